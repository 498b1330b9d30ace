"""Trains of gears: judged by Willis, closed forms of elliptic chains, vector loops with 40 digits, and polygons."""

from __future__ import annotations

import json
import re
from collections.abc import Mapping
from dataclasses import replace
from functools import cache
from itertools import pairwise
from pathlib import Path
from typing import Any

import mpmath as mp
import numpy as np
import pytest
import shapely
from PIL import Image, ImageSequence
from ruamel.yaml import YAML

from at_once import at_once
from commands import ROOT, Run
from drives import TRAINS
from ncgear.design.trains.planetary import RATIOS, Planetary
from ncgear.errors import NoSuchMechanism
from ncgear.files.read_back import mesh_of_stl, outline_of_csv
from ncgear.pitch.pair import sized_pair
from ncgear.pitch.shape import Gear
from ncgear.ratio.laws.spline import even_steps, spline_ratio_staged
from ncgear.trains.contact import contacts_of, distances_of
from ncgear.trains.loads import PutMass, body_of, joint_forces, loads_of
from ncgear.trains.path_search import PathLimits, found_motion, pair_figures, segment_distances, tool_mount
from ncgear.trains.planetary_told import carrier_torque_n_m
from ncgear.trains.tip_path import TipMotion, WishedPath, missed_mm, motion_from
from ncgear.trains.train import Part, PinHole, Poses, Train
from oracles import rigid_body
from train_cases import GEARS, POINTS, UNEVEN, WISHED, NewtonAndEuler, planetary

pytestmark = pytest.mark.judges("trains")

LIMITS = PathLimits(np.radians(45.0), 28, 300.0)


@cache
def motion() -> TipMotion:
    return found_motion(WISHED, LIMITS, None)


def angles_of(train: Train, name: str, driving: Any) -> Any:
    return train.poses_at(driving).angle_rad[train.number(name)]


@at_once("idler", ["compound", "shared"])
@at_once("sun_turns", [0.0, -1.5])
def test_round_gears_turn_as_willis_says(idler: str, sun_turns: float) -> None:
    """(planet - carrier) / (sun - carrier) = 1 and (idler - carrier) / (sun - carrier) = -1 with equal teeth."""
    train = planetary(idler=idler, ratio=(1.0, 1.0, 1.0, 1.0), sun_turns=sun_turns)
    driving = np.linspace(0.0, 20.0, 41)
    turned = {name: angles_of(train, name, driving) for name in ("sun", "idler", "planet", "carrier")}
    turned = {name: angle - angle[0] for name, angle in turned.items()}
    against = turned["sun"] - turned["carrier"]
    assert np.allclose(turned["sun"], sun_turns * driving, rtol=0.0, atol=1e-12)
    assert np.allclose(turned["planet"] - turned["carrier"], against, rtol=0.0, atol=1e-10)
    assert np.allclose(turned["idler"] - turned["carrier"], -against, rtol=0.0, atol=1e-10)


RING = {"idler": "ring", "planet_turns": 3, "ratio": (1.15, 1.0, 0.9, 1.0), "gears": {**GEARS, "rim_mm": 6.0}}


@pytest.mark.slow
@at_once("sun_turns", [0.0, -0.5])
def test_a_planet_in_a_round_ring_turns_as_willis_says(sun_turns: float) -> None:
    """(planet - carrier) / (ring - carrier) = 3, and the ring turns as asked."""
    train = planetary(**RING | {"ratio": (1.0,) * 4}, sun_turns=sun_turns)
    driving = np.linspace(0.0, 20.0, 41)
    turned = {name: angles_of(train, name, driving) for name in ("ring", "planet", "carrier")}
    turned = {name: angle - angle[0] for name, angle in turned.items()}
    assert np.allclose(turned["ring"], sun_turns * driving, rtol=0.0, atol=1e-12)
    against = turned["ring"] - turned["carrier"]
    assert np.allclose(turned["planet"] - turned["carrier"], 3.0 * against, rtol=0.0, atol=1e-10)


@pytest.mark.slow
def test_a_planet_in_a_ring_has_the_speeds_that_are_asked() -> None:
    """At even angles of the carrier, by differences; their mean is three, as the planet comes back with the ring."""
    train = planetary(**RING)
    driving = np.arange(4) * (2.0 * np.pi / 12) + np.array([[-1e-4], [1e-4]])
    planet = [angles_of(train, "planet", one) - one for one in driving]
    speeds = (planet[0] - planet[1]) / 2e-4
    assert speeds / speeds[1] == pytest.approx([1.15, 1.0, 0.9, 1.0], rel=1e-6)
    whole = np.array([0.0, 2.0 * np.pi])
    assert np.diff(angles_of(train, "planet", whole)) == pytest.approx(-4.0 * np.pi, abs=1e-9)


