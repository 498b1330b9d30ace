"""Crossings of polylines and of curves against plane geometry; what does not cross must not be reported."""

from __future__ import annotations

from collections.abc import Callable
from math import cos, pi, sin, sqrt

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from shapely import LineString

from at_once import at_once
from ncgear.numerics.arrays import Array
from ncgear.numerics.crossing import CurveFunction, chord_crossings, circle_crossings, refined_crossings

TIGHT = 1e-13
"""Curves of size 1 to 5: some tens of rounding errors of a point."""


def circles(centre: tuple[float, float], radius: float) -> CurveFunction:
    """A circle by its polar angle."""

    def points(at: Array) -> tuple[Array, Array]:
        direction = np.column_stack([np.cos(at), np.sin(at)])
        return np.array(centre) + radius * direction, radius * np.column_stack([-direction[:, 1], direction[:, 0]])

    return points


def lines(start: tuple[float, float], step: tuple[float, float]) -> CurveFunction:
    """A straight line, parameter 1 at its second point."""
    return lambda at: (np.array(start) + at[:, None] * np.array(step), np.tile(np.array(step), (at.size, 1)))


def sampled(curve: CurveFunction, parameters: Array) -> Array:
    """One row of points on a curve."""
    return curve(parameters)[0][None]


def test_two_segments_cross_where_geometry_says() -> None:
    first = np.array([[[0.0, 0.0], [4.0, 4.0]]])
    second = np.array([[[0.0, 2.0], [2.0, 2.0], [6.0, 2.0]]])
    row, along1, along2 = chord_crossings(first, second)
    # y = x meets y = 2 at (2, 2), the shared corner: one crossing for each of its two segments
    assert row.tolist() == [0, 0]
    assert along1 == pytest.approx([0.5, 0.5], abs=1e-15)
    assert along2 == pytest.approx([1.0, 1.0], abs=1e-15)


def test_rows_are_only_compared_with_their_own_row() -> None:
    diagonal, level, far = [[0.0, 0.0], [2.0, 2.0]], [[0.0, 0.5], [2.0, 0.5]], [[5.0, 5.0], [6.0, 5.0]]
    row, along1, along2 = chord_crossings(np.array([diagonal, diagonal]), np.array([far, level]))
    assert row.tolist() == [1]
    assert (along1[0], along2[0]) == pytest.approx((0.25, 0.25), abs=1e-15)


@pytest.mark.judges("numerics")
@at_once("points", [2, 17, 18, 33, 100])
def test_long_polylines_cross_where_each_pair_of_chords_does(points: int) -> None:
    """Shapely tells them pair by pair.  The negative control: polylines that are moved apart cross nowhere."""
    noise = np.random.default_rng(points)
    first, second = (np.cumsum(noise.normal(size=(3, count, 2)), axis=1) for count in (40, points))
    row, along1, along2 = chord_crossings(first, second)
    expected = [
        (number, i, j)
        for number in range(3)
        for i in range(39)
        for j in range(points - 1)
        if LineString(first[number, i : i + 2]).intersects(LineString(second[number, j : j + 2]))
    ]
    assert list(zip(row.tolist(), along1.astype(int).tolist(), along2.astype(int).tolist(), strict=True)) == expected
    for number, one, other in zip(row, along1, along2, strict=True):
        places = [
            line[number, int(at)] + (at - int(at)) * (line[number, int(at) + 1] - line[number, int(at)])
            for line, at in ((first, one), (second, other))
        ]
        assert places[0] == pytest.approx(places[1], abs=1e-10)
    assert expected or points == 2
    assert not chord_crossings(first, second + 1e3)[0].size


@at_once(
    "second",
    [
        [[0.0, 1.0], [2.0, 3.0]],  # parallel
        [[3.0, 3.0], [4.0, 4.0]],  # on the same line, apart
        [[0.0, 2.1], [0.9, 1.2]],  # ends before it
        [[2.0001, 0.0], [2.0001, 9.0]],  # passes beyond the end
    ],
)
def test_segments_that_miss_give_nothing(second: list[list[float]]) -> None:
    row, along1, along2 = chord_crossings(np.array([[[0.0, 0.0], [2.0, 2.0]]]), np.array([second]))
    assert row.size == along1.size == along2.size == 0


def two_circles() -> tuple[CurveFunction, CurveFunction, Array]:
    """Unit circles 1 apart: they cross at (1/2, +-sqrt(3)/2)."""
    height = sqrt(3.0) / 2.0
    return circles((0.0, 0.0), 1.0), circles((1.0, 0.0), 1.0), np.array([[0.5, -height], [0.5, height]])


