"""Tools that cut a gear: the largest round one against shapely's parallels, the others against what they leave."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from math import degrees

import numpy as np
import pytest
import shapely
from shapely import Polygon

from drives import drive
from ncgear.figures.data_sheet.sheet import data_sheet
from ncgear.metrology.cut_by import CutBy, CutVerdict, Tool, cut_by
from ncgear.metrology.round_tool import FILLET, RoundTool, round_tool
from ncgear.pitch.pair import PitchPair, sized_pair
from ncgear.pitch.shape import Gear, Mesh
from ncgear.project.workshop_measures import cut_gears
from ncgear.ratio.laws.ellipse import elliptical_law
from ncgear.ratio.laws.uniform import uniform_law
from ncgear.ratio.transmission import Lobes
from ncgear.teeth.form import Backlash, Cutter, CutterKind, TipLimits, ToothForm
from ncgear.teeth.gear import ToothedGear, ToothedPair, toothed_pair
from ncgear.teeth.outline import whole_curves
from pairs import exact_ring, rack, sine_law

MODULE = 2.0
LEFT = 0.005

PITCHES: dict[str, Callable[[], PitchPair]] = {
    "circle": lambda: sized_pair(uniform_law(Lobes()), 18, MODULE, None),
    "ellipse": lambda: sized_pair(elliptical_law(0.35, 0.0, Lobes()), 37, MODULE, None),
    "undercut": lambda: sized_pair(elliptical_law(0.35, 0.0, Lobes()), 15, MODULE, None),
    "concave": lambda: sized_pair(sine_law(0.2), 60, MODULE, None),
    "ring": lambda: sized_pair(uniform_law(Lobes(1, 2)), 24, MODULE, None, Mesh.INTERNAL),
}


@cache
def made(name: str, cutter: Cutter | None = None, root_radius: float = 0.38, undercut: bool = True) -> ToothedPair:
    form = ToothForm(
        rack(root_radius=root_radius), cutter=cutter or Cutter(), limits=TipLimits(avoid_undercut=not undercut)
    )
    return toothed_pair(PITCHES[name](), form, LEFT)


def left_by(gear: ToothedGear, diameter: float) -> float:
    """How far what a disc leaves stands over the outline anywhere: the free space opened by the disc, by shapely."""
    ring, radius = exact_ring(gear, 2e-4), diameter / 2.0
    sense = -1.0 if gear.flanks.curve.is_ring else 1.0
    moved = Polygon(ring).buffer(sense * radius, quad_segs=48).buffer(-sense * radius, quad_segs=48)
    return float(shapely.distance(shapely.points(ring), moved.boundary).max())


@pytest.mark.tiers(slow=["ellipse-Gear.DRIVING", "concave-Gear.DRIVEN"], rest="long")
@pytest.mark.parametrize("gear", Gear)
@pytest.mark.parametrize("name", PITCHES)
def test_the_largest_round_tool_leaves_no_more_than_allowed_and_a_larger_one_does(name: str, gear: Gear) -> None:
    """The disc comes near along the normals, so that it leaves a fifth of what it may; 15 % more leave too much."""
    own = made(name).of(gear)
    found = round_tool(own, LEFT)
    assert left_by(own, found.diameter_mm) <= LEFT
    assert left_by(own, 1.15 * found.diameter_mm) > LEFT


@pytest.mark.slow
def test_a_tool_that_is_wider_than_the_bottom_of_a_space_does_not_get_there() -> None:
    """A rack's tip that is rounded all over: no fillet is rounder, but both sides hold the tool."""
    own = made("circle", root_radius=0.471).driving
    found = round_tool(own, LEFT)
    assert found.passage
    assert left_by(own, found.diameter_mm) <= LEFT
    assert left_by(own, 1.15 * found.diameter_mm) > 0.3


@pytest.mark.tiers(thorough=["circle-*"], rest="slow")
@pytest.mark.parametrize("gear", Gear)
@pytest.mark.parametrize("name", ["circle", "ellipse", "concave", "ring"])
def test_the_least_hollow_is_that_of_differences(name: str, gear: Gear) -> None:
    """Radii of circles through three near points of every fillet."""
    own = made(name).of(gear)
    fillets = whole_curves(own.tips, own.sides)[FILLET]
    point = fillets.at(np.arange(fillets.owner.size)[:, None], np.linspace(0.0, 1.0, 2001))[0]
    one, two = point[:, 1:-1] - point[:, :-2], point[:, 2:] - point[:, 1:-1]
    area = np.abs(one[..., 0] * two[..., 1] - one[..., 1] * two[..., 0])
    sides = np.linalg.norm([one, two, one + two], axis=-1).prod(axis=0)
    assert round_tool(own, LEFT).hollow_mm == pytest.approx(float((sides / (2.0 * area)).min()), rel=2e-3)


def of(name: str, gear: Gear, pair: ToothedPair) -> dict[Tool, CutBy]:
    free = RoundTool(1.0, LEFT, 1, False, 0.5, 1)
    return {one.tool: one for one in cut_by(PITCHES[name](), pair, gear, free)}


