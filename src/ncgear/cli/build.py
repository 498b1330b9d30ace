"""``ncgear build``: everything into a folder."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from ncgear.cli.arguments import EXPORT, DesignFile, Timing
from ncgear.cli.opened import opened
from ncgear.cli.progress import stages_shown
from ncgear.errors import WrongInput
from ncgear.output.workshop.kinds import USUAL, Format


def build(
    design_file: DesignFile,
    out: Annotated[
        Path | None, typer.Option(metavar="DIR", help="Output folder.", show_default="export/<design name>")
    ] = None,
    kinds: Annotated[
        list[Format] | None,
        typer.Option(
            "--format",
            help="Files for the workshop, may be given again; left out: all but step, which needs an extra.",
        ),
    ] = None,
    report: Annotated[bool, typer.Option("--report", help="Also write report.html, as ncgear report does.")] = False,
    timing: Timing = False,
) -> None:
    """Build the gears: outlines, solids, plots, motion law and summary, into a folder."""
    from ncgear.output.publish import prepare

    with opened(design_file) as loaded:
        folder = out or EXPORT / loaded.design.name
        prepare(folder)
        if loaded.design.gears is None:
            raise WrongInput("missing; a build needs it (teeth, module_mm, face_width_mm, ...)", key="gears")

        from ncgear.drive import Drive
        from ncgear.output.build import build as build_files
        from ncgear.output.build import stage_count
        from ncgear.output.report import build_text, timing_text

        drive = Drive(loaded.design)
        with stages_shown(stage_count(drive, report=report)) as on_stage:
            built = build_files(drive, folder, on_stage, kinds or USUAL, loaded if report else None)
        typer.echo(build_text(built.summaries, built.paths))
        if timing:
            typer.echo(timing_text(drive), err=True)
