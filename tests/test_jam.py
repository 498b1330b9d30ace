"""A jam as a load case of its own: by hand on round gears, beside the load of every stroke, in every command."""

from __future__ import annotations

import json

import numpy as np
import pytest

from commands import Run, on_text
from drives import drive_of_text
from ncgear.drivetrain.bearings import Bearing, Seats
from ncgear.drivetrain.jam import HELD, Jam, deciding, jammed_shaft
from ncgear.drivetrain.shafts import STEELS, ShaftSection
from ncgear.dynamics.gaps import LEAST_IN_MODULES, WITHIN_IN_MODULES
from ncgear.errors import WrongInput
from ncgear.figures.advice.drivetrain_advice import around
from ncgear.figures.advice.strength_advice import rough, strength
from ncgear.figures.advice.values import Advice
from ncgear.figures.flanks import surfaces_rows
from ncgear.figures.strong import deciding_forces
from ncgear.pitch.shape import Gear
from ncgear.project.rough_strength import rough_strength
from ncgear.project.strengthening import deciding_loads, rating_of
from ncgear.strength.conditions import face_load_factor_of_roots
from ncgear.strength.holding import Damage

TEXT = """\
name: jammed
linkage: {crank_mm: 40, rod_mm: 150}
operation: {speed_rpm: 60}
motion: {law: uniform_crank}
gears: {teeth: 24, module_mm: 2, face_width_mm: 10, material: 42CrMo4}
resistance: {polynomial_n: [50]}
strength: {application_factor: 1.5, dynamic_factor: 1.2JAM}
"""

TORQUE_N_M = 61.0
JAM = f", overload: {{driving_torque_n_m: {TORQUE_N_M:g}, times: TIMES}}"


def text_of(times: float | None, more: str = "") -> str:
    return TEXT.replace("JAM", "" if times is None else JAM.replace("TIMES", f"{times:g}")) + more


@pytest.mark.thorough
def test_loads_do_not_depend_on_the_depth_to_which_teeth_are_followed() -> None:
    """Pairs are followed by the load of every stroke, 0.05 modules deep; this jam presses them in by 0.15 modules."""
    one = drive_of_text(text_of(1.0).replace(f"{TORQUE_N_M:g}", "1500"))
    jammed = one.judged_teeth("estimate").loading.jammed
    methods = one.judged_teeth("estimate").methods
    deep = one._loading_within(WITHIN_IN_MODULES, methods, one.materials)
    assert jammed is not None
    assert deep.jammed is not None
    assert np.abs(jammed.error_rad).max() > 2.0 * LEAST_IN_MODULES * 2.0 / 24.0
    np.testing.assert_allclose(jammed.contacts.force_n, deep.jammed.contacts.force_n, rtol=1e-9)
    light = drive_of_text(text_of(None))
    found = light.judged_teeth("estimate").loading.contacts.force_n
    np.testing.assert_allclose(found, deep.contacts.force_n, rtol=1e-9)


def test_round_gears_bear_a_jam_as_by_hand() -> None:
    """T / (r cos 20 deg) on one pair where it stands alone; without K_A and K_V."""
    one = drive_of_text(text_of(1.0))
    jammed, without = one.judged_teeth("estimate").jammed, drive_of_text(text_of(None)).strength
    assert jammed is not None
    force_n = 1e3 * TORQUE_N_M / (24.0 * np.cos(np.radians(20.0)))
    assert jammed.contacts.force_n.max() == pytest.approx(force_n, rel=1e-6)
    roots_shared = face_load_factor_of_roots(one.running, np.array(one.face_loading.constant))
    for place, gear in enumerate(Gear):
        of_unit = one.judged_teeth("estimate").methods[place].root_stress(jammed.contacts.on(gear)).tension_mpa
        plain = of_unit * jammed.contacts.force_n / 10.0 * roots_shared
        assert jammed.stresses.tension_mpa[place] == pytest.approx(plain, rel=1e-9)
        static = float(jammed.of(gear).material.bending.stress_mpa[0])
        stress = float(jammed.stresses.tension_mpa[place].max())
        assert jammed.of(gear).bending.safety_min == pytest.approx(static / stress, rel=1e-6)
        assert one.strength.of(gear).bending.safety_min == jammed.of(gear).bending.safety_min
        np.testing.assert_array_equal(one.strength.of(gear).bending.life_h, without.of(gear).bending.life_h)


