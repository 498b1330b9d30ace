"""The strength without teeth, which a check tells: against ISO 6336, finite elements and the estimate with teeth."""

from __future__ import annotations

from math import pi, radians

import numpy as np
import pytest

from circular_pairs import (
    CylindricalPair,
    contact_ratio_factor,
    elasticity_factor,
    nominal_contact_stress_mpa,
    single_contact_diameter,
    single_contact_factors,
)
from commands import ROOT, Run, on_text
from drives import drive, drive_of_text
from ncgear.figures.advice import strength_advice
from ncgear.figures.advice.strength_advice import _under
from ncgear.figures.advice.values import Advice, NotJudged
from ncgear.figures.advice.verdict import Verdict
from ncgear.figures.answers.machine import build_answer
from ncgear.pitch.shape import Gear
from ncgear.project.drive import Drive
from ncgear.project.rough_strength import (
    RINGS_HOLD,
    RoughStrength,
    _walls_mm,
    rolled_load,
    rough_strength,
    tooth_plan,
)
from ncgear.project.strengthening import rating_of
from ncgear.strength.conditions import Running, face_load_factor_of_roots
from ncgear.strength.holding import Damage, lives_of
from ncgear.strength.iso6336 import RackTip, root_factors, root_section
from ncgear.strength.without_teeth import RoughSafety, shared_loads

TEXT = """\
name: press
linkage: {crank_mm: 38, rod_mm: 96}
operation: {speed_rpm: 60}
motion: {law: uniform_crank}
gears: {teeth: 40, module_mm: 2, face_width_mm: 12}
resistance: {polynomial_n: [1500]}
strength: {dynamic_factor: 1.0}
"""

ELLIPSE = TEXT.replace("law: uniform_crank", "law: ellipse, eccentricity: 0.3")
HELICAL = ELLIPSE.replace("12}", "12, helix: {angle_deg: 18, kind: herringbone, hand: left}}")
DRY = TEXT.replace("1500", "80").replace("dynamic_factor: 1.0", "dynamic_factor: 1.0, lubrication: dry")


def least(found: RoughStrength | None, damage: Damage) -> RoughSafety:
    assert found is not None
    return min((one for one in found.safeties if one.damage is damage), key=lambda one: one.safety)


def line_load_n_mm(text: str) -> float:
    """The largest tooth force of circular gears for each mm of width: from the crank's torque on a fine grid."""
    force = float(text.partition("polynomial_n: [")[2].partition("]")[0])
    crank = np.linspace(0.0, pi, 20001)
    slide = 38.0 * np.cos(crank) + np.sqrt(96.0**2 - (38.0 * np.sin(crank)) ** 2)
    return force * float(np.abs(np.gradient(slide, crank)).max()) / 40.0 / 12.0


@pytest.mark.judges("strength")
def test_the_pressure_of_circular_gears_is_that_of_iso_6336_2() -> None:
    """sigma_H0 without Z_epsilon, times the root of K_Hbeta, and up to Z_B times that, where a pair begins to bear
    all of the load alone."""
    pair = CylindricalPair(2.0, (40, 40), 12.0)
    tangential = 12.0 * line_load_n_mm(TEXT)
    nominal = nominal_contact_stress_mpa(pair, tangential, elasticity_factor(206e3, 0.3), 1.0)
    pitch_point = nominal / contact_ratio_factor(pair) * 1.3**0.5
    found = least(rough_strength(drive_of_text(TEXT)), Damage.CONTACT)
    assert 0.998 * pitch_point <= found.stress_mpa <= 1.001 * single_contact_factors(pair)[0] * pitch_point


@pytest.mark.judges("strength")
def test_the_root_stress_of_circular_gears_is_that_of_iso_6336_3() -> None:
    """F_t / (b m) Y_F Y_S at the outer point of single contact: method B, under a load that hardly bends the teeth."""
    text, angle = TEXT.replace("1500", "15"), radians(20.0)
    ratio = CylindricalPair(2.0, (40, 40), 12.0).transverse_contact_ratio
    outer = single_contact_diameter(40.0, 42.0, ratio, angle)
    factors = root_factors(root_section(40.0, 0.0, RackTip(1.25, 0.38), angle), 40.0, 0.0, outer, angle)
    roots = face_load_factor_of_roots(Running(2.0, (40, 40), 12.0, 2.0 * pi), np.array(1.3))
    nominal = roots * line_load_n_mm(text) / 2.0
    found = least(rough_strength(drive_of_text(text)), Damage.BENDING)
    assert found.stress_mpa == pytest.approx(nominal * factors.form * factors.notch, rel=0.02)


