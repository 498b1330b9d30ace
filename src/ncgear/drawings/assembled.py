"""Contents of the pictures of a build, as values that know nothing of designs; ``pictures.py`` makes them."""

from __future__ import annotations

import numpy as np

from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array
from ncgear.numerics.plane import turned
from ncgear.pitch.shape import Gear

SLACK = 1.03
"""Size of the whole view divided by the reach of the gears."""


@dataclass(frozen=True)
class AssembledPosition:
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

    def placed(self, gear: Gear, points_mm: Array, position: AssembledPosition) -> Array:
        """Points of a gear's own frame (shape (n, 2)) in a position: turned by +phi1, the driven gear by -phi2, or a
        ring by +phi2.
        """
        if gear is Gear.DRIVING:
            return turned(points_mm, np.asarray(position.phi1_rad))
        sense = -1.0 if self.ring_radius_mm is None else 1.0
        center = np.array([self.center_distance_mm, 0.0])
        return np.asarray(turned(points_mm, np.asarray(sense * position.phi2_rad)) + center)

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
