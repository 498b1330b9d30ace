"""Judge of a written pair of gears: turn the outlines as the law says and look at overlap, gap and play.

Only what was written counts: the two STL files (cut at mid height, outer boundary only), the law's rows and the centre
distance. STL coordinates are single precision: about 4e-6 mm at 100 mm, which bounds what can be told.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import shapely
import trimesh
from numpy.typing import NDArray
from shapely import Polygon

FloatArray = NDArray[np.float64]

MARGIN_MM = 1.0  # kept around the region where the two gears can meet, so that gaps up to this are measured locally


# --- reading -----------------------------------------------------------------------------------------------------


def read_outline(path: Path | str, height: float | None = None) -> Polygon:
    """Outer boundary of the section of an STL file at a height, by default half way up; a bore is dropped."""
    mesh = trimesh.load_mesh(str(path))
    rings = section_rings(np.asarray(mesh.vertices), np.asarray(mesh.faces), height)
    return max((Polygon(ring) for ring in rings), key=lambda polygon: polygon.area)


def read_ring(path: Path | str) -> Polygon:
    """Section of a ring's STL file at mid height: between its outer boundary and the largest hole, others dropped."""
    mesh = trimesh.load_mesh(str(path))
    rings = section_rings(np.asarray(mesh.vertices), np.asarray(mesh.faces))
    outer, hole = sorted(rings, key=lambda ring: Polygon(ring).area)[:-3:-1]
    return Polygon(outer, [hole])


def section_rings(vertices: FloatArray, faces: NDArray[np.int64], height: float | None = None) -> list[FloatArray]:
    """Closed rings (n, 2) where a watertight mesh meets the plane at a height, by default half way up.

    Rings are followed over mesh edges, not over coordinates: rounding can then neither open a ring nor join two.
    """
    level = (vertices[:, 2].min() + vertices[:, 2].max()) / 2 if height is None else height
    above = vertices[:, 2] > level
    edges = np.stack([faces, np.roll(faces, -1, axis=1)], axis=-1)
    crossing = above[edges[..., 0]] != above[edges[..., 1]]
    crossed = np.sort(edges[crossing], axis=-1)  # two per crossed face, in face order
    keys, node = np.unique(crossed, axis=0, return_inverse=True)
    points = _points_at(vertices, keys, level)
    return [points[ring] for ring in _followed(node.reshape(-1, 2))]


def _points_at(vertices: FloatArray, edges: NDArray[np.int64], level: float) -> FloatArray:
    """Where mesh edges meet the plane at a height."""
    low, high = vertices[edges[:, 0]], vertices[edges[:, 1]]
    share = (level - low[:, 2]) / (high[:, 2] - low[:, 2])
    return low[:, :2] + share[:, None] * (high[:, :2] - low[:, :2])


def _followed(links: NDArray[np.int64]) -> Iterator[list[int]]:
    """Rings of a graph in which every node has exactly two links."""
    neighbours: dict[int, list[int]] = {}
    for one, other in links.tolist():
        neighbours.setdefault(one, []).append(other)
        neighbours.setdefault(other, []).append(one)
    if any(len(linked) != 2 for linked in neighbours.values()):
        raise ValueError("the mesh is not watertight at this height")
    while neighbours:
        yield _one_ring(neighbours)


def _one_ring(neighbours: dict[int, list[int]]) -> list[int]:
    """Take one ring out of the graph."""
    ring = [next(iter(neighbours))]
    while True:
        onward = [node for node in neighbours.pop(ring[-1]) if node in neighbours]
        if not onward:
            return ring
        ring.append(onward[0])


def read_law(path: Path | str) -> tuple[FloatArray, FloatArray]:
    """Columns phi1_rad and phi2_rad of a law.csv."""
    table = np.genfromtxt(path, delimiter=",", names=True)
    return np.asarray(table["phi1_rad"]), np.asarray(table["phi2_rad"])


