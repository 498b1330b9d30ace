"""The load of each of two pairs of gears in series: both pass on the power that the slider takes in.

The judges are the power of the slider's own motion, and designs in which one of both pairs turns evenly, so that the
other one is the single pair of another design.
"""

from __future__ import annotations

import json
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from commands import ROOT, Run, on_text
from drives import drive, drive_of_text
from ncgear.errors import NoSuchMechanism, WrongInput
from ncgear.figures.advice.values import Kind
from ncgear.figures.advice.verdict import KnownParts
from ncgear.numerics.arrays import Array
from ncgear.pitch.shape import Gear
from ncgear.project.drive import Drive
from ncgear.project.rough_strength import rough_strength
from ncgear.project.strengthening import known_rating, rating_of, unknown
from ncgear.strength.holding import Damage, lives_of
from verdicts import verdict_on

TEXT = """\
name: press
linkage: {{crank_mm: 38, rod_mm: 96}}
operation: {{speed_rpm: 60}}
motion: {{law: harmonic_ratio, cosine: {first}, sine: {sine}{second}}}
gears: {{teeth: 24, module_mm: 1.5, face_width_mm: 10}}
resistance: {{polynomial_n: [400]}}
"""
SLIDER = """\
masses:
  slider_kg: 30
  rod: {mass_kg: 0, center_mm: 0, inertia_kg_mm2: 0}
  crank: {mass_kg: 0, center_mm: 0, inertia_kg_mm2: 0}
  driving_gear_kg_mm2: 0
"""
DRIVEN = "  driven_gear_kg_mm2: 0\n  shaft_between_kg_mm2: 0\n"
WHOLE, SINE = "[-0.35, 0.08]", "[0.12]"
SHARED = TEXT.format(first=WHOLE, sine=SINE, second=", second_stage: {cosine: [-0.2], sine: [0.05]}")
FIRST_EVEN = TEXT.format(first=WHOLE, sine=SINE, second=f", second_stage: {{cosine: {WHOLE}, sine: {SINE}}}")
SECOND_EVEN = TEXT.format(first=WHOLE, sine=SINE, second=", second_stage: {}")
SINGLE = TEXT.format(first=WHOLE, sine=SINE, second="")


@cache
def made(text: str) -> Drive:
    return drive_of_text(text)


def power_of_the_slider(one: Drive, phi1: Array) -> Array:
    """In N mm/s: the resistance and the inertia of the slider against its speed; no other part has any."""
    motion = one.machine.motion(phi1)
    mass = 0.0 if one.design.masses is None else one.design.masses.slider_kg
    # 1 kg mm/s2 is 1e-3 N.  Velocity and acceleration count the same way out, the force against the working stroke.
    return motion.load * motion.velocity + 1e-3 * mass * motion.acceleration * motion.velocity


def passed_on(pair: Drive, angle: Array) -> tuple[Array, Array]:
    """The power in N mm/s that a pair's driving gear takes in and that its driven gear gives, at its own angles."""
    torque, slope = pair.tooth_load.torque_n_mm(angle), pair.pair.transmission.driven_angle(angle, 1).derivative(1)
    # What the driving gear is asked for follows from the pitch radii, r2 / r1 = 1 / slope.
    radii = [np.hypot(*pair.pitch.of(gear).at_angle(angle).position.T) for gear in Gear]
    speed = pair.pair_speed_rad_s(angle)
    return torque * radii[0] / radii[1] * speed, torque * slope * speed


ANGLES = np.linspace(0.0, 4.0 * np.pi, 801)[:-1] + 1e-3


@pytest.mark.thorough
@pytest.mark.parametrize("text", [SHARED, SHARED + SLIDER + DRIVEN], ids=["resistance", "masses"])
def test_every_shaft_passes_on_the_power_of_the_slider(text: str) -> None:
    one = made(text)
    first, second = one.by_stage
    wanted = power_of_the_slider(one, ANGLES)
    between = first.pair.transmission.driven_angle(ANGLES).value
    for pair, angle in ((first, ANGLES), (second, between)):
        for power in passed_on(pair, angle):
            np.testing.assert_allclose(power, wanted, atol=1e-9 * np.abs(wanted).max())
    # Negative control: the crank's torque, which the second pair bears, is not that of the first one.
    torques = [pair.tooth_load.torque_n_mm(angle) for pair, angle in ((first, ANGLES), (second, between))]
    assert np.abs(torques[0] - torques[1]).max() > 0.1 * np.abs(torques[1]).max()
    assert {pair.tooth_load.load for pair in one.by_stage} == {"masses" if "masses" in text else "resistance"}


def test_the_shaft_between_turns_back_to_the_driving_shaft() -> None:
    first, second = made(SHARED).by_stage
    between = first.pair.transmission.driven_angle(ANGLES, 1)
    np.testing.assert_allclose(second.pair.shaft_rad(between.value), ANGLES, atol=1e-11)
    np.testing.assert_allclose(second.pair.speed(between.value), between.derivative(1), rtol=1e-11)


