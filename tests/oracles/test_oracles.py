"""The oracles themselves: pinned against published and hand-derived numbers, with negative controls."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import shapely
import trimesh
from mpmath import mp
from shapely import Polygon, affinity

from . import meshing, rack_cut, stroke

ALPHA = np.radians(20.0)
MODULE = 2.0


# --- stroke ------------------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def baler() -> stroke.Cycle:
    """The baler of Table 1, e = 0."""
    return stroke.cycle(stroke.BALER, "0")


@pytest.fixture(scope="module")
def working_angles(baler: stroke.Cycle) -> list[stroke.Real]:
    """Angles over the working stroke."""
    return [baler.working.theta4 * k / 120 for k in range(121)]


@pytest.fixture(scope="module")
def return_angles(baler: stroke.Cycle) -> list[stroke.Real]:
    """Angles over the return."""
    return [baler.working.theta4 + (2 * mp.pi - baler.working.theta4) * k / 120 for k in range(1, 121)]


@pytest.mark.slow
def test_baler_closes_at_the_known_law_speed(baler: stroke.Cycle) -> None:
    assert float(baler.working.omega) == pytest.approx(5.5301, abs=5e-5)
    assert abs(baler.working.displacement("13*pi/10") - 760) < mp.mpf(10) ** -50


def test_baler_at_one_speed_for_everything_closes_at_51_rpm() -> None:
    parameters = replace(stroke.BALER, a1_reference_speed=None)
    assert float(stroke.Stroke(parameters).omega * 30 / mp.pi) == pytest.approx(51.31, abs=5e-3)


@pytest.mark.slow
def test_segments_meet_every_condition(baler: stroke.Cycle) -> None:
    omega, s = baler.working.omega, baler.working.displacement
    with mp.workdps(60):
        expected = [("0", 1, 0), ("2*pi/5", 1, 1600 / omega), ("2*pi/5", 2, 0), ("7*pi/10", 1, 1100 / omega)]
        expected += [("7*pi/10", 2, 0), ("pi", 1, 1100 / omega), ("13*pi/10", 1, 0)]
        expected += [("13*pi/10", 2, -1500 / stroke.exact("2*pi/3") ** 2)]
        for angle, order, value in expected:
            assert abs(s(angle, order) - value) < mp.mpf(10) ** -50


@pytest.mark.slow
def test_ratio_range_over_the_turn(
    baler: stroke.Cycle, working_angles: list[stroke.Real], return_angles: list[stroke.Real]
) -> None:
    ratios = [float(baler.ratio(angle)) for angle in working_angles + return_angles]
    assert min(ratios) == pytest.approx(0.44, abs=0.005)
    assert max(ratios) == pytest.approx(2.05, abs=0.01)


@pytest.mark.slow
def test_peak_power_and_acceleration(
    baler: stroke.Cycle, working_angles: list[stroke.Real], return_angles: list[stroke.Real]
) -> None:
    force = ["2.498e-7", "-1.575e-4", "1.846e-2", "3.447", "-131.2779"]
    s = baler.displacement
    per_speed = max(mp.polyval([mp.mpf(c) for c in force], s(a)) * s(a, 1) for a in working_angles) / 1000
    speed = 2 * mp.pi / 3
    assert float(per_speed * speed) == pytest.approx(6315, rel=1e-3)
    assert float(per_speed * baler.working.omega) == pytest.approx(16675, rel=1e-3)
    assert float(max(abs(s(a, 2)) for a in working_angles) * speed**2) == pytest.approx(1500, rel=1e-9)
    assert float(max(abs(s(a, 2)) for a in return_angles[::2]) * speed**2) == pytest.approx(7340, rel=3e-3)


@pytest.mark.slow
@pytest.mark.parametrize("angle", ["1e-9", "0.001", "1", "2.5", "4"])
def test_inversion_agrees_with_the_in_line_closed_form(baler: stroke.Cycle, angle: str) -> None:
    with mp.workdps(120):
        x = stroke.solve(stroke.BALER, 120).displacement(mp.mpf(angle))
        phi2 = 2 * mp.atan(mp.sqrt(x * (x + 1920) / ((760 - x) * (x + 1160))))
        assert abs(baler.driven_angle(angle) / phi2 - 1) < mp.mpf(10) ** -40


@pytest.mark.slow
def test_ratio_near_dead_centres_follows_the_limit_and_its_slope(baler: stroke.Cycle) -> None:
    with mp.workdps(60):
        step = mp.mpf("1e-9")
        for end, direction in ((mp.mpf(0), 1), (baler.working.theta4, -1)):
            slope = baler.working.ratio_slope_at_dead_centre(end > 0)
            linear = baler.working.ratio(end) + direction * step * slope
            assert abs(baler.working.ratio(end + direction * step) - linear) < mp.mpf(10) ** -16


@pytest.mark.slow
def test_ratio_is_the_derivative_of_the_driven_angle(baler: stroke.Cycle) -> None:
    for angle in ("1e-6", "1.7", "3.3", "4.5", "6"):
        with mp.workdps(60):
            at, h = mp.mpf(angle), mp.mpf(10) ** -14
            slope = (baler.driven_angle(at + h) - baler.driven_angle(at - h)) / (2 * h)
            assert abs(slope * baler.ratio(at) - 1) < mp.mpf(10) ** -20


@pytest.mark.slow
def test_return_meets_its_conditions(baler: stroke.Cycle) -> None:
    with mp.workdps(60):
        back, work = baler.returning, baler.working
        assert back.coefficients[0] == 0
        assert abs(back.driven_angle("2*pi") - 2 * mp.pi) < mp.mpf(10) ** -45
        for joint, end in ((work.theta4, True), (2 * mp.pi, False)):
            assert abs(back.ratio(joint) - work.ratio(work.theta4 if end else 0)) < mp.mpf(10) ** -45
            assert abs(back.ratio(joint, 1) - work.ratio_slope_at_dead_centre(end)) < mp.mpf(10) ** -45


def test_offset_linkage_pose_and_working_angle() -> None:
    linkage = stroke.Linkage("380", "960", "100")
    with mp.workdps(50):
        end = linkage.working_angle()
        assert abs(linkage.displacement(mp.mpf(0))) < mp.mpf(10) ** -45
        assert abs(linkage.displacement(end) - linkage.stroke()) < mp.mpf(10) ** -45
        assert abs(linkage.slope(mp.mpf(0))) + abs(linkage.slope(end)) < mp.mpf(10) ** -45
        assert abs(mp.diff(linkage.displacement, mp.mpf(1)) - linkage.slope(mp.mpf(1))) < mp.mpf(10) ** -40


@pytest.mark.slow
def test_offset_stroke_near_a_dead_centre() -> None:
    """No symmetry helps here: the ratio's slope at the dead centre has a part from the linkage."""
    work = stroke.Stroke(replace(stroke.BALER, offset="100"))
    with mp.workdps(60):
        steps = [mp.mpf("1e-7"), mp.mpf("1e-9")]
        slopes = [(work.ratio(step) - work.ratio(0)) / step for step in steps]
        slope = work.ratio_slope_at_dead_centre(False)
        assert abs(slopes[0] - slope) / abs(slopes[1] - slope) == pytest.approx(100, rel=1e-3)


