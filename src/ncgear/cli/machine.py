"""Commands that compute one machine: check, build, report, animate, simulate and strength; and balance."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from ncgear.cli import arguments, train
from ncgear.cli.mending import BUILD, OPTION, MakeTeeth, Mend, as_given, mended, naming_what_helps
from ncgear.cli.progress import counted, steps_shown
from ncgear.dynamics.level import Level
from ncgear.errors import WrongInput, located
from ncgear.files.workshop.formats import USUAL, Format, require_libraries, slow_to_load

if TYPE_CHECKING:
    from ncgear.drawings.animation import AnimationFormat


def check(
    design_file: arguments.DesignFile,
    as_json: arguments.AsJson = False,
    mend: MakeTeeth = False,
    verbose: arguments.Verbose = False,
    timing: arguments.Timing = False,
) -> None:
    """Check a design: motion and power, no files; teeth only where masses leave out the inertia of the gears."""
    if train.is_train(design_file):
        train.refuse_options(design_file, {"--mend": mend})
        train.check_train(design_file, as_json=as_json, verbose=verbose)
        return
    with arguments.opened(design_file) as loaded:
        from ncgear.figures.advice.verdict import KnownParts, judged
        from ncgear.figures.answers.machine import check_answer
        from ncgear.figures.summary.check_summary import check_summary

        made = mended(loaded) if mend else as_given(loaded)
        drive = made.drive
        if as_json:
            made.say()
        with steps_shown(1) as on_step:
            on_step("kinematics and power")
            verdict = judged(drive, KnownParts.MOTION)
            file = f"{arguments.pasted(design_file)} {OPTION}" if made.text else arguments.pasted(design_file)
            answer = check_answer(drive, verdict, file, made.said)
            figures = [check_summary(drive, verdict)] if as_json or verbose else []
        arguments.tell(answer, *figures, as_json=as_json, verbose=verbose)
        if timing:
            arguments.print_times(drive)


def build(
    design_file: arguments.DesignFile,
    out: Annotated[Path | None, arguments.folder_option()] = None,
    kinds: Annotated[
        list[Format] | None,
        typer.Option(
            "--format", help="Files for the workshop, may be given again; left out: all but step, which needs an extra."
        ),
    ] = None,
    report: Annotated[
        bool,
        typer.Option(
            "--report", help="Also write report.html, as ncgear report does; an existing report is always made anew."
        ),
    ] = False,
    mend: Mend = False,
    as_json: arguments.AsJson = False,
    verbose: arguments.Verbose = False,
    timing: arguments.Timing = False,
) -> None:
    """Build the gears: outlines, solids, plots, motion law and summary, into a folder."""
    if train.is_train(design_file):
        train.refuse_options(design_file, {"--format": kinds, "--report": report, "--mend": mend})
        train.build_train(design_file, out, as_json=as_json, verbose=verbose)
        return
    from ncgear.drawings.beside import MOTION_PICTURE, PAGE_CHARTS, drawing_beside

    kinds = kinds or list(USUAL)
    require_libraries(kinds)
    charts = [PAGE_CHARTS] if report else []
    with (
        drawing_beside(MOTION_PICTURE, *charts, *slow_to_load(kinds)) as drawer,
        arguments.opened(design_file) as given,
    ):
        arguments.prepared(out, given.design.name)
        if given.design.gears is None:
            raise WrongInput("missing; a build needs it (teeth, module_mm, face_width_mm, ...)", key="gears")

        made = mended(given) if mend else as_given(given)
        loaded, drive = made.loaded, made.drive
        folder = arguments.prepared(out, loaded.design.name)

        from ncgear.drawings.page import REPORT_FILE
        from ncgear.figures.answers.machine import build_answer
        from ncgear.files.build import build as build_files
        from ncgear.files.build import step_count
        from ncgear.files.manifest import Run, holds_as_written

        # The report of an earlier design would lie beside gears that it does not show.
        report = report or holds_as_written(folder, REPORT_FILE)
        with naming_what_helps(loaded, drive), steps_shown(step_count(drive, report=report)) as on_step:
            built = build_files(drive, folder, on_step, kinds, loaded if report else None, drawer)
        design = made.kept_in(folder)
        # Both runs wrote the manifest.
        paths = list(dict.fromkeys([*built.paths, *design.paths]))
        run = Run(paths, [*built.kept, *design.kept])
        if as_json:
            made.say()
        shown = folder / f"{loaded.design.name}.yaml" if made.text else design_file
        then = f"open {folder / REPORT_FILE}" if report else f"ncgear report {arguments.pasted(shown)}"
        answer = build_answer(drive, built.verdict, then, made.said)
        arguments.tell(answer, *built.summaries, as_json=as_json, verbose=verbose, run=run)
        if timing:
            arguments.print_times(drive)


def report(
    design_file: arguments.DesignFile,
    out: Annotated[Path | None, arguments.folder_option()] = None,
    as_json: arguments.AsJson = False,
    timing: arguments.Timing = False,
) -> None:
    """Write report.html: the machine running, its curves, comparison, warnings, data sheet and design file."""
    if train.reports_as_train(design_file):
        train.refuse_options(design_file, {"--timing": timing})
        train.report_train(design_file, out, as_json=as_json)
        return
    from ncgear.drawings.beside import PAGE_CHARTS, drawing_beside

    with drawing_beside(PAGE_CHARTS) as drawer, arguments.opened(design_file) as loaded:
        folder = arguments.prepared(out, loaded.design.name)

        from ncgear.drawings.page import REPORT_FILE
        from ncgear.drawings.page.page import report_page
        from ncgear.figures.advice.verdict import together
        from ncgear.files.build import WRITTEN_STEPS, contacts_as_written, summaries_without_files, verdicts_of
        from ncgear.files.manifest import publish_run
        from ncgear.project.drive import Drive

        drive = Drive(loaded.design)
        has_gears = loaded.design.gears is not None
        steps = 1 + has_gears * drive.design.stages * len(WRITTEN_STEPS)
        with naming_what_helps(loaded, drive, BUILD), steps_shown(steps) as on_step:
            contacts = contacts_as_written(drive, on_step) if has_gears else []
            on_step("report")
            verdicts = verdicts_of(drive)
            page = report_page(drive, loaded, contacts, together(verdicts), drawer)
            figures = summaries_without_files(drive, contacts, verdicts) if as_json else []
        run = publish_run(folder, {REPORT_FILE: page}, "report")
        arguments.tell_written(
            f"{folder / REPORT_FILE} ({len(page) / 1e6:.1f} MB): open it in a browser", run.kept, figures
        )
        if timing:
            arguments.print_times(drive)


def animate(
    design_file: arguments.DesignFile,
    out: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE", help="File to write, .gif or .mp4.", show_default="export/<design name>/mechanism.gif"
        ),
    ] = None,
    frames: Annotated[int, typer.Option(min=2, max=600, help="Pictures in the loop.")] = 72,
    seconds: Annotated[float, typer.Option(min=0.1, max=600.0, help="Time that the loop takes.")] = 4.0,
    width: Annotated[int, typer.Option(min=320, max=1920, help="Width in pixels, rounded to an even number.")] = 960,
) -> None:
    """Show the mechanism moving: gears, crank, rod and slider over a whole cycle, as a GIF or MP4."""
    from ncgear.drawings.animation import AnimationFormat, format_of, require_shown

    kind = format_of(out) if out else AnimationFormat.GIF
    require_shown(kind, frames, seconds)
    form = frames, seconds, width
    make = train.animated_train if train.is_train(design_file) else _animated_machine
    path, content = make(design_file, out, kind, form)

    from ncgear.files.manifest import publish_named, publish_run

    # Another animation in the same folder is kept.
    command = f"animate {path.name}"
    run = (
        publish_run(path.parent, {path.name: content}, command)
        if out is None
        else publish_named(path, content, command, replaces=True)
    )
    arguments.tell_written(f"wrote {path}: {frames} frames in {seconds:g} s, {len(content) / 1e6:.3g} MB", run.kept)


def _animated_machine(
    design_file: Path, out: Path | None, kind: AnimationFormat, form: tuple[int, float, int]
) -> tuple[Path, bytes]:
    """The place and the bytes of a GIF or MP4 of a machine; ``form`` has frames, seconds and width in pixels."""
    from ncgear.files.publish import prepare_file

    with arguments.opened(design_file) as loaded:
        path = out or arguments.EXPORT / loaded.design.name / "mechanism.gif"
        prepare_file(path)

        from ncgear.drawings.animation.packing import Loop, animated
        from ncgear.drawings.scene.scene import scene_of
        from ncgear.project.drive import Drive

        drive = Drive(loaded.design)
        with naming_what_helps(loaded, drive, BUILD):
            drive.require_sound_pairs()
            scene = scene_of(drive)
        with counted("frames") as on_frame:
            return path, animated(scene, kind, Loop(*form), on_frame)


def simulate(
    design_file: arguments.DesignFile,
    level: Annotated[
        Level,
        typer.Option(help="rigid: inverse dynamics in closed form; quasi_static: teeth under load; dynamic: in time."),
    ] = Level.RIGID,
    out: Annotated[Path | None, arguments.folder_option("-<level>")] = None,
    as_json: arguments.AsJson = False,
    verbose: arguments.Verbose = False,
    timing: arguments.Timing = False,
) -> None:
    """Find the torques and forces in a design's machine, beside the uniform crank with the same masses."""
    with arguments.opened(design_file) as loaded:
        folder = arguments.prepared(out, f"{loaded.design.name}-{level}")

        from ncgear.figures.answers.simulated import simulated_answer
        from ncgear.files.manifest import publish_run
        from ncgear.files.simulation import simulate as simulate_drive
        from ncgear.files.simulation import simulation_files
        from ncgear.project.drive import Drive

        drive = Drive(loaded.design)
        with naming_what_helps(loaded, drive, BUILD), steps_shown(1) as on_step:
            on_step(f"simulation, level {level}")
            drive.stopwatch.within = on_step.within
            found = simulate_drive(drive, level)
        run = publish_run(folder, simulation_files(found), "simulate")
        answer = simulated_answer(drive, level, found.figures, found.verdict, arguments.pasted(design_file))
        arguments.tell(answer, found.figures, as_json=as_json, verbose=verbose, run=run)
        if timing:
            arguments.print_times(drive)


