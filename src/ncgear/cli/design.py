"""The command that finds whole machines."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Annotated

import typer

from ncgear.cli.arguments import EXPORT, AsJson, DesignFile, Processes, Scheduler, Verbose, opened, pasted
from ncgear.cli.as_json import tell
from ncgear.cli.progress import steps_shown

STEPS = 4
"""Steps of the search, about: laws, materials, machines, limits."""


def design(
    design_file: DesignFile,
    scheduler: Scheduler = None,
    processes: Processes = None,
    out: Annotated[
        Path | None, typer.Option(metavar="DIR", help="Output folder.", show_default="export/<design name>-machines")
    ] = None,
    as_json: AsJson = False,
    verbose: Verbose = False,
) -> None:
    """Find whole machines: law, gears, material, flywheel and motor together, and how far from the best they are.

    Ctrl-C ends the search, and the machines found until then are written.
    """
    from ncgear.files.manifest import publish_run
    from ncgear.files.publish import prepare
    from ncgear.workers import one_thread_each

    with one_thread_each(), opened(design_file) as loaded:
        from ncgear.files.whole_machines import machine_files
        from ncgear.whole_machines.search import MachineSearch
        from ncgear.whole_machines.told import machines_answer, machines_figures

        folder = out or EXPORT / f"{loaded.design.name}-machines"
        prepare(folder)
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
        answer = machines_answer(found, f"ncgear build {pasted(folder / f'{best.name}.yaml')}")
        figures = machines_figures(found)
        tell(answer, figures, as_json=as_json, verbose=verbose, paths=run.paths, kept=run.kept)
        if interrupted:
            # The end of an interrupted command loses what is not written yet
            sys.stdout.flush()
            raise KeyboardInterrupt
