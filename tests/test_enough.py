"""What a refusal says is enough is tried out: with less there is no law, with the value of a law that was found, one.

Designs of ``designs/`` with other keys, as a user would ask.
"""

from __future__ import annotations

import json
import re
from collections.abc import Mapping
from copy import deepcopy
from pathlib import Path
from typing import Any, NamedTuple

import pytest

from drives import loaded
from ncgear.design.reading.design_file import parsed
from ncgear.errors import NoSuchMechanism
from ncgear.kinematics.motion import Machine
from ncgear.optimum.certified.refusals import EASED
from ncgear.project.best_law import BestLaw
from tiers import long_but

pytestmark = pytest.mark.slow

ROOM = 5e-3
"""How much more than the value of a law of few knots is asked for: the search is a local one."""

LESS = 0.01
"""How much less than certainly needed is asked for."""

Keys = Mapping[str, Any]
LIMITS, GOAL = "optimize.limits.", "optimize.goal"
NO_WISHES: Keys = {"wishes.constant_speed": [], "wishes.time_ratio": None, "wishes.dwell": [], "wishes.speed_at": []}


class Refused(NamedTuple):
    """A design with other keys, and what its refusal says is enough.

    ``key`` is the one that is asked for again, a list's first member with a 0; ``certain`` and ``found`` have one
    number each, the least that can be enough and that of a law, which may be ``dearer`` by this share at most.
    ``named`` is the key that the refusal names, where it is another.
    """

    design: str
    keys: Keys
    key: str
    certain: str
    found: str
    dearer: float
    named: str = ""


def design_of(name: str, keys: Keys) -> BestLaw:
    data = deepcopy(dict(loaded(name).data))
    for key, value in keys.items():
        *groups, last = key.split(".")
        group: Any = data
        for one in groups:
            group = group[int(one)] if isinstance(group, list) else group.setdefault(one, {})
        if value is None:
            group.pop(last, None)
        else:
            group[last] = deepcopy(value)
    if keys.get(GOAL, "weighted") != "weighted":
        data["optimize"].pop("weights", None)
    return BestLaw(parsed(json.dumps(data), Path("d.yaml")).design)


def refusal(name: str, keys: Keys) -> NoSuchMechanism:
    with pytest.raises(NoSuchMechanism) as caught:
        _ = design_of(name, keys).law
    return caught.value


def number(pattern: str, text: str) -> float:
    said = re.search(pattern.replace("#", r"([\d.]+(?:e[+-]?\d+)?)"), text)
    assert said is not None, text
    return float(said[1])


REAL, CONVEX = "baler-real", "baler-66"
POWER, FOUND_POWER = "at least # W", "a peak power of # W"
ACCELERATION, FOUND_ACCELERATION = "at least # mm/s.2", "a peak acceleration of # mm/s.2"
BOTH: Keys = {LIMITS + "peak_power_w": 6300, LIMITS + "peak_acceleration_mm_s2": 20_000}
WEIGHTED: Keys = {**BOTH, GOAL: "weighted", "optimize.weights": {"acceleration_mm_s2": 1000, "power_w": 500}}
EVEN: Keys = {
    **NO_WISHES,
    "wishes.constant_speed": [{"from_mm": 20, "to_mm": 80, "tolerance": 0.005}],
    LIMITS + "ratio_min": 0.85,
    LIMITS + "ratio_max": 1.2,
}
DWELL: Keys = {**NO_WISHES, "wishes.dwell": [{"at": "extended", "within_mm": 1, "for_deg": 60}]}
BRAKE: Keys = {LIMITS + "braking_power_w": 10, LIMITS + "ratio_min": 0.85, LIMITS + "ratio_max": 1.2}
BRAKING, FOUND_BRAKING = "at least # W of braking", "a braking power of # W"