# --- cutting -----------------------------------------------------------------------------------------------------

TOOTH = rack_cut.Proportions(MODULE, ALPHA, MODULE, 1.25 * MODULE, 0.38 * MODULE)


def involute(angle: np.ndarray | float) -> np.ndarray:
    """Involute function."""
    return np.tan(angle) - np.asarray(angle)


def half_tooth_angle(teeth: int, radius: np.ndarray, thinning: float = 0.0) -> np.ndarray:
    """Polar half angle of a standard involute tooth at radii."""
    base = teeth * MODULE / 2 * np.cos(ALPHA)
    at_pitch = (np.pi * MODULE / 2 - thinning) / (teeth * MODULE)
    return at_pitch + involute(ALPHA) - involute(np.arccos(np.minimum(1.0, base / radius)))


def circle_curve(radius: float, samples: int = 2000) -> rack_cut.PitchCurve:
    """A circle as a pitch curve."""
    angle = np.linspace(0, 2 * np.pi, samples, endpoint=False)
    normals = np.column_stack([np.cos(angle), np.sin(angle)])
    tangents = np.column_stack([-np.sin(angle), np.cos(angle)])
    return rack_cut.PitchCurve(radius * normals, tangents, normals, radius * angle, 2 * np.pi * radius)


def mirrored(curve: rack_cut.PitchCurve) -> rack_cut.PitchCurve:
    """The curve run through clockwise."""
    flip = np.array([1.0, -1.0])
    return rack_cut.PitchCurve(
        curve.points * flip, curve.tangents * flip, curve.normals * flip, curve.sigma, curve.length
    )


