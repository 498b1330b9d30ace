"""Hertz's closed form against the equation of the half-plane, integrated, and against ISO 6336-2 at the pitch point."""

from __future__ import annotations

from math import cos, pi, radians, sin, sqrt

import numpy as np
import pytest
from scipy.integrate import quad

from circular_pairs import CylindricalPair, contact_ratio_factor, elasticity_factor, nominal_contact_stress_mpa
from drives import drive_of_text
from ncgear.strength.hertz import contact_modulus_mpa, half_width_mm, hertz_pressure_mpa
from tooth_places import STEEL, elastic

POM = elastic(2800.0, 0.35)


@pytest.mark.judges("strength")
def test_the_pressure_bears_the_load_and_fits_both_bodies() -> None:
    """p(x) over the half-width sums up to the load, and its slope of the gap, 2 / (pi E*) times the principal value of
    the integral of p(s) / (x - s), is x times the relative curvature: so the gap is closed everywhere."""
    load, curvature = 40.0, 0.11
    materials = STEEL, POM
    (top,), (half,) = (
        of(np.array([load]), np.array([curvature]), materials) for of in (hertz_pressure_mpa, half_width_mm)
    )

    def pressure(x: float) -> float:
        return float(top) * sqrt(max(1.0 - (x / half) ** 2, 0.0))

    assert quad(pressure, -half, half)[0] == pytest.approx(load, rel=1e-6)
    for x in (0.2 * half, -0.6 * half):
        pull = -quad(pressure, -half, half, weight="cauchy", wvar=x)[0]
        assert 2.0 / (pi * contact_modulus_mpa(materials)) * pull == pytest.approx(x * curvature, rel=1e-5)
        wider = -quad(lambda s: pressure(s / 2.0), -2.0 * half, 2.0 * half, weight="cauchy", wvar=x)[0]
        assert 2.0 / (pi * contact_modulus_mpa(materials)) * wider != pytest.approx(x * curvature, rel=0.1)


@pytest.mark.judges("strength")
def test_a_spur_pair_has_the_nominal_stress_of_iso_6336_2_at_its_pitch_point() -> None:
    """sigma_H0 without the contact ratio factor, which spreads the load over more than one pair."""
    pair = CylindricalPair(3.0, (21, 44), 25.0)
    tangential = 4000.0
    nominal = nominal_contact_stress_mpa(pair, tangential, elasticity_factor(206e3, 0.3)) / contact_ratio_factor(pair)
    sine = sin(radians(20.0))
    curvature = 1.0 / (31.5 * sine) + 1.0 / (66.0 * sine)
    line = tangential / cos(radians(20.0)) / 25.0
    found = hertz_pressure_mpa(np.array([line]), np.array([curvature]), (STEEL, STEEL))
    assert found == pytest.approx([nominal], rel=1e-12)


def test_an_edge_has_no_width_and_infinite_pressure() -> None:
    line, edge = np.array([10.0]), np.array([np.inf])
    assert half_width_mm(line, edge, (STEEL, STEEL)).tolist() == [0.0]
    assert hertz_pressure_mpa(line, edge, (STEEL, STEEL)).tolist() == [np.inf]


@pytest.mark.tiers(quick=["17-100"], rest="slow")
@pytest.mark.parametrize(("teeth", "force_n"), [(17, 100), (24, 400), (40, 2000)])
def test_round_gears_are_rated_at_the_end_of_single_contact_which_deflection_moves(teeth: int, force_n: float) -> None:
    """By hand: T / (r cos 20 deg), there, with both involutes' radii.  Teeth give way and bear in two pairs sooner."""
    text = f"""name: round
linkage: {{crank_mm: 40, rod_mm: 150}}
operation: {{speed_rpm: 60}}
motion: {{law: uniform_crank}}
gears: {{teeth: {teeth}, module_mm: 2.5, face_width_mm: 25, material: 42CrMo4, undercut: allow}}
resistance: {{polynomial_n: [{force_n}], returning: {{polynomial_n: [{force_n}]}}}}
strength: {{application_factor: 1, dynamic_factor: 1, face_load_factor: 1}}
"""
    one = drive_of_text(text)
    angle, radius = np.radians(20.0), 1.25 * teeth
    torque = float(np.abs(one.tooth_load.torque_n_mm(np.linspace(0.0, 2.0 * np.pi, 20_001))).max())
    line_load = torque / (radius * np.cos(angle)) / 25.0
    over_base = np.sqrt((radius + 2.5) ** 2 - (radius * np.cos(angle)) ** 2)
    own = over_base - 2.5 * np.pi * np.cos(angle)
    mate, modulus = 2.0 * radius * np.sin(angle) - own, 206_000.0 / (2.0 * (1.0 - 0.3**2))
    by_hand, pitch_point = (
        np.sqrt(line_load / np.pi * curvature * modulus)
        for curvature in (1.0 / own + 1.0 / mate, 4.0 / (2.0 * radius * np.sin(angle)))
    )
    rated = one.strength.driving.contact
    assert rated is not None
    assert 0.97 < rated.stress_mpa.max() / by_hand < 1.0005
    assert rated.stress_mpa.max() > 0.999 * pitch_point
