"""Helical teeth that yield and move in time, against closed forms of circular gears and against straight teeth."""

from __future__ import annotations

from dataclasses import replace
from math import cos, pi, radians, sqrt, tan

import numpy as np
import pytest
from scipy.linalg import expm

from commands import Run, on_text, simulated
from loaded import SMOOTH, even_load
from ncgear.design.keys.masses import Simulation
from ncgear.dynamics.gaps import Near
from ncgear.dynamics.meshing import Meshing
from ncgear.dynamics.motion_in_time import EvenDrive, ToothedMachine, course
from ncgear.dynamics.quasi_static import loaded_contact
from ncgear.project.forces import meshing_of, stiffness_of
from test_helical_strength import ANGLE, MODULE, WIDTH, helix_of, sections_of
from test_simulation_levels import HEAD

Array = np.ndarray
TEETH, STIFFNESS, TORQUE, INERTIA, SPEED = 24, 3e5, 2e3, 2e4, 2.0 * pi
RADIUS, PITCH = 0.5 * TEETH * MODULE, pi * MODULE
BASE = RADIUS * cos(ANGLE)
REACH = sqrt((RADIUS + MODULE) ** 2 - BASE**2) - BASE * tan(ANGLE)
"""Way of the contact from the pitch point to where a tip circle ends it."""


def even_teeth(angle_deg: float, count: int, damping: float = 0.0) -> Meshing:
    """Circular helical gears whose pairs have one stiffness over the whole width."""
    pitch, sections = sections_of("uniform", TEETH, helix_of(angle_deg), count)
    given = Simulation(stiffness_n_mm=STIFFNESS, exponent=1.0, damping_n_s_mm=damping, full_damping_depth_mm=1e-9)
    own = stiffness_of(given, lambda places: np.full(places.flanks.shape, np.nan), 1.0)
    return replace(meshing_of(given, pitch, [(one.teeth, own) for one in sections.each]), friction=SMOOTH)


def spans(angle_deg: float, count: int) -> Array:
    """Rolled lengths between which each pair of each section touches, shape (n, 2)."""
    advance = -WIDTH * tan(radians(angle_deg)) * (np.arange(count) + 0.5) / count
    middle = (np.arange(-6, 12) * PITCH - PITCH / 4.0 + advance[:, None]).ravel()
    return np.column_stack([middle - REACH / cos(ANGLE), middle + REACH / cos(ANGLE)])


def pairs(rolled_mm: Array, angle_deg: float, count: int) -> Array:
    """Number of pairs that touch at rolled lengths, sections counting their part of the width, shape (n,)."""
    ends = spans(angle_deg, count)
    return ((ends[:, 0] < rolled_mm[:, None]) & (rolled_mm[:, None] < ends[:, 1])).sum(axis=1) / count


def swung(angle_deg: float, count: int, damping: float, end_s: float) -> tuple[Array, Array]:
    """Times, and angles of the driven gear beyond the law's: between changes of pairs a damped linear oscillator."""
    changes = spans(angle_deg, count).ravel() / (RADIUS * SPEED)
    time_s = np.union1d(np.linspace(0.0, end_s, 800), changes[(changes > 0.0) & (changes < end_s)])
    found = pairs(RADIUS * SPEED * (time_s[1:] + time_s[:-1]) / 2.0, angle_deg, count)
    inertia, every = 1e-3 * INERTIA, [np.array([-TORQUE / (STIFFNESS * found[0] * BASE**2), 0.0, 1.0])]
    for step_s, touching in zip(np.diff(time_s), found, strict=True):
        spring, damper = (one * touching * BASE**2 / inertia for one in (STIFFNESS, damping))
        rate = np.array([[0.0, 1.0, 0.0], [-spring, -damper, -TORQUE / inertia], [0.0, 0.0, 0.0]])
        every.append(expm(rate * step_s) @ every[-1])
    return time_s, np.array(every)[:, 0]


@pytest.mark.judges("dynamics")
def test_the_force_of_a_pair_is_that_of_all_its_sections() -> None:
    none = np.zeros((2, 4))
    near = Near(none, none, none, none, none, none, (none, none, none), np.array([[5, 3, 5, 0], [2, 2, 2, 9]]))
    found = near.of_pairs(np.array([[1.0, 2.0, 4.0, 0.0], [1.0, 1.0, 1.0, 7.0]]))
    assert np.sort(found).tolist() == [[0.0, 0.0, 2.0, 5.0], [0.0, 0.0, 3.0, 7.0]]
    assert replace(near, number=None).of_pairs(none) is none


