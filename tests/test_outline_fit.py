"""The nearest pair to an outline, judged by shapely, closed forms and differences, and what is refused."""

from __future__ import annotations

import json
from dataclasses import replace
from math import pi, radians, tau
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import shapely
from shapely import affinity

import ncgear
from at_once import at_once
from commands import Run
from ncgear.errors import NoSuchMechanism, WrongInput
from ncgear.numerics.arrays import Array
from ncgear.optimum.outline.conditions import CurveLimits, conditions
from ncgear.optimum.outline.nearest import best_phases, deviation, nearest_curve
from ncgear.optimum.outline.outline import axes_to_try, outline_of
from ncgear.optimum.outline.programme import OutlineAim
from ncgear.optimum.outline.rolled import MatePlace, Rolled, SplineBasis, closing_distance_mm, rays
from ncgear.project.drive import Drive
from ncgear.project.outline_fit import OutlineFit
from ncgear.project.outline_trial import Made, between, control_points

GEARS = "driving", "driven"

TURN = np.linspace(0.0, tau, 400, endpoint=False)


def ellipse(semi_major: float, semi_minor: float) -> Array:
    return np.column_stack([semi_major * np.cos(TURN), semi_minor * np.sin(TURN)])


def heart() -> Array:
    """The usual heart of sines and cosines, 64 mm wide."""
    x, y = 16.0 * np.sin(TURN) ** 3, sum(c * np.cos((k + 1) * TURN) for k, c in enumerate((13.0, -5.0, -2.0, -1.0)))
    return 2.0 * np.column_stack([x, y])


def square(side: float = 64.0) -> Array:
    half = side / 2.0
    return np.array([[-half, -half], [half, -half], [half, half], [-half, half]])


def rolled(radius_of: Any, count: int = 96, teeth: int = 48) -> Rolled:
    """The curve through radii of a function of the polar angle."""
    basis = SplineBasis(count)
    coefficients = basis.through(radius_of(tau * np.arange(count) / count))
    curve = Rolled(basis, coefficients, np.zeros(2), 1.0, teeth)
    return replace(curve, center_distance_mm=closing_distance_mm(curve.radius[0]))


def by_shapely(outline: Array, curve: Array, count: int = 2000) -> tuple[float, float]:
    """Root of the mean square over both, and the greatest distance, between outline and curve."""
    rings = shapely.LinearRing(outline), shapely.LinearRing(curve)
    square, greatest = 0.0, 0.0
    for one, other in (rings, rings[::-1]):
        points = shapely.line_interpolate_point(one, (np.arange(count) + 0.5) / count, normalized=True)
        away = shapely.distance(points, other)
        corners = shapely.distance(shapely.points(shapely.get_coordinates(one)), other)
        square, greatest = square + float(np.mean(away**2)) / 2.0, max(greatest, float(max(away.max(), corners.max())))
    return float(np.sqrt(square)), greatest


@pytest.mark.judges("optimum")
def test_an_ellipse_about_its_focus_rolls_on_its_equal() -> None:
    """The mate of an ellipse about its focus is that ellipse, at a distance of its major axis (Litvin, chapter 4)."""
    semi, eccentricity = 30.0, 0.4
    latus = semi * (1.0 - eccentricity**2)
    curve = rolled(lambda phi: latus / (1.0 + eccentricity * np.cos(phi)))
    assert curve.center_distance_mm == pytest.approx(2.0 * semi, rel=1e-9)
    # Curvature of an ellipse by the distances from its foci: a b / (r1 r2)^(3/2).
    r1 = curve.radius[0]
    r2 = 2.0 * semi - r1
    expected = semi * semi * np.sqrt(1.0 - eccentricity**2) / (r1 * r2) ** 1.5
    for curvature in curve.curvature:
        assert curvature == pytest.approx(expected, rel=1e-5)


