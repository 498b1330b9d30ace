"""Fillets and root lands of every tool: closed forms of circular gears, envelopes by definition, smooth joints."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from math import cos, pi, radians, sin

import numpy as np
import pytest
from mpmath import mp

from at_once import at_once
from ncgear.pitch.pair import PitchPair, sized_pair
from ncgear.pitch.shape import Gear
from ncgear.ratio.laws.ellipse import elliptical_law
from ncgear.ratio.laws.uniform import uniform_law
from ncgear.ratio.transmission import Lobes, Transmission
from ncgear.teeth.backlash import play_of
from ncgear.teeth.fitting import fitted_pair
from ncgear.teeth.flank import Flanks, flanks_of
from ncgear.teeth.form import Backlash, BasicRack, TipLimits
from ncgear.teeth.spaces import Roots, roots_of
from ncgear.teeth.tool import PinionCircle, RackLine, Tool
from pairs import baler_law, rack, sine_law
from plane import cross, fourth_order

MODULE = 2.0
ALPHA = radians(20.0)
CUTTER_TEETH = 20

Array = np.ndarray

LAWS: dict[str, tuple[Callable[[], Transmission], int]] = {
    "uniform": (lambda: uniform_law(Lobes(1, 2)), 24),
    "ellipse": (lambda: elliptical_law(0.35, 0.0, Lobes()), 37),
    "sine": (lambda: sine_law(0.08), 40),
    "baler": (baler_law, 48),
}

TOOLS = ["rack", "pinion", "mate"]
CASES = [(name, tool) for name in LAWS for tool in TOOLS if name != "baler" or tool == "mate"]
"""The baler's curves are concave: no rack goes in, and at 48 teeth no pinion cutter that is not pointed."""


@cache
def pitch_pair(name: str) -> PitchPair:
    """The pitch curves of one of the laws at module 2."""
    return sized_pair(LAWS[name][0](), LAWS[name][1], MODULE, None)


def tools(pair: PitchPair, tool: str) -> tuple[Tool, Tool]:
    """What cuts the driving and the driven gear."""
    if tool == "mate":
        return pair.driven, pair.driving
    cutter = RackLine() if tool == "rack" else PinionCircle(CUTTER_TEETH, MODULE)
    return cutter, cutter


@cache
def cut(name: str, tool: str, backlash_mm: float = 0.0) -> dict[Gear, Flanks]:
    """Both gears' flanks as they are fitted to each other."""
    pair, basic = pitch_pair(name), rack()
    one, other = tools(pair, tool)
    play = play_of(pair, basic, Backlash(backlash_mm)).driven_rad
    gears = (
        flanks_of(pair.driving, basic, pair.size.driving_teeth, one, 0.0),
        flanks_of(pair.driven, basic, pair.size.driven_teeth, other, basic.pitch_mm / 2.0, None, play),
    )
    driving, driven = fitted_pair(*gears, TipLimits())
    return {Gear.DRIVING: driving.flanks, Gear.DRIVEN: driven.flanks}


def radius(gear: Gear) -> float:
    """Pitch radius of the uniform pair."""
    return LAWS["uniform"][1] * MODULE / 2.0 * (1.0 if gear is Gear.DRIVING else 2.0)


# --- circular gears in closed form -------------------------------------------------------------------------------

Path = Callable[[mp.mpf], tuple[mp.mpf, mp.mpf]]


def frame(gear: Gear, sigma: mp.mpf) -> tuple[mp.mpf, mp.mpf]:
    """Sense of a circular gear's arc length and polar angle of the pitch point at it."""
    sense, start = (-1, 0) if gear is Gear.DRIVING else (1, mp.pi)
    return sense, start + sense * sigma / mp.mpf(radius(gear))


def turned(along: mp.mpf, outwards: mp.mpf, sense: int, angle: mp.mpf, base: mp.mpf) -> tuple[mp.mpf, mp.mpf]:
    """A point ``along`` the tangent and ``outwards`` from the pitch point at a polar angle, in the gear's frame."""
    x, y = base + outwards, sense * along
    return x * mp.cos(angle) - y * mp.sin(angle), x * mp.sin(angle) + y * mp.cos(angle)


