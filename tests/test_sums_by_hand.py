"""Sums over sections, plies of chords and colours that no test had judged by themselves: against closed forms."""

from __future__ import annotations

from itertools import pairwise
from math import cos, pi, radians, sin
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
import shapely
from matplotlib.figure import Figure
from numpy.polynomial import Polynomial
from scipy.stats import truncnorm

import ncgear.drawings.scene.standing as standing
import ncgear.strength.estimate as estimate
from at_once import at_once
from ncgear.drawings.animation import moving_picture
from ncgear.drawings.solid_pair import linear_light
from ncgear.project.moving import _polygon_mm4
from ncgear.solids.helical.even_tips import HIGH, RISE, _low_sides, _rising
from ncgear.solids.mesh.pair import _strips
from ncgear.solids.mesh.slabs import _level_lines
from ncgear.solids.plan.areas import floored, largest_fitting, raised
from ncgear.solids.plan.plan import quarter_chords
from ncgear.solids.plan.room import (
    DIAMETER_IN_MODULES,
    INNER_WALL_IN_MODULES,
    OUTER_WALL_IN_MODULES,
    _hole_on_ray,
)
from ncgear.strength.elements.plane import lame_mpa
from ncgear.strength.face_load import _hats, _mean_line
from ncgear.strength.iso6336 import notch_factor
from ncgear.strength.loading import _beside_more
from ncgear.tolerances.assemblies import Follower
from ncgear.tolerances.drawn import BEYOND, COUNT, SIGMAS, DeviationLimits, _within_limit, deviating, rows_of
from ncgear.tolerances.estimate import _tightest
from ncgear.tolerances.iso1328 import DIAMETERS_MM, tooth_diameters_mm

Made: Any = SimpleNamespace


# --- strength


@pytest.mark.judges("strength")
@at_once("slender", [1.0, 0.9])
def test_a_tooth_of_even_width_bends_as_a_short_beam(slender: float, monkeypatch: pytest.MonkeyPatch) -> None:
    """Timoshenko's energy of a plate of width 5 mm in closed form, and Weber's foundation; the load leans by 15 deg."""
    wide, high, aside, poisson, youngs = 5.0, 4.0, 2.5, 0.3, 206e3
    across, down = cos(radians(15.0)), sin(radians(15.0))
    load = Made(
        tooth=np.array([0]),
        aside_mm=np.array([aside]),
        height_mm=np.array([1.5 + high]),
        across=np.array([across]),
        down=np.array([down]),
    )
    monkeypatch.setattr(estimate, "_loads", lambda frames, places: load)
    halves = Made(low_mm=np.array([1.5, 0.7]), at=lambda flank, height: np.full(np.shape(height), wide / 2.0))
    places: Any = Made(flank=np.array([0]))
    frames: Any = Made(slender=slender)
    tooth, foundation, depth = estimate._of_body.__wrapped__(frames, halves, youngs, poisson, places)
    plate, shear = youngs / (1.0 - poisson**2), youngs / 2.6
    # The moment is across * y - down * aside at y below the load.
    moments = (across**2 * high**3 / 3.0 - across * down * aside * high**2 + (down * aside) ** 2 * high) / wide**3
    energy = 12.0 / plate * moments + down**2 * high / (plate * wide) + 1.2 / shear * across**2 * high / wide
    assert tooth == pytest.approx([energy / slender])
    lever = (across * high - down * aside) / across / wide
    weber = 18.0 / pi * lever**2 + 2.0 * (1.0 - 2.0 * poisson) / (1.0 - poisson) * lever
    weber += 4.8 / pi * (1.0 + (1.0 - poisson) / 2.4 * (down / across) ** 2)
    assert foundation == pytest.approx([across**2 * weber / (plate * slender)])
    assert depth == pytest.approx([wide / 2.0 / across])


