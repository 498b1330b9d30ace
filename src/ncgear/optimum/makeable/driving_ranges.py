"""Gentle stretches over driving angles: the search holds them over crank angles, moved until no law is better.

The crank angles of a range of driving angles are known only with the law.  A search therefore holds the bound over
given crank angles and demands that the law begins them no later, and ends them no earlier, than the range; such a law
keeps the wish.  A first law gives the crank angles.  Then each end is moved alone, as long as the law found over them
is better.  The certified limit holds the bound where every law is within the range, or divides the laws into cases by
the crank angles at which they begin and end it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from math import pi
from typing import NamedTuple, Protocol, TypeVar

import numpy as np

from ncgear.kinematics.crank_stretches import CrankStretch
from ncgear.optimum.certified.limit import Motion
from ncgear.optimum.makeable.wishes import Wishes
from ncgear.wishes.requirements import DrivingRange, Requirement, passed_no_earlier, passed_no_later
from ncgear.wishes.wish import DrivingWish

STEPS = (0.1, 0.03)
"""Crank angles in rad by which ends are moved, in turn: the second step leaves a degree."""

MOST_MOVES = 4
"""Most moves of one end by a step; a search takes about a second."""

BETTER = 1e-4
"""Least gain of a law that moves crank angles, as a share of the goal."""

LEAST = 1e-3
"""Crank angle in rad that a stretch keeps, from end to end and to the dead centre that it begins or ends at."""


class SearchResult(Protocol):
    """The result of a search."""

    @property
    def motion(self) -> Motion:
        """How the crank turns."""

    def cost(self, first: float) -> float:
        """The goal; where it is ``first``, with the costs of soft wishes."""

    @property
    def goal(self) -> float:
        """The value that is minimized."""


Found = TypeVar("Found", bound=SearchResult)


class Passed(NamedTuple):
    """The least and the greatest crank angle in rad at which laws begin a driving range, and at which they end it."""

    start: tuple[float, float]
    end: tuple[float, float]

    @property
    def width(self) -> float:
        """Difference between the laws in rad of the crank, at the end with the larger difference."""
        return max(most - least for least, most in self)

    def halves(self) -> list[Passed]:
        """Two cases that together have all laws of this case."""
        number = max((0, 1), key=lambda number: self[number][1] - self[number][0])
        least, most = self[number]
        middle = (least + most) / 2.0
        return [Passed(*(*self[:number], part, *self[number + 1 :])) for part in ((least, middle), (middle, most))]

    def bound(self, wish: DrivingWish) -> list[Requirement]:
        """The bound over the crank angles that all these laws pass within the range; empty where there are none."""
        sure = CrankStretch(self.start[1], self.end[0])
        return [wish.bound(sure)] if sure.start_rad < sure.end_rad else []

    def requirements(self, wish: DrivingWish) -> list[Requirement]:
        """Requirements that all these laws keep if they keep the wish."""
        assert wish.driving is not None
        ends = zip(self, wish.driving[:2], strict=True)
        times = [(*passed_no_later(least, at), *passed_no_earlier(most, at)) for (least, most), at in ends]
        return [*self.bound(wish), *times[0], *times[1]]


def passed_by_all(driving: DrivingRange, cycle_rad: float, ratio_min: float, ratio_max: float) -> Passed:
    """The case of every law with i12 = dphi1/dphi2 in a range: the crank turns by phi1/i12_max to phi1/i12_min."""

    def turned(phi1: float) -> tuple[float, float]:
        turns, local = divmod(phi1, cycle_rad)
        before, behind = 2.0 * pi * turns, 2.0 * pi * (turns + 1.0)
        least = max(before + local / ratio_max, behind - (cycle_rad - local) / ratio_min)
        return least, min(before + local / ratio_min, behind - (cycle_rad - local) / ratio_max)

    return Passed(turned(driving.start_rad), turned(driving.end_rad))


def ranges(wishes: Wishes) -> list[int]:
    """Numbers of the motion's wishes over driving angles."""
    return [
        number
        for number, wish in enumerate(wishes.motion)
        if isinstance(wish, DrivingWish) and wish.driving is not None
    ]


def held_as(wishes: Wishes, motion: Motion, cycle_rad: float) -> Wishes:
    """The wishes with every driving range held over the crank angles that a motion passes in it."""
    crank = np.linspace(0.0, 2.0 * pi, 4001)
    slow = 1.0 / np.interp(crank, motion.crank_angle_rad, motion.turning, period=2.0 * pi)
    gone = np.concatenate([[0.0], np.cumsum((slow[1:] + slow[:-1]) / 2.0)])

    def passed(phi1: float) -> float:
        turns, local = divmod(phi1, cycle_rad)
        return 2.0 * pi * turns + float(np.interp(local, gone * cycle_rad / gone[-1], crank))

    for number in ranges(wishes):
        driving = _driving(wishes, number)
        crank_rad = CrankStretch(passed(driving.start_rad), passed(driving.end_rad))
        wishes = _held_over(wishes, number, crank_rad)
    return wishes


def best_held(wishes: Wishes, found: Found, find: Callable[[Wishes, Motion], Found | None]) -> Found:
    """The best law that ``find`` finds, from a motion, with driving ranges held over other crank angles.

    ``found`` is the law for the crank angles of ``wishes``; each end is moved by itself.
    """
    first, ends = found.goal, [(number, end) for number in ranges(wishes) for end in (0, 1)]
    for step in STEPS:
        for number, end in ends:
            for side in (-step, step):
                before = found
                for moved in _moved(wishes, number, end, side):
                    other = find(moved, found.motion)
                    if other is None or not other.cost(first) < found.cost(first) - BETTER * abs(first):
                        break
                    wishes, found = moved, other
                if found is not before:
                    break
    return found


def _moved(wishes: Wishes, number: int, end: int, step: float) -> Iterator[Wishes]:
    """The wishes with an end of a range's crank angles moved further and further; a retracted end stays."""
    crank = _driving(wishes, number).crank
    turn = 2.0 * pi * np.floor(crank[end] / (2.0 * pi))
    if not turn < crank[end] < turn + 2.0 * pi:
        return
    for times in range(1, MOST_MOVES + 1):
        at = list(crank)
        at[end] += times * step
        inside = turn + LEAST < at[end] < turn + 2.0 * pi - LEAST
        if not (inside and LEAST < at[1] - at[0] < 2.0 * pi - LEAST):
            return
        yield _held_over(wishes, number, CrankStretch(*at))


def _driving(wishes: Wishes, number: int) -> DrivingRange:
    driving = getattr(wishes.motion[number], "driving", None)
    assert isinstance(driving, DrivingRange)
    return driving


def _held_over(wishes: Wishes, number: int, crank: CrankStretch) -> Wishes:
    wish = wishes.motion[number]
    assert isinstance(wish, DrivingWish)
    return replace(wishes, motion=(*wishes.motion[:number], wish.held_over(crank), *wishes.motion[number + 1 :]))
