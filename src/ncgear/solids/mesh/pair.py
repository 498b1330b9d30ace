"""The gears of a pair with straight teeth as solids, each with its plan: pockets, the hub and its set screw as well.

The manifold library makes unions and differences in double precision.  The volume of the result is compared with the
volume of its parts.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import cached_property
from itertools import pairwise
from typing import TYPE_CHECKING

import manifold3d
import numpy as np
import shapely
from shapely import Polygon
from shapely.affinity import rotate
from shapely.geometry.base import BaseGeometry

from ncgear.errors import Unanswered
from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array, distinct
from ncgear.pitch.shape import Gear, Mesh, meeting_direction_rad
from ncgear.shown import Shown
from ncgear.solids.mesh.slabs import VOLUME_TOLERANCE, bevel_of, require_sound, slab_mesh
from ncgear.solids.mesh.triangles import TriangleMesh, merged
from ncgear.solids.plan.body import Blank, BodyPlan, RingBlank, RoundHole, SetScrew, Slab, circle_points
from ncgear.solids.plan.plan import planned, planned_ring

if TYPE_CHECKING:
    from trimesh import Trimesh

SCREW_TOLERANCE = 1e-6
"""Relative difference allowed between the volume of a screw hole and the quadrature of its sections; the quadrature
errs at the hub's corners (tests/test_bodies.py)."""

GAUSS_POINTS = 8
"""Points of the quadrature between the heights of two corners of the hole's polygon."""

LEVEL_DIGITS = 9
"""Decimals to which heights of the hole's corners, relative to the greatest, must agree to count as one height."""


def finished(toothed: TriangleMesh, plan: BodyPlan) -> TriangleMesh:
    """A toothed mesh with the plan's pockets, hub and set screw; raises Unanswered if the mesh is not sound."""
    if plan.is_plate:
        return toothed
    solid, volume = _solid_of(toothed), toothed.volume
    if plan.web is not None:
        floor, top = plan.web.thickness_mm, plan.face_width_mm
        for pocket in plan.web.pockets:
            # The prism goes on beyond the upper face, so that no two faces coincide.
            solid -= _solid_of(slab_mesh((Slab(pocket, floor, 2.0 * top - floor),)))
            volume -= pocket.intersection(plan.section).area * (top - floor)
    if plan.hub is not None:
        hub = plan.slabs[-1]
        # The hub begins within the gear, so that both share a volume and not just a face.
        solid += _solid_of(slab_mesh((Slab(hub.section, plan.face_width_mm / 2.0, hub.high_mm),)))
        volume += hub.section.area * hub.thickness_mm
    made = _mesh_of(solid)
    require_sound(made, volume, VOLUME_TOLERANCE)
    return drilled_hub(made, plan)


def drilled_hub(mesh: TriangleMesh, plan: BodyPlan) -> TriangleMesh:
    """The gear with the hole of its set screw; raises Unanswered if the mesh is not sound."""
    hub = plan.hub
    if hub is None or hub.set_screw is None:
        return mesh
    drill = _drill(hub.set_screw, hub.diameter_mm, plan.chord_tolerance_mm)
    made = _mesh_of(_solid_of(mesh) - _solid_of(drill))
    taken = screw_hole_mm3(plan.slabs[-1].section, hub.set_screw, plan.chord_tolerance_mm)
    whole = mesh.volume
    require_sound(made, whole - taken, SCREW_TOLERANCE * taken / whole)
    return made


def _drill(screw: SetScrew, reach: float, tolerance: float) -> TriangleMesh:
    """A cylinder along the screw, from the axis to beyond the hub."""
    round_hole = Polygon(circle_points(screw.diameter_mm / 2.0, tolerance))
    upright = slab_mesh((Slab(round_hole, 0.0, reach),))
    along = np.array([np.cos(screw.direction_rad), np.sin(screw.direction_rad), 0.0])
    axes = np.array([[-along[1], along[0], 0.0], [0.0, 0.0, 1.0], along])
    return TriangleMesh(upright.vertices @ axes + [0.0, 0.0, screw.height_mm], upright.faces)


def screw_hole_mm3(section: BaseGeometry, screw: SetScrew, tolerance_mm: float) -> float:
    """Volume that a screw hole takes out of a hub's section; both are polygons, integrated over the height."""
    reach = 2.0 * float(np.abs(section.bounds).max())
    turned = rotate(section, -screw.direction_rad, origin=(0.0, 0.0), use_radians=True)
    strips = _strips(circle_points(screw.diameter_mm / 2.0, tolerance_mm))
    return sum(
        weight * float(turned.intersection(shapely.box(0.0, low, reach, high)).area) for low, high, weight in strips
    )


