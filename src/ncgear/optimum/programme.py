"""The nonlinear programme of a makeable law: harmonics of ln i12 under levels, for an interior-point method.

The series' values and derivatives at each place are variables of their own, joined to the coefficients by linear
equations: all else is local to a place, so that exact second derivatives are cheap and sparse.  Of two stages there are
two series, ln i12 and ln iB.
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
from ncgear.optimum.quantities import Place, Slider
from ncgear.optimum.reached import Grid, lengths, ratios, reached
from ncgear.optimum.series import basis
from ncgear.optimum.stages import length_rates

TOLERANCE = 1e-8
"""Of the interior-point method, on terms of the order of one: far below what is left between the places."""

MOST_STEPS = 500
"""Thirty to sixty are the rule, from a start at random three hundred."""

MOST_RESTORING = 10
"""Steps on end towards keeping the limits alone; where these do not lead there, ``Programme.nearest`` is the way."""

SOLVED = {"Solve_Succeeded", "Solved_To_Acceptable_Level"}

QUIET: dict[str, Any] = {
    "print_time": False,
    "ipopt.print_level": 0,
    "ipopt.sb": "yes",
    "ipopt.tol": TOLERANCE,
    "ipopt.max_iter": MOST_STEPS,
    "ipopt.expect_infeasible_problem": "yes",
    "ipopt.max_resto_iter": MOST_RESTORING,
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

AHEAD = 0.1
"""How far levels start above what the start reaches: an interior-point method begins inside."""


@dataclass(frozen=True)
class Working:
    """The driving angle in rad that the crank's first ``crank_rad`` shall take."""

    crank_rad: float
    driving_rad: float


@dataclass(frozen=True, eq=False)
class Solution:
    """A local optimum: coefficients cos 1.., sin 1.. of every series; all variables and multipliers, to go on from.

    ``excess`` is by how much all caps are overstepped, ``pressing`` what each cap's multiplier is, shape (levels,).
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

    ``afresh`` starts from coefficients, ``onwards`` from the solution for caps that were a little different.  Of two
    stages the coefficients of i12 may be ``held`` as they are.
    """

    levels: Sequence[Level]
    on: Grid
    cycle_rad: float
    afresh: Any
    onwards: Any
    pairs: int
    equations: int
    rows: int
    held: Array | None = None

    def solved(self, caps: Array, weights: Array, start: Array | Solution) -> Solution | None:
        """A local optimum under caps on the levels (infinite: none), from a start; None where none is found.

        Caps and weights have shape (levels,), starts that are coefficients (pairs 2 harmonics,).
        """
        return self._solved(caps, np.append(weights, 0.0), start, 0.0)

    def nearest(self, caps: Array, weights: Array, price: float, start: Array) -> Solution | None:
        """A law that may overstep all caps by one excess, which has a price beside the weights of the levels.

        There always is one.  Where caps can be kept and the price is high enough, it has no excess.
        """
        return self._solved(caps, np.append(weights, price), start, np.inf)

    def _solved(self, caps: Array, prices: Array, start: Array | Solution, most: float) -> Solution | None:
        """A local optimum with an excess of ``most`` at most; prices of the levels, then of the excess."""
        solver, given = self._from(start)
        size = self.pairs * self.on.basis.value.shape[1]
        before = size + 2 * self.pairs
        highest, lowest = np.full(given["x0"].shape[0], np.inf), np.full(given["x0"].shape[0], -np.inf)
        of_levels, of_excess = slice(before, before + caps.size), before + caps.size
        highest[of_levels], highest[of_excess], lowest[of_excess] = caps, most, 0.0
        if self.held is not None:
            lowest[: self.held.size] = highest[: self.held.size] = self.held
        floor = np.zeros(self.equations + self.rows)
        floor[self.equations :] = -np.inf
        answer = solver(p=prices, lbx=lowest, ubx=highest, lbg=floor, ubg=np.zeros(floor.size), **given)
        if solver.stats()["return_status"] not in SOLVED:
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


@dataclass(frozen=True, eq=False)
class _Ratio:
    """Symbols of ln of one ratio: its series, its constant, and value and derivatives at every place."""

    coefficients: Any
    constant: Any
    local: Sequence[Any]


