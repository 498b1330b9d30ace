"""Loaded contact against closed forms on circular gears, and against energy on others."""

from __future__ import annotations

from dataclasses import replace
from math import cos, log2, pi, radians

import numpy as np
import pytest

from engaged import MODULE
from loaded import SMOOTH, STIFFNESS, frictionless, meshing, uneven_meshing
from ncgear.dynamics.meshing import Friction, Impact, TwoShafts
from ncgear.dynamics.quasi_static import LoadedContact, loaded_contact, loaded_peaks
from ncgear.errors import NoSuchMechanism

BASE = 12.0 * MODULE * cos(radians(20.0))
ANGLES = np.linspace(0.0, 2.0 * pi, 1501)
PAIRS = [("uniform", 24), ("sine", 31), ("baler", 25)]


@pytest.mark.slow
def test_circular_gears_give_way_by_the_closed_form() -> None:
    """N pairs share T: the depth is (T / (N k r))^(1/n) and the angle that over the base radius r."""
    found = frictionless(meshing("uniform", 24))
    torque = np.full_like(ANGLES, 50.0)
    loaded = loaded_contact(found, ANGLES, torque, 0.0)
    near = found.gaps.at(ANGLES)
    gap = np.where(near.urge > 0.0, -near.error_rad * near.lever_mm, np.inf)
    pairs = np.sum(gap < 1e-12, axis=-1)
    depth = (50.0 / (pairs * STIFFNESS * BASE)) ** (1.0 / found.impact.exponent)
    # Corners that come as near as flanks are deep bear some of the load: there the closed form does not hold, nor where
    # the lever is on its way from a flank's to a corner's.
    free = ~np.any((gap > 1e-12) & (gap < 1.05 * depth[:, None]), axis=-1)
    alone = free & np.all((gap > 1e-12) | (np.abs(near.slopes[1]) < 1e-9), axis=-1)
    assert alone.sum() > 1200
    np.testing.assert_allclose(loaded.error_rad[alone], -depth[alone] / BASE, rtol=1e-7)
    assert set(np.unique(pairs[alone])) == {1, 2}
    np.testing.assert_array_equal(loaded.pairs[alone], pairs[alone])


@pytest.mark.parametrize("share", [1e-3, 1e-6, 1e-9])
def test_a_share_of_the_load_has_that_share_of_the_torque(share: float) -> None:
    """Without backlash, where flanks of both sides touch; negative control: both bear, at driven angles from the law.

    That is how a motion in time has it, and at a billionth of the load rounding errors of these angles show.
    """
    angles = np.linspace(0.0, 1.0, 61)
    found, torque = replace(meshing("sine", 31), impact=Impact(1.0, 0.0, 0.01)), np.full_like(angles, 2e3)
    whole, little = (loaded_contact(found, angles, load, 2.0) for load in (torque, share * torque))
    np.testing.assert_allclose(little.driving_torque_n_mm, share * whole.driving_torque_n_mm, rtol=0.02)
    np.testing.assert_allclose(little.forces.driven_n_mm.sum(axis=-1), share * torque, rtol=1e-5)
    assert np.all(little.pairs >= 1)
    angle, ratio = found.law.at(angles)
    both = -found.forces(TwoShafts(angles, 2.0, angle + little.error_rad, 2.0 * ratio)).driving_n_mm.sum(axis=-1)
    assert (np.abs(both / little.driving_torque_n_mm - 1.0).max() > 0.5) == (share < 1e-6)


@pytest.mark.slow
@pytest.mark.parametrize(("name", "teeth"), PAIRS)
def test_the_teeth_bring_the_torque(name: str, teeth: int) -> None:
    torque = 2e4 * np.sin(3.0 * ANGLES)
    loaded = loaded_contact(meshing(name, teeth), ANGLES, torque, 2.0)
    np.testing.assert_allclose(loaded.forces.driven_n_mm.sum(axis=-1), torque, atol=2e4 * 1e-9)
    pushed = np.sum(np.where(loaded.forces.near.urge > 0.0, loaded.forces.normal_n, 0.0), axis=-1)
    held = np.sum(np.where(loaded.forces.near.urge < 0.0, loaded.forces.normal_n, 0.0), axis=-1)
    assert np.all(pushed[torque > 100.0] > held[torque > 100.0])
    assert np.all(pushed[torque < -100.0] < held[torque < -100.0])


