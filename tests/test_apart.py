"""Outlines that stand apart: shapely tells whether they do, plain search which chords are near a place."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from math import pi

import numpy as np
import pytest
import shapely
from shapely import Polygon

import ncgear.contact.written.apart as search
from at_once import at_once
from engaged import made
from ncgear.contact.placement import Placement, placed
from ncgear.contact.written.apart import REACHES_IN_PITCHES, Apart, Facing, apart_play
from ncgear.contact.written.as_written import reach_mm
from ncgear.contact.written.cells import cells_near, chords_of
from ncgear.pitch.shape import Mesh
from test_play import jagged

Array = np.ndarray

# --- positions in which outlines stand apart -------------------------------------------------------------------------


@cache
def apart(
    name: str, teeth: int, tolerance: float, ahead_rad: float, noise_mm: float = 0.0
) -> tuple[Apart, Array, Array, Placement]:
    """What is known of a pair with the driven gear turned on, its vertices moved at random; and its outlines."""
    pitch, pair = made(name, teeth, tolerance, 0.05)
    noise = np.random.default_rng(teeth)
    driving, driven = (
        (gear.outline_mm + noise.uniform(-noise_mm, noise_mm, gear.outline_mm.shape)) @ np.array([1.0, 1j])
        for gear in (pair.driving, pair.driven)
    )
    at = placed(pitch)
    at = replace(at, phi2_rad=at.phi2_rad + ahead_rad)
    left = driven[::-1] if at.driven_inside else driven
    return apart_play(Facing(driving, left, at.pitch_mm), at, reach_mm(pitch, pair)), driving, driven, at


def overlap_mm2(driving: Array, driven: Array, at: Placement, row: int, turned_rad: float = 0.0) -> float:
    """Area of the driving gear inside the driven one, the driving gear turned about the driven axis, by shapely."""
    turn = np.exp(1j * (at.phi1_rad[row] - at.mesh.sense * at.phi2_rad[row]))
    axis = at.center_distance_mm * np.exp(-1j * at.mesh.sense * at.phi2_rad[row])
    moved = (driving * turn - axis) * np.exp(1j * turned_rad)
    one, other = (Polygon(np.column_stack([outline.real, outline.imag])) for outline in (moved, driven))
    return float((one.difference(other) if at.mesh is Mesh.INTERNAL else one.intersection(other)).area)


KINDS = [("sine", 25, 0.005), ("baler", 24, 0.02), ("ring 1:2", 30, 0.01), ("long ellipse", 40, 0.02)]


@pytest.mark.judges("contact")
@pytest.mark.tiers(
    quick=["*-sine-*"],
    slow=[
        "0.0-0.0-ring 1:2-30-0.01",
        "0.0011-0.0-baler-24-0.02",
        "0.0001-0.01-baler-24-0.02",
        "0.0001-0.01-long ellipse-40-0.02",
        "-0.003-0.0-ring 1:2-30-0.01",
    ],
    rest="long",
)
@pytest.mark.parametrize(("name", "teeth", "tolerance"), KINDS)
@pytest.mark.parametrize(("ahead_rad", "noise_mm"), [(0.0, 0.0), (0.0011, 0.0), (1e-4, 0.01), (-0.003, 0.0)])
def test_outlines_that_are_known_to_stand_apart_do(
    name: str, teeth: int, tolerance: float, ahead_rad: float, noise_mm: float
) -> None:
    found, driving, driven, at = apart(name, teeth, tolerance, ahead_rad, noise_mm)
    for row in range(0, at.count, at.count // 40 + 1):
        overlap = overlap_mm2(driving, driven, at, row)
        assert overlap == 0.0 or not found.known[row]
        # Nothing is left out whose play is small enough; with the backlash it is.
        assert overlap > 0.0 or found.known[row] or np.isinf(found.up_rad[row])


@pytest.mark.tiers(quick=["sine-*"], rest="slow")
@pytest.mark.parametrize(("name", "teeth", "tolerance"), KINDS)
def test_play_of_outlines_apart_is_where_shapely_sees_them_touch(name: str, teeth: int, tolerance: float) -> None:
    found, driving, driven, at = apart(name, teeth, tolerance, 0.0)
    assert np.count_nonzero(found.known) > 0.9 * at.count
    for row in np.nonzero(found.known)[0][:: at.count // 12]:
        for way in (found.up_rad[row], -found.down_rad[row]):
            assert overlap_mm2(driving, driven, at, row, way - np.sign(way) * 1e-9) == 0.0
            assert overlap_mm2(driving, driven, at, row, way + np.sign(way) * 1e-6) > 0.0


@pytest.mark.parametrize("ahead_rad", [0.0, 0.02])
def test_play_is_known_no_farther_than_vertices_are_followed(ahead_rad: float) -> None:
    found, _, driven, at = apart("sine", 25, 0.005, ahead_rad)
    reach = max(REACHES_IN_PITCHES) * at.pitch_mm / np.abs(driven).max()
    assert np.isinf(found.up_rad[~found.known]).all()
    assert np.isinf(found.down_rad[~found.known]).all()
    for way in (found.up_rad, found.down_rad):
        assert np.all((way[found.known] > 0.0) & (way[found.known] <= reach))
    assert found.known.all() == (ahead_rad == 0.0)


def test_a_gear_wholly_inside_the_other_does_not_stand_apart() -> None:
    """A round driving gear within a bar that is the driven one: nothing crosses, and both its sides are near."""
    around = np.exp(2j * pi * np.arange(40) / 40)
    bar = np.array([-20 - 1j, 20 - 1j, 20 + 1j, -20 + 1j])
    zero, one = np.zeros(1), np.ones(1)
    at = Placement(Mesh.EXTERNAL, 15.0, 1, 1, 1.5, 20, zero, zero, zero, one)
    assert not apart_play(Facing(0.5 * around, bar, at.pitch_mm), at, 40.0).known.any()
    # Beside the bar it does, between two prongs.
    fork = np.array([-20 - 3j, 20 - 3j, 20 + 3j, -20 + 3j, -20 + 2j, -10 + 1j, -10 - 1j, -20 - 2j])
    found = apart_play(Facing(0.9 * around, fork, at.pitch_mm), at, 40.0)
    assert found.known.all()
    assert found.up_rad == pytest.approx(found.down_rad, abs=1e-12)


@at_once(("own", "other"), [(10.0, 12.0), (14.0, 12.0), (2.0, 17.0), (3.0, 12.0)])
def test_nothing_is_met_beyond_the_lens_of_two_discs(own: float, other: float) -> None:
    """Points of a disc 16 mm from the axis of another one: the farthest angle at which they are in it, by a grid."""
    around = np.exp(2j * pi * np.arange(20_000) / 20_000)
    radius, angle = np.linspace(own / 400.0, own, 400)[:, None], np.linspace(0.0, pi, 2000)
    inside = np.abs(radius * np.exp(1j * angle) - 16.0) <= other
    found = Facing(own * around, other * around, 1.0).meeting_rad(16.0)
    expected = float(angle[inside.any(axis=0)].max(initial=0.0))
    assert expected - 1e-9 <= found <= expected + 0.01 + 0.1 * (own + other < 16.0)


@pytest.mark.tiers(slow=["ring 1:2-30-0.01"], rest="long")
@pytest.mark.parametrize(("name", "teeth", "tolerance"), [*KINDS, ("uniform", 120, 0.03)])
def test_pairs_of_a_stretch_are_all_that_come_near_in_any_of_its_positions(
    name: str, teeth: int, tolerance: float
) -> None:
    _, driving, driven, at = apart(name, teeth, tolerance, 0.0)
    pitch = at.pitch_mm
    facing = Facing(driving, driven[::-1] if at.driven_inside else driven, pitch)
    chords, once = facing.chords, facing.once
    stretches = search._stretches(facing, at, 1.2 * pitch)
    cells = facing.cells(0.02 * pitch)
    setting = search._Setting(at, stretches, chords, facing.twice, search._windows(chords, stretches.width))
    rows = np.arange(0, stretches.first.size, stretches.first.size // 3)
    pairs = search._near_pairs(setting, cells, rows, 0.02 * pitch)
    others = segments(once.start, once.start + once.direction * once.length_mm)
    for number, row in enumerate(rows):
        looked_at = (stretches.first[row] + np.arange(stretches.width)) % chords.start.size
        of_row = pairs.row == number
        found = set(zip(pairs.driving.start[of_row].tolist(), pairs.driven.start[of_row].tolist(), strict=True))
        for position in stretches.position[row]:
            start = at.driving_points(chords.start[looked_at], position)
            end = start + at.driving_directions(chords.direction[looked_at], position) * chords.length_mm[looked_at]
            close = shapely.distance(segments(start, end)[:, None], others) <= 0.02 * pitch
            for own, other in np.argwhere(close):
                assert (chords.start[looked_at[own]], once.start[other]) in found


def segments(start: Array, end: Array) -> Array:
    """Straight lines from points to points."""
    return shapely.linestrings(np.stack([start, end], axis=-1).view(float).reshape(-1, 2, 2))


# --- chords and cells ------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("longest", [np.inf, 1.0, 0.1])
def test_chords_follow_the_outline_in_pieces_no_longer_than_wanted(longest: float) -> None:
    ring = jagged(0)
    chords = chords_of(ring, longest)
    ends = chords.start + chords.direction * chords.length_mm
    assert chords.length_mm.max() <= longest * (1.0 + 1e-12)
    assert np.roll(chords.start, -1) == pytest.approx(ends, abs=1e-12)
    assert set(ring) <= set(chords.start)
    assert chords.length_mm.sum() == pytest.approx(np.abs(np.diff(ring, append=ring[0])).sum(), rel=1e-12)


@at_once("seed", range(5))
@at_once(("near", "cell"), [(0.3, 0.4), (1.0, 0.2), (0.05, 1.0)])
def test_cells_name_all_chords_that_are_near(seed: int, near: float, cell: float) -> None:
    ring = jagged(seed) if seed % 2 else jagged(seed)[::-1]
    chords = chords_of(ring, np.inf)
    cells = cells_near(chords, near, cell)
    noise = np.random.default_rng(seed)
    places = noise.uniform(-14.0, 14.0, 400) + 1j * noise.uniform(-14.0, 14.0, 400)
    lines = segments(ring, np.roll(ring, -1))
    named = 0
    for place, number in zip(places, cells.cell(places), strict=True):
        chord = set((np.arange(cells.first[number], cells.beyond[number]) % ring.size).tolist())
        within = np.nonzero(shapely.distance(shapely.Point(place.real, place.imag), lines) <= near)[0]
        assert set(within.tolist()) <= chord
        assert len(chord) < ring.size / 2
        named += bool(chord)
    assert 0 < named < 400
