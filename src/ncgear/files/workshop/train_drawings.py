"""The drawings of a train for a workshop: every part at 1:1 for DXF and SVG files, and sheets of paper.

Equal parts share a drawing, by the name of the first.  The sheet of a gear says which of its directions face its mates
when the train is put together; the sheet of the assembly has all parts in that pose, with their places and angles.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import partial
from math import degrees

import numpy as np

from ncgear.figures.assembly import outline_radius_mm
from ncgear.figures.numbers import drawn
from ncgear.files.workshop.drawing import Circle, Cross, Drawing, Layer, Shape, polygon
from ncgear.files.workshop.sheets import sheet as paper
from ncgear.files.workshop.sheets.board import Board
from ncgear.files.workshop.sheets.body import PaperView, drawn_shape
from ncgear.files.workshop.sheets.frame import (
    TITLE_HEIGHT_MM,
    Box,
    ColumnWidths,
    PaperTable,
    Titles,
    framed,
    inside,
)
from ncgear.files.workshop.sheets.gear_view import point_at_circle
from ncgear.files.workshop.sheets.sheet import A4_MM, Dimension, Measured, Pen, Sheet
from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array
from ncgear.pitch.shape import Mesh
from ncgear.trains.train import Part, Train

GAP_MM, SIDE_MM, ABOVE_MM = 2.0, 24.0, 14.0
"""Gaps beside views and tables, and room left and right of a view, and above and below it, for its leaders."""

MOST_ROWS = 30
"""Most rows of a table: as many as leave half a sheet for the view."""

CROSS_SHARE = 0.12
"""Length of the mark of an axis without a bore, as a share of the part's reach."""


@dataclass(frozen=True, eq=False)
class TrainDrawings:
    """Drawings of different parts, by the name of the first of equal parts, and sheets of gears and assembly."""

    parts: Mapping[str, Drawing]
    sheets: Mapping[str, Sheet]


@dataclass(frozen=True)
class MateFacing:
    """A mate of a gear, and the directions in rad, each in its own frame, that face each other as assembled."""

    mate: str
    distance_mm: float
    own_rad: float
    mate_rad: float

    @property
    def directions(self) -> tuple[str, str]:
        """Both directions in degrees, from 0 to 360."""
        own, mate = (f"{round(degrees(angle), 3) % 360.0:.3f}" for angle in (self.own_rad, self.mate_rad))
        return own, mate


def train_drawings(name: str, train: Train, outlines_mm: Mapping[str, Array]) -> TrainDrawings:
    """All drawings of a train, from the outlines that are written, shape (n, 2) each."""
    first = [part for part in train.parts if train.alike[part.name] == part.name]
    drawings = {part.name: _part_drawing(name, train, part, outlines_mm[part.name]) for part in first}
    sheets = {part.name: _gear_sheet(name, train, part, drawings[part.name]) for part in first if part.teeth}
    return TrainDrawings(drawings, sheets | {"assembly": _assembly_sheet(name, train, drawings)})


def _part_drawing(name: str, train: Train, part: Part, outline_mm: Array) -> Drawing:
    """A part in its own frame."""
    holes = [Circle(hole.x_mm, hole.y_mm, hole.diameter_mm / 2.0) for hole in part.holes]
    if part.bore_mm is not None:
        holes.insert(0, Circle(0.0, 0.0, part.bore_mm / 2.0))
    long_mm = CROSS_SHARE * part.reach_mm if part.bore_mm is None else 1.25 * part.bore_mm
    shapes: dict[Layer, tuple[Shape, ...]] = {
        Layer.OUTLINE: (polygon(outline_mm),),
        Layer.RIM: () if part.rim_mm is None else (Circle(0.0, 0.0, part.reach_mm),),
        Layer.BORE: tuple(holes),
        Layer.AXIS: (Cross(0.0, 0.0, long_mm),),
    }
    teeth = f"{part.teeth} teeth, " if part.teeth else ""
    notes = (
        f"{name}: {', '.join(_equals(train, part))}",
        f"1:1 in mm; chords no farther than {train.tolerance_mm:.4g} mm from the exact curve, round holes exact",
        f"axis at the origin, upper face towards you; {teeth}face width {part.face_width_mm:g} mm",
        *(f"as assembled {_angle(train, other)} deg: {other}" for other in _equals(train, part)),
    )
    return Drawing(part.name, {layer: found for layer, found in shapes.items() if found}, notes)


