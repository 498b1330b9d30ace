"""Teeth with two pressure angles under load: each flank is rated by its own, in closed form on circular gears."""

from __future__ import annotations

from math import cos, pi, radians, sin, sqrt

import numpy as np
import pytest

from drives import drive_of_text
from loaded import FRICTION, LINEAR
from ncgear.contact.placement import BACK, PUSHING
from ncgear.dynamics.gaps import gaps_of
from ncgear.dynamics.law_table import law_table
from ncgear.dynamics.meshing import Meshing
from ncgear.pitch.shape import Gear
from ncgear.strength.estimate import estimate_of
from ncgear.strength.hertz import contact_modulus_mpa, hertz_pressure_mpa
from ncgear.strength.loading import AskedTorque, loading_of
from ncgear.strength.sections import FaceSections
from ncgear.strength.stiffness import LinearTeeth
from tooth_places import STEEL

TEETH, MODULE, WIDTH, TORQUE = 30, 2.0, 12.0, 2e4
TEXT = f"""\
name: shaft
operation: {{speed_rpm: 20}}
motion: {{law: uniform_crank}}
gears:
  teeth: {TEETH}
  module_mm: {MODULE}
  face_width_mm: {WIDTH}
  rack: {{pressure_angle_deg: 25, idle_pressure_angle_deg: 18, root_radius: 0.25}}
"""


@pytest.mark.slow
@pytest.mark.judges("strength")
@pytest.mark.parametrize(("side", "angle_deg"), [(PUSHING, 25.0), (BACK, 18.0)])
def test_pressure_at_the_pitch_point_is_by_the_flanks_own_angle(side: int, angle_deg: float) -> None:
    """p^2 = F / b (2 / (r sin a)) E* / pi with F = T / (r cos a); by the other flank's angle it would be off by far."""
    drive = drive_of_text(TEXT)
    teeth, pitch = drive.teeth, drive.pitch
    first, second = (estimate_of(teeth.of(gear), STEEL) for gear in Gear)
    stiffness = LinearTeeth(teeth, (first, second), (STEEL, STEEL), WIDTH, TORQUE / 30.0 / WIDTH)
    meshing = Meshing(law_table(pitch.transmission), gaps_of(teeth, pitch, stiffness), LINEAR, FRICTION)
    sign = 1.0 if side == PUSHING else -1.0
    asked = AskedTorque.of(pitch, lambda phi1: np.full_like(phi1, sign * TORQUE))
    found = loading_of(meshing, FaceSections.straight(teeth), pitch, asked, np.ones_like).contacts
    radius = MODULE * TEETH / 2.0
    assert set(found.side) == {side}
    # Where a pair touches at the pitch point its flanks roll without sliding.
    rolls = np.flatnonzero(found.sliding_mm_s < 0.02 * radius * 0.1)
    assert rolls.size > 4
    pressure = hertz_pressure_mpa(found.force_n[rolls] / WIDTH, found.relative_curvature[rolls], (STEEL, STEEL))

    def by_hand(angle: float, share: np.ndarray) -> np.ndarray:
        force = share * TORQUE / (radius * cos(angle))
        return np.sqrt(force / WIDTH * 2.0 / (radius * sin(angle)) * contact_modulus_mpa((STEEL, STEEL)) / pi)

    total = np.bincount(found.position, found.force_n)[found.position[rolls]]
    share = found.force_n[rolls] / total
    own, other = radians(angle_deg), radians(43.0 - angle_deg)
    assert pressure == pytest.approx(by_hand(own, share), rel=5e-3)
    assert total == pytest.approx(TORQUE / (radius * cos(own)), rel=1e-3)
    assert abs(sqrt(sin(2.0 * other) / sin(2.0 * own)) - 1.0) > 0.04
