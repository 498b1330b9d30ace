"""Every law keeps the same contract; then each against its own closed form, and its refusals."""

from __future__ import annotations

import itertools
import re
from collections.abc import Callable
from dataclasses import replace
from functools import cache, partial
from math import exp, nan, pi, radians, sqrt
from re import search

import numpy as np
import pytest
from mpmath import mp
from numpy.polynomial import chebyshev, legendre

from at_once import at_once
from ncgear.errors import DesignError, NoSuchMechanism, WrongInput
from ncgear.mechanisms.crank_slider import CrankSlider
from ncgear.numerics.arrays import Array
from ncgear.numerics.jet import Jet
from ncgear.ratio.laws.ellipse import elliptical_law
from ncgear.ratio.laws.expression import driven_angle_expression_law, ratio_expression_law
from ncgear.ratio.laws.harmonic import harmonic_law
from ncgear.ratio.laws.spline import spline_ratio_law
from ncgear.ratio.laws.table import displacement_table_law, ratio_table_law
from ncgear.ratio.laws.three_segment import stroke_law
from ncgear.ratio.laws.uniform import uniform_law
from ncgear.ratio.transmission import Lobes, Piece, Transmission
from ncgear.ratio.working_stroke import StrokeRequest, solved_stroke
from oracles import stroke as oracle
from published import BALER_LINKAGE, OFFSET
from test_stroke import AT_LAW_SPEED, BALER

SMALL = CrankSlider(50.0, 200.0, -10.0)


def test_a_driven_angle_that_passes_a_bump_of_its_ratio_by_does_not_close() -> None:
    """The negative control of the residual: at the period's end the driven angle itself is exact."""

    def blind(phi1: Array, order: int) -> Jet:
        slope = 1.0 + 0.2 * np.exp(-(((phi1 - 3.3) / 0.05) ** 2))
        return Jet(np.stack([phi1, slope, *[0.0 * phi1] * max(order - 1, 0)])[: order + 1])

    law = Transmission((Piece(0.0, 2.0 * pi, blind),), Lobes())
    assert law.closure_error_rad == pytest.approx(0.2 * 0.05 * sqrt(pi), rel=1e-4)


def stroke_of(
    request: StrokeRequest, linkage: CrankSlider, lobes: Lobes, constant: float | None = None, inverse: bool = False
) -> Transmission:
    """The three-segment law of a request on a linkage."""
    stroke = solved_stroke(replace(request, stroke_mm=linkage.stroke_mm))
    return stroke_law(stroke, linkage, lobes, constant=constant, inverse_basis=inverse).transmission


def doubled_lobes() -> StrokeRequest:
    """The baler's law in half the driving angle: half the law speed, and a1's own speed halved too."""
    angles = {f"theta{k}_rad": getattr(BALER, f"theta{k}_rad") / 2.0 for k in range(1, 5)}
    return replace(BALER, **angles, a1_speed_rad_s=BALER.a1_speed_rad_s / 2.0)


def table_of(source: Transmission, linkage: CrankSlider, each_stroke: int) -> tuple[Array, Array]:
    """Points of a known law: even in driving angle within each stroke, the extended end among them."""
    phi1 = np.linspace(0.0, 2.0 * pi, 20001)
    extended = np.interp(linkage.working_angle_rad, source.driven_angle(phi1).value, phi1)
    for _ in range(3):
        series = source.driven_angle(np.array([extended]), 1)
        extended -= float((series.value[0] - linkage.working_angle_rad) / series.derivative(1)[0])
    halves = np.linspace(0.0, extended, each_stroke + 1), np.linspace(extended, 2.0 * pi, each_stroke + 1)[1:-1]
    points = np.concatenate(halves)
    exact = oracle.Linkage(linkage.crank_mm, linkage.rod_mm, linkage.offset_mm)
    with mp.workdps(30):
        driven = source.driven_angle(points).value.tolist()
        return points, np.array([float(exact.displacement(mp.mpf(angle))) for angle in driven])


ELLIPSE = partial(elliptical_law, 0.3, 0.9, Lobes())


def doubled_table() -> Transmission:
    """The same table in half the driving angle, for two lobes."""
    phi1, displacement = table_of(ELLIPSE(), SMALL, 12)
    return displacement_table_law(phi1 / 2.0, displacement, SMALL, Lobes(2, 1))


def displacement_table(each_stroke: int) -> Transmission:
    """An elliptical law by its displacements."""
    return displacement_table_law(*table_of(ELLIPSE(), SMALL, each_stroke), SMALL, Lobes())


def ratio_table(count: int, lobes: Lobes | None = None) -> Transmission:
    """A ratio of 1 + 0.3 cos x, times what closes it, by points."""
    lobes = lobes or Lobes()
    phi1 = np.linspace(0.0, lobes.driving_period_rad, count, endpoint=False)
    return ratio_table_law(phi1, 1.0 + 0.3 * np.cos(lobes.driving * phi1), lobes, scale_to_close=True)


def spline_of(count: int, lobes: Lobes | None = None) -> Transmission:
    """A spline through points of a wave at uneven driven angles."""
    angles = 2.0 * pi / count * (np.arange(count) + 0.4 * np.sin(np.arange(count)))
    ratio = np.exp(0.15 * np.cos(angles) + 0.05 * np.sin(2.0 * angles))
    return spline_ratio_law(angles, ratio, lobes or Lobes())


