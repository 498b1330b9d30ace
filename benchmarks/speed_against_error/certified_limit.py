"""The study of the certified limit: how narrow its enclosure is, by the number of cells.

The reference is the baler's limit in closed form.  With u = v^2 / 2, the fastest motion under a peak of acceleration A
and a power P rises along u = A x.  It turns onto the line of slope -A that touches the ceiling of power, which is u =
(P / F(x))^2 / 2.  From there on the ceiling falls less steeply, and the motion follows it; then it comes to rest along
u = A (H - x).  The return has constant acceleration and constant braking.  With v_p at the turn, and v_t and v_b where
the motion joins and leaves the ceiling, the cycle takes

    (2 v_p - v_t + v_b) / A + (W(x_b) - W(x_t)) / P + 2 sqrt(H / A),

and W, the resistance's work, is a polynomial.  The limit is the A for which this is the cycle's time: no law has less,
and laws come as close to it as one likes.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cache, cached_property, partial
from math import pi

import numpy as np
from mpmath import findroot, mp, mpf, polyval, sqrt

from ncgear.optimum.certified.limit import CELLS, Bound, enclosed, least_acceleration, resting_acceleration
from ncgear.optimum.certified.problem import Problem
from ncgear.optimum.certified.road import Peaks, Road, road_at
from ncgear.optimum.task import Limits
from speed_against_error.baler import COEFFICIENTS_N, DIGITS, TASK, Real
from speed_against_error.study import Method, Study

POWER_W = 6300.0
LIMITS = Limits(0.01, 100.0, POWER_W)
"""The range of ratios is so wide that it does not bind, as in the closed form; the baler's 0.2 to 5 does not either."""

GRIDS = (200, 400, 800, CELLS, 3200, 6400)
ENOUGH = 5e-4
"""As a share of the limit: a makeable law of 36 harmonics is still a fifth above it."""

BY_ANGLE, BY_WAY = "cells even in the crank angle", "cells even in the way"


def limit_study() -> Study:
    """The baler's least acceleration at 6300 W and 60 r/min."""
    return Study(
        key="limit",
        title="Certified limit",
        unit="share",
        reference="the fastest motion of the baler in closed form, its least acceleration solved for to fifty digits; "
        "of an enclosure the farther side counts",
        methods=(
            Method(BY_ANGLE, "cells", GRIDS, by_angle, 2.0),
            Method(BY_WAY, "cells", GRIDS, _by_way),
        ),
        error=limit_error,
        chosen=(BY_ANGLE, CELLS),
        enough=ENOUGH,
        because="the enclosure is then narrower than what any law is judged to, and certain; cells even in the way are "
        "too long at the dead centres, where the slider hardly moves",
    )


def limit_error(found: Bound) -> float:
    """The relative distance of the enclosure's farther side."""
    return max(abs(side / exact_mm_s2() - 1.0) for side in (found.value, found.attained))


def by_angle(cells: int) -> Bound:
    """As ncgear does it."""
    return least_acceleration(TASK, LIMITS, cells)


def _by_way(cells: int) -> Bound:
    return enclosed(_EvenWay(TASK, LIMITS, cells), lambda value: Peaks(value, POWER_W), resting_acceleration(TASK))


class _EvenWay(Problem):
    """The same problem with cells of equal length on the slider's way."""

    @cached_property
    def road(self) -> Road:
        """The cycle cut into cells."""
        linkage, half = self.task.linkage, self.cells // 2
        way = np.linspace(0.0, linkage.stroke_mm, half + 1)[1:-1]
        out, back = (
            linkage.crank_angle(at, np.full(half - 1, homeward)) for at, homeward in ((way, False), (way[::-1], True))
        )
        return road_at(self.task, np.concatenate([[0.0], out, [linkage.working_angle_rad], back, [2.0 * pi]]), half)


# --- the closed form -------------------------------------------------------------------------------------------------

STEEP_MM, LEAST_MM = 400.0, 0.01
"""Up to STEEP_MM the baler's ceiling falls more steeply than any acceleration that is tried; up to LEAST_MM before the
end it falls less steeply."""

FOUND = 1e-40
"""Roots are this exact relative to their brackets, ten digits less than the numbers have."""


@cache
def exact_mm_s2() -> float:
    """The baler's limit in closed form."""
    rest = resting_acceleration(TASK)
    return least_acceleration_mm_s2(COEFFICIENTS_N, TASK.linkage.stroke_mm, POWER_W, TASK.cycle_s, (rest, 4.0 * rest))


def least_acceleration_mm_s2(
    coefficients: Sequence[float], stroke_mm: float, power_w: float, cycle_s: float, between: tuple[float, float]
) -> float:
    """The least peak acceleration against a resistance of polynomial ``coefficients`` (N over mm), for any ratios.

    The search covers the range ``between``.  Raises ArithmeticError if the motion is not of the kind described above.
    """
    with mp.workdps(DIGITS):
        exact, power, stroke = [mpf(c) for c in coefficients], 1000 * mpf(power_w), mpf(stroke_mm)
        return float(_root(lambda most: _cycle_s(exact, power, stroke, most) - mpf(cycle_s), *between))


def _cycle_s(coefficients: Sequence[Real], power: Real, stroke: Real, most: Real) -> Real:
    """The time of the fastest motion under the acceleration ``most``; lengths in mm, power in N mm/s."""
    rising = [n * c for n, c in enumerate(coefficients)][1:]
    worked = [0, *(c / (n + 1) for n, c in enumerate(coefficients))]
    force, slope, work = (partial(polyval, own[::-1]) for own in (coefficients, rising, worked))
    last = stroke - LEAST_MM
    touching = _root(lambda x: power**2 * slope(x) / force(x) ** 3 - most, STEEP_MM, last)
    braking = _root(lambda x: most * (stroke - x) - (power / force(x)) ** 2 / 2, touching, last)
    begins, ends = power / force(touching), power / force(braking)
    fastest = sqrt(begins**2 / 2 + most * touching)
    return (2 * fastest - begins + ends) / most + (work(braking) - work(touching)) / power + 2 * sqrt(stroke / most)


def _root(function: Callable[[Real], Real], low: Real, high: Real) -> Real:
    """The root in a bracket; raises ArithmeticError if there is none."""
    if function(low) * function(high) > 0:
        raise ArithmeticError("the fastest motion is not of the kind whose closed form is known")
    return findroot(function, (low, high), solver="anderson", tol=FOUND**2 * abs(high), verify=False)
