"""Taylor arithmetic: values and exact derivatives of composed functions, over whole arrays of angles at once.

A jet holds the coefficients f(t0), f'(t0), f''(t0)/2!, ... of a function at each of many points t0.  Every rule
below is the recurrence of the power series itself, so a derivative is as exact as the value: no difference quotient
and no symbolic expansion is involved.  Source of the recurrences: A. Griewank and A. Walther, "Evaluating
Derivatives", 2nd edition, SIAM 2008, table 13.2.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from math import factorial

import numpy as np
from numpy.typing import ArrayLike

from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array, Mask


@dataclass(frozen=True, eq=False)
class Jet:
    """Truncated Taylor series of one function at many points.

    ``coefficients`` has shape (order + 1, n): row k is the k-th derivative divided by k!.  A rule that takes a number
    also takes an array of shape (n,), one number for each point.  Points may lie in an array of more axes, shape
    (..., n): numbers of shape (n,) then belong to all points of a column.
    """

    coefficients: Array

    def __init__(self, coefficients: Array) -> None:
        # As dataclasses do, in less time.
        self.__dict__["coefficients"] = coefficients

    __array_ufunc__ = None
    """Makes numpy leave the arithmetic to the jet where an array stands to its left."""

    @staticmethod
    def variable(points: ArrayLike, order: int) -> Jet:
        """The independent variable itself at ``points`` (shape (n,) or (..., n)): value t, derivative 1."""
        values = np.atleast_1d(np.asarray(points, dtype=float))
        coefficients = np.zeros((order + 1, *values.shape))
        coefficients[0] = values
        if order:
            coefficients[1] = 1.0
        return Jet(coefficients)

    @property
    def order(self) -> int:
        """Highest derivative carried."""
        return len(self.coefficients) - 1

    @property
    def value(self) -> Array:
        """The function's values, shape (n,)."""
        return self.coefficients[0]

    def derivative(self, k: int = 1) -> Array:
        """The k-th derivative, shape (n,); k at most ``order``."""
        return self.coefficients[k] * factorial(k)

    def differentiated(self) -> Jet:
        """The derivative as a jet of one order less."""
        return Jet(_slopes(self.coefficients))

    def integrated(self, values: Array) -> Jet:
        """The antiderivative with the given values (shape (n,)), one order more."""
        divisors = _counted(self.coefficients)
        return Jet(np.concatenate([values[None], self.coefficients / divisors]))

    def truncated(self, order: int) -> Jet:
        """The same series cut at ``order``."""
        return Jet(self.coefficients[: order + 1])

    def __neg__(self) -> Jet:
        return Jet(-self.coefficients)

    def __add__(self, other: Jet | float | Array) -> Jet:
        if isinstance(other, Jet):
            return Jet(self.coefficients + other.coefficients)
        return Jet(_raised(self.coefficients.copy(), other))

    __radd__ = __add__

    def __sub__(self, other: Jet | float | Array) -> Jet:
        if isinstance(other, Jet):
            return Jet(self.coefficients - other.coefficients)
        return self + (-other)

    def __rsub__(self, other: float | Array) -> Jet:
        return Jet(_raised(-self.coefficients, other))

    def __mul__(self, other: Jet | float | Array) -> Jet:
        if not isinstance(other, Jet):
            return Jet(self.coefficients * other)
        return Jet(_product(self.coefficients, other.coefficients, len(self.coefficients)))

    __rmul__ = __mul__

    def __truediv__(self, other: Jet | float | Array) -> Jet:
        if not isinstance(other, Jet):
            return Jet(self.coefficients / other)
        a, b = self.coefficients, other.coefficients
        quotient = a.copy() if a.shape == b.shape else np.broadcast_to(a, np.broadcast_shapes(a.shape, b.shape)).copy()
        for k in range(len(a) - 1):
            row, rest = quotient[k], quotient[k + 1 :]
            row /= b[0]
            rest -= row * b[1 : len(a) - k]
        quotient[-1] /= b[0]
        return Jet(quotient)

    def __pow__(self, exponent: float) -> Jet:
        """A constant power; the values must be positive unless the exponent is a whole number that is not negative.

        At zero the derivatives below the exponent are zero, and the others infinite.
        """
        if float(exponent).is_integer() and exponent >= 0:
            return _whole_power(self, int(exponent))
        a = self.coefficients
        power = np.empty_like(a)
        power[0] = a[0] ** exponent
        for k in range(1, len(a)):
            terms = (((exponent + 1.0) * j - k) * a[j] * power[k - j] for j in range(1, k + 1))
            power[k] = 0.0 if k < exponent else np.inf
            np.divide(sum(terms), k * a[0], out=power[k], where=a[0] != 0.0)
        return Jet(power)

    def __rtruediv__(self, other: float | Array) -> Jet:
        numerator = np.zeros_like(self.coefficients)
        numerator[0] = other
        return Jet(numerator) / self


