"""Runs of outlines, heels, meshes of one tooth and inverted laws that no test had judged by themselves."""

from __future__ import annotations

from itertools import pairwise
from math import ceil, cos, pi, sin
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
import shapely

import ncgear.teeth.toothed_arc as toothed_arc
from at_once import at_once
from ncgear.contact.written.as_written import BEYOND_TEETH, _along_normals
from ncgear.contact.written.polar import NO_RUN, SECTORS_PER_PITCH, radial_runs
from ncgear.errors import NoSuchMechanism
from ncgear.pitch.shape import Gear
from ncgear.project.opened import _off
from ncgear.ratio.laws.expression import ratio_expression_law
from ncgear.ratio.transmission import Lobes
from ncgear.solids.helical.even_tips import HIGH, RISE, STANDS_OUT, _low_sides
from ncgear.solids.plan.room import INNER_WALL_IN_MODULES, USEFUL_MM, _hole_on_ray
from ncgear.strength.elements.mesh import MeshSize, topology_of
from ncgear.teeth.spaces import _widths
from ncgear.trains.planetary import _inverse

Made: Any = SimpleNamespace


# --- contact


@pytest.mark.judges("contact")
@at_once("sense", [1.0, -1.0])
def test_normals_of_a_circle_meet_a_hexagon_where_its_sides_are(sense: float) -> None:
    """From 30 mm along the radius to a side with the apothem a: a / cos(angle from its middle) - 30."""
    apothem = 32.0 if sense > 0.0 else 24.0
    hexagon = apothem / cos(pi / 6.0) * np.exp(1j * pi * np.arange(6) / 3.0)

    def at_length(sigma: Any) -> Any:
        around = np.stack([np.cos(sigma / 30.0), np.sin(sigma / 30.0)], axis=-1)
        return Made(position=30.0 * around, normal=around)

    flanks: Any = Made(
        curve=Made(at_length=at_length), tip_height_mm=np.array([5.0, 1.0]), root_depth_mm=np.array([2.0, 6.0])
    )
    away = _along_normals(np.stack([hexagon.real, hexagon.imag], axis=1), flanks, sense)
    sigma = np.linspace(0.0, 60.0 * pi, 41)[:-1] + 0.1
    aside = np.mod(sigma / 30.0, pi / 3.0) - pi / 6.0
    assert away(sigma) == pytest.approx(np.abs(apothem / np.cos(aside) - 30.0), abs=1e-9)
    assert BEYOND_TEETH * 6.0 > 30.0 - 24.0
    # A side behind is not met.
    assert np.all(np.isinf(_along_normals(np.stack([hexagon.real, hexagon.imag], axis=1), flanks, -sense)(sigma)))


@pytest.mark.judges("contact")
@at_once("reach_mm", [0.1, 3.0])
def test_runs_are_named_in_all_sectors_that_they_come_near(reach_mm: float) -> None:
    """Of a wave of 12 teeth around 40 mm, whose flanks lean: each entry is found within its reach to both sides."""
    turn = np.linspace(0.0, 2.0 * pi, 601)[:-1]
    outline = (40.0 + 3.0 * np.cos(12.0 * turn)) * np.exp(1j * (turn + 0.04 * np.sin(12.0 * turn)))
    runs = radial_runs(outline, reach_mm, 20.0)
    assert runs.first.size == 24
    sectors = len(runs.near)
    assert sectors == ceil(SECTORS_PER_PITCH * 2.0 * pi * np.abs(outline).max() / 20.0)
    named = [set(row[row != NO_RUN].tolist()) for row in runs.near]
    for run, (first, last) in enumerate(zip(runs.first, runs.last, strict=True)):
        margin, polar = reach_mm / abs(runs.point[first]), np.angle(runs.point[first : last + 1])
        for angle in (polar - 0.999 * margin, polar, polar + 0.999 * margin):
            assert all(run in named[place] for place in runs.sector(np.angle(np.exp(1j * angle))))
        # No sector beyond, but the sectors in which both ends lie.
        whole = np.unwrap(polar)
        middle, half = (whole.min() + whole.max()) / 2.0, np.ptp(whole) / 2.0 + margin
        apart = np.abs(np.angle(np.exp(1j * ((np.arange(sectors) + 0.5) * 2.0 * pi / sectors - middle))))
        for place in np.flatnonzero(apart > half + pi / sectors + 1e-6):
            assert run not in named[place]
        assert sum(run in row for row in named) >= 2.0 * half * sectors / (2.0 * pi) - 1e-6