def test_circles_from_chords_to_rounding_error() -> None:
    first, second, exact = two_circles()
    parameters = np.linspace(-pi, pi, 41)
    _, along1, along2 = chord_crossings(sampled(first, parameters), sampled(second, parameters))
    assert along1.size == 2
    step = parameters[1] - parameters[0]
    at1, at2, agreed = refined_crossings(first, second, -pi + along1 * step, -pi + along2 * step, TIGHT)
    assert agreed.all()
    order = np.argsort(first(at1)[0][:, 1])
    assert np.allclose(first(at1)[0][order], exact, rtol=0.0, atol=2 * TIGHT)
    assert np.allclose(second(at2)[0][order], exact, rtol=0.0, atol=2 * TIGHT)


def test_starts_are_not_changed() -> None:
    first, second, _ = two_circles()
    start1, start2 = np.array([1.0]), np.array([2.0])
    refined_crossings(first, second, start1, start2, TIGHT)
    assert (start1[0], start2[0]) == (1.0, 2.0)


@pytest.mark.parametrize(
    ("second", "start"),
    [
        (circles((3.0, 0.0), 1.0), pi),  # outside, 1 apart
        (circles((0.1, 0.0), 0.5), 0.0),  # inside
        (lines((1.5, 0.0), (0.0, 1.0)), 0.0),  # a line that passes by
    ],
    ids=["apart", "inside", "line"],
)
def test_curves_that_miss_are_not_called_crossings(second: CurveFunction, start: float) -> None:
    with np.errstate(all="ignore"):
        agreed = refined_crossings(circles((0.0, 0.0), 1.0), second, np.array([0.1]), np.array([start]), 1e-9)[2]
    assert not agreed.any()


def test_parallel_lines_neither_cross_nor_fail() -> None:
    first, second = lines((0.0, 0.0), (1.0, 0.0)), lines((0.0, 1.0), (1.0, 0.0))
    at1, at2, agreed = refined_crossings(first, second, np.array([0.3]), np.array([0.7]), 1e-9)
    assert not agreed.any()
    assert (at1[0], at2[0]) == (0.3, 0.7)  # no direction to go in


def test_one_of_several_may_miss() -> None:
    """Rows are independent: a crossing beside one that does not exist is still found."""

    def second(at: Array) -> tuple[Array, Array]:
        heights = np.array([0.5, 2.0])
        return np.column_stack([at, heights]), np.column_stack([np.ones(2), np.zeros(2)])

    first, starts = circles((0.0, 0.0), 1.0), (np.array([0.4, 1.0]), np.array([0.9, 0.1]))
    at1, _, agreed = refined_crossings(first, second, *starts, TIGHT)
    assert agreed.tolist() == [True, False]
    assert at1[0] == pytest.approx(pi / 6.0, abs=2 * TIGHT)


@pytest.mark.slow
@settings(deadline=None)
@given(st.floats(0.1, 2.9), st.floats(-1.2, 1.2))
def test_a_line_through_a_circle(direction: float, turned: float) -> None:
    """The line leaves the centre's neighbour (0.3, 0) in a direction; its crossing solves a quadratic."""
    c, s = cos(direction + turned), sin(direction + turned)
    length = -0.3 * c + sqrt(1.0 - (0.3 * s) ** 2)
    exact = (0.3 + length * c, length * s)
    first: Callable[[Array], tuple[Array, Array]] = circles((0.0, 0.0), 1.0)
    start = np.array([np.arctan2(exact[1], exact[0]) + 0.05])
    at1, at2, agreed = refined_crossings(first, lines((0.3, 0.0), (c, s)), start, np.array([1.0]), TIGHT)
    assert agreed.all()
    assert at2[0] == pytest.approx(length, abs=10 * TIGHT)
    assert tuple(first(at1)[0][0]) == pytest.approx(exact, abs=10 * TIGHT)


@pytest.mark.slow
@settings(deadline=None)
@given(st.floats(0.2, 1.4), st.floats(-3.0, 3.0), st.floats(0.01, 0.9), st.floats(0.05, 0.95))
def test_a_chord_through_a_circle_in_both_senses(slope: float, turned: float, before: float, share: float) -> None:
    """A chord that crosses the unit circle at a known place, at a known angle to the radius there."""
    place, direction = np.exp(1j * np.array([turned])), np.exp(1j * np.array([turned + slope]))
    # Inwards the chord ends before it comes out again on the other side.
    start, step = place - before * cos(slope) * direction, before * cos(slope) / share * direction
    for begin, way, at in ((start, step, share), (start + step, -step, 1.0 - share)):
        found, lever = circle_crossings(begin, way, np.ones(1))
        assert found == pytest.approx(at, abs=1e-10)
        assert lever == pytest.approx(cos(slope), abs=1e-10)


def test_a_chord_that_begins_on_the_circle_crosses_it_there() -> None:
    for step in (0.5 + 0.1j, 0.5 - 3.0j):
        share, _ = circle_crossings(np.ones(1, dtype=complex), np.array([step]), np.ones(1))
        assert share[0] == 0.0
