"""DXF files (AutoCAD 2010 and later) in mm: drawings of gears, closed contours on named layers, and sheets.

A sheet is at true size about the origin of the main view, so its frame is enlarged by the inverse of the scale;
the layout ``A4`` shows it on paper.  Its dimensions are DXF dimensions; a dimension in a view of another scale has the
factor that makes its text right.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from io import StringIO
from math import ceil, degrees, log10

import ezdxf
import numpy as np
from ezdxf import units
from ezdxf.document import Drawing as Document
from ezdxf.entities import Dimension as DimensionEntity
from ezdxf.entities.lwpolyline import LWPolylinePoints
from ezdxf.layouts import BlockLayout, Modelspace
from ezdxf.lldxf.types import DXFTag
from ezdxf.sections.classes import REQ_R2004

from ncgear.errors import Unanswered
from ncgear.figures.numbers import drawn
from ncgear.files.workshop import drawing as flat
from ncgear.files.workshop.drawing import (
    BULGE_DECIMALS,
    DECIMALS,
    Circle,
    Cross,
    Drawing,
    PairDrawings,
    Polyline,
    Shape,
    Use,
    written,
)
from ncgear.files.workshop.sheets import sheet as paper
from ncgear.files.workshop.sheets.sheet import NARROW, Anchor, Dimension, Measured, Pen, Ring, Sheet, SheetLine, Text
from ncgear.numerics.arrays import Array

VERSION = "R2010"
"""The first version with all features used here; every program of the last fifteen years reads it."""

COLORS = {Use.THROUGH: 7, Use.PART_WAY: 5, Use.REFERENCE: 1}
"""Colours by the AutoCAD colour index: black or white, blue, red."""

CENTER_LINE = [6.0, 4.0, -0.75, 0.5, -0.75]
"""Length in mm of the pattern, and its lines and gaps; lines that no machine should cut look like centre lines."""

WHOLE_PATTERN = 128
"""Flag of polylines whose line pattern continues from chord to chord."""

NOTES = "NOTES"
LETTERS_ACROSS = 80.0
"""Width of the drawing in heights of the notes' letters."""
LINE_SPACING = 1.6
"""Distance of two lines of notes in heights of letters."""
SLACK = 1.1
"""Height of the first view of an opened file, divided by the height of the drawing."""


def dxf_files(shown: PairDrawings) -> dict[str, bytes]:
    """``driving.dxf`` and ``driven.dxf`` in their own frames, and ``pair.dxf`` as assembled, by their names.

    The files of one gear are for cutting: they hold only the closed contours that are cut.
    """
    driving, driven = shown.driving, shown.driven
    assembled = {"DRIVING_": driving, "DRIVEN_": driven.moved(shown.center_distance_mm)}
    return {
        "driving.dxf": dxf_bytes({"": driving.cut}, driving.notes, in_sight=False),
        "driven.dxf": dxf_bytes({"": driven.cut}, driven.notes, in_sight=False),
        "pair.dxf": dxf_bytes(assembled, shown.notes),
    }


def dxf_bytes(drawings: Mapping[str, Drawing], notes: Sequence[str], *, in_sight: bool = True) -> bytes:
    """One file with drawings, each by the prefix of its layers' names; the same drawings give the same bytes.

    The notes are among the properties of the file and, ``in_sight``, below the drawings.  Raises Unanswered for a file
    with faults.
    """

    def fill(document: Document) -> None:
        document.linetypes.add("CENTER", CENTER_LINE, description="Center ____ _ ____")
        decimals = flat.decimals_for(drawings.values())
        for prefix, drawing in drawings.items():
            _draw(document, drawing, prefix, decimals)
        for number, note in enumerate(notes, 1):
            document.header.custom_vars.append(f"note {number}", note)
        _write(document, notes if in_sight else (), *flat.box_around(drawings.values()), decimals)

    return _file(notes[0], fill)


def _file(name: str, fill: Callable[[Document], None]) -> bytes:
    """A file that ``fill`` fills, with no time of writing and no random identities.

    Raises Unanswered for a file in which the library's audit finds a fault.
    """
    options = ezdxf.options
    before = options.write_fixed_meta_data_for_testing
    options.write_fixed_meta_data_for_testing = True
    try:
        document = ezdxf.new(VERSION, units=units.MM)
        fill(document)
        if document.audit().has_issues:
            raise Unanswered(f"the DXF file of {name} has faults")
        # Otherwise the library lists the classes in the order of a set, which differs from process to process.
        for kind in (*REQ_R2004, *sorted(document.entitydb.dxf_types_in_use())):
            document.classes.add_class(kind)
        text = StringIO()
        document.write(text)
    finally:
        options.write_fixed_meta_data_for_testing = before
    return document.encode(text.getvalue())


def _draw(document: Document, drawing: Drawing, prefix: str, decimals: int) -> None:
    """Add a drawing's layers, with their use as a property, and the shapes on them."""
    for layer, shapes in drawing.layers.items():
        line = "CENTER" if layer.use is Use.REFERENCE else "Continuous"
        made = document.layers.add(f"{prefix}{layer.name}", color=COLORS[layer.use], linetype=line)
        made.description = layer.words
        for shape in shapes:
            _add(document.modelspace(), shape, made.dxf.name, decimals)


def _add(space: Modelspace, shape: Shape, layer: str, decimals: int) -> None:
    attributes = {"layer": layer}
    match shape:
        case Polyline():
            bulges = written(shape.bulges, BULGE_DECIMALS)
            _add_polyline(space, layer, written(shape.points, decimals), bulges, closed=True)
        case Circle():
            x, y, radius = written(np.array([shape.x_mm, shape.y_mm, shape.radius_mm]), decimals).tolist()
            space.add_circle((x, y), radius, dxfattribs=attributes)
        case Cross():
            for start, end in written(shape.lines, decimals).tolist():
                space.add_line(start, end, dxfattribs=attributes)


