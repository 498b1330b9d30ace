"""Helical teeth under load against ISO 6336 on circular gears, and against straight teeth where both must agree."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from math import atan, cos, pi, radians, tan

import numpy as np
import pytest

from circular_pairs import (
    CylindricalPair,
    contact_ratio_factor,
    elasticity_factor,
    mesh_stiffness,
    nominal_contact_stress_mpa,
    single_contact_diameter,
    single_stiffness,
)
from engaged import LAWS
from loaded import FRICTION, LINEAR
from ncgear.dynamics.gaps import Gaps, gaps_of
from ncgear.dynamics.law_table import law_table
from ncgear.dynamics.meshing import Meshing
from ncgear.pitch.pair import PitchPair, sized_pair
from ncgear.pitch.shape import Gear, Mesh
from ncgear.solids.helical.even_tips import with_even_tips
from ncgear.solids.helical.helix import Hand, Helix
from ncgear.solids.helical.sections import Sections
from ncgear.strength.conditions import Conditions, Running
from ncgear.strength.estimate import estimate_of
from ncgear.strength.iso6336 import RackTip, root_factors, root_section, single_stiffness_theoretical
from ncgear.strength.life import rated_for_pitting, stresses_of
from ncgear.strength.loading import AskedTorque, Loading, loading_of
from ncgear.strength.sections import FaceSection, FaceSections, InSections, count_of
from ncgear.strength.stiffness import LinearTeeth
from ncgear.strength.vibration import MeshStiffness, Vibration
from ncgear.teeth.form import TipLimits, ToothForm
from pairs import rack
from tooth_places import STEEL, places_at

MODULE, WIDTH, FORCE_N = 2.0, 24.0, 1200.0
ANGLE = radians(20.0)
"""Module and pressure angle across the axis, face width, and tangential force."""


def helix_of(angle_deg: float, width_mm: float = WIDTH, *, herringbone: bool = False) -> Helix:
    return Helix(radians(angle_deg), width_mm, Hand.RIGHT, herringbone)


@cache
def sections_of(law: str, teeth: int, helix: Helix, count: int) -> tuple[PitchPair, FaceSections]:
    pitch = sized_pair(LAWS[law](), teeth, MODULE, None, Mesh.EXTERNAL)
    form = with_even_tips(pitch, ToothForm(rack(20.0), limits=TipLimits(0.2 * MODULE, avoid_undercut=False)), helix)
    made = Sections(pitch, form, helix, 0.005)
    heights = helix.rise_mm * (np.arange(count) + 0.5) / count
    parts = tuple(FaceSection(made.at(float(height)).teeth, 1.0 / count) for height in heights)
    return pitch, FaceSections(parts, helix.angle_rad)


@cache
def loaded(law: str, teeth: int, helix: Helix, count: int) -> tuple[Loading, tuple[InSections, InSections]]:
    """Teeth of steel under a tangential force of FORCE_N at the radius of circular gears."""
    pitch, sections = sections_of(law, teeth, helix, count)
    methods = tuple(
        InSections(tuple(estimate_of(one.teeth.of(gear), STEEL, helix.angle_rad) for one in sections.each))
        for gear in Gear
    )
    parts = []
    for number, one in enumerate(sections.each):
        beams = methods[0].each[number], methods[1].each[number]
        stiffness = LinearTeeth(one.teeth, beams, (STEEL, STEEL), one.share * WIDTH, FORCE_N / WIDTH)
        parts.append(gaps_of(one.teeth, pitch, stiffness, 40, sides=(0,)))
    meshing = Meshing(law_table(LAWS[law]()), Gaps.beside(parts), LINEAR, FRICTION)
    torque = FORCE_N * MODULE * pitch.size.driven_teeth / 2.0
    asked = AskedTorque.of(pitch, lambda phi1: np.full_like(phi1, torque))
    found = loading_of(meshing, sections, pitch, asked, lambda phi1: np.full_like(phi1, 3.0))
    return found, (methods[0], methods[1])


def stresses(law: str, teeth: int, helix: Helix, count: int) -> tuple[float, float, float]:
    """The largest rated pressure, and the largest root stresses of both gears, without factors of load."""
    loading, methods = loaded(law, teeth, helix, count)
    contacts, plain = loading.contacts, Conditions(dynamic_factor=1.0)
    running = Running(MODULE, (teeth, teeth), WIDTH, 3.0)
    found = stresses_of(contacts, methods, (STEEL, STEEL), plain, running, *np.ones((2, contacts.force_n.size)))
    rated = rated_for_pitting(contacts)
    return (float(found.pressure_mpa[rated].max()), *(float(one.max()) for one in found.tension_mpa))


def iso_pair(teeth: tuple[int, int], angle_deg: float) -> CylindricalPair:
    """The same pair by its normal module and pressure angle."""
    beta = radians(angle_deg)
    normal, angle = MODULE * cos(beta), atan(tan(ANGLE) * cos(beta))
    tips = tuple(MODULE * (z + 2.0) for z in teeth)
    return CylindricalPair(normal, teeth, WIDTH, (0.0, 0.0), beta, angle, given_tip_mm=(tips[0], tips[1]))


@pytest.mark.judges("strength")
@pytest.mark.parametrize("angle_deg", [12.0, 25.0])
def test_roots_across_the_tooth_are_those_of_the_virtual_spur_gear(angle_deg: float) -> None:
    """Y_F Y_S of ISO 6336-3 for z_n teeth, F_t / (b m_n) times them; a circle of the rack's tip is an ellipse across
    the tooth, whose radius is between both of its axes'."""
    beta, teeth = radians(angle_deg), 30
    pair, (_, sections) = iso_pair((teeth, teeth), angle_deg), sections_of("uniform", teeth, helix_of(angle_deg), 3)
    gear = sections.each[1].teeth.driving
    top, bottom = gear.sides.flank_range()
    places = places_at(gear, np.full(4, 3), np.linspace(bottom[3], top[3], 6)[2:])
    virtual = float(pair.virtual_teeth[0])
    # Heights over the reference circle are the same across the tooth.
    at = virtual + (2.0 * np.abs(places.point) - MODULE * teeth) / pair.module_mm
    found, straight = (estimate_of(gear, STEEL, one).root_stress(places).tension_mpa for one in (beta, 0.0))
    wanted = []
    for radius in (0.38 / cos(beta), 0.38 * cos(beta)):
        tip = RackTip(1.25 / cos(beta), radius)
        section = root_section(virtual, 0.0, tip, pair.pressure_angle_rad)
        factors = root_factors(section, virtual, 0.0, at, pair.pressure_angle_rad)
        wanted.append(cos(ANGLE) / pair.module_mm * factors.form * factors.notch)
    assert np.all(found > 0.975 * np.max(wanted, axis=0))
    assert np.all(found < 1.06 * np.min(wanted, axis=0))
    # The negative control: the section across the axis is thicker.
    assert np.all(straight < 0.98 * np.min(wanted, axis=0))