@pytest.mark.slow
def test_planets_of_all_arms_touch_their_ring_and_a_wrong_phase_clashes() -> None:
    """By polygons; half a pitch or a whole one off, which fits round gears only."""
    train = planetary(**RING, arms=4)
    found = contacts_of(train, outlines(train))
    assert len(found) == 4
    assert max(one.penetration_max_mm for one in found) < 3.0 * train.tolerance_mm
    assert max(one.gap_max_mm for one in found) < 3.0 * train.tolerance_mm
    for pitches in (0.5, 1.0):
        turned = with_turned(train, "planet_1", 2.0 * np.pi / 18 * pitches)
        assert contacts_of(turned, outlines(turned))[0].penetration_max_mm > 0.1


def elliptic(eccentricity: float, count: int = 360) -> tuple[float, ...]:
    """du/dv over v of two ellipses about foci: tan(v/2) = k tan(u/2) with k = (1 + e) / (1 - e)."""
    k, half = (1.0 + eccentricity) / (1.0 - eccentricity), np.arange(count) * (np.pi / count)
    return tuple((k / (k**2 * np.cos(half) ** 2 + np.sin(half) ** 2)).tolist())


@pytest.mark.slow
def test_an_elliptic_chain_has_its_closed_form() -> None:
    """Three equal ellipses: tan(w/2) = ((1 + e) / (1 - e))^2 tan(u/2)."""
    train = planetary(idler="shared", ratio=elliptic(0.25))
    u = np.linspace(-2.9, 2.9, 59)
    planet = u - (angles_of(train, "planet", u) - angles_of(train, "planet", np.zeros(1)))
    assert np.allclose(np.tan(planet / 2.0), (1.25 / 0.75) ** 2 * np.tan(u / 2.0), rtol=1e-6)


@pytest.mark.slow
@pytest.mark.parametrize("bend", [None, 50.0])
def test_a_shared_idler_makes_odd_harmonics_only_where_it_is_straight(bend: float | None) -> None:
    train = planetary(idler="shared", bend_deg=bend)
    u = np.linspace(0.0, 2.0 * np.pi, 20001)
    planet, idler = (angles_of(train, name, u) - u for name in ("planet", "idler"))
    rate = np.log(np.gradient(u, -planet))
    even = np.interp(np.arange(512) * 2.0 * np.pi / 512, idler - idler[0], rate)
    waves = np.abs(np.fft.rfft(even)) / 512
    assert (waves[0:8:2].max() < 1e-3 * waves[1:8:2].max()) == (bend is None)


@pytest.mark.slow
def test_the_share_of_both_pairs_is_judged_as_their_pitch_curves_are() -> None:
    """Tangents and curvatures of the search are those of the pairs that are made, found there by another way."""
    found = pair_figures(motion())
    laws = spline_ratio_staged(even_steps(RATIOS), motion().ratio(RATIOS)[1], np.sqrt(motion().ratio(RATIOS)[1]))
    for pair, (tangent, *curvatures) in zip(laws.train.pairs, found.transpose(1, 0, 2), strict=True):
        pitch = sized_pair(pair.transmission, 20, None, 1.0)
        assert np.arctan(np.abs(tangent).max()) == pytest.approx(pitch.largest_tangent_angle_rad.value, rel=2e-3)
        for gear, curvature in zip(Gear, curvatures, strict=True):
            low, high = (one.value for one in pitch.curvature_range[gear])
            assert [curvature.min(), curvature.max()] == pytest.approx([low, high], rel=5e-3, abs=2e-2)


@pytest.mark.slow
def test_the_tip_goes_where_a_vector_loop_with_40_digits_says() -> None:
    """From the carrier's angle alone, by a Newton search in mpmath, and back by two circles that cross."""
    path = {"points_mm": [[one.real, one.imag] for one in POINTS], "longest_mm": 300.0}
    gears = {"teeth": 28, "face_width_mm": 8.0}
    keys = Planetary.model_validate({"speed_rpm": 60.0, "path": path, "gears": gears, "arms": 2})
    assert keys.path is not None
    train = keys.train()
    found = keys._motion(keys.path, keys.path.wished())
    driving = np.linspace(0.0, 2.0 * np.pi, 7)[:-1] + 0.3
    with mp.workdps(40):
        waves = [mp.mpf(float(one)) for one in found.waves]
        half = len(waves) // 2

        def carrier(w: Any) -> Any:
            turned = [waves[k - 1] * mp.cos(k * w) + waves[half + k - 1] * mp.sin(k * w) for k in range(1, half + 1)]
            return w + found.start_rad + mp.fsum(turned)

        for trace in train.traces:
            offset = 0.0 if trace is train.traces[0] else np.pi
            for angle, place in zip(driving, train.trace_mm(trace, driving), strict=True):
                u = carrier(0) + mp.mpf(float(angle)) + offset
                w = mp.findroot(lambda w, u=u: carrier(w) - u, mp.mpf(float(angle)) + offset)
                there = found.carrier_mm * mp.expj(u) + found.arm_mm * mp.expj(u - w)
                tip = found.axis + complex(there.conjugate() if found.clockwise else there)
                assert abs(complex(*place) - tip) < 2e-4
                r = abs(there)
                inner = mp.acos((found.carrier_mm**2 + r**2 - found.arm_mm**2) / (2 * found.carrier_mm * r))
                ways = [mp.arg(there) + sign * inner - u for sign in (1, -1)]
                assert min(abs(mp.expj(one) - 1) for one in ways) < mp.mpf(10) ** -12
    assert missed_mm(found, WISHED).max() <= 0.1


