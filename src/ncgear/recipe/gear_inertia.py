"""Moments of inertia of the gears of a design, where the file leaves them out."""

from __future__ import annotations

from ncgear.design.gears import Gears
from ncgear.numerics.arrays import Array
from ncgear.recipe.gears import bore_of, rim_mm_of
from ncgear.solids.inertia import gear_polar_mm4, plate_kg_mm2, ring_polar_mm4
from ncgear.solids.ring import outer_radius_mm


def body_inertias_kg_mm2(
    gears: Gears, driving_mm: Array, driven_mm: Array, module_mm: float, chord_tolerance_mm: float, density_kg_m3: float
) -> tuple[float, float]:
    """Moments of inertia of the driving and the driven gear's body from their outlines, shape (n, 2) each.

    Index holes are not counted, and the section at z = 0 stands for all of helical teeth.
    """
    polar = gear_polar_mm4(driving_mm, bore_of(gears.driving), chord_tolerance_mm)
    if gears.mesh == "internal":
        other = ring_polar_mm4(driven_mm, outer_radius_mm(driven_mm, rim_mm_of(gears, module_mm)))
    else:
        other = gear_polar_mm4(driven_mm, bore_of(gears.driven), chord_tolerance_mm)
    driving, driven = (plate_kg_mm2(moment, gears.face_width_mm, density_kg_m3) for moment in (polar, other))
    return driving, driven
