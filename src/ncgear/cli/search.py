"""Commands that search many laws, curves, gears or machines: optimize, frontier, fit, size, design."""

from __future__ import annotations

import sys
from math import inf
from pathlib import Path
from typing import Annotated

import typer

from ncgear.cli import arguments
from ncgear.cli.mending import BUILD, naming_what_helps
from ncgear.cli.progress import counted, steps_shown
from ncgear.errors import WrongInput


def optimize(
    design_file: arguments.DesignFile,
    starts: Annotated[
        int, typer.Option(min=1, max=10_000, help="Starts of the search; the best law of all is kept.")
    ] = 1,
    scheduler: arguments.Scheduler = None,
    processes: arguments.Processes = None,
    out: Annotated[Path | None, arguments.folder_option("-optimized")] = None,
    as_json: arguments.AsJson = False,
    verbose: arguments.Verbose = False,
) -> None:
    """Find the best law for a design's machine, with a certificate of how close to the limit it is."""
    from ncgear.files.manifest import publish_run

    with arguments.opened(design_file) as loaded:
        from ncgear.design.words import ending_in
        from ncgear.figures.answers.best_law import optimized_answer
        from ncgear.figures.best_law import SUFFIX, certificate, optimized_design
        from ncgear.figures.numbers import json_text
        from ncgear.files.searched import PICTURE, limit_picture
        from ncgear.project.best_law import BestLaw
        from ncgear.whole_machines.holding_law import holding

        name = ending_in(SUFFIX, loaded.design.name)
        folder = arguments.prepared(out, name)
        lengths, flywheel = loaded.design.free_lengths, loaded.design.free_flywheel
        hold = loaded.design.holding_teeth
        with steps_shown(5 + bool(lengths) + bool(flywheel) + hold) as on_step:
            best = BestLaw(
                loaded.design,
                starts,
                scheduler,
                processes,
                lambda solved, most: on_step.within(f"{solved} of at most {most} steps"),
                lambda laws: on_step.within(f"{laws} laws"),
                lambda laws: on_step.within(f"{laws} mechanisms"),
            )
            if lengths:
                on_step("lengths")
                best.lengths  # noqa: B018
            if flywheel:
                on_step("flywheel")
                best.flywheel  # noqa: B018
            on_step("certified limit")
            best.bound  # noqa: B018
            on_step("makeable law")
            best.law  # noqa: B018
            if hold:
                on_step("teeth that hold")
                best = holding(best, lambda laws: on_step.within(f"law {laws}"))
            on_step("limit beside the law")
            best.limit  # noqa: B018
            written = optimized_design(loaded, best)
            on_step("figures")
            figures = certificate(best)
            files = {f"{name}.yaml": written.encode(), "certificate.json": json_text(figures).encode()}
            if best.limit_points:
                on_step("picture")
                files[PICTURE] = limit_picture(best)
        # The best law of another design in the same folder is kept.
        run = publish_run(folder, files, f"optimize {name}")
        command, file = "build" if best.design.gears else "check", arguments.pasted(folder / f"{name}.yaml")
        answer = optimized_answer(best, f"ncgear {command} {file}")
        arguments.tell(answer, figures, as_json=as_json, verbose=verbose, run=run)


