"""The three-segment family: many laws at once against each law by itself, and the best of them."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from math import inf, pi

import numpy as np
import pytest
from scipy.optimize import brentq

from ncgear.errors import NoSuchMechanism
from ncgear.kinematics.motion import Machine
from ncgear.mechanisms.crank_slider import CrankSlider
from ncgear.mechanisms.slider_load import SliderLoad
from ncgear.numerics.arrays import Array
from ncgear.numerics.sampled import shares
from ncgear.optimum.family import (
    BOX,
    RETURN_POINTS,
    SEGMENT_POINTS,
    FamilyOptimum,
    LawFamily,
    PeakGoal,
    best_of_family,
    request_at,
    sampled_laws,
    strokes_at,
)
from ncgear.optimum.task import Task
from ncgear.ratio.laws.three_segment import StrokeLaw, stroke_law
from ncgear.ratio.sampled_strokes import (
    BUMP_HEIGHT,
    ReturnSamples,
    return_samples,
    returns_with_skewness,
    working_motions,
)
from ncgear.ratio.transmission import Lobes
from ncgear.ratio.working_stroke import solved_stroke
from published import BALER_LINKAGE, OFFSET, PRESS

LINKAGES = {
    "in line": BALER_LINKAGE,
    "offset": OFFSET,
    "short rod": CrankSlider(100.0, 120.0, -5.0),
}
OMEGA = 2.0 * pi
"""60 r/min."""

SHAPES = np.array(
    [
        [0.65, 0.77, 0.7, 0.571, 0.3, 1.0],
        [0.53, 0.957, 1.0, 0.456, 1.41, 1.5],
        [0.6, 0.85, 0.8, 0.97, -0.6, 2.9],
    ]
)
"""Numbers of ``BOX``; the second has no constant speed, in the third theta1 nearly falls on theta2."""


def points_of(shapes: Array, skewness: float = 0.0) -> Array:
    """Shapes (shape (n, 6)) with a skewness as points of the unit box."""
    numbers = np.column_stack([shapes, np.full(len(shapes), skewness)])
    points: Array = (numbers - BOX[:, 0]) / (BOX[:, 1] - BOX[:, 0])
    return points


def family_of(linkage: CrankSlider, *, inverse: bool = True, lobes: Lobes | None = None) -> LawFamily:
    """The family against the baler's resistance."""
    return LawFamily(Task(linkage, PRESS, OMEGA, lobes or Lobes()), inverse)


def made(shape: Array, family: LawFamily) -> StrokeLaw:
    """The law of a shape as a design file makes it."""
    point = points_of(shape[None])
    stroke = solved_stroke(request_at(family, point[0]))
    strokes, _ = strokes_at(family, point)
    assert stroke.v2 == pytest.approx(strokes.pressing_mm_rad[0] * OMEGA, rel=1e-9)
    return stroke_law(stroke, family.task.linkage, family.task.lobes, inverse_basis=family.inverse)


@pytest.mark.parametrize("linkage", LINKAGES.values(), ids=LINKAGES)
def test_working_strokes_are_those_of_the_laws(linkage: CrankSlider) -> None:
    family = family_of(linkage)
    strokes, _ = strokes_at(family, points_of(SHAPES))
    displacement, velocity, acceleration = (
        np.hstack(parts) for parts in zip(*working_motions(strokes, SEGMENT_POINTS), strict=True)
    )
    assert np.isfinite(sampled_laws(family, points_of(SHAPES)).power).all()
    for number, shape in enumerate(SHAPES):
        machine = Machine(made(shape, family).transmission, linkage, PRESS, OMEGA)
        theta2, theta3, theta4 = (getattr(strokes, f"theta{k}_rad")[number] for k in (2, 3, 4))
        out, steady, back = (shares(count) for count in SEGMENT_POINTS)
        phi1 = np.concatenate([theta2 * out, theta2 + (theta3 - theta2) * steady, theta4 - (theta4 - theta3) * back])
        # A joint belongs to what follows it, so the ends of each segment are left out; the second may have no length
        approach, pressing, _ = SEGMENT_POINTS
        ends = [0, *range(approach - 1, approach + pressing + 1), phi1.size - 1]
        kept = np.setdiff1d(np.arange(phi1.size), ends)
        exact = machine.displacement(phi1[kept], 2)
        assert np.max(np.abs(displacement[number, kept] - exact.value)) <= 1e-10 * linkage.stroke_mm
        scale = np.abs(acceleration).max()
        assert np.max(np.abs(velocity[number, kept] - exact.derivative(1))) <= 1e-9 * scale
        assert np.max(np.abs(acceleration[number, kept] - exact.derivative(2))) <= 1e-7 * scale


