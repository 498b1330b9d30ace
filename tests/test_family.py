"""The three-segment family: many laws at once against each law by itself, and the best of them."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from math import inf, pi

import numpy as np
import pytest
from scipy.optimize import brentq

from ncgear.errors import NoSuchMechanism
from ncgear.kinematics.check import work_per_stroke_j
from ncgear.kinematics.motion import Machine
from ncgear.mechanisms.crank_slider import CrankSlider
from ncgear.mechanisms.resistance import PolynomialResistance
from ncgear.numerics.arrays import Array
from ncgear.numerics.sampled import shares
from ncgear.optimum.family.best import BOX, Family, FamilyOptimum, Peak, best_of_family, figures
from ncgear.optimum.family.samples import (
    APPROACH,
    BOUNDS,
    BRAKING,
    POINTS,
    PRESSING,
    SKEWNESS_UNIT,
    return_samples,
    strokes_of,
    working_samples,
)
from ncgear.ratio.laws.three_segment import StrokeLaw, stroke_law
from ncgear.ratio.transmission import Lobes
from ncgear.ratio.working_stroke import solved_stroke

IN_LINE = CrankSlider(380.0, 960.0)
LINKAGES = {
    "in line": IN_LINE,
    "offset": CrankSlider(380.0, 960.0, 100.0),
    "short rod": CrankSlider(100.0, 120.0, -5.0),
}
RESISTANCE = PolynomialResistance((-131.2779, 3.447, 1.846e-2, -1.575e-4, 2.498e-7))
OMEGA = 2.0 * pi
"""60 r/min."""

SHAPES = np.array(
    [
        [0.65, 0.77, 0.7, 0.571, 0.3, 1.0],
        [0.53, 0.957, 1.0, 0.456, 1.41, 1.5],
        [0.6, 0.85, 0.8, 0.97, -0.6, 2.9],
    ]
)
"""Numbers of ``BOUNDS``; the second has no constant speed, in the third theta1 nearly falls on theta2."""


def made(shape: Array, linkage: CrankSlider, *, inverse: bool, lobes: Lobes | None = None) -> StrokeLaw:
    """The law of a shape as a design file makes it."""
    lobes = lobes or Lobes()
    strokes = strokes_of(shape[None], linkage.stroke_mm, lobes.driving_period_rad)
    stroke = solved_stroke(strokes.request(0, OMEGA))
    assert stroke.v2_mm_s == pytest.approx(strokes.pressing_mm_rad[0] * OMEGA, rel=1e-9)
    return stroke_law(stroke, linkage, lobes, inverse_basis=inverse)


@pytest.mark.parametrize("linkage", LINKAGES.values(), ids=LINKAGES)
def test_working_strokes_are_those_of_the_laws(linkage: CrankSlider) -> None:
    strokes = strokes_of(SHAPES, linkage.stroke_mm, 2.0 * pi)
    samples = working_samples(strokes)
    assert samples.advancing.all()
    for number, shape in enumerate(SHAPES):
        machine = Machine(made(shape, linkage, inverse=True).transmission, linkage, RESISTANCE, OMEGA)
        _, theta2, theta3, theta4 = strokes.theta_rad[number]
        parts = theta2 * shares(APPROACH), theta2 + (theta3 - theta2) * shares(PRESSING)
        # A joint belongs to what follows it, so the last point of each segment is left out
        phi1 = np.concatenate([*parts, theta4 - (theta4 - theta3) * shares(BRAKING)])
        ends = [0, APPROACH - 1, *range(APPROACH - 1, APPROACH + PRESSING), phi1.size - BRAKING, phi1.size - 1]
        kept = np.setdiff1d(np.arange(phi1.size), ends)
        exact = machine.displacement(phi1[kept], 2)
        assert np.max(np.abs(samples.displacement[number, kept] - exact.value)) <= 1e-10 * linkage.stroke_mm
        scale = np.abs(samples.acceleration).max()
        assert np.max(np.abs(samples.velocity[number, kept] - exact.derivative(1))) <= 1e-9 * scale
        assert np.max(np.abs(samples.acceleration[number, kept] - exact.derivative(2))) <= 1e-7 * scale


@pytest.mark.parametrize("inverse", [False, True])
@pytest.mark.parametrize("lobes", [Lobes(), Lobes(2, 1)])
@pytest.mark.parametrize("linkage", LINKAGES.values(), ids=LINKAGES)
def test_returns_are_those_of_the_laws(linkage: CrankSlider, lobes: Lobes, inverse: bool) -> None:
    """The law's own skewness is half the highest coefficient of its polynomial."""
    period = lobes.driving_period_rad
    for shape in SHAPES[:2]:
        law = made(shape, linkage, inverse=inverse, lobes=lobes)
        ends = law.return_law.ends
        mean = ends.driven_length_rad / ends.length_rad if inverse else ends.length_rad / ends.driven_length_rad
        skewness = np.array([law.return_law.polynomial.coef[5] / 2.0 / (SKEWNESS_UNIT * mean)])
        strokes = strokes_of(shape[None], linkage.stroke_mm, period)
        found = return_samples(strokes, skewness, linkage, period, inverse=inverse)
        assert found.closed.all()
        phi1 = ends.start_rad + ends.length_rad * shares(POINTS)
        turned = law.transmission.pieces[-1].driven_angle(phi1, 2)
        exact = linkage.displacement(turned).derivative(2)
        assert np.max(np.abs(found.acceleration[0] - exact)) <= 1e-6 * np.abs(exact).max()


