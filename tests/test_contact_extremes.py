"""Extremes of the contact between its positions: a closed form, and positions that the search did not use."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from math import atan, cos, pi, radians, sin, sqrt, tan
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from engaged import MODULE, TOLERANCE, designed, made, outlines
from ncgear.contact.designed.as_designed import as_designed, touch_at
from ncgear.contact.designed.extremes import CLOSELY, KNOWN, ContactExtremes, contact_extremes
from ncgear.contact.pair import PairContact, pair_contact, refuse_overlap, sound_extremes
from ncgear.contact.placement import Placement, placed, placed_at
from ncgear.contact.written.as_written import reach_mm
from ncgear.contact.written.extremes import KNOWN as KNOWN_OF_WRITTEN
from ncgear.contact.written.play import facing_outlines, outline_play
from ncgear.errors import NoSuchMechanism
from ncgear.numerics.extrema import Extremum
from ncgear.numerics.highest import largest_from
from ncgear.pitch.pair import PitchPair
from ncgear.teeth.form import TipRelief
from ncgear.teeth.gear import ToothedPair

Array = np.ndarray

ERRORS = 3
"""So many of the quantities, the first, are errors or play."""

SPEED = 3.0
"""Speed of the driving gear in rad/s."""


def evenly(phi1: Array) -> Array:
    return np.full_like(phi1, SPEED)


def extremes(name: str, teeth: int, backlash_mm: float = 0.0, **kinds: Any) -> ContactExtremes:
    pitch, pair = made(name, teeth, TOLERANCE, backlash_mm, **kinds)
    return contact_extremes(pair, pitch, designed(name, teeth, backlash_mm, **kinds), evenly)


@pytest.mark.slow
@pytest.mark.parametrize(("name", "teeth", "ratio"), [("uniform", 26, 1.0), ("uniform 1:2", 18, 2.0)])
def test_sliding_of_circular_gears_is_the_closed_form(name: str, teeth: int, ratio: float) -> None:
    """At the end of contact: (w1 + w2) times the line of action from the pitch point to the larger tip circle's end.

    A corner counts as touching until it is a ten-thousandth of a pitch from its mate, a little beyond.
    """
    found = extremes(name, teeth)
    alpha, reach = radians(20.0), []
    for radius in (teeth * MODULE / 2.0, ratio * teeth * MODULE / 2.0):
        reach.append(sqrt((radius + MODULE) ** 2 - (radius * cos(alpha)) ** 2) - radius * sin(alpha))
    expected = SPEED * (1.0 + 1.0 / ratio) * max(reach)
    assert (1.0 - KNOWN) * expected <= found.sliding_mm_s.value <= 1.03 * expected
    # Negative control: the positions of the table miss it by about a per cent.
    assert designed(name, teeth).largest_sliding_mm.max() * SPEED < 0.995 * found.sliding_mm_s.value
    assert found.pushing_error_rad.width == found.backlash_rad.width == found.overlap_mm.value == 0.0


def test_ranges_of_a_circular_pair_are_the_closed_forms() -> None:
    """Play on the idle flanks alone; along the line of action, of tan(p) from one end of contact to the other.

    The first contact is the one nearest to the pitch point: half a base pitch from it at most, where the next one takes
    over, on either side.
    """
    backlash, radius, alpha = 0.1, 18.0, radians(20.0)
    found = extremes("uniform", 18, backlash)
    base, play = radius * cos(alpha), backlash / (radius * cos(alpha))
    for told, wanted in ((found.pushing_error_rad, 0.0), (found.back_error_rad, play), (found.backlash_rad, play)):
        assert [told.low.value, told.high.value] == pytest.approx([wanted, wanted], abs=1e-12)
    half = pi * MODULE * cos(alpha) / 2.0
    ends = [atan((base * tan(alpha) + off) / base) for off in (-half, half)]
    for told in (found.pushing_pressure_angle_rad, found.back_pressure_angle_rad):
        assert [told.low.value, told.high.value] == pytest.approx(ends, rel=1e-5)
    assert found.least_lever_mm.value == pytest.approx(base, rel=1e-9)
    reach = sqrt((radius + MODULE) ** 2 - base**2) - radius * sin(alpha)
    assert (1.0 - KNOWN) * 2.0 * SPEED * reach <= found.sliding_mm_s.value <= 1.03 * 2.0 * SPEED * reach
    assert found.overlap_mm.value == 0.0


def test_a_driven_gear_ahead_overlaps_by_its_way_at_the_base_radius(monkeypatch: pytest.MonkeyPatch) -> None:
    """Turned on by an angle, the backs of round gears lie in each other by it times the base radius."""
    ahead = 1e-3
    pitch, pair = made("uniform", 18)

    def turned(*place: Any) -> Placement:
        at = placed_at(*place)
        return replace(at, phi2_rad=at.phi2_rad + ahead)

    monkeypatch.setattr("ncgear.contact.designed.extremes.placed_at", turned)
    even = placed(pitch)
    contact = as_designed(pair, replace(even, phi2_rad=even.phi2_rad + ahead))
    found = contact_extremes(pair, pitch, contact, evenly)
    assert found.overlap_mm.value == pytest.approx(ahead * 18.0 * cos(radians(20.0)), rel=1e-6)
    assert found.pushing_error_rad.low.value == pytest.approx(-ahead, abs=1e-9)
    both: Any = SimpleNamespace(
        extremes=[SimpleNamespace(overlap_mm=found.overlap_mm), SimpleNamespace(overlap_mm=Extremum(0.0, 0.0))]
    )
    assert PairContact.penetration_mm.fget(both) == found.overlap_mm.value  # type: ignore[attr-defined]


def test_teeth_at_the_pitch_point_are_those_whose_middles_are_nearest() -> None:
    """Driving teeth stand at whole pitches, driven ones half a pitch on."""
    pitch, _ = made("uniform", 18)
    even = placed(pitch)
    for position in (3, 6, 9, 14, 29, 351):
        pitches = even.rolled_mm[position] / even.pitch_mm
        driving = int(np.argmin(np.abs(np.arange(19) - pitches))) % 18 + 1
        driven = int(np.argmin(np.abs(np.arange(-1, 18) + 0.5 - pitches)) - 1) % 18 + 1
        assert even.teeth_at(position) == (driving, driven)


def places_looked_at(backlash_mm: float, monkeypatch: pytest.MonkeyPatch) -> tuple[int, ContactExtremes]:
    """How many places the search looks at, and what it finds."""
    sizes: list[int] = []

    def counting(pitch: PitchPair, even: Placement, rolled_mm: Array) -> Placement:
        sizes.append(rolled_mm.size)
        return placed_at(pitch, even, rolled_mm)

    monkeypatch.setattr("ncgear.contact.designed.extremes.placed_at", counting)
    found = extremes("sine", 31, backlash_mm)
    return sum(sizes), found


@pytest.mark.slow
def test_next_to_no_backlash_is_found_as_quickly(monkeypatch: pytest.MonkeyPatch) -> None:
    """A play of 1e-4 mm varies by rounding errors alone, and is in proportion to that of 0.05 mm."""
    usual, wide = places_looked_at(0.05, monkeypatch)
    tiny, narrow = places_looked_at(1e-4, monkeypatch)
    assert tiny <= 2 * usual
    for end in ("low", "high"):
        share = getattr(narrow.backlash_rad, end).value / getattr(wide.backlash_rad, end).value
        assert share == pytest.approx(1e-4 / 0.05, rel=1e-3)


CASES = [
    ("sine", 31, 0.1, {}),
    ("baler", 43, 0.2, {}),
    ("ellipse", 37, 0.05, {"relief": TipRelief(0.05, 0.3, 2.0)}),
    ("ring", 40, 0.1, {}),
    ("uniform", 12, 0.0, {"undercut": True}),
]


@pytest.mark.tiers(slow=["ellipse-37-0.05-kinds2"], rest="long")
@pytest.mark.parametrize(("name", "teeth", "backlash_mm", "kinds"), CASES)
def test_positions_that_the_search_did_not_use_find_nothing_beyond(
    name: str, teeth: int, backlash_mm: float, kinds: dict[str, Any]
) -> None:
    """400 positions to a pitch, all of them an irrational share of a step beside the others."""
    found = extremes(name, teeth, backlash_mm, **kinds)
    pitch, pair = made(name, teeth, TOLERANCE, backlash_mm, **kinds)
    even = designed(name, teeth, backlash_mm, **kinds).placement
    rolled = (np.arange(400 * even.meetings) + (sqrt(5.0) - 1.0) / 2.0) * even.pitch_mm / 400.0
    touch = touch_at(pair)
    judged = [touch(placed_at(pitch, even, block)) for block in np.array_split(rolled, rolled.size // 1000)]
    ranges = {
        found.pushing_error_rad: [one.pushing.error_rad for one in judged],
        found.back_error_rad: [one.back.error_rad for one in judged],
        found.backlash_rad: [one.backlash_rad for one in judged],
        found.pushing_pressure_angle_rad: [one.pushing.first.pressure_angle_rad for one in judged],
        found.back_pressure_angle_rad: [one.back.first.pressure_angle_rad for one in judged],
    }
    for number, (told, blocks) in enumerate(ranges.items()):
        values = np.concatenate(blocks)
        beyond, missed = (share * np.ptp(values) + 2e-12 for share in (0.1, KNOWN if number < ERRORS else CLOSELY))
        assert told.low.value - missed <= values.min() <= told.low.value + beyond
        assert told.high.value - beyond <= values.max() <= told.high.value + missed
    sliding = SPEED * max(one.largest_sliding_mm.max() for one in judged)
    assert 0.99 * found.sliding_mm_s.value <= sliding <= (1.0 + KNOWN) * found.sliding_mm_s.value
    assert max(one.pushing.overlap_mm.max() for one in judged) <= found.overlap_mm.value + 1e-9


@pytest.mark.slow
def test_a_pressure_angle_that_passes_zero_is_least_at_zero() -> None:
    """Where the normal's angle against the pitch curve changes its sign; circular gears never come so far."""
    steep, even = extremes("long ellipse", 60, 0.1), extremes("uniform", 26)
    for angle in (steep.pushing_pressure_angle_rad, steep.back_pressure_angle_rad):
        assert angle.low.value == 0.0
        assert angle.high.value > radians(45.0)
    assert even.pushing_pressure_angle_rad.low.value > radians(10.0)


