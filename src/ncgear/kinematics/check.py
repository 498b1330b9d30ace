"""Figures that judge a design: peaks of power, speed and acceleration, located exactly, and the mean power."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace
from math import degrees, fsum

import numpy as np

from ncgear.frozen import dataclass
from ncgear.kinematics.motion import Machine, Stretch, angles_at, stretches
from ncgear.mechanisms.mechanism import Output
from ncgear.numerics.arrays import Array, distinct
from ncgear.numerics.extrema import Extremum, extreme, extremes_on, grid_between
from ncgear.numerics.jet import Jet
from ncgear.numerics.quadrature import gauss_points, rms_above
from ncgear.numerics.units import RAD_S_PER_RPM
from ncgear.shown import Shown


@dataclass(frozen=True)
class WithMasses:
    """Figures of the driving shaft's power where masses are counted; each peak with its driving angle.

    ``peak_power_resistance_w`` is the peak of the resistance alone, without masses, weights and friction in the guide.
    ``braking_power_w`` is the largest power that flows back to the motor, as a size.  ``energy_swing_j`` is the energy
    that the driving shaft stores and gives back in a cycle where the motor's torque is even.
    """

    peak_power_resistance_w: Extremum
    braking_power_w: Extremum
    rms_torque_n_m: float
    energy_swing_j: float


@dataclass(frozen=True)
class KinematicCheck(Shown):
    """Peaks over one cycle of the output, each with the driving angle at which it occurs.

    Power is the driving shaft's with all that its design gives; ``with_masses`` is None where only the resistance
    counts.

    Speeds and accelerations are in mm/s and mm/s^2, or in rad/s and rad/s^2 where the output turns.  Accelerations are
    magnitudes; ``working`` means from the retracted to the extended dead centre, or all of the cycle of an output that
    never returns.  For gears that turn less than once, all values are those of the way from end to end.

    ``extremes_rad`` are all driving angles at which speed, acceleration or power is least or greatest on a stretch of
    the cycle: samples that include them miss no peak.
    """

    output: Output
    speed_rpm: float
    peak_power_w: Extremum
    mean_power_w: float
    peak_speed: Extremum
    peak_acceleration_working: Extremum
    peak_acceleration_cycle: Extremum
    extremes_rad: tuple[float, ...]
    with_masses: WithMasses | None = None

    @property
    def peak_power_resistance_w(self) -> Extremum:
        """The peak power of the resistance alone, whether or not masses are counted."""
        return self.with_masses.peak_power_resistance_w if self.with_masses else self.peak_power_w

    def __repr__(self) -> str:
        rows = (
            f"power {_at(self.peak_power_w, 'W')}, on average {self.mean_power_w:.4g} W",
            f"speed {_at(self.peak_speed, self.output.speed.text)}",
            f"acceleration {_at(self.peak_acceleration_cycle, self.output.acceleration.text)}",
            f"acceleration of the working stroke {_at(self.peak_acceleration_working, self.output.acceleration.text)}",
        )
        return f"KinematicCheck(peaks at {self.speed_rpm:.4g} r/min:\n  " + "\n  ".join(rows) + ")"


def kinematic_check(machine: Machine) -> KinematicCheck:
    """Exact peaks of a machine: stationary points of the closed forms, and both sides of every joint.

    Only the resistance counts in its power: masses are counted by ``ncgear.dynamics.driving_shaft``.
    """
    omega = machine.speed_rad_s
    cycle = stretches(machine)
    peaks = [_peaks(machine, stretch) for stretch in cycle]
    working = [peak for peak, stretch in zip(peaks, cycle, strict=True) if stretch.working]
    work_j = _cycle_work_n_mm(machine) / 1000.0
    return KinematicCheck(
        output=machine.linkage.OUTPUT,
        speed_rpm=omega / RAD_S_PER_RPM,
        peak_power_w=_scaled(_largest(peak.power for peak in peaks), omega / 1000.0),
        mean_power_w=work_j * omega / machine.transmission.cycle_rad,
        peak_speed=_scaled(_largest(peak.speed for peak in peaks), omega),
        peak_acceleration_working=_scaled(_largest(peak.acceleration for peak in working or peaks), omega**2),
        peak_acceleration_cycle=_scaled(_largest(peak.acceleration for peak in peaks), omega**2),
        extremes_rad=tuple(angle for peak in peaks for angle in peak.extremes_rad),
    )


NODES = 8
"""Gauss points between two points of a grid on which extremes are searched."""

JUMP = 1e-7
"""Largest difference of the accelerations on both sides of a joint that is no jump, as a share of the peak."""


def peak_jerk(machine: Machine) -> Extremum | None:
    """The output's greatest jerk over a cycle, in mm/s^3 or rad/s^3, as a magnitude.

    None where the acceleration jumps at a joint of the law: jerk has no bound there.
    """
    cycle, cubed = stretches(machine), machine.speed_rad_s**3
    ends = [of.displacement(np.array([of.start_rad, of.end_rad]), 2).derivative(2) for of in cycle]
    jumps = [abs(after[0] - before[1]) for before, after in zip(ends, [*ends[1:], ends[0]], strict=True)]
    if max(jumps) > JUMP * max(float(np.abs(end).max()) for end in ends):
        return None

    def jerk(stretch: Stretch) -> Extremum:
        def third(phi1: Array) -> list[Jet]:
            return [stretch.displacement(phi1, 4).differentiated().differentiated().differentiated()]

        return _size(extremes_on(third, _grid(machine, stretch))[0])

    return _scaled(_largest(map(jerk, cycle)), cubed)


def acceleration_rms_above(machine: Machine, order: int) -> float:
    """Root mean square over time of the output's harmonics of acceleration above an order, in mm/s^2 or rad/s^2."""
    cycle = stretches(machine)
    each = [gauss_points(_grid(machine, of), NODES) for of in cycle]
    values = [of.displacement(points, 2).derivative(2) for of, (points, _) in zip(cycle, each, strict=True)]
    points, weights = (np.concatenate(parts) for parts in zip(*each, strict=True))
    return rms_above(points, weights, np.concatenate(values), order) * machine.speed_rad_s**2


