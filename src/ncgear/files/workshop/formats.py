"""Kinds of files for the workshop, and the functions that make them; their libraries are imported when needed."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable
from enum import StrEnum
from typing import TYPE_CHECKING, Any

from ncgear.extras import require
from ncgear.frozen import dataclass

if TYPE_CHECKING:
    from ncgear.drawings.beside import Drawer
    from ncgear.files.read_back import ExactOutlines
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
"""The kinds of files that a build writes by default: all kinds without an optional library."""


@dataclass(frozen=True)
class FormatWriter:
    """The function that makes the files of a kind, by its module in this package and its name, and the files' names.

    It takes a drive, or the result of ``shown``, a function of a drive: values that a second process can be given.
    ``reader``, of ``files/read_back.py``, reads the outline of a gear back from its file, ``driving.KIND`` or
    ``driven.KIND``; None where files have no outlines of their own.  ``is_slow`` says that the function needs a library
    that takes long to load; ``library`` is an optional library that it needs.
    """

    function: str
    names: tuple[str, ...]
    shown: str | None = None
    reader: str | None = None
    is_slow: bool = False
    library: str | None = None


def _drawn(function: str, names: tuple[str, ...], reader: str, *, is_slow: bool = False) -> FormatWriter:
    """The writer of drawings of both gears, whose outlines are always read back."""
    return FormatWriter(function, names, "drawing:pair_drawings", reader, is_slow)


WRITERS = {
    Format.DXF: _drawn("dxf:dxf_files", ("driving.dxf", "driven.dxf", "pair.dxf"), "outline_of_dxf", is_slow=True),
    Format.SVG: _drawn("svg:svg_files", ("driving.svg", "driven.svg"), "outline_of_svg"),
    Format.THREEMF: FormatWriter("solid_files:threemf_files", ("gears.3mf", "pair.3mf"), "solid_files:placed_meshes"),
    Format.GLB: FormatWriter("solid_files:glb_files", ("pair.glb",)),
    Format.STEP: FormatWriter("step:step_files", ("driving.step", "driven.step", "pair.step"), library="OCP"),
    Format.DRAWING: FormatWriter(
        "sheet_files:drawing_files",
        tuple(f"{name}_drawing.{kind}" for name in ("driving", "driven", "pair") for kind in ("pdf", "svg", "dxf")),
        "sheets.sheets:sheets_of",
        is_slow=True,
    ),
}


@dataclass(frozen=True)
class WrittenFiles:
    """Files by their names, and the largest distance in mm of the outlines read back from the exact outlines, by kind.

    A drawing has an outline where it shows a single gear.
    """

    files: dict[str, bytes]
    errors_mm: dict[str, float]


Making = Callable[[], WrittenFiles]
"""Makes the files of a kind, or waits for them; raises the errors of the drive."""


def slow_to_load(formats: Collection[Format]) -> list[str]:
    """The functions that write files of these kinds and take long to load, ``module:function`` each."""
    return [f"{PACKAGE}.{writer.function}" for kind, writer in WRITERS.items() if kind in formats and writer.is_slow]


def require_libraries(formats: Collection[Format]) -> None:
    """Raise WrongInput where a library that writes files of these kinds is not installed."""
    for kind in formats:
        if (library := WRITERS[kind].library) is not None:
            require(library, kind, f"--format {kind}")


def begun_workshop_files(
    drive: Drive, formats: Collection[Format], drawer: Drawer, exact_mm: ExactOutlines | None
) -> list[Making]:
    """The files of one pair of gears; ``drawer`` makes as many of them as it can before they are asked for.

    Outlines are measured against ``exact_mm`` where it is given.  Raises the errors of the drive.
    """
    return [_begun(drive, kind, drawer, exact_mm) for kind in WRITERS if kind in formats]


def _begun(drive: Drive, kind: Format, drawer: Drawer, exact_mm: ExactOutlines | None) -> Making:
    writer = WRITERS[kind]
    if writer.shown is None:
        return lambda: written_and_measured(kind, drive, None)
    shown = _function(writer.shown)(drive)
    return drawer.offered(WRITTEN, kind, shown, exact_mm if writer.reader else None)


def all_made(parts: Iterable[Making]) -> WrittenFiles:
    """The files of all kinds together."""
    written = [part() for part in parts]
    return WrittenFiles(
        {name: content for made in written for name, content in made.files.items()},
        {kind: error for made in written for kind, error in made.errors_mm.items()},
    )


WRITTEN = f"{__name__}:written_and_measured"


def written_and_measured(kind: Format, shown: Any, exact_mm: ExactOutlines | None) -> WrittenFiles:
    """The files of a kind from a drive or from the values of ``FormatWriter.shown``; see ``begun_workshop_files``."""
    from ncgear.files import read_back

    writer = WRITERS[kind]
    files = _function(writer.function)(shown)
    if exact_mm is None or writer.reader is None:
        return WrittenFiles(files, {})
    read = getattr(read_back, writer.reader)
    outlines_mm = read(files[f"driving.{kind}"]), read(files[f"driven.{kind}"])
    return WrittenFiles(files, read_back.outline_errors_mm(exact_mm, {kind.value: outlines_mm}))


def _function(name: str) -> Callable[..., Any]:
    # This import loads the library that starts processes.
    from ncgear.drawings.beside import function_of

    return function_of(f"{PACKAGE}.{name}")
