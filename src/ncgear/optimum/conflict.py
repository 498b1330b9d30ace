"""Which limits of a makeable law are in each other's way, and the nearest values that can be had."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import NamedTuple

import numpy as np

from ncgear.numerics.arrays import Array
from ncgear.optimum.levels import CONVEX
from ncgear.optimum.programme import Programme, Solution

NO_EXCESS = 1e-6
"""Excess over caps that counts as none: far under what is left between the places of the programme."""

PRESSING = 1e-4
"""Share of a cap in what keeps the excess up, below which it has none."""

DEARER = 10.0
"""How much more an excess over the other caps costs than what it can gain, so that there is none if there need not."""

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
    shares = zip(programme.levels, near.pressing, strict=True)
    return list(dict.fromkeys(level.wish for level, share in shares if share > PRESSING))


def easings(programme: Programme, caps: Array, near: Solution, judge: Judge) -> Iterator[Easing]:
    """Of each wish that presses the nearest value with which all others can be kept, if there is one."""
    for wish in pressing(programme, near):
        freed = np.array([level.wish == wish for level in programme.levels])
        least = np.where(freed, 0.0 if wish == CONVEX else 1.0, 0.0)
        free = np.where(freed, ANY_DENT if wish == CONVEX else np.inf, caps)
        found = programme.nearest(free, least, DEARER / float(near.pressing[freed].sum()), near.coefficients)
        if found is not None and found.excess <= NO_EXCESS:
            yield _easing(programme, wish, judge(found.coefficients))


def easings_together(programme: Programme, near: Solution, judge: Judge) -> Iterator[Easing]:
    """Of each wish that presses the value in the nearest law: those that can be had together."""
    reached = judge(near.coefficients)
    for wish in pressing(programme, near):
        yield _easing(programme, wish, reached)


def _easing(programme: Programme, wish: str, reached: Array) -> Easing:
    value, level = max(
        ((value, level) for value, level in zip(reached, programme.levels, strict=True) if level.wish == wish),
        key=lambda one: one[0],
    )
    return Easing(wish, level.shown(float(value)))