def _strips(ring: Array) -> Iterator[tuple[float, float, float]]:
    """Ends of the line across a convex ring (n, 2) at each Gauss point of its height, with the point's weight."""
    nodes, weights = np.polynomial.legendre.leggauss(GAUSS_POINTS)
    start, end = ring, np.roll(ring, -1, axis=0)
    top = float(np.abs(ring[:, 1]).max())
    for low, high in pairwise(top * distinct(np.round(ring[:, 1] / top, LEVEL_DIGITS))):
        half = (high - low) / 2.0
        for height, weight in zip(low + half * (1.0 + nodes), half * weights, strict=True):
            crossing = (start[:, 1] > height) != (end[:, 1] > height)
            (x0, y0), (x1, y1) = start[crossing].T, end[crossing].T
            across = x0 + (x1 - x0) * (height - y0) / (y1 - y0)
            yield float(across.min()), float(across.max()), float(weight)


def _solid_of(mesh: TriangleMesh) -> manifold3d.Manifold:
    """A mesh for booleans, in double precision; raises Unanswered where it is no closed solid."""
    solid = manifold3d.Manifold(manifold3d.Mesh64(mesh.vertices, mesh.faces.astype(np.uint64)))
    if solid.status() != manifold3d.Error.NoError:
        raise Unanswered(f"a gear's mesh is no solid: {solid.status()}")
    return solid


def _mesh_of(solid: manifold3d.Manifold) -> TriangleMesh:
    made = solid.to_mesh64()
    points: Array = np.asarray(made.vert_properties)[:, :3]
    return merged(points, np.asarray(made.tri_verts).astype(np.int64))


CHAMFER_KEY = "gears.first_layer_chamfer_mm"


@dataclass(frozen=True, eq=False)
class GearSolid(Shown):
    """One gear's triangles in its own frame at phi1 = 0, and the gear's plan."""

    triangles: TriangleMesh
    plan: BodyPlan

    @cached_property
    def mesh(self) -> Trimesh:
        """The solid in mm as a mesh of trimesh, which is loaded when it is first asked for."""
        return self.triangles.as_trimesh()

    @property
    def index_hole(self) -> RoundHole | None:
        """The index hole; None where none was asked for or none had room."""
        return self.plan.index_hole

    def __repr__(self) -> str:
        size = " x ".join(f"{length:.4g}" for length in self.triangles.extents)
        mark = "with" if self.index_hole else "no"
        return f"GearSolid({size} mm, {len(self.triangles.faces)} triangles, {mark} index hole)"


@dataclass(frozen=True, eq=False)
class SolidPair(Shown):
    """The solids of a pair."""

    driving: GearSolid
    driven: GearSolid

    def of(self, gear: Gear) -> GearSolid:
        """The solid of one gear."""
        return self.driving if gear is Gear.DRIVING else self.driven

    def __repr__(self) -> str:
        return f"SolidPair(\n  driving: {self.driving!r},\n  driven: {self.driven!r})"


def gear_solid(
    gear: Gear, outline_mm: Array, blank: Blank, module_mm: float, chord_tolerance_mm: float, mesh: Mesh = Mesh.EXTERNAL
) -> GearSolid:
    """A gear, not a ring, with everything that its blank asks for; raises as ``planned`` and ``solid_of_plan`` do."""
    return solid_of_plan(gear_plan(gear, outline_mm, blank, module_mm, chord_tolerance_mm, mesh))


def gear_plan(
    gear: Gear, outline_mm: Array, blank: Blank, module_mm: float, chord_tolerance_mm: float, mesh: Mesh = Mesh.EXTERNAL
) -> BodyPlan:
    """The body of a gear that is not a ring; raises as ``planned`` does."""
    direction, key = meeting_direction_rad(gear, mesh), f"gears.{gear.value}"
    return planned(outline_mm, blank, direction, module_mm, chord_tolerance_mm, key)


def ring_solid(outline_mm: Array, blank: RingBlank, module_mm: float, chord_tolerance_mm: float) -> GearSolid:
    """The driven ring of an internal pair; raises as ``planned_ring`` and ``solid_of_plan`` do."""
    return solid_of_plan(planned_ring(outline_mm, blank, module_mm, chord_tolerance_mm))


def solid_of_plan(plan: BodyPlan) -> GearSolid:
    """The solid of straight teeth; raises WrongInput for a chamfer too large, Unanswered if the mesh is not sound."""
    bevel = bevel_of(plan.section, plan.chamfer_mm, plan.chord_tolerance_mm, CHAMFER_KEY) if plan.chamfer_mm else None
    return GearSolid(drilled_hub(slab_mesh(plan.slabs, bevel), plan), plan)
