"""The sheets of a pair as files: SVG, PDF and DXF."""

from __future__ import annotations

from collections.abc import Mapping

from ncgear.files.workshop.sheets.dxf import dxf_bytes
from ncgear.files.workshop.sheets.pdf import pdf_bytes
from ncgear.files.workshop.sheets.sheet import Sheet
from ncgear.files.workshop.sheets.svg import svg_bytes

WRITERS = {"svg": svg_bytes, "pdf": pdf_bytes, "dxf": dxf_bytes}


def drawing_files(sheets: Mapping[str, Sheet]) -> dict[str, bytes]:
    """``driving_drawing``, ``driven_drawing`` and ``pair_drawing`` of each kind by their names."""
    return {f"{name}_drawing.{kind}": write(sheet) for name, sheet in sheets.items() for kind, write in WRITERS.items()}
