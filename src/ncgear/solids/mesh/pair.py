"""The gears of a pair with straight teeth as solids, each with its plan."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING

from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array
from ncgear.pitch.shape import Gear, Mesh, meeting_direction_rad
from ncgear.shown import Shown
from ncgear.solids.mesh.finish import drilled_hub
from ncgear.solids.mesh.slabs import bevel_of, slab_mesh
from ncgear.solids.mesh.triangles import TriangleMesh
from ncgear.solids.plan.body import Blank, BodyPlan, RingBlank, RoundHole
from ncgear.solids.plan.plan import planned, planned_ring

if TYPE_CHECKING:
    from trimesh import Trimesh

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
    gear: Gear,
    outline_mm: Array,
    blank: Blank,
    module_mm: float,
    chord_tolerance_mm: float,
    mesh: Mesh = Mesh.EXTERNAL,
) -> GearSolid:
    """A gear, not a ring, with everything that its blank asks for; raises as ``planned`` and ``solid_of_plan`` do."""
    return solid_of_plan(gear_plan(gear, outline_mm, blank, module_mm, chord_tolerance_mm, mesh))


def gear_plan(
    gear: Gear,
    outline_mm: Array,
    blank: Blank,
    module_mm: float,
    chord_tolerance_mm: float,
    mesh: Mesh = Mesh.EXTERNAL,
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
