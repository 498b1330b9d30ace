"""The transmission angle of a linkage against triangles drawn by other code, and where friction locks.

Each judge computes the angle from lengths and sampled crank angles; the limit is found by the work of all forces.
"""

from __future__ import annotations

import re
from math import acos, asin, degrees, pi, radians

import numpy as np
import pytest

from at_once import at_once
from drives import DESIGNS, design_of, drive, drive_of_text
from ncgear.errors import NoSuchMechanism
from ncgear.figures.advice.machine_advice import FLATTEST_DEG, FRICTION, transmission_angle
from ncgear.figures.numbers import to_digits
from ncgear.project.drive import Drive

OPEN = {"law": "function_generator", "function": "x", "x_from": 1, "x_to": 2, "driving_range_deg": 200}
EVEN = {"law": "ratio_expression", "ratio": "1 - 0.2*cos(phi)", "scale_to_close": True}


def told(linkage: dict[str, object], motion: dict[str, object] = EVEN) -> str:
    """What is found of a linkage without gears; empty where nothing is."""
    made = design_of({"name": "a", "operation": {"speed_rpm": 30}, "linkage": linkage, "motion": motion})
    found = transmission_angle(Drive(made))
    return found.what if found else ""


@pytest.mark.parametrize(("rod", "offset"), [(61.0, 0.0), (100.0, 39.0), (100.0, -39.0)])
def test_a_steep_rod_is_told_with_its_angle_and_place(rod: float, offset: float) -> None:
    said = told({"crank_mm": 60.0, "rod_mm": rod, "offset_mm": offset})
    across = np.abs(60.0 * np.sin(np.linspace(0.0, 2.0 * pi, 100_001)) - offset)
    assert f"down to {to_digits(90.0 - degrees(asin(across.max() / rod)), 3)} deg" in said


def test_the_place_is_where_the_pin_is_farthest_from_the_slider_s_line() -> None:
    """The crank of an in-line slider is square to its line at phi2 = 90 deg, where phi1 - 0.2 sin(phi1) is."""
    phi1 = np.linspace(0.0, pi, 1_000_001)
    at = degrees(phi1[np.argmin(np.abs(phi1 - 0.2 * np.sin(phi1) - 0.5 * pi))])
    said = told({"crank_mm": 60.0, "rod_mm": 61.0}, {**EVEN, "ratio": "1/(1 - 0.2*cos(phi))"})
    assert any(f"phi1 = {to_digits(one, 4)} deg" in said for one in (at, 360.0 - at))


@pytest.mark.parametrize(("rocker", "least"), [(65.5, 10.8), (80.0, None)])
def test_a_rocker_s_angle_is_that_of_the_triangle_of_coupler_rocker_and_pin(rocker: float, least: float | None) -> None:
    lengths = {"crank_mm": 15.0, "coupler_mm": 50.0, "rocker_mm": rocker, "ground_mm": 100.0}
    reach = np.abs(15.0 * np.exp(1j * np.linspace(0.0, 2.0 * pi, 100_001)) - 100.0)
    cosine = np.abs(50.0**2 + rocker**2 - reach**2) / (100.0 * rocker)
    own = degrees(np.arccos(cosine.max()))
    assert (own < FLATTEST_DEG) == (least is not None)
    said = told({"kind": "crank_rocker", **lengths})
    assert said.partition(" (at")[0] == (f"transmission angle down to {to_digits(own, 3)} deg" if least else "")


@pytest.mark.parametrize(("pivot", "locks"), [(30.5, True), (32.0, False)])
def test_a_lever_leans_most_at_its_dead_centres(pivot: float, locks: bool) -> None:
    said = told({"kind": "slotted_lever", "crank_mm": 30.0, "pivot_mm": pivot, "lever_mm": 80.0})
    assert (to_digits(90.0 - degrees(asin(30.0 / pivot)), 3) in said) == locks
    assert bool(said) == locks


