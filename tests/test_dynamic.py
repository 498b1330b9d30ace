"""The motion in time: energy, closed forms, limits, and the cases in which teeth part, knock and turn back."""

from __future__ import annotations

from dataclasses import replace
from math import cos, pi, radians, sqrt
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from engaged import LAWS, MODULE, RINGS, made
from loaded import (
    LINKAGE,
    MASSES,
    SPEED,
    STIFFNESS,
    begun,
    even_load,
    frictionless,
    mechanism,
    meshing,
    slider_load,
    uneven_meshing,
)
from ncgear.dynamics.history import even_times_s, history, meetings_s, partings_s, pressed_rad
from ncgear.dynamics.loaded_machine import RigidMachine
from ncgear.dynamics.mesh_force import MeshPlace, mesh_force
from ncgear.dynamics.meshing import force_on_driven, tangent
from ncgear.dynamics.motion_in_time import Course, EvenDrive, Motor, ToothedMachine, course
from ncgear.dynamics.place_by_place import StateByState
from ncgear.dynamics.quasi_static import loaded_contact
from ncgear.dynamics.start import Start, law_torque_n_mm, started
from ncgear.errors import NoSuchMechanism
from ncgear.kinematics.motion import Machine
from ncgear.mechanisms.forces import RodMasses
from ncgear.mechanisms.resistance import PolynomialResistance
from ncgear.mechanisms.slider_load import SliderLoad
from ncgear.numerics.arrays import Array
from ncgear.numerics.jet import Jet
from ncgear.numerics.oscillator_steps import Pull
from ncgear.pitch.shape import Mesh

BASE = 12.0 * MODULE * cos(radians(20.0))
PLACE = MeshPlace(62.0, radians(20.0), Mesh.EXTERNAL, pi)
HEAVY = 2e4
"""Inertia in kg mm2 of the closed forms' shaft."""


def run(found: ToothedMachine, name: str, turns: float = 0.3, start: Start = Start.ON_LAW, **kinds: Any) -> Course:
    return course(found, begun(found, (LAWS | RINGS)[name](), start), turns, **kinds)


def pushing_meet_s(out: Course) -> Array:
    """Times at which pushing flanks meet or part."""
    return meetings_s(lambda time_s: pressed_rad(*out.machine.pairs(out.at(time_s))[0])[0], out.fine_s)


def backs_meet_s(out: Course) -> Array:
    """Times at which the backs of the teeth meet or part."""

    def pressed(time_s: Array) -> Array:
        states, meshing = out.at(time_s), out.machine.meshing
        return states[2] - meshing.law.at(states[0])[0] - meshing.gaps.play_rad(states[0])[1]

    return meetings_s(pressed, out.time_s)


# Energy


@pytest.mark.tiers(quick=["sine-31-on_law"], slow=["ring-24-on_law"], rest="long")
@pytest.mark.parametrize("start", list(Start))
@pytest.mark.parametrize(("name", "teeth"), [("uniform", 24), ("sine", 31), ("uniform 1:2", 16), ("ring", 24)])
def test_energy_balances(name: str, teeth: int, start: Start) -> None:
    found = run(mechanism(meshing(name, teeth), slider_load()), name, 0.12, start)
    assert found.states[4, -1] > 1e3
    assert found.energy_error < 1e-5


@pytest.mark.tiers(slow=["sine-31"], rest="long")
@pytest.mark.parametrize(("name", "teeth"), [("uniform", 24), ("sine", 31), ("ring", 24)])
def test_energy_balances_where_pairs_get_stiffer_and_softer_on_their_way(name: str, teeth: int) -> None:
    found = run(mechanism(uneven_meshing(name, teeth), slider_load()), name, 0.12)
    assert found.states[4, -1] > 1e3
    assert found.energy_error < 1e-5


@pytest.mark.slow
def test_teeth_that_push_harder_than_they_tell_are_told_by_the_energy(monkeypatch: pytest.MonkeyPatch) -> None:
    right = StateByState.pull

    def wrong(machine: StateByState, place: complex, speed: complex) -> Pull:
        found = right(machine, place, speed)
        return found._replace(acceleration=complex(found.acceleration.real, 1.01 * found.acceleration.imag))

    monkeypatch.setattr(StateByState, "pull", wrong)
    damped = meshing("uniform", 24)
    damped = replace(damped, impact=replace(damped.impact, damping_n_s_mm=1.0))
    with pytest.raises(
        NoSuchMechanism, match=r"energy misses .* of the work at phi1 = .*; softer teeth .* are needed"
    ) as told:
        run(mechanism(damped, slider_load()), "uniform", 0.01, Start.REST)
    assert (told.value.exit_status, told.value.key) == (3, "simulation")


