"""A boss on a gear's face that brings its centroid to the axis: a counterweight cast or welded on.

Of all bosses of a height within a room, the one of least mass with a given first moment is the room beyond a chord: a
linear programme over the density, 0 to 1 at each place, whose dual is a line.  The chord's direction and distance are
found from both components of the moment.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import ceil

import numpy as np
import shapely
from scipy.optimize import root
from shapely import MultiPolygon, Polygon
from shapely.affinity import rotate
from shapely.geometry.base import BaseGeometry

from ncgear.balance.gear_body import area_moment_mm3
from ncgear.errors import NoSuchMechanism
from ncgear.numerics.arrays import Array

SOLVED = 1e-9
"""Share of the moment that may be left: rounding of areas of some thousand corners."""

SPARE, ADVISED = 1.02, 1.05
"""Moment of the room beyond a chord through the axis, by the one needed: from which on a boss is made, and what the
advice is for.  That chord gives most; near it the direction is hardly free any more, and the solution is not
(tests/test_gear_balance.py takes the advice)."""

STARTS = 33
"""Distances of the chord among which the solution's start is chosen."""


@dataclass(frozen=True, eq=False)
class Boss:
    """Its outlines in the gear's frame and its height over the face, in mm."""

    section: MultiPolygon
    height_mm: float


def balancing_boss(section: Polygon, moment_mm4: complex, height_mm: float, wall_mm: float, key: str) -> Boss:
    """The lightest boss of a height in mm whose moment of volume about the axis is minus the one given, not zero.

    It lies within the gear's ``section`` with a wall all round.  Raises NoSuchMechanism for ``key`` where none of this
    height is heavy enough, with a height that is.
    """
    needed, room = -moment_mm4 / height_mm, section.buffer(-wall_mm)
    toward = float(np.angle(needed))
    most = float((area_moment_mm3(_beyond(room, toward, 0.0)) / needed).real)
    if most <= SPARE:
        hope = f"one of {ceil(ADVISED * height_mm / most)} mm would" if most > 0.0 else "there is no room for any"
        raise NoSuchMechanism(f"no boss of {height_mm:g} mm within the gear balances it; {hope}", key=key)
    return Boss(_solved(room, needed, toward), height_mm)


def _solved(room: BaseGeometry, needed: complex, toward: float) -> MultiPolygon:
    """The room beyond the chord that has the moment."""
    reach = float(np.abs(room.bounds).max())

    def excess(unknown: Array) -> Array:
        error = area_moment_mm3(_beyond(room, unknown[0], unknown[1] * reach)) / needed - 1.0
        return np.array([error.real, error.imag])

    starts = [np.array([toward, share]) for share in np.linspace(0.0, 1.0, STARTS)]
    found = root(excess, min(starts, key=lambda start: float(np.abs(excess(start)).sum())), tol=SOLVED / 1e4)
    if np.abs(excess(found.x)).max() > SOLVED:
        raise ArithmeticError(f"no chord gives the moment of the boss: {found.message}")
    return _beyond(room, found.x[0], found.x[1] * reach)


def _beyond(room: BaseGeometry, direction_rad: float, distance_mm: float) -> MultiPolygon:
    """The part of a room farther out than a distance, in a direction from the axis."""
    reach = 2.0 * float(np.abs(room.bounds).max())
    half = rotate(
        shapely.box(distance_mm, -reach, 2.0 * reach, reach), direction_rad, origin=(0.0, 0.0), use_radians=True
    )
    parts = shapely.get_parts(room.intersection(half))
    return MultiPolygon([part for part in parts if isinstance(part, Polygon)])
