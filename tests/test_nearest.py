"""The nearest point of a rolling curve: circles and lines in closed form, other curves by brute force."""

from __future__ import annotations

from math import pi

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.optimize import minimize_scalar

from at_once import at_once
from ncgear.pitch.curve import PitchCurve, nearest
from ncgear.pitch.pair import sized_pair
from ncgear.ratio.laws.ellipse import elliptical_law
from ncgear.ratio.laws.uniform import uniform_law
from ncgear.ratio.transmission import Lobes
from ncgear.teeth.tool import PinionCircle, RackLine
from pairs import baler_law

MODULE = 2.0
TOLERANCE = 1e-11

Array = np.ndarray


@pytest.mark.parametrize("start", [-3.0, 0.0, 5.0])
def test_of_a_line_it_is_the_foot_of_the_perpendicular(start: float) -> None:
    points = np.array([[1.0, 2.0], [-4.0, -0.5], [7.0, 0.0]])
    sigma, distance = nearest(RackLine(), points, np.full(3, start), TOLERANCE)
    assert sigma == pytest.approx(points[:, 0], abs=TOLERANCE)
    # The rack's material lies above its line: its normal points down.
    assert distance == pytest.approx(-points[:, 1], abs=TOLERANCE)


@pytest.mark.slow
@given(st.floats(-2.5, 2.5), st.floats(4.0, 40.0), st.floats(-0.5, 0.5))
def test_of_a_circle_it_is_on_the_radius(angle: float, away: float, aside: float) -> None:
    """From inside and outside, from a start that is half a radian off."""
    circle = PinionCircle(20, MODULE)
    place = angle - pi / 2.0
    point = away * np.array([[np.cos(place), np.sin(place)]])
    start = np.array([20.0 * (angle + aside)])
    sigma, distance = nearest(circle, point, start, TOLERANCE)
    assert sigma == pytest.approx(20.0 * angle, abs=1e-9)
    assert distance == pytest.approx(away - 20.0, abs=1e-9)


def curves() -> dict[str, PitchCurve]:
    laws = {"uniform": uniform_law(Lobes()), "ellipse": elliptical_law(0.5, 0.3, Lobes()), "baler": baler_law()}
    pairs = {name: sized_pair(law, 40, MODULE, None) for name, law in laws.items()}
    return {f"{name} {gear}": getattr(pair, gear) for name, pair in pairs.items() for gear in ("driving", "driven")}


@at_once("name", ["uniform driving", "ellipse driving", "ellipse driven", "baler driving", "baler driven"])
def test_of_a_pitch_curve_it_is_what_a_search_finds(name: str) -> None:
    """Points within two modules of the curve, whose radius of curvature is larger: Newton's method and a minimiser."""
    curve, random = curves()[name], np.random.default_rng(3)
    at = random.uniform(0.0, curve.length_mm, 40)
    offsets = random.uniform(-2.0, 2.0, 40)
    on = curve.at_length(at)
    points = on.position + offsets[:, None] * on.normal
    sigma, distance = nearest(curve, points, at + random.uniform(-1.0, 1.0, 40), TOLERANCE)
    for point, found, away in zip(points, sigma, distance, strict=True):
        searched = minimize_scalar(
            lambda s, p=point: np.linalg.norm(curve.at_length(np.array([s])).position[0] - p),
            bounds=(found - 2.0, found + 2.0),
            method="bounded",
            options={"xatol": 1e-9},
        )
        assert abs(away) <= searched.fun + 1e-9
        # A minimum is known to the square root of what its value is.
        assert found == pytest.approx(searched.x, abs=1e-4)
    assert distance == pytest.approx(offsets, abs=1e-9)
    assert sigma == pytest.approx(at, abs=1e-8)


def test_beyond_the_seam_it_goes_on_counting() -> None:
    curve = curves()["ellipse driving"]
    for turns in (-1, 0, 1, 2):
        start = np.array([turns * curve.length_mm + 0.4])
        on = curve.at_length(start)
        sigma, distance = nearest(curve, on.position + 0.5 * on.normal, start - 0.7, TOLERANCE)
        assert sigma == pytest.approx(start, abs=1e-9)
        assert distance == pytest.approx(0.5, abs=1e-10)


def test_a_point_without_a_foot_near_by_is_not_a_number() -> None:
    """The centre of a circle is as far from all of it, and no wrong place is told for a point of no numbers."""
    points = np.array([[0.0, np.nan], [0.0, 10.0]])
    sigma, distance = nearest(RackLine(), points, np.zeros(2), TOLERANCE)
    assert np.isnan(distance[0])
    assert np.isnan(sigma[0])
    assert distance[1] == -10.0
