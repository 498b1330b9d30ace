"""The studies of the levels of simulation: what rigid, quasi-static and dynamic neglect, and what they cost."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np
from scipy.integrate import solve_ivp

from ncgear.design.reading.design_file import load
from ncgear.dynamics.motion_in_time import ACCURACY, course
from ncgear.dynamics.quasi_static import loaded_contact
from ncgear.numerics.arrays import Array
from ncgear.project.drive import Drive
from speed_against_error.study import Method, Study

DESIGNS = Path(__file__).parents[2] / "designs"

ACCURACIES = (1e-5, 3e-6, 1e-6, 3e-7, 1e-7)
"""At 1e-4 the balance of energy fails, which is an error."""

REFERENCE = "DOP853"
EXACT = 1e-9

ENOUGH_RAD = 3e-6
"""A micrometre at the baler's crank of 380 mm."""

TIMES = 2001


def baler_simulation_study() -> Study:
    """The published baler with chosen masses."""
    return _study("simulation-baler", "Levels of simulation: the baler with masses, 20 r/min", "baler-dynamics")


def half_power_simulation_study() -> Study:
    """The law of half the power."""
    return _study("simulation-half", "Levels of simulation: half the power, 60 r/min", "baler-half-dynamics")


def _study(key: str, title: str, name: str) -> Study:
    simulated = Simulated(name)
    return Study(
        key=key,
        title=title,
        unit="rad of the driven gear, rms over a turn",
        reference="the motion in time by an explicit method of order 8 (DOP853) at an accuracy of 1e-9, which agrees "
        "with ncgear's steps at 1e-9 to 1e-8 rad: what a level leaves out is its error",
        methods=(
            Method("rigid", "", (0,), lambda _: simulated.rigid()),
            Method("quasi-static", "", (0,), lambda _: simulated.quasi_static()),
            Method("dynamic", "accuracy", ACCURACIES, simulated.dynamic),
        ),
        error=simulated.error_rad,
        chosen=("dynamic", ACCURACY),
        enough=ENOUGH_RAD,
        because="where motion in time is asked for, it is to be right to a micrometre of the slider even where flanks "
        "part and meet; rigid and quasi-static are chosen by name where what they leave out does not count. Teeth, "
        "contact and tables, which all but rigid need, are not in these times",
    )


@dataclass(frozen=True, eq=False)
class Simulated:
    """A design with masses, by its name in designs/; each level gives driven angles in rad at the same times."""

    name: str

    @cached_property
    def drive(self) -> Drive:
        """The design's drive."""
        return Drive(load(DESIGNS / f"{self.name}.yaml").design)

    @cached_property
    def time_s(self) -> Array:
        """Times of one turn at constant driving speed, shape (n,)."""
        return np.linspace(0.0, 2.0 * np.pi / self.drive.machine.speed_rad_s * (1.0 - 1e-3), TIMES)

    @cached_property
    def phi1_rad(self) -> Array:
        """The driving angles at those times."""
        return self.time_s * self.drive.machine.speed_rad_s

    @cached_property
    def exact_rad(self) -> Array:
        """By an explicit method of order 8 with the machine's forces by arrays."""
        own = self.drive.course

        def change(_: float, state: Array) -> Array:
            found = own.machine.answer(state)
            return np.array([state[1], found.acceleration1_rad_s2, state[3], found.acceleration2_rad_s2])

        ends = self.time_s[[0, -1]]
        found = solve_ivp(change, ends, own.states[:4, 0], REFERENCE, self.time_s, rtol=EXACT, atol=1e-2 * EXACT)
        exact: Array = found.y[2]
        return exact

    def error_rad(self, found: Array) -> float:
        """The root mean square error over the turn."""
        return float(np.sqrt(np.mean((found - self.exact_rad) ** 2)))

    def rigid(self) -> Array:
        """The law; the forces that keep it are computed too."""
        self.drive.rigid.machine.at(self.phi1_rad)
        return self.drive.transmission.driven_angle(self.phi1_rad).value

    def quasi_static(self) -> Array:
        """The teeth bear the torque of the rigid level."""
        drive, phi1 = self.drive, self.phi1_rad
        torque = drive.rigid.machine.at(phi1).driven_torque.value
        loaded = loaded_contact(drive.meshing, phi1, torque, drive.machine.speed_rad_s)
        return drive.transmission.driven_angle(phi1).value + loaded.error_rad

    def dynamic(self, accuracy: float) -> Array:
        """The motion in time, from the same start for every accuracy."""
        own = self.drive.course
        found: Array = course(own.machine, own.states[:, 0], 1.0, accuracy).at(self.time_s)[2]
        return found
