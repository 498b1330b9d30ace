"""Ceilings over the tips of helical teeth: no jump is left, and nothing is lowered where there was none."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from math import pi

import numpy as np
import pytest

from ncgear.errors import NoSuchMechanism
from ncgear.pitch.pair import PitchPair, sized_pair
from ncgear.ratio.laws.ellipse import elliptical_law
from ncgear.ratio.laws.uniform import uniform_law
from ncgear.ratio.transmission import Lobes, Transmission
from ncgear.solids.helical.even_tips import RISE, ceilings_over
from ncgear.teeth.form import Ceiling, TipLimits, ToothForm
from ncgear.teeth.gear import ToothedPair, pair_tips, toothed_pair
from ncgear.teeth.tips import Limit, Tips
from pairs import baler_law, rack, sine_law

Array = np.ndarray

MODULE, TEETH = 2.0, 20
PITCH = MODULE * pi
STEP = PITCH / 48
LENGTH = TEETH * PITCH

Heights = Callable[[Array], Array]
"""Tip heights by the arc length at which flanks cross the pitch curve."""


def jumping(at: Array) -> Array:
    """2 mm, and from a fifth to a half of the length 1.5 mm."""
    return np.where((at % LENGTH > 0.2 * LENGTH) & (at % LENGTH < 0.5 * LENGTH), 1.5, 2.0)


def falling_up_to_a_jump(at: Array) -> Array:
    """A slope of -0.2 that ends with a small jump upwards, half way between two fitted sections."""
    left = 0.3 * LENGTH + STEP / 2.0 - at % LENGTH
    return np.where(left > 0.0, 2.0 + 0.2 * np.clip(left, 0.0, 2.0), 2.03)


def waving(at: Array) -> Array:
    return 1.6 + 0.4 * np.sin(2.0 * pi * 5.0 * at / LENGTH)


def tips_with(heights: Heights, advance: float) -> tuple[Tips, Tips]:
    """Circular gears' tips with heights put in their place."""
    pitch = sized_pair(uniform_law(Lobes()), TEETH, MODULE, None)
    driving, driven = (
        replace(tips, flanks=replace(tips.flanks, tip_height_mm=heights(tips.flanks.crossing_mm)))
        for tips in pair_tips(pitch, ToothForm(rack()), advance)[1]
    )
    return driving, driven


def ceiling_of(heights: Heights, steps: int = 48) -> Ceiling:
    return ceilings_over([tips_with(heights, STEP * step) for step in range(steps)], STEP)[0]


def along(ceiling: Ceiling, at: Array) -> Array:
    return np.interp(at, ceiling.at_mm[0], ceiling.height_mm[0], period=LENGTH)


@pytest.mark.slow
@pytest.mark.parametrize("heights", [jumping, falling_up_to_a_jump])
def test_heights_under_their_ceiling_rise_no_more_steeply_than_it(heights: Heights) -> None:
    at = np.linspace(0.0, LENGTH, 40_001)
    held = np.minimum(heights(at), along(ceiling_of(heights), at))
    assert np.max(np.abs(np.diff(held))) <= RISE * (at[1] - at[0]) * (1.0 + 1e-9)
    assert np.max(np.abs(np.diff(heights(at)))) > 5.0 * RISE * (at[1] - at[0])


@pytest.mark.slow
def test_a_ceiling_takes_nothing_but_the_way_up_to_the_jumps() -> None:
    at = np.linspace(0.0, LENGTH, 4001)
    lost = jumping(at) - np.minimum(jumping(at), along(ceiling_of(jumping), at))
    assert lost.max() == pytest.approx(0.5)
    # Half of 0.5 mm over 1 mm beside both jumps, and up to two steps where the jump is not known better.
    assert np.mean(lost) * LENGTH == pytest.approx(2 * 0.5 * 1.0 / 2.0, abs=2 * 2.0 * 0.5 * STEP)


@pytest.mark.slow
def test_there_is_no_ceiling_over_smooth_heights() -> None:
    assert np.all(ceiling_of(waving).height_mm > 4.0 * MODULE)


@pytest.mark.slow
def test_a_ceiling_over_part_of_a_pitch_knows_jumps_within_the_part_only() -> None:
    """Teeth that advance by a quarter of a pitch pass the jump at 0.2 of the length, on a tooth, or do not."""
    quarter = ceiling_of(jumping, 12)
    assert np.all(np.diff(quarter.at_mm, axis=1) > 0.0)
    for where in (0.2 * LENGTH, 0.5 * LENGTH):
        passed = np.any(
            (quarter.at_mm[0][:-1] < where) & (np.diff(quarter.at_mm[0]) < 1.5 * STEP) & (quarter.at_mm[0][1:] > where)
        )
        assert passed == bool(along(quarter, np.array([where]))[0] < 2.0)


# --- gears under ceilings -----------------------------------------------------------------------------------------