def sqrt(argument: Jet) -> Jet:
    """Square root; the argument's values must be positive."""
    a = argument.coefficients
    root = np.empty_like(a)
    root[0] = np.sqrt(a[0])
    twice = 2.0 * root[0]
    for k in range(1, len(a)):
        rest = a[k] - _paired(root[1:k], root[1:k]) if k > 1 else a[k]
        np.divide(rest, twice, out=root[k])
    return Jet(root)


def sin_cos(argument: Jet) -> tuple[Jet, Jet]:
    """Sine and cosine together, since each one's recurrence needs the other."""
    values = argument.value
    return _pair(argument.coefficients, np.sin(values), np.cos(values), -1.0)


def sine_versine(argument: Jet) -> tuple[Jet, Jet]:
    """Sine and 1 - cosine together, from half the angle: the versine is relatively accurate at its zeros."""
    half = np.sin(0.5 * argument.value)
    versine = 2.0 * half * half
    sine, cosine = _pair(argument.coefficients, 2.0 * half * np.cos(0.5 * argument.value), 1.0 - versine, -1.0)
    rows = np.negative(cosine.coefficients, out=cosine.coefficients)
    rows[0] = versine
    return sine, cosine


def sinh_cosh(argument: Jet) -> tuple[Jet, Jet]:
    """Hyperbolic sine and cosine together, since each one's recurrence needs the other."""
    values = argument.value
    return _pair(argument.coefficients, np.sinh(values), np.cosh(values), 1.0)


def _pair(a: Array, odd: Array, even: Array, sign: float) -> tuple[Jet, Jet]:
    """Two functions by their values: the derivative of the odd one is the even one, and ``sign`` times the odd one."""
    sine, cosine = np.empty_like(a), np.empty_like(a)
    sine[0], cosine[0] = odd, even
    count = _rows(a) - 1
    slopes = _slopes(a[: count + 1])
    for k in range(1, len(a)):
        last = max(k - count, 0)
        np.divide(_paired(slopes[: k - last], cosine[last:k]), k, out=sine[k])
        np.divide(_paired(slopes[: k - last], sine[last:k]), sign * k, out=cosine[k])
    return Jet(sine), Jet(cosine)


def tanh(argument: Jet) -> Jet:
    """Hyperbolic tangent, by t' = u' / cosh(u)^2 for its slope and t'' after it; finite for every argument."""
    a = argument.coefficients
    value, slope = np.empty_like(a), np.empty_like(a)
    value[0], slope[0] = np.tanh(a[0]), np.exp(-2.0 * np.logaddexp(a[0], -a[0]) + 2.0 * np.log(2.0))
    slopes = _slopes(a)
    for k in range(1, len(a)):
        value[k] = _paired(slopes[:k], slope[:k]) / k
        slope[k] = -_paired(value[: k + 1], value[: k + 1])
    return Jet(value)


def _counted(rows: Array) -> Array:
    """1, 2, ... for the rows, in a shape that multiplies rows."""
    return _counts(len(rows), rows.ndim)


