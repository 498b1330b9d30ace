"""``ncgear explain``: what a key means."""

from __future__ import annotations

from typing import Annotated

import typer

from ncgear.cli.completion import keys_to_complete
from ncgear.cli.schema import FileKind, model_of


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
    from ncgear.design.reference.keys import keys_of
    from ncgear.design.reference.lookup import looked_up
    from ncgear.output.explained import explained, tree

    root = model_of(of)
    keys = keys_of(root)
    typer.echo(tree(keys) if key is None else explained(keys, looked_up(keys, key), root))