def flank_points(teeth: int, tooth_at_zero: bool = True, thinning: float = 0.0) -> np.ndarray:
    """Points on the exact involutes of all teeth, clear of tip and fillet."""
    radius = np.linspace(teeth * MODULE / 2 - 0.5 * MODULE, teeth * MODULE / 2 + 0.97 * MODULE, 40)
    half = half_tooth_angle(teeth, radius, thinning)
    centre = (np.arange(teeth) + (0.0 if tooth_at_zero else 0.5)) * 2 * np.pi / teeth
    angle = (centre[:, None, None] + half * np.array([1, -1])[None, :, None]).reshape(-1, len(radius))
    return shapely.points((radius * np.cos(angle)).ravel(), (radius * np.sin(angle)).ravel())


@pytest.mark.slow
@pytest.mark.parametrize("tooth_at_zero", [True, False])
@pytest.mark.parametrize("turn", [lambda curve: curve, mirrored], ids=["counter-clockwise", "clockwise"])
def test_rack_on_a_circle_leaves_the_involute(
    tooth_at_zero: bool, turn: Callable[[rack_cut.PitchCurve], rack_cut.PitchCurve]
) -> None:
    gear = rack_cut.cut(turn(circle_curve(25.0)), TOOTH, 25, tooth_at_zero, positions_per_pitch=50)
    assert rack_cut.deviation_of_points(flank_points(25, tooth_at_zero), gear).max() < 5e-5
    tip, root = np.hypot(*shapely.get_coordinates(gear).T).max(), np.hypot(*shapely.get_coordinates(gear).T).min()
    assert (tip, root) == pytest.approx((27.0, 22.5), abs=2e-5)


@pytest.mark.slow
def test_scallops_shrink_with_the_square_of_the_step() -> None:
    gears = [rack_cut.cut(circle_curve(25.0), TOOTH, 25, True, positions_per_pitch=n) for n in (13, 52)]
    coarse, fine = (rack_cut.deviation_of_points(flank_points(25), gear).max() for gear in gears)
    assert 10 < coarse / fine < 22


@pytest.mark.slow
def test_thinning_is_taken_at_the_pitch_line() -> None:
    thin = rack_cut.Proportions(MODULE, ALPHA, MODULE, 1.25 * MODULE, 0.38 * MODULE, thinning=0.1)
    gear = rack_cut.cut(circle_curve(25.0), thin, 25, True)
    assert rack_cut.deviation_of_points(flank_points(25, thinning=0.1), gear).max() < 2e-5


@pytest.mark.slow
def test_pinion_cutter_leaves_the_same_flanks() -> None:
    gear = rack_cut.cut(circle_curve(25.0), TOOTH, 25, True, rack_cut.Pinion(20), 40)
    assert rack_cut.deviation_of_points(flank_points(25), gear).max() < 5e-4


def lobed_curve(depth: float, teeth: int, samples: int = 3000) -> rack_cut.PitchCurve:
    """r = R (1 + depth cos 2 theta), of the length of so many teeth; concave for depth > 1/5."""
    angle = np.linspace(0, 2 * np.pi, 200_001)
    radius, slope = 1 + depth * np.cos(2 * angle), -2 * depth * np.sin(2 * angle)
    speed = np.hypot(radius, slope)
    sigma = np.append(0.0, np.cumsum((speed[1:] + speed[:-1]) / 2) * (angle[1] - angle[0]))
    scale = np.pi * MODULE * teeth / sigma[-1]
    a = np.interp(np.arange(samples) * sigma[-1] / samples, sigma, angle)
    r, dr = 1 + depth * np.cos(2 * a), -2 * depth * np.sin(2 * a)
    tangents = np.column_stack([dr * np.cos(a) - r * np.sin(a), dr * np.sin(a) + r * np.cos(a)])
    tangents /= np.linalg.norm(tangents, axis=1, keepdims=True)
    normals = np.column_stack([tangents[:, 1], -tangents[:, 0]])
    points = scale * r[:, None] * np.column_stack([np.cos(a), np.sin(a)])
    return rack_cut.PitchCurve(points, tangents, normals, scale * np.interp(a, angle, sigma), scale * sigma[-1])


