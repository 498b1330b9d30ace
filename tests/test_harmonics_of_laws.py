"""Harmonics above an order and centre distances, least or limited: FFTs by other formulas, another search."""

from __future__ import annotations

from functools import cache
from math import cos, pi, radians
from pathlib import Path

import numpy as np
import pytest
from scipy.interpolate import CubicSpline
from scipy.optimize import minimize

from ncgear.design.reading.design_file import parsed
from ncgear.errors import DesignError
from ncgear.kinematics.check import acceleration_rms_above
from ncgear.kinematics.motion import Machine
from ncgear.mechanisms.crank_slider import CrankSlider
from ncgear.mechanisms.slider_load import SliderLoad
from ncgear.numerics.arrays import Array
from ncgear.numerics.quadrature import gauss_points, rms_above
from ncgear.optimum.makeable.law import EVEN, kept_law
from ncgear.optimum.makeable.search import searched
from ncgear.project.best_law import BestLaw
from ncgear.ratio.laws.uniform import uniform_law
from ncgear.ratio.transmission import Lobes

HEAD = """\
name: a
linkage: {crank_mm: 60, rod_mm: 200}
operation: {speed_rpm: 60}
motion: {law: uniform_crank}
gears: {teeth: 60, module_mm: 2, face_width_mm: 20}
resistance: {polynomial_n: [500]}
"""
"""A stroke of 120 mm in a second against 500 N on the way out."""

POWER_W = 90.0
"""Three quarters of an even crank's: laws that keep it are not even."""

SAMPLES = 4096


@cache
def best(optimize: str) -> BestLaw:
    return BestLaw(parsed(f"{HEAD}optimize: {{knots: 48, {optimize}}}\n", Path("d.yaml")).design)


def above(lines: Array, order: int) -> float:
    """Root mean square of the lines of a real transform above an order."""
    return float(np.sqrt(2.0 * np.sum(np.abs(lines[order + 1 :]) ** 2)))


