"""Taylor arithmetic against mpmath's 40-digit Taylor coefficients, and its algebra."""

from __future__ import annotations

from collections.abc import Callable
from math import factorial
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from mpmath import mp
from numpy.polynomial import Polynomial

from at_once import at_once
from ncgear.numerics import jet
from ncgear.numerics.arrays import Array
from ncgear.numerics.jet import Jet

ORDER = 5

# Five recurrences on top of each other, each a sum of six products or fewer whose terms may be ten times the result:
# about 500 rounding errors of the largest coefficient.
ROUNDING = 1e-13

Case = tuple[Callable[[Jet], Jet], Callable[[Any], Any], float, float]

CASES: dict[str, Case] = {
    "negative": (lambda t: -t, lambda t: -t, -3, 3),
    "sum with number": (lambda t: t + 2.5, lambda t: t + 2.5, -3, 3),
    "number first": (lambda t: 2.5 + t, lambda t: 2.5 + t, -3, 3),
    "sum": (lambda t: t + t * t, lambda t: t + t**2, -3, 3),
    "difference": (lambda t: t * t - t, lambda t: t**2 - t, -3, 3),
    "difference with number": (lambda t: t * t - 0.75, lambda t: t**2 - 0.75, -3, 3),
    "number minus": (lambda t: 0.75 - t * t, lambda t: 0.75 - t**2, -3, 3),
    "product": (lambda t: (t + 1.0) * (t * t - 2.0) * t, lambda t: (t + 1) * (t**2 - 2) * t, -3, 3),
    "product with number": (lambda t: 3.0 * (t * t) * 0.5, lambda t: 1.5 * t**2, -3, 3),
    "quotient": (lambda t: (t * t + 1.0) / (t + 5.0), lambda t: (t**2 + 1) / (t + 5), -3, 3),
    "quotient by number": (lambda t: t * t / 8.0, lambda t: t**2 / 8, -3, 3),
    "reciprocal": (lambda t: 2.0 / (t * t + 1.0), lambda t: 2 / (t**2 + 1), -3, 3),
    "square root": (lambda t: jet.sqrt(t * t + t + 2.0), lambda t: mp.sqrt(t**2 + t + 2), -3, 3),
    "square root of the variable": (jet.sqrt, mp.sqrt, 0.5, 9),
    "sine": (lambda t: jet.sin_cos(t)[0], mp.sin, -7, 7),
    "cosine": (lambda t: jet.sin_cos(t)[1], mp.cos, -7, 7),
    "sine of a square": (lambda t: jet.sin_cos(t * t)[0], lambda t: mp.sin(t**2), -1, 1),
    "cosine of a quotient": (lambda t: jet.sin_cos(1.0 / t)[1], lambda t: mp.cos(1 / t), 1, 4),
    "inverse tangent": (jet.arctan, mp.atan, -3, 3),
    "inverse tangent of a product": (lambda t: jet.arctan(t * t - t), lambda t: mp.atan(t**2 - t), -2, 2),
    "polynomial": (lambda t: jet.polynomial([1.0, -2.0, 0.0, 0.5], t), lambda t: 1 - 2 * t + t**3 / 2, -3, 3),
    "constant polynomial": (lambda t: jet.polynomial([4.25], t), lambda t: mp.mpf(4.25) + 0 * t, -3, 3),
    "polynomial of a sine": (
        lambda t: jet.polynomial(np.array([0.0, 1.0, 0.0, 0.0, 0.0, 1.0, -2.0]), jet.sin_cos(t)[0]),
        lambda t: mp.sin(t) + mp.sin(t) ** 5 - 2 * mp.sin(t) ** 6,
        -3,
        3,
    ),
    "all of them": (
        lambda t: jet.arctan(jet.sqrt(t * t + 1.0) / (2.0 + jet.sin_cos(3.0 * t)[0])),
        lambda t: mp.atan(mp.sqrt(t**2 + 1) / (2 + mp.sin(3 * t))),
        -2,
        2,
    ),
}


def taylor(function: Callable[[Any], Any], points: Array) -> Array:
    """Taylor coefficients 0..ORDER at points, from mpmath; shape (ORDER + 1, n)."""
    with mp.workdps(40):
        return np.array([[float(c) for c in mp.taylor(function, mp.mpf(float(t)), ORDER)] for t in points]).T


