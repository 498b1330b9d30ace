"""The bevel of a foot: the slope from a section's edges down to those of its inner parallel at z = 0.

The slope falls at 45 degrees from each edge of the section.  Constrained Delaunay triangles join each edge to the one
that it was moved to; where edges vanish on the way, levels are put in between until the slope's sections are the
parallels to the tolerance.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import shapely
from shapely import Polygon
from shapely.geometry.base import BaseGeometry
from trimesh import Trimesh

from ncgear.numerics.arrays import Array
from ncgear.solids.mesh.sheets import facing, rings
from ncgear.solids.plan.parallel import moved_inwards, moved_outwards

SHARES = (0.25, 0.5, 0.75)
"""Of the height of a slope, where its section is held against the parallel."""


@dataclass(frozen=True, eq=False)
class Bevel:
    """The bevel of a section in mm: the section's inner parallel, and what lies between, facing down."""

    foot: Polygon
    height_mm: float
    slopes: tuple[Trimesh, ...]

    @property
    def below_mm3(self) -> float:
        """Volume between the slopes and z = 0."""
        return sum(_under(np.asarray(slope.triangles)) for slope in self.slopes)


def bevel_of(section: Polygon, height_mm: float, tolerance_mm: float, key: str) -> Bevel:
    """The bevel up to a height; raises WrongInput for ``key`` where a part of the section is narrower than twice it."""
    foot = moved_inwards(section, height_mm, tolerance_mm, key)
    return Bevel(foot, height_mm, tuple(_slopes(section, foot, (0.0, height_mm), tolerance_mm)))


def _slopes(
    area: BaseGeometry, foot: BaseGeometry, between: tuple[float, float], tolerance: float
) -> Iterator[Trimesh]:
    """Slopes from a foot at one height to the area at another."""
    low, high = between
    slope = _slope(area, foot, between)
    if high - low <= tolerance or all(
        _close(slope, area, low + share * (high - low), high, tolerance) for share in SHARES
    ):
        yield slope
        return
    middle = (low + high) / 2.0
    level = moved_outwards(area, middle - high)
    yield from _slopes(level, foot, (low, middle), tolerance)
    yield from _slopes(area, level, (middle, high), tolerance)


def _slope(area: BaseGeometry, foot: BaseGeometry, between: tuple[float, float]) -> Trimesh:
    """Triangles with the corners of the foot at the lower height and those of the area at the upper one."""
    low = np.unique(_complex(shapely.get_coordinates(foot)))
    triangles = shapely.get_parts(shapely.constrained_delaunay_triangles(area.difference(foot)))
    corners = shapely.get_coordinates(triangles).reshape(-1, 4, 2)[:, :3]
    heights = np.where(np.isin(_complex(corners), low), *between)
    vertices = np.concatenate([corners, heights[..., None]], axis=2).reshape(-1, 3)
    return facing(vertices, np.arange(len(vertices)).reshape(-1, 3), up=False)


def _close(slope: Trimesh, area: BaseGeometry, height: float, top: float, tolerance: float) -> bool:
    """Whether the slope's section at a height is the parallel of the area at its top, to the tolerance."""
    section = _level_lines(np.asarray(slope.triangles), height)
    parallel = np.concatenate(
        [np.stack([ring[:-1], ring[1:]], axis=1) for ring in rings(moved_outwards(area, height - top))]
    )
    return _within(section, parallel, tolerance) and _within(parallel, section, tolerance)


def _within(lines: Array, of: Array, tolerance: float) -> bool:
    """Whether the ends of all lines, shape (n, 2, 2), lie within a distance of others."""
    points = shapely.points(lines[:, 0])
    near, _ = shapely.STRtree(shapely.linestrings(of)).query(points, predicate="dwithin", distance=tolerance)
    return bool(np.unique(near).size == points.size)


def _level_lines(triangles: Array, height: float) -> Array:
    """Where triangles (t, 3, 3) cross a height, shape (n, 2, 2)."""
    start, end = triangles, np.roll(triangles, -1, axis=1)
    crossing = (start[..., 2] > height) != (end[..., 2] > height)
    low, high = start[crossing], end[crossing]
    share = (height - low[:, 2:]) / (high[:, 2:] - low[:, 2:])
    return np.asarray((low[:, :2] + share * (high[:, :2] - low[:, :2])).reshape(-1, 2, 2))


def _under(triangles: Array) -> float:
    """Volume between triangles (t, 3, 3) and z = 0."""
    a, b = triangles[:, 1, :2] - triangles[:, 0, :2], triangles[:, 2, :2] - triangles[:, 0, :2]
    areas = np.abs(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]) / 2.0
    return float(np.sum(areas * triangles[:, :, 2].mean(axis=1)))


def _complex(points: Array) -> Array:
    return np.asarray(points[..., 0] + 1j * points[..., 1])
