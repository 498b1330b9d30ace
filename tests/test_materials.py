"""The table of materials and what gears of them endure: published values of classes, factors and formulas."""

from __future__ import annotations

import re
from dataclasses import replace
from math import pi
from pathlib import Path

import numpy as np
import pytest

from at_once import at_once
from commands import ROOT
from ncgear.design.reading.design_file import load
from ncgear.errors import WrongInput
from ncgear.project.opened import loads
from ncgear.project.service import choices_of, conditions_of
from ncgear.strength.classes import (
    ALLOY,
    CARBON,
    CASE,
    CASE_HARD_CORE,
    GREY,
    INDUCTION,
    NITRIDED,
    NITRIDING,
    NODULAR,
    STRUCTURAL,
    LifePoint,
    Quality,
    StrengthClass,
)
from ncgear.strength.conditions import Conditions, Running, hours_of_strokes
from ncgear.strength.contacts import LoadedContacts
from ncgear.strength.endurance import (
    contact_size_factor,
    hardening_factor,
    limit_contact_mpa,
    materials_of,
    reliability_factor,
    root_roughness_factor,
    root_size_factor,
)
from ncgear.strength.material import EnduredStress, Material, MaterialFamily
from ncgear.strength.materials import ASSUMED, ROWS, TABLE, Choice, Ferrous, Plastic, assumed_choice
from ncgear.strength.plastics import creep_factor, flank_limit_mpa, friction, lost_w, root_limit_mpa, temperatures_of

RUNNING = Running(3.0, (25, 25), 20.0, 2.1)


def pair(
    first: Choice, second: Choice | None = None, given: Conditions | None = None, at: Running = RUNNING
) -> Material:
    """What the first gear endures beside the second, or another like itself."""
    conditions, both = given or Conditions(), (first, second or first)
    return materials_of(both, conditions, at, temperatures_of(both, conditions, at))[0]


def of(name: str, **own: float) -> Choice:
    return Choice(TABLE[name], **own)


def contact(material: Material) -> EnduredStress:
    assert material.contact is not None
    return material.contact


PUBLISHED = [
    (CASE, 720.0, Quality.MQ, 1500.0, 425.0),
    (CASE_HARD_CORE, 720.0, Quality.MQ, 1500.0, 500.0),
    (CASE_HARD_CORE, 720.0, Quality.ME, 1650.0, 525.0),
    (CASE, 720.0, Quality.ML, 1300.0, 312.0),
    (NITRIDING, 700.0, Quality.MQ, 1250.0, 420.0),
    (NITRIDED, 550.0, Quality.MQ, 998.0, 363.0),
    (INDUCTION, 550.0, Quality.MQ, 1179.55, 365.9),
    (INDUCTION, 600.0, Quality.MQ, 1206.6, 368.66),
    (ALLOY, 300.0, Quality.MQ, 766.9, 314.5),
    (ALLOY, 390.0, Quality.ME, 1123.07, 370.62),
    (CARBON, 200.0, Quality.MQ, 545.0, 211.0),
    (STRUCTURAL, 150.0, Quality.MQ, 340.0, 137.25),
    (NODULAR, 250.0, Quality.ML, 569.5, 206.5),
    (GREY, 200.0, Quality.MQ, 338.6, 59.2),
]
"""ISO 6336-5:2016, table 1 (secondary source): class, hardness, quality, sigma_Hlim, sigma_Flim."""


@pytest.mark.judges("strength")
@at_once(("group", "hardness", "quality", "contact_mpa", "bending_mpa"), PUBLISHED)
def test_published_stresses_of_the_classes(
    group: StrengthClass, hardness: float, quality: Quality, contact_mpa: float, bending_mpa: float
) -> None:
    assert group.contact[quality].at(hardness) == pytest.approx(contact_mpa, rel=1e-12)
    assert group.bending[quality].at(hardness) == pytest.approx(bending_mpa, rel=1e-12)


@at_once("group", {id(row.group): row.group for row in ROWS if isinstance(row, Ferrous)}.values())
def test_better_quality_is_never_weaker(group: StrengthClass) -> None:
    for hardness in np.linspace(*group.hardnesses, 5):
        for lines in (group.contact, group.bending):
            rising = [lines[quality].at(float(hardness)) for quality in Quality]
            # ME of soft alloy steel begins a little below where MQ ends; see the table.
            assert rising == sorted(rising)


