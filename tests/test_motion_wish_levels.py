"""Laws asked for wishes of the motion: kept by the exact motion, never under the certified limit, or refused."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from math import pi

import pytest

from drives import drive
from ncgear.errors import NoSuchMechanism
from ncgear.kinematics.crank_stretches import End
from ncgear.kinematics.motion import Machine
from ncgear.optimum.certified.limit import least_acceleration_roughly, problem_of
from ncgear.optimum.makeable.demanded import certified_limit, demands_of, start_motion
from ncgear.optimum.makeable.law import makeable_law
from ncgear.optimum.makeable.wishes import Wishes
from ncgear.optimum.task import figures
from ncgear.wishes.constant_speed import ConstantSpeed
from ncgear.wishes.dwell import Dwell
from ncgear.wishes.positions import Position
from ncgear.wishes.speed_at import ExtremeSpeed, SpeedAt
from ncgear.wishes.time_ratio import TimeRatio
from ncgear.wishes.wish import Outcome, Wish
from ncgear.wishes.working_stroke import WorkingStroke
from published import AT_SIXTY, USUAL

pytestmark = pytest.mark.judges("optimum")

FREE = Wishes(replace(USUAL, peak_power_w=18_750.0))
ROUNDING = 1.0 + 1e-7

HARD: dict[str, Wish] = {
    "even speed": ConstantSpeed(key="wishes.constant_speed.0", from_mm=300, to_mm=500, tolerance=0.005),
    "this even speed": ConstantSpeed(
        key="wishes.constant_speed.0", from_mm=300, to_mm=500, tolerance=0.01, speed_mm_s=1500.0
    ),
    "slow at a place": SpeedAt(key="wishes.speed_at.0", at_mm=600, most_mm_s=1000.0),
    "time ratio": TimeRatio(key="wishes.time_ratio", at_least=1.6),
    "working stroke": WorkingStroke(key="wishes.working_stroke", angle_rad=3.5),
    "working stroke or so": WorkingStroke(key="wishes.working_stroke", angle_rad=4.1, tolerance_rad=0.1),
    "dwell": Dwell(key="wishes.dwell.0", end=End.EXTENDED, within_mm=5, for_rad=0.8),
    "position": Position(key="wishes.positions.0", at_mm=400, phi1_rad=2.2, tolerance_mm=3.0),
}


@cache
def found(*wishes: Wish) -> tuple[Machine, float]:
    """The best law's motion, and its peak acceleration in mm/s2; the law is never under the certified limit."""
    asked = replace(FREE, motion=wishes)
    bound = certified_limit(AT_SIXTY, asked)
    assert bound is not None
    train = makeable_law(AT_SIXTY, asked, start_motion(AT_SIXTY, asked, bound)).train(AT_SIXTY.lobes)
    peak = figures(AT_SIXTY, train).peak_acceleration_mm_s2
    assert bound.value <= peak * ROUNDING
    return Machine(train.whole, AT_SIXTY.linkage, AT_SIXTY.load, AT_SIXTY.speed_rad_s), peak


def judged(wish: Wish, *asked: Wish) -> Outcome:
    return wish.outcome(found(*asked)[0])


@pytest.mark.tiers(slow=["working stroke"], rest="long")
@pytest.mark.parametrize("name", HARD)
def test_a_hard_wish_is_kept_and_binds(name: str) -> None:
    """Control: the law without the wish breaks it."""
    wish = HARD[name]
    assert judged(wish, wish).kept
    assert not judged(wish).kept
    assert found(wish)[1] > found()[1]


@pytest.mark.slow
def test_the_press_feeder_keeps_its_wishes() -> None:
    """Control: the same wishes on a crank that turns evenly are missed."""
    assert all(one.kept for one in drive("feeder-kept").achieved.outcomes)
    assert not all(one.kept for one in drive("feeder-wishes").achieved.outcomes)


@pytest.mark.slow
@pytest.mark.long
def test_a_soft_wish_is_kept_where_its_weight_is_worth_it() -> None:
    """A speed of 1000 mm/s at 600 mm costs a third more acceleration."""
    wish = HARD["slow at a place"]
    light, heavy = (replace(wish, weight=weight) for weight in (0.01, 10.0))
    assert judged(heavy, heavy).achieved == pytest.approx(1000.0, rel=1e-4)
    assert judged(light, light).achieved > 1.05 * 1000.0
    assert found(light)[1] < found(heavy)[1] <= found(wish)[1] * 1.002


@pytest.mark.tiers(slow=["False-0.5"], rest="long")
@pytest.mark.parametrize(("fastest", "weight"), [(False, 0.5), (True, 5.0)])
def test_an_extreme_speed_moves_the_speed_its_way(fastest: bool, weight: float) -> None:
    """Fastest is dear: at 700 mm the power leaves 1085 mm/s, so that 1 % of 1900 mm/s is 3 % of the braking before."""
    wish = ExtremeSpeed(key="wishes.speed_at.0", at_mm=600, weight=weight, fastest=fastest)
    moved, free = judged(wish, wish).achieved, judged(wish).achieved
    assert moved > free * 1.01 if fastest else moved < free * 0.99


@pytest.mark.parametrize(
    "wish",
    [
        TimeRatio(key="wishes.time_ratio", at_least=20.0),
        Dwell(key="wishes.dwell.0", end=End.EXTENDED, within_mm=0.1, for_rad=pi),
    ],
)
def test_a_wish_that_no_law_keeps_is_refused_by_its_key(wish: Wish) -> None:
    with pytest.raises(NoSuchMechanism) as caught:
        found(wish)
    assert wish.key in f"{caught.value.key} {caught.value.problem}"


@pytest.mark.parametrize(("ends_mm", "known"), [((300.0, 500.0), 13_282.0), ((200.0, 600.0), 19_103.0)])
def test_the_limit_of_an_even_speed_agrees_with_another_programme(ends_mm: tuple[float, float], known: float) -> None:
    """The reference, another solver's, leaves the driving curve free as well; one percent is its grid's."""
    wish = ConstantSpeed(key="wishes.constant_speed.0", from_mm=ends_mm[0], to_mm=ends_mm[1], tolerance=1e-4)
    asked = demands_of(AT_SIXTY, replace(FREE, motion=(wish,)))
    assert least_acceleration_roughly(problem_of(AT_SIXTY, asked)) == pytest.approx(known, rel=0.01)
