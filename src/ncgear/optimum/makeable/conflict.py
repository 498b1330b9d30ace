"""Which limits of a makeable law are in each other's way, and the nearest values that can be had."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import NamedTuple

import numpy as np

from ncgear.numerics.arrays import Array
from ncgear.optimum.makeable.levels import CONVEX, Level
from ncgear.optimum.makeable.programme import Programme, Solution

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
