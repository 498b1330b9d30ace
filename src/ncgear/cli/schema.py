"""``ncgear schema``: what design files may hold."""

from __future__ import annotations

import json
from enum import StrEnum
from typing import TYPE_CHECKING, Annotated

import typer

if TYPE_CHECKING:
    from ncgear.design.base import Model


class FileKind(StrEnum):
    """Files that ncgear reads."""

    DESIGN = "design"
    BALANCE = "balance"


def model_of(kind: FileKind) -> type[Model]:
    """The model of a kind of file."""
    from ncgear.design.balance import Balance
    from ncgear.design.schema import Design

    return Balance if kind is FileKind.BALANCE else Design


def schema(
    of: Annotated[FileKind, typer.Option(help="The kind of file.")] = FileKind.DESIGN,
) -> None:
    """Print the JSON Schema of a design or a balance file, for editors that complete and check while typing."""
    from ncgear.design.schema import json_schema

    typer.echo(json.dumps(json_schema(model_of(of)), indent=2))
