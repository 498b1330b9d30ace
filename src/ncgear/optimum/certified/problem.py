"""A task under demands on one grid: the programmes of its motions, and whether any motion keeps the demands."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

from ncgear.optimum.certified.cycle import Cycle
from ncgear.optimum.certified.demands import Demands, Near, Ranges
from ncgear.optimum.certified.motion import MotionProgramme, motion_programme
from ncgear.optimum.certified.proof import least
from ncgear.optimum.task import Task


@dataclass(frozen=True, eq=False)
class Problem:
    """A task under demands, on the grid of a cycle."""

    task: Task
    asked: Demands
    on: Cycle

    def programme(self, curve: Ranges | Near | None = None, *, closed: bool = True) -> MotionProgramme:
        """The conic programme of the motions."""
        return motion_programme(self.task, self.on, self.asked, curve, closed=closed)

    @cached_property
    def closing(self) -> float:
        """Least driving angle of a cycle that keeps all other demands, over what it has; infinite where none does."""
        made = self.programme(closed=False)
        return least(made.programme, made.angle).value

    @property
    def is_open(self) -> bool:
        """False only where certainly no law keeps the demands."""
        return self.closing <= 1.0

    def under(self, **demands: Any) -> Problem:
        """The problem with other values of some demands."""
        return replace(self, asked=replace(self.asked, **demands))