SIDE_RAD = 1e-9
"""Distance in rad between a jump and the samples before and after it.

It is far larger than the rounding of an angle, and too small to be seen or hit by a cursor.
"""


def both_sides_rad(angles_rad: Sequence[float], end_rad: float) -> Array:
    """Rising driving angles from 0 to an end: each with others right before and after it, as a curve may jump there."""
    at = np.array(angles_rad)
    return distinct(np.clip(np.concatenate([at - SIDE_RAD, at, at + SIDE_RAD]), 0.0, end_rad))


def load_extremes_rad(machine: Machine) -> list[float]:
    """Driving angles at which the load is least or greatest on a stretch of the cycle, or has a knot."""
    return [angle for stretch in stretches(machine) for angle in _load_extremes_rad(machine, stretch)]


def _load_extremes_rad(machine: Machine, stretch: Stretch) -> list[float]:
    passed: list[float] = _passed_rad(machine, stretch).tolist()
    curves = machine.load.smooth_curves_n(not stretch.working)
    if not curves:
        return passed

    def loads(phi1: Array) -> list[Jet]:
        position = stretch.displacement(phi1, 1)
        return [load_n(position) for load_n in curves]

    return [*passed, *_places(extremes_on(loads, _grid(machine, stretch)))]


@dataclass(frozen=True)
class _Peaks:
    """Largest magnitudes on a stretch, per rad of driving angle: in mm/rad, mm/rad^2 and N mm/rad; never below zero.

    ``extremes_rad`` are the driving angles of all least and greatest values, the magnitudes among them.
    """

    speed: Extremum
    acceleration: Extremum
    power: Extremum
    extremes_rad: tuple[float, ...]


def _peaks(machine: Machine, stretch: Stretch) -> _Peaks:
    """The peaks of one stretch, searched together since all follow from the displacement."""
    returning = not stretch.working
    curves = machine.load.smooth_curves_n(returning)

    def quantities(phi1: Array) -> list[Jet]:
        position = stretch.displacement(phi1, 3)
        speed = position.differentiated()
        # A force may have only one derivative at the end of the stroke.
        near, forward = position.truncated(1), (-speed if returning else speed).truncated(1)
        return [speed, speed.differentiated(), *(force_n(near) * forward for force_n in curves)]

    found = extremes_on(quantities, _grid(machine, stretch))
    speed, acceleration, *powers = found
    still = Extremum(0.0, stretch.start_rad)
    return _Peaks(_size(speed), _size(acceleration), _largest([still, *(most for _, most in powers)]), _places(found))


def _grid(machine: Machine, stretch: Stretch) -> Array:
    """The grid on which the extremes of a stretch are searched, with the knots of the stretch and of the load."""
    knots = distinct(np.concatenate([stretch.knots_rad, _passed_rad(machine, stretch)]))
    return grid_between(stretch.start_rad, stretch.end_rad, knots)


