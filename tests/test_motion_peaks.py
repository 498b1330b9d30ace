"""Peaks of a motion in time: closed forms of an impact, finer times than the search used, and what even rows miss."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from math import cos, pi, radians

import numpy as np
import pytest

from engaged import LAWS, MODULE
from loaded import LINKAGE, MASSES, SPEED, STIFFNESS, begun, even_load, frictionless, mechanism, meshing, slider_load
from ncgear.dynamics.crank_load import crank_load
from ncgear.dynamics.history import even_times_s, history, motion_peaks
from ncgear.dynamics.loaded_machine import RigidMachine
from ncgear.dynamics.mesh_force import MeshPlace
from ncgear.dynamics.motion_in_time import Course, EvenDrive, Motor, ToothedMachine, course
from ncgear.dynamics.quasi_static import loaded_contact
from ncgear.dynamics.start import Start, _pressing, law_torque_n_mm, started
from ncgear.errors import NoSuchMechanism
from ncgear.kinematics.motion import Machine
from ncgear.mechanisms.forces import CrankPace
from ncgear.mechanisms.resistance import PolynomialResistance, Resistance, TableResistance
from ncgear.mechanisms.slider_load import SliderLoad
from ncgear.numerics.arrays import Array
from ncgear.numerics.jet import Jet
from ncgear.pitch.shape import Mesh

BASE = 12.0 * MODULE * cos(radians(20.0))
CENTER_MM = {"uniform": 48.0, "sine": 62.0}
"""Distance of the axes: teeth times module."""


def rigid(name: str, resistance: Resistance, speed_rad_s: float = SPEED) -> RigidMachine:
    place = MeshPlace(CENTER_MM[name], radians(20.0), Mesh.EXTERNAL, pi)
    return RigidMachine(Machine(LAWS[name](), LINKAGE, SliderLoad(resistance), speed_rad_s), MASSES, place)


def on_its_way(found: ToothedMachine, phi1_rad: float, speed_rad_s: float) -> Array:
    """The state of circular gears that run on the law with its load, at a driving angle."""
    here = np.array([phi1_rad])
    torque = law_torque_n_mm(found.load, LAWS["uniform"](), here, speed_rad_s)
    ahead = loaded_contact(found.meshing, here, torque, speed_rad_s).error_rad[0]
    return np.array([phi1_rad, speed_rad_s, phi1_rad + ahead, speed_rad_s, 0.0, 0.0])


@cache
def knocking() -> Course:
    """A machine without resistance whose teeth part and meet."""
    found = mechanism(meshing("sine", 31, backlash_mm=0.2), slider_load((0.0,)))
    return course(found, started(found, LAWS["sine"](), Start.ON_LAW, SPEED), 0.6)


@pytest.mark.slow
@pytest.mark.parametrize(("speed", "inertia"), [(0.4, 3e4), (1.5, 7e3)])
def test_an_impact_from_rest_has_the_closed_forms_peak(speed: float, inertia: float) -> None:
    """Without damping and load M w^2 / 2 = N k d^(n + 1) / (n + 1); even rows see next to nothing of it."""
    found = mechanism(
        frictionless(meshing("uniform", 24, backlash_mm=0.5), damping_n_s_mm=0.0),
        even_load(inertia, 0.0),
        EvenDrive(speed),
    )
    out = course(found, begun(found, LAWS["uniform"](), Start.REST), 0.002)
    peaks = motion_peaks(out, rigid("uniform", PolynomialResistance((0.0,)), speed))
    impact = found.meshing.impact
    near = found.meshing.gaps.at(np.array(peaks.pushing_n.phi1_rad))
    pairs = int(np.sum((near.urge > 0.0) & (np.abs(near.error_rad) < 1e-9)))
    energy = 0.5 * 1e-3 * inertia * speed**2
    depth = ((impact.exponent + 1.0) * energy / (pairs * STIFFNESS)) ** (1.0 / (impact.exponent + 1.0))
    force = STIFFNESS * depth**impact.exponent
    assert peaks.pushing_n.value == pytest.approx(force, rel=2e-5)
    assert peaks.least_torque_n_mm.value == pytest.approx(0.0, abs=1e-6)
    assert peaks.most_torque_n_mm.value == pytest.approx(pairs * force * BASE, rel=2e-5)
    assert peaks.forces_n["mesh"].value == pytest.approx(pairs * force, rel=2e-4)
    rows = history(out, rigid("uniform", PolynomialResistance((0.0,)), speed), even_times_s(out))
    assert rows.pushing_n.max() < 0.9 * force


@pytest.mark.long
@pytest.mark.slow
def test_no_time_shows_more_than_the_peaks() -> None:
    """At random times, which the search did not use; each peak is reached at its own time and driving angle."""
    out, machine, shares = knocking(), rigid("sine", PolynomialResistance((0.0,))), list[float]()
    peaks = motion_peaks(out, machine, shares.append)
    assert min(shares) == 0.0
    assert 0.5 < max(shares) <= 1.0
    time_s = np.sort(np.random.default_rng(5).uniform(0.0, out.time_s[-1], 100_000))
    shown = history(out, machine, time_s)
    for peak, values in (
        (peaks.pushing_n, shown.pushing_n),
        (peaks.back_n, shown.back_n),
        (peaks.most_torque_n_mm, shown.torque_n_mm),
        (peaks.acceleration, np.abs(shown.slide.acceleration)),
        (peaks.velocity_error, np.abs(shown.slide.velocity - shown.law.velocity)),
        *((peaks.forces_n[name], np.hypot(force.x, force.y)) for name, force in shown.forces.items()),
    ):
        assert values.max() <= peak.value * (1.0 + 1e-9)
        assert values.max() > 0.98 * peak.value
        assert out.at(np.array([peak.time_s]))[0, 0] == pytest.approx(peak.phi1_rad, abs=1e-12)
    there = history(out, machine, np.array([peaks.pushing_n.time_s, peaks.back_n.time_s]))
    assert there.pushing_n[0] == pytest.approx(peaks.pushing_n.value, rel=1e-12)
    assert there.back_n[1] == pytest.approx(peaks.back_n.value, rel=1e-12)
    rows = history(out, machine, even_times_s(out))
    assert rows.back_n.max() < 0.999 * peaks.back_n.value


@pytest.mark.slow
def test_a_force_that_ends_at_a_dead_centre_is_met_on_its_own_side() -> None:
    """The resistance is largest where it ends; the wrist bears it and the slider's inertia just before."""
    resistance = PolynomialResistance((0.0, 40.0))
    found = mechanism(meshing("uniform", 24), slider_load((0.0, 40.0)), EvenDrive(1.0))
    out = course(found, on_its_way(found, pi - 0.1, 1.0), 0.03)
    machine = rigid("uniform", resistance, 1.0)
    peak = motion_peaks(out, machine).forces_n["wrist"]
    end_s = out.time_s[np.argmin(np.abs(out.states[2] - pi))]
    before = history(out, machine, np.array([end_s * (1.0 - 1e-10)]))
    assert peak.value >= float(np.hypot(before.forces["wrist"].x, before.forces["wrist"].y)[0]) * (1.0 - 1e-9)
    assert peak.value == pytest.approx(40.0 * 120.0, rel=2e-3)