@pytest.mark.tiers(slow=["first even"], rest="long")
@pytest.mark.judges("strength")
@pytest.mark.parametrize(("text", "stage"), [(FIRST_EVEN, 2), (SECOND_EVEN, 1)], ids=["first even", "second even"])
def test_beside_a_pair_that_turns_evenly_the_other_is_a_single_one(text: str, stage: int) -> None:
    one = made(text).by_stage[stage - 1]
    alone, stage_verdict = rating_of(made(SINGLE), "estimate"), rating_of(one, "estimate")
    for mine, other in zip(stage_verdict.weakest, alone.weakest, strict=True):
        assert (mine.gear, mine.damage, mine.tooth) == (other.gear, other.damage, other.tooth)
    for gear in Gear:
        mine, other = (lives_of(verdict.strength, gear) for verdict in (stage_verdict, alone))
        for damage in Damage:
            np.testing.assert_allclose(mine[damage].stress_mpa, other[damage].stress_mpa, rtol=1e-6, atol=1e-6)
            np.testing.assert_allclose(mine[damage].safety, other[damage].safety, rtol=1e-6)
    # Negative control: the pair that turns evenly bears other loads.
    even = rating_of(made(text).by_stage[2 - stage], "estimate")
    assert abs(even.weakest[0].safety / alone.weakest[0].safety - 1.0) > 0.01


@pytest.mark.slow
def test_flanks_slide_as_fast_as_their_shafts_turn() -> None:
    """At a place of contact both gears' points differ in speed by the sliding; the speeds are found by time."""
    first, second = made(SHARED).by_stage
    found, distance = second.loading_by("estimate").contacts, second.pitch.center_distance_mm
    on = found.flanks
    place = found.on(Gear.DRIVING).point * np.exp(1j * found.phi1_rad)
    step, turned = 1e-5, second.pair.shaft_rad(found.phi1_rad)
    between = [first.pair.transmission.driven_angle(turned + side).value for side in (-step, step)]
    crank = [second.transmission.driven_angle(turned + side).value for side in (-step, step)]
    per_second = second.machine.speed_rad_s / (2.0 * step)
    apart = (between[1] - between[0]) * place + (crank[1] - crank[0]) * (place - distance)
    wanted, sliding = np.abs(apart) * per_second, np.abs(found.sliding_mm_s)
    np.testing.assert_allclose(sliding[on], wanted[on], atol=2e-2 * wanted[on].max())
    # Negative control: with a shaft between that turns evenly it is further from that.
    even = sliding / second.pair.speed(found.phi1_rad)
    assert np.abs(even - wanted)[on].max() > 0.1 * wanted[on].max()


def test_the_whole_has_no_strength_but_each_stage() -> None:
    one = made(SHARED)
    assert "each with a strength of its own" in str(unknown(one))
    assert known_rating(one) is None
    assert [unknown(pair) for pair in one.by_stage] == [None, None]
    with pytest.raises(WrongInput, match="two pairs of gears") as told:
        _ = one.tooth_load
    assert told.value.key == "motion.second_stage"


@pytest.mark.parametrize(("second", "locked"), [("[0.01]", 1), ("[-1.6, 1.6]", 2)])
def test_a_stage_that_cannot_turn_its_mate_is_refused_and_the_other_is_not(second: str, locked: int) -> None:
    """Of ln i12 = 1.6 (cos 2x - cos x) one pair makes nearly all: 93 deg of pressure angle; the other one has 20."""
    text = TEXT.format(first="[-1.6, 1.6]", sine="[0]", second=f", second_stage: {{cosine: {second}}}")
    for pair in made(text).by_stage:
        if pair.stage == locked:
            with pytest.raises(NoSuchMechanism, match="cannot push the driven gear"):
                _ = pair.tooth_load
        else:
            assert pair.tooth_load.peak_n > 0.0


BETWEEN = DRIVEN.replace("between_kg_mm2: 0", "between_kg_mm2: 5e4")


def energy_n_mm(one: Drive, phi1: Array, between_kg_mm2: float) -> Array:
    """Kinetic energy of slider and shaft between, from places that are differenced anew."""
    step, speed = 1e-4, one.machine.speed_rad_s
    sides = [phi1 - step, phi1 + step]
    slid = [one.machine.displacement(side, 0).value for side in sides]
    turned = [one.law.train.pairs[0].transmission.driven_angle(side).value for side in sides]
    rates = [(after - before) / (2.0 * step) for before, after in (slid, turned)]
    return np.asarray(0.5e-3 * speed**2 * (30.0 * rates[0] ** 2 + between_kg_mm2 * rates[1] ** 2))


