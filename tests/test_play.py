"""Play of two outlines: shapely's judgement of good, rough and overlapping ones, closed forms, parts of the search."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from math import cos, pi, radians, sin

import numpy as np
import pytest
import shapely
from shapely import Polygon

from at_once import at_once
from engaged import MODULE, TOLERANCE, least_driven_radius, made
from ncgear.contact.placement import Placement, placed, placed_at
from ncgear.contact.written.as_written import BEYOND, reach_mm
from ncgear.contact.written.play import WrittenPlay, facing_outlines, outline_play
from ncgear.contact.written.polar import NO_RUN, polar_outline, radial_runs
from ncgear.pitch.shape import Mesh
from oracles import meshing

ALPHA = radians(20.0)
REACH = BEYOND * 1.25 * MODULE / sin(ALPHA)

Array = np.ndarray


def play(
    name: str, teeth: int, ahead_rad: float = 0.0, apart_mm: float = 0.0, **kinds: float
) -> tuple[WrittenPlay, Placement]:
    """Play of a pair's outlines with the driven gear turned on, or the centre distance enlarged."""
    pitch, pair = made(name, teeth, **kinds)
    at = placed(pitch)
    at = replace(at, phi2_rad=at.phi2_rad + ahead_rad, center_distance_mm=at.center_distance_mm + apart_mm)
    facing = facing_outlines(pair.driving.outline_mm, pair.driven.outline_mm, at)
    return outline_play(facing, at, reach_mm(pitch, pair)), at


def judged(driving: Array, driven: Array, at: Placement) -> meshing.Pair:
    return meshing.Pair(Polygon(driving), Polygon(driven), at.phi1_rad, at.phi2_rad, at.center_distance_mm)


# --- against plain search --------------------------------------------------------------------------------------------


def plain_play(driving: Array, driven: Array, at: Placement, row: int) -> tuple[float, float]:
    """Play up and down by looking at every vertex and every chord of both outlines, shapely telling inside from out."""
    turn = np.exp(1j * (at.phi1_rad[row] - at.mesh.sense * at.phi2_rad[row]))
    axis = at.center_distance_mm * np.exp(-1j * at.mesh.sense * at.phi2_rad[row])
    placed_driving, own = (driving @ [1, 1j]) * turn - axis, driven @ [1, 1j]
    up, down = plain_freedom(placed_driving, own, ring=at.mesh is Mesh.INTERNAL)
    other_up, other_down = plain_freedom(own, placed_driving, ring=False)
    return min(up, other_down), min(down, other_up)


def plain_freedom(points: Array, outline: Array, *, ring: bool) -> tuple[float, float]:
    """How far the first of the points can turn about the origin until they meet the outline's inside, or come out."""
    polygon = Polygon(np.column_stack([outline.real, outline.imag]))
    inside = shapely.contains_xy(polygon, points.real, points.imag) != ring
    start, step = outline, np.roll(outline, -1) - outline
    up, down = [], []
    for point, within in zip(points, inside, strict=True):
        along, length = (start.conj() * step).real, np.abs(step) ** 2
        root = along**2 - length * (np.abs(start) ** 2 - np.abs(point) ** 2)
        shares = (-along + np.outer([1.0, -1.0], np.sqrt(np.maximum(root, 0.0)))) / length
        hit = (root > 0.0) & (shares >= 0.0) & (shares < 1.0)
        angles = np.angle((start + shares * step) / point)[hit]
        above, below = angles[angles >= 0.0].min(initial=9.0), -angles[angles < 0.0].max(initial=-9.0)
        if not within:
            up.append(above)
            down.append(below)
        elif above < below:
            down.append(-above)
        else:
            up.append(-below)
    return min(up), min(down)


