"""One gear's pitch curve at its real size, in the gear's own frame and the pose of phi1 = 0.

The curve is known by the driving angle, from the closed form, and by its arc length, which is the same for both gears.
Arc length and its inverse are kept at unit centre distance and continue periodically over any number of turns.

``nearest`` finds the point of a curve that is nearest to a given point, for pitch curves and for all others that roll
on them.
"""

from __future__ import annotations

from functools import cached_property
from math import cos
from typing import Protocol

import numpy as np

from ncgear.frozen import dataclass
from ncgear.numerics import chebyshev
from ncgear.numerics.arrays import Array, Columns, ComplexArray
from ncgear.numerics.chebyshev import Cells, NotSmooth, PiecewiseChebyshev, cells_of
from ncgear.numerics.plane import across, along, as_complex, as_points, turned
from ncgear.pitch import shape
from ncgear.pitch.arc_length import ArcLength, ArcMaps, too_sharp
from ncgear.pitch.shape import Gear, Mesh
from ncgear.ratio.transmission import Transmission


@dataclass(frozen=True, eq=False)
class CurvePoints(Columns):
    """Points of a curve, of any shape (...).

    ``position`` in mm, unit ``tangent`` in the sense of growing arc length and unit ``normal`` away from the gear's
    material have shape (..., 2); ``curvature`` in 1/mm (positive where convex) has shape (...).  ``outside`` is +1
    where the normal is on the left of the tangent, and -1 where it is on the right.
    """

    position: Array
    tangent: Array
    outside: float
    curvature: Array

    @property
    def normal(self) -> Array:
        """Unit normals."""
        return as_points(1j * self.outside * as_complex(self.tangent))

    def turned(self, angle_rad: Array) -> CurvePoints:
        """The curve turned counter-clockwise about (0, 0) by angles; shapes broadcast."""
        position, tangent = (turned(array, angle_rad) for array in (self.position, self.tangent))
        return CurvePoints(position, tangent, self.outside, np.broadcast_to(self.curvature, position.shape[:-1]))


FOOT_STEPS = 12
"""Steps of Newton's method to a foot on the pitch curve; two are enough where a tooth has a tip land."""


