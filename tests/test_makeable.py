"""Makeable laws: limits kept by exact figures, never under the certified limit, nothing better next to them."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from itertools import pairwise
from math import pi, radians

import numpy as np
import pytest
from scipy.optimize import linprog

from ncgear.kinematics.motion import Machine
from ncgear.mechanisms.crank_slider import CrankSlider
from ncgear.mechanisms.resistance import FormulaResistance, PolynomialResistance, TableResistance
from ncgear.mechanisms.slider_load import SliderLoad
from ncgear.numerics.arrays import Array
from ncgear.optimum.certified.limit import Motion
from ncgear.optimum.makeable.demanded import certified_limit
from ncgear.optimum.makeable.law import MakeableLaw, makeable_law
from ncgear.optimum.makeable.places import cell_ends, places
from ncgear.optimum.makeable.reached import JudgedLaw
from ncgear.optimum.makeable.reached import ratios as ratios_at
from ncgear.optimum.makeable.search import scales
from ncgear.optimum.makeable.spline import even_knots
from ncgear.optimum.makeable.wishes import Goal, Wishes, levels
from ncgear.optimum.task import Figures, Limits, Prices, Task, figures
from ncgear.ratio.laws.spline import spline_ratio_law
from ncgear.ratio.transmission import Lobes
from ncgear.wishes.working_stroke import WorkingStroke
from published import AT_SIXTY, BALER_LINKAGE, FIT, OFFSET, PRESS, RPM, USUAL

HALF = Wishes(replace(USUAL, peak_power_w=9375.0), knots=36)
ROUNDING = 1.0 + 1e-7


@cache
def law(wishes: Wishes, task: Task = AT_SIXTY) -> MakeableLaw:
    return makeable_law(task, wishes, wavy(1))


def even(task: Task) -> Motion:
    """The crank turns evenly: a start that knows nothing of the machine."""
    return Motion(np.array([0.0, pi]), np.full(2, 2.0 * pi / task.cycle_rad))


def wavy(seed: int) -> Motion:
    """A motion at random, its ratio between 0.4 and 2.5."""
    angle = np.linspace(0.0, 2.0 * pi, 12, endpoint=False)
    return Motion(angle, np.exp(np.random.default_rng(seed).uniform(-0.9, 0.9, angle.size)))


@cache
def limit(wishes: Wishes, task: Task = AT_SIXTY) -> float:
    """The certified limit of the goal, in its unit."""
    bound = certified_limit(task, wishes)
    assert bound is not None
    return bound.value


@cache
def judged(wishes: Wishes, task: Task = AT_SIXTY) -> Figures:
    found = law(wishes, task)
    return figures(task, found.train(task.lobes))


def machine(wishes: Wishes, task: Task = AT_SIXTY) -> Machine:
    found = law(wishes, task)
    whole = found.train(task.lobes).whole
    return Machine(whole, task.linkage, task.load, task.speed_rad_s)


def peak_jerk(wishes: Wishes) -> float:
    """Of dense samples: their peak is less than that by the second power of their distance."""
    displacement = machine(wishes).displacement(np.linspace(0.0, 2.0 * pi, 40_001), 3)
    return float(np.abs(displacement.derivative(3)).max()) * AT_SIXTY.speed_rad_s**3


def peak_moving_power(wishes: Wishes, task: Task) -> float:
    """With the slider's mass alone, of dense samples."""
    motion = machine(wishes, task).motion(np.linspace(0.0, 2.0 * pi, 40_001))
    inertia = task.moving.slider_kg * motion.acceleration * motion.velocity * 1e-6
    return float((motion.power_w + inertia).max())


