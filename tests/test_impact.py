"""Law of impact and friction against closed forms, and what no contact may do."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from at_once import at_once
from loaded import FRICTION, IMPACT, STIFFNESS
from ncgear.dynamics.meshing import Friction, Impact

DEPTH = np.linspace(-0.05, 0.3, 351)
ELASTIC = IMPACT.elastic_n(DEPTH, STIFFNESS)


@at_once("rate", [-1e4, -10.0, 0.0, 10.0])
def test_bodies_never_pull_and_damping_never_gives(rate: float) -> None:
    damped = IMPACT.damping(DEPTH) * rate
    assert np.all(IMPACT.force_n(ELASTIC, damped) >= 0.0)
    assert np.all(IMPACT.force_n(ELASTIC, damped)[DEPTH <= 0.0] == 0.0)
    assert np.all(IMPACT.loss_n_mm_s(ELASTIC, damped, np.full_like(DEPTH, rate)) >= 0.0)


def test_the_elastic_force_is_the_slope_of_its_energy() -> None:
    step, depth = 1e-6, DEPTH[DEPTH > 1e-3]
    slope = (IMPACT.energy_n_mm(depth + step, STIFFNESS) - IMPACT.energy_n_mm(depth - step, STIFFNESS)) / (2.0 * step)
    np.testing.assert_allclose(slope, IMPACT.elastic_n(depth, STIFFNESS), rtol=1e-6)


@pytest.mark.parametrize("rate", [-1e4, -10.0, 3.0])
def test_what_the_force_takes_beyond_the_elastic_one_is_lost(rate: float) -> None:
    damped = IMPACT.damping(DEPTH) * rate
    beyond = IMPACT.force_n(ELASTIC, damped) - ELASTIC
    np.testing.assert_allclose(
        IMPACT.loss_n_mm_s(ELASTIC, damped, np.full_like(DEPTH, rate)), beyond * rate, rtol=1e-12
    )


def test_damping_rises_to_its_full_value_over_the_depth() -> None:
    assert IMPACT.damping(np.array([-1.0, 0.0, 0.05, 0.1, 1.0])).tolist() == [0.0, 0.0, 50.0, 100.0, 100.0]


def test_a_ball_without_damping_bounces_back_as_fast() -> None:
    """One kilogram at 100 mm/s onto a wall: the depth of return from m v^2 / 2 = k d^(n + 1) / (n + 1)."""
    hard = Impact(2.2, 0.0, 0.1)
    out = solve_ivp(
        lambda _, y: [y[1], -1e3 * float(hard.force_n(hard.elastic_n(y[0], STIFFNESS), hard.damping(y[0]) * y[1]))],
        (0.0, 0.01),
        [0.0, 100.0],
        rtol=1e-10,
        atol=1e-12,
    )
    assert out.y[1, -1] == pytest.approx(-100.0, rel=1e-7)
    deepest = ((2.2 + 1.0) * 0.5 * 1e-3 * 100.0**2 / 5e5) ** (1.0 / 3.2)
    assert out.y[0].max() == pytest.approx(deepest, rel=1e-2)


def test_friction_goes_from_rest_over_the_static_to_the_dynamic_coefficient() -> None:
    speeds = np.array([-1e3, -1.0, 0.0, 0.5, 1.0, 10.0, 1e3])
    expected = [-0.05, -0.08, 0.0, 0.04, 0.08, 0.05, 0.05]
    np.testing.assert_allclose(FRICTION.coefficient(speeds), expected, atol=1e-15)


def test_friction_is_smooth() -> None:
    speed = np.linspace(-12.0, 12.0, 240_001)
    slope = np.diff(FRICTION.coefficient(speed)) / np.diff(speed)
    assert np.abs(np.diff(slope)).max() < 1e-4
    assert not Friction(0.0, 0.0, 1.0, 10.0).coefficient(speed).any()