@pytest.mark.judges("strength")
def test_a_tooth_that_leans_has_its_middle_line_off_the_load() -> None:
    """A width of 3 mm to one side and 1 mm to the other: the middle is 1 mm towards the loaded flank."""
    load = Made(tooth=np.array([0]), aside_mm=np.array([3.0]), height_mm=np.array([2.0]))
    load.across, load.down = np.array([0.0]), np.array([1.0])
    sides = {0: 3.0, 1: 1.0}
    halves = Made(
        low_mm=np.array([0.0, -1.0]),
        at=lambda flank, height: np.broadcast_to([sides[int(one)] for one in flank], np.shape(height)).astype(float),
    )
    frames: Any = Made(slender=1.0)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(estimate, "_loads", lambda frames, places: load)
        tooth, foundation, depth = estimate._of_body.__wrapped__(frames, halves, 1.0, 0.0, Made(flank=np.array([0])))
    # Moment 2 N mm along 2 mm and the force itself, over a width of 4 mm.
    assert tooth == pytest.approx([12.0 * 4.0 * 2.0 / 4.0**3 + 2.0 / 4.0])
    assert foundation == pytest.approx([18.0 / pi / 4.0 + 2.0 / pi])
    assert depth == pytest.approx([2.0 / estimate.LEAST_ACROSS])


@pytest.mark.judges("strength")
def test_lames_constants_give_the_bulk_modulus_and_no_stress_across_a_bar() -> None:
    volume, shear = lame_mpa(Made(youngs_modulus_mpa=206e3, poisson=0.3))
    assert volume + 2.0 * shear / 3.0 == pytest.approx(206e3 / (3.0 * (1.0 - 0.6)))
    assert shear * (3.0 * volume + 2.0 * shear) / (volume + shear) == pytest.approx(206e3)


@pytest.mark.judges("strength")
@at_once(("slenderness", "sharpness", "wanted"), [(1.8, 1.0, 1.434), (2.3, 4.0, 2.80690), (1.0, 8.0, 2.40515)])
def test_the_notch_factor_is_that_of_iso_6336_3(slenderness: float, sharpness: float, wanted: float) -> None:
    """1.499 times 4^(1/2.21) at L = 2.3, and 1.33 times 8^(1/3.51) at L = 1."""
    assert notch_factor(slenderness, sharpness) == pytest.approx(wanted, abs=1e-5)


@pytest.mark.judges("strength")
def test_products_of_hats_are_integrated_over_what_presses() -> None:
    """Two parts of 1.5 mm of which the shares 0.2 to 1 and 0 to 0.6 press: by Gauss' points of each."""
    active, part = np.array([[[0.2, 1.0], [0.0, 0.6]]]), 1.5
    (own,), (beside,) = _hats(active, np.array([[part, part]]))
    nodes, weights = np.polynomial.legendre.leggauss(4)
    wanted = np.zeros((3, 3))
    for number, (begin, end) in enumerate(active[0]):
        share = begin + (end - begin) * (nodes + 1.0) / 2.0
        hats = np.zeros((3, 4))
        hats[number], hats[number + 1] = 1.0 - share, share
        wanted += part * (end - begin) / 2.0 * (hats * weights) @ hats.T
    assert np.diag(own) + np.diag(beside, 1) + np.diag(beside, -1) == pytest.approx(wanted)


@pytest.mark.judges("strength")
def test_the_line_of_least_squares_leaves_what_is_across_all_lines() -> None:
    at = np.array([-6.0, -4.0, -1.0, 2.0, 3.0, 6.0])
    line = _mean_line(at)
    assert line @ (2.0 - 0.3 * at) == pytest.approx(2.0 - 0.3 * at)
    form = np.array([0.0, 1.0, -0.5, 2.0, 0.3, 1.0])
    rest = form - line @ form
    for power in (0, 1):
        # Exact for products of pieces of lines: Simpson's rule.
        middle = [
            (one + two) / 2.0 * ((a + b) / 2.0) ** power
            for (one, two), (a, b) in zip(pairwise(rest), pairwise(at), strict=True)
        ]
        ends = rest * at**power
        total = np.diff(at) @ (ends[:-1] + 4.0 * np.array(middle) + ends[1:]) / 6.0
        assert total == pytest.approx(0.0, abs=1e-12)


