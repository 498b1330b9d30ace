"""A gentle stop: what a motion achieves of it, the law that keeps it, and a limit that no law with it lies below."""

from __future__ import annotations

import json
from dataclasses import replace
from functools import cache
from math import inf, pi, sin
from pathlib import Path

import numpy as np
import pytest

import ncgear
from at_once import at_once
from commands import ROOT
from conftest import Run
from ncgear.kinematics.crank_stretches import CrankStretch, Stroke, by_stroke
from ncgear.kinematics.motion import Machine
from ncgear.mechanisms.crank_slider import CrankSlider
from ncgear.mechanisms.mechanism import Mechanism
from ncgear.mechanisms.resistance import PolynomialResistance
from ncgear.mechanisms.scotch_yoke import ScotchYoke
from ncgear.mechanisms.slider_load import SliderLoad
from ncgear.numerics.jet import Jet
from ncgear.optimum.certified.demands import Demands, WishDemand
from ncgear.optimum.certified.limit import problem_of
from ncgear.optimum.makeable.demanded import certified_limit, start_motion
from ncgear.optimum.makeable.law import EVEN, MakeableLaw, law_of, makeable_law
from ncgear.optimum.makeable.search import Kept, scales, searched
from ncgear.optimum.makeable.wishes import Goal, Wishes, levels
from ncgear.optimum.task import Limits, Task, figures
from ncgear.project.best_law import Begun, BestLaw
from ncgear.project.law_task import inertia_as_given
from ncgear.ratio.laws.harmonic import harmonic_law
from ncgear.ratio.laws.uniform import uniform_law
from ncgear.ratio.transmission import Lobes, PairsInSeries, single
from ncgear.wishes.gentle_stop import GentleSpeed, GentleStop, GentleStretch
from ncgear.wishes.requirements import DecelerationWithin

pytestmark = pytest.mark.judges("optimum")

RADIUS = 100.0
YOKE = ScotchYoke(RADIUS)
OFFSET = CrankSlider(380.0, 960.0, 120.0)
W = 2.0 * pi
PRESS = Task(OFFSET, SliderLoad(PolynomialResistance((400.0,))), W)

STOP = GentleStop(key="wishes.gentle_stop.0", from_mm=100.0, to_mm=200.0, most_mm_s2=1.0)
TOP = RADIUS * W**2
"""Greatest acceleration of an even yoke: that at its ends."""


def even(linkage: Mechanism = YOKE) -> Machine:
    return Machine(uniform_law(Lobes()), linkage, PolynomialResistance(), W)


def law_at_random(seed: int) -> PairsInSeries:
    generator = np.random.default_rng([37, seed])
    cosine, sine = generator.normal(0.0, 0.25, (2, 3)) / np.arange(1.0, 4.0) ** 1.5
    return single(harmonic_law(cosine, sine, Lobes()))


@at_once(
    ("place", "achieved"),
    [
        ({}, TOP),
        ({"to_mm": 150.0}, 0.5 * TOP),
        ({"from_mm": 0.0, "to_mm": 150.0}, 0.5 * TOP),
        ({"from_mm": 20.0, "to_mm": 90.0}, 0.0),
        ({"from_mm": 0.0, "to_mm": 100.0, "stroke": Stroke.RETURN}, TOP),
        ({"from_mm": 50.0, "to_mm": 200.0, "stroke": Stroke.RETURN}, 0.5 * TOP),
        ({"from_mm": 50.0, "stroke": None}, TOP),
        ({"from_mm": 0.0, "to_mm": 20.0, "stroke": None}, TOP),
        ({"from_mm": 0.0, "stroke": None}, TOP),
    ],
)
def test_the_deceleration_of_an_even_yoke(place: dict[str, float], achieved: float) -> None:
    """Its speed r w sin(phi) falls by -r w^2 cos(phi) on the way out, and by r w^2 cos(phi) on the way back."""
    found = replace(STOP, most_mm_s2=0.75 * TOP, **place).outcome(even())
    assert found.achieved == pytest.approx(achieved, rel=1e-9, abs=1e-6)
    assert found.kept is (achieved < 0.75 * TOP)
    assert found.missed_by == pytest.approx(max(achieved - 0.75 * TOP, 0.0), rel=1e-9)


