"""A stack of one gear's sections, with corresponding points on all of them, and how the mesh between them strays."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import shapely

from ncgear.numerics.arrays import Array
from ncgear.solids.columns import columns_for
from ncgear.solids.loft import middle_section, signed_area
from ncgear.solids.pieces import pieces_of
from ncgear.teeth.gear import ToothedGear


@dataclass(frozen=True, eq=False)
class Stack:
    """Rings of corresponding points, counter-clockwise, shape (l, c, 2) in mm, at rising heights, shape (l,)."""

    heights_mm: Array
    rings_mm: Array

    def mirrored(self) -> Stack:
        """The same up to the last section and from there down again, as herringbone teeth go."""
        top = 2.0 * self.heights_mm[-1]
        return Stack(
            np.concatenate([self.heights_mm, top - self.heights_mm[-2::-1]]),
            np.concatenate([self.rings_mm, self.rings_mm[-2::-1]]),
        )

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
        across = np.max(area / np.maximum(np.linalg.norm(along, axis=2), np.finfo(float).tiny), axis=1, initial=0.0)
        bend = np.pad(across / (4.0 * below * above), 1)
        return np.asarray(np.maximum(bend[:-1], bend[1:]) * step**2)

    def strays_mm(self, step: int, outline_mm: Array) -> float:
        """Largest distance between an outline, shape (n, 2), and the mesh half way up a step, either from the other."""
        ring = middle_section(self.rings_mm[step], self.rings_mm[step + 1])
        return max(_farthest(outline_mm, ring), _farthest(ring, outline_mm))


def stacked(heights_mm: Array, sections: Sequence[ToothedGear], sagitta_mm: float, twist_mm: float) -> Stack:
    """The stack of a gear's sections at heights (l,), sampled as ``columns_for`` does it."""
    pieces = pieces_of(sections)
    rings = columns_for(pieces, sagitta_mm, twist_mm).rings(pieces)
    return Stack(heights_mm, rings if signed_area(rings[0]) > 0.0 else rings[:, ::-1])


def _farthest(points: Array, ring: Array) -> float:
    """Largest distance of points (n, 2) from a closed ring (m, 2)."""
    chords = shapely.STRtree(shapely.linestrings(np.stack([ring, np.roll(ring, -1, axis=0)], axis=1)))
    nearest = chords.query_nearest(shapely.points(points), all_matches=False, return_distance=True)
    return float(np.max(nearest[1]))
