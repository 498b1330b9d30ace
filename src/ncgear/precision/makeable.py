"""Study of makeable laws: harmonics against how far the goal stays above what ever more of them come down to."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache
from math import log2, pi

import numpy as np
from ncgear.precision.limit import COEFFICIENTS_N
from ncgear.precision.periodic_spline import periodic_spline
from ncgear.precision.study import Method, Study

from ncgear.extras import require
from ncgear.mechanisms.crank_slider import CrankSlider
from ncgear.mechanisms.resistance import PolynomialResistance
from ncgear.numerics.arrays import Array
from ncgear.optimum.makeable.reached import Grid, Stations, grid, lengths, ratios, reached, stations
from ncgear.optimum.makeable.wishes import Wishes, levels
from ncgear.optimum.task import Limits, Task

POWER_W = 9375.0
"""Half of what the published baler takes, as in designs/baler-half.yaml."""

BALER = Task(CrankSlider(380.0, 960.0), PolynomialResistance(COEFFICIENTS_N), 2.0 * pi)
LIMITS = Limits(0.2, 5.0, POWER_W)
HARMONICS = Wishes(LIMITS).harmonics
"""What design files have where they say nothing."""

COUNTS = (8, 12, 16, HARMONICS, 36)
MORE = (*COUNTS, 48)
"""Of the quicker ones."""

ORDER = 2.0
"""A corner of the best motion, smeared over a share 1/n of the turn, costs a share of the time of the order 1/n^2."""

REFERENCE = (25, 50, 100)
"""Of the reference's splines, counted as harmonics are, each twice the one before."""

ENOUGH = 0.02
"""Of the goal: the machine's resistance is not known so well."""

FINISHED, AT_PLACES, SPLINES = "harmonics", "harmonics, limits at the places only", "quintic splines"

Form = Callable[[Stations, int], Grid]


def study() -> Study:
    """Excess of the baler's least acceleration at 9375 W, convex pitch curves, over its limit for endless harmonics.

    Raises WrongInput where the optimiser is not installed.
    """
    require("casadi", "optimize", "ncgear bench --only makeable")
    return Study(
        key="makeable",
        title="Makeable law",
        unit="share",
        reference="Aitken's extrapolation, which fits limit and rate, of quintic splines with "
        f"{', '.join(str(2 * count) for count in REFERENCE)} coefficients",
        methods=(
            Method(FINISHED, "harmonics", COUNTS, lambda count: kept_mm_s2(grid, count), ORDER),
            Method(SPLINES, "pairs of coefficients", COUNTS, lambda count: kept_mm_s2(splines, count), ORDER),
            Method(AT_PLACES, "harmonics", MORE, lambda count: at_places_mm_s2(grid, count), ORDER),
        ),
        error=lambda found: abs(found / least_mm_s2() - 1.0),
        chosen=(FINISHED, HARMONICS),
        enough=ENOUGH,
        because="more harmonics gain a hundredth at most and take longer by their square. The programme of a spline is "
        "quicker, its matrices being sparse, and comes as far; but a law of harmonics is one piece, without knots that "
        "pitch curves and teeth would show in their higher derivatives, and a second is little",
    )


def kept_mm_s2(form: Form, count: int) -> float:
    """Peak acceleration of a law of 2 ``count`` coefficients as ncgear makes it, limits held between places too.

    Raises ArithmeticError where none is found.
    """
    from ncgear.optimum.makeable.search import kept, scales, searched

    search = searched(BALER, Wishes(LIMITS, harmonics=count), form)
    found = kept(search, np.zeros(2 * count))
    if found is None:
        raise ArithmeticError(f"no law of {2 * count} coefficients was found")
    return float(found.reached[0]) * scales(BALER, search.finer.stations).acceleration_mm_s2


@dataclass(frozen=True, eq=False)
class AtPlaces:
    """A law whose limits hold at even places only: coefficients, the largest acceleration at the places, its level.

    The level also counts what parabolas through the places tell of the peaks between.
    """

    coefficients: Array
    at_places_mm_s2: float
    level_mm_s2: float


def at_places_mm_s2(form: Form, count: int) -> float:
    """Least peak acceleration at the programme's places, for ln i12 of 2 ``count`` coefficients in some form."""
    from ncgear.optimum.makeable.search import PLACES_PER_HARMONIC

    return at_places(form, count, PLACES_PER_HARMONIC).level_mm_s2


def at_places(form: Form, count: int, places_per_count: int) -> AtPlaces:
    """The best law at even places, so many for each harmonic or two coefficients of a spline.

    Raises ArithmeticError where the optimiser finds none.
    """
    from ncgear.optimum.makeable.programme import programme
    from ncgear.optimum.makeable.search import scales

    at = stations(BALER.linkage, BALER.resistance, places_per_count * count)
    on, units = form(at, count), scales(BALER, at)
    wanted = levels(Wishes(LIMITS), units)
    caps = np.array([np.inf if level.limit is None else level.limit for level in wanted])
    weights = np.array([level.weight for level in wanted])
    found = programme(wanted, on, BALER.cycle_rad, None, 1).solved(caps, weights, np.zeros(2 * count))
    if found is None:
        raise ArithmeticError(f"no law of {2 * count} coefficients was found")
    there = ratios(on, found.coefficients, BALER.cycle_rad)
    largest = max(float(np.max(term)) for term in wanted[0].terms(there, on.slider, lengths(there)))
    unit, level = units.acceleration_mm_s2, float(reached(wanted, on, there)[0])
    return AtPlaces(found.coefficients, unit * largest, unit * level)


def splines(at: Stations, count: int) -> Grid:
    """The form that ncgear does not use."""
    return Grid(at, periodic_spline(at.phi2_rad, 2 * count))


def least_mm_s2() -> float:
    """What ever more coefficients come down to."""
    return extrapolated(_down_mm_s2())


def fitted_order() -> float:
    """Rate at which the reference's splines come down to it."""
    first, second, third = _down_mm_s2()
    return log2((first - second) / (second - third))


@cache
def _down_mm_s2() -> tuple[float, ...]:
    return tuple(at_places_mm_s2(splines, count) for count in REFERENCE)


def extrapolated(values: Sequence[float]) -> float:
    """The limit of three values whose excess falls by one factor from each to the next."""
    first, second, third = values
    return third - (second - third) ** 2 / (first - 2.0 * second + third)
