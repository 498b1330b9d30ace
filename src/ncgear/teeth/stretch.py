"""Stretches of the curves that make an outline: a curve of every flank or land, between two parameters each."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array, IndexArray, Mask, counted_up
from ncgear.numerics.plane import as_complex, as_points

Curve = Callable[[IndexArray, Array], tuple[Array, Array]]
"""From owners and parameters (shapes broadcast) to points and derivatives by the parameter, shape (..., 2)."""

BY_ROW = ("owner", "start", "end", "rolled", "rank", "span", "most_turning", "kind")
"""The fields of stretches with rows along the last axis, in order."""


@dataclass(frozen=True, eq=False)
class CurveStretch:
    """A curve of every flank or land, n in all, between two parameters each.

    ``curve`` maps owners and parameters to points and derivatives.  ``owner`` numbers the flanks, ``start`` and ``end``
    are the parameters, shape (n,) each.  ``rolled`` (shape (2, n)) holds the arc lengths at which both ends touch;
    between them arc length is linear in the parameter.  ``rank`` orders the rows along the outline, and ``span`` is the
    part of the way to the next rank that a row takes, shape (n,) each.  ``most_turning`` (shape (n,)) bounds the
    turning of a row to either side, in rad per mm of arc length, infinite where unknown.  ``kind`` (shape (n,)) numbers
    the curves that were joined into this stretch.
    """

    curve: Curve
    owner: IndexArray
    start: Array
    end: Array
    rolled: Array
    rank: Array
    span: Array
    most_turning: Array
    kind: IndexArray

    def at(self, rows: IndexArray, share: Array) -> tuple[Array, Array]:
        """Points of rows at shares of their way from start to end, and derivatives by the share; shapes broadcast."""
        span = (self.end - self.start)[rows]
        point, slope = self.curve(self.owner[rows], self.start[rows] + span * share)
        return point, as_points(span * as_complex(slope))

    def kept(self, rows: Mask | IndexArray) -> CurveStretch:
        """The chosen rows."""
        return replace(self, **{name: getattr(self, name)[..., rows] for name in BY_ROW})


def parted(stretch: CurveStretch, cut: Array) -> CurveStretch:
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
    return _of(stretch.curve, [first, rest])


def joined(stretches: Sequence[CurveStretch]) -> CurveStretch:
    """The rows of several stretches as a single curve, with the rows' numbers as owners, in order."""
    counts = [stretch.owner.size for stretch in stretches]
    first = np.cumsum([0, *counts])

    def curve(owner: IndexArray, parameter: Array) -> tuple[Array, Array]:
        begin = np.searchsorted(owner.reshape(len(owner), -1)[:, 0], first)
        found = [
            stretch.curve(stretch.owner[owner[low:high] - before], parameter[low:high])
            for stretch, before, low, high in zip(stretches, first[:-1], begin[:-1], begin[1:], strict=True)
            if high > low
        ]
        points, slopes = (np.concatenate(arrays) for arrays in zip(*found, strict=True))
        return points, slopes

    return replace(_of(curve, stretches), owner=np.arange(first[-1]), kind=np.repeat(np.arange(len(counts)), counts))


def _of(curve: Curve, parts: Sequence[CurveStretch]) -> CurveStretch:
    """The rows of all parts, as a single curve."""
    return CurveStretch(curve, *(np.concatenate([getattr(part, name) for part in parts], axis=-1) for name in BY_ROW))


def split(stretch: CurveStretch, joints: Array) -> CurveStretch:
    """The stretch, cut at joints, since a curve's turning must not be averaged across a jump."""
    low, high = stretch.rolled.min(axis=0), stretch.rolled.max(axis=0)
    first, last = np.searchsorted(joints, low, side="right"), np.searchsorted(joints, high, side="left")
    counts = np.maximum(last - first, 0)
    if not counts.any():
        return stretch
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
