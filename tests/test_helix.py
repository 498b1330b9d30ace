"""Helical and herringbone solids: closed forms of circular gears, exact sections, conjugacy, and what must fail."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cache
from math import cos, pi, radians, tan
from pathlib import Path
from tempfile import TemporaryDirectory
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
import shapely
from scipy.interpolate import BSpline
from shapely import Polygon, affinity
from trimesh import Trimesh

from drives import drive_of_text
from ncgear.contact.designed.as_designed import SideContact, as_designed
from ncgear.contact.placement import placed
from ncgear.errors import DesignError, NoSuchMechanism, Unanswered, WrongInput
from ncgear.files.build import build
from ncgear.files.read_back import read_back, stl_bytes
from ncgear.numerics.extrema import Extremum
from ncgear.pitch.pair import PitchPair, sized_pair
from ncgear.pitch.shape import Gear
from ncgear.project.drive import Drive
from ncgear.ratio.laws.ellipse import elliptical_law
from ncgear.ratio.laws.expression import ratio_expression_law
from ncgear.ratio.laws.uniform import uniform_law
from ncgear.ratio.transmission import Lobes, Transmission
from ncgear.solids.helical.even_tips import ceilings_over, heights_fitted, with_even_tips
from ncgear.solids.helical.helix import Hand, Helix
from ncgear.solids.helical.mesh import helical_pair
from ncgear.solids.helical.patches import _interpolated, _sharing_edges
from ncgear.solids.helical.sections import Pieces, Sections, pieces_of
from ncgear.solids.helical.stack import (
    MOST_STEPS,
    ColumnPlaces,
    Stack,
    StrayLimits,
    close_columns,
    close_stacks,
    sagittas,
    spread_columns,
    stacked,
)
from ncgear.solids.mesh.pair import SolidPair
from ncgear.solids.plan.body import Blank, Bore, Keyway
from ncgear.solids.plan.room import full_disc, largest_bore_mm
from ncgear.teeth.form import TipLimits, ToothForm
from ncgear.teeth.gear import ToothedPair, toothed_pair
from ncgear.teeth.tips import Limit
from oracles import meshing
from pairs import baler_law, rack, sine_law

TOLERANCE = 0.005
MODULE = 2.0
WIDTH = 14.0
ANGLE = radians(20.0)

LAWS: dict[str, tuple[Callable[[], Transmission], int]] = {
    "circular": (lambda: uniform_law(Lobes()), 20),
    "ellipse": (lambda: elliptical_law(0.3, 0.7, Lobes()), 21),
    "one on two": (lambda: ratio_expression_law("2 + 0.5*cos(phi)", Lobes(1, 2), scale_to_close=True), 18),
    "concave": (lambda: sine_law(0.2), 30),
}


@dataclass(frozen=True)
class Made:
    """A helical pair and what it was made from."""

    pitch: PitchPair
    helix: Helix
    solids: SolidPair

    def mesh(self, gear: str) -> Trimesh:
        solid = self.solids.driving if gear == "driving" else self.solids.driven
        return solid.mesh


def pitch_of(name: str) -> PitchPair:
    law, teeth = LAWS[name]
    return sized_pair(law(), teeth, MODULE, None)


@cache
def made(
    name: str, hand: Hand = Hand.RIGHT, *, herringbone: bool = False, bore: Bore | None = None, marked: bool = False
) -> Made:
    pitch, helix = pitch_of(name), Helix(ANGLE, WIDTH, hand, herringbone)
    blank = Blank(WIDTH, bore, marked)
    solids = helical_pair(pitch, ToothForm(rack()), helix, {Gear.DRIVING: blank, Gear.DRIVEN: blank}, TOLERANCE)
    return Made(pitch, helix, solids)


def advance(height: float, hand: Hand, *, herringbone: bool = False) -> float:
    """Said once more: both gears' teeth go along growing arc length, clockwise on the driving gear, for a left hand."""
    rolled = min(height, WIDTH - height) if herringbone else height
    return rolled * tan(ANGLE) * {Hand.RIGHT: -1.0, Hand.LEFT: 1.0}[hand]


@cache
def exact(name: str, advance_mm: float, tolerance: float = 1e-4) -> ToothedPair:
    return toothed_pair(pitch_of(name), ToothForm(rack()), tolerance, advance_mm=advance_mm)


def section(mesh: Trimesh, height: float) -> Polygon:
    """Outer boundary of a mesh's section, by following its edges."""
    rings = meshing.section_rings(np.asarray(mesh.vertices), np.asarray(mesh.faces), height)
    return max((Polygon(ring) for ring in rings), key=lambda polygon: polygon.area)


def apart(one: Polygon, other: Polygon) -> float:
    """Largest distance of either boundary's vertices from the other boundary."""
    return max(_farthest(one, other), _farthest(other, one))


def _farthest(one: Polygon, other: Polygon) -> float:
    ring = shapely.get_coordinates(other.exterior)
    chords = shapely.STRtree(shapely.linestrings(np.stack([ring[:-1], ring[1:]], axis=1)))
    points = shapely.points(shapely.get_coordinates(one.exterior))
    return float(chords.query_nearest(points, all_matches=False, return_distance=True)[1].max())


HEIGHTS = [1e-6, WIDTH / 4, 0.37 * WIDTH, WIDTH / 2, 3 * WIDTH / 4, WIDTH * (1.0 - 1e-7)]


# --- the advance --------------------------------------------------------------------------------------------------


