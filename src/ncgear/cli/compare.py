"""The command that sets designs side by side."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from ncgear.cli.arguments import EXPORT, AsJson, Verbose, files_to_complete
from ncgear.cli.as_json import print_figures
from ncgear.memory import keep_freed_memory


def compare(
    design_files: Annotated[
        list[Path],
        typer.Argument(
            metavar="DESIGN.yaml...",
            help="Two to eight design files; figures differ from those of the first.",
            autocompletion=files_to_complete,
        ),
    ],
    out: Annotated[
        Path | None, typer.Option(metavar="DIR", help="Output folder.", show_default="export/<first name>-compared")
    ] = None,
    as_json: AsJson = False,
    verbose: Verbose = False,
) -> None:
    """Set designs side by side: the figures of a check in a table, with differences, and their motions in charts."""
    from ncgear.figures.side_by_side import compare as compared
    from ncgear.figures.side_by_side import side_by_side_figures, side_by_side_text
    from ncgear.figures.terminal import written_lines
    from ncgear.files.manifest import publish_run
    from ncgear.files.publish import prepare
    from ncgear.files.side_by_side import side_by_side_files

    keep_freed_memory()
    found = compared(*design_files)
    folder = out or EXPORT / f"{found.names[0]}-compared"
    prepare(folder)
    run = publish_run(folder, side_by_side_files(found), "compare")
    if as_json:
        print_figures(side_by_side_figures(found), kept=run.kept)
        return
    then = [] if verbose else ["--verbose prints every figure"]
    written = "\n".join(written_lines(run.paths, run.kept))
    typer.echo("\n\n".join([side_by_side_text(found, every=verbose), "\n".join([written, *then])]))
