"""Speed against error of the certified limit and of makeable laws: rates, and references held against others."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from itertools import pairwise
from math import pi

import numpy as np
import pytest
from scipy.integrate import quad

from ncgear.optimum.certified.limit import CELLS, Bound, least_acceleration
from oracles import convex_limit
from speed_against_error import certified_limit, makeable_laws
from speed_against_error.baler import COEFFICIENTS_N, TASK
from speed_against_error.certified_limit import BY_ANGLE, BY_WAY, by_angle, exact_mm_s2, least_acceleration_mm_s2
from speed_against_error.makeable_laws import HARMONICS, REFERENCE, extrapolated, fitted_order, least_mm_s2
from speed_against_error.run import STUDIES
from speed_against_error.study import Point, order, points

PLACES = 321


@cache
def found(key: str, method: str, *levels: int) -> tuple[Point, ...]:
    """Points of a method at a few of its levels, each run once."""
    study = STUDIES[key]()
    chosen = study.method(method)
    assert set(levels) <= set(chosen.levels)
    return points(study, replace(chosen, levels=levels), timed_s=0.0)


@cache
def enclosed(cells: int) -> Bound:
    return by_angle(cells)


# --- the certified limit -----------------------------------------------------------------------------------------


@pytest.mark.parametrize("power_w", [6300.0, 18750.0])
def test_the_closed_form_is_the_convex_programmes_optimum(power_w: float) -> None:
    """Its grid of 320 has chords where motions peak, which is of second order."""
    angle = np.linspace(0.0, 2.0 * pi, PLACES)
    position = convex_limit.displacement(380.0, 960.0, angle)
    force = np.where(angle <= pi, TASK.resistance.force_n(position), 0.0)
    convex = convex_limit.least_acceleration(380.0, 960.0, force, power_w, 2.0 * pi, (0.2, 5.0))
    exact = least_acceleration_mm_s2(COEFFICIENTS_N, 760.0, power_w, 1.0, (1e4, 5e4))
    assert exact == pytest.approx(convex, rel=3e-3)


def test_the_closed_form_is_the_time_that_its_motion_takes() -> None:
    """The ceilings laid on top of each other by hand, and the time by adaptive quadrature of 1 / v."""
    most = exact_mm_s2()

    def followed(x: float) -> float:
        force = np.polynomial.polynomial.polyval(x, COEFFICIENTS_N)
        return (1e3 * certified_limit.POWER_W / force) ** 2 / 2.0 if force > 0.0 else np.inf

    # Where the ceiling is steeper than the acceleration, the line that touches it is below it.
    touching = min(np.linspace(450.0, 600.0, 150_001), key=lambda x: followed(x) + most * x)
    peak = (touching + followed(touching) / most) / 2.0

    def seconds(x: float) -> float:
        braking = followed(touching) + most * (touching - x) if x < touching else followed(x)
        return 1.0 / np.sqrt(2.0 * min(most * x, braking, most * (760.0 - x)))

    corners = (0.0, peak, touching, 759.0, 759.0548, 760.0)
    out = sum(quad(seconds, low, high, epsabs=1e-11)[0] for low, high in pairwise(corners))
    assert out + 2.0 * np.sqrt(760.0 / most) == pytest.approx(1.0, abs=2e-7)


def test_a_resistance_of_another_kind_is_refused() -> None:
    with pytest.raises(ArithmeticError, match="not of the kind"):
        least_acceleration_mm_s2((100.0, 0.0), 760.0, 6300.0, 1.0, (1e4, 5e4))


@pytest.mark.parametrize("cells", [200, 400, CELLS, 6400])
def test_enclosures_hold_the_closed_form(cells: int) -> None:
    assert enclosed(cells).value < exact_mm_s2() < enclosed(cells).attained


def test_enclosures_narrow_by_the_square_of_the_cells() -> None:
    measured = found("limit", BY_ANGLE, 200, 400, CELLS, 6400)
    assert order(measured, 0.0) == pytest.approx(2.0, abs=0.06)
    assert measured[2].error < certified_limit.ENOUGH < measured[1].error


def test_cells_even_in_the_way_are_worse_until_they_resolve_the_dead_centres() -> None:
    by_angle, by_way = (found("limit", method, 200, 400) for method in (BY_ANGLE, BY_WAY))
    assert all(other.error > 4.0 * own.error for own, other in zip(by_angle, by_way, strict=True))


@pytest.mark.parametrize("share", [1e-3, -1e-3])
def test_an_enclosure_that_does_not_hold_the_limit_is_told(share: float) -> None:
    moved = Bound(enclosed(6400).value * (1.0 + share), enclosed(6400).attained * (1.0 + share), 6400)
    assert certified_limit.limit_error(moved) > 0.9e-3
    assert not moved.value < exact_mm_s2() < moved.attained


# --- makeable laws -----------------------------------------------------------------------------------------------


@pytest.mark.parametrize("power", [1.0, 1.7, 2.0])
def test_a_limit_is_extrapolated_whatever_the_rate(power: float) -> None:
    values = [5.0 + 3.0 / n**power for n in REFERENCE]
    assert extrapolated(values) == pytest.approx(5.0, abs=1e-13)


@pytest.mark.slow
def test_laws_stay_over_the_certified_limit() -> None:
    """All that makeable laws are asked beyond it is that pitch curves be convex, which costs a twelfth."""
    bound = least_acceleration(TASK, makeable_laws.LIMITS)
    assert bound.attained < least_mm_s2() < 1.1 * bound.value


@pytest.mark.slow
def test_two_forms_come_down_to_the_same_at_the_rate_of_smeared_corners() -> None:
    """Harmonics of 12, 24 and 48, extrapolated by themselves, end where splines do; coarse laws fall more slowly."""
    assert fitted_order() == pytest.approx(makeable_laws.ORDER, abs=0.1)
    harmonics = found("makeable", makeable_laws.AT_PLACES, 8, 12, 24, 48)
    least = least_mm_s2()
    own = extrapolated([least * (1.0 + point.error) for point in harmonics[1:]])
    assert own == pytest.approx(least, rel=2e-3)
    finished = found("makeable", makeable_laws.FINISHED, 8, 12, HARMONICS)
    splines = found("makeable", makeable_laws.SPLINES, 8, 12, HARMONICS)
    for measured in (harmonics, finished, splines):
        assert makeable_laws.ORDER - 0.5 < order(measured, 0.0) < makeable_laws.ORDER + 0.1
    assert finished[-1].error < makeable_laws.ENOUGH < finished[1].error


@pytest.mark.slow
def test_what_is_left_between_places_falls_with_their_square() -> None:
    """With the highest harmonic alone (2 pi / n)^2 / 8 of it would be; laws have some hundredths of that."""
    measured = found("makeable-places", makeable_laws.PROGRAMME, 4, 6, 10, 16)
    highest = [(2.0 * pi / point.level) ** 2 / 8.0 for point in measured]
    assert all(5e-3 < point.error / whole < 0.03 for point, whole in zip(measured, highest, strict=True))
    assert measured[2].error < makeable_laws.ENOUGH_BETWEEN < measured[1].error


def test_a_law_that_is_a_hundredth_too_good_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(makeable_laws, "least_mm_s2", lambda: 18_944.0)
    study = makeable_laws.makeable_study()
    assert study.error(0.99 * 18_944.0) == pytest.approx(0.01)
