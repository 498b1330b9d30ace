"""What a makeable law is held to, place by place: against the jets of the machine, the pitch curves, and 30 digits."""

from __future__ import annotations

from dataclasses import replace
from math import pi, sqrt

import mpmath
import numpy as np
import pytest

from at_once import at_once
from ncgear.kinematics.motion import Machine
from ncgear.mechanisms.crank_slider import CrankSlider
from ncgear.numerics.arrays import Array
from ncgear.optimum.makeable import quantities
from ncgear.optimum.makeable.levels import WishLevel
from ncgear.optimum.makeable.places import CellPlaces, cell_ends, places, slider_at
from ncgear.optimum.makeable.quantities import RatioPlace, Slider
from ncgear.optimum.makeable.reached import JudgedLaw, lengths, ratios
from ncgear.optimum.makeable.spline import even_knots
from ncgear.optimum.task import Task, figures
from ncgear.pitch import shape
from ncgear.pitch.arc_length import arc_length
from ncgear.pitch.shape import Gear, Mesh
from ncgear.ratio.laws.spline import even_steps, spline_ratio_law
from ncgear.ratio.transmission import Lobes, Transmission, single
from published import BALER_LINKAGE, OFFSET, PRESS

SPEED = 5.0
KNOTS = 48
STEPS = 16
SEEDS = range(6)


def logarithm(seed: int) -> Array:
    """ln i12 at the knots: harmonics that fall off fast enough for dents to be shallow, slow enough to leave some."""
    random, waves = np.random.default_rng(seed), np.arange(1.0, 9.0)
    cosine, sine = random.normal(size=(2, 8)) * 0.3 / waves**2
    turned = np.outer(even_steps(KNOTS), waves)
    return np.asarray(np.cos(turned) @ cosine + np.sin(turned) @ sine)


def linkage(seed: int) -> CrankSlider:
    return (BALER_LINKAGE, OFFSET, CrankSlider(380.0, 456.0, -40.0))[seed % 3]


def lobes(seed: int) -> Lobes:
    return Lobes(1 + seed % 2)


def transmission(seed: int) -> Transmission:
    return spline_ratio_law(even_steps(KNOTS), np.exp(logarithm(seed)), lobes(seed))


def task(seed: int) -> Task:
    return Task(linkage(seed), PRESS, SPEED, lobes(seed), linkage(seed).MASSES(slider_kg=70.0))


def on_places(seed: int, steps: int = STEPS) -> tuple[CellPlaces, RatioPlace]:
    """All places of a turn, so many steps between two knots, and the ratio there as the optimiser sees it."""
    knots = even_knots(KNOTS)
    on = places(task(seed), cell_ends(task(seed), knots.angle_rad, []), steps)
    coefficients = knots.coefficients(logarithm(seed))
    return on, ratios(on, knots.rows(on.angle_rad), coefficients, [lobes(seed).driving_period_rad])[0]


def driving_angles(law: Transmission, phi2: Array) -> Array:
    """phi1 at driven angles of the first cycle, by Newton's method on the law."""
    phi1 = phi2 * law.cycle_rad / (2.0 * pi)
    for _ in range(60):
        driven = law.driven_angle(phi1, 1)
        phi1 = np.clip(phi1 - 0.7 * (driven.value - phi2) / driven.derivative(1), 0.0, law.cycle_rad * (1.0 - 1e-15))
    for _ in range(3):
        driven = law.driven_angle(phi1, 1)
        phi1 = np.clip(phi1 - (driven.value - phi2) / driven.derivative(1), 0.0, law.cycle_rad * (1.0 - 1e-15))
    assert np.abs(law.driven_angle(phi1, 0).value - phi2).max() < 1e-12
    return phi1


def close(found: Array, exact: Array) -> bool:
    """Equal to rounding, against the largest."""
    return bool(np.abs(found - exact).max() <= 1e-9 * np.abs(exact).max())


@at_once("seed", SEEDS)
def test_motion_against_the_jets_of_the_machine(seed: int) -> None:
    on, at = on_places(seed)
    machine = Machine(transmission(seed), linkage(seed), PRESS, SPEED)
    displacement = machine.displacement(driving_angles(machine.transmission, on.angle_rad), 3)
    exact = [displacement.derivative(order) * SPEED**order for order in (1, 2, 3)]
    assert close(quantities.velocity(at, on.slider, SPEED), exact[0])
    assert close(quantities.acceleration(at, on.slider, SPEED), exact[1])
    assert close(quantities.jerk(at, on.slider, SPEED), exact[2])
    force = np.where(on.angle_rad < linkage(seed).working_angle_rad, PRESS.working.force_n(displacement.value), 0.0)
    assert close(quantities.power(at, on.slider, SPEED), force * exact[0] / 1e3)
    moved = (force + 70.0 * exact[1] / 1e3) * exact[0] / 1e3
    assert close(quantities.driving_torque(at, on.slider, SPEED) * SPEED / 1e3, moved)


