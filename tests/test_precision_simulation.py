"""Studies of the levels of simulation: what each leaves out, and that the reference tells it."""

from __future__ import annotations

import pytest

from ncgear.errors import WrongInput
from ncgear.precision import simulation
from ncgear.precision.catalogue import made

pytestmark = pytest.mark.slow


def test_each_level_leaves_out_less() -> None:
    simulated = simulation.Simulated("baler-half")
    errors = [simulated.error_rad(found) for found in (simulated.rigid(0), simulated.quasi_static(0))]
    in_time = [simulated.error_rad(simulated.dynamic("LSODA", accuracy)) for accuracy in (1e-5, 1e-7)]
    assert 5e-4 < errors[0] < 2e-3
    assert 5e-5 < errors[1] < 0.5 * errors[0]
    assert in_time[0] < 0.5 * errors[1]
    assert in_time[1] <= simulation.ENOUGH_RAD
    planted = simulated.exact_rad + 1e-5
    assert simulated.error_rad(planted) == pytest.approx(1e-5, rel=1e-9)


def test_the_reference_is_right_by_another_method() -> None:
    simulated = simulation.Simulated("baler-half")
    assert simulated.error_rad(simulated.dynamic("LSODA", 1e-10)) <= 1e-8


def test_without_the_designs_a_study_is_left_out_by_name(monkeypatch: pytest.MonkeyPatch, tmp_path) -> None:
    monkeypatch.setattr(simulation, "DESIGNS", tmp_path)
    studies, left_out = made([])
    assert not [study for study in studies if study.key.startswith("simulation")]
    assert [reason.split()[0] for reason in left_out] == ["simulation-baler", "simulation-half"]
    with pytest.raises(WrongInput, match="source tree"):
        made(["simulation-half"])
