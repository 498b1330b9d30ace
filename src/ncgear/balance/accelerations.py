"""The few functions of the driving angle of which all shaking forces and moments of a crank-slider are sums.

By the driving angle, with the pin c = r exp(-i q), the wrist w = x + i e, the rod's angle b and the share d of a mass
on the rod, the place (1 - d) c + d w has the second derivative (1 - d) c'' + d x'', and its moment of acceleration
about the axis is

    Im(conj(p) p'') = |1 - d|^2 Im(conj(c) c'') + |d|^2 Im(conj(w) w'') + Im(K conj(c) w'' + conj(K) conj(w) c''),
    K = conj(1 - d) d,  Im(conj(c) c'') = -r^2 q'',  Im(conj(w) w'') = -e x''

So counterweights change coefficients only, and one resolved form serves them all.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ncgear.balance.mechanism import Mechanism, as_complex
from ncgear.numerics import chebyshev
from ncgear.numerics.arrays import Array
from ncgear.numerics.chebyshev import PiecewiseChebyshev

PIN_X, PIN_Y, WRIST, CRANK, ROD, TOGETHER, ASIDE = range(7)
"""Rows of the functions: c''/r, x''/r, q'', b'', Im(conj(c) w'' + conj(w) c'')/(r l), Re(conj(c) w'' - conj(w) c'')/(r
l).

All are near one, so that each is resolved as well as the others."""


@dataclass(frozen=True, eq=False)
class Accelerations:
    """The functions on one cycle; ``form`` has values of shape (7,)."""

    form: PiecewiseChebyshev

    def combined(self, weights: Array) -> PiecewiseChebyshev:
        """Sums of the functions, ``weights`` of shape (7,) or (7, k)."""
        return PiecewiseChebyshev(self.form.breaks, self.form.coefficients @ weights)


def accelerations(mechanism: Mechanism) -> Accelerations:
    """The functions of a mechanism, resolved to rounding error; its masses do not matter.

    Raises NotSmooth where the law's second derivative is not finite.
    """
    return Accelerations(chebyshev.fitted(lambda phi1: functions_at(mechanism, phi1), mechanism.breaks_rad))


def functions_at(mechanism: Mechanism, phi1_rad: Array) -> Array:
    """The functions at driving angles of shape (n,), shape (n, 7)."""
    crank, rod, at = mechanism.linkage.crank_mm, mechanism.linkage.rod_mm, mechanism.bodies(phi1_rad)
    pin, wrist = (as_complex(place, 0) for place in (at.pin, at.wrist))
    pin_2, wrist_2 = (as_complex(place, 2) for place in (at.pin, at.wrist))
    one, other = np.conj(pin) * wrist_2, np.conj(wrist) * pin_2
    both = (one + other).imag / (crank * rod), (one - other).real / (crank * rod)
    alone = at.crank_angle.derivative(2), at.rod_angle.derivative(2)
    return np.column_stack([pin_2.real / crank, pin_2.imag / crank, wrist_2.real / crank, *alone, *both])
