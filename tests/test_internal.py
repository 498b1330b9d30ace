"""Internal pairs: a driving gear inside a driven ring, from the law that allows it to the solid that is written."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from io import BytesIO
from math import cos, pi, radians
from pathlib import Path

import numpy as np
import pytest
from mpmath import mp
from PIL import Image
from shapely import Point, Polygon

from drives import DESIGNS
from engaged import outlines, read
from ncgear.contact.designed.as_designed import as_designed
from ncgear.contact.pair import pair_contact, refuse_bad_outlines
from ncgear.contact.placement import Placement, placed
from ncgear.contact.written.as_written import AsWritten, tips_overlap_mm
from ncgear.design.reading.design_file import load
from ncgear.drawings.plots import assembled_pair as gears
from ncgear.errors import NoSuchMechanism, WrongInput
from ncgear.figures.assembly import Placed, assembled_pose
from ncgear.files.read_back import read_back, stl_bytes
from ncgear.numerics.arrays import Array
from ncgear.pitch.curve import CurvePoints
from ncgear.pitch.internal import LEAST_RATIO, require_ring
from ncgear.pitch.pair import PitchPair, sized_pair
from ncgear.pitch.shape import Gear, Mesh
from ncgear.project.drive import Drive
from ncgear.ratio.laws.expression import ratio_expression_law
from ncgear.ratio.laws.table import ratio_table_law
from ncgear.ratio.laws.uniform import uniform_law
from ncgear.ratio.transmission import Lobes, Transmission
from ncgear.solids.mesh.pair import gear_solid, ring_solid
from ncgear.solids.plan.body import Blank, RingBlank, circle_points
from ncgear.solids.plan.plan import outer_radius_mm, ring_section
from ncgear.solids.plan.room import INNER_WALL_IN_MODULES, OUTER_WALL_IN_MODULES
from ncgear.teeth.form import Backlash, ToothForm
from ncgear.teeth.gear import ToothedPair, toothed_pair
from oracles import meshing
from oracles.rack_cut import involute
from pairs import one_of, rack
from plane import turned, wave_ring

DISTANCE = 60.0

every_gear = pytest.mark.parametrize("gear", list(Gear), ids=lambda gear: gear.value)

VARIABLE = "2 + 0.3*cos(phi)"
"""Its mean is 2, but the mean of its inverse is not 1/2: it is scaled to close."""


@cache
def variable_law() -> Transmission:
    """A ratio that varies about 2, for one lobe on two."""
    return ratio_expression_law(VARIABLE, Lobes(1, 2), scale_to_close=True)


@cache
def variable() -> PitchPair:
    """The internal pair of that law, 60 teeth in a ring of 120."""
    return sized_pair(variable_law(), 60, None, DISTANCE, Mesh.INTERNAL)


@cache
def table() -> PitchPair:
    """Two lobes on three from points: a spline, whose third derivative jumps at each."""
    phi1 = np.linspace(0.0, pi, 16, endpoint=False)
    law = ratio_table_law(phi1, 1.5 + 0.1 * np.cos(2.0 * phi1), Lobes(2, 3), scale_to_close=True)
    return sized_pair(law, 60, None, DISTANCE, Mesh.INTERNAL)


every_pair = pytest.mark.parametrize("of", [variable, pytest.param(table, marks=pytest.mark.slow)])


# --- circles -------------------------------------------------------------------------------------------------------


@pytest.mark.tiers(slow=["lobes2"], rest="long")
@pytest.mark.parametrize("lobes", [Lobes(1, 2), Lobes(1, 3), Lobes(2, 3), Lobes(7, 8)])
def test_a_constant_ratio_makes_a_circle_in_a_circle(lobes: Lobes) -> None:
    found = sized_pair(uniform_law(lobes), 21 * lobes.driving, None, DISTANCE, Mesh.INTERNAL)
    radii = {
        Gear.DRIVING: DISTANCE * lobes.driving / (lobes.driven - lobes.driving),
        Gear.DRIVEN: DISTANCE * lobes.driven / (lobes.driven - lobes.driving),
    }
    for gear, outward in ((Gear.DRIVING, 1.0), (Gear.DRIVEN, -1.0)):
        radius = radii[gear]
        points = one_of(found, gear).at_angle(np.linspace(0.0, 9.0, 31))
        assert np.hypot(*points.position.T) == pytest.approx(np.full(31, radius), rel=1e-13)
        assert points.normal == pytest.approx(outward * points.position / radius, abs=1e-14)
        # The ring's material lies outside its curve and is concave
        assert points.curvature == pytest.approx(np.full(31, outward / radius), rel=1e-13)
        assert found.length_mm(gear) == pytest.approx(2.0 * pi * radius, rel=1e-13)
        # As closed curves both are convex
        assert found.convex(gear)
        assert found.least_radius_mm(gear) == pytest.approx(radius, rel=1e-13)
        assert found.least_concave_radius_mm(gear) is None
        assert found.concave_ranges(gear) == []
    assert found.size.driven_teeth == 21 * lobes.driven
    assert found.size.module_mm == pytest.approx(2.0 * DISTANCE / (21 * (lobes.driven - lobes.driving)), rel=1e-13)
    assert found.pitch_point_mm(np.array([0.0, 1.0])) == pytest.approx([-radii[Gear.DRIVING]] * 2, rel=1e-13)
    assert found.largest_tangent_angle_rad.value == pytest.approx(0.0, abs=1e-15)


# --- rolling -------------------------------------------------------------------------------------------------------

ANGLES = np.linspace(0.05, 4.0 * pi, 43)
"""A turn of the ring, which is two of the driving gear."""


def exact_ratio(angle: float) -> mp.mpf:
    """The scaled ratio: the mean of 1/(2 + 0.3 cos) is 1/sqrt(4 - 0.09), and must be 1/2 for one lobe on two."""
    return (2 + mp.mpf("0.3") * mp.cos(mp.mpf(angle))) * 2 / mp.sqrt(4 - mp.mpf("0.09"))


def test_the_closed_form_of_the_scaled_ratio_is_the_laws() -> None:
    slope = variable_law().driven_angle(ANGLES, 1).derivative(1)
    assert 1.0 / slope == pytest.approx([float(exact_ratio(angle)) for angle in ANGLES], rel=1e-13)


def assembled(of: PitchPair, phi1: Array) -> tuple[CurvePoints, CurvePoints]:
    """The points that touch at driving angles, in the fixed frame: both gears turned in the same sense."""
    driven_angle = of.transmission.driven_angle(phi1).value
    driving, driven = of.driving.at_angle(phi1), of.driven.at_angle(phi1)
    axis = np.array([of.center_distance_mm, 0.0])
    return (
        CurvePoints(
            turned(driving.position, phi1),
            turned(driving.tangent, phi1),
            driving.outside,
            driving.curvature,
        ),
        CurvePoints(
            turned(driven.position, driven_angle) + axis,
            turned(driven.tangent, driven_angle),
            driven.outside,
            driven.curvature,
        ),
    )


@every_pair
def test_both_points_meet_beyond_the_driving_axis_where_velocities_agree(of: Callable[[], PitchPair]) -> None:
    made = of()
    driving, driven = assembled(made, ANGLES)
    pitch_point = made.pitch_point_mm(ANGLES)
    for points in (driving, driven):
        # 180 mm, angles of up to 12 rad rounded
        assert np.max(np.abs(points.position - np.column_stack([pitch_point, np.zeros(43)]))) <= 1e-12
    assert pitch_point.max() < 0.0
    slope = made.transmission.driven_angle(ANGLES, 1).derivative(1)
    # w1 x = w2 (x - a): both gears turn counter-clockwise
    assert pitch_point == pytest.approx(slope * (pitch_point - DISTANCE), rel=1e-13)


@every_pair
def test_tangents_agree_and_the_normals_point_away_from_each_gears_material(of: Callable[[], PitchPair]) -> None:
    driving, driven = assembled(of(), ANGLES)
    assert np.max(np.abs(driving.tangent - driven.tangent)) <= 1e-13
    assert np.max(np.abs(driving.normal + driven.normal)) <= 1e-13
    assert np.all(driving.normal[:, 0] < 0.0)  # away from the driving axis, which lies to the right of the pitch point
    assert np.all(driven.normal[:, 0] > 0.0)  # towards both axes


@every_gear
def test_derivatives_along_the_curve_are_tangent_and_curvature(gear: Gear) -> None:
    """dX/dsigma = T and dT/dsigma = -k N by central differences, whose error of h^2 is extrapolated away."""
    of = one_of(variable(), gear)
    sigma, tangents, bends = np.linspace(1.0, of.length_mm - 1.0, 37), [], []
    for step in (0.02, 0.01):
        before, after = of.at_length(sigma - step), of.at_length(sigma + step)
        tangents.append((after.position - before.position) / (2.0 * step))
        bends.append((after.tangent - before.tangent) / (2.0 * step))
    at = of.at_length(sigma)
    # Left: h^4 / 30 of the fifth derivative, 1e-8 / 1e4 mm^4; rounding 200 mm 1e-16 / h
    assert (4.0 * tangents[1] - tangents[0]) / 3.0 == pytest.approx(at.tangent, abs=1e-10)
    assert (4.0 * bends[1] - bends[0]) / 3.0 == pytest.approx(-at.curvature[:, None] * at.normal, abs=1e-11)


@pytest.mark.tiers(slow=["driving"], rest="long")
@every_gear
def test_arc_lengths_are_those_of_an_independent_quadrature(gear: Gear) -> None:
    """mpmath on r1 = a/(i - 1) and r2 = a i/(i - 1) from the ratio's own formula: the curves roll without slip."""

    def speed(angle: mp.mpf) -> mp.mpf:
        ratio = exact_ratio(angle)
        ratio_slope = mp.diff(exact_ratio, angle)
        radius = DISTANCE / (ratio - 1) if gear is Gear.DRIVING else DISTANCE * ratio / (ratio - 1)
        turned_by = 1 if gear is Gear.DRIVING else 1 / ratio
        return mp.hypot(radius * turned_by, DISTANCE * ratio_slope / (ratio - 1) ** 2)

    of = variable()
    for end in (1.0, 2.5, 2.0 * pi):
        expected = float(mp.quad(speed, mp.linspace(0, end, 5)))
        assert float(of.arc.length(np.array(end))) * DISTANCE == pytest.approx(expected, rel=1e-12)
    assert of.length_mm(Gear.DRIVEN) == pytest.approx(2.0 * of.length_mm(Gear.DRIVING), rel=1e-13)


