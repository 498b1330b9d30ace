"""The equivalent-gear method: exact on circles, third order in the distance rolled elsewhere, straight where k = 0."""

from __future__ import annotations

from math import pi

import numpy as np
import pytest

from at_once import at_once
from ncgear.pitch.curve import CurvePoints
from ncgear.pitch.pair import sized_pair
from ncgear.pitch.shape import Gear
from ncgear.ratio.laws.ellipse import elliptical_law
from ncgear.ratio.laws.uniform import uniform_law
from ncgear.ratio.transmission import Lobes, Transmission
from ncgear.teeth.flank import Flanks, flanks_of, on_circles
from ncgear.teeth.form import ToothForm
from ncgear.teeth.gear import toothed_pair
from ncgear.teeth.tool import RackLine
from pairs import rack, sine_law

MODULE = 2.0

Array = np.ndarray


def touched(curvature: float, turn: float = 0.7) -> CurvePoints:
    """A curve's point at (3, -2) whose tangent stands at an angle."""
    tangent = np.array([[np.cos(turn), np.sin(turn)]])
    return CurvePoints(np.array([[3.0, -2.0]]), tangent, -1.0, np.array([curvature]))


@at_once("curvature", [0.3, 1e-3, 1e-9, -1e-3, -0.3])
def test_points_are_on_the_circle_of_curvature(curvature: float) -> None:
    """At one radius from the centre, an arc from the touching point, the tangent square to the radius."""
    at, rolled = touched(curvature), np.linspace(-4.0, 4.0, 17)
    points = on_circles(at, rolled)
    center = at.position - at.normal / curvature
    arm = points.position - center
    assert np.linalg.norm(arm, axis=1) == pytest.approx(1.0 / abs(curvature), rel=1e-14)
    assert points.normal == pytest.approx(
        np.sign(curvature) * arm * abs(curvature), abs=1e-6 if curvature < 1e-8 else 1e-13
    )
    assert np.sum(points.tangent * points.normal, axis=1) == pytest.approx(0.0, abs=1e-15)
    chord = np.linalg.norm(points.position - at.position, axis=1)
    assert chord == pytest.approx(np.abs(2.0 * np.sin(rolled * curvature / 2.0) / curvature), rel=1e-13)


def test_where_the_curvature_vanishes_the_circle_is_the_tangent() -> None:
    at, rolled = touched(0.0), np.linspace(-4.0, 4.0, 17)
    points = on_circles(at, rolled)
    assert points.position == pytest.approx(at.position + rolled[:, None] * at.tangent, abs=1e-15)
    assert np.all(points.tangent == at.tangent)
    assert np.all(points.normal == at.normal)


def test_the_limit_of_small_curvature_is_smooth() -> None:
    """Against the tangent a circle falls off by k s^2 / 2: first order in the curvature down to rounding."""
    rolled = np.array([3.0])
    straight = on_circles(touched(0.0), rolled).position
    for curvature in (1e-4, 1e-8, 1e-12):
        away = np.sum((on_circles(touched(curvature), rolled).position - straight) * touched(0.0).normal)
        assert away == pytest.approx(-curvature * 9.0 / 2.0, abs=2e-15, rel=1e-6)


def both(law: Transmission, teeth: int, gear: Gear) -> tuple[Flanks, Flanks]:
    """Exact flanks and those of the equivalent gears."""
    pair = sized_pair(law, teeth, MODULE, None)
    curve = pair.driving if gear is Gear.DRIVING else pair.driven
    exact, circles = (flanks_of(curve, rack(), teeth, RackLine(), 0.3, equivalent=e) for e in (False, True))
    return exact, circles


@pytest.mark.parametrize("gear", Gear)
def test_on_circles_both_methods_agree(gear: Gear) -> None:
    exact, circles = both(uniform_law(Lobes()), 25, gear)
    number, height = np.arange(50)[:, None], np.linspace(-1.0, 1.0, 9) * MODULE
    for one, other in zip(exact.flank(number, height), circles.flank(number, height), strict=True):
        assert one == pytest.approx(other, abs=1e-11)
    sigma = exact.rolled_mm(number, height)
    for one, other in zip(exact.fillet(number, sigma), circles.fillet(number, sigma), strict=True):
        assert one == pytest.approx(other, abs=1e-11)
    assert exact.regularity(number, height) == pytest.approx(circles.regularity(number, height), abs=1e-12)


@pytest.mark.parametrize("gear", Gear)
def test_on_an_ellipse_the_error_is_of_third_order_in_the_height(gear: Gear) -> None:
    """The circle and the curve part with the third power of the distance rolled, and so do the flanks."""
    exact, circles = both(elliptical_law(0.35, 0.0, Lobes()), 37, gear)
    every = np.arange(exact.count)
    heights = 0.4 * MODULE * 0.5 ** np.arange(4)
    errors = np.array(
        [
            np.linalg.norm(
                exact.flank(every, np.full(74, h))[0] - circles.flank(every, np.full(74, h))[0], axis=1
            ).max()
            for h in heights
        ]
    )
    rates = np.log2(errors[:-1] / errors[1:])
    assert rates == pytest.approx(3.0, abs=0.05)
    # At full height: the exact curve is not within a thousandth of a module of its circles.
    assert errors[0] > 1e-4 * MODULE


@pytest.mark.parametrize("gear", Gear)
def test_equivalent_flanks_cross_the_pitch_curve_where_the_exact_ones_do(gear: Gear) -> None:
    exact, circles = both(elliptical_law(0.5, 0.2, Lobes()), 37, gear)
    every = np.arange(exact.count)
    zero = np.zeros(exact.count)
    for one, other in zip(exact.flank(every, zero), circles.flank(every, zero), strict=True):
        assert one == pytest.approx(other, abs=1e-11)


@pytest.mark.thorough
def test_a_pair_by_the_equivalent_method_differs_where_the_curvature_changes() -> None:
    """Outlines of the same teeth: a thousandth of a module apart on a mild law, nothing on circles."""
    for law, least, most in ((uniform_law(Lobes()), 0.0, 1e-9), (sine_law(0.08), 1e-3, 0.05)):
        pitch = sized_pair(law, 40, MODULE, None)
        exact, circles = (toothed_pair(pitch, ToothForm(rack(), equivalent=e), 0.001).driving for e in (False, True))
        height = np.linspace(-0.9, 0.9, 7) * MODULE
        points = [gear.flanks.flank(np.arange(80)[:, None], height)[0] for gear in (exact, circles)]
        apart = np.linalg.norm(points[0] - points[1], axis=-1).max() / MODULE
        assert least <= apart <= most
        assert pi * 40 * MODULE == pytest.approx(exact.flanks.curve.length_mm, rel=1e-12)
