"""Film, heat and wear of flanks: against calculations by hand, other published formulas, and brute force."""

from __future__ import annotations

import csv
from dataclasses import replace
from math import log10, pi

import mpmath
import numpy as np
import pytest

from drives import drive, drive_of_text
from ncgear.figures.advice.strength_advice import flanks
from ncgear.figures.advice.values import Advice
from ncgear.figures.flanks import film_csv, surfaces_rows
from ncgear.numerics.arrays import Array
from ncgear.project.drive import Drive
from ncgear.project.vibration import mesh_stiffness
from ncgear.strength.conditions import Conditions, Running
from ncgear.strength.contacts import LoadedContacts
from ncgear.strength.film import (
    MOST_FRICTION,
    Oil,
    Pressed,
    Regime,
    film_um,
    flash_k,
    friction,
    scuffing_c,
    usual_at_100_mm2_s,
)
from ncgear.strength.materials import TABLE, Choice
from ncgear.strength.surfaces import _Pair
from ncgear.strength.wear import (
    MOST_SLIDING,
    coefficient_mm3_n_m,
    depth_mm,
    share_unparted,
    usual_mm3_n_m,
)
from strong import STEEL

BOTH = STEEL, STEEL
OIL = Oil(220.0, 19.0)
CONDITIONS = Conditions(oil_viscosity_100_mm2_s=19.0)
PLACE = Pressed(np.array([250.0]), np.array([1.0 / 9.0]), np.array([[0.62, 0.41]]))
"""250 N/mm on a relative radius of 9 mm, where the contact moves at 0.62 and 0.41 m/s along the flanks."""


def mp(value: float) -> mpmath.mpf:
    return mpmath.mpf(repr(value))


def viscosity(celsius: float) -> mpmath.mpf:
    """Of the oil in mm2/s: a straight line of lg lg (nu + 0.7) over lg T, by hand."""
    at = [mpmath.log10(mp(273.15) + one) for one in (40, 100, mp(celsius))]
    known = [mpmath.log10(mpmath.log10(mp(one) + mp(0.7))) for one in (220.0, 19.0)]
    line = known[0] + (known[1] - known[0]) * (at[2] - at[0]) / (at[1] - at[0])
    return mpmath.power(10, mpmath.power(10, line)) - mp(0.7)


def pascal_seconds(celsius: float) -> mpmath.mpf:
    density = mp(43.37) * mpmath.log10(220) + mp(805.5) - mp(0.7) * (mp(celsius) + 273 - 289)
    return viscosity(celsius) * density / 10**6


def alpha(celsius: float) -> mpmath.mpf:
    at_38 = mp(2.657e-8) * pascal_seconds(38.0) ** mp(0.1348)
    return at_38 * (1 + 516 * (1 / (mp(celsius) + 273) - mp(1) / 311))


class TestOil:
    def test_it_has_the_viscosities_that_are_given(self) -> None:
        assert OIL.kinematic_mm2_s(np.array([40.0, 100.0])) == pytest.approx([220.0, 19.0], rel=1e-12)

    @pytest.mark.parametrize("celsius", [-20.0, 20.0, 65.0, 130.0])
    def test_it_flows_as_calculated_by_hand(self, celsius: float) -> None:
        assert float(OIL.kinematic_mm2_s(celsius)) == pytest.approx(float(viscosity(celsius)), rel=1e-10)
        assert float(OIL.dynamic_pa_s(celsius)) == pytest.approx(float(pascal_seconds(celsius)), rel=1e-10)
        assert float(OIL.thickening_per_pa(celsius)) == pytest.approx(float(alpha(celsius)), rel=1e-10)

    def test_left_out_it_is_an_oil_of_viscosity_index_95(self) -> None:
        """ISO 2909 of 70 mm2/s and more at 100 degrees: L and H are parabolas; of 10 mm2/s its table has them."""
        for thin, low, high in (
            (10.0, 147.7, 82.87),
            (70.0, 0.8353 * 70.0**2 + 14.67 * 70.0 - 216.0, 0.1684 * 70.0**2 + 11.85 * 70.0 - 97.0),
        ):
            at_40 = low - 0.95 * (low - high)
            assert usual_at_100_mm2_s(at_40) == pytest.approx(thin, rel=3e-3)
        assert Oil.of(Conditions()).at_100_mm2_s == pytest.approx(18.4, abs=0.05)
        assert Oil.of(CONDITIONS) == OIL


