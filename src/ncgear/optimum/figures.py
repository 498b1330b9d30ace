"""The exact figures of a law, to be held against wishes: peaks located on the closed forms, not on a grid."""

from __future__ import annotations

from dataclasses import dataclass
from math import pi

from ncgear.kinematics.check import KinematicCheck, kinematic_check
from ncgear.kinematics.motion import Machine
from ncgear.optimum.task import Task
from ncgear.pitch.pair import PitchPair, sized_pair
from ncgear.pitch.shape import Gear
from ncgear.ratio.transmission import Train

TEETH = 100
"""Per lobe: figures of the curves are taken from a pair of any size, since they are ratios."""


@dataclass(frozen=True, eq=False)
class Figures:
    """Peaks at the operating speed, ratio range, and the shape of the pitch curves.

    ``curvature_turns`` is the largest curvature of any curve, bulge or dent, times the length its pair rolls in one
    cycle.  Of several pairs the ratios are those of the whole, and ``convex`` says it of all.
    """

    peak_power_w: float
    peak_acceleration_mm_s2: float
    peak_speed_mm_s: float
    ratio_min: float
    ratio_max: float
    working_rad: float
    tangent_rad: float
    convex: bool
    curvature_turns: float


def figures(task: Task, train: Train) -> Figures:
    """The figures of a law on a machine; raises NoSuchMechanism for curves too sharp to be computed."""
    machine = Machine(train.whole, task.linkage, task.resistance, task.speed_rad_s)
    check: KinematicCheck = kinematic_check(machine)
    pairs = [sized_pair(one.transmission, TEETH * task.lobes.driving, 1.0, None) for one in train.pairs]
    lowest, highest = train.whole.ratio_range
    return Figures(
        peak_power_w=check.peak_power_w.value,
        peak_acceleration_mm_s2=check.peak_acceleration_cycle_mm_s2.value,
        peak_speed_mm_s=check.peak_speed_mm_s.value,
        ratio_min=lowest.value,
        ratio_max=highest.value,
        working_rad=machine.extended_rad,
        tangent_rad=max(pair.largest_tangent_angle_rad.value for pair in pairs),
        convex=all(pair.convex(gear) for pair in pairs for gear in Gear),
        curvature_turns=max(map(_curvature_turns, pairs)),
    )


def _curvature_turns(pair: PitchPair) -> float:
    sharpest = max(abs(extremum.value) for gear in Gear for extremum in pair.curvature_range[gear])
    return sharpest * TEETH * pi
