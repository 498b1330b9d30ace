"""Commands that look things up: explain and schema tell of the keys of files, reproduce of the papers' figures."""

from __future__ import annotations

import json
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from ncgear.cli.arguments import keys_to_complete
from ncgear.cli.progress import steps_shown

if TYPE_CHECKING:
    from ncgear.design.keys.base import Model


class FileKind(StrEnum):
    """Files that ncgear reads."""

    DESIGN = "design"
    BALANCE = "balance"


def model_of(kind: FileKind) -> type[Model]:
    """The model of a kind of file."""
    from ncgear.design.keys.balance import Balance
    from ncgear.design.keys.design import Design

    return Balance if kind is FileKind.BALANCE else Design


def explain(
    key: Annotated[
        str | None,
        typer.Argument(
            metavar="[KEY]",
            help="A key, or its last part: gears.rack.profile, profile, theta2. Left out: all keys.",
            autocompletion=keys_to_complete,
        ),
    ] = None,
    of: Annotated[FileKind, typer.Option(help="The kind of file.")] = FileKind.DESIGN,
) -> None:
    """Say what a key of a design or a balance file means: unit, values, default, an example."""
    from ncgear.design.reference import keys_of, looked_up
    from ncgear.figures.explained import explained, tree

    root = model_of(of)
    keys = keys_of(root)
    typer.echo(tree(keys) if key is None else explained(keys, looked_up(keys, key), root))


def schema(
    of: Annotated[FileKind, typer.Option(help="The kind of file.")] = FileKind.DESIGN,
) -> None:
    """Print the JSON Schema of a design or a balance file, for editors that complete and check while typing."""
    from ncgear.design.keys.design import json_schema

    typer.echo(json.dumps(json_schema(model_of(of)), indent=2))


def reproduce(
    out: Annotated[Path, typer.Option(metavar="DIR", help="Output folder.")] = Path("export/reproduction"),
) -> None:
    """Compute every figure of the four papers that ncgear is built on, and say which can be reproduced."""
    from ncgear.files.publish import prepare, publish

    prepare(out)
    from ncgear.figures.ledger import PAGE, ledger_page, ledger_text
    from ncgear.papers.judgement import PAPERS, judgement

    judgements = []
    with steps_shown(len(PAPERS)) as on_step:
        for paper in PAPERS:
            on_step(paper.title)
            judgements.append(judgement(paper))
    paths = publish(out, {PAGE: ledger_page(judgements).encode()})
    typer.echo(ledger_text(judgements, paths))