def life_factor(points: tuple[LifePoint, ...], cycles: float) -> float:
    curve = EnduredStress(np.array([p.cycles for p in points]), np.array([p.factor for p in points]))
    return float(curve.at(np.array(cycles)))


@pytest.mark.judges("strength")
def test_life_factors_of_iso_tr_6336_30() -> None:
    """Example 1: 0.91 for 1.08e9 cycles of the pinion, 0.962 for 1.783e8 of the wheel."""
    assert life_factor(CASE.contact_life, 1.08e9) == pytest.approx(0.910, abs=0.0005)
    assert life_factor(CASE.contact_life, 1.783e8) == pytest.approx(0.962, abs=0.0005)


@at_once(
    ("group", "contact_static", "bending_static", "from_cycles"),
    [(CASE, 1.6, 2.5, 1e3), (ALLOY, 1.6, 2.5, 1e4), (NITRIDING, 1.3, 1.6, 1e3), (GREY, 1.3, 1.6, 1e3)],
)
def test_static_life_factors(
    group: StrengthClass, contact_static: float, bending_static: float, from_cycles: float
) -> None:
    """Table 2 of ISO 6336-2 and table 1 of ISO 6336-3, and DIN 3990-11 (secondary sources)."""
    assert group.contact_life[0] == (1e5, contact_static)
    assert group.bending_life[0] == (from_cycles, bending_static)
    assert life_factor(group.bending_life, 3e6) == life_factor(group.contact_life, group.contact_life[1].cycles) == 1.0
    assert life_factor(group.bending_life, 1e10) == pytest.approx(0.85)


TR_30 = Running(8.0, (17, 103), 100.0, 360.0 * pi / 30.0)
"""Example 1 of ISO/TR 6336-30: module 8, 17 and 103 teeth, width 100 mm, 360 r/min; here without its helix."""


@pytest.mark.judges("strength")
def test_permissible_stresses_of_iso_tr_6336_30() -> None:
    """1338.48 and 1414.53 MPa for 50 000 h; its pinion has a helix of 15.8 degrees, which v and Z_R feel a little."""
    given = Conditions(oil_viscosity_mm2_s=320.0, flank_roughness_um=6.0, life_h=50_000.0)
    endured = contact(pair(Choice(replace(TABLE["18CrNiMo7-6"], hardness=720.0)), given=given, at=TR_30))
    assert endured.at(np.array([1.08e9, 1.783e8])) == pytest.approx([1338.48, 1414.53], rel=0.006)


def test_root_stress_of_case_hardened_steel() -> None:
    """sigma_FE = 1000 MPa for MQ; at roughness 10 um and a small module nothing is left of it but life."""
    endured = pair(of("18CrNiMo7-6"), given=Conditions(root_roughness_um=10.0)).bending
    assert endured.at(np.array([1e2, 3e6, 1e10])) == pytest.approx([2500.0, 1000.0, 850.0], rel=0.002)


def test_factors_of_surface_and_size() -> None:
    """ISO 6336-3, table 5, and ISO 6336-2 (secondary sources)."""
    assert [root_size_factor(ALLOY, m) for m in (5.0, 10.0, 40.0)] == pytest.approx([1.0, 0.97, 0.85])
    assert [root_size_factor(CASE, m) for m in (5.0, 16.0, 40.0)] == pytest.approx([1.0, 0.89, 0.8])
    assert [root_size_factor(GREY, m) for m in (5.0, 15.0, 40.0)] == pytest.approx([1.0, 0.85, 0.7])
    assert [contact_size_factor(CASE, m) for m in (10.0, 20.0, 40.0)] == pytest.approx([1.0, 0.95, 0.9])
    assert [contact_size_factor(NITRIDING, m) for m in (7.5, 20.0, 40.0)] == pytest.approx([0.9975, 0.86, 0.75])
    for group in (CASE, ALLOY, STRUCTURAL, GREY):
        rough = [root_roughness_factor(group, um) for um in (1.0, 10.0, 40.0)]
        assert rough[1] == pytest.approx(1.0, abs=0.006)
        assert rough[0] > rough[1] > rough[2] > 0.85


