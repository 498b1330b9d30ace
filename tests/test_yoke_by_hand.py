"""Motions of a Scotch yoke on even gears, x = r (1 - cos phi), by closed forms, and the waves of a crank-slider."""

from __future__ import annotations

from math import acos, asin, cos, pi, sin, sqrt
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from at_once import at_once
from ncgear.kinematics import check, crank_stretches
from ncgear.kinematics.crank_stretches import CrankStretch, End, Stroke
from ncgear.kinematics.motion import Machine, angles_at, cut, sample_angles, stretches
from ncgear.mechanisms.crank_slider import CrankSlider
from ncgear.mechanisms.resistance import PolynomialResistance
from ncgear.mechanisms.scotch_yoke import ScotchYoke
from ncgear.mechanisms.slider_load import SliderLoad
from ncgear.ratio.laws.uniform import uniform_law
from ncgear.ratio.transmission import Lobes

Made: Any = SimpleNamespace

CRANK_MM, SPEED = 30.0, 2.0

LOAD = SliderLoad(PolynomialResistance((50.0,)), PolynomialResistance((20.0,)))


def yoke(lobes: Lobes | None = None) -> Machine:
    """A machine whose driven angle is the driving one, or half of it."""
    return Machine(uniform_law(lobes or Lobes()), ScotchYoke(CRANK_MM), LOAD, SPEED)


@pytest.mark.judges("kinematics")
@at_once("degrees", [0.0, 30.0, 100.0, 179.0, 181.0, 270.0, 359.0])
@at_once("lobes", [Lobes(), Lobes(1, 2)])
def test_a_yokes_slider_swings_as_a_cosine(degrees: float, lobes: Lobes) -> None:
    """50 N on the way out and 20 N on the way back, at 2 rad/s of the driving gear."""
    machine, crank = yoke(lobes), np.radians(degrees)
    turned = lobes.even_slope
    found = machine.motion(np.array([crank / turned]))
    force = 50.0 if crank < pi else 20.0
    assert found.ratio == pytest.approx(1.0 / turned)
    assert found.displacement == pytest.approx(CRANK_MM * (1.0 - cos(crank)))
    assert found.velocity == pytest.approx(CRANK_MM * sin(crank) * SPEED * turned, abs=1e-9)
    assert found.acceleration == pytest.approx(CRANK_MM * cos(crank) * (SPEED * turned) ** 2)
    assert found.load == pytest.approx(force)
    assert found.power_w == pytest.approx(force * CRANK_MM * abs(sin(crank)) * SPEED * turned / 1000.0, abs=1e-9)


@pytest.mark.judges("kinematics")
@at_once("lobes", [Lobes(), Lobes(1, 2)])
def test_peaks_of_a_yoke_are_those_of_sine_and_cosine(lobes: Lobes) -> None:
    machine, turned = yoke(lobes), lobes.even_slope
    omega = SPEED * turned
    found = check.kinematic_check(machine)
    assert found.speed_rpm == pytest.approx(SPEED * 30.0 / pi)
    assert (found.peak_speed.value, found.peak_power_w.value) == pytest.approx(
        (CRANK_MM * omega, 50.0 * CRANK_MM * omega / 1000.0)
    )
    assert found.peak_power_w.at == pytest.approx(pi / 2.0 / turned)
    assert found.mean_power_w == pytest.approx(70.0 * 2.0 * CRANK_MM / 1000.0 * omega / (2.0 * pi))
    assert (found.peak_acceleration_working.value, found.peak_acceleration_cycle.value) == pytest.approx(
        2 * [CRANK_MM * omega**2]
    )
    jerk = check.peak_jerk(machine)
    assert jerk is not None
    assert jerk.value == pytest.approx(CRANK_MM * omega**3)
    assert jerk.at * turned % pi == pytest.approx(pi / 2.0)
    assert check.acceleration_rms_above(machine, 0) == pytest.approx(CRANK_MM * omega**2 / sqrt(2.0))
    assert check.stroke_error_mm(machine) == pytest.approx(0.0, abs=1e-10)
    twice = check.at_speed(found, 2.0 * found.speed_rpm)
    assert (twice.peak_speed.value, twice.mean_power_w) == pytest.approx(
        (2.0 * found.peak_speed.value, 2.0 * found.mean_power_w)
    )
    assert twice.peak_power_w.value == pytest.approx(2.0 * found.peak_power_w.value)
    assert twice.peak_acceleration_working.value == pytest.approx(4.0 * found.peak_acceleration_working.value)
    assert twice.peak_acceleration_cycle.value == pytest.approx(4.0 * found.peak_acceleration_cycle.value)


