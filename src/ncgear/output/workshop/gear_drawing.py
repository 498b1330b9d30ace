"""The drawings of a pair of gears, from the plans of their bodies."""

from __future__ import annotations

from math import asin, ceil, pi, sqrt, tan

import numpy as np
import shapely
from shapely import Polygon
from shapely.geometry.base import BaseGeometry

from ncgear.drive import Drive
from ncgear.numerics.arrays import Array
from ncgear.output.workshop.drawing import Circle, Contour, Cross, Drawing, Layer, Shape, polygon
from ncgear.output.workshop.notes import gear_notes
from ncgear.pitch.curve import PitchCurve
from ncgear.pitch.shape import Gear
from ncgear.solids.body import BodyPlan
from ncgear.solids.bore import Bore
from ncgear.solids.round_hole import RoundHole

CROSS_IN_MODULES = 2.0
"""Length of an axis' mark: it stays within the smallest bore that a shaft goes through."""


def gear_drawing(drive: Drive, gear: Gear) -> Drawing:
    """A gear in its own frame; raises as the drive's stages do."""
    plan = drive.solids.of(gear).plan
    curve = drive.pitch.of(gear)
    shapes = {
        **body_shapes(plan),
        Layer.PITCH_CURVE: (polygon(pitch_points(curve, plan.chord_tolerance_mm)),),
        Layer.AXIS: (Cross(0.0, 0.0, CROSS_IN_MODULES * drive.pitch.size.module_mm),),
    }
    layers = {layer: shapes[layer] for layer in Layer if shapes[layer]}
    return Drawing(gear.value, layers, gear_notes(drive, gear, plan))


def body_shapes(plan: BodyPlan) -> dict[Layer, tuple[Shape, ...]]:
    """All edges of a body that are seen from above, by their layers; none on some."""
    return {
        **_toothed(plan),
        Layer.BORE: () if plan.bore is None else (_bore(plan.bore),),
        Layer.INDEX_HOLE: () if plan.index_hole is None else (_circle(plan.index_hole),),
        Layer.LIGHTENING_HOLES: tuple(_circle(hole) for hole in plan.lightening_holes),
        Layer.POCKETS: () if plan.web is None else _contours(shapely.union_all(plan.web.pockets)),
        Layer.HUB: () if plan.hub is None else (Circle(0.0, 0.0, plan.hub.diameter_mm / 2.0),),
    }


def _toothed(plan: BodyPlan) -> dict[Layer, tuple[Shape, ...]]:
    """The teeth; of a ring, the circle too on which the corners of its polygon lie."""
    outer = _points(plan.disc.exterior)
    if not plan.is_ring:
        return {Layer.OUTLINE: (polygon(outer),), Layer.RIM: ()}
    circle = Circle(0.0, 0.0, float(np.hypot(*outer.T).max()))
    return {Layer.OUTLINE: (polygon(_points(plan.disc.interiors[0])),), Layer.RIM: (circle,)}


def _bore(bore: Bore) -> Shape:
    """The circle or, with a keyway, the three sides of the keyway and two arcs, neither over half a turn."""
    radius = bore.diameter_mm / 2.0
    if bore.keyway is None:
        return Circle(0.0, 0.0, radius)
    half = bore.keyway.width_mm / 2.0
    side, turned = sqrt(radius**2 - half**2), pi - asin(half / radius)
    points = np.array([[side, half], [-radius, 0.0], [side, -half], [bore.reach_mm, -half], [bore.reach_mm, half]])
    return Contour(points, np.array([tan(turned / 4.0), tan(turned / 4.0), 0.0, 0.0, 0.0]))


def _circle(hole: RoundHole) -> Circle:
    return Circle(hole.x_mm, hole.y_mm, hole.diameter_mm / 2.0)


def _contours(area: BaseGeometry) -> tuple[Shape, ...]:
    """All boundaries of an area."""
    parts = [part for part in shapely.get_parts(area) if isinstance(part, Polygon)]
    return tuple(polygon(_points(ring)) for part in parts for ring in (part.exterior, *part.interiors))


def _points(ring: BaseGeometry) -> Array:
    """A ring's points, first point not repeated."""
    points: Array = shapely.get_coordinates(ring)[:-1]
    return points


def pitch_points(curve: PitchCurve, tolerance_mm: float) -> Array:
    """Points of a pitch curve, shape (n, 2), evenly spread, so that no chord strays from it by more than a tolerance.

    Over an arc of length s, a chord strays by k s^2 / 8 at most, k being the largest curvature.
    """
    sharpest = max(abs(bound) for bound in curve.curvature_bounds)
    count = ceil(curve.length_mm * sqrt(sharpest / (8.0 * tolerance_mm)))
    return curve.at_length(np.linspace(0.0, curve.length_mm, count, endpoint=False)).position