@pytest.mark.judges("strength")
def test_roots_are_stressed_most_beside_positions_of_more_pairs() -> None:
    loaded = np.array([[1, 1], [0, 1], [0, 1], [1, 0], [1, 1], [0, 0]], dtype=bool)
    assert _beside_more(np.array([0.0, 1.0, 2.0, 3.0, 4.0, 5.0]), loaded).tolist() == [1, 3]
    # In the order of rolled lengths.
    turned = np.array([5, 4, 3, 2, 1, 0])
    assert sorted(_beside_more(np.array([5.0, 4.0, 3.0, 2.0, 1.0, 0.0]), loaded[turned]).tolist()) == [2, 4]


# --- tolerances


@pytest.mark.judges("tolerances")
def test_drawn_deviations_are_normal_within_their_limit() -> None:
    share = np.array([0.0, 0.01, 0.3, 0.5, 0.8, 1.0])
    assert _within_limit(share) == pytest.approx(truncnorm.ppf(share, -SIGMAS, SIGMAS) / SIGMAS, abs=1e-12)
    assert _within_limit(share)[[0, 3, 5]] == pytest.approx([-1.0, 0.0, 1.0])


@pytest.mark.judges("tolerances")
def test_deviations_are_drawn_within_their_limits_from_even_numbers() -> None:
    """Three assemblies: all numbers 1/2, a largest eccentricity at 60 deg, and the ends of temperatures and wear."""
    pair = np.full((COUNT, 3), 0.5)
    pair[rows_of("eccentricity_driving"), 1] = [1.0, 1.0 / 6.0]
    pair[rows_of("tilt_driven"), 1] = [1.0, 0.25]
    pair[rows_of("center_distance"), 2] = 1.0
    pair[rows_of("temperature"), 1:] = [[0.0, 1.0]]
    pair[rows_of("wear"), 1:] = [[0.0, 1.0]]
    pair[rows_of("index_driven"), 2] = 0.0
    pitch, profile = np.array([0.01, 0.02]), np.array([0.004, 0.006])
    limits = DeviationLimits(
        0.05,
        (0.03, 0.02),
        (1e-3, 2e-3),
        (4e-4, 5e-4),
        pitch,
        profile,
        (-10.0, 50.0),
        30.0,
        (1e-5, 2e-5, 3e-5),
        (0.1, 0.2),
    )
    teeth = np.array([[[1.0, 0.5, -1.0], [0.0, 1.0, 0.2]], [[-1.0, 0.0, 0.5], [1.0, 0.1, -0.3]]])
    found = deviating(limits, pair, teeth)
    assert found.rigid[0] == pytest.approx([0.0, 0.0, 0.05])
    # The radius at which half of a Rayleigh distribution is left that ends at its limit.
    middle = 0.03 * np.sqrt(np.log(1.0 - 0.5 * (1.0 - BEYOND)) / np.log(BEYOND))
    assert found.rigid[1, :2] == pytest.approx([-middle, 0.03 / 2.0])
    assert found.rigid[2, :2] == pytest.approx([0.0, 0.03 * 3.0**0.5 / 2.0])
    assert np.hypot(*found.rigid[3:5]) == pytest.approx(np.full(3, middle * 2.0 / 3.0))
    assert found.tilt[2:, 1] == pytest.approx([0.0, 2e-3])
    # The housing is 0, -30 and 30 degrees Celsius warmer than it was made, and gears are warmer by 30 degrees.
    assert found.rigid[5] == pytest.approx(1e-5 * np.array([30.0, 0.0, 60.0]))
    assert found.rigid[7] == pytest.approx(3e-5 * np.array([0.0, -30.0, 30.0]))
    assert found.rigid[6] == pytest.approx(2.0 * found.rigid[5])
    assert found.rigid[8] == pytest.approx([0.0, 0.0, 0.0])
    assert found.rigid[9:, 1:] == pytest.approx(np.array([[0.0, 0.1], [0.0, 0.2]]))
    assert found.pitch == pytest.approx(np.array([[0.01, 0.005, -0.01], [0.0, 0.02, 0.004]]) / 2.0**0.5)
    assert found.profile == pytest.approx(np.array([[-0.004, 0.0, 0.002], [0.006, 0.0006, -0.0018]]))
    assert found.output_rad == pytest.approx([0.0, 0.0, -5e-4])


