"""From keys to values: what the motor of a simulation makes of its machine, before any tooth is followed in time."""

from __future__ import annotations

from math import pi

from ncgear.drivetrain.cycle import cycle_of
from ncgear.drivetrain.demand import Demand
from ncgear.drivetrain.losses import losses_of
from ncgear.drivetrain.motor import Gearbox, StraightLine
from ncgear.drivetrain.speed import LineDrive, speed_course
from ncgear.drivetrain.stall import Stall, stall_of
from ncgear.dynamics.motion_in_time import Motor
from ncgear.project.forces import drive_line_of
from ncgear.project.geared import Geared


def _asked(drive: Geared) -> tuple[Demand, LineDrive] | None:
    """What the machine asks of the motor of the simulation, friction in the guide counted, that of the teeth left out.

    None where no motor is given; raises WrongInput where its shaft has no inertia.
    """
    line = drive_line_of(drive.design.simulation, drive.masses, drive.machine.speed_rad_s)
    if not isinstance(line, Motor):
        return None
    cycle = cycle_of(drive.rigid)
    motor = LineDrive(StraightLine(line.stall_torque_n_mm, line.speed_rad_s), Gearbox())
    return Demand(cycle, losses_of(cycle, None, 0.0)), motor


def motor_stall(drive: Geared) -> Stall | None:
    """Where the motor of the simulation stops within its turns; None where it passes, or where none is given."""
    if (asked := _asked(drive)) is None:
        return None
    given, (demand, motor) = drive.design.simulation, asked
    start = demand.speed_rad_s if given.start == "on_law" else 0.0
    return stall_of(demand, motor.torque_n_mm, start, 2.0 * pi * given.turns)


def steady_rad_s(drive: Geared) -> float | None:
    """The mean speed at which the motor of the simulation keeps the machine turning; None where none is given.

    Raises NoSuchMechanism where it cannot.
    """
    return None if (asked := _asked(drive)) is None else speed_course(*asked).mean_rad_s
