"""Undercut: the textbook's limits, profile shift against it, and what avoiding it leaves of flanks and tips."""

from __future__ import annotations

from math import ceil, cos, pi, radians, sin, tan

import numpy as np
import pytest
from scipy.optimize import brentq
from scipy.special import ellipe

from at_once import at_once
from ncgear.pitch.curve import PitchCurve
from ncgear.pitch.pair import sized_pair
from ncgear.pitch.shape import Gear, Mesh
from ncgear.ratio.laws.ellipse import elliptical_law
from ncgear.ratio.laws.expression import ratio_expression_law
from ncgear.ratio.laws.uniform import uniform_law
from ncgear.ratio.transmission import Lobes, Transmission
from ncgear.teeth.flank import FLANK, Flanks, flanks_of
from ncgear.teeth.form import BasicRack, TipLimits, ToothForm
from ncgear.teeth.gear import ToothedGear, ToothedPair, shift_against_undercut, teeth_free_of_undercut, toothed_pair
from ncgear.teeth.lost import shortening, undercutting
from ncgear.teeth.regular import regular_depth, regular_height
from ncgear.teeth.tips import Limit
from ncgear.teeth.tool import RackLine
from pairs import baler_law, both, pitch_pair, rack, sine_law

MODULE = 2.0
TOLERANCE = 0.01

Array = np.ndarray


def made(law: Transmission, teeth: int, basic: BasicRack | None = None, *, avoid: bool = True) -> ToothedPair:
    """A pair of gears."""
    form = ToothForm(basic or rack(), limits=TipLimits(avoid_undercut=avoid))
    return toothed_pair(pitch_pair(law, teeth), form, TOLERANCE)


def full_flank(angle_deg: float, radius: float = 0.2) -> BasicRack:
    """A rack whose straight flank ends one module below its mid line, as the textbook's does."""
    return rack(angle_deg, dedendum=1.0 + radius * (1.0 - sin(radians(angle_deg))), root_radius=radius)


# --- the textbook ------------------------------------------------------------------------------------------------


@pytest.mark.tiers(quick=["True-basic2-*", "True-basic6-*"], rest="slow")
@pytest.mark.parametrize(
    ("basic", "least"),
    [
        (full_flank(14.5), 32),  # 2 / sin^2 14.5 = 31.90
        (full_flank(20.0), 18),  # 17.097
        (full_flank(25.0), 12),  # 11.198
        (rack(), 18),  # profile A: hF is one module to 3e-5
        (rack(root_radius=0.25), 19),  # profile C: hF = 1.0855 modules, 18.56
        (rack(14.5, dedendum=1.25, root_radius=0.0), 40),  # a sharp cutter: 2.5 / sin^2 14.5 = 39.88
        (rack(25.0, dedendum=1.0, root_radius=0.0), 12),
    ],
)
@pytest.mark.parametrize("avoid", [True, False])
def test_undercut_of_circular_gears_begins_at_the_classical_number(basic: BasicRack, least: int, avoid: bool) -> None:
    """z = 2 hF / (m sin^2(alpha)), with hF the depth at which the cutter's straight flank ends."""
    theory = 2.0 * basic.flank_depth_mm / MODULE / sin(basic.pressure_angle_rad) ** 2
    assert least - 1 < theory < least
    for teeth in (least - 1, least):
        for gear in both(made(uniform_law(Lobes()), teeth, basic, avoid=avoid)):
            assert gear.undercut == (list(range(1, teeth + 1)) if teeth < least else [])
        pair = pitch_pair(uniform_law(Lobes()), teeth)
        assert teeth_free_of_undercut(pair, basic, basic) == least


# --- amounts -----------------------------------------------------------------------------------------------------


def too_deep(teeth: int, deeper_mm: float) -> BasicRack:
    """A sharp rack whose flank ends so far below the cusp of a circular gear's flank, r sin^2(alpha)."""
    return rack(dedendum=teeth / 2.0 * sin(radians(20.0)) ** 2 + deeper_mm / MODULE, root_radius=0.0)