def test_slopes_of_the_conditions_are_those_of_differences() -> None:
    curve = rolled(lambda phi: 30.0 + 4.0 * np.cos(phi) + 1.5 * np.sin(3.0 * phi), 48)
    limits = CurveLimits(share=np.linspace(0.8, 1.1, curve.arc_mm.size))
    way, step = np.cos(np.arange(48) ** 2), 1e-5
    ends = [
        replace(
            curve,
            coefficients=curve.coefficients + sign * step * way,
            center_distance_mm=curve.center_distance_mm + sign * step * 0.7,
        )
        for sign in (1.0, -1.0)
    ]
    by_module = (ends[0].module_mm - ends[1].module_mm) / (2.0 * step)
    for one, after, before in zip(*(list(conditions(each, limits)) for each in (curve, *ends)), strict=True):
        if one.kind.value.startswith(("hollow_corner", "corner")):
            rows, by_distance, slope = one.slopes()
            told = rows @ way + 0.7 * by_distance + by_module * slope
            assert told == pytest.approx((after.value - before.value) / (2.0 * step), abs=1e-8)


def test_slopes_of_means_over_stretches_are_those_of_differences_on_a_circle() -> None:
    """There the mean of what is alike all round does not change with its weights."""
    curve, limits = rolled(lambda phi: np.full_like(phi, 30.0), 48), CurveLimits(share=0.8)
    way, step = np.ones(48), 1e-5
    ends = [replace(curve, coefficients=curve.coefficients + sign * step * way) for sign in (1.0, -1.0)]
    by_module = (ends[0].module_mm - ends[1].module_mm) / (2.0 * step)
    for one, after, before in zip(*(list(conditions(each, limits)) for each in (curve, *ends)), strict=True):
        if one.kind.value in ("hollow_own", "hollow_mate"):
            rows, _, slope = one.slopes()
            assert rows @ way + by_module * slope == pytest.approx(
                (after.value - before.value) / (2.0 * step), abs=1e-7
            )


def test_distances_are_those_of_shapely() -> None:
    """Of a square and a circle about its middle, by another program."""
    curve = rolled(lambda phi: 33.0 + 2.0 * np.cos(4.0 * phi))
    found = deviation(outline_of(square(), ""), curve)
    root, greatest = by_shapely(square(), curve.points()[0])
    assert found.root_mean_square_mm == pytest.approx(root, rel=1e-3)
    assert found.greatest_mm == pytest.approx(greatest, rel=1e-3)
    assert shapely.LinearRing(square()).distance(shapely.Point(found.at_mm)) < 1e-9
    ring = shapely.LinearRing(curve.points()[0])
    assert ring.distance(shapely.Point(found.at_mm)) == pytest.approx(found.greatest_mm, rel=1e-6)


HOOK = np.array([[0, 0], [60, 0], [60, 40], [20, 40], [20, 30], [50, 30], [50, 10], [0, 10]], dtype=float)
"""An outline with an inlet: rays from its left end meet it more than once."""


def test_an_outline_that_crosses_itself_is_refused_with_the_place() -> None:
    star = 30.0 * np.exp(2j * tau * np.arange(5) / 5.0)
    with pytest.raises(WrongInput, match=r"crosses itself at \(-?\d"):
        outline_of(np.column_stack([star.real, star.imag]), "key")
    # Two squares that touch in a corner have an inside.
    touching = np.array([(0, 0), (1, 0), (1, 1), (2, 1), (2, 2), (1, 2), (1, 1), (0, 1)], dtype=float)
    assert outline_of(touching, "key").area_mm2 == pytest.approx(2.0)