@pytest.mark.long
@pytest.mark.slow
def test_the_motion_converges_with_the_accuracy() -> None:
    found = mechanism(meshing("sine", 31), slider_load())
    exact = run(found, "sine", accuracy=1e-11).states[:5, -1]
    # At 1e-4 the energy may miss its balance, which is an error
    errors = [
        np.abs(run(found, "sine", accuracy=accuracy).states[:5, -1] / exact - 1.0).max()
        for accuracy in (1e-5, 1e-7, 1e-9)
    ]
    assert errors[0] > 10.0 * errors[1] > 10.0 * errors[2]
    assert errors[2] < 1e-7


# Closed forms on circular gears


def test_a_constant_torque_settles_at_the_closed_forms_depth() -> None:
    """One shaft of constant inertia against a constant torque: depth (T / (N k r))^(1/n), N pairs sharing."""
    found = mechanism(frictionless(meshing("uniform", 24)), even_load(HEAVY, 2e3), EvenDrive(0.1))
    end = run(found, "uniform", 0.02, Start.REST)
    teeth = found.answer(end.states[:, -1]).teeth[-1]
    pairs = int(np.sum(teeth.normal_n > 0.0))
    depth = (2e3 / (pairs * STIFFNESS * BASE)) ** (1.0 / 2.2)
    np.testing.assert_allclose(teeth.depth_mm[teeth.normal_n > 0.0], depth, rtol=1e-4)


def test_small_vibrations_have_the_closed_forms_frequency() -> None:
    """w^2 = N n k d^(n - 1) r^2 / M about the depth d at rest, the driving gear standing still."""
    smooth = frictionless(meshing("uniform", 24), damping_n_s_mm=0.0)
    found = mechanism(smooth, even_load(HEAVY, 2e3), EvenDrive(0.0))
    phi1 = 0.07
    rest = loaded_contact(smooth, np.array([phi1]), np.array([2e3]), 0.0)
    pairs, depth = int(rest.pairs[0]), float(rest.forces.depth_mm.max())
    stiffness = pairs * 2.2 * STIFFNESS * depth**1.2 * BASE**2
    frequency = sqrt(stiffness / (1e-3 * HEAVY))
    place = phi1 + float(rest.error_rad[0])
    swing = 1e-4 * depth / BASE
    own = StateByState(found.drive.answer, 0.0, found.meshing, found.load)

    def change(_: float, at: Array) -> Array:
        return np.array([at[1], own.pull(complex(phi1, at[0]), complex(0.0, at[1])).acceleration.imag])

    swung = [place + swing, 0.0]
    out = solve_ivp(change, (0.0, 10.0 * 2.0 * pi / frequency), swung, rtol=1e-10, atol=1e-13)
    assert out.y[0, -1] - place == pytest.approx(swing, rel=1e-3)
    assert np.interp(2.25 * 2.0 * pi / frequency, out.t, out.y[0]) - place == pytest.approx(0.0, abs=0.05 * swing)


# Limits


@pytest.mark.slow
def test_a_stiff_contact_reaches_the_rigid_motion_at_the_power_of_the_law_of_impact() -> None:
    """The driven gear stays behind the law by the static depth, which falls with k^(-1/n)."""
    behind = []
    for stiffness in (1e5, 1e7):
        found = mechanism(frictionless(meshing("sine", 31), stiffness=stiffness), slider_load())
        out = run(found, "sine", 0.3)
        behind.append(np.median(np.abs(out.states[2] - found.meshing.law.at(out.states[0])[0])))
    assert np.log10(behind[0] / behind[1]) / 2.0 == pytest.approx(1.0 / 2.2, rel=0.1)


@pytest.mark.slow
def test_at_a_slow_speed_the_motion_is_that_of_loaded_contact() -> None:
    found = mechanism(meshing("sine", 31), slider_load(), EvenDrive(0.5))
    out = run(found, "sine", 0.2)
    time_s = np.linspace(0.1, out.time_s[-1], 50)
    states = out.at(time_s)
    phi1 = states[0]
    torque = law_torque_n_mm(found.load, LAWS["sine"](), phi1, 0.5)
    rest = loaded_contact(found.meshing, phi1, torque, 0.5)
    error = states[2] - found.meshing.law.at(phi1)[0]
    np.testing.assert_allclose(error, rest.error_rad, atol=0.05 * np.abs(rest.error_rad).max())


