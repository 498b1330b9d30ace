"""Laws by a spline of ln i12, against SciPy's splines with quadrature in 30 digits, harmonics, and their own joints."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import replace
from itertools import pairwise
from math import exp, inf, log, nan, pi
from typing import Any

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from mpmath import mp, mpf
from scipy.interpolate import CubicSpline, PchipInterpolator

from at_once import at_once
from ncgear.design.laws.spline_ratio import SplineRatio
from ncgear.errors import DesignError, NoSuchMechanism, WrongInput
from ncgear.numerics.arrays import Array
from ncgear.numerics.jet import Jet
from ncgear.numerics.periodic_cubic import PeriodicCubic, periodic_cubic
from ncgear.pitch.pair import sized_pair
from ncgear.pitch.shape import Gear
from ncgear.project.opened import loads
from ncgear.ratio.laws.harmonic import harmonic_law
from ncgear.ratio.laws.over_driven_angle import LogRatioLaw
from ncgear.ratio.laws.spline import closed_spline, even_steps, spline_ratio_law, spline_ratio_staged
from ncgear.ratio.transmission import Lobes, Transmission
from ncgear.teeth.flank import Flanks
from ncgear.teeth.form import ToothForm
from ncgear.teeth.gear import toothed_pair
from pairs import one_of, rack

DIGITS = 30


def wave(angle: Array) -> Array:
    """An even enough ln i12, its slope at most 1.14."""
    return 0.6 * np.cos(angle) + 0.3 * np.sin(2.0 * angle + 1.0)


def with_pair(gap_rad: float) -> Array:
    """Sixty even steps, with two more knots that are so near to each other."""
    return np.sort(np.concatenate([even_steps(60), [1.0, 1.0 + gap_rad]]))


UNEVEN = np.array([0.0, 0.3, 0.35, 1.2, 2.0, 3.1, 3.15, 3.2, 4.4, 6.2])

CASES: dict[str, tuple[Array, Array, Lobes]] = {
    "even": (even_steps(36), wave(even_steps(36)), Lobes()),
    "uneven": (UNEVEN, wave(UNEVEN), Lobes()),
    "two 1e-6 rad apart": (with_pair(1e-6), wave(with_pair(1e-6)), Lobes()),
    "lobes 2:3": (even_steps(12), 0.2 * wave(even_steps(12)), Lobes(2, 3)),
    "four, range of 1:3000": (even_steps(4), np.array([4.0, 0.0, -4.0, 0.5]), Lobes()),
}
"""Driven angles in rad, ln i12 there, lobes."""


def law(name: str) -> Transmission:
    angles, values, lobes = CASES[name]
    return spline_ratio_law(angles, np.exp(values), lobes)


class Exact:
    """The law of SciPy's spline through the same points: its cubics exponentiated and integrated in 30 digits."""

    def __init__(self, angles: Array, values: Array, lobes: Lobes) -> None:
        self.lobes = lobes
        closed = CubicSpline(np.append(angles, 2.0 * pi), np.append(values, values[0]), bc_type="periodic")
        self.knots = [*map(mpf, angles.tolist()), 2 * mp.pi]
        self.cubics = [list(map(mpf, column)) for column in closed.c.T.tolist()]
        self.before = [mpf(0)]
        for k, (low, high) in enumerate(pairwise(self.knots)):
            self.before.append(self.before[-1] + self.quadrature(k, high - low))
        self.mean = self.before[-1] / (2 * mp.pi)

    def quadrature(self, cell: int, beyond: mpf) -> mpf:
        """Integral of the exponential from a knot on; 30 digits on parts that are short against a change of e."""
        return mp.quad(lambda x: mp.exp(mp.polyval(self.cubics[cell], x)), mp.linspace(0, beyond, 9))

    def at(self, cell: int, share: float) -> tuple[float, mpf, list[mpf]]:
        """phi1, and phi2 with derivatives by phi1 up to the third, at a share of a cell."""
        beyond = mpf(share) * (self.knots[cell + 1] - self.knots[cell])
        turned = self.knots[cell] + beyond
        phi1 = (self.before[cell] + self.quadrature(cell, beyond)) / self.mean / self.lobes.driving
        cubic = self.cubics[cell]
        slope = 3 * cubic[0] * beyond**2 + 2 * cubic[1] * beyond + cubic[2]
        bend = 6 * cubic[0] * beyond + 2 * cubic[1]
        speed = self.mean * mp.exp(-mp.polyval(cubic, beyond))
        # With w = exp(-f) by t: w' = -f' w and w'' = (f'^2 - f'') w
        by_x = [speed, -slope * speed**2, speed**3 * (2 * slope**2 - bend)]
        n1, n2 = self.lobes.driving, self.lobes.driven
        return float(phi1), turned / n2, [value * n1 ** (k + 1) / mpf(n2) for k, value in enumerate(by_x)]


