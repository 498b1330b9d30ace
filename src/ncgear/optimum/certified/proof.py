"""A conic programme, its solution, and the proof of a lower bound of its least value.

    least c'v   where   b - A v  is in K   and   low <= v <= high

K is a product of half lines and of second-order cones of three numbers, x0 >= sqrt(x1^2 + x2^2).  Clarabel, an
interior-point method, solves it.  Its answer is not the certificate.  For any z in the dual cone (K itself) and any
allowed v, z'(b - A v) >= 0, and so with r = c + A'z

    c'v >= -b'z + r'v >= -b'z + sum of min(r low, r high)

The solver's multipliers z are moved into the cone, and this sum is computed and lowered by all its rounding errors.
Errors of the numbers in A and b count, too: every row is relaxed by ``DATA`` of its terms, or more where the numbers of
a machine have lost digits.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property
from math import fsum, inf, isfinite
from typing import Any

import numpy as np
from scipy import sparse

from ncgear.extras import require
from ncgear.numerics.arrays import Array, IndexArray

UNIT = float(np.finfo(float).eps)

DATA = 1e-11
"""Largest relative error of numbers of the rows: they come from a few operations on displacements and sines, whose
cancellation leaves 1e-13 at worst where places are as near as ``cycle.NEAREST`` allows.  At a corner of the
displacement of width w it leaves a quarter of 2e-16/w^2 at worst: ``Cycle.error`` is never less."""


@dataclass(frozen=True, eq=False)
class Linear:
    """k linear expressions: constant + sum of coefficients times variables; arrays of shape (terms, k) and (k,)."""

    columns: IndexArray
    coefficients: Array
    constant: Array

    __array_ufunc__ = None  # so that an array times an expression is an expression

    def __add__(self, other: Linear | Array | float) -> Linear:
        if not isinstance(other, Linear):
            return replace(self, constant=self.constant + other)
        return Linear(
            np.concatenate([self.columns, other.columns]),
            np.concatenate([self.coefficients, other.coefficients]),
            self.constant + other.constant,
        )

    __radd__ = __add__

    def __mul__(self, factor: Array | float) -> Linear:
        return Linear(self.columns, self.coefficients * factor, self.constant * factor)

    __rmul__ = __mul__

    def __neg__(self) -> Linear:
        return self * -1.0

    def __sub__(self, other: Linear | Array | float) -> Linear:
        return self + -other

    def __rsub__(self, other: Array | float) -> Linear:
        return -self + other

    def __getitem__(self, places: Any) -> Linear:
        return Linear(self.columns[:, places], self.coefficients[:, places], self.constant[places])

    def total(self) -> Linear:
        """The sum of all expressions, as a single expression."""
        return Linear(
            self.columns.reshape(-1, 1), self.coefficients.reshape(-1, 1), np.sum(self.constant, keepdims=True)
        )

    def repeated(self, count: int) -> Linear:
        """An expression, ``count`` times."""
        return Linear(
            np.repeat(self.columns, count, axis=1),
            np.repeat(self.coefficients, count, axis=1),
            np.repeat(self.constant, count),
        )


@dataclass
class ConicProgramme:
    """A programme under construction: variables with their ranges, then rows that must not be negative.

    ``error`` is the largest relative error of the numbers of its rows.
    """

    error: float = DATA
    low: list[Array] = field(default_factory=list)
    high: list[Array] = field(default_factory=list)
    rows: list[Linear] = field(default_factory=list)
    cones: list[tuple[Linear, Linear, Linear]] = field(default_factory=list)
    size: int = 0

    def variable(self, low: Array, high: Array) -> Linear:
        """New variables, shape (k,), within ranges that every wanted motion keeps; the ranges are no rows."""
        count = low.size
        columns = np.arange(self.size, self.size + count)[None, :]
        self.size += count
        self.low.append(low)
        self.high.append(high)
        return Linear(columns, np.ones((1, count)), np.zeros(count))

    def positive(self, expression: Linear) -> None:
        """Rows: each expression is zero or more."""
        self.rows.append(expression)

    def cone(self, first: Linear, second: Linear, third: Linear) -> None:
        """Rows: first >= sqrt(second^2 + third^2), for each of k."""
        self.cones.append((first, second, third))

    def product(self, one: Linear, other: Linear, square_of: Linear) -> None:
        """Rows: one * other >= square_of^2, both factors positive."""
        self.cone(one + other, 2.0 * square_of, one - other)

    def root(self, root: Linear, of: Linear) -> None:
        """Rows: root <= sqrt(of)."""
        self.cone(of + 1.0, 2.0 * root, of - 1.0)


@dataclass(frozen=True, eq=False)
class ConicAnswer:
    """``value`` is a certain lower bound over all allowed variables; infinite where none are allowed.

    ``near`` holds the solver's variables, shape (n,), close to the best; None where it found none.
    """

    value: float
    near: Array | None


def least(programme: ConicProgramme, goal: Linear) -> ConicAnswer:
    """The least of a goal, a single expression, and variables near it; raises WrongInput without Clarabel."""
    return Solver().least(proof_of(programme), goal)


class Solver:
    """Clarabel: what it has made of a programme is used again where the next one's rows have the same variables."""

    _last: tuple[Any, Any] = None, None

    def least(self, proof: Proof, goal: Linear) -> ConicAnswer:
        """The least of a goal, a single expression, from what proves it, and variables near it."""
        cost = np.zeros(proof.low.size)
        np.add.at(cost, goal.columns[:, 0], goal.coefficients[:, 0])
        answer = ConicAnswer(-inf, None)
        # The rows are scaled already and the proof judges: the first try leaves out steps that take a third of the time
        for thorough in (False, True):
            found = self._solved(proof, cost, thorough)
            near, multipliers = np.array(found.x), np.array(found.z)
            if not np.all(np.isfinite(multipliers)):
                continue
            if "PrimalInfeasible" in str(found.status):
                if proof.bound(np.zeros(cost.size), multipliers) > 0.0:
                    return ConicAnswer(inf, None)
                continue
            value = proof.bound(cost, multipliers) + float(goal.constant[0])
            if value > answer.value or answer.near is None:
                answer = ConicAnswer(max(value, answer.value), near if np.all(np.isfinite(near)) else answer.near)
            if str(found.status) == "Solved":
                break
        return answer

    def _solved(self, proof: Proof, cost: Array, thorough: bool) -> Any:
        require("clarabel", "optimize", "a certified limit")
        import clarabel

        matrix = proof.matrix
        pattern = thorough, matrix.shape, proof.cones, matrix.indptr.tobytes(), matrix.indices.tobytes()
        if self._last[0] == pattern:
            self._last[1].update(q=cost, A=matrix.data, b=proof.bounds)
            return self._last[1].solve()
        settings = clarabel.DefaultSettings()
        settings.verbose = False
        settings.max_threads = 1
        settings.iterative_refinement_enable = settings.equilibrate_enable = thorough
        flat = proof.bounds.size - 3 * proof.cones
        shapes = [clarabel.NonnegativeConeT(flat), *[clarabel.SecondOrderConeT(3)] * proof.cones]
        nothing = sparse.csc_matrix((cost.size, cost.size))
        self._last = pattern, clarabel.DefaultSolver(nothing, cost, matrix, proof.bounds, shapes, settings)
        return self._last[1].solve()


