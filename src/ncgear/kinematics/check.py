"""The figures a design is judged by: peaks of power, speed and acceleration, located exactly, and the mean power."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import pairwise
from math import pi

import numpy as np

from ncgear.kinematics.corners import corner_cuts_rad
from ncgear.kinematics.slider import Machine
from ncgear.machine.resistance import Resistance
from ncgear.numerics.arrays import Array
from ncgear.numerics.bracketed import zeros_between
from ncgear.numerics.extrema import Extremum, extremes
from ncgear.numerics.jet import Jet


@dataclass(frozen=True)
class KinematicCheck:
    """Peaks over one cycle of the slider, each with the driving angle at which it occurs.

    Accelerations are magnitudes; ``working`` means from the retracted to the extended dead centre.
    """

    speed_rpm: float
    peak_power_w: Extremum
    mean_power_w: float
    peak_speed_mm_s: Extremum
    peak_acceleration_working_mm_s2: Extremum
    peak_acceleration_cycle_mm_s2: Extremum


def kinematic_check(machine: Machine) -> KinematicCheck:
    """Exact peaks of a machine: stationary points of the closed forms, and both sides of every joint."""
    omega = machine.speed_rad_s
    working = list(_intervals(machine, working=True))
    returning = list(_intervals(machine, working=False))
    acceleration_working = _peak(machine, working, lambda jet: jet.differentiated().differentiated())
    acceleration_returning = _peak(machine, returning, lambda jet: jet.differentiated().differentiated())
    acceleration = max(acceleration_working, acceleration_returning, key=lambda extremum: extremum.value)
    speed = _peak(machine, working + returning, lambda jet: jet.differentiated())
    power = _peak_power(machine, working)
    return KinematicCheck(
        speed_rpm=omega * 30.0 / pi,
        peak_power_w=_scaled(power, omega / 1000.0),
        mean_power_w=work_per_stroke_j(machine.resistance, machine.linkage.stroke_mm)
        * omega
        / machine.transmission.cycle_rad,
        peak_speed_mm_s=_scaled(speed, omega),
        peak_acceleration_working_mm_s2=_scaled(acceleration_working, omega**2),
        peak_acceleration_cycle_mm_s2=_scaled(acceleration, omega**2),
    )


def work_per_stroke_j(resistance: Resistance, stroke_mm: float) -> float:
    """Work of the resistance over one working stroke in J, whatever the law."""
    return float(resistance.work_n_mm(np.array([stroke_mm]), stroke_mm)[0]) / 1000.0


def _intervals(machine: Machine, *, working: bool) -> Iterator[tuple[float, float]]:
    """Stretches of one cycle, cut at the law's joints, about sharp corners, and at the extended dead centre."""
    transmission, extended = machine.transmission, machine.extended_rad
    period = transmission.lobes.driving_period_rad
    starts = [k * period + piece.start_rad for k in range(transmission.lobes.driven) for piece in transmission.pieces]
    edges = np.unique([*starts, *corner_cuts_rad(machine), transmission.cycle_rad]).tolist()
    for start, end in pairwise(edges):
        low, high = (start, min(end, extended)) if working else (max(start, extended), end)
        if high - low > 1e-9 * period:
            yield low, high


def _on_piece(machine: Machine, low: float, high: float) -> tuple[Callable[[Array, int], Jet], Array]:
    """Displacement along one stretch with one-sided limits at its ends, and the knots of the law there."""
    transmission = machine.transmission
    period = transmission.lobes.driving_period_rad
    turns = int(((low + high) / 2.0) // period)
    middle = (low + high) / 2.0 - turns * period
    piece = next(piece for piece in transmission.pieces if piece.start_rad <= middle <= piece.end_rad)

    def displacement(phi1: Array, order: int) -> Jet:
        local = np.clip(phi1 - turns * period, piece.start_rad, piece.end_rad)
        driven = piece.driven_angle(local, order) + turns * transmission.lobes.driven_period_rad
        return machine.linkage.displacement(driven)

    return displacement, turns * period + np.array(piece.knots_rad)


def _peak(machine: Machine, intervals: list[tuple[float, float]], quantity: Callable[[Jet], Jet]) -> Extremum:
    """Largest magnitude over the intervals of a quantity made from the displacement's jet."""
    best = Extremum(0.0, intervals[0][0])
    for low, high in intervals:
        displacement, knots = _on_piece(machine, low, high)

        def along(phi1: Array, displacement: Callable[[Array, int], Jet] = displacement) -> Jet:
            return quantity(displacement(phi1, 3))

        for extremum in extremes(along, low, high, knots):
            if abs(extremum.value) > best.value:
                best = Extremum(abs(extremum.value), extremum.at)
    return best


def _peak_power(machine: Machine, intervals: list[tuple[float, float]]) -> Extremum:
    """Largest force times dx/dphi1, in N mm per rad; never below zero."""
    best = Extremum(0.0, intervals[0][0])
    for low, high in _cut_at_turns(machine, intervals):
        displacement, knots = _on_piece(machine, low, high)

        def power(phi1: Array, displacement: Callable[[Array, int], Jet] = displacement) -> Jet:
            position = displacement(phi1, 2)
            return machine.resistance.fitted_n(position.truncated(1)) * position.differentiated()

        highest = extremes(power, low, high, knots)[1]
        best = max(best, highest, key=lambda extremum: extremum.value)
    return best


def _cut_at_turns(machine: Machine, intervals: list[tuple[float, float]]) -> Iterator[tuple[float, float]]:
    """The intervals of the working stroke, cut where the slider passes a turn of the resistance."""
    turns = machine.resistance.turns_mm(machine.linkage.stroke_mm)
    for low, high in intervals:
        displacement, _ = _on_piece(machine, low, high)
        start, end = displacement(np.array([low, high]), 0).value
        passed = turns[(turns > start) & (turns < end)]
        yield from pairwise([low, *_angles_at(displacement, passed, low, high).tolist(), high])


def _angles_at(displacement: Callable[[Array, int], Jet], wanted_mm: Array, low: float, high: float) -> Array:
    """Driving angles between ``low`` and ``high`` at which the slider passes the displacements, both shape (n,)."""
    if not wanted_mm.size:
        return wanted_mm

    ends = np.full(wanted_mm.shape, low), np.full(wanted_mm.shape, high)
    return np.unique(zeros_between(lambda phi1: displacement(phi1, 0).value - wanted_mm, *ends))


def _scaled(extremum: Extremum, factor: float) -> Extremum:
    return Extremum(extremum.value * factor, extremum.at)