@pytest.mark.slow
def test_many_jams_are_endured_less_and_a_light_one_changes_nothing() -> None:
    once, often = (drive_of_text(text_of(times)).strength.driving.bending.safety_min for times in (1.0, 1e6))
    assert often < 0.8 * once
    broken = drive_of_text(text_of(1.0).replace(f"{TORQUE_N_M:g}", "1000")).strength.driving.bending
    assert broken.safety_min < 1.0
    assert broken.life_h[broken.weakest - 1] == 0.0
    light = drive_of_text(text_of(1.0).replace(f"{TORQUE_N_M:g}", "0.1"))
    without = drive_of_text(text_of(None))
    assert light.strength.driving.bending.safety_min == without.strength.driving.bending.safety_min


@pytest.mark.slow
def test_the_second_of_two_stages_bears_the_jam_by_both_ratios() -> None:
    law = "law: harmonic_ratio, cosine: [0.1], second_stage: {cosine: [-0.2]}"
    series = text_of(1.0).replace("law: uniform_crank", law)
    first, second = drive_of_text(series).by_stage
    whole = drive_of_text(series)
    own = np.linspace(0.0, 6.0, 7)
    torque = second.tooth_load.passed_on_n_mm(1e3 * TORQUE_N_M, own)
    slope = whole.transmission.driven_angle(second.pair.shaft_rad(own), 1).derivative(1)
    assert torque == pytest.approx(1e3 * TORQUE_N_M / slope, rel=1e-9)
    assert first.judged_teeth("estimate").jammed is not None


AROUND = """
masses:
  slider_kg: 2
  rod: {mass_kg: 1, center_mm: 50, inertia_kg_mm2: 1000}
  crank: {mass_kg: 1, center_mm: 10, inertia_kg_mm2: 1000}
  flywheel: {speed_fluctuation: 0.1}
drivetrain:
  driving_shaft:
    bearing_a: {at_mm: -30, dynamic_rating_n: 20000, static_rating_n: 4000}
    bearing_b: {at_mm: 30, dynamic_rating_n: 20000}
    diameter_mm: 16
    steel: C45
    key: {height_mm: 2, length_mm: 10}
  driven_shaft:
    crank_at_mm: 60
    bearing_a: {at_mm: -30, dynamic_rating_n: 20000, static_rating_n: 9000}
    bearing_b: {at_mm: 30, dynamic_rating_n: 20000, static_rating_n: 9000}
"""


FORCE_N = 1e3 * TORQUE_N_M / (24.0 * np.cos(np.radians(20.0)))
"""At the teeth of round gears."""


def test_a_shaft_between_two_bearings_bears_a_jam_as_by_hand() -> None:
    """The gear in the middle between both; without a crank on it, and a section that yields by its own moments."""
    one = drive_of_text(text_of(1.0, AROUND))
    assert one.jam is not None
    ends = Bearing(-20.0, "ball", 20_000.0, 4000.0), Bearing(60.0, "ball", 20_000.0)
    section = ShaftSection(16.0, 16.0, STEELS["C45"])
    found = jammed_shaft(one.jam, 0, Seats(ends), section)
    assert [most.value for most in found.largest_n] == pytest.approx([0.75 * FORCE_N, 0.25 * FORCE_N])
    assert found.static_safety == (pytest.approx(4000.0 / (0.75 * FORCE_N)), None)
    bent = 0.75 * FORCE_N * 20.0 / (np.pi * 16.0**3 / 32.0)
    twisted = 1e3 * TORQUE_N_M / (np.pi * 16.0**3 / 16.0)
    assert found.yielding == pytest.approx(490.0 / np.sqrt(bent**2 + 3.0 * twisted**2), rel=1e-6)
    assert found.torques_n_mm == (pytest.approx(1e3 * TORQUE_N_M),)


