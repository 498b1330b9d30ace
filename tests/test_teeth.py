"""Teeth: which are undercut or pointed by theory, outlines against brute-force cutting, and what is refused."""

from __future__ import annotations

from contextlib import nullcontext
from dataclasses import replace
from math import cos, degrees, pi, radians, sin
from pathlib import Path

import numpy as np
import pytest
import shapely
from scipy.optimize import brentq
from scipy.special import ellipe
from shapely import Polygon

from ncgear.errors import NoSuchMechanism
from ncgear.machine.rack import BasicRack
from ncgear.pitch.curve import PitchCurve
from ncgear.pitch.pair import PitchPair, sized_pair
from ncgear.pitch.shape import Gear
from ncgear.ratio.laws.ellipse import elliptical_law
from ncgear.ratio.laws.uniform import uniform_law
from ncgear.ratio.transmission import Lobes, Transmission
from ncgear.teeth.flank import flanks_of
from ncgear.teeth.gear import ToothedGear, teeth_free_of_undercut, toothed_gear, toothed_pair
from ncgear.teeth.sides import refuse_folded_lands, regular_sides
from oracles import rack_cut
from pairs import baler_law, rack, sine_law

MODULE = 2.0
DESIGNS = Path(__file__).parents[1] / "designs"

Array = np.ndarray


def pitch_pair(law: Transmission, teeth: int, module: float = MODULE) -> PitchPair:
    """Pitch curves for so many driving teeth."""
    return sized_pair(law, teeth, module, None)


def undercut_teeth(curve: PitchCurve, basic: BasicRack, teeth: int) -> list[int]:
    """Undercut teeth before anything is trimmed."""
    own = flanks_of(curve, basic, teeth, tooth_at_zero=curve.gear is Gear.DRIVING)
    return sorted({int(number) for number in own.tooth[regular_sides(own)[0].undercut]})


def involute(angle: Array | float) -> Array:
    """Involute function."""
    return np.tan(angle) - np.asarray(angle)


# --- undercut ----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("basic", "least"),
    [
        (rack(), 18),  # 2 hF / sin^2 20 = 17.097
        (rack(dedendum=1.25, root_radius=0.25), 19),  # profile C: hF = 1.0855 modules, 18.56
        (rack(14.5), 31),  # hF = 0.96514 modules, 30.79
        (rack(14.5, dedendum=1.25, root_radius=0.0), 40),  # a sharp cutter: 2.5 / sin^2 14.5 = 39.88
        (rack(25.0, root_radius=0.25), 13),  # hF = 1.10566 modules, 12.38
        (rack(25.0, dedendum=1.0, root_radius=0.0), 12),  # 2 / sin^2 25 = 11.198
    ],
)
def test_undercut_of_circular_gears_begins_at_the_classical_number(basic: BasicRack, least: int) -> None:
    """z = 2 hF / (m sin^2(alpha)), with hF the depth at which the cutter's straight flank ends."""
    depth = basic.dedendum_mm - basic.root_radius_mm * (1.0 - sin(basic.pressure_angle_rad))
    theory = 2.0 * depth / MODULE / sin(basic.pressure_angle_rad) ** 2
    assert least - 1 < theory < least
    for teeth in (least - 1, least):
        pair = pitch_pair(uniform_law(Lobes()), teeth)
        for curve in (pair.driving, pair.driven):
            expected = list(range(1, teeth + 1)) if teeth < least else []
            assert undercut_teeth(curve, basic, teeth) == expected
        assert teeth_free_of_undercut(pair, basic) == least


def test_free_of_undercut_does_not_depend_on_the_teeth_at_hand() -> None:
    numbers = {teeth_free_of_undercut(pitch_pair(baler_law(), teeth), rack()) for teeth in (12, 25, 86, 200)}
    assert numbers == {86}


@pytest.mark.parametrize("eccentricity", [0.0, 0.2, 0.35, 0.5, 0.7])
def test_free_of_undercut_on_ellipses_in_closed_form(eccentricity: float) -> None:
    """Sharpest curvature 1 / (A (1 - e^2)), perimeter 4 A E(e^2) = pi m z, A being the greater half axis."""
    pair, basic = pitch_pair(elliptical_law(eccentricity, 0.3, Lobes()), 40), rack()
    squared = eccentricity**2
    exact = 4.0 * ellipe(squared) * basic.flank_depth_mm / (pi * MODULE * (1.0 - squared) * sin(radians(20.0)) ** 2)
    least = teeth_free_of_undercut(pair, basic)
    assert least == int(np.ceil(exact))
    free = pitch_pair(pair.transmission, least)
    assert undercut_teeth(free.driving, basic, least) + undercut_teeth(free.driven, basic, least) == []