def rack_center(gear: Gear, basic: BasicRack, rounding: float, middle: float, side: float) -> Path:
    """Path of the centre of a rack's rounding; the rack's tooth stands in the middle of the space at ``middle``."""
    across = middle - side * mp.mpf(basic.tip_half_width_mm)
    depth = mp.mpf(basic.dedendum_mm) - mp.mpf(rounding)

    def path(sigma: mp.mpf) -> tuple[mp.mpf, mp.mpf]:
        sense, angle = frame(gear, sigma)
        return turned(across - sigma, -depth, sense, angle, mp.mpf(radius(gear)))

    return path


def pinion_center(gear: Gear, basic: BasicRack, rounding: float, middle: float, side: float) -> Path:
    """The same of a pinion cutter: on the involute parallel to its flank, one rounding below its tip circle.

    Parallel involutes have the same base circle, turned by the distance over its radius.
    """
    own = mp.mpf(CUTTER_TEETH) * MODULE / 2
    base = own * mp.cos(mp.radians(20))
    away = own + mp.mpf(basic.dedendum_mm) - mp.mpf(rounding)
    involute = [mp.tan(a) - a for a in (mp.radians(20), mp.acos(base / away))]
    half = mp.pi * MODULE / 4 / own + involute[0] - involute[1] - mp.mpf(rounding) / base

    def path(sigma: mp.mpf) -> tuple[mp.mpf, mp.mpf]:
        sense, angle = frame(gear, sigma)
        place = (middle - sigma) / own - side * half
        return turned(away * mp.sin(place), own - away * mp.cos(place), sense, angle, mp.mpf(radius(gear)))

    return path


def envelope(path: Path, rounding: float, sigma: float) -> Array:
    """What a circle cuts whose centre follows a path: the parallel curve on the gear's side, which is inwards."""
    with mp.workdps(50):
        at = mp.mpf(sigma)
        x, y = path(at)
        dx, dy = (mp.diff(lambda s, k=k: path(s)[k], at) for k in (0, 1))
        shift = mp.mpf(rounding) / mp.hypot(dx, dy)
        both = [(x + sign * shift * dy, y - sign * shift * dx) for sign in (1, -1)]
        return np.array([float(value) for value in min(both, key=lambda p: mp.hypot(*p))])


@at_once("gear", Gear)
@at_once(("tool", "center"), [("rack", rack_center), ("pinion", pinion_center)])
def test_fillet_of_a_circular_gear_is_the_trochoid_of_the_rounded_tip(
    gear: Gear, tool: str, center: Callable[[Gear, BasicRack, float, float, float], Path]
) -> None:
    own = cut("uniform", tool)[gear]
    roots = roots_of(own)
    for number in (0, 1, own.count - 3):
        side = own.side[number]
        middle = own.crossing_mm[number] + side * pi * MODULE / 4.0
        start = own.rolled_mm(np.array([number]), -own.flank_depth_mm[[number]])[0]
        rounding = own.root_radius_mm[number]
        path = center(gear, own.rack, rounding, middle, side)
        for share in (0.0, 0.3, 0.7, 0.95):
            sigma = start + share * (roots.end_mm[number] - start)
            point = own.fillet(np.array([number]), np.array([sigma]))[0][0]
            expected = envelope(path, rounding, sigma)
            # Rounding of sigma, some tens of mm, turns the frame by 1e-16; the cutter's own depth is found by a root.
            assert np.linalg.norm(point - expected) < 2e-12 * radius(gear)


def test_a_wrong_root_radius_is_another_trochoid() -> None:
    """Negative control: a thousandth of the radius moves the fillet by more than a thousandth of a tenth of it."""
    own = cut("uniform", "rack")[Gear.DRIVING]
    number = np.array([1])
    start = own.rolled_mm(number, -own.flank_depth_mm[number])[0]
    sigma = start + 0.5 * (roots_of(own).end_mm[1] - start)
    rounding, middle = 0.38 * MODULE * 1.001, own.crossing_mm[1] + pi * MODULE / 4.0
    wrong = envelope(rack_center(Gear.DRIVING, rack(root_radius=0.38 * 1.001), rounding, middle, 1.0), rounding, sigma)
    assert np.linalg.norm(own.fillet(number, np.array([sigma]))[0][0] - wrong) > 1e-5


