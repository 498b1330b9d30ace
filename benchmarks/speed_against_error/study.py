"""The frame of all studies: methods are timed, their errors are measured, and rates and the knee follow.

A study takes one number that ncgear computes.  Several methods compute it at several levels, an independent reference
tells their errors.  Rates of convergence are fitted beside the theory's.  The knee is the quickest point that is exact
enough; the study says whether ncgear works there.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from math import isfinite, log
from time import perf_counter
from typing import Any

Level = int | float
"""How fine a method works: a degree, a number of points, a tolerance."""

TIMED_S = 0.05
"""Each level is run again until this time has passed.  The least time counts: other runs were disturbed."""

MOST_RUNS = 200

LEAST_RUNS, LONG = 3, 10.0
"""Long levels also run this often, because a first run is cold, unless this many times TIMED_S have passed."""

ABOVE_ROUNDING = 30.0
"""An error of this many times the least of all methods comes from the method, not from rounding."""

MOST_ROUNDING = 1e-10
"""Rounding errors are below this in every study's unit.  Where no method gets so far, no error is rounding."""

NEARLY_LEAST = 10.0
"""Errors up to this many times the least of all methods count as equal to it: they differ by a digit of rounding."""

SAME_TIME = 1.5
"""Times that differ by a smaller factor count as equal: on a busy machine the least of repeated runs varies so much."""


# --- what is measured ------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Method:
    """One way to compute the number: ``run`` takes a level and returns what the study's error is computed from.

    ``levels`` go from cheap to expensive.  ``level`` names them: in the plural if it counts something ("samples a
    piece"), otherwise in the singular ("degree").  A method with a single accuracy has the levels (0,) and no name for
    them.  ``order`` is the rate of convergence in theory, the power of 1/level that the error falls with; it is None if
    the error falls faster than any power or does not depend on the level.  An ``adaptive`` method finds by itself how
    fine it must be, and fails with a message if it cannot.
    """

    name: str
    level: str
    levels: tuple[Level, ...]
    run: Callable[[Any], Any]
    order: float | None = None
    adaptive: bool = False

    @property
    def unaided(self) -> bool:
        """Whether the method is exact although nobody knows beforehand how many points are enough."""
        return self.adaptive or not self.level


@dataclass(frozen=True)
class Size:
    """The size of a result, on which the cost of all that follows depends: its ``name``, and what counts it."""

    name: str
    of: Callable[[Any], float]


@dataclass(frozen=True)
class Study:
    """One number, and the methods that compute it.

    ``error`` gives the error of a result in ``unit`` against an independent reference, which ``reference`` describes.
    ``chosen`` is the name of the method and the level that ncgear uses, ``because`` gives the reason.  Smaller errors
    than ``enough`` are of no use to anybody.  If ``size`` is given, the page shows it beside the level.
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
        """The method of that name; raises KeyError if there is none."""
        return {method.name: method for method in self.methods}[name]


# --- measuring -------------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Point:
    """The time and the error of a method at one level, and the result's size if the study has one."""

    level: Level
    seconds: float
    error: float
    size: float | None = None


PointOfMethod = tuple[Method, Point]


@dataclass(frozen=True)
class Measured:
    """A study with the points of each of its methods, in the order of the methods."""

    study: Study
    points: tuple[tuple[Point, ...], ...]

    @property
    def of_all(self) -> tuple[PointOfMethod, ...]:
        """All points of all methods."""
        rows = zip(self.study.methods, self.points, strict=True)
        return tuple((method, point) for method, row in rows for point in row)

    @property
    def chosen(self) -> PointOfMethod:
        """The method and the point that ncgear uses."""
        name, level = self.study.chosen
        return next(one for one in self.of_all if one[0].name == name and one[1].level == level)

    @property
    def least_error(self) -> float:
        """The smallest error above 0; 0 if there is none."""
        return min((point.error for _, point in self.of_all if point.error > 0.0), default=0.0)


def measured(study: Study, timed_s: float = TIMED_S) -> Measured:
    """Run all methods of a study; raises what they raise, and ArithmeticError if an error is not a finite number."""
    return Measured(study, tuple(points(study, method, timed_s) for method in study.methods))


def points(study: Study, method: Method, timed_s: float = TIMED_S) -> tuple[Point, ...]:
    """Run one method at all its levels; raises ArithmeticError if an error is not a finite number."""
    found = []
    for level in method.levels:
        seconds, result = _timed(lambda level=level: method.run(level), timed_s)  # type: ignore[misc]
        error = study.error(result)
        if not isfinite(error):
            raise ArithmeticError(f"{study.key}: the error of {method.name!r} at level {level:g} is {error}")
        found.append(Point(level, seconds, error, study.size.of(result) if study.size else None))
    return tuple(found)


