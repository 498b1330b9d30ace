"""Frames of the moving picture as images, in full colours or in those of a palette."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from matplotlib.colors import to_rgb
from PIL import Image

from ncgear.drawings.animation import artists as looks
from ncgear.drawings.animation.moving_picture import Picture
from ncgear.drawings.scene.scene import Scene
from ncgear.numerics.arrays import Array

COLORS = 128
"""Colours of a GIF's palette beside those of lines: enough for shades at edges, with half the bytes of 256 colours."""

PAPER = 244
"""Colours whose red, green and blue are at least this become white.

Pillow finds the colour of a palette to 4 of 255, and the median of many shades of white is also off by up to 4.
"""

SAMPLES = 4
"""Number of frames, spread over the loop, from which the colours of a GIF are taken; so memory never holds them all."""


EVERY = 2
"""Of these frames every second pixel of every second row is looked at: a quarter of the time, and colours as near."""


def palette_found(made: Picture, scene: Scene) -> Image.Image:
    """An image of one pixel with the colours of a picture's frames and of lines as its palette.

    Nearly white colours become white, so that the paper stays white.
    """
    some = list(made.frames(scene.poses(scene.evenly_in_time(SAMPLES))))
    found = Image.fromarray(np.concatenate(some)[::EVERY, ::EVERY]).quantize(COLORS, method=Image.Quantize.MEDIANCUT)
    colors = np.array(found.getpalette()).reshape(-1, 3)
    colors[colors.min(axis=1) >= PAPER] = 255
    pure = [round(255 * part) for color in looks.PURE for part in to_rgb(color)]
    found.putpalette([*colors[:COLORS].ravel().tolist(), *pure])
    return found.crop((0, 0, 1, 1))


def drawn(made: Picture, scene: Scene, phi1_rad: Array) -> Iterator[Image.Image]:
    """Images of a picture that is made, in full colours, one after the other."""
    return map(Image.fromarray, made.frames(scene.poses(phi1_rad)))


def in_colors(image: Image.Image, palette: Image.Image | None) -> Image.Image:
    """An image in the colours of a palette, or as it is where there is none."""
    return image if palette is None else image.quantize(palette=palette, dither=Image.Dither.NONE)
