"""Count of touching flanks on two outlines, from their points alone.

The driven outline stands still, the driving one is placed as the law says, and the driven gear is turned until the
first flanks of one side touch.  Each pair of flanks has a separation: the least signed distance from a vertex of either
outline to the chords of the other.  A pair counts where that is within a given distance, unless it is a tip's corner
that is nearest: then an edge touches, not a flank.  As the contact nears a corner, the chords cannot tell which of the
two is nearer, so there are two counts, between which the true one lies.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

FloatArray = NDArray[np.float64]
ComplexArray = NDArray[np.complex128]
IntArray = NDArray[np.int64]

SHARP_RAD = 0.5
"""Turn of an outline that makes a vertex the corner of a tip; on smooth curves chords turn by some thousandths."""

TURNS = 2
"""Steps of Newton's method towards the first touch: separations are linear in the turn to some millionths."""

LOOKED_AT_MM = 0.15
"""Vertices farther than this from the other outline are left out; chords are shorter, and reliefs less deep."""


@dataclass(frozen=True, eq=False)
class Gear:
    """An outline, shape (n, 2), counter-clockwise about its axis; ``ring`` has its material outside."""

    points: ComplexArray
    normal: ComplexArray
    flank: IntArray
    corner: NDArray[np.bool_]
    tree: cKDTree


def gear(outline: FloatArray, *, ring: bool = False) -> Gear:
    """A gear whose flanks go from the middle of a tip's land, over its corner, to the middle of the space."""
    points = outline[:, 0] + 1j * outline[:, 1]
    chord = np.roll(points, -1) - points
    turn = np.angle(chord / np.roll(chord, 1)) * (-1.0 if ring else 1.0)
    corner = turn > SHARP_RAD
    points, chord, corner = (np.roll(array, -int(np.argmax(corner))) for array in (points, chord, corner))
    run = np.cumsum(corner) - 1
    length = np.append(0.0, np.cumsum(np.abs(chord)))
    starts = np.append(np.flatnonzero(corner), points.size)
    middle = (length[starts[:-1]] + length[starts[1:]])[run] / 2.0
    normal = chord / np.abs(chord) * (1j if ring else -1j)
    flank = (run + (length[:-1] >= middle)) % (run[-1] + 1)
    return Gear(points, normal, flank, corner, cKDTree(np.column_stack([points.real, points.imag])))


@dataclass(frozen=True, eq=False)
class Poses:
    """The law at n positions: turn of the driving gear as the driven one sees it, and the driving axis there."""

    turn: ComplexArray
    axis: ComplexArray
    sense: float

    def turned(self, delta: FloatArray) -> Poses:
        """The driven gear turned on by angles (n,): it sees the driving gear turned back about its axis."""
        back = np.exp(-1j * self.sense * delta)
        return Poses(self.turn * back, self.axis * back, self.sense)


def poses(phi1: FloatArray, phi2: FloatArray, center_distance: float, sense: float = -1.0) -> Poses:
    """Poses by the law; ``sense`` is +1 where the driven gear turns as the driving one does."""
    back = np.exp(-1j * sense * phi2)
    return Poses(np.exp(1j * phi1) * back, -center_distance * back, sense)


@dataclass(frozen=True, eq=False)
class _Looked:
    """Which vertices of a gear are near the mesh: k positions and vertices."""

    row: IntArray
    vertex: IntArray

    def kept(self, mask: NDArray[np.bool_]) -> _Looked:
        """Some of them."""
        return _Looked(self.row[mask], self.vertex[mask])


def _close(other: Gear, points: ComplexArray) -> NDArray[np.bool_]:
    """Which points are near an outline's vertices."""
    found = other.tree.query(np.column_stack([points.real, points.imag]), distance_upper_bound=LOOKED_AT_MM)[0]
    return np.isfinite(found)


def _near_mesh(one: Gear, heading: ComplexArray, window: float) -> _Looked:
    """Vertices within ``window`` mm to either side of the line of centres, at headings of shape (n,)."""
    along = heading / np.abs(heading)
    ahead = np.outer(along.real, one.points.real) + np.outer(along.imag, one.points.imag) > 0.0
    off = np.outer(along.real, one.points.imag) - np.outer(along.imag, one.points.real)
    return _Looked(*np.nonzero(ahead & (np.abs(off) <= window)))


@dataclass(frozen=True, eq=False)
class _Apart:
    """Separations of k pairs of flanks in mm, with their slopes by the driven gear's turn on.

    ``off_corners`` are the separations with the corners of tips left out, ``at_corners`` those of the corners.
    """

    position: IntArray
    apart: FloatArray
    slope: FloatArray
    off_corners: FloatArray
    at_corners: FloatArray


