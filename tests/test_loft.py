"""Lofted meshes and the corresponding points they go through: closed forms, slices, and faults that must be noticed."""

from __future__ import annotations

from dataclasses import replace
from math import cos, pi, sin

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st
from shapely import Polygon

from ncgear.errors import Unanswered
from ncgear.files.read_back import read_back, stl_bytes
from ncgear.numerics.arrays import Array
from ncgear.numerics.plane import signed_area
from ncgear.pitch.pair import sized_pair
from ncgear.ratio.laws.ellipse import elliptical_law
from ncgear.ratio.laws.uniform import uniform_law
from ncgear.ratio.transmission import Lobes
from ncgear.solids.helical import mesh as mesh_module
from ncgear.solids.helical import stack as stack_module
from ncgear.solids.helical.mesh import lofted
from ncgear.solids.helical.sections import PER_TOOTH, Pieces, pieces_of
from ncgear.solids.helical.stack import (
    ColumnPlaces,
    Stack,
    StrayLimits,
    close_columns,
    falls,
    middle_section,
    sagittas,
    spread_columns,
    twists,
)
from ncgear.teeth.form import TipLimits, ToothForm
from ncgear.teeth.gear import ToothedGear, toothed_pair
from ncgear.teeth.tips import Limit
from oracles import meshing
from pairs import rack

pytestmark = pytest.mark.slow

HOLE = np.array([[0.5, 0.0], [0.0, 0.5], [-0.5, 0.0], [0.0, -0.5]])


def star(turn: float = 0.0, points: int = 40) -> Array:
    """A wavy ring about the origin, counter-clockwise."""
    angle = np.linspace(0.0, 2.0 * pi, points, endpoint=False)
    radius = 3.0 + 0.6 * np.cos(5.0 * angle)
    return radius[:, None] * np.column_stack([np.cos(angle + turn), np.sin(angle + turn)])


def square(points: int = 1) -> Array:
    """A square of side 4 with ``points`` evenly spread on each side, exactly in line."""
    corners = np.array([[2.0, 2.0], [-2.0, 2.0], [-2.0, -2.0], [2.0, -2.0]])
    share = np.arange(points)[:, None] / points
    sides = [start + share * (end - start) for start, end in zip(corners, np.roll(corners, -1, axis=0), strict=True)]
    return np.concatenate(sides)


# --- lofting --------------------------------------------------------------------------------------------------------


@pytest.mark.tiers(slow=["holes1-8"], rest="long")
@pytest.mark.parametrize("points", [1, 2, 8, 64])
@pytest.mark.parametrize("holes", [[], [HOLE], [HOLE, 0.3 * HOLE + [1.3, 0.0]]])
def test_a_prism_with_points_in_line(points: int, holes: list[Array]) -> None:
    mesh = lofted(np.stack([square(points)] * 3), np.array([0.0, 1.0, 5.0]), holes)
    cut = sum(float(signed_area(hole)) for hole in holes)
    assert mesh.volume == pytest.approx(5.0 * (16.0 - cut), rel=1e-12)
    assert mesh.as_trimesh().euler_number == 2 - 2 * len(holes)
    np.testing.assert_allclose(mesh.bounds, [[-2.0, -2.0, 0.0], [2.0, 2.0, 5.0]], rtol=0.0, atol=0.0)
    assert read_back(stl_bytes(mesh.as_trimesh()), mesh).is_watertight


def test_a_twisted_prism_holds_what_its_turning_corners_leave() -> None:
    """Half way up an octagon: verticals pass at r cos(t/2), the shorter diagonals at r cos((90 deg - t)/2)."""
    radius, turn = 8.0**0.5, 0.5
    turned = square() @ np.array([[cos(turn), sin(turn)], [-sin(turn), cos(turn)]])
    mesh = lofted(np.stack([square(), turned]), np.array([0.0, 3.0]), [])
    octagon = 4.0 * radius * cos(turn / 2.0) * radius * cos(pi / 4.0 - turn / 2.0) * sin(pi / 4.0)
    assert mesh.volume == pytest.approx(3.0 * (16.0 + 4.0 * octagon + 16.0) / 6.0, rel=1e-12)


def test_the_middle_section_is_the_slice_of_the_mesh() -> None:
    lower, upper = star(), star(0.3)
    mesh = lofted(np.stack([lower, upper]), np.array([0.0, 2.0]), [])
    slice_ = Polygon(meshing.section_rings(np.asarray(mesh.vertices), np.asarray(mesh.faces), 1.0)[0])
    middle = Polygon(middle_section(lower, upper))
    assert slice_.symmetric_difference(middle).area <= 1e-12
    assert middle.symmetric_difference(Polygon((lower + upper) / 2.0)).area > 1e-3


def test_quadrilaterals_are_folded_along_the_shorter_diagonal() -> None:
    """On a round body that turns counter-clockwise with height, it is the one that falls."""
    assert falls(star(0.0, 400), star(0.02, 400)).mean() > 0.9
    assert falls(star(0.0, 400), star(-0.02, 400)).mean() < 0.1