def _add_polyline(space: BlockLayout | Modelspace, layer: str, points: Array, bulges: Array, *, closed: bool) -> None:
    """Add points (shape (n, 2)) with their bulges (shape (n,)) at once: the library would copy all for each point."""
    polyline = space.add_lwpolyline([], close=closed, dxfattribs={"layer": layer, "flags": WHOLE_PATTERN | closed})
    width = np.zeros(len(points))
    polyline.lwpoints = _Vertices()
    polyline.lwpoints.set(np.column_stack([points, width, width, bulges]))


class _Vertices(LWPolylinePoints):
    """Points of a polyline that are written at once: the library would make several objects for every number."""

    def dxftags(self) -> Iterator[DXFTag]:
        """All points as one tag."""
        rows = np.asarray(self.values).reshape(-1, self.VERTEX_SIZE)[:, [0, 1, 4]].tolist()
        bent = (f" 42\n{bulge}\n" if bulge else "" for _, _, bulge in rows)
        yield _Text("".join(f" 10\n{x}\n 20\n{y}\n{more}" for (x, y, _), more in zip(rows, bent, strict=True)))


class _Text(DXFTag):
    """Tags that are text already."""

    def __init__(self, text: str) -> None:
        super().__init__(LWPolylinePoints.VERTEX_CODE, text)

    def dxfstr(self) -> str:
        """The text."""
        return str(self.value)


def _write(document: Document, notes: Sequence[str], low: Array, high: Array, decimals: int) -> None:
    """Write notes below the box of the drawings, line by line, and set the view that shows all of it at opening."""
    if notes:
        document.layers.add(NOTES, color=COLORS[Use.THROUGH])
    low, high = written(low, decimals), written(high, decimals)
    letter = float(written((high[0] - low[0]) / LETTERS_ACROSS, decimals))
    foot = low - np.array([0.0, LINE_SPACING * letter * (len(notes) + 1)])
    for number, note in enumerate(notes, 1):
        place = low - np.array([0.0, LINE_SPACING * letter * (number + 0.5)])
        document.modelspace().add_text(
            note, height=letter, dxfattribs={"layer": NOTES, "insert": tuple(written(place, decimals).tolist())}
        )
    document.header["$EXTMIN"], document.header["$EXTMAX"] = (
        (*written(foot, decimals).tolist(), 0.0),
        (*high.tolist(), 0.0),
    )
    center = tuple(written((foot + high) / 2.0, decimals).tolist())
    document.set_modelspace_vport(float(written(SLACK * (high[1] - foot[1]), decimals)), center)


LETTERS, DIMENSIONS = "LETTERS", "DIMENSIONS"
"""Layers beside the layers of the pens; the styles of texts and of dimensions have the same names."""

TYPES = {Measured.LENGTH: 1, Measured.DIAMETER: 3, Measured.RADIUS: 4}
OWN_BLOCK = 32
"""Types of dimensions in DXF, and the flag that no other dimension uses its block."""


def sheet_dxf(sheet: Sheet) -> bytes:
    """A sheet as a file; the same sheet gives the same bytes.  Raises Unanswered for a file with faults."""

    def fill(document: Document) -> None:
        _prepare(document, sheet)
        space = document.modelspace()
        for item in sheet.items:
            if isinstance(item, Dimension):
                _measure(document, space, item, sheet)
            else:
                _put(space, item, sheet)
        _show(document, sheet)

    return _file(sheet.title, fill)


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
    sizes = {
        "dimtxt": paper.LETTER_MM,
        "dimasz": paper.ARROW_MM,
        "dimexe": paper.BEYOND_MM,
        "dimexo": paper.FREE_MM,
        "dimgap": paper.FREE_MM,
    }
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


def _put(space: BlockLayout | Modelspace, item: SheetLine | Ring | Text, sheet: Sheet) -> None:
    match item:
        case Text():
            place = tuple(_true(np.asarray(item.place), sheet).tolist())
            # Programs place texts that do not begin at their place by the second point.
            aligned = (
                {"halign": [*Anchor].index(item.anchor), "align_point": place}
                if item.anchor is not Anchor.START
                else {}
            )
            turned = {"rotation": degrees(item.turned_rad)} if item.turned_rad else {}
            attributes = {"layer": LETTERS, "style": LETTERS, "width": NARROW, "insert": place, **turned, **aligned}
            space.add_text(item.words, height=item.letter_mm / sheet.scale, dxfattribs=attributes)
        case Ring():
            center = _true(np.asarray(item.center), sheet).tolist()
            space.add_circle(
                center, float(written(item.radius / sheet.scale, _decimals(sheet))), dxfattribs={"layer": item.pen.name}
            )
        case SheetLine():
            points, layer = _true(item.points, sheet), {"layer": item.pen.name}
            if item.filled:
                # A triangle: a DXF solid has its third corner twice.
                space.add_solid(points[[0, 1, 2, 2]].tolist(), dxfattribs=layer)
            elif len(points) == 2:
                start, end = points.tolist()
                space.add_line(start, end, dxfattribs=layer)
            else:
                _add_polyline(space, item.pen.name, points, np.zeros(len(points)), closed=item.closed)


def _measure(document: Document, space: Modelspace, item: Dimension, sheet: Sheet) -> None:
    """A dimension with the block that shows it; so it looks the same whatever fonts a program has."""
    block = document.blocks.new_anonymous_block(type_char="D")
    for part in paper.parts_of(item):
        _put(block, part, sheet)
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
