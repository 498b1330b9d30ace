"""The closed outline of a gear, sampled from its exact curves to a chord tolerance."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from ncgear.numerics.arrays import Array, IndexArray, Mask
from ncgear.teeth.flank import FILLET, FLANK, Flanks
from ncgear.teeth.sides import Sides
from ncgear.teeth.tips import Tips

PROBES = 33
"""Points per curve between which its turning is measured to place the chords."""

PLACED = 0.95
"""Share of the tolerance for which chords are placed: between probes the turning is known to a few per cent only."""

HALVINGS = 12
"""Rounds of halving chords that stray too far: near a cusp the turning is not seen by the probes."""


@dataclass(frozen=True)
class ChordTolerance:
    """How far chords may stray from the exact curve: on the working flanks, and on fillets and lands."""

    flanks_mm: float
    elsewhere_mm: float


@dataclass(frozen=True, eq=False)
class _Stretch:
    """One curve of every flank or land, between two parameters each.

    ``rolled`` are the arc lengths at which the two parameters touch, shape (2, n); between them it is linear in the
    parameter.  ``rank`` orders the curves along the outline, ``span`` is the part of the rank up to the next that a row
    takes.
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

    def kept(self, rows: Mask | IndexArray) -> _Stretch:
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


def outline_points(tips: Tips, sides: Sides, chords: ChordTolerance) -> Array:
    """The outline in mm, shape (n, 2), counter-clockwise, first point not repeated.

    No chord is farther from the exact curve than its tolerance.
    """
    flanks = tips.flanks
    points, keys = [], []
    joints = flanks.curve.joints_around_mm
    for stretch, tolerance in _stretches(tips, sides, chords):
        real = stretch.kept(np.abs(stretch.end - stretch.start) > 1e-12 * flanks.rack.module_mm)
        sampled, key = _sampled(_split(real, joints), tolerance)
        points.append(sampled)
        keys.append(key)
    joined, order = np.concatenate(points), np.argsort(np.concatenate(keys), kind="stable")
    outline = joined[order]
    return outline[::-1] if _signed_area(outline) < 0.0 else outline


def _stretches(tips: Tips, sides: Sides, chords: ChordTolerance) -> list[tuple[_Stretch, float]]:
    """All curves in the sense of growing arc length: a tooth's back from root to tip, land, front, root land."""
    flanks, runs = tips.flanks, _side_runs(tips.flanks, sides, FLANK)
    parts = _parted(runs, -tips.met_depth_mm[runs.owner])
    works = (parts.start + parts.end) / 2.0 > -tips.met_depth_mm[parts.owner]
    elsewhere = (_side_runs(flanks, sides, FILLET), _tip_lands(flanks, sides), _root_lands(flanks, sides))
    return [
        (parts.kept(works), chords.flanks_mm),
        *((curve, chords.elsewhere_mm) for curve in (parts.kept(~works), *elsewhere)),
    ]


def _parted(stretch: _Stretch, cut: Array) -> _Stretch:
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


def _joined(first: _Stretch, second: _Stretch) -> _Stretch:
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


def _side_runs(flanks: Flanks, sides: Sides, kind: int) -> _Stretch:
    """Runs of one kind, inwards on front flanks and outwards on back flanks."""
    curve = (flanks.flank, flanks.fillet)[kind]
    chosen = sides.kind == kind
    owner, start, end = sides.owner[chosen], sides.start[chosen], sides.end[chosen]
    outwards = flanks.side[owner] < 0.0
    step = np.arange(sides.owner.size)[chosen]
    first, last = np.searchsorted(sides.owner, owner), np.searchsorted(sides.owner, owner, side="right") - 1
    rank = np.where(outwards, first + last - step, step)
    start, end = np.where(outwards, end, start), np.where(outwards, start, end)
    rolled = np.array([start, end] if kind != FLANK else [flanks.rolled_mm(owner, start), flanks.rolled_mm(owner, end)])
    return _Stretch(curve, owner, start, end, rolled, 4.0 * rank, np.ones(rank.size))


def _tip_lands(flanks: Flanks, sides: Sides) -> _Stretch:
    """From each tooth's back to its front flank, after the last run of the back.

    Parallel to the pitch curve, or straight where the two flanks end at different heights.
    """
    back = np.arange(0, flanks.count, 2)
    start, end = sides.tip_mm[back], sides.tip_mm[back + 1]
    edges = flanks.offset(sides.tip_mm, flanks.tip_height_mm)[0].reshape(-1, 2, 2)
    slopes = flanks.tip_height_mm[back] != flanks.tip_height_mm[back + 1]

    def curve(flank: IndexArray, sigma: Array) -> tuple[Array, Array]:
        tooth = flank // 2
        length = (end - start)[tooth][..., None]
        chord = (edges[tooth, 1] - edges[tooth, 0]) / length
        straight = edges[tooth, 0] + (sigma - start[tooth])[..., None] * chord
        parallel, slope = flanks.offset(sigma, flanks.tip_height_mm[flank])
        chosen = slopes[tooth][..., None]
        return np.where(chosen, straight, parallel), np.where(chosen, chord, slope)

    return _lands(curve, sides, back, start, end)


