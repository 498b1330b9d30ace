"""The closed outline of a gear, sampled from its exact curves to a chord tolerance."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from ncgear.numerics.arrays import Array, IndexArray, Mask
from ncgear.teeth.flank import CROWN, FILLET, FLANK, Flanks
from ncgear.teeth.sides import Sides

PROBES = 33
"""Points per curve on which its turning is measured to place the chords."""

MARGIN = 0.9
"""Share of the tolerance that is used: the turning is measured on chords, which see a tenth less than the curve."""


@dataclass(frozen=True, eq=False)
class _Stretch:
    """One curve of every flank or land, between two parameters each; ``rank`` orders the curves within a tooth."""

    curve: Callable[[IndexArray, Array], Array]
    owner: IndexArray
    start: Array
    end: Array
    rank: IndexArray


def outline_points(flanks: Flanks, sides: Sides, tolerance_mm: float) -> Array:
    """The outline in mm, shape (n, 2), counter-clockwise, first point not repeated.

    No chord is farther from the exact curve than ``tolerance_mm``.
    """
    points, keys = [], []
    for stretch in _stretches(flanks, sides):
        kept = np.abs(stretch.end - stretch.start) > 1e-12 * flanks.rack.module_mm
        sampled, key = _sampled(stretch, kept, tolerance_mm * MARGIN)
        points.append(sampled)
        keys.append(key)
    joined, order = np.concatenate(points), np.argsort(np.concatenate(keys), kind="stable")
    outline = joined[order]
    return outline[::-1] if _signed_area(outline) < 0.0 else outline


def _stretches(flanks: Flanks, sides: Sides) -> list[_Stretch]:
    """All curves in the sense of growing arc length: a tooth's back from root to tip, land, front, root land."""
    lands = [_tip_lands(flanks, sides), _root_lands(flanks, sides)]
    return [_side_runs(flanks, sides, kind) for kind in (CROWN, FLANK, FILLET)] + lands


def _side_runs(flanks: Flanks, sides: Sides, kind: int) -> _Stretch:
    """Runs of one kind, inwards on front flanks and outwards on back flanks."""
    curve = (flanks.crown, flanks.flank, flanks.fillet)[kind]
    chosen = sides.kind == kind
    owner, start, end = sides.owner[chosen], sides.start[chosen], sides.end[chosen]
    outwards = flanks.side[owner] < 0.0
    step = np.arange(sides.owner.size)[chosen]
    first, last = np.searchsorted(sides.owner, owner), np.searchsorted(sides.owner, owner, side="right") - 1
    rank = np.where(outwards, first + last - step, step)
    return _Stretch(
        lambda i, t: curve(i, t)[0], owner, np.where(outwards, end, start), np.where(outwards, start, end), 4 * rank
    )


def _tip_lands(flanks: Flanks, sides: Sides) -> _Stretch:
    """From each tooth's back to its front flank, after the last run of the back; empty on a pointed tooth."""
    back = np.arange(0, flanks.count, 2)
    start = sides.tip_mm[back]
    end = np.where(sides.pointed[back], start, sides.tip_mm[back + 1])
    rank = 4 * (np.searchsorted(sides.owner, back, side="right") - 1) + 1
    return _Stretch(lambda i, t: flanks.offset(t, flanks.rack.addendum_mm)[0], back, start, end, rank)


def _root_lands(flanks: Flanks, sides: Sides) -> _Stretch:
    """From each tooth's front flank to the next one's back, after the last run of the front."""
    front = np.arange(1, flanks.count, 2)
    next_back = np.append(flanks.rounding_mm[2::2], flanks.rounding_mm[0] + flanks.curve.length_mm)
    rank = 4 * (np.searchsorted(sides.owner, front, side="right") - 1) + 1
    return _Stretch(
        lambda i, t: flanks.offset(t, -flanks.rack.dedendum_mm)[0], front, flanks.rounding_mm[front], next_back, rank
    )


def _sampled(stretch: _Stretch, kept: Mask, tolerance: float) -> tuple[Array, Array]:
    """Points of a stretch without the last of each curve, and keys that order them along the outline."""
    owner, start, end = stretch.owner[kept], stretch.start[kept], stretch.end[kept]
    if not owner.size:
        return np.empty((0, 2)), np.empty(0)
    share = np.linspace(0.0, 1.0, PROBES)
    probe = stretch.curve(owner[:, None], start[:, None] + (end - start)[:, None] * share)
    needed = _chords_needed(probe, tolerance)
    counts = np.maximum(np.ceil(needed[:, -1]), 1).astype(int)
    row = np.repeat(np.arange(owner.size), counts)
    place = np.arange(counts.sum()) - np.repeat(np.cumsum(counts) - counts, counts)
    at = _inverse_rows(needed, share, row, place / counts[row])
    points = stretch.curve(owner[row], start[row] + (end - start)[row] * at)
    return points, stretch.rank[kept][row] + place / counts[row]


def _chords_needed(probe: Array, tolerance: float) -> Array:
    """Cumulated number of chords along each curve: a chord of length d that turns by t misses the curve by d t / 8.

    Rows are scaled to start at 0; shape (n, PROBES).
    """
    chord = np.diff(probe, axis=1)
    length = np.hypot(chord[..., 0], chord[..., 1])
    area = chord[:, :-1, 0] * chord[:, 1:, 1] - chord[:, :-1, 1] * chord[:, 1:, 0]
    turn = np.abs(np.arctan2(area, np.sum(chord[:, :-1] * chord[:, 1:], axis=2)))
    turn = np.concatenate([turn[:, :1], (turn[:, 1:] + turn[:, :-1]) / 2.0, turn[:, -1:]], axis=1)
    density = np.sqrt(length * turn / (8.0 * tolerance)) + 1e-9
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