class TestFilm:
    def test_it_is_as_thick_as_calculated_by_hand(self) -> None:
        """With the teeth at 60 degrees and the contact 25 K hotter: 0.28 um, of which heat takes 16 %."""
        modulus = 2 / (2 * (1 - mp(0.3) ** 2) / 206000) * 10**6
        radius, load = mp(9.0) / 1000, mp(250.0) * 1000
        speed = pascal_seconds(60.0) * (mp(0.62) + mp(0.41)) / 2 / (modulus * radius)
        hot = alpha(85.0) * pascal_seconds(85.0) / (alpha(60.0) * pascal_seconds(60.0))
        stiff, pressed = alpha(60.0) * modulus, load / (modulus * radius)
        by_hand = mp(1.6) * radius * stiff ** mp(0.6) * speed ** mp(0.7) / pressed ** mp(0.13) * hot ** mp(0.22)
        found = film_um(PLACE, np.array([25.0]), 60.0, OIL, BOTH)
        assert found == pytest.approx([float(by_hand * 10**6)], rel=1e-9)
        # Dowson's and Higginson's later formula for the least thickness has other powers, and no heat.
        later = mp(2.65) * radius * stiff ** mp(0.54) * speed ** mp(0.7) / pressed ** mp(0.13)
        assert film_um(PLACE, np.zeros(1), 60.0, OIL, BOTH) == pytest.approx([float(later * 10**6)], rel=0.02)

    def test_speed_and_thicker_oil_part_the_flanks(self) -> None:
        cold = np.zeros(1)
        one = film_um(PLACE, cold, 60.0, OIL, BOTH)
        faster = replace(PLACE, rolling_m_s=10.0 * PLACE.rolling_m_s)
        assert film_um(faster, cold, 60.0, OIL, BOTH) == pytest.approx(10.0**0.7 * one)
        assert film_um(PLACE, cold, 60.0, Oil(460.0, 31.0), BOTH) > 1.3 * one
        assert film_um(PLACE, cold, 40.0, OIL, BOTH) > 1.3 * one
        assert film_um(PLACE, np.array([40.0]), 60.0, OIL, BOTH) < 0.9 * one
        assert film_um(PLACE, np.array([4000.0]), 900.0, OIL, BOTH) > 0.0

    def test_regimes_have_their_ends(self) -> None:
        assert [Regime.of(one) for one in (0.69, 0.7, 1.99, 2.0)] == ["boundary", "mixed", "mixed", "full film"]


