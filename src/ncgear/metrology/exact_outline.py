"""Distances of points from the exact outline of a gear: along its own normals, not from the chords of a file.

The outline is a closed chain of smooth curves (flanks, fillets, lands).  For each point the nearest samples of the
chain show on which curves its foot may lie; there steps along the tangent find it,

  share += (point - curve(share)) . slope(share) / |slope(share)|^2

which is Gauss and Newton's method for the least distance.  Each step leaves as much of the error as the distance is of
the radius of curvature; for points of a measured gear this is some hundredths.
"""

from __future__ import annotations

from dataclasses import replace
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
import shapely

from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array, Columns, ComplexArray, IndexArray, Mask, counted_up
from ncgear.numerics.plane import across, along, as_complex, as_points, square
from ncgear.pitch.shape import Gear
from ncgear.teeth.gear import ToothedGear
from ncgear.teeth.outline import exact_curves
from ncgear.teeth.stretch import CurveStretch

if TYPE_CHECKING:
    from scipy.spatial import cKDTree

FLANK_CURVE, TIP_LAND_CURVE = 0, 2
"""The numbers of flanks and tip lands among ``exact_curves``."""

PROBES = 33
"""Places of each curve between which its length is measured."""

SAMPLES_PER_MODULE = 20.0
"""Samples of all curves in a module's length, which show the curves near a point."""

NEAR_SAMPLES, CANDIDATES = 16, 3
"""Nearest samples that are examined, and the most of their curves on which a foot is searched: near a corner, and in a
thin tip, several compete."""

STEPS = 30
"""Most steps along the tangent."""

SETTLED = 1e-11
"""Change of a share below which it has settled: some 1e-10 mm on the curves of teeth."""


@dataclass(frozen=True, eq=False)
class Feet(Columns):
    """The nearest places of the outline to n points, shape (n,) each.

    ``distance_mm`` is positive on the side away from the material.  ``row`` numbers the curve, ``share`` is the foot's
    share of the way along it, and ``place_mm`` its way along the whole outline.  ``outwards`` is the unit normal away
    from the material.  ``at_end`` is true for feet at an end of their curve, where the distance may not be along the
    normal.
    """

    point: ComplexArray
    foot: ComplexArray
    outwards: ComplexArray
    distance_mm: Array
    row: IndexArray
    share: Array
    place_mm: Array
    at_end: Mask

    def less(self, radius_mm: float) -> Feet:
        """The feet of the places that a ball about each point touches: nearer to the material by its radius."""
        return replace(self, point=self.point - radius_mm * self.outwards, distance_mm=self.distance_mm - radius_mm)


