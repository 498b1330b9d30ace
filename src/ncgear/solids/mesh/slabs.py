"""A body made of slabs that stand on each other, as one closed mesh that is checked to be sound.

The surface is put together from sheets of triangles that share their edges: level faces, upright walls, and where the
foot has a bevel, slopes from the section's edges down to the edges of its inner parallel at z = 0.  The slopes fall at
45 degrees from each edge of the section.  Constrained Delaunay triangles join each edge to its moved edge; where edges
vanish on the way, levels are put in between until the slopes' sections are the parallels to the tolerance.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import pairwise
from typing import TYPE_CHECKING

import mapbox_earcut
import numpy as np
import shapely
from shapely import Polygon
from shapely.geometry.base import BaseGeometry

from ncgear.errors import Unanswered
from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array, IndexArray, distinct
from ncgear.numerics.plane import as_complex, signed_area
from ncgear.solids.mesh.triangles import TriangleMesh, merged
from ncgear.solids.plan.areas import moved_inwards, parallel, polygons, rings
from ncgear.solids.plan.body import Slab

if TYPE_CHECKING:
    from trimesh import Trimesh

UNEVEN = 1e-9
"""How unevenly points are shifted, relative to their distance from the axis, so that earcut passes over no point of an
end: far below single precision."""

VOLUME_TOLERANCE = 1e-9
"""Relative difference allowed between the mesh's volume and section areas times heights: rounding only."""

SHARES = (0.25, 0.5, 0.75)
"""Shares of a slope's height at which its section is compared with the parallel."""


@dataclass(frozen=True, eq=False)
class Bevel:
    """The bevel of a section in mm: the section's inner parallel at z = 0, and the slopes between, facing down."""

    foot: Polygon
    height_mm: float
    slopes: tuple[TriangleMesh, ...]

    @property
    def below_mm3(self) -> float:
        """Volume between the slopes and z = 0."""
        volume = 0.0
        for triangles in (slope.triangles for slope in self.slopes):
            a, b = triangles[:, 1, :2] - triangles[:, 0, :2], triangles[:, 2, :2] - triangles[:, 0, :2]
            areas = np.abs(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]) / 2.0
            volume += float(np.sum(areas * triangles[:, :, 2].mean(axis=1)))
        return volume


def slab_mesh(slabs: Sequence[Slab], bevel: Bevel | None = None) -> TriangleMesh:
    """The slabs from the lowest up, each within the one below it; all in mm.

    A ``bevel`` belongs to the section of the first slab, which then begins at z = 0; it is lower than this slab.
    Between two slabs there is a face only where the lower one ends, so that nothing lies within the body.  Raises
    Unanswered if the mesh is not sound.
    """
    lowest, top = slabs[0], slabs[-1]
    sheets = [
        *faces(bevel.foot if bevel else lowest.section, lowest.low_mm, up=False),
        *(bevel.slopes if bevel else ()),
        *walls(lowest.section, bevel.height_mm if bevel else lowest.low_mm, lowest.high_mm),
        *(sheet for slab in slabs[1:] for sheet in walls(slab.section, slab.low_mm, slab.high_mm)),
        *(
            sheet
            for below, above in pairwise(slabs)
            for sheet in faces(below.section.difference(above.section), above.low_mm, up=True)
        ),
        *faces(top.section, top.high_mm, up=True),
    ]
    mesh = joined(sheets)
    volume = sum(slab.section.area * slab.thickness_mm for slab in slabs) - (bevel.below_mm3 if bevel else 0.0)
    require_sound(mesh, volume, VOLUME_TOLERANCE)
    return mesh


def require_sound(mesh: TriangleMesh | Trimesh, volume_mm3: float, tolerance: float) -> None:
    """Raise Unanswered unless a mesh is closed, evenly wound, and of the volume given to a relative tolerance."""
    if not mesh.is_watertight:
        raise Unanswered("a gear's mesh is not watertight")
    if not mesh.is_winding_consistent:
        raise Unanswered("a gear's mesh has facets that face the wrong way")
    if not abs(float(mesh.volume) - volume_mm3) <= tolerance * volume_mm3:
        raise Unanswered(f"a gear's mesh holds {mesh.volume:.9g} mm3 instead of {volume_mm3:.9g} mm3")


def faces(area: BaseGeometry, height_mm: float, *, up: bool) -> list[TriangleMesh]:
    """An area at a height, facing up or down."""
    made = []
    for polygon in polygons(area):
        closed = [shapely.get_coordinates(ring) for ring in (polygon.exterior, *polygon.interiors)]
        points, triangles = np.vstack(closed), earcut(np.vstack(closed), np.cumsum([len(ring) for ring in closed]))
        around = [ring[:-1] for ring in closed]
        ends = np.cumsum([len(ring) for ring in around])
        if len(triangles) < ends[-1] + 2 * len(around) - 4:
            points = np.vstack(around)
            triangles = filling(points, ends)
        made.append(facing(np.column_stack([points, np.full(len(points), height_mm)]), triangles, up=up))
    return made