def test_advance_of_helical_teeth() -> None:
    helix = Helix(radians(30.0), 12.0, Hand.LEFT)
    assert helix.advance_mm(12.0) == pytest.approx(12.0 / 3.0**0.5, rel=1e-15)
    assert helix.largest_advance_mm == helix.advance_mm(12.0)
    assert replace(helix, hand=Hand.RIGHT).advance_mm(5.0) == -helix.advance_mm(5.0)
    assert helix.thrust_share == pytest.approx(tan(radians(30.0)))


def test_advance_of_herringbone_teeth_goes_back_from_half_way() -> None:
    helix = Helix(radians(30.0), 12.0, Hand.LEFT, herringbone=True)
    assert [helix.advance_mm(z) for z in (0.0, 12.0)] == [0.0, 0.0]
    assert helix.advance_mm(2.0) == helix.advance_mm(10.0) == replace(helix, herringbone=False).advance_mm(2.0)
    assert helix.largest_advance_mm == helix.advance_mm(6.0)
    assert helix.thrust_share == 0.0


@pytest.mark.tiers(slow=["one on two"], rest="long")
@pytest.mark.parametrize("name", LAWS)
def test_a_whole_pitch_of_advance_gives_the_same_outline(name: str) -> None:
    """And so do whole turns, in which every tooth keeps its place in the file."""
    pitch, first = pitch_of(name), exact(name, 0.0)
    moved = exact(name, MODULE * pi)
    turned = exact(name, 3.0 * pitch.driving.length_mm)
    for gear in ("driving", "driven"):
        outlines = [getattr(pair, gear).outline_mm for pair in (first, moved, turned)]
        assert apart(Polygon(outlines[0]), Polygon(outlines[1])) <= 1e-4
    np.testing.assert_allclose(turned.driving.outline_mm, first.driving.outline_mm, rtol=0.0, atol=1e-9)


def test_half_a_pitch_puts_a_space_where_the_tooth_was() -> None:
    first, moved = exact("ellipse", 0.0).driving, exact("ellipse", MODULE * pi / 2).driving
    assert apart(Polygon(first.outline_mm), Polygon(moved.outline_mm)) > 0.5 * MODULE


# --- circular gears: the section is the outline, turned ------------------------------------------------------------


@pytest.mark.tiers(quick=["7.0-right"], rest="long")
@pytest.mark.parametrize("hand", list(Hand))
@pytest.mark.parametrize("height", HEIGHTS)
def test_circular_sections_are_turned_by_the_hand(hand: Hand, height: float) -> None:
    radius, sense = 20 * MODULE / 2, {Hand.RIGHT: 1.0, Hand.LEFT: -1.0}[hand]
    turn = sense * height * tan(ANGLE) / radius
    for gear, own in (("driving", turn), ("driven", -turn)):
        outline = Polygon(getattr(exact("circular", 0.0), gear).outline_mm)
        turned = affinity.rotate(outline, own, origin=(0.0, 0.0), use_radians=True)
        assert apart(section(made("circular", hand).mesh(gear), height), turned) <= TOLERANCE
        if height > 0.1:
            wrong = affinity.rotate(outline, -own, origin=(0.0, 0.0), use_radians=True)
            assert apart(section(made("circular", hand).mesh(gear), height), wrong) > 10.0 * TOLERANCE


@pytest.mark.tiers(quick=["False"], rest="long")
@pytest.mark.parametrize("herringbone", [False, True])
def test_circular_volume_is_area_times_width(herringbone: bool) -> None:
    pair = made("circular", herringbone=herringbone)
    outline = Polygon(exact("circular", 0.0).driving.outline_mm)
    volume = pair.mesh("driving").volume
    # No facet is farther from the surface than the tolerance.
    assert abs(volume - outline.area * WIDTH) <= TOLERANCE * outline.length * WIDTH
    # Both ways: what is cut off convex tips and left in hollow roots comes to less than a tenth of that.
    assert volume == pytest.approx(outline.area * WIDTH, rel=1e-4)


def test_steps_follow_from_the_turning_of_the_tip_circle() -> None:
    """A step d of advance turns the tip circle by d / r; its chord passes it by r_a (1 - cos(d / 2 r))."""
    radius, tip = 20.0, 22.0
    sections = Sections(pitch_of("circular"), ToothForm(rack()), Helix(ANGLE, WIDTH, Hand.RIGHT), TOLERANCE)
    for sagitta in (1e-4, 1e-3, 1e-2):
        step = sections.helix.largest_advance_mm / sections.steps_within(sagitta)
        assert tip * (1.0 - cos(step / radius / 2.0)) <= sagitta
        wider = sections.helix.largest_advance_mm / (sections.steps_within(sagitta) - 1)
        assert tip * (1.0 - cos(wider / radius / 2.0)) > sagitta * 0.999


def test_steps_follow_from_the_worst_land_of_both_gears() -> None:
    """|k| (1 + h k) d^2 / 8 of lands up to 2 mm outside and 2.5 mm inside, on a hollow and on a sharp pitch curve."""
    flanks = SimpleNamespace(tip_height_mm=np.array([2.0, 1.0]), root_depth_mm=np.array([1.5, 2.5]))
    helix = Helix(ANGLE, WIDTH, Hand.RIGHT)
    for bends, worst in (((-0.1, 0.02), 0.1 * 1.25), ((-0.02, 0.1), 0.1 * 1.2)):
        level = (Extremum(0.01, 0.0), Extremum(0.01, 0.0))
        curved = (Extremum(bends[0], 0.0), Extremum(bends[1], 0.0))
        pitch: Any = SimpleNamespace(curvature_range={Gear.DRIVING: level, Gear.DRIVEN: curved})
        sections = Sections(pitch, ToothForm(rack()), helix, TOLERANCE)
        section: Any = SimpleNamespace(of=lambda gear: SimpleNamespace(flanks=flanks))
        sections._made[0.0] = section
        assert sections.sagitta_mm(3) == pytest.approx(worst * (helix.largest_advance_mm / 3.0) ** 2 / 8.0)


