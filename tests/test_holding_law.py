"""Laws whose teeth hold: caps of loads against closed forms, and the gears of a law rated again from its file."""

from __future__ import annotations

import json
from math import sqrt
from pathlib import Path
from typing import Any

import pytest

import drives
from commands import Run, on_text
from ncgear.design.keys.design import Design
from ncgear.design.reading.design_file import load, parsed
from ncgear.errors import NoSuchMechanism, WrongInput
from ncgear.optimum.makeable.wishes import Goal, Wishes
from ncgear.optimum.task import Limits
from ncgear.project.best_law import BestLaw, motion_keys
from ncgear.project.drive import Drive
from ncgear.project.strengthening import rating_of
from ncgear.strength.holding import Damage
from ncgear.whole_machines import holding_law
from ncgear.whole_machines.holding_law import CappedLaw, holding

ASKED = """
strength: {contact_safety: 2.1}
optimize: {goal: least_acceleration, knots: 60, limits: {free_of_undercut: true, pressure_angle_deg: 50, MORE}}
"""


def text(more: str = "teeth_hold: true") -> str:
    return (drives.DESIGNS / "pusher.yaml").read_text(encoding="utf-8") + ASKED.replace("MORE", more)


def design(more: str = "teeth_hold: true") -> Design:
    return parsed(text(more), drives.DESIGNS / "d.yaml").design


class Plain:
    """A law of a model machine: its safeties fall with its loads by the laws of stress, its goal with its cap."""

    least = 1.0
    pits, breaks = 0.0, 0.0
    """Stresses that no law changes."""

    def __init__(self, asked: Any = None, caps: dict[Damage, float] | None = None, begin: Any = None) -> None:
        caps = caps or {}
        self.flank = min(caps.get(Damage.CONTACT, 9.0), 9.0)
        self.force = min(caps.get(Damage.BENDING, 8.0), 8.0)
        self.goal = 100.0 / self.flank + 100.0 / self.force

    @property
    def law(self) -> None:
        if self.flank < self.least or self.force < self.least:
            raise NoSuchMechanism("none")


def shares(law: Plain) -> dict[Damage, float]:
    return {
        Damage.CONTACT: 2.0 / (sqrt(law.flank) + law.pits),
        Damage.BENDING: 5.0 / (law.force + law.breaks),
    }


def held(monkeypatch: pytest.MonkeyPatch, **changed: float) -> Any:
    for name in ("least", "pits", "breaks"):
        monkeypatch.setattr(Plain, name, changed.get(name, getattr(Plain, name)))
    monkeypatch.setattr(holding_law, "CappedLaw", Plain)
    of_least = Plain(None, {Damage.CONTACT: max(Plain.least, 1e-3)})
    monkeypatch.setattr(Plain, "wishes", Wishes(Limits(0.2, 5.0), Goal.FLANK_LOAD), raising=False)

    def least_load(asked: Plain, damage: Damage) -> Plain:
        # Asked for the load of the damage from which the law that was rated last is farthest.
        assert damage is min(rated[-1], key=rated[-1].__getitem__)
        return of_least

    rated: list[dict[Damage, float]] = []
    monkeypatch.setattr(holding_law, "_shares", lambda law: rated.append(shares(law)) or rated[-1])
    monkeypatch.setattr(holding_law, "_of_least_load", least_load)
    monkeypatch.setattr(holding_law, "_loads", lambda law: {Damage.CONTACT: law.flank, Damage.BENDING: law.force})
    monkeypatch.setattr(Plain, "figures", property(lambda self: self), raising=False)
    told: list[int] = []
    return holding(Plain(), told.append), told  # type: ignore[arg-type]


def test_stresses_by_their_loads_need_one_correction(monkeypatch: pytest.MonkeyPatch) -> None:
    found, told = held(monkeypatch)
    assert found.flank == pytest.approx(4.0 / 1.003**2, rel=1e-12)
    assert found.force == pytest.approx(5.0 / 1.003, rel=1e-12)
    assert told == [1, 2]


