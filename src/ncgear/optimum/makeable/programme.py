"""The nonlinear programme of a makeable law: splines of ln i12 under levels, for an interior-point method.

``rows.py`` has the rows, ``assembly.py`` gives them to the solver with exact first and second derivatives.  With two
stages there are two splines, ln i12 and ln iB.
"""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import redirect_stderr
from io import StringIO
from typing import Any

import casadi
import numpy as np

from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array
from ncgear.optimum.makeable.assembly import Assembly, local_terms
from ncgear.optimum.makeable.levels import LevelKind, WishLevel
from ncgear.optimum.makeable.places import CellPlaces
from ncgear.optimum.makeable.quantities import RatioPlace
from ncgear.optimum.makeable.reached import SMALLEST, JudgedLaw, ratios, running
from ncgear.optimum.makeable.rows import ProgrammeRows, rows_of
from ncgear.optimum.makeable.spline import Knots, SplineRows

SOLVED = {"Solve_Succeeded", "Solved_To_Acceptable_Level"}
STOPPED = "User_Requested_Stop"
"""The solver's status after Ctrl-C."""

AHEAD = 0.1
"""First distance of levels above the levels of the start: an interior-point method begins inside."""


@dataclass(frozen=True, eq=False)
class Solution:
    """A local optimum: coefficients of every spline, shape (pairs n,); all variables and multipliers, to continue from.

    ``excess`` is the amount by which the levels exceed all caps; ``levels`` has the value of every level at the
    programme's places, ``pressing`` each cap's multiplier, shape (levels,).
    """

    coefficients: Array
    excess: float
    levels: Array
    pressing: Array
    variables: Any
    of_bounds: Any
    of_rows: Any


