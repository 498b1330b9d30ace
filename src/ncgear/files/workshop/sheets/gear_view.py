"""One gear on paper: from above with numbered teeth, marks and dimensions, and cut across its axis."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import partial
from math import cos, radians, sin

import numpy as np
import shapely
from scipy.spatial import KDTree

from ncgear.drawings.scene.geared_pairs import Mounting, mountings
from ncgear.figures.assembly import outline_radius_mm
from ncgear.figures.data_sheet.measured_tables import allowed_texts, two_pin_table
from ncgear.figures.data_sheet.sheet import rows_found
from ncgear.figures.numbers import drawn
from ncgear.files.workshop.drawing import Circle, Cross, Layer, body_shapes
from ncgear.files.workshop.sheets import body
from ncgear.files.workshop.sheets import sheet as paper
from ncgear.files.workshop.sheets.board import LENGTHS_MM, Board, centered
from ncgear.files.workshop.sheets.frame import Box
from ncgear.files.workshop.sheets.sheet import Anchor, Dimension, Item, Measured, Pen, Ring, SheetLine, Text
from ncgear.numerics.arrays import Array, Mask
from ncgear.pitch.shape import Gear, meeting_direction_rad
from ncgear.project.drive import Drive
from ncgear.project.workshop_measures import GearMeasures
from ncgear.solids.plan.body import BodyPlan
from ncgear.teeth.gear import ToothedGear
from ncgear.tolerances.iso286 import hole_text

SIDE_MM, ABOVE_MM = 17.0, 11.0
"""Room left and right of a gear's view, and above and below it, for numbers, leaders and dimensions."""

CUT_MM = 24.0
"""Room beside the section for its dimension."""

ASIDE_MM = 0.0, 1.2, -1.2, 2.2, -2.2
"""Shifts along the pitch curve that are tried for a tooth's number."""

ASIDE_SHARE = 0.45
"""Share of a pitch beyond which a number would be nearer to the next tooth."""

CAPTION = "Pitch radii are at their angles from the mark of the mesh, against the sense of turning (arrow)."

FIFTH_UNDER_MM = 5.0
"""Where teeth stand nearer than this on paper, only every fifth tooth has its number."""


def mounting_of(drive: Drive) -> Mounting:
    """How the pair is mounted in the machine, as if its driven gear turned the crank."""
    pitch, direction = drive.pitch, radians(drive.gears.driving_axis_deg)
    return mountings([pitch.mesh], [pitch.center_distance_mm], [direction])[0]


def turns_crank(drive: Drive) -> bool:
    """Whether a crank or another body stands on the driven gear's shaft."""
    return drive.linkage.HAS_CRANK and drive.stage in (None, drive.design.stages)


def gear_views(drive: Drive, measured: GearMeasures, plan: BodyPlan, area: Box) -> tuple[body.PaperView, list[Item]]:
    """The gear from above and its section to the right, as large as there is room for."""
    low, high = np.split(np.array(plan.disc.bounds), 2)
    section = body.section_of(plan)
    size = high - low

    def fits(scale: float) -> bool:
        wide = scale * (size[0] + section.height_mm) + 2.0 * SIDE_MM + CUT_MM
        return bool(wide <= area.width and scale * size[1] + 2.0 * ABOVE_MM <= area.height)

    scale = next((scale for scale in paper.SCALES if fits(scale)), paper.SCALES[-1])
    spare = area.width - scale * (size[0] + section.height_mm) - 2.0 * SIDE_MM - CUT_MM
    x = area.left + spare / 2.0 + SIDE_MM - scale * low[0]
    y = (area.low + area.high) / 2.0 - scale * (low[1] + high[1]) / 2.0
    view = body.PaperView(scale, (float(x), float(y)))
    right = float(x + scale * high[0] + SIDE_MM + spare / 2.0)
    board = Board((area.left, area.low, right, area.high))
    board.add(Text(CAPTION, (area.left, area.low + 1.0)))
    _draw_gear(board, drive, measured, plan, view)
    cut = Board((right, area.low, area.right, area.high))
    _draw_section(cut, section, view, right + 8.0)
    return view, [*board.items, *cut.items]