@dataclass(frozen=True, eq=False)
class ExactOutline:
    """The exact curves of a gear's outline as rows of one chain, in the sense of growing arc length.

    ``part`` and ``number`` give the stretch of each row, and its curve there; ``begin_mm`` is its beginning along the
    outline and ``length_mm`` its length, shape (rows,) each.  ``material`` is the side of the material as seen along
    the chain, +1 to the left.
    """

    gear: ToothedGear
    stretches: tuple[CurveStretch, ...]
    part: IndexArray
    number: IndexArray
    begin_mm: Array
    length_mm: Array
    material: float

    @property
    def around_mm(self) -> float:
        """Length of the whole outline."""
        return float(self.length_mm.sum())

    @cached_property
    def middle_mm(self) -> complex:
        """The mean of places that are evenly spread over the outline."""
        return complex(self.at(*self._sampled)[0].mean())

    @cached_property
    def flank(self) -> IndexArray:
        """The flank of each row: its own flank, or the flank that its land follows."""
        owners = [stretch.owner for stretch in self.stretches]
        return np.array([owners[part][number] for part, number in zip(self.part, self.number, strict=True)])

    @cached_property
    def _tree(self) -> cKDTree:
        from scipy.spatial import cKDTree

        samples, _ = self.at(*self._sampled)
        return cKDTree(as_points(samples))

    @cached_property
    def _sampled(self) -> tuple[IndexArray, Array]:
        """Rows and shares of the samples: both ends of each row and as many between as its length needs."""
        steps = np.ceil(self.length_mm * SAMPLES_PER_MODULE / self.gear.flanks.rack.module_mm).astype(np.intp)
        row, number = counted_up(np.zeros_like(steps), steps + 1)
        return row, number / steps[row]

    def near_mm(self, points: ComplexArray) -> Array:
        """Distances from samples of the outline, which are never less than distances from the outline; shape (n,)."""
        return np.asarray(self._tree.query(as_points(points))[0])

    def at(self, row: IndexArray, share: Array) -> tuple[ComplexArray, ComplexArray]:
        """Points of rows at shares of their way, and derivatives by the share; shape (n,) each."""
        point, slope = np.empty(row.size, dtype=complex), np.empty(row.size, dtype=complex)
        for part, stretch in enumerate(self.stretches):
            here = np.flatnonzero(self.part[row] == part)
            if here.size:
                found = stretch.at(self.number[row[here]], share[here])
                point[here], slope[here] = (as_complex(values) for values in found)
        return point, slope

    def at_place(self, place_mm: Array) -> ComplexArray:
        """Points at ways along the whole outline, shape (n,)."""
        row = np.clip(np.searchsorted(self.begin_mm, place_mm, side="right") - 1, 0, self.part.size - 1)
        share = np.clip((place_mm - self.begin_mm[row]) / np.maximum(self.length_mm[row], 1e-300), 0.0, 1.0)
        return self.at(row, share)[0]

    def height_mm(self, row: IndexArray, share: Array) -> Array:
        """Height over the rack's pitch line of feet on flanks, shape (n,); without meaning elsewhere."""
        flanks, number = self.stretches[FLANK_CURVE], np.where(self.part[row] == FLANK_CURVE, self.number[row], 0)
        return flanks.start[number] + share * (flanks.end - flanks.start)[number]

    def feet(self, points: ComplexArray) -> Feet:
        """The nearest places of the outline to points, shape (n,)."""
        row, share = self._candidates(points)
        many = np.repeat(points, CANDIDATES)
        moving = np.arange(many.size)
        for _ in range(STEPS):
            point, slope = self.at(row[moving], share[moving])
            step = along(slope, many[moving] - point) / np.maximum(square(slope), 1e-300)
            moved = np.clip(share[moving] + step, 0.0, 1.0)
            open_still = np.abs(moved - share[moving]) > SETTLED
            share[moving] = moved
            moving = moving[open_still]
            if not moving.size:
                break
        foot, slope = self.at(row, share)
        outwards = -1j * self.material * slope / np.maximum(np.abs(slope), 1e-300)
        away = np.abs(many - foot).reshape(-1, CANDIDATES)
        best = np.arange(points.size) * CANDIDATES + np.argmin(away, axis=1)
        row, share, foot, outwards = row[best], share[best], foot[best], outwards[best]
        sense = np.where(self.material * across(slope[best], points - foot) > 0.0, -1.0, 1.0)
        at_end = (share <= 0.0) | (share >= 1.0)
        distance = np.where(at_end, sense * np.abs(points - foot), along(outwards, points - foot))
        place = self.begin_mm[row] + share * self.length_mm[row]
        return Feet(points, foot, outwards, distance, row, share, place, at_end)

    def _candidates(self, points: ComplexArray) -> tuple[IndexArray, Array]:
        """Curves and shares where the search for feet begins, (CANDIDATES * n,): nearest samples of each near curve."""
        _, nearest = self._tree.query(as_points(points), k=NEAR_SAMPLES)
        sampled_row, sampled_share = self._sampled
        row = sampled_row[nearest]
        chosen = np.zeros((points.size, CANDIDATES), dtype=np.intp)
        for place in range(1, CANDIDATES):
            taken = np.take_along_axis(row, chosen[:, :place], axis=1)
            others = np.all(row[:, :, None] != taken[:, None, :], axis=2)
            chosen[:, place] = np.argmax(others, axis=1)
        first = np.take_along_axis(row, chosen, axis=1).ravel()
        return first, np.take_along_axis(sampled_share[nearest], chosen, axis=1).ravel()


