"""What a file gives that changes nothing is told, whatever it stands beside; what changes something is not."""

from __future__ import annotations

from math import atan, cos, pi, sin, sqrt
from typing import Any

import numpy as np
import pytest
from pydantic import ValidationError

from at_once import at_once
from drives import design_of
from ncgear.figures.advice.drivetrain_advice import around
from ncgear.figures.advice.given_advice import without_effect
from ncgear.figures.advice.values import ONLY_TEETH, Advice, Change, Kind
from ncgear.figures.advice.verdict import JudgedCondition, KnownParts, State
from ncgear.pitch.shape import Gear
from ncgear.project.alternatives import changed_drive
from ncgear.project.drive import Drive
from verdicts import verdict_on

Data = dict[str, Any]

PUMP: Data = {
    "name": "pump",
    "linkage": {"crank_mm": 60, "rod_mm": 220},
    "operation": {"speed_rpm": 30},
    "motion": {"law": "harmonic_ratio", "cosine": [-0.2]},
    "gears": {"teeth": 48, "module_mm": 1.5, "face_width_mm": 12},
    "resistance": {"polynomial_n": [50]},
    "masses": {
        "slider_kg": 2,
        "driving_gear_kg_mm2": 500,
        "driven_gear_kg_mm2": 500,
        "rod": {"mass_kg": 1, "center_mm": 50, "inertia_kg_mm2": 1000},
        "crank": {"mass_kg": 1, "center_mm": 0, "inertia_kg_mm2": 100},
    },
}
UNLOADED: Data = {"masses": None, "resistance": None}
YOKE: Data = {
    "linkage": {"kind": "scotch_yoke", "crank_mm": 60},
    "masses": {key: PUMP["masses"][key] for key in ("slider_kg", "crank", "driving_gear_kg_mm2", "driven_gear_kg_mm2")},
}
ROCKER: Data = {
    "linkage": {"kind": "crank_rocker", "crank_mm": 15, "coupler_mm": 60, "rocker_mm": 40, "ground_mm": 72},
    "resistance": {"polynomial_n_m": [5]},
    "masses": {
        "rocker": {"mass_kg": 1, "center_mm": 10, "inertia_kg_mm2": 1000},
        "coupler": {"mass_kg": 1, "center_mm": 10, "inertia_kg_mm2": 1000},
        **{key: PUMP["masses"][key] for key in ("crank", "driving_gear_kg_mm2", "driven_gear_kg_mm2")},
    },
}
HELIX = {**PUMP["gears"], "helix": {"angle_deg": 15, "kind": "herringbone", "hand": "right"}}
TWO_STAGES = {**PUMP["motion"], "second_stage": {"cosine": [-0.1]}}
BEARINGS = {"bearing_a": {"at_mm": -20}, "bearing_b": {"at_mm": 25}}
RATED = {"bearing_a": {"at_mm": -20}, "bearing_b": {"at_mm": 25, "static_rating_n": 2000}}
HELICAL = {**PUMP["gears"], "helix": {**HELIX["helix"], "kind": "helical"}}
MOTOR = {"rated_torque_n_m": 5, "rated_speed_rpm": 28, "overrunning_clutch": True}
STEADY = {"static": 0.1, "dynamic": 0.1, "static_speed_mm_s": 2}


def told(changed: Data) -> list[str]:
    data = {key: value for key, value in {**PUMP, **changed}.items() if value is not None}
    return [advice.what for advice in without_effect(Drive(design_of(data)))]


