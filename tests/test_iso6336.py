"""Formulas of ISO 6336 against published worked examples; both are secondary transcripts (see the module)."""

from __future__ import annotations

from dataclasses import replace
from math import cos, pi, radians, sqrt

import numpy as np
import pytest

from at_once import at_once
from circular_pairs import (
    CylindricalPair,
    contact_ratio_factor,
    elasticity_factor,
    mesh_stiffness,
    nominal_contact_stress_mpa,
    single_contact_diameter,
    single_contact_factors,
    single_stiffness,
    zone_factor,
)
from ncgear.strength.iso6336 import (
    RackTip,
    lubricant_factor,
    rim_factor,
    root_factors,
    root_section,
    roughness_factor,
    single_stiffness_theoretical,
    speed_factor,
)
from ncgear.strength.material import EnduredStress

TR_30 = CylindricalPair(
    8.0, (17, 103), 100.0, (0.145, 0.0), radians(15.8), given_center_distance_mm=500.0, given_tip_mm=(159.66, 872.35)
)
"""Example 1 of ISO/TR 6336-30.  The tip diameters are the full ones rounded to 0.01 mm: only so is the published
c_gamma_alpha / c' the given 1.41182, that is a contact ratio of 1.54909."""

TORQUE_N_MM, SPEED_RPM, HOURS = 9.0e6, 360.0, 50_000.0

ENDURED = EnduredStress(np.array([1e5, 5e7, 1e10]), 1500.0 * np.array([1.6, 1.0, 0.85]))
"""Case-hardened steel without pitting: sigma_H lim 1500 MPa times Z_NT of ISO 6336-2."""


def shown(value: float, figure: str) -> bool:
    """Whether a value rounds to a printed figure, half a unit of its last digit and a rounding error apart at most."""
    digits = len(figure.partition(".")[2])
    return abs(value - float(figure)) <= 0.5 * 10.0**-digits * 1.0001


@pytest.mark.judges("strength")
def test_figures_of_example_1_of_iso_tr_6336_30() -> None:
    tangential = 2.0 * TORQUE_N_MM / TR_30.reference_mm[0]
    helix = 1.0 / sqrt(cos(TR_30.helix_rad))
    elasticity = elasticity_factor(206e3, 0.3)
    theory = single_stiffness_theoretical(TR_30.virtual_teeth, TR_30.shift)
    single = single_stiffness(theory, 1.4, TR_30.helix_rad)
    mesh = mesh_stiffness(single, TR_30.transverse_contact_ratio)
    found = {
        "127352": tangential,
        "2.39533": zone_factor(TR_30),
        "0.803": contact_ratio_factor(TR_30),
        "189.81170": elasticity,
        "1.01944": helix,
        "1206.58207": nominal_contact_stress_mpa(TR_30, tangential, elasticity, helix),
        "18.905": TR_30.virtual_teeth[0],
        "114.543": TR_30.virtual_teeth[1],
        "17.85584": theory,
        "12.37047": single,
        "17.46485": mesh,
        "14.84512": 0.85 * mesh,
    }
    assert [figure for figure, value in found.items() if not shown(value, figure)] == []
    assert single_contact_factors(TR_30) == (1.0, 1.0)


def test_the_stiffness_of_shifted_teeth_is_the_standards_polynomial() -> None:
    """C1 to C9 of ISO 6336-1, table 9 (secondary source); the example above has no shift of the second gear."""
    coefficients = [0.04723, 0.15551, 0.25791, -0.00635, -0.11654, -0.00193, -0.24188, 0.00529, 0.00182]
    z1, z2, x1, x2 = 20.0, 45.0, 0.4, -0.3
    terms = [1.0, 1.0 / z1, 1.0 / z2, x1, x1 / z1, x2, x2 / z2, x1 * x1, x2 * x2]
    found = single_stiffness_theoretical((z1, z2), (x1, x2))
    assert found == pytest.approx(1.0 / np.dot(coefficients, terms), rel=1e-13)


def test_full_tip_diameters_would_miss_the_nominal_stress_by_a_tenth_of_a_megapascal() -> None:
    """The negative control of the rounded tip diameters."""
    exact = replace(TR_30, given_tip_mm=None)
    tangential, helix = 2.0 * TORQUE_N_MM / exact.reference_mm[0], 1.0 / sqrt(cos(exact.helix_rad))
    stress = nominal_contact_stress_mpa(exact, tangential, elasticity_factor(206e3, 0.3), helix)
    assert 1206.58207 - stress == pytest.approx(0.098, abs=0.001)


@pytest.mark.judges("strength")
def test_safety_against_pitting_of_example_1() -> None:
    """K_V 1.003 and K_H beta 1.16 are printed rounded, so the stress is met to 1e-4 only, and so are the safeties."""
    speed = pi * TR_30.reference_mm[0] * SPEED_RPM / 60e3
    assert shown(speed, "2.664")
    film = lubricant_factor(1500.0, 320.0), speed_factor(1500.0, speed), roughness_factor(1500.0, 6.0, 21.8537)
    for factor, figure in zip(film, ("1.04739", "0.96911", "0.96599"), strict=True):
        assert shown(float(factor), figure)
    cycles = 60.0 * SPEED_RPM * HOURS * np.array([1.0, 1.0 / TR_30.ratio])
    permitted = ENDURED.at(cycles) * np.prod(film)
    assert shown(ENDURED.at(cycles)[0] / 1500.0, "0.91")
    assert shown(ENDURED.at(cycles)[1] / 1500.0, "0.962")
    assert permitted == pytest.approx([1338.48050, 1414.52551], rel=1e-7)
    stress = 1206.58207 * sqrt(1.003 * 1.16)
    assert stress == pytest.approx(1301.35343, rel=1.0e-4)
    assert stress != pytest.approx(1301.35343, rel=0.9e-4)
    assert permitted / stress == pytest.approx([1.02853, 1.08696], rel=1.0e-4)


