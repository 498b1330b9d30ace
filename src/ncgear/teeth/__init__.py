"""Teeth of both gears: exact curves from a rack that rolls on the pitch curves, and their outlines.

Read in this order: the wanted teeth (form), the tool (tool), the curves that bound a tooth (flank), spaces and tips
(spaces, tips, fouling, ceilings), both gears fitted to each other (fitting), the sides after cutting (sides), and the
outline as points (chords, outline). gear is the entrance to all of them; contour gives the outline as smooth curves.
"""
