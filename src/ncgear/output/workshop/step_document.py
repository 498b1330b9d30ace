"""STEP (ISO 10303-21, AP 214) from solids, in mm: the same solids give the same bytes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from io import BytesIO

from OCP.APIHeaderSection import APIHeaderSection_MakeHeader
from OCP.gp import gp_Trsf, gp_Vec
from OCP.IFSelect import IFSelect_ReturnStatus
from OCP.Interface import Interface_Static
from OCP.Message import Message, Message_Gravity
from OCP.STEPCAFControl import STEPCAFControl_Writer
from OCP.STEPControl import STEPControl_Controller
from OCP.StepData import StepData_StepModel
from OCP.StepRepr import StepRepr_NextAssemblyUsageOccurrence
from OCP.TCollection import TCollection_ExtendedString, TCollection_HAsciiString
from OCP.TDataStd import TDataStd_Name
from OCP.TDF import TDF_Label
from OCP.TDocStd import TDocStd_Document
from OCP.TopLoc import TopLoc_Location
from OCP.TopoDS import TopoDS_Shape
from OCP.XCAFDoc import XCAFDoc_DocumentTool, XCAFDoc_ShapeTool

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