def test_a_wrong_skewness_is_seen() -> None:
    """Negative control of the test above."""
    strokes = strokes_of(SHAPES[:1], 760.0, 2.0 * pi)
    right, wrong = (return_samples(strokes, np.array([s]), IN_LINE, 2.0 * pi, inverse=True) for s in (0.1, 0.1001))
    assert np.max(np.abs(right.acceleration - wrong.acceleration)) > 1e-6 * np.abs(right.acceleration).max()


def baler_point() -> Array:
    """The published baler in the unit box: a1 at 20 r/min, v1 : v2 = 1600 : 1100, and no skewness."""
    speed, delta = 52.8085 * pi / 30.0, 0.3 * pi
    brake = 1500.0 / (20.0 * pi / 30.0) ** 2 * delta / (1100.0 / speed)

    def ratio(chi: float) -> float:
        shape = np.array([[0.65, 1.0 / 1.3, 0.7, 0.4 / 0.7, chi, brake]])
        request = strokes_of(shape, 760.0, 2.0 * pi).request(0, 1.0)
        return float(request.v1_mm_s or 0.0) / float(strokes_of(shape, 760.0, 2.0 * pi).pressing_mm_rad[0])

    chi = brentq(lambda angle: ratio(angle) - 16.0 / 11.0, 0.0, 1.5)
    numbers = np.array([0.65, 1.0 / 1.3, 0.7, 0.4 / 0.7, chi, brake, 0.0])
    return (numbers - BOX[:, 0]) / (BOX[:, 1] - BOX[:, 0])


def test_the_published_baler_is_a_member() -> None:
    """6315 W and 1500 mm/s^2 in the working stroke at 20 r/min, its headline figures."""
    found = figures(Family(IN_LINE, RESISTANCE, 20.0 * pi / 30.0), baler_point()[None])
    assert found.power.max() == pytest.approx(6315.1, rel=1e-3)  # between samples
    assert np.abs(found.acceleration[:, :-POINTS]).max() == pytest.approx(1500.0, rel=1e-4)  # 52.8085, rounded


def test_shapes_that_turn_back_are_no_laws() -> None:
    random = np.random.default_rng(4)
    points = random.random((400, 7))
    found = figures(Family(IN_LINE, RESISTANCE, OMEGA), points)
    possible = np.isfinite(found.power[:, 0])
    assert 0.3 < possible.mean() < 0.95
    shapes = BOUNDS[:, 0] + points[:, :6] * (BOUNDS[:, 1] - BOUNDS[:, 0])
    for shape in shapes[~working_samples(strokes_of(shapes, 760.0, 2.0 * pi)).advancing][:10]:
        with pytest.raises(NoSuchMechanism):
            made(shape, IN_LINE, inverse=True)


