"""Balance of the gears themselves: closed forms, trimesh's volume integrals, and solids that balance when corrected."""

from __future__ import annotations

from functools import cache
from math import inf, pi

import numpy as np
import pytest
import shapely
import trimesh
from hypothesis import example, given, settings
from hypothesis import strategies as st
from scipy.optimize import linprog
from shapely import Point, Polygon

from at_once import at_once
from drives import drive
from ncgear.balance.gears import (
    BossSize,
    Corrected,
    Drills,
    Means,
    balancing_boss,
    corrected,
    drilled,
    drilled_holes,
    mesh_body,
    plate_body,
)
from ncgear.balance.rotor import grade_reached, permissible_unbalance_kg_mm
from ncgear.errors import NoSuchMechanism, WrongInput
from ncgear.solids.mesh.slabs import slab_mesh
from ncgear.solids.mesh.triangles import TriangleMesh
from ncgear.solids.plan.areas import area_moments
from ncgear.solids.plan.body import RoundHole, Slab, circle_points

STEEL = 7850.0
TOLERANCE = 0.005


Holes = tuple[tuple[complex, float], ...]


def disc(radius: float, center: complex = 0j, holes: Holes = (), chord_mm: float = 0.005) -> Polygon:
    """A round plate with round holes, by chords."""

    def circle(at: complex, r: float) -> np.ndarray:
        return np.array([at.real, at.imag]) + circle_points(r, chord_mm)

    return Polygon(circle(center, radius), [circle(at, r) for at, r in holes])


def test_two_boxes_in_closed_form() -> None:
    """One on the other, both beside the axis: Steiner's theorem, and the couple about the height of their centroid."""
    bounds = np.array([[[2.0, 1.0, 0.0], [8.0, 5.0, 10.0]], [[-3.0, -2.0, 10.0], [4.0, 6.0, 14.0]]])
    boxes = trimesh.util.concatenate([trimesh.creation.box(bounds=one) for one in bounds])
    found = mesh_body(TriangleMesh(boxes.vertices, boxes.faces), STEEL)
    size, center = bounds[:, 1] - bounds[:, 0], bounds.mean(axis=1)
    mass, place, height = STEEL * 1e-9 * size.prod(axis=1), center @ [1.0, 1j, 0.0], center[:, 2]
    assert found.mass_kg == pytest.approx(mass.sum(), rel=1e-12)
    assert found.unbalance_kg_mm == pytest.approx(mass @ place, rel=1e-12)
    steiner = (size[:, 0] ** 2 + size[:, 1] ** 2) / 12.0 + abs(place) ** 2
    assert found.inertia_kg_mm2 == pytest.approx(mass @ steiner, rel=1e-12)
    assert found.couple_kg_mm2 == pytest.approx(mass @ (place * (height - mass @ height / mass.sum())), rel=1e-12)


@cache
def section(name: str, gear: str) -> Polygon:
    return getattr(drive(name).solids, gear).plan.section


def test_an_eccentric_disc_with_holes() -> None:
    """Circles: area, centroid and Steiner's theorem."""
    shape = disc(50.0, 3 + 4j, ((10 - 20j, 8.0), (-15 + 5j, 6.0)), 1e-7)
    areas = pi * np.array([50.0**2, -(8.0**2), -(6.0**2)])
    places, radii = np.array([3 + 4j, 10 - 20j, -15 + 5j]), np.array([50.0, 8.0, 6.0])
    found = plate_body(shape, 12.0, STEEL)
    per_area = STEEL * 1e-9 * 12.0
    assert found.mass_kg == pytest.approx(per_area * areas.sum(), rel=1e-7)
    assert found.unbalance_kg_mm == pytest.approx(per_area * (areas @ places), rel=1e-6)
    polar = np.sum(areas * (radii**2 / 2.0 + np.abs(places) ** 2))
    assert found.inertia_kg_mm2 == pytest.approx(per_area * polar, rel=1e-7)


@pytest.mark.slow
@at_once("name", ["ellipse", "baler-86"])
@at_once("gear", ["driving", "driven"])
def test_the_outline_and_the_mesh_agree(name: str, gear: str) -> None:
    """Green's theorem in the plane against trimesh's integrals over the solid that is written."""
    made = drive(name)
    plate = plate_body(section(name, gear), made.gears.face_width_mm, STEEL)
    mesh = mesh_body(getattr(made.solids, gear).triangles, STEEL)
    assert plate.mass_kg == pytest.approx(mesh.mass_kg, rel=1e-10)
    assert plate.unbalance_kg_mm == pytest.approx(mesh.unbalance_kg_mm, rel=1e-10)
    assert plate.inertia_kg_mm2 == pytest.approx(mesh.inertia_kg_mm2, rel=1e-10)


def test_an_elliptical_gear_turns_about_its_focus() -> None:
    """Its centroid lies about the linear eccentricity, 0.35 of the half axis, off the axis."""
    found = plate_body(section("ellipse", "driving"), 12.0, STEEL)
    half_axis = drive("ellipse").pitch.size.center_distance_mm / 2.0
    assert found.eccentricity_mm == pytest.approx(0.35 * half_axis, rel=0.05)