def test_where_the_pressure_angle_is_zero_the_normal_is_across_the_radius(monkeypatch: pytest.MonkeyPatch) -> None:
    """The normal leads through the pitch point, as the law of gearing has it.  It is not searched for."""
    pitch, pair = made("baler", 24, TOLERANCE, 0.0)
    sought: list[Array] = []

    def noting(functions: Callable[[Array], Array], places: Array, values: Array, missed: Array) -> list[Extremum]:
        sought.append(values[np.isfinite(missed)])
        return largest_from(functions, places, values, missed)

    monkeypatch.setattr("ncgear.contact.designed.extremes.largest_from", noting)
    even, found = designed("baler", 24).placement, extremes("baler", 24)
    assert len(sought[0]) == 11
    for side, angle in (("pushing", found.pushing_pressure_angle_rad), ("back", found.back_pressure_angle_rad)):
        rolled = pitch.driving.arc.length(np.array([angle.low.at])) * pitch.driving.unit_mm
        at = placed_at(pitch, even, rolled)
        place = getattr(touch_at(pair)(at), side).first.fixed_points(at)
        normal, arm = place - at.driving_radius_mm, place - at.center_distance_mm
        assert angle.low.value == 0.0
        assert np.abs((normal * arm.conj()).real / np.abs(normal * arm)) <= 1e-6


