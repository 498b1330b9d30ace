"""A gear's body as a sheet shows it: finished, from above, and cut across its axis."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import shapely
from shapely import LineString, Polygon
from shapely.geometry.base import BaseGeometry

from ncgear.files.read_back import as_chords
from ncgear.files.workshop.drawing import Circle, Cross, Layer, Polyline, Shape, body_shapes, pitch_points
from ncgear.files.workshop.sheets.sheet import Pen, Ring, SheetLine
from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array
from ncgear.numerics.plane import turned
from ncgear.pitch.shape import Gear
from ncgear.project.drive import Drive
from ncgear.solids.plan.areas import polygons
from ncgear.solids.plan.body import BodyPlan
from ncgear.teeth.gear import ToothedGear

STRAY_MM = 0.004
"""Largest distance between lines of a drawing and the outline's table, which itself keeps the chord tolerance: in mm of
paper where the gear is enlarged."""

ARC_STEP_RAD = np.radians(3.0)
"""Largest angle between points of an arc that is drawn in chords: 0.003 mm off on a radius of 10 mm."""


@dataclass(frozen=True, eq=False)
class PaperView:
    """From a gear's own frame to paper: seen from above, or for ``hand`` -1 from below, turned, scaled, and moved."""

    scale: float
    origin: tuple[float, float]
    turn_rad: float = 0.0
    hand: float = 1.0

    def on_paper(self, points_mm: Array) -> Array:
        """Points (..., 2) in mm of paper."""
        seen = points_mm * np.array([1.0, self.hand])
        return np.asarray(np.asarray(self.origin) + self.scale * turned(seen, np.asarray(self.turn_rad)))

    def direction_rad(self, own_rad: float) -> float:
        """A direction of the gear's own frame on paper."""
        return self.turn_rad + self.hand * own_rad


def finished(drive: Drive, gear: Gear) -> BodyPlan:
    """The finished body: without the clearance of a process along its edges, and without corners left by a cutter."""
    plan = drive.solids.of(gear).plan
    off = plan.clearance_mm
    if off == 0.0:
        return plan
    outline = drive.teeth.of(gear).outline_mm
    disc = Polygon(plan.disc.exterior, [outline]) if plan.is_ring else Polygon(outline)
    # Round holes are not enlarged by a clearance, but are narrower by a kerf.
    wider = -2.0 * min(off, 0.0)
    return replace(
        plan,
        disc=disc,
        bore=plan.bore.widened(-off) if plan.bore else None,
        slot=plan.slot.widened(-off) if plan.slot else None,
        index_hole=replace(plan.index_hole, diameter_mm=plan.index_hole.diameter_mm + wider)
        if plan.index_hole
        else None,
        crank_pin=replace(plan.crank_pin, diameter_mm=plan.crank_pin.diameter_mm - 2.0 * off)
        if plan.crank_pin
        else None,
        lightening_holes=tuple(replace(hole, diameter_mm=hole.diameter_mm + wider) for hole in plan.lightening_holes),
        clearance_mm=0.0,
    )


def material_of(drive: Drive, gear: Gear) -> str:
    """The name of a gear's material, or words for a design that names no material."""
    if drive.gears.material is None:
        return "not given"
    driving, driven = drive.gears.material.each
    return (driving if gear is Gear.DRIVING else driven).name


def drawn_body(drive: Drive, gear: Gear, plan: BodyPlan, view: PaperView, name: str = "") -> Iterator[SheetLine | Ring]:
    """All edges seen from above, the pitch curve, and the mark of the axis; the tooth outline is named ``name``."""
    for layer, shapes in body_shapes(plan).items():
        for shape in shapes:
            yield from drawn_shape(shape, view, Pen.VISIBLE, name if layer is Layer.OUTLINE else "")
    curve = pitch_points(drive.pitch.of(gear), plan.chord_tolerance_mm)
    yield SheetLine(view.on_paper(curve), Pen.CHAIN, closed=True)


