"""Round through holes about the axis that take weight out of a gear.

They stand in evenly spread directions, each as far out as its walls allow: there holes have most room beside each
other, and take most of the moment of inertia.
"""

from __future__ import annotations

import numpy as np
import shapely
from shapely.geometry.base import BaseGeometry

from ncgear.errors import WrongInput
from ncgear.numerics.arrays import Array
from ncgear.solids.blank import HoleSet
from ncgear.solids.largest import floored, largest_fitting, said_largest
from ncgear.solids.round_hole import RoundHole
from ncgear.solids.web import quarter_chords

TURNS = 12
"""Ways, between one direction and the next, in which the directions are turned to find most room."""

LEAST_MM = 0.1
"""Diameter in mm of the smallest hole that is made unasked."""


def lightening_holes(room: BaseGeometry, asked: HoleSet, tolerance_mm: float, key: str) -> tuple[RoundHole, ...]:
    """Holes within a room in mm, with walls to its edges and to each other.

    Raises WrongInput for ``key``.lightening_holes, with the largest diameter that fits, where they have no room.
    """
    wanted = asked.diameter_mm
    if wanted is not None and (places := _places(room, asked, wanted, tolerance_mm)) is not None:
        return _holes(places, wanted)
    most = wanted if wanted is not None else float(np.abs(room.bounds).max()) if not room.is_empty else 0.0
    largest = largest_fitting(lambda size: _places(room, asked, size, tolerance_mm) is not None, 0.0, most)
    if wanted is None and largest >= LEAST_MM:
        size = floored(largest)
        places = _places(room, asked, size, tolerance_mm)
        assert places is not None
        return _holes(places, size)
    raise _without_room(asked, largest, f"{key}.lightening_holes")


def _without_room(asked: HoleSet, largest: float, key: str) -> WrongInput:
    """What is wrong with the holes asked for, and the largest diameter that would be right."""
    given = asked.diameter_mm is not None
    named = f"{asked.count} holes of {asked.diameter_mm:g} mm" if given else f"{asked.count} holes"
    right = said_largest(largest, "none fit; fewer holes, thinner walls, or a smaller hub are needed")
    problem = f"{named} do not keep walls of {asked.wall_mm:g} mm to every edge and to each other; {right}"
    return WrongInput(problem, key=f"{key}.diameter_mm" if given else key)


def _holes(places: Array, diameter: float) -> tuple[RoundHole, ...]:
    return tuple(RoundHole(float(x), float(y), diameter) for x, y in places)


def _places(room: BaseGeometry, asked: HoleSet, diameter: float, tolerance: float) -> Array | None:
    """Centres of the holes, shape (count, 2), in the first turn in which they have room; None where there is none."""
    # Chords of the parallel's arcs come nearer to the edge by a tolerance.
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
    """The point of an area farthest out in each direction from the axis, shape (n, 2); None where one meets none."""
    reach = 2.0 * float(np.abs(inside.bounds).max())
    ends = reach * np.column_stack([np.cos(direction), np.sin(direction)])
    rays = shapely.linestrings(np.stack([np.zeros_like(ends), ends], axis=1))
    met = [shapely.get_coordinates(part) for part in shapely.intersection(rays, inside)]
    if not all(len(points) for points in met):
        return None
    return np.array([points[np.argmax(np.hypot(points[:, 0], points[:, 1]))] for points in met])


def _apart(places: Array) -> float:
    """Least distance between any two of them; infinite of a single one."""
    between = np.hypot(*(places[:, None] - places[None, :]).transpose(2, 0, 1))
    np.fill_diagonal(between, np.inf)
    return float(between.min())
