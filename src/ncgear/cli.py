"""The command line. Numerical libraries are imported inside the commands, so that help and usage errors come at once.

Results go to stdout, everything else to stderr. Exit status: 0 done, 1 a fault in ncgear, 2 wrong input, 3 no such
mechanism, 130 interrupted.
"""

from __future__ import annotations

import json
import os
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, NoReturn

import typer

from ncgear import __version__
from ncgear.design.naming import NAME_RULE, is_name
from ncgear.design.template import Law, template
from ncgear.dynamics.level import Level
from ncgear.errors import DesignError, WrongInput

if TYPE_CHECKING:
    from ncgear.design.load import LoadedDesign


class FileKind(StrEnum):
    """Files that ncgear reads."""

    DESIGN = "design"
    BALANCE = "balance"


INTERRUPTED = 130
WRONG_INPUT = 2
FAULT = 1
SILENT_SECONDS = 1.0

app = typer.Typer(
    name="ncgear",
    help="Non-circular gears from the motion of a slider. A design file says how it should move.",
    epilog="Exit status: 0 done, 2 wrong input, 3 no such mechanism exists, 1 a fault in ncgear.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
)

DesignFile = Annotated[
    Path, typer.Argument(metavar="DESIGN.yaml", help="The design file; `ncgear new` writes one to begin with.")
]
Timing = Annotated[bool, typer.Option("--timing", help="Also print, to stderr, how long each stage took.")]


def main() -> NoReturn:
    """Run the command line and exit with its status."""
    try:
        app()
        status = 0
    except KeyboardInterrupt:
        status = INTERRUPTED
    except DesignError as error:
        status = _say(str(error), error.exit_status)
    except OSError as error:
        status = _say(_of_system(error), WRONG_INPUT)
    except Exception as error:
        status = _internal_fault(error)
    sys.exit(status)


def _print_version(wanted: bool) -> None:
    if wanted:
        typer.echo(f"ncgear {__version__}")
        raise typer.Exit


@app.callback()
def _options(
    version: Annotated[
        bool,
        # Eager and by callback: only so is it heeded before the missing command is.
        typer.Option("--version", callback=_print_version, is_eager=True, help="Print the version and exit."),
    ] = False,
) -> None:
    pass


@app.command()
def build(
    design_file: DesignFile,
    out: Annotated[
        Path | None, typer.Option(metavar="DIR", help="Output folder.", show_default="export/<design name>")
    ] = None,
    timing: Timing = False,
) -> None:
    """Build the gears: outlines, solids, plots, motion law and summary, into a folder."""
    from ncgear.output.publish import prepare

    with _design(design_file) as loaded:
        folder = out or Path("export") / loaded.design.name
        prepare(folder)
        if loaded.design.gears is None:
            raise WrongInput("missing; a build needs it (teeth, module_mm, face_width_mm, ...)", key="gears")

        from ncgear.drive import Drive
        from ncgear.output.build import build as build_files
        from ncgear.output.report import build_text, timing_text

        drive = Drive(loaded.design)
        with _progress() as on_stage:
            built = build_files(drive, folder, on_stage)
        typer.echo(build_text(built.summaries, built.paths))
        if timing:
            typer.echo(timing_text(drive), err=True)


@app.command()
def check(
    design_file: DesignFile,
    as_json: Annotated[bool, typer.Option("--json", help="Print the results as JSON.")] = False,
    timing: Timing = False,
) -> None:
    """Check a design: kinematics and power only, no teeth, no files."""
    with _design(design_file) as loaded:
        from ncgear.drive import Drive
        from ncgear.output.report import check_text, timing_text
        from ncgear.output.summary import check_summary

        drive = Drive(loaded.design)
        with _progress() as on_stage:
            on_stage("kinematics and power")
            text = json.dumps(check_summary(drive), indent=2, allow_nan=False) if as_json else check_text(drive)
        typer.echo(text)
        if timing:
            typer.echo(timing_text(drive), err=True)


@app.command()
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

    with _design(design_file) as loaded:
        folder = out or Path("export") / f"{loaded.design.name}-{level}"
        prepare(folder)

        from ncgear.drive import Drive
        from ncgear.output.report import timing_text
        from ncgear.output.simulated import simulate as simulate_drive
        from ncgear.output.simulated import simulation_files, simulation_text

        drive = Drive(loaded.design)
        with _progress() as on_stage:
            on_stage(f"simulation, level {level}")
            found = simulate_drive(drive, level)
        typer.echo(simulation_text(found, publish(folder, simulation_files(found))))
        if timing:
            typer.echo(timing_text(drive), err=True)


