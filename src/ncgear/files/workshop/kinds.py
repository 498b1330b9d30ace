"""Kinds of files for the workshop."""

from __future__ import annotations

from enum import StrEnum


class Format(StrEnum):
    """Kinds of files that a build writes beside STL and CSV."""

    DXF = "dxf"
    SVG = "svg"
    THREEMF = "3mf"
    GLB = "glb"
    STEP = "step"


USUAL = (Format.DXF, Format.SVG, Format.THREEMF, Format.GLB)
"""Written unless others are asked for: all that need no extra library."""
