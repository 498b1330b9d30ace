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

from ncgear.drawings.animation import AnimationFormat
from ncgear.drawings.animation import artists as looks
from ncgear.drawings.animation.moving_picture import Frame, picture
from ncgear.drawings.scene.scene import Scene

COLORS = 128
"""Colours of a GIF's palette beside those of lines: enough for shades at edges, with half the bytes of 256 colours."""

PAPER = 244
"""Colours whose red, green and blue are at least this become white.

Pillow finds the colour of a palette to 4 of 255, and the median of many shades of white is also off by up to 4.
"""

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


def gif_bytes(frames: Iterable[Frame], some: Sequence[Frame], loop: Loop) -> bytes:
    """A GIF that shows the frames evenly and endlessly; its colours come from ``some`` of them."""
    palette, data = _palette(some), BytesIO()
    first, *others = (Image.fromarray(frame).quantize(palette=palette, dither=Image.Dither.NONE) for frame in frames)
    first.save(data, "GIF", save_all=True, append_images=others, duration=loop.durations_ms, loop=0)
    return data.getvalue()


def _palette(frames: Sequence[Frame]) -> Image.Image:
    """The colours of frames and of lines; nearly white colours become white, so that the paper stays white."""
    made = Image.fromarray(np.concatenate(frames)).quantize(COLORS, method=Image.Quantize.MEDIANCUT)
    colors = np.array(made.getpalette()).reshape(-1, 3)
    colors[colors.min(axis=1) >= PAPER] = 255
    pure = [round(255 * part) for color in looks.PURE for part in to_rgb(color)]
    made.putpalette([*colors[:COLORS].ravel().tolist(), *pure])
    return made


def mp4_bytes(frames: Iterable[Frame], some: Sequence[Frame], loop: Loop) -> bytes:
    """An MP4 of one loop, in a form of H.264 that every player knows; its size is that of ``some`` of the frames."""
    # An optional library; format_of has made sure that it is installed.
    import imageio_ffmpeg

    height, width, _ = some[0].shape
    rate = {"fps": loop.frames / loop.seconds, "macro_block_size": 2, "pix_fmt_out": "yuv420p"}
    # Without these flags the file would hold the time and the version of the program.
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
"""Number of frames, spread over the loop, that are drawn first for colours and size; so memory never holds them all."""

PACKERS = {AnimationFormat.GIF: gif_bytes, AnimationFormat.MP4: mp4_bytes}


def animated(scene: Scene, kind: AnimationFormat, loop: Loop, on_frame: Callable[[int, int], None]) -> bytes:
    """The scene over its whole loop as the bytes of a file; ``on_frame`` gets the number of frames drawn and of all."""
    made = picture(scene, loop.width_px)
    # Without the end of the loop, which looks like its beginning.
    angles = (scene.evenly_in_time(count) for count in (loop.frames, SAMPLES))
    frames, some = (made.frames(scene.poses(phi1)) for phi1 in angles)
    return PACKERS[kind](_counted(frames, loop.frames, on_frame), list(some), loop)


def _counted(frames: Iterator[Frame], total: int, on_frame: Callable[[int, int], None]) -> Iterator[Frame]:
    for number, frame in enumerate(frames, start=1):
        yield frame
        on_frame(number, total)
