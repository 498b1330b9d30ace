"""Chords along many curves at once: as few as a tolerance allows, and none that strays from its curve by more.

A chord of length d along which the curve turns by t misses the curve by d t / 8, so a curve needs the integral of
sqrt(ds dt / (8 tolerance)) chords.  They are placed at even shares of that integral, checked, and halved where they
stray too far.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from ncgear.errors import WrongInput
from ncgear.numerics.arrays import Array, IndexArray, Mask, counted_up

PROBES = 33
"""Points per curve between which its turning is measured to place the chords."""

SHARES = np.linspace(0.0, 1.0, PROBES)
"""Shares of the way along the curve at which these points are."""

PLACED = 0.95
"""Share of the tolerance for which chords are placed: between probes the turning is known to a few per cent only."""

MOST_CHORDS, MOST_OF_ONE = 30_000, 25
"""Chords of all curves together, and of each where there are very many curves: a minute and 3 GB of all that follows.

Teeth of a usual module take some twenty points each; their number grows with the root of module over tolerance.
"""

HALVINGS = 12
"""Rounds of halving chords that stray too far: near a cusp the turning is not seen by the probes."""


@dataclass(frozen=True, eq=False)
class Stretch:
    """One curve of every flank or land, n in all, between two parameters each.

    ``curve`` maps owners and parameters to points and derivatives.  ``owner`` numbers the flanks, ``start`` and ``end``
    are the parameters, shape (n,) each.  ``rolled`` (shape (2, n)) holds the arc lengths at which both ends touch;
    between them arc length is linear in the parameter.  ``rank`` orders the rows along the outline, and ``span`` is the
    part of the way to the next rank that a row takes, shape (n,) each.
    """

    curve: Callable[[IndexArray, Array], tuple[Array, Array]]
    owner: IndexArray
    start: Array
    end: Array
    rolled: Array
    rank: Array
    span: Array

    def at(self, rows: IndexArray, share: Array) -> tuple[Array, Array]:
        """Points of rows at shares of their way from start to end, and derivatives by the share; shapes broadcast."""
        span = (self.end - self.start)[rows]
        point, slope = self.curve(self.owner[rows], self.start[rows] + span * share)
        return point, span[..., None] * slope

    def kept(self, rows: Mask | IndexArray) -> Stretch:
        """The chosen rows."""
        return replace(
            self,
            owner=self.owner[rows],
            start=self.start[rows],
            end=self.end[rows],
            rolled=self.rolled[:, rows],
            rank=self.rank[rows],
            span=self.span[rows],
        )


def parted(stretch: Stretch, cut: Array) -> Stretch:
    """The stretch with each row parted in two where its parameter is ``cut``, if that lies inside."""
    share = (cut - stretch.start) / (stretch.end - stretch.start)
    inside = (share > 0.0) & (share < 1.0)
    share = np.where(inside, share, 1.0)
    rolled = stretch.rolled[0] + share * (stretch.rolled[1] - stretch.rolled[0])
    end = np.where(inside, cut, stretch.end)
    first = replace(stretch, end=end, rolled=np.array([stretch.rolled[0], rolled]), span=share * stretch.span)
    rest = replace(
        stretch,
        start=end,
        rolled=np.array([rolled, stretch.rolled[1]]),
        rank=stretch.rank + share * stretch.span,
        span=(1.0 - share) * stretch.span,
    ).kept(inside)
    return _joined(first, rest)


def _joined(first: Stretch, second: Stretch) -> Stretch:
    """The rows of two stretches of the same curve."""
    return replace(
        first,
        owner=np.concatenate([first.owner, second.owner]),
        start=np.concatenate([first.start, second.start]),
        end=np.concatenate([first.end, second.end]),
        rolled=np.concatenate([first.rolled, second.rolled], axis=1),
        rank=np.concatenate([first.rank, second.rank]),
        span=np.concatenate([first.span, second.span]),
    )


def split(stretch: Stretch, joints: Array) -> Stretch:
    """The stretch, cut where it rolls over a joint, since a curve's turning must not be averaged across a jump."""
    low, high = stretch.rolled.min(axis=0), stretch.rolled.max(axis=0)
    first, last = np.searchsorted(joints, low, side="right"), np.searchsorted(joints, high, side="left")
    counts = np.maximum(last - first, 0)
    cut, number = counted_up(first, counts)
    share_cut = (joints[number] - stretch.rolled[0, cut]) / (stretch.rolled[1, cut] - stretch.rolled[0, cut])
    every = np.arange(counts.size)
    row, share = np.concatenate([every, cut]), np.concatenate([np.zeros(counts.size), share_cut])
    order = np.lexsort((share, row))
    row, share = row[order], share[order]
    following = np.append(np.where(np.diff(row) == 0, share[1:], 1.0), 1.0)
    parts = stretch.kept(row)
    length = parts.end - parts.start
    return replace(
        parts,
        start=parts.start + length * share,
        end=np.where(following == 1.0, parts.end, parts.start + length * following),
        rank=parts.rank + share * parts.span,
        span=(following - share) * parts.span,
    )