def test_an_outline_with_loops_of_noise_is_its_outer_border() -> None:
    """A square with three loops of 0.3 by 0.2 mm outside its sides; loops that reach over a hundredth are refused."""

    def looped(size: float) -> Array:
        loop = size * np.array([[1.0, 0.0], [0.5, -0.7], [0.0, 0.1], [2.0, 0.1], [2.0, 0.0]])
        side, quarter = np.concatenate([[[-32.0, 0.0]], loop]), np.array([[0.0, 1.0], [-1.0, 0.0]])
        side[:, 1] -= 32.0
        return np.concatenate([*(side @ np.linalg.matrix_power(quarter, turn) for turn in range(3)), [[-32.0, 32.0]]])

    points = looped(0.3)
    found = outline_of(points, "points")
    border, drawn = shapely.LinearRing(found.corners), shapely.LinearRing(points)
    assert (drawn.is_simple, border.is_simple) == (False, True)
    assert shapely.Polygon(found.corners).symmetric_difference(shapely.Polygon(square())).area < 3 * 0.3 * 0.2
    assert found.area_mm2 > 0.0
    assert found.left_out_mm == pytest.approx(shapely.hausdorff_distance(drawn, border, densify=0.001), rel=0.1)
    for turned in (points[::-1], np.roll(points, 3, axis=0)):
        assert outline_of(turned, "points").area_mm2 == pytest.approx(found.area_mm2, rel=1e-12)
    with pytest.raises(WrongInput, match=r"crosses itself at .* in loops of up to"):
        outline_of(looped(9.0), "points")


@pytest.mark.filterwarnings("error")
@at_once("corners", [20, 48, 150, 240])
def test_corners_at_even_lengths_leave_no_chord_of_no_length(corners: int) -> None:
    """A point that is put beside a corner by a rounding error makes a chord that has no direction."""
    ring = 25.0 * np.exp(1j * (tau * np.arange(corners) / corners + 0.1))
    outline = outline_of(np.column_stack([ring.real, ring.imag]), "key")
    points = np.random.default_rng(3).normal(scale=20.0, size=(2000, 2))
    found, away = outline.nearest(points)
    expected = shapely.LinearRing(outline.corners).distance(shapely.points(points))
    assert away == pytest.approx(expected, abs=1e-6)
    assert np.hypot(*(points - found).T) == pytest.approx(expected, abs=1e-6)


def test_rays_go_to_the_farthest_hit_behind_an_inlet() -> None:
    outline, axis = outline_of(HOOK, ""), np.array([5.0, 5.0])
    hits = outline.farthest_hits(axis, 90)
    ring = shapely.LinearRing(HOOK)
    for number, hit in enumerate(hits):
        way = np.array([np.cos(tau * number / 90), np.sin(tau * number / 90)])
        met = shapely.LineString([axis, axis + 200.0 * way]).intersection(ring)
        far = max(np.hypot(*(np.array(place) - axis)) for place in shapely.get_coordinates(met))
        assert hit == pytest.approx(far, abs=1e-6)


def test_axes_to_try_are_inside() -> None:
    polygon = shapely.Polygon(HOOK)
    assert all(polygon.contains(shapely.Point(axis)) for axis in axes_to_try(outline_of(HOOK[::-1], ""), 8))


@pytest.mark.parametrize("points", [np.zeros((5, 2)), np.array([[0.0, 0.0], [1.0, 1.0], [2.0, 2.0]]), np.zeros(4)])
def test_no_outline_is_refused(points: Array) -> None:
    with pytest.raises(WrongInput, match=r"outline|shape"):
        ncgear.fit(points, teeth=40)


@at_once(
    ("options", "key"),
    [
        ({"teeth": 48, "axis_mm": (40.0, 0.0)}, "motion.points"),
        ({}, "gears"),
        ({"teeth": 48, "gears": {"mesh": "internal"}}, "gears.mesh"),
        ({"teeth": 48, "gears": {"lobes": {"driving": 2, "driven": 2}}}, "gears.lobes"),
    ],
)
def test_what_is_wrong_is_refused(options: dict[str, Any], key: str) -> None:
    with pytest.raises(WrongInput) as refused:
        ncgear.fit(ellipse(25.0, 22.0), **options)
    assert refused.value.key == key


