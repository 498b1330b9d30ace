"""Where circles about the origin meet outlines, found without looking at every chord.

An outline's distance from an axis rises and falls a few times per tooth only.  Each rise and each fall, here a slope,
meets a circle once at most, in a chord that is found by bisection.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ncgear.numerics.arrays import Array, IndexArray, Mask


@dataclass(frozen=True, eq=False)
class Chords:
    """Chords of one outline near the mesh at many positions, position by position and along the outline.

    ``position`` is the number of the position, shape (n,); ``start`` and ``end`` are points, shape (n, 2).
    """

    position: IndexArray
    start: Array
    end: Array

    def kept(self, rows: Mask | IndexArray) -> Chords:
        """The chosen chords."""
        return Chords(self.position[rows], self.start[rows], self.end[rows])


@dataclass(frozen=True, eq=False)
class Slopes:
    """The rises and falls of an outline's distance from the origin, position by position.

    ``low`` and ``high`` are the squared distances between which each slope runs and ``number`` is its number, shape
    (positions, slopes); padded with slopes that no circle meets.  ``chords`` and whether they are ``rising`` are in the
    order of ``key``: the slope's number and, as a fraction, how far up the slope the chord begins.
    """

    low: Array
    high: Array
    number: Array
    chords: Chords
    rising: Mask
    key: Array

    def met(self, position: IndexArray, square: Array) -> tuple[IndexArray, IndexArray]:
        """Which of n circles, given by position and squared radius, meet a slope; and in which chord they do."""
        circle, column = np.nonzero((self.low[position] <= square[:, None]) & (square[:, None] < self.high[position]))
        place = position[circle], column
        low, high, number = self.low[place], self.high[place], self.number[place]
        found = np.searchsorted(self.key, number + (square[circle] - low) / (high - low), side="right") - 1
        # A circle a rounding error below the slope's top must not slip into the next slope.
        return circle, np.minimum(found, np.searchsorted(self.key, number + 1.0) - 1)


def slopes_of(chords: Chords, positions: int) -> Slopes:
    """The chords sorted into slopes; those of which both ends are equally far from the origin belong to none."""
    first, last = product(chords.start, chords.start), product(chords.end, chords.end)
    chords, first, last = chords.kept(first != last), first[first != last], last[first != last]
    rising = last > first
    begins = _begins(chords.position, first, last)
    slope, begin = np.cumsum(begins) - 1, np.nonzero(begins)[0]
    inner, outer = np.minimum(first, last), np.maximum(first, last)
    low, high = np.minimum.reduceat(inner, begin), np.maximum.reduceat(outer, begin)
    key = slope + (inner - low[slope]) / (high - low)[slope]
    order = np.argsort(key, kind="stable")
    table = _by_position(chords.position[begins], low, high, positions)
    return Slopes(*table, chords.kept(order), rising[order], key[order])


def _begins(position: IndexArray, first: Array, last: Array) -> Mask:
    """Whether a chord begins a slope: at a new position, where it turns, and where it does not go on from the last."""
    begins = np.ones(position.size, dtype=bool)
    turns = (last > first)[1:] != (last > first)[:-1]
    begins[1:] = (position[1:] != position[:-1]) | turns | (first[1:] != last[:-1])
    return begins


def _by_position(position: IndexArray, low: Array, high: Array, positions: int) -> tuple[Array, Array, Array]:
    """Lower ends, upper ends and numbers of slopes in tables with one row per position."""
    place = np.arange(position.size) - np.searchsorted(position, position)
    shape = positions, int(place.max(initial=0)) + 1
    lows, highs, numbers = np.full(shape, np.inf), np.full(shape, -np.inf), np.zeros(shape)
    lows[position, place], highs[position, place], numbers[position, place] = low, high, np.arange(position.size)
    return lows, highs, numbers


def product(first: Array, second: Array) -> Array:
    """Scalar products of plane vectors, shape (n, 2) each; twice as fast as a sum over the last axis."""
    products: Array = first[:, 0] * second[:, 0] + first[:, 1] * second[:, 1]
    return products