@pytest.mark.tiers(slow=["uniform-24", "baler-25"], rest="long")
@pytest.mark.parametrize(("name", "teeth"), PAIRS)
def test_without_friction_the_drive_puts_in_what_the_load_takes(name: str, teeth: int) -> None:
    """What the contact stores is given back over a turn: the work of both torques is the same."""
    angles = np.linspace(0.0, 2.0 * pi, 5001)
    torque = 2e4 * (1.5 + np.cos(angles))
    found = frictionless(meshing(name, teeth))
    loaded = loaded_contact(found, angles, torque, 0.0)
    driven = found.law.at(angles)[0] + loaded.error_rad
    taken = np.sum((torque[1:] + torque[:-1]) / 2.0 * np.diff(driven))
    given = np.sum((loaded.driving_torque_n_mm[1:] + loaded.driving_torque_n_mm[:-1]) / 2.0 * np.diff(angles))
    assert given == pytest.approx(taken, rel=2e-5)


@pytest.mark.long
@pytest.mark.slow
@pytest.mark.parametrize(("name", "teeth"), PAIRS)
def test_pairs_that_get_stiffer_and_softer_on_their_way_take_and_give_no_work(name: str, teeth: int) -> None:
    """The work of both torques is the same over a turn; without what the change of stiffness does it would not be."""
    angles = np.linspace(0.0, 2.0 * pi, 20_001)
    torque = 2e5 * (1.5 + np.cos(angles))
    found = frictionless(uneven_meshing(name, teeth))
    loaded = loaded_contact(found, angles, torque, 0.0)

    def worked(moment: np.ndarray, angle: np.ndarray) -> float:
        return float(np.sum((moment[1:] + moment[:-1]) / 2.0 * np.diff(angle)))

    taken = worked(torque, found.law.at(angles)[0] + loaded.error_rad)
    given = worked(loaded.driving_torque_n_mm, angles)
    assert given == pytest.approx(taken, rel=1e-6)
    depth = np.maximum(loaded.forces.depth_mm, 0.0)
    stiffening = np.sum(loaded.forces.near.slopes[2] * depth**2 / 2.0, axis=-1)
    assert given - worked(stiffening, angles) != pytest.approx(taken, rel=1e-5)


@pytest.mark.tiers(slow=["uniform-24-300.0"], rest="long")
@pytest.mark.parametrize(("name", "teeth", "torque_n_mm"), [("uniform", 24, 300.0), ("sine", 31, 2e4)])
def test_most_pairs_are_found_between_angles_that_all_see_fewer(name: str, teeth: int, torque_n_mm: float) -> None:
    found = frictionless(meshing(name, teeth))

    def loaded_at(phi1: np.ndarray) -> LoadedContact:
        return loaded_contact(found, phi1, np.full_like(phi1, torque_n_mm), 0.0)

    seen = loaded_at(ANGLES).pairs
    fewer = ANGLES[seen < seen.max()]
    sampled = int(loaded_at(fewer).pairs.max())
    assert sampled < seen.max()
    assert loaded_peaks(loaded_at, fewer, sampled).most_pairs == loaded_at(np.linspace(0.0, 2.0 * pi, 3001)).pairs.max()


@pytest.mark.slow
def test_friction_costs_work() -> None:
    torque = np.full_like(ANGLES, 2e4)
    smooth, rough = (
        loaded_contact(replace(meshing("uniform", 24), friction=friction), ANGLES, torque, 2.0)
        for friction in (SMOOTH, Friction(0.08, 0.05, 1.0, 10.0))
    )
    efficiency = smooth.driving_torque_n_mm[:-1].mean() / rough.driving_torque_n_mm[:-1].mean()
    # Circular gears of 24 teeth lose about pi mu (1/z1 + 1/z2) e, with e near 0.7 for a contact ratio of 1.6.
    assert 1.0 - efficiency == pytest.approx(pi * 0.05 * (2.0 / 24.0) * 0.7, rel=0.25)


@pytest.mark.slow
def test_the_rigid_limit_is_reached_as_the_stiffness_to_the_power_of_minus_one_over_the_exponent() -> None:
    torque = np.full_like(ANGLES, 100.0)
    errors = [
        np.median(np.abs(loaded_contact(frictionless(meshing("sine", 31), stiffness=k), ANGLES, torque, 0.0).error_rad))
        for k in (1e6, 1e8, 1e10)
    ]
    rates = np.diff(np.log10(errors)) / 2.0
    np.testing.assert_allclose(rates, -1.0 / 2.2, rtol=0.02)


