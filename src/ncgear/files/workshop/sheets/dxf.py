"""A sheet as a DXF file (AutoCAD 2010 and later), with dimensions that are dimensions.

Everything is at true size about the origin of the main view, so the sheet's frame is as much larger as the scale asks;
the layout ``A4`` shows it on paper.  A dimension in a view of another scale has the factor that makes its text right.
"""

from __future__ import annotations

from io import StringIO
from math import ceil, degrees, log10

import ezdxf
import numpy as np
from ezdxf import units
from ezdxf.document import Drawing as Document
from ezdxf.entities import Dimension as DimensionEntity
from ezdxf.layouts import BlockLayout, Modelspace
from ezdxf.sections.classes import REQ_R2004

from ncgear.errors import Unanswered
from ncgear.figures.numbers import drawn
from ncgear.files.workshop.drawing import DECIMALS, written
from ncgear.files.workshop.dxf import VERSION, WHOLE_PATTERN, add_chain, without_clock
from ncgear.files.workshop.sheets.sheet import (
    ARROW_MM,
    BEYOND_MM,
    FREE_MM,
    LETTER_MM,
    NARROW,
    Anchor,
    Dimension,
    Line,
    Measured,
    Pen,
    Ring,
    Sheet,
    Text,
    parts_of,
)
from ncgear.numerics.arrays import Array

LETTERS, DIMENSIONS = "LETTERS", "DIMENSIONS"
"""Layers beside those of the pens; the style of texts and that of dimensions have the same names."""

ALIGNMENTS = {Anchor.START: 0, Anchor.MIDDLE: 1, Anchor.END: 2}
"""Horizontal alignments of texts in DXF."""

TYPES = {Measured.LENGTH: 1, Measured.DIAMETER: 3, Measured.RADIUS: 4}
OWN_BLOCK = 32
"""Types of dimensions in DXF, and the flag that no other dimension uses its block."""


def dxf_bytes(sheet: Sheet) -> bytes:
    """The file; the same sheet gives the same bytes.

    Raises Unanswered for a file in which the library's audit finds a fault.
    """
    with without_clock():
        document = ezdxf.new(VERSION, units=units.MM)
        _prepare(document, sheet)
        space = document.modelspace()
        for item in sheet.items:
            if isinstance(item, Dimension):
                _measure(document, space, item, sheet)
            else:
                _add(space, item, sheet)
        _show(document, sheet)
        if document.audit().has_issues:
            raise Unanswered(f"the DXF file of {sheet.title} has faults")
        # Otherwise the library lists the classes in the order of a set, which differs from process to process.
        for name in (*REQ_R2004, *sorted(document.entitydb.dxf_types_in_use())):
            document.classes.add_class(name)
        text = StringIO()
        document.write(text)
    return document.encode(text.getvalue())


def _prepare(document: Document, sheet: Sheet) -> None:
    """Layers, styles, and the title among the properties."""
    for pen in Pen:
        line = "Continuous"
        if pen.dashes_mm:
            gaps = [length if place % 2 == 0 else -length for place, length in enumerate(pen.dashes_mm)]
            document.linetypes.add(pen.name, [sum(pen.dashes_mm), *gaps])
            line = pen.name
        document.layers.add(pen.name, color=7, linetype=line, lineweight=round(100.0 * pen.width_mm))
    document.layers.add(LETTERS, color=7, lineweight=25)
    document.layers.add(DIMENSIONS, color=7, lineweight=25)
    document.styles.add(LETTERS, font="arial.ttf").dxf.width = NARROW
    sizes = {"dimtxt": LETTER_MM, "dimasz": ARROW_MM, "dimexe": BEYOND_MM, "dimexo": FREE_MM, "dimgap": FREE_MM}
    looks = {"dimdec": 4, "dimzin": 8, "dimtad": 1, "dimtih": 0, "dimtoh": 0, "dimtxsty": LETTERS}
    document.dimstyles.add(DIMENSIONS, dxfattribs={**sizes, **looks, "dimscale": 1.0 / sheet.scale})
    # Dashes are in mm of paper.
    document.header["$LTSCALE"], document.header["$PSLTSCALE"] = 1.0 / sheet.scale, 0
    document.header.custom_vars.append("title", sheet.title)
    document.header["$LWDISPLAY"] = 1