def judged(found: OutlineFit, outline: Array) -> float:
    """The r.m.s. deviation, which another program finds too; the gears are made and close."""
    root, greatest = by_shapely(outline, found.points_mm)
    assert found.deviation.root_mean_square_mm == pytest.approx(root, rel=2e-3, abs=1e-4)
    assert found.deviation.greatest_mm == pytest.approx(greatest, rel=2e-3, abs=1e-3)
    assert found.drive.pitch.center_distance_mm == pytest.approx(found.curve.center_distance_mm, rel=1e-4)
    assert found.drive.designed_contact.longest_gap_pitches == 0.0
    # The drive's pitch curve is that of the fit.
    given = found.drive.pitch.driving.drawn(2000).position + found.curve.axis_mm
    assert by_shapely(given, found.points_mm, 500)[1] < 2e-3
    return root


@pytest.mark.slow
def test_an_ellipse_that_can_be_made_stays() -> None:
    found = ncgear.fit(ellipse(30.0, 20.0), teeth=48)
    assert judged(found, ellipse(30.0, 20.0)) < 1e-3
    assert found.bound_by == ()


@pytest.mark.tiers(slow=["heart"], rest="long")
@pytest.mark.parametrize(("outline", "most_mm"), [(heart(), 0.80), (square(), 0.29)], ids=["heart", "square"])
def test_outlines_with_corners_are_followed(outline: Array, most_mm: float) -> None:
    both = {"drives": "both_ways"}
    found = ncgear.fit(outline, teeth=64, gears=both)
    assert judged(found, outline) < most_mm
    assert np.array_equal(found.points_mm, ncgear.fit(outline, teeth=64, gears=both).points_mm)
    assert [size.root_mean_square_mm for size in found.next_sizes] == sorted(
        (size.root_mean_square_mm for size in found.next_sizes), reverse=True
    )


@pytest.mark.slow
@pytest.mark.long
def test_the_greatest_deviation_is_less_when_it_is_asked_for() -> None:
    usual, least = (ncgear.fit(square(), teeth=48, criterion=name) for name in ("root_mean_square", "greatest"))
    assert least.deviation.greatest_mm < usual.deviation.greatest_mm
    assert least.deviation.root_mean_square_mm > usual.deviation.root_mean_square_mm


@pytest.mark.slow
def test_the_axis_stays_and_the_module_is_kept() -> None:
    found = ncgear.fit(ellipse(30.0, 20.0), module_mm=1.0, axis_mm=(4.0, 0.0))
    assert found.curve.axis_mm.tolist() == pytest.approx([4.0, 0.0], abs=1e-6)
    assert found.curve.module_mm == pytest.approx(1.0, rel=1e-3)
    assert found.curve.length_mm == pytest.approx(pi * found.curve.teeth, rel=1e-3)


@pytest.mark.slow
@pytest.mark.long
def test_an_inlet_is_lost_and_told() -> None:
    """No ray may meet a pitch curve twice, so the inlet is filled; the greatest deviation is in it."""
    found = ncgear.fit(HOOK, teeth=72, gears={"drives": "both_ways"})
    assert found.deviation.greatest_mm > 5.0
    assert judged(found, HOOK) < 8.0


@pytest.mark.slow
@pytest.mark.parametrize("seed", [3, 5])
def test_of_axes_that_follow_a_noisy_ellipse_equally_the_gentle_curve_is_taken(seed: int) -> None:
    noise = np.random.default_rng(seed).normal(0.0, 0.04, (100, 2))
    outline = outline_of(ellipse(34.0, 27.0)[::4] + noise, "outline")
    found = nearest_curve(outline, 24, CurveLimits(), OutlineAim())
    radius, slope, _ = found.radius
    # About its centre, an ellipse runs at most asin((34^2 - 27^2) / (34^2 + 27^2)) = 13 degrees from circles.
    assert np.max(np.abs(np.arctan(slope / radius))) < np.radians(20.0)
    assert deviation(outline, found).root_mean_square_mm < 0.05


