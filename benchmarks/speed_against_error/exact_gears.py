"""Gears in closed form: a circular gear and the flanks of an elliptical one, as references of teeth and solids.

Neither goes through ncgear's laws, arc lengths, Chebyshev forms or its way to make teeth.  Source of the circular gear:
F. L. Litvin and A. Fuentes, "Gear Geometry and Applied Theory", 2nd edition, Cambridge 2004, chapters 6 and 10.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache, cached_property
from math import acos, cos, hypot, pi, sin, sqrt, tan

import numpy as np
from mpmath import mp, mpf
from scipy.spatial import cKDTree
from scipy.special import ellipe, ellipeinc

from ncgear.numerics.arrays import Array, ComplexArray, IndexArray
from ncgear.teeth.form import BasicRack
from speed_against_error.baler import Real

FILLET_STARTS, FLANK_STARTS = 33, 65
"""Places along each fillet and each flank.  The search for a point's foot starts from the nearest of them."""

STEPS = 12
"""Steps of Newton's method, to a foot or to an eccentric anomaly; the starts are so near that five give all digits."""

ON_FOOT = 1e-9
"""A foot on a fillet counts as found within this distance in modules; farther off it was held at the fillet's end."""

WITHIN = 0.7
"""Points up to this height in modules count as on a flank of the elliptical gear: every flank reaches so far."""

AREA_DIGITS = 30
"""Twice the digits of the volumes that the area is compared with."""


# --- circular --------------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class CircularGear:
    """``teeth`` without backlash or shift, cut by the rack and not undercut; the axis is at (0, 0).

    Half a tooth runs from its middle at polar angle 0 to the middle of the next space at pi / z: the tip's arc, the
    involute, the trochoidal fillet of the rack's rounded tip, the root's arc.  Mirroring and turning gives the rest.
    """

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
        """The pitch radius and the addendum."""
        return self.pitch_radius_mm + self.rack.addendum_mm

    @property
    def root_radius_mm(self) -> float:
        """The pitch radius less the dedendum."""
        return self.pitch_radius_mm - self.rack.dedendum_mm

    @property
    def joint_radius_mm(self) -> float:
        """Where the involute passes into the fillet: the end of the rack's straight side touches the flank there."""
        depth = self.rack.flank_depth_mm
        return hypot(self.pitch_radius_mm - depth, depth / tan(self.rack.pressure_angle_rad))

    @property
    def base_angle_rad(self) -> float:
        """The polar angle at which the involute leaves the base circle: half the tooth's angle and inv(alpha)."""
        angle = self.rack.pressure_angle_rad
        return pi / (2.0 * self.teeth) + tan(angle) - angle

    @property
    def tip_angle_rad(self) -> float:
        """Half the angle of the tip's arc."""
        pressure = acos(self.base_radius_mm / self.tip_radius_mm)
        return self.base_angle_rad - sqrt((self.tip_radius_mm / self.base_radius_mm) ** 2 - 1.0) + pressure

    @property
    def center_depth_mm(self) -> float:
        """The depth of the rounding's centre below the rack's pitch line."""
        return self.rack.dedendum_mm - self.rack.root_radius_mm

    @property
    def center_along_mm(self) -> float:
        """The place of the rounding's centre along that line, from the middle of the gear's tooth."""
        rack, angle = self.rack, self.rack.pressure_angle_rad
        return rack.pitch_mm / 4.0 + rack.flank_depth_mm * tan(angle) + rack.root_radius_mm * cos(angle)

    @property
    def fillet_mm(self) -> tuple[float, float]:
        """The rolled lengths at which the fillet ends: on the root's arc, and at the flank."""
        rack, angle = self.rack, self.rack.pressure_angle_rad
        return self.center_along_mm, rack.pitch_mm / 4.0 + rack.flank_depth_mm / (sin(angle) * cos(angle))

    @cached_property
    def joints_mm(self) -> ComplexArray:
        """Where tip and flank, flank and fillet, fillet and root of the half tooth meet."""
        pressure = acos(self.base_radius_mm / self.joint_radius_mm)
        radii = np.array([self.tip_radius_mm, self.joint_radius_mm, self.root_radius_mm])
        joint, root = self.base_angle_rad - tan(pressure) + pressure, self.fillet_mm[0] / self.pitch_radius_mm
        return radii * np.exp(1j * np.array([self.tip_angle_rad, joint, root]))

    def distance_mm(self, points_mm: Array) -> Array:
        """The least distances of points, shape (n, 2), from the gear's boundary, shape (n,)."""
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
        """The distance along the involute's normal, infinite beyond its ends.

        The normal is the base circle's tangent through the point.  The distance is the tangent's length less the arc
        that is unwound up to its point of contact.
        """
        base = self.base_radius_mm
        outside = radius > base
        far = np.where(outside, radius, 2.0 * base)
        unwound = base * (self.base_angle_rad - angle + np.arccos(base / far))
        foot = np.hypot(base, unwound)
        met = outside & (unwound > 0.0) & (foot >= self.joint_radius_mm) & (foot <= self.tip_radius_mm)
        return np.where(met, np.abs(np.sqrt(far**2 - base**2) - unwound), np.inf)

    def _from_fillet_mm(self, place: ComplexArray) -> Array:
        """The distance from the path of the rounding's centre less the rounding, infinite beyond its ends."""
        low, high = self.fillet_mm
        starts = np.linspace(low, high, FILLET_STARTS)
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
        """The rounding's centre in the gear's axes, and two derivatives by the rolled length."""
        radius, depth, along = self.pitch_radius_mm, self.center_depth_mm, self.center_along_mm - sigma
        turned = np.exp(1j * sigma / radius)
        return (
            turned * (radius - depth + 1j * along),
            turned * (-along - 1j * depth) / radius,
            turned * (radius + depth - 1j * along) / radius**2,
        )


