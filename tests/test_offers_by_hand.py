"""Offers of nearest wishes and gentler laws, limits set free, drilled holes, shapers and facts of gears, by hand."""

from __future__ import annotations

from dataclasses import dataclass
from math import inf, pi, sqrt, tau
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from shapely import MultiPoint, box

import ncgear.balance.gears as balance_gears
import ncgear.figures.advice.law_advice as law_advice
import ncgear.figures.answers.best_law as best_law
import ncgear.figures.answers.machine as machine
import ncgear.figures.balance.shaking as shaking
import ncgear.metrology.cut_by as cut_by
import ncgear.optimum.certified.refusals as refusals
import ncgear.optimum.makeable.law as makeable
import ncgear.optimum.makeable.motion_wishes as motion_wishes
import ncgear.studio.handles as handles
from at_once import at_once
from ncgear.errors import NoSuchMechanism, WrongInput
from ncgear.metrology.cut_by import CutVerdict
from ncgear.optimum.makeable.search import Kept
from ncgear.optimum.makeable.wishes import CONVEX
from ncgear.pitch.shape import Gear
from ncgear.project import alternatives
from ncgear.teeth.tool import FEWER_TEETH, MOST_TEETH
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


@pytest.mark.judges("balance")
@at_once(("wide_mm", "high_mm"), [(60.0, 12.0), (12.0, 60.0), (35.0, 35.0)])
@at_once("aside_mm", [0.0, 40.0])
def test_places_of_drilled_holes_fill_their_section(wide_mm: float, high_mm: float, aside_mm: float) -> None:
    """Holes of 4 mm with walls of 1 mm: a lattice 5 mm apart, one place to 5^2 sqrt(3)/2 mm2 of what has room."""
    section = box(aside_mm - wide_mm, -high_mm, aside_mm + wide_mm, high_mm)
    drills: Any = Made(largest_mm=4.0, wall_mm=1.0)
    found = balance_gears._places(section, drills, "k")
    apart = np.abs(found[:, None] - found) + 99.0 * np.eye(found.size)
    assert apart.min() == pytest.approx(5.0)
    room = box(aside_mm - wide_mm + 3.0, -high_mm + 3.0, aside_mm + wide_mm - 3.0, high_mm - 3.0)
    # Up to a strip of half a pitch along the border
    assert found.size * 25.0 * sqrt(3.0) / 2.0 == pytest.approx(room.area, abs=2.5 * room.length)
    assert room.buffer(1e-9).contains(MultiPoint(np.column_stack([found.real, found.imag])))
    # It reaches all borders
    assert [found.real.min(), found.real.max()] == pytest.approx([room.bounds[0], room.bounds[2]], abs=5.0)
    assert [found.imag.min(), found.imag.max()] == pytest.approx([room.bounds[1], room.bounds[3]], abs=5.0)


@pytest.mark.judges("balance")
def test_drilled_holes_that_are_too_many_are_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    """Rows 4.33 mm apart reach 60 mm: 14 on each side, and four times as many columns."""
    section, drills = box(-60.0, -9.0, 60.0, 9.0), Made(largest_mm=4.0, wall_mm=1.0)
    monkeypatch.setattr(balance_gears, "MOST_PLACES", 28 * 56)
    assert balance_gears._places(section, drills, "k").size
    monkeypatch.setattr(balance_gears, "MOST_PLACES", 28 * 56 - 1)
    with pytest.raises(WrongInput, match="holes 5 mm apart are too many"):
        balance_gears._places(section, drills, "k")


@pytest.mark.judges("figures")
def test_a_shaking_moment_is_told_by_its_greater_extreme(monkeypatch: pytest.MonkeyPatch) -> None:
    """From -3000 to 2000 N mm: 3 N m."""
    monkeypatch.setattr(shaking, "statistics_figures", lambda force: {})
    of: Any = Made(
        force=None, peak=Made(at=pi / 3.0), moment=Made(extremes=[Made(value=-3000.0), Made(value=2000.0)], rms=1500.0)
    )
    assert shaking.shaking_figures(of) == pytest.approx(
        {"peak_at_deg": 60.0, "moment_max_n_m": 3.0, "moment_rms_n_m": 1.5}
    )


