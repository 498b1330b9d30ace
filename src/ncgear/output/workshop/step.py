"""STEP files of a pair: each gear in its own frame, and both as they go together at phi1 = 0."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ncgear.drive import Drive
from ncgear.errors import NoSuchMechanism
from ncgear.extras import require
from ncgear.pitch.shape import Gear
from ncgear.recipe.gears import bore_of, rim_mm_of
from ncgear.solids.ring import outer_radius_mm
from ncgear.teeth.contour import Contour, contour_of

if TYPE_CHECKING:
    from OCP.TopoDS import TopoDS_Shape

SHARE = 0.1
"""Of the chord tolerance, which faces may stray from the exact ones: even where the working flanks of an outline get
the least share of it, 0.15, the faces are the closer ones, so that gears made of them miss the law no more."""


def step_files(drive: Drive) -> dict[str, bytes]:
    """``driving.step``, ``driven.step`` and ``pair.step`` by their names.

    Raises WrongInput when the library is not installed, NoSuchMechanism for helical teeth.
    """
    require("OCP", "step", "--format step")
    if drive.helix is not None:
        raise NoSuchMechanism(
            "helical teeth are not made as STEP, only as meshes; STL and 3MF have them", key="gears.helix"
        )
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


def _contour(drive: Drive, gear: Gear) -> Contour:
    teeth = drive.sound_teeth
    own = teeth.driving if gear is Gear.DRIVING else teeth.driven
    return contour_of(own, SHARE * drive.design.output.chord_tolerance_mm)


def _shape(drive: Drive, gear: Gear, contour: Contour) -> TopoDS_Shape:
    from ncgear.solids.brep.gear import gear_shape, ring_shape

    gears, solids = drive.gears, drive.solids
    width = gears.face_width_mm
    if gear is Gear.DRIVING:
        return gear_shape(contour, width, bore_of(gears.driving), solids.driving.index_hole)
    if not drive.pitch.driven.is_ring:
        return gear_shape(contour, width, bore_of(gears.driven), solids.driven.index_hole)
    radius = outer_radius_mm(drive.teeth.driven.outline_mm, rim_mm_of(gears, drive.pitch.size.module_mm))
    return ring_shape(contour, width, radius, solids.driven.index_hole)


def _description(drive: Drive, contours: dict[Gear, Contour]) -> str:
    """What the header says of the files: how far faces were found from the exact ones."""
    most = max(contour.deviation_mm for contour in contours.values())
    return f"{drive.design.name}: tooth faces within {most:.1e} mm of the exact ones"