@pytest.mark.parametrize("deeper_mm", [0.0005, 0.05])
def test_the_amount_of_an_avoided_undercut_is_what_the_rack_goes_below_the_cusp(deeper_mm: float) -> None:
    for gear in both(made(uniform_law(Lobes()), 24, too_deep(24, deeper_mm))):
        loss = undercutting(gear)
        assert loss.amount_mm == pytest.approx(deeper_mm, abs=1e-9)
        assert (loss.tooth, loss.contact_pitches) == (1, 0.0)


@pytest.mark.slow
@pytest.mark.parametrize("deeper_mm", [0.05, 0.2])
def test_the_amount_of_an_allowed_undercut_is_the_height_that_the_notch_takes(deeper_mm: float) -> None:
    """The path of the sharp corner crosses the involute above its base circle; both in polar coordinates."""
    basic, radius, angle = too_deep(24, deeper_mm), 24.0, radians(20.0)
    depth = basic.dedendum_mm

    def corner(rolled: Array) -> Array:
        """The rack's corner in the gear's frame; its flank crosses the pitch line at 0 and faces +x."""
        around = np.exp(-1j * rolled / radius)
        return (radius - depth) * 1j * around + (depth * tan(angle) - rolled) * around

    def involute_angle(at_radius: Array) -> Array:
        """Polar angle of the flank of a tooth that lies on the left, from the pitch point on."""
        opening = np.arccos(radius * cos(angle) / at_radius)
        return pi / 2.0 + (np.tan(opening) - opening) - (tan(angle) - angle)

    def beside(rolled: float) -> float:
        place = corner(np.array([rolled]))[0]
        return float(np.angle(place) - involute_angle(np.abs(place)))

    # From where the corner crosses the base circle upwards, up to the pitch circle
    upwards = np.linspace(0.0, -3.0 * MODULE, 5001) + depth / (sin(angle) * cos(angle))
    rising = [rolled for rolled in upwards if radius * cos(angle) < abs(corner(np.array([rolled]))[0]) < radius]
    values = [beside(rolled) for rolled in rising]
    crossing = next(i for i in range(len(values) - 1) if values[i] * values[i + 1] < 0.0)
    found = abs(corner(np.array([brentq(beside, rising[crossing], rising[crossing + 1])]))[0])
    # r^2 + 2 r h + h^2 / sin^2(alpha) is the square of the radius at the height h of the contact
    square = sin(angle) ** 2
    height = square * (-radius + np.sqrt(radius**2 - (radius**2 - found**2) / square))
    for gear in both(made(uniform_law(Lobes()), 24, basic, avoid=False)):
        loss = undercutting(gear)
        assert loss.amount_mm == pytest.approx(depth + height, abs=1e-6)
        assert loss.amount_mm > deeper_mm
        assert loss.contact_pitches == pytest.approx(loss.amount_mm / (sin(angle) * cos(angle)) / (pi * MODULE))


@pytest.mark.thorough
def test_the_amount_of_pointed_tips_is_that_of_the_involute_of_their_land() -> None:
    """30 tall teeth of 25 deg: the land's chord at a radius follows from the involute function."""
    basic, angle, radius = rack(25.0, addendum=1.5, dedendum=1.6, root_radius=0.05), radians(25.0), 30.0
    form = ToothForm(basic, limits=TipLimits(0.3 * MODULE, avoid_undercut=True))
    gear = toothed_pair(pitch_pair(uniform_law(Lobes()), 30), form, TOLERANCE).driving

    def land(tip: float) -> float:
        opening = np.arccos(radius * cos(angle) / tip)
        half = pi / 60.0 + (tan(angle) - angle) - (np.tan(opening) - opening)
        return 2.0 * tip * float(np.sin(half)) - 0.3 * MODULE

    tip = brentq(land, radius, radius + basic.addendum_mm)
    loss = shortening(gear, gear.tips.limit == Limit.LAND)
    assert loss.amount_mm == pytest.approx(radius + basic.addendum_mm - tip, abs=1e-9)
    assert (loss.tooth, loss.amount_mm > 0.05) == (1, True)
    square = sin(angle) ** 2
    heights = [square * (-radius + np.sqrt(radius**2 + (end**2 - radius**2) / square)) for end in (tip, radius + 3.0)]
    assert loss.contact_pitches == pytest.approx((heights[1] - heights[0]) / (sin(angle) * cos(angle)) / (pi * MODULE))