# --- grades ------------------------------------------------------------------------------------------------------


def test_permissible_unbalance() -> None:
    """G 6.3 at 3000 r/min: 20 um of eccentricity; the finest grade met is the next one above."""
    speed = 3000.0 * pi / 30.0
    allowed = permissible_unbalance_kg_mm(6.3, 10.0, speed)
    assert allowed == pytest.approx(10.0 * 0.02005, rel=1e-3)
    assert grade_reached(0.999 * allowed, 10.0, speed) == 6.3
    assert grade_reached(1.001 * allowed, 10.0, speed) == 16.0
    assert grade_reached(0.0, 10.0, speed) == 0.4
    assert grade_reached(1e6, 1.0, 100.0) == inf


# --- correction --------------------------------------------------------------------------------------------------

SLIGHT = disc(60.0, 2 - 1j, ((0j, 10.0),))
"""A gear of little unbalance, which holes alone can take."""

DRILLS = Drills(largest_mm=9.0, smallest_mm=1.0, wall_mm=3.0)


def residual(found: Corrected, of: Polygon) -> float:
    """Share of the section's eccentricity that the mesh has left."""
    return found.body.eccentricity_mm / plate_body(of, 1.0, STEEL).eccentricity_mm


def test_holes_balance_the_mesh() -> None:
    found = corrected(SLIGHT, 15.0, STEEL, Means(DRILLS), TOLERANCE, "gears")
    assert found.mesh.is_watertight
    # A hole of under 1 mm, 1.2 per cent of a full one, may be left out
    assert residual(found, SLIGHT) <= 0.005
    assert len(found.holes) >= 3
    direction = np.angle(plate_body(SLIGHT, 1.0, STEEL).unbalance_kg_mm)
    assert all(np.cos(np.angle(complex(hole.x_mm, hole.y_mm)) - direction) > 0.0 for hole in found.holes)
    # Nothing drilled leaves everything
    assert residual(corrected(SLIGHT, 15.0, STEEL, Means(), TOLERANCE, "gears"), SLIGHT) == pytest.approx(1.0, rel=1e-9)


def test_drilled_polygons_have_the_areas_of_their_circles() -> None:
    """However coarse their chords."""
    holes = [RoundHole(20.0, 5.0, 9.0), RoundHole(-15.0, 20.0, 4.0)]
    lost = SLIGHT.area - drilled(SLIGHT, holes, 0.5).area
    assert lost == pytest.approx(pi / 4.0 * (81.0 + 16.0), rel=1e-9)


def test_holes_keep_their_walls() -> None:
    found = drilled_holes(SLIGHT, area_moments(SLIGHT).first_mm3, DRILLS, "gears")
    discs = [Point(hole.x_mm, hole.y_mm).buffer(hole.diameter_mm / 2.0, quad_segs=64) for hole in found]
    assert all(hole.distance(SLIGHT.boundary) >= 3.0 - 1e-9 for hole in discs)
    assert all(one.distance(other) >= 3.0 - 1e-9 for k, one in enumerate(discs) for other in discs[:k])
    assert all(DRILLS.smallest_mm <= hole.diameter_mm <= DRILLS.largest_mm * (1.0 + 1e-12) for hole in found)


def test_no_other_holes_on_the_lattice_take_less() -> None:
    """All but two are full: a corner of the linear programme."""
    diameters = [hole.diameter_mm for hole in drilled_holes(SLIGHT, area_moments(SLIGHT).first_mm3, DRILLS, "gears")]
    assert sum(diameter < DRILLS.largest_mm * (1.0 - 1e-9) for diameter in diameters) <= 2


@pytest.mark.parametrize("height", [6.0, 15.0])
def test_a_boss_balances_the_mesh(height: float) -> None:
    found = corrected(SLIGHT, 15.0, STEEL, Means(boss=BossSize(height, 2.0)), TOLERANCE, "gears")
    assert residual(found, SLIGHT) <= 1e-8
    assert found.mesh.is_watertight
    assert found.mesh.bounds[:, 2] == pytest.approx([0.0, 15.0 + height])
    assert found.boss is not None
    # What is static is balanced in another plane: a couple of unbalance times half of both heights is left
    unbalance = abs(plate_body(SLIGHT, 15.0, STEEL).unbalance_kg_mm)
    assert abs(found.body.couple_kg_mm2) == pytest.approx(unbalance * (15.0 + height) / 2.0, rel=1e-6)
    assert found.boss.section.distance(SLIGHT.boundary) >= 2.0 * (1.0 - 1e-9)