LAWS: dict[str, Callable[[], Transmission]] = {
    "uniform": lambda: uniform_law(Lobes()),
    "uniform 2:1": lambda: uniform_law(Lobes(2, 1)),
    "uniform 2:3": lambda: uniform_law(Lobes(2, 3)),
    "ellipse, circular": lambda: elliptical_law(0.0, 0.0, Lobes()),
    "ellipse 0.35": lambda: elliptical_law(0.35, radians(200.0), Lobes()),
    "ellipse 0.8": lambda: elliptical_law(0.8, -2.0, Lobes()),
    "ellipse 1:2": lambda: elliptical_law(0.3, 1.0, Lobes(1, 2)),
    "ellipse 2:3": lambda: elliptical_law(0.15, 0.4, Lobes(2, 3)),
    "ellipse 3:1": lambda: elliptical_law(0.05, 0.0, Lobes(3, 1)),
    "ratio expression": lambda: ratio_expression_law("1/(1 + 0.3*cos(phi))", Lobes(), scale_to_close=False),
    "ratio expression 1:2": lambda: ratio_expression_law(
        "2 + 0.5*cos(phi) + 0.1*sin(2*phi)", Lobes(1, 2), scale_to_close=True
    ),
    "sharp ratio": lambda: ratio_expression_law("1 + 4*exp(40*(cos(phi - 2) - 1))", Lobes(), scale_to_close=True),
    "driven angle": lambda: driven_angle_expression_law("phi - 0.08*sin(2*phi)", Lobes()),
    "driven angle 2:1": lambda: driven_angle_expression_law("2*phi + 0.1*cos(4*phi)", Lobes(2, 1)),
    "harmonics": lambda: harmonic_law(np.array([-0.4, 0.2, 0.0, 0.05]), np.array([0.3, -0.1]), Lobes()),
    "harmonics 2:3": lambda: harmonic_law(np.array([0.1, 0.02]), np.array([0.05]), Lobes(2, 3)),
    "strong harmonic": lambda: harmonic_law(np.array([1.0]), np.array([0.0, 0.3]), Lobes()),
    "spline": lambda: spline_of(24),
    "spline 2:3": lambda: spline_of(17, Lobes(2, 3)),
    "steep spline": lambda: spline_ratio_law(
        np.array([0.0, 1.0, 1.7, 2.9, 4.0, 5.1]), np.exp([0.0, 0.8, -0.5, 1.0, 0.1, -0.3]), Lobes()
    ),
    "displacement table": lambda: displacement_table(12),
    "displacement table 2:1": doubled_table,
    "ratio table": lambda: ratio_table(30),
    "ratio table 2:3": lambda: ratio_table(24, Lobes(2, 3)),
    "stroke, e = 0": lambda: stroke_of(BALER, BALER_LINKAGE, Lobes(), 0.0),
    "stroke, least": lambda: stroke_of(BALER, BALER_LINKAGE, Lobes()),
    "stroke, least inverse": lambda: stroke_of(BALER, BALER_LINKAGE, Lobes(), inverse=True),
    "stroke, offset": lambda: stroke_of(BALER, OFFSET, Lobes(), 0.0),
    "stroke, law speed": lambda: stroke_of(AT_LAW_SPEED, BALER_LINKAGE, Lobes(), 0.0),
    "stroke, 2:1": lambda: stroke_of(doubled_lobes(), BALER_LINKAGE, Lobes(2, 1), 0.0),
}


@cache
def law(name: str) -> Transmission:
    """A law of the list, made once."""
    return LAWS[name]()


every_law = at_once("name", LAWS)


def stretches(transmission: Transmission) -> list[tuple[Piece, float, float]]:
    """The analytic stretches of the period, each with the piece it belongs to."""
    found = []
    for piece in transmission.pieces:
        edges = [piece.start_rad, *piece.knots_rad, piece.end_rad]
        found += [(piece, low, high) for low, high in itertools.pairwise(edges)]
    return found


# --- the contract --------------------------------------------------------------------------------------------------


@every_law
def test_the_driven_angle_starts_at_zero(name: str) -> None:
    assert law(name).driven_angle(np.zeros(1)).value[0] == pytest.approx(0.0, abs=1e-15)


@every_law
def test_the_cycle_closes(name: str) -> None:
    assert abs(law(name).closure_error_rad) <= 1e-12  # the closure promised


@every_law
def test_the_law_repeats_every_period_backwards_and_forwards(name: str) -> None:
    transmission = law(name)
    period, driven = transmission.lobes.driving_period_rad, transmission.lobes.driven_period_rad
    points = np.random.default_rng(5).uniform(0.01, 0.99, 40) * period
    at = transmission.driven_angle(points, 3)
    for turns in (-2, -1, 1, 5):
        moved = transmission.driven_angle(points + turns * period, 3)
        # phi1 itself loses 5 turns' rounding, 4e-15, and a derivative passes it on times the next one's size
        assert np.max(np.abs(moved.value - at.value - turns * driven)) <= 1e-13
        for order in range(1, 3):
            bound = 1e-12 + 1e-14 * np.abs(at.derivative(order + 1)) + 1e-13 * np.abs(at.derivative(order))
            assert np.all(np.abs(moved.derivative(order) - at.derivative(order)) <= bound)