@pytest.mark.tiers(slow=["0.1"], rest="long")
@pytest.mark.parametrize("factor", [0.1, 10.0])
def test_ten_times_the_stiffness_or_a_tenth(factor: float) -> None:
    found = meshing("sine", 31)
    out = run(mechanism(found.stiffened(factor), slider_load()), "sine")
    assert out.energy_error < 1e-5
    deepest = out.machine.answer(out.states).teeth[-1].depth_mm.max()
    usual = run(mechanism(found, slider_load()), "sine")
    ratio = deepest / usual.machine.answer(usual.states).teeth[-1].depth_mm.max()
    assert ratio == pytest.approx(factor ** (-1.0 / 2.2), rel=0.3)


# Teeth that part and meet


@pytest.mark.tiers(slow=["0.05"], rest="long")
@pytest.mark.parametrize("backlash_mm", [0.05, 0.4])
def test_without_resistance_teeth_part_and_meet_and_no_energy_appears(backlash_mm: float) -> None:
    """The slider's inertia carries the driven gear ahead; nothing is lost, so nothing may be gained."""
    smooth = frictionless(meshing("sine", 31, backlash_mm=backlash_mm), damping_n_s_mm=0.0)
    out = run(mechanism(smooth, slider_load((0.0,))), "sine", 0.6)
    assert len(partings_s(out)[0]) >= 2
    assert out.states[5].max() == 0.0
    assert out.energy_error < 1e-5


@pytest.mark.slow
def test_damping_takes_energy_at_every_knock() -> None:
    out = run(mechanism(meshing("sine", 31, backlash_mm=0.2), slider_load((0.0,))), "sine", 0.6)
    assert np.all(np.diff(out.states[5]) >= -1e-5 * out.states[5, -1])
    assert out.states[5, -1] > 0.0
    assert out.energy_error < 1e-5


@pytest.mark.slow
def test_without_play_a_reversed_load_changes_flanks_at_once() -> None:
    out = run(mechanism(meshing("sine", 31), slider_load((0.0,))), "sine", 0.6)
    parting = pushing_meet_s(out)
    assert parting.size >= 2
    np.testing.assert_allclose(parting, backs_meet_s(out), atol=1e-3)


@pytest.mark.long
@pytest.mark.slow
def test_without_play_some_flank_always_touches() -> None:
    """Pushing flanks part for a good part of the time, but then the backs carry."""
    out = run(mechanism(meshing("sine", 31), slider_load((0.0,))), "sine", 0.6)
    apart = partings_s(out)[0]
    assert np.sum(np.diff(apart)) > 0.1 * out.time_s[-1]
    assert partings_s(out)[1].size == 0


@pytest.mark.slow
def test_with_play_no_flank_touches_where_none_bears_load() -> None:
    """The spans without contact, told from depths, against the forces at shifted times; and they are fewer than the
    spans in which pushing flanks are apart."""
    out = run(mechanism(meshing("sine", 31, backlash_mm=0.2), slider_load((0.0,))), "sine", 0.6)
    free, apart = partings_s(out)[::-1]
    assert 0.0 < np.sum(np.diff(free)) < np.sum(np.diff(apart))
    time_s = np.linspace(0.0, out.time_s[-1], 7919)[1:-1]
    bears = out.machine.answer(out.at(time_s)).teeth[-1].normal_n.max(axis=-1) > 0.0
    within = np.any((time_s[:, None] > free[:, 0]) & (time_s[:, None] < free[:, 1]), axis=1)
    assert not bears[within].any()
    # Damping may hold parting flanks at no force before they are apart
    assert np.mean(bears[~within]) > 0.95


@pytest.mark.long
@pytest.mark.slow
def test_a_fast_drive_reverses_the_load_of_the_teeth_and_a_slow_one_does_not() -> None:
    """From the torque of the rigid motion: at the speed at which inertia outweighs the resistance, backs bear load."""
    angles = np.linspace(0.3, 2.8, 400)
    for speed, reverses in ((1.0, False), (120.0, True)):
        found = mechanism(meshing("uniform", 24), slider_load(), EvenDrive(speed))
        least = law_torque_n_mm(found.load, LAWS["uniform"](), angles, speed).min()
        assert bool(least < 0.0) is reverses
        out = run(found, "uniform", 0.45)
        assert (backs_meet_s(out).size > 0) is reverses


