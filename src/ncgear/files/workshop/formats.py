"""Kinds of files for the workshop, and the functions that make them; their libraries are imported when needed."""

from __future__ import annotations

from collections.abc import Callable, Collection
from dataclasses import dataclass
from enum import StrEnum
from functools import cache
from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from ncgear.drawings.beside import Drawer
    from ncgear.numerics.arrays import Array
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
    """The function that makes the files of a kind, by its module and name, and the names of the files.

    It takes a drive, or what ``shown``, a function of a drive, tells of it: values that a second process can be given.
    ``is_quick`` says that it needs no library that takes long to load.
    """

    module: str
    function: str
    names: tuple[str, ...]
    shown: tuple[str, str] | None = None
    is_quick: bool = False


DRAWINGS = ("gear_drawing", "pair_drawings")

WRITERS = {
    Format.DXF: Writer("dxf", "dxf_files", ("driving.dxf", "driven.dxf", "pair.dxf"), DRAWINGS),
    Format.SVG: Writer("svg", "svg_files", ("driving.svg", "driven.svg"), DRAWINGS, is_quick=True),
    Format.THREEMF: Writer("threemf", "threemf_files", ("gears.3mf", "pair.3mf")),
    Format.GLB: Writer("glb", "glb_files", ("pair.glb",)),
    Format.STEP: Writer("step", "step_files", ("driving.step", "driven.step", "pair.step")),
    Format.DRAWING: Writer(
        "sheets.files",
        "drawing_files",
        tuple(f"{name}_drawing.{kind}" for name in ("driving", "driven", "pair") for kind in ("pdf", "svg", "dxf")),
        ("sheets.pair_sheets", "sheets_of"),
    ),
}


@dataclass(frozen=True)
class Written:
    """Files by their names, and the outlines read back from those of them that are read where they are written."""

    files: dict[str, bytes]
    outlines: dict[str, tuple[Array, Array]]


def begun_workshop_files(drive: Drive, formats: Collection[Format], drawer: Drawer) -> Callable[[], Written]:
    """The files of one pair of gears; the function that is returned waits for them.

    ``drawer`` makes those whose library takes long to load.  Raises the errors of the drive.
    """
    from ncgear.drawings.beside import HERE

    drawings = cache(lambda shown: _function(*shown)(drive))
    waits = [
        (HERE if writer.is_quick else drawer).begun(WRITTEN, kind, drawings(writer.shown))
        for kind, writer in WRITERS.items()
        if kind in formats and writer.shown is not None
    ]
    here: dict[str, bytes] = {}
    for kind, writer in WRITERS.items():
        if kind in formats and writer.shown is None:
            here.update(_function(writer.module, writer.function)(drive))

    def wait() -> Written:
        parts = [part() for part in waits]
        files = {**here, **{name: content for part in parts for name, content in part.files.items()}}
        outlines = {kind: both for part in parts for kind, both in part.outlines.items()}
        names = [name for writer in WRITERS.values() for name in writer.names if name in files]
        return Written({name: files[name] for name in names}, outlines)

    return wait


WRITTEN = f"{__name__}:written_and_read"


def written_and_read(kind: Format, shown: Any) -> Written:
    """The files of a kind from what is shown, and the outlines read back from them."""
    from ncgear.files.workshop.read_back import read_outlines

    writer = WRITERS[kind]
    files = _function(writer.module, writer.function)(shown)
    return Written(files, read_outlines(files))


def _function(module: str, name: str) -> Callable[..., Any]:
    function: Callable[..., Any] = getattr(import_module(f"ncgear.files.workshop.{module}"), name)
    return function
