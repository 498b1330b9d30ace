"""Commands that take what needs no conversion as it is given, so that they begin without loading pydantic.

typer converts every value of the command line by an adapter of pydantic, which takes longer to load than typer itself.
Text, paths, names to choose, and what is left out are right without one: so a build begins its second process before
pydantic is loaded.
"""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path
from typing import Any

from typer.core import TyperCommand, TyperGroup


class PlainCommand(TyperCommand):
    """A command whose parameters convert only what must be converted."""

    def get_params(self, ctx: Any) -> Any:
        """The parameters, with that of the help."""
        return _plain(super().get_params(ctx))


class PlainGroup(TyperGroup):
    """The same of the program's own parameters."""

    def get_params(self, ctx: Any) -> Any:
        """The parameters, with that of the help."""
        return _plain(super().get_params(ctx))


def _plain(parameters: list[Any]) -> list[Any]:
    for parameter in parameters:
        if "process_value" not in vars(parameter) and hasattr(parameter, "type_descriptor"):
            parameter.process_value = _as_given(parameter)
    return parameters


def _as_given(parameter: Any) -> Any:
    """What typer processes a parameter's value by, passed over where the value is already what it should be."""
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
