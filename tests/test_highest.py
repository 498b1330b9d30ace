"""The largest values of functions without derivatives, against closed forms and mpmath."""

from __future__ import annotations

from math import pi, sqrt

import mpmath
import numpy as np
import pytest

from ncgear.errors import Unanswered
from ncgear.numerics.highest import largest_from, largest_of_each

Array = np.ndarray


@pytest.mark.thorough
def test_tops_of_several_functions_at_once() -> None:
    """A wave, a parabola that falls throughout from its end, one that is even, and one with its top at a sample."""

    def functions(x: Array) -> Array:
        return np.stack([np.sin(x) + 0.1 * np.sin(7.0 * x), -(x**2), np.full(x.shape, 2.5), 3.0 - np.abs(x - 1.0)])

    places = np.sort(np.append(np.linspace(0.0, 2.0 * pi, 60), 1.0))
    wave, falling, even, kinked = largest_of_each(functions, places)
    with mpmath.workdps(30):
        at = mpmath.findroot(lambda x: mpmath.cos(x) + mpmath.mpf("0.7") * mpmath.cos(7 * x), wave.at)
        top = mpmath.sin(at) + mpmath.mpf("0.1") * mpmath.sin(7 * at)
    assert wave.value == pytest.approx(float(top), rel=1e-10)
    assert wave.at == pytest.approx(float(at), abs=1e-5)
    others = max(float(np.sin(x) + 0.1 * np.sin(7.0 * x)) for x in np.linspace(0.0, 2.0 * pi, 100_003))
    assert wave.value >= others - 1e-9
    assert (falling.value, falling.at) == (0.0, 0.0)
    assert even.value == 2.5
    assert (kinked.value, kinked.at) == (3.0, 1.0)


@pytest.mark.parametrize("place", [0.3333, 0.777777, 0.5000001])
def test_tops_with_a_kink_a_cusp_and_a_jump(place: float) -> None:
    """None has a slope of zero at its top; at the jump the limit from below counts."""

    def functions(x: Array) -> Array:
        away = np.abs(x - place)
        return np.stack([1.0 - away, 1.0 - np.sqrt(away), np.where(x < place, x, 0.0)])

    kink, cusp, jump = largest_of_each(functions, np.linspace(0.0, 1.0, 21))
    assert kink.value == pytest.approx(1.0, abs=1e-9)
    assert cusp.value == pytest.approx(1.0, abs=1e-5)
    assert jump.value == pytest.approx(place, abs=1e-9)
    assert jump.at < place


def test_what_stays_below_a_known_value_is_not_searched() -> None:
    """A top just above the value is found between the samples; a value above the top costs no evaluation."""
    places, asked = np.arange(0.0, 10.0, 0.2), list[int]()

    def function(x: Array) -> Array:
        asked.append(x.size)
        return np.exp(-((x - 7.1) ** 2))[None]

    values = function(places)
    for above, told in ((0.999, 1.0), (1.5, 1.5)):
        asked.clear()
        (top,) = largest_from(function, places, values, np.zeros(1), above)
        assert top.value == pytest.approx(told, abs=1e-9)
        assert (asked == []) == (above > 1.0)


def test_the_higher_of_two_tops_is_found_though_its_samples_are_lower() -> None:
    """The second wave is higher by a thousandth, and its nearest sample is farther from its top."""

    def functions(x: Array) -> Array:
        return np.exp(-((x - 2.0) ** 2))[None] + 1.001 * np.exp(-((x - 7.1) ** 2))

    places = np.arange(0.0, 10.0, 0.2)
    assert functions(places)[0].argmax() == 10
    assert largest_of_each(functions, places)[0].at == pytest.approx(7.1, abs=1e-4)


def test_many_places_are_looked_at_block_by_block() -> None:
    places = np.linspace(0.0, 1.0, 10_000)
    sizes = []

    def functions(x: Array) -> Array:
        sizes.append(x.size)
        return -((x[None] - sqrt(0.5)) ** 2)

    assert largest_of_each(functions, places)[0].at == pytest.approx(sqrt(0.5), abs=1e-6)
    assert max(sizes) < 4096


def test_what_is_between_samples_is_not_seen() -> None:
    """Negative control of the places: a spike that no sample meets adds nothing, one that a sample meets is found."""

    def functions(x: Array) -> Array:
        return np.exp(-(((x[None] - 0.512) / 1e-5) ** 2))

    places = np.linspace(0.0, 1.0, 101)
    assert largest_of_each(functions, places)[0].value < 1e-9
    assert largest_of_each(functions, np.union1d(places, [0.512004]))[0].value == pytest.approx(1.0, rel=1e-9)


def test_a_function_of_rounding_errors_is_refused_at_once() -> None:
    """Scatter of 1e-8, which differs from one number to the next; known to 1e-7, the same function has an answer."""
    places, looked_at = np.linspace(0.0, 1.0, 1001), []

    def scattered(x: Array) -> Array:
        looked_at.append(x.size)
        return 1.0 + 1e-8 * np.sin(1e15 * x[None])

    with pytest.raises(Unanswered, match="rounding"):
        largest_of_each(scattered, places)
    assert sum(looked_at) < 300_000
    values = scattered(places)
    assert largest_from(scattered, places, values, np.array([1e-7]))[0].value == values.max()


@pytest.mark.slow
def test_rounding_errors_about_a_largest_value_of_zero_are_known_to_the_function_s_size() -> None:
    def noisy(x: Array) -> Array:
        return (1e-9 * np.sin(1e13 * x) - 5e3 * np.maximum(x - 0.5, 0.0))[None]

    places = np.linspace(0.0, 1.0, 3001)
    (top,) = largest_of_each(noisy, places)
    assert top.value == pytest.approx(0.0, abs=1e-8)
    assert top.at <= 0.5
    # Known to 1e-10 of itself alone, it cannot be closed in on.
    with pytest.raises(Unanswered, match="cannot be told from rounding errors"):
        largest_from(noisy, places, noisy(places), np.zeros(1))


def test_a_jump_is_closed_in_on_no_further_than_is_asked() -> None:
    """Where the highest value lies elsewhere, as right of a jump up to a fall, its own steepness promises nothing.

    Intervals that were cut down to rounding errors, as by the slope across the jump, would take 13 rounds.
    """
    looked = []

    def functions(x: Array) -> Array:
        looked.append(x.size)
        return np.where(x < 1.0 / 3.0, 0.0, 4.0 / 3.0 - x)[None]

    (top,) = largest_of_each(functions, np.linspace(0.0, 1.0, 21), 1e-6)
    assert top.value == pytest.approx(1.0, abs=1e-6)
    assert len(looked) <= 8


@pytest.mark.parametrize("width", [2e-2, 5e-3, 1e-3])
def test_a_steep_rise_that_a_sample_meets_is_no_jump(width: float) -> None:
    """A ramp with an overshoot at its end, as narrow as a fiftieth of a step."""
    end = 0.45 + width / 3.0

    def functions(x: Array) -> Array:
        share = (x - end) / width
        return (np.clip(share + 1.0, 0.0, 1.0) + 0.3 * np.maximum(1.0 - np.abs(share), 0.0))[None]

    (top,) = largest_of_each(functions, np.linspace(0.0, 1.0, 21))
    assert top.value == pytest.approx(1.3, abs=1e-9)
    assert top.at == pytest.approx(end, abs=1e-9)
