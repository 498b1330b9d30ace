"""Tips: full where nothing is in the way, else as high as land, mate, cusp and path allow; profile shift and relief."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from math import cos, pi, radians, sin, tan

import numpy as np
import pytest
from scipy.optimize import brentq
from scipy.spatial import KDTree
from shapely import Polygon

from ncgear.figures.summary.build_summary import _tips
from ncgear.numerics.crossing import refined_crossings
from ncgear.pitch.pair import PitchPair, sized_pair
from ncgear.ratio.laws.ellipse import elliptical_law
from ncgear.ratio.laws.expression import driven_angle_expression_law
from ncgear.ratio.laws.uniform import uniform_law
from ncgear.ratio.transmission import Lobes
from ncgear.teeth import fitting, tips
from ncgear.teeth.flank import flanks_of, mating_flanks
from ncgear.teeth.form import Backlash, BasicRack, Cutter, CutterKind, TipLimits, TipRelief, ToothForm
from ncgear.teeth.fouling import STEPS, paths_near_concave
from ncgear.teeth.gear import ToothedGear, ToothedPair, toothed_pair
from ncgear.teeth.outline import ChordTolerance, outline_points
from ncgear.teeth.regular import CLEAR_OF_CUSPS, regular_depth, regular_height
from ncgear.teeth.tips import Bounds, Limit, Tips, _crossing_below_cusp, _land, even_heights, fitted_tips, tip_crossing
from ncgear.teeth.tool import RackLine
from oracles import meshing
from oracles.rack_cut import involute
from pairs import baler_law, both, rack, sine_law

MODULE = 2.0
TOLERANCE = 0.005
ALPHA = radians(20.0)

Array = np.ndarray

LAWS = {
    "uniform": (lambda: uniform_law(Lobes()), 25),
    "uniform 1:3": (lambda: uniform_law(Lobes(1, 3)), 20),
    "ellipse": (lambda: elliptical_law(0.35, 0.0, Lobes()), 37),
    "sharp ellipse": (lambda: elliptical_law(0.7, 0.0, Lobes()), 25),
    "1:2": (lambda: elliptical_law(0.2, 0.3, Lobes(1, 2)), 25),
    "sine": (lambda: sine_law(0.08), 40),
    "deep sine": (lambda: sine_law(0.3), 48),
    "baler": (baler_law, 25),
}


@cache
def pitch_pair(name: str) -> PitchPair:
    """The pitch curves of one of the laws."""
    return sized_pair(LAWS[name][0](), LAWS[name][1], MODULE, None)


@cache
def made(name: str, form: ToothForm) -> ToothedPair:
    """A pair of gears."""
    return toothed_pair(pitch_pair(name), form, TOLERANCE)


def judged(pitch: PitchPair, pair: ToothedPair, positions: int = 211) -> meshing.MeshingReport:
    """Overlap and gap of the outlines over a turn of the driving gear, by shapely."""
    phi1 = np.linspace(0.0, pitch.driving.turn_rad, positions + 1)
    phi2 = pitch.transmission.driven_angle(phi1).value
    outlines = Polygon(pair.driving.outline_mm), Polygon(pair.driven.outline_mm)
    return meshing.Pair(*outlines, phi1, phi2, pitch.center_distance_mm).report(positions)


# --- nothing in the way ------------------------------------------------------------------------------------------


@pytest.mark.tiers(quick=["CutterKind.RACK-sine"], rest="long")
@pytest.mark.parametrize("name", ["uniform", "uniform 1:3", "ellipse", "1:2", "sine"])
@pytest.mark.parametrize("kind", [CutterKind.RACK, CutterKind.MATE])
def test_no_tip_of_an_ordinary_gear_is_shortened(name: str, kind: CutterKind) -> None:
    basic = rack()
    for gear in both(made(name, ToothForm(basic, cutter=Cutter(kind), limits=TipLimits(0.2 * MODULE)))):
        assert np.all(gear.tips.limit == Limit.FULL)
        assert np.all(gear.flanks.tip_height_mm == basic.addendum_mm)
        assert gear.undercut == []


def test_full_tips_of_circular_gears_end_where_the_involute_meets_the_tip_circle() -> None:
    """The pressure angle there is acos(R cos(alpha) / Ra); the contact's height (tan(there) R cos - R sin) sin."""
    gear = made("uniform", ToothForm(rack())).driving
    pitch_radius = 25 * MODULE / 2.0
    at_tip = np.arccos(pitch_radius * cos(ALPHA) / (pitch_radius + MODULE))
    expected = (np.tan(at_tip) * pitch_radius * cos(ALPHA) - pitch_radius * sin(ALPHA)) * sin(ALPHA)
    assert gear.tips.height_mm == pytest.approx(expected, rel=1e-10)


