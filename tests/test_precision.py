"""Speed against error: rates are the theory's, what ncgear uses is exact, and the page says what is measured."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest

import ncgear.precision.catalogue as catalogue
from ncgear.output.precision import page
from ncgear.precision import bases, closure, curvature, inversion, pitch_curves, pitch_length, quadrature
from ncgear.precision.knee import knee
from ncgear.precision.measure import measured, order
from ncgear.precision.rates import rates
from ncgear.precision.study import Measured, Method, Point, Study

PAGE = Path(__file__).parents[1] / "docs" / "speed-against-error.md"

every_study = pytest.mark.parametrize("key", catalogue.STUDIES)


@cache
def of(key: str) -> Measured:
    """Each level once: errors do not depend on how often."""
    return measured(catalogue.STUDIES[key](), timed_s=0.0)


# --- studies ---------------------------------------------------------------------------------------------------------

BOUNDS = {
    "inversion": 5e-15,
    "closure": 1e-14,
    "return-basis": 1e-14,
    "driven-angle-ellipse": 5e-14,
    "driven-angle-return": 5e-15,
    "pitch-length-ellipse": 1e-15,
    "pitch-length-baler": 1e-15,
    "curvature-ellipse": 2e-15,
    "curvature-baler": 5e-15,
}
"""Error of what ncgear does: some rounding errors; of phi2 on the ellipse, whose slopes go up to 19, some more."""

RATED = [key for key in BOUNDS if key != "return-basis"]
"""Studies with a method whose rate theory tells."""

RATE_BAND = 0.3
"""The error's constant changes with where the samples fall between the points looked at."""


@every_study
def test_a_study_is_known_by_its_own_key(key: str) -> None:
    assert catalogue.STUDIES[key]().key == key


@pytest.mark.parametrize("key", BOUNDS)
def test_what_ncgear_does_is_exact(key: str) -> None:
    assert of(key).chosen[1].error <= BOUNDS[key]


@pytest.mark.parametrize("key", RATED)
def test_rates_are_the_theorys(key: str) -> None:
    found = rates(of(key))
    assert found
    for rate in found:
        assert abs(rate.fitted - rate.theory) <= RATE_BAND, rate


def test_the_law_of_cosines_is_lost_at_the_dead_centres() -> None:
    """Half the digits go at both: the reference tells what is wrong by more than rounding."""
    phi1 = inversion.angles()
    assert inversion.error(inversion.closed_form(phi1)) <= 5e-15
    assert inversion.error(inversion.textbook(phi1)) >= 1e-3


@pytest.mark.parametrize("row", [0, 1])
def test_a_planted_error_of_an_inversion_is_told(row: int) -> None:
    planted = inversion.closed_form(inversion.angles())
    planted[row, 200] *= 1.0 + 1e-10
    assert inversion.error(planted) >= 5e-11


def test_a_planted_error_of_phi2_is_told() -> None:
    stretch = quadrature.return_of_baler()
    planted = quadrature.read(stretch, lambda angles: quadrature.panels(stretch, 24)(angles + 1e-10))
    assert quadrature.error(stretch, planted) >= 5e-11


def test_a_planted_error_of_closure_is_told() -> None:
    law = closure.ncgears_own()
    assert closure.error(replace(law, polynomial=law.polynomial * (1.0 + 1e-10))) >= 5e-11


def test_a_return_in_powers_of_phi1_loses_half_its_digits() -> None:
    assert bases.error(bases.ncgears_own()) <= 1e-14
    assert bases.error(bases.solved(bases.global_powers)) >= 1e-9


@pytest.mark.parametrize("curve", [pitch_curves.of_ellipse(), pitch_curves.of_baler()], ids=lambda curve: curve.name)
def test_planted_errors_of_pitch_curves_are_told(curve: pitch_curves.Curve) -> None:
    length, bent = pitch_length.panels(curve, 24), curvature.closed_form(curve)
    bent[3] += 1e-10 * np.max(np.abs(bent))
    assert pitch_length.error(curve, length * (1.0 + 1e-10)) == pytest.approx(1e-10, rel=1e-4)
    assert curvature.error(curve, bent) == pytest.approx(1e-10, rel=1e-3)


