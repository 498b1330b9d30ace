"""What a motion achieves and wishes of it: closed forms on a Scotch yoke, dense samples, requirements by quadrature."""

from __future__ import annotations

from collections import deque
from dataclasses import replace
from math import acos, asin, cos, degrees, log, pi, radians, sin, sqrt
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import quad

from at_once import at_once
from conftest import Run
from drives import drive, drive_of_text
from ncgear.kinematics import crank_stretches
from ncgear.kinematics.crank_stretches import CrankStretch, End, Stroke, longest_even_stretch, nearest_dwell_mm, spread
from ncgear.kinematics.motion import Machine
from ncgear.mechanisms.crank_slider import CrankSlider
from ncgear.mechanisms.mechanism import Mechanism
from ncgear.mechanisms.resistance import PolynomialResistance
from ncgear.mechanisms.scotch_yoke import ScotchYoke
from ncgear.numerics.jet import Jet
from ncgear.ratio.laws.harmonic import harmonic_law
from ncgear.ratio.laws.uniform import uniform_law
from ncgear.ratio.transmission import Lobes
from ncgear.wishes.constant_speed import ConstantSpeed
from ncgear.wishes.dwell import Dwell
from ncgear.wishes.gentle_stop import GentleSpeed, GentleStop
from ncgear.wishes.positions import Position
from ncgear.wishes.requirements import DrivingRange, EvenSpeed, Requirement, SpeedWithin, TimeWithin
from ncgear.wishes.speed_at import ExtremeSpeed, SpeedAt
from ncgear.wishes.time_ratio import TimeRatio
from ncgear.wishes.wish import EVEN, Wish, achieved, near_mm
from ncgear.wishes.working_stroke import WorkingStroke

pytestmark = pytest.mark.judges("kinematics", "wishes")

RADIUS = 100.0
YOKE = ScotchYoke(RADIUS)
OFFSET = CrankSlider(380.0, 960.0, 120.0)
W = 2.0 * pi


def uniform(linkage: Mechanism = YOKE) -> Machine:
    """A crank that turns evenly, once a second."""
    return Machine(uniform_law(Lobes()), linkage, PolynomialResistance(), W)


def at_random(seed: int, linkage: Mechanism = OFFSET) -> Machine:
    """A law of five harmonics whose ratio stays within 5 of one."""
    generator = np.random.default_rng(seed)
    cosine, sine = generator.normal(0.0, 0.3, (2, 5)) / np.arange(1.0, 6.0)
    return Machine(harmonic_law(cosine, sine, Lobes()), linkage, PolynomialResistance(), W)


def dense(machine: Machine, stroke: Stroke, count: int = 40_001) -> tuple[np.ndarray, np.ndarray]:
    """Places and speeds of a stroke at even driving angles."""
    ends = (0.0, machine.extended_rad) if stroke is Stroke.WORKING else (machine.extended_rad, 2.0 * pi)
    jet = machine.displacement(np.linspace(*ends, count), 1)
    return jet.value, np.abs(jet.derivative(1))


def longest_between_samples(place: np.ndarray, speed: np.ndarray, most: float) -> tuple[float, float]:
    """The longest way between two samples within the spread, and the longest step: two ends that follow each other."""
    tops: deque[int] = deque()
    lows: deque[int] = deque()
    first, best = 0, 0.0
    for last in range(speed.size):
        while tops and speed[tops[-1]] <= speed[last]:
            tops.pop()
        while lows and speed[lows[-1]] >= speed[last]:
            lows.pop()
        tops.append(last)
        lows.append(last)
        while speed[tops[0]] > most * speed[lows[0]]:
            first += 1
            if tops[0] < first:
                tops.popleft()
            if lows[0] < first:
                lows.popleft()
        best = max(best, abs(place[last] - place[first]))
    return best, float(np.abs(np.diff(place)).max())