KEPT: dict[str, Wishes] = {
    "power": HALF,
    "both peaks, least power": replace(
        HALF, goal=Goal.POWER, limits=replace(USUAL, peak_acceleration_mm_s2=22_000.0, peak_power_w=12_000.0)
    ),
    "ratio range": replace(HALF, limits=Limits(0.75, 1.9, peak_power_w=14_500.0)),
    "pressure angle": replace(
        HALF, limits=replace(USUAL, peak_power_w=11_000.0, pressure_angle_rad=radians(25.0)), convex=False
    ),
    "curvature": replace(HALF, curvature_turns=4.4 * pi),
    "curvature of dents": replace(HALF, curvature_turns=4.0 * pi, convex=False),
    "jerk": replace(HALF, limits=replace(USUAL, peak_power_w=14_000.0), peak_jerk_mm_s3=170_000.0),
    "driven speed": replace(HALF, limits=replace(USUAL, peak_power_w=10_000.0), driven_speed_rad_s=80.0 * RPM),
    "working stroke": replace(
        HALF,
        limits=replace(USUAL, peak_power_w=12_000.0),
        motion=(WorkingStroke(key="wishes.working_stroke", angle_rad=3.5),),
    ),
    "mass": replace(HALF, limits=replace(USUAL, peak_power_w=12_000.0)),
    "not convex": replace(HALF, convex=False, limits=replace(USUAL, peak_power_w=6_300.0)),
}
HEAVY = replace(AT_SIXTY, masses=BALER_LINKAGE.MASSES(slider_kg=60.0))


def task_of(name: str) -> Task:
    return HEAVY if name == "mass" else AT_SIXTY


@pytest.mark.tiers(thorough=["curvature of dents"], rest="long")
@pytest.mark.parametrize("name", KEPT)
def test_every_limit_is_kept_by_exact_figures(name: str) -> None:
    wishes, task = KEPT[name], task_of(name)
    found, limits = judged(wishes, task), wishes.limits
    assert found.peak_power_w <= (limits.peak_power_w or np.inf) * ROUNDING
    assert found.peak_acceleration_mm_s2 <= (limits.peak_acceleration_mm_s2 or np.inf) * ROUNDING
    assert limits.ratio_min <= found.ratio_min * ROUNDING
    assert found.ratio_max <= limits.ratio_max * ROUNDING
    assert found.tangent_rad <= (limits.pressure_angle_rad or np.inf) * ROUNDING
    assert found.convex or not wishes.convex
    assert found.curvature_turns <= (wishes.curvature_turns or np.inf) * ROUNDING
    assert AT_SIXTY.speed_rad_s / found.ratio_min <= (wishes.driven_speed_rad_s or np.inf) * ROUNDING
    if wishes.peak_jerk_mm_s3:
        assert peak_jerk(wishes) <= wishes.peak_jerk_mm_s3 * ROUNDING
    for wish in wishes.motion:
        assert isinstance(wish, WorkingStroke)
        assert found.working_rad == pytest.approx(wish.angle_rad, abs=1e-7)
    if task.masses is not None:
        assert peak_moving_power(wishes, task) <= (limits.peak_power_w or np.inf) * ROUNDING


@pytest.mark.slow
def test_each_of_those_limits_binds() -> None:
    """Control of the test above: without its limit the same law would break it."""
    free = judged(HALF)
    assert free.tangent_rad > radians(30.0)
    assert free.curvature_turns > 4.4 * pi
    assert free.ratio_max > 1.9
    assert AT_SIXTY.speed_rad_s / free.ratio_min > 80.0 * RPM
    assert abs(free.working_rad - 3.5) > 0.1
    assert peak_jerk(replace(HALF, limits=replace(USUAL, peak_power_w=14_000.0))) > 170_000.0
    slowed = replace(HEAVY, masses=None)  # the mass, slowed down, presses along
    assert figures(slowed, law(KEPT["mass"], HEAVY).train(slowed.lobes)).peak_power_w > 12_000.0
    assert not judged(KEPT["not convex"]).convex


@pytest.mark.tiers(slow=["not convex", "curvature"], rest="long")
@pytest.mark.parametrize("name", KEPT)
def test_no_law_is_under_the_certified_limit(name: str) -> None:
    wishes, task = KEPT[name], task_of(name)
    assert limit(wishes, task) < wishes.prices.of(judged(wishes, task)) < 1.7 * limit(wishes, task)


SMALL = 4e-3
"""Largest change of ln i12 at a knot."""