def conjugate_flank_points(curve: rack_cut.PitchCurve, teeth: int) -> np.ndarray:
    """Where rack flanks touch by the law of gearing: at contact the flank's normal goes through the pitch point."""
    along = np.linspace(-0.6, 0.8, 15)[:, None] * MODULE / np.sin(ALPHA)  # from the pitch point, along the normal
    found = []
    for side in (1, -1):
        cross = np.arange(teeth) * np.pi * MODULE + side * np.pi * MODULE / 4
        point, tangent, normal = curve.at((cross - side * along / np.cos(ALPHA)).ravel())
        step = along.repeat(teeth, axis=1).ravel()[:, None]
        found.append(point + step * (side * np.cos(ALPHA) * tangent + np.sin(ALPHA) * normal))
    return shapely.points(np.vstack(found))


@pytest.mark.slow
def test_rack_on_a_convex_curve_leaves_conjugate_flanks() -> None:
    curve = lobed_curve(0.1, 40)
    gear = rack_cut.cut(curve, TOOTH, 40, True, positions_per_pitch=50)
    assert rack_cut.deviation_of_points(conjugate_flank_points(curve, 40), gear).max() < 5e-5


@pytest.mark.slow
def test_on_a_concave_curve_the_pinion_is_right_and_the_rack_gouges() -> None:
    curve = lobed_curve(0.3, 60)
    flanks = conjugate_flank_points(curve, 60)
    flanks = flanks[shapely.contains(rack_cut.blank(curve, 0.98 * MODULE), flanks)]
    pinion = rack_cut.cut(curve, TOOTH, 60, True, rack_cut.Pinion(20), 25, 1.5)
    rack = rack_cut.cut(curve, TOOTH, 60, True, rack_cut.Rack(), 25)
    assert rack_cut.deviation_of_points(flanks, pinion).max() < 6e-4
    assert rack_cut.deviation_of_points(flanks, rack).max() > 0.3


@pytest.mark.slow
def test_wrong_phase_is_seen() -> None:
    gear = rack_cut.cut(circle_curve(25.0), TOOTH, 25, False, positions_per_pitch=25)
    assert rack_cut.deviation_of_points(flank_points(25, True), gear).max() > 0.5


@pytest.mark.slow
def test_outline_distance_of_known_shapes() -> None:
    one = shapely.Point(0, 0).buffer(10, quad_segs=200)
    assert rack_cut.outline_distance(one, affinity.translate(one, 0.3)) == pytest.approx(0.3, abs=1e-3)
    spike = one.union(shapely.box(9, -0.5, 12, 0.5))
    assert rack_cut.outline_distance(one, spike) == pytest.approx(np.hypot(12, 0.5) - 10, abs=1e-3)


# --- meshing -----------------------------------------------------------------------------------------------------

PHI1 = np.linspace(0, 2 * np.pi, 2001)


def involute_gear(teeth: int, phase: float = 0.0, samples: int = 60) -> Polygon:
    """Standard involute gear without backlash; radial lines below the base circle."""
    pitch = teeth * MODULE / 2
    base = pitch * np.cos(ALPHA)
    # even steps of the roll angle: the chord error is then about even along the flank
    radius = np.sqrt(np.linspace(0, 1, samples) ** 2 * ((pitch + MODULE) ** 2 - base**2) + base**2)
    half = half_tooth_angle(teeth, radius)
    radius, half = np.append(pitch - 1.25 * MODULE, radius), np.append(half[0], half)
    r = np.tile(np.append(radius, radius[::-1]), teeth)
    centres = phase + np.arange(teeth) * 2 * np.pi / teeth
    angle = (centres[:, None] + np.append(-half, half[::-1])[None, :]).ravel()
    return Polygon(np.column_stack([r * np.cos(angle), r * np.sin(angle)]))


def involute_pair(distance: float = 55.0, turned: float = 0.0, samples: int = 60) -> meshing.Pair:
    """25 and 30 teeth in mesh; the driven gear has a space on the line of centres at phi1 = 0."""
    driven = involute_gear(30, np.pi + np.pi / 30 + turned, samples)
    return meshing.Pair(involute_gear(25, 0.0, samples), driven, PHI1, PHI1 * 25 / 30, distance)


@pytest.mark.slow
def test_exact_involutes_neither_overlap_nor_leave_a_gap() -> None:
    coarse, fine = (involute_pair(samples=samples).report() for samples in (30, 60))
    assert len(fine.phi1) == 401
    assert fine.overlap_depth.max() < 1e-9  # chords of convex flanks lie inside the teeth
    assert fine.gap.max() < 2e-4
    assert 3 < coarse.gap.max() / fine.gap.max() < 6


