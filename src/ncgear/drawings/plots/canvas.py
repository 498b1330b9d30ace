"""Parts that all pictures share: figures without global state, colours, font sizes, axes, filled outlines, PNG."""

from __future__ import annotations

from collections.abc import Sequence
from io import BytesIO
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.cm import ScalarMappable
from matplotlib.colorbar import Colorbar
from matplotlib.colors import Colormap, Normalize, to_rgba
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import PathPatch, Polygon
from matplotlib.path import Path
from matplotlib.text import Annotation
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter
from PIL import Image

from ncgear.drawings.palette import LIGHT
from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array
from ncgear.numerics.plane import signed_area

DPI = 110

DRIVING, DRIVEN, HIGHLIGHT, MATERIAL = (LIGHT[name] for name in ("driving", "driven", "highlight", "material"))
REFERENCE, INK, GRID, JOINT, PAPER = (LIGHT[name] for name in ("uniform", "ink", "grid", "joint", "panel"))

FILL = 0.16
"""Opacity of areas, small enough to show where two areas overlap."""

SMALL = 8.0
NORMAL = 9.5
LARGE = 12.0
"""Font sizes in points."""

Style = dict[str, Any]
"""Keyword arguments of a drawing function of matplotlib."""

Box = tuple[float, float, float, float]
"""Left, bottom, width and height."""

EDGE_IN = 0.12
"""Distance in inches of a heading from the figure's edges."""


@dataclass(frozen=True)
class Margins:
    """Space around the axes in inches, which is the same in figures of every size."""

    left: float = 0.85
    right: float = 0.15
    bottom: float = 0.6
    top: float = 0.68

    def shares(self, width_in: float, height_in: float) -> dict[str, float]:
        """The margins as shares of a figure, which matplotlib needs."""
        return {
            "left": self.left / width_in,
            "right": 1.0 - self.right / width_in,
            "bottom": self.bottom / height_in,
            "top": 1.0 - self.top / height_in,
        }


def figure(width_in: float, height_in: float, title: str, margins: Margins | None = None, **gaps: float) -> Figure:
    """An empty figure of a size in inches, for Agg, with a heading at the left; its axes get margins and gaps."""
    made = Figure(figsize=(width_in, height_in), dpi=DPI, facecolor=PAPER)
    FigureCanvasAgg(made)
    x, y = EDGE_IN / width_in, 1.0 - EDGE_IN / height_in
    # The name of a design may contain dollar signs, which are not formulas.
    made.text(x, y, title, size=LARGE, weight="bold", color=INK, ha="left", va="top", parse_math=False)
    if margins is not None:
        made.subplots_adjust(**margins.shares(width_in, height_in), **gaps)
    return made


PACKED = 3
"""Compression level of zlib: a third less time than its usual 6, for files a twelfth larger."""


def png(made: Figure) -> bytes:
    """The figure as PNG: red, green and blue of each pixel, since no picture is transparent."""
    # Matplotlib has no types for the canvas of Agg and its buffers.
    canvas: Any = made.canvas
    canvas.draw()
    data = BytesIO()
    pixels = Image.fromarray(np.asarray(canvas.buffer_rgba())).convert("RGB")
    pixels.save(data, "png", dpi=(made.dpi, made.dpi), compress_level=PACKED)
    return data.getvalue()


def dress(axes: Axes, x_label: str, y_label: str) -> None:
    """Put labels, a faint grid, and no frame on sides without a scale."""
    axes.set_xlabel(x_label, size=NORMAL, color=INK)
    axes.set_ylabel(y_label, size=NORMAL, color=INK)
    axes.tick_params(labelsize=SMALL, colors=INK, length=3.0)
    axes.grid(True, color=GRID, linewidth=0.7)
    axes.set_axisbelow(True)
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)
    for side in ("left", "bottom"):
        axes.spines[side].set_color(REFERENCE)


