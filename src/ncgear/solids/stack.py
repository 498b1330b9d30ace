"""A stack of one gear's sections, with corresponding points on all of them, and how the mesh between them strays."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import shapely

from ncgear.numerics.arrays import Array, IndexArray
from ncgear.numerics.plane import signed_area
from ncgear.solids.columns import TINY, Columns, Limits, close_columns
from ncgear.solids.loft import middle_section
from ncgear.solids.pieces import Pieces


@dataclass(frozen=True, eq=False)
class Stack:
    """Sections at rising heights (shape (l,)), and their points at the columns, shape (l, c, 2), in mm."""

    heights_mm: Array
    columns: Columns
    rings_mm: Array

    def counter_clockwise(self) -> Array:
        """The rings in that sense."""
        return self.rings_mm if signed_area(self.rings_mm[0]) > 0.0 else self.rings_mm[:, ::-1]

    def seems_to_stray_mm(self) -> Array:
        """About how far straight lines stray within each step from one section to the next, shape (l - 1,).

        A section is off the straight line between its neighbours, p below and q above, by X'' p q / 2, across the
        outline; straight lines within a step h are off by X'' h^2 / 8.  The worse end of each step counts.
        """
        step = np.diff(self.heights_mm)
        below, above = step[:-1], step[1:]
        rise = (below / (below + above))[:, None, None]
        off = self.rings_mm[:-2] * (1.0 - rise) + self.rings_mm[2:] * rise - self.rings_mm[1:-1]
        along = (np.roll(self.rings_mm, -1, axis=1) - np.roll(self.rings_mm, 1, axis=1))[1:-1]
        area = np.abs(off[..., 0] * along[..., 1] - off[..., 1] * along[..., 0])
        across = np.max(area / np.maximum(np.linalg.norm(along, axis=2), TINY), axis=1, initial=0.0)
        bend = np.pad(across / (4.0 * below * above), 1)
        return np.asarray(np.maximum(bend[:-1], bend[1:]) * step**2)

    def strays_mm(self, steps: IndexArray, sections: Sequence[Pieces]) -> Array:
        """Distances between the mesh half way up s steps and exact sections there, the largest after each column.

        Both from the outlines to the mesh and the other way round; shape (s, c).
        """
        rings = middle_section(self.rings_mm[steps], self.rings_mm[steps + 1])
        found = [_apart(ring, section.points_mm[:-1]) for ring, section in zip(rings, sections, strict=True)]
        # Two chords of a middle section lie between neighbouring columns.
        return np.asarray(np.stack(found).reshape(len(found), -1, 2).max(axis=2))


def stacked(heights_mm: Array, sections: Sequence[Pieces], columns: Columns, limits: Limits) -> Stack:
    """The stack of sections at heights (l,), with as many more columns as they need to keep the limits."""
    close = close_columns(columns, sections, limits)
    return Stack(heights_mm, close, close.rings(sections))


def _apart(ring: Array, outline: Array) -> Array:
    """Largest distance between a ring (m, 2) and an outline (n, 2) at each chord of the ring, shape (m,)."""
    chord, away = _nearest(outline, ring)
    largest = _nearest(ring, outline)[1]
    np.maximum.at(largest, chord, away)
    return largest


def _nearest(points: Array, ring: Array) -> tuple[IndexArray, Array]:
    """Number of the chord of a closed ring (m, 2) that is nearest to each point (n, 2), and how far it is."""
    chords = shapely.STRtree(shapely.linestrings(np.stack([ring, np.roll(ring, -1, axis=0)], axis=1)))
    (_, chord), away = chords.query_nearest(shapely.points(points), all_matches=False, return_distance=True)
    return chord, away