def test_points_that_coincide_become_one() -> None:
    doubled = np.repeat(star(), 3, axis=0)
    doubled[1::3] += 1e-8
    rings = np.stack([doubled, np.repeat(star(0.2), 3, axis=0)])
    mesh = lofted(rings, np.array([0.0, 2.0]), [HOLE])
    plain = lofted(np.stack([star(), star(0.2)]), np.array([0.0, 2.0]), [HOLE])
    assert len(mesh.vertices) == len(plain.vertices)
    assert len(mesh.faces) == len(plain.faces)
    assert mesh.volume == pytest.approx(plain.volume, rel=1e-7)
    assert read_back(stl_bytes(mesh.as_trimesh()), mesh).is_watertight


def test_a_land_may_vanish_with_height() -> None:
    lower = square(4)
    upper = lower.copy()
    upper[4:9] = upper[4]
    mesh = lofted(np.stack([lower, lower, upper, lower]), np.arange(4.0), [HOLE])
    assert mesh.as_trimesh().euler_number == 0
    assert read_back(stl_bytes(mesh.as_trimesh()), mesh).is_watertight


def test_a_lost_triangle_is_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    whole = mesh_module._cap
    monkeypatch.setattr(mesh_module, "_cap", lambda *arguments: whole(*arguments)[1:])
    with pytest.raises(Unanswered, match="watertight"):
        lofted(np.stack([star(), star(0.5)]), np.array([0.0, 2.0]), [])


def test_quadrilaterals_folded_otherwise_than_their_areas_say_are_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(mesh_module, "middle_section", lambda lower, upper: (lower + upper) / 2.0)
    with pytest.raises(Unanswered, match="instead of"):
        lofted(np.stack([star(), star(0.5)]), np.array([0.0, 2.0]), [])


def test_distances_are_measured_from_both_sides() -> None:
    """A thin spike of the mesh is far from the outline, which passes close to its foot; and the other way round."""
    plain = star(0.0, 4000)
    spiked = plain.copy()
    spiked[777] *= 1.1
    columns = ColumnPlaces(np.arange(4000), np.zeros(4000))
    for ring, outline in ((spiked, plain), (plain, spiked)):
        section = Pieces(np.concatenate([outline, outline[:1]]), np.arange(4001.0), np.arange(4001.0))
        strays = Stack(np.array([0.0, 1.0]), columns, np.stack([ring, ring])).strays_mm(np.array([0]), [section])[0]
        assert strays.max() == pytest.approx(0.1 * np.linalg.norm(plain[777]), rel=0.01)
        assert abs(int(np.argmax(strays)) - 777) <= 10


# --- pieces ---------------------------------------------------------------------------------------------------------


def gear(advance_mm: float = 0.0, tolerance: float = 5e-4, teeth: int = 19) -> ToothedGear:
    pitch = sized_pair(elliptical_law(0.3, 0.5, Lobes()), teeth, 2.0, None)
    return toothed_pair(pitch, ToothForm(rack()), tolerance, advance_mm=advance_mm).driving


def test_places_are_the_ends_of_tips_and_roots() -> None:
    """Six on each tooth: the tip land's ends stand at the addendum, the root land's at the dedendum."""
    own = gear()
    pieces = pieces_of(own)
    assert pieces.count == PER_TOOTH * 19
    number = np.arange(pieces.count)
    places = pieces.at(number, np.zeros(pieces.count)).reshape(19, PER_TOOTH, 2)
    curve = Polygon(own.flanks.curve.at_length(np.linspace(0.0, own.flanks.curve.length_mm, 20_000)).position)
    height = shapely.distance(curve.exterior, shapely.points(places))
    np.testing.assert_allclose(height[:, [2, 3]], 2.0, atol=1e-4)
    np.testing.assert_allclose(height[:, [0, 5]], 2.5, atol=1e-4)
    np.testing.assert_allclose(pieces.at(number, np.ones(pieces.count))[:-1], places.reshape(-1, 2)[1:], atol=1e-9)


def test_places_move_evenly_with_the_teeth() -> None:
    """Like with like: over a hundredth of a module every place moves by about as much, on the pitch curve by it."""
    before, after = pieces_of(gear()), pieces_of(gear(0.02))
    number, share = np.arange(before.count), np.full(before.count, 0.3)
    moved = np.linalg.norm(after.at(number, share) - before.at(number, share), axis=1)
    assert moved.min() > 0.01
    assert moved.max() < 0.03


def test_shortened_teeth_have_a_tip_land_of_the_least_width() -> None:
    pitch = sized_pair(uniform_law(Lobes()), 22, 2.0, None)
    short = toothed_pair(pitch, ToothForm(rack(), limits=TipLimits(least_land_mm=1.8)), 1e-4).driving
    assert len(short.shortened(Limit.LAND)) == 22
    lands = np.diff(pieces_of(short).cut_mm)[2::PER_TOOTH]
    # The least width is along the chord, and an arc of 1.8 mm on a radius of 24 mm is 4e-4 mm longer.
    np.testing.assert_allclose(lands, 1.8, rtol=0.0, atol=5e-4)