IDLE: dict[str, tuple[str, Data, Data]] = {
    "no masses": ("simulation is given without masses", {"simulation": {"turns": 3}, "masses": None}, {"masses": None}),
    "no load": ("simulation is given without resistance", {"simulation": {"turns": 3}, **UNLOADED}, UNLOADED),
    "no gears": ("strength is given without gears", {"strength": {"life_h": 9}, "gears": None}, {"gears": None}),
    "stages": (
        "simulation is given without masses",
        {"simulation": {"turns": 3}, "motion": TWO_STAGES, "masses": None},
        {"simulation": {"turns": 3}, "motion": TWO_STAGES},
    ),
    "damping": (
        "simulation.damping_ratio is",
        {"simulation": {"damping_n_s_mm": 1, "damping_ratio": 0.1}},
        {"simulation": {"damping_ratio": 0.1}},
    ),
    "steady friction": (
        "simulation.friction.static_speed_mm_s is",
        {"simulation": {"friction": STEADY}},
        {"simulation": {"friction": {**STEADY, "static": 0.2}}},
    ),
    "pauses of metal": (
        "strength.duty_cycle is given with gears of metal",
        {"strength": {"duty_cycle": 0.3, "lubrication": "grease"}},
        {
            "strength": {"duty_cycle": 0.3, "lubrication": "grease"},
            "gears": {**PUMP["gears"], "material": {"driving": "C45", "driven": "POM"}},
        },
    ),
    "pauses in oil": (
        "strength.duty_cycle is given with teeth in oil",
        {"strength": {"duty_cycle": 0.3}, "gears": {**PUMP["gears"], "material": "POM"}},
        {
            "strength": {"duty_cycle": 0.3, "lubrication": "dry"},
            "gears": {**PUMP["gears"], "material": "POM"},
        },
    ),
    "nowhere negative": (
        "resistance.where_negative is given with a load that is nowhere negative",
        {"resistance": {"polynomial_n": [50], "where_negative": "keep"}},
        {"resistance": {"polynomial_n": [50, -1], "where_negative": "keep"}},
    ),
    "nowhere negative on the way back": (
        "resistance.returning.where_negative is",
        {"resistance": {"polynomial_n": [50], "returning": {"polynomial_n": [7], "where_negative": "zero"}}},
        {"resistance": {"polynomial_n": [50], "returning": {"polynomial_n": [7, -1], "where_negative": "zero"}}},
    ),
    "no temperature": (
        "tolerances.housing_expansion_um_m_k is",
        {"tolerances": {"grade": 8, "housing_expansion_um_m_k": 23.8}},
        {
            "tolerances": {
                "grade": 8,
                "housing_expansion_um_m_k": 23.8,
                "temperature": {"least_c": 5, "largest_c": 45},
            }
        },
    ),
    "life": (
        "drivetrain.life_h is",
        {"drivetrain": {"life_h": 9}},
        {"drivetrain": {"life_h": 9, "driving_shaft": BEARINGS}},
    ),
    "rocker": (
        "drivetrain.guide_friction is",
        {**ROCKER, "drivetrain": {"guide_friction": 0.1}},
        {"drivetrain": {"guide_friction": 0.1}},
    ),
    "yoke": (
        "drivetrain.guide_friction is",
        {**YOKE, "drivetrain": {"guide_friction": 0.1}},
        {
            **YOKE,
            "masses": {**YOKE["masses"], "gravity": {}},
            "drivetrain": {"guide_friction": 0.1},
        },
    ),
    "clutch": (
        "drivetrain.motor.overrunning_clutch is",
        {"drivetrain": {"motor": MOTOR}},
        {"drivetrain": {"motor": {**MOTOR, "no_load_speed_rpm": 30}}},
    ),
    "steel": (
        "drivetrain.driving_shaft.diameter_mm is",
        {"drivetrain": {"driving_shaft": {**BEARINGS, "diameter_mm": 9}}},
        {"drivetrain": {"driving_shaft": {**BEARINGS, "diameter_mm": 9, "steel": "S355"}}},
    ),
    "thrust": (
        "drivetrain.driven_shaft.thrust_on is",
        {"drivetrain": {"driven_shaft": {**RATED, "thrust_on": "b"}}},
        {"gears": HELICAL, "drivetrain": {"driven_shaft": {**RATED, "thrust_on": "b"}}},
    ),
    "crank": (
        "drivetrain.driven_shaft.crank_at_mm is",
        {"drivetrain": {"driven_shaft": {"crank_at_mm": 20}}},
        {"drivetrain": {"driven_shaft": {**BEARINGS, "crank_at_mm": 20}}},
    ),
    "own grade": (
        "tolerances.driven.grade is given beside",
        {"tolerances": {"grade": 8, "driven": {"grade": 9, "single_pitch_mm": 0.02, "profile_mm": 0.03}}},
        {"tolerances": {"grade": 8, "driven": {"grade": 9, "single_pitch_mm": 0.02}}},
    ),
    "grade of both": (
        "tolerances.grade is given and each",
        {"tolerances": {"grade": 7, "driving": {"grade": 6}, "driven": {"single_pitch_mm": 0.02, "profile_mm": 0.03}}},
        {"tolerances": {"grade": 7, "driving": {"grade": 6}}},
    ),
}
"""What is told, where, and where it is not."""


@pytest.mark.parametrize("name", IDLE)
def test_a_key_that_no_figure_counts_is_told(name: str) -> None:
    start, idle, acting = IDLE[name]
    (found,) = told(idle)
    assert found.startswith(start)
    assert told(acting) == []


# --- what only teeth and bodies can tell


