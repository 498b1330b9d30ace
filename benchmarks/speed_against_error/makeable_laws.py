"""The studies of makeable laws: how many harmonics they need, and at how many places they are held to their limits.

Both take the baler at 60 r/min with half of its published power and convex pitch curves, as designs/baler-half.yaml.
The best motion has corners.  A series of n harmonics smears a corner over a share 1/n of the turn, which costs a share
of the time of the order 1/n^2.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache
from math import log2, pi

import numpy as np
from scipy.interpolate import BSpline

from ncgear.numerics.arrays import Array
from ncgear.optimum.makeable.programme import programme
from ncgear.optimum.makeable.reached import Basis, Grid, Stations, grid, lengths, ratios, reached, stations
from ncgear.optimum.makeable.search import PLACES_PER_HARMONIC, kept, scales, searched
from ncgear.optimum.makeable.wishes import Wishes, levels
from ncgear.optimum.task import Limits, figures
from ncgear.ratio.laws.harmonic import harmonic_law
from ncgear.ratio.transmission import single
from speed_against_error.baler import TASK
from speed_against_error.study import Method, Study

POWER_W = 9375.0
LIMITS = Limits(0.2, 5.0, POWER_W)
HARMONICS = Wishes(LIMITS).harmonics
"""The default of design files."""

Form = Callable[[Stations, int], Grid]
"""A way to write ln i12 with 2 n coefficients."""


# --- harmonics -------------------------------------------------------------------------------------------------------

COUNTS = (8, 12, 16, HARMONICS, 36)
MORE = (*COUNTS, 48)
"""For the quicker method."""

ORDER = 2.0

REFERENCE = (25, 50, 100)
"""Pairs of coefficients of the reference's splines, each number twice the one before."""

ENOUGH = 0.02
"""As a share of the goal: the machine's resistance is not known better."""

FINISHED, AT_PLACES, SPLINES = "harmonics", "harmonics, limits at the places only", "quintic splines"


def makeable_study() -> Study:
    """By how much the baler's least acceleration exceeds its limit for any number of harmonics."""
    return Study(
        key="makeable",
        title="Makeable law",
        unit="share",
        reference="Aitken's extrapolation, which fits limit and rate, of quintic splines with "
        f"{', '.join(str(2 * count) for count in REFERENCE)} coefficients",
        methods=(
            Method(FINISHED, "harmonics", COUNTS, lambda count: _kept_mm_s2(grid, count), ORDER),
            Method(SPLINES, "pairs of coefficients", COUNTS, lambda count: _kept_mm_s2(_splines, count), ORDER),
            Method(AT_PLACES, "harmonics", MORE, lambda count: _at_places_mm_s2(grid, count), ORDER),
        ),
        error=lambda found: abs(found / least_mm_s2() - 1.0),
        chosen=(FINISHED, HARMONICS),
        enough=ENOUGH,
        because="more harmonics gain a hundredth at most and take longer by their square. The programme of a spline is "
        "quicker, its matrices being sparse, and comes as far; but a law of harmonics is one piece, without knots that "
        "pitch curves and teeth would show in their higher derivatives, and a second is little",
    )


def least_mm_s2() -> float:
    """The acceleration that any number of coefficients comes down to."""
    return extrapolated(_reference_mm_s2())


def fitted_order() -> float:
    """The rate at which the reference's splines come down to it."""
    first, second, third = _reference_mm_s2()
    return log2((first - second) / (second - third))


@cache
def _reference_mm_s2() -> tuple[float, ...]:
    return tuple(_at_places_mm_s2(_splines, count) for count in REFERENCE)


def extrapolated(values: Sequence[float]) -> float:
    """The limit of three values whose excess falls by the same factor from each to the next."""
    first, second, third = values
    return third - (second - third) ** 2 / (first - 2.0 * second + third)


def _kept_mm_s2(form: Form, count: int) -> float:
    """The peak acceleration of a law of 2 ``count`` coefficients as ncgear makes it, with limits held everywhere.

    Raises ArithmeticError if there is none.
    """
    search = searched(TASK, Wishes(LIMITS, harmonics=count), form)
    found = kept(search, np.zeros(2 * count))
    if found is None:
        raise ArithmeticError(f"no law of {2 * count} coefficients was found")
    return float(found.reached[0]) * scales(TASK, search.finer.stations).acceleration_mm_s2


