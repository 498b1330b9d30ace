"""A surface of triangles in space: what solids are made of, what STL files hold, and its integrals.

The integrals are those of D. Eberly, "Polyhedral Mass Properties (Revisited)", Geometric Tools 2002 (revised 2009),
equations of section 2: for each triangle the polynomials of its corners times its normal, summed.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np

from ncgear.numerics.arrays import Array, IndexArray, distinct

SAME_PER_MM = 1e8
"""Vertices whose coordinates agree when they are rounded to this many parts of a mm are one vertex."""

NO_AREA_MM2 = 1e-13
"""Twice the area below which a triangle has no direction, and its normal is left at zero."""

FACETS = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
HEADER_BYTES = 80
"""The rows of a binary STL file, and what stands before their number."""


@dataclass(frozen=True, eq=False)
class TriangleMesh:
    """Triangles (``faces``, shape (t, 3)) between ``vertices`` (shape (n, 3)) in mm, counter-clockwise from outside."""

    vertices: Array
    faces: IndexArray

    @cached_property
    def triangles(self) -> Array:
        """The corners of the triangles, shape (t, 3, 3)."""
        return np.asarray(self.vertices[self.faces])

    @cached_property
    def crosses(self) -> Array:
        """Vectors along the normals whose lengths are twice the areas, shape (t, 3)."""
        sides = self.triangles[:, 1:] - self.triangles[:, :2]
        return np.asarray(np.cross(sides[:, 0], sides[:, 1]))

    @property
    def normals(self) -> Array:
        """Unit normals, shape (t, 3); as good as zero for a triangle without area."""
        length = np.sqrt(np.dot(self.crosses * self.crosses, np.ones(3)))
        directed = length > NO_AREA_MM2
        return np.asarray(
            np.where(directed[:, None], self.crosses * (1.0 / np.where(directed, length, 1.0))[:, None], 0.0)
        )

    @property
    def bounds(self) -> Array:
        """The least and the largest coordinates of all triangles, shape (2, 3)."""
        return np.array([self.triangles.min(axis=(0, 1)), self.triangles.max(axis=(0, 1))])

    @property
    def extents(self) -> Array:
        """The sizes along the axes, shape (3,)."""
        low, high = self.bounds
        return np.asarray(high - low)

    @property
    def is_watertight(self) -> bool:
        """Whether every edge belongs to exactly two triangles."""
        counts = np.unique(self._edges(either_way=True), return_counts=True)[1]
        return bool(counts.size) and bool(np.all(counts == 2))

    @property
    def is_winding_consistent(self) -> bool:
        """Whether no two triangles run along an edge in the same sense."""
        edges = self._edges(either_way=False)
        return distinct(edges).size == edges.size

    def _edges(self, *, either_way: bool) -> IndexArray:
        """A number for each edge of each triangle, the same for an edge and its reverse if ``either_way``."""
        start, end = self.faces.ravel(), np.roll(self.faces, -1, axis=1).ravel()
        if either_way:
            start, end = np.minimum(start, end), np.maximum(start, end)
        edges: IndexArray = start * len(self.vertices) + end
        return edges

    @cached_property
    def volume(self) -> float:
        """The volume of the body inside, if the surface is closed."""
        sums = self.triangles[:, 0, 0] + self.triangles[:, 1, 0] + self.triangles[:, 2, 0]
        return float(np.sum(self.crosses[:, 0] * sums) / 6.0)

    @cached_property
    def center_mass(self) -> Array:
        """The centroid of the body inside, shape (3,)."""
        return np.asarray(self._integrals[:3] / self.volume)

    @cached_property
    def moment_inertia(self) -> Array:
        """The inertia of the body inside of density 1 about its centroid, shape (3, 3), in mm^5."""
        squares, products = self._integrals[3:6], self._integrals[6:9]
        x, y, z = self.center_mass
        xx, yy, zz = squares - self.volume * np.array([x * x, y * y, z * z])
        xy, yz, zx = products - self.volume * np.array([x * y, y * z, z * x])
        return np.array([[yy + zz, -xy, -zx], [-xy, xx + zz, -yz], [-zx, -yz, xx + yy]])

    @cached_property
    def _integrals(self) -> Array:
        """Volume integrals of x, y, z, x^2, y^2, z^2, xy, yz, zx, shape (9,)."""
        a, b, c = self.triangles.swapaxes(0, 1)
        first = a + b + c
        second = a**2 + b**2 + a * b + c * first
        third = a**3 + a**2 * b + a * b**2 + b**3 + c * second
        beside = [np.roll(corner, -1, axis=1) * (second + (corner + first) * corner) for corner in (a, b, c)]
        sums = (np.sum(self.crosses * part, axis=0) for part in (second, third, sum(beside)))
        return np.concatenate([part / divisor for part, divisor in zip(sums, (24.0, 60.0, 120.0), strict=True)])

    def without_unused(self) -> TriangleMesh:
        """The same triangles without vertices that none of them has."""
        used = np.zeros(len(self.vertices), dtype=bool)
        used[self.faces] = True
        return TriangleMesh(self.vertices[used], (np.cumsum(used) - 1)[self.faces])

    def merged(self) -> TriangleMesh:
        """The same triangles on vertices of which no two are the same, in the order in which they come first.

        Vertices that no triangle has are gone.
        """
        mesh = self.without_unused()
        rows = (mesh.vertices * SAME_PER_MM).round().astype(np.int64)
        # The sort is stable: of equal rows the one that comes first stays the first.
        order = np.lexsort(rows.T)
        begins = np.concatenate([[True], np.any(np.diff(rows[order], axis=0) != 0, axis=1)])
        first = order[begins]
        place = np.empty(len(rows), dtype=np.int64)
        place[order] = np.argsort(np.argsort(first))[np.cumsum(begins) - 1]
        return TriangleMesh(mesh.vertices[np.sort(first)], place[mesh.faces])

    def as_stl(self) -> bytes:
        """The triangles as a binary STL file, in single precision."""
        rows = np.zeros(len(self.faces), dtype=FACETS)
        rows["normal"], rows["corners"] = self.normals, self.triangles
        return b"".join([bytes(HEADER_BYTES), np.array([rows.size], dtype="<u4").tobytes(), rows.tobytes()])


def joined(sheets: Sequence[TriangleMesh]) -> TriangleMesh:
    """One mesh of sheets that share their edges."""
    ends = np.cumsum([0, *(len(sheet.vertices) for sheet in sheets)])
    faces = [sheet.faces + start for sheet, (start, _) in zip(sheets, pairwise(ends), strict=True)]
    return TriangleMesh(np.vstack([sheet.vertices for sheet in sheets]), np.vstack(faces)).merged()


def from_stl(data: bytes) -> TriangleMesh:
    """The triangles of a binary STL file, on merged vertices; raises ValueError where it is not as long as it says."""
    begin = HEADER_BYTES + 4
    count = int(np.frombuffer(data[HEADER_BYTES:begin], dtype="<u4")[0]) if len(data) >= begin else -1
    if len(data) != begin + count * FACETS.itemsize:
        raise ValueError("the STL file is not as long as its number of facets says")
    corners = np.frombuffer(data[begin:], dtype=FACETS)["corners"].astype(float).reshape(-1, 3)
    return TriangleMesh(corners, np.arange(len(corners)).reshape(-1, 3)).merged()
