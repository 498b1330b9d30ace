"""Branch and bound: no motion is below a target if every part of the motions below it is proven empty.

A part is a box: ranges of q at the checkpoints (``ranges``), and of the figures that a sum counts.  The programmes of
its motions give the least and the greatest q at each checkpoint, which narrow the box; narrower ranges allow narrower
rows, which narrow it again.  A box is finished where it allows no motion, or where its least value is not below the
target.  Another box is narrowed as long as that pays, and then cut in two where it is widest.  Every bound of a box is
proven by multipliers (``proof``), and each cut leaves every motion in one of both halves.

If some boxes are not finished after a share of the allowed programmes, the target is lowered.  Facts about motions
below a target also hold for motions below a lower target, so the search continues with the remaining boxes.  Where all
boxes are finished, and programmes remain, a target between is tried.  In the end no motion is below the highest proven
target, or below the least value of any remaining box.

This is spatial branch and bound (A. H. Land and A. G. Doig, Econometrica 28 (1960); H. S. Ryoo and N. V. Sahinidis,
J. Glob. Optim. 8 (1996)) with the tightening of bounds by optimization and its filter (A. M. Gleixner et al., "Three
enhancements for optimization-based bound tightening", J. Glob. Optim. 67 (2017)).
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from itertools import chain
from math import ceil, inf, log, sqrt

import numpy as np

from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array, IndexArray
from ncgear.optimum.certified.cycle import CrankCycle
from ncgear.optimum.certified.demands import Demands, NearMotion, Ranges
from ncgear.optimum.certified.motion import MotionProgramme
from ncgear.optimum.certified.proof import Linear, Proof, Solver, proof_of
from ncgear.optimum.certified.ranges import CheckpointPlaces, KnownRanges, between, parts_between


@dataclass(frozen=True, eq=False)
class TriedMotion:
    """A certain least value of a programme, and q at the places of a motion near it; None without a motion."""

    value: float
    q: Array | None


@dataclass(frozen=True, eq=False)
class Solved:
    """A value, and q at the places of a motion near it."""

    value: float
    q: Array


FigureRanges = Mapping[str, tuple[float, float]]
"""Ranges of the figures that a sum counts, by their names in ``Demands``."""


@dataclass(frozen=True, eq=False)
class Trials:
    """The programmes of a cycle as functions.

    ``least`` gives the least value of the goal with ranges of q, or near a motion (see ``problem.motion_programme``),
    in ranges of figures; ``below`` gives the programme of all motions in them whose goal is below a value.  ``prices``
    are the prices of the figures.
    """

    on: CrankCycle
    least: Callable[[Ranges | NearMotion | None, FigureRanges, float], TriedMotion]
    below: Callable[[Ranges | None, FigureRanges, float], MotionProgramme]
    prices: Mapping[str, float]


@dataclass(frozen=True)
class Effort:
    """The effort for the proof of a limit: solved programmes, and parts into which the motions were divided.

    ``places`` is the number of places of its grid; ``ended`` tells whether the limit is as near to the law as this grid
    allows.
    """

    programmes: int
    parts: int
    places: int
    ended: bool


@dataclasses.dataclass
class Budget:
    """Numbers of allowed and of solved programmes; ``tell`` is called with both.

    They are counted, and no time is taken, so that the same limit comes out on every computer.
    """

    most: int
    tell: Callable[[int, int], None] = lambda used, most: None
    used: int = 0
    parts: int = 1

    def spend(self, programmes: int) -> None:
        """Count programmes that will be solved."""
        self.used += programmes
        self.tell(min(self.used, self.most), self.most)


STEPS = 3
"""Steps along the tangent: the motion found keeps the driving curve convex, and three steps find all of it but 1e-6."""

ENOUGH = 0.001
"""Largest distance of the limit from the motion's value, as a share of it: the law itself is about as far from it."""

WIDENED = 1.03
"""Factor to each side of the law's own q: motions in these ranges show the error of the grid."""

OVER_GRID = 0.3
"""Distance of a target from the law beyond the grid's error, as a share of it: nearer, boxes at the law do not end."""

EASIER = 1.3
"""Factor by which the next target is farther from the law, where the remaining boxes have come far."""

FAR = 0.5
"""Share of the way to a target that the least value of any box left has come to count as far; else the next target is
halfway back to that value."""

TOO_NEAR = 1e-3
"""Least distance of the next target over a value, as a share of the value."""

PHASE = 0.5
"""Share of the programmes left that a target may take."""

NARROW = 1.1
"""Ratio of the ends of a range of q in which the relations are almost exact."""

WORTH = 0.85
"""A box is narrowed again while a round leaves less than this share of its widths."""

WORTH_ALONE = 0.93
"""The same for boxes that are not divided."""

OF_FIGURE = 4.0
"""A figure of a sum is divided where its width, as a share of its greatest value, is over the widest of ln q by this
factor: the time of a cell goes with the root of q, and the planes of both touch only at the ends."""

