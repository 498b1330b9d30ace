"""Permissible unbalance by the grades of ISO 21940-11 (values from secondary sources).

A grade G is the speed in mm/s at which a rigid rotor's centre of mass may go round: e = G / w, U = e m.
"""

from __future__ import annotations

from bisect import bisect_left
from math import inf

GRADES_MM_S = (0.4, 1.0, 2.5, 6.3, 16.0, 40.0, 100.0, 250.0, 630.0, 1600.0, 4000.0)
"""G 6.3 for machines and gears in general, G 16 for agricultural machinery."""


def permissible_unbalance_kg_mm(grade_mm_s: float, mass_kg: float, speed_rad_s: float) -> float:
    """U of a rotor at its highest speed, for both of its planes together; all arguments over zero."""
    return grade_mm_s / speed_rad_s * mass_kg


def grade_reached(unbalance_kg_mm: float, mass_kg: float, speed_rad_s: float) -> float:
    """The finest grade that an unbalance meets; infinity where it meets none."""
    reached = bisect_left(GRADES_MM_S, unbalance_kg_mm / mass_kg * speed_rad_s)
    return GRADES_MM_S[reached] if reached < len(GRADES_MM_S) else inf
