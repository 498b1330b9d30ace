"""The figures a design is judged by: peaks of power, speed and acceleration, located exactly, and the mean power."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from functools import partial
from math import degrees, fsum

import numpy as np

from ncgear.kinematics.motion import Machine, Stretch, angles_at, stretches
from ncgear.mechanisms.mechanism import Output
from ncgear.numerics.arrays import Array
from ncgear.numerics.extrema import NO_KNOTS, Extremum, extremes
from ncgear.numerics.jet import Jet
from ncgear.numerics.units import RAD_S_PER_RPM
from ncgear.shown import Shown


@dataclass(frozen=True)
class KinematicCheck(Shown):
    """Peaks over one cycle of the output, each with the driving angle at which it occurs.

    Speeds and accelerations are in mm/s and mm/s^2, or in rad/s and rad/s^2 where the output turns.  Accelerations are
    magnitudes; ``working`` means from the retracted to the extended dead centre, or all of the cycle of an output that
    never returns.  Of gears that turn less than once, all are those of the way from end to end.
    """

    output: Output
    speed_rpm: float
    peak_power_w: Extremum
    mean_power_w: float
    peak_speed: Extremum
    peak_acceleration_working: Extremum
    peak_acceleration_cycle: Extremum

    def __repr__(self) -> str:
        rows = (
            f"power {_at(self.peak_power_w, 'W')}, on average {self.mean_power_w:.4g} W",
            f"speed {_at(self.peak_speed, self.output.speed.text)}",
            f"acceleration {_at(self.peak_acceleration_cycle, self.output.acceleration.text)}",
            f"acceleration of the working stroke {_at(self.peak_acceleration_working, self.output.acceleration.text)}",
        )
        return f"KinematicCheck(peaks at {self.speed_rpm:.4g} r/min:\n  " + "\n  ".join(rows) + ")"


def kinematic_check(machine: Machine) -> KinematicCheck:
    """Exact peaks of a machine: stationary points of the closed forms, and both sides of every joint."""
    omega = machine.speed_rad_s
    cycle = stretches(machine)
    working = [stretch for stretch in cycle if stretch.working]
    returning = [stretch for stretch in cycle if not stretch.working]
    halves = [half for half in (working, returning) if half]
    accelerations = [_peak(half, lambda jet: jet.differentiated().differentiated()) for half in halves]
    acceleration = max(accelerations, key=lambda extremum: extremum.value)
    speed = _peak(cycle, Jet.differentiated)
    work_j = _cycle_work_n_mm(machine) / 1000.0
    return KinematicCheck(
        output=machine.linkage.OUTPUT,
        speed_rpm=omega / RAD_S_PER_RPM,
        peak_power_w=_scaled(_peak_power(machine, cycle), omega / 1000.0),
        mean_power_w=work_j * omega / machine.transmission.cycle_rad,
        peak_speed=_scaled(speed, omega),
        peak_acceleration_working=_scaled(accelerations[0], omega**2),
        peak_acceleration_cycle=_scaled(acceleration, omega**2),
    )


def stroke_error_mm(machine: Machine) -> float:
    """What the slider's speed, integrated over its working stroke, misses of the mechanism's stroke.

    Of gears that turn less than once, what it misses of the slider's place at the end of the range.
    """
    way = machine.linkage.stroke_mm
    if not machine.transmission.lobes.repeats:
        way = _end_mm(machine)
    return fsum(stretch.way_mm for stretch in stretches(machine) if stretch.working) - way


def _end_mm(machine: Machine) -> float:
    """Where the slider is at the end of a range."""
    return float(machine.displacement(np.array([machine.transmission.cycle_rad]), 0).value[0])


def _cycle_work_n_mm(machine: Machine) -> float:
    """Work in N mm of one cycle, or of the way from one end of a range to the other."""
    load, stroke_mm = machine.load, machine.linkage.stroke_mm
    if machine.transmission.lobes.repeats:
        return load.cycle_work_n_mm(stroke_mm)
    return float(load.work_n_mm(np.array([_end_mm(machine)]), stroke_mm, returning=False)[0])


def _peak(parts: Iterable[Stretch], quantity: Callable[[Jet], Jet]) -> Extremum:
    """Largest magnitude over the stretches of a quantity made from the displacement's jet."""
    found = [extremum for stretch in parts for extremum in _extremes(stretch, quantity, 3)]
    return max((Extremum(abs(extremum.value), extremum.at) for extremum in found), key=lambda extremum: extremum.value)


def _extremes(
    stretch: Stretch, quantity: Callable[[Jet], Jet], order: int, passed_mm: Array = NO_KNOTS
) -> tuple[Extremum, Extremum]:
    """Extremes on a stretch; ``passed_mm`` are displacements at which the quantity may have a corner."""

    def of_angle(phi1: Array) -> Jet:
        return quantity(stretch.displacement(phi1, order))

    knots = np.union1d(stretch.knots_rad, angles_at(stretch, passed_mm))
    return extremes(of_angle, stretch.start_rad, stretch.end_rad, knots)


def _peak_power(machine: Machine, cycle: Sequence[Stretch]) -> Extremum:
    """Largest force against the motion times |dx/dphi1|, in N mm per rad; never below zero."""
    load, stroke_mm = machine.load, machine.linkage.stroke_mm
    found = [Extremum(0.0, cycle[0].start_rad)]
    for stretch in cycle:
        returning = not stretch.working
        knots = load.knots_mm(stroke_mm, returning)
        for curve in load.smooth_curves_n(returning):
            found.append(_extremes(stretch, partial(_power, curve, returning), 2, knots)[1])
    return max(found, key=lambda extremum: extremum.value)


def _power(force_n: Callable[[Jet], Jet], returning: bool, position: Jet) -> Jet:
    """A force against the motion times the speed, from the displacement's jet."""
    speed = position.differentiated()
    return force_n(position.truncated(1)) * (-speed if returning else speed)


def _at(peak: Extremum, unit: str) -> str:
    return f"{peak.value:.5g} {unit} at {degrees(peak.at):.4g} deg"


def _scaled(extremum: Extremum, factor: float) -> Extremum:
    return Extremum(extremum.value * factor, extremum.at)