@every_pair
def test_curvatures_differ_as_euler_and_savary_say(of: Callable[[], PitchPair]) -> None:
    """The common tangent turns by w1 dphi - k1 dsigma on one gear and by w2 dphi + k2 dsigma on the other."""
    pair = of()
    slope = pair.transmission.driven_angle(ANGLES, 1).derivative(1)
    total = pair.driving.at_angle(ANGLES).curvature + pair.driven.at_angle(ANGLES).curvature
    speed = np.gradient(pair.arc.length(np.linspace(-1e-4, 1e-4, 3)[:, None] + ANGLES) * DISTANCE, 1e-4, axis=0)[1]
    assert total == pytest.approx((1.0 - slope) / speed, rel=1e-7)


# --- refusals ------------------------------------------------------------------------------------------------------


def test_a_ratio_that_falls_to_one_is_refused_with_its_angle() -> None:
    law = ratio_expression_law("2 + 1.2*cos(phi)", Lobes(1, 2), scale_to_close=True)
    with pytest.raises(NoSuchMechanism, match=r"phi1 = 3\.14\d* rad") as caught:
        sized_pair(law, 60, 2.0, None, Mesh.INTERNAL)
    assert caught.value.key == "gears.mesh"
    assert f"{law.ratio_range[0].value:.6g}" in caught.value.problem
    assert "a smaller range of the ratio" in caught.value.problem
    assert sized_pair(law, 60, 2.0, None).center_distance_mm > 0.0


