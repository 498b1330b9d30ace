"""Pictures of the assembled gears: their pitch curves at phi1 = 0, and their tooth outlines at any driving angle."""

from __future__ import annotations

from collections.abc import Sequence
from math import degrees

import numpy as np
from matplotlib.axes import Axes

from ncgear.drawings.assembled import Assembled, AssembledPosition
from ncgear.drawings.charts import drawer
from ncgear.drawings.charts.chart import Chart
from ncgear.drawings.plots import canvas
from ncgear.figures.numbers import drawn, rounded
from ncgear.numerics.arrays import Array, Mask
from ncgear.pitch.shape import Gear

PANEL_IN = 3.6
"""Width in inches of one position's views."""

ZOOM_IN_MODULES = 4.5
"""Half the width of the view on the mesh."""

LINE_OF_CENTRES = (0, (8, 2, 1, 2))
"""Dashes and dots."""


def pitch_curves_png(pair: Assembled, concave: tuple[Mask, Mask], title: str) -> bytes:
    """Both pitch curves assembled at phi1 = 0; see ``draw_pitch_curves``."""
    width, height = np.ptp(pair.reach, axis=0)
    # At least as tall as the scale needs, and never taller than a screen.
    size = 8.2, float(np.clip(7.2 * height / width, 2.8, 7.0)) + 1.5
    made = canvas.figure(*size, title)
    draw_pitch_curves(made.subplots(gridspec_kw=canvas.Margins().shares(*size)), pair, concave)
    return canvas.png(made)


def draw_pitch_curves(axes: Axes, pair: Assembled, concave: tuple[Mask, Mask]) -> None:
    """Both pitch curves at phi1 = 0, with their points in the masks ``concave`` (shape (n,) each) highlighted."""
    centers = [0.0, pair.center_distance_mm]
    curves = pair.driving_mm, pair.driven_mm + np.array([pair.center_distance_mm, 0.0])
    for gear, curve, color in zip(Gear, curves, (canvas.DRIVING, canvas.DRIVEN), strict=True):
        draw_body(axes, pair, gear, curve, color, 1.8, f"{gear.value} gear")
    driving, driven = (np.where(mask[:, None], curve, np.nan) for curve, mask in zip(curves, concave, strict=True))
    # A single line with a gap between the gears, so that the legend names it once.
    highlighted = np.vstack([driving, np.full((1, 2), np.nan), driven])
    if np.isfinite(highlighted).any():
        axes.plot(*highlighted.T, color=canvas.HIGHLIGHT, linewidth=4.0, label="concave", solid_capstyle="butt")
    axes.plot(centers, [0.0, 0.0], color=canvas.INK, linewidth=0.8, linestyle=LINE_OF_CENTRES)
    axes.plot(centers, [0.0, 0.0], "+", color=canvas.INK, markersize=11, markeredgewidth=1.3)
    _name_below(axes, "driving axis", 0.0, canvas.INK)
    _name_below(axes, "driven axis", pair.center_distance_mm, canvas.INK)
    canvas.dress(axes, "x in mm", "y in mm")
    axes.update_datalim(pair.reach)
    axes.set_aspect("equal", adjustable="datalim")
    axes.autoscale_view()
    canvas.legend_above(axes)


def teeth_png(pair: Assembled, module_mm: float, positions: Sequence[AssembledPosition], title: str) -> bytes:
    """Tooth outlines assembled in each position: whole above, mesh below."""
    left, right, top = pair.frame
    rows_in = PANEL_IN * (2.0 * top / (right - left)), PANEL_IN * 0.95
    margins = canvas.Margins(left=0.7, top=0.65)
    size = PANEL_IN * len(positions) + 0.85, sum(rows_in) + 1.5
    made = canvas.figure(*size, title)
    spaces = {"hspace": 0.12, "wspace": 0.14, "height_ratios": rows_in}
    views = made.subplots(2, len(positions), squeeze=False, gridspec_kw={**margins.shares(*size), **spaces})
    for (whole, mesh), position in zip(views.T, positions, strict=True):
        draw_whole(whole, pair, position)
        draw_mesh(mesh, pair, ZOOM_IN_MODULES * module_mm, position)
    _name_below(views[0, 0], "driving", 0.0, canvas.DRIVING)
    _name_below(views[0, 0], "driven", pair.center_distance_mm, canvas.DRIVEN)
    views[1, 0].set_ylabel("y in mm", size=canvas.SMALL, color=canvas.INK)
    return canvas.png(made)