def test_a_hard_smooth_mate_hardens_a_soft_flank() -> None:
    smooth = Conditions(flank_roughness_um=3.0)
    soft, hard = TABLE["42CrMo4"], TABLE["16MnCr5"]
    assert hardening_factor(soft, hard, smooth) == pytest.approx(1.2 - 170.0 / 1700.0)
    assert hardening_factor(hard, soft, smooth) == hardening_factor(soft, soft, smooth) == 1.0
    assert hardening_factor(soft, hard, Conditions(flank_roughness_um=12.0)) == 1.0


def test_reliability() -> None:
    """The table of AGMA 2101 (secondary source); it divides both stresses."""
    shares = (0.5, 0.9, 0.99, 0.999, 0.9999)
    assert [reliability_factor(share) for share in shares] == pytest.approx([0.7, 0.85, 1.0, 1.25, 1.5])
    usual, surer = (pair(of("C45"), given=Conditions(reliability=share)) for share in (0.99, 0.999))
    assert surer.bending.stress_mpa == pytest.approx(usual.bending.stress_mpa / 1.25, rel=1e-12)
    assert contact(surer).stress_mpa == pytest.approx(contact(usual).stress_mpa / 1.25, rel=1e-12)


@at_once("name", TABLE)
@at_once("lubrication", ["oil", "grease", "dry"])
def test_every_material_has_a_curve_that_never_rises(name: str, lubrication: str) -> None:
    found = pair(of(name), given=Conditions(lubrication=lubrication))  # type: ignore[arg-type]
    for curve in (found.bending, found.contact):
        if curve is not None:
            assert np.all(np.diff(curve.cycles) > 0.0)
            assert np.all(np.diff(curve.stress_mpa) <= 0.0)
            assert np.all(curve.stress_mpa > 0.0)
    assert found.source
    if found.family is not MaterialFamily.PLASTIC:
        assert (found.contact is None) == (lubrication == "dry")


def test_own_values_stand_in_place_of_the_tables() -> None:
    own = pair(
        of("42CrMo4", contact_limit_mpa=900.0, bending_limit_mpa=700.0), given=Conditions(root_roughness_um=10.0)
    )
    table = pair(of("42CrMo4"), given=Conditions(root_roughness_um=10.0))
    assert own.bending.at(np.array(3e6)) == pytest.approx(700.0, rel=0.002)
    # Films matter less to a harder flank, so that the whole gain is a little over 900 / 766.9.
    gain = contact(own).at(np.array(5e7)) / contact(table).at(np.array(5e7))
    assert 900.0 / 766.9 < gain < 1.03 * 900.0 / 766.9
    assert "own stresses" in own.source
    assert "own" not in table.source
    plastic = pair(of("POM", contact_limit_mpa=50.0, bending_limit_mpa=30.0))
    assert contact(plastic).at(np.array([1e4, 1e8])) == pytest.approx([50.0, 50.0])
    assert plastic.bending.at(np.array([1e4, 1e8])) == pytest.approx([30.0, 30.0])


def test_what_is_assumed_says_so() -> None:
    assert pair(assumed_choice()).source.startswith(f"assumed: {ASSUMED}, ")


@pytest.mark.judges("strength")
def test_formulas_of_the_guideline_for_plastics() -> None:
    """Worked by hand from the formulas at 20 and 60 degrees C for 1e6 and 1e8 cycles."""
    cycles = np.array([1e6, 1e8])
    assert root_limit_mpa("POM", 20.0, cycles) == pytest.approx([2 * (25.0 + 25.2383), 2 * (25.0 + 10.0475)], rel=1e-4)
    assert root_limit_mpa("POM", 60.0, cycles) == pytest.approx([2 * (17.0 + 25.2383), 2 * (17.0 + 10.0475)], rel=1e-4)
    # 20^0.3 = 2.45649, so 4600 - 900 * 2.45649 = 2389.16; a hundredth and a 464.16th of it.
    assert root_limit_mpa("PA66", 20.0, cycles) == pytest.approx([2 * (25.6 + 23.8916), 2 * (25.6 + 5.1473)], rel=1e-4)
    # 1e6^-0.21 = 0.0549541, 1e8^-0.21 = 0.0208930
    assert flank_limit_mpa(60.0, cycles) == pytest.approx([31.68 + 910 * 0.0549541, 31.68 + 910 * 0.020893], rel=1e-5)