# With masses the power's limit is a relaxed one, and forces of inertia cost what it does not know
TOO_LITTLE: dict[str, Refused] = {
    "power": Refused(CONVEX, {LIMITS + "peak_power_w": 3000}, LIMITS + "peak_power_w", POWER, FOUND_POWER, 0.005),
    "power with an angle": Refused(
        CONVEX, {LIMITS + "pressure_angle_deg": 40}, LIMITS + "peak_power_w", POWER, FOUND_POWER, 0.01
    ),
    "an angle with power": Refused(
        CONVEX,
        {LIMITS + "pressure_angle_deg": 40},
        LIMITS + "pressure_angle_deg",
        "a pressure angle of # deg .of which",
        "each of these.*a pressure angle of # deg",
        0.01,
        LIMITS + "peak_power_w",
    ),
    "power, not convex": Refused(
        CONVEX,
        {LIMITS + "peak_power_w": 3000, LIMITS + "convex": False},
        LIMITS + "peak_power_w",
        POWER,
        FOUND_POWER,
        0.005,
    ),
    "the goal's own acceleration": Refused(
        CONVEX, BOTH, LIMITS + "peak_acceleration_mm_s2", ACCELERATION, FOUND_ACCELERATION, 0.03
    ),
    "the goal's own power": Refused(
        CONVEX, {**BOTH, GOAL: "least_power"}, LIMITS + "peak_power_w", POWER, FOUND_POWER, 0.02
    ),
    "acceleration of two in a weighted goal": Refused(
        CONVEX, WEIGHTED, LIMITS + "peak_acceleration_mm_s2", ACCELERATION, FOUND_ACCELERATION, 0.04
    ),
    "power of two in a weighted goal": Refused(
        CONVEX,
        WEIGHTED,
        LIMITS + "peak_power_w",
        "or # W, can",
        FOUND_POWER,
        0.03,
        LIMITS + "peak_acceleration_mm_s2",
    ),
    "power of two in a goal without a limit": Refused(
        CONVEX,
        {**BOTH, GOAL: "least_shaking_force"},
        LIMITS + "peak_power_w",
        "or # W, can",
        FOUND_POWER,
        0.16,
        LIMITS + "peak_acceleration_mm_s2",
    ),
    "power of all masses": Refused(
        REAL,
        {LIMITS + "peak_power_w": 3000, GOAL: "least_power"},
        LIMITS + "peak_power_w",
        POWER,
        FOUND_POWER,
        0.6,
    ),
    "braking": Refused(REAL, {**BRAKE, GOAL: "least_power"}, LIMITS + "braking_power_w", BRAKING, FOUND_BRAKING, 0.35),
    "the goal's own braking": Refused(
        REAL, {**BRAKE, GOAL: "least_braking_power"}, LIMITS + "braking_power_w", BRAKING, FOUND_BRAKING, 0.35
    ),
    "r.m.s. torque": Refused(
        REAL,
        {LIMITS + "rms_torque_n_m": 500, GOAL: "least_power"},
        LIMITS + "rms_torque_n_m",
        "or # N m of r.m.s. torque",
        "an r.m.s. torque of # N m",
        0.25,
        LIMITS + "peak_acceleration_mm_s2",
    ),
    "the goal's own flywheel": Refused(
        REAL,
        {LIMITS + "flywheel_kg_mm2": 1e8, GOAL: "least_flywheel"},
        LIMITS + "flywheel_kg_mm2",
        "at least # kg mm.2 of flywheel",
        "a flywheel of # kg mm.2",
        0.15,
    ),
    "an even speed": Refused(
        "feeder-wishes",
        EVEN,
        "wishes.constant_speed.0.tolerance",
        "a tolerance of # of the speed",
        "with each of these.*a tolerance of # of the speed",
        0.03,
        "wishes.constant_speed.0",
    ),
    "an angle for an even speed": Refused(
        "feeder-wishes",
        {LIMITS + "pressure_angle_deg": 25},
        LIMITS + "pressure_angle_deg",
        "a pressure angle of # deg .of which",
        "found.*a pressure angle of # deg",
        0.3,
        "wishes.constant_speed.0",
    ),
    "a speed at a place": Refused(
        "feeder-wishes",
        {**NO_WISHES, "wishes.speed_at": [{"at_mm": 50, "at_least_mm_s": 1000}]},
        "wishes.speed_at.0.at_least_mm_s",
        "at least # mm/s at",
        "found.*at least # mm/s at",
        0.005,
        "wishes.speed_at.0",
    ),
    "time ratio": Refused(
        "feeder-wishes",
        {"wishes.time_ratio.at_least": 20},
        "wishes.time_ratio.at_least",
        "at least # times the time",
        "found.*at least # times the time",
        0.5,
        "wishes.time_ratio",
    ),
    "least ratio for a time ratio": Refused(
        "feeder-wishes",
        {**NO_WISHES, "wishes.time_ratio": {"at_least": 3.5}},
        LIMITS + "ratio_min",
        "a ratio_min of at most #",
        "found.*a least ratio of #",
        0.1,
        "wishes.time_ratio",
    ),
    "a dwell's angle": Refused(
        "feeder-wishes",
        DWELL,
        "wishes.dwell.0.for_deg",
        "a dwell of # deg",
        "found.*a dwell of # deg",
        0.005,
        "wishes.dwell.0",
    ),
    "greatest ratio for a dwell": Refused(
        "feeder-wishes",
        DWELL,
        LIMITS + "ratio_max",
        "a ratio_max of at least #",
        "a greatest ratio of #",
        0.005,
        "wishes.dwell.0",
    ),
    "a working stroke": Refused(
        "feeder-wishes",
        {**NO_WISHES, "wishes.working_stroke": {"angle_deg": 300}},
        "wishes.working_stroke.tolerance_deg",
        "a tolerance of # deg",
        "found.*a tolerance of # deg",
        0.02,
        "wishes.working_stroke",
    ),
    "a position": Refused(
        "feeder-wishes",
        {**NO_WISHES, "wishes.positions": [{"at_mm": 50, "phi1_deg": 30, "tolerance_mm": 1}]},
        "wishes.positions.0.phi1_deg",
        "passed at # deg",
        "found.*passed at # deg",
        0.005,
        "wishes.positions.0",
    ),
}

