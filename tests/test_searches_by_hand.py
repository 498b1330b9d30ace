"""Searches whose answers are known by hand: made-up laws, gears that hold from a width on, boxes and driving ranges."""

from __future__ import annotations

from dataclasses import dataclass
from math import exp, log, pi
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from at_once import at_once
from ncgear.kinematics.crank_stretches import CrankStretch
from ncgear.metrology.cut_by import CutVerdict, Tool
from ncgear.numerics.extrema import Extremum
from ncgear.optimum import family
from ncgear.optimum.certified import tree as tree_room
from ncgear.optimum.certified.ranges import KnownRanges
from ncgear.optimum.certified.tree import MotionBox, Seen, Tree
from ncgear.optimum.family import BOX, PeakGoal
from ncgear.optimum.makeable import driving_ranges
from ncgear.optimum.makeable.driving_ranges import Passed, best_held, held_as, passed_by_all
from ncgear.optimum.makeable.reached import _rise, peaks, running
from ncgear.optimum.makeable.rows import UNHEARD, _square
from ncgear.project.motor import MotorResult
from ncgear.project.sizing import _Search
from ncgear.whole_machines import laws as machine_laws
from ncgear.whole_machines.laws import FoundLaw
from ncgear.whole_machines.machine import cut_words

Made: Any = SimpleNamespace
CUTS = CutVerdict.CUTS

# --- the published family, with a made-up law: peaks of acceleration 1 + |x - a|^2, of power 3 - 2 x0 ----------------

BEST = np.linspace(0.3, 0.6, len(BOX))


def sampled(_: Any, points: np.ndarray) -> Any:
    acceleration = 1.0 + ((points - BEST) ** 2).sum(axis=1)
    power = 3.0 - 2.0 * points[:, 0]
    values = {PeakGoal.ACCELERATION: np.stack([acceleration, -0.5 * acceleration], 1), PeakGoal.POWER: -power[:, None]}
    return Made(of=values.__getitem__)


