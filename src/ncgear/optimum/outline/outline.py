"""A closed outline in the plane: its points by arc length, its meetings with rays from an axis, and distances to it."""

from __future__ import annotations

from functools import cached_property
from math import tau

import numpy as np
from scipy.spatial import ConvexHull, cKDTree

from ncgear.errors import WrongInput
from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array, IndexArray

FINE = 3000
"""Least number of chords of an outline, so that the nearest vertex gives the nearest chord."""

CROSSES = "Self-intersection"
"""The first word of GEOS for a ring that crosses itself."""

SAME = 1e-9
"""Largest distance of two places that count as one, as a share of an outline's length."""

LOOPS = 0.01
"""Share of an outline's size up to which its loops count as noise and are left out."""

FEWEST_POINTS = 3

ROUNDING = 1e-9
"""Share of the angle between two rays within which a ray meets the end of a chord."""


@dataclass(frozen=True, eq=False)
class Outline:
    """A closed polygon, counter-clockwise, its first corner not repeated; ``corners`` have shape (n, 2), in mm.

    ``left_out_mm`` is how far loops of the drawing reach from it that were left out.
    """

    corners: Array
    left_out_mm: float = 0.0

    @cached_property
    def size_mm(self) -> float:
        """The greater of width and height."""
        return float(np.max(np.ptp(self.corners, axis=0)))

    @cached_property
    def area_mm2(self) -> float:
        """Enclosed area."""
        return _area(self.corners)

    @cached_property
    def centroid_mm(self) -> Array:
        """Centroid of the enclosed area, shape (2,)."""
        after = np.roll(self.corners, -1, axis=0)
        cross = self.corners[:, 0] * after[:, 1] - self.corners[:, 1] * after[:, 0]
        return ((self.corners + after) * cross[:, None]).sum(axis=0) / (6.0 * self.area_mm2)

    @cached_property
    def _lengths(self) -> Array:
        """Arc length at each corner and at the end, shape (n + 1,)."""
        steps = np.hypot(*(np.roll(self.corners, -1, axis=0) - self.corners).T)
        return np.concatenate([[0.0], np.cumsum(steps)])

    @property
    def hull_length_mm(self) -> float:
        """Length of the convex hull, about that of a pitch curve: clefts and limbs do not count."""
        return float(ConvexHull(self.corners).area)

    def even(self, count: int) -> Array:
        """Points in the middle of ``count`` parts of equal arc length, shape (count, 2)."""
        return self._at(((np.arange(count) + 0.5) / count) * self._lengths[-1])

    def _at(self, length_mm: Array) -> Array:
        closed = np.concatenate([self.corners, self.corners[:1]])
        return np.column_stack([np.interp(length_mm, self._lengths, column) for column in closed.T])

    @property
    def with_middles(self) -> Array:
        """The corners with the middles between them, shape (2 n, 2)."""
        middles = (self.corners + np.roll(self.corners, -1, axis=0)) / 2.0
        return np.stack([self.corners, middles], axis=1).reshape(-1, 2)

    @cached_property
    def _fine(self) -> Array:
        """The corners with points between them."""
        between = np.linspace(0.0, self._lengths[-1], FINE, endpoint=False)
        places = np.unique(np.concatenate([between, self._lengths[:-1]]))
        # Places that differ by rounding errors count as one, so that every chord has a length.
        return self._at(places[np.diff(places, prepend=-np.inf) > SAME * self._lengths[-1]])

    @cached_property
    def _tree(self) -> cKDTree:
        # Building a balanced tree would take longer than it saves.
        return cKDTree(self._fine, compact_nodes=False, balanced_tree=False)

    def nearest(self, points_mm: Array) -> tuple[Array, Array]:
        """The nearest point of the outline to each point, shape (m, 2), and its distance in mm, shape (m,)."""
        _, vertex = self._tree.query(points_mm)
        found = [_on_chord(self._fine, vertex, points_mm), _on_chord(self._fine, vertex - 1, points_mm)]
        away = [np.hypot(*(points_mm - place).T) for place in found]
        nearer = away[1] < away[0]
        return np.where(nearer[:, None], found[1], found[0]), np.where(nearer, away[1], away[0])

    def farthest_hits(self, axis_mm: Array, count: int) -> Array:
        """Distance in mm from the axis to the farthest hit of each of ``count`` even rays; -inf without a hit."""
        before = self.corners - axis_mm
        after, angle = np.roll(before, -1, axis=0), tau * np.arange(count) / count
        found = np.full(count, -np.inf)
        start = np.arctan2(before[:, 1], before[:, 0])
        turned = np.arctan2(before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0], np.sum(before * after, axis=1))
        # A chord is met by the rays between the polar angles of its ends.
        low, high = np.minimum(start, start + turned), np.maximum(start, start + turned)
        first = np.ceil(low / tau * count - ROUNDING).astype(int)
        rays = np.maximum(np.floor(high / tau * count + ROUNDING).astype(int) - first + 1, 0)
        chord = np.repeat(np.arange(len(before)), rays)
        ray = np.arange(rays.sum()) - np.repeat(np.cumsum(rays) - rays, rays) + np.repeat(first, rays)
        ray = ray % count
        way = np.column_stack([np.cos(angle[ray]), np.sin(angle[ray])])
        one, other = before[chord], after[chord]
        across = [p[:, 0] * way[:, 1] - p[:, 1] * way[:, 0] for p in (one, other)]
        span = across[0] - across[1]
        share = np.clip(np.divide(across[0], span, out=np.zeros_like(span), where=span != 0.0), 0.0, 1.0)
        hit = one + share[:, None] * (other - one)
        np.maximum.at(found, ray, np.sum(hit * way, axis=1))
        return found

    def holds(self, axis_mm: Array) -> bool:
        """Whether a place is inside."""
        before = self.corners - axis_mm
        after = np.roll(before, -1, axis=0)
        turns = np.arctan2(before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0], np.sum(before * after, axis=1))
        return round(float(turns.sum()) / tau) == 1


