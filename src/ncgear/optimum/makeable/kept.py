"""Limits kept everywhere: a programme solved again until they hold between its places, too.

Which limits of a makeable law are in each other's way, and the nearest values that can be had.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from math import pi
from typing import NamedTuple

import numpy as np

from ncgear.numerics.arrays import Array
from ncgear.optimum.makeable.levels import CONVEX, Level, Scales, levels
from ncgear.optimum.makeable.programme import Programme, Solution, Working, programme
from ncgear.optimum.makeable.quantities import Place
from ncgear.optimum.makeable.reached import Grid, Stations, beyond, grid, ratios, reached, stations
from ncgear.optimum.makeable.wishes import Wishes
from ncgear.optimum.task import Task

PLACES_PER_HARMONIC = 10
"""Places of the programme: ten on the shortest wave, so that little is left between them."""

FEWEST_PLACES = 240
"""Resistances and linkages have their own waves, which few harmonics of the law do not make longer."""

FINER = 20
"""How many times finer the grid is on which limits are held against the law that was found: on ten times as fine a one
the parabolas between its places missed the curvature of 36 harmonics by more than the margin."""

ROUNDS = 6
"""Times that caps are tightened by what is over them between the places; three are the rule."""

PATIENCE = 2
"""Rounds in which places alone are kept back: each leaves a tenth of what was over the caps, or less."""

MARGIN = 1e-6
"""Share by which caps are tightened beyond that, for what is left between the places of the finer grid."""

DECIMALS = 10
"""Of the coefficients, so that what is judged is what a design file holds."""

LEAST_POWER_W = 1.0
"""Unit of power of a machine that nothing resists."""

Form = Callable[[Stations, int], Grid]
"""Places, and a number of harmonics or as many coefficients of another form of ln i12, to the form's matrices there."""


@dataclass(frozen=True, eq=False)
class Search:
    """A programme, the finer grid that judges it, and the caps and weights of its levels."""

    programme: Programme
    finer: Grid
    caps: Array
    weights: Array

    def reached(self, coefficients: Array) -> Array:
        """Levels on the finer grid, and between its places as parabolas through them tell; shape (levels,)."""
        return reached(self.programme.levels, self.finer, self._ratios(coefficients))

    def beyond(self, coefficients: Array) -> Array:
        """By how much every term is larger around the programme's places than at them, shape (programme.rows,)."""
        places = self.programme.on.stations.count
        return beyond(self.programme.levels, self.finer, self._ratios(coefficients), places)

    def _ratios(self, coefficients: Array) -> tuple[Place, ...]:
        return ratios(self.finer, coefficients, self.programme.cycle_rad)


@dataclass(frozen=True, eq=False)
class Kept:
    """Coefficients that keep all limits, and the levels reached on the finer grid, shape (levels,)."""

    coefficients: Array
    reached: Array


def searched(task: Task, wishes: Wishes, form: Form = grid) -> Search:
    """The search for the law that a task and wishes ask for; a working stroke of a given angle takes harmonics."""
    count = max(PLACES_PER_HARMONIC * wishes.harmonics, FEWEST_PLACES)
    coarse = stations(task.linkage, task.resistance, count)
    finer = stations(task.linkage, task.resistance, FINER * count)
    wanted = levels(wishes, scales(task, finer))
    working = (
        None
        if wishes.limits.working_rad is None
        else Working(task.linkage.working_angle_rad, wishes.limits.working_rad)
    )
    return Search(
        programme(wanted, form(coarse, wishes.harmonics), task.cycle_rad, working, wishes.pairs),
        form(finer, wishes.harmonics),
        np.array([np.inf if level.limit is None else level.limit for level in wanted]),
        np.array([level.weight for level in wanted]),
    )


def scales(task: Task, at: Stations) -> Scales:
    """Units of the order of what a uniform crank feels."""
    turning = task.speed_rad_s * 2.0 * pi / task.cycle_rad
    power = float(np.max(at.force_n * at.first)) * turning / 1000.0
    return Scales(task.speed_rad_s, task.linkage.crank_mm * turning**2, max(power, LEAST_POWER_W))


