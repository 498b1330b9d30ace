"""What is told of bearings, shafts, losses, motor, flywheel and couplings, as sections of plain values."""

from __future__ import annotations

from collections.abc import Sequence
from math import degrees
from typing import Any

from ncgear.drivetrain.bearings import BearingLife
from ncgear.drivetrain.losses import Demand
from ncgear.drivetrain.pto import Excursion
from ncgear.drivetrain.speed import SpeedCourse
from ncgear.figures.numbers import known
from ncgear.numerics.extrema import extreme
from ncgear.numerics.units import KG_M2, N_M_PER_N_MM, RAD_S_PER_RPM
from ncgear.project.drivetrain import DrivetrainResult, PowerTakeOffResult, ShaftResult
from ncgear.project.motor import MotorResult

W = 1e-3
"""One N mm/s in W; likewise one N mm in J."""


def drivetrain_figures(found: DrivetrainResult) -> dict[str, Any]:
    """The sections of a drivetrain; parts that are not given have none.

    A driving angle belongs to the key before it, and None stands where nothing has been given or nothing limits.
    """
    return {
        "losses": _losses(found),
        **{
            shaft.words.replace(" ", "_"): _shaft(shaft)
            for shaft in found.shafts
            if shaft is not None and shaft.bearings
        },
        "flywheel": _flywheel(found),
        **({"motor": _motor(found.motor)} if found.motor else {}),
        **({"pto": _pto(found.pto, found.demand)} if found.pto else {}),
    }


def _losses(found: DrivetrainResult) -> dict[str, Any]:
    demand, losses = found.demand, found.demand.losses
    cycle_s = demand.cycle.cycle_rad / demand.speed_rad_s
    least, most = demand.torque_range_n_mm
    return {
        "useful_power_w": W * losses.useful_n_mm / cycle_s,
        "mesh_friction": losses.mesh_friction,
        "mesh_loss_factor": losses.mesh_loss_factor,
        "mesh_loss_w": None if losses.mesh_loss_factor is None else W * losses.mesh_n_mm / cycle_s,
        "mesh_efficiency": None if losses.mesh_loss_factor is None else 1.0 - losses.mesh_share,
        "guide_friction": losses.guide_friction,
        "guide_loss_w": W * losses.guide_n_mm / cycle_s,
        "efficiency": losses.efficiency,
        "mean_power_with_tooth_friction_w": W * demand.fluctuation.work_n_mm / cycle_s,
        **extreme("peak_driving_torque_with_tooth_friction", "n_m", most, N_M_PER_N_MM),
        **extreme("least_driving_torque_with_tooth_friction", "n_m", least, N_M_PER_N_MM),
    }


def _shaft(found: ShaftResult) -> dict[str, Any]:
    bearings = found.bearings or ()
    told: dict[str, Any] = {
        name: _bearing(bearing) for name, bearing in zip(("bearing_a", "bearing_b"), bearings, strict=False)
    }
    if found.most_bent is not None:
        told["largest_bending_moment_n_m"] = N_M_PER_N_MM * found.most_bent.moment_n_mm
        told["largest_bending_moment_along_shaft_mm"] = found.most_bent.at_mm
    if found.shaft is not None:
        told["estimate_of_shaft"] = {
            "diameter_mm": found.shaft.section.diameter_mm,
            **vars(found.shaft.stresses),
            "fatigue_safety": known(found.shaft.fatigue),
            "yield_safety": known(found.shaft.yielding),
        }
    if found.key is not None:
        told["key"] = {
            "pressure_mpa": found.key.pressure_mpa,
            "safety": known(found.key.safety),
            "torque_changes_sense": found.key.both_senses,
        }
    if found.jammed is not None:
        jam: dict[str, Any] = {"torque_n_m": N_M_PER_N_MM * max(found.jammed.torques_n_mm)}
        for letter, most, safety in zip("ab", found.jammed.largest_n, found.jammed.static_safety, strict=True):
            jam |= {**extreme(f"bearing_{letter}_force", "n", most), f"bearing_{letter}_static_safety": safety}
        if found.jammed.yielding is not None:
            jam["yield_safety"] = known(found.jammed.yielding)
        if found.jammed_key is not None:
            jam["key_safety"] = known(found.jammed_key.safety)
        told["jam"] = jam
    return {**told, "decided_by": dict(found.decided_by)}


def _bearing(found: BearingLife) -> dict[str, Any]:
    return {
        **extreme("peak_force", "n", found.largest_n),
        **(extreme("peak_thrust", "n", found.thrust_n) if found.thrust_n.value else {}),
        "equivalent_load_n": found.equivalent_n,
        "mean_speed_rpm": found.speed_rad_s / RAD_S_PER_RPM,
        "dynamic_rating_needed_n": found.needed_rating_n,
        "dynamic_rating_n": found.bearing.dynamic_rating_n,
        "life_h": found.life_h,
        "static_safety": found.static_safety,
        "load_within_iso_281": found.within_iso_281,
    }


