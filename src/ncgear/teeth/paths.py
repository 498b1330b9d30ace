"""Whole sides of teeth as polylines with exact parameters: flank and fillet, from the tip to the root."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ncgear.numerics.arrays import Array, IndexArray, Mask
from ncgear.teeth.flank import FILLET, FLANK, Flanks

KINDS = 2
"""Curves of a whole side, numbered FLANK and FILLET in this order."""

FINE = 257
"""Points per curve at which folds are looked for."""

FLAT = 1e-9
"""Regularity, a pure number of order one, that counts as zero."""


@dataclass(frozen=True, eq=False)
class Paths:
    """Sides of n flanks, each of two curves of m points.

    ``parameters`` has shape (n, 2, m), ``points`` (n, 2 m, 2).  Fractional indices count the points along a path; where
    the curves join, the point stands twice.
    """

    flanks: Flanks
    owner: IndexArray
    parameters: Array
    points: Array

    @property
    def count(self) -> int:
        """Points per curve."""
        return int(self.parameters.shape[2])

    def place(self, row: IndexArray, index: Array) -> tuple[IndexArray, Array]:
        """Kind and parameter at fractional indices."""
        kind = np.minimum((index // self.count).astype(int), KINDS - 1)
        local = np.clip(index - kind * self.count, 0.0, self.count - 1.0)
        low = np.minimum(local.astype(int), self.count - 2)
        before, after = self.parameters[row, kind, low], self.parameters[row, kind, low + 1]
        return kind, before + (after - before) * (local - low)

    def index(self, row: IndexArray, kind: IndexArray, parameter: Array) -> Array:
        """Fractional indices of parameters; the inverse of ``place``."""
        numbers = np.arange(self.count, dtype=float)
        found = np.empty(row.size)
        for number, (r, k) in enumerate(zip(row, kind, strict=True)):
            known = self.parameters[r, k]
            order = slice(None) if known[-1] > known[0] else slice(None, None, -1)
            found[number] = k * self.count + np.interp(parameter[number], known[order], numbers[order])
        return found

    def reaches(
        self, row: IndexArray, kind1: IndexArray, first: Array, kind2: IndexArray, second: Array
    ) -> tuple[Array, Array]:
        """How far, in parameters, the crossings of the curves may be from those of their chords.

        A chord and a half of the longer one, on both curves: where a coarse chord crosses fine ones, its sagitta shifts
        the crossing by many of them.
        """
        spacing1, length1 = self._chord(row, kind1, first)
        spacing2, length2 = self._chord(row, kind2, second)
        longer = 1.5 * np.maximum(length1, length2)
        return spacing1 * longer / length1, spacing2 * longer / length2

    def _chord(self, row: IndexArray, kind: IndexArray, index: Array) -> tuple[Array, Array]:
        """Step of the parameter and length in mm of the chords at fractional indices."""
        low = np.clip((index - kind * self.count).astype(int), 0, self.count - 2)
        step = np.abs(self.parameters[row, kind, low + 1] - self.parameters[row, kind, low])
        start = kind * self.count + low
        length = np.linalg.norm(self.points[row, start + 1] - self.points[row, start], axis=1)
        return step, np.maximum(length, 1e-12 * self.flanks.rack.module_mm)

    def folds(self, row: IndexArray, kind: IndexArray, start: Array, end: Array) -> Mask:
        """Whether stretches of the curves, all of shape (r,), still fold anywhere inside."""
        share = (1.0 - np.cos(np.pi * np.linspace(0.01, 0.99, FINE // 4))) / 2.0
        parameter = start[:, None] + (end - start)[:, None] * share
        folds = np.zeros(row.size, dtype=bool)
        for number in range(KINDS):
            mask = kind == number
            folds[mask] = np.any(_folded(self.flanks, self.owner[row[mask]], parameter[mask], number), axis=1)
        return folds


def paths_of(flanks: Flanks, owner: IndexArray, top_mm: Array, root_mm: Array, count: int) -> Paths:
    """The paths of the flanks ``owner``, ``count`` points on each curve.

    From heights ``top_mm`` to fillets' ends at arc lengths ``root_mm``, shape (n,) each.
    """
    depth = flanks.flank_depth_mm[owner]
    start = np.column_stack([top_mm, flanks.rolled_mm(owner, -depth)])
    end = np.column_stack([-depth, root_mm])
    spread = [_spread(flanks, owner, start[:, kind], end[:, kind], kind, count) for kind in range(KINDS)]
    points = [curve(owner[:, None], spread[kind])[0] for kind, curve in enumerate((flanks.flank, flanks.fillet))]
    return Paths(flanks, owner, np.stack(spread, axis=1), np.concatenate(points, axis=1))


def _folded(flanks: Flanks, owner: IndexArray, parameter: Array, kind: int) -> Mask:
    """Where curves do not bound the tooth, at parameters of shape (n, m)."""
    regularity = flanks.regularity if kind == FLANK else flanks.fillet_regularity
    folded: Mask = regularity(owner[:, None], parameter) < -FLAT
    return folded


def _spread(flanks: Flanks, owner: IndexArray, start: Array, end: Array, kind: int, count: int) -> Array:
    """Parameters from start to end, shape (n, count), dense where loops may be small.

    A fillet is crossed near its flank, ever nearer as the undercut gets slighter.  Where a curve folds, half of its
    points stand about the folds.
    """
    even = np.linspace(0.0, 1.0, count)
    share = even**3 if kind == FILLET else even
    spread = start[:, None] + (end - start)[:, None] * share
    fine = start[:, None] + (end - start)[:, None] * np.linspace(0.0, 1.0, FINE)
    folded = _folded(flanks, owner, fine, kind)
    for row in np.nonzero(folded.any(axis=1))[0]:
        near = _about_runs(fine[row], folded[row], count // 2)
        ordered = np.sort(np.concatenate([spread[row, ::2], near]))
        spread[row] = ordered if end[row] > start[row] else ordered[::-1]
    return spread


def _about_runs(values: Array, marked: Mask, count: int) -> Array:
    """``count`` numbers in and about the runs of marked values, and a run's own width to either side of each."""
    edges = np.nonzero(np.diff(np.concatenate([[False], marked, [False]])))[0]
    runs = list(zip(edges[::2], edges[1::2], strict=True))
    shares = np.diff(np.linspace(0, count, len(runs) + 1).astype(int))
    last = len(values) - 1
    pieces = [
        np.linspace(values[max(2 * first - after, 0)], values[min(2 * after - first, last)], share)
        for (first, after), share in zip(runs, shares, strict=True)
    ]
    return np.concatenate(pieces)
