"""Branch and bound: its limits beside laws and a known optimum, what it needs, and what wrong ranges would prove."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import inf
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from at_once import at_once
from kept_laws import FILES, KeptLaw, kept
from ncgear.design.reading.design_file import load
from ncgear.mechanisms.forces import RodMasses
from ncgear.numerics.arrays import Array
from ncgear.optimum.certified import limit, sums
from ncgear.optimum.certified.cycle import CrankCycle, cycle
from ncgear.optimum.certified.demands import Demands
from ncgear.optimum.certified.limit import Motion
from ncgear.optimum.certified.proof import Solver
from ncgear.optimum.certified.sums import PLACES_RAISED, raised
from ncgear.optimum.certified.tree import Budget, Effort, MotionBox, Tree, proven
from ncgear.optimum.makeable.demanded import MOST_PROGRAMMES, demands_of
from ncgear.optimum.task import figures
from ncgear.project.best_law import BestLaw
from ncgear.ratio.laws.uniform import uniform_law
from ncgear.ratio.transmission import single
from published import AT_SIXTY, PRESS

pytestmark = pytest.mark.judges("optimum")

EXACT = 1.0 + 1e-9

MACHINE = """\
name: wished
linkage: {{crank_mm: 45, rod_mm: 160}}
operation: {{speed_rpm: 50}}
motion: {{law: uniform_crank}}
resistance: {{friction_n: 60}}
wishes:
  {wishes}
optimize: {{goal: least_acceleration, knots: 90, limits: {{{limits}}}}}
"""
LIMITS = "ratio_min: 0.3, ratio_max: 4"
DENTED = f"{LIMITS}, convex: false, pressure_angle_deg: 65"

SPEEDS = """speed_at: [{at_mm: 72, at_most_mm_s: 70}, {at_mm: 36, at_least_mm_s: 280}]
  constant_speed: [{from_mm: 14, to_mm: 60, stroke: return, tolerance: 0.02}]"""
DWELL = "dwell: [{at: extended, within_mm: 1, for_deg: 55}]"
DWELLS = "dwell: [{at: retracted, within_mm: 1.4, for_deg: 48}, {at: extended, within_mm: 1.4, for_deg: 45}]"


HEAVY_SLIDER = """\
name: heavy-slider
linkage: {crank_mm: 45, rod_mm: 160}
operation: {speed_rpm: 200}
motion: {law: uniform_crank}
resistance: {polynomial_n: [800]}
masses:
  slider_kg: 12
  rod: {mass_kg: 1, center_mm: 60, inertia_kg_mm2: 3000}
  crank: {mass_kg: 1, center_mm: 10, inertia_kg_mm2: 1000}