@pytest.mark.parametrize("lobes", [Lobes(), Lobes(2, 1)])
def test_too_few_driven_lobes_are_named(lobes: Lobes) -> None:
    with pytest.raises(NoSuchMechanism, match="more lobes of the driven gear") as caught:
        sized_pair(uniform_law(lobes), 60, 2.0, None, Mesh.INTERNAL)
    assert caught.value.key == "gears.mesh"


def nearly_one(least: float) -> Transmission:
    """A closed ratio c (1 + e cos) whose least value c (1 - e) is given; it closes where c = 2 / sqrt(1 - e^2)."""
    depth = (4.0 - least**2) / (4.0 + least**2)
    return ratio_expression_law(f"1 + {depth!r}*cos(phi)", Lobes(1, 2), scale_to_close=True)


def test_the_least_ratio_that_makes_a_ring() -> None:
    law = nearly_one(LEAST_RATIO + 1e-6)
    assert law.ratio_range[0].value == pytest.approx(LEAST_RATIO + 1e-6, rel=1e-9)
    require_ring(law)
    with pytest.raises(NoSuchMechanism, match=r"falls to 1\.0009 at"):
        require_ring(nearly_one(LEAST_RATIO - 1e-4))


def longest(depth: float) -> Transmission:
    """A ratio of 2 + depth cos(phi), scaled to close: the farther it varies, the longer the driving gear."""
    return ratio_expression_law(f"2 + {depth}*cos(phi)", Lobes(1, 2), scale_to_close=True)