@pytest.mark.slow
@at_once("angle_deg", [14.5, 20.0, 25.0])
@at_once("teeth", [9, 11])
def test_undercut_ends_at_the_classical_profile_shift(angle_deg: float, teeth: int) -> None:
    """x = ha - z sin^2(alpha) / 2, of a gear whose mate has five times the teeth."""
    basic = full_flank(angle_deg)
    least = 1.0 - teeth * sin(radians(angle_deg)) ** 2 / 2.0
    pitch = pitch_pair(uniform_law(Lobes(1, 5)), teeth)
    for shift, undercut in ((least - 1e-6, list(range(1, teeth + 1))), (least + 1e-6, [])):
        form = ToothForm(basic, driving_shift_mm=shift * MODULE, driven_shift_mm=-shift * MODULE)
        assert toothed_pair(pitch, form, TOLERANCE).driving.undercut == undercut


@at_once("teeth", [9, 11, 15, 17])
def test_chosen_shift_is_the_least_that_frees_a_circular_gear(teeth: int) -> None:
    basic = full_flank(20.0)
    pitch = pitch_pair(uniform_law(Lobes(1, 5)), teeth)
    shift = shift_against_undercut(pitch, basic) / MODULE
    assert shift == pytest.approx(1.0 - teeth * sin(radians(20.0)) ** 2 / 2.0, abs=1e-9)
    pair = toothed_pair(pitch, ToothForm(basic, shift_for_undercut=True), TOLERANCE)
    assert pair.driving.flanks.rack.shift_mm == -pair.driven.flanks.rack.shift_mm == shift * MODULE
    assert [gear.undercut for gear in both(pair)] == [[], []]
    assert len(toothed_pair(pitch, ToothForm(basic), TOLERANCE).driving.undercut) == teeth


def test_chosen_shift_is_limited_and_halves_what_cannot_be_freed() -> None:
    few, equal = pitch_pair(uniform_law(Lobes(1, 10)), 4), pitch_pair(uniform_law(Lobes()), 10)
    assert shift_against_undercut(few, rack()) == pytest.approx(0.7 * MODULE)
    assert shift_against_undercut(equal, rack()) == pytest.approx(0.0, abs=1e-12)
    assert shift_against_undercut(pitch_pair(uniform_law(Lobes()), 30), rack()) == 0.0


@pytest.mark.tiers(slow=["18-0.0"], rest="long")
@pytest.mark.parametrize(("teeth", "expected"), [(11, 1.0 - 5.5 * sin(radians(20.0)) ** 2), (18, 0.0), (33, 0.0)])
def test_a_ring_sets_no_bound_to_the_chosen_shift(teeth: int, expected: float) -> None:
    """No tool undercuts a ring's teeth, so the driving gear takes what it needs and no more."""
    circles = sized_pair(uniform_law(Lobes(1, 3)), teeth, MODULE, None, Mesh.INTERNAL)
    assert shift_against_undercut(circles, full_flank(20.0)) == pytest.approx(expected * MODULE, abs=1e-8)
    waved = ratio_expression_law("3 + 0.2*sin(phi)", Lobes(1, 3), scale_to_close=True)
    assert shift_against_undercut(sized_pair(waved, 60, MODULE, None, Mesh.INTERNAL), rack()) == 0.0


@pytest.mark.parametrize("depth", [0.08, 0.15])
def test_chosen_shift_stands_between_both_curves_limits(depth: float) -> None:
    """Driving and driven curvatures differ: the shift gives each what it needs, or both as much too little."""
    pitch = pitch_pair(sine_law(depth), 40)
    shift = shift_against_undercut(pitch, rack())
    square, full = sin(radians(20.0)) ** 2, rack().flank_depth_mm
    spare = [
        square / pitch.curvature_range[gear][1].value - (full - own)
        for gear, own in ((Gear.DRIVING, shift), (Gear.DRIVEN, -shift))
    ]
    assert min(spare) >= -1e-9 or spare[0] == pytest.approx(spare[1], abs=1e-9)
    less = shift_against_undercut(pitch_pair(sine_law(depth), 80), rack())
    assert abs(less) <= abs(shift)


