"""The picture of a fitted outline."""

from __future__ import annotations

import numpy as np

from ncgear.drawings.plots.outline_plot import outline_and_curve
from ncgear.project.outline_fit import OutlineFit

PICTURE = "outline.png"
"""Name of the picture."""


def outline_picture(found: OutlineFit, name: str) -> bytes:
    """PNG of the outline, the fitted curve, its mate where they touch at the curve's first point, and the deviation."""
    away, curve = found.deviation, found.curve
    other = curve.axis_mm + np.array([curve.center_distance_mm, 0.0])
    title = f"{name}: outline and pitch curves, greatest deviation {away.greatest_mm:.2f} mm"
    greatest = np.array(away.at_mm), np.array(away.toward_mm)
    mate = other + found.mate_points_mm
    return outline_and_curve(found.outline.corners, found.points_mm, mate, (curve.axis_mm, other), greatest, title)