@pytest.mark.slow
def test_the_nearest_and_the_farthest_place_give_both_lengths() -> None:
    w = np.linspace(0.0, 2.0 * np.pi, 4001)
    r = np.abs(motion().tip(w) - motion().axis)
    lengths = sorted((motion().carrier_mm, motion().arm_mm))
    assert [r.max() + r.min(), r.max() - r.min()] == pytest.approx([2.0 * lengths[1], 2.0 * lengths[0]], rel=1e-6)
    assert np.diff(motion().carrier_rad(w)).min() > 0.0


@pytest.mark.slow
def test_a_mirrored_path_has_a_mirrored_train() -> None:
    one = motion_from(WISHED, motion().axis, (1.0, 1.0), clockwise=True)
    other = motion_from(WISHED.mirrored, motion().axis.conjugate(), (1.0, 1.0), clockwise=False)
    assert isinstance(one, TipMotion)
    assert isinstance(other, TipMotion)
    w = np.linspace(0.0, 6.0, 50)
    assert np.allclose(one.tip(w), other.tip(w).conj(), atol=1e-9)


def test_distances_of_arms_are_those_of_shapely() -> None:
    ends = np.random.default_rng(5).normal(size=(4, 200)) + 1j * np.random.default_rng(6).normal(size=(4, 200))
    lines = [
        [shapely.LineString([[a.real, a.imag], [b.real, b.imag]]) for a, b in zip(*ends[two : two + 2], strict=True)]
        for two in (0, 2)
    ]
    assert np.allclose(segment_distances(*ends), shapely.distance(*lines), atol=1e-12)


@pytest.mark.slow
def test_the_tools_angles_are_kept_or_refused() -> None:
    tools = replace(WISHED, tool_rad=((0, -1.57), (5, -1.75)), tool_tolerance_rad=0.14)
    found = found_motion(tools, LIMITS, None)
    assert tool_mount(found, tools)[1] <= 0.14 * 1.001
    with pytest.raises(NoSuchMechanism) as refused:
        found_motion(replace(tools, tool_rad=((0, -1.57), (1, 1.57))), LIMITS, None)
    assert refused.value.key.startswith("path.")


@pytest.mark.slow
def test_a_straight_stretch_is_straight() -> None:
    """From point 3 to point 4 by shapely; without the wish the path bulges there."""
    wished = WishedPath(POINTS, np.full(POINTS.size, 0.1), ((3, -1.5), (6, -1.7)), 3.0)
    added = wished.straightened([2])
    assert [added.name(place) for place in range(2, 8)] == [3, 3, 3, 3, 4, 5]
    assert added.points[added.tool_rad[0][0]] == POINTS[3]
    ends = [[one.real, one.imag] for one in POINTS[2:4]]
    line, middle = shapely.LineString(ends), shapely.box(-84.0, 72.0, -61.0, 128.0)
    off = []
    for path in (added, WISHED):
        tip = found_motion(path, LIMITS, None).tip(np.linspace(0.0, 2.0 * np.pi, 4001))
        near = [one for one in shapely.points(tip.real, tip.imag) if middle.contains(one)]
        off.append(max(line.distance(one) for one in near))
    assert off[0] < 0.12 < 0.5 < off[1]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("points", "axis", "said"),
    [
        (POINTS, -30.0 + 120.0j, "fall and rise once only"),
        (POINTS[np.random.default_rng(2).permutation(12)], None, "no carrier passes the points"),
    ],
)
def test_what_no_gears_do_is_refused_with_where(points: Any, axis: complex | None, said: str) -> None:
    with pytest.raises(NoSuchMechanism, match=said) as refused:
        found_motion(WishedPath(points, np.full(points.size, 0.1)), LIMITS, axis)
    assert refused.value.key == "path.points_mm"


# --- contact -----------------------------------------------------------------------------------------------------


def outlines(train: Train) -> dict[str, Any]:
    return {part.name: part.outline_mm for part in train.parts}