@pytest.mark.thorough
def test_chosen_shift_lets_more_contact_stand_than_none() -> None:
    for teeth in (9, 11):
        pitch = pitch_pair(uniform_law(Lobes(1, 5)), teeth)
        sums = []
        for chosen in (False, True):
            pair = toothed_pair(pitch, ToothForm(rack(), shift_for_undercut=chosen), TOLERANCE)
            sums.append(pair.driving.tips.height_mm.min() + pair.driven.tips.height_mm.min())
        assert sums[1] > 1.1 * sums[0]


# --- how many teeth are free -------------------------------------------------------------------------------------


def undercut_teeth(curve: PitchCurve, basic: BasicRack, teeth: int) -> list[int]:
    """Teeth with flanks that are not regular down to the rack's full depth."""
    own = unfitted(curve, basic, teeth)
    depth = basic.flank_depth_mm
    return sorted({int(number) for number in own.tooth[regular_depth(own, depth) < depth]})


def unfitted(curve: PitchCurve, basic: BasicRack, teeth: int) -> Flanks:
    """The flanks at full height and depth."""
    start = 0.0 if curve.gear is Gear.DRIVING else basic.pitch_mm / 2.0
    return flanks_of(curve, basic, teeth, RackLine(), start)


@pytest.mark.slow
def test_free_of_undercut_does_not_depend_on_the_teeth_at_hand() -> None:
    found = {teeth_free_of_undercut(pitch_pair(baler_law(), teeth), rack(), rack()) for teeth in (12, 25, 86, 200)}
    assert found == {86}


@pytest.mark.judges("teeth")
@at_once("eccentricity", [0.0, 0.2, 0.35, 0.5, 0.7])
def test_free_of_undercut_on_ellipses_in_closed_form(eccentricity: float) -> None:
    """Sharpest curvature 1 / (A (1 - e^2)), perimeter 4 A E(e^2) = pi m z, A being the greater half axis."""
    pair, basic = pitch_pair(elliptical_law(eccentricity, 0.3, Lobes()), 40), rack()
    squared = eccentricity**2
    exact = 4.0 * ellipe(squared) * basic.flank_depth_mm / (pi * MODULE * (1.0 - squared) * sin(radians(20.0)) ** 2)
    least = teeth_free_of_undercut(pair, basic, basic)
    assert least == ceil(exact)
    free = pitch_pair(pair.transmission, least)
    assert undercut_teeth(free.driving, basic, least) + undercut_teeth(free.driven, basic, least) == []


@pytest.mark.parametrize("lobes", [Lobes(1, 2), Lobes(3, 1), Lobes(2, 3)])
def test_free_of_undercut_gives_whole_teeth_on_both_gears(lobes: Lobes) -> None:
    pair = pitch_pair(elliptical_law(0.1, 0.0, lobes), 10 * lobes.driving)
    least = teeth_free_of_undercut(pair, rack(), rack())
    assert least * lobes.driven % lobes.driving == 0
    free = pitch_pair(pair.transmission, least)
    sides = ((free.driving, free.size.driving_teeth), (free.driven, free.size.driven_teeth))
    assert [undercut_teeth(curve, rack(), teeth) for curve, teeth in sides] == [[], []]


# --- which teeth -------------------------------------------------------------------------------------------------


def undercut_by_closed_form(gear: ToothedGear) -> list[int]:
    """Teeth on which sin^2 + h k vanishes below the pitch line, k from the law's closed form at 2001 heights."""
    own, basic = gear.flanks, rack()
    height = np.linspace(-basic.flank_depth_mm, 0.0, 2001)
    angle = own.curve.driving_angle(own.rolled_mm(np.arange(own.count)[:, None], height))
    regular = sin(basic.pressure_angle_rad) ** 2 + height * own.curve.at_angle(angle).curvature
    return sorted({int(number) for number in own.tooth[regular.min(axis=1) <= 0.0]})


@pytest.mark.tiers(slow=["3:1"], rest="long")
@pytest.mark.parametrize(
    ("law", "teeth"),
    [
        (elliptical_law(0.7, 0.0, Lobes()), 25),
        (sine_law(0.3), 48),
        (elliptical_law(0.3, 0.0, Lobes(3, 1)), 60),
        (baler_law(), 25),
        (baler_law(), 60),
    ],
    ids=["ellipse", "sine", "3:1", "baler 25", "baler 60"],
)
def test_undercut_teeth_are_those_of_the_closed_form(law: Transmission, teeth: int) -> None:
    pair = made(law, teeth)
    for gear in both(pair):
        assert gear.undercut == undercut_by_closed_form(gear)
    assert 0 < len(pair.driven.undercut) < pair.driven.teeth


