"""Kinds of files for the workshop, and the functions that make them; their libraries are imported when needed."""

from __future__ import annotations

from collections.abc import Callable, Collection
from enum import StrEnum
from functools import cache
from importlib import import_module
from typing import TYPE_CHECKING, Any

from ncgear.frozen import dataclass

if TYPE_CHECKING:
    from ncgear.drawings.beside import Drawer
    from ncgear.files.outline_errors import ExactOutlines
    from ncgear.project.drive import Drive


PACKAGE = __name__.rpartition(".")[0]


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
    ``is_slow`` says that it needs a library that takes long to load.
    """

    module: str
    function: str
    names: tuple[str, ...]
    shown: tuple[str, str] | None = None
    is_slow: bool = False


DRAWINGS = ("gear_drawing", "pair_drawings")

WRITERS = {
    Format.DXF: Writer("dxf", "dxf_files", ("driving.dxf", "driven.dxf", "pair.dxf"), DRAWINGS, is_slow=True),
    Format.SVG: Writer("svg", "svg_files", ("driving.svg", "driven.svg"), DRAWINGS),
    Format.THREEMF: Writer("threemf", "threemf_files", ("gears.3mf", "pair.3mf"), ("threemf", "placed_meshes")),
    Format.GLB: Writer("glb", "glb_files", ("pair.glb",)),
    Format.STEP: Writer("step", "step_files", ("driving.step", "driven.step", "pair.step")),
    Format.DRAWING: Writer(
        "sheets.files",
        "drawing_files",
        tuple(f"{name}_drawing.{kind}" for name in ("driving", "driven", "pair") for kind in ("pdf", "svg", "dxf")),
        ("sheets.pair_sheets", "sheets_of"),
        is_slow=True,
    ),
}


@dataclass(frozen=True)
class Written:
    """Files by their names, and how far the outlines in them, read back, are from the exact ones, in mm by their kind.

    Of drawings only those of one gear each have an outline.
    """

    files: dict[str, bytes]
    errors_mm: dict[str, float]


def slow_to_load(formats: Collection[Format]) -> list[str]:
    """The functions that write files of these kinds and take long to load, ``module:function`` each."""
    writers = [writer for kind, writer in WRITERS.items() if kind in formats and writer.is_slow]
    return [f"{PACKAGE}.{writer.module}:{writer.function}" for writer in writers]


def begun_workshop_files(
    drive: Drive, formats: Collection[Format], drawer: Drawer, exact_mm: ExactOutlines | None
) -> Callable[[], Written]:
    """The files of one pair of gears; the function that is returned makes and gives those that are not made by then.

    ``drawer`` makes what it can until then.  Outlines are measured against ``exact_mm`` where it is given.  Both
    functions raise the errors of the drive.
    """
    from ncgear.files.workshop.read_back import READERS

    drawings = cache(lambda shown: _function(*shown)(drive))
    waits = [
        drawer.offered(WRITTEN, kind, drawings(writer.shown), exact_mm if kind in READERS else None)
        for kind, writer in WRITERS.items()
        if kind in formats and writer.shown is not None
    ]

    def made() -> Written:
        files: dict[str, bytes] = {}
        for kind, writer in WRITERS.items():
            if kind in formats and writer.shown is None:
                files.update(_function(writer.module, writer.function)(drive))
        errors_mm: dict[str, float] = {}
        for part in waits:
            written = part()
            files.update(written.files)
            errors_mm.update(written.errors_mm)
        return Written(files, errors_mm)

    return made


WRITTEN = f"{__name__}:written_and_measured"


def written_and_measured(kind: Format, shown: Any, exact_mm: ExactOutlines | None) -> Written:
    """The files of a kind from what is shown; see ``begun_workshop_files``."""
    from ncgear.files.outline_errors import outline_errors_mm
    from ncgear.files.workshop.read_back import read_outlines

    writer = WRITERS[kind]
    files = _function(writer.module, writer.function)(shown)
    return Written(files, {} if exact_mm is None else outline_errors_mm(exact_mm, read_outlines(files)))


def _function(module: str, name: str) -> Callable[..., Any]:
    function: Callable[..., Any] = getattr(import_module(f"{PACKAGE}.{module}"), name)
    return function