class Method(StrEnum):
    """Methods of strength."""

    ESTIMATE = "estimate"
    ELEMENTS = "elements"


def strength(
    design_file: arguments.DesignFile,
    method: Annotated[
        Method | None,
        typer.Option(
            help="estimate: local replacement gears, at once; elements: plane finite elements, in seconds.",
            show_default="as the file says",
        ),
    ] = None,
    worn: Annotated[
        bool, typer.Option("--worn", help="Also rate the gears worn, after a quarter, half and all of the wanted life.")
    ] = False,
    out: Annotated[Path | None, arguments.folder_option("-strength")] = None,
    as_json: arguments.AsJson = False,
    verbose: arguments.Verbose = False,
    timing: arguments.Timing = False,
) -> None:
    """Say whether the teeth hold: safety and life of every tooth, the weakest first, and what would do."""
    with arguments.opened(design_file, for_loads=True) as loaded:
        folder = arguments.prepared(out, f"{loaded.design.name}-strength")

        from ncgear.figures.advice.strength_advice import SIZE, remedies
        from ncgear.figures.advice.verdict import KnownParts, judged, together
        from ncgear.figures.answers.strong import strength_answer, worn_figures
        from ncgear.figures.strong import strength_figures
        from ncgear.files.build import naming_stage
        from ncgear.files.manifest import publish_run
        from ncgear.files.strength import strength_files
        from ncgear.project.drive import Drive
        from ncgear.project.strengthening import rating_of
        from ncgear.project.worn import worn_over_life

        drive = Drive(loaded.design)
        told, figures, files, verdicts = [], [], {}, []
        with naming_what_helps(loaded, drive, BUILD), steps_shown((3 + worn) * drive.design.stages) as on_step:
            for pair in drive.by_stage:
                on_pair_step = naming_stage(pair, on_step)
                on_pair_step("strength")
                rating = rating_of(pair, method.value if method else None)
                beside = None if rating.strength.method == "estimate" else rating_of(pair, "estimate")
                verdicts.append(judged(pair, KnownParts.TEETH))
                figures.append(strength_figures(pair, rating, verdicts[-1], beside))
                on_pair_step("what would do")
                cures, wears = remedies(pair, rating), []
                if worn:
                    on_pair_step("worn gears")
                    wears = list(worn_over_life(pair, rating))
                    figures[-1] |= worn_figures(pair, wears)
                told.append((pair, rating, cures, beside, wears))
                on_pair_step("pictures")
                files.update(strength_files(pair, rating, figures[-1]))
        run = publish_run(folder, files, "strength")
        then = f"{SIZE} {arguments.pasted(design_file)}" if drive.design.stages == 1 else ""
        answer = strength_answer(told, together(verdicts), then)
        arguments.tell(answer, *figures, as_json=as_json, verbose=verbose, run=run)
        if timing:
            arguments.print_times(drive)


def balance(
    balance_file: Annotated[
        Path, typer.Argument(metavar="FILE.yaml", help="The balance file.", autocompletion=arguments.files_to_complete)
    ],
    out: Annotated[Path | None, arguments.folder_option("-balance", "name")] = None,
    as_json: arguments.AsJson = False,
    verbose: arguments.Verbose = False,
) -> None:
    """Say how much a machine shakes, and what mass where would stop it: linkages, gears, rotors, frequencies."""
    from ncgear.design.reading.balance_file import load_balance

    loaded = load_balance(balance_file)
    folder = arguments.prepared(out, f"{loaded.balance.name}-balance")

    from ncgear.figures.balance.parts import balance_answer, balancing_figures
    from ncgear.files.balance import balance_files
    from ncgear.files.manifest import publish_run
    from ncgear.project.balancing import Balancing

    balancing = Balancing(loaded)
    with located(loaded.source), steps_shown(2) as on_step:
        on_step("balance")
        figures = balancing_figures(balancing)
        on_step("pictures")
        files = balance_files(balancing, figures)
    run = publish_run(folder, files, "balance")
    answer = balance_answer(figures)
    arguments.tell(answer, figures, as_json=as_json, verbose=verbose, run=run)
