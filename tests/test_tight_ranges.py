"""Ranges between checkpoints are no wider than they have to be: laws that go along their borders, in closed form.

That no law leaves them is judged in ``test_limit_proof.py``.
"""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise
from math import cos, inf, pi
from typing import Any

import numpy as np
import pytest
from scipy.optimize import brentq

from at_once import at_once
from ncgear.mechanisms.crank_slider import CrankSlider
from ncgear.mechanisms.slider_load import SliderLoad
from ncgear.optimum.certified.cycle import CrankCycle, cycle
from ncgear.optimum.certified.demands import Demands
from ncgear.optimum.certified.ranges import (
    KnownRanges,
    _between_lower,
    _between_upper,
    _greatest_ratio,
    _leaning,
    _spare,
    along,
    between,
    curved,
    halves,
    parts_between,
    rows_of_places,
)
from ncgear.optimum.task import Task

pytestmark = pytest.mark.judges("optimum")

ANGLE = np.array([0.0, 0.02, 0.05, 0.06, 0.1])


def alone(bound: Callable[..., Any], values: np.ndarray, angle: np.ndarray, *limits: float) -> list[np.ndarray]:
    """What a bound tells of one part, whose values and angles have shape (n,)."""
    return [found[0] for found in bound(values[np.newaxis], angle[np.newaxis], *limits)]


def known(ends: np.ndarray, between: float) -> np.ndarray:
    """Values at both ends alone."""
    return np.concatenate([ends[:1], np.full(ends.size - 2, between), ends[-1:]])


def test_between_two_places_a_driven_curve_may_be_straight() -> None:
    """1 + s = A cos(phi - phi0): a straight pitch curve, 1/r2 = (1 + s)/a, and no more."""
    s = 2.1 * np.cos(ANGLE - 0.07) - 1.0
    at, in_cell = alone(_between_upper, known(s**2, inf), ANGLE)
    assert at == pytest.approx(s**2, rel=1e-12)
    # In a cell no more than the height of a sine over its larger end.
    most = [(2.1 * np.cos(np.linspace(a, b, 99) - 0.07) - 1.0).max() for a, b in pairwise(ANGLE)]
    assert (np.sqrt(in_cell) >= np.array(most) - 1e-12).all()
    assert np.sqrt(in_cell) == pytest.approx(np.maximum(s[1:], s[:-1]), abs=2.2 * 0.04**2 / 8.0 + 1e-12)
    assert alone(_between_upper, known(np.full(5, inf), 1.0), ANGLE)[1].tolist() == [inf] * 4
    narrow = alone(_between_upper, known(s**2, 0.5), ANGLE)[0]
    assert narrow[1:-1] == pytest.approx(0.5)


@at_once("sign", [1.0, -1.0])
def test_between_two_places_a_curve_may_lean_as_far_as_its_tangent(sign: float) -> None:
    """Up from both ends for the greatest q, down for the least: 1 + s goes by exp(t d)."""
    ends, steep = np.array([1.3, 1.25]), 0.8
    at, in_cell = alone(
        _leaning, known(np.repeat(ends - 1.0, [2, 3]) ** 2, inf if sign > 0.0 else 0.0), ANGLE, sign * steep
    )
    if sign > 0.0:
        wanted = np.minimum(ends[0] * np.exp(steep * ANGLE), ends[1] * np.exp(steep * (0.1 - ANGLE)))
        assert at == pytest.approx((wanted - 1.0) ** 2, rel=1e-12)
        fine = np.linspace(ANGLE[:-1], ANGLE[1:], 2001)
        inside = np.minimum(ends[0] * np.exp(steep * fine), ends[1] * np.exp(steep * (0.1 - fine)))
        assert in_cell == pytest.approx(((inside - 1.0) ** 2).max(axis=0), rel=1e-3)
    else:
        # A least q of nothing in the middle is lifted from both ends.
        wanted = np.maximum(ends[0] * np.exp(-steep * ANGLE), ends[1] * np.exp(-steep * (0.1 - ANGLE)))
        assert at == pytest.approx((wanted - 1.0) ** 2, rel=1e-12)