FALLING = {
    "wishes.speed_at.0.at_least_mm_s",
    "wishes.time_ratio.at_least",
    LIMITS + "ratio_min",
    "wishes.dwell.0.for_deg",
}
"""Keys that ask for less the lower they are."""


def moved(case: Refused, value: float, share: float) -> Keys:
    """The keys with another value, eased by a share of it."""
    return {**case.keys, case.key: value * (1.0 - share if case.key in FALLING else 1.0 + share)}


@pytest.mark.long
@pytest.mark.parametrize("name", long_but(list(TOO_LITTLE)[::6], TOO_LITTLE))
def test_what_is_said_to_be_enough_is(name: str) -> None:
    """The certain value opens the limit and a hundredth less does not; a law has the other value."""
    case = TOO_LITTLE[name]
    refused = refusal(case.design, case.keys)
    assert refused.key == (case.named or case.key)
    certain, found = number(case.certain, refused.problem), number(case.found, refused.problem)
    dearer = certain / found - 1.0 if case.key in FALLING else found / certain - 1.0
    assert -EASED < dearer < case.dearer
    refusal(case.design, moved(case, certain, -LESS))
    _ = design_of(case.design, moved(case, certain, EASED)).bound
    keys = moved(case, found, ROOM)
    best = design_of(case.design, keys)
    held = best.figures
    name_of_limit = case.key.removeprefix(LIMITS)
    if hasattr(held, name_of_limit):
        sign = -1.0 if case.key in FALLING else 1.0
        assert sign * getattr(held, name_of_limit) <= sign * keys[case.key] * (1.0 + 1e-6 * sign)
    machine = Machine(best.train.whole, best.task.linkage, best.task.load, best.task.speed_rad_s)
    assert all(wish.outcome(machine).kept for wish in best.wishes.motion if wish.hard)
