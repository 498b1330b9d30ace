"""One gear's pitch curve at its real size, in the gear's own frame and the pose of phi1 = 0."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from math import cos

import numpy as np

from ncgear.numerics import chebyshev
from ncgear.numerics.arrays import Array, IndexArray, Mask
from ncgear.numerics.chebyshev import NotSmooth, PiecewiseChebyshev
from ncgear.pitch import shape
from ncgear.pitch.arc import ArcLength, too_sharp
from ncgear.pitch.shape import Gear, Mesh
from ncgear.ratio.transmission import Transmission


@dataclass(frozen=True, eq=False)
class CurvePoints:
    """Points of a pitch curve, each row one point.

    Positions in mm, unit tangents in the sense of growing arc length, unit normals away from the gear's material,
    curvatures in 1/mm (positive where convex).
    """

    position: Array
    tangent: Array
    normal: Array
    curvature: Array

    def kept(self, rows: IndexArray | Mask) -> CurvePoints:
        """The chosen points."""
        return CurvePoints(self.position[rows], self.tangent[rows], self.normal[rows], self.curvature[rows])


@dataclass(frozen=True, eq=False)
class PitchCurve:
    """A closed pitch curve; arc length in mm runs with phi1, clockwise on the driving gear and on a ring."""

    gear: Gear
    transmission: Transmission
    arc: ArcLength
    center_distance_mm: float
    mesh: Mesh

    @property
    def is_ring(self) -> bool:
        """Whether the gear's material lies outside the curve: the driven gear of an internal pair."""
        return shape.is_ring(self.gear, self.mesh)

    @property
    def periods(self) -> int:
        """Periods of the law in one turn of this gear."""
        lobes = self.transmission.lobes
        return lobes.driving if self.gear is Gear.DRIVING else lobes.driven

    @property
    def length_mm(self) -> float:
        """Length of the closed curve."""
        return self.periods * self.arc.period * self.center_distance_mm

    @property
    def turn_rad(self) -> float:
        """Driving angle that turns this gear once."""
        return self.periods * self.transmission.lobes.driving_period_rad

    @property
    def joints_mm(self) -> Array:
        """Arc lengths within one turn at which the curvature may jump; none for a law of one piece."""
        starts = np.array([piece.start_rad for piece in self.transmission.pieces])
        if starts.size == 1:
            return np.empty(0)
        cycles = np.arange(self.periods)[:, None] * self.arc.period
        return (cycles + self.arc.length(starts)).ravel() * self.center_distance_mm

    @property
    def joints_around_mm(self) -> Array:
        """The same from one turn before to one turn after the first, for curves that reach across the seam."""
        return np.concatenate([self.joints_mm - self.length_mm, self.joints_mm, self.joints_mm + self.length_mm])

    def driving_angle(self, sigma_mm: Array) -> Array:
        """phi1 in rad at which the point at arc length sigma is the pitch point, any shape."""
        return self.arc.angle(sigma_mm / self.center_distance_mm)

    def at_length(self, sigma_mm: Array) -> CurvePoints:
        """The curve at arc lengths in mm, of any shape, beyond one turn as well.

        Read from piecewise Chebyshev forms of the closed form, which agree with it to rounding error.
        """
        columns = self._by_length(np.mod(sigma_mm / self.center_distance_mm, self.length_mm / self.center_distance_mm))
        size, tangent = self.center_distance_mm, columns[..., 2:4]
        return CurvePoints(columns[..., 0:2] * size, tangent, _normal(self.gear, tangent), columns[..., 4] / size)

    @cached_property
    def curvature_bounds(self) -> tuple[float, float]:
        """Numbers in 1/mm below and above every curvature, proven by the coefficients of the Chebyshev forms."""
        coefficients = self._by_length.coefficients[..., 4] / self.center_distance_mm
        spread = np.abs(coefficients[1:]).sum(axis=0)
        return float(np.min(coefficients[0] - spread)), float(np.max(coefficients[0] + spread))

    @cached_property
    def _by_length(self) -> PiecewiseChebyshev:
        """Position, tangent and curvature at unit centre distance over one turn of this gear."""
        size = self.center_distance_mm

        def columns(sigma: Array) -> Array:
            at = self.at_angle(self.arc.angle(sigma))
            return np.column_stack([at.position / size, at.tangent, at.curvature * size])

        period = self.arc.length(self.transmission.joints_rad[:-1])
        joints = np.concatenate([period + number * self.arc.period for number in range(self.periods)])
        try:
            return chebyshev.fitted(columns, np.append(joints, self.periods * self.arc.period))
        except NotSmooth as fault:
            raise too_sharp(float(self.arc.angle(np.array(fault.at)))) from fault

    def at_angle(self, phi1: Array) -> CurvePoints:
        """The curve at driving angles in rad, of any shape."""
        driven = self.transmission.driven_angle(np.ravel(phi1), 3)
        slope = driven.differentiated()
        own = phi1.ravel() if self.gear is Gear.DRIVING else driven.value
        of = self.gear, self.mesh
        radius = shape.radius(slope, *of).value * self.center_distance_mm
        radius_slope = shape.radius_slope(slope, *of).value * self.center_distance_mm
        curvature = shape.curvature(slope, *of).value / self.center_distance_mm
        return _points(of, own, radius, radius_slope, curvature, phi1.shape)


def _points(
    of: tuple[Gear, Mesh], own: Array, radius: Array, radius_slope: Array, curvature: Array, form: tuple[int, ...]
) -> CurvePoints:
    """The pitch point on each gear's curve, in the frame of that gear, which has turned under it.

    The driving curve is met at polar angle -phi1, the driven one at pi + phi2; of an internal pair, at pi - phi1 and
    pi - phi2.  Arc length runs alike on both curves where they touch, with the driving gear's material to the right of
    the tangent and the driven gear's to the left.
    """
    gear, mesh = of
    facing = cos(shape.meeting_direction_rad(gear, mesh))
    turning = mesh.sense if gear is Gear.DRIVEN else 1.0
    radial = facing * np.stack([np.cos(own), -turning * np.sin(own)], axis=-1)
    around = facing * np.stack([-np.sin(own), -turning * np.cos(own)], axis=-1)
    tangent = radius_slope[:, None] * radial + radius[:, None] * around
    tangent /= np.hypot(tangent[:, 0], tangent[:, 1])[:, None]
    normal = _normal(gear, tangent)
    return CurvePoints(
        (radius[:, None] * radial).reshape(*form, 2),
        tangent.reshape(*form, 2),
        normal.reshape(*form, 2),
        curvature.reshape(form),
    )


def _normal(gear: Gear, tangent: Array) -> Array:
    """Unit normals away from the gear's material, which lies to the right of the driving gear's tangent."""
    side = 1.0 if gear is Gear.DRIVING else -1.0
    return side * np.stack([-tangent[..., 1], tangent[..., 0]], axis=-1)
