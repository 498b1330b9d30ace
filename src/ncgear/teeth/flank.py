"""The curves that bound a tooth, each an exact envelope of one part of the rack that rolls on the pitch curve.

Everything is written in the gear's own moving frame: P the pitch point at arc length sigma, T the unit tangent, N the
unit normal away from the gear.  A flank is named by the arc length c at which it crosses the pitch curve and by its
side s, +1 for the flank that faces growing arc length.

Flank: the rack's straight side touches where its normal goes through the pitch point, at height h above the tangent:
X = P + h (s cot(alpha) T + N), sigma = c - s h / (sin(alpha) cos(alpha)).  Its speed along itself by sigma is
sin(alpha) + h k / sin(alpha), k being the pitch curve's curvature; where that vanishes the flank has a cusp, and the
part beyond is cut away (undercut).  Envelope of the rounding: its centre Y runs with the rack, and the point touching
the gear lies on the line from P through Y, one radius beyond Y. Source of the principle: F. L. Litvin and A. Fuentes,
"Gear Geometry and Applied Theory", 2nd edition, Cambridge 2004, chapters 6 (envelopes, singularities) and 12
(noncircular gears).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from math import cos, remainder, sin, tan

import numpy as np

from ncgear.machine.rack import BasicRack
from ncgear.numerics.arrays import Array, IndexArray
from ncgear.pitch.curve import PitchCurve

CROWN, FLANK, FILLET = 0, 1, 2
"""The curves along a tooth's side from the tip inwards; a crown is what the mating rack's rounding leaves."""


@dataclass(frozen=True, eq=False)
class Flanks:
    """All flanks of a gear in the order of arc length: back and front flank of tooth 1, of tooth 2, and so on.

    ``crossing_mm`` (shape (2 z,)) is where each crosses the pitch curve, ``side`` is -1 for back and +1 for front.
    """

    curve: PitchCurve
    rack: BasicRack
    crossing_mm: Array
    side: Array

    @property
    def count(self) -> int:
        """Number of flanks, twice the number of teeth."""
        return len(self.crossing_mm)

    @property
    def tooth(self) -> IndexArray:
        """Number of each flank's tooth, from 1."""
        return np.arange(self.count) // 2 + 1

    @cached_property
    def rounding_mm(self) -> Array:
        """Arc length at which the centre of the cutter's rounding stands right under the pitch point."""
        return self.crossing_mm + self.side * (self.rack.cutter_half_width_mm - self.rack.tip_half_width_mm)

    @cached_property
    def crown_rounding_mm(self) -> Array:
        """The same for the rounding of the mating rack, which stands over this gear's tooth."""
        return self.crossing_mm - self.side * (self.rack.cutter_half_width_mm - self.rack.tip_half_width_mm)

    def rolled_mm(self, flank: IndexArray, height_mm: Array) -> Array:
        """Arc length of the pitch point when the flank touches at the given heights; shapes broadcast."""
        angle = self.rack.pressure_angle_rad
        return self.crossing_mm[flank] - self.side[flank] * height_mm / (sin(angle) * cos(angle))

    def flank(self, flank: IndexArray, height_mm: Array) -> tuple[Array, Array]:
        """Points of flanks at heights over the rack's pitch line, and their derivatives by the height."""
        angle, side = self.rack.pressure_angle_rad, self.side[flank][..., None]
        at = self.curve.at_length(self.rolled_mm(flank, height_mm))
        point = at.position + height_mm[..., None] * (side / tan(angle) * at.tangent + at.normal)
        direction = at.normal / sin(angle) - side * at.tangent / cos(angle)
        regularity = sin(angle) + height_mm * at.curvature / sin(angle)
        return point, regularity[..., None] * direction

    def regularity(self, flank: IndexArray, height_mm: Array) -> Array:
        """sin^2(alpha) + h k: positive on a flank that exists, zero at a cusp."""
        curvature = self.curve.at_length(self.rolled_mm(flank, height_mm)).curvature
        return sin(self.rack.pressure_angle_rad) ** 2 + height_mm * curvature

    def envelope_regularity(self, kind: int, flank: IndexArray, sigma_mm: Array) -> Array:
        """The same for fillets and crowns, which exist as bounds of the tooth where it is positive.

        Along its tangent the envelope of a rounding runs with -+ k (D + rho) + rho d / D^2 per unit of sigma (minus for
        crowns), D being the distance from the pitch point to the rounding's centre and d the latter's depth.
        """
        crown = kind == CROWN
        center = (self.crown_rounding_mm if crown else self.rounding_mm)[flank]
        depth, radius = self.rack.rounding_depth_mm, self.rack.root_radius_mm
        curvature = self.curve.at_length(sigma_mm).curvature * (-1.0 if crown else 1.0)
        distance = np.hypot(center - sigma_mm, depth)
        return curvature * (distance + radius) + radius * depth / distance**2

    def fillet(self, flank: IndexArray, sigma_mm: Array) -> tuple[Array, Array]:
        """Points cut by the cutter's rounded tip when the pitch point is at sigma, and derivatives by sigma."""
        return self._envelope(self.rounding_mm[flank], -self.rack.rounding_depth_mm, sigma_mm)

    def crown(self, flank: IndexArray, sigma_mm: Array) -> tuple[Array, Array]:
        """Points that the mating rack's rounding leaves on the tooth, and derivatives by sigma."""
        return self._envelope(self.crown_rounding_mm[flank], self.rack.rounding_depth_mm, sigma_mm)

    def _envelope(self, center_mm: Array, height_mm: float, sigma_mm: Array) -> tuple[Array, Array]:
        at = self.curve.at_length(sigma_mm)
        ahead, curvature = (center_mm - sigma_mm)[..., None], at.curvature[..., None]
        arm = ahead * at.tangent + height_mm * at.normal
        length = np.linalg.norm(arm, axis=-1, keepdims=True)
        toward = arm / length
        center_slope = curvature * (height_mm * at.tangent - ahead * at.normal)
        arm_slope = center_slope - at.tangent
        turning = (arm_slope - toward * np.sum(toward * arm_slope, axis=-1, keepdims=True)) / length
        radius = self.rack.root_radius_mm
        return at.position + arm + radius * toward, center_slope + radius * turning

    def curve_of(self, kind: IndexArray, flank: IndexArray, parameter: Array) -> tuple[Array, Array]:
        """Points and derivatives of n mixed curves (kinds CROWN, FLANK, FILLET) at parameters of shape (n, ...)."""
        point, slope = np.empty((*parameter.shape, 2)), np.empty((*parameter.shape, 2))
        rows = flank.reshape(-1, *[1] * (parameter.ndim - 1))
        for number, curve in ((CROWN, self.crown), (FLANK, self.flank), (FILLET, self.fillet)):
            mask = kind == number
            if mask.any():
                point[mask], slope[mask] = curve(rows[mask], parameter[mask])
        return point, slope

    def offset(self, sigma_mm: Array, height_mm: float) -> tuple[Array, Array]:
        """The curve at constant distance from the pitch curve (tips, roots), and derivatives by sigma."""
        at = self.curve.at_length(sigma_mm)
        return at.position + height_mm * at.normal, (1.0 + height_mm * at.curvature)[..., None] * at.tangent


def flanks_of(
    curve: PitchCurve, rack: BasicRack, teeth: int, *, tooth_at_zero: bool, advance_mm: float = 0.0
) -> Flanks:
    """The flanks of a gear with ``teeth`` teeth; a tooth (or else a space) stands in the middle at sigma = 0.

    ``advance_mm`` moves all teeth along the pitch curve in the sense of growing arc length; whole turns of it are left
    out, so that every tooth keeps its number.
    """
    centers = (np.arange(teeth) + (0.0 if tooth_at_zero else 0.5)) * (curve.length_mm / teeth)
    centers = centers + remainder(advance_mm, curve.length_mm)
    side = np.tile([-1.0, 1.0], teeth)
    return Flanks(curve, rack, np.repeat(centers, 2) + side * rack.tooth_half_width_mm, side)
