"""What a warning says would mend it, does: the value that it tells is set in the file, and the warning is gone.

A value a little on the other side of a bound leaves the warning, so that none asks for more than it takes.
"""

from __future__ import annotations

import copy
import re
from typing import Any

import pytest

from drives import design_of
from ncgear.figures.advice.drivetrain_advice import around, motor
from ncgear.figures.advice.law_advice import crank_pin, rods
from ncgear.figures.advice.values import Advice
from ncgear.project.drive import Drive

Data = dict[str, Any]

PUMP: Data = {
    "name": "pump",
    "linkage": {"crank_mm": 60, "rod_mm": 220},
    "operation": {"speed_rpm": 30},
    "motion": {"law": "harmonic_ratio", "cosine": [-0.2]},
    "gears": {
        "teeth": 48,
        "module_mm": 1.5,
        "face_width_mm": 12,
        # Whose friction is not followed, which takes the time of a test
        "helix": {"angle_deg": 15, "kind": "herringbone", "hand": "right"},
        "backlash_mm": 0.05,
        "driving": {"bore_mm": 10, "keyway": {"width_mm": 3, "depth_mm": 1.4}},
        "driven": {"bore_mm": 10, "keyway": {"width_mm": 3, "depth_mm": 1.4}},
    },
    "resistance": {"polynomial_n": [50]},
    "masses": {
        "slider_kg": 2,
        "driving_gear_kg_mm2": 500,
        "driven_gear_kg_mm2": 500,
        "rod": {"mass_kg": 1, "center_mm": 50, "inertia_kg_mm2": 1000},
        "crank": {"mass_kg": 1, "center_mm": 0, "inertia_kg_mm2": 100},
    },
}


def of(drivetrain: Data) -> Data:
    return {**PUMP, "drivetrain": drivetrain}


def with_value(data: Data, key: str, value: object) -> Data:
    made = copy.deepcopy(data)
    *path, last = key.split(".")
    place = made
    for part in path:
        place = place.setdefault(part, {})
    place[last] = value
    return made


TOLD = re.compile(r"^([\w.]+): ([\d.]+|\w+)")


def told(advice: Advice) -> tuple[str, object]:
    """The key and the value that the first remedy of a warning tells."""
    found = TOLD.match(advice.remedies[0].brief)
    assert found is not None, advice.remedies
    key, value = found.groups()
    return key, float(value) if value[0].isdigit() else {"false": False}.get(value, value)


def drivetrain(data: Data, words: str) -> list[Advice]:
    drive = Drive(design_of(data))
    found = [*around(drive), *(motor(drive) if drive.design.drivetrain.motor else ())]
    return [one for one in found if isinstance(one, Advice) and words in one.what]


BALL = {"at_mm": -20, "dynamic_rating_n": 60}
SHAFT = {"bearing_a": BALL, "bearing_b": {"at_mm": 25, "static_rating_n": 5}}
MOTOR = {"rated_torque_n_m": 0.5, "rated_speed_rpm": 28, "no_load_speed_rpm": 30}

BOUNDS = {
    "lasts": {"driving_shaft": SHAFT},
    "half its dynamic load rating": {"driving_shaft": SHAFT},
    "dented": {"driven_shaft": SHAFT},
    "the key of": {"driven_shaft": {**SHAFT, "steel": "S355", "key": {"length_mm": 0.04}}},
    "r.m.s.": {"motor": {"rated_torque_n_m": 0.001, "rated_speed_rpm": 1000}},
    "gives up to": {"motor": {"rated_torque_n_m": 2.0, "peak_torque_n_m": 2.1, "rated_speed_rpm": 1000}},
    "limiter slips": {"pto": {"torque_limiter_n_m": 0.5}},
}


@pytest.mark.tiers(
    long=["lasts", "dented", "the key of", "r.m.s.", "gives up to", "limiter slips", "half its*"], rest="slow"
)
@pytest.mark.parametrize("words", BOUNDS)
def test_the_bound_that_is_told_is_enough_and_not_much_more(words: str) -> None:
    data = of(BOUNDS[words])
    (warning,) = drivetrain(data, words)
    key, value = told(warning)
    assert isinstance(value, float)
    assert drivetrain(with_value(data, key, value), words) == []
    assert len(drivetrain(with_value(data, key, 0.998 * value), words)) == 1


@pytest.mark.slow
@pytest.mark.parametrize(("ratio", "told_so"), [(40.0, False), (50.0, True)])
def test_a_motor_faster_than_it_gives_its_torque_is_told(ratio: float, told_so: bool) -> None:
    data = of({"motor": {"rated_torque_n_m": 5, "rated_speed_rpm": 1300, "gearbox": {"ratio": ratio}}})
    found = drivetrain(data, "faster than")
    assert len(found) == told_so
    for warning in found:
        assert drivetrain(with_value(data, *told(warning)), "faster than") == []


@pytest.mark.tiers(slow=["runs at"], rest="long")
@pytest.mark.parametrize("words", ["r.m.s.", "runs at"])
def test_a_motor_of_falling_torque_runs_as_is_told(words: str) -> None:
    gearbox = {"ratio": 1.2} if words == "runs at" else {}
    data = of({"motor": {**MOTOR, "gearbox": gearbox, "rated_torque_n_m": 6.0 if gearbox else 0.8}})
    (warning,) = drivetrain(data, words)
    assert drivetrain(with_value(data, *told(warning)), words) == []


@pytest.mark.parametrize("fit", [None, {"driving_shaft": "through"}])
def test_a_shaft_that_is_said_to_end_below_is_met_no_more(fit: Data | None) -> None:
    """Also where the file says that it goes through: then it is words, since a person has asked for it."""
    data = {**PUMP, **({"fit": fit} if fit else {}), "linkage": {"crank_mm": 70, "rod_mm": 220}}

    def met(given: Data) -> list[Advice]:
        drive = Drive(design_of(given))
        return [one for one in (*rods(drive), *crank_pin(drive)) if isinstance(one, Advice)]

    assert len(met(data)) == 2
    for warning in met(data):
        assert bool(warning.remedies[0].changes) == (fit is None)
        assert met(with_value(data, *told(warning))) == []
