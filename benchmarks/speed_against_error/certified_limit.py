"""The study of the certified limit: how far below the best motion it stays, by the number of places of its grid.

The reference is the baler's limit in closed form.  With u = v^2 / 2, the fastest motion under a peak of acceleration A
and a power P rises along u = A x.  It turns onto the line of slope -A that touches the ceiling of power, which is u =
(P / F(x))^2 / 2.  From there on the ceiling falls less steeply, and the motion follows it; then it comes to rest along
u = A (H - x).  The return has constant acceleration and constant braking.  With v_p at the turn, and v_t and v_b where
the motion joins and leaves the ceiling, the cycle takes

    (2 v_p - v_t + v_b) / A + (W(x_b) - W(x_t)) / P + 2 sqrt(H / A),

and W, the resistance's work, is a polynomial.  The limit is the A for which this is the cycle's time: no law has less,
and laws come as close to it as one likes.

Pitch curves need not be convex here, since the closed form does not know of them.  The relations of the grid are then
of first order: nothing bounds how a motion bends between two places.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cache, partial

from mpmath import findroot, mp, mpf, polyval, sqrt

from ncgear.optimum.certified.demands import Demands
from ncgear.optimum.certified.limit import PLACES_ROUGH, Bound, least_acceleration
from ncgear.optimum.certified.sums import TOLERANCE
from speed_against_error.baler import COEFFICIENTS_N, DIGITS, LINKAGE, TASK, Real
from speed_against_error.study import Method, Study

POWER_W = 6300.0
DEMANDS = Demands(0.01, 100.0, power_w=POWER_W)
"""The range of ratios is so wide that it does not bind, as in the closed form; the baler's 0.2 to 5 does not either."""

GRIDS = (120, 240, 480, PLACES_ROUGH, 2 * PLACES_ROUGH, 4 * PLACES_ROUGH)
ENOUGH = TOLERANCE
"""As a share of the limit: weighted sums are not enclosed more closely either."""

BY_ANGLE = "places even in the crank angle"


def limit_study() -> Study:
    """The baler's least acceleration at 6300 W and 60 r/min."""
    return Study(
        key="limit",
        title="Certified limit",
        unit="share",
        reference="the fastest motion of the baler in closed form, its least acceleration solved for to fifty digits",
        methods=(Method(BY_ANGLE, "places", GRIDS, by_angle, 1.0),),
        error=limit_error,
        chosen=(BY_ANGLE, PLACES_ROUGH),
        enough=ENOUGH,
        because="the limit is certain on any grid, and this one misses less of it than weighted sums may; with four "
        "times as many places the solver's multipliers miss their equations by 6e-8, which takes a quarter off the "
        "limit that they prove",
    )


def limit_error(found: Bound) -> float:
    """The relative distance of the limit from the best motion."""
    return abs(found.value / exact_mm_s2() - 1.0)


def by_angle(places: int) -> Bound:
    """As ncgear does it."""
    return least_acceleration(TASK, DEMANDS, places)


# --- the closed form -------------------------------------------------------------------------------------------------

STEEP_MM, LEAST_MM = 400.0, 0.01
"""Up to STEEP_MM the baler's ceiling falls more steeply than any acceleration that is tried; up to LEAST_MM before the
end it falls less steeply."""

FOUND = 1e-40
"""Roots are this exact relative to their brackets, ten digits less than the numbers have."""


@cache
def exact_mm_s2() -> float:
    """The baler's limit in closed form."""
    stroke = LINKAGE.stroke_mm
    # Both strokes from rest to rest at constant acceleration and braking take the cycle's time at 16 H / T^2
    rest = 16.0 * stroke / TASK.cycle_s**2
    return least_acceleration_mm_s2(COEFFICIENTS_N, stroke, POWER_W, TASK.cycle_s, (rest, 4.0 * rest))


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
