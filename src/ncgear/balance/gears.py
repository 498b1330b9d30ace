"""A non-circular gear brought to balance: through holes, a boss on its face, or holes first and a boss for the rest.

The unbalance of a gear comes from its section or from its mesh; the rest after a correction comes from the mesh.

Holes are chosen from a hexagonal lattice on which holes of the largest diameter keep their walls.  A linear programme
finds how much is taken out at each place: the least material that removes both components of the unbalance.  At its
corner solution all holes but two are full.  Where there is no room for all of it, as much as possible is taken, in the
direction of the unbalance.

A boss is a counterweight cast or welded on.  Of all bosses of one height within a room, the lightest with a given first
moment is the part of the room beyond a chord: a linear programme over the density, 0 to 1 at each place, has a line as
its dual.  The chord's direction and distance follow from both components of the moment.
"""

from __future__ import annotations

from math import ceil, pi, sqrt

import numpy as np
import shapely
from scipy.optimize import linprog, minimize, root
from shapely import MultiPolygon, Polygon
from shapely.affinity import rotate
from shapely.geometry.base import BaseGeometry

from ncgear.errors import NoSuchMechanism, Unanswered, WrongInput
from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array
from ncgear.solids.mesh.slabs import slab_mesh
from ncgear.solids.mesh.triangles import TriangleMesh
from ncgear.solids.plan.areas import area_moments
from ncgear.solids.plan.body import KG_MM3, RoundHole, Slab, hole_points

# --- mass and unbalance ---------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class GearBody:
    """A rigid body on an axis along z.

    ``unbalance_kg_mm`` is its mass times the place x + i y of its centroid, ``inertia_kg_mm2`` is about the axis.
    ``couple_kg_mm2`` is the sum of mass times place times height above the centroid: zero for a plate.
    """

    mass_kg: float
    unbalance_kg_mm: complex
    inertia_kg_mm2: float
    couple_kg_mm2: complex = 0j

    @property
    def eccentricity_mm(self) -> float:
        """Distance of the centroid from the axis."""
        return abs(self.unbalance_kg_mm / self.mass_kg)


def plate_body(section: Polygon, thickness_mm: float, density_kg_m3: float) -> GearBody:
    """A plate, from the moments of its section in mm about the origin."""
    moments, per_area = area_moments(section), KG_MM3 * density_kg_m3 * thickness_mm
    return GearBody(per_area * moments.area_mm2, per_area * moments.first_mm3, per_area * moments.polar_mm4)


def mesh_body(mesh: TriangleMesh, density_kg_m3: float) -> GearBody:
    """A body from the volume integrals of its closed mesh in mm, whose section may change with height."""
    density, solid = KG_MM3 * density_kg_m3, mesh.as_trimesh()
    mass, center = density * mesh.volume, solid.center_mass
    place = complex(center[0], center[1])
    inertia = density * solid.moment_inertia
    about_axis = float(inertia[2, 2]) + mass * abs(place) ** 2
    return GearBody(mass, mass * place, about_axis, -complex(inertia[0, 2], inertia[1, 2]))


# --- holes ----------------------------------------------------------------------------------------------------------

MOST_PLACES = 200_000
"""Most points of a lattice: some two hundred holes along a gear's radius."""


@dataclass(frozen=True)
class Drills:
    """Limits of holes: diameters in mm, and the least wall between holes and to every edge."""

    largest_mm: float
    smallest_mm: float
    wall_mm: float


def drilled_holes(section: Polygon, moment_mm3: complex, drills: Drills, key: str) -> list[RoundHole]:
    """Holes in the gear's ``section`` in mm whose areas have ``moment_mm3`` about the axis, or as much of it as fits.

    Raises NoSuchMechanism for ``key`` where no hole has room, WrongInput for too many places of small holes.
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
    """The section with the holes, each a polygon that is enlarged to the area of its circle."""
    rings = []
    for hole in holes:
        points, center = hole_points(hole, chord_tolerance_mm), np.array([hole.x_mm, hole.y_mm])
        larger = sqrt(pi * hole.diameter_mm**2 / 4.0 / Polygon(points).area)
        rings.append(np.asarray(center + (points - center) * larger))
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
    """Areas of the holes in mm^2, each within [0, largest], with the moment or the largest share of it that fits."""
    scale = largest * float(np.abs(places).max())
    columns = np.vstack([places.real, places.imag]) * largest / scale
    target = np.array([moment.real, moment.imag]) / scale
    # The last unknown is the share of the moment; it counts more than all the material
    system = np.column_stack([columns, -target])
    cost = np.append(np.full(places.size, 1.0 / (places.size + 1.0)), -100.0)
    found = linprog(cost, A_eq=system, b_eq=np.zeros(2), bounds=(0.0, 1.0))
    if not found.success:
        raise Unanswered(f"the linear programme of the holes failed: {found.message}")
    return np.asarray(largest * found.x[:-1])


# --- boss -----------------------------------------------------------------------------------------------------------

SOLVED = 1e-9
"""Share of the moment that a boss may miss: rounding of areas of some thousand corners."""

SPARE, ADVISED = 1.02, 1.05
"""Moment that a room must be able to give for a boss, over the needed moment, and the same after taking the advice.
The moment is largest for a chord near the axis, where it hardly depends on the distance, and the distance cannot be
found (tests/test_gear_balance.py takes the advice)."""

STARTS = 33
"""Number of chord distances from which the search picks its start, and of directions in which the room is judged."""

WIDEST_RAD = 1.4
"""Largest angle from the needed moment at which the room is judged: beyond it, hardly any moment is needed."""


@dataclass(frozen=True, eq=False)
class Boss:
    """A boss: its outlines in the gear's frame and its height over the face, in mm."""

    section: MultiPolygon
    height_mm: float


