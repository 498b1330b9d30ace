"""Places on flanks and materials for the tests of strength."""

from __future__ import annotations

from functools import cache

import numpy as np

from ncgear.numerics.arrays import Array, IndexArray
from ncgear.numerics.plane import as_complex
from ncgear.strength.contacts import FlankPlaces
from ncgear.strength.material import EnduredStress, Material, MaterialFamily
from ncgear.teeth.form import TipLimits, ToothForm
from ncgear.teeth.gear import ToothedGear, ToothedPair, toothed_pair
from pairs import pitch_pair, rack, sine_law


def elastic(youngs_modulus_mpa: float, poisson: float) -> Material:
    """A material of which only the elastic constants matter."""
    endured = EnduredStress(np.array([1.0, 2.0]), np.array([1.0, 1.0]))
    return Material("elastic", MaterialFamily.STEEL, youngs_modulus_mpa, poisson, 7830.0, None, endured, "a test")


STEEL = elastic(206e3, 0.3)


@cache
def circular_pair(teeth: int, shift: float = 0.0, dedendum: float = 1.25, root_radius: float = 0.38) -> ToothedPair:
    """Two circular gears of module 2, of equal numbers of teeth and opposite shifts in modules, undercut if need be."""
    form = ToothForm(
        rack(20.0, 1.0, dedendum, root_radius), 2.0 * shift, -2.0 * shift, limits=TipLimits(avoid_undercut=False)
    )
    return toothed_pair(pitch_pair(sine_law(0.0), teeth), form, 0.005)


def places_at(gear: ToothedGear, flank: IndexArray, height_mm: Array) -> FlankPlaces:
    """Places on flanks at heights over the pitch point, shape (n,) each, with the exact normals.

    From a front flank's rise the material is a quarter turn away, in the sense from the pitch curve's tangent to its
    normal; from a back flank's it is so in the other sense.
    """
    point, rise = (as_complex(array) for array in gear.flanks.flank(flank, height_mm))
    start = gear.flanks.curve.at_length(np.zeros(1))
    quarter = as_complex(start.normal) / as_complex(start.tangent)
    return FlankPlaces(flank, point, rise / np.abs(rise) * quarter * gear.flanks.side[flank])


def random_places(gear: ToothedGear, count: int, seed: int = 0) -> tuple[FlankPlaces, Array]:
    """Places all over the working flanks, and their heights."""
    rng = np.random.default_rng(seed)
    top, bottom = gear.sides.flank_range()
    flank = rng.integers(0, gear.flanks.count, count)
    height = bottom[flank] + (top[flank] - bottom[flank]) * rng.random(count)
    return places_at(gear, flank, height), height