def look_at(axes: Axes, box: Box) -> float:
    """Show a box of the drawing at equal scales, without numbers; returns the size of a pixel in the drawing."""
    left, bottom, width, height = box
    axes.set_xlim(left, left + width)
    axes.set_ylim(bottom, bottom + height)
    axes.set_aspect("equal")
    axes.set_axis_off()
    axes.apply_aspect()
    return width / axes.bbox.width


def color_bar(made: Figure, norm: Normalize, scale: Colormap, box: Box, label: str, **ends: Any) -> Colorbar:
    """A level scale of colours in a box of a figure, in shares of it, with a label below."""
    bar = made.colorbar(ScalarMappable(norm, scale), cax=made.add_axes(box), orientation="horizontal", **ends)
    bar.ax.tick_params(labelsize=SMALL, colors=INK)
    bar.set_label(label, size=NORMAL, color=INK)
    return bar


def number(axes: Axes, place: Array, text: str, **style: Any) -> None:
    """A small number with its middle at a place, shape (2,)."""
    axes.text(float(place[0]), float(place[1]), text, size=SMALL - 1.0, color=INK, ha="center", va="center", **style)


def plain_log(axis: Axis, steps: tuple[float, ...]) -> None:
    """Put plain numbers at these steps of each power of ten on a logarithmic scale."""
    axis.set_major_locator(LogLocator(subs=steps))
    axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axis.set_minor_formatter(NullFormatter())


def legend_above(axes: Axes, in_a_line: int | None = None) -> None:
    """Put the legend in one line above the axes, at their right end, or in lines with a number of entries."""
    entries = in_a_line or len(axes.get_legend_handles_labels()[1])
    axes.legend(
        loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=entries, frameon=False, fontsize=SMALL, borderaxespad=0.1
    )


def area(axes: Axes, points: Array, color: str, line_width: float, label: str = "") -> None:
    """Draw a closed outline (shape (n, 2)) with a faint filling; does not set the limits of the axes."""
    patch = Polygon(points, facecolor=to_rgba(color, FILL), edgecolor=color, linewidth=line_width, label=label)
    # add_patch would compute the limits of every edge like those of a curve: half a second for two gears.
    axes.add_artist(patch)


def ring_area(
    axes: Axes, hole: Array, center: tuple[float, float], radius: float, color: str, line_width: float, label: str = ""
) -> None:
    """Draw the area between a circle and a closed outline within it (shape (n, 2)), with a faint filling."""
    # Agg fills by winding: the outline is a hole if it runs opposite to the circle.
    clockwise = hole if signed_area(hole) < 0.0 else hole[::-1]
    inner = Path(np.vstack([clockwise, clockwise[:1]]), closed=True)
    path = Path.make_compound_path(Path.circle(center, radius), inner)
    style: Style = {"facecolor": to_rgba(color, FILL), "edgecolor": color, "linewidth": line_width, "label": label}
    axes.add_artist(PathPatch(path, **style))


NotePlace = tuple[str, float, float]
"""Alignment of a note with its point, and the distances in points from the point along the axis and upwards."""

CLEAR_PX = 2.0
"""Least distance in pixels of a note from a curve."""


def place_note(axes: Axes, note: Annotation, places: Sequence[NotePlace], curves: Sequence[Line2D]) -> None:
    """Put a note at the first place inside the axes that is clear of curves, else where it covers the fewest.

    The axes must have the limits of the finished picture.
    """
    paths = [curve.get_transform().transform_path(curve.get_path()) for curve in curves]

    def faults(place: NotePlace) -> tuple[bool, int]:
        _put(note, place)
        box, frame = note.get_window_extent(), axes.get_window_extent()
        inside = frame.x0 <= box.x0 and box.x1 <= frame.x1 and frame.y0 <= box.y0 and box.y1 <= frame.y1
        around = box.padded(CLEAR_PX)
        return not inside, sum(path.intersects_bbox(around, filled=False) for path in paths)

    _put(note, min(places, key=faults))


def _put(note: Annotation, place: NotePlace) -> None:
    across, along, upwards = place
    note.set(ha=across, va="center" if upwards == 0.0 else "bottom" if upwards > 0.0 else "top")
    note.xyann = along, upwards