@pytest.mark.slow
@pytest.mark.parametrize(("angle_deg", "count"), [(5.0, 4), (15.0, 8)])
def test_helical_teeth_yield_as_the_lines_of_contact_say(angle_deg: float, count: int) -> None:
    """The driven gear yields by T / (k n r_b^2), n being the pairs that touch, each in its part of the width."""
    rolled = np.linspace(0.0, 3.0 * PITCH, 400)
    found = loaded_contact(even_teeth(angle_deg, count), rolled / RADIUS, np.full(400, TORQUE), 0.0)
    touching = pairs(rolled, angle_deg, count)
    # Tips touch a little before their time, since loaded teeth yield.
    steady = np.flatnonzero((touching == np.roll(touching, 6)) & (touching == np.roll(touching, -6)))
    assert steady.size > 100
    yielded = -TORQUE / (STIFFNESS * touching * BASE**2)
    assert np.allclose(found.error_rad[steady], yielded[steady], rtol=0.03)
    assert not np.allclose(found.error_rad[steady], yielded[(steady + 40) % 400], rtol=0.03)
    assert np.allclose((found.forces.normal_n.sum(axis=-1) * BASE)[steady], TORQUE, rtol=2e-3)
    # A whole pair bears more than its most loaded section.
    assert found.tooth_force_n.max() > 2.0 * found.forces.normal_n.max()
    assert 2 <= found.pairs.max() <= 3


@pytest.mark.slow
@pytest.mark.parametrize(("angle_deg", "count"), [(5.0, 4), (15.0, 8)])
def test_helical_teeth_swing_as_an_oscillator_in_parts(angle_deg: float, count: int) -> None:
    """Peaks within 3 %: tips touch a little early.  Straight teeth swing three times as far."""
    damping = 60.0
    machine = ToothedMachine(EvenDrive(SPEED), even_teeth(angle_deg, count, damping), even_load(INERTIA, TORQUE))
    time_s, exact = swung(angle_deg, count, damping, 2.5 / TEETH)
    found = course(machine, np.array([0.0, SPEED, exact[0], SPEED, 0.0, 0.0]), 2.5 / TEETH)
    states = found.at(np.minimum(time_s, found.time_s[-1]))
    ahead = states[2] - machine.meshing.law.at(states[0])[0]
    assert found.energy_error < 1e-5
    assert ahead.min() == pytest.approx(exact.min(), rel=0.03)
    assert ahead.mean() == pytest.approx(exact.mean(), rel=0.02)
    assert np.sqrt(np.mean((ahead - exact) ** 2)) < 0.08 * abs(exact.mean())
    _, straight = swung(0.0, 1, damping, 2.5 / TEETH)
    assert abs(straight.min() / ahead.min() - 1.0) > 0.1


@pytest.mark.slow
@pytest.mark.parametrize("level", ["quasi_static", "dynamic"])
def test_teeth_that_hardly_advance_move_as_straight_teeth(run: Run, level: str) -> None:
    """In three sections whose teeth stand some hundredths of a millimetre apart."""
    text = HEAD.replace("face_width_mm: 10", "face_width_mm: 10, backlash_mm: 0.05") + "simulation: {turns: 0.2}\n"
    told = []
    for helix in ("", ", helix: {angle_deg: 0.2, kind: helical, hand: right}"):
        given = text.replace("backlash_mm: 0.05}", f"backlash_mm: 0.05{helix}}}")
        status, _, err = on_text(run, "simulate")(given, "--level", level, "--out", f"h{len(told)}")
        assert (status, err) == (0, "")
        told.append(simulated(f"h{len(told)}")["loaded_contact" if level == "quasi_static" else "motion_in_time"])
    keys = {
        "quasi_static": (
            "peak_tooth_force_n",
            "peak_depth_mm",
            "transmission_error_rad",
            "mean_pair_stiffness_n_per_mm",
        ),
        "dynamic": ("peak_pushing_force_n", "peak_back_force_n", "loss_of_teeth_j", "damping_n_s_mm"),
    }
    for key in keys[level]:
        assert told[1][key] == pytest.approx(told[0][key], rel=0.03), key
