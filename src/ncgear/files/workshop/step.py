"""STEP files of a pair: each gear in its own frame, and both assembled at phi1 = 0.

The library that makes them is optional, and is loaded only when these files are asked for.
"""

from __future__ import annotations

from ncgear.errors import WrongInput
from ncgear.extras import require
from ncgear.pitch.shape import Gear
from ncgear.project.drive import Drive

ONLY_MESHES = "given, but STEP files have no bevel and no clearance for a process; leave it out for --format step"

LEAST_MODULE_MM = 0.01
"""Least module of teeth in STEP files: the kernel and whoever reads such files take points within 1e-7 mm as one."""


def step_files(drive: Drive) -> dict[str, bytes]:
    """``driving.step``, ``driven.step`` and ``pair.step`` by their names; each was read back and found the same.

    Raises WrongInput when the library is not installed, and for shapes that only meshes have: a chamfer, a clearance,
    helical teeth that do not change smoothly with height, teeth of
    less than ``LEAST_MODULE_MM``.
    """
    require("OCP", "step", "--format step")
    if drive.pitch.size.module_mm < LEAST_MODULE_MM:
        raise WrongInput(
            f"the module of {drive.pitch.size.module_mm:.4g} mm is too small for STEP files, in which points within "
            f"1e-07 mm are one; {LEAST_MODULE_MM:g} mm or more, or other formats than step, are right",
            key="gears.module_mm",
        )
    if drive.gears.first_layer_chamfer_mm > 0.0:
        raise WrongInput(ONLY_MESHES, key="gears.first_layer_chamfer_mm")
    if drive.gears.process_clearance_mm != 0.0:
        raise WrongInput(ONLY_MESHES, key="gears.process_clearance_mm")
    from ncgear.files.workshop.step_kernel import Part, assembly_bytes, part_bytes, require_same, solids_of_drive

    solids = solids_of_drive(drive)
    title = drive.design.name if drive.stage is None else f"{drive.design.name}-stage-{drive.stage}"
    deviation_mm = max(solid.deviation_mm for solid in solids.values())
    words = f"{title}: tooth faces within {deviation_mm:.1e} mm of the exact ones"
    place = {Gear.DRIVING: 0.0, Gear.DRIVEN: drive.pitch.center_distance_mm}
    files = {f"{gear.value}.step": part_bytes(Part(gear.value, solids[gear].shape), words) for gear in Gear}
    parts = [Part(gear.value, solids[gear].shape, place[gear]) for gear in Gear]
    files["pair.step"] = assembly_bytes(title, parts, words)
    require_same(files["pair.step"], [part.shape for part in parts])
    return files