def with_turned(train: Train, name: str, by_rad: float) -> Train:
    """The train with a part put in at another phase."""

    def poses_at(driving: Any) -> Poses:
        poses = train.poses_at(driving)
        angle = poses.angle_rad.copy()
        angle[train.number(name)] += by_rad
        return replace(poses, angle_rad=angle)

    return replace(train, poses_at=poses_at)


@pytest.mark.slow
@pytest.mark.parametrize(("idler", "arms", "bend"), [("compound", 2, None), ("shared", 3, None), ("shared", 1, 50.0)])
def test_all_meshes_of_all_arms_touch_and_none_overlaps(idler: str, arms: int, bend: float | None) -> None:
    train = planetary(idler=idler, arms=arms, sun_turns=-0.5, bend_deg=bend)
    found = contacts_of(train, outlines(train))
    assert len(found) == 2 * arms
    assert max(one.penetration_max_mm for one in found) < 3.0 * train.tolerance_mm
    assert max(one.gap_max_mm for one in found) < 3.0 * train.tolerance_mm


@pytest.mark.slow
@pytest.mark.parametrize("idler", ["compound", "shared"])
def test_a_wrong_phase_clashes(idler: str) -> None:
    """By half a pitch or by a whole one: gears that are not round fit at one tooth only."""
    train = planetary(idler=idler)
    for pitches in (0.5, 1.0):
        turned = with_turned(train, "planet", 2.0 * np.pi / 18 * pitches)
        assert contacts_of(turned, outlines(train))[1].penetration_max_mm > 0.1


def seen_by_the_carrier(train: Train, body: str, fixed: tuple[str, ...] = ()) -> rigid_body.Wheel:
    """A body of a train whose carrier stands at 0, in the frame of the carrier, in which all axes stand."""
    poses = train.poses_at(np.array([0.0, 1e-4]))
    turned = poses.angle_rad - poses.angle_rad[train.number("carrier")]
    own, pieces = train.number(body), {}
    for name in (body, *fixed):
        number = train.number(name)
        outline = train.parts[number].outline_mm @ [1.0, 1j] * np.exp(1j * (turned[number] - turned[own])[0])
        layer = 2 if round(train.parts[number].low_mm) else 1
        pieces[layer] = rigid_body.convex_pieces(np.stack([outline.real, outline.imag], axis=-1))
    return rigid_body.Wheel(poses.places(own)[0][0], turned[own, 0], np.diff(turned[own])[0] / 1e-4, pieces)


@pytest.mark.slow
@pytest.mark.parametrize(("idler", "plays"), [("compound", 0), ("shared", 1)])
def test_toothed_bodies_under_load_turn_as_the_train_says(idler: str, plays: int) -> None:
    """By pymunk, which knows outlines and no law: the sun turns, idler and planet are pushed by teeth alone, and a drag
    holds the planet back.  A planet half a pitch off jams.

    Allowed is what chords, slop and steps explain in two meshes (see test_rigid_body.py), beside the play: a shared
    idler pushes its planet with the flanks that have it.
    """
    train, steps, drag = planetary(idler=idler), 3000, 3.0
    compound = ("second_idler",) if idler == "compound" else ()
    wheels = [seen_by_the_carrier(train, *one) for one in (("sun",), ("idler", compound), ("planet",))]
    planet = train.number("planet")

    def behind(last: rigid_body.Wheel) -> Any:
        angles = rigid_body.train_turned([*wheels[:2], last], drag, steps)
        driving = wheels[0].angle - angles[:, 0]
        return angles[:, 2] - (train.poses_at(driving).angle_rad[planet] - driving)

    speeds = np.gradient(train.poses_at(np.linspace(0.0, 2.0 * np.pi, 721)).angle_rad, axis=1) * 720 / (2.0 * np.pi) - 1
    ratio = np.abs(speeds[planet] / speeds[train.number("idler")])
    apart_mm = abs(wheels[2].place - wheels[1].place)
    lever_mm = apart_mm / (1.0 + ratio.max()) * np.cos(np.radians(35.0))
    allowed = (
        2.0 * (2.0 * train.tolerance_mm + rigid_body.SLOP) / lever_mm + 6.0 * (drag + 1.0) * (2.0 * np.pi / steps) ** 2
    )
    found = behind(wheels[2])
    assert -allowed < found.min()
    assert found.max() < allowed + plays * 0.05 / lever_mm
    off = behind(replace(wheels[2], angle=wheels[2].angle + np.pi / 18))
    assert np.abs(off).max() > 10.0 * allowed


