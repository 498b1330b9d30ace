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
    with stages_shown() as on_stage:
        on_stage("figures of four papers")
        from ncgear.ledger.catalogue import PAPERS
        from ncgear.ledger.judgement import judgement
        from ncgear.output.ledger import PAGE, ledger_page, ledger_text

        judgements = [judgement(paper) for paper in PAPERS]
    paths = publish(out, {PAGE: ledger_page(judgements).encode()})
    typer.echo(ledger_text(judgements, paths))
