"""Shafts of pairs in series: forces of two meshes on a shaft, its bearings, keys, fatigue, and K_Hbeta of each mesh.

The judge knows the masses, the law of each shaft's angle and the places of the axes.  Newton's balance of every shaft
is taken with the forces that its bearings get, at the pitch points and bearings in space.
"""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from math import pi, radians

import numpy as np
import pytest

from at_once import at_once
from commands import Run, on_text
from drives import drive, drive_of_text
from ncgear.drivetrain.bearings import (
    Bearing,
    Seats,
    WantedLife,
    bearing_forces,
    bending_moment_n_mm,
    bending_places_mm,
    most_bent,
)
from ncgear.drivetrain.cycle import GearLoads, ShaftLoads, cycle_of, loads_at
from ncgear.drivetrain.peaks import shaft_peaks
from ncgear.errors import WrongInput
from ncgear.figures.advice.drivetrain_advice import around
from ncgear.figures.advice.verdict import KnownParts, judged
from ncgear.figures.strong import deciding_forces
from ncgear.numerics.arrays import Array
from ncgear.project.drive import Drive
from ncgear.project.face_load import seats_of
from ncgear.project.strengthening import rating_of

BORED = "{bore_mm: 30, keyway: {width_mm: 8, depth_mm: 3.3}}"
BEARING = "dynamic_rating_n: 20000, static_rating_n: 12000"
BETWEEN = (
    f"  - {{second_gear_at_mm: 60, bearing_a: {{at_mm: -35, {BEARING}}}, bearing_b: {{at_mm: 95, {BEARING}}},\n"
    "     steel: C45, key: {}}\n"
)
TEXT = f"""\
name: two
linkage: {{crank_mm: 100, rod_mm: 300}}
operation: {{speed_rpm: 120}}
motion: {{law: ratio_expression, ratio: "1 + 0.4*cos(phi) + 0.1*sin(2*phi)", scale_to_close: true}}
gears:
  {{teeth: 40, module_mm: 3, face_width_mm: 20, backlash_mm: 0.1, pairs: 2, driving_axis_deg: 130,
   driving: {BORED}, driven: {BORED}}}
masses:
  {{crank: {{mass_kg: 1, center_mm: 20, inertia_kg_mm2: 2000}}, rod: {{mass_kg: 1.5, center_mm: 120,
   inertia_kg_mm2: 15000}}, slider_kg: 4, driving_gear_kg_mm2: 9000, shaft_between_kg_mm2: 30000,
   driven_gear_kg_mm2: 12000, flywheel: {{inertia_kg_mm2: 1.0e+6, speed_fluctuation: 0.1}}}}
resistance: {{polynomial_n: [100, 4]}}
drivetrain:
  driving_shaft: {{bearing_a: {{at_mm: -40, {BEARING}}}, bearing_b: {{at_mm: 40, {BEARING}}}, steel: C45, key: {{}}}}
  shafts_between:
{BETWEEN}  driven_shaft: {{crank_at_mm: 80, bearing_a: {{at_mm: -40, {BEARING}}}, bearing_b: {{at_mm: 45, {BEARING}}},
    steel: C45, key: {{}}}}
"""


@cache
def two() -> Drive:
    return drive_of_text(TEXT)


def seats(number: int) -> Seats:
    found = seats_of(two().design.shafts[number].given)
    assert found is not None
    return found


def pitch_points(phi1: Array) -> tuple[list[Array], list[float]]:
    """Both pitch points from the axes of their driving and driven gears, as x + i y, and the axes' distances."""
    first, second = (pair.pair.transmission for pair in two().by_stage)
    between = first.driven_angle(phi1, 1)
    slopes = between.derivative(1), second.driven_angle(between.value, 1).derivative(1)
    back, found = np.exp(1j * radians(130.0)), list[Array]()
    distances = [pair.pitch.center_distance_mm for pair in two().by_stage]
    for slope, distance in zip(slopes, distances, strict=True):
        # Each mate's axis is at the end of the line of centres away from `back`; radii are a i / (1 + i) and the rest.
        found += [-back * distance * slope / (1.0 + slope), back * distance / (1.0 + slope)]
    return found, distances


def cross(place: Array, force: Array) -> Array:
    return np.asarray((np.conj(place) * force).imag)


