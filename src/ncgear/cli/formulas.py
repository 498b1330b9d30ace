"""The command that prints a law in closed form."""

from __future__ import annotations

from enum import StrEnum
from typing import Annotated

import typer

from ncgear.cli.arguments import AsJson, DesignFile, opened
from ncgear.cli.as_json import print_figures


class Printed(StrEnum):
    """What formulas are printed as."""

    TEXT = "text"
    LATEX = "latex"
    PYTHON = "python"
    C = "c"
    MATLAB = "matlab"


def formulas(
    design_file: DesignFile,
    form: Annotated[
        Printed, typer.Option("--as", help="Text to read, LaTeX, or a file of functions that run.")
    ] = Printed.TEXT,
    as_json: AsJson = False,
) -> None:
    """Print the law in closed form, piece by piece: stroke, driven angle, ratio, both pitch radii."""
    from ncgear.formulas.printed import figures, printed
    from ncgear.project.drive import Drive

    with opened(design_file) as loaded:
        found = Drive(loaded.design, loaded=loaded).formulas
        if as_json:
            print_figures(figures(found))
        else:
            typer.echo(printed(found, form.value))
