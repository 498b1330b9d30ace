"""A makeable law: the best harmonics under all limits, which then hold between the places of the programme, too."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import pi

import numpy as np

from ncgear.errors import NoSuchMechanism
from ncgear.numerics.arrays import Array
from ncgear.optimum.makeable.conflict import NO_EXCESS, Easing, easings, easings_together
from ncgear.optimum.makeable.equations import Working, programme
from ncgear.optimum.makeable.levels import Level, Scales, levels
from ncgear.optimum.makeable.programme import Programme, Solution
from ncgear.optimum.makeable.quantities import Place
from ncgear.optimum.makeable.reached import Grid, beyond, grid, ratios, reached
from ncgear.optimum.makeable.stations import Stations, stations
from ncgear.optimum.task import Task
from ncgear.optimum.wishes import Wishes
from ncgear.ratio.laws.harmonic import LogSeries, harmonic_law
from ncgear.ratio.laws.staged import staged_law
from ncgear.ratio.train import Train, single
from ncgear.ratio.transmission import Lobes

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

BETWEEN = (
    "a law was found that keeps all limits at the places of the search, and none that keeps them everywhere; limits a "
    "little wider can be kept"
)

LEAST_POWER_W = 1.0
"""Unit of power of a machine that nothing resists."""


@dataclass(frozen=True, eq=False)
class MakeableLaw:
    """Harmonics of ln i12 over the driven angle, shape (harmonics,) each, and the levels reached on the finer grid.

    Of two stages, ``second`` are those of the second one's ratio.
    """

    cosine: Array
    sine: Array
    levels: Sequence[Level]
    reached: Array
    second: LogSeries | None = None

    def train(self, lobes: Lobes) -> Train:
        """The law as gears follow it."""
        if self.second is None:
            return single(harmonic_law(self.cosine, self.sine, lobes))
        return staged_law(self.cosine, self.sine, self.second.cosine, self.second.sine).train

    @property
    def goal(self) -> float:
        """What was to be least, in units of the levels."""
        return float(sum(level.weight * value for level, value in zip(self.levels, self.reached, strict=True)))


def makeable_law(task: Task, wishes: Wishes, starts: Sequence[Array]) -> MakeableLaw:
    """The best law found from starts (coefficients cos 1.., sin 1.., shape (2 harmonics,) each).

    A local optimum, with every limit kept on a grid twenty times finer than the programme's.  Two stages begin by
    halves of the ratio, and end so that the larger of their pressure angles is least.  Raises NoSuchMechanism with
    the limits that cannot be kept together, and for each the nearest value that can be had with the others.
    """
    search = _search(task, wishes)
    # Every pair but the first has an even share of ln i12 at the start
    shared = [np.concatenate([start / (1 + pair) for pair in range(wishes.pairs)]) for start in starts]
    found = [law for start in shared if (law := _kept(search, start)) is not None]
    return min(found, key=lambda law: law.goal) if found else _kept_at_last(search, task, wishes, shared[0])


def shared_law(task: Task, wishes: Wishes, cosine: Array, sine: Array) -> MakeableLaw:
    """A law as it stands, shared over two pairs so that the larger pressure angle is least.

    Coefficients of ln i12 have shape (wishes.harmonics,), and of the wishes only those count that concern each pair.
    Raises NoSuchMechanism where no share keeps them.
    """
    alone = replace(wishes, limits=replace(wishes.limits, working_rad=None))
    search = _search(task, alone)
    named = [(level.of_pairs, level.wish == "pressure_angle_deg") for level in search.programme.levels]
    of_pairs, angle = np.array(named).T
    whole = np.concatenate([cosine, sine])
    split = replace(
        search,
        programme=replace(search.programme, held=whole),
        caps=np.where(of_pairs, search.caps, np.inf),
        weights=angle.astype(float),
    )
    start = np.concatenate([whole, whole / 2.0])
    return _kept(split, start) or _kept_at_last(split, task, alone, start)


@dataclass(frozen=True, eq=False)
class _Search:
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


def _kept_at_last(search: _Search, task: Task, wishes: Wishes, start: Array) -> MakeableLaw:
    """The law from the one that comes nearest to keeping all limits; raises NoSuchMechanism where there is none."""
    near = search.programme.nearest(search.caps, np.zeros(search.caps.size), 1.0, start)
    if near is None:
        raise NoSuchMechanism("no law was found, not even one that oversteps the limits", key="optimize.limits")
    if near.excess <= NO_EXCESS:
        law = _kept(search, near.coefficients)
        if law is None:
            raise NoSuchMechanism(BETWEEN, key="optimize.limits")
        return law
    raise _cannot_be(search, near, _free_working(task, wishes, near))


def _search(task: Task, wishes: Wishes) -> _Search:
    count = max(PLACES_PER_HARMONIC * wishes.harmonics, FEWEST_PLACES)
    coarse = stations(task.linkage, task.resistance, count)
    finer = stations(task.linkage, task.resistance, FINER * count)
    wanted = levels(wishes, scales(task, finer))
    working = (
        None
        if wishes.limits.working_rad is None
        else Working(task.linkage.working_angle_rad, wishes.limits.working_rad)
    )
    return _Search(
        programme(wanted, grid(coarse, wishes.harmonics), task.cycle_rad, working, wishes.pairs),
        grid(finer, wishes.harmonics),
        np.array([np.inf if level.limit is None else level.limit for level in wanted]),
        np.array([level.weight for level in wanted]),
    )


def scales(task: Task, at: Stations) -> Scales:
    """Units of the order of what a uniform crank feels."""
    turning = task.speed_rad_s * 2.0 * pi / task.cycle_rad
    power = float(np.max(at.force_n * at.first)) * turning / 1000.0
    return Scales(task.speed_rad_s, task.linkage.crank_mm * turning**2, max(power, LEAST_POWER_W))


def _kept(search: _Search, start: Array) -> MakeableLaw | None:
    """The law from one start, solved again until all limits hold on the finer grid.

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
            return _law(search, coefficients, values)
        kept_back = np.maximum(kept_back, search.beyond(coefficients) + MARGIN)
        if tried >= PATIENCE:
            caps = caps - over
        # Where the next one is too far to go on to, afresh from the same place
        onwards = search.programme.solved(caps, search.weights, found, kept_back)
        found = onwards or search.programme.solved(caps, search.weights, found.coefficients, kept_back)
    return None


