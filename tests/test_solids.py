"""Solids: volumes against closed forms, bores and keyways, what is refused, and where the index hole goes."""

from __future__ import annotations

from io import BytesIO
from math import asin, hypot, pi, sqrt

import numpy as np
import pytest
import shapely
import trimesh.creation
from shapely import Point, Polygon
from trimesh import Trimesh

from at_once import at_once
from ncgear.errors import NoSuchMechanism, Unanswered, WrongInput
from ncgear.figures.assembly import Placed, assembled_pose, met_at, outline_radius_mm
from ncgear.files.read_back import mesh_of_stl, read_back, stl_bytes
from ncgear.numerics.arrays import Array
from ncgear.pitch.shape import Gear
from ncgear.solids.mesh.pair import gear_solid
from ncgear.solids.mesh.slabs import slab_mesh
from ncgear.solids.mesh.triangles import TriangleMesh, merged
from ncgear.solids.plan.body import (
    HOLE_CHORDS_MM,
    Blank,
    Bore,
    Keyway,
    RoundHole,
    Slab,
    bore_points,
    circle_points,
    hole_points,
)
from ncgear.solids.plan.room import INNER_WALL_IN_MODULES, OUTER_WALL_IN_MODULES, full_disc, index_hole, largest_bore_mm
from ncgear.tolerances.iso286 import standard_tolerance_mm
from plane import wave_ring

TOLERANCE = 0.005
MODULE = 2.5
TEETH = 40
RADIUS = TEETH * MODULE / 2.0
WAVE = 1.1 * MODULE


def wavy(points: int = 40_000, phase: float = 0.0) -> Array:
    """A gear-like outline, radius RADIUS + WAVE cos(TEETH angle): a tooth on polar angle 0 when the phase is 0."""
    return wave_ring(RADIUS, WAVE, TEETH, points, phase)


def extruded(outline: Array, width: float, bore: Bore | None, tolerance: float) -> Trimesh:
    return gear_solid(Gear.DRIVING, outline, Blank(width, bore), MODULE, tolerance).mesh


def cut_area(bore: Bore) -> float:
    """Exact area of a bore with its keyway: circle, plus the rectangle, less the segment that both have."""
    radius, keyway = bore.diameter_mm / 2.0, bore.keyway
    if keyway is None:
        return pi * radius**2
    half = keyway.width_mm / 2.0
    chord = sqrt(radius**2 - half**2)
    segment = radius**2 * asin(half / radius) - half * chord
    return pi * radius**2 + keyway.width_mm * (radius + keyway.depth_mm - chord) - segment


BORES = [None, Bore(30.0), Bore(30.0, Keyway(8.0, 3.3)), Bore(6.0, Keyway(5.9, 1.0))]


@pytest.mark.judges("solids")
@pytest.mark.tiers(slow=["None", "bore2"], rest="long")
@pytest.mark.parametrize("bore", BORES)
def test_volume_is_that_of_the_closed_form(bore: Bore | None) -> None:
    mesh = extruded(wavy(), 20.0, bore, 1e-4)
    area = pi * (RADIUS**2 + WAVE**2 / 2.0) - (cut_area(bore) if bore else 0.0)
    # Chords of 8 um on the outline, a chord tolerance of 0.1 um on a bore of 100 mm around at most.
    assert mesh.volume == pytest.approx(20.0 * area, rel=3e-6)
    assert mesh.is_watertight
    assert mesh.euler_number == (0 if bore else 2)
    np.testing.assert_allclose(mesh.bounds[:, 2], [0.0, 20.0], rtol=0.0, atol=0.0)


@pytest.mark.slow
@at_once("bore", BORES)
def test_stl_reads_back_as_the_same_solid(bore: Bore | None) -> None:
    mesh = extruded(wavy(4000), 20.0, bore, TOLERANCE)
    data = stl_bytes(mesh)
    again = read_back(data, mesh)
    assert len(data) == 84 + 50 * len(mesh.faces)
    assert again.is_watertight
    assert again.volume == pytest.approx(mesh.volume, rel=1e-6)