def draw_whole(axes: Axes, pair: Assembled, position: AssembledPosition) -> None:
    """Both gears, in a view that is the same for all positions."""
    _draw_turned(axes, pair, position, 0.5)
    axes.plot([0.0, pair.center_distance_mm], [0.0, 0.0], "+", color=canvas.INK, markersize=8)
    left, right, top = pair.frame
    canvas.look_at(axes, (left, -top, right - left, 2.0 * top))
    phi1, phi2 = (drawn(rounded(degrees(angle), 1), "deg") for angle in (position.phi1_rad, position.phi2_rad))
    axes.set_title(f"phi1 = {phi1}\u00b0, phi2 = {phi2}\u00b0", size=canvas.SMALL + 1.0, color=canvas.INK, y=1.0)


def draw_mesh(axes: Axes, pair: Assembled, half_mm: float, position: AssembledPosition) -> None:
    """The surroundings of the pitch point, ``half_mm`` to each side."""
    point = position.pitch_point_mm
    _draw_turned(axes, pair, position, 1.2)
    axes.axhline(0.0, color=canvas.REFERENCE, linewidth=0.7, linestyle=LINE_OF_CENTRES)
    axes.plot(point, 0.0, "o", color=canvas.INK, markersize=3.5)
    canvas.dress(axes, "x in mm (dot: pitch point)", "")
    axes.xaxis.label.set_fontsize(canvas.SMALL)
    axes.locator_params(nbins=6)
    axes.set_xlim(point - half_mm, point + half_mm)
    axes.set_ylim(-half_mm, half_mm)
    axes.set_aspect("equal")


def _draw_turned(axes: Axes, pair: Assembled, position: AssembledPosition, line_width: float) -> None:
    for gear, curve, color in (
        (Gear.DRIVING, pair.driving_mm, canvas.DRIVING),
        (Gear.DRIVEN, pair.driven_mm, canvas.DRIVEN),
    ):
        draw_body(axes, pair, gear, pair.placed(gear, curve, position), color, line_width)


def draw_body(
    axes: Axes, pair: Assembled, gear: Gear, placed_mm: Array, color: str, line_width: float, label: str = ""
) -> None:
    """A gear by its curve in place, shape (n, 2), with the outer circle of a ring."""
    if gear is Gear.DRIVING or pair.ring_radius_mm is None:
        canvas.area(axes, placed_mm, color, line_width, label)
    else:
        canvas.ring_area(axes, placed_mm, (pair.center_distance_mm, 0.0), pair.ring_radius_mm, color, line_width, label)


def _name_below(axes: Axes, text: str, x: float, color: str) -> None:
    """A name below a point of the line of centres."""
    axes.annotate(
        text,
        (x, 0.0),
        xytext=(0, -9),
        textcoords="offset points",
        ha="center",
        va="top",
        size=canvas.SMALL,
        color=color,
    )


def motion_drawn(charts: Sequence[Chart], title: str) -> dict[str, bytes]:
    """The picture of the machine's motion, by its file name; ``drawings.pictures`` makes the charts."""
    return {"motion.png": drawer.column_png(charts, title, drawer.MOTION_LOOK, drawer.MOTION_COLUMN)}


def gears_drawn(
    pair: str,
    pitch_curves: tuple[Assembled, tuple[Mask, Mask]],
    teeth: Assembled,
    module_mm: float,
    positions: Sequence[AssembledPosition],
) -> dict[str, bytes]:
    """The pictures of the pitch curves and of the teeth."""
    return {
        "pitch_curves.png": pitch_curves_png(*pitch_curves, f"{pair}: pitch curves at phi1 = 0"),
        "tooth_pair.png": teeth_png(teeth, module_mm, positions, f"{pair}: tooth outlines in mesh"),
    }


def load_drawn(
    pair: str, contact: Sequence[Chart], load: Sequence[tuple[Chart, Chart]], load_title: str
) -> dict[str, bytes]:
    """The pictures of contact and load."""
    return {
        "contact.png": drawer.column_png(
            contact, f"{pair}: contact of the teeth", drawer.CONTACT_LOOK, drawer.CONTACT_COLUMN
        ),
        "power.png": drawer.beside_png(load, load_title),
    }
