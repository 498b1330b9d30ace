"""What the shell offers while a command is being typed.

Arguments and options that several commands share, and where these write.

A design file in use by a command.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

if TYPE_CHECKING:
    from ncgear.design.reading.design_file import LoadedDesign

SUFFIXES = (".yaml", ".yml")


def files_to_complete(incomplete: str) -> list[str]:
    """Design files and folders whose path begins with what is typed; hidden ones only once a dot is."""
    typed = Path(incomplete)
    folder, start = (typed, "") if incomplete.endswith("/") or not incomplete else (typed.parent, typed.name)
    if not folder.is_dir():
        return []
    found = [place for place in sorted(folder.iterdir()) if place.name.startswith(start or _not_hidden(place))]
    return [f"{place}/" if place.is_dir() else str(place) for place in found if _wanted(place)]


def _not_hidden(place: Path) -> str:
    """A start that no hidden file has."""
    return "\0" if place.name.startswith(".") else ""


def _wanted(place: Path) -> bool:
    return place.is_dir() or place.suffix in SUFFIXES


def keys_to_complete(context: typer.Context, incomplete: str) -> list[str]:
    """Keys of the kind of file that is asked about, by their whole path or their last part."""
    from ncgear.cli.design_files import FileKind, model_of
    from ncgear.design.reference import keys_of

    keys = keys_of(model_of(FileKind(context.params.get("of") or FileKind.DESIGN)))
    words = dict.fromkeys(word for key in keys for word in (key.path, key.name))
    return [word for word in words if word.startswith(incomplete)]


EXPORT = Path("export")
"""Where commands write, into a folder for each design, unless they are told another place."""

DesignFile = Annotated[
    Path,
    typer.Argument(
        metavar="DESIGN.yaml",
        help="The design file; `ncgear new` writes one to begin with.",
        autocompletion=files_to_complete,
    ),
]
Timing = Annotated[bool, typer.Option("--timing", help="Also print, to stderr, how long each stage took.")]


@contextmanager
def opened(path: Path) -> Iterator[LoadedDesign]:
    """The design of a file; errors raised while it is in use get the place of their key in that file."""
    from ncgear.design.reading.design_file import load

    loaded = load(path)
    with loaded.locating():
        yield loaded