@pytest.mark.parametrize("tolerance", [0.001, 0.005, 0.1])
def test_the_even_stretch_of_an_even_yoke(tolerance: float) -> None:
    """Its speed r w sin(phi) is within the spread R about its peak as long as sin(phi) is over 1/R."""
    length = 2.0 * RADIUS * sqrt(1.0 - 1.0 / spread(tolerance) ** 2)
    for stroke in Stroke:
        found = longest_even_stretch(uniform(), stroke, tolerance)
        # Rounding, and what speeds count as alike by: 1e-9 of the speed, where the length goes with its root.
        assert found.length_mm == pytest.approx(length, rel=1e-6)
        assert found.most_mm_s == pytest.approx(RADIUS * W, rel=1e-9)
        assert found.least_mm_s == pytest.approx(RADIUS * W / spread(tolerance), rel=1e-8)
        assert found.speed_mm_s == pytest.approx(RADIUS * W / (1.0 + tolerance), rel=1e-8)
        ends = [RADIUS + side * length / 2.0 for side in (-1.0, 1.0)]
        assert sorted([found.start_mm, found.end_mm]) == pytest.approx(ends, rel=1e-6)


@at_once("count", [1, 2, 3, 7, 8, 9, 100])
def test_a_stretch_reaches_any_number_of_samples(count: int) -> None:
    """Against trials of every end, for even speeds, which all fit, and for speeds at random."""
    for speed in (np.ones(count), np.exp(np.random.default_rng(count).normal(size=count))):
        last, highest, lowest = crank_stretches._reach(speed, 3.0)
        for start in range(count):
            fits = [
                end for end in range(start, count) if speed[start : end + 1].max() <= 3.0 * speed[start : end + 1].min()
            ]
            assert last[start] == fits[-1]
            within = speed[start : fits[-1] + 1]
            assert (highest[start], lowest[start]) == (within.max(), within.min())


@pytest.mark.tiers(thorough=["0-*"], rest="slow")
@pytest.mark.parametrize("stroke", Stroke, ids=lambda stroke: stroke.value)
@pytest.mark.parametrize("seed", range(3))
def test_the_even_stretch_of_laws_at_random(seed: int, stroke: Stroke) -> None:
    """Never shorter than between dense samples, and never longer than they allow by more than a step at either end."""
    machine = at_random(seed)
    found = longest_even_stretch(machine, stroke, EVEN)
    best, step = longest_between_samples(*dense(machine, stroke), spread(EVEN))
    assert best - 1e-6 * OFFSET.stroke_mm <= found.length_mm <= best + 2.0 * step
    assert found.most_mm_s <= found.least_mm_s * spread(EVEN) * (1.0 + 3e-9)


@pytest.mark.slow
@at_once("name", ["baler", "feeder-table", "pusher", "internal-1-2"])
def test_the_even_stretch_of_designs(name: str) -> None:
    machine = drive(name).machine
    if name == "internal-1-2":
        ends = (0.0, machine.extended_rad)
        jet = machine.displacement(np.linspace(*ends, 40_001), 1)
        place, speed = jet.value, np.abs(jet.derivative(1))
    else:
        place, speed = dense(machine, Stroke.WORKING)
    best, step = longest_between_samples(place, speed, spread(EVEN))
    found = longest_even_stretch(machine, Stroke.WORKING, EVEN).length_mm
    assert best - 1e-6 * machine.linkage.stroke_mm <= found <= best + 2.0 * step


@pytest.mark.slow
def test_a_stretch_of_constant_speed_is_found_whole() -> None:
    """The published baler presses from theta2 to theta3 at v2: 1100 mm/s at the law's speed, 416.6 mm/s at 20 r/min."""
    machine, law_speed = drive("baler").machine, drive("baler").law_speed_rpm
    edges = machine.displacement(np.array([0.7 * pi, pi]), 0).value
    found = longest_even_stretch(machine, Stroke.WORKING, 1e-4)
    assert found.start_mm <= edges[0] + 1e-6
    assert found.end_mm >= edges[1] - 1e-6
    assert found.speed_mm_s == pytest.approx(1100.0 * 20.0 / law_speed, rel=1.1e-4)
    wish = ConstantSpeed(from_mm=float(edges[0]), to_mm=float(edges[1]), tolerance=EVEN)
    assert wish.outcome(machine).achieved < 1e-9
    # Negative control: a little further back the slider is faster.
    assert replace(wish, from_mm=float(edges[0]) - 40.0).outcome(machine).achieved > 1e-3


