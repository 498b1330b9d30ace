"""What a law makes a machine feel: another program's figures, energies and momenta by Fourier series, lever arms."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from math import cos, pi, radians
from types import SimpleNamespace

import numpy as np
import pytest

from at_once import at_once
from drives import drive, drive_of_text, loaded
from ncgear.dynamics.loaded_machine import RigidMachine
from ncgear.dynamics.mesh_force import MeshPlace
from ncgear.dynamics.rigid import load_peaks
from ncgear.errors import Unanswered
from ncgear.kinematics.motion import Machine
from ncgear.mechanisms.crank_slider import CrankSlider
from ncgear.mechanisms.forces import RodMasses
from ncgear.mechanisms.slider_load import SliderLoad
from ncgear.numerics.arrays import Array
from ncgear.optimum.loads import machine_loads
from ncgear.optimum.task import GearSize, Task, figures, tooth_loads
from ncgear.optimum.task import felt as felt_figures
from ncgear.pitch.shape import Mesh
from ncgear.project.law_task import task_of
from ncgear.project.moving import TrainInertia
from ncgear.ratio.laws.expression import driven_angle_expression_law
from ncgear.ratio.laws.uniform import uniform_law
from ncgear.ratio.transmission import Lobes, single
from published import BALER_LINKAGE, FIT, PRESS, RPM

SWAYING = 0.08
"""Of the law phi2 = phi1 - 0.08 sin 2 phi1."""

WHOLE = RodMasses(150.0, 30.0, 430.0, 2.8e6, 40.0, 120.0, 1.6e6, 800.0, 800.0, 0.0, (0.0, -9.80665))
"""The masses of designs/baler-dynamics.yaml."""


def felt(rigid: RigidMachine, fluctuation: float) -> SimpleNamespace:
    return SimpleNamespace(**felt_figures(rigid, fluctuation))


@cache
def swaying(offset_mm: float = 60.0) -> Machine:
    law = driven_angle_expression_law(f"phi - {SWAYING}*sin(2*phi)", Lobes())
    return Machine(law, CrankSlider(380.0, 960.0, offset_mm), PRESS, 60.0 * RPM)


@pytest.mark.judges("optimum")
@at_once(
    ("name", "mass_kg", "power_w", "braking_w"),
    [
        ("uniform-crank", 0.0, 26_068.0, 0.0),
        ("uniform-crank", 50.0, 24_820.0, 961.0),
        ("uniform-crank", 150.0, 22_342.0, 2_884.0),
        ("baler-drivetrain", 0.0, 9_375.0, 0.0),
        ("baler-drivetrain", 50.0, 9_342.0, 3_090.0),
        ("baler-drivetrain", 150.0, 9_319.0, 9_270.0),
    ],
)
def test_powers_that_another_program_has_found(name: str, mass_kg: float, power_w: float, braking_w: float) -> None:
    """Figures of a slider alone, with all digits that were printed; the second is the law of half the power."""
    law = uniform_law(Lobes()) if name == "uniform-crank" else drive(name).machine.transmission
    found = felt(RigidMachine(Machine(law, BALER_LINKAGE, PRESS, 60.0 * RPM), RodMasses(slider_kg=mass_kg)), 0.05)
    assert found.peak_power_w == pytest.approx(power_w, abs=0.51)
    assert found.braking_power_w == pytest.approx(braking_w, abs=0.51)


POINTS = 1 << 14
"""Even driving angles of a turn: the resistance's corner is seen to the square of their distance."""


def slopes(values: Array, order: int) -> Array:
    """Derivative by the driving angle of a smooth function around a turn, by its Fourier series."""
    waves = np.fft.fftfreq(POINTS, 1.0 / POINTS) * 1j
    kept = np.abs(waves) < 200.0
    return np.asarray(np.fft.ifft(np.fft.fft(values) * np.where(kept, waves, 0.0) ** order))


