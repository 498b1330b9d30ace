"""States one by one in plain numbers, against the same machine in arrays."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from loaded import frictionless, mechanism, meshing, slider_load, uneven_meshing
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
    """The changes of states, shape (6, n)."""
    answer = found.answer(at)
    moved = at[1], answer.acceleration1_rad_s2, at[3], answer.acceleration2_rad_s2
    return np.stack([*moved, answer.torque_n_mm * at[1], answer.teeth[-1].loss_n_mm_s.sum(axis=-1)])


@pytest.mark.slow
@pytest.mark.parametrize("name", MESHES)
def test_one_by_one_states_change_as_in_arrays(name: str) -> None:
    teeth = MESHES[name]()
    found = mechanism(teeth, slider_load(), Motor(10.0, 5e5, 50.0))
    at = states(teeth)
    expected = by_arrays(found, at)
    own = StateByState(found.drive.answer, found.meshing, found.load)
    changes = np.stack([own.change(state) for state in at.T], axis=1)
    scale = np.abs(expected).max(axis=1, keepdims=True)
    np.testing.assert_allclose(changes / scale, expected / scale, rtol=1e-12, atol=1e-15)
    # Negative control: teeth of another law of impact
    other = replace(teeth, impact=replace(teeth.impact, exponent=teeth.impact.exponent + 0.1))
    assert np.abs(by_arrays(replace(found, meshing=other), at) - expected).max() > 1e-3 * scale[1]