def test_no_boss_of_the_height_is_lighter() -> None:
    """Against a linear programme over the cells of a fine grid of the room."""
    moment = area_moments(SLIGHT).first_mm3 * 15.0
    found = balancing_boss(SLIGHT, moment, 10.0, 2.0, "gears")
    x, y = np.meshgrid(np.arange(-60.0, 63.0), np.arange(-62.0, 60.0))
    inside = shapely.contains_xy(SLIGHT.buffer(-2.0), x, y)
    cells = np.vstack([x[inside], y[inside]])
    target = -moment / 10.0
    least = linprog(np.ones(cells.shape[1]), A_eq=cells, b_eq=[target.real, target.imag], bounds=(0.0, 1.0)).fun
    # Cells of 1 mm2 along an edge of some 60 mm
    assert found.section.area == pytest.approx(least, rel=0.02)


@pytest.mark.slow
def test_holes_and_a_boss_balance_an_elliptical_gear() -> None:
    """Its unbalance is too much for holes alone: they say how much they leave, the boss takes that."""
    gear, width = section("ellipse", "driving"), 12.0
    drills = Drills(8.0, 3.0, 2.0)
    holes = corrected(gear, width, STEEL, Means(drills), TOLERANCE, "gears")
    before = plate_body(gear, width, STEEL).unbalance_kg_mm
    left = holes.body.unbalance_kg_mm / before
    assert 0.5 < left.real < 0.8
    assert abs(left.imag) < 1e-3
    both = corrected(gear, width, STEEL, Means(drills, BossSize(75.0, 2.0)), TOLERANCE, "gears")
    assert residual(both, gear) <= 1e-8


@pytest.mark.thorough
def test_a_low_boss_is_refused_with_a_height_that_does() -> None:
    gear, moment = section("ellipse", "driving"), area_moments(section("ellipse", "driving")).first_mm3 * 12.0
    with pytest.raises(NoSuchMechanism, match=r"one of (\d+) mm would") as error:
        balancing_boss(gear, moment, 40.0, 2.0, "gears.boss.height_mm")
    height = float(str(error.value).split("one of ")[1].split(" ")[0])
    assert balancing_boss(gear, moment, height, 2.0, "gears").section.area > 0.0
    assert error.value.key == "gears.boss.height_mm"


def test_a_balanced_gear_is_left_as_it_is() -> None:
    round_gear = disc(60.0, 0j, ((0j, 10.0),))
    found = corrected(round_gear, 15.0, STEEL, Means(DRILLS, BossSize(10.0, 2.0)), TOLERANCE, "gears")
    assert (found.holes, found.boss) == ([], None)
    assert found.mesh.volume == pytest.approx(round_gear.area * 15.0, rel=1e-9)


@pytest.mark.slow
@settings(max_examples=15, deadline=None)
@example(offset=0.15038146635252092, direction=1.875, oval=0.0, bore=0.17254488767752046)  # three points in line
@given(
    offset=st.floats(0.02, 0.5),
    direction=st.floats(-pi, pi),
    oval=st.floats(0.0, 0.1),
    bore=st.floats(0.1, 0.3),
)
def test_every_gear_balances_with_the_height_advised(offset: float, direction: float, oval: float, bore: float) -> None:
    angle = np.linspace(0.0, 2.0 * pi, 200, endpoint=False)
    radius = 80.0 * (1.0 + 0.03 * np.cos(20.0 * angle) + oval * np.cos(2.0 * angle + 1.0))
    points = 80.0 * offset * np.exp(1j * direction) + radius * np.exp(1j * angle)
    gear = Polygon(np.column_stack([points.real, points.imag]), [circle_points(80.0 * bore, 0.05)])
    with pytest.raises(NoSuchMechanism, match=r"one of (\d+) mm would") as error:
        corrected(gear, 20.0, STEEL, Means(boss=BossSize(0.1, 1.5)), TOLERANCE, "gears")
    height = float(str(error.value).split("one of ")[1].split(" ")[0])
    found = corrected(gear, 20.0, STEEL, Means(boss=BossSize(height, 1.5)), TOLERANCE, "gears")
    assert residual(found, gear) <= 1e-8


def test_no_room_for_holes() -> None:
    with pytest.raises(NoSuchMechanism, match="no hole of 200 mm"):
        drilled_holes(SLIGHT, area_moments(SLIGHT).first_mm3, Drills(200.0, 3.0, 2.0), "gears.holes")
    with pytest.raises(WrongInput, match="too many to choose from"):
        drilled_holes(SLIGHT, area_moments(SLIGHT).first_mm3, Drills(0.01, 0.01, 0.01), "gears.holes")


def test_a_boss_around_the_bore_is_one_sound_mesh() -> None:
    """With a chord near the axis the boss goes round the bore on both sides."""
    gear = disc(60.0, 9 + 0j, ((0j, 10.0),))
    found = corrected(gear, 15.0, STEEL, Means(boss=BossSize(19.0, 2.0)), TOLERANCE, "gears")
    assert residual(found, gear) <= 1e-8
    assert mesh_body(slab_mesh((Slab(gear, 0.0, 15.0),)), STEEL).eccentricity_mm > 9.0