@pytest.mark.judges("dynamics")
def test_the_shaft_between_two_pairs_takes_its_part_of_the_torque() -> None:
    one, phi1 = made(SHARED + SLIDER + BETWEEN), np.linspace(0.1, 6.2, 60)
    step = 1e-4
    rise = (energy_n_mm(one, phi1 + step, 5e4) - energy_n_mm(one, phi1 - step, 5e4)) / (2.0 * step)
    moved = one.machine.motion(phi1)
    wanted = rise + moved.load * moved.velocity / one.machine.speed_rad_s
    torque = one.driving.machine.at(phi1).driving_torque.value
    np.testing.assert_allclose(torque, wanted, atol=3e-6 * np.abs(wanted).max())
    # Negative control: without the shaft between it is another torque, and the check's power another power.
    without = made(SHARED + SLIDER + DRIVEN)
    assert np.abs(without.driving.machine.at(phi1).driving_torque.value - wanted).max() > 0.03 * np.abs(wanted).max()
    assert one.check.peak_power_w.value != pytest.approx(without.check.peak_power_w.value, rel=1e-3)


def test_the_uniform_crank_of_two_pairs_turns_no_shaft_unevenly() -> None:
    """Its figures are those of one pair, whatever the shaft between weighs."""
    heavy, light = made(SHARED + SLIDER + BETWEEN).uniform_check, made(SHARED + SLIDER + DRIVEN).uniform_check
    single = made(SINGLE + SLIDER + DRIVEN.replace("  shaft_between_kg_mm2: 0\n", "")).uniform_check
    assert heavy.peak_power_w.value == light.peak_power_w.value == pytest.approx(single.peak_power_w.value, rel=1e-9)
    assert heavy.with_masses is not None
    assert single.with_masses is not None
    assert heavy.with_masses.braking_power_w.value == pytest.approx(single.with_masses.braking_power_w.value, rel=1e-9)


def test_gears_between_two_pairs_weigh_what_their_bodies_do() -> None:
    one = made(SHARED + SLIDER)
    first, second = (pair.gear_inertia for pair in one.by_stage)
    assert sum(one.masses.between_inertia_kg_mm2) == first.driven_kg_mm2 + second.driving_kg_mm2 > 0.0
    assert one.masses.driven_inertia_kg_mm2 == second.driven_kg_mm2
    assert one.masses.driving_inertia_kg_mm2 == 0.0
    assert one.by_stage[0].masses == one.by_stage[1].masses == one.masses


@pytest.mark.long
@pytest.mark.slow
def test_the_command_tells_both_stages(run: Run) -> None:
    strength = on_text(run, "strength", "--verbose")
    status, out, err = strength(SHARED)
    assert (status, err) == (0, "")
    folder = Path("export/press-strength")
    for number in (1, 2):
        assert f"stage {number}: driving, breakage" in out
        assert f"stage-{number}/strength.png" in out
    found = [json.loads((folder / f"stage-{number}" / "strength.json").read_text()) for number in (1, 2)]
    assert [one["stage"]["number"] for one in found] == [1, 2]
    status, out, _ = strength(SHARED, "--json")
    assert status == 0
    assert json.loads(out) == {"stages": {"stage_1": found[0], "stage_2": found[1]}}


def test_a_check_warns_of_each_stage_by_its_own_load() -> None:
    """Roughly what every tooth says of steel that is not hard: 0.56 and 0.35 against pitting."""
    text = (ROOT / "designs" / "baler-66-two-stage.yaml").read_text("utf-8")
    one = drive_of_text(text.replace("material: 18CrNiMo7-6", "").replace("width_mm: 68", "width_mm: 30"))
    known = [rough_strength(pair) for pair in one.by_stage]
    found = [min(rough.safety for rough in pair.safeties) for pair in known if pair is not None]
    assert found == pytest.approx([0.56, 0.35], rel=0.1)
    rough = [
        (row.of, advice) for row in verdict_on(Kind.STRENGTH, one, KnownParts.MOTION).rows for advice in row.advices
    ]
    assert [of for of, _ in rough] == ["stage 1: ", "stage 2: "]
    for _, advice in rough:
        assert "the teeth will hardly hold" in advice.line
        assert "ncgear size" not in advice.line


@pytest.mark.slow
def test_the_baler_in_two_stages() -> None:
    """Forces on arms take in the slider's power.  Pinned: the second pair bears twice the force of the first, since it
    turns against the crank itself."""
    one, most = drive("baler-66-two-stage"), []
    for pair in one.by_stage:
        contacts = rating_of(pair).strength.contacts
        places = contacts.on(Gear.DRIVEN)
        arm = np.abs(np.imag(np.conj(places.point) * places.inwards))
        positions, first, row = np.unique(contacts.position, return_index=True, return_inverse=True)
        angle = contacts.phi1_rad[first]
        speed = pair.pair_speed_rad_s(angle) * pair.pair.transmission.driven_angle(angle, 1).derivative(1)
        power = np.bincount(row, contacts.force_n * arm, positions.size) * speed
        wanted = power_of_the_slider(one, pair.pair.shaft_rad(angle))
        np.testing.assert_allclose(power, wanted, atol=1e-9 * wanted.max())
        assert wanted.max() == pytest.approx(6300e3, rel=1e-4)
        most.append(float(contacts.force_n.max()))
    assert most == pytest.approx([17_356.0, 36_902.0], rel=1e-3)
