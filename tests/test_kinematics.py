"""Peaks, power and working stroke: published figures, dense samples, quadrature, and scaling with speed."""

from __future__ import annotations

import itertools
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cache
from math import pi

import numpy as np
import pytest
from numpy.polynomial import Polynomial, legendre

from at_once import at_once
from ncgear.kinematics.check import KinematicCheck, at_speed, kinematic_check
from ncgear.kinematics.crank_stretches import _reach
from ncgear.kinematics.motion import Machine, sample_angles
from ncgear.mechanisms.crank_slider import CrankSlider
from ncgear.mechanisms.resistance import PolynomialResistance
from ncgear.mechanisms.slider_load import SliderLoad
from ncgear.numerics.arrays import Array
from ncgear.numerics.extrema import Extremum
from ncgear.numerics.jet import Jet
from ncgear.ratio.laws.expression import ratio_expression_law
from ncgear.ratio.laws.harmonic import harmonic_law
from ncgear.ratio.laws.uniform import uniform_law
from ncgear.ratio.transmission import Lobes
from published import BALER_LINKAGE, FIT, OFFSET, PRESS, RPM
from test_laws import LAWS, law

BALER_LAW = "stroke, e = 0"


def machine(name: str, rpm: float, linkage: CrankSlider = BALER_LINKAGE, load: SliderLoad = PRESS) -> Machine:
    """A law of the list on a linkage."""
    return Machine(law(name), linkage, load, rpm * RPM)


@cache
def check(name: str, rpm: float, linkage: CrankSlider = BALER_LINKAGE, load: SliderLoad = PRESS) -> KinematicCheck:
    """Its figures."""
    return kinematic_check(machine(name, rpm, linkage, load))


def test_uniform_crank_at_sixty() -> None:
    """434.5 W per r/min and 20 940 mm/s^2, known to four digits."""
    found = check("uniform", 60.0)
    assert found.peak_power_w.value / 60.0 == pytest.approx(434.5, abs=0.05)
    assert found.peak_acceleration_cycle.value == pytest.approx(20940.0, abs=5.0)
    # In line the crank's own formula at the extended end: l2 w^2 (1 + l2/l3)
    exact = 380.0 * (2.0 * pi) ** 2 * (1.0 + 380.0 / 960.0)
    assert found.peak_acceleration_cycle.value == pytest.approx(exact, rel=1e-13)
    assert found.speed_rpm == pytest.approx(60.0, rel=1e-15)


@pytest.mark.judges("kinematics")
def test_the_published_headline_figures() -> None:
    """6315 W and 1500.0 mm/s^2 in the working stroke at 20 r/min; over the cycle about 7340 mm/s^2."""
    found = check(BALER_LAW, 20.0)
    assert found.peak_power_w.value == pytest.approx(6315.0, abs=0.5)
    assert found.peak_acceleration_working.value == pytest.approx(1500.0, abs=1e-8)  # a1 itself, at theta4
    assert found.peak_acceleration_working.at == pytest.approx(1.3 * pi, rel=1e-14)
    assert found.peak_acceleration_cycle.value == pytest.approx(7340.0, abs=10.0)
    assert found.peak_acceleration_cycle.at > 1.3 * pi


@pytest.mark.thorough
def test_the_same_mechanism_at_its_own_speed() -> None:
    """16 675 W at 52.81 r/min, where its working speed is the 1100 mm/s asked for and its peak about 51 200 mm/s^2."""
    found = check(BALER_LAW, 52.81)
    assert found.peak_power_w.value == pytest.approx(16675.0, abs=2.0)  # the speed is written with four digits
    assert found.peak_acceleration_cycle.value == pytest.approx(51200.0, abs=100.0)
    at_theta1 = machine(BALER_LAW, 52.81).motion(np.array([0.4 * pi, 0.8 * pi])).velocity
    assert at_theta1 == pytest.approx([1600.0, 1100.0], rel=1e-4)


FIGURES: dict[str, tuple[Callable[[KinematicCheck], float], int]] = {
    "power": (lambda c: c.peak_power_w.value, 1),
    "mean power": (lambda c: c.mean_power_w, 1),
    "speed": (lambda c: c.peak_speed.value, 1),
    "working acceleration": (lambda c: c.peak_acceleration_working.value, 2),
    "cycle acceleration": (lambda c: c.peak_acceleration_cycle.value, 2),
}


