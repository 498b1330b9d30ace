"""The head of each command's page: how it is called, its arguments and options, read from the application."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from made.parameters import Parameter, parameters_of
from ncgear.cli.app import COMMANDS

FOLDER = Path(__file__).parents[1] / "commands"

END = "<!-- Above: made by `make docs` from the program. Below: written by hand. -->"

NAMES = {function.__name__: function for function in COMMANDS}
"""The function of each command."""


def head(name: str) -> str:
    """The head of a command's page, up to and with the line that ends it."""
    function = NAMES[name]
    found = parameters_of(function)
    usage = " ".join(["ncgear", name, *(_in_usage(one) for one in found)])
    table = ["| | meaning | left out |", "|---|---|---|", *(_row(one) for one in found)] if found else []
    return "\n".join(
        [f"# ncgear {name}", "", _says(function), "", f"    {usage}", "", *table, *[""] * bool(table), END]
    )


def with_head(page: str, name: str) -> str:
    """A page with the head of today's program in the place of its own."""
    by_hand = page.partition(END)[2] or "\n"
    return f"{head(name)}{by_hand}"


def _says(function: Callable[..., None]) -> str:
    return " ".join(str(function.__doc__).split())


def _in_usage(one: Parameter) -> str:
    return one.called if one.required else f"[{one.called.strip('[]')}]"


def _row(one: Parameter) -> str:
    cells = f"`{one.called}`".replace("|", "\\|"), one.info.help, one.left_out
    return f"| {' | '.join(str(cell) for cell in cells)} |"