def _equals(train: Train, part: Part) -> list[str]:
    """The names of all parts that are made alike."""
    return [other for other, first in train.alike.items() if first == train.alike[part.name]]


def _angle(train: Train, name: str) -> str:
    """The angle in degrees at which a part stands as the train is assembled, from 0 to 360."""
    turned = degrees(float(train.assembled.angle_rad[train.number(name), 0]))
    return f"{round(turned, 3) % 360.0:.3f}"


def facings(train: Train, name: str) -> Iterator[MateFacing]:
    """The mates of a gear at the driving angle 0; the gear in a ring faces away from the ring's axis."""
    poses = train.assembled
    for mesh in train.meshes:
        if name not in (mesh.first, mesh.second):
            continue
        mate = mesh.second if mesh.first == name else mesh.first
        (here, turn), (there, other) = (
            (complex(axis[0]), complex(turned[0]))
            for axis, turned in (poses.places(train.number(each)) for each in (name, mate))
        )
        way = there - here
        senses = (1.0, -1.0)
        if mesh.kind is Mesh.INTERNAL:
            senses = (-1.0, -1.0) if mesh.first == name else (1.0, 1.0)
        own, others = (float(np.angle(sense * way / each)) for sense, each in zip(senses, (turn, other), strict=True))
        yield MateFacing(mate, abs(way), own, others)


def _scale_in(area: Box, size_mm: Array) -> float:
    """The largest scale at which a view of a size has room for itself and its leaders."""
    room = np.array([area.width - 2.0 * SIDE_MM, area.height - 2.0 * ABOVE_MM])
    return next((scale for scale in paper.SCALES if (scale * size_mm <= room).all()), paper.SCALES[-1])


def _areas(table: PaperTable) -> tuple[Box, Box]:
    """The paper for a view, and below it for a table over the title block."""
    frame = inside(A4_MM)
    low = frame.low + TITLE_HEIGHT_MM + GAP_MM
    high = low + table.height_mm() + GAP_MM
    return Box(frame.left + GAP_MM, high, frame.right - GAP_MM, frame.high - GAP_MM), Box(
        frame.left, low, frame.right, high
    )


def _gear_sheet(name: str, train: Train, part: Part, drawing: Drawing) -> Sheet:
    """A gear from above, the directions that face its mates, and their table; for all equal gears."""
    rows = [
        (other, _angle(train, other), each.mate, _angle(train, each.mate), f"{each.distance_mm:.4f}", *each.directions)
        for other in _equals(train, part)
        for each in facings(train, other)
    ]
    heads = (
        "gear",
        "its angle deg",
        "mate",
        "mate's angle deg",
        "distance mm",
        "faces mate at deg",
        "mate faces at deg",
    )
    title = f"As assembled: {part.teeth} teeth, face width {part.face_width_mm:g} mm; angles counter-clockwise from +x"
    columns = ColumnWidths((30.0, 22.0, 30.0, 22.0, 24.0, 26.0, 26.0), (False, True, False, True, True, True, True))
    table = PaperTable(_title(title, len(rows)), heads, tuple(rows[:MOST_ROWS]), columns)
    area, below = _areas(table)
    low, high = (edge(np.vstack([shape.corners for shape in _edges(drawing)]), axis=0) for edge in (np.min, np.max))
    scale = _scale_in(area, high - low)
    middle = np.array([area.left + area.right, area.low + area.high]) / 2.0
    view = PaperView(scale, tuple((middle - scale * (low + high) / 2.0).tolist()))
    board = Board(area.bounds)
    _draw(board, drawing, view, Pen.VISIBLE, part.name)
    outline = next(iter(drawing.layers[Layer.OUTLINE])).corners
    for each in facings(train, part.name):
        way = np.array([np.cos(each.own_rad), np.sin(each.own_rad)])
        target = view.on_paper(outline_radius_mm(outline, each.own_rad) * way)
        inwards = each.own_rad + (np.pi if part.rim_mm is not None else 0.0)
        board.point(target, inwards, f"faces {each.mate}")
    tip = outline[int(np.argmax(np.hypot(*outline.T)))]
    reach = f"R{drawn(part.reach_mm, 'mm')} over all"
    if part.rim_mm is not None:
        tip = part.reach_mm * tip / np.hypot(*tip)
    found = board.pointed(view.on_paper(tip), float(np.arctan2(tip[1], tip[0])), reach)
    if found is not None:
        ends = view.on_paper(np.array([np.zeros(2), tip]))
        board.add(Dimension(Measured.RADIUS, ends, ends[1], *found, scale))
    if part.bore_mm is not None:
        point_at_circle(board, view, [Circle(0.0, 0.0, part.bore_mm / 2.0)], f"\u00d8{drawn(part.bore_mm, 'mm')}")
    said = ", ".join(_equals(train, part))
    titles = _titles(said, name, train, "in its own frame", scale)
    items = (*framed(A4_MM, titles), *board.items, *table.drawn(below.left, below.high))
    return Sheet(f"{name}: {said}", A4_MM, scale, view.origin, items)