def test_a_lost_facet_is_noticed() -> None:
    mesh = extruded(wavy(400), 20.0, None, TOLERANCE)
    data = stl_bytes(mesh)
    count = len(mesh.faces) - 1
    with pytest.raises(Unanswered, match="watertight"):
        read_back(data[:80] + count.to_bytes(4, "little") + data[84:-50], mesh)


def test_another_solid_is_noticed() -> None:
    mesh = extruded(wavy(400), 20.0, None, TOLERANCE)
    moved = TriangleMesh(np.add(mesh.vertices, [0.0, 0.0, 0.01]), mesh.faces)
    with pytest.raises(Unanswered, match="spans"):
        read_back(stl_bytes(moved.as_trimesh()), mesh)
    with pytest.raises(Unanswered, match="mm3"):
        read_back(stl_bytes(extruded(wavy(400), 20.01, None, TOLERANCE)), mesh)


def test_points_that_single_precision_cannot_tell_apart_do_no_harm() -> None:
    outline = wavy(400)
    doubled = np.repeat(outline, 2, axis=0)
    doubled[1::2] += 1e-7
    mesh = extruded(doubled, 20.0, Bore(30.0), TOLERANCE)
    assert read_back(stl_bytes(mesh), mesh).is_watertight


@at_once("radius", [0.5, 10.0, 300.0])
@at_once("tolerance", [1e-4, 0.005, 0.5, 5.0])
def test_circles_keep_the_chord_tolerance(radius: float, tolerance: float) -> None:
    points = circle_points(radius, tolerance)
    middles = (points + np.roll(points, -1, axis=0)) / 2.0
    np.testing.assert_allclose(np.hypot(*points.T), radius, rtol=1e-14)
    assert radius - np.hypot(*middles.T).min() <= tolerance
    assert len(points) >= 24


@at_once("diameter", [0.4, 2.0, 10.0, 49.0, 400.0])
@at_once("tolerance", [1e-5, 0.005, 0.5])
def test_polygons_of_holes_are_within_their_narrowest_fit(diameter: float, tolerance: float) -> None:
    """What fits the least hole of H6 goes through, and what is greater than the greatest does not touch all round."""
    polygon = Polygon(hole_points(RoundHole(0.0, 0.0, diameter), tolerance))
    fitting = Polygon(bore_points(Bore(diameter, Keyway(diameter / 4.0, diameter / 8.0)), tolerance))
    width = standard_tolerance_mm(6, diameter)
    assert width is not None
    for hole in (polygon, fitting):
        assert hole.exterior.distance(Point(0.0, 0.0)) >= diameter / 2.0 * (1.0 - 1e-14)
    assert 2.0 * np.hypot(*shapely.get_coordinates(polygon).T).max() <= diameter + min(width, 2.1 * tolerance)


def test_keyway_points_along_x() -> None:
    points = bore_points(Bore(30.0, Keyway(8.0, 3.3)), TOLERANCE)
    floor = points[points[:, 0] > 15.0 + 1e-9]
    np.testing.assert_allclose(floor, [[18.3, -4.0], [18.3, 4.0]])
    polygon = Polygon(points)
    assert polygon.is_valid
    assert polygon.exterior.is_ccw


def test_keyway_as_wide_as_the_bore_is_refused() -> None:
    with pytest.raises(ValueError, match="keyway"):
        Bore(8.0, Keyway(8.0, 1.0))