@at_once("within", [0.01, 0.5, 30.0])
@at_once("end", End)
def test_the_dwell_of_an_even_yoke(end: End, within: float) -> None:
    """Its displacement r (1 - cos phi) is within d of either end for 2 acos(1 - d/r)."""
    found = Dwell(end=end, within_mm=within, for_rad=1.0).outcome(uniform())
    assert found.achieved == pytest.approx(2.0 * acos(1.0 - within / RADIUS), rel=1e-9)
    assert found.kept is (found.achieved >= 1.0)


def test_the_time_ratio_of_an_even_crank() -> None:
    """An offset crank turns by the angle between its stretched positions, asin(offset / (rod -+ crank))."""
    crank, rod, offset = OFFSET.crank_mm, OFFSET.rod_mm, OFFSET.offset_mm
    between = asin(offset / (rod - crank)) - asin(offset / (rod + crank))
    ratios = (pi + between) / (pi - between), (pi - between) / (pi + between)
    found = TimeRatio(at_least=1.0).outcome(uniform(OFFSET)).achieved
    assert min(abs(found / ratio - 1.0) for ratio in ratios) < 1e-12
    assert achieved(uniform(), ()).time_ratio == pytest.approx(1.0, rel=1e-12)


def test_positions_of_an_even_yoke() -> None:
    place = RADIUS * (1.0 - cos(2.0))
    wish = Position(at_mm=place - 0.5, phi1_rad=2.0, tolerance_mm=1.0)
    assert wish.outcome(uniform()).achieved == pytest.approx(place, rel=1e-12)
    assert wish.outcome(uniform()).kept
    assert replace(wish, at_mm=place - 3.0).outcome(uniform()).missed_by == pytest.approx(2.0)
    # The same place on the way back is passed after the extended end.
    back = replace(wish, at_mm=place, stroke=Stroke.RETURN).outcome(uniform())
    assert back.other_stroke
    assert back.missed_by == pytest.approx(2.0 * (2.0 * RADIUS - place) - 1.0)
    assert replace(wish, at_mm=place, stroke=Stroke.RETURN, phi1_rad=2.0 * pi - 2.0).outcome(uniform()).kept


def test_speeds_of_an_even_yoke() -> None:
    speed = RADIUS * W * sin(acos(0.4))
    for stroke in Stroke:
        wish = SpeedAt(at_mm=0.6 * RADIUS, stroke=stroke, most_mm_s=0.99 * speed)
        found = wish.outcome(uniform())
        assert found.achieved == pytest.approx(speed, rel=1e-12)
        assert found.missed_by == pytest.approx(0.01 * speed)
        assert ExtremeSpeed(at_mm=0.6 * RADIUS, stroke=stroke).outcome(uniform()).kept
    constant = ConstantSpeed(from_mm=60.0, to_mm=120.0, tolerance=0.01, speed_mm_s=600.0)
    assert constant.outcome(uniform()).achieved == pytest.approx(max(RADIUS * W / 600.0 - 1.0, 1.0 - speed / 600.0))
    fast = replace(constant, speed_mm_s=RADIUS * W)
    assert fast.outcome(uniform()).achieved == pytest.approx(1.0 - speed / (RADIUS * W))
    whatever = replace(constant, speed_mm_s=None).outcome(uniform())
    assert whatever.achieved == pytest.approx((RADIUS * W - speed) / (RADIUS * W + speed))
    assert whatever.speed_mm_s == pytest.approx((RADIUS * W + speed) / 2.0)


@at_once(("stroke_mm", "near"), [(760.0, 0.5), (200.0, 0.2), (100.0, 0.1), (99.0, 0.05), (2e4, 20.0)])
def test_near_is_a_thousandth_of_the_stroke_in_round_figures(stroke_mm: float, near: float) -> None:
    assert near_mm(stroke_mm) == pytest.approx(near, rel=1e-12)


FASTEST, AT_60 = RADIUS * W, RADIUS * W * sin(acos(0.4))
"""Speeds of the even yoke in mm/s: in the middle, and where it is 60 mm from its end."""