# --- the pair ----------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class MeshingReport:
    """One entry per position. Depth is the largest width of the overlap; gap is 0 where there is overlap."""

    phi1: FloatArray
    phi2: FloatArray
    overlap_area: FloatArray  # mm^2
    overlap_depth: FloatArray  # mm
    gap: FloatArray  # mm

    @property
    def worst(self) -> int:
        """Index of the position with the deepest overlap."""
        return int(np.argmax(self.overlap_depth))


@dataclass(frozen=True)
class Pair:
    """Two outlines in their own frames in the pose of phi1 = 0, the law's rows and the centre distance (mm).

    ``driven_sense`` is +1 where the driven gear, a polygon with a hole, turns in the driving gear's sense.
    """

    driving: Polygon
    driven: Polygon
    phi1: FloatArray
    phi2: FloatArray
    center_distance: float
    driven_sense: float = -1.0

    def placed(self, phi1: float, phi2: float) -> tuple[Polygon, Polygon]:
        """Both gears in the fixed frame: driving turned by +phi1, driven by phi2 in its sense and moved to its axis."""
        driven_turn = self.driven_sense * phi2
        return _turned(self.driving, phi1, 0.0), _turned(self.driven, driven_turn, self.center_distance)

    def overlap(self, phi1: float, phi2: float) -> tuple[float, float]:
        """Area (mm^2) and depth (mm) of the overlap."""
        return _overlap(*_near(*self.placed(phi1, phi2)))

    def rows(self, positions: int) -> NDArray[np.int64]:
        """Evenly spread rows of the law, the closing one left out: rows, so that nothing is interpolated."""
        return np.unique(np.linspace(0, len(self.phi1) - 1, positions + 1)[:-1].round().astype(int))

    def report(self, positions: int = 401) -> MeshingReport:
        """Overlap and gap over the whole turn. The default is prime, so it does not keep step with the teeth."""
        rows = self.rows(positions)
        found = [self._judged(float(self.phi1[row]), float(self.phi2[row])) for row in rows]
        area, depth, gap = np.array(found).T
        return MeshingReport(self.phi1[rows], self.phi2[rows], area, depth, gap)

    def driven_play(self, position: int, tolerance: float = 1e-4, limit: float = 0.05) -> tuple[float, float]:
        """(minus, plus), rad: how far the driven gear turns back and on from a row of the law before the overlap is
        deeper than the tolerance (mm). Negative where the law's own position is beyond that side by so much; the sum is
        the play. Infinite where the limit is reached; (nan, nan) where nothing within the limit is free.
        """
        phi1, phi2 = float(self.phi1[position]), float(self.phi2[position])

        def free(offset: float) -> bool:
            return self.overlap(phi1, phi2 + offset)[1] <= tolerance

        start = _first_free(free, limit)
        if start is None:
            return float("nan"), float("nan")
        return float(-_edge(free, start, -limit)), float(_edge(free, start, limit))

    def _judged(self, phi1: float, phi2: float) -> tuple[float, float, float]:
        """Area, depth and gap at one position."""
        driving, driven = self.placed(phi1, phi2)
        near = _near(driving, driven)
        area, depth = _overlap(*near)
        return area, depth, 0.0 if area > 0 else _gap(near, (driving, driven))


def read_pair(
    driving: Path | str, driven: Path | str, law: Path | str, center_distance: float, *, internal: bool = False
) -> Pair:
    """A pair as written: two STL files and law.csv; an internal one has a ring as its driven gear."""
    phi1, phi2 = read_law(law)
    if internal:
        return Pair(read_outline(driving), read_ring(driven), phi1, phi2, center_distance, 1.0)
    return Pair(read_outline(driving), read_outline(driven), phi1, phi2, center_distance)


def _turned(polygon: Polygon, angle: float, shift: float) -> Polygon:
    """Rotated about the origin, then moved along x."""
    cos, sin = np.cos(angle), np.sin(angle)
    rotation, move = np.array([[cos, sin], [-sin, cos]]), np.array([shift, 0.0])
    return shapely.transform(polygon, lambda points: points @ rotation + move)


