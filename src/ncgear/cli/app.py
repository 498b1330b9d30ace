"""The application: its commands and options."""

from __future__ import annotations

from typing import Annotated

import typer

from ncgear import __version__
from ncgear.cli.animate import animate
from ncgear.cli.balance import balance
from ncgear.cli.build import build
from ncgear.cli.check import check
from ncgear.cli.explain import explain
from ncgear.cli.frontier import frontier
from ncgear.cli.new import new
from ncgear.cli.optimize import optimize
from ncgear.cli.report import report
from ncgear.cli.reproduce import reproduce
from ncgear.cli.schema import schema
from ncgear.cli.simulate import simulate
from ncgear.cli.sweep import sweep

app = typer.Typer(
    name="ncgear",
    help="Non-circular gears from the motion of a slider. A design file says how it should move.",
    epilog="Exit status: 0 done, 2 wrong input, 3 no such mechanism exists, 1 a fault in ncgear.",
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
)

COMMANDS = (
    build,
    report,
    animate,
    check,
    simulate,
    optimize,
    frontier,
    sweep,
    balance,
    new,
    explain,
    reproduce,
    schema,
)
"""In the order of the help."""

for command in COMMANDS:
    app.command()(command)


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