# --- teeth


def heel(monkeypatch: pytest.MonkeyPatch, gear: Gear, beyond: list[float]) -> tuple[Any, complex, complex, float]:
    """The heel between root lands that end 20 mm and begin 22 mm from the axis, 2.28 rad apart."""
    left, way = 2.0 * pi - 4.0, -1.0 if gear is Gear.DRIVING else 1.0
    end, start = 20.0 * np.exp(0.3j), 22.0 * np.exp(1j * (0.3 + way * left))
    monkeypatch.setattr(toothed_arc, "_covered_rad", lambda *given: 4.0)
    monkeypatch.setattr(toothed_arc, "_beyond_mm", lambda *given: beyond)

    def land(place: complex) -> Any:
        return Made(at=lambda row, share: (np.array([[place.real, place.imag]]), None), rank=np.array([7.0]))

    flanks: Any = Made(curve=Made(gear=gear, length_mm=150.0), rack=Made(module_mm=2.0))
    return toothed_arc._heel(flanks, land(end), land(start)), end, start, way


@pytest.mark.judges("teeth")
@pytest.mark.parametrize("gear", list(Gear))
@pytest.mark.parametrize("lowest", [15.0, 19.8, 21.9])
def test_a_heel_leads_round_the_axis_without_a_corner(
    monkeypatch: pytest.MonkeyPatch, gear: Gear, lowest: float
) -> None:
    """Walls towards the axis, corners with the rounding of a module, an arc; slopes are those of the points."""
    made, end, start, way = heel(monkeypatch, gear, [lowest, 23.0])
    rows, share = made.owner.tolist(), np.linspace(0.0, 1.0, 201)
    points, slopes = [], []
    for row in rows:
        point, slope = (values @ [1.0, 1.0j] for values in made.curve(np.full(201, row), share))
        assert np.gradient(point, share, edge_order=2)[1:-1] == pytest.approx(slope[1:-1], rel=2e-3)
        points.append(point)
        slopes.append(slope / np.abs(slope))
    assert (points[0][0], points[-1][-1]) == (pytest.approx(end), pytest.approx(start))
    # Where the arc's radius changes, by 0.2 mm over 2.28 rad, it meets its corners a little askew.
    askew = 0.2 / 2.2 / 19.8 if lowest == 19.8 else 1e-6
    for (one, other), (before, after) in zip(pairwise(points), pairwise(slopes), strict=True):
        assert one[-1] == pytest.approx(other[0])
        assert abs(before[-1] - after[0]) <= askew
    low = min(20.0, lowest)
    assert rows == {15.0: [0, 1, 2, 3, 4], 19.8: [2, 3, 4], 21.9: [2, 3, 4]}[lowest]
    wall = points[-1]
    assert np.ptp(np.angle(wall)) == pytest.approx(0.0, abs=1e-12)
    corner = points[-2]
    rounding = min(2.0, (22.0 - low) / 2.0)
    turned = np.diff(np.unwrap(np.angle(slopes[-2])))
    assert np.abs(np.diff(corner)).sum() / np.abs(turned).sum() == pytest.approx(rounding, rel=1e-3)
    assert np.all(np.sign(turned) == -way)
    arc = points[rows.index(2)]
    ends = (20.0, low) if lowest > 19.0 else (low, low)
    assert np.abs(arc[[0, -1]]) == pytest.approx(ends)
    assert np.all(np.sign(np.diff(np.unwrap(np.angle(arc)))) == way)
    assert made.rank.tolist() == [8.0 + row for row in rows]
    # Arc lengths in order, beyond all turns that the lands are on.
    assert made.rolled[0].tolist() == [600.0 + row for row in rows]
    assert made.rolled[1].tolist() == [601.0 + row for row in rows]