def test_a_section_is_cut_where_lands_end_and_flanks_pass_into_fillets() -> None:
    """r^2 - 2 r f + f^2 / sin^2(alpha) is the square of the radius at which a circular flank ends, f below the line."""
    gear, radius = exact("circular", 0.3).driving, 20.0
    pieces, basic = pieces_of(gear), rack()
    depth = basic.flank_depth_mm
    joint = (radius**2 - 2.0 * radius * depth + (depth / np.sin(basic.pressure_angle_rad)) ** 2) ** 0.5
    root, tip = radius - basic.dedendum_mm, radius + basic.addendum_mm
    found = np.hypot(*pieces.at(np.arange(pieces.count), np.zeros(pieces.count)).T).reshape(-1, 6)
    assert found == pytest.approx(np.tile([root, joint, tip, tip, joint, root], (20, 1)), abs=1e-5)


def test_what_strays_between_two_sections_is_the_closed_form_of_a_circle() -> None:
    """A chord over the turn t of a circular gear passes its tip circle at r (1 - cos(t / 2))."""
    radius, tip = 20.0, 22.0
    found = {}
    for step in (2.0, 1.0):
        ends = [pieces_of(exact("circular", s).driving) for s in (0.0, step)]
        limits = StrayLimits(1e-4, 1e-3)
        stack = stacked(np.array([0.0, 1.0]), ends, spread_columns(ends, limits), limits)
        middle = pieces_of(exact("circular", step / 2.0).driving)
        found[step] = float(stack.strays_mm(np.array([0]), [middle]).max())
        assert found[step] == pytest.approx(tip * (1.0 - cos(step / radius / 2.0)), rel=0.05)
    assert found[2.0] / found[1.0] == pytest.approx(4.0, rel=0.1)


# --- non-circular gears ---------------------------------------------------------------------------------------------


@pytest.mark.tiers(slow=["one on two-False"], rest="long")
@pytest.mark.parametrize(
    ("name", "herringbone"),
    # A section of the concave gears takes half a second: half as many do for them.
    [("ellipse", False), ("ellipse", True), ("one on two", False), ("one on two", True), ("concave", True)],
)
def test_sections_of_the_written_file_are_exact(name: str, herringbone: bool) -> None:
    pair = made(name, herringbone=herringbone)
    for gear in ("driving", "driven"):
        again = read_back(stl_bytes(pair.mesh(gear)), pair.mesh(gear)).as_trimesh()
        for height in HEIGHTS:
            teeth = exact(name, advance(height, Hand.RIGHT, herringbone=herringbone))
            wanted = Polygon(getattr(teeth, gear).outline_mm)
            assert apart(section(again, height), wanted) <= TOLERANCE


UNDERCUT = ToothForm(rack(), limits=TipLimits(avoid_undercut=False))


@pytest.mark.slow
def test_curvature_that_jumps_is_followed_too() -> None:
    """The baler's undercut teeth have trimmed corners that come, move and go with height."""
    pitch = sized_pair(baler_law(), 86, MODULE, None)
    helix = Helix(radians(15.0), 4.0, Hand.LEFT)
    solids = helical_pair(pitch, UNDERCUT, helix, {gear: Blank(4.0) for gear in Gear}, TOLERANCE)
    sides = []
    for height in (0.9, 2.1, 3.3):
        teeth = toothed_pair(pitch, UNDERCUT, 2e-4, advance_mm=helix.advance_mm(height))
        assert apart(section(solids.driving.mesh, height), Polygon(teeth.driving.outline_mm)) <= TOLERANCE
        assert apart(section(solids.driven.mesh, height), Polygon(teeth.driven.outline_mm)) <= TOLERANCE
        sides.append(teeth.driven.sides)
    assert sides[0].owner.size > sides[-1].owner.size
    assert 0.1 < np.max(np.abs(sides[0].flank_range()[1] - sides[-1].flank_range()[1])) < 0.2
    assert np.any(sides[-1].flank_range()[1] > 0.3 - teeth.driven.flanks.flank_depth_mm)


@pytest.mark.slow
def test_tips_that_jump_are_refused_with_height_and_tooth() -> None:
    """Just above z = 0.42 mm a mate of tooth 29 ceases to be undercut: its tip may be 0.42 mm higher at once, and the
    space beside tooth 28 of the other gear is as much deeper."""
    pitch, helix = sized_pair(baler_law(), 86, MODULE, None), Helix(radians(15.0), 0.6, Hand.LEFT)
    tips = [
        toothed_pair(pitch, ToothForm(rack()), TOLERANCE, advance_mm=helix.advance_mm(z)).driving.flanks.tip_height_mm
        for z in (0.425, 0.43)
    ]
    assert np.argmax(np.abs(tips[1] - tips[0])) // 2 + 1 == 29
    assert np.max(np.abs(tips[1] - tips[0])) > 0.4
    problem = r"abruptly at z = 0\.42\d* mm .* tooth 28 of the driven gear .* gears\.undercut: allow"
    with pytest.raises(NoSuchMechanism, match=problem) as caught:
        helical_pair(pitch, ToothForm(rack()), helix, {gear: Blank(0.6) for gear in Gear}, 4.0 * TOLERANCE)
    assert caught.value.key == "gears.helix"


