"""First zeros on many intervals: against roots known in closed form, with jumps, touches and none at all."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.polynomial import chebyshev

from at_once import at_once
from ncgear.numerics.zeros import _first_zeros_of_series, first_zeros

Array = np.ndarray
Function = Callable[[Array], Array]


def first_zero(function: Function, *cuts: float) -> float:
    """Of a single function between the first and the last cut."""
    return float(first_zeros(lambda i, t: function(t), [np.array(cuts)])[0])


@at_once(
    ("function", "end", "expected"),
    [
        (np.cos, 20.0, np.pi / 2.0),
        (lambda t: np.exp(-t) - 0.25, 5.0, np.log(4.0)),
        (lambda t: 1.0 - t**3, 1.5, 1.0),
        (lambda t: (t - 0.3) * (t - 0.31) * (t - 2.0) * -1.0, 3.0, 0.3),
        (lambda t: np.cos(40.0 * t) + 1.0 - t, 3.0, None),
        (lambda t: 1.0 / (1.0 + 100.0 * (t - 1.0) ** 2) - 0.5, 3.0, 0.0),
    ],
)
def test_first_zero_is_the_closed_form(function: Function, end: float, expected: float | None) -> None:
    found = first_zero(function, 0.0, end)
    if expected is None:  # no closed form: the function is zero there and positive at 100 000 places before
        assert abs(function(np.array(found))) < 1e-12
        assert function(np.linspace(0.0, found - 1e-9, 100_000)).min() > 0.0
    else:
        assert found == pytest.approx(expected, abs=1e-13)


@pytest.mark.parametrize("function", [lambda t: 1.0 + t**2, lambda t: np.exp(-t), lambda t: np.cos(t) + 1.001])
def test_end_of_the_interval_where_the_function_stays_positive(function: Function) -> None:
    assert first_zero(function, 0.0, 10.0) == 10.0


def test_a_touch_counts_as_zero_and_a_near_miss_does_not() -> None:
    """A double zero is known to the square root of rounding; a parabola 1e-6 above zero is none."""
    assert first_zero(lambda t: (t - 0.7) ** 2, 0.0, 2.0) == pytest.approx(0.7, abs=1e-6)
    assert first_zero(lambda t: (t - 0.7) ** 2 + 1e-6, 0.0, 2.0) == 2.0


def test_a_jump_to_negative_values_is_a_zero_at_the_cut() -> None:
    def steps(t: Array) -> Array:
        return np.where(t < 1.0, 2.0 - t, -1.0)

    assert first_zero(steps, 0.0, 1.0, 3.0) == 1.0


def test_a_jump_over_zero_and_back_is_seen_however_short() -> None:
    def dip(t: Array) -> Array:
        return np.where((t > 1.0) & (t < 1.0 + 1e-6), -1.0, 1.0)

    assert first_zero(dip, 0.0, 1.0, 1.0 + 1e-6, 3.0) == 1.0


def test_a_zero_before_a_jump_is_the_first() -> None:
    def kinked(t: Array) -> Array:
        return np.where(t < 1.0, 0.5 - t, 1.0)

    assert first_zero(kinked, 0.0, 1.0, 3.0) == pytest.approx(0.5, abs=1e-14)


def test_many_intervals_are_each_searched_by_themselves() -> None:
    """Zero of interval i at sqrt(i), of those with cuts elsewhere too; some have none."""
    number = np.arange(1, 40)
    cuts = [np.array([0.0, 5.0]) if i % 2 else np.array([0.0, 1.3, 2.6, 5.0]) for i in number]
    found = first_zeros(lambda i, t: number[i] - t**2, cuts)
    assert found == pytest.approx(np.minimum(np.sqrt(number), 5.0), abs=1e-13)


def test_intervals_may_run_backwards() -> None:
    assert first_zero(lambda t: 1.0 + t, 0.0, -2.0) == pytest.approx(-1.0, abs=1e-14)


@pytest.mark.slow
@given(st.lists(st.floats(0.05, 2.9), min_size=1, max_size=4), st.floats(0.1, 10.0))
def test_smallest_root_of_a_polynomial_with_known_roots(roots: list[float], scale: float) -> None:
    """A polynomial is the product of its roots' distances, times what makes it positive at the start."""
    spread = np.sort(roots)
    if spread.size > 1 and np.diff(spread).min() < 0.01:
        return  # nearly double: known to the square root of rounding only, as tested above

    def product(t: Array) -> Array:
        return scale * np.prod(np.subtract.outer(spread, t), axis=0) * np.sign(np.prod(spread))

    assert first_zero(product, 0.0, 3.0) == pytest.approx(spread[0], abs=1e-9)


def test_a_dip_between_samples_is_found() -> None:
    """Negative control of sampling: a dip that 41 even samples do not see."""

    def dip(t: Array) -> Array:
        return 1.0 - 1.5 * np.exp(-(((t - 1.2345) / 0.02) ** 2))

    assert dip(np.linspace(0.0, 3.0, 41)).min() > 0.5
    assert first_zero(dip, 0.0, 3.0) == pytest.approx(1.2345 - 0.02 * np.sqrt(np.log(1.5)), abs=1e-12)


@pytest.mark.judges("numerics")
def test_first_zeros_of_series_are_the_least_of_all_their_roots() -> None:
    """Eigenvalues of companion matrices tell all roots of series, in their middles, at ends, double ones and none.

    The negative control: the series' last roots are others.
    """
    noise, several = np.random.default_rng(5), 0
    for degree in (3, 8, 24):
        decay = 0.6 ** np.arange(degree + 1.0)
        series = noise.normal(size=(degree + 1, 300)) * decay[:, None]
        series[0] += noise.uniform(0.0, 2.0, 300)
        found = _first_zeros_of_series(series)
        for column, place in zip(series.T, found, strict=True):
            roots = chebyshev.chebroots(column)
            real = np.sort(roots.real[(np.abs(roots.imag) < 1e-12) & (np.abs(roots.real) <= 1.0)])
            if chebyshev.chebval(-1.0, column) <= 0.0:
                assert place == -1.0
            elif not real.size:
                assert np.isnan(place)
            else:
                assert place == pytest.approx(real[0], abs=1e-11)
                several += real.size > 1 and abs(place - real[-1]) > 1e-3
    assert several > 50