@pytest.mark.judges("teeth")
def test_a_corner_is_as_round_as_wall_and_heel_allow() -> None:
    """A circle of rho that stands on the radius R within an angle a of the wall: (R + rho) sin a = rho."""
    assert toothed_arc._rounding(20.0, 15.0, 2.0, 3.0) == 2.0
    assert toothed_arc._rounding(20.0, 17.5, 2.0, 3.0) == 1.25
    assert toothed_arc._rounding(20.0, 20.0 - 0.24 * 2.0, 2.0, 3.0) == 0.0
    narrow = toothed_arc._rounding(20.0, 15.0, 2.0, 0.2)
    assert (15.0 + narrow) * sin(0.2 / 4.0) == pytest.approx(narrow)
    wide = toothed_arc._rounding(1e3, 15.0, 1e3, 4.0)
    assert (15.0 + wide) * sin(pi / 4.0) == pytest.approx(wide)


@pytest.mark.judges("teeth")
def test_places_of_a_row_stand_for_half_the_steps_beside_them() -> None:
    found = _widths(np.array([[0.0, 1.0, 4.0, 6.0], [2.0, 2.0, 3.0, 9.0]]))
    assert found == pytest.approx(np.array([[0.5, 2.0, 2.5, 1.0], [0.0, 0.5, 3.5, 3.0]]))


# --- solids


@pytest.mark.judges("solids")
def test_a_small_jump_stands_out_from_even_steps_beside_it() -> None:
    """Of a module of 4 mm a step that differs by more than 0.004 mm from both beside it; either sign counts."""
    for jump in (1.3 * STANDS_OUT * 4.0, -1.3 * STANDS_OUT * 4.0):
        height = 5.0 - 0.01 * np.arange(8.0)
        height[4:] += jump
        fitted = np.array([True] * 7 + [False])
        found = _low_sides(height, np.ones(8), fitted, 4.0)
        assert found[3] == pytest.approx(min(height[3], height[4]) - 0.01)
        assert np.delete(found, 3) == pytest.approx(np.full(7, 4.0 * HIGH))
        height[4:] -= jump * 0.5 / 1.3
        assert _low_sides(height, np.ones(8), fitted, 4.0) == pytest.approx(np.full(8, 4.0 * HIGH))


@pytest.mark.judges("solids")
def test_a_rise_steeper_than_ceilings_is_a_jump() -> None:
    """Heights that rise by 0.8 in each step of 1.5 mm rise more than RISE; the fall beside it counts up to RISE."""
    height, gap = 1.0 + 0.8 * np.arange(6.0), np.full(6, 1.5)
    fitted = np.array([True] * 5 + [False])
    assert RISE * 1.5 < 0.8
    found = _low_sides(height, gap, fitted, 2.0)
    assert found[:5] == pytest.approx(height[:5] - RISE * 1.5)
    assert found[5] == pytest.approx(2.0 * HIGH)
    assert _low_sides(height, np.full(6, 1.7), fitted, 2.0) == pytest.approx(np.full(6, 2.0 * HIGH))


@pytest.mark.judges("solids")
def test_a_hole_of_small_modules_is_as_wide_as_is_useful() -> None:
    disc, hub = (shapely.Point(0.0, 0.0).buffer(one, quad_segs=256) for one in (50.0, 10.0))
    hole = _hole_on_ray(disc, 2.0, 0.3, disc.exterior, hub, np.argmin)
    assert hole is not None
    assert hole.diameter_mm == USEFUL_MM
    assert np.hypot(hole.x_mm, hole.y_mm) == pytest.approx(
        10.0 + USEFUL_MM / 2.0 + INNER_WALL_IN_MODULES * 0.3, abs=0.05
    )
    # A narrow ring has room for no hole.
    narrow = shapely.Point(0.0, 0.0).buffer(11.0)
    assert _hole_on_ray(narrow, 2.0, 0.3, narrow.exterior, hub, np.argmin) is None


