"""``ncgear simulate``: torques and forces."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from ncgear.cli.arguments import EXPORT, DesignFile, Timing
from ncgear.cli.opened import opened
from ncgear.cli.progress import stages_shown
from ncgear.dynamics.level import Level


def simulate(
    design_file: DesignFile,
    level: Annotated[
        Level,
        typer.Option(help="rigid: inverse dynamics in closed form; quasi_static: teeth under load; dynamic: in time."),
    ] = Level.RIGID,
    out: Annotated[
        Path | None, typer.Option(metavar="DIR", help="Output folder.", show_default="export/<design name>-<level>")
    ] = None,
    timing: Timing = False,
) -> None:
    """Find the torques and forces in a design's machine, beside the uniform crank with the same masses."""
    from ncgear.output.publish import prepare, publish

    with opened(design_file) as loaded:
        folder = out or EXPORT / f"{loaded.design.name}-{level}"
        prepare(folder)

        from ncgear.drive import Drive
        from ncgear.output.report import timing_text
        from ncgear.output.simulation.files import simulate as simulate_drive
        from ncgear.output.simulation.files import simulation_files, simulation_text

        drive = Drive(loaded.design)
        with stages_shown(1) as on_stage:
            on_stage(f"simulation, level {level}")
            found = simulate_drive(drive, level)
        typer.echo(simulation_text(found, publish(folder, simulation_files(found))))
        if timing:
            typer.echo(timing_text(drive), err=True)
