"""``ncgear animate``: the mechanism as a moving picture."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from ncgear.cli.arguments import EXPORT, DesignFile
from ncgear.cli.opened import opened
from ncgear.cli.progress import counted


def animate(
    design_file: DesignFile,
    out: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE", help="File to write, .gif or .mp4.", show_default="export/<design name>/mechanism.gif"
        ),
    ] = None,
    frames: Annotated[int, typer.Option(min=2, max=600, help="Pictures in the loop.")] = 72,
    seconds: Annotated[float, typer.Option(min=0.1, max=600.0, help="Time that the loop takes.")] = 4.0,
    width: Annotated[int, typer.Option(min=320, max=1920, help="Width in pixels, rounded to an even number.")] = 960,
) -> None:
    """Show the mechanism moving: gears, crank, rod and slider over a whole cycle, as a GIF or MP4."""
    from ncgear.output.animation.formats import Format, format_of
    from ncgear.output.publish import prepare, publish

    kind = format_of(out) if out else Format.GIF
    with opened(design_file) as loaded:
        path = out or EXPORT / loaded.design.name / "mechanism.gif"
        prepare(path.parent)

        from ncgear.drive import Drive
        from ncgear.output.animation.animate import Loop, animated
        from ncgear.output.animation.packing import Timing
        from ncgear.scene.made import scene_of

        scene = scene_of(Drive(loaded.design))
        with counted("frames") as on_frame:
            content = animated(scene, kind, Loop(Timing(frames, seconds), width), on_frame)
        (written,) = publish(path.parent, {path.name: content})
        typer.echo(f"wrote {written}: {frames} frames in {seconds:g} s, {len(content) / 1e6:.3g} MB")