@at_once("figure", FIGURES)
@at_once("name", ["uniform", BALER_LAW, "ratio expression 1:2"])
def test_figures_scale_with_powers_of_the_speed(name: str, figure: str) -> None:
    value, power = FIGURES[figure]
    slow, fast = value(check(name, 20.0)), value(check(name, 50.0))
    assert fast == pytest.approx(slow * 2.5**power, rel=1e-14)
    assert value(at_speed(check(name, 20.0), 50.0)) == pytest.approx(slow * 2.5**power, rel=1e-14)


# --- against dense samples -----------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Sampled:
    """A quantity over one cycle, and the step between its samples."""

    phi1: Array
    values: Array


def joints_of(of: Machine) -> list[float]:
    """Every joint of the law in one cycle of the slider, both ends included."""
    lobes, joints = of.transmission.lobes, of.transmission.joints_rad.tolist()
    return [k * lobes.driving_period_rad + joint for k in range(lobes.driven) for joint in joints]


def dense_angles(of: Machine, count: int = 6007) -> Array:
    """Even angles over one cycle, and both sides of every joint and of the extended dead centre."""
    sides = [joint + side for joint in [*joints_of(of), of.extended_rad] for side in (-1e-9, 1e-9)]
    angles = np.concatenate([np.linspace(0.0, of.transmission.cycle_rad, count), sides])
    return np.unique(angles[(angles >= 0.0) & (angles < of.transmission.cycle_rad)])


def assert_peak(exact: Extremum, phi1: Array, sampled: Array) -> None:
    """Never below a sample, but for rounding; above all of them only by what a step can hide."""
    highest = float(sampled.max())
    assert exact.value >= highest * (1.0 - 1e-11)
    around = sampled[max(int(sampled.argmax()) - 3, 0) : int(sampled.argmax()) + 4]
    # A smooth top hides an eighth of the second difference between samples, 1e-6 of the peak; sharper laws hide more
    hidden = float(np.abs(np.diff(around, 2)).max()) if around.size > 2 else 0.0
    assert exact.value <= highest * (1.0 + 1e-6) + 2.0 * hidden


LINKAGES = {"in line": BALER_LINKAGE, "offset": OFFSET, "offset back": CrankSlider(380.0, 960.0, -150.0)}


@pytest.mark.tiers(quick=["uniform*"], thorough=["stroke*-offset"], rest="slow")
@pytest.mark.parametrize("linkage", LINKAGES)
@pytest.mark.parametrize("name", LAWS)
def test_peaks_bound_a_dense_sample_and_are_hardly_higher(name: str, linkage: str) -> None:
    of, found = machine(name, 30.0, LINKAGES[linkage]), check(name, 30.0, LINKAGES[linkage])
    phi1 = dense_angles(of)
    motion = of.motion(phi1)
    working = phi1 < of.extended_rad
    accelerations = np.abs(motion.acceleration)
    assert_peak(found.peak_power_w, phi1, motion.power_w)
    assert_peak(found.peak_speed, phi1, np.abs(motion.velocity))
    assert_peak(found.peak_acceleration_cycle, phi1, accelerations)
    assert_peak(found.peak_acceleration_working, phi1[working], accelerations[working])


NARROW = {
    "rod/crank 1.0001": CrankSlider(380.0, 380.038),
    "rod/crank 1.01": CrankSlider(380.0, 383.8),
    "rod/crank 1.14": CrankSlider(380.0, 433.2),
    "offset to the limit": CrankSlider(380.0, 570.0, 189.99),
    "offset back to the limit": CrankSlider(380.0, 570.0, -189.99),
}


@pytest.mark.tiers(thorough=["uniform*"], rest="slow")
@pytest.mark.parametrize("linkage", NARROW)
@pytest.mark.parametrize("name", [BALER_LAW, "uniform", "ellipse 1:2"])
def test_no_sharp_corner_of_a_short_rod_is_passed_by(name: str, linkage: str) -> None:
    """Its acceleration is a peak 0.014 rad of the crank wide, which even samples of the strokes would miss."""
    of = Machine(law(name), NARROW[linkage], PRESS, RPM)
    phi1 = dense_angles(of, 60_007)
    assert_peak(kinematic_check(of).peak_acceleration_cycle, phi1, np.abs(of.motion(phi1).acceleration))