def sampled(stretch: Stretch, tolerance: float) -> tuple[Array, Array]:
    """Points of a stretch, without the last point of each curve, and keys that order them along the outline."""
    row, at = _placed(stretch, tolerance)
    row, at, points = _with_halves(stretch, row, at, np.full(row.size, tolerance), tolerance)
    return points, stretch.rank[row] + stretch.span[row] * at


END_CHORD = 4.0
"""Sagittas by which the inner end of the first or the last chord stands off its curve, so that the chord is tangent to
the curve where it ends on it."""


HOLLOW = 0.8
"""Share of the tolerance for which chords of curves that may be hollow are placed.  Where such a curve begins to bulge,
a chord strays by its sagitta and by what its ends stand off."""


def sampled_within(stretch: Stretch, tolerance: float, material: float) -> tuple[Array, Array]:
    """As ``sampled``, with chords that stray into the material only, which lies to the left (+1) or to the right (-1).

    Where a curve is hollow the points stand off it by the sagitta of the chords beside them, so that chords touch it in
    their middles.  The ends of the curves are on the curves: a first or last chord is tangent to the curve there, and
    so short that its other end stands off by the tolerance at most.
    """
    hollow, most = HOLLOW * tolerance, PLACED * tolerance
    row, at = _placed(stretch, hollow)
    row, at, _ = _with_halves(stretch, row, at, np.full(row.size, hollow), hollow)
    order = np.lexsort((at, row))
    row, at = row[order], at[order]
    for _ in range(HALVINGS):
        first, last = np.diff(row, prepend=-1) != 0, np.diff(row, append=-1) != 0
        out, within = _both_sides(stretch, row, at, material)
        raised = out * np.where(first | last, END_CHORD, 1.0)
        off = np.where(first, 0.0, np.maximum(np.roll(raised, 1), raised))
        # How far a chord strays in its middle from a curve that bulges between two points that stand off it.
        bulging = within + (off + np.where(last, 0.0, np.roll(off, -1))) / 2.0
        cut = np.nonzero((first & last & (out > 0.0)) | (raised > most) | ((within > 0.0) & (bulging > most)))[0]
        if not cut.size:
            break
        row, at = np.insert(row, cut + 1, row[cut]), np.insert(at, cut + 1, (at[cut] + _ends(row, at)[cut]) / 2.0)
    else:
        raise ArithmeticError("chords of a hollow curve were not found")
    points, slope = stretch.at(row, at)
    return points + (material * off)[:, None] * _left(slope), stretch.rank[row] + stretch.span[row] * at


def _both_sides(stretch: Stretch, row: IndexArray, share: Array, material: float) -> tuple[Array, Array]:
    """How far chords stand out of the material and how far they cut into it, at most; shape (n,) each."""
    off, tilt, _ = _middles(stretch, row, share)
    # As in _strayed, where the curve goes to both sides.
    both = np.where(np.abs(tilt) > 2.0 * np.abs(off), np.sqrt(off**2 + tilt**2 / 8.0), 0.0)
    return np.maximum(material * off, both), np.maximum(-material * off, both)