def read_sections(pair: SolidPair, height: float) -> list[Polygon]:
    """Both gears' sections at a height, as read back from their files."""
    return [
        section(read_back(stl_bytes(one.mesh), one.mesh).as_trimesh(), height) for one in (pair.driving, pair.driven)
    ]


@pytest.mark.tiers(slow=["86-0.6-15.0-0.02-False"], rest="long")
@pytest.mark.parametrize(
    ("teeth", "width", "angle_deg", "tolerance", "herringbone"),
    [(86, 0.6, 15.0, 4.0 * TOLERANCE, False), (25, 12.0, 20.0, 6.0 * TOLERANCE, True)],
)
def test_tips_that_would_jump_are_led_up_to_the_jumps(
    teeth: int, width: float, angle_deg: float, tolerance: float, herringbone: bool
) -> None:
    """The baler's: solids are sound, exact under their ceilings, and run without overlap at every height."""
    pitch, helix = (
        sized_pair(baler_law(), teeth, MODULE, None),
        Helix(radians(angle_deg), width, Hand.LEFT, herringbone),
    )
    form = with_even_tips(pitch, ToothForm(rack(), limits=TipLimits(0.2 * MODULE)), helix)
    pair = helical_pair(pitch, form, helix, {gear: Blank(width) for gear in Gear}, tolerance)
    assert pair.driving.mesh.is_watertight
    assert pair.driven.mesh.is_watertight
    for height in (0.12 * width, 0.71 * width, 0.93 * width):
        made = read_sections(pair, height)
        exact = toothed_pair(pitch, form, 2e-4, advance_mm=helix.advance_mm(height))
        assert apart(made[0], Polygon(exact.driving.outline_mm)) <= tolerance
        assert apart(made[1], Polygon(exact.driven.outline_mm)) <= tolerance
        report = judged_on(pitch, *made)
        assert report.overlap_depth.max() <= 2.0 * tolerance
        assert report.gap.max() <= 2.0 * tolerance


def test_sections_are_fitted_over_the_helix_and_no_farther_than_a_pitch() -> None:
    for angle, sections in ((0.5, 5), (10.0, 20), (60.0, 48)):
        helix = Helix(radians(angle), WIDTH, Hand.RIGHT)
        heights, step = heights_fitted(helix, MODULE * pi)
        assert [helix.advance_mm(z) for z in heights] == pytest.approx([-step * i for i in range(sections)])
        assert (sections - (angle < 60.0)) * step == pytest.approx(min(helix.largest_advance_mm, MODULE * pi))


@pytest.mark.parametrize("turned", [0.0, 0.3])
def test_what_seems_to_stray_is_the_bend_across_the_outline(turned: float) -> None:
    """A square that grows with the square of the height: straight lines over a step h are off by X'' h^2 / 8."""
    corners = np.exp(1j * (turned + np.arange(4) * pi / 2.0))
    heights = np.array([0.0, 1.0, 2.0])
    rings = (heights**2)[:, None, None] * np.stack([corners.real, corners.imag], axis=-1)
    columns = ColumnPlaces(np.zeros(4, dtype=int), np.arange(4.0))
    assert Stack(heights, columns, rings).seems_to_stray_mm() == pytest.approx([0.25, 0.25], rel=1e-12)


@pytest.mark.parametrize("lower", [0.6, 0.99])
def test_ceilings_rise_from_the_lower_side_of_each_jump(lower: float) -> None:
    """Tips are 1 mm high, and less along a stretch: from its ends on the ceiling rises by half, both ways round."""
    length, step, count = 60.0, 0.25, 240
    at = np.arange(count) * step
    high = np.where((at > 20.1) & (at < 30.1), lower, 1.0)
    fits = []
    for start in range(4):
        tips: Any = SimpleNamespace(
            flanks=SimpleNamespace(
                crossing_mm=np.repeat(at[start::4], 2) + length * (start == 2),
                tip_height_mm=np.repeat(high[start::4], 2),
                curve=SimpleNamespace(length_mm=length),
                rack=SimpleNamespace(module_mm=1.0),
            )
        )
        fits.append((tips, tips))
    for ceiling in ceilings_over(fits, step):
        assert (ceiling.length_mm, ceiling.at_mm.shape) == (length, (2, count))
        for places, heights in zip(ceiling.at_mm, ceiling.height_mm, strict=True):
            assert places == pytest.approx(at)
            ends = np.array([20.0, 20.25, 30.0, 30.25])
            apart = np.abs(places[:, None] - ends)
            wanted = np.minimum(lower + 0.5 * np.minimum(apart, length - apart).min(axis=1), 10.0)
            assert heights == pytest.approx(wanted)
        assert ceiling.over(np.array([25.0, 21.0, 80.125, 35.0])) == pytest.approx(
            lower + np.array([2.375, 0.375, 0.0, 2.375])
        )


