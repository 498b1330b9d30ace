"""Contact of the exact curves: closed forms of circular pairs, shapely's judgement, and pairs that must fail."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cache
from math import cos, floor, lcm, pi, radians, sin

import numpy as np
import pytest
import shapely
from scipy.optimize import brentq
from shapely import LineString, Point, Polygon

from at_once import at_once
from drives import drive
from engaged import MODULE, TOLERANCE, designed, made, outlines, read, written
from ncgear.contact.designed.as_designed import AsDesigned, SideContact, as_designed, contacts_within
from ncgear.contact.designed.curves import side_paths
from ncgear.contact.designed.flanks import TOUCHING_IN_PITCHES
from ncgear.contact.pair import refuse_overlap
from ncgear.contact.placement import (
    REACH_IN_PITCHES,
    Placement,
    _crossings_mm,
    meetings,
    placed,
    placed_at,
    single_meetings,
)
from ncgear.errors import NoSuchMechanism
from ncgear.teeth.flank import FLANK
from ncgear.teeth.form import TipRelief, ToothForm
from ncgear.teeth.gear import ToothedGear, ToothedPair, toothed_pair
from oracles import meshing
from pairs import rack

ALPHA = radians(20.0)

Array = np.ndarray


def both(contact: AsDesigned) -> tuple[SideContact, SideContact]:
    return contact.pushing, contact.back


# --- the sides as chords ---------------------------------------------------------------------------------------------


@pytest.mark.tiers(thorough=["sine-25"], rest="slow")
@pytest.mark.parametrize(("name", "teeth"), [("sine", 25), ("baler", 25), ("ring", 40)])
def test_paths_lead_from_tip_to_tip_across_each_space(name: str, teeth: int) -> None:
    """Without a gap, down flank and fillet, over the root land, and up the fillet of the flank that faces it."""
    _, pair = made(name, teeth)
    for gear in (pair.driving, pair.driven):
        paths = side_paths(gear.flanks, gear.sides)
        following = paths.runs.path[1:] == paths.runs.path[:-1]
        assert np.abs(paths.point[1:, 0] - paths.point[:-1, -1])[following].max() < 1e-9
        points = shapely.points(paths.places.real, paths.places.imag)
        # Their points are on the written outline, to its chords.
        assert shapely.distance(shapely.LinearRing(gear.outline_mm), points).max() <= TOLERANCE


@pytest.mark.tiers(thorough=["sine-25-False"], rest="slow")
@pytest.mark.parametrize(
    ("name", "teeth", "undercut"),
    [("sine", 25, False), ("uniform", 12, True), ("deep sine", 40, False), ("baler", 25, False), ("ring", 40, False)],
)
def test_curves_stray_from_their_chords_by_no_more_than_is_said(name: str, teeth: int, undercut: bool) -> None:
    """By half of it where they bend evenly; by more where the curvature jumps, as in the baler's curves."""
    share = np.linspace(0.0, 1.0, 33)[1:-1]
    _, pair = made(name, teeth, undercut=undercut)
    for gear in (pair.driving, pair.driven):
        paths = side_paths(gear.flanks, gear.sides)
        chord, step = np.diff(paths.point, axis=1)[..., None], np.diff(paths.parameter, axis=1)[..., None]
        every = np.arange(len(paths.point))
        places = (paths.parameter[:, :-1, None] + step * share).reshape(every.size, -1)
        points = paths.curve(every, places)[0].reshape(*chord.shape[:2], -1)
        strayed = np.abs(((points - paths.point[:, :-1, None]) * np.conj(chord)).imag / np.abs(chord)).max(axis=-1)
        assert np.all(strayed <= 0.9 * paths.stray_mm + 1e-12)
        assert np.median(paths.stray_mm / strayed) == pytest.approx(2.0, rel=0.05)


# --- positions ---------------------------------------------------------------------------------------------------


@pytest.mark.tiers(slow=["baler-86-86-1-1720"], rest="quick")
@pytest.mark.parametrize(
    ("name", "teeth", "driven", "turns", "count"),
    [("uniform", 25, 25, 1, 500), ("uniform 1:2", 24, 48, 2, 960), ("uniform 3:2", 30, 20, 2, 1200),
     ("uniform", 8, 8, 1, 400), ("baler", 86, 86, 1, 1720)],
)  # fmt: skip
def test_positions_cover_a_meeting_cycle_evenly(name: str, teeth: int, driven: int, turns: int, count: int) -> None:
    pitch, _ = made(name, teeth)
    placement = placed(pitch)
    assert placement.count == count
    assert (placement.phi1_rad[0], placement.rolled_mm[0]) == (0.0, 0.0)
    assert placement.cycle_rad == pytest.approx(2.0 * pi * turns, rel=1e-15)
    # Evenly in rolled length, by an integral of the pitch curve's own speed.
    dense = np.linspace(0.0, placement.cycle_rad, 40001)
    points = pitch.driving.at_angle(dense).position
    rolled = np.append(0.0, np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1)))
    assert np.interp(placement.phi1_rad, dense, rolled) == pytest.approx(placement.rolled_mm, abs=2e-4)
    assert np.diff(placement.rolled_mm) == pytest.approx(np.full(count - 1, rolled[-1] / count), rel=1e-6)
    # Every pair of teeth that can meet does, and at 20 positions of its own or more.
    met = {placement.teeth_at(position) for position in range(count)}
    assert {first for first, _ in met} == set(range(1, teeth + 1))
    assert {second for _, second in met} == set(range(1, driven + 1))
    assert count // lcm(teeth, driven) >= 20


