"""Parts of a drawing as one closed contour: joined at their ends, without what is drawn twice; points along it."""

from __future__ import annotations

from collections.abc import Sequence
from math import hypot, pi

import numpy as np

from ncgear.errors import WrongInput
from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array
from ncgear.numerics.rational import RationalSpline
from ncgear.ratio.laws.closed_curve import JOINED

ROUGHEST = 1e-3
"""Share of a contour's size above which a gap between ends is no rounding: the contour is open."""

PER_PART, ALONG = 128, 1000
"""Points on each smooth part of a contour that is smoothed with its neighbours, and the least number of pieces of a
contour as long as a circle of its size."""


def points_along(curves: Sequence[RationalSpline]) -> Array:
    """Points of a chain, shape (n, 2), close together all along it, with its corners.

    Pieces of chords are at most 1 / ALONG of a circle of the chain's size; a smooth part has PER_PART points.
    """
    every = np.concatenate([curve.points for curve in curves])
    longest = float(np.max(np.ptp(every, axis=0))) * pi / ALONG
    found = list[Array]()
    for curve in curves:
        if curve.degree == 1:
            chords = np.diff(curve.points, axis=0)
            pieces = np.maximum(np.ceil(np.hypot(*chords.T) / longest), 1.0).astype(int)
            share = (np.arange(pieces.sum()) - np.repeat(np.cumsum(pieces) - pieces, pieces)) / np.repeat(
                pieces, pieces
            )
            found.append(
                np.repeat(curve.points[:-1], pieces, axis=0) + share[:, None] * np.repeat(chords, pieces, axis=0)
            )
            continue
        for part in curve.smooth_parts():
            x, y = part.at(np.linspace(part.breaks[0], part.breaks[-1], PER_PART, endpoint=False), 0)
            found.append(np.column_stack([x.value, y.value]))
    return np.concatenate(found)


ALONGSIDE = 1e-5
"""Share of a contour's size within which a part along others is the same line, drawn twice."""

FINE, FEWEST, LOOKED_AT = 4096, 8, 65
"""Chords for the curves of a contour, by which distances are measured; fewest chords of a curve's span; and places of a
part, beside its corners, that have to be along others."""


@dataclass(frozen=True, eq=False)
class JoinedContour:
    """A closed chain of parts, each beginning where the one before ends; the greatest gap that their ends had, and the
    length of the parts that were drawn twice and left out, in mm."""

    parts: list[RationalSpline]
    gap_mm: float
    doubled_mm: float


def one_contour(curves: Sequence[RationalSpline], near_mm: float, key: str) -> JoinedContour:
    """Curves in any order and sense as a closed chain.

    Ends within ``near_mm``, but no more than ROUGHEST and no less than JOINED of the contour's size, are one point, and
    are joined there; shorter curves, and curves all along others, are left out.  Raises WrongInput where they are not
    one closed contour.
    """
    size = max((float(np.max(np.ptp(curve.points, axis=0))) for curve in curves), default=0.0)
    if not size:
        raise WrongInput("no lines, arcs or curves; one closed contour is needed", key=key)
    every = np.concatenate([curve.points for curve in curves])
    size = float(np.max(np.ptp(every, axis=0)))
    near = min(max(near_mm, JOINED * size), ROUGHEST * size)
    left = [curve for curve in curves if np.max(np.ptp(curve.points, axis=0)) > near]
    left, doubled_mm = _without_doubled(left, max(near, ALONGSIDE * size))
    # Both ends of all parts; the ends of parts in the chain are infinitely far.
    ends_mm = np.array([[curve.points[0], curve.points[-1]] for curve in left])
    found, first = [left[0]], left[0].points[0]
    ends_mm[0] = np.inf
    while _gap(tip := found[-1].points[-1], first) > near:
        away = np.hypot(*(ends_mm - tip).reshape(-1, 2).T)
        number, backwards = divmod(int(np.argmin(away)), 2)
        if (reach := float(away.min())) > near:
            nearest = f", the nearest one {reach:.3g} mm away" if len(found) < len(left) else ""
            raise WrongInput(
                f"the contour is open: it ends at ({tip[0]:.6g}, {tip[1]:.6g}), where no other part begins{nearest}; "
                "one closed contour is needed",
                key=key,
            )
        found.append(left[number].reversed() if backwards else left[number])
        ends_mm[number] = np.inf
    if beside := len(left) - len(found):
        at = left[int(np.argmax(np.isfinite(ends_mm[:, 0, 0])))].points[0]
        raise WrongInput(
            f"{beside} further part{'s' if beside > 1 else ''} beside a closed contour, at ({at[0]:.6g}, "
            f"{at[1]:.6g}); one closed contour is needed: name its layer or element, or remove the others",
            key=key,
        )
    ends = [curve.points[-1] for curve in found]
    starts = [ends[-1], *ends[:-1]]
    gap_mm = max(_gap(curve.points[0], start) for curve, start in zip(found, starts, strict=True))
    joined = [_from(curve, start, end) for curve, start, end in zip(found, starts, ends, strict=True)]
    return JoinedContour(joined, gap_mm, doubled_mm)


def _without_doubled(curves: Sequence[RationalSpline], near_mm: float) -> tuple[list[RationalSpline], float]:
    """The curves without those that run along others, the shorter ones first, and the length of these in mm."""
    import shapely

    if len(curves) <= 1:
        return list(curves), 0.0
    lines = np.array([shapely.LineString(curve.chords(FINE // len(curves) + FEWEST)) for curve in curves])
    lengths, tree = shapely.length(lines), shapely.STRtree(lines)
    middles = shapely.line_interpolate_point(lines, 0.5, normalized=True)
    part, other = tree.query(middles, predicate="dwithin", distance=near_mm)
    kept = np.ones(len(lines), dtype=bool)
    for number in sorted(set(part[part != other].tolist()), key=lambda one: (lengths[one], -one)):
        beside = np.setdiff1d(tree.query(lines[number], predicate="dwithin", distance=near_mm), number)
        others = shapely.multilinestrings(lines[beside[kept[beside]]])
        shapely.prepare(others)
        even = shapely.line_interpolate_point(lines[number], np.linspace(0.0, 1.0, LOOKED_AT), normalized=True)
        corners = shapely.points(shapely.get_coordinates(lines[number]))
        kept[number] = not all(np.all(shapely.dwithin(others, places, near_mm)) for places in (even, corners))
    return [curve for curve, stays in zip(curves, kept, strict=True) if stays], float(np.sum(lengths[~kept]))


def _gap(one: Array, other: Array) -> float:
    return hypot(*(one - other).tolist())


def _from(curve: RationalSpline, start: Array, end: Array) -> RationalSpline:
    points = curve.points.copy()
    points[0], points[-1] = start, end
    return RationalSpline(curve.degree, curve.knots, points, curve.weights)
