"""Flanks of two pressure angles, and a profile shift for each tooth: closed forms, a published gear, brute force."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from math import acos, atan, cos, pi, radians, sin, tan
from typing import Any

import numpy as np
import pytest
import shapely
from scipy.optimize import brentq
from shapely import Polygon

from at_once import at_once
from drives import drive, drive_of_text
from ncgear.contact.designed.as_designed import as_designed
from ncgear.contact.placement import placed
from ncgear.dynamics.mesh_force import MeshPlace, mesh_force
from ncgear.errors import NoSuchMechanism, WrongInput
from ncgear.figures.data_sheet.sheet import data_sheet
from ncgear.figures.summary.build_summary import teeth_summary
from ncgear.metrology.pins import pins_in_spaces, working_flanks
from ncgear.metrology.span import spans
from ncgear.numerics.jet import Jet
from ncgear.pitch.pair import PitchPair, sized_pair
from ncgear.pitch.shape import Gear, Mesh
from ncgear.ratio.laws.ellipse import elliptical_law
from ncgear.ratio.laws.uniform import uniform_law
from ncgear.ratio.transmission import Lobes
from ncgear.strength.estimate import estimate_of
from ncgear.teeth.backlash import play_of
from ncgear.teeth.form import Backlash, BasicRack, Cutter, CutterKind, TipLimits, ToothForm
from ncgear.teeth.gear import ToothedGear, ToothedPair, toothed_pair
from ncgear.teeth.shifts import thickness_mm, tooth_shifts
from oracles import meshing
from pairs import rack, sine_law
from test_cutter import apart
from tooth_places import STEEL, places_at

Array = np.ndarray

MODULE = 2.0
TOLERANCE = 2e-4

PUSHING, IDLE = radians(25.0), radians(18.0)

WAVE = (0.1, 0.2, 0.1, 0.0, -0.1, -0.2, -0.1, 0.0)
"""Shifts in modules that differ from tooth to tooth."""


def uneven(pushing_deg: float = 25.0, idle_deg: float = 18.0) -> BasicRack:
    return replace(rack(), pressure_angle_rad=radians(pushing_deg), idle_angle_rad=radians(idle_deg))


def form(basic: BasicRack, shifts: tuple[float, ...] = (), **more: Any) -> ToothForm:
    """The form of teeth with shifts in modules."""
    return ToothForm(basic, tooth_shifts_mm=tuple(one * MODULE for one in shifts), **more)


@cache
def pitch_of(name: str) -> PitchPair:
    law, teeth, mesh = {
        "circle": (uniform_law(Lobes()), 32, Mesh.EXTERNAL),
        "ring": (uniform_law(Lobes(1, 2)), 32, Mesh.INTERNAL),
        "ellipse": (elliptical_law(0.35, 0.0, Lobes(1, 2)), 24, Mesh.EXTERNAL),
        "concave": (sine_law(0.2), 64, Mesh.EXTERNAL),
    }[name]
    return sized_pair(law, teeth, MODULE, None, mesh)


FORMS: dict[str, ToothForm] = {
    "angles": form(uneven()),
    "shifts": form(rack(), WAVE),
    "both": form(uneven(), WAVE),
    "both with play": form(uneven(), WAVE, backlash=Backlash(0.1)),
    "full depth": form(uneven(), WAVE, limits=TipLimits(avoid_undercut=False)),
}


@cache
def made(name: str, asked: str, tolerance: float = TOLERANCE) -> ToothedPair:
    return toothed_pair(pitch_of(name), FORMS[asked], tolerance)


# --- the published gear --------------------------------------------------------------------------------------------

TABLE_2 = (0.0, -0.1, -0.2, -0.1, 0.0, 0.1, 0.2, 0.1, 0.0, 0.1, 0.2, 0.1, 0.0, -0.1, -0.2, -0.1) * 2
"""Shifts of the 32 teeth in modules: I. Zarebski and T. Salacinski, "Designing of non-circular gears", Archive of
Mechanical Engineering 55 (2008), table 2; their gear has 32 teeth of module 4.71 at 20 degrees."""

OWN_MODULE = 7.396 / (pi / 2.0)
"""4.7084 mm: the module that the thickness of 7.396 mm without shift belongs to (table 3), told as 4.71."""


@pytest.mark.judges("teeth")
@pytest.mark.parametrize(("module", "within"), [(4.71, 3.2e-3), (OWN_MODULE, 6e-4)])
def test_thickness_of_each_tooth_is_the_published_one(module: float, within: float) -> None:
    """Tables 1 and 3: 6.710 to 8.081 mm, and 7.396 mm for flanks of 17.5 and 22.5 degrees without shift."""
    angles = radians(20.0), radians(20.0)
    found = thickness_mm(module, module * np.array(TABLE_2), angles)
    assert [found.min(), found.max()] == pytest.approx([6.710, 8.081], abs=within)
    alike = thickness_mm(module, np.zeros(1), (radians(17.5), radians(22.5)))
    assert alike == pytest.approx([7.396], abs=within)
    # Table 4, of module 4.91.
    assert thickness_mm(4.91, np.zeros(1), angles) == pytest.approx([7.714], abs=1.5e-3)
    # What one angle alone, or no tangent at all, would give is far off.
    assert abs(found.max() - thickness_mm(module, np.array([0.2 * module]), (0.0, radians(20.0)))[0]) > 0.3


@pytest.mark.thorough
def test_the_published_gears_are_made_and_their_teeth_are_as_thick() -> None:
    """Of 32 teeth on an ellipse: the thickness along the pitch curve of exact flanks, and the mate's spaces."""
    pitch = sized_pair(elliptical_law(0.3, 0.0, Lobes()), 32, 4.71, None)
    basic = rack(module=4.71)
    pair = toothed_pair(pitch, ToothForm(basic, tooth_shifts_mm=tuple(4.71 * x for x in TABLE_2)), 0.005)
    thickness = np.diff(pair.driving.flanks.crossing_mm.reshape(-1, 2), axis=1)[:, 0]
    assert thickness == pytest.approx(thickness_mm(4.71, 4.71 * np.array(TABLE_2), basic.angles_rad), abs=1e-12)
    # The driven space after tooth j meets driving tooth j + 1.
    crossing, length = pair.driven.flanks.crossing_mm, pitch.driven.length_mm
    gaps = np.mod(np.roll(crossing[::2], -1) - crossing[1::2], length)
    assert gaps == pytest.approx(np.roll(thickness, -1), abs=1e-11)