optimize: {goal: least_power, knots: 90, limits: {ratio_min: 0.3, ratio_max: 3, convex: false, pressure_angle_deg: 55}}
"""


def best_of(folder: Path, text: str) -> BestLaw:
    path = folder / "wished.yaml"
    path.write_text(text)
    return BestLaw(load(path).design)


@pytest.mark.long
@pytest.mark.slow
@pytest.mark.parametrize(
    ("text", "before", "gap"),
    [
        (MACHINE.format(wishes=SPEEDS, limits=LIMITS), 0.1, 0.02),
        (MACHINE.format(wishes=DWELL, limits=LIMITS), 0.02, 0.015),
        (MACHINE.format(wishes=DWELLS, limits=LIMITS), 0.1, 0.03),
        (MACHINE.format(wishes=DWELLS, limits=DENTED), 0.19, 0.03),
        (HEAVY_SLIDER, 0.08, 0.01),
    ],
    ids=["speeds", "dwell", "dwells", "dwells, dented", "heavy slider, dented"],
)
def test_limits_come_near_the_law(tmp_path: Path, text: str, before: float, gap: float) -> None:
    """Ranges of the ratio that are not divided, or not looked for at all, leave what is ``before``."""
    best = best_of(tmp_path, text)
    assert best.bound is not None
    assert best.limit is not None
    assert best.limit.effort is not None
    assert best.goal / best.bound.value - 1.0 > before
    assert -1e-9 < best.goal / best.limit.value - 1.0 < gap
    assert best.limit.effort.programmes < 1.05 * MOST_PROGRAMMES


def about(law: KeptLaw, prices: dict[str, float], times: float, most: int) -> tuple[float, Effort]:
    """The limit, over what the law has, that is raised towards more than that; its own other figures are demanded."""
    asked = law.demands()
    own = {name: getattr(asked, name) for name in prices}
    free = replace(asked, **dict.fromkeys(prices, inf))
    wanted = {name: times * value for name, value in own.items()}
    value, effort = raised(law.task, free, prices, wanted, law.motion, Budget(most))
    return value / sum(price * own[name] for name, price in prices.items()), effort


ACCELERATION, BOTH_POWERS = {"acceleration_mm_s2": 1.0}, {"power_w": 1.0, "braking_w": 1.0}


@pytest.mark.long
@pytest.mark.slow
def test_the_gap_closes_with_the_number_of_programmes() -> None:
    """Of what the design asks, under a law that it has."""
    law, best = kept("designs/baler-real"), BestLaw(load(FILES["designs/baler-real"]).design)
    asked, own = demands_of(best.task, best.wishes), law.demands()
    felt = {name: getattr(own, name) for name in BOTH_POWERS}
    found = [raised(best.task, asked, BOTH_POWERS, felt, law.motion, Budget(most)) for most in (100, 500, 1000, 2000)]
    shares, parts = [value / sum(felt.values()) for value, _ in found], [effort.parts for _, effort in found]
    assert shares == sorted(shares)
    assert shares[0] < 0.9
    assert 0.98 < shares[-1] <= 1.0
    assert parts[0] < parts[-1]


@pytest.mark.long
@pytest.mark.slow
def test_the_same_limit_comes_out_again() -> None:
    law = kept("designs/pump-both-ways")
    assert about(law, {"power_w": 1.0}, 1.0, 150) == about(law, {"power_w": 1.0}, 1.0, 150)


@pytest.mark.parametrize("width", [0.003, 0.02])
def test_ratios_that_leave_next_to_nothing_have_a_known_optimum(width: float) -> None:
    """Within such ratios no figure is further from the uniform crank's than powers of q and its rate allow."""
    task = replace(AT_SIXTY, load=PRESS, masses=RodMasses(slider_kg=15.0))
    crank = figures(task, single(uniform_law(task.lobes)))
    asked = Demands(1.0 - width, 1.0 + width, convex=True)
    even = Motion(np.linspace(0.0, 6.0, 7), np.ones(7))
    value, effort = raised(
        task, asked, ACCELERATION, {"acceleration_mm_s2": crank.peak_acceleration_mm_s2}, even, Budget(150)
    )
    assert 1.0 - 4.0 * width - 1e-3 < value / crank.peak_acceleration_mm_s2 <= 1.0
    assert effort.parts <= 2


@dataclass
class Watched:
    """The boxes that are left whenever a target was tried, with the target."""

    left: list[tuple[float, Sequence[MotionBox]]]

    def of(self, monkeypatch: pytest.MonkeyPatch) -> None:
        emptied = Tree.emptied

        def watched(tree: Tree, boxes: Sequence[MotionBox], target: float, until: int) -> list[MotionBox]:
            left = emptied(tree, boxes, target, until)
            self.left.append((target, left))
            return left

        monkeypatch.setattr(Tree, "emptied", watched)


def q_of(law: KeptLaw, angle_rad: Array) -> Array:
    machine = law.machine
    return np.append(
        law.train.whole.driven_angle(np.zeros(1), 1).derivative(1) ** 2,
        law.train.whole.driven_angle(machine.driving_angles(angle_rad[1:]), 1).derivative(1) ** 2,
    )


def grids(law: KeptLaw) -> list[CrankCycle]:
    return [cycle(law.task, places, law.demands().places_rad) for places in (PLACES_RAISED, 2 * PLACES_RAISED)]


def inside(box: MotionBox, at: dict[int, Array]) -> bool:
    """Whether a law lies in a box, from its q at the places of either grid."""
    q = at[box.known.least.size]
    return bool(np.all((box.known.least <= q * EXACT) & (q <= box.known.most * EXACT)))


