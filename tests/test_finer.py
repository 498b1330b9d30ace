"""Values that trials tell: against trying every number, and put into the file."""

from __future__ import annotations

import pytest

from at_once import at_once
from drives import drive_of_text
from ncgear.drivetrain.shafts import LEAST_SAFETY
from ncgear.project.drivetrain import MOST_TIMES, _thick_enough_mm
from ncgear.project.finer import fewest
from ncgear.tolerances.iso286 import distance_deviation_mm


@at_once("each", [1, 3])
@at_once("least", [25, 40, 41, 99, 240])
def test_the_fewest_that_do_are_found_as_by_trying_all(least: int, each: int) -> None:
    tried = []

    def does(count: int) -> bool:
        tried.append(count)
        return count >= least

    low = 24
    assert fewest(does, low, 240, each) == next(n for n in range(low + each, 241, each) if n >= least)
    assert len(tried) <= 14
    # Negative control: what never does is not found, and neither is what nobody has time for
    assert fewest(lambda count: False, low, 240, each) == 0
    assert fewest(lambda count: None, low, 240, each) == 0


def test_the_diameter_that_is_told_holds_and_a_little_less_does_not() -> None:
    class Held:
        def __init__(self, diameter_mm: float) -> None:
            self.fatigue = (diameter_mm / 20.0) ** 2.7
            self.yielding = 2.0 * self.fatigue

    found = _thick_enough_mm(Held, 10.0, Held(10.0))  # type: ignore[arg-type]
    assert found is not None
    assert Held(found).fatigue >= LEAST_SAFETY > Held(0.99 * found).fatigue
    assert _thick_enough_mm(Held, 30.0, Held(30.0)) is None  # type: ignore[arg-type]
    # Ten times the diameter does not hold either
    assert _thick_enough_mm(Held, 1.0 / MOST_TIMES, Held(1.0 / MOST_TIMES)) is None  # type: ignore[arg-type]


def test_distances_below_the_standards_sizes_have_deviations_in_proportion() -> None:
    assert distance_deviation_mm(2.0) == distance_deviation_mm(1.0) == 0.005
    assert distance_deviation_mm(1e-6) == pytest.approx(0.005e-6)


def test_damping_is_full_at_the_same_share_of_every_module() -> None:
    text = """\
name: press
linkage: {{crank_mm: {0:g}, rod_mm: {1:g}}}
operation: {{speed_rpm: 60}}
motion: {{law: uniform_crank}}
resistance: {{polynomial_n: [400]}}
gears: {{teeth: 19, module_mm: {2:g}, face_width_mm: {3:g}}}
"""
    large, small = (drive_of_text(text.format(*(size * one for one in (30, 90, 3, 20)))) for size in (1.0, 1e-3))
    depths = [drive.meshing.impact.full_damping_depth_mm for drive in (large, small)]
    assert depths == pytest.approx([2e-3, 2e-6])