@pytest.mark.tiers(slow=["bore1-94.5"], rest="long")
@pytest.mark.parametrize(
    ("bore", "largest"),
    [
        (Bore(200.0), 2.0 * (RADIUS - WAVE)),
        (Bore(97.0), 2.0 * (RADIUS - WAVE)),
        # The keyway's corners reach the outline at polar angles near 5 deg, where there is a root.
        (Bore(90.0, Keyway(8.0, 6.0)), None),
    ],
)
def test_bore_that_does_not_fit_is_refused_with_the_largest_that_does(bore: Bore, largest: float | None) -> None:
    with pytest.raises(WrongInput, match="largest that fits is") as caught:
        gear_solid(Gear.DRIVEN, wavy(4000), Blank(20.0, bore), MODULE, TOLERANCE)
    assert caught.value.key == "gears.driven.bore_mm"
    stated = float(caught.value.problem.split("fits is ")[1].split(" mm")[0])
    extruded(wavy(4000), 20.0, Bore(stated, bore.keyway), TOLERANCE)
    with pytest.raises(WrongInput):
        extruded(wavy(4000), 20.0, Bore(stated + 0.03, bore.keyway), TOLERANCE)
    if largest is not None:
        assert stated == pytest.approx(largest - 2.0 * (MODULE + TOLERANCE), abs=0.03)


def test_keyway_that_no_bore_makes_room_for() -> None:
    bore = Bore(20.0, Keyway(8.0, 60.0))
    assert largest_bore_mm(full_disc(wavy(), "gears.driving"), bore, MODULE, TOLERANCE) == 0.0
    with pytest.raises(WrongInput, match="none fits"):
        extruded(wavy(), 20.0, bore, TOLERANCE)


def test_outline_that_crosses_itself_is_refused_where_it_does() -> None:
    outline = np.array([[-10.0, -10.0], [10.0, 10.0], [10.0, -10.0], [-10.0, 10.0]]) + np.array([30.0, 40.0])
    with pytest.raises(
        NoSuchMechanism, match=r"crosses itself at x = 30 mm, y = 40 mm \(polar angle 53.13 deg"
    ) as caught:
        extruded(outline, 20.0, None, TOLERANCE)
    assert caught.value.key == "gears.driving"


def test_a_section_whose_mesh_is_wrong_is_a_fault(monkeypatch: pytest.MonkeyPatch) -> None:
    box = trimesh.creation.box((1.0, 1.0, 1.0))
    monkeypatch.setattr("ncgear.solids.mesh.slabs.joined", lambda _: TriangleMesh(box.vertices, box.faces))
    with pytest.raises(Unanswered, match="mm3"):
        slab_mesh((Slab(Polygon(wavy(100)), 0.0, 20.0),))


@at_once("direction", [0.0, pi, 1.0])
@at_once("bore", [None, Bore(30.0), Bore(30.0, Keyway(8.0, 3.3))])
def test_index_hole_keeps_its_walls(bore: Bore | None, direction: float) -> None:
    disc = full_disc(wavy(4000), "gears.driving")
    hole = index_hole(disc, bore, direction, MODULE)
    assert hole is not None
    assert np.arctan2(hole.y_mm, hole.x_mm) == pytest.approx(direction, abs=1e-9)
    assert hole.diameter_mm == 2.0  # half a module would be 1.25 mm
    wall = disc.exterior.distance(Point(hole.x_mm, hole.y_mm)) - hole.diameter_mm / 2.0
    # As far out as the wall allows; buffers are polygons, a thousandth off.
    assert wall == pytest.approx(OUTER_WALL_IN_MODULES * MODULE, rel=5e-3)


def test_index_hole_is_left_out_without_room() -> None:
    disc = full_disc(wavy(4000, pi), "gears.driving")
    free = RADIUS - WAVE - (INNER_WALL_IN_MODULES + OUTER_WALL_IN_MODULES + 0.5) * MODULE
    assert index_hole(disc, Bore(2.0 * free - 0.5), pi, MODULE) is not None
    assert index_hole(disc, Bore(2.0 * free + 0.5), pi, MODULE) is None


