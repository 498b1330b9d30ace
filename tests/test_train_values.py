"""Trains made by hand: paths whose carrier and waves are known, round parts on fixed axes, bodies that swing evenly."""

from __future__ import annotations

from contextlib import nullcontext
from dataclasses import replace
from math import acos, atan, cos, pi, radians, sin
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest
import shapely
from scipy.optimize import brentq

from ncgear.design.trains.base import with_sound_bodies
from ncgear.errors import WrongInput
from ncgear.pitch.pair import sized_pair
from ncgear.pitch.shape import Mesh
from ncgear.ratio.laws.uniform import uniform_law
from ncgear.ratio.transmission import Lobes
from ncgear.teeth.gear import ToothedPair
from ncgear.trains import path_search
from ncgear.trains.contact import contacts_of, distances_of
from ncgear.trains.loads import PutMass, TrainForces, TrainLoads, loads_of
from ncgear.trains.path_search import PathLimits, burden, crowding, found_motion, pair_figures, tool_mount
from ncgear.trains.planetary import shared_chain
from ncgear.trains.planetary_told import told_of
from ncgear.trains.tip_path import (
    HARMONICS,
    NoPath,
    TipMotion,
    WishedPath,
    _smoothest,
    _turns_of,
    distances_mm,
    missed_mm,
    motion_from,
)
from ncgear.trains.train import (
    GearMesh,
    Part,
    PinHole,
    Poses,
    Trace,
    Train,
    TrainFigures,
    contact_condition,
    seen_from_behind,
)
from pairs import sine_law

pytestmark = pytest.mark.judges("trains")


def motion(carrier: float, arm: float, swing: float = 0.2, *, clockwise: bool = False) -> TipMotion:
    """u = w + 0.4 + swing (0.7 cos w + sin w) about an axis at 30 + 10i."""
    waves = np.zeros(2 * HARMONICS)
    waves[0], waves[HARMONICS] = 0.7 * swing, swing
    return TipMotion(30.0 + 10.0j, carrier, arm, 0.4, waves, clockwise)


@pytest.mark.parametrize("clockwise", [False, True])
@pytest.mark.parametrize(("carrier", "arm", "first"), [(100.0, 60.0, 0.3), (60.0, 100.0, 0.7)])
def test_a_path_that_is_known_is_found_from_its_points(
    carrier: float, arm: float, first: float, clockwise: bool
) -> None:
    """The lengths are half the sum and half the difference of the greatest and the least distance from the axis."""
    known = replace(motion(carrier, arm, clockwise=clockwise), start_rad=1.6)
    w = 2.0 * pi * (np.arange(16) + first) / 16
    path = WishedPath(known.tip(w), np.full(16, 1e-3))
    r = np.abs(path.points - known.axis)
    beyond = 160.0 - r.max(), r.min() - 40.0
    found = motion_from(path, known.axis, beyond, clockwise=clockwise)
    assert isinstance(found, TipMotion)
    assert (found.carrier_mm, found.arm_mm) == pytest.approx((carrier, arm), rel=1e-12)
    assert missed_mm(found, path).max() < 2e-3
    fine = np.linspace(0.0, 2.0 * pi, 200)
    assert np.abs(found.tip(fine) - known.tip(fine)).max() < 0.3
    steps = np.gradient(np.asarray(found.carrier_rad(fine)), fine)
    assert found.carrier_rad(fine, 1)[1:-1] == pytest.approx(steps[1:-1], abs=2e-3)
    # A point beside the path turns the distance round, and an axis on the path is too near to it.
    aside = replace(path, points=np.where(np.arange(16) == 4, path.points * 1.3, path.points))
    assert isinstance(motion_from(aside, known.axis, beyond, clockwise=clockwise), NoPath)
    on_path = motion_from(path, complex(path.points[3]) + 0.1, beyond, clockwise=clockwise)
    assert isinstance(on_path, NoPath)
    # From the other side it turns against the carrier, where the path goes around the axis
    if carrier > arm:
        against = motion_from(path, known.axis, beyond, clockwise=not clockwise)
        assert isinstance(against, NoPath)
        assert "against the carrier" in against.words


