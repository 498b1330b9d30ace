"""The application: its commands and options."""

from __future__ import annotations

import re
from contextlib import suppress
from enum import StrEnum
from pathlib import Path
from typing import Annotated, Any

import typer
from typer.core import TyperCommand, TyperGroup

from ncgear import __version__
from ncgear.cli.lookup import examples, explain, freecad, reproduce, schema
from ncgear.cli.machine import animate, balance, build, check, report, simulate, strength
from ncgear.cli.new import new
from ncgear.cli.search import design, fit, frontier, optimize, size
from ncgear.cli.studio import studio
from ncgear.cli.study import bench, compare, formulas, measured, tolerance
from ncgear.cli.sweep import sweep


class PlainCommand(TyperCommand):
    """A command whose parameters convert only values that need it."""

    def get_params(self, ctx: Any) -> Any:
        """The parameters, with the help's parameter."""
        return _plain(super().get_params(ctx))


class PlainGroup(TyperGroup):
    """A group whose own parameters convert only values that need it."""

    def get_params(self, ctx: Any) -> Any:
        """The parameters, with the help's parameter."""
        return _plain(super().get_params(ctx))


def _plain(parameters: list[Any]) -> list[Any]:
    for parameter in parameters:
        if "process_value" not in vars(parameter) and hasattr(parameter, "type_descriptor"):
            parameter.process_value = _as_given(parameter)
    return parameters


def _as_given(parameter: Any) -> Any:
    """The parameter with typer's processing of its value, which is skipped where the value already has its type."""
    processed = parameter.process_value

    def process_value(context: Any, value: Any) -> Any:
        several, asked = parameter.multiple or parameter.nargs == -1, parameter.type_descriptor.annotation
        kind = asked if isinstance(asked, type) and not several else object
        if value is None and not parameter.required:
            value = () if several else None
        elif issubclass(kind, StrEnum) and value in list(kind):
            value = kind(value)
        elif kind is Path and type(value) is str:
            value = Path(value)
        elif type(value) is not kind or kind not in (str, bool):
            return processed(context, value)
        return value if parameter.callback is None else parameter.callback(context, parameter, value)

    return process_value


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
    # The words after ``explain`` may be several
    app.command(cls=PlainCommand, context_settings={"allow_extra_args": command is explain})(command)


def _libraries() -> dict[str, str]:
    """The installed versions of the libraries that ncgear can use, for reports of faults."""
    from importlib.metadata import PackageNotFoundError, requires, version

    found = {}
    for name in dict.fromkeys(re.split(r"[^\w.-]", name)[0] for name in requires("ncgear") or () if "dev" not in name):
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