def _timed(run: Callable[[], object], timed_s: float) -> tuple[float, object]:
    """The least time of several runs, and the result of the last one."""
    least, total, runs = float("inf"), 0.0, 0
    result: object = None
    while runs == 0 or (runs < MOST_RUNS and total < timed_s * (1.0 if runs >= LEAST_RUNS else LONG)):
        start = perf_counter()
        result = run()
        seconds = perf_counter() - start
        least, total, runs = min(least, seconds), total + seconds, runs + 1
    return least, result


# --- rates of convergence --------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Rate:
    """How fast a method's error falls with its level: as fitted, and in theory."""

    method: str
    fitted: float
    theory: float


def rates(found: Measured) -> tuple[Rate, ...]:
    """The rates of all methods that have one in theory; raises ValueError if a fit has fewer than two points."""
    floor = min(ABOVE_ROUNDING * found.least_error, MOST_ROUNDING)
    rows = zip(found.study.methods, found.points, strict=True)
    return tuple(Rate(one.name, order(row, floor), one.order) for one, row in rows if one.order is not None)


def order(found: Sequence[Point], floor: float) -> float:
    """The power of 1/level that the errors above ``floor`` fall with, by least squares on the logarithms.

    Points after the least error are left out, because rounding errors grow with the level there.  Raises ValueError if
    fewer than two points are left.
    """
    errors = [point.error for point in found]
    falling = [point for point in found[: errors.index(min(errors)) + 1] if point.error > floor]
    logarithms = [(log(point.level), log(point.error)) for point in falling]
    if len(logarithms) < 2:
        raise ValueError(f"fewer than two errors above {floor:g}: no rate can be told")
    mean_x, mean_y = (sum(values) / len(values) for values in zip(*logarithms, strict=True))
    across: float = sum((x - mean_x) ** 2 for x, _ in logarithms)
    rise: float = sum((x - mean_x) * (y - mean_y) for x, y in logarithms)
    return -rise / across


# --- the knee --------------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Knee:
    """The point that ncgear uses, compared with all others.

    ``error`` is the largest error that is exact enough, ``quickest`` the quickest point within it.  ``cheaper`` and
    ``dearer`` are the chosen point's neighbours on the front: the points that no other beats in both time and error.
    """

    chosen: PointOfMethod
    error: float
    quickest: PointOfMethod
    cheaper: PointOfMethod | None
    dearer: PointOfMethod | None

    @property
    def slowness(self) -> float:
        """The time of the chosen point as a multiple of the quickest one's."""
        return self.chosen[1].seconds / self.quickest[1].seconds

    @property
    def is_chosen(self) -> bool:
        """Whether the chosen point is exact enough and no other exact enough point is clearly quicker."""
        return self.chosen[1].error <= self.error and self.slowness <= SAME_TIME


def knee(found: Measured, unaided: bool = False) -> Knee:
    """Compare the chosen point with the quickest one that is exact enough, or nearly the most exact if none is.

    ``unaided`` leaves only the methods that find by themselves how fine they must be.  The levels of the others were
    chosen with the help of the exact result, which no program has.
    """
    candidates = tuple(one for one in found.of_all if one[0].unaided or not unaided)
    least = min(point.error for _, point in candidates)
    error = found.study.enough if least <= found.study.enough else NEARLY_LEAST * least
    quickest = min((one for one in candidates if one[1].error <= error), key=_seconds)
    front, chosen = _front(candidates), found.chosen
    cheaper = [one for one in front if _seconds(one) < _seconds(chosen) and one[1].error > chosen[1].error]
    dearer = [one for one in front if _seconds(one) > _seconds(chosen) and one[1].error < chosen[1].error]
    neighbours = max(cheaper, key=_seconds, default=None), min(dearer, key=_seconds, default=None)
    return Knee(chosen, error, quickest, *neighbours)


def _front(candidates: tuple[PointOfMethod, ...]) -> list[PointOfMethod]:
    """The points that no other beats in both time and error, from quick to slow."""
    front: list[PointOfMethod] = []
    for one in sorted(candidates, key=_seconds):
        if not front or one[1].error < front[-1][1].error:
            front.append(one)
    return front


def _seconds(one: PointOfMethod) -> float:
    return one[1].seconds
