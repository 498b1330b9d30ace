"""From keys to values: how the motor of a design drives its machine, before any tooth is followed in time.

A design has one motor at the most: the motor of ``drivetrain``, behind a gearbox, or of ``simulation``, at the driving
gear.  If a motor is too weak, a stronger motor is told, which was tried with exactly the told numbers.
"""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from math import cos, pi, radians

from ncgear.design.keys.base import listed
from ncgear.design.keys.design import Design
from ncgear.design.keys.drivetrain import DrivetrainMotor
from ncgear.drivetrain.cycle import Cycle, cycle_of, rubbing
from ncgear.drivetrain.losses import Demand, losses_of, most_mesh_loss_factor
from ncgear.drivetrain.motor import Gearbox, MotorLoad, Stall, StraightLine, motor_load, stall_of
from ncgear.drivetrain.speed import LineDrive, SpeedCourse, speed_course
from ncgear.dynamics.motion_in_time import Motor
from ncgear.errors import NoSuchMechanism, WrongInput
from ncgear.frozen import dataclass
from ncgear.interrupts import TimeIsOver, at_most
from ncgear.numerics.bounds import shown_above
from ncgear.numerics.units import N_M_PER_N_MM, RAD_S_PER_RPM
from ncgear.project.forces import drive_line_of
from ncgear.project.geared import Geared
from ncgear.project.tooth_form import reach_in_pitches


@dataclass(frozen=True, eq=False)
class MotorResult:
    """The motor of a drivetrain: the machine's demand, the motor's load at even speed, the course of the speed.

    The course is None without a line of the motor, and where the motor stops; ``stops`` says why, in words.
    """

    given: DrivetrainMotor
    demand: Demand
    load: MotorLoad
    course: SpeedCourse | None
    stops: str = ""

    @property
    def rms_n_m(self) -> float:
        """Root of the mean square of the motor's torque."""
        return N_M_PER_N_MM * (self.course.rms_n_mm if self.course else self.load.rms_n_mm)

    @property
    def most_n_m(self) -> float:
        """The motor's largest torque."""
        return N_M_PER_N_MM * (self.course.motor_range_n_mm[1] if self.course else self.load.most_n_mm.value)


def demand_of(design: Design, smooth: Cycle, mesh_loss_factors: tuple[float, ...]) -> Demand:
    """The demand of a smooth cycle on the driving shaft, with friction and with the inertia of the motor's rotor."""
    motor = design.drivetrain.motor if design.drivetrain else None
    losses = losses_of(smooth, mesh_loss_factors, design.simulation.friction.dynamic)
    rotor_kg_mm2 = motor.inertia_kg_mm2 * motor.gearbox.ratio**2 if motor else 0.0
    return Demand(rubbing(smooth, losses.mesh_shares), losses, rotor_kg_mm2)


def motor_of(design: Design, given: DrivetrainMotor, demand: Demand) -> MotorResult:
    """The motor of a drivetrain; raises WrongInput where its shaft has no inertia."""
    drive = _line_drive(design, given)
    if drive is not None and not demand.inertia(demand.cycle.loads.phi1_rad)[0].min() > 0.0:
        raise WrongInput(
            "0 given, but a motor's shaft needs inertia; give driving_gear_kg_mm2 or a flywheel",
            key="masses.driving_gear_kg_mm2",
        )
    course, stops = None, ""
    if drive is not None:
        try:
            course = speed_course(demand, drive)
        except NoSuchMechanism as refusal:
            stops = refusal.problem
    return MotorResult(given, demand, motor_load(demand, _gearbox(given)), course, stops)


def motor_within(drive: Geared) -> tuple[MotorResult, MotorResult]:
    """The motor of a drivetrain without teeth: with no friction between them, and with the most that is possible."""
    design, around = drive.design, drive.design.drivetrain
    assert around is not None
    assert around.motor is not None
    gears = drive.gears
    flat, steep = radians(min(gears.rack.angles_deg)), radians(max(gears.rack.angles_deg))
    reach = reach_in_pitches(gears) * pi * cos(flat)
    # Friction between helical teeth is not computed
    pitches = [] if drive.helix else [pair.pitch for pair in drive.by_stage]
    most = tuple(most_mesh_loss_factor(one, reach * one.size.module_mm, steep) for one in pitches)
    smooth = cycle_of(drive.rigid)
    least, greatest = (motor_of(design, around.motor, demand_of(design, smooth, factors)) for factors in ((), most))
    return least, greatest


def _gearbox(given: DrivetrainMotor) -> Gearbox:
    return Gearbox(given.gearbox.ratio, given.gearbox.efficiency)


