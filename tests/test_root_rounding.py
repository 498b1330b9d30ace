"""Radii of the roundings at the roots: how roundings move as they grow, and the largest that fit, by bisection."""

from __future__ import annotations

import re
from math import radians

import numpy as np
import pytest
from scipy.optimize import brentq

from at_once import at_once
from drives import drive
from ncgear.errors import WrongInput
from ncgear.pitch.shape import Gear
from ncgear.teeth.flank import Flanks
from ncgear.teeth.form import BasicRack, ToothForm
from ncgear.teeth.root_radius import largest_root_radius
from ncgear.teeth.spaces import LEAST_FLAT
from ncgear.teeth.tool import PinionCircle, RackLine, Tool, rounding_of, rounding_rates
from pairs import baler_law, pitch_pair, rack

Array = np.ndarray
MODULE = 2.0
PAIR = pitch_pair(baler_law(), 48)
FORM = ToothForm(rack())
TOOLS: dict[str, Tool] = {"rack": RackLine(), "pinion": PinionCircle(20, MODULE), "mate": PAIR.driven}
COUNT = 60


def roundings(tool: Tool, growth: Array | float, deeper: float) -> tuple[Array, Array, tuple]:
    """Places and depths of roundings whose radius has grown, while flanks get deeper by a share of that."""
    slant, side = FORM.rack.slants[0], np.tile([-1.0, 1.0], COUNT // 2)
    crossing, radius = np.linspace(0.0, 250.0, COUNT), np.linspace(0.1, 0.7, COUNT) + growth
    depth = 1.9 + deeper * growth + np.zeros(COUNT)
    found = rounding_of(tool, MODULE, slant, crossing, side, depth, radius)
    rates = rounding_rates(tool, slant, crossing, side, (depth, np.full(COUNT, deeper)), radius, found)
    return found.lowest_mm, found.depth_mm, rates


@at_once("deeper", [0.0, -0.66, 0.4])
@at_once("tool", list(TOOLS))
def test_rates_of_roundings_are_the_limits_of_differences(tool: str, deeper: float) -> None:
    """Fourth order, with steps whose error is next to rounding."""
    step = 1e-3
    away = {n: roundings(TOOLS[tool], n * step, deeper)[:2] for n in (-2, -1, 1, 2)}
    rates = roundings(TOOLS[tool], 0.0, deeper)[2]
    for number, rate in enumerate(rates):
        near, far = (away[n][number] - away[-n][number] for n in (1, 2))
        assert rate == pytest.approx((8.0 * near - far) / (12.0 * step), abs=2e-9)


@pytest.mark.parametrize("tool", ["pinion", "mate"])
def test_rates_without_the_tools_curvature_are_told(tool: str) -> None:
    """The negative control: those of a rack differ by far more."""
    apart = np.abs(roundings(TOOLS[tool], 0.0, -0.66)[2][0] - roundings(TOOLS["rack"], 0.0, -0.66)[2][0])
    assert np.max(apart) > 1e-2


def flat_mm(flanks: Flanks, tooth: int, radius: float) -> float:
    """The flat of the mate's tip between its roundings in the space after a tooth, less what its ends differ by.

    The places right under which the roundings stand are sought by Brent's method on the tool's curve.
    """
    front, back = 2 * tooth + 1, (2 * tooth + 2) % flanks.count
    sine, cosine = np.sin(flanks.rack.pressure_angle_rad), np.cos(flanks.rack.pressure_angle_rad)
    ends = []
    for flank, side in ((front, 1.0), (back, -1.0)):
        depth = flanks.flank_depth_mm[flank]
        crossing = flanks.crossing_mm[flank] + (flanks.curve.length_mm if flank == 0 else 0.0)
        at = flanks.tool.at_length(np.array(crossing + side * depth / (sine * cosine)))
        # From where the flank ends, one radius along its normal, which leads through the pitch point.
        touched = at.position + side * depth * cosine / sine * -at.tangent + depth * at.normal
        arm = at.position - touched
        center = touched + radius * arm / np.linalg.norm(arm)

        def ahead(sigma: float, center: Array = center) -> float:
            foot = flanks.tool.at_length(np.array(sigma))
            return float((center - foot.position) @ foot.tangent)

        lowest = brentq(ahead, *(crossing + flanks.rack.module_mm * np.array([-3.0, 3.0])), xtol=1e-14)
        foot = flanks.tool.at_length(np.array(lowest))
        ends.append((lowest, float((center - foot.position) @ foot.normal) + radius))
    return ends[1][0] - ends[0][0] - abs(ends[1][1] - ends[0][1])


@pytest.mark.judges("teeth")
@pytest.mark.parametrize("gear", list(Gear))
def test_radii_of_narrow_spaces_are_those_of_bisection(gear: Gear) -> None:
    """The flat is what is least asked for; a radius a thousandth greater leaves less (the negative control)."""
    flanks = drive("baler").teeth.of(gear).flanks
    least = LEAST_FLAT * flanks.rack.module_mm
    judged = 0
    for tooth in range(0, flanks.teeth, 4):
        radius = float(flanks.root_radius_mm[2 * tooth + 1])
        flat = flat_mm(flanks, tooth, radius)
        assert flat >= least - 1e-12
        if flat > least + 1e-9:
            continue
        low, high = 0.0, 1.01 * radius
        for _ in range(45):
            middle = (low + high) / 2.0
            low, high = (middle, high) if flat_mm(flanks, tooth, middle) >= least else (low, middle)
        assert radius == pytest.approx(low, abs=1e-10)
        assert flat_mm(flanks, tooth, 1.001 * radius) < least
        judged += 1
    assert judged > 3


# --- a rack that is pointed at its depth


SOLUTIONS = re.compile(r"gears\.rack\.(\w+): ([\d.]+)(?: is usual, ([\d.]+) the most)?")


@at_once(("dedendum", "radius", "angle_deg"), [(2.3, 0.2, 20.0), (2.5, 0.9, 20.0), (2.2, 0.35, 25.0), (2.9, 0.0, 17.5)])
def test_a_pointed_rack_is_told_a_dedendum_that_fits_with_its_root_radius(
    dedendum: float, radius: float, angle_deg: float
) -> None:
    def rack_of(dedendum: float, root_radius: float) -> BasicRack:
        return BasicRack(MODULE, radians(angle_deg), MODULE, dedendum * MODULE, root_radius * MODULE)

    with pytest.raises(WrongInput, match="it is pointed") as refused:
        rack_of(dedendum, radius)
    told = [(key, float(value), most) for key, value, most in SOLUTIONS.findall(refused.value.problem)]
    right = {"dedendum": dedendum, "root_radius": radius, **{key: value for key, value, _ in told}}
    assert rack_of(**right).tip_half_width_mm >= 0.0
    assert right["dedendum"] > 1.0
    for most in (float(most) for _, _, most in told if most):
        rack_of(most, radius)
        with pytest.raises(WrongInput):
            rack_of(most * 1.01, radius)


def test_a_rounding_begins_no_higher_than_the_mid_line() -> None:
    """On a shallow tooth the depth beside the flatter flank decides, on a deep one the flat of the tip."""
    flatter, steeper = radians(15.0), radians(25.0)
    for angles in ((flatter, steeper), (steeper, flatter)):
        assert largest_root_radius(angles, 0.2, np.pi / 4.0) == pytest.approx(0.2 / (1.0 - np.sin(flatter)))
    # ISO 53: both roundings meet in the middle of the tip.
    angle = radians(20.0)
    iso = (np.pi / 4.0 - 1.25 * np.tan(angle)) / ((1.0 - np.sin(angle)) / np.cos(angle))
    assert largest_root_radius((angle, angle), 1.25, np.pi / 4.0) == pytest.approx(iso)