@pytest.mark.slow
def test_penetration_is_what_shapely_says_of_two_round_parts() -> None:
    """Two polygons of known distance: how deep a corner of one lies in the other, and the gap."""
    train = planetary(ratio=(1.0, 1.0, 1.0, 1.0))
    circle = 20.0 * np.exp(2j * np.pi * np.arange(800) / 800)
    ring = np.stack([circle.real, circle.imag], axis=-1)
    sun, idler = (
        complex(*(getattr(train.poses_at(np.zeros(1)), c)[train.number(n), 0] for c in ("x_mm", "y_mm")))
        for n in ("sun", "idler")
    )
    apart = abs(sun - idler) - 40.0
    found = contacts_of(train, dict.fromkeys(outlines(train), ring))[0]
    assert apart < 0.0
    assert found.penetration_max_mm == pytest.approx(-apart, abs=1e-2)
    wider = contacts_of(train, dict.fromkeys(outlines(train), ring * 0.8))[0]
    assert wider.gap_max_mm == pytest.approx(apart + 8.0, abs=1e-2)


@pytest.mark.slow
def test_arms_that_meet_are_told() -> None:
    """Arms longer than the carrier cross where both planets swing to one side."""
    train = planetary(arms=2, arm_mm=150.0)
    near = {(one.first, one.second): one.least_distance_mm for one in distances_of(train, outlines(train))}
    apart = near["arm_1", "arm_2"]
    lines = []
    for driving in np.linspace(0.0, 2.0 * np.pi, 721):
        both = []
        for trace in train.traces:
            poses = train.poses_at(np.array([driving]))
            number = train.number(trace.part)
            start = [poses.x_mm[number, 0], poses.y_mm[number, 0]]
            both.append(shapely.LineString([start, train.trace_mm(trace, np.array([driving]))[0]]))
        lines.append(shapely.distance(*both))
    assert apart == pytest.approx(min(lines) - 20.0, abs=0.1) if min(lines) > 20.0 else apart < 0.0


# --- forces ------------------------------------------------------------------------------------------------------


def test_a_part_weighs_what_closed_forms_say() -> None:
    """A bar with a bore and a hole as rectangles and circles, and a mass at its end."""
    outline = np.array([[-10.0, -5.0], [50.0, -5.0], [50.0, 5.0], [-10.0, 5.0]])
    part = Part("bar", outline, 8.0, bore_mm=6.0, holes=(PinHole(40.0, 1.0, 4.0),))
    body = body_of(part, 7850.0, [PutMass("bar", 50.0 + 0.0j, 0.02)])
    areas = np.array([600.0, -np.pi * 9.0, -np.pi * 4.0])
    own = np.array([(60.0**2 + 10.0**2) / 12.0, 9.0 / 2.0, 4.0 / 2.0, 0.0])
    kg, at = np.append(areas * 7850e-9 * 8.0, 0.02), np.array([20.0, 0.0, 40.0 + 1.0j, 50.0])
    center = (kg * at).sum() / kg.sum()
    assert body.kg == pytest.approx(kg.sum(), rel=1e-12)
    assert body.center_mm == pytest.approx(center, rel=1e-12)
    assert body.kg_mm2 == pytest.approx((kg * (own + np.abs(at - center) ** 2)).sum(), rel=1e-12)


def test_every_arm_goes_where_the_first_one_went_a_third_of_a_turn_before() -> None:
    """About a sun that stands still all arms are one chain: gears, planets and tips alike."""
    train = planetary(arms=3, arm_mm=90.0)
    driving, third = np.array([0.2, 1.9, 5.0]), 2.0 * np.pi / 3.0
    names = [part.name for part in train.parts]
    for kind in ("idler", "second_idler", "planet", "arm"):
        arms = [number for number, name in enumerate(names) if name.rstrip("_123") == kind]
        assert len(arms) == 3
        for turns, number in enumerate(arms):
            now, before = train.poses_at(driving), train.poses_at(driving + turns * third)
            assert now.x_mm[number] == pytest.approx(before.x_mm[arms[0]], abs=1e-9)
            assert now.y_mm[number] == pytest.approx(before.y_mm[arms[0]], abs=1e-9)
            turned = now.angle_rad[number] - before.angle_rad[arms[0]]
            assert np.exp(1j * turned) == pytest.approx(np.ones(3))