@cache
def area_mm2(gear: CircularGear) -> float:
    """The area of a circular gear by Green's theorem: arcs and involutes in closed form, fillets by quadrature.

    An involute unwound from t to t' rad sweeps rb^2 (t'^3 - t^3) / 6 about the axis.
    """

    def fillet(sigma: Real) -> Real:
        """The point one radius of the rounding beyond its centre, on the line from the pitch point."""
        along, depth = mpf(gear.center_along_mm) - sigma, mpf(gear.center_depth_mm)
        reach = 1 + mpf(gear.rack.root_radius_mm) / mp.hypot(along, depth)
        turned = mp.expj(sigma / mpf(gear.pitch_radius_mm))
        return turned * mp.mpc(mpf(gear.pitch_radius_mm) - reach * depth, reach * along)

    def swept(sigma: Real) -> Real:
        """Half the cross product of the fillet's point and its derivative."""
        return mp.im(mp.conj(fillet(sigma)) * mp.diff(fillet, sigma)) / 2

    with mp.workdps(AREA_DIGITS):
        base, tip, root = mpf(gear.base_radius_mm), mpf(gear.tip_radius_mm), mpf(gear.root_radius_mm)
        unwound = [mp.sqrt((mpf(radius) / base) ** 2 - 1) for radius in (gear.tip_radius_mm, gear.joint_radius_mm)]
        involute = base**2 * (unwound[0] ** 3 - unwound[1] ** 3) / 6
        low, high = gear.fillet_mm
        arcs = (tip**2 * gear.tip_angle_rad + root**2 * (pi / gear.teeth - low / gear.pitch_radius_mm)) / 2
        return float(2 * gear.teeth * (arcs + involute + mp.quad(swept, [mpf(high), mpf(low)])))