def test_mates_cross_the_pitch_point_together_in_every_turn() -> None:
    """Of 20 and 30 teeth, which all meet within three turns, each pair of flanks once on either side."""
    pitch, pair = made("uniform 2:3", 20)
    side, driving, driven, own, other = _crossings_mm(pair, placed(pitch))
    assert own == pytest.approx(other, abs=1e-9)
    assert own.min() > -pi * MODULE
    assert own.max() < 3.0 * pitch.driving.length_mm
    met = set(zip(side.tolist(), driving.tolist(), driven.tolist(), strict=True))
    assert len(met) == side.size == 2 * 60


# --- exact flanks keep the law -------------------------------------------------------------------------------------


@pytest.mark.tiers(slow=["uniform 1:2-24", "ellipse-37", "sine-25", "baler-86", "ring 1:2-30"], rest="long")
@pytest.mark.parametrize(
    ("name", "teeth"),
    [("uniform", 18), ("uniform 1:2", 24), ("uniform 3:2", 30), ("ellipse", 37), ("long ellipse", 60), ("sine", 25),
     ("sine", 18), ("baler", 86), ("baler", 43), ("ring 1:2", 30), ("ring", 40)],
)  # fmt: skip
def test_exact_flanks_keep_the_law(name: str, teeth: int) -> None:
    contact = designed(name, teeth)
    for side in both(contact):
        assert np.abs(side.error_rad).max() <= 1e-12
        assert side.transmission_error_rad <= 1e-12
        assert side.first.flanks.all()
        assert max(side.variation_by_tooth(side.error_rad).values()) <= 1e-12
    assert np.abs(contact.backlash_rad).max() <= 1e-12
    assert contact.overlap_mm.max() == 0.0


def test_driven_gear_turned_on_is_seen_to_the_last_digit() -> None:
    """Negative control: a driven gear that stands 1e-4 rad ahead of the law is pushed back by its backs."""
    pitch, pair = made("sine", 25)
    true = placed(pitch)
    contact = as_designed(pair, replace(true, phi2_rad=true.phi2_rad + 1e-4))
    # Flanks of other curves than circles are conjugate at the law's angle only: elsewhere to second order in the angle.
    for side in both(contact):
        assert side.error_rad == pytest.approx(np.full(true.count, -1e-4), abs=3e-8)
    arm = pitch.center_distance_mm / 2.0
    assert contact.overlap_mm.min() > 0.3 * 1e-4 * arm
    assert contact.overlap_mm.max() < 2.0 * 1e-4 * arm


@pytest.mark.parametrize("apart", [-0.05, 0.05, 0.3])
def test_circular_gears_stay_conjugate_at_another_centre_distance(apart: float) -> None:
    """Their play is 2 (r1 + r2) (inv(work) - inv(alpha)) / r2, half of it to either side."""
    pitch, pair = made("uniform 1:2", 24)
    contact = as_designed(pair, replace(placed(pitch), center_distance_mm=pitch.center_distance_mm + apart))
    work = np.arccos(72.0 * cos(ALPHA) / (72.0 + apart))
    expected = 2.0 * 72.0 * ((np.tan(work) - work) - (np.tan(ALPHA) - ALPHA)) / 48.0
    assert contact.backlash_rad == pytest.approx(np.full(960, expected), abs=1e-13)
    assert contact.pushing.error_rad == pytest.approx(np.full(960, -expected / 2.0), abs=1e-13)
    assert (contact.overlap_mm.max() > 0.0) == (apart < 0.0)
    if apart < 0.0:
        # Across the flanks: the angle times the base radius.
        assert contact.overlap_mm == pytest.approx(np.full(960, -expected / 2.0 * 48.0 * cos(ALPHA)), rel=1e-9)


def test_flanks_that_are_not_conjugate_do_not_pass() -> None:
    """Negative control: a driven gear of another pressure angle."""
    pitch, pair = made("sine", 25)
    _, other = made("sine", 25, TOLERANCE, 0.0, 21.0)
    contact = as_designed(ToothedPair(pair.driving, other.driven, pair.cutter), placed(pitch))
    # Base pitches differ by 0.6 %: 0.04 mm, which the driven gear makes up within each pitch.
    assert contact.pushing.transmission_error_rad > 3e-4