@pytest.mark.judges("metrology")
@at_once(
    ("concave_mm", "why", "counts"),
    [
        (None, cut_by.OUT, [1.0, 0.75, 0.5]),
        (None, "else", [1.0]),
        (30.0, cut_by.OUT, [30 - FEWER_TEETH, int(0.75 * (30 - FEWER_TEETH)), 0.5]),
        (5.0, cut_by.OUT, []),
    ],
)
def test_smaller_shapers_are_tried_while_teeth_reach_out(
    monkeypatch: pytest.MonkeyPatch, concave_mm: float | None, why: str, counts: list[float]
) -> None:
    """Of most teeth, three quarters and half of them, but 12 at least; a hollow of 30 mm takes 30 teeth of 2 mm."""
    tried = list[int]()
    monkeypatch.setattr(cut_by, "PinionCircle", _Circle)
    monkeypatch.setattr(cut_by, "_tried", lambda *given: (tried.append(given[-1].teeth), (CutVerdict.NOT, why))[1])  # type: ignore[func-returns-value]
    pitch: Any = Made(least_concave_radius_mm=lambda gear: concave_mm, size=Made(module_mm=2.0))
    teeth: Any = Made(of=lambda gear: Made(flanks=Made(tool=None)))
    found = cut_by._shaper(pitch, teeth, Gear.DRIVING)
    most = MOST_TEETH if concave_mm is None else 30 - FEWER_TEETH
    expected = [max(int(count * most) if count <= 1.0 else int(count), cut_by.FEWEST_TEETH) for count in counts]
    assert tried == expected
    assert found.verdict is CutVerdict.NOT
    if counts:
        assert found.reason == f"with {expected[0]} teeth {why}"


@dataclass(frozen=True)
class _Circle:
    teeth: int
    module_mm: float


@pytest.mark.judges("optimum")
@at_once(("hard", "weight", "level"), [(True, None, (4.0, -inf, 0.0)), (False, 6.0, (None, 4.0, 3.0))])
def test_a_soft_wish_costs_by_its_weight_over_its_share(hard: bool, weight: Any, level: Any) -> None:
    """A weight of 6 for two shares."""
    wish: Any = Made(key="k", hard=hard, weight=weight)
    asked: Any = Made(stretch=None)
    found = motion_wishes._level(Made(cycle_rad=tau), wish, asked, None, None, 4.0, 2.0)  # type: ignore[arg-type]
    assert (found.limit, found.floor, found.share_of_goal) == level


@pytest.mark.judges("optimum")
@at_once("reached", [[0.5, 0.4], [0.5, 1.5]])
@at_once("without", [{}, {"speed": [0.9, 0.9]}, {"speed": [0.9, 1.1]}])
def test_a_law_that_keeps_its_limits_between_the_places_is_taken(reached: Any, without: Any) -> None:
    """The law itself, or the law that was found without one of its wishes; else what each law reaches is offered."""
    caps = np.ones(2)
    levels = [Made(wish="speed", limit=1.0), Made(wish="power", limit=1.0), Made(wish=CONVEX, limit=1.0)]
    search: Any = Made(
        programme=Made(levels=levels[:2]), caps=caps, reached=lambda near: np.array(reached), rounded=lambda near: near
    )
    with pytest.MonkeyPatch.context() as patch:
        found = {wish: Kept(caps, np.array(law)) for wish, law in without.items()}
        patch.setattr(makeable, "_kept_without", lambda search, wishes, near: found.get(wishes[0]))
        patch.setattr(makeable, "law_of", lambda search, law: law.reached.tolist())
        patch.setattr(makeable, "_easing", lambda search, wish, reached: [(wish, reached.tolist())])
        patch.setattr(makeable, "_offered", lambda told, eased, each=True: NoSuchMechanism(f"{eased} {each}"))
        kept = [law for law in (reached, *without.values()) if max(law) <= 1.0]
        if kept:
            assert makeable._kept_between(search, None) == kept[0]  # type: ignore[arg-type]
            return
        with pytest.raises(NoSuchMechanism) as error:
            makeable._kept_between(search, None)  # type: ignore[arg-type]
    offers = [(wish, law) for wish, law in without.items()] or [("power", reached)]
    assert error.value.problem == f"{offers} {bool(without)}"


@pytest.mark.judges("studio")
@at_once(("times", "count"), [(0.5, 0), (2.0, 1)])
def test_a_number_that_hardly_moves_the_ratio_has_no_handle(
    monkeypatch: pytest.MonkeyPatch, times: float, count: int
) -> None:
    """A ratio of 40 that changes at one of 180 places, by half and by twice of what is felt there."""
    effect = times * handles.LEAST_EFFECT * 40.0
    number = Made(value=3.0)

    def ratio(law: Any, angle: Any) -> Any:
        return 40.0 + effect * (law == 3.0 + 3.0 * handles.STEP) * (np.arange(angle.size) == 45)

    monkeypatch.setattr(handles, "_ratio", ratio)
    monkeypatch.setattr(handles, "_with", lambda drive, number, value: value)
    lobes = Made(driving_period_rad=tau)
    law = Made(lobes=lobes)
    drive: Any = Made(transmission=law, design=Made(motion=Made(law_numbers=[number])))
    found = list(handles.grips(drive))
    assert len(found) == count
    if found:
        assert found[0].angle_deg == pytest.approx(90.0)
        assert found[0].factor == pytest.approx(3.0 * handles.STEP / effect)
