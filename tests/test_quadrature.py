"""The integral of a slope: right for sharp functions, and it tells where value and slope disagree."""

from __future__ import annotations

from math import atan, pi

import numpy as np
import pytest

from ncgear.numerics import jet
from ncgear.numerics.arrays import Array
from ncgear.numerics.jet import Jet
from ncgear.numerics.quadrature import gauss_points, integrated_slope


def test_gauss_points_are_exact_to_twice_their_number() -> None:
    points, weights = gauss_points(np.array([0.0, 0.5, 2.0]), 6)
    assert float(weights @ points**11) == pytest.approx(2.0**12 / 12.0, rel=1e-14)


@pytest.mark.parametrize("width", [1.0, 1e-2, 1e-4])
def test_sharp_steps(width: float) -> None:
    def step(points: Array) -> Jet:
        return jet.arctan((Jet.variable(points, 1) - 0.31) * (1.0 / width))

    exact = atan(0.69 / width) + atan(0.31 / width)
    assert integrated_slope(step, np.array([0.0, 1.0])) == pytest.approx(exact, rel=1e-13)


@pytest.mark.parametrize("area", [1e-3, 1e-9])
def test_a_value_that_passes_a_bump_of_its_slope_by_is_found_out(area: float) -> None:
    """The driven angle of a law whose quadrature saw nothing of a bump: value and slope are both smooth, and differ."""

    def blind(points: Array) -> Jet:
        bump = area / (0.03 * np.sqrt(pi)) * np.exp(-(((points - 2.2) / 0.03) ** 2))
        return Jet(np.stack([points, 1.0 + bump]))

    assert integrated_slope(blind, np.array([0.0, 2.0 * pi])) - 2.0 * pi == pytest.approx(area, rel=1e-4)