@pytest.mark.judges("kinematics")
@pytest.mark.parametrize("order", [0, 1, 2, 3])
def test_waves_of_an_acceleration_above_an_order_are_those_of_fourier(order: int) -> None:
    """A crank of 30 mm, a rod of 80 mm and an offset of 9 mm: the acceleration by the second derivative of waves."""
    machine = Machine(uniform_law(Lobes()), CrankSlider(30.0, 80.0, 9.0), LOAD, SPEED)
    turned = 2.0 * pi * np.arange(512) / 512.0
    place = 30.0 * np.cos(turned) + np.sqrt(80.0**2 - (30.0 * np.sin(turned) - 9.0) ** 2)
    waves = np.fft.rfft(place) / 512.0 * np.arange(257) ** 2 * SPEED**2
    assert check.acceleration_rms_above(machine, order) == pytest.approx(
        sqrt(2.0 * float((np.abs(waves[order + 1 :]) ** 2).sum())), rel=1e-8
    )


@pytest.mark.judges("kinematics")
@pytest.mark.parametrize("stroke", list(Stroke))
@pytest.mark.parametrize("tolerance", [0.01, 0.1, 0.3])
def test_a_yoke_is_most_even_about_the_middle_of_its_stroke(tolerance: float, stroke: Stroke) -> None:
    """Speeds between the greatest one and (1 - t) / (1 + t) of it: a way of 2 r cos(asin((1 - t) / (1 + t)))."""
    found = crank_stretches.longest_even_stretch(yoke(), stroke, tolerance)
    share = (1.0 - tolerance) / (1.0 + tolerance)
    half = acos(share)
    middle = pi / 2.0 if stroke is Stroke.WORKING else 1.5 * pi
    assert (found.start_rad, found.end_rad) == pytest.approx((middle - half, middle + half), abs=2e-3)
    assert found.length_mm == pytest.approx(2.0 * CRANK_MM * sin(half), rel=1e-6)
    assert (found.least_mm_s, found.most_mm_s) == pytest.approx((share * 60.0, 60.0), rel=2e-3)
    assert found.speed_mm_s == pytest.approx((1.0 + share) * 30.0, rel=2e-3)


@pytest.mark.judges("kinematics")
def test_the_longest_stretch_may_end_between_samples(monkeypatch: pytest.MonkeyPatch) -> None:
    """From the second place 3 mm and half of a step of 8 mm, which is more than 5 mm from the third one."""
    samples = Made(speed=np.ones(4), place_mm=np.array([0.0, 2.0, 5.0, 13.0]), phi1_rad=np.array([0.1, 0.2, 0.3, 0.4]))
    monkeypatch.setattr(crank_stretches, "stretches", lambda machine: [])
    monkeypatch.setattr(crank_stretches, "_sampled", lambda parts, most: samples)
    last = np.array([1, 2, 2, 3])
    monkeypatch.setattr(crank_stretches, "_reach", lambda speed, most: (last, np.full(4, 1.5), np.full(4, 0.9)))
    share = np.array([0.9, 0.5, 0.6, 0.0])
    monkeypatch.setattr(crank_stretches, "_beyond", lambda *_: (share, np.array([1.0, 1.2, 1.3, 1.4])))
    asked: list[Any] = []
    monkeypatch.setattr(crank_stretches, "_where", lambda machine, on, last, level: asked.append((last, level)) or 0.37)
    machine: Any = Made(speed_rad_s=SPEED, displacement=lambda phi1, order: Made(value=100.0 * phi1))
    found = crank_stretches.longest_even_stretch(machine, Stroke.WORKING, 0.1)
    assert asked == [(2, 1.2)]
    assert (found.start_rad, found.start_mm, found.end_rad) == (0.2, 2.0, 0.37)
    assert (found.end_mm, found.least_mm_s, found.most_mm_s) == pytest.approx((37.0, 1.8, 3.0))