def test_the_greatest_speed_of_an_even_yoke() -> None:
    near = GentleSpeed(from_mm=150.0, to_mm=200.0, stroke=None, most_mm_s=500.0)
    assert near.outcome(even()).achieved == pytest.approx(RADIUS * W * sin(pi / 3.0), rel=1e-9)
    assert replace(near, from_mm=0.0).outcome(even()).achieved == pytest.approx(RADIUS * W, rel=1e-9)


PLACES = [(500.0, inf, Stroke.WORKING), (200.0, 430.0, Stroke.WORKING), (0.0, 250.0, Stroke.RETURN), (600.0, inf, None)]


def wish_at(place: tuple[float, float, Stroke | None], most: float = 1.0) -> GentleStop:
    start, end, stroke = place
    return replace(STOP, from_mm=start, to_mm=min(end, OFFSET.stroke_mm), stroke=stroke, most_mm_s2=most)


def sampled(machine: Machine, wish: GentleStretch) -> tuple[float, float]:
    """Greatest fall and greatest speed by differences of places at even driving angles, two places at a time."""
    step = 2.0 * pi / 16_000
    phi1 = np.arange(16_000) * step
    place = machine.displacement(phi1, 0).value
    speed = np.abs(np.roll(place, -1) - np.roll(place, 1)) / (2.0 * step)
    working = phi1 < machine.extended_rad
    inside = (place >= wish.from_mm) & (place <= wish.to_mm)
    if wish.stroke is not None:
        inside &= working == (wish.stroke is Stroke.WORKING)
    fall = -(np.roll(speed, -1) - np.roll(speed, 1)) / (2.0 * step)
    # Across a dead centre differences mean nothing
    near = np.minimum(np.abs(phi1 - machine.extended_rad), np.abs((phi1 + pi) % (2.0 * pi) - pi)) < 3.0 * step
    return float(fall[inside & ~near].max(initial=0.0)) * W**2, float(speed[inside].max()) * W


@pytest.mark.parametrize("seed", range(2))
def test_decelerations_of_laws_at_random(seed: int) -> None:
    machine = Machine(law_at_random(seed).whole, OFFSET, PolynomialResistance(), W)
    for place in PLACES:
        wish = wish_at(place)
        fall, speed = sampled(machine, wish)
        assert wish.outcome(machine).achieved == pytest.approx(fall, rel=5e-3, abs=30.0)
        fast = GentleSpeed(from_mm=wish.from_mm, to_mm=wish.to_mm, stroke=wish.stroke, most_mm_s=1.0)
        assert fast.outcome(machine).achieved == pytest.approx(speed, rel=1e-3)


@pytest.mark.parametrize("linkage", [YOKE, OFFSET], ids=["yoke", "offset"])
def test_a_stretch_is_cut_at_dead_centres(linkage: Mechanism) -> None:
    far, whole = linkage.working_angle_rad, replace(STOP, from_mm=0.0, to_mm=linkage.stroke_mm, stroke=None)
    parts = by_stroke(linkage, whole.stretch(linkage))
    assert [stroke for _, stroke in parts] == [Stroke.WORKING, Stroke.RETURN]
    assert [tuple(part) for part, _ in parts] == [(0.0, far), (far, 2.0 * pi)]
    about = replace(whole, to_mm=30.0).stretch(linkage)
    assert about.start_rad < 0.0 < about.end_rad
    (back, _), (out, _) = by_stroke(linkage, about)
    assert (back.end_rad, out.start_rad) == (pytest.approx(2.0 * pi), 0.0)
    ends = linkage.displacement(Jet.variable(np.array([back.start_rad, out.end_rad]), 0)).value
    assert ends == pytest.approx(30.0)


@cache
def own_demands(seed: int, *, curved: bool) -> Demands:
    """All that a law at random has itself, with its decelerations over every stretch; curves too where ``curved``."""
    train = law_at_random(seed)
    found, machine = figures(PRESS, train), Machine(train.whole, OFFSET, PRESS.load, W)
    wishes, room = [wish_at(place) for place in PLACES], 1.0 + 1e-9
    own = [(wish.stretch(OFFSET), room * wish.outcome(machine).achieved) for wish in wishes]
    return Demands(
        found.ratio_min / room,
        found.ratio_max * room,
        steepness=float(np.tan(found.tangent_rad)) * room if curved else inf,
        convex=found.convex and curved,
        acceleration_mm_s2=found.peak_acceleration_mm_s2 * room,
        power_w=found.peak_power_w * room,
        wishes=tuple(WishDemand("", DecelerationWithin(stretch, most)) for stretch, most in own),
    )


