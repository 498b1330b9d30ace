"""Through holes that bring a gear's centroid to its axis.

Places are a hexagonal lattice on which holes of the largest diameter keep their wall.  How much is taken out at each
place is a linear programme, least material under both components of the unbalance; its corner solution has full holes
but for two.  Where the holes cannot take all of it, as much as possible is taken along the unbalance.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import pi, sqrt

import numpy as np
import shapely
from scipy.optimize import linprog
from shapely import Polygon

from ncgear.errors import NoSuchMechanism, WrongInput
from ncgear.numerics.arrays import Array
from ncgear.solids.round_hole import RoundHole, hole_points

MOST_PLACES = 200_000
"""Points of a lattice: some two hundred holes along a gear's radius."""


@dataclass(frozen=True)
class Drills:
    """What may be drilled: diameters in mm, and the least wall between holes and to every edge."""

    largest_mm: float
    smallest_mm: float
    wall_mm: float


def drilled_holes(section: Polygon, moment_mm3: complex, drills: Drills, key: str) -> list[RoundHole]:
    """Holes whose areas' first moment about the axis is ``moment_mm3``, or as near along it as there is room.

    ``section`` is the gear's, in mm.  Raises NoSuchMechanism for ``key`` where no hole has room, WrongInput where
    holes and walls are so small that there are too many places.
    """
    places = _places(section, drills, key)
    if not places.size:
        raise NoSuchMechanism(
            f"no hole of {drills.largest_mm:g} mm with walls of {drills.wall_mm:g} mm has room; smaller ones may",
            key=key,
        )
    areas = _areas(places, moment_mm3, pi * drills.largest_mm**2 / 4.0)
    diameters = 2.0 * np.sqrt(areas / pi)
    kept = diameters >= drills.smallest_mm
    return [
        RoundHole(float(place.real), float(place.imag), float(diameter))
        for place, diameter in zip(places[kept], diameters[kept], strict=True)
    ]


def drilled(section: Polygon, holes: list[RoundHole], chord_tolerance_mm: float) -> Polygon:
    """The section with the holes, each a polygon of the area of its circle, which chords alone would make less."""
    rings = [_of_equal_area(hole, chord_tolerance_mm) for hole in holes]
    return Polygon(section.exterior, [*section.interiors, *rings])


def _places(section: Polygon, drills: Drills, key: str) -> Array:
    """Lattice points with room for the largest hole, as x + i y."""
    room = section.buffer(-drills.largest_mm / 2.0 - drills.wall_mm)
    pitch = drills.largest_mm + drills.wall_mm
    reach = int(np.abs(section.bounds).max() / pitch * 2.0 / sqrt(3.0)) + 1
    if 8 * reach**2 > MOST_PLACES:
        problem = f"holes {pitch:g} mm apart are too many to choose from; larger ones or thicker walls are needed"
        raise WrongInput(problem, key=key)
    column, row = np.meshgrid(np.arange(-2 * reach, 2 * reach + 1), np.arange(-reach, reach + 1))
    places = pitch * (column + row / 2.0 + 1j * row * sqrt(3.0) / 2.0).ravel()
    return np.asarray(places[shapely.contains_xy(room, places.real, places.imag)])


def _areas(places: Array, moment: complex, largest: float) -> Array:
    """Areas within [0, largest] with the moment, or with as large a share of it as there is room for."""
    scale = largest * float(np.abs(places).max())
    columns = np.vstack([places.real, places.imag]) * largest / scale
    target = np.array([moment.real, moment.imag]) / scale
    # The last unknown is the share; it is worth more than all the material
    system = np.column_stack([columns, -target])
    cost = np.append(np.full(places.size, 1.0 / (places.size + 1.0)), -100.0)
    found = linprog(cost, A_eq=system, b_eq=np.zeros(2), bounds=(0.0, 1.0))
    if not found.success:
        raise ArithmeticError(f"the linear programme of the holes failed: {found.message}")
    return np.asarray(largest * found.x[:-1])


def _of_equal_area(hole: RoundHole, tolerance: float) -> Array:
    points = hole_points(hole, tolerance)
    center = np.array([hole.x_mm, hole.y_mm])
    polygon = Polygon(points).area
    return np.asarray(center + (points - center) * sqrt(pi * hole.diameter_mm**2 / 4.0 / polygon))
