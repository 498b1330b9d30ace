"""``ncgear check``: kinematics and power."""

from __future__ import annotations

from typing import Annotated

import typer

from ncgear.cli.arguments import DesignFile, Timing
from ncgear.cli.opened import opened
from ncgear.cli.progress import stages_shown


def check(
    design_file: DesignFile,
    as_json: Annotated[bool, typer.Option("--json", help="Print the results as JSON.")] = False,
    timing: Timing = False,
) -> None:
    """Check a design: kinematics and power only, no teeth, no files."""
    with opened(design_file) as loaded:
        from ncgear.drive import Drive
        from ncgear.output.json_text import json_text
        from ncgear.output.report import check_text, timing_text
        from ncgear.output.summary.check import check_summary

        drive = Drive(loaded.design)
        with stages_shown(1) as on_stage:
            on_stage("kinematics and power")
            text = json_text(check_summary(drive)).rstrip() if as_json else check_text(drive)
        typer.echo(text)
        if timing:
            typer.echo(timing_text(drive), err=True)