@pytest.mark.tiers(slow=[f"{seed}-{curve}-60" for seed in (0, 1) for curve in ("curved", "free")], rest="long")
@pytest.mark.parametrize("places", [60, 160])
@pytest.mark.parametrize("curved", [True, False], ids=["curved", "free"])
@pytest.mark.parametrize("seed", range(8))
def test_no_law_is_refused_its_own_decelerations(seed: int, curved: bool, places: int) -> None:
    """A law keeps what it has itself, so the programme that bounds all laws must be open, on coarse grids too."""
    assert problem_of(PRESS, own_demands(seed, curved=curved), places).is_open


def test_a_little_less_deceleration_is_refused() -> None:
    """Negative control: how near the programme is to laws; this one keeps its own, and no law 3 % less."""
    own = own_demands(2, curved=True)
    less = replace(own, wishes=tuple(one.eased(0.97) for one in own.wishes))
    assert [problem_of(PRESS, asked, 60).is_open for asked in (own, less)] == [True, False]


FASTEST = 4.0
"""Greatest s = dphi2/dphi1 of the motions below."""


def least_cycle(rising: float, falling: float) -> float:
    """The shortest cycle of a yoke that starts from rest, rises and falls so fast at most, over that of an even one.

    The speed is as high as the three allow at every place: v^2 is at most 2 A x, 2 D (2 r - x) and (w x' s)^2.
    """
    crank = (np.arange(200_000) + 0.5) * pi / 200_000
    gone, slope = RADIUS * (1.0 - np.cos(crank)), RADIUS * np.sin(crank)
    speed = np.minimum(W * slope * FASTEST, np.sqrt(2.0 * falling * (2.0 * RADIUS - gone)))
    return float(np.mean(W * slope / np.minimum(speed, np.sqrt(2.0 * rising * gone) if rising < inf else inf)))


@at_once(("places", "near"), [(16, 0.9), (480, 0.995)])
@at_once("rising", [inf, 2.0 * TOP])
def test_the_shortest_cycle_of_a_gentle_stop(rising: float, places: int, near: float) -> None:
    """Time-optimal motion between rests: the programme is never above it, on any grid, and comes near on a fine one."""
    falling = 0.4 * TOP
    asked = Demands(1.0 / FASTEST, 50.0, acceleration_mm_s2=rising)
    asked = replace(asked, wishes=(WishDemand("", DecelerationWithin(CrankStretch(0.0, 2.0 * pi), falling)),))
    task = Task(YOKE, SliderLoad(PolynomialResistance()), W)
    share = problem_of(task, asked, places).closing / least_cycle(rising, falling)
    assert near < share <= 1.0 + 1e-6


FREE = Wishes(Limits(0.4, 2.5), convex=False, knots=90)


@cache
def best(wish: GentleStretch | None, goal: Goal = Goal.ACCELERATION) -> tuple[float, float, Machine]:
    """The limit, what the law found has, and its motion."""
    asked = replace(FREE, goal=goal, motion=() if wish is None else (wish,))
    bound = certified_limit(PRESS, asked)
    assert bound is not None
    train = makeable_law(PRESS, asked, start_motion(PRESS, asked, bound)).train(PRESS.lobes)
    return bound.value, asked.prices.of(figures(PRESS, train)), Machine(train.whole, OFFSET, PRESS.load, W)


BINDING = wish_at(PLACES[0], 4000.0)


@pytest.mark.tiers(slow=["least_power"], rest="long")
@pytest.mark.parametrize("goal", [Goal.ACCELERATION, Goal.POWER], ids=lambda goal: goal.value)
def test_a_hard_gentle_stop_is_kept_binds_and_counts_in_the_limit(goal: Goal) -> None:
    """On free curves the limit without the wish is a quarter lower; control: the law without the wish breaks it."""
    (limit, value, machine), (free, without, other) = best(BINDING, goal), best(None, goal)
    assert BINDING.outcome(machine).kept
    assert not BINDING.outcome(other).kept
    assert free < without < limit <= value < 1.1 * limit
    assert BINDING.outcome(machine).achieved == pytest.approx(4000.0, rel=1e-3)


