"""The moving picture packed as the bytes of a file: an endless GIF by Pillow in few colours, or an MP4 by ffmpeg."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from io import BytesIO
from itertools import chain
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from matplotlib.colors import to_rgb
from PIL import Image

from ncgear.drawings.animation import AnimationFormat
from ncgear.drawings.animation import artists as looks
from ncgear.drawings.animation.moving_picture import Frame, picture
from ncgear.drawings.scene.scene import Scene
from ncgear.frozen import dataclass

COLORS = 128
"""Colours of a GIF's palette besides the colours of lines: enough for shades at edges, with half the bytes of 256."""

PAPER = 244
"""Colours whose red, green and blue are at least this become white.

Pillow finds the colour of a palette to 4 of 255, and the median of many shades of white is also off by up to 4.
"""

SAMPLES = 4
"""Number of frames, spread over the loop, that give the colours of a GIF; so memory never holds all frames."""


EVERY = 2
"""Step of the rows and pixels that are used of these frames: a quarter of the time, with almost the same colours."""


Frames = Callable[[int], Iterator[Frame]]
"""A function that gives a number of frames, even in time over the loop, without its end, which repeats its start."""


def palette_found(frames: Frames) -> Image.Image:
    """An image of one pixel with the colours of frames and of lines as its palette.

    Nearly white colours become white, so that the paper stays white.
    """
    some = list(frames(SAMPLES))
    found = Image.fromarray(np.concatenate(some)[::EVERY, ::EVERY]).quantize(COLORS, method=Image.Quantize.MEDIANCUT)
    colors = np.array(found.getpalette()).reshape(-1, 3)
    colors[colors.min(axis=1) >= PAPER] = 255
    pure = [round(255 * part) for color in looks.PURE for part in to_rgb(color)]
    found.putpalette([*colors[:COLORS].ravel().tolist(), *pure])
    return found.crop((0, 0, 1, 1))


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
    # An optional library; format_of has checked that it is installed.
    import imageio_ffmpeg

    images = iter(images)
    first = next(images)
    rate = {"fps": loop.frames / loop.seconds, "macro_block_size": 2, "pix_fmt_out": "yuv420p"}
    # Without these flags the file would contain the time and the version of the program.
    bare = ["-crf", QUALITY, "-fflags", "+bitexact", "-flags:v", "+bitexact", "-movflags", "+faststart"]
    with TemporaryDirectory() as folder:
        path = Path(folder) / "loop.mp4"
        writer = imageio_ffmpeg.write_frames(str(path), first.size, output_params=bare, quality=None, **rate)
        writer.send(None)
        for image in chain([first], images):
            writer.send(image.tobytes())
        writer.close()
        return path.read_bytes()


PACKERS = {AnimationFormat.GIF: gif_bytes, AnimationFormat.MP4: mp4_bytes}


def animated(scene: Scene, kind: AnimationFormat, loop: Loop, on_frame: Callable[[int, int], None]) -> bytes:
    """The scene over its whole loop as the bytes of a file; ``on_frame`` gets the numbers drawn and in all."""
    made = picture(scene, loop.width_px)
    return packed(lambda count: made.frames(scene.poses(scene.evenly_in_time(count))), kind, loop, on_frame)


def packed(frames: Frames, kind: AnimationFormat, loop: Loop, on_frame: Callable[[int, int], None]) -> bytes:
    """Frames over their whole loop as the bytes of a file; ``on_frame`` as in ``animated``."""
    images: Iterator[Image.Image] = map(Image.fromarray, frames(loop.frames))
    if kind is AnimationFormat.GIF:
        palette = palette_found(frames)
        images = (image.quantize(palette=palette, dither=Image.Dither.NONE) for image in images)
    return PACKERS[kind](_counted(images, loop.frames, on_frame), loop)


def _counted(images: Iterator[Image.Image], total: int, on_frame: Callable[[int, int], None]) -> Iterator[Image.Image]:
    for number, image in enumerate(images, start=1):
        yield image
        on_frame(number, total)