@pytest.mark.parametrize("arms", [1, 3])
def test_torque_and_shaking_force_are_those_of_newton_and_euler(arms: int) -> None:
    train = replace(planetary(arms=arms, arm_mm=90.0, arm_deg=25.0), speed_rpm=600.0)
    tools = [PutMass(trace.part, complex(*trace.at_mm), 0.4) for trace in train.traces]
    loads = loads_of(train, 7850.0, tools, -9806.65j)
    most = np.abs(loads.torque_n_m).max(), np.abs(loads.force_n).max()
    for number in (0, 100, 333, 700, 1201):
        torque, force, _ = NewtonAndEuler(train, 7850.0, 0.4, float(loads.driving_rad[number])).solved()
        assert loads.torque_n_m[number] == pytest.approx(torque, abs=1e-4 * most[0])
        assert loads.force_n[number] == pytest.approx(force, abs=1e-4 * most[1])
    assert loads.torque_n_m.mean() == pytest.approx(0.0, abs=1e-4 * most[0])
    around, speed = np.exp(1j * loads.driving_rad), train.speed_rpm * 2.0 * np.pi / 60.0
    found = loads.counterweight_kg_mm
    left = [
        np.mean(np.abs(loads.force_n + w * speed**2 / 1e3 * around) ** 2)
        for w in (found, found + 1.0, found - 1.0, found + 1.0j, found - 1.0j)
    ]
    assert np.mean(np.abs(loads.left_n) ** 2) == pytest.approx(left[0], rel=1e-9, abs=1e-12)
    assert min(left) == left[0]


@at_once("sun_turns", [-1.5, 1.0 / 3.0])
def test_torques_of_carrier_and_sun_are_those_of_newton_and_euler(sun_turns: float) -> None:
    """Newton's equations know the carrier's torque; what it and the sun's do together is nothing over a cycle.

    By virtual work alone, as about a sun that stands, the torque would be another.
    """
    train = replace(planetary(arms=2, arm_mm=90.0, arm_deg=25.0, sun_turns=sun_turns), speed_rpm=600.0)
    put = 7850.0, [PutMass(trace.part, complex(*trace.at_mm), 0.4) for trace in train.traces], -9806.65j
    loads, joints = loads_of(train, *put), joint_forces(train, np.radians(20.0), *put)
    torque = carrier_torque_n_m(train, loads, joints)
    most = np.abs(torque).max(), np.abs(loads.force_n).max()
    for number in (0, 333, 1201, loads.driving_rad.size - 7):
        found, force, _ = NewtonAndEuler(train, 7850.0, 0.4, float(loads.driving_rad[number])).solved()
        assert torque[number] == pytest.approx(found, abs=1e-4 * most[0])
        assert loads.force_n[number] == pytest.approx(force, abs=1e-4 * most[1])
    (sun,) = joints.driven_n_m.values()
    assert (torque + sun_turns * sun).mean() == pytest.approx(0.0, abs=1e-6 * most[0])
    assert np.abs(torque - loads.torque_n_m).max() > 0.1 * most[0]
    ends = train.poses_at(np.array([0.0, train.cycle_rad]))
    assert np.exp(1j * ends.angle_rad[:, 1]) == pytest.approx(np.exp(1j * ends.angle_rad[:, 0]), abs=1e-9)


@pytest.mark.parametrize("keys", [{"arms": 2}, {"carrier_ratio": (1.2, 1.0, 0.8, 1.0)}])
def test_forces_of_teeth_and_axes_are_those_of_newton_and_euler(keys: dict[str, Any]) -> None:
    train = replace(planetary(**keys, arm_mm=90.0, arm_deg=25.0), speed_rpm=600.0)
    put = [PutMass(trace.part, complex(*trace.at_mm), 0.4) for trace in train.traces]
    found = joint_forces(train, np.radians(20.0), 7850.0, put, -9806.65j)
    driving = loads_of(train, 7850.0, put, -9806.65j).driving_rad
    for number in (0, 100, 333, 700, 1201):
        judge = NewtonAndEuler(train, 7850.0, 0.4, float(driving[number]))
        judge.solved()
        for forces, wanted in ((found.teeth_n, judge.teeth), (found.axes_n, judge.axes)):
            assert set(forces) == set(wanted)
            for name, one in wanted.items():
                assert forces[name][number] == pytest.approx(one, abs=2e-4 * np.abs(forces[name]).max())


@pytest.mark.parametrize(
    "keys",
    [
        {"arm_mm": 90.0, "idler": "shared", "bend_deg": -70.0},
        {"idler": "ring", "planet_turns": 3, "ratio": (1.15, 1.0, 0.9, 1.0), "gears": {**GEARS, "rim_mm": 6.0}},
    ],
)
def test_axes_give_the_carrier_the_torque_of_virtual_work(keys: dict[str, Any]) -> None:
    """The moments of all axes about the carrier's, and of the carrier's own weight."""
    train = replace(planetary(**keys), speed_rpm=300.0)
    put = [PutMass(trace.part, complex(*trace.at_mm), 0.4) for trace in train.traces]
    found, loads = (
        joint_forces(train, np.radians(20.0), 7850.0, put, -9806.65j),
        loads_of(train, 7850.0, put, -9806.65j),
    )
    poses, carrier = train.poses_at(loads.driving_rad), train.number("carrier")
    axis, turn = poses.places(carrier)
    body = body_of(train.part("carrier"), 7850.0)
    torque = (np.conj(body.center_mm * turn) * body.kg * 9806.65j).imag / 1e6
    for name, force in found.axes_n.items():
        torque += ((poses.places(train.number(name))[0] - axis).conj() * force).imag / 1e3
    assert torque == pytest.approx(loads.torque_n_m, abs=1e-9 * np.abs(loads.torque_n_m).max())