@cache
def sampled() -> tuple[Array, Array, Array]:
    """Driving torque in N mm and shaking force in N (x + i y), at even driving angles, from energies and momenta alone.

    Places are those of the vector loop, written anew; work is that of the resistance over the displacement.
    """
    machine = swaying()
    phi1 = np.arange(POINTS) * 2.0 * pi / POINTS
    turned = phi1 - SWAYING * np.sin(2.0 * phi1)
    tilt = np.arcsin(60.0 / (960.0 - 380.0))
    heading = np.exp(1j * (pi + tilt - turned))
    pin = 380.0 * heading
    sine = (60.0 - pin.imag) / 960.0
    rod = np.sqrt(1.0 - sine**2) + 1j * sine
    wrist = pin + 960.0 * rod
    speed = machine.speed_rad_s
    places = [(150.0, wrist), (30.0, pin + 430.0 * rod), (40.0, 120.0 * heading)]
    # The crank's own inertia about its axis holds the part of its mass at the centre already
    energy = 0.5e-3 * speed**2 * (150.0 * np.abs(slopes(wrist, 1)) ** 2 + 30.0 * np.abs(slopes(places[1][1], 1)) ** 2)
    energy = energy + 0.5e-3 * speed**2 * 2.8e6 * np.abs(slopes(rod, 1)) ** 2
    energy = energy + 0.5e-3 * speed**2 * (1.6e6 + 800.0) * (1.0 - 2.0 * SWAYING * np.cos(2.0 * phi1)) ** 2
    height = sum(mass * 9.80665 * place.imag for mass, place in places)
    slid = wrist.real - wrist.real[0]
    force = np.maximum(np.polyval(FIT[::-1], slid), 0.0)
    rising = slopes(wrist, 1).real
    torque = slopes(energy + height, 1).real + np.where(rising > 0.0, force, 0.0) * rising
    shaking = -1e-3 * speed**2 * sum(mass * slopes(place, 2) for mass, place in places)
    return phi1, torque, shaking


@cache
def found() -> SimpleNamespace:
    return felt(RigidMachine(swaying(), WHOLE), 0.05)


@pytest.mark.thorough
def test_power_and_torque_are_rates_of_energy() -> None:
    """A corner of the resistance between two samples is missed by their distance, 4e-4, times a jump of the slope."""
    _, torque, _ = sampled()
    speed = swaying().speed_rad_s
    assert found().peak_power_w == pytest.approx(torque.max() * speed / 1e3, rel=1e-6)
    assert found().braking_power_w == pytest.approx(-torque.min() * speed / 1e3, rel=1e-6)
    assert found().rms_torque_n_m == pytest.approx(np.sqrt(np.mean(torque**2)) / 1e3, rel=1e-6)
    # The rms counts braking too: it is well over the mean
    assert found().rms_torque_n_m > 1.5 * np.mean(torque) / 1e3


@pytest.mark.thorough
def test_the_flywheel_stores_what_an_even_motor_torque_leaves() -> None:
    """Its speed by energy: J (w_max^2 - w_min^2) / 2 is the swing, w_max - w_min = C w about the mean speed w."""
    _, torque, _ = sampled()
    stored = np.cumsum(np.mean(torque) - torque) * 2.0 * pi / POINTS
    inertia, speed = found().flywheel_kg_mm2 / 1e3, swaying().speed_rad_s
    fastest, slowest = speed * 1.025, speed * 0.975
    assert inertia * (fastest**2 - slowest**2) / 2.0 == pytest.approx(np.ptp(stored), rel=1e-4)
    # Half the fluctuation takes twice the flywheel
    assert felt(RigidMachine(swaying(), WHOLE), 0.025).flywheel_kg_mm2 == pytest.approx(
        2.0 * found().flywheel_kg_mm2, rel=1e-12
    )


def test_the_frame_feels_the_rate_of_momentum() -> None:
    _, _, shaking = sampled()
    assert found().shaking_force_n == pytest.approx(np.abs(shaking).max(), rel=1e-6)


def test_the_bearings_feel_the_columns_of_the_loads() -> None:
    """Weights and resistance are in it, and the teeth are not; the columns are judged in test_machine_loads.py."""
    machine, (phi1, _, _) = swaying(), sampled()
    driven = machine.transmission.driven_angle(phi1, 2)
    loads = machine_loads(machine.linkage, WHOLE, driven.value, machine.motion(phi1).load)
    q, rate = driven.derivative(1) ** 2, 2.0 * driven.derivative(2)
    force = np.linalg.norm(loads.bearing_n.at(q, rate, machine.speed_rad_s), axis=1)
    assert found().bearing_force_n == pytest.approx(force.max(), rel=1e-6)
    assert found().bearing_force_n > found().shaking_force_n


@pytest.mark.slow
def test_a_torque_that_cannot_be_followed_is_refused_with_its_place() -> None:
    """A lever whose block comes within a ten-thousandth of a millimetre of its axis turns there in no time."""
    lever = "{mass_kg: 7, center_mm: 110, inertia_kg_mm2: 1.2e5}"
    masses = f"{{slider_kg: 25, lever: {lever}, crank: {{mass_kg: 6, center_mm: 15, inertia_kg_mm2: 3e4}}}}"
    made = drive_of_text(
        "name: lever\nlinkage: {kind: slotted_lever, crank_mm: 100, pivot_mm: 100.0001, lever_mm: 300}\n"
        f"operation: {{speed_rpm: 60}}\nmotion: {{law: uniform_crank}}\nmasses: {masses}\n"
    )
    with pytest.raises(Unanswered, match=r"near phi1 = 6\.28.* rad \(359\.9 deg\) faster than") as refused:
        _ = made.check
    assert refused.value.key == "linkage"


