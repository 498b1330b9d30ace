"""Study of the certified limit: cells against the width of its enclosure."""

from __future__ import annotations

from functools import cache, cached_property
from math import pi

import numpy as np

from ncgear.mechanisms.crank_slider import CrankSlider
from ncgear.mechanisms.resistance import PolynomialResistance
from ncgear.optimum.certified.limit import CELLS, Bound, enclosed, least_acceleration, resting_acceleration
from ncgear.optimum.certified.problem import Problem
from ncgear.optimum.certified.road import Peaks, Road, road_at
from ncgear.optimum.task import Limits, Task
from ncgear.precision.limit_reference import least_acceleration_mm_s2
from ncgear.precision.study import Method, Study

COEFFICIENTS_N = (-131.2779, 3.447, 1.846e-2, -1.575e-4, 2.498e-7)
"""Of the baler's resistance, over mm: J. Wang, C. Wang, L. Miao, as in designs/baler.yaml."""

POWER_W = 6300.0
TASK = Task(CrankSlider(380.0, 960.0), PolynomialResistance(COEFFICIENTS_N), 2.0 * pi)
LIMITS = Limits(0.01, 100.0, POWER_W)
"""Ratios so wide that they do not bind, as in the closed form; the baler's own of 0.2 to 5 do not either."""

GRIDS = (200, 400, 800, CELLS, 3200, 6400)
ENOUGH = 5e-4
"""Of the limit: a makeable law of 36 harmonics is still a fifth above it."""

BY_ANGLE, BY_WAY = "cells even in the crank angle", "cells even in the way"


def study() -> Study:
    """Relative error of the baler's least acceleration at 6300 W and 60 r/min."""
    return Study(
        key="limit",
        title="Certified limit",
        unit="share",
        reference="the fastest motion of the baler in closed form, its least acceleration solved for to fifty digits; "
        "of an enclosure the farther side counts",
        methods=(
            Method(BY_ANGLE, "cells", GRIDS, lambda cells: least_acceleration(TASK, LIMITS, cells), 2.0),
            Method(BY_WAY, "cells", GRIDS, _enclosed_evenly),
        ),
        error=error,
        chosen=(BY_ANGLE, CELLS),
        enough=ENOUGH,
        because="the enclosure is then narrower than what any law is judged to, and certain; cells even in the way are "
        "too long at the dead centres, where the slider hardly moves",
    )


@cache
def exact_mm_s2() -> float:
    """The closed form's value."""
    rest = resting_acceleration(TASK)
    return least_acceleration_mm_s2(COEFFICIENTS_N, TASK.linkage.stroke_mm, POWER_W, TASK.cycle_s, (rest, 4.0 * rest))


def error(found: Bound) -> float:
    """Relative distance of an enclosure's farther side."""
    return max(abs(side / exact_mm_s2() - 1.0) for side in (found.value, found.attained))


def _enclosed_evenly(cells: int) -> Bound:
    """The same enclosure on cells of even way."""
    return enclosed(_EvenWay(TASK, LIMITS, cells), lambda value: Peaks(value, POWER_W), resting_acceleration(TASK))


class _EvenWay(Problem):
    """A problem whose cells are as long as each other on the slider's way."""

    @cached_property
    def road(self) -> Road:
        """The cycle cut into cells."""
        linkage, half = self.task.linkage, self.cells // 2
        way = np.linspace(0.0, linkage.stroke_mm, half + 1)[1:-1]
        out, back = (
            linkage.crank_angle(at, np.full(half - 1, homeward)) for at, homeward in ((way, False), (way[::-1], True))
        )
        return road_at(self.task, np.concatenate([[0.0], out, [linkage.working_angle_rad], back, [2.0 * pi]]), half)
