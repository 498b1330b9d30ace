"""``ncgear sweep``: many designs at once."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from ncgear.cli.arguments import EXPORT, DesignFile
from ncgear.cli.opened import opened
from ncgear.cli.progress import counted


def sweep(
    design_file: DesignFile,
    vary: Annotated[
        list[str],
        typer.Option(metavar="KEY=FROM:TO:COUNT", help="A key of the file and its values; again for another key."),
    ],
    out: Annotated[
        Path | None, typer.Option(metavar="DIR", help="Output folder.", show_default="export/<design name>-sweep")
    ] = None,
) -> None:
    """Screen many designs: check and pitch curves, without teeth, for all combinations of some keys' values."""
    from ncgear.design.varied import designs_of, require_grid, varied_of
    from ncgear.output.publish import prepare, publish

    varied = [varied_of(text) for text in vary]
    with opened(design_file) as loaded:
        require_grid(loaded, varied)
        folder = out or EXPORT / f"{loaded.design.name}-sweep"
        prepare(folder)

        from ncgear.output.sweep import sweep_csv, sweep_text
        from ncgear.screening.screen import screened

        with counted("designs") as on_done:
            found = screened(list(designs_of(loaded, varied)), on_done=on_done)
        typer.echo(sweep_text(varied, found, publish(folder, {"sweep.csv": sweep_csv(varied, found).encode()})))
