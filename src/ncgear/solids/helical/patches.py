"""Helical tooth sides as B-spline surfaces: every flank, fillet and land of a gear one patch from end to end.

The curves of corresponding pieces of several sections, each in its own parameter, make a grid of points; cubic splines
through it, first along the curves and then up the gear, are a surface.  It is analytic in both parameters where the law
is, so that a few sections are enough.
"""

from __future__ import annotations

import numpy as np
from scipy.interpolate import BSpline, make_interp_spline

from ncgear.errors import Unanswered, WrongInput
from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array, IndexArray
from ncgear.pitch.shape import Gear
from ncgear.solids.helical.sections import Sections
from ncgear.teeth.contour import DEGREE, INSIDE, PROBES, SHORTEST_IN_MODULES
from ncgear.teeth.outline import whole_curves
from ncgear.teeth.stretch import CurveStretch

GRIDS = ((4, 8), (4, 12), (6, 16), (8, 24), (12, 32), (16, 48), (24, 64))
"""Spans up the gear and along each curve, tried in turn; a surface that needs more spans is not smooth."""

REMEDY = "formats stl and 3mf can hold these teeth"


@dataclass(frozen=True, eq=False)
class Patches:
    """Surfaces side by side round a gear, the last beside the first; neighbours share the poles of their common edge.

    ``along`` and ``up`` are the clamped knots of both parameters; ``poles_mm`` has shape (patches, n along, n up, 3).
    ``deviation_mm`` is the largest distance found between points of the surfaces and the exact points.
    """

    along: Array
    up: Array
    poles_mm: Array
    deviation_mm: float


def patches_of(sections: Sections, gear: Gear, tolerance_mm: float) -> Patches:
    """Surfaces within ``tolerance_mm`` of the teeth, from z = 0 up to the height where the advance ends or turns back.

    Raises WrongInput where the teeth do not change smoothly with height.
    """
    deviation = 0.0
    for up, along in GRIDS:
        made = _interpolated(sections, gear, up, along)
        if made.deviation_mm <= tolerance_mm:
            return made
        deviation = made.deviation_mm
    raise _rough(gear, f"surfaces through {GRIDS[-1][0] + 1} sections are still {deviation:.2g} mm off")


def _rough(gear: Gear, why: str) -> WrongInput:
    problem = f"the helical teeth of the {gear.value} gear do not go up smoothly enough for surfaces: {why}; {REMEDY}"
    return WrongInput(problem, key="gears.helix")


def _interpolated(sections: Sections, gear: Gear, up: int, along: int) -> Patches:
    """Surfaces with these numbers of spans, compared with exact sections half way between the interpolated sections."""
    heights, share = np.linspace(0.0, sections.helix.rise_mm, up + 1), np.linspace(0.0, 1.0, along + 1)
    curves = [_curves(sections, gear, float(height)) for height in heights]
    shortest_mm = SHORTEST_IN_MODULES * sections.at(0.0).of(gear).flanks.rack.module_mm
    _require_alike(curves, gear, shortest_mm)
    lengthwise = _lengthwise(curves, heights, share)
    poles = make_interp_spline(heights, lengthwise.c.swapaxes(0, 1), k=DEGREE)
    probes = (np.arange(along)[:, None] + PROBES).ravel() / along
    found = make_interp_spline(heights, lengthwise(probes).swapaxes(0, 1), k=DEGREE)
    middles = [float(height) for height in (heights[1:] + heights[:-1]) / 2.0]
    apart = _apart(found, [(height, _curves(sections, gear, height)) for height in middles], probes)
    # Poles come in the order (up, along, patches, 3).
    return Patches(lengthwise.t, poles.t, _sharing_edges(poles.c.transpose(2, 1, 0, 3), shortest_mm), apart)


def _lengthwise(curves: list[list[CurveStretch]], heights: Array, share: Array) -> BSpline:
    """Splines along all curves of all sections, values of shape (up, patches, 3)."""
    points = np.stack([_points(own, height, share) for own, height in zip(curves, heights, strict=True)])
    slopes = np.stack([_slopes(own) for own in curves])
    ends = ([(1, slopes[:, :, 0])], [(1, slopes[:, :, 1])])
    return make_interp_spline(share, np.moveaxis(points, 2, 0), k=DEGREE, bc_type=ends)


def _apart(found: BSpline, exact: list[tuple[float, list[CurveStretch]]], probes: Array) -> float:
    """Largest distance between points found, shape (probes, patches, 3) at a height, and points of exact sections."""
    return max(
        float(np.linalg.norm(found(height).swapaxes(0, 1) - _points(curves, height, probes), axis=2).max())
        for height, curves in exact
    )


def _curves(sections: Sections, gear: Gear, height: float) -> list[CurveStretch]:
    own = sections.at(height).of(gear)
    return whole_curves(own.tips, own.sides)


def _require_alike(curves: list[list[CurveStretch]], gear: Gear, shortest_mm: float) -> None:
    """Raise WrongInput unless every section has the same curves and no curve vanishes."""
    for stretches in zip(*curves, strict=True):
        if any(not np.array_equal(stretch.owner, stretches[0].owner) for stretch in stretches):
            raise _rough(gear, "some are undercut at one height and not at another")
        points = np.stack([_rows(stretch, np.array([0.0, 1.0]))[0] for stretch in stretches])
        if np.linalg.norm(points[:, :, 1] - points[:, :, 0], axis=2).min() <= shortest_mm:
            raise _rough(gear, "a land vanishes with height")


def _order(curves: list[CurveStretch]) -> IndexArray:
    """Places along the outline of all rows of curves."""
    return np.argsort(np.concatenate([stretch.rank for stretch in curves]), kind="stable")


def _points(curves: list[CurveStretch], height: float, share: Array) -> Array:
    flat = np.concatenate([_rows(stretch, share)[0] for stretch in curves])[_order(curves)]
    return np.concatenate([flat, np.full((*flat.shape[:2], 1), height)], axis=2)


def _slopes(curves: list[CurveStretch]) -> Array:
    """Slopes at both ends of all curves, shape (patches, 2, 3)."""
    flat = np.concatenate([_rows(stretch, INSIDE)[1] for stretch in curves])[_order(curves)]
    return np.concatenate([flat, np.zeros((*flat.shape[:2], 1))], axis=2)


def _rows(stretch: CurveStretch, share: Array) -> tuple[Array, Array]:
    """Points and slopes of a stretch's curves at shares (n,) of their parameters, shape (curves, n, 2) each."""
    return stretch.at(np.arange(stretch.owner.size)[:, None], share)


def _sharing_edges(poles: Array, shortest_mm: float) -> Array:
    """Poles with each patch's last edge replaced by the first edge of the next; they differ by rounding errors."""
    following = np.roll(poles[:, 0], -1, axis=0)
    gap = float(np.abs(poles[:, -1] - following).max())
    if not gap <= shortest_mm:
        raise Unanswered(f"two surfaces of a gear are {gap:.3g} mm apart where they should meet")
    poles = poles.copy()
    poles[:, -1] = following
    return poles