@app.command()
def optimize(
    design_file: DesignFile,
    out: Annotated[
        Path | None, typer.Option(metavar="DIR", help="Output folder.", show_default="export/<design name>-optimized")
    ] = None,
) -> None:
    """Find the best law for a design's machine, with a certificate of how close to the limit it is."""
    from ncgear.output.publish import prepare, publish

    with _design(design_file) as loaded:
        from ncgear.improvement import Improvement
        from ncgear.output.frontier_files import LIMIT_PICTURE, limit_picture
        from ncgear.output.optimized import certificate, optimized_design, optimized_name
        from ncgear.output.optimized_text import optimized_text

        improvement = Improvement(loaded.design)
        name = optimized_name(improvement)
        folder = out or Path("export") / name
        prepare(folder)
        with _progress() as on_stage:
            on_stage("certified limit")
            improvement.bound  # noqa: B018
            on_stage("makeable law")
            written = optimized_design(loaded.text, improvement)
            on_stage("figures")
            text = json.dumps(certificate(improvement), indent=2, allow_nan=False) + "\n"
            files = {f"{name}.yaml": written.encode(), "certificate.json": text.encode()}
            if improvement.limit_points:
                on_stage("picture")
                files[LIMIT_PICTURE] = limit_picture(improvement)
        paths = publish(folder, files, obsolete=[LIMIT_PICTURE])
        typer.echo(optimized_text(improvement, paths))


@app.command()
def frontier(
    design_file: DesignFile,
    points: Annotated[int, typer.Option(min=2, max=200, help="Points from least power to least acceleration.")] = 20,
    out: Annotated[
        Path | None, typer.Option(metavar="DIR", help="Output folder.", show_default="export/<design name>-frontier")
    ] = None,
) -> None:
    """Set power against acceleration: certified limit, best laws, published family, mechanisms, all at one speed.

    Uses all cores; finished points are kept in the folder, so that a run that was interrupted goes on from there.
    """
    from ncgear.output.publish import prepare, publish

    with _design(design_file) as loaded:
        from ncgear.frontier import frontier as frontier_of
        from ncgear.improvement import Improvement
        from ncgear.output.frontier_files import frontier_files, frontier_text

        folder = out or Path("export") / f"{loaded.design.name}-frontier"
        prepare(folder)
        with _counted() as on_point:
            found = frontier_of(loaded.design, points, folder, on_point)
        improvement = Improvement(loaded.design)
        typer.echo(frontier_text(found, improvement, publish(folder, frontier_files(found, improvement))))


@app.command()
def sweep(
    design_file: DesignFile,
    vary: Annotated[
        list[str],
        typer.Option(metavar="KEY=FROM:TO:COUNT", help="A key of the file and its values; again for another key."),
    ],
    out: Annotated[
        Path | None, typer.Option(metavar="DIR", help="Output folder.", show_default="export/<design name>-sweep")
    ] = None,
) -> None:
    """Screen many designs: check and pitch curves, without teeth, for all combinations of some keys' values."""
    from ncgear.design.varied import designs_of, require_grid, varied_of
    from ncgear.output.publish import prepare, publish

    varied = [varied_of(text) for text in vary]
    with _design(design_file) as loaded:
        require_grid(loaded, varied)
        folder = out or Path("export") / f"{loaded.design.name}-sweep"
        prepare(folder)

        from ncgear.output.sweep import sweep_csv, sweep_text
        from ncgear.screening.screen import screened

        with _progress() as on_stage:
            on_stage("designs")
            found = screened(list(designs_of(loaded, varied)))
        typer.echo(sweep_text(varied, found, publish(folder, {"sweep.csv": sweep_csv(varied, found).encode()})))


@app.command()
def bench(
    out: Annotated[Path, typer.Option(metavar="DIR", help="Output folder.")] = Path("export/bench"),
    only: Annotated[
        list[str] | None, typer.Option(metavar="KEY", help="A study to make, may be given again; left out: all.")
    ] = None,
) -> None:
    """Measure speed against error of every number ncgear reports; write a page of tables, and plots."""
    from ncgear.output.precision_files import bench_text, write
    from ncgear.output.publish import prepare
    from ncgear.precision.catalogue import made
    from ncgear.precision.measure import measured

    studies, left_out = made(only or [])
    prepare(out)
    for reason in left_out:
        typer.echo(reason, err=True)
    found = []
    for number, study in enumerate(studies, 1):
        typer.echo(f"{number} of {len(studies)}: {study.key}", err=True)
        found.append(measured(study))
    typer.echo(bench_text(found, write(out, found)))


