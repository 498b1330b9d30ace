"""Extrema against calculus: inner ones, ends, double zeros of the derivative, and touching zeros."""

from __future__ import annotations

from collections.abc import Callable
from math import pi

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.polynomial import Polynomial

from at_once import at_once
from ncgear.numerics import jet
from ncgear.numerics.arrays import Array
from ncgear.numerics.extrema import bounds_on, extremes, extremes_on, grid_between, stationary_points
from ncgear.numerics.jet import Jet

ORDER = 2

# A zero of the derivative is found to some rounding errors of the argument; the value's error is its square.
AT, VALUE = 1e-12, 4e-15


def of_jet(function: Callable[[Jet], Jet]) -> Callable[[Array], Jet]:
    """A function of points from one of jets."""
    return lambda points: function(Jet.variable(points, ORDER))


def sine(scale: float = 1.0) -> Callable[[Array], Jet]:
    """sin(scale t)."""
    return of_jet(lambda t: jet.sin_cos(t * scale)[0])


def test_sine_over_a_turn() -> None:
    low, high = extremes(sine(), 0.0, 2.0 * pi)
    assert (low.value, high.value) == pytest.approx((-1.0, 1.0), abs=VALUE)
    assert (low.at, high.at) == pytest.approx((1.5 * pi, 0.5 * pi), abs=AT)


@at_once("count", [1, 5, 20, 60])
def test_every_sign_change_is_found(count: int) -> None:
    points = stationary_points(sine(count), 0.0, 2.0 * pi)
    exact = (np.arange(2 * count) + 0.5) * pi / count
    assert points[[0, -1]].tolist() == [0.0, 2.0 * pi]
    assert np.allclose(points[1:-1], exact, rtol=0.0, atol=AT)


def test_more_samples_separate_what_too_few_confound() -> None:
    """200 waves on 129 samples are aliased; with knots, and so with four more for each, every one is seen."""
    assert stationary_points(sine(200.0), 0.0, 2.0 * pi).size < 402
    assert stationary_points(sine(200.0), 0.0, 2.0 * pi, np.linspace(0.0, 2.0 * pi, 250)).size == 402


def test_a_peak_that_only_knots_near_it_show() -> None:
    """On a slope, a thousandth of the interval wide: two signs change between two of 129 even points."""
    bell = of_jet(lambda t: t * 0.1 + jet.exp((t - 0.9961) * (t - 0.9961) * -1e7))
    knots = 1.0 - 0.5 ** np.arange(1.0, 13.0)
    assert extremes(bell, 0.0, 1.0)[1].value == 0.1
    assert extremes(bell, 0.0, 1.0, knots)[1].value == pytest.approx(1.09961, abs=1e-6)


@pytest.mark.parametrize(("sign", "low_at", "high_at"), [(1.0, -1.0, 2.0), (-1.0, 2.0, -1.0)])
def test_monotonic_functions_are_extreme_at_their_ends(sign: float, low_at: float, high_at: float) -> None:
    low, high = extremes(of_jet(lambda t: sign * (t * t * t + t)), -1.0, 2.0)
    assert (low.at, high.at) == (low_at, high_at)
    assert {low.value, high.value} == {sign * -2.0, sign * 10.0}


def test_a_flat_inflection_is_no_sign_change_but_does_no_harm() -> None:
    """t^3 on [-1, 1]: the derivative touches zero at a sample, 0, and keeps its sign."""
    low, high = extremes(of_jet(lambda t: t * t * t), -1.0, 1.0)
    assert (low.value, high.value) == (-1.0, 1.0)


@pytest.mark.parametrize("shift", [0.0, 0.3, 1.0 / 64.0])
def test_quartic_minimum_with_a_triple_zero_of_the_derivative(shift: float) -> None:
    """On a sample (0, 1/64) or between samples (0.3)."""
    low, _ = extremes(of_jet(lambda t: (t - shift) * (t - shift) * (t - shift) * (t - shift)), -1.0, 1.0)
    assert low.value == pytest.approx(0.0, abs=1e-18)  # the triple zero is blurred to 1e-5 at worst: 1e-20
    assert low.at == pytest.approx(shift, abs=1e-4)


