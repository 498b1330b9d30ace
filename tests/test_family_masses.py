"""The three-segment family with masses: its samples and exact peaks against the balance of energy of all bodies."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import cache
from math import asin, pi

import numpy as np
import pytest

import ncgear.optimum.family as of_family
from ncgear.mechanisms.crank_slider import CrankSlider
from ncgear.mechanisms.forces import RodMasses
from ncgear.mechanisms.slider_load import SliderLoad
from ncgear.numerics.arrays import Array
from ncgear.numerics.sampled import shares
from ncgear.optimum.family import (
    RETURN_POINTS,
    SEGMENT_POINTS,
    FamilyOptimum,
    LawFamily,
    PeakGoal,
    best_of_family,
    sampled_laws,
    strokes_at,
)
from ncgear.optimum.task import Task
from ncgear.ratio.transmission import Lobes
from published import FIT, PRESS
from test_family import LINKAGES, OMEGA, baler_point

MASSES = RodMasses(
    slider_kg=90.0,
    rod_kg=22.0,
    rod_center_mm=41.0,
    rod_inertia_kg_mm2=9e5,
    crank_kg=35.0,
    crank_center_mm=-60.0,
    crank_inertia_kg_mm2=6e5,
    driven_inertia_kg_mm2=3e5,
    gravity_m_s2=(2.0, -9.5),
)
FRICTION_N = 150.0
LOAD = SliderLoad(PRESS.working, friction_n=FRICTION_N)

STEP_RAD = 1e-4
"""Step of the differences: the fourth power of its share of a law's narrowest feature, 0.01 rad, is 1e-8."""

CLOSE = 3e-6
"""Share of the peak by which samples may miss: their returns are closed to 1e-6."""


# --- energy ----------------------------------------------------------------------------------------------------------


def slope(function: Callable[[Array], Array], at: Array) -> Array:
    """The derivative by five points."""
    low, lower, upper, high = (function(at + k * STEP_RAD) for k in (-2, -1, 1, 2))
    found: Array = (low - high + 8.0 * (upper - lower)) / (12.0 * STEP_RAD)
    return found


def bodies(linkage: CrankSlider, masses: RodMasses, phi2: Array) -> dict[str, Array]:
    """Places of all centres in mm as complex numbers, and angles in rad."""
    reach = linkage.rod_mm - linkage.crank_mm
    crank = np.exp(1j * (pi + asin(linkage.offset_mm / reach) - phi2))
    pin = linkage.crank_mm * crank
    wrist = pin.real + np.sqrt(linkage.rod_mm**2 - (pin.imag - linkage.offset_mm) ** 2) + 1j * linkage.offset_mm
    rod = (wrist - pin) / linkage.rod_mm
    return {
        "slider": wrist,
        "rod": pin + masses.rod_center_mm * rod,
        "crank": masses.crank_center_mm * crank,
        "rod_angle": np.arcsin(rod.imag),
    }


def power_w(task: Task, driven_angle: Callable[[Array], Array], phi1: Array) -> Array:
    """What the driving shaft gives: the rise of all energy with time, and the work against the load."""
    linkage, masses, omega = task.linkage, task.masses, task.speed_rad_s
    assert isinstance(linkage, CrankSlider)
    assert isinstance(masses, RodMasses)

    def at(name: str) -> Callable[[Array], Array]:
        return lambda angle: bodies(linkage, masses, driven_angle(angle))[name]

    def energy_j(angle: Array) -> Array:
        speeds = {name: omega * np.abs(slope(at(name), angle)) for name in ("slider", "rod", "rod_angle")}
        kinetic = masses.slider_kg * speeds["slider"] ** 2 + masses.rod_kg * speeds["rod"] ** 2
        kinetic = kinetic + masses.rod_inertia_kg_mm2 * speeds["rod_angle"] ** 2
        turning = masses.crank_inertia_kg_mm2 + masses.driven_inertia_kg_mm2
        kinetic = kinetic + turning * (omega * slope(driven_angle, angle)) ** 2
        along, across = masses.gravity_m_s2
        weights = sum(
            kg * (along * at(name)(angle).real + across * at(name)(angle).imag)
            for name, kg in (("slider", masses.slider_kg), ("rod", masses.rod_kg), ("crank", masses.crank_kg))
        )
        found: Array = 1e-6 * kinetic / 2.0 - 1e-3 * weights
        return found

    x = at("slider")(phi1).real - np.sqrt((linkage.rod_mm - linkage.crank_mm) ** 2 - linkage.offset_mm**2)
    speed = omega * slope(lambda angle: at("slider")(angle).real, phi1)
    press = np.maximum(np.polyval(FIT[::-1], x), 0.0)
    against = np.where(speed > 0.0, press, 0.0) + FRICTION_N
    power: Array = omega * slope(energy_j, phi1) + 1e-3 * against * np.abs(speed)
    return power


# --- laws ------------------------------------------------------------------------------------------------------------


@cache
def family_of(name: str, *, inverse: bool, lobes: Lobes | None = None) -> LawFamily:
    """The family on a machine with masses."""
    return LawFamily(Task(LINKAGES[name], LOAD, OMEGA, lobes or Lobes(), MASSES), inverse)


def some_laws(family: LawFamily, count: int) -> list[tuple[Array, FamilyOptimum]]:
    """Random points of the family whose laws take least power, with the law of each whose return is the point's own."""
    points = np.random.default_rng(5).random((60, 7))
    found = sampled_laws(family, points).power.max(axis=1)
    chosen = points[np.argsort(found)[:count]]
    assert np.isfinite(found).sum() > count
    return [(point, of_family._made(family, point)[-1]) for point in chosen]


