"""The command about tolerances: many assemblies of one design."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from ncgear.cli.arguments import EXPORT, AsJson, DesignFile, Scheduler, Verbose, opened
from ncgear.cli.as_json import tell
from ncgear.cli.mending import BUILD, naming_what_helps
from ncgear.cli.progress import counted
from ncgear.errors import WrongInput

FEWEST, MOST = 64, 1 << 20


def tolerance(
    design_file: DesignFile,
    samples: Annotated[int, typer.Option(help=f"Assemblies, a power of two from {FEWEST} to {MOST}.")] = 4096,
    seed: Annotated[int, typer.Option(min=0, max=2**31, help="Seed: the same one draws the same assemblies.")] = 1,
    scheduler: Scheduler = None,
    processes: Annotated[
        int | None,
        typer.Option(
            min=1, max=1024, help="Processes of this computer that compute.", show_default="one; long runs one per core"
        ),
    ] = None,
    out: Annotated[
        Path | None, typer.Option(metavar="DIR", help="Output folder.", show_default="export/<design name>-tolerance")
    ] = None,
    as_json: AsJson = False,
    verbose: Verbose = False,
) -> None:
    """Say what tolerances do: play, transmission error, the assemblies that jam or knock, which tolerance matters."""
    from ncgear.files.publish import prepare

    if not FEWEST <= samples <= MOST or samples & (samples - 1):
        nearest = min(max(1 << max(samples, 1).bit_length(), FEWEST), MOST)
        raise WrongInput(f"{samples} is no power of two from {FEWEST} to {MOST}; {nearest} is right", key="--samples")
    with opened(design_file) as loaded:
        folder = out or EXPORT / f"{loaded.design.name}-tolerance"
        prepare(folder)

        from ncgear.figures.answers.toleranced import tolerance_answer
        from ncgear.figures.toleranced import tolerance_json
        from ncgear.files.manifest import publish_run
        from ncgear.files.tolerance import tolerance_files
        from ncgear.project.drive import Drive
        from ncgear.project.tolerance import tolerated
        from ncgear.tolerances.study import Workers

        drive = Drive(loaded.design)
        with naming_what_helps(drive, BUILD), counted("assemblies") as on_done:
            found = tolerated(drive, samples, seed, Workers(scheduler, processes), on_done)
            run = publish_run(folder, tolerance_files(found), "tolerance")
        answer, figures = tolerance_answer(found), tolerance_json(found)
        tell(answer, figures, as_json=as_json, verbose=verbose, paths=run.paths, kept=run.kept)