@pytest.mark.slow
def test_the_laws_motion_is_the_one_at_the_driving_gears_own_speed() -> None:
    """On a motor that runs up, the law's velocity is the rate of the law's displacement, not that at another speed."""
    motor = Motor(3.0 * SPEED, 2e4, 100.0)
    found = mechanism(frictionless(meshing("sine", 31)), slider_load((0.0,)), motor)
    out = course(found, started(found, LAWS["sine"](), Start.ON_LAW, SPEED), 0.05)
    assert out.states[1, -1] > 1.05 * SPEED
    machine = rigid("sine", PolynomialResistance((0.0,)))
    step = 1e-6
    time_s = np.linspace(step, out.time_s[-1] - step, 40)
    shown, before, after = (history(out, machine, time_s + shift) for shift in (0.0, -step, step))
    rate = (after.law.displacement - before.law.displacement) / (2.0 * step)
    np.testing.assert_allclose(shown.law.velocity, rate, rtol=1e-5, atol=1e-4)
    peaks = motion_peaks(out, machine)
    # The driven gear keeps the law but for the depth of its teeth
    assert peaks.velocity_error.value < 0.02 * np.abs(shown.law.velocity).max()


@pytest.mark.slow
@pytest.mark.parametrize("width_mm", [0.01, 0.003])
def test_a_narrow_peak_of_the_resistance_is_met(width_mm: float) -> None:
    """The wrist bears its part of it: the crank slows down by its moment while speeds and teeth are as they were."""
    resistance = TableResistance(
        (0.0, 58.0 - width_mm, 58.0, 58.0 + width_mm, 120.0), (200.0, 200.0, 7e3, 200.0, 200.0)
    )
    load = crank_load(LINKAGE, MASSES, SliderLoad(resistance))
    found = mechanism(meshing("uniform", 24), load)
    out = course(found, on_its_way(found, 1.5, SPEED), 0.05)
    peak = motion_peaks(out, rigid("uniform", resistance)).forces_n["wrist"]
    state = out.at(np.array([peak.time_s]))
    slide = LINKAGE.displacement(Jet.variable(state[2], 1))
    assert slide.value[0] == pytest.approx(58.0, abs=0.05 * width_mm)
    even = slider_load((200.0,))
    moment = found.answer(state).teeth[-1].driven_n_mm.sum(axis=-1) - 6800.0 * slide.derivative(1)
    slowed = CrankPace(state[3], even.acceleration_rad_s2(state[2], state[3], moment))
    wrist = LINKAGE.joint_forces(Jet.variable(state[2], 2), MASSES, slowed, np.array([7e3])).joints["wrist"]
    assert peak.value == pytest.approx(float(np.hypot(wrist.x, wrist.y)[0]), rel=1e-3)
    rows = history(out, rigid("uniform", resistance), even_times_s(out)).forces["wrist"]
    assert np.hypot(rows.x, rows.y).max() < 0.5 * peak.value


