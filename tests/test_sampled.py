"""Many functions by their values at Chebyshev points: integrals, extrema and tails, against closed forms."""

from __future__ import annotations

import numpy as np
import pytest

from ncgear.numerics.arrays import Array, Mask
from ncgear.numerics.sampled import Functions, Sought, extremes, integration, shares

COUNTS = (24, 33, 64)


def both_ends(values: Array, there: Mask) -> tuple[Array, Array]:
    """Smallest and largest value of the functions of owners (shape (n, p, count)) that are there, shape (n, p)."""
    functions = Functions(np.moveaxis(values, 0, -1))
    low, high, largest = extremes([Sought(functions, there.T, signs) for signs in ((-1.0,), (1.0,), (1.0, -1.0))])
    assert largest == pytest.approx(np.maximum(low, high), rel=1e-15)
    return -low, high


def alone(values: Array) -> tuple[Array, Array]:
    """The extremes of each function (shape (n, count)) by itself."""
    return both_ends(values[:, None], np.ones((len(values), 1), dtype=bool))


def tails(values: Array) -> Array:
    """The largest last coefficient of functions, shape (p, count)."""
    return Functions(values[..., None]).tails[:, 0]


@pytest.mark.parametrize("count", COUNTS)
def test_integrals_are_those_of_the_closed_form(count: int) -> None:
    t = shares(count)
    rate = np.linspace(0.5, 6.0, 7)[:, None]
    found = np.exp(-rate * t) @ integration(count).T
    assert found == pytest.approx((1.0 - np.exp(-rate * t)) / rate, rel=1e-13, abs=1e-15)


@pytest.mark.parametrize("count", COUNTS)
def test_extremes_between_the_points_are_exact(count: int) -> None:
    """A wave of one crest and one trough somewhere inside: plus and minus one, wherever they lie."""
    phase = np.linspace(0.0, 6.0, 200)[:, None]
    low, high = alone(np.sin(2.0 * np.pi * shares(count) + phase))
    assert np.abs(low + 1.0).max() < 1e-13
    assert np.abs(high - 1.0).max() < 1e-13


def test_an_owner_of_several_functions_has_the_extremes_of_all() -> None:
    t = shares(33)
    values = np.stack([[t * (1.0 - t), 0.5 * np.cos(3.0 * t)], [t - 3.0, 0.0 * t + 2.0]])
    low, high = both_ends(values, np.ones((2, 2), dtype=bool))
    assert low == pytest.approx([0.5 * np.cos(3.0), -3.0], rel=1e-14)
    assert high == pytest.approx([0.5, 2.0], rel=1e-14)


def test_a_top_that_is_lower_than_another_functions_end_does_not_count() -> None:
    t = shares(33)
    values = np.stack([t * (1.0 - t), 0.3 - 0.1 * t])[None, :]
    assert both_ends(values, np.ones((1, 2), dtype=bool))[1] == pytest.approx([0.3], rel=1e-14)


def test_a_function_that_is_not_there_does_not_count() -> None:
    t = shares(33)
    values = np.stack([[t, np.full(33, np.nan)], [t + 5.0, np.full(33, np.inf)]])
    with np.errstate(invalid="ignore"):
        low, high = both_ends(values, np.array([[True, False], [False, False]]))
    assert low.tolist() == pytest.approx([0.0, np.inf], abs=1e-15)
    assert high.tolist() == [1.0, -np.inf]


@pytest.mark.parametrize("count", COUNTS)
def test_the_highest_top_is_found_among_functions_that_nearly_reach_it(count: int) -> None:
    """Nine waves whose tops differ by less than what samples miss of them, against the values at very many places."""
    random = np.random.default_rng(5)
    turns, phase = random.uniform(0.5, count / 12.0, (80, 9, 1)), random.uniform(0.0, 6.3, (80, 9, 1))
    size = 1.0 + 1e-4 * random.standard_normal((80, 9, 1))

    def at(places: Array) -> Array:
        return size * np.cos(turns * 2.0 * np.pi * places + phase)

    assert (tails(at(shares(count)).reshape(720, count)) < 1e-7).all()
    some = np.broadcast_to(np.arange(9) < 4, (80, 9))
    low, high = both_ends(at(shares(count)), np.ones((80, 9), dtype=bool))
    assert (both_ends(at(shares(count)), some)[1] <= high + 1e-12).all()
    many = at(np.linspace(0.0, 1.0, 4001))
    assert (high >= many.max(axis=(1, 2)) - 1e-7).all()
    assert (low <= many.min(axis=(1, 2)) + 1e-7).all()
    assert (high <= many.max(axis=(1, 2)) + 1e-4).all()


def test_a_limit_between_the_samples_and_the_top_is_told_apart() -> None:
    """A top of exactly 1 between two points, whose samples are all under 0.999: over 0.9999, not over 1.0001."""
    values = np.sin(np.pi * shares(33)[:, None] ** 1.5)[None] * 1.0
    functions, there = Functions(values), np.ones((1, 1), dtype=bool)
    assert values.max() < 0.9999
    found = extremes([Sought(functions, there, (1.0,), limit) for limit in (0.9, 0.99999, 1.0001)])
    assert [float(one[0]) > limit for one, limit in zip(found, (0.9, 0.99999, 1.0001), strict=True)] == [
        True,
        True,
        False,
    ]


def test_constants_and_rounding_errors_have_extremes() -> None:
    rough = 5.0 + 1e-15 * np.random.default_rng(3).standard_normal((50, 65))
    low, high = alone(rough)
    assert np.abs(low - 5.0).max() < 1e-13
    assert np.abs(high - 5.0).max() < 1e-13


def test_samples_alone_would_miss_the_top() -> None:
    """What the refinement is for: the largest sample of a wave is lower by a tenth of a percent."""
    values = np.sin(2.0 * np.pi * shares(33) + np.linspace(0.0, 6.0, 200)[:, None])
    assert np.abs(values.max(axis=1) - 1.0).max() > 1e-3


def test_tails_fall_with_the_count_and_show_what_is_not_resolved() -> None:
    runge = [float(tails(0.01 / (0.01 + (shares(count) - 0.5) ** 2)[None])[0]) for count in (17, 33, 65, 129)]
    assert runge[0] > 1e-2
    # Bernstein ellipse of the pole at 0.5 + 0.1i: rho = 0.2 + sqrt(1.04) a coefficient.
    assert runge[2] / runge[1] == pytest.approx((0.2 + 1.04**0.5) ** -32, rel=0.5)
    assert runge[3] < 1e-10


@pytest.mark.parametrize("wrong", [np.nan, np.inf])
def test_tails_of_what_is_not_finite_are_infinite(wrong: float) -> None:
    values = np.ones((2, 33))
    values[0, 4] = wrong
    assert tails(values).tolist() == [np.inf, pytest.approx(0.0, abs=1e-15)]
    assert Functions(values[..., None]).size[1, 0] == 1.0
