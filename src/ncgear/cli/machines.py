"""``ncgear balance``: how much a machine shakes.

``ncgear reproduce``: the papers' figures.
"""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from ncgear.cli.arguments import EXPORT, files_to_complete
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
    from ncgear.design.reading.balance_file import load_balance
    from ncgear.files.publish import prepare, publish

    loaded = load_balance(balance_file)
    folder = out or EXPORT / f"{loaded.balance.name}-balance"
    prepare(folder)

    from ncgear.figures.balance import balance_text, figures_of
    from ncgear.files.balance import balance_files
    from ncgear.project.balancing import Balancing

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


def reproduce(
    out: Annotated[Path, typer.Option(metavar="DIR", help="Output folder.")] = Path("export/reproduction"),
) -> None:
    """Compute every figure of the four papers that ncgear is built on, and say which can be reproduced."""
    from ncgear.files.publish import prepare, publish

    prepare(out)
    from ncgear.figures.ledger import PAGE, ledger_page, ledger_text
    from ncgear.papers.catalogue import PAPERS
    from ncgear.papers.judgement import judgement

    judgements = []
    with stages_shown(len(PAPERS)) as on_stage:
        for paper in PAPERS:
            on_stage(paper.title)
            judgements.append(judgement(paper))
    paths = publish(out, {PAGE: ledger_page(judgements).encode()})
    typer.echo(ledger_text(judgements, paths))
