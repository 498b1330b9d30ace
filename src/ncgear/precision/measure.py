"""Times and errors of a study's methods."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from math import log
from time import perf_counter

from ncgear.precision.study import Measured, Method, Point, Study

TIMED_S = 0.05
"""Each level is run again until so much time has gone; the least of its times counts, the others were disturbed."""

MOST_RUNS = 200


def measured(study: Study, timed_s: float = TIMED_S) -> Measured:
    """All points of a study; whatever a method raises is raised."""
    return Measured(study, tuple(points(study, method, timed_s) for method in study.methods))


def points(study: Study, method: Method, timed_s: float = TIMED_S) -> tuple[Point, ...]:
    """The points of one method, from cheap to dear."""
    found = []
    for level in method.levels:
        seconds, result = _timed(lambda level=level: method.run(level), timed_s)  # type: ignore[misc]
        found.append(Point(level, seconds, study.error(result), study.size.of(result) if study.size else None))
    return tuple(found)


def order(found: Sequence[Point], floor: float) -> float:
    """Power of one over the level with which the error falls, fitted by least squares over the points above a floor.

    The slope of ln error over ln level, changed in sign; raises ValueError with fewer than two points above the floor.
    """
    logarithms = [(log(point.level), log(point.error)) for point in found if point.error > floor]
    if len(logarithms) < 2:
        raise ValueError(f"fewer than two errors above {floor:g}: no rate can be told")
    mean_x, mean_y = (sum(values) / len(values) for values in zip(*logarithms, strict=True))
    across = sum((x - mean_x) ** 2 for x, _ in logarithms)
    return -float(sum((x - mean_x) * (y - mean_y) for x, y in logarithms)) / across


def _timed(run: Callable[[], object], timed_s: float) -> tuple[float, object]:
    """Least time of several runs, and the result of the last one."""
    least, gone, runs = float("inf"), 0.0, 0
    result: object = None
    while runs == 0 or (gone < timed_s and runs < MOST_RUNS):
        start = perf_counter()
        result = run()
        seconds = perf_counter() - start
        least, gone, runs = min(least, seconds), gone + seconds, runs + 1
    return least, result