# --- stretches of the crank angle


@pytest.mark.judges("kinematics")
@at_once("way", [0.0, 10.0, 59.0, 60.0, 61.0, 90.0, 119.0])
def test_a_way_beyond_a_stroke_goes_back(way: float) -> None:
    angle = crank_stretches.crank_at_way_rad(ScotchYoke(CRANK_MM), way)
    assert 0.0 <= angle <= 2.0 * pi
    place = CRANK_MM * (1.0 - cos(angle))
    assert place == pytest.approx(way if way <= 60.0 else 120.0 - way)
    assert (angle > pi) == (way > 60.0)


@pytest.mark.judges("kinematics")
@at_once(
    ("start", "end", "parts"),
    [
        (0.5, 1.0, [(0.5, 1.0, Stroke.WORKING)]),
        (3.0, 4.0, [(3.0, pi, Stroke.WORKING), (pi, 4.0, Stroke.RETURN)]),
        (-1.0, 0.5, [(2.0 * pi - 1.0, 2.0 * pi, Stroke.RETURN), (0.0, 0.5, Stroke.WORKING)]),
        (5.0, 7.0, [(5.0, 2.0 * pi, Stroke.RETURN), (0.0, 7.0 - 2.0 * pi, Stroke.WORKING)]),
        (6.0, 9.7, [
            (6.0, 2.0 * pi, Stroke.RETURN), (0.0, pi, Stroke.WORKING), (pi, 9.7 - 2.0 * pi, Stroke.RETURN)]),
    ],
)  # fmt: skip
def test_dead_centres_divide_a_stretch(start: float, end: float, parts: Any) -> None:
    found = crank_stretches.by_stroke(ScotchYoke(CRANK_MM), CrankStretch(start, end))
    assert [stroke for _, stroke in found] == [stroke for *_, stroke in parts]
    assert [tuple(one) for one, _ in found] == [pytest.approx(part[:2]) for part in parts]


@pytest.mark.judges("kinematics")
@at_once("within", [0.5, 6.0, 25.0])
def test_a_yoke_is_near_a_dead_centre_alike_on_both_sides(within: float) -> None:
    half = acos(1.0 - within / CRANK_MM)
    linkage = ScotchYoke(CRANK_MM)
    assert tuple(crank_stretches.about_end(linkage, End.RETRACTED, within)) == pytest.approx((-half, half))
    assert tuple(crank_stretches.about_end(linkage, End.EXTENDED, within)) == pytest.approx((pi - half, pi + half))
    for end in End:
        assert crank_stretches.nearest_dwell_mm(linkage, end, 3.0 * half, 1.5) == pytest.approx(within)