@pytest.mark.parametrize("lobes", [Lobes(1, 2), Lobes(3, 1), Lobes(2, 3)])
def test_free_of_undercut_gives_whole_teeth_on_both_gears(lobes: Lobes) -> None:
    pair = pitch_pair(elliptical_law(0.1, 0.0, lobes), 10 * lobes.driving)
    least = teeth_free_of_undercut(pair, rack())
    assert least * lobes.driven % lobes.driving == 0
    free = pitch_pair(pair.transmission, least)
    both = ((free.driving, free.size.driving_teeth), (free.driven, free.size.driven_teeth))
    assert [undercut_teeth(curve, rack(), teeth) for curve, teeth in both] == [[], []]


def undercut_by_closed_form(curve: PitchCurve, basic: BasicRack, teeth: int) -> list[int]:
    """Teeth on which sin^2 + h k vanishes below the pitch line, k from the law's closed form at 2001 heights."""
    own = flanks_of(curve, basic, teeth, tooth_at_zero=curve.gear is Gear.DRIVING)
    height = np.linspace(-basic.flank_depth_mm, 0.0, 2001)
    angle = curve.driving_angle(own.rolled_mm(np.arange(own.count)[:, None], height))
    regular = sin(basic.pressure_angle_rad) ** 2 + height * curve.at_angle(angle).curvature
    return sorted({int(number) for number in own.tooth[regular.min(axis=1) <= 0.0]})


@pytest.mark.parametrize(
    ("law", "teeth"),
    [(elliptical_law(0.7, 0.0, Lobes()), 25), (sine_law(0.3), 40), (elliptical_law(0.3, 0.0, Lobes(3, 1)), 60)],
    ids=["ellipse", "sine", "3:1"],
)
def test_undercut_teeth_are_those_of_the_closed_form(law: Transmission, teeth: int) -> None:
    pitch = pitch_pair(law, teeth)
    pair = toothed_pair(pitch, rack(), 0.01)
    for gear in (pair.driving, pair.driven):
        assert gear.undercut == undercut_by_closed_form(gear.flanks.curve, rack(), gear.teeth)
    assert 0 < len(pair.driven.undercut) < pair.driven.teeth


def test_undercut_teeth_of_the_baler() -> None:
    pair = toothed_pair(pitch_pair(baler_law(), 25), rack(), 0.01)
    for gear in (pair.driving, pair.driven):
        assert gear.undercut == undercut_by_closed_form(gear.flanks.curve, rack(), 25)
        assert 8 <= len(gear.undercut) <= 16


# --- pointed teeth -----------------------------------------------------------------------------------------------

LONG = rack(addendum=1.6, dedendum=1.7, root_radius=0.15)
"""Teeth so long that circular gears of 25 teeth or fewer are pointed."""


def tip_thickness(teeth: int) -> float:
    """Of a circular gear, on its tip circle: da (pi / 2 z + inv(alpha) - inv(alpha_a))."""
    radius = teeth * MODULE / 2.0
    tip = radius + LONG.addendum_mm
    at_tip = np.arccos(radius * cos(radians(20.0)) / tip)
    return 2.0 * tip * (pi / (2.0 * teeth) + involute(radians(20.0)) - involute(at_tip))


def pointed_radius(teeth: int) -> float:
    """Where the two involutes of a tooth meet: inv(alpha) = pi / 2 z + inv(alpha_pitch)."""
    target = pi / (2.0 * teeth) + float(involute(radians(20.0)))
    angle = brentq(lambda a: float(involute(a)) - target, 0.1, 1.4, xtol=1e-15)
    return teeth * MODULE / 2.0 * cos(radians(20.0)) / cos(angle)


@pytest.mark.parametrize("teeth", [18, 20, 22, 24, 25, 26, 27, 30, 40])
@pytest.mark.parametrize("gear", Gear)
def test_teeth_are_pointed_where_the_closed_form_tip_is_negative(teeth: int, gear: Gear) -> None:
    pair = pitch_pair(uniform_law(Lobes()), teeth)
    made = toothed_gear(pair.driving if gear is Gear.DRIVING else pair.driven, LONG, teeth, 0.001)
    sharp = tip_thickness(teeth) < 0.0
    assert sharp == (teeth <= 25)
    assert made.pointed == (list(range(1, teeth + 1)) if sharp else [])
    farthest = np.hypot(*made.outline_mm.T).max()
    expected = pointed_radius(teeth) if sharp else teeth * MODULE / 2.0 + LONG.addendum_mm
    assert farthest == pytest.approx(expected, abs=1e-9)
    assert Polygon(made.outline_mm).is_valid


@pytest.mark.parametrize("teeth", [20, 40])
def test_standard_teeth_are_not_pointed(teeth: int) -> None:
    pair = toothed_pair(pitch_pair(uniform_law(Lobes()), teeth), rack(), 0.01)
    assert pair.driving.pointed + pair.driven.pointed == []