def _draw_gear(board: Board, drive: Drive, measured: GearMeasures, plan: BodyPlan, view: body.PaperView) -> None:
    """The gear from above, its numbers first, then other items where there is room."""
    gear, module = measured.gear, drive.pitch.size.module_mm
    board.add(*body.drawn_body(drive, gear, plan, view, "outline"))
    board.keep_clear(body.drawn_holes(plan, view))
    # The mark of the axis is a little longer than the bore.
    mark_mm = 2.0 * module if plan.bore is None else 1.25 * plan.bore.diameter_mm
    board.add(*body.drawn_shape(Cross(0.0, 0.0, mark_mm), view, Pen.CHAIN))
    _mark_plane(board, plan, view)
    for words, own_rad in _directions(drive, gear):
        way, outer = np.array([cos(own_rad), sin(own_rad)]), shapely.get_coordinates(plan.disc.exterior)[:-1]
        reach = outline_radius_mm(outer, own_rad)
        target = view.on_paper((reach + 1.0 / view.scale) * way)
        board.point(target, view.direction_rad(own_rad), words, (0.0,))
    number_teeth(board, measured.toothed if drive.helix is None else drive.teeth.of(gear), view, "tooth")
    _point_at_tip(board, plan, view, drive.outer_radii_mm[gear])
    if drive.helix is None:
        # Helical gears are measured in another section than the section drawn.
        _draw_pins(board, measured, view)
    _point_at_holes(board, drive, plan, view)
    sense = 1.0 if gear is Gear.DRIVING else drive.pitch.mesh.sense
    draw_turning(board, view, sense, free_radius_mm(plan, view))


def _mark_plane(board: Board, plan: BodyPlan, view: body.PaperView) -> None:
    """The plane of the section A-A, by its ends over and under the gear, with arrows in the direction of view."""
    _, low, _, high = plan.disc.bounds
    for y, sense in ((low, -1.0), (high, 1.0)):
        x, edge = view.on_paper(np.array([0.0, y])).tolist()
        start, end = np.array([x, edge + 1.5 * sense]), np.array([x, edge + 6.0 * sense])
        tip = end + np.array([5.0, 0.0])
        board.add(
            SheetLine(np.array([start, end]), Pen.VISIBLE), SheetLine(np.array([end, tip])), paper.arrow(tip, tip - end)
        )
        board.add(Text("A", (x - 3.5, float(end[1]) - 1.2), letter_mm=paper.TITLE_MM))


