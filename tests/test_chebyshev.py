"""Piecewise Chebyshev forms against closed forms: values, integrals, near-poles, jumps, and what must be refused."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
import pytest
from numpy.polynomial import chebyshev as numpy_chebyshev
from numpy.polynomial import legendre

from at_once import at_once
from ncgear.numerics import chebyshev
from ncgear.numerics.arrays import Array
from ncgear.numerics.chebyshev import NotSmooth

ACROSS = np.random.default_rng(3).uniform(0.0, 1.0, 997)

NEAR = 25000.0**0.5
"""1/(1 + 25000 x^2) has its poles at +-i/158."""

Case = tuple[Callable[[Array], Array], Callable[[Array], Array], Sequence[float]]

CASES: dict[str, Case] = {
    "sine": (np.cos, np.sin, [0.0, 7.0]),
    "exponential": (np.exp, np.exp, [-3.0, 1.0, 2.0]),
    "near pole": (lambda x: 1.0 / (1.0 + (NEAR * x) ** 2), lambda x: np.arctan(NEAR * x) / NEAR, [-1, 1]),
    "fast oscillation": (lambda x: np.cos(300.0 * x), lambda x: np.sin(300.0 * x) / 300.0, [0.0, 2.0]),
    "polynomial": (lambda x: x**7, lambda x: x**8 / 8.0, [-1.0, 0.5, 2.0]),
    "reciprocal near zero": (lambda x: 1.0 / x, np.log, [1e-3, 1.0]),
    "jump at a break": (lambda x: np.where(x < 1, 2.0, -3.0), lambda x: np.where(x < 1, 2 * x, 5 - 3 * x), [0, 1, 2]),
    "kink at a break": (lambda x: np.abs(x - 0.3), lambda x: 0.5 * (x - 0.3) * np.abs(x - 0.3), [0.0, 0.3, 1.0]),
}


def points_of(breaks: Sequence[float]) -> Array:
    """Random points between the first and the last break."""
    return breaks[0] + (breaks[-1] - breaks[0]) * ACROSS


@at_once("name", CASES)
def test_fit_reproduces_the_function(name: str) -> None:
    function, _, breaks = CASES[name]
    points = points_of(breaks)
    scale = np.max(np.abs(function(points)))
    found = chebyshev.fitted(function, breaks)(points)
    # Resolved to 18 rounding errors per tail, and a 25-term sum rounds about as much; cos(300 x) has its argument
    # rounded to 600 x 1.1e-16 already
    assert np.max(np.abs(found - function(points))) <= (2e-13 if name == "fast oscillation" else 4e-14) * scale


@at_once("name", CASES)
def test_columns_are_as_exact_as_single_functions(name: str) -> None:
    """Several columns are summed in another way: breaks, ends and points off them to the right included."""
    function, _, breaks = CASES[name]
    points = np.concatenate([points_of(breaks), np.array(breaks, dtype=float)[:-1]])
    values = function(points)
    found = chebyshev.fitted(lambda x: np.column_stack([function(x), 2.0 * function(x)]), breaks)(points)
    allowed = (2e-13 if name == "fast oscillation" else 4e-14) * np.max(np.abs(values))
    assert np.max(np.abs(found - values[:, None] * [1.0, 2.0])) <= 2.0 * allowed


@at_once("name", CASES)
def test_cells_are_as_exact_as_the_panels_they_are_cut_from(name: str) -> None:
    """Each column to its own size: the second is a millionth of the first."""
    function, _, breaks = CASES[name]
    form = chebyshev.fitted(lambda x: np.column_stack([function(x), 1e-6 * function(x) + 1e-7]), breaks)
    cells = chebyshev.cells_of(form)
    points = np.concatenate([points_of(breaks), form.breaks, np.nextafter(form.breaks[1:], -9.0)])
    apart = np.abs(cells(points) - form(points)).max(axis=0)
    assert np.all(apart <= 2e-14 * np.abs(form(points)).max(axis=0))
    assert np.array_equal(cells.ends[1:, 0], cells.ends[:-1, 1])


@at_once("name", CASES)
def test_integral_is_the_antiderivative_from_the_first_break(name: str) -> None:
    function, antiderivative, breaks = CASES[name]
    points = points_of(breaks)
    exact = antiderivative(points) - antiderivative(np.array([breaks[0]]))
    integral = chebyshev.fitted(function, breaks).integrated()
    area = np.max(np.abs(function(points))) * (breaks[-1] - breaks[0])
    # The fit's error over the whole length bounds the integral's
    assert np.max(np.abs(integral(points) - exact)) <= 4e-14 * area
    total = float((antiderivative(np.array([breaks[-1]])) - antiderivative(np.array([breaks[0]])))[0])
    assert integral.final == pytest.approx(total, abs=4e-14 * area)
    assert integral(np.array([float(breaks[0])]))[0] == pytest.approx(0.0, abs=1e-15 * area)


def test_integral_is_continuous_across_panels() -> None:
    integral = chebyshev.fitted(CASES["near pole"][0], [-1.0, 1.0]).integrated()
    inner = integral.breaks[1:-1]
    assert inner.size > 4  # the pole at 0.0063 i needs many panels
    gap = integral(inner) - integral(np.nextafter(inner, -2.0))
    assert np.max(np.abs(gap)) <= 1e-14  # the integral is at most 0.02; a rounding error of the argument moves it 1e-16


def test_a_point_at_a_break_takes_the_right_hand_limit() -> None:
    form = chebyshev.fitted(CASES["jump at a break"][0], [0, 1, 2])
    assert form(np.array([1.0]))[0] == pytest.approx(-3.0, rel=1e-15)
    assert form(np.array([np.nextafter(1.0, 0.0)]))[0] == pytest.approx(2.0, rel=1e-15)
    assert form.final == pytest.approx(-3.0, rel=1e-15)


def test_values_may_be_vectors_and_points_of_any_shape() -> None:
    def curve(x: Array) -> Array:
        return np.column_stack([np.cos(x), np.sin(3.0 * x), np.exp(-x)])

    form = chebyshev.fitted(curve, [0.0, 1.0, 5.0])
    points = (5.0 * ACROSS[:60]).reshape(3, 4, 5)
    assert form(points).shape == (3, 4, 5, 3)
    assert np.max(np.abs(form(points).reshape(-1, 3) - curve(points.ravel()))) <= 2e-14  # scale 1, as for single values
    assert form(np.float64(2.0)).shape == (3,)


@at_once("frequency", range(1, 26))
def test_every_frequency_is_resolved_whether_or_not_a_panel_just_fails_to(frequency: int) -> None:
    """A tail that counted as resolved too early would show at the frequency that just fits a panel."""
    form = chebyshev.fitted(lambda x: np.cos(frequency * x), [-1.0, 1.0])
    points = 2.0 * ACROSS - 1.0
    assert np.max(np.abs(form(points) - np.cos(frequency * points))) <= 2e-14  # tails of 4e-15 and their neighbours


def test_smooth_functions_need_no_more_than_a_few_panels() -> None:
    assert chebyshev.fitted(np.cos, [0.0, 3.0]).breaks.size == 2
    # One halving towards the pole each time its distance halves: log2(1/0.0063) = 7.3, on both sides
    assert chebyshev.fitted(CASES["near pole"][0], [-1.0, 1.0]).breaks.size < 40


def test_noise_of_the_function_is_not_chased() -> None:
    noise = np.random.default_rng(1)
    form = chebyshev.fitted(lambda x: np.sin(x) + 1e-13 * noise.standard_normal(x.shape), [0.0, 2.0])
    assert form.breaks.size < 200
    assert np.max(np.abs(form(2.0 * ACROSS) - np.sin(2.0 * ACROSS))) < 2e-12  # 20 noise widths: 25 noisy terms summed


@at_once(
    ("function", "at"),
    [
        (np.tan, np.pi / 2),
        (lambda x: np.sqrt(np.abs(x - 1.0)), 1.0),
        (lambda x: np.where(x < 1.7, 0.0, 1.0), 1.7),
        (lambda x: 1.0 / (x - 0.7), 0.7),
        (lambda x: np.abs(x - 0.9) + 1e-9 / np.abs(x - 0.9), 0.9),
    ],
)
def test_what_is_not_smooth_inside_a_piece_is_refused(function: Callable[[Array], Array], at: float) -> None:
    with pytest.raises(NotSmooth) as caught:
        chebyshev.fitted(function, [0.0, 2.0])
    assert caught.value.at == pytest.approx(at, abs=1e-3)


@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf])
def test_a_value_that_is_not_finite_is_refused_where_it_occurs(bad: float) -> None:
    with pytest.raises(NotSmooth) as caught:
        chebyshev.fitted(lambda x: np.where(np.abs(x - 0.6) < 0.1, bad, x), [0.0, 1.0])
    assert abs(caught.value.at - 0.6) < 0.1


def test_the_same_functions_are_fine_with_breaks_where_they_are_not_smooth() -> None:
    for step in (lambda x: np.where(x < 1.7, 0.0, 1.0), lambda x: np.abs(x - 1.7)):
        assert chebyshev.fitted(step, [0.0, 1.7, 2.0]).breaks.size == 3


def test_nodes_lie_inside_their_panels() -> None:
    left, right = np.array([0.0, 1.0]), np.array([1.0, 4.0])
    nodes = chebyshev.nodes(left, right, 10)
    assert nodes.shape == (11, 2)
    assert np.all((nodes > left) & (nodes < right))
    # Zeros of the Chebyshev polynomial of degree 11: cos((2 k + 1) pi / 22)
    exact = -np.cos((2.0 * np.arange(11) + 1.0) * np.pi / 22.0)
    assert np.allclose((nodes[:, 1] - 2.5) / 1.5, exact, rtol=0.0, atol=4e-16 * 4)


@at_once("degree", [1, 5, 24, 128])
def test_integration_matrix_is_exact_for_polynomials(degree: int) -> None:
    nodes = chebyshev.nodes(np.array([-1.0]), np.array([1.0]), degree).ravel()
    matrix = chebyshev.integration_matrix(degree)
    coefficients = np.random.default_rng(degree).standard_normal((degree + 1, 5))
    for column in coefficients.T:
        series = legendre.Legendre(column)  # a basis of its own, not the matrix's
        exact = series.integ(lbnd=-1)(nodes)
        # Sums of degree + 1 terms of size |column|: rounding grows with the degree
        assert np.max(np.abs(matrix @ series(nodes) - exact)) <= 1e-15 * (degree + 9) * np.abs(column).sum()


def test_integration_matrix_is_not_exact_beyond_its_degree() -> None:
    nodes = chebyshev.nodes(np.array([-1.0]), np.array([1.0]), 5).ravel()
    values = numpy_chebyshev.chebval(nodes, [0.0] * 6 + [1.0])
    exact = numpy_chebyshev.chebval(nodes, numpy_chebyshev.chebint([0.0] * 6 + [1.0], lbnd=-1))
    assert np.max(np.abs(chebyshev.integration_matrix(5) @ values - exact)) > 1e-3


@pytest.mark.parametrize("pieces", [1, 200])
def test_noise_is_given_up_before_millions_of_evaluations(pieces: int) -> None:
    random, asked = np.random.default_rng(0), 0

    def noise(points: Array) -> Array:
        nonlocal asked
        asked += points.size
        return 1.0 + 1e-9 * random.standard_normal(points.size)

    with pytest.raises(NotSmooth):
        chebyshev.fitted(noise, np.linspace(0.0, 1.0, pieces + 1))
    assert asked < 500_000


@pytest.mark.parametrize("pieces", [1, 20])
def test_five_thousand_waves_are_no_noise(pieces: int) -> None:
    form = chebyshev.fitted(lambda points: np.sin(1e4 * np.pi * points), np.linspace(0.0, 1.0, pieces + 1))
    points = np.linspace(0.0, 1.0, 1001)
    assert form(points) == pytest.approx(np.sin(1e4 * np.pi * points), abs=1e-10)


@at_once("lowest_at", [0.0, 0.31, 1.7, 2.0])
def test_function_falls_below_what_is_more_than_its_least_value(lowest_at: float) -> None:
    """0.4 + 1 - cos 30 (x - c) is 0.4 at c, inside a panel or at its end, and nowhere less."""
    form = chebyshev.fitted(lambda x: 1.4 - np.cos(30.0 * (x - lowest_at)), [0.0, 0.9, 2.0])
    assert chebyshev.falls_below(form.coefficients, 0.4 + 1e-13)
    assert not chebyshev.falls_below(form.coefficients, 0.4 - 1e-13)
    assert not chebyshev.falls_below(0.0 * form.coefficients, 0.0)


def test_polynomial_of_chebyshev_falls_to_minus_one() -> None:
    """T_8 alone: 1 at both ends, -1 at four places between."""
    alone = np.eye(9)[:, 8:]
    assert chebyshev.falls_below(alone, -1.0 + 1e-12)
    assert not chebyshev.falls_below(alone, -1.0 - 1e-12)
