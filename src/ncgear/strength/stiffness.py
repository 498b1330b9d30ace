"""Stiffness of pairs of teeth: both teeth yield, and so do the flanks where they touch.

The stiffness of a pair is its face width over the sum of the compliances of both teeth for 1 N per mm of face width.
Flanks are flattened over the half-width of Hertz's contact of cylinders.  Their yielding grows a little slower than the
load: teeth of steel are about a tenth softer at a tenth of the load.  The stiffness is taken at the largest load of the
cycle, so that a pair is a linear spring.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from ncgear.dynamics.pair_places import PairPlaces
from ncgear.errors import Unanswered
from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array, ComplexArray, row_blocks
from ncgear.numerics.plane import along, as_complex
from ncgear.strength.contacts import FlankPlaces
from ncgear.strength.hertz import half_width_mm
from ncgear.strength.material import Material
from ncgear.strength.method import RootStress, ToothMethod
from ncgear.teeth.gear import ToothedGear, ToothedPair

NEWTON_STEPS = 12
"""Most steps to the height of a place on its flank; three suffice unless the curvature of the rolled curve jumps.  A
wrong height shows, since the place is then beside its flank."""

MET_IN_MODULES = 1e-10

SOFTER, STIFFER = 0.7, 1.3
"""The band of the stiffness of real teeth over the computed stiffness.  ISO 6336-1 takes a fifth off the computed
stiffness of solid gears to meet measurements (C_M = 0.8, from a secondary source); webs, shafts and the load for
Hertz's part may take another tenth.  The other way, finite elements are up to a sixth stiffer than the estimate
(docs/method.md); the band is as wide there as on the soft side."""

SHARPEST_IN_MODULES = 0.02
"""Least radius of a flattened contact: a flank that begins on its base circle, and any edge, wears to this radius
within a few turns."""

FLATTEST_IN_MODULES = 100.0
"""Greatest radius, of flanks that nearly fit each other; the half-width goes with its root only."""


@dataclass(frozen=True, eq=False)
class NearestOnFlanks:
    """The points of flanks nearest to n places, their heights and the derivatives by these; shape (n,) each."""

    height_mm: Array
    point: ComplexArray
    slope: ComplexArray


def nearest_on_flanks(gear: ToothedGear, places: FlankPlaces) -> NearestOnFlanks:
    """The points of the remaining flanks that are nearest to places."""
    flanks, number = gear.flanks, places.flank
    top, bottom = (limit[number] for limit in gear.sides.flank_range())
    origin, slope = (part[number] for part in flanks.at_pitch_line)
    # The flank's length is a h + b h^2 / 2 where the curvature of the rolled curve is constant.
    length, first = along(slope, places.point - origin) / np.abs(slope), np.abs(slope)
    turning = flanks.crossings.curvature[number]
    slant = flanks.slant.of(number)
    second = turning / (slant.sine * slant.height_per_rolled)
    height = 2.0 * length / (first + np.sqrt(np.maximum(first**2 + 2.0 * second * length, 0.0)))
    height = np.clip(height, bottom, top)
    point = np.empty_like(places.point)
    todo = np.arange(height.size)
    for _ in range(NEWTON_STEPS):
        at, leading = (as_complex(part) for part in flanks.flank(number[todo], height[todo]))
        nearer = height[todo] + along(leading, places.point[todo] - at) / np.abs(leading) ** 2
        nearer = np.clip(nearer, bottom[todo], top[todo])
        moved = np.abs(nearer - height[todo]) > MET_IN_MODULES * flanks.rack.module_mm
        height[todo], point[todo], slope[todo], todo = nearer, at, leading, todo[moved]
        if not todo.size:
            break
    return NearestOnFlanks(height, point, slope)


def on_flanks(gear: ToothedGear, places: FlankPlaces, height_mm: Array) -> tuple[FlankPlaces, Array]:
    """The places on flanks nearest to given places, with the flanks' own normals, and the flanks' curvatures there.

    Places with a height are on their flank already; others have NaN.  An edge is at the end of its flank, and a place
    on a fillet at the flank's other end.  Shape (n,) each.
    """
    edges = np.flatnonzero(np.isnan(height_mm))
    flanks, nearest, number = gear.flanks, nearest_on_flanks(gear, places.kept(edges)), places.flank[edges]
    crossing = as_complex(flanks.crossings.position)
    normal = 1j * nearest.slope / np.abs(nearest.slope)
    point, inwards, height = places.point.copy(), places.inwards.copy(), height_mm.copy()
    point[edges], height[edges] = nearest.point, nearest.height_mm
    inwards[edges] = normal * np.sign(along(normal, crossing[number ^ 1] - crossing[number]))
    return FlankPlaces(places.flank, point, inwards), flanks.curvature(places.flank, height)


@dataclass(frozen=True, eq=False)
class LinearTeeth:
    """The stiffness of each pair of teeth in N/mm, as a function of the places at which they touch.

    ``methods`` and ``materials`` belong to the driving and the driven gear; ``line_load_n_mm`` is the load per mm of
    face width for Hertz's part.
    """

    teeth: ToothedPair
    methods: tuple[ToothMethod, ToothMethod]
    materials: tuple[Material, Material]
    face_width_mm: float
    line_load_n_mm: float

    def __call__(self, places: PairPlaces) -> Array:
        """Stiffness in N/mm, shape (n,); raises Unanswered where a method gives none.

        Edges count as the ends of their flanks, so that the stiffness is continuous where contact passes to an edge.
        """
        (own, other), parts = self.methods, [np.empty(0)]
        for driving, driven, curvature in _placed(self.teeth, places):
            reach = self.reach_mm(curvature)
            parts.append(own.compliance(driving, reach) + other.compliance(driven, reach))
        given = np.concatenate(parts)
        if not np.all(np.isfinite(given) & (given > 0.0)):
            raise Unanswered("the compliance of a pair of teeth is not above 0")
        return np.asarray(self.face_width_mm / given)

    def reach_mm(self, curvature: Array) -> Array:
        """Half-width of the contact of flanks with a sum of curvatures in 1/mm, shape (n,)."""
        module = self.teeth.driving.flanks.rack.module_mm
        sharpest, flattest = 1.0 / (SHARPEST_IN_MODULES * module), 1.0 / (FLATTEST_IN_MODULES * module)
        load = np.full(curvature.shape, self.line_load_n_mm)
        return half_width_mm(load, np.clip(curvature, flattest, sharpest), self.materials)


@lru_cache(maxsize=4)
def _placed(teeth: ToothedPair, places: PairPlaces) -> list[tuple[FlankPlaces, FlankPlaces, Array]]:
    """Blocks of places on the driving and the driven flanks, and the sums of the flanks' curvatures; kept as gaps."""
    found = []
    for rows in row_blocks(places.driving_flank.size):
        some = places.kept(rows)
        driving = FlankPlaces(some.driving_flank, some.driving_point, some.driving_inwards)
        driven = FlankPlaces(some.driven_flank, some.driven_point, some.driven_inwards)
        driving, first = on_flanks(teeth.driving, driving, some.driving_mm)
        driven, second = on_flanks(teeth.driven, driven, some.driven_mm)
        found.append((driving, driven, first + second))
    return found


ISO_N_MM_UM = 14.0
"""The stiffness of a pair of steel teeth in N/(mm um) where no more is known: ISO 6336-1 for solid gears with the
standard rack (from a secondary source)."""

STEEL_MPA = 206e3


@dataclass(frozen=True, eq=False)
class EvenTeeth:
    """Teeth that give way alike everywhere, by ISO_N_MM_UM and their modulus: of them nothing else is known."""

    youngs_modulus_mpa: float
    name: str = "even"

    def compliance(self, places: FlankPlaces, reach_mm: Array) -> Array:
        """Way in mm by which flanks yield for 1 N per mm, shape (n,)."""
        return np.full(reach_mm.shape, 0.5 / (1e3 * ISO_N_MM_UM * self.youngs_modulus_mpa / STEEL_MPA))

    def root_stress(self, places: FlankPlaces) -> RootStress:
        """Raises Unanswered: nothing is known of the root."""
        raise Unanswered("teeth that are known by their stiffness alone have no root stress")