OFFERED: list[tuple[Wish, int, float, dict[str, float], float]] = [
    (Dwell(end=End.RETRACTED, within_mm=20.0, for_rad=2.0), 0, 2.0 - 2.0 * acos(0.8),
     {"for_deg": degrees(2.0 * acos(0.8))}, -1.0),
    (TimeRatio(at_least=1.5), 0, 0.2 * pi, {"at_least": 1.0}, -1.0),
    (WorkingStroke(angle_rad=2.5, tolerance_rad=0.1), 0, pi - 2.6, {"tolerance_deg": degrees(pi - 2.5)}, 1.0),
    (Position(at_mm=60.0, phi1_rad=0.8, tolerance_mm=5.0), 0, acos(0.45) - 0.8, {"phi1_deg": degrees(acos(0.45))}, 1.0),
    (Position(at_mm=60.0, phi1_rad=1.5, tolerance_mm=5.0), 1, 1.5 - acos(0.35),
     {"phi1_deg": degrees(acos(0.35))}, -1.0),
    (GentleSpeed(most_mm_s=500.0), 0, log(FASTEST / 500.0), {"speed_at_most_mm_s": FASTEST}, 1.0),
    (GentleStop(most_mm_s2=2e3), 0, RADIUS * W**2 / 2e3 - 1.0, {"deceleration_at_most_mm_s2": RADIUS * W**2}, 1.0),
    (ConstantSpeed(from_mm=60.0, to_mm=120.0, tolerance=0.01), 0, log(FASTEST / AT_60),
     {"tolerance": (FASTEST - AT_60) / (FASTEST + AT_60)}, 1.0),
    (ConstantSpeed(from_mm=60.0, to_mm=120.0, tolerance=0.01, speed_mm_s=600.0), 0, log(FASTEST / 606.0),
     {"tolerance": FASTEST / 600.0 - 1.0}, 1.0),
    (SpeedAt(at_mm=60.0, least_mm_s=600.0), 0, log(600.0 / AT_60), {"at_least_mm_s": AT_60}, -1.0),
    (SpeedAt(at_mm=60.0, most_mm_s=500.0), 0, log(AT_60 / 500.0), {"at_most_mm_s": AT_60}, 1.0),
]  # fmt: skip
"""Wishes that an even yoke misses, which of their requirements, by how much, and what it keeps: rounded down or up."""


@at_once(("wish", "number", "missed", "kept", "way"), OFFERED)
def test_what_is_offered_for_a_missed_wish_is_what_an_even_yoke_keeps(
    wish: Wish, number: int, missed: float, kept: dict[str, float], way: float
) -> None:
    wish = replace(wish, key="w")
    assert not wish.outcome(uniform()).kept
    offered = dict(wish.offer(wish.requirements(YOKE, 2.0 * pi)[number], missed, 2.0 * pi).values)
    assert offered == pytest.approx({f"w.{key}": value for key, value in kept.items()}, rel=2e-3)
    for key, value in kept.items():
        assert way * (offered[f"w.{key}"] - value) >= -1e-9 * value


def test_a_driving_range_is_offered_shorter_at_both_ends() -> None:
    crank = CrankStretch(-0.4, 1.5)
    wish = GentleSpeed(key="w", most_mm_s=500.0, driving=DrivingRange(-0.3, 2.0, crank))
    _, start, end = wish.requirements(YOKE, 2.0 * pi)
    # No later than 0.3 before the end is at least 0.3 for the way to it; no earlier than 2 is at least 2.
    assert start == TimeWithin(CrankStretch(-0.4, 0.0), least_rad=0.3)
    assert end == TimeWithin(CrankStretch(0.0, 1.5), least_rad=2.0)
    assert dict(wish.offer(end, 0.05, 2.0 * pi).values) == pytest.approx(
        {"w.from_phi1_deg": degrees(-0.25), "w.to_phi1_deg": degrees(1.95)}, rel=2e-3
    )