@pytest.mark.slow
@pytest.mark.judges("drivetrain")
def test_every_shaft_is_in_balance_at_every_angle() -> None:
    """Forces and tilting couples to 1e-9; turning couples by torques of both ends and the inertia between."""
    phi1 = np.linspace(0.0, 2.0 * pi, 721)
    shafts = loads_at(two().rigid.machine, phi1).shafts
    first, second, driven = shafts
    assert [len(one.gears) for one in shafts] == [1, 2, 1]
    # A gear's force is returned by its mate on the next shaft.
    for gear, mate in ((first.gears[0], second.gears[0]), (second.gears[1], driven.gears[0])):
        assert np.abs(gear.force_n + mate.force_n).max() < 1e-9 * np.abs(mate.force_n).max()
    largest = max(float(np.abs(one.force_n).max()) for shaft in shafts for one in shaft.gears)
    for number, shaft in enumerate(shafts):
        at, own = seats(number), [one.force_n for one in shaft.gears]
        borne = bearing_forces(shaft, at)
        places = [*at.gears_mm, at.crank_at_mm, *(one.at_mm for one in at.bearings)]
        forces = [*own, shaft.crank_n, *(-one for one in borne)]
        assert np.abs(sum(forces)).max() < 1e-9 * largest
        tilting = sum(place * force for place, force in zip(places, forces, strict=True))
        assert np.abs(tilting).max() < 1e-9 * largest * 100.0
    points, _ = pitch_points(phi1)
    torques = [cross(point, force) for point, force in zip(
        points, [first.gears[0].force_n, second.gears[0].force_n, second.gears[1].force_n, driven.gears[0].force_n],
        strict=True,
    )]  # fmt: skip
    told = [first.gears[0], second.gears[0], second.gears[1], driven.gears[0]]
    for torque, gear in zip(torques, told, strict=True):
        assert np.abs(torque) == pytest.approx(np.abs(gear.torque_n_mm), rel=1e-6, abs=1e-6 * largest)
    # The shaft between: what comes in is what leaves and what its inertia takes.
    between = two().by_stage[0].pair.transmission.driven_angle(phi1, 2)
    inertia = 1e-3 * 30_000.0 * (4.0 * pi) ** 2 * between.derivative(2)
    assert told[1].torque_n_mm - told[2].torque_n_mm == pytest.approx(inertia, rel=1e-9, abs=1e-6 * largest)
    assert np.abs(inertia).max() > 1000.0


def test_a_stage_has_the_forces_of_the_whole_machine() -> None:
    whole = two()
    for stage in whole.by_stage:
        assert stage.rigid is whole.rigid
        assert stage.whole is whole


@pytest.mark.slow
def test_commands_tell_the_same_of_pairs_in_series(run: Run) -> None:
    """A strength tells the same safeties as the drive, and shafts, keys and bearings but once."""
    status, out, err = on_text(run, "strength")(TEXT)
    assert (status, err) == (0, "")
    for number, stage in enumerate(two().by_stage, 1):
        for one in rating_of(stage).weakest:
            row = next(
                line for line in out.splitlines() if f"stage {number}: {one.gear.value}, {one.damage.words}" in line
            )
            assert float(row.split()[4]) == pytest.approx(one.safety, rel=6e-3)
    assert " ".join(out.split()).count("changes its sense") <= 1


def test_two_forces_on_a_shaft_add_as_each_alone() -> None:
    """Superposition, and both point loads by hand; the same shaft without its second gear bends otherwise."""
    idle, none = np.zeros(1), 0j * np.zeros(1)
    pressing = np.array([1000.0 + 200.0j]), np.array([-300.0 + 900.0j])
    at = Seats((Bearing(-50.0, "ball"), Bearing(150.0, "ball")), (0.0, 100.0))

    def loaded(*forces: Array) -> ShaftLoads:
        return ShaftLoads(idle, idle, tuple(GearLoads(one, idle, idle, none) for one in forces), none)

    both, parts = loaded(*pressing), [loaded(pressing[0], none), loaded(none, pressing[1])]
    for bearing in (0, 1):
        alone = sum(bearing_forces(one, at)[bearing] for one in parts)
        assert bearing_forces(both, at)[bearing] == pytest.approx(alone)
    # By hand: a force at c of 200 mm between bearings leaves (200 - c) / 200 of it on the first.
    assert bearing_forces(both, at)[0][0] == pytest.approx(0.75 * pressing[0][0] + 0.25 * pressing[1][0])
    for place in (-50.0, -20.0, 0.0, 60.0, 100.0, 130.0, 150.0):
        by_hand = sum(
            force[0] * min((150.0 - c) * (place + 50.0), (c + 50.0) * (150.0 - place)) / 200.0
            for c, force in zip(at.gears_mm, pressing, strict=True)
        )
        assert abs(bending_moment_n_mm(both, at, place)[0]) == pytest.approx(abs(by_hand), abs=1e-9)
    moments = {place: float(np.abs(bending_moment_n_mm(both, at, place)[0])) for place in bending_places_mm(both, at)}
    assert most_bent(moments, at).at_mm in at.gears_mm
    assert abs(bending_moment_n_mm(parts[0], at, 100.0)[0]) < 0.5 * abs(bending_moment_n_mm(both, at, 100.0)[0])