@pytest.mark.slow
def test_a_driving_gear_too_long_for_its_ring_is_refused_where_shapely_sees_it_stand_out() -> None:
    """One lobe on two fits until, at phi1 = 0, the driving gear is as long as the ring is wide through its axis.

    r1(0) + r1(pi) = 2 r2(0) is 1/(i(0) - 1) + 1/(i(pi) - 1) = 2 i(0)/(i(0) - 1) and, for i = c (2 +- d) with
    c = (1 - d^2/4)^(-1/2), holds at d = 0.69157.
    """
    fits = sized_pair(longest(0.6912), 60, None, DISTANCE, Mesh.INTERNAL)
    driving, ring = (
        Polygon(of.at_angle(np.linspace(0.0, of.turn_rad, 4000, endpoint=False)).position)
        for of in (fits.driving, fits.driven)
    )
    phi1 = np.linspace(0.0, 2.0 * pi, 26)
    phi2 = fits.transmission.driven_angle(phi1).value
    around = Polygon(ring.buffer(100.0).exterior, [ring.exterior])
    # Chords of up to 0.6 mm on a ring of 75 mm: 6e-4 mm
    assert meshing.Pair(driving, around, phi1, phi2, DISTANCE, 1.0).report(25).overlap_depth.max() <= 6e-4
    with pytest.raises(NoSuchMechanism, match=r"at phi1 = 0 rad .* would stand .* mm out of the ring's") as caught:
        sized_pair(longest(0.6920), 60, None, DISTANCE, Mesh.INTERNAL)
    assert caught.value.key == "gears.mesh"


def test_where_the_driving_gear_stands_out_most_is_found_between_the_positions() -> None:
    """The long sides meet at 2 pi - 1.2345 = 5.049, between positions at 5.027 and 5.061."""
    shifted = ratio_expression_law("2 + 0.72*cos(phi + 1.2345)", Lobes(1, 2), scale_to_close=True)
    with pytest.raises(NoSuchMechanism, match=r"at phi1 = 5\.0[45]\d* rad .* would stand .* mm out of the ring's"):
        sized_pair(shifted, 60, None, DISTANCE, Mesh.INTERNAL)


# --- teeth ---------------------------------------------------------------------------------------------------------

MODULE = 2.0
TOLERANCE = 0.005
ALPHA = radians(20.0)

Made = tuple[PitchPair, ToothedPair]


@cache
def made(law: str, teeth: int, backlash_mm: float = 0.0) -> Made:
    """Pitch curves and teeth with an addendum of 0.8 modules; lobes n1:n2 of circles, or the variable law."""
    transmission = variable_law() if law == "variable" else uniform_law(Lobes(*map(int, law.split(":"))))
    pitch = sized_pair(transmission, teeth, MODULE, None, Mesh.INTERNAL)
    return pitch, toothed_pair(
        pitch, ToothForm(rack(addendum=0.8, module=MODULE), backlash=Backlash(backlash_mm)), TOLERANCE
    )


@pytest.mark.tiers(slow=["1:2"], rest="long")
@pytest.mark.parametrize("law", ["1:2", "1:3"])
def test_spaces_of_a_circular_ring_are_involute_teeth_of_its_base_circle(law: str) -> None:
    """At radius r a space is pi/z - 2 inv(alpha_r) + 2 inv(alpha) wide, cos(alpha_r) = r_b2/r, as a tooth would be."""
    _, pair = made(law, 60)
    flanks, teeth = pair.driven.flanks, pair.driven.teeth
    base = MODULE * teeth / 2.0 * cos(ALPHA)
    height = np.linspace(-0.7, 0.8, 16) * MODULE
    points = flanks.flank(np.arange(flanks.count)[:, None], height)[0]
    radius, polar = np.hypot(points[..., 0], points[..., 1]), np.arctan2(points[..., 1], points[..., 0])
    half = pi / (2.0 * teeth) - involute(np.arccos(base / radius)) + involute(np.array(ALPHA))
    # Spaces stand every pitch from polar angle pi on; arc length runs clockwise, so fronts are met after their space
    step = 2.0 * pi / teeth
    from_space = np.mod(polar - pi + step / 2.0, step) - step / 2.0
    assert np.abs(from_space) == pytest.approx(half, abs=1e-13)
    assert np.sign(from_space) == pytest.approx(np.broadcast_to(flanks.side[:, None], from_space.shape))
    assert np.ptp(radius[0]) > MODULE


