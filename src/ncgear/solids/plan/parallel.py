"""A section moved into its material by one distance along the normal, everywhere.

The parallel of a polygon whose chords stray from a curve by a tolerance strays from the curve's parallel by no more:
where one section lies within the other, so do their parallels.  Each edge keeps its direction, and neighbouring ones
are prolonged to meet (mitred), so that moving back gives the edges again.  In a hollow of radius r, by a distance d,
the corners between prolonged edges stray by d / r of the tolerance: less than it up to the radius of the fillets.
"""

from __future__ import annotations

import numpy as np
import shapely
from shapely import Polygon
from shapely.geometry.base import BaseGeometry

from ncgear.errors import WrongInput
from ncgear.solids.plan.room import largest_fitting, said_largest

SHARPEST = 10.0
"""Length, in distances moved, up to which a corner is prolonged: corners down to 12 degrees stay corners."""


def moved_inwards(section: Polygon, distance_mm: float, tolerance_mm: float, key: str) -> Polygon:
    """The inner parallel of a section in mm; moved back, it is the section again to the tolerance.

    Raises WrongInput for ``key``, with the largest distance that can be, where it would lose something: a tooth, a wall
    between two holes, or a tip narrower than twice the distance.
    """
    inner = _parallel(section, -distance_mm)
    if _comes_back(section, inner, distance_mm, tolerance_mm):
        return shapely.get_parts(inner)[0]
    largest = largest_fitting(
        lambda size: _comes_back(section, _parallel(section, -size), size, tolerance_mm), 0.0, distance_mm
    )
    right = said_largest(largest, "none can be taken; larger teeth are needed")
    problem = f"{distance_mm:g} mm off the edges is more than half of the thinnest part of the gear; {right}"
    raise WrongInput(problem, key=key)


def moved_outwards(section: BaseGeometry, distance_mm: float) -> BaseGeometry:
    """The outer parallel of an area in mm."""
    return _parallel(section, distance_mm)


def _parallel(section: BaseGeometry, distance: float) -> BaseGeometry:
    moved = section.buffer(distance, join_style="mitre", mitre_limit=SHARPEST)
    step = 2.0 * float(np.spacing(np.float32(np.abs(section.bounds).max())))
    # Points that the single precision of STL files cannot tell apart would become one there.
    return shapely.remove_repeated_points(moved, step)


def _comes_back(section: Polygon, inner: BaseGeometry, distance: float, tolerance: float) -> bool:
    """Whether nothing is lost: the parallel is in one piece, and its own parallel is the section."""
    if inner.is_empty or len(shapely.get_parts(inner)) != 1 or len(inner.interiors) != len(section.interiors):
        return False
    # Where a tip's land is lost its flanks, prolonged, meet beyond it: what is gained counts as well.
    changed = section.symmetric_difference(_parallel(inner, distance))
    return bool(changed.buffer(-tolerance / 2.0).is_empty)
