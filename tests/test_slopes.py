"""Circles against rises and falls of outlines: the same chords as every chord looked at, flat ones and all."""

from __future__ import annotations

from math import pi

import numpy as np
import pytest

from ncgear.contact.slopes import Chords, Slopes, slopes_of

Array = np.ndarray
SEED = 20240811


def wavy(waves: int, count: int, depth: float, shift: float = 0.0) -> Array:
    """A closed outline whose distance from the origin rises and falls ``waves`` times."""
    around = np.arange(count) * (2.0 * pi / count)
    radius = 10.0 + depth * np.sin(waves * around)
    return np.column_stack([radius * np.cos(around) + shift, radius * np.sin(around)])


def chords(outlines: list[Array]) -> Chords:
    """All chords, one outline per position."""
    position = np.repeat(np.arange(len(outlines)), [len(outline) for outline in outlines])
    ends = np.concatenate([np.roll(outline, -1, axis=0) for outline in outlines])
    return Chords(position, np.concatenate(outlines), ends)


def met_by_looking_at_all(all_chords: Chords, position: int, square: float) -> set[tuple[float, ...]]:
    """Chords that a circle crosses, one end being on it or inside and the other outside."""
    inside = [np.sum(points**2, axis=1) <= square for points in (all_chords.start, all_chords.end)]
    crossed = (inside[0] != inside[1]) & (all_chords.position == position)
    return set(map(tuple, np.hstack([all_chords.start, all_chords.end])[crossed]))


def met(slopes: Slopes, position: Array, square: Array, circle: int) -> list[tuple[float, ...]]:
    """Chords found for one of the circles."""
    number, chord = slopes.met(position, square)
    both = np.hstack([slopes.chords.start, slopes.chords.end])
    return list(map(tuple, both[chord[number == circle]]))


OUTLINES = {
    "waves": [wavy(7, 100, 2.0), wavy(12, 311, 0.5), wavy(3, 50, 4.0)],
    "off the axis": [wavy(7, 100, 2.0, shift=15.0), wavy(12, 311, 0.5, shift=-9.0)],
    "circle": [wavy(1, 64, 0.0), wavy(1, 64, 0.0, shift=1.0)],
    "nothing but a corner": [np.array([[1.0, 0.0], [2.0, 0.0], [2.0, 2.0]])],
}


@pytest.mark.parametrize("name", OUTLINES)
def test_circles_meet_the_chords_that_a_look_at_all_finds(name: str) -> None:
    all_chords = chords(OUTLINES[name])
    slopes, random = slopes_of(all_chords, len(OUTLINES[name])), np.random.default_rng(SEED)
    position = random.integers(0, len(OUTLINES[name]), 300)
    square = random.uniform(0.5, 26.0, position.size) ** 2
    for circle in range(position.size):
        found = met(slopes, position, square, circle)
        assert len(found) == len(set(found))
        assert set(found) == met_by_looking_at_all(all_chords, int(position[circle]), float(square[circle]))


def test_circles_through_corners_meet_one_of_the_two_chords_there() -> None:
    outline = wavy(7, 100, 2.0)
    slopes = slopes_of(chords([outline]), 1)
    square = outline[:, 0] * outline[:, 0] + outline[:, 1] * outline[:, 1]
    for circle in range(square.size):
        found = met(slopes, np.zeros(square.size, dtype=int), square, circle)
        # Every rise is followed by a fall, whichever chord of a corner counts.
        assert len(found) % 2 == 0


def test_each_wave_makes_two_slopes() -> None:
    slopes = slopes_of(chords([wavy(7, 700, 1.0)]), 1)
    assert slopes.low.size in (14, 15)  # one is cut in two where the outline begins


def test_circles_of_a_position_without_chords_meet_nothing() -> None:
    only_first = chords([wavy(7, 100, 2.0)])
    circle, chord = slopes_of(only_first, 3).met(np.array([1, 2]), np.array([100.0, 100.0]))
    assert circle.size == chord.size == 0