# --- circular gears in closed form -----------------------------------------------------------------------------------


def involute(angle: Array | float) -> Array:
    return np.tan(angle) - angle


@pytest.mark.judges("teeth")
def test_flanks_of_circular_gears_are_involutes_of_two_base_circles() -> None:
    """At the radius R a flank has turned from where it crosses the pitch circle by inv(acos(rb / R)) - inv(alpha)."""
    pair, radius = made("circle", "both"), 32.0
    for gear, sense in ((pair.driving, -1.0), (pair.driven, 1.0)):
        own = gear.flanks
        for number in range(8):
            pushes = (own.side[number] < 0.0) == (gear is pair.driving)
            alpha = PUSHING if pushes else IDLE
            height = np.linspace(-0.9 * own.flank_depth_mm[number], gear.tips.height_mm[number], 9)
            point = own.flank(np.full(9, number), height)[0] @ [1.0, 1j]
            crossing = own.curve.at_length(own.crossing_mm[number : number + 1]).position[0] @ [1.0, 1j]
            away = np.abs(point)
            turned = np.angle(point / crossing) * sense * own.side[number]
            roll = np.arccos(np.minimum(radius * cos(alpha) / away, 1.0))
            assert turned == pytest.approx(involute(alpha) - involute(roll), abs=1e-12)
            other = IDLE if pushes else PUSHING
            wrong = involute(other) - involute(np.arccos(np.minimum(radius * cos(other) / away, 1.0)))
            assert np.abs(turned - wrong).max() > 1e-3


def test_contact_of_circular_gears_has_the_angle_and_the_length_of_its_side() -> None:
    """The line of action touches each side's base circle; tips at ra leave sqrt(ra^2 - rb^2) - r sin(alpha) of it."""
    pitch, pair = pitch_of("circle"), made("circle", "angles")
    contact = as_designed(pair, placed(pitch))
    for side, alpha in ((contact.pushing, PUSHING), (contact.back, IDLE)):
        assert side.first.lever_mm == pytest.approx(32.0 * cos(alpha), abs=1e-9)
        reach = np.sqrt(34.0**2 - (32.0 * cos(alpha)) ** 2) - 32.0 * sin(alpha)
        assert side.pairs.contact_ratio == pytest.approx(2.0 * reach / (pi * MODULE * cos(alpha)), abs=1e-9)