@pytest.mark.parametrize("gear", Gear)
def test_a_circular_mate_leaves_what_a_pinion_cutter_with_its_teeth_does(gear: Gear) -> None:
    mated = cut("uniform", "mate")[gear]
    teeth = LAWS["uniform"][1] * (2 if gear is Gear.DRIVING else 1)
    pinion = flanks_of(
        mated.curve, mated.rack, mated.count // 2, PinionCircle(teeth, MODULE), mated.crossing_mm[:2].mean()
    )
    pinion = Flanks(
        pinion.curve,
        pinion.rack,
        mated.crossing_mm,
        mated.side,
        mated.tip_height_mm,
        mated.flank_depth_mm,
        mated.root_radius_mm,
        pinion.tool,
        mated.turn_rad,
        pinion.full_tip_mm,
        pinion.full_root_mm,
    )
    every = np.arange(mated.count)
    start, end = mated.rolled_mm(every, -mated.flank_depth_mm), roots_of(mated).end_mm
    assert roots_of(pinion).end_mm == pytest.approx(end, abs=1e-10)
    sigma = start[:, None] + (end - start)[:, None] * np.linspace(0.0, 1.0, 9)
    points = [flanks.fillet(every[:, None], sigma)[0] for flanks in (mated, pinion)]
    assert points[0] == pytest.approx(points[1], abs=1e-10)


# --- envelopes by definition -------------------------------------------------------------------------------------


def in_gear(own: Flanks, number: Array, sigma: Array) -> Array:
    """The rounding's centre, which rests in the tool, carried into the gear's frame by the two rolling frames."""
    at, tool = own.curve.at_length(sigma), own.tool.at_length(sigma)
    arm = own.rounding.center_mm[number] - tool.position
    along, outwards = np.sum(arm * tool.tangent, axis=-1), -np.sum(arm * tool.normal, axis=-1)
    return at.position + along[..., None] * at.tangent + outwards[..., None] * at.normal


def fillet_places(own: Flanks, share: float) -> tuple[Array, Array]:
    """Fillets at a share of their way to the root, as far as no joint of the law is near."""
    every = np.arange(own.count)
    start, end = own.rolled_mm(every, -own.flank_depth_mm), roots_of(own).end_mm
    sigma = start + share * (end - start)
    joints = own.curve.joints_around_mm
    gap = np.min(np.abs(sigma[:, None] - joints), axis=1) if joints.size else np.full(own.count, np.inf)
    return every[gap > 0.1 * MODULE], sigma[gap > 0.1 * MODULE]


@at_once(("name", "tool"), CASES)
@at_once("gear", Gear)
def test_fillet_touches_the_tools_rounding_wherever_it_is_cut(name: str, tool: str, gear: Gear) -> None:
    """At the distance of the radius from the centre's path, square to it, and on the side of the gear's material."""
    own = cut(name, tool)[gear]
    for share in (0.1, 0.5, 0.9):
        number, sigma = fillet_places(own, share)
        point, slope = own.fillet(number, sigma)
        arm = point - in_gear(own, number, sigma)
        assert np.linalg.norm(arm, axis=1) == pytest.approx(own.root_radius_mm[number], rel=1e-11)
        speed = fourth_order(lambda s, i=number: in_gear(own, i, s), sigma, 0.01 * MODULE)
        assert np.abs(np.sum(arm * speed, axis=1)).max() < 1e-6
        assert np.abs(np.sum(arm * slope, axis=1)).max() < 1e-10
        assert np.sum(arm * own.curve.at_length(sigma).normal, axis=1).max() < 0.0


@at_once(("name", "tool"), CASES)
@at_once("gear", Gear)
def test_derivatives_are_the_limits_of_fourth_order_differences(name: str, tool: str, gear: Gear) -> None:
    own = cut(name, tool)[gear]
    number, sigma = fillet_places(own, 0.4)
    slope = own.fillet(number, sigma)[1]
    coarse, fine = (
        np.linalg.norm(fourth_order(lambda s: own.fillet(number, s)[0], sigma, step) - slope, axis=1).max()
        for step in (0.02 * MODULE, 0.01 * MODULE)
    )
    assert coarse / fine == pytest.approx(16.0, rel=0.15)
    assert fine < 1e-4