@at_once("ratio", [0.5, 1.0, 2.5])
def test_between_two_near_places_a_driving_curve_bends_by_its_greatest_ratio(ratio: float) -> None:
    """ln q bends up by 2 i + 2 i^2, i the greatest ratio of the stretch, which near places hardly change."""
    short = ANGLE / 4.0
    at, in_cell = alone(_between_lower, known(np.full(5, ratio**-2), 1e-9), short, 50.0)
    bend = 2.0 * ratio + 2.0 * ratio**2
    assert np.log(at * ratio**2) == pytest.approx(-bend * short * (0.025 - short) / 2.0, rel=0.01)
    inner = np.minimum(at[1:], at[:-1]) * np.exp(-bend * np.diff(short) ** 2 / 8.0)
    assert in_cell == pytest.approx(inner, rel=1e-5)
    # No less than the ratios let be, and no less than is known.
    assert alone(_between_lower, known(np.full(5, ratio**-2), 1e-9), 10.0 * ANGLE, ratio)[0] == pytest.approx(ratio**-2)
    least = 0.999 * ratio**-2
    at, _ = alone(_between_lower, known(np.full(5, ratio**-2), least), ANGLE, 50.0)
    assert at[1:-1] == pytest.approx(least)


@at_once(("at_ends", "length"), [(1.0, 0.2), (2.0, 0.3), (0.5, 0.6)])
def test_the_greatest_ratio_of_a_stretch_is_a_fixed_point(at_ends: float, length: float) -> None:

    def greatest(most: float) -> float:
        return float(_greatest_ratio(np.array([at_ends]), np.array([length]), most)[0])

    wanted = brentq(lambda i: (1.0 + at_ends) / cos(i * length / 2.0) - 1.0 - i, at_ends, 1.6 * at_ends + 0.3)
    assert greatest(1.4 * wanted) == pytest.approx(wanted, rel=3e-6)
    # Where ratios may be so great that the bound never falls below them, it is the greatest of all.
    assert greatest(3.0 / length + 9.0) == pytest.approx(3.0 / length + 9.0)
    assert greatest(1.0001 * at_ends) == 1.0001 * at_ends


def test_three_places_in_a_row_meet_their_bounds_along_the_solutions() -> None:
    """y'' + c y = a by waves, and q'' = d + 2 rate q' - (rate^2 - 1/sqrt(tangent)) q and so on, by finite steps."""
    before, after = np.array([0.03]), np.array([0.05])
    low, high = np.log([0.8]), np.log([1.1])
    first, second, rest, good = curved(low, high, before, after)
    roof = lambda y: 2.0 * np.exp(-y) + 2.0 * np.exp(-y / 2.0)  # noqa: E731
    c = (roof(low) - roof(high)) / (high - low)
    a = roof(low) + c * low
    for amplitude, phase in ((0.2, 0.3), (0.0, 0.0), (-0.4, 1.0)):
        y = lambda at, k=amplitude, p=phase: a / c + k * np.cos(np.sqrt(c) * at + p)  # noqa: E731
        assert first * y(-before) + second * y(after) + rest == pytest.approx(y(0.0), rel=1e-12)
    assert good.tolist() == [0]
    far = np.array([0.9 * pi / float(np.sqrt(c[0]))])
    assert curved(low, high, far, far)[3].size == 0
    for rate, about in ((0.4, 0.9), (-1.5, 1.2), (1.0, 1.02), (0.0, 4.0)):
        ones = np.ones(1)
        first, second, rest = along(rate * ones, about * ones, before, after)
        # The bound is that of one tangent of the root: q'' = 2 + sqrt(T) + q/sqrt(T) + 2 rate q' - rate^2 q.
        tangents = np.geomspace(0.05, 60.0, 60_001)
        k = tangents**-0.25
        whole = np.sinh(k * (before + after))
        by_tangent = np.exp(rate * before) * np.sinh(k * after) / whole
        root = tangents[np.argmin(np.abs(by_tangent - first))]
        grid = np.linspace(-float(before[0]), float(after[0]), 4001)
        h = grid[1] - grid[0]
        lower = (1.0 / h**2 + rate / h) * np.ones(grid.size)
        upper = (1.0 / h**2 - rate / h) * np.ones(grid.size)
        diagonal = (-2.0 / h**2 + rate**2 - root**-0.5) * np.ones(grid.size)
        ends = 1.1, 1.25
        right = np.full(grid.size - 2, 2.0 + np.sqrt(root))
        right[0] -= lower[0] * ends[0]
        right[-1] -= upper[0] * ends[1]
        solved = thomas(lower[1:-1], diagonal[1:-1], upper[1:-1], right)
        at_zero = np.interp(0.0, grid[1:-1], solved)
        assert first * ends[0] + second * ends[1] + rest == pytest.approx(at_zero, rel=2e-5)
        assert abs(rate**2 - root**-0.5) > 0.29