def gain_nearby(wishes: Wishes, found: MakeableLaw, task: Task = AT_SIXTY) -> float:
    """Relative gain to first order within all limits, no ln i12 at a knot moved by over SMALL: a linear programme."""
    knots = even_knots(wishes.knots)
    on = places(task, cell_ends(task, knots.angle_rad, []), 20)
    rows, wanted = knots.rows(on.angle_rad), levels(wishes, scales(task))

    def terms(logarithm: Array) -> list[list[Array]]:
        """All sides of all levels at all places."""
        at = ratios_at(on, rows, knots.coefficients(logarithm), [task.cycle_rad])
        judged = JudgedLaw(wanted, on, at)
        return [[term + np.zeros(on.count) for term in level.terms(at, on.slider, judged.lengths)] for level in wanted]

    def flat(logarithm: Array) -> Array:
        return np.concatenate([term for terms_of in terms(logarithm) for term in terms_of])

    best = np.log(found.ratio)
    values, moves = flat(best), 1e-6 * np.eye(best.size)
    slopes = np.column_stack([(flat(best + move) - flat(best - move)) / 2e-6 for move in moves])
    owner = np.concatenate([np.full(on.count * len(sides), k) for k, sides in enumerate(terms(best))])
    (goal,) = (k for k, level in enumerate(wanted) if level.weight)
    limits = np.array([level.cap for level in wanted])[owner]
    capped, sought = np.isfinite(limits), owner == goal
    rows_of_limits = np.hstack([slopes[capped], np.zeros((capped.sum(), 1))])
    rows_of_goal = np.hstack([slopes[sought], -np.ones((sought.sum(), 1))])
    room = np.concatenate([np.maximum(limits[capped] - values[capped], 0.0), -values[sought]])
    cost = np.append(np.zeros(best.size), 1.0)
    bounds = [(-SMALL, SMALL)] * best.size + [(None, None)]
    answer = linprog(cost, np.vstack([rows_of_limits, rows_of_goal]), room, bounds=bounds)
    assert answer.success
    return 1.0 - float(answer.fun) / float(values[sought].max())


@pytest.mark.tiers(slow=["curvature of dents"], rest="long")
@pytest.mark.parametrize("name", ["power", "pressure angle", "curvature of dents", "jerk"])
def test_no_small_change_improves_it(name: str) -> None:
    """But for what it costs to hold the limits between the places of the programme."""
    wishes = replace(KEPT[name], knots=72)
    assert -1e-9 < gain_nearby(wishes, law(wishes)) < 2e-3


@pytest.mark.slow
def test_a_law_for_tighter_limits_is_improved_by_small_changes() -> None:
    """Negative control of the test above: a power of 4 % less is given back."""
    wishes = replace(HALF, knots=72)
    tighter = replace(wishes, limits=replace(USUAL, peak_power_w=9_000.0))
    assert gain_nearby(wishes, law(tighter)) > 4e-3


@pytest.mark.tiers(slow=["1"], rest="long")
@pytest.mark.parametrize("seed", range(3))
def test_the_same_from_any_start(seed: int) -> None:
    """The programme is not convex; starts at random end where the even one does."""
    found = makeable_law(AT_SIXTY, HALF, wavy(seed))
    again = figures(AT_SIXTY, found.train(AT_SIXTY.lobes)).peak_acceleration_mm_s2
    assert again == pytest.approx(judged(HALF).peak_acceleration_mm_s2, rel=1e-5)


@pytest.mark.slow
def test_knots_between_the_others_are_never_worse() -> None:
    """Twice the knots hold every spline of the others."""
    found = [judged(replace(HALF, knots=count)).peak_acceleration_mm_s2 for count in (12, 24, 48, 96)]
    assert found == sorted(found, reverse=True)
    assert found[-1] < 0.99 * found[0]


OF_KNOTS = (90, 180, 360, 720)


@pytest.mark.long
@pytest.mark.slow
def test_another_discretisation_comes_to_the_same_law() -> None:
    """The baler at 6300 W from a wavy start: 0.22 % from 180 knots to 720, and each doubling takes a third or less."""
    wishes = Wishes(replace(USUAL, peak_power_w=6300.0))
    found = [judged(replace(wishes, knots=count)).peak_acceleration_mm_s2 for count in OF_KNOTS]
    gains = [before / after - 1.0 for before, after in pairwise(found)]
    assert 0.0 < found[1] / found[3] - 1.0 < 2.5e-3
    assert all(0.0 < later < earlier / 3.0 for earlier, later in pairwise(gains))
    assert limit(wishes) < found[3] < 1.003 * limit(wishes)


@pytest.mark.tiers(slow=["36"], rest="long")
@pytest.mark.parametrize("count", [12, 24, 36, 48, 360, 720])
def test_few_knots_and_many_keep_power_and_curves_exactly(count: int) -> None:
    """Between few knots a judge with steps in proportion to them would overlook dents and peaks of a millionth."""
    for power_w in (6300.0, 9375.0):
        found = judged(replace(HALF, limits=replace(USUAL, peak_power_w=power_w), knots=count))
        assert found.convex
        assert found.peak_power_w <= power_w