@cache
def best(cap_w: float, *, inverse: bool, seed: int = 1) -> FamilyOptimum:
    """The least acceleration on the baler's linkage at 60 r/min."""
    return best_of_family(Family(IN_LINE, RESISTANCE, OMEGA, inverse), Peak.ACCELERATION, cap_w, seed=seed, starts=16)


@pytest.mark.parametrize(
    ("cap_w", "inverse", "at_most"),
    [
        (18750.0, True, 15_600.0),
        pytest.param(12000.0, False, 18_750.0, marks=pytest.mark.slow),
        pytest.param(9375.0, True, 28_000.0, marks=pytest.mark.slow),
    ],
)
def test_the_reach_of_the_family_on_the_baler(cap_w: float, inverse: bool, at_most: float) -> None:
    """What a thousand descents came to, and 1 % more; the uniform crank needs 20 940 mm/s^2 and 26 070 W."""
    optimum = best(cap_w, inverse=inverse)
    assert optimum.peak(Peak.POWER) <= cap_w * (1.0 + 1e-6)
    assert optimum.peak(Peak.ACCELERATION) <= at_most
    assert abs(optimum.law.transmission.closure_error_rad) <= 1e-12


def test_the_same_seed_gives_the_same_law() -> None:
    again = best_of_family(Family(IN_LINE, RESISTANCE, OMEGA, True), Peak.ACCELERATION, 18750.0, starts=16)
    assert again.request == best(18750.0, inverse=True).request


def test_the_request_makes_the_law_again() -> None:
    """As a design file would, with v2 to be found."""
    optimum = best(18750.0, inverse=True)
    again = stroke_law(solved_stroke(replace(optimum.request)), IN_LINE, Lobes(), inverse_basis=True)
    phi1 = np.linspace(0.0, 2.0 * pi, 50)
    exact = optimum.law.transmission.driven_angle(phi1).value
    assert np.array_equal(again.transmission.driven_angle(phi1).value, exact)


def test_least_power_under_the_acceleration_found_is_the_power_cap() -> None:
    """Both ways of asking lead to the same frontier."""
    optimum = best(12000.0, inverse=True)
    cap = optimum.peak(Peak.ACCELERATION)
    other = best_of_family(Family(IN_LINE, RESISTANCE, OMEGA, True), Peak.POWER, cap, starts=16)
    assert other.peak(Peak.ACCELERATION) <= cap * (1.0 + 1e-6)
    assert other.peak(Peak.POWER) == pytest.approx(12000.0, rel=0.02)


@pytest.mark.parametrize("linkage", LINKAGES.values(), ids=LINKAGES)
def test_without_resistance_any_cap_is_kept(linkage: CrankSlider) -> None:
    family = Family(linkage, PolynomialResistance(), OMEGA, True)
    optimum = best_of_family(family, Peak.ACCELERATION, 1.0, starts=6)
    assert optimum.peak(Peak.POWER) == 0.0
    without = best_of_family(family, Peak.ACCELERATION, inf, starts=6)
    assert without.peak(Peak.ACCELERATION) == pytest.approx(optimum.peak(Peak.ACCELERATION), rel=0.01)


@pytest.mark.slow
def test_a_cap_out_of_reach_is_refused_with_what_is_in_reach() -> None:
    """The work of a stroke in a whole cycle is a power no law goes below."""
    mean_w = work_per_stroke_j(RESISTANCE, 760.0)
    with pytest.raises(NoSuchMechanism, match=r"power of \d+ or less; the least found is (\d+)") as caught:
        best_of_family(Family(IN_LINE, RESISTANCE, OMEGA, True), Peak.ACCELERATION, float(round(mean_w)), starts=4)
    assert float(caught.value.problem.split()[-1]) > mean_w