def test_backlash_thins_tips_to_a_point_one_tooth_earlier() -> None:
    """26 teeth have a tip of 0.020 mm; backlash takes jn / 2 cos(alpha) off at the pitch circle, more at the tip."""
    curve = pitch_pair(uniform_law(Lobes()), 26).driving
    ratio = (26.0 + 3.2) / 26.0
    critical = tip_thickness(26) / ratio * 2.0 * cos(radians(20.0))
    assert toothed_gear(curve, replace(LONG, backlash_mm=0.99 * critical), 26, 0.01).pointed == []
    assert len(toothed_gear(curve, replace(LONG, backlash_mm=1.01 * critical), 26, 0.01).pointed) == 26


# --- against brute-force cutting ---------------------------------------------------------------------------------

TOLERANCE = 2e-4
CUTTER_FACETS = 2.5e-4
"""Sagitta of the 24 chords that draw the oracle's rounding of 0.76 mm over 70 degrees, material it leaves standing."""
SCALLOPS = 1e-4
"""At 100 positions a pitch: halving the step moves the outlines below by 2e-5 to 6e-5 mm."""


def brute(
    gear: ToothedGear, positions: int = 100, window: float = 2.0, cutter: rack_cut.Cutter | None = None
) -> Polygon:
    """The same gear cut by the oracle, from samples of its pitch curve."""
    curve, basic = gear.flanks.curve, gear.flanks.rack
    sigma = np.arange(4000) * (curve.length_mm / 4000)
    at = curve.at_angle(curve.driving_angle(sigma))
    sampled = rack_cut.PitchCurve(at.position, at.tangent, at.normal, sigma, curve.length_mm)
    tooth = rack_cut.Proportions(
        basic.module_mm,
        basic.pressure_angle_rad,
        basic.addendum_mm,
        basic.dedendum_mm,
        basic.root_radius_mm,
        basic.backlash_mm / 2.0 / cos(basic.pressure_angle_rad),
    )
    return rack_cut.cut(sampled, tooth, gear.teeth, curve.gear is Gear.DRIVING, cutter, positions, window)


CONVEX = {
    "circle of 6": (lambda: uniform_law(Lobes()), 6),
    "circle of 12": (lambda: uniform_law(Lobes()), 12),
    "circle of 18": (lambda: uniform_law(Lobes()), 18),
    "ellipse": (lambda: elliptical_law(0.35, 0.0, Lobes()), 37),
    "undercut ellipse": (lambda: elliptical_law(0.7, 0.0, Lobes()), 25),
    "sine": (lambda: sine_law(0.08), 25),
    "1:2": (lambda: elliptical_law(0.2, 0.3, Lobes(1, 2)), 25),
}


@pytest.mark.parametrize("name", CONVEX)
@pytest.mark.parametrize("gear", Gear)
def test_outline_on_a_convex_curve_is_what_a_rack_cuts(name: str, gear: Gear) -> None:
    law, teeth = CONVEX[name][0](), CONVEX[name][1]
    pair = toothed_pair(pitch_pair(law, teeth), rack(), TOLERANCE)
    made = pair.driving if gear is Gear.DRIVING else pair.driven
    assert rack_cut.outline_distance(Polygon(made.outline_mm), brute(made), 0.02) < TOLERANCE + CUTTER_FACETS + SCALLOPS


@pytest.mark.slow
@pytest.mark.parametrize("teeth", [*range(7, 26), 30])
@pytest.mark.parametrize("name", ["circle", "ellipse", "sharp ellipse", "sine"])
def test_few_teeth_are_what_a_rack_cuts(name: str, teeth: int) -> None:
    """From deep undercut to none, on curves whose teeth are undercut a little, much and not at all."""
    laws = {
        "circle": uniform_law(Lobes()),
        "ellipse": elliptical_law(0.35, 0.3, Lobes()),
        "sharp ellipse": elliptical_law(0.7, 0.3, Lobes()),
        "sine": sine_law(0.08),
    }
    tolerance = 0.002
    pair = toothed_pair(pitch_pair(laws[name], teeth), rack(), tolerance)
    for made in (pair.driving, pair.driven):
        assert Polygon(made.outline_mm).is_valid
        apart = rack_cut.outline_distance(Polygon(made.outline_mm), brute(made, 50), 0.05)
        assert apart < tolerance + CUTTER_FACETS + 4.0 * SCALLOPS  # at half the positions


