"""The figures of a pair by their keys, against closed forms of circular gears with involute teeth."""

from __future__ import annotations

from functools import cache
from math import cos, pi, radians, sin, sqrt
from typing import Any

import pytest

from at_once import at_once
from drives import design_of
from ncgear.project.drive import Drive
from ncgear.project.figures import OF_PAIR, figures_of

TEETH, MODULE, WIDTH, BACKLASH, RPM = 40, 2.0, 12.5, 0.1, 90.0
RADIUS = TEETH * MODULE / 2.0
ALPHA = radians(20.0)
BASE = RADIUS * cos(ALPHA)
PATH = sqrt((RADIUS + MODULE) ** 2 - BASE**2) - RADIUS * sin(ALPHA)
"""Way on the line of action from the pitch point to where a tip ends the contact, with an addendum of a module."""

RATIO = 2.0 * PATH / (pi * MODULE * cos(ALPHA))

LOADED = {"contact_ratio_under_load_mean", "contact_ratio_under_load_min", "peak_tooth_force_n"}
"""What needs a load."""

SLIDING = "sliding_velocity_max_mm_s"

EXPECTED: dict[str, Any] = {
    "mesh": "external",
    "center_distance_mm": 2.0 * RADIUS,
    **{f"length_{gear}_mm": 2.0 * pi * RADIUS for gear in ("driving", "driven")},
    **{f"{gear}_convex": True for gear in ("driving", "driven")},
    **{f"min_radius_{gear}_mm": RADIUS for gear in ("driving", "driven")},
    **{f"min_concave_radius_{gear}_mm": None for gear in ("driving", "driven")},
    **{f"concave_{gear}_rad": [] for gear in ("driving", "driven")},
    "max_tangent_angle_deg": 0.0,
    "max_pressure_angle_deg": 20.0,
    "teeth_driving": TEETH,
    "teeth_driven": TEETH,
    "module_mm": MODULE,
    "face_width_mm": WIDTH,
    "backlash_mm": BACKLASH,
    "backlash_max_mm": BACKLASH,
    "play_rad": BACKLASH / BASE,
    "play_greatest_rad": BACKLASH / BASE,
    "backlash_min_rad": BACKLASH / BASE,
    "contact_ratio_mean": RATIO,
    "contact_ratio_min": RATIO,
    "overlap_ratio": 0.0,
    "transmission_error_exact_rad": 0.0,
}


@cache
def even_pair() -> Drive:
    gears = {"teeth": TEETH, "module_mm": MODULE, "face_width_mm": WIDTH, "backlash_mm": BACKLASH}
    return Drive(
        design_of(
            {
                "name": "even",
                "linkage": {"crank_mm": 40, "rod_mm": 150},
                "operation": {"speed_rpm": RPM},
                "motion": {"law": "uniform_crank"},
                "gears": {**gears, "rack": {"pressure_angle_deg": 20}},
            }
        )
    )


@pytest.mark.thorough
@at_once("key", EXPECTED)
def test_a_figure_of_an_even_pair_is_that_of_its_circles(key: str) -> None:
    found, expected = figures_of(even_pair(), key)[key], EXPECTED[key]
    if isinstance(expected, float):
        assert found == pytest.approx(expected, rel=1e-6, abs=1e-9)
    else:
        assert found == expected


@pytest.mark.thorough
def test_sliding_is_that_at_the_ends_of_the_path() -> None:
    """Teeth count as touching a little beyond, where a tip leaves its mate (tests/test_contact_extremes.py)."""
    at_ends = 2.0 * RPM * pi / 30.0 * PATH
    assert 1.0 <= figures_of(even_pair(), SLIDING)[SLIDING] / at_ends <= 1.05


def test_every_figure_that_needs_no_load_is_judged() -> None:
    # Of circles no place is the steepest
    assert set(OF_PAIR) == {*EXPECTED, *LOADED, SLIDING, "max_pressure_angle_at_rad"}