@pytest.mark.parametrize(("rod", "locks"), [(61.75, True), (61.95, False)])
def test_it_is_told_where_the_guide_s_friction_eats_the_push(rod: float, locks: bool) -> None:
    """Along its line a slider of the steepest rod is pushed by cos(b) less the friction of the guide, sin(b) each N."""
    steepest = asin(60.0 / rod)
    assert (np.cos(steepest) < FRICTION * np.sin(steepest)) == locks
    assert bool(told({"crank_mm": 60.0, "rod_mm": rod})) == locks


@pytest.mark.parametrize(("range_deg", "locks"), [(60.0, False), (85.0, True), (120.0, True)])
def test_gears_that_turn_less_than_once_are_judged_where_they_turn(range_deg: float, locks: bool) -> None:
    said = told({"crank_mm": 60.0, "rod_mm": 61.0}, {**OPEN, "driven_range_deg": range_deg})
    steepest = asin(60.0 * np.sin(radians(min(range_deg, 90.0))) / 61.0)
    assert said == "" if not locks else f"down to {to_digits(90.0 - degrees(steepest), 3)} deg" in said


@at_once("name", ["baler", "rocker-drive", "quick-return-shaper", "scotch-yoke-pump", "rack-feed"])
def test_shipped_linkages_do_not_lock(name: str) -> None:
    assert transmission_angle(drive(name)) is None


# --- friction in the guide that the file gives, against the balance of the slider's forces


def held(crank: float, rod: float, offset: float, friction: float, against: tuple[float, float]) -> list[str]:
    """The strokes on which no forces are in balance somewhere: the rod's, the guide's and its friction.

    ``against`` are the forces against the motion out and back, negative ones along it.  The guide presses on either
    side; a force of it that points the other way is no balance.
    """
    found = []
    theta = np.linspace(0.0, 2.0 * pi, 5_001)
    across = crank * np.sin(theta) - offset
    # The crank turns clockwise: theta falls
    speed = crank * np.sin(theta) + across / np.sqrt(rod**2 - across**2) * crank * np.cos(theta)
    tilt = np.arcsin(across / rod)
    for name, way, force in (("out", 1.0, against[0]), ("back", -1.0, against[1])):
        there = tilt[way * speed > 1e-9 * crank]
        balanced = np.full(there.size, force == 0.0)
        for side in (1.0, -1.0):
            # Along the line: cos(b) S - way mu side N = way F; across it: -sin(b) S + N = 0
            rows = [[np.cos(there), np.full(there.size, -way * friction * side)], [-np.sin(there), np.ones(there.size)]]
            matrix = np.moveaxis(np.array(rows), 2, 0)
            load = np.tile([way * force, 0.0], (there.size, 1))[..., None]
            balanced |= side * np.linalg.solve(matrix, load)[:, 1, 0] >= 0.0
        found += [] if balanced.all() else [name]
    return found


def rubbing(friction: float, out: float = 10.0, back: float = 10.0, **lengths: float) -> Drive:
    """A machine whose guide rubs, with a constant force on each stroke."""
    machine = {
        "name": "a",
        "operation": {"speed_rpm": 1},
        "linkage": {"crank_mm": 60.0, "rod_mm": 100.0, "offset_mm": 39.0, **lengths},
        "motion": {"law": "uniform_crank"},
        "resistance": {
            "polynomial_n": [out],
            "where_negative": "keep",
            "returning": {"polynomial_n": [back], "where_negative": "keep"},
        },
        "drivetrain": {"guide_friction": friction},
        "gears": {"teeth": 40, "module_mm": 2, "face_width_mm": 10},
        "masses": {
            "slider_kg": 0,
            "rod": {"mass_kg": 0, "center_mm": 0, "inertia_kg_mm2": 0},
            "crank": {"mass_kg": 0, "center_mm": 0, "inertia_kg_mm2": 0},
            "driving_gear_kg_mm2": 0,
            "driven_gear_kg_mm2": 0,
        },
    }
    return Drive(design_of(machine))


def refusal(made: Drive) -> str:
    try:
        _ = made.check
    except NoSuchMechanism as refused:
        return refused.problem
    return ""


LIMIT = np.sqrt(100.0**2 - 99.0**2) / 99.0
"""The pin is 60 + 39 mm from the slider's line where the rod of 100 mm leans most."""