@app.command()
def balance(
    balance_file: Annotated[Path, typer.Argument(metavar="FILE.yaml", help="The balance file.")],
    out: Annotated[
        Path | None, typer.Option(metavar="DIR", help="Output folder.", show_default="export/<name>-balance")
    ] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print the results as JSON.")] = False,
) -> None:
    """Say how much a machine shakes, and what mass where would stop it: linkages, gears, rotors, frequencies."""
    from ncgear.design.load_balance import load_balance
    from ncgear.output.publish import prepare, publish

    loaded = load_balance(balance_file)
    folder = out or Path("export") / f"{loaded.balance.name}-balance"
    prepare(folder)

    from ncgear.balancing import Balancing
    from ncgear.output.balance.figures import balance_text, figures_of
    from ncgear.output.balance.files import balance_files

    balancing = Balancing(loaded)
    try:
        with _progress() as on_stage:
            on_stage("balance")
            figures = figures_of(balancing)
            on_stage("pictures")
            files = balance_files(balancing, figures)
    except DesignError as error:
        raise loaded.located(error) from error
    paths = publish(folder, files)
    typer.echo(files["balance.json"].decode().rstrip() if as_json else balance_text(figures, paths))


@app.command()
def new(
    name: Annotated[str, typer.Argument(metavar="NAME", help=f"Name of the design: {NAME_RULE}.")],
    law: Annotated[Law, typer.Option(help="The motion law to begin with.")] = Law.THREE_SEGMENT_STROKE,
) -> None:
    """Write NAME.yaml, a commented design file to begin with, into the current folder."""
    if not is_name(name):
        raise WrongInput(f"{name!r} cannot name a design; {NAME_RULE}, without .yaml, is right", key="NAME")
    path = Path(f"{name}.yaml")
    try:
        # Mode x: a file that is already there is refused even if it appears at this very moment.
        with path.open("x", encoding="utf-8") as file:
            file.write(template(name, law))
    except FileExistsError as error:
        raise WrongInput("exists already; choose another name, or remove it", location=str(path)) from error
    typer.echo(path)


@app.command()
def reproduce(
    out: Annotated[Path, typer.Option(metavar="DIR", help="Output folder.")] = Path("export/reproduction"),
) -> None:
    """Compute every figure of the four papers that ncgear is built on, and say which can be reproduced."""
    from ncgear.output.publish import prepare, publish

    prepare(out)
    with _progress() as on_stage:
        on_stage("figures of four papers")
        from ncgear.ledger.catalogue import PAPERS
        from ncgear.ledger.judgement import judgement
        from ncgear.output.ledger import PAGE, ledger_page, ledger_text

        judgements = [judgement(paper) for paper in PAPERS]
    paths = publish(out, {PAGE: ledger_page(judgements).encode()})
    typer.echo(ledger_text(judgements, paths))


@app.command()
def schema(
    of: Annotated[FileKind, typer.Option(help="The kind of file.")] = FileKind.DESIGN,
) -> None:
    """Print the JSON Schema of a design or a balance file, for editors that complete and check while typing."""
    from ncgear.design.balance import Balance
    from ncgear.design.schema import Design, json_schema

    typer.echo(json.dumps(json_schema(Balance if of is FileKind.BALANCE else Design), indent=2))


@contextmanager
def _design(path: Path) -> Iterator[LoadedDesign]:
    """The design of a file; errors raised while it is in use get the place of their key in that file."""
    from ncgear.design.load import load, with_location

    loaded = load(path)
    try:
        yield loaded
    except DesignError as error:
        raise with_location(error, loaded) from error


@contextmanager
def _counted() -> Iterator[Callable[[int, int], None]]:
    """A function to say how many of how many points are done; a terminal shows a bar."""
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

    columns = TextColumn("points"), BarColumn(), MofNCompleteColumn(), TimeElapsedColumn()
    with Progress(*columns, console=Console(stderr=True), disable=not sys.stderr.isatty(), transient=True) as bar:
        task = bar.add_task("points", total=None)
        yield lambda done, total: bar.update(task, completed=done, total=total)


@contextmanager
def _progress() -> Iterator[Callable[[str], None]]:
    """A function to name the stage at work with; a terminal shows it once the work takes over a second."""
    if not sys.stderr.isatty():
        yield lambda stage: None
        return
    from rich.console import Console
    from rich.markup import escape

    status = Console(stderr=True).status("starting")
    timer = threading.Timer(SILENT_SECONDS, status.start)
    timer.daemon = True
    timer.start()
    try:
        yield lambda stage: status.update(escape(stage))
    finally:
        timer.cancel()
        # A start already under way must end before the stop, or the spinner would stay.
        timer.join()
        status.stop()


def _say(message: str, status: int) -> int:
    typer.echo(message, err=True)
    return status


def _of_system(error: OSError) -> str:
    parts = [str(part) for part in (error.filename, error.strerror or error) if part]
    return f"{': '.join(parts)}; give a path that can be read or written"


def _internal_fault(error: Exception) -> int:
    if os.environ.get("NCGEAR_DEBUG"):
        import traceback

        traceback.print_exception(error)
    reason = " ".join(f"{type(error).__name__}: {error}".split())
    return _say(f"ncgear: internal fault: {reason}, please report", FAULT)
