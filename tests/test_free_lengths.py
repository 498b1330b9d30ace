"""Lengths of the mechanism found with the law: the search among them, the stroke that is held, the limit of all."""

from __future__ import annotations

import json
from itertools import product
from math import inf, sqrt
from pathlib import Path

import numpy as np
import pytest

import drives
from at_once import at_once
from commands import Run, on_text
from ncgear.design.keys.design import Design
from ncgear.design.mechanisms import mechanism_of
from ncgear.design.reading.design_file import load, parsed
from ncgear.design.template import MachineName, machine_template
from ncgear.errors import DesignError, NoSuchMechanism
from ncgear.numerics.jet import Jet
from ncgear.optimum.lengths import LengthSearch, TriedLaw, Unknown, Values, least_with_any_lengths
from ncgear.optimum.makeable.wishes import Goal
from ncgear.project.best_law import BestLaw
from ncgear.project.drive import Drive
from ncgear.project.free_lengths import with_lengths
from ncgear.project.law_task import inertia_as_given, task_of, wishes_of
from ncgear.whole_machines.laws import LawJob, laws_of, with_best_lengths

ASKED = """
optimize:
  goal: least_flank_load
  limits: {peak_power_w: 8174, peak_acceleration_mm_s2: 25000, pressure_angle_deg: 60}
  knots: 60
  lengths: LENGTHS
"""


def holding(lengths: str = "{rod_mm: {least: 900, most: 2000}, offset_mm: {least: -300, most: 300}}") -> str:
    """The baler whose teeth hold, under equal power and acceleration, with lengths that are free."""
    text = (drives.DESIGNS / "baler-holds.yaml").read_text(encoding="utf-8")
    return text + ASKED.replace("LENGTHS", lengths)


def design(text: str) -> Design:
    return parsed(text, drives.DESIGNS / "d.yaml").design


class OfNumbers(LengthSearch):
    """A search whose laws are replaced by a function of the values: infinite where there is no law."""

    cost: staticmethod

    def _law(self, values: Values, start: object) -> TriedLaw | None:
        cost = self.cost(*values)
        return None if cost == inf else TriedLaw(values, None, cost)  # type: ignore[arg-type]


def chosen(cost: object, *unknowns: Unknown) -> Values:
    search = OfNumbers(unknowns, lambda values: None)  # type: ignore[arg-type, return-value]
    search.cost = cost  # type: ignore[assignment]
    found = search.best().values
    assert len(search.found) < 20 * len(unknowns)
    return found


def test_the_best_of_lengths_by_known_functions() -> None:
    """A valley that lies askew, a goal that falls to a corner, a part without laws, and nothing to gain."""
    rod, offset = Unknown(900.0, 2000.0, 960.0), Unknown(-300.0, 300.0, 0.0)
    valley = chosen(lambda a, b: 5.0 + ((a - 1300) / 500) ** 2 + ((a - 1300) / 500 - (b + 90) / 200) ** 2, rod, offset)
    assert valley == pytest.approx((1300.0, -90.0), abs=12.0)
    assert chosen(lambda a, b: 9.0 - a / 2000.0 - b / 600.0, rod, offset) == (2000.0, 300.0)
    walled = chosen(lambda a, b: inf if a > 1500.0 or b < -100.0 else 9.0 - a / 1500.0 + b / 600.0, rod, offset)
    assert walled[0] == pytest.approx(1500.0, rel=0.03)
    assert walled[1] == pytest.approx(-100.0, abs=30.0)
    corner = chosen(lambda a, b: inf if a < 1200.0 or b < 100.0 else 5.0 + a / 1000.0 + b / 1000.0, rod, offset)
    assert sum(corner) < 1.12 * 1300.0
    assert chosen(lambda a, b: 7.0 - 1e-7 * a, rod, offset) == (960.0, 0.0)
    # As given, the least of the range is nearest
    assert chosen(lambda a: 7.0, Unknown(1000.0, 2000.0, 960.0)) == (1000.0,)
    with pytest.raises(NoSuchMechanism, match="no law was found with any lengths of the ranges"):
        chosen(lambda a: inf, rod)


