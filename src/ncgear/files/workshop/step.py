"""The solids of a drive's gears with exact faces.

STEP (ISO 10303-21, AP 214) from solids, in mm: the same solids give the same bytes.

The proof, by reading it back, that a written STEP file still holds its solids.

STEP files of a pair: each gear in its own frame, and both as they go together at phi1 = 0.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from io import BytesIO

from OCP.APIHeaderSection import APIHeaderSection_MakeHeader
from OCP.BRepCheck import BRepCheck_Analyzer
from OCP.gp import gp_Trsf, gp_Vec
from OCP.IFSelect import IFSelect_ReturnStatus
from OCP.Interface import Interface_Static
from OCP.Message import Message, Message_Gravity
from OCP.STEPCAFControl import STEPCAFControl_Writer
from OCP.STEPControl import STEPControl_Controller, STEPControl_Reader
from OCP.StepData import StepData_StepModel
from OCP.StepRepr import StepRepr_NextAssemblyUsageOccurrence
from OCP.TCollection import TCollection_ExtendedString, TCollection_HAsciiString
from OCP.TDataStd import TDataStd_Name
from OCP.TDF import TDF_Label
from OCP.TDocStd import TDocStd_Document
from OCP.TopLoc import TopLoc_Location
from OCP.TopoDS import TopoDS_Shape
from OCP.XCAFDoc import XCAFDoc_DocumentTool, XCAFDoc_ShapeTool

from ncgear.design.keys.gears import Gears
from ncgear.errors import WrongInput
from ncgear.extras import require
from ncgear.pitch.shape import Gear
from ncgear.project.drive import Drive
from ncgear.project.gear_solids import rim_mm_of
from ncgear.solids.brep.gear import gear_shape, helical_gear_shape, ring_shape
from ncgear.solids.brep.shapes import faces_of, solids_of, volume_mm3
from ncgear.solids.helical.helix import Helix
from ncgear.solids.helical.patches import patches_of
from ncgear.solids.helical.sections import Sections
from ncgear.solids.mesh.ring import outer_radius_mm
from ncgear.teeth.contour import contour_of

SHARE = 0.1
"""Of the chord tolerance, which faces may stray from the exact ones: even where the working flanks of an outline get
the least share of it, 0.15, the faces are the closer ones, so that gears made of them miss the law no more."""


@dataclass(frozen=True, eq=False)
class Solid:
    """A gear's solid in its own frame, and how far its tooth faces were found from the exact ones at most."""

    shape: TopoDS_Shape
    deviation_mm: float


def solids_of_drive(drive: Drive) -> dict[Gear, Solid]:
    """Both gears; raises as the teeth's contact does, and WrongInput for helical teeth that do not go up smoothly."""
    drive.require_sound_teeth()
    if drive.helix is None:
        return {gear: _straight(drive, gear) for gear in Gear}
    sections = Sections(drive.pitch, drive.tooth_form, drive.helix, drive.design.output.chord_tolerance_mm)
    return {gear: _helical(drive, sections, drive.helix, gear) for gear in Gear}


def _straight(drive: Drive, gear: Gear) -> Solid:
    own = drive.teeth.of(gear)
    contour = contour_of(own, SHARE * drive.design.output.chord_tolerance_mm)
    plan = drive.solids.of(gear).plan
    if gear is Gear.DRIVING or not drive.pitch.driven.is_ring:
        return Solid(gear_shape(contour, plan), contour.deviation_mm)
    radius = outer_radius_mm(own.outline_mm, rim_mm_of(drive.gears, drive.pitch.size.module_mm))
    return Solid(ring_shape(contour, plan, radius), contour.deviation_mm)


def _helical(drive: Drive, sections: Sections, helix: Helix, gear: Gear) -> Solid:
    patches = patches_of(sections, gear, SHARE * drive.design.output.chord_tolerance_mm)
    shape = helical_gear_shape(patches, drive.solids.of(gear).plan, herringbone=helix.herringbone)
    return Solid(shape, patches.deviation_mm)


TIMESTAMP = "1970-01-01T00:00:00"
"""Of every file: the same design gives the same bytes, whenever it is built."""

SETTINGS = {
    # Curves on surfaces follow from the curves in space; with them files are twice as large.
    "write.surfacecurve.mode": 0,
}


@dataclass(frozen=True, eq=False)
class Part:
    """A solid, its name, and how far along x its axis stands in the file."""

    name: str
    shape: TopoDS_Shape
    x_mm: float = 0.0


def part_bytes(part: Part, description: str) -> bytes:
    """A file of one product."""
    document, shapes = _document()
    _named(shapes.AddShape(part.shape, False), part.name)
    return _written(document, part.name, description)


