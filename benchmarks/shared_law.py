"""What two pairs in series gain from a law that was made for one: the law as it stands, shared over both."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from ncgear.errors import NoSuchMechanism
from ncgear.numerics.arrays import Array
from ncgear.optimum.makeable.law import MakeableLaw, law_of
from ncgear.optimum.makeable.programme import LawProgramme
from ncgear.optimum.makeable.search import kept, searched
from ncgear.optimum.makeable.wishes import Wishes
from ncgear.optimum.task import Task

HAIR = 1e-7
"""Room of each held coefficient, so that the angle of the turn, an equation, closes by the finer places too."""


@dataclass(frozen=True, eq=False, kw_only=True)
class HeldProgramme(LawProgramme):
    """A programme of two pairs in which the coefficients of i12 are held as they are, shape (knots,)."""

    held: Array

    def coefficient_bounds(self, size: int) -> tuple[Array, Array]:
        lowest, highest = super().coefficient_bounds(size)
        lowest[: self.held.size], highest[: self.held.size] = self.held - HAIR, self.held + HAIR
        return lowest, highest


def shared_law(task: Task, wishes: Wishes, ratio: Array) -> MakeableLaw:
    """A law as it stands, shared over two pairs so that the larger pressure angle is least.

    Ratios i12 at even driven angles have shape (n,), which gives the second pair n knots. Only those wishes count that
    concern each pair. Raises NoSuchMechanism where no share keeps them.
    """
    search = searched(task, replace(wishes, motion=(), knots=ratio.size))
    named = [(level.of_pairs, level.wish == "pressure_angle_deg") for level in search.programme.levels]
    of_pairs, angle = np.array(named).T
    programme = search.programme
    start = np.concatenate([programme.knots.coefficients(np.log(ratio)) * share for share in (1.0, 0.5)])
    whole = programme.inside(start)[: ratio.size]
    split = replace(
        search,
        programme=HeldProgramme(**vars(programme), held=whole),
        caps=np.where(of_pairs, search.caps, np.inf),
        weights=angle.astype(float),
    )
    found = kept(split, start)
    if found is None:
        raise NoSuchMechanism("no share of the law keeps the limits of both pairs", key="optimize.limits")
    return law_of(split, found)
