"""The command that holds measured gears against the exact ones."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

from ncgear.cli.arguments import EXPORT, AsJson, DesignFile, Verbose, opened
from ncgear.cli.as_json import tell
from ncgear.cli.mending import BUILD, naming_what_helps
from ncgear.cli.progress import steps_shown


class FitOption(StrEnum):
    """What is fitted; see ``project.compared.Fit``."""

    ROTATION = "rotation"
    RIGID = "rigid"


def measured(
    design_file: DesignFile,
    driving: Annotated[
        Path | None,
        typer.Option(metavar="POINTS.csv", help="Points of the driving gear, x and y in mm.", show_default="exact"),
    ] = None,
    driven: Annotated[
        Path | None,
        typer.Option(metavar="POINTS.csv", help="Points of the driven gear, x and y in mm.", show_default="exact"),
    ] = None,
    fit: Annotated[
        FitOption,
        typer.Option(help="rotation: the bore is at (0, 0), the angle is fitted; rigid: the axis is fitted too."),
    ] = FitOption.ROTATION,
    probe_radius: Annotated[
        float,
        typer.Option(metavar="MM", min=0.0, max=50.0, help="Radius of the probe's ball where points are its centres."),
    ] = 0.0,
    stage: Annotated[
        int | None,
        typer.Option(metavar="N", min=1, max=2, help="Which of two pairs of gears in series was measured: 1 or 2."),
    ] = None,
    out: Annotated[
        Path | None, typer.Option(metavar="DIR", help="Output folder.", show_default="export/<design name>-measured")
    ] = None,
    as_json: AsJson = False,
    verbose: Verbose = False,
) -> None:
    """Hold gears measured by points against the exact ones: pitch, thickness, profile, and whether the pair turns."""
    from ncgear.files.publish import prepare

    with opened(design_file) as loaded:
        from ncgear.figures.answers.compared import compared_answer
        from ncgear.figures.compared import compared_figures
        from ncgear.files.manifest import publish_run
        from ncgear.files.measured import compared_files
        from ncgear.pitch.shape import Gear
        from ncgear.project.compared import Fit, compared_pair, read_files
        from ncgear.project.drive import Drive

        files = read_files({Gear.DRIVING: driving, Gear.DRIVEN: driven})
        drive, how = Drive(loaded.design).of_stage(stage), Fit(fit.value)
        name = loaded.design.name + ("" if drive.stage is None else f"-stage-{drive.stage}")
        folder = out or EXPORT / f"{name}-measured"
        prepare(folder)
        with naming_what_helps(drive, BUILD), steps_shown(2) as on_step:
            on_step("best fit and contact")
            pair = compared_pair(drive, files, how, probe_radius)
            on_step("pictures")
            written = compared_files(pair, name)
        run = publish_run(folder, written, "measured")
        answer = compared_answer(pair, name, how, f"see {folder / 'measured-contact.png'} and measured.csv")
        figures = compared_figures(pair, name)
        tell(answer, figures, as_json=as_json, verbose=verbose, paths=run.paths, kept=run.kept)