@every_law
def test_one_turn_of_the_driven_gear_is_one_cycle(name: str) -> None:
    transmission = law(name)
    turned = transmission.driven_angle(np.array([transmission.cycle_rad])).value[0]
    assert turned == pytest.approx(2.0 * pi, abs=1e-12)


@every_law
def test_joints_are_ordered_from_zero_to_the_period(name: str) -> None:
    transmission = law(name)
    joints = transmission.joints_rad
    assert joints[0] == 0.0
    assert joints[-1] == pytest.approx(transmission.lobes.driving_period_rad, rel=1e-15)
    assert np.all(np.diff(joints) > 0.0)
    for before, after in zip(transmission.pieces[:-1], transmission.pieces[1:], strict=True):
        assert before.end_rad == after.start_rad


@every_law
def test_the_driven_angle_rises_strictly_without_jumps(name: str) -> None:
    transmission = law(name)
    phi1 = np.linspace(-0.5, 1.5, 8001) * transmission.lobes.driving_period_rad
    driven = transmission.driven_angle(phi1, 1)
    rise = np.diff(driven.value)
    assert np.all(rise > 0.0)
    steepest = transmission.slope_range[1].value
    assert np.all(rise <= np.diff(phi1) * steepest * (1.0 + 1e-9))  # the mean value theorem, and rounding


@every_law
def test_the_integral_of_the_slope_is_the_driven_angle(name: str) -> None:
    """Gauss-Legendre with 40 points on parts of 0.2 rad or less of each analytic stretch: resolved to rounding."""
    unit, weights = legendre.leggauss(40)
    for piece, low, high in stretches(law(name)):
        edges = np.linspace(low, high, 2 + int((high - low) / 0.2))
        middle, half = (edges[1:] + edges[:-1]) / 2.0, np.diff(edges) / 2.0
        slope = piece.slope((middle[:, None] + half[:, None] * unit).ravel(), 0).value.reshape(-1, 40)
        driven = piece.driven_angle(edges, 0).value
        # Angles of up to 2 pi, rounded, subtracted: some tens of rounding errors
        assert np.max(np.abs(half * (slope @ weights) - np.diff(driven))) <= 3e-14


@every_law
def test_every_derivative_is_the_derivative_of_the_one_before(name: str) -> None:
    """A Chebyshev interpolant of derivative k, differentiated in the middle of a stretch, against derivative k + 1."""
    nodes = chebyshev.chebpts1(15)
    for piece, low, high in stretches(law(name))[::5]:
        centre, half = (low + high) / 2.0, min(0.3 * (high - low), 0.04)
        points = np.append(centre + half * nodes, centre)
        series = piece.driven_angle(points, 4)
        for order in range(4):
            values = series.derivative(order)[:-1]
            fit = chebyshev.chebder(chebyshev.chebfit(nodes, values, 14)) / half
            # Differentiating amplifies rounding by degree^2 / half-width, 225 / half, in the scale of the values
            scale = float(np.abs(values).max()) + float(np.abs(series.derivative(order + 1)).max()) * half
            found = float(chebyshev.chebval(0.0, fit))
            assert found == pytest.approx(series.derivative(order + 1)[-1], abs=3e-13 / half * scale), (order, centre)


@every_law
def test_a_shorter_series_is_the_longer_one_cut(name: str) -> None:
    transmission = law(name)
    phi1 = np.linspace(0.0, transmission.lobes.driving_period_rad, 37)
    longer = transmission.driven_angle(phi1, 4)
    for order in range(4):
        shorter = transmission.driven_angle(phi1, order)
        scale = np.abs(longer.coefficients).max(axis=1, keepdims=True)[: order + 1]
        assert np.max(np.abs(shorter.coefficients - longer.coefficients[: order + 1]) / np.maximum(scale, 1.0)) <= 1e-14


@every_law
def test_the_ratio_range_bounds_a_dense_sample_and_is_reached(name: str) -> None:
    transmission = law(name)
    low, high = transmission.ratio_range
    phi1 = np.linspace(0.0, transmission.lobes.driving_period_rad, 20011)
    ratio = 1.0 / transmission.driven_angle(phi1, 1).derivative(1)
    assert ratio.min() >= low.value * (1.0 - 1e-13)  # rounding of one evaluation against another
    assert ratio.max() <= high.value * (1.0 + 1e-13)
    # Half a step off a smooth top: (1.6e-4)^2 / 2 times a relative curvature of some hundreds
    assert (ratio.min(), ratio.max()) == pytest.approx((low.value, high.value), rel=1e-5)
    for extremum in (low, high):
        reached = min(
            abs(1.0 / float(piece.slope(np.array([extremum.at]), 0).value[0]) - extremum.value)
            for piece in transmission.pieces
            if piece.start_rad <= extremum.at <= piece.end_rad
        )
        assert reached <= 1e-12 * extremum.value


