"""SVG files at 1:1: one user unit is one millimetre, and y points up as in the gear's frame."""

from __future__ import annotations

from math import atan, pi, sin
from xml.etree import ElementTree as Xml

import numpy as np

from ncgear.files.workshop.drawing import (
    DECIMALS,
    Circle,
    Cross,
    Drawing,
    Polyline,
    Shape,
    Use,
    box_around,
    gear_drawing,
    written,
)
from ncgear.pitch.shape import Gear
from ncgear.project.drive import Drive

NAMESPACE = "http://www.w3.org/2000/svg"

MARGIN_MM = 2.0
HAIRLINE_MM = 0.1
"""Width of lines: narrow enough for cutters that cut only thin lines, and wide enough for a screen."""

COLORS = {Use.THROUGH: "#000000", Use.PART_WAY: "#0000ff", Use.REFERENCE: "#cc0000"}
"""Colours by which cutters know what to do along a line."""


def svg_files(drive: Drive) -> dict[str, bytes]:
    """``driving.svg`` and ``driven.svg``, each gear in its own frame, by their names."""
    drawings = [gear_drawing(drive, gear) for gear in Gear]
    return {f"{drawing.name}.svg": svg_bytes(drawing) for drawing in drawings}


def svg_bytes(drawing: Drawing) -> bytes:
    """A drawing with a group for each layer, as large on paper as the gear is."""
    root = Xml.Element("svg", {"xmlns": NAMESPACE, "version": "1.1", **_size(drawing)})
    Xml.SubElement(root, "title").text = drawing.notes[0]
    Xml.SubElement(root, "desc").text = "; ".join(drawing.notes[1:])
    upward = Xml.SubElement(root, "g", {"transform": "scale(1,-1)", "fill": "none", "stroke-width": f"{HAIRLINE_MM}"})
    for layer, shapes in drawing.layers.items():
        group = Xml.SubElement(upward, "g", {"id": layer.name, "stroke": COLORS[layer.use]})
        Xml.SubElement(group, "title").text = layer.words
        for shape in shapes:
            Xml.SubElement(group, "path", {"d": _path(shape)})
    Xml.indent(root)
    text: bytes = Xml.tostring(root, encoding="utf-8", xml_declaration=True)
    return text + b"\n"


def _size(drawing: Drawing) -> dict[str, str]:
    """Attributes that give a drawing with its margin its true size on paper."""
    box_low, box_high = box_around([drawing])
    low, high = box_low - MARGIN_MM, box_high + MARGIN_MM
    width, height = high - low
    box = " ".join(map(_number, (low[0], -high[1], width, height)))
    return {"width": f"{_number(width)}mm", "height": f"{_number(height)}mm", "viewBox": box}


def _path(shape: Shape) -> str:
    """The ``d`` attribute of a path that draws a shape."""
    match shape:
        case Polyline():
            points = shape.points.tolist()
            steps = zip(points, [*points[1:], points[0]], shape.bulges.tolist(), strict=True)
            return f"M{_coordinates(points[0])}{''.join(_step(*step) for step in steps)}Z"
        case Circle():
            left, right = ((shape.x_mm + side * shape.radius_mm, shape.y_mm) for side in (-1.0, 1.0))
            half = f"A{_number(shape.radius_mm)},{_number(shape.radius_mm)} 0 0 1 "
            return f"M{_coordinates(left)}{half}{_coordinates(right)}{half}{_coordinates(left)}Z"
        case Cross():
            return "".join(f"M{_coordinates(start)}L{_coordinates(end)}" for start, end in shape.lines.tolist())


def _step(start: list[float], end: list[float], bulge: float) -> str:
    """A line or an arc to the end; an arc of over half a turn is the larger one of the two with its radius."""
    if bulge == 0.0:
        return f"L{_coordinates(end)}"
    turned = 4.0 * atan(abs(bulge))
    radius = _number(float(np.hypot(end[0] - start[0], end[1] - start[1])) / 2.0 / sin(turned / 2.0))
    return f"A{radius},{radius} 0 {int(turned > pi)} {int(bulge > 0.0)} {_coordinates(end)}"


def _coordinates(point: tuple[float, float] | list[float]) -> str:
    return f"{_number(point[0])},{_number(point[1])}"


def _number(value: float) -> str:
    """The number without needless zeros, and without a minus before a zero."""
    return f"{written(value):.{DECIMALS}f}".rstrip("0").rstrip(".")