def random_text(seed: int) -> str:
    """A machine of module 1 to 6 and 20 to 120 teeth, whose load leaves a safety of 0.4 to 4."""
    of = np.random.default_rng(seed)
    module, teeth, width = of.choice([1.0, 1.25, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0]), of.integers(20, 121), 8.0
    crank = of.uniform(0.3, 0.9) * module * teeth / 2.0
    linkage = (
        f"{{crank_mm: {crank:.4g}, rod_mm: {of.uniform(1.8, 4.0) * crank:.4g}}}",
        f"{{kind: scotch_yoke, crank_mm: {crank:.4g}}}",
    )[of.integers(2)]
    motion = (
        "{law: uniform_crank}",
        f"{{law: ellipse, eccentricity: {of.uniform(0.05, 0.45):.3g}}}",
        f"{{law: harmonic_ratio, cosine: [{of.uniform(-0.3, 0.3):.3g}, {of.uniform(-0.1, 0.1):.3g}]}}",
        f"{{law: ratio_expression, ratio: '2 + {of.uniform(0.1, 0.8):.3g}*sin(phi)', scale_to_close: true}}",
    )[of.integers(4)]
    material, endured = (("16MnCr5", 850.0), ("C45", 417.0), ("42CrMo4", 629.0), ("POM", 60.0))[of.integers(4)]
    force = endured / 10 ** of.uniform(-0.4, 0.6) / 3.8 * width * module**3 * teeth / 2.0 / crank
    return f"""
linkage: {linkage}
operation: {{speed_rpm: {of.integers(5, 80)}}}
motion: {motion}
gears: {{teeth: {teeth}, module_mm: {module}, face_width_mm: {width * module}, material: {material}}}
resistance: {{polynomial_n: [{force * of.uniform(0.1, 1.0):.4g}, {force / 2.0 / crank:.4g}]}}
strength: {{lubrication: {("oil", "grease")[of.integers(2)]}}}
name: seed-{seed}
"""


RANDOM = range(30)

LOADED = ["baler-66", "baler-86", "baler-drivetrain", "baler-half-dynamics", "baler-half", "baler-holds", "baler-real"]
LOADED += [
    "baler-flywheel",
    "baler-smooth",
    "baler-dynamics",
    "baler",
    "printed-pump",
    "pump-1-2",
    "pump-both-ways",
    "pusher",
]
LOADED += ["quick-return-shaper", "rocker-drive", "scotch-yoke-pump", "uniform-crank", "baler-66-two-stage"]
"""Every design whose strength is computed."""


def ratios(made: Drive) -> dict[Damage | None, float]:
    """Rough over known least safety, by damage, and by None that of the least share of the wanted safeties."""
    rough, known = rough_strength(made), rating_of(made, "estimate").weakest
    assert rough is not None
    assert not rough.unjudged
    if rough.needs_teeth:
        return {}
    shares = min(one.safety / one.wanted for one in rough.safeties) / min(one.share for one in known)
    each = {one.damage: min(other.safety for other in known if other.damage is one.damage) for one in known}
    return {None: shares, **{damage: least(rough, damage).safety / safety for damage, safety in each.items()}}


def within(found: dict[Damage | None, float]) -> bool:
    return all(0.8 <= ratio <= 1.1 for ratio in found.values())


@pytest.mark.tiers(long=["baler-half*", "baler-real", "baler-66*", "baler-8*", "baler-s*"], rest="slow")
@pytest.mark.judges("strength")
@pytest.mark.parametrize("name", LOADED)
def test_a_design_beside_the_estimate_with_teeth(name: str) -> None:
    """Within 0.8 to 1.1, but of the published baler, whose curvature leaps within a tooth.

    Knocks that go on and on are known by their size, not one by one: there it is 0.6 to 1.25.
    """
    for pair in drive(name).by_stage:
        found = ratios(pair)
        knocks = pair.loading_by("estimate").knocks
        assert within(found) or (knocks and all(0.6 <= ratio <= 1.25 for ratio in found.values())), found
        assert bool(found) is (name not in {"baler", "baler-dynamics"})


