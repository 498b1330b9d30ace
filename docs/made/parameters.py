"""Arguments and options of a command, read from the annotations of its function."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from dataclasses import dataclass
from enum import Enum
from types import NoneType
from typing import Annotated, Any, get_args, get_origin

import typer
from typer.models import ArgumentInfo, OptionInfo


@dataclass(frozen=True)
class Parameter:
    """One argument or option; ``default`` is what holds where it is left out, None where nothing is said of it."""

    name: str
    info: ArgumentInfo | OptionInfo
    kinds: tuple[type, ...]
    default: Any

    @property
    def required(self) -> bool:
        """Whether the command cannot do without it."""
        return self.default is inspect.Parameter.empty

    @property
    def called(self) -> str:
        """How it is written on the command line."""
        if isinstance(self.info, ArgumentInfo):
            return str(self.info.metavar)
        # In an annotation typer takes the first flag for the default.
        flags = [one for one in (self.info.default, *(self.info.param_decls or ())) if isinstance(one, str)]
        flag = next(iter(flags), f"--{self.name}").replace("_", "-")
        return f"{flag} {self.value}".rstrip()

    @property
    def value(self) -> str:
        """What stands behind an option: nothing behind a switch."""
        kind = self.kinds[0]
        if self.info.metavar:
            return self.info.metavar
        if issubclass(kind, Enum):
            return "|".join(str(one.value) for one in kind)
        return "" if kind is bool else {"int": "N", "float": "X"}.get(kind.__name__, kind.__name__.upper())

    @property
    def left_out(self) -> str:
        """What holds where it is left out."""
        if self.required:
            return "must be given"
        if isinstance(self.info.show_default, str):
            return f"`{self.info.show_default}`"
        if self.default in (None, False):
            return "-"
        return f"`{self.default.value if isinstance(self.default, Enum) else self.default}`"


def parameters_of(function: Callable[..., None]) -> list[Parameter]:
    """The parameters of a command's function that a person gives, in order."""
    signature = inspect.signature(function, eval_str=True).parameters
    return [_parameter(name, one) for name, one in signature.items() if one.annotation is not typer.Context]


def _parameter(name: str, one: inspect.Parameter) -> Parameter:
    assert get_origin(one.annotation) is Annotated, name
    annotation, info = get_args(one.annotation)
    return Parameter(name, info, _kinds(annotation), one.default)


def _kinds(annotation: Any) -> tuple[type, ...]:
    """The plain types of an annotation: of a list those of its items, nothing of None."""
    if isinstance(annotation, type) and not get_args(annotation):
        return () if annotation is NoneType else (annotation,)
    return tuple(kind for part in get_args(annotation) for kind in _kinds(part))