def kept(search: Search, start: Array) -> Kept | None:
    """The best coefficients from one start, solved again until all limits hold on the finer grid; None where none do.

    Every term is kept back at each place by what it rises to beside it; what is left in the end is taken off the caps,
    since places alone come near only round by round.
    """
    caps, kept_back = search.caps.copy(), np.zeros(search.programme.rows)
    found = search.programme.solved(caps, search.weights, start, kept_back)
    for tried in range(ROUNDS):
        if found is None:
            return None
        coefficients = np.round(found.coefficients, DECIMALS)
        values = search.reached(coefficients)
        over = np.maximum(values - search.caps, 0.0)
        if not np.any(over):
            return Kept(coefficients, values)
        kept_back = np.maximum(kept_back, search.beyond(coefficients) + MARGIN)
        if tried >= PATIENCE:
            caps = caps - over
        # Where the next one is too far to go on to, afresh from the same place
        onwards = search.programme.solved(caps, search.weights, found, kept_back)
        found = onwards or search.programme.solved(caps, search.weights, found.coefficients, kept_back)
    return None


NO_EXCESS = 1e-6
"""Excess over caps that counts as none: far under what is left between the places of the programme."""

PRESSING = 1e-4
"""Share of a cap in what keeps the excess up, below which it has none."""

DEARER = 10.0
"""How much more an excess over the other caps costs than what it can gain, so that there is none if there need not."""

TOGETHER = 1e3
"""Price of an excess over all caps beside several levels that have none, in units that are of the order of one."""

ANY_DENT = 10.0
"""Depth of a dent, in units of the level of convexity, that no law of any use has."""

Judge = Callable[[Array], Array]
"""Levels that coefficients reach everywhere, shape (levels,)."""


class Easing(NamedTuple):
    """A wish, and the words for a value of it that makes room."""

    wish: str
    said: str

    def __str__(self) -> str:
        return f"{self.said} (optimize.limits.{self.wish})"


def pressing(programme: Programme, near: Solution) -> list[str]:
    """The wishes that keep up the excess of the law that comes nearest to keeping all limits.

    No others are to blame: without any of those the same law would still be the nearest.
    """
    return list(dict.fromkeys(level.wish for level, share in _shares(programme, near) if share > PRESSING))


def easings(programme: Programme, caps: Array, near: Solution, judge: Judge) -> Iterator[Easing]:
    """Of each wish that presses the nearest value with which all others can be kept, if there is one."""
    for wish in pressing(programme, near):
        share = sum(near.pressing[k] for k, level in enumerate(programme.levels) if level.wish == wish)
        found = _without(programme, caps, [wish], DEARER / float(share), near)
        if found is not None and found.excess <= NO_EXCESS:
            yield _easing(programme, wish, judge(found.coefficients))


def easings_together(programme: Programme, caps: Array, near: Solution, judge: Judge) -> Iterator[Easing]:
    """Values of several wishes that are enough together, where none alone is: the most pressing is given up, then the
    most pressing without it, and so on."""
    freed: list[str] = []
    found: Solution | None = near
    while found is not None and found.excess > NO_EXCESS:
        shares = [0.0 if level.wish in freed else share for level, share in _shares(programme, found)]
        freed.append(programme.levels[int(np.argmax(shares))].wish)
        found = _without(programme, caps, freed, TOGETHER, found)
        if len(freed) == len(programme.levels):
            return
    if found is not None:
        reached = judge(found.coefficients)
        yield from (_easing(programme, wish, reached) for wish in freed)


def _without(programme: Programme, caps: Array, wishes: Sequence[str], price: float, near: Solution) -> Solution | None:
    """The law with these wishes' levels as low as they will go, and an excess of that price over all other caps."""
    freed = np.array([level.wish in wishes for level in programme.levels])
    dents = np.array([level.wish == CONVEX for level in programme.levels])
    free = np.where(freed, np.where(dents, ANY_DENT, np.inf), caps)
    return programme.nearest(free, np.where(freed & ~dents, 1.0, 0.0), price, near.coefficients)


def _shares(programme: Programme, near: Solution) -> Iterator[tuple[Level, float]]:
    return zip(programme.levels, near.pressing.tolist(), strict=True)


def _easing(programme: Programme, wish: str, reached: Array) -> Easing:
    value, level = max(
        ((value, level) for value, level in zip(reached, programme.levels, strict=True) if level.wish == wish),
        key=lambda one: one[0],
    )
    return Easing(wish, level.shown(float(value)))