@pytest.mark.judges("tolerances")
def test_the_output_is_accelerated_by_an_error_as_the_composed_motion() -> None:
    """x(p(t) + e(t)) of polynomials at t = 0, differentiated whole; the square of e = 1e-5 is left out."""
    turned, error = Polynomial([0.4, 1.3, -0.35]), Polynomial([1e-5, 0.02, 0.05])
    way = Polynomial([1.0, 2.0, -0.7, 0.9])
    whole = way(turned + error).deriv(2)(0.0)
    output = [[way.deriv(order)(0.4)] for order in (1, 2, 3)]
    follower: Any = Made(driven=np.array([[1.3], [-0.7]]), output=np.array(output))
    given = np.array([1e-5, 0.02, 0.1])[:, None, None]
    assert Follower._seconds(follower, given) == pytest.approx(whole, abs=1e-8)
    assert abs(Follower._seconds(follower, 0.0 * given)[0, 0] - whole) > 0.1


@pytest.mark.judges("tolerances")
def test_the_tightest_position_of_each_stretch() -> None:
    assert _tightest(np.array([1, 5, 2, 7, 7, 0, 3]), 3).tolist() == [1, 3, 6]


@pytest.mark.judges("tolerances")
def test_diameters_of_teeth_are_those_of_curvature_up_to_the_tip() -> None:
    curvature = np.array([0.05, 0.2, 0.0, -0.1, 1.0])
    position = np.array([[30.0, 40.0], [3.0, 4.0], [6.0, 8.0], [0.0, 1.0], [300.0, 0.0]])
    made = np.array([True, True, True, True, False])
    gear: Any = Made(flanks=Made(crossings=Made(curvature=curvature, position=position), is_made=made))
    assert tooth_diameters_mm(gear) == pytest.approx([40.0, 10.0, 100.0, 100.0, DIAMETERS_MM[0]])


# --- solids


@pytest.mark.judges("solids")
def test_strips_of_a_convex_ring_have_its_area() -> None:
    ring = np.array([[4.0, -3.0], [5.0, 1.0], [1.0, 3.0], [-4.0, 2.0], [-3.0, -3.0]])
    strips = list(_strips(ring))
    assert sum(weight for _, _, weight in strips) == pytest.approx(6.0)
    area = sum(weight * (high - low) for low, high, weight in strips)
    assert area == pytest.approx(shapely.Polygon(ring).area)
    # The area's first moment across: x dx over each strip.
    moment = sum(weight * (high**2 - low**2) / 2.0 for low, high, weight in strips)
    assert moment == pytest.approx(area * shapely.Polygon(ring).centroid.x)


@pytest.mark.judges("solids")
def test_sizes_are_rounded_to_what_fits() -> None:
    assert [floored(one) for one in (12.3456, 1.239, 0.5678, 0.01234, 0.0)] == [12.34, 1.23, 0.56, 0.012, 0.0]
    assert [raised(one) for one in (12.3412, 0.001)] == [12.35, 0.01]
    assert largest_fitting(lambda size: size <= 7.3, 0.0, 20.0) == pytest.approx(7.3, rel=3e-4)
    assert largest_fitting(lambda size: size <= 7.3, 0.0, 20.0) <= 7.3
    assert largest_fitting(lambda size: False, 1.0, 20.0) == 0.0


@pytest.mark.judges("solids")
@at_once("radius_mm", [1.0, 5.0, 40.0])
def test_chords_of_a_quarter_keep_a_quarter_of_the_tolerance(radius_mm: float) -> None:
    """The sagitta of a chord over half its angle a is r (1 - cos a)."""
    count = quarter_chords(radius_mm, 0.01)
    assert radius_mm * (1.0 - cos(pi / 4.0 / count)) <= 0.01 / 4.0
    assert radius_mm * (1.0 - cos(pi / 4.0 / (count - 1))) > 0.01 / 4.0
    assert quarter_chords(radius_mm, 100.0 * radius_mm) == 2