@pytest.mark.thorough
def test_without_torque_the_teeth_just_touch() -> None:
    found = meshing("sine", 31, backlash_mm=0.1)
    loaded = loaded_contact(found, ANGLES, np.zeros_like(ANGLES), 2.0)
    assert loaded.tooth_force_n.max() < 1e-20
    np.testing.assert_array_equal(loaded.error_rad, found.gaps.play_rad(ANGLES)[0])


@pytest.mark.thorough
@pytest.mark.parametrize("torque_n_mm", [1e-3, 1e-7, 1e-11])
def test_torques_next_to_nothing_are_borne(torque_n_mm: float) -> None:
    """Depth and force are then below the rounding errors of the driven angle, whose shares of the torque are large."""
    found = meshing("sine", 31, backlash_mm=0.1)
    loaded = loaded_contact(found, ANGLES[::7], np.full(ANGLES[::7].size, torque_n_mm), 2.0)
    touching = found.gaps.play_rad(ANGLES[::7])[0]
    deepest = (torque_n_mm / (STIFFNESS * 0.9 * BASE)) ** (1.0 / found.impact.exponent)
    np.testing.assert_allclose(loaded.error_rad, touching, atol=2.0 * deepest / BASE)


@pytest.mark.slow
def test_a_reversed_torque_takes_the_play_up() -> None:
    found = meshing("uniform", 24, backlash_mm=0.1)
    ahead, behind = (
        loaded_contact(found, ANGLES, np.full_like(ANGLES, torque), 0.0).error_rad for torque in (-10.0, 10.0)
    )
    assert np.median(ahead - behind) > 0.1 / BASE
    assert np.median(ahead - behind) == pytest.approx(0.1 / BASE, rel=0.05)


@pytest.mark.tiers(slow=["1.0", "3.0"], rest="long")
@pytest.mark.parametrize("exponent", [1.0, 1.5, 3.0])
def test_a_stiffer_law_of_impact_gives_way_less(exponent: float) -> None:
    torque = np.full_like(ANGLES, 2e4)
    soft, hard = (
        np.abs(
            loaded_contact(
                frictionless(meshing("baler", 25), stiffness=k, exponent=exponent), ANGLES, torque, 0.0
            ).error_rad
        )
        for k in (1e6, 1e7)
    )
    assert np.all(hard < soft)
    assert log2(np.median(soft / hard)) == pytest.approx(log2(10.0) / exponent, rel=0.3)


@pytest.mark.slow
def test_teeth_pressed_too_deep_are_refused() -> None:
    with pytest.raises(NoSuchMechanism, match="deeper than their teeth can be followed") as caught:
        loaded_contact(meshing("uniform", 24), ANGLES, np.full_like(ANGLES, 1e9), 0.0)
    # The teeth's own stiffness is that of their width; a given one has a key of its own.
    assert caught.value.key == "gears.face_width_mm"
    given = replace(meshing("uniform", 24), stiffness_key="simulation.stiffness_n_mm")
    with pytest.raises(NoSuchMechanism, match="a greater stiffness or less load is needed") as caught:
        loaded_contact(given, ANGLES, np.full_like(ANGLES, 1e9), 0.0)
    assert caught.value.key == "simulation.stiffness_n_mm"


@pytest.mark.thorough
def test_friction_that_locks_the_teeth_is_refused() -> None:
    locked = replace(meshing("baler", 25), friction=Friction(9.0, 9.0, 1.0, 10.0))
    with pytest.raises(NoSuchMechanism, match="friction holds them"):
        loaded_contact(locked, ANGLES, np.full_like(ANGLES, 1e3), 2.0)


@pytest.mark.long
@pytest.mark.slow
def test_peaks_of_a_load_next_to_nothing_are_not_sought_in_rounding_errors() -> None:
    """No more places than of a load that presses the teeth by micrometres."""

    def places(torque_n_mm: float) -> int:
        looked_at: list[int] = []

        def loaded_at(phi1: np.ndarray) -> LoadedContact:
            looked_at.append(phi1.size)
            return loaded_contact(found, phi1, np.full(phi1.size, torque_n_mm), 2.0)

        peaks = loaded_peaks(loaded_at, ANGLES[::40], 1)
        assert peaks.depth_mm.value >= 0.0
        return sum(looked_at)

    found = meshing("sine", 31, backlash_mm=0.1)
    assert places(1e-9) <= 2 * places(1e4)