# --- strength


@pytest.mark.judges("strength")
@at_once("order", [1, 2])
@at_once("times", [1, 2])
def test_the_mesh_of_a_tooth_has_its_sides_middle_and_bottom(order: int, times: int) -> None:
    """Nodes follow each other in elements; Euler's number of a disc is 1; what is held is the strip's three sides."""
    size = MeshSize(order=order).times(times)
    found = topology_of(size)
    across, upper, aside = size.across, size.fillet + size.flank, size.valley + 3 * size.beyond
    assert len(found.cells) == across * upper + (2 * aside + across) * size.deep
    corners = found.cells[:, [0, order, -1, -1 - order]]
    edges = {frozenset(pair) for cell in corners for pair in zip(cell, np.roll(cell, 1), strict=True)}
    assert np.unique(corners).size - len(edges) + len(corners) == 1
    together = {frozenset((one, other)) for cell in found.cells for one in cell for other in cell}
    length = (size.valley + upper) * order + 1
    assert found.root_nodes == (size.valley + size.fillet) * order + 1
    for way in (*found.sides, found.middle):
        assert all(frozenset(pair) in together for pair in pairwise(way))
        assert np.unique(way).size == way.size
    assert found.sides.shape == (2, length)
    assert found.middle.size == (upper + size.deep) * order + 1
    assert not found.held[found.sides].any()
    assert found.held[found.middle].tolist() == [False] * (found.middle.size - 1) + [True]
    assert found.held.sum() == (2 * aside + across) * order + 1 + 2 * size.deep * order
    # Own elements leave out what is beyond the middles of both spaces.
    left_out = np.setdiff1d(np.arange(len(found.cells)), found.own)
    assert left_out.size == 2 * 3 * size.beyond * size.deep
    valley = {node for way in found.sides for node in way[:1]}
    assert valley <= set(found.cells[left_out].ravel().tolist()) & set(found.cells[found.own].ravel().tolist())


# --- trains and projects


@pytest.mark.judges("trains")
def test_a_law_is_inverted_over_many_cycles() -> None:
    law = ratio_expression_law("1.5 + 0.3*cos(phi)", Lobes(1, 2), scale_to_close=True)
    pitch: Any = Made(transmission=law)
    at = np.array([-30.0, -0.5, 0.0, 1.0, 6.5, 12.0, 40.0])
    assert _inverse(pitch)(law.driven_angle(at).value) == pytest.approx(at, abs=1e-9)
    rough = Made(
        lobes=law.lobes,
        driven_angle=lambda angle, order=0: Made(
            value=law.driven_angle(angle).value + 1e-6 * np.sin(1e9 * angle), derivative=lambda one: 1.0 + 0.0 * angle
        ),
    )
    with pytest.raises(NoSuchMechanism, match="could not be inverted"):
        _inverse(Made(transmission=rough))(np.array([0.7]))


@pytest.mark.judges("project")
def test_the_difference_of_law_and_function_is_a_share_of_the_greatest_value() -> None:
    at = np.array([0.0, 1.0, 2.0])
    slope = np.array([0.5, 0.8, 1.25])
    drive: Any = Made(
        transmission=Made(driven_angle=lambda angle, order: Made(derivative=lambda one: slope)),
        machine=Made(displacement=lambda angle, order: Made(value=np.array([1.0, 2.0, 4.0]))),
        linkage=Made(OUTPUT=Made(place=Made(factor=10.0))),
    )
    wanted = np.array([2.0, -4.0, 0.7])
    assert _off(drive, at, wanted, {}, "motion.ratio") == pytest.approx(np.array([0.0, 5.25, 0.1]) / 4.0)
    scaled = _off(drive, at, np.array([4.0, 2.5, 1.7]), {"scale_to_close": True}, "ratio")
    assert scaled == pytest.approx(np.array([0.0, 0.0, 0.1]) / 4.0)
    assert _off(drive, at, np.array([12.0, 20.0, -5.0]), {}, "place_mm") == pytest.approx([0.1, 0.0, 2.25])