def test_heat_weakens_plastics() -> None:
    cold, warm = (pair(of("POM"), given=Conditions(temperature_c=t)) for t in (20.0, 80.0))
    assert np.all(warm.bending.stress_mpa < cold.bending.stress_mpa)
    assert np.all(contact(warm).stress_mpa < contact(cold).stress_mpa)
    for printed in ("PLA-print", "PETG-print"):
        prints = [pair(of(printed), given=Conditions(temperature_c=t)) for t in (20.0, 45.0)]
        assert np.all(prints[1].bending.stress_mpa < prints[0].bending.stress_mpa)
        assert prints[0].contact is None
        assert "rough" in prints[0].source


def test_plastics_hotter_than_their_figures_endure_nothing_and_say_so() -> None:
    """Polyacetal melts at 175 degrees Celsius and has figures to 120; own limits are a person's word."""
    hot, warm = (pair(of("POM"), given=Conditions(temperature_c=t)) for t in (121.0, 119.0))
    assert (hot.too_hot_c, warm.too_hot_c) == (121.0, None)
    assert contact(hot).stress_mpa.max() < 0.1001 < 1.0 < contact(warm).stress_mpa.min()
    assert hot.bending.stress_mpa.max() < 0.1001
    own = pair(replace(of("POM"), bending_limit_mpa=20.0), given=Conditions(temperature_c=121.0))
    assert own.bending.stress_mpa.min() == pytest.approx(20.0)


def test_temperature_of_teeth() -> None:
    """By hand: 20 teeth, 10 mm, module 1, 2 m/s, 5 W lost in grease: 5 * 6300 / (200 * 2^0.75) = 93.65 K at flanks."""
    running = Running(1.0, (20, 40), 10.0, 200.0)
    greased = Conditions(lubrication="grease")
    plastic, steel = of("POM"), of("C45")
    first, second = temperatures_of((plastic, steel), greased, running, 5.0)
    assert (first.flank_c, first.root_c) == pytest.approx((113.65, 33.30), abs=0.02)
    assert second.flank_c == pytest.approx(20.0 + 93.65 / 2.0, abs=0.02)
    assert not first.too_hot
    both, _ = temperatures_of((plastic, plastic), greased, running, 5.0)
    assert both.flank_c == pytest.approx(20.0 + 93.65 * 9.0 / 6.3, abs=0.02)
    assert both.too_hot
    # A tenth of the time: 0.1^0.64 = 0.229087, so 21.45 K at flanks and 3.05 at roots.
    paused, _ = temperatures_of((plastic, steel), replace(greased, duty_cycle=0.1), running, 5.0)
    assert (paused.flank_c, paused.root_c) == pytest.approx((41.45, 23.05), abs=0.02)
    for cool in (
        temperatures_of((plastic, steel), Conditions(), running, 5.0),
        temperatures_of((steel, steel), greased, running, 5.0),
    ):
        assert [(one.root_c, one.flank_c) for one in cool] == [(20.0, 20.0)] * 2


def test_creep_is_that_of_the_data_sheet() -> None:
    """2850 MPa at once, 2500 after an hour, 1300 after a thousand; on a straight line of logarithms between."""
    assert creep_factor("POM", 1.0) == pytest.approx(2850.0 / 2500.0)
    assert creep_factor("POM", 1000.0) == pytest.approx(2850.0 / 1300.0)
    middle = creep_factor("POM", 1000.0**0.5)
    assert middle == pytest.approx((2850.0 / 2500.0 * 2850.0 / 1300.0) ** 0.5)
    assert creep_factor("POM", 1e-4) == 1.0
    assert creep_factor("PA66", 1.0) == pytest.approx(1400.0 / 1190.0)
    assert creep_factor("PA66", 1000.0) == pytest.approx(1400.0 / 540.0)
    for name in ("PA66-dry", "PA66-GF30", "PLA-print", "PETG-print"):
        assert creep_factor(name, 10.0) is None


