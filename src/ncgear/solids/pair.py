"""Both gears of a pair as solids, with the marks that show how they go together."""

from __future__ import annotations

from dataclasses import dataclass

from trimesh import Trimesh

from ncgear.numerics.arrays import Array
from ncgear.pitch.shape import Gear, Mesh, meeting_direction_rad
from ncgear.solids.bore import Bore
from ncgear.solids.extrude import extruded
from ncgear.solids.index_hole import IndexHole, index_hole
from ncgear.solids.section import cut, disc_with_room


@dataclass(frozen=True)
class Blank:
    """What makes a tooth outline a body: face width, bore, and whether an index hole is wanted."""

    face_width_mm: float
    bore: Bore | None = None
    index_hole: bool = False


@dataclass(frozen=True, eq=False)
class GearSolid:
    """One gear's mesh in its own frame at phi1 = 0, and its index hole where one was wanted and had room."""

    mesh: Trimesh
    index_hole: IndexHole | None

    def __repr__(self) -> str:
        size = " x ".join(f"{length:.4g}" for length in self.mesh.extents)
        mark = "with" if self.index_hole else "no"
        return f"GearSolid({size} mm, {len(self.mesh.faces)} triangles, {mark} index hole)"


@dataclass(frozen=True, eq=False)
class SolidPair:
    """The solids of a pair."""

    driving: GearSolid
    driven: GearSolid

    def __repr__(self) -> str:
        return f"SolidPair(\n  driving: {self.driving!r},\n  driven: {self.driven!r})"


def driving_solid(
    outline_mm: Array, blank: Blank, module_mm: float, chord_tolerance_mm: float, mesh: Mesh = Mesh.EXTERNAL
) -> GearSolid:
    """The driving gear, with its index hole if wanted; raises as ``gear_solid`` does."""
    direction = meeting_direction_rad(Gear.DRIVING, mesh)
    return _marked(outline_mm, blank, module_mm, chord_tolerance_mm, direction, "gears.driving")


def driven_solid(outline_mm: Array, blank: Blank, module_mm: float, chord_tolerance_mm: float) -> GearSolid:
    """The driven gear of an external pair, with its index hole if wanted; raises as ``gear_solid`` does."""
    direction = meeting_direction_rad(Gear.DRIVEN, Mesh.EXTERNAL)
    return _marked(outline_mm, blank, module_mm, chord_tolerance_mm, direction, "gears.driven")


def _marked(outline: Array, blank: Blank, module: float, tolerance: float, direction: float, key: str) -> GearSolid:
    disc = disc_with_room(outline, blank.bore, tolerance, key)
    mark = index_hole(disc, blank.bore, direction, module) if blank.index_hole else None
    return GearSolid(extruded(cut(disc, blank.bore, mark, tolerance), blank.face_width_mm), mark)
