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
from ncgear.errors import NoSuchMechanism
from ncgear.numerics.bounds import shown_above
from ncgear.numerics.units import N_M_PER_N_MM, RAD_S_PER_RPM
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
    return _stops(drive, *asked)


def _stops(drive: Geared, demand: Demand, motor: LineDrive) -> Stall | None:
    """Where a motor stops within the turns of the simulation."""
    given = drive.design.simulation
    start = demand.speed_rad_s if given.start == "on_law" else 0.0
    return stall_of(demand, motor.torque_n_mm, start, 2.0 * pi * given.turns)


TRIES = 2
"""Speeds without load that are tried with a torque: that at which the machine's mean torque leaves its own speed, and
one nearer by what this missed."""

STRONGER = (1.0, 2.0)
"""Torques at rest that are tried if the given one does not do, over the most that the machine asks for."""


def fitting_motor(drive: Geared, share: float) -> tuple[float, float] | None:
    """Speed without load in r/min and torque at rest in N m with which the motor turns the machine at its own speed.

    It does so to a share of that speed, and has been tried with these very numbers; the torque is the given one where
    this does.  None where none of those tried does.
    """
    asked, given = _asked(drive), drive.design.simulation.motor
    if asked is None or given is None:
        return None
    demand, least = asked[0], max(N_M_PER_N_MM * asked[0].torque_range_n_mm[1].value, given.stall_torque_n_m)
    stronger = (float(shown_above(times * least, 3)) for times in STRONGER)
    mean, wanted = N_M_PER_N_MM * demand.fluctuation.mean_torque_n_mm, demand.speed_rad_s / RAD_S_PER_RPM
    for torque in (given.stall_torque_n_m, *stronger):
        rpm = wanted / (1.0 - mean / torque) if mean < torque else 0.0
        for _ in range(TRIES if rpm else 0):
            rpm = float(f"{rpm:.4g}")
            line = StraightLine(torque / N_M_PER_N_MM, rpm * RAD_S_PER_RPM)
            runs = _runs_rad_s(drive, demand, LineDrive(line, Gearbox()))
            if runs is None:
                break
            if abs(runs / demand.speed_rad_s - 1.0) <= share:
                return rpm, torque
            rpm *= demand.speed_rad_s / runs
    return None


def _runs_rad_s(drive: Geared, demand: Demand, motor: LineDrive) -> float | None:
    """The mean speed at which a motor keeps the machine turning; None where it stops from the start on or later."""
    try:
        return None if _stops(drive, demand, motor) else speed_course(demand, motor).mean_rad_s
    except NoSuchMechanism:
        return None


def steady_rad_s(drive: Geared) -> float | None:
    """The mean speed at which the motor of the simulation keeps the machine turning; None where none is given.

    Raises NoSuchMechanism where it cannot.
    """
    return None if (asked := _asked(drive)) is None else speed_course(*asked).mean_rad_s
