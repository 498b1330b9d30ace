"""The force between the teeth against the contact of the exact flanks, whose common normals it must follow."""

from __future__ import annotations

from dataclasses import replace
from math import pi, radians

import numpy as np
import pytest

from engaged import designed, made
from ncgear.contact.placement import Placement
from ncgear.dynamics.mesh_force import MeshForce, MeshPlace, mesh_force
from ncgear.numerics.arrays import Array
from ncgear.numerics.jet import Jet

TORQUE = 1000.0
PAIRS = [("sine", 24), ("baler", 40), ("ring", 24)]


def force_at(name: str, teeth: int, phi1: Array, torque_n_mm: float) -> MeshForce:
    """The force for an even torque, the driving axis straight behind the driven one."""
    pitch = made(name, teeth)[0]
    place = MeshPlace(pitch.center_distance_mm, radians(20.0), pitch.mesh, pi)
    slope = pitch.transmission.driven_angle(phi1, 2).differentiated()
    return mesh_force(place, slope, Jet(np.full((1, phi1.size), torque_n_mm)))


def placement_of(name: str, teeth: int) -> Placement:
    return designed(name, teeth).placement


@pytest.mark.tiers(quick=["sine-24-*"], rest="slow")
@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize(("name", "teeth"), PAIRS)
def test_size_is_the_torque_over_the_arm_of_the_flanks_normal(name: str, teeth: int, sign: float) -> None:
    contact = designed(name, teeth)
    first = (contact.pushing if sign > 0.0 else contact.back).first
    found = force_at(name, teeth, contact.placement.phi1_rad, sign * TORQUE).size_n.value
    flanks = first.flanks
    assert flanks.mean() > 0.9
    assert found[flanks] == pytest.approx(TORQUE / first.lever_mm[flanks], rel=1e-12)


@pytest.mark.slow
@pytest.mark.parametrize(("name", "teeth"), PAIRS)
def test_the_other_flanks_have_other_arms(name: str, teeth: int) -> None:
    """Negative control: with the sense of the torque mistaken, sizes are off by several per cent somewhere."""
    contact = designed(name, teeth)
    found = force_at(name, teeth, contact.placement.phi1_rad, -TORQUE).size_n.value
    assert np.max(np.abs(found * contact.pushing.first.lever_mm / TORQUE - 1.0)) > 0.05


@pytest.mark.tiers(slow=["ring*"], rest="quick")
@pytest.mark.parametrize("torque", [TORQUE, -TORQUE])
@pytest.mark.parametrize("name", ["sine", "ring"])
def test_force_turns_the_driven_gear_and_drives_it_off(name: str, torque: float) -> None:
    """Clockwise moment about the crank axis; away from the driving axis, of a ring too, whose teeth point inwards."""
    pitch = made(name, 24)[0]
    phi1 = np.linspace(0.0, 6.0, 30)
    found = force_at(name, 24, phi1, torque)
    point = pitch.pitch_point_mm(phi1) - pitch.center_distance_mm
    assert -point * found.force.y.value == pytest.approx(torque, rel=1e-12)
    across = np.abs(found.force.y.value)
    apart = pitch.mesh.sense * -found.force.x.value
    assert apart == pytest.approx(across * np.tan(found.pressure_angle_rad.value), rel=1e-12)
    assert np.hypot(found.force.x.value, found.force.y.value) == pytest.approx(found.size_n.value, rel=1e-13)


def test_force_turns_with_the_driving_axis() -> None:
    pitch, phi1 = made("sine", 24)[0], np.linspace(0.0, 6.0, 30)
    place = MeshPlace(pitch.center_distance_mm, radians(20.0), pitch.mesh, pi)
    slope, torque = pitch.transmission.driven_angle(phi1, 2).differentiated(), Jet(np.full((1, 30), TORQUE))
    behind, above = mesh_force(place, slope, torque), mesh_force(replace(place, driving_axis_rad=pi / 2), slope, torque)
    assert above.force.x.value == pytest.approx(behind.force.y.value, rel=1e-12)
    assert above.force.y.value == pytest.approx(-behind.force.x.value, rel=1e-12)
