"""Arguments and options that several commands share, and where these write."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from ncgear.cli.completion import files_to_complete

EXPORT = Path("export")
"""Where commands write, into a folder for each design, unless they are told another place."""

DesignFile = Annotated[
    Path,
    typer.Argument(
        metavar="DESIGN.yaml",
        help="The design file; `ncgear new` writes one to begin with.",
        autocompletion=files_to_complete,
    ),
]
Timing = Annotated[bool, typer.Option("--timing", help="Also print, to stderr, how long each stage took.")]