def heard(ratio: Array, order: int) -> tuple[float, float, float, float]:
    """Harmonics of acceleration in mm/s2 and of torque in N m, peak power in W, teeth's curve over centre distance.

    ``ratio`` is at even crank angles: a periodic cubic spline of its logarithm, its integral at many crank angles, the
    slider's place by Pythagoras at even driving angles, and the rest by a fast Fourier transform.
    """
    knots = np.linspace(0.0, 2.0 * pi, ratio.size + 1)
    logarithm = CubicSpline(knots, np.log(np.append(ratio, ratio[0])), bc_type="periodic")
    crank = np.linspace(0.0, 2.0 * pi, 12_001)
    driving = CubicSpline(crank, np.exp(logarithm(crank))).antiderivative()(crank)
    driving *= 2.0 * pi / driving[-1]
    phi2 = CubicSpline(driving, crank)(2.0 * pi * np.arange(SAMPLES) / SAMPLES)
    out = -60.0 * np.cos(phi2) + np.sqrt(200.0**2 - (60.0 * np.sin(phi2)) ** 2)
    lines, number = np.fft.rfft(out), np.arange(SAMPLES // 2 + 1)
    speed = np.fft.irfft(lines * 1j * number) * 2.0 * pi
    torque = np.where(speed > 0.0, 500.0 * speed, 0.0) / 1e3 / (2.0 * pi)
    acceleration = lines / SAMPLES * (2.0 * pi * number) ** 2
    i = np.exp(logarithm(crank))
    slope = i * logarithm(crank, 1)
    curve = np.trapezoid(np.sqrt((i / (1.0 + i)) ** 2 + (slope / (1.0 + i) ** 2) ** 2), crank)
    return (
        above(acceleration, order),
        above(np.fft.rfft(torque) / SAMPLES, order),
        float(torque.max() * 2.0 * pi),
        curve,
    )


def test_what_waves_leave_above_an_order() -> None:
    points, weights = gauss_points(np.linspace(1.0, 4.0, 40), 16)
    angle = 2.0 * pi / 3.0 * points
    values = 5.0 + 3.0 * np.cos(2.0 * angle + 1.0) + 0.4 * np.sin(7.0 * angle) + 1e-9 * np.cos(12.0 * angle)
    assert rms_above(points, weights, values, 0) == pytest.approx(np.sqrt((9.0 + 0.16) / 2.0))
    assert rms_above(points, weights, values, 6) == pytest.approx(0.4 / np.sqrt(2.0))
    assert rms_above(points, weights, values, 7) == pytest.approx(1e-9 / np.sqrt(2.0), rel=1e-5)


def test_harmonics_of_a_crank_with_an_offset() -> None:
    """The slider's place by Pythagoras at 2^12 even angles, its acceleration by the transform itself."""
    machine = Machine(uniform_law(Lobes()), CrankSlider(40.0, 110.0, 25.0), SliderLoad(), 7.0)
    angle = 2.0 * pi * np.arange(SAMPLES) / SAMPLES
    place = 40.0 * np.cos(angle) + np.sqrt(110.0**2 - (25.0 - 40.0 * np.sin(angle)) ** 2)
    lines = np.fft.rfft(place) / SAMPLES * (7.0 * np.arange(SAMPLES // 2 + 1)) ** 2
    for order in (1, 3, 6):
        assert acceleration_rms_above(machine, order) == pytest.approx(above(lines, order), rel=1e-7)


@pytest.mark.slow
def test_levels_of_the_search_are_the_harmonics() -> None:
    """Beside themselves high harmonics count a hundredth of the whole; without an order the whole counts."""
    limits = (
        "acceleration_harmonics_mm_s2: 9e5, torque_harmonics_n_m: 9e5, rms_torque_n_m: 9e5, center_distance_mm: 9e5"
    )
    asked = best(f"harmonics_above: 3, goal: least_power, limits: {{pressure_angle_deg: 45, {limits}}}")
    task, search = asked.begun.task, searched(asked.begun.task, asked.wishes)
    law = kept_law(task, asked.wishes, EVEN)
    assert law is not None
    reached = zip(search.programme.levels, search.judged(law.ratio[None, :]).reached, strict=True)
    told = {level.wish: share / level.cap * 9e5 for level, share in reached if level.cap}
    high, whole = heard(law.ratio, 3), heard(law.ratio, 0)
    for name, number in (("acceleration_harmonics_mm_s2", 0), ("torque_harmonics_n_m", 1)):
        mean = 500.0 * 0.12 / (2.0 * pi) if number else 0.0
        assert told[name] == pytest.approx(np.hypot(high[number], 0.01 * np.hypot(whole[number], mean)), rel=3e-4)
    assert told["center_distance_mm"] == pytest.approx(120.0 * pi / high[3], rel=1e-5)


@pytest.mark.slow
@pytest.mark.parametrize("goal", ["acceleration", "torque"])
def test_the_least_harmonics(goal: str) -> None:
    """Judged by the transform; another search, of eight harmonics of ln i by SLSQP, comes as low and not lower."""
    number = ("acceleration", "torque").index(goal)
    found = best(
        f"harmonics_above: 2, goal: least_{goal}_harmonics, limits: {{peak_power_w: {POWER_W}, convex: false}}"
    )
    own = heard(found.law.ratio, 2)
    told = found.figures.acceleration_harmonics_mm_s2, found.figures.torque_harmonics_n_m
    assert told[number] == pytest.approx(own[number], rel=1e-3)
    assert own[2] <= POWER_W * (1.0 + 1e-6)
    assert found.bound is None
    angle = np.linspace(0.0, 2.0 * pi, 48, endpoint=False)
    waves = np.array([shape(wave * angle) for wave in range(1, 5) for shape in (np.cos, np.sin)])

    def ratio(sizes: Array) -> Array:
        return np.exp(sizes @ waves)

    def goal_of(sizes: Array) -> float:
        high, whole = heard(ratio(sizes), 2), heard(ratio(sizes), 0)
        return float(np.hypot(high[number], 0.01 * whole[number])) / own[number]

    room = {"type": "ineq", "fun": lambda sizes: 1.0 - heard(ratio(sizes), 2)[2] / POWER_W}
    # Beside the law itself, less what eight harmonics cannot follow
    start = waves @ np.log(found.law.ratio) / 24.0
    other = minimize(
        goal_of, start, method="SLSQP", constraints=[room], options={"maxiter": 40}, bounds=[(-0.6, 0.6)] * 8
    )
    high, whole = own[number], heard(found.law.ratio, 0)[number]
    ours = float(np.hypot(high, 0.01 * whole)) / own[number]
    assert other.fun >= ours * (1.0 - 0.02)
    assert room["fun"](other.x) > -1e-4


@pytest.mark.slow
def test_a_limit_of_harmonics_is_kept() -> None:
    """Least power under half the harmonics of the law of least power; the torque's mean square weighs in a sum."""
    free = best("harmonics_above: 5, goal: least_power, limits: {pressure_angle_deg: 45, torque_harmonics_n_m: 1e3}")
    most = 0.5 * free.figures.torque_harmonics_n_m
    kept = best(
        f"harmonics_above: 5, goal: least_power, limits: {{pressure_angle_deg: 45, torque_harmonics_n_m: {most}}}"
    )
    assert heard(kept.law.ratio, 5)[1] <= most * (1.0 + 1e-3)
    assert kept.figures.peak_power_w > free.figures.peak_power_w
    assert "harmonics of the torque" in kept.not_covered
    weighed = [
        best(f"goal: weighted, weights: {{power_w: 100, rms_torque_n_m: {share}}}, limits: {{pressure_angle_deg: 45}}")
        for share in (10.0, 1.0)
    ]
    for one in weighed:
        assert one.bound is not None
        assert one.bound.value <= one.goal
        assert all(one.goal <= one.wishes.prices.of(other.figures) * (1.0 + 1e-4) for other in weighed)


@pytest.mark.slow
def test_a_limit_of_the_centre_distance() -> None:
    """60 teeth of 2 mm on round gears are 120 mm apart; the file's own pair is judged."""
    held = best("goal: least_power, limits: {pressure_angle_deg: 45, center_distance_mm: 118}")
    assert held.figures.center_distance_mm == pytest.approx(120.0 * pi / heard(held.law.ratio, 1)[3], rel=1e-6)
    assert held.figures.center_distance_mm <= 118.0
    # The uniform crank's gears, whose forces stand beside the law's, are as far apart as the law's gears.
    assert held.uniform_figures.center_distance_mm == pytest.approx(held.figures.center_distance_mm, rel=1e-9)
    least = best("goal: least_center_distance, limits: {pressure_angle_deg: 45}")
    assert least.bound is not None
    # No curve is longer than the way across the line of centres over the cosine of its greatest angle
    assert least.bound.value == pytest.approx(120.0 * cos(radians(25.0)), rel=1e-6)
    assert least.bound.value < least.goal < held.figures.center_distance_mm


@pytest.mark.parametrize("gears", ["", "gears: {teeth: 60, center_distance_mm: 120, face_width_mm: 20}\n"])
def test_a_centre_distance_needs_teeth_and_module(gears: str) -> None:
    text = HEAD.replace("gears: {teeth: 60, module_mm: 2, face_width_mm: 20}\n", gears)
    design = parsed(f"{text}optimize: {{limits: {{center_distance_mm: 100}}}}\n", Path("d.yaml")).design
    with pytest.raises(DesignError, match=r"give gears\.teeth and gears\.module_mm") as refused:
        _ = BestLaw(design).begun
    assert refused.value.key == "optimize.limits.center_distance_mm"
