"""The rough strength at the pitch point, which a check tells: against ISO 6336 and against the estimate with teeth."""

from __future__ import annotations

from math import cos, pi, radians, sin

import numpy as np
import pytest

from commands import Run, on_text
from drives import drive, drive_of_text
from ncgear.project.rough_strength import rough_strength
from ncgear.project.strengthening import verdict_of
from ncgear.strength.at_pitch_point import RoughSafety
from ncgear.strength.conditions import Running, face_load_factor_of_roots
from ncgear.strength.holding import Damage
from ncgear.strength.iso6336 import CylindricalPair, contact_ratio_factor, elasticity_factor, nominal_contact_stress_mpa

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


def least(found: list[RoughSafety], damage: Damage) -> RoughSafety:
    return min((one for one in found if one.damage is damage), key=lambda one: one.safety)


@pytest.mark.judges("strength")
def test_the_pressure_of_circular_gears_is_that_of_iso_6336_2() -> None:
    """sigma_H0 without Z_epsilon, times the root of K_Hbeta, for the crank's largest torque, found on a fine grid."""
    made = drive_of_text(TEXT)
    crank = np.linspace(0.0, pi, 20001)
    slide = 38.0 * np.cos(crank) + np.sqrt(96.0**2 - (38.0 * np.sin(crank)) ** 2)
    torque = 1500.0 * np.abs(np.gradient(slide, crank)).max()
    pair = CylindricalPair(2.0, (40, 40), 12.0)
    nominal = nominal_contact_stress_mpa(pair, torque / 40.0, elasticity_factor(206e3, 0.3), 1.0)
    found = least(rough_strength(made), Damage.CONTACT)
    assert found.stress_mpa == pytest.approx(nominal / contact_ratio_factor(pair) * 1.3**0.5, rel=1e-4)


@pytest.mark.slow
@pytest.mark.judges("strength")
@pytest.mark.parametrize("text", [TEXT, ELLIPSE], ids=["circles", "ellipses"])
def test_beside_the_estimate_with_teeth(text: str) -> None:
    """Pressure within a tenth, being largest near the pitch point; roots bear up to 40 % less where pairs share."""
    made = drive_of_text(text)
    rough, known = rough_strength(made), verdict_of(made, "estimate").weakest
    for damage, low, high in ((Damage.CONTACT, 0.9, 1.1), (Damage.BENDING, 0.6, 1.05)):
        exact = min((one for one in known if one.damage is damage), key=lambda one: one.safety)
        assert low <= least(rough, damage).safety / exact.safety <= high


@pytest.mark.judges("strength")
def test_root_stress_by_hand() -> None:
    """Y_F and Y_S of 40 teeth at the outer point of single contact, from the chord and radius of the real 30 degrees.

    A rack with h_fP 1.25 and rho_fP 0.38: Y_F about 1.6 and Y_S about 1.85 at a contact ratio of 1.5 (tables of DIN
    3990-3, from secondary sources, for loads at the tip: 2.4 and 1.67).
    """
    made = drive_of_text(TEXT)
    found = least(rough_strength(made), Damage.BENDING)
    pressed = least(rough_strength(made), Damage.CONTACT)
    # Back from Hertz's pressure to the normal force for each mm, K_Hbeta taken off.
    modulus, relative = 206e3 / (2.0 * (1.0 - 0.3**2)), 2.0 / (40.0 * sin(radians(20.0)))
    line_load = pressed.stress_mpa**2 * pi / (relative * modulus) / 1.3
    roots = face_load_factor_of_roots(Running(2.0, (40, 40), 12.0, 2.0 * pi), 1.3)
    factors = found.stress_mpa / (roots * line_load * cos(radians(20.0)) / 2.0)
    assert 1.5 * 1.7 < factors < 1.75 * 2.1


def test_twice_the_load_halves_the_safety_of_roots() -> None:
    one, two = (rough_strength(drive_of_text(TEXT.replace("1500", load))) for load in ("1500", "3000"))
    assert least(one, Damage.BENDING).safety == pytest.approx(2.0 * least(two, Damage.BENDING).safety, rel=1e-9)
    assert least(one, Damage.CONTACT).safety == pytest.approx(2**0.5 * least(two, Damage.CONTACT).safety, rel=1e-9)


@pytest.mark.parametrize("name", ["ellipse", "helical-ellipse", "baler-66-two-stage", "internal-1-2"])
def test_nothing_is_said_where_no_load_is_known(name: str) -> None:
    assert rough_strength(drive(name)) == []


@pytest.mark.slow
def test_a_check_warns_and_makes_no_tooth(run: Run) -> None:
    check = on_text(run, "check", "--verbose")
    _, weak, _ = check(TEXT)
    assert "the teeth will hardly hold the load of the resistance" in weak
    assert "make the gears about" not in weak  # 31 mm would be more than 12 modules
    assert "take a module of about 3.2 mm with as many teeth" in weak
    _, strong, _ = check(TEXT.replace("1500", "100"))
    assert "hold" not in strong


@pytest.mark.thorough
def test_a_check_of_gears_too_fast_for_the_dynamic_factor_says_nothing_of_strength(run: Run) -> None:
    fast = TEXT.replace("speed_rpm: 60", "speed_rpm: 10000").replace("dynamic_factor: 1.0", "life_h: 1000")
    status, out, _ = on_text(run, "check", "--verbose")(fast)
    assert status == 0
    assert "hold" not in out


@pytest.mark.thorough
def test_a_load_that_no_gears_of_usual_size_bear_asks_for_others(run: Run) -> None:
    _, weak, _ = on_text(run, "check", "--verbose")(TEXT.replace("1500", "1e9"))
    assert "To change it: take a stronger material or more pairs of gears" in " ".join(weak.split())
    assert "ncgear size" not in weak
