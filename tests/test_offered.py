"""What `ncgear optimize` offers where no law keeps all that is asked is tried out: written into the file, it does."""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import pytest

from ncgear.design.beginning import begun
from ncgear.design.keys.design import Design
from ncgear.design.reading.design_file import parsed
from ncgear.design.rewritten import rewritten
from ncgear.design.template import MachineName
from ncgear.optimum.certified.refusals import turning_point
from ncgear.optimum.offers import Refused
from ncgear.project.best_law import BestLaw
from ncgear.wishes.wish import Offer

Keys = dict[str, Any]
LIMITS = "optimize.limits."
KNOTS: Keys = {"optimize.knots": 60}


def text_of(machine: MachineName, wishes: Keys, more: Keys) -> str:
    return rewritten(begun("asked", machine, {}, wishes), KNOTS | more)


def design_of(text: str) -> Design:
    return parsed(text, Path("asked.yaml")).design


def refusal(text: str) -> Refused:
    with pytest.raises(Refused) as caught:
        _ = BestLaw(design_of(text)).law
    return caught.value


def asking(text: str, offers: Sequence[Offer]) -> str:
    """The file with the values that offers name, as a person would write them."""
    return rewritten(text, {key: value for offer in offers for key, value in offer.values})


def is_limit(offer: Offer) -> bool:
    return offer.key.startswith(LIMITS)


def dwell(end: str, within_mm: float, for_deg: float) -> Keys:
    return {"at": end, "within_mm": within_mm, "for_deg": for_deg}


TOGETHER: dict[str, tuple[MachineName, Keys, Keys, set[str]]] = {
    "a long dwell": (
        MachineName.PRESS_FEEDER,
        {"dwell": [dwell("extended", 0.8, 80)]},
        {LIMITS + "peak_power_w": 45},
        {"ratio_max", "pressure_angle_deg"},
    ),
    "dwells at both ends": (
        MachineName.PRESS_FEEDER,
        {"dwell": [dwell("extended", 0.4, 29), dwell("retracted", 0.6, 30)]},
        {},
        {"ratio_max", "peak_power_w"},
    ),
    "a very quick return": (
        MachineName.PUMP,
        {"time_ratio": {"at_least": 4.2}},
        {},
        {"peak_acceleration_mm_s2", "ratio_min"},
    ),
    "a long working stroke": (
        MachineName.BALER,
        {"working_stroke": {"angle_deg": 300, "tolerance_deg": 1}},
        {},
        {"ratio_min", "peak_power_w"},
    ),
    "an early place": (
        MachineName.DESK_TOY,
        {"positions": [{"at_mm": 16, "phi1_deg": 43, "tolerance_mm": 0.2}], "dwell": []},
        {LIMITS + "pressure_angle_deg": 35},
        {"ratio_min", "pressure_angle_deg"},
    ),
    "a fast machine": (
        MachineName.PUMP,
        {"time_ratio": {"at_least": 2.5}},
        {"operation.speed_rpm": 500, LIMITS + "peak_acceleration_mm_s2": 50_000, LIMITS + "peak_power_w": 330},
        {"peak_acceleration_mm_s2", "peak_power_w"},
    ),
}
"""Machines, their wishes, other keys, and limits that are known to stand in the way, which must be named at once."""


@pytest.mark.slow
@pytest.mark.long
@pytest.mark.parametrize("case", TOGETHER)
def test_all_limits_that_have_to_give_way_are_named_at_once_and_are_enough(case: str) -> None:
    machine, wishes, more, named = TOGETHER[case]
    text = text_of(machine, wishes, more)
    refused = refusal(text)
    limits = [one for one in refused.offers if is_limit(one)]
    assert not refused.each
    assert {one.key.removeprefix(LIMITS) for one in limits} >= named
    assert "all of these together" in refused.problem
    assert "can be enough" not in refused.problem
    law = BestLaw(design_of(asking(text, limits))).law
    assert law.goal > 0.0
    # Without any one of them there is none.
    for left_out in limits:
        fewer = [one for one in limits if one is not left_out]
        assert refusal(asking(text, fewer)).problem


@pytest.mark.long
@pytest.mark.slow
@pytest.mark.parametrize("case", ["dwells at both ends", "a very quick return"])
def test_a_wish_beside_the_limits_is_enough_as_they_are(case: str) -> None:
    machine, wishes, more, _ = TOGETHER[case]
    text = text_of(machine, wishes, more)
    beside = [one for one in refusal(text).offers if not is_limit(one)]
    assert beside
    for one in beside:
        assert BestLaw(design_of(asking(text, [one]))).law.goal > 0.0


EVEN = {"from_mm": 60, "to_mm": 200, "tolerance": 0.002}
IMPOSSIBLE: dict[str, tuple[MachineName, Keys, Keys]] = {
    "a speed that is much too low": (
        MachineName.PUSHER,
        {"constant_speed": [EVEN | {"speed_mm_s": 60}]},
        {},
    ),
    "a speed that is too high": (MachineName.PUSHER, {"constant_speed": [EVEN | {"speed_mm_s": 700}]}, {}),
    "speeds far apart": (
        MachineName.PUSHER,
        {"speed_at": [{"at_mm": 125, "at_most_mm_s": 50}, {"at_mm": 70, "at_least_mm_s": 480}]},
        {},
    ),
    "a dwell for most of the turn": (MachineName.DESK_TOY, {"dwell": [dwell("retracted", 0.02, 300)]}, {}),
    "an even speed over all of the stroke": (
        MachineName.PUSHER,
        {"constant_speed": [{"from_mm": 0.5, "to_mm": 249.5, "tolerance": 0.01}]},
        {},
    ),
}


@pytest.mark.long
@pytest.mark.slow
@pytest.mark.parametrize("case", [*IMPOSSIBLE, *TOGETHER])
def test_every_offer_may_be_written_into_the_file(case: str) -> None:
    """A tolerance is at most 0.5 there, a ratio at most 100; and offers with which laws were found have one."""
    machine, wishes, more = {**IMPOSSIBLE, **{name: found[:3] for name, found in TOGETHER.items()}}[case]
    text = text_of(machine, wishes, more)
    refused = refusal(text)
    for one in refused.offers:
        assert one.values
        design_of(asking(text, [one]))
    tolerances = [float(one) for one in re.findall(r"a tolerance of ([\d.]+) of the speed", refused.problem)]
    assert all(one <= 0.5 for one in tolerances)
    if refused.found and case in IMPOSSIBLE:
        tried = [[one] for one in refused.offers] if refused.each else [list(refused.offers)]
        for offers in tried:
            assert BestLaw(design_of(asking(text, offers))).law.goal > 0.0


def test_an_excess_that_rounding_decides_has_a_turning_point() -> None:
    """The root lies at the edge of the interval, and rounding lets the excess be under zero just beside it."""

    def excess(value: float) -> float:
        return 1e-9 if value == 1.0 else -1e-7 - (value - 1.0 if value > 1.0 else 0.0)

    found = turning_point(excess, 1.0)
    assert found is not None
    assert found == pytest.approx((1.0, 1.0), abs=1e-4)