def balancing_boss(section: Polygon, moment_mm4: complex, height_mm: float, wall_mm: float, key: str) -> Boss:
    """The lightest boss of a height in the ``section``, with a wall around, that has minus ``moment_mm4`` (not zero).

    Raises NoSuchMechanism for ``key`` where no boss is heavy enough; the message names a sufficient height.
    """
    needed, room = -moment_mm4 / height_mm, section.buffer(-wall_mm)
    most = _largest_multiple(room, needed)
    if most <= SPARE:
        hope = f"one of {ceil(ADVISED * height_mm / most)} mm would" if most > 0.0 else "there is no room for any"
        raise NoSuchMechanism(f"no boss of {height_mm:g} mm within the gear balances it; {hope}", key=key)
    return Boss(_beyond_solved_chord(room, needed), height_mm)


def _largest_multiple(room: BaseGeometry, needed: complex) -> float:
    """The largest multiple of the needed moment that a part of the room has: moments of parts form a convex set.

    The room beyond a chord through the axis has the farthest moment across the chord.
    """
    multiples = []
    for turn in np.linspace(-WIDEST_RAD, WIDEST_RAD, STARTS):
        direction = needed * np.exp(1j * turn)
        farthest = area_moments(_beyond(room, float(np.angle(direction)), 0.0)).first_mm3
        multiples.append((np.conj(direction) * farthest).real / (np.conj(direction) * needed).real)
    return float(min(multiples))


def _beyond_solved_chord(room: BaseGeometry, needed: complex) -> MultiPolygon:
    """The part of the room beyond a chord that has the moment.

    With the chord at l.p = 1, the dual is the integral of (l.p - 1) beyond it minus l.needed.  It is convex in l, and
    its gradient is the moment beyond the chord minus the needed moment.
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
        raise Unanswered("no chord gives the moment of the boss")
    return _chord(room, complex(found[0], found[1]) / reach)


def _chord(room: BaseGeometry, line: complex) -> MultiPolygon:
    """The part of a room beyond the line l.p = 1."""
    return _beyond(room, float(np.angle(line)), 1.0 / abs(line))


def _beyond(room: BaseGeometry, direction_rad: float, distance_mm: float) -> MultiPolygon:
    """The part of a room farther from the axis than a distance, measured in a direction."""
    reach = 2.0 * float(np.abs(room.bounds).max())
    half = rotate(
        shapely.box(distance_mm, -reach, 2.0 * reach, reach), direction_rad, origin=(0.0, 0.0), use_radians=True
    )
    parts = shapely.get_parts(room.intersection(half))
    return MultiPolygon([part for part in parts if isinstance(part, Polygon)])


# --- the corrected gear ---------------------------------------------------------------------------------------------

BALANCED = 1e-9
"""Share of area to the power 3/2 below which a first moment is rounding error and gives a boss no direction."""


@dataclass(frozen=True)
class BossSize:
    """Size of a boss: its height over the face and its wall to every edge, in mm."""

    height_mm: float
    wall_mm: float


@dataclass(frozen=True)
class Means:
    """Means to correct a gear: holes, a boss, or both."""

    drills: Drills | None = None
    boss: BossSize | None = None


@dataclass(frozen=True, eq=False)
class Corrected:
    """A corrected gear: its holes and boss, its mesh, and the body by the integrals of the mesh."""

    holes: list[RoundHole]
    boss: Boss | None
    mesh: TriangleMesh
    body: GearBody


def corrected(
    section: Polygon, face_width_mm: float, density_kg_m3: float, means: Means, tolerance_mm: float, key: str
) -> Corrected:
    """A straight gear with its section in mm, brought to balance about the origin as far as the means allow.

    ``tolerance_mm`` is the chord tolerance of the holes; ``key`` names the means in errors.  Raises NoSuchMechanism
    where a hole or a boss has no room, or the boss is too low.
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