# --- the law against other programs and closed forms --------------------------------------------------------------


@pytest.mark.judges("ratio")
@pytest.mark.tiers(quick=["lobes*"], slow=["two 1e-6 rad apart"], rest="long")
@pytest.mark.parametrize("name", CASES)
def test_against_thirty_digits(name: str) -> None:
    transmission = law(name)
    with mp.workdps(DIGITS):
        exact = Exact(*CASES[name])
        for cell in range(0, len(exact.cubics), 1 + len(exact.cubics) // 12):
            phi1, phi2, derivatives = exact.at(cell, 0.37)
            found = transmission.driven_angle(np.array([phi1]), 3)
            # Rounding of the driving angle, and of the sums of at most 62 cells, each on the slope's scale
            assert abs(found.value[0] - phi2) <= 4e-15 * (1 + derivatives[0])
            scale = (1 + derivatives[0]) * max(map(abs, derivatives))
            # f'' is made of chords: it has the rounding of ln i12 over h^2, of steps down to 0.05 rad
            for k, bound in ((1, 4e-15), (2, 4e-15), (3, 1e-13)):
                assert abs(found.derivative(k)[0] - derivatives[k - 1]) <= bound * scale, (cell, k)


@pytest.mark.slow
def test_the_reference_sees_a_point_that_is_moved_by_a_millionth() -> None:
    """Negative control."""
    angles, values, lobes = CASES["lobes 2:3"]
    moved = values + 1e-6 * (np.arange(values.size) == 5)
    transmission = spline_ratio_law(angles, np.exp(moved), lobes)
    with mp.workdps(DIGITS):
        phi1, phi2, _ = Exact(angles, values, lobes).at(5, 0.37)
        assert abs(transmission.driven_angle(np.array([phi1])).value[0] - phi2) > 1e-8


@at_once("name", CASES)
def test_the_law_closes_and_its_factor_is_of_no_account(name: str) -> None:
    angles, values, lobes = CASES[name]
    transmission = law(name)
    assert abs(transmission.closure_error_rad) <= 1e-12
    phi1 = np.linspace(0.0, lobes.driving_period_rad, 57)
    exact = transmission.driven_angle(phi1, 3)
    nearest, usual = np.diff(angles).min(), np.diff(angles).mean()
    for factor in (1e-3, 3.0, 1e3):
        found = spline_ratio_law(angles, np.exp(values) * factor, lobes).driven_angle(phi1, 2)
        # Logarithms of up to 11 have roundings of 4e-15 together.  Over the nearest knots' distance they turn a chord;
        # 3 / h times that turn is what f'' is off between steps of h on both sides, and f' and f are by h and h^2 of it
        bend = 3.0 * 4e-15 / (nearest * usual)
        bound = 4e-15 + bend * usual ** np.array([[3.0], [2.0], [1.0]])
        scale = np.abs(exact.coefficients[1]).max() * np.abs(exact.coefficients[:3]).max(axis=1, keepdims=True)
        assert np.all(np.abs(found.coefficients - exact.coefficients[:3]) <= bound * np.maximum(scale, 1.0))


def test_equal_ratios_are_the_uniform_law() -> None:
    phi1 = np.linspace(0.0, pi, 57)[:-1]
    found = spline_ratio_law(UNEVEN, np.full(UNEVEN.size, 7.0), Lobes(2, 3)).driven_angle(phi1, 3)
    assert np.max(np.abs(found.value - phi1 * 2.0 / 3.0)) <= 2e-15
    assert np.max(np.abs(found.coefficients[1] - 2.0 / 3.0)) <= 2e-15
    assert not found.coefficients[2:].any()


COSINE, SINE = np.array([-0.8, 0.2, 0.1, -0.05]), np.array([0.4, 0.0, 0.1, 0.02])


def test_dense_splines_come_to_the_harmonic_law_by_the_fourth_power() -> None:
    """The driven angle by h^4, d2phi2/dphi1^2 (of f') by h^3, the third derivative (of f'') by h^2."""
    exact = harmonic_law(COSINE, SINE, Lobes())
    phi1 = np.linspace(0.0, 2.0 * pi, 4001)
    wanted, counts, errors = exact.driven_angle(phi1, 3), (60, 120, 240, 480), []
    waves = np.arange(1, COSINE.size + 1)[:, None]
    for count in counts:
        angles = even_steps(count)
        ratio = np.exp(COSINE @ np.cos(waves * angles) + SINE @ np.sin(waves * angles))
        found = spline_ratio_law(angles, ratio, Lobes()).driven_angle(phi1, 3)
        errors.append(np.abs(found.coefficients - wanted.coefficients).max(axis=1))
    rates = -np.polyfit(np.log(counts), np.log(errors), 1)[0]
    assert rates == pytest.approx([4.0, 4.0, 3.0, 2.0], abs=0.15)
    assert errors[-1][0] <= 1e-7


STEEP = [(1.0, 0.0), (0.87, 0.5), (0.25, 0.15), (0.5, 0.75), (0.07, -1.4), (0.0375, 0.3), (0.95, 0.7), (0.63, 1.3)]
"""Points whose spline goes over 1:40 000, with most of the driven angle in a hundredth of a turn before its end."""


@pytest.mark.slow
@settings(max_examples=40, deadline=None)
@given(
    st.lists(st.tuples(st.floats(0.02, 1.0), st.floats(-1.5, 1.5)), min_size=4, max_size=30),
    st.sampled_from([Lobes(), Lobes(2, 1), Lobes(1, 2), Lobes(3, 2)]),
)
@example([*STEEP, (1.0, 0.3), (0.78, 0.125), (0.28, 0.0), (0.5, 0.0), (0.5, 0.625), (1.0, 0.0), (0.34, 0.0)], Lobes())
def test_any_points_give_a_closed_law_or_a_refusal(points: list[tuple[float, float]], lobes: Lobes) -> None:
    steps, values = np.array(points).T
    angles = 2.0 * pi * (np.cumsum(steps) - steps[0]) / (steps.sum() - steps[0] + 0.3)
    try:
        transmission = spline_ratio_law(angles, np.exp(values), lobes)
    except DesignError:
        return
    # At every joint the last digit of its driving angle, times the speed of the driven gear there
    speeds = transmission.driven_angle(transmission.joints_rad[:-1], 1).derivative(1)
    assert abs(transmission.closure_error_rad) <= 1e-12 + 2.0 * pi * 2.2e-16 * speeds.sum()
    dense = transmission.driven_angle(np.linspace(0.0, lobes.driving_period_rad, 20_001), 1).derivative(1)
    low, high = (end.value for end in transmission.slope_range)
    assert low * (1.0 - 1e-9) <= dense.min() <= dense.max() <= high * (1.0 + 1e-9)


# --- the spline itself --------------------------------------------------------------------------------------------


@pytest.mark.judges("numerics")
@at_once("count", [3, 4, 7, 180, 2000])
def test_the_spline_is_scipys(count: int) -> None:
    random = np.random.default_rng(count)
    angles = 2.0 * pi / count * (np.arange(count) + 0.4 * np.concatenate([[0.0], random.uniform(-1, 1, count - 1)]))
    values = random.normal(size=count)
    wanted = CubicSpline(np.append(angles, 2.0 * pi), np.append(values, values[0]), bc_type="periodic")
    spline, at = periodic_cubic(angles, values), random.uniform(0.0, 2.0 * pi, 3000)
    found = spline.at(at, 3)
    for order in range(4):
        scale = np.abs(wanted(at, order)).max()
        assert np.max(np.abs(found.derivative(order) - wanted(at, order))) <= 1e-12 * scale
    places = np.linspace(0.0, 2.0 * pi, 200_001)
    dense, bend = wanted(places), float(np.abs(wanted(places, 2)).max())
    low, high = spline.extremes
    # Half a step off a top
    assert (low.value, high.value) == pytest.approx((dense.min(), dense.max()), abs=bend * places[1] ** 2 / 8.0)
    assert low.value <= dense.min() + 1e-14
    assert high.value >= dense.max() - 1e-14
    assert [float(wanted(end.at)) for end in (low, high)] == pytest.approx([low.value, high.value], abs=1e-12)


@at_once("knots", [[0.1, 1.0, 2.0], [0.0, 2.0, 1.0], [0.0, 1.0, 7.0], [0.0, 1.0], [0.0, 1.0, 1.0]])
def test_knots_that_do_not_rise_within_a_turn_are_a_fault(knots: list[float]) -> None:
    with pytest.raises(ValueError, match="rise"):
        periodic_cubic(np.array(knots), np.zeros(len(knots)))


@pytest.mark.slow
def test_the_integral_of_a_steep_exponential_is_that_of_thirty_digits() -> None:
    """Between two points the function changes ten thousandfold, so cells are halved there."""
    spline = periodic_cubic(even_steps(4), np.array([4.5, 0.0, -4.5, 0.5]))
    integral = spline.exponential_integral()
    assert integral.nodes.size > 100
    with mp.workdps(DIGITS):
        cubics = [list(map(mpf, column[::-1])) for column in spline.coefficients.T.tolist()]
        ends = [mpf(knot) for knot in spline.knots.tolist()]
        parts = [
            mp.quad(lambda x, cubic=cubic: mp.exp(mp.polyval(cubic, x)), mp.linspace(0, high - low, 17))
            for cubic, (low, high) in zip(cubics, pairwise(ends), strict=True)
        ]
        assert integral.mean == pytest.approx(float(mp.fsum(parts) / (2 * mp.pi)), rel=1e-14)
        shares = [float(2 * mp.pi * mp.fsum(parts[:k]) / mp.fsum(parts)) for k in (1, 2, 3)]
    assert integral.at(even_steps(4)[1:]) == pytest.approx(shares, rel=1e-14)
    values = np.concatenate([[0.0, 1e-12, 1e-9], np.linspace(0.0, 2.0 * pi, 999)])
    there = integral.at(integral.inverse(values))
    assert np.max(np.abs(there - values)) <= 4e-15
    assert np.max(np.abs(there[1:3] / values[1:3] - 1.0)) <= 1e-14


# --- joints -------------------------------------------------------------------------------------------------------


def sides(transmission: Transmission, gear: Gear, apart_rad: float) -> tuple[Array, Array]:
    """Curvature times centre distance of a pitch curve just before and just after each joint, shape (m,) each."""
    curve, joints = one_of(sized_pair(transmission, 25, None, 200.0), gear), transmission.joints_rad[1:-1]
    before, after = (curve.at_angle(joints + step).curvature * 200.0 for step in (-apart_rad, apart_rad))
    return before, after


def unsmooth(angles: Array, values: Array) -> LogRatioLaw:
    """The law of cubics through the same points whose second derivative jumps, by SciPy's pchip."""
    around = np.concatenate([angles[-2:] - 2.0 * pi, angles, 2.0 * pi + angles[:3]])
    cubics = PchipInterpolator(around, np.concatenate([values[-2:], values, values[:3]])).c[::-1, 2:-2]
    spline = PeriodicCubic(np.append(angles, 2.0 * pi), cubics)
    return replace(
        closed_spline(angles, np.exp(values), Lobes()), series=spline, integral=spline.exponential_integral()
    )


@pytest.mark.judges("pitch")
@at_once("gear", list(Gear))
@at_once("name", ["even", "uneven", "two 1e-6 rad apart"])
def test_the_curvature_of_both_pitch_curves_goes_on_at_every_knot(name: str, gear: Gear) -> None:
    apart = 1e-9
    transmission = law(name)
    before, after = sides(transmission, gear, apart)
    # The curvature's own slope, at most 200 here, over both steps, and rounding of f'' of knots 1e-6 apart
    assert np.max(np.abs(after - before)) <= 200.0 * 2.0 * apart + 1e-9
    angles, values, _ = CASES[name]
    rough = unsmooth(angles, values)
    before, after = sides(rough.transmission, gear, apart)
    assert np.max(np.abs(after - before)) > 1e-2


@at_once("name", CASES)
def test_knots_are_joints_and_are_where_the_third_derivative_jumps(name: str) -> None:
    angles, _, lobes = CASES[name]
    transmission = law(name)
    joints = transmission.joints_rad
    there = transmission.driven_angle(joints[:-1]).value * lobes.driven
    distance = np.abs(there[:, None] - angles).min(axis=0)
    assert np.max(distance) <= 1e-14 * transmission.slope_range[1].value
    # Nothing changes by more than a factor of e between two joints
    ratio = 1.0 / transmission.driven_angle(joints, 1).derivative(1)
    assert np.max(np.abs(np.diff(np.log(ratio)))) <= 1.0
    if np.diff(angles).max() < 1.0:
        assert joints.size == angles.size + 1


def test_a_steep_law_has_more_joints_than_knots() -> None:
    assert law("four, range of 1:3000").joints_rad.size > 9


# --- two pairs ----------------------------------------------------------------------------------------------------


def test_two_pairs_in_series_are_the_whole() -> None:
    angles = even_steps(36)
    train = spline_ratio_staged(angles, np.exp(wave(angles)), np.exp(0.4 * wave(angles + 0.3))).train
    first, second = (pair.transmission for pair in train.pairs)
    phi1 = np.linspace(-7.0, 20.0, 400)
    shaft, whole = first.driven_angle(phi1, 2), train.whole.driven_angle(phi1, 2)
    crank = second.driven_angle(shaft.value, 2)
    assert np.max(np.abs(crank.value - whole.value)) <= 1e-13
    assert np.max(np.abs(crank.derivative(1) * shaft.derivative(1) - whole.derivative(1))) <= 1e-12
    bend = crank.derivative(2) * shaft.derivative(1) ** 2 + crank.derivative(1) * shaft.derivative(2)
    assert np.max(np.abs(bend - whole.derivative(2))) <= 1e-11
    for transmission in (first, second, train.whole):
        assert abs(transmission.closure_error_rad) <= 1e-13
        assert transmission.joints_rad.size == 37
    alone = spline_ratio_law(angles, np.exp(0.4 * wave(angles + 0.3)), Lobes())
    assert np.array_equal(alone.driven_angle(phi1, 3).coefficients, second.driven_angle(phi1, 3).coefficients)


# --- refusals -----------------------------------------------------------------------------------------------------


def refused(work: Callable[[], Any], kind: type[DesignError]) -> DesignError:
    with pytest.raises(kind) as caught:
        work()
    return caught.value


@at_once("value", [0.0, -1.0, nan, inf])
def test_what_is_no_positive_number_is_wrong_input(value: float) -> None:
    ratio, good = np.array([1.0, 1.1, value, 1.2]), np.array([1.0, 1.1, 1.3, 1.2])
    found = refused(lambda: spline_ratio_law(even_steps(4), ratio, Lobes()), WrongInput)
    assert (found.key, found.problem) == ("motion.ratio.2", f"{value:g} given; a positive number is needed")
    assert refused(lambda: spline_ratio_staged(even_steps(4), good, ratio), WrongInput).key == (
        "motion.second_stage.ratio.2"
    )


def test_a_range_beyond_sense_is_refused_at_the_point_that_has_it() -> None:
    values = np.array([0.0, 1.0, 14.0, 1.0, 0.0, 0.5])
    found = refused(lambda: spline_ratio_law(even_steps(6), np.exp(values), Lobes()), NoSuchMechanism)
    assert found.key == "motion.ratio.2"
    assert "over 1:1e6 the driven gear stands still: bring the ratios nearer" in found.problem
    assert "2.0" in found.problem  # rad, near 120 deg
    assert spline_ratio_law(even_steps(6), np.exp(0.85 * values), Lobes()).ratio_range


def test_a_spline_that_swings_beyond_its_points_is_told_apart() -> None:
    """Two points 1e-3 rad apart whose ratios differ by half: the slope between them is carried on by the spline."""
    angles = np.sort(np.append(even_steps(8), 1e-3))
    values = np.where(angles == 1e-3, 0.4, 0.0)
    found = refused(lambda: spline_ratio_law(angles, np.exp(values), Lobes()), NoSuchMechanism)
    assert "the points themselves span only 1:1.492" in found.problem
    wanted = CubicSpline(np.append(angles, 2.0 * pi), np.append(values, values[0]), bc_type="periodic")
    dense = np.linspace(0.0, 2.0 * pi, 100_001)
    span = np.ptp(wanted(dense)) / log(10.0)
    assert f"a range of 1:1e{span:.4g};" in found.problem


def told(motion: dict[str, Any]) -> tuple[str, str]:
    """Key and words of the refusal of a design with this motion."""
    text = "{name: own, linkage: {crank_mm: 40, rod_mm: 90}, operation: {speed_rpm: 30}, motion: %s}"
    found = refused(lambda: loads(text % json.dumps({"law": "spline_ratio", **motion})), WrongInput)
    return found.key, found.problem


ROUND = [1.0, 1.1, 1.2, 1.1]


@at_once(
    ("motion", "key", "said"),
    [
        ({"ratio": [1.0, 1.1, -0.5, 1.2]}, "motion.ratio.2", "a number over 0 is needed"),
        ({"ratio": [1.0, 1.1, 0.5]}, "motion.ratio", "4"),
        ({"driven_angle_deg": [0, 90, 80, 270]}, "motion.driven_angle_deg.2", "80 follows 90; the angles must rise"),
        ({"driven_angle_deg": [0, 90, 180, 360]}, "motion.driven_angle_deg.3", "under 360 is right"),
        ({"driven_angle_pi": [0, 0.5, 2.5, 2.7]}, "motion.driven_angle_pi.2", "under 2 is right"),
        ({"driven_angle_rad": [0.1, 1, 2, 3]}, "motion.driven_angle_rad.0", "0 is right"),
        ({"driven_angle_rad": [0, 1, 1.0000001, 3]}, "motion.driven_angle_rad.2", "at least 6.3e-07 apart"),
        ({"driven_angle_deg": [0, 90, 180]}, "motion.driven_angle_deg", "4"),
        ({"driven_angle_deg": [0, 9, 18, 27, 36]}, "motion.driven_angle_deg", "5 values, but ratio has 4"),
        (
            {"driven_angle_deg": [0, 1, 2, 3], "driven_angle_pi": [0, 0.1, 1, 1.1]},
            "motion.driven_angle_pi",
            "keep one",
        ),
        ({"second_stage": {"ratio": [1, 2, 1, 2, 1]}}, "motion.second_stage.ratio", "5 values, but ratio has 4"),
        ({"second_stage": {"ratio": [1, 0, 1, 2]}}, "motion.second_stage.ratio.1", "a number over 0 is needed"),
    ],
)
def test_a_file_is_refused_at_its_key(motion: dict[str, Any], key: str, said: str) -> None:
    found, problem = told({"ratio": ROUND, **motion})
    assert found == key
    assert said in problem


def test_angles_that_are_left_out_are_even_steps_and_spellings_agree() -> None:
    ratio = (1.0, 1.1, 1.3, 1.2)
    given = [
        SplineRatio(law="spline_ratio", ratio=ratio),
        SplineRatio(law="spline_ratio", ratio=ratio, driven_angle_deg=(0.0, 90.0, 180.0, 270.0)),
        SplineRatio(law="spline_ratio", ratio=ratio, driven_angle_pi=(0.0, 0.5, 1.0, 1.5)),
        SplineRatio(law="spline_ratio", ratio=ratio, driven_angle_rad=(0.0, pi / 2, pi, 3 * pi / 2)),
    ]
    for one in given:
        assert one.driven_angle == pytest.approx(even_steps(4), abs=1e-15)


@pytest.mark.parametrize("count", [36, 180, 720])
def test_even_steps_of_a_file_are_those_of_the_search_bit_for_bit(count: int) -> None:
    assert SplineRatio(law="spline_ratio", ratio=(1.0,) * count).driven_angle == tuple(even_steps(count))


def test_a_gentler_law_has_a_share_of_the_logarithm() -> None:
    keys = SplineRatio(law="spline_ratio", ratio=(1.0, 1.1, 1.3, 0.8))
    assert np.log(keys.gentler(0.25, "phi")["ratio"]) == pytest.approx(0.25 * np.log(keys.ratio), abs=1e-16)
    assert keys.gentler(1.0, "phi")["ratio"] == keys.ratio
    staged = SplineRatio(law="spline_ratio", ratio=keys.ratio, second_stage={"ratio": keys.ratio})
    assert staged.gentler(0.25, "phi") == {}


# --- how quick it is ----------------------------------------------------------------------------------------------


def test_a_law_of_many_knots_is_made_from_few_places(monkeypatch: pytest.MonkeyPatch) -> None:
    """With the range of its ratio: all places at once, some more about its extremes, and none knot by knot."""
    looked, plain = [], LogRatioLaw.driven_angle

    def counted(law: LogRatioLaw, phi1: Array, order: int) -> Jet:
        looked.append(phi1.size)
        return plain(law, phi1, order)

    monkeypatch.setattr(LogRatioLaw, "driven_angle", counted)
    angles = even_steps(720)
    transmission = spline_ratio_law(angles, np.exp(wave(angles)), Lobes())
    assert transmission.ratio_range[0].value < transmission.ratio_range[1].value
    assert 0 < len(looked) <= 30
    assert sum(looked) <= 8 * angles.size


@pytest.mark.slow
def test_cusps_of_many_knots_are_sought_between_the_knots(monkeypatch: pytest.MonkeyPatch) -> None:
    """The curvature has a corner at each knot, and a form that knew of none would close in on all of them.

    Without the knots 900 points a knot were looked at here.
    """
    looked, plain = [], Flanks.regularity

    def counted(flanks: Flanks, flank: Any, height_mm: Array) -> Array:
        looked.append(height_mm.size)
        return plain(flanks, flank, height_mm)

    monkeypatch.setattr(Flanks, "regularity", counted)
    angles = even_steps(180)
    transmission = spline_ratio_law(angles, np.exp(0.8 * wave(angles)), Lobes())
    toothed_pair(sized_pair(transmission, 25, 3.0, None), ToothForm(rack(module=3.0)), 0.005)
    assert 0 < sum(looked) <= 300 * angles.size


def test_the_ratio_at_a_knot_is_the_one_given() -> None:
    """Up to the common factor, read from the law's own driven angle."""
    angles, values, _ = CASES["uneven"]
    made = closed_spline(angles, np.exp(values), Lobes())
    phi1 = np.concatenate([[0.0], made.integral.at(angles[1:])])
    ratio = 1.0 / made.transmission.driven_angle(phi1, 1).derivative(1)
    share = ratio / np.exp(values)
    assert share == pytest.approx(np.full(angles.size, share[0]), rel=1e-13)
    assert share[0] != pytest.approx(1.0, rel=1e-3)
    assert exp(-0.1) < share[0] * made.integral.mean / np.exp((values.max() + values.min()) / -2.0) < exp(0.1)