def thomas(lower: np.ndarray, diagonal: np.ndarray, upper: np.ndarray, right: np.ndarray) -> np.ndarray:
    """The solution of a tridiagonal system."""
    from scipy.linalg import solve_banded

    return solve_banded((1, 1), np.stack([np.roll(upper, 1), diagonal, np.roll(lower, -1)]), right)


def even(count: int) -> CrankCycle:
    return cycle(Task(CrankSlider(50.0, 200.0), SliderLoad(), 5.0), count)


def test_what_is_left_of_convexity_is_that_of_derivatives() -> None:
    on = even(720)
    angle = on.crank_angle_rad
    s, first, second = 1.0 + 0.3 * np.sin(2.0 * angle), 0.6 * np.cos(2.0 * angle), -1.2 * np.sin(2.0 * angle)
    wanted = (1.0 + s - s * second + first**2) / (1.0 + s + np.abs(s * second) + first**2)
    assert _spare(on, s**2) == pytest.approx(wanted, abs=2e-4)


def test_rows_of_places_close_gaps_of_two_cells_and_go_round_the_turn() -> None:
    assert [row.tolist() for row in rows_of_places(np.array([18, 19, 1, 4, 5, 10]), 20)] == [
        [18, 19, 0, 1, 2, 3, 4, 5, 6],
        [10, 11],
    ]
    assert rows_of_places(np.array([], dtype=int), 20) == []
    first, last = halves(even(40))
    assert first[-1] == last[0]
    assert (first[0], last[-1]) == (0, 0)


@at_once("convex", [True, False])
def test_checkpoints_stand_where_a_range_has_left_the_chord(convex: bool) -> None:
    """By (2 i + 2 i^2) L^2/8 = 0.02, or by t (1 + 1/s) L = 0.6, at the ratio of the motion; even for an even motion."""
    on = even(720)
    asked = Demands(0.2, 5.0, steepness=0.7, convex=convex)
    parts = parts_between(on, np.arange(on.count // 2), np.full(on.count // 2, 1.0 / 1.5**2), asked)
    assert [part[-1] for part in parts[:-1]] == [part[0] for part in parts[1:]]
    found = [parts[0][0], *(part[-1] for part in parts)]
    apart = np.sqrt(8.0 * 0.02 / (2.0 * 1.5 + 2.0 * 1.5**2)) if convex else 0.6 / (0.7 * 2.5)
    count = round(on.crank_angle_rad[on.count // 2 - 1] / apart)
    assert (found[0], found[-1], len(found)) == (0, on.count // 2 - 1, count + 1)
    assert np.ptp(np.diff(found)) <= 1
    # Between them, at places and in cells, known values are kept, widened by rounding alone.
    known_ranges = KnownRanges(np.full(on.count, 1e-3), np.full(on.count, inf))
    for place in found:
        known_ranges = known_ranges.within(place, 0.4, 0.5)
    assert not known_ranges.empty
    ranges = between(on, parts, asked).everywhere(known_ranges)
    assert ranges.least[found] == pytest.approx(0.4, rel=3e-9)
    assert ranges.most[found] == pytest.approx(0.5, rel=3e-9)
    assert (ranges.least[found] < 0.4).all()
    assert (ranges.most[found] > 0.5).all()
    assert ranges.most[-1] == inf
    assert known_ranges.within(0, 0.6, 0.7).empty
