"""The command that measures speed against error of a design's own stages."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from ncgear.cli.arguments import EXPORT, AsJson, DesignFile, Verbose, opened
from ncgear.cli.as_json import tell
from ncgear.cli.mending import BUILD, naming_what_helps
from ncgear.cli.progress import steps_shown


def bench(
    design_file: DesignFile,
    out: Annotated[
        Path | None, typer.Option(metavar="DIR", help="Output folder.", show_default="export/<design name>-bench")
    ] = None,
    as_json: AsJson = False,
    verbose: Verbose = False,
) -> None:
    """Measure time and error of each stage of a design, and recommend tolerance, mesh and positions for it."""
    from ncgear.files.publish import prepare

    with opened(design_file) as loaded:
        name = loaded.design.name
        folder = out or EXPORT / f"{name}-bench"
        prepare(folder)

        from ncgear.figures.answers.bench import bench_answer
        from ncgear.figures.bench import bench_figures
        from ncgear.files.bench import bench_files
        from ncgear.files.manifest import publish_run
        from ncgear.project.bench import benched, step_count
        from ncgear.project.drive import Drive

        drive = Drive(loaded.design)
        with naming_what_helps(drive, BUILD), steps_shown(step_count(drive) + 1) as on_step:
            stages = benched(drive, on_step)
            on_step("pictures")
            written = bench_files(stages, name)
        run = publish_run(folder, written, "bench")
        shown = next((made for made in written if made.startswith("bench-teeth")), "bench-motion.png")
        answer, figures = bench_answer(stages, name, f"see {folder}/{shown}"), bench_figures(stages, name)
        tell(answer, figures, as_json=as_json, verbose=verbose, paths=run.paths, kept=run.kept)