@pytest.mark.tiers(slow=["0.0-long ellipse-40-0.02-0.3"], rest="long")
@pytest.mark.parametrize(
    ("name", "teeth", "tolerance", "backlash"),
    [("uniform", 8, 0.005, 0.0), ("sine", 25, 0.02, 0.0), ("baler", 24, 0.005, 0.1), ("baler", 86, 0.02, 0.0),
     ("long ellipse", 40, 0.02, 0.3), ("ellipse", 25, 10.0, 0.0), ("ring 1:2", 30, 0.01, 0.0), ("ring", 40, 0.01, 0.2)],
)  # fmt: skip
@pytest.mark.parametrize(
    "ahead_rad", [0.003, pytest.param(0.0, marks=pytest.mark.slow), pytest.param(-0.003, marks=pytest.mark.slow)]
)
def test_play_is_what_a_plain_search_finds(
    name: str, teeth: int, tolerance: float, backlash: float, ahead_rad: float
) -> None:
    found, at = play(name, teeth, ahead_rad, tolerance=tolerance, backlash_mm=backlash)
    _, pair = made(name, teeth, tolerance, backlash)
    outlines = pair.driving.outline_mm, pair.driven.outline_mm
    for row in range(0, at.count, at.count // 12 + 1):
        expected = plain_play(*outlines, at, row)
        assert (found.up_rad[row], found.down_rad[row]) == pytest.approx(expected, abs=1e-12)


@pytest.mark.tiers(slow=["0", "2", "3", "5"], rest="long")
@pytest.mark.parametrize("seed", range(6))
def test_play_of_rough_outlines_is_what_a_plain_search_finds(seed: int) -> None:
    """Teeth that no tool would leave: every vertex moved at random."""
    pitch, pair = made("sine", 12, 0.05, 0.4)
    noise = np.random.default_rng(seed)
    rough = [
        gear.outline_mm + noise.uniform(-0.05, 0.05, gear.outline_mm.shape) for gear in (pair.driving, pair.driven)
    ]
    assert all(Polygon(outline).is_valid for outline in rough)
    at = placed(pitch)
    found = outline_play(facing_outlines(*rough, at), at, REACH)
    for row in range(seed, at.count, 17):
        assert (found.up_rad[row], found.down_rad[row]) == pytest.approx(plain_play(*rough, at, row), abs=1e-12)


@pytest.mark.parametrize("tolerance", [0.05, 0.4])
def test_play_of_coarse_outlines_at_a_few_positions_is_what_a_plain_search_finds(tolerance: float) -> None:
    """Chords longer than vertices are followed, every vertex moved at random."""
    pitch, pair = made("sine", 12, tolerance, 0.4)
    noise = np.random.default_rng(1)
    rough = [
        gear.outline_mm + noise.uniform(-0.05, 0.05, gear.outline_mm.shape) for gear in (pair.driving, pair.driven)
    ]
    even = placed(pitch)
    at = placed_at(pitch, even, even.rolled_mm[[3, 40, 77, 114, 151, 188]] + 0.3)
    found = outline_play(facing_outlines(*rough, at), at, REACH)
    for row in range(at.count):
        assert (found.up_rad[row], found.down_rad[row]) == pytest.approx(plain_play(*rough, at, row), abs=1e-12)


# --- against shapely -------------------------------------------------------------------------------------------------


@pytest.mark.judges("contact")
@pytest.mark.tiers(quick=["0.0005-sine"], rest="slow")
@pytest.mark.parametrize("name", ["uniform", "ellipse", "sine", "baler"])
@pytest.mark.parametrize("ahead_rad", [0.0, 0.0005])
def test_play_is_what_shapely_finds(name: str, ahead_rad: float) -> None:
    found, at = play(name, 25, ahead_rad, backlash_mm=0.05)
    _, pair = made(name, 25, backlash_mm=0.05)
    judge = judged(pair.driving.outline_mm, pair.driven.outline_mm, at)
    for row in (0, 37, 150, 251, 433):
        # The judge allows 1e-7 mm of overlap, 1e-8 rad at the smallest base radius with the bisection's 1e-9.
        assert (found.down_rad[row], found.up_rad[row]) == pytest.approx(judge.driven_play(row, 1e-7), abs=2e-8)


@pytest.mark.thorough
@pytest.mark.parametrize("name", ["sine", "baler"])
def test_overlap_is_as_deep_as_shapely_finds(name: str) -> None:
    """An overlap of both sides of a tooth: the judge's depth is the widest circle in it, good to 6 %."""
    found, at = play(name, 25, 0.002)
    _, pair = made(name, 25)
    judge = judged(pair.driving.outline_mm, pair.driven.outline_mm, at)
    for row in (0, 101, 333):
        _, depth = judge.overlap(float(at.phi1_rad[row]), float(at.phi2_rad[row]))
        # Slivers between chords: the deepest vertex is off by what their chords are, the tolerance for each.
        assert found.overlap_mm[row] == pytest.approx(depth, rel=0.06, abs=2.0 * TOLERANCE)
        assert depth > 0.02


@pytest.mark.tiers(thorough=["*-sine"], rest="slow")
@pytest.mark.parametrize("name", ["uniform", "sine", "baler"])
@pytest.mark.parametrize("ahead_rad", [0.01, -0.01])
def test_driven_gear_turned_too_far_overlaps(name: str, ahead_rad: float) -> None:
    free, (forced, at) = play(name, 25)[0], play(name, 25, ahead_rad)
    pressed, before = (forced.up_rad, free.up_rad) if ahead_rad > 0 else (forced.down_rad, free.down_rad)
    assert pressed.max() < 0.0
    # The play that is missing is the angle turned, and the depth across the flanks no more than that at the tip.
    assert np.median(before - pressed) == pytest.approx(0.01, rel=1e-6)
    radius = at.center_distance_mm - at.driving_radius_mm.min() + MODULE
    assert forced.overlap_mm.min() > 0.0
    assert 0.2 * 0.01 * radius < forced.overlap_mm.max() < 0.01 * radius


@pytest.mark.slow
@at_once("name", ["uniform", "ellipse", "sine", "baler"])
def test_centre_distance_too_small_overlaps(name: str) -> None:
    near, free = play(name, 25, apart_mm=-0.1)[0], play(name, 25)[0]
    # A tenth nearer costs each flank 0.1 sin(alpha) along its normal, less what the chords leave free.
    assert near.overlap_mm.min() > 0.0
    assert near.overlap_mm.max() > 5.0 * max(free.overlap_mm.max(), 1e-4)
    assert (near.up_rad + near.down_rad).max() < 0.0


@pytest.mark.slow
def test_play_of_a_nearer_circular_pair_is_the_closed_form() -> None:
    """2 (r1 + r2) (inv(work) - inv(alpha)) / r2 at the working pressure angle of the other centre distance."""
    for apart in (-0.05, 0.05, 0.2):
        found, _ = play("uniform", 25, apart_mm=apart, tolerance=2e-4)
        work = np.arccos(50.0 * cos(ALPHA) / (50.0 + apart))
        expected = 2.0 * 50.0 * ((np.tan(work) - work) - (np.tan(ALPHA) - ALPHA)) / 25.0
        # Both outlines leave up to the tolerance free on either side: 4 x 2e-4 mm at the base radius.
        assert np.abs(found.up_rad + found.down_rad - expected).max() < 4 * 2e-4 / (25.0 * cos(ALPHA))


@pytest.mark.tiers(thorough=["0.02"], rest="slow")
@pytest.mark.parametrize("backlash", [0.02, 0.1, 0.2])
def test_play_of_a_circular_pair_is_its_backlash_angle(backlash: float) -> None:
    """jn / (r2 cos(alpha)), all of it on the idle flanks: the driven gear can turn on, not back."""
    base, tolerance = 48.0 * cos(ALPHA), 2e-4
    found, _ = play("uniform 1:2", 24, tolerance=tolerance, backlash_mm=backlash)
    for way, room in ((found.up_rad, backlash), (found.down_rad, 0.0)):
        assert way.min() >= room / base - 1e-12  # chords only ever leave more room
        assert way.max() <= (room + 2.0 * tolerance) / base


@pytest.mark.slow
def test_very_fine_outlines_touch_where_the_law_says() -> None:
    found, at = play("sine", 25, tolerance=2e-5)
    assert np.abs(found.down_rad).max() <= 2.0 * 2e-5 / (least_driven_radius(at) * cos(radians(40.0)))


def test_gears_out_of_reach_have_no_play() -> None:
    found, _ = play("uniform", 25, apart_mm=3.0 * MODULE)
    assert np.isinf(found.up_rad).all()
    assert np.isinf(found.down_rad).all()
    assert found.overlap_mm.max() == 0.0


# --- the parts of the search -----------------------------------------------------------------------------------------


@cache
def jagged(seed: int, count: int = 60) -> Array:
    """A polygon around the origin whose radius and polar angle both run to and fro."""
    noise = np.random.default_rng(seed)
    angle = np.linspace(0.0, 2.0 * pi, count, endpoint=False) + noise.uniform(-0.15, 0.15, count)
    ring: Array = noise.uniform(8.0, 12.0, count) * np.exp(1j * angle)
    return ring


@at_once("seed", range(5))
def test_runs_are_the_outline_cut_where_its_radius_turns(seed: int) -> None:
    ring = jagged(seed)
    runs = radial_runs(ring, 1.0, 1.0)
    for first, last in zip(runs.first, runs.last, strict=True):
        assert np.all(np.diff(runs.square[first : last + 1]) > 0.0)
    # Every circle crosses the outline as often as it crosses runs, by the outline's own chords sampled densely.
    dense = np.abs(ring[:, None] + (np.roll(ring, -1) - ring)[:, None] * np.linspace(0.0, 1.0, 2000, endpoint=False))
    for radius in np.linspace(8.05, 11.9, 23):
        crossed = np.count_nonzero(np.diff(np.sign(dense.ravel() - radius), append=np.sign(dense[0, 0] - radius)))
        assert np.count_nonzero((runs.inner[:-1] < radius**2) & (radius**2 < runs.outer[:-1])) == crossed


@at_once("seed", range(5))
def test_entries_and_near_runs_are_what_a_plain_search_finds(seed: int) -> None:
    ring, reach = jagged(seed), 1.5
    runs = radial_runs(ring, reach, 4.0)
    for run in range(runs.first.size):
        own = runs.square[runs.first[run] : runs.last[run] + 1]
        for squared in (60.0, 81.0, 100.0, 143.0, 200.0):
            found = runs.entry_beyond(np.array([run]), np.array([squared]))[0]
            assert found == runs.first[run] + np.searchsorted(own, squared)
    for point in 10.0 * np.exp(1j * np.linspace(-pi, pi, 77)):
        near = set(runs.near[runs.sector(np.angle(np.array([point])))[0]].tolist()) - {NO_RUN}
        for run in range(runs.first.size):
            entries = runs.point[runs.first[run] : runs.last[run] + 1]
            if np.any(np.abs(np.angle(entries / point)) * np.abs(runs.point[runs.first[run]]) < reach):
                assert run in near


@at_once("seed", range(5))
def test_windows_hold_every_vertex_of_their_sector(seed: int) -> None:
    ring = jagged(seed)
    directions = np.linspace(-7.0, 7.0, 41)
    first, count = polar_outline(ring).windows(directions, np.full(41, 0.3))
    for direction, start, size in zip(directions, first, count, strict=True):
        inside = np.nonzero(np.abs(np.angle(ring * np.exp(-1j * direction))) <= 0.3)[0]
        window = np.arange(start, start + size) % ring.size
        assert set(inside) <= set(window)
        assert size < ring.size / 2
    assert polar_outline(ring).windows(np.zeros(1), np.full(1, pi))[1] == ring.size
