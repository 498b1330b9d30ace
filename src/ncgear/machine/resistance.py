"""The resistance against the slider in its working stroke, as a polynomial of the displacement."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.polynomial import Polynomial, polynomial

from ncgear.numerics import jet
from ncgear.numerics.arrays import Array
from ncgear.numerics.jet import Jet


@dataclass(frozen=True)
class Resistance:
    """Force in N against rising powers of the displacement in mm.

    A fit may be negative where there is nothing to press, as the published baler's is below 33.7 mm; a resistance
    cannot push, so negative values count as zero unless ``keep_negative``.
    """

    coefficients_n: tuple[float, ...] = (0.0,)
    keep_negative: bool = False

    def zeros_mm(self, stroke_mm: float) -> Array:
        """Displacements inside the stroke at which the polynomial is zero, in rising order."""
        zeros = Polynomial(self.coefficients_n).roots()
        real = zeros.real[np.abs(zeros.imag) < 1e-9 * stroke_mm]
        return np.sort(real[(real > 0.0) & (real < stroke_mm)])

    def negative_stretches_mm(self, stroke_mm: float) -> list[tuple[float, float]]:
        """Stretches of the stroke on which the polynomial is negative."""
        edges = [0.0, *self.zeros_mm(stroke_mm).tolist(), stroke_mm]
        force = Polynomial(self.coefficients_n)
        return [(low, high) for low, high in pairwise(edges) if force((low + high) / 2.0) < 0.0]

    def fitted_n(self, displacement: Jet) -> Jet:
        """The polynomial itself, with derivatives."""
        return jet.polynomial(self.coefficients_n, displacement)

    def force_n(self, displacement_mm: Array) -> Array:
        """Force in N at displacements in mm, any shape."""
        force = np.asarray(polynomial.polyval(displacement_mm, np.array(self.coefficients_n)))
        return force if self.keep_negative else np.maximum(force, 0.0)
