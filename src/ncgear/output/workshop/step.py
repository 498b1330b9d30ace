"""STEP files of a pair: each gear in its own frame, and both as they go together at phi1 = 0."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ncgear.design.gears import Gears
from ncgear.drive import Drive
from ncgear.errors import WrongInput
from ncgear.extras import require
from ncgear.pitch.shape import Gear
from ncgear.recipe.bodies import rim_mm_of
from ncgear.solids.ring import outer_radius_mm
from ncgear.teeth.contour import Contour, contour_of

if TYPE_CHECKING:
    from OCP.TopoDS import TopoDS_Shape

SHARE = 0.1
"""Of the chord tolerance, which faces may stray from the exact ones: even where the working flanks of an outline get
the least share of it, 0.15, the faces are the closer ones, so that gears made of them miss the law no more."""


def step_files(drive: Drive) -> dict[str, bytes]:
    """``driving.step``, ``driven.step`` and ``pair.step`` by their names.

    Raises WrongInput when the library is not installed, and for helical teeth, chamfer and clearance: only meshes have
    them.
    """
    require("OCP", "step", "--format step")
    _refuse_what_only_meshes_have(drive.gears)
    from ncgear.output.workshop.step_document import Part, assembly_bytes, part_bytes
    from ncgear.output.workshop.step_read import require_same

    contours = {gear: _contour(drive, gear) for gear in Gear}
    shapes = {gear: _shape(drive, gear, contours[gear]) for gear in Gear}
    place = {Gear.DRIVING: 0.0, Gear.DRIVEN: drive.pitch.center_distance_mm}
    parts = [Part(gear.value, shapes[gear], place[gear]) for gear in Gear]
    words = _description(drive, contours)
    files = {f"{gear.value}.step": part_bytes(Part(gear.value, shapes[gear]), words) for gear in Gear}
    files["pair.step"] = assembly_bytes(drive.design.name, parts, words)
    require_same(files["pair.step"], [shapes[gear] for gear in Gear])
    return files


def _refuse_what_only_meshes_have(gears: Gears) -> None:
    for name, given in {
        "helix": gears.helix is not None,
        "first_layer_chamfer_mm": gears.first_layer_chamfer_mm > 0.0,
        "process_clearance_mm": gears.process_clearance_mm > 0.0,
    }.items():
        if given:
            problem = "given, but only meshes are made so; formats stl and 3mf have it, and without it there is STEP"
            raise WrongInput(problem, key=f"gears.{name}")


def _contour(drive: Drive, gear: Gear) -> Contour:
    teeth = drive.sound_teeth
    own = teeth.driving if gear is Gear.DRIVING else teeth.driven
    return contour_of(own, SHARE * drive.design.output.chord_tolerance_mm)


def _shape(drive: Drive, gear: Gear, contour: Contour) -> TopoDS_Shape:
    from ncgear.solids.brep.gear import gear_shape, ring_shape

    plan = (drive.solids.driving if gear is Gear.DRIVING else drive.solids.driven).plan
    if gear is Gear.DRIVING or not drive.pitch.driven.is_ring:
        return gear_shape(contour, plan)
    rim = rim_mm_of(drive.gears, drive.pitch.size.module_mm)
    return ring_shape(contour, plan, outer_radius_mm(drive.teeth.driven.outline_mm, rim))


def _description(drive: Drive, contours: dict[Gear, Contour]) -> str:
    """What the header says of the files: how far faces were found from the exact ones."""
    most = max(contour.deviation_mm for contour in contours.values())
    return f"{drive.design.name}: tooth faces within {most:.1e} mm of the exact ones"