LEAST_FIGURE = 1e-3
"""Least greatest value of a figure as a share of the target, since rows are scaled by it."""

LEAST_GAIN = 0.1
"""Least possible move of one side of a range, as a share of its width, for which a programme is solved."""


def motion_along(trials: Trials, found: Solved) -> Solved:
    """The motion after a few steps from another motion, along the tangent of the driving curve's relation."""
    for _ in range(STEPS):
        near = NearMotion(found.q, np.log(np.roll(found.q, -1) / found.q) / trials.on.step_rad)
        step = trials.least(near, {}, inf)
        if step.q is None:
            break
        found = Solved(step.value, step.q)
    return found


@dataclass(frozen=True, eq=False)
class MotionBox:
    """Motions in ranges of q and of figures; ``value`` is a certain lower bound of those below the target."""

    known: KnownRanges
    figures: FigureRanges
    value: float


@dataclass(frozen=True, eq=False)
class Tree:
    """The stretches of the ranges of q; it narrows and divides boxes of these ranges."""

    trials: Trials
    checkpoints: Sequence[int]
    between: CheckpointPlaces
    budget: Budget
    solver: Solver

    def emptied(self, boxes: Sequence[MotionBox], target: float, until: int) -> list[MotionBox]:
        """The boxes that remain in the search for motions below a target."""
        left, stuck = list(boxes), []
        while left and self.budget.used < until:
            box = self.narrowed(left.pop(), target)
            if box is None:
                continue
            if not (halves := self.halves(box)):
                # No wider than the relations can tell: this target is out of reach
                stuck.append(box)
                break
            self.budget.parts += 1
            tried = [self.bounded(half, target) for half in halves]
            # The half with the higher value comes first, so that few boxes remain beside the hardest
            left += sorted((half for half in tried if half is not None), key=lambda half: half.value)
        return [*left, *stuck]

    def narrowed(self, box: MotionBox, target: float, worth: float = WORTH) -> MotionBox | None:
        """A box narrowed in rounds to motions below a target; None where it has none."""
        while True:
            before = self.widths(box).sum()
            after = self.round(box, target)
            if after is None:
                return None
            after = self.bounded(after, target)
            if after is None or self.widths(after).sum() > worth * before:
                return after
            box = after

    def round(self, box: MotionBox, target: float) -> MotionBox | None:
        """A box with the range at each checkpoint, and of each figure, narrowed once; None where a range is empty."""
        seen = Seen(self.trials.on.count)
        for name in box.figures if len(box.figures) > 1 else ():
            made = self.trials.below(self.between.everywhere(box.known), box.figures, target)
            proof, of, (low, high) = proof_of(made.programme), made.figures[name], box.figures[name]
            low = max(low, self.answer(proof, of, made.q, seen))
            high = min(
                high, max(-self.answer(proof, -of, made.q, seen), LEAST_FIGURE * target / self.trials.prices[name])
            )
            if low > high:
                return None
            box = replace(box, figures={**box.figures, name: (low, high)})
        for place in self.checkpoints:
            low, high = box.known.least[place], box.known.most[place]
            if high < NARROW * low or not (sides := seen.worth(place, low, high)):
                continue
            made = self.trials.below(self.between.everywhere(box.known), box.figures, target)
            proof, of = proof_of(made.programme), made.q[place : place + 1]
            for side in sides:
                answer = self.answer(proof, of * side, made.q, seen)
                bounds = (answer, inf) if side > 0.0 else (0.0, -answer)
                box = replace(box, known=box.known.within(place, *bounds))
            if box.known.empty:
                return None
        return box

    def answer(self, proof: Proof, goal: Linear, q: Linear, seen: Seen) -> float:
        """The certain least value of a goal in a programme; ``seen`` receives q of the motion near it."""
        self.budget.spend(1)
        answer = self.solver.least(proof, goal)
        if answer.near is not None:
            seen.add(answer.near[q.columns[0]])
        return answer.value

    def bounded(self, box: MotionBox, target: float) -> MotionBox | None:
        """A box with the bounds between checkpoints, and its least value; None if that is not below a target."""
        ranges = self.between.everywhere(box.known)
        known = KnownRanges(np.maximum(box.known.least, ranges.least), np.minimum(box.known.most, ranges.most))
        if known.empty:
            return None
        self.budget.spend(1)
        value = max(self.trials.least(ranges, box.figures, target).value, box.value)
        if value >= target:
            return None
        figures = box.figures
        if len(figures) == 1:
            # The goal is this figure
            [(name, (low, high))] = figures.items()
            figures = {name: (max(low, value / self.trials.prices[name]), high)}
        return MotionBox(known, figures, value)

    def halves(self, box: MotionBox) -> list[MotionBox]:
        """A box cut in two where ln q, or a figure of a sum, is widest; none where ln q is narrow everywhere."""
        known = box.known
        place = self.checkpoints[int(np.argmax(self.widths(box)))]
        low, high = float(known.least[place]), float(known.most[place])
        if high < NARROW * low:
            return []
        if len(box.figures) > 1:
            name = max(
                box.figures, key=lambda name: self.trials.prices[name] * (box.figures[name][1] - box.figures[name][0])
            )
            least, most = box.figures[name]
            if OF_FIGURE * (most - least) > most * log(high / low):
                middle = (least + most) / 2.0
                parts = (least, middle), (middle, most)
                return [replace(box, figures={**box.figures, name: part}) for part in parts]
        middle = sqrt(low * high)
        return [replace(box, known=known.within(place, *part)) for part in ((0.0, middle), (middle, inf))]

    def lacking(self, motion: Solved, figures: Mapping[str, float]) -> float:
        """Distance of the programme's least value near a motion below the motion's own value: the error of the grid."""
        known = KnownRanges(motion.q / WIDENED, motion.q * WIDENED)
        room = (WIDENED - 1.0) * motion.value
        about = {
            name: (value / WIDENED, value * WIDENED + room / self.trials.prices[name])
            for name, value in figures.items()
        }
        self.budget.spend(1)
        found = self.trials.least(self.between.everywhere(known), about, WIDENED * motion.value)
        return max(motion.value - found.value, 0.0)

    def widths(self, box: MotionBox) -> Array:
        """The widths of ln q at the checkpoints, shape (k,)."""
        return np.asarray(np.log(box.known.most[self.checkpoints] / box.known.least[self.checkpoints]))


