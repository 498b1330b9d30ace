"""The tools that leave the fillets: a rack, a pinion cutter, or the mating gear itself with a rounded tip.

A tool is known by the curve with which it rolls on the pitch curve, in the tool's own frame: a straight line, a circle,
or the mate's pitch curve.  Its teeth are conjugate to the gear's, so the working flanks are the same whatever the tool;
its rounded tip leaves the fillet.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import cos, pi, sin

import numpy as np

from ncgear.machine.rack import BasicRack
from ncgear.numerics.arrays import Array
from ncgear.pitch.curve import CurvePoints, PitchCurve


@dataclass(frozen=True)
class RackLine:
    """The pitch line of a rack: the tool of a hob, and of every cutter that moves straight."""

    def at_length(self, sigma_mm: Array) -> CurvePoints:
        """The x axis; the rack's material lies above it."""
        zero, one = np.zeros_like(sigma_mm), np.ones_like(sigma_mm)
        return CurvePoints(
            np.stack([sigma_mm, zero], axis=-1), np.stack([one, zero], axis=-1), np.stack([zero, -one], axis=-1), zero
        )

    def flank_depth_mm(self, rack: BasicRack, depth_mm: Array, radius_mm: Array) -> Array:
        """How deep the straight flank goes on a tool tooth of a depth and a tip radius."""
        return depth_mm - radius_mm * (1.0 - sin(rack.pressure_angle_rad))


@dataclass(frozen=True)
class PinionCircle:
    """The pitch circle of a pinion cutter (shaper) with whole ``teeth``."""

    teeth: int
    module_mm: float

    @property
    def radius_mm(self) -> float:
        """Pitch radius."""
        return self.teeth * self.module_mm / 2.0

    def at_length(self, sigma_mm: Array) -> CurvePoints:
        """The circle about (0, 0), touched from below at sigma = 0 and run counter-clockwise."""
        angle = sigma_mm / self.radius_mm - pi / 2.0
        outward = np.stack([np.cos(angle), np.sin(angle)], axis=-1)
        tangent = np.stack([-np.sin(angle), np.cos(angle)], axis=-1)
        return CurvePoints(
            self.radius_mm * outward, tangent, outward, np.full(np.shape(sigma_mm), 1.0 / self.radius_mm)
        )

    def flank_depth_mm(self, rack: BasicRack, depth_mm: Array, radius_mm: Array) -> Array:
        """How deep the involute goes on a tool tooth of a depth and a tip radius.

        The rounding's centre runs on an involute of the same base circle R cos(alpha); at the depth f of the contact
        its distance to the base circle's tangent point is R sin(alpha) + f / sin(alpha) - rho.
        """
        sine, base = sin(rack.pressure_angle_rad), self.radius_mm * cos(rack.pressure_angle_rad)
        tangent = np.sqrt((self.radius_mm + depth_mm - radius_mm) ** 2 - base**2)
        depth: Array = sine * (tangent - self.radius_mm * sine + radius_mm)
        return depth


Tool = RackLine | PinionCircle | PitchCurve
"""What may leave a gear's fillets; a pitch curve stands for the mating gear."""
