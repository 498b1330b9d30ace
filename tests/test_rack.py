"""The basic rack: its measures against the cutter that the brute-force oracle draws, and against closed forms."""

from __future__ import annotations

import re
from dataclasses import replace
from math import cos, pi, radians, sin, tan

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from at_once import at_once
from ncgear.errors import WrongInput
from ncgear.teeth.form import BasicRack
from oracles import rack_cut
from pairs import rack

ISO_53 = {"A": (1.25, 0.38), "B": (1.25, 0.30), "C": (1.25, 0.25), "D": (1.40, 0.39)}
"""Dedendum and root radius in modules, at an addendum of one module and 20 degrees."""


RACKS = [rack(dedendum=d, root_radius=r) for d, r in ISO_53.values()]
RACKS += [
    rack(angle_deg=14.5),
    rack(angle_deg=25.0, root_radius=0.25),
    rack(module=0.3),
    rack(module=20.0),
]


def drawn(basic: BasicRack) -> np.ndarray:
    """The oracle's cutter tooth as (u, height): from the middle of its tip's right corner the points run up again."""
    sizes = (basic.module_mm, basic.pressure_angle_rad, basic.addendum_mm, basic.dedendum_mm, basic.root_radius_mm)
    return rack_cut.rack_tooth(rack_cut.Proportions(*sizes, 0.0), basic.pitch_mm, basic.addendum_mm)


@at_once("basic", RACKS)
def test_measures_are_those_of_the_drawn_cutter(basic: BasicRack) -> None:
    right = drawn(basic)[: rack_cut.ARC_SEGMENTS + 2]
    (far, rounding), flat = right[:2], right[-1]
    share = -far[1] / (rounding[1] - far[1])
    # What the cutter's tooth and the gear's leave of the pitch is nothing.
    half_width = basic.pitch_mm / 2 - basic.tooth_half_width_mm
    assert far[0] + share * (rounding[0] - far[0]) == pytest.approx(half_width, rel=1e-14)
    assert -rounding[1] == pytest.approx(basic.flank_depth_mm, rel=1e-14)
    assert flat == pytest.approx([basic.tip_half_width_mm, -basic.dedendum_mm], rel=1e-13)


@at_once("basic", RACKS)
def test_rounding_touches_flank_and_tip(basic: BasicRack) -> None:
    angle = basic.pressure_angle_rad
    center = np.array([basic.tip_half_width_mm, basic.root_radius_mm - basic.dedendum_mm])
    on_flank = np.array([basic.pitch_mm / 2 - basic.tooth_half_width_mm, 0.0])
    normal = np.array([cos(angle), -sin(angle)])
    assert (on_flank - center) @ normal == pytest.approx(basic.root_radius_mm, rel=1e-13)
    touching = center + basic.root_radius_mm * normal
    assert touching[1] == pytest.approx(-basic.flank_depth_mm, rel=1e-13)
    assert basic.dedendum_mm - basic.flank_depth_mm == pytest.approx(basic.rounding_height_mm, rel=1e-13)


@at_once("basic", RACKS)
@at_once("coefficient", [-0.5, 0.25, 0.7])
def test_a_shifted_rack_moves_the_tooth_outwards(basic: BasicRack, coefficient: float) -> None:
    """The rack's mid line moves by x m: tips and roots with it."""
    shift = coefficient * basic.module_mm
    shifted = basic.shifted(shift)
    assert shifted.tip_height_mm == pytest.approx(basic.addendum_mm + shift, rel=1e-15)
    assert shifted.root_depth_mm == pytest.approx(basic.dedendum_mm - shift, rel=1e-15)
    unshifted = ("flank_depth_mm", "tip_half_width_mm", "rounding_height_mm", "tooth_half_width_mm")
    assert all(getattr(shifted, name) == getattr(basic, name) for name in unshifted)


@at_once(("dedendum", "root_radius"), ISO_53.values())
def test_largest_root_radius_is_the_standards_formula(dedendum: float, root_radius: float) -> None:
    """ISO 53: (pi/4 m - hfP tan(alpha)) / tan((90 deg - alpha) / 2), which the four profiles keep below."""
    basic = rack(dedendum=dedendum, root_radius=root_radius)
    formula = (pi / 4 * 2.0 - dedendum * 2.0 * tan(radians(20))) / tan(radians(35))
    assert basic.largest_root_radius_mm == pytest.approx(formula, rel=1e-14)
    assert basic.root_radius_mm < formula
    assert replace(basic, root_radius_mm=formula * (1 - 1e-12)).tip_half_width_mm == pytest.approx(0.0, abs=1e-11)


def test_profile_a_s_flank_is_as_long_as_the_mates_addendum() -> None:
    """hfP - rho (1 - sin alpha) = 1.25 - 0.38 x 0.65798 = 0.99997: why profile A's undercut limit is 17.1 teeth."""
    assert rack(module=1.0).flank_depth_mm == pytest.approx(0.9999676543, abs=1e-9)


@pytest.mark.slow
@given(
    st.floats(0.1, 50.0),
    st.floats(14.0, 26.0),
    st.floats(0.7, 1.1),
    st.floats(1.0, 1.3),
    st.floats(0.0, 0.25),
)
def test_sizes_scale_with_the_module(
    module: float, angle: float, addendum: float, dedendum: float, root_radius: float
) -> None:
    unit = rack(angle, addendum, dedendum, root_radius, module=1.0)
    large = rack(angle, addendum, dedendum, root_radius, module=module)
    for name in ("tooth_half_width_mm", "flank_depth_mm", "tip_half_width_mm"):
        # The narrowest tips are a difference of widths a hundred times as large.
        assert getattr(large, name) == pytest.approx(module * getattr(unit, name), rel=1e-12, abs=1e-15 * module)


@at_once(
    ("change", "key"),
    [
        ({"root_radius": 0.48}, "gears.rack.root_radius"),  # the tip's flat vanishes at 0.4719 modules
        ({"dedendum": 2.2, "root_radius": 0.0}, "gears.rack.root_radius"),  # the cutter is pointed at 2.158 modules
        ({"dedendum": 0.2, "root_radius": 0.35}, "gears.rack.root_radius"),  # rounded beyond the pitch line
        ({"addendum": 2.16}, "gears.rack.addendum"),
    ],
)
def test_rack_that_cannot_be_is_refused(change: dict[str, float], key: str) -> None:
    with pytest.raises(WrongInput) as caught:
        rack(**change)
    assert caught.value.key == key


@pytest.mark.parametrize(
    "change",
    [{"root_radius": 0.4719}, {"dedendum": 2.157, "root_radius": 0.0}, {"addendum": 2.157}],
)
def test_rack_just_possible_is_taken(change: dict[str, float]) -> None:
    assert rack(**change).tip_half_width_mm >= 0.0


def test_refusal_names_the_largest_radius() -> None:
    with pytest.raises(WrongInput, match=r"0\.943\d\d mm is the most") as caught:
        rack(root_radius=0.6)
    told = re.search(r"([\d.]+) mm is the most", str(caught.value))
    assert told
    rack(root_radius=float(told[1]) / rack().module_mm)