def miss(found: Array, exact: Array) -> float:
    """Largest difference relative to the largest coefficient at the same point."""
    return float(np.max(np.abs(found - exact) / np.maximum(np.abs(exact).max(axis=0), 1e-3)))


@pytest.mark.judges("numerics")
@at_once("name", CASES)
def test_every_operation_has_the_exact_taylor_series(name: str) -> None:
    function, oracle, low, high = CASES[name]
    points = np.random.default_rng(7).uniform(low, high, 12)
    found = function(Jet.variable(points, ORDER)).coefficients
    assert found.shape == (ORDER + 1, 12)
    assert miss(found, taylor(oracle, points)) <= ROUNDING


@at_once("name", CASES)
def test_points_may_lie_in_an_array_of_more_axes(name: str) -> None:
    function, _, low, high = CASES[name]
    points = np.random.default_rng(7).uniform(low, high, (2, 3, 4))
    found = function(Jet.variable(points, ORDER)).coefficients
    assert np.array_equal(found.reshape(ORDER + 1, -1), function(Jet.variable(points.ravel(), ORDER)).coefficients)


def test_numbers_of_a_last_axis_belong_to_all_points_of_their_column() -> None:
    points, factors = np.array([[0.2], [0.7], [1.1]]), np.array([1.0, -2.0])
    t = Jet.variable(points, ORDER)
    found = (t * t + 1.0) / (t * factors + 5.0)
    for column, factor in enumerate(factors):
        one = Jet.variable(points[:, 0], ORDER)
        alone = (one * one + 1.0) / (one * factor + 5.0)
        assert np.array_equal(found.coefficients[:, :, column], alone.coefficients)


def test_the_comparison_would_see_a_wrong_fifth_derivative() -> None:
    points = np.array([0.3, 1.1])
    exact = taylor(mp.sin, points)
    wrong = jet.sin_cos(Jet.variable(points, ORDER))[0].coefficients.copy()
    wrong[ORDER] *= 1.0 + 1e-9
    assert miss(wrong, exact) > ROUNDING


@at_once("order", range(ORDER + 1))
def test_a_shorter_series_is_the_longer_one_cut(order: int) -> None:
    points = np.linspace(-2.0, 2.0, 9)
    function = CASES["all of them"][0]
    longer = function(Jet.variable(points, ORDER)).truncated(order)
    assert function(Jet.variable(points, order)).order == order
    assert np.array_equal(function(Jet.variable(points, order)).coefficients, longer.coefficients)


def test_derivative_is_coefficient_times_factorial() -> None:
    points = np.array([0.2, 1.9])
    cosine = jet.sin_cos(Jet.variable(points, ORDER))[1]  # derivatives cycle
    cycle = [np.cos(points), -np.sin(points), -np.cos(points), np.sin(points)]
    for k in range(ORDER + 1):
        assert np.allclose(cosine.derivative(k), cycle[k % 4], rtol=0.0, atol=ROUNDING)


def test_differentiated_and_integrated_are_inverse() -> None:
    series = CASES["all of them"][0](Jet.variable(np.linspace(-1.0, 1.0, 5), ORDER))
    back = series.differentiated().integrated(series.value)
    # k times a rounded quotient by k: one rounding error
    assert np.allclose(back.coefficients, series.coefficients, rtol=4e-16, atol=0.0)
    assert series.differentiated().order == ORDER - 1
    assert np.array_equal(series.differentiated().derivative(2), series.differentiated().coefficients[2] * 2.0)


def test_variable_of_order_zero_has_a_value_only() -> None:
    series = Jet.variable(3.0, 0)
    assert series.order == 0
    assert np.array_equal(series.value, [3.0])
    assert np.array_equal(jet.arctan(series).coefficients, [[np.arctan(3.0)]])


def test_joined_puts_compressed_parts_back_in_place() -> None:
    series = jet.sin_cos(Jet.variable(np.linspace(0.0, 6.0, 11), 4))[0]
    mask = np.arange(11) % 3 == 0
    parts = [(chosen, Jet(series.coefficients[:, chosen])) for chosen in (mask, ~mask)]
    assert parts[0][1].coefficients.shape == (5, 4)
    assert np.array_equal(jet.joined(parts).coefficients, series.coefficients)
    assert np.array_equal(jet.joined(parts[::-1]).coefficients, series.coefficients)