# --- the crossing with the tip land ------------------------------------------------------------------------------


@pytest.mark.tiers(slow=["1:2"], rest="long")
@pytest.mark.parametrize("name", LAWS)
def test_flanks_end_on_their_tip_lands(name: str) -> None:
    for gear in both(made(name, ToothForm(rack()))):
        own, tips = gear.flanks, gear.tips
        edge = own.flank(np.arange(own.count), tips.height_mm)[0]
        land = own.offset(tips.at_mm, own.tip_height_mm)[0]
        assert np.linalg.norm(edge - land, axis=1).max() < 1e-9 * MODULE


@pytest.mark.tiers(slow=["20.0-25"], rest="long")
@pytest.mark.parametrize("teeth", [25, 28])
@pytest.mark.parametrize("angle_deg", [14.5, 20.0])
def test_no_tip_stands_beyond_a_cusp(teeth: int, angle_deg: float) -> None:
    """On hollow stretches a flank comes to the same height again beyond its cusp."""
    pitch, share = sized_pair(baler_law(), teeth, MODULE, None), np.linspace(0.0, 1.0, 401)
    for addendum in (0.9, 1.0):
        form = ToothForm(rack(angle_deg, addendum, 1.25, 0.2), limits=TipLimits(0.2 * MODULE))
        for gear in both(toothed_pair(pitch, form, TOLERANCE)):
            own, every = gear.flanks, np.arange(gear.flanks.count)
            assert own.regularity(every[:, None], gear.tips.height_mm[:, None] * share).min() > 0.0


def test_newtons_method_alone_leads_beyond_a_cusp() -> None:
    """Negative control: at 14.5 degrees one of the baler's 28 teeth would end on the wrong branch."""
    curve = sized_pair(baler_law(), 28, MODULE, None).driving
    own = flanks_of(curve, rack(14.5, root_radius=0.2), 28, RackLine(), 0.0)
    own, every = replace(own, tip_height_mm=np.full(56, 0.909 * MODULE)), np.arange(56)
    top, _, there = refined_crossings(
        lambda h: own.flank(every, h),
        lambda s: own.offset(s, own.tip_height_mm),
        0.5 * own.tip_height_mm,
        own.crossing_mm - own.side * 0.5 * own.tip_height_mm * tan(radians(14.5)),
        1e-10,
    )
    wrong = there & (top > regular_height(own, 3.0 * MODULE)) & (top < 1.2 * MODULE)
    assert wrong.any()


# --- the mate ----------------------------------------------------------------------------------------------------


def greatest_of_mates(own: Tips, values: Array, meeting: tuple[Array, Array]) -> Array:
    """Largest value over all mates of each flank."""
    most = np.full(own.flanks.count, -np.inf)
    np.maximum.at(most, meeting[0], values[meeting[1]])
    return most


@pytest.mark.tiers(quick=["1:2-True"], rest="long")
@pytest.mark.parametrize("avoid", [True, False])
@pytest.mark.parametrize("name", LAWS)
def test_no_tip_touches_deeper_than_the_mates_flank_goes(name: str, avoid: bool) -> None:
    pair = made(name, ToothForm(rack(), limits=TipLimits(0.2 * MODULE, avoid)))
    own, mate = pair.driving.tips, pair.driven.tips
    pairs = mating_flanks(pair.driving.teeth, pair.driven.teeth)
    for one, other, meeting in ((own, mate, pairs), (mate, own, pairs[::-1])):
        met = greatest_of_mates(one, other.height_mm, meeting)
        assert np.all(met <= one.flanks.flank_depth_mm + 1e-12)
        assert one.met_depth_mm == pytest.approx(met, abs=1e-15)
        # Where two gears have equal teeth every flank meets one other; its tip is nowhere beyond the regular flank.
        regular = regular_depth(one.flanks, 3.0 * MODULE)
        assert not avoid or np.all(met < regular)


