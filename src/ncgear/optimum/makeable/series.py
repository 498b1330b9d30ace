"""A trigonometric series and its derivatives at even places of a turn, as matrices on its coefficients."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ncgear.numerics.arrays import Array


@dataclass(frozen=True, eq=False)
class Basis:
    """Rows of values, first and second derivatives at n angles; columns cos 1.., sin 1.., shape (n, 2 harmonics)."""

    value: Array
    first: Array
    second: Array


def basis(angle_rad: Array, harmonics: int) -> Basis:
    """The matrices at angles in rad, shape (n,)."""
    waves = np.arange(1, harmonics + 1)
    cosine, sine = np.cos(np.outer(angle_rad, waves)), np.sin(np.outer(angle_rad, waves))
    value = np.hstack([cosine, sine])
    return Basis(value, np.hstack([-waves * sine, waves * cosine]), -value * np.tile(waves**2, 2))