@at_once("seed", SEEDS)
def test_curves_against_the_pitch_curves(seed: int) -> None:
    on, at = on_places(seed)
    law = transmission(seed)
    (piece,) = law.pieces
    slope = piece.slope(driving_angles(law, on.angle_rad), 3)
    assert close(quantities.tangent(at), -shape.tangent_slope(slope, Mesh.EXTERNAL).value)
    for gear, curvature, bulge in (
        (Gear.DRIVING, quantities.driving_curvature, quantities.driving_bulge),
        (Gear.DRIVEN, quantities.driven_curvature, quantities.driven_bulge),
    ):
        exact = shape.curvature(slope, gear, Mesh.EXTERNAL).value
        assert close(curvature(at), exact)
        assert np.array_equal(np.sign(bulge(at)), np.sign(exact))
    # Length per unit of phi1, turned into one per unit of phi2.
    rate = shape.speed(slope, Gear.DRIVING, Mesh.EXTERNAL).value / slope.value[: slope.value.size]
    assert close(quantities.length_rate(at), rate)
    # Simpson's rule misses 1e-9 with sixteen steps between knots, and 256 times less with 64
    finer, there = on_places(seed, 4 * STEPS)
    assert lengths(finer, [there])[0] == pytest.approx(arc_length(law, Mesh.EXTERNAL).period, rel=1e-10)


@pytest.mark.thorough
def test_the_random_laws_are_no_easy_ones() -> None:
    """Some curves among them are dented and some are not, or the signs above would prove nothing."""
    dented = [bool(np.any(quantities.driving_bulge(on_places(seed)[1]) < 0.0)) for seed in range(12)]
    assert any(dented)
    assert not all(dented)


@pytest.mark.thorough
def test_thirty_digits_from_the_radii() -> None:
    """r1 = a/(1 + i) and r2 = a i/(1 + i) in polar coordinates, and time as the driving angle, by mpmath alone."""
    cosine, sine = (0.3, -0.05), (0.1, 0.02)
    with mpmath.workdps(30):
        series = lambda t: sum(  # noqa: E731
            mpmath.mpf(c) * mpmath.cos(k * t) + mpmath.mpf(s) * mpmath.sin(k * t)
            for k, c, s in zip((1, 2), cosine, sine, strict=True)
        )
        mean = mpmath.quad(lambda t: mpmath.exp(series(t)), [0, mpmath.pi, 2 * mpmath.pi]) / (2 * mpmath.pi)
        ratio = lambda t: mpmath.exp(series(t)) / mean  # noqa: E731

        def by_driving(quantity, t):  # type: ignore[no-untyped-def]
            return mpmath.diff(quantity, t) / ratio(t)

        def curvature(radius, by_angle, t):  # type: ignore[no-untyped-def]
            first = by_angle(radius, t)
            second = by_angle(lambda u: by_angle(radius, u), t)
            r = radius(t)
            return (r**2 + 2 * first**2 - r * second) / (r**2 + first**2) ** mpmath.mpf(1.5)

        r1, r2 = (lambda t: 1 / (1 + ratio(t))), (lambda t: ratio(t) / (1 + ratio(t)))
        slider = lambda t: mpmath.sqrt(960**2 - (380 * mpmath.sin(t)) ** 2) - 380 * mpmath.cos(t)  # noqa: E731
        velocity = lambda t: by_driving(slider, t) * SPEED  # noqa: E731
        acceleration = lambda t: by_driving(velocity, t) * SPEED  # noqa: E731
        log = lambda u: mpmath.log(ratio(u))  # noqa: E731
        for angle in (0.47, 2.67, 4.55):
            t = mpmath.mpf(angle)
            of = (log(t), ratio(t), 1 / ratio(t), mpmath.diff(log, t), mpmath.diff(log, t, 2))
            found = RatioPlace(*(float(value) for value in of))
            (columns,) = zip(*slider_at(Task(BALER_LINKAGE, PRESS, SPEED), np.array([angle])), strict=True)
            slides = Slider(*map(float, columns))
            turns2 = lambda q, u: mpmath.diff(q, u)  # noqa: E731
            pairs = (
                (quantities.acceleration(found, slides, SPEED), acceleration(t)),
                (quantities.jerk(found, slides, SPEED), by_driving(acceleration, t) * SPEED),
                (quantities.tangent(found), -by_driving(r1, t) / r1(t)),
                (quantities.driving_curvature(found), curvature(r1, by_driving, t)),
                (quantities.driven_curvature(found), curvature(r2, turns2, t)),
                (quantities.length_rate(found), mpmath.sqrt(r2(t) ** 2 + mpmath.diff(r2, t) ** 2)),
            )
            for value, exact in pairs:
                assert float(value) == pytest.approx(float(exact), rel=1e-9)


