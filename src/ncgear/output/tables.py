"""The tables of a build as text. Numbers are written in full: read back, they are the same floats."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ncgear.kinematics.slider import SliderMotion
from ncgear.numerics.arrays import Array

LAW_COLUMNS = (
    "phi1_rad",
    "phi2_rad",
    "ratio",
    "displacement_mm",
    "velocity_mm_s",
    "acceleration_mm_s2",
    "force_n",
    "power_w",
)
OUTLINE_COLUMNS = ("x_mm", "y_mm")


def law_csv(motion: SliderMotion) -> str:
    """The motion law over one turn, one row per driving angle, columns named with their units.

    Raises ValueError when a column holds something other than finite numbers, or columns differ in length.
    """
    return _csv(LAW_COLUMNS, [getattr(motion, name) for name in LAW_COLUMNS])


def outline_csv(outline_mm: Array) -> str:
    """A tooth outline in mm, shape (n, 2), one point a row; raises ValueError as ``law_csv`` does."""
    return _csv(OUTLINE_COLUMNS, list(outline_mm.T))


def _csv(names: Sequence[str], columns: Sequence[Array]) -> str:
    rows = zip(*(_texts(name, column) for name, column in zip(names, columns, strict=True)), strict=True)
    return "\n".join([",".join(names), *map(",".join, rows)]) + "\n"


def _texts(name: str, column: Array) -> list[str]:
    """The shortest texts that read back as the same floats."""
    if not np.isfinite(column).all():
        raise ValueError(f"{name} holds a value that is not finite")
    return list(map(repr, np.asarray(column, dtype=float).tolist()))
