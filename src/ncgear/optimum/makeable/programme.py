"""The nonlinear programme of a makeable law: harmonics of ln i12 under levels, for an interior-point method.

The series' values and derivatives at each place are variables of their own, joined to the coefficients by linear
equations: all else is local to a place, so that exact second derivatives are cheap and sparse.  Of two stages there are
two series, ln i12 and ln iB.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ncgear.numerics.arrays import Array
from ncgear.optimum.makeable.levels import Level
from ncgear.optimum.makeable.reached import Grid, lengths, ratios, reached

SOLVED = {"Solve_Succeeded", "Solved_To_Acceptable_Level"}
STOPPED = "User_Requested_Stop"
"""What the solver makes of Ctrl-C."""

AHEAD = 0.1
"""How far levels start above what the start reaches: an interior-point method begins inside."""


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

    def _solved(
        self, caps: Array, prices: Array, start: Array | Solution, most: float, kept_back: Array | float
    ) -> Solution | None:
        """A local optimum with an excess of ``most`` at most; prices of the levels, then of the excess."""
        solver, given = self._from(start)
        size = self.pairs * self.on.basis.value.shape[1]
        before = size + 2 * self.pairs
        highest, lowest = np.full(given["x0"].shape[0], np.inf), np.full(given["x0"].shape[0], -np.inf)
        of_levels, of_excess = slice(before, before + caps.size), before + caps.size
        highest[of_levels], highest[of_excess], lowest[of_excess] = caps, most, 0.0
        if self.held is not None:
            lowest[: self.held.size] = highest[: self.held.size] = self.held
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
