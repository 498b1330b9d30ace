"""Sheets of triangles of which a solid's surface is made: level faces and upright walls."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
import shapely
import trimesh.creation
from shapely import Polygon
from shapely.geometry.base import BaseGeometry
from trimesh import Trimesh

from ncgear.numerics.arrays import Array, IndexArray
from ncgear.numerics.plane import signed_area


def polygons(area: BaseGeometry) -> list[Polygon]:
    """The polygons of an area, none where it is empty."""
    return [part for part in shapely.get_parts(area) if isinstance(part, Polygon) and not part.is_empty]


def rings(area: BaseGeometry) -> Iterator[Array]:
    """All outlines of an area, shape (n, 2) each, first point repeated: the material on the left."""
    for polygon in polygons(area):
        oriented = shapely.orient_polygons(polygon)
        yield from (shapely.get_coordinates(ring) for ring in (oriented.exterior, *oriented.interiors))


def faces(area: BaseGeometry, height_mm: float, *, up: bool) -> list[Trimesh]:
    """An area at a height, facing up or down."""
    return [_face(polygon, height_mm, up) for polygon in polygons(area)]


def walls(area: BaseGeometry, low_mm: float, high_mm: float) -> list[Trimesh]:
    """The sides of an area from a height to another."""
    return [_wall(ring, low_mm, high_mm) for ring in rings(area)]


def joined(sheets: Sequence[Trimesh]) -> Trimesh:
    """One mesh of sheets that share their edges."""
    starts = np.cumsum([0, *(len(sheet.vertices) for sheet in sheets[:-1])])
    triangles = [sheet.faces + start for sheet, start in zip(sheets, starts, strict=True)]
    return Trimesh(np.vstack([sheet.vertices for sheet in sheets]), np.vstack(triangles))


def facing(vertices: Array, triangles: IndexArray, *, up: bool) -> Trimesh:
    """Triangles of one sense turned, all or none, so that they face up, or down.

    Together: by itself a triangle of three points in line would be turned by their rounding.
    """
    area = float(np.sum(signed_area(vertices[triangles][..., :2])))
    return Trimesh(vertices, triangles if (area > 0.0) == up else triangles[:, ::-1], process=False)


def _face(polygon: Polygon, height_mm: float, up: bool) -> Trimesh:
    points, triangles = trimesh.creation.triangulate_polygon(polygon, engine="earcut")
    return facing(np.column_stack([points, np.full(len(points), height_mm)]), triangles, up=up)


def _wall(ring: Array, low_mm: float, high_mm: float) -> Trimesh:
    """Two triangles on each edge of a ring, facing to its right."""
    count = len(ring) - 1
    rows = [np.column_stack([ring, np.full(len(ring), height)]) for height in (low_mm, high_mm)]
    edge = np.arange(count)
    lower, upper = edge, edge + len(ring)
    triangles = np.vstack([np.column_stack([lower, lower + 1, upper + 1]), np.column_stack([lower, upper + 1, upper])])
    return Trimesh(np.vstack(rows), triangles, process=False)
