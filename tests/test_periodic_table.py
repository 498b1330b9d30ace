"""Tables for integrators: what Hermite's interpolation promises, on polynomials, by its rate, and on the laws."""

from __future__ import annotations

from collections.abc import Callable
from math import log2, pi

import numpy as np
import pytest

from ncgear.dynamics.law_table import law_table
from ncgear.numerics.periodic_table import PeriodicTable, cubics, quintics
from ncgear.ratio.transmission import Lobes
from pairs import baler_law, sine_law

Array = np.ndarray
EDGES = np.array([0.0, 0.3, 1.1, 1.2, 2.0])
POINTS = np.linspace(0.0, 2.0, 201)


def table_of(functions: list[Callable[[Array], Array]], edges: Array) -> PeriodicTable:
    """A table from values and as many derivatives as are given."""
    interpolated = {2: cubics, 3: quintics}[len(functions)]
    low, high = ([function(ends) for function in functions] for ends in (edges[:-1], edges[1:]))
    return PeriodicTable(edges, interpolated(np.diff(edges), low, high))


@pytest.mark.parametrize(("degree", "derivatives"), [(3, 1), (5, 2)])
def test_polynomials_of_its_degree_are_met_to_rounding_errors(degree: int, derivatives: int) -> None:
    polynomial = np.polynomial.Polynomial(np.arange(1.0, degree + 2.0))
    table = table_of([polynomial, *(polynomial.deriv(k + 1) for k in range(derivatives))], EDGES)
    # The last point begins the next period.
    value, slope = table.at(POINTS[:-1])
    np.testing.assert_allclose(value, polynomial(POINTS[:-1]), rtol=1e-13)
    np.testing.assert_allclose(slope, polynomial.deriv()(POINTS[:-1]), rtol=1e-12)


@pytest.mark.parametrize(("functions", "rate"), [((np.sin, np.cos), 4), ((np.sin, np.cos, lambda x: -np.sin(x)), 6)])
def test_the_error_falls_with_the_width_to_the_power_of_the_degree_and_one(
    functions: tuple[Callable[[Array], Array], ...], rate: int
) -> None:
    x = np.linspace(0.0, 2.0 * pi, 5003)[:-1]
    errors = [
        np.abs(table_of(list(functions), np.linspace(0.0, 2.0 * pi, n + 1)).at(x)[0] - np.sin(x)).max() for n in (8, 16)
    ]
    assert log2(errors[0] / errors[1]) == pytest.approx(rate, abs=0.15)


def test_one_angle_gives_what_an_array_gives() -> None:
    table = law_table(sine_law(0.08))
    values, slopes = table.at(np.array([0.7, -3.0, 9.0]))
    assert [table.at(x) for x in (0.7, -3.0, 9.0)] == list(zip(values, slopes, strict=True))


@pytest.mark.parametrize("law", [baler_law(), sine_law(0.3), sine_law(0.1, Lobes(2, 2))])
def test_a_law_is_met_before_and_after_its_period(law: object) -> None:
    x = np.linspace(-7.0, 14.0, 10_001)
    exact = law.driven_angle(x, 1)  # type: ignore[attr-defined]
    value, slope = law_table(law).at(x)  # type: ignore[arg-type]
    assert np.abs(value - exact.value).max() < 1e-13
    assert np.abs(slope - exact.derivative(1)).max() < 1e-10