@at_once("end", End)
@at_once("linkage", [YOKE, OFFSET])
def test_the_nearest_dwell(linkage: Mechanism, end: End) -> None:
    """r (1 - cos(angle / 2)) on a yoke; nearly |x''| angle^2 / 8 on any mechanism, for the crank's own angle."""
    for_rad, ratio_max = radians(41.0), 5.0
    crank = for_rad / ratio_max
    found = nearest_dwell_mm(linkage, end, for_rad, ratio_max)
    at = 0.0 if end is End.RETRACTED else linkage.working_angle_rad
    step = 1e-4
    three = linkage.displacement(Jet.variable(np.array([at - step, at, at + step]), 0)).value
    bend = abs(three[0] - 2.0 * three[1] + three[2]) / step**2
    # The next term of the series is under crank^2 of this one.
    assert found == pytest.approx(bend * crank**2 / 8.0, rel=crank**2)
    if linkage is YOKE:
        assert found == pytest.approx(RADIUS * (1.0 - cos(crank / 2.0)), rel=1e-9)


@pytest.mark.slow
def test_no_law_stays_nearer_for_longer() -> None:
    """Laws at random within ratios of 5 stay near the end for less; a law at that ratio about the end attains it."""
    wish = Dwell(end=End.EXTENDED, within_mm=nearest_dwell_mm(OFFSET, End.EXTENDED, 1.0, 5.0), for_rad=1.0)
    longest = 0.0
    for seed in range(20):
        machine = at_random(seed)
        assert machine.transmission.ratio_range[1].value < 5.0
        longest = max(longest, wish.outcome(machine).achieved)
    assert longest < 1.0
    # i12 is close to 4.6 about the end and low elsewhere.
    peaked = drive_of_text(
        "name: peaked\nlinkage: {crank_mm: 380, rod_mm: 960}\noperation: {speed_rpm: 60}\n"
        "motion: {law: ratio_expression, ratio: '0.75 + 4.2/(1 + ((phi - pi)/0.9)**8)', scale_to_close: true}\n"
    )
    ratio = peaked.transmission.ratio_range[1].value
    taken = 0.8 * ratio * radians(10.0)
    near = nearest_dwell_mm(peaked.linkage, End.EXTENDED, taken, ratio)
    found = Dwell(end=End.EXTENDED, within_mm=near, for_rad=taken).outcome(peaked.machine)
    assert found.achieved <= taken * (1.0 + 1e-9)
    assert found.achieved == pytest.approx(taken, rel=2e-2)


def taken_by_quadrature(machine: Machine, stretch: CrankStretch) -> float:
    """The driving angle of a stretch: where phi2 has its ends, by bisection of its own."""

    def driving(crank: float) -> float:
        turns, local = divmod(crank, 2.0 * pi)
        low, high = 0.0, 2.0 * pi
        for _ in range(80):
            middle = (low + high) / 2.0
            below = machine.transmission.driven_angle(np.array([middle])).value[0] < local
            low, high = (middle, high) if below else (low, middle)
        return turns * 2.0 * pi + low

    return driving(stretch.end_rad) - driving(stretch.start_rad)


def holds(machine: Machine, asked: Requirement) -> float:
    """By how much a requirement is kept (over 0) or missed, in rad or as a share of the speed; dense samples."""
    if isinstance(asked, TimeWithin):
        taken = taken_by_quadrature(machine, asked.stretch)
        return min(taken - asked.least_rad, asked.most_rad - taken)
    crank = np.linspace(*asked.stretch, 2001)
    phi1 = machine.driving_angles(crank)
    speed = np.abs(machine.displacement(phi1, 1).derivative(1)) * machine.speed_rad_s
    if isinstance(asked, EvenSpeed):
        return float(asked.spread / (speed.max() / speed.min()) - 1.0)
    assert isinstance(asked, SpeedWithin)
    return float(min(speed.min() / max(asked.least_mm_s, 1e-9), asked.most_mm_s / speed.max()) - 1.0)


