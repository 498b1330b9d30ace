"""The moving picture packed as the bytes of a file: an endless GIF by Pillow, or an MP4 by ffmpeg.

Two processes draw: of each block of frames, this one the first half, the second process the other one.  For a GIF the
second process first finds the colours.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from io import BytesIO
from itertools import chain
from math import ceil
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from PIL import Image

from ncgear.drawings.animation import AnimationFormat
from ncgear.drawings.beside import FIRST_FRAMES, FRAMES, HERE, Drawer
from ncgear.drawings.scene.scene import Scene
from ncgear.frozen import dataclass

TICK_MS = 10
"""The unit of time of GIF files: a hundredth of a second."""

QUALITY = "20"
"""Constant rate factor of x264: lines stay sharp, and the file is smaller than the GIF."""


@dataclass(frozen=True)
class Loop:
    """The form of a loop: its number of frames, at even driving angles, its seconds, and its width in pixels."""

    frames: int
    seconds: float
    width_px: int

    @property
    def durations_ms(self) -> list[int]:
        """The time in ms for which each frame is shown, in whole ticks; the sum is the loop's time to within a tick."""
        ends = np.rint(np.arange(self.frames + 1) * (1000.0 * self.seconds / self.frames / TICK_MS)).astype(int)
        return [int(ticks) * TICK_MS for ticks in np.diff(ends)]


def gif_bytes(images: Iterable[Image.Image], loop: Loop) -> bytes:
    """A GIF that shows images of one palette evenly and endlessly."""
    data = BytesIO()
    first, *others = images
    first.save(data, "GIF", save_all=True, append_images=others, duration=loop.durations_ms, loop=0)
    return data.getvalue()


def mp4_bytes(images: Iterable[Image.Image], loop: Loop) -> bytes:
    """An MP4 of one loop, in a form of H.264 that every player knows."""
    # An optional library; format_of has made sure that it is installed.
    import imageio_ffmpeg

    images = iter(images)
    first = next(images)
    rate = {"fps": loop.frames / loop.seconds, "macro_block_size": 2, "pix_fmt_out": "yuv420p"}
    # Without these flags the file would hold the time and the version of the program.
    bare = ["-crf", QUALITY, "-fflags", "+bitexact", "-flags:v", "+bitexact", "-movflags", "+faststart"]
    with TemporaryDirectory() as folder:
        path = Path(folder) / "loop.mp4"
        writer = imageio_ffmpeg.write_frames(str(path), first.size, output_params=bare, quality=None, **rate)
        writer.send(None)
        for image in chain([first], images):
            writer.send(image.tobytes())
        writer.close()
        return path.read_bytes()


BLOCK = 128
"""Most frames of a block: this process may hold the half that it draws in full colours."""

PACKERS = {AnimationFormat.GIF: gif_bytes, AnimationFormat.MP4: mp4_bytes}


def animated(
    scene: Scene, kind: AnimationFormat, loop: Loop, on_frame: Callable[[int, int], None], drawer: Drawer = HERE
) -> bytes:
    """The scene over its whole loop as the bytes of a file; ``on_frame`` gets the number of frames drawn and of all.

    ``drawer`` draws every other block of frames.
    """
    images = _drawn_by_two(scene, kind, loop, drawer)
    return PACKERS[kind](_counted(images, loop.frames, on_frame), loop)


def _drawn_by_two(scene: Scene, kind: AnimationFormat, loop: Loop, drawer: Drawer) -> Iterator[Image.Image]:
    # Without the end of the loop, which looks like its beginning.
    phi1 = scene.evenly_in_time(loop.frames)
    blocks, palette = np.array_split(phi1, ceil(phi1.size / BLOCK)), None
    if kind is AnimationFormat.GIF:
        own, others = np.array_split(blocks.pop(0), 2)
        colored = drawer.begun(FIRST_FRAMES, scene, loop.width_px, others)
    # Loads matplotlib, while the second process finds the colours.
    from ncgear.drawings.animation.images import drawn, in_colors
    from ncgear.drawings.animation.moving_picture import picture

    made = picture(scene, loop.width_px)
    if kind is AnimationFormat.GIF:
        images = list(drawn(made, scene, own))
        palette, further = colored()
        yield from (in_colors(image, palette) for image in images)
        yield from further
    for block in blocks:
        own, others = np.array_split(block, 2)
        beside = drawer.begun(FRAMES, scene, loop.width_px, others, palette)
        yield from (in_colors(image, palette) for image in drawn(made, scene, own))
        yield from beside()


def _counted(images: Iterator[Image.Image], total: int, on_frame: Callable[[int, int], None]) -> Iterator[Image.Image]:
    for number, image in enumerate(images, start=1):
        yield image
        on_frame(number, total)
