"""Outlines as a maker would judge them: no reversal, no repeated point, no crossing, no more points than are of use."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from itertools import pairwise
from math import pi

import numpy as np
import pytest
from shapely import Polygon

from ncgear.pitch.pair import sized_pair
from ncgear.ratio.laws.ellipse import elliptical_law
from ncgear.ratio.laws.uniform import uniform_law
from ncgear.ratio.transmission import Lobes, Transmission
from ncgear.teeth import chords
from ncgear.teeth.form import BasicRack, ToothForm
from ncgear.teeth.gear import ToothedGear, toothed_pair
from pairs import baler_law, rack, sine_law
from plane import steps, turns

pytestmark = pytest.mark.slow

Array = np.ndarray

SAME_POINT = 1e-9
"""Distance in modules at which points count as repeated: nothing that is made or displayed can tell them apart."""

CORNER = 0.2
"""Turn in rad of a finely sampled outline that is a corner: chords of a smooth curve turn by a tenth of that there."""

FINER = 400.0
"""How many times finer the oracle's outline is sampled: it has 20 times as many points as are needed."""

PLACING = 1.03
"""Chords are placed for 0.95 of the tolerance and therefore 1.026 times as many as the fewest; the rest is halving."""

JOINTS = 8
"""Points per tooth where two curves join smoothly, which the fewest chords pass: ends of fillets and of flanks, and the
shorter chords with which hollow ones begin and end."""

HOLLOW = 1.12
"""Chords of curves that may be hollow are placed for 0.8 of the tolerance: the root of 1 / 0.8 times as many."""


def uniform() -> Transmission:
    return uniform_law(Lobes())


def mild() -> Transmission:
    return sine_law(0.08)


def sharp() -> Transmission:
    return elliptical_law(0.7, 0.0, Lobes())


Design = tuple[Callable[[], Transmission], int, BasicRack]

DESIGNS: dict[str, Design] = {
    "circular": (uniform, 18, rack()),
    "circular, few teeth": (uniform, 8, rack()),
    "circular, many teeth": (uniform, 500, rack()),
    "mild": (mild, 25, rack()),
    "mild, small module": (mild, 25, rack(module=0.3)),
    "mild, large module": (mild, 25, rack(module=20.0)),
    "mild, 14.5 degrees": (mild, 25, rack(14.5, 1.0, 1.157, 0.2)),
    "mild, 25 degrees": (mild, 25, rack(25.0, 1.0, 1.25, 0.25)),
    "mild, many teeth": (mild, 500, rack()),
    "pointed": (uniform, 12, rack(25.0, 1.3, 1.25, 0.25)),
    "sharp": (sharp, 25, rack()),
    "baler": (baler_law, 25, rack()),
    "baler free of undercut": (baler_law, 86, rack()),
}

TOLERANCES = (0.005, 0.0002)
CASES = [
    pytest.param(
        name,
        tolerance,
        id=f"{name}, {tolerance}",
        marks=[pytest.mark.slow, *[pytest.mark.long] * (tolerance < 1e-3)] if "many" in name else [],
    )
    for name in DESIGNS
    for tolerance in TOLERANCES
]


@pytest.fixture(autouse=True)
def without_budget(monkeypatch: pytest.MonkeyPatch) -> None:
    """The budget of points bounds what a build costs; references here are far finer."""
    monkeypatch.setattr(chords, "MOST_CHORDS", 1_000_000)


@cache
def gears(name: str, tolerance: float) -> tuple[ToothedGear, ToothedGear]:
    """Both gears of a design."""
    law, teeth, basic = DESIGNS[name]
    pair = toothed_pair(
        sized_pair(law(), teeth, basic.module_mm, None), ToothForm(basic), tolerance, flank_tolerance_mm=tolerance
    )
    return pair.driving, pair.driven


def reversals(outline: Array) -> int:
    """Number of vertices at which an outline turns by more than a right angle."""
    return int(np.sum(np.abs(turns(outline)) > pi / 2.0))


def shortest_chord(outline: Array) -> float:
    """Length of the shortest chord."""
    return float(np.linalg.norm(steps(outline), axis=1).min())


# --- the fewest points -------------------------------------------------------------------------------------------


def within(points: Array, tolerance: float) -> bool:
    """Whether the chord from the first point to the last passes all others within the tolerance."""
    chord, arm = points[-1] - points[0], points - points[0]
    return bool(np.all(np.abs(chord[0] * arm[:, 1] - chord[1] * arm[:, 0]) <= tolerance * np.hypot(*chord)))


def longest_chord(points: Array, start: int, tolerance: float) -> int:
    """Index of the last point that a chord from ``start`` may reach; doubling, then bisection."""
    last, reach = len(points) - 1, 1
    while start + reach < last and within(points[start : start + 2 * reach + 1], tolerance):
        reach *= 2
    low, high = start + reach, min(start + 2 * reach, last)
    while low < high:
        middle = (low + high + 1) // 2
        low, high = (middle, high) if within(points[start : middle + 1], tolerance) else (low, middle - 1)
    return min(low, last)