@pytest.mark.slow
def test_too_few_teeth_are_refused_by_name() -> None:
    """Seven teeth stand on no heart; what is refused is not a fault of ncgear."""
    with pytest.raises(NoSuchMechanism):
        ncgear.fit(heart(), teeth=7)


def fish() -> Array:
    """A fish with a tail, 60 mm long."""
    x = 30.0 * np.cos(TURN) - 6.0 * np.sin(TURN) ** 2
    y = (
        14.0 * np.sin(TURN)
        + 6.0 * np.exp(-(((TURN - pi + 0.5) / 0.2) ** 2))
        - 6.0 * np.exp(-(((TURN - pi - 0.5) / 0.2) ** 2))
    )
    return np.column_stack([x, y])


def follower(place: MatePlace) -> Rolled:
    """A curve whose mate stands in a drawing."""
    return replace(rolled(lambda phi: 30.0 + 3.0 * np.cos(phi) + 2.0 * np.sin(2.0 * phi), 64, 64), mate_place=place)


@pytest.mark.judges("optimum")
def test_the_mate_moves_in_its_drawing_as_differences_say() -> None:
    curve = follower(MatePlace(np.array([1.0, 2.0]), 0.3, 1.2))
    index = np.array([0, 5, 600, 975, 1530])
    way = rays(np.array([0.1, 1.2, 2.3, 3.4, 5.5]))[0]
    change, step = np.cos(np.arange(64) ** 2), 1e-5
    ends = []
    for sign in (step, -step):
        place = replace(curve.mate_place, turned_rad=0.3 + 0.02 * sign) if curve.mate_place else None
        coefficients, distance = curve.coefficients + sign * change, curve.center_distance_mm + 0.7 * sign
        moved = replace(curve, coefficients=coefficients, center_distance_mm=distance, mate_place=place)
        ends.append(moved.mate_in_drawing()[0][index])
    rows, by_distance, by_turn = curve.mate_rows(index, way)
    expected = np.sum((ends[0] - ends[1]) / (2.0 * step) * way, axis=1)
    assert rows @ change + 0.7 * by_distance + 0.02 * by_turn == pytest.approx(expected, abs=5e-3)


def test_the_mate_of_an_ellipse_about_its_focus_is_found_at_its_turn() -> None:
    """Two equal ellipses about their foci roll on each other, facing with opposite ends (Litvin, chapter 4)."""
    phi = tau * np.arange(720) / 720
    radius = 20.0 / (1.0 + 0.4 * np.cos(phi))
    start = best_phases([radius], [np.roll(radius, 60)], 0.5, False, 1)[0]
    assert start.scale == pytest.approx(1.0, rel=1e-4)
    assert start.radius_mm == pytest.approx(radius, rel=1e-3)
    # The mate faces the least radius with its greatest, which lies at 180 + 30 deg of its drawing.
    assert start.turned_rad % tau == pytest.approx(radians(210.0), abs=0.02)


@pytest.mark.long
@pytest.mark.slow
def test_both_gears_follow_an_outline() -> None:
    """Distances of both are those of shapely; either gear alone is nearer, and the weight moves them apart."""
    both = {"drives": "both_ways"}
    found = {
        weight: ncgear.fit(heart(), teeth=48, mate_mm=fish(), mate_weight=weight, gears=both) for weight in (0.25, 0.75)
    }
    for one in found.values():
        judged(one, heart())
        assert one.mate is not None
        root, greatest = by_shapely(one.mate.scale * fish(), one.mate.scale * one.mate.points_mm)
        assert one.mate.deviation.root_mean_square_mm == pytest.approx(root, rel=5e-3)
        assert one.mate.deviation.greatest_mm == pytest.approx(greatest, rel=5e-3)
        # The mate of the teeth has the curve that is told, turned and moved into its drawing.
        driven = shapely.LinearRing(one.drive.pitch.driven.drawn(2000).position)
        told = shapely.LinearRing(one.mate.scale * one.mate.points_mm)
        assert driven.length == pytest.approx(told.length, rel=1e-4)
        assert shapely.Polygon(driven).area == pytest.approx(shapely.Polygon(told).area, rel=1e-4)
    light, heavy = found[0.25], found[0.75]
    assert light.mate is not None
    assert heavy.mate is not None
    assert light.deviation.root_mean_square_mm < heavy.deviation.root_mean_square_mm
    assert heavy.mate.deviation.root_mean_square_mm < light.mate.deviation.root_mean_square_mm