def _law(search: _Search, coefficients: Array, values: Array) -> MakeableLaw:
    cosine, sine, *second = coefficients.reshape(2 * search.programme.pairs, -1)
    return MakeableLaw(cosine, sine, search.programme.levels, values, LogSeries(*second) if second else None)


def _cannot_be(search: _Search, near: Solution, others: Sequence[Easing]) -> NoSuchMechanism:
    """The refusal: what each limit would have to be with all the others, or all of them together."""
    given = search.programme, search.caps, near, search.reached
    said, found = "no law was found that keeps all limits; one of these is enough", [*easings(*given), *others]
    if not found:
        said, found = (
            said.replace("one of these is enough", "all of these are enough together"),
            list(easings_together(*given)),
        )
    return NoSuchMechanism(
        f"{said}: {', '.join(map(str, found)) or 'none known'}",
        key=f"optimize.limits.{found[0].wish}" if found else "optimize.limits",
    )


def _free_working(task: Task, wishes: Wishes, near: Solution) -> list[Easing]:
    """Whether a working stroke of another driving angle would be enough."""
    if wishes.limits.working_rad is None:
        return []
    search = _search(task, replace(wishes, limits=replace(wishes.limits, working_rad=None)))
    found = search.programme.nearest(search.caps, np.zeros(search.caps.size), 1.0, near.coefficients)
    kept = found is not None and found.excess <= NO_EXCESS
    return [Easing("working_angle_rad", "a working stroke of another driving angle")] if kept else []