@pytest.mark.slow
def test_a_hob_cuts_what_it_is_the_tool_of_and_nothing_hollow() -> None:
    assert of("ellipse", Gear.DRIVEN, made("ellipse"))[Tool.HOB].verdict is CutVerdict.CUTS
    for name, gear, why in (("concave", Gear.DRIVING, "concave with a radius"), ("ring", Gear.DRIVEN, "inwards")):
        found = of(name, gear, made(name))[Tool.HOB]
        assert found.verdict is CutVerdict.NOT
        assert why in found.reason


@pytest.mark.thorough
def test_idle_flanks_that_stand_turned_take_the_hob_a_second_pass() -> None:
    """0.1 mm over the base radius where the arm is least; the driving gear stands as it is."""
    form = ToothForm(rack(), limits=TipLimits(avoid_undercut=False), backlash=Backlash(0.1))
    pair = toothed_pair(PITCHES["circle"](), form, LEFT)
    driving, driven = (of("circle", gear, pair)[Tool.HOB] for gear in Gear)
    turn = degrees(float(np.ptp(pair.driven.flanks.turn_rad)))
    assert (driving.verdict, driving.reason) == (CutVerdict.CUTS, "")
    assert driven.reason == f"idle flanks in a second pass, the gear turned by {turn:.4g} deg"


@pytest.mark.slow
def test_a_hob_of_full_depth_does_not_make_spaces_that_are_shallower_against_undercut() -> None:
    allowed, avoided = (of("undercut", Gear.DRIVING, made("undercut", undercut=u))[Tool.HOB] for u in (True, False))
    assert allowed.verdict is CutVerdict.CUTS
    assert (avoided.verdict, avoided.reason[:28]) == (CutVerdict.NOT, "at full depth it undercuts t")


@pytest.mark.slow
def test_the_shaper_of_the_design_cuts_it_and_others_leave_their_own_fillets() -> None:
    """Judged by the outlines: on the flanks both designs agree to the chords, in the fillets they do not."""
    shaped = made("ellipse", Cutter(CutterKind.PINION, 40))
    own = of("ellipse", Gear.DRIVING, shaped)[Tool.SHAPER]
    assert (own.verdict, own.teeth) == (CutVerdict.CUTS, 40)
    other = of("ellipse", Gear.DRIVING, made("ellipse"))[Tool.SHAPER]
    assert (other.verdict, other.teeth) == (CutVerdict.FLANKS, 40)
    hobbed, cut = made("ellipse").driving, shaped.driving
    heights = np.linspace(-hobbed.tips.met_depth_mm, np.minimum(hobbed.tips.height_mm, cut.tips.height_mm), 9)
    flank = np.broadcast_to(np.arange(hobbed.flanks.count), heights.shape)
    points = shapely.points(hobbed.flanks.flank(flank, heights)[0].reshape(-1, 2))
    assert shapely.distance(points, Polygon(cut.outline_mm).exterior).max() < 2.0 * LEFT
    deep = shapely.points(exact_ring(hobbed, LEFT))
    assert shapely.distance(deep, Polygon(cut.outline_mm).exterior).max() > 4.0 * LEFT


@pytest.mark.slow
def test_a_shaper_that_is_too_shallow_for_the_mate_is_told_so() -> None:
    """A pinion's rounded tip begins higher up than a rack's: its flanks are 1.341 mm deep where 1.394 mm are met."""
    found = next(one for one in cut_gears(drive("pusher"))[0].by if one.tool is Tool.SHAPER)
    assert found.verdict is CutVerdict.NOT
    assert found.reason == "with 40 teeth it is not as deep beside tooth 4 as the mate's tips reach"


def test_a_corner_that_is_too_sharp_and_helical_teeth_take_no_round_tool() -> None:
    sharp = RoundTool(0.015, LEFT, 7, False, 0.0, 7)
    wire, mill = cut_by(PITCHES["circle"](), made("circle"), Gear.DRIVING, sharp)[2:]
    assert (wire.verdict, mill.verdict) == (CutVerdict.NOT, CutVerdict.NOT)
    assert wire.reason == "the space after tooth 7 takes 0.015 mm at most, and the finest have 0.02 mm"
    helical = cut_by(PITCHES["circle"](), made("circle"), Gear.DRIVING, sharp, helix="herringbone")
    assert [one.verdict for one in helical if one.tool is not Tool.SHAPER] == [CutVerdict.NOT] * 3


@pytest.mark.slow
def test_the_sheet_says_which_tools_cut_each_gear() -> None:
    """Diameters are rounded down: the tool of the stated size is no larger than the largest."""
    gears = cut_gears(drive("ellipse"))
    tables = [table for table in data_sheet(drive("ellipse")).tables if table.title.endswith("is cut by")]
    for gear, table in zip(gears, tables, strict=True):
        assert [row[1] for row in table.rows] == [one.verdict.value for one in gear.by]
        stated = float(str(table.rows[2][0]).split()[2])
        assert 0.0 <= gear.round_tool.diameter_mm - stated < 1e-3