def _at_places_mm_s2(form: Form, count: int) -> float:
    """The least peak acceleration of a law whose limits hold at the programme's places."""
    return best_at_places(form, count, PLACES_PER_HARMONIC).level_mm_s2


@dataclass(frozen=True, eq=False)
class LawAtPlaces:
    """A law whose limits hold at even places only: coefficients, the largest acceleration at the places, its level.

    The level also counts the peaks between the places, as parabolas through the places estimate them.
    """

    coefficients: Array
    at_places_mm_s2: float
    level_mm_s2: float


def best_at_places(form: Form, count: int, places_per_count: int) -> LawAtPlaces:
    """The best law at even places, ``places_per_count`` for each harmonic or for each two coefficients of a spline.

    Raises ArithmeticError if the optimiser finds none.
    """
    at = stations(TASK.linkage, TASK.resistance, places_per_count * count)
    on, units = form(at, count), scales(TASK, at)
    wanted = levels(Wishes(LIMITS), units)
    caps = np.array([np.inf if level.limit is None else level.limit for level in wanted])
    weights = np.array([level.weight for level in wanted])
    found = programme(wanted, on, TASK.cycle_rad, None, 1).solved(caps, weights, np.zeros(2 * count))
    if found is None:
        raise ArithmeticError(f"no law of {2 * count} coefficients was found")
    there = ratios(on, found.coefficients, TASK.cycle_rad)
    largest = max(float(np.max(term)) for term in wanted[0].terms(there, on.stations.slider, lengths(there)))
    unit, level = units.acceleration_mm_s2, float(reached(wanted, on, there)[0])
    return LawAtPlaces(found.coefficients, unit * largest, unit * level)


SPLINE_DEGREE = 5
"""Curvature needs the second derivative, which is smooth at this degree."""


def _splines(at: Stations, count: int) -> Grid:
    """Periodic quintic splines, a form that ncgear does not use.

    The splines have 2 ``count`` + 1 even knots around the turn.  One of them is left out: all together sum up to one,
    and the programme of a makeable law has a constant of its own.
    """
    knot_count = 2 * count + 1
    step = 2.0 * pi / knot_count
    knots = step * np.arange(-SPLINE_DEGREE, knot_count + SPLINE_DEGREE + 1)
    rows = np.zeros((3, at.phi2_rad.size, knot_count))
    for number in range(knot_count + SPLINE_DEGREE):
        bump = BSpline.basis_element(knots[number : number + SPLINE_DEGREE + 2], extrapolate=False)
        for order in range(3):
            curve = bump.derivative(order) if order else bump
            rows[order, :, number % knot_count] += np.nan_to_num(curve(at.phi2_rad))
    return Grid(at, Basis(*rows[:, :, :-1]))


# --- places ----------------------------------------------------------------------------------------------------------

PLACES = (4, 6, 10, 16)
ENOUGH_BETWEEN = 5e-4
"""As a share of a limit: two or three more rounds of ten steps each then keep it everywhere."""

PROGRAMME = "even places, one round"


def places_study() -> Study:
    """By how much the baler's law of 24 harmonics exceeds, between its places, the limits that it keeps at them.

    The programme misses a peak between two places by at most the square of their distance, and by less if the peak
    happens to lie near one of them.  The error therefore falls with the square, but not evenly, and no rate is fitted.
    """
    return Study(
        key="makeable-places",
        title="Makeable law between its places",
        unit="share",
        reference="the exact peaks of acceleration and power of the law that was found, located on its closed form",
        methods=(
            Method(PROGRAMME, "places per harmonic", PLACES, lambda count: best_at_places(grid, HARMONICS, count)),
        ),
        error=_excess,
        chosen=(PROGRAMME, PLACES_PER_HARMONIC),
        enough=ENOUGH_BETWEEN,
        because="what is left between them is so little that tightening the limits by it takes two or three short "
        "rounds more; the time grows with the places",
    )


def _excess(law: LawAtPlaces) -> float:
    """The larger share by which an exact peak, of acceleration or power, exceeds the limit held at the places."""
    cosine, sine = law.coefficients.reshape(2, -1)
    exact = figures(TASK, single(harmonic_law(cosine, sine, TASK.lobes)))
    over = exact.peak_acceleration_mm_s2 / law.at_places_mm_s2, exact.peak_power_w / POWER_W
    return abs(max(over) - 1.0)