@pytest.mark.judges("metrology")
@pytest.mark.parametrize("helix_deg", [0.0, 25.0])
def test_over_pins_between_unequal_involutes_is_the_closed_form(helix_deg: float) -> None:
    """The centre lies on involutes of both base circles: their turnings to it add up to the width of the space.

    Of helical teeth each side has a base helix angle of its own, and the ball's radius over its cosine in the section.
    """
    gear, radius, diameter = made("circle", "angles").driving, 32.0, 3.75
    found = pins_in_spaces(working_flanks(gear, radians(helix_deg)), diameter, gear.outline_mm, TOLERANCE)

    def left(center: float) -> float:
        turned = pi * MODULE / 2.0 / radius
        for alpha in (PUSHING, IDLE):
            base, leaning = radius * cos(alpha), cos(atan(tan(radians(helix_deg)) * cos(alpha)))
            turned += float(involute(acos(base / center)) - involute(alpha)) - diameter / 2.0 / leaning / base
        return turned

    assert found.misfits == {}
    assert found.over_mm == pytest.approx(brentq(left, 31.0, 36.0, xtol=1e-13) + diameter / 2.0, abs=1e-9)
    assert spans(working_flanks(gear)).first.size == 0


def test_a_pin_touches_both_flanks_of_shifted_unequal_teeth() -> None:
    gear = made("ellipse", "both").driving
    found = pins_in_spaces(working_flanks(gear), 4.0, gear.outline_mm, TOLERANCE)
    assert found.space.size == gear.teeth
    distance = shapely.distance(shapely.points(found.center_mm), shapely.linearrings(gear.outline_mm))
    assert distance == pytest.approx(2.0, abs=TOLERANCE)
    # Wider spaces let the pin sink in.
    assert np.ptp(np.linalg.norm(found.center_mm[:8], axis=1)) > 0.1


def test_play_is_that_of_the_idle_angle() -> None:
    play = play_of(pitch_of("circle"), uneven(), Backlash(0.07))
    assert play.driven_rad == pytest.approx(0.07 / (32.0 * cos(IDLE)), rel=1e-12)


def test_force_between_teeth_leans_by_the_angle_of_the_side_that_carries() -> None:
    place = MeshPlace(64.0, PUSHING, Mesh.EXTERNAL, 0.0, IDLE)
    slope = Jet(np.array([[1.0, 1.0], [0.0, 0.0], [0.0, 0.0]]))
    force = mesh_force(place, slope, Jet(np.array([[3200.0, -3200.0], [0.0, 0.0]])))
    assert force.pressure_angle_rad.value == pytest.approx([PUSHING, IDLE], rel=1e-14)
    assert force.size_n.value == pytest.approx([100.0 / cos(PUSHING), 100.0 / cos(IDLE)], rel=1e-14)


@pytest.mark.judges("strength")
def test_strength_of_a_gear_is_that_of_its_mirror_image() -> None:
    """Angles the other way round: what its front flanks bear its mirror image's back flanks bear, and are as stiff."""
    pitch = pitch_of("circle")
    one, other = (toothed_pair(pitch, form(basic), 0.005).driving for basic in (uneven(25.0, 18.0), uneven(18.0, 25.0)))
    found = []
    for gear, flank in ((one, 2), (other, 3), (one, 3)):
        top, bottom = gear.sides.flank_range()
        height = np.linspace(bottom[flank], top[flank], 6)[1:]
        places, estimate = places_at(gear, np.full(5, flank), height), estimate_of(gear, STEEL)
        found.append((estimate.root_stress(places).tension_mpa, estimate.compliance(places, np.full(5, 0.02))))
    assert found[0][0] == pytest.approx(found[1][0], rel=1e-6)
    assert found[0][1] == pytest.approx(found[1][1], rel=1e-6)
    # The steeper flank is another flank.
    assert np.abs(found[0][0] / found[2][0] - 1.0).max() > 0.01


# --- brute force -----------------------------------------------------------------------------------------------------

OPENED = 96
"""Chords of the drawn rounding in a quarter turn: it stays within 3e-5 mm."""


