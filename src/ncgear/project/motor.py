"""From keys to values: how the motor of a design drives its machine, before any tooth is followed in time.

A design has one motor at the most: the motor of ``drivetrain``, behind a gearbox, or of ``simulation``, at the driving
gear.  If a motor is too weak, a stronger motor is told, which was tried with exactly the told numbers.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import suppress
from math import cos, inf, pi, radians

from ncgear.design.keys.design import Design
from ncgear.design.keys.drivetrain import DrivetrainMotor
from ncgear.design.keys.masses import Motor as LineKeys
from ncgear.design.words import listed
from ncgear.drivetrain.cycle import Cycle, cycle_of, rubbing
from ncgear.drivetrain.losses import Demand, losses_of, most_mesh_loss_factor
from ncgear.drivetrain.motor import Gearbox, MotorLoad, Stall, StraightLine, motor_load, stall_of
from ncgear.drivetrain.speed import LineDrive, SpeedCourse, speed_course
from ncgear.dynamics.motion_in_time import Motor
from ncgear.errors import NoSuchMechanism, WrongInput
from ncgear.frozen import dataclass
from ncgear.interrupts import TimeIsOver, at_most
from ncgear.numerics.bounds import shown_above, shown_below
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

    @property
    def turns_rpm(self) -> float:
        """The motor's speed at the machine's."""
        return self.load.speed_rad_s / RAD_S_PER_RPM

    @property
    def faults(self) -> set[str]:
        """What the motor does not do: it stops, is hot or weak, turns too fast, or the machine is off its speed."""
        given, course, peak = self.given, self.course, self.given.peak_torque_n_m
        if self.stops:
            return {"stops"}
        tests = {
            "hot": self.rms_n_m > given.rated_torque_n_m,
            "weak": peak is not None and self.most_n_m > peak,
            "fast": course is None and self.turns_rpm > (1.0 + OFF_SPEED) * given.rated_speed_rpm,
            "off speed": course is not None and not _is_near(course.mean_rad_s, self.demand),
        }
        return {fault for fault, true in tests.items() if true}


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
    most = tuple(most_mesh_loss_factor(pitch, reach * pitch.size.module_mm, steep) for pitch in pitches)
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

STEPS = 12
"""Motors that are tried one after the other: a motor whose line rises with its rated torque bears more with each."""

STRONGER = 2.0
"""Torque at rest of a motor in place of one that stops, as a multiple of that, or of the machine's greatest torque:
with less, motors lose half of their speed and more."""

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


BARE = DrivetrainMotor.model_construct(rated_torque_n_m=inf, rated_speed_rpm=inf)
"""A motor of which nothing but the simulation's line at the driving gear counts."""


def fitting_simulated(drive: Geared) -> Told | None:
    """Keys of a motor for the simulation that turns the machine at its own speed, from its start on.

    Only changed keys are told; the torque stays if it is enough.  None where no tried motor works.
    """
    if (asked := _asked(drive)) is None:
        return None
    demand = asked[0]

    def starts(design: Design) -> bool:
        line = _line_drive(design, BARE)
        return line is not None and _stops(drive, demand, line) is None

    return _fitting(drive.design, [motor_of(drive.design, BARE, demand)], starts)


def fitting_geared(design: Design, found: Sequence[MotorResult]) -> Told | None:
    """The same for a motor behind its gearbox: torques and ratio, or the simulation's line.

    ``found`` is the motor that does not work, with the least and the most friction between the teeth, or as it is.
    """
    return _fitting(design, found, lambda _: True)


def _fitting(design: Design, found: Sequence[MotorResult], starts: Callable[[Design], bool]) -> Told | None:
    motor, line, runs = found[0].given, design.simulation.motor, tuple(found)
    given, changed = _keys(motor, line), design
    with suppress(TimeIsOver), at_most(MOST_SECONDS):
        for _ in range(STEPS):
            faults, peak = set().union(*(run.faults for run in runs)), motor.peak_torque_n_m
            if not faults and not starts(changed):
                faults = {"stops"}
            if not faults and (peak is None or peak >= motor.rated_torque_n_m):
                return {key: value for key, value in _keys(motor, line).items() if value != given[key]}
            motor, line = _bettered(motor, line, runs, faults)
            changed = design.model_copy(update={"simulation": design.simulation.model_copy(update={"motor": line})})
            rotor_kg_mm2 = motor.inertia_kg_mm2 * motor.gearbox.ratio**2
            again = (Demand(run.demand.cycle, run.demand.losses, rotor_kg_mm2) for run in runs)
            runs = tuple(motor_of(changed, motor, demand) for demand in again)
    return None


