"""Studies of the levels of simulation: what each leaves out, and that the reference tells it."""

from __future__ import annotations

import pytest

from speed_against_error.simulation import ENOUGH_RAD, Simulated

pytestmark = pytest.mark.slow


@pytest.mark.long
def test_each_level_leaves_out_less() -> None:
    simulated = Simulated("baler-half-dynamics")
    errors = [simulated.error_rad(found) for found in (simulated.rigid(), simulated.quasi_static())]
    in_time = [simulated.error_rad(simulated.dynamic(accuracy)) for accuracy in (1e-5, 1e-7)]
    assert 1e-4 < errors[0] < 4e-4
    assert 1e-5 < errors[1] < 0.5 * errors[0]
    assert in_time[0] < 0.5 * errors[1]
    assert in_time[1] <= ENOUGH_RAD
    planted = simulated.exact_rad + 1e-5
    assert simulated.error_rad(planted) == pytest.approx(1e-5, rel=1e-9)


@pytest.mark.long
def test_the_reference_is_right_by_another_method() -> None:
    simulated = Simulated("baler-half-dynamics")
    assert simulated.error_rad(simulated.dynamic(1e-9)) <= 1e-8