@pytest.mark.tiers(quick=["ellipse"], rest="long")
@pytest.mark.parametrize("name", ["uniform", "uniform 1:3", "ellipse", "sharp ellipse", "1:2", "sine"])
def test_tips_stand_clear_of_roots_that_a_rack_has_cut(name: str) -> None:
    """By the difference of dedendum and addendum, measured along the common perpendicular of the pitch curves."""
    pair = made(name, ToothForm(rack()))
    own, mate = pair.driving.tips, pair.driven.tips
    pairs = mating_flanks(pair.driving.teeth, pair.driven.teeth)
    for one, other, meeting in ((own, mate, pairs), (mate, own, pairs[::-1])):
        tallest = greatest_of_mates(one, other.flanks.tip_height_mm, meeting)
        assert np.min(one.flanks.root_depth_mm - tallest) >= 0.25 * MODULE * (1.0 - 1e-9)


# --- lands -------------------------------------------------------------------------------------------------------

LONG = rack(addendum=1.6, dedendum=1.7, root_radius=0.15)
"""Teeth so long that circular gears of 25 teeth or fewer would be pointed."""


def lands(gear: ToothedGear) -> Array:
    """Widths of the tip lands along their chords, from their edges on the exact flanks."""
    own = gear.flanks
    edges = own.flank(np.arange(own.count), gear.tips.height_mm)[0].reshape(-1, 2, 2)
    width: Array = np.linalg.norm(edges[:, 1] - edges[:, 0], axis=1)
    return width


def radius_of_land(teeth: int, land_mm: float) -> float:
    """Where a circular gear's tooth is as wide as the land: 2 r sin(pi / 2 z + inv(alpha) - inv(alpha_r))."""
    pitch_radius = teeth * MODULE / 2.0

    def excess(radius: float) -> float:
        angle = float(np.arccos(pitch_radius * cos(ALPHA) / radius))
        return 2.0 * radius * sin(pi / (2.0 * teeth) + involute(ALPHA) - involute(angle)) - land_mm

    return float(brentq(excess, pitch_radius, pitch_radius + 3.0 * MODULE, xtol=1e-14))


@pytest.mark.tiers(quick=["0.3-14"], rest="long")
@pytest.mark.parametrize("teeth", [14, 18, 22, 25])
@pytest.mark.parametrize("least", [0.1, 0.3])
def test_narrow_tips_of_circular_gears_are_shortened_to_the_least_land(teeth: int, least: float) -> None:
    pitch = sized_pair(uniform_law(Lobes()), teeth, MODULE, None)
    form = ToothForm(LONG, limits=TipLimits(least * MODULE, avoid_undercut=False))
    for gear in both(toothed_pair(pitch, form, TOLERANCE)):
        assert gear.shortened(Limit.LAND) == list(range(1, teeth + 1))
        assert lands(gear) == pytest.approx(least * MODULE, abs=1e-9)
        expected = radius_of_land(teeth, least * MODULE)
        assert np.hypot(*gear.outline_mm.T).max() == pytest.approx(expected, abs=1e-9)
        full = teeth * MODULE / 2.0 + LONG.addendum_mm
        assert _tips(gear)["most_shortened_um"] == pytest.approx(1e3 * (full - expected), abs=1e-5)


@pytest.mark.tiers(quick=["baler"], rest="long")
@pytest.mark.parametrize("name", ["sharp ellipse", "sine", "baler", "deep sine", "1:2"])
def test_no_land_is_narrower_than_asked_for_and_the_shortened_are_just_as_wide(name: str) -> None:
    least = 0.75 * MODULE
    limited = 0
    for gear in both(made(name, ToothForm(rack(), limits=TipLimits(least)))):
        width, narrow = lands(gear), gear.tips.limit.reshape(-1, 2)[:, 0] == Limit.LAND
        assert width.min() >= least - 1e-9
        assert width[narrow] == pytest.approx(least, abs=1e-9)
        limited += int(narrow.sum())
    assert limited > 0