@pytest.mark.long
@pytest.mark.slow
@pytest.mark.judges("strength")
def test_random_machines_beside_the_estimate_with_teeth() -> None:
    found = {seed: ratios(drive_of_text(random_text(seed))) for seed in RANDOM}
    assert {seed: one for seed, one in found.items() if not within(one)} == {}
    assert sum(not one for one in found.values()) <= len(RANDOM) // 6


def knocking_text(seed: int) -> str:
    """The carton pusher with masses, at 20 to 60 r/min, against a force that steps up or down, or reverses."""
    of, text = np.random.default_rng(seed), (ROOT / "designs" / "pusher.yaml").read_text().partition("resistance:")[0]
    force, at, wide = of.uniform(100, 500), of.uniform(20, 90), of.uniform(0.02, 5)
    first, last = ((10, force), (force, 10), (force, -0.6 * force))[seed % 3]
    text = text.replace("backlash_mm: 0.05", f"backlash_mm: {of.choice([0.02, 0.05, 0.1, 0.2])}")
    return f"""{text.replace("speed_rpm: 30", f"speed_rpm: {of.uniform(18, 66):.4g}", 1)}
resistance:
  table: {{displacement_mm: [0, {at:.4g}, {at + wide:.4g}, 120], force_n: [{first}, {first}, {last}, {last}]}}
  where_negative: keep
masses:
  slider_kg: {of.choice([0.5, 2.0, 5.0, 12.0])}
  rod: {{mass_kg: 0.8, center_mm: 100, inertia_kg_mm2: 4000}}
  crank: {{mass_kg: 0.5, center_mm: 25, inertia_kg_mm2: 1000}}
"""


@pytest.mark.slow
@pytest.mark.judges("strength")
def test_machines_that_knock_at_steps_are_on_the_safe_side() -> None:
    """Knocks shorter than the way between two positions were missed: breakage of such a machine had 1.95 times."""
    found = {seed: ratios(drive_of_text(knocking_text(seed))) for seed in range(9)}
    assert all(0.6 <= min(one.values()) <= max(one.values()) <= 1.15 for one in found.values()), found
    assert sum(bool(one) for one in found.values()) >= 8


@pytest.mark.slow
@pytest.mark.judges("strength")
@pytest.mark.parametrize(
    "gears",
    [
        "teeth: 70, module_mm: 2, face_width_mm: 12, rack: {tip_relief: {amount: 0.025}}",
        "teeth: 26, module_mm: 2, face_width_mm: 12, rack: {pressure_angle_deg: 24, profile: C}",
        "teeth: 26, module_mm: 2, face_width_mm: 12, rack: {addendum: 1.15, dedendum: 1.4}",
        "teeth: 26, module_mm: 2, face_width_mm: 12, profile_shift: {driving: 0.35}",
        "teeth: 23, module_mm: 2, face_width_mm: 12, profile_shift: {driving: -0.1}",
    ],
)
def test_other_teeth_beside_the_estimate_with_teeth(gears: str) -> None:
    """Each gear by itself: a shift makes the teeth of one stronger and those of the other weaker."""
    made = drive_of_text(ELLIPSE.replace("teeth: 40, module_mm: 2, face_width_mm: 12", gears))
    rough, known = rough_strength(made), rating_of(made, "estimate").weakest
    assert rough is not None
    assert not rough.needs_teeth
    for one, other in zip(rough.safeties, known, strict=True):
        assert (one.gear, one.damage) == (other.gear, other.damage)
        assert 0.8 <= one.safety / other.safety <= 1.1


@pytest.mark.slow
@pytest.mark.judges("strength")
@pytest.mark.parametrize("torque", ["[1500]", "[-1500], where_negative: keep"], ids=["pushing", "backs"])
def test_each_pair_bears_what_the_teeth_do(torque: str) -> None:
    """At every position of the stroke that both look at, a quarter of a pitch apart: the two largest forces."""
    made = drive_of_text(ELLIPSE.replace("teeth: 40", "teeth: 28").replace("[1500]", torque))
    loading, load, plan = rating_of(made).loading, rolled_load(made), tooth_plan(made)
    contacts, compared = loading.contacts, 0
    for one in shared_loads(load, plan, made.running, made.materials):
        for column, phi1 in enumerate(one.load.phi1_rad):
            same = np.isclose(contacts.phi1_rad, phi1, rtol=0.0, atol=1e-9)
            if same.any():
                exact = np.sort([*contacts.force_n[same], 0.0])[-2:]
                found = 12.0 * np.sort(one.line_n_mm[:, column])[-2:]
                assert found == pytest.approx(exact, abs=0.06 * contacts.force_n.max())
                compared += 1
    assert compared >= 50