@pytest.mark.slow
def test_a_judge_with_steps_in_proportion_to_few_knots_overlooks_dents(monkeypatch: pytest.MonkeyPatch) -> None:
    """Negative control of the test above."""
    monkeypatch.setattr("ncgear.optimum.makeable.search._judging", lambda task, ends, _: places(task, ends, 16))
    monkeypatch.setattr("ncgear.optimum.makeable.search.ROOM", 0.0)
    overlooked = []
    for count in (24, 36, 48):
        found = makeable_law(AT_SIXTY, replace(HALF, knots=count), even(AT_SIXTY))
        exact = figures(AT_SIXTY, found.train(AT_SIXTY.lobes))
        overlooked.append(not exact.convex or exact.peak_power_w > 9375.0)
    assert any(overlooked)


@pytest.mark.slow
def test_the_same_input_gives_the_same_bits() -> None:
    first, again = (makeable_law(AT_SIXTY, HALF, wavy(3)) for _ in range(2))
    assert np.array_equal(first.ratio, again.ratio)
    other = makeable_law(AT_SIXTY, replace(HALF, limits=replace(USUAL, peak_power_w=9374.0)), wavy(3))
    assert not np.array_equal(first.ratio, other.ratio)


@pytest.mark.slow
def test_ratios_are_what_a_file_holds() -> None:
    """Ten decimals: the law that was judged is the law that is written."""
    found = law(HALF)
    assert [float(f"{value:.10f}") for value in found.ratio] == found.ratio.tolist()
    written = spline_ratio_law(found.driven_angle_rad, found.ratio, AT_SIXTY.lobes)
    angle = np.linspace(0.0, 2.0 * pi, 500, endpoint=False)
    closed, own = written.driven_angle(angle, 1), machine(HALF).transmission.driven_angle(angle, 1)
    assert np.array_equal(closed.derivative(1), own.derivative(1))


@pytest.mark.slow
def test_power_and_acceleration_are_each_other_s_inverse() -> None:
    """One frontier: the least power at the least acceleration under a cap is that cap.

    But for what is kept back for the rises between places.
    """
    acceleration = judged(HALF).peak_acceleration_mm_s2
    dual = replace(HALF, goal=Goal.POWER, limits=replace(USUAL, peak_acceleration_mm_s2=acceleration))
    assert judged(dual).peak_power_w == pytest.approx(9375.0, rel=3e-5)


@pytest.mark.slow
def test_a_weighted_sum_touches_the_frontier_from_no_side() -> None:
    prices = Prices(1.0 / 20_000.0, 1.0 / 9_000.0)
    wishes = replace(HALF, goal=Goal.WEIGHTED, weights=prices, limits=USUAL)
    found = judged(wishes)
    value = prices.of(found)
    assert value > limit(wishes)
    # On the frontier at its own power, and no other point of it has a lesser sum.
    on_it = judged(replace(HALF, limits=replace(USUAL, peak_power_w=round(found.peak_power_w, 3))))
    assert on_it.peak_acceleration_mm_s2 == pytest.approx(found.peak_acceleration_mm_s2, rel=1e-4)
    for cap in (0.9, 0.97, 1.03, 1.1):
        other = judged(replace(HALF, limits=replace(USUAL, peak_power_w=round(cap * found.peak_power_w, 3))))
        assert prices.of(other) >= value * (1.0 - 1e-5)


@pytest.mark.slow
def test_weights_scale_away() -> None:
    wishes = replace(HALF, goal=Goal.WEIGHTED, weights=Prices(1.0 / 20_000.0, 1.0 / 9_000.0), limits=USUAL)
    twice = replace(wishes, weights=Prices(2.0 / 20_000.0, 2.0 / 9_000.0))
    assert judged(twice).peak_power_w == pytest.approx(judged(wishes).peak_power_w, rel=1e-4)