class TestHeat:
    def test_friction_is_as_calculated_by_hand(self) -> None:
        """0.060 (250 / (1.03 9))^0.2 (1e3 eta)^-0.05 with Ra 1 um, the oil at 40 degrees: 0.0893."""
        by_hand = mp(0.060) * (mp(250.0) / (mp(1.03) * 9)) ** mp(0.2) / (1000 * pascal_seconds(40.0)) ** mp(0.05)
        assert friction(PLACE, OIL, CONDITIONS) == pytest.approx([float(by_hand)], rel=1e-9)
        still = replace(PLACE, rolling_m_s=np.zeros((1, 2)))
        assert friction(still, OIL, CONDITIONS) == [MOST_FRICTION]

    def test_the_flash_is_that_of_the_standard_for_circular_gears(self) -> None:
        """ISO/TS 6336-20 gives 2.52 mu X_M / 50 w^0.75 sqrt(n / 60) |sqrt(rho1) - sqrt(rho2 / u)| / rho^0.25 for them.

        X_M is 50 for steel of E = 206 GPa and B_M = 435 N/(mm^0.5 m^0.5 s^0.5 K); its constant is rounded.
        """
        speed_rpm, ratio, radii = 900.0, 2.5, (6.0, 21.0)
        rolling = np.array([[radii[0] * speed_rpm, radii[1] * speed_rpm / ratio]]) * 2.0 * pi / 60.0 / 1000.0
        relative = radii[0] * radii[1] / sum(radii)
        place = Pressed(np.array([250.0]), np.array([1.0 / relative]), rolling)
        contact = (45.0 * 440.0 * STEEL.density_kg_m3) ** 0.5 / 1000.0**0.5
        roots = abs(radii[0] ** 0.5 - (radii[1] / ratio) ** 0.5) / relative**0.25
        standard = 2.52 * 0.06 * 435.0 / contact * 250.0**0.75 * (speed_rpm / 60.0) ** 0.5 * roots
        assert flash_k(place, np.array([0.06]), BOTH) == pytest.approx([standard], rel=0.03)

    def test_nothing_is_heated_or_worn_where_nothing_slides(self) -> None:
        rolls = replace(PLACE, rolling_m_s=np.array([[0.5, 0.5]]))
        assert flash_k(rolls, np.array([0.1]), BOTH) == [0.0]
        assert np.all(depth_mm(rolls, np.ones(1), (1e-8, 1e-8)) == 0.0)

    def test_oil_fails_by_its_stage_and_the_steel(self) -> None:
        """80 + 2.25 X_L 144 with X_L = 196 mPa s to the power of -0.05; nitrided 2.95 for 2.25."""
        thin = float((1000 * pascal_seconds(40.0)) ** mp(-0.05))
        assert scuffing_c(OIL, CONDITIONS, 1.0) == pytest.approx(80.0 + 2.25 * thin * 144.0)
        assert scuffing_c(OIL, replace(CONDITIONS, oil_fzg_stage=9.0), 1.5) == pytest.approx(80.0 + 2.95 * thin * 81.0)


class TestWear:
    def test_a_meeting_takes_off_what_pressure_and_sliding_add_up_to(self) -> None:
        """Hertz's pressure passes over a place at 0.62 m/s while the flanks slide at 0.21."""
        half, seconds = 0.3, np.linspace(-1.0, 1.0, 20001) * 0.3 / 620.0
        pressure = 2.0 * 250.0 / (pi * half) * np.sqrt(np.maximum(1.0 - (620.0 * seconds / half) ** 2, 0.0))
        slid_mm = float(np.trapezoid(pressure * 210.0, seconds))
        assert depth_mm(PLACE, np.ones(1), (1e-8, 0.0))[:, 0] == pytest.approx([1e-11 * slid_mm, 0.0], rel=1e-4)
        assert depth_mm(PLACE, np.full(1, 0.5), (0.0, 1e-8))[1] == pytest.approx([0.5e-11 * 250.0 * 0.21 / 0.41])
        turns = replace(PLACE, rolling_m_s=np.array([[0.0, 0.3]]))
        assert depth_mm(turns, np.ones(1), (1e-8, 0.0))[0] == pytest.approx([1e-11 * 250.0 * MOST_SLIDING])

    def test_a_film_saves_the_flanks(self) -> None:
        lambdas = np.array([0.0, 0.5, 2.25, 4.0, 9.0]) * 1.77
        assert share_unparted(lambdas) == pytest.approx([1.0, 1.0, 0.5, 0.0, 0.0])

    def test_coefficients_follow_material_and_lubrication(self) -> None:
        hard, soft, bronze, plastic = (TABLE[name] for name in ("16MnCr5", "C45", "CuSn12", "POM"))
        for entry in (hard, soft, bronze):
            assert usual_mm3_n_m(entry, hard, "oil") < 1e-2 * usual_mm3_n_m(entry, hard, "dry")
            assert usual_mm3_n_m(entry, plastic, "dry") == 0.0
        assert usual_mm3_n_m(hard, soft, "oil") < usual_mm3_n_m(soft, hard, "oil") < usual_mm3_n_m(bronze, hard, "oil")
        assert usual_mm3_n_m(plastic, hard, "grease") < usual_mm3_n_m(plastic, hard, "dry")
        own = replace(CONDITIONS, wear_coefficient_mm3_n_m=3e-7)
        assert coefficient_mm3_n_m(Choice(hard), Choice(soft), own) == 3e-7


