"""The machine that laws are sought for, and the figures of the mechanisms that they are compared with."""

from __future__ import annotations

from abc import ABC, abstractmethod
from functools import cached_property

from ncgear.design.keys.design import Design
from ncgear.errors import DesignError
from ncgear.optimum.makeable.wishes import Wishes
from ncgear.optimum.task import Figures, Task, figures
from ncgear.project.law import keeps_even_speed, law_of
from ncgear.project.law_task import inertia_as_given, task_of, wishes_of
from ncgear.ratio.laws.uniform import uniform_law
from ncgear.ratio.transmission import Train, single


class SoughtMachine(ABC):
    """A design's machine and its wishes, with other mechanisms that have the same masses and the same speed.

    Every attribute may raise WrongInput for wishes that contradict each other or the design.
    """

    def __init__(self, design: Design) -> None:
        self.given = design

    @property
    def design(self) -> Design:
        """The design whose machine it is: as given, where nothing of the machine is free."""
        return self.given

    @property
    @abstractmethod
    def task(self) -> Task:
        """The machine; all figures count its masses."""

    @cached_property
    def wishes(self) -> Wishes:
        """Goal and limits."""
        return wishes_of(self.given)

    @property
    def not_kept(self) -> str:
        """What the design's own law prescribes of the motion and no wish asks for, in words; empty where none is."""
        return "" if keeps_even_speed(self.design) else self.design.motion.prescribed

    @property
    def soft(self) -> bool:
        """Whether soft wishes count in the goal: they bend the law, and the limit is for hard wishes alone."""
        return any(not wish.hard for wish in self.wishes.motion)

    @property
    def sizing(self) -> Train | None:
        """The law whose gears tell how far the uniform crank's gears are apart; None: their own size does."""
        return None

    @cached_property
    def uniform_figures(self) -> Figures:
        """Exact figures of a uniform crank on the same machine."""
        return figures(self.task, single(uniform_law(self.task.lobes)), self.sizing)

    @cached_property
    def given_figures(self) -> Figures | None:
        """Exact figures of the design's own law and gears at the same speed; None where that law cannot be made."""
        try:
            return figures(task_of(self.given, inertia_as_given(self.given)), law_of(self.given).train)
        except DesignError:
            return None


class GearsAsGiven(SoughtMachine):
    """The machine with its gears as given: laws under different caps are compared with the same masses."""

    @cached_property
    def task(self) -> Task:
        """The machine; a moment of inertia that is left out follows from the gear that the design's own law makes."""
        return task_of(self.design, inertia_as_given(self.design))
