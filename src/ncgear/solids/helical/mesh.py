"""Helical and herringbone gears as closed meshes: sections lofted into a wall, with straight holes from end to end.

Each quadrilateral between two sections is folded along its shorter diagonal.  On a round body the shorter diagonal
stays nearer to the surface.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array, IndexArray, distinct
from ncgear.numerics.plane import signed_area
from ncgear.pitch.pair import PitchPair
from ncgear.pitch.shape import Gear, Mesh, meeting_direction_rad
from ncgear.solids.helical.helix import Helix
from ncgear.solids.helical.sections import Sections
from ncgear.solids.helical.stack import OUTLINE, Stack, close_stacks, falls, middle_section
from ncgear.solids.mesh.pair import GearSolid, SolidPair, finished
from ncgear.solids.mesh.slabs import VOLUME_TOLERANCE, filling, require_sound
from ncgear.solids.mesh.triangles import TriangleMesh, with_used_vertices
from ncgear.solids.plan.areas import stl_resolution_mm
from ncgear.solids.plan.body import Blank, BodyPlan, bore_points, hole_points
from ncgear.solids.plan.plan import planned_within
from ncgear.solids.plan.room import common_disc, full_disc
from ncgear.teeth.form import ToothForm


def helical_pair(
    pitch: PitchPair, form: ToothForm, helix: Helix, blanks: dict[Gear, Blank], tolerance_mm: float
) -> SolidPair:
    """Both gears as meshes that stray from the exact surfaces by no more than the chord tolerance.

    Raises NoSuchMechanism, naming the height, where a section cannot be made or changes too abruptly with height;
    WrongInput when a bore does not fit into every section, or when too many sections would be needed.
    """
    sections = Sections(pitch, form, helix, OUTLINE * tolerance_mm)
    stacks = close_stacks(sections, tolerance_mm)
    solids = {gear: _solid(sections, stacks[gear], gear, blanks[gear], tolerance_mm) for gear in Gear}
    return SolidPair(solids[Gear.DRIVING], solids[Gear.DRIVEN])


def _solid(sections: Sections, stack: Stack, gear: Gear, blank: Blank, tolerance: float) -> GearSolid:
    """A gear's mesh; bore, holes and pockets keep their walls in every section."""
    outlines = [pieces.points_mm[:-1] for pieces in sections.pieces(gear, stack.heights_mm)]
    plan = planned_through(outlines, gear, blank, sections.form.rack.module_mm, tolerance)
    holes = [bore_points(plan.bore, tolerance)] if plan.bore is not None else []
    holes += [hole_points(hole, tolerance) for hole in plan.round_holes]
    rings, heights = stack.counter_clockwise(), stack.heights_mm
    if sections.helix.herringbone:
        rings = np.concatenate([rings, rings[-2::-1]])
        heights = np.concatenate([heights, sections.helix.face_width_mm - heights[-2::-1]])
    return GearSolid(finished(lofted(rings, heights, holes), plan), plan)


def planned_through(
    outlines_mm: Sequence[Array], gear: Gear, blank: Blank, module_mm: float, tolerance_mm: float
) -> BodyPlan:
    """The plan of a gear with the first of its sections' outlines; what is cut out leaves its walls in all of them."""
    key, direction = f"gears.{gear.value}", meeting_direction_rad(gear, Mesh.EXTERNAL)
    room = common_disc(outlines_mm, key)
    return planned_within(full_disc(outlines_mm[0], key), room, blank, direction, module_mm, tolerance_mm, key)


