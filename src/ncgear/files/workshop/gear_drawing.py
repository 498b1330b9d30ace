"""A gear as a flat drawing: the plan of its body from above, in the gear's own frame and in the pose of phi1 = 0.

Its notes tell the facts that lines cannot show, so that a workshop needs no other paper.
"""

from __future__ import annotations

from math import asin, ceil, pi, sqrt, tan

import numpy as np
import shapely
from shapely.geometry.base import BaseGeometry

from ncgear.figures.numbers import drawn
from ncgear.files.workshop.drawing import Circle, Cross, Drawing, Layer, PairDrawings, Polyline, Shape, polygon
from ncgear.numerics.arrays import Array
from ncgear.pitch.curve import PitchCurve
from ncgear.pitch.shape import Gear
from ncgear.project.drive import Drive
from ncgear.solids.plan.areas import polygons
from ncgear.solids.plan.body import BodyPlan, Bore, RoundHole
from ncgear.teeth.contour import CURVES_SHARE

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
    """All boundaries of an area."""
    rings = [ring for part in polygons(area) for ring in (part.exterior, *part.interiors)]
    return tuple(polygon(_points(ring)) for ring in rings)


def _points(ring: BaseGeometry) -> Array:
    """A ring's points, first point not repeated."""
    points: Array = shapely.get_coordinates(ring)[:-1]
    return points


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
