"""Commands that study one design or compare several: bench, compare, formulas, measured, tolerance."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

from ncgear.cli import arguments
from ncgear.cli.mending import BUILD, naming_what_helps
from ncgear.cli.progress import counted, steps_shown
from ncgear.errors import WrongInput
from ncgear.memory import keep_freed_memory


def bench(
    design_file: arguments.DesignFile,
    out: Annotated[Path | None, arguments.folder_option("-bench")] = None,
    as_json: arguments.AsJson = False,
    verbose: arguments.Verbose = False,
) -> None:
    """Measure time and error of each stage of a design, and recommend tolerance, mesh and positions for it."""
    with arguments.opened(design_file) as loaded:
        name = loaded.design.name
        folder = arguments.prepared(out, f"{name}-bench")

        from ncgear.figures.bench import bench_answer, bench_figures
        from ncgear.files.bench import bench_files
        from ncgear.files.manifest import publish_run
        from ncgear.project.bench import benched, step_count
        from ncgear.project.drive import Drive

        drive = Drive(loaded.design)
        with naming_what_helps(loaded, drive, BUILD), steps_shown(step_count(drive) + 1) as on_step:
            stages = benched(drive, on_step)
            on_step("pictures")
            written = bench_files(stages, name)
        run = publish_run(folder, written, "bench")
        shown = next((made for made in written if made.startswith("bench-teeth")), "bench-motion.png")
        answer, figures = bench_answer(stages, name, f"see {folder}/{shown}"), bench_figures(stages, name)
        arguments.tell(answer, figures, as_json=as_json, verbose=verbose, run=run)


def compare(
    design_files: Annotated[
        list[Path],
        typer.Argument(
            metavar="DESIGN.yaml...",
            help="Two to eight design files; figures differ from those of the first.",
            autocompletion=arguments.files_to_complete,
        ),
    ],
    out: Annotated[Path | None, arguments.folder_option("-compared", "first name")] = None,
    as_json: arguments.AsJson = False,
    verbose: arguments.Verbose = False,
) -> None:
    """Set designs side by side: the figures of a check in a table, with differences, and their motions in charts."""
    from ncgear.figures.side_by_side import compare as compared
    from ncgear.figures.side_by_side import side_by_side_figures, side_by_side_text
    from ncgear.figures.terminal import written_lines
    from ncgear.files.manifest import publish_run
    from ncgear.files.side_by_side import side_by_side_files

    keep_freed_memory()
    found = compared(*design_files)
    folder = arguments.prepared(out, f"{found.names[0]}-compared")
    run = publish_run(folder, side_by_side_files(found), "compare")
    if as_json:
        arguments.print_figures(side_by_side_figures(found), kept=run.kept)
        return
    then = [] if verbose else ["--verbose prints every figure"]
    written = "\n".join(written_lines(run.paths, run.kept))
    typer.echo("\n\n".join([side_by_side_text(found, every=verbose), "\n".join([written, *then])]))


class FormulaLanguage(StrEnum):
    """What formulas are printed as."""

    TEXT = "text"
    LATEX = "latex"
    PYTHON = "python"
    C = "c"
    MATLAB = "matlab"


def formulas(
    design_file: arguments.DesignFile,
    form: Annotated[
        FormulaLanguage, typer.Option("--as", help="Text to read, LaTeX, or a file of functions that run.")
    ] = FormulaLanguage.TEXT,
    as_json: arguments.AsJson = False,
) -> None:
    """Print the law in closed form, piece by piece: stroke, driven angle, ratio, both pitch radii."""
    from ncgear.formulas.checked import figures, printed
    from ncgear.project.drive import Drive

    with arguments.opened(design_file) as loaded:
        found = Drive(loaded.design, loaded=loaded).formulas
        if as_json:
            arguments.print_figures(figures(found))
        else:
            typer.echo(printed(found, form.value))


class FitOption(StrEnum):
    """Kinds of fit; see ``project.compared.Fit``."""

    ROTATION = "rotation"
    RIGID = "rigid"


def measured(
    design_file: arguments.DesignFile,
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
        int | None, typer.Option(metavar="N", min=1, help="Which of several pairs of gears in series was measured.")
    ] = None,
    out: Annotated[Path | None, arguments.folder_option("-measured")] = None,
    as_json: arguments.AsJson = False,
    verbose: arguments.Verbose = False,
) -> None:
    """Compare gears measured by points with the exact gears: pitch, thickness, profile, and whether the pair turns."""
    with arguments.opened(design_file) as loaded:
        from ncgear.figures.compared import compared_answer, compared_figures
        from ncgear.files.manifest import publish_run
        from ncgear.files.measured import compared_files
        from ncgear.pitch.shape import Gear
        from ncgear.project.compared import FittedQuantities, compared_pair, read_files
        from ncgear.project.drive import Drive

        files = read_files({Gear.DRIVING: driving, Gear.DRIVEN: driven})
        drive, how = Drive(loaded.design).of_stage(stage), FittedQuantities(fit.value)
        name = drive.stem
        folder = arguments.prepared(out, f"{name}-measured")
        with naming_what_helps(loaded, drive, BUILD), steps_shown(2) as on_step:
            on_step("best fit and contact")
            pair = compared_pair(drive, files, how, probe_radius)
            on_step("pictures")
            written = compared_files(pair, name)
        run = publish_run(folder, written, "measured")
        answer = compared_answer(pair, name, how, f"see {folder / 'measured-contact.png'} and measured.csv")
        figures = compared_figures(pair, name)
        arguments.tell(answer, figures, as_json=as_json, verbose=verbose, run=run)


FEWEST, MOST = 64, 1 << 20


def tolerance(
    design_file: arguments.DesignFile,
    samples: Annotated[int, typer.Option(help=f"Assemblies, a power of two from {FEWEST} to {MOST}.")] = 4096,
    seed: Annotated[int, typer.Option(min=0, max=2**31, help="Seed: the same one draws the same assemblies.")] = 1,
    scheduler: arguments.Scheduler = None,
    processes: Annotated[
        int | None,
        typer.Option(
            min=1, max=1024, help="Processes of this computer that compute.", show_default="one; long runs one per core"
        ),
    ] = None,
    out: Annotated[Path | None, arguments.folder_option("-tolerance")] = None,
    as_json: arguments.AsJson = False,
    verbose: arguments.Verbose = False,
) -> None:
    """Say what tolerances do: play, transmission error, the assemblies that jam or knock, which tolerance matters."""
    if not FEWEST <= samples <= MOST or samples & (samples - 1):
        nearest = min(max(1 << max(samples, 1).bit_length(), FEWEST), MOST)
        raise WrongInput(f"{samples} is no power of two from {FEWEST} to {MOST}; {nearest} is right", key="--samples")
    with arguments.opened(design_file, for_loads=True) as loaded:
        folder = arguments.prepared(out, f"{loaded.design.name}-tolerance")

        from ncgear.figures.toleranced import tolerance_answer, tolerance_json
        from ncgear.files.manifest import publish_run
        from ncgear.files.tolerance import tolerance_files
        from ncgear.project.drive import Drive
        from ncgear.project.tolerance import tolerated
        from ncgear.tolerances.study import Workers

        drive = Drive(loaded.design)
        with naming_what_helps(loaded, drive, BUILD), counted("assemblies") as on_done:
            found = tolerated(drive, samples, seed, Workers(scheduler, processes), on_done)
            run = publish_run(folder, tolerance_files(found), "tolerance")
        answer, figures = tolerance_answer(found), tolerance_json(found)
        arguments.tell(answer, figures, as_json=as_json, verbose=verbose, run=run)
