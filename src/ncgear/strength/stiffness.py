"""How stiff pairs of teeth are: both teeth give way, and so do the flanks where they touch.

A pair is as stiff as its face width over the sum of what both teeth give way for 1 N per mm of face width.  Flanks are
flattened over the half-width of Hertz's contact of cylinders (K. L. Johnson, "Contact Mechanics", Cambridge 1985, 4.2),

    b^2 = 4 w / (pi E* k),   1/E* = (1 - nu1^2)/E1 + (1 - nu2^2)/E2

at the load w per mm of face width, k being the sum of both curvatures.  What they give way grows a little slower than
the load: by a fifth less at a tenth of the load.  The stiffness is taken at one load, the largest of the cycle, so that
a pair is a linear spring.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import pi, sin, sqrt

import numpy as np

from ncgear.dynamics.pair_places import PairPlaces
from ncgear.numerics.arrays import Array
from ncgear.numerics.plane import along, as_complex
from ncgear.strength.contacts import FlankPlaces
from ncgear.strength.material import Material
from ncgear.strength.method import RootStress, ToothMethod
from ncgear.teeth.gear import ToothedGear, ToothedPair

NEWTON_STEPS = 8
"""Steps to the height of a place on its flank; the start is right for a circular gear to the second order."""

SHARPEST_IN_MODULES = 0.02
"""Least radius at which a contact is flattened: a flank that begins on its base circle, and any edge, has worn as round
as that after a few turns."""

FLATTEST_IN_MODULES = 100.0
"""Greatest radius, of flanks that nearly fit each other; the half-width goes with its root only."""


def flank_heights_mm(gear: ToothedGear, places: FlankPlaces) -> Array:
    """Heights of the flanks' points nearest to places, within what is left of the flanks, shape (n,)."""
    flanks, rack = gear.flanks, gear.flanks.rack
    top, bottom = (limit[places.flank] for limit in gear.sides.flank_range())
    zero = np.zeros(places.flank.size)
    origin, slope = (as_complex(part) for part in flanks.flank(places.flank, zero))
    # The flank's length is a h + b h^2 / 2 where the curvature of what rolls does not change.
    length, first = along(slope, places.point - origin) / np.abs(slope), np.abs(slope)
    turning = flanks.at_rolled(places.flank, flanks.crossing_mm[places.flank]).curvature
    second = turning / (sin(rack.pressure_angle_rad) * rack.height_per_rolled)
    height = 2.0 * length / (first + np.sqrt(np.maximum(first**2 + 2.0 * second * length, 0.0)))
    for _ in range(NEWTON_STEPS):
        height = np.clip(height, bottom, top)
        point, slope = (as_complex(part) for part in flanks.flank(places.flank, height))
        height = height + along(slope, places.point - point) / np.abs(slope) ** 2
    return np.asarray(np.clip(height, bottom, top))


def relative_curvature(teeth: ToothedPair, driving: FlankPlaces, driven: FlankPlaces) -> Array:
    """Sum of both flanks' curvatures in 1/mm at places that touch, shape (n,); at edges that of the flanks' ends."""
    return _curvature(teeth.driving, driving) + _curvature(teeth.driven, driven)


def _curvature(gear: ToothedGear, places: FlankPlaces) -> Array:
    return gear.flanks.curvature(places.flank, flank_heights_mm(gear, places))


def contact_modulus_mpa(first: Material, second: Material) -> float:
    """E* of two bodies in contact."""
    return 1.0 / sum((1.0 - one.poisson**2) / one.youngs_modulus_mpa for one in (first, second))


@dataclass(frozen=True, eq=False)
class LinearTeeth:
    """The stiffness of each pair of teeth in N/mm, as a function of the places at which they touch.

    ``methods`` and ``materials`` are those of the driving and of the driven gear; ``line_load_n_mm`` is the load per mm
    of face width for which Hertz's part is taken.
    """

    teeth: ToothedPair
    methods: tuple[ToothMethod, ToothMethod]
    materials: tuple[Material, Material]
    face_width_mm: float
    line_load_n_mm: float

    def __call__(self, places: PairPlaces) -> Array:
        """Stiffness in N/mm, shape (n,); raises ArithmeticError where a method gives none."""
        driving = FlankPlaces(places.driving_flank, places.driving_point, places.driving_inwards)
        driven = FlankPlaces(places.driven_flank, places.driven_point, places.driven_inwards)
        reach = self.reach_mm(relative_curvature(self.teeth, driving, driven))
        own, other = (
            method.compliance(part, reach) for method, part in zip(self.methods, (driving, driven), strict=True)
        )
        given: Array = own + other
        if not np.all(np.isfinite(given) & (given > 0.0)):
            raise ArithmeticError("the compliance of a pair of teeth is not above 0")
        return self.face_width_mm / given

    def reach_mm(self, curvature: Array) -> Array:
        """Half-width of the contact of flanks with a sum of curvatures in 1/mm, shape (n,)."""
        module = self.teeth.driving.flanks.rack.module_mm
        radius = 1.0 / np.clip(curvature, 1.0 / (FLATTEST_IN_MODULES * module), 1.0 / (SHARPEST_IN_MODULES * module))
        factor = 4.0 * self.line_load_n_mm / (pi * contact_modulus_mpa(*self.materials))
        return np.asarray(sqrt(factor) * np.sqrt(radius))


@dataclass(frozen=True, eq=False)
class EvenTeeth:
    """Teeth that give way alike everywhere: ISO 6336-1's 14 N/(mm um) for a pair of steel, by the modulus for others.

    That value is for solid gears of steel with the standard rack, where no more is known (from a secondary source).
    """

    youngs_modulus_mpa: float
    name: str = "even"

    def compliance(self, places: FlankPlaces, reach_mm: Array) -> Array:
        """How far flanks give way in mm for 1 N per mm, shape (n,)."""
        return np.full(reach_mm.shape, 0.5 / (14e3 * self.youngs_modulus_mpa / 206e3))

    def root_stress(self, places: FlankPlaces) -> RootStress:
        """Nothing is known of the root."""
        raise NotImplementedError
