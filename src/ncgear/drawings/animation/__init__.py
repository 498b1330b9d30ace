"""The scene as a moving picture, and the kinds of files that can hold it; this module loads no library."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path

from ncgear.errors import WrongInput
from ncgear.extras import require


class AnimationFormat(StrEnum):
    """The kinds of files for an animation; each value is the suffix of its files."""

    GIF = ".gif"
    MP4 = ".mp4"


def format_of(path: Path) -> AnimationFormat:
    """The format of a file by its suffix.

    Raises WrongInput for an unknown suffix, and where a library that the format needs is not installed.
    """
    suffix = path.suffix.lower()
    if suffix not in set(AnimationFormat):
        given = f"{suffix!r} is" if suffix else "no suffix is"
        raise WrongInput(f"{given} no moving picture; .gif or .mp4 is right", location=str(path))
    if suffix == AnimationFormat.MP4:
        require("imageio_ffmpeg", "video", "an MP4")
    return AnimationFormat(suffix)


LEAST_GIF_MS = 20.0
"""Shortest time of a frame of a GIF: viewers take 0 and 10 ms for a mistake, and show such frames for 100 ms."""


def require_shown(kind: AnimationFormat, frames: int, seconds: float) -> None:
    """Raise WrongInput where a file cannot show so many frames in so short a time."""
    if kind is AnimationFormat.GIF and 1000.0 * seconds < frames * LEAST_GIF_MS:
        most = max(int(1000.0 * seconds / LEAST_GIF_MS), 2)
        raise WrongInput(
            f"{frames} in {seconds:g} s given; a GIF shows {1000.0 / LEAST_GIF_MS:g} in a second at most: --frames "
            f"{most} or fewer, --seconds {frames * LEAST_GIF_MS / 1000.0:g} or more, or a name that ends in .mp4",
            key="--frames",
        )