@pytest.mark.tiers(slow=["1:2"], rest="long")
@pytest.mark.parametrize("law", ["1:2", "variable"])
def test_mating_flanks_touch_where_their_normal_goes_through_the_pitch_point(law: str) -> None:
    """A driving flank at height h and the ring's flank of the same crossing at -h, in the fixed frame."""
    pitch, pair = made(law, 60)
    own, other = pair.driving.flanks, pair.driven.flanks
    mates = np.searchsorted(np.round(other.crossing_mm, 6), np.round(own.crossing_mm[2:], 6))
    flank = np.arange(2, own.count)
    assert own.crossing_mm[2:] == pytest.approx(other.crossing_mm[mates], abs=1e-9)
    assert np.array_equal(own.side[2:], -other.side[mates])
    for height in (-1.2, 0.5, 1.5):
        at = np.full(flank.size, height)
        phi1 = own.curve.driving_angle(own.rolled_mm(flank, at))
        phi2 = pitch.transmission.driven_angle(phi1).value
        points, along = (turned(vectors, phi1) for vectors in own.flank(flank, at))
        mating = turned(other.flank(mates, -at)[0], phi2) + np.array([pitch.center_distance_mm, 0.0])
        assert np.max(np.abs(points - mating)) <= 1e-10
        arm = points - np.column_stack([pitch.pitch_point_mm(phi1), np.zeros(phi1.size)])
        assert np.max(np.abs(np.sum(arm * along, axis=1)) / np.linalg.norm(along, axis=1)) <= 1e-10


@pytest.mark.slow
def test_the_rings_outline_is_the_edge_of_its_hole() -> None:
    """Counter-clockwise, tips towards the axis, roots away from it."""
    _, pair = made("1:2", 60)
    x, y = pair.driven.outline_mm.T
    assert np.sum(x * np.roll(y, -1) - y * np.roll(x, -1)) > 0.0
    radius = np.hypot(x, y)
    assert radius.min() == pytest.approx(MODULE * (60.0 - 0.8), abs=2.0 * TOLERANCE)
    # As deep as the driving gear's tips need, with a clearance of a quarter of a module or a little more.
    assert MODULE * (60.0 + 1.05) < radius.max() < MODULE * (60.0 + 1.30)


# --- meshing -------------------------------------------------------------------------------------------------------


def ring_of(outline_mm: Array) -> Polygon:
    """A ring of material around an outline."""
    return Polygon(circle_points(float(np.abs(outline_mm).max()) * 1.5, 0.1), [outline_mm])


def judge_of(pair: Made, phi1: Array) -> meshing.Pair:
    """The outlines as the judge takes them: the driven gear turns in the driving one's sense."""
    driving, driven = pair[1].driving.outline_mm, pair[1].driven.outline_mm
    phi2 = pair[0].transmission.driven_angle(phi1).value
    return meshing.Pair(Polygon(driving), ring_of(driven), phi1, phi2, pair[0].center_distance_mm, 1.0)


def turns(count: int = 101) -> Array:
    """Driving angles over a turn of the ring, two of the driving gear; the count is prime to keep out of step."""
    return np.arange(count) * (4.0 * pi / count)


@pytest.mark.tiers(slow=["1:2"], rest="long")
@pytest.mark.parametrize("law", ["1:2", "variable"])
def test_pairs_neither_overlap_nor_stand_apart(law: str) -> None:
    report = judge_of(made(law, 60), turns()).report(101)
    # Chords of the ring's concave flanks lie outside its material's true edge by up to the tolerance, those of the
    # driving gear's convex ones inside; the judge's depth is good to 6 %
    assert report.overlap_depth.max() <= 1.06 * TOLERANCE
    assert report.gap.max() <= 2.0 * TOLERANCE


@pytest.mark.tiers(slow=["0.002"], rest="long")
@pytest.mark.parametrize("ahead_rad", [0.002, -0.002])
def test_a_slight_turn_makes_them_overlap(ahead_rad: float) -> None:
    judge = judge_of(made("variable", 60), turns(11))
    depths = [judge.overlap(phi1, phi2 + ahead_rad)[1] for phi1, phi2 in zip(judge.phi1, judge.phi2, strict=True)]
    assert min(depths) > 10.0 * TOLERANCE