# --- circular pairs in closed form -------------------------------------------------------------------------------


def transverse_contact_ratio(first: float, second: float, angle: float) -> float:
    """Of a circular pair without undercut, from tip and base radii: ISO 21771."""
    radii = np.array([first, second]) * MODULE / 2.0
    base, tip = radii * cos(angle), radii + MODULE
    length = np.sum(np.sqrt(tip**2 - base**2)) - np.sum(radii) * sin(angle)
    return float(length / (pi * MODULE * cos(angle)))


@pytest.mark.slow
@at_once(
    ("name", "teeth", "angle_deg"),
    [("uniform", 18, 20.0), ("uniform", 25, 20.0), ("uniform 1:2", 24, 20.0), ("uniform 3:2", 30, 20.0),
     ("uniform", 100, 14.5), ("uniform", 36, 14.5)],
)  # fmt: skip
def test_contact_ratio_of_a_circular_pair_is_the_closed_form(name: str, teeth: int, angle_deg: float) -> None:
    pitch, _ = made(name, teeth, TOLERANCE, 0.0, angle_deg)
    expected = transverse_contact_ratio(teeth, pitch.size.driven_teeth, radians(angle_deg))
    for side in both(designed(name, teeth, 0.0, angle_deg)):
        assert side.pairs.arcs == pytest.approx(np.full(side.pairs.arcs.size, expected), abs=1e-9)
        assert (side.simultaneous.min(), side.simultaneous.max()) == (floor(expected), floor(expected) + 1)
        assert side.pairs.fewest == floor(expected)
        # Positions see each number of contacts for its share of the cycle, to one of 20 at either end of a contact.
        assert side.simultaneous.mean() == pytest.approx(expected, abs=0.1)


def test_some_pairs_have_two_teeth_in_contact_always() -> None:
    """So that the test above saw more than ones."""
    assert floor(transverse_contact_ratio(100, 100, radians(14.5))) == 2


@pytest.mark.slow
def test_undercut_shortens_contact() -> None:
    """12 teeth: the flank ends above its base circle, where the cusp was; contact then ends there, not at the tip."""
    _, pair = made("uniform", 12, undercut=True)
    _, bottom = pair.driving.sides.flank_range()
    # Mates touch between -low and low: both flanks end at the same depth and their tips reach farther.
    expected = -2.0 * bottom[0] / (sin(ALPHA) * cos(ALPHA)) / (pi * MODULE)
    assert designed("uniform", 12, undercut=True).pushing.pairs.arcs.min() == pytest.approx(expected, abs=1e-9)
    assert expected < transverse_contact_ratio(12, 12, ALPHA)


@pytest.mark.thorough
@pytest.mark.parametrize("backlash", [0.02, 0.2])
def test_backlash_of_a_circular_pair_is_its_angle(backlash: float) -> None:
    """jn / (r2 cos(alpha)), all of it on the idle flanks, and nothing off the contact ratio."""
    contact = designed("uniform 1:2", 24, backlash)
    angle = backlash / (48.0 * cos(ALPHA))
    assert contact.backlash_rad == pytest.approx(np.full(960, angle), abs=1e-13)
    assert contact.pushing.error_rad == pytest.approx(np.zeros(960), abs=1e-13)
    assert contact.back.error_rad == pytest.approx(np.full(960, angle), abs=1e-13)
    assert contact.pushing.pairs.arcs.min() == pytest.approx(transverse_contact_ratio(24, 48, ALPHA), abs=1e-9)


@pytest.mark.judges("contact")
@pytest.mark.parametrize("backlash", [0.0, 0.1])
def test_contact_of_a_circular_pair_runs_along_the_line_of_action(backlash: float) -> None:
    """Through the pitch point at the pressure angle, from tip circle to tip circle; pressing at the base radius."""
    contact = designed("uniform 1:2", 24, backlash)
    pitch_point, first, second = 24.0, 24.0, 48.0
    # The driving gear turns counter-clockwise and the driven gear lies at +x: it is pushed upwards and away, so the
    # normal of pushing flanks leans from +y towards +x by the pressure angle, the one of their backs towards -x.
    for side, lean in ((contact.pushing, -1.0), (contact.back, 1.0)):
        action = 1j * np.exp(1j * lean * ALPHA)
        touching = side.touching.kept(side.touching.flanks)
        place = touching.fixed_points(contact.placement)
        along = ((place - pitch_point) / action).real
        assert np.abs(((place - pitch_point) / action).imag).max() <= 1e-12
        reach = [np.sqrt((r + MODULE) ** 2 - (r * cos(ALPHA)) ** 2) - r * sin(ALPHA) for r in (first, second)]
        # Upwards contact goes on towards the driving gear's tips where the normal leans to the driven gear's side.
        after, before = (-lean * along).max(), (lean * along).max()
        # Positions are 1/20 base pitch apart along the line, so its ends are seen to that.
        assert min(reach[0] - after, reach[1] - before) >= -1e-9
        assert max(reach[0] - after, reach[1] - before) <= pi * MODULE * cos(ALPHA) / 20.0
        assert touching.lever_mm == pytest.approx(np.full(along.size, second * cos(ALPHA)), rel=1e-12)
        rho = np.abs(place - 72.0)
        assert touching.pressure_angle_rad == pytest.approx(np.arccos(second * cos(ALPHA) / rho), abs=1e-10)