@at_once(
    ("name", "values"),
    [
        ("baler-holds", {"rod_mm": 1300.0, "offset_mm": 250.0}),
        ("baler-holds", {"stroke_mm": 700.0}),
        ("rocker-drive", {"coupler_mm": 1.1, "rocker_mm": 1.05}),
        ("quick-return-shaper", {"pivot_mm": 1.2}),
        ("scotch-yoke-pump", {"stroke_mm": 90.0}),
    ],
)
def test_the_stroke_is_held_by_the_crank(name: str, values: dict[str, float]) -> None:
    """The way of the output, at a hundred thousand crank angles; values near 1 are factors."""
    given = drives.loaded(name).design
    values = {key: value if value > 2.0 else value * getattr(given.linkage, key) for key, value in values.items()}
    before, after = mechanism_of(given.linkage), mechanism_of(with_lengths(given, values).linkage)
    way = after.displacement(Jet.variable(np.linspace(0.0, 2.0 * np.pi, 100_001), 0)).value
    wanted = values.get("stroke_mm", before.stroke_mm)
    assert 0.0 <= np.ptp(way) - wanted * (1.0 - 1e-9) < 1e-5
    assert all(getattr(after, key) == value for key, value in values.items() if key != "stroke_mm")
    assert with_lengths(given, {key: getattr(before, key) for key in values}) is given


def test_a_longer_rod_keeps_its_section() -> None:
    """A bar of even section has its mass by its length, and m l^2/12; the crank gives the stroke by Pythagoras."""
    given = drives.loaded("baler-holds").design
    longer = with_lengths(given, {"rod_mm": 1920.0, "offset_mm": 200.0})
    assert longer.masses is not None
    rod = longer.masses.rod
    assert (rod.mass_kg, rod.center_mm, rod.inertia_kg_mm2) == (60.0, 860.0, 2.8e6 * 8.0)
    assert longer.masses.crank == given.masses.crank
    crank = longer.linkage.crank_mm
    ends = [sqrt((1920.0 + side * crank) ** 2 - 200.0**2) for side in (1.0, -1.0)]
    assert ends[0] - ends[1] == pytest.approx(760.0, abs=1e-5)
    with pytest.raises(DesignError, match="cannot give the stroke"):
        with_lengths(given, {"rod_mm": 390.0, "offset_mm": 200.0})


@at_once(
    ("lengths", "said"),
    [
        ("{coupler_mm: {least: 1, most: 2}}", "this mechanism has rod_mm, offset_mm and stroke_mm"),
        ("{stroke_deg: {least: 1, most: 2}}", "this mechanism has rod_mm, offset_mm and stroke_mm"),
        ("{rod_mm: {least: 1000, most: 1000}}", "but least is 1000; over 1000 is right"),
        ("{rod_mm: {least: 0, most: 1000}}", "least"),
    ],
)
def test_wrong_ranges_of_lengths(lengths: str, said: str) -> None:
    with pytest.raises(DesignError, match=said):
        design(holding(lengths))


def test_what_every_mechanism_needs() -> None:
    """Parabolas, a triangle and the known jerk; they depend on the stroke alone, and so does the mean power."""
    given = design(holding())
    task, wishes = task_of(given, inertia_as_given(given)), wishes_of(given)

    def least(goal: Goal, stroke: float | None = None) -> float:
        return least_with_any_lengths(task, wishes.__class__(wishes.limits, goal), stroke)

    # There and back in a second: a parabola of 16 h/T^2 turns round at a quarter and three quarters of it
    time = np.linspace(0.0, 1.0, 100_001)
    speed = np.cumsum(np.where((time + 0.25) % 1.0 < 0.5, 1.0, -1.0)) * (time[1] - time[0])
    way = np.cumsum(speed - speed.mean()) * (time[1] - time[0])
    assert least(Goal.ACCELERATION) == pytest.approx(760.0 / np.ptp(way), rel=1e-4)
    assert least(Goal.SPEED) == pytest.approx(1520.0, rel=1e-6)
    assert least(Goal.JERK, 500.0) == pytest.approx(96.0 * 500.0, rel=1e-6)
    assert least(Goal.POWER) == pytest.approx(task.work_n_mm / 1000.0, rel=1e-6)
    assert least(Goal.POWER, 500.0) == 0.0
    assert least(Goal.FLANK_LOAD) > 3e6