TEXT = """\
name: press
linkage: {crank_mm: 38, rod_mm: 96}
operation: {speed_rpm: 60}
motion: {law: ellipse, eccentricity: 0.3}
gears: {teeth: 30, module_mm: 2, face_width_mm: 12, backlash_mm: 0.1}
resistance: {polynomial_n: [150]}
"""


def with_strength(keys: str) -> Drive:
    return drive_of_text(f"{TEXT}strength: {{{keys}}}\n")


@pytest.mark.slow
def test_extremes_are_those_of_a_search_by_brute_force() -> None:
    """At 60 times as many places as pairs are solved at: the least film and the most heat and wear are no worse."""
    made = drive_of_text(TEXT)
    found, loading = made.surfaces_by("estimate"), made.loading_by("estimate")
    film, wear = found.film, found.wear
    assert film is not None
    strength = made.strength
    materials = strength.driving.material, strength.driven.material
    mesh = mesh_stiffness(loading, made.running)

    def factors(contacts: LoadedContacts) -> tuple[Array, Array]:
        shaken = made.vibration.of_contacts(contacts, mesh, made.conditions)
        # K_Hbeta is assumed.
        return shaken, np.full(shaken.shape, 1.3)

    coefficients, oil = wear.coefficients_mm3_n_m, Oil.of(made.conditions)
    pair = _Pair(materials, made.conditions, made.running, coefficients, factors, oil, film.bulk_c)
    pressure = made.strength.stresses.pressure_mpa
    contacts = loading.between(np.linspace(0.0, loading.cycle_mm, 40_001))
    own, _, known = pair.touching(loading.contacts)
    modulus = materials[0].youngs_modulus_mpa / (2.0 * (1.0 - materials[0].poisson ** 2))
    load = pressure[loading.contacts.flanks] ** 2 * pi / (own.relative_curvature * modulus)
    assert load == pytest.approx(known.line_n_mm)
    touching, shaken, pressed = pair.touching(contacts)
    rows = pair.quantities(touching.side, shaken, pressed)
    worst = rows.max(axis=1)
    told = [1.0 / film.thickness.value, film.flash_k.value, wear.depth_mm[0].value, wear.depth_mm[1].value]
    assert told == pytest.approx(worst[:4], rel=3e-3)
    assert np.all(np.array(told) >= (1.0 - 2e-3) * worst[:4])
    thinnest = rows[0].argmax()
    assert touching.phi1_rad[thinnest] == pytest.approx(film.thickness.phi1_rad, abs=1e-3)
    assert touching.driving_flank[thinnest] // 2 + 1 == film.thickness.driving_tooth
    assert wear.play_mm <= wear.depth_mm[0].value + wear.depth_mm[1].value + 1e-12