@pytest.mark.tiers(slow=["15.0-40", "30.0-24"], rest="long")
@pytest.mark.judges("strength")
@pytest.mark.parametrize(("angle_deg", "teeth"), [(10.0, 24), (15.0, 40), (20.0, 24), (25.0, 40), (30.0, 24)])
def test_pressures_and_root_stresses_of_circular_gears_are_those_of_iso_6336(angle_deg: float, teeth: int) -> None:
    """sigma_H0 with Z_epsilon and Z_beta; sigma_F0 of method B with f_epsilon and Y_beta of 2019, and Y_beta of 2006.

    The editions of ISO 6336-3 are further from each other than either from here.
    """
    helix, pair = helix_of(angle_deg), iso_pair((teeth, teeth), angle_deg)
    pressure, *roots = stresses("uniform", teeth, helix, count_of(helix.largest_advance_mm, pi * MODULE))
    beta, c = helix.angle_rad, cos(helix.angle_rad)
    elasticity = elasticity_factor(206e3, 0.3)
    assert 0.98 <= pressure / nominal_contact_stress_mpa(pair, FORCE_N, elasticity, c**-0.5) <= 1.07
    # The negative control: without the overlap's share Z_epsilon would be another.
    straight = replace(pair, face_width_mm=1e-9)
    assert pressure < 0.96 * pressure * contact_ratio_factor(straight) / contact_ratio_factor(pair)
    virtual, angle, over = float(pair.virtual_teeth[0]), pair.pressure_angle_rad, pair.virtual_contact_ratio
    outer = single_contact_diameter(virtual, virtual + 2.0 / c, over, angle)
    section = root_section(virtual, 0.0, RackTip(1.25 / c, 0.38), angle)
    factors = root_factors(section, virtual, 0.0, outer, angle)
    overlap = min(pair.overlap_ratio, 1.0)
    slanting = 1.0 - overlap * beta / radians(120.0)
    nominal = FORCE_N / WIDTH / pair.module_mm * factors.form * factors.notch * slanting
    shared = (1.0 - overlap + overlap / over) ** 0.5 / c**3
    for root in roots:
        assert 0.93 <= root / (nominal * shared) <= 1.17
        assert 0.82 <= root / nominal <= 1.24