@pytest.mark.slow
def test_turned_against_each_other_they_do_not_mesh() -> None:
    """Negative control of the sense."""
    pair = made("variable", 60)
    judge = judge_of(pair, turns(11))
    against = meshing.Pair(judge.driving, judge.driven, judge.phi1, judge.phi2, judge.center_distance, -1.0)
    assert against.report(11).overlap_depth.max() > 0.5 * MODULE


def contact_of(pair: Made) -> tuple[AsWritten, Placement]:
    """Contact of the outlines, and its positions."""
    at = placed(pair[0])
    return read(outlines(pair[1]), pair[0], pair[1], at), at


@pytest.mark.tiers(slow=["1:2"], rest="long")
@pytest.mark.parametrize("law", ["1:2", "variable"])
def test_play_is_what_shapely_finds(law: str) -> None:
    pair = made(law, 60, 0.05)
    found, at = contact_of(pair)
    judge = judge_of(pair, at.phi1_rad)
    for row in (0, 170, 500, 711, 932):
        expected = judge.driven_play(row, tolerance=1e-7)
        # The judge allows 1e-7 mm of overlap at 100 mm and bisects to 1e-9 rad
        assert (-found.pushing_rad[row], found.back_rad[row]) == pytest.approx(expected, abs=1e-8)


@pytest.mark.slow
def test_transmission_error_is_that_of_the_chords() -> None:
    found, _ = contact_of(made("1:2", 60))
    # Both outlines within the tolerance of the exact flank, as an arc about the ring's base circle
    assert 0.0 < found.transmission_error_rad <= 2.0 * TOLERANCE / (120.0 * cos(ALPHA))
    assert found.overlap_mm.max() <= TOLERANCE


# --- fouling -------------------------------------------------------------------------------------------------------


@pytest.mark.tiers(slow=["1:2-60"], rest="long")
@pytest.mark.parametrize(
    ("law", "teeth"), [("1:2", 60), ("4:5", 40), pytest.param("10:11", 40, marks=[pytest.mark.slow, pytest.mark.long])]
)
def test_tips_overlap_as_far_as_their_circles_cross(law: str, teeth: int) -> None:
    pitch, pair = made(law, teeth)
    distance = pitch.center_distance_mm
    driving, driven = MODULE * (teeth / 2.0 + 0.8), MODULE * (pair.driven.teeth / 2.0 - 0.8)
    x = (driving**2 - driven**2 + distance**2) / (2.0 * distance)
    point = pitch.pitch_point_mm(np.zeros(1))[0]
    expected = np.hypot(x - point, np.sqrt(driving**2 - x**2))
    # Short of the crossing by up to an eighth of a pitch
    assert expected - pi * MODULE / 8.0 <= tips_overlap_mm(pitch, pair) <= expected + 1e-9


def full_height(monkeypatch: pytest.MonkeyPatch) -> Made:
    """Four teeth more on the ring, with tips that nothing has shortened."""
    monkeypatch.setattr("ncgear.teeth.fitting.freed", lambda own, mate, paths: own)
    return made.__wrapped__("5:6", 20, 0.1)


@pytest.mark.long
@pytest.mark.slow
def test_fouling_far_from_the_line_of_action_is_seen_and_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    """Tips run into each other 13 modules from the pitch point, where flanks are clear."""
    pitch, pair = full_height(monkeypatch)
    found, at = contact_of((pitch, pair))
    report = judge_of((pitch, pair), at.phi1_rad[::40]).report(11)
    assert found.overlap_mm.max() > 0.1
    assert report.overlap_depth.max() > 0.1
    contact = pair_contact(pitch, pair, as_designed(pair, at), [outlines(pair)])
    with pytest.raises(NoSuchMechanism, match=r"run into each other by .* too few teeth more") as caught:
        refuse_bad_outlines(contact, TOLERANCE)
    assert caught.value.key == "gears.teeth"


@pytest.mark.long
@pytest.mark.slow
def test_tips_that_would_foul_are_shortened() -> None:
    pair = made("5:6", 20, 0.1)
    found, at = contact_of(pair)
    assert found.overlap_mm.max() <= TOLERANCE
    assert judge_of(pair, at.phi1_rad[::40]).report(11).overlap_depth.max() <= 1.06 * TOLERANCE


@pytest.mark.long
@pytest.mark.slow
def test_seven_teeth_more_on_the_ring_keep_clear() -> None:
    found, _ = contact_of(made("4:5", 28, 0.1))
    assert found.overlap_mm.max() <= TOLERANCE


# --- solids --------------------------------------------------------------------------------------------------------

