"""The way of the common centre of mass: the less it moves, the less is shaken."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ncgear.balance.mechanism import Mechanism
from ncgear.numerics.arrays import Array
from ncgear.numerics.plane import signed_area

TRACK_POINTS = 361
"""Points of a track, first one repeated; its area by the trapezoidal rule is far more exact than any picture."""


@dataclass(frozen=True, eq=False)
class Track:
    """The closed way of the common centre of mass: points in mm (shape (n, 2)), extents in mm and area in mm^2."""

    points_mm: Array

    @property
    def extent_mm(self) -> tuple[float, float]:
        """Along the slider's line and across it."""
        along, across = np.ptp(self.points_mm, axis=0)
        return float(along), float(across)

    @property
    def area_mm2(self) -> float:
        """What it encloses, by Green's theorem, where it does not cross itself."""
        return abs(float(signed_area(self.points_mm[:-1])))


def track(mechanism: Mechanism) -> Track:
    """The way of the common centre of mass over one cycle."""
    center = mechanism.center_of_mass_mm(np.linspace(0.0, mechanism.transmission.cycle_rad, TRACK_POINTS))
    return Track(np.column_stack([center.real, center.imag]))
