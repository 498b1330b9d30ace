"""A gear's body as a workshop describes it: wishes, material and cuts; all lengths in mm.

Every solid and every drawing is made from a ``BodyPlan``, in the gear's own frame: axis along z through the origin,
lower face at z = 0, pose of phi1 = 0.

- ``disc``: section of the toothed part at z = 0 before anything is cut; its exterior is the tooth outline (of a ring:
  its circle, and the one interior is the tooth outline), already moved inwards by the clearance for the process, or
  outwards by half a kerf.
- through cuts: ``bore`` with its keyway (enlarged by the clearance), ``index_hole``, ``lightening_holes``: circles, and
  for a keyway ``bore_points``; ``slot`` and ``crank_pin``, a hole (enlarged as the bore is); all narrower by a kerf.
- ``web``: pockets from the upper face down to the web, as polygons; a pocket's floor is at ``web.thickness_mm``.
- ``hub``: a cylinder about the axis on the upper face; the bore goes through it, and its radial ``set_screw`` hole goes
  from one side down to the bore.
- ``chamfer_mm``: the bevel of all edges of the face at z = 0, whose section there is moved inwards by it.

The disc of helical teeth is their section at z = 0 only; everything else is the same at every height.
"""

from __future__ import annotations

from dataclasses import replace
from functools import cached_property
from math import acos, asin, ceil, cos, hypot, pi, sin, tan

import numpy as np
import shapely
from shapely import Polygon
from shapely.geometry.base import BaseGeometry

from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array
from ncgear.solids.plan.areas import area_moments

FEWEST_CHORDS = 24
"""Least number of chords of a full circle at any tolerance, so that a small bore still looks round."""

KG_MM3 = 1e-9
"""One kg/m3 in kg/mm3."""


@dataclass(frozen=True)
class Keyway:
    """A keyway cut along +x of the gear's frame; ``depth_mm`` counts from the bore's circle at the keyway's middle."""

    width_mm: float
    depth_mm: float


@dataclass(frozen=True)
class Bore:
    """A bore on the gear's axis; raises ValueError for a keyway that is no narrower than the bore."""

    diameter_mm: float
    keyway: Keyway | None = None

    def __post_init__(self) -> None:
        if self.keyway is not None and self.keyway.width_mm >= self.diameter_mm:
            raise ValueError(f"a keyway of {self.keyway.width_mm} mm in a bore of {self.diameter_mm} mm")

    @property
    def reach_mm(self) -> float:
        """Distance from the axis to the keyway's floor, or to the bore's circle where there is no keyway."""
        return self.diameter_mm / 2.0 + (self.keyway.depth_mm if self.keyway else 0.0)

    @property
    def farthest_mm(self) -> float:
        """Distance from the axis to the farthest corner of the keyway, or to the circle where there is none."""
        return hypot(self.reach_mm, self.keyway.width_mm / 2.0) if self.keyway else self.reach_mm

    def widened(self, distance_mm: float) -> Bore:
        """The bore with its circle and all sides of its keyway moved outwards by a distance."""
        keyway = replace(self.keyway, width_mm=self.keyway.width_mm + 2.0 * distance_mm) if self.keyway else None
        return Bore(self.diameter_mm + 2.0 * distance_mm, keyway)


@dataclass(frozen=True)
class SetScrew:
    """A radial hole from a hub's side to the bore: its axis at ``height_mm`` over z = 0, at a polar angle."""

    diameter_mm: float
    height_mm: float
    direction_rad: float


@dataclass(frozen=True)
class Hub:
    """A cylinder about the axis, ``height_mm`` high over the upper face."""

    diameter_mm: float
    height_mm: float
    set_screw: SetScrew | None = None


@dataclass(frozen=True)
class WebSize:
    """A web under pockets: its thickness, the least wall to the tooth roots, the diameter left about the axis."""

    thickness_mm: float
    rim_mm: float
    hub_mm: float


@dataclass(frozen=True)
class HoleSet:
    """Round holes of one diameter evenly about the axis, with their least wall to every edge and to each other.

    Where no diameter is given, the holes are as large as possible.
    """

    count: int
    wall_mm: float
    diameter_mm: float | None = None


@dataclass(frozen=True)
class EndStop:
    """A pin in the frame, in an arc slot of a gear that turns by ``turned_rad``, counter-clockwise where positive.

    The slot is wider than the pin by ``clearance_mm`` and shorter, so that its ends still meet the pin exactly at both
    ends of the turn.
    """

    pin_mm: float
    radius_mm: float
    clearance_mm: float
    turned_rad: float

    @property
    def width_mm(self) -> float:
        """The width of the slot."""
        return self.pin_mm + self.clearance_mm

    def pin_rad(self, middle_rad: float) -> float:
        """Polar angle of the pin in the frame, for a slot about ``middle_rad`` in the pose of phi1 = 0."""
        return middle_rad + self.turned_rad / 2.0

    def slot(self, middle_rad: float) -> ArcSlot:
        """The slot about a polar angle in the gear's frame; its round ends touch the pin at both ends of the turn."""
        beyond = 2.0 * asin(self.clearance_mm / 4.0 / self.radius_mm)
        half = abs(self.turned_rad) / 2.0 - beyond
        return ArcSlot(self.radius_mm, self.width_mm, middle_rad - half, middle_rad + half)