TEETH, WAVE, RADIUS = 40, 2.2, 50.0


def wavy(points: int = 40_000) -> Array:
    """A hole like a ring's: a root at polar angle pi, radius RADIUS + WAVE cos(TEETH angle)."""
    return wave_ring(RADIUS, WAVE, TEETH, points)


@pytest.mark.slow
def test_the_volume_of_a_ring_is_that_of_the_closed_form() -> None:
    solid = ring_solid(wavy(), RingBlank(20.0, 8.0), MODULE, 1e-4)
    outer = RADIUS + WAVE + 8.0
    assert outer_radius_mm(wavy(), 8.0) == pytest.approx(outer, rel=1e-12)
    # Chords of 8 um on the outline, a chord tolerance of 0.1 um on the circle of 378 mm
    assert solid.mesh.volume == pytest.approx(20.0 * pi * (outer**2 - RADIUS**2 - WAVE**2 / 2.0), rel=3e-5)
    assert solid.mesh.is_watertight
    assert solid.mesh.euler_number == 0
    assert solid.index_hole is None
    assert np.hypot(*solid.mesh.vertices[:, :2].T).max() == pytest.approx(outer, rel=1e-12)


@pytest.mark.slow
def test_a_ring_reads_back_from_its_stl() -> None:
    mesh = ring_solid(wavy(4000), RingBlank(20.0, 8.0, index_hole=True), MODULE, TOLERANCE).mesh
    assert mesh.euler_number == -2
    assert read_back(stl_bytes(mesh), mesh).is_watertight


@pytest.mark.thorough
def test_the_index_hole_of_a_ring_stands_behind_its_root_and_faces_that_of_the_driving_gear() -> None:
    ring = ring_solid(wavy(4000), RingBlank(20.0, 8.0, index_hole=True), MODULE, TOLERANCE).index_hole
    driving = gear_solid(
        Gear.DRIVING, wavy(4000) / 2.0, Blank(20.0, None, True), MODULE, TOLERANCE, Mesh.INTERNAL
    ).index_hole
    assert ring is not None
    assert driving is not None
    section = ring_section(wavy(4000), 8.0, TOLERANCE)
    center, half = Point(ring.x_mm, ring.y_mm), ring.diameter_mm / 2.0
    # As near to the teeth as the wall allows; buffers are polygons, a thousandth off
    wall = section.interiors[0].distance(center) - half
    assert wall == pytest.approx(OUTER_WALL_IN_MODULES * MODULE, rel=5e-3)
    assert section.exterior.distance(center) - half >= INNER_WALL_IN_MODULES * MODULE * (1.0 - 5e-3)
    for hole in (ring, driving):
        assert hole.x_mm < 0.0
        assert abs(hole.y_mm) < 1e-12 * RADIUS


@pytest.mark.thorough
def test_a_rim_too_thin_has_no_index_hole() -> None:
    least = (OUTER_WALL_IN_MODULES + INNER_WALL_IN_MODULES + 0.5) * MODULE
    for rim, there in ((least + 0.2, True), (least - 0.2, False)):
        hole = ring_solid(wavy(4000), RingBlank(20.0, rim, index_hole=True), MODULE, TOLERANCE).index_hole
        assert (hole is not None) is there


def test_assembled_pose_names_what_meets_in_a_ring() -> None:
    tooth, space = Placed(wavy(4000) / 2.0, RADIUS / 2.0, None), Placed(wavy(4000), RADIUS, None, is_ring=True)
    report = assembled_pose(tooth, space, RADIUS / 2.0, MODULE, Mesh.INTERNAL)
    assert (report["driving"]["on_line_of_centers"], report["driven"]["on_line_of_centers"]) == ("tooth", "space")
    angles = [report[gear]["line_of_centers_rad"] for gear in ("driving", "driven")]
    assert angles == pytest.approx([pi, pi], abs=1e-7)
    assert report["mesh"] == "internal"


# --- pictures ------------------------------------------------------------------------------------------------------


def picture(png: bytes) -> Array:
    """Red, green and blue from 0 to 255, shape (height, width, 3)."""
    return np.asarray(Image.open(BytesIO(png)).convert("RGB"), dtype=float)