DIN_11 = CylindricalPair(16.0, (23, 113), 480.0, (0.313, -0.071), radians(7.0))
RACKS = RackTip(1.4, 0.4, 0.02), RackTip(1.25, 0.25)


def din_load_factors(line_n_mm: float, speed_m_s: float) -> tuple[float, float]:
    """K_V and K_H beta of DIN 3990-11 for the example: quality 6, shaft of 370 mm, f_ma 10 um, K_A 1.25."""
    u, d = DIN_11.ratio, DIN_11.reference_mm[0]
    dynamic = 1.0 + (8.5 / line_n_mm + 0.0087) * DIN_11.teeth[0] * speed_m_s / 100.0 * sqrt(u**2 / (1.0 + u**2))
    line = line_n_mm * dynamic
    place = 1.0 - 1125.0 * 0.151 * 1125.0 / d**2 * (d / 370.0) ** 4
    bend = line * 0.023 * (abs(place - 0.3) + 0.3) * (480.0 / d) ** 2
    askew = abs(1.33 * bend - 10.0)
    run_in = (0.15 + 320.0 / 740.0) / 2.0 * askew
    return dynamic, 1.0 + 20.0 * (askew - run_in) / (2.0 * line)


@pytest.mark.judges("strength")
def test_safeties_of_the_example_of_din_3990_11() -> None:
    """S_H 2.1 and 1.2, S_F 4.8 and 3.3: pinion case-hardened (1500, 860 MPa), wheel through-hardened (740, 590 MPa)."""
    diameter = DIN_11.reference_mm[0]
    speed = pi * diameter * 275.2 / 60e3
    tangential = 1500e3 / speed
    dynamic, across = din_load_factors(1.25 * tangential / 480.0, speed)
    nominal = nominal_contact_stress_mpa(DIN_11, tangential, 189.8, sqrt(cos(DIN_11.helix_rad)))
    contact = nominal * sqrt(1.25 * dynamic * across) * np.array(single_contact_factors(DIN_11))
    endured = 0.92 * np.array([1500.0 * (1.05 - 0.005 * 16.0), 740.0 * (1.2 - (266.0 - 130.0) / 1700.0)])
    assert [shown(*pair) for pair in zip(endured / contact, ("2.1", "1.2"), strict=True)] == [True, True]

    height = (DIN_11.tip_mm - DIN_11.reference_mm) / 2.0 + 16.0 * (np.array([1.4, 1.25]) - np.array(DIN_11.shift))
    slender = np.minimum(height / 480.0, 1.0 / 3.0)
    shared = 0.25 + 0.75 / DIN_11.virtual_contact_ratio
    helix = 1.0 - min(DIN_11.overlap_ratio, 1.0) * 7.0 / 120.0
    endured = np.array([860.0 * (1.05 - 0.01 * 16.0), 590.0 * (1.03 - 0.006 * 16.0)])
    for gear, figure in enumerate(("4.8", "3.3")):
        teeth, shift = DIN_11.virtual_teeth[gear], DIN_11.shift[gear]
        tip = teeth + (DIN_11.tip_mm[gear] - DIN_11.reference_mm[gear]) / 16.0
        factors = root_factors(root_section(teeth, shift, RACKS[gear]), teeth, shift, tip)
        stress = tangential / 480.0 / 16.0 * factors.form * factors.notch * shared * helix
        stress *= 1.25 * dynamic * across ** (1.0 / (1.0 + slender[gear] + slender[gear] ** 2))
        assert shown(endured[gear] / stress, figure)


def test_the_outer_point_of_single_contact_is_a_base_pitch_from_the_end_of_contact() -> None:
    """A spur pair of 20 and 30 teeth: on the line of action the point is e_alpha - 1 base pitches below the tip."""
    pair = CylindricalPair(1.0, (20, 30), 10.0)
    ratio = pair.transverse_contact_ratio
    diameter = single_contact_diameter(20.0, 22.0, ratio, radians(20.0))
    base = 20.0 * cos(radians(20.0))
    way = (sqrt(22.0**2 - base**2) - sqrt(diameter**2 - base**2)) / 2.0
    assert way == pytest.approx((ratio - 1.0) * pi * cos(radians(20.0)), rel=1e-12)
    assert pair.center_distance_mm == pytest.approx(25.0, rel=1e-12)


@at_once(
    ("wall", "internal", "factor"),
    [
        (5.4, False, 1.0),
        (3.0, False, 1.6 * np.log(2.242 * 4.5 / 3.0)),
        (7.0, True, 1.0),
        (5.0, True, 1.15 * np.log(3.3296)),
    ],
)
def test_a_thin_rim_raises_root_stress_and_a_thick_one_does_not(wall: float, internal: bool, factor: float) -> None:
    assert rim_factor(wall, 4.5, 2.0, internal=internal) == pytest.approx(factor, rel=1e-12)


@pytest.mark.parametrize(("internal", "thick", "thin"), [(False, 5.4, 2.25), (True, 7.0, 3.5)])
def test_the_factor_of_a_rim_has_no_jump_but_where_it_is_not_known(internal: bool, thick: float, thin: float) -> None:
    just_thinner = rim_factor(thick * (1.0 - 1e-9), 4.5, 2.0, internal=internal)
    assert just_thinner == pytest.approx(1.0, abs=5e-3)
    assert 1.5 < rim_factor(thin, 4.5, 2.0, internal=internal) < 3.0
    assert rim_factor(thin * (1.0 - 1e-9), 4.5, 2.0, internal=internal) == np.inf