def straddled(stretch: Stretch, tolerance: float) -> tuple[Array, Array]:
    """As ``sampled``, with chords that stray to both sides of the curves, by at most the tolerance.

    A chord may then be longer by the square root of 2.  Points stand off the curves by half of the chords' sagitta;
    the ends of the curves, and points where a curve bends the other way, are on the curves.
    """
    row, at = _placed(stretch, 2.0 * tolerance)
    sagitta, across = _sagittas(stretch, row, at)
    shift = _standing_off(row, sagitta, tolerance)[:, None] * _left(stretch.at(row, at)[1])
    following = np.where((np.diff(row, append=-1) == 0)[:, None], np.roll(shift, -1, axis=0), 0.0)
    # A whole chord stands off at least as far as the nearer of its ends, and strays that much less to the other side.
    taken = np.sign(sagitta) * np.sum([shift * across, following * across], axis=2)
    allowed = tolerance + np.maximum(taken.min(axis=0), 0.0)
    row, at, points = _with_halves(stretch, row, at, allowed, tolerance)
    points[: len(shift)] += shift
    return points, stretch.rank[row] + stretch.span[row] * at


def _standing_off(row: IndexArray, sagitta: Array, tolerance: float) -> Array:
    """How far to the left of its curve each chord's beginning is put: half the smaller sagitta of the chords beside it.

    Zero at the beginning of a row, and where the two chords lie on different sides of the curve.
    """
    before = np.roll(sagitta, 1)
    inner = (np.diff(row, prepend=-1) == 0) & (before * sagitta > 0.0)
    off = np.minimum(np.minimum(np.abs(before), np.abs(sagitta)) / 2.0, tolerance)
    return np.where(inner, np.sign(sagitta) * off, 0.0)


def _placed(stretch: Stretch, tolerance: float) -> tuple[IndexArray, Array]:
    """Row and share of the beginning of every chord."""
    every = np.arange(stretch.owner.size)
    needed = _chords_needed(*stretch.at(every[:, None], SHARES), tolerance * PLACED)
    _refuse_too_many(float(np.sum(needed[:, -1])), max(MOST_CHORDS, MOST_OF_ONE * every.size))
    counts = np.maximum(np.ceil(needed[:, -1]), 1).astype(int)
    row, place = counted_up(np.zeros_like(counts), counts)
    return row, _inverse_rows(needed, row, place / counts[row])


def _refuse_too_many(needed: float, most: int) -> None:
    """Raise WrongInput where a tolerance is out of all proportion to the curves."""
    if needed > most:
        raise WrongInput(
            f"the teeth are so large for it that flanks, fillets or lands need {needed:.3g} points; at most {most} are "
            f"made: at least {(needed / most) ** 2:.2g} times the tolerance, or so much less module_mm, is right",
            key="output.chord_tolerance_mm",
        )


def _sagittas(stretch: Stretch, row: IndexArray, share: Array) -> tuple[Array, Array]:
    """How far to the left of each chord's middle its curve is, and the chords' unit vectors to the left.

    Shapes (n,) and (n, 2).  The distance is zero where the curve goes to both sides.
    """
    off, tilt, across = _middles(stretch, row, share)
    return np.where(np.abs(tilt) <= 2.0 * np.abs(off), off, 0.0), across


def _middles(stretch: Stretch, row: IndexArray, share: Array) -> tuple[Array, Array, Array]:
    """How far to the left of each chord's middle its curve is, its slope there, and unit vectors to the chords' left.

    The slope is by the share of the chord.  A cubic goes to both sides of its chord if that is more than twice the
    distance.  Shapes (n,), (n,) and (n, 2).
    """
    high = _ends(row, share)
    start, end = stretch.at(row, share)[0], stretch.at(row, high)[0]
    middle, slope = stretch.at(row, (share + high) / 2.0)
    across = _left(end - start)
    return np.sum(across * (middle - start), axis=1), np.sum(across * slope, axis=1) * (high - share), across