@at_once("name", NARROW)
def test_corners_are_where_the_rod_is_steepest(name: str) -> None:
    """Half a width off, the curve bends there at its most; the widths are those of cosh."""
    for angle, width in NARROW[name].corners:
        around = angle + width * np.linspace(-0.5, 0.5, 2001)
        if width < 0.1:
            bend = np.abs(NARROW[name].displacement(Jet.variable(around, 2)).derivative(2))
            assert abs(around[int(bend.argmax())] - angle) <= 0.1 * width


@at_once("name", LAWS)
def test_velocity_and_acceleration_are_derivatives_of_the_displacement(name: str) -> None:
    """Central differences with Richardson extrapolation, at points away from joints."""
    of = machine(name, 30.0)
    joints = of.transmission.joints_rad
    phi1 = ((joints[:-1] + joints[1:]) / 2.0)[::3]
    step = min(2e-3, 0.1 * float(np.diff(joints).min()))
    moved = {k: of.motion(phi1 + k * step) for k in (-2, -1, 0, 1, 2)}
    for fine, coarse in (("displacement", "velocity"), ("velocity", "acceleration")):
        x = {k: getattr(motion, fine) for k, motion in moved.items()}
        slope = (8.0 * (x[1] - x[-1]) - (x[2] - x[-2])) / (12.0 * step) * of.speed_rad_s
        exact = getattr(moved[0], coarse)
        scale = float(np.abs(exact).max()) + 760.0 * of.speed_rad_s
        # Fourth-order error, (2e-3)^4 times a fifth derivative of some 1e4; rounding 1e-13 / 2e-3
        assert np.max(np.abs(slope - exact)) <= 1e-6 * scale


# --- work and mean power -------------------------------------------------------------------------------------------


def quadrature_of_power(of: Machine) -> float:
    """Mean power from Gauss-Legendre quadrature of the sampled power, piece by piece."""
    unit, weights = legendre.leggauss(24)
    assert isinstance(of.load.working, PolynomialResistance)
    zero = np.array([cross for cross in real_zeros(of.load.working) if 0.0 < cross < of.linkage.stroke_mm])
    candidates = np.array([*joints_of(of), of.extended_rad, *crossings(of, zero)])
    edges = np.unique(candidates[candidates <= of.extended_rad])
    edges = np.concatenate([np.linspace(low, high, 9)[:-1] for low, high in itertools.pairwise(edges)] + [edges[-1:]])
    halves = np.diff(edges)[:, None] / 2.0
    phi1 = edges[:-1, None] + halves * (1.0 + unit)
    power_w = of.motion(phi1.ravel()).power_w.reshape(phi1.shape)
    return float((halves * weights * power_w).sum()) / of.transmission.cycle_rad


def real_zeros(resistance: PolynomialResistance) -> list[float]:
    """Real zeros of the fit."""
    roots = Polynomial(resistance.coefficients_n).roots()
    return [float(root.real) for root in roots if abs(root.imag) < 1e-9]


def crossings(of: Machine, displacements: Array) -> list[float]:
    """Driving angles in the working stroke at which the slider passes displacements, by bisection."""
    found = []
    for wanted in displacements.tolist():
        low, high = 0.0, of.extended_rad
        for _ in range(60):
            middle = (low + high) / 2.0
            low, high = (middle, high) if of.displacement(np.array([middle]), 0).value[0] < wanted else (low, middle)
        found.append(low)
    return found


@pytest.mark.tiers(quick=["ellipse*-True"], thorough=["*-offset-*"], rest="slow")
@pytest.mark.parametrize("keep", [False, True])
@pytest.mark.parametrize("linkage", LINKAGES)
@pytest.mark.parametrize("name", ["uniform", BALER_LAW, "ellipse 1:2", "displacement table"])
def test_mean_power_is_the_work_in_the_cycle_time(name: str, linkage: str, keep: bool) -> None:
    load = SliderLoad(PolynomialResistance(FIT, keep_negative=keep))
    of = machine(name, 30.0, LINKAGES[linkage], load)
    # Work does not depend on the law; quadrature of smooth parts is exact to rounding of some thousand products
    mean = check(name, 30.0, LINKAGES[linkage], load).mean_power_w
    assert quadrature_of_power(of) == pytest.approx(mean, rel=1e-10)


