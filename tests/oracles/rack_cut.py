"""Brute-force generation of a gear by a cutter that rolls on the pitch curve: union, difference, no envelope formula.

The blank is the pitch curve grown by the addendum. Every tooth space is what one cutter tooth sweeps while the cutter
rolls without slipping. Positions are discrete, so the result always *contains* the gear that a continuous motion would
leave; the scallops shrink with the square of the step.

A straight rack can only cut a convex pitch curve: where the curve is concave the conjugate flank is concave too and a
straight flank, tangent to it from the space, gouges it. Give `Pinion` there, with a pitch radius well below the least
concave radius; its flanks have the same envelope.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
import shapely
from numpy.typing import NDArray
from scipy.interpolate import CubicHermiteSpline
from shapely import MultiPolygon, Polygon, STRtree

FloatArray = NDArray[np.float64]

ARC_SEGMENTS = 24


@dataclass(frozen=True)
class PitchCurve:
    """Closed pitch curve sampled in the gear's own frame; one row per sample, first sample not repeated."""

    points: FloatArray  # (n, 2)
    tangents: FloatArray  # (n, 2), unit, towards growing arc length
    normals: FloatArray  # (n, 2), unit, out of the gear
    sigma: FloatArray  # (n,), arc length, increasing
    length: float

    def at(self, sigma: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Points, tangents and normals at arc lengths, by cubic Hermite pieces between the samples."""
        spline = CubicHermiteSpline(*self._closed())
        wrapped = self.sigma[0] + np.mod(sigma - self.sigma[0], self.length)
        tangents = spline(wrapped, 1)
        tangents /= np.linalg.norm(tangents, axis=1, keepdims=True)
        return spline(wrapped), tangents, self._side() * np.column_stack([tangents[:, 1], -tangents[:, 0]])

    def _closed(self) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Arc length, points and tangents with the first sample repeated one length later."""
        sigma = np.append(self.sigma, self.sigma[0] + self.length)
        return sigma, np.vstack([self.points, self.points[:1]]), np.vstack([self.tangents, self.tangents[:1]])

    def _side(self) -> float:
        """+1 if the outward normal is to the right of the tangent, else -1; refused if the samples disagree."""
        side = self.tangents[:, 1] * self.normals[:, 0] - self.tangents[:, 0] * self.normals[:, 1]
        if np.ptp(side) > 1e-6:
            raise ValueError("the normals are not square to the tangents on one side of the curve")
        return float(np.sign(side[0]))


@dataclass(frozen=True)
class Proportions:
    """Tooth proportions in mm and rad, as seen from the gear that is cut.

    `thinning` is what backlash takes off this gear's tooth thickness, measured along the pitch line: for a normal
    backlash jn shared equally it is jn / 2 / cos(alpha) on each gear.
    """

    module: float
    alpha: float
    addendum: float
    dedendum: float
    root_radius: float
    thinning: float = 0.0


class Cutter(Protocol):
    """A tooth and how it moves."""

    def swept(self, tooth: Proportions, pitch: float, lead: FloatArray) -> FloatArray:
        """Cutter tooth in tangent frames, (positions, vertices, 2) as (u, height); lead = c - sigma."""
        ...


@dataclass(frozen=True)
class Rack:
    """Straight-sided rack. `reach` is how far its flanks go outwards from the pitch line: by default the addendum.

    On a convex curve no more is ever met; on a concave one the blank rises above the tangent frame's addendum.
    """

    reach: float | None = None

    def swept(self, tooth: Proportions, pitch: float, lead: FloatArray) -> FloatArray:
        """The tooth slides along the tangent."""
        outline = rack_tooth(tooth, pitch, tooth.addendum if self.reach is None else self.reach)
        shift = np.column_stack([lead, np.zeros_like(lead)])
        return outline[None, :, :] + shift[:, None, :]


@dataclass(frozen=True)
class Pinion:
    """Involute shaper cutter, its pitch circle rolling outside the pitch curve; tip corners are rounded.

    Its own flanks end at its base circle: with fewer than about 18 teeth they stop short of the gear's tips, and sooner
    on concave stretches. Its fillets reach higher than a rack's: a mate flatter than the cutter may foul them unless
    the root radius is small and the dedendum generous.
    """

    teeth: int

    def swept(self, tooth: Proportions, pitch: float, lead: FloatArray) -> FloatArray:
        """The tooth turns with the cutter: the pitch circle's arc is the rolled length."""
        radius = self.teeth * pitch / (2 * np.pi)
        outline = pinion_tooth(tooth, pitch, radius)
        x, y = outline[:, 0][None, :], outline[:, 1][None, :] - radius
        turn = (lead / radius)[:, None]
        return np.stack([x * np.cos(turn) - y * np.sin(turn), radius + x * np.sin(turn) + y * np.cos(turn)], axis=-1)


def rack_tooth(tooth: Proportions, pitch: float, reach: float) -> FloatArray:
    """Cutter tooth (u, height): half width (pitch + 2 thinning)/4 at height 0, tip at -dedendum, rounded corners."""
    half, slope, radius = pitch / 4 + tooth.thinning / 2, np.tan(tooth.alpha), tooth.root_radius
    height = radius - tooth.dedendum
    centre = half + height * slope - radius / np.cos(tooth.alpha)
    if centre < 0:
        raise ValueError(f"root radius {radius} mm does not fit the tip of the rack's tooth")
    angle = np.linspace(-tooth.alpha, -np.pi / 2, ARC_SEGMENTS + 1)
    arc = np.column_stack([centre + radius * np.cos(angle), height + radius * np.sin(angle)])
    right = np.vstack([[half + reach * slope, reach], arc])
    return np.vstack([right, right[::-1] * [-1, 1]])


def pinion_tooth(tooth: Proportions, pitch: float, radius: float) -> FloatArray:
    """Cutter tooth (u, height), its centre at (0, radius): involute from near the base circle to the tip."""
    base = radius * np.cos(tooth.alpha)
    inner = max(base, radius - tooth.addendum - 0.25 * tooth.module)
    r = np.linspace(inner, radius + tooth.dedendum, 200)
    half = (pitch / 4 + tooth.thinning / 2) / radius + involute(tooth.alpha) - involute(np.arccos(base / r))
    if half[-1] <= 0:
        raise ValueError("the pinion cutter's tooth is pointed: give it more teeth")
    # The tip circle's arc after the involute: a chord would be shallower by its sagitta.
    half, r = np.append(half, half[-1] * np.linspace(0.98, 0.02, 49)), np.append(r, np.full(49, r[-1]))
    right = np.column_stack([r * np.sin(half), radius - r * np.cos(half)])
    return _rounded_tip(np.vstack([right, right[::-1] * [-1, 1]]), tooth.root_radius)


def _rounded_tip(outline: FloatArray, radius: float) -> FloatArray:
    """Tip corners rounded by opening; the far end is lengthened first so that it keeps its corners out of the way."""
    far = outline[0] + [0.0, 4 * radius]
    lengthened = Polygon(np.vstack([far, outline, far * [-1, 1]]))
    opened = lengthened.buffer(-radius, quad_segs=4 * ARC_SEGMENTS).buffer(radius, quad_segs=4 * ARC_SEGMENTS)
    kept = opened.intersection(Polygon(outline))
    return shapely.get_coordinates(kept.exterior)[:-1]


def involute(angle: float | FloatArray) -> FloatArray:
    """Involute function."""
    return np.tan(angle) - np.asarray(angle)


def cut(
    curve: PitchCurve,
    tooth: Proportions,
    teeth: int,
    tooth_at_zero: bool,
    cutter: Cutter | None = None,
    positions_per_pitch: int = 100,
    window_pitches: float = 2.0,
) -> Polygon:
    """The gear: blank minus all swept spaces. A tooth, or else a space, is centred at arc length 0."""
    pitch = curve.length / teeth
    if abs(pitch / (np.pi * tooth.module) - 1) > 1e-6:
        raise ValueError(f"{teeth} teeth on {curve.length} mm are of module {pitch / np.pi}, not {tooth.module}")
    body = blank(curve, tooth.addendum)
    centres = (np.arange(teeth) + (0.5 if tooth_at_zero else 0.0)) * pitch
    half = round(window_pitches * positions_per_pitch)
    lead = np.arange(-half, half + 1, dtype=np.float64) * float(pitch / positions_per_pitch)
    outline = (cutter or Rack()).swept(tooth, pitch, lead)
    spaces = [_space(curve, outline, centre - lead, body) for centre in centres]
    return _largest(body.difference(shapely.union_all(spaces)))


def blank(curve: PitchCurve, addendum: float) -> Polygon:
    """Pitch curve grown by the addendum."""
    sigma = curve.sigma[0] + np.linspace(0, curve.length, max(4 * len(curve.sigma), 8000), endpoint=False)
    return Polygon(curve.at(sigma)[0]).buffer(addendum, quad_segs=32)


def _space(curve: PitchCurve, outline: FloatArray, sigma: FloatArray, body: Polygon) -> shapely.Geometry:
    """Union of one cutter tooth over the rolling positions that reach the blank."""
    points, tangents, normals = (array[:, None, :] for array in curve.at(sigma))
    placed = points + outline[:, :, :1] * tangents + outline[:, :, 1:] * normals
    polygons = shapely.polygons(placed)
    shapely.prepare(body)
    return shapely.union_all(polygons[shapely.intersects(body, polygons)])


def _largest(shape: Polygon | MultiPolygon) -> Polygon:
    """The part with the most area: loose chips are not the gear."""
    parts = [shape] if isinstance(shape, Polygon) else list(shape.geoms)
    return max(parts, key=lambda part: part.area)


def outline_distance(one: Polygon, other: Polygon, step: float | None = None) -> float:
    """Hausdorff distance of the outer boundaries, sampled at all vertices and at least every step (mm)."""
    step = step or min(one.length, other.length) / 20000
    return float(max(boundary_deviation(one, other, step).max(), boundary_deviation(other, one, step).max()))


def boundary_deviation(one: Polygon, other: Polygon, step: float) -> FloatArray:
    """Distance to the other's outer boundary of points along one's, at all vertices and at least every step (mm)."""
    points = shapely.points(shapely.get_coordinates(shapely.segmentize(one.exterior, step)))
    return deviation_of_points(points, other)


def deviation_of_points(points: NDArray[np.object_], polygon: Polygon) -> FloatArray:
    """Distance of points to a polygon's outer boundary."""
    ring = shapely.get_coordinates(polygon.exterior)
    tree = STRtree(shapely.linestrings(np.stack([ring[:-1], ring[1:]], axis=1)))
    (index, _), distance = tree.query_nearest(points, return_distance=True, all_matches=False)
    result = np.empty(len(points))
    result[index] = distance
    return result
