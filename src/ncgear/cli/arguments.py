"""Arguments and options that several commands share."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from ncgear.cli.completion import files_to_complete

DesignFile = Annotated[
    Path,
    typer.Argument(
        metavar="DESIGN.yaml",
        help="The design file; `ncgear new` writes one to begin with.",
        autocompletion=files_to_complete,
    ),
]
Timing = Annotated[bool, typer.Option("--timing", help="Also print, to stderr, how long each stage took.")]
