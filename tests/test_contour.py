"""Outlines as few smooth curves, held against outlines of very many chords; rates; curves that are lines or arcs."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import cache
from math import pi

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.interpolate import BSpline

from closeness import farthest
from ncgear.errors import Unanswered
from ncgear.pitch.pair import PitchPair, sized_pair
from ncgear.pitch.shape import Mesh
from ncgear.ratio.laws.ellipse import elliptical_law
from ncgear.ratio.laws.expression import ratio_expression_law
from ncgear.ratio.laws.uniform import uniform_law
from ncgear.ratio.transmission import Lobes
from ncgear.teeth import contour as splines
from ncgear.teeth.contour import (
    DEGREE,
    SAME_IN_MODULES,
    SHORTEST_IN_MODULES,
    SPANS,
    Arc,
    Contour,
    Curve,
    Line,
    Spline,
    _ending,
    contour_of,
    fitted_splines,
    line_or_arc,
    ring_of_arcs,
)
from ncgear.teeth.form import TipRelief, ToothForm
from ncgear.teeth.gear import ToothedPair, toothed_pair
from ncgear.teeth.outline import exact_curves
from ncgear.teeth.stretch import CurveStretch
from pairs import baler_law, exact_ring, rack, sine_law

TOLERANCE = 5e-4
FINE = 5e-6
"""Chord tolerance of the outlines that curves are held against: far below what is asked of these."""
DENSE = 64
"""Points on each curve: 3 and more between any two at which it was fitted."""

Array = NDArray[np.float64]

PITCHES: dict[str, Callable[[], PitchPair]] = {
    "circle": lambda: sized_pair(uniform_law(Lobes()), 22, 2.0, None),
    "ellipse": lambda: sized_pair(elliptical_law(0.35, 0.0, Lobes()), 37, 2.0, None),
    "undercut": lambda: sized_pair(elliptical_law(0.7, 0.0, Lobes()), 13, 2.0, None),
    "concave": lambda: sized_pair(sine_law(0.2), 40, 2.0, None),
    "baler": lambda: sized_pair(baler_law(), 25, 3.0, None),
    "internal": lambda: sized_pair(
        ratio_expression_law("2 + 0.4*cos(phi)", Lobes(1, 2), scale_to_close=True), 48, 2.0, None, Mesh.INTERNAL
    ),
}


@cache
def pair(name: str) -> ToothedPair:
    pitch = PITCHES[name]()
    return toothed_pair(pitch, ToothForm(rack(module=pitch.size.module_mm)), 0.005)


def points_of(curve: Curve, count: int = DENSE) -> Array:
    """Points from a curve's start up to its end, which is left out; circles by their own formula."""
    share = np.arange(count)[:, None] / count
    if isinstance(curve, Spline):
        return np.asarray(BSpline(curve.knots, curve.poles_mm, DEGREE)(share[:, 0]))
    if isinstance(curve, Line):
        return curve.start + share * (curve.end - curve.start)
    start, middle, end = (complex(*at) for at in (curve.start, curve.middle, curve.end))
    # The Moebius transformation that takes 0, 1/2, 1 to the three points takes the line to the circle.
    ratio = (middle - start) / (end - middle)
    at = (start + share * (ratio * end - start)) / (1.0 + share * (ratio - 1.0))
    return np.column_stack([at.real, at.imag])


def ring_of(contour: Contour, count: int = DENSE) -> Array:
    return np.concatenate([points_of(curve, count) for curve in contour.curves])


SLOW = [pytest.param(name, marks=pytest.mark.slow) for name in ("circle", "concave")]


@pytest.mark.slow
@pytest.mark.parametrize("name", ["undercut", "baler", *SLOW])
def test_curves_and_exact_outline_are_close_both_ways(name: str) -> None:
    for gear in (pair(name).driving, pair(name).driven):
        contour, exact = contour_of(gear, TOLERANCE), exact_ring(gear, FINE)
        assert contour.deviation_mm <= TOLERANCE
        assert farthest(ring_of(contour), exact) <= TOLERANCE + FINE
        # Chords of 8 times as many points stray by less than a hundredth of the tolerance.
        assert farthest(exact, ring_of(contour, 8 * DENSE)) <= 1.01 * TOLERANCE