def test_an_inflection_exactly_on_a_sample_hides_nothing() -> None:
    """x^4 + x^3 / 64 on [-1.5, 1.5]: flat at the sample 0, least half a step before it."""
    low, _ = extremes(of_jet(lambda x: x * x * x * (x + 1.0 / 64.0)), -1.5, 1.5)
    assert low.at == pytest.approx(-3.0 / 256.0, rel=1e-6)
    assert low.value == pytest.approx(-27.0 / 256.0 / 64.0**4, rel=1e-9)


def test_an_extremum_exactly_on_a_sample_is_kept() -> None:
    """The derivative is exactly zero at the middle sample, so neither neighbouring product is negative."""
    low, high = extremes(of_jet(lambda t: t * t), -1.0, 1.0)
    assert (low.value, low.at, high.value) == (0.0, 0.0, 1.0)


def test_a_constant_is_its_own_extreme() -> None:
    low, high = extremes(of_jet(lambda t: t * 0.0 + 4.0), 0.0, 1.0)
    assert low.value == high.value == 4.0


@pytest.mark.parametrize(("low_at", "high_at"), [(0.5, 0.7), (0.101, 0.112)])
def test_a_pair_of_nearby_extrema(low_at: float, high_at: float) -> None:
    """x' = (x - a)(x - b); a minimum and a maximum of the negative, 1.4 samples apart in the second case."""
    antiderivative = -1.0 * Polynomial.fromroots([low_at, high_at]).integ()
    points = stationary_points(of_jet(lambda t: jet.polynomial(antiderivative.coef, t)), 0.0, 1.0)
    assert points[1:-1] == pytest.approx([low_at, high_at], abs=1e-11)  # slope of x' is 0.011: 100 rounding errors


@pytest.mark.slow
@settings(deadline=None, max_examples=40)
@given(st.lists(st.floats(-3.0, 3.0), min_size=3, max_size=7))
def test_no_sample_lies_outside_the_extremes(coefficients: list[float]) -> None:
    polynomial = Polynomial(coefficients)
    low, high = extremes(of_jet(lambda t: jet.polynomial(coefficients, t)), -1.5, 1.5)
    values = polynomial(np.linspace(-1.5, 1.5, 3001))
    # Two orders of evaluation round differently; terms of up to 3 * 1.5^6 cancel
    # Where the derivative changes its sign twice within a step, both extrema differ by its second derivative h^3 / 12.
    hidden = np.abs(polynomial.deriv(3)(np.linspace(-1.5, 1.5, 301))).max() * (3.0 / 128.0) ** 3 / 12.0
    slack = 1e-13 * (1.0 + np.abs(values).max()) + 1.1 * hidden
    assert values.min() >= low.value - slack
    assert values.max() <= high.value + slack
    assert polynomial(low.at) == pytest.approx(low.value, abs=slack)
    assert polynomial(high.at) == pytest.approx(high.value, abs=slack)


@pytest.mark.parametrize("width", [1e-2, 1e-4, 1e-6])
def test_a_narrow_swing_is_not_passed_by(width: float) -> None:
    """Extrema +-1/(2 width) at -+width from a place between two samples: the derivative changes its sign twice."""
    low, high = extremes(of_jet(lambda x: (x - 0.3) / ((x - 0.3) * (x - 0.3) + width**2)), 0.0, 1.0)
    assert low.value == pytest.approx(-0.5 / width, rel=1e-9)
    assert high.value == pytest.approx(0.5 / width, rel=1e-9)
    assert (low.at, high.at) == (
        pytest.approx(0.3 - width, abs=1e-6 * width),
        pytest.approx(0.3 + width, abs=1e-6 * width),
    )


