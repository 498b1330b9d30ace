"""A flat drawing of a gear in mm as a value: closed contours and marks on named layers, for DXF and SVG files.

It is the plan of the body from above, in the frame of the gear and in the pose of phi1 = 0.  Its notes tell the facts
that lines cannot show, so that a workshop needs no other paper.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace
from enum import Enum
from math import asin, ceil, log10, pi, sqrt, tan

import numpy as np
import shapely
from shapely.geometry.base import BaseGeometry

from ncgear.errors import Unanswered
from ncgear.figures.numbers import drawn
from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array
from ncgear.numerics.plane import bow_middles
from ncgear.pitch.curve import PitchCurve
from ncgear.pitch.shape import Gear
from ncgear.project.drive import Drive
from ncgear.solids.plan.areas import polygons
from ncgear.solids.plan.body import BodyPlan, Bore, RoundHole
from ncgear.teeth.contour import CURVES_SHARE

DECIMALS, FINER = 6, 8
"""Decimals of coordinates in mm: a millionth of a millimetre, or a hundred-millionth for drawings under 100 mm: far
below any chord tolerance."""

BULGE_DECIMALS = 9
"""Decimals of bulges: on a chord of a metre the arc stays within a millionth of a millimetre."""


def written(values: Array | float, decimals: int) -> Array:
    """Numbers as DXF and SVG files have them: rounded, and without a minus before a zero.

    Raises Unanswered for infinity and NaN.
    """
    if not np.isfinite(values).all():
        raise Unanswered("a drawing holds a coordinate that is no finite number")
    return np.asarray(np.round(values, decimals) + 0.0)


class Use(Enum):
    """The use of the lines of a layer in a workshop."""

    THROUGH = "cut through"
    PART_WAY = "not cut through"
    REFERENCE = "for reference, not cut"


class Layer(Enum):
    """The layers of a drawing, each with its content and its use; in files a layer has the member's name."""

    OUTLINE = "tooth outline", Use.THROUGH
    RIM = "outer circle of the ring", Use.THROUGH
    BORE = "bore with its keyway", Use.THROUGH
    CRANK_PIN = "hole for the crank pin, in the direction of the crank at phi1 = 0", Use.THROUGH
    INDEX_HOLE = "index hole; those of both gears face each other at phi1 = 0", Use.THROUGH
    END_STOP = "slot in which a pin of the frame stops the gear", Use.THROUGH
    LIGHTENING_HOLES = "lightening holes", Use.THROUGH
    POCKETS = "pockets from the upper face down to the web", Use.PART_WAY
    HUB = "hub on the upper face", Use.PART_WAY
    PITCH_CURVE = "pitch curve", Use.REFERENCE
    AXIS = "axis of the gear", Use.REFERENCE

    def __init__(self, content: str, use: Use) -> None:
        self.content, self.use = content, use

    @property
    def words(self) -> str:
        """The content and the use of the layer, in the words of the files."""
        return f"{self.content}; {self.use.value}"


@dataclass(frozen=True, eq=False)
class Polyline:
    """A closed chain of lines and arcs through points (n, 2), first point not repeated.

    ``bulges`` (n,) describe the piece after each point: 0 for a line, else the tangent of a quarter of the arc's angle,
    positive counter-clockwise (the bulge of the DXF reference).
    """

    points: Array
    bulges: Array

    @property
    def corners(self) -> Array:
        """Points whose box holds the contour, up to the height of arcs above the points at their middles."""
        return np.vstack([self.points, bow_middles(self.points, self.bulges)])


def polygon(points: Array) -> Polyline:
    """A contour of lines alone, through points (n, 2)."""
    return Polyline(points, np.zeros(len(points)))


@dataclass(frozen=True)
class Circle:
    """A whole circle."""

    x_mm: float
    y_mm: float
    radius_mm: float

    @property
    def corners(self) -> Array:
        """Two opposite corners of the square around it, shape (2, 2)."""
        center = np.array([self.x_mm, self.y_mm])
        return np.stack([center - self.radius_mm, center + self.radius_mm])


@dataclass(frozen=True)
class Cross:
    """The mark of an axis: two lines of the same length that cross each other."""

    x_mm: float
    y_mm: float
    length_mm: float

    @property
    def lines(self) -> Array:
        """Both lines, shape (2, 2, 2): line, end, coordinate."""
        half = self.length_mm / 2.0
        arms = np.array([[[-half, 0.0], [half, 0.0]], [[0.0, -half], [0.0, half]]])
        return np.asarray(arms + np.array([self.x_mm, self.y_mm]))

    @property
    def corners(self) -> Array:
        """The ends of its lines, shape (4, 2)."""
        return self.lines.reshape(-1, 2)