@cache
def _counts(count: int, axes: int) -> Array:
    return np.arange(1.0, count + 1.0).reshape(-1, *[1] * (axes - 1))


def _slopes(coefficients: Array) -> Array:
    return coefficients[1:] * _counted(coefficients[1:])


def _paired(rising: Array, falling: Array) -> Array:
    """Sum of products of rows: the first of one times the last of the other and so on; shape (n,)."""
    if len(rising) == 1:
        return np.asarray(rising[0] * falling[0])
    return np.asarray(np.add.reduce(rising * falling[::-1]))


def _product(a: Array, b: Array, count: int) -> Array:
    """Product of two series, of which the first one is zero but for so many rows."""
    product = a[0] * b
    for j in range(1, count):
        rest = product[j:]
        rest += a[j] * b[:-j]
    return product


def _raised(coefficients: Array, by: float | Array) -> Array:
    """The series itself, with a number added to its values."""
    values = coefficients[0]
    values += by
    return coefficients


def _rows(a: Array) -> int:
    """How many rows of a series count: a straight argument, which is the usual one, has a single slope."""
    return len(a) if len(a) < 3 or a[2:].any() else 2


def _whole_power(base: Jet, exponent: int) -> Jet:
    if exponent == 0:
        return base * 0.0 + 1.0
    result = base
    for bit in bin(exponent)[3:]:
        result = result * result
        if bit == "1":
            result = result * base
    return result


def exp(argument: Jet) -> Jet:
    """Exponential function."""
    a = argument.coefficients
    power = np.empty_like(a)
    power[0] = np.exp(a[0])
    slopes = _slopes(a)
    for k in range(1, len(a)):
        power[k] = _paired(slopes[:k], power[:k]) / k
    return Jet(power)


def log(argument: Jet) -> Jet:
    """Natural logarithm; the argument's values must be positive."""
    values = np.log(argument.value)
    if argument.order == 0:
        return Jet(values[None, :])
    return (argument.differentiated() / argument.truncated(argument.order - 1)).integrated(values)


def arctan(argument: Jet) -> Jet:
    """Inverse tangent: the derivative u' / (1 + u^2), integrated term by term."""
    values = np.arctan(argument.value)
    if argument.order == 0:
        return Jet(values[None, :])
    shorter = argument.truncated(argument.order - 1)
    return (argument.differentiated() / (shorter * shorter + 1.0)).integrated(values)


def polynomial(coefficients: Sequence[float] | Array, argument: Jet) -> Jet:
    """Polynomial by Horner, ``coefficients`` from the constant term up, (m,), or (m, n) with one for each point."""
    if len(coefficients) == 1:
        return argument * 0.0 + coefficients[0]
    a, count = argument.coefficients, _rows(argument.coefficients)
    result = _raised(a * coefficients[-1], coefficients[-2])
    for coefficient in reversed(coefficients[:-2]):
        result = _raised(_product(a, result, count), coefficient)
    return Jet(result)


def joined(parts: Sequence[tuple[Mask, Jet]]) -> Jet:
    """One jet from parts that each cover the points where their mask is true."""
    first_mask, first = parts[0]
    coefficients = np.full((first.order + 1, *first_mask.shape), np.nan)
    for mask, part in parts:
        coefficients[:, mask] = part.coefficients
    return Jet(coefficients)


def by_other(values: Array, rate: Jet, speed: Jet) -> Jet:
    """The jet by another variable x, one order higher, of a function with these values, shape (n,), and slope ``rate``.

    ``rate`` is the derivative by x and ``speed`` = dt/dx, both jets by t of the same order: the next derivative by x is
    ``speed`` times the derivative by t of the one before.
    """
    coefficients = np.empty((rate.order + 2, *values.shape))
    coefficients[0], coefficients[1] = values, rate.value
    for k in range(2, rate.order + 2):
        rate = speed.truncated(rate.order - 1) * rate.differentiated()
        coefficients[k] = rate.value / factorial(k)
    return Jet(coefficients)