@at_once(("name", "tool"), CASES)
@at_once("gear", Gear)
def test_regularity_is_the_speed_with_which_a_fillet_runs_outwards(name: str, tool: str, gear: Gear) -> None:
    """Outwards with the arc length on front flanks, against it on back flanks, where it bounds the tooth."""
    own = cut(name, tool)[gear]
    number, sigma = fillet_places(own, 0.4)
    slope, regular = own.fillet(number, sigma)[1], own.fillet_regularity(number, sigma)
    outwards = np.sum(slope * own.curve.at_length(sigma).normal, axis=1)
    assert regular.min() > 0.0
    assert np.linalg.norm(slope, axis=1) == pytest.approx(regular, rel=1e-10)
    assert np.min(own.side[number] * outwards) > 0.0


# --- joints ------------------------------------------------------------------------------------------------------


def directions(slope: Array) -> Array:
    return slope / np.linalg.norm(slope, axis=-1, keepdims=True)


@pytest.mark.tiers(quick=["*-sine-*"], rest="slow")
@pytest.mark.parametrize("backlash_mm", [0.0, 0.1])
@pytest.mark.parametrize(("name", "tool"), CASES)
@pytest.mark.parametrize("gear", Gear)
def test_flank_passes_into_fillet_tangentially(name: str, tool: str, gear: Gear, backlash_mm: float) -> None:
    own = cut(name, tool, backlash_mm)[gear]
    every, depth = np.arange(own.count), -own.flank_depth_mm
    flank, fillet = own.flank(every, depth), own.fillet(every, own.rolled_mm(every, depth))
    assert np.linalg.norm(flank[0] - fillet[0], axis=1).max() < 1e-11 * MODULE
    # Front fillets run outwards with the arc length, as the height does; back fillets against it.
    facing = np.sum(directions(flank[1]) * directions(fillet[1]), axis=1) * own.side
    assert np.abs(cross(directions(flank[1]), directions(fillet[1]))).max() < 1e-9
    assert facing.min() > 0.0


