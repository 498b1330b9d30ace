"""Speed against error of teeth, contact and solids: errors and rates, and references that see what is wrong."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import mpmath
import numpy as np
import pytest
from shapely import Polygon
from trimesh import Trimesh

from ncgear.contact.placement import PER_TOOTH
from ncgear.pitch.shape import Gear
from ncgear.solids.mesh.pair import gear_solid
from ncgear.teeth.gear import toothed_pair
from speed_against_error import contact, outlines, solids
from speed_against_error.exact_gears import area_mm2
from speed_against_error.outlines import (
    MODULE_MM,
    TEETH,
    TOLERANCE_MM,
    circular_gear,
    circular_pair,
    elliptical_gear,
    elliptical_pair,
    even_outlines,
    form,
)
from speed_against_error.run import STUDIES
from speed_against_error.study import Point, Study, order, points

Array = np.ndarray
ROUNDING_MM = 1e-11
CIRCLE = circular_gear()
ELLIPSE = elliptical_gear()


@cache
def study(key: str) -> Study:
    return STUDIES[key]()


@cache
def found(key: str, method: str, *levels: float) -> tuple[Point, ...]:
    """Points of a method at a few of its levels, each run once."""
    chosen = study(key).method(method)
    assert set(levels) <= set(chosen.levels)
    return points(study(key), replace(chosen, levels=levels), timed_s=0.0)


def order_by_size(measured: tuple[Point, ...]) -> float:
    """Power of one over the size of the result with which its error falls."""
    return order([replace(point, level=point.size) for point in measured], 0.0)


@cache
def outline(key: str) -> Array:
    """The driving outline at the default tolerance."""
    return study(key).method(outlines.CHORDS).run(TOLERANCE_MM)


def turned(points_mm: Array, angle: float) -> Array:
    return points_mm @ np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])


# --- the references themselves -----------------------------------------------------------------------------------


def test_the_closed_form_of_the_circular_gear_meets_itself_where_its_curves_join() -> None:
    """Where fillets end is where flank and root do; an unwound string ends in the tip's corner."""
    reach = CIRCLE.center_along_mm - np.array(CIRCLE.fillet_mm)[::-1]
    arm = 1j * reach - CIRCLE.center_depth_mm
    fillet = CIRCLE.pitch_radius_mm + (1.0 + CIRCLE.rack.root_radius_mm / np.abs(arm)) * arm
    ends = fillet * np.exp(1j * np.array(CIRCLE.fillet_mm)[::-1] / CIRCLE.pitch_radius_mm)
    assert np.max(np.abs(ends - CIRCLE.joints_mm[1:])) < 1e-13
    tip = CIRCLE.tip_radius_mm
    unwound = np.sqrt(tip**2 - CIRCLE.base_radius_mm**2)
    start = CIRCLE.base_angle_rad - unwound / CIRCLE.base_radius_mm
    corner = (CIRCLE.base_radius_mm + 1j * unwound) * np.exp(1j * start)
    assert abs(corner - CIRCLE.joints_mm[0]) < 1e-13


@pytest.mark.usefixtures("finer_chords")
@pytest.mark.thorough
def test_distances_from_the_circular_gear_are_those_from_many_of_its_points() -> None:
    """Along each normal of a fine outline, so far as no other part of the tooth is nearer."""
    dense = toothed_pair(circular_pair(), form(), 1e-5).driving.outline_mm
    middle = (dense + np.roll(dense, -1, axis=0)) / 2.0
    step = np.roll(dense, -1, axis=0) - dense
    normal = np.column_stack([step[:, 1], -step[:, 0]]) / np.hypot(step[:, 0], step[:, 1])[:, None]
    for distance in (-0.01, 0.01):
        away = CIRCLE.distance_mm(middle + distance * normal)
        # Beyond the corners of tips the nearest place is another.
        assert np.quantile(away, [0.002, 0.998]) == pytest.approx([0.01, 0.01], abs=2e-5)


@pytest.mark.thorough
def test_the_area_of_the_circular_gear_is_that_of_a_fine_polygon_but_for_its_chords() -> None:
    """Richardson's extrapolation of two even outlines, whose areas are of second order, to the fourth."""
    outlines = (even_outlines(circular_pair(), form(), count)[0] for count in (64, 128))
    coarse, fine = (Polygon(points).area for points in outlines)
    assert (4.0 * fine - coarse) / 3.0 == pytest.approx(area_mm2(CIRCLE), rel=1e-10)


