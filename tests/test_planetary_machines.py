"""The gears of a planetary train as a machine by themselves, as the carrier sees them, in every command.

The judges are the poses of the train, Newton's and Euler's equations of every body, and single round pairs.
"""

from __future__ import annotations

import json
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import shapely
from scipy.interpolate import CubicSpline

from at_once import at_once
from drives import drive_of_text
from ncgear.design.reading.design_file import load
from ncgear.design.trains.planetary import Planetary
from ncgear.errors import NoSuchMechanism, WrongInput
from ncgear.pitch.shape import Gear
from ncgear.project.drive import Drive
from ncgear.project.strengthening import rating_of
from ncgear.strength.conditions import Running
from ncgear.strength.holding import Damage
from ncgear.trains.loads import PutMass, loads_of, turning_load
from ncgear.trains.pace import PacedStretch, carrier_pace
from ncgear.trains.tip_path import TipMotion, motion_from
from ncgear.trains.train import seen_from_behind
from train_cases import GEARS, UNEVEN, WISHED, NewtonAndEuler, planetary

MASSES = {"density_kg_m3": 7850.0, "tool_kg": 0.4}
ARM = {"arm_mm": 90.0, "arm_deg": 25.0}


def machine_of(folder: Path, **keys: Any) -> Drive:
    """The drive of the file of a train."""
    train = {"kind": "planetary", "speed_rpm": 60, "ratio": UNEVEN, "gears": GEARS, **keys}
    place = folder / "train.yaml"
    place.write_text(json.dumps({"name": "mine", "train": train}), encoding="utf-8")
    return Drive(load(place, for_loads=True).design)


CHAINS: list[dict[str, Any]] = [
    {"idler": "compound", "arms": 2},
    {"idler": "shared", "bend_deg": 40.0},
    {"idler": "shared", "bend_deg": -70.0, "sun_turns": -0.5},
]


@pytest.mark.slow
@at_once("keys", CHAINS)
def test_the_last_gear_turns_as_the_planet_does_against_the_carrier(tmp_path: Path, keys: dict[str, Any]) -> None:
    drive, train = machine_of(tmp_path, **keys), planetary(**keys)
    cycle_rad = train.cycle_rad / train.repeats
    driving = np.linspace(0.0, cycle_rad, 13)
    poses, carrier = train.poses_at(driving), train.number("carrier")
    planet = next(number for number, part in enumerate(train.parts) if part.name.startswith("planet"))
    turned = poses.angle_rad[planet] - poses.angle_rad[carrier]
    u = driving * 2.0 * np.pi / cycle_rad
    assert drive.transmission.driven_angle(u).value == pytest.approx(turned[0] - turned, abs=1e-9)
    sun = np.ptp(poses.angle_rad[0] - poses.angle_rad[carrier]) / cycle_rad
    assert drive.machine.speed_rad_s == pytest.approx(sun * 2.0 * np.pi * train.speed_rpm / 60.0, rel=1e-12)


@pytest.mark.slow
def test_the_gears_of_the_machine_are_those_of_the_train(tmp_path: Path) -> None:
    """Both pairs of a compound idler, their outlines as areas, some seen from behind."""
    drive, train = machine_of(tmp_path), planetary()
    names = ("sun", "idler", "second_idler", "planet")
    made = [gear for pair in drive.by_stage for gear in (pair.teeth.driving, pair.teeth.driven)]
    for name, gear in zip(names, made, strict=True):
        wanted = shapely.Polygon(train.part(name).outline_mm)
        areas = [shapely.Polygon(gear.outline_mm * [1.0, side]) for side in (1.0, -1.0)]
        assert min(wanted.symmetric_difference(area).area for area in areas) < 1e-9


