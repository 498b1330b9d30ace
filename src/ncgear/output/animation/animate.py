"""A scene as the bytes of a moving picture."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from ncgear.numerics.arrays import Array
from ncgear.output.animation.formats import Format
from ncgear.output.animation.packing import Timing, gif_bytes, mp4_bytes
from ncgear.output.animation.picture import Frame, picture
from ncgear.scene.scene import Scene

SAMPLES = 4
"""Frames, spread over the loop, that tell its colours and its size beforehand; frames themselves are not kept."""

PACKERS = {Format.GIF: gif_bytes, Format.MP4: mp4_bytes}


@dataclass(frozen=True)
class Loop:
    """How the loop is shown: frames at even driving angles, in so many seconds, so many pixels wide."""

    timing: Timing
    width_px: int


def animated(scene: Scene, kind: Format, loop: Loop, on_frame: Callable[[int, int], None]) -> bytes:
    """The scene over its whole loop as the bytes of a file; ``on_frame`` is told how many of how many are drawn."""
    made, total = picture(scene, loop.width_px), loop.timing.frames
    frames, some = (made.frames(scene.poses(loop_angles_rad(scene, count))) for count in (total, SAMPLES))
    return PACKERS[kind](_counted(frames, total, on_frame), list(some), loop.timing)


def loop_angles_rad(scene: Scene, frames: int) -> Array:
    """Even driving angles over the loop; its end, which looks as its beginning, is left to the next round."""
    return np.linspace(0.0, scene.loop_rad, frames, endpoint=False)


def _counted(frames: Iterator[Frame], total: int, on_frame: Callable[[int, int], None]) -> Iterator[Frame]:
    for number, frame in enumerate(frames, start=1):
        yield frame
        on_frame(number, total)