# --- elliptical ------------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class EllipticalGear:
    """The driving gear of two equal ellipses about their foci: ``teeth`` without backlash or shift, 0 <= e < 1.

    Tooth 1 stands on the vertex near the axis at polar angle 0, arc length runs clockwise.  With the semi-axes A and
    B = A sqrt(1 - e^2), the pitch curve is A cos E - A e, B sin E from the focus.  Its arc length from the near vertex
    is A (E(E + pi/2 | e^2) - E(pi/2 | e^2)), an incomplete elliptic integral.  A flank that crosses the curve at c is
    P + h (s cot(alpha) T + N) at sigma = c - s h / (sin(alpha) cos(alpha)).
    """

    teeth: int
    eccentricity: float
    rack: BasicRack

    @property
    def large_mm(self) -> float:
        """A: the ellipse's length 4 A E(e^2) is that of all pitches."""
        return self.teeth * self.rack.pitch_mm / (4.0 * float(ellipe(self.eccentricity**2)))

    def distance_mm(self, points_mm: Array) -> Array:
        """The distances of points, shape (n, 2), from the nearest flank, shape (n,); 0 beside tips and roots."""
        mirrored = points_mm * [1.0, -1.0]
        tree, flanks, heights = self._starts
        nearest = tree.query(mirrored)[1]
        flank, start = flanks[nearest], heights[nearest]
        height = start
        for _ in range(STEPS):
            foot, along, speed = self._flank(flank, height)
            height = height + np.sum((mirrored - foot) * along, axis=1) / speed
        foot, along, _ = self._flank(flank, height)
        gap = mirrored - foot
        across = np.abs(gap[:, 0] * along[:, 1] - gap[:, 1] * along[:, 0])
        # The start of points on tips and fillets is too high or too low, even if their foot on the longer flank is not.
        beside = np.maximum(np.abs(start), np.abs(height)) <= WITHIN * self.rack.module_mm
        return np.where(beside, across, 0.0)

    @cached_property
    def _starts(self) -> tuple[cKDTree, IndexArray, Array]:
        """Places on all flanks as a tree, with the flank and the height of each."""
        heights = np.linspace(-1.0, 1.0, FLANK_STARTS) * self.rack.module_mm
        flank = np.repeat(np.arange(2 * self.teeth), FLANK_STARTS)
        height = np.tile(heights, 2 * self.teeth)
        return cKDTree(self._flank(flank, height)[0]), flank, height

    def _flank(self, flank: IndexArray, height: Array) -> tuple[Array, Array, Array]:
        """Points, unit tangents and speeds by the height.  Even flanks are the backs of teeth, odd ones the fronts."""
        angle, side = self.rack.pressure_angle_rad, np.where(flank % 2, 1.0, -1.0)
        crossing = (flank // 2 + side / 4.0) * self.rack.pitch_mm
        position, tangent, curvature = self._pitch_curve(crossing - side * height / (sin(angle) * cos(angle)))
        normal = np.column_stack([tangent[:, 1], -tangent[:, 0]])
        point = position + height[:, None] * ((side / tan(angle))[:, None] * tangent + normal)
        along = cos(angle) * normal - (side * sin(angle))[:, None] * tangent
        return point, along, (sin(angle) + height * curvature / sin(angle)) / (sin(angle) * cos(angle))

    def _pitch_curve(self, sigma: Array) -> tuple[Array, Array, Array]:
        """Positions, unit tangents and curvatures at arc lengths, counter-clockwise from the vertex near the axis."""
        large, small = self.large_mm, self.large_mm * sqrt(1.0 - self.eccentricity**2)
        anomaly = self.anomaly_rad(sigma)
        cosine, sine = np.cos(anomaly), np.sin(anomaly)
        slope = np.column_stack([-large * sine, small * cosine])
        speed = np.hypot(slope[:, 0], slope[:, 1])
        position = np.column_stack([large * (cosine - self.eccentricity), small * sine])
        return position, slope / speed[:, None], large * small / speed**3

    def anomaly_rad(self, sigma_mm: Array) -> Array:
        """The eccentric anomaly at arc lengths in mm, shape (n,), by Newton's method on the elliptic integral."""
        squared = self.eccentricity**2
        quarter = float(ellipe(squared))
        anomaly = sigma_mm / self.large_mm * 2.0 * pi / (4.0 * quarter)
        for _ in range(STEPS):
            missing = sigma_mm / self.large_mm - ellipeinc(anomaly + pi / 2.0, squared) + quarter
            anomaly = anomaly + missing / np.sqrt(1.0 - squared * np.cos(anomaly) ** 2)
        return np.asarray(anomaly)