def wishes_at_random(seed: int) -> list[Wish]:
    """One wish of every kind, about as often kept as missed."""
    draw = np.random.default_rng(seed).uniform
    low = draw(100.0, 500.0)
    out, back = Stroke.WORKING, Stroke.RETURN
    speed = draw(1500.0, 3500.0)
    return [
        ConstantSpeed(from_mm=low, to_mm=low + 80.0, tolerance=draw(0.0, 0.1), stroke=back if seed % 2 else out),
        ConstantSpeed(from_mm=low, to_mm=low + 30.0, tolerance=draw(0.0, 0.5), speed_mm_s=speed),
        SpeedAt(at_mm=low, stroke=out if seed % 2 else back, least_mm_s=0.7 * speed, most_mm_s=1.3 * speed),
        TimeRatio(at_least=draw(0.3, 3.0)),
        WorkingStroke(angle_rad=draw(2.0, 4.5), tolerance_rad=draw(0.0, 1.0)),
        Dwell(end=End.RETRACTED, within_mm=draw(1.0, 40.0), for_rad=draw(0.2, 1.2)),
        Dwell(end=End.EXTENDED, within_mm=draw(1.0, 40.0), for_rad=draw(0.2, 1.2)),
        Position(at_mm=low, phi1_rad=draw(1.0, 3.0), tolerance_mm=draw(10.0, 150.0)),
        Position(at_mm=low, phi1_rad=draw(4.0, 5.5), tolerance_mm=draw(10.0, 150.0), stroke=back),
        Position(at_mm=20.0, phi1_rad=0.3, tolerance_mm=50.0),
        Position(at_mm=20.0, phi1_rad=6.1, tolerance_mm=50.0, stroke=back),
    ]


@pytest.mark.long
@pytest.mark.slow
def test_a_wish_is_kept_where_its_requirements_hold() -> None:
    """Judged by quadrature and dense samples, on laws and wishes at random; both answers are met for every kind."""
    answers: dict[int, set[bool]] = {}
    for seed in range(24):
        machine = at_random(seed)
        for number, wish in enumerate(wishes_at_random(seed)):
            margin = min(holds(machine, asked) for asked in wish.requirements(OFFSET, 2.0 * pi))
            kept = wish.outcome(machine).kept
            # Samples miss a peak by less than this.
            if abs(margin) > 1e-5:
                assert kept is bool(margin > 0.0), (seed, wish, margin)
            answers.setdefault(number, set()).add(kept)
    assert all(found == {True, False} for found in list(answers.values())[:9])


@pytest.mark.slow
def test_the_rest_of_a_turn_takes_the_rest_of_the_cycle() -> None:
    """A lower bound of a stretch's time is an upper bound of the rest's."""
    machine, stretch = at_random(1), CrankStretch(-0.4, 0.7)
    slope = machine.transmission.driven_angle

    def time(at: CrankStretch) -> float:
        def rate(crank: float) -> float:
            phi1 = machine.driving_angles(np.array([crank % (2.0 * pi)]))
            return float(1.0 / slope(phi1, 1).derivative(1)[0])

        return float(quad(rate, *at, points=[0.0] if at.start_rad < 0.0 else None, limit=200)[0])

    assert time(stretch) + time(stretch.rest) == pytest.approx(2.0 * pi, abs=1e-8)


HEAD = "name: d\nlinkage: {crank_mm: 380, rod_mm: 960}\noperation: {speed_rpm: 60}\nmotion: {law: uniform_crank}\n"