@pytest.mark.slow
@pytest.mark.parametrize("backlash_mm", [0.0, 0.1])
def test_heights_of_lands_by_newtons_method_are_those_in_brackets(backlash_mm: float) -> None:
    """All are found, also between edges of different heights and of turned flanks; a wider land is lower by far."""
    form = ToothForm(rack(), backlash=Backlash(backlash_mm), limits=TipLimits(0.2 * MODULE))
    for gear in both(made("baler", form)):
        uneven = np.where(np.arange(gear.flanks.count) % 3 == 0, 1.02, 1.1)
        flanks = gear.flanks.with_tips(even_heights(gear.flanks, gear.flanks.tip_height_mm * uneven))
        edges, every = tips._Edges(flanks, *tip_crossing(flanks)), np.arange(0, flanks.count, 2)
        back = every[edges.met.reshape(-1, 2).all(axis=1)]
        least = 1.05 * float(tips._land(flanks, back).max())
        found, _, met = tips._newton_lands(edges, back, least)
        assert np.count_nonzero(met) >= 0.9 * back.size
        bracketed = tips._height_of_land(flanks, back, least, tips._land(flanks, back))
        assert found[met] == pytest.approx(bracketed[met], abs=1e-9)
        wider = tips._newton_lands(edges, back, 1.01 * least)[0]
        assert np.all(wider[met] < found[met] - 1e-3)


@pytest.mark.parametrize(
    ("contact", "regular", "undercut", "limit"),
    [
        (9.0, 1.0, False, Limit.CUSP),
        (1.0, 9.0, False, Limit.FILLET),
        (1.0, 9.0, True, Limit.UNDERCUT),
        (9.0, 9.0, False, Limit.FULL),
    ],
)
def test_a_tip_says_what_limits_it(contact: float, regular: float, undercut: bool, limit: Limit) -> None:
    """The cusp of its own flank, or what its mate lets it touch; its contact then ends there."""
    flanks = flanks_of(sized_pair(uniform_law(Lobes()), 25, MODULE, None).driving, rack(), 25, RackLine(), 0.0)
    every, nothing = np.ones(50), np.zeros(50, dtype=bool)
    found = fitted_tips(flanks, Bounds(contact * every, 9.0 * every, regular * every, nothing | undercut), nothing, 0.0)
    assert (found.limit == limit).all()
    ends = {Limit.CUSP: CLEAR_OF_CUSPS * regular, Limit.FULL: float(tip_crossing(flanks)[0][0])}.get(limit, contact)
    assert found.height_mm == pytest.approx(ends * every, rel=1e-6)


def test_only_the_part_of_a_flank_that_works_has_fine_chords() -> None:
    """Ten times finer ones take about three times as many points there, and no more below."""
    gear = toothed_pair(sized_pair(uniform_law(Lobes()), 25, MODULE, None), ToothForm(rack()), 0.05).driving
    depth = float(gear.tips.met_depth_mm.max())
    works = 25.0**2 - 2.0 * 25.0 * depth + (depth / sin(radians(20.0))) ** 2
    counts = []
    for tolerance in (1e-2, 1e-3):
        radius = np.hypot(*outline_points(gear.tips, gear.sides, ChordTolerance(tolerance, 1e-2)).T)
        flank = (radius > works**0.5 + 1e-6) & (radius < 27.0 - 1e-6)
        counts.append((np.count_nonzero(flank), np.count_nonzero(radius < works**0.5 - 1e-6)))
    assert counts[1][0] > 2.5 * counts[0][0]
    assert counts[1][1] == counts[0][1]


def test_play_makes_lands_of_a_round_gear_narrower_by_its_way_on_the_tip_circle() -> None:
    pitch = sized_pair(uniform_law(Lobes()), 25, MODULE, None)
    flanks = toothed_pair(pitch, ToothForm(rack(), backlash=Backlash(0.2)), 0.05).driven.flanks
    back = np.arange(0, flanks.count, 2)
    way = flanks.turn_rad[0] * (25.0 + MODULE)
    assert way > 0.2
    assert _land(flanks.unturned, back) - _land(flanks, back) == pytest.approx(np.full(25, way), rel=1e-4)