@pytest.mark.slow
@pytest.mark.judges("strength")
@pytest.mark.parametrize(("teeth", "swing", "rim_mm"), [(24, 0.05, 8.0), (30, 0.3, 12.0), (48, 0.3, 6.0)])
def test_a_ring_in_a_jam_is_within_the_margin_from_which_it_is_said_to_hold(
    teeth: int, swing: float, rim_mm: float
) -> None:
    """Its walls are those of the body, thick where the ring's pitch curve is near its axis."""
    gears = f"{{teeth: {teeth}, module_mm: 2, face_width_mm: 14, mesh: internal, lobes: {{driving: 1, driven: 2}}"
    made = drive_of_text(f"""\
name: ring
linkage: {{crank_mm: 38, rod_mm: 96}}
operation: {{speed_rpm: 60}}
motion: {{law: ratio_expression, ratio: "2 + {swing}*cos(phi)", scale_to_close: true}}
gears: {gears}, driven: {{rim_mm: {rim_mm}}}}}
resistance: {{polynomial_n: [15]}}
strength: {{overload: {{driving_torque_n_m: 100}}}}
""")
    rough, jammed = rough_strength(made), made.judged_teeth("estimate").jammed
    assert rough is not None
    assert jammed is not None
    for one in rough.jammed:
        assert 1.0 / RINGS_HOLD <= one.safety / lives_of(jammed, one.gear)[one.damage].safety_min <= 1.25, one
    cycle = np.linspace(0.0, 2.0 * made.transmission.cycle_rad, 2000)
    walls = _walls_mm(made, Gear.DRIVEN, cycle)
    assert (walls.min(), walls.max()) == pytest.approx(
        (made.rims[1].wall_mm.min(), made.rims[1].wall_mm.max()), abs=0.1 * rim_mm
    )


@pytest.mark.slow
@pytest.mark.judges("strength")
def test_dry_plastics_are_as_warm_as_with_teeth() -> None:
    """Friction takes a fifth of the strength that they have in oil, and more."""
    text = ELLIPSE.replace("width_mm: 12", "width_mm: 24, material: PA66").replace("1500", "900").replace(" 60", " 900")
    dry, oiled = (drive_of_text(text.replace("1.0", f"1.0, lubrication: {one}")) for one in ("dry", "oil"))
    assert within(ratios(dry))
    cooler, warmer = (least(rough_strength(one), Damage.BENDING).safety for one in (oiled, dry))
    assert warmer < 0.8 * cooler


@pytest.mark.slow
@pytest.mark.parametrize(
    "gears",
    [
        "teeth: 20, module_mm: 2, profile_shift: {driving: 0.2, driven: 0.2}",
        "teeth: 20, module_mm: 2, mesh: internal, lobes: {driving: 1, driven: 2}",
        "teeth: 20, module_mm: 2, material: PA66",
    ],
    ids=["shifts", "ring", "soft"],
)
def test_what_only_teeth_tell_is_said(gears: str) -> None:
    text = TEXT.replace("teeth: 40, module_mm: 2", gears)
    if "internal" in gears:
        text = text.replace(
            "law: uniform_crank", 'law: ratio_expression, ratio: "2 + 0.1*cos(phi)", scale_to_close: true'
        )
    found = rough_strength(drive_of_text(text))
    assert found is not None
    assert found.needs_teeth.startswith("it needs the teeth to tell")
    light = strength_advice.rough(drive_of_text(text.replace("1500", "1")))
    assert light is None if "PA66" in gears or "internal" in gears else isinstance(light, NotJudged)


