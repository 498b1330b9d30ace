"""The moving picture packed as the bytes of a file: an endless GIF by Pillow, or an MP4 by ffmpeg."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from io import BytesIO
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from matplotlib.colors import to_rgb
from PIL import Image

from ncgear.drawings.animation import Format
from ncgear.drawings.animation import artists as looks
from ncgear.drawings.animation.moving_picture import Frame, picture
from ncgear.drawings.scene.scene import Scene
from ncgear.numerics.arrays import Array

COLORS = 128
"""Colours of a GIF's palette beside those of lines: enough for the shades at edges, in half the bytes of 256."""

PAPER = 244
"""Least red, green and blue of a colour that is made white: Pillow finds a colour of a palette to 4 of 255, and a
median of many shades of white is up to 4 off as well."""

TICK_MS = 10
"""GIF counts time in hundredths of a second."""

QUALITY = "20"
"""Constant rate factor of x264: lines stay sharp, and a loop takes less than the GIF does."""


@dataclass(frozen=True)
class Timing:
    """How many frames a loop has, and how many seconds it takes."""

    frames: int
    seconds: float

    @property
    def durations_ms(self) -> list[int]:
        """How long each frame is shown, in whole ticks; together they are the loop's time to within a tick."""
        ends = np.rint(np.arange(self.frames + 1) * (1000.0 * self.seconds / self.frames / TICK_MS)).astype(int)
        return [int(ticks) * TICK_MS for ticks in np.diff(ends)]


def gif_bytes(frames: Iterable[Frame], some: Sequence[Frame], timing: Timing) -> bytes:
    """A GIF that shows the frames evenly, again and again, in the colours of some of them."""
    palette, data = _palette(some), BytesIO()
    first, *others = (Image.fromarray(frame).quantize(palette=palette, dither=Image.Dither.NONE) for frame in frames)
    first.save(data, "GIF", save_all=True, append_images=others, duration=timing.durations_ms, loop=0)
    return data.getvalue()


def _palette(frames: Sequence[Frame]) -> Image.Image:
    """The colours of frames and those of lines; what is nearly white is made white, so that the paper stays white."""
    made = Image.fromarray(np.concatenate(frames)).quantize(COLORS, method=Image.Quantize.MEDIANCUT)
    colors = np.array(made.getpalette()).reshape(-1, 3)
    colors[colors.min(axis=1) >= PAPER] = 255
    pure = [round(255 * part) for color in looks.PURE for part in to_rgb(color)]
    made.putpalette([*colors[:COLORS].ravel().tolist(), *pure])
    return made


def mp4_bytes(frames: Iterable[Frame], some: Sequence[Frame], timing: Timing) -> bytes:
    """An MP4 of one loop, H.264 as every player knows it, of the size of some of its frames."""
    # Not installed by everyone; format_of has asked for it.
    import imageio_ffmpeg

    height, width, _ = some[0].shape
    rate = {"fps": timing.frames / timing.seconds, "macro_block_size": 2, "pix_fmt_out": "yuv420p"}
    # Without these the file tells when and by which version it was made.
    bare = ["-crf", QUALITY, "-fflags", "+bitexact", "-flags:v", "+bitexact", "-movflags", "+faststart"]
    with TemporaryDirectory() as folder:
        path = Path(folder) / "loop.mp4"
        writer = imageio_ffmpeg.write_frames(str(path), (width, height), output_params=bare, quality=None, **rate)
        writer.send(None)
        for frame in frames:
            writer.send(np.ascontiguousarray(frame))
        writer.close()
        return path.read_bytes()


SAMPLES = 4
"""Frames, spread over the loop, drawn beforehand for its colours and its size: not all frames are kept in memory."""

PACKERS = {Format.GIF: gif_bytes, Format.MP4: mp4_bytes}


@dataclass(frozen=True)
class Loop:
    """How the loop is shown: frames at even driving angles, in so many seconds, so many pixels wide."""

    timing: Timing
    width_px: int


def animated(scene: Scene, kind: Format, loop: Loop, on_frame: Callable[[int, int], None]) -> bytes:
    """The scene over its whole loop as the bytes of a file; ``on_frame`` gets the number of frames drawn and of all."""
    made, total = picture(scene, loop.width_px), loop.timing.frames
    frames, some = (made.frames(scene.poses(loop_angles_rad(scene, count))) for count in (total, SAMPLES))
    return PACKERS[kind](_counted(frames, total, on_frame), list(some), loop.timing)


def loop_angles_rad(scene: Scene, frames: int) -> Array:
    """Even driving angles over the loop without its end, which looks as its beginning."""
    return np.linspace(0.0, scene.loop_rad, frames, endpoint=False)


def _counted(frames: Iterator[Frame], total: int, on_frame: Callable[[int, int], None]) -> Iterator[Frame]:
    for number, frame in enumerate(frames, start=1):
        yield frame
        on_frame(number, total)
