"""Contact of the exact curves.

as_designed is the way in.  Flanks touch flanks (flanks, tangency), corners touch curves (edges, on the curves as the
driven gear sees them in curves), and tips stay clear of roots (clearance).
"""