@pytest.mark.slow
def test_circular_gears_have_the_film_and_the_heat_of_their_involutes() -> None:
    """By hand at every contact: of the loads only the forces are taken, the rest follows from involutes.

    A place at the radius R has the radius of curvature sqrt(R^2 - r_b^2), and is passed at that times the speed.
    """
    text = TEXT.replace("law: ellipse, eccentricity: 0.3", "law: uniform_crank")
    made = drive_of_text(f"{text}strength: {{dynamic_factor: 1.0}}\n")
    found, loading = made.surfaces_by("estimate"), made.loading_by("estimate")
    film = found.film
    assert film is not None
    # First the places of the table, then so many that they have the extremes
    dense = loading.between(np.linspace(0.0, loading.cycle_mm, 20_001))
    count = film.film_um.size
    touching = LoadedContacts.joined([film.contacts, dense.kept(dense.flanks)])
    base = 30.0 * np.cos(np.radians(20.0))
    points = touching.driving_point, touching.driven_point
    first, second = (np.sqrt(np.abs(point) ** 2 - base**2) for point in points)
    speed, modulus = 2.0 * pi, 206000.0 / 0.91
    radius, turned = first * second / (first + second), speed * (first + second) / 1000.0
    load = touching.force_n * 1.3 / 12.0
    eta = 1e3 * float(Oil.of(made.conditions).dynamic_pa_s(40.0))
    mu = 0.060 * (load / (turned * radius)) ** 0.2 * eta**-0.05
    half = np.sqrt(8.0 * load * radius / (pi * modulus))
    contact = np.sqrt(45.0 * 440.0 * 7850.0) / 1000.0**0.5
    flash = 1.11 * mu * load * np.abs(np.sqrt(first) - np.sqrt(second)) * np.sqrt(speed / 1000.0)
    flash = flash / np.sqrt(2.0 * half) / contact * 1000.0
    assert film.flash_k.value == pytest.approx(flash.max(), rel=5e-3)
    warm = 40.0 + 0.47 * flash[count:].mean()
    assert film.bulk_c - 40.0 == pytest.approx(warm - 40.0, rel=5e-3)
    oil = Oil.of(made.conditions)
    cold, hot = (oil.thickening_per_pa(one) * 1e6 for one in (warm, warm + flash))
    eta_cold, eta_hot = (oil.dynamic_pa_s(one) for one in (warm, warm + flash))
    thin = 1.6 * radius * (cold * modulus) ** 0.6 * (eta_cold * turned / (2e3 * modulus * radius)) ** 0.7
    thin = 1e3 * thin * (load / (modulus * radius)) ** -0.13 * (hot * eta_hot / (cold * eta_cold)) ** 0.22
    assert film.thickness.value == pytest.approx(thin.min(), rel=5e-3)
    table = list(csv.DictReader(film_csv(film).splitlines()))
    # Ra is 1 um, and a tooth's place is its driving angle
    for name, wanted in (("film_um", thin), ("specific_film_thickness", thin), ("film_phi1_rad", touching.phi1_rad)):
        assert [float(row[name]) for row in table] == pytest.approx(wanted[:count].tolist(), rel=5e-3)
    # Both gears count against their turning, so that the same teeth meet in each turn
    assert len({(int(row["driving_tooth"]) - int(row["driven_tooth"])) % 30 for row in table}) == 1
    slid = load * np.abs(first - second) * np.clip((4.0 - thin / 1.77) / 3.5, 0.0, 1.0)
    turns = 20_000.0 * 3600.0
    for depth, rolled in zip(found.wear.depth_mm, (first, second), strict=True):
        assert depth.value == pytest.approx(1e-11 * turns * (slid / rolled).max(), rel=5e-3)


def test_flanks_of_the_larger_gear_meet_less_often() -> None:
    """And flanks of gears that turn to and fro, here by 90 degrees, once out and back."""
    running = Running(2.0, (24, 48), 10.0, 4.0 * pi)
    assert running.meetings(10.0) == pytest.approx([2.0 * 36_000.0, 36_000.0])
    swinging = replace(running, around=(60.0, 90.0), stroke_rad=pi)
    assert swinging.meetings(10.0) == pytest.approx([4.0 * 36_000.0, 4.0 * 36_000.0])