@every_law
def test_the_mean_slope_is_the_lobes_ratio(name: str) -> None:
    """So the ratio's range encloses n2 / n1."""
    transmission = law(name)
    low, high = transmission.ratio_range
    mean = transmission.lobes.driven / transmission.lobes.driving
    assert low.value <= mean * (1.0 + 1e-14)
    assert high.value >= mean * (1.0 - 1e-14)


@every_law
def test_slope_is_continuous_at_every_joint_and_at_the_seam(name: str) -> None:
    """Otherwise the slider's velocity would jump."""
    pieces = law(name).pieces
    for before, after in zip((pieces[-1], *pieces[:-1]), pieces, strict=True):
        left = before.slope(np.array([before.end_rad]), 0).value[0]
        right = after.slope(np.array([after.start_rad]), 0).value[0]
        assert left == pytest.approx(right, rel=1e-11)


def test_right_hand_limits_at_joints() -> None:
    transmission = law("stroke, e = 0")
    for piece in transmission.pieces:
        joint = np.array([piece.start_rad])
        found, exact = transmission.driven_angle(joint, 4), piece.driven_angle(joint, 4)
        assert np.array_equal(found.coefficients, exact.coefficients)


# --- uniform and elliptical ----------------------------------------------------------------------------------------


@at_once("lobes", [Lobes(), Lobes(2, 1), Lobes(1, 3), Lobes(3, 2)])
def test_uniform_law_is_a_straight_line(lobes: Lobes) -> None:
    phi1 = np.linspace(-3.0, 9.0, 41)
    series = uniform_law(lobes).driven_angle(phi1, 3)
    assert np.allclose(series.value, phi1 * lobes.driving / lobes.driven, rtol=0.0, atol=1e-14)
    assert np.array_equal(series.derivative(1), np.full(41, lobes.driving / lobes.driven))
    assert not series.coefficients[2:].any()


@pytest.mark.judges("ratio")
@pytest.mark.tiers(quick=["0.05-*-lobes1"], slow=["0.35-3.49-lobes2"], rest="long")
@pytest.mark.parametrize("lobes", [Lobes(), Lobes(1, 2), Lobes(2, 1), Lobes(2, 3)])
@pytest.mark.parametrize(("eccentricity", "phase"), [(0.05, 0.0), (0.35, 3.49), (0.7, -1.0)])
def test_elliptical_law_against_quadrature_of_its_radii(eccentricity: float, phase: float, lobes: Lobes) -> None:
    """r1 = p / (1 + e cos x) rolls on r2 = a - r1; a / p is what closes the driven curve, found by mpmath."""
    transmission = elliptical_law(eccentricity, phase, lobes)
    with mp.workdps(25):
        period = 2 * mp.pi / lobes.driving

        def slope(phi: mp.mpf, size: mp.mpf) -> mp.mpf:
            radius = 1 / (1 + mp.mpf(eccentricity) * mp.cos(lobes.driving * (phi - mp.mpf(phase))))
            return radius / (size - radius)

        def turned(end: mp.mpf, size: mp.mpf) -> mp.mpf:
            return mp.quad(lambda phi: slope(phi, size), mp.linspace(0, end, 7))

        start = (1 + mp.mpf(lobes.driven) / lobes.driving) / (1 - mp.mpf(eccentricity) ** 2)
        bracket = (start * mp.mpf("0.7"), start * mp.mpf("1.5"))
        bracket = (max(bracket[0], mp.mpf("1.02") / (1 - mp.mpf(eccentricity))), bracket[1])

        def missing(size: mp.mpf) -> mp.mpf:
            # By even places of a period, which miss the mean by 0.41^128 at most.
            mean = mp.fsum(slope(period * k / 128, size) for k in range(128)) / 128
            return period * mean - 2 * mp.pi / lobes.driven

        size = mp.findroot(missing, bracket, solver="anderson", tol=1e-30)
        for share in (0.2, 0.5, 0.9):
            phi = mp.mpf(float(share * period))
            found = float(transmission.driven_angle(np.array([float(phi)])).value[0])
            assert abs(found - turned(phi, size)) <= 1e-13  # size 1 to 6, nothing cancels


def test_equal_ellipses_have_their_focal_distance_as_size() -> None:
    """a = 2 p / (1 - e^2), so i12 = 2 (1 + e cos x) / (1 - e^2) - 1 lies in [(1 - e)/(1 + e), (1 + e)/(1 - e)]."""
    for eccentricity in (0.1, 0.35, 0.8):
        low, high = elliptical_law(eccentricity, 1.0, Lobes()).ratio_range
        assert low.value == pytest.approx((1.0 - eccentricity) / (1.0 + eccentricity), rel=1e-14)
        assert high.value == pytest.approx((1.0 + eccentricity) / (1.0 - eccentricity), rel=1e-14)
        assert high.at == pytest.approx(1.0, abs=1e-6)  # smallest driving radius at the phase


# --- expressions ---------------------------------------------------------------------------------------------------


@pytest.mark.judges("ratio")
def test_ratio_expression_against_its_antiderivative() -> None:
    phi1 = np.linspace(0.0, 2.0 * pi, 51)
    assert np.max(np.abs(law("ratio expression").driven_angle(phi1).value - (phi1 + 0.3 * np.sin(phi1)))) <= 5e-15 * 6