def assembly_bytes(name: str, parts: Sequence[Part], description: str) -> bytes:
    """A file of one product that consists of the parts, each at its place."""
    document, shapes = _document()
    whole = _named(shapes.NewShape(), name)
    for part in parts:
        own = _named(shapes.AddShape(part.shape, False), part.name)
        _named(shapes.AddComponent(whole, own, _moved(part.x_mm)), part.name)
    shapes.UpdateAssemblies()
    return _written(document, name, description)


def _document() -> tuple[TDocStd_Document, XCAFDoc_ShapeTool]:
    """An empty document; the tool that fills it lives no longer than the document."""
    document = TDocStd_Document(TCollection_ExtendedString("BinXCAF"))
    return document, XCAFDoc_DocumentTool.ShapeTool_s(document.Main())


def _named(label: TDF_Label, name: str) -> TDF_Label:
    TDataStd_Name.Set_s(label, TCollection_ExtendedString(name))
    return label


def _moved(x_mm: float) -> TopLoc_Location:
    move = gp_Trsf()
    move.SetTranslation(gp_Vec(x_mm, 0.0, 0.0))
    return TopLoc_Location(move)


def _written(document: TDocStd_Document, name: str, description: str) -> bytes:
    """The document as a file; raises RuntimeError, a fault of ncgear, when the kernel cannot write it."""
    be_quiet()
    STEPControl_Controller.Init_s()
    for key, value in SETTINGS.items():
        Interface_Static.SetIVal_s(key, value)
    writer = STEPCAFControl_Writer()
    if not writer.Transfer(document):
        raise RuntimeError(f"{name} cannot be put into a STEP file")
    _reproducible(writer.ChangeWriter().Model(), name, description)
    stream = BytesIO()
    if writer.WriteStream(stream) != IFSelect_ReturnStatus.IFSelect_RetDone:
        raise RuntimeError(f"the STEP file of {name} was not written")
    return stream.getvalue()


def be_quiet() -> None:
    """Keep the kernel's reports of what it does off the terminal; its alarms still come."""
    for printer in Message.DefaultMessenger_s().Printers():
        printer.SetTraceLevel(Message_Gravity.Message_Alarm)


def _reproducible(model: StepData_StepModel, name: str, description: str) -> None:
    """A header without clock and machine, and components numbered by name, not by how many this process has made."""
    for number in range(1, model.NbEntities() + 1):
        entity = model.Entity(number)
        if isinstance(entity, StepRepr_NextAssemblyUsageOccurrence):
            entity.SetId(entity.Name())
    header = APIHeaderSection_MakeHeader(model)
    header.SetName(_text(name))
    header.SetTimeStamp(_text(TIMESTAMP))
    header.SetAuthorValue(1, _text(""))
    header.SetOrganizationValue(1, _text(""))
    header.SetAuthorisation(_text(""))
    header.SetOriginatingSystem(_text("ncgear"))
    header.SetDescriptionValue(1, _text(description))
    header.Apply(model)


def _text(words: str) -> TCollection_HAsciiString:
    return TCollection_HAsciiString(words)


VOLUME_TOLERANCE = 2e-5
"""Relative difference allowed between a solid and the same one read back: the kernel's integrals are no better, since
it finds the edges of faces anew (tests/test_step.py holds them against sections); faces are counted."""


def require_same(data: bytes, shapes: Sequence[TopoDS_Shape]) -> None:
    """Raise RuntimeError, a fault of ncgear, unless a file holds valid solids with faces and volumes of ``shapes``."""
    whole = _read(data)
    if not BRepCheck_Analyzer(whole).IsValid():
        raise RuntimeError("a STEP file holds solids that are not valid")
    for shape, found in zip(shapes, solids_of(whole), strict=True):
        _require_alike(shape, found)


def _read(data: bytes) -> TopoDS_Shape:
    reader = STEPControl_Reader()
    if reader.ReadStream("step", BytesIO(data)) != IFSelect_ReturnStatus.IFSelect_RetDone:
        raise RuntimeError("a STEP file cannot be read back")
    reader.TransferRoots()
    return reader.OneShape()


def _require_alike(shape: TopoDS_Shape, found: TopoDS_Shape) -> None:
    faces, faces_found = (len(faces_of(one)) for one in (shape, found))
    volume, volume_found = volume_mm3(shape), volume_mm3(found)
    if faces != faces_found or not abs(volume_found - volume) <= VOLUME_TOLERANCE * volume:
        raise RuntimeError(
            f"a STEP file holds {faces_found} faces about {volume_found:.9g} mm3, not {faces} about {volume:.9g} mm3"
        )


def step_files(drive: Drive) -> dict[str, bytes]:
    """``driving.step``, ``driven.step`` and ``pair.step`` by their names, read back and found the same.

    Raises WrongInput when the library is not installed, and for what only meshes have: a chamfer, a clearance, helical
    teeth that do not go up smoothly.
    """
    require("OCP", "step", "--format step")
    _refuse_what_only_meshes_have(drive.gears)

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