def _flywheel(found: DrivetrainResult) -> dict[str, Any]:
    told = {
        "speed_fluctuation_wanted": found.wanted_fluctuation,
        "inertia_needed_on_driving_shaft_kg_m2": KG_M2 * found.flywheel_kg_mm2,
    }
    return told if found.disc is None else {**told, "disc": vars(found.disc)}


def _motor(found: MotorResult) -> dict[str, Any]:
    given, demand, load = found.given, found.demand, found.load
    useful_n_mm_s = demand.losses.useful_n_mm / demand.cycle.cycle_rad * demand.speed_rad_s
    peak = None if given.peak_torque_n_m is None else given.peak_torque_n_m / (N_M_PER_N_MM * load.most_n_mm.value)
    told: dict[str, Any] = {
        "rated_power_w": given.rated_torque_n_m * given.rated_speed_rpm * RAD_S_PER_RPM,
        "rated_torque_n_m": given.rated_torque_n_m,
        "even_speed": {
            "motor_speed_rpm": load.speed_rad_s / RAD_S_PER_RPM,
            "rms_torque_n_m": N_M_PER_N_MM * load.rms_n_mm,
            "rms_torque_of_rated": N_M_PER_N_MM * load.rms_n_mm / given.rated_torque_n_m,
            "needed_power_w": W * load.rms_power_n_mm_s,
            "mean_torque_n_m": N_M_PER_N_MM * load.mean_n_mm,
            **extreme("peak_torque", "n_m", load.most_n_mm, N_M_PER_N_MM),
            "peak_torque_safety": peak if peak is None or peak > 0.0 else None,
            **extreme("most_braking_torque", "n_m", load.least_n_mm, N_M_PER_N_MM),
            "most_braking_power_w": W * min(load.least_n_mm.value, 0.0) * load.speed_rad_s,
            "mean_power_while_braking_w": W * load.braking_n_mm * load.speed_rad_s,
            "time_braking_percent": 100.0 * load.braking_share,
            "efficiency_gearbox_included": useful_n_mm_s / (load.mean_n_mm * load.speed_rad_s)
            if load.mean_n_mm > 0.0
            else None,
        },
    }
    if found.stops:
        told["stops"] = found.stops
    if found.course is not None:
        told["with_flywheel"] = _course(found.course, given.rated_torque_n_m, given.peak_torque_n_m)
    return told


def _course(course: SpeedCourse, rated_n_m: float, peak_n_m: float | None) -> dict[str, Any]:
    slow, fast = course.range_rad_s
    least, most = course.motor_range_n_mm
    power = course.drive_work_n_mm / course.period_s
    return {
        "mean_speed_rpm": course.mean_rad_s / RAD_S_PER_RPM,
        **extreme("least_speed", "rpm", slow, 1.0 / RAD_S_PER_RPM),
        **extreme("largest_speed", "rpm", fast, 1.0 / RAD_S_PER_RPM),
        "speed_fluctuation": course.fluctuation,
        "strokes_per_minute": 60.0 / course.period_s,
        "rms_torque_n_m": N_M_PER_N_MM * course.rms_n_mm,
        "rms_torque_of_rated": N_M_PER_N_MM * course.rms_n_mm / rated_n_m,
        "peak_torque_n_m": N_M_PER_N_MM * most,
        "peak_torque_safety": None if peak_n_m is None or most <= 0.0 else peak_n_m / (N_M_PER_N_MM * most),
        "most_braking_torque_n_m": N_M_PER_N_MM * min(least, 0.0),
        "mean_driving_power_w": W * power,
        "energy_error": course.energy_error,
        "energy_residual": course.unsettled,
    }


def _pto(found: PowerTakeOffResult, demand: Demand) -> dict[str, Any]:
    """Where and how far the coupling lets go; the driving angles may go on into the next cycle."""
    told: dict[str, Any] = {}
    cycle_s = demand.cycle.cycle_rad / demand.speed_rad_s
    if found.slips is not None:
        heats = [slip.heat_n_mm for slip in found.slips]
        lasting = any(slip.end_rad is None for slip in found.slips)
        told["torque_limiter"] = {
            "slips_at_deg": _spans_deg(found.slips),
            "stops_the_machine": lasting,
            "least_speed_rpm": 0.0 if lasting else _speed_rpm(found.slips, demand, min),
            "heat_w": None if lasting else W * sum(heat or 0.0 for heat in heats) / cycle_s,
        }
    if found.runs_ahead is not None:
        told["overrunning_clutch"] = {
            "runs_ahead_at_deg": _spans_deg(found.runs_ahead),
            "largest_speed_rpm": _speed_rpm(found.runs_ahead, demand, max),
            "largest_energy_gained_j": W * max((run.energy_n_mm for run in found.runs_ahead), default=0.0),
        }
    return told


def _spans_deg(found: Sequence[Excursion]) -> list[list[float]]:
    return [[degrees(excursion.start_rad), degrees(excursion.last_rad)] for excursion in found]


def _speed_rpm(found: Sequence[Excursion], demand: Demand, choice: Any) -> float:
    speeds = [excursion.speed_rad_s.value for excursion in found]
    return float(choice([demand.speed_rad_s, *speeds])) / RAD_S_PER_RPM