def test_driven_angle_expression_is_taken_at_its_word() -> None:
    phi1 = np.linspace(0.0, pi, 51)
    exact = 2.0 * phi1 + 0.1 * (np.cos(4.0 * phi1) - 1.0)
    assert np.max(np.abs(law("driven angle 2:1").driven_angle(phi1).value - exact)) <= 5e-15
    slope = law("driven angle").driven_angle(np.ones(1), 1).derivative(1)[0]
    assert slope == pytest.approx(1.0 - 0.16 * np.cos(2.0), rel=1e-14)


def test_scaling_to_close_multiplies_the_ratio() -> None:
    """The mean of 1/(1 + b cos x) is 1/sqrt(1 - b^2), so the ratio must be multiplied by that."""
    transmission = ratio_expression_law("1 + 0.6*cos(phi)", Lobes(), scale_to_close=True)
    phi1 = np.linspace(0.0, 6.0, 13)
    ratio = 1.0 / transmission.driven_angle(phi1, 1).derivative(1)
    assert ratio == pytest.approx((1.0 + 0.6 * np.cos(phi1)) / sqrt(1.0 - 0.36), rel=1e-13)


def test_the_factor_that_a_refusal_names_does_close_the_cycle() -> None:
    with pytest.raises(NoSuchMechanism) as caught:
        ratio_expression_law("1 + 0.6*cos(phi)", Lobes(), scale_to_close=False)
    found = search(r"multiply the ratio by ([0-9.e+-]+)", caught.value.problem)
    assert found is not None
    assert float(found.group(1)) == pytest.approx(1.25, rel=1e-11)
    text = f"{found.group(1)}*(1 + 0.6*cos(phi))"
    assert abs(ratio_expression_law(text, Lobes(), scale_to_close=False).closure_error_rad) <= 1e-12


@at_once(
    ("law", "text", "driving", "driven"),
    [
        (driven_angle_expression_law, "2*phi + 0.1*sin(2*phi)", 2, 1),
        (driven_angle_expression_law, "phi/3 + 0.1*sin(phi)", 1, 3),
        (partial(ratio_expression_law, scale_to_close=False), "1/(3 + cos(3*phi))", 3, 1),
        (partial(ratio_expression_law, scale_to_close=False), "2/(1 + 0.3*cos(phi))", 1, 2),
    ],
)
def test_the_lobes_that_a_refusal_names_do_close_the_cycle(
    law: Callable[[str, Lobes], Transmission], text: str, driving: int, driven: int
) -> None:
    with pytest.raises(NoSuchMechanism) as caught:
        law(text, Lobes())
    assert f"gears.lobes: {{driving: {driving}, driven: {driven}}} is right" in caught.value.problem
    assert abs(law(text, Lobes(driving, driven)).closure_error_rad) <= 1e-12


@at_once(
    ("text", "said"),
    [
        ("1.001/(1 + 0.3*cos(phi))", "does not close"),
        ("-1/(1 + 0.3*cos(phi))", "negative"),
        ("0.5 + cos(phi)", "zero, infinite or jumps"),
        ("1 + phi/10", "jumps where the cycle begins again"),
        ("1 + 0.1*cos(phi/2)", "jumps where the cycle begins again"),
        ("1/phi", "no finite value"),
        ("log(phi)", "no finite value"),
        ("0", ""),
        ("sqrt(cos(phi))", ""),
    ],
)
@at_once("scale", [True, False])
def test_ratios_that_give_no_law_are_refused(text: str, said: str, scale: bool) -> None:
    if scale and said == "does not close":
        assert abs(ratio_expression_law(text, Lobes(), scale_to_close=True).closure_error_rad) <= 1e-12
        return
    with pytest.raises(NoSuchMechanism) as caught:
        ratio_expression_law(text, Lobes(), scale_to_close=scale)
    assert caught.value.key == "motion.ratio"
    assert said in caught.value.problem


@at_once(
    ("text", "said"),
    [
        ("2*phi", "does not close"),
        ("phi**2/(2*pi)", "jumps"),
        ("log(phi)", "no finite value"),
        ("-phi", ""),
        ("3", ""),
    ],
)
def test_driven_angles_that_give_no_law_are_refused(text: str, said: str) -> None:
    with pytest.raises(DesignError) as caught:
        driven_angle_expression_law(text, Lobes())
    assert caught.value.key == "motion.driven_angle"
    assert said in caught.value.problem


def test_a_driven_gear_that_turns_back_is_refused_with_the_angle() -> None:
    """phi - 1.5 sin(phi) falls where cos(phi) > 2/3; fastest at 0."""
    with pytest.raises(NoSuchMechanism) as caught:
        driven_angle_expression_law("phi - 1.5*sin(phi - 1) - 1.5*sin(1)", Lobes())
    found = search(r"phi1 = ([-0-9.e]+) rad", caught.value.problem)
    assert found is not None
    assert float(found.group(1)) == pytest.approx(1.0, abs=1e-5)
    assert "-0.5" in caught.value.problem


# --- tables --------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("each_stroke", [5, 12, 40])
def test_a_displacement_table_is_met_through_the_linkage(each_stroke: int) -> None:
    phi1, displacement = table_of(ELLIPSE(), SMALL, each_stroke)
    transmission = displacement_table_law(phi1, displacement, SMALL, Lobes())
    found = SMALL.displacement(transmission.driven_angle(phi1)).value
    # Interpolation is exact at its points; crank angle and back lose some rounding errors of the stroke
    assert np.max(np.abs(found - displacement)) <= 1e-13 * SMALL.stroke_mm