def outline_of(points_mm: Array, key: str) -> Outline:
    """The outline of points of shape (n, 2), in either sense; of points that cross in loops as small as noise, around
    them.

    Raises WrongInput where they cross otherwise, or enclose nothing.
    """
    from shapely import Polygon, is_valid_reason

    points = np.asarray(points_mm, dtype=float)
    if points.ndim != 2 or points.shape[1:] != (2,) or not np.all(np.isfinite(points)):
        raise WrongInput(f"points of shape {points.shape}; finite x and y, of shape (n, 2), are right", key=key)
    apart = np.any(points != np.roll(points, 1, axis=0), axis=1)
    points = points[apart]
    size = float(np.max(np.ptp(points, axis=0))) if len(points) else 0.0
    area = _area(points) if len(points) >= FEWEST_POINTS else 0.0
    if not abs(area) > 1e-6 * size**2:
        raise WrongInput("the outline encloses no area; a closed contour is needed", key=key)
    # An outline that only touches itself still has a single inside.
    if (why := is_valid_reason(Polygon(points))).startswith(CROSSES):
        around, left_out_mm = _around_loops(points, LOOPS * size / 2.0)
        if left_out_mm > LOOPS * size:
            x, y = map(float, why.removeprefix(CROSSES).strip("[]").split()[:2])
            raise WrongInput(
                f"the outline crosses itself at ({x:.6g}, {y:.6g}) mm, in loops of up to {left_out_mm:.3g} mm; one "
                f"that does not, or in loops of up to {LOOPS * size:.3g} mm, is right",
                key=key,
            )
        return Outline(around, left_out_mm)
    return Outline(points if area > 0.0 else points[::-1].copy())


def _around_loops(points: Array, step_mm: float) -> tuple[Array, float]:
    """The outer border of a closed line that crosses itself, counter-clockwise, and the greatest distance of the line
    from it, at places ``step_mm`` apart."""
    import shapely

    lines = shapely.unary_union(shapely.LinearRing(points))
    areas = shapely.get_parts(shapely.unary_union(shapely.get_parts(shapely.polygonize([lines]))))
    border = shapely.get_exterior_ring(shapely.orient_polygons(areas[np.argmax(shapely.area(areas))]))
    shapely.prepare(border)
    corners: Array = shapely.get_coordinates(border)[:-1]
    places = shapely.points(shapely.get_coordinates(shapely.segmentize(lines, step_mm)))
    return corners, float(np.max(shapely.distance(places, border)))


def _area(corners: Array) -> float:
    x, y = corners.T
    return float(np.sum(x * np.roll(y, -1) - y * np.roll(x, -1))) / 2.0


def _on_chord(polygon: Array, start: IndexArray, points: Array) -> Array:
    """The nearest point to each point on the chord that begins at a corner."""
    one, other = polygon[start], polygon[(start + 1) % len(polygon)]
    way = other - one
    share = np.sum((points - one) * way, axis=1) / np.sum(way * way, axis=1)
    return one + np.clip(share, 0.0, 1.0)[:, None] * way


GRID = 25
"""Places along each side of the outline's box among which axes are chosen."""

DEEP, NEAR = 0.25, 0.28
"""Least distance of an axis from the outline, as a share of the greatest distance inside, and its greatest distance
from the centroid as a share of the size."""


def axes_to_try(outline: Outline, count: int) -> list[Array]:
    """First axes of the search: the centroid, if it is inside, and places spread over the inside.

    Each further place is the place of a grid, deep inside and near the centroid, that is farthest from those before.
    """
    low, high = outline.corners.min(axis=0), outline.corners.max(axis=0)
    step = (np.arange(GRID) + 0.5) / GRID
    grid = np.array([low + (high - low) * np.array([x, y]) for x in step for y in step] + [outline.centroid_mm])
    depth = np.where([outline.holds(place) for place in grid], outline.nearest(grid)[1], 0.0)
    near = np.hypot(*(grid - outline.centroid_mm).T) < NEAR * outline.size_mm
    deep = grid[(depth > DEEP * np.max(depth)) & (near | (depth == np.max(depth)))]
    found = [outline.centroid_mm if depth[-1] > DEEP * np.max(depth) else grid[np.argmax(depth)]]
    while len(found) < count:
        away = np.min([np.hypot(*(deep - place).T) for place in found], axis=0)
        found.append(deep[np.argmax(away)])
    return found