@pytest.mark.slow
def test_one_arm_is_told_to_have_a_counterweight() -> None:
    masses = {"density_kg_m3": 7850.0, "tool_kg": 0.4}
    keys = {"speed_rpm": 60.0, "ratio": UNEVEN, "gears": GEARS, "arm_mm": 90.0, "masses": masses}
    told = {arms: Planetary.model_validate({**keys, "arms": arms}).train().told for arms in (1, 2)}
    held = {arms: {one.name: one.holds for one in found.conditions}["balance"] for arms, found in told.items()}
    assert held == {1: False, 2: True}
    now, left = (told[1].figures[name] for name in ("shaking_force_max_n", "shaking_force_left_max_n"))
    assert left < 0.9 * now


@pytest.mark.slow
def test_a_carrier_that_teeth_do_not_span_is_refused_with_the_module_that_would() -> None:
    path = {"points_mm": [[one.real, one.imag] for one in POINTS], "longest_mm": 300.0}
    keys = {"speed_rpm": 60.0, "path": path}
    with pytest.raises(NoSuchMechanism, match="do not span") as refused:
        Planetary.model_validate({**keys, "gears": {**GEARS, "teeth": 28, "module_mm": 1.0}}).train()
    assert refused.value.key == "train.gears"
    module = float(refused.value.problem.partition("a module of ")[2].split()[0])
    assert Planetary.model_validate({**keys, "gears": {**GEARS, "teeth": 28, "module_mm": module * 1.001}}).train()


# --- commands ----------------------------------------------------------------------------------------------------

FILE = """\
name: mine
train:
  kind: planetary
  speed_rpm: 60
  ratio: [1.3, 1.0, 0.8, 0.9, 1.0, 1.1]
  gears: {teeth: 18, module_mm: 2, face_width_mm: 8, backlash_mm: 0.05}
"""


def written(text: str) -> Path:
    place = Path("mine.yaml")
    place.write_text(text)
    return place


@pytest.mark.slow
def test_a_check_says_what_the_train_is(run: Run) -> None:
    status, out, err = run("check", str(written(FILE)))
    assert (status, err) == (0, "")
    assert "planetary train, compound idler, 1 arm" in out
    assert "Not judged: forces" in out
    assert "teeth (undercut, tips and strength" in out


RING_FILE = FILE.replace("ratio:", "idler: ring\n  planet_turns: 3\n  ratio:").replace("teeth:", "rim_mm: 6, teeth:")


@at_once(
    ("command", "text"),
    [
        *((one, TRAINS["lobed-motor"].read_text()) for one in ("simulate", "strength", "balance", "tolerance", "size")),
        ("strength", RING_FILE),
    ],
)
def test_other_commands_say_what_works(run: Run, command: str, text: str) -> None:
    status, _, err = run(command, str(written(text)))
    assert status == 2
    assert re.match(r"mine.yaml:\d+:1: train: ", err)
    assert "which `check`, `build`, `report`, `animate` and `studio` of ncgear take; this needs" in err


@at_once("command", ["simulate", "size", "compare mine.yaml", "sweep --vary train.speed_rpm=60:90"])
def test_gears_on_a_carrier_have_no_power_of_gears_on_fixed_axes(run: Run, command: str) -> None:
    """Loads hold for both; the power of the sun as it turns beside the carrier is nobody's."""
    _ = written(FILE)
    status, _, err = run(*command.split(), "mine.yaml")
    assert status == 2
    assert "`animate`, `studio`, `strength` and `tolerance` of ncgear take" in err


@at_once(
    ("old", "new", "said"),
    [
        ("kind: planetary", "kind: planetry", "mine.yaml:3:3: train.kind: 'planetry' given; planetary"),
        ("  ratio: [1.3, 1.0, 0.8, 0.9, 1.0, 1.1]\n", "", "mine.yaml:2:1: train: one of ratio or path is missing"),
        ("teeth: 18", "teeth: 18.5", "mine.yaml:6:11: train.gears.teeth: 18.5 given; a whole number is needed"),
        ("teeth: 18", "tooth: 18", "mine.yaml:6:11: train.gears.tooth: unknown key"),
        ("module_mm: 2, ", "", "mine.yaml:6:3: train.gears: module_mm or center_distance_mm is missing"),
        (
            "teeth: 18",
            "bore_mm: 40, teeth: 18",
            "bore_mm: 40 mm leaves less than 2 mm, one module, at the side of carrier; the largest that fits is 15.9",
        ),
        (
            "teeth: 18",
            "bore_mm: 20, teeth: 18",
            "bore_mm: 20 mm leaves less than 2 mm, one module, at the side of carrier; the largest that fits is 15.9",
        ),
        ("teeth: 18", "chord_tolerance_mm: 1, teeth: 18", "train.gears.chord_tolerance_mm: 1 mm are 0.5 of the module"),
        ("backlash_mm: 0.05", "backlash_mm: 9", "train.gears.backlash_mm: 9 mm takes more than 80%"),
    ],
)
def test_a_wrong_file_is_told_by_line_and_key(run: Run, old: str, new: str, said: str) -> None:
    status, _, err = run("check", str(written(FILE.replace(old, new))))
    assert status == 2
    assert said in err


