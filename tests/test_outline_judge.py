"""The judge of the benchmarks: what it says of a pair whose gaps are known, and of outlines with known faults."""

from __future__ import annotations

from functools import cache
from math import cos, pi, radians, sin

import numpy as np
import pytest

from beside_ncgears import JUDGED, MODULE_MM, SEEN, by_ncgear_in_curves, points_of, sampled
from ncgear.pitch.pair import sized_pair
from ncgear.teeth.backlash import play_of
from ncgear.teeth.form import Backlash, ToothForm
from ncgear.teeth.gear import toothed_pair
from outline_judge import Flanks, judged_flanks, judged_outline, sine_law
from pairs import rack
from pairs import sine_law as transmission

Array = np.ndarray

DEPTH, TEETH, MODULE = 0.08, 25, 2.0
ALPHA = radians(20.0)


@cache
def outlines(tolerance: float, backlash_mm: float = 0.0) -> tuple[Array, Array]:
    """Both outlines of a pair."""
    pitch = sized_pair(transmission(DEPTH), TEETH, MODULE, None)
    pair = toothed_pair(pitch, ToothForm(rack(module=MODULE), backlash=Backlash(backlash_mm)), tolerance)
    return pair.driving.outline_mm, pair.driven.outline_mm


def turned(outline: Array, angle: float) -> Array:
    """Turned about the axis."""
    return outline @ np.array([[cos(angle), sin(angle)], [-sin(angle), cos(angle)]])


def judged(driving: Array, driven: Array, depth: float = DEPTH) -> Flanks:
    return judged_flanks(driving, driven, sine_law(depth), TEETH, MODULE, ALPHA)


def test_centre_distance_is_that_of_the_pitch_curves() -> None:
    pitch = sized_pair(transmission(DEPTH), TEETH, MODULE, None)
    assert sine_law(DEPTH).center_distance_mm(TEETH, MODULE) == pytest.approx(pitch.center_distance_mm, rel=1e-13)


@pytest.mark.slow
@pytest.mark.parametrize("tolerance", [0.005, 0.0005, 0.00005])
def test_chords_inside_convex_flanks_leave_up_to_two_tolerances(tolerance: float) -> None:
    found = judged(*outlines(tolerance))
    assert found.overlap == 0.0
    assert 1.4 * tolerance < found.gap * MODULE <= 2.0 * tolerance


@pytest.mark.slow
@pytest.mark.parametrize("tolerance", [0.0005, 0.00001])
def test_chords_that_straddle_flanks_overlap_as_much_as_they_gape(tolerance: float) -> None:
    """With fewer points by the square root of 2; fillets and lands are the same."""
    pitch, form = sized_pair(transmission(DEPTH), TEETH, MODULE, None), ToothForm(rack(module=MODULE))
    plain, pair = (
        toothed_pair(pitch, form, 0.005, flank_tolerance_mm=tolerance, straddling=straddling)
        for straddling in (False, True)
    )
    found = judged(pair.driving.outline_mm, pair.driven.outline_mm)
    assert 1.4 * tolerance < found.gap * MODULE <= 2.0 * tolerance
    assert 1.4 * tolerance < found.overlap * MODULE <= 2.0 * tolerance
    elsewhere = len(toothed_pair(pitch, form, 0.005, flank_tolerance_mm=10.0).driving.outline_mm)
    points = [len(gear.outline_mm) - elsewhere for gear in (plain.driving, pair.driving)]
    # Two more on each flank, whose ends are on it, and whole numbers.
    assert 0.97 * points[0] < np.sqrt(2.0) * (points[1] - 2 * 2 * TEETH) < 1.1 * points[0]


@pytest.mark.slow
def test_every_pair_in_mesh_is_looked_at() -> None:
    # Front and back, 40 positions a tooth, and more than one pair at most of them.
    found = judged(*outlines(0.005))
    assert 1.2 * 2 * 40 * TEETH < found.pairs < 2.0 * 2 * 40 * TEETH


@pytest.mark.slow
def test_backlash_is_gap_along_the_normal() -> None:
    """All of it on the idle side, and most where the driven gear's flanks have the longest arm."""
    tolerance = 0.0005
    found = judged(*outlines(tolerance, 0.1))
    pitch = sized_pair(transmission(DEPTH), TEETH, MODULE, None)
    most = play_of(pitch, rack(module=MODULE), Backlash(0.1)).largest_normal_mm.value
    assert most > 0.12
    assert found.gap * MODULE == pytest.approx(most, abs=3.0 * tolerance)


@pytest.mark.slow
@pytest.mark.parametrize("angle", [1e-4, -1e-4])
def test_a_driven_gear_turned_too_far_overlaps_on_one_side_and_gapes_on_the_other(angle: float) -> None:
    tolerance = 0.00005
    driving, driven = outlines(tolerance)
    found = judged(driving, turned(driven, angle))
    lever = 1e-4 * np.hypot(*driven.T).max() * cos(ALPHA) / MODULE
    assert 0.7 * lever < found.overlap < lever
    assert 0.7 * lever < found.gap < 1.1 * lever


@pytest.mark.slow
def test_another_law_does_not_pass() -> None:
    assert judged(*outlines(0.0005), depth=0.081).overlap > 10.0 * 0.0005


@pytest.mark.slow
def test_flanks_that_never_meet_are_no_pairs() -> None:
    driving, driven = outlines(0.005)
    assert judged(driving, turned(driven, pi / TEETH)).gap == np.inf


def test_faults_of_outlines_are_counted() -> None:
    square = np.array([[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0]])
    sound = judged_outline(square, 1.0)
    assert (sound.points, sound.reversals, sound.repeated, sound.simple) == (4, 0, 0, True)
    repeated = judged_outline(np.insert(square, 1, square[1], axis=0), 1.0)
    assert (repeated.points, repeated.reversals, repeated.repeated, repeated.simple) == (5, 0, 1, True)
    spur = judged_outline(np.insert(square, 1, [[3.0, 0.0], [2.5, 0.1]], axis=0), 1.0)
    assert spur.reversals == 2
    crossed = judged_outline(square[[0, 2, 1, 3]], 1.0)
    assert not crossed.simple


@pytest.mark.long
@pytest.mark.slow
def test_few_poles_leave_a_gap_of_a_millionth_of_a_module() -> None:
    """Splines of the benchmark, by points much closer than their spans; by one point a span they look coarse."""
    contours = by_ncgear_in_curves(TEETH)
    assert max(map(points_of, contours)) < 0.1 * 19863, "a tenth of what the other program of the field takes"
    driving, driven = (sampled(contour, JUDGED) for contour in contours)
    found = judged_flanks(driving, driven, sine_law(DEPTH), TEETH, MODULE_MM, ALPHA)
    assert max(found.gap, found.overlap) <= 1.1e-6
    coarse = judged_flanks(*(sampled(one, SEEN[:1]) for one in contours), sine_law(DEPTH), TEETH, MODULE_MM, ALPHA)
    assert coarse.gap > 1e-4
