"""Strays of curves, angles of many designs, hobs over hollows and told costs, on a few numbers by hand."""

from __future__ import annotations

from math import pi, tan
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import ncgear.metrology.cut_by as cut_by
from at_once import at_once
from ncgear.contact.designed import curves
from ncgear.design.reading.yaml import read_yaml
from ncgear.errors import WrongInput
from ncgear.figures.answers import simulated
from ncgear.metrology.cut_by import HARMLESS, CutVerdict
from ncgear.pitch.shape import Gear
from ncgear.screening.batch import Batch
from ncgear.whole_machines.told import _told

Made: Any = SimpleNamespace


@pytest.mark.judges("contact")
@pytest.mark.parametrize("sense", [1.0, -1.0])
def test_an_arc_strays_by_half_of_the_triangle_of_its_chord_and_tangents(sense: float) -> None:
    """Arcs of 0.3 and 0.2 rad of 10 mm, whose parameter rises or falls along the run."""
    turned = np.array([0.4, 0.7, 0.9])
    point = 10.0 * np.exp(1j * turned)
    runs = Made(start=np.array([5.0]), end=np.array([5.0 + 2.0 * sense]))
    of: Any = Made(point=point[None], slope=sense * 1j * point[None], runs=runs)
    found = curves.SidePaths.stray_mm.func(of)  # type: ignore[attr-defined]
    chord = np.abs(np.diff(point))
    heights = chord / 2.0 * np.array([tan(0.15), tan(0.1)])
    assert found == pytest.approx(heights[None])
    assert np.all(10.0 * (1.0 - np.cos([0.15, 0.1])) < found[0])


@pytest.mark.judges("design")
def test_a_number_that_is_too_large_has_the_place_to_which_the_text_is_read() -> None:
    with pytest.raises(WrongInput) as error:
        read_yaml('name: a\nlaw: b\nsize: "\\UFFFFFFFF"\n', "d.yaml")
    assert error.value.location == "d.yaml:3:5"


@pytest.mark.judges("metrology")
@at_once(("deep", "verdict"), [(0.9, CutVerdict.CUTS), (1.1, CutVerdict.NOT)])
@at_once("module", [0.5, 4.0])
def test_a_hob_cuts_a_hollow_but_for_a_share_of_the_module(deep: float, verdict: CutVerdict, module: float) -> None:
    pitch: Any = Made(of=lambda gear: Made(is_ring=False), least_concave_radius_mm=lambda gear: 30.0)
    teeth: Any = Made(of=lambda gear: Made(flanks=Made(rack=Made(module_mm=module))))
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(cut_by, "gouged_mm", lambda curve, rack: deep * HARMLESS * module)
        patch.setattr(cut_by, "_tried", lambda *_: (CutVerdict.CUTS, ""))
        assert cut_by._hob(pitch, teeth, Gear.DRIVING).verdict is verdict


@pytest.mark.judges("screening")
@at_once(("unit", "value"), [("rad", 1.5), ("deg", 270.0 / pi), ("pi", 1.5 / pi), ("", 1.5)])
def test_an_angle_of_many_designs_is_in_radians(unit: str, value: float) -> None:
    columns = {f"motion.start_{unit}": np.array([value, 2.0 * value])} if unit else {}
    written = (Made(motion=Made(start=1.5)), Made(motion=Made(start=3.0)))
    batch: Any = Made(columns=columns, written=written, follows=np.array([0, 1]))
    assert Batch.angle_rad(batch, "start") == pytest.approx([1.5, 3.0])


@pytest.mark.judges("whole_machines")
@at_once(
    ("costs", "objectives", "told"),
    [
        ((1.0, 2.0), ("power",), ("power", "cost")),
        ((1.0, None), ("power",), ("power",)),
        ((1.0,), ("cost",), ("cost",)),
    ],
)
def test_costs_are_told_where_every_machine_has_one(costs: Any, objectives: Any, told: Any) -> None:
    assert _told(Made(machines=[Made(cost=cost) for cost in costs], objectives=objectives)) == told


@pytest.mark.judges("figures")
@pytest.mark.parametrize(
    ("load", "rows"), [("law", ["efficiency", "drivetrain"]), ("jam", ["efficiency", "drivetrain", "decided"])]
)
def test_what_stands_around_the_gears_is_told_by_its_shortest_life_and_least_safety(load: str, rows: list[str]) -> None:
    """What decides is told where it is not the law alone."""
    shaft = {
        "bearing_a": {"life_h": 5000.0},
        "bearing_b": {"life_h": None},
        "estimate_of_shaft": {"fatigue_safety": 3.0, "yield_safety": 2.5},
        "jam": {"yield_safety": 1.75},
        "decided_by": {"bearing_a": load},
    }
    found = {
        "losses": {"efficiency": 0.9, "mean_power_with_tooth_friction_w": 12.0},
        "driving_shaft": shaft,
        "motor": {"even_speed": {"rms_torque_of_rated": 0.456}},
    }
    told = {row.name: row.texts[0] for row in simulated._around(found)}
    assert list(told) == rows
    assert "bearings last 5000 h" in told["drivetrain"].replace(",", "")
    assert "shaft safety 1.75" in told["drivetrain"]
    assert "motor at 0.456 of its torque" in told["drivetrain"]


def test_gears_around_which_all_holds_come_first(monkeypatch: pytest.MonkeyPatch) -> None:
    """Each group keeps its order."""
    from ncgear.figures.answers import strong

    monkeypatch.setattr(strong, "parts_that_fail", lambda one: one.failing)
    sizes: Any = [
        Made(name=name, failing=failing) for name, failing in zip("abcd", (["key"], [], ["key"], []), strict=True)
    ]
    assert [one.name for one in strong.in_order(sizes)] == ["b", "d", "a", "c"]