def test_work_with_negative_resistance_kept_or_taken_as_zero() -> None:
    """The fit crosses zero near 34 mm: kept, its antiderivative over the stroke; clamped, without the negative part."""
    fit = Polynomial(FIT)
    whole = float(fit.integ()(760.0)) / 1000.0
    crossing = min(zero for zero in real_zeros(PRESS.working) if zero > 0.0)
    assert sum(c * crossing**k for k, c in enumerate(FIT)) == pytest.approx(0.0, abs=1e-10)
    assert 33.0 < crossing < 34.0  # by hand: F(33) = -2.7 N, F(34) = 1.3 N
    negative = float(fit.integ()(crossing)) / 1000.0
    assert negative < 0.0
    assert SliderLoad(PolynomialResistance(FIT, keep_negative=True)).cycle_work_n_mm(760.0) / 1e3 == pytest.approx(
        whole, rel=1e-14
    )
    clamped = PRESS.cycle_work_n_mm(760.0) / 1e3
    assert clamped >= whole - negative - 1e-9
    samples = np.linspace(0.0, 760.0, 400001)
    trapezoid = float(np.trapezoid(np.maximum(fit(samples), 0.0), samples)) / 1000.0
    assert clamped == pytest.approx(trapezoid, rel=1e-8)  # steps of 2e-3 mm: (2e-3)^2 relative, kinks included


@pytest.mark.judges("kinematics")
@pytest.mark.parametrize(
    ("coefficients", "keep", "work"), [((400.0,), False, 24.0), ((-400.0,), False, 0.0), ((-400.0,), True, -24.0)]
)
def test_work_of_constant_resistance(coefficients: tuple[float, ...], keep: bool, work: float) -> None:
    assert SliderLoad(PolynomialResistance(coefficients, keep)).cycle_work_n_mm(60.0) == pytest.approx(
        1e3 * work, rel=1e-15
    )


def test_no_resistance_needs_no_power() -> None:
    found = check("uniform", 60.0, BALER_LINKAGE, SliderLoad())
    assert found.peak_power_w.value == found.mean_power_w == 0.0


@pytest.mark.parametrize(("keep", "lowest"), [(False, 0.0), (True, -131.2779)])
def test_force_is_clamped_or_kept(keep: bool, lowest: float) -> None:
    force = PolynomialResistance(FIT, keep).force_n(np.array([0.0, 20.0, 700.0]))
    assert force[0] == pytest.approx(lowest)
    assert (force[1] < 0.0) == keep
    exact = sum(c * 700.0**k for k, c in enumerate(FIT))
    assert force[2] == pytest.approx(exact, rel=1e-12)


# --- cycle and working stroke --------------------------------------------------------------------------------------


@at_once("lobes", [Lobes(), Lobes(1, 2), Lobes(2, 1), Lobes(2, 3)])
def test_samples_cover_the_cycle_and_a_turn(lobes: Lobes) -> None:
    transmission = uniform_law(lobes)
    phi1 = sample_angles(transmission)
    assert phi1[0] == 0.0
    assert phi1[-1] >= 2.0 * pi - 1e-15
    assert phi1[-1] >= transmission.cycle_rad * (1.0 - 1e-15)
    assert phi1.size >= 2001
    assert np.diff(phi1).max() <= 2.0 * pi / 2000.0 * (1.0 + 1e-9)


def test_one_lobe_on_two_makes_one_stroke_in_two_turns() -> None:
    of = machine("ratio expression 1:2", 30.0, OFFSET)
    assert of.transmission.cycle_rad == pytest.approx(4.0 * pi, rel=1e-15)
    motion = of.motion(sample_angles(of.transmission))
    assert motion.displacement[0] == pytest.approx(0.0, abs=1e-9)
    assert motion.displacement[-1] == pytest.approx(0.0, abs=1e-9)
    assert motion.displacement.max() == pytest.approx(OFFSET.stroke_mm, rel=1e-5)
    reversals = np.nonzero(np.diff(np.sign(motion.velocity[1:-1])))[0]
    assert reversals.size == 1
    assert of.extended_rad == pytest.approx(float(motion.phi1_rad[reversals[0] + 1]), abs=2.0 * pi / 2000.0)