def frontier(
    design_file: arguments.DesignFile,
    points: Annotated[int, typer.Option(min=2, max=200, help="Points from least power to least acceleration.")] = 20,
    flywheel: Annotated[
        bool,
        typer.Option(
            "--flywheel",
            help="Set least power against the size of a flywheel on the driven shaft, "
            "within optimize.driven_flywheel_kg_mm2.",
        ),
    ] = False,
    scheduler: arguments.Scheduler = None,
    processes: arguments.Processes = None,
    out: Annotated[Path | None, arguments.folder_option("-frontier")] = None,
    as_json: arguments.AsJson = False,
    verbose: arguments.Verbose = False,
) -> None:
    """Set power against acceleration: certified limit, best laws, published family, mechanisms, all at one speed.

    Uses all cores; finished points are kept in the folder, so that a run that was interrupted goes on from there.
    """
    with arguments.opened(design_file) as loaded:
        from ncgear.figures.answers.best_law import flywheel_answer, frontier_answer
        from ncgear.figures.best_law import flywheel_figures, frontier_figures
        from ncgear.files.manifest import publish_run
        from ncgear.files.searched import flywheel_files, frontier_files
        from ncgear.project.frontier_run import frontier as frontier_of
        from ncgear.project.frontier_run import over_flywheels
        from ncgear.project.law_task import GearsAsGiven

        folder = arguments.prepared(out, f"{loaded.design.name}-frontier")
        if flywheel:
            with counted("laws") as on_law:
                over = over_flywheels(loaded.design, points, on_law)
            run = publish_run(folder, flywheel_files(over, loaded.design), "frontier")
            told = flywheel_answer(over, loaded.design)
            arguments.tell(told, flywheel_figures(over, loaded.design), as_json=as_json, verbose=verbose, run=run)
            return
        with counted("points", folder) as on_point:
            found = frontier_of(loaded.design, points, folder, on_point, scheduler, processes)
        beside = GearsAsGiven(loaded.design)
        run = publish_run(folder, frontier_files(found, beside), "frontier")
        answer = frontier_answer(found, beside, "give a cap as optimize.limits.peak_power_w, then ncgear optimize")
        figures = frontier_figures(found, beside)
        arguments.tell(answer, figures, as_json=as_json, verbose=verbose, run=run)


def fit(
    design_file: arguments.DesignFile,
    out: Annotated[Path | None, arguments.folder_option("-fitted")] = None,
    as_json: arguments.AsJson = False,
    verbose: arguments.Verbose = False,
) -> None:
    """Find the pitch curve nearest to a drawn outline whose pair of gears can be made, and say how far it strays."""
    from ncgear.files.manifest import publish_run

    with arguments.opened(design_file, offers_fit=False) as loaded:
        from ncgear.design.words import ending_in
        from ncgear.figures.numbers import json_text
        from ncgear.figures.outline_fit import SUFFIX, fit_figures, fitted_answer, fitted_design
        from ncgear.files.searched import OUTLINE_PICTURE, outline_picture
        from ncgear.project.outline_fit import fitted

        name = ending_in(SUFFIX, loaded.design.name)
        folder = arguments.prepared(out, name)
        with counted("pairs of gears made") as on_trial:
            found = fitted(loaded.design, on_trial)
        figures = fit_figures(found)
        files = {
            f"{name}.yaml": fitted_design(loaded, found).encode(),
            "fit.json": json_text(figures).encode(),
            OUTLINE_PICTURE: outline_picture(found, loaded.design.name),
        }
        run = publish_run(folder, files, f"fit {name}")
        answer = fitted_answer(loaded.design.name, found, f"ncgear build {arguments.pasted(folder / f'{name}.yaml')}")
        arguments.tell(answer, figures, as_json=as_json, verbose=verbose, run=run)