def returned(family: LawFamily, shape: Array, skewness: float) -> ReturnSamples:
    """Samples of the return of one shape."""
    strokes, found = strokes_at(family, points_of(shape[None], skewness))
    task = family.task
    asked = strokes, task.linkage, task.cycle_rad, found, RETURN_POINTS
    return return_samples(returns_with_skewness(*asked, inverse=family.inverse), task.linkage, RETURN_POINTS, 1)


@pytest.mark.tiers(
    thorough=["in line-*-True"],
    slow=["in line-lobes1-False", "offset-lobes1-False", "short rod-lobes1-False"],
    rest="long",
)
@pytest.mark.parametrize("inverse", [False, True])
@pytest.mark.parametrize("lobes", [Lobes(), Lobes(2, 1)])
@pytest.mark.parametrize("linkage", LINKAGES.values(), ids=LINKAGES)
def test_returns_are_those_of_the_laws(linkage: CrankSlider, lobes: Lobes, inverse: bool) -> None:
    """The law's own skewness is half the highest coefficient of its polynomial."""
    family = family_of(linkage, inverse=inverse, lobes=lobes)
    for shape in SHAPES[:2]:
        law = made(shape, family)
        ends = law.return_law.ends
        mean = ends.driven_length_rad / ends.length_rad if inverse else ends.length_rad / ends.driven_length_rad
        skewness = law.return_law.polynomial.coef[5] / 2.0 * BUMP_HEIGHT / mean
        found = returned(family, shape, skewness)
        assert found.slopes[0].min() > 0.0
        assert found.end_driven_rad[0] == pytest.approx(2.0 * pi, abs=1e-6)
        phi1 = ends.start_rad + ends.length_rad * shares(RETURN_POINTS.count)
        turned = law.transmission.pieces[-1].driven_angle(phi1, 2)
        exact = linkage.displacement(turned).derivative(2)
        assert np.max(np.abs(found.acceleration[0, 0] - exact)) <= 1e-6 * np.abs(exact).max()


def test_a_wrong_skewness_is_seen() -> None:
    """Negative control of the test above."""
    right, wrong = (returned(family_of(BALER_LINKAGE), SHAPES[0], skewness).acceleration for skewness in (0.1, 0.1001))
    assert np.max(np.abs(right - wrong)) > 1e-6 * np.abs(right).max()


def baler_point() -> Array:
    """The published baler in the unit box: a1 at 20 r/min, v1 : v2 = 1600 : 1100, and no skewness."""
    speed, delta = 52.8085 * pi / 30.0, 0.3 * pi
    brake = 1500.0 / (20.0 * pi / 30.0) ** 2 * delta / (1100.0 / speed)

    def ratio(chi: float) -> float:
        point = points_of(np.array([[0.65, 1.0 / 1.3, 0.7, 0.4 / 0.7, chi, brake]]))
        strokes, _ = strokes_at(family_of(BALER_LINKAGE), point)
        return float(strokes.v1[0] / strokes.v2[0])

    chi = brentq(lambda angle: ratio(angle) - 16.0 / 11.0, 0.0, 1.5)
    point: Array = points_of(np.array([[0.65, 1.0 / 1.3, 0.7, 0.4 / 0.7, chi, brake]]))[0]
    return point


def test_the_published_baler_is_a_member() -> None:
    """6315 W and 1500 mm/s^2 in the working stroke at 20 r/min, its headline figures."""
    found = sampled_laws(LawFamily(Task(BALER_LINKAGE, PRESS, 20.0 * pi / 30.0)), baler_point()[None])
    assert found.power.max() == pytest.approx(6315.1, rel=1e-3)  # between samples
    assert np.abs(found.acceleration[:, : sum(SEGMENT_POINTS)]).max() == pytest.approx(
        1500.0, rel=1e-4
    )  # 52.8085, rounded