def test_rounding_error_alone_is_not_sampled_more_finely() -> None:
    seen: list[int] = []

    def noise(points: Array) -> Jet:
        seen.append(points.size)
        return Jet(1e-16 * np.random.default_rng(points.size).standard_normal((2, points.size)))

    extremes(noise, 0.0, 1.0)
    assert max(seen) <= 129


@pytest.mark.parametrize("level", [0.0, 300.0])
def test_zeros_of_rounding_errors_are_not_sought(level: float) -> None:
    """A speed that cancels to a constant, or to zero, in a few looks; where it really changes, all of it is found."""
    seen: list[int] = []

    def speed(points: Array, rise: float) -> Jet:
        seen.append(points.size)
        t = Jet.variable(points, ORDER)
        root = jet.sqrt(t * 7.0 + 1.3)
        cancelled = (root * root - t * 7.0 - 1.3) / (t + 3.0) + level
        return cancelled + jet.sin_cos(t * 60.0)[0] * rise

    low, high = extremes(lambda points: speed(points, 0.0), 0.0, 1.0)
    assert len(seen) <= 4
    assert high.value - low.value <= 1e-15 * max(level, 1.0)
    waves = extremes(lambda points: speed(points, 1e-9), 0.0, 1.0)
    assert [one.value - level for one in waves] == pytest.approx([-1e-9, 1e-9], abs=2e-13)


def test_it_never_looks_beyond_the_ends() -> None:
    def guarded(points: Array) -> Jet:
        assert points.min() >= 0.25
        assert points.max() <= 1.75
        return jet.sin_cos(Jet.variable(points, ORDER) * 9.0)[0]

    extremes(guarded, 0.25, 1.75)


def test_extremes_of_several_functions_are_those_of_each() -> None:
    """One with many changes of sign, one with none and one with a single one, in any order."""
    functions = [
        lambda t: jet.sin_cos(t * 9.0)[0],
        lambda t: t * t * t + t,
        lambda t: (t - 0.3) * (t - 0.3),
    ]
    grid = grid_between(-1.0, 2.0, np.empty(0))
    for order in ([0, 1, 2], [2, 0, 1], [1]):
        chosen = [functions[number] for number in order]
        found = extremes_on(lambda at, chosen=chosen: [of_jet(function)(at) for function in chosen], grid)
        assert found == [extremes(of_jet(function), -1.0, 2.0) for function in chosen]
    both = extremes_on(lambda at: [of_jet(function)(at) for function in functions], grid)
    assert len({low.at for low, _ in both}) == 3


@settings(max_examples=60, deadline=None)
@given(st.floats(0.1, 40.0), st.floats(0.0, 6.0), st.floats(-2.0, 2.0))
def test_bounds_hold_every_value_or_are_infinite(scale: float, phase: float, lift: float) -> None:
    wave, grid = of_jet(lambda t: jet.sin_cos(t * scale + phase)[0] + lift), grid_between(0.0, 2.0 * pi, np.empty(0))
    low, high = bounds_on(grid, wave(grid))
    values = wave(np.linspace(0.0, 2.0 * pi, 20_011)).value
    assert low <= values.min()
    assert values.max() <= high
    # Waves of twenty samples are followed closely enough to tell something.
    assert scale > 6.0 or high - low <= 1.7 * np.ptp(values) + 1e-9


def test_samples_that_tell_too_little_bound_nothing() -> None:
    """A wave of five samples, a narrow peak that one sample meets, and what is no number."""
    grid = grid_between(0.0, 1.0, np.empty(0))
    peak = of_jet(lambda t: 1.0 / ((t - grid[41]) * (t - grid[41]) + 1e-6))
    nothing = Jet(np.full((2, grid.size), np.nan))
    for found in (sine(2.0 * pi * 26.0)(grid), peak(grid), nothing):
        assert bounds_on(grid, found) == (-np.inf, np.inf)
