"""A mesh of triangles as two arrays, and its figures: closed or not, volume, box.

A body is found closed by counting edges; no coordinates are compared.  For anything more, the mesh is handed to
trimesh, which takes long to load and judges these figures in the tests.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import cached_property
from math import ceil, log10
from typing import TYPE_CHECKING

import numpy as np

from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array, IndexArray, equal_rows

if TYPE_CHECKING:
    from trimesh import Trimesh

MERGED = 1e-10
"""Points whose coordinates agree to about this share of the largest one are one vertex: far below single precision."""

TINY = 1e-200
"""Less than any length; it stands for the size of a mesh of one point."""


@dataclass(frozen=True, eq=False)
class TriangleMesh:
    """Triangles in mm: ``vertices`` (n, 3) and ``faces`` (t, 3), counter-clockwise seen from outside."""

    vertices: Array
    faces: IndexArray

    @cached_property
    def triangles(self) -> Array:
        """The corners of each triangle in mm, shape (t, 3, 3)."""
        return np.asarray(self.vertices[self.faces])

    @cached_property
    def _crosses(self) -> Array:
        """Twice the area of each triangle times its normal, shape (t, 3)."""
        first, second = (self.triangles[:, corner + 1] - self.triangles[:, corner] for corner in (0, 1))
        return np.asarray(np.cross(first, second))

    @cached_property
    def volume(self) -> float:
        """Volume within in mm3, by the divergence theorem; it means something for closed meshes only."""
        return float((self._crosses[:, 0] * self.triangles[:, :, 0].sum(axis=1)).sum() / 6.0)

    @cached_property
    def bounds(self) -> Array:
        """The least and the largest coordinates of the triangles in mm, shape (2, 3)."""
        return np.array([[column.min(), column.max()] for column in self.triangles.reshape(-1, 3).T]).T

    @property
    def extents(self) -> Array:
        """The sizes in mm of the box around the triangles, shape (3,)."""
        return np.asarray(self.bounds[1] - self.bounds[0])

    @cached_property
    def _edges(self) -> tuple[IndexArray, IndexArray]:
        """For each edge the number of its triangles, and how many more of them run it one way than the other way."""
        start, end = self.faces.ravel(), np.roll(self.faces, -1, axis=1).ravel()
        keys = np.minimum(start, end) * np.int64(len(self.vertices)) + np.maximum(start, end)
        order = np.argsort(keys, kind="stable")
        first = np.flatnonzero(np.diff(keys[order], prepend=-1))
        sense = np.where(start < end, 1, -1)
        return np.diff(first, append=keys.size), np.add.reduceat(sense[order], first)

    @property
    def is_watertight(self) -> bool:
        """Whether every edge belongs to exactly two triangles."""
        return bool(np.all(self._edges[0] == 2))

    @property
    def is_winding_consistent(self) -> bool:
        """Whether the two triangles at each edge run along it in opposite directions."""
        count, sense = self._edges
        return bool(np.all(sense[count == 2] == 0))

    def as_trimesh(self) -> Trimesh:
        """The same mesh for trimesh, whose vertices and triangles keep their numbers."""
        from trimesh import Trimesh

        return Trimesh(self.vertices, self.faces, process=False)


def with_used_vertices(mesh: TriangleMesh) -> TriangleMesh:
    """The mesh without vertices that no triangle uses; the others keep their order."""
    used = np.zeros(len(mesh.vertices), dtype=bool)
    used[mesh.faces] = True
    return TriangleMesh(mesh.vertices[used], np.asarray((np.cumsum(used) - 1)[mesh.faces]))


def merged(vertices: Array, faces: IndexArray) -> TriangleMesh:
    """The mesh with vertices at one place, to ``MERGED``, merged into the first, in order; unused vertices left out."""
    mesh = with_used_vertices(TriangleMesh(vertices, faces))
    # A grid of powers of ten keeps coordinates that are written in decimals as they stand.
    grain = MERGED * 10.0 ** ceil(log10(max(float(np.abs(mesh.vertices).max(initial=0.0)), TINY)))
    first, place = equal_rows(np.round(mesh.vertices / grain).astype(np.int64))
    order = np.argsort(first)
    return TriangleMesh(np.asarray(mesh.vertices[first[order]]), np.asarray(np.argsort(order)[place[mesh.faces]]))


def section_rings(vertices: Array, faces: IndexArray, height: float) -> list[Array]:
    """The rings, shape (n, 2) each, in which a mesh meets the plane at a height; outer rings run counter-clockwise.

    The search goes from facet to facet along the edges of the mesh and compares no coordinates, so rounding can neither
    open a ring nor join two.  Raises ValueError unless every edge that crosses the plane joins two facets.
    """
    above, count = vertices[:, 2] > height, len(vertices)
    start, end = faces, np.roll(faces, -1, axis=1)
    falling, rising = above[start] & ~above[end], ~above[start] & above[end]
    # Seen from outside, a facet's boundary runs down on the left of its section and up again on the right.
    down, up = (_edge_keys(start[mask], end[mask], count) for mask in (falling, rising))
    edges, place = np.unique(np.concatenate([down, up]), return_inverse=True)
    if edges.size != down.size or np.any(np.bincount(place) != 2):
        raise ValueError(f"the mesh is not closed at a height of {height:g}")
    following = np.empty(edges.size, dtype=int)
    following[place[: down.size]] = place[down.size :]
    one, other = vertices[edges // count], vertices[edges % count]
    share = (height - one[:, 2]) / (other[:, 2] - one[:, 2])
    points: Array = one[:, :2] + share[:, None] * (other[:, :2] - one[:, :2])
    return [points[ring] for ring in _cycles(following.tolist())]


def _edge_keys(start: IndexArray, end: IndexArray, count: int) -> IndexArray:
    """A number for each edge, which is the same in both facets that the edge joins."""
    return np.minimum(start, end) * count + np.maximum(start, end)


def _cycles(following: list[int]) -> Iterator[list[int]]:
    left = set(range(len(following)))
    while left:
        ring = [left.pop()]
        while (place := following[ring[-1]]) != ring[0]:
            ring.append(place)
            left.remove(place)
        yield ring
