"""Quadrature in as many digits as mpmath works with."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import Any

from mpmath import mp
from mpmath.calculus.quadrature import GaussLegendre

Real = Any  # mpf

HALVINGS = 40


def integral(function: Callable[[Real], Real], start: Real, end: Real) -> Real:
    """Quadrature on stretches that are halved until each is good to 22 digits of what it may be."""
    return _quadrature(function, start, end, HALVINGS)


def _quadrature(function: Callable[[Real], Real], low: Real, high: Real, halvings: int) -> Real:
    coarse, fine = (_gauss(function, low, high, degree) for degree in (3, 4))
    if abs(fine - coarse) <= mp.mpf(10) ** -22 * (1 + abs(fine)):
        return fine
    if not halvings:
        raise ArithmeticError("the quadrature does not converge")
    middle = (low + high) / 2
    return _quadrature(function, low, middle, halvings - 1) + _quadrature(function, middle, high, halvings - 1)


def _gauss(function: Callable[[Real], Real], low: Real, high: Real, degree: int) -> Real:
    """The rule of 3 * 2^(degree - 1) nodes."""
    middle, half = (low + high) / 2, (high - low) / 2
    return half * mp.fsum(weight * function(middle + half * x) for x, weight in _rule(degree, mp.prec))


@cache
def _rule(degree: int, bits: int) -> list[tuple[Real, Real]]:
    nodes: list[tuple[Real, Real]] = GaussLegendre(mp).get_nodes(-1, 1, degree, bits)
    return nodes