def test_a_bump_of_a_section_strays_after_the_column_before_it() -> None:
    """Of an upright square column, whose side has a bump of 0.3 mm out of it and another of 0.2 mm into it."""
    square = np.array([[0.0, 0.0], [10.0, 0.0], [10.0, 10.0], [0.0, 10.0]])
    columns = ColumnPlaces(np.arange(4), np.zeros(4))
    stack = Stack(np.array([0.0, 1.0]), columns, np.stack([square, square]))
    outline = np.insert(square, [1, 3], [[2.5, -0.3], [7.5, 9.8]], axis=0)
    pieces: Any = SimpleNamespace(points_mm=np.vstack([outline, outline[:1]]))
    assert stack.strays_mm(np.array([0]), [pieces]) == pytest.approx(np.array([[0.3, 0.0, 0.2, 0.0]]), abs=0.02)


@pytest.mark.thorough
def test_surfaces_of_round_helical_teeth_are_the_section_turned() -> None:
    """By the advance over the radius at every height; they stray from the outline as far as they say, and join."""
    sections = Sections(pitch_of("circular"), ToothForm(rack()), Helix(ANGLE, WIDTH, Hand.LEFT), TOLERANCE)
    found = _interpolated(sections, Gear.DRIVING, 4, 4)
    share = np.linspace(0.0, 1.0, 41)

    def at(height: float) -> np.ndarray:
        along = BSpline(found.up, found.poles_mm.transpose(2, 0, 1, 3), 3)(height)
        points = BSpline(found.along, along.swapaxes(0, 1), 3)(share)
        assert points[..., 2] == pytest.approx(np.full(points.shape[:2], height))
        return np.asarray(points[..., 0] + 1j * points[..., 1])

    for height in (WIDTH / 4.0, WIDTH):
        turned = at(0.0) * np.exp(-1j * height * tan(ANGLE) / 20.0)
        assert np.abs(at(height) - turned).max() < 1e-10
        assert np.abs(at(height)[-1] - np.roll(at(height)[0], -1)).max() < 1e-10
    outline = shapely.LinearRing(exact("circular", 0.0).driving.outline_mm)
    strayed = shapely.distance(outline, shapely.points(at(0.0).real, at(0.0).imag)).max()
    assert 0.9 * strayed < found.deviation_mm < 2.0 * strayed
    with pytest.raises(Unanswered, match="where they should meet"):
        _sharing_edges(found.poles_mm[::2], TOLERANCE)


def test_columns_are_added_where_an_outline_strays_and_nowhere_else() -> None:
    """Of a half disc: its side needs none, its arc so many that each cuts off at most what is allowed."""
    arc = 20.0 * np.exp(1j * np.linspace(0.0, pi, 2001))
    points = np.column_stack([arc.real, arc.imag])
    length = np.append(0.0, np.cumsum(np.hypot(*np.diff(points, axis=0).T)))
    pieces = Pieces(
        np.vstack([points, points[:1]]),
        np.append(length, length[-1] + 40.0),
        np.array([0.0, length[-1], length[-1] + 40.0]),
    )
    found = close_columns(ColumnPlaces(np.array([0, 1]), np.zeros(2)), [pieces, pieces], StrayLimits(0.1, 1e-3))
    ring = found.rings([pieces])[0]
    assert sagittas(found, pieces, ring).max() <= 0.1
    chords = np.count_nonzero(found.piece == 0)
    assert 20.0 * (1.0 - cos(pi / 2.0 / chords)) <= 0.1 < 20.0 * (1.0 - cos(pi / chords))
    assert np.count_nonzero(found.piece == 1) == 1


def test_columns_are_halved_where_they_are_marked_and_spread_as_wanted() -> None:
    """Half way to the next one or to the end of the piece; spread where one interval wants four parts."""
    columns = ColumnPlaces(np.array([0, 0, 1]), np.array([0.0, 0.5, 0.0]))
    halved = columns.halved(np.array([False, True, True]))
    assert (halved.piece.tolist(), halved.share.tolist()) == ([0, 0, 0, 1, 1], [0.0, 0.5, 0.75, 0.0, 0.5])
    spread = columns.spread(np.array([3.8, 0.0, 0.5]))
    assert spread.piece.tolist() == [0, 0, 0, 0, 1]
    # All parts but a thousandth are in the first half of the piece.
    assert spread.share == pytest.approx([0.0, 0.125, 0.25, 0.375, 0.0], abs=2e-3)


def test_even_tips_change_nothing_where_none_jumps() -> None:
    pitch, helix = pitch_of("ellipse"), Helix(ANGLE, WIDTH, Hand.RIGHT)
    form = with_even_tips(pitch, ToothForm(rack()), helix)
    plain, even = (toothed_pair(pitch, one, TOLERANCE, advance_mm=2.0) for one in (ToothForm(rack()), form))
    np.testing.assert_array_equal(plain.driving.outline_mm, even.driving.outline_mm)


@pytest.mark.slow
def test_teeth_whose_lands_are_shortened_in_some_sections_only() -> None:
    pitch = sized_pair(elliptical_law(0.4, 0.7, Lobes()), 25, MODULE, None)
    form, helix = ToothForm(rack(), limits=TipLimits(least_land_mm=1.45)), Helix(ANGLE, WIDTH, Hand.RIGHT)
    first, last = (
        toothed_pair(pitch, form, TOLERANCE, advance_mm=helix.advance_mm(z)).driving.shortened(Limit.LAND)
        for z in (0.0, 3.0)
    )
    assert set(first) ^ set(last)
    assert set(first) & set(last)
    solids = helical_pair(pitch, form, helix, {gear: Blank(WIDTH) for gear in Gear}, TOLERANCE)
    again = read_back(stl_bytes(solids.driving.mesh), solids.driving.mesh).as_trimesh()
    for height in (1.0, 6.3):
        teeth = toothed_pair(pitch, form, 2e-4, advance_mm=helix.advance_mm(height))
        assert apart(section(again, height), Polygon(teeth.driving.outline_mm)) <= TOLERANCE