Shape = Polyline | Circle | Cross

Layers = Mapping[Layer, tuple[Shape, ...]]


@dataclass(frozen=True, eq=False)
class Drawing:
    """A gear in its own frame, in the pose of phi1 = 0; ``notes`` are sentences about it."""

    name: str
    layers: Layers
    notes: tuple[str, ...]

    @property
    def cut(self) -> Drawing:
        """Only the closed contours that a workshop cuts, through or part of the way."""
        cuts = {layer: shapes for layer, shapes in self.layers.items() if layer.use is not Use.REFERENCE}
        return replace(self, layers=cuts)

    def moved(self, x_mm: float) -> Drawing:
        """The drawing, farther along x."""
        layers = {layer: tuple(_moved(shape, x_mm) for shape in shapes) for layer, shapes in self.layers.items()}
        return replace(self, layers=layers)


def _moved(shape: Shape, x_mm: float) -> Shape:
    if isinstance(shape, Polyline):
        return replace(shape, points=shape.points + np.array([x_mm, 0.0]))
    return replace(shape, x_mm=shape.x_mm + x_mm)


@dataclass(frozen=True, eq=False)
class PairDrawings:
    """Both gears in their own frames, the distance of their axes in mm, and sentences about the pair."""

    driving: Drawing
    driven: Drawing
    center_distance_mm: float
    notes: tuple[str, ...]


def decimals_for(drawings: Iterable[Drawing]) -> int:
    """The decimals that coordinates of drawings have in a file."""
    low, high = box_around(drawings)
    return max(DECIMALS, FINER - ceil(log10(float(np.max(high - low)))))


def box_around(drawings: Iterable[Drawing]) -> tuple[Array, Array]:
    """Lower left and upper right corner of the box around all shapes."""
    shapes = (shape for drawing in drawings for layer in drawing.layers.values() for shape in layer)
    corners = np.vstack([shape.corners for shape in shapes])
    return corners.min(axis=0), corners.max(axis=0)


CROSS_IN_MODULES = 2.0
"""Length in modules of the mark of an axis: it is inside the smallest bore of any shaft."""


def pair_drawings(drive: Drive) -> PairDrawings:
    """The drawings of a pair; raises the errors of the drive."""
    driving, driven = (gear_drawing(drive, gear) for gear in Gear)
    return PairDrawings(driving, driven, drive.pitch.center_distance_mm, tuple(pair_notes(drive)))


def gear_drawing(drive: Drive, gear: Gear) -> Drawing:
    """A gear in its own frame; raises the errors of the drive's solids."""
    plan = drive.solids.of(gear).plan
    curve = drive.pitch.of(gear)
    arcs = drive.tooth_arcs
    shapes = {
        **body_shapes(plan),
        **({} if arcs is None else {Layer.OUTLINE: (Polyline(arcs[gear].points_mm, arcs[gear].bulges),)}),
        Layer.PITCH_CURVE: (polygon(pitch_points(curve, plan.chord_tolerance_mm)),),
        Layer.AXIS: (Cross(0.0, 0.0, CROSS_IN_MODULES * drive.pitch.size.module_mm),),
    }
    layers = {layer: shapes[layer] for layer in Layer if shapes[layer]}
    return Drawing(gear.value, layers, gear_notes(drive, gear, plan))


def body_shapes(plan: BodyPlan) -> dict[Layer, tuple[Shape, ...]]:
    """All visible edges of a body from above, by their layers; some layers may be empty."""
    return {
        **_toothed(plan),
        Layer.BORE: () if plan.bore is None else (bore_shape(plan.bore),),
        Layer.CRANK_PIN: () if plan.crank_pin is None else (_circle(plan.crank_pin),),
        Layer.INDEX_HOLE: () if plan.index_hole is None else (_circle(plan.index_hole),),
        Layer.END_STOP: () if plan.slot is None else (Polyline(plan.slot.points, plan.slot.bulges),),
        Layer.LIGHTENING_HOLES: tuple(_circle(hole) for hole in plan.lightening_holes),
        Layer.POCKETS: () if plan.web is None else _contours(shapely.union_all(plan.web.pockets)),
        Layer.HUB: () if plan.hub is None else (Circle(0.0, 0.0, plan.hub.diameter_mm / 2.0),),
    }


def _toothed(plan: BodyPlan) -> dict[Layer, tuple[Shape, ...]]:
    """The teeth, and for a ring also the circle through the corners of its outer polygon."""
    outer = _points(plan.disc.exterior)
    if not plan.is_ring:
        return {Layer.OUTLINE: (polygon(outer),), Layer.RIM: ()}
    circle = Circle(0.0, 0.0, float(np.hypot(*outer.T).max()))
    return {Layer.OUTLINE: (polygon(_points(plan.disc.interiors[0])),), Layer.RIM: (circle,)}


