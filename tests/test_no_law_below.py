"""No law lies below a limit that is told, with heavy gears that follow the law; and files have what is said."""

from __future__ import annotations

import json
from dataclasses import replace
from functools import cache, reduce
from math import inf
from pathlib import Path

import pytest

from commands import Run, on_text
from drives import drive_of_text
from heavy_gears import heavy, laws_beside
from ncgear.design.reading.design_file import load
from ncgear.design.template import MachineName, machine_template
from ncgear.mechanisms.crank_slider import CrankSlider
from ncgear.mechanisms.forces import RodMasses
from ncgear.mechanisms.resistance import PolynomialResistance
from ncgear.mechanisms.slider_load import SliderLoad
from ncgear.optimum.frontier import limit_points
from ncgear.optimum.makeable.demanded import certified_limit, demands_of, not_covered
from ncgear.optimum.makeable.wishes import Goal, TwoStages, Wishes
from ncgear.optimum.task import Limits, Task
from ncgear.project.best_law import BestLaw
from ncgear.project.drive import Drive

pytestmark = pytest.mark.judges("optimum")

EXACT = 1e-9
"""Figures are exact but for rounding."""

PUMP = machine_template("pump", MachineName.PUMP).replace("speed_rpm: 120", "speed_rpm: 600")
CHANGED = {
    "peak_acceleration_mm_s2: 10000": "peak_acceleration_mm_s2: 250000",
    "goal: least_power": "goal: least_power\n  knots: 48",
    "sine: [0.35]": "sine: [0.05]",
}
FAST = reduce(lambda text, change: text.replace(*change), CHANGED.items(), PUMP)
"""Five times as fast, and given with gears that are nearly round."""


@cache
def best(text: str) -> BestLaw:
    return BestLaw(drive_of_text(text).design)


@pytest.mark.tiers(slow=["convex-0"], rest="long")
@pytest.mark.parametrize("seed", range(15))
@pytest.mark.parametrize("convex", [True, False], ids=["convex", "dented"])
def test_no_law_of_heavy_gears_is_below_the_limit(seed: int, convex: bool) -> None:
    """The law found, the even one, kept ones and random ones, all with the gears that the limit holds for."""
    found = best(heavy(seed, convex=convex))
    limit, price = found.limit, found.wishes.prices.of
    assert limit is not None
    assert found.bound is not None
    assert price(found.figures) >= limit.value * (1.0 - EXACT)
    beside = {name: price(one) for name, one in laws_beside(found.task, found.wishes, seed, 12)}
    assert {name: value for name, value in beside.items() if value < limit.value * (1.0 - EXACT)} == {}


@pytest.mark.long
@pytest.mark.slow
def test_a_limit_for_gears_of_a_quarter_less_weight_is_above_a_law() -> None:
    """Negative control, of braking power: the gears store what would flow back."""
    found = best(heavy(2))
    assert found.limit is not None
    inertia = found.task.moving.driven_inertia_kg_mm2 * 0.75
    lighter = replace(found.task, masses=replace(found.task.moving, driven_inertia_kg_mm2=inertia))
    other = certified_limit(lighter, found.wishes)
    assert other is not None
    assert found.limit.value <= found.goal < other.value


