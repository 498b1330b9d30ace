"""Tables of gaps against the contact analysis they are made from, at other positions and by the law of gearing."""

from __future__ import annotations

from math import cos, log2, pi, radians

import numpy as np
import pytest
import shapely
from shapely.affinity import rotate, translate

from at_once import at_once
from engaged import MODULE, designed, made
from loaded import alike, gaps, uneven
from ncgear.contact.designed.as_designed import contacts_within, repeat_of
from ncgear.contact.placement import placed
from ncgear.dynamics import gaps as tables
from ncgear.dynamics.gaps import gaps_of
from ncgear.pitch.pair import PitchPair
from ncgear.teeth.gear import ToothedGear, ToothedPair

BASE = 12.0 * MODULE * cos(radians(20.0))
PAIRS = [("uniform", 24), ("sine", 31), ("baler", 25)]


@pytest.mark.parametrize(("name", "teeth"), PAIRS)
def test_at_its_positions_a_table_has_the_first_touches_of_the_analysis(name: str, teeth: int) -> None:
    contact = designed(name, teeth)
    pushing, back = gaps(name, teeth, 20).play_rad(contact.placement.phi1_rad)
    np.testing.assert_allclose(pushing, contact.pushing.error_rad, atol=1e-11)
    np.testing.assert_allclose(back, contact.back.error_rad, atol=1e-11)


@pytest.mark.parametrize(("name", "teeth"), PAIRS)
def test_between_its_positions_exact_flanks_touch_at_the_laws_angle(name: str, teeth: int) -> None:
    pushing, back = gaps(name, teeth).play_rad(np.linspace(0.0, 2.0 * pi, 20_011))
    assert np.abs(pushing).max() < 4e-6
    assert np.abs(back).max() < 4e-6


