"""Sweeps around the turn: slopes beside the machine's figures written out by hand, limits in closed form on a yoke."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from math import cos, inf, pi, sin, sqrt
from typing import Any

import numpy as np
import pytest

from drives import drive_of_text
from ncgear.kinematics.crank_stretches import CrankStretch
from ncgear.optimum.certified.demands import Demands, WishDemand
from ncgear.optimum.certified.sweeps import Sweeps, SweptLimits, least_flank_load, least_power
from ncgear.optimum.task import Task
from ncgear.project.law_task import inertia_as_given, task_of
from ncgear.whole_machines.laws import law_design
from ncgear.wishes.requirements import TimeWithin

pytestmark = pytest.mark.judges("optimum")

RADIUS, SPEED = 100.0, 2.0 * pi
FORCE_N, SLIDER_KG, CRANK_KG_MM2 = 500.0, 5.0, 40_000.0

YOKE = f"""\
name: yoke
linkage: {{kind: scotch_yoke, crank_mm: 100}}
operation: {{speed_rpm: 60}}
motion: {{law: uniform_crank}}
gears: {{teeth: 40, module_mm: 3, face_width_mm: 20}}
resistance: {{polynomial_n: [{FORCE_N}]}}
"""
MASSES = f"""\
masses:
  slider_kg: {SLIDER_KG}
  crank: {{mass_kg: 0, center_mm: 0, inertia_kg_mm2: {CRANK_KG_MM2}}}
  driving_gear_kg_mm2: 0
  driven_gear_kg_mm2: 0
