"""How each kind of files for the workshop is made; what one needs is imported when it is asked for."""

from __future__ import annotations

from collections.abc import Callable, Collection
from dataclasses import dataclass
from importlib import import_module

from ncgear.files.workshop.kinds import Format
from ncgear.project.drive import Drive


@dataclass(frozen=True)
class Writer:
    """Where the function is that makes a kind's files of a drive, and what they are called."""

    module: str
    function: str
    names: tuple[str, ...]


WRITERS = {
    Format.DXF: Writer("dxf", "dxf_files", ("driving.dxf", "driven.dxf", "pair.dxf")),
    Format.SVG: Writer("svg", "svg_files", ("driving.svg", "driven.svg")),
    Format.THREEMF: Writer("threemf", "threemf_files", ("gears.3mf", "pair.3mf")),
    Format.GLB: Writer("glb", "glb_files", ("pair.glb",)),
    Format.STEP: Writer("step", "step_files", ("driving.step", "driven.step", "pair.step")),
}

NAMES = tuple(name for writer in WRITERS.values() for name in writer.names)
"""All files that a build may write, of which an earlier one may have left some."""


def workshop_files(drive: Drive, formats: Collection[Format]) -> dict[str, bytes]:
    """The files of one pair of gears by their names; raises as the drive does."""
    files: dict[str, bytes] = {}
    for kind in Format:
        if kind in formats:
            files.update(_function(WRITERS[kind])(drive))
    return files


def _function(writer: Writer) -> Callable[[Drive], dict[str, bytes]]:
    module = import_module(f"ncgear.files.workshop.{writer.module}")
    made: Callable[[Drive], dict[str, bytes]] = getattr(module, writer.function)
    return made
