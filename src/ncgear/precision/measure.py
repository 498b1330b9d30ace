"""Times and errors of a study's methods."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from math import isfinite, log
from time import perf_counter

from ncgear.precision.study import Measured, Method, Point, Study

TIMED_S = 0.05
"""Each level is run again until so much time has gone; the least of its times counts, the others were disturbed."""

MOST_RUNS = 200

LEAST_RUNS, LONG = 3, 10.0
"""Levels that take longer are run so often all the same, the first time being cold, unless ten times that has gone."""


def measured(study: Study, timed_s: float = TIMED_S) -> Measured:
    """All points of a study; whatever a method raises is raised, and ArithmeticError for an error that is no number."""
    return Measured(study, tuple(points(study, method, timed_s) for method in study.methods))


def points(study: Study, method: Method, timed_s: float = TIMED_S) -> tuple[Point, ...]:
    """The points of one method, from cheap to dear; raises ArithmeticError for an error that is no number."""
    found = []
    for level in method.levels:
        seconds, result = _timed(lambda level=level: method.run(level), timed_s)  # type: ignore[misc]
        error = study.error(result)
        if not isfinite(error):
            raise ArithmeticError(f"{study.key}: the error of {method.name!r} at level {level:g} is {error}")
        found.append(Point(level, seconds, error, study.size.of(result) if study.size else None))
    return tuple(found)


def falling(found: Sequence[Point], floor: float) -> tuple[Point, ...]:
    """The points above a floor of rounding, up to the least error: beyond it rounding errors grow with the level."""
    errors = [point.error for point in found]
    return tuple(point for point in found[: errors.index(min(errors)) + 1] if point.error > floor)


def order(found: Sequence[Point], floor: float) -> float:
    """Power of one over the level with which the error falls, fitted by least squares over its ``falling`` points.

    The slope of ln error over ln level, changed in sign; raises ValueError with fewer than two such points.
    """
    logarithms = [(log(point.level), log(point.error)) for point in falling(found, floor)]
    if len(logarithms) < 2:
        raise ValueError(f"fewer than two errors above {floor:g}: no rate can be told")
    mean_x, mean_y = (sum(values) / len(values) for values in zip(*logarithms, strict=True))
    across: float = sum((x - mean_x) ** 2 for x, _ in logarithms)
    rise: float = sum((x - mean_x) * (y - mean_y) for x, y in logarithms)
    return -rise / across


def _timed(run: Callable[[], object], timed_s: float) -> tuple[float, object]:
    """Least time of several runs, and the result of the last one."""
    least, gone, runs = float("inf"), 0.0, 0
    result: object = None
    while runs == 0 or (runs < MOST_RUNS and gone < timed_s * (1.0 if runs >= LEAST_RUNS else LONG)):
        start = perf_counter()
        result = run()
        seconds = perf_counter() - start
        least, gone, runs = min(least, seconds), gone + seconds, runs + 1
    return least, result