@pytest.mark.slow
def test_an_undercut_pair_bears_load_on_its_shorter_contact() -> None:
    kinds = {"undercut": True}
    _, pair = made("uniform", 12, **kinds)
    assert pair.driving.undercut
    out = run(mechanism(meshing("uniform", 12, **kinds), slider_load()), "uniform", 0.3)
    assert out.energy_error < 1e-5
    # The slider's mass has pressed the backs before the dead centre: the gear crosses its play once.
    assert partings_s(out)[0][:, 0].tolist() == [0.0]


# Drive and start


@pytest.mark.slow
def test_from_rest_a_motor_takes_the_machine_up_to_its_speed() -> None:
    motor = Motor(SPEED, 5e5, 50.0)
    out = run(mechanism(meshing("uniform", 24), slider_load((50.0,)), motor), "uniform", 1.0, Start.REST)
    assert out.states[1, 0] == out.states[3, 0] == 0.0
    assert out.states[1, -1] == pytest.approx(SPEED, rel=0.05)
    assert out.energy_error < 1e-5


def test_a_motor_without_load_has_the_closed_forms_run_up() -> None:
    """J w' = T (1 - w / w0), so that w = w0 (1 - exp(-T t / (J w0))), with the driven shaft's inertia in J."""
    motor = Motor(10.0, 1e4, 100.0)
    found = mechanism(frictionless(meshing("uniform", 24)), even_load(HEAVY, 0.0), motor)
    out = run(found, "uniform", 0.2, Start.REST)
    expected = 10.0 * (1.0 - np.exp(-1e4 * out.time_s[-1] / ((100.0 + 1e-3 * HEAVY) * 10.0)))
    assert out.states[1, -1] == pytest.approx(expected, rel=2e-3)


@pytest.mark.thorough
@pytest.mark.parametrize("no_load", [1.3 * SPEED, 4.0 * SPEED])
def test_on_the_law_a_motor_starts_at_the_operating_speed(no_load: float) -> None:
    """Whatever its speed without load is: both shafts have the law's speeds, and the teeth bear the law's torque.

    That is 0 at a dead centre, before which the slider's mass has pressed the backs of the teeth.
    """
    found = mechanism(frictionless(meshing("sine", 31)), slider_load(), Motor(no_load, 5e5, 50.0))
    state = started(found, LAWS["sine"](), Start.ON_LAW, SPEED)
    slope = float(LAWS["sine"]().driven_angle(np.zeros(1), 1).derivative(1)[0])
    assert state[1] == SPEED
    assert state[3] == pytest.approx(slope * SPEED, rel=1e-12)
    asked = law_torque_n_mm(found.load, LAWS["sine"](), np.linspace(-1.0, 0.0, 100), SPEED)
    assert abs(asked[-1]) < 1e-9 < -asked[50]
    brought = found.answer(state).teeth[-1].driven_n_mm.sum()
    assert -0.01 * np.abs(asked).max() < brought < 0.0


@pytest.mark.slow
def test_a_motor_that_cannot_is_told() -> None:
    weak = Motor(SPEED, 2e3, 50.0)
    with pytest.raises(NoSuchMechanism, match="does not get on") as caught:
        run(mechanism(meshing("uniform", 24), slider_load(), weak), "uniform", 1.0, Start.REST)
    assert caught.value.key == "simulation.motor"


@pytest.mark.long
@pytest.mark.slow
def test_dead_centres_end_steps() -> None:
    out = run(mechanism(meshing("uniform", 24), slider_load()), "uniform", 1.2)
    crank_rad = out.states[2]
    for dead_centre_rad in (pi, 2.0 * pi):
        assert np.abs(crank_rad - dead_centre_rad).min() < 1e-9


# What is shown


@pytest.mark.slow
def test_pushing_flanks_bear_nothing_where_they_are_told_apart() -> None:
    """Zero in every interval of lost contact; and whatever they bear is outside of these."""
    out = run(mechanism(meshing("sine", 31, backlash_mm=0.2), slider_load((0.0,))), "sine", 0.6)
    machine = RigidMachine(Machine(LAWS["sine"](), LINKAGE, SliderLoad(), SPEED), MASSES, PLACE)
    shown = history(out, machine, even_times_s(out))
    lost = partings_s(out)[0]
    assert len(lost) >= 1
    apart = np.any((shown.time_s[:, None] > lost[:, 0]) & (shown.time_s[:, None] < lost[:, 1]), axis=1)
    assert 0.05 < apart.mean() < 0.95
    assert shown.pushing_n[apart].max() == 0.0
    assert np.mean(shown.pushing_n[~apart] > 0.0) > 0.95