@pytest.mark.long
@pytest.mark.slow
def test_rod_and_offset_of_the_baler(run: Run) -> None:
    """No lengths of a grid, each searched for by themselves, need less; the file's own figures are those told."""
    status, out, err = on_text(run, "optimize", "--verbose")(holding())
    assert (status, err) == (0, "")
    assert "rod 2000 mm (900 to 2000), offset 300 mm (-300 to 300) and crank 375.5 mm" in " ".join(out.split())
    folder = Path("export/baler-holds-optimized")
    told = json.loads((folder / "certificate.json").read_text())
    again = load(folder / "baler-holds-optimized.yaml").design
    assert told["lengths"]["values"] == {"rod_mm": 2000.0, "offset_mm": 300.0}
    assert (again.linkage.rod_mm, again.linkage.offset_mm) == (2000.0, 300.0)
    assert Drive(again).check.peak_power_w.value == pytest.approx(told["law"]["peak_power_w"], rel=1e-6)
    load_found = told["law"]["flank_load_n_mm"]
    assert told["lengths"]["limit_with_any"] <= told["goal"]["limit"] <= load_found
    given = design(holding("{}"))
    for rod, offset in product((960.0, 1500.0, 2000.0), (-150.0, 0.0, 250.0)):
        alone = BestLaw(with_lengths(given, {"rod_mm": rod, "offset_mm": offset})).figures.flank_load_n_mm
        assert alone is not None
        assert load_found < alone
        if (rod, offset) == (960.0, 0.0):
            assert load_found < 0.87 * alone


@pytest.mark.slow
def test_a_yoke_whose_stroke_is_free_has_the_least() -> None:
    """Every peak of a yoke is in proportion to its stroke, at any law."""
    text = """
name: yoke
linkage: {kind: scotch_yoke, crank_mm: 50}
operation: {speed_rpm: 30}
motion: {law: uniform_crank}
optimize: {limits: {pressure_angle_deg: 40}, knots: 40, lengths: {stroke_mm: {least: 60, most: 120}}}
"""
    found, held = BestLaw(design(text)), BestLaw(with_lengths(design(text), {"stroke_mm": 60.0}))
    assert found.lengths is not None
    assert found.lengths.values == {"stroke_mm": 60.0}
    assert found.design.linkage.crank_mm == pytest.approx(30.0)
    given = design(text.replace(", lengths: {stroke_mm: {least: 60, most: 120}}", ""))
    assert found.goal == pytest.approx(0.6 * BestLaw(given).goal, rel=1e-4)
    assert held.design.linkage.crank_mm == pytest.approx(30.0)
    assert found.lengths.least_with_any == pytest.approx(16.0 * 60.0 / 2.0**2, rel=1e-6)


@pytest.mark.long
@pytest.mark.slow
def test_whole_machines_have_the_best_lengths_for_the_flank_load() -> None:
    """A pump's text with other lengths, whose law has less flank load; all else of the file stays."""
    text = machine_template("pump", MachineName.PUMP)
    lengths = "  lengths: {offset_mm: {least: -25, most: 25}}\n"
    given = parsed(text.replace("optimize:\n", f"optimize:\n{lengths}"), Path("pump.yaml"))
    tried: list[int] = []
    found, chosen = with_best_lengths(given, tried.append)
    assert set(chosen) == {"offset_mm"}
    assert found.design.linkage.offset_mm == chosen["offset_mm"] != 0.0
    assert found.design.linkage.crank_mm < 30.0
    assert found.design.gears == given.design.gears
    assert tried
    loads_found = [laws_of(one, LawJob(0.0, None))[-1].flank_load_n_mm for one in (given.design, found.design)]
    assert loads_found[1] < 0.98 * loads_found[0]
