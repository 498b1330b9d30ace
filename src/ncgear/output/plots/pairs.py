"""The two gears assembled: pitch curves at phi1 = 0, tooth outlines in several positions."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import degrees

import numpy as np
from matplotlib.axes import Axes

from ncgear.numerics.arrays import Array, Mask
from ncgear.output.plots.canvas import (
    DRIVEN,
    DRIVING,
    HIGHLIGHT,
    INK,
    REFERENCE,
    SMALL,
    Margins,
    area,
    dress,
    figure,
    key_above,
    png,
    ring_area,
)

PANEL_IN = 3.6
"""Width in inches of one position's views."""

ZOOM_IN_MODULES = 4.5
"""Half the width of the view on the mesh."""

SLACK = 1.03
"""Frame of the whole view relative to the gears' reach."""


@dataclass(frozen=True)
class Position:
    """Angles of both gears and the pitch point's place on the line of centres, 0 being the driving axis."""

    phi1_rad: float
    phi2_rad: float
    pitch_point_mm: float


@dataclass(frozen=True, eq=False)
class _Pair:
    """Both outlines in their own frames; a driven ring lies between its outline and a circle of ``ring_radius``."""

    driving: Array
    driven: Array
    center_distance: float
    ring_radius: float | None

    @property
    def frame(self) -> tuple[float, float, float]:
        """Least and largest x and the largest y that the gears reach in any position."""
        driving = float(np.hypot(*self.driving.T).max()) * SLACK
        driven = (self.ring_radius or float(np.hypot(*self.driven.T).max())) * SLACK
        left, right = min(-driving, self.center_distance - driven), max(driving, self.center_distance + driven)
        return left, right, max(driving, driven)

    def draw(self, axes: Axes, position: Position, line_width: float) -> None:
        """Both gears in a position."""
        area(axes, turned(self.driving, position.phi1_rad), DRIVING, line_width)
        sense = -1.0 if self.ring_radius is None else 1.0
        driven = turned(self.driven, sense * position.phi2_rad)
        _driven_area(axes, driven, self.center_distance, self.ring_radius, line_width)


def pitch_curves(
    driving_mm: Array,
    driven_mm: Array,
    center_distance_mm: float,
    driving_concave: Mask | None = None,
    driven_concave: Mask | None = None,
    title: str = "Pitch curves at phi1 = 0",
    *,
    ring_radius_mm: float | None = None,
) -> bytes:
    """Both closed pitch curves, each in its own frame (mm, shape (n, 2)), assembled at phi1 = 0.

    Concave stretches are highlighted where masks (shape (n,)) are given.  ``ring_radius_mm`` is the outer radius of a
    driven ring, None for an external pair.
    """
    shifted = driven_mm + np.array([center_distance_mm, 0.0])
    both = np.vstack([driving_mm, shifted, *_box(center_distance_mm, ring_radius_mm)])
    size = _size(both)
    made = figure(*size, title)
    axes = made.subplots(gridspec_kw=Margins().shares(*size))
    area(axes, driving_mm, DRIVING, 1.8, "driving gear")
    _driven_area(axes, driven_mm, center_distance_mm, ring_radius_mm, 1.8, "driven gear")
    _concave(axes, [(driving_mm, driving_concave), (shifted, driven_concave)])
    _axes_of_rotation(axes, center_distance_mm)
    dress(axes, "x in mm", "y in mm")
    axes.update_datalim(both)
    axes.set_aspect("equal", adjustable="datalim")
    axes.autoscale_view()
    key_above(axes)
    return png(made)


def tooth_pair(
    driving_mm: Array,
    driven_mm: Array,
    center_distance_mm: float,
    module_mm: float,
    positions: Sequence[Position],
    title: str = "Tooth outlines in mesh",
    *,
    ring_radius_mm: float | None = None,
) -> bytes:
    """Tooth outlines, each in its own frame (mm, shape (n, 2)), assembled in each position: whole above, mesh below.

    The driving gear is turned by +phi1, the driven one by -phi2 about its own axis; a driven ring, which has an outer
    radius, by +phi2.
    """
    pair = _Pair(driving_mm, driven_mm, center_distance_mm, ring_radius_mm)
    rows_in = PANEL_IN * _whole_height(pair), PANEL_IN * 0.95
    margins = Margins(left=0.7, top=0.65)
    size = PANEL_IN * len(positions) + 0.85, sum(rows_in) + 1.5
    made = figure(*size, title)
    spaces = {"hspace": 0.12, "wspace": 0.14, "height_ratios": rows_in}
    views = made.subplots(2, len(positions), squeeze=False, gridspec_kw={**margins.shares(*size), **spaces})
    for (whole, mesh), position in zip(views.T, positions, strict=True):
        _whole(whole, pair, position)
        _mesh(mesh, pair, ZOOM_IN_MODULES * module_mm, position)
    _names(views[0, 0], pair)
    views[1, 0].set_ylabel("y in mm", size=SMALL, color=INK)
    return png(made)