def proof_of(programme: ConicProgramme) -> Proof:
    """What bounds of a programme are proven from: each row b - A v is an expression that must be in its cone."""
    blocks, places, before = list[Linear](), list[IndexArray](), 0
    # The three rows of a cone follow each other
    for together in [*((row,) for row in programme.rows), *programme.cones]:
        count = len(together) * together[0].constant.size
        blocks += together
        places += [np.arange(before + place, before + count, len(together)) for place in range(len(together))]
        before += count
    columns = np.concatenate([block.columns.ravel() for block in blocks])
    values = np.concatenate([-block.coefficients.ravel() for block in blocks])
    rows = np.concatenate([np.tile(at, len(block.columns)) for block, at in zip(blocks, places, strict=True)])
    matrix, bounds = sparse.csc_matrix((values, (rows, columns)), shape=(before, programme.size)), np.zeros(before)
    matrix.eliminate_zeros()
    bounds[np.concatenate(places)] = np.concatenate([block.constant for block in blocks])
    cones = sum(first.constant.size for first, _, _ in programme.cones)
    return Proof(matrix, bounds, cones, np.concatenate(programme.low), np.concatenate(programme.high), programme.error)


@dataclass(frozen=True, eq=False)
class Proof:
    """The data for the proof of a bound: the rows A and b, the number of cones among them (the last rows), the ranges.

    ``error`` is the relative error of the numbers in A and b.
    """

    matrix: sparse.csc_matrix
    bounds: Array
    cones: int
    low: Array
    high: Array
    error: float = DATA

    def bound(self, cost: Array, multipliers: Array) -> float:
        """A value certainly at or below the least of cost'v over all allowed v, from any multipliers, shape (rows,).

        It is minus infinity where numbers are not finite: they prove nothing.
        """
        z = self.in_cone(multipliers)
        rows = -self.bounds - self.let_out
        residual = cost + self.matrix.T @ z
        size = np.abs(cost) + abs(self.matrix).T @ np.abs(z)
        # A sum of k terms is off by at most k units of rounding of the sum of their sizes
        most = int(np.diff(self.matrix.indptr).max()) + 4
        off = most * UNIT * size
        least = np.minimum.reduce(
            [(residual + sign * off) * end for sign in (-1.0, 1.0) for end in (self.low, self.high)]
        )
        terms = [*(rows * z).tolist(), *least.tolist()]
        if not all(map(isfinite, terms)):
            return -inf
        return fsum(terms) - 4.0 * UNIT * fsum(map(abs, terms))

    def in_cone(self, multipliers: Array) -> Array:
        """Multipliers in the dual cone: halves below zero are zero, the first of three is raised to their length."""
        z = np.maximum(multipliers, 0.0)
        flat = z.size - 3 * self.cones
        three = multipliers[flat:].reshape(-1, 3)
        length = np.hypot(three[:, 1], three[:, 2]) * (1.0 + 4.0 * UNIT)
        z[flat:] = np.column_stack([np.maximum(three[:, 0], length), three[:, 1:]]).ravel()
        return z

    @cached_property
    def let_out(self) -> Array:
        """Relaxation of every row for errors of its numbers; in a cone of three rows, the first row has the sum."""
        largest = np.maximum(np.abs(self.low), np.abs(self.high))
        each = self.error * (abs(self.matrix) @ largest + np.abs(self.bounds))
        flat = each.size - 3 * self.cones
        three = each[flat:].reshape(-1, 3)
        three[:, 0], three[:, 1:] = three.sum(axis=1), 0.0
        return each
