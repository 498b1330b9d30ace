"""Remedies where teeth are refused: commands name them, and commands with ``--mend`` apply them."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from ncgear.cli.progress import counted
from ncgear.errors import DesignError, WrongInput
from ncgear.frozen import dataclass

if TYPE_CHECKING:
    from ncgear.design.reading.design_file import LoadedDesign
    from ncgear.files.manifest import Run
    from ncgear.project.drive import Drive
    from ncgear.project.mending import Mending

OPTION = "--mend"

Mend = Annotated[
    bool, typer.Option(OPTION, help="Where the teeth are refused, take the least change that makes them, and say so.")
]

MakeTeeth = Annotated[
    bool,
    typer.Option(
        OPTION, help="Also make the teeth; where they are refused, check the design with the least change that helps."
    ),
]

BUILD = f"ncgear build {OPTION}"

NOTHING = "Nothing to mend: the teeth can be made as the file has them."


@dataclass(frozen=True)
class Mended:
    """The design with which a command continues, its drive, and the text about the change.

    ``text`` is the mended design file, empty where the design is unchanged.
    """

    loaded: LoadedDesign
    drive: Drive
    said: tuple[str, ...] = ()
    text: str = ""

    @property
    def words(self) -> str:
        """The whole text, in lines for a terminal."""
        from ncgear.figures.mended import in_lines

        return in_lines(self.said)

    def say(self) -> None:
        """Print the whole text and an empty line to stderr; print nothing where the text is empty."""
        if self.said:
            typer.echo(f"{self.words}\n", err=True)

    def kept_in(self, folder: Path) -> Run:
        """Write the mended design file into a folder, beside the files that were made from it."""
        from ncgear.files.manifest import Run, publish_run

        if not self.text:
            return Run([], [])
        name = self.loaded.design.name
        # A build replaces files that builds wrote; a design file is kept.
        return publish_run(folder, {f"{name}.yaml": self.text.encode()}, f"mend {name}")


def as_given(loaded: LoadedDesign) -> Mended:
    """The design of a file, unchanged."""
    from ncgear.project.drive import Drive

    return Mended(loaded, Drive(loaded.design))


def mended(loaded: LoadedDesign) -> Mended:
    """The design with the least change that makes its teeth; raises the error, with the changes tried, if none does."""
    from ncgear.design.reading.design_file import parsed
    from ncgear.design.words import ending_in
    from ncgear.figures.mended import SUFFIX, mended_design, mended_words, refusal_with_help
    from ncgear.project.drive import Drive
    from ncgear.project.mending import mending

    drive = Drive(loaded.design)
    with counted("changes tried") as on_trial:
        search = mending(drive, on_trial)
    if search is None:
        return Mended(loaded, drive, (NOTHING,))
    if search.found is None:
        raise refusal_with_help(search) from search.refusal
    text = mended_design(loaded, search.found)
    # The gears are made from the text, so the kept file makes the same gears.
    changed = parsed(text, Path(f"{ending_in(SUFFIX, loaded.design.name)}.yaml"))
    return Mended(changed, Drive(changed.design), mended_words(search, search.found), text)


@contextmanager
def naming_what_helps(loaded: LoadedDesign, drive: Drive, option: str = OPTION) -> Iterator[None]:
    """A context that adds a remedy to an error about teeth; ``option`` is the option that applies it, for machines."""
    try:
        yield
    except DesignError as error:
        from ncgear.figures.mended import refusal_with_help

        search = None if drive.design.gears is None else _search(drive, error)
        if search is None:
            raise
        raise refusal_with_help(search, "" if loaded.is_train else option) from error


def _search(drive: Drive, error: DesignError) -> Mending | None:
    """The search for a remedy; None where the error is not about teeth."""
    from ncgear.project.mending import BACKLASH, ROOT_RADIUS, refusal_of_teeth, searched

    if isinstance(error, WrongInput) and error.key not in (ROOT_RADIUS, *BACKLASH):
        return None
    try:
        refusal = refusal_of_teeth(drive)
    except DesignError:
        return None
    if refusal is None or (type(refusal), refusal.key) != (type(error), error.key):
        return None
    with counted("changes tried") as on_trial:
        return searched(drive, error, on_trial)
