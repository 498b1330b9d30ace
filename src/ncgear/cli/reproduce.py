"""``ncgear reproduce``: the papers' figures."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from ncgear.cli.progress import stages_shown


def reproduce(
    out: Annotated[Path, typer.Option(metavar="DIR", help="Output folder.")] = Path("export/reproduction"),
) -> None:
    """Compute every figure of the four papers that ncgear is built on, and say which can be reproduced."""
    from ncgear.output.publish import prepare, publish

    prepare(out)
    from ncgear.ledger.catalogue import PAPERS
    from ncgear.ledger.judgement import judgement
    from ncgear.output.ledger import PAGE, ledger_page, ledger_text

    judgements = []
    with stages_shown(len(PAPERS)) as on_stage:
        for paper in PAPERS:
            on_stage(paper.title)
            judgements.append(judgement(paper))
    paths = publish(out, {PAGE: ledger_page(judgements).encode()})
    typer.echo(ledger_text(judgements, paths))
