"""A flywheel on the driven shaft found with the law: the best size, the smallest of sizes as good, the limit of all."""

from __future__ import annotations

import json
from dataclasses import replace
from functools import cache
from math import inf
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import quad

import drives
from commands import Run, on_text
from ncgear.design.keys.design import Design
from ncgear.design.reading.design_file import load, parsed
from ncgear.errors import DesignError, NoSuchMechanism
from ncgear.optimum import flywheels
from ncgear.optimum.flywheels import FlywheelLaw, FlywheelSearch, least_with_any, mean_inertia_kg_mm2, with_flywheel
from ncgear.optimum.makeable.wishes import Goal
from ncgear.optimum.task import Task
from ncgear.project.best_law import BestLaw
from ncgear.project.drive import Drive
from ncgear.project.law_task import inertia_as_given, task_of, wishes_of, with_driven_flywheel

KG_M2 = 1e6
"""One kg m^2 in kg mm^2."""


@cache
def baler() -> Design:
    """The baler with all its masses, and no flywheel on its driven shaft."""
    return with_driven_flywheel(drives.loaded("baler-flywheel").design, 0.0)


@cache
def machine() -> Task:
    return task_of(baler(), inertia_as_given(baler()))


def free(text: str, range_: str) -> str:
    """A design file's text with its flywheel free within a range."""
    return text.replace("optimize:\n", f"optimize:\n  driven_flywheel_kg_mm2: {range_}\n")


def text() -> str:
    return (drives.DESIGNS / "baler-flywheel.yaml").read_text(encoding="utf-8")


class OfOneNumber(FlywheelSearch):
    """A search whose laws are replaced by a function of the size: infinite where there is no law."""

    goals: staticmethod

    def _tried(self, size_kg_mm2: float, start: object) -> object:
        goal = self.goals(size_kg_mm2)
        if start is None or goal == inf:
            return None
        law = type("Law", (), {"goal": goal, "motion": "found"})()
        self.found[size_kg_mm2] = FlywheelLaw(size_kg_mm2, law)  # type: ignore[arg-type]
        return "found"

    def _begun(self, size_kg_mm2: float) -> object:
        return "begun"


def chosen(goals: object, least: float, most: float) -> float:
    search = OfOneNumber(machine(), wishes_of(baler()))
    search.goals = goals  # type: ignore[assignment]
    return search.best(least * KG_M2, most * KG_M2).flywheel_kg_mm2 / KG_M2


def test_the_smallest_flywheel_that_is_as_good_as_the_best() -> None:
    """Of a goal that no longer falls from 70 kg m2 on, of a valley, and where small flywheels have no law."""
    levels_off = chosen(lambda size: max(3000.0, 10_000.0 - 100.0 * size / KG_M2), 0.0, 150.0)
    assert 69.9 < levels_off < 71.0
    valley = chosen(lambda size: 5000.0 + (size / KG_M2 - 42.0) ** 2, 0.0, 150.0)
    assert valley == pytest.approx(42.0, abs=2.0)
    assert chosen(lambda size: 5000.0, 3.0, 150.0) == 3.0
    assert chosen(lambda size: inf if size < 60.0 * KG_M2 else 5000.0 + size / KG_M2, 0.0, 150.0) < 80.0
    with pytest.raises(NoSuchMechanism, match="no law was found with any flywheel"):
        chosen(lambda size: inf, 0.0, 150.0)


def test_no_machine_needs_less_than_the_mean_power_with_any_flywheel() -> None:
    """The work of the published resistance over a stroke, by quadrature, at one stroke a second."""

    def force(x: float) -> float:
        return max(0.0, -131.2779 + 3.447 * x + 1.846e-2 * x**2 - 1.575e-4 * x**3 + 2.498e-7 * x**4)

    watts = quad(force, 0.0, 760.0, limit=400)[0] / 1000.0
    wishes = replace(wishes_of(baler()), goal=Goal.POWER)
    assert least_with_any(machine(), wishes) == pytest.approx(watts, rel=1e-6)
    torque = least_with_any(machine(), replace(wishes, goal=Goal.RMS_TORQUE))
    assert torque == pytest.approx(watts / (2.0 * np.pi), rel=1e-6)
    assert least_with_any(machine(), replace(wishes, goal=Goal.BRAKING_POWER)) == 0.0
    # 65 teeth of 2 mm roll the work of the stroke, and 0.76 m in a second need a jerk
    force = least_with_any(machine(), replace(wishes, goal=Goal.TOOTH_FORCE))
    assert force == pytest.approx(1000.0 * watts / (65.0 * np.pi * 2.0), rel=1e-6)
    assert least_with_any(machine(), replace(wishes, goal=Goal.JERK)) == pytest.approx(96.0 * 760.0, rel=1e-9)