@pytest.mark.slow
@pytest.mark.parametrize(
    ("speed_rpm", "keys"), [(20.0, {}), (300.0, {}), (120.0, {"carrier_ratio": (1.1, 1.0, 0.9, 0.95)})]
)
def test_each_mesh_bears_what_newton_and_euler_say(tmp_path: Path, speed_rpm: float, keys: dict[str, Any]) -> None:
    """Slow, weights alone; fast, inertia too; and with a carrier that turns unevenly.

    What the idler bears beside its inertia counts as the planet's load, so the planet has up to a thirtieth more.
    """
    drive = machine_of(tmp_path, **ARM, arms=2, speed_rpm=speed_rpm, masses=MASSES, **keys)
    train = replace(planetary(**ARM, arms=2, **keys), speed_rpm=speed_rpm)
    first, second = drive.by_stage
    driving = np.linspace(0.0, 6.0, 9)
    carrier = train.poses_at(driving).angle_rad[train.number("carrier")]
    u = carrier - train.poses_at(np.zeros(1)).angle_rad[train.number("carrier")]
    between = first.pair.transmission.driven_angle(u).value
    found = np.array([second.tooth_load.torque_n_mm(between), -first.tooth_load.torque_n_mm(u)]) / 1000.0
    wanted = -np.array([NewtonAndEuler(train, 7850.0, 0.4, float(one)).solved()[2] for one in driving]).T
    most = np.abs(wanted).max(axis=1)
    assert found[0] == pytest.approx(wanted[0], abs=(3e-2 if keys else 1e-2) * most[0])
    assert found[1] == pytest.approx(wanted[1], abs=3e-4 * most[1])


@pytest.mark.slow
def test_the_sun_of_a_shared_idler_bears_what_newton_and_euler_say(tmp_path: Path) -> None:
    """By virtual work in the frame of the carrier, from the moments of idler and planet about their axes."""
    drive = machine_of(tmp_path, **ARM, idler="shared", bend_deg=40.0, masses=MASSES, speed_rpm=300.0)
    train = replace(planetary(**ARM, idler="shared", bend_deg=40.0), speed_rpm=300.0)
    u, wanted = np.linspace(0.0, 6.0, 9), []
    for one in u:
        judge = NewtonAndEuler(train, 7850.0, 0.4, float(one))
        power = 0.0
        for names in (["planet", "arm"], ["idler"]):
            turns = judge.rates(judge.angle[names[0]] - judge.angle["carrier"])[0]
            power += judge.load(names, judge.place[names[0]][2])[0] / 1e6 * turns
        idler = judge.rates(judge.angle["idler"] - judge.angle["carrier"])[0]
        wanted.append(power / idler)
    first = drive.by_stage[0].tooth_load.torque_n_mm(u) / 1000.0
    assert first == pytest.approx(np.array(wanted), abs=3e-4 * np.abs(wanted).max())


@pytest.mark.thorough
def test_a_train_that_is_seen_from_behind_has_the_same_loads() -> None:
    """All of it and gravity reflected in the x axis: the carrier turns clockwise."""
    train, put = planetary(**ARM, arms=2, carrier_ratio=(1.1, 1.0, 0.9, 0.95)), [PutMass("arm_1", 90.0 + 5.0j, 0.4)]
    behind = [replace(one, at_mm=one.at_mm.conjugate()) for one in put]
    for name in ("idler_1", "planet_1"):
        one = turning_load(train, name, 7850.0, put, -2000.0 - 9806.65j)
        other = turning_load(seen_from_behind(train), name, 7850.0, behind, -2000.0 + 9806.65j)
        for value in ("turned_rad", "rate", "torque_n_m", "even_n_m"):
            most = np.abs(getattr(one, value)).max()
            assert getattr(one, value) == pytest.approx(getattr(other, value), abs=1e-9 * most)
        assert one.turned_rad[-1] == pytest.approx(2.0 * np.pi)


def elliptic(eccentricity: float, count: int = 180) -> tuple[float, ...]:
    """Ratios over the driven angle of two ellipses about foci: tan(driven/2) = k tan(driving/2)."""
    k, half = (1.0 + eccentricity) / (1.0 - eccentricity), np.arange(count) * (np.pi / count)
    return tuple((k / (k**2 * np.cos(half) ** 2 + np.sin(half) ** 2)).tolist())


@pytest.mark.thorough
def test_a_carrier_behind_elliptic_gears_has_their_closed_form_and_all_else_follows_it() -> None:
    """tan(carrier/2) = k tan(driving/2); at the same carrier angle all parts stand as with an even carrier."""
    keys = {"ratio": (1.0,) * 4, "arm_mm": 60.0}
    uneven, even = planetary(**keys, carrier_ratio=elliptic(0.2)), planetary(**keys)
    driving = np.linspace(-2.5, 2.5, 11)
    carrier = 2.0 * np.arctan(1.2 / 0.8 * np.tan(driving / 2.0))
    found, wanted = uneven.poses_at(driving), even.poses_at(carrier)
    assert found.angle_rad[uneven.number("carrier")] == pytest.approx(carrier, abs=1e-7)
    for one, other in ((found.x_mm, wanted.x_mm), (found.y_mm, wanted.y_mm), (found.angle_rad, wanted.angle_rad)):
        assert one == pytest.approx(other, abs=1e-5)


