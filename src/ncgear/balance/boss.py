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
from scipy.optimize import minimize, root
from shapely import MultiPolygon, Polygon
from shapely.affinity import rotate
from shapely.geometry.base import BaseGeometry

from ncgear.errors import NoSuchMechanism
from ncgear.numerics.arrays import Array
from ncgear.solids.inertia import area_moments

SOLVED = 1e-9
"""Share of the moment that may be left: rounding of areas of some thousand corners."""

SPARE, ADVISED = 1.02, 1.05
"""What a room must be able to give, by what is needed, for a boss to be made, and what the advice is for.  A chord near
the axis gives most; there its distance hardly matters any more, and is not found (tests/test_gear_balance.py takes the
advice)."""

STARTS = 33
"""Distances of the chord among which the search's start is chosen, and directions in which the room is judged."""

WIDEST_RAD = 1.4
"""Angle from the needed moment up to which the room is judged: beyond, hardly any of it is asked for."""


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
    most = _most(room, needed)
    if most <= SPARE:
        hope = f"one of {ceil(ADVISED * height_mm / most)} mm would" if most > 0.0 else "there is no room for any"
        raise NoSuchMechanism(f"no boss of {height_mm:g} mm within the gear balances it; {hope}", key=key)
    return Boss(_solved(room, needed), height_mm)


def _most(room: BaseGeometry, needed: complex) -> float:
    """The largest multiple of the moment that parts of the room have.

    The moments of all parts are a convex set; the room beyond a chord through the axis is its farthest in a direction.
    """
    multiples = []
    for turn in np.linspace(-WIDEST_RAD, WIDEST_RAD, STARTS):
        direction = needed * np.exp(1j * turn)
        farthest = area_moments(_beyond(room, float(np.angle(direction)), 0.0)).first_mm3
        multiples.append((np.conj(direction) * farthest).real / (np.conj(direction) * needed).real)
    return float(min(multiples))


def _solved(room: BaseGeometry, needed: complex) -> MultiPolygon:
    """The room beyond the chord that has the moment.

    With the chord at l.p = 1 the dual, the integral of (l.p - 1) beyond it less l.needed, is convex in l; its gradient
    is the excess of the moment.
    """
    reach = float(np.abs(room.bounds).max())

    def dual(scaled: Array) -> tuple[float, Array]:
        line = complex(scaled[0], scaled[1]) / reach
        beyond = _chord(room, line)
        excess = (area_moments(beyond).first_mm3 - needed) / abs(needed)
        value = (np.conj(line) * excess).real - float(beyond.area) / abs(needed)
        return reach * value, np.array([excess.real, excess.imag])

    shares = np.linspace(0.0, 1.0, STARTS + 1)[1:]
    starts = [np.array([needed.real, needed.imag]) / abs(needed) / share for share in shares]
    near = minimize(dual, min(starts, key=lambda start: dual(start)[0]), jac=True, method="BFGS").x
    found = root(lambda scaled: dual(scaled)[1], near, tol=SOLVED / 1e4).x
    if np.abs(dual(found)[1]).max() > SOLVED:
        raise ArithmeticError("no chord gives the moment of the boss")
    return _chord(room, complex(found[0], found[1]) / reach)


def _chord(room: BaseGeometry, line: complex) -> MultiPolygon:
    """The part of a room beyond the line l.p = 1."""
    return _beyond(room, float(np.angle(line)), 1.0 / abs(line))


def _beyond(room: BaseGeometry, direction_rad: float, distance_mm: float) -> MultiPolygon:
    """The part of a room farther out than a distance, in a direction from the axis."""
    reach = 2.0 * float(np.abs(room.bounds).max())
    half = rotate(
        shapely.box(distance_mm, -reach, 2.0 * reach, reach), direction_rad, origin=(0.0, 0.0), use_radians=True
    )
    parts = shapely.get_parts(room.intersection(half))
    return MultiPolygon([part for part in parts if isinstance(part, Polygon)])
