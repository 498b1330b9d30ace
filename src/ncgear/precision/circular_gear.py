"""A circular gear cut by a rack, in closed form, and how far points are from it.

Half a tooth, from its middle at polar angle 0 to the middle of the next space at pi / z: the tip's arc, the involute,
the trochoidal fillet of the rack's rounded tip, the root's arc.  The rest follows by mirrors and turns.  Nothing of
this is ncgear's own way to make teeth.  Source: F. L. Litvin and A. Fuentes, "Gear Geometry and Applied Theory", 2nd
edition, Cambridge 2004, chapters 6 and 10.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from math import acos, cos, hypot, pi, sin, sqrt, tan

import numpy as np

from ncgear.numerics.arrays import Array, ComplexArray
from ncgear.teeth.form import BasicRack

STARTS = 33
"""Places along a fillet from the nearest of which its foot is looked for."""

STEPS = 12
"""Of Newton's method to the foot; from so near a start it has all digits after five."""

ON_FOOT = 1e-9
"""Distance in modules along a fillet at which its foot counts as found; farther off it was held at the fillet's end."""


@dataclass(frozen=True)
class CircularGear:
    """``teeth`` without backlash or shift, cut by the rack, and not undercut; axis at (0, 0), a tooth at angle 0."""

    teeth: int
    rack: BasicRack

    @property
    def pitch_radius_mm(self) -> float:
        """R = m z / 2."""
        return self.teeth * self.rack.module_mm / 2.0

    @property
    def base_radius_mm(self) -> float:
        """R cos(alpha)."""
        return self.pitch_radius_mm * cos(self.rack.pressure_angle_rad)

    @property
    def tip_radius_mm(self) -> float:
        """Pitch radius and addendum."""
        return self.pitch_radius_mm + self.rack.addendum_mm

    @property
    def root_radius_mm(self) -> float:
        """Pitch radius less dedendum."""
        return self.pitch_radius_mm - self.rack.dedendum_mm

    @property
    def joint_radius_mm(self) -> float:
        """Where the involute passes into the fillet: the flank touches the rack at the end of its straight side."""
        depth = self.rack.flank_depth_mm
        return hypot(self.pitch_radius_mm - depth, depth / tan(self.rack.pressure_angle_rad))

    @property
    def base_angle_rad(self) -> float:
        """Polar angle at which the involute leaves the base circle: half the tooth's angle and inv(alpha)."""
        angle = self.rack.pressure_angle_rad
        return pi / (2.0 * self.teeth) + tan(angle) - angle

    @property
    def tip_angle_rad(self) -> float:
        """Half the angle of the tip's arc."""
        return self.base_angle_rad - sqrt((self.tip_radius_mm / self.base_radius_mm) ** 2 - 1.0) + self._tip_pressure

    @property
    def _tip_pressure(self) -> float:
        return acos(self.base_radius_mm / self.tip_radius_mm)

    @property
    def center_depth_mm(self) -> float:
        """Depth of the rounding's centre below the rack's pitch line."""
        return self.rack.dedendum_mm - self.rack.root_radius_mm

    @property
    def center_along_mm(self) -> float:
        """Where it stands along that line, from the middle of the gear's tooth."""
        rack, angle = self.rack, self.rack.pressure_angle_rad
        return rack.pitch_mm / 4.0 + rack.flank_depth_mm * tan(angle) + rack.root_radius_mm * cos(angle)

    @property
    def fillet_mm(self) -> tuple[float, float]:
        """Rolled lengths at which the fillet ends: on the root's arc, and where it passes into the flank."""
        rack, angle = self.rack, self.rack.pressure_angle_rad
        return self.center_along_mm, rack.pitch_mm / 4.0 + rack.flank_depth_mm / (sin(angle) * cos(angle))

    @cached_property
    def joints_mm(self) -> ComplexArray:
        """Where tip and flank, flank and fillet, fillet and root meet, of the half tooth."""
        pressure = acos(self.base_radius_mm / self.joint_radius_mm)
        radii = np.array([self.tip_radius_mm, self.joint_radius_mm, self.root_radius_mm])
        joint, root = self.base_angle_rad - tan(pressure) + pressure, self.fillet_mm[0] / self.pitch_radius_mm
        return radii * np.exp(1j * np.array([self.tip_angle_rad, joint, root]))

    def distance_mm(self, points_mm: Array) -> Array:
        """Least distances of points, shape (n, 2), from the gear's boundary, shape (n,)."""
        radius, pitch = np.hypot(points_mm[:, 0], points_mm[:, 1]), 2.0 * pi / self.teeth
        polar = np.arctan2(points_mm[:, 1], points_mm[:, 0])
        angle = np.abs(polar - pitch * np.round(polar / pitch))
        place = radius * np.exp(1j * angle)
        found = [
            *(np.abs(place - joint) for joint in self.joints_mm),
            np.where(angle <= self.tip_angle_rad, np.abs(radius - self.tip_radius_mm), np.inf),
            np.where(angle * self.pitch_radius_mm >= self.fillet_mm[0], np.abs(radius - self.root_radius_mm), np.inf),
            self._from_involute_mm(radius, angle),
            self._from_fillet_mm(place),
        ]
        least: Array = np.min(found, axis=0)
        return least

    def _from_involute_mm(self, radius: Array, angle: Array) -> Array:
        """Along the base circle's tangent through the point, which is the involute's normal; infinite beyond its ends.

        The tangent's length less the arc that has been unwound up to where it touches.
        """
        base = self.base_radius_mm
        outside = radius > base
        far = np.where(outside, radius, 2.0 * base)
        unwound = base * (self.base_angle_rad - angle + np.arccos(base / far))
        foot = np.hypot(base, unwound)
        met = outside & (unwound > 0.0) & (foot >= self.joint_radius_mm) & (foot <= self.tip_radius_mm)
        return np.where(met, np.abs(np.sqrt(far**2 - base**2) - unwound), np.inf)

    def _from_fillet_mm(self, place: ComplexArray) -> Array:
        """From the curve of the rounding's centre, less the rounding; infinite beyond its ends.

        By Newton's method on the foot.
        """
        low, high = self.fillet_mm
        starts = np.linspace(low, high, STARTS)
        apart = np.abs(place[:, None] - self._center(starts)[0])
        sigma = starts[np.argmin(apart, axis=1)]
        for _ in range(STEPS):
            center, slope, bend = self._center(sigma)
            gap = place - center
            missing, rate = np.real(gap * slope.conj()), np.real(gap * bend.conj()) - np.abs(slope) ** 2
            sigma = np.clip(sigma - missing / np.where(rate == 0.0, np.inf, rate), low, high)
        met = np.abs(missing) <= ON_FOOT * np.abs(slope) * self.rack.module_mm
        return np.where(met, np.abs(np.abs(place - self._center(sigma)[0]) - self.rack.root_radius_mm), np.inf)

    def _center(self, sigma: Array) -> tuple[ComplexArray, ComplexArray, ComplexArray]:
        """The rounding's centre as seen from the gear, and two derivatives by the rolled length."""
        radius, depth, along = self.pitch_radius_mm, self.center_depth_mm, self.center_along_mm - sigma
        turned = np.exp(1j * sigma / radius)
        return (
            turned * (radius - depth + 1j * along),
            turned * (-along - 1j * depth) / radius,
            turned * (radius + depth - 1j * along) / radius**2,
        )