@pytest.mark.slow
def test_shafts_keys_and_bearings_bear_a_jam_as_by_hand() -> None:
    """T / (r cos 20 deg) at the gear, half of it at either bearing."""
    one = drive_of_text(text_of(1.0, AROUND))
    found = one.drivetrain.shafts[0]
    assert found is not None
    assert found.jammed is not None
    assert found.jammed_key is not None
    force = FORCE_N
    assert [most.value for most in found.jammed.largest_n] == pytest.approx([force / 2.0, force / 2.0])
    assert found.jammed.static_safety == (pytest.approx(8000.0 / force), None)
    bent, twisted = force / 2.0 * 30.0 / (np.pi * 16.0**3 / 32.0), 1e3 * TORQUE_N_M / (np.pi * 16.0**3 / 16.0)
    assert found.jammed.yielding == pytest.approx(490.0 / np.sqrt(bent**2 + 3.0 * twisted**2), rel=1e-6)
    assert found.jammed_key.pressure_mpa == pytest.approx(2e3 * TORQUE_N_M / (16.0 * 2.0 * 10.0))


def test_the_rod_of_a_held_slider_bears_what_its_triangle_says() -> None:
    one, force = drive_of_text(text_of(1.0, AROUND)), FORCE_N
    jam = Jam.of(one.rigid.machine, 1e3 * TORQUE_N_M, np.linspace(0.0, 2.0 * np.pi, 200))
    phi1 = np.array([0.01, 0.4, 1.2, 2.0, 3.1, 4.0, 5.5])
    loads = jam.shaft(1, phi1)
    # At phi = 0 the slider is next to the crank's axis; the rod leans by beta.
    beta = np.arcsin(40.0 * np.sin(phi1) / 150.0)
    way = 40.0 * np.sin(phi1) - 40.0 * np.cos(phi1) * np.tan(beta)
    grid = np.linspace(0.0, np.pi, 20_001)
    leaning = np.tan(np.arcsin(40.0 * np.sin(grid) / 150.0))
    fastest = np.abs(40.0 * np.sin(grid) - 40.0 * np.cos(grid) * leaning).max()
    held = 1e3 * TORQUE_N_M / np.maximum(np.abs(way), fastest / 2.0)
    assert np.abs(loads.crank_n) == pytest.approx(held / np.cos(beta), rel=1e-6)
    assert np.abs(loads.crank_n.imag / loads.crank_n.real) == pytest.approx(np.abs(np.tan(beta)), abs=1e-9)
    assert np.abs(loads.gears[0].force_n) == pytest.approx(np.full(7, force))
    near, far = np.abs(loads.crank_n[[0, 2]])
    assert near < 3.0 * far  # Without a bound it would be a hundred times as much.

    # Peaks of all joints: the pin bears what the rod passes on, the guide what the rod leans, and 30 degrees of its
    # fastest way bound both.
    told, phi1 = one.jam.peaks(), np.linspace(0.0, 2.0 * np.pi, 100_001)
    beta = np.arcsin(40.0 * np.sin(phi1) / 150.0)
    way = np.abs(40.0 * np.sin(phi1) - 40.0 * np.cos(phi1) * np.tan(beta))
    held = 1e3 * TORQUE_N_M / np.maximum(way, HELD * fastest)
    assert told.joints_n["pin"].value == pytest.approx((held / np.cos(beta)).max(), rel=1e-5)
    assert told.joints_n["wrist"].value == pytest.approx(told.joints_n["pin"].value)
    assert told.guide_n.value == pytest.approx(np.abs(held * np.tan(beta)).max(), rel=1e-5)
    assert told.mesh.force_n.value == pytest.approx(force)


def test_the_load_that_is_named_first_decides_among_equal_ones() -> None:
    assert deciding({"law": 1.0, "knocks": 1.0 + 1e-9}) == "law"
    assert deciding({"law": 1.0, "knocks": 1.01, "jam": 1.01}) == "knocks"
    assert deciding({"law": 1.0, "knocks": 1.01, "jam": 2.0}) == "jam"
    assert deciding({"law": 0.0, "jam": 0.0}) == "law"