def lofted(rings_mm: Array, heights_mm: Array, holes_mm: Sequence[Array]) -> TriangleMesh:
    """The solid through rings (l, c, 2) at rising heights (l,), with holes (n, 2) along z, all counter-clockwise.

    Neighbouring points of a ring become one where single precision cannot tell them apart.  Raises Unanswered if the
    mesh is not sound.
    """
    tubes = [_tube(rings_mm, heights_mm, 0)]
    for hole in holes_mm:
        tubes.append(_tube(np.stack([hole[::-1]] * 2), heights_mm[[0, -1]], tubes[-1].first + tubes[-1].column.size))
    faces = np.concatenate([*(tube.faces() for tube in tubes), _cap(tubes, 0)[:, ::-1], _cap(tubes, -1)])
    proper = np.all(faces != np.roll(faces, 1, axis=1), axis=1)
    mesh = with_used_vertices(TriangleMesh(np.concatenate([tube.vertices for tube in tubes]), faces[proper]))
    require_sound(mesh, sum(tube.volume_mm3 for tube in tubes), VOLUME_TOLERANCE)
    return mesh


@dataclass(frozen=True, eq=False)
class _Tube:
    """A wall through rings (l, c, 2) at heights (l,); the material is on the left when one follows a ring.

    ``column`` (l, c) is the vertex of its ring that stands for each point: points that coincide share one vertex.
    Vertices are numbered from ``first`` on.
    """

    rings: Array
    heights: Array
    column: IndexArray
    first: int

    @property
    def vertices(self) -> Array:
        """Shape (l c, 3)."""
        height = np.broadcast_to(self.heights[:, None, None], (*self.rings.shape[:2], 1))
        return np.concatenate([self.rings, height], axis=2).reshape(-1, 3)

    @property
    def numbers(self) -> IndexArray:
        """Vertex of each point, shape (l, c)."""
        layers, columns = self.column.shape
        return np.asarray(self.first + columns * np.arange(layers)[:, None] + self.column)

    @property
    def volume_mm3(self) -> float:
        """Volume inside, negative for a hole, by Simpson's rule, exact for areas quadratic in height."""
        lower, upper = self.rings[:-1], self.rings[1:]
        mean = (signed_area(lower) + 4.0 * signed_area(middle_section(lower, upper)) + signed_area(upper)) / 6.0
        return float(np.sum(mean * np.diff(self.heights)))

    def faces(self) -> IndexArray:
        """Two triangles for each quadrilateral, shape (2 (l - 1) c, 3)."""
        lower, upper = self.numbers[:-1], self.numbers[1:]
        lower_next, upper_next = np.roll(lower, -1, axis=1), np.roll(upper, -1, axis=1)
        falling = falls(self.rings[:-1], self.rings[1:])
        first = np.stack([lower, lower_next, np.where(falling, upper, upper_next)], axis=-1)
        second = np.stack([np.where(falling, lower_next, lower), upper_next, upper], axis=-1)
        return np.concatenate([first.reshape(-1, 3), second.reshape(-1, 3)])


def _tube(rings: Array, heights: Array, first: int) -> _Tube:
    """The tube; neighbouring points of a ring are merged where the single precision of STL files makes them equal."""
    distinct = np.linalg.norm(rings - np.roll(rings, 1, axis=1), axis=2) > stl_resolution_mm(rings)
    column = np.maximum.accumulate(np.where(distinct, np.arange(rings.shape[1]), -1), axis=1)
    # Points before the first distinct point belong to the last point of the ring.
    column = np.where(column < 0, column[:, -1:], column)
    return _Tube(np.take_along_axis(rings, column[..., None], axis=1), heights, column, first)


def _cap(tubes: Sequence[_Tube], layer: int) -> IndexArray:
    """Triangles that fill the section between the rings of one layer, counter-clockwise seen from above."""
    kept = [distinct(tube.column[layer]) for tube in tubes]
    points = np.concatenate([tube.rings[layer, own] for tube, own in zip(tubes, kept, strict=True)])
    vertex = np.concatenate([tube.numbers[layer, own] for tube, own in zip(tubes, kept, strict=True)])
    corners = filling(points, np.cumsum([own.size for own in kept]))
    return np.asarray(vertex[corners if np.sum(signed_area(points[corners])) > 0.0 else corners[:, ::-1]])