def drawn_cutter(basic: BasicRack, left: float, right: float, raised: float, aside: float, reach: float) -> Array:
    """A standard cutter tooth (along, height) with a flank of an angle on either side, raised and moved aside."""
    quarter, deep, high = basic.pitch_mm / 4.0, -basic.dedendum_mm, reach + 3.0
    corners = [
        (-quarter - high * tan(left), high),
        (-quarter - deep * tan(left), deep),
        (quarter + deep * tan(right), deep),
        (quarter + high * tan(right), high),
    ]
    radius = basic.root_radius_mm
    rounded = Polygon(corners).buffer(-radius, quad_segs=OPENED).buffer(radius, quad_segs=OPENED)
    tooth = rounded.intersection(shapely.box(-20.0, deep - 1.0, 20.0, reach - raised))
    return np.asarray(shapely.get_coordinates(tooth.exterior)[:-1] + np.array([aside, raised]))


def shaped(gear: ToothedGear, cutters: list[Array], centers: Array, highest: float, positions: int = 100) -> Polygon:
    """A blank less what each space's cutter tooth sweeps while it rolls on the pitch curve, from sampled positions."""
    curve, pitch = gear.flanks.curve, gear.flanks.rack.pitch_mm
    around = curve.at_length(np.linspace(0.0, curve.length_mm, 8001)[:-1]).position
    body = Polygon(around).buffer(highest, quad_segs=64)
    lead = np.arange(-2 * positions, 2 * positions + 1) * (pitch / positions)
    swept = []
    for tooth, center in zip(cutters, centers, strict=True):
        at = curve.at_length(center - lead)
        along = tooth[None, :, :1] + lead[:, None, None]
        placed_at = at.position[:, None] + along * at.tangent[:, None] + tooth[None, :, 1:] * at.normal[:, None]
        swept.append(shapely.union_all(shapely.polygons(placed_at)))
    rest = body.difference(shapely.union_all(swept))
    return max(shapely.get_parts(rest), key=lambda part: part.area)


def cutters_of(gear: ToothedGear, basic: BasicRack, shifts: Array) -> tuple[list[Array], Array]:
    """The standard cutter tooth in every space, where its flanks meet the pitch line as the shifts of the teeth say."""
    driving = gear.flanks.curve.gear is Gear.DRIVING
    pushing, idle = map(tan, basic.angles_rad)
    pitch, reach = basic.pitch_mm, basic.addendum_mm + float(np.abs(shifts).max())
    found = []
    for number in range(gear.teeth):
        if driving:
            # Left of the space is an idle flank of its tooth, right a pushing flank of the next one.
            before, after = shifts[number % shifts.size], shifts[(number + 1) % shifts.size]
            lines = np.array([[1.0, idle], [1.0, -pushing]])
            aside, raised = np.linalg.solve(lines, [before * idle, -after * pushing])
            left, right = basic.angles_rad[1], basic.angles_rad[0]
        else:
            aside, raised = 0.0, -shifts[number % shifts.size]
            left, right = basic.angles_rad
        found.append(drawn_cutter(basic, left, right, raised, aside, reach))
    return found, (np.arange(gear.teeth) + (0.5 if driving else 0.0)) * pitch


@pytest.mark.judges("teeth")
@pytest.mark.tiers(slow=["full depth-Gear.DRIVING"], rest="long")
@pytest.mark.parametrize(
    ("asked", "gear"), [("angles", Gear.DRIVING), ("full depth", Gear.DRIVING), ("full depth", Gear.DRIVEN)]
)
def test_a_standard_cutter_tooth_in_each_space_leaves_the_same_gear(asked: str, gear: Gear) -> None:
    """All flanks, fillets and roots; scallops and chords of the drawn cutter stand out by less than 5e-4 mm.

    At full depth it undercuts teeth 12 to 14, 21 and 22 of the driving gear.
    """
    basic = FORMS[asked].rack
    shifts = np.array(FORMS[asked].tooth_shifts_mm or (0.0,))
    own = made("ellipse", asked).of(gear)
    cut = shaped(own, *cutters_of(own, basic, shifts), basic.addendum_mm + 0.2 * MODULE)
    assert apart(own, cut) < 5e-4


@pytest.mark.slow
def test_another_cutter_leaves_another_gear() -> None:
    """With the shifts of the teeth the other way round, or flanks the other way round, the gears are far apart."""
    own = made("circle", "both").driving
    basic = FORMS["both"].rack
    shifts = np.array(FORMS["both"].tooth_shifts_mm)
    turned = replace(basic, pressure_angle_rad=IDLE, idle_angle_rad=PUSHING)
    for wrong in (cutters_of(own, basic, -shifts), cutters_of(own, turned, shifts)):
        assert apart(own, shaped(own, *wrong, basic.addendum_mm + 0.2 * MODULE, 30)) > 0.1


