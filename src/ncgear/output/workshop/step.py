"""STEP files of a pair: each gear in its own frame, and both as they go together at phi1 = 0."""

from __future__ import annotations

from ncgear.design.gears import Gears
from ncgear.drive import Drive
from ncgear.errors import WrongInput
from ncgear.extras import require
from ncgear.pitch.shape import Gear


def step_files(drive: Drive) -> dict[str, bytes]:
    """``driving.step``, ``driven.step`` and ``pair.step`` by their names, read back and found the same.

    Raises WrongInput when the library is not installed, and for what only meshes have: a chamfer, a clearance, helical
    teeth that do not go up smoothly.
    """
    require("OCP", "step", "--format step")
    _refuse_what_only_meshes_have(drive.gears)
    from ncgear.output.workshop.step_document import Part, assembly_bytes, part_bytes
    from ncgear.output.workshop.step_read import require_same
    from ncgear.output.workshop.step_shapes import solids_of_drive

    solids = solids_of_drive(drive)
    title = drive.design.name if drive.stage is None else f"{drive.design.name}-stage-{drive.stage}"
    words = _description(title, max(solid.deviation_mm for solid in solids.values()))
    place = {Gear.DRIVING: 0.0, Gear.DRIVEN: drive.pitch.center_distance_mm}
    files = {f"{gear.value}.step": part_bytes(Part(gear.value, solids[gear].shape), words) for gear in Gear}
    parts = [Part(gear.value, solids[gear].shape, place[gear]) for gear in Gear]
    files["pair.step"] = assembly_bytes(title, parts, words)
    require_same(files["pair.step"], [part.shape for part in parts])
    return files


def _refuse_what_only_meshes_have(gears: Gears) -> None:
    for name, given in {
        "first_layer_chamfer_mm": gears.first_layer_chamfer_mm > 0.0,
        "process_clearance_mm": gears.process_clearance_mm > 0.0,
    }.items():
        if given:
            problem = "given, but STEP files have no bevel and no clearance for a print; leave it out for --format step"
            raise WrongInput(problem, key=f"gears.{name}")


def _description(title: str, deviation_mm: float) -> str:
    """What the header says of the files: how far faces were found from the exact ones."""
    return f"{title}: tooth faces within {deviation_mm:.1e} mm of the exact ones"