def touching(
    gears: tuple[Gear, Gear], at: Poses, side: float, within: float, chords: float, window: float
) -> tuple[IntArray, IntArray]:
    """The fewest and the most pairs of flanks that may touch at each position, shape (n,) each.

    ``gears`` are the driving and the driven one; ``side`` is +1 for flanks that push, -1 for their backs.  ``within``
    is the distance in mm at which flanks count, and ``chords`` the one that chords cannot tell.  ``window`` is how far
    to either side of the line of centres teeth may touch, in mm.
    """
    driving, driven = gears
    first = _near_mesh(driving, at.sense * at.axis / at.turn, window)
    second = _near_mesh(driven, at.axis, window)
    looked = (
        first.kept(_close(driven, driving.points[first.vertex] * at.turn[first.row] + at.axis[first.row])),
        second.kept(_close(driving, (driven.points[second.vertex] - at.axis[second.row]) / at.turn[second.row])),
    )
    delta = np.zeros(at.turn.size)
    for _ in range(TURNS):
        found = _separations(gears, looked, at.turned(delta), side)
        step = np.full(delta.size, -np.inf)
        np.maximum.at(step, found.position, -found.apart / found.slope)
        delta += side * step
    found = _separations(gears, looked, at.turned(delta), side)
    fewest = (found.apart <= within - chords) & (found.at_corners > found.apart + chords)
    most = (found.apart <= within + chords) & (found.off_corners <= found.apart + chords)
    count = delta.size
    return np.bincount(found.position[fewest], minlength=count), np.bincount(found.position[most], minlength=count)


def _separations(gears: tuple[Gear, Gear], looked: tuple[_Looked, _Looked], at: Poses, side: float) -> _Apart:
    """The least distance of each pair of flanks that the driven gear's turn towards ``side`` parts."""
    driving, driven = gears
    row, vertex = looked[0].row, looked[0].vertex
    seen = driving.points[vertex] * at.turn[row] + at.axis[row]
    apart, near, normal, edge = _to_chords(driven, seen)
    # The driven surface moves on with i z times its sense; that takes it away from a point outside of it.
    slope = -at.sense * np.real(np.conj(1j * seen) * normal)
    first = row, driving.flank[vertex], driven.flank[near], apart, side * slope, edge | driving.corner[vertex], seen
    row, vertex = looked[1].row, looked[1].vertex
    seen = driven.points[vertex]
    apart, near, normal, edge = _to_chords(driving, (seen - at.axis[row]) / at.turn[row])
    slope = at.sense * np.real(np.conj(1j * seen) * normal * at.turn[row])
    second = row, driving.flank[near], driven.flank[vertex], apart, side * slope, edge | driven.corner[vertex], seen
    row, one, other, apart, slope, edge, seen = (np.concatenate(both) for both in zip(first, second, strict=True))
    facing = np.nonzero(slope > LEAST_LEVER * np.abs(seen))[0]
    order = facing[np.lexsort((apart[facing], other[facing], one[facing], row[facing]))]
    pair = np.column_stack([row, one, other])[order]
    begins = np.flatnonzero(np.append(True, np.any(np.diff(pair, axis=0) != 0, axis=1)))
    off_corners = np.minimum.reduceat(np.where(edge, np.inf, apart)[order], begins)
    least = order[begins]
    at_corners = np.minimum.reduceat(np.where(edge, apart, np.inf)[order], begins)
    return _Apart(row[least], apart[least], slope[least], off_corners, at_corners)


LEAST_LEVER = 0.3
"""Least lever of a flank's normal, as a share of the distance from the axis: lands and roots have next to none."""

AT_CORNER_MM = 1e-3
"""Distance from a corner within which it is the corner that is nearest."""


def _to_chords(one: Gear, points: ComplexArray) -> tuple[FloatArray, IntArray, ComplexArray, NDArray[np.bool_]]:
    """Signed distance of points to an outline, the number of the chord, its outward normal, and whether at a corner."""
    nearest = one.tree.query(np.column_stack([points.real, points.imag]))[1]
    count = one.points.size
    best = np.full(points.size, np.inf)
    chord, foot = np.zeros(points.size, dtype=int), np.zeros(points.size, dtype=complex)
    for number in ((nearest - 1) % count, nearest):
        start = one.points[number]
        way = one.points[(number + 1) % count] - start
        share = np.clip(np.real((points - start) * np.conj(way)) / np.abs(way) ** 2, 0.0, 1.0)
        place = start + share * way
        closer = np.abs(points - place) < best
        best = np.where(closer, np.abs(points - place), best)
        chord, foot = np.where(closer, number, chord), np.where(closer, place, foot)
    normal = one.normal[chord]
    outside = np.real((points - foot) * np.conj(normal)) >= 0.0
    corner = np.zeros(points.size, dtype=bool)
    for number in (chord, (chord + 1) % count):
        corner |= one.corner[number] & (np.abs(foot - one.points[number]) < AT_CORNER_MM)
    return np.where(outside, best, -best), chord, normal, corner
