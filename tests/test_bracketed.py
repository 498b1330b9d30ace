"""Zeros in many brackets at once: against closed forms, hard functions, and a bracket without a zero."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from at_once import at_once
from ncgear.errors import Unanswered
from ncgear.numerics.arrays import Array
from ncgear.numerics.zeros import zeros_between, zeros_by_slope


def test_many_zeros_at_once() -> None:
    low = np.arange(50) * np.pi + 0.3
    found = zeros_between(np.sin, low, low + 3.0)
    assert np.max(np.abs(found - np.arange(1, 51) * np.pi)) <= 1e-13  # 157 and its rounding


@pytest.mark.judges("numerics")
@at_once(
    ("function", "low", "high", "zero"),
    [
        (lambda t: t**9, -1.0, 4.0, 0.0),
        (lambda t: np.exp(50.0 * (t - 1.0)) - 1.0, -3.0, 1.5, 1.0),
        (np.sign, -1.0, 0.7, 0.0),
        (lambda t: np.where(t < 0.3, -1e-12, 1e12), 0.0, 1.0, 0.3),
        (lambda t: t - 0.25, 0.25, 1.0, 0.25),
        (lambda t: 1.0 / (t - 2.0) + 1.0, -5.0, 1.5, 1.0),
    ],
)
def test_hard_functions(function: Callable[[Array], Array], low: float, high: float, zero: float) -> None:
    for ends in ((low, high), (high, low)):
        found = zeros_between(function, *(np.array([end]) for end in ends))
        # Nothing is demanded beyond the function's own digits: t^9 is below the smallest number for t < 1e-36
        assert found[0] == pytest.approx(zero, abs=1e-15)


def test_few_evaluations_are_needed() -> None:
    calls = []

    def counted(points: Array) -> Array:
        calls.append(points.size)
        return np.cos(points)

    zeros_between(counted, np.linspace(0.0, 1.0, 20), np.linspace(2.0, 3.0, 20))
    assert len(calls) <= 12


def test_nothing_to_look_for_is_nothing_found() -> None:
    assert zeros_between(np.sin, np.empty(0), np.empty(0)).size == 0


@pytest.mark.parametrize("low", [0.3, 3.2])
def test_a_bracket_without_a_change_of_sign_is_refused(low: float) -> None:
    """The negative control: beside a bracket that holds a zero, too."""
    with pytest.raises(Unanswered, match="different signs"):
        zeros_between(np.sin, np.array([3.0, low]), np.array([4.0, low + 2.0]))


def test_a_zero_at_an_end_is_found_though_rounding_errors_hide_it() -> None:
    for shift, end in ((1e-13, 1.0), (-1e-13, 2.0)):
        found = zeros_between(lambda at, zero=end, off=shift: at - zero + off, np.array([1.0]), np.array([2.0]))
        assert found == pytest.approx([end], abs=1e-12)
    with pytest.raises(Unanswered, match="different signs"):
        zeros_between(lambda at: at - 1.0 + 1e-7, np.array([1.0]), np.array([2.0]))


@pytest.mark.parametrize("jump", [0.3, 0.777, 0.999999])
def test_an_infinite_value_halves_the_bracket(jump: float) -> None:
    """What falls to minus infinity: the point beside the jump at which it is finite; elsewhere its own zero."""
    place = np.array([jump, 2.0])

    def function(at: np.ndarray) -> np.ndarray:
        return np.where(at < place, 1.5 - at, -np.inf)

    found = zeros_between(function, np.zeros(2), np.array([1.0, 1.9]))
    assert found == pytest.approx([jump, 1.5], rel=1e-14)
    assert found[0] < jump
    with pytest.raises(Unanswered, match="different signs"):
        zeros_between(lambda at: np.full(at.shape, -np.inf), np.zeros(1), np.ones(1))


def test_a_search_without_answer_numbers_its_brackets() -> None:
    with pytest.raises(Unanswered) as refused:
        zeros_between(np.sin, np.array([3.0, 0.3, 6.0, 1.0]), np.array([4.0, 2.0, 6.5, 1.1]))
    assert refused.value.rows == (1, 3)
    assert "0.3 and 2" in str(refused.value)


def test_a_function_that_is_no_number_has_no_zero() -> None:
    with pytest.raises(Unanswered, match="no zero"):
        zeros_between(lambda points: points * np.nan, np.zeros(2), np.ones(2))


@at_once("seed", range(4))
def test_a_zero_that_is_found_early_stays_while_others_are_sought(seed: int) -> None:
    """Functions that are themselves solved for have digits that vary.

    Steps in a bracket that was narrow already led out of it then, and to where there is no number.
    """
    noise, tried = np.random.default_rng(seed), []
    zero = noise.uniform(0.2, 0.8, 200)
    low, high = np.zeros(200), np.ones(200)

    def function(points: Array) -> Array:
        tried.append(points)
        values = np.tanh(points - zero) + noise.normal(0.0, 1e-16, 200)
        values[-1] = (points[-1] - zero[-1]) ** 9
        return values

    found = zeros_between(function, low, high)
    assert len(tried) > 40  # the last one is slow, the others need a dozen steps
    assert np.max(np.abs(found - zero)[:-1]) <= 1e-15


# --- by Newton's method ------------------------------------------------------------------------------------------

WITHIN = 1e-12


def by_slope(function: Callable[[Array], Array], slope: Callable[[Array], Array], good: float, bad: float) -> float:
    ends = np.array([good]), np.array([bad])
    values = function(ends[0]), function(ends[1])
    return float(zeros_by_slope(lambda at, _: (function(at), slope(at)), *ends, values, WITHIN)[0])


@pytest.mark.judges("numerics")
@at_once(
    ("function", "slope", "good", "bad"),
    [
        (np.cos, lambda t: -np.sin(t), 0.0, 3.0),
        (lambda t: 1.0 - t**9, lambda t: -9.0 * t**8, 0.0, 4.0),
        (lambda t: np.exp(50.0 * (t - 1.0)) - 1.0, lambda t: 50.0 * np.exp(50.0 * (t - 1.0)), 1.5, -3.0),
        (lambda t: 2.0 - t - 3.0 * np.abs(t - 0.6), lambda t: -1.0 - 3.0 * np.sign(t - 0.6), 0.5, 2.0),
    ],
)
def test_places_beside_zeros_by_slope_are_those_of_bisection(
    function: Callable[[Array], Array], slope: Callable[[Array], Array], good: float, bad: float
) -> None:
    """Bisection to the last digit; values are positive at the places, by twice what is asked for at most."""
    found = by_slope(function, slope, good, bad)
    low, high = good, bad
    for _ in range(200):
        middle = (low + high) / 2.0
        low, high = (middle, high) if function(np.array(middle)) > 0.0 else (low, middle)
    assert 0.0 <= function(np.array(found)) <= 2.0 * WITHIN
    assert found == pytest.approx(low, abs=5e-12)


def test_slopes_that_are_wrong_cost_steps_but_no_digits() -> None:
    """The negative control of the slopes: of the wrong sign, zero, and no number at all."""
    for wrong in (np.sin, np.zeros_like, lambda t: t * np.nan):
        assert by_slope(np.cos, wrong, 0.0, 3.0) == pytest.approx(np.pi / 2.0, abs=3e-12)


def test_beside_a_jump_the_place_is_on_the_side_that_is_not_negative() -> None:
    """What is no number counts as beyond the zero."""
    jump = by_slope(lambda t: np.where(t <= 0.3, 1.0, -1.0), np.zeros_like, 0.0, 1.0)
    assert 0.3 - 1e-15 <= jump <= 0.3
    with np.errstate(invalid="ignore"):
        lost = by_slope(lambda t: np.sqrt(0.3 - t) + 1.0, np.zeros_like, 0.0, 1.0)
    assert 0.3 - 1e-15 <= lost <= 0.3


def test_each_bracket_is_closed_in_on_by_itself() -> None:
    """Brackets are numbered; those whose zero is found are not asked for any more."""
    zero, asked = np.linspace(0.1, 0.9, 50), []

    def function(at: Array, row: Array) -> tuple[Array, Array]:
        asked.append(row.size)
        power = np.where(row == 7, 5, 1)
        return (zero[row] - at) ** power, -power * (zero[row] - at) ** (power - 1)

    ends = np.zeros(50), np.ones(50)
    found = zeros_by_slope(function, *ends, tuple(function(end, np.arange(50))[0] for end in ends), WITHIN)
    assert np.max(np.abs(found - zero)[np.arange(50) != 7]) <= 2.0 * WITHIN
    assert 0.0 <= zero[7] - found[7] <= (2.0 * WITHIN) ** 0.2
    assert asked[-1] == 1


def test_a_bracket_whose_ends_have_one_sign_is_refused_by_slope() -> None:
    with pytest.raises(Unanswered, match="different signs"):
        by_slope(np.cos, lambda t: -np.sin(t), 0.0, 1.0)
