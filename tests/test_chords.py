"""Chords along curves of known shape: how many, how far they stray, and to which side."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
import shapely

from at_once import at_once
from ncgear.teeth.chords import sampled, straddled
from ncgear.teeth.stretch import CurveStretch, joined, split

Array = np.ndarray
Curve = Callable[[Array], tuple[Array, Array]]
Sampling = Callable[[CurveStretch, Array], tuple[Array, Array]]

RADII = np.array([1.0, 10.0, 300.0])


def arcs(number: Array, angle: Array) -> tuple[Array, Array]:
    """Circles about the origin, counter-clockwise."""
    radius, around = RADII[number][..., None], np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    return radius * around, radius * np.stack([-around[..., 1], around[..., 0]], axis=-1)


def bends(number: Array, x: Array) -> tuple[Array, Array]:
    """Cubics through an inflection at x = 0, and one with a sharp bend there."""
    sharp = np.asarray(number == 2)
    y = np.where(sharp, np.sqrt(x * x + 1e-4), (number + 1) * x**3)
    slope = np.where(sharp, x / np.sqrt(x * x + 1e-4), 3.0 * (number + 1) * x**2)
    return np.stack([x, y], axis=-1), np.stack([np.ones_like(x), slope], axis=-1)


def waves(number: Array, x: Array) -> tuple[Array, Array]:
    """Sines of one wave and more: as many inflections as crests."""
    times = np.asarray(number + 1, dtype=float)
    y, slope = np.sin(times * x), times * np.cos(times * x)
    return np.stack([x, y], axis=-1), np.stack([np.ones_like(x), slope], axis=-1)


SHAPES: dict[str, tuple[Callable[[Array, Array], tuple[Array, Array]], float, float]] = {
    "arcs": (arcs, 0.2, 1.2),
    "bends": (bends, -1.0, 1.3),
    "waves": (waves, 0.3, 6.0),
}


def stretch(name: str) -> CurveStretch:
    """Three curves of a kind; each is rolled over evenly."""
    curve, start, end = SHAPES[name]
    every = np.arange(3)
    ends = np.array([np.full(3, start), np.full(3, end)])
    return CurveStretch(curve, every, *ends, ends, 4.0 * every, np.ones(3), np.full(3, np.inf), np.zeros_like(every))


def polylines(sampling: Sampling, name: str, tolerance: float) -> list[Array]:
    """Points of each of the curves in order, the last one included."""
    curve, _, end = SHAPES[name]
    points, key = sampling(stretch(name), np.full(3, tolerance))
    ends = curve(np.arange(3), np.full(3, end))[0]
    return [
        np.vstack([points[np.argsort(key)][np.sort(key) // 4 == number], ends[number : number + 1]])
        for number in range(3)
    ]


def dense(name: str, number: int) -> Array:
    """A curve by a hundred thousand points."""
    curve, start, end = SHAPES[name]
    return curve(np.full(100_001, number), np.linspace(start, end, 100_001))[0]


@pytest.mark.tiers(
    thorough=["0.01-arcs-straddled"],
    long=["0.0001-waves-sampled", "0.0001-arcs-straddled"],
    rest="slow",
)
@pytest.mark.parametrize("sampling", [sampled, straddled])
@pytest.mark.parametrize("name", SHAPES)
@pytest.mark.parametrize(
    "tolerance",
    [1e-2, pytest.param(1e-4, marks=pytest.mark.slow), pytest.param(1e-6, marks=[pytest.mark.slow, pytest.mark.long])],
)
def test_chords_and_curves_are_nowhere_farther_apart_than_the_tolerance(
    sampling: Sampling, name: str, tolerance: float
) -> None:
    for number, points in enumerate(polylines(sampling, name, tolerance)):
        exact, chords = dense(name, number), shapely.LineString(points)
        assert shapely.distance(chords, shapely.points(exact[::7])).max() <= tolerance
        # The dense points' own chords, 2.3e-5 long, stray by up to 7e-9 where the radius is 0.01.
        line = shapely.LineString(exact)
        shapely.prepare(line)
        assert shapely.distance(line, shapely.points(points)).max() <= tolerance + 1e-8


@pytest.mark.parametrize("tolerance", [1e-3, 1e-5])
def test_points_of_sampled_curves_are_on_them_and_stray_inwards(tolerance: float) -> None:
    for radius, points in zip(RADII, polylines(sampled, "arcs", tolerance), strict=True):
        middles = (points[1:] + points[:-1]) / 2.0
        assert np.hypot(*points.T) == pytest.approx(radius, rel=1e-14)
        assert (radius - np.hypot(*middles.T)).max() > 0.0


@pytest.mark.slow
@pytest.mark.parametrize("tolerance", [1e-4, 1e-6])
def test_points_of_straddled_arcs_stand_off_as_far_as_middles_stand_in(tolerance: float) -> None:
    for radius, points in zip(RADII, polylines(straddled, "arcs", tolerance), strict=True):
        assert np.hypot(*points[[0, -1]].T) == pytest.approx([radius, radius], rel=1e-14)
        outside = np.hypot(*points[3:-3].T) - radius
        inside = radius - np.hypot(*((points[4:-3] + points[3:-4]) / 2.0).T)
        assert outside == pytest.approx(np.full(outside.size, 0.9 * tolerance), rel=0.12)
        assert inside == pytest.approx(np.full(inside.size, outside[0]), rel=1e-3)


@pytest.mark.parametrize(("sampling", "sagitta"), [(sampled, 1.0), (straddled, 2.0)])
def test_arcs_have_as_many_chords_as_their_sagitta_asks_for(sampling: Sampling, sagitta: float) -> None:
    tolerance = 1e-6
    for radius, points in zip(RADII, polylines(sampling, "arcs", tolerance), strict=True):
        least = 1.0 / (2.0 * np.arccos(1.0 - sagitta * tolerance / radius))
        # Whole numbers, and two more at the ends of straddled curves, which are on them.
        assert least <= len(points) - 1 <= 1.03 * least + 3.0


def test_straddling_takes_fewer_chords_by_the_square_root_of_two() -> None:
    for name in SHAPES:
        on, off = (sum(map(len, polylines(way, name, 1e-6))) for way in (sampled, straddled))
        assert on / off == pytest.approx(np.sqrt(2.0), rel=0.05)


@pytest.mark.parametrize("sampling", [sampled, straddled])
def test_a_stretch_that_is_split_keeps_the_points_where_it_is(sampling: Sampling) -> None:
    joints = np.array([-0.5, 0.25, 0.5])
    points, key = sampling(split(stretch("bends"), joints), np.full(12, 1e-3))
    on_first = points[np.argsort(key)][np.sort(key) < 1.0]
    assert np.all(np.diff(on_first[:, 0]) > 0.0)
    for joint in joints:
        assert np.abs(on_first - [joint, joint**3]).max(axis=1).min() < 1e-12


@pytest.mark.parametrize("sampling", [sampled, straddled])
def test_no_curves_have_no_points(sampling: Sampling) -> None:
    points, key = sampling(stretch("arcs").kept(np.zeros(3, dtype=bool)), np.empty(0))
    assert points.shape == (0, 2)
    assert key.size == 0


@at_once("sampling", [sampled, straddled])
@at_once("tolerance", [0.5, 0.05, 1e-3])
def test_a_bound_of_the_turning_changes_no_points(sampling: Sampling, tolerance: float) -> None:
    """Arcs of 1 rad less a little: of small ones, a single chord is known to do without probes."""
    short = replace(stretch("arcs"), end=np.full(3, 1.19), rolled=np.array([np.full(3, 0.2), np.full(3, 1.19)]))
    bounded = replace(short, most_turning=np.ones(3))
    for known, found in zip(
        sampling(short, np.full(3, tolerance)), sampling(bounded, np.full(3, tolerance)), strict=True
    ):
        assert np.array_equal(known, found)


@pytest.mark.parametrize("sampling", [sampled, straddled])
def test_curves_that_are_sampled_together_have_the_points_they_have_alone(sampling: Sampling) -> None:
    tolerances = {"arcs": 1e-3, "bends": 1e-2, "waves": 1e-4}
    alone = [sampling(stretch(name), np.full(3, tolerance)) for name, tolerance in tolerances.items()]
    none = stretch("bends").kept(np.zeros(3, dtype=bool))
    together = joined([stretch("arcs"), none, stretch("bends"), stretch("waves")])
    points, keys = sampling(together, np.repeat(list(tolerances.values()), 3))
    assert points == pytest.approx(np.concatenate([found[0] for found in alone]), abs=1e-14)
    assert keys == pytest.approx(np.concatenate([found[1] for found in alone]), abs=1e-14)
