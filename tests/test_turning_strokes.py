"""Laws of the stroke on an output that turns: a rocker whose speed and table are in rad/s and deg."""

from __future__ import annotations

import numpy as np
import pytest

from at_once import at_once
from drives import drive_of_text
from ncgear.errors import DesignError, NoSuchMechanism, WrongInput
from ncgear.project.drive import Drive

HEAD = """
name: r
linkage: {kind: crank_rocker, crank_mm: 40, coupler_mm: 130, rocker_mm: 90, ground_mm: 140}
operation: {speed_rpm: 60}
"""
STROKE = """
motion: {law: three_segment_stroke, solve_for: law_speed, theta1_pi: 0.4, theta2_pi: 0.7, theta3_pi: 1.0,
  theta4_pi: 1.25, v1_rad_s: 3.0, v2_rad_s: 2.2, a1_rad_s2: -12, return: {basis: inverse_ratio}}
"""


def rocker(motion: str = STROKE) -> Drive:
    return drive_of_text(HEAD + motion)


def place_rad(crank: np.ndarray) -> np.ndarray:
    """The rocker's angle by the triangles of crank pin, axes and rocker pin, from its retracted end on."""
    a, b, c, d = 40.0, 130.0, 90.0, 140.0
    start = np.arccos((c**2 + d**2 - (b - a) ** 2) / (2.0 * c * d))
    # At the retracted end crank and coupler lie over each other; the crank turns clockwise, the rocker's pin is above.
    direction = np.arctan2(c * np.sin(start), d - c * np.cos(start))
    pin = a * np.exp(1j * (np.pi + direction - crank))
    to_axis = d - pin
    reach = np.abs(to_axis)
    inner = np.arccos((c**2 + reach**2 - b**2) / (2.0 * c * reach))
    return inner - np.angle(to_axis) - start


@pytest.mark.slow
def test_a_rocker_keeps_the_stroke_that_is_asked_of_it() -> None:
    made = rocker()
    speed = made.law_speed_rpm * np.pi / 30.0
    phi1 = np.linspace(0.71, 0.99, 40) * np.pi
    rate = made.machine.displacement(phi1, 1).derivative(1) * speed
    assert rate == pytest.approx(2.2, rel=1e-12)
    at_theta1 = made.machine.displacement(np.array([0.4 * np.pi]), 1).derivative(1) * speed
    assert at_theta1 == pytest.approx(3.0, rel=1e-12)
    assert made.law.stroke is not None
    assert made.law.stroke.facts["v2_rad_s"] == pytest.approx(2.2)
    turned = made.transmission.driven_angle(phi1).value
    assert made.machine.displacement(phi1, 0).value == pytest.approx(place_rad(turned), abs=1e-12)


@pytest.mark.thorough
def test_a_table_of_places_in_deg_is_met() -> None:
    stroke = float(np.degrees(rocker().linkage.stroke_mm))
    places = [0.0, 0.3 * stroke, 0.8 * stroke, stroke, 0.6 * stroke, 0.2 * stroke]
    angles = [0, 70, 140, 200, 260, 320]
    made = rocker(f"motion: {{law: table, phi1_deg: {angles}, displacement_deg: {places}}}")
    found = made.machine.displacement(np.radians(np.array(angles, dtype=float)), 0).value
    assert np.degrees(found) == pytest.approx(places, abs=1e-9)


@at_once(
    ("change", "kind", "said"),
    [
        (("v1_rad_s: 3.0", "v1_rad_s: 90"), NoSuchMechanism, "v1_rad_s: the rocker stops.*v1 under 4.1[0-9]* rad/s"),
        (("v1_rad_s: 3.0", "v1_mm_s: 90"), WrongInput, r"motion.v1_mm_s: given beside keys of an output that turns"),
        (("kind: crank_rocker, crank_mm: 40, coupler_mm: 130, rocker_mm: 90, ground_mm: 140", "crank_mm: 4, rod_mm: 9"),
         WrongInput, r"the slider of a crank-slider slides; v1_mm_s is right"),
        (("return:", "stroke_deg: 50, return:"), WrongInput, "50 deg is shorter than the linkage's stroke of 53.7"),
    ],
)  # fmt: skip
def test_refusals_are_in_the_units_of_the_output(change: tuple[str, str], kind: type[DesignError], said: str) -> None:
    with pytest.raises(kind, match=said):
        _ = drive_of_text((HEAD + STROKE).replace(*change)).law
