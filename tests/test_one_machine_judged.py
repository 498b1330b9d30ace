"""The loaded machine against Newton's and Euler's equations of all bodies, its gears weighed as the written solids.

Gears are read back from STL files, and their moments of inertia are integrals over these meshes.  Places, accelerations
and the directions of forces are the oracle's own (``oracles.newton_euler``).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cache
from math import pi, radians
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh
from mpmath import mp
from scipy.interpolate import PchipInterpolator

from commands import new_folder
from drives import drive_of_text
from ncgear.design.template import MachineName, machine_template
from ncgear.files.build import build
from ncgear.pitch.shape import Gear
from ncgear.project.drive import Drive
from oracles import newton_euler
from oracles.harmonic_angle import HarmonicAngle, driven_angle

STEEL_KG_MM3 = 7850e-9
"""Of 42CrMo4, and of gears without a material."""

IRON_KG_MM3 = 7200e-9
"""Of nodular cast iron."""

OF_SOLIDS = 1e-6
"""Share of the largest force: the meshes have the chords of the plans, at 32 bits: 6e-8 of a place, 2.4e-7 of J."""

RING = """\
name: ring
linkage: {crank_mm: 45, rod_mm: 150, offset_mm: 10}
operation: {speed_rpm: 700}
motion: {law: ratio_expression, driven_angle: "phi/2 - 0.06*sin(phi)"}
gears:
  mesh: internal
  lobes: {driving: 1, driven: 2}
  teeth: 48
  module_mm: 2
  face_width_mm: 14
  driving_axis_deg: 150
  driving: {bore_mm: 16}
  driven: {rim_mm: 8}
resistance: {polynomial_n: [300, 2]}
masses:
  slider_kg: 1.5
  rod: {mass_kg: 0.5, center_mm: 60, inertia_kg_mm2: 900}
  crank: {mass_kg: 0.6, center_mm: 12, inertia_kg_mm2: 300}
  density_kg_m3: 5000
  gravity: {acceleration_m_s2: 9.80665}
drivetrain: {guide_friction: 0.2}
"""
"""A ring of cast parts in heavy use: gravity, an offset, friction in the guide."""

PUMP = machine_template("pump", MachineName.PUMP).replace("speed_rpm: 120", "speed_rpm: 600")
RUBBING = PUMP + "\ndrivetrain: {guide_friction: 0.4}\n"

YOKE = """\
name: yoke
linkage: {kind: scotch_yoke, crank_mm: 40}
operation: {speed_rpm: 400}
motion: {law: ratio_expression, driven_angle: "phi - 0.1*sin(2*phi)"}
gears:
  teeth: 48
  module_mm: 2
  face_width_mm: 20
  driving_axis_deg: 120
  material: GJS-600-3
  driving: {bore_mm: 16}
  driven: {bore_mm: 16}
resistance: {polynomial_n: [500], returning: {polynomial_n: [420]}, friction_n: 20}
masses:
  slider_kg: 1.5
  crank: {mass_kg: 0.8, center_mm: 12, inertia_kg_mm2: 500}
  gravity: {acceleration_m_s2: 9.80665}
"""

TWO_PAIRS = """\
name: two
linkage: {crank_mm: 38, rod_mm: 96}
operation: {speed_rpm: 1000}
motion:
  law: harmonic_ratio
  cosine: [-0.35, 0.08]
  sine: [0.12]
  second_stage: {cosine: [-0.2], sine: [0.05]}
gears: {teeth: 24, module_mm: 2.5, face_width_mm: 25, driving: {bore_mm: 8}, driven: {bore_mm: 10}}
resistance: {polynomial_n: [400]}
masses:
  slider_kg: 2
  rod: {mass_kg: 0.4, center_mm: 40, inertia_kg_mm2: 700}
  crank: {mass_kg: 0.3, center_mm: 10, inertia_kg_mm2: 150}