def turning(pitch: PitchPair, driving: ToothedGear, driven: ToothedGear, count: int = 401) -> meshing.Pair:
    """The written outlines of two gears, and the law at ``count`` angles over a turn of the driving gear."""
    phi1 = np.linspace(0.0, 2.0 * pi, count)
    law = pitch.transmission.driven_angle(phi1).value
    return meshing.Pair(Polygon(driving.outline_mm), Polygon(driven.outline_mm), phi1, law, pitch.center_distance_mm)


@pytest.mark.judges("contact")
@pytest.mark.tiers(quick=["both-ellipse"], rest="slow")
@pytest.mark.parametrize("name", ["ellipse", "concave"])
@pytest.mark.parametrize("asked", ["angles", "shifts", "both"])
def test_whole_outlines_never_overlap_and_always_touch(name: str, asked: str) -> None:
    """Without play both sides touch to within the chords, wherever the gears stand."""
    pitch, pair = pitch_of(name), made(name, asked)
    report = turning(pitch, pair.driving, pair.driven).report(13)
    assert report.overlap_depth.max() < 1.1 * TOLERANCE
    assert report.gap.max() < 4.0 * TOLERANCE


@pytest.mark.thorough
def test_teeth_of_a_mate_with_the_same_instead_of_the_opposite_shift_do_not_mesh() -> None:
    """Nor do gears with the flanks the other way round."""
    pitch, pair = pitch_of("ellipse"), made("ellipse", "both")
    other_shifts = toothed_pair(pitch, form(uneven(), tuple(-x for x in WAVE)), TOLERANCE)
    other_flanks = toothed_pair(pitch, form(uneven(18.0, 25.0), WAVE), TOLERANCE)
    for wrong in (other_shifts, other_flanks):
        report = turning(pitch, pair.driving, wrong.driven).report(7)
        assert report.overlap_depth.max() > 0.05


@pytest.mark.tiers(thorough=["ellipse"], slow=["ring"], rest="long")
@pytest.mark.parametrize("name", ["ellipse", "ring", "concave"])
def test_the_law_is_held_exactly_and_the_play_is_even(name: str) -> None:
    pitch, pair = pitch_of(name), made(name, "both with play", 0.005)
    contact = as_designed(pair, placed(pitch))
    asked = play_of(pitch, uneven(), Backlash(0.1)).driven_rad
    for side in (contact.pushing, contact.back):
        assert side.transmission_error_rad < 1e-11
        assert side.pairs.least_arc > 1.0
    assert contact.backlash_rad == pytest.approx(asked, abs=1e-11)
    assert contact.overlap_mm.max() < 1e-9


@pytest.mark.thorough
@pytest.mark.parametrize("advance", [0.0, 0.37])
def test_sections_of_helical_teeth_hold_the_law_too(advance: float) -> None:
    pitch = pitch_of("ellipse")
    pair = toothed_pair(pitch, FORMS["angles"], 0.005, advance_mm=advance * pi * MODULE)
    contact = as_designed(pair, placed(pitch))
    assert max(contact.pushing.transmission_error_rad, contact.back.transmission_error_rad) < 1e-11
    assert np.abs(contact.backlash_rad).max() < 1e-11


@pytest.mark.slow
def test_written_gears_turn_by_the_play_and_no_farther() -> None:
    pitch, pair = pitch_of("ellipse"), made("ellipse", "both with play")
    asked = play_of(pitch, uneven(), Backlash(0.1)).driven_rad
    written = turning(pitch, pair.driving, pair.driven)
    for position in (0, 67, 211, 340):
        back, on = written.driven_play(position)
        assert -1e-6 < back < 4.0 * TOLERANCE / 25.0
        assert on == pytest.approx(asked, abs=4.0 * TOLERANCE / 25.0)


@pytest.mark.thorough
@pytest.mark.parametrize("kind", [CutterKind.MATE, CutterKind.PINION])
def test_other_tools_leave_the_same_flanks(kind: CutterKind) -> None:
    pitch = pitch_of("ellipse")
    pair = toothed_pair(pitch, form(uneven(), () if kind is CutterKind.PINION else WAVE, cutter=Cutter(kind)), 0.005)
    contact = as_designed(pair, placed(pitch))
    assert max(contact.pushing.transmission_error_rad, contact.back.transmission_error_rad) < 1e-11
    assert contact.overlap_mm.max() < 1e-9
    for gear in (pair.driving, pair.driven):
        assert Polygon(gear.outline_mm).is_valid


