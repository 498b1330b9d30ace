"""The equations of a makeable law for an interior-point method, with exact first and second derivatives by casadi.

The series' values and derivatives at each place are variables of their own, joined to the coefficients by linear
equations: all else is local to a place, so that second derivatives are cheap and sparse.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import pi
from typing import Any

import casadi
import numpy as np
from scipy import sparse

from ncgear.optimum.makeable.levels import Level
from ncgear.optimum.makeable.programme import Programme
from ncgear.optimum.makeable.quantities import Place, Slider
from ncgear.optimum.makeable.reached import Grid
from ncgear.optimum.makeable.series import basis
from ncgear.optimum.makeable.stages import length_rates

TOLERANCE = 1e-8
"""Of the interior-point method, on terms of the order of one: far below what is left between the places."""

MOST_STEPS = 500
"""Thirty to sixty are the rule, from a start at random three hundred."""

MOST_RESTORING = 10
"""Steps on end towards keeping the limits alone; where these do not lead there, ``Programme.nearest`` is the way."""

QUIET: dict[str, Any] = {
    "print_time": False,
    "ipopt.print_level": 0,
    "ipopt.sb": "yes",
    "ipopt.tol": TOLERANCE,
    "ipopt.max_iter": MOST_STEPS,
    "ipopt.expect_infeasible_problem": "yes",
    "ipopt.max_resto_iter": MOST_RESTORING,
    # Approximate minimum degree: the factors of these systems take half the time of the order chosen by itself
    "ipopt.mumps_pivot_order": 0,
}
ONWARDS: dict[str, Any] = QUIET | {
    "ipopt.warm_start_init_point": "yes",
    "ipopt.mu_init": 1e-6,
    **{f"ipopt.warm_start_{name}_push": 1e-9 for name in ("bound", "mult_bound", "slack_bound")},
    **{f"ipopt.warm_start_{name}_frac": 1e-9 for name in ("bound", "slack_bound")},
}
"""From a solution nearby the method begins where the barrier has all but gone: ten steps instead of forty."""

QUADRATURE = 96
"""Gauss-Legendre points of the working stroke's driving angle: exact to rounding for a hundred harmonics."""

LOCAL = ("f", "f1", "f2")
"""Symbols of a ratio at a place: its logarithm, and the derivatives of that by the crank's angle."""


@dataclass(frozen=True)
class Working:
    """The driving angle in rad that the crank's first ``crank_rad`` shall take."""

    crank_rad: float
    driving_rad: float


@dataclass(frozen=True, eq=False)
class _Ratio:
    """Symbols of ln of one ratio: its series, its constant, and value and derivatives at every place."""

    coefficients: Any
    constant: Any
    local: Sequence[Any]