class Seen:
    """The least and the greatest q at the places of all motions found while a box is narrowed, shape (n,).

    An end of a range near which a motion was seen will hardly move.
    """

    def __init__(self, count: int) -> None:
        self.least, self.most = np.full(count, inf), np.zeros(count)

    def add(self, q: Array) -> None:
        """Take in the q of a motion at all places."""
        self.least, self.most = np.minimum(self.least, q), np.maximum(self.most, q)

    def worth(self, place: int, low: float, high: float) -> list[float]:
        """The sides of a range that may move by enough: 1 for the lower side, -1 for the upper side."""
        room = LEAST_GAIN * log(high / low)
        sides = {1.0: log(max(self.least[place], low) / low), -1.0: log(high / max(min(self.most[place], high), low))}
        return [side for side, gain in sides.items() if gain > room]


def bisected(trials: Trials, parts: Sequence[IndexArray], without: float, motion: Solved, asked: Demands) -> float:
    """A certain least value with ranges of q in parts of the turn (places in a row each), from a single box.

    ``without`` is the limit without ranges, ``motion`` keeps all relations.  The target is halved towards the limit.
    """
    tree, box = whole_tree(trials, parts, without, motion, asked, Budget(0))
    target = (1.0 - ENOUGH) * motion.value
    while target > box.value * (1.0 + TOO_NEAR):
        narrowed = tree.narrowed(box, target, WORTH_ALONE)
        if narrowed is None:
            return target
        box, target = narrowed, (narrowed.value + target) / 2.0
    return box.value


def proven(tree: Tree, whole: MotionBox, law: float, lacking: float) -> tuple[float, Effort]:
    """A certain least value from divided boxes, and the effort; ``lacking`` is the error of the grid at the law."""
    budget, without = tree.budget, whole.value
    # First a single box: it may be narrow enough for the highest target
    target = (1.0 - ENOUGH) * law
    boxes, failed = tree.emptied([whole], target, budget.used + 1), target
    value = min((box.value for box in boxes), default=target)
    target = nearest = min(target, law - (1.0 + OVER_GRID) * lacking)
    while value < nearest and budget.used < budget.most and target > value * (1.0 + TOO_NEAR):
        left = tree.emptied(boxes, target, budget.used + ceil(PHASE * (budget.most - budget.used)))
        if not left:
            # Boxes that remain of a higher target hold for all lower targets
            value, target = target, (target + failed) / 2.0
            continue
        boxes, failed = left, target
        lowest = min(box.value for box in boxes)
        easier = law - EASIER * (law - target)
        far = lowest - without > FAR * (target - without) and easier > value
        value = max(value, lowest)
        target = easier if far else (value + target) / 2.0
    return value, Effort(budget.used, budget.parts, tree.trials.on.count, budget.used < budget.most)


def whole_tree(
    trials: Trials, parts: Sequence[IndexArray], without: float, motion: Solved, asked: Demands, budget: Budget
) -> tuple[Tree, MotionBox]:
    """The tree and the box of all motions, with ranges in parts of the turn; see ``bisected``."""
    on = trials.on
    stretches = [parts_between(on, places, motion.q[places], asked) for places in parts]
    ends = [int(end) for own in stretches for end in (*(part[0] for part in own), own[-1][-1])]
    known = KnownRanges(np.full(on.count, asked.ratio_max**-2.0), np.full(on.count, asked.ratio_min**-2.0))
    tree = Tree(trials, ends, between(on, [*chain(*stretches)], asked), budget, Solver())
    return tree, MotionBox(known, dict.fromkeys(trials.prices, (0.0, inf)), without)
