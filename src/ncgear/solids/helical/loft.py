"""A closed mesh lofted through rings of corresponding points, with straight holes from end to end.

Between two rings each quadrilateral is folded along its shorter diagonal, which on a round body is the one that stays
nearer to it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import mapbox_earcut
import numpy as np
from trimesh import Trimesh

from ncgear.numerics.arrays import Array, IndexArray, Mask
from ncgear.numerics.plane import signed_area
from ncgear.solids.mesh.layers import require_sound

VOLUME_TOLERANCE = 1e-9
"""Relative difference allowed between the mesh's volume and the integral of its sections' areas: rounding only."""

UNEVEN = 1e-9
"""How unevenly points are shifted, relative to their distance from the axis, to choose the triangles of an end: far
below single precision."""


@dataclass(frozen=True, eq=False)
class _Tube:
    """A wall through rings (l, c, 2) at heights (l,), material on the left of the rings' sense; vertices from ``first``
    on.

    ``column`` (l, c) is the vertex of its ring that stands for each point: points that coincide share one.
    """

    rings: Array
    heights: Array
    column: IndexArray
    first: int

    @property
    def vertices(self) -> Array:
        """Shape (l c, 3)."""
        height = np.broadcast_to(self.heights[:, None, None], (*self.rings.shape[:2], 1))
        return np.concatenate([self.rings, height], axis=2).reshape(-1, 3)

    @property
    def numbers(self) -> IndexArray:
        """Vertex of each point, shape (l, c)."""
        layers, columns = self.column.shape
        return np.asarray(self.first + columns * np.arange(layers)[:, None] + self.column)

    @property
    def volume_mm3(self) -> float:
        """Volume inside, negative for a hole: between two rings the area is a quadratic of height, so that Simpson's
        rule is exact."""
        lower, upper = self.rings[:-1], self.rings[1:]
        mean = (signed_area(lower) + 4.0 * signed_area(middle_section(lower, upper)) + signed_area(upper)) / 6.0
        return float(np.sum(mean * np.diff(self.heights)))

    def faces(self) -> IndexArray:
        """Two triangles for each quadrilateral, shape (2 (l - 1) c, 3)."""
        lower, upper = self.numbers[:-1], self.numbers[1:]
        lower_next, upper_next = np.roll(lower, -1, axis=1), np.roll(upper, -1, axis=1)
        falling = falls(self.rings[:-1], self.rings[1:])
        first = np.stack([lower, lower_next, np.where(falling, upper, upper_next)], axis=-1)
        second = np.stack([np.where(falling, lower_next, lower), upper_next, upper], axis=-1)
        return np.concatenate([first.reshape(-1, 3), second.reshape(-1, 3)])


def lofted(rings_mm: Array, heights_mm: Array, holes_mm: Sequence[Array]) -> Trimesh:
    """The solid through rings of shape (l, c, 2) at rising heights (l,), with holes (n, 2) along z, all
    counter-clockwise.

    Neighbouring points of a ring that single precision cannot tell apart become one.  Raises RuntimeError if the mesh
    is not sound, a fault of ncgear.
    """
    tubes = [_tube(rings_mm, heights_mm, 0)]
    for hole in holes_mm:
        tubes.append(_tube(np.stack([hole[::-1]] * 2), heights_mm[[0, -1]], tubes[-1].first + tubes[-1].column.size))
    faces = np.concatenate([*(tube.faces() for tube in tubes), _cap(tubes, 0)[:, ::-1], _cap(tubes, -1)])
    proper = np.all(faces != np.roll(faces, 1, axis=1), axis=1)
    mesh = Trimesh(np.concatenate([tube.vertices for tube in tubes]), faces[proper], process=False)
    mesh.remove_unreferenced_vertices()
    require_sound(mesh, sum(tube.volume_mm3 for tube in tubes), VOLUME_TOLERANCE)
    return mesh


def middle_section(lower_mm: Array, upper_mm: Array) -> Array:
    """Rings half way between rings (..., c, 2), shape (..., 2 c, 2): where a plane there meets the mesh's edges."""
    lower_next, upper_next = np.roll(lower_mm, -1, axis=-2), np.roll(upper_mm, -1, axis=-2)
    falling = falls(lower_mm, upper_mm)[..., None]
    diagonal = np.where(falling, lower_next + upper_mm, lower_mm + upper_next) / 2.0
    both = np.stack([(lower_mm + upper_mm) / 2.0, diagonal], axis=-2)
    return both.reshape(*lower_mm.shape[:-2], -1, 2)


def falls(lower_mm: Array, upper_mm: Array) -> Mask:
    """Whether quadrilaterals between rings (..., c, 2) are folded from an upper point to the next lower one."""
    falling = np.roll(lower_mm, -1, axis=-2) - upper_mm
    rising = np.roll(upper_mm, -1, axis=-2) - lower_mm
    shorter: Mask = np.sum(falling**2, axis=-1) < np.sum(rising**2, axis=-1)
    return shorter


def _tube(rings: Array, heights: Array, first: int) -> _Tube:
    """The tube with points of a ring merged that the single precision of STL files could not tell apart."""
    step = 2.0 * float(np.spacing(np.float32(np.abs(rings).max())))
    distinct = np.linalg.norm(rings - np.roll(rings, 1, axis=1), axis=2) > step
    column = np.maximum.accumulate(np.where(distinct, np.arange(rings.shape[1]), -1), axis=1)
    # Points before the first distinct one belong to the last of the ring.
    column = np.where(column < 0, column[:, -1:], column)
    return _Tube(np.take_along_axis(rings, column[..., None], axis=1), heights, column, first)


def _cap(tubes: Sequence[_Tube], layer: int) -> IndexArray:
    """Triangles that fill the section between the rings of one layer, counter-clockwise seen from above."""
    kept = [np.unique(tube.column[layer]) for tube in tubes]
    points = np.concatenate([tube.rings[layer, own] for tube, own in zip(tubes, kept, strict=True)])
    vertex = np.concatenate([tube.numbers[layer, own] for tube, own in zip(tubes, kept, strict=True)])
    ends = np.cumsum([own.size for own in kept]).astype(np.uint32)
    # Earcut passes over points that stand exactly in line with their neighbours; shifted unevenly, none does.
    uneven = points * (1.0 + UNEVEN * np.random.default_rng(0).random((len(points), 1)))
    corners = mapbox_earcut.triangulate_float64(uneven, ends).reshape(-1, 3).astype(np.intp)
    return np.asarray(vertex[corners if np.sum(signed_area(points[corners])) > 0.0 else corners[:, ::-1]])
