"""Speed against error of the certified limit and of makeable laws: rates, and references held against others."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from itertools import pairwise
from math import pi

import numpy as np
import pytest
from scipy.integrate import quad

from ncgear import extras
from ncgear.errors import WrongInput
from ncgear.optimum.certified.limit import CELLS, Bound
from ncgear.precision import limit, makeable, makeable_places
from ncgear.precision.catalogue import STUDIES
from ncgear.precision.limit_reference import least_acceleration_mm_s2
from ncgear.precision.measure import order, points
from ncgear.precision.study import Point
from oracles import convex_limit

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
    return limit.study().method(limit.BY_ANGLE).run(cells)


# --- the certified limit -----------------------------------------------------------------------------------------


@pytest.mark.parametrize("power_w", [6300.0, 18750.0])
def test_the_closed_form_is_the_convex_programmes_optimum(power_w: float) -> None:
    """Its grid of 320 has chords where motions peak, which is of second order."""
    angle = np.linspace(0.0, 2.0 * pi, PLACES)
    position = convex_limit.displacement(380.0, 960.0, angle)
    force = np.where(angle <= pi, limit.TASK.resistance.force_n(position), 0.0)
    convex = convex_limit.least_acceleration(380.0, 960.0, force, power_w, 2.0 * pi, (0.2, 5.0))
    exact = least_acceleration_mm_s2(limit.COEFFICIENTS_N, 760.0, power_w, 1.0, (1e4, 5e4))
    assert exact == pytest.approx(convex, rel=3e-3)


def test_the_closed_form_is_the_time_that_its_motion_takes() -> None:
    """The ceilings laid on top of each other by hand, and the time by adaptive quadrature of 1 / v."""
    most = limit.exact_mm_s2()

    def followed(x: float) -> float:
        force = np.polynomial.polynomial.polyval(x, limit.COEFFICIENTS_N)
        return (1e3 * limit.POWER_W / force) ** 2 / 2.0 if force > 0.0 else np.inf

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
    assert enclosed(cells).value < limit.exact_mm_s2() < enclosed(cells).attained


def test_enclosures_narrow_by_the_square_of_the_cells() -> None:
    measured = found("limit", limit.BY_ANGLE, 200, 400, CELLS, 6400)
    assert order(measured, 0.0) == pytest.approx(2.0, abs=0.06)
    assert measured[2].error < limit.ENOUGH < measured[1].error


def test_cells_even_in_the_way_are_worse_until_they_resolve_the_dead_centres() -> None:
    by_angle, by_way = (found("limit", method, 200, 400) for method in (limit.BY_ANGLE, limit.BY_WAY))
    assert all(other.error > 4.0 * own.error for own, other in zip(by_angle, by_way, strict=True))


@pytest.mark.parametrize("share", [1e-3, -1e-3])
def test_an_enclosure_that_does_not_hold_the_limit_is_told(share: float) -> None:
    moved = Bound(enclosed(6400).value * (1.0 + share), enclosed(6400).attained * (1.0 + share), 6400)
    assert limit.error(moved) > 0.9e-3
    assert not moved.value < limit.exact_mm_s2() < moved.attained


# --- makeable laws -----------------------------------------------------------------------------------------------


def test_the_makeable_study_names_what_is_missing(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(extras, "find_spec", lambda _: None)
    for study in (makeable.study, makeable_places.study):
        with pytest.raises(WrongInput, match="needs casadi"):
            study()


@pytest.mark.parametrize("power", [1.0, 1.7, 2.0])
def test_a_limit_is_extrapolated_whatever_the_rate(power: float) -> None:
    values = [5.0 + 3.0 / n**power for n in makeable.REFERENCE]
    assert makeable.extrapolated(values) == pytest.approx(5.0, abs=1e-13)


@pytest.mark.slow
def test_laws_stay_over_the_certified_limit() -> None:
    """All that makeable laws are asked beyond it is that pitch curves be convex, which costs a twelfth."""
    bound = limit.least_acceleration(makeable.BALER, makeable.LIMITS)
    assert bound.attained < makeable.least_mm_s2() < 1.1 * bound.value


@pytest.mark.slow
def test_two_forms_come_down_to_the_same_at_the_rate_of_smeared_corners() -> None:
    """Harmonics of 12, 24 and 48, extrapolated by themselves, end where splines do; coarse laws fall more slowly."""
    assert makeable.fitted_order() == pytest.approx(makeable.ORDER, abs=0.1)
    harmonics = found("makeable", makeable.AT_PLACES, 8, 12, 24, 48)
    least = makeable.least_mm_s2()
    own = makeable.extrapolated([least * (1.0 + point.error) for point in harmonics[1:]])
    assert own == pytest.approx(least, rel=2e-3)
    finished = found("makeable", makeable.FINISHED, 8, 12, makeable.HARMONICS)
    splines = found("makeable", makeable.SPLINES, 8, 12, makeable.HARMONICS)
    for measured in (harmonics, finished, splines):
        assert makeable.ORDER - 0.5 < order(measured, 0.0) < makeable.ORDER + 0.1
    assert finished[-1].error < makeable.ENOUGH < finished[1].error


@pytest.mark.slow
def test_what_is_left_between_places_falls_with_their_square() -> None:
    """With the highest harmonic alone (2 pi / n)^2 / 8 of it would be; laws have some hundredths of that."""
    measured = found("makeable-places", makeable_places.PROGRAMME, 4, 6, 10, 16)
    highest = [(2.0 * pi / point.level) ** 2 / 8.0 for point in measured]
    assert all(5e-3 < point.error / whole < 0.03 for point, whole in zip(measured, highest, strict=True))
    assert measured[2].error < makeable_places.ENOUGH < measured[1].error


def test_a_law_that_is_a_hundredth_too_good_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(makeable, "least_mm_s2", lambda: 18_944.0)
    study = makeable.study()
    assert study.error(0.99 * makeable.least_mm_s2()) == pytest.approx(0.01)