def observed_orders(make: Callable[[int], Transmission], exact: Transmission, counts: list[int]) -> list[float]:
    """Exponents of the error's fall from one count to the next."""
    phi1 = np.linspace(0.0, 2.0 * pi, 1201)
    errors = [float(np.max(np.abs(make(n).driven_angle(phi1).value - exact.driven_angle(phi1).value))) for n in counts]
    pairs = zip(errors[:-1], errors[1:], counts[:-1], counts[1:], strict=True)
    return [float(np.log(coarse / fine) / np.log(n2 / n1)) for coarse, fine, n1, n2 in pairs]


def test_displacement_tables_converge_at_the_order_of_a_quintic_spline() -> None:
    """Order 6; the last orders, of errors 1e-7 and less, are asymptotic to a few tenths."""
    orders = observed_orders(displacement_table, ELLIPSE(), [12, 24, 48, 96])
    assert min(orders[1:]) > 5.5


def test_ratio_tables_converge_at_the_order_of_a_quintic_spline() -> None:
    """The slope's error is of order 6, and its integral over whole steps no worse."""
    exact = ratio_expression_law("1 + 0.3*cos(phi)", Lobes(), scale_to_close=True)
    assert min(observed_orders(ratio_table, exact, [12, 24, 48])) > 5.5


def test_a_ratio_table_is_met_at_its_points() -> None:
    phi1 = np.linspace(0.0, 2.0 * pi, 30, endpoint=False)
    ratio = 1.0 / law("ratio table").driven_angle(phi1, 1).derivative(1)
    # The mean of 1/(1 + b cos x) again; thirty points resolve it to 1e-12
    assert ratio == pytest.approx((1.0 + 0.3 * np.cos(phi1)) / sqrt(0.91), rel=1e-9)


def test_a_closing_row_changes_nothing() -> None:
    phi1, displacement = table_of(ELLIPSE(), SMALL, 12)
    closed = displacement_table_law(np.append(phi1, 2.0 * pi), np.append(displacement, 0.0), SMALL, Lobes())
    points = np.linspace(0.0, 6.0, 31)
    found, exact = closed.driven_angle(points, 2), law("displacement table").driven_angle(points, 2)
    assert np.array_equal(found.coefficients, exact.coefficients)


def test_few_points_are_interpolated_by_a_cubic() -> None:
    phi1 = np.array([0.0, 1.5, 3.0, 4.5])
    transmission = ratio_table_law(phi1, np.array([1.0, 1.1, 1.0, 0.9]), Lobes(), scale_to_close=True)
    slope = transmission.driven_angle(phi1, 1).derivative(1)
    assert slope[0] / slope[1] == pytest.approx(1.1, rel=1e-13)


GOOD_ANGLES = np.arange(8) * (2.0 * pi / 8.0)
GOOD = np.array([0.0, 10.0, 40.0, 80.0, 100.0, 80.0, 40.0, 10.0])
IN_LINE = CrankSlider(50.0, 200.0)


def changed(values: Array, index: int, value: float) -> Array:
    """A copy with one value changed."""
    copy = values.copy()
    copy[index] = value
    return copy


@at_once(
    ("phi1", "displacement", "said"),
    [
        (changed(GOOD_ANGLES, 0, 0.1), GOOD, "must be (0, 0)"),
        (GOOD_ANGLES, changed(GOOD, 0, 1.0), "must be (0, 0)"),
        (GOOD_ANGLES, changed(GOOD, 4, 99.0), "must be the extended end, 100 mm"),
        (GOOD_ANGLES, changed(GOOD, 4, 101.0), "must be the extended end, 100 mm"),
        (GOOD_ANGLES, changed(GOOD, 2, 9.0), "turns back after phi1 = 0.785398"),
        (GOOD_ANGLES, changed(GOOD, 2, 10.0), "stands still at 10 mm after phi1 = 0.785398"),
        (GOOD_ANGLES, changed(GOOD, 2, 10.0), "1.5708 rad (90 deg) over 10 and under 80 mm is right"),
        (GOOD_ANGLES, changed(GOOD, 5, 100.0), "3.92699 rad (225 deg) over 40 and under 100 mm is right"),
        (GOOD_ANGLES, changed(GOOD, 3, 100.0), "stands still at 100 mm after phi1 = 2.35619"),
        (GOOD_ANGLES, changed(GOOD, 3, 120.0), "the largest displacement is 120 mm"),
        (GOOD_ANGLES, changed(GOOD, 1, 42.0), "1.5708 rad (90 deg) over 42 and under 80 mm is right"),
        (GOOD_ANGLES, changed(GOOD, 7, 0.0), "5.49779 rad (315 deg) over 0 and under 40 mm is right"),
        (GOOD_ANGLES, changed(GOOD, 6, 85.0), "turns back after phi1 = 3.92699"),
        (changed(GOOD_ANGLES, 7, 6.4), GOOD, "one cycle ends at 6.28319"),
        (changed(GOOD_ANGLES, 7, 2.0 * pi), GOOD, "ends with 10 but begins with 0"),
    ],
)
def test_displacement_tables_that_are_wrong_are_refused(phi1: Array, displacement: Array, said: str) -> None:
    with pytest.raises(WrongInput) as caught:
        displacement_table_law(phi1, displacement, IN_LINE, Lobes())
    number = re.fullmatch(r"motion\.displacement_mm(?:\.(\d))?", caught.value.key)
    assert number is not None
    assert said in caught.value.problem
    right = re.search(r"at ([\d.]+) rad .* over (\d+) and under (\d+) mm is right", caught.value.problem)
    if right:
        assert number[1] is not None
        assert GOOD_ANGLES[int(number[1])] == pytest.approx(float(right[1]), abs=1e-5)
        middle = (float(right[2]) + float(right[3])) / 2.0
        displacement_table_law(phi1, changed(displacement, int(number[1]), middle), IN_LINE, Lobes())