@pytest.mark.slow
def test_the_schema_takes_worked_trains_and_no_misspelt_one(run: Run) -> None:
    import jsonschema

    judge = jsonschema.Draft202012Validator(json.loads(run("schema", "--of", "train")[1]))
    for path in TRAINS.values():
        data = YAML(typ="safe").load(path.read_text(encoding="utf-8"))
        assert judge.is_valid(data), path.name
        assert not judge.is_valid({**data, "train": {**data["train"], "arsm": 1}})


def test_options_that_are_not_offered_are_refused(run: Run) -> None:
    status, _, err = run("build", str(written(FILE)), "--report")
    assert (status, "--report: given, but not offered for a train" in err) == (2, True)


@pytest.mark.slow
def test_an_animation_moves_every_part(run: Run) -> None:
    status, out, _ = run("animate", str(written(FILE)), "--frames", "3", "--width", "320", "--out", "moving.gif")
    assert (status, out.split(":")[0]) == (0, "wrote moving.gif")
    with Image.open("moving.gif") as picture:
        frames = [np.array(frame.convert("RGB"), dtype=int) for frame in ImageSequence.Iterator(picture)]
    assert len(frames) == 3
    assert min(np.abs(one - other).max() for one, other in pairwise(frames)) > 100


@pytest.mark.slow
def test_the_worked_transplanter_keeps_its_promises(run: Run, tmp_path: Path) -> None:
    """All files, sound solids, all conditions, the path within 0.1 mm by a reader of its own, poses that mesh."""
    status, _, err = run("build", str(ROOT / "designs" / "transplanter.yaml"), "--out", str(tmp_path / "out"))
    assert status == 0, err
    out = tmp_path / "out"
    summary = json.loads((out / "summary.json").read_text())
    judged = {one["condition"]: one["holds"] for one in summary["verdict"]}
    assert judged == {
        "assembly": True,
        "path": True,
        "forces": None,
        "balance": True,
        "meshes": True,
        "room": True,
        "teeth": None,
    }
    assembly = json.loads((out / "assembly.json").read_text())
    parts = {one["name"]: one for one in assembly["parts"]}
    assert {f"{name}.{end}" for name in parts for end in ("csv", "stl")} <= {path.name for path in out.iterdir()}
    for name, part in parts.items():
        mesh = mesh_of_stl((out / f"{name}.stl").read_bytes())
        assert mesh.is_watertight
        area = shapely.Polygon(outline_of_csv((out / f"{name}.csv").read_bytes())).area
        assert 0.5 * area < mesh.volume / 10.0 <= area * (1.0 + 1e-6), part
    path = np.loadtxt(out / "path_1.csv", delimiter=",", skiprows=1)[:, 1:]
    line = shapely.LineString(path)
    missed = [line.distance(shapely.Point(one.real, one.imag)) for one in POINTS]
    assert max(missed) <= 0.1
    clash_free(assembly, parts, out)
    content = (out / "train.glb").read_bytes()
    moving = json.loads(content[20 : 20 + int.from_bytes(content[12:16], "little")])
    assert {one["target"]["path"] for one in moving["animations"][0]["channels"]} == {"rotation", "translation"}
    assert len(moving["animations"][0]["channels"]) == 2 * len(parts)


def clash_free(assembly: Mapping[str, Any], parts: Mapping[str, Any], out: Path) -> None:
    """All pairs in mesh at some of the written poses, placed by hand: the area that they share is next to nothing."""
    for mesh in assembly["meshes"]:
        for number in (0, 100, 333, 500):
            placed = []
            for name in (mesh["first"], mesh["second"]):
                one = parts[name]
                points = outline_of_csv((out / f"{name}.csv").read_bytes()) @ np.array([1.0, 1.0j])
                points = points * np.exp(1j * one["angle_rad"][number]) + one["x_mm"][number] + 1j * one["y_mm"][number]
                placed.append(shapely.Polygon(np.stack([points.real, points.imag], axis=-1)))
            assert placed[0].intersection(placed[1]).area < 0.05
            assert placed[0].distance(placed[1]) < 0.05