def test_stresses_that_follow_less_than_the_load_are_approached(monkeypatch: pytest.MonkeyPatch) -> None:
    found, told = held(monkeypatch, pits=0.4, breaks=1.5)
    assert 1.0 <= min(shares(found).values()) <= 1.01
    assert all(1.0 <= share <= 1.03 for share in shares(found).values())
    assert 2 < len(told) <= 8


def test_a_law_whose_teeth_hold_is_taken_as_it_is(monkeypatch: pytest.MonkeyPatch) -> None:
    found, told = held(monkeypatch, pits=-1.5, breaks=-4.0)
    assert (found.flank, found.force, told) == (9.0, 8.0, [1])


def test_where_no_law_has_so_little_load_the_law_of_the_least_is_rated(monkeypatch: pytest.MonkeyPatch) -> None:
    """Of the offered flank load, 6.25, it has 2/2.5 of the wanted safety; where its stress is less, it holds."""
    with pytest.raises(NoSuchMechanism, match=r"of 2 laws the nearest that was rated has 79.8 % .* against pitting"):
        held(monkeypatch, least=6.25, breaks=-4.0)
    with pytest.raises(
        NoSuchMechanism, match=r"99.8 % .*; the law of optimize.goal least_flank_load has teeth that hold"
    ):
        held(monkeypatch, least=3.999, breaks=-4.0)
    found, told = held(monkeypatch, least=3.98, breaks=-4.0)
    assert (found.flank, told) == (pytest.approx(1.005 * 3.98, rel=1e-12), [1, 2])


def test_stresses_that_no_law_changes_are_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(NoSuchMechanism, match=r"of 8 laws the nearest that was rated has 8\d\.\d % .* breakage"):
        held(monkeypatch, breaks=5.5, least=0.0)


def test_gears_that_are_not_followed_are_refused() -> None:
    with pytest.raises(WrongInput, match="one pair only") as refused:
        _ = BestLaw(design("teeth_hold: true, stages: 2")).begun
    assert refused.value.key == "optimize.limits.teeth_hold"
    with pytest.raises(WrongInput, match="it needs the gears' size") as refused:
        _ = BestLaw(design().model_copy(update={"gears": None})).begun
    assert refused.value.key == "optimize.limits.teeth_hold"


def test_a_frontier_does_not_rate_gears(run: Run) -> None:
    status, _, err = on_text(run, "frontier")(text())
    assert status == 2
    assert "optimize.limits.teeth_hold: true, but the gears of a frontier's points are not rated" in err


def test_caps_are_under_limits_of_the_same_loads() -> None:
    best = BestLaw(design("teeth_hold: true, flank_load_n_mm: 30000"))
    capped = CappedLaw(best, {Damage.CONTACT: 40000.0, Damage.BENDING: 120.0})
    assert capped.wishes.limits.flank_load_n_mm == 30000.0
    assert capped.wishes.limits.tooth_force_n == 120.0
    assert capped.wishes_of_limit == best.wishes
    assert capped.asked == best.asked
    assert "teeth that hold" in capped.not_covered


@pytest.mark.slow
def test_the_teeth_of_the_written_law_hold(run: Run) -> None:
    """Without the limit they do not; more safety costs acceleration; the certified limit is that of all laws."""
    free = BestLaw(design("convex: true"))
    status, out, err = on_text(run, "optimize")(text())
    assert (status, err) == (0, "")
    assert "teeth that hold" in out
    folder = Path("export/pusher-optimized")
    again = Drive(load(folder / "pusher-optimized.yaml").design)
    safeties = [one.share for one in rating_of(again).weakest]
    assert 1.0 <= min(safeties) <= 1.01
    without = Drive(free.design.model_copy(update={"motion": motion_keys(free.law)}))
    assert min(one.share for one in rating_of(without).weakest) < 0.95
    told = json.loads((folder / "certificate.json").read_text())
    assert told["goal"]["law"] > 1.02 * free.goal
    assert told["goal"]["limit"] <= free.goal
    assert told["wishes"]["limits"]["teeth_hold"] is True
    assert told["wishes"]["limits"]["flank_load_n_mm"] is None
