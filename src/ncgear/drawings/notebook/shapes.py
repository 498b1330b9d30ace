"""Pitch curves and teeth in a notebook: closed outlines of a pair of gears in mm, assembled at phi1 = 0."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from markupsafe import Markup

from ncgear.drawings.notebook.frame import NOTHING
from ncgear.drawings.page.scene_svg import closed_path, grid_mm
from ncgear.numerics.arrays import Array
from ncgear.pitch.pair import PitchPair
from ncgear.pitch.shape import Gear
from ncgear.teeth.gear import ToothedGear, ToothedPair

CURVE_POINTS = 721
"""Points of a pitch curve: one every half degree."""

FINENESS = 2e-4
"""Tolerance of a drawn outline as a share of the picture's size: a tenth of a pixel."""

ROOM = 1.04
"""Size of the picture divided by that of what is on it."""


class Outline(NamedTuple):
    """A closed outline in mm, shape (n, 2), in the frame of its gear, and the place of the gear's axis."""

    gear: Gear
    points_mm: Array
    axis_mm: float


def pitch_outlines(pitch: PitchPair) -> list[Outline]:
    """Both pitch curves; those of gears that turn less than once are closed by straight sides to the axis."""
    outlines = []
    for gear, axis in zip(Gear, (0.0, pitch.center_distance_mm), strict=True):
        points = pitch.of(gear).drawn(CURVE_POINTS).position
        closed = points if pitch.toothed is None else np.vstack([points, np.zeros((1, 2))])
        outlines.append(Outline(gear, closed, axis))
    return outlines


def tooth_outlines(teeth: ToothedPair) -> list[Outline]:
    """Both tooth outlines in mesh."""
    distance = teeth.driving.flanks.curve.center_distance_mm
    return [Outline(gear, teeth.of(gear).outline_mm, axis) for gear, axis in zip(Gear, (0.0, distance), strict=True)]


def tooth_outline(gear: ToothedGear) -> Outline:
    """One gear by itself."""
    return Outline(gear.flanks.curve.gear, gear.outline_mm, 0.0)


def picture(outlines: Sequence[Outline], name: str) -> Markup:
    """The outlines to one scale, with their axes; the name is what a screen reader says."""
    corners = np.vstack([outline.points_mm + np.array([outline.axis_mm, 0.0]) for outline in outlines])
    low, high = corners.min(axis=0), corners.max(axis=0)
    size, middle = ROOM * (high - low), (low + high) / 2.0
    box = f"{middle[0] - size[0] / 2.0:.6g} {-middle[1] - size[1] / 2.0:.6g} {size[0]:.6g} {size[1]:.6g}"
    grid = grid_mm(FINENESS * float(size.max()))
    # A ring goes behind the gear within it.
    drawn = sorted(outlines, key=lambda outline: -float(np.ptp(outline.points_mm[:, 0])))
    shapes = NOTHING.join(_shape(outline, grid) for outline in drawn)
    return Markup(
        '<figure class="shape"><svg viewBox="{}" role="img" aria-label="{}"><g transform="scale(1 -1)">{}</g></svg>'
        "</figure>"
    ).format(box, name, shapes)


def _shape(outline: Outline, grid: float) -> Markup:
    color = outline.gear.value
    return Markup(
        '<g transform="translate({0:.6g} 0)"><path transform="scale({1:.6g})" d="{2}" fill="var(--{3})" '
        'fill-opacity="0.22" stroke="var(--{3})" stroke-width="1.4"/>'
        '<path d="M0 0h0" stroke="var(--ink)" stroke-width="7" stroke-linecap="round"/></g>'
    ).format(outline.axis_mm, grid, closed_path([outline.points_mm], grid), color)