def programme(levels: Sequence[Level], on: Grid, cycle_rad: float, working: Working | None, pairs: int) -> Programme:
    """The programme of one pair or two on a grid, with exact first and second derivatives by casadi."""
    unknown = [_ratio(on) for _ in range(pairs)]
    total = [casadi.SX.sym("length") for _ in range(pairs)]
    level, excess = casadi.SX.sym("level", len(levels)), casadi.SX.sym("excess")
    prices = casadi.SX.sym("price", len(levels) + 1)
    local = [variable for one in unknown for variable in one.local]
    coefficients, constants = [one.coefficients for one in unknown], [one.constant for one in unknown]
    variables = casadi.vertcat(*coefficients, *constants, *total, level, excess, *local)
    at = [_place(one) for one in unknown]
    # The shaft between the pairs turns once as the crank does
    cycles = cycle_rad, 2.0 * pi
    equations = [
        *(_mean(one.ratio) - cycle / (2.0 * pi) for one, cycle in zip(at, cycles, strict=False)),
        *(length - 2.0 * pi * _mean(rate) for length, rate in zip(total, length_rates(at), strict=True)),
    ]
    if working is not None:
        equations.append(_working_equation(working, unknown[0], on.basis.value.shape[1] // 2))
    rows = _rows(levels, on, at, level + excess, total)
    series = _of_series(on, pairs, between=pairs + len(levels) + 1)
    goal = casadi.dot(prices, casadi.vertcat(level, excess))
    solvers = _solvers(variables, prices, goal, series, (casadi.vertcat(*equations), casadi.vertcat(*rows)))
    return Programme(
        levels, on, cycle_rad, *solvers, pairs, series.shape[0] + len(equations), sum(row.shape[0] for row in rows)
    )


def _solvers(variables: Any, prices: Any, goal: Any, series: Any, others: Sequence[Any]) -> tuple[Any, Any]:
    """The two solvers, from the matrix of the linear equations, and the other equations and rows.

    The matrix is handed over as it is: left to itself, casadi would work it out anew at every step, for longer than the
    rest of the step takes.  Slopes are derived apart for equations, which have full rows, and rows, which have full
    columns: together neither direction is cheap.
    """
    x, p = casadi.MX.sym("x", variables.shape[0]), casadi.MX.sym("p", prices.shape[0])
    value = casadi.Function("others", [variables], [casadi.vertcat(*others)])
    each = [casadi.jacobian(one, variables) for one in others]
    slope = casadi.Function("slopes_of_others", [variables], [casadi.vertcat(*each)])
    rows = casadi.vertcat(casadi.mtimes(series, x), value(x))
    slopes = casadi.Function("slopes", [x, p], [rows, casadi.vertcat(series, slope(x))], ["x", "p"], ["g", "jac_g_x"])
    problem = {"x": x, "p": p, "f": casadi.Function("goal", [variables, prices], [goal])(x, p), "g": rows}
    given = {"jac_g": slopes}
    afresh = casadi.nlpsol("afresh", "ipopt", problem, QUIET | given)
    return afresh, casadi.nlpsol("onwards", "ipopt", problem, ONWARDS | given)


def _ratio(on: Grid) -> _Ratio:
    places, columns = on.basis.value.shape
    local = [casadi.SX.sym(name, places) for name in LOCAL]
    return _Ratio(casadi.SX.sym("c", columns), casadi.SX.sym("c0"), local)


def _of_series(on: Grid, pairs: int, between: int) -> Any:
    """What joins the ratios' values to their coefficients: all linear, with ``between`` columns that have no part."""
    each = np.vstack([on.basis.value, on.basis.first, on.basis.second])
    constant = np.repeat([1.0, 0.0, 0.0], on.stations.count)[:, None]
    own, constants = (sparse.kron(sparse.eye(pairs), part) for part in (each, constant))
    rows = own.shape[0]
    whole = sparse.hstack([-own, -constants, sparse.csc_matrix((rows, between)), sparse.eye(rows)])
    return casadi.DM(sparse.csc_matrix(whole))


def _place(one: _Ratio) -> Place:
    logarithm, first, second = one.local
    return Place(logarithm, casadi.exp(logarithm), casadi.exp(-logarithm), first, second)


def _mean(term: Any) -> Any:
    return casadi.sum1(term) / term.shape[0]


def _rows(levels: Sequence[Level], on: Grid, at: Sequence[Place], caps: Any, total: Sequence[Any]) -> list[Any]:
    """What must be at or below zero, every term at all places."""
    slider = Slider(*(casadi.DM(column) for column in on.slider))
    return [term - caps[k] for k, one in enumerate(levels) for term in one.terms(at, slider, total)]


def _working_equation(working: Working, whole: _Ratio, harmonics: int) -> Any:
    unit, weight = np.polynomial.legendre.leggauss(QUADRATURE)
    angle = working.crank_rad * (1.0 + unit) / 2.0
    series = casadi.mtimes(casadi.DM(basis(angle, harmonics).value), whole.coefficients) + whole.constant
    share = casadi.DM(weight * working.crank_rad / 2.0)
    return casadi.dot(share, casadi.exp(series)) - working.driving_rad