@pytest.mark.slow
def test_the_stated_deviation_is_about_what_is_found() -> None:
    gear = pair("ellipse").driving
    contour = contour_of(gear, TOLERANCE)
    found = farthest(ring_of(contour), exact_ring(gear, FINE))
    assert contour.deviation_mm / 3.0 < found <= contour.deviation_mm + FINE


@pytest.mark.thorough
def test_a_curve_that_is_moved_by_two_tolerances_is_seen() -> None:
    gear = pair("undercut").driving
    contour = contour_of(gear, TOLERANCE)
    number = next(n for n, curve in enumerate(contour.curves) if isinstance(curve, Spline))
    spline = contour.curves[number]
    assert isinstance(spline, Spline)
    step = spline.end - spline.start
    away = 2.0 * TOLERANCE * np.array([-step[1], step[0]]) / np.hypot(*step)
    curves = (*contour.curves[:number], replace(spline, poles_mm=spline.poles_mm + away), *contour.curves[number + 1 :])
    assert farthest(ring_of(replace(contour, curves=curves)), exact_ring(gear, FINE)) > 1.5 * TOLERANCE


@pytest.mark.slow
def test_each_curve_begins_exactly_where_the_last_one_ends() -> None:
    for name in PITCHES:
        curves = contour_of(pair(name).driving, TOLERANCE).curves
        assert all(
            np.array_equal(one.end, after.start) for one, after in zip(curves, [*curves[1:], curves[0]], strict=True)
        )


@pytest.mark.slow
def test_six_curves_a_tooth_and_one_more_at_each_joint() -> None:
    """A joint of the law is rolled over by a flank and a fillet or by a land: it parts one or two curves."""
    assert len(contour_of(pair("ellipse").driving, TOLERANCE).curves) == 6 * 37
    joints = pair("baler").driving.flanks.curve.joints_around_mm
    curve = pair("baler").driving.flanks.curve
    around = np.sum((joints > 0.0) & (joints < curve.length_mm))
    parted = len(contour_of(pair("baler").driving, TOLERANCE).curves) - 6 * 25
    assert 0 < parted <= 6 * (around + 1)


def test_lands_of_a_circle_are_arcs_about_its_axis() -> None:
    curves = contour_of(pair("circle").driving, TOLERANCE).curves
    arcs = [curve for curve in curves if isinstance(curve, Arc)]
    assert len(arcs) == 2 * 22
    radii = np.array([np.hypot(*at) for arc in arcs for at in (arc.start, arc.middle, arc.end)])
    tip, root = 22.0 + 2.0, 22.0 - 2.5
    assert np.all(np.minimum(np.abs(radii - tip), np.abs(radii - root)) < 1e-6)


@pytest.mark.slow
def test_tip_relief_parts_the_flanks_where_it_begins() -> None:
    plain = pair("circle").driving
    relieved = replace(rack(), relief=TipRelief(0.02, 1.0, 2.0))
    gear = toothed_pair(PITCHES["circle"](), ToothForm(relieved), 0.005).driving
    counts = [len(contour_of(one, TOLERANCE).curves) for one in (plain, gear)]
    assert counts[1] - counts[0] == 2 * 22
    assert farthest(ring_of(contour_of(gear, TOLERANCE)), exact_ring(gear, FINE)) <= TOLERANCE + FINE


@pytest.mark.slow
def test_gaps_of_equivalent_gears_are_bridged_as_in_their_outlines() -> None:
    form = ToothForm(rack(), equivalent=True)
    gear = toothed_pair(PITCHES["ellipse"](), form, 0.005).driving
    contour = contour_of(gear, TOLERANCE)
    gaps = [float(np.linalg.norm(curve.end - curve.start)) for curve in contour.curves if isinstance(curve, Line)]
    assert len(gaps) > 37
    assert max(gaps) < TOLERANCE
    # An outline's chord goes over the gap from some way before it, so that it misses the curve's end by less than it.
    assert farthest(ring_of(contour), exact_ring(gear, FINE)) <= TOLERANCE + FINE + max(gaps)
    assert farthest(exact_ring(gear, FINE), ring_of(contour, 8 * DENSE)) <= 1.01 * TOLERANCE


# --- splines --------------------------------------------------------------------------------------------------------