@pytest.mark.slow
@pytest.mark.judges("drivetrain")
@pytest.mark.parametrize(
    ("decides", "speed_rpm", "force_n", "torque_n_m"),
    [("law", 10, 3000, 20), ("knocks", 300, 0, 0.5), ("jam", 120, 0, 300)],
)
def test_shafts_keys_bearings_and_joints_tell_which_load_decides(
    decides: str, speed_rpm: float, force_n: float, torque_n_m: float
) -> None:
    """A press by its own force, a fast machine by its knocks, a stuck one by its jam.

    The gear stands in the middle of its shaft: either bearing bears half the mesh force, of a jam T / (r cos 20 deg).
    """
    text = text_of(1.0, AROUND).replace(f"{TORQUE_N_M:g}", f"{torque_n_m:g}").replace("[50]", f"[{force_n}]")
    backlash = "42CrMo4, backlash_mm: 0.2}"
    text = text.replace("rpm: 60", f"rpm: {speed_rpm}").replace("42CrMo4}", "42CrMo4}" if force_n else backlash)
    one = drive_of_text(text)
    found, knocking = one.drivetrain, one.knocking_peaks
    halves = {
        "law": one.rigid.peaks.mesh.force_n.value / 2.0,
        "jam": 1e3 * torque_n_m / (48.0 * np.cos(np.radians(20.0))),
    }
    halves |= {"knocks": knocking.mesh.force_n.value / 2.0} if knocking else {}
    assert max(halves, key=halves.__getitem__) == decides
    for shaft in (found.shafts[0], found.shafts[1]):
        for part, load in shaft.decided_by.items():
            if part.endswith("life") or part == "fatigue":  # Nothing tires of a jam.
                assert load != "jam"
                assert decides == "jam" or load == decides
            else:
                assert (part, load) == (part, decides)
    forces = deciding_forces(one)
    assert {load for _, load in forces.values()} == {decides}
    assert forces["peak_mesh_force_n"][0] == pytest.approx(2.0 * max(halves.values()))


@pytest.mark.slow
def test_what_a_jam_dents_is_told() -> None:
    said = [one.what for one in around(drive_of_text(text_of(1.0, AROUND))) if isinstance(one, Advice)]
    assert not any("in a jam bearing a of the driving" in one for one in said)
    weak = AROUND.replace("4000", "1000").replace("steel: C45", "steel: S355").replace("length_mm: 10", "length_mm: 3")
    said = [one.line for one in around(drive_of_text(text_of(1.0, weak))) if isinstance(one, Advice)]
    dented = next(
        one for one in said if one.startswith("in a jam the load of bearing a of the driving shaft is 1352 N")
    )
    assert "drivetrain.driving_shaft.bearing_a.static_rating_n: 1353 or over" in dented
    assert any(one.startswith("in a jam the pressure on the key of the driving shaft is 1271 MPa") for one in said)
    without = [one.what for one in around(drive_of_text(text_of(None, weak))) if isinstance(one, Advice)]
    assert not any("jam" in one for one in without)


@pytest.mark.slow
def test_a_check_and_a_build_tell_of_teeth_that_a_jam_breaks(run: Run) -> None:
    breaking = text_of(1.0).replace(f"{TORQUE_N_M:g}", "1000")
    one = drive_of_text(breaking)
    for judge in (rough, strength):
        assert judge(drive_of_text(text_of(1.0).replace(f"{TORQUE_N_M:g}", "20"))) is None
        assert isinstance(judge(one), Advice)
    guessed = rough_strength(one)
    assert guessed is not None
    roots = min(found.safety for found in guessed.safeties if found.damage is Damage.BENDING)
    assert roots / min(one.strength.of(gear).bending.safety_min for gear in Gear) == pytest.approx(1.0, abs=0.2)
    _, told, _ = on_text(run, "strength", "--json")(breaking)
    assert json.loads(told)["load"]["jam"]["driving_torque_n_m"] == pytest.approx(1000.0)