def _title(words: str, rows: int) -> str:
    return words if rows <= MOST_ROWS else f"{words}; {MOST_ROWS} of {rows}, all in assembly.json"


def _titles(part: str, name: str, train: Train, view: str, scale: float) -> Titles:
    return Titles(part, name, "-", f"seen from z > 0, {view}", scale, f"outlines within {train.tolerance_mm:.4g}")


def _edges(drawing: Drawing) -> list[Shape]:
    """The shapes of a drawing but for the mark of its axis."""
    return [shape for layer, shapes in drawing.layers.items() if layer is not Layer.AXIS for shape in shapes]


def _draw(board: Board, drawing: Drawing, view: PaperView, pen: Pen, name: str) -> None:
    for shape in _edges(drawing):
        board.add(*drawn_shape(shape, view, pen, name))
    for shape in drawing.layers[Layer.AXIS]:
        board.add(*drawn_shape(shape, view, Pen.CHAIN))


def _assembly_sheet(name: str, train: Train, drawings: Mapping[str, Drawing]) -> Sheet:
    """All parts at the driving angle 0, with their places, angles and heights."""
    poses = train.assembled
    at = [np.array([poses.x_mm[number, 0], poses.y_mm[number, 0]]) for number in range(len(train.parts))]
    rows = []
    for number, part in enumerate(train.parts):
        place = (f"{round(value, 4) + 0.0:.4f}" for value in at[number].tolist())
        heights = f"{part.low_mm:g} to {part.low_mm + part.face_width_mm:g}"
        file = f"{train.alike[part.name]}.dxf"
        rows.append(
            (str(number + 1), part.name, str(part.teeth or "-"), file, *place, _angle(train, part.name), heights)
        )
    heads = ("", "part", "teeth", "file", "x mm", "y mm", "angle deg", "z mm")
    columns = ColumnWidths((8.0, 34.0, 12.0, 36.0, 22.0, 22.0, 20.0, 26.0), (True, False, True, False, *[True] * 4))
    table = PaperTable(_title("Parts as assembled", len(rows)), heads, tuple(rows[:MOST_ROWS]), columns)
    area, below = _areas(table)
    plain = [
        PaperView(1.0, tuple(place.tolist()), float(poses.angle_rad[number, 0])) for number, place in enumerate(at)
    ]
    shapes = [drawings[train.alike[part.name]] for part in train.parts]
    reached = np.vstack(
        [view.on_paper(shape.corners) for view, flat in zip(plain, shapes, strict=True) for shape in _edges(flat)]
    )
    low, high = reached.min(axis=0), reached.max(axis=0)
    scale = _scale_in(area, high - low)
    middle = np.array([area.left + area.right, area.low + area.high]) / 2.0
    origin = middle - scale * (low + high) / 2.0
    board = Board(area.bounds)
    views = [
        PaperView(scale, tuple((origin + scale * np.array(view.origin)).tolist()), view.turn_rad) for view in plain
    ]
    for part, view, drawing in zip(train.parts, views, shapes, strict=True):
        _draw(board, drawing, view, Pen.THIN, part.name)
    for number, (part, view, drawing) in enumerate(zip(train.parts, views, shapes, strict=True), 1):
        edge = view.on_paper(_edges(drawing)[0].corners)
        away = edge - middle
        pointed = partial(board.point, words=f"{number} {part.name}")
        for angle in np.radians(np.arange(90.0, 450.0, 20.0)) + float(np.angle(complex(*(view.origin - middle)))):
            way = np.array([np.cos(angle), np.sin(angle)])
            if pointed(edge[int(np.argmax(away @ way))], float(angle), turns_rad=(0.0, 0.4, -0.4)):
                break
    items = (
        *framed(A4_MM, _titles("Assembly", name, train, "as assembled", scale)),
        *board.items,
        *table.drawn(below.left, below.high),
    )
    return Sheet(f"{name}: assembly", A4_MM, scale, tuple(origin.tolist()), items)
