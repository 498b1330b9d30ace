"""A gear with a boss on its upper face, as one closed mesh."""

from __future__ import annotations

import numpy as np
import shapely
import trimesh.creation
from shapely import MultiPolygon, Polygon
from trimesh import Trimesh

from ncgear.numerics.arrays import Array
from ncgear.solids.extrude import VOLUME_TOLERANCE, require_sound


def bossed(section: Polygon, face_width_mm: float, boss: MultiPolygon, boss_height_mm: float) -> Trimesh:
    """The section extruded from z = 0 and the boss, which lies within it, from there on; all in mm.

    The upper face is the section with the boss cut out, so nothing lies within the body; raises RuntimeError if the
    mesh is not sound, a fault of ncgear.
    """
    top = face_width_mm + boss_height_mm
    around = shapely.get_parts(section.difference(boss))
    parts = [
        _face(section, 0.0, up=False),
        *(_face(part, face_width_mm, up=True) for part in around),
        *(_face(part, top, up=True) for part in boss.geoms),
        *(_wall(ring, 0.0, face_width_mm) for ring in _rings(section)),
        *(_wall(ring, face_width_mm, top) for part in boss.geoms for ring in _rings(part)),
    ]
    starts = np.cumsum([0, *(len(part.vertices) for part in parts[:-1])])
    triangles = [part.faces + start for part, start in zip(parts, starts, strict=True)]
    mesh = Trimesh(np.vstack([part.vertices for part in parts]), np.vstack(triangles))
    require_sound(mesh, section.area * face_width_mm + boss.area * boss_height_mm, VOLUME_TOLERANCE)
    return mesh


def _rings(polygon: Polygon) -> list[Array]:
    """Its outlines, shape (n, 2) each, first point repeated: the material on the left."""
    oriented = shapely.orient_polygons(polygon)
    return [shapely.get_coordinates(ring) for ring in (oriented.exterior, *oriented.interiors)]


def _face(polygon: Polygon, height_mm: float, *, up: bool) -> Trimesh:
    points, triangles = trimesh.creation.triangulate_polygon(polygon, engine="earcut")
    first, second, third = points[triangles[:, 0]], points[triangles[:, 1]], points[triangles[:, 2]]
    a, b = second - first, third - first
    turned = (a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0] > 0.0) != up
    triangles = np.where(turned[:, None], triangles[:, ::-1], triangles)
    return Trimesh(np.column_stack([points, np.full(len(points), height_mm)]), triangles, process=False)


def _wall(ring: Array, low_mm: float, high_mm: float) -> Trimesh:
    """Two triangles on each edge of a ring, facing to its right."""
    count = len(ring) - 1
    rows = [np.column_stack([ring, np.full(len(ring), height)]) for height in (low_mm, high_mm)]
    edge = np.arange(count)
    lower, upper = edge, edge + len(ring)
    triangles = np.vstack([np.column_stack([lower, lower + 1, upper + 1]), np.column_stack([lower, upper + 1, upper])])
    return Trimesh(np.vstack(rows), triangles, process=False)
