"""The application: its commands and options."""

from __future__ import annotations

import re
from contextlib import suppress
from typing import Annotated

import typer

from ncgear import __version__
from ncgear.cli.as_given import PlainCommand, PlainGroup
from ncgear.cli.bench import bench
from ncgear.cli.compare import compare
from ncgear.cli.design import design
from ncgear.cli.formulas import formulas
from ncgear.cli.lookup import examples, explain, freecad, reproduce, schema
from ncgear.cli.machine import animate, balance, build, check, report, simulate, strength
from ncgear.cli.measured import measured
from ncgear.cli.new import new
from ncgear.cli.search import fit, frontier, optimize, size
from ncgear.cli.studio import studio
from ncgear.cli.sweep import sweep
from ncgear.cli.tolerance import tolerance

app = typer.Typer(
    name="ncgear",
    cls=PlainGroup,
    help="Non-circular gears from the motion of a slider. A design file says how it should move.",
    epilog="Exit status: 0 done, 2 wrong input, 3 no such mechanism exists, 1 a fault in ncgear.",
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
)

COMMANDS = (
    studio,
    build,
    report,
    animate,
    check,
    compare,
    formulas,
    simulate,
    strength,
    tolerance,
    size,
    design,
    optimize,
    frontier,
    fit,
    sweep,
    measured,
    bench,
    balance,
    new,
    examples,
    explain,
    reproduce,
    schema,
    freecad,
)
"""All commands, in the order in which the help lists them."""

for command in COMMANDS:
    # What is looked up may be of several words
    app.command(cls=PlainCommand, context_settings={"allow_extra_args": command is explain})(command)


def _libraries() -> dict[str, str]:
    """The versions of the libraries that are installed of those that ncgear can use, for reports of faults."""
    from importlib.metadata import PackageNotFoundError, requires, version

    found = {}
    for name in dict.fromkeys(re.split(r"[^\w.-]", one)[0] for one in requires("ncgear") or () if "dev" not in one):
        with suppress(PackageNotFoundError):
            found[name] = version(name)
    return found


def _print_version(wanted: bool) -> None:
    if wanted:
        from platform import platform, python_version

        typer.echo(f"ncgear {__version__}, Python {python_version()}, {platform()}")
        typer.echo(", ".join(f"{name} {version}" for name, version in _libraries().items()))
        raise typer.Exit


@app.callback()
def _options(
    version: Annotated[
        bool,
        # Only an eager option with a callback comes before the error about a missing command.
        typer.Option("--version", callback=_print_version, is_eager=True, help="Print all versions and exit."),
    ] = False,
) -> None:
    pass