def test_all_clearances_are_the_racks() -> None:
    """Tips reach up to the clearance of a quarter of a module from the roots, whatever shifts the teeth have."""
    pitch, pair = pitch_of("ellipse"), made("ellipse", "both", 0.005)
    contact = as_designed(pair, placed(pitch))
    for side in (contact.pushing, contact.back):
        for tips in (side.driving_tips, side.driven_tips):
            assert tips.over_root_mm == pytest.approx(0.25 * MODULE, abs=1e-9)


# --- undercut --------------------------------------------------------------------------------------------------------

ENDS = (0.1, 0.1, 0.1, 0.0, 0.0, 0.0, 0.0, 0.1, 0.1)
"""Shifts in modules of nine of 18 teeth: those about a sharp end have some."""


@pytest.mark.thorough
def test_a_larger_angle_and_shifts_at_the_sharp_ends_remove_undercut() -> None:
    """18 teeth on an ellipse of eccentricity 0.35, on an oval of 36: undercut ends where k (f - x) < sin^2(alpha)."""
    pitch = sized_pair(elliptical_law(0.35, pi, Lobes(1, 2)), 18, MODULE, None)

    def undercut(basic: BasicRack, shifts: tuple[float, ...] = ()) -> tuple[ToothedPair, list[int], set[int]]:
        pair = toothed_pair(pitch, form(basic, shifts, limits=TipLimits(0.4)), 0.005)
        assert pair.driven.undercut == []
        marked = np.nonzero(pair.driving.tips.undercut)[0]
        return pair, pair.driving.undercut, {int(side) for side in pair.driving.flanks.side[marked]}

    _, at_20, both_sides = undercut(rack())
    _, with_angle, one_side = undercut(uneven(25.0, 20.0))
    _, with_shifts, _ = undercut(rack(), ENDS)
    pair, with_both, _ = undercut(uneven(25.0, 20.0), ENDS)
    assert (at_20, both_sides) == ([1, 2, 3, 8, 9, 10, 11, 12, 17, 18], {-1, 1})
    # The larger angle frees the pushing flanks, which are the driving gear's back flanks; the idle ones stay.
    assert (with_angle, one_side) == ([1, 8, 9, 10, 17, 18], {1})
    assert (with_shifts, with_both) == ([], [])
    # By the condition itself, at the sharpest place: no shift fails, that of the ends does not.
    sharpest, sine = pitch.curvature_range[Gear.DRIVING][1].value, sin(radians(20.0))
    depth = rack().flank_depth_mm
    assert sharpest * (depth - 0.1 * MODULE) < sine**2 < sharpest * depth
    assert sharpest * depth < sin(radians(25.0)) ** 2
    assert np.all(pair.driving.tips.limit == 0)


@pytest.mark.parametrize("avoid", [True, False])
def test_bottoms_are_level_though_roundings_end_at_unequal_heights(avoid: bool) -> None:
    """Of a rack's tooth, at full depth as where the space is less deep so as not to undercut."""
    pitch = sized_pair(uniform_law(Lobes()), 14, MODULE, None)
    pair = toothed_pair(pitch, form(uneven(), limits=TipLimits(0.0, avoid_undercut=avoid)), 0.005)
    assert pair.driving.undercut == list(range(1, 15))
    own, roots = pair.driving.flanks, pair.driving.sides.roots
    depths = own.root_depth_mm
    assert np.ptp(depths) < 1e-12
    assert (depths[0] < 1.25 * MODULE - 0.1) == avoid
    assert np.ptp(own.flank_depth_mm) == pytest.approx(own.root_radius_mm[0] * (sin(PUSHING) - sin(IDLE)), abs=1e-12)
    land = roots.height(np.zeros(5, dtype=int), np.linspace(*(ends[0] for ends in roots.lands()), 5))
    assert land == pytest.approx(-depths[0], abs=1e-12)


# --- keys ------------------------------------------------------------------------------------------------------------

TEXT = """
name: uneven
linkage: {{crank_mm: 40, rod_mm: 150}}
operation: {{speed_rpm: 60}}
motion: {{law: ellipse, eccentricity: 0.2}}
gears: {{teeth: {teeth}, module_mm: 2, face_width_mm: 10, {more}}}
"""


