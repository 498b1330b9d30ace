"""States one by one in plain numbers, against the same machine in arrays."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from loaded import even_load, frictionless, mechanism, meshing, slider_load, uneven_meshing
from ncgear.dynamics.meshing import Meshing
from ncgear.dynamics.motion_in_time import Motor, ToothedMachine
from ncgear.dynamics.place_by_place import StateByState
from ncgear.numerics.arrays import Array

MESHES = {
    "friction": lambda: meshing("sine", 31, backlash_mm=0.2),
    "smooth": lambda: frictionless(meshing("uniform", 24)),
    "stiffer and softer": lambda: uneven_meshing("sine", 31),
}


def states(teeth: Meshing, count: int = 200) -> Array:
    """States in which teeth push, hold back or are apart, over several turns to either side, shape (6, n)."""
    drawn = np.random.default_rng(3)
    phi1 = drawn.uniform(-10.0, 20.0, count)
    pushing, back = teeth.gaps.play_rad(phi1)
    error = pushing + (back - pushing) * drawn.uniform(0.0, 1.0, count) + drawn.choice([-1e-3, 0.0, 1e-3], count)
    speeds = drawn.uniform(-10.0, 10.0, (2, count))
    return np.stack([phi1, speeds[0], teeth.law.at(phi1)[0] + error, speeds[1], *np.zeros((2, count))])


def by_arrays(found: ToothedMachine, at: Array) -> Array:
    """The accelerations of both shafts in states, shape (2, n)."""
    answer = found.answer(at)
    return np.stack([answer.acceleration1_rad_s2, answer.acceleration2_rad_s2])


@pytest.mark.slow
@pytest.mark.parametrize("name", MESHES)
def test_one_by_one_states_change_as_in_arrays(name: str) -> None:
    teeth = MESHES[name]()
    motor = Motor(10.0, 5e5, 50.0)
    found = mechanism(teeth, slider_load(), motor)
    at = states(teeth)
    expected = by_arrays(found, at)
    own = StateByState(motor.answer, motor.inertia_n_mm_s2, found.meshing, found.load)
    pulls = [own.pull(complex(*state[[0, 2]]), complex(*state[[1, 3]])) for state in at.T]
    pulled = np.array([one.acceleration for one in pulls])
    scale = np.abs(expected).max(axis=1, keepdims=True)
    np.testing.assert_allclose(np.stack([pulled.real, pulled.imag]) / scale, expected / scale, rtol=1e-12, atol=1e-15)
    # Negative control: teeth of another law of impact
    other = replace(teeth, impact=replace(teeth.impact, exponent=teeth.impact.exponent + 0.1))
    assert np.abs(by_arrays(replace(found, meshing=other), at) - expected).max() > 1e-3 * scale[1]


@pytest.mark.slow
@pytest.mark.parametrize(("row", "told", "damping_n_s_mm"), [(2, "stiffness", 0.0), (3, "damping", 30.0)])
def test_the_spring_of_touching_teeth_is_what_a_small_turn_changes(row: int, told: str, damping_n_s_mm: float) -> None:
    """The relative acceleration by the driven angle or speed; but for what levers change with it."""
    motor, teeth = Motor(10.0, 5e5, 50.0), frictionless(meshing("uniform", 24), damping_n_s_mm=damping_n_s_mm)
    found, at, step = mechanism(teeth, even_load(2e4, 0.0), motor), states(teeth), np.zeros((6, 1))
    step[row] = 1e-7
    changed = (by_arrays(found, at + step) - by_arrays(found, at - step)) / 2e-7
    own = StateByState(motor.answer, motor.inertia_n_mm_s2, teeth, found.load)
    pulls = [own.pull(complex(*state[[0, 2]]), complex(*state[[1, 3]])) for state in at.T]
    ratio, spring = np.array([one.ratio for one in pulls]), np.array([getattr(one, told) for one in pulls])
    np.testing.assert_allclose(-spring, changed[1] - ratio * changed[0], atol=2e-2 * spring.max())
    assert np.count_nonzero(spring) > 50
    yielding = np.array([one.yielding for one in pulls])
    np.testing.assert_allclose(yielding.imag - ratio * yielding.real, 1.0, rtol=1e-12)
    np.testing.assert_allclose(-spring * yielding.real, changed[0], atol=2e-2 * np.abs(changed[0]).max())