def test_the_driven_gear_may_be_slow_by_a_millionth_of_its_fastest() -> None:
    """exp(a cos(phi)) spans exp(2 a) whatever it is scaled by: 0.8 millions with 6.8, 1.2 millions with 7."""
    slow, fast = (
        one.value for one in ratio_expression_law("exp(6.8*cos(phi))", Lobes(), scale_to_close=True).slope_range
    )
    assert fast / slow == pytest.approx(exp(2.0 * 6.8), rel=1e-9)
    with pytest.raises(NoSuchMechanism, match="stops or turns back"):
        ratio_expression_law("exp(7*cos(phi))", Lobes(), scale_to_close=True)


def test_the_table_that_was_changed_is_a_law_unchanged() -> None:
    assert abs(displacement_table_law(GOOD_ANGLES, GOOD, IN_LINE, Lobes()).closure_error_rad) <= 1e-12


def test_a_table_whose_spline_turns_back_is_refused() -> None:
    """Points that rise hardly at all and then suddenly: the interpolant overshoots."""
    steps = np.array([0.0, 0.01, 0.02, 99.98, 100.0, 99.98, 0.02, 0.01])
    with pytest.raises(NoSuchMechanism) as caught:
        displacement_table_law(GOOD_ANGLES, steps, IN_LINE, Lobes())
    assert "stops or turns back" in caught.value.problem
    assert "no single point of the table mends that" in caught.value.problem


def test_a_rising_table_that_turns_back_between_its_points_is_told_which_point_to_move() -> None:
    """The point that was moved off a smooth curve is named, and its new value makes the law."""
    good = displacement_table_law(GOOD_ANGLES, GOOD, IN_LINE, Lobes())
    phi1 = np.linspace(0.0, 2.0 * pi, 24, endpoint=False)
    smooth = IN_LINE.displacement(good.driven_angle(phi1)).value
    rough = changed(smooth, 8, 0.9 * smooth[9] + 0.1 * smooth[8])
    with pytest.raises(NoSuchMechanism, match="stops or turns back") as caught:
        displacement_table_law(phi1, rough, IN_LINE, Lobes())
    assert caught.value.key == "motion.displacement_mm.8"
    new = float(re.findall(r"with ([\d.]+) mm in place of", caught.value.problem)[0])
    assert new == pytest.approx(smooth[8], rel=1e-2)
    displacement_table_law(phi1, changed(rough, 8, new), IN_LINE, Lobes())


def test_a_table_of_positive_ratios_whose_spline_is_not_positive_is_told_which_point_to_move() -> None:
    phi1 = np.arange(16) * (2.0 * pi / 16.0)
    ratio = changed(1.0 + 0.2 * np.sin(phi1), 5, 0.02)
    with pytest.raises(NoSuchMechanism, match="stops or turns back") as caught:
        ratio_table_law(phi1, ratio, Lobes(), scale_to_close=True)
    assert caught.value.key == "motion.ratio.5"
    new = float(re.findall(r"with ([\d.]+) in place of 0\.02", caught.value.problem)[0])
    assert new == pytest.approx(1.0 + 0.2 * np.sin(phi1[5]), rel=1e-2)


@pytest.mark.parametrize("value", [0.0, -0.2])
def test_ratio_tables_must_be_positive(value: float) -> None:
    ratio = changed(1.0 + 0.1 * np.cos(GOOD_ANGLES), 3, value)
    with pytest.raises(WrongInput) as caught:
        ratio_table_law(GOOD_ANGLES, ratio, Lobes(), scale_to_close=True)
    assert caught.value.key == "motion.ratio"
    assert "phi1 = 2.35619" in caught.value.problem


def test_ratio_tables_must_close() -> None:
    with pytest.raises(NoSuchMechanism) as caught:
        ratio_table_law(GOOD_ANGLES, np.full(8, 1.01), Lobes(), scale_to_close=False)
    assert caught.value.key == "motion.ratio"
    assert "1/1.01" not in caught.value.problem
    assert "multiply the ratio by 0.990099" in caught.value.problem


# --- three segments ------------------------------------------------------------------------------------------------


SAME_LAWS = [("stroke, e = 0", "stroke, 2:1"), ("displacement table", "displacement table 2:1")]