@pytest.mark.slow
def test_a_soft_gentle_stop_is_kept_where_its_weight_is_worth_it() -> None:
    light, heavy = (replace(BINDING, weight=weight) for weight in (0.001, 10.0))
    assert heavy.outcome(best(heavy)[2]).achieved == pytest.approx(4000.0, rel=1e-2)
    assert light.outcome(best(light)[2]).achieved > 1.2 * 4000.0
    assert best(light)[1] < best(heavy)[1]
    assert best(light)[0] == best(None)[0]


def test_a_soft_one_is_missed_by_the_greatest_deceleration_of_both_strokes() -> None:
    """One level of the search is what outcomes tell by the exact curves of a law at random."""
    wish = replace(wish_at(PLACES[-1], 4000.0), weight=1.0)
    search = searched(PRESS, replace(FREE, motion=(wish,)))
    angle, waves = search.programme.knots.angle_rad, np.random.default_rng(38).normal(0.0, 0.15, (3, 2))
    logarithm = sum(a * np.cos(n * angle) + b * np.sin(n * angle) for n, (a, b) in enumerate(waves, 1))
    ratio = np.exp(logarithm) / np.mean(np.exp(logarithm))
    law = law_of(search, Kept(ratio[None], search.judged(ratio[None]).reached))
    machine = Machine(law.train(PRESS.lobes).whole, OFFSET, PRESS.load, W)
    [level] = [level for level, of in zip(law.reached, law.levels, strict=True) if of.share_of_goal]
    assert 4000.0 * (1.0 + level) == pytest.approx(wish.outcome(machine).achieved, rel=1e-5)


BOTH = replace(STOP, from_mm=0.0, to_mm=90.0, stroke=None, most_mm_s2=1200.0)
JARS = Task(CrankSlider(45.0, 160.0), SliderLoad(PolynomialResistance()), W)
CONVEX = Wishes(Limits(0.4, 2.5), knots=90)


@cache
def jars(wish: GentleStop) -> tuple[float, float, Machine]:
    """The limit, the acceleration of the law found, and its motion."""
    asked = replace(CONVEX, motion=(wish,))
    bound = certified_limit(JARS, asked)
    assert bound is not None
    train = makeable_law(JARS, asked, start_motion(JARS, asked, bound)).train(JARS.lobes)
    return bound.value, figures(JARS, train).peak_acceleration_mm_s2, Machine(train.whole, JARS.linkage, JARS.load, W)


def test_of_laws_from_several_starts_the_one_is_taken_that_costs_least() -> None:
    """With what it misses of a soft stop; control: another one has less of the goal alone."""
    wanted = levels(replace(CONVEX, motion=(replace(BOTH, weight=1.0),)), scales(JARS))

    def law(goal: float, missed: float) -> MakeableLaw:
        reached = [goal if one.weight else missed if one.share_of_goal else 0.0 for one in wanted]
        return MakeableLaw(np.zeros(1), np.ones(1), wanted, np.array(reached))

    design = ncgear.load(ROOT / "designs" / "jar-pusher.yaml").design
    best, laws = BestLaw(design, starts=3), [law(1.0, 0.0), law(0.9, 0.5), law(0.95, 0.04)]
    vars(best).update(_laws=laws, begun=Begun(inertia_as_given(design), JARS, None, EVEN))
    assert best.law is laws[2]
    assert laws[1].goal < laws[2].goal
    assert best.starts.apart == pytest.approx(1.0 - 0.99 / 1.4)