def test_nothing_moves_and_nothing_resists() -> None:
    idle = felt(RigidMachine(replace(swaying(), load=SliderLoad()), RodMasses()), 0.05)
    assert set(vars(idle).values()) == {0.0}


@pytest.mark.slow
def test_the_force_between_teeth_is_torque_over_lever() -> None:
    """On circles the lever is the base circle's radius; the peak torque is that of the power."""
    even = Machine(uniform_law(Lobes()), BALER_LINKAGE, PRESS, 60.0 * RPM)
    force = tooth_loads(RigidMachine(even, WHOLE, MeshPlace(200.0, radians(20.0), Mesh.EXTERNAL, 0.0)))[0]
    own = felt(RigidMachine(even, WHOLE), 0.05)
    torque = max(own.peak_power_w, own.braking_power_w) * 1e3 / even.speed_rad_s
    assert force == pytest.approx(torque / (100.0 * cos(radians(20.0))), rel=1e-12)


@pytest.mark.slow
def test_the_force_between_teeth_of_a_design_is_that_of_its_simulation() -> None:
    """Of designs/baler-half-dynamics.yaml.  Its gears' own inertia follows from their teeth and is left out here."""
    made, task = drive("baler-half-dynamics"), task_of(loaded("baler-half-dynamics").design, TrainInertia())
    force = figures(task, made.law.train).tooth_force_n
    pitch = made.pitch
    place = MeshPlace(pitch.center_distance_mm, radians(20.0), Mesh.EXTERNAL, pi)
    peak = load_peaks(RigidMachine(made.machine, task.moving, place)).mesh
    assert peak is not None
    assert force == pytest.approx(peak.force_n.value, rel=1e-9)
    assert task.gears is not None
    assert task.gears.module_mm is not None
    own = load_peaks(RigidMachine(made.machine, made.masses, place)).mesh
    assert own is not None
    assert 0.0 < abs(own.force_n.value / peak.force_n.value - 1.0) < 1e-3
    larger = replace(task, gears=replace(task.gears, module_mm=2.0 * task.gears.module_mm))
    assert figures(larger, made.law.train).tooth_force_n == pytest.approx(peak.force_n.value / 2.0, rel=1e-9)


@pytest.mark.slow
def test_figures_have_loads_where_masses_are() -> None:
    """Without masses power is the check's, and no load is told; with them it is the motor's."""
    alone = Task(BALER_LINKAGE, PRESS, 60.0 * RPM)
    law = single(uniform_law(Lobes()))
    assert figures(alone, law).braking_power_w is None
    told = figures(replace(alone, masses=RodMasses(slider_kg=150.0)), law)
    assert told.peak_power_w == pytest.approx(22_342.0, abs=0.51)
    assert told.tooth_force_n is None
    sized = replace(alone, masses=RodMasses(), gears=GearSize(None, 4.0, 200.0, radians(20.0)))
    lever = 100.0 * cos(radians(20.0))
    exact = 26_068.0 * 1e3 / (60.0 * RPM) / lever
    assert figures(sized, law).tooth_force_n == pytest.approx(exact, abs=0.51 * 1e3 / (60.0 * RPM) / lever)


HEAD = """\
name: press
linkage: {crank_mm: 380, rod_mm: 960}
operation: {speed_rpm: 60}
motion: {law: uniform_crank}
resistance: {polynomial_n: [1000]}
"""


@at_once(
    ("more", "masses"),
    [
        ("", None),
        ("optimize: {limits: {peak_power_w: 9000}}\n", None),
        ("optimize: {goal: least_rms_torque}\n", RodMasses()),
        ("optimize: {limits: {bearing_force_n: 9000}}\n", RodMasses()),
        ("optimize: {goal: weighted, weights: {acceleration_mm_s2: 2e4, braking_power_w: 3e3}}\n", RodMasses()),
        (
            "masses:\n  slider_kg: 80\n  rod: {mass_kg: 0, center_mm: 0, inertia_kg_mm2: 0}\n"
            "  crank: {mass_kg: 3, center_mm: 0, inertia_kg_mm2: 7}\n",
            RodMasses(slider_kg=80.0, crank_kg=3.0, crank_inertia_kg_mm2=7.0),
        ),
    ],
)
def test_masses_are_known_where_they_are_given_or_asked_for(more: str, masses: RodMasses | None) -> None:
    assert task_of(drive_of_text(HEAD + more).design, TrainInertia()).masses == masses