def judged(name: str, driving: Polygon, driven: Polygon) -> meshing.MeshingReport:
    return judged_on(pitch_of(name), driving, driven)


def judged_on(pitch: PitchPair, driving: Polygon, driven: Polygon) -> meshing.MeshingReport:
    turn = 2.0 * pi * max(1, pitch.transmission.lobes.driven)
    phi1 = np.linspace(0.0, turn, 102)
    phi2 = pitch.transmission.driven_angle(phi1).value
    return meshing.Pair(driving, driven, phi1, phi2, pitch.center_distance_mm).report(101)


@pytest.mark.tiers(slow=["one on two-False"], rest="long")
@pytest.mark.parametrize("herringbone", [False, True])
@pytest.mark.parametrize("name", ["ellipse", "one on two"])
def test_sections_at_one_height_mesh_at_the_same_angles(name: str, herringbone: bool) -> None:
    pair = made(name, Hand.LEFT, herringbone=herringbone)
    for height in (0.31 * WIDTH, 0.8 * WIDTH):
        report = judged(name, section(pair.mesh("driving"), height), section(pair.mesh("driven"), height))
        # Each section strays by one tolerance at most; without backlash the flanks touch.
        assert report.overlap_depth.max() <= 2.0 * TOLERANCE
        assert report.gap.max() <= 2.0 * TOLERANCE


def test_a_rigid_twist_of_non_circular_gears_does_not_mesh() -> None:
    teeth, pitch = exact("ellipse", 0.0), pitch_of("ellipse")
    twist = advance(WIDTH, Hand.RIGHT) / (pitch.driving.length_mm / (2.0 * pi))
    driving = affinity.rotate(Polygon(teeth.driving.outline_mm), -twist, origin=(0.0, 0.0), use_radians=True)
    driven = affinity.rotate(Polygon(teeth.driven.outline_mm), twist, origin=(0.0, 0.0), use_radians=True)
    assert judged("ellipse", driving, driven).overlap_depth.max() > 100.0 * TOLERANCE


@pytest.mark.slow
def test_gears_of_one_hand_do_not_mesh() -> None:
    right, left = made("ellipse", Hand.RIGHT), made("ellipse", Hand.LEFT)
    report = judged("ellipse", section(right.mesh("driving"), WIDTH / 5), section(left.mesh("driven"), WIDTH / 5))
    assert report.overlap_depth.max() > 100.0 * TOLERANCE


@pytest.mark.slow
def test_herringbone_teeth_are_alike_above_and_below_half_way() -> None:
    for gear in ("driving", "driven"):
        mesh = made("ellipse", herringbone=True).mesh(gear)
        for height in (1e-6, 0.2 * WIDTH, 0.45 * WIDTH):
            assert apart(section(mesh, height), section(mesh, WIDTH - height)) <= 1e-9
        assert WIDTH / 2 in mesh.vertices[:, 2]
        mirrored = mesh.vertices * [1.0, 1.0, -1.0] + [0.0, 0.0, WIDTH]
        order, other = np.lexsort(mesh.vertices.T), np.lexsort(mirrored.T)
        np.testing.assert_allclose(mesh.vertices[order], mirrored[other], rtol=0.0, atol=1e-12)


@pytest.mark.slow
def test_helical_teeth_are_not_alike_above_and_below_half_way() -> None:
    mesh = made("ellipse").mesh("driving")
    assert apart(section(mesh, 1.0), section(mesh, WIDTH - 1.0)) > 1.0


# --- bores and holes ------------------------------------------------------------------------------------------------


@pytest.mark.tiers(slow=["False-bore2"], rest="long")
@pytest.mark.parametrize("bore", [None, Bore(10.0), Bore(10.0, Keyway(3.0, 1.4))])
@pytest.mark.parametrize("herringbone", [False, True])
def test_bore_and_index_hole_go_straight_through(bore: Bore | None, herringbone: bool) -> None:
    pair = made("ellipse", herringbone=herringbone, bore=bore, marked=True)
    for solid in (pair.solids.driving, pair.solids.driven):
        hole = solid.index_hole
        assert hole is not None
        assert solid.mesh.is_watertight
        assert solid.mesh.euler_number == (-2 if bore else 0)
        for height in HEIGHTS:
            rings = meshing.section_rings(np.asarray(solid.mesh.vertices), np.asarray(solid.mesh.faces), height)
            assert len(rings) == (3 if bore else 2)
            smallest = min((Polygon(ring) for ring in rings), key=lambda polygon: polygon.area)
            assert smallest.centroid.coords[0] == pytest.approx((hole.x_mm, hole.y_mm), abs=1e-6)
            # The walls of one and a half modules to the outline, in every section.
            assert section(solid.mesh, height).exterior.distance(smallest) > 1.49 * MODULE