@pytest.mark.slow
def test_a_turned_gear_overlaps_by_its_base_radius_times_the_angle() -> None:
    for turned in (0.01, -0.01):
        report = involute_pair(turned=turned).report(97)
        assert report.overlap_depth == pytest.approx(0.01 * 30 * np.cos(ALPHA), rel=5e-3)


@pytest.mark.slow
def test_too_near_overlaps_and_too_far_leaves_a_gap() -> None:
    near, far = involute_pair(54.9).report(97), involute_pair(55.5).report(97)
    assert near.overlap_depth == pytest.approx(0.1 * np.sin(ALPHA), rel=0.02)
    assert far.overlap_area.max() == 0
    at_work = np.arccos(55 * np.cos(ALPHA) / 55.5)
    assert far.gap == pytest.approx(55 * np.cos(ALPHA) * (involute(at_work) - involute(ALPHA)), rel=2e-3)


@pytest.mark.slow
def test_driven_play_of_a_spread_pair() -> None:
    pair = involute_pair(55.1)
    at_work = np.arccos(55 * np.cos(ALPHA) / 55.1)
    expected = 2 * 55 / 30 * (involute(at_work) - involute(ALPHA))
    for row in (0, 7, 1001):
        minus, plus = pair.driven_play(row, tolerance=1e-6)
        assert minus + plus == pytest.approx(expected, rel=5e-3)
        assert minus == pytest.approx(plus, rel=0.01)


@pytest.mark.slow
def test_driven_play_is_negative_beyond_a_side() -> None:
    pair = involute_pair(55.1, turned=-0.003)  # clockwise: the driven gear is 3 mrad ahead
    minus, plus = pair.driven_play(7, tolerance=1e-6)
    assert minus + plus == pytest.approx(0.00245, rel=0.01)
    assert plus == pytest.approx(0.00245 / 2 - 0.003, abs=2e-5)


@pytest.mark.thorough
def test_width_of_known_regions() -> None:
    assert meshing.width(shapely.box(0, 0, 5, 1e-3)) == pytest.approx(1e-3, rel=0.02)
    low, high = np.linspace(0, 3, 50), np.linspace(3, 0, 50)
    lens = Polygon(np.column_stack([np.append(low, high), np.append(0 * low, 1e-4 * high * (3 - high))]))
    assert meshing.width(affinity.rotate(lens, 33)) == pytest.approx(2.25e-4, rel=0.02)
    corner = affinity.translate(shapely.box(0, 0, 5, 1e-3).union(shapely.box(0, 0, 1e-3, 5)), 7, 7)
    assert meshing.width(corner) == pytest.approx(4e-3 - 2e-3 * 2**0.5, rel=0.08)
    assert meshing.width(shapely.Point(0, 0).buffer(2)) == pytest.approx(4, rel=0.02)


@pytest.mark.slow
def test_written_files_are_read_back(tmp_path: Path) -> None:
    gears = involute_gear(25), involute_gear(30, np.pi + np.pi / 30)
    paths = tmp_path / "driving.stl", tmp_path / "driven.stl"
    for gear, path in zip(gears, paths, strict=True):
        bored = gear.difference(shapely.Point(0, 0).buffer(8))
        trimesh.creation.extrude_polygon(bored, 20.0).export(path)
    law = np.column_stack([PHI1, PHI1 * 25 / 30, np.full_like(PHI1, 1.2)])
    np.savetxt(tmp_path / "law.csv", law, delimiter=",", header="phi1_rad,phi2_rad,ratio", comments="", fmt="%.17g")
    pair = meshing.read_pair(*paths, tmp_path / "law.csv", 55.0)
    assert rack_cut.outline_distance(pair.driving, gears[0]) < 1e-5
    assert len(pair.driving.interiors) == 0
    assert pair.report(97).overlap_depth.max() < 1e-5


@pytest.mark.slow
def test_a_cut_pair_meshes() -> None:
    driving = rack_cut.cut(circle_curve(25.0), TOOTH, 25, True)
    driven = affinity.rotate(rack_cut.cut(circle_curve(30.0), TOOTH, 30, False), 180, (0, 0))
    report = meshing.Pair(driving, driven, PHI1, PHI1 * 25 / 30, 55.0).report(41)
    assert report.overlap_depth.max() < 4e-5  # scallops stand proud of the involute
    assert report.gap.max() < 4e-5
