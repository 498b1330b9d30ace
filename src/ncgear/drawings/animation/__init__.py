"""The scene as a moving picture, and the kinds of files that can hold it; this module itself loads no library."""

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
    """The format that a file's suffix names.

    Raises WrongInput for another suffix, and where a library that the format needs is not installed.
    """
    suffix = path.suffix.lower()
    if suffix not in set(AnimationFormat):
        given = f"{suffix!r} is" if suffix else "no suffix is"
        raise WrongInput(f"{given} no moving picture; .gif or .mp4 is right", location=str(path))
    if suffix == AnimationFormat.MP4:
        require("imageio_ffmpeg", "video", "an MP4")
    return AnimationFormat(suffix)
