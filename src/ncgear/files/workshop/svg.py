"""SVG files at 1:1: one user unit is one millimetre, and y points up as in the gear's frame."""

from __future__ import annotations

from collections.abc import Iterator
from math import pi
from xml.etree import ElementTree as Xml

import numpy as np

from ncgear.files.workshop.drawing import (
    Circle,
    Cross,
    Drawing,
    PairDrawings,
    Polyline,
    Shape,
    Use,
    box_around,
    decimals_for,
    written,
)
from ncgear.numerics.arrays import Array

NAMESPACE = "http://www.w3.org/2000/svg"

MARGIN_MM = 2.0
HAIRLINE_MM = 0.1
"""Width of lines: narrow enough for cutters that cut only thin lines, and wide enough for a screen."""

COLORS = {Use.THROUGH: "#000000", Use.PART_WAY: "#0000ff", Use.REFERENCE: "#cc0000"}
"""Colours by which cutters know what to do along a line."""


def svg_files(shown: PairDrawings) -> dict[str, bytes]:
    """``driving.svg`` and ``driven.svg``, each gear in its own frame, by their names."""
    return {f"{drawing.name}.svg": svg_bytes(drawing) for drawing in (shown.driving, shown.driven)}


def svg_bytes(drawing: Drawing) -> bytes:
    """A drawing with a group for each layer, as large on paper as the gear is."""
    decimals = decimals_for([drawing])
    root = Xml.Element("svg", {"xmlns": NAMESPACE, "version": "1.1", **_size(drawing, decimals)})
    Xml.SubElement(root, "title").text = drawing.notes[0]
    Xml.SubElement(root, "desc").text = "; ".join(drawing.notes[1:])
    upward = Xml.SubElement(root, "g", {"transform": "scale(1,-1)", "fill": "none", "stroke-width": f"{HAIRLINE_MM}"})
    for layer, shapes in drawing.layers.items():
        group = Xml.SubElement(upward, "g", {"id": layer.name, "stroke": COLORS[layer.use]})
        Xml.SubElement(group, "title").text = layer.words
        for shape in shapes:
            Xml.SubElement(group, "path", {"d": _path(shape, decimals)})
    Xml.indent(root)
    text: bytes = Xml.tostring(root, encoding="utf-8", xml_declaration=True)
    return text + b"\n"


def _size(drawing: Drawing, decimals: int) -> dict[str, str]:
    """Attributes that give a drawing with its margin its true size on paper."""
    box_low, box_high = box_around([drawing])
    low, high = box_low - MARGIN_MM, box_high + MARGIN_MM
    width, height = high - low
    box = " ".join(_numbers(np.array([low[0], -high[1], width, height]), decimals))
    across, up = _numbers(np.array([width, height]), decimals)
    return {"width": f"{across}mm", "height": f"{up}mm", "viewBox": box}


def _path(shape: Shape, decimals: int) -> str:
    """The ``d`` attribute of a path that draws a shape."""
    match shape:
        case Polyline():
            return f"M{_coordinates(shape.points[:1], decimals)[0]}{''.join(_steps(shape, decimals))}Z"
        case Circle():
            reach = shape.radius_mm * np.array([[-1.0, 0.0], [1.0, 0.0]])
            left, right = _coordinates(np.array([shape.x_mm, shape.y_mm]) + reach, decimals)
            (radius,) = _numbers(np.array([shape.radius_mm]), decimals)
            half = f"A{radius},{radius} 0 0 1 "
            return f"M{left}{half}{right}{half}{left}Z"
        case Cross():
            return "".join(f"M{start}L{end}" for start, end in (_coordinates(line, decimals) for line in shape.lines))


def _steps(chain: Polyline, decimals: int) -> Iterator[str]:
    """Its lines and arcs; an arc of over half a turn is the larger one of the two with its radius."""
    ends, turned = np.roll(chain.points, -1, axis=0), 4.0 * np.arctan(chain.bulges)
    # Lines have no radius; theirs is not written.
    sine = np.where(turned == 0.0, 1.0, np.sin(np.abs(turned) / 2.0))
    radii = _numbers(np.hypot(*(ends - chain.points).T) / 2.0 / sine, decimals)
    for end, radius, turn in zip(_coordinates(ends, decimals), radii, turned.tolist(), strict=True):
        yield f"A{radius},{radius} 0 {int(abs(turn) > pi)} {int(turn > 0.0)} {end}" if turn else f"L{end}"


def _coordinates(points: Array, decimals: int) -> list[str]:
    """Points of shape (n, 2) as a path has them."""
    return [f"{x},{y}" for x, y in zip(*(_numbers(column, decimals) for column in points.T), strict=True)]


def _numbers(values: Array, decimals: int) -> list[str]:
    """Numbers without needless zeros, and without a minus before a zero."""
    return [f"{value:.{decimals}f}".rstrip("0").rstrip(".") for value in written(values, decimals).tolist()]
