"""What moves as a rigid body, and the places it takes."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

import numpy as np

from ncgear.numerics.arrays import Array


class Kind(Enum):
    """What a body is, for its colour and its name."""

    DRIVING = "driving"
    DRIVEN = "driven"
    CRANK = "crank"
    ROD = "rod"
    SLIDER = "slider"


@dataclass(frozen=True, eq=False)
class Body:
    """A flat body in its own frame: contours in mm, shape (n, 2) each, first point not repeated.

    The first contour is the outer one, counter-clockwise; the others are holes.  ``edges_mm`` are closed lines on its
    face: pockets, a hub.
    """

    name: str
    kind: Kind
    contours_mm: tuple[Array, ...]
    edges_mm: tuple[Array, ...] = ()

    @property
    def reach_mm(self) -> float:
        """Greatest distance of the body from its frame's origin."""
        return float(np.hypot(*self.contours_mm[0].T).max())


@dataclass(frozen=True, eq=False)
class Places:
    """Where a body's frame is: origin in mm, shape (n, 2), and angle in rad counter-clockwise, shape (n,)."""

    origin_mm: Array
    angle_rad: Array