WRONG = {
    "places the wrong way round": (
        "constant_speed: [{from_mm: 500, to_mm: 300}]",
        "d.yaml:5:42: wishes.constant_speed.0.to_mm: 300 mm given, but from_mm is 500 mm; over 500 mm is right",
    ),
    "overlapping even speeds": (
        "constant_speed: [{from_mm: 300, to_mm: 500}, {from_mm: 100, to_mm: 301}]",
        "wishes.constant_speed.0.from_mm: 300 given, but even speed is wished from 100 to 301 mm of the same stroke",
    ),
    "speeds that do not meet": (
        "constant_speed: [{from_mm: 100, to_mm: 300, speed_mm_s: 900}, {from_mm: 300, to_mm: 400, speed_mm_s: 1000}]",
        "wishes.constant_speed.1.from_mm: 300 given",
    ),
    "place beyond the stroke": (
        "constant_speed: [{from_mm: 300, to_mm: 800}]",
        "d.yaml:5:42: wishes.constant_speed.0.to_mm: 800 given, but the stroke is 760 mm; less is right",
    ),
    "speed beyond the stroke": (
        "speed_at: [{at_mm: 760, at_most_mm_s: 10}]",
        "d.yaml:5:22: wishes.speed_at.0.at_mm: 760 given, but the stroke is 760 mm",
    ),
    "no speed": ("speed_at: [{at_mm: 300}]", "wishes.speed_at.0: says nothing of the speed"),
    "bounds the wrong way round": (
        "speed_at: [{at_mm: 300, at_least_mm_s: 900, at_most_mm_s: 800}]",
        "wishes.speed_at.0.at_most_mm_s: 800 mm/s given, but at_least_mm_s is 900 mm/s; 900 mm/s or over is right",
    ),
    "hard and slowest": ("speed_at: [{at_mm: 300, make: slowest}]", "wishes.speed_at.0.make: slowest has no bound"),
    "slowest and bounded": (
        "speed_at: [{at_mm: 300, make: slowest, hard: false, at_most_mm_s: 800}]",
        "wishes.speed_at.0.at_most_mm_s: given, and make: slowest too",
    ),
    "hard with a weight": (
        "time_ratio: {at_least: 1.5, weight: 2}",
        "wishes.time_ratio.weight: given, but the wish",
    ),
    "positions whose angles fall": (
        "positions: [{at_mm: 300, phi1_deg: 100, tolerance_mm: 1}, {at_mm: 400, phi1_pi: 0.5, tolerance_mm: 1}]",
        "wishes.positions.1.phi1_pi: 0.5 given, which is not over the angle before it",
    ),
    "positions that go to and fro": (
        "positions: [{at_mm: 300, phi1_deg: 100, tolerance_mm: 1}, {at_mm: 200, phi1_deg: 110, tolerance_mm: 1}, "
        "{at_mm: 250, phi1_deg: 120, tolerance_mm: 1}]",
        "wishes.positions.2.at_mm: 250 follows 200 in the return stroke, where displacements fall",
    ),
    "working after the return": (
        "positions: [{at_mm: 300, phi1_deg: 100, tolerance_mm: 1, stroke: return}, "
        "{at_mm: 200, phi1_deg: 110, tolerance_mm: 1, stroke: working}]",
        "wishes.positions.1.stroke: working given after a position on the return",
    ),
    "position beyond the stroke": (
        "positions: [{at_mm: 761, phi1_deg: 100, tolerance_mm: 1}]",
        "d.yaml:5:23: wishes.positions.0.at_mm: 761 given, but the stroke is 760 mm; at most that is right",
    ),
    "position without an angle": (
        "positions: [{at_mm: 300, tolerance_mm: 1}]",
        "wishes.positions.0: one of phi1_rad, phi1_deg or phi1_pi is missing",
    ),
    "angle beyond the cycle": (
        "positions: [{at_mm: 300, phi1_deg: 400, tolerance_mm: 1}]",
        "d.yaml:5:35: wishes.positions.0.phi1_deg: 400 given, but a cycle takes 360 deg of the driving angle; less is",
    ),
    "working stroke of more than a cycle": (
        "working_stroke: {angle_deg: 370}",
        "d.yaml:5:27: wishes.working_stroke.angle_deg: 370 given, but a cycle takes 360 deg",
    ),
    "working stroke twice": ("working_stroke: {angle_deg: 200, angle_pi: 1}", "wishes.working_stroke.angle_pi: "),
    "a ratio that the working stroke has not": (
        "working_stroke: {angle_deg: 180}, time_ratio: {at_least: 2}",
        "wishes.time_ratio.at_least: 2 given, but a working stroke of 180 deg takes 1 times the time of the return",
    ),
    "long dwells": (
        "dwell: [{at: extended, within_mm: 1, for_deg: 200}, {at: retracted, within_mm: 1, for_deg: 160}]",
        "wishes.dwell: dwells at both ends for 360 deg together",
    ),
}


@at_once(("wishes", "said"), WRONG.values())
def test_wishes_that_contradict_are_refused_at_their_key(run: Run, wishes: str, said: str) -> None:
    got, out, err = check(run, wishes)
    assert (got, out) == (2, "")
    assert err.startswith("d.yaml:5:")
    assert said in err


