"""Stretches of the crank angle in which the output moves, and the motion there: time, speed, deceleration."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from enum import Enum
from functools import partial
from itertools import pairwise
from math import pi
from typing import NamedTuple

import numpy as np

from ncgear.kinematics.motion import Machine, Stretch, stretches
from ncgear.mechanisms.mechanism import Mechanism
from ncgear.numerics.arrays import Array
from ncgear.numerics.extrema import Extremum, extremes
from ncgear.numerics.jet import Jet


class Stroke(Enum):
    """The way from the retracted to the extended dead centre, or the way back."""

    WORKING = "working"
    RETURN = "return"


class End(Enum):
    """A dead centre."""

    RETRACTED = "retracted"
    EXTENDED = "extended"


class CrankStretch(NamedTuple):
    """Crank angles in rad from ``start_rad`` to ``end_rad``, rising; a start under 0 lies in the turn before."""

    start_rad: float
    end_rad: float

    @property
    def rest(self) -> CrankStretch:
        """The rest of the turn."""
        return CrankStretch(self.end_rad, self.start_rad + 2.0 * pi)


def crank_angle_rad(linkage: Mechanism, place_mm: float, stroke: Stroke) -> float:
    """Crank angle, 0 to 2 pi, at which the output passes a place of the stroke."""
    returning = np.array([stroke is Stroke.RETURN])
    return float(linkage.crank_angle(np.array([place_mm], dtype=float), returning)[0])


def crank_at_way_rad(linkage: Mechanism, way_mm: float) -> float:
    """Crank angle at which the output has gone a way of 0 to 2 strokes from the retracted end."""
    if way_mm <= linkage.stroke_mm:
        return crank_angle_rad(linkage, way_mm, Stroke.WORKING)
    return crank_angle_rad(linkage, 2.0 * linkage.stroke_mm - way_mm, Stroke.RETURN)


def place_of(linkage: Mechanism, at_mm: float, stroke: Stroke) -> CrankStretch:
    """The crank angle of a place, as a stretch without length."""
    angle = crank_angle_rad(linkage, at_mm, stroke)
    return CrankStretch(angle, angle)


def by_stroke(linkage: Mechanism, stretch: CrankStretch) -> list[tuple[CrankStretch, Stroke]]:
    """The parts of a stretch in each stroke, in order, with angles from 0 to 2 pi."""
    turn = 2.0 * pi
    dead = [angle + whole for whole in (-turn, 0.0, turn) for angle in (0.0, linkage.working_angle_rad)]
    edges = [stretch.start_rad, *(angle for angle in dead if stretch.start_rad < angle < stretch.end_rad)]
    found = []
    for start, end in pairwise([*edges, stretch.end_rad]):
        whole, middle = divmod((start + end) / 2.0, turn)
        working = middle < linkage.working_angle_rad
        found.append(
            (CrankStretch(start - turn * whole, end - turn * whole), Stroke.WORKING if working else Stroke.RETURN)
        )
    return found


def about_end(linkage: Mechanism, end: End, within_mm: float) -> CrankStretch:
    """The crank angles about a dead centre at which the displacement is within ``within_mm`` of it."""
    if end is End.EXTENDED:
        place = linkage.stroke_mm - within_mm
        return CrankStretch(*(crank_angle_rad(linkage, place, stroke) for stroke in Stroke))
    back, out = (crank_angle_rad(linkage, within_mm, stroke) for stroke in (Stroke.RETURN, Stroke.WORKING))
    return CrankStretch(back - 2.0 * pi, out)


def nearest_dwell_mm(linkage: Mechanism, end: End, for_rad: float, ratio_max: float) -> float:
    """The least distance from an end within which the output can stay for a driving angle, in mm.

    i12 is at most ``ratio_max``, so the crank turns by for_rad / ratio_max at least; with x'' = d2x/dphi2^2 at the dead
    centre, this takes the output nearly |x''| (for_rad / ratio_max)^2 / 8 away.  The result is exact: the distance that
    is reached on both sides of the dead centre.  It is the whole stroke where the crank must turn all round.
    """
    crank_rad = for_rad / ratio_max
    low, high = 0.0, 1.0
    # The square root of the distance grows evenly with the angle, and bisection halves its error in each step.
    for _ in range(60):
        middle = (low + high) / 2.0
        stretch = about_end(linkage, end, linkage.stroke_mm * middle**2)
        low, high = (middle, high) if stretch.end_rad - stretch.start_rad < crank_rad else (low, middle)
    return linkage.stroke_mm * high**2


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
    values = _extremes_of(machine, stretch, lambda part, phi1: part.speed(phi1, 1))
    return min(values) * machine.speed_rad_s, max(values) * machine.speed_rad_s


def deceleration_mm_s2(machine: Machine, stretch: CrankStretch) -> float:
    """The greatest fall of the speed in a second on a stretch of crank angles, 0 where the speed never falls."""
    values = _extremes_of(machine, stretch, lambda part, phi1: -part.speed(phi1, 2).differentiated())
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