def filling(points: Array, ends: IndexArray) -> IndexArray:
    """Triangles (t, 3) between rings (n, 2) that end at ``ends``; shifts keep earcut from passing over points."""
    uneven = points * (1.0 + UNEVEN * np.random.default_rng(0).random((len(points), 1)))
    return earcut(uneven, ends)


def earcut(points: Array, ends: IndexArray) -> IndexArray:
    """Triangles, shape (t, 3), between rings of points (n, 2) that end at ``ends``, the outer one first."""
    return mapbox_earcut.triangulate_float64(points, ends.astype(np.uint32)).reshape(-1, 3).astype(np.intp)


def walls(area: BaseGeometry, low_mm: float, high_mm: float) -> list[TriangleMesh]:
    """The sides of an area from one height to another: two triangles on each edge, facing outwards."""
    made = []
    for ring in rings(area):
        rows = [np.column_stack([ring, np.full(len(ring), height)]) for height in (low_mm, high_mm)]
        lower = np.arange(len(ring) - 1)
        upper = lower + len(ring)
        triangles = [np.column_stack([lower, lower + 1, upper + 1]), np.column_stack([lower, upper + 1, upper])]
        made.append(TriangleMesh(np.vstack(rows), np.vstack(triangles)))
    return made


def facing(vertices: Array, triangles: IndexArray, *, up: bool) -> TriangleMesh:
    """Triangles turned so that all face up, or all down: rounding would turn a triangle of three points in line."""
    area = float(np.sum(signed_area(vertices[triangles][..., :2])))
    return TriangleMesh(vertices, triangles if (area > 0.0) == up else triangles[:, ::-1])


def joined(sheets: Sequence[TriangleMesh]) -> TriangleMesh:
    """One mesh of sheets that share their edges."""
    starts = np.cumsum([0, *(len(sheet.vertices) for sheet in sheets[:-1])])
    triangles = [sheet.faces + start for sheet, start in zip(sheets, starts, strict=True)]
    return merged(np.vstack([sheet.vertices for sheet in sheets]), np.vstack(triangles))


def bevel_of(section: Polygon, height_mm: float, tolerance_mm: float, key: str) -> Bevel:
    """The bevel up to a height; raises WrongInput for ``key`` where a part of the section is narrower than twice it."""
    foot = moved_inwards(section, height_mm, tolerance_mm, key)
    return Bevel(foot, height_mm, tuple(_slopes(section, foot, (0.0, height_mm), tolerance_mm)))


def _slopes(
    area: BaseGeometry, foot: BaseGeometry, between: tuple[float, float], tolerance: float
) -> Iterator[TriangleMesh]:
    """Slopes from a foot at one height to the area at another height."""
    low, high = between
    slope = _slope(area, foot, between)
    if high - low <= tolerance or all(
        _close(slope, area, low + share * (high - low), high, tolerance) for share in SHARES
    ):
        yield slope
        return
    middle = (low + high) / 2.0
    level = parallel(area, middle - high)
    yield from _slopes(level, foot, (low, middle), tolerance)
    yield from _slopes(area, level, (middle, high), tolerance)


def _slope(area: BaseGeometry, foot: BaseGeometry, between: tuple[float, float]) -> TriangleMesh:
    """Triangles with the corners of the foot at the lower height and the corners of the area at the upper height."""
    low = distinct(as_complex(shapely.get_coordinates(foot)))
    triangles = shapely.get_parts(shapely.constrained_delaunay_triangles(area.difference(foot)))
    corners = shapely.get_coordinates(triangles).reshape(-1, 4, 2)[:, :3]
    heights = np.where(np.isin(as_complex(corners), low), *between)
    vertices = np.concatenate([corners, heights[..., None]], axis=2).reshape(-1, 3)
    return facing(vertices, np.arange(len(vertices)).reshape(-1, 3), up=False)


def _close(slope: TriangleMesh, area: BaseGeometry, height: float, top: float, tolerance: float) -> bool:
    """Whether the slope's section at a height agrees to the tolerance with the parallel of the area at its top."""
    section = _level_lines(slope.triangles, height)
    exact = np.concatenate([np.stack([ring[:-1], ring[1:]], axis=1) for ring in rings(parallel(area, height - top))])
    return _within(section, exact, tolerance) and _within(exact, section, tolerance)


def _within(lines: Array, of: Array, tolerance: float) -> bool:
    """Whether the ends of all lines, shape (n, 2, 2), lie within a distance of other lines."""
    points = shapely.points(lines[:, 0])
    near, _ = shapely.STRtree(shapely.linestrings(of)).query(points, predicate="dwithin", distance=tolerance)
    return bool(distinct(near).size == points.size)


def _level_lines(triangles: Array, height: float) -> Array:
    """Lines in which triangles (t, 3, 3) cross a height, shape (n, 2, 2)."""
    start, end = triangles, np.roll(triangles, -1, axis=1)
    crossing = (start[..., 2] > height) != (end[..., 2] > height)
    low, high = start[crossing], end[crossing]
    share = (height - low[:, 2:]) / (high[:, 2:] - low[:, 2:])
    return np.asarray((low[:, :2] + share * (high[:, :2] - low[:, :2])).reshape(-1, 2, 2))