def programme(levels: Sequence[Level], on: Grid, cycle_rad: float, working: Working | None, pairs: int) -> Programme:
    """The programme of one pair or two on a grid, with exact first and second derivatives by casadi."""
    unknown = [_ratio(on) for _ in range(pairs)]
    total = [casadi.MX.sym("length") for _ in range(pairs)]
    level, excess = casadi.MX.sym("level", len(levels)), casadi.MX.sym("excess")
    prices = casadi.MX.sym("price", len(levels) + 1)
    local = [variable for one in unknown for variable in one.local]
    # The shaft between the pairs turns once as the crank does
    cycles = cycle_rad, 2.0 * pi
    equations = [
        *(equation for one, cycle in zip(unknown, cycles, strict=False) for equation in _of_series(one, on, cycle)),
        casadi.vertcat(*total) - _rolled(local, on.stations.count),
    ]
    if working is not None:
        equations.append(_working_equation(working, unknown[0], on.basis.value.shape[1] // 2))
    rows = casadi.vec(_local_rows(levels, on, local, level + excess, total))
    coefficients, constants = [one.coefficients for one in unknown], [one.constant for one in unknown]
    problem = {
        "x": casadi.vertcat(*coefficients, *constants, *total, level, excess, *local),
        "p": prices,
        "f": casadi.dot(prices, casadi.vertcat(level, excess)),
        "g": casadi.vertcat(*equations, rows),
    }
    solvers = casadi.nlpsol("afresh", "ipopt", problem, QUIET), casadi.nlpsol("onwards", "ipopt", problem, ONWARDS)
    return Programme(levels, on, cycle_rad, *solvers, pairs, sum(one.shape[0] for one in equations), rows.shape[0])


def _ratio(on: Grid) -> _Ratio:
    places, columns = on.basis.value.shape
    local = [casadi.MX.sym(name, places) for name in LOCAL]
    return _Ratio(casadi.MX.sym("c", columns), casadi.MX.sym("c0"), local)


def _of_series(one: _Ratio, on: Grid, cycle_rad: float) -> Sequence[Any]:
    """What joins a ratio's values to its coefficients, and closes its cycle."""
    value, first, second = (casadi.mtimes(casadi.DM(matrix), one.coefficients) for matrix in _matrices(on))
    return [
        one.local[0] - value - one.constant,
        one.local[1] - first,
        one.local[2] - second,
        casadi.sum1(casadi.exp(one.local[0])) / on.stations.count - cycle_rad / (2.0 * pi),
    ]


def _matrices(on: Grid) -> Sequence[Array]:
    return on.basis.value, on.basis.first, on.basis.second


def _places(local: Sequence[Any]) -> list[Place]:
    """Every ratio at a place, from value and derivatives of their logarithms in turn."""
    starts = range(0, len(local), len(LOCAL))
    return [Place(local[k], casadi.exp(local[k]), casadi.exp(-local[k]), local[k + 1], local[k + 2]) for k in starts]


def _symbols(count: int) -> list[Any]:
    return [casadi.SX.sym(LOCAL[k % len(LOCAL)]) for k in range(count)]


def _local_rows(levels: Sequence[Level], on: Grid, local: Sequence[Any], level: Any, total: Sequence[Any]) -> Any:
    """What must be at or below zero at every place, shape (rows of a place, places)."""
    symbols = _symbols(len(local))
    slider = Slider(*(casadi.SX.sym(name) for name in Slider._fields))
    caps, rolled = casadi.SX.sym("level", len(levels)), [casadi.SX.sym("length") for _ in total]
    at = _places(symbols)
    terms = [term - caps[k] for k, one in enumerate(levels) for term in one.terms(at, slider, rolled)]
    at_one = casadi.Function("place", [*symbols, *slider, caps, *rolled], [casadi.vertcat(*terms)])
    places = on.stations.count
    given = [casadi.DM(column).T for column in on.slider]
    repeated = [casadi.repmat(one, 1, places) for one in (level, *total)]
    return at_one.map(places)(*(variable.T for variable in local), *given, *repeated)


def _rolled(local: Sequence[Any], places: int) -> Any:
    """Length that every pair rolls in a cycle, over its centre distance."""
    symbols = _symbols(len(local))
    rates = casadi.vertcat(*length_rates(_places(symbols)))
    rate = casadi.Function("rate", symbols, [rates]).map(places)
    return casadi.sum2(rate(*(variable.T for variable in local))) * (2.0 * pi / places)


def _working_equation(working: Working, whole: _Ratio, harmonics: int) -> Any:
    unit, weight = np.polynomial.legendre.leggauss(QUADRATURE)
    angle = working.crank_rad * (1.0 + unit) / 2.0
    series = casadi.mtimes(casadi.DM(basis(angle, harmonics).value), whole.coefficients) + whole.constant
    share = casadi.DM(weight * working.crank_rad / 2.0)
    return casadi.dot(share, casadi.exp(series)) - working.driving_rad
