"""Interval bounds against points and mpmath; forms of expressions with features that no even samples show."""

from __future__ import annotations

from math import erf, exp, pi, sqrt

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from mpmath import iv

from ncgear.numerics import chebyshev, intervals
from ncgear.numerics.chebyshev import NotSmooth
from ncgear.numerics.formula import composed
from ncgear.numerics.jet import Jet
from ncgear.numerics.proven import proven_form

TEXTS = (
    "3 - 2*x + 0.5*x**3",
    "exp(-((x - 1)/0.3)**2)",
    "sin(3*x)*cos(x/2) + tan(x/4)",
    "1/(2 + sin(x)) - (x + 3)**-2",
    "sqrt(x + 2.5)*log(x + 3)",
    "atan(x)*sinh(x) - tanh(2*x)",
    "(x + 2.5)**1.5",
)


@pytest.mark.thorough
@settings(deadline=None, max_examples=30)
@given(st.sampled_from(TEXTS), st.floats(-2.0, 2.0), st.floats(0.0, 1.0))
def test_a_cell_encloses_value_and_derivatives_at_its_points(text: str, low: float, width: float) -> None:
    function, order = composed(text, "key", "x"), 6
    bounds = intervals.coefficients(function(intervals.variable(np.array([low]), np.array([low + width]), order)))
    inside = function(Jet.variable(np.linspace(low, low + width, 41), order)).coefficients
    slack = 1e-13 * (1.0 + np.abs(inside))
    assert np.all(bounds.low <= inside + slack)
    assert np.all(bounds.high >= inside - slack)


@pytest.mark.parametrize("text", TEXTS)
def test_narrow_cells_have_narrow_bounds(text: str) -> None:
    """A bound that is merely infinite would prove nothing."""
    low = np.linspace(-1.9, 1.9, 39)
    found = intervals.coefficients(composed(text, "key", "x")(intervals.variable(low, low + 1e-6, 4)))
    assert np.all(found.high - found.low <= 1e-2 * (1.0 + found.magnitude))


@pytest.mark.parametrize(
    ("low", "high"), [(-1.0, 2.0), (0.1, 0.2), (1.5, 1.6), (3.0, 3.3), (-7.0, -4.8), (4.0, 11.0), (0.0, 0.0)]
)
def test_waves_and_products_against_the_intervals_of_mpmath(low: float, high: float) -> None:
    own, other = intervals.Intervals(np.array([low]), np.array([high])), iv.mpf([low, high])
    pairs = [
        (np.sin(own), iv.sin(other)),
        (np.cos(own), iv.cos(other)),
        (np.exp(own), iv.exp(other)),
        (own * (own - 1.0), other * (other - 1)),
    ]
    for found, exact in pairs:
        assert float(found.low[0]) <= float(exact.a) + 1e-300
        assert float(found.high[0]) >= float(exact.b) - 1e-300
        assert (found.low[0], found.high[0]) == pytest.approx((float(exact.a), float(exact.b)), rel=1e-14, abs=1e-14)


def test_what_is_not_known_is_infinite_and_never_not_a_number() -> None:
    across = intervals.Intervals(np.array([-1.0, 0.0]), np.array([1.0, 800.0]))
    with np.errstate(all="ignore"):
        one, two, three = 1.0 / across, np.log(across), np.sqrt(across)
        four, five, six = np.exp(across) * 0.0, across**-0.5, across / across
    for found in (one, two, three, four, five, six):
        assert not np.isnan(found.low).any()
        assert not np.isnan(found.high).any()
        assert np.all(found.low <= found.high)


@pytest.mark.parametrize("width", [3.0, 0.07, 2e-3, 4e-4])
@pytest.mark.parametrize("height", [7e3, 0.4])
def test_the_integral_of_a_peak_of_any_width(width: float, height: float) -> None:
    """Against the error function.  Panels of even halving see nothing of the narrow ones: the control below."""
    place, end = 17.6543, 60.0
    function = composed(f"50 + {height}*exp(-((x - {place})/{width})**2)", "key", "x")
    exact = 50.0 * end + height * width * sqrt(pi) / 2.0 * (erf((end - place) / width) + erf(place / width))
    assert proven_form(function, 0.0, end).integrated().final == pytest.approx(exact, rel=1e-12)


def test_the_control_misses_the_peak() -> None:
    function = composed("50 + 7e3*exp(-((x - 17.6543)/2e-3)**2)", "key", "x")
    plain = chebyshev.fitted(lambda x: function(Jet(x[None, :])).value, [0.0, 60.0])
    assert plain.integrated().final == pytest.approx(3000.0, rel=1e-12)
    assert proven_form(function, 0.0, 60.0).integrated().final > 3000.0 + 20.0


def test_a_small_peak_beside_a_large_one_is_seen() -> None:
    """The large one's rounding errors are larger than the small one's tail."""
    function = composed("9e3*exp(-((x - 5.55)/2e-3)**2) + 3*exp(-((x - 41.01)/3e-3)**2)", "key", "x")
    form = proven_form(function, 0.0, 60.0)
    assert form(np.array([5.55, 41.01, 41.013, 30.0])) == pytest.approx([9e3, 3.0, 3.0 * exp(-1.0), 0.0], abs=1e-8)


@pytest.mark.parametrize(("text", "at"), [("1/(x - 20.02)", 20.02), ("sqrt(x)", 0.0)])
def test_what_is_not_smooth_is_refused_with_its_place(text: str, at: float) -> None:
    with pytest.raises(NotSmooth) as caught:
        proven_form(composed(text, "key", "x"), 0.0, 60.0)
    assert caught.value.at == pytest.approx(at, abs=1e-4)


def test_a_root_of_higher_order_at_an_end_is_smooth_enough() -> None:
    form = proven_form(composed("x**1.5", "key", "x"), 0.0, 60.0)
    assert form.integrated().final == pytest.approx(60.0**2.5 / 2.5, rel=1e-12)
