"""The picture of a fitted outline."""

from __future__ import annotations

from math import cos, pi, sin

import numpy as np

from ncgear.drawings.plots.outline_plot import outline_and_curve
from ncgear.numerics.arrays import Array
from ncgear.project.outline_fit import OutlineFit

PICTURE = "outline.png"
"""Name of the picture."""


def outline_picture(found: OutlineFit, name: str) -> bytes:
    """PNG of the outline, the fitted curve, its mate where they touch at the curve's first point, and the deviation.

    An outline of the mate lies where the mate stands.
    """
    away, curve, follower = found.deviation, found.curve, found.mate
    other = curve.axis_mm + np.array([curve.center_distance_mm, 0.0])
    outlines, greatest = [found.outline.corners], [np.array([away.at_mm, away.toward_mm])]
    farthest = away.greatest_mm
    if follower is not None and curve.mate_place is not None:
        # The mate's first point faces the curve's: it is turned from the drawing to there.
        turn = pi - curve.mate_place.turned_rad
        to_pair = follower.scale * np.array([[cos(turn), sin(turn)], [-sin(turn), cos(turn)]])

        def placed(points: Array) -> Array:
            there: Array = other + (points - follower.axis_mm) @ to_pair
            return there

        outlines.append(placed(follower.outline.corners))
        greatest.append(placed(np.array([follower.deviation.at_mm, follower.deviation.toward_mm])))
        farthest = max(farthest, follower.deviation.greatest_mm)
    title = f"{name}: outline and pitch curves, greatest deviation {farthest:.2f} mm"
    mate = other + found.mate_points_mm
    return outline_and_curve(outlines, found.points_mm, mate, (curve.axis_mm, other), greatest, title)
