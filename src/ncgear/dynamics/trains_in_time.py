"""Steps in time of shafts that pairs in series join, of which several swing at once, or helical teeth: scipy's LSODA.

The solver restarts at each dead centre, where the resistance starts or ends, and at each narrow peak of the resistance,
which its steps might pass over.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import NamedTuple

import numpy as np

from ncgear.dynamics.crank_load import CrankLoad
from ncgear.numerics.arrays import Array
from ncgear.numerics.chebyshev import nodes
from ncgear.numerics.zeros import zeros_between

DEGREE = 12
"""Degree of the polynomials within steps: the highest order of LSODA."""

SHARES = nodes(np.zeros(1), np.ones(1), DEGREE)[:, 0]
"""The nodes of these polynomials as shares of a step."""

SMALL = 1e-2
"""A small change in rad, and as a share of the drive's speed."""


SHARE = 1.0 / 3.0
"""LSODA's relative error of a step, as a share of the accuracy asked for: largest moments of pairs that knock then miss
2e-4 at 3e-7, and their energy a quarter of what is refused at 4e-6."""


class TrainStep(NamedTuple):
    """The end of a step, the shafts then, shape (rows,), and at the nodes of its polynomial, shape (13, rows).

    The rows are the angle and the speed of each shaft, from the driving one on.
    """

    time_s: float
    shafts: Array
    inner: Array


def train_steps(
    change: Callable[[Array], Array],
    load: CrankLoad,
    shafts: Array,
    ends: tuple[float, float],
    accuracy: float,
) -> Iterator[TrainStep]:
    """Steps from time 0 on, until the solver can take no more.

    ``change`` gives the derivatives of ``shafts`` by time, of which the last turns the ``load``.  ``ends`` are the
    drive's speed in rad/s and the driving angle at which a step is to end; ``accuracy`` is the error of a step.
    """
    from scipy.integrate import LSODA

    (even_rad_s, target_rad), time_s, solver = ends, 0.0, None
    while True:
        if solver is None:
            stop_rad, way_rad = load.next_stop_rad(float(shafts[-2]))
            most_s = way_rad / max(abs(float(shafts[-1])), even_rad_s)
            small = SHARE * accuracy * SMALL * np.tile([1.0, even_rad_s], shafts.size // 2)
            how = {"max_step": most_s, "rtol": SHARE * accuracy, "atol": small}
            solver = LSODA(lambda _, now: change(now), time_s, shafts, np.inf, **how)
        try:
            solver.step()
        except (ArithmeticError, ValueError):
            return
        if solver.status == "failed":
            return
        between, end_s, shafts = solver.dense_output(), solver.t, solver.y
        if shafts[0] >= target_rad or shafts[-2] >= stop_rad:
            end_s = _first_s(between, (target_rad, stop_rad), time_s, end_s)
            solver, shafts = None, between(end_s)
        # The polynomials of steps join up to the solver's error: the end may be that of the step before
        if end_s > time_s:
            yield TrainStep(end_s, shafts, between(time_s + (end_s - time_s) * SHARES).T)
            time_s = end_s


def _first_s(
    between: Callable[[Array], Array], stops_rad: tuple[float, float], before_s: float, after_s: float
) -> float:
    """When the first or the last shaft gets beyond its stop in a step: not yet before, but after, but for rounding."""

    def beyond(time_s: Array) -> Array:
        shafts = between(time_s)
        passed: Array = np.maximum(shafts[0] - stops_rad[0], shafts[-2] - stops_rad[1])
        return passed

    low, high = np.array([before_s]), np.array([after_s])
    return float(zeros_between(beyond, low, high, (-np.abs(beyond(low)), np.abs(beyond(high))))[0])