@pytest.mark.parametrize(("module", "bore", "diameter"), [(7.0, 12.0, 3.5), (1.2, 12.0, 2.0), (1.2, 95.5, 1.0)])
def test_index_holes_can_be_printed_or_drilled(module: float, bore: float, diameter: float) -> None:
    """Half a module, but 2 mm at least where they have room, and nowhere under 1 mm."""
    disc = Polygon(circle_points(52.0, TOLERANCE))
    hole = index_hole(disc, Bore(bore), 2.0, module)
    assert hole is not None
    assert hole.diameter_mm == diameter
    walls = 52.0 - bore / 2.0 - 2.5 * module
    assert diameter <= walls < (2.0 if diameter == 1.0 else np.inf)
    assert index_hole(disc, Bore(2.0 * (52.0 - 2.5 * module - 0.98)), 2.0, module) is None


def test_keyway_takes_the_room_of_the_index_hole_on_its_own_side_only() -> None:
    disc = full_disc(wavy(4000), "gears.driving")
    bore = Bore(60.0, Keyway(10.0, 12.0))
    assert index_hole(disc, bore, 0.0, MODULE) is None
    assert index_hole(disc, bore, pi, MODULE) is not None


@pytest.mark.thorough
def test_index_holes_face_each_other_on_the_line_of_centres() -> None:
    blank = Blank(20.0, Bore(30.0), index_hole=True)
    driving = gear_solid(Gear.DRIVING, wavy(4000), blank, MODULE, TOLERANCE)
    driven = gear_solid(Gear.DRIVEN, wavy(4000, pi), blank, MODULE, TOLERANCE)
    assert driving.index_hole is not None
    assert driven.index_hole is not None
    assert 0.0 < driving.index_hole.x_mm < 2.0 * RADIUS + driven.index_hole.x_mm
    assert abs(driving.index_hole.y_mm) + abs(driven.index_hole.y_mm) < 1e-12
    for solid in (driving, driven):
        assert solid.mesh.euler_number == -2
        hole = solid.index_hole
        assert hole is not None
        # The mesh really has the hole, at the place that is reported.
        away = np.hypot(solid.mesh.vertices[:, 0] - hole.x_mm, solid.mesh.vertices[:, 1] - hole.y_mm)
        assert away.min() == pytest.approx(hole.diameter_mm / 2.0 + HOLE_CHORDS_MM)


def test_assembled_pose_names_what_meets() -> None:
    driving, driven = wavy(4000), wavy(4000, pi)
    report = assembled_pose(Placed(driving, RADIUS, None), Placed(driven, RADIUS, None), 2.0 * RADIUS, MODULE)
    assert report["center_distance_mm"] == 2.0 * RADIUS
    # Forty teeth: a space of the driven gear stands on pi as on 0.
    assert (report["driving"]["on_line_of_centers"], report["driven"]["on_line_of_centers"]) == ("tooth", "space")
    assert (report["driving"]["line_of_centers_rad"], report["driven"]["line_of_centers_rad"]) == (0.0, 3.1415927)
    assert report["driving"]["index_hole"] is None
    assert met_at(Placed(wavy(4000, pi / 2.0), RADIUS, None), 0.0, MODULE) == "flank"


def test_outline_radius_along_a_ray() -> None:
    square = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
    assert outline_radius_mm(square, 0.0) == pytest.approx(1.0)
    assert outline_radius_mm(square, pi / 4.0 - 1e-9) == pytest.approx(hypot(1.0, 1.0))
    assert np.isnan(outline_radius_mm(square + 10.0, pi))


@pytest.mark.parametrize("points", [1, 3])
def test_points_in_line_stay_corners_of_both_faces(points: int) -> None:
    """Earcut leaves them out, and then the walls beside them would not close."""
    side = np.linspace(0.0, 40.0, points + 2)[:-1]
    square = np.concatenate(
        [
            np.column_stack([side, 0.0 * side]),
            np.column_stack([40.0 + 0.0 * side, side]),
            np.column_stack([40.0 - side, 40.0 + 0.0 * side]),
            np.column_stack([0.0 * side, 40.0 - side]),
        ]
    )
    ring = square + np.array([-20.0, -20.0])
    section = Polygon(ring, [0.5 * ring, 0.1 * ring + np.array([15.0, 0.0])])
    mesh = slab_mesh([Slab(section, 0.0, 7.0)], None)
    assert mesh.is_watertight
    assert mesh.volume == pytest.approx(7.0 * section.area, rel=1e-12)


