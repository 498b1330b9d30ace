"""Discs in the complex plane, and their images by formulas: bounds from which no feature of a formula can hide.

A formula that takes a disc about a stretch of the real line into a finite disc is analytic on it, and its values lie
within the radius of the value in the middle.  The rules take a disc into a disc that holds all images; sizes are true
but for rounding errors, which do not matter where a size counts by its power of ten.  Every centre is real, since
formulas are.  Source: I. Gargantini and P. Henrici, "Circular arithmetic and the determination of polynomial zeros",
Numerische Mathematik 18 (1972), 305-320; for functions the radius is that of the power series about the centre with all
terms taken as positive.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array

FAR = 600.0
"""Exponentials with a larger real part count as far from zero rather than as a disc: exp(600) is 4e260."""


@dataclass(frozen=True, eq=False)
class Disc:
    """Numbers within ``radius`` of a real ``center``, each of shape (n,); an infinite radius says nothing.

    Where the radius is infinite, the numbers have at least the size ``far``, which may be zero.  With ``real`` only
    the real numbers among them are meant, and roots may begin at zero.
    """

    center: Array
    radius: Array
    far: Array
    real: bool

    @staticmethod
    def about(center: Array, radius: Array, *, real: bool) -> Disc:
        """Discs about centres."""
        return Disc(center, radius, np.zeros_like(center), real)

    def made(self, center: Array, radius: Array, far: Array | float = 0.0) -> Disc:
        """Other discs of the same kind; where a number is not finite, only ``far`` is known."""
        known = np.isfinite(center) & np.isfinite(radius)
        away = np.where(known | ~(np.asarray(far) > 0.0), 0.0, far)
        return Disc(np.where(known, center, 0.0), np.where(known, radius, np.inf), away, self.real)

    @property
    def largest(self) -> Array:
        """Bound of the size from above."""
        return np.abs(self.center) + self.radius

    @property
    def least(self) -> Array:
        """Bound of the size from below, at least zero."""
        return np.maximum(np.abs(self.center) - self.radius, self.far)

    def __neg__(self) -> Disc:
        return Disc(-self.center, self.radius, self.far, self.real)

    def __add__(self, other: Disc | float) -> Disc:
        if not isinstance(other, Disc):
            return self.made(self.center + other, self.radius, self.far - abs(other))
        far = np.maximum(self.far - other.largest, other.far - self.largest)
        return self.made(self.center + other.center, self.radius + other.radius, far)

    __radd__ = __add__

    def __sub__(self, other: Disc | float) -> Disc:
        return self + (-other)

    def __rsub__(self, other: float) -> Disc:
        return (-self) + other

    def __mul__(self, other: Disc | float) -> Disc:
        if not isinstance(other, Disc):
            return self.made(self.center * other, self.radius * abs(other), self.far * abs(other))
        radius = np.abs(self.center) * other.radius + self.radius * other.largest
        return self.made(self.center * other.center, radius, self.least * other.least)

    __rmul__ = __mul__


def quotient(over: Disc | float, under: Disc | float) -> Disc:
    """A quotient; nothing is known where the divisor's disc holds zero."""
    if not isinstance(under, Disc):
        assert isinstance(over, Disc)
        return over * (1.0 / under)
    share = under.radius / np.abs(under.center)
    sound = share < 1.0
    inverse = 1.0 / under.center / (1.0 - share**2)
    center = np.where(sound, inverse, np.where(under.far > 0.0, 0.0, np.nan))
    radius = np.where(sound, np.abs(inverse) * share, 1.0 / under.far)
    return under.made(center, radius) * over


