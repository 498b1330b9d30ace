"""What a refusal says would be right is right: the told value, typed in as it stands, is not refused again."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from at_once import at_once
from drives import drive_of_text
from ncgear.errors import DesignError
from ncgear.numerics.bounds import rounded_up, shown_above, shown_below
from ncgear.pitch.shape import Gear
from ncgear.project.gear_solids import SOON

BASE = """\
name: bounds
linkage: {{crank_mm: 38.123457, rod_mm: {rod}, offset_mm: 7.1234567}}
operation: {{speed_rpm: 60}}
motion: {{law: harmonic_ratio, cosine: [0.1]}}
gears: {{teeth: 23, module_mm: 1.2345678, face_width_mm: 10.1234567, backlash_mm: {backlash}{more}}}
output: {{chord_tolerance_mm: {chord}}}
masses: {{slider_kg: 1, rod: {{mass_kg: 0.7, center_mm: 41.333333, inertia_kg_mm2: 300}}, crank: {{mass_kg: 0.4, \
center_mm: 41.3333, inertia_kg_mm2: {inertia}}}, driving_gear_kg_mm2: 50, driven_gear_kg_mm2: 50}}
simulation: {{stiffness_n_mm: {stiffness}}}
"""

RIGHT = {
    "rod": "96",
    "backlash": "0.05",
    "chord": "0.005",
    "inertia": "3000",
    "stiffness": "100000",
    "more": "",
}


def text_with(**given: str) -> str:
    return BASE.format(**{**RIGHT, **given})


def teeth(text: str) -> None:
    drive = drive_of_text(text)
    _ = drive.meshing if "stiffness_n_mm: 1e" in text or "stiffness_n_mm: 0" in text else drive.teeth


def refused(text: str) -> str:
    with pytest.raises(DesignError) as caught:
        teeth(text)
    return caught.value.problem


BOUNDS: list[tuple[str, str, str]] = [
    ("inertia", "100", r"([\d.e+-]+) or over is right"),
    ("chord", "0.9", r"; ([\d.e+-]+) mm or less is right"),
    ("rod", "40", r"a rod over ([\d.e+-]+) mm works"),
    ("more", ", tolerances: {tooth_thickness_upper_mm: 0.5, tooth_thickness_lower_mm: 0}", r"; ([\d.e+-]+) mm or less"),
]


@at_once(("key", "wrong", "told"), BOUNDS)
def test_a_told_bound_is_accepted(key: str, wrong: str, told: str) -> None:
    said = refused(text_with(**{key: wrong}))
    found = re.search(told, said)
    assert found, said
    right = found[1] if key != "more" else wrong.replace("0.5", found[1])
    teeth(text_with(**{key: right}))


@pytest.mark.slow
@pytest.mark.long
@pytest.mark.parametrize("name", ["pusher", "baler-66-two-stage"])
def test_the_finest_chord_tolerance_that_is_told_is_the_finest(name: str) -> None:
    """All pairs are made with it, within the limits of their thickness too; with a little less they are refused."""
    design = Path(f"designs/{name}.yaml").read_text("utf-8")

    def made(tolerance_mm: str) -> None:
        drive = drive_of_text(f"{design}\noutput: {{chord_tolerance_mm: {tolerance_mm}}}\n")
        for pair in drive.by_stage:
            _ = pair.teeth, pair.thickness_band

    def finest_over(tolerance_mm: str) -> str:
        with pytest.raises(DesignError, match=r"mm or more is right") as caught:
            made(tolerance_mm)
        found = re.search(r"; ([\d.e+-]+) mm or more is right", caught.value.problem)
        assert found
        return found[1]

    finest = finest_over("1e-9")
    made(finest)
    assert finest_over(f"{0.998 * float(finest):.12g}") == finest


@pytest.mark.slow
@pytest.mark.parametrize("name", ["desk-toy", "ellipse"])
def test_a_chord_tolerance_is_told_with_which_a_build_is_done_soon(name: str) -> None:
    """Its outlines have the points of half a minute, to a tenth; those of the finest have many times more."""
    design = re.sub(r"\noutput:.*", "", Path(f"designs/{name}.yaml").read_text("utf-8"))
    with pytest.raises(DesignError, match="a build takes minutes under") as caught:
        _ = drive_of_text(f"{design}\noutput: {{chord_tolerance_mm: 1e-11}}\n").teeth
    found = re.search(r"; ([\d.e+-]+) mm or more is right; .* under ([\d.e+-]+) mm", caught.value.problem)
    assert found
    finest, soon = (drive_of_text(f"{design}\noutput: {{chord_tolerance_mm: {one}}}\n").teeth for one in found.groups())
    points, many = (max(len(one.of(gear).outline_mm) for gear in Gear) for one in (soon, finest))
    assert 0.85 * SOON < points < 1.1 * SOON
    assert many > 3 * SOON


@pytest.mark.slow
@pytest.mark.parametrize("wrong", ["1e-9", "1e15"])
def test_a_told_stiffness_is_one_that_teeth_may_have(wrong: str) -> None:
    said = refused(text_with(stiffness=wrong))
    found = re.search(r"([\d.e+-]+) or (more|less) is right", said)
    assert found, said
    drive = drive_of_text(text_with(stiffness=found[1]))
    _ = drive.meshing


@pytest.mark.parametrize(("shown", "way"), [(shown_above, 1), (shown_below, -1)])
def test_a_bound_is_on_its_side_and_near(shown: Callable[..., str], way: int) -> None:
    """Of numbers of all sizes, and of such that are next to a rounded one; rounding to nearest fails half of them."""
    rng = np.random.default_rng(5)
    sizes = np.concatenate([rng.uniform(1.0, 10.0, 2000) * 10.0 ** rng.integers(-8, 9, 2000), [0.1, 0.3, 7.0, 1e5]])
    values = [*sizes, *np.nextafter([float(f"{x:.5g}") for x in sizes], np.inf), *-sizes]
    for value in values:
        assert 0.0 <= way * (float(shown(value)) - value) <= 1.001e-4 * abs(value)
        assert 0.0 <= way * (float(shown(value, 3)) - value) <= 1.001e-2 * abs(value)
    nearest = np.array([float(f"{value:.5g}") for value in values])
    assert np.mean(way * (nearest - values) < 0.0) > 0.3


@pytest.mark.parametrize("step", [0.005, 0.001, 0.0001])
def test_a_multiple_of_a_step_is_the_least_that_is_not_below(step: float) -> None:
    multiples = [float(f"{k * step:.9g}") for k in range(400)]
    assert [rounded_up(value, step) for value in multiples] == multiples
    values = np.random.default_rng(6).uniform(0.0, 2.0, 500)
    told = np.array([rounded_up(value, step) for value in values])
    assert 0.0 <= (told - values).min() <= (told - values).max() < step
