"""Teeth of both gears: exact curves from a rack that rolls on the pitch curves, and their outlines.

To be read in this order: what is asked (form), the tool (tool), the curves that bound a tooth (flank), spaces and tips
(spaces, tips, fouling, ceilings), both gears fitted to each other (fitting), what is left of the sides (sides), and the
outline as points (chords, outline).  gear is the way in to all of it; contour gives the outline as smooth curves.
"""