def test_eccentric_anomalies_are_those_of_elliptic_integrals_to_fifty_digits() -> None:
    sigma = np.array([-31.0, 0.0, 7.5, 60.0, 200.0])
    with mpmath.workdps(50):
        squared = mpmath.mpf(ELLIPSE.eccentricity) ** 2
        size = TEETH * mpmath.pi * MODULE_MM / (4 * mpmath.ellipe(squared))
        for length, anomaly in zip(sigma.tolist(), ELLIPSE.anomaly_rad(sigma).tolist(), strict=True):
            rolled = size * (mpmath.ellipe(mpmath.mpf(anomaly) + mpmath.pi / 2, squared) - mpmath.ellipe(squared))
            assert abs(rolled - length) < 1e-13 * 236


# --- outlines ----------------------------------------------------------------------------------------------------

OUTLINES = ["outlines-circle", "outlines-ellipse"]


@pytest.mark.tiers(quick=["outlines-circle"], rest="slow")
@pytest.mark.parametrize("key", OUTLINES)
def test_vertices_of_outlines_are_on_the_closed_form(key: str) -> None:
    gear = CIRCLE if key == "outlines-circle" else ELLIPSE
    assert np.max(gear.distance_mm(outline(key))) < ROUNDING_MM


@pytest.mark.tiers(slow=["chords to both sides-outlines-circle"], rest="long")
@pytest.mark.parametrize("key", OUTLINES)
@pytest.mark.parametrize("method", [outlines.CHORDS, pytest.param(outlines.BOTH_SIDES, marks=pytest.mark.slow)])
def test_outlines_stray_by_their_tolerance_with_points_that_grow_by_its_square_root(key: str, method: str) -> None:
    measured = found(key, method, 0.05, TOLERANCE_MM, 5e-4, 5e-5)
    for point in measured:
        assert 0.5 * point.level < point.error <= point.level
    assert order(measured, 0.0) == pytest.approx(-1.0, abs=0.08)
    # Whole numbers of chords on each curve make coarse outlines better than their tolerance, by a third at most.
    assert order_by_size(measured) == pytest.approx(2.0, abs=0.35)


@pytest.mark.tiers(slow=["outlines-circle"], rest="long")
@pytest.mark.parametrize("key", OUTLINES)
def test_even_parameters_are_of_second_order_and_need_more_points(key: str) -> None:
    measured = found(key, outlines.EVEN, 8, 16, 32)
    assert order(measured, 0.0) == pytest.approx(2.0, abs=0.06)
    chords = found(key, outlines.CHORDS, 0.05, TOLERANCE_MM, 5e-4, 5e-5)
    assert measured[0].size > chords[1].size
    assert measured[0].error > 1.5 * chords[1].error


@pytest.mark.slow
def test_equivalent_gears_miss_an_elliptical_gear_however_many_points_they_have() -> None:
    astray = found("outlines-ellipse", outlines.EQUIVALENT, 5e-4, 5e-5)
    assert all(point.error > 1.5e-3 for point in astray)
    # On circles they are exact.
    teeth = toothed_pair(circular_pair(), form(equivalent=True), 5e-5)
    assert study("outlines-circle").error(teeth.driving.outline_mm) <= 5e-5


@pytest.mark.tiers(thorough=["outlines-circle"], rest="slow")
@pytest.mark.parametrize("key", OUTLINES)
def test_an_outline_displaced_by_a_tenth_of_the_tolerance_is_told(key: str) -> None:
    fine = toothed_pair(study_pair(key), form(), 0.05 * TOLERANCE_MM).driving.outline_mm
    error = study(key).error
    assert error(fine) <= 0.05 * TOLERANCE_MM
    assert error(fine + np.array([0.0, 0.1 * TOLERANCE_MM])) > 0.09 * TOLERANCE_MM
    turn = 0.1 * TOLERANCE_MM / CIRCLE.pitch_radius_mm
    assert error(turned(fine, turn)) > 0.08 * TOLERANCE_MM


def study_pair(key: str):
    return circular_pair() if key == "outlines-circle" else elliptical_pair()


# --- contact -----------------------------------------------------------------------------------------------------


@pytest.mark.thorough
def test_ends_of_contact_are_exact_once_every_contact_has_a_position() -> None:
    assert all(point.error < 1e-12 for point in found("contact-ratio", contact.ENDS, 6, PER_TOOTH))
    assert found("contact-ratio", contact.ENDS, 4)[0].error > 1e-2


@pytest.mark.thorough
def test_counting_contacts_misses_up_to_one_position_of_each() -> None:
    for point in found("contact-ratio", contact.COUNTED, 6, 10, PER_TOOTH):
        assert 1e-3 < point.error <= 1.0 / (point.level * contact.exact_contact_ratio())


@pytest.mark.thorough
def test_exact_curves_have_no_transmission_error_and_the_backlash_of_involutes() -> None:
    assert all(point.error < 1e-13 for point in found("contact-angle", contact.CURVES, 6, PER_TOOTH))


