"""The resistance against the slider in its working stroke, as a polynomial of the displacement."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.polynomial import polynomial

from ncgear.numerics import jet
from ncgear.numerics.arrays import Array
from ncgear.numerics.jet import Jet


@dataclass(frozen=True)
class Resistance:
    """Force in N against rising powers of the displacement in mm.

    A fit may be negative where there is nothing to press, as the published baler's is below 33.4 mm; a resistance
    cannot push, so negative values count as zero unless ``keep_negative``.
    """

    coefficients_n: tuple[float, ...] = (0.0,)
    keep_negative: bool = False

    def fitted_n(self, displacement: Jet) -> Jet:
        """The polynomial itself, with derivatives."""
        return jet.polynomial(self.coefficients_n, displacement)

    def force_n(self, displacement_mm: Array) -> Array:
        """Force in N at displacements in mm, any shape."""
        force = np.asarray(polynomial.polyval(displacement_mm, np.array(self.coefficients_n)))
        return force if self.keep_negative else np.maximum(force, 0.0)
