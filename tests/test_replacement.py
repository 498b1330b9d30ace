"""The local replacement gear: flanks bend as its involute does, and places on them are found."""

from __future__ import annotations

from math import sin
from pathlib import Path

import numpy as np
import pytest

from at_once import at_once
from drives import drive
from ncgear.numerics.arrays import Array, IndexArray
from ncgear.numerics.plane import as_complex
from ncgear.pitch.shape import Gear
from ncgear.project.opened import load
from ncgear.strength.stiffness import nearest_on_flanks
from ncgear.teeth.gear import ToothedGear
from tooth_places import circular_pair, random_places

CASES = Path(__file__).parent / "cases"

GEARS = [("baler", Gear.DRIVING), ("baler", Gear.DRIVEN), ("internal-1-2", Gear.DRIVEN), ("ellipse", Gear.DRIVING)]


def measured_curvature(gear: ToothedGear, flank: IndexArray, height: Array) -> Array:
    """Size of the flanks' curvature in 1/mm, by differences of their directions."""
    step = 1e-4
    before, after = (as_complex(gear.flanks.flank(flank, height + way)[1]) for way in (-step, step))
    speed = np.abs(as_complex(gear.flanks.flank(flank, height)[1]))
    return np.asarray(np.abs(np.angle(after / before)) / (2.0 * step * speed))


def involute_curvature(gear: ToothedGear, pitch_curvature: Array, height: Array) -> Array:
    """That of the involute of a circular gear with the pitch radius 1/k, at a height over the pitch point, in 1/mm."""
    sine = sin(gear.flanks.rack.pressure_angle_rad)
    return np.asarray(pitch_curvature * sine / (sine**2 + height * pitch_curvature))


@pytest.mark.judges("strength")
@at_once(("name", "which"), GEARS)
def test_the_flank_bends_as_the_replacement_gears_involute(name: str, which: Gear) -> None:
    """By Euler and Savary, on convex and concave stretches and on a ring; baler flanks reach down to near a cusp."""
    gear = drive(name).teeth.of(which)
    places, height = random_places(gear, 300)
    assert nearest_on_flanks(gear, places).height_mm == pytest.approx(height, abs=1e-8)
    rolling = gear.flanks.at_rolled(places.flank, gear.flanks.rolled_mm(places.flank, height)).curvature
    found = np.abs(gear.flanks.curvature(places.flank, height))
    assert found == pytest.approx(np.abs(involute_curvature(gear, rolling, height)), rel=1e-9)
    assert found == pytest.approx(measured_curvature(gear, places.flank, height), rel=1e-6)


@pytest.mark.slow
def test_places_are_found_where_the_pitch_curve_bends_within_a_module() -> None:
    gear = load(CASES / "harmonics-1-100.yaml").teeth.driving
    places, height = random_places(gear, 1000)
    assert nearest_on_flanks(gear, places).height_mm == pytest.approx(height, abs=1e-8)


def test_the_gear_of_where_the_flank_crosses_the_pitch_curve_is_another_one() -> None:
    """The negative control: the equivalent gear of the whole flank misses the curvature by a tenth and more."""
    gear = drive("baler").teeth.driving
    places, height = random_places(gear, 300)
    curvature = gear.flanks.curve.at_length(gear.flanks.crossing_mm[places.flank]).curvature
    involute = np.abs(involute_curvature(gear, curvature, height))
    missed = np.abs(involute / measured_curvature(gear, places.flank, height) - 1.0)
    assert np.quantile(missed, 0.5) > 0.1


def test_on_circular_gears_it_is_the_gear_itself() -> None:
    gear = circular_pair(25).driving
    found = gear.flanks.curvature(np.array([3, 8]), np.array([1.0, -0.7]))
    assert 1.0 / np.abs(found) == pytest.approx(
        [25.0 * sin(np.radians(20.0)) + h / sin(np.radians(20.0)) for h in (1.0, -0.7)]
    )
