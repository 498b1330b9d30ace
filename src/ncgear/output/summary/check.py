"""What a check finds, as plain values: keys end in their unit."""

from __future__ import annotations

from math import degrees
from typing import TYPE_CHECKING, Any

from ncgear.drive import Drive
from ncgear.kinematics.check import KinematicCheck
from ncgear.output.advice.collected import check_advice
from ncgear.output.comparison_rows import comparison_rows

if TYPE_CHECKING:
    pass


def check_summary(drive: Drive) -> dict[str, Any]:
    """Kinematics and power; needs no pitch curve."""
    return {
        "design": {"name": drive.design.name, "description": drive.design.description, "law": drive.design.motion.law},
        "drive": _drive(drive),
        **_stages(drive),
        "closure": _closure(drive),
        "ratio": _ratio(drive),
        "check": _check(drive),
        "comparison": comparison_rows(drive),
        "warnings": [advice.line for advice in check_advice(drive)],
    }


def _drive(drive: Drive) -> dict[str, Any]:
    lobes = drive.transmission.lobes
    linkage = drive.linkage
    return {
        "speed_rpm": drive.design.operation.speed_rpm,
        "law_speed_rpm": drive.law_speed_rpm,
        "lobes_driving": lobes.driving,
        "lobes_driven": lobes.driven,
        "crank_mm": linkage.crank_mm,
        "stroke_mm": linkage.stroke_mm,
        "working_crank_angle_deg": degrees(linkage.working_angle_rad),
        "working_driving_angle_deg": degrees(drive.machine.extended_rad),
        **_solved(drive),
    }


def _solved(drive: Drive) -> dict[str, Any]:
    """The stroke's quantities after the solve, and which one was solved for."""
    law = drive.law.stroke_law
    if law is None:
        return {}
    stroke = law.stroke
    return {
        "solved_for": getattr(drive.design.motion, "solve_for", None),
        "v1_mm_s": stroke.v1_mm_s,
        "v2_mm_s": stroke.v2_mm_s,
        "a1_mm_s2": stroke.a1_mm_s2,
        "return_basis": "inverse_ratio" if law.return_law.inverse else "ratio",
        "return_constant_e": None if law.return_law.inverse else law.return_law.extrapolated_ratio,
    }


def _stages(drive: Drive) -> dict[str, Any]:
    """Nothing of a single pair; of one of two, which it is; of both together, each one's range and angle."""
    if drive.design.stages == 1:
        return {}
    if drive.stage is not None:
        return {"stage": _stage(drive, drive.stage)}
    return {"stages": {f"stage_{pair.stage}": _range_and_angle(pair) for pair in drive.by_stage}}


def _stage(drive: Drive, stage: int) -> dict[str, Any]:
    """All that is of this pair and not of the machine: angles phi1 of its own are its driving gear's."""
    return {
        "number": stage,
        "of": drive.design.stages,
        "driving_gear_on": "driving shaft" if stage == 1 else "shaft between the stages",
        "driven_gear_on": "shaft between the stages" if stage == 1 else "crank shaft",
        # The first pair turns the shaft between them the other way round.
        "seen_from": "driving end" if stage == 1 else "other end of the shafts",
    }


def _range_and_angle(drive: Drive) -> dict[str, Any]:
    from ncgear.pitch.pair import largest_tangent_angle_rad

    low, high = drive.pair.transmission.ratio_range
    tangent = degrees(largest_tangent_angle_rad(drive.pair.transmission).value)
    found = {"ratio_min": low.value, "ratio_max": high.value, "max_tangent_angle_deg": tangent}
    if drive.design.gears is None:
        return found
    return {**found, "max_pressure_angle_deg": tangent + drive.design.gears.rack.pressure_angle_deg}


def _closure(drive: Drive) -> dict[str, Any]:
    law = drive.law.stroke_law
    return {
        "residual_rad": abs(drive.transmission.closure_error_rad),
        "stroke_residual_mm": abs(law.stroke.closing_error_mm) if law else 0.0,
    }


def _ratio(drive: Drive) -> dict[str, Any]:
    """Of the pair that is told, else of the whole."""
    low, high = (drive.transmission if drive.stage is None else drive.pair.transmission).ratio_range
    return {"min": low.value, "max": high.value, "min_at_rad": low.at, "max_at_rad": high.at}


def _check(drive: Drive) -> dict[str, Any]:
    result = peaks(drive.check)
    factor = drive.law_speed_rpm / drive.design.operation.speed_rpm
    if drive.law.stroke_law is not None:
        result["at_law_speed"] = {
            "speed_rpm": drive.law_speed_rpm,
            "peak_power_w": drive.check.peak_power_w.value * factor,
            "peak_speed_mm_s": drive.check.peak_speed_mm_s.value * factor,
            "peak_acceleration_working_mm_s2": drive.check.peak_acceleration_working_mm_s2.value * factor**2,
            "peak_acceleration_cycle_mm_s2": drive.check.peak_acceleration_cycle_mm_s2.value * factor**2,
        }
    result["uniform_crank"] = peaks(drive.uniform_check)
    return result


def peaks(check: KinematicCheck) -> dict[str, Any]:
    """Peaks of a check with the driving angle of each."""
    return {
        "peak_power_w": check.peak_power_w.value,
        "peak_power_at_rad": check.peak_power_w.at,
        "mean_power_w": check.mean_power_w,
        "peak_speed_mm_s": check.peak_speed_mm_s.value,
        "peak_speed_at_rad": check.peak_speed_mm_s.at,
        "peak_acceleration_working_mm_s2": check.peak_acceleration_working_mm_s2.value,
        "peak_acceleration_working_at_rad": check.peak_acceleration_working_mm_s2.at,
        "peak_acceleration_cycle_mm_s2": check.peak_acceleration_cycle_mm_s2.value,
        "peak_acceleration_cycle_at_rad": check.peak_acceleration_cycle_mm_s2.at,
    }
