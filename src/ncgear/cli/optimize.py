"""``ncgear optimize``: the best law under limits."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from ncgear.cli.arguments import EXPORT, DesignFile
from ncgear.cli.opened import opened
from ncgear.cli.progress import stages_shown


def optimize(
    design_file: DesignFile,
    out: Annotated[
        Path | None, typer.Option(metavar="DIR", help="Output folder.", show_default="export/<design name>-optimized")
    ] = None,
) -> None:
    """Find the best law for a design's machine, with a certificate of how close to the limit it is."""
    from ncgear.output.publish import prepare, publish

    with opened(design_file) as loaded:
        from ncgear.improvement import Improvement
        from ncgear.output.json_text import json_text
        from ncgear.output.optimum.frontier_files import LIMIT_PICTURE, limit_picture
        from ncgear.output.optimum.optimized import certificate, optimized_design, optimized_name
        from ncgear.output.optimum.optimized_text import optimized_text

        improvement = Improvement(loaded.design)
        name = optimized_name(improvement)
        folder = out or EXPORT / name
        prepare(folder)
        with stages_shown(4) as on_stage:
            on_stage("certified limit")
            improvement.bound  # noqa: B018
            on_stage("makeable law")
            written = optimized_design(loaded.text, improvement)
            on_stage("figures")
            certified = json_text(certificate(improvement)).encode()
            files = {f"{name}.yaml": written.encode(), "certificate.json": certified}
            if improvement.limit_points:
                on_stage("picture")
                files[LIMIT_PICTURE] = limit_picture(improvement)
        paths = publish(folder, files, obsolete=[LIMIT_PICTURE])
        typer.echo(optimized_text(improvement, paths))
