"""``ncgear new``: a design file to begin with."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from ncgear.design.naming import NAME_RULE, is_name
from ncgear.design.template import Law, template
from ncgear.errors import WrongInput


def new(
    name: Annotated[str, typer.Argument(metavar="NAME", help=f"Name of the design: {NAME_RULE}.")],
    law: Annotated[Law, typer.Option(help="The motion law to begin with.")] = Law.THREE_SEGMENT_STROKE,
) -> None:
    """Write NAME.yaml, a commented design file to begin with, into the current folder."""
    if not is_name(name):
        raise WrongInput(f"{name!r} cannot name a design; {NAME_RULE}, without .yaml, is right", key="NAME")
    path = Path(f"{name}.yaml")
    try:
        # Mode x: a file that is already there is refused even if it appears at this very moment.
        with path.open("x", encoding="utf-8") as file:
            file.write(template(name, law))
    except FileExistsError as error:
        raise WrongInput("exists already; choose another name, or remove it", location=str(path)) from error
    typer.echo(path)
