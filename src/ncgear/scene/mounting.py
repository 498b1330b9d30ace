"""How pairs of gears lie in the machine: from each pair's own frame into that of the linkage.

A pair's frame has its driving axis at (0, 0) and its driven one at (a, 0), and its driving gear turns
counter-clockwise.  The linkage's frame has the crank's axis at the origin, the slider moving along +x, and the crank
turning clockwise.  The driven gear of the last pair turns with the crank, so that pair is seen from the side from
which its driven gear turns clockwise: an external pair as it is, an internal one from behind.  Pairs before it are seen
from the side on which the shaft that two pairs share turns alike.  All axes lie on one line.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import cos, pi, sin

import numpy as np

from ncgear.numerics.arrays import Array
from ncgear.pitch.shape import Gear, Mesh

CRANK_SENSE = -1.0
"""The crank turns clockwise."""


@dataclass(frozen=True)
class Mounting:
    """Where one pair lies in the frame of the linkage.

    ``turn_rad`` is the direction of the driven axis from the driving one; ``hand`` is -1 where the pair is seen from
    behind, its own y axis pointing the other way.
    """

    mesh: Mesh
    driving_axis_mm: tuple[float, float]
    driven_axis_mm: tuple[float, float]
    turn_rad: float
    hand: float

    def axis_mm(self, gear: Gear) -> tuple[float, float]:
        """The axis of one of its gears."""
        return self.driving_axis_mm if gear is Gear.DRIVING else self.driven_axis_mm

    def sense(self, gear: Gear) -> float:
        """Sense in which one of its gears turns, counter-clockwise being +1."""
        return self.hand if gear is Gear.DRIVING else self.hand * self.mesh.sense

    def seen(self, points_mm: Array) -> Array:
        """Points of a gear's own frame as they are seen, before it is turned; shape (n, 2)."""
        seen: Array = points_mm * np.array([1.0, self.hand])
        return seen

    def on_centres_mm(self, distance_mm: Array) -> Array:
        """Points of the line of centres, so far from the driving axis towards the driven one; (n,) to (n, 2)."""
        along = np.array([cos(self.turn_rad), sin(self.turn_rad)])
        points: Array = np.array(self.driving_axis_mm) + distance_mm[:, None] * along
        return points


def mountings(meshes: Sequence[Mesh], center_distances_mm: Sequence[float], driving_axis_rad: float) -> list[Mounting]:
    """The mountings of pairs in series, the one that turns the crank last.

    ``driving_axis_rad`` is the direction from the crank's axis to the driving one's, counter-clockwise from +x.
    """
    made: list[Mounting] = []
    sense, axis = CRANK_SENSE, (0.0, 0.0)
    for mesh, distance in zip(reversed(meshes), reversed(center_distances_mm), strict=True):
        before = axis[0] + distance * cos(driving_axis_rad), axis[1] + distance * sin(driving_axis_rad)
        made.insert(0, Mounting(mesh, before, axis, driving_axis_rad - pi, sense * mesh.sense))
        sense, axis = sense * mesh.sense, before
    return made