@at_once(
    ("more", "key", "words"),
    [
        ("rack: {idle_pressure_angle_deg: 45}", "rack.idle_pressure_angle_deg", "under 40"),
        ("method: equivalent_gear, rack: {idle_pressure_angle_deg: 25}", "rack.idle_pressure_angle_deg", "one angle"),
        ("method: equivalent_gear, profile_shift: {per_tooth: [0.1]}", "profile_shift.per_tooth", "equivalent_gear"),
        ("profile_shift: {per_tooth: [0.1], driving: 0.2}", "profile_shift.per_tooth", "driving given as well"),
        ("profile_shift: {per_tooth: [0.1], against_undercut: true}", "profile_shift.per_tooth", "against_undercut"),
        ("profile_shift: {per_tooth: []}", "profile_shift.per_tooth", "at least 1"),
        ("profile_shift: {per_tooth: [1.5]}", "profile_shift.per_tooth.0", "1"),
        ("profile_shift: {per_tooth: [0.1]}, cutter: {kind: pinion}", "profile_shift.per_tooth", "cutter.kind: pinion"),
        ("profile_shift: {per_tooth: [0.1]}, rack: {tip_relief: {amount: 0.01}}", "profile_shift.per_tooth", "relief"),
        (
            "profile_shift: {per_tooth: [0.1]}, helix: {angle_deg: 9, kind: helical, hand: left}",
            "profile_shift.per_tooth",
            "helix",
        ),
    ],
)
def test_what_is_not_made_together_is_refused(more: str, key: str, words: str) -> None:
    with pytest.raises(WrongInput) as caught:
        drive_of_text(TEXT.format(teeth=24, more=more))
    assert caught.value.key == f"gears.{key}"
    assert words in caught.value.problem


@at_once(
    ("teeth", "more", "key", "words"),
    [
        (24, "profile_shift: {per_tooth: [0.1, 0, 0, 0, 0]}", "profile_shift.per_tooth", "5 shifts given"),
        (
            24,
            "lobes: {driving: 2, driven: 3}, profile_shift: {per_tooth: [0.1, 0, 0, 0, 0, 0, 0, 0]}",
            "profile_shift.per_tooth",
            "",
        ),
        (
            24,
            "rack: {pressure_angle_deg: 38, dedendum: 0.9, addendum: 0.8}, profile_shift: {per_tooth: [0.9]}",
            "profile_shift.per_tooth",
            "at the pitch curve",
        ),
        (
            24,
            "rack: {pressure_angle_deg: 35, idle_pressure_angle_deg: 39, dedendum: 0.9, addendum: 1.05}",
            "rack.addendum",
            "pointed",
        ),
        (
            24,
            "rack: {pressure_angle_deg: 20, idle_pressure_angle_deg: 30, root_radius: 0.38}",
            "rack.root_radius",
            "20 and 30 deg",
        ),
    ],
)
def test_shifts_and_angles_that_leave_no_teeth_are_refused(teeth: int, more: str, key: str, words: str) -> None:
    asked = drive_of_text(TEXT.format(teeth=teeth, more=more))
    if not words:
        # 24 teeth on 36 meet every 12th: eight shifts do not fit.
        words = "repeat after 12 teeth"
    with pytest.raises(WrongInput) as caught:
        _ = asked.teeth
    assert caught.value.key == f"gears.{key}"
    assert words in caught.value.problem


@pytest.mark.slow
def test_gears_that_turn_less_than_once_have_no_shifts_for_each_tooth() -> None:
    spiral = drive_of_text(
        "name: s\noperation: {speed_rpm: 60}\nmotion: {law: spiral, range_deg: 160, ratio_start: 1.3, ratio_end: 0.8}\n"
        f"gears: {{module_mm: {MODULE}, center_distance_mm: 80, face_width_mm: 10}}\n"
    )
    with pytest.raises(WrongInput, match="turn less than once") as caught:
        toothed_pair(spiral.pitch, FORMS["shifts"], 0.005)
    assert caught.value.key == "gears.profile_shift.per_tooth"


