"""The nonlinear programme of a makeable law: harmonics of ln i12 under levels, for an interior-point method.

The series' values and derivatives at each place are variables of their own, joined to the coefficients by linear
equations: all else is local to a place, so that exact second derivatives are cheap and sparse.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import pi
from typing import Any

import casadi
import numpy as np

from ncgear.numerics.arrays import Array
from ncgear.optimum.levels import Level
from ncgear.optimum.quantities import Place, Slider, length_rate
from ncgear.optimum.reached import Grid, length, place, reached
from ncgear.optimum.series import basis

TOLERANCE = 1e-8
"""Of the interior-point method, on terms of the order of one: far below what is left between the places."""

MOST_STEPS = 500
"""Thirty to sixty are the rule, from a start at random three hundred."""

SOLVED = {"Solve_Succeeded", "Solved_To_Acceptable_Level"}

QUADRATURE = 96
"""Gauss-Legendre points of the working stroke's driving angle: exact to rounding for a hundred harmonics."""

AHEAD = 0.1
"""How far levels start above what the start reaches: an interior-point method begins inside."""


@dataclass(frozen=True)
class Working:
    """The driving angle in rad that the crank's first ``crank_rad`` shall take."""

    crank_rad: float
    driving_rad: float


@dataclass(frozen=True, eq=False)
class Programme:
    """A programme to be solved under different caps on its levels; ``solver`` takes their weights as parameters."""

    levels: Sequence[Level]
    on: Grid
    cycle_rad: float
    solver: Any
    equations: int
    rows: int

    def solved(self, caps: Array, weights: Array, start: Array) -> Array | None:
        """Coefficients of a local optimum under caps on the levels (infinite: none), from a start; None without one.

        Caps and weights have shape (levels,), coefficients cos 1.., sin 1...
        """
        at = self._start(start)
        highest = np.full(at.size, np.inf)
        highest[start.size + 2 : start.size + 2 + caps.size] = caps
        lowest = np.zeros(self.equations + self.rows)
        lowest[self.equations :] = -np.inf
        answer = self.solver(
            x0=at, p=weights, lbx=-np.inf, ubx=highest, lbg=lowest, ubg=np.zeros(self.equations + self.rows)
        )
        if self.solver.stats()["return_status"] not in SOLVED:
            return None
        found: Array = np.array(answer["x"])[: start.size, 0]
        return found

    def _start(self, coefficients: Array) -> Array:
        at = place(self.on, coefficients, self.cycle_rad)
        constant = at.log[0] - (self.on.basis.value @ coefficients)[0]
        ahead = reached(self.levels, self.on, at) + AHEAD
        return np.concatenate([coefficients, [constant, length(at)], ahead, at.log, at.first, at.second])


def programme(levels: Sequence[Level], on: Grid, cycle_rad: float, working: Working | None) -> Programme:
    """The programme on a grid, with exact first and second derivatives by casadi."""
    places, columns = on.basis.value.shape
    coefficients, constant, total = casadi.MX.sym("c", columns), casadi.MX.sym("c0"), casadi.MX.sym("length")
    level, weights = casadi.MX.sym("level", len(levels)), casadi.MX.sym("weight", len(levels))
    local = [casadi.MX.sym(name, places) for name in ("f", "f1", "f2")]
    equations = [
        local[0] - casadi.mtimes(casadi.DM(on.basis.value), coefficients) - constant,
        local[1] - casadi.mtimes(casadi.DM(on.basis.first), coefficients),
        local[2] - casadi.mtimes(casadi.DM(on.basis.second), coefficients),
        casadi.sum1(casadi.exp(local[0])) / places - cycle_rad / (2.0 * pi),
        _length_equation(local, total, places),
    ]
    if working is not None:
        equations.append(_working_equation(working, coefficients, constant, columns // 2))
    rows = casadi.vec(_local_rows(levels, on, local, level, total))
    problem = {
        "x": casadi.vertcat(coefficients, constant, total, level, *local),
        "p": weights,
        "f": casadi.dot(weights, level),
        "g": casadi.vertcat(*equations, rows),
    }
    return Programme(levels, on, cycle_rad, _solver(problem), sum(one.shape[0] for one in equations), rows.shape[0])


def _solver(problem: dict[str, Any]) -> Any:
    options = {
        "print_time": False,
        "ipopt.print_level": 0,
        "ipopt.sb": "yes",
        "ipopt.tol": TOLERANCE,
        "ipopt.max_iter": MOST_STEPS,
    }
    return casadi.nlpsol("makeable", "ipopt", problem, options)


def _place(local: Sequence[Any]) -> Place:
    logarithm, first, second = local
    return Place(logarithm, casadi.exp(logarithm), casadi.exp(-logarithm), first, second)


def _local_rows(levels: Sequence[Level], on: Grid, local: Sequence[Any], level: Any, total: Any) -> Any:
    """What must be at or below zero at every place, shape (rows of a place, places)."""
    symbols = [casadi.SX.sym(name) for name in ("f", "f1", "f2")]
    slider = Slider(*(casadi.SX.sym(name) for name in Slider._fields))
    caps, length = casadi.SX.sym("level", len(levels)), casadi.SX.sym("length")
    at = _place(symbols)
    sides = [side - caps[k] for k, one in enumerate(levels) for side in one.sides(at, slider, length)]
    inputs = [*symbols, *slider, caps, length]
    at_one = casadi.Function("place", inputs, [casadi.vertcat(*sides)])
    places = on.stations.count
    given = [casadi.DM(column).T for column in on.slider]
    repeated = casadi.repmat(level, 1, places), casadi.repmat(total, 1, places)
    return at_one.map(places)(*(variable.T for variable in local), *given, *repeated)


def _length_equation(local: Sequence[Any], total: Any, places: int) -> Any:
    symbols = [casadi.SX.sym(name) for name in ("f", "f1", "f2")]
    rate = casadi.Function("rate", symbols, [length_rate(_place(symbols))]).map(places)
    return casadi.sum2(rate(*(variable.T for variable in local))) * (2.0 * pi / places) - total


def _working_equation(working: Working, coefficients: Any, constant: Any, harmonics: int) -> Any:
    unit, weight = np.polynomial.legendre.leggauss(QUADRATURE)
    angle = working.crank_rad * (1.0 + unit) / 2.0
    series = casadi.mtimes(casadi.DM(basis(angle, harmonics).value), coefficients) + constant
    share = casadi.DM(weight * working.crank_rad / 2.0)
    return casadi.dot(share, casadi.exp(series)) - working.driving_rad
