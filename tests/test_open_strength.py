"""The strength of gears that turn less than once: against closed circular gears, ISO 6336 and counts by hand."""

from __future__ import annotations

from functools import cache
from math import cos, pi, radians

import numpy as np
import pytest

from circular_pairs import (
    CylindricalPair,
    contact_ratio_factor,
    elasticity_factor,
    nominal_contact_stress_mpa,
    single_contact_factors,
)
from drives import drive_of_text
from ncgear.contact.placement import BACK, PUSHING
from ncgear.pitch.shape import Gear
from ncgear.project.drive import Drive
from ncgear.strength.life import rated_for_pitting

TEETH, MODULE, WIDTH, RACK_MM = 40, 2.5, 18.0, 30.0
OPEN = f"""\
name: press
linkage: {{kind: rack_pinion, radius_mm: {RACK_MM}}}
operation: {{speed_rpm: 20}}
motion: {{law: function_generator, function: "x", x_from: 0, x_to: 1, driving_range_deg: 200, driven_range_deg: 200}}
gears: {{module_mm: {MODULE}, center_distance_mm: {MODULE * TEETH}, face_width_mm: {WIDTH}}}
strength: {{dynamic_factor: 1.0, life_h: 2000}}
resistance: {{polynomial_n: [700]}}
"""
CLOSED = f"""\
name: shaft
operation: {{speed_rpm: 20}}
motion: {{law: uniform_crank}}
gears: {{teeth: {TEETH}, module_mm: {MODULE}, face_width_mm: {WIDTH}}}
strength: {{dynamic_factor: 1.0, life_h: 2000}}
resistance: {{polynomial_n_m: [{0.7 * RACK_MM}]}}
"""
BASE_MM = TEETH * MODULE / 2.0 * cos(radians(20.0))


@cache
def made(friction_n: float = 0.0, load: str = "700") -> Drive:
    text = OPEN.replace("[700]", f"[{load}]")
    return drive_of_text(text.replace("]}\n", f"], friction_n: {friction_n}}}\n") if friction_n else text)


@pytest.mark.slow
@pytest.mark.judges("strength")
def test_sectors_of_circles_bear_as_whole_circles_do() -> None:
    """Teeth in the middle of the range, at whose roots and flanks nothing knows where the range ends.

    Positions are 20 to a pitch, and where a pair begins to bear all of the load, is met to a twentieth of it.
    """
    found, whole = made().strength, drive_of_text(CLOSED).strength
    for gear in Gear:
        one, other = found.of(gear), whole.of(gear)
        assert one.contact is not None
        assert other.contact is not None
        middle = slice(8, one.bending.stress_mpa.size - 8)
        assert one.bending.stress_mpa[middle] == pytest.approx(other.bending.stress_mpa.max(), rel=0.03)
        assert one.contact.stress_mpa[middle] == pytest.approx(other.contact.stress_mpa.max(), rel=0.01)
    assert made(load="350").strength.driving.bending.stress_mpa.max() < 0.6 * found.driving.bending.stress_mpa.max()


@pytest.mark.slow
@pytest.mark.judges("strength")
def test_the_pressure_of_circular_sectors_is_that_of_iso_6336_2() -> None:
    pair = CylindricalPair(MODULE, (TEETH, TEETH), WIDTH)
    tangential = 700.0 * RACK_MM / (MODULE * TEETH / 2.0)
    nominal = nominal_contact_stress_mpa(pair, tangential, elasticity_factor(206e3, 0.3), 1.0)
    pitch_point = nominal / contact_ratio_factor(pair) * 1.3**0.5
    found = made().strength.driving.contact
    assert found is not None
    assert 0.998 * pitch_point <= found.stress_mpa.max() <= 1.01 * single_contact_factors(pair)[0] * pitch_point


@pytest.mark.slow
@pytest.mark.judges("strength")
def test_a_tooth_meets_its_mate_once_in_a_stroke() -> None:
    """Life by hand: the strokes that the largest pressure is endured, each of 400 degrees at 20 r/min."""
    drive = made(load="5000")
    life, stroke_h = drive.strength.driving.contact, 400.0 / 360.0 / 20.0 / 60.0
    endured = drive.strength.driving.material.contact
    assert life is not None
    assert endured is not None
    tooth = life.weakest - 1
    cycles = float(endured.cycles_to_failure(life.stress_mpa[[tooth]])[0])
    assert 1e4 < cycles < 1e9
    assert life.life_h[tooth] == pytest.approx(cycles * stroke_h, rel=1e-6)
    assert drive.running.pitch_speed_m_s == pytest.approx(MODULE * TEETH / 2.0 * 20.0 * pi / 30e3, rel=1e-6)


@pytest.mark.slow
@pytest.mark.judges("strength")
def test_friction_presses_the_backs_on_the_way_back() -> None:
    """Out bear 700 and 100 N on pushing flanks, back 100 N on the others; forces balance up to both ends."""
    loading = made(friction_n=100.0).judged_teeth("estimate").loading
    contacts = loading.contacts
    moment = np.bincount(contacts.position, contacts.force_n, loading.phi1_rad.size) * BASE_MM
    back = np.bincount(contacts.position, contacts.side, loading.phi1_rad.size) > 0
    assert moment[~back] == pytest.approx(800.0 * RACK_MM, rel=2e-3)
    assert moment[back] == pytest.approx(100.0 * RACK_MM, rel=2e-3)
    assert set(contacts.side) == {PUSHING, BACK}
    assert np.all(np.diff(loading.rolled_mm) > 0.0)
    at = loading.between(loading.rolled_mm)
    assert np.sort(at.force_n) == pytest.approx(np.sort(contacts.force_n), rel=1e-6)
    # The control: without friction nothing bears on the way back.
    assert set(made().strength.contacts.side) == {PUSHING}
    roots = (made(friction_n=one).strength.driving.bending.safety.min() for one in (0.0, 100.0))
    idle, worked = roots
    assert worked < idle * 700.0 / 800.0
    assert rated_for_pitting(contacts).any()