# --- avoid and allow ---------------------------------------------------------------------------------------------

UNDERCUT = {
    "circular": (uniform_law(Lobes()), 12),
    "ellipse": (elliptical_law(0.7, 0.0, Lobes()), 25),
    "sine": (sine_law(0.08), 12),
    "baler": (baler_law(), 25),
}


@pytest.mark.slow
@at_once("name", UNDERCUT)
def test_avoiding_undercut_leaves_regular_flanks_down_to_their_fillets(name: str) -> None:
    for gear in both(made(*UNDERCUT[name])):
        own, sides = gear.flanks, gear.sides
        height = -own.flank_depth_mm[:, None] * np.linspace(0.0, 1.0, 101)
        assert own.regularity(np.arange(own.count)[:, None], height).min() > 0.0
        # Nothing is trimmed: every side is one flank and one fillet.
        assert sides.kind.size == 2 * own.count
        assert sides.flank_range()[1] == pytest.approx(-own.flank_depth_mm, abs=1e-12)
        assert gear.undercut


@pytest.mark.parametrize("name", ["circular", "ellipse", "sine"])
def test_allowing_undercut_leaves_full_tips_and_cuts_flanks_away(name: str) -> None:
    for gear in both(made(*UNDERCUT[name], avoid=False)):
        own = gear.flanks
        assert set(gear.tips.limit) <= {Limit.FULL, Limit.FILLET}
        assert own.flank_depth_mm == pytest.approx(rack().flank_depth_mm, rel=1e-9)
        lost = gear.sides.flank_range()[1] > -own.flank_depth_mm + 1e-9
        assert set(own.tooth[lost]) == set(gear.undercut)


def test_avoided_flanks_of_circular_gears_end_just_above_the_base_circle() -> None:
    """Their cusps are z m / 2 sin^2(alpha) below the pitch line, of which a hundredth is kept off; tips clear roots."""
    for gear in both(made(uniform_law(Lobes()), 12)):
        depth = 0.99 * 12.0 * MODULE / 2.0 * sin(radians(20.0)) ** 2
        assert gear.flanks.flank_depth_mm == pytest.approx(depth, rel=1e-9)
        clearance, rounding = 0.25 * MODULE, rack().root_radius_mm * (1.0 - sin(radians(20.0)))
        assert gear.flanks.tip_height_mm == pytest.approx(depth + rounding - clearance, rel=1e-9)
        assert gear.shortened(Limit.UNDERCUT) == list(range(1, 13))


@pytest.mark.thorough
def test_flank_kinds_left_by_undercut_are_in_order() -> None:
    """Allowed undercut leaves one run of flank and one of fillet on each side, the flank above."""
    for gear in both(made(uniform_law(Lobes()), 12, avoid=False)):
        assert list(gear.sides.kind[:4]) == [FLANK, 1, FLANK, 1]
        assert np.all(np.diff(gear.sides.owner) >= 0)


@pytest.mark.slow
@at_once("nudge", [-4, -1, 0, 1, 2, 3, 4])
def test_a_joint_just_before_the_end_of_a_range_is_its_end(nudge: int) -> None:
    """Between them there are no numbers left to tell both sides of the jump apart."""
    curve, basic = pitch_pair(baler_law(), 14).driven, rack(25.0, root_radius=0.2)
    flanks = flanks_of(curve, basic, 14, RackLine(), 1.45)
    # Heights at which some flank touches where the curvature jumps.
    heights = np.abs(curve.joints_mm[:, None] - flanks.crossing_mm) * basic.slants[0].height_per_rolled
    for height in heights[(heights > 0.5) & (heights < 5.0)]:
        limit = float(height) * (1.0 + nudge * 2.3e-16)
        near = regular_height(flanks, limit * (1.0 - 1e-9))
        assert regular_height(flanks, limit) == pytest.approx(near, rel=2e-9)