def _line_drive(design: Design, given: DrivetrainMotor) -> LineDrive | None:
    """The motor's line: its own, or the simulation's at the driving gear."""
    gearbox, simulated = _gearbox(given), design.simulation.motor
    if given.no_load_speed_rpm is not None:
        rest_n_m = given.rated_torque_n_m / (1.0 - given.rated_speed_rpm / given.no_load_speed_rpm)
        line = StraightLine(rest_n_m / N_M_PER_N_MM, given.no_load_speed_rpm * RAD_S_PER_RPM)
        return LineDrive(line, gearbox, given.overrunning_clutch)
    if simulated is None:
        return None
    line = StraightLine(simulated.stall_torque_n_m / N_M_PER_N_MM, simulated.no_load_speed_rpm * RAD_S_PER_RPM)
    # The line at the driving gear is behind the gearbox, and includes its losses
    own = StraightLine(line.stall_n_mm / (gearbox.ratio * gearbox.efficiency), line.no_load_rad_s * gearbox.ratio)
    return LineDrive(own, gearbox, given.overrunning_clutch)


def _asked(drive: Geared) -> tuple[Demand, LineDrive] | None:
    """The machine's demand on the motor of the simulation, with friction in the guide, without friction of the teeth.

    None where no motor is given; raises WrongInput where its shaft has no inertia.
    """
    line = drive_line_of(drive.design.simulation, drive.masses, drive.machine.speed_rad_s)
    if not isinstance(line, Motor):
        return None
    cycle = cycle_of(drive.rigid)
    motor = LineDrive(StraightLine(line.stall_torque_n_mm, line.speed_rad_s), Gearbox())
    return Demand(cycle, losses_of(cycle, (), 0.0)), motor


def motor_stall(drive: Geared) -> Stall | None:
    """Where the motor of the simulation stops within its turns; None if it keeps turning, or if none is given."""
    if (asked := _asked(drive)) is None:
        return None
    return _stops(drive, *asked)


def _stops(drive: Geared, demand: Demand, motor: LineDrive) -> Stall | None:
    given = drive.design.simulation
    start = demand.speed_rad_s if given.start == "on_law" else 0.0
    return stall_of(demand, motor.torque_n_mm, start, 2.0 * pi * given.turns)


def steady_rad_s(drive: Geared) -> float | None:
    """The mean speed at which the motor of the simulation keeps the machine turning; None without a motor.

    Raises NoSuchMechanism where the motor cannot keep it turning.
    """
    return None if (asked := _asked(drive)) is None else speed_course(*asked).mean_rad_s


# A motor that works, in place of a motor that does not.


Told = dict[str, float]
"""Dotted keys of the design file with values, as they are written."""

TRIES = 3
"""Number of no-load speeds that are tried with each torque.  The first follows from the machine's mean torque; each
next speed is corrected by the error of the speed before."""

STRONGER = (2.0, 4.0)
"""Torques at rest that are tried if the given torque is not enough, as multiples of the machine's greatest torque: with
less, motors lose half of their speed and more."""

STIFFENED = 1.01
"""Factor on the r.m.s.  torque for which a stronger motor is rated: with a higher rating it holds its speed better."""

MOST_SECONDS = 5.0
"""Most processor time of these trials."""

OFF_SPEED = 0.03
"""Share by which a motor's own speed may differ from the wanted speed: about the slip of usual motors."""


def told_words(found: Told | None) -> str:
    """The keys of a motor that works, or the words that none was found."""
    if found is None:
        return "another speed, more torque or a heavier flywheel is needed; none of the tried motors works"
    return listed((f"{key}: {value:.6g}" for key, value in found.items()), "and")


def fitting_simulated(drive: Geared) -> Told | None:
    """Keys of a motor for the simulation that turns the machine at its own speed.

    Only changed keys are told; the torque stays if it is enough.  None where no tried motor works.
    """
    asked, given = _asked(drive), drive.design.simulation.motor
    if asked is None or given is None:
        return None
    demand = asked[0]

    def tried(rpm: float, torque_n_m: float) -> tuple[Told, float | None]:
        torque_n_m = torque_n_m if torque_n_m == given.stall_torque_n_m else float(shown_above(torque_n_m, 3))
        told = {"no_load_speed_rpm": float(f"{rpm:.4g}"), "stall_torque_n_m": torque_n_m}
        line = StraightLine(torque_n_m / N_M_PER_N_MM, told["no_load_speed_rpm"] * RAD_S_PER_RPM)
        changed = {key: value for key, value in told.items() if value != getattr(given, key)}
        return _under("simulation.motor", changed), _runs_rad_s(drive, demand, LineDrive(line, Gearbox()))

    return _fitting(demand, given.stall_torque_n_m, tried)


