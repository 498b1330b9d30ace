"""Forces of the teeth for any motion of both gears: which pairs touch, how deep, and what that does to either gear.

The depth of a pair is a function of both angles, d = u l(phi1) (law(phi1) + e(phi1) - phi2), with e and the lever l
from the tables and u = +1 on pushing flanks, -1 on their backs.  Its normal force acts on either gear along the
gradient of d, so that no energy comes from the tables: what the gears lose is what the contact stores and what its
damping and friction take.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ncgear.dynamics.gaps import Gaps, Near
from ncgear.dynamics.impact import Friction, Impact
from ncgear.numerics.arrays import Array
from ncgear.numerics.periodic_table import PeriodicTable


@dataclass(frozen=True, eq=False)
class TwoShafts:
    """Angles in rad and speeds in rad/s of the driving and of the driven shaft; floats or arrays of one shape s."""

    phi1_rad: Array | float
    speed1_rad_s: Array | float
    phi2_rad: Array | float
    speed2_rad_s: Array | float


@dataclass(frozen=True, eq=False)
class ToothForces:
    """What the pairs near contact bear, arrays of shape s + (slots,).

    ``depth_mm`` is negative by the gap where a pair does not touch; ``normal_n`` is 0 there.  The moments in N mm are
    those on the gears, each in the sense in which it turns; ``loss_n_mm_s`` is what damping and friction take.
    ``rubbing_n`` is the friction on the driven gear along the tangent that leads outwards from its axis.
    """

    near: Near
    depth_mm: Array
    normal_n: Array
    rubbing_n: Array
    driving_n_mm: Array
    driven_n_mm: Array
    loss_n_mm_s: Array


@dataclass(frozen=True, eq=False)
class Meshing:
    """A law, the pairs of teeth that keep it, and how they bear load."""

    law: PeriodicTable
    gaps: Gaps
    impact: Impact
    friction: Friction

    def forces(self, shafts: TwoShafts) -> ToothForces:
        """Forces of all pairs near contact."""
        near = self.gaps.at(shafts.phi1_rad)
        behind, rate = self._behind(near, shafts)
        lever, (_, lever_slope) = near.urge * near.lever_mm, near.slopes
        depth = lever * behind
        by_driving = near.urge * lever_slope * behind + lever * rate
        speed1, speed2 = _column(shafts.speed1_rad_s), _column(shafts.speed2_rad_s)
        closing = by_driving * speed1 - lever * speed2
        sliding = near.driving_mm * speed1 - near.driven_mm * speed2
        normal = self.impact.force_n(depth, closing)
        rubbing = self.friction.coefficient(sliding) * normal
        return ToothForces(
            near,
            depth,
            normal,
            rubbing,
            -normal * by_driving - rubbing * near.driving_mm,
            normal * lever + rubbing * near.driven_mm,
            self.impact.loss_n_mm_s(depth, closing) + np.abs(rubbing * sliding),
        )

    def _behind(self, near: Near, shafts: TwoShafts) -> tuple[Array, Array]:
        """Driven angles by which the driven gear is behind each pair's contact, and their slopes by phi1."""
        angle, ratio = self.law.at(shafts.phi1_rad)
        return _column(angle - shafts.phi2_rad) + near.error_rad, _column(ratio) + near.slopes[0]


def _column(values: Array | float) -> Array:
    return np.asarray(values)[..., None]
