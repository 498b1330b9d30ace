"""The search for a law under levels: its start, and the way to keep limits everywhere.

The programme of ``programme.py`` keeps limits at its own places.  It is solved again until all limits hold at places at
least eight times as dense.  Each time the bound of a term is lowered by the term's rise between the places, and
integrals over a turn are corrected by the finer places.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import ceil, log10, pi

import numpy as np

from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array
from ncgear.optimum.certified.limit import Motion
from ncgear.optimum.makeable.levels import LevelKind, WishLevel, machine_scales
from ncgear.optimum.makeable.places import CellPlaces, cell_ends, places
from ncgear.optimum.makeable.programme import LawProgramme, Solution, programme
from ncgear.optimum.makeable.reached import JudgedLaw, ratios
from ncgear.optimum.makeable.spline import SplineRows, even_knots
from ncgear.optimum.makeable.wishes import Scales, Wishes, levels
from ncgear.optimum.task import Task

STEPS = 2
"""Steps of the programme's places in a cell: both ends and the middle."""

STRAYING = 0.3
"""Standard deviation of the first random harmonic of ln i12 that makes other starts from the usual start; the n-th
harmonic has an n-th of it.  Ratios then begin up to three times as large or as small."""

STRAYING_WAVES = (1.0, 2.0, 3.0)

FINER = 16
"""Fewest steps of the judge's places in a cell."""

FINER_TURN = 2880
"""Fewest steps of the judge's places between even knots in a turn.  The error of a parabola at a peak falls with the
third power of the step, and is under a millionth with a tenth of these steps."""

FINEST = 256
"""Most steps of the judge's places in a cell, for narrow peaks of the force."""

ROOM = 1e-7
"""Distance of laws below their caps, in units of the levels: more than the error of the judge's parabolas."""

ROUNDS = 6
"""Most rounds in which the programme is solved again; usually there are three."""

PATIENCE = 2
"""Rounds that only keep terms back at the places, before caps are lowered too: each leaves a tenth of the excess over
the caps, or less."""

MARGIN = 1e-6
"""Further lowering of the bounds of terms, in their units, for their rise between the places of the finer grid."""

TOLD = 1e-4
"""Largest shortfall of a soft wish beyond the value at the places, as a share of the wish: four digits are shown."""

RISEN = 5e-3
"""Largest rise of a goal between the places, as a share of it: forces and accelerations rise by a hundredth of this, a
jerk beside a dead centre by a fifteenth of itself."""

DECIMALS = 10
"""Decimals of the ratios at the knots, so that the judged law is the law in the design file."""

ROUNDED_KNOTS = 180
"""Most knots for which these decimals suffice: rounding dents a curve by the square of the number of knots."""

EVEN_CELLS = 120
"""Cells for the greatest power of a uniform crank, which is only a unit."""

LEAST_POWER_W = 1.0
"""Least unit of power, for a machine that nothing resists."""