def wave(turn: float = 1.0) -> CurveStretch:
    """Some waves whose slopes are known."""
    one, two = np.ones(1), np.zeros((2, 1))

    def curve(row: NDArray[np.intp], at: Array) -> tuple[Array, Array]:
        shift = np.asarray(row, dtype=float) + turn * at
        return np.stack([at, np.sin(shift)], axis=-1), np.stack([np.ones_like(at), turn * np.cos(shift)], axis=-1)

    ends = np.zeros(2), np.ones(2), np.tile(two, 2)
    return CurveStretch(
        curve, np.arange(2), *ends, np.tile(one, 2), np.ones(2), np.full(2, np.inf), np.zeros(2, dtype=int)
    )


def test_splines_come_closer_with_the_fourth_power_of_their_spans(monkeypatch: pytest.MonkeyPatch) -> None:
    found = []
    for spans in (8, 16, 32):
        monkeypatch.setattr(splines, "SPANS", (spans,))
        found.append(max(group.deviation_mm.max() for group in fitted_splines(wave(), np.arange(2), 1.0)))
    assert np.log2(found[0] / found[1]) == pytest.approx(4.0, abs=0.1)
    assert np.log2(found[1] / found[2]) == pytest.approx(4.0, abs=0.1)


@pytest.mark.slow
def test_at_a_joint_of_the_law_splines_lose_nothing() -> None:
    """The slope there may be that of the other side: it would cost three orders of convergence."""
    gear = pair("baler").driving
    for stretch in exact_curves(gear.tips, gear.sides):
        spans = [group.knots.size - 7 for group in fitted_splines(stretch, np.arange(stretch.owner.size), TOLERANCE)]
        assert max(spans) <= 24


def test_a_curve_that_no_spline_follows_is_refused() -> None:
    with pytest.raises(Unanswered, match=f"tooth 1 is not followed by {SPANS[-1]} spans"):
        fitted_splines(wave(5000.0), np.arange(2), 1e-6)


# --- lines and arcs -------------------------------------------------------------------------------------------------


def quarter(off: float = 0.0) -> Array:
    """Points of a quarter of a circle of radius 3, bent by ``off`` in an odd wave, so that its middle stays."""
    share = np.linspace(0.0, 1.0, 9)
    radius = 3.0 + off * np.sin(2.0 * pi * share)
    return np.column_stack([radius * np.cos(share * pi / 2.0), radius * np.sin(share * pi / 2.0)])


def test_points_on_a_line_or_a_circle_make_one() -> None:
    straight, round_ = (
        line_or_arc(np.linspace([0.0, 1.0], [2.0, 5.0], 9), SAME_IN_MODULES),
        line_or_arc(quarter(), SAME_IN_MODULES),
    )
    assert straight is not None
    assert isinstance(straight[0], Line)
    assert round_ is not None
    assert isinstance(round_[0], Arc)
    for off, found in ((0.5, True), (2.0, False)):
        assert (line_or_arc(quarter(off * SAME_IN_MODULES), SAME_IN_MODULES) is not None) is found


def test_a_slot_as_a_polygon_becomes_its_lines_and_arcs() -> None:
    """Two half circles of radius 2 joined by lines of 6 mm: arcs may not turn by half a circle."""
    angle = np.linspace(-pi / 2.0, pi / 2.0, 41)
    half = 2.0 * np.column_stack([np.cos(angle), np.sin(angle)]) + [3.0, 0.0]
    curves = ring_of_arcs(np.concatenate([half, -half]), 1e-3)
    assert len(curves) <= 8
    assert all(
        np.array_equal(one.end, after.start) for one, after in zip(curves, [*curves[1:], curves[0]], strict=True)
    )
    points = np.concatenate([points_of(curve) for curve in curves])
    away = np.abs(np.hypot(np.maximum(np.abs(points[:, 0]) - 3.0, 0.0), points[:, 1]) - 2.0)
    assert away.max() <= 2e-3


def test_a_gap_between_curves_is_refused() -> None:
    corners = np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]])
    closed: list[Curve] = [Line(a, b) for a, b in zip(corners, np.roll(corners, -1, axis=0), strict=True)]
    assert np.array_equal(_ending(closed[0], closed[1].start, 1.0).end, corners[1])
    moved = Line(corners[0], corners[1] + [0.0, 3.0 * SHORTEST_IN_MODULES])
    with pytest.raises(Unanswered, match="mm apart where they should meet"):
        _ending(moved, closed[1].start, 1.0)
