"""Largest values of functions, and hulls of curves, that can only be evaluated: no derivative, kinks and jumps allowed.

From samples the search closes in on every interval that may hold the highest value by the slopes beside it, or may lead
out of the hull.  It does not see a peak wholly between two neighbouring samples: the caller must choose places that
show what the function does, such as the steps of a solver that controls its error.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from ncgear.errors import Unanswered
from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array, Columns, ComplexArray, IndexArray, distinct, equal_rows
from ncgear.numerics.extrema import Extremum
from ncgear.numerics.plane import corners, depths

SHARES = 8
"""Parts into which an interval is cut in a round."""

MANY, HALVED = 4000, 4
"""More intervals than these are halved in the first rounds: one value rules out many of them, and so few values pay for
a further round."""

ROUNDS = 16
"""Most rounds: intervals shrink to 8^-16 of their length, next to rounding.  Only a cusp takes as many."""

STEEPER = 2.0
"""Factor by which a function may rise more steeply into an interval than beside it.  Flat tops rise less."""

STAYS, JUMPS = 0.1, 2
"""Where the difference over a part equals the difference over the whole up to this share, for so many rounds, the
function jumps in it: its slope says nothing of the function beside.  Over a cusp the difference falls to a third."""

EVEN = 1e-10
"""Share of the highest value that may be missed."""

ALIKE = 0.1
"""Largest difference of two equal intervals, as a share of the allowed miss; only one of them is searched: the teeth of
circular gears are all alike."""

LEAST = 1e-200
"""Difference of values that always counts as zero; values divided by it do not overflow."""

MOST_PARTS = 50_000
"""Most parts that are examined in a round, beside the parts of all first intervals: where values are rounding errors,
each round finds more parts that may hold the highest value, without end.  Outlines that touch at every vertex need
nearly as many in their second round as there are intervals at first, and few in the third."""

BLOCK = 1 << 11
"""Places evaluated at once: few enough for the cache, and long motions do not fill the memory."""


@dataclass(frozen=True, eq=False)
class _Intervals(Columns):
    """k intervals, each of the function ``owner``, between the places ``low`` and ``high``; shape (k,) each.

    ``at_low`` and ``at_high`` are the values there, whose difference has been the same for ``stayed`` rounds,
    ``before`` and ``after`` the slopes on either side.
    """

    owner: IndexArray
    stayed: IndexArray
    low: Array
    high: Array
    at_low: Array
    at_high: Array
    before: Array
    after: Array

    @property
    def rises(self) -> tuple[Array, Array]:
        """Rise of the values into each interval, from both its ends, at the slopes beside it."""
        length = self.high - self.low
        return np.maximum(self.before, 0.0) * length, np.maximum(-self.after, 0.0) * length

    def inner(self, parts: int) -> Array:
        """Places between equal parts of each interval, shape (k, parts - 1)."""
        return self.low[:, None] + (self.high - self.low)[:, None] * (np.arange(1, parts) / parts)

    def own(self, values: Any) -> Any:
        """Of values of all functions at all inner places, (q, k * parts - k), those of its own in each interval."""
        count = self.owner.size
        return values.reshape(len(values), count, -1)[self.owner, np.arange(count)]

    @property
    def bound(self) -> Array:
        """Value that the function does not exceed within each interval."""
        from_low, from_high = self.rises
        return np.maximum(self.at_low + STEEPER * from_low, self.at_high + STEEPER * from_high)


def largest_of_each(functions: Callable[[Array], Array], places: Array, missed: Array | float = 0.0) -> list[Extremum]:
    """The largest value of each of q functions between rising places, (n,), n > 1; one-sided limits at jumps count.

    ``functions`` maps places (m,) to values (q, m).  Values are known to EVEN of a function's largest size, or to
    ``missed``, (q,) or one number.
    """
    values = _evaluated(functions, places)
    return largest_from(functions, places, values, np.maximum(missed, EVEN * np.abs(values).max(axis=1)))


def range_of(function: Callable[[Array], Array], places: Array) -> tuple[Extremum, Extremum]:
    """The least and the largest value of a function between rising places, (n,), as ``largest_of_each`` finds them."""
    least, largest = largest_of_each(lambda at: np.stack([-function(at), function(at)]), places)
    return Extremum(-least.value, least.at), largest


def largest_from(
    functions: Callable[[Array], Array], places: Array, values: Array, missed: Array, above: float = -np.inf
) -> list[Extremum]:
    """As ``largest_of_each``, with known values at the places, shape (q, n).

    Largest values are known to ``missed`` (shape (q,)), or to EVEN of themselves where this is more; a largest value up
    to ``above`` is told as ``above``.  Raises Unanswered where values differ only by rounding errors that are more than
    that.
    """
    best = values.argmax(axis=1)
    top, at = np.maximum(values.max(axis=1), above), places[best]
    left = _between(places, values)
    for done in range(ROUNDS):
        left = _worth_cutting(left, top, np.maximum(missed, EVEN * np.abs(top)))
        if not left.owner.size:
            break
        if SHARES * left.owner.size > MOST_PARTS + SHARES * values.size:
            number = int(np.bincount(left.owner).argmax())
            raise Unanswered(
                f"the largest value {top[number]:.3g} was not closed in on, since the values beside it cannot be told "
                "from rounding errors",
                rows=[number],
            )
        parts = 2 if left.owner.size > MANY and done < HALVED else SHARES
        inner = left.inner(parts)
        left = _cut(left, inner, left.own(_evaluated(functions, inner.ravel())))
        for number in distinct(left.owner):
            own = np.nonzero(left.owner == number)[0]
            highest = own[left.at_low[own].argmax()]
            if left.at_low[highest] > top[number]:
                top[number], at[number] = left.at_low[highest], left.low[highest]
    return [Extremum(float(value), float(place)) for value, place in zip(top, at, strict=True)]


def hull_of_each(
    curves: Callable[[Array], ComplexArray], places: Array, values: ComplexArray, missed: Array
) -> list[ComplexArray]:
    """The corners of the convex hull of each of q curves, with known ``values`` (q, n) at rising places, n > 2.

    ``curves`` maps places (m,) to points x + i y, (q, m); the largest part along any direction is known to ``missed``,
    (q,).
    """
    hulls, left = [corners(own) for own in values], _between(places, values)
    for _ in range(ROUNDS):
        each = (left.kept(left.owner == number) for number in range(len(hulls)))
        left = _Intervals.joined([_leaving(*own) for own in zip(each, hulls, missed, strict=True)])
        if not left.owner.size:
            break
        owner, inner = left.owner, left.inner(SHARES)
        found = left.own(_evaluated(curves, inner.ravel()))
        left = _cut(left, inner, found)
        hulls = [corners(np.append(hull, found[owner == number])) for number, hull in enumerate(hulls)]
    return hulls


def _leaving(left: _Intervals, hull: ComplexArray, missed: float) -> _Intervals:
    """The intervals in which a curve may go farther than ``missed`` out of its hull.

    A smooth curve leaves its chord by an eighth of its change of slope over an interval, by which slopes of neighbours
    differ; beside a jump inside it, it leaves it by the slopes beside it.
    """
    length = left.high - left.low
    slope, beside = (left.at_high - left.at_low) / length, np.abs([left.before, left.after])
    bent = np.abs([slope - left.before, slope - left.after]) / 2.0
    leaves = length * np.minimum(bent.max(axis=0), STEEPER * beside.max(axis=0))
    left, leaves = left.kept(leaves > missed), leaves[leaves > missed]
    deep = np.minimum(*(depths(hull, np.asarray(ends, dtype=complex)) for ends in (left.at_low, left.at_high)))
    return left.kept(leaves > missed + deep)


def _evaluated(functions: Callable[[Array], Any], places: Array) -> Any:
    """Values of shape (q, n), one block of rising places after the other; several functions may share an interval."""
    rising, number = np.unique(places, return_inverse=True)
    blocks = np.array_split(rising, -(-rising.size // BLOCK))
    return np.concatenate([functions(block) for block in blocks], axis=1)[:, number]


def _between(places: Array, values: Any) -> _Intervals:
    """All intervals between neighbouring places; beyond the first and the last place slopes go on."""
    slope = np.diff(values, axis=1) / np.diff(places)
    before, after = np.hstack([slope[:, :1], slope[:, :-1]]), np.hstack([slope[:, 1:], slope[:, -1:]])
    owner = np.repeat(np.arange(len(values)), places.size - 1)
    low, high = (np.tile(ends, len(values)) for ends in (places[:-1], places[1:]))
    columns = values[:, :-1], values[:, 1:], before, after
    return _Intervals(owner, np.zeros_like(owner), low, high, *(column.ravel() for column in columns))


def _worth_cutting(left: _Intervals, top: Array, missed: Array) -> _Intervals:
    """The intervals that may lead to more than is known; one of equal intervals."""
    left = left.kept(left.bound > (top + missed)[left.owner])
    unit = np.maximum(ALIKE * missed, LEAST)[left.owner]
    seen = np.column_stack([left.at_low, left.at_high, *left.rises]) / unit[:, None]
    return left.kept(np.sort(equal_rows(np.column_stack([left.owner, np.round(seen)]))[0]))


def _cut(whole: _Intervals, inner: Array, found: Any) -> _Intervals:
    """The parts of intervals that were cut at inner places, shape (k, parts - 1), with the values found there."""
    places = np.column_stack([whole.low, inner, whole.high])
    values = np.column_stack([whole.at_low, found, whole.at_high])
    length = np.diff(places, axis=1)
    slope = np.diff(values, axis=1) / np.where(length > 0.0, length, np.inf)
    over_whole = (whole.at_high - whole.at_low)[:, None]
    stays = np.abs(np.diff(values, axis=1) - over_whole) < STAYS * np.abs(over_whole)
    stayed = np.where(stays, whole.stayed[:, None] + 1, 0)
    jumps = stayed >= JUMPS
    before = np.column_stack([whole.before, np.where(jumps, np.roll(slope, -1, axis=1), slope)[:, :-1]])
    after = np.column_stack([np.where(jumps, np.roll(slope, 1, axis=1), slope)[:, 1:], whole.after])
    owner = np.repeat(whole.owner, length.shape[1])
    columns = places[:, :-1], places[:, 1:], values[:, :-1], values[:, 1:], before, after
    return _Intervals(owner, stayed.ravel(), *(column.ravel() for column in columns))


GOLDEN = (5.0**0.5 - 1.0) / 2.0


def golden_section(function: Callable[[float], float], low: float, high: float, within: float) -> list[Extremum]:
    """Two values next to the least value of a function that falls and then rises between two places.

    The sections end where the places about the two are no more than ``within`` apart.
    """
    places = [high - GOLDEN * (high - low), low + GOLDEN * (high - low)]
    values = [function(place) for place in places]
    while high - low > within:
        if values[0] <= values[1]:
            high, places = places[1], [places[1] - GOLDEN * (places[1] - low), places[0]]
            values = [function(places[0]), values[0]]
        else:
            low, places = places[0], [places[1], places[0] + GOLDEN * (high - places[0])]
            values = [values[1], function(places[1])]
    return [Extremum(value, place) for value, place in zip(values, places, strict=True)]
