"""``ncgear report``: one page that shows the mechanism running."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from ncgear.cli.arguments import EXPORT, DesignFile, Timing
from ncgear.cli.opened import opened
from ncgear.cli.progress import stages_shown


def report(
    design_file: DesignFile,
    out: Annotated[
        Path | None, typer.Option(metavar="DIR", help="Output folder.", show_default="export/<design name>")
    ] = None,
    timing: Timing = False,
) -> None:
    """Write report.html: the machine running, its curves, comparison, warnings, data sheet and design file."""
    from ncgear.output.publish import prepare, publish

    with opened(design_file) as loaded:
        folder = out or EXPORT / loaded.design.name
        prepare(folder)

        from ncgear.drive import Drive
        from ncgear.output.build import WRITTEN_STAGES, contacts_as_written
        from ncgear.output.page import REPORT_FILE
        from ncgear.output.page.report_page import report_page
        from ncgear.output.report import timing_text

        drive = Drive(loaded.design)
        has_gears = loaded.design.gears is not None
        with stages_shown(1 + has_gears * drive.design.stages * len(WRITTEN_STAGES)) as on_stage:
            contacts = contacts_as_written(drive, on_stage) if has_gears else []
            on_stage("report")
            page = report_page(drive, loaded, contacts)
        (path,) = publish(folder, {REPORT_FILE: page})
        typer.echo(f"{path} ({len(page) / 1e6:.1f} MB): open it in a browser")
        if timing:
            typer.echo(timing_text(drive), err=True)
