"""STEP files (ISO 10303-21, AP 214) of a pair in mm: each gear in its own frame, and both assembled at phi1 = 0.

OpenCASCADE makes them, an optional library that is loaded with this module.  The same solids give the same
bytes.
"""

from __future__ import annotations

from collections.abc import Sequence
from io import BytesIO

import numpy as np
from OCP.APIHeaderSection import APIHeaderSection_MakeHeader
from OCP.BRepCheck import BRepCheck_Analyzer
from OCP.gp import gp_Vec
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
from OCP.TopoDS import TopoDS_Shape
from OCP.XCAFDoc import XCAFDoc_DocumentTool, XCAFDoc_ShapeTool

from ncgear.errors import Unanswered, WrongInput
from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array
from ncgear.pitch.curve import PitchCurve
from ncgear.pitch.shape import Gear
from ncgear.project.drive import Drive
from ncgear.project.gear_solids import rim_mm_of
from ncgear.solids.brep.gear import (
    faces_of,
    gear_shape,
    helical_gear_shape,
    moved_by,
    ring_shape,
    solids_of,
    volume_mm3,
)
from ncgear.solids.helical.helix import Helix
from ncgear.solids.helical.patches import patches_of
from ncgear.solids.helical.sections import Sections
from ncgear.solids.plan.plan import outer_radius_mm
from ncgear.teeth.contour import CURVES_SHARE, DEGREE, SPANS, Spline, contour_of

ONLY_MESHES = (
    "given, but solids with exact faces, as in STEP files, have no bevel and no clearance for a process; leave it out"
)

LEAST_MODULE_MM = 0.01
"""Least module of teeth with exact faces: the kernel and CAD programs take points within 1e-7 mm as one point."""

ExactSolid = tuple[TopoDS_Shape, float]
"""A gear's solid in its own frame, and the largest distance found between its tooth faces and the exact faces."""


def exact_solids(drive: Drive) -> dict[Gear, ExactSolid]:
    """The solids of both gears.

    Raises the errors of the teeth's contact, and WrongInput for shapes that only meshes have: a chamfer, a clearance,
    helical teeth that do not change smoothly with height, teeth of less than ``LEAST_MODULE_MM``.
    """
    if drive.pitch.size.module_mm < LEAST_MODULE_MM:
        raise WrongInput(
            f"the module of {drive.pitch.size.module_mm:.4g} mm is too small for exact faces, in which points within "
            f"1e-07 mm are one; {LEAST_MODULE_MM:g} mm or more, or other formats than step, are right",
            key="gears.module_mm",
        )
    if drive.gears.first_layer_chamfer_mm > 0.0:
        raise WrongInput(ONLY_MESHES, key="gears.first_layer_chamfer_mm")
    if drive.gears.process_clearance_mm != 0.0:
        raise WrongInput(ONLY_MESHES, key="gears.process_clearance_mm")
    drive.require_sound_teeth()
    if drive.helix is None:
        return {gear: _straight(drive, gear) for gear in Gear}
    sections = Sections(drive.pitch, drive.tooth_form, drive.helix, drive.chord_tolerance_mm)
    return {gear: _helical(drive, sections, drive.helix, gear) for gear in Gear}


def _straight(drive: Drive, gear: Gear) -> ExactSolid:
    own = drive.teeth.of(gear)
    contour = contour_of(own, CURVES_SHARE * drive.chord_tolerance_mm)
    plan = drive.solids.of(gear).plan
    if gear is Gear.DRIVING or not drive.pitch.driven.is_ring:
        return gear_shape(contour, plan), contour.deviation_mm
    radius = outer_radius_mm(own.outline_mm, rim_mm_of(drive.gears, drive.pitch.size.module_mm))
    return ring_shape(contour, plan, radius), contour.deviation_mm


