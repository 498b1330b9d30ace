"""``ncgear balance``: how much a machine shakes."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from ncgear.cli.arguments import EXPORT
from ncgear.cli.completion import files_to_complete
from ncgear.cli.progress import stages_shown
from ncgear.errors import DesignError


def balance(
    balance_file: Annotated[
        Path, typer.Argument(metavar="FILE.yaml", help="The balance file.", autocompletion=files_to_complete)
    ],
    out: Annotated[
        Path | None, typer.Option(metavar="DIR", help="Output folder.", show_default="export/<name>-balance")
    ] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print the results as JSON.")] = False,
) -> None:
    """Say how much a machine shakes, and what mass where would stop it: linkages, gears, rotors, frequencies."""
    from ncgear.design.load_balance import load_balance
    from ncgear.output.publish import prepare, publish

    loaded = load_balance(balance_file)
    folder = out or EXPORT / f"{loaded.balance.name}-balance"
    prepare(folder)

    from ncgear.balancing import Balancing
    from ncgear.output.balance.figures import balance_text, figures_of
    from ncgear.output.balance.files import balance_files

    balancing = Balancing(loaded)
    try:
        with stages_shown(2) as on_stage:
            on_stage("balance")
            figures = figures_of(balancing)
            on_stage("pictures")
            files = balance_files(balancing, figures)
    except DesignError as error:
        raise loaded.located(error) from error
    paths = publish(folder, files)
    typer.echo(files["balance.json"].decode().rstrip() if as_json else balance_text(figures, paths))