@pytest.mark.slow
def test_a_solver_that_steps_over_a_narrow_peak_is_told_by_the_energy() -> None:
    """Negative control of the stops about it."""
    resistance = TableResistance((0.0, 57.99, 58.0, 58.01, 120.0), (200.0, 200.0, 2e4, 200.0, 200.0))
    load = crank_load(LINKAGE, MASSES, SliderLoad(resistance))
    assert load.narrow_rad.shape == (1, 3)
    found = mechanism(meshing("uniform", 24), replace(load, narrow_rad=np.empty((0, 3))))
    with pytest.raises(NoSuchMechanism, match="energy misses"):
        course(found, on_its_way(found, 1.5, SPEED), 0.05)


def test_a_small_torque_at_a_dead_centre_leaves_the_flanks_that_were_pressed() -> None:
    """The torques of the turn before a start; 0 stands for pushing flanks, a torque below 0 presses their backs."""
    for torques, kept in (
        ([5.0, 3.0, -0.04], 0.0),
        ([5.0, 3.0, 0.04], 0.04),
        ([5.0, 3.0, -0.06], -0.06),
        ([5.0, -3.0, 0.04], -5e-4),
        ([5.0, -3.0, -0.04], -0.04),
        ([0.0, 0.0, 0.0], 0.0),
    ):
        assert _pressing(np.array(torques)).tolist() == pytest.approx([kept]), torques