def _helical(drive: Drive, sections: Sections, helix: Helix, gear: Gear) -> ExactSolid:
    patches = patches_of(sections, gear, CURVES_SHARE * drive.chord_tolerance_mm)
    shape = helical_gear_shape(patches, drive.solids.of(gear).plan, herringbone=helix.herringbone)
    return shape, patches.deviation_mm


PROBES = np.array([0.25, 0.5, 0.75])
"""Shares of each span at which a spline is compared with the curve; its error is largest near the middle."""


def pitch_spline(curve: PitchCurve, tolerance_mm: float) -> Spline:
    """A pitch curve as a cubic B-spline by arc length, with equal tangents on both sides of each knot.

    It passes through exact points along exact tangents.  No point at PROBES is further from the curve than the
    tolerance; joints of the law are knots.  For gears that turn less than once it covers the range of turning.  Raises
    Unanswered where even the largest number of spans does not follow the curve.
    """
    ends, covered = curve.panels_mm, curve.transmission.lobes.range
    if covered is not None:
        end = float(curve.arc.length(np.array([covered.driving_rad]))[0]) * curve.center_distance_mm
        ends = np.append(ends[ends < end], end)
    for spans in (1, *SPANS):
        share = np.arange(spans) / spans
        knots = np.append((ends[:-1, None] + np.diff(ends)[:, None] * share).ravel(), ends[-1])
        spline = _through(curve, knots)
        if _missed_mm(curve, knots, spline) <= tolerance_mm:
            return spline
    raise Unanswered(f"the pitch curve is not followed by {SPANS[-1]} spans of each of its parts")


def _through(curve: PitchCurve, knots: Array) -> Spline:
    """The spline through a curve's points at arc lengths, with its tangents there (cubic Hermite)."""
    # A closed curve ends exactly at its first point.
    at, third = curve.at_length(knots), np.diff(knots)[:, None] / 3.0
    after, before = at.position[:-1] + third * at.tangent[:-1], at.position[1:] - third * at.tangent[1:]
    inner = np.stack([after, before], axis=1).reshape(-1, 2)
    repeated = np.repeat(knots, 2)
    return Spline(
        np.concatenate([knots[:1], knots[:1], repeated, knots[-1:], knots[-1:]]),
        np.vstack([at.position[:1], inner, at.position[-1:]]),
    )


def _missed_mm(curve: PitchCurve, knots: Array, spline: Spline) -> float:
    from scipy.interpolate import BSpline

    between = (knots[:-1, None] + np.diff(knots)[:, None] * PROBES).ravel()
    apart = BSpline(spline.knots, spline.poles_mm, DEGREE)(between) - curve.at_length(between).position
    return float(np.linalg.norm(apart, axis=1).max())


def step_files(drive: Drive) -> dict[str, bytes]:
    """``driving.step``, ``driven.step`` and ``pair.step`` by their names; each was read back and found the same.

    Raises the errors of ``exact_solids``.
    """
    solids = exact_solids(drive)
    words = f"{drive.stem}: tooth faces within {max(error for _, error in solids.values()):.1e} mm of the exact ones"
    files = {
        f"{gear.value}.step": part_bytes(StepSolid(gear.value, shape), words) for gear, (shape, _) in solids.items()
    }
    places = zip(solids.items(), (0.0, drive.pitch.center_distance_mm), strict=True)
    parts = [StepSolid(gear.value, shape, x_mm) for (gear, (shape, _)), x_mm in places]
    files["pair.step"] = assembly_bytes(drive.stem, parts, words)
    require_same(files["pair.step"], [part.shape for part in parts])
    return files


VOLUME_TOLERANCE = 2e-5
"""Largest relative difference of volume between a solid and the same solid read back; their faces are counted too.

The integrals of the kernel are no better, because it computes the edges of faces again (tests/test_step.py compares
them with sections).
"""

TIMESTAMP = "1970-01-01T00:00:00"
"""Time in the header of every file, so that the same design gives the same bytes at any time."""