@pytest.mark.slow
def test_contact_of_a_circular_ring_is_the_closed_form() -> None:
    """The driving gear lies inside: pitch point beyond its axis, gears turning alike, sliding by the difference."""
    backlash, base = 0.1, 60.0 * cos(ALPHA)
    contact = designed("ring 1:2", 30, backlash)
    assert contact.pushing.error_rad == pytest.approx(np.zeros(1200), abs=1e-13)
    assert contact.back.error_rad == pytest.approx(np.full(1200, backlash / base), abs=1e-13)
    # Turned counter-clockwise the driving gear pushes downwards at its left; the ring's teeth stand outside.
    for side, lean in ((contact.pushing, -1.0), (contact.back, 1.0)):
        touching = side.touching.kept(side.touching.flanks)
        place = touching.fixed_points(contact.placement)
        assert np.abs(((place + 30.0) / (1j * np.exp(1j * lean * ALPHA))).imag).max() <= 1e-12
        assert touching.lever_mm == pytest.approx(np.full(place.size, base), rel=1e-12)
        assert np.abs(touching.sliding_mm(contact.placement)) == pytest.approx(0.5 * np.abs(place + 30.0), abs=1e-10)


def test_sliding_of_a_circular_pair_is_the_closed_form() -> None:
    """(omega1 + omega2) times the distance from the pitch point, and from the velocities of both gears' points."""
    contact = designed("uniform 1:2", 24)
    for side in both(contact):
        touching = side.touching.kept(side.touching.flanks)
        place, sliding = touching.fixed_points(contact.placement), touching.sliding_mm(contact.placement)
        assert np.abs(sliding) == pytest.approx(1.5 * np.abs(place - 24.0), abs=1e-10)
        driving, driven = 1j * place, -0.5j * (place - 72.0)
        # The flank is across the line of action; outwards is away from the driving axis.
        flank = 1j * (place - 24.0) / np.abs(place - 24.0)
        flank *= np.sign((flank * place.conj()).real)
        assert sliding == pytest.approx(((driving - driven) * flank.conj()).real, abs=1e-9)
    # A pushing tooth slides outwards over the driven one until the pitch point is reached, then inwards.
    touching = contact.pushing.touching
    one = touching.kept(touching.flanks & (touching.driving_tooth == 6) & (touching.driven_tooth == 5))
    assert np.all(np.diff(one.sliding_mm(contact.placement)[np.argsort(one.position)]) < 0.0)
    largest = max(np.sqrt(26.0**2 - (24 * cos(ALPHA)) ** 2) - 24 * sin(ALPHA),
                  np.sqrt(50.0**2 - (48 * cos(ALPHA)) ** 2) - 48 * sin(ALPHA))  # fmt: skip
    assert contact.largest_sliding_mm.max() == pytest.approx(1.5 * largest, abs=1.5 * pi * MODULE / 20.0)


# --- clearance -----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("name", "teeth"), [("uniform 1:2", 24), ("ellipse", 37), ("sine", 100)])
def test_tips_clear_the_roots_by_what_the_rack_says(name: str, teeth: int) -> None:
    for side in both(designed(name, teeth)):
        for tips in (side.driving_tips, side.driven_tips):
            assert tips.over_root_mm == pytest.approx(0.25 * MODULE, abs=1e-9)
            assert 0.0 < tips.from_fillet_mm < 0.5 * MODULE


def test_tips_that_reach_into_the_roots_have_negative_clearance() -> None:
    """Negative control: a driven gear that was cut less deep than the driving gear's teeth are high."""
    pitch, pair = made("uniform", 25)
    shallow = toothed_pair(pitch, ToothForm(rack(addendum=0.8, dedendum=0.9, root_radius=0.2)), TOLERANCE)
    contact = as_designed(ToothedPair(pair.driving, shallow.driven, pair.cutter), placed(pitch))
    for side in both(contact):
        assert side.driving_tips.over_root_mm == pytest.approx(-0.1 * MODULE, abs=1e-9)
        assert side.driven_tips.over_root_mm == pytest.approx(0.45 * MODULE, abs=1e-9)