def geared(**gears: Any) -> Drive:
    motion = {"operation": {"speed_rpm": 40}, "motion": {"law": "harmonic_ratio", "cosine": [-0.1]}}
    sizes = {"teeth": 22, "module_mm": 2.5, "face_width_mm": 8, "backlash_mm": 0.1}
    return Drive(design_of({"name": "marked", **motion, "gears": {**sizes, **gears}}))


def rows_of(one: Drive, kind: Kind, known: KnownParts = KnownParts.TEETH) -> JudgedCondition:
    (found,) = verdict_on(kind, one, known).rows
    return found


@pytest.mark.slow
@pytest.mark.parametrize(
    "bodies",
    [
        {"driven": {"bore_mm": 37}},
        {"driving": {"bore_mm": 12, "hub": {"diameter_mm": 40, "height_mm": 4}}},
        {"mesh": "internal", "lobes": {"driving": 1, "driven": 2}, "driven": {"rim_mm": 1.5}},
    ],
)
def test_an_index_hole_without_room_is_told_with_a_size_that_leaves_it_room(bodies: Data) -> None:
    one = geared(index_holes=True, **bodies)
    assert rows_of(one, Kind.INDEX_HOLES, KnownParts.MOTION).state is State.NOT_JUDGED
    (advice,) = rows_of(one, Kind.INDEX_HOLES).advices
    lacking = [gear for gear, plan in zip(Gear, one.finished_plans, strict=True) if plan.index_hole is None]
    names = " and ".join(gear.value for gear in lacking)
    assert f"index hole of the {names} gear" in advice.what
    room, without = advice.remedies
    assert without.changes == (Change("gears.index_holes", value=False),)
    (change,) = room.changes
    assert change.key.split(".")[1] == lacking[0].value
    helped = changed_drive(one, {change.key: change.value})
    assert rows_of(helped, Kind.INDEX_HOLES).state is State.KEPT


def test_holes_that_have_room_or_are_not_asked_for_are_not_told() -> None:
    assert rows_of(geared(index_holes=True), Kind.INDEX_HOLES).state is State.KEPT
    assert verdict_on(Kind.INDEX_HOLES, geared(driven={"bore_mm": 31}), KnownParts.MOTION).rows == ()


@pytest.mark.parametrize(("teeth", "idle"), [(26, True), (14, False)])
def test_allowed_undercut_is_told_where_no_tooth_is_undercut(teeth: int, idle: bool) -> None:
    allowed = geared(teeth=teeth, undercut="allow")
    assert bool(allowed.teeth.driving.undercut) is not idle
    assert rows_of(allowed, Kind.WITHOUT_EFFECT, KnownParts.MOTION).state is State.NOT_JUDGED
    told = [advice.what for advice in rows_of(allowed, Kind.WITHOUT_EFFECT).advices]
    assert told == ["gears.undercut is given without a tooth that would be undercut"] * idle
    avoided = geared(teeth=teeth, undercut="avoid")
    assert np.array_equal(allowed.teeth.driving.outline_mm, avoided.teeth.driving.outline_mm) is idle
    assert rows_of(avoided, Kind.WITHOUT_EFFECT, KnownParts.MOTION).state is State.KEPT


# --- where bearings and the crank stand


def refused(changed: Data) -> str:
    try:
        design_of({**PUMP, **changed})
    except ValidationError as error:
        return str(error)
    return ""


@at_once(
    ("bearing", "thrust_on", "missing"),
    [
        ({"kind": "roller"}, "a", "bearing_a.contact_angle_deg"),
        ({"kind": "roller", "contact_angle_deg": 12}, "a", ""),
        ({"kind": "ball"}, "a", "bearing_a.static_rating_n"),
        ({"kind": "ball", "static_rating_n": 2e4}, "a", ""),
        ({"kind": "ball", "contact_angle_deg": 30}, "a", ""),
        ({"kind": "roller"}, "b", "bearing_b.static_rating_n"),
    ],
)
def test_a_bearing_of_helical_teeth_bears_their_thrust(bearing: Data, thrust_on: str, missing: str) -> None:
    """As the file is read; herringbone teeth have no thrust."""
    shaft = {"bearing_a": {"at_mm": -30, **bearing}, "bearing_b": {"at_mm": 40}, "thrust_on": thrust_on}
    for kind in ("helical", "herringbone"):
        gears = {**HELIX, "helix": {**HELIX["helix"], "kind": kind}}
        said = refused({"gears": gears, "drivetrain": {"driven_shaft": shaft}})
        assert bool(said) == bool(missing and kind == "helical")
        words = "cylindrical rollers bear no thrust of" if missing.endswith("deg") else "ball bearing"
        assert not said or words in said