BORDERS = [
    "working_stroke: {angle_deg: 180}, time_ratio: {at_least: 1}",
    "working_stroke: {angle_deg: 239, tolerance_deg: 1}, time_ratio: {at_least: 2}",
    "working_stroke: {angle_deg: 359}",
    "constant_speed: [{from_mm: 300, to_mm: 500}, {from_mm: 100, to_mm: 300}]",
    "constant_speed: [{from_mm: 300, to_mm: 759}]",
    "positions: [{at_mm: 760, phi1_deg: 100, tolerance_mm: 1}]",
    "positions: [{at_mm: 300, phi1_deg: 359, tolerance_mm: 1}]",
    "speed_at: [{at_mm: 759, at_most_mm_s: 10}]",
    "speed_at: [{at_mm: 300, at_least_mm_s: 900, at_most_mm_s: 900}]",
    "dwell: [{at: extended, within_mm: 1, for_deg: 200}, {at: retracted, within_mm: 1, for_deg: 159}]",
    "gentle_stop: [{from_phi1_deg: -359, to_phi1_deg: 0, speed_at_most_mm_s: 900}]",
]
"""Wishes that only just do not contradict each other, the stroke of 760 mm, or the cycle."""


@pytest.mark.parametrize("wishes", BORDERS)
def test_wishes_that_only_just_agree_are_taken(wishes: str) -> None:
    assert drive_of_text(f"{HEAD}wishes: {{{wishes}}}\n").design.wishes.model_fields_set


def check(run: Run, wishes: str) -> tuple[int, str, str]:
    """A check of an evenly turning baler with wishes."""
    Path("d.yaml").write_text(f"{HEAD}wishes: {{{wishes}}}\n", encoding="utf-8")
    return run("check", "d.yaml", "--verbose")


@pytest.mark.thorough
def test_an_exact_dwell_is_refused_with_the_nearest(run: Run) -> None:
    got, out, err = check(run, "dwell: [{at: extended, within_mm: 0, for_deg: 41}]")
    assert (got, out) == (3, "")
    assert err.startswith("d.yaml:5:33: wishes.dwell.0.within_mm: 0 given, an exact dwell, but gears of a ")
    nearest = float(err.split("it can stay within ")[1].split()[0])
    exact = nearest_dwell_mm(CrankSlider(380.0, 960.0), End.EXTENDED, radians(41.0), 5.0)
    assert exact <= nearest < 1.01 * exact


@pytest.mark.thorough
def test_a_check_says_what_is_achieved_and_what_is_missed(run: Run) -> None:
    got, out, err = check(run, "time_ratio: {at_least: 1.5}, dwell: [{at: extended, within_mm: 50, for_deg: 41}]")
    assert (got, err) == (0, "")
    assert "  constant speed  within 0.5 % over 96.8 mm, 12.7 % of the stroke\n  time ratio      1\n" in out
    assert "  dwell           within 0.5 mm for 4.98 deg extended, 7.56 deg retracted\n" in out
    assert "  missed: time ratio of working stroke and return: 1, at least 1.5 wished, missed by 0.5\n" in out
    assert "  kept: dwell within 50 mm of the extended end: 50.45 deg, at least 41 deg wished\n" in out
    assert "  1 of 2 wishes missed: wishes.time_ratio by 0.5\n" in out


def test_the_press_feeder_on_an_even_crank() -> None:
    """Its dwell from the triangle of crank and rod: the crank is within 1 mm of its far end for 2 acos(...)."""
    found = drive("feeder-wishes").achieved
    # Law of cosines at the place 249 mm from the crank's axis, with crank 50 and rod 200.
    crank = acos((249.0**2 + 50.0**2 - 200.0**2) / (2.0 * 249.0 * 50.0))
    dwell = next(one for one in found.outcomes if isinstance(one.wish, Dwell))
    assert dwell.achieved == pytest.approx(2.0 * crank, rel=1e-9)
    assert [one.kept for one in found.outcomes] == [False, False, False, False]
