"""The stress in both gears by finite elements, each tooth at its own worst place of contact."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from matplotlib.cm import ScalarMappable
from matplotlib.collections import PolyCollection
from matplotlib.colors import LinearSegmentedColormap, Normalize

from ncgear.drawings.palette import STRESS
from ncgear.drawings.plots.assembled_pair import Position, assembled_teeth, turned
from ncgear.drawings.plots.canvas import INK, NORMAL, REFERENCE, SMALL, area, figure, png, ring_area
from ncgear.drawings.plots.coloured_teeth import REST_IN, SIZE_IN
from ncgear.numerics.plane import as_points
from ncgear.pitch.shape import Gear
from ncgear.project.drive import Drive
from ncgear.strength.elements.teeth import Painted

SCALE = LinearSegmentedColormap.from_list("stress", STRESS)


def stress_field_png(
    drive: Drive, fields: Mapping[Gear, Painted], largest_mpa: float, position: Position, title: str
) -> bytes:
    """Both gears in a position, coloured by von Mises' stress up to ``largest_mpa``."""
    pair = assembled_teeth(drive)
    left, right, top = pair.frame
    width, most = SIZE_IN
    height = min(most, REST_IN + width * 2.0 * top / (right - left))
    made = figure(width, height, title)
    axes = made.add_axes((0.0, 1.05 / height, 1.0, 1.0 - REST_IN / height))
    norm = Normalize(0.0, largest_mpa)
    for gear, field in fields.items():
        driven = gear is Gear.DRIVEN
        ring = pair.ring_radius_mm if driven else None
        center = np.array([pair.center_distance_mm, 0.0]) if driven else np.zeros(2)
        angle = position.phi2_rad * (1.0 if ring is not None else -1.0) if driven else position.phi1_rad
        outline = turned(drive.teeth.of(gear).outline_mm, angle) + center
        if ring is None:
            area(axes, outline, REFERENCE, 0.3)
        else:
            ring_area(axes, outline, (float(center[0]), 0.0), ring, REFERENCE, 0.3)
        place = turned(as_points(field.place_mm), angle) + center
        colors = SCALE(norm(field.von_mises_mpa[field.triangles].mean(axis=1)))
        axes.add_collection(
            PolyCollection(list(place[field.triangles]), facecolors=colors, edgecolors=colors, linewidths=0.2),
            autolim=False,
        )
    axes.plot([0.0, pair.center_distance_mm], [0.0, 0.0], "+", color=INK, markersize=9)
    axes.set_xlim(left, right)
    axes.set_ylim(-top, top)
    axes.set_aspect("equal")
    axes.set_axis_off()
    bar = made.colorbar(
        ScalarMappable(norm, SCALE),
        cax=made.add_axes((0.2, 0.62 / height, 0.6, 0.16 / height)),
        orientation="horizontal",
        extend="max",
    )
    bar.ax.tick_params(labelsize=SMALL, colors=INK)
    bar.set_label("von Mises' stress in MPa, each tooth alone at its worst place of contact", size=NORMAL, color=INK)
    return png(made)
