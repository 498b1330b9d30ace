"""Play of two outlines both ways, by polygons: turn the driven gear on and back until the outlines touch.

All of both outlines is compared.  What can touch within the reach of the search is cut out first, by distance alone.
Positions, driven angles and the levers of the flanks come from a law's own formula by Gauss and Legendre's quadrature.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from math import pi, sqrt

import numpy as np
import shapely
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline
from scipy.spatial import KDTree

from oracles.meshing import width

FloatArray = NDArray[np.float64]
Function = Callable[[FloatArray], FloatArray]

GOLDEN = (sqrt(5.0) - 1.0) / 2.0

NODES = 24
"""Nodes of the quadrature on each stretch between positions; the laws here are analytic."""


@dataclass(frozen=True)
class Positions:
    """Driving and driven angles in rad, with the first two derivatives of the driven one; shape (n,) each."""

    phi1: FloatArray
    phi2: FloatArray
    slope: FloatArray
    bend: FloatArray

    def levers(self, distance: float, pressure_rad: float, *, ring: bool) -> tuple[FloatArray, FloatArray]:
        """Arms of the normals of pushing and of idle flanks about the driven axis, at the centre distance in mm.

        Polar form: the driving pitch curve's tangent is turned by atan(r1' / r1) from across the line of centres.
        """
        sense = -1.0 if ring else 1.0
        radius = distance / (1.0 + sense * self.slope)
        turn = np.arctan2(self.bend, self.slope * (1.0 + sense * self.slope))
        return radius * np.cos(pressure_rad - turn), radius * np.cos(pressure_rad + turn)


def golden(count: int, cycle: float) -> FloatArray:
    """Angles in rising order that keep step with no grid: multiples of the golden ratio, modulo the cycle."""
    return np.sort(cycle * np.mod(GOLDEN * (np.arange(count) + 0.5), 1.0))


def of_ratio(ratio: Function, ratio_slope: Function, phi1: FloatArray, lobes: tuple[int, int] = (1, 1)) -> Positions:
    """Driven angles for a ratio dphi1/dphi2 by a formula, with its derivative; the ratio is scaled so that it closes.

    One period takes 2 pi / n1 of the driving angle and 2 pi / n2 of the driven one.
    """
    period = 2.0 * pi / lobes[0]
    _, whole = _integrated(lambda phi: 1.0 / ratio(phi), np.linspace(0.0, period, 201))
    scale = whole / (2.0 * pi / lobes[1])
    phi2, _ = _integrated(lambda phi: 1.0 / (scale * ratio(phi)), np.concatenate([[0.0], phi1]))
    value = ratio(phi1)
    return Positions(phi1, phi2[1:], 1.0 / (scale * value), -ratio_slope(phi1) / (scale * value**2))


def of_harmonics(cosine: Sequence[float], sine: Sequence[float], phi2: FloatArray) -> Positions:
    """Positions at given driven angles of a law of one lobe whose ratio dphi1/dphi2 is exp(Fourier series of phi2)."""
    wave = np.arange(1, max(len(cosine), len(sine)) + 1)
    a, b = (np.pad(np.asarray(part, dtype=float), (0, wave.size - len(part))) for part in (cosine, sine))

    def series(t: FloatArray) -> FloatArray:
        return np.cos(t[..., None] * wave) @ a + np.sin(t[..., None] * wave) @ b

    bend = np.cos(phi2[:, None] * wave) @ (wave * b) - np.sin(phi2[:, None] * wave) @ (wave * a)
    places = np.concatenate([[0.0], phi2, [2.0 * pi]])
    turned, whole = _integrated(lambda t: np.exp(series(t)), places)
    slope = whole / (2.0 * pi) * np.exp(-series(phi2))
    return Positions(turned[1:-1] * (2.0 * pi / whole), phi2, slope, -bend * slope**2)


def of_spline(ratio: Sequence[float], phi2: FloatArray) -> Positions:
    """Positions at given driven angles of a law of one lobe: ln(dphi1/dphi2) is SciPy's periodic cubic spline.

    It goes through the logarithms of ratios at even driven angles, but for the constant that closes the cycle.
    """
    knots = np.linspace(0.0, 2.0 * pi, len(ratio) + 1)
    series = CubicSpline(knots, np.log(np.append(ratio, ratio[0])), bc_type="periodic")
    places = np.union1d(knots, phi2)
    turned, whole = _integrated(lambda t: np.exp(series(t)), places)
    slope = whole / (2.0 * pi) * np.exp(-series(phi2))
    return Positions(
        turned[np.searchsorted(places, phi2)] * (2.0 * pi / whole), phi2, slope, -series(phi2, 1) * slope**2
    )


def _integrated(function: Function, at: FloatArray) -> tuple[FloatArray, float]:
    """Integral from the first place to each, and to the last; long stretches are parted evenly."""
    fine = np.unique(np.concatenate([at, np.linspace(at[0], at[-1], 65)]))
    node, weight = np.polynomial.legendre.leggauss(NODES)
    half = np.diff(fine) / 2.0
    values = function((fine[:-1] + half)[:, None] + half[:, None] * node)
    whole = np.concatenate([[0.0], np.cumsum(half * (values @ weight))])
    return whole[np.searchsorted(fine, at)], float(whole[-1])


# --- outlines ----------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Freedom:
    """How far the driven gear turns on and back from a position, in its own sense, in rad; shape (n,) each.

    NaN where the start of the search is not free; infinite where the reach ends the search.
    """

    on: FloatArray
    back: FloatArray


@dataclass(frozen=True)
class Outlines:
    """Two closed outlines in mm, shape (n, 2), in their own frames in the pose of phi1 = 0, and their centre distance.

    The driven outline of a ring is that of its hole.
    """

    driving: FloatArray
    driven: FloatArray
    distance: float
    ring: bool = False

    def freedom(self, at: Positions, start: FloatArray | float, reach: float, resolution: float = 1e-7) -> Freedom:
        """Freedom of the driven gear from the law's angle, searched both ways from ``start`` off it up to ``reach``."""
        start = np.broadcast_to(np.asarray(start, dtype=float), at.phi1.shape)
        driving, driven = self._near(at, start, reach)
        blocked = self._blocked(driving, driven, at, start)
        on, back = (self._edge(driving, driven, at, start, way * reach, resolution) for way in (1.0, -1.0))
        return Freedom(np.where(blocked, np.nan, start + on), np.where(blocked, np.nan, -(start + back)))

    def overlap(self, at: Positions, offset: FloatArray | float = 0.0) -> FloatArray:
        """Depth of the overlap in mm with the driven gear turned on from the law's angle; 0 where there is none."""
        turned = at.phi2 + offset
        depth = np.zeros(at.phi1.shape)
        for row in range(at.phi1.size):
            driving = shapely.Polygon(self._driving(at.phi1[row : row + 1])[0])
            driven = shapely.Polygon(self._driven(turned[row : row + 1])[0])
            common = driving.difference(driven) if self.ring else _clipped(driving, driven)
            parts = [part for part in shapely.get_parts(common) if part.area > 0.0]
            depth[row] = max((width(part) for part in parts), default=0.0)
        return depth

    def _driving(self, phi1: FloatArray) -> FloatArray:
        """Outlines about the driven axis, shape (n, points, 2)."""
        return _turned(self.driving, phi1) - np.array([self.distance, 0.0])

    def _driven(self, phi2: FloatArray) -> FloatArray:
        return _turned(self.driven, phi2 if self.ring else -phi2)

    def _near(self, at: Positions, start: FloatArray, reach: float) -> tuple[FloatArray, FloatArray]:
        """Chords that can meet within the reach, one collection for each position."""
        one, other = _finely(self.driving), _finely(self.driven)
        margin = 1.1 * reach * float(np.hypot(*self.driven.T).max()) + FINE
        tree, near = KDTree(other), []
        for row in range(at.phi1.size):
            turn = (at.phi2[row : row + 1] + start[row]) * (1.0 if self.ring else -1.0)
            placed = _turned(one, at.phi1[row : row + 1])[0] - np.array([self.distance, 0.0])
            own = _turned(placed, -turn)[0]
            close = np.isfinite(tree.query(own, distance_upper_bound=margin)[0])
            facing = np.zeros(len(other), dtype=bool)
            if close.any():
                facing = np.isfinite(KDTree(own[close]).query(other, distance_upper_bound=margin)[0])
            near.append([_lines(placed, close), _lines(_turned(other, turn)[0], facing)])
        driving, driven = (np.array(side, dtype=object) for side in zip(*near, strict=True))
        shapely.prepare(driving)
        return driving, driven

    def _blocked(self, driving: FloatArray, driven: FloatArray, at: Positions, start: FloatArray) -> FloatArray:
        """Whether the outlines are not free at the start: their edges meet there, or a vertex is inside the other.

        Edges that do not meet leave whole outlines apart or one inside the other, which is told by one vertex.
        """
        found = shapely.intersects(driving, driven)
        inner = shapely.points(self._driving(at.phi1)[:, 0])
        hole = shapely.polygons(self._driven(at.phi2 + start))
        return found | (shapely.contains(hole, inner) != self.ring)

    def _edge(
        self,
        driving: FloatArray,
        driven: FloatArray,
        at: Positions,
        start: FloatArray,
        reach: float,
        resolution: float,
    ) -> FloatArray:
        """Offsets from the start at which the outlines touch: steps outwards find the touch, halving its place."""
        sense = 1.0 if self.ring else -1.0
        steps = np.linspace(0.0, reach, STEPS + 1)[1:]
        low, high = np.zeros(start.shape), np.full(start.shape, np.inf)
        for before, step in zip(np.concatenate([[0.0], steps[:-1]]), steps, strict=True):
            new = np.isinf(high) & shapely.intersects(driving, _rotated(driven, np.full(start.shape, sense * step)))
            low, high = np.where(new, before, low), np.where(new, step, high)
        found = np.isfinite(high)
        low, high = np.where(found, low, 0.0), np.where(found, high, 0.0)
        while np.abs(high - low).max() > resolution:
            middle = (low + high) / 2.0
            met = shapely.intersects(driving, _rotated(driven, sense * middle))
            low, high = np.where(met, low, middle), np.where(met, middle, high)
        return np.where(found, low, np.copysign(np.inf, reach))