@dataclass(frozen=True)
class ArcSlot:
    """A through slot along an arc about the gear's axis; its round ends are centred at ``low_rad`` and ``high_rad``."""

    radius_mm: float
    width_mm: float
    low_rad: float
    high_rad: float

    @property
    def points(self) -> Array:
        """Starts of its six arcs, shape (6, 2), counter-clockwise; each long side is two arcs."""
        half, middle = self.width_mm / 2.0, (self.low_rad + self.high_rad) / 2.0
        radii = self.radius_mm + half * np.array([1.0, 1.0, 1.0, -1.0, -1.0, -1.0])
        angles = np.array([self.low_rad, middle, self.high_rad, self.high_rad, middle, self.low_rad])
        return np.asarray(radii[:, None] * np.column_stack([np.cos(angles), np.sin(angles)]))

    @property
    def bulges(self) -> Array:
        """For each arc the tangent of a quarter of its angle, positive counter-clockwise."""
        along = tan((self.high_rad - self.low_rad) / 8.0)
        return np.array([along, along, 1.0, -along, -along, 1.0])

    def widened(self, distance_mm: float) -> ArcSlot:
        """The slot with all its sides moved outwards by a distance."""
        return replace(self, width_mm=self.width_mm + 2.0 * distance_mm)


@dataclass(frozen=True)
class Blank:
    """The wishes for a gear's body beside its teeth, whether there is room for them or not.

    The process wants outline and bore moved into the material by ``clearance_mm``. A negative clearance is half a kerf:
    then all cuts through the gear are moved out of the material.  ``chamfer_mm`` is the bevel of the lower edges.
    """

    face_width_mm: float
    bore: Bore | None = None
    index_hole: bool = False
    hub: Hub | None = None
    web: WebSize | None = None
    holes: HoleSet | None = None
    end_stop: EndStop | None = None
    crank_pin: RoundHole | None = None
    chamfer_mm: float = 0.0
    clearance_mm: float = 0.0


@dataclass(frozen=True)
class RingBlank:
    """The wishes for a ring beside its teeth: face width, rim, index hole; chamfer and clearance as in ``Blank``."""

    face_width_mm: float
    rim_mm: float
    index_hole: bool = False
    chamfer_mm: float = 0.0
    clearance_mm: float = 0.0


@dataclass(frozen=True)
class RoundHole:
    """A round through hole, parallel to the gear's axis; centre in the gear's own frame."""

    x_mm: float
    y_mm: float
    diameter_mm: float


@dataclass(frozen=True, eq=False)
class Web:
    """The material between z = 0 and ``thickness_mm`` under pockets that are open to the upper face."""

    thickness_mm: float
    pockets: tuple[Polygon, ...]


@dataclass(frozen=True, eq=False)
class Slab:
    """A part of a body with the same section (one or more polygons) from one height to another."""

    section: BaseGeometry
    low_mm: float
    high_mm: float

    @property
    def thickness_mm(self) -> float:
        """Distance from the lower to the upper face."""
        return self.high_mm - self.low_mm


@dataclass(frozen=True, eq=False)
class BodyPlan:
    """One gear's body; see the module.

    Curves become polygons whose chords stay within ``chord_tolerance_mm``.  Outline and bore have already been moved by
    ``clearance_mm``, which is minus half the kerf where a cutter follows the lines.  ``pin_mm`` is the centre of the
    pin that stands in the slot, in the pose of phi1 = 0.
    """

    disc: Polygon
    face_width_mm: float
    chord_tolerance_mm: float
    bore: Bore | None = None
    index_hole: RoundHole | None = None
    lightening_holes: tuple[RoundHole, ...] = ()
    hub: Hub | None = None
    web: Web | None = None
    chamfer_mm: float = 0.0
    clearance_mm: float = 0.0
    slot: ArcSlot | None = None
    pin_mm: tuple[float, float] | None = None
    crank_pin: RoundHole | None = None

    @property
    def round_holes(self) -> tuple[RoundHole, ...]:
        """All round through holes beside the axis."""
        return (*(hole for hole in (self.crank_pin, self.index_hole) if hole is not None), *self.lightening_holes)

    @property
    def is_ring(self) -> bool:
        """Whether the teeth point inwards."""
        return len(self.disc.interiors) > 0

    @property
    def height_mm(self) -> float:
        """Height of the top of the hub, or of the upper face where there is no hub."""
        return self.face_width_mm + (self.hub.height_mm if self.hub else 0.0)

    @property
    def is_plate(self) -> bool:
        """Whether the body has the same section at every height."""
        return self.hub is None and self.web is None and self.chamfer_mm == 0.0

    @cached_property
    def section(self) -> Polygon:
        """The section under all pockets: the disc less bore, keyway, round holes and slot."""
        holes = [hole_points(hole, self.chord_tolerance_mm) for hole in self.round_holes]
        holes += [slot_points(self.slot, self.chord_tolerance_mm)] if self.slot else []
        around_axis = [self.bore_polygon.exterior] if self.bore else []
        return Polygon(self.disc.exterior, [*self.disc.interiors, *around_axis, *holes])

    @cached_property
    def slabs(self) -> tuple[Slab, ...]:
        """The body from the bottom up, without chamfer and set screw; each slab lies within the slab below it."""
        top = self.face_width_mm
        if self.web is None:
            parts = [Slab(self.section, 0.0, top)]
        else:
            around = self.section.difference(shapely.union_all(self.web.pockets))
            parts = [Slab(self.section, 0.0, self.web.thickness_mm), Slab(around, self.web.thickness_mm, top)]
        if self.hub is not None:
            circle = Polygon(circle_points(self.hub.diameter_mm / 2.0, self.chord_tolerance_mm))
            parts.append(Slab(circle.difference(self.bore_polygon), top, self.height_mm))
        return tuple(parts)

    @cached_property
    def bore_polygon(self) -> Polygon:
        """The bore with its keyway; empty where there is none."""
        return Polygon(bore_points(self.bore, self.chord_tolerance_mm)) if self.bore else Polygon()