def test_rows_of_balls_have_a_contact_angle_of_20_degrees_or_more() -> None:
    shaft = {"bearing_a": {"at_mm": -30, "contact_angle_deg": 15}, "bearing_b": {"at_mm": 40}}
    assert "20 deg or over" in refused({"drivetrain": {"driven_shaft": shaft}})


@at_once(("at_mm", "within"), [(5.9, "gear,"), (10.0, "gear's hub"), (14.0, ""), (-6.0, ""), (-5.9, "gear,")])
def test_a_bearing_stands_beside_gear_and_hub(at_mm: float, within: str) -> None:
    gears = {**PUMP["gears"], "driving": {"bore_mm": 10, "hub": {"diameter_mm": 20, "height_mm": 8}}}
    shaft = {"bearing_a": {"at_mm": at_mm}, "bearing_b": {"at_mm": 40}}
    said = refused({"gears": gears, "drivetrain": {"driving_shaft": shaft}})
    assert bool(said) == bool(within)
    assert f"is within the {within}" in said or not within


@pytest.mark.slow
@pytest.mark.parametrize(("at_mm", "inside"), [(None, True), (5.0, True), (6.0, False), (-20.0, False)])
def test_a_crank_within_its_gear_is_told(at_mm: float | None, inside: bool) -> None:
    shaft = {**BEARINGS, **({} if at_mm is None else {"crank_at_mm": at_mm})}
    made = Drive(design_of({**PUMP, "gears": HELIX, "drivetrain": {"driven_shaft": shaft}}))
    found = [one for one in around(made) if isinstance(one, Advice) and "would turn within the gear" in one.what]
    assert len(found) == inside
    assert not found or found[0].remedies[0].brief == "drivetrain.driven_shaft.crank_at_mm: 6 or over"


@pytest.mark.slow
@pytest.mark.parametrize(
    ("at_mm", "matters"), [(25.0, [True]), (10.0, [False]), (-20.0, [True]), (25.1, []), (-20.1, []), (5.0, [])]
)
def test_a_crank_between_its_bearings_or_in_one_is_told(at_mm: float, matters: list[bool]) -> None:
    shaft = {**BEARINGS, "crank_at_mm": at_mm}
    made = Drive(design_of({**PUMP, "gears": HELIX, "drivetrain": {"driven_shaft": shaft}}))
    assert [
        one.matters for one in around(made) if isinstance(one, Advice) and "passes over the shaft's axis" in one.what
    ] == matters


@pytest.mark.slow
@pytest.mark.parametrize(("inertia", "idle"), [(1e9, True), (0.0, False)])
def test_the_diameter_of_a_disc_that_nothing_needs_is_told(inertia: float, idle: bool) -> None:
    wheel = {"inertia_kg_mm2": inertia, "speed_fluctuation": 0.05}
    masses = {**PUMP["masses"], "flywheel": wheel}
    made = Drive(design_of({**PUMP, "gears": HELIX, "masses": masses, "drivetrain": {"flywheel_diameter_mm": 300}}))
    assert [one.matters for one in around(made) if isinstance(one, Advice) and "no disc is needed" in one.what] == [
        False
    ] * idle


# --- wishes that every law keeps


@pytest.mark.parametrize(("bore_mm", "shaft_mm"), [(14.0, 13.5), (14.0, 14.0), (None, 12.0)])
@pytest.mark.parametrize("name", ["driving", "driven"])
def test_a_shaft_that_is_loose_in_its_bore_is_told_with_both_sizes(
    name: str, bore_mm: float | None, shaft_mm: float
) -> None:
    shaft = {**BEARINGS, "diameter_mm": shaft_mm, "steel": "C45"}
    gears = {**PUMP["gears"], name: {"bore_mm": bore_mm}}
    one = Drive(design_of({**PUMP, "gears": gears, "drivetrain": {f"{name}_shaft": shaft}}))
    row = rows_of(one, Kind.DRIVETRAIN, KnownParts.MOTION)
    assert row.why == ONLY_TEETH
    if bore_mm is None or shaft_mm == bore_mm:
        assert row.advices == ()
        return
    (advice,) = row.advices
    assert advice.what == f"the {name} shaft of {shaft_mm:g} mm is loose in a bore of {bore_mm:g} mm"
    assert advice.remedies[0].text == (
        f"drivetrain.{name}_shaft.diameter_mm: {bore_mm:g}, or gears.{name}.bore_mm: {shaft_mm:g}"
    )


