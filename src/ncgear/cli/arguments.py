"""Parts that commands share: arguments, their completion in the shell, the design file in use, and printing."""

from __future__ import annotations

import os
import shlex
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from enum import StrEnum
from pathlib import Path
from subprocess import list2cmdline
from typing import TYPE_CHECKING, Annotated, Any

import typer

from ncgear.errors import NoSuchMechanism, Unanswered, located
from ncgear.extras import require
from ncgear.memory import keep_freed_memory

if TYPE_CHECKING:
    from ncgear.design.keys.base import Model
    from ncgear.design.reading.design_file import LoadedDesign
    from ncgear.figures.answers.answer import Answer
    from ncgear.files.manifest import Run
    from ncgear.project.drive import Drive

SUFFIXES = (".yaml", ".yml")


def files_to_complete(incomplete: str) -> list[str]:
    """Design files and folders whose path begins with the typed text; hidden files only after a typed dot."""
    typed = Path(incomplete)
    folder, start = (typed, "") if incomplete.endswith("/") or not incomplete else (typed.parent, typed.name)
    if not folder.is_dir():
        return []
    named = [place for place in sorted(folder.iterdir()) if place.name.startswith(start)]
    found = [place for place in named if start or not place.name.startswith(".")]
    wanted = [place for place in found if place.is_dir() or place.suffix in SUFFIXES]
    return [f"{place}/" if place.is_dir() else str(place) for place in wanted]


def pasted(path: Path) -> str:
    """A path as a shell reads it in a command that is pasted."""
    return list2cmdline([str(path)]) if os.name == "nt" else shlex.quote(str(path))


class FileKind(StrEnum):
    """Files that ncgear reads."""

    DESIGN = "design"
    BALANCE = "balance"
    TRAIN = "train"


def model_of(kind: FileKind) -> type[Model]:
    """The model of a kind of file."""
    from ncgear.design.keys.balance import Balance
    from ncgear.design.keys.design import Design
    from ncgear.design.trains.registry import TrainFile

    models: dict[FileKind, type[Model]] = {FileKind.BALANCE: Balance, FileKind.TRAIN: TrainFile}
    return models.get(kind, Design)


def keys_to_complete(context: typer.Context, incomplete: str) -> list[str]:
    """Keys of the kind of file in the command line, by their whole path or by their last part."""
    from ncgear.design.told_keys import told_keys

    keys = told_keys(FileKind(context.params.get("of") or FileKind.DESIGN))
    words = dict.fromkeys(word for key in keys for word in (key.path, key.name))
    return [word for word in words if word.startswith(incomplete)]


def materials_to_complete(incomplete: str) -> list[str]:
    """Materials of the table whose name begins with the typed text."""
    from ncgear.strength.materials import TABLE

    return [name for name in TABLE if name.startswith(incomplete)]


EXPORT = Path("export")
"""Commands write into a folder for each design below this one, unless ``--out`` names another folder."""


def folder_option(suffix: str = "", named: str = "design name") -> Any:
    """The option ``--out`` of a command whose folder has a name with so a suffix."""
    return typer.Option(metavar="DIR", help="Output folder.", show_default=f"{EXPORT}/<{named}>{suffix}")


DesignFile = Annotated[
    Path,
    typer.Argument(
        metavar="DESIGN.yaml",
        help="The design file; `ncgear new` writes one to begin with.",
        autocompletion=files_to_complete,
    ),
]
AsJson = Annotated[
    bool, typer.Option("--json", help="Print every figure as JSON to stdout, and everything else to stderr.")
]
Verbose = Annotated[bool, typer.Option("--verbose", help="Print every figure, every file, and warnings in full.")]


def _with_dask(context: typer.Context, address: str | None) -> str | None:
    """The address of a scheduler; raises WrongInput before any work where Dask is not installed."""
    if address is not None and not context.resilient_parsing:
        require("distributed", "cluster", "--scheduler")
    return address