@pytest.mark.slow
def test_a_history_is_the_motion_beside_its_law() -> None:
    machine = Machine(LAWS["sine"](), LINKAGE, SliderLoad(PolynomialResistance((500.0,))), SPEED)
    out = run(mechanism(meshing("sine", 31), slider_load()), "sine", 0.5)
    shown = history(out, RigidMachine(machine, MASSES, PLACE), even_times_s(out, 2000))
    np.testing.assert_allclose(shown.law.velocity, machine.motion(shown.phi1_rad).velocity, atol=1e-9)
    assert np.abs(shown.slide.displacement - shown.law.displacement).max() < 0.3
    # Velocity and acceleration are the derivatives of what is shown beside them.
    step = shown.time_s[1]
    velocity = np.gradient(shown.slide.displacement, step)[1:-1]
    np.testing.assert_allclose(velocity, shown.slide.velocity[1:-1], atol=1e-3 * np.abs(velocity).max())
    acceleration = np.gradient(shown.slide.velocity, step)[1:-1]
    typical = np.abs(acceleration).max()
    assert np.quantile(np.abs(acceleration - shown.slide.acceleration[1:-1]), 0.9) < 1e-2 * typical


def test_joints_bear_what_newton_and_euler_ask_of_the_simulated_motion() -> None:
    """The torque asked of the crank shaft is what the teeth bring, though the motion came from Lagrange's equation."""
    machine = RigidMachine(
        Machine(LAWS["sine"](), LINKAGE, SliderLoad(PolynomialResistance((500.0,))), SPEED), MASSES, PLACE
    )
    out = run(mechanism(meshing("sine", 31), slider_load()), "sine", 0.15)
    shown = history(out, machine, even_times_s(out))
    brought = out.machine.answer(out.at(shown.time_s)).teeth[-1].driven_n_mm.sum(axis=-1)
    np.testing.assert_allclose(shown.joints.torque_n_mm, brought, atol=1e-6 * np.abs(brought).max())


@pytest.mark.tiers(slow=["ring-24"], rest="quick")
@pytest.mark.parametrize(("name", "teeth"), [("uniform", 24), ("sine", 31), ("ring", 24)])
def test_tangents_have_the_length_one(name: str, teeth: int) -> None:
    found = meshing(name, teeth)
    phi1 = np.linspace(0.01, 6.0, 301)
    near = found.gaps.at(phi1)
    pitch, _ = made(name, teeth)
    place = MeshPlace(pitch.center_distance_mm, radians(20.0), pitch.mesh, pi)
    close = (near.urge != 0.0) & (np.abs(near.error_rad * near.lever_mm) < 0.2)
    assert np.quantile(np.abs(np.abs(tangent(near, found.law.at(phi1)[1], place))[close] - 1.0), 0.95) < 2e-3


@pytest.mark.tiers(slow=["*ring*"], rest="thorough")
@pytest.mark.parametrize(("name", "teeth"), [("uniform", 24), ("sine", 31), ("ring", 24)])
@pytest.mark.parametrize("torque", [500.0, -500.0])
def test_stiff_teeth_push_as_the_rigid_levels_mesh_force(name: str, teeth: int, torque: float) -> None:
    """The vector found from the teeth's own tangents, against the one through the pitch point."""
    found = frictionless(meshing(name, teeth), stiffness=1e12)
    pitch, _ = made(name, teeth)
    place = MeshPlace(pitch.center_distance_mm, radians(20.0), pitch.mesh, 2.2)
    phi1 = np.linspace(0.01, 6.0, 201)
    loaded = loaded_contact(found, phi1, np.full_like(phi1, torque), 0.0)
    vector = force_on_driven(loaded.forces, found.law.at(phi1)[1], place)
    slope = pitch.transmission.driven_angle(phi1, 2).differentiated()
    rigid = mesh_force(place, slope, Jet(np.full((1, phi1.size), torque))).force
    off = np.hypot(vector.x - rigid.x.value, vector.y - rigid.y.value) / np.hypot(rigid.x.value, rigid.y.value)
    assert np.quantile(off, 0.9) < 1e-3


@pytest.mark.long
@pytest.mark.slow
def test_unbalanced_weights_alone_do_no_work_over_a_turn() -> None:
    heavy = RodMasses(**{**vars(MASSES), "gravity_m_s2": (0.0, -9.81)})
    out = run(mechanism(meshing("uniform", 24), slider_load((0.0,), heavy), EvenDrive(1.0)), "uniform", 1.0)
    assert out.states[4, -1] - out.states[5, -1] == pytest.approx(0.0, abs=2.0)
