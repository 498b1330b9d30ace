"""Limits kept everywhere: a programme solved again until they hold between its places, too."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import pi

import numpy as np

from ncgear.numerics.arrays import Array
from ncgear.optimum.makeable.equations import Working, programme
from ncgear.optimum.makeable.levels import Scales, levels
from ncgear.optimum.makeable.programme import Programme
from ncgear.optimum.makeable.quantities import Place
from ncgear.optimum.makeable.reached import Grid, beyond, grid, ratios, reached
from ncgear.optimum.makeable.stations import Stations, stations
from ncgear.optimum.task import Task
from ncgear.optimum.wishes import Wishes

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
