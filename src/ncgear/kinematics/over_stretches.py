"""What a motion does over stretches of the crank angle: how long it takes, how fast it is, how much it slows down."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from math import pi

import numpy as np

from ncgear.kinematics.crank_stretches import CrankStretch, Stroke, by_stroke
from ncgear.kinematics.even_speed import velocity
from ncgear.kinematics.motion import Machine, Stretch, stretches
from ncgear.numerics.arrays import Array
from ncgear.numerics.extrema import Extremum, extremes
from ncgear.numerics.jet import Jet


def time_ratio(machine: Machine) -> float:
    """Time of the working stroke over the time of the return."""
    working = machine.extended_rad
    return working / (machine.transmission.cycle_rad - working)


def crank_rad(machine: Machine, phi1_rad: float) -> float:
    """Crank angle at a driving angle of any cycle, counted from the retracted dead centre."""
    turns, local = divmod(phi1_rad, machine.transmission.cycle_rad)
    return 2.0 * pi * turns + float(machine.transmission.driven_angle(np.array([local]), 0).value[0])


def driving_rad(machine: Machine, crank_rad: float) -> float:
    """Driving angle at a crank angle of any turn, counted from the retracted dead centre."""
    turns, local = divmod(crank_rad, 2.0 * pi)
    whole = turns * machine.transmission.cycle_rad
    found = machine.driving_angles(np.array([local])) if local > 0.0 else np.zeros(1)
    return whole + (float(found[0]) if found.size else machine.transmission.cycle_rad)


def taken_rad(machine: Machine, stretch: CrankStretch) -> float:
    """Driving angle that a stretch of the crank angle takes."""
    return driving_rad(machine, stretch.end_rad) - driving_rad(machine, stretch.start_rad)


def speeds_mm_s(machine: Machine, stretch: CrankStretch) -> tuple[float, float]:
    """Least and greatest speed on a stretch of crank angles, at stationary points and both ends."""
    if not stretch.start_rad < stretch.end_rad:
        at = np.array([driving_rad(machine, stretch.start_rad)])
        speed = abs(float(machine.displacement(at, 1).derivative(1)[0])) * machine.speed_rad_s
        return speed, speed
    values = _extremes_of(machine, stretch, lambda part, phi1: velocity(part, phi1, 1))
    return min(values) * machine.speed_rad_s, max(values) * machine.speed_rad_s


def deceleration_mm_s2(machine: Machine, stretch: CrankStretch) -> float:
    """The greatest fall of the speed in a second on a stretch of crank angles, 0 where the speed never falls."""
    values = _extremes_of(machine, stretch, lambda part, phi1: -velocity(part, phi1, 2).differentiated())
    return max(0.0, max(values) * machine.speed_rad_s**2)


def _extremes_of(machine: Machine, stretch: CrankStretch, function: Callable[[Stretch, Array], Jet]) -> list[float]:
    """Least and greatest values of a function of smooth stretches of the motion, on a stretch of crank angles."""
    found: list[Extremum] = []
    for one, stroke in by_stroke(machine.linkage, stretch):
        start, end = driving_rad(machine, one.start_rad), driving_rad(machine, one.end_rad)
        for whole in stretches(machine):
            part = replace(whole, start_rad=max(start, whole.start_rad), end_rad=min(end, whole.end_rad))
            # Rounding must not bring in the other side of a dead centre
            if part.working is (stroke is Stroke.WORKING) and part.start_rad < part.end_rad:
                found += extremes(partial(function, part), part.start_rad, part.end_rad, np.array(part.knots_rad))
    return [extremum.value for extremum in found]
