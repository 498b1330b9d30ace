"""Convex hulls of curves: scipy's hulls of points, closed forms, and many more places than the search looks at."""

from __future__ import annotations

from math import pi

import numpy as np
import pytest

from ncgear.numerics.arrays import Array, ComplexArray
from ncgear.numerics.highest import hull_of_each
from ncgear.numerics.plane import corners, depths

DIRECTIONS = np.exp(2j * pi * np.arange(211) / 211)


def farthest(points: ComplexArray) -> Array:
    """The largest part of points along each of DIRECTIONS."""
    return np.array([np.real(points * np.conj(way)).max() for way in DIRECTIONS])


@pytest.mark.parametrize("count", [3, 5, 60, 20_000])
def test_corners_of_points_as_by_scipy(count: int) -> None:
    from scipy.spatial import ConvexHull

    rng = np.random.default_rng(count)
    points = rng.normal(size=count) + 1j * rng.normal(size=count)
    found, hull = corners(points), ConvexHull(np.column_stack([points.real, points.imag]))
    assert set(found.tolist()) == set(points[hull.vertices].tolist())
    # Counter-clockwise, and no point is outside
    assert np.sum(np.imag(np.conj(found) * np.roll(found, -1))) / 2.0 == pytest.approx(hull.volume)
    assert depths(found, points).min() > -1e-12
    assert depths(found, 9.0 * points[hull.vertices]).max() < 0.0


def test_corners_of_points_on_a_line_or_at_one_place() -> None:
    assert corners(np.array([3 + 3j, 1 + 1j, 2 + 2j, 1 + 1j])).tolist() == [1 + 1j, 3 + 3j]
    assert corners(np.full(7, 2 - 1j)).tolist() == [2 - 1j]
    assert depths(np.array([2 - 1j]), np.array([2 - 1j])).tolist() == [0.0]


def test_a_curve_with_a_jump_a_kink_and_a_flat_part_between_few_places() -> None:
    """To 1e-6 of its size, by a hundred thousand places and those beside its jump and its kinks.

    A point that stands still and a wave too small to count cost nothing.  The jump is by a half at 1.234567, between
    places; a cardioid has a cusp, a square's corners are kinks.
    """

    def square(phi1: Array) -> ComplexArray:
        side, along = np.divmod((phi1 + 0.1) % (2.0 * pi), pi / 2.0)
        return np.asarray(1j**side * (1.0 + 1j * (along / (pi / 4.0) - 1.0)))

    def curves(phi1: Array) -> ComplexArray:
        looked.append(phi1.size)
        turning = np.exp(1j * phi1)
        small = 1.0 + 1e-8 * np.sin(50.0 * phi1)
        jumping = np.where(phi1 < 1.234567, 1.0, 0.5) * turning
        return np.stack([jumping, (1.0 - turning) * turning / 2.0, square(phi1), 3.0 + 0j * phi1, small + 0j])

    looked = list[int]()
    places = np.linspace(0.0, 2.0 * pi, 61)
    hulls = hull_of_each(curves, places, curves(places), np.full(5, 1e-6))
    assert sum(looked) < 30_000
    told = np.nextafter([1.234567, *(np.arange(1, 5) * pi / 2.0 - 0.1)], 0.0)
    dense = curves(np.append(np.linspace(0.0, 2.0 * pi, 100_001)[:-1], told))
    for number, (hull, curve, first) in enumerate(zip(hulls, dense, curves(places), strict=True)):
        missed = farthest(curve) - farthest(hull)
        assert np.abs(missed).max() < 3e-6, number
        # Negative control: the places alone see less of the curves that bend or jump.
        assert number > 2 or (farthest(curve) - farthest(first)).max() > 1e-4