def test_shapes_that_turn_back_are_no_laws() -> None:
    random = np.random.default_rng(4)
    points = random.random((400, 7))
    family = family_of(BALER_LINKAGE, inverse=False)
    found = sampled_laws(family, points)
    possible = np.isfinite(found.power[:, 0])
    assert 0.3 < possible.mean() < 0.95
    strokes, _ = strokes_at(family, points)
    approach = working_motions(strokes, SEGMENT_POINTS)[0]
    for point in points[approach.velocity.min(axis=1) < 0.0][:10]:
        with pytest.raises(NoSuchMechanism):
            solved_stroke(request_at(family, point))


@cache
def best(cap_w: float, *, inverse: bool, seed: int = 1) -> FamilyOptimum:
    """The least acceleration on the baler's linkage at 60 r/min."""
    family = family_of(BALER_LINKAGE, inverse=inverse)
    return best_of_family(family, PeakGoal.ACCELERATION, cap_w, seed=seed, starts=16)


@pytest.mark.long
@pytest.mark.slow
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
    assert optimum.peak(PeakGoal.POWER) <= cap_w * (1.0 + 1e-6)
    assert optimum.peak(PeakGoal.ACCELERATION) <= at_most
    assert abs(optimum.law.transmission.closure_error_rad) <= 1e-12


@pytest.mark.slow
def test_the_same_seed_gives_the_same_law() -> None:
    again = best_of_family(family_of(BALER_LINKAGE), PeakGoal.ACCELERATION, 18750.0, starts=16)
    assert again.request == best(18750.0, inverse=True).request


@pytest.mark.slow
def test_the_request_makes_the_law_again() -> None:
    """As a design file would, with v2 to be found."""
    optimum = best(18750.0, inverse=True)
    again = stroke_law(solved_stroke(replace(optimum.request)), BALER_LINKAGE, Lobes(), inverse_basis=True)
    phi1 = np.linspace(0.0, 2.0 * pi, 50)
    exact = optimum.law.transmission.driven_angle(phi1).value
    assert np.array_equal(again.transmission.driven_angle(phi1).value, exact)


@pytest.mark.long
@pytest.mark.slow
def test_least_power_under_the_acceleration_found_is_the_power_cap() -> None:
    """Both ways of asking lead to the same frontier."""
    optimum = best(12000.0, inverse=True)
    cap = optimum.peak(PeakGoal.ACCELERATION)
    other = best_of_family(family_of(BALER_LINKAGE), PeakGoal.POWER, cap, starts=16)
    assert other.peak(PeakGoal.ACCELERATION) <= cap * (1.0 + 1e-6)
    assert other.peak(PeakGoal.POWER) == pytest.approx(12000.0, rel=0.02)


@pytest.mark.tiers(slow=["offset"], rest="long")
@pytest.mark.parametrize("linkage", LINKAGES.values(), ids=LINKAGES)
def test_without_resistance_any_cap_is_kept(linkage: CrankSlider) -> None:
    family = LawFamily(Task(linkage, SliderLoad(), OMEGA), inverse=True)
    optimum = best_of_family(family, PeakGoal.ACCELERATION, 1.0, starts=6)
    assert optimum.peak(PeakGoal.POWER) == 0.0
    without = best_of_family(family, PeakGoal.ACCELERATION, inf, starts=6)
    assert without.peak(PeakGoal.ACCELERATION) == pytest.approx(optimum.peak(PeakGoal.ACCELERATION), rel=0.01)


@pytest.mark.slow
@pytest.mark.long
def test_a_cap_out_of_reach_is_refused_with_what_is_in_reach() -> None:
    """The work of a stroke in a whole cycle is a power no law goes below."""
    mean_w = PRESS.cycle_work_n_mm(760.0) / 1000.0
    with pytest.raises(NoSuchMechanism, match=r"power of \d+ or less; the least found is (\d+)") as caught:
        best_of_family(family_of(BALER_LINKAGE), PeakGoal.ACCELERATION, float(round(mean_w)), starts=4)
    assert float(caught.value.problem.split()[-1]) > mean_w
