"""DXF files (AutoCAD 2010 and later) in mm: closed contours on named layers."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from io import StringIO

import ezdxf
from ezdxf import units
from ezdxf.document import Drawing as Document
from ezdxf.layouts import Modelspace

from ncgear.drive import Drive
from ncgear.output.workshop.drawing import Circle, Contour, Cross, Drawing, Layer, Shape
from ncgear.output.workshop.gear_drawing import gear_drawing, pair_drawings
from ncgear.pitch.shape import Gear

VERSION = "R2010"
"""Read by every program of the last fifteen years, and the first version with all that is needed here."""

COLORS = {
    Layer.OUTLINE: 7,
    Layer.BORE: 5,
    Layer.HOLES: 5,
    Layer.POCKETS: 3,
    Layer.HUB: 4,
    Layer.PITCH_CURVE: 1,
    Layer.AXIS: 1,
}
"""By the AutoCAD colour index: 7 black or white, 5 blue, 3 green, 4 cyan, 1 red."""

CENTER_LINES = (Layer.PITCH_CURVE, Layer.AXIS)
"""What no machine should cut, drawn as centre lines are."""


def dxf_files(drive: Drive) -> dict[str, bytes]:
    """``driving.dxf`` and ``driven.dxf`` in their own frames, and ``pair.dxf`` as assembled, by their names."""
    drawings = [gear_drawing(drive, gear) for gear in Gear]
    pair = pair_drawings(drive)
    return {
        **{f"{drawing.name}.dxf": dxf_bytes([drawing]) for drawing in drawings},
        "pair.dxf": dxf_bytes(pair, prefixed=True),
    }


def dxf_bytes(drawings: Sequence[Drawing], *, prefixed: bool = False) -> bytes:
    """Drawings in one file, whose layers bear the drawing's name too where ``prefixed``; the same give the same bytes.

    Raises RuntimeError, a fault of ncgear, for a file in which the library's audit finds a fault.
    """
    with _without_clock():
        document = ezdxf.new(VERSION, units=units.MM)
        document.linetypes.add("CENTER", [6.0, 4.0, -0.75, 0.5, -0.75], description="Center ____ _ ____")
        for drawing in drawings:
            _draw(document, drawing, f"{drawing.name.upper()}_" if prefixed else "")
        if document.audit().has_issues:
            raise RuntimeError(f"the DXF file of {drawings[0].name} has faults")
        text = StringIO()
        document.write(text)
    return text.getvalue().encode()


@contextmanager
def _without_clock() -> Iterator[None]:
    """Files without the time of writing and random identities."""
    options = ezdxf.options
    before = options.write_fixed_meta_data_for_testing
    options.write_fixed_meta_data_for_testing = True
    try:
        yield
    finally:
        options.write_fixed_meta_data_for_testing = before


def _draw(document: Document, drawing: Drawing, prefix: str) -> None:
    for number, note in enumerate(drawing.notes, 1):
        document.header.custom_vars.append(f"{drawing.name} {number}", note)
    for layer, shapes in drawing.layers.items():
        name, line = f"{prefix}{layer}", "CENTER" if layer in CENTER_LINES else "Continuous"
        document.layers.add(name, color=COLORS[layer], linetype=line)
        for shape in shapes:
            _add(document.modelspace(), shape, name)


def _add(space: Modelspace, shape: Shape, layer: str) -> None:
    attributes = {"layer": layer}
    match shape:
        case Contour():
            rows = [(*point, bulge) for point, bulge in zip(shape.points.tolist(), shape.bulges.tolist(), strict=True)]
            space.add_lwpolyline(rows, format="xyb", close=True, dxfattribs=attributes)
        case Circle():
            space.add_circle((shape.x_mm, shape.y_mm), shape.radius_mm, dxfattribs=attributes)
        case Cross():
            for start, end in shape.lines.tolist():
                space.add_line(start, end, dxfattribs=attributes)