@pytest.mark.slow
@pytest.mark.judges("strength")
def test_a_jam_alone_is_rated_as_beside_a_resistance() -> None:
    """Safeties of the jam are those that it has beside a small load, and nothing else ends the teeth's life."""
    both, resistance = drive_of_text(text_of(1.0)), "resistance: {polynomial_n: [50]}\n"
    alone = drive_of_text(text_of(1.0).replace(resistance, ""))
    rated, beside = rating_of(alone), both.judged_teeth("estimate").jammed
    assert beside is not None
    assert rated.strength.load == "jam"
    assert np.all(rated.strength.stresses.dynamic_factor == 1.0)
    for gear in Gear:
        one, other = rated.strength.of(gear).bending, beside.of(gear).bending
        assert one.safety == pytest.approx(other.safety, rel=0.05)
        assert np.all(np.isinf(one.life_h))
    assert rated.strength.peak_pair_n == pytest.approx(beside.peak_pair_n, rel=0.05)
    told = rough(alone)
    assert isinstance(told, Advice)
    assert "against pitting" in told.what
    assert min(one.safety for one in rated.weakest if one.damage is Damage.CONTACT) < 1.0
    # Without the jam nothing loads the teeth.
    with pytest.raises(WrongInput, match="missing"):
        rating_of(drive_of_text(text_of(None).replace(resistance, "")))


@pytest.mark.slow
@pytest.mark.judges("project")
@pytest.mark.parametrize("times", [100, 100_000])
def test_a_check_judges_flanks_and_life_of_teeth_in_a_jam(times: int) -> None:
    """As the teeth do: a shock that no root feels dents flanks, and many of them are endured less."""
    jammed = drive_of_text(
        "name: jammed\noperation: {speed_rpm: 60}\nmotion: {law: ellipse, eccentricity: 0.3}\n"
        "gears: {teeth: 31, module_mm: 2, face_width_mm: 15, material: 42CrMo4, backlash_mm: 0.06}\n"
        f"strength: {{overload: {{driving_torque_n_m: 200, times: {times}}}}}\n"
    )
    found, known = rough_strength(jammed), rating_of(jammed)
    assert found is not None
    assert not found.unjudged
    for damage in Damage:
        rough_one = min(one.safety for one in found.safeties if one.damage is damage)
        exact = min(one.safety for one in known.weakest if one.damage is damage)
        assert 0.8 <= rough_one / exact <= 1.1
    assert {one.damage for one in found.weak} == ({Damage.CONTACT} if times == 100 else set(Damage))


JAMMED = """\
name: jammed
linkage: {crank_mm: 40, rod_mm: 150}
operation: {speed_rpm: 60}
motion: {law: uniform_crank}
gears: {teeth: 24, module_mm: 2, face_width_mm: 20, material: 42CrMo4}
strength: {overload: {driving_torque_n_m: 40, times: 100}}
"""


@pytest.mark.slow
def test_flanks_that_only_a_jam_presses_are_not_judged_for_film_and_wear() -> None:
    """A resistance that is nowhere more than none is the same machine, and a force that is more is not."""
    told = []
    for more in ("", "resistance: {polynomial_n: [0]}\n", "resistance: {polynomial_n: [50]}\n"):
        made = drive_of_text(JAMMED + more)
        found = made.surfaces_by("estimate")
        assert found.judged == ("50" in more)
        assert (found.film is not None) == found.judged
        assert set(deciding_loads(made, rating_of(made)).values()) == {"jam"}
        told.append((made.strength.load, dict(surfaces_rows(made, found))["wear"].startswith("not judged, because")))
    assert told == [("jam", True), ("jam", True), ("resistance", False)]


def test_a_check_judges_the_jam_of_two_pairs_whose_knocks_only_teeth_can_tell() -> None:
    """Its safety is that of round gears of the same teeth in one pair, whose second shaft turns alike."""
    law = "law: harmonic_ratio, cosine: [0], second_stage: {cosine: [0]}"
    masses = AROUND.partition("drivetrain")[0] + "  shaft_between_kg_mm2: 3000\n"
    single = rough_strength(drive_of_text(text_of(1.0)))
    for pair in drive_of_text(text_of(1.0, masses).replace("law: uniform_crank", law)).by_stage:
        found = rough_strength(pair)
        assert found is not None
        assert single is not None
        assert "knock" in found.needs_teeth
        (weak,) = {one.safety for one in found.weak}
        assert weak == pytest.approx(min(one.safety for one in single.weak), rel=1e-6)
        told = rough(pair)
        assert isinstance(told, Advice)
        assert "safety about" in told.what
        assert "the load of a jam" in told.line
