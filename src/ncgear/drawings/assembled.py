"""What the pictures of a build show, as values that know nothing of designs: ``pictures.py`` makes them."""

from __future__ import annotations

import numpy as np

from ncgear.drawings.charts.chart import Chart
from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array, Mask

SLACK = 1.03
"""Size of the whole view divided by the reach of the gears."""


@dataclass(frozen=True)
class Position:
    """Angles in rad of both gears, and the distance in mm of the pitch point from the driving axis."""

    phi1_rad: float
    phi2_rad: float
    pitch_point_mm: float


@dataclass(frozen=True, eq=False)
class Assembled:
    """Two closed curves in mm, each in its own frame (shape (n, 2)), and the distance of their axes.

    The body of a driven ring is between its curve and a circle of ``ring_radius_mm``, which is None for an external
    pair.
    """

    driving_mm: Array
    driven_mm: Array
    center_distance_mm: float
    ring_radius_mm: float | None = None

    @property
    def frame(self) -> tuple[float, float, float]:
        """Least and largest x and the largest y that the gears reach in any position."""
        driving = float(np.hypot(*self.driving_mm.T).max()) * SLACK
        driven = (self.ring_radius_mm or float(np.hypot(*self.driven_mm.T).max())) * SLACK
        left, right = min(-driving, self.center_distance_mm - driven), max(driving, self.center_distance_mm + driven)
        return left, right, max(driving, driven)

    @property
    def reach(self) -> Array:
        """Points of both curves at phi1 = 0, and two corners of the square around a ring; shape (n, 2)."""
        points = [self.driving_mm, self.driven_mm + np.array([self.center_distance_mm, 0.0])]
        if self.ring_radius_mm is not None:
            distance, radius = self.center_distance_mm, self.ring_radius_mm
            points.append(np.array([[distance - radius, -radius], [distance + radius, radius]]))
        return np.vstack(points)


@dataclass(frozen=True, eq=False)
class MotionPicture:
    """What the picture of the machine's motion shows."""

    title: str
    charts: list[Chart]


@dataclass(frozen=True, eq=False)
class GearPictures:
    """What the pictures of the pitch curves and of the teeth of a pair show."""

    pair: str
    pitch_curves: tuple[Assembled, tuple[Mask, Mask]]
    teeth: Assembled
    module_mm: float
    positions: list[Position]


@dataclass(frozen=True, eq=False)
class LoadPictures:
    """What the pictures of contact and load show; charts of the load are pairs, over the driving angle and over
    displacement.
    """

    pair: str
    contact: list[Chart]
    load_title: str
    load: list[tuple[Chart, Chart]]


def heading(name: str, what: str, speed_rpm: float) -> str:
    """The heading of a picture of a machine at a speed."""
    return f"{name}: {what} at {speed_rpm:.4g} r/min"
