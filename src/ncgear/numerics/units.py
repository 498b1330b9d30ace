"""Units: factors between the units of files and of the code, the unit that a key ends in, angles in messages.

A key of a design file, a summary or a table ends in its unit: ``crank_mm``, ``peak_acceleration_mm_s2``.
"""

from __future__ import annotations

from math import degrees, pi

RAD_S_PER_RPM = pi / 30.0
"""One turn per minute in rad/s."""

N_PER_KG_MM_S2 = 1e-3
"""One kg mm/s^2 in N; likewise one kg mm^2/s^2 in N mm."""

N_M_PER_N_MM = 1e-3
"""One N mm in N m."""

KG_M2 = 1e-6
"""One kg mm2 in kg m2."""

CM3_PER_MM3 = 1e-3
"""One mm3 in cm3."""

STANDARD_GRAVITY_M_S2 = 9.80665
"""Acceleration of gravity where none is given: the standard value (3rd General Conference on Weights and Measures)."""

UNITS = {
    "c": "\u00b0C",
    "cm3": "cm3",
    "l_min": "l/min",
    "deg": "deg",
    "g": "g",
    "gpa": "GPa",
    "h": "h",
    "hz": "Hz",
    "j": "J",
    "kg": "kg",
    "kg_m2": "kg m2",
    "kg_m3": "kg/m3",
    "kg_mm": "kg mm",
    "kg_mm2": "kg mm2",
    "m_s": "m/s",
    "m_s2": "m/s2",
    "mm": "mm",
    "mm2": "mm2",
    "mm2_s": "mm2/s",
    "mm3": "mm3",
    "mm3_n_m": "mm3/(N m)",
    "mm_s": "mm/s",
    "mm_s2": "mm/s2",
    "mm_s3": "mm/s3",
    "mpa": "MPa",
    "n": "N",
    "n_m": "N m",
    "n_mm": "N mm",
    "n_per_mm": "N/mm",
    "n_per_um": "N/\u00b5m",
    "n_s_mm": "N s/mm",
    "percent": "%",
    "pi": "multiples of pi",
    "rad": "rad",
    "rad_s": "rad/s",
    "rad_s2": "rad/s2",
    "rad_s3": "rad/s3",
    "rpm": "r/min",
    "s": "s",
    "um": "\u00b5m",
    "um_m_k": "\u00b5m/(m K)",
    "w": "W",
}
"""Units by the last words of a key; the longest ending that is known here counts."""

LONGEST_ENDING = max(ending.count("_") + 1 for ending in UNITS)


def label_and_unit(key: str) -> tuple[str, str]:
    """``peak_power_w`` -> (``peak power``, ``W``); a key without a unit has an empty one."""
    words = key.split("_")
    for count in range(min(LONGEST_ENDING, len(words) - 1), 0, -1):
        unit = UNITS.get("_".join(words[-count:]))
        if unit is not None:
            return " ".join(words[:-count]), unit
    return " ".join(words), ""


RESOLVED = 1e-6
"""Share of a turn below which the place of an extreme is 0: near it the value changes with the square of the way, so of
sixteen digits of a value eight give its place, and a search loses a few of them."""


def placed_rad(angle_rad: float) -> float:
    """An angle of a place in rad: 0 for an angle that is not resolved beside a turn."""
    return 0.0 if abs(angle_rad) < RESOLVED * 2.0 * pi else angle_rad


def in_words(angle_rad: float) -> str:
    """``4.465 rad (255.8 deg)``; an angle that is not resolved beside a turn is zero."""
    placed = placed_rad(angle_rad)
    return f"{placed:.6g} rad ({degrees(placed):.4g} deg)"