@dataclass(frozen=True, eq=False)
class StepSolid:
    """A solid, its name, and the x coordinate of its axis in the file."""

    name: str
    shape: TopoDS_Shape
    x_mm: float = 0.0


def part_bytes(part: StepSolid, description: str) -> bytes:
    """A file of one product."""
    document, shapes = _document()
    _named(shapes.AddShape(part.shape, False), part.name)
    return _written(document, part.name, description)


def assembly_bytes(name: str, parts: Sequence[StepSolid], description: str) -> bytes:
    """A file of one product with the parts, each at its place."""
    document, shapes = _document()
    whole = _named(shapes.NewShape(), name)
    for part in parts:
        own = _named(shapes.AddShape(part.shape, False), part.name)
        _named(shapes.AddComponent(whole, own, moved_by(gp_Vec(part.x_mm, 0.0, 0.0))), part.name)
    shapes.UpdateAssemblies()
    return _written(document, name, description)


def _document() -> tuple[TDocStd_Document, XCAFDoc_ShapeTool]:
    """An empty document, and the tool that fills it; the tool is valid only as long as the document exists."""
    document = TDocStd_Document(TCollection_ExtendedString("BinXCAF"))
    return document, XCAFDoc_DocumentTool.ShapeTool_s(document.Main())


def _named(label: TDF_Label, name: str) -> TDF_Label:
    TDataStd_Name.Set_s(label, TCollection_ExtendedString(name))
    return label


def _written(document: TDocStd_Document, name: str, description: str) -> bytes:
    """The document as a file; raises Unanswered when the kernel cannot write it."""
    # The messages of the kernel about its work stay off the terminal; its alarms still appear.
    for printer in Message.DefaultMessenger_s().Printers():
        printer.SetTraceLevel(Message_Gravity.Message_Alarm)
    STEPControl_Controller.Init_s()
    # No curves on surfaces: they follow from the curves in space, and files would be twice as large.
    Interface_Static.SetIVal_s("write.surfacecurve.mode", 0)
    writer = STEPCAFControl_Writer()
    if not writer.Transfer(document):
        raise Unanswered(f"{name} cannot be put into a STEP file")
    _reproducible(writer.ChangeWriter().Model(), name, description)
    stream = BytesIO()
    if writer.WriteStream(stream) != IFSelect_ReturnStatus.IFSelect_RetDone:
        raise Unanswered(f"the STEP file of {name} was not written")
    return stream.getvalue()


def _reproducible(model: StepData_StepModel, name: str, description: str) -> None:
    """Give the header no time and no machine, and number components by name instead of by a count of this process."""
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


def require_same(data: bytes, shapes: Sequence[TopoDS_Shape]) -> None:
    """Raise Unanswered unless a file holds valid solids with faces and volumes of ``shapes``."""
    whole = read_back(data)
    if not BRepCheck_Analyzer(whole).IsValid():
        raise Unanswered("a STEP file holds solids that are not valid")
    for shape, found in zip(shapes, solids_of(whole), strict=True):
        faces, faces_found = (len(faces_of(solid)) for solid in (shape, found))
        volume, volume_found = volume_mm3(shape), volume_mm3(found)
        if faces != faces_found or not abs(volume_found - volume) <= VOLUME_TOLERANCE * volume:
            raise Unanswered(
                f"a STEP file holds {faces_found} faces about {volume_found:.9g} mm3, "
                f"not {faces} about {volume:.9g} mm3"
            )


def read_back(data: bytes) -> TopoDS_Shape:
    """The shape in a file; raises Unanswered where it cannot be read."""
    reader = STEPControl_Reader()
    if reader.ReadStream("step", BytesIO(data)) != IFSelect_ReturnStatus.IFSelect_RetDone:
        raise Unanswered("a STEP file cannot be read back")
    reader.TransferRoots()
    return reader.OneShape()