@pytest.mark.slow
def test_the_command_follows_an_outline_of_the_mate(run: Run) -> None:
    table = "x_mm;y_mm\n" + "".join(f"{x:.4f};{y:.4f}\n" for x, y in fish())
    Path("fish.csv").write_text(table)
    mate = "{points: {file: fish.csv, tolerance_mm: 1}, size: fixed}"
    text = CORNERED.replace("{axis: fixed}", f"{{mate: {mate}}}")
    Path("two.yaml").write_text(text)
    told = json.loads(run("fit", "two.yaml", "--out", "out", "--json")[1])
    assert told["mate"]["outline"]["scale"] == pytest.approx(1.0, abs=1e-9)
    drive = ncgear.load("out/tile-fitted.yaml")
    assert drive.design.outline is None
    assert drive.designed_contact.contact_ratio == pytest.approx(told["pair"]["contact_ratio"], rel=1e-3)
    Path("two.yaml").write_text(
        text.replace("size: fixed", "axis: fixed, size: fixed").replace(
            "tolerance_mm: 1", "tolerance_mm: 1, axis_x_mm: 99"
        )
    )
    status, _, refused = run("fit", "two.yaml")
    assert (status, "two.yaml" in refused, "outline.mate.points" in refused, "outside" in refused) == (
        2,
        True,
        True,
        True,
    )


@pytest.mark.parametrize(
    ("mate", "said"),
    [
        ("{}", "one of"),
        ("{points: {phi_deg: [0, 60, 120, 180, 240, 300], radius_mm: [1, 1, 1, 1, 1, 1], tolerance_mm: 1}}", "polar"),
    ],
)
def test_an_outline_of_the_mate_is_drawn(mate: str, said: str) -> None:
    with pytest.raises(WrongInput, match=said) as refused:
        ncgear.loads(CORNERED.replace("{axis: fixed}", f"{{mate: {mate}}}"))
    assert "outline.mate" in str(refused.value)


CORNERED = """\
name: tile
operation: {speed_rpm: 30}
motion:
  law: pitch_curve
  # as drawn
  rounded_polygon: {sides: 4, side_mm: 60, corner_radius_mm: 0}
gears: {teeth: 48, face_width_mm: 8}
outline: {axis: fixed}
"""


def of_the_ellipse_about_its_focus(semi: float, eccentricity: float) -> Rolled:
    return rolled(lambda phi: semi * (1.0 - eccentricity**2) / (1.0 + eccentricity * np.cos(phi)), 48, 24)


def test_the_design_of_a_fitted_curve_draws_that_curve_and_its_mate() -> None:
    """Of an ellipse about its focus: its equal as mate, at a distance of its major axis."""
    curve = replace(of_the_ellipse_about_its_focus(30.0, 0.3), axis_mm=np.array([2.0, -1.0]))
    design = ncgear.loads(CORNERED).design
    points = control_points(curve)
    motion = type(design.motion)(**design.motion.along(points, curve.axis_mm))
    drive = Drive(design.model_copy(update={"motion": motion}))
    assert drive.pitch.center_distance_mm == pytest.approx(60.0, abs=1e-5)
    for pitch in (drive.pitch.driving, drive.pitch.driven):
        x, y = pitch.drawn(200).position.T
        assert np.hypot(x, y) + np.hypot(x + 18.0, y) == pytest.approx(60.0, abs=1e-4)