def exact_outline(gear: ToothedGear) -> ExactOutline:
    """The exact outline of a gear."""
    stretches = tuple(exact_curves(gear.tips, gear.sides))
    part = np.repeat(np.arange(len(stretches)), [stretch.owner.size for stretch in stretches])
    number = np.concatenate([np.arange(stretch.owner.size) for stretch in stretches])
    order = np.argsort(np.concatenate([stretch.rank for stretch in stretches]), kind="stable")
    part, number = part[order], number[order]
    share = np.linspace(0.0, 1.0, PROBES)
    by_part = [
        as_complex(stretch.at(np.arange(stretch.owner.size)[:, None], share[None, :])[0]) for stretch in stretches
    ]
    length = np.abs(np.diff(np.concatenate(by_part)[order], axis=1)).sum(axis=1)
    begin = np.append(0.0, np.cumsum(length)[:-1])
    material = -1.0 if gear.flanks.curve.gear is Gear.DRIVING else 1.0
    return ExactOutline(gear, stretches, part, number, begin, length, material)


PER_CURVE = 21
"""Checked points of each flank, fillet and land, at equal shares, in addition to the points of chords and arcs."""

OFF_GRID = 0.382
"""Share of the way between two of these points at which the first one lies."""

CHORDS = 8
"""Chords of an outline that are one line of the search."""

FEW = 256
"""Points that are measured first, from those that seem nearest to those that seem farthest; of the other points, only
those that may be farther than the farthest of these are measured."""


def exact_points(gear: ToothedGear) -> Array:
    """Points of all exact curves of a gear's outline, shape (n, 2)."""
    share = (np.arange(PER_CURVE) + OFF_GRID) / PER_CURVE
    stretches = exact_curves(gear.tips, gear.sides)
    points = [stretch.at(np.arange(stretch.owner.size)[:, None], share)[0].reshape(-1, 2) for stretch in stretches]
    return np.concatenate(points)


def farthest_mm(points: Array, outline_mm: Array) -> float:
    """The largest distance of points (n, 2) from a closed line through others (m, 2)."""
    # Lines of a few chords: hardly more distances than with single chords, and far fewer lines.
    first = np.arange(0, len(outline_mm), CHORDS)
    last = np.minimum(first + CHORDS, len(outline_mm))
    line, corner = counted_up(first, last - first + 1)
    tree = shapely.STRtree(shapely.linestrings(outline_mm[corner % len(outline_mm)], indices=line))
    most = _at_most_mm(as_complex(points), as_complex(outline_mm))
    chosen = np.argsort(most)[:: max(most.size // FEW, 1)]
    few = _farthest_mm(points[chosen], tree)
    most[chosen] = 0.0
    return max(few, _farthest_mm(points[most > few], tree))


def _at_most_mm(points: ComplexArray, outline: ComplexArray) -> Array:
    """Distances of points (n,) from two chords of a closed line (m,): upper bounds of their distances from the line.

    The chords are those at the corner next to the point by the angle about the axis. On teeth that no ray from the axis
    crosses twice they are the nearest chords or next to them.
    """
    angle = np.angle(outline)
    by_angle = np.argsort(angle)
    corner = by_angle[np.searchsorted(angle[by_angle], np.angle(points)) - 1]
    return np.minimum(
        _from_chords_mm(points, outline[corner], outline[(corner + 1) % outline.size]),
        _from_chords_mm(points, outline[corner], outline[corner - 1]),
    )


def _from_chords_mm(points: ComplexArray, start: ComplexArray, end: ComplexArray) -> Array:
    """Distances of points from chords, shape (n,) each."""
    chord, way = end - start, points - start
    length = np.square(chord.real) + np.square(chord.imag)
    share = (way.real * chord.real + way.imag * chord.imag) / np.where(length > 0.0, length, 1.0)
    return np.abs(way - np.clip(share, 0.0, 1.0) * chord)


def _farthest_mm(points: Array, tree: shapely.STRtree) -> float:
    """The largest distance of points (n, 2) from the nearest line of a tree each; 0 for no points."""
    _, distance = tree.query_nearest(shapely.points(points), return_distance=True, all_matches=False)
    return float(distance.max(initial=0.0))