@pytest.mark.tiers(slow=["least_braking_power"], rest="long")
@pytest.mark.parametrize("goal", ["least_power", "least_braking_power"])
def test_the_file_has_what_is_said_of_its_law(run: Run, goal: str) -> None:
    text = FAST.replace("least_power", goal).replace("ratio_min: 0.4", "ratio_min: 0.65")
    status, _, _ = on_text(run, "optimize")(text)
    assert status == 0
    folder = Path("export/pump-optimized")
    told = json.loads((folder / "certificate.json").read_text())
    made = Drive(load(folder / "pump-optimized.yaml").design)
    power = made.check.with_masses
    assert power is not None
    assert made.check.peak_power_w.value == pytest.approx(told["law"]["peak_power_w"], rel=1e-4)
    assert power.braking_power_w.value == pytest.approx(told["law"]["braking_power_w"], rel=1e-4)
    assert power.rms_torque_n_m == pytest.approx(told["law"]["rms_torque_n_m"], rel=1e-4)
    least = {"least_power": made.check.peak_power_w.value, "least_braking_power": power.braking_power_w.value}[goal]
    assert told["goal"]["law"] == pytest.approx(least, rel=1e-4)
    assert told["goal"]["limit"] <= told["goal"]["law"] * (1.0 + EXACT)
    # The certificate holds for the inertia of the gears that the file makes
    held_for = told["masses"]["driven_inertia_kg_mm2"]
    assert made.masses.driven_inertia_kg_mm2 == pytest.approx(held_for, rel=1e-9)
    # Negative control: the gears as given are others
    assert drive_of_text(text).masses.driven_inertia_kg_mm2 != pytest.approx(held_for, rel=1e-3)


@pytest.mark.long
@pytest.mark.slow
def test_a_limit_that_only_other_gears_keep_is_not_refused() -> None:
    """The gears as given are lighter than those of the best law, and no law with them has so little power."""
    free = best(FAST)
    as_given = free.begun.bound
    assert as_given is not None
    assert free.goal < as_given.value * (1.0 - 1e-3)
    cap = (free.goal + as_given.value) / 2.0
    capped = best(FAST.replace("ratio_min: 0.4", f"ratio_min: 0.4\n    peak_power_w: {cap!r}"))
    assert capped.goal <= cap
    assert capped.limit is not None
    assert capped.limit.value <= capped.goal


SHARED = Wishes(Limits(0.4, 2.5, peak_power_w=1.0, rms_torque_n_m=0.001), goal=Goal.POWER, two_stages=TwoStages(None))
MASSES = RodMasses(slider_kg=3.0, between_inertia_kg_mm2=(1300.0,))
BETWEEN = Task(CrankSlider(30.0, 120.0), SliderLoad(PolynomialResistance((400.0,))), 63.0, masses=MASSES)


def test_a_limit_knows_nothing_of_a_shaft_between_two_pairs() -> None:
    """No limits of power and torque then, as low as they may be asked for: only of the motion."""
    asked = demands_of(BETWEEN, SHARED)
    assert (asked.power_w, asked.torque_n_mm, asked.braking_w, asked.fluctuation_n_mm) == (inf,) * 4
    assert certified_limit(BETWEEN, SHARED) is None
    assert limit_points(BETWEEN, SHARED, 1e4) == []
    assert any("shaft between" in said for said in not_covered(BETWEEN, SHARED))
    # Without inertia there it knows them, and of one pair there is no such shaft
    still = replace(BETWEEN, masses=replace(MASSES, between_inertia_kg_mm2=()))
    for task, wishes in ((still, SHARED), (BETWEEN, replace(SHARED, two_stages=None))):
        known = demands_of(task, wishes)
        assert (known.power_w, known.torque_n_mm) == (1.0, pytest.approx(1.0))
        assert not any("shaft between" in said for said in not_covered(task, wishes))


@pytest.mark.long
@pytest.mark.slow
def test_a_shaft_between_brings_laws_below_the_limit_without_it() -> None:
    """Why the limit of power is unknown then: what the shaft stores takes a quarter of the power off."""
    text = FAST.replace("limits:", "limits:\n    stages: 2").replace("    free_of_undercut: true\n", "")
    found = best(text.replace("wishes:\n  time_ratio: {at_least: 1.5}", "").replace("pressure_angle_deg: 55", ""))
    assert found.bound is found.limit is None
    without = replace(found.task, masses=replace(found.task.moving, between_inertia_kg_mm2=()))
    least = certified_limit(without, found.wishes)
    assert least is not None
    assert found.goal < 0.98 * least.value
