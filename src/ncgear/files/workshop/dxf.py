"""DXF files (AutoCAD 2010 and later) in mm: closed contours on named layers."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from io import StringIO
from typing import Any

import ezdxf
import numpy as np
from ezdxf import units
from ezdxf.document import Drawing as Document
from ezdxf.entities.lwpolyline import LWPolylinePoints
from ezdxf.layouts import BlockLayout, Modelspace
from ezdxf.lldxf.types import DXFTag
from ezdxf.sections.classes import REQ_R2004

from ncgear.errors import Unanswered
from ncgear.files.workshop.drawing import (
    BULGE_DECIMALS,
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
"""Height of the view with which the file opens, divided by the height of the drawing."""


def dxf_files(shown: PairDrawings) -> dict[str, bytes]:
    """``driving.dxf`` and ``driven.dxf`` in their own frames, and ``pair.dxf`` as assembled, by their names."""
    driving, driven = shown.driving, shown.driven
    assembled = {"DRIVING_": driving, "DRIVEN_": driven.moved(shown.center_distance_mm)}
    return {
        "driving.dxf": dxf_bytes({"": driving}, driving.notes),
        "driven.dxf": dxf_bytes({"": driven}, driven.notes),
        "pair.dxf": dxf_bytes(assembled, shown.notes),
    }


def dxf_bytes(drawings: Mapping[str, Drawing], notes: Sequence[str]) -> bytes:
    """One file with drawings, each by the prefix of its layers' names; the same drawings give the same bytes.

    The notes are below the drawings, and among the properties of the file.  Raises Unanswered for
    a file in which the library's audit finds a fault.
    """
    with without_clock():
        document = ezdxf.new(VERSION, units=units.MM)
        document.linetypes.add("CENTER", CENTER_LINE, description="Center ____ _ ____")
        decimals = decimals_for(drawings.values())
        for prefix, drawing in drawings.items():
            _draw(document, drawing, prefix, decimals)
        _write(document, notes, *box_around(drawings.values()), decimals)
        if document.audit().has_issues:
            raise Unanswered(f"the DXF file of {notes[0]} has faults")
        # Otherwise the library lists the classes in the order of a set, which differs from process to process.
        for name in (*REQ_R2004, *sorted(document.entitydb.dxf_types_in_use())):
            document.classes.add_class(name)
        text = StringIO()
        document.write(text)
    return document.encode(text.getvalue())


@contextmanager
def without_clock() -> Iterator[None]:
    """A context in which files get no time of writing and no random identities."""
    options = ezdxf.options
    before = options.write_fixed_meta_data_for_testing
    options.write_fixed_meta_data_for_testing = True
    try:
        yield
    finally:
        options.write_fixed_meta_data_for_testing = before


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
            add_chain(
                space, written(shape.points, decimals), {**attributes, "flags": WHOLE_PATTERN}, bulges, closed=True
            )
        case Circle():
            x, y, radius = written(np.array([shape.x_mm, shape.y_mm, shape.radius_mm]), decimals).tolist()
            space.add_circle((x, y), radius, dxfattribs=attributes)
        case Cross():
            for start, end in written(shape.lines, decimals).tolist():
                space.add_line(start, end, dxfattribs=attributes)


class _ChainPoints(LWPolylinePoints):
    """The points of a polyline, whose tags are one text: the library would make an object of every number."""

    __slots__ = ()

    def dxftags(self) -> Iterator[DXFTag]:
        rows = ((x, y, f" 42\n{bulge}\n" if bulge else "") for x, y, _, _, bulge in self.values.tolist())
        yield _TagText(0, "".join(f" 10\n{x}\n 20\n{y}\n{more}" for x, y, more in rows))


class _TagText(DXFTag):
    """Tags as the text that a file has of them."""

    def dxfstr(self) -> str:
        return str(self._value)


def add_chain(
    space: BlockLayout | Modelspace,
    points: Array,
    attributes: dict[str, Any],
    bulges: Array | float = 0.0,
    *,
    closed: bool,
) -> None:
    """Add a polyline through points (n, 2) with bulges (n,), all at once: the library copies them point by point."""
    chain, rows = space.add_lwpolyline([], close=closed, dxfattribs=attributes), np.zeros((len(points), 5))
    rows[:, :2], rows[:, 4] = points, bulges
    chain.lwpoints = _ChainPoints()
    chain.lwpoints.set(rows)


def _write(document: Document, notes: Sequence[str], low: Array, high: Array, decimals: int) -> None:
    """Write notes below the box of the drawings, line by line, and set the view that shows all of it at opening."""
    document.layers.add(NOTES, color=COLORS[Use.THROUGH])
    low, high = written(low, decimals), written(high, decimals)
    letter = float(written((high[0] - low[0]) / LETTERS_ACROSS, decimals))
    foot = low - np.array([0.0, LINE_SPACING * letter * (len(notes) + 1)])
    for number, note in enumerate(notes, 1):
        document.header.custom_vars.append(f"note {number}", note)
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