@pytest.mark.slow
def test_a_bore_must_fit_into_every_section() -> None:
    """Where a tooth stands at z = 0 there is room for a larger bore than where a space has come to stand higher up."""
    pitch = sized_pair(elliptical_law(0.3, 0.0, Lobes()), 21, MODULE, None)
    outline = toothed_pair(pitch, ToothForm(rack()), TOLERANCE).driving.outline_mm
    room = largest_bore_mm(full_disc(outline, "gears.driving"), Bore(100.0), MODULE, TOLERANCE)
    helix, plain = Helix(ANGLE, WIDTH, Hand.RIGHT), Blank(WIDTH)
    blanks = {Gear.DRIVING: Blank(WIDTH, Bore(room)), Gear.DRIVEN: plain}
    with pytest.raises(WrongInput, match="largest that fits") as caught:
        helical_pair(pitch, ToothForm(rack()), helix, blanks, TOLERANCE)
    assert caught.value.key == "gears.driving.bore_mm"
    stated = float(caught.value.problem.split("fits is ")[1].split(" mm")[0])
    assert stated < room - 0.05
    helical_pair(pitch, ToothForm(rack()), helix, {**blanks, Gear.DRIVING: Blank(WIDTH, Bore(stated))}, TOLERANCE)


# --- refusals -------------------------------------------------------------------------------------------------------


@pytest.mark.slow
def test_a_section_without_teeth_is_refused_with_its_height() -> None:
    """At z = 0 this pair stands; a third of a pitch farther on a flank below the pitch curve is lost."""
    pitch = sized_pair(sine_law(0.29), 19, MODULE, None)
    assert toothed_pair(pitch, ToothForm(rack()), 20.0 * TOLERANCE).driving.teeth == 19
    helix = Helix(ANGLE, 2.0 / tan(ANGLE), Hand.LEFT)
    with pytest.raises(
        NoSuchMechanism,
        match=r"section of the helical teeth at z = .* mm: the (space beside|root of the space after) .*tooth",
    ) as caught:
        helical_pair(pitch, ToothForm(rack()), helix, {gear: Blank(WIDTH) for gear in Gear}, 20.0 * TOLERANCE)
    assert caught.value.key == "gears.teeth"
    height = float(caught.value.problem.split("z = ")[1].split(" mm")[0])
    with pytest.raises(NoSuchMechanism, match=r"^gears.teeth: the (space|root of the space)"):
        toothed_pair(pitch, ToothForm(rack()), 20.0 * TOLERANCE, advance_mm=helix.advance_mm(height))


@dataclass(frozen=True)
class Stepped(Helix):
    """No helix: the teeth jump half way up."""

    def advance_mm(self, height_mm: float) -> float:
        return 0.0 if height_mm < 0.4 * self.face_width_mm else 0.5


@pytest.mark.slow
def test_teeth_that_jump_are_refused_with_the_height() -> None:
    pitch = sized_pair(uniform_law(Lobes()), 17, MODULE, None)
    sections = Sections(pitch, ToothForm(rack()), Stepped(radians(5.0), 10.0, Hand.LEFT), 0.1 * TOLERANCE)
    with pytest.raises(NoSuchMechanism, match=r"too abruptly at z = (3\.9\d*|4\.0\d*|4) mm") as caught:
        close_stacks(sections, TOLERANCE)
    assert caught.value.key == "gears.helix"


def test_too_many_sections_are_refused_before_they_are_made() -> None:
    sections = Sections(pitch_of("ellipse"), ToothForm(rack()), Helix(radians(45.0), 1e4, Hand.LEFT), 0.1 * TOLERANCE)
    with pytest.raises(WrongInput, match=f"more than {MOST_STEPS}; .* output.chord_tolerance_mm of") as caught:
        close_stacks(sections, TOLERANCE)
    assert caught.value.key == "gears.helix.angle_deg"
    stated = float(caught.value.problem.split("chord_tolerance_mm of ")[1].split()[0])
    assert sections.steps_within(0.6 * stated) == pytest.approx(MOST_STEPS, rel=0.05)


DESIGN = """\
name: a
linkage: {crank_mm: 25, rod_mm: 90}
operation: {speed_rpm: 150}
motion: {law: ellipse, eccentricity: 0.2}
gears:
  teeth: 23
  module_mm: 2
  face_width_mm: 8
  backlash_mm: 0.05
"""
LOSING = "law: ratio_expression, driven_angle: phi - 0.3*sin(2*phi)"
HELIX = "  helix: {angle_deg: 15, kind: helical, hand: left}\n"


@pytest.mark.tiers(slow=["{angle_deg: 15, hand: left}-gears.helix.kind-missing"], rest="long")
@pytest.mark.parametrize(
    ("helix", "key", "words"),
    [
        ("{angle_deg: 45.1, kind: helical, hand: left}", "gears.helix.angle_deg", "45"),
        ("{angle_deg: 0, kind: helical, hand: left}", "gears.helix.angle_deg", "0"),
        ("{angle_deg: -15, kind: helical, hand: left}", "gears.helix.angle_deg", "0"),
        ("{kind: helical, hand: left}", "gears.helix.angle_deg", "missing"),
        ("{angle_deg: 15, hand: left}", "gears.helix.kind", "missing"),
        ("{angle_deg: 15, kind: helical}", "gears.helix.hand", "missing"),
        ("{angle_deg: 15, kind: double, hand: left}", "gears.helix.kind", "herringbone"),
        ("{angle_deg: 15, kind: helical, hand: up}", "gears.helix.hand", "right"),
        ("{angle_deg: 15, kind: helical, hand: left, module_mm: 2}", "gears.helix.module_mm", ""),
    ],
)
def test_what_a_design_file_may_not_say(helix: str, key: str, words: str) -> None:
    with pytest.raises(DesignError) as caught:
        drive_of_text(DESIGN + f"  helix: {helix}\n")
    assert caught.value.key == key
    assert words in str(caught.value)
    assert "own.yaml:10:" in str(caught.value)