@pytest.mark.tiers(slow=["1:2"], rest="long")
@pytest.mark.parametrize("name", LAWS)
def test_no_land_rises_by_more_than_a_quarter_of_its_width_when_level(name: str) -> None:
    for gear in both(made(name, ToothForm(rack(), limits=TipLimits(0.2 * MODULE)))):
        heights = gear.flanks.tip_height_mm.reshape(-1, 2)
        level = replace(gear.flanks, tip_height_mm=np.repeat(heights.min(axis=1), 2))
        edges = level.offset(tip_crossing(level)[1], level.tip_height_mm)[0].reshape(-1, 2, 2)
        assert np.all(np.ptp(heights, axis=1) <= 0.25 * np.linalg.norm(edges[:, 1] - edges[:, 0], axis=1) + 1e-9)


# --- fouling -----------------------------------------------------------------------------------------------------


@pytest.mark.slow
def test_tips_of_hollow_stretches_are_shortened_where_they_would_foul(monkeypatch: pytest.MonkeyPatch) -> None:
    pitch = sized_pair(sine_law(0.3), 37, MODULE, None)
    form = ToothForm(rack(), limits=TipLimits(0.2 * MODULE))
    pair = toothed_pair(pitch, form, TOLERANCE)
    assert pair.driving.shortened(Limit.FOULING) or pair.driven.shortened(Limit.FOULING)
    assert judged(pitch, pair).overlap_depth.max() <= 1.2 * TOLERANCE
    # Negative control: left as they are, the same tips run into each other.
    monkeypatch.setattr(fitting, "freed", lambda own, mate, meeting: own)
    assert judged(pitch, toothed_pair(pitch, form, TOLERANCE)).overlap_depth.max() > 10.0 * TOLERANCE


@pytest.mark.slow
def test_edges_that_cross_a_mates_land_are_seen() -> None:
    """A path may come in below the mate's flank and leave by its tip: on this law it is the only sign."""
    law = driven_angle_expression_law("phi - 0.2114*sin(3*phi)/1.5", Lobes())
    pitch = sized_pair(law, 57, MODULE, None)
    form = ToothForm(rack(), cutter=Cutter(CutterKind.MATE), limits=TipLimits(0.4 * MODULE, False))
    assert judged(pitch, toothed_pair(pitch, form, TOLERANCE)).overlap_depth.max() <= 1.2 * TOLERANCE


# --- profile shift -----------------------------------------------------------------------------------------------


@pytest.mark.tiers(quick=["-0.4-uniform"], rest="long")
@pytest.mark.parametrize("name", ["uniform", "ellipse", "sine", "baler"])
@pytest.mark.parametrize("shift", [0.3, -0.4])
def test_equal_and_opposite_shifts_leave_neither_overlap_nor_gap(name: str, shift: float) -> None:
    form = ToothForm(rack(), shift * MODULE, -shift * MODULE, limits=TipLimits(0.2 * MODULE))
    pair = made(name, form)
    for gear, own in ((pair.driving, shift), (pair.driven, -shift)):
        thickness = np.diff(gear.flanks.crossing_mm.reshape(-1, 2), axis=1)
        assert thickness == pytest.approx(pi * MODULE / 2.0 + 2.0 * own * MODULE * tan(ALPHA), rel=1e-12)
    report = judged(pitch_pair(name), pair)
    assert report.overlap_depth.max() <= 1.2 * TOLERANCE
    assert report.gap.max() <= 2.0 * TOLERANCE


def test_shifts_of_both_gears_outwards_leave_their_teeth_as_thick_as_the_pitch_allows() -> None:
    """They fit without play where a hob would make them too thick by 2 (x1 + x2) sin(alpha)."""
    pitch = pitch_pair("uniform")
    pair = toothed_pair(pitch, ToothForm(rack(), 0.3, 0.1), TOLERANCE)
    thickness = [np.diff(gear.flanks.crossing_mm.reshape(-1, 2), axis=1).mean() for gear in (pair.driving, pair.driven)]
    assert thickness == pytest.approx([pi * MODULE / 2.0 + way * 0.2 * tan(ALPHA) for way in (1.0, -1.0)], rel=1e-12)
    report = judged(pitch, pair)
    assert report.overlap_depth.max() <= 1.2 * TOLERANCE
    assert report.gap.max() <= 2.0 * TOLERANCE


