"""From keys to values: the moving masses of a design."""

from __future__ import annotations

from math import cos, radians, sin

from ncgear.design.keys.masses import DrivenShaftMasses, Gravity, ShaftMasses
from ncgear.mechanisms.masses import Masses
from ncgear.mechanisms.mechanism import Mechanism


def masses_of(
    given: ShaftMasses | DrivenShaftMasses,
    mechanism: Mechanism,
    driving_body_kg_mm2: float = 0.0,
    driven_body_kg_mm2: float = 0.0,
) -> Masses:
    """The masses that a design gives; a gear without a moment of inertia gets that of its body (kg mm2)."""
    driving, driven = given.driving_gear_kg_mm2, given.driven_gear_kg_mm2
    rods = {name: getattr(given, name) for name in mechanism.RODS}
    return mechanism.MASSES(
        **{f"{name}_kg": getattr(given, f"{name}_kg") for name in mechanism.POINTS},
        **{f"{name}_kg": rod.mass_kg for name, rod in rods.items()},
        **{f"{name}_center_mm": rod.center_mm for name, rod in rods.items()},
        **{f"{name}_inertia_kg_mm2": rod.inertia_kg_mm2 for name, rod in rods.items()},
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
