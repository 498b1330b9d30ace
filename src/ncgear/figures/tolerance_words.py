"""Tolerances in words: what deviates, and by how much."""

from __future__ import annotations

from ncgear.design.keys.tolerances import AssemblyTolerances
from ncgear.project.usual_tolerances import Process
from ncgear.tolerances.drawn import MADE_C


def limit_words(given: AssemblyTolerances) -> list[str]:
    """What deviates, by its largest value."""
    driving, driven, warm = given.driving, given.driven, given.temperature
    words = [
        f"centre distance \u00b1{given.center_distance_mm:g} mm" if given.center_distance_mm else "",
        _both("bores off by {} mm", driving.eccentricity_mm, driven.eccentricity_mm),
        _both("tilted by {} deg", driving.tilt_deg, driven.tilt_deg),
        _both("keyways \u00b1{} deg", driving.index_deg, driven.index_deg),
        _both("single pitch \u00b1{} mm", driving.single_pitch_mm or 0.0, driven.single_pitch_mm or 0.0),
        _both("profile within {} mm", driving.profile_mm or 0.0, driven.profile_mm or 0.0),
        _both("wear up to {} mm", driving.wear_mm, driven.wear_mm),
    ]
    if warm is not None and (warm.largest_c > warm.least_c or warm.least_c != MADE_C):
        words.append(f"{warm.least_c:g} to {warm.largest_c:g} \u00b0C")
    grades = {one.grade or given.grade for one in (driving, driven)} - {None}
    if grades:
        words.insert(0, f"grade {' and '.join(str(one) for one in sorted(g for g in grades if g))} of ISO 1328-1")
    return [word for word in words if word] or ["none"]


def assumed_words(process: Process | None) -> str:
    """What stands before tolerances that the file does not give; nothing before those that it gives."""
    return "" if process is None else f"usual for {process} gears, "


def _both(text: str, driving: float, driven: float) -> str:
    if not (driving or driven):
        return ""
    return text.format(f"{driving:g}" if driving == driven else f"{driving:g} and {driven:g}")