def _near(driving: Polygon, driven: Polygon) -> tuple[Polygon, Polygon]:
    """Both gears clipped to where they can meet: the common part of their bounds, taken until it stops shrinking.

    Nothing that overlaps is lost, wherever it is: no assumption is made on where the mesh is.
    """
    for _ in range(4):
        one, other = np.array(driving.bounds), np.array(driven.bounds)
        if np.isnan(one).any() or np.isnan(other).any():
            break
        low, high = np.maximum(one[:2], other[:2]) - MARGIN_MM, np.minimum(one[2:], other[2:]) + MARGIN_MM
        driving, driven = _clipped(driving, *low, *high), _clipped(driven, *low, *high)
    return driving, driven


def _clipped(polygon: Polygon, *box: float) -> Polygon:
    """Polygon within a box; the fast clip may leave an invalid ring, then the exact one is taken."""
    if box[0] >= box[2] or box[1] >= box[3]:
        return Polygon()
    clipped = shapely.clip_by_rect(polygon, *box)
    return clipped if clipped.is_valid else polygon.intersection(shapely.box(*box))


# --- measures ----------------------------------------------------------------------------------------------------


def _overlap(driving: Polygon, driven: Polygon) -> tuple[float, float]:
    """Area and depth of the common region."""
    common = driving.intersection(driven)
    parts = [part for part in shapely.get_parts(common) if part.area > 0]
    return float(common.area), max((width(part) for part in parts), default=0.0)


def width(region: Polygon) -> float:
    """Diameter of the largest circle in a region, to about 2 % (6 % in thin bent slivers).

    For any region the radius is at least area / perimeter, so that sets the tolerance. Slivers, for which a search of
    circles would need as many cells as they are long, are measured across instead.
    """
    scale = region.area / region.length
    if scale < 1e-9:
        return float(2 * scale)
    across = _sliver_width(shapely.get_coordinates(region.exterior)[:-1]) if scale < 0.005 * region.length else None
    if across is not None:
        return across
    return float(2 * shapely.maximum_inscribed_circle(region, tolerance=0.02 * scale).length)


def _sliver_width(ring: FloatArray) -> float | None:
    """Largest distance between the two sides of a thin ring, across its long axis; None if bent."""
    centred = ring - ring.mean(axis=0)
    x, y = (centred @ np.linalg.svd(centred, full_matrices=False)[2].T).T
    if np.ptp(y) > 0.15 * np.ptp(x):
        return None
    start = int(np.argmin(x))
    x, y = np.roll(x, -start), np.roll(y, -start)
    far = int(np.argmax(x))
    upper, lower = (x[: far + 1], y[: far + 1]), (np.append(x[far:], x[0])[::-1], np.append(y[far:], y[0])[::-1])
    if any((np.diff(side[0]) < 0).any() for side in (upper, lower)):
        return None
    return float(np.abs(np.interp(x, *upper) - np.interp(x, *lower)).max())


def _gap(near: tuple[Polygon, Polygon], whole: tuple[Polygon, Polygon]) -> float:
    """Least distance; if what is near does not settle it, of the whole outlines."""
    local = float(shapely.distance(*near)) if not (near[0].is_empty or near[1].is_empty) else np.inf
    return local if local <= MARGIN_MM else float(shapely.distance(*whole))


def _first_free(free: Callable[[float], bool], limit: float, steps: int = 50) -> float | None:
    """The offset nearest 0 at which the gears are free, searched both ways up to the limit."""
    sizes = np.geomspace(1e-6, limit, steps)
    offsets = np.concatenate([[0.0], np.column_stack([sizes, -sizes]).ravel()])
    return next((float(offset) for offset in offsets if free(offset)), None)


def _edge(free: Callable[[float], bool], start: float, end: float) -> float:
    """Offset between a free start and an end where freedom stops: steps outwards, then bisection to 1e-9 rad."""
    inside, outside = start, start
    step = np.copysign(1e-5, end)
    while free(outside):
        if abs(outside) >= abs(end):
            return float(np.copysign(np.inf, end))
        inside, outside, step = outside, outside + step, step * 1.5
    while abs(outside - inside) > 1e-9:
        middle = (inside + outside) / 2
        inside, outside = (middle, outside) if free(middle) else (inside, middle)
    return inside