HOLES = Layer.BORE, Layer.CRANK_PIN, Layer.INDEX_HOLE, Layer.END_STOP, Layer.LIGHTENING_HOLES


def drawn_holes(plan: BodyPlan, view: PaperView) -> Iterator[SheetLine | Ring]:
    """The edges of all that goes through a body."""
    shapes = body_shapes(plan)
    for shape in (shape for layer in HOLES for shape in shapes[layer]):
        yield from drawn_shape(shape, view, Pen.VISIBLE)


def drawn_shape(shape: Shape, view: PaperView, pen: Pen, name: str = "") -> Iterator[SheetLine | Ring]:
    """The lines of a shape."""
    match shape:
        case Polyline():
            chords = as_chords(shape.points, shape.bulges, np.abs(4.0 * np.arctan(shape.bulges)) / ARC_STEP_RAD)
            ring = shapely.simplify(shapely.LinearRing(chords), STRAY_MM / max(view.scale, 1.0))
            yield SheetLine(view.on_paper(shapely.get_coordinates(ring)[:-1]), pen, closed=True, name=name)
        case Circle():
            x, y = view.on_paper(np.array([shape.x_mm, shape.y_mm])).tolist()
            yield Ring((x, y), view.scale * shape.radius_mm, pen, name)
        case Cross():
            for ends in shape.lines:
                yield SheetLine(view.on_paper(ends), Pen.CHAIN)


def tooth_places(gear: ToothedGear, height_mm: float) -> Array:
    """Places over the pitch curve in the middle of every tooth, shape (z, 2); the row of tooth n is n - 1."""
    flanks = gear.flanks
    sides = flanks.crossing_mm[: 2 * flanks.teeth].reshape(-1, 2)
    return flanks.offset(sides.mean(axis=1), height_mm)[0]


HATCH_MM = 2.5
"""Distance of the lines of a hatching."""


@dataclass(frozen=True, eq=False)
class BodySection:
    """A body cut in the plane x = 0 of its frame: z to the right in mm, and y upwards."""

    area: BaseGeometry
    width_mm: float
    height_mm: float

    def lines(self, scale: float, left: float, middle: float) -> Iterator[SheetLine]:
        """The section on paper: z = 0 at ``left``, y = 0 at ``middle``, with its hatching."""
        place = np.array([left, middle])
        cut = shapely.transform(self.area, lambda points: place + scale * points)
        low, high = (edge(shapely.get_coordinates(cut)[:, 1]) for edge in (np.min, np.max))
        for z in {0.0, self.width_mm, self.height_mm}:
            if z != self.height_mm or z == self.width_mm:
                x = left + scale * z
                yield SheetLine(np.array([[x, low], [x, high]]), Pen.VISIBLE)
        for part in polygons(cut):
            for ring in (part.exterior, *part.interiors):
                yield SheetLine(np.asarray(ring.coords)[:-1], Pen.VISIBLE, closed=True)
        right = left + scale * self.height_mm
        for start in np.arange(low - (right - left), high, HATCH_MM * np.sqrt(2.0)):
            stroke = LineString([(left, start), (right, start + right - left)]).intersection(cut)
            for piece in shapely.get_parts(stroke):
                if piece.length > 0.0:
                    yield SheetLine(np.asarray(piece.coords), Pen.THIN)


def section_of(plan: BodyPlan) -> BodySection:
    """The body's section by the plane x = 0."""
    reach = 2.0 * float(np.abs(shapely.get_coordinates(plan.disc)).max())
    plane = LineString([(0.0, -reach), (0.0, reach)])
    boxes = []
    for slab in plan.slabs:
        for piece in shapely.get_parts(slab.section.intersection(plane)):
            if piece.length > 0.0:
                ys = np.asarray(piece.coords)[:, 1]
                boxes.append(shapely.box(slab.low_mm, ys.min(), slab.high_mm, ys.max()))
    return BodySection(shapely.union_all(boxes), plan.face_width_mm, plan.height_mm)