WRITTEN = [
    ("uniform", 12, 0.0, {"undercut": True}),
    ("uniform 3:2", 30, 0.1, {}),
    ("sine", 31, 0.1, {}),
    ("long ellipse", 60, 0.0, {}),
    ("ring", 40, 0.1, {}),
    ("baler", 43, 0.2, {}),
    ("ellipse", 37, 0.05, {"relief": TipRelief(0.05, 0.3, 2.0)}),
]


@pytest.mark.tiers(slow=["uniform-12*", "uniform 3*"], rest="long")
@pytest.mark.parametrize(("name", "teeth", "backlash_mm", "kinds"), WRITTEN)
def test_fifty_times_as_many_positions_find_nothing_beyond_written_outlines_extremes(
    name: str, teeth: int, backlash_mm: float, kinds: dict[str, Any]
) -> None:
    """Positions beside those of the table, with outlines where the law has them, not in the middle of their play."""
    pitch, pair = made(name, teeth, TOLERANCE, backlash_mm, **kinds)
    contact = pair_contact(pitch, pair, designed(name, teeth, backlash_mm, **kinds), [outlines(pair)])
    (found,), even = contact.extremes, contact.as_designed.placement
    rolled = (np.arange(50 * even.count) + (sqrt(5.0) - 1.0) / 2.0) * even.step_mm / 50.0
    facing = facing_outlines(pair.driving.outline_mm, pair.driven.outline_mm, even)
    reach, bounds, overlap_mm = reach_mm(pitch, pair), [], 0.0
    for block in np.array_split(rolled, rolled.size // 1000):
        at = placed_at(pitch, even, block)
        play = outline_play(facing, at, reach)
        bounds.append(np.stack(at.bounds_rad(play.up_rad, play.down_rad)))
        overlap_mm = max(overlap_mm, float(play.overlap_mm.max()))
    pushing, back = np.hstack(bounds)
    (sampled,), seen = contact.as_written, []
    for told, values, before in (
        (found.pushing_rad, pushing, sampled.pushing_rad),
        (found.back_rad, back, sampled.back_rad),
        (found.backlash_rad, back - pushing, sampled.backlash_rad),
    ):
        allowed = KNOWN_OF_WRITTEN * np.ptp(values)
        assert values.min() - 3.0 * allowed <= told.low.value <= values.min() + allowed
        assert values.max() - allowed <= told.high.value <= values.max() + 3.0 * allowed
        seen.append(float(np.ptp(before)) / told.width)
    # Negative control: the positions of the table miss several hundredths of a variation.
    assert min(seen) < 1.0 - 2.0 * KNOWN_OF_WRITTEN
    room = KNOWN_OF_WRITTEN * float(np.ptp(pushing) * even.driven_radius_mm.max())
    assert overlap_mm - room <= found.overlap_mm.value <= overlap_mm + room


@pytest.mark.thorough
def test_single_positions_see_what_the_table_of_even_ones_sees() -> None:
    pitch, pair = made("sine", 31, TOLERANCE, 0.1)
    contact = designed("sine", 31, 0.1)
    some = placed_at(pitch, contact.placement, contact.placement.rolled_mm[7::13])
    single = touch_at(pair)(some)
    np.testing.assert_allclose(single.pushing.error_rad, contact.pushing.error_rad[7::13], atol=1e-14)
    np.testing.assert_allclose(single.back.error_rad, contact.back.error_rad[7::13], atol=1e-14)
    np.testing.assert_allclose(single.largest_sliding_mm, contact.largest_sliding_mm[7::13], rtol=1e-9)


@pytest.mark.slow
def test_an_overlap_between_positions_is_refused() -> None:
    """Base pitches of another pressure angle: overlaps have kinks where one pair takes over from the other."""
    pitch, pair = made("sine", 25)
    _, other = made("sine", 25, TOLERANCE, 0.0, 21.0)
    unlike, placement = ToothedPair(pair.driving, other.driven, pair.cutter), placed(pitch)
    contact = as_designed(unlike, placement)
    found, sampled = contact_extremes(unlike, pitch, contact, evenly), float(contact.overlap_mm.max())
    assert found.overlap_mm.value > 1.001 * sampled
    between = (sampled + found.overlap_mm.value) / 2.0
    refuse_overlap(contact, between)
    with pytest.raises(NoSuchMechanism, match=r"run into each other by .* near tooth \d+ of the driving gear"):
        sound_extremes(pitch, unlike, contact, evenly, between)