def fitting_geared(design: Design, found: MotorResult) -> Told | None:
    """As ``fitting_simulated``, for a motor that stops behind its gearbox: torques and ratio, or line, that work."""
    given, demand, line = found.given, found.demand, design.simulation.motor

    def run(ratio: float, rated_n_m: float, of_line: Told) -> MotorResult:
        gearbox = given.gearbox.model_copy(update={"ratio": ratio})
        motor = given.model_copy(update={"rated_torque_n_m": rated_n_m, "gearbox": gearbox})
        simulation = design.simulation.model_copy(update={"motor": line and line.model_copy(update=of_line)})
        rotor_kg_mm2 = given.inertia_kg_mm2 * ratio**2
        changed = design.model_copy(update={"simulation": simulation})
        return motor_of(changed, motor, Demand(demand.cycle, demand.losses, rotor_kg_mm2))

    def tried(rpm: float, torque_n_m: float) -> tuple[Told, float | None]:
        """The motor with this speed and at least this torque in its line at the driving gear, and its rated torque."""
        of_line, ratio, rated = Told(), given.gearbox.ratio, given.rated_torque_n_m
        if given.no_load_speed_rpm is None:
            of_line = {"no_load_speed_rpm": float(f"{rpm:.4g}"), "stall_torque_n_m": float(shown_above(torque_n_m, 3))}
        else:
            ratio = float(f"{given.no_load_speed_rpm / rpm:.4g}")
            slip = 1.0 - given.rated_speed_rpm / given.no_load_speed_rpm
            rated = max(slip * torque_n_m / (ratio * given.gearbox.efficiency), rated)
        needed = N_M_PER_N_MM * found.load.rms_n_mm * given.gearbox.ratio / ratio
        rated = float(shown_above(max(rated, needed), 3))
        runs = run(ratio, rated, of_line)
        if runs.course is not None and runs.rms_n_m > rated:
            # With a line of its own, the motor stiffens with its rated torque
            rated = float(shown_above(STIFFENED * runs.rms_n_m, 3))
            runs = run(ratio, rated, of_line)
        if runs.course is None:
            return {}, None
        own: Told = {"rated_torque_n_m": rated} | ({"gearbox.ratio": ratio} if ratio != given.gearbox.ratio else {})
        if given.peak_torque_n_m is not None and given.peak_torque_n_m < max(runs.most_n_m, rated):
            own["peak_torque_n_m"] = float(shown_above(max(runs.most_n_m, rated), 3))
        told = _under("drivetrain.motor", own) | _under("simulation.motor", of_line)
        return told, runs.course.mean_rad_s if runs.rms_n_m <= rated else None

    return _fitting(demand, None, tried)


def _under(group: str, told: Told) -> Told:
    return {f"{group}.{key}": value for key, value in told.items()}


def _fitting(
    demand: Demand, given_n_m: float | None, tried: Callable[[float, float], tuple[Told, float | None]]
) -> Told | None:
    """The first motor that works, among torques at rest in N m and no-load speeds in r/min at the driving gear.

    ``tried`` gives the keys to tell, and the mean speed in rad/s with them; None where the motor stops.
    """
    own = () if given_n_m is None else (given_n_m,)
    least = max(N_M_PER_N_MM * demand.torque_range_n_mm[1].value, *own, 0.0)
    mean, wanted = N_M_PER_N_MM * demand.fluctuation.mean_torque_n_mm, demand.speed_rad_s / RAD_S_PER_RPM
    with suppress(TimeIsOver), at_most(MOST_SECONDS):
        for torque in (*own, *(times * least for times in STRONGER)):
            rpm = wanted / (1.0 - mean / torque) if mean < torque else 0.0
            for _ in range(TRIES if rpm else 0):
                told, runs = tried(rpm, torque)
                if runs is None:
                    break
                if _is_near(runs, demand):
                    return told
                rpm *= demand.speed_rad_s / runs
    return None


def _runs_rad_s(drive: Geared, demand: Demand, motor: LineDrive) -> float | None:
    """The mean speed at which a motor keeps the machine turning; None where it stops from the start on or later."""
    try:
        runs = speed_course(demand, motor).mean_rad_s
    except NoSuchMechanism:
        return None
    # The start takes as long to compute, and matters only where the speed is right
    return None if _is_near(runs, demand) and _stops(drive, demand, motor) else runs


def _is_near(runs_rad_s: float, demand: Demand) -> bool:
    return abs(runs_rad_s / demand.speed_rad_s - 1.0) <= OFF_SPEED
