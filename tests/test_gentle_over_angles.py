"""A gentle stretch over driving angles: its outcome, the law that keeps it, the limit, its keys and its handles."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from math import pi
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import ncgear
from at_once import at_once
from conftest import Run
from ncgear.errors import WrongInput
from ncgear.kinematics.crank_stretches import CrankStretch, crank_rad
from ncgear.kinematics.motion import Machine
from ncgear.mechanisms.crank_slider import CrankSlider
from ncgear.mechanisms.resistance import PolynomialResistance
from ncgear.mechanisms.slider_load import SliderLoad
from ncgear.optimum.certified.limit import Bound
from ncgear.optimum.makeable.demanded import certified_limit, raised_limit, start_motion
from ncgear.optimum.makeable.driving_ranges import Passed, held_as, passed_by_all
from ncgear.optimum.makeable.law import MakeableLaw, makeable_law
from ncgear.optimum.makeable.search import kept, scales, searched
from ncgear.optimum.makeable.wishes import Wishes
from ncgear.optimum.task import Limits, Task, figures
from ncgear.ratio.laws.harmonic import harmonic_law
from ncgear.ratio.transmission import Lobes, PairsInSeries, single
from ncgear.studio.handles import handles
from ncgear.wishes.gentle_stop import GentleSpeed, GentleStop, GentleStretch
from ncgear.wishes.requirements import DrivingRange, TimeWithin

pytestmark = pytest.mark.judges("optimum")

TURN, W = 2.0 * pi, 2.0 * pi
LINKAGE = CrankSlider(380.0, 960.0, 120.0)
TASK = Task(LINKAGE, SliderLoad(PolynomialResistance((400.0,))), W)
FREE = Wishes(Limits(0.4, 2.5), convex=False, knots=90)


def driving(start: float, end: float) -> DrivingRange:
    return DrivingRange(start, end, CrankStretch(start, end))


SLOW = GentleSpeed(key="wishes.gentle_stop.0", driving=driving(2.0, 3.0), most_mm_s=1500.0)
STOP = GentleStop(key="wishes.gentle_stop.0", driving=driving(1.0, 2.2), most_mm_s2=4000.0)
AROUND = replace(STOP, driving=driving(-0.6, 0.5), most_mm_s2=3000.0)
ALL: list[GentleStretch] = [SLOW, STOP, AROUND]


@cache
def law_at_random(seed: int) -> PairsInSeries:
    generator = np.random.default_rng([41, seed])
    cosine, sine = generator.normal(0.0, 0.25, (2, 3)) / np.arange(1.0, 4.0) ** 1.5
    return single(harmonic_law(cosine, sine, Lobes()))


@cache
def ratios_of(seed: int) -> np.ndarray:
    return 1.0 / law_at_random(seed).whole.driven_angle(np.linspace(0.0, TURN, 2000), 1).derivative(1)


def moving(train: PairsInSeries) -> Machine:
    return Machine(train.whole, LINKAGE, PolynomialResistance(), W)


def sampled(machine: Machine, wish: GentleStretch) -> float:
    """Greatest speed, or fall of it, by differences of places at even driving angles of two cycles."""
    assert wish.driving is not None
    step = TURN / 16_000
    phi1 = np.arange(-16_000, 16_000) * step
    place = machine.displacement(phi1 % TURN, 0).value
    speed = np.abs(np.roll(place, -1) - np.roll(place, 1)) / (2.0 * step)
    inside = (phi1 >= wish.driving.start_rad) & (phi1 <= wish.driving.end_rad)
    if isinstance(wish, GentleSpeed):
        return float(speed[inside].max()) * W
    fall = -(np.roll(speed, -1) - np.roll(speed, 1)) / (2.0 * step)
    near = np.abs((phi1 + pi) % TURN - pi) < 3.0 * step
    near |= np.abs(phi1 % TURN - machine.extended_rad) < 3.0 * step
    return float(fall[inside & ~near].max(initial=0.0)) * W**2


@at_once("wish", ALL)
@at_once("seed", range(2))
def test_what_a_law_at_random_achieves(seed: int, wish: GentleStretch) -> None:
    machine = moving(law_at_random(seed))
    assert wish.outcome(machine).achieved == pytest.approx(sampled(machine, wish), rel=5e-3, abs=30.0)


@at_once("ends", [(2.0, 3.0), (-0.6, 0.5), (-2.0, -1.0), (0.0, 4.0), (5.0, TURN)])
def test_crank_angles_that_every_law_passes(ends: tuple[float, float]) -> None:
    """None of eight laws leaves them; control: taken for a range that is half as wide, some laws do."""
    left = []
    for share in (1.0, 0.5):
        outside = 0
        for seed in range(8):
            machine = moving(law_at_random(seed))
            ratio = ratios_of(seed)
            low, high = float(ratio.min()), float(ratio.max())
            middle, half = (low + high) / 2.0, share * (high - low) / 2.0
            case = passed_by_all(driving(*ends), TURN, middle - 1.001 * half, middle + 1.001 * half)
            passed = zip(case, (crank_rad(machine, angle) for angle in ends), strict=True)
            outside += any(not least - 1e-9 <= crank <= most + 1e-9 for (least, most), crank in passed)
        left.append(outside)
    assert left[0] == 0 < left[1]


@pytest.mark.tiers(slow=["0-*"], rest="long")
@pytest.mark.parametrize("wish", ALL, ids=["speed", "deceleration", "around the end"])
@pytest.mark.parametrize("seed", range(2))
def test_a_law_keeps_what_is_asked_of_its_case_and_breaks_that_of_others(seed: int, wish: GentleStretch) -> None:
    """A law at random, whose own bound is the wish, in cases halved six times; control: the other halves."""
    machine = moving(law_at_random(seed))
    assert wish.driving is not None
    own = [crank_rad(machine, angle) for angle in wish.driving[:2]]

    def has(case: Passed) -> bool:
        return all(least <= crank <= most for (least, most), crank in zip(case, own, strict=True))

    def keeps(case: Passed) -> bool:
        times = [one for one in case.requirements(wish) if isinstance(one, TimeWithin)]
        taken = [angle_at(machine, one.stretch.end_rad) - angle_at(machine, one.stretch.start_rad) for one in times]
        return all(
            one.least_rad - 1e-9 <= value <= one.most_rad + 1e-9 for one, value in zip(times, taken, strict=True)
        )

    case = passed_by_all(wish.driving, TURN, 0.2, 5.0)
    for _ in range(6):
        [case], [other] = ([half for half in case.halves() if has(half) is yes] for yes in (True, False))
        assert keeps(case)
        assert not keeps(other)
        for held in (one for one in case.requirements(wish) if not isinstance(one, TimeWithin)):
            assert own[0] - 1e-9 <= held.stretch.start_rad < held.stretch.end_rad <= own[1] + 1e-9


@pytest.mark.slow
@at_once("wish", ALL)
@at_once("seed", range(2))
def test_what_is_asked_is_enough(seed: int, wish: GentleStretch) -> None:
    """A law keeps its times over the crank angles it passes; shifted to later, or to earlier ones, it breaks them."""
    machine = moving(law_at_random(seed))
    assert wish.driving is not None
    start, end = (crank_rad(machine, angle) for angle in wish.driving[:2])

    def keeps(over: CrankStretch) -> bool:
        times = [one for one in wish.held_over(over).requirements(LINKAGE, TURN) if isinstance(one, TimeWithin)]
        assert len(times) == 2
        taken = [angle_at(machine, one.stretch.end_rad) - angle_at(machine, one.stretch.start_rad) for one in times]
        return all(
            one.least_rad - 1e-9 <= value <= one.most_rad + 1e-9 for one, value in zip(times, taken, strict=True)
        )

    assert keeps(CrankStretch(start, end))
    assert keeps(CrankStretch(start - 0.01, end + 0.01))
    assert not keeps(CrankStretch(start + 0.01, end))
    assert not keeps(CrankStretch(start, end - 0.01))


def angle_at(machine: Machine, crank: float) -> float:
    low, high = -TURN, TURN
    for _ in range(60):
        middle = (low + high) / 2.0
        low, high = (middle, high) if crank_rad(machine, middle) < crank else (low, middle)
    return low


@cache
def searched_for(wish: GentleStretch | None) -> tuple[Wishes, Bound, MakeableLaw]:
    """What is asked, the limit of all laws at once, and the law found."""
    asked = replace(FREE, motion=() if wish is None else (wish,))
    bound = certified_limit(TASK, asked)
    assert bound is not None
    return asked, bound, makeable_law(TASK, asked, start_motion(TASK, asked, bound))


def best(wish: GentleStretch | None) -> tuple[float, float, Machine]:
    """The limit, what the law found has, and its motion."""
    _, bound, law = searched_for(wish)
    train = law.train(TASK.lobes)
    return bound.value, figures(TASK, train).peak_acceleration_mm_s2, moving(train)


@pytest.mark.long
@pytest.mark.slow
@pytest.mark.parametrize(
    ("wish", "before", "after"),
    [(SLOW, 0.11, 0.02), (STOP, 0.05, 0.015), (AROUND, 0.1, 0.065)],
    ids=["speed", "deceleration", "around the end"],
)
def test_cases_raise_the_limit_towards_the_law(wish: GentleStretch, before: float, after: float) -> None:
    """What a law passes in the range depends on the law: the limit of all at once lies 5 to 12 % below the law."""
    asked, bound, law = searched_for(wish)
    own = figures(TASK, law.train(TASK.lobes))
    raised = raised_limit(TASK, asked, bound, own, law.motion).value
    assert own.peak_acceleration_mm_s2 > (1.0 + before) * bound.value
    assert raised <= own.peak_acceleration_mm_s2 <= (1.0 + after) * raised


@pytest.mark.tiers(slow=["around the end"], rest="long")
@pytest.mark.parametrize("wish", ALL, ids=["speed", "deceleration", "around the end"])
def test_a_hard_one_is_kept_and_costs(wish: GentleStretch) -> None:
    """Control: the law without the wish breaks it.  Around the end, where all laws are, the limit rises too."""
    (limit, value, machine), (free, without, other) = best(wish), best(None)
    assert wish.outcome(machine).kept
    assert sampled(machine, wish) <= 1.001 * wish.outcome(machine).most
    assert not wish.outcome(other).kept
    assert free <= limit <= value
    assert without < value
    assert (limit > 1.05 * free) is (wish is AROUND)


@pytest.mark.long
@pytest.mark.slow
def test_the_crank_angles_are_moved_to_where_the_law_is_best() -> None:
    """No even step of the stretch by a twentieth of a radian gives a law that is better by half a percent."""
    _, value, machine = best(SLOW)
    assert SLOW.driving is not None
    start, end = (crank_rad(machine, angle) for angle in SLOW.driving[:2])
    asked = replace(FREE, motion=(SLOW,))
    begun = start_motion(TASK, asked)
    unit, others = scales(TASK).acceleration_mm_s2, []
    for ends in ((start - 0.05, end), (start + 0.05, end), (start, end - 0.05), (start, end + 0.05)):
        search = searched(TASK, replace(asked, motion=(SLOW.held_over(CrankStretch(*ends)),)))
        found = kept(search, search.begun(begun))
        others.append(np.inf if found is None else float(found.reached[0]) * unit)
    first = searched(TASK, held_as(asked, begun, TURN))
    there = kept(first, first.begun(begun))
    assert there is not None
    assert min(others) > 0.995 * value
    assert float(there.reached[0]) * unit > 1.02 * value


@pytest.mark.long
@pytest.mark.slow
@pytest.mark.parametrize("wish", ALL, ids=["speed", "deceleration", "around the end"])
def test_a_soft_one_costs_no_more_than_the_hard_one(wish: GentleStretch) -> None:
    """At each weight, since it may choose the hard law too; a greater weight keeps the wish more nearly."""
    most, (_, hard, _) = wish.outcome(best(wish)[2]).most, best(wish)
    missed = []
    for weight in (0.1, 3.0):
        limit, value, machine = best(replace(wish, weight=weight))
        missed.append(max(sampled(machine, wish) / most - 1.0, 0.0))
        assert limit <= value * (1.0 + weight * missed[-1]) <= 1.002 * hard
    assert missed[1] <= missed[0] + 1e-3
    assert missed[1] < 1e-3


HEAD: dict[str, Any] = {
    "name": "d",
    "linkage": {"crank_mm": 380, "rod_mm": 960},
    "operation": {"speed_rpm": 60},
    "motion": {"law": "uniform_crank"},
}


def drive(**wish: Any) -> ncgear.Drive:
    return ncgear.load({**HEAD, "wishes": {"gentle_stop": [wish]}})


WRONG = {
    "one end": ({"from_phi1_deg": 10.0}, "to_phi1_rad"),
    "two units": ({"from_phi1_deg": 10.0, "to_phi1_deg": 20.0, "to_phi1_rad": 1.0}, "only one of them can count"),
    "falling": ({"from_phi1_deg": 20.0, "to_phi1_pi": 0.1}, "to_phi1_pi: 0.1 given, which is not over from_phi1_deg"),
    "places too": (
        {"from_phi1_deg": 20.0, "to_phi1_deg": 30.0, "to_mm": 9.0},
        "to_mm, from_phi1_deg and to_phi1_deg are given: places and driving angles are mixed",
    ),
    "a stroke too": ({"from_phi1_deg": 20.0, "to_phi1_deg": 30.0, "stroke": "return"}, "stroke: given with driving"),
    "beyond": ({"from_phi1_deg": 20.0, "to_phi1_deg": 361.0}, "to_phi1_deg: from 20 to 361 deg given, but a cycle"),
    "before": ({"from_phi1_deg": -360.0, "to_phi1_deg": -1.0}, "from_phi1_deg: from -360 to -1 deg given"),
    "all of it": ({"from_phi1_deg": -180.0, "to_phi1_deg": 180.0}, "to_phi1_deg: from -180 to 180 deg given"),
}


@at_once(("wish", "said"), WRONG.values())
def test_faults_are_told_at_their_key(wish: dict[str, Any], said: str) -> None:
    with pytest.raises(WrongInput, match="gentle_stop") as found:
        _ = drive(speed_at_most_mm_s=9.0, **wish).motion_wishes
    assert said in str(found.value)


@pytest.mark.parametrize(("unit", "turn"), [("deg", 360.0), ("rad", TURN), ("pi", 2.0)])
def test_units_agree(unit: str, turn: float) -> None:
    made = drive(speed_at_most_mm_s=9.0, **{f"from_phi1_{unit}": -turn / 10.0, f"to_phi1_{unit}": turn / 20.0})
    assert made.achieved is not None
    [found] = made.achieved.outcomes
    assert found.achieved == pytest.approx(941.3009642776066, rel=1e-9)


def test_a_check_tells_the_range(run: Run) -> None:
    text = "wishes: {gentle_stop: [{from_phi1_deg: -36, to_phi1_deg: 18, speed_at_most_mm_s: 900}]}\n"
    head = "name: d\nlinkage: {crank_mm: 380, rod_mm: 960}\noperation: {speed_rpm: 60}\nmotion: {law: uniform_crank}\n"
    Path("d.yaml").write_text(head + text)
    got, out, _ = run("check", "d.yaml", "--json")
    assert got == 0
    assert "greatest speed from driving angle -36 to 18 deg: 941.3 mm/s, at most 900 mm/s wished" in out


@pytest.mark.parametrize(
    ("wish", "wanted"),
    [
        (
            {"from_phi1_pi": -0.2, "to_phi1_pi": 0.1, "speed_at_most_mm_s": 900.0},
            [("speed_at_most_mm_s", 351.0, -900.0, "y"), ("from_phi1_pi", 324.0, -900.0, "x")],
        ),
        (
            {"from_phi1_deg": 100.0, "to_phi1_deg": 170.0, "deceleration_at_most_mm_s2": 9000.0},
            [("deceleration_at_most_mm_s2", 135.0, -9000.0, "y"), ("from_phi1_deg", 100.0, -9000.0, "x")],
        ),
        (
            {"from_mm": 500.0, "stroke": "return", "deceleration_at_most_mm_s2": 9000.0},
            [("deceleration_at_most_mm_s2", None, 9000.0, "y"), ("from_mm", None, 500.0, "y")],
        ),
    ],
    ids=["speed over angles", "deceleration over angles", "places of the return"],
)
def test_its_handles(wish: dict[str, float], wanted: list[tuple[str, float | None, float, str]]) -> None:
    """Each moves its key along one axis; those of the return stand where the slider comes back."""
    made = drive(**wish)
    found = [one for one in handles(made) if one["name"].startswith("gentle")]
    assert len(found) == 2 + ("to_mm" not in wish and "from_mm" not in wish)
    for one, (key, angle, shown, axis) in zip(found, wanted, strict=False):
        assert one["moves"][axis]["key"] == f"wishes.gentle_stop.0.{key}"
        assert list(one["moves"]) == [axis]
        assert one["y"] == shown
        if angle is None:
            assert one["x"] > 180.0
        else:
            assert one["x"] == pytest.approx(angle)
