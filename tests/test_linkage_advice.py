"""The transmission angle of a linkage against triangles drawn by other code, and where friction locks.

Each judge computes the angle from lengths and sampled crank angles; the limit is found by the work of all forces.
"""

from __future__ import annotations

from math import asin, degrees, pi, radians

import numpy as np
import pytest

from drives import design_of, drive
from ncgear.figures.advice.linkage_advice import FLATTEST_DEG, FRICTION, transmission_angle
from ncgear.figures.numbers import to_digits
from ncgear.project.drive import Drive

OPEN = {"law": "function_generator", "function": "x", "x_from": 1, "x_to": 2, "driving_range_deg": 200}
EVEN = {"law": "ratio_expression", "ratio": "1 - 0.2*cos(phi)", "scale_to_close": True}


def told(linkage: dict[str, object], motion: dict[str, object] = EVEN) -> str:
    """What is found of a linkage without gears; empty where nothing is."""
    made = design_of({"name": "a", "operation": {"speed_rpm": 30}, "linkage": linkage, "motion": motion})
    found = transmission_angle(Drive(made))
    return found.what if found else ""


@pytest.mark.parametrize(("rod", "offset"), [(61.0, 0.0), (100.0, 39.0), (100.0, -39.0)])
def test_a_steep_rod_is_told_with_its_angle_and_place(rod: float, offset: float) -> None:
    said = told({"crank_mm": 60.0, "rod_mm": rod, "offset_mm": offset})
    across = np.abs(60.0 * np.sin(np.linspace(0.0, 2.0 * pi, 100_001)) - offset)
    assert f"falls to {to_digits(90.0 - degrees(asin(across.max() / rod)), 3)} deg" in said


def test_the_place_is_where_the_pin_is_farthest_from_the_slider_s_line() -> None:
    """The crank of an in-line slider is square to its line at phi2 = 90 deg, where phi1 - 0.2 sin(phi1) is."""
    phi1 = np.linspace(0.0, pi, 1_000_001)
    at = degrees(phi1[np.argmin(np.abs(phi1 - 0.2 * np.sin(phi1) - 0.5 * pi))])
    said = told({"crank_mm": 60.0, "rod_mm": 61.0}, {**EVEN, "ratio": "1/(1 - 0.2*cos(phi))"})
    assert any(f"phi1 = {to_digits(one, 4)} deg" in said for one in (at, 360.0 - at))


@pytest.mark.parametrize(("rocker", "least"), [(65.5, 10.8), (80.0, None)])
def test_a_rocker_s_angle_is_that_of_the_triangle_of_coupler_rocker_and_pin(rocker: float, least: float | None) -> None:
    lengths = {"crank_mm": 15.0, "coupler_mm": 50.0, "rocker_mm": rocker, "ground_mm": 100.0}
    reach = np.abs(15.0 * np.exp(1j * np.linspace(0.0, 2.0 * pi, 100_001)) - 100.0)
    cosine = np.abs(50.0**2 + rocker**2 - reach**2) / (100.0 * rocker)
    own = degrees(np.arccos(cosine.max()))
    assert (own < FLATTEST_DEG) == (least is not None)
    said = told({"kind": "crank_rocker", **lengths})
    assert said.partition(" at")[0] == (f"the transmission angle falls to {to_digits(own, 3)} deg" if least else "")


@pytest.mark.parametrize(("pivot", "locks"), [(30.5, True), (32.0, False)])
def test_a_lever_leans_most_at_its_dead_centres(pivot: float, locks: bool) -> None:
    said = told({"kind": "slotted_lever", "crank_mm": 30.0, "pivot_mm": pivot, "lever_mm": 80.0})
    assert (to_digits(90.0 - degrees(asin(30.0 / pivot)), 3) in said) == locks
    assert bool(said) == locks


@pytest.mark.parametrize(("rod", "locks"), [(61.75, True), (61.95, False)])
def test_it_is_told_where_the_guide_s_friction_eats_the_push(rod: float, locks: bool) -> None:
    """Along its line a slider of the steepest rod is pushed by cos(b) less the friction of the guide, sin(b) each N."""
    steepest = asin(60.0 / rod)
    assert (np.cos(steepest) < FRICTION * np.sin(steepest)) == locks
    assert bool(told({"crank_mm": 60.0, "rod_mm": rod})) == locks


@pytest.mark.parametrize(("range_deg", "locks"), [(60.0, False), (85.0, True), (120.0, True)])
def test_gears_that_turn_less_than_once_are_judged_where_they_turn(range_deg: float, locks: bool) -> None:
    said = told({"crank_mm": 60.0, "rod_mm": 61.0}, {**OPEN, "driven_range_deg": range_deg})
    steepest = asin(60.0 * np.sin(radians(min(range_deg, 90.0))) / 61.0)
    assert said == "" if not locks else f"falls to {to_digits(90.0 - degrees(steepest), 3)} deg" in said


@pytest.mark.parametrize("name", ["baler", "rocker-drive", "quick-return-shaper", "scotch-yoke-pump", "rack-feed"])
def test_shipped_linkages_do_not_lock(name: str) -> None:
    assert transmission_angle(drive(name)) is None