@dataclass(frozen=True, eq=False)
class LawSearch:
    """A programme, the places that judge it and the splines there, and the caps and weights of its levels."""

    programme: LawProgramme
    finer: CellPlaces
    basis: SplineRows
    caps: Array
    weights: Array
    ratio_range: tuple[float, float]

    def begun(self, motion: Motion) -> Array:
        """Coefficients of splines along a motion, within the limits of the ratio; two pairs share ln i12 evenly."""
        logarithm = np.clip(-np.log(motion.turning), *np.log(self.ratio_range))
        pairs, knots = len(self.programme.cycles_rad), self.programme.knots
        return np.concatenate([knots.smoothed(motion.crank_angle_rad, logarithm) / (1 + pair) for pair in range(pairs)])

    def elsewhere(self, begun: Array, number: int) -> Array:
        """Another start from ``begun``, with random harmonics in each pair's ln i12; ``number`` seeds them."""
        pairs, random = len(self.programme.cycles_rad), np.random.default_rng(number)
        angle = np.linspace(0.0, 2.0 * pi, begun.size // pairs, endpoint=False)
        waves = np.array([shape(wave * angle) / wave for wave in STRAYING_WAVES for shape in (np.cos, np.sin)])
        return begun + (STRAYING * random.normal(size=(pairs, len(waves))) @ waves).ravel()

    def judged(self, ratio: Array) -> JudgedLaw:
        """A law by its ratios at the knots, shape (pairs, n), at the judge's places."""
        coefficients = np.concatenate([self.programme.knots.coefficients(np.log(own)) for own in ratio])
        law = ratios(self.finer, self.basis, coefficients, self.programme.cycles_rad)
        return JudgedLaw(self.programme.levels, self.finer, law)

    def rounded(self, coefficients: Array) -> Array:
        """Ratios at the knots as a file holds them, shape (pairs, n)."""
        each = coefficients.reshape(len(self.programme.cycles_rad), -1)
        values: Array = np.exp(np.array([self.programme.knots.values(own) for own in each]))
        more = ceil(2.0 * log10(max(self.programme.knots.count / ROUNDED_KNOTS, 1.0)))
        return np.round(values, DECIMALS + more)

    def nearest(self, start: Array) -> Solution | None:
        """The law nearest to keeping all limits, from coefficients; None where none is found."""
        return self.programme.nearest(self.caps, np.zeros(self.caps.size), 1.0, start)

    def reached(self, coefficients: Array) -> Array:
        """Levels of a law with rounded ratios, shape (levels,)."""
        return self.judged(self.rounded(coefficients)).reached


@dataclass(frozen=True, eq=False)
class Kept:
    """Ratios at the knots that keep all limits, shape (pairs, n), and the levels that they reach, shape (levels,)."""

    ratio: Array
    reached: Array


def searched(task: Task, wishes: Wishes) -> LawSearch:
    """The search for the law that a task and wishes ask for."""
    knots = even_knots(wishes.knots)
    wanted = levels(wishes, scales(task))
    ends = cell_ends(task, knots.angle_rad, [level.stretch for level in wanted])
    finer = _judging(task, ends, FINER * max(1, ceil(FINER_TURN / (FINER * wishes.knots))))
    cycles = task.cycle_rad, 2.0 * pi
    return LawSearch(
        programme(wanted, knots, places(task, ends, STEPS), cycles[: wishes.pairs]),
        finer,
        knots.rows(finer.angle_rad),
        np.array([level.cap for level in wanted]),
        goal_weights(wanted, sum(level.weight for level in wanted)),
        (wishes.limits.ratio_min, wishes.limits.ratio_max),
    )


def _judging(task: Task, ends_rad: Array, steps: int) -> CellPlaces:
    """The judge's places: ``steps`` steps in a cell, or more until parabolas through them tell the force."""
    found = places(task, ends_rad, steps)
    force = found.slider.force_n[found.number]
    # Through every second place, at the places between; with every place the parabolas miss an eighth of it
    missed = (3.0 * force[:, :-4:4] + 6.0 * force[:, 2:-2:4] - force[:, 4::4]) / 8.0 - force[:, 1:-3:4]
    told = np.abs(missed).max() / 8.0 <= ROOM * np.abs(force).max()
    return found if told or 2 * steps > FINEST else _judging(task, ends_rad, 2 * steps)


def goal_weights(wanted: Sequence[WishLevel], goal: float) -> Array:
    """The cost of a unit of every level where the goal is about ``goal``, shape (levels,)."""
    return np.array([level.weight + level.share_of_goal * goal for level in wanted])


def cost(wanted: Sequence[WishLevel], weights: Array, reached: Array) -> float:
    """The cost of reached levels together, shape (levels,) each; below its floor a level costs no less."""
    return float(weights @ np.maximum(reached, [level.least for level in wanted]))


def scales(task: Task) -> Scales:
    """Units of the order of the forces at a uniform crank."""
    turning = task.speed_rad_s * 2.0 * pi / task.cycle_rad
    slider = places(task, cell_ends(task, even_knots(EVEN_CELLS).angle_rad, []), STEPS).slider
    power = float(np.max(slider.force_n * slider.first)) * turning / 1000.0
    acceleration = task.linkage.half_way * turning**2
    loads = None if task.masses is None else machine_scales(task, slider)
    return Scales(task, acceleration, max(power, LEAST_POWER_W), loads)


def kept(search: LawSearch, start: Array | Solution) -> Kept | None:
    """The best law from a start, solved again until all limits hold on the finer grid; None where they never hold.

    The bound of every term is lowered at each place by the term's rise beside the place; in the last rounds the rest is
    taken off the caps.  A law whose soft wish falls short, or whose goal rises, between the places is solved again,
    too; the law with the least cost is taken.
    """
    programme = search.programme
    blocks, coarse, levels = programme.rows.blocks, programme.rows.at, programme.levels
    exact = np.concatenate([np.full(b.places.size, levels[b.level].kind is LevelKind.DEVIATION) for b in blocks])
    room = np.array([0.0 if level.kind is LevelKind.DEVIATION else ROOM for level in levels])
    priced = search.weights > 0.0
    soft = np.array([level.share_of_goal > 0.0 for level in levels]) & priced
    caps, kept_back, laws = search.caps.copy(), np.zeros(exact.size), []
    found = programme.solved(caps, search.weights, start, kept_back)
    for tried in range(ROUNDS):
        if found is None:
            break
        ratio = search.rounded(found.coefficients)
        judged = search.judged(ratio)
        over = np.maximum(judged.reached - search.caps + room, 0.0)
        if not np.any(over):
            laws.append(Kept(ratio, judged.reached))
            risen = judged.reached - found.levels
            if not np.any(risen[soft] > TOLD) and not np.any(risen[priced] > RISEN * np.abs(found.levels[priced])):
                break
        beyond = judged.beyond(blocks, coarse)
        kept_back = np.where(exact, beyond, np.maximum(kept_back, beyond + MARGIN))
        if tried >= PATIENCE:
            caps = caps - over
        # Where the next solution is too far away to continue, solve afresh from the coefficients
        missed = judged.missed(coarse)
        onwards = programme.solved(caps, search.weights, found, kept_back, missed)
        found = onwards or programme.solved(caps, search.weights, found.coefficients, kept_back, missed)
    return min(laws, key=lambda law: cost(levels, search.weights, law.reached), default=None)
