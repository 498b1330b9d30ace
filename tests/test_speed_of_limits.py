"""Speed against error of the certified limit and of makeable laws: rates, and references held against others."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from itertools import pairwise
from math import pi

import numpy as np
import pytest
from scipy.integrate import quad

from ncgear.optimum.certified.limit import PLACES_ROUGH, Bound, least_acceleration
from ncgear.optimum.makeable.demanded import demands_of
from ncgear.optimum.makeable.wishes import Wishes
from oracles import convex_limit
from speed_against_error import certified_limit, makeable_laws
from speed_against_error.baler import COEFFICIENTS_N, TASK
from speed_against_error.certified_limit import BY_ANGLE, GRIDS, by_angle, exact_mm_s2, least_acceleration_mm_s2
from speed_against_error.makeable_laws import KNOTS, REFERENCE, extrapolated, fitted_order, least_mm_s2
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
def limit(places: int) -> Bound:
    return by_angle(places)


# --- the certified limit -----------------------------------------------------------------------------------------


@pytest.mark.slow
@pytest.mark.parametrize("power_w", [6300.0, 18750.0])
def test_the_closed_form_is_the_convex_programmes_optimum(power_w: float) -> None:
    """Its grid of 320 has chords where motions peak, which is of second order."""
    angle = np.linspace(0.0, 2.0 * pi, PLACES)
    position = convex_limit.displacement(380.0, 960.0, angle)
    force = np.where(angle <= pi, TASK.load.working.force_n(position), 0.0)
    convex = convex_limit.least_acceleration(380.0, 960.0, force, power_w, 2.0 * pi, (0.2, 5.0))
    exact = least_acceleration_mm_s2(COEFFICIENTS_N, 760.0, power_w, 1.0, (1e4, 5e4))
    assert exact == pytest.approx(convex, rel=3e-3)


@pytest.mark.slow
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


@pytest.mark.tiers(slow=["480"], rest="long")
@pytest.mark.parametrize("places", GRIDS)
def test_limits_are_below_the_closed_form_on_any_grid(places: int) -> None:
    """On the finest as well, where the multipliers are so rough that they prove little."""
    assert limit(places).value < exact_mm_s2()


@pytest.mark.slow
def test_what_limits_miss_falls_with_the_places() -> None:
    """Nothing is known of how a motion bends between two places, so the rate is one."""
    measured = found("limit", BY_ANGLE, *GRIDS[:4])
    assert order(measured, 0.0) == pytest.approx(1.0, abs=0.1)
    assert measured[3].level == PLACES_ROUGH
    assert measured[3].error < certified_limit.ENOUGH < measured[2].error


@pytest.mark.slow
@pytest.mark.xfail(strict=True, reason="on 3840 places the multipliers are rough: the limit is 28 % low")
def test_the_finest_grid_is_the_best() -> None:
    assert limit(GRIDS[-1]).value > limit(GRIDS[-2]).value


@pytest.mark.slow
@pytest.mark.parametrize("share", [1e-2, -1e-2])
def test_a_limit_that_is_a_hundredth_off_is_told(share: float) -> None:
    """The limit itself misses less than half of that."""
    moved = replace(limit(PLACES_ROUGH), value=limit(PLACES_ROUGH).value * (1.0 + share))
    assert certified_limit.limit_error(moved) > certified_limit.ENOUGH
    assert (moved.value < exact_mm_s2()) == (share < 0.0)


# --- makeable laws -----------------------------------------------------------------------------------------------


@pytest.mark.parametrize("power", [1.0, 1.7, 2.0])
def test_a_limit_is_extrapolated_whatever_the_rate(power: float) -> None:
    values = [5.0 + 3.0 / n**power for n in REFERENCE]
    assert extrapolated(values) == pytest.approx(5.0, abs=1e-13)


@pytest.mark.long
@pytest.mark.slow
def test_laws_stay_over_the_certified_limit() -> None:
    """And come within a hundredth of it."""
    bound = least_acceleration(TASK, demands_of(TASK, Wishes(makeable_laws.LIMITS)))
    assert bound.value < least_mm_s2() < 1.01 * bound.value


@pytest.mark.long
@pytest.mark.slow
def test_laws_come_down_at_the_rate_of_smeared_corners() -> None:
    """To where quintic splines did, of another program, as their coefficients were extrapolated: 18 944 mm/s2."""
    assert makeable_laws.ORDER - 0.1 < fitted_order() < makeable_laws.ORDER + 0.5
    assert least_mm_s2() == pytest.approx(18_944.0, rel=1e-3)
    finished = found("makeable", makeable_laws.FINISHED, 36, 60, 96, KNOTS)
    at_places = found("makeable", makeable_laws.AT_PLACES, 36, 60, 96, KNOTS)
    for measured in (finished, at_places):
        assert makeable_laws.ORDER - 0.5 < order(measured, 0.0) < makeable_laws.ORDER + 0.5
    assert finished[-1].error < makeable_laws.ENOUGH < finished[1].error


@pytest.mark.long
@pytest.mark.slow
def test_what_is_left_between_places_falls_with_their_square() -> None:
    measured = found("makeable-places", makeable_laws.PROGRAMME, 2, 4, 8)
    assert measured[1].error < measured[0].error / 3.0
    assert measured[2].error < measured[1].error
    assert measured[0].error < makeable_laws.ENOUGH_BETWEEN


def test_a_law_that_is_a_hundredth_too_good_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(makeable_laws, "least_mm_s2", lambda: 18_944.0)
    study = makeable_laws.makeable_study()
    assert study.error(0.99 * 18_944.0) == pytest.approx(0.01)