def power(base: Disc, exponent: float) -> Disc:
    """A constant power; whole powers of every disc, others of discs to the right of zero."""
    center, radius = base.center, base.radius
    if exponent.is_integer():
        if exponent < 0.0:
            return quotient(1.0, power(base, -exponent))
        size = np.abs(center)
        return base.made(center**exponent, (size + radius) ** exponent - size**exponent, base.least**exponent)
    share = radius / center
    inner = base.made(center**exponent, center**exponent * ((1.0 - share) ** -abs(exponent) - 1.0))
    return _from_the_right(base, inner, lambda value: value**exponent, begins=exponent > 0.0)


def _from_the_right(base: Disc, inner: Disc, function: Callable[[Array], Array], *, begins: bool) -> Disc:
    """``inner`` where a disc is to the right of zero.

    Elsewhere nothing is known, unless only real numbers are meant and the rising ``function`` begins at zero: then the
    formula has no value at negative numbers, and the numbers from zero to the right end remain.
    """
    right = base.center > base.radius
    center, radius = np.where(right, inner.center, np.nan), np.where(right, inner.radius, np.inf)
    if base.real and begins:
        half = function(np.maximum(base.center + base.radius, 0.0)) / 2.0
        center, radius = np.where(right, center, half), np.where(right, radius, half)
    return base.made(center, radius)


def _exp(u: Disc) -> Disc:
    low = u.center - u.radius
    far = np.where(low > FAR, np.exp(FAR), 0.0)
    size = np.where(low > FAR, np.inf, np.exp(u.center))
    return u.made(size, np.where(u.radius < 1.0, size * np.expm1(u.radius), np.exp(u.center + u.radius)), far)


def _sin(u: Disc) -> Disc:
    return _turned(u, np.sin(u.center), np.abs(np.cos(u.center)))


def _cos(u: Disc) -> Disc:
    return _turned(u, np.cos(u.center), np.abs(np.sin(u.center)))


def _turned(u: Disc, value: Array, slope: Array) -> Disc:
    """A sine by its value and its slope's size at the centre."""
    return u.made(value, slope * np.sinh(u.radius) + np.abs(value) * (np.cosh(u.radius) - 1.0))


def _hyperbolic(u: Disc, value: Array, slope: Array) -> Disc:
    """A hyperbolic function by its value and its slope's size at the centre; at least sinh of the real part's size."""
    away = np.abs(u.center) - u.radius > FAR
    radius = slope * np.sinh(u.radius) + np.abs(value) * (np.cosh(u.radius) - 1.0)
    return u.made(np.where(away, np.inf, value), radius, np.where(away, np.sinh(FAR), 0.0))


def _tanh(u: Disc) -> Disc:
    """1 - 2/(exp(2u) + 1) to the right of zero, and the negative of that to the left."""
    side = np.where(u.center < 0.0, -1.0, 1.0)
    right = quotient(2.0, _exp(Disc(-2.0 * np.abs(u.center), 2.0 * u.radius, 0.0 * side, u.real)) + 1.0)
    return u.made(side * (right.center - 1.0), right.radius)


def _atan(u: Disc) -> Disc:
    """By the mean value: the largest 1/(1 + u^2) of the disc times its radius."""
    slope = quotient(1.0, power(u, 2.0) + 1.0)
    return u.made(np.arctan(u.center), slope.largest * u.radius)


DISC_FUNCTIONS: Mapping[str, Callable[..., Any]] = {
    "/": quotient,
    "power": power,
    "sin": _sin,
    "cos": _cos,
    "tan": lambda u: quotient(_sin(u), _cos(u)),
    "exp": _exp,
    "log": lambda u: _from_the_right(
        u, u.made(np.log(u.center), -np.log1p(-u.radius / u.center)), np.log, begins=False
    ),
    "sqrt": lambda u: power(u, 0.5),
    "atan": _atan,
    "sinh": lambda u: _hyperbolic(u, np.sinh(u.center), np.cosh(u.center)),
    "cosh": lambda u: _hyperbolic(u, np.cosh(u.center), np.abs(np.sinh(u.center))),
    "tanh": _tanh,
}
"""The functions of formulas without choices."""
