"""Trains made by hand: paths whose carrier and waves are known, round parts on fixed axes, bodies that swing evenly."""

from __future__ import annotations

from dataclasses import replace
from math import acos, atan, cos, pi, sin
from typing import Any

import numpy as np
import pytest
import shapely

from ncgear.pitch.shape import Mesh
from ncgear.trains import path_search
from ncgear.trains.contact import contacts_of, distances_of
from ncgear.trains.loads import PutMass, loads_of
from ncgear.trains.path_search import PathLimits, burden, crowding, found_motion, pair_figures, tool_mount
from ncgear.trains.tip_path import HARMONICS, Refused, TipMotion, WishedPath, distances_mm, missed_mm, motion_from
from ncgear.trains.train import GearMesh, Part, Poses, Told, Train

pytestmark = pytest.mark.judges("trains")


def motion(carrier: float, arm: float, swing: float = 0.2, *, clockwise: bool = False) -> TipMotion:
    """u = w + 0.4 + swing (0.7 cos w + sin w) about an axis at 30 + 10i."""
    waves = np.zeros(2 * HARMONICS)
    waves[0], waves[HARMONICS] = 0.7 * swing, swing
    return TipMotion(30.0 + 10.0j, carrier, arm, 0.4, waves, clockwise)


@pytest.mark.parametrize("clockwise", [False, True])
@pytest.mark.parametrize(("carrier", "arm"), [(100.0, 60.0), (60.0, 100.0)])
def test_a_path_that_is_known_is_found_from_its_points(carrier: float, arm: float, clockwise: bool) -> None:
    """The lengths are half the sum and half the difference of the greatest and the least distance from the axis."""
    known = motion(carrier, arm, clockwise=clockwise)
    w = 2.0 * pi * (np.arange(16) + 0.3) / 16
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
    assert isinstance(motion_from(aside, known.axis, beyond, clockwise=clockwise), Refused)
    on_path = motion_from(path, complex(path.points[3]) + 0.1, beyond, clockwise=clockwise)
    assert isinstance(on_path, Refused)
    # From the other side it turns against the carrier, where the path goes around the axis
    if carrier > arm:
        against = motion_from(path, known.axis, beyond, clockwise=not clockwise)
        assert isinstance(against, Refused)
        assert "against the carrier" in against.words


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
    return Train(parts, mesh, poses_at, "one", 2.0 * pi, 60.0, 0.01, Told("made by hand"))


def test_two_circles_come_apart_and_overlap_by_what_their_distance_says() -> None:
    """Axes at 39.5 + 0.8 cos of a cycle, radii 25 and 15: 0.3 mm apart at first, 1.3 mm deep half a cycle later."""
    parts = Part("one", circle(25.0), 5.0), Part("two", circle(15.0), 5.0)
    (found,) = contacts_of(round_train(39.5, 0.8, *parts), {one.name: one.outline_mm for one in parts})
    assert (found.deepest_mm, found.gap_mm) == (pytest.approx(1.3, abs=0.02), pytest.approx(0.3, abs=0.02))
    assert found.deepest_at_rad == pytest.approx(pi, abs=0.02)
    assert cos(found.gap_at_rad) == pytest.approx(1.0, abs=2e-3)
    assert found.clashes(1.2)
    assert not found.clashes(1.4)
    assert found.parts(0.2)
    assert not found.parts(0.4)


def test_a_circle_in_a_ring_touches_where_the_axes_are_as_far_apart_as_the_radii_differ() -> None:
    """Axes 9.8 + 0.5 cos apart, radii 30 of the ring and 20: 0.3 mm too deep at first, 0.7 mm short half a cycle on."""
    parts = Part("one", circle(20.0), 5.0), Part("two", circle(30.0), 5.0, rim_mm=5.0)
    train = round_train(9.8, 0.5, *parts, kind=Mesh.INTERNAL)
    (found,) = contacts_of(train, {one.name: one.outline_mm for one in parts})
    assert (found.deepest_mm, found.gap_mm) == (pytest.approx(0.3, abs=0.02), pytest.approx(0.7, abs=0.02))


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
    assert found["one", "wide"].least_mm == pytest.approx(-(lens**0.5), rel=0.02)
    # An ellipse, whose narrow side is turned to the circle and which would touch it with its long one
    narrow = replace(parts[2], outline_mm=parts[2].outline_mm * [0.5, 1.0])
    near = round_train(44.5, 0.8, parts[0], narrow, kind=None)
    (one,) = distances_of(near, {part.name: part.outline_mm for part in (parts[0], narrow)})
    assert one.least_mm == pytest.approx(44.5 - 0.8 - 25.0 - 10.0, abs=0.02)
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
    assert loads.swing_n_m == (loads.torque_n_m.min(), loads.torque_n_m.max())


def test_a_body_that_turns_unevenly_takes_torque_by_its_inertia() -> None:
    """J phi'' w^2 phi' of a disc of angle 2 t + 0.3 sin t; a point of it has its moment about the driving axis."""
    disc = Part("one", circle(25.0), 5.0)

    def poses_at(driving: np.ndarray) -> Poses:
        return Poses(0.0 * driving[None], 0.0 * driving[None], (2.0 * driving + 0.3 * np.sin(driving))[None])

    train = Train((disc,), (), poses_at, "one", 2.0 * pi, 60.0, 0.01, Told("made by hand"))
    loads = loads_of(train, 7850.0, [], 0j)
    phi, speed = loads.driving_rad, 2.0 * pi
    inertia = pi * 25.0**4 / 2.0 * 5.0 * 7850e-9
    faster, rate = -0.3 * np.sin(phi), 2.0 + 0.3 * np.cos(phi)
    assert loads.torque_n_m == pytest.approx(inertia * faster * speed**2 * rate / 1e6, rel=1e-3, abs=1e-9)
    assert loads.moment_n_m == pytest.approx(-inertia * faster * speed**2 / 1e6, rel=1e-3, abs=1e-9)
