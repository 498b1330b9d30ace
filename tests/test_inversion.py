"""The inverted working stroke against 50-digit inversion, up to 1e-9 rad from every joint and dead centre."""

from __future__ import annotations

import itertools
from dataclasses import replace
from functools import cache
from math import pi

import numpy as np
import pytest
from mpmath import mp

from ncgear.mechanisms.crank_slider import CrankSlider
from ncgear.numerics.arrays import Array
from ncgear.ratio.laws.three_segment import working_pieces
from ncgear.ratio.transmission import Piece
from ncgear.ratio.working_stroke import ClosedStroke, StrokeRequest, solved_stroke
from oracles import stroke as oracle
from test_stroke import AT_LAW_SPEED, BALER, NO_PRESSING

CASES: dict[str, tuple[StrokeRequest, tuple[float, float, float]]] = {
    "baler": (BALER, (380.0, 960.0, 0.0)),
    "a1 at law speed": (AT_LAW_SPEED, (380.0, 960.0, 0.0)),
    "offset 100": (BALER, (380.0, 960.0, 100.0)),
    "offset -150": (BALER, (380.0, 960.0, -150.0)),
    "short rod": (BALER, (380.0, 500.0, 0.0)),
    "no pressing": (NO_PRESSING, (380.0, 960.0, 0.0)),
}

every_case = pytest.mark.parametrize("name", CASES)

NEAR = np.array([1e-9, 1e-6, 1e-3])


@cache
def case(name: str) -> tuple[ClosedStroke, CrankSlider, oracle.Stroke]:
    """Stroke, linkage, and the oracle of the same float64 angles: theta4 is then the same number in both."""
    request, lengths = CASES[name]
    linkage = CrankSlider(*lengths)
    request = replace(request, stroke_mm=linkage.stroke_mm)
    angles = request.theta1_rad, request.theta2_rad, request.theta3_rad, request.theta4_rad
    speeds = request.v1, request.v2, request.a1
    exact = oracle.Stroke(oracle.StrokeParameters(*angles, *speeds, *lengths, request.a1_speed_rad_s))
    return solved_stroke(request), linkage, exact


def angles_of(stroke: ClosedStroke) -> Array:
    """A grid, and points next to the dead centres and to both sides of the joints."""
    inner = [stroke.theta2_rad, stroke.theta3_rad]
    near = [NEAR, stroke.theta4_rad - NEAR, *(joint + side * NEAR for joint in inner for side in (-1.0, 1.0))]
    return np.unique(np.concatenate([np.linspace(0.05, stroke.theta4_rad - 0.05, 60), *near]))


def evaluated(pieces: tuple[Piece, ...], angles: Array) -> tuple[Array, Array]:
    """phi2 and i12 at angles, each on its own piece."""
    driven, ratio = np.full(angles.size, np.nan), np.full(angles.size, np.nan)
    for piece in pieces:
        mask = (angles >= piece.start_rad) & (angles <= piece.end_rad)
        series = piece.driven_angle(angles[mask], 1)
        driven[mask], ratio[mask] = series.value, 1.0 / series.derivative(1)
    return driven, ratio


@pytest.mark.tiers(slow=["offset 100"], rest="long")
@every_case
def test_angle_and_ratio_are_relatively_exact_everywhere(name: str) -> None:
    stroke, linkage, exact = case(name)
    angles = angles_of(stroke)
    driven, ratio = evaluated(working_pieces(stroke, linkage), angles)
    for angle, found, slope in zip(angles.tolist(), driven.tolist(), ratio.tolist(), strict=True):
        assert abs(found / exact.driven_angle(angle) - 1) <= 1e-12, angle  # the accuracy promised
        assert abs(slope / exact.ratio(angle) - 1) <= 1e-12, angle


def test_textbook_inversion_would_fail_the_same_comparison() -> None:
    """tan^2(phi2/2) = x (x + 2 l3) / ((H - x)(x + 2 (l3 - l2))) in floats, from powers of phi1: H - x cancels."""
    _, _, exact = case("baler")
    phi1 = 1.3 * pi - 1e-6
    x = float(exact.displacement(phi1))
    with np.errstate(all="ignore"):
        textbook = 2.0 * np.arctan(np.sqrt(x * (x + 1920.0) / ((760.0 - x) * (x + 1160.0))))
    assert not abs(textbook / exact.driven_angle(phi1) - 1) <= 1e-12


@every_case
@pytest.mark.parametrize("extended", [False, True])
def test_dead_centres_have_the_limit_of_zero_by_zero(name: str, extended: bool) -> None:
    """i12 = sqrt(S'' / s''): S the linkage's displacement by phi2, s the stroke's by phi1."""
    stroke, linkage, exact = case(name)
    piece = working_pieces(stroke, linkage)[-1 if extended else 0]
    end, driven_end = (stroke.theta4_rad, linkage.working_angle_rad) if extended else (0.0, 0.0)
    series = piece.driven_angle(np.array([end]), 2)
    assert series.value[0] == pytest.approx(driven_end, abs=1e-15)
    with mp.workdps(40):
        bent = mp.diff(exact.linkage.displacement, exact.linkage.working_angle() if extended else mp.mpf(0), 2)
        limit = mp.sqrt(bent / exact.displacement(end, 2))
        assert abs(1 / series.derivative(1)[0] / limit - 1) <= 1e-13
        slope = exact.ratio_slope_at_dead_centre(extended)
        found = -series.derivative(2)[0] / series.derivative(1)[0] ** 2
        assert abs(found - slope) <= 1e-12 * (1 + abs(slope))


@every_case
def test_linkage_leads_back_to_the_displacement_asked_for(name: str) -> None:
    """Slider displacement and its first two derivatives through the linkage are the stroke's own."""
    stroke, linkage, exact = case(name)
    for piece in working_pieces(stroke, linkage):
        angles = np.linspace(piece.start_rad, piece.end_rad, 9)
        moved = linkage.displacement(piece.driven_angle(angles, 2))
        for order in range(3):
            inside = np.clip(angles, piece.start_rad + 1e-12, piece.end_rad)  # the oracle takes joints from the left
            wanted = np.array([float(exact.displacement(angle, order)) for angle in inside.tolist()])
            assert np.max(np.abs(moved.derivative(order) - wanted)) <= 1e-11 * stroke.stroke_mm


@every_case
def test_pieces_meet_with_equal_value_slope_and_bend(name: str) -> None:
    """Displacement, velocity and acceleration are continuous at theta2 and theta3, so phi2'' is."""
    pieces = working_pieces(*case(name)[:2])
    for before, after in itertools.pairwise(pieces):
        assert before.end_rad == after.start_rad
        joint = np.array([before.end_rad])
        left, right = before.driven_angle(joint, 3), after.driven_angle(joint, 3)
        for order in range(3):
            # Rounding of three derivatives of a composed function of size 1
            assert left.derivative(order)[0] == pytest.approx(right.derivative(order)[0], abs=1e-12)
        assert abs(left.derivative(3)[0] - right.derivative(3)[0]) > 1e-2  # and no further: a real joint


def test_an_empty_middle_segment_leaves_two_pieces() -> None:
    assert len(working_pieces(*case("no pressing")[:2])) == 2
    assert len(working_pieces(*case("baler")[:2])) == 3