def test_joined_leaves_uncovered_points_undefined() -> None:
    series = Jet.variable(np.array([1.0, 2.0]), 1)
    mask = np.array([True, False])
    coefficients = jet.joined([(mask, Jet(series.coefficients[:, mask]))]).coefficients
    assert np.all(np.isnan(coefficients[:, 1]))
    assert np.array_equal(coefficients[:, 0], [1.0, 1.0])


SMALL = st.lists(st.floats(-2.0, 2.0), min_size=4, max_size=4)


@pytest.mark.slow
@settings(deadline=None)
@given(SMALL, SMALL, st.floats(-1.5, 1.5))
def test_products_of_polynomials_are_polynomials(first: list[float], second: list[float], point: float) -> None:
    variable = Jet.variable(point, 6)
    found = jet.polynomial(first, variable) * jet.polynomial(second, variable)
    product = Polynomial(first) * Polynomial(second)
    exact = [float(product.deriv(k)(point)) / factorial(k) if k else float(product(point)) for k in range(7)]
    # Seven-term sums of products up to 2 * 1.5^3 * 4 each: the absolute scale is some hundreds
    assert np.allclose(found.coefficients[:, 0], exact, rtol=0.0, atol=1e-12)


@pytest.mark.slow
@settings(deadline=None)
@given(SMALL, st.floats(-1.5, 1.5))
def test_square_root_and_division_undo_multiplication(coefficients: list[float], point: float) -> None:
    series = jet.polynomial(coefficients, Jet.variable(point, ORDER))
    positive = series * series + 1.0
    root = jet.sqrt(positive)
    scale = float(np.abs(positive.coefficients).max()) * float(np.abs(root.coefficients).max())
    # Products return what the recurrences solved for; both round in the scale of the largest partial product
    assert np.allclose((root * root).coefficients, positive.coefficients, rtol=0.0, atol=ROUNDING * scale)
    assert np.allclose((positive / root).coefficients, root.coefficients, rtol=0.0, atol=ROUNDING * scale)


@pytest.mark.slow
@settings(deadline=None)
@given(SMALL, st.floats(-1.5, 1.5))
def test_sine_and_cosine_squares_add_to_one(coefficients: list[float], point: float) -> None:
    sine, cosine = jet.sin_cos(jet.polynomial(coefficients, Jet.variable(point, ORDER)))
    total = (sine * sine + cosine * cosine).coefficients[:, 0]
    scale = 1.0 + max(float(np.abs(part.coefficients).max()) ** 2 for part in (sine, cosine))
    assert np.allclose(total, [1.0] + [0.0] * ORDER, rtol=0.0, atol=ROUNDING * scale)


@pytest.mark.parametrize("exponent", [1.5, 2.5, 0.5])
def test_a_power_at_zero_has_the_derivatives_that_exist(exponent: float) -> None:
    with np.errstate(all="ignore"):
        power = Jet.variable(np.zeros(1), 3) ** exponent
    assert power.coefficients[:, 0].tolist() == [0.0 if k < exponent else np.inf for k in range(4)]


def test_hyperbolic_functions_near_zero_and_far_from_it() -> None:
    """The difference of exponentials loses all digits at 1e-12, and tanh by exp(2 u) overflows at 400."""
    for point in (1e-12, 0.3, -2.0, 20.0, 400.0, -9000.0):
        found = jet.tanh(Jet.variable(np.array([point]), 3)).coefficients[:, 0]
        with mp.workdps(40):
            exact = (
                [float(c) for c in mp.taylor(mp.tanh, mp.mpf(point), 3)]
                if abs(point) < 30
                else [np.sign(point), 0, 0, 0]
            )
        assert found == pytest.approx(exact, rel=1e-13, abs=1e-15)
    sine, cosine = jet.sinh_cosh(Jet.variable(np.array([1e-12]), 2))
    assert sine.coefficients[:, 0] == pytest.approx([1e-12, 1.0, 5e-13], rel=1e-14)
    assert cosine.coefficients[:, 0] == pytest.approx([1.0, 1e-12, 0.5], rel=1e-14)