MACHINES: dict[str, Task] = {
    "offset": Task(OFFSET, PRESS, 5.0),
    "offset the other way": Task(CrankSlider(380.0, 960.0, -300.0), PRESS, 5.0),
    "rod 1.2 cranks": Task(CrankSlider(380.0, 456.0), PRESS, 5.0),
    "rod 50 cranks": Task(CrankSlider(380.0, 19_000.0), PRESS, 5.0),
    "no resistance": Task(BALER_LINKAGE, SliderLoad(), 5.0),
    "table": Task(
        BALER_LINKAGE, SliderLoad(TableResistance((0.0, 200.0, 210.0, 600.0, 760.0), (0.0, 50.0, 3e3, 3e3, 2e4))), 5.0
    ),
    "expression": Task(BALER_LINKAGE, SliderLoad(FormulaResistance("300 + 20000*exp(-(x - 500)**2/2000)")), 5.0),
    "kept negative": Task(BALER_LINKAGE, SliderLoad(PolynomialResistance(FIT, keep_negative=True)), 5.0),
    "driving gear of two lobes": Task(BALER_LINKAGE, PRESS, 2.5, Lobes(2)),
    "tiny": Task(CrankSlider(0.38, 0.96), SliderLoad(PolynomialResistance((1.0,))), 5.0),
    "huge and slow": Task(CrankSlider(38_000.0, 96_000.0), SliderLoad(PolynomialResistance((1e6,))), 0.05),
}


@pytest.mark.tiers(slow=["table"], rest="long")
@pytest.mark.parametrize("name", MACHINES)
def test_other_machines(name: str) -> None:
    """Under four fifths of the power that the fastest even motion takes; 1e-5 for peaks at a table's corners."""
    task = MACHINES[name]
    turns = 2.0 * pi / task.cycle_rad
    ratios = Limits(0.2 / turns, 5.0 / turns)
    wishes = Wishes(ratios, knots=36)
    free = judged(wishes, task)
    least = limit(wishes, task)
    assert least < free.peak_acceleration_mm_s2 < 1.6 * least
    if not free.peak_power_w:
        return
    capped = replace(wishes, limits=replace(ratios, peak_power_w=0.8 * free.peak_power_w))
    found = judged(capped, task)
    assert found.peak_power_w <= 0.8 * free.peak_power_w * (1.0 + 1e-6)
    assert found.convex
    assert limit(capped, task) < found.peak_acceleration_mm_s2
    assert found.peak_acceleration_mm_s2 >= free.peak_acceleration_mm_s2 * (1.0 - 1e-6)


@pytest.mark.tiers(quick=["no resistance"], rest="slow")
@pytest.mark.judges("optimum")
@pytest.mark.parametrize("name", ["no resistance", "kept negative"])
def test_least_power_of_other_machines(name: str) -> None:
    """Nothing to press: any law is best, and one is found."""
    task = MACHINES[name]
    wishes = Wishes(replace(USUAL, peak_acceleration_mm_s2=3e4), goal=Goal.POWER, knots=24)
    found = judged(wishes, task)
    assert found.peak_acceleration_mm_s2 <= 3e4
    assert found.peak_power_w >= limit(wishes, task)


@pytest.mark.slow
def test_speed_scales_away() -> None:
    """Three times the speed: nine times the acceleration, three times the power, and the same law."""
    fast = replace(AT_SIXTY, speed_rad_s=3.0 * AT_SIXTY.speed_rad_s)
    wishes = replace(HALF, limits=replace(HALF.limits, peak_power_w=3.0 * 9375.0))
    slow, found = judged(HALF), judged(wishes, fast)
    assert found.peak_acceleration_mm_s2 == pytest.approx(9.0 * slow.peak_acceleration_mm_s2, rel=1e-6)
    assert law(wishes, fast).ratio == pytest.approx(law(HALF).ratio, abs=1e-6)


@pytest.mark.slow
def test_size_scales_away() -> None:
    """Twice the machine against the same force at the same places: twice the acceleration at twice the power."""
    force = SliderLoad(PolynomialResistance(tuple(c / 2.0**k for k, c in enumerate(FIT))))
    task = Task(CrankSlider(760.0, 1920.0), force, AT_SIXTY.speed_rad_s)
    wishes = replace(HALF, limits=replace(HALF.limits, peak_power_w=2.0 * 9375.0))
    found = judged(wishes, task)
    assert found.peak_acceleration_mm_s2 == pytest.approx(2.0 * judged(HALF).peak_acceleration_mm_s2, rel=1e-6)


