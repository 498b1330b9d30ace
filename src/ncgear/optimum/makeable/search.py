"""The search for a law under levels: where it starts, and how limits come to be kept everywhere.

The programme of ``programme.py`` keeps limits at its own places.  It is solved again, with each term kept back by as
much as it rises between those places, until a grid twenty times finer finds all limits kept.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from math import pi

import numpy as np

from ncgear.errors import NoSuchMechanism
from ncgear.numerics.arrays import Array
from ncgear.optimum.certified.limit import fastest_motion
from ncgear.optimum.makeable.programme import Programme, Working, programme
from ncgear.optimum.makeable.quantities import Place
from ncgear.optimum.makeable.reached import Grid, Stations, beyond, grid, hidden_tops_mm, ratios, reached, stations
from ncgear.optimum.makeable.wishes import Scales, Wishes, levels
from ncgear.optimum.task import Task

PLACES_PER_HARMONIC = 10
"""Places of the programme: ten on the shortest wave, so that little is left between them."""

FEWEST_PLACES = 240
"""Fewest places: resistance and mechanism have waves of their own, as short where a law has few harmonics."""

FINER = 20
"""How many times finer the grid is that judges the law: with ten times, the parabolas between its places missed the
curvature of 36 harmonics by more than the margin."""

ROUNDS = 6
"""Most rounds in which the programme is solved again; three are the rule."""

PATIENCE = 2
"""Rounds that only keep terms back at the places, before caps are lowered too: each leaves a tenth of the excess over
the caps, or less."""

MARGIN = 1e-6
"""How much more terms are kept back, in their units, for what is left between the places of the finer grid."""

DECIMALS = 10
"""Decimals of the coefficients, so that the law that is judged is the one that a design file holds."""

LEAST_POWER_W = 1.0
"""Least unit of power, for a machine that nothing resists."""

Form = Callable[[Stations, int], Grid]
"""Gives a form of ln i12 as matrices at places; the number is that of its harmonics, or of other coefficients."""


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
    """The search for the law that a task and wishes ask for.

    Other forms than harmonics are for studies of accuracy; they take no working stroke of a given angle.
    """
    count = max(PLACES_PER_HARMONIC * wishes.harmonics, FEWEST_PLACES)
    coarse = stations(task.linkage, task.resistance, count)
    finer = stations(task.linkage, task.resistance, FINER * count)
    wanted = levels(wishes, scales(task, finer))
    if any(level.wish == "peak_power_w" for level in wanted):
        _require_shown_tops(task, finer)
    driving_rad = wishes.limits.working_rad
    working = None if driving_rad is None else Working(task.linkage.working_angle_rad, driving_rad)
    return Search(
        programme(wanted, form(coarse, wishes.harmonics), task.cycle_rad, working, wishes.pairs),
        form(finer, wishes.harmonics),
        np.array([np.inf if level.limit is None else level.limit for level in wanted]),
        np.array([level.weight for level in wanted]),
    )


def _require_shown_tops(task: Task, finer: Stations) -> None:
    """Refuse a resistance with a top so narrow that the places miss it, for the power there would not be limited."""
    hidden = hidden_tops_mm(finer, task.linkage, task.resistance)
    if hidden.size:
        top = float(task.resistance.force_n(hidden[:1])[0])
        raise NoSuchMechanism(
            f"the peak of {top:.4g} N at {hidden[0]:.6g} mm is too narrow for the search of a law, which looks at the "
            f"force at {finer.count} places of a turn; a wider peak, or limits and a goal without power, are needed",
            key="resistance",
        )


def scales(task: Task, at: Stations) -> Scales:
    """Units of the order of what a uniform crank feels."""
    turning = task.speed_rad_s * 2.0 * pi / task.cycle_rad
    power = float(np.max(at.slider.force_n * at.slider.first)) * turning / 1000.0
    return Scales(task.speed_rad_s, task.linkage.crank_mm * turning**2, max(power, LEAST_POWER_W))


def kept(search: Search, start: Array) -> Kept | None:
    """The best coefficients from one start, solved again until all limits hold on the finer grid; None where none do.

    Every term is kept back at each place by as much as it rises beside the place.  Each round leaves less excess; in
    the last rounds, what is left is taken off the caps as well.
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
        # Where the next solution is too far away to be reached from this one, solve afresh from its coefficients
        onwards = search.programme.solved(caps, search.weights, found, kept_back)
        found = onwards or search.programme.solved(caps, search.weights, found.coefficients, kept_back)
    return None


SPREAD = 0.3
"""Standard deviation of the first harmonics of a start at random; higher ones fall off with their number."""

RESAMPLED = 16
"""Places per harmonic at which the fastest motion is read."""


def rough_start(task: Task, wishes: Wishes, peak_acceleration_mm_s2: float) -> Array:
    """Coefficients cos 1.., sin 1.. of the fastest motion under a peak of acceleration, its corners smoothed.

    Its ratio jumps; Lanczos' sigma factors on the harmonics remove the overshoot at the jumps.
    """
    limits = replace(wishes.limits, peak_acceleration_mm_s2=peak_acceleration_mm_s2)
    motion = fastest_motion(task, limits)
    count = RESAMPLED * wishes.harmonics
    angle = np.linspace(0.0, 2.0 * np.pi, count, endpoint=False)
    lowest, highest = np.log(limits.ratio_min), np.log(limits.ratio_max)
    logarithm = np.clip(-np.log(np.interp(angle, motion.crank_angle_rad, motion.slope)), lowest, highest)
    spectrum = np.fft.rfft(logarithm)[1 : wishes.harmonics + 1] * (2.0 / count)
    smoothed = spectrum * np.sinc(np.arange(1, wishes.harmonics + 1) / (wishes.harmonics + 1))
    return np.concatenate([smoothed.real, -smoothed.imag])


def random_starts(harmonics: int, count: int, seed: int) -> Sequence[Array]:
    """``count`` random starts; the same seed gives the same ones."""
    random = np.random.default_rng(seed)
    falling = SPREAD / np.tile(np.arange(1.0, harmonics + 1.0), 2)
    return [random.normal(size=2 * harmonics) * falling for _ in range(count)]
