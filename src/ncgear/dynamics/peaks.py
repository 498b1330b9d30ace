"""Peaks of a motion in time: from the solver's steps and places between them, refined on its interpolation.

An impact lasts some milliseconds and may fall between rows at even times; the solver makes its steps shorter there.  A
resistance may have a narrow peak that no step meets: the places at which it turns are tested as well.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np

from ncgear.dynamics.crank_load import crank_angles_rad
from ncgear.dynamics.history import History, history, meetings_s
from ncgear.dynamics.loaded_machine import RigidMachine
from ncgear.dynamics.motion_in_time import Course, unheard
from ncgear.frozen import dataclass
from ncgear.kinematics.motion import Machine
from ncgear.numerics.arrays import Array
from ncgear.numerics.highest import largest_of_each


@dataclass(frozen=True)
class Peak:
    """A value with its time in s and its driving angle in rad."""

    value: float
    time_s: float
    phi1_rad: float


@dataclass(frozen=True)
class MotionPeaks:
    """Largest sizes over a motion; names and meaning are those of ``History``.

    ``forces_n`` are the forces in the joints and between the teeth, by their names.
    """

    displacement_error: Peak
    velocity_error: Peak
    acceleration: Peak
    law_acceleration: Peak
    pushing_n: Peak
    back_n: Peak
    most_torque_n_mm: Peak
    least_torque_n_mm: Peak
    forces_n: Mapping[str, Peak]

    @property
    def times_s(self) -> Array:
        """The times of all peaks, shape (n,)."""
        alone = [peak for peak in vars(self).values() if isinstance(peak, Peak)]
        return np.unique([peak.time_s for peak in (*alone, *self.forces_n.values())])


def motion_peaks(course: Course, rigid: RigidMachine, on_share: Callable[[float], None] = unheard) -> MotionPeaks:
    """The peaks of a course of this machine; ``on_share`` receives the finished share of it."""
    names = list(_sizes(history(course, rigid, course.time_s[:1])))
    places = np.union1d(course.fine_s, _turns_s(course, rigid.machine))

    def sizes(time_s: Array) -> Array:
        on_share(float(time_s[0] / places[-1]))
        return np.stack(list(_sizes(history(course, rigid, time_s)).values()))

    found = largest_of_each(sizes, places)
    phi1 = course.at(np.array([one.at for one in found]))[0]
    peaks = {name: Peak(one.value, one.at, float(angle)) for name, one, angle in zip(names, found, phi1, strict=True)}
    forces = {name.removesuffix(FORCE): peaks.pop(name) for name in names if name.endswith(FORCE)}
    braking = peaks.pop("least_torque_n_mm")
    least = Peak(0.0 - braking.value, braking.time_s, braking.phi1_rad)
    return MotionPeaks(**peaks, least_torque_n_mm=least, forces_n=forces)


FORCE = " force"


def _sizes(shown: History) -> dict[str, Array]:
    """The quantities whose peaks are searched, shape (n,) each; the least torque with the other sign."""
    return {
        "displacement_error": np.abs(shown.slide.displacement - shown.law.displacement),
        "velocity_error": np.abs(shown.slide.velocity - shown.law.velocity),
        "acceleration": np.abs(shown.slide.acceleration),
        "law_acceleration": np.abs(shown.law.acceleration),
        "pushing_n": shown.pushing_n,
        "back_n": shown.back_n,
        "most_torque_n_mm": shown.torque_n_mm,
        "least_torque_n_mm": -shown.torque_n_mm,
        **{name + FORCE: np.hypot(force.x, force.y) for name, force in shown.forces.items()},
    }


def _turns_s(course: Course, machine: Machine) -> Array:
    """Times at which the slider passes a place of either stroke where the resistance turns."""
    stroke = machine.linkage.stroke_mm
    crank_rad = [
        crank_angles_rad(machine.linkage, machine.load.turns_mm(stroke, returning), returning)
        for returning in (False, True)
    ]
    return np.concatenate([np.empty(0), *(_passings_s(course, angle) for angle in np.concatenate(crank_rad))])


def _passings_s(course: Course, crank_rad: float) -> Array:
    """Times at which the crank passes an angle, in any turn."""
    # Half the angle, so that the sine changes its sign at each passing and nowhere else
    return meetings_s(lambda time_s: np.sin((course.at(time_s)[2] - crank_rad) / 2.0), course.time_s)