def _passed_rad(machine: Machine, stretch: Stretch) -> Array:
    """Driving angles in a stretch at which the output passes a knot of the load."""
    return angles_at(stretch, machine.load.knots_mm(machine.linkage.stroke_mm, not stretch.working))


def _places(ranges: Iterable[tuple[Extremum, Extremum]]) -> tuple[float, ...]:
    return tuple(end.at for ends in ranges for end in ends)


def _size(found: tuple[Extremum, Extremum]) -> Extremum:
    """The larger magnitude of both extremes."""
    return _largest(Extremum(abs(extremum.value), extremum.at) for extremum in found)


def _largest(found: Iterable[Extremum]) -> Extremum:
    return max(found, key=lambda extremum: extremum.value)


def stroke_error_mm(machine: Machine) -> float:
    """Difference between the integral of the slider's speed over the working stroke and the stroke of the mechanism.

    For gears that turn less than once: the difference from the slider's place at the end of the range.
    """
    way = machine.linkage.stroke_mm
    if not machine.transmission.lobes.repeats:
        way = _end_mm(machine)
    return fsum(stretch.way_mm for stretch in stretches(machine) if stretch.working) - way


def _end_mm(machine: Machine) -> float:
    """The slider's place at the end of a range."""
    return float(machine.displacement(np.array([machine.transmission.cycle_rad]), 0).value[0])


def _cycle_work_n_mm(machine: Machine) -> float:
    """Work in N mm of one cycle, or of the way from one end of a range to the other."""
    load, stroke_mm = machine.load, machine.linkage.stroke_mm
    if machine.transmission.lobes.repeats:
        return load.cycle_work_n_mm(stroke_mm)
    return float(load.work_n_mm(np.array([_end_mm(machine)]), stroke_mm, returning=False)[0])


OF_MASSES: dict[str, Callable[[WithMasses], float]] = {
    "peak_power_resistance_w": lambda found: found.peak_power_resistance_w.value,
    "peak_power_resistance_at_rad": lambda found: found.peak_power_resistance_w.at,
    "braking_power_w": lambda found: found.braking_power_w.value,
    "braking_power_at_rad": lambda found: found.braking_power_w.at,
    "rms_torque_n_m": lambda found: found.rms_torque_n_m,
    "energy_swing_j": lambda found: found.energy_swing_j,
}
"""Figures of power that need masses, by keys that end in their units."""


def power_figures(check: KinematicCheck) -> dict[str, float]:
    """The figures of power of the driving shaft, by keys that end in their units.

    Where masses are counted, the figures of the resistance alone are added.
    """
    found = check.with_masses
    counted = {} if found is None else {key: of(found) for key, of in OF_MASSES.items()}
    return {**extreme("peak_power", "w", check.peak_power_w), **counted, "mean_power_w": check.mean_power_w}


def peak_figures(check: KinematicCheck, *, returns: bool = True) -> dict[str, float]:
    """All figures of a check with the driving angles of peaks; ``returns`` tells peaks of the working stroke, too."""
    speed, acceleration = check.output.speed.ending, check.output.acceleration.ending
    return {
        **power_figures(check),
        **extreme("peak_speed", speed, check.peak_speed),
        **(extreme("peak_acceleration_working", acceleration, check.peak_acceleration_working) if returns else {}),
        **extreme("peak_acceleration_cycle", acceleration, check.peak_acceleration_cycle),
    }


def at_speed(check: KinematicCheck, speed_rpm: float) -> KinematicCheck:
    """The check of the same machine, without masses, at another driving speed: accelerations grow with its square."""
    factor = speed_rpm / check.speed_rpm
    return replace(
        check,
        speed_rpm=speed_rpm,
        peak_power_w=_scaled(check.peak_power_resistance_w, factor),
        mean_power_w=check.mean_power_w * factor,
        peak_speed=_scaled(check.peak_speed, factor),
        peak_acceleration_working=_scaled(check.peak_acceleration_working, factor**2),
        peak_acceleration_cycle=_scaled(check.peak_acceleration_cycle, factor**2),
        with_masses=None,
    )


def _at(peak: Extremum, unit: str) -> str:
    return f"{peak.value:.5g} {unit} at {degrees(peak.at):.4g} deg"


def _scaled(extremum: Extremum, factor: float) -> Extremum:
    return Extremum(extremum.value * factor, extremum.at)