@pytest.mark.slow
def test_bearings_between_live_as_by_hand() -> None:
    """L_10 by even steps of the angle that the shaft between turns, at the one speed of all shafts, 120 r/min."""
    cycle, at = cycle_of(two().rigid), seats(1)
    lives = shaft_peaks(cycle, {1: at}, WantedLife(10_000.0, 90.0))[1].bearings
    phi1 = np.linspace(0.0, 2.0 * pi, 40_001)
    middle = (phi1[1:] + phi1[:-1]) / 2.0
    turned = two().by_stage[0].pair.transmission.driven_angle(phi1, 0).value
    meshes = two().rigid.machine.at(middle).meshes
    into, out = (one.force.x.value + 1j * one.force.y.value for one in meshes)
    on_second = (into * 35.0 - out * 95.0) / 130.0
    for life, force in zip(lives, (into - out - on_second, on_second), strict=True):
        cube = float(np.diff(turned) @ np.abs(force) ** 3) / (2.0 * pi)
        assert life.equivalent_n == pytest.approx(cube ** (1.0 / 3.0), rel=1e-5)
        assert life.life_h == pytest.approx(1e6 * (20_000.0**3 / cube) / 120.0 / 60.0, rel=1e-4)


@pytest.mark.slow
def test_parts_of_pairs_in_series_bear_the_worst_of_law_and_knocks() -> None:
    found, knocking = two().drivetrain, two().knocking
    assert knocking is not None
    phi1 = np.linspace(0.0, 2.0 * pi, 100_001)
    loads = knocking.at(phi1)
    into, out = (one.force.x.value + 1j * one.force.y.value for one in loads.meshes)
    # The torques that both pairs bear, at their own angles.
    between = two().by_stage[0].pair.transmission.driven_angle(phi1, 1)
    for torque, borne, angle in (
        (loads.passed[0].value / between.derivative(1), knocking.borne[0], phi1),
        (loads.driven_torque.value, knocking.borne[1], between.value),
    ):
        assert torque == pytest.approx(borne.turning(angle), rel=1e-6, abs=1e-3 * np.abs(torque).max())
    shaft, losses = found.shafts[1], found.demand.losses
    assert shaft is not None
    assert shaft.bearings is not None
    forces = (into - out - (into * 35.0 - out * 95.0) / 130.0, (into * 35.0 - out * 95.0) / 130.0)
    for life, force in zip(shaft.bearings, forces, strict=True):
        assert life.largest_n.value == pytest.approx(np.abs(force).max(), rel=0.01 + losses.mesh_share)
    assert set(shaft.decided_by.values()) == {"knocks"}
    still = drive_of_text(TEXT.replace("backlash_mm: 0.1", "backlash_mm: 0")).drivetrain.shafts[1]
    assert still is not None
    assert still.bearings is not None
    assert shaft.bearings[0].largest_n.value > 1.1 * still.bearings[0].largest_n.value
    peaks = two().knocking_peaks
    assert peaks is not None
    assert peaks.between_bearings_n[0].value == pytest.approx(np.abs(out - into).max(), rel=0.01)
    assert peaks.joints_n["pin"].value > 1.2 * two().rigid.peaks.joints_n["pin"].value
    assert not any("not judged" in str(one) for one in around(two()))