@pytest.mark.long
@pytest.mark.slow
def test_a_soft_one_over_both_strokes_is_as_good_as_the_hard_one_of_the_same_stop() -> None:
    """Its deceleration falls, and the acceleration rises, with the weight; both strokes slow down alike.

    A percent of deceleration costs, by the hard laws beside it, what the weight says: on two strokes it would be half.
    """
    weights = 0.5, 1.5, 8.0
    found = [jars(replace(BOTH, weight=weight)) for weight in weights]
    stops = [sampled(machine, BOTH)[0] for _, _, machine in found]
    peaks = [peak for _, peak, _ in found]
    assert stops == sorted(stops, reverse=True)
    assert peaks == sorted(peaks)
    assert stops[-1] == pytest.approx(1200.0, rel=1e-3)
    (limit, peak, machine), stop = found[1], stops[1]
    strokes = [sampled(machine, replace(BOTH, stroke=stroke))[0] for stroke in Stroke]
    assert strokes == pytest.approx([stop, stop], rel=2e-3)
    same = jars(replace(BOTH, most_mm_s2=BOTH.outcome(machine).achieved))
    assert limit <= same[0] <= peak <= 1.0005 * same[1]
    gentler, harder = (jars(replace(BOTH, most_mm_s2=share * stop))[1] for share in (0.99, 1.01))
    assert (gentler - harder) / (0.02 * stop / 1200.0) == pytest.approx(1.5 * peak, rel=0.1)


@pytest.mark.long
@pytest.mark.slow
def test_a_greatest_speed_over_a_stretch_is_kept() -> None:
    wish = GentleSpeed(key="wishes.gentle_stop.0", from_mm=650.0, to_mm=OFFSET.stroke_mm, stroke=None, most_mm_s=900.0)
    limit, value, machine = best(wish)
    assert wish.outcome(machine).kept
    assert not wish.outcome(best(None)[2]).kept
    assert limit <= value


HEAD = """\
name: d
linkage: {crank_mm: 380, rod_mm: 960}
operation: {speed_rpm: 60}
motion: {law: uniform_crank}
"""

WRONG = {
    "neither": ("{from_mm: 700}", ":5:24: wishes.gentle_stop.0: one of deceleration_at_most_mm_s2 or speed_at_most"),
    "both bounds": (
        "{speed_at_most_mm_s: 9, deceleration_at_most_mm_s2: 9}",
        "wishes.gentle_stop.0.speed_at_most_mm_s: ",
    ),
    "no length": (
        "{from_mm: 700, to_mm: 700, speed_at_most_mm_s: 9}",
        "wishes.gentle_stop.0.to_mm: 700 mm given, but from_mm is 700 mm; over 700 mm is right",
    ),
    "apart": (
        "{from_mm: 100, to_mm: 700, stroke: both, speed_at_most_mm_s: 9}",
        "wishes.gentle_stop.0.stroke: both given from 100 to 700 mm; a wish for each stroke is right",
    ),
    "beyond": (
        "{to_mm: 761, speed_at_most_mm_s: 9}",
        "wishes.gentle_stop.0.to_mm: 761 given, but the stroke is 760 mm; at most that is right",
    ),
    "at the end": (
        "{from_mm: 760, speed_at_most_mm_s: 9}",
        "wishes.gentle_stop.0.from_mm: 760 given, but the stroke is 760 mm; less is right",
    ),
    "none at all": ("{deceleration_at_most_mm_s2: 0}", "wishes.gentle_stop.0.deceleration_at_most_mm_s2: 0"),
}


@at_once(("wish", "said"), WRONG.values())
def test_faults_are_told_at_their_key(run: Run, wish: str, said: str) -> None:
    Path("d.yaml").write_text(f"{HEAD}wishes: {{gentle_stop: [{wish}]}}\n", encoding="utf-8")
    got, out, err = run("check", "d.yaml")
    assert (got, out) == (2, "")
    assert said in err


def test_a_check_tells_what_is_achieved(run: Run) -> None:
    """At its extended end, stretched, an even crank slows down by r w^2 (1 + r/l)."""
    Path("d.yaml").write_text(f"{HEAD}wishes: {{gentle_stop: [{{from_mm: 759.9, deceleration_at_most_mm_s2: 1}}]}}\n")
    got, out, _ = run("check", "d.yaml", "--json")
    assert got == 0
    [told] = json.loads(out)["wishes"]
    assert told["achieved_mm_s2"] == pytest.approx(380.0 * W**2 * (1.0 + 380.0 / 960.0), rel=1e-3)
    assert told["missed_by_mm_s2"] == pytest.approx(told["achieved_mm_s2"] - 1.0)
    assert told["in_words"].startswith("greatest deceleration from 759.9 to 760 mm: ")
