"""Pockets between rim and hub, from the upper face down to a web.

From above only, so that the gear lies on a level face when it is printed, and needs turning over for no cut.
"""

from __future__ import annotations

from math import acos, ceil, pi

import shapely
from shapely import Polygon
from shapely.geometry.base import BaseGeometry

from ncgear.errors import WrongInput
from ncgear.solids.blank import WebSize
from ncgear.solids.body import Web
from ncgear.solids.bore import circle_points
from ncgear.solids.index_hole import INNER_WALL_IN_MODULES
from ncgear.solids.largest import largest_fitting, said_largest
from ncgear.solids.round_hole import RoundHole, hole_points
from ncgear.solids.sheets import polygons

CORNER_IN_MODULES = 1.0
"""Least radius of a pocket's corners: a round tool's, which leaves out whatever is narrower."""


def web_of(
    disc: Polygon, mark: RoundHole | None, size: WebSize, module_mm: float, tolerance_mm: float, key: str
) -> Web:
    """The web of a gear whose disc in mm has an index hole or none.

    Pockets keep the rim's wall to the nearest point of the tooth outline.  Raises WrongInput for ``key``.web.rim_mm,
    with the thickest rim that leaves a pocket, where there is no room for any.
    """
    around = _kept(mark, size.hub_mm, module_mm, tolerance_mm)
    corner = CORNER_IN_MODULES * module_mm
    pockets = _pockets(disc, around, size.rim_mm, corner, tolerance_mm)
    if pockets:
        return Web(size.thickness_mm, tuple(pockets))
    largest = largest_fitting(lambda rim: bool(_pockets(disc, around, rim, corner, tolerance_mm)), 0.0, size.rim_mm)
    right = said_largest(largest, "there is none beside any rim; a smaller hub_mm or a larger gear is needed")
    problem = f"a rim of {size.rim_mm:g} mm leaves no room for a pocket beside a hub of {size.hub_mm:g} mm; {right}"
    raise WrongInput(problem, key=f"{key}.web.rim_mm")


def _kept(mark: RoundHole | None, hub: float, module: float, tolerance: float) -> BaseGeometry:
    """What no pocket cuts: the hub, and the wall around the index hole."""
    kept: BaseGeometry = Polygon(circle_points(hub / 2.0 + tolerance, tolerance))
    if mark is None:
        return kept
    hole = Polygon(hole_points(mark, tolerance))
    return kept.union(hole.buffer(INNER_WALL_IN_MODULES * module, quad_segs=quarter_chords(module, tolerance)))


def _pockets(disc: Polygon, kept: BaseGeometry, rim: float, corner: float, tolerance: float) -> list[Polygon]:
    """The room for pockets with rounded corners, without points that the tolerance does not need.

    Chords of arcs and points left out may bring it nearer to a wall, by a tolerance and by half of one: hence two.
    """
    inside = disc.buffer(-rim - corner - 2.0 * tolerance, quad_segs=quarter_chords(rim + corner, tolerance))
    quarter = quarter_chords(corner, tolerance)
    room = inside.difference(kept.buffer(corner + 2.0 * tolerance, quad_segs=quarter)).buffer(corner, quad_segs=quarter)
    return polygons(shapely.simplify(room, tolerance / 2.0))


def quarter_chords(radius_mm: float, tolerance_mm: float) -> int:
    """Parts of a quarter circle, by shapely's count, with which a parallel's arcs keep within a tolerance.

    It closes an arc with a chord of up to two parts, which strays four times as far.
    """
    return max(2, ceil(pi / 4.0 / acos(max(1.0 - tolerance_mm / 4.0 / radius_mm, 0.0))))
