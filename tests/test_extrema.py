"""Extrema against calculus: inner ones, ends, double zeros of the derivative, and touching zeros."""

from __future__ import annotations

from collections.abc import Callable
from math import pi

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.polynomial import Polynomial

from ncgear.numerics import jet
from ncgear.numerics.arrays import Array
from ncgear.numerics.extrema import extremes, extremes_on, stationary_on, stationary_points
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


def test_extremes_between_given_places() -> None:
    """Places as dense as the waves are find all of them; even ones pass over those that crowd at one end."""
    waves = of_jet(lambda t: jet.sin_cos(jet.exp(t * 7.0))[0])
    places = np.log(np.linspace(1.0, 1000.0, 4001)) / 7.0
    low, high = extremes_on(waves, places)
    assert (low.value, high.value) == pytest.approx((-1.0, 1.0), abs=VALUE)
    found = stationary_on(waves, places)
    # Odd multiples of pi / 2 between 1 and 1000, and both ends
    assert found.size == 2 + int(1000.0 / pi + 0.5)
    assert stationary_points(waves, 0.0, places[-1]).size < found.size


@pytest.mark.parametrize("count", [1, 5, 20, 60])
def test_every_sign_change_is_found(count: int) -> None:
    points = stationary_points(sine(count), 0.0, 2.0 * pi)
    exact = (np.arange(2 * count) + 0.5) * pi / count
    assert points[[0, -1]].tolist() == [0.0, 2.0 * pi]
    assert np.allclose(points[1:-1], exact, rtol=0.0, atol=AT)


def test_more_samples_separate_what_too_few_confound() -> None:
    """200 waves on 129 samples are aliased; on 1001 every one is seen."""
    assert stationary_points(sine(200.0), 0.0, 2.0 * pi).size < 402
    assert stationary_points(sine(200.0), 0.0, 2.0 * pi, samples=1001).size == 402


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


@settings(deadline=None, max_examples=40)
@given(st.lists(st.floats(-3.0, 3.0), min_size=3, max_size=7))
def test_no_sample_lies_outside_the_extremes(coefficients: list[float]) -> None:
    polynomial = Polynomial(coefficients)
    low, high = extremes(of_jet(lambda t: jet.polynomial(coefficients, t)), -1.5, 1.5)
    values = polynomial(np.linspace(-1.5, 1.5, 3001))
    # Two orders of evaluation round differently; terms of up to 3 * 1.5^6 cancel
    slack = 1e-13 * (1.0 + np.abs(values).max())
    assert values.min() >= low.value - slack
    assert values.max() <= high.value + slack
    assert polynomial(low.at) == pytest.approx(low.value, abs=slack)
    assert polynomial(high.at) == pytest.approx(high.value, abs=slack)


def test_it_never_looks_beyond_the_ends() -> None:
    def guarded(points: Array) -> Jet:
        assert points.min() >= 0.25
        assert points.max() <= 1.75
        return jet.sin_cos(Jet.variable(points, ORDER) * 9.0)[0]

    extremes(guarded, 0.25, 1.75)