@pytest.mark.parametrize(("carrier", "arm"), [(100.0, 60.0), (60.0, 100.0)])
def test_what_is_said_to_be_missed_is_the_distance_of_the_points(carrier: float, arm: float) -> None:
    """To first order in tolerances: of points that stand aside by half of it, as the smoothest motion leaves them."""
    known = motion(carrier, arm)
    w = 2.0 * pi * (np.arange(16) + 0.3) / 16
    aside = 0.05 * np.random.default_rng(4).normal(size=(2, 16))
    path = WishedPath(known.tip(w) + aside[0] + 1j * aside[1], np.full(16, 0.1))
    arms = path.points - known.axis
    turned = _turns_of(path, np.abs(arms), carrier + arm, abs(carrier - arm))
    assert not isinstance(turned, NoPath)
    found, missed = _smoothest(path, np.abs(arms), np.unwrap(np.angle(arms)), turned, carrier, arm)
    made = TipMotion(known.axis, carrier, arm, float(found[0]), found[1:], False)
    assert 0.05 < missed.max() <= 0.8
    # Beside the farthest place, where an error of the distance turns w by its root, first order says little.
    off = np.abs(np.sin(w)) > 0.2
    assert missed[off] == pytest.approx(missed_mm(made, path)[off] / 0.1, abs=0.02)


def test_gears_about_an_idler_that_two_share_stand_and_turn_as_their_law_says() -> None:
    """At equal distances, turned off the line by the bend; the planet's mesh has the law of the sun's, kappa later."""
    pitch = sized_pair(sine_law(0.1), 24, 2.0, None)
    gear: Any = SimpleNamespace(outline_mm=circle(20.0), teeth=24)
    chain = shared_chain(pitch, cast(ToothedPair, SimpleNamespace(driving=gear, driven=gear)), 0.4)
    sun, idler, planet = chain.gears
    steps = idler.place - sun.place, planet.place - idler.place
    assert np.abs(steps) == pytest.approx([pitch.center_distance_mm] * 2)
    assert np.angle(steps[1] / steps[0]) == pytest.approx(0.4)
    assert (planet.place.imag, chain.carrier_mm) == (0.0, pytest.approx(planet.place.real))
    u = np.linspace(-1.0, 9.0, 50)
    law, before = (lambda angle: pitch.transmission.driven_angle(np.atleast_1d(angle)).value), np.angle(steps[0])
    assert sun.angle(u) == pytest.approx(before - u)
    assert idler.angle(u) == pytest.approx(before + law(u))
    start = brentq(lambda angle: float(law(angle)[0]) - (pi - 0.4), 0.0, 2.0 * pi)
    assert law(chain.planet_rad(u) + start) == pytest.approx(law(u) + pi - 0.4, abs=1e-9)
    assert planet.angle(u) == pytest.approx(before + 0.4 - pi - start - chain.planet_rad(u))


def test_a_straight_stretch_has_even_points_between_its_ends() -> None:
    path = WishedPath(np.array([0.0, 8.0, 8.0 + 4.0j]), np.array([0.3, 0.1, 0.2]), ((2, 0.5),))
    found = path.straightened([1])
    assert found.points.tolist() == [0.0, 8.0, 8.0 + 1.0j, 8.0 + 2.0j, 8.0 + 3.0j, 8.0 + 4.0j]
    assert found.tolerance_mm.tolist() == [0.3, 0.1, 0.1, 0.1, 0.1, 0.2]
    assert (found.named, found.tool_rad) == ((1, 2, 2, 2, 2, 3), ((5, 0.5),))


