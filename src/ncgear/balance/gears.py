"""Mass, centroid, moment of inertia and static unbalance of a gear's body, from its section or from its mesh.

Through holes that bring a gear's centroid to its axis.

Places are a hexagonal lattice on which holes of the largest diameter keep their wall.  How much is taken out at each
place is a linear programme, least material under both components of the unbalance; its corner solution has full holes
but for two.  Where the holes cannot take all of it, as much as possible is taken along the unbalance.

A boss on a gear's face that brings its centroid to the axis: a counterweight cast or welded on.

Of all bosses of a height within a room, the one of least mass with a given first moment is the room beyond a chord: a
linear programme over the density, 0 to 1 at each place, whose dual is a line.  The chord's direction and distance are
found from both components of the moment.

A gear corrected by holes, by a boss, or by holes first and a boss for what they leave; judged by its mesh.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import ceil, pi, sqrt

import numpy as np
import shapely
from scipy.optimize import linprog, minimize, root
from shapely import MultiPolygon, Polygon
from shapely.affinity import rotate
from shapely.geometry.base import BaseGeometry
from trimesh import Trimesh

from ncgear.errors import NoSuchMechanism, WrongInput
from ncgear.numerics.arrays import Array
from ncgear.solids.mesh.slabs import slab_mesh
from ncgear.solids.plan.areas import area_moments
from ncgear.solids.plan.body import KG_MM3, RoundHole, Slab, hole_points


@dataclass(frozen=True)
class GearBody:
    """A rigid body on an axis along z.

    ``unbalance_kg_mm`` is mass times the centroid's place (x + i y), ``inertia_kg_mm2`` is about the axis.
    ``couple_kg_mm2`` is the sum of mass times place times height over the centroid: zero for a plate.
    """

    mass_kg: float
    unbalance_kg_mm: complex
    inertia_kg_mm2: float
    couple_kg_mm2: complex = 0j

    @property
    def centroid_mm(self) -> complex:
        """The centroid's place from the axis."""
        return self.unbalance_kg_mm / self.mass_kg

    @property
    def eccentricity_mm(self) -> float:
        """Its distance from the axis."""
        return abs(self.centroid_mm)


def plate_body(section: Polygon, thickness_mm: float, density_kg_m3: float) -> GearBody:
    """Of a plate: a section in mm, about the origin, by its moments."""
    moments, per_area = area_moments(section), KG_MM3 * density_kg_m3 * thickness_mm
    return GearBody(per_area * moments.area_mm2, per_area * moments.first_mm3, per_area * moments.polar_mm4)


def mesh_body(mesh: Trimesh, density_kg_m3: float) -> GearBody:
    """Of a closed mesh in mm, by its volume integrals; for sections that change with height, and as a check."""
    density = KG_MM3 * density_kg_m3
    mass, center = density * float(mesh.volume), mesh.center_mass
    place = complex(center[0], center[1])
    inertia = density * mesh.moment_inertia
    about_axis = float(inertia[2, 2]) + mass * abs(place) ** 2
    return GearBody(mass, mass * place, about_axis, -complex(inertia[0, 2], inertia[1, 2]))


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


BALANCED = 1e-9
"""Share of area to the power 3/2 below which a first moment is rounding error, and no boss has a direction."""


@dataclass(frozen=True)
class BossSize:
    """Height of a boss over the face and its wall to every edge, in mm."""

    height_mm: float
    wall_mm: float


@dataclass(frozen=True)
class Means:
    """What may be done to a gear."""

    drills: Drills | None = None
    boss: BossSize | None = None


@dataclass(frozen=True, eq=False)
class Corrected:
    """The gear with its corrections: its holes and boss, the mesh, and what the mesh's own integrals say of it."""

    holes: list[RoundHole]
    boss: Boss | None
    mesh: Trimesh
    body: GearBody


def corrected(
    section: Polygon, face_width_mm: float, density_kg_m3: float, means: Means, tolerance_mm: float, key: str
) -> Corrected:
    """A straight gear, its section in mm, brought to balance about the origin as far as the means go.

    ``tolerance_mm`` is that of the holes' chords; ``key`` names the means in errors.  Raises NoSuchMechanism where a
    hole or a boss has no room, or the boss is too low.
    """
    holes, boss = [], None
    if means.drills is not None:
        holes = drilled_holes(section, area_moments(section).first_mm3, means.drills, f"{key}.holes")
        section = drilled(section, holes, tolerance_mm)
    moment = area_moments(section).first_mm3 * face_width_mm
    if means.boss is not None and abs(moment) > BALANCED * section.area**1.5 * face_width_mm:
        boss = balancing_boss(section, moment, means.boss.height_mm, means.boss.wall_mm, f"{key}.boss.height_mm")
    gear = Slab(section, 0.0, face_width_mm)
    mesh = slab_mesh((gear, *([Slab(boss.section, face_width_mm, face_width_mm + boss.height_mm)] if boss else [])))
    return Corrected(holes, boss, mesh, mesh_body(mesh, density_kg_m3))
