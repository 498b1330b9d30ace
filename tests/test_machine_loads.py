"""Loads over the crank for any motion: against all bodies in one linear system, momentum, Lagrange, and energy."""

from __future__ import annotations

from dataclasses import replace
from math import pi

import numpy as np
import pytest

from at_once import at_once
from mechanisms import AMPLITUDE, OFFSET, oracle, sampled, uneven
from ncgear.kinematics.motion import Machine
from ncgear.mechanisms.crank_slider import CrankSlider
from ncgear.mechanisms.forces import Masses, RodMasses
from ncgear.mechanisms.scotch_yoke import ScotchYoke
from ncgear.numerics.arrays import Array
from ncgear.numerics.jet import Jet
from ncgear.optimum.loads import MachineLoads, machine_loads
from oracles import newton_euler
from published import BALER_LINKAGE, PRESS, RPM
from test_rigid import HEAVY, felt, scene

ANY = np.linspace(0.2, 2.0 * pi + 0.2, 41)
"""Crank angles over a turn, dead centres not among them."""


def square_of(angle: Array) -> tuple[Array, Array]:
    """Some q > 0 of period 2 pi, and its derivative."""
    return 1.3 + 0.5 * np.sin(angle) + 0.3 * np.cos(2.0 * angle), 0.5 * np.cos(angle) - 0.6 * np.sin(2.0 * angle)


def of_law(machine: Machine, phi1: Array) -> tuple[Array, Array, Array]:
    """Crank angle, q and dq/dphi2 = 2 d2phi2/dphi1^2 of a law."""
    driven = machine.transmission.driven_angle(phi1, 2)
    return driven.value, driven.derivative(1) ** 2, 2.0 * driven.derivative(2)


def loads_of(machine: Machine, masses: Masses, angle: Array) -> MachineLoads:
    slid = machine.motion(machine.driving_angles(np.mod(angle, 2.0 * pi)))
    return machine_loads(machine.linkage, masses, angle, slid.load)


@pytest.mark.judges("optimum")
@at_once("phi1", [0.4, 2.2, 3.5, 5.9])
def test_all_bodies_in_one_linear_system(phi1: float) -> None:
    """At 200 r/min, offset, with weights: every column matters.  The oracle's law is sin(2 phi) of 40 digits."""
    rigid = felt(200.0, 60.0)
    driven, q, rate = of_law(rigid.machine, np.array([phi1]))
    working = bool(rigid.machine.working(driven)[0])
    pushing = bool(rigid.at(np.array([phi1])).driven_torque.value[0] > 0.0)
    exact = newton_euler.solved(scene(rigid), phi1, working=working, pushing=pushing)
    found = loads_of(rigid.machine, HEAVY, driven)
    speed = rigid.machine.speed_rad_s
    scale = max(map(abs, exact.values()))
    assert found.torque_n_mm.at(q, rate, speed)[0] * np.sqrt(q[0]) == pytest.approx(exact["torque"], rel=1e-11)
    expected = {
        "bearing": [exact[f"crank_{axis}"] + exact[f"axis_{axis}"] for axis in "xy"],
        "wrist": [exact["wrist_x"], exact["wrist_y"]],
        "pin": [exact["pin_x"], exact["pin_y"]],
    }
    assert found.guide_n.at(q, rate, speed)[0] == pytest.approx(exact["guide"], rel=1e-11)
    for name, force in {"bearing": found.bearing_n, **found.joints_n}.items():
        assert force.at(q, rate, speed)[0] == pytest.approx(expected[name], rel=1e-11, abs=1e-13 * scale), name


def test_the_shaking_force_is_the_rate_of_momentum() -> None:
    """Momentum of every single mass, differentiated in 40 digits; weights and resistance have no part in it."""
    mechanism = replace(uneven(OFFSET), masses=replace(uneven().masses, gravity_m_s2=(3.0, -9.0)))
    machine = Machine(mechanism.transmission, mechanism.linkage, PRESS, mechanism.speed_rad_s)
    phi1 = sampled(mechanism, 7)
    driven, q, rate = of_law(machine, phi1)
    found = machine_loads(mechanism.linkage, mechanism.masses, driven, np.full(driven.size, 500.0))
    forces = found.shaking_n.at(q, rate, machine.speed_rad_s)
    assert not found.shaking_n.static.any()
    for at, force in zip(phi1, forces, strict=True):
        exact, _ = oracle(mechanism, AMPLITUDE, float(at))
        assert force[0] + 1j * force[1] == pytest.approx(exact, rel=1e-11, abs=1e-12 * np.abs(forces).max())