@pytest.mark.slow
def test_the_play_is_what_is_asked_for_whatever_the_shifts() -> None:
    """Along the normal, by which the driven gear can turn on; the law's position is an end of it."""
    pitch = pitch_pair("uniform")
    phi1 = np.linspace(0.0, 2.0 * pi, 12)
    for form, play in (
        (ToothForm(rack(), -0.3, -0.1), 0.0),
        (ToothForm(rack(), 0.1, -0.1, backlash=Backlash(0.1)), 0.1),
        (ToothForm(rack(), 0.2, 0.1, backlash=Backlash(0.3)), 0.3),
    ):
        pair = toothed_pair(pitch, form, TOLERANCE / 20.0)
        outlines = Polygon(pair.driving.outline_mm), Polygon(pair.driven.outline_mm)
        law = pitch.transmission.driven_angle(phi1).value
        for position in (1, 4, 9):
            back, on = meshing.Pair(*outlines, phi1, law, pitch.center_distance_mm).driven_play(position)
            lever = 25.0 * cos(ALPHA)
            assert back * lever == pytest.approx(0.0, abs=2.0 * TOLERANCE / 20.0)
            assert on * lever == pytest.approx(play, abs=2.0 * TOLERANCE / 20.0)


# --- tip relief --------------------------------------------------------------------------------------------------


def relieved(amount: float) -> BasicRack:
    return replace(rack(), relief=TipRelief(amount * MODULE, 0.5 * MODULE, MODULE))


@pytest.mark.tiers(slow=["uniform"], rest="long")
@pytest.mark.parametrize("name", ["uniform", "sine"])
def test_relief_parts_the_flanks_where_only_tips_are_left_to_touch(name: str) -> None:
    """More than one pair is in mesh, and where one carries below the reliefs nothing has changed."""
    plain, eased = (judged(pitch_pair(name), made(name, ToothForm(basic))) for basic in (rack(), relieved(0.02)))
    assert eased.overlap_depth.max() <= 1.2 * TOLERANCE
    assert plain.gap.max() <= 2.0 * TOLERANCE
    assert eased.gap.max() <= 2.0 * TOLERANCE + 0.02 * MODULE


def test_the_first_crossing_below_a_cusp_is_where_a_march_first_meets_the_land() -> None:
    """Up each flank in 250 steps, with distances from a dense pitch curve; concave stretches among them."""
    flanks = made("baler", ToothForm(rack())).driving.flanks
    every, heights = np.arange(flanks.count), np.linspace(0.0, 1.3, 250) * flanks.tip_height_mm[:, None]
    dense = flanks.curve.at_length(np.linspace(0.0, flanks.curve.length_mm, 10_000)).position
    away = KDTree(dense).query(flanks.flank(every[:, None], heights)[0])[0]
    first = np.argmax(away >= flanks.tip_height_mm[:, None], axis=1)
    found, _, met = _crossing_below_cusp(flanks, every)
    assert met.all()
    assert np.all(first > 0)
    assert np.all((found >= heights[every, first - 1] - 1e-6) & (found <= heights[every, first] + 1e-6))


def test_tips_are_followed_along_both_pitch_curves() -> None:
    """Each path by its own arc lengths, beside the points that paths share."""
    pair = made("baler", ToothForm(rack(), backlash=Backlash(0.1)))
    own, mate = pair.driving.flanks, pair.driven.flanks
    pairs = mating_flanks(25, 25)
    paths = paths_near_concave((own, mate), (pairs, pairs[::-1]))[0]
    assert paths.own.size
    steps = (paths.at.curvature.shape[1] - 1) // 2
    rolled = np.arange(-steps, steps + 1) * own.rack.pitch_mm / STEPS
    for flanks, found in ((own, paths.at), (mate, paths.there)):
        wanted = flanks.curve.at_length(own.crossing_mm[paths.own, None] + rolled).position
        assert np.abs(found.position - wanted).max() <= 1e-9