def test_teeth_that_meet_several_spaces_have_shifts_that_repeat() -> None:
    """24 driving teeth on 36 driven ones: what is given for twelve teeth goes on and fits every space it meets."""
    angles, shift = (PUSHING, IDLE), 0.1 * np.arange(12)
    driving, driven = tooth_shifts(shift, MODULE, angles, (24, 36))
    for meeting in range(72):
        tooth, space = meeting % 24, (meeting - 1) % 36
        assert driven.space_mm[space] == -driving.tooth_mm[tooth]
        # A driving tooth's front flank meets the back flank after the space, its back flank the front one before it.
        assert driven.outwards_mm[2 * ((space + 1) % 36)] == -driving.outwards_mm[2 * tooth + 1]
        assert driven.outwards_mm[2 * space + 1] == -driving.outwards_mm[2 * tooth]


def test_equal_angles_said_twice_are_one() -> None:
    given = drive_of_text(TEXT.format(teeth=24, more="rack: {pressure_angle_deg: 22, idle_pressure_angle_deg: 22}"))
    once = drive_of_text(TEXT.format(teeth=24, more="rack: {pressure_angle_deg: 22}"))
    assert np.array_equal(given.teeth.driving.outline_mm, once.teeth.driving.outline_mm)


@pytest.mark.thorough
def test_equal_shifts_of_all_teeth_are_a_profile_shift() -> None:
    each = drive_of_text(TEXT.format(teeth=24, more="profile_shift: {per_tooth: [0.2]}"))
    whole = drive_of_text(TEXT.format(teeth=24, more="profile_shift: {driving: 0.2}"))
    for one, other in ((each.teeth.driving, whole.teeth.driving), (each.teeth.driven, whole.teeth.driven)):
        assert one.outline_mm == pytest.approx(other.outline_mm, abs=1e-11)


def test_a_flank_that_could_not_turn_its_mate_is_refused_though_it_is_idle() -> None:
    steep = TEXT.replace("0.2", "0.8").format(teeth=60, more="rack: {idle_pressure_angle_deg: 38, addendum: 0.8}")
    with pytest.raises(NoSuchMechanism, match="of which the rack has 38"):
        _ = drive_of_text(steep).tooth_form


# --- what is told ----------------------------------------------------------------------------------------------------


@pytest.mark.slow
def test_summary_and_data_sheet_tell_angles_shifts_and_thicknesses() -> None:
    one = drive("asymmetric-ellipse")
    told = teeth_summary(one)
    assert (told["rack_angle_pushing_deg"], told["rack_angle_idle_deg"]) == pytest.approx((25.0, 20.0))
    assert told["profile_shift_driving_mm"] == [0.2, 0.2, 0.2, 0.0, 0.0, 0.0, 0.0, 0.2, 0.2] * 2
    thick = pi + 0.2 * (tan(radians(25.0)) + tan(radians(20.0)))
    assert told["tooth_thickness_driving_mm"][:4] == pytest.approx([thick, thick, thick, pi])
    # Driven teeth fill the driving spaces: what two driving teeth leave of a pitch.
    between = pi - (thick - pi)
    assert told["tooth_thickness_driven_mm"][:2] == pytest.approx([between, between])
    assert len(told["tooth_thickness_driven_mm"]) == 36
    sheet = data_sheet(one)
    labels = {entry.label: entry for group in sheet.groups for entry in group.entries}
    assert labels["pressure angle, idle flanks"].pair == pytest.approx(20.0)
    assert labels["flanks that push face, seen from the end z > 0"].driven == "counter-clockwise"
    assert "unequal pressure angles" in str(labels["places of a span"].driving)
    table = next(table for table in sheet.tables if table.title == "Teeth with a profile shift of their own")
    assert table.rows[0][:3] == pytest.approx((1, 0.1, thick))
    assert len(table.rows) == 36


def test_flanks_that_push_face_as_the_sheet_says() -> None:
    """Counter-clockwise on both gears: the driving gear turns so, and pushes what comes towards it."""
    pitch, pair = pitch_of("ellipse"), made("ellipse", "angles")
    for gear, side in ((pair.driving, -1.0), (pair.driven, 1.0)):
        own = gear.flanks
        flank = int(np.nonzero(own.side == side)[0][3])
        assert own.slant.of(np.array([flank])).sine == pytest.approx(sin(PUSHING))
        across = own.curve.at_length(own.crossing_mm[[flank, flank ^ 1]]).position @ [1.0, 1j]
        # From the tooth's other flank to this one, counter-clockwise about the axis.
        assert np.angle(across[0] / across[1]) > 0.0
    assert pitch.mesh is Mesh.EXTERNAL