def test_power_that_friction_takes() -> None:
    """Two contacts of 1000 N that slide at 50 mm/s in one of four positions, coefficient 0.2: 2 * 10 W / 4."""
    nowhere, flank = np.zeros(2, dtype=complex), np.zeros(2, dtype=int)
    contacts = LoadedContacts(
        position=np.array([2, 2]),
        phi1_rad=np.zeros(2),
        side=flank,
        force_n=np.array([1000.0, 1000.0]),
        stiffness_n_mm=np.full(2, 1e5),
        relative_curvature=np.ones(2),
        flanks=np.ones(2, dtype=bool),
        rolling_mm_s=np.array([[80.0, 30.0], [-20.0, 30.0]]),
        driving_flank=flank,
        driving_point=nowhere,
        driving_inwards=nowhere,
        driven_flank=flank,
        driven_point=nowhere,
        driven_inwards=nowhere,
        section=flank,
        share=np.ones(2),
    )
    assert lost_w(contacts, 4, 0.2) == pytest.approx(5.0, rel=1e-14)


def test_friction_of_plastics() -> None:
    pom, nylon, steel = of("POM"), of("PA66-dry"), of("C45")
    assert [friction(both, "dry") for both in ((pom, steel), (pom, pom), (nylon, pom), (nylon, nylon))] == [
        0.2,
        0.28,
        0.18,
        0.4,
    ]
    assert friction((pom, pom), "oil") < friction((pom, pom), "grease") < 0.1


def test_a_plastic_has_no_single_limit() -> None:
    with pytest.raises(WrongInput, match="POM has no single limit"):
        limit_contact_mpa(of("POM"))


def test_steel_beside_plastic_is_limited_by_itself_alone() -> None:
    """No film between plastic and steel is counted, and no hardening."""
    beside = contact(pair(of("42CrMo4"), of("POM")))
    assert beside.at(np.array(5e7)) == pytest.approx(766.9, rel=1e-12)


def test_strokes_and_hours() -> None:
    """A stroke a second for 3600 strokes is an hour; two turns of the driving gear for each take twice as long."""
    assert hours_of_strokes(3600.0, 2.0 * pi, 2.0 * pi) == pytest.approx(1.0)
    assert hours_of_strokes(3600.0, 4.0 * pi, 2.0 * pi) == pytest.approx(2.0)


HEAD = """name: a
linkage: {crank_mm: 100, rod_mm: 300}
operation: {speed_rpm: 60}
motion: {law: uniform_crank}
gears: {teeth: 20, module_mm: 2, face_width_mm: 9, material: MATERIAL}
"""


def chosen(folder: Path, material: str) -> tuple[Choice, Choice]:
    path = folder / "d.yaml"
    path.write_text(HEAD.replace("MATERIAL", material), encoding="utf-8")
    gears = load(path).design.gears
    assert gears is not None
    return choices_of(gears)


def test_materials_as_people_write_them(tmp_path: Path) -> None:
    both = chosen(tmp_path, "16MnCr5")
    assert both == (of("16MnCr5"), of("16MnCr5"))
    assert chosen(tmp_path, "{driving: C45, driven: POM}") == (of("C45"), of("POM"))
    assert chosen(tmp_path, "{driving: C45}") == (of("C45"), of("C45"))
    driving, driven = chosen(tmp_path, "{name: 42CrMo4, quality: ME, hardness: 350, bending_limit_mpa: 800}")
    assert driving == driven
    assert driving.bending_limit_mpa == 800.0
    assert limit_contact_mpa(driving) == pytest.approx(2.213 * 350.0 + 260.0)
    (plastic, _) = chosen(tmp_path, "{name: POM, youngs_modulus_gpa: 3.1, density_kg_m3: 1500}")
    assert isinstance(plastic.entry, Plastic)
    assert (plastic.entry.elastic.youngs_modulus_mpa, plastic.entry.elastic.density_kg_m3) == (3100.0, 1500.0)
    assert chosen(tmp_path, "null") == (assumed_choice(), assumed_choice())