@pytest.mark.thorough
def test_clearance_of_corners_from_fillets_is_that_of_a_fine_outline() -> None:
    """Circular gears: a driving tip's corner on the line of centres, and the driven gear's chords below its flanks."""
    _, pair = made("uniform 1:2", 24, 5e-6)
    driven, depth = pair.driven.outline_mm @ [1, 1j], pair.driven.flanks.rack.flank_depth_mm
    below = driven[np.abs(driven) < 48.0 - depth]
    root = LineString(np.stack([below.real, below.imag], axis=1))
    # Tooth 1 of the driving gear stands in a driven space at phi1 = 0.  Turned by half its tip's width, back and on.
    half_tip = np.diff(pair.driving.sides.tip_mm[:2])[0] / 2.0 / 48.0
    corners = [(MODULE - 48.0) * np.exp(1j * turn) for turn in (half_tip, -half_tip)]
    expected = min(root.distance(Point(corner.real, corner.imag)) for corner in corners)
    assert designed("uniform 1:2", 24).pushing.driving_tips.from_fillet_mm == pytest.approx(expected, abs=1e-5)


# --- edges -----------------------------------------------------------------------------------------------------------


@cache
def fine(name: str, teeth: int, backlash_mm: float = 0.0) -> tuple[meshing.Pair, Placement]:
    """The pair as polygons so fine that they stand for the exact curves, and its positions."""
    pitch, pair = made(name, teeth, 2e-5, backlash_mm)
    placement = placed(pitch)
    polygons = [Polygon(gear.outline_mm) for gear in (pair.driving, pair.driven)]
    return meshing.Pair(*polygons, placement.phi1_rad, placement.phi2_rad, pitch.center_distance_mm), placement


