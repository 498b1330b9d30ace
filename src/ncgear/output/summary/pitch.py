"""The pitch curves in a summary."""

from __future__ import annotations

from math import degrees
from typing import TYPE_CHECKING, Any

from ncgear.drive import Drive
from ncgear.numerics.extrema import Extremum

if TYPE_CHECKING:
    from ncgear.pitch.pair import CurvatureJump, PitchPair

LEAST_JUMP = 1e-6
"""Of curvature times the centre distance: joints that go on smoothly differ by rounding, 1e-8 at the most; those that
jump, by 1e-3 and more."""


def pitch_summary(drive: Drive) -> dict[str, Any]:
    """Sizes, convexity, pressure angle, and where curvature jumps."""
    from ncgear.pitch.shape import Gear

    pitch = drive.pitch
    result: dict[str, Any] = {"mesh": pitch.mesh.value, "center_distance_mm": pitch.center_distance_mm}
    for gear in Gear:
        name = gear.value
        result[f"length_{name}_mm"] = pitch.length_mm(gear)
        result[f"{name}_convex"] = pitch.convex(gear)
        result[f"min_radius_{name}_mm"] = pitch.least_radius_mm(gear)
        result[f"min_concave_radius_{name}_mm"] = pitch.least_concave_radius_mm(gear)
        result[f"concave_{name}_rad"] = [list(stretch) for stretch in pitch.concave_ranges(gear)]
    tangent: Extremum = pitch.largest_tangent_angle_rad
    result["max_tangent_angle_deg"] = degrees(tangent.value)
    result["max_pressure_angle_deg"] = pitch.largest_pressure_angle_deg(drive.rack.pressure_angle_rad)
    result["max_pressure_angle_at_rad"] = tangent.at
    result["curvature_jumps"] = _jumps(pitch)
    return result


def _jumps(pitch: PitchPair) -> list[dict[str, float]]:
    return [
        {
            "phi1_rad": jump.phi1_rad,
            "driving_before_1_mm": jump.driving_before,
            "driving_after_1_mm": jump.driving_after,
            "driven_before_1_mm": jump.driven_before,
            "driven_after_1_mm": jump.driven_after,
        }
        for jump in pitch.curvature_jumps()
        if _height(jump) * pitch.center_distance_mm > LEAST_JUMP
    ]


def _height(jump: CurvatureJump) -> float:
    """The larger of both gears' jumps, in 1/mm."""
    return max(abs(jump.driving_after - jump.driving_before), abs(jump.driven_after - jump.driven_before))
