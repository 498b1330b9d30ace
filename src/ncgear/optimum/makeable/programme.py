"""The nonlinear programme of a makeable law: harmonics of ln i12 under levels, for an interior-point method.

The series' values and derivatives at each place are variables of their own, joined to the coefficients by linear
equations: all else is local to a place, so that the exact second derivatives, by casadi, are cheap and sparse.  With
two stages there are two series, ln i12 and ln iB.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import pi
from typing import Any

import casadi
import numpy as np
from scipy import sparse

from ncgear.numerics.arrays import Array
from ncgear.optimum.makeable.quantities import Place, Slider, length_rates
from ncgear.optimum.makeable.reached import Grid, basis, lengths, ratios, reached
from ncgear.optimum.makeable.wishes import Level

SOLVED = {"Solve_Succeeded", "Solved_To_Acceptable_Level"}
STOPPED = "User_Requested_Stop"
"""The solver's status after Ctrl-C."""

AHEAD = 0.1
"""How far levels start above what the start reaches: an interior-point method begins inside."""


@dataclass(frozen=True, eq=False)
class Solution:
    """A local optimum: coefficients cos 1.., sin 1.. of every series; all variables and multipliers, to go on from.

    ``excess`` is by how much all caps are overstepped; ``pressing`` holds each cap's multiplier, shape (levels,).
    """

    coefficients: Array
    excess: float
    pressing: Array
    variables: Any
    of_bounds: Any
    of_rows: Any


@dataclass(frozen=True, eq=False)
class Programme:
    """A programme to be solved under different caps on its levels; the solvers take the levels' weights as parameters.

    ``afresh`` starts from coefficients, ``onwards`` from the solution for caps that were a little different.
    """

    levels: Sequence[Level]
    on: Grid
    cycle_rad: float
    afresh: Any
    onwards: Any
    pairs: int
    equations: int
    rows: int

    def solved(
        self, caps: Array, weights: Array, start: Array | Solution, kept_back: Array | float = 0.0
    ) -> Solution | None:
        """A local optimum under caps on the levels (infinite: none), from a start; None where none is found.

        Caps and weights have shape (levels,), starts that are coefficients (pairs 2 harmonics,); every term is
        ``kept_back`` from its level, shape (terms * places,).
        """
        return self._solved(caps, np.append(weights, 0.0), start, 0.0, kept_back)

    def nearest(self, caps: Array, weights: Array, price: float, start: Array) -> Solution | None:
        """A law that may overstep all caps by one excess, which has a price beside the weights of the levels.

        There always is one.  Where caps can be kept and the price is high enough, it has no excess.
        """
        return self._solved(caps, np.append(weights, price), start, np.inf, 0.0)

    def coefficient_bounds(self, size: int) -> tuple[Array, Array]:
        """Least and greatest values of the coefficients, shape (size,) each: they are free."""
        return np.full(size, -np.inf), np.full(size, np.inf)

    def _solved(
        self, caps: Array, prices: Array, start: Array | Solution, most: float, kept_back: Array | float
    ) -> Solution | None:
        """A local optimum with an excess of ``most`` at most; prices of the levels, then of the excess."""
        solver, given = self._from(start)
        size = self.pairs * self.on.basis.value.shape[1]
        before = size + 2 * self.pairs
        of_levels, of_excess = slice(before, before + caps.size), before + caps.size
        highest, lowest = np.full(given["x0"].shape[0], np.inf), np.full(given["x0"].shape[0], -np.inf)
        highest[of_levels], highest[of_excess], lowest[of_excess] = caps, most, 0.0
        lowest[:size], highest[:size] = self.coefficient_bounds(size)
        zero = np.zeros(self.equations)
        of_rows = {
            "lbg": np.append(zero, np.full(self.rows, -np.inf)),
            "ubg": np.append(zero, np.zeros(self.rows) - kept_back),
        }
        answer = solver(p=prices, lbx=lowest, ubx=highest, **of_rows, **given)
        ended = solver.stats()["return_status"]
        if ended == STOPPED:
            raise KeyboardInterrupt
        if ended not in SOLVED:
            return None
        values, pressing = np.array(answer["x"])[:, 0], np.array(answer["lam_x"])[of_levels, 0]
        return Solution(
            values[:size], float(values[of_excess]), pressing, answer["x"], answer["lam_x"], answer["lam_g"]
        )

    def _from(self, start: Array | Solution) -> tuple[Any, dict[str, Any]]:
        if isinstance(start, Solution):
            return self.onwards, {"x0": start.variables, "lam_x0": start.of_bounds, "lam_g0": start.of_rows}
        at = ratios(self.on, start, self.cycle_rad)
        rows = self.on.basis.value[0]
        constants = [one.log[0] - rows @ own for one, own in zip(at, start.reshape(self.pairs, -1), strict=True)]
        ahead = reached(self.levels, self.on, at) + AHEAD
        local = [column for one in at for column in (one.log, one.first, one.second)]
        return self.afresh, {"x0": np.concatenate([start, constants, lengths(at), ahead, [0.0], *local])}


TOLERANCE = 1e-8
"""Tolerance of the interior-point method on terms of the order of one: far below what is left between the places."""

MOST_STEPS = 500
"""Most steps; thirty to sixty are the rule, three hundred from a start at random."""

MOST_RESTORING = 10
"""Most steps in a row that only try to keep the limits; where they do not get there, ``Programme.nearest`` does."""

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
"""Options for a start from a solution nearby, with the barrier all but gone: ten steps instead of forty."""

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
    rest of the step takes.  Slopes are derived separately for the equations, whose matrix has full rows, and for the
    other rows, whose matrix has full columns: for both together neither direction of derivation is cheap.
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
    """The linear equations that join the ratios' values to their coefficients; ``between`` columns have no part."""
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
    slider = Slider(*(casadi.DM(column) for column in on.stations.slider))
    return [term - caps[k] for k, one in enumerate(levels) for term in one.terms(at, slider, total)]


def _working_equation(working: Working, whole: _Ratio, harmonics: int) -> Any:
    unit, weight = np.polynomial.legendre.leggauss(QUADRATURE)
    angle = working.crank_rad * (1.0 + unit) / 2.0
    series = casadi.mtimes(casadi.DM(basis(angle, harmonics).value), whole.coefficients) + whole.constant
    share = casadi.DM(weight * working.crank_rad / 2.0)
    return casadi.dot(share, casadi.exp(series)) - working.driving_rad