@pytest.mark.tiers(quick=["*-10.0-0.0-39.0", "*-0.0-10.0--39.0"], rest="slow")
@pytest.mark.parametrize("offset", [39.0, -39.0])
@pytest.mark.parametrize(("out", "back"), [(10.0, 0.0), (0.0, 10.0), (10.0, 5000.0), (-10.0, 10.0), (10.0, -10.0)])
@pytest.mark.parametrize("friction", [0.999 * LIMIT, 1.001 * LIMIT])
def test_a_guide_that_jams_while_it_runs_is_refused_for_the_force_and_the_stroke(
    friction: float, out: float, back: float, offset: float
) -> None:
    jams = held(60.0, 100.0, offset, friction, (out, back))
    said = refusal(rubbing(friction, out, back, offset_mm=offset))
    assert bool(said) == bool(jams)
    assert not said or f"on its way {jams[0]}" in said
    told_limit = re.search(r"under ([\d.]+), is right", said)
    assert not said or (told_limit and LIMIT - 1e-4 <= float(told_limit[1]) <= LIMIT)


@at_once(("out", "back"), [(0.0, 0.0), (-10.0, 0.0), (0.0, -10.0)])
@at_once("offset", [39.0, -39.0])
@at_once(("friction", "starts"), [(0.999 * LIMIT, True), (1.001 * LIMIT, False)])
def test_a_guide_that_jams_only_at_the_start_is_told(
    friction: float, starts: bool, offset: float, out: float, back: float
) -> None:
    """Whatever moves the running slider along, at rest any force against it, on one stroke or the other, holds it."""
    assert (not held(60.0, 100.0, offset, friction, (1.0, 1.0))) == starts
    found = transmission_angle(rubbing(friction, out, back, offset_mm=offset))
    assert (found is None) == starts
    assert found is None or "started there" in found.what


@pytest.mark.parametrize("name", ["rod_mm", "crank_mm", "offset_mm"])
def test_a_length_that_is_told_lets_the_guide_go(name: str) -> None:
    found = transmission_angle(rubbing(0.2, 0.0, 0.0))
    assert found is not None
    told = dict(re.findall(r"linkage\.(\w+): ([\d.]+)", " ".join(one.text for one in found.remedies)))
    assert transmission_angle(rubbing(0.2, 0.0, 0.0, **{name: float(told[name])})) is None
    # It is near: between it and its own the warning comes back
    own = {"rod_mm": 100.0, "crank_mm": 60.0, "offset_mm": 39.0}[name]
    nearer = float(told[name]) + 0.1 * (own - float(told[name]))
    assert transmission_angle(rubbing(0.2, 0.0, 0.0, **{name: nearer})) is not None


def test_a_smooth_guide_that_is_given_is_believed() -> None:
    """At 8 deg a friction of 0.25 locks, of which nothing is said where the file gives 0.1."""
    assert transmission_angle(rubbing(0.0)) is not None
    assert transmission_angle(rubbing(0.1)) is None


@pytest.mark.parametrize(("rod_mm", "speed"), [(60.01, 110), (62.0, 110), (60.01, 118)])
def test_a_law_that_is_refused_beside_a_linkage_that_nearly_locks_names_the_linkage(rod_mm: float, speed: int) -> None:
    """The angle by its own formula, cos b = crank / rod at right angles; a speed that no rod suits names none."""
    text = (DESIGNS / "pusher.yaml").read_text(encoding="utf-8")
    text = text.replace("rod_mm: 220", f"rod_mm: {rod_mm}").replace("v2_mm_s: 110", f"v2_mm_s: {speed}")
    with pytest.raises(NoSuchMechanism) as refused:
        _ = drive_of_text(text).law
    said = (
        f"nearly locks at the crank angle of 90 deg, where its transmission angle is {degrees(acos(60 / rod_mm)):.3g}"
    )
    assert (said in refused.value.problem) == (speed == 110)
    if speed == 110:
        _ = drive_of_text(text.replace(f"rod_mm: {rod_mm}", "rod_mm: 75")).law