@pytest.mark.judges("strength")
@pytest.mark.parametrize(("angle_deg", "teeth"), [(12.0, 40), (20.0, 24), (28.0, 60)])
def test_circular_helical_gears_have_the_stresses_of_iso_6336(angle_deg: float, teeth: int) -> None:
    """sigma_H0 with Z_epsilon and Z_beta of part 2, and sigma_F0 with f_epsilon and Y_beta of part 3:2019."""
    beta, angle, width = radians(angle_deg), radians(20.0), 24.0
    text = TEXT.replace("teeth: 40", f"teeth: {teeth}").replace("1500", "15")
    text = text.replace("12}", f"24, helix: {{angle_deg: {angle_deg}, kind: helical, hand: left}}}}")
    found = rough_strength(drive_of_text(text))
    assert found is not None
    assert not found.unjudged
    c, normal = np.cos(beta), float(np.arctan(np.tan(angle) * np.cos(beta)))
    tips = 2.0 * (teeth + 2.0), 2.0 * (teeth + 2.0)
    pair = CylindricalPair(2.0 * c, (teeth, teeth), width, (0.0, 0.0), beta, normal, given_tip_mm=tips)
    tangential = 12.0 * line_load_n_mm(TEXT.replace("1500", "15")) * 40.0 / teeth
    nominal = nominal_contact_stress_mpa(pair, tangential, elasticity_factor(206e3, 0.3), c**-0.5)
    assert 0.97 <= least(found, Damage.CONTACT).stress_mpa / (1.3**0.5 * nominal) <= 1.11
    virtual, over = float(pair.virtual_teeth[0]), pair.virtual_contact_ratio
    outer = single_contact_diameter(virtual, virtual + 2.0 / c, over, normal)
    factors = root_factors(root_section(virtual, 0.0, RackTip(1.25 / c, 0.38), normal), virtual, 0.0, outer, normal)
    overlap = min(pair.overlap_ratio, 1.0)
    shared = (1.0 - overlap + overlap / over) ** 0.5 * (1.0 - overlap * beta / radians(120.0)) / c**3
    roots = face_load_factor_of_roots(Running(2.0, (teeth, teeth), width, 2.0 * pi), np.array(1.3))
    stress = roots * tangential / width / (2.0 * c) * factors.form * factors.notch * shared
    assert 0.9 <= least(found, Damage.BENDING).stress_mpa / stress <= 1.2


@pytest.mark.slow
@pytest.mark.judges("strength")
@pytest.mark.parametrize(("changes", "load"), [("", 1500), ("angle_deg: 8", 3000), ("angle_deg: 30", 900)])
def test_helical_teeth_have_the_safeties_that_the_teeth_tell(changes: str, load: int) -> None:
    """Of straight sections beside each other, every tooth of its own form."""
    text = HELICAL.replace("angle_deg: 18", changes or "angle_deg: 18").replace("1500", str(load))
    made = drive_of_text(text)
    for damage, ratio in ratios(made).items():
        assert 0.85 <= ratio <= 1.06, damage


OPEN = """\
name: press
linkage: {kind: rack_pinion, radius_mm: 30}
operation: {speed_rpm: 20}
motion: {law: function_generator, function: "x", x_from: 0, x_to: 1, driving_range_deg: 200, driven_range_deg: 200}
gears: {module_mm: 2.5, center_distance_mm: 100, face_width_mm: 18}
resistance: {polynomial_n: [700]}
"""


@pytest.mark.judges("strength")
def test_the_root_stress_of_open_gears_is_that_of_iso_6336_3() -> None:
    """Circular sectors of 40 teeth under an even torque."""
    still = OPEN + "strength: {dynamic_factor: 1.0}\n"
    found, angle = rough_strength(drive_of_text(still)), radians(20.0)
    assert found is not None
    assert not found.unjudged
    ratio = CylindricalPair(2.5, (40, 40), 18.0).transverse_contact_ratio
    outer = single_contact_diameter(40.0, 42.0, ratio, angle)
    factors = root_factors(root_section(40.0, 0.0, RackTip(1.25, 0.38), angle), 40.0, 0.0, outer, angle)
    running = drive_of_text(OPEN).running
    assert running.whole == pytest.approx((40.0, 40.0), rel=1e-6)
    line = 700.0 * 30.0 / 50.0 / 18.0
    stress = face_load_factor_of_roots(running, np.array(1.3)) * line / 2.5 * factors.form * factors.notch
    assert least(found, Damage.BENDING).stress_mpa == pytest.approx(stress, rel=0.04)


def test_helical_teeth_are_judged_without_teeth() -> None:
    weak = strength_advice.rough(drive_of_text(HELICAL.replace("1500", "80000")))
    assert isinstance(weak, Advice)
    assert strength_advice.rough(drive_of_text(HELICAL.replace("1500", "10"))) is None


