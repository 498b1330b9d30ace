"""SVG files: drawings of gears at 1:1, a user unit a millimetre and y up, and sheets of their size on paper."""

from __future__ import annotations

from collections.abc import Iterator
from math import cos, pi, sin
from xml.etree import ElementTree as Xml

import numpy as np

from ncgear.files.workshop import drawing as flat
from ncgear.files.workshop.drawing import Circle, Cross, Drawing, PairDrawings, Polyline, Shape, Use
from ncgear.files.workshop.sheets.sheet import CAPITAL, NARROW, Pen, Ring, Sheet, SheetLine, Text
from ncgear.numerics.arrays import Array

NAMESPACE = "http://www.w3.org/2000/svg"

MARGIN_MM = 2.0
HAIRLINE_MM = 0.1
"""Width of lines: narrow enough for cutters that cut only thin lines, and wide enough for a screen."""

COLORS = {Use.THROUGH: "#000000", Use.PART_WAY: "#0000ff", Use.REFERENCE: "#cc0000"}
"""Colours that tell a cutter how to treat a line."""


def svg_files(shown: PairDrawings) -> dict[str, bytes]:
    """``driving.svg`` and ``driven.svg``, each gear in its own frame, by their names."""
    return {f"{drawing.name}.svg": svg_bytes(drawing) for drawing in (shown.driving, shown.driven)}


def svg_bytes(drawing: Drawing) -> bytes:
    """A drawing with a group for each layer, as large on paper as the gear is."""
    decimals = flat.decimals_for([drawing])
    box_low, box_high = flat.box_around([drawing])
    low, high = box_low - MARGIN_MM, box_high + MARGIN_MM
    width, height = high - low
    box = " ".join(_numbers(np.array([low[0], -high[1], width, height]), decimals))
    across, up = _numbers(np.array([width, height]), decimals)
    root = _root(drawing.notes[0], {"width": f"{across}mm", "height": f"{up}mm", "viewBox": box})
    Xml.SubElement(root, "desc").text = "; ".join(drawing.notes[1:])
    upward = Xml.SubElement(root, "g", {"transform": "scale(1,-1)", "fill": "none", "stroke-width": f"{HAIRLINE_MM}"})
    for layer, shapes in drawing.layers.items():
        group = Xml.SubElement(upward, "g", {"id": layer.name, "stroke": COLORS[layer.use]})
        Xml.SubElement(group, "title").text = layer.words
        for shape in shapes:
            Xml.SubElement(group, "path", {"d": _path(shape, decimals)})
    return _bytes(root)


def _root(title: str, attributes: dict[str, str]) -> Xml.Element:
    root = Xml.Element("svg", {"xmlns": NAMESPACE, "version": "1.1", **attributes})
    Xml.SubElement(root, "title").text = title
    return root


def _bytes(root: Xml.Element) -> bytes:
    Xml.indent(root)
    text: bytes = Xml.tostring(root, encoding="utf-8", xml_declaration=True)
    return text + b"\n"


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
    """Path steps of lines and arcs; an arc over half a turn is marked as the larger of two arcs with its radius."""
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
    return [f"{value:.{decimals}f}".rstrip("0").rstrip(".") for value in flat.written(values, decimals).tolist()]


PAPER_DECIMALS = 3
"""Decimals of coordinates: a micrometre of paper."""

MATRIX_DECIMALS = 6
"""Decimals of sines and cosines, so that turned letters keep their height."""

FONT = "Arial, Helvetica, 'Liberation Sans', sans-serif"


def sheet_svg(sheet: Sheet) -> bytes:
    """A sheet as a file in millimetres of paper, from the upper left corner."""
    width, height = sheet.size_mm
    size = {"width": f"{width:g}mm", "height": f"{height:g}mm", "viewBox": f"0 0 {width:g} {height:g}"}
    root = _root(sheet.title, {**size, "font-family": FONT, "fill": "none", "stroke-linejoin": "round"})
    Xml.SubElement(root, "rect", {"width": f"{width:g}", "height": f"{height:g}", "fill": "#ffffff"})
    groups = {pen: Xml.SubElement(root, "g", _pen(pen)) for pen in Pen}
    texts = Xml.SubElement(root, "g", {"fill": "#000000"})
    for item in sheet.plain():
        named = {"id": item.name} if item.name else {}
        match item:
            case Text():
                Xml.SubElement(texts, "text", {**named, **_text(item, height)}).text = item.words
            case Ring():
                (x, y), radius = item.center, item.radius
                place = {"cx": _number(x), "cy": _number(height - y), "r": _number(radius)}
                Xml.SubElement(groups[item.pen], "circle", {**named, **place})
            case SheetLine():
                black = {"fill": "#000000", "stroke": "none"} if item.filled else {}
                path = {**named, "d": _line(item, height), **black}
                Xml.SubElement(groups[item.pen], "path", path)
    return _bytes(root)


def _pen(pen: Pen) -> dict[str, str]:
    dashes = {"stroke-dasharray": " ".join(f"{dash:g}" for dash in pen.dashes_mm)} if pen.dashes_mm else {}
    return {"id": pen.name, "stroke": "#000000", "stroke-width": f"{pen.width_mm:g}", **dashes}


def _line(line: SheetLine, height: float) -> str:
    points = np.round(np.array([0.0, height]) + line.points * np.array([1.0, -1.0]), PAPER_DECIMALS) + 0.0
    return "M" + "L".join(f"{x:g},{y:g}" for x, y in points.tolist()) + ("Z" if line.closed else "")


def _text(text: Text, height: float) -> dict[str, str]:
    """Letters are narrowed along their line, wherever it leads."""
    (x, y), cosine, sine = text.place, cos(text.turned_rad), sin(text.turned_rad)
    matrix = (NARROW * cosine, -NARROW * sine, sine, cosine, x, height - y)
    numbers = " ".join(f"{round(value, MATRIX_DECIMALS) + 0.0:g}" for value in matrix)
    return {
        "transform": f"matrix({numbers})",
        "font-size": _number(text.letter_mm / CAPITAL),
        "text-anchor": text.anchor.name.lower(),
    }


def _number(value: float) -> str:
    return f"{round(float(value), PAPER_DECIMALS) + 0.0:g}"