@pytest.mark.slow
def test_lobes_of_the_driving_gear_are_a_matter_of_speed() -> None:
    """Two lobes at half the speed: the same motion of the slider, at half the ratio."""
    two = Task(BALER_LINKAGE, PRESS, 30.0 * RPM, Lobes(2))
    wishes = Wishes(Limits(0.1, 2.5, peak_power_w=9375.0), convex=False, knots=36)
    one = replace(HALF, convex=False)
    assert judged(wishes, two).peak_acceleration_mm_s2 == pytest.approx(judged(one).peak_acceleration_mm_s2, rel=1e-5)


@pytest.mark.slow
def test_next_to_no_mass_is_none() -> None:
    light = replace(AT_SIXTY, masses=BALER_LINKAGE.MASSES(slider_kg=1e-6))
    assert judged(HALF, light).peak_acceleration_mm_s2 == pytest.approx(judged(HALF).peak_acceleration_mm_s2, rel=1e-5)


OF_HARMONICS = {
    "baler-66": (6_300.0, None, 33_990.3),
    "baler-half": (9_375.0, 40.0, 19_143.0),
    "baler-smooth": (18_750.0, 20.0, 12_605.0),
}
"""Power in W, tangent angle in degrees without the rack's, and what 36 harmonics came down to under them, in mm/s2."""


@pytest.mark.tiers(slow=["even-baler-66", "even-baler-smooth", "wavy-baler-half"], rest="long")
@pytest.mark.parametrize("name", OF_HARMONICS)
@pytest.mark.parametrize("start", ["even", "wavy"])
def test_never_worse_than_the_laws_of_36_harmonics(name: str, start: str) -> None:
    power_w, angle_deg, before = OF_HARMONICS[name]
    angle = None if angle_deg is None else radians(angle_deg)
    wishes = Wishes(replace(USUAL, peak_power_w=power_w, pressure_angle_rad=angle))
    found = makeable_law(AT_SIXTY, wishes, even(AT_SIXTY) if start == "even" else wavy(1))
    exact = figures(AT_SIXTY, found.train(AT_SIXTY.lobes))
    assert exact.peak_acceleration_mm_s2 < before
    assert exact.peak_power_w <= power_w
    assert exact.tangent_rad <= (angle or np.inf)
    assert exact.convex


STEP = Task(
    CrankSlider(105.0, 300.0),
    SliderLoad(TableResistance((0.0, 50.0, 50.001, 210.0), (0.0, 0.0, 4e3, 4e3))),
    60.0 * RPM,
)
PEAK = Task(
    CrankSlider(105.0, 300.0), SliderLoad(FormulaResistance("1000 + 3000*exp(-((x - 100)/1.5)**2)")), 60.0 * RPM
)


@pytest.mark.tiers(slow=["task1-2000.0"], rest="long")
@pytest.mark.parametrize(("task", "power_w"), [(STEP, 3_000.0), (STEP, 2_000.0), (PEAK, 3_000.0)])
def test_a_step_and_a_narrow_peak_of_the_force_have_laws_near_their_limit(task: Task, power_w: float) -> None:
    """A step of 4000 N within a thousandth of a millimetre, and a peak 3 mm wide."""
    wishes = Wishes(replace(USUAL, peak_power_w=power_w))
    exact = figures(task, makeable_law(task, wishes, even(task)).train(task.lobes))
    assert exact.peak_power_w <= power_w
    assert exact.convex
    assert 1.0 < exact.peak_acceleration_mm_s2 / limit(wishes, task) < 1.02


@pytest.mark.slow
def test_many_knots_are_not_undone_by_the_decimals_of_a_file() -> None:
    """With ten decimals the curve of 720 knots was dented by 3e-6, and a law eleven times as steep was given."""
    few, many = (
        makeable_law(PEAK, Wishes(replace(USUAL, peak_power_w=3_000.0), knots=knots), even(PEAK)).goal
        for knots in (180, 720)
    )
    assert 0.99 * few < many < few


@pytest.mark.tiers(slow=["2000.0"], rest="long")
@pytest.mark.parametrize("power_w", [2_000.0, 2_500.0])
def test_the_power_at_a_narrow_peak_of_the_force_is_kept_exactly(power_w: float) -> None:
    """The judge has places enough for the peak; with sixteen steps between knots, 2e-6 of the power was overlooked."""
    wishes = Wishes(replace(USUAL, peak_power_w=power_w), convex=False)
    assert figures(PEAK, makeable_law(PEAK, wishes, even(PEAK)).train(PEAK.lobes)).peak_power_w <= power_w