def test_distances_from_chords_are_those_of_shapely() -> None:
    generator = np.random.default_rng(3)
    points, places = ((generator.normal(size=(n, 2)) @ [1.0, 1.0j]) for n in (40, 25))
    line = shapely.LineString(np.stack([places.real, places.imag], axis=-1))
    wanted = shapely.distance(shapely.points(points.real, points.imag), line)
    assert distances_mm(points, places) == pytest.approx(wanted, abs=1e-12)


def test_the_axis_is_found_again_where_it_is_given(monkeypatch: pytest.MonkeyPatch) -> None:
    """Both lengths of a path of even gears, and the tool's angle on the arm."""
    monkeypatch.setattr(path_search, "SEARCHES", 1)
    known = motion(100.0, 60.0, 0.1)
    w = 2.0 * pi * (np.arange(12) + 0.3) / 12
    arm = known.carrier_rad(w) - w
    path = WishedPath(known.tip(w), np.full(12, 0.05), ((2, arm[2] + 0.7), (7, arm[7] + 0.72)), 0.05)
    found = found_motion(path, PathLimits(0.8, 30, 300.0), known.axis)
    assert missed_mm(found, path).max() < 0.05
    mount, missed = tool_mount(known, path)
    assert (mount, missed) == (pytest.approx(0.71, abs=0.02), pytest.approx(0.01, abs=0.02))
    assert burden(found, PathLimits(0.8, 30, 300.0)) <= burden(known, PathLimits(0.8, 30, 300.0)) + 0.02


def test_the_burden_of_even_gears() -> None:
    """Two pairs of equal circles of radius a / 2: a curvature of 2 / a, z teeth of a module of a / z, no tangent angle.

    A swing of the ratio about one by e bends them: tan is half of the logarithm's rate over 1 + s.
    """
    even = motion(100.0, 60.0, 0.0)
    assert pair_figures(even) == pytest.approx(np.broadcast_to(np.array([0.0, 2.0, 2.0])[:, None, None], (3, 2, 360)))
    assert burden(even, PathLimits(0.8, 20, 1000.0)) == pytest.approx(2.0 / (0.45 * 20))
    assert burden(even, PathLimits(0.8, 20, 125.0)) == pytest.approx(0.8)
    bent = motion(100.0, 60.0, 0.01)
    # ln R = 0.01 (cos w - 0.7 sin w), R' / 2 over 1 + 1
    tangent = 0.01 * np.hypot(1.0, 0.7) / 4.0
    assert np.abs(pair_figures(bent)[0]).max(axis=1) == pytest.approx([tangent, tangent], rel=0.02)
    # k2 = (1 + s + s'') / a with s = 1 - e / 2: (2 - e/2 + e/2) + O(e^2), and both curvatures add up to (1 + s)^2 / s
    both = pair_figures(bent)[1] + pair_figures(bent)[2]
    assert both == pytest.approx(np.full((2, 360), 4.0), rel=1e-3)
    assert burden(bent, PathLimits(atan(tangent), 2000, 1e6)) == pytest.approx(1.0, rel=0.02)
    standing = motion(100.0, 60.0, 1.0)
    assert burden(standing, PathLimits(0.8, 20, 1000.0)) > 10.0


def test_pitch_curves_of_a_ratio_that_swings_far_are_bent_as_its_samples_say() -> None:
    """k2 = (1 + s + s'') cos^3 over the driven angle, w of the second pair and v of the first, by waves of s."""
    known = motion(100.0, 60.0, 0.4)
    w, ratio = known.ratio(360)
    root = np.sqrt(ratio)
    second = root / root.mean()
    waves = 1j * np.fft.fftfreq(360, 1.0 / 360.0)

    def by_w(values: np.ndarray) -> np.ndarray:
        return np.fft.ifft(np.fft.fft(values) * waves).real

    for pair, (own, faster) in enumerate(((root * root.mean(), second), (second, np.ones(360)))):
        s = 1.0 / own
        slope = by_w(s) / faster
        tangent = slope / (1.0 + s)
        bent = (1.0 + s + by_w(slope) / faster) / np.hypot(1.0, tangent) ** 3
        found = pair_figures(known)[:, pair]
        assert found[0] == pytest.approx(tangent, abs=1e-6)
        assert found[2] == pytest.approx(bent, abs=1e-6)
        assert found[1] + found[2] == pytest.approx((1.0 + s) ** 2 / s / np.hypot(1.0, tangent), abs=1e-6)
    assert w[1] == pytest.approx(2.0 * pi / 360)