def turned(points_mm: Array, angle_rad: float) -> Array:
    """Points (shape (n, 2)) turned counter-clockwise about the origin."""
    cosine, sine = np.cos(angle_rad), np.sin(angle_rad)
    result: Array = points_mm @ np.array([[cosine, sine], [-sine, cosine]])
    return result


def _size(points: Array) -> tuple[float, float]:
    """Inches for a drawing of these points: wide enough for the scale, never taller than a screen."""
    width, height = np.ptp(points, axis=0)
    return 8.2, float(np.clip(7.2 * height / width, 2.8, 7.0)) + 1.5


def _concave(axes: Axes, curves: Sequence[tuple[Array, Mask | None]]) -> None:
    """Draw over the concave stretches, if any."""
    drawn = [np.where(mask[:, None], points, np.nan) for points, mask in curves if mask is not None]
    # One line with a gap between the gears, so that the key names it once.
    joined = np.vstack([np.full((1, 2), np.nan), *(part for points in drawn for part in (points, [[np.nan, np.nan]]))])
    if np.isfinite(joined).any():
        axes.plot(*joined.T, color=HIGHLIGHT, linewidth=4.0, label="concave", solid_capstyle="butt")


def _driven_area(
    axes: Axes, points: Array, center_distance: float, ring_radius: float | None, line_width: float, label: str = ""
) -> None:
    """The driven gear at its axis, a ring with its circle."""
    shift = np.array([center_distance, 0.0])
    if ring_radius is None:
        area(axes, points + shift, DRIVEN, line_width, label)
    else:
        ring_area(axes, points + shift, (center_distance, 0.0), ring_radius, DRIVEN, line_width, label)


def _box(center_distance: float, ring_radius: float | None) -> list[Array]:
    """Corners of the square around a ring; none where there is no ring."""
    if ring_radius is None:
        return []
    return [np.array([[center_distance - ring_radius, -ring_radius], [center_distance + ring_radius, ring_radius]])]


def _axes_of_rotation(axes: Axes, center_distance: float) -> None:
    """The line of centres and both axes, named."""
    axes.plot([0.0, center_distance], [0.0, 0.0], color=INK, linewidth=0.8, linestyle=(0, (8, 2, 1, 2)))
    axes.plot([0.0, center_distance], [0.0, 0.0], "+", color=INK, markersize=11, markeredgewidth=1.3)
    _label(axes, "driving axis", 0.0, INK)
    _label(axes, "driven axis", center_distance, INK)


def _label(axes: Axes, text: str, x: float, color: str) -> None:
    """A name below a point of the line of centres."""
    axes.annotate(
        text, (x, 0.0), xytext=(0, -9), textcoords="offset points", ha="center", va="top", size=SMALL, color=color
    )


def _names(axes: Axes, pair: _Pair) -> None:
    _label(axes, "driving", 0.0, DRIVING)
    _label(axes, "driven", pair.center_distance, DRIVEN)


def _whole_height(pair: _Pair) -> float:
    """Height of the whole view relative to its width."""
    left, right, top = pair.frame
    return 2.0 * top / (right - left)


def _whole(axes: Axes, pair: _Pair, position: Position) -> None:
    """Both gears, in a frame that is the same for all positions."""
    pair.draw(axes, position, 0.5)
    axes.plot([0.0, pair.center_distance], [0.0, 0.0], "+", color=INK, markersize=8)
    left, right, top = pair.frame
    axes.set_xlim(left, right)
    axes.set_ylim(-top, top)
    axes.set_aspect("equal")
    axes.set_axis_off()
    # Adding zero turns a rounded -0.0 into 0.0.
    phi1, phi2 = (round(degrees(angle), 1) + 0.0 for angle in (position.phi1_rad, position.phi2_rad))
    axes.set_title(f"phi1 = {phi1:g}\u00b0, phi2 = {phi2:g}\u00b0", size=SMALL + 1.0, color=INK)


def _mesh(axes: Axes, pair: _Pair, half: float, position: Position) -> None:
    """The surroundings of the pitch point."""
    point = position.pitch_point_mm
    pair.draw(axes, position, 1.2)
    axes.axhline(0.0, color=REFERENCE, linewidth=0.7, linestyle=(0, (8, 2, 1, 2)))
    axes.plot(point, 0.0, "o", color=INK, markersize=3.5)
    dress(axes, "x in mm (dot: pitch point)", "")
    axes.xaxis.label.set_fontsize(SMALL)
    axes.locator_params(nbins=6)
    axes.set_xlim(point - half, point + half)
    axes.set_ylim(-half, half)
    axes.set_aspect("equal")
