"""The command that opens the studio."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from ncgear.cli.arguments import EXPORT, files_to_complete
from ncgear.errors import WrongInput
from ncgear.extras import require


def studio(
    design_file: Annotated[
        Path | None,
        typer.Argument(
            metavar="DESIGN.yaml",
            help="The design file; without one the page asks what to begin with, and writes it into this folder.",
            show_default="a choice",
            autocompletion=files_to_complete,
        ),
    ] = None,
    out: Annotated[
        Path, typer.Option(metavar="DIR", help="Folder for what the page makes, one folder for each design.")
    ] = EXPORT,
    port: Annotated[
        int, typer.Option(min=0, max=65535, help="Port on this computer.", show_default="any that is free")
    ] = 0,
    no_browser: Annotated[bool, typer.Option("--no-browser", help="Open no browser, only print the address.")] = False,
) -> None:
    """Design by looking: a page on which the machine runs and follows every value at once.

    The page is served to this computer only, at an address that nobody can guess; Ctrl-C ends it.
    """
    for library in ("starlette", "uvicorn", "websockets"):
        require(library, "studio", "ncgear studio")
    if design_file is not None and not design_file.exists():
        name = design_file.stem or "machine"
        raise WrongInput(f"is not there; `ncgear new {name}` writes a design to begin with", location=str(design_file))

    from ncgear.design.reading.text import read_text
    from ncgear.files.publish import real_place
    from ncgear.studio.on_disk import LARGEST_MB
    from ncgear.studio.server import listening, open_in_browser, serve

    if design_file is not None:
        # Files of a killed save are removed later, when the page can tell about it.
        read_text(real := real_place(design_file), limit_mb=LARGEST_MB)
        if str(real) != str(real).encode(errors="replace").decode():
            problem = "has a name that is no text in UTF-8, which no page can tell; rename it for the studio"
            raise WrongInput(problem, location=str(real))
    try:
        bound = listening(port)
    except OSError as error:
        raise WrongInput(
            f"{port} cannot be used ({error.strerror}); leave --port out, or give another number", key="--port"
        ) from error

    def begun(address: str) -> None:
        typer.echo(f"{design_file or 'The studio'} is open at {address}")
        typer.echo("Ctrl-C ends the studio; unsaved changes are there again when it is opened next.")
        if not no_browser:
            open_in_browser(address)

    serve(design_file, out, bound, begun)
