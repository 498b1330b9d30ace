"""The closed outline of a gear as few smooth curves: lines, arcs of circles, and B-splines.

Programs for solids make one face of each curve, so that a flank stays one flank, where a polygon would give a facet for
every chord.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from ncgear.numerics.arrays import Array, IndexArray
from ncgear.teeth.arcs import Arc, Line, line_or_arc
from ncgear.teeth.chords import Stretch
from ncgear.teeth.gear import ToothedGear
from ncgear.teeth.outline import exact_curves
from ncgear.teeth.splines import fitted_splines

SAME_MM = 1e-7
"""Distance at which programs for solids take two points as one: a curve this close to a line or a circle is one."""

SHORTEST_MM = 100.0 * SAME_MM
"""Curves shorter than this are left out, and the next one's beginning is the last one's end: a face so narrow would be
nothing but its own tolerances."""

LOOKED_AT = np.linspace(0.0, 1.0, 9)
"""Shares of a curve at which it is held against a line or a circle; it bends too little to wave between them."""


@dataclass(frozen=True, eq=False)
class Spline:
    """A cubic B-spline: clamped knots (n + 4,), poles (n, 2) in mm."""

    knots: Array
    poles_mm: Array

    @property
    def start(self) -> Array:
        """First point, shape (2,)."""
        return np.asarray(self.poles_mm[0])

    @property
    def end(self) -> Array:
        """Last point, shape (2,)."""
        return np.asarray(self.poles_mm[-1])


Curve = Line | Arc | Spline


@dataclass(frozen=True, eq=False)
class Contour:
    """Curves one after the other round a gear, each beginning exactly where the last one ends.

    ``deviation_mm`` is the largest distance found between points of them and of the exact curves.
    """

    curves: tuple[Curve, ...]
    deviation_mm: float


@dataclass(frozen=True, eq=False)
class _Placed:
    """A curve, its place along the outline, and how far it was found from the exact one."""

    rank: float
    curve: Curve
    deviation_mm: float


def contour_of(gear: ToothedGear, tolerance_mm: float) -> Contour:
    """A gear's outline as curves within ``tolerance_mm`` of the exact ones, counter-clockwise or not.

    Raises RuntimeError, a fault of ncgear, where a curve cannot be followed so, or does not begin where the last ends.
    """
    stretches = exact_curves(gear.tips, gear.sides)
    placed = [one for stretch in stretches for one in _placed(stretch, tolerance_mm)]
    ordered = sorted(placed, key=lambda one: one.rank)
    curves = [one.curve for one in ordered]
    whole = _bridged(curves) if gear.flanks.equivalent else curves
    return Contour(_joined(whole), max(one.deviation_mm for one in ordered))


def _placed(stretch: Stretch, tolerance: float) -> list[_Placed]:
    """Every curve of a stretch that is long enough."""
    probes = stretch.at(np.arange(stretch.owner.size)[:, None], LOOKED_AT)[0]
    rows = np.nonzero(np.linalg.norm(np.diff(probes, axis=1), axis=2).sum(axis=1) > SHORTEST_MM)[0]
    plain = {int(row): one for row in rows if (one := _plain(probes[row], float(stretch.rank[row])))}
    return [*plain.values(), *_splines(stretch, np.setdiff1d(rows, list(plain)), tolerance)]


def _plain(points: Array, rank: float) -> _Placed | None:
    """The line or arc that a curve's points (n, 2) lie on; None where they lie on neither."""
    found = line_or_arc(points, SAME_MM)
    return found and _Placed(rank, *found)


def _splines(stretch: Stretch, rows: IndexArray, tolerance: float) -> list[_Placed]:
    return [
        _Placed(float(stretch.rank[row]), Spline(group.knots, poles), float(deviation))
        for group in fitted_splines(stretch, rows, tolerance)
        for row, poles, deviation in zip(group.row, group.poles_mm, group.deviation_mm, strict=True)
    ]


def _bridged(curves: list[Curve]) -> list[Curve]:
    """The curves with lines where they leave gaps, as outlines have chords: those of equivalent gears, whose flanks are
    of other circles than the lands between them."""
    pairs = zip(curves, [*curves[1:], curves[0]], strict=True)
    return [part for one, after in pairs for part in (one, *_bridge(one.end, after.start))]


def _bridge(end: Array, start: Array) -> list[Curve]:
    return [Line(end, start)] if np.linalg.norm(start - end) > SHORTEST_MM else []


def _joined(curves: list[Curve]) -> tuple[Curve, ...]:
    """The curves with the end of each at the very beginning of the next."""
    return tuple(_ending(one, after.start) for one, after in zip(curves, [*curves[1:], curves[0]], strict=True))


def _ending(curve: Curve, end: Array) -> Curve:
    """The curve with its end moved by a rounding error, or by as much as a curve that was left out."""
    gap = float(np.linalg.norm(curve.end - end))
    if not gap <= 2.0 * SHORTEST_MM:
        raise RuntimeError(f"two curves of an outline are {gap:.3g} mm apart where they should meet")
    if isinstance(curve, Spline):
        return replace(curve, poles_mm=np.vstack([curve.poles_mm[:-1], end]))
    return replace(curve, end=end)
