"""Flank tolerances of ISO 1328-1:2013 by class, here for every tooth of a non-circular gear.

Source: ISO 1328-1:2013, clause 5, formulas 5 to 10, with the step from class to class of 5.2.2 and the rounding of
5.2.3 (from secondary sources: the same formulas, with their numbers, in two independent public programs, one of which
prints the example of tests/test_tolerances.py).  In micrometres, with lengths in mm, before the step of the class:

    single pitch       f_pT = 0.001 d + 0.4 m + 5
    cumulative pitch   F_pT = 0.002 d + 0.55 sqrt(d) + 0.7 m + 12
    profile slope      f_HalphaT = 0.4 m + 0.001 d + 4
    profile form       f_falphaT = 0.55 m + 5
    total profile      F_alphaT = sqrt(f_HalphaT^2 + f_falphaT^2)
    helix slope        f_HbetaT = 0.05 sqrt(d) + 0.35 sqrt(b) + 4

The standard knows circular gears only.  For each tooth of a non-circular gear, the local radius of curvature of the
pitch curve stands for the radius of the pitch circle.  Where the curve is flat or hollow, the largest diameter of the
gear stands for the diameter.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array

if TYPE_CHECKING:
    from ncgear.teeth.gear import ToothedGear

CLASSES = 1, 11
"""The finest and the coarsest class."""

MODULES_MM = 0.5, 70.0
DIAMETERS_MM = 5.0, 15_000.0
TEETH = 5, 1000
"""The ranges of validity of the formulas; the standard forbids to use them beyond."""

MM_PER_UM = 1e-3


@dataclass(frozen=True, eq=False)
class FlankTolerances:
    """Tolerances in mm, not rounded, in the shape of the given diameters."""

    single_pitch_mm: Array
    profile_slope_mm: Array
    profile_form_mm: Array

    @property
    def total_profile_mm(self) -> Array:
        """F_alphaT, formula 9."""
        return np.hypot(self.profile_slope_mm, self.profile_form_mm)


def flank_tolerances(grade: int, diameter_mm: Array, module_mm: float) -> FlankTolerances:
    """The tolerances of a class for diameters of the pitch circle in mm, of any shape."""
    step = MM_PER_UM * 2.0 ** ((grade - 5) / 2.0)
    return FlankTolerances(
        single_pitch_mm=step * (0.001 * diameter_mm + 0.4 * module_mm + 5.0),
        profile_slope_mm=step * (0.4 * module_mm + 0.001 * diameter_mm + 4.0),
        profile_form_mm=step * np.full(np.shape(diameter_mm), 0.55 * module_mm + 5.0),
    )


def helix_slope_mm(grade: int, diameter_mm: float, width_mm: float) -> float:
    """f_HbetaT of a class in mm, not rounded: the most that a flank is askew over a face width from 4 to 1200 mm."""
    base = 0.05 * diameter_mm**0.5 + 0.35 * width_mm**0.5 + 4.0
    return float(MM_PER_UM * 2.0 ** ((grade - 5) / 2.0) * base)


def rounded_um(tolerance_mm: float) -> float:
    """A tolerance in micrometres as drawings give it (5.2.3): a whole number above 10, halves from 5, tenths below."""
    value = tolerance_mm / MM_PER_UM
    parts = 1.0 if value > 10.0 else 2.0 if value >= 5.0 else 10.0
    return float(np.floor(parts * value + 0.5) / parts)


def tooth_diameters_mm(gear: ToothedGear) -> Array:
    """Diameters of curvature where flanks cross, (flanks,); the largest where the curve is flat or hollow."""
    flanks = gear.flanks
    curvature = flanks.crossings.curvature
    toothed = flanks.crossings.position[flanks.is_made]
    largest = 2.0 * float(np.linalg.norm(toothed, axis=-1).max())
    local = 2.0 / np.maximum(curvature, 2.0 / largest)
    return np.asarray(np.clip(local, *DIAMETERS_MM))