@pytest.mark.judges("solids")
def test_a_hole_on_a_ray_keeps_its_walls() -> None:
    """In a disc of 50 mm about a hub of 10 mm, with module 4, as far out and as far in as its walls allow."""
    disc, hub = shapely.Point(0.0, 0.0).buffer(50.0, quad_segs=256), shapely.Point(0.0, 0.0).buffer(10.0, quad_segs=256)
    wide = DIAMETER_IN_MODULES * 4.0
    for chosen, wanted in (
        (np.argmax, 50.0 - wide / 2.0 - OUTER_WALL_IN_MODULES * 4.0),
        (np.argmin, 10.0 + wide / 2.0 + INNER_WALL_IN_MODULES * 4.0),
    ):
        hole = _hole_on_ray(disc, 0.7, 4.0, disc.exterior, hub, chosen)
        assert hole is not None
        assert (hole.x_mm, hole.y_mm) == pytest.approx((wanted * cos(0.7), wanted * sin(0.7)), abs=0.05)
        assert hole.diameter_mm == pytest.approx(wide)


@pytest.mark.judges("solids")
def test_a_tetrahedron_is_cut_in_a_triangle() -> None:
    """At a quarter of its height the section of a corner of a cube of 4 mm has three quarters of its legs."""
    o, x, y, z = np.zeros(3), np.array([4.0, 0, 0]), np.array([0, 4.0, 0]), np.array([0, 0, 4.0])
    lines = _level_lines(np.array([[o, y, x], [o, x, z], [x, y, z], [y, o, z]]), 1.0)
    assert lines.shape == (3, 2, 2)
    lengths = sorted(np.hypot(*(lines[:, 1] - lines[:, 0]).T).tolist())
    assert lengths == pytest.approx([3.0, 3.0, 3.0 * 2.0**0.5])
    assert {tuple(np.round(point, 9)) for point in lines.reshape(-1, 2)} == {(0.0, 0.0), (3.0, 0.0), (0.0, 3.0)}


@pytest.mark.judges("solids")
def test_heights_rise_no_more_steeply_than_ceilings_do() -> None:
    """From a place of height 1 the ceiling rises to both sides, and round the end."""
    at, low = np.arange(10.0), np.full(10, 9.0)
    low[2] = 1.0
    away = np.array([2, 1, 0, 1, 2, 3, 4, 5, 4, 3])
    assert _rising(at, low, 10.0) == pytest.approx(np.minimum(1.0 + RISE * away, 9.0))


@pytest.mark.judges("solids")
def test_jumps_of_heights_leave_their_lower_side() -> None:
    """Heights fall by 0.01 a step, and once by 2 mm: the lower side less the fall beside it."""
    height = 5.0 - 0.01 * np.arange(8.0)
    height[4:] -= 2.0
    fitted = np.array([True] * 7 + [False])
    found = _low_sides(height, np.ones(8), fitted, 2.0)
    assert found[3] == pytest.approx(height[4] - 0.01)
    assert np.delete(found, 3) == pytest.approx(np.full(7, 2.0 * HIGH))


# --- drawings and projects


@pytest.mark.judges("drawings")
@at_once(("color", "light"), [("#000000", 0.0), ("#ffffff", 1.0), ("#0a0a0a", 10 / 255 / 12.92), ("#bcbcbc", 0.5029)])
def test_light_of_a_screens_colour(color: str, light: float) -> None:
    """Half the light is the number 188 of sRGB."""
    assert linear_light(color) == pytest.approx([light] * 3, abs=2e-4)
    assert linear_light("#ff0000") == pytest.approx([1.0, 0.0, 0.0])


@pytest.mark.judges("drawings")
def test_a_box_has_room_around_all_points() -> None:
    box = standing._box_around(np.array([[1.0, 2.0], [11.0, 5.0], [4.0, -3.0]]))
    slack = 10.0 * standing.SLACK
    assert box == pytest.approx((1.0 - slack, -3.0 - slack, 10.0 + 2.0 * slack, 8.0 + 2.0 * slack))


