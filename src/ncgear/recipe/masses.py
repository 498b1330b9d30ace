"""The moving masses of a design."""

from __future__ import annotations

from math import cos, radians, sin

from ncgear.design.masses import Gravity
from ncgear.design.masses import Masses as Given
from ncgear.machine.masses import Masses


def masses_of(given: Given, driving_gear_kg_mm2: float, driven_gear_kg_mm2: float) -> Masses:
    """What a design says of its masses, with the moments of inertia of its gears."""
    return Masses(
        slider_kg=given.slider_kg,
        rod_kg=given.rod.mass_kg,
        rod_center_mm=given.rod.center_mm,
        rod_inertia_kg_mm2=given.rod.inertia_kg_mm2,
        crank_kg=given.crank.mass_kg,
        crank_center_mm=given.crank.center_mm,
        crank_inertia_kg_mm2=given.crank.inertia_kg_mm2,
        driven_inertia_kg_mm2=driven_gear_kg_mm2,
        driving_inertia_kg_mm2=driving_gear_kg_mm2,
        flywheel_inertia_kg_mm2=given.flywheel.inertia_kg_mm2,
        gravity_m_s2=_vector(given.gravity),
    )


def _vector(gravity: Gravity | None) -> tuple[float, float]:
    if gravity is None:
        return 0.0, 0.0
    direction = radians(gravity.direction_deg)
    return gravity.acceleration_m_s2 * cos(direction), gravity.acceleration_m_s2 * sin(direction)