# --- the whole way from a design file -------------------------------------------------------------------------------


def summary_of(drive: Drive) -> dict[str, Any]:
    with TemporaryDirectory() as folder:
        return build(drive, Path(folder), lambda step: None).summaries[0]


@pytest.mark.slow
def test_the_summary_has_the_overlap_and_the_thrust() -> None:
    summary = summary_of(drive_of_text(DESIGN + HELIX))
    teeth, contact = summary["teeth"], summary["contact"]
    assert (teeth["helix_angle_deg"], teeth["helix_kind"], teeth["hand_driving"]) == (
        pytest.approx(15.0),
        "helical",
        "left",
    )
    assert contact["overlap_ratio"] == pytest.approx(8.0 * tan(radians(15.0)) / (2.0 * pi), rel=1e-12)
    assert contact["total_contact_ratio"] == contact["section_contact_ratio_min"] + contact["overlap_ratio"]
    assert 1.0 < contact["section_contact_ratio_min"] < contact["contact_ratio_min"]
    assert any("0.268 of the tangential force" in warning for warning in summary["warnings"])


@pytest.mark.slow
def test_herringbone_teeth_overlap_by_half_and_have_no_thrust() -> None:
    summary = summary_of(drive_of_text(DESIGN + HELIX.replace("helical,", "herringbone,")))
    assert summary["contact"]["overlap_ratio"] == pytest.approx(4.0 * tan(radians(15.0)) / (2.0 * pi), rel=1e-12)
    assert not any("thrust" in warning for warning in summary["warnings"])


@pytest.mark.slow
def test_straight_teeth_say_nothing_of_a_helix() -> None:
    summary = summary_of(drive_of_text(DESIGN))
    assert not {"helix_angle_deg", "hand_driving", "overlap_ratio"} & {*summary["teeth"], *summary["contact"]}
    assert not any("thrust" in warning for warning in summary["warnings"])


@pytest.mark.slow
def test_the_least_contact_of_sections_is_found_among_them() -> None:
    drive = drive_of_text(DESIGN.replace("0.2}", "0.6}") + HELIX)
    found = []
    for height in np.linspace(0.0, 8.0, 25):
        assert drive.helix
        advance = drive.helix.advance_mm(float(height))
        contact = as_designed(
            toothed_pair(drive.pitch, drive.tooth_form, 0.01, advance_mm=advance), placed(drive.pitch)
        )
        found.append(min(contact.pushing.pairs.arcs.min(), contact.back.pairs.arcs.min()))
    assert drive.section_contact_ratio == pytest.approx(min(found), abs=5e-3)
    assert drive.section_contact_ratio <= found[0]


@pytest.mark.slow
def test_an_overlap_that_leaves_a_rest_to_the_sections_asks_for_it() -> None:
    """A helix of a hundredth of a degree does not make up for flanks that lose contact."""
    text = DESIGN.replace("teeth: 23", "teeth: 24").replace("law: ellipse, eccentricity: 0.2", LOSING)
    with pytest.raises(NoSuchMechanism) as straight:
        assert drive_of_text(text).designed_contact
    with pytest.raises(NoSuchMechanism) as helical:
        assert drive_of_text(text + HELIX.replace("15", "0.01")).designed_contact
    assert helical.value.key == straight.value.key == "gears.least_contact_ratio"


@pytest.mark.tiers(slow=["12.0-shares1-False"], rest="long")
@pytest.mark.parametrize(
    ("helix_deg", "shares", "refused"),
    [
        (2.0, (1.001, 1.03), True),  # contact ceases, and the little overlap hid it from ratios just over 1
        (12.0, (1.0,), False),  # the overlap bridges what the flanks leave
        (12.0, (1.15, 1.2), True),  # and does not make up for the whole of these
    ],
)
def test_flanks_and_helix_together_touch_over_what_is_asked(
    helix_deg: float, shares: tuple[float, ...], refused: bool
) -> None:
    """Teeth of half height touch over less than a pitch."""
    low = DESIGN.replace("teeth: 23", "teeth: 23\n  rack: {addendum: 0.5}")
    for share in shares:
        drive = drive_of_text(f"{low}{HELIX.replace('15', str(helix_deg))}  least_contact_ratio: {share}\n")
        arcs = [side.pairs.arcs.min() for side in made_contact(drive)]
        assert max(arcs) < 1.0
        assert (min(arcs) + drive.overlap_ratio < share or drive.overlap_ratio < 0.05) == refused
        if refused:
            with pytest.raises(NoSuchMechanism, match=r"touch over|no flanks touch") as caught:
                assert drive.designed_contact
            assert caught.value.key == "gears.least_contact_ratio"
        else:
            assert drive.designed_contact


def made_contact(drive: Drive) -> tuple[SideContact, SideContact]:
    """Both sides' contact in the section at z = 0, whether it is enough or not."""
    found = as_designed(drive.teeth, placed(drive.pitch))
    return found.pushing, found.back


@pytest.mark.slow
def test_a_build_writes_the_section_at_no_height_as_the_outline(tmp_path: Path) -> None:
    build(drive_of_text(DESIGN + HELIX), tmp_path / "out", lambda step: None)
    for gear in ("driving", "driven"):
        outline = np.genfromtxt(tmp_path / "out" / f"{gear}.csv", delimiter=",", skip_header=1)
        assert apart(meshing.read_outline(tmp_path / "out" / f"{gear}.stl", 1e-6), Polygon(outline)) <= 1.1 * TOLERANCE
