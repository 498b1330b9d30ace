"""A gear's body as a workshop describes it: what stands, and what is cut; every solid and every drawing is made of it.

All lengths in mm in the gear's own frame: axis along z through the origin, lower face at z = 0, pose of phi1 = 0.

- ``disc``: section of the toothed part at z = 0 before anything is cut; its exterior is the tooth outline (of a ring:
  its circle, and the one interior is the tooth outline), already moved inwards by the clearance for the process.
- through cuts: ``bore`` with its keyway (enlarged by the clearance), ``index_hole``, ``lightening_holes``: circles, and
  for a keyway ``bore_points``.
- ``web``: pockets from the upper face down to the web, as polygons; a pocket's floor is at ``web.thickness_mm``.
- ``hub``: a cylinder about the axis on the upper face; the bore goes through it, and so does from one side, down to the
  bore, its radial ``set_screw`` hole.
- ``chamfer_mm``: the bevel of all edges of the face at z = 0, whose section there is moved inwards by it.

Of helical teeth the disc is the section at z = 0 alone; all else is the same at every height.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import shapely
from shapely import Polygon
from shapely.geometry.base import BaseGeometry

from ncgear.solids.bore import Bore, bore_points, circle_points
from ncgear.solids.round_hole import RoundHole, hole_points


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


@dataclass(frozen=True, eq=False)
class Web:
    """What is left between z = 0 and ``thickness_mm`` under pockets that are open to the upper face."""

    thickness_mm: float
    pockets: tuple[Polygon, ...]


@dataclass(frozen=True, eq=False)
class Layer:
    """A part of a body that has one section from a height to another; polygons, one or more."""

    section: BaseGeometry
    low_mm: float
    high_mm: float

    @property
    def thickness_mm(self) -> float:
        """How high it is."""
        return self.high_mm - self.low_mm


@dataclass(frozen=True, eq=False)
class BodyPlan:
    """One gear's body; see the module.

    Curves become polygons whose chords stay within ``chord_tolerance_mm``.  ``clearance_mm`` is what outline and bore
    have been moved by already.
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

    @property
    def round_holes(self) -> tuple[RoundHole, ...]:
        """All round through holes beside the axis."""
        return (*([self.index_hole] if self.index_hole else []), *self.lightening_holes)

    @property
    def is_ring(self) -> bool:
        """Whether the teeth point inwards."""
        return len(self.disc.interiors) > 0

    @property
    def height_mm(self) -> float:
        """From z = 0 to the top of the hub, or to the upper face."""
        return self.face_width_mm + (self.hub.height_mm if self.hub else 0.0)

    @property
    def is_plate(self) -> bool:
        """Whether one section goes all the way up."""
        return self.hub is None and self.web is None and self.chamfer_mm == 0.0

    @cached_property
    def bore_polygon(self) -> Polygon:
        """The bore with its keyway; empty where there is none."""
        return Polygon(bore_points(self.bore, self.chord_tolerance_mm)) if self.bore else Polygon()

    @cached_property
    def section(self) -> Polygon:
        """The section under all pockets: the disc less bore, keyway and round holes."""
        holes = [hole_points(hole, self.chord_tolerance_mm) for hole in self.round_holes]
        around_axis = [self.bore_polygon.exterior] if self.bore else []
        return Polygon(self.disc.exterior, [*self.disc.interiors, *around_axis, *holes])

    @cached_property
    def layers(self) -> tuple[Layer, ...]:
        """From the bottom up, without chamfer and set screw."""
        top = self.face_width_mm
        if self.web is None:
            parts = [Layer(self.section, 0.0, top)]
        else:
            around = self.section.difference(shapely.union_all(self.web.pockets))
            parts = [Layer(self.section, 0.0, self.web.thickness_mm), Layer(around, self.web.thickness_mm, top)]
        if self.hub is not None:
            circle = Polygon(circle_points(self.hub.diameter_mm / 2.0, self.chord_tolerance_mm))
            parts.append(Layer(circle.difference(self.bore_polygon), top, self.height_mm))
        return tuple(parts)
