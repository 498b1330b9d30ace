"""Studies of the levels of simulation: what rigid, quasi-static and dynamic leave out, and what they cost."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property, partial
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from ncgear.errors import WrongInput
from ncgear.numerics.arrays import Array
from ncgear.precision.study import Method, Study

if TYPE_CHECKING:
    from ncgear.project.drive import Drive

DESIGNS = Path(__file__).parents[3] / "designs"
"""Worked examples of the source tree; an installed package has none."""

ACCURACIES = (1e-5, 1e-6, 1e-7)
"""At 1e-4 the balance of energy is missed, which is an error."""
REFERENCE = "DOP853"
EXACT = 1e-9
ENOUGH_RAD = 3e-6
"""A micrometre at the baler's crank of 380 mm."""

TIMES = 2001


@dataclass(frozen=True, eq=False)
class Simulated:
    """A design with masses; what it has is computed when it is first asked for."""

    name: str

    @cached_property
    def drive(self) -> Drive:
        """The design's stages."""
        from ncgear.design.reading.design_file import load
        from ncgear.project.drive import Drive

        return Drive(load(DESIGNS / f"{self.name}.yaml").design)

    @cached_property
    def time_s(self) -> Array:
        """Times of one turn at constant driving speed, shape (n,)."""
        return np.linspace(0.0, 2.0 * np.pi / self.drive.machine.speed_rad_s * (1.0 - 1e-3), TIMES)

    @cached_property
    def phi1_rad(self) -> Array:
        """Driving angles at those times."""
        return self.time_s * self.drive.machine.speed_rad_s

    @cached_property
    def exact_rad(self) -> Array:
        """Driven angles by an explicit method of order 8, which shares nothing with those for stiff equations."""
        return self.dynamic(REFERENCE, EXACT)

    def rigid(self, _level: int) -> Array:
        """Driven angles of the law, with the forces that keep it."""
        self.drive.rigid.machine.at(self.phi1_rad)
        return self.drive.transmission.driven_angle(self.phi1_rad).value

    def quasi_static(self, _level: int) -> Array:
        """Driven angles at which the teeth bear the rigid level's torque."""
        from ncgear.dynamics.quasi_static import loaded_contact

        drive, phi1 = self.drive, self.phi1_rad
        torque = drive.rigid.machine.at(phi1).driven_torque.value
        loaded = loaded_contact(drive.meshing, phi1, torque, drive.machine.speed_rad_s)
        return drive.transmission.driven_angle(phi1).value + loaded.error_rad

    def dynamic(self, method: str, accuracy: float) -> Array:
        """Driven angles of the motion in time, from the same start."""
        from ncgear.dynamics.motion_in_time import course

        own = self.drive.course
        found: Array = course(own.mechanism, own.states[:, 0], 1.0, accuracy, method).at(self.time_s)[2]
        return found

    def error_rad(self, found: Array) -> float:
        """Root mean square over the turn."""
        return float(np.sqrt(np.mean((found - self.exact_rad) ** 2)))


def of_baler() -> Study:
    """The published baler with chosen masses."""
    return _study("simulation-baler", "Levels of simulation: the baler with masses, 20 r/min", "baler-dynamics")


def of_half() -> Study:
    """The law of half the power."""
    return _study("simulation-half", "Levels of simulation: half the power, 60 r/min", "baler-half")


def _study(key: str, title: str, name: str) -> Study:
    from ncgear.dynamics.motion_in_time import ACCURACY, METHOD

    if not (DESIGNS / f"{name}.yaml").exists():
        raise WrongInput(f"needs designs/{name}.yaml of the source tree, which is not here", key=key)
    simulated = Simulated(name)
    return Study(
        key=key,
        title=title,
        unit="rad of the driven gear, rms over a turn",
        reference="the motion in time by an explicit method of order 8 (DOP853) at an accuracy of 1e-9, which agrees "
        "with LSODA at 1e-10 to 1e-8 rad: what a level leaves out is its error",
        methods=(
            Method("rigid", "", (0,), simulated.rigid),
            Method("quasi-static", "", (0,), simulated.quasi_static),
            *(_in_time(simulated, solver) for solver in ("LSODA", "Radau", "BDF")),
        ),
        error=simulated.error_rad,
        chosen=(f"dynamic, {METHOD}", ACCURACY),
        enough=ENOUGH_RAD,
        because="where motion in time is asked for, it is to be right to a micrometre of the slider even where flanks "
        "part and meet; rigid and quasi-static are chosen by name where what they leave out does not count. Teeth, "
        "contact and tables, which all but rigid need, are not in these times",
    )


def _in_time(simulated: Simulated, solver: str) -> Method:
    return Method(f"dynamic, {solver}", "accuracy", ACCURACIES, partial(simulated.dynamic, solver))
