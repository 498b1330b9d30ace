"""The law of a return: a polynomial that stands for the ratio or for its inverse."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.polynomial import Polynomial

from ncgear.numerics import chebyshev, jet
from ncgear.numerics.arrays import Array
from ncgear.numerics.chebyshev import NotSmooth, PiecewiseChebyshev
from ncgear.numerics.jet import Jet
from ncgear.ratio.compensation.ends import ReturnEnds, not_positive


@dataclass(frozen=True, eq=False)
class ReturnLaw:
    """The closed return: a polynomial in tau is i12, or 1/i12 when ``inverse`` is true.

    Its coefficients may be 1e5 times its smallest value, so they are those ``about`` the place of that, in powers of
    tau - about; there the constant term is the value.  ``correction``, which closes the cycle to rounding error, is
    in tau and kept by itself, since it would be rounded off.
    """

    ends: ReturnEnds
    local: Polynomial
    inverse: bool
    about: float = 0.0
    correction: Polynomial = field(default_factory=lambda: Polynomial([0.0]))

    @property
    def polynomial(self) -> Polynomial:
        """The polynomial in powers of tau."""
        whole: Polynomial = self.local(Polynomial([-self.about, 1.0])) + self.correction
        return whole

    @property
    def extrapolated_ratio(self) -> float:
        """The polynomial's value at phi1 = 0, the published method's e."""
        origin = -self.ends.start_rad / self.ends.length_rad
        return float(self.local(origin - self.about) + self.correction(origin))

    def slope(self, phi1: Array, order: int) -> Jet:
        """dphi2/dphi1 = 1/i12 with derivatives."""
        tau = (Jet.variable(phi1, order) - self.ends.start_rad) * (1.0 / self.ends.length_rad)
        local, fine = (np.asarray(part.coef, dtype=float) for part in (self.local, self.correction))
        value = jet.polynomial(local, tau - self.about) + jet.polynomial(fine, tau)
        return value if self.inverse else 1.0 / value

    def driven_angle(self, phi1: Array, order: int) -> Jet:
        """phi2 with derivatives; the integral is spectral, to rounding error."""
        values = self.ends.start_driven_rad + self._driven_integral(phi1)
        if order == 0:
            return Jet(values[None, :])
        return self.slope(phi1, order - 1).integrated(values)

    @cached_property
    def _driven_integral(self) -> PiecewiseChebyshev:
        ends = (self.ends.start_rad, self.ends.end_rad)
        try:
            return chebyshev.fitted(lambda phi1: self.slope(phi1, 0).value, ends).integrated()
        except NotSmooth as fault:
            raise not_positive(fault.at, self.ends) from fault

    @property
    def closure_error_rad(self) -> float:
        """Driven angle of the return minus what it should be."""
        return self._driven_integral.final - self.ends.driven_length_rad