@pytest.mark.tiers(slow=["ellipse-8-0.0", "ellipse-24-0.1"], rest="long")
@pytest.mark.parametrize(
    ("name", "teeth", "backlash_mm"),
    [("uniform", 8, 0.0), ("ellipse", 8, 0.0), ("long ellipse", 18, 0.0), ("ellipse", 24, 0.1),
     ("baler", 25, 0.1)],
)  # fmt: skip
def test_touching_angles_are_what_shapely_finds(name: str, teeth: int, backlash_mm: float) -> None:
    """Edges where no flanks touch, and flanks with backlash, which on such curves are not conjugate."""
    judge, placement = fine(name, teeth, backlash_mm)
    contact = designed(name, teeth, backlash_mm)
    unlike = np.argsort(-np.abs(contact.pushing.error_rad - np.median(contact.pushing.error_rad)))[:3]
    for row in (*unlike.tolist(), 0, placement.count // 3):
        back, on = judge.driven_play(row, tolerance=1e-6, limit=0.2)
        # Chords of 2e-5 mm on both outlines and the judge's own 1e-6 mm, at the lever of the contact.
        assert contact.pushing.error_rad[row] == pytest.approx(-back, abs=4.2e-5 / contact.pushing.first.lever_mm[row])
        assert contact.back.error_rad[row] == pytest.approx(on, abs=4.2e-5 / contact.back.first.lever_mm[row])


def test_edges_carry_where_contact_is_shorter_than_a_pitch() -> None:
    contact = designed("uniform", 8)
    assert contact.pushing.pairs.arcs.max() < 1.0
    edges = ~contact.pushing.first.flanks
    assert np.array_equal(edges, contact.pushing.simultaneous == 0)
    share = contact.pushing.pairs.arcs[0]
    assert edges.mean() == pytest.approx(1.0 - share, abs=2.0 / contact.placement.per_tooth)
    assert contact.pushing.error_rad[edges].max() < 0.0  # the driven gear lags until an edge takes over
    by_tooth = contact.pushing.variation_by_tooth(contact.pushing.error_rad)
    assert sorted(by_tooth) == list(range(1, 9))
    assert list(by_tooth.values()) == pytest.approx([contact.pushing.transmission_error_rad] * 8, rel=1e-6)


@pytest.mark.tiers(quick=["uniform-8-None"], rest="slow")
@pytest.mark.parametrize(
    ("name", "teeth", "relief"),
    [("uniform", 8, None), ("long ellipse", 18, None), ("baler", 25, TipRelief(0.05, 0.4, MODULE)), ("ring", 40, None)],
    ids=["uniform-8-None", "long ellipse-18-None", "baler-25-relief", "ring-40-None"],
)
def test_no_corner_that_touches_first_is_left_out(name: str, teeth: int, relief: TipRelief | None) -> None:
    """Beside all corners that come within half a millimetre of contact."""
    pitch, pair = made(name, teeth, relief=relief)
    contact = as_designed(pair, placed(pitch))
    for side, every in zip(both(contact), contacts_within(pair, contact.placement, 0.5), strict=True):
        lead = np.full(contact.placement.count, -np.inf)
        np.maximum.at(lead, every.position, every.lead_rad)
        assert side.first.lead_rad == pytest.approx(lead, abs=1e-12)
        behind = (lead[every.position] - every.lead_rad) * every.lever_mm
        few, many = (
            np.sum(behind <= share * TOUCHING_IN_PITCHES * contact.placement.pitch_mm) for share in (0.999999, 1.000001)
        )
        assert few <= side.touching.position.size <= many


@pytest.mark.tiers(thorough=["uniform-8-0.0"], rest="slow")
@pytest.mark.parametrize(
    ("name", "teeth", "backlash_mm"), [("baler", 25, 0.1), ("baler", 25, 0.0), ("uniform", 8, 0.0)]
)
def test_no_position_is_missed(name: str, teeth: int, backlash_mm: float) -> None:
    """Nor at the baler's joints, where idle flanks pass a jump of the curvature unequally, nor in undercut notches."""
    contact, outlines = designed(name, teeth, backlash_mm), written(name, teeth, 1e-4, backlash_mm)
    for side, error in ((contact.pushing, outlines.pushing_rad), (contact.back, outlines.back_rad)):
        assert np.abs((error - side.error_rad) * side.first.lever_mm).max() <= 2.0 * 1e-4


# --- counting --------------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class FlankPair:
    """A driving flank, its mate, found by where both cross the pitch curves, and heights that both still have."""

    meeting: int
    crossing_mm: float
    side: float
    low_mm: float
    high_mm: float


def heights(gear: ToothedGear, flank: int) -> list[tuple[float, float]]:
    """What is left of a flank: trimming may take a piece out of its middle."""
    sides = gear.sides
    runs = np.nonzero((sides.kind == FLANK) & (sides.owner == flank))[0]
    return [(float(sides.end[run]), float(sides.start[run])) for run in runs]


@cache
def flank_pairs(name: str, teeth: int, **tool: bool) -> tuple[list[FlankPair], float]:
    """All pairs of flanks that meet in a meeting cycle, and the cycle's length."""
    _, pair = made(name, teeth, **tool)
    own, other = pair.driving.flanks, pair.driven.flanks
    turns = lcm(pair.driving.teeth, pair.driven.teeth) // pair.driving.teeth
    found = []
    for turn in range(turns):
        for number, cross in enumerate(own.crossing_mm):
            crossing = float(cross + turn * own.curve.length_mm)
            gap = np.abs(np.mod(other.crossing_mm - crossing + 1.0, other.curve.length_mm) - 1.0)
            mate = int(np.argmin(gap))
            assert gap[mate] < 1e-6
            for low, high in heights(pair.driving, number):
                for other_low, other_high in heights(pair.driven, mate):
                    both_low, both_high = max(low, -other_high), min(high, -other_low)
                    if both_high > both_low:
                        meeting = turn * teeth + number // 2
                        found.append(FlankPair(meeting, crossing, float(own.side[number]), both_low, both_high))
    return found, turns * own.curve.length_mm


def height(one: FlankPair, rolled: Array, cycle: float) -> Array:
    """Where a pair of flanks touches when the gears have rolled so far."""
    ahead = np.mod(one.crossing_mm - rolled + cycle / 2.0, cycle) - cycle / 2.0
    return one.side * ahead * sin(ALPHA) * cos(ALPHA)


COUNTED = [("uniform 3:2", 30), ("ellipse", 37), ("sine", 25), ("baler", 86), ("baler", 25)]


@pytest.mark.slow
def test_the_contact_ratio_is_that_of_the_worse_side() -> None:
    """The baler's 25 teeth, as the method page has them."""
    pairs, _ = flank_pairs("baler", 25)
    pitches = {}
    for side in (-1.0, 1.0):
        arcs = np.zeros(max(one.meeting for one in pairs) + 1)
        for one in (one for one in pairs if one.side == side):
            arcs[one.meeting] += (one.high_mm - one.low_mm) / (sin(ALPHA) * cos(ALPHA) * pi * MODULE)
        pitches[side] = arcs.min()
    assert sorted(pitches.values()) == pytest.approx([1.16, 1.27], abs=0.005)
    assert designed("baler", 25).least_arc == pytest.approx(min(pitches.values()), abs=1e-9)


@pytest.mark.slow
@pytest.mark.parametrize(("name", "teeth"), COUNTED)
def test_arcs_of_contact_are_those_of_the_heights_that_are_left(name: str, teeth: int) -> None:
    pairs, _ = flank_pairs(name, teeth)
    for side, contact in zip((-1.0, 1.0), both(designed(name, teeth)), strict=True):
        arcs = np.zeros(contact.pairs.arcs.size)
        for one in (one for one in pairs if one.side == side):
            arcs[one.meeting] += (one.high_mm - one.low_mm) / (sin(ALPHA) * cos(ALPHA) * pi * MODULE)
        assert contact.pairs.arcs == pytest.approx(arcs, abs=1e-9)


@pytest.mark.tiers(slow=["baler-*"], rest="quick")
@pytest.mark.parametrize(("name", "teeth"), COUNTED)
def test_numbers_in_contact_are_what_counting_finds(name: str, teeth: int) -> None:
    contact = designed(name, teeth)
    pairs, cycle = flank_pairs(name, teeth)
    for side, found in zip((-1.0, 1.0), both(contact), strict=True):
        total = np.zeros(contact.placement.count, dtype=int)
        for one in (one for one in pairs if one.side == side):
            at = height(one, contact.placement.rolled_mm, cycle)
            total += (at >= one.low_mm - 1e-9) & (at <= one.high_mm + 1e-9)
        assert np.array_equal(found.simultaneous, total)


@pytest.mark.slow
def test_the_undercut_balers_gap_is_seen() -> None:
    contact = designed("baler", 18, undercut=True)
    assert min(side.pairs.arcs.min() for side in both(contact)) < 1.0
    assert min(side.simultaneous.min() for side in both(contact)) == 0


# --- flanks that are off their exact shape ---------------------------------------------------------------------------


@pytest.mark.thorough
def test_tip_relief_is_a_transmission_error_of_its_own_depth() -> None:
    """Circular gears whose tips are relieved from the pitch line on, so that a pair alone carries on relieved flanks.

    A pair that touches where a flank has lost a depth lets the driven gear lag by depth / base radius, to second order
    in the relief's slope.
    """
    relief = TipRelief(0.02, 0.0, MODULE)
    contact, base = designed("uniform", 25, relief=relief), 25.0 * cos(ALPHA)
    pairs, cycle = flank_pairs("uniform", 25)
    for side, found in zip((-1.0, 1.0), both(contact), strict=True):
        expected = np.full(contact.placement.count, np.inf)
        for one in (one for one in pairs if one.side == side):
            at = height(one, contact.placement.rolled_mm, cycle)
            lag = relief.amount_mm * (np.abs(at) / relief.full_mm) ** 2 / base
            expected = np.where((at >= one.low_mm) & (at <= one.high_mm), np.minimum(expected, lag), expected)
        assert found.first.flanks.mean() > 0.9
        assert side * found.error_rad == pytest.approx(expected, abs=0.02 * relief.amount_mm / base)
        assert found.transmission_error_rad > 0.1 * relief.amount_mm / base


@pytest.mark.parametrize(("amount_mm", "start"), [(0.03, 0.3), (0.004, 0.5)])
def test_contact_ratio_does_not_count_flanks_that_a_relief_holds_apart(amount_mm: float, start: float) -> None:
    """Circular gears: a pair touches from where it lags no more behind the one before it than counts as touching."""
    relief = TipRelief(amount_mm, start * MODULE, MODULE)
    contact, pitch = designed("uniform", 25, relief=relief), pi * MODULE

    def lag_mm(rolled_mm: float) -> float:
        high = abs(rolled_mm) * sin(ALPHA) * cos(ALPHA)
        return amount_mm * (max(high - relief.start_mm, 0.0) / (MODULE - relief.start_mm)) ** 2

    half = brentq(
        lambda rolled: lag_mm(rolled) - lag_mm(pitch - rolled) - TOUCHING_IN_PITCHES * pitch, 0.5 * pitch, pitch
    )
    for side in both(contact):
        assert side.pairs.arcs == pytest.approx(2.0 * half / pitch, abs=0.02)
        assert side.simultaneous.mean() == pytest.approx(2.0 * half / pitch, abs=0.06)
        assert side.reaches.min() > side.pairs.arcs.max() + 0.1
        touching = side.touching.kept(side.touching.flanks)
        place = touching.fixed_points(contact.placement)
        # Flanks touch between the base and the tip circles of both gears.
        for axis in (0.0, 50.0):
            assert 25.0 * cos(ALPHA) - 0.01 < np.abs(place - axis).min() <= np.abs(place - axis).max() < 27.0 + 1e-9
    plain = designed("uniform", 25)
    assert all(np.array_equal(side.pairs.arcs, side.reaches) for side in both(plain))
    assert (contact.held_apart, plain.held_apart) == (True, False)
    assert min(side.reaches.min() for side in both(contact)) == pytest.approx(plain.contact_ratio, abs=0.05)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["sine", "ellipse"])
