"""Teeth of both gears: exact curves from a rack that rolls on the pitch curves, and their outlines.

To be read in this order: the wanted teeth (form), the tool (tool), the curves that bound a tooth (flank), spaces and
tips (spaces, tips, fouling, ceilings), both gears fitted to each other (fitting), the sides as the tool leaves them
(sides), and the outline as points (chords, outline). gear is the way in to all of them; contour gives the outline as
smooth curves.
"""
