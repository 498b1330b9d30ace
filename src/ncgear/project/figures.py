"""The figures of a pair of gears: one list, by keys that end in their units.

Whoever tells a figure takes it from here by its key: summary, data sheet, answers, pages, notebooks and sweeps.  Its
name and its digits stand in ``figures/numbers.py``.
"""

from __future__ import annotations

from collections.abc import Callable
from math import degrees
from typing import Any

from ncgear.pitch.shape import Gear
from ncgear.project.drive import Drive

Figure = Callable[[Drive], Any]


def _of_curve(gear: Gear) -> dict[str, Figure]:
    name = gear.value
    return {
        f"length_{name}_mm": lambda pair: pair.pitch.length_mm(gear),
        f"{name}_convex": lambda pair: pair.pitch.convex(gear),
        f"min_radius_{name}_mm": lambda pair: pair.pitch.least_radius_mm(gear),
        f"min_concave_radius_{name}_mm": lambda pair: pair.pitch.least_concave_radius_mm(gear),
        f"concave_{name}_rad": lambda pair: [list(stretch) for stretch in pair.pitch.concave_ranges(gear)],
    }


PITCH: dict[str, Figure] = {
    "mesh": lambda pair: pair.pitch.mesh.value,
    "center_distance_mm": lambda pair: pair.pitch.center_distance_mm,
    **_of_curve(Gear.DRIVING),
    **_of_curve(Gear.DRIVEN),
    "max_tangent_angle_deg": lambda pair: degrees(pair.pitch.largest_tangent_angle_rad.value),
    "max_pressure_angle_deg": lambda pair: pair.largest_pressure_angle_deg,
    "max_pressure_angle_at_rad": lambda pair: pair.pitch.largest_tangent_angle_rad.at,
}
"""The figures of both pitch curves."""

CONTACT: dict[str, Figure] = {
    "contact_ratio_mean": lambda pair: pair.designed_contact.contact_ratio,
    "contact_ratio_min": lambda pair: pair.designed_contact.least_arc,
    "transmission_error_exact_rad": lambda pair: pair.contact_extremes.pushing_error_rad.width,
    "backlash_min_rad": lambda pair: pair.contact_extremes.backlash_rad.low.value,
    "sliding_velocity_max_mm_s": lambda pair: pair.contact_extremes.sliding_mm_s.value,
}
"""Figures of the contact of the exact teeth."""

OF_PAIR: dict[str, Figure] = {
    **PITCH,
    "teeth_driving": lambda pair: pair.pitch.size.driving_teeth,
    "teeth_driven": lambda pair: pair.pitch.size.driven_teeth,
    "module_mm": lambda pair: pair.pitch.size.module_mm,
    "face_width_mm": lambda pair: pair.gears.face_width_mm,
    "backlash_mm": lambda pair: pair.play.least_normal_mm.value,
    "backlash_max_mm": lambda pair: pair.play.largest_normal_mm.value,
    "play_rad": lambda pair: pair.play_range_rad[0],
    "play_greatest_rad": lambda pair: pair.play_range_rad[1],
    **CONTACT,
    "contact_ratio_under_load_mean": lambda pair: min(
        (side.contact_ratio for side in pair.pairs_under_load or ()), default=None
    ),
    "contact_ratio_under_load_min": lambda pair: min(
        (side.least_arc for side in pair.pairs_under_load or ()), default=None
    ),
    "overlap_ratio": lambda pair: pair.overlap_ratio,
    "peak_tooth_force_n": lambda pair: pair.strength.peak_pair_n,
}
"""All figures of a pair."""


def figures_of(pair: Drive, *keys: str) -> dict[str, Any]:
    """Some figures of a pair by their keys; raises as the drive does, KeyError for a key that is not in ``OF_PAIR``."""
    return {key: OF_PAIR[key](pair) for key in keys}