@pytest.mark.parametrize(("carrier", "arm", "arms"), [(100.0, 60.0, 2), (100.0, 30.0, 3), (60.0, 100.0, 2)])
def test_crowding_is_the_distance_of_all_arms_by_shapely(carrier: float, arm: float, arms: int) -> None:
    known = motion(carrier, arm)
    limits = PathLimits(0.8, 20, 1000.0, arms, 25.0)
    w, u = known.turn
    at = u[0] + np.linspace(0.0, 2.0 * pi, path_search.ROOM_PLACES, endpoint=False)

    def line(angle: float) -> Any:
        turned = np.interp((angle - u[0]) % (2.0 * pi) + u[0], u, w)
        ends = carrier * np.exp(1j * angle), carrier * np.exp(1j * angle) + arm * np.exp(1j * (angle - turned))
        return shapely.LineString([[one.real, one.imag] for one in ends])

    least = np.array(
        [[line(one).distance(line(one + 2.0 * pi * k / arms)) for one in at] for k in range(1, arms // 2 + 1)]
    )
    crossing = (least == 0.0).mean(axis=1).max()
    wanted = 2.0 + 8.0 * crossing if crossing else min(25.0 / least.min(), 2.0)
    assert crowding(known, limits) == pytest.approx(wanted, rel=1e-9)
    assert crowding(known, replace(limits, arms=1)) == 0.0


def circle(radius: float, count: int = 360) -> np.ndarray:
    angle = 2.0 * pi * np.arange(count) / count
    return radius * np.stack([np.cos(angle), np.sin(angle)], axis=-1)


def round_train(apart_mm: float, swing_mm: float, *parts: Part, kind: Mesh | None = Mesh.EXTERNAL) -> Train:
    """Parts, the first on the driving axis, the others on an axis that swings along x by a cosine, once in a cycle."""

    def poses_at(driving: np.ndarray) -> Poses:
        moved = apart_mm + swing_mm * np.cos(driving)
        x = np.stack([0.0 * driving, *[moved] * (len(parts) - 1)])
        return Poses(x, 0.0 * x, np.stack([driving, *[0.0 * driving] * (len(parts) - 1)]))

    mesh = (GearMesh("one", "two", kind),) if kind is not None else ()
    return Train(parts, mesh, poses_at, "one", 2.0 * pi, 60.0, 0.01, TrainFigures("made by hand"))


def test_two_circles_come_apart_and_overlap_by_what_their_distance_says() -> None:
    """Axes at 39.5 + 0.8 cos of a cycle, radii 25 and 15: 0.3 mm apart at first, 1.3 mm deep half a cycle later."""
    parts = Part("one", circle(25.0), 5.0), Part("two", circle(15.0), 5.0)
    (found,) = contacts_of(round_train(39.5, 0.8, *parts), {one.name: one.outline_mm for one in parts})
    assert (found.penetration_max_mm, found.gap_max_mm) == (pytest.approx(1.3, abs=0.02), pytest.approx(0.3, abs=0.02))
    assert found.penetration_max_at_rad == pytest.approx(pi, abs=0.02)
    assert cos(found.gap_max_at_rad) == pytest.approx(1.0, abs=2e-3)
    assert found.clashes(1.2)
    assert not found.clashes(1.4)
    assert found.parts(0.2)
    assert not found.parts(0.4)


def test_a_circle_in_a_ring_touches_where_the_axes_are_as_far_apart_as_the_radii_differ() -> None:
    """Axes 9.8 + 0.5 cos apart, radii 30 of the ring and 20: 0.3 mm too deep at first, 0.7 mm short half a cycle on."""
    parts = Part("one", circle(20.0), 5.0), Part("two", circle(30.0), 5.0, rim_mm=5.0)
    train = round_train(9.8, 0.5, *parts, kind=Mesh.INTERNAL)
    (found,) = contacts_of(train, {one.name: one.outline_mm for one in parts})
    assert (found.penetration_max_mm, found.gap_max_mm) == (pytest.approx(0.3, abs=0.02), pytest.approx(0.7, abs=0.02))


def test_parts_that_share_heights_keep_their_distance() -> None:
    """Of parts in mesh, of one body, at other heights, and of those that never come near, nothing is told."""
    parts = (
        Part("one", circle(25.0), 5.0),
        Part("two", circle(15.0), 5.0),
        Part("wide", circle(20.0), 5.0, low_mm=4.0),
        Part("above", circle(20.0), 5.0, low_mm=9.0, fixed_to="wide"),
    )
    train = round_train(45.5, 0.8, *parts)
    found = {(one.first, one.second): one for one in distances_of(train, {one.name: one.outline_mm for one in parts})}
    assert set(found) == {("one", "wide"), ("two", "wide")}
    # Where parts overlap, the root of the area of a lens of two circles 44.7 mm apart
    first, second = (
        acos((44.7**2 + own**2 - other**2) / (2.0 * 44.7 * own)) for own, other in ((25.0, 20.0), (20.0, 25.0))
    )
    lens = sum(r**2 * (half - sin(half) * cos(half)) for r, half in ((25.0, first), (20.0, second)))
    assert found["one", "wide"].least_distance_mm == pytest.approx(-(lens**0.5), rel=0.02)
    # An ellipse, whose narrow side is turned to the circle and which would touch it with its long one
    narrow = replace(parts[2], outline_mm=parts[2].outline_mm * [0.5, 1.0])
    near = round_train(44.5, 0.8, parts[0], narrow, kind=None)
    (one,) = distances_of(near, {part.name: part.outline_mm for part in (parts[0], narrow)})
    assert one.least_distance_mm == pytest.approx(44.5 - 0.8 - 25.0 - 10.0, abs=0.02)
    assert one.at_rad == pytest.approx(pi, abs=0.02)


def test_a_body_that_swings_needs_the_force_and_torque_of_its_acceleration() -> None:
    """A mass whose axis swings by a cosine, gravity along x: m x'' of force, and the power m (x'' - g) x' over w."""
    disc = Part("two", circle(15.0), 5.0)
    train = round_train(40.0, 6.0, Part("one", circle(25.0), 5.0), disc)
    put, speed, gravity = PutMass("two", 0j, 2.0), 2.0 * pi, -9806.65
    loads = loads_of(train, 1e-9, [put], complex(gravity))
    phi = loads.driving_rad
    acceleration = -6.0 * speed**2 * np.cos(phi)
    assert loads.force_n.real == pytest.approx(-2.0 * acceleration / 1e3, abs=1e-6)
    assert np.abs(loads.force_n.imag).max() < 1e-9
    assert loads.torque_n_m == pytest.approx(2.0 * (acceleration - gravity) * -6.0 * np.sin(phi) / 1e6, abs=1e-9)
    assert loads.mass_kg == pytest.approx(2.0)
    # m r w^2 cos t along x is half a force that turns with the carrier: half of m r balances it
    assert loads.counterweight_kg_mm == pytest.approx(-2.0 * 6.0 / 2.0, rel=1e-9)
    assert np.abs(loads.moment_n_m).max() < 1e-9


def test_a_body_that_turns_unevenly_takes_torque_by_its_inertia() -> None:
    """J phi'' w^2 phi' of a disc of angle 2 t + 0.3 sin t; a point of it has its moment about the driving axis."""
    disc = Part("one", circle(25.0), 5.0)

    def poses_at(driving: np.ndarray) -> Poses:
        return Poses(0.0 * driving[None], 0.0 * driving[None], (2.0 * driving + 0.3 * np.sin(driving))[None])

    train = Train((disc,), (), poses_at, "one", 2.0 * pi, 60.0, 0.01, TrainFigures("made by hand"))
    loads = loads_of(train, 7850.0, [], 0j)
    phi, speed = loads.driving_rad, 2.0 * pi
    inertia = pi * 25.0**4 / 2.0 * 5.0 * 7850e-9
    faster, rate = -0.3 * np.sin(phi), 2.0 + 0.3 * np.cos(phi)
    assert loads.torque_n_m == pytest.approx(inertia * faster * speed**2 * rate / 1e6, rel=1e-3, abs=1e-9)
    assert loads.moment_n_m == pytest.approx(-inertia * faster * speed**2 / 1e6, rel=1e-3, abs=1e-9)


# --- what is told


def carried(cycle_rad: float = 2.0 * pi) -> Train:
    """A sun that stands still, a carrier of 100 mm, and a planet that keeps its direction: its tip runs on a circle."""
    parts = Part("sun", circle(40.0), 5.0), Part("carrier", circle(10.0), 5.0), Part("planet", circle(40.0), 5.0)

    def poses_at(driving: np.ndarray) -> Poses:
        still = 0.0 * driving
        places = np.stack([still, still, 100.0 * np.exp(1j * driving)])
        return Poses(places.real, places.imag, np.stack([still, driving, still]))

    trace = Trace("path_1", "planet", (30.0, 0.0))
    return Train(parts, (), poses_at, "carrier", cycle_rad, 60.0, 0.01, TrainFigures("made by hand"), (trace,))


def test_what_is_told_of_a_tip_that_runs_on_a_circle() -> None:
    """About 30 mm beside the axis, with 100 mm and one turn a second; the lowest place moves forwards at that speed."""
    angles = np.array([0.3, 1.7, 4.0])
    points = 30.0 + np.array([100.0, 100.4, 99.8]) * np.exp(1j * angles)
    wished = WishedPath(points, np.array([0.1, 0.5, 0.1]))
    pair = sized_pair(uniform_law(Lobes()), 20, 4.0, None)
    told = told_of(carried(), "compound", (pair, pair), radians(20.0), wished, None, -150.0, None)
    found, speed = told.figures, 100.0 * 2.0 * pi
    assert (found["carrier_mm"], found["axis_x_mm"], found["arms"]) == pytest.approx((100.0, 0.0, 1))
    assert (found["arm_mm"], found["path_length_mm"]) == pytest.approx((30.0, speed), rel=1e-5)
    assert found["tip_speed_max_mm_s"] == pytest.approx(speed, rel=1e-5)
    assert found["path_missed_mm"] == pytest.approx([0.0, 0.4, 0.2], abs=1e-3)
    assert found["point_speeds_mm_s"] == pytest.approx([speed] * 3, rel=1e-5)
    assert found["spacing_mm"] == pytest.approx(150.0)
    assert found["lowest_speed_over_ground_mm_s"] == pytest.approx(speed - 150.0, rel=1e-5)
    assert (found["modules_mm"], found["center_distances_mm"]) == ([4.0, 4.0], pytest.approx([80.0, 80.0]))
    assert (found["max_pressure_angle_deg"], found["convex"]) == (pytest.approx(20.0), True)
    held = {one.name: one for one in told.conditions}
    assert (held["assembly"].holds, held["path"].holds, held["forces"].holds) == (True, False, None)
    assert "0.2 of 0.1 mm allowed at point 3" in held["path"].said
    open_end = told_of(carried(1.5 * pi), "compound", (pair, pair), radians(20.0), None, None, 0.0, None)
    assert not open_end.conditions[0].holds


@pytest.mark.parametrize(("left", "balanced"), [(0.85, False), (0.95, True)])
def test_a_counterweight_is_told_that_takes_a_tenth_off(left: float, balanced: bool) -> None:
    wave = np.exp(1j * np.linspace(0.0, 2.0 * pi, 8, endpoint=False))
    loads = TrainLoads(
        np.angle(wave), 3.0 * wave.real + 1.0, 20.0 * wave, 5.0 * wave.imag, 40.0j, left * 20.0 * wave, 7.0
    )
    pair = sized_pair(uniform_law(Lobes()), 20, 4.0, None)
    forces = {"planet_1": 3.0 * wave, "planet_2": -9.0 * wave, "idler_1": 1j * wave}
    joints = TrainForces({("sun", "idler_1"): 4.0 * wave, ("sun", "idler_2"): 2.0 * wave}, forces, {})
    told = told_of(carried(), "compound", (pair, pair), radians(20.0), None, None, 0.0, (loads, joints))
    found = told.figures
    assert found["tooth_forces_max_n"] == pytest.approx({"sun and idler": 4.0})
    assert found["axis_forces_max_n"] == pytest.approx({"planet": 9.0, "idler": 1.0})
    assert ("on the axes", "planet 9 N; idler 1 N at most") in told.rows
    # 20 N beside 30 t are next to nothing
    heavy = replace(loads, mass_kg=30e3), joints
    at_rest = told_of(carried(), "compound", (pair, pair), radians(20.0), None, None, 0.0, heavy)
    assert {one.name: one.holds for one in at_rest.conditions}["balance"]
    assert (found["torque_min_n_m"], found["torque_max_n_m"], found["torque_mean_n_m"]) == pytest.approx(
        (-2.0, 4.0, 1.0)
    )
    assert (found["counterweight_kg_mm"], found["counterweight_deg"]) == pytest.approx((40.0, 90.0))
    assert (found["shaking_force_max_n"], found["shaking_moment_max_n_m"]) == pytest.approx((20.0, 5.0))
    assert found["shaking_force_left_max_n"] == pytest.approx(left * 20.0)
    assert {one.name: one.holds for one in told.conditions}["balance"] is balanced


def test_sizes_of_a_part_and_what_is_seen_from_behind() -> None:
    """The largest bore of a rectangle about a point 3 mm from its side; a reflected train turns the other way."""
    bar = Part(
        "bar", np.array([[-10.0, -3.0], [50.0, -3.0], [50.0, 7.0], [-10.0, 7.0]]), 5.0, holes=(PinHole(40.0, 2.0, 4.0),)
    )
    for bore_mm, fits in ((5.9, True), (6.0, False)):
        bored = replace(carried(), parts=(*carried().parts, replace(bar, bore_mm=bore_mm)))
        with nullcontext() if fits else pytest.raises(WrongInput, match="at the side of bar; the largest that fits is"):
            assert with_sound_bodies(bored) is bored
    assert replace(bar, rim_mm=2.0).reach_mm == pytest.approx(np.hypot(50.0, 7.0) + 2.0)
    above = replace(bar, low_mm=5.0)
    assert (bar.overlaps(above), bar.overlaps(replace(above, low_mm=4.9)), above.overlaps(bar)) == (False, True, False)
    train = replace(carried(), parts=(*carried().parts[:2], replace(bar, name="planet")))
    other, angles = seen_from_behind(train), np.array([0.3, 2.0])
    assert other.trace_mm(other.traces[0], angles) == pytest.approx(
        train.trace_mm(train.traces[0], angles) * [1.0, -1.0]
    )
    assert other.part("planet").holes == (PinHole(40.0, -2.0, 4.0),)
    assert shapely.Polygon(other.part("planet").outline_mm).exterior.is_ccw
    assert contact_condition(1.01).holds
    assert contact_condition(0.99, "more teeth").cures == ("more teeth",)
