"""A sheet as an SVG file of its size on paper, with texts as texts."""

from __future__ import annotations

from math import cos, sin
from xml.etree import ElementTree as Xml

import numpy as np

from ncgear.files.workshop.sheets.sheet import CAPITAL, NARROW, Anchor, Line, Pen, Ring, Sheet, Text
from ncgear.files.workshop.svg import NAMESPACE
from ncgear.numerics.arrays import Array

DECIMALS = 3
"""Decimals of coordinates: a micrometre of paper."""

MATRIX_DECIMALS = 6
"""Decimals of sines and cosines, so that turned letters keep their height."""

FONT = "Arial, Helvetica, 'Liberation Sans', sans-serif"

ANCHORS = {Anchor.START: "start", Anchor.MIDDLE: "middle", Anchor.END: "end"}


def svg_bytes(sheet: Sheet) -> bytes:
    """The file; its unit is a millimetre of paper, from the upper left corner."""
    width, height = sheet.size_mm
    root = Xml.Element(
        "svg",
        {
            "xmlns": NAMESPACE,
            "version": "1.1",
            "width": f"{width:g}mm",
            "height": f"{height:g}mm",
            "viewBox": f"0 0 {width:g} {height:g}",
            "font-family": FONT,
            "fill": "none",
            "stroke-linejoin": "round",
        },
    )
    Xml.SubElement(root, "title").text = sheet.title
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
            case Line():
                black = {"fill": "#000000", "stroke": "none"} if item.filled else {}
                path = {**named, "d": _path(item, height), **black}
                Xml.SubElement(groups[item.pen], "path", path)
    Xml.indent(root)
    made: bytes = Xml.tostring(root, encoding="utf-8", xml_declaration=True)
    return made + b"\n"


def _pen(pen: Pen) -> dict[str, str]:
    dashes = {"stroke-dasharray": " ".join(f"{one:g}" for one in pen.dashes_mm)} if pen.dashes_mm else {}
    return {"id": pen.name, "stroke": "#000000", "stroke-width": f"{pen.width_mm:g}", **dashes}


def _path(line: Line, height: float) -> str:
    points = np.round(np.array([0.0, height]) + line.points * np.array([1.0, -1.0]), DECIMALS) + 0.0
    return "M" + "L".join(f"{x:g},{y:g}" for x, y in _printed(points)) + ("Z" if line.closed else "")


def _printed(points: Array) -> list[list[float]]:
    found: list[list[float]] = points.tolist()
    return found


def _text(text: Text, height: float) -> dict[str, str]:
    """Letters are narrowed along their line, wherever it leads."""
    (x, y), cosine, sine = text.place, cos(text.turned_rad), sin(text.turned_rad)
    matrix = (NARROW * cosine, -NARROW * sine, sine, cosine, x, height - y)
    numbers = " ".join(f"{round(value, MATRIX_DECIMALS) + 0.0:g}" for value in matrix)
    return {
        "transform": f"matrix({numbers})",
        "font-size": _number(text.letter_mm / CAPITAL),
        "text-anchor": ANCHORS[text.anchor],
    }


def _number(value: float) -> str:
    return f"{round(float(value), DECIMALS) + 0.0:g}"