class ClosedPitchCurve:
    """A closed pitch curve by its arc length, whatever motion it comes from; teeth stand on it.

    ``arc`` maps the driving angle of one period to the arc length and back.  Arc length runs clockwise on the driving
    gear and on a ring, against the clock on other gears.
    """

    gear: Gear
    mesh: Mesh
    arc: ArcMaps

    @property
    def periods(self) -> int:
        """Periods of the driving angle in one turn of this gear."""
        raise NotImplementedError

    @property
    def unit_mm(self) -> float:
        """Length in mm of the unit of ``arc``."""
        raise NotImplementedError

    @property
    def joints_rad(self) -> Array:
        """Driving angles within one period, 0 first, at which smooth pieces begin."""
        raise NotImplementedError

    def at_angle(self, phi1: Array) -> CurvePoints:
        """The curve at driving angles in rad, of any shape."""
        raise NotImplementedError

    def mate_curvature(self, sigma_mm: float) -> float:
        """Curvature in 1/mm of the mate beside the curve, positive where the mate is convex."""
        raise NotImplementedError

    @property
    def is_ring(self) -> bool:
        """Whether the gear's material lies outside the curve: the driven gear of an internal pair."""
        return shape.is_ring(self.gear, self.mesh)

    @cached_property
    def length_mm(self) -> float:
        """Length of the closed curve."""
        return self.periods * self.arc.period * self.unit_mm

    @property
    def joints_mm(self) -> Array:
        """Arc lengths within one turn at which the curvature may jump; none for a law of one piece."""
        starts = self.joints_rad
        if starts.size == 1:
            return np.empty(0)
        cycles = np.arange(self.periods)[:, None] * self.arc.period
        return (cycles + self.arc.length(starts)).ravel() * self.unit_mm

    @property
    def joints_around_mm(self) -> Array:
        """``joints_mm`` of the first turn and of the turns beside it, for curves that reach across the seam."""
        return self._around(self.joints_mm)

    @property
    def panels_mm(self) -> Array:
        """Arc lengths over one turn between which one polynomial follows the curve, both ends included."""
        return self._by_length.breaks * self.unit_mm

    @property
    def panels_around_mm(self) -> Array:
        """Ends of panels in the first turn and in the turns beside it, for curves that reach across the seam."""
        return self._around(self.panels_mm[:-1])

    def _around(self, lengths_mm: Array) -> Array:
        return np.concatenate([lengths_mm - self.length_mm, lengths_mm, lengths_mm + self.length_mm])

    def driving_angle(self, sigma_mm: Array) -> Array:
        """phi1 in rad at which the point at arc length sigma is the pitch point, any shape."""
        return self.arc.angle(sigma_mm / self.unit_mm)

    def at_length(self, sigma_mm: Array) -> CurvePoints:
        """The curve at arc lengths in mm, of any shape, beyond one turn too; the closed form to rounding."""
        columns = self._cells(self._in_first_turn(sigma_mm))
        return CurvePoints(columns[..., 0:2], columns[..., 2:4], outside(self.gear), columns[..., 4])

    def curvature_at(self, sigma_mm: Array) -> Array:
        """Its curvature alone, in 1/mm."""
        return self._curvature_cells(self._in_first_turn(sigma_mm))[..., 0]

    def _in_first_turn(self, sigma_mm: Array) -> Array:
        """The same as ``np.mod``, which would take a quarter of the whole time."""
        return np.asarray(sigma_mm - self.length_mm * np.floor(sigma_mm / self.length_mm))

    def feet(self, points: ComplexArray, start_mm: Array, within_mm: float) -> tuple[Array, Array]:
        """Arc lengths that points stand over, to ``within_mm``, and their heights, (n,); NaN where none is found."""
        foot = start_mm
        for _ in range(FOOT_STEPS):
            at = self.at_length(foot)
            arm = points - as_complex(at.position)
            height = along(as_complex(at.normal), arm)
            step = along(as_complex(at.tangent), arm) / (1.0 + height * at.curvature)
            found = np.abs(step) <= within_mm
            if found.all():
                break
            foot = np.where(found, foot, foot + step)
        return np.where(found, foot, np.nan), np.where(found, height, np.nan)

    @cached_property
    def curvature_bounds(self) -> tuple[float, float]:
        """Lower and upper bound of the curvature in 1/mm; the coefficients of the Chebyshev forms prove them."""
        coefficients = self._by_length.coefficients[..., 4] / self.unit_mm
        spread = np.abs(coefficients[1:]).sum(axis=0)
        return float(np.min(coefficients[0] - spread)), float(np.max(coefficients[0] + spread))

    def bends_below(self, curvature: float) -> bool:
        """Whether the curvature is less than ``curvature`` in 1/mm anywhere; as a rule no extreme is needed to tell."""
        return chebyshev.falls_below(self._by_length.coefficients[..., 4], curvature * self.unit_mm)

    @cached_property
    def is_dented(self) -> bool:
        """Whether the curvature is negative anywhere."""
        return self.bends_below(0.0)

    def curvature_between(self, first_mm: Array, last_mm: Array) -> tuple[Array, Array]:
        """Proven bounds of the curvature in 1/mm from one arc length to another beyond; shape (n,) each."""
        low, high = self._cell_bounds
        start, turn = self._cells.ends[:, 0], np.floor(first_mm / self.length_mm) * self.length_mm
        turns = int(np.max(last_mm - turn, initial=0.0) // self.length_mm) + 1
        starts = (np.arange(turns)[:, None] * self.length_mm + start).ravel()
        cells = [np.searchsorted(starts[1:], at - turn, side="right") for at in (first_mm, last_mm)]
        ends = np.column_stack(cells).ravel() + np.tile([0, 1], first_mm.size)
        least, most = np.append(np.tile(low, turns), np.inf), np.append(np.tile(high, turns), -np.inf)
        return np.minimum.reduceat(least, ends)[::2], np.maximum.reduceat(most, ends)[::2]

    @cached_property
    def _cell_bounds(self) -> tuple[Array, Array]:
        """Lower and upper bounds of the curvature in 1/mm on each cell, shape (n,) each."""
        powers = self._cells.powers[..., 4]
        spread = np.abs(powers[:, 1:]).sum(axis=1)
        return powers[:, 0] - spread, powers[:, 0] + spread

    @cached_property
    def _cells(self) -> Cells:
        """The arrays of ``CurvePoints`` by the arc length in mm over one turn of this gear, as five columns."""
        form, size = self._by_length, self.unit_mm
        position, tangent, curvature = np.split(form.coefficients, [2, 4], axis=-1)
        columns = [position * size, tangent, curvature / size]
        return cells_of(PiecewiseChebyshev(form.breaks * size, np.concatenate(columns, axis=-1)))

    @cached_property
    def _curvature_cells(self) -> Cells:
        return self._cells.column(4)

    @cached_property
    def _by_length(self) -> PiecewiseChebyshev:
        """Position, tangent and curvature at unit centre distance over one turn of this gear."""
        size = self.unit_mm

        def columns(sigma: Array) -> Array:
            at = self.at_angle(self.arc.angle(sigma))
            return np.column_stack([at.position / size, at.tangent, at.curvature * size])

        # The curve needs at least the panels of the inverse of arc length.
        period = self.arc.by_length.breaks[:-1]
        panels = np.concatenate([period + number * self.arc.period for number in range(self.periods)])
        try:
            return chebyshev.fitted(columns, np.append(panels, self.periods * self.arc.period))
        except NotSmooth as fault:
            raise too_sharp(float(self.arc.angle(np.array(fault.at)))) from fault


@dataclass(frozen=True, eq=False)
class PitchCurve(ClosedPitchCurve):
    """The pitch curve of a law's gear, at a fixed distance from its mate."""

    gear: Gear
    transmission: Transmission
    arc: ArcLength
    center_distance_mm: float
    mesh: Mesh

    @property
    def periods(self) -> int:
        """Periods of the law in one turn of this gear."""
        lobes = self.transmission.lobes
        return lobes.driving if self.gear is Gear.DRIVING else lobes.driven

    @property
    def unit_mm(self) -> float:
        """The centre distance."""
        return self.center_distance_mm

    @property
    def joints_rad(self) -> Array:
        """Driving angles at which the pieces of the law begin."""
        return np.array([piece.start_rad for piece in self.transmission.pieces])

    @property
    def turn_rad(self) -> float:
        """Driving angle that turns this gear once."""
        return self.periods * self.transmission.lobes.driving_period_rad

    def drawn(self, count: int) -> CurvePoints:
        """``count`` points of the closed curve, or of the range of gears that turn less than once."""
        covered = self.transmission.lobes.range
        return self.at_angle(np.linspace(0.0, covered.driving_rad if covered else self.turn_rad, count))

    def mate_curvature(self, sigma_mm: float) -> float:
        """Curvature in 1/mm of the mate beside the curve, positive where the mate is convex, by Euler and Savary."""
        at = self.at_length(np.array([sigma_mm]))
        bend = float(at.curvature[0])
        if self.mesh is Mesh.INTERNAL:
            return bend
        radius = float(np.hypot(*at.position[0]))
        cosine = abs(float(across(as_complex(at.position), as_complex(at.tangent))[0])) / radius
        return cosine * self.center_distance_mm / (radius * (self.center_distance_mm - radius)) - bend

    def at_angle(self, phi1: Array) -> CurvePoints:
        """The curve at driving angles in rad, of any shape."""
        driven = self.arc.driven_angle(np.ravel(phi1))
        slope = driven.differentiated()
        own = phi1.ravel() if self.gear is Gear.DRIVING else driven.value
        of = self.gear, self.mesh
        polar = shape.polar(slope, *of)
        radius, radius_slope = (jet.value * self.center_distance_mm for jet in polar[:2])
        curvature = shape.curvature_of(polar, *of).value / self.center_distance_mm
        return _points(of, own, radius, radius_slope, curvature, phi1.shape)


def _points(
    of: tuple[Gear, Mesh], own: Array, radius: Array, radius_slope: Array, curvature: Array, form: tuple[int, ...]
) -> CurvePoints:
    """The pitch point on each gear's curve, in the frame of that gear, which has turned under it.

    On an external pair the pitch point is at the polar angle -phi1 of the driving gear and pi + phi2 of the driven one;
    on an internal pair it is at pi - phi1 and pi - phi2.  Arc length runs in the same direction on both curves where
    they touch; the driving gear's material is to the right of the tangent and the driven gear's to the left.
    """
    gear, mesh = of
    facing = cos(shape.meeting_direction_rad(gear, mesh))
    turning = mesh.sense if gear is Gear.DRIVEN else 1.0
    radial = facing * np.stack([np.cos(own), -turning * np.sin(own)], axis=-1)
    around = facing * np.stack([-np.sin(own), -turning * np.cos(own)], axis=-1)
    tangent = radius_slope[:, None] * radial + radius[:, None] * around
    tangent /= np.hypot(tangent[:, 0], tangent[:, 1])[:, None]
    position = radius[:, None] * radial
    return CurvePoints(position.reshape(*form, 2), tangent.reshape(*form, 2), outside(gear), curvature.reshape(form))


def outside(gear: Gear) -> float:
    """The side of ``CurvePoints``: the driving gear's material lies to the right of the tangent."""
    return 1.0 if gear is Gear.DRIVING else -1.0


STEPS = 40
"""Newton's method converges quadratically from within a radius of curvature; a damped start costs some steps."""

LEAST_SHARE = 0.2
"""Least divisor of a Newton step.  The divisor is the point's distance from the centre of curvature over the radius of
curvature; this bound keeps steps from leaping over the centre."""


class RollingCurve(Protocol):
    """A curve by its arc length in mm, in a frame of its own; normals point away from its material."""

    def at_length(self, sigma_mm: Array) -> CurvePoints:
        """Positions, tangents, normals and curvatures at arc lengths of any shape."""


def nearest(curve: RollingCurve, point_mm: Array, start_mm: Array, tolerance_mm: float) -> tuple[Array, Array]:
    """Arc lengths of points nearest to (n, 2) near starts (n,), signed distances along the normals; NaN for none."""
    sigma, point = start_mm, as_complex(point_mm)
    for _ in range(STEPS):
        at = curve.at_length(sigma)
        arm = point - as_complex(at.position)
        ahead, outwards = along(as_complex(at.tangent), arm), along(as_complex(at.normal), arm)
        found = np.abs(ahead) <= tolerance_mm
        if not np.any(np.abs(ahead) > tolerance_mm):
            break
        sigma = sigma + ahead / np.maximum(1.0 + outwards * at.curvature, LEAST_SHARE)
    return np.where(found, sigma, np.nan), np.where(found, outwards, np.nan)
