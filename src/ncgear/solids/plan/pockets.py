"""Cuts that make a gear lighter: pockets between rim and hub down to a web, and round through holes about the axis.

Pockets are cut from above only, so that the gear lies on a level face when it is printed and is never turned over.
Holes stand in evenly spread directions, each as far out as its walls allow: there, holes have most room beside each
other, and take away most of the moment of inertia.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import acos, ceil, pi

import numpy as np
import shapely
from shapely import Polygon
from shapely.geometry.base import BaseGeometry

from ncgear.errors import WrongInput
from ncgear.numerics.arrays import Array
from ncgear.solids.plan.areas import floored, largest_fitting, polygons, said_largest
from ncgear.solids.plan.body import HoleSet, RoundHole, Web, WebSize, circle_points
from ncgear.solids.plan.room import INNER_WALL_IN_MODULES, USEFUL_MM

CORNER_IN_MODULES = 1.0
"""Least radius of a pocket's corners: the radius of a round tool, which cannot reach narrower places."""

TURNS = 12
"""Angles, between one direction and the next, by which the directions of the holes are turned to find most room."""


def web_of(disc: Polygon, cuts: Sequence[Array], size: WebSize, module_mm: float, tolerance_mm: float, key: str) -> Web:
    """The web of a gear; its disc in mm has cuts, polygons of shape (n, 2): an index hole, a slot, or none.

    Pockets keep the rim's wall to the nearest point of the tooth outline.  Raises WrongInput for ``key``.web.rim_mm,
    with the thickest rim that leaves a pocket, where there is no room for a pocket.
    """
    around = _kept(cuts, size.hub_mm, module_mm, tolerance_mm)
    corner = CORNER_IN_MODULES * module_mm
    pockets = _pockets(disc, around, size.rim_mm, corner, tolerance_mm)
    if pockets:
        return Web(size.thickness_mm, tuple(pockets))
    largest = largest_fitting(lambda rim: bool(_pockets(disc, around, rim, corner, tolerance_mm)), 0.0, size.rim_mm)
    right = said_largest(largest, "there is none beside any rim; a smaller hub_mm or a larger gear is needed")
    problem = f"a rim of {size.rim_mm:g} mm leaves no room for a pocket beside a hub of {size.hub_mm:g} mm; {right}"
    raise WrongInput(problem, key=f"{key}.web.rim_mm")


def _kept(cuts: Sequence[Array], hub: float, module: float, tolerance: float) -> BaseGeometry:
    """The area that no pocket cuts: the hub, and the wall around each cut."""
    kept: BaseGeometry = Polygon(circle_points(hub / 2.0 + tolerance, tolerance))
    wall, quarter = INNER_WALL_IN_MODULES * module, quarter_chords(module, tolerance)
    return shapely.union_all([kept, *(Polygon(cut).buffer(wall, quad_segs=quarter) for cut in cuts)])


def _pockets(disc: Polygon, kept: BaseGeometry, rim: float, corner: float, tolerance: float) -> list[Polygon]:
    """The room for pockets with rounded corners, two tolerances from walls: for chords and for points left out."""
    inside = disc.buffer(-rim - corner - 2.0 * tolerance, quad_segs=quarter_chords(rim + corner, tolerance))
    quarter = quarter_chords(corner, tolerance)
    room = inside.difference(kept.buffer(corner + 2.0 * tolerance, quad_segs=quarter)).buffer(corner, quad_segs=quarter)
    return polygons(shapely.simplify(room, tolerance / 2.0))


def quarter_chords(radius_mm: float, tolerance_mm: float) -> int:
    """Number of parts of a quarter circle, for shapely, at which the arcs of a parallel keep the tolerance."""
    return max(2, ceil(pi / 4.0 / acos(max(1.0 - tolerance_mm / 4.0 / radius_mm, 0.0))))


def lightening_holes(room: BaseGeometry, asked: HoleSet, tolerance_mm: float, key: str) -> tuple[RoundHole, ...]:
    """Holes within a room in mm, with walls to its edges and to each other.

    Raises WrongInput for ``key``.lightening_holes, with the largest diameter that fits, where the holes have no room,
    or where no diameter is given and only holes under ``USEFUL_MM`` fit.
    """
    wanted = asked.diameter_mm
    if wanted is not None and (places := _places(room, asked, wanted, tolerance_mm)) is not None:
        return _holes(places, wanted)
    most = wanted if wanted is not None else float(np.abs(room.bounds).max()) if not room.is_empty else 0.0
    largest = largest_fitting(lambda size: _places(room, asked, size, tolerance_mm) is not None, 0.0, most)
    if wanted is None and largest >= USEFUL_MM:
        size = floored(largest)
        places = _places(room, asked, size, tolerance_mm)
        assert places is not None
        return _holes(places, size)
    raise _without_room(asked, largest, f"{key}.lightening_holes")


def _holes(places: Array, diameter: float) -> tuple[RoundHole, ...]:
    return tuple(RoundHole(float(x), float(y), diameter) for x, y in places)


def _without_room(asked: HoleSet, largest: float, key: str) -> WrongInput:
    given = asked.diameter_mm is not None
    named = f"{asked.count} holes of {asked.diameter_mm:g} mm" if given else f"{asked.count} holes"
    helps = "fewer holes, thinner walls, or a smaller hub are needed"
    right = said_largest(largest, f"none fit; {helps}")
    if 0.0 < largest < USEFUL_MM:
        right = f"{right}, and under {USEFUL_MM:g} mm holes take off next to nothing; {helps}"
    problem = f"{named} do not keep walls of {asked.wall_mm:g} mm to every edge and to each other; {right}"
    return WrongInput(problem, key=f"{key}.diameter_mm" if given else key)


def _places(room: BaseGeometry, asked: HoleSet, diameter: float, tolerance: float) -> Array | None:
    """Centres of the holes, shape (count, 2), for the first turn with room for them; None where no turn has room."""
    # Chords of the parallel's arcs come nearer to the edge by up to a tolerance.
    inset = diameter / 2.0 + asked.wall_mm + tolerance
    inside = room.buffer(-inset, quad_segs=quarter_chords(inset, tolerance))
    if inside.is_empty:
        return None
    shapely.prepare(inside)
    for turn in np.arange(TURNS) / TURNS:
        places = _farthest(inside, 2.0 * np.pi / asked.count * (np.arange(asked.count) + turn))
        if places is not None and _apart(places) >= diameter + asked.wall_mm:
            return places
    return None


def _farthest(inside: BaseGeometry, direction: Array) -> Array | None:
    """The farthest point of an area in each direction from the axis, shape (n, 2); None if a direction misses it."""
    reach = 2.0 * float(np.abs(inside.bounds).max())
    ends = reach * np.column_stack([np.cos(direction), np.sin(direction)])
    rays = shapely.linestrings(np.stack([np.zeros_like(ends), ends], axis=1))
    met = [shapely.get_coordinates(part) for part in shapely.intersection(rays, inside)]
    if not all(len(points) for points in met):
        return None
    return np.array([points[np.argmax(np.hypot(points[:, 0], points[:, 1]))] for points in met])


def _apart(places: Array) -> float:
    """Least distance between any two of the points; infinite for a single point."""
    between = np.hypot(*(places[:, None] - places[None, :]).transpose(2, 0, 1))
    np.fill_diagonal(between, np.inf)
    return float(between.min())