@pytest.mark.slow
def test_what_is_judged_depends_on_oil_and_material() -> None:
    plain, thick = drive_of_text(TEXT), with_strength("oil_viscosity_mm2_s: 680")
    film, thicker = (one.surfaces_by("estimate").film for one in (plain, thick))
    assert film is not None
    assert thicker is not None
    assert film.oil_c == 40.0
    assert film.thickness.value < 0.7 * thicker.thickness.value
    cold = with_strength("temperature_c: 20").surfaces_by("estimate").film
    assert cold is not None
    assert cold.thickness.value > 2.0 * film.thickness.value
    dry = with_strength("lubrication: dry").surfaces_by("estimate")
    assert (dry.film, dry.scuffing_safety) == (None, None)
    plastic = drive_of_text(TEXT.replace("backlash_mm", "material: {driving: C45, driven: POM}, backlash_mm"))
    surfaces = plastic.surfaces_by("estimate")
    assert surfaces.film is None
    assert surfaces.wear.depth_mm[0].value == 0.0 < surfaces.wear.depth_mm[1].value
    assert surfaces.warm[0] is None
    assert surfaces.warm[1] is not None
    hard = drive_of_text(TEXT.replace("backlash_mm", "material: 16MnCr5, backlash_mm")).surfaces_by("estimate").wear
    soft = plain.surfaces_by("estimate").wear
    assert hard.deepest_mm == pytest.approx(0.1 * soft.deepest_mm, rel=0.02)
    longer = with_strength("life_h: 40000").surfaces_by("estimate").wear
    assert (longer.deepest_mm, longer.life_h) == pytest.approx((2.0 * soft.deepest_mm, soft.life_h), rel=1e-9)


@pytest.mark.slow
def test_flanks_that_wear_or_scuff_are_told_and_a_thin_film_is_a_remark() -> None:
    held = list(flanks(drive("pusher")))
    assert [one.matters for one in held if isinstance(one, Advice)] == [False]
    dry = [one for one in flanks(with_strength("lubrication: dry")) if isinstance(one, Advice)]
    assert len(dry) == 1
    assert dry[0].matters
    assert "wear away" in dry[0].what
    broken = [
        one.what for one in flanks(with_strength("oil_fzg_stage: 1, temperature_c: 110")) if isinstance(one, Advice)
    ]
    assert any("scuff" in one for one in broken)
    helical = drive_of_text(
        TEXT.replace("backlash_mm", "helix: {angle_deg: 18, kind: helical, hand: left}, backlash_mm")
    )
    assert [one.matters for one in flanks(helical) if isinstance(one, Advice)] == [False]


@pytest.mark.slow
def test_creep_of_polyacetal_and_what_is_not_known_of_others() -> None:
    """A tooth of 24 bears for as many 24ths of its life as pairs bear in the mean; by hand from the data sheet."""
    text = """\
name: pom
linkage: {crank_mm: 40, rod_mm: 150}
operation: {speed_rpm: 60}
motion: {law: uniform_crank}
gears: {teeth: 24, module_mm: 2, face_width_mm: 20, material: POM}
resistance: {polynomial_n: [40], returning: {polynomial_n: [40]}}
"""
    made = drive_of_text(text)
    creep = made.surfaces_by("estimate").creep
    assert creep is not None
    pairs = made.loading_by("estimate").contact_ratio
    assert creep.loaded_h == pytest.approx(20000.0 * pairs / 24.0, rel=0.02)
    assert creep.after_mm / creep.at_once_mm == pytest.approx(1.14 * (2500.0 / 1300.0) ** (log10(creep.loaded_h) / 3.0))
    unknown = "not judged, because no creep modulus of PA66-dry is known here"
    for material, said in (
        ("POM", "teeth give way by"), ("PA66", "teeth give way by"), ("PA66-dry", unknown), ("42CrMo4", ""),
    ):  # fmt: skip
        other = drive_of_text(text.replace("POM", material))
        assert dict(surfaces_rows(other, other.surfaces_by("estimate"))).get("creep", "").startswith(said)
        assert (other.surfaces_by("estimate").creep is None) == (material not in {"POM", "PA66"})