FINE = 0.3
"""Longest chord in mm between points by which nearness is told."""

STEPS = 3
"""Steps from the start to the reach in which the first touch is sought: teeth are much thicker than a step."""


def _turned(outline: FloatArray, angle: FloatArray) -> FloatArray:
    """Copies of an outline turned by angles about the origin, shape (angles, points, 2)."""
    placed = (outline[:, 0] + 1j * outline[:, 1]) * np.exp(1j * angle)[:, None]
    return np.stack([placed.real, placed.imag], axis=-1)


def _rotated(geometry: FloatArray, angle: FloatArray) -> FloatArray:
    """Geometries, each turned by an angle of its own about the origin."""
    points, owner = shapely.get_coordinates(geometry, return_index=True)
    placed = (points[:, 0] + 1j * points[:, 1]) * np.exp(1j * angle[owner])
    return shapely.set_coordinates(geometry.copy(), np.column_stack([placed.real, placed.imag]))


def _finely(outline: FloatArray) -> FloatArray:
    """The outline with points added on its chords, so that none is longer than ``FINE``."""
    step = np.roll(outline, -1, axis=0) - outline
    count = np.ceil(np.hypot(*step.T) / FINE).astype(int)
    row = np.repeat(np.arange(len(outline)), count)
    share = (np.arange(row.size) - np.repeat(np.cumsum(count) - count, count)) / count[row]
    return outline[row] + share[:, None] * step[row]


def _lines(outline: FloatArray, kept: NDArray[np.bool_]) -> shapely.MultiLineString:
    """The chords of a closed outline that begin or end at a kept point."""
    chord = kept | np.roll(kept, -1)
    if not chord.any():
        return shapely.MultiLineString()
    return shapely.multilinestrings(list(np.stack([outline, np.roll(outline, -1, axis=0)], axis=1)[chord]))


def _clipped(one: shapely.Polygon, other: shapely.Polygon) -> shapely.Geometry:
    """The common part; both are first clipped to the common part of their bounds."""
    low, high = np.maximum(one.bounds[:2], other.bounds[:2]), np.minimum(one.bounds[2:], other.bounds[2:])
    if np.any(low >= high):
        return shapely.Polygon()
    box = shapely.box(*low, *high)
    return one.intersection(box).intersection(other.intersection(box))