@pytest.mark.parametrize(
    ("material", "said"),
    [
        ("16MnCr", "gears.material: 16MnCr is no material of the table; did you mean 16MnCr5?"),
        ("PLA", "gears.material: PLA is no material of the table; did you mean PLA-print?"),
        ("{driving: C45, driven: XYZ}", "gears.material.driven: XYZ is no material of the table; known are S235, "),
        ("{name: C45, hardness: 400}", "hardness: 400 given, but C45 (carbon steel, normalized) has 135 to 210 HV"),
        ("{name: POM, hardness: 80}", "hardness: given, but the strength of POM does not follow from it"),
        ("{name: POM, quality: ME}", "quality: given, but POM has no grades"),
        ("7", "7 given; a group of keys is needed"),
    ],
)
def test_a_wrong_material_is_refused_where_it_stands(tmp_path: Path, material: str, said: str) -> None:
    with pytest.raises(WrongInput) as caught:
        chosen(tmp_path, material)
    assert said in str(caught.value)
    assert "d.yaml:5:" in str(caught.value)
    assert "\n" not in str(caught.value)


def test_what_the_page_of_materials_shows_can_be_written(tmp_path: Path) -> None:
    page = (ROOT / "docs" / "materials.md").read_text(encoding="utf-8")
    shown = re.findall(r"`material: ([^`]+)`", page)
    assert len(shown) == 4
    for material in shown:
        chosen(tmp_path, material)


def test_conditions_left_out_and_life_in_strokes(tmp_path: Path) -> None:
    path = tmp_path / "d.yaml"
    path.write_text(HEAD.replace("MATERIAL", "C45"), encoding="utf-8")
    assert conditions_of(load(path).design.strength, 2.0 * pi, 2.0 * pi) == Conditions()
    path.write_text(HEAD.replace("MATERIAL", "C45") + "strength: {life_strokes: 7.2e6}\n", encoding="utf-8")
    assert conditions_of(load(path).design.strength, 2.0 * pi, 2.0 * pi).life_h == pytest.approx(2000.0)
    path.write_text(HEAD.replace("MATERIAL", "C45") + "strength: {life_strokes: 1, life_h: 2}\n", encoding="utf-8")
    with pytest.raises(WrongInput, match=r"d\.yaml:6:.*strength\.life_strokes: life_h and life_strokes are given"):
        load(path)
    wanted = Conditions()
    metal, plastic = pair(of("C45")), pair(of("POM"))
    assert [wanted.wanted_bending_safety(one) for one in (metal, plastic)] == [1.4, 2.0]
    assert [wanted.wanted_contact_safety(one) for one in (metal, plastic)] == [1.0, 1.4]
    asked = Conditions(contact_safety=1.2, bending_safety=1.7)
    assert (asked.wanted_contact_safety(plastic), asked.wanted_bending_safety(metal)) == (1.2, 1.7)


@pytest.mark.thorough
def test_density_of_the_gears_is_that_of_their_materials() -> None:
    """Inertias of a plastic and a steel gear are as their densities; a density that is given stands for both."""
    masses = "masses: {slider_kg: 1, rod: {mass_kg: 0, center_mm: 0, inertia_kg_mm2: 0}, crank: CRANK}\n"
    text = HEAD + masses.replace("CRANK", "{mass_kg: 0, center_mm: 0, inertia_kg_mm2: 0}")
    steel, mixed = (
        loads(text.replace("MATERIAL", name)).masses for name in ("null", "{driving: POM, driven: 42CrMo4}")
    )
    assert mixed.driving_inertia_kg_mm2 == pytest.approx(steel.driving_inertia_kg_mm2 * 1410.0 / 7850.0, rel=1e-12)
    assert mixed.driven_inertia_kg_mm2 == steel.driven_inertia_kg_mm2
    given = loads(text.replace("MATERIAL", "POM").replace("{slider_kg", "{density_kg_m3: 7850, slider_kg")).masses
    assert given.driving_inertia_kg_mm2 == steel.driving_inertia_kg_mm2
