"""A train of gears as an SVG element of the page, and the data by which ``scene.js`` moves it.

All parts move like the links of a mechanism: by tables of place and angle over the driving angle.
"""

from __future__ import annotations

from collections.abc import Iterator
from math import pi
from typing import Any

import numpy as np

from ncgear.drawings.page.scene_svg import closed_path, grid_mm
from ncgear.drawings.scene.standing import simplified
from ncgear.numerics.arrays import Array
from ncgear.trains.train import Part, Poses, Train

STEPS = 240
"""Steps of the tables over a cycle: a waving angle is within 1e-5 rad."""

TOLERANCE = 3e-4
"""Tolerance of outlines as a share of the picture's size: a third of a pixel."""

CIRCLE = np.exp(1j * np.linspace(0.0, 2.0 * pi, 90, endpoint=False))

MARGIN = 0.04
"""Margin of the picture, as a share of its larger side."""

KINDS = ("driving", "driven", "slider")
"""The looks of gears that mesh with each other, by the tint of each; bars look like cranks."""


def train_scene(train: Train) -> dict[str, Any]:
    """``svg``, the element with no part turned, and ``data`` that move it; angles in rad, lengths in mm."""
    driving = np.linspace(0.0, train.cycle_rad, STEPS + 1)
    poses = train.poses_at(driving)
    left, bottom, width, height = box_mm(train, poses)
    tolerance = TOLERANCE * max(width, height)
    shown = sorted(enumerate(train.parts), key=lambda one: one[1].low_mm)
    parts = "".join(_part(train, part, number, tolerance) for number, part in shown)
    svg = (
        f'<svg class="scene" viewBox="{left:.6g} {-bottom - height:.6g} {width:.6g} {height:.6g}" tabindex="0" '
        f'role="img" aria-label="the train"><g class="world" transform="scale(1 -1)">{parts}'
        f"{''.join(_traces(train, driving, tolerance))}</g></svg>"
    )
    even = {"period": train.cycle_rad, "rise": train.cycle_rad, "at": [0.0, train.cycle_rad], "slope": [1.0, 1.0]}
    links = {
        f"part-{number}": {
            "x": _table(driving, poses.x_mm[number]),
            "y": _table(driving, poses.y_mm[number]),
            "angle": _table(driving, poses.angle_rad[number]),
        }
        for number, _ in shown
    }
    data = {
        "loop": train.cycle_rad,
        "shafts": [{**even, "value": even["at"]}],
        "gears": [],
        "pairs": [],
        "linkage": {"links": links, "pins": {}},
        "chamber": None,
        "views": {"machine": [left, bottom, width, height]},
    }
    return {"svg": svg, "data": data, "gears": False}


def box_mm(train: Train, poses: Poses) -> tuple[float, float, float, float]:
    """Left, bottom, width and height of the upright rectangle, with a margin, in which all parts stay."""
    lows, highs = [], []
    for number, part in enumerate(train.parts):
        axis, turn = poses.places(number)
        if part.teeth:
            # What turns on the spot fills its circle.
            around = np.unique(axis.round(6))[:, None] + part.reach_mm * CIRCLE
        else:
            around = axis[:, None] + turn[:, None] * (part.outline_mm @ np.array([1.0, 1.0j]))
        lows.append([around.real.min(), around.imag.min()])
        highs.append([around.real.max(), around.imag.max()])
    low, high = np.min(lows, axis=0), np.max(highs, axis=0)
    margin = MARGIN * float((high - low).max())
    width, height = (high - low + 2.0 * margin).tolist()
    return float(low[0]) - margin, float(low[1]) - margin, width, height


def _part(train: Train, part: Part, number: int, tolerance_mm: float) -> str:
    """A part's group in its own frame; the outline of a ring is its hole."""
    contours = [part.outline_mm]
    if part.rim_mm is not None:
        contours.append(_circle(0j, part.reach_mm))
    if part.bore_mm is not None:
        contours.append(_circle(0j, part.bore_mm / 2.0))
    contours += [_circle(hole.x_mm + 1j * hole.y_mm, hole.diameter_mm / 2.0) for hole in part.holes]
    grid = grid_mm(tolerance_mm)
    path = closed_path(simplified(contours, tolerance_mm), grid)
    kind = KINDS[train.tint(part) % len(KINDS)] if part.teeth else "crank"
    return (
        f'<g id="scene-part-{number}" class="body {kind}"><title>{part.name.replace("_", " ")}</title>'
        f'<g transform="scale({grid:g})"><path class="outline" d="{path}"/></g><path class="shaft" d="M0 0h0"/></g>'
    )


def _circle(center: complex, radius_mm: float) -> Array:
    points = center + radius_mm * CIRCLE
    return np.stack([points.real, points.imag], axis=-1)


def _traces(train: Train, driving_rad: Array, tolerance_mm: float) -> Iterator[str]:
    """The paths of followed points, and the points wished for them."""
    grid = grid_mm(tolerance_mm)
    for trace in train.traces:
        path = closed_path([train.trace_mm(trace, driving_rad)[:-1]], grid)
        yield f'<g transform="scale({grid:g})"><path class="trace" d="{path}"/></g>'
        for x, y in trace.wished_mm.tolist():
            yield f'<circle class="pin" cx="{x:.6g}" cy="{y:.6g}" r="{3.0 * tolerance_mm / TOLERANCE / 1000.0:.4g}"/>'


def _table(driving_rad: Array, values: Array) -> dict[str, Any]:
    """A table for Hermite's cubics over a cycle; what stands still needs only both ends."""
    slopes = np.gradient(values, driving_rad, edge_order=2)
    rows = slice(None) if np.ptp(values) > 0.0 else slice(None, None, len(values) - 1)
    return {
        "period": float(driving_rad[-1]),
        "rise": float(values[-1] - values[0]),
        "at": driving_rad[rows].tolist(),
        "value": np.round(values[rows], 6).tolist(),
        "slope": np.round(slopes[rows], 6).tolist(),
    }