@pytest.mark.slow
def test_dry_metal_is_not_said_to_hold(run: Run) -> None:
    """Its roots do, and its flanks wear away."""
    dry, oiled = drive_of_text(DRY), drive_of_text(DRY.replace("dry", "oil"))
    for one in (dry, oiled, drive_of_text(DRY.replace("12}", "12, material: {driving: C45, driven: POM}}"))):
        assert strength_advice.rough(one) is None
        assert strength_advice.strength(one) is None
    assert any(isinstance(one, Advice) and one.matters for one in strength_advice.flanks(dry))
    assert not any(isinstance(one, Advice) and one.matters for one in strength_advice.flanks(oiled))
    _, told, _ = on_text(run, "strength")(DRY)
    assert "no end" not in told
    assert "The teeth hold" not in told
    assert "dry metal wears" in told
    assert "a tenth of the module is gone after" in told
    _, told, _ = on_text(run, "strength")(DRY.replace("dry", "oil"))
    assert "until worn" not in told


@pytest.mark.slow
def test_a_build_tells_a_safety_where_its_strength_is_refused() -> None:
    """And never points to a warning that may not be there."""
    made = drive_of_text(HELICAL.replace("1500", "40").replace("dynamic_factor: 1.0", "method: elements"))
    rows = build_answer(made, Verdict(()), "").rows
    safety = next(row.texts[0] for row in rows if row.name == "safety")
    assert safety.startswith("about ")
    assert safety.endswith(" (1 wanted)")


def test_twice_the_load_leaves_half_the_safety_or_a_little_more() -> None:
    """Of roots; teeth that bend more share the load with others."""
    one, two = (rough_strength(drive_of_text(TEXT.replace("1500", load))) for load in ("1500", "3000"))
    assert 1.8 <= least(one, Damage.BENDING).safety / least(two, Damage.BENDING).safety <= 2.0
    assert least(one, Damage.CONTACT).safety == pytest.approx(2**0.5 * least(two, Damage.CONTACT).safety, rel=0.05)


@pytest.mark.slow
def test_what_is_too_near_to_tell_without_teeth_is_not_judged_and_points_to_the_rating() -> None:
    """Pressures grow with the root of the load; a tenth under the wanted safety may hold, a fifth does not."""
    given = least(rough_strength(drive_of_text(TEXT)), Damage.CONTACT).safety
    warned, near = (
        strength_advice.rough(drive_of_text(TEXT.replace("1500", f"{1500.0 * (given / safety) ** 2:.6g}")))
        for safety in (0.8, 0.93)
    )
    assert isinstance(warned, Advice)
    assert isinstance(near, NotJudged)
    assert near.why.startswith("a safety of about 0.9")
    assert near.why.endswith(
        "against pitting, 1 wanted, is too near for an estimate without teeth: ncgear strength tells"
    )


@pytest.mark.parametrize("name", ["ellipse", "helical-ellipse", "internal-1-2"])
def test_nothing_is_said_where_no_load_is_known(name: str) -> None:
    assert rough_strength(drive(name)) is None
    assert strength_advice.rough(drive(name)) is None
    assert strength_advice.strength(drive(name)) is None


@pytest.mark.slow
def test_a_check_warns_and_makes_no_tooth(run: Run) -> None:
    check = on_text(run, "check", "--verbose")
    _, weak, _ = check(TEXT)
    assert "the teeth will hardly hold: safety about" in weak
    assert "face width roughly" not in weak  # 31 mm would be more than 12 modules
    assert "module roughly 3.5 mm" in weak
    _, strong, _ = check(TEXT.replace("1500", "100"))
    assert "hardly hold" not in strong
    assert "kept        the teeth hold their load" in strong


@pytest.mark.thorough
def test_a_load_that_no_gears_of_usual_size_bear_asks_for_others(run: Run) -> None:
    _, weak, _ = on_text(run, "check", "--verbose")(TEXT.replace("1500", "1e11"))
    assert "To change it: take a stronger material; or take more pairs of gears" in " ".join(weak.split())
    assert "ncgear size" not in weak


@pytest.mark.parametrize(
    ("safety", "wanted", "told"), [(1.36, 2.0, "1.4"), (1.99849, 2.0, "1.998"), (1.3997, 1.4, "1.3997")]
)
def test_a_safety_under_the_wanted_one_is_told_with_digits_that_say_so(safety: float, wanted: float, told: str) -> None:
    assert _under(safety, wanted) == told
    assert _under(wanted * (1.0 - 1e-15), wanted) == f"just under {wanted:g}"