def number_teeth(board: Board, gear: ToothedGear, view: body.PaperView, name: str, *, fifths: bool = False) -> None:
    """The number of every tooth inside its root, or outside its tip, nearest to the middle of that tooth.

    Where teeth stand close on paper, and with ``fifths``, the first and every fifth have numbers.
    """
    addendum = gear.flanks.rack.addendum_mm
    heights = [view.on_paper(body.tooth_places(gear, height)) for height in (0.0, addendum, -addendum)]
    trees = [KDTree(places) for places in heights]
    middles = heights[0]
    over = view.on_paper(body.tooth_places(gear, 1.0)) - middles
    outwards = over / np.hypot(*over.T)[:, None]
    teeth = len(middles)
    apart = gear.flanks.curve.length_mm * view.scale / (gear.flanks.count // 2)
    crowded = fifths or apart < FIFTH_UNDER_MM
    depth = view.scale * gear.flanks.rack.dedendum_mm + paper.LETTER_MM / 2.0
    shifts = np.array([shift for shift in ASIDE_MM if abs(shift) < ASIDE_SHARE * apart])
    tries = np.concatenate([-(depth + np.arange(0.6, 6.0, 0.4)), depth + np.arange(0.0, 6.0, 0.4)])
    rows = np.array([row for row in range(teeth) if not crowded or row == 0 or row % 5 == 4])
    aside = outwards[rows, ::-1] * [-1.0, 1.0]
    middle, out, aside = (values[:, None, None] for values in (middles[rows], outwards[rows], aside))
    places = (middle + tries[:, None] * out + shifts[:, None, None] * aside).reshape(rows.size, -1, 2)
    for row, every in zip(rows.tolist(), places, strict=True):
        text = centered(str(row + 1), np.zeros(2), paper.LETTER_MM, f"{name}-{row + 1}")
        board.put_text_at(text, every, partial(_is_nearest, trees, row))


UP_AND_DOWN_MM = np.array([[0.0, -0.4], [0.0, 0.0], [0.0, 0.4]])
"""Points of a number from which its tooth must be the nearest tooth."""


def _is_nearest(trees: Sequence[KDTree], row: int, places: Array) -> Mask:
    """Whether a tooth is the nearest to places on paper, (n, 2), by trees of all teeth's points at several heights."""
    nearest = np.stack([tree.query(places[:, None] + UP_AND_DOWN_MM)[1] for tree in trees])
    return np.asarray((nearest == row).all(axis=(0, -1)))


MOST_PAIRS = 40
"""Most pairs of pins that are tried: between pairs a few degrees apart, none has room where these have none."""


def _draw_pins(board: Board, measured: GearMeasures, view: body.PaperView) -> None:
    """Two pins with the dimension over them, on the left or the right; the most upright pair with room is drawn.

    The text of the dimension is that of the table of measurements, with limits where it has limits.
    """
    rows = [row for row in rows_found(lambda: (two_pin_table(measured),)) if None not in row]
    pins, radius = measured.pins, measured.pins.diameter_mm / 2.0
    places = dict(zip(pins.space.tolist(), pins.center_mm, strict=True))
    pairs = [(*sorted((places[row[0]], places[row[1]]), key=lambda place: float(place[1])), row) for row in rows]
    pairs.sort(key=lambda pair: abs(pair[1][0] - pair[0][0]) / np.hypot(*(pair[1] - pair[0])))
    pairs = pairs[:: -(-len(pairs) // MOST_PAIRS) or 1]
    ring, hull = measured.working.is_ring, shapely.MultiPoint(measured.toothed.outline_mm).convex_hull
    outline = view.on_paper(shapely.get_coordinates(hull))
    by = f"{'between' if ring else 'over'} 2 pins \u00d8{drawn(2.0 * radius, 'mm')}"

    def tried() -> Iterator[tuple[Dimension, Ring, Ring]]:
        for low, high, row in pairs:
            way = (high - low) / np.hypot(*(high - low))
            out = -radius * way if ring else radius * way
            ends = view.on_paper(np.array([low - out, high + out]))
            words = f"{' to '.join(allowed_texts(row[2:]))} {by} ({row[0]}, {row[1]})"
            reach = (outline - ends[0]) @ np.array([-way[1], way[0]])
            edges = reach.max(), reach.min()
            offsets = [0.0] if ring else [float(edge + np.sign(edge) * more) for more in (6.0, 10.0) for edge in edges]
            one, other = (
                Ring(tuple(view.on_paper(place).tolist()), view.scale * radius, Pen.THIN) for place in (low, high)
            )
            for apart in offsets:
                yield paper.length(ends, apart, words, view.scale), one, other

    board.put_dimension(tried())


def _point_at_holes(board: Board, drive: Drive, plan: BodyPlan, view: body.PaperView) -> None:
    """A leader with the diameter to every kind of round holes."""
    for layer, shapes in body_shapes(plan).items():
        if layer in (Layer.RIM, Layer.HUB, Layer.BORE):
            continue
        by_size: dict[float, list[Circle]] = {}
        for shape in shapes:
            if isinstance(shape, Circle):
                by_size.setdefault(2.0 * shape.radius_mm, []).append(shape)
        for size_mm, holes in by_size.items():
            count = f"{len(holes)} \u00d7 " if len(holes) > 1 else ""
            # Lightening holes need no name.
            name = "" if layer is Layer.LIGHTENING_HOLES else f" {layer.content.partition(';')[0].partition(',')[0]}"
            words = f"{count}\u00d8{drawn(size_mm, 'mm')}{_fit(drive, layer, size_mm)}{name}"
            point_at_circle(board, view, holes, words)


def _fit(drive: Drive, layer: Layer, size_mm: float) -> str:
    """The fit of holes of a layer after their diameter; empty where the general tolerance holds."""
    given = drive.gears.tolerances
    if layer is Layer.CRANK_PIN:
        return f" {hole_text(given.crank_pin_fit, size_mm)}"
    return f" {given.index_hole_fit}" if layer is Layer.INDEX_HOLE else ""


AROUND_RAD = tuple(np.radians([45.0, -45.0, 20.0, -20.0, 70.0, -70.0, 100.0, -100.0, 140.0, -140.0, 180.0, 0.0]))


def point_at_circle(
    board: Board, view: body.PaperView, holes: Sequence[Circle], words: str, direction_rad: float = 0.0
) -> None:
    """The shortest leader with room to the edge of one of several holes, as a dimension of its diameter.

    It points at the centre from about a direction, which counts from the direction towards the gear's axis.
    """
    for reach in LENGTHS_MM:
        for hole in holes:
            center = view.on_paper(np.array([hole.x_mm, hole.y_mm]))
            for turn in AROUND_RAD:
                angle = float(np.arctan2(0.0 - hole.y_mm, 0.0 - hole.x_mm)) + direction_rad + turn
                edge = view.scale * hole.radius_mm * np.array([cos(angle), sin(angle)])
                found = board.pointed(center + edge, angle, words, (0.0,), (reach,))
                if found is not None:
                    ends = np.array([center + edge, center - edge])
                    board.add(Dimension(Measured.DIAMETER, ends, ends[0], *found, view.scale))
                    return


def _point_at_tip(board: Board, plan: BodyPlan, view: body.PaperView, radius_mm: float) -> None:
    """A dimension that points from outside at the greatest radius, or at the outer radius of a ring."""
    outer = shapely.get_coordinates(plan.disc.exterior)
    tips = [outer[int(np.argmax(np.hypot(*outer.T)))]]
    if plan.is_ring:
        tips = [radius_mm * np.array([cos(turn), sin(turn)]) for turn in np.radians(np.arange(40.0, 400.0, 15.0))]
    center = view.on_paper(np.zeros(2))
    for tip in tips:
        angle = float(np.arctan2(tip[1], tip[0]))
        target = view.on_paper(tip)
        found = board.pointed(target, angle, f"R{drawn(radius_mm, 'mm')} over all")
        if found is not None:
            board.add(Dimension(Measured.RADIUS, np.array([center, target]), target, *found, view.scale))
            return


def _directions(drive: Drive, gear: Gear) -> list[tuple[str, float]]:
    """Directions in the gear's own frame that matter at phi1 = 0, with their words."""
    meeting = meeting_direction_rad(gear, drive.pitch.mesh)
    if gear is Gear.DRIVING or not turns_crank(drive):
        return [("mesh", meeting)]
    mounting = mounting_of(drive)
    crank = mounting.hand * (drive.linkage.crank_start_rad - mounting.turn_rad)
    if abs(sin((crank - meeting) / 2.0)) < 1e-6:
        return [(f"mesh, {drive.linkage.CRANK}", meeting)]
    return [("mesh", meeting), (drive.linkage.CRANK, crank)]


def free_radius_mm(plan: BodyPlan, view: body.PaperView) -> float:
    """Radius on paper of an arc about the axis outside bore and hub."""
    about = max([plan.bore.reach_mm if plan.bore else 0.0, plan.hub.diameter_mm / 2.0 if plan.hub else 0.0])
    return max(view.scale * about + 2.5, LEAST_TURNING_MM)


TURNING_RAD, LEAST_TURNING_MM = radians(100.0), 5.0
"""Angle of an arc that shows the sense of turning, and its least radius on paper."""


def draw_turning(board: Board, view: body.PaperView, sense: float, least_mm: float) -> None:
    """An arc with an arrow about the axis for the sense of turning, where it crosses no text."""
    axis = view.on_paper(np.zeros(2))
    for radius in least_mm + np.arange(0.0, 12.0, 1.0):
        for start in np.radians(np.arange(40.0, 400.0, 20.0)):
            turned = start + sense * np.linspace(0.0, TURNING_RAD, 25)
            points = axis + radius * np.column_stack([np.cos(turned), np.sin(turned)])
            head = paper.arrow(
                points[-1],
                sense * np.array([-sin(turned[-1] - sense * 1.25 / radius), cos(turned[-1] - sense * 1.25 / radius)]),
            )
            if board.is_free([SheetLine(points), head]):
                board.add(SheetLine(points), head)
                return


def _draw_section(board: Board, section: body.BodySection, view: body.PaperView, left: float) -> None:
    """The section A-A with the dimensions of its widths."""
    middle = view.origin[1]
    board.add(*section.lines(view.scale, left, middle))
    corners = shapely.get_coordinates(section.area)
    low, high = middle + view.scale * float(corners[:, 1].min()), middle + view.scale * float(corners[:, 1].max())
    board.add(
        SheetLine(np.array([[left - 2.0, middle], [left + view.scale * section.height_mm + 2.0, middle]]), Pen.CHAIN)
    )
    center = left + view.scale * section.height_mm / 2.0
    board.add(Text("A-A", (center, high + 4.0), Anchor.MIDDLE, paper.TITLE_MM))
    widths = sorted({section.width_mm, section.height_mm})
    for row, width in enumerate(widths):
        ends = np.array([[left, low], [left + view.scale * width, low]])
        board.add(paper.length(ends, -(6.0 + 6.5 * row), drawn(width, "mm"), view.scale))