def test_the_exact_length_is_the_published_one() -> None:
    assert 200.0 * float(pitch_curves.of_baler().length()) == pytest.approx(629.2813, abs=5e-5)


def test_trapezoids_are_spectral_on_a_smooth_closed_curve() -> None:
    """Halving the gaps squares the error; with the baler's joints it only quarters it."""
    ellipse, jointed = of("pitch-length-ellipse"), of("pitch-length-baler")
    rows = [dict(zip((m.name for m in one.study.methods), one.points, strict=True)) for one in (ellipse, jointed)]
    smooth, kinked = ([point.error for point in row["trapezoids"]] for row in rows)
    assert smooth[1] <= 1e-15
    assert kinked[1] >= 1e-5


# --- measuring -------------------------------------------------------------------------------------------------------


def by_hand(*rows: tuple[Point, ...], enough: float = 0.0) -> Measured:
    """A study of made-up points; the first point of the first method is what is chosen."""
    methods = tuple(Method(f"m{i}", "steps", tuple(p.level for p in row), float) for i, row in enumerate(rows))
    chosen = "m0", rows[0][0].level
    return Measured(Study("made", "Made up", "mm", "none", methods, float, chosen, enough, "it is first"), rows)


def test_a_rate_is_the_slope_of_the_logarithms() -> None:
    points = [Point(n, 1.0, 7.0 / n**3) for n in (2, 4, 8, 16)]
    assert order(points, 0.0) == pytest.approx(3.0, abs=1e-12)


def test_rounding_does_not_count_for_a_rate() -> None:
    """Neither what lies under the floor nor what grows again behind the least error."""
    points = [Point(n, 1.0, e) for n, e in ((1, 1.0), (2, 0.25), (4, 0.0625), (8, 1e-15), (16, 0.5))]
    assert order(points, 1e-12) == pytest.approx(2.0, abs=1e-12)


def test_one_point_tells_no_rate() -> None:
    with pytest.raises(ValueError, match="no rate can be told"):
        order([Point(1, 1.0, 1.0), Point(2, 1.0, 1e-16)], 1e-12)


def test_an_error_that_is_no_number_is_refused() -> None:
    study = Study("s", "S", "mm", "-", (Method("m", "", (0,), lambda _: np.nan),), float, ("m", 0), 0.0, "-")
    with pytest.raises(ArithmeticError, match="s: the error of 'm' at level 0 is nan"):
        measured(study, timed_s=0.0)


def test_the_knee_is_the_quickest_that_is_exact_enough() -> None:
    exact, rough, slow = Point(1, 1.0, 2e-15), Point(1, 0.1, 1e-3), Point(1, 9.0, 1e-15)
    told = knee(by_hand((exact,), (rough,), (slow,)))
    assert told.is_chosen
    assert told.error == pytest.approx(1e-14)
    assert told.cheaper is not None
    assert told.dearer is not None
    assert (told.cheaper[1], told.dearer[1]) == (rough, slow)


def test_a_choice_that_is_slow_or_wrong_is_no_knee() -> None:
    good = Point(1, 1.0, 1e-15)
    assert not knee(by_hand((Point(1, 2.0, 1e-15),), (good,))).is_chosen
    assert not knee(by_hand((Point(1, 0.5, 1e-13),), (good,))).is_chosen
    assert knee(by_hand((Point(1, 0.5, 1e-13),), (good,), enough=1e-12)).is_chosen


@pytest.mark.parametrize(
    ("chosen", "said"),
    [
        (Point(1, 1.0, 1e-15), "That is the knee"),
        (Point(1, 8.0, 1e-15), "That is not the knee: m1, 1 steps (2 s) has an error of at most 1.0e-14 too, 4 times"),
        (Point(1, 1.0, 1e-3), "That is not the knee: its error is larger than 1.0e-14"),
    ],
)
def test_the_page_says_whether_the_choice_is_the_knee(chosen: Point, said: str) -> None:
    assert said in page([by_hand((chosen,), (Point(1, 2.0, 1e-15),))])