@pytest.mark.long
@pytest.mark.slow
@pytest.mark.judges("strength")
def test_lines_of_contact_are_even_where_teeth_advance_a_whole_pitch() -> None:
    """Then as much of them bears at every position (epsilon_beta = 1), and the driven gear hardly moves to and fro."""
    even = helix_of(float(np.degrees(atan(pi * MODULE / WIDTH))))
    errors = {
        name: loaded("uniform", 24, helix, count)[0].transmission_error_rad
        for name, helix, count in (("even", even, 24), ("half", helix_of(7.46), 24), ("straight", helix_of(1e-6), 1))
    }
    assert errors["even"] < 0.25 * errors["straight"]
    assert errors["even"] < 0.5 * errors["half"]


@pytest.mark.long
@pytest.mark.slow
@pytest.mark.judges("strength")
def test_the_mesh_is_as_stiff_as_iso_6336_1_says() -> None:
    """c_gamma_alpha = c' (0.75 epsilon_alpha + 0.25), c' with cos(beta) and C_B, beside that of straight teeth."""

    def over_iso(angle_deg: float, count: int) -> float:
        pair, helix = iso_pair((30, 30), angle_deg), helix_of(angle_deg)
        loading, _ = loaded("uniform", 30, helix, count)
        along_mm = np.abs(loading.error_rad) * MODULE * 30 / 2.0 * cos(ANGLE)
        theory, dedendum = single_stiffness_theoretical(pair.virtual_teeth, (0.0, 0.0)), 1.25 / cos(helix.angle_rad)
        single = single_stiffness(theory, dedendum, helix.angle_rad)
        return FORCE_N / WIDTH / float(np.mean(along_mm)) / mesh_stiffness(single, pair.transverse_contact_ratio)

    straight = over_iso(1e-6, 1)
    for angle_deg in (15.0, 30.0):
        assert over_iso(angle_deg, 20) == pytest.approx(straight, rel=0.07)


@pytest.mark.long
@pytest.mark.slow
@pytest.mark.judges("strength")
def test_no_helix_is_straight_and_twice_the_sections_change_little() -> None:
    one, many = (stresses("sine", 31, helix_of(1e-6), count) for count in (1, 4))
    assert many == pytest.approx(one, rel=1e-6)
    usual, fine = (stresses("sine", 31, helix_of(20.0), count) for count in (17, 34))
    assert usual == pytest.approx(fine, rel=0.02)
    assert usual != pytest.approx(one, rel=0.05)


@pytest.mark.slow
def test_forces_of_all_sections_balance_the_torque() -> None:
    """Each force times its base radius; a pair's force is that of its sections."""
    loading, _ = loaded("uniform", 24, helix_of(20.0), 3)
    contacts, torque = loading.contacts, FORCE_N * MODULE * 12.0
    borne = np.bincount(contacts.position, contacts.force_n) * MODULE * 12.0 * cos(ANGLE)
    assert borne == pytest.approx(np.full(borne.size, torque), rel=2e-3)
    pairs = contacts.of_pairs()
    assert pairs.force_n.size < contacts.force_n.size
    assert np.bincount(pairs.position, pairs.force_n) == pytest.approx(np.bincount(contacts.position, contacts.force_n))
    assert np.all(contacts.share == pytest.approx(1.0 / 3.0))


def test_what_vibration_adds_presses_the_whole_width() -> None:
    """F + (K_V - 1) F over the width wherever teeth touch: not all of it on the one section that happens to bear."""
    loading, _ = loaded("uniform", 24, helix_of(20.0), 3)
    contacts, running = loading.contacts, Running(MODULE, (24, 24), WIDTH, 30.0)
    vibration = Vibration(
        lambda phi1: np.full_like(phi1, 0.1), lambda phi1: np.full_like(phi1, 500.0), (0.01, 0.01), ANGLE, running
    )
    mesh = MeshStiffness(np.array([0.0, 1.0]), np.full(2, 4e5), np.full(2, 1.5), 2.0 * pi)
    alone = contacts.kept(contacts.section == 0)
    alone = replace(alone, force_n=1e-3 * alone.force_n)
    force = np.bincount(alone.position, alone.force_n)[alone.position]
    plain = vibration.factors(alone.phi1_rad, force, mesh, Conditions())
    borne = alone.force_n * vibration.of_contacts(alone, mesh, Conditions())
    assert plain.min() > 5.0
    added = np.bincount(alone.position, borne - alone.force_n)[alone.position]
    assert added == pytest.approx((plain - 1.0) * force / 3.0, rel=1e-9)
    given = Conditions(dynamic_factor=1.5)
    assert np.all(vibration.of_contacts(alone, mesh, given) == 1.5)
    # Teeth that are straight have it all.
    straight = replace(alone, share=np.ones_like(alone.share))
    assert straight.force_n * vibration.of_contacts(straight, mesh, Conditions()) == pytest.approx(
        plain * alone.force_n, rel=1e-12
    )
