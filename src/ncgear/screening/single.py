"""The figures of one design, by the stages that a check and a build use."""

from __future__ import annotations

from math import degrees, radians

from ncgear.design.schema import Design
from ncgear.drive import Drive
from ncgear.pitch.shape import Gear


def single_figures(design: Design) -> dict[str, float]:
    """Every figure of a design; raises WrongInput or NoSuchMechanism where it cannot be made."""
    drive = Drive(design)
    figures = {**_law(drive), **_check(drive)}
    # Of two stages the curves are those of each pair, and a build alone tells them apart.
    return figures if design.gears is None or design.stages > 1 else {**figures, **_pitch(drive)}


def _law(drive: Drive) -> dict[str, float]:
    stroke, (low, high) = drive.law.stroke_law, drive.transmission.ratio_range
    return {
        "drive.law_speed_rpm": drive.law_speed_rpm,
        "closure.residual_rad": abs(drive.transmission.closure_error_rad),
        "closure.stroke_residual_mm": abs(stroke.stroke.closing_error_mm) if stroke else 0.0,
        "ratio.min": low.value,
        "ratio.max": high.value,
    }


def _check(drive: Drive) -> dict[str, float]:
    check = drive.check
    return {
        "check.peak_power_w": check.peak_power_w.value,
        "check.mean_power_w": check.mean_power_w,
        "check.peak_speed_mm_s": check.peak_speed_mm_s.value,
        "check.peak_acceleration_working_mm_s2": check.peak_acceleration_working_mm_s2.value,
        "check.peak_acceleration_cycle_mm_s2": check.peak_acceleration_cycle_mm_s2.value,
    }


def _pitch(drive: Drive) -> dict[str, float]:
    pitch = drive.pitch
    return {
        "pitch.center_distance_mm": pitch.center_distance_mm,
        "pitch.length_driving_mm": pitch.length_mm(Gear.DRIVING),
        "pitch.length_driven_mm": pitch.length_mm(Gear.DRIVEN),
        "pitch.driving_convex": float(pitch.convex(Gear.DRIVING)),
        "pitch.driven_convex": float(pitch.convex(Gear.DRIVEN)),
        "pitch.min_radius_driving_mm": pitch.least_radius_mm(Gear.DRIVING),
        "pitch.min_radius_driven_mm": pitch.least_radius_mm(Gear.DRIVEN),
        "pitch.max_tangent_angle_deg": degrees(pitch.largest_tangent_angle_rad.value),
        "pitch.max_pressure_angle_deg": pitch.largest_pressure_angle_deg(radians(drive.gears.rack.pressure_angle_deg)),
    }