def test_relieved_flanks_of_other_gears_touch_where_their_fine_outlines_do(name: str) -> None:
    relief = TipRelief(0.03, 0.2, MODULE)
    contact, outlines = designed(name, 25, relief=relief), written(name, 25, 1e-4, relief=relief)
    for side, error in ((contact.pushing, outlines.pushing_rad), (contact.back, outlines.back_rad)):
        assert np.abs((error - side.error_rad) * side.first.lever_mm).max() <= 2.0 * 1e-4
    assert contact.pushing.transmission_error_rad > 1e-4


# --- refusals ------------------------------------------------------------------------------------------------------


def test_gears_too_far_apart_are_refused_with_the_angle() -> None:
    pitch, pair = made("uniform", 25)
    far = replace(placed(pitch), center_distance_mm=pitch.center_distance_mm + 3.0 * MODULE)
    with pytest.raises(NoSuchMechanism, match=r"no tooth touches another at phi1 = 0 rad"):
        as_designed(pair, far)


def test_an_overlap_as_designed_is_refused_with_its_place() -> None:
    pitch, pair = made("ellipse", 37)
    near = as_designed(pair, replace(placed(pitch), center_distance_mm=pitch.center_distance_mm - 0.1))
    refuse_overlap(designed("ellipse", 37), TOLERANCE)
    with pytest.raises(NoSuchMechanism, match=r"run into each other by 0\.0\d+ mm near tooth \d+ of the driving gear"):
        refuse_overlap(near, TOLERANCE)


