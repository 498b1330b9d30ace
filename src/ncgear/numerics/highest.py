"""Largest values of functions that are known by evaluation alone: no derivative, kinks and jumps allowed.

From samples the search closes in on every one of them that is as high as its neighbours and may lead to the highest
value.  What happens wholly between two neighbouring samples is not seen: whoever samples chooses places at which the
function shows what it does, such as the steps of a solver that controls its error.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ncgear.numerics.arrays import Array, IndexArray
from ncgear.numerics.extrema import Extremum

SHARES = 4
"""Parts into which each side of a high sample is cut in a round; the two sides shrink to a quarter by it."""

ROUNDS = 24
"""Most rounds: sides shrink to 4^-24 of their length, next to rounding.  Only a jump takes as many."""

EVEN = 1e-10
"""Share of the highest value by which a sample may exceed both neighbours and count as found.  The top of a parabola is
at most a quarter of the way higher that the sample rises above its lower neighbour."""

BLOCK = 1 << 11
"""Places evaluated at once: few enough for the cache, and long motions do not fill the memory."""


def largest_of_each(functions: Callable[[Array], Array], places: Array) -> list[Extremum]:
    """The largest value of each of q functions between the first and the last of rising places, shape (n,), n > 1.

    ``functions`` maps places (shape (m,)) to values (shape (q, m)).  One-sided limits at jumps count.
    """
    blocks = np.array_split(places, -(-places.size // BLOCK))
    values = np.concatenate([functions(block) for block in blocks], axis=1)
    best = values.argmax(axis=1)
    top, at = values.max(axis=1), places[best]
    owner, middle = _as_high_as_neighbours(values)
    around = np.stack([np.maximum(middle - 1, 0), middle, np.minimum(middle + 1, places.size - 1)])
    triples, heights = places[around], values[owner, around]
    for _ in range(ROUNDS):
        drop = heights[1] - np.minimum(heights[0], heights[2])
        kept = (heights[1] + drop >= top[owner]) & (drop > EVEN * np.abs(top[owner]))
        if not kept.any():
            break
        owner = owner[kept]
        triples, heights = _closer(functions, owner, triples[:, kept])
        for number in np.unique(owner):
            own = np.nonzero(owner == number)[0]
            highest = own[heights[1, own].argmax()]
            if heights[1, highest] > top[number]:
                top[number], at[number] = heights[1, highest], triples[1, highest]
    return [Extremum(float(value), float(place)) for value, place in zip(top, at, strict=True)]


def _as_high_as_neighbours(values: Array) -> tuple[IndexArray, IndexArray]:
    """Row and column of the samples that no neighbour exceeds, values of shape (q, n)."""
    edge = np.full((values.shape[0], 1), -np.inf)
    padded = np.concatenate([edge, values, edge], axis=1)
    owner, middle = np.nonzero((values >= padded[:, :-2]) & (values >= padded[:, 2:]))
    return owner, middle


def _closer(functions: Callable[[Array], Array], owner: IndexArray, triples: Array) -> tuple[Array, Array]:
    """The highest of finer samples about each middle place with its neighbours, and their values, shape (3, k) each."""
    low, middle, high = triples
    shares = np.arange(SHARES)[:, None] / SHARES
    points = np.concatenate([low + (middle - low) * shares, middle + (high - middle) * shares, high[None]])
    values = functions(points.ravel()).reshape(-1, *points.shape)[owner, :, np.arange(owner.size)].T
    best = values.argmax(axis=0)
    around = np.stack([np.maximum(best - 1, 0), best, np.minimum(best + 1, 2 * SHARES)])
    column = np.arange(owner.size)
    return points[around, column], values[around, column]