def fewest_chords(points: Array, tolerance: float) -> int:
    """Longest chords, one after the other: the fewest with ends on the curve (Imai and Iri, 1986)."""
    at, count = 0, 0
    while at < len(points) - 1:
        at, count = longest_chord(points, at, tolerance), count + 1
    return count


def fewest_points(fine: Array, tolerance: float) -> int:
    """Fewest points of an outline that keeps the corners of a finely sampled one."""
    corners = np.nonzero(np.abs(turns(fine)) > CORNER)[0]
    rolled = np.roll(fine, -corners[0], axis=0)
    bounds = [*(corners - corners[0]), len(fine)]
    closed = np.vstack([rolled, rolled[:1]])
    return sum(fewest_chords(closed[a : b + 1], tolerance) for a, b in pairwise(bounds))


def test_fewest_points_of_an_arc_are_those_of_its_sagitta() -> None:
    around = np.linspace(0.0, 1.0, 200_001)
    arc = 10.0 * np.column_stack([np.cos(around), np.sin(around)])
    for tolerance in (1e-2, 1e-3, 1e-4):
        each = 2.0 * np.arccos(1.0 - tolerance / 10.0)
        assert fewest_chords(arc, tolerance) == np.ceil(1.0 / each)


def test_fewest_points_of_a_square_are_its_corners() -> None:
    side = np.linspace(0.0, 1.0, 51)[:-1, None] * np.array([1.0, 0.0])
    corner, quarter = np.zeros(2), np.array([[0.0, 1.0], [-1.0, 0.0]])
    sides = []
    for _ in range(4):
        sides.append(corner + side)
        corner, side = corner + side[1] * 50.0, side @ quarter
    assert fewest_points(np.vstack(sides), 1e-6) == 4


# --- outlines ----------------------------------------------------------------------------------------------------


@pytest.mark.tiers(
    slow=[
        "circular, 0.005",
        "circular, few teeth, 0.005",
        "circular, many teeth, 0.005",
        "mild, 0.0002",
        "mild, small module, 0.0002",
        "mild, large module, 0.0002",
        "mild, 14.5 degrees, 0.0002",
        "mild, 25 degrees, 0.0002",
        "pointed, 0.005",
        "sharp, 0.005",
        "baler, 0.005",
        "baler free of undercut, 0.005",
    ],
    rest="long",
)
@pytest.mark.parametrize(("name", "tolerance"), CASES)
def test_outline_turns_back_nowhere(name: str, tolerance: float) -> None:
    """A tip turns by 90 degrees less the pressure angle there; nothing else on a tooth is as sharp."""
    for gear in gears(name, tolerance):
        assert reversals(gear.outline_mm) == 0
        assert turns(gear.outline_mm).min() > -pi / 2.0


@pytest.mark.tiers(
    slow=[
        "circular, 0.0002",
        "circular, many teeth, 0.005",
        "mild, 0.0002",
        "mild, large module, 0.005",
        "mild, 14.5 degrees, 0.0002",
        "mild, 25 degrees, 0.0002",
        "pointed, 0.0002",
        "baler, 0.005",
        "baler free of undercut, 0.005",
    ],
    rest="long",
)
@pytest.mark.parametrize(("name", "tolerance"), CASES)
def test_outline_repeats_no_point_and_does_not_cross_itself(name: str, tolerance: float) -> None:
    for gear in gears(name, tolerance):
        assert shortest_chord(gear.outline_mm) > SAME_POINT * DESIGNS[name][2].module_mm
        assert Polygon(gear.outline_mm).is_valid


def most_points(fine: ToothedGear, tolerance: float) -> float:
    """What an outline may have, judged by a finely sampled one."""
    return HOLLOW * PLACING * fewest_points(fine.outline_mm, tolerance) + JOINTS * fine.teeth


@pytest.mark.tiers(slow=["mild, 14.5 degrees, 0.0002"], rest="long")
@pytest.mark.parametrize(("name", "tolerance"), CASES)
def test_outline_has_hardly_more_points_than_the_tolerance_needs(name: str, tolerance: float) -> None:
    for gear, fine in zip(gears(name, tolerance), gears(name, tolerance / FINER), strict=True):
        assert len(gear.outline_mm) <= most_points(fine, tolerance)


def test_an_outline_sampled_twice_too_finely_has_too_many_points() -> None:
    """Negative control: the square root of 2 times as many."""
    tolerance = TOLERANCES[1]
    for gear, fine in zip(gears("mild", tolerance / 2.0), gears("mild", tolerance / FINER), strict=True):
        assert len(gear.outline_mm) > most_points(fine, tolerance)


def test_reversals_repeated_points_and_crossings_are_seen() -> None:
    """Negative control: a tooth of sound outline with a spur, a point twice, and two points swapped."""
    sound = gears("mild", TOLERANCES[0])[0].outline_mm
    spur = np.insert(sound, 40, sound[39] + (sound[39] - sound[38]) * 0.5 + 1e-3, axis=0)
    spur = np.insert(spur, 41, sound[39], axis=0)
    assert reversals(sound) == 0 < reversals(spur)
    assert shortest_chord(np.insert(sound, 40, sound[40], axis=0)) == 0.0
    swapped = sound.copy()
    swapped[[40, 48]] = swapped[[48, 40]]
    assert not Polygon(swapped).is_valid