@pytest.mark.thorough
def test_written_outlines_see_the_same_overlap() -> None:
    """The exact curves and their outlines, brought too near: depths across the flanks agree to the chords."""
    pitch, pair = made("sine", 25)
    near = replace(placed(pitch), center_distance_mm=pitch.center_distance_mm - 0.1)
    contact, coarse = as_designed(pair, near), read(outlines(pair), pitch, pair, near)
    assert np.abs(contact.overlap_mm - coarse.overlap_mm).max() <= 2.0 * TOLERANCE
    assert contact.overlap_mm.min() > 2.0 * TOLERANCE


@pytest.mark.slow
@pytest.mark.parametrize("case", [("baler", 18, True), ("baler", 25, True), ("baler", 25, False), ("sine", 25, False)])
def test_gaps_of_contact_are_those_of_counting_between_positions(case: tuple[str, int, bool]) -> None:
    """Four hundred times as fine as the positions; the cycle's end is no end of a gap."""
    name, teeth, undercut = case
    contact, (pairs, cycle) = designed(name, teeth, undercut=undercut), flank_pairs(name, teeth, undercut=undercut)
    fine = np.linspace(0.0, cycle, 400 * contact.placement.count, endpoint=False)
    for side, found in zip((-1.0, 1.0), both(contact), strict=True):
        total = np.zeros(fine.size, dtype=int)
        for one in (one for one in pairs if one.side == side):
            at = height(one, fine, cycle)
            total += (at >= one.low_mm) & (at <= one.high_mm)
        touched = np.flatnonzero(total)
        assert found.pairs.fewest == total.min()
        assert found.pairs.contact_ratio == pytest.approx(total.mean(), abs=1e-3)
        longest = (np.max(np.diff(touched, append=touched[0] + fine.size)) - 1) / 400.0
        assert found.pairs.longest_gap == pytest.approx(longest, abs=0.01)
        assert found.pairs.longest_gap == 0.0 or total[400 * found.pairs.parted_at] == 0


def test_the_longest_gap_goes_on_across_the_seam() -> None:
    pairs, count = designed("ellipse", 25).pushing.pairs, designed("ellipse", 25).placement.count
    across = replace(pairs, gaps=np.array([[3.0, 3.5], [count - 0.75, count + 1.5]]))
    assert (across.longest_gap, across.parted_at) == (2.25, 0)
    assert replace(pairs, gaps=np.empty((0, 2))).longest_gap == 0.0


@pytest.mark.parametrize("name", ["ellipse", "log-generator", "pump-1-2"])
def test_every_meeting_near_any_place_is_found(name: str) -> None:
    """Beside all meetings held against all places one by one, also beyond the ends of the cycle."""
    found = drive(name)
    teeth, even = found.teeth, placed(found.pitch)
    covered = even.toothed is not None
    rolled = np.random.default_rng(5).uniform(*((0.0, 1.0) if covered else (-1.0, 2.0)), 40) * even.cycle_mm
    placement = placed_at(found.pitch, even, rolled)
    met, expected = single_meetings(teeth, placement), []
    whole = meetings(teeth, even)
    for number, (side, own, other) in enumerate(zip(whole.side, whole.driving, whole.driven, strict=True)):
        crossing = whole.driving_ahead_mm[number, 0] + whole.position[number, 0] * even.step_mm
        for place, at in enumerate(rolled):
            ahead = crossing - at
            ahead = ahead if covered else (ahead + even.cycle_mm / 2.0) % even.cycle_mm - even.cycle_mm / 2.0
            if abs(ahead) <= REACH_IN_PITCHES * even.pitch_mm:
                other_ahead = ahead + whole.driven_ahead_mm[number, 0] - whole.driving_ahead_mm[number, 0]
                expected.append((side, own, other, place, round(ahead, 9), round(other_ahead, 9)))
    both_ahead = (np.round(one[:, 0], 9) for one in (met.driving_ahead_mm, met.driven_ahead_mm))
    got = zip(met.side, met.driving, met.driven, met.position[:, 0], *both_ahead, strict=True)
    assert sorted(got) == sorted(expected)