@pytest.mark.parametrize("mechanism", [CrankSlider(380.0, 960.0, 60.0), ScotchYoke(300.0)])
def test_newton_and_lagrange_agree(mechanism: CrankSlider | ScotchYoke) -> None:
    """M2 = J q'/2 + J' q/2 by w^2: the inertia is from kinetic energy, the torque from the forces in all joints."""
    masses: Masses = HEAVY if isinstance(mechanism, CrankSlider) else Masses(150.0, 40.0, 120.0, 1.6e6, 2e5)
    found = machine_loads(mechanism, masses, ANY, np.zeros(ANY.size))
    torque, inertia, slope = found.torque_n_mm, found.inertia_kg_mm2, found.inertia_slope_kg_mm2
    assert np.allclose(torque.by_rate, inertia / 1e3, rtol=1e-12, atol=0.0)
    assert np.allclose(torque.by_q, slope / 2e3, rtol=0.0, atol=1e-12 * np.abs(slope).max())
    step = 1e-4
    beside = [machine_loads(mechanism, masses, ANY + way, np.zeros(ANY.size)).inertia_kg_mm2 for way in (-step, step)]
    # Central differences miss by step^2/6 of the third derivative, which is of the order of the slope itself
    assert np.allclose((beside[1] - beside[0]) / (2.0 * step), slope, rtol=0.0, atol=1e-7 * np.abs(slope).max())


def test_a_slider_alone_takes_force_times_speed() -> None:
    """(F + m a) v, from the slider's own displacement, at places of a turn; q is any function."""
    speed, mass = 60.0 * RPM, 150.0
    slid = BALER_LINKAGE.displacement(Jet.variable(ANY, 2))
    force = np.where(np.mod(ANY, 2.0 * pi) < pi, PRESS.working.force_n(slid.value), 0.0)
    q, rate = square_of(ANY)
    velocity = speed * slid.derivative(1) * np.sqrt(q)
    acceleration = speed**2 * (slid.derivative(2) * q + slid.derivative(1) * rate / 2.0)
    exact = (force + mass * acceleration / 1000.0) * velocity / 1000.0
    found = machine_loads(BALER_LINKAGE, RodMasses(slider_kg=mass), ANY, force).torque_n_mm.at(q, rate, speed)
    assert np.allclose(found * np.sqrt(q) * speed / 1000.0, exact, rtol=0.0, atol=1e-12 * np.abs(exact).max())
    # Without its mass it is another power
    light = machine_loads(BALER_LINKAGE, RodMasses(), ANY, force).torque_n_mm.at(q, rate, speed)
    assert not np.allclose(light * np.sqrt(q) * speed / 1000.0, exact, rtol=0.1)


def test_a_cycle_takes_the_work_of_the_resistance() -> None:
    """Whatever the motion: masses give back what they take, and weights too.  Gauss-Legendre points, 60 a stroke."""
    linkage = CrankSlider(380.0, 960.0, 60.0)
    unit, weight = np.polynomial.legendre.leggauss(60)
    work = 0.0
    for start, end, force_n in ((0.0, linkage.working_angle_rad, 700.0), (linkage.working_angle_rad, 2.0 * pi, 0.0)):
        angle = start + (end - start) * (1.0 + unit) / 2.0
        found = machine_loads(linkage, HEAVY, angle, np.full(angle.size, force_n))
        torque = found.torque_n_mm.at(*square_of(angle), 60.0 * RPM)
        work += float(np.sum(weight * torque)) * (end - start) / 2.0
    assert work == pytest.approx(700.0 * linkage.stroke_mm, rel=1e-12)


def test_stored_energy_is_what_the_torque_has_brought() -> None:
    """Without resistance and weights the torque's work from place to place is the change of J w^2 q / 2."""
    linkage, speed = CrankSlider(380.0, 960.0, 60.0), 60.0 * RPM
    masses = replace(HEAVY, gravity_m_s2=(0.0, 0.0))
    unit, weight = np.polynomial.legendre.leggauss(40)
    angle = 1.0 + 0.75 * (1.0 + unit)
    found = machine_loads(linkage, masses, angle, np.zeros(40))
    work = 0.75 * float(np.sum(weight * found.torque_n_mm.at(*square_of(angle), speed)))
    ends = np.array([1.0, 2.5])
    inertia = machine_loads(linkage, masses, ends, np.zeros(2)).inertia_kg_mm2
    energy = inertia * speed**2 * square_of(ends)[0] / 2e3
    assert work == pytest.approx(float(energy[1] - energy[0]), rel=1e-12)