@pytest.mark.thorough
def test_torque_and_force_of_an_uneven_carrier_are_those_of_newton_and_euler() -> None:
    """The shaft that drives the carrier has its torque times the carrier's speed over the shaft's."""
    train = replace(planetary(**ARM, arms=2, carrier_ratio=(1.2, 1.0, 0.8, 1.0)), speed_rpm=300.0)
    tools = [PutMass(trace.part, complex(*trace.at_mm), 0.4) for trace in train.traces]
    loads = loads_of(train, 7850.0, tools, -9806.65j)
    most = np.abs(loads.torque_n_m).max(), np.abs(loads.force_n).max()
    for number in (0, 333, 700, 1201):
        judge = NewtonAndEuler(train, 7850.0, 0.4, float(loads.driving_rad[number]))
        torque, force, _ = judge.solved()
        rate = judge.rates(judge.angle["carrier"])[0] / judge.speed
        assert loads.torque_n_m[number] == pytest.approx(torque * rate, abs=1e-4 * most[0])
        assert loads.force_n[number] == pytest.approx(force, abs=1e-4 * most[1])
    carrier = train.poses_at(loads.driving_rad).angle_rad[train.number("carrier")]
    weight = replace(tools[0], part="carrier", at_mm=loads.counterweight_kg_mm, kg=1.0)
    put = loads_of(train, 7850.0, [*tools, weight], -9806.65j).force_n
    assert carrier[0] == 0.0
    assert loads.left_n == pytest.approx(put, abs=1e-6 * most[1])
    off = [np.mean(np.abs(loads.force_n + (1.0 + by) * (put - loads.force_n)) ** 2) for by in (0.0, 0.1, -0.1, 0.1j)]
    assert min(off) == off[0]


@cache
def tip_motion() -> TipMotion:
    found = motion_from(WISHED, 10.572 + 244.37j, (1.0, 1.0), clockwise=True)
    assert isinstance(found, TipMotion)
    return found


