"""Offers of nearest wishes and gentler laws, limits set free, flywheels and facts of gears, by hand."""

from __future__ import annotations

from dataclasses import dataclass
from math import inf
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import ncgear.figures.advice.law_advice as law_advice
import ncgear.figures.answers.best_law as best_law
import ncgear.figures.answers.machine as machine
import ncgear.optimum.certified.refusals as refusals
import ncgear.optimum.makeable.law as makeable
from at_once import at_once
from ncgear.optimum.makeable.wishes import CONVEX
from ncgear.project import alternatives
from ncgear.wishes.requirements import EvenSpeed, TimeWithin
from ncgear.wishes.wish import Offer

Made: Any = SimpleNamespace


@pytest.mark.judges("optimum")
@at_once(
    ("asked", "guess", "eased"),
    [
        (TimeWithin((2.0, 3.0), 0.0, 1.0), None, 0.7),  # type: ignore[arg-type]
        (EvenSpeed(None, 1.3), 0.3, 1.05),  # type: ignore[arg-type]
        (EvenSpeed(None, 1.0), refusals.LEAST_EASE, 1.05),  # type: ignore[arg-type]
        ("any", refusals.LEAST_EASE, 1.05),
        ("any", None, inf),
    ],
)
def test_the_nearest_wish_is_eased_from_its_own_spread(asked: Any, guess: Any, eased: float) -> None:
    """A share of 0.05 more is the least that can be kept; the time of a stretch has its own least value."""
    guesses = list[float]()

    def search(problem: Any, demands: Any, start: float) -> float:
        guesses.append(start)
        assert demands(0.25) == {"wishes": ("kept", 1.25)}
        return inf if eased == inf else 0.05

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(refusals, "_eased", search)
        free: Any = Made(asked=Made(wishes=("kept",)), least_time=lambda start, end: 0.7)
        wish: Any = Made(asked=asked, key="k", eased=lambda value: value, shown=lambda value: Offer(f"{value:.6g}"))
        found = refusals._nearest_wish(free, wish)
    assert [str(one) for one in found] == ([] if eased == inf else [f"{eased:.6g} (k)"])
    if guess is not None:
        assert guesses == [pytest.approx(guess)]


@dataclass(frozen=True)
class _Level:
    wish: str
    limit: float | None
    floor: float


@dataclass(frozen=True)
class _Programme:
    levels: Any


@dataclass(frozen=True)
class _Search:
    programme: Any
    caps: Any
    weights: Any


@pytest.mark.judges("optimum")
def test_a_freed_wish_comes_near_its_limit_and_others_keep_theirs() -> None:
    """A power whose floor lies below and one whose floor lies above its limit, dents, and a wish that stays."""
    levels = [
        _Level("power", 5.0, 1.0), _Level("power", 5.0, 9.0), _Level("power", None, 2.0),
        _Level(CONVEX, 3.0, 1.0), _Level("speed", 4.0, 1.0),
    ]  # fmt: skip
    search: Any = _Search(_Programme(levels), np.full(5, 0.5), np.full(5, 7.0))
    found: Any = makeable._freed(search, ["power", CONVEX])
    assert [level.floor for level in found.programme.levels] == [5.0, 9.0, 2.0, 1.0, 1.0]
    assert found.caps.tolist() == [inf, inf, inf, makeable.ANY_DENT, 0.5]
    assert found.weights.tolist() == [1.0, 1.0, 1.0, 0.0, 0.0]


@pytest.mark.judges("figures")
@at_once(
    ("percent", "as_given", "changed", "offered"),
    [(0, 1, 1, False), (60, 1, 1, True), (60, 1, 2, False), (60, 3, 1, True)],
)
def test_a_gentler_law_is_offered_where_it_keeps_what_the_law_keeps(
    monkeypatch: pytest.MonkeyPatch, percent: int, as_given: int, changed: int, offered: bool
) -> None:
    asked = list[float]()
    monkeypatch.setattr(alternatives, "kept_percent", lambda design, harmful: percent)
    monkeypatch.setattr(alternatives, "gentler", lambda design, share: asked.append(share))
    monkeypatch.setattr(alternatives, "changed_motion", lambda design, changes: "changed")
    monkeypatch.setattr(alternatives, "overstepped", lambda design: changed if design == "changed" else as_given)
    monkeypatch.setattr(law_advice, "changed", lambda changes: changes)
    monkeypatch.setattr(law_advice, "Remedy", lambda text, changes: text)
    drive: Any = Made(design="given", linkage=Made(OUTPUT=Made(name="slider")))
    found: Any = law_advice.tempered(drive, lambda law: False)
    assert [text[:12] for text in found] == (["keep 60 % of"] if offered else [])
    assert asked == [0.6] * bool(percent)


@pytest.mark.judges("figures")
def test_flywheels_are_told_with_the_gap_of_their_laws() -> None:
    """A law of 105 W over a limit of 100 W is 5 % above it; over no limit there is no gap; 2e6 kg mm2 are 2 kg m2."""
    law = Made(peak_power_w=105.0, braking_power_w=20.0, ratio_min=0.5, ratio_max=1.75)
    points: Any = [Made(law=law, limit_w=limit, flywheel_kg_mm2=2e6) for limit in (100.0, 0.0)]
    found = best_law.flywheel_answer(points, Made(name="m", operation=Made(speed_rpm=60.0)))
    assert [row.texts[2] for row in found.rows] == ["5.0 %", "-"]
    assert found.rows[0].name.startswith("2 kg")
    assert found.rows[0].texts[-1] == "0.500 to 1.750"


@pytest.mark.judges("figures")
@at_once("pumped", [None, Made(per_turn_mm3=12000.0, pulsation=0.125)])
def test_facts_of_gears_have_the_displacement_of_a_pump(monkeypatch: pytest.MonkeyPatch, pumped: Any) -> None:
    monkeypatch.setattr(machine, "figures_of", lambda *_: {})
    drive: Any = Made(pitch=Made(size=Made(driving_teeth=20, driven_teeth=40)), pumped=pumped)
    facts = dict(machine.gear_facts(drive))
    assert facts["teeth"] == "20 : 40"
    told = " ".join(facts.values())
    assert ("12 cm" in told, "12.5 %" in told) == (pumped is not None, pumped is not None)