def driven_angle_of(optimum: FamilyOptimum) -> Callable[[Array], Array]:
    return lambda phi1: optimum.law.transmission.driven_angle(phi1).value


@pytest.mark.tiers(slow=["in line-True", "offset-False"], rest="long")
@pytest.mark.parametrize("inverse", [False, True])
@pytest.mark.parametrize("name", LINKAGES)
def test_sampled_power_is_that_of_the_energy(name: str, inverse: bool) -> None:
    """Where the motor drives; where it brakes, samples are zero."""
    family = family_of(name, inverse=inverse)
    braked = 0
    for point, optimum in some_laws(family, 4):
        assert optimum.constant is not None
        strokes, _ = strokes_at(family, point[None])
        theta2, theta3, theta4 = (float(getattr(strokes, f"theta{k}_rad")[0]) for k in (2, 3, 4))
        out, steady, slowing = (shares(count) for count in SEGMENT_POINTS)
        phi1 = np.concatenate(
            [
                theta2 * out,
                theta2 + (theta3 - theta2) * steady,
                theta4 - (theta4 - theta3) * slowing,
                theta4 + (2.0 * pi - theta4) * shares(RETURN_POINTS.count),
            ]
        )
        # Differences must not reach across a joint
        joints = np.array([0.0, theta2, theta3, theta4, 2.0 * pi])
        clear = np.abs(phi1[:, None] - joints).min(axis=1) > 5.0 * STEP_RAD
        exact = power_w(family.task, driven_angle_of(optimum), phi1[clear])
        found = sampled_laws(family, point[None]).power[0]
        assert found.size == phi1.size
        np.testing.assert_allclose(found[clear], np.maximum(exact, 0.0), rtol=0.0, atol=CLOSE * exact.max())
        braked += int(np.sum(exact < -0.01 * exact.max()))
    assert braked > 20


@pytest.mark.tiers(slow=["offset"], rest="long")
@pytest.mark.parametrize("name", LINKAGES)
def test_the_exact_peak_is_that_of_the_energy(name: str) -> None:
    for inverse in (False, True):
        family = family_of(name, inverse=inverse)
        for point, optimum in some_laws(family, 2):
            phi1 = np.linspace(0.0, 2.0 * pi, 20_001)
            joints = [piece.start_rad for piece in optimum.law.transmission.pieces] + [2.0 * pi]
            phi1 = phi1[np.abs(phi1[:, None] - np.array(joints)).min(axis=1) > 5.0 * STEP_RAD]
            highest = float(power_w(family.task, driven_angle_of(optimum), phi1).max())
            exact = optimum.peak(PeakGoal.POWER)
            # A peak at a joint is missed by up to five steps' rise
            assert highest * (1.0 - CLOSE) <= exact <= highest * 1.005
            samples = float(sampled_laws(family, point[None]).power.max())
            assert samples == pytest.approx(exact, rel=0.01)


def test_an_inertia_left_out_is_seen() -> None:
    """Negative control of the tests above: the gear's alone is a tenth of all that turns."""
    family = family_of("in line", inverse=True)
    lighter = replace(family, task=replace(family.task, masses=replace(MASSES, driven_inertia_kg_mm2=0.0)))
    ((point, optimum),) = some_laws(family, 1)
    whole, less = (sampled_laws(one, point[None]).power.max() for one in (family, lighter))
    assert abs(whole - less) > 100.0 * CLOSE * whole
    phi1 = np.linspace(0.1, 0.5, 50)
    exact = power_w(family.task, driven_angle_of(optimum), phi1)
    assert np.abs(power_w(lighter.task, driven_angle_of(optimum), phi1) - exact).max() > 100.0 * CLOSE * whole


def test_masses_that_weigh_nothing_take_no_power() -> None:
    """And the power of the resistance alone is that of the search without masses, the return's with it."""
    family = family_of("in line", inverse=False)
    nothing, none = (LawFamily(replace(family.task, masses=masses)) for masses in (RodMasses(), None))
    points = np.vstack([np.random.default_rng(2).random((20, 7)), baler_point()])
    ours, theirs = (sampled_laws(one, points).power for one in (nothing, none))
    possible = np.isfinite(theirs[:, 0])
    assert possible.sum() > 5
    np.testing.assert_allclose(ours[possible], theirs[possible], rtol=0.0, atol=1e-9 * theirs[possible].max())


@pytest.mark.long
@pytest.mark.slow
def test_the_best_law_keeps_the_cap_with_masses() -> None:
    """Its exact peak does; without masses another law is best, which does not."""
    task = Task(LINKAGES["in line"], LOAD, 2.0 * OMEGA, masses=MASSES)
    family, cap_w = LawFamily(task, inverse=True), 26_000.0
    best = best_of_family(family, PeakGoal.ACCELERATION, cap_w, starts=3)
    assert best.peak(PeakGoal.POWER) <= cap_w * (1.0 + 1e-6)
    phi1 = np.linspace(0.001, 2.0 * pi - 0.001, 5001)
    joints = np.array([piece.start_rad for piece in best.law.transmission.pieces])
    clear = phi1[np.abs(phi1[:, None] - joints).min(axis=1) > 5.0 * STEP_RAD]
    assert power_w(task, driven_angle_of(best), clear).max() <= cap_w * (1.0 + CLOSE)
    without = LawFamily(replace(task, masses=None), inverse=True)
    lighter = best_of_family(without, PeakGoal.ACCELERATION, cap_w, starts=3)
    assert power_w(task, driven_angle_of(lighter), clear).max() > 1.05 * cap_w
