"""Forces between the teeth of two pairs in series and on the shaft between them, by Newton and Euler.

The judge knows the angles of the shafts alone.  It takes their speeds, their accelerations and the tangents of pitch
curves by differences, and lays the flanks' normal at the rack's angle to the tangent.
"""

from __future__ import annotations

from functools import cache
from math import cos, pi, radians, sin

import numpy as np
import pytest

from drives import drive_of_text
from ncgear.errors import WrongInput
from ncgear.figures.simulated import force_figures
from ncgear.numerics.arrays import Array
from ncgear.project.drive import Drive

TEXT = """\
name: two
linkage: {crank_mm: 100, rod_mm: 300}
operation: {speed_rpm: 240}
motion: {law: ratio_expression, ratio: "1 + 0.4*cos(phi) + 0.1*sin(2*phi)", scale_to_close: true}
gears: {teeth: 40, module_mm: 3, face_width_mm: 20, backlash_mm: 0.1, pairs: 2, driving_axis_deg: 130}
masses:
  {crank: {mass_kg: 1, center_mm: 20, inertia_kg_mm2: 2000}, rod: {mass_kg: 1.5, center_mm: 120, inertia_kg_mm2: 15000},
   slider_kg: 4, driving_gear_kg_mm2: 9000, shaft_between_kg_mm2: 30000, driven_gear_kg_mm2: 12000}
resistance: {polynomial_n: [100, 4]}
"""
STEP = 1e-4


@cache
def two() -> Drive:
    return drive_of_text(TEXT)


def cross(place: complex, force: complex) -> float:
    return float((place.conjugate() * force).imag)


def of_mesh(
    angle: Array, mate: Array, axis: complex, towards: complex, distance: float, sense: float
) -> tuple[complex, ...]:
    """The pitch point, the tangent as teeth move there and the normal away from the driving gear.

    Angles of both shafts are at places a step apart, shape (5,); the driving gear turns in ``sense``.
    """
    slope = np.gradient(mate, angle)
    radius = distance * slope / (1.0 + slope)
    # What faces the mate a little later is a little behind now.
    curve = axis + radius * towards * np.exp(-1j * sense * (angle - angle[2]))
    back = curve[3] - curve[1]
    tangent = -back / abs(back)
    return complex(curve[2]), complex(tangent), complex(tangent * -1j * sense)


@pytest.mark.slow
@pytest.mark.judges("dynamics")
@pytest.mark.parametrize("phi1", [0.2, 1.4, 2.9, 4.1, 5.3])
def test_forces_of_two_pairs_balance_by_newton_and_euler(phi1: float) -> None:
    drive = two()
    loads = drive.rigid.machine.at(np.array([phi1]))
    (first_mesh,), (between_bearing,) = loads.meshes_before, loads.between_bearings

    def vector(found: object) -> complex:
        return complex(found.x.value[0], found.y.value[0])  # type: ignore[attr-defined]

    last, first = vector(loads.mesh_force.force), vector(first_mesh.force)
    turned = phi1 + STEP * np.arange(-2, 3)
    between = drive.by_stage[0].pair.transmission.driven_angle(turned, 0).value
    crank = drive.by_stage[1].pair.transmission.driven_angle(between, 0).value
    assert crank == pytest.approx(drive.transmission.driven_angle(turned, 0).value, abs=1e-10)

    distances = [pair.pitch.center_distance_mm for pair in drive.by_stage]
    back = np.exp(1j * radians(130.0))
    middle, driving = distances[1] * back, (distances[1] + distances[0]) * back
    # The crank turns clockwise, the shaft between counter-clockwise, the driving shaft clockwise.
    here, along, away = of_mesh(between, crank, middle, -back, distances[1], 1.0)
    there, before, apart = of_mesh(turned, between, driving, -back, distances[0], -1.0)
    alpha = radians(20.0)
    for force, tangent, normal in ((last, along, away), (first, before, apart)):
        side = np.sign((force * tangent.conjugate()).real)
        wanted = side * cos(alpha) * tangent + sin(alpha) * normal
        assert force / abs(force) == pytest.approx(wanted, abs=1e-6)
    assert cross(here, last) == pytest.approx(-loads.driven_torque.value[0], rel=1e-7)
    speed = 240.0 * pi / 30.0
    spun = float(np.diff(between, 2)[1]) / STEP**2 * speed**2
    inertia_n_mm = 1e-3 * 30_000.0 * spun
    assert cross(there - middle, first) - cross(here - middle, last) == pytest.approx(inertia_n_mm, rel=1e-4, abs=2.0)
    assert abs(inertia_n_mm) > 500.0
    assert cross(there - driving, first) == pytest.approx(-loads.driving_torque.value[0], rel=1e-7)
    assert vector(between_bearing) == pytest.approx(last - first)


@pytest.mark.slow
def test_peaks_of_two_pairs_are_those_of_the_curves() -> None:
    drive = two()
    phi1 = np.linspace(0.0, 2.0 * pi, 3601)
    loads, found = drive.rigid.machine.at(phi1), force_figures(drive.linkage, drive.rigid.peaks)
    (first_mesh,), (between_bearing,) = loads.meshes_before, loads.between_bearings
    sizes = {
        "mesh": loads.mesh_force.size_n.value,
        "first_mesh": first_mesh.size_n.value,
        "driving_bearing": first_mesh.size_n.value,
        "shaft_between_bearing": np.hypot(between_bearing.x.value, between_bearing.y.value),
    }
    for name, size in sizes.items():
        assert found[f"peak_{name}_force_n"] == pytest.approx(size.max(), rel=1e-5)
        assert found[f"peak_{name}_force_n"] >= size.max() * (1.0 - 1e-12)
    with pytest.raises(WrongInput):
        _ = drive.meshing