def _true(points: Array, sheet: Sheet) -> Array:
    """Points of the sheet (..., 2) at true size about the origin of the main view."""
    return written((points - np.asarray(sheet.origin)) / sheet.scale, _decimals(sheet))


def _decimals(sheet: Sheet) -> int:
    """Decimals of coordinates of true size: as many on paper as any drawing has."""
    return DECIMALS + max(0, ceil(log10(sheet.scale)))


def _add(space: BlockLayout | Modelspace, item: Line | Ring | Text, sheet: Sheet) -> None:
    match item:
        case Text():
            place = tuple(_true(np.asarray(item.place), sheet).tolist())
            # Programs place texts that do not begin at their place by the second point.
            aligned = (
                {"halign": ALIGNMENTS[item.anchor], "align_point": place} if item.anchor is not Anchor.START else {}
            )
            turned = {"rotation": degrees(item.turned_rad)} if item.turned_rad else {}
            attributes = {"layer": LETTERS, "style": LETTERS, "width": NARROW, "insert": place, **turned, **aligned}
            space.add_text(item.words, height=item.letter_mm / sheet.scale, dxfattribs=attributes)
        case Ring():
            center = _true(np.asarray(item.center), sheet).tolist()
            space.add_circle(
                center, float(written(item.radius / sheet.scale, _decimals(sheet))), dxfattribs={"layer": item.pen.name}
            )
        case Line():
            points, layer = _true(item.points, sheet), {"layer": item.pen.name}
            if item.filled:
                # A triangle, whose third corner a solid has twice.
                space.add_solid(points[[0, 1, 2, 2]].tolist(), dxfattribs=layer)
            elif len(points) == 2:
                start, end = points.tolist()
                space.add_line(start, end, dxfattribs=layer)
            else:
                add_chain(space, points, {**layer, "flags": WHOLE_PATTERN | item.closed}, closed=item.closed)


def _measure(document: Document, space: Modelspace, item: Dimension, sheet: Sheet) -> None:
    """A dimension with the block that shows it; so it looks the same whatever fonts a program has."""
    block = document.blocks.new_anonymous_block(type_char="D")
    for part in parts_of(item):
        _add(block, part, sheet)
    (one, other), base = _true(item.ends, sheet).tolist(), _true(item.base, sheet).tolist()
    points = {"defpoint": base, "defpoint2": one, "defpoint3": other}
    if item.measured is not Measured.LENGTH:
        points = {"defpoint": one, "defpoint4": other}
    dimension = space.new_entity(
        "DIMENSION",
        {
            **{name: (*place, 0.0) for name, place in points.items()},
            "layer": DIMENSIONS,
            "dimstyle": DIMENSIONS,
            "dimtype": TYPES[item.measured] | OWN_BLOCK,
            "text": item.text.words.replace(drawn(item.value_mm, "mm"), "<>", 1),
            "text_midpoint": (*_true(item.text.corners.mean(axis=0), sheet).tolist(), 0.0),
            "actual_measurement": float(written(item.value_mm, _decimals(sheet))),
            "geometry": block.name,
        },
    )
    assert isinstance(dimension, DimensionEntity)
    if item.view != sheet.scale:
        style = dimension.override()
        style["dimlfac"] = sheet.scale / item.view
        style.commit()


def _show(document: Document, sheet: Sheet) -> None:
    """The view at opening, and the sheet on paper."""
    size = np.asarray(sheet.size_mm)
    low, high = _true(np.zeros(2), sheet), _true(size, sheet)
    document.header["$EXTMIN"], document.header["$EXTMAX"] = (*low.tolist(), 0.0), (*high.tolist(), 0.0)
    middle, height = tuple(((low + high) / 2.0).tolist()), float(high[1] - low[1])
    document.set_modelspace_vport(height, middle)
    document.layouts.rename("Layout1", "A4")
    paper = document.paperspace("A4")
    paper.page_setup(size=sheet.size_mm, margins=(0, 0, 0, 0), units="mm")
    paper.add_viewport(tuple((size / 2.0).tolist()), sheet.size_mm, middle, height)