def test_the_flywheel_adds_to_all_that_turns_with_the_crank() -> None:
    more = mean_inertia_kg_mm2(with_flywheel(machine(), 5.0 * KG_M2)) - mean_inertia_kg_mm2(machine())
    assert more == pytest.approx(5.0 * KG_M2, rel=1e-9)


@pytest.mark.parametrize(
    ("range_", "said"),
    [
        ("{most: 0}", "driven_flywheel_kg_mm2.most: 0 given, but least is 0 where it is left out"),
        ("{least: 5}", "most"),
    ],
)
def test_a_wrong_range(range_: str, said: str) -> None:
    with pytest.raises(DesignError, match=said):
        parsed(free(text(), range_), Path("d.yaml"))


def test_a_free_flywheel_needs_masses() -> None:
    bare = "name: a\nlinkage: {crank_mm: 38, rod_mm: 96}\noperation: {speed_rpm: 60}\nmotion: {law: uniform_crank}\n"
    with pytest.raises(DesignError, match="without masses there is nothing that a flywheel could take up"):
        parsed(f"{bare}optimize: {{driven_flywheel_kg_mm2: {{most: 1}}}}\n", Path("d.yaml"))


@pytest.mark.slow
def test_of_two_optima_side_by_side_the_better_counts() -> None:
    """With 35 kg m2 a law that is only followed from its neighbour needs a sixteenth more."""
    search = FlywheelSearch(machine(), wishes_of(baler()))
    middle = 35.512 * KG_M2
    own = mean_inertia_kg_mm2(machine())
    end = (own + middle) ** 2 / own - own
    found = {one.flywheel_kg_mm2: one.goal for one in search.of_sizes(0.0, end, 3)}
    assert sorted(found)[1] == pytest.approx(middle, rel=1e-9)
    neighbour = FlywheelSearch(machine(), wishes_of(baler()))
    last = neighbour._begun(24.767 * KG_M2)
    for size in (24.767 * KG_M2, sorted(found)[1]):
        last = neighbour._tried(size, last)
    assert found[sorted(found)[1]] < neighbour.found[sorted(found)[1]].goal / 1.05


@pytest.mark.long
@pytest.mark.slow
def test_law_and_flywheel_of_the_baler_together(run: Run) -> None:
    """No size of a grid, each searched for by itself with all knots, needs less; the file says what was found."""
    asked = free(text(), "{most: 150e6}")
    status, out, err = on_text(run, "optimize", "--verbose")(asked)
    assert (status, err) == (0, "")
    folder = Path("export/baler-flywheel-optimized")
    told = json.loads((folder / "certificate.json").read_text())
    again = load(folder / "baler-flywheel-optimized.yaml").design
    assert again.masses is not None
    size, power = again.masses.driven_flywheel_kg_mm2, told["law"]["peak_power_w"]
    assert told["driven_flywheel"]["inertia_kg_mm2"] == size
    assert f"a flywheel of {size / KG_M2:.4g} kg m2 on the driven shaft, the best of 0 to 150" in " ".join(out.split())
    assert told["driven_flywheel"]["limit_with_any"] <= told["goal"]["limit"] <= power <= 3_400.0
    # Judged anew from the file
    law = Drive(again).check.peak_power_w.value
    assert law == pytest.approx(power, rel=1e-6)
    for other in (20.0, 90.0, 150.0):
        alone = BestLaw(with_driven_flywheel(baler(), other * KG_M2))
        assert power <= alone.figures.peak_power_w + flywheels.AS_GOOD * 1e4


@pytest.mark.slow
def test_power_against_the_flywheel(run: Run) -> None:
    asked = free(text(), "{least: 50e6, most: 150e6}").replace("optimize:\n", "optimize:\n  knots: 24\n")
    status, _, err = on_text(run, "frontier", "--flywheel", "--points", "3")(asked)
    assert (status, err) == (0, "")
    folder = Path("export/baler-flywheel-frontier")
    points = json.loads((folder / "flywheel.json").read_text())["points"]
    assert [points[0]["driven_flywheel_kg_mm2"], points[-1]["driven_flywheel_kg_mm2"]] == [50e6, 150e6]
    powers = [one["law"]["peak_power_w"] for one in points]
    assert powers == sorted(powers, reverse=True)
    assert all(one["limit_power_w"] <= power for one, power in zip(points, powers, strict=True))
    assert len((folder / "flywheel.csv").read_text().splitlines()) == 4
    assert (folder / "flywheel.png").read_bytes().startswith(b"\x89PNG")
    status, _, err = on_text(run, "frontier", "--flywheel")(text())
    assert status == 2
    assert "optimize.driven_flywheel_kg_mm2: missing; give the range of sizes" in err
