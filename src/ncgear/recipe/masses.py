"""The moving masses of a design."""

from __future__ import annotations

from math import cos, radians, sin

from ncgear.design.masses import Gravity
from ncgear.design.masses import Masses as Given
from ncgear.machine.masses import Masses


def masses_of(given: Given, driving_body_kg_mm2: float = 0.0, driven_body_kg_mm2: float = 0.0) -> Masses:
    """What a design says of its masses; where it is silent on a gear, the moment of inertia of the gear's body."""
    driving, driven = given.driving_gear_kg_mm2, given.driven_gear_kg_mm2
    return Masses(
        slider_kg=given.slider_kg,
        rod_kg=given.rod.mass_kg,
        rod_center_mm=given.rod.center_mm,
        rod_inertia_kg_mm2=given.rod.inertia_kg_mm2,
        crank_kg=given.crank.mass_kg,
        crank_center_mm=given.crank.center_mm,
        crank_inertia_kg_mm2=given.crank.inertia_kg_mm2,
        driven_inertia_kg_mm2=driven_body_kg_mm2 if driven is None else driven,
        driving_inertia_kg_mm2=driving_body_kg_mm2 if driving is None else driving,
        flywheel_inertia_kg_mm2=given.flywheel.inertia_kg_mm2,
        gravity_m_s2=_vector(given.gravity),
    )


def _vector(gravity: Gravity | None) -> tuple[float, float]:
    if gravity is None:
        return 0.0, 0.0
    direction = radians(gravity.direction_deg)
    return gravity.acceleration_m_s2 * cos(direction), gravity.acceleration_m_s2 * sin(direction)