def bore_shape(bore: Bore) -> Shape:
    """The circle of a bore; with a keyway, its three sides and two arcs of at most half a turn each."""
    radius = bore.diameter_mm / 2.0
    if bore.keyway is None:
        return Circle(0.0, 0.0, radius)
    half = bore.keyway.width_mm / 2.0
    side, turned = sqrt(radius**2 - half**2), pi - asin(half / radius)
    points = np.array([[side, half], [-radius, 0.0], [side, -half], [bore.reach_mm, -half], [bore.reach_mm, half]])
    return Polyline(points, np.array([tan(turned / 4.0), tan(turned / 4.0), 0.0, 0.0, 0.0]))


def _circle(hole: RoundHole) -> Circle:
    return Circle(hole.x_mm, hole.y_mm, hole.diameter_mm / 2.0)


def _contours(area: BaseGeometry) -> tuple[Shape, ...]:
    rings = [ring for part in polygons(area) for ring in (part.exterior, *part.interiors)]
    return tuple(polygon(_points(ring)) for ring in rings)


def _points(ring: BaseGeometry) -> Array:
    """A ring's points, first point not repeated."""
    return shapely.get_coordinates(ring)[:-1]


def pitch_points(curve: PitchCurve, tolerance_mm: float) -> Array:
    """Evenly spread points of a pitch curve, shape (n, 2); no chord is off the curve by more than the tolerance.

    Over an arc of length s, a chord is off by at most k s^2 / 8, with the largest curvature k.  For gears that turn
    less than once it is the sector of the range; its last point is the axis.
    """
    sharpest = max(abs(bound) for bound in curve.curvature_bounds)
    covered = curve.transmission.lobes.range
    if covered is None:
        count = ceil(curve.length_mm * sqrt(sharpest / (8.0 * tolerance_mm)))
        return curve.at_length(np.linspace(0.0, curve.length_mm, count, endpoint=False)).position
    end_mm = float(curve.arc.length(np.array([covered.driving_rad]))[0]) * curve.center_distance_mm
    count = ceil(end_mm * sqrt(sharpest / (8.0 * tolerance_mm))) + 1
    return np.vstack([curve.at_length(np.linspace(0.0, end_mm, count)).position, np.zeros((1, 2))])


def gear_notes(drive: Drive, gear: Gear, plan: BodyPlan) -> tuple[str, ...]:
    """Sentences about the gear, its scale and frame, and the facts that lines cannot show.

    These facts are the depth or height of shapes that are not cut through, the distance of the lines from the gear as
    designed, and the places where the body differs from the lines.
    """
    notes = [
        f"{drive.title}: {gear.value} gear",
        _scale(drive),
        "axis at the origin, upper face towards you, pose of phi1 = 0",
        f"module {drive.pitch.size.module_mm:.10g} mm, face width {plan.face_width_mm:g} mm",
    ]
    if plan.web:
        notes.append(f"POCKETS from the upper face down to {plan.web.thickness_mm:g} mm over the lower one")
    if plan.hub:
        notes.append(f"HUB {plan.hub.height_mm:g} mm over the upper face")
    if drive.helix is not None:
        notes.append("helical teeth: section at z = 0, not to be cut upright")
    if plan.clearance_mm > 0.0:
        notes.append(f"{plan.clearance_mm:g} mm taken off outline and bore for the process")
    if plan.clearance_mm < 0.0:
        kerf = f"a kerf of {-2.0 * plan.clearance_mm:g} mm"
        notes.append(f"for {kerf}: whatever is cut through is {-plan.clearance_mm:g} mm outside of the finished gear")
    if plan.chamfer_mm > 0.0:
        notes.append(f"lower edges bevelled by {plan.chamfer_mm:g} mm")
    return tuple(notes)


def pair_notes(drive: Drive) -> tuple[str, ...]:
    """Sentences about the drawing of both gears together, its scale and frame."""
    return (
        f"{drive.title}: both gears assembled at phi1 = 0",
        _scale(drive),
        f"driving axis at the origin, driven axis at x = {drawn(drive.pitch.center_distance_mm, 'mm')} mm",
    )


def _scale(drive: Drive) -> str:
    tolerance = drive.chord_tolerance_mm
    arcs = f"arcs of the teeth no farther than {CURVES_SHARE * tolerance:.4g} mm and " if drive.tooth_arcs else ""
    return f"1:1 in mm; {arcs}chords no farther than {tolerance:.4g} mm from the exact curve, round holes exact"