@pytest.mark.parametrize(
    ("name", "teeth", "every"),
    [("uniform", 24, 1), ("uniform 3:2", 30, 1), ("ring", 40, 40), ("sine", 32, 16), ("sine", 31, 31)],
)
def test_teeth_that_repeat_are_followed_once(
    name: str, teeth: int, every: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The tables are those of all teeth, to rounding."""
    pitch, pair = made(name, teeth)
    assert repeat_of(pair, placed(pitch, 20)) == 20 * every
    once = gaps_of(pair, pitch, uneven, 20)
    monkeypatch.setattr(tables, "repeat_of", lambda teeth, placement: placement.count)
    tables._met.cache_clear()
    whole, angles = gaps_of(pair, pitch, uneven, 20), np.linspace(0.0, once.table.breaks[-1], 5003)
    np.testing.assert_allclose(once.play_rad(angles), whole.play_rad(angles), rtol=0.0, atol=1e-12)
    for urge in (1.0, -1.0):
        touching = []
        for found in (once, whole):
            near = found.at(angles)
            ahead = np.where(near.urge == urge, urge * near.error_rad, -np.inf)
            first = ahead >= ahead.max(axis=1, keepdims=True) - 1e-5
            touching.append(np.stack([(figure * first).sum(axis=1) for figure in (near.lever_mm, near.stiffness)]))
        # Where a pair is just so far ahead, rounding decides whether it counts.
        assert np.mean(np.abs(touching[0] / touching[1] - 1.0) > 1e-9) < 1e-3
    tables._met.cache_clear()


@pytest.mark.thorough
def test_gaps_converge_with_the_positions() -> None:
    angles = np.linspace(0.0, 2.0 * pi, 5003)
    errors = [np.abs(np.stack(gaps("sine", 31, count).play_rad(angles))).max() for count in (20, 80)]
    assert log2(errors[0] / errors[1]) / 2.0 > 1.9


@at_once("number", range(4))
def test_followed_pairs_match_a_finer_table(number: int) -> None:
    """Gap, lever and both tangential speeds of every pair less than a tenth of a millimetre from touching."""
    angles = np.linspace(0.011, 6.2, 301)
    coarse, fine = (gaps("sine", 31, count).table.at(angles)[0][..., number] for count in (80, 160))
    near = gaps("sine", 31, 80).at(angles)
    urge, pairs = (gaps("sine", 31, 80), gaps("sine", 31, 160)), []
    for found in urge:
        index = found.table.place(angles)[1]
        pairs.append(found.pair[index] * found.urge[index][..., None].astype(int))
    match = (pairs[0][:, :, None] == pairs[1][:, None]).all(axis=-1) & (near.urge != 0.0)[..., None]
    row, own, other = np.nonzero(match)
    close = near.lever_mm[row, own] * np.abs(near.error_rad[row, own]) < 0.1
    assert close.sum() > 500
    scale = (1e-5, 0.05, 0.3, 0.3)[number]
    assert np.abs(coarse[row, own] - fine[row, other])[close].max() < scale


@pytest.mark.parametrize(("name", "teeth"), PAIRS)
def test_the_known_slope_is_that_of_the_touching_angle(name: str, teeth: int) -> None:
    """Away from where another corner takes over, a difference over a fine step tells the same slope."""
    found, step = gaps(name, teeth), 1e-6
    angles = found.table.breaks[:-1:7] + step
    near = found.at(angles)
    nodes = found.at(found.table.breaks[:-1:7] + 1e-12)
    change = (near.error_rad - nodes.error_rad) / step
    np.testing.assert_allclose(change[near.urge != 0.0], nodes.slopes[0][near.urge != 0.0], atol=1e-2)


@pytest.mark.slow
def test_slopes_of_corners_match_differences_of_contacts() -> None:
    """The common normal against two solved positions: the error of a corner that scrapes along a flank."""
    pitch, pair = made("sine", 31)
    placement = placed(pitch, 160)
    found = gaps_of(pair, pitch, alike, 160)
    contacts = contacts_within(pair, placement, 0.2)[0]
    first = contacts.kept(~contacts.flanks)
    order = np.lexsort((first.position, first.driven, first.driving))
    first = first.kept(order)
    joined = (np.diff(first.position) == 1) & (np.diff(first.driven) == 0) & (np.diff(first.error_rad) < 0.0)
    assert joined.sum() > 1000
    middle = first.position[:-1][joined]
    width = placement.phi1_rad[middle + 1] - placement.phi1_rad[middle]
    slope = (np.diff(first.error_rad)[joined]) / width
    teeth = np.column_stack([first.driving_tooth, first.driven_tooth])[:-1][joined]
    same = (found.pair[middle] == teeth[:, None]).all(axis=-1) & (found.urge[middle] > 0.0)
    # Where flanks touch beside the corner, they are what is followed.
    row, slot = np.nonzero(same & (found.table.coefficients[3, middle, :, 0] == first.error_rad[:-1][joined][:, None]))
    assert row.size > 300
    known = found.at(placement.phi1_rad[middle] + width / 2.0).slopes[0]
    np.testing.assert_allclose(slope[row], known[row, slot], atol=2e-3)


def test_on_circular_gears_the_lever_of_flanks_is_the_base_radius() -> None:
    near = gaps("uniform", 24).at(np.linspace(0.0, 6.0, 501))
    touching = (near.urge != 0.0) & (np.abs(near.error_rad) < 1e-13) & (np.abs(near.slopes[1]) < 1e-9)
    assert touching.sum() > 1000
    np.testing.assert_allclose(near.lever_mm[touching], BASE, rtol=1e-9)


@pytest.mark.thorough
def test_backlash_parts_the_backs_by_its_angle() -> None:
    """Backlash is measured along the normal: on a base circle of radius r it leaves j / r of play."""
    pushing, back = gaps("uniform", 24, backlash_mm=0.1).play_rad(np.linspace(0.0, 6.0, 501))
    np.testing.assert_allclose(back - pushing, 0.1 / BASE, atol=1e-6)


def test_driven_gears_pressed_beyond_the_tables_are_found() -> None:
    angles = np.linspace(0.0, 6.0, 101)
    found = gaps("uniform", 24)
    assert found.too_deep(angles, np.full_like(angles, -1e-3)) is None
    deepest = found.too_deep(angles, np.where(angles > 3.0, -0.2, 0.0))
    assert deepest is not None
    assert deepest[0] > 3.0
    assert deepest[1] == pytest.approx(0.2, abs=1e-9)


@pytest.mark.thorough
def test_levers_are_positive() -> None:
    for name, teeth in PAIRS:
        near = gaps(name, teeth).at(np.linspace(0.0, 2.0 * pi, 20_011))
        assert near.lever_mm[near.urge != 0.0].min() > 0.0


# One tooth of each gear as polygons: nothing of the contact analysis is used


def tooth(gear: ToothedGear, number: int) -> shapely.Polygon:
    """A tooth with the body below it, from the middle of one space to the middle of the next."""
    flanks = gear.flanks
    crossing, pitch = flanks.crossing_mm, flanks.rack.pitch_mm
    middle = (crossing[2 * number - 2] + crossing[2 * number - 1]) / 2.0
    edges = flanks.curve.at_length(middle + np.array([-0.5, -0.25, 0.0, 0.25, 0.5]) * pitch).position
    return shapely.Polygon(gear.outline_mm).intersection(shapely.Polygon([(0.0, 0.0), *(2.0 * edges)]))


def touching_rad(pair: ToothedPair, pitch: PitchPair, teeth: tuple[int, int], phi1: float) -> float:
    """Driven angle beyond the law's at which two teeth stop overlapping, by bisection."""
    own, other = tooth(pair.driving, teeth[0]), tooth(pair.driven, teeth[1])
    driving = rotate(own, phi1, origin=(0.0, 0.0), use_radians=True)
    law = float(pitch.transmission.driven_angle(np.array([phi1])).value[0])
    low, high = -0.06, 0.03
    for _ in range(24):
        ahead = (low + high) / 2.0
        driven = rotate(other, pitch.mesh.sense * (law + ahead), origin=(0.0, 0.0), use_radians=True)
        overlap = driving.intersects(translate(driven, pitch.center_distance_mm))
        low, high = (ahead, high) if overlap else (low, ahead)
    return high


@pytest.mark.slow
@pytest.mark.parametrize(("name", "teeth"), [("uniform", 24), ("sine", 31)])
def test_gaps_are_those_of_single_teeth_as_polygons(name: str, teeth: int) -> None:
    """Pairs that touch and pairs that are about to, or have just parted, up to a third of a millimetre away."""
    tolerance = 1e-3
    pitch, pair = made(name, teeth, tolerance)
    found = gaps(name, teeth)
    checked = []
    for phi1 in np.linspace(0.2, 5.9, 12):
        near = found.at(phi1)
        index = found.table.place(phi1)[1]
        gap = near.lever_mm * np.abs(near.error_rad)
        for slot in np.nonzero((near.urge > 0.0) & (gap < 0.35))[0]:
            polygons = touching_rad(pair, pitch, tuple(found.pair[index, slot]), phi1)
            checked.append((gap[slot], (polygons - near.error_rad[slot]) * near.lever_mm[slot]))
    gap, missed = np.array(checked).T
    assert np.sum(gap > 0.02) >= 5
    assert np.abs(missed).max() < 3.0 * tolerance