@at_once("name", LAWS)
@at_once("linkage", LINKAGES)
def test_working_stroke_is_where_the_slider_advances(name: str, linkage: str) -> None:
    of = machine(name, 30.0, LINKAGES[linkage], SliderLoad(PolynomialResistance((100.0,))))
    phi1 = np.linspace(0.0, of.transmission.cycle_rad, 1999)[1:-1]
    motion = of.motion(phi1)
    clear = np.abs(phi1 - of.extended_rad) > 1e-9
    advancing = motion.velocity > 0.0
    assert np.array_equal(of.working(motion.phi2_rad)[clear], advancing[clear])
    assert np.array_equal(motion.load[clear], np.where(advancing, 100.0, 0.0)[clear])
    assert np.array_equal(motion.power_w, motion.load * motion.velocity / 1000.0)


@at_once("name", LAWS)
def test_extended_angle_is_the_extended_dead_centre(name: str) -> None:
    of = machine(name, 30.0, OFFSET)
    series = of.displacement(np.array([of.extended_rad]), 1)
    assert series.value[0] == pytest.approx(OFFSET.stroke_mm, rel=1e-13)  # quadratic in the angle's error
    # A rounding error of the angle times the second derivative, some thousands at the most
    assert abs(series.derivative(1)[0]) <= 1e-9 * OFFSET.stroke_mm


def test_a_sign_error_of_the_offset_would_show() -> None:
    """Offset +100 and -100 differ by 11 degrees of working stroke."""
    forward, back = (machine("uniform", 30.0, CrankSlider(380.0, 960.0, side * 100.0)) for side in (1.0, -1.0))
    assert forward.extended_rad - back.extended_rad > 0.19


def test_a_peak_that_is_a_thousandth_of_the_cycle_wide_is_found() -> None:
    """A ratio of 1:250, which makes the slider's whole working stroke near one end of the cycle."""
    cosine = np.array([-2.250806469395375, -0.5788877717131287, 0.029454377666941874])
    sine = np.array([0.7367287720954889, -0.0056116134174584815])
    found = Machine(harmonic_law(cosine, sine, Lobes()), CrankSlider(380.0, 2294.8790550802387), PRESS, 60.0 * RPM)
    phi1 = np.linspace(6.27, 2.0 * pi, 20_001)
    sampled = float(np.max(np.abs(found.displacement(phi1, 2).derivative(2)))) * (60.0 * RPM) ** 2
    exact = kinematic_check(found).peak_acceleration_cycle.value
    assert sampled <= exact * (1.0 + 1e-12)
    assert exact == pytest.approx(sampled, rel=1e-5)


@at_once("name", LAWS)
@at_once("astray", [0.0, 1e-15])
def test_a_stroke_begins_at_its_dead_centre(name: str, astray: float) -> None:
    """Though the law's angle is a rounding error before it; the force is in the tables' first and last row."""
    of = machine(name, 30.0, load=SliderLoad(PolynomialResistance((400.0,))))
    ends = np.array([0.0, of.linkage.working_angle_rad, 2.0 * pi])
    assert of.working(ends - astray).tolist() == [True, False, True]
    assert of.motion(np.array([0.0, of.transmission.cycle_rad])).load.tolist() == [400.0, 400.0]


def test_a_law_that_begins_a_rounding_error_early_meets_its_force() -> None:
    """A rounding error of its own begins this law early or late, as the processor has it; here it begins early."""
    exact = ratio_expression_law("2 + 0.5*cos(phi) + 0.1*sin(2*phi)", Lobes(1, 2), scale_to_close=True)
    early = tuple(
        replace(piece, driven_angle=lambda phi1, order, of=piece.driven_angle: of(phi1, order) - 1e-15)
        for piece in exact.pieces
    )
    pump = replace(exact, pieces=early)
    assert pump.driven_angle(np.zeros(1)).value[0] < 0.0
    of = Machine(pump, CrankSlider(30.0, 120.0), SliderLoad(PolynomialResistance((400.0,))), 1.0)
    assert of.motion(np.zeros(1)).load[0] == 400.0


@at_once("count", [1, 2, 5, 16, 37])
def test_stretches_of_even_speed_reach_as_far_as_a_plain_search_finds(count: int) -> None:
    """The last sample up to which the fastest is no more than so many times the slowest."""
    speed = np.random.default_rng(count).uniform(1.0, 1.5, count)
    last, highest, lowest = _reach(speed, 1.3)
    for first in range(count):
        fits = [
            end for end in range(first, count) if speed[first : end + 1].max() <= 1.3 * speed[first : end + 1].min()
        ]
        end = next(one for one in fits if one + 1 not in fits)
        of = speed[first : end + 1]
        assert (last[first], highest[first], lowest[first]) == (end, of.max(), of.min())