"""


DELIVERY = PchipInterpolator([0.0, 2.0, 60.0], [0.0, 400.0, 400.0])
SUCTION = PchipInterpolator([0.0, 58.0, 60.0], [60.0, 60.0, 0.0])


def delivery(x: Any) -> Any:
    """Of the pump: the table and the friction of its seals."""
    return float(DELIVERY(float(x))) + 15.0


def suction(x: Any) -> Any:
    return float(SUCTION(float(x))) + 15.0


Force = Callable[[Any], Any]

WHOLE, SECOND = ([-0.35, 0.08], [0.12]), ([-0.2], [0.05])
"""Harmonics of the two pairs together, and of the second one."""

PUMP_LAW = driven_angle([], [0.35])


@dataclass(frozen=True, eq=False)
class Judged:
    """A drive, and the same machine for the oracle with the inertia of the gears that were written."""

    drive: Drive
    scene: newton_euler.Scene
    inertia: dict[str, float]

    def without_the_driven_gear(self) -> newton_euler.Scene:
        return replace(self.scene, shaft_inertia=self.scene.shaft_inertia - self.inertia["driven"])


@cache
def written(text: str) -> tuple[Drive, Path]:
    """The drive of a text, and the folder of its build."""
    made, folder = drive_of_text(text), new_folder() / "out"
    build(made, folder, lambda step: None)
    return made, folder


def weighed(folder: Path, kg_mm3: float) -> dict[str, float]:
    """Moments of inertia in kg mm2 of both gears in a folder about their axes."""
    found = {}
    for gear in Gear:
        mesh = trimesh.load_mesh(folder / f"{gear.value}.stl")
        assert mesh.is_watertight
        x, y, _ = mesh.center_mass
        found[gear.value] = float(kg_mm3 * (mesh.moment_inertia[2, 2] + mesh.volume * (x**2 + y**2)))
    return found


def scene_of(made: Drive, law: newton_euler.Angle, driven_kg_mm2: float, **loads: Force) -> newton_euler.Scene:
    """What a person wrote, with the distance of the gears and what is turned by them."""
    design, linkage, given = made.design, made.design.linkage, made.design.masses
    down = 0.0 if given.gravity is None else given.gravity.acceleration_m_s2
    rod = getattr(given, "rod", None)
    return newton_euler.Scene(
        driven_angle=law,
        speed_rad_s=design.operation.speed_rpm * pi / 30.0,
        crank=linkage.crank_mm,
        rod=rod and linkage.rod_mm,
        offset=rod and linkage.offset_mm,
        slider_kg=given.slider_kg,
        rod_kg=rod and rod.mass_kg,
        rod_center=rod and rod.center_mm,
        rod_inertia=rod and rod.inertia_kg_mm2,
        crank_kg=given.crank.mass_kg,
        crank_center=given.crank.center_mm,
        shaft_inertia=given.crank.inertia_kg_mm2 + driven_kg_mm2,
        gravity=(0.0, -down),
        distance=made.by_stage[-1].pitch.center_distance_mm,
        rack_angle=radians(20.0),
        internal=design.gears.mesh == "internal",
        driving_axis=radians(design.gears.driving_axis_deg),
        guide_friction=design.drivetrain.guide_friction if design.drivetrain else 0.0,
        **loads,
    )


RING_LAW: newton_euler.Angle = lambda phi: phi / 2 - mp.mpf("0.06") * mp.sin(phi)  # noqa: E731
YOKE_LAW: newton_euler.Angle = lambda phi: phi - mp.mpf("0.1") * mp.sin(2 * phi)  # noqa: E731

MACHINES: dict[str, tuple[str, newton_euler.Angle, float, dict[str, Force]]] = {
    "ring": (RING, RING_LAW, 5000e-9, {"resistance": lambda x: 300 + 2 * x}),
    "pump": (PUMP, PUMP_LAW, STEEL_KG_MM3, {"resistance": delivery, "returning": suction}),
    "rubbing": (RUBBING, PUMP_LAW, STEEL_KG_MM3, {"resistance": delivery, "returning": suction}),
    "yoke": (YOKE, YOKE_LAW, IRON_KG_MM3, {"resistance": lambda x: 520, "returning": lambda x: 440}),
}
"""Text, law, density of the gears in kg/mm3, and forces against the slider."""


@cache
def machine(name: str) -> Judged:
    text, law, kg_mm3, loads = MACHINES[name]
    made, folder = written(text)
    inertia = weighed(folder, kg_mm3)
    return Judged(made, scene_of(made, law, inertia["driven"], **loads), inertia)


def solved(scene: newton_euler.Scene, phi1: float) -> dict[str, float]:
    """The forces by the oracle, on the flanks that press."""
    with mp.workdps(15):
        turned = float(scene.driven_angle(mp.mpf(phi1)))
    working = turned % (2.0 * pi) < extended_rad(scene)
    system = newton_euler.solved if scene.rod else newton_euler.solved_yoke
    pushed = system(scene, phi1, working=working, pushing=True)
    return pushed if pushed["mesh"] >= 0.0 else system(scene, phi1, working=working, pushing=False)


def extended_rad(scene: newton_euler.Scene) -> float:
    """Crank angle from the retracted to the extended dead centre."""
    if not scene.rod:
        return pi
    tilts = [np.arcsin(scene.offset / (scene.rod + sign * scene.crank)) for sign in (-1, 1)]
    return float(pi + tilts[0] - tilts[1])


def apart(scene: newton_euler.Scene, one: Drive, places: list[float]) -> dict[str, float]:
    """Differences of forces and torque that are over OF_SOLIDS, as shares of the largest of each."""
    loads = one.rigid.machine.at(np.array(places))
    told = {
        "torque": loads.driving_torque.value,
        "crank_x": loads.crank_bearing.x.value,
        "crank_y": loads.crank_bearing.y.value,
        "mesh": loads.mesh_force.size_n.value,
    }
    exact = [solved(scene, place) for place in places]
    found = {}
    for name, values in told.items():
        right = np.array([forces[name] for forces in exact])
        found[name] = float(np.max(np.abs(values - right)) / np.max(np.abs(right)))
    return {name: share for name, share in found.items() if share > OF_SOLIDS}


PLACES = [0.4, 1.5, 3.3, 5.5]


@pytest.mark.tiers(slow=["pump"], rest="long")
@pytest.mark.judges("dynamics")
@pytest.mark.parametrize("name", MACHINES)
def test_all_forces_are_those_of_the_bodies_that_are_written(name: str) -> None:
    one = machine(name)
    assert one.drive.gear_inertia.driven_kg_mm2 == pytest.approx(one.inertia["driven"], rel=OF_SOLIDS)
    assert apart(one.scene, one.drive, PLACES) == {}
    # Negative control: without the driven gear none of them is right
    assert {"torque", "crank_x", "crank_y", "mesh"} == set(apart(one.without_the_driven_gear(), one.drive, PLACES[:3]))


@pytest.mark.tiers(slow=["pump"], rest="long")
@pytest.mark.parametrize("name", MACHINES)
def test_the_peak_power_of_a_check_is_that_of_the_bodies_that_are_written(name: str) -> None:
    """At its own place, and nowhere beside it or elsewhere is there more."""
    one = machine(name)
    peak, speed = one.drive.check.peak_power_w, 1e-3 * one.scene.speed_rad_s
    here = speed * solved(one.scene, peak.at)["torque"]
    assert peak.value == pytest.approx(here, rel=OF_SOLIDS)
    assert peak.value == one.drive.rigid.driving.peak_power_w.value
    beside = [peak.at + step for step in (-0.01, 0.01)]
    assert max(speed * solved(one.scene, at)["torque"] for at in (*beside, *PLACES[::2])) <= here * (1.0 + OF_SOLIDS)
    without = speed * solved(one.without_the_driven_gear(), peak.at)["torque"]
    assert abs(without / peak.value - 1.0) > 1e-3


@cache
def two_pairs() -> tuple[Drive, newton_euler.Scene, dict[str, float]]:
    """Two pairs in series: the drive, the crank's side, and the inertia of all four gears that were written."""
    made, folder = written(TWO_PAIRS)
    inertia = {
        f"{stage} {gear}": kg_mm2
        for stage in (1, 2)
        for gear, kg_mm2 in weighed(folder / f"stage-{stage}", STEEL_KG_MM3).items()
    }
    scene = scene_of(made, driven_angle(*WHOLE), inertia["2 driven"], resistance=lambda x: 400)
    return made, scene, inertia


