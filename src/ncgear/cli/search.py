"""Commands that look among many laws: optimize, frontier, sweep."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from ncgear.cli.arguments import EXPORT, DesignFile, opened
from ncgear.cli.progress import counted, steps_shown


def optimize(
    design_file: DesignFile,
    out: Annotated[
        Path | None, typer.Option(metavar="DIR", help="Output folder.", show_default="export/<design name>-optimized")
    ] = None,
) -> None:
    """Find the best law for a design's machine, with a certificate of how close to the limit it is."""
    from ncgear.files.manifest import publish_run
    from ncgear.files.publish import prepare

    with opened(design_file) as loaded:
        from ncgear.figures.best_law import certificate, optimized_design, optimized_name, optimized_text
        from ncgear.figures.numbers import json_text
        from ncgear.files.frontier import PICTURE, limit_picture
        from ncgear.project.best_law import BestLaw

        best = BestLaw(loaded.design)
        name = optimized_name(best)
        folder = out or EXPORT / name
        prepare(folder)
        with steps_shown(4) as on_step:
            on_step("certified limit")
            best.bound  # noqa: B018
            on_step("makeable law")
            written = optimized_design(loaded.text, best)
            on_step("figures")
            certified = json_text(certificate(best)).encode()
            files = {f"{name}.yaml": written.encode(), "certificate.json": certified}
            if best.limit_points:
                on_step("picture")
                files[PICTURE] = limit_picture(best)
        # The best law of another design in the same folder stays.
        run = publish_run(folder, files, f"optimize {name}")
        typer.echo(optimized_text(best, run.paths, run.kept))


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
    from ncgear.files.publish import prepare

    with opened(design_file) as loaded:
        from ncgear.figures.best_law import frontier_text
        from ncgear.files.frontier import frontier_files
        from ncgear.files.manifest import publish_run
        from ncgear.project.best_law import BestLaw
        from ncgear.project.frontier_run import frontier as frontier_of

        folder = out or EXPORT / f"{loaded.design.name}-frontier"
        prepare(folder)
        with counted("points") as on_point:
            found = frontier_of(loaded.design, points, folder, on_point)
        best = BestLaw(loaded.design)
        run = publish_run(folder, frontier_files(found, best), "frontier")
        typer.echo(frontier_text(found, best, run.paths, run.kept))


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
    from ncgear.files.publish import prepare

    varied = [varied_of(text) for text in vary]
    with opened(design_file) as loaded:
        require_grid(loaded, varied)
        folder = out or EXPORT / f"{loaded.design.name}-sweep"
        prepare(folder)

        from ncgear.figures.sweep import sweep_csv, sweep_text
        from ncgear.files.manifest import publish_run
        from ncgear.screening.screen import screened

        with counted("designs") as on_done:
            found = screened(list(designs_of(loaded, varied)), on_done=on_done, as_written=loaded.source.as_written)
        run = publish_run(folder, {"sweep.csv": sweep_csv(varied, found).encode()}, "sweep")
        typer.echo(sweep_text(varied, found, run.paths, run.kept))