@pytest.mark.parametrize(("single", "double"), SAME_LAWS)
def test_two_lobes_run_the_same_law_twice_as_often(single: str, double: str) -> None:
    """Halved angles and halved speeds are the same functions of twice the angle; the driven gear has one lobe."""
    phi1 = np.linspace(0.0, 2.0 * pi, 101)[:-1]
    once, twice = law(single).driven_angle(phi1, 2), law(double).driven_angle(phi1 / 2.0, 2)
    assert np.max(np.abs(once.value - twice.value)) <= 1e-12
    assert np.max(np.abs(2.0 * once.derivative(1) - twice.derivative(1))) <= 1e-11


@pytest.mark.slow
def test_the_published_law_against_mpmath_over_the_whole_turn() -> None:
    angles = BALER.theta1_rad, BALER.theta2_rad, BALER.theta3_rad, BALER.theta4_rad
    speeds = BALER.v1, BALER.v2, BALER.a1
    exact = oracle.cycle(oracle.StrokeParameters(*angles, *speeds, 380.0, 960.0, 0.0, BALER.a1_speed_rad_s))
    phi1 = np.linspace(0.0, 2.0 * pi - 1e-9, 31)
    series = law("stroke, e = 0").driven_angle(phi1, 1)
    for at, driven, slope in zip(phi1.tolist(), series.value.tolist(), series.derivative(1).tolist(), strict=True):
        assert driven == pytest.approx(float(exact.driven_angle(at)), abs=1e-10)  # as in the return's own test
        assert 1.0 / slope == pytest.approx(float(exact.ratio(at)), abs=1e-10)


@pytest.mark.parametrize("lobes", [Lobes(2, 1), Lobes(3, 1)])
def test_a_stroke_longer_than_the_cycle_is_refused(lobes: Lobes) -> None:
    with pytest.raises(WrongInput) as caught:
        stroke_of(BALER, BALER_LINKAGE, lobes, 0.0)
    assert caught.value.key == "motion"
    assert "theta4 is 234 deg" in caught.value.problem


def cosine_table(count: int) -> Transmission:
    phi1 = np.linspace(0.0, 2.0 * pi, count, endpoint=False)
    return ratio_table_law(phi1, 1.0 / (1.0 + 0.2 * np.cos(phi1)), Lobes(), scale_to_close=True)


def test_the_densest_table_still_has_its_curvature() -> None:
    """phi2 = phi1 + 0.2 sin(phi1): the pitch curves' curvature is made of its third derivative, -0.2 cos(phi1)."""
    points = np.linspace(0.1, 6.0, 501)
    third = cosine_table(2000).driven_angle(points, 3).derivative(3)
    # Rounding of 1e-16 by the cube of 1/h = 318 is 3e-9; the sum over neighbours adds to it
    assert np.max(np.abs(third + 0.2 * np.cos(points))) <= 1e-7


def test_a_table_too_dense_for_its_digits_is_refused() -> None:
    with pytest.raises(WrongInput, match="keep every 5th") as caught:
        cosine_table(8001)
    assert caught.value.key == "motion.ratio"


@pytest.mark.parametrize("lobes", [Lobes(1, 2), Lobes(2, 3)])
def test_a_slider_law_takes_one_turn_of_the_driven_gear(lobes: Lobes) -> None:
    """A crank that turns half a cycle a turn would need the other half to be the same: strokes and tables say so."""
    phi1 = np.linspace(0.0, lobes.driving_period_rad, 12, endpoint=False)
    moved = BALER_LINKAGE.displacement(Jet(phi1[None, :] * lobes.driving)).value
    for made in (
        lambda: stroke_of(BALER, BALER_LINKAGE, lobes, 0.0),
        lambda: displacement_table_law(phi1, moved, BALER_LINKAGE, lobes),
    ):
        with pytest.raises(WrongInput) as caught:
            made()
        assert caught.value.key == "gears.lobes.driven"


DOUBLE = "2 + 1/(cos(phi) - cos(1.0))**2"
"""Two double poles, which the search for the least slope hits exactly."""


@pytest.mark.slow
@pytest.mark.parametrize("text", ["cos(phi)", "tan(phi/2)**2 + 1", "1/(1 + cos(phi))", DOUBLE])
@pytest.mark.parametrize("scaled", [True, False])
def test_a_ratio_with_a_pole_or_a_zero_is_no_law(text: str, scaled: bool) -> None:
    with pytest.raises(NoSuchMechanism):
        ratio_expression_law(text, Lobes(), scale_to_close=scaled)


# --- the check that every law passes through ------------------------------------------------------------------------


@pytest.mark.parametrize("lowest", [0.0, -0.3, nan])
def test_a_slope_that_is_not_positive_makes_no_transmission(lowest: float) -> None:
    def driven_angle(phi1: Array, order: int) -> Jet:
        series = Jet.variable(phi1, order + 2)
        slope = (series - 2.0) * (series - 2.0) + lowest
        return slope.truncated(max(order - 1, 0)).integrated(phi1) if order else Jet(phi1[None, :])

    with pytest.raises(NoSuchMechanism) as caught:
        Transmission((Piece(0.0, 2.0 * pi, driven_angle),), Lobes())
    assert "stops or turns back" in caught.value.problem
    if lowest == lowest:
        assert "phi1 = 2 rad" in caught.value.problem