def driving_torque_n_mm(scene: newton_euler.Scene, made: Drive, between_kg_mm2: float, phi1: float) -> float:
    """The driving torque of two pairs: teeth forces across both lines of centres turn crank and shaft between."""
    second = HarmonicAngle(*SECOND)

    def between(angle: Any) -> Any:
        return second.driving(scene.driven_angle(angle))

    with mp.workdps(newton_euler.DIGITS):
        angle = mp.mpf(phi1)
        whole, first = (float(mp.diff(law, angle)) for law in (scene.driven_angle, between))
        turned = float(mp.diff(between, angle, 2)) * scene.speed_rad_s**2 / 1000.0
    of_crank = solved(scene, phi1)["torque"] / whole
    ratios = first, whole / first
    distances = [pair.pitch.center_distance_mm for pair in made.by_stage]
    driven = [distance / (1.0 + ratio) for distance, ratio in zip(distances, ratios, strict=True)]
    driving = [distance - radius for distance, radius in zip(distances, driven, strict=True)]
    # Teeth of the first pair, of the second one, driving torque
    rows = [[0.0, driven[1], 0.0], [driven[0], -driving[1], 0.0], [-driving[0], 0.0, 1.0]]
    return float(np.linalg.solve(rows, [of_crank, between_kg_mm2 * turned, 0.0])[2])


@pytest.mark.long
@pytest.mark.slow
@pytest.mark.judges("dynamics")
def test_the_shaft_between_turns_with_the_gears_that_are_written() -> None:
    made, scene, inertia = two_pairs()
    weight = inertia["1 driven"] + inertia["2 driving"]
    assert sum(made.masses.between_inertia_kg_mm2) == pytest.approx(weight, rel=OF_SOLIDS)
    told = made.driving.machine.at(np.array(PLACES)).driving_torque.value
    right = [driving_torque_n_mm(scene, made, weight, place) for place in PLACES]
    np.testing.assert_allclose(told, right, atol=OF_SOLIDS * np.abs(right).max())
    peak = made.check.peak_power_w
    here = driving_torque_n_mm(scene, made, weight, peak.at) * scene.speed_rad_s / 1000.0
    assert peak.value == pytest.approx(here, rel=OF_SOLIDS)
    # Negative control: a shaft between without gears asks for another torque
    without = driving_torque_n_mm(scene, made, 0.0, PLACES[1])
    assert abs(told[1] - without) > 1e-3 * np.abs(right).max()