@pytest.mark.parametrize("gear", Gear)
def test_backlash_thins_what_a_rack_cuts(gear: Gear) -> None:
    pair = toothed_pair(pitch_pair(sine_law(0.08), 25), rack(backlash_mm=0.1), TOLERANCE)
    made = pair.driving if gear is Gear.DRIVING else pair.driven
    assert rack_cut.outline_distance(Polygon(made.outline_mm), brute(made), 0.02) < TOLERANCE + CUTTER_FACETS + SCALLOPS


@pytest.mark.parametrize(
    "wrong", [{"angle_deg": 20.1}, {"root_radius": 0.37}, {"dedendum": 1.251}, {"backlash_mm": 0.004}]
)
def test_brute_force_tells_slightly_other_racks_apart(wrong: dict[str, float]) -> None:
    """Negative controls: each changes the outline by more than the tolerance of the tests above."""
    curve = pitch_pair(elliptical_law(0.35, 0.0, Lobes()), 37).driving
    made, other = (toothed_gear(curve, basic, 37, TOLERANCE) for basic in (rack(), rack(**wrong)))
    assert rack_cut.outline_distance(Polygon(made.outline_mm), brute(other, 50), 0.05) > 1e-3


def working_points(gear: ToothedGear, lowest_mm: float, share: float) -> np.ndarray:
    """Points on what is left of the working flanks, from a height up to a share of the way to their tops."""
    top, bottom = (heights[:, None] for heights in gear.sides.flank_range())
    low = np.maximum(bottom, lowest_mm)
    height = low + (top - low) * np.linspace(0.0, share, 15)
    point, _ = gear.flanks.flank(np.arange(gear.flanks.count)[:, None], height)
    return shapely.points(point.reshape(-1, 2))


@pytest.mark.parametrize("depth", [0.16, 0.2])
@pytest.mark.parametrize("gear", Gear)
def test_flanks_on_a_mildly_concave_curve_are_what_a_pinion_cuts(depth: float, gear: Gear) -> None:
    """Radius 397 or 66 mm where concave; the cutter's fillets reach higher and its base circle ends its flanks."""
    pitch = pitch_pair(sine_law(depth), 60)
    assert not pitch.convex(Gear.DRIVING)
    pair = toothed_pair(pitch, rack(), 0.001)
    made = pair.driving if gear is Gear.DRIVING else pair.driven
    cut = brute(made, 50, 1.5, rack_cut.Pinion(20))
    # Scallops of a pinion are larger: the oracle's own test allows 5e-4 mm at 40 positions a pitch.
    assert rack_cut.deviation_of_points(working_points(made, -0.6 * MODULE, 0.95), cut).max() < 5e-4


def test_a_straight_rack_gouges_the_concave_flanks() -> None:
    """Negative control: where the curve is concave the envelope is not what a rack leaves."""
    made = toothed_pair(pitch_pair(sine_law(0.2), 60), rack(), 0.001).driving
    assert rack_cut.deviation_of_points(working_points(made, -0.6 * MODULE, 0.95), brute(made, 25)).max() > 0.05


# --- what is refused ---------------------------------------------------------------------------------------------


def test_root_land_that_folds_is_refused_with_gear_radius_and_angle() -> None:
    with pytest.raises(NoSuchMechanism) as caught:
        toothed_pair(pitch_pair(baler_law(), 6), rack(), 0.01)
    assert caught.value.key == "gears.teeth"
    pair = pitch_pair(baler_law(), 6)
    sharpest = pair.curvature_range[Gear.DRIVING][1]
    assert "driving pitch curve" in caught.value.problem
    assert f"{1.0 / sharpest.value:.4g} mm" in caught.value.problem
    assert "dedendum of 2.5 mm" in caught.value.problem


def test_tip_land_that_folds_is_refused_with_gear_radius_and_angle() -> None:
    pair = pitch_pair(sine_law(0.3), 10)
    with pytest.raises(NoSuchMechanism) as caught:
        toothed_pair(pair, rack(), 0.01)
    assert f"{pair.least_concave_radius_mm(Gear.DRIVING):.4g} mm" in caught.value.problem
    assert "addendum of 2 mm" in caught.value.problem
    assert degrees(pair.curvature_range[Gear.DRIVING][0].at) % 180 == pytest.approx(0.0, abs=1e-6)


@pytest.mark.parametrize("share", [0.999, 1.001])
def test_limit_of_folded_lands_is_the_radius_itself(share: float) -> None:
    """At 13 teeth the driving curve's concave radius is 1.055 modules; the addendum is put just below and above."""
    pair = pitch_pair(sine_law(0.3), 13)
    radius = pair.least_concave_radius_mm(Gear.DRIVING)
    assert radius is not None
    own = flanks_of(pair.driving, rack(addendum=share * radius / MODULE), 13, tooth_at_zero=True)
    with nullcontext() if share < 1.0 else pytest.raises(NoSuchMechanism, match="addendum"):
        refuse_folded_lands(own)