@pytest.mark.judges("kinematics")
@at_once(
    ("start", "end", "least", "most", "fall"),
    [
        (0.3, 1.0, sin(0.3), sin(1.0), 0.0),
        (1.0, 2.5, sin(2.5), 1.0, -cos(2.5)),
        (2.0, 3.5, 0.0, sin(2.0), 1.0),
        (3.5, 5.5, -sin(3.5), 1.0, cos(5.5)),
        (6.0, 6.9, 0.0, sin(6.9), 1.0),
        (1.2, 1.2, sin(1.2), sin(1.2), None),
    ],
)
def test_speeds_on_a_stretch_are_those_of_a_sine(
    start: float, end: float, least: float, most: float, fall: float | None
) -> None:
    """The crank turns at half the speed of the driving gear."""
    machine, stretch, omega = yoke(Lobes(1, 2)), CrankStretch(start, end), SPEED / 2.0
    found = crank_stretches.speeds_mm_s(machine, stretch)
    assert found == pytest.approx((CRANK_MM * least * omega, CRANK_MM * most * omega), abs=1e-6)
    if fall is not None:
        assert crank_stretches.deceleration_mm_s2(machine, stretch) == pytest.approx(CRANK_MM * fall * omega**2)
    assert crank_stretches.taken_rad(machine, stretch) == pytest.approx(2.0 * (end - start))
    assert tuple(stretch.rest) == pytest.approx((end, start + 2.0 * pi))


@pytest.mark.judges("kinematics")
@at_once("turns", [-2.3, -1.0, 0.0, 0.4, 1.0, 3.7])
@at_once("lobes", [Lobes(), Lobes(1, 2)])
def test_angles_of_crank_and_driving_gear_count_whole_turns(turns: float, lobes: Lobes) -> None:
    machine, crank = yoke(lobes), 2.0 * pi * turns
    assert crank_stretches.driving_rad(machine, crank) == pytest.approx(crank / lobes.even_slope)
    assert crank_stretches.crank_rad(machine, crank / lobes.even_slope) == pytest.approx(crank)


@pytest.mark.judges("kinematics")
def test_a_stroke_takes_the_time_of_its_crank_angle() -> None:
    """The crank goes clockwise from pi + asin(e / (l - r)), where the slider is near, to asin(e / (l + r))."""
    slider = CrankSlider(30.0, 80.0, 20.0)
    working = pi + asin(20.0 / 50.0) - asin(20.0 / 110.0)
    found = crank_stretches.time_ratio(Machine(uniform_law(Lobes()), slider, LOAD, SPEED))
    assert found == pytest.approx(working / (2.0 * pi - working))
    assert crank_stretches.time_ratio(yoke(Lobes(1, 2))) == pytest.approx(1.0)


@pytest.mark.judges("kinematics")
@at_once("lobes", [Lobes(), Lobes(1, 2)])
def test_a_stretch_is_cut_where_the_slider_passes_places(lobes: Lobes) -> None:
    out, back = stretches(yoke(lobes))[0], stretches(yoke(lobes))[-1]
    places = np.array([-5.0, 10.0, 42.0, 70.0])
    passed = np.arccos(1.0 - places[1:3] / CRANK_MM) / lobes.even_slope
    assert (out.working, back.working) == (True, False)
    assert angles_at(out, places) == pytest.approx(passed)
    ends = [(one.start_rad, one.end_rad) for one in cut(out, places)]
    assert ends == [pytest.approx(pair) for pair in ((0.0, passed[0]), tuple(passed), (passed[1], out.end_rad))]
    assert out.way_mm == pytest.approx(2.0 * CRANK_MM)
    middle = np.array([(back.start_rad + back.end_rad) / 2.0])
    assert back.speed(middle, 0).value == pytest.approx(CRANK_MM * lobes.even_slope)
    assert angles_at(out, np.zeros(0)).size == 0


@pytest.mark.judges("kinematics")
def test_samples_are_two_thousand_a_turn() -> None:
    for lobes, count, end in ((Lobes(), 2001, 2.0 * pi), (Lobes(1, 2), 4001, 4.0 * pi), (Lobes(2, 1), 2001, 2.0 * pi)):
        found = sample_angles(uniform_law(lobes))
        assert (found.size, found[0], found[-1]) == (count, 0.0, pytest.approx(end))
    ends = check.both_sides_rad([0.0, 1.0], 3.0)
    assert ends == pytest.approx([0.0, 1e-9, 1.0 - 1e-9, 1.0, 1.0 + 1e-9], rel=1e-12, abs=1e-15)