def test_a_fit_is_offered_for_what_it_takes() -> None:
    for lobes, mesh, fits in (("", "", True), ("2, driven: 2", "", False), ("1, driven: 2", ", mesh: internal", False)):
        more = f", lobes: {{driving: {lobes}}}" if lobes else ""
        text = CORNERED.replace("face_width_mm: 8", f"face_width_mm: 8{more}{mesh}")
        assert ncgear.loads(text).design.can_be_fitted is fits


def test_limits_between_two_pairs_are_half_way_where_contact_failed_and_the_wider_ones_elsewhere() -> None:
    circle = rolled(lambda phi: 30.0 + 0.0 * phi)
    drive = ncgear.loads(CORNERED)
    kept = Made(circle, CurveLimits(share=np.where(circle.phi_rad < 5.0, 0.8, 1.05)), drive, {})
    refused = replace(kept, limits=CurveLimits(), lacking=np.array([[30.0 * pi / 2.0, 0.2]]))
    share = np.interp([pi / 2.0, pi, 6.0], circle.phi_rad, between(kept, refused).share)
    assert share == pytest.approx([0.9, 1.0, 1.05], abs=5e-3)
    nowhere = replace(refused, lacking=np.empty((0, 2)))
    assert between(kept, nowhere).share == pytest.approx((np.asarray(kept.limits.share) + 1.0) / 2.0)


def turning(folder: Path) -> tuple[float, float]:
    """Greatest overlap in mm2 and greatest gap in mm of written outlines that turn by the written law."""
    driving, driven = (shapely.Polygon(np.loadtxt(folder / f"{n}.csv", delimiter=",", skiprows=1)) for n in GEARS)
    law = np.loadtxt(folder / "law.csv", delimiter=",", skiprows=1)[::83, :2]
    apart = json.loads((folder / "assembly.json").read_text())["center_distance_mm"]
    overlap, gap = 0.0, 0.0
    for phi1, phi2 in law:
        one = affinity.rotate(driving, phi1, origin=(0, 0), use_radians=True)
        other = affinity.translate(affinity.rotate(driven, -phi2, origin=(0, 0), use_radians=True), apart)
        overlap, gap = max(overlap, one.intersection(other).area), max(gap, one.distance(other))
    return overlap, gap


@pytest.mark.slow
def test_the_command_writes_a_design_that_builds(run: Run) -> None:
    Path("tile.yaml").write_text(CORNERED)
    assert "ncgear fit" in run("check", "tile.yaml")[1]
    status, _, refused = run("build", "tile.yaml")
    assert (status, "ncgear fit tile.yaml" in refused) == (3, True)
    told = json.loads(run("fit", "tile.yaml", "--out", "out", "--json")[1])
    drive = ncgear.load("out/tile-fitted.yaml")
    assert drive.pitch.center_distance_mm == pytest.approx(told["pair"]["center_distance_mm"], rel=1e-4)
    assert drive.designed_contact.contact_ratio == pytest.approx(told["pair"]["contact_ratio"], rel=1e-3)
    points = drive.pitch.driving.drawn(2000).position
    root, greatest = by_shapely(square(60.0), points)
    assert told["deviation"]["root_mean_square_mm"] == pytest.approx(root, rel=5e-3)
    assert told["deviation"]["greatest_mm"] == pytest.approx(greatest, rel=5e-3)
    assert Path("out/outline.png").read_bytes()[:4] == b"\x89PNG"
    assert run("build", "out/tile-fitted.yaml", "--format", "svg", "--out", "pair")[0] == 0
    overlap, gap = turning(Path("pair"))
    # Flanks that touch: chords with a tolerance of 0.5 um leave a gap of about that, and meet in slivers.
    assert overlap < 1e-5
    assert gap < 2e-3


def test_an_outline_needs_a_pitch_curve() -> None:
    with pytest.raises(WrongInput, match="draws no pitch curve"):
        ncgear.loads(
            "{name: x, operation: {speed_rpm: 30}, motion: {law: harmonic_ratio, cosine: [0.1]}, outline: {axis: free}}"
        )