@dataclass(frozen=True, eq=False)
class LawProgramme:
    """A programme to be solved under different caps on its levels; the solvers take the levels' weights as parameters.

    ``afresh`` starts from coefficients, ``onwards`` from the solution for caps that were a little different.
    """

    levels: Sequence[WishLevel]
    knots: Knots
    basis: SplineRows
    rows: ProgrammeRows
    cycles_rad: Sequence[float]
    afresh: Any
    onwards: Any

    def solved(
        self,
        caps: Array,
        weights: Array,
        start: Array | Solution,
        kept_back: Array | float = 0.0,
        missed: Array | float = 0.0,
    ) -> Solution | None:
        """A local optimum under caps on the levels (infinite: no cap), from a start; None where none is found.

        Caps and weights have shape (levels,), starts that are coefficients (pairs n,).  Every row at or below zero is
        ``kept_back`` from zero, shape (rows.bounded,).  ``missed`` is the excess of the places' driving angle and
        length of every pair, shape (2 pairs,).
        """
        return self._solved(caps, np.append(weights, 0.0), start, 0.0, kept_back, missed)

    def nearest(self, caps: Array, weights: Array, price: float, start: Array | Solution) -> Solution | None:
        """A law, which always exists, that exceeds all caps by one priced excess: 0 where caps can be kept."""
        return self._solved(caps, np.append(weights, price), start, np.inf, 0.0, 0.0)

    def coefficient_bounds(self, size: int) -> tuple[Array, Array]:
        """Least and greatest values of the coefficients, shape (size,) each: they are free."""
        return np.full(size, -np.inf), np.full(size, np.inf)

    def _solved(
        self,
        caps: Array,
        prices: Array,
        start: Array | Solution,
        most: float,
        kept_back: Array | float,
        missed: Array | float,
    ) -> Solution | None:
        """A local optimum with an excess of ``most`` at most; prices of the levels, then of the excess."""
        solver, given = self._from(start)
        size = len(self.cycles_rad) * self.knots.count
        before, columns = size + self.rows.columns.first_level, self.rows.columns
        of_levels, of_excess = slice(before, before + caps.size), size + columns.excess
        highest, lowest = np.full(given["x0"].shape[0], np.inf), np.full(given["x0"].shape[0], -np.inf)
        highest[of_levels], highest[of_excess], lowest[of_excess] = caps, most, 0.0
        lowest[of_levels] = [level.least for level in self.levels]
        lowest[size + np.array(columns.sizes, dtype=int)] = SMALLEST

        lowest[:size], highest[:size] = self.coefficient_bounds(size)
        least, greatest = self._row_bounds(caps, most, kept_back, missed)
        # The solver warns of an interrupt; its status tells the same.
        with redirect_stderr(StringIO()):
            answer = solver(p=prices, lbx=lowest, ubx=highest, lbg=least, ubg=greatest, **given)
        ended = solver.stats()["return_status"]
        if ended == STOPPED:
            raise KeyboardInterrupt
        if ended not in SOLVED:
            return None
        values, pressing = np.array(answer["x"])[:, 0], np.array(answer["lam_x"])[of_levels, 0]
        return Solution(
            values[:size],
            float(values[of_excess]),
            values[of_levels],
            pressing,
            answer["x"],
            answer["lam_x"],
            answer["lam_g"],
        )

    def _row_bounds(
        self, caps: Array, most: float, kept_back: Array | float, missed: Array | float
    ) -> tuple[Array, Array]:
        """Bounds of all rows; a deviation that must be zero is an equation."""
        least, greatest = np.zeros(self.rows.count), np.zeros(self.rows.count)
        least[self.rows.equations :] = -np.inf
        greatest[self.rows.equations :] -= kept_back
        closing = slice(2 * len(self.cycles_rad))
        least[closing] = greatest[closing] = missed
        for block in self.rows.blocks:
            exact = most == 0.0 and caps[block.level] == 0.0
            if self.levels[block.level].kind is LevelKind.DEVIATION and exact:
                least[block.rows] = -np.inf if block.sense < 0 else greatest[block.rows]
                greatest[block.rows] = np.inf if block.sense < 0 else greatest[block.rows]
        return least, greatest

    def _from(self, start: Array | Solution) -> tuple[Any, dict[str, Any]]:
        if isinstance(start, Solution):
            return self.onwards, {"x0": start.variables, "lam_x0": start.of_bounds, "lam_g0": start.of_rows}
        return self.afresh, {"x0": self.inside(start)}

    def inside(self, coefficients: Array) -> Array:
        """All variables from coefficients; with variables of the whole law rows hold with room, or are zero."""
        at, columns = self.rows.at, self.rows.columns
        law = ratios(at, self.basis, coefficients, self.cycles_rad)
        judged = JudgedLaw(self.levels, at, law)
        floors = np.array([level.least for level in self.levels])
        whole = np.zeros(self.rows.wholes)
        whole[: columns.first_unknown] = judged.lengths
        whole[columns.first_unknown : columns.first_level] = judged.unknowns
        if self.rows.first_angle is not None:
            whole[self.rows.first_angle : self.rows.first_angle + at.count] = judged.angle_rad
        whole[columns.first_level : columns.excess] = np.maximum(judged.reached, floors) + AHEAD
        for block in self.rows.blocks:
            if block.base is not None:
                level, term = self.levels[block.level], judged.flat[block.term]
                values = running(at, term) if level.kind is LevelKind.SWING else term[at.cells(level.stretch)]
                whole[block.base] = values.min() - AHEAD / 2.0
                if level.kind is LevelKind.SWING:
                    whole[block.running] = values[1:, 0]
        return np.concatenate([self._closed(coefficients, law), whole])

    def _closed(self, coefficients: Array, law: Sequence[RatioPlace]) -> Array:
        """Coefficients shifted as the law is that closes its turn."""
        apart = [
            spline.log[0] - self.basis.of(own)[0][0] for spline, own in zip(law, self._each(coefficients), strict=True)
        ]
        closed: Array = self._each(coefficients) + np.array(apart)[:, None]
        return closed.ravel()

    def _each(self, coefficients: Array) -> Array:
        return coefficients.reshape(len(self.cycles_rad), -1)


TOLERANCE = 1e-8
"""Tolerance of the interior-point method on terms of the order of 1: far below the excess between the places."""

MOST_STEPS = 500
"""Most steps; thirty to sixty are the rule."""

MOST_RESTORING = 10
"""Most steps in a row that only restore the limits; where they fail, ``LawProgramme.nearest`` succeeds."""

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


def programme(levels: Sequence[WishLevel], knots: Knots, at: CellPlaces, cycles_rad: Sequence[float]) -> LawProgramme:
    """The programme of one pair or two that turn through ``cycles_rad`` per turn of the crank."""
    local, basis = local_terms(levels, len(cycles_rad)), knots.rows(at.angle_rad)
    rows = rows_of(levels, local.counts, at, cycles_rad)
    problem, given = Assembly(local, rows, basis, knots.count, len(cycles_rad)).problem(len(levels))
    afresh, onwards = (
        casadi.nlpsol(name, "ipopt", problem, options | given)
        for name, options in (("afresh", QUIET), ("onwards", ONWARDS))
    )
    return LawProgramme(levels, knots, basis, rows, cycles_rad, afresh, onwards)
