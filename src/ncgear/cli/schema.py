"""``ncgear schema``: what design files may hold."""

from __future__ import annotations

import json
from enum import StrEnum
from typing import Annotated

import typer


class FileKind(StrEnum):
    """Files that ncgear reads."""

    DESIGN = "design"
    BALANCE = "balance"


def schema(
    of: Annotated[FileKind, typer.Option(help="The kind of file.")] = FileKind.DESIGN,
) -> None:
    """Print the JSON Schema of a design or a balance file, for editors that complete and check while typing."""
    from ncgear.design.balance import Balance
    from ncgear.design.schema import Design, json_schema

    typer.echo(json.dumps(json_schema(Balance if of is FileKind.BALANCE else Design), indent=2))