@pytest.fixture
def made_up(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(family, "sampled_laws", sampled)


@pytest.mark.judges("optimum")
@pytest.mark.usefixtures("made_up")
@pytest.mark.parametrize(("cap", "first"), [(np.inf, 0.3), (2.0, 0.5), (2.8, 0.3)])
def test_a_descent_ends_where_a_cap_binds(cap: float, first: float) -> None:
    """Under a power of 2 the first share is at least a half; all others stay at their best."""
    start = np.full(len(BOX), 0.7)
    found = family._descended(Made(), PeakGoal.ACCELERATION, cap, start)
    assert found == pytest.approx(np.append(first, BEST[1:]), abs=1e-4)
    descent = family._Descent(Made(), PeakGoal.ACCELERATION, cap, start)
    at = np.append(start, 1.1)
    told, step = descent.slopes(at), 1e-5
    for column, way in enumerate(np.eye(at.size) * step):
        slope = (descent.values(at + way) - descent.values(at - way)) / (2.0 * step)
        assert told[:, column] == pytest.approx(np.nan_to_num(slope), abs=1e-4)


@pytest.mark.judges("optimum")
@pytest.mark.usefixtures("made_up")
def test_a_peak_counts_more_by_how_far_the_other_exceeds_its_cap() -> None:
    """At the best point the power is 2.4: a fifth over a cap of 2, for which the peak of 1 counts as 1 + 20/5."""
    points = np.stack([BEST, BEST + 0.1])
    away = 1.0 + 0.01 * len(BOX)
    assert family._merit(Made(), PeakGoal.ACCELERATION, np.inf, points) == pytest.approx([1.0, away])
    assert family._merit(Made(), PeakGoal.ACCELERATION, 2.0, points) == pytest.approx([5.0, away * (1.0 + 20.0 * 0.1)])
    by_power = family._merit(Made(), PeakGoal.POWER, 1.0, points)
    assert by_power == pytest.approx([2.4, 2.2 * (1.0 + 20.0 * 0.01 * len(BOX))])


@pytest.mark.judges("optimum")
def test_a_law_over_its_cap_is_moved_under_a_tighter_one(monkeypatch: pytest.MonkeyPatch) -> None:
    """Exact peaks are 5 % over those of the samples: under 100 the next descent is asked for 100/1.05."""
    asked: list[float] = []

    def descended(_: Any, least: PeakGoal, cap: float, point: np.ndarray) -> np.ndarray:
        asked.append(cap)
        return np.array([cap])

    def made(_: Any, point: np.ndarray) -> list[Any]:
        power = {PeakGoal.POWER: 1.05 * point[0], PeakGoal.ACCELERATION: 7.0}
        return [Made(peak=power.__getitem__), Made(peak={PeakGoal.POWER: 1e9, PeakGoal.ACCELERATION: 1.0}.__getitem__)]

    monkeypatch.setattr(family, "_descended", descended)
    monkeypatch.setattr(family, "_made", made)
    found: Any = family._under_cap(Made(), PeakGoal.ACCELERATION, 100.0, np.array([100.0]))
    assert asked == [pytest.approx(100.0 / 1.05)]
    assert found.peak(PeakGoal.POWER) == pytest.approx(100.0)
    monkeypatch.setattr(family, "_made", lambda *_: [])
    assert family._under_cap(Made(), PeakGoal.ACCELERATION, 100.0, np.array([100.0])) is None


# --- boxes of the certified limit ------------------------------------------------------------------------------------


@pytest.mark.judges("optimum")
@pytest.mark.parametrize("low", [1.0, 0.2, 7.0])
def test_a_side_of_a_range_is_worth_moving_where_no_motion_was_near(low: float) -> None:
    """Of a range over two in ln q, a tenth of its width is a fifth."""

    def worth(*seen_at: float) -> list[float]:
        seen = Seen(1)
        for at in seen_at:
            seen.add(np.array([low * exp(at)]))
        return seen.worth(0, low, low * exp(2.0))

    assert worth(0.1, 1.5) == [-1.0]
    assert worth(0.3, 1.9) == [1.0]
    assert worth(0.21, 1.79) == worth() == [1.0, -1.0]
    assert worth(0.19, 1.81) == []


@pytest.mark.judges("optimum")
def test_a_box_is_halved_where_it_is_widest() -> None:
    """From 3 to 48 at 12, in even ratios; or by the dearest figure, if four widths are over its most times ln 16."""
    prices = {"power": 1.0, "acceleration": 2.0}
    tree: Any = Tree(Made(prices=prices), [0, 2], Made(), Made(), Made())

    def halves(most: float = 48.0, **figures: tuple[float, float]) -> list[MotionBox]:
        ranges = KnownRanges(np.array([3.0, 3.0, 3.0]), np.array([6.0, 300.0, most]))
        assert tree.widths(MotionBox(ranges, {}, 0.0)) == pytest.approx([log(2.0), log(most / 3.0)])
        return tree.halves(MotionBox(ranges, figures, 0.0))

    parts = halves(power=(1.0, 2.0))
    assert [(one.known.least[2], one.known.most[2]) for one in parts] == [(3.0, 12.0), (12.0, 48.0)]
    narrow = KnownRanges(np.full(3, 3.0), np.full(3, 3.2))
    assert tree.halves(MotionBox(narrow, {"power": (1.0, 2.0)}, 0.0)) == []
    by_acceleration = halves(power=(0.0, 10.0), acceleration=(1.0, 9.0))
    assert [one.figures["acceleration"] for one in by_acceleration] == [(1.0, 5.0), (5.0, 9.0)]
    by_power = halves(power=(0.0, 10.0), acceleration=(7.0, 9.0))
    assert [one.figures["power"] for one in by_power] == [(0.0, 5.0), (5.0, 10.0)]
    for figures in (
        {"power": (9.0, 10.0), "acceleration": (5.0, 9.0)},
        {"power": (3.2, 10.0), "acceleration": (8.0, 9.0)},
    ):
        assert [one.known.most[2] for one in halves(**figures)] == [12.0, 48.0]
    (first, _) = halves(power=(3.0, 10.0), acceleration=(8.0, 9.0))
    assert first.figures["power"] == (3.0, 6.5)


@pytest.mark.judges("optimum")
def test_a_single_box_is_narrowed_towards_the_least_value(monkeypatch: pytest.MonkeyPatch) -> None:
    """A box that has no motion below 1.7 of a law at 2 proves a target between that and the last one with motions."""
    asked: list[float] = []

    def narrowed(box: Any, target: float, worth: float) -> Any:
        asked.append(target)
        return None if target < 1.7 else Made(value=max(box.value, target - 0.4))

    box = Made(value=1.0)
    monkeypatch.setattr(tree_room, "whole_tree", lambda *_: (Made(narrowed=narrowed), box))
    proven = tree_room.bisected(Made(), [], 1.0, Made(value=2.0), Made())
    assert asked[0] == pytest.approx(1.998)
    assert asked[1] == pytest.approx((1.998 - 0.4 + 1.998) / 2.0)
    assert proven == asked[-1] < 1.7 <= asked[-2]
    monkeypatch.setattr(tree_room, "whole_tree", lambda *_: (Made(narrowed=narrowed), Made(value=1.999)))
    assert tree_room.bisected(Made(), [], 1.0, Made(value=2.0), Made()) == 1.999


@pytest.mark.judges("optimum")
def test_running_integrals_and_rises_of_parabolas_are_exact() -> None:
    """Of 1 - (t - 0.4)^2 over two cells of a turn: primitives at all places, and its top beside the places."""
    ends = np.array([0.0, 0.9, 2.0])
    places = ends[:-1, None] + np.diff(ends)[:, None] * np.arange(5) / 4.0
    term = 1.0 - (places - 0.4) ** 2
    found = running(Made(ends_rad=ends), term)
    assert found == pytest.approx(places - ((places - 0.4) ** 3 + 0.4**3) / 3.0)
    assert peaks(-((places - 0.4) ** 2))[0].max() == pytest.approx(0.0, abs=1e-12)
    rise = _rise(term, np.array([[0, 1, 2], [2, 3, 4]]), 5)
    # Around each place, half a step of these places to both sides.
    around = [(0.0, 0.0, 0.225), (0.45, 0.225, 0.675), (0.9, 0.675, 1.175), (1.45, 1.175, 1.725), (2.0, 1.725, 2.0)]
    expected = [(at - 0.4) ** 2 - (np.clip(0.4, low, high) - 0.4) ** 2 for at, low, high in around]
    assert rise == pytest.approx(expected)


@pytest.mark.judges("optimum")
def test_the_square_of_what_stays_above_an_order_is_without_its_waves() -> None:
    """3 + 2 cos(2 t) + 0.5 sin(5 t) over a cycle of pi, t its half: beyond the second order 0.5 sin(5 t) is left."""
    angle = np.linspace(0.0, 2.0 * pi, 400, endpoint=False)

    def fitted(term: np.ndarray, waves: Any) -> Any:
        columns = np.stack([wave + np.zeros(angle.size) for wave in waves], axis=1)
        return np.linalg.lstsq(columns, term, rcond=None)[0]

    whole: Any = Made(angle_rad=angle / 2.0, fitted=fitted, wave=lambda turned: (np.cos(turned), np.sin(turned)))
    term = 3.0 + 2.0 * np.cos(2.0 * angle) + 0.5 * np.sin(5.0 * angle)
    level: Any = Made(order=2, cycle_rad=pi)
    assert _square(level, term, whole) == pytest.approx((0.5 * np.sin(5.0 * angle)) ** 2 + (UNHEARD * term) ** 2)
    assert _square(Made(order=None), term, whole) == pytest.approx(term**2)


# --- wishes over driving angles --------------------------------------------------------------------------------------


@pytest.mark.judges("optimum")
def test_laws_of_a_range_are_halved_and_bounded_where_all_of_them_are() -> None:
    passed = Passed((1.0, 1.4), (2.0, 3.0))
    assert passed.width == pytest.approx(1.0)
    assert passed.halves() == [Passed((1.0, 1.4), (2.0, 2.5)), Passed((1.0, 1.4), (2.5, 3.0))]
    wish: Any = Made(bound=lambda stretch: stretch)
    assert passed.bound(wish) == [CrankStretch(1.4, 2.0)]
    assert Passed((1.0, 2.4), (2.0, 3.0)).bound(wish) == []
    every = passed_by_all(Made(start_rad=1.0, end_rad=2.0 * pi + 2.0), 2.0 * pi, 0.5, 2.0)
    # From pi/2 on at the slowest, or later where the rest of the turn at the fastest needs it.
    assert every.start == pytest.approx((0.5, 2.0))
    assert every.end == pytest.approx((2.0 * pi + 1.0, 2.0 * pi + 4.0))


@dataclass(frozen=True)
class Ranged:
    """A wish over a driving range, and the wishes of one."""

    motion: tuple[Any, ...]


def held(monkeypatch: pytest.MonkeyPatch, start: float, end: float, crank: CrankStretch) -> Any:
    """One wish, by stand-ins for the two functions that look at its class."""
    driving = Made(start_rad=start, end_rad=end, crank=crank)
    monkeypatch.setattr(driving_ranges, "ranges", lambda wishes: [0])
    monkeypatch.setattr(driving_ranges, "_driving", lambda wishes, number: wishes.motion[number])
    monkeypatch.setattr(
        driving_ranges,
        "_held_over",
        lambda wishes, number, crank: Ranged((Made(start_rad=start, end_rad=end, crank=crank),)),
    )
    return Ranged((driving,))


@pytest.mark.judges("optimum")
def test_a_range_is_held_where_a_motion_passes_it(monkeypatch: pytest.MonkeyPatch) -> None:
    """With i12 = 1 + cos(phi2)/2 the driving angle is phi2 + sin(phi2)/2; a cycle of two turns doubles it."""
    crank = np.linspace(0.0, 2.0 * pi, 721)
    motion: Any = Made(crank_angle_rad=crank[:-1], turning=1.0 / (1.0 + 0.5 * np.cos(crank[:-1])))

    def driving(phi2: float) -> float:
        return 2.0 * (phi2 + 0.5 * np.sin(phi2))

    wishes = held(monkeypatch, driving(1.0), driving(2.0) + 4.0 * pi, CrankStretch(0.0, 1.0))
    found = held_as(wishes, motion, 4.0 * pi).motion[0].crank
    assert (found.start_rad, found.end_rad) == pytest.approx((1.0, 2.0 + 2.0 * pi), abs=1e-4)


@pytest.mark.judges("optimum")
def test_the_ends_of_a_range_are_moved_to_where_a_law_is_best(monkeypatch: pytest.MonkeyPatch) -> None:
    """Cost (start - 1.26)^2 + (end - 1.94)^2, in steps of a tenth and then of three hundredths."""
    wishes = held(monkeypatch, 0.0, 1.0, CrankStretch(1.0, 2.0))

    def law(held_so: Any, _: Any) -> Any:
        crank = held_so.motion[0].crank
        goal = 100.0 + (crank.start_rad - 1.26) ** 2 * 100.0 + (crank.end_rad - 1.94) ** 2 * 100.0
        return Made(goal=goal, motion=crank, cost=lambda _, goal=goal: goal)

    best = best_held(wishes, law(wishes, None), law)
    assert (best.motion.start_rad, best.motion.end_rad) == pytest.approx((1.26, 1.94), abs=0.02)
    # An end at a retracted place stays there.
    still = held(monkeypatch, 0.0, 1.0, CrankStretch(0.0, 2.0))
    assert best_held(still, law(still, None), law).motion.start_rad == 0.0


# --- sizes, motors, laws of machines ---------------------------------------------------------------------------------


def gears(teeth: int, module: float, width: float, share: float) -> Any:
    return Made(teeth=teeth, module_mm=module, face_width_mm=width, share=share, holds=share >= 1.0)


@pytest.mark.judges("project")
@pytest.mark.parametrize(("least", "power"), [(23.4, 1.0), (11.0, 0.8), (36.5, 0.5)])
def test_the_least_width_that_holds_is_found_to_a_millimetre(least: float, power: float) -> None:
    """Safeties that go with a power of the width: wider than ``least`` holds, a millimetre less does not."""

    def made(teeth: int, module_mm: float, width_mm: float) -> Any:
        assert width_mm == round(width_mm)
        search.computed.append(gears(teeth, module_mm, width_mm, (width_mm / least) ** power))
        return search.computed[-1]

    wide = gears(30, 2.0, 40.0, (40.0 / least) ** power)
    search = Made(computed=[gears(30, 2.0, 99.0, 9.0), wide], narrowings=0, most_narrowed=30, made=made)
    search.widths_mm = lambda module: (3.0 * module, np.inf)
    search.width = lambda *_: np.ceil(0.8 * least)
    best, known = _Search.narrowed(search, wide)
    assert (best.face_width_mm, known) == (np.ceil(least), True)


@pytest.mark.judges("drivetrain")
def test_a_motors_torques_are_those_of_its_course_where_it_has_one() -> None:
    load: Any = Made(rms_n_mm=3000.0, most_n_mm=Extremum(9000.0, 1.0))
    course: Any = Made(rms_n_mm=2000.0, motor_range_n_mm=(-1000.0, 5000.0))
    even, swinging = MotorResult(Made(), Made(), load, None), MotorResult(Made(), Made(), load, course)
    assert (even.rms_n_m, even.most_n_m) == pytest.approx((3.0, 9.0))
    assert (swinging.rms_n_m, swinging.most_n_m) == pytest.approx((2.0, 5.0))


@pytest.mark.judges("whole_machines")
def test_laws_are_kept_that_load_flanks_less_than_every_law_of_less_power(monkeypatch: pytest.MonkeyPatch) -> None:
    def found(power: float, load: float) -> FoundLaw:
        return FoundLaw((1.0,), 0.0, Made(peak_power_w=power, flank_load_n_mm=load))

    by_cap = {None: found(400.0, 10.0), 150.0: found(150.0, 60.0), 200.0: found(200.0, 70.0), 300.0: found(299.0, 20.0)}
    monkeypatch.setattr(machine_laws, "start_motion", lambda *_: None)
    search: Any = machine_laws._Search(Made(), Made(), Made())
    search.least_power = lambda start: found(100.0, 90.0)
    search.capped = lambda cap, starts: by_cap[cap]
    search.caps_w = lambda least, most: [150.0, 200.0, 300.0]
    kept = [(one.found.peak_power_w, one.flank_load_n_mm) for one in search.laws()]
    assert kept == [(100.0, 90.0), (150.0, 60.0), (299.0, 20.0), (400.0, 10.0)]
    # A law that is found above its cap is none.
    by_cap[150.0] = found(151.0, 60.0)
    assert [one.found.peak_power_w for one in search.laws()] == [100.0, 200.0, 299.0, 400.0]


@pytest.mark.judges("whole_machines")
@at_once(
    ("process", "plastics", "verdicts", "words"),
    [
        ("printed", (True, True), (), "printed"),
        ("printed", (False, False), (), "of metal"),
        ("printed", (True, False), (), "printed"),
        ("wire_cut", (True, False), (CUTS, CUTS), "of plastic"),
        (
            "wire_cut",
            (False, False),
            (CUTS, CUTS),
            f"a {Tool.WIRE.value} {CutVerdict.CUTS.value}",
        ),
        (
            "hobbed",
            (False, False),
            (CutVerdict.CUTS, CutVerdict.FLANKS),
            f"a {Tool.HOB.value} {CutVerdict.FLANKS.value}",
        ),
        ("hobbed", (False, False), (CUTS, CutVerdict.NOT), "the driven gear: concave"),
    ],
)
def test_a_process_makes_what_its_tool_cuts(
    process: Any, plastics: tuple[bool, ...], verdicts: tuple[CutVerdict, ...], words: str
) -> None:
    from ncgear.strength.materials import Plastic
    from ncgear.whole_machines import machine

    with pytest.MonkeyPatch.context() as patch:
        entries = [Made(entry=object.__new__(Plastic) if one else None) for one in plastics]
        patch.setattr(machine, "choices_of", lambda gears: entries)
        made = [Made(by=[Made(tool=tool, verdict=verdict, reason="concave") for tool in Tool]) for verdict in verdicts]
        patch.setattr(machine, "cut_gears", lambda drive: made)
        makes = not words.startswith(("of ", "the "))
        assert cut_words(Made(gears=None), process) == (makes, words)


@pytest.mark.judges("whole_machines")
def test_caps_are_in_even_ratios_up_to_the_greatest_power() -> None:
    search: Any = machine_laws._Search(Made(), Made(), Made(powers_w=()))
    caps = search.caps_w(100.0, 400.0)
    assert np.diff(np.log([*caps, 400.0])) == pytest.approx(log(400.0 / 100.3) / 4.0)
    assert search.caps_w(100.0, 101.9) == []
    search.job = Made(powers_w=(500.0, 300.0, 100.2, 101.0))
    assert search.caps_w(100.0, 400.0) == [101.0, 300.0]