def _keys(motor: DrivetrainMotor, line: LineKeys | None) -> Told:
    own: Told = {"rated_torque_n_m": motor.rated_torque_n_m}
    if motor.peak_torque_n_m is not None:
        own["peak_torque_n_m"] = motor.peak_torque_n_m
    own["gearbox.ratio"] = motor.gearbox.ratio
    at_gear = {} if line is None else {key: getattr(line, key) for key in ("no_load_speed_rpm", "stall_torque_n_m")}
    return _under("drivetrain.motor", own) | _under("simulation.motor", at_gear)


def _bettered(
    motor: DrivetrainMotor, line: LineKeys | None, runs: Sequence[MotorResult], faults: set[str]
) -> tuple[DrivetrainMotor, LineKeys | None]:
    """The motor with what it lacks in these runs, to four digits; its line stands at the driving gear or is its own."""
    own, demand, rated, peak = motor.gearbox.ratio, runs[-1].demand, motor.rated_torque_n_m, motor.peak_torque_n_m
    slip = 1.0 - motor.rated_speed_rpm / motor.no_load_speed_rpm if motor.no_load_speed_rpm else 1.0
    rest_n_m = line.stall_torque_n_m if line else rated / slip * own * motor.gearbox.efficiency
    # How many times as fast the line is without load
    faster = 1.0
    if "stops" in faults:
        mean = N_M_PER_N_MM * demand.fluctuation.mean_torque_n_mm
        rest_n_m = STRONGER * max(rest_n_m, N_M_PER_N_MM * demand.torque_range_n_mm[1].value)
        free_rpm = line.no_load_speed_rpm if line else (motor.no_load_speed_rpm or motor.rated_speed_rpm) / own
        faster = demand.speed_rad_s / RAD_S_PER_RPM / (1.0 - mean / rest_n_m) / free_rpm
    elif "off speed" in faults:
        shares = [run.course.mean_rad_s / demand.speed_rad_s for run in runs if run.course]
        faster = len(shares) / sum(shares)
    elif "fast" in faults:
        faster = runs[0].turns_rpm / motor.rated_speed_rpm
    ratio = own
    if line:
        speeds = {"no_load_speed_rpm": float(f"{line.no_load_speed_rpm * faster:.4g}")}
        line = line.model_copy(update={**speeds, "stall_torque_n_m": float(shown_above(rest_n_m, 4))})
    elif faster != 1.0:
        ratio = float(shown_below(own / faster, 4))
    if "stops" in faults and not line:
        rated = float(shown_above(max(rated, slip * rest_n_m / (ratio * motor.gearbox.efficiency)), 4))
    if "hot" in faults:
        # With a line of its own, the motor stiffens with its rated torque
        stiffer = STIFFENED if runs[0].course else 1.0
        rated = float(shown_above(stiffer * max(run.rms_n_m for run in runs) * own / ratio, 4))
    if peak is not None and faults <= {"weak"}:
        peak = float(shown_above(max(*(run.most_n_m for run in runs), rated), 4))
    gearbox = motor.gearbox.model_copy(update={"ratio": ratio})
    changes = {"gearbox": gearbox, "rated_torque_n_m": rated, "peak_torque_n_m": peak}
    return motor.model_copy(update=changes), line


def _under(group: str, told: Told) -> Told:
    return {f"{group}.{key}": value for key, value in told.items()}


def _is_near(runs_rad_s: float, demand: Demand) -> bool:
    return abs(runs_rad_s / demand.speed_rad_s - 1.0) <= OFF_SPEED
