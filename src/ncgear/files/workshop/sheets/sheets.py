"""The sheets of a pair on paper, one for each gear and one for the assembly.

The sheet of a gear has its views with numbered teeth above, its tables and its bore below.  The sheet of the assembly
has both gears in mesh, the mechanism at phi1 = 0, and a list of parts.  Its frame is that of the mechanism: the slider
moves to the right and the crank turns clockwise.  So a ring and the gear in it are seen from below, like their crank.
Each of two pairs in series has its own sheets; the assembly of the second pair shows the mechanism.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import fields
from math import degrees
from typing import Any

import numpy as np
import shapely

from ncgear.drawings.scene.bodies import chamber_of
from ncgear.drawings.scene.scene import Scene
from ncgear.drawings.scene.standing import supports_mm
from ncgear.figures.data_sheet.entries import distance_text, general_text, shafts_below
from ncgear.figures.data_sheet.measured_tables import pitch_table
from ncgear.figures.numbers import drawn
from ncgear.figures.tables import Table
from ncgear.files.workshop.drawing import Cross
from ncgear.files.workshop.sheets import gear_view
from ncgear.files.workshop.sheets import sheet as paper
from ncgear.files.workshop.sheets.board import Board
from ncgear.files.workshop.sheets.body import PaperView, drawn_body, drawn_holes, drawn_shape, finished, material_of
from ncgear.files.workshop.sheets.frame import (
    TITLE_HEIGHT_MM,
    TITLE_WIDTH_MM,
    Box,
    ColumnWidths,
    PaperTable,
    Titles,
    fitted,
    framed,
    inside,
)
from ncgear.files.workshop.sheets.gear_tables import gear_tables
from ncgear.files.workshop.sheets.sheet import A4_MM, Anchor, Item, Pen, Sheet, SheetLine, Text
from ncgear.frozen import dataclass
from ncgear.mechanisms.mechanism import RodMechanism
from ncgear.numerics.arrays import Array
from ncgear.numerics.jet import Jet
from ncgear.numerics.plane import turned
from ncgear.pitch.shape import Gear
from ncgear.project.drive import Drive
from ncgear.project.workshop_measures import GearMeasures
from ncgear.solids.plan.body import BodyPlan

GAP_MM = 2.0
"""Gap beside tables and views."""

SIDE_MM, ABOVE_MM = 26.0, 16.0
"""Room left and right of the gears, and above and below them, for leaders and the centre distance."""

MECHANISM_MM = 74.0
"""Height of the view of the mechanism."""

MECHANISM_SIDE_MM, MECHANISM_ABOVE_MM = 10.0, 13.0
"""Room about the mechanism."""

SEEN = {1.0: "seen from z > 0", -1.0: "seen from z < 0"}
"""The side from which the gears are seen, by the hand of their mounting."""


@dataclass(frozen=True)
class Layout:
    """The places of the parts of the sheet."""

    size_mm: tuple[float, float]
    gears: Box
    mechanism: Box | None
    parts: Box


def pair_sheet(drive: Drive) -> Sheet:
    """The sheet of the pair in the pose of phi1 = 0, upright or across, whichever has room for a larger scale."""
    mounting, plans = gear_view.mounting_of(drive), {gear: finished(drive, gear) for gear in Gear}
    plain = {gear: PaperView(1.0, mounting.axis_mm(gear), mounting.turn_rad, mounting.hand) for gear in Gear}
    outlines = [plain[gear].on_paper(shapely.get_coordinates(plan.disc)) for gear, plan in plans.items()]
    low, high = np.vstack(outlines).min(axis=0), np.vstack(outlines).max(axis=0)
    scene = Scene(drive.design.name, drive.machine, drive.law.train, (), chamber_of(drive.linkage, drive.machine.load))
    bodies = dict(_bodies(scene)) if gear_view.turns_crank(drive) and scene.links else {}
    upright, across = (_layout(size, mechanism=bool(bodies)) for size in (paper.A4_MM, paper.A4_MM[::-1]))
    scale, other = (_scale_in(layout.gears, high - low) for layout in (upright, across))
    layout, scale = (across, other) if other > scale else (upright, scale)
    middle = np.array([layout.gears.left + layout.gears.right, layout.gears.low + layout.gears.high]) / 2.0
    origin = middle - scale * (low + high) / 2.0
    views = {
        gear: PaperView(
            scale, tuple((origin + scale * np.array(mounting.axis_mm(gear))).tolist()), mounting.turn_rad, mounting.hand
        )
        for gear in Gear
    }
    items = _gears(drive, plans, views, layout.gears)
    if layout.mechanism is not None:
        items += _mechanism(drive, bodies, layout.mechanism)
    items += _parts(drive, list(bodies)).drawn(layout.parts.left, layout.parts.high)
    name = drive.title
    titles = Titles(
        "Assembly", name, "see list of parts", f"{SEEN[mounting.hand]}, pose of phi1 = 0", scale, general_text(drive)
    )
    x, y = origin.tolist()
    return Sheet(f"{name}: assembly", layout.size_mm, scale, (x, y), (*framed(layout.size_mm, titles), *items))


def _scale_in(box: Box, size_mm: Array) -> float:
    """The largest scale at which a size fits into a box, with room around it."""
    room = np.array([box.width - 2.0 * SIDE_MM, box.height - 2.0 * ABOVE_MM])
    return next((scale for scale in paper.SCALES if (scale * size_mm <= room).all()), paper.SCALES[-1])


PARTS_UPRIGHT_MM = 40.0
"""Height of the list of parts above the title block."""


def _layout(size_mm: tuple[float, float], *, mechanism: bool) -> Layout:
    frame = inside(size_mm)
    title = frame.low + TITLE_HEIGHT_MM
    if size_mm[0] < size_mm[1]:
        parts = Box(frame.left, title, frame.right, title + PARTS_UPRIGHT_MM)
        low = parts.high + GAP_MM
    else:
        parts = Box(frame.left, frame.low, frame.right - TITLE_WIDTH_MM, title + GAP_MM)
        low = title + 2.0 * GAP_MM
    area = Box(frame.left + GAP_MM, low, frame.right - GAP_MM, frame.high - GAP_MM)
    if not mechanism:
        return Layout(size_mm, area, None, parts)
    between = area.low + MECHANISM_MM
    below = Box(area.left, area.low, area.right, between)
    return Layout(size_mm, Box(area.left, between, area.right, area.high), below, parts)


# --- gears -----------------------------------------------------------------------------------------------------------


def _gears(drive: Drive, plans: dict[Gear, BodyPlan], views: dict[Gear, PaperView], box: Box) -> list[Item]:
    """Both gears, the line of centres with its length, numbers, marks and senses of turning."""
    board, mounting = Board(box.bounds), gear_view.mounting_of(drive)
    for gear, view in views.items():
        board.add(*drawn_body(drive, gear, plans[gear], view, f"{gear.value}-outline"))
        board.keep_clear(drawn_holes(plans[gear], view))
        mark = Cross(0.0, 0.0, 2.0 * drive.pitch.size.module_mm)
        board.add(*drawn_shape(mark, view, Pen.CHAIN))
    axes = np.array([views[gear].origin for gear in Gear])
    board.add(SheetLine(axes, Pen.CHAIN))
    if all(plans[gear].index_hole for gear in Gear):
        board.add(Text(FACING, (box.left, box.high - paper.LETTER_MM - 1.0)))
    if drive.stage is not None and not gear_view.turns_crank(drive):
        board.add(Text(BEFORE_LAST.format(drive.stage + 1), (box.left, box.high - 2.0 * (paper.LETTER_MM + 1.0) - 1.0)))
    if gear_view.turns_crank(drive):
        _draw_crank(
            board, drive, axes[1], np.vstack([item.points for item in board.items if isinstance(item, SheetLine)])
        )
    along = (axes[1] - axes[0]) / np.hypot(*(axes[1] - axes[0]))
    aside = np.array([-along[1], along[0]])
    corners = np.vstack([views[gear].on_paper(shapely.get_coordinates(plans[gear].disc)) for gear in Gear])
    reach = (corners - axes[0]) @ aside
    distance = drive.pitch.center_distance_mm
    # Outside both gears, or between their axes and there where outside is not free.
    offsets = [edge + np.sign(edge) * more for more in (7.0, 11.0, 15.0) for edge in (reach.min(), reach.max())]
    offsets += [sense * more for more in np.arange(6.0, float(reach.max()), 2.0) for sense in (-1.0, 1.0)]
    scale = views[Gear.DRIVING].scale
    words = f"{drawn(distance, 'mm')} {distance_text(drive) or ''}".strip()
    board.put_dimension((paper.length(axes, float(apart), words, scale),) for apart in offsets)
    for gear, view in views.items():
        gear_view.number_teeth(board, drive.teeth.of(gear), view, gear.value, fifths=True)
        sense = mounting.sense(gear)
        gear_view.draw_turning(board, view, sense, gear_view.free_radius_mm(plans[gear], view))
    for number, (gear, view) in enumerate(views.items(), 1):
        _name(board, plans[gear], view, f"{number} {gear.value} gear", list(views.values()))
    return board.items


FACING = "The index holes face each other on the line of centres."
BEFORE_LAST = "The shaft of the driven gear turns the driving gear of stage {}."


def _draw_crank(board: Board, drive: Drive, axis: Array, drawn_mm: Array) -> None:
    """The direction of the crank with its name, from the axis to a free place."""
    angle = drive.linkage.crank_start_rad
    way = np.array([np.cos(angle), np.sin(angle)])
    ahead = (drawn_mm - axis) @ way
    beside = np.abs((drawn_mm - axis) @ np.array([-way[1], way[0]])) < paper.LETTER_MM
    end = axis + (float(ahead[beside].max(initial=0.0)) + 6.0) * way
    board.add(SheetLine(np.array([axis, end]), Pen.CHAIN))
    places = [end + more * way + np.array([0.0, lift]) for more in (1.0, 3.0, 6.0) for lift in (1.5, -4.0)]
    anchors = (Anchor.END, Anchor.MIDDLE, Anchor.START)
    board.put_text(Text(drive.linkage.CRANK, (float(x), float(y)), anchor) for x, y in places for anchor in anchors)


def _name(board: Board, plan: BodyPlan, view: PaperView, words: str, views: list[PaperView]) -> None:
    """A leader with item number and name to the edge of a gear, away from the other gear."""
    outer = view.on_paper(shapely.get_coordinates(plan.disc.exterior))
    others = np.mean([other.origin for other in views], axis=0)
    axis = np.asarray(view.origin)
    for degree in np.arange(0.0, 360.0, 15.0):
        away = np.arctan2(*(axis - others)[::-1]) if np.hypot(*(axis - others)) > 1e-9 else 0.0
        angle = away + np.radians(90.0 + (degree if degree <= 180.0 else 180.0 - degree))
        way = np.array([np.cos(angle), np.sin(angle)])
        target = outer[int(np.argmax((outer - axis) @ way))]
        if board.point(target, float(angle), words, (0.0, 0.3, -0.3)):
            return


# --- mechanism -------------------------------------------------------------------------------------------------------


def _bodies(scene: Scene) -> Iterator[tuple[str, list[Array]]]:
    """The bodies of the mechanism at phi1 = 0, by their names: contours in mm in the frame of the mechanism."""
    poses = scene.poses(np.zeros(1))
    for body in scene.links:
        place = poses.places[body.name]
        name = scene.machine.linkage.CRANK if body.name == "crank" else body.name
        yield name, [turned(ring, place.angle_rad) + place.origin_mm for ring in body.contours_mm]


def _mechanism(drive: Drive, bodies: dict[str, list[Array]], box: Box) -> list[Item]:
    """The mechanism at phi1 = 0 in a scale of its own, with its lengths."""
    linkage, mounting = drive.linkage, gear_view.mounting_of(drive)
    supports = supports_mm(linkage)
    gears = np.array([mounting.driving_axis_mm, mounting.driven_axis_mm])
    ends = np.array([[linkage.nearest_mm, linkage.offset_mm], [linkage.farthest_mm, linkage.offset_mm]])
    slides = not linkage.OUTPUT.angular
    curves = {
        curve.gear: PaperView(1.0, mounting.axis_mm(curve.gear), mounting.turn_rad, mounting.hand).on_paper(
            curve.drawn(361).position
        )
        for curve in (drive.pitch.driving, drive.pitch.driven)
    }
    everything = np.vstack(
        [
            *curves.values(),
            *(ring for rings in bodies.values() for ring in rings),
            *supports,
            gears,
            *([ends] if slides else []),
        ]
    )
    low, high = everything.min(axis=0), everything.max(axis=0)
    room = np.array([box.width - 2.0 * MECHANISM_SIDE_MM, box.height - 2.0 * MECHANISM_ABOVE_MM])
    scale = next((scale for scale in paper.SCALES if (scale * (high - low) <= room).all()), paper.SCALES[-1])
    origin = np.array([(box.left + box.right) / 2.0, (box.low + box.high) / 2.0 + 1.0]) - scale * (low + high) / 2.0
    view = PaperView(scale, tuple(origin.tolist()))
    board = Board(box.bounds)
    board.add(SheetLine(np.array([[box.left, box.high], [box.right, box.high]])))
    keys: Any = linkage
    sizes = ", ".join(
        f"{key.name.removesuffix('_mm').replace('_', ' ')} {drawn(float(getattr(linkage, key.name)), 'mm')}"
        for key in fields(keys)
        if key.name.endswith("_mm")
    )
    crank = drawn(degrees(linkage.crank_start_rad) % 360.0, "deg")
    at = f"Mechanism at phi1 = 0, {paper.scale_text(scale)}"
    words = f"{at}; lengths: {sizes}; {linkage.CRANK} at {crank} deg, turns clockwise"
    board.add(Text(fitted(words, box.width - 4.0), (box.left + 2.0, box.high - 4.5)))
    for number, (part, shaft) in enumerate(shafts_below(drive), 1):
        note = f"The {shaft} must end below the {part}."
        board.add(Text(note, (box.left + 2.0, box.high - 4.5 - number * (paper.LETTER_MM + 1.0))))
    for name, rings in bodies.items():
        for ring in rings:
            board.add(SheetLine(view.on_paper(ring), Pen.THIN, closed=True, name=name))
    for line in supports:
        board.add(SheetLine(view.on_paper(line)))
    for gear, curve in curves.items():
        board.add(SheetLine(view.on_paper(curve), Pen.CHAIN, closed=drive.pitch.toothed is None))
        for mark in Cross(*mounting.axis_mm(gear), 5.0 / scale).lines:
            board.add(SheetLine(view.on_paper(mark), Pen.THIN))
    if slides:
        board.add(SheetLine(view.on_paper(ends) + np.array([[-6.0, 0.0], [6.0, 0.0]]), Pen.CHAIN))
        below = float(view.on_paper(low)[1]) - 5.0
        apart = [below - float(view.on_paper(ends)[0, 1]) - more for more in (0.0, 2.0, 4.0)]
        board.put_dimension(
            (paper.length(view.on_paper(ends), ends_apart, f"{drawn(linkage.stroke_mm, 'mm')} stroke", scale),)
            for ends_apart in apart
        )
    for points, words in _lengths(drive):
        on_paper = view.on_paper(points)
        board.put_dimension(
            (paper.length(on_paper, sense * apart, words, scale),)
            for apart in (7.0, 10.0, 13.0, 5.0, 16.0)
            for sense in (1.0, -1.0)
        )
    for number, (name, rings) in enumerate(bodies.items(), 3):
        points = view.on_paper(rings[0])
        for angle in np.radians(np.arange(70.0, 430.0, 20.0)):
            way = np.array([np.cos(angle), np.sin(angle)])
            if board.point(points[int(np.argmax(points @ way))], float(angle), f"{number} {name}", (0.0, 0.4, -0.4)):
                break
    return board.items


def _lengths(drive: Drive) -> Iterator[tuple[Array, str]]:
    """The lengths of crank and rod between their pins at phi1 = 0, shape (2, 2) each, with their texts."""
    linkage, still = drive.linkage, Jet(np.zeros((1, 1)))
    if "crank" in linkage.links(still) and linkage.crank_mm > 0.0:
        angle = linkage.crank_start_rad
        pin = linkage.crank_mm * np.array([np.cos(angle), np.sin(angle)])
        yield np.array([[0.0, 0.0], pin]), drawn(linkage.crank_mm, "mm")
    if isinstance(linkage, RodMechanism):
        rod = linkage.rod(still)
        ends = [[float(end.x.value[0]), float(end.y.value[0])] for end in (rod.pin, rod.wrist)]
        yield np.array(ends), drawn(rod.length_mm, "mm")


# --- list of parts ---------------------------------------------------------------------------------------------------


def _parts(drive: Drive, links: list[str]) -> PaperTable:
    """Gears with their files and materials, and the bodies that they move."""
    rows = [
        (str(number), f"{gear.value} gear", f"{gear.value}_drawing.pdf", material_of(drive, gear))
        for number, gear in enumerate(Gear, 1)
    ]
    rows += [(str(number), name, "-", "-") for number, name in enumerate(links, 3)]
    columns = ColumnWidths((8.0, 25.0, 34.0, 18.0), (True, False, False, False))
    return PaperTable("Parts", ("", "part", "file", "material"), tuple(rows), columns)


TABLES_MM = 108.0
"""Height of the tables: a title, two lines of heads and 24 rows."""


def gear_sheet(drive: Drive, measured: GearMeasures, pitch_radii: Table) -> Sheet:
    """The sheet of a gear, in its own frame and in the pose of phi1 = 0, seen from its upper face.

    ``pitch_radii`` is the data sheet's table of both gears.
    """
    gear = measured.gear
    plan = finished(drive, gear)
    frame = inside(A4_MM)
    low = frame.low + TITLE_HEIGHT_MM + GAP_MM
    tables = Box(frame.left, low, frame.right, low + TABLES_MM)
    area = Box(frame.left + GAP_MM, tables.high + GAP_MM, frame.right - GAP_MM, frame.high - GAP_MM)
    view, items = gear_view.gear_views(drive, measured, plan, area)
    items += gear_tables(drive, measured, plan, pitch_radii, tables)
    name = drive.title
    titles = Titles(
        f"{gear.value.capitalize()} gear",
        name,
        material_of(drive, gear),
        "seen from z > 0, pose of phi1 = 0" + (", section of teeth at z = 0" if drive.helix else ""),
        view.scale,
        general_text(drive),
    )
    return Sheet(f"{name}: {gear.value} gear", A4_MM, view.scale, view.origin, (*framed(A4_MM, titles), *items))


def sheets_of(drive: Drive) -> dict[str, Sheet]:
    """The sheets of ``driving``, ``driven`` and ``pair``; raises the errors of the drive's solids."""
    radii = pitch_table(drive.pitch)
    sheets = {gear.gear.value: gear_sheet(drive, gear, radii) for gear in drive.measured}
    sheets["pair"] = pair_sheet(drive)
    return sheets
