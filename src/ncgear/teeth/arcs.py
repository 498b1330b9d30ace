"""Lines and arcs of circles, and points that lie on one."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ncgear.numerics.arrays import Array


@dataclass(frozen=True, eq=False)
class Line:
    """A straight line; points of shape (2,) in mm."""

    start: Array
    end: Array


@dataclass(frozen=True, eq=False)
class Arc:
    """The arc of a circle through three points of shape (2,) in mm."""

    start: Array
    middle: Array
    end: Array


def line_or_arc(points_mm: Array, within_mm: float) -> tuple[Line | Arc, float] | None:
    """The line or arc from the first to the last of points (n, 2), n >= 2, and how far the others are from it.

    None where neither passes all of them within a distance.
    """
    start, middle, end = points_mm[0], points_mm[len(points_mm) // 2], points_mm[-1]
    for curve in (Line(start, end), Arc(start, middle, end)):
        if (off := float(distances_mm(curve, points_mm).max())) <= within_mm:
            return curve, off
    return None


def distances_mm(curve: Line | Arc, points_mm: Array) -> Array:
    """Distances of points (n, 2) from the whole line or circle, shape (n,); infinite where an arc has no circle."""
    if isinstance(curve, Line):
        chord = (curve.end - curve.start) / np.linalg.norm(curve.end - curve.start)
        arm = points_mm - curve.start
        return np.asarray(np.abs(chord[0] * arm[:, 1] - chord[1] * arm[:, 0]))
    center, radius = _circle(curve)
    return np.asarray(np.abs(np.linalg.norm(points_mm - center, axis=1) - radius))


def _circle(arc: Arc) -> tuple[Array, float]:
    """Centre and radius of an arc's circle; a point infinitely far away where its points are in line."""
    rows = np.array([arc.middle - arc.start, arc.end - arc.start])
    if np.linalg.det(rows) == 0.0:
        return np.full(2, np.inf), 0.0
    arm = np.linalg.solve(rows, np.sum(rows**2, axis=1) / 2.0)
    return arc.start + arm, float(np.linalg.norm(arm))


def ring_of_arcs(ring_mm: Array, within_mm: float) -> list[Line | Arc]:
    """A closed polygon (n, 2) as lines and arcs, each as long as it stays within a distance of all its corners.

    They stay within twice as much of the middles of its sides and so, as parabolas, within 17/8 of it everywhere.  None
    takes more than a third of the corners, so that none turns by half a circle or more.
    """
    closed, found, first = np.vstack([ring_mm, ring_mm[:1]]), [], 0
    longest = max(1, len(ring_mm) // 3)
    while first < len(ring_mm):
        last, curve = first + 1, _through(closed[first : first + 2], within_mm)
        while last < min(first + longest, len(ring_mm)):
            farther = _through(closed[first : last + 2], within_mm)
            if farther is None:
                break
            last, curve = last + 1, farther
        assert curve is not None
        found.append(curve)
        first = last
    return found


def _through(corners: Array, within: float) -> Line | Arc | None:
    """The line or arc along the sides between corners (n, 2), if there is one."""
    found = line_or_arc(corners, within)
    if found is None or distances_mm(found[0], (corners[:-1] + corners[1:]) / 2.0).max() > 2.0 * within:
        return None
    return found[0]