Scheduler = Annotated[
    str | None,
    typer.Option(
        callback=_with_dask,
        metavar="ADDRESS",
        help="Dask scheduler (tcp://host:8786) that computes, or local for a Dask cluster of this computer.",
        show_default="processes of this computer",
    ),
]
Processes = Annotated[
    int | None,
    typer.Option(min=1, max=1024, help="Processes of this computer that compute.", show_default="one for each core"),
]
Timing = Annotated[bool, typer.Option("--timing", help="Also print, to stderr, how long each step took.")]


@contextmanager
def opened(path: Path, *, offers_fit: bool = True, for_loads: bool = False) -> Iterator[LoadedDesign]:
    """A context with the design of a file; errors raised in it get the place of their key in that file.

    An error about a drawn pitch curve or its teeth names the command that finds the nearest one, unless it is running.
    The gears of a carrier are a design only ``for_loads``.
    """
    from ncgear.design.reading.design_file import load

    if path.is_symlink():
        from ncgear.files.publish import real_place

        # Links that a killed run has left are replaced by their files.
        real_place(path)
    # The work that follows computes with large arrays.
    keep_freed_memory()
    loaded = load(path, for_loads=for_loads)
    with located(loaded.source):
        try:
            yield loaded
        except NoSuchMechanism as refusal:
            if not (offers_fit and loaded.design.can_be_fitted and _is_of_curve(refusal)):
                raise
            from ncgear.project.outline_fit import has_outline

            if not has_outline(loaded.design):
                raise
            offer = f"ncgear fit {pasted(path)} finds the nearest pitch curve whose gears can be made"
            raise NoSuchMechanism(
                f"{refusal.problem}; {offer}", key=refusal.key, location=refusal.location
            ) from refusal


def _is_of_curve(refusal: NoSuchMechanism) -> bool:
    """Whether an error refuses a pitch curve, or the teeth on it."""
    of_teeth = refusal.key in ("gears.teeth", "gears.least_contact_ratio")
    return not isinstance(refusal, Unanswered) and (of_teeth or refusal.key.split(".")[0] == "motion")


def prepared(out: Path | None, name: str = "") -> Path:
    """The output folder: ``out``, or one below ``EXPORT``; it is refused before any work if it cannot be written."""
    from ncgear.files.publish import prepare

    folder = out or EXPORT / name
    prepare(folder)
    return folder


def tell(answer: Answer, *of_pairs: Mapping[str, Any], as_json: bool, verbose: bool, run: Run | None = None) -> None:
    """Print an answer and the files of a run; with ``verbose`` the full answer and every figure; or figures as JSON.

    For the figures and errors see ``print_figures``.
    """
    from ncgear.figures.answers.answer import answer_text
    from ncgear.figures.terminal import full_text

    files = (run.paths, run.kept) if run else ((), ())
    if as_json:
        print_figures(*of_pairs, kept=files[1])
    else:
        typer.echo(full_text(answer, of_pairs, *files) if verbose else answer_text(answer, *files))


def print_times(drive: Drive) -> None:
    """Print to stderr how long each step of a drive took."""
    from ncgear.figures.terminal import timing_text

    typer.echo(timing_text(drive), err=True)


def tell_written(said: str, kept: Sequence[Path], figures: Sequence[Mapping[str, Any]] = ()) -> None:
    """Tell what was written, and the files of other programs that were ``kept``; or print figures as JSON, if any."""
    from ncgear.figures.terminal import kept_lines

    if figures:
        print_figures(*figures, kept=kept)
    else:
        typer.echo("\n".join([said, *kept_lines(kept)]))


def print_figures(*of_pairs: Mapping[str, Any], kept: Sequence[Path] = ()) -> None:
    """Print figures as one JSON document to stdout, and the files of other programs that were ``kept`` to stderr.

    The figures equal the figures of the JSON file that the command writes, to the digit.  For two pairs in series that
    are told one by one, they are below ``stages``. Raises Unanswered, before anything is printed, where a figure is not
    finite.
    """
    from ncgear.figures.numbers import json_text

    by_stage = {f"stage_{number}": figures for number, figures in enumerate(of_pairs, start=1)}
    typer.echo(json_text(of_pairs[0] if len(of_pairs) == 1 else {"stages": by_stage}).rstrip())
    if kept:
        from ncgear.figures.terminal import kept_lines

        typer.echo("\n".join(kept_lines(kept)), err=True)
