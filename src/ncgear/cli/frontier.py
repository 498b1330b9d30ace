"""``ncgear frontier``: power against acceleration."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from ncgear.cli.arguments import EXPORT, DesignFile
from ncgear.cli.opened import opened
from ncgear.cli.progress import counted


def frontier(
    design_file: DesignFile,
    points: Annotated[int, typer.Option(min=2, max=200, help="Points from least power to least acceleration.")] = 20,
    out: Annotated[
        Path | None, typer.Option(metavar="DIR", help="Output folder.", show_default="export/<design name>-frontier")
    ] = None,
) -> None:
    """Set power against acceleration: certified limit, best laws, published family, mechanisms, all at one speed.

    Uses all cores; finished points are kept in the folder, so that a run that was interrupted goes on from there.
    """
    from ncgear.output.publish import prepare, publish

    with opened(design_file) as loaded:
        from ncgear.frontier import frontier as frontier_of
        from ncgear.improvement import Improvement
        from ncgear.output.optimum.frontier_files import frontier_files, frontier_text

        folder = out or EXPORT / f"{loaded.design.name}-frontier"
        prepare(folder)
        with counted("points") as on_point:
            found = frontier_of(loaded.design, points, folder, on_point)
        improvement = Improvement(loaded.design)
        typer.echo(frontier_text(found, improvement, publish(folder, frontier_files(found, improvement))))