"""


@cache
def task(masses: bool) -> Task:
    design = law_design(drive_of_text(YOKE + MASSES * masses).design)
    found = task_of(design, inertia_as_given(design))
    return found if masses else replace(found, masses=None)


def limits(count: int = 1, flywheel: tuple[float, float] = (0.0, 0.0), **given: Any) -> SweptLimits:
    free = {"flank_load_n_mm": np.full(count, inf), "power_w": np.full(count, inf)} | given
    return SweptLimits(flywheel_kg_mm2=np.repeat(np.array(flywheel)[:, None], count, axis=1), **free)


def kept(sweeps: Sweeps, asked: SweptLimits, at: tuple[int, int], q: float, rate: np.ndarray, wheel: float) -> Any:
    """Whether the machine's figures keep all limits at a crank angle, for some slopes of q, by hand.

    The yoke's slider is at r (1 - cos phi); all that turns and slides has J = I + m x'^2.
    """
    cell, node = at
    ends, demands = sweeps.known.ends_rad, sweeps.asked
    phi = ends[cell] + (ends[cell + 1] - ends[cell]) * (0.0, 0.5, 1.0)[node]
    first, second, s = RADIUS * sin(phi), RADIUS * cos(phi), sqrt(q)
    acceleration = SPEED**2 * (second * q + first * rate / 2.0)
    against_n = FORCE_N if first > 0.0 else 0.0
    inertia = CRANK_KG_MM2 + wheel + SLIDER_KG * first**2
    torque = against_n * first + 1e-3 * SPEED**2 * (SLIDER_KG * first * second * q + inertia * rate / 2.0)
    power = torque * s * SPEED / 1000.0
    fine = (np.abs(acceleration) <= demands.acceleration_mm_s2) & (power <= asked.power_w[0])
    fine &= (-power <= demands.braking_w) & (np.abs(rate) <= 2.0 * s * demands.steepness * (1.0 + s))
    if asked.flank_load_n_mm[0] == inf:
        return fine
    for sign, angle in zip((1.0, -1.0), sweeps.angles, strict=True):
        room = s * cos(angle) + sign * rate * sin(angle) / (2.0 * (1.0 + s))
        fine &= sign * torque * (1.0 + s) ** 3 <= asked.flank_load_n_mm[0] * room
    return fine


@pytest.mark.parametrize(
    ("demands", "load"),
    [
        ({"acceleration_mm_s2": 5000.0}, {}),
        ({"steepness": 0.5}, {}),
        ({"braking_w": 150.0}, {"power_w": 400.0}),
        ({"steepness": 2.0}, {"flank_load_n_mm": 4e5}),
        ({"acceleration_mm_s2": 6000.0, "braking_w": 100.0}, {"power_w": 500.0, "flank_load_n_mm": 6e5}),
    ],
)
def test_slopes_are_those_with_which_the_machine_keeps_its_limits(
    demands: dict[str, float], load: dict[str, float]
) -> None:
    asked = limits(**{name: np.array([value]) for name, value in load.items()})
    sweeps = Sweeps(task(True), Demands(ratio_min=0.2, ratio_max=5.0, **demands), 24)
    rate = np.linspace(-30.0, 30.0, 60_001)
    judged = 0
    for at in ((1, 1), (4, 0), (8, 2), (14, 1), (19, 1), (22, 0)):
        for q in (0.5, 1.3):
            least, most = (float(one[0]) for one in sweeps.slopes(asked, at, np.array([q])))
            fine = rate[kept(sweeps, asked, at, q, rate, 0.0)]
            if fine.size:
                judged += 1
                assert max(least, -30.0) == pytest.approx(fine[0], abs=0.003)
                assert min(most, 30.0) == pytest.approx(fine[-1], abs=0.003)
            else:
                assert least > most
            # Of a range of flywheels a slope is possible that one of them lets be
            wide = replace(asked, flywheel_kg_mm2=np.array([[0.0], [90_000.0]]))
            low, high = (float(one[0]) for one in sweeps.slopes(wide, at, np.array([q])))
            for wheel in (0.0, 30_000.0, 90_000.0):
                own = rate[kept(sweeps, asked, at, q, rate, wheel)]
                assert own.size == 0 or (low <= own[0] + 0.003 and own[-1] - 0.003 <= high)
    assert judged > 5


def test_the_greatest_ratio_leaves_an_acceleration_and_a_speed() -> None:
    """The crank turns no slower than w over it: r w^2 over its square at the dead centre, r w over it in the middle."""
    slow = SPEED / 1.05
    for name, least in (("acceleration_mm_s2", RADIUS * slow**2), ("speed_mm_s", RADIUS * slow)):
        for share, possible in ((0.99, False), (1.01, True)):
            asked = Demands(ratio_min=0.02, ratio_max=1.05, **{name: share * least})
            assert Sweeps(task(False), asked, 24).possible(limits()).tolist() == [possible]


def test_the_least_peak_acceleration_is_even() -> None:
    """Two even accelerations take the slider over its stroke 2 r in half a turn: 4 (2 r)/(T/2)^2 with T = 1 s."""
    for share, possible in ((0.97, False), (1.001, True)):
        asked = Demands(0.02, 50.0, acceleration_mm_s2=share * 32.0 * RADIUS)
        assert Sweeps(task(False), asked, 48).possible(limits()).tolist() == [possible]


def test_a_crank_of_even_speed_needs_its_acceleration() -> None:
    """A crank that may not change its speed needs r w^2; a little more lets it be."""
    for fastest in (0.5, 0.52):
        for share, possible in ((0.9995, False), (1.0005, True)):
            asked = Demands(fastest, 2.0, steepness=1e-7, acceleration_mm_s2=share * RADIUS * SPEED**2)
            assert Sweeps(task(False), asked, 24).possible(limits()).tolist() == [possible]


@pytest.mark.tiers(thorough=["1e-09"], rest="slow")
@pytest.mark.parametrize("masses", [0.0, 1e-9, 1e-4])
def test_least_power_against_an_even_force_is_the_mean_power(masses: float) -> None:
    """Without masses the power of the working stroke may be even: the work F 2 r of a second, and a quick return.

    Next to no masses change next to nothing, although slopes within cells are as great as they are small.
    """
    own = task(False)
    if masses:
        own = replace(own, masses=own.linkage.MASSES(slider_kg=masses * SLIDER_KG))
    sweeps = Sweeps(own, Demands(ratio_min=0.02, ratio_max=50.0), 90)
    mean_w = FORCE_N * 2.0 * RADIUS / 1000.0
    found = least_power(sweeps, np.zeros((2, 2)), np.array([2.0 * mean_w, 2.5 * mean_w]))
    assert np.all(found > 0.93 * mean_w)
    assert np.all(found < 1.01 * mean_w)


def test_a_stretch_takes_its_share_of_the_least_ratio_at_least() -> None:
    """At the least ratio 1/2 a rad of the crank takes half a rad; at the greatest a whole turn takes too long."""
    for most_rad, possible in ((0.49, False), (0.52, True)):
        wish = WishDemand("wishes.dwell.0", TimeWithin(CrankStretch(5.8, 6.8), most_rad=most_rad))
        sweeps = Sweeps(task(False), Demands(ratio_min=0.5, ratio_max=2.0, wishes=(wish,)), 40)
        assert sweeps.possible(limits(3)).tolist() == [possible] * 3
    for least in (0.99, 1.01):
        sweeps = Sweeps(task(False), Demands(ratio_min=least, ratio_max=5.0), 40)
        assert sweeps.possible(limits()).tolist() == [least < 1.0]


@pytest.mark.thorough
def test_the_flank_load_of_an_even_crank_is_not_under_the_limit() -> None:
    """On an even crank M (1 + s)^3 = 8 F r is pressed at cos(alpha) by a flank load of 8 F r / cos(alpha)."""
    sweeps = Sweeps(task(False), Demands(ratio_min=0.5, ratio_max=2.0), 60)
    even = 8.0 * FORCE_N * RADIUS / cos(sweeps.angles[0])
    found = least_flank_load(sweeps, np.array([inf]), np.zeros((2, 1)), np.array([even]), 0.1)
    assert 0.2 * even < found[0] < even