def _left(direction: Array) -> Array:
    """Unit vectors to the left of directions, shape (n, 2) each."""
    length = np.maximum(np.hypot(direction[:, 0], direction[:, 1]), 1e-300)
    return np.stack([-direction[:, 1], direction[:, 0]], axis=1) / length[:, None]


def _ends(row: IndexArray, share: Array) -> Array:
    """Share of every chord's end, from the shares of all beginnings."""
    return np.where(np.append(row[1:] != row[:-1], True), 1.0, np.append(share[1:], 1.0))


def _with_halves(
    stretch: Stretch, row: IndexArray, share: Array, allowed: Array, tolerance: float
) -> tuple[IndexArray, Array, Array]:
    """Rows, shares and points, with points added until no chord strays too far from its curve.

    A given chord may stray by its ``allowed``, a halved one by the tolerance.  Added points come after the given ones;
    the last point of each row ends a chord but is not returned.
    """
    chords = row, share, _ends(row, share)
    start, end = stretch.at(row, share)[0], stretch.at(row, chords[2])[0]
    found = [(row, share, start)]
    for _ in range(HALVINGS):
        rows, low, high = chords
        middle = (low + high) / 2.0
        between, slope = stretch.at(rows, middle)
        astray = _strayed(start, end, between, slope * (high - low)[:, None]) > allowed
        if not astray.any():
            break
        rows, low, middle, high = rows[astray], low[astray], middle[astray], high[astray]
        found.append((rows, middle, between[astray]))
        chords = np.tile(rows, 2), np.concatenate([low, middle]), np.concatenate([middle, high])
        start, end = (np.concatenate([start[astray], between[astray]]), np.concatenate([between[astray], end[astray]]))
        allowed = np.full(2 * rows.size, tolerance)
    rows, shares, points = (np.concatenate(parts) for parts in zip(*found, strict=True))
    return rows, shares, points


def _strayed(start: Array, end: Array, middle: Array, slope: Array) -> Array:
    """How far curves stray at most from their chords, shape (n,), from their middles and slopes by the share there.

    Across the chord the curve is taken as a cubic that starts and ends on the chord: with the distance d and the slope
    d' in the middle, it strays by sqrt(d^2 + d'^2 / 8) or less.
    """
    across = _left(end - start)
    off, tilt = np.sum(across * (middle - start), axis=1), np.sum(across * slope, axis=1)
    strayed: Array = np.sqrt(off**2 + tilt**2 / 8.0)
    return strayed


def _chords_needed(probe: Array, slope: Array, tolerance: float) -> Array:
    """Number of chords needed from the start of each curve to each of its probes, shape (n, PROBES).

    The curves' slopes give the turning from probe to probe exactly.
    """
    chord = np.diff(probe, axis=1)
    before, after = slope[:, :-1], slope[:, 1:]
    area = before[..., 0] * after[..., 1] - before[..., 1] * after[..., 0]
    turn = np.abs(np.arctan2(area, np.sum(before * after, axis=2)))
    density = np.sqrt(np.hypot(chord[..., 0], chord[..., 1]) * turn / (8.0 * tolerance)) + 1e-9
    return np.concatenate([np.zeros((len(probe), 1)), np.cumsum(density, axis=1)], axis=1)


def _inverse_rows(needed: Array, row: IndexArray, fraction: Array) -> Array:
    """Shares of the parameter at which the number of chords reaches the given fractions of its total, row by row."""
    target = fraction * needed[row, -1]
    step = np.sum(needed[row, 1:-1] <= target[:, None], axis=1)
    low, high = needed[row, step], needed[row, step + 1]
    placed: Array = SHARES[step] + (SHARES[step + 1] - SHARES[step]) * (target - low) / (high - low)
    return placed
