"""A study: one number that ncgear computes, by several methods at several costs, against an independent reference."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

Level = int | float
"""How fine a method works: a degree, a number of points, a tolerance."""


@dataclass(frozen=True)
class Method:
    """One way to compute the number: ``run`` takes a level and gives what the study's error can be told of.

    ``levels`` go from cheap to dear, and ``level`` says in words what they are, in the plural what is counted
    ("samples a piece"), in the singular what is named ("degree"); a method that works at one accuracy only has the
    levels (0,) and no word.  ``order`` is the theory's rate of convergence: the power of one over the level with which
    the error falls; None where it falls faster than any power, or does not depend on the level.  ``adaptive`` is true
    where the method finds by itself how fine it must be, whatever the level, and says so where it cannot.
    """

    name: str
    level: str
    levels: tuple[Level, ...]
    run: Callable[[Any], Any]
    order: float | None = None
    adaptive: bool = False

    @property
    def unaided(self) -> bool:
        """Whether it is exact without anyone's knowing beforehand how many points are enough."""
        return self.adaptive or not self.level


@dataclass(frozen=True)
class Size:
    """How large a result is, which costs whoever goes on with it: a ``name``, and the number ``of`` a result."""

    name: str
    of: Callable[[Any], float]


@dataclass(frozen=True)
class Study:
    """Methods for one number of a stage.

    ``error`` gives the error of a result in ``unit``, against a reference that none of the methods made; ``reference``
    says in words which.  ``chosen`` names the method and the level that ncgear works with, ``because`` says why.
    ``enough`` is an error below which nobody gains.  Results that differ in ``size`` have it told beside the level.
    """

    key: str
    title: str
    unit: str
    reference: str
    methods: tuple[Method, ...]
    error: Callable[[Any], float]
    chosen: tuple[str, Level]
    enough: float
    because: str
    size: Size | None = None

    def method(self, name: str) -> Method:
        """The method of that name; raises KeyError where there is none."""
        return {method.name: method for method in self.methods}[name]


@dataclass(frozen=True)
class Point:
    """What one level of a method takes in seconds, how wrong it is, and the result's size where the study has one."""

    level: Level
    seconds: float
    error: float
    size: float | None = None


@dataclass(frozen=True)
class Measured:
    """A study with the points of each of its methods, in the order of the methods."""

    study: Study
    points: tuple[tuple[Point, ...], ...]

    @property
    def of_all(self) -> tuple[tuple[Method, Point], ...]:
        """Every point of every method."""
        rows = zip(self.study.methods, self.points, strict=True)
        return tuple((method, point) for method, row in rows for point in row)

    @property
    def chosen(self) -> tuple[Method, Point]:
        """The method and the point that ncgear works at."""
        name, level = self.study.chosen
        return next(one for one in self.of_all if one[0].name == name and one[1].level == level)
