"""The command that screens many designs, and follows the best of them deeper."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

from ncgear.cli import arguments
from ncgear.cli.progress import counted
from ncgear.errors import WrongInput


class Sampling(StrEnum):
    """How points are sampled."""

    SOBOL = "sobol"
    LATIN_HYPERCUBE = "latin-hypercube"


class Depth(StrEnum):
    """How far designs are computed."""

    CHECK = "check"
    PITCH = "pitch"
    TEETH = "teeth"
    CONTACT = "contact"
    STRENGTH = "strength"


@contextmanager
def _about_options(design_file: Path) -> Iterator[None]:
    """A context whose errors are about options for a file, not about a place in it."""
    try:
        yield
    except WrongInput as error:
        error.location = str(design_file)
        raise


def sweep(
    design_file: arguments.DesignFile,
    vary: Annotated[
        list[str],
        typer.Option(
            metavar="KEY=VALUES",
            help="A key of the file and its values: FROM:TO:COUNT, A,B,C, or FROM:TO to be sampled; again for others.",
        ),
    ],
    samples: Annotated[
        int | None, typer.Option(metavar="N", min=1, help="Points sampled of all ranges FROM:TO together.")
    ] = None,
    sampling: Annotated[Sampling, typer.Option(help="How points are sampled.")] = Sampling.SOBOL,
    seed: Annotated[int, typer.Option(min=0, help="Another seed samples other points.")] = 1,
    keep_if: Annotated[
        list[str] | None,
        typer.Option(metavar="'FIGURE < NUMBER'", help="A condition that a design must keep to count; again for more."),
    ] = None,
    objective: Annotated[
        list[str] | None,
        typer.Option(
            metavar="FIGURE",
            help="A figure to minimise, or to maximise with max: before it; again for more.",
            show_default="peak acceleration and peak power",
        ),
    ] = None,
    stage: Annotated[Depth, typer.Option(help="How far the best designs are followed.")] = Depth.PITCH,
    keep: Annotated[int, typer.Option(metavar="N", min=1, help="Best designs that go on beyond pitch curves.")] = 100,
    scheduler: arguments.Scheduler = None,
    processes: arguments.Processes = None,
    out: Annotated[Path | None, arguments.folder_option("-sweep")] = None,
    as_json: arguments.AsJson = False,
    verbose: arguments.Verbose = False,
) -> None:
    """Screen many designs, up to millions: grids, lists or samples of some keys' values; the best go on to teeth.

    Uses all cores; finished parts are kept in the folder, so that a run that was interrupted goes on from there.
    """
    from ncgear.workers import one_thread_each

    # Several threads of linear algebra add in another order: figures would differ in their last digits from the figures
    # of processes with one thread.  No module that starts such threads is imported yet.
    with one_thread_each():
        from ncgear.design.space import space_of, varied_of

        varied = [varied_of(text) for text in vary]
    with one_thread_each(), arguments.opened(design_file) as loaded:
        with _about_options(design_file):
            space = space_of(loaded, varied, samples, sampling.value, seed)
        folder = arguments.prepared(out, f"{loaded.design.name}-sweep")

        from ncgear.figures.sweep import sweep_figures, swept_answer
        from ncgear.files.manifest import publish_run
        from ncgear.files.sweep_run import Order, names_of, screening_of, swept
        from ncgear.screening.wanted import Wanted, constraint_of, objectives_of

        order = Order(space, stage.value, keep)
        screening = screening_of(loaded.design, loaded.data, order)
        names = names_of(loaded.design, screening, stage.value)
        with _about_options(design_file):
            constraints = tuple(constraint_of(text, names) for text in keep_if or ())
            wanted = Wanted(constraints, objectives_of(objective or (), names))
        with counted("designs", folder) as on_done:
            found = swept(loaded, order, screening, wanted, folder, on_done, scheduler, processes)

        from ncgear.files.sweep import first_best, sweep_files

        figures = sweep_figures(loaded.design.name, found.screened, found.deeper, stage.value)
        files = sweep_files(loaded, found.last, found.screened, figures)
        run = publish_run(folder, files, "sweep")
        run.paths.extend(found.tables)
        best = first_best(files)
        then = f"ncgear build {arguments.pasted(folder / best)}" if best else "give other values, or fewer constraints"
        answer = swept_answer(loaded.design, found.screened, found.deeper, stage.value, then)
        arguments.tell(answer, figures, as_json=as_json, verbose=verbose, run=run)