@pytest.mark.judges("drawings")
def test_straws_lie_in_the_material() -> None:
    strokes = standing.straws()
    assert strokes.shape == (standing.STRAWS, 2, 2)
    assert np.all((strokes >= [0.0, -0.5]) & (strokes <= [1.0, 0.5]))
    along, across = (strokes[:, 1] - strokes[:, 0]).T / (2.0 * standing.HALF_STRAW[:, None])
    inner = np.all((strokes > [0.0, -0.5]) & (strokes < [1.0, 0.5]), axis=(1, 2))
    assert 0.5 * standing.STRAWS < inner.sum() < standing.STRAWS
    assert np.hypot(along, across)[inner] == pytest.approx(1.0)
    middle = strokes.mean(axis=1)[inner]
    # They are spread over the whole material.
    counted, _, _ = np.histogram2d(*middle.T, bins=3, range=[[0.0, 1.0], [-0.5, 0.5]])
    assert counted.min() > 5


@pytest.mark.judges("drawings")
def test_panels_stand_side_by_side_in_the_ratio_of_their_shapes() -> None:
    made = Figure(figsize=(moving_picture.WIDTH_IN, 6.0))
    panels = moving_picture._panels(made, [1.0, 2.5, 0.5], 3.0)
    boxes = [panel.get_position() for panel in panels]
    widths, wide = np.array([box.width for box in boxes]), moving_picture.WIDTH_IN
    assert widths / widths[0] == pytest.approx([1.0, 2.5, 0.5])
    edges = [0.0, *(edge for box in boxes for edge in (box.x0, box.x1)), 1.0]
    assert np.diff(edges)[::2] * wide == pytest.approx(np.full(4, moving_picture.GAP_IN))
    for box in boxes:
        assert box.height * 6.0 == pytest.approx(3.0)
        assert (1.0 - box.y1) * 6.0 == pytest.approx(moving_picture.HEADING_IN)


@pytest.mark.judges("drawings")
def test_a_figure_has_even_pixels_and_room_for_all_parts() -> None:
    made = moving_picture._figure(3.0, 801, "title")
    width, height = (made.get_size_inches() * made.dpi).tolist()
    assert (width, height % 2.0) == (pytest.approx(800.0), pytest.approx(0.0, abs=1e-6))
    parts = ("HEADING_IN", "BELOW_IN", "CHART_IN", "FOOT_IN")
    needed = 3.0 + sum(getattr(moving_picture, part) for part in parts)
    assert made.get_figheight() == pytest.approx(needed, abs=2.0 / made.dpi)


@pytest.mark.judges("drawings")
def test_a_chambers_opening_is_where_links_pass_its_start(monkeypatch: pytest.MonkeyPatch) -> None:
    asked = list[float]()
    monkeypatch.setattr(standing, "crossings", lambda moved, x: (asked.append(x), np.array(moved))[1])
    linkage = Made(crank_mm=50.0, stroke_mm=100.0, offset_mm=4.0)
    chamber: Any = Made(linkage=linkage, start_mm=70.0)
    gap = standing.WALL_GAP * 50.0
    scene: Any = Made(swept_mm={"rod": [-12.0, 9.0], "crank": [2.0]})
    assert standing._opening_mm(scene, chamber) == pytest.approx((-12.0 - gap, 9.0 + gap))
    assert asked == pytest.approx([70.0 - 1e-4] * 2, abs=1e-6)
    scene.swept_mm = {"rod": []}
    assert standing._opening_mm(scene, chamber) == pytest.approx((4.0 - gap, 4.0 + gap))


@pytest.mark.judges("project")
def test_the_polar_moment_of_a_rectangle_away_from_the_origin() -> None:
    """8 by 6 mm about (5, -2), in either sense: 48 ((8^2 + 6^2) / 12 + 5^2 + 2^2)."""
    ring = np.array([[1.0, -5.0], [9.0, -5.0], [9.0, 1.0], [1.0, 1.0]])
    wanted = 48.0 * (100.0 / 12.0 + 29.0)
    assert _polygon_mm4(ring) == pytest.approx(wanted)
    assert _polygon_mm4(ring[::-1]) == pytest.approx(wanted)