def asks(wish: Data) -> bool:
    """Whether a wish asks anything, as far as is told."""
    return not any("every law keeps it" in one for one in told({"wishes": wish}))


def greatest_deceleration() -> float:
    """Of a crank of 60 mm and a rod of 220 mm at 30 r/min, in mm/s2, by pitch curves that no gears have.

    A pitch curve of the radius r(phi1), steeper than 87 deg, against a mate at the distance a of which it takes 20/21:
    the crank's angle is the integral of r/(a - r).  The second derivative is that of seven points of it.
    """
    steps, tangent, speed = np.arange(-3, 4) * 1e-5, 20.0, pi
    weights = np.array([2.0, -27.0, 270.0, -490.0, 270.0, -27.0, 2.0]) / 180.0 / 1e-10
    assert atan(tangent) > 87.0 * pi / 180.0
    radius = 20.0 / 21.0 * np.exp(tangent * np.linspace(-3e-5, 3e-5, 6001))
    ratio = radius / (1.0 - radius)
    turned = np.concatenate([[0.0], np.cumsum((ratio[1:] + ratio[:-1]) / 2.0) * 1e-8])
    turned = np.interp(steps, np.linspace(-3e-5, 3e-5, 6001), turned - turned[3000])

    def acceleration(angle: float) -> float:
        crank = angle + turned
        places = [60.0 * -cos(one) + sqrt(220.0**2 - (60.0 * sin(one)) ** 2) for one in crank]
        return abs(speed**2 * float(np.dot(weights, places)))

    return max(acceleration(angle) for angle in np.linspace(0.0, pi, 361))


def test_a_deceleration_that_no_gears_reach_is_told() -> None:
    most = greatest_deceleration()
    bound = {"from_mm": 0, "to_mm": 120}
    assert not asks({"gentle_stop": [{**bound, "deceleration_at_most_mm_s2": 1.1 * most}]})
    assert asks({"gentle_stop": [{**bound, "deceleration_at_most_mm_s2": 0.95 * most}]})


@pytest.mark.tiers(quick=["*-True"], rest="slow")
@pytest.mark.parametrize("hard", [True, False])
@pytest.mark.parametrize(
    ("kind", "idle", "asking"),
    [
        ("gentle_stop", {"deceleration_at_most_mm_s2": 1e9, "stroke": "both"}, {"deceleration_at_most_mm_s2": 500}),
        (
            "gentle_stop",
            {"from_phi1_deg": 10, "to_phi1_deg": 90, "deceleration_at_most_mm_s2": 1e9},
            {"from_phi1_deg": 10, "to_phi1_deg": 90, "deceleration_at_most_mm_s2": 500},
        ),
        ("gentle_stop", {"from_mm": 9, "speed_at_most_mm_s": 1e5}, {"from_mm": 9, "speed_at_most_mm_s": 200}),
        ("speed_at", {"at_mm": 50, "at_most_mm_s": 1e5}, {"at_mm": 50, "at_most_mm_s": 200}),
        ("speed_at", {"at_mm": 50, "at_least_mm_s": 0.1}, {"at_mm": 50, "at_least_mm_s": 100}),
        ("speed_at", {"at_mm": 50, "at_least_mm_s": 0.1}, {"at_mm": 50, "make": "slowest", "hard": False}),
        (
            "dwell",
            {"at": "extended", "within_mm": 119, "for_deg": 1},
            {"at": "extended", "within_mm": 9, "for_deg": 90},
        ),
        (
            "constant_speed",
            {"from_mm": 50, "to_mm": 50.001, "tolerance": 0.5},
            {"from_mm": 30, "to_mm": 60, "tolerance": 0.5},
        ),
        (
            "positions",
            {"at_mm": 50, "phi1_deg": 90, "tolerance_mm": 500},
            {"at_mm": 50, "phi1_deg": 90, "tolerance_mm": 9},
        ),
        ("time_ratio", {"at_least": 0.01}, {"at_least": 0.5}),
        ("working_stroke", {"angle_deg": 180, "tolerance_deg": 179}, {"angle_deg": 180, "tolerance_deg": 9}),
    ],
)
def test_a_wish_that_asks_nothing_is_told_hard_or_soft(kind: str, idle: Data, asking: Data, hard: bool) -> None:
    alone = kind in ("time_ratio", "working_stroke")
    for wish, acts in ((idle, False), (asking, True)):
        made = {"hard": hard, **wish}
        assert asks({kind: made if alone else [made]}) == acts