def test_an_outline_that_is_not_its_gears_is_noticed() -> None:
    own = gear()
    with pytest.raises(Unanswered, match="away from its outline"):
        pieces_of(replace(own, outline_mm=own.outline_mm + 1e-3))


# --- columns --------------------------------------------------------------------------------------------------------

LIMITS = StrayLimits(0.003, 0.002)


def brute_sagitta(section: Pieces, columns: ColumnPlaces) -> float:
    """Largest distance of the outline from the polygon through the columns."""
    ring = columns.rings([section])[0]
    return float(shapely.distance(shapely.linearrings(ring), shapely.points(section.points_mm)).max())


def test_columns_keep_the_limits_on_every_section() -> None:
    sections = [pieces_of(gear(advance)) for advance in (0.0, 0.7, 1.4)]
    columns = close_columns(spread_columns(sections, LIMITS), sections, LIMITS)
    assert max(brute_sagitta(section, columns) for section in sections) <= LIMITS.sagitta_mm
    rings = columns.rings(sections)
    lower, upper = rings[:-1], rings[1:]
    corners = np.roll(lower, -1, axis=1), np.roll(upper, -1, axis=1)
    # Middle of the four corners against the middle of a diagonal.
    apart = (lower + upper + corners[0] + corners[1]) / 4.0 - (lower + corners[1]) / 2.0
    across = np.linalg.norm(apart, axis=2)
    assert twists(rings).max() <= LIMITS.twist_mm
    assert np.all(twists(rings) <= across.max(axis=0) + 1e-12)
    # And not many more than it takes: half as many do not keep them.
    half = ColumnPlaces(
        columns.piece[::2], np.where(np.diff(columns.piece[::2], prepend=-1) > 0, 0.0, columns.share[::2])
    )
    assert max(brute_sagitta(section, half) for section in sections) > LIMITS.sagitta_mm


def test_a_corner_within_a_piece_is_closed_in_on() -> None:
    """A piece with a right angle at a share that no even division meets."""
    points = np.array([[0.0, 0.0], [1.0 / pi, 0.0], [1.0 / pi, 1.0], [0.0, 1.0], [0.0, 0.0]])
    length = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))])
    section = Pieces(points, length, np.array([0.0, length[-1]]))
    columns = close_columns(spread_columns([section] * 2, LIMITS), [section] * 2, LIMITS)
    assert sagittas(columns, section, columns.rings([section])[0]).max() <= LIMITS.sagitta_mm
    assert brute_sagitta(section, columns) <= LIMITS.sagitta_mm


def test_limits_that_no_halving_keeps_are_a_fault(monkeypatch: pytest.MonkeyPatch) -> None:
    sections = [pieces_of(gear(advance)) for advance in (0.0, 0.5)]
    monkeypatch.setattr(stack_module, "COLUMN_HALVINGS", 2)
    with pytest.raises(Unanswered, match="strays from its chords even after 2 halvings"):
        close_columns(spread_columns(sections, LIMITS), sections, StrayLimits(1e-6, 1.0))


@given(st.lists(st.lists(st.floats(1e-3, 20.0), min_size=1, max_size=6), min_size=1, max_size=6))
@settings(max_examples=60, deadline=None)
def test_columns_stay_in_order(wanted: list[list[float]]) -> None:
    piece = np.repeat(np.arange(len(wanted)), [len(own) for own in wanted])
    share = np.concatenate([np.arange(len(own)) / len(own) for own in wanted])
    columns = ColumnPlaces(piece, share)
    flat = np.concatenate([np.array(own) for own in wanted])
    for made in (columns.spread(flat), columns.halved(flat > 1.0)):
        assert np.all((made.share >= 0.0) & (made.share < 1.0))
        assert np.all(np.diff(made.piece + made.share) > 0.0)
        first = np.nonzero(np.diff(made.piece, prepend=-1))[0]
        np.testing.assert_array_equal(made.piece[first], np.arange(len(wanted)))
        np.testing.assert_array_equal(made.share[first], 0.0)
    assert columns.spread(flat).share.size >= sum(sum(own) for own in wanted)
    assert columns.halved(flat > 1.0).share.size == share.size + np.sum(flat > 1.0)


def test_sagittas_of_a_circle() -> None:
    """A circle's sagitta between two columns is r (1 - cos(t / 2)), measured on its own fine polygon."""
    fine = 100.0 * np.column_stack([np.cos(t := np.linspace(0.0, 2.0 * pi, 3601)), np.sin(t)])
    length = np.arange(3601) * 200.0 * sin(pi / 3600)
    circle = Pieces(fine, length, np.array([0.0, length[-1]]))
    columns = ColumnPlaces(np.zeros(12, dtype=int), np.arange(12) / 12)
    np.testing.assert_allclose(
        sagittas(columns, circle, columns.rings([circle])[0]), 100.0 * (1.0 - np.cos(pi / 12)), rtol=1e-6
    )
