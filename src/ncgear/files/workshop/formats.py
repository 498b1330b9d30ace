"""Kinds of files for the workshop, and the functions that make them; their libraries are imported when needed."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass
from enum import StrEnum
from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from ncgear.project.drive import Drive


class Format(StrEnum):
    """Kinds of files that a build writes beside STL and CSV."""

    DXF = "dxf"
    SVG = "svg"
    THREEMF = "3mf"
    GLB = "glb"
    STEP = "step"
    DRAWING = "drawing"


USUAL = (Format.DXF, Format.SVG, Format.THREEMF, Format.GLB, Format.DRAWING)
"""The kinds that a build writes if no others are asked for: all that need no optional library."""


@dataclass(frozen=True)
class Writer:
    """The function that makes the files of a kind from a drive, by its module and name, and the names of the files."""

    module: str
    function: str
    names: tuple[str, ...]


WRITERS = {
    Format.DXF: Writer("dxf", "dxf_files", ("driving.dxf", "driven.dxf", "pair.dxf")),
    Format.SVG: Writer("svg", "svg_files", ("driving.svg", "driven.svg")),
    Format.THREEMF: Writer("threemf", "threemf_files", ("gears.3mf", "pair.3mf")),
    Format.GLB: Writer("glb", "glb_files", ("pair.glb",)),
    Format.STEP: Writer("step", "step_files", ("driving.step", "driven.step", "pair.step")),
    Format.DRAWING: Writer(
        "sheets.files",
        "drawing_files",
        tuple(f"{name}_drawing.{kind}" for name in ("driving", "driven", "pair") for kind in ("pdf", "svg", "dxf")),
    ),
}


def workshop_files(drive: Drive, formats: Collection[Format]) -> dict[str, bytes]:
    """The files of one pair of gears by their names; raises the errors of the drive."""
    files: dict[str, bytes] = {}
    for kind, writer in WRITERS.items():
        if kind in formats:
            module = import_module(f"ncgear.files.workshop.{writer.module}")
            files.update(getattr(module, writer.function)(drive))
    return files
