"""The flanks as pins and plates touch them: without tip relief, in one section, thicker or thinner by an allowance.

All flanks of one side are parallel curves: the rolled length c at which a flank crosses the pitch curve moves it along
its normals by s cos(alpha) dc (teeth/flank.py).  So a tooth that is thicker by dE along the pitch curve has the same
normals, and the curve at a distance r outside a flank is a flank again, with c + s r / cos(alpha).

On helical teeth the surface's normal leans out of the section by the base helix angle beta_b, tan(beta_b) = tan(beta)
cos(alpha), by the same angle everywhere.  A ball of radius r therefore meets a section's flanks as a pin of r /
cos(beta_b) would, and plates are cos(beta_b) times as far apart as in the section.  On circular gears both are the
usual formulas, cos(beta_b) = cos(beta) cos(alpha_n) / cos(alpha).
"""

from __future__ import annotations

from dataclasses import replace
from math import atan, cos, tan

import numpy as np

from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array, IndexArray
from ncgear.numerics.plane import turned
from ncgear.teeth.flank import Flanks
from ncgear.teeth.gear import ToothedGear


@dataclass(frozen=True, eq=False)
class WorkingFlanks:
    """Flanks in one section, and the heights over the rack's pitch line between which each is exact, shape (2 z,).

    ``tips_mm`` (shape (z, 3, 2)) holds both ends and the middle of each tip land; ``base_cosine`` (shape (2 z,)) is the
    cosine of each flank's base helix angle, 1 for straight teeth.
    """

    flanks: Flanks
    low_mm: Array
    high_mm: Array
    tips_mm: Array
    base_cosine: Array

    @property
    def is_ring(self) -> bool:
        """Whether the teeth point towards the axis."""
        return self.flanks.curve.is_ring

    def thicker(self, allowance_mm: float) -> WorkingFlanks:
        """The same teeth with idle flanks that stand out by an allowance along the pitch curve; back if negative."""
        idle = np.where(self.flanks.idle, self.flanks.side, 0.0)
        crossing = self.flanks.crossing_mm + idle * allowance_mm
        return replace(self, flanks=replace(self.flanks, crossing_mm=crossing))

    def parallel(self, flank: IndexArray, height_mm: Array, distance_mm: Array) -> tuple[Array, Array]:
        """Points at distances outside the points where flanks touch at heights, and derivatives by the height."""
        slant, side = self.flanks.slant.of(flank), self.flanks.side[flank][..., None]
        sine, cosine = (np.broadcast_to(value, flank.shape)[..., None] for value in (slant.sine, slant.cosine))
        at = self.flanks.at_rolled(flank, self.flanks.rolled_mm(flank, height_mm)).turned(self.flanks.turn_rad[flank])
        farther = height_mm / slant.sine + distance_mm
        along = cosine * at.normal - side * sine * at.tangent
        speed = (slant.sine + farther * at.curvature) / slant.height_per_rolled
        point = at.position + farther[..., None] * (side * cosine * at.tangent + sine * at.normal)
        return point, speed[..., None] * along


def working_flanks(gear: ToothedGear, helix_rad: float = 0.0) -> WorkingFlanks:
    """The flanks of a section of a gear whose teeth have the helix angle ``helix_rad`` (0 <= beta < pi/2)."""
    high, low = gear.sides.flank_range()
    rack = gear.flanks.rack
    if rack.relief is not None:
        high = np.minimum(high, rack.relief.start_mm)
    leaning = [cos(atan(tan(helix_rad) * cos(angle))) for angle in rack.angles_rad]
    base = np.where(gear.flanks.idle, leaning[1], leaning[0])
    along, height = gear.sides.tip_mm.reshape(-1, 2), gear.flanks.tip_height_mm.reshape(-1, 2)
    ends = np.stack([along[:, 0], along.mean(axis=1), along[:, 1]], axis=1)
    heights = np.stack([height[:, 0], height.mean(axis=1), height[:, 1]], axis=1)
    turn = gear.flanks.turn_rad.reshape(-1, 2)
    over = np.stack([turn[:, 0], turn.mean(axis=1), turn[:, 1]], axis=1)
    tips = turned(gear.flanks.offset(ends, heights)[0], over)
    return WorkingFlanks(replace(gear.flanks, rack=replace(rack, relief=None)), low, high, tips, base)
