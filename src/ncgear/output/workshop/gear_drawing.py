"""The drawings of a pair of gears, from the plans of their bodies."""

from __future__ import annotations

from math import asin, pi, tan

import numpy as np
import shapely
from shapely import Polygon
from shapely.geometry.base import BaseGeometry

from ncgear.drive import Drive
from ncgear.numerics.arrays import Array
from ncgear.output.workshop.drawing import Circle, Contour, Cross, Drawing, Layer, Shape, polygon
from ncgear.pitch.curve import PitchCurve
from ncgear.pitch.shape import Gear
from ncgear.solids.body import BodyPlan
from ncgear.solids.bore import Bore

CROSS_IN_MODULES = 2.0
"""Length of an axis' mark: it stays within the smallest bore that a shaft goes through."""

PITCH_POINTS_PER_TOOTH = 24
"""Points of a pitch curve in a drawing, where it is a help line: within a thousandth of a module of the curve."""


def gear_drawing(drive: Drive, gear: Gear) -> Drawing:
    """A gear in its own frame; raises as the drive's stages do."""
    plan = (drive.solids.driving if gear is Gear.DRIVING else drive.solids.driven).plan
    module = drive.pitch.size.module_mm
    curve = drive.pitch.driving if gear is Gear.DRIVING else drive.pitch.driven
    shapes: dict[Layer, tuple[Shape, ...]] = {
        Layer.OUTLINE: _outline(plan, ring=gear is Gear.DRIVEN and curve.is_ring),
        Layer.BORE: () if plan.bore is None else (_bore(plan.bore),),
        Layer.HOLES: tuple(Circle(hole.x_mm, hole.y_mm, hole.diameter_mm / 2.0) for hole in plan.round_holes),
        Layer.POCKETS: () if plan.web is None else _contours(shapely.union_all(plan.web.pockets)),
        Layer.HUB: () if plan.hub is None else (Circle(0.0, 0.0, plan.hub.diameter_mm / 2.0),),
        Layer.PITCH_CURVE: (polygon(_pitch_points(curve, _teeth(drive, gear))),),
        Layer.AXIS: (Cross(0.0, 0.0, CROSS_IN_MODULES * module),),
    }
    return Drawing(gear.value, {name: found for name, found in shapes.items() if found}, _notes(drive, plan, gear))


def pair_drawings(drive: Drive) -> tuple[Drawing, Drawing]:
    """Both gears as they go together at phi1 = 0: the driven one at the centre distance."""
    driving, driven = (gear_drawing(drive, gear) for gear in Gear)
    return driving, driven.moved(drive.pitch.center_distance_mm)


def _outline(plan: BodyPlan, *, ring: bool) -> tuple[Shape, ...]:
    """The teeth; of a ring, its circle too."""
    if not ring:
        return (polygon(_points(plan.disc.exterior)),)
    radius = float(np.hypot(*_points(plan.disc.exterior).T).max())
    return polygon(_points(plan.disc.interiors[0])), Circle(0.0, 0.0, radius)


def _bore(bore: Bore) -> Shape:
    """The circle or, with a keyway, its arc and the three sides of the keyway."""
    radius = bore.diameter_mm / 2.0
    if bore.keyway is None:
        return Circle(0.0, 0.0, radius)
    half, start = bore.keyway.width_mm / 2.0, asin(bore.keyway.width_mm / bore.diameter_mm)
    side = np.sqrt(radius**2 - half**2)
    points = np.array([[side, half], [side, -half], [bore.reach_mm, -half], [bore.reach_mm, half]])
    return Contour(points, np.array([tan((2.0 * pi - 2.0 * start) / 4.0), 0.0, 0.0, 0.0]))


def _contours(area: BaseGeometry) -> tuple[Shape, ...]:
    """All boundaries of an area."""
    parts = [part for part in shapely.get_parts(area) if isinstance(part, Polygon)]
    return tuple(polygon(_points(ring)) for part in parts for ring in (part.exterior, *part.interiors))


def _points(ring: BaseGeometry) -> Array:
    """A ring's points, first point not repeated."""
    points: Array = shapely.get_coordinates(ring)[:-1]
    return points


def _pitch_points(curve: PitchCurve, teeth: int) -> Array:
    count = PITCH_POINTS_PER_TOOTH * teeth
    return curve.at_angle(np.linspace(0.0, curve.turn_rad, count, endpoint=False)).position


def _notes(drive: Drive, plan: BodyPlan, gear: Gear) -> tuple[str, ...]:
    tolerance = plan.chord_tolerance_mm
    name = drive.design.name if drive.stage is None else f"{drive.design.name}, stage {drive.stage}"
    notes = [
        f"{name}: {gear.value} gear, in mm, axis at the origin",
        f"module {drive.pitch.size.module_mm:.10g} mm, face width {plan.face_width_mm:g} mm",
        f"outline in lines, no farther than {tolerance:g} mm from the exact curve; round holes exact",
    ]
    if drive.helix is not None:
        notes.append("helical teeth: section at z = 0")
    if plan.clearance_mm > 0.0:
        notes.append(f"{plan.clearance_mm:g} mm taken off outline and bore for the process")
    return tuple(notes)


def _teeth(drive: Drive, gear: Gear) -> int:
    size = drive.pitch.size
    return size.driving_teeth if gear is Gear.DRIVING else size.driven_teeth
