"""The flanks of an elliptical gear in closed form: how far points are from them.

The driving gear of two equal ellipses about their foci.  With the semi-axes A and B = A sqrt(1 - e^2), the pitch curve
is A cos E - A e, B sin E from the focus, and its arc length from the near vertex A (E(E + pi/2 | e^2) - E(pi/2 | e^2)),
an incomplete elliptic integral.  A flank that crosses it at c is P + h (s cot(alpha) T + N) at sigma = c - s h /
(sin(alpha) cos(alpha)).  Nothing of this goes through ncgear's laws, arc lengths or Chebyshev forms.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from math import cos, pi, sin, sqrt, tan

import numpy as np
from scipy.spatial import cKDTree
from scipy.special import ellipe, ellipeinc

from ncgear.numerics.arrays import Array, IndexArray
from ncgear.teeth.form import BasicRack

WITHIN = 0.7
"""Heights in modules up to which points count as on a flank: what every flank of the pair has, tips and fillets not."""

STARTS = 65
"""Places along each flank, from the nearest of which a point's foot is looked for."""

STEPS = 8
"""Of Newton's method, to the foot and to the eccentric anomaly: both have all digits after five."""


@dataclass(frozen=True)
class EllipticalGear:
    """``teeth`` without backlash or shift, on an ellipse of an eccentricity (0 <= e < 1) about its focus.

    Tooth 1 stands on the vertex near the axis at polar angle 0, arc length runs clockwise.
    """

    teeth: int
    eccentricity: float
    rack: BasicRack

    @property
    def large_mm(self) -> float:
        """A: the ellipse's length is 4 A E(e^2), that of all pitches."""
        return self.teeth * self.rack.pitch_mm / (4.0 * float(ellipe(self.eccentricity**2)))

    @property
    def small_mm(self) -> float:
        """B."""
        return self.large_mm * sqrt(1.0 - self.eccentricity**2)

    def distance_mm(self, points_mm: Array) -> Array:
        """Distances of points, shape (n, 2), from the nearest flank, shape (n,); 0 beside tips and roots."""
        mirrored = points_mm * [1.0, -1.0]
        flank, start = self._nearest(mirrored)
        height = start
        for _ in range(STEPS):
            foot, along, speed = self._flank(flank, height)
            height = height + np.sum((mirrored - foot) * along, axis=1) / speed
        foot, along, _ = self._flank(flank, height)
        gap = mirrored - foot
        across = np.abs(gap[:, 0] * along[:, 1] - gap[:, 1] * along[:, 0])
        # On tips and fillets the nearest place is beyond, though the foot on the flank drawn on may not be.
        beside = np.maximum(np.abs(start), np.abs(height)) <= WITHIN * self.rack.module_mm
        return np.where(beside, across, 0.0)

    def _nearest(self, points: Array) -> tuple[IndexArray, Array]:
        """Flank and height of the nearest place."""
        number, place = self._starts[1:]
        found = self._starts[0].query(points)[1]
        return number[found], place[found]

    @cached_property
    def _starts(self) -> tuple[cKDTree, IndexArray, Array]:
        heights = np.linspace(-1.0, 1.0, STARTS) * self.rack.module_mm
        flank = np.repeat(np.arange(2 * self.teeth), STARTS)
        height = np.tile(heights, 2 * self.teeth)
        return cKDTree(self._flank(flank, height)[0]), flank, height

    def _flank(self, flank: IndexArray, height: Array) -> tuple[Array, Array, Array]:
        """Points, unit tangents and speeds by the height; flanks are numbered back and front of each tooth in turn."""
        angle, side = self.rack.pressure_angle_rad, np.where(flank % 2, 1.0, -1.0)
        crossing = (flank // 2 + side / 4.0) * self.rack.pitch_mm
        position, tangent, curvature = self._pitch_curve(crossing - side * height / (sin(angle) * cos(angle)))
        normal = np.column_stack([tangent[:, 1], -tangent[:, 0]])
        point = position + height[:, None] * ((side / tan(angle))[:, None] * tangent + normal)
        along = cos(angle) * normal - (side * sin(angle))[:, None] * tangent
        return point, along, (sin(angle) + height * curvature / sin(angle)) / (sin(angle) * cos(angle))

    def _pitch_curve(self, sigma: Array) -> tuple[Array, Array, Array]:
        """Positions, unit tangents and curvatures at arc lengths, counter-clockwise from the vertex near the axis."""
        large, small = self.large_mm, self.small_mm
        anomaly = self.anomaly_rad(sigma)
        cosine, sine = np.cos(anomaly), np.sin(anomaly)
        slope = np.column_stack([-large * sine, small * cosine])
        speed = np.hypot(slope[:, 0], slope[:, 1])
        position = np.column_stack([large * (cosine - self.eccentricity), small * sine])
        return position, slope / speed[:, None], large * small / speed**3

    def anomaly_rad(self, sigma_mm: Array) -> Array:
        """Eccentric anomaly at arc lengths in mm, shape (n,); by Newton's method on the elliptic integral."""
        squared, turn = self.eccentricity**2, 4.0 * float(ellipe(self.eccentricity**2))
        quarter = float(ellipe(squared))
        anomaly = sigma_mm / self.large_mm * 2.0 * pi / turn
        for _ in range(STEPS):
            missing = sigma_mm / self.large_mm - ellipeinc(anomaly + pi / 2.0, squared) + quarter
            anomaly = anomaly + missing / np.sqrt(1.0 - squared * np.cos(anomaly) ** 2)
        return np.asarray(anomaly)