def size(
    design_file: arguments.DesignFile,
    space: Annotated[
        float | None,
        typer.Option(metavar="MM", min=1.0, help="Largest centre distance in mm.", show_default="no limit"),
    ] = None,
    diameter: Annotated[
        float | None,
        typer.Option(metavar="MM", min=1.0, help="Largest diameter of either gear in mm.", show_default="no limit"),
    ] = None,
    width: Annotated[float, typer.Option(min=5.0, max=30.0, help="Largest face width in modules.")] = 12.0,
    bending_safety: Annotated[
        float | None,
        typer.Option(min=0.1, max=10.0, help="Safety wanted against breakage.", show_default="as the file says"),
    ] = None,
    contact_safety: Annotated[
        float | None,
        typer.Option(min=0.1, max=10.0, help="Safety wanted against pitting.", show_default="as the file says"),
    ] = None,
    material: Annotated[
        str | None,
        typer.Option(
            metavar="NAME",
            help="Material of both gears.",
            show_default="as the file says",
            autocompletion=arguments.materials_to_complete,
        ),
    ] = None,
    herringbone: Annotated[
        bool, typer.Option("--herringbone", help="Also find how narrow herringbone teeth make the first gears.")
    ] = False,
    out: Annotated[
        Path | None,
        typer.Option(metavar="FILE.yaml", help="Write the design file with the smallest gears.", show_default="none"),
    ] = None,
    as_json: arguments.AsJson = False,
    verbose: arguments.Verbose = False,
) -> None:
    """Find the smallest gears that hold: module of series I, number of teeth, face width, within a space."""
    from ncgear.files.publish import prepare_file

    if out is not None and out.suffix not in arguments.SUFFIXES:
        raise WrongInput(f"{out} given; a file that ends in .yaml is right", key="--out")
    if material is not None:
        from ncgear.project.sizing import require_material

        require_material(material, "--material")
    with arguments.opened(design_file) as loaded:
        if out is not None:
            prepare_file(out)

        from ncgear.figures.answers.strong import in_order, sized_answer, sized_design, sized_figures
        from ncgear.files.manifest import Run, publish_named
        from ncgear.project.drive import Drive
        from ncgear.project.sizing import GearRoom, asked_design, in_herringbone, smallest_gears, stated_inertias

        options = {
            "strength.bending_safety": bending_safety,
            "strength.contact_safety": contact_safety,
            "gears.material": material,
        }
        asked = {key: value for key, value in options.items() if value is not None}
        drive = Drive(asked_design(loaded.design, asked))
        with naming_what_helps(loaded, drive, BUILD), counted("gears computed") as on_trial:
            found = in_order(smallest_gears(drive, GearRoom(space or inf, diameter or inf, width), on_trial))
            also = in_herringbone(found[0]) if herringbone else None
        option, what = ("--herringbone ", "herringbone teeth") if also else ("", "the first")
        run, then = (
            Run([], []),
            f"ncgear size {arguments.pasted(design_file)} {option}--out NEW.yaml writes a file with {what}",
        )
        if out is not None:
            content = sized_design(loaded, also or found[0], asked).encode()
            run, then = publish_named(out, content, f"size {out.name}"), f"ncgear build {arguments.pasted(out)}"
        answer = sized_answer(found, then, stated_inertias(loaded.design), herringbone and (also or "none"))
        arguments.tell(answer, sized_figures(found, also), as_json=as_json, verbose=verbose, run=run)


STEPS = 4
"""Approximate number of steps of the search: laws, materials, machines, limits."""


def design(
    design_file: arguments.DesignFile,
    scheduler: arguments.Scheduler = None,
    processes: arguments.Processes = None,
    out: Annotated[Path | None, arguments.folder_option("-machines")] = None,
    as_json: arguments.AsJson = False,
    verbose: arguments.Verbose = False,
) -> None:
    """Find whole machines: law, gears, material, flywheel and motor together, and how far from the best they are.

    Ctrl-C ends the search, and the machines found until then are written.
    """
    from ncgear.files.manifest import publish_run
    from ncgear.workers import one_thread_each

    with one_thread_each(), arguments.opened(design_file) as loaded:
        from ncgear.files.searched import machine_files
        from ncgear.whole_machines.search import MachineSearch
        from ncgear.whole_machines.told import machines_answer, machines_figures

        folder = arguments.prepared(out, f"{loaded.design.name}-machines")
        interrupted = False
        with steps_shown(STEPS) as on_step:
            begun: list[str] = []

            def tell_step(what: str, done: int, most: int) -> None:
                if not begun or begun[-1] != what:
                    begun.append(what)
                    on_step(what)
                on_step.within(f"{done} of {most}" if most else f"{done}")

            search = MachineSearch(loaded, tell_step, scheduler, processes)
            try:
                found = search.run()
            except KeyboardInterrupt:
                if not search.made:
                    raise
                found, interrupted = search.found, True
        run = publish_run(folder, machine_files(found), f"design {loaded.design.name}")
        best = found.machines[found.recommended]
        answer = machines_answer(found, f"ncgear build {arguments.pasted(folder / f'{best.name}.yaml')}")
        figures = machines_figures(found)
        arguments.tell(answer, figures, as_json=as_json, verbose=verbose, run=run)
        if interrupted:
            # At the end of an interrupted command, unwritten output is lost
            sys.stdout.flush()
            raise KeyboardInterrupt