def _root_lands(flanks: Flanks, sides: Sides) -> _Stretch:
    """From each tooth's front flank to the next one's back, after the last run of the front."""
    start, end = sides.roots.lands()
    return _lands(
        lambda flank, sigma: sides.roots.land(flank // 2, sigma), sides, np.arange(1, flanks.count, 2), start, end
    )


def _lands(
    curve: Callable[[IndexArray, Array], tuple[Array, Array]], sides: Sides, owner: IndexArray, start: Array, end: Array
) -> _Stretch:
    """Lands after the last runs of their owners, every other flank."""
    last_run = np.searchsorted(sides.owner, owner, side="right") - 1
    rank, rolled = np.asarray(4.0 * last_run + 1.0, dtype=float), np.array([start, end])
    return _Stretch(curve, owner, start, end, rolled, rank, np.ones(rank.size))


def _split(stretch: _Stretch, joints: Array) -> _Stretch:
    """The stretch cut where a joint is rolled over, since a curve's turning must not be averaged across a jump."""
    low, high = stretch.rolled.min(axis=0), stretch.rolled.max(axis=0)
    first, last = np.searchsorted(joints, low, side="right"), np.searchsorted(joints, high, side="left")
    counts = np.maximum(last - first, 0)
    cut = np.repeat(np.arange(counts.size), counts)
    joint = joints[np.arange(cut.size) - np.repeat(np.cumsum(counts) - counts, counts) + first[cut]]
    share_cut = (joint - stretch.rolled[0, cut]) / (stretch.rolled[1, cut] - stretch.rolled[0, cut])
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


def _sampled(stretch: _Stretch, tolerance: float) -> tuple[Array, Array]:
    """Points of a stretch without the last of each curve, and keys that order them along the outline."""
    every = np.arange(stretch.owner.size)
    if not every.size:
        return np.empty((0, 2)), np.empty(0)
    share = np.linspace(0.0, 1.0, PROBES)
    needed = _chords_needed(*stretch.at(every[:, None], share), tolerance * PLACED)
    counts = np.maximum(np.ceil(needed[:, -1]), 1).astype(int)
    row = np.repeat(every, counts)
    place = np.arange(counts.sum()) - np.repeat(np.cumsum(counts) - counts, counts)
    at = _inverse_rows(needed, share, row, place / counts[row])
    row, at, points = _with_halves(stretch, row, at, tolerance)
    return points, stretch.rank[row] + stretch.span[row] * at


def _with_halves(stretch: _Stretch, row: IndexArray, share: Array, tolerance: float) -> tuple[IndexArray, Array, Array]:
    """Rows, shares and points, with points added until no chord's curve strays from it by more than the tolerance.

    The last point of each row is checked against but not returned; what comes out is in no order.
    """
    last = np.append(row[1:] != row[:-1], True)
    low, high = share, np.where(last, 1.0, np.append(share[1:], 1.0))
    points = stretch.at(row, share)[0]
    ends = np.roll(points, -1, axis=0)
    ends[last] = stretch.at(row[last], np.ones(int(last.sum())))[0]
    found = [(row, share, points)]
    chords, start, end = (row, low, high), points, ends
    for _ in range(HALVINGS):
        rows, low, high = chords
        middle = (low + high) / 2.0
        between, slope = stretch.at(rows, middle)
        astray = _strayed(start, end, between, slope * (high - low)[:, None]) > tolerance
        if not astray.any():
            break
        rows, low, middle, high = rows[astray], low[astray], middle[astray], high[astray]
        found.append((rows, middle, between[astray]))
        chords = np.tile(rows, 2), np.concatenate([low, middle]), np.concatenate([middle, high])
        start, end = (np.concatenate([start[astray], between[astray]]), np.concatenate([between[astray], end[astray]]))
    rows, shares, added = (np.concatenate(parts) for parts in zip(*found, strict=True))
    return rows, shares, added


def _strayed(start: Array, end: Array, middle: Array, slope: Array) -> Array:
    """How far a curve strays from its chords at most, shape (n,), from its middle and its slope by the share there.

    Across the chord the curve is taken as a cubic that starts and ends on it: with d in the middle and the slope d'
    there, it strays by sqrt(d^2 + d'^2 / 8) or less.
    """
    chord = end - start
    across = np.stack([-chord[:, 1], chord[:, 0]], axis=1) / np.maximum(np.hypot(*chord.T), 1e-300)[:, None]
    off, tilt = np.sum(across * (middle - start), axis=1), np.sum(across * slope, axis=1)
    strayed: Array = np.sqrt(off**2 + tilt**2 / 8.0)
    return strayed


def _chords_needed(probe: Array, slope: Array, tolerance: float) -> Array:
    """Cumulated number of chords along each curve: a chord of length d that turns by t misses the curve by d t / 8.

    Turning is taken from the curves' slopes, which give it exactly from probe to probe.  Rows are scaled to start at 0;
    shape (n, PROBES).
    """
    chord = np.diff(probe, axis=1)
    before, after = slope[:, :-1], slope[:, 1:]
    area = before[..., 0] * after[..., 1] - before[..., 1] * after[..., 0]
    turn = np.abs(np.arctan2(area, np.sum(before * after, axis=2)))
    density = np.sqrt(np.hypot(chord[..., 0], chord[..., 1]) * turn / (8.0 * tolerance)) + 1e-9
    return np.concatenate([np.zeros((len(probe), 1)), np.cumsum(density, axis=1)], axis=1)


def _inverse_rows(needed: Array, share: Array, row: IndexArray, fraction: Array) -> Array:
    """Shares of the parameter at which the cumulated number reaches the given fractions of its total, row by row."""
    target = fraction * needed[row, -1]
    step = np.sum(needed[row, 1:-1] <= target[:, None], axis=1)
    low, high = needed[row, step], needed[row, step + 1]
    placed: Array = share[step] + (share[step + 1] - share[step]) * (target - low) / (high - low)
    return placed


def _signed_area(outline: Array) -> float:
    x, y = outline.T
    return float(np.sum(x * np.roll(y, -1) - y * np.roll(x, -1))) / 2.0