def whole_and_faulty() -> dict[str, TriangleMesh]:
    """Sound meshes, and meshes with a fault each."""
    mesh = gear_solid(Gear.DRIVING, wavy(200), Blank(20.0, Bore(30.0)), MODULE, TOLERANCE).triangles
    turned = mesh.faces.copy()
    turned[7] = turned[7, ::-1]
    return {
        "gear": mesh,
        "body": gear_solid(
            Gear.DRIVING, wavy(400), Blank(10.0, Bore(20.0), True, chamfer_mm=0.5), MODULE, 0.01
        ).triangles,
        "open": TriangleMesh(mesh.vertices, mesh.faces[1:]),
        "turned": TriangleMesh(mesh.vertices, turned),
        "spare": TriangleMesh(np.vstack([mesh.vertices, [[1e3, 1e3, 1e3]]]), mesh.faces),
        "flat": TriangleMesh(mesh.vertices, np.vstack([mesh.faces, [[3, 3, 4]]])),
    }


@pytest.mark.judges("solids")
@at_once("name", list(whole_and_faulty()))
def test_what_a_mesh_says_of_itself_is_what_trimesh_says(name: str) -> None:
    mesh = whole_and_faulty()[name]
    other = mesh.as_trimesh()
    assert (mesh.is_watertight, mesh.is_winding_consistent) == (other.is_watertight, other.is_winding_consistent)
    assert mesh.volume == pytest.approx(other.volume, rel=1e-14)
    np.testing.assert_array_equal(mesh.bounds, other.bounds)


@pytest.mark.judges("solids")
@pytest.mark.parametrize("name", ["gear", "body"])
def test_stl_files_hold_the_triangles_in_single_precision(name: str) -> None:
    """By the form of binary STL: a head of 80 bytes, their number, and for each a normal, three corners, two bytes."""
    mesh = whole_and_faulty()[name]
    data = stl_bytes(mesh.as_trimesh())
    row = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("more", "<u2")])
    found = np.frombuffer(data, row, offset=84)
    assert int.from_bytes(data[80:84], "little") == found.size == len(mesh.faces)
    np.testing.assert_array_equal(found["corners"], mesh.triangles.astype("<f4"))
    across = np.cross(*(mesh.triangles[:, corner + 1] - mesh.triangles[:, corner] for corner in (0, 1)))
    np.testing.assert_allclose(found["normal"], across / np.linalg.norm(across, axis=1)[:, None], atol=1e-6)
    assert mesh_of_stl(data).volume == pytest.approx(mesh.volume, rel=1e-5)
    other = trimesh.load_mesh(BytesIO(data), file_type="stl")
    np.testing.assert_array_equal(mesh_of_stl(data).vertices, other.vertices)
    np.testing.assert_array_equal(mesh_of_stl(data).faces, other.faces)


def test_an_stl_file_that_is_cut_off_is_refused() -> None:
    data = stl_bytes(extruded(wavy(200), 20.0, None, TOLERANCE))
    with pytest.raises(ValueError, match="does not hold"):
        mesh_of_stl(data[:-1])


@pytest.mark.judges("solids")
def test_points_at_one_place_become_the_first_of_them() -> None:
    rng = np.random.default_rng(3)
    vertices = rng.integers(0, 3, (200, 3)) + rng.uniform(-1e-10, 1e-10, (200, 3))
    faces = rng.integers(0, 150, (80, 3))
    mine, other = merged(vertices, faces), trimesh.Trimesh(vertices, faces)
    np.testing.assert_array_equal(mine.vertices, other.vertices)
    np.testing.assert_array_equal(mine.faces, other.faces)
