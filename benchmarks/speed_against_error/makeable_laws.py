"""The studies of makeable laws: how many knots they need, and at how many places they are held to their limits.

Both take the baler at 60 r/min with half of its published power and convex pitch curves, as designs/baler-half.yaml.
The best motion has corners.  A spline of n knots smears a corner over a share 1/n of the turn, which costs a share of
the time of the order 1/n^2.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cache
from math import log2, pi

import numpy as np

from ncgear.numerics.arrays import Array
from ncgear.optimum.certified.limit import Motion
from ncgear.optimum.makeable.places import cell_ends, places
from ncgear.optimum.makeable.programme import programme
from ncgear.optimum.makeable.reached import JudgedLaw, ratios
from ncgear.optimum.makeable.search import STEPS, LawSearch, kept, scales, searched
from ncgear.optimum.makeable.wishes import Wishes
from ncgear.optimum.task import Limits, figures
from ncgear.ratio.laws.spline import spline_ratio_law
from ncgear.ratio.transmission import single
from speed_against_error.baler import TASK
from speed_against_error.study import Method, Study

POWER_W = 9375.0
LIMITS = Limits(0.2, 5.0, POWER_W)
KNOTS = Wishes(LIMITS).knots
"""The default of design files."""

EVEN = Motion(np.array([0.0, pi]), np.ones(2))
"""A crank that turns evenly."""


# --- knots -----------------------------------------------------------------------------------------------------------

COUNTS = (36, 60, 96, KNOTS, 360)

ORDER = 2.0

REFERENCE = (180, 360, 720)
"""Knots of the reference's splines, each number twice the one before."""

ENOUGH = 2e-3
"""As a share of the goal: the machine's resistance is not known better."""

FINISHED, AT_PLACES = "cubic splines", "cubic splines, limits at the places only"


def makeable_study() -> Study:
    """By how much the baler's least acceleration exceeds its limit for any number of knots."""
    return Study(
        key="makeable",
        title="Makeable law",
        unit="share",
        reference="Aitken's extrapolation, which fits limit and rate, of cubic splines with "
        f"{', '.join(map(str, REFERENCE))} knots and limits at their places",
        methods=(
            Method(FINISHED, "knots", COUNTS, _kept_mm_s2, ORDER),
            Method(AT_PLACES, "knots", COUNTS, _at_places_mm_s2, ORDER),
        ),
        error=lambda found: abs(found / least_mm_s2() - 1.0),
        chosen=(FINISHED, KNOTS),
        enough=ENOUGH,
        because="twice the knots gain a thousandth and take twice as long",
    )


def least_mm_s2() -> float:
    """The acceleration that any number of knots comes down to."""
    return extrapolated(_reference_mm_s2())


def fitted_order() -> float:
    """The rate at which the reference's splines come down to it."""
    first, second, third = _reference_mm_s2()
    return log2((first - second) / (second - third))


@cache
def _reference_mm_s2() -> tuple[float, ...]:
    return tuple(_at_places_mm_s2(count) for count in REFERENCE)


def extrapolated(values: Sequence[float]) -> float:
    """The limit of three values whose excess falls by the same factor from each to the next."""
    first, second, third = values
    return third - (second - third) ** 2 / (first - 2.0 * second + third)


def _kept_mm_s2(count: int) -> float:
    """The peak acceleration of a law of so many knots as ncgear makes it, with limits held everywhere.

    Raises ArithmeticError if there is none.
    """
    search = searched(TASK, Wishes(LIMITS, knots=count))
    found = kept(search, search.begun(EVEN))
    if found is None:
        raise ArithmeticError(f"no law of {count} knots was found")
    return float(found.reached[0]) * scales(TASK).acceleration_mm_s2


def _at_places_mm_s2(count: int) -> float:
    """The least peak acceleration of a law whose limits hold at the programme's places."""
    return best_at_places(count, STEPS).level_mm_s2


@dataclass(frozen=True, eq=False)
class LawAtPlaces:
    """A law whose limits hold at places only: ratios at the knots, the largest acceleration at the places, its level.

    The level also counts the peaks between the places, as parabolas through the places estimate them.
    """

    ratio: Array
    at_places_mm_s2: float
    level_mm_s2: float


def best_at_places(count: int, steps: int) -> LawAtPlaces:
    """The best law of so many knots whose limits hold at so many steps between two knots, an even number.

    Raises ArithmeticError if the optimiser finds none.
    """
    search = _in_steps(searched(TASK, Wishes(LIMITS, knots=count)), steps)
    found = search.programme.solved(search.caps, search.weights, search.begun(EVEN))
    if found is None:
        raise ArithmeticError(f"no law of {count} knots was found")
    at, basis = search.programme.rows.at, search.programme.basis
    judged = JudgedLaw(search.programme.levels, at, ratios(at, basis, found.coefficients, [TASK.cycle_rad]))
    unit = scales(TASK).acceleration_mm_s2
    largest = max(float(np.max(term)) for term in judged.terms[0])
    return LawAtPlaces(search.rounded(found.coefficients)[0], unit * largest, unit * float(judged.reached[0]))


def _in_steps(search: LawSearch, steps: int) -> LawSearch:
    """The search with another number of steps of the programme's places between two knots."""
    old = search.programme
    at = places(TASK, cell_ends(TASK, old.knots.angle_rad, []), steps)
    return replace(search, programme=programme(old.levels, old.knots, at, old.cycles_rad))


# --- places ----------------------------------------------------------------------------------------------------------

PLACES = (2, 4, 8)
ENOUGH_BETWEEN = 5e-4
"""As a share of a limit: one or two more rounds of a few steps each then keep it everywhere."""

PROGRAMME = "even places, one round"


def places_study() -> Study:
    """By how much the baler's law exceeds, between its places, the limits that it keeps at them.

    The programme misses a peak between two places by at most the square of their distance, and by less if the peak
    happens to lie near one of them.  The error therefore falls with the square, but not evenly, and no rate is fitted.
    """
    return Study(
        key="makeable-places",
        title="Makeable law between its places",
        unit="share",
        reference="the exact peaks of acceleration and power of the law that was found, located on its closed form",
        methods=(Method(PROGRAMME, "steps between two knots", PLACES, lambda steps: best_at_places(KNOTS, steps)),),
        error=_excess,
        chosen=(PROGRAMME, STEPS),
        enough=ENOUGH_BETWEEN,
        because="what is left between them is so little that keeping terms back by it takes one or two short rounds "
        "more; the time grows with the places",
    )


def _excess(law: LawAtPlaces) -> float:
    """The larger share by which an exact peak, of acceleration or power, exceeds the limit held at the places."""
    angle = 2.0 * pi * np.arange(law.ratio.size) / law.ratio.size
    exact = figures(TASK, single(spline_ratio_law(angle, law.ratio, TASK.lobes)))
    over = exact.peak_acceleration_mm_s2 / law.at_places_mm_s2, exact.peak_power_w / POWER_W
    return abs(max(over) - 1.0)