@pytest.mark.tiers(slow=["1"], rest="long")
@pytest.mark.parametrize("sense", [1, -1])
def test_the_ring_is_filled_outside_its_curve_and_the_driving_gear_inside(sense: int) -> None:
    """Whichever way the curve runs, as areas tell: a hole that is filled makes the ring nearly twice as large."""
    angle = np.linspace(0.0, 2.0 * pi, 400)[::sense]
    circle = np.column_stack([np.cos(angle), np.sin(angle)])
    pair, concave = gears.Assembled(10.0 * circle, 40.0 * circle, 30.0, 60.0), np.zeros(400, dtype=bool)
    pixels = picture(gears.pitch_curves_png(pair, (concave, concave), "pitch curves"))
    tinted = np.abs(pixels - 255.0).max(axis=2) > 20.0
    colored = pixels[tinted & (np.ptp(pixels, axis=2) > 10.0)]
    orange, blue = np.sum(colored[:, 0] > colored[:, 2]), np.sum(colored[:, 2] > colored[:, 0])
    # Areas: pi (60^2 - 40^2) to pi 10^2; lines of 1.8 points add to both
    assert orange / blue == pytest.approx(20.0, rel=0.25)


@pytest.mark.slow
def test_the_ring_is_drawn_turned_with_the_driving_gear() -> None:
    """By phi2 = 0.3: as one that stands at 0.3 with phi2 = 0.  Titles, which name phi2, are in the upper half."""

    def mesh_view(outline: Array, phi2: float) -> Array:
        shown = [gears.AssembledPosition(0.0, phi2, -RADIUS / 2.0)]
        pair = gears.Assembled(wavy(4000) / 2.0, outline, RADIUS / 2.0, RADIUS + 10.0)
        pixels = picture(gears.teeth_png(pair, MODULE, shown, "teeth"))
        return pixels[pixels.shape[0] // 2 :]

    ring = wavy(4000) * (1.0 + 0.1 * np.sin(np.linspace(0.0, 2.0 * pi, 4000, endpoint=False)))[:, None]
    turned_on, turned_back = (turned(ring, np.asarray(angle)) for angle in (0.3, -0.3))
    assert np.abs(mesh_view(ring, 0.3) - mesh_view(turned_on, 0.0)).max() <= 2.0
    assert np.abs(mesh_view(ring, 0.3) - mesh_view(turned_back, 0.0)).max() > 100.0


# --- from the design file ------------------------------------------------------------------------------------------

DESIGN = (DESIGNS / "internal-1-2.yaml").read_text(encoding="utf-8")


def design_with(tmp_path: Path, old: str, new: str) -> Path:
    """The worked example with one change."""
    assert DESIGN.count(old) == 1
    path = tmp_path / "design.yaml"
    path.write_text(DESIGN.replace(old, new), encoding="utf-8")
    return path


@pytest.mark.parametrize(
    ("old", "new", "key", "problem"),
    [
        ("driven: {rim_mm: 8}", "driven: {bore_mm: 8}", "gears.driven.bore_mm", "a ring .* has no bore"),
        ("mesh: internal", "mesh: external", "gears.driven.rim_mm", "only a ring has a rim"),
        ("driving: {bore_mm: 16,", "driving: {rim_mm: 8, bore_mm: 16,", "gears.driving.rim_mm", "unknown"),
        ("mesh: internal", "mesh: inside", "gears.mesh", "external"),
    ],
)
def test_bodies_that_do_not_belong_to_the_mesh_are_refused(
    tmp_path: Path, old: str, new: str, key: str, problem: str
) -> None:
    with pytest.raises(WrongInput, match=problem) as caught:
        load(design_with(tmp_path, old, new))
    assert caught.value.key == key


def test_a_ratio_too_small_is_refused_at_the_key_of_the_mesh(tmp_path: Path) -> None:
    drive = Drive(load(design_with(tmp_path, "2 + 0.4*cos(phi)", "2 + 1.4*cos(phi)")).design)
    assert drive.check.peak_speed.value > 0.0
    with pytest.raises(NoSuchMechanism, match=r"falls to 0\.84") as caught:
        _ = drive.pitch
    assert caught.value.key == "gears.mesh"


@pytest.mark.slow
def test_the_rim_is_three_and_a_half_modules_where_the_file_says_nothing(tmp_path: Path) -> None:
    for path, rim in (
        (DESIGNS / "internal-1-2.yaml", 8.0),
        (design_with(tmp_path, "  driven: {rim_mm: 8}\n", ""), 7.0),
    ):
        drive = Drive(load(path).design)
        radius = np.hypot(*drive.solids.driven.mesh.vertices[:, :2].T).max()
        assert radius - np.hypot(*drive.teeth.driven.outline_mm.T).max() == pytest.approx(rim, abs=1e-9)