@pytest.mark.thorough
@pytest.mark.parametrize("arms", [1, 2])
def test_stretches_take_their_time_and_are_passed_as_slowly_as_asked(arms: int) -> None:
    """By times and differences of places, from the pace summed up; without the wish the tip is faster there."""
    motion, turns = tip_motion(), 2.0 * np.pi
    asked = [PacedStretch(11, 1, speed_mm_s=350.0), PacedStretch(3, 6, share=0.27)]
    w = np.linspace(0.0, turns, 20001)
    u, tip = motion.carrier_rad(w), motion.tip(w)
    at = [int(np.abs(tip - point).argmin()) for point in WISHED.points]
    for wished in (True, False):
        pace = carrier_pace(motion, WISHED, asked, arms, turns) if wished else np.ones(720)
        assert pace.reshape(arms, -1) == pytest.approx(np.tile(pace[: 720 // arms], (arms, 1)))
        # Smooth over the ends of each repetition, too: waves of two arms bend by 0.002 in a step at most.
        assert np.abs(np.diff(np.append(pace, pace[:2]), 2)).max() < 0.01
        course = CubicSpline(np.arange(721) * (turns / 720), np.append(pace, pace[0]), bc_type="periodic")
        seconds = course.antiderivative()(u - u[0]) / turns
        speed = np.abs(np.diff(tip) / np.diff(seconds))
        place = np.arange(speed.size)
        slow = speed[(place - at[11]) % speed.size <= (at[1] - at[11]) % speed.size].max()
        took = (seconds[at[6]] - seconds[at[3]]) % 1.0
        assert bool(slow <= 350.0) is wished
        assert bool(abs(took - 0.27) < 1e-4) is wished


@pytest.mark.thorough
def test_a_pace_that_no_carrier_keeps_is_refused() -> None:
    with pytest.raises(NoSuchMechanism, match="as slow as that take") as refused:
        carrier_pace(tip_motion(), WISHED, [PacedStretch(11, 1, speed_mm_s=20.0)], 1, 2.0 * np.pi)
    assert refused.value.key == "path.pace"


@pytest.mark.slow
@pytest.mark.parametrize("idler", ["compound", "shared"])
def test_round_gears_are_as_strong_as_a_single_pair(tmp_path: Path, idler: str) -> None:
    """Equal gears, so the torque against the planet passes both meshes; the sun meets three idlers.

    Teeth stand elsewhere than in the single pair, and so do the positions computed: stresses are 0.9 % off.
    """
    gears = {**GEARS, "teeth": 24, "backlash_mm": 0.0}
    keys = {"idler": idler, "ratio": [1.0] * 4, "gears": gears, "resistance": {"polynomial_n_m": [6.0]}}
    stages = machine_of(tmp_path, **keys, arms=3).by_stage
    text = f"name: one\noperation: {{speed_rpm: 60}}\nmotion: {{law: uniform_crank}}\ngears: {json.dumps(gears)}\n"
    single = drive_of_text(text + "resistance: {polynomial_n_m: [6]}\n")
    thrice = drive_of_text(text + "resistance: {polynomial_n_m: [6]}\nstrength: {life_h: 60000}\n")
    wanted, of_sun = ({(w.gear, w.damage): w for w in rating_of(one).weakest} for one in (single, thrice))
    for place, stage in enumerate(stages):
        for one in rating_of(stage).weakest:
            if idler == "shared" and one.damage is Damage.BENDING and one.gear is list(Gear)[1 - place]:
                assert 0.6 < one.safety / wanted[one.gear, one.damage].safety < 0.8
                continue
            by = of_sun if not place and one.gear is Gear.DRIVING else wanted
            assert one.safety == pytest.approx(by[one.gear, one.damage].safety, rel=1e-2)
    pitting = [rating_of(one).weakest[1] for one in (single, stages[0])]
    assert all(one.damage is Damage.CONTACT and one.gear is Gear.DRIVING for one in pitting)
    assert 0.0 < pitting[0].life_h < np.inf
    assert pitting[1].life_h == pytest.approx(pitting[0].life_h / 3.0, rel=1e-2)


def test_a_gear_with_several_mates_is_met_by_each() -> None:
    alone = Running(2.0, (24, 48), 10.0, 4.0 * np.pi)
    assert replace(alone, mates=3).meetings(10.0) == pytest.approx(alone.meetings(10.0) * [3.0, 1.0])


@at_once(
    ("keys", "said"),
    [
        ({"masses": MASSES, "resistance": {"polynomial_n_m": [1.0]}}, "resistance"),
        ({"strength": {"mates": 2}}, "follows from arms"),
        (
            {
                "idler": "ring",
                "planet_turns": 2,
                "gears": {**GEARS, "rim_mm": 6.0},
                "resistance": {"polynomial_n_m": [1.0]},
            },
            "not rated",
        ),
        ({"idler": "ring"}, "planet_turns: missing"),
        ({"planet_turns": 2}, "no ring"),
        ({"carrier_ratio": [1.0, 1.1, 1.0, 1.0], "sun_turns": 0.5}, "sun that stands"),
        ({"idler": "shared", "masses": {**MASSES, "tool_kg": 0.0}, "sun_turns": 0.5}, "masses"),
    ],
)
def test_loads_that_do_not_go_together_are_refused(tmp_path: Path, keys: dict[str, Any], said: str) -> None:
    with pytest.raises(WrongInput) as refused:
        machine_of(tmp_path, **keys)
    assert said in str(refused.value)


@pytest.mark.thorough
def test_arms_do_not_change_the_load_of_the_first_one(tmp_path: Path) -> None:
    """The keys of the machine but for the mates of the sun."""
    keys = {"speed_rpm": 60.0, "ratio": UNEVEN, "gears": GEARS, **ARM, "masses": MASSES}
    one, three = (Planetary.model_validate({**keys, "arms": arms}).machine() for arms in (1, 3))
    assert one.pop("strength") == {"mates": 1}
    assert three.pop("strength") == {"mates": 3}
    table = one.pop("resistance")["table"]["torque_n_m"]
    assert three.pop("resistance")["table"]["torque_n_m"] == pytest.approx(table, abs=1e-12)
    assert one == three