def lands_at(roots: Roots, own: Flanks) -> tuple[tuple[Array, Array], tuple[Array, Array]]:
    """Points and derivatives of the root lands at their beginnings and ends."""
    start, end = roots.lands()
    every = np.arange(own.count // 2)
    return roots.land(every, start), roots.land(every, end)


@at_once(("name", "tool"), CASES)
@at_once("gear", Gear)
def test_fillet_passes_into_the_root_land_tangentially(name: str, tool: str, gear: Gear) -> None:
    own = cut(name, tool)[gear]
    roots = roots_of(own)
    every = np.arange(own.count)
    point, slope = own.fillet(every, roots.end_mm)
    begin, end = lands_at(roots, own)
    back = np.roll(every[::2], -1)
    for fillets, land in ((every[1::2], begin), (back, end)):
        assert np.linalg.norm(point[fillets] - land[0], axis=1).max() < 1e-9 * MODULE
        assert np.abs(cross(directions(slope[fillets]), directions(land[1]))).max() < 1e-8
        # The tool's edge touches ahead of where it comes from: lands run with the arc length, fillets against it.
        assert np.sum(slope[fillets] * land[1], axis=1).max() < 0.0


@at_once("name", ["uniform", "ellipse", "sine"])
@at_once("gear", Gear)
def test_a_rack_of_even_height_leaves_the_parallel_curve_at_its_dedendum(name: str, gear: Gear) -> None:
    own = cut(name, "rack")[gear]
    roots = roots_of(own)
    start, end = roots.lands()
    depth = own.root_depth_mm[1::2]
    sigma = start + 0.3 * (end - start)
    point, slope = roots.land(np.arange(own.count // 2), sigma)
    parallel = own.offset(sigma, -depth)
    assert point == pytest.approx(parallel[0], abs=1e-10)
    assert slope == pytest.approx(parallel[1], abs=1e-10)
    assert end - start == pytest.approx(2.0 * own.rack.tip_half_width_mm, abs=1e-9)


@at_once(("name", "tool"), CASES)
@at_once("gear", Gear)
def test_derivative_of_the_root_land_is_its_limit(name: str, tool: str, gear: Gear) -> None:
    own = cut(name, tool)[gear]
    roots = roots_of(own)
    start, end = roots.lands()
    every = np.arange(own.count // 2)
    sigma = start + 0.4 * (end - start)
    joints = own.curve.joints_around_mm
    if joints.size:
        clear = np.min(np.abs(sigma[:, None] - joints), axis=1) > 0.1 * MODULE
        every, sigma = every[clear], sigma[clear]
    slope = roots.land(every, sigma)[1]
    errors = [
        np.linalg.norm(fourth_order(lambda s: roots.land(every, s)[0], sigma, step) - slope, axis=1).max()
        for step in (0.04 * MODULE, 0.02 * MODULE)
    ]
    # A land is nearly the pitch curve: its fifth derivative is so small that rounding stops the fall of some.
    assert errors[1] < max(errors[0] / 12.0, 1e-10)
    assert errors[1] < 1e-6


def test_depth_at_which_a_root_land_folds() -> None:
    """On a circle a rack's edge folds at the depth of the radius itself; a mate's at 1 / (1/R1 + 1/R2)."""
    for tool, expected in (("rack", 24.0), ("mate", 16.0)):
        own = cut("uniform", tool)[Gear.DRIVING]
        start, end = roots_of(own).lands()
        depth, limit = roots_of(own).folding(np.arange(24), (start + end) / 2.0)
        assert limit == pytest.approx(expected, rel=1e-9)
        # A mate's straight edge comes a little less deep between its roundings.
        assert depth == pytest.approx(own.root_depth_mm[1::2], abs=1e-9 if tool == "rack" else 0.01)
        assert np.all(depth <= own.root_depth_mm[1::2] + 1e-9)


def test_a_tip_of_even_height_ends_its_roundings_right_under_the_pitch_point() -> None:
    own = cut("ellipse", "rack")[Gear.DRIVEN]
    assert roots_of(own).end_mm == pytest.approx(own.rounding.lowest_mm, abs=1e-10)
    expected = own.crossing_mm + own.side * (own.rack.pitch_mm / 4.0 - own.rack.tip_half_width_mm)
    assert own.rounding.lowest_mm == pytest.approx(expected, abs=1e-10)


def test_a_rounding_touches_the_flank_at_its_end() -> None:
    """The rounding's centre stands one radius off the flank's end, along the normal that leads to the pitch point."""
    for name, tool in CASES:
        own = cut(name, tool)[Gear.DRIVEN]
        every = np.arange(own.count)
        sigma = own.rolled_mm(every, -own.flank_depth_mm)
        touching = own.flank(every, -own.flank_depth_mm)[0]
        towards = own.curve.at_length(sigma).position - touching
        expected = touching + own.root_radius_mm[:, None] * directions(towards)
        assert in_gear(own, every, sigma) == pytest.approx(expected, abs=1e-10)
        assert np.linalg.norm(towards, axis=1) == pytest.approx(own.flank_depth_mm / sin(ALPHA), rel=1e-11)


def test_a_pinion_cutters_flank_is_as_deep_as_its_rounding_leaves_it() -> None:
    """Its rounding begins where the base circle's tangent through the rounding's centre leads one radius on."""
    basic, cutter = rack(), PinionCircle(CUTTER_TEETH, MODULE)
    depth = cutter.flank_depth_mm(basic.slants[0], np.array([basic.dedendum_mm]), np.array([basic.root_radius_mm]))[0]
    base = cutter.radius_mm * cos(ALPHA)
    center = cutter.radius_mm + basic.dedendum_mm - basic.root_radius_mm
    reach = np.sqrt(center**2 - base**2) + basic.root_radius_mm
    # On the line of action, from the pitch point on: R sin(alpha) + f / sin(alpha) is the involute's generating line.
    assert cutter.radius_mm * sin(ALPHA) + depth / sin(ALPHA) == pytest.approx(reach, rel=1e-13)
    flat = RackLine().flank_depth_mm(basic.slants[0], np.array([basic.dedendum_mm]), np.array([basic.root_radius_mm]))[
        0
    ]
    assert flat == pytest.approx(basic.flank_depth_mm, rel=1e-14)
