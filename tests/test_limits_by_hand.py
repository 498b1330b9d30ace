"""The limit and the search for laws by stand-ins whose answers are known: cases, wishes that give way, integrals."""

from __future__ import annotations

from math import inf, pi, sqrt
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from ncgear.mechanisms.scotch_yoke import ScotchYoke
from ncgear.optimum.certified import refusals
from ncgear.optimum.makeable import demanded, law
from ncgear.optimum.makeable.driving_ranges import Passed
from ncgear.optimum.makeable.levels import LevelKind
from ncgear.optimum.makeable.motion_wishes import _times
from ncgear.optimum.makeable.places import CellPlaces
from ncgear.optimum.makeable.reached import SMALLEST, JudgedLaw, _Values
from ncgear.optimum.makeable.rows import _angles, _of_root
from ncgear.strength.without_teeth import _relieved_mm, slid_w
from ncgear.trains.path_search import PLACES, WIDE, PathLimits, _places
from ncgear.wishes.requirements import TimeWithin

pytestmark = pytest.mark.judges("optimum")

Made: Any = SimpleNamespace


@pytest.mark.parametrize(("law_value", "least"), [(99.0, 10.4), (10.25, 10.25)])
def test_cases_of_driving_ranges_are_halved_where_their_limit_is_least(
    law_value: float, least: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A case whose crank angles begin at s and end at e has a limit of 10 + the distance of its angles from 0.4."""

    def limit(task: Any, wishes: Any, case: Any) -> float:
        (low, high), _ = case["wish"]
        return 10.0 + max(low - 0.4, 0.4 - high, 0.0) + 0.8 * min(max(0.5 - (high - low), 0.0), 0.5)

    every = {"wish": Passed((0.0, 1.0), (2.0, 2.0))}
    monkeypatch.setattr(demanded, "_every_law", lambda *_: every)
    monkeypatch.setattr(demanded, "_limit_in", limit)
    told: list[int] = []
    found = demanded._by_cases(Made(), Made(), 9.0, law_value, lambda used, most: told.append(used))
    assert found <= law_value
    assert found == pytest.approx(least, rel=demanded.CLOSE - 1.0)
    assert told[0] == 2
    assert all(used <= demanded.MOST_CASES for used in told)
    monkeypatch.setattr(demanded, "_every_law", lambda *_: {})
    assert demanded._by_cases(Made(), Made(), 9.0, law_value, lambda *_: None) == 9.0
    monkeypatch.setattr(demanded, "_every_law", lambda *_: every)
    assert demanded._by_cases(Made(), Made(), 9.95, 10.0, lambda *_: pytest.fail("close to the law")) == 9.95


def search(needed: set[frozenset[str]], shares: dict[str, float], monkeypatch: pytest.MonkeyPatch) -> Any:
    """A search that has a law without any of some sets of wishes; wishes press by their shares."""
    levels = [Made(wish=name) for name in shares]
    pressing = np.array(list(shares.values()))

    def without(search: Any, freed: Any, price: float, near: Any) -> Any:
        enough = any(one <= set(freed) for one in needed)
        return Made(excess=0.0 if enough else 1.0, pressing=pressing, freed=set(freed))

    monkeypatch.setattr(law, "_without", without)
    return Made(programme=Made(levels=levels))


def test_wishes_give_way_together_the_most_pressing_first_and_as_few_as_do(monkeypatch: pytest.MonkeyPatch) -> None:
    shares = {"a": 0.5, "b": 0.1, "c": 0.4}
    near: Any = Made(excess=1.0, pressing=np.array(list(shares.values())))
    made = search({frozenset("c")}, shares, monkeypatch)
    freed, found = law._freed_together(made, near, lambda level: True)
    assert (freed, found.freed) == (["c"], {"c"})
    made = search({frozenset("ac")}, shares, monkeypatch)
    assert law._freed_together(made, near, lambda level: True)[0] == ["a", "c"]
    made = search({frozenset("b")}, shares, monkeypatch)
    assert law._freed_together(made, near, lambda level: True)[0] == ["b"]
    # None of those that may give way is enough.
    assert law._freed_together(made, near, lambda level: level.wish != "b") == (["a", "c"], None)


def test_a_wish_is_eased_to_what_a_law_has_reached_and_a_share_more() -> None:
    def shown(value: float) -> Any:
        return Offer(value)

    class Offer(SimpleNamespace):
        def __init__(self, value: float, key: str = "") -> None:
            super().__init__(value=value, key=key)

    levels = [
        Made(wish="a", widest=9.0, shown=shown, key="k1"),
        Made(wish="a", widest=9.0, shown=shown, key="k2"),
        Made(wish="b", widest=1.0, shown=shown, key="k3"),
    ]
    made: Any = Made(programme=Made(levels=levels))
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(law, "replace", lambda offer, key: Offer(offer.value, key))
        told = list(law._easing(made, "a", np.array([2.0, 3.0, 5.0])))
        assert [(one.value, one.key) for one in told] == [(3.0, "k2")]
        assert list(law._easing(made, "b", np.array([2.0, 3.0, 5.0]))) == []
        more = law._eased_by(made, ["a", "b"], np.array([-2.0, 0.2, 0.5]))(0.1)
        # A tenth of its size, or of 1 where it is smaller.
        assert [(one.value, one.key) for one in more] == [(pytest.approx(0.3), "k2"), (pytest.approx(0.6), "k3")]


# --- values over a turn ----------------------------------------------------------------------------------------------


def places(steps: int) -> CellPlaces:
    """Two cells of a turn with a number of steps each; where they meet are two places."""
    ends = np.array([0.0, 2.0, 2.0 * pi])
    angle = np.concatenate([np.linspace(*ends[:2], steps + 1), np.linspace(*ends[1:], steps + 1)])
    number = np.arange(2 * steps + 2).reshape(2, -1)
    simpson = np.array([1.0, 4.0, 1.0])
    weight = np.zeros((2, steps + 1))
    for cell, width in enumerate(np.diff(ends)):
        for step in range(0, steps, 2):
            weight[cell, step : step + 3] += simpson * width / steps / 3.0
    slider: Any = Made()
    return CellPlaces(ends, angle, slider, number, weight)


def test_means_sizes_and_waves_are_those_over_the_driving_angle() -> None:
    """With i = 1 + 0.3 cos(phi2), psi = phi2 + 0.3 sin(phi2): means over psi by a fine sum of their own."""
    at = places(200)
    ratio = 1.0 + 0.3 * np.cos(at.angle_rad)
    judged: Any = Made(at=at, law=[Made(ratio=ratio)], angle_rad=at.angle_rad + 0.3 * np.sin(at.angle_rad))
    values = _Values(judged)
    term = np.sin(at.angle_rad) ** 2 + 0.5
    fine = (np.arange(100_000) + 0.5) * 2.0 * pi / 100_000
    weight = (1.0 + 0.3 * np.cos(fine)) / 100_000
    mean = float(np.sum((np.sin(fine) ** 2 + 0.5) * weight))
    assert values.mean_of(term) == pytest.approx(mean)
    assert values.size_of(term, 2.0 * pi) == pytest.approx(sqrt(mean))
    assert values.size_of(0.0 * term, 2.0 * pi) == SMALLEST
    waves = [1.0, np.cos(judged.angle_rad), np.sin(judged.angle_rad)]
    assert values.fitted(3.0 + 2.0 * waves[1] - waves[2], waves) == pytest.approx([3.0, 2.0, -1.0])
    assert values.unknowns == pytest.approx([mean, sqrt(mean), SMALLEST, 3.0, 2.0, -1.0])
    cosine, sine = values.wave(np.array([0.3]))
    assert (cosine, sine) == (np.cos(0.3), np.sin(0.3))


def test_an_integral_is_taken_over_its_stretch_less_its_target() -> None:
    at = places(8)
    level: Any = Made(stretch=Made(start_rad=2.0, end_rad=2.0 * pi), target=0.5)
    judged: Any = Made(at=at)
    term = (1.0 + at.angle_rad**2)[at.number]
    expected = 2.0 * pi - 2.0 + ((2.0 * pi) ** 3 - 8.0) / 3.0 - 0.5
    assert JudgedLaw.integral(judged, level, term) == pytest.approx(expected)


def test_a_root_of_a_mean_square_is_the_least_over_all_sizes() -> None:
    """(s + q/s)/(2 c) over s: at its least, s = sqrt(q), it is sqrt(q)/c."""
    level: Any = Made(cycle_rad=3.0)
    for size in (1.0, 2.0, 4.0):
        whole: Any = Made(size_of=lambda square, cycle, size=size: size)
        assert _of_root(level, 4.0, whole) == pytest.approx((size + 4.0 / size) / 6.0)


def test_driving_angles_at_all_places_follow_from_the_ratios() -> None:
    """Equations of two cells, solved for the angles of a parabola i = 1 + t^2: t + t^3/3."""
    at = places(2)
    rows: list[tuple[Any, Any, Any]] = []
    taken: list[int] = []

    def new(count: int, *_: float) -> np.ndarray:
        first = sum(taken)
        taken.append(count)
        return np.arange(first, first + count)

    system = Made(
        at=at,
        new=new,
        new_wholes=lambda count: np.arange(count),
        put_whole=lambda row, column, value=1.0: rows.append((row, column, value)),
        put_term=lambda row, place, term, value: rows.append((row, ("i", place, term), value)),
    )
    assert _angles(system, 7) == 0
    ratio = 1.0 + at.angle_rad**2
    matrix, right = np.zeros((sum(taken), at.count)), np.zeros(sum(taken))
    for row, column, value in rows:
        if isinstance(column, tuple):
            assert column[2] == 7
            np.add.at(right, row, -np.broadcast_to(value, np.shape(row)) * ratio[column[1]])
        else:
            np.add.at(matrix, (row, column), value)
    t = at.angle_rad
    assert np.linalg.solve(matrix, right) == pytest.approx(t + t**3 / 3.0)


def test_a_time_is_held_or_bounded_on_each_side() -> None:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(
            "ncgear.optimum.makeable.motion_wishes._level",
            lambda task, wish, asked, kind, sides, **more: (kind, sides(), more["per_share"], more["target"]),
        )
        task: Any = Made(cycle_rad=3.0)

        def told(**bounds: float) -> list[Any]:
            return list(_times(task, Made(), TimeWithin(Made(), **bounds)))

        assert told(least_rad=1.0, most_rad=2.0) == [
            (LevelKind.INTEGRAL, (1.0,), 3.0, 2.0),
            (LevelKind.INTEGRAL, (-1.0,), 3.0, -1.0),
        ]
        assert told(most_rad=2.0) == [(LevelKind.INTEGRAL, (1.0,), 3.0, 2.0)]
        assert told(least_rad=1.0, most_rad=inf) == [(LevelKind.INTEGRAL, (-1.0,), 3.0, -1.0)]
        assert told(least_rad=1.5, most_rad=1.5) == [(LevelKind.DEVIATION, (1.0,), 3.0, 1.5)]


def test_demands_are_told_in_the_units_of_a_file() -> None:
    """10 kN mm are 10 N m; a swing of energy of J w^2 d: 2e3 N mm at 10 rad/s and d = 0.05 are 0.4 kg m2."""
    task: Any = Made(linkage=ScotchYoke(40.0), speed_rad_s=10.0, speed_fluctuation=0.05)
    assert refusals._said(task, "acceleration_mm_s2", 5000.0) == "5000 mm/s^2"
    assert refusals._said(task, "speed_mm_s", 50.0) == "50 mm/s"
    assert refusals._said(task, "torque_n_mm", 10_000.0).startswith("10 ")
    assert refusals.in_demand(task, "fluctuation_n_mm") == pytest.approx(10.0**2 * 0.05 / 1000.0)
    offer = refusals._enough(task, "torque_n_mm", 10_000.0, "at least ")
    ((key, value),) = offer.values
    assert key.startswith("optimize.limits.")
    assert 10.0 < value <= 10.0 * (1.0 + 2.0 * refusals.EDGE) + 1e-3


@pytest.mark.judges("strength")
def test_tip_relief_grows_with_the_square_of_the_height_over_its_start() -> None:
    relief: Any = Made(start_mm=1.0, full_mm=3.0, amount_mm=0.02)
    assert _relieved_mm(np.array([0.0, 1.0, 2.0, 3.0]), relief) == pytest.approx([0.0, 0.0, 0.005, 0.02])
    assert _relieved_mm(np.array([5.0]), None).tolist() == [0.0]


@pytest.mark.judges("strength")
def test_friction_takes_its_share_of_loads_times_sliding() -> None:
    """At one of four positions 50 N/mm over 20 mm slide by 3 mm at 2 rad/s: 6 W of which friction takes a tenth."""
    side: Any = Made(
        line_n_mm=np.array([50.0]), place_mm=np.array([-3.0]), load=Made(turning_rad_s=np.array([2.0])), sections=2
    )
    assert slid_w([side, side], 4, 20.0, 0.1) == pytest.approx(0.1 * 6.0 / 4.0)


@pytest.mark.judges("trains")
def test_axes_are_tried_over_their_whole_area() -> None:
    path: Any = Made(points=np.array([0.0, 20.0, 10.0 + 30.0j]))
    everywhere = np.array(_places(path, 10.0, PathLimits(1.0, 20, 100.0)))
    assert len(everywhere) == PLACES**2
    assert everywhere.mean() == pytest.approx(10.0 + 10.0j)
    assert (np.ptp(everywhere.real), np.ptp(everywhere.imag)) == pytest.approx((20.0 * WIDE, 20.0 * WIDE))
    limits = PathLimits(1.0, 20, 100.0, low=1.0 + 2.0j, high=5.0 + 4.0j)
    inside = np.array(_places(path, 10.0, limits))
    assert [inside.real.min(), inside.real.max(), inside.imag.min(), inside.imag.max()] == [1.0, 5.0, 2.0, 4.0]
    assert [limits.outside(axis) for axis in (3.0 + 3.0j, 8.0 + 8.0j, -1.0 + 3.0j)] == [0.0, 5.0, 2.0]
    assert PathLimits(1.0, 20, 100.0).outside(9.0 + 9.0j) == 0.0