def flat(height: float, front_lower_by: float = 0.0) -> Ceiling:
    at = np.tile([0.0, 1.0], (2, 1))
    return Ceiling(LENGTH, at, np.array([[height] * 2, [height - front_lower_by] * 2]))


def under(pitch: PitchPair, ceiling: Ceiling | None) -> ToothedPair:
    ceilings = None if ceiling is None else (ceiling, ceiling)
    return toothed_pair(pitch, ToothForm(rack(), limits=TipLimits(ceilings=ceilings)), 0.005)


def test_tips_end_at_the_ceiling_and_say_so() -> None:
    pitch = sized_pair(elliptical_law(0.3, 0.0, Lobes()), TEETH, MODULE, None)
    low, free = under(pitch, flat(1.7)), under(pitch, None)
    np.testing.assert_allclose(low.driving.flanks.tip_height_mm, 1.7, rtol=1e-12)
    assert low.driven.shortened(Limit.HELIX) == list(range(1, TEETH + 1))
    assert not free.driven.shortened(Limit.HELIX)
    np.testing.assert_array_equal(low.driving.flanks.crossing_mm, free.driving.flanks.crossing_mm)


def test_a_tip_land_hardly_changes_when_its_edges_come_to_one_height() -> None:
    """A level land is parallel to the pitch curve; one that hardly slopes is hardly another."""
    pitch = sized_pair(elliptical_law(0.3, 0.0, Lobes()), TEETH, MODULE, None)
    level, sloping = (under(pitch, flat(1.7, by)).driving.outline_mm for by in (0.0, 1e-6))
    assert level.shape == sloping.shape
    assert 1e-7 < np.max(np.abs(level - sloping)) < 1e-5


@pytest.mark.slow
def test_spaces_get_shallower_by_degrees_where_undercut_begins() -> None:
    """As the dedendum grows by steps past the one that undercuts 17 teeth, no depth leaps."""
    pitch, depths = sized_pair(uniform_law(Lobes()), 17, MODULE, None), []
    for dedendum in np.linspace(1.2, 1.3, 21):
        gear = pair_tips(pitch, ToothForm(rack(dedendum=float(dedendum))), 0.0)[1][0]
        depths.append((gear.flanks.flank_depth_mm[0], bool(gear.undercut[0])))
    assert {marked for _, marked in depths} == {False, True}
    assert np.max(np.diff([depth for depth, _ in depths])) <= 0.005 * MODULE * 1.01


# --- advanced teeth exist, or are refused with tooth and remedy ----------------------------------------------------


@pytest.mark.slow
@pytest.mark.parametrize("advance", [0.3927, 0.7854])
def test_a_space_that_no_tip_can_cut_is_refused_by_tooth(advance: float) -> None:
    """Between teeth 7 and 8 the mate's tip is so steep that no perpendicular from the pitch point meets its edge."""
    pitch = sized_pair(sine_law(0.28), 13, MODULE, None)
    with pytest.raises(NoSuchMechanism, match=r"space beside the front flank of tooth 7 .* more teeth") as caught:
        toothed_pair(pitch, ToothForm(rack()), 0.02, advance_mm=advance)
    assert caught.value.key == "gears.teeth"


@pytest.mark.slow
def test_the_balers_outline_does_not_cross_itself_where_it_once_did() -> None:
    pitch = sized_pair(baler_law(), 25, 3.0, None)
    assert toothed_pair(pitch, ToothForm(rack(module=3.0)), 0.02, advance_mm=-1.0718).driving.teeth == 25


SCANNED: list[tuple[Callable[[], Transmission], int, int]] = [
    (baler_law, 25, 60),
    (lambda: sine_law(0.28), 13, 28),
    (lambda: sine_law(0.28), 24, 60),
    (lambda: sine_law(0.28), 48, 60),
    (lambda: sine_law(0.3), 72, 60),
    (lambda: elliptical_law(0.7, 0.0, Lobes()), 25, 60),
]
"""Laws, driving teeth, and how many of 60 advances over a pitch have teeth at least; all others are refused."""


@pytest.mark.long
@pytest.mark.slow
@pytest.mark.parametrize(
    ("law", "teeth", "standing"),
    [SCANNED[0], *(pytest.param(*case, marks=pytest.mark.long) for case in SCANNED[1:5]), SCANNED[5]],
)
def test_teeth_stand_or_are_refused_at_every_advance(
    law: Callable[[], Transmission], teeth: int, standing: int
) -> None:
    pitch, stood = sized_pair(law(), teeth, MODULE, None), 0
    for advance in PITCH * (np.arange(60) / 60.0 - 0.5):
        try:
            toothed_pair(pitch, ToothForm(rack(), limits=TipLimits(0.2 * MODULE)), 0.02, advance_mm=float(advance))
            stood += 1
        except NoSuchMechanism as refusal:
            assert "tooth" in refusal.problem
            assert "are needed" in refusal.problem
    assert stood >= standing