@pytest.mark.slow
def test_the_load_along_the_width_of_both_meshes_knows_the_other_gear() -> None:
    """K_Hbeta is computed of both, and another where the other gear stands elsewhere; bearings of one shaft missing:
    1.3."""
    both = [one.told_face_load_by("estimate") for one in two().by_stage]
    assert all(one is not None and one.decisive_factor_by_shafts > 1.1 for one in both)
    model = two().by_stage[1].face_loading.model
    assert model is not None
    assert model.beside_mm == (-60.0, 80.0)
    assert model.shafts[0].supports[0].at_mm == -95.0
    farther = drive_of_text(TEXT.replace("second_gear_at_mm: 60", "second_gear_at_mm: 40"))
    for one, other in zip(farther.by_stage, both, strict=True):
        told = one.told_face_load_by("estimate")
        assert told is not None
        assert other is not None
        assert abs(told.decisive_factor_by_shafts / other.decisive_factor_by_shafts - 1.0) > 0.01
    none = drive_of_text(TEXT.replace("  shafts_between:\n" + BETWEEN, "")).by_stage[1].face_loading
    assert (none.basis, none.why) == ("assumed", "drivetrain gives no bearings of the shaft between the stages")


@pytest.mark.slow
def test_a_shaft_between_alike_gears_that_stand_close_is_loaded_as_one_of_a_single_pair() -> None:
    """Without the second mesh's force, the shaft between is the driven shaft of its pair."""
    phi1 = np.linspace(0.0, 2.0 * pi, 50)
    shaft = loads_at(two().rigid.machine, phi1).shafts[1]
    first, second = shaft.gears
    quiet = replace(second, force_n=0.0 * second.force_n, torque_n_mm=0.0 * second.torque_n_mm)
    at = seats(1)
    for one, other in zip(
        bearing_forces(replace(shaft, gears=(first, quiet)), at),
        bearing_forces(replace(shaft, gears=(first,)), Seats(at.bearings)),
        strict=True,
    ):
        assert one == pytest.approx(other, rel=1e-12)


@at_once(
    ("changes", "said"),
    [
        (("pairs: 2, ", ""), "shafts_between: 1 given, but one pair has none"),
        ((BETWEEN, 2 * BETWEEN), "shafts_between: 2 given, but two pairs of gears have 1"),
        (("pairs: 2", "pairs: 3"), "shafts_between: 1 given, but three pairs of gears have 2"),
        (("second_gear_at_mm: 60", "second_gear_at_mm: 19"), "second_gear_at_mm: 19 mm given, but the gears are 20 mm"),
        (("bearing_b: {at_mm: 95", "bearing_b: {at_mm: 65"), "bearing_b.at_mm: 65 mm is within the gear"),
        (("second_gear_at_mm: 60,", "second_gear_at_mm: 60, diameter_mm: 31,"), "diameter_mm: 31 mm given, but a bore"),
        (("pairs: 2", "helix: {angle_deg: 10, kind: helical, hand: right}, pairs: 2"), "helix.kind: helical given"),
    ],
)
def test_shafts_between_that_cannot_be_are_refused_in_their_line(changes: tuple[str, str], said: str) -> None:
    old, new = changes
    text = TEXT.replace(old, new)
    if "pairs: 3" in new:
        text = text.replace("shaft_between_kg_mm2: 30000", "shaft_between_kg_mm2: [30000, 30000]")
    if not new:
        text = text.replace(" shaft_between_kg_mm2: 30000,", "")
    with pytest.raises(WrongInput) as refusal:
        drive_of_text(text)
    assert said in str(refusal.value)
    assert ".yaml:" in str(refusal.value)


@pytest.mark.slow
@pytest.mark.judges("drivetrain")
def test_the_shipped_machine_of_two_pairs_holds() -> None:
    """Teeth of both pairs, shafts, keys and bearings.  The carton pusher's motion against ten times its resistance
    asks for ten times its power; rigid bodies, teeth and bearings bear the same forces."""
    made, carton = drive("crate-pusher"), drive("pusher")
    power_w = made.check.peak_power_resistance_w.value
    assert power_w == pytest.approx(10.0 * carton.check.peak_power_w.value, rel=1e-9)
    verdict = judged(made, KnownParts.TEETH)
    assert not verdict.warnings
    assert "drivetrain" not in verdict.not_judged
    assert {"peak_mesh_force_n", "peak_first_mesh_force_n"} <= set(deciding_forces(made))
    for pair, mesh in zip(made.by_stage, (*made.rigid.peaks.meshes_before, made.rigid.peaks.mesh), strict=True):
        assert mesh is not None
        assert min(one.share for one in rating_of(pair).weakest) > 1.1
        still = pair.loading_by("estimate").still
        assert still is not None
        _, row = np.unique(still.contacts.position, return_inverse=True)
        assert np.bincount(row, still.contacts.force_n).max() == pytest.approx(mesh.force_n.value, rel=2e-3)