def peaks(seed: int, steps: int) -> tuple[Array, Array]:
    """Largest acceleration, ratio, tangent, driving and driven curvature: with parabolas, and at the places alone."""
    on, at = on_places(seed, steps)
    terms = (
        quantities.acceleration(at, on.slider, SPEED),
        at.log,
        quantities.tangent(at),
        quantities.driving_curvature(at),
        quantities.driven_curvature(at),
    )
    levels = [
        WishLevel(
            "acceleration", None, 0.0, lambda at, slider, _: both(quantities.acceleration(at, slider, SPEED)), str
        ),
        WishLevel("ratio", None, 0.0, lambda at, *_: (at.log,), str),
        WishLevel("tangent", None, 0.0, lambda at, *_: both(quantities.tangent(at)), str),
        WishLevel("driving", None, 0.0, lambda at, *_: both(quantities.driving_curvature(at)), str),
        WishLevel("driven", None, 0.0, lambda at, *_: both(quantities.driven_curvature(at)), str),
    ]
    alone = [np.max(term) if number == 1 else np.max(np.abs(term)) for number, term in enumerate(terms)]
    return JudgedLaw(levels, on, [at]).reached, np.array(alone)


def both(term: Array) -> tuple[Array, Array]:
    return term, -term


def exact_peaks(seed: int) -> Array:
    """The same from extrema located on the closed forms."""
    law = transmission(seed)
    found = figures(replace(task(seed), masses=None), single(law))
    curves = []
    for gear in Gear:
        ends = law.extremes(lambda slope, gear=gear: shape.curvature(slope, gear, Mesh.EXTERNAL), 2)
        curves.append(max(abs(end.value) for end in ends))
    steep = np.tan(found.tangent_rad)
    return np.array([found.peak_acceleration_mm_s2, np.log(found.ratio_max), steep, *curves])


@pytest.mark.slow
@pytest.mark.parametrize("seed", SEEDS)
def test_peaks_between_the_places_are_found(seed: int) -> None:
    exact = exact_peaks(seed)
    assert peaks(seed, 32)[0] == pytest.approx(exact, rel=2e-7)


@pytest.mark.long
@pytest.mark.slow
def test_peaks_are_missed_by_the_third_power_and_at_places_alone_by_the_second() -> None:
    """Four times as many places: 64 and 16 times less, in the mean.  Places alone are the control.

    With a step h between places, a parabola through -h, 0 and h misses by c x (x^2 - h^2) / 6, 0.046 c h^3 in the mean
    of all x, where c is the third derivative; places alone miss by b x^2 / 2, 0.056 b h^2, where b is the second one.
    Waves up to the eighth have c below 8 b, so that parabolas miss less than 0.82 times 8 h of what places alone miss.
    """
    misses = {}
    for steps in (4, 16):
        found = [(peaks(seed, steps), exact_peaks(seed)) for seed in range(12)]
        misses[steps] = [
            np.sqrt(np.mean([((values[way] - exact) / exact) ** 2 for values, exact in found])) for way in (0, 1)
        ]
    (smooth, alone), (fine_smooth, fine_alone) = misses[4], misses[16]
    assert 8.0 < alone / fine_alone < 32.0
    assert 32.0 < smooth / fine_smooth < 128.0
    for steps, (parabolas, places_alone) in misses.items():
        assert parabolas < 0.82 * 8.0 * (2.0 * pi / (KNOTS * steps)) * places_alone


@pytest.mark.slow
def test_places_alone_never_exceed_the_peak() -> None:
    for seed in SEEDS:
        assert np.all(peaks(seed, 4)[1] <= exact_peaks(seed) * (1.0 + 1e-12))


def test_a_circle_pair_is_known() -> None:
    """A ratio that stays: two circles, whatever the lobes."""
    knots, machine = even_knots(24), Task(BALER_LINKAGE, PRESS, SPEED)
    on = places(machine, cell_ends(machine, knots.angle_rad, []), 2)
    at = ratios(on, knots.rows(on.angle_rad), np.zeros(24), [pi])[0]
    assert at.ratio == pytest.approx(np.full(on.count, 0.5), rel=1e-15)
    assert quantities.driving_curvature(at) == pytest.approx(np.full(on.count, 1.5), rel=1e-14)
    assert quantities.driven_curvature(at) == pytest.approx(np.full(on.count, 3.0), rel=1e-14)
    assert lengths(on, [at])[0] == pytest.approx(2.0 * pi / 3.0, rel=1e-14)
    assert sqrt(float(np.max(quantities.tangent(at) ** 2))) == 0.0
