"""Commands that look things up: keys of files, examples and macros of the program, the figures of papers."""

from __future__ import annotations

import json
from itertools import chain
from pathlib import Path
from textwrap import shorten
from typing import Annotated

import typer

from ncgear.cli.arguments import AsJson, FileKind, keys_to_complete, model_of, prepared, print_figures
from ncgear.cli.progress import steps_shown


def explain(
    context: typer.Context,
    key: Annotated[
        str | None,
        typer.Argument(
            metavar="[KEY]",
            help="A key, its last part or an idea: gears.rack.profile, profile, v2, standstill. Left out: all keys.",
            autocompletion=keys_to_complete,
        ),
    ] = None,
    of: Annotated[FileKind, typer.Option(help="The kind of file.")] = FileKind.DESIGN,
) -> None:
    """Say what a key of a design, balance or train file means: unit, values, default, an example."""
    from ncgear.design.told_keys import told_keys
    from ncgear.figures.explained import told, tree

    keys = told_keys(of)
    typer.echo(tree(keys) if key is None else told(keys, " ".join([key, *context.args])))


def examples() -> None:
    """List the worked designs that come with ncgear; `ncgear new --example NAME` writes one here."""
    from ncgear.design.template import description_of, examples
    from ncgear.figures.tables import WIDTH

    found = examples()
    width = max(map(len, found), default=0) + 2
    for name, path in found.items():
        typer.echo(f"{name:<{width}}{shorten(description_of(path), WIDTH - width, placeholder=' ...')}")


def schema(
    of: Annotated[FileKind, typer.Option(help="The kind of file.")] = FileKind.DESIGN,
    vscode: Annotated[
        Path | None,
        typer.Option(
            metavar="FOLDER", help="Write the schemas of all kinds into .vscode of a folder, named in its settings."
        ),
    ] = None,
) -> None:
    """Print the JSON Schema of a design, balance or train file, for editors that complete and check while typing."""
    if vscode is not None:
        _into_settings(vscode)
        return
    from ncgear.design.keys.design import json_schema

    typer.echo(json.dumps(json_schema(model_of(of)), indent=2))


NAMED = 4
"""Number of file patterns that are listed by name."""


def _into_settings(folder: Path) -> None:
    """Write the schemas and the settings that name them; print the written files and the files that they are for."""
    from ncgear.errors import WrongInput
    from ncgear.files.editor import SETTINGS_FOLDER, editor_files
    from ncgear.files.publish import exchange, opened

    if not folder.is_dir():
        raise WrongInput("is no folder; give the folder that is opened in VS Code", location=str(folder))
    place = folder / SETTINGS_FOLDER
    found = editor_files(folder)
    if found.files:
        with opened(place):
            exchange(place, found.files)
    for name in found.files:
        typer.echo(str(place / name))
    patterns = list(chain.from_iterable(found.patterns.values()))
    more = f" and {len(patterns) - NAMED} more" if len(patterns) > NAMED else ""
    files = f"{', '.join(patterns[:NAMED])}{more}"
    typer.echo(
        f"{'' if found.files else 'nothing to change: '}the extension YAML of Red Hat completes and checks {files}"
    )


def freecad(out: Annotated[Path, typer.Option(metavar="DIR", help="Folder for the macro.")] = Path()) -> None:
    """Write the macro for FreeCAD, which shows both gears of a design file and their pitch curves, and follows it."""
    from ncgear.files.freecad import MACRO, macro
    from ncgear.files.one_file import put_in_place
    from ncgear.files.publish import opened

    with opened(out):
        put_in_place(out / MACRO, macro().encode())
    typer.echo(str(out / MACRO))


def reproduce(
    out: Annotated[Path, typer.Option(metavar="DIR", help="Output folder.")] = Path("export/reproduction"),
    as_json: AsJson = False,
) -> None:
    """Compute every figure of the six publications that ncgear is judged by, and say which can be reproduced."""
    from ncgear.files.manifest import publish_run

    prepared(out)
    from ncgear.figures.ledger import PAGE, ledger_figures, ledger_page, ledger_text
    from ncgear.figures.numbers import json_text
    from ncgear.papers.judgement import PAPERS, judgement

    judgements = []
    with steps_shown(len(PAPERS)) as on_step:
        for paper in PAPERS:
            on_step(paper.title)
            judgements.append(judgement(paper))
    figures = ledger_figures(judgements)
    files = {PAGE: ledger_page(judgements).encode(), "reproduction.json": json_text(figures).encode()}
    run = publish_run(out, files, "reproduce")
    if as_json:
        print_figures(figures, kept=run.kept)
    else:
        typer.echo(ledger_text(judgements, run.paths, run.kept))