@pytest.mark.slow
def test_outlines_touch_where_involutes_do_but_for_both_gears_chords() -> None:
    """Two chords astray by t turn the driven gear by 2 t / rb at most, and somewhere by more than half of that."""
    measured = found("contact-angle", contact.CHORDS, TOLERANCE_MM, 0.0016, 5e-4)
    for point in measured:
        bound = 2.0 * point.level / CIRCLE.base_radius_mm
        assert 0.5 * bound < point.error <= bound
    assert order(measured, 0.0) == pytest.approx(-1.0, abs=0.05)


@pytest.mark.slow
def test_even_parameters_turn_the_driven_gear_at_second_order() -> None:
    assert order(found("contact-angle", contact.EVEN, 4, 8, 16), 0.0) == pytest.approx(2.0, abs=0.25)


@pytest.mark.slow
def test_the_default_positions_find_what_outlines_do_and_half_of_them_do_not() -> None:
    half, default, more = (
        contact.play_error_rad(contact.play_to_tolerance(TOLERANCE_MM, n)) for n in (10, PER_TOOTH, 60)
    )
    assert default == pytest.approx(more, rel=0.05)
    assert half < 0.7 * more


@pytest.mark.slow
@pytest.mark.parametrize("turn", [1e-5, -1e-5])
def test_a_pair_whose_driven_gear_stands_elsewhere_is_told(turn: float) -> None:
    exact = contact.play_of_curves(6)
    assert contact.play_error_rad(exact) < 1e-13
    moved = contact.Play(exact.pushing_rad + turn, exact.back_rad + turn)
    assert contact.play_error_rad(moved) == pytest.approx(1e-5, rel=1e-6)
    teeth = toothed_pair(circular_pair(), form(contact.BACKLASH_MM), 5e-4)
    outlines_mm = teeth.driving.outline_mm, turned(teeth.driven.outline_mm, 100.0 * turn)
    assert contact.play_error_rad(contact.play_of_outlines(outlines_mm)) == pytest.approx(1e-3, rel=0.05)


# --- solids ------------------------------------------------------------------------------------------------------


@pytest.mark.slow
def test_volumes_are_wrong_by_the_tolerance_with_triangles_that_grow_by_its_square_root() -> None:
    measured = found("solid-volume", solids.STRAIGHT, 0.05, TOLERANCE_MM, 5e-4, 5e-5)
    assert order(measured, 0.0) == pytest.approx(-0.95, abs=0.06)
    assert order_by_size(measured) == pytest.approx(2.0, abs=0.1)
    assert measured[1].error < 2e-4


@pytest.mark.slow
def test_volumes_of_even_parameters_are_of_second_order() -> None:
    assert order(found("solid-volume", solids.EVEN, 8, 16, 32), 0.0) == pytest.approx(2.0, abs=0.06)


@pytest.mark.slow
def test_facets_of_straight_and_helical_teeth_keep_to_the_tolerance() -> None:
    for method in (solids.STRAIGHT, solids.HELICAL):
        for point in found("solid-surface", method, 0.05, 0.016):
            assert 0.3 * point.level < point.error <= point.level


@pytest.mark.slow
def test_helical_volumes_fall_with_the_tolerance_and_triangles_with_its_inverse() -> None:
    """Sections and chords both grow by the square root."""
    measured = found("solid-volume", solids.HELICAL, 0.05, 0.016, TOLERANCE_MM)
    assert order(measured, 0.0) == pytest.approx(-1.0, abs=0.06)
    assert order_by_size(measured) == pytest.approx(1.2, abs=0.1)


def test_a_solid_without_one_of_its_teeth_is_told() -> None:
    whole = outline("outlines-circle")
    polar = np.arctan2(whole[:, 1], whole[:, 0])
    beside = np.abs(polar) < 1.02 * CIRCLE.fillet_mm[0] / CIRCLE.pitch_radius_mm
    assert 0 < beside.sum() <= len(whole) / TEETH
    without = solids.Solid(gear_solid(Gear.DRIVING, whole[~beside], solids.BLANK, MODULE_MM, TOLERANCE_MM).mesh)
    # One tooth in 25 is a hundredth of the gear.
    assert solids.volume_error(without) > 5e-3
    assert solids.surface_error_mm(without) > 0.1 * MODULE_MM


@pytest.mark.slow
@pytest.mark.parametrize("share", [1e-3, -1e-3])
def test_a_solid_of_another_size_or_another_helix_is_told(share: float) -> None:
    solid = study("solid-volume").method(solids.STRAIGHT).run(TOLERANCE_MM)
    other = Trimesh((1.0 + share) * solid.mesh.vertices, solid.mesh.faces, process=False)
    assert solids.volume_error(solids.Solid(other)) == pytest.approx(3.0 * abs(share), rel=0.1)
    helical = study("solid-surface").method(solids.HELICAL).run(0.05)
    assert solids.surface_error_mm(replace(helical, advance=(1.0 + 20.0 * share) * helical.advance)) > 0.05
