"""``ncgear bench``: speed against error."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from ncgear.cli.progress import steps_shown


def bench(
    out: Annotated[Path, typer.Option(metavar="DIR", help="Output folder.")] = Path("export/bench"),
    only: Annotated[
        list[str] | None, typer.Option(metavar="KEY", help="A study to make, may be given again; left out: all.")
    ] = None,
) -> None:
    """Measure speed against error of every number ncgear reports; write a page of tables, and plots."""
    from ncgear.files.publish import prepare
    from ncgear.precision.catalogue import made
    from ncgear.precision.measure import measured
    from ncgear.precision.told.files import bench_text, write

    studies, left_out = made(only or [])
    prepare(out)
    for reason in left_out:
        typer.echo(reason, err=True)
    found = []
    with steps_shown(len(studies)) as on_step:
        for study in studies:
            on_step(study.key)
            found.append(measured(study))
    typer.echo(bench_text(found, write(out, found)))