def body_kg_mm2(plan: BodyPlan, density_kg_m3: float) -> float:
    """Moment of inertia about the axis, by slabs, without chamfer and set screw; helical teeth by their z = 0."""
    polar = (slab.thickness_mm * area_moments(slab.section).polar_mm4 for slab in plan.slabs)
    return KG_MM3 * density_kg_m3 * sum(polar)


HOLE_CHORDS_MM, SMALL_MM = 0.0025, 1.0
"""Largest distance of a hole's points from its circle, and the diameter below which it shrinks in proportion.  The
narrowest fit that a file may give, H6 up to 3 mm, allows a diameter 0.006 mm greater and none smaller; small holes
shrink it in proportion.  Polygons of solids keep this fit too."""


def bore_points(bore: Bore, chord_tolerance_mm: float) -> Array:
    """The bore's polygon in mm, shape (n, 2), counter-clockwise, first point not repeated.

    A shaft that fits the circle fits the polygon: its chords touch the circle or stay off it, and its points stand off
    it by ``chord_tolerance_mm``, or by HOLE_CHORDS_MM where that is less.
    """
    tolerance_mm = min(chord_tolerance_mm, HOLE_CHORDS_MM * min(1.0, bore.diameter_mm / SMALL_MM))
    radius = bore.diameter_mm / 2.0 + tolerance_mm
    if bore.keyway is None:
        return circle_points(radius, tolerance_mm)
    half_width = bore.keyway.width_mm / 2.0
    start = asin(half_width / radius)
    floor = np.array([[bore.reach_mm, -half_width], [bore.reach_mm, half_width]])
    return np.concatenate([_arc(radius, start, 2.0 * pi - start, tolerance_mm), floor])


def hole_points(hole: RoundHole, chord_tolerance_mm: float) -> Array:
    """The hole's polygon in mm, like ``bore_points``."""
    return np.array([hole.x_mm, hole.y_mm]) + bore_points(Bore(hole.diameter_mm), chord_tolerance_mm)


def slot_points(slot: ArcSlot, chord_tolerance_mm: float) -> Array:
    """The slot's polygon in mm, with its points on the arcs."""
    half = slot.width_mm / 2.0

    def end(angle: float, start: float) -> Array:
        center = slot.radius_mm * np.array([cos(angle), sin(angle)])
        return np.asarray(center + _arc(half, start, start + pi, chord_tolerance_mm)[1:-1])

    outer = _arc(slot.radius_mm + half, slot.low_rad, slot.high_rad, chord_tolerance_mm)
    inner = _arc(slot.radius_mm - half, slot.low_rad, slot.high_rad, chord_tolerance_mm)[::-1]
    return np.concatenate([outer, end(slot.high_rad, slot.high_rad), inner, end(slot.low_rad, slot.low_rad + pi)])


def circle_points(radius_mm: float, chord_tolerance_mm: float) -> Array:
    """A circle about the origin as a polygon in mm; its points lie on the circle, its chords within the tolerance."""
    return _arc(radius_mm, 0.0, 2.0 * pi, chord_tolerance_mm)[:-1]


def _arc(radius: float, start: float, end: float, tolerance: float) -> Array:
    """Points of an arc, both ends included: a chord that spans 2 t misses the circle by radius (1 - cos t)."""
    widest = 2.0 * acos(max(1.0 - tolerance / radius, 0.0))
    chords = ceil((end - start) / min(widest, 2.0 * pi / FEWEST_CHORDS))
    angle = np.linspace(start, end, chords + 1)
    return radius * np.column_stack([np.cos(angle), np.sin(angle)])
