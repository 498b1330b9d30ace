"""Gauss-Legendre rules, each made once: a program has its nodes at hand."""

from __future__ import annotations

from functools import cache

from numpy.polynomial import legendre

from ncgear.numerics.arrays import Array


@cache
def gauss_rule(points: int) -> tuple[Array, Array]:
    """Nodes and weights on [-1, 1], shape (points,) each."""
    nodes, weights = legendre.leggauss(points)
    return nodes, weights