@pytest.mark.long
@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "prices"),
    [
        ("designs/pump-both-ways", BOTH_POWERS),
        ("designs/baler-real", BOTH_POWERS),
        ("designs/baler-half", ACCELERATION),
        ("designs/baler-dynamics", BOTH_POWERS),
    ],
    ids=["designs/pump-both-ways", "designs/baler-real", "designs/baler-half", "designs/baler-dynamics"],
)
def test_a_law_below_the_target_stays_in_one_of_the_boxes(
    name: str, prices: dict[str, float], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of whatever is done to boxes, nothing may leave out a motion that is there."""
    law, watched = kept(name), Watched([])
    watched.of(monkeypatch)
    share, _ = about(law, prices, 1.1, 400)
    assert share <= EXACT
    own = sum(getattr(law.demands(), name) for name in prices)
    at = {on.count: q_of(law, on.crank_angle_rad) for on in grids(law)}
    seen = 0
    for target, boxes in watched.left:
        if target > own * EXACT:
            assert any(inside(box, at) for box in boxes)
            seen += len(boxes)
    assert seen > 2


@pytest.mark.long
@pytest.mark.slow
def test_ranges_that_leave_a_half_out_prove_too_much(monkeypatch: pytest.MonkeyPatch) -> None:
    """Negative control: where cuts leave only the half without the law, the judge above finds the limit wrong."""
    law = kept("designs/rocker-drive")
    halves = Tree.halves
    at = {on.count: q_of(law, on.crank_angle_rad) for on in grids(law)}

    def wrong(tree: Tree, box: MotionBox) -> list[MotionBox]:
        return [half for half in halves(tree, box) if not inside(half, at)]

    monkeypatch.setattr(Tree, "halves", wrong)
    share, _ = about(law, {"power_w": 1.0}, 1.3, 1500)
    assert share > 1.01


class OnALine(Tree):
    """A tree whose motions are numbers; a box is an interval, its value the least that a slope leaves possible."""

    def bounded(self, box: MotionBox, target: float) -> MotionBox | None:
        low, high = box.figures["x"]
        value = max(box.value, wavy((low + high) / 2.0) - STEEPEST * (high - low) / 2.0)
        return replace(box, value=value) if value < target else None

    def narrowed(self, box: MotionBox, target: float, worth: float = 0.0) -> MotionBox | None:
        self.budget.spend(1)
        return self.bounded(box, target)

    def halves(self, box: MotionBox) -> Any:
        low, high = box.figures["x"]
        middle = (low + high) / 2.0
        return [replace(box, figures={"x": part}) for part in ((low, middle), (middle, high)) if high - low > 1e-4]


STEEPEST = 9.5


def wavy(x: Any) -> Any:
    """Two valleys of nearly the same depth."""
    return 3.0 + np.cos(9.0 * x) + 0.5 * x


LEAST = float(wavy(np.linspace(0.0, 1.5, 200001)).min())


@at_once(("most", "above"), [(0, 1.0), (3, 1.0), (10, 1.0), (300, 1.0), (300, 1.02), (300, 1.3), (3000, 1.0)])
def test_a_least_value_is_proven_as_far_as_the_programmes_go(most: int, above: float) -> None:
    """Never above what a number has, and close below where there are enough programmes, whatever law was found."""
    budget = Budget(most)
    tree = OnALine(*[SimpleNamespace(on=SimpleNamespace(count=7))] * 3, budget, Solver())  # type: ignore[arg-type]
    whole: Any = MotionBox(None, {"x": (0.0, 1.5)}, 0.4)  # type: ignore[arg-type]
    value, effort = proven(tree, whole, above * LEAST, 0.0)
    assert 0.4 <= value <= LEAST
    assert (effort.programmes, effort.ended) == (budget.used, budget.used < most)
    assert effort.programmes <= most + 1
    if most >= 300:
        assert value > 0.98 * LEAST
    if most == 3000:
        assert value > 0.998 * LEAST
        assert effort.ended


@at_once(("without", "asked"), [(8.0, 0), (7.0, 0), (5.0, 1)])
def test_a_law_is_the_limit_at_once_only_where_no_motion_has_less(without: float, asked: int) -> None:
    on = SimpleNamespace(crank_angle_rad=np.array([0.0, 1.0]), count=2)
    trials = SimpleNamespace(least=lambda *_: SimpleNamespace(value=without))
    tree = SimpleNamespace(lacking=lambda *_: 0.0)
    came: list[Any] = []

    def looked(*given: Any) -> tuple[float, Effort]:
        came.append(given)
        return 6.0, Effort(9, 9, 2, True)

    with pytest.MonkeyPatch.context() as patched:
        patched.setattr(limit, "problem_of", lambda *_: SimpleNamespace(on=on))
        patched.setattr(sums, "_trials", lambda *_: trials)
        patched.setattr(sums, "halves", lambda _: [])
        patched.setattr(sums, "whole_tree", lambda *_: (tree, None))
        patched.setattr(sums, "proven", looked)
        motion: Any = SimpleNamespace(crank_angle_rad=on.crank_angle_rad, turning=np.array([2.0, 3.0]))
        nothing: Any = None
        value, _ = sums._raised_on(9, nothing, nothing, {"a": 2.0, "b": 0.5}, {"a": 3.0, "b": 2.0}, motion, Budget(5))
    assert (value, len(came)) == ((6.0 if asked else 7.0), asked)
