"""A resistance whose force is a polynomial of the displacement."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.polynomial import Polynomial

from ncgear.machine.resistance import Resistance, within
from ncgear.numerics import jet
from ncgear.numerics.arrays import Array
from ncgear.numerics.jet import Jet


@dataclass(frozen=True)
class PolynomialResistance(Resistance):
    """Force in N against rising powers of the displacement in mm; without coefficients, no resistance."""

    coefficients_n: tuple[float, ...] = (0.0,)
    keep_negative: bool = False

    def fitted_n(self, displacement: Jet) -> Jet:
        """The polynomial itself, with derivatives."""
        return jet.polynomial(self.coefficients_n, displacement)

    def work_from_retracted_n_mm(self, displacement_mm: Array, stroke_mm: float) -> Array:
        """The antiderivative of the polynomial."""
        work: Array = Polynomial(self.coefficients_n).integ()(displacement_mm)
        return work

    def zeros_mm(self, stroke_mm: float) -> Array:
        """Real zeros inside the stroke."""
        return _real_zeros(Polynomial(self.coefficients_n), stroke_mm)

    def turns_mm(self, stroke_mm: float) -> Array:
        """Real zeros of the derivative inside the stroke."""
        return _real_zeros(Polynomial(self.coefficients_n).deriv(), stroke_mm)


def _real_zeros(curve: Polynomial, stroke_mm: float) -> Array:
    zeros = curve.roots()
    return within(zeros.real[np.abs(zeros.imag) < 1e-9 * stroke_mm], stroke_mm)
