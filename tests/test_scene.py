"""The moving scene: bodies stay joined, teeth clear of each other, pitch curves roll, and the loop closes."""

from __future__ import annotations

from dataclasses import replace
from math import pi, radians

import numpy as np
import pytest
import shapely
from shapely import LinearRing, LineString, Point, Polygon

from drives import drive_of_text
from ncgear.drawings.scene.bodies import REST, ROD_WIDTH, BodyPlaces, chamber_of
from ncgear.drawings.scene.geared_pairs import SceneGear, ScenePair, mountings
from ncgear.drawings.scene.scene import Scene, ScenePoses
from ncgear.drawings.scene.standing import WALL_GAP, views, wall_starts_mm, walls_mm
from ncgear.numerics.arrays import Array
from ncgear.numerics.plane import signed_area
from ncgear.pitch.shape import Gear, Mesh
from scenes import ASKEW, TWO_STAGES, carried, drive_of, scene, standing

GEARED = ["baler", "ellipse", "internal-1-2", "pump-1-2", "uniform-crank", TWO_STAGES, "askew"]
every_scene = pytest.mark.parametrize("name", [*GEARED, "gearless"])
every_geared = pytest.mark.parametrize("name", GEARED)


def angles(found: Scene, count: int = 97) -> Array:
    """Over the whole loop, and from before to beyond it."""
    return np.linspace(-0.3, 1.2, count) * found.loop_rad


def pin_mm(found: Scene, poses: ScenePoses) -> Array:
    return carried(poses.places["crank"], np.array([found.machine.linkage.crank_mm, 0.0]))


def rounding_mm(found: Scene) -> float:
    """Some twenty operations on lengths of the size of the linkage; angles of ten turns have rounding of their own."""
    linkage = found.machine.linkage
    return 1e-14 * (linkage.crank_mm + linkage.rod_mm) * 10.0


@pytest.mark.judges("drawings")
@pytest.mark.tiers(quick=["gearless", "askew", "pump-1-2"], rest="slow")
@every_scene
def test_the_linkage_stays_joined(name: str) -> None:
    found = scene(name)
    poses, linkage = found.poses(angles(found)), found.machine.linkage
    rod, slider, pin = poses.places["rod"], poses.places["slider"], pin_mm(found, poses)
    assert np.abs(pin - rod.origin_mm).max() < rounding_mm(found)
    assert np.abs(carried(rod, np.array([linkage.rod_mm, 0.0])) - slider.origin_mm).max() < rounding_mm(found)
    assert np.abs(np.hypot(*(slider.origin_mm - pin).T) - linkage.rod_mm).max() < rounding_mm(found)
    assert np.ptp(slider.origin_mm[:, 1]) == 0.0
    assert np.ptp(slider.angle_rad) == 0.0


@pytest.mark.tiers(slow=["baler-66-two-stage"], rest="thorough")
@every_scene
def test_the_slider_moves_as_the_drive_says(name: str) -> None:
    found, motion = scene(name), drive_of(name).motion
    poses = found.poses(motion.phi1_rad)
    moved = poses.places["slider"].origin_mm[:, 0] - found.machine.linkage.nearest_mm
    assert np.abs(moved - motion.displacement).max() < rounding_mm(found)
    assert np.array_equal(poses.motion.velocity, motion.velocity)


@every_geared
def test_the_crank_pin_stands_still_on_the_driven_gear(name: str) -> None:
    found = scene(name)
    poses, last = found.poses(angles(found)), found.pairs[-1].driven
    pin = as_seen_by(poses.places[last.body.name], pin_mm(found, poses))
    assert np.abs(pin - pin[0]).max() < rounding_mm(found)
    first = as_seen_by(poses.places[found.pairs[0].driving.body.name], pin_mm(found, poses))
    assert np.abs(first - first[0]).max() > 0.5 * found.machine.linkage.crank_mm


@pytest.mark.parametrize("name", ["uniform-crank", "pump-1-2"])
def test_the_view_of_the_gears_has_the_same_room_at_all_sides(name: str) -> None:
    found = scene(name)
    left, bottom, width, height = views(found)["gears"]
    axes, reach = (
        np.array([gear.axis_mm for gear in found.gears]),
        np.array([gear.body.reach_mm for gear in found.gears]),
    )
    low, high = (axes - reach[:, None]).min(axis=0), (axes + reach[:, None]).max(axis=0)
    room = [*(low - (left, bottom)), *((left + width, bottom + height) - high)]
    assert room == pytest.approx([0.03 * (high - low).max()] * 4, rel=1e-9)


def as_seen_by(places: BodyPlaces, points: Array) -> Array:
    cosine, sine = np.cos(places.angle_rad), np.sin(places.angle_rad)
    x, y = (points - places.origin_mm).T
    return np.stack([cosine * x + sine * y, cosine * y - sine * x], axis=-1)


def test_the_crank_turns_clockwise_and_gears_against_each_other_but_in_a_ring() -> None:
    def turns(name: str) -> list[float]:
        found = scene(name)
        bodies = ["crank", *(gear.body.name for gear in found.gears)]
        poses = found.poses(np.array([0.0, 1e-3]))
        return [float(np.sign(np.diff(poses.places[body].angle_rad)[0])) for body in bodies]

    assert turns("baler") == [-1.0, 1.0, -1.0]
    assert turns("internal-1-2") == [-1.0, -1.0, -1.0]
    assert turns(TWO_STAGES) == [-1.0, -1.0, 1.0, 1.0, -1.0]


def test_rings_in_series_turn_alike() -> None:
    """No design has them: both mountings are seen from behind."""
    first, last = mountings([Mesh.INTERNAL, Mesh.INTERNAL], [30.0, 40.0], [radians(90.0)] * 2)
    assert [first.hand, last.hand] == [-1.0, -1.0]
    assert [one.sense(gear) for one in (first, last) for gear in Gear] == [-1.0] * 4
    assert first.driving_axis_mm == pytest.approx((0.0, 70.0))
    assert first.driven_axis_mm == last.driving_axis_mm == pytest.approx((0.0, 40.0))


@every_geared
def test_axes_lie_as_the_design_says(name: str) -> None:
    found, gears = scene(name), drive_of(name).gears
    assert found.axes_mm[-1] == (0.0, 0.0)
    towards = np.exp(1j * radians(gears.driving_axis_deg))
    distances = np.cumsum([pair.pitch.center_distance_mm for pair in reversed(found.pairs)])
    places = [x + 1j * y for x, y in found.axes_mm[-2::-1]]
    assert places == pytest.approx(list(towards * distances), rel=1e-14)


@every_geared
def test_pitch_curves_roll_on_each_other(name: str) -> None:
    """Both go through the pitch point, where both gears have one velocity."""
    found, step = scene(name), 1e-5
    for phi1 in angles(found, 7):
        poses = found.poses(phi1 + step * np.array([-1.0, 0.0, 1.0]))
        for pair, point in zip(found.pairs, poses.pitch_points_mm, strict=True):
            sides = [(gear, poses.places[gear.body.name]) for gear in (pair.driving, pair.driven)]
            # Chords over half a degree of a radius of curvature r miss the curve by r/100 000.
            size = pair.pitch.center_distance_mm
            assert max(curve_at(gear, places).distance(Point(point[1])) for gear, places in sides) < 5e-5 * size
            velocities = [velocity(places, point[1], step) for _, places in sides]
            # Central differences: the third derivative of the angles times the step's square.
            assert np.abs(velocities[0] - velocities[1]).max() < 1e-6 * size


def curve_at(gear: SceneGear, places: BodyPlaces) -> LinearRing:
    return LinearRing(standing(places, gear.pitch_curve_mm, 1))


def velocity(places: BodyPlaces, point: Array, step: float) -> Array:
    """Of a body at a fixed point, in mm per rad of phi1, by central differences."""
    speed = (places.angle_rad[2] - places.angle_rad[0]) / (2.0 * step)
    x, y = point - places.origin_mm[1]
    return speed * np.array([-y, x])


def section_at(gear: SceneGear, poses: ScenePoses, row: int, ahead_rad: float = 0.0) -> Polygon:
    places = poses.places[gear.body.name]
    turned = replace(places, angle_rad=places.angle_rad + ahead_rad)
    rings = [standing(turned, contour, row) for contour in gear.body.contours_mm]
    return Polygon(rings[0], rings[1:])


def gap_mm(pair: ScenePair, poses: ScenePoses, row: int, ahead_rad: float = 0.0) -> float:
    """Distance of the two gears; where they overlap, minus a lower bound of how deep, to 1 micrometre."""
    driving, driven = section_at(pair.driving, poses, row), section_at(pair.driven, poses, row, ahead_rad)
    depth = 0.0
    while driving.buffer(-depth).intersects(driven):
        depth += 1e-3
    return driving.distance(driven) if depth == 0.0 else -depth


@pytest.mark.tiers(slow=["baler-66-two-stage", "internal-1-2"], rest="thorough")
@every_geared
def test_teeth_touch_and_do_not_overlap(name: str) -> None:
    """As far as chords on both sides may stray; turned by half a tooth they would overlap by far."""
    found = scene(name)
    poses, backlash = found.poses(angles(found, 7)), drive_of(name).gears.backlash_mm
    for pair, own in zip(found.pairs, drive_of(name).by_stage, strict=True):
        tolerance = own.chord_tolerance_mm
        gaps = np.array([gap_mm(pair, poses, row) for row in range(7)])
        assert gaps.min() >= -2.0 * tolerance
        assert gaps.max() <= 2.0 * tolerance + backlash
        half_tooth = pi / pair.pitch.size.driven_teeth
        assert section_at(pair.driving, poses, 0).intersects(
            section_at(pair.driven, poses, 0, half_tooth).buffer(-10.0 * tolerance)
        )


@every_geared
def test_contours_go_round_the_right_way(name: str) -> None:
    for body in (*(gear.body for gear in scene(name).gears), *scene(name).links):
        outer, *holes = (signed_area(contour) for contour in body.contours_mm)
        assert outer > 0.0
        assert all(hole < 0.0 for hole in holes)


@pytest.mark.slow
def test_pockets_hub_and_holes_are_seen() -> None:
    body = scene("webbed").pairs[0].driving.body
    # A bore and four holes; a hub, and a pocket around it with its own inner edge.
    assert len(body.contours_mm) == 1 + 1 + 4
    hub, *pocket = sorted(body.edges_mm, key=signed_size)
    assert np.hypot(*hub.T) == pytest.approx(np.full(len(hub), 10.0))
    assert len(pocket) == 2


def signed_size(ring: Array) -> float:
    return abs(float(signed_area(ring)))


@every_scene
def test_after_the_loop_every_body_is_back_and_not_before(name: str) -> None:
    found = scene(name)
    lobes = found.machine.transmission.lobes
    turns = np.arange(1, 7) * 2.0 * pi
    back = [np.allclose(offsets(found, turn), 0.0, atol=1e-12) for turn in turns]
    assert back.index(True) == round(found.loop_rad / (2.0 * pi)) - 1
    assert found.loop_rad == pytest.approx(2.0 * pi * {(1, 1): 1, (1, 2): 2, (2, 3): 3}[lobes.driving, lobes.driven])


def offsets(found: Scene, phi1: float) -> Array:
    """How far bodies are from their first poses: angles up to whole turns."""
    poses = found.poses(np.array([0.0, phi1]))
    return np.array([np.sin(np.diff(places.angle_rad) / 2.0) for places in poses.places.values()])


def test_each_stage_turns_by_its_own_angles() -> None:
    found = scene(TWO_STAGES)
    first, shaft, crank = found.shaft_angles_rad(angles(found))
    assert np.array_equal(first, angles(found))
    assert found.train.pairs[1].transmission.driven_angle(shaft).value == pytest.approx(crank, abs=2e-12)
    assert np.abs(shaft - crank).max() > 0.1


def test_material_is_pressed_left_and_renewed() -> None:
    found, linkage = scene("baler"), drive_of("baler").linkage
    # The only real zero of the published polynomial below half the stroke.
    assert found.chamber.begins_mm == pytest.approx(33.7, abs=0.05)
    extended, cycle = found.machine.extended_rad, found.machine.transmission.cycle_rad
    working = found.poses(np.linspace(0.0, extended, 50, endpoint=False)).material_mm
    rest, whole = REST * linkage.stroke_mm, (1.0 + REST) * linkage.stroke_mm - found.chamber.begins_mm
    assert working[0] == pytest.approx(whole)
    assert np.all(np.diff(working) <= 0.0)
    returning = found.poses(np.linspace(extended + 1e-9, cycle - 1e-9, 50)).material_mm
    assert returning == pytest.approx(np.full(50, rest))
    assert found.poses(np.array([cycle + 1e-9])).material_mm[0] == pytest.approx(whole)


@pytest.mark.parametrize(("name", "begins"), [("pump-1-2", 0.0), ("askew", 20.0), ("ellipse", None)])
def test_material_begins_where_the_force_does(name: str, begins: float | None) -> None:
    assert scene(name).chamber.begins_mm == (begins if begins is None else pytest.approx(begins, abs=1e-9))
    assert (scene(name).poses(np.zeros(1)).material_mm[0] > 0.0) == (begins is not None)


def test_slider_and_material_fill_the_chamber() -> None:
    found = scene("pump-1-2")
    poses, chamber = found.poses(np.linspace(0.0, 3.0, 9)), found.chamber
    face = poses.places["slider"].origin_mm[:, 0] + chamber.face_mm
    assert face + poses.material_mm == pytest.approx(np.full(9, chamber.end_mm))


def test_a_force_that_is_zero_everywhere_gives_no_material() -> None:
    drive = drive_of_text(ASKEW.replace('expression_n: "500*(x - 20)"', "polynomial_n: [0]"))
    assert chamber_of(drive.linkage, drive.machine.load).begins_mm is None


def test_a_force_on_the_way_back_has_its_material_behind_the_slider() -> None:
    """Where it acts: here over the last 60 mm, and on the way back alone; friction shows nothing."""
    found = scene("both ways")
    extended = found.machine.extended_rad
    assert (found.chamber.begins_mm, found.chamber.behind_mm) == (0.0, pytest.approx(60.0, abs=1e-6))
    out = found.poses(np.linspace(0.0, extended - 1e-9, 50))
    assert np.all(out.material_behind_mm == 0.0)
    back = found.poses(np.linspace(extended + 1e-9, found.machine.transmission.cycle_rad - 1e-9, 50))
    assert back.material_behind_mm[0] == pytest.approx(60.0, abs=1e-6)
    slider_back = back.places["slider"].origin_mm[:, 0] - found.chamber.face_mm
    met = back.motion.displacement < 60.0
    assert (slider_back - found.chamber.start_mm)[met] == pytest.approx(back.material_behind_mm[met], abs=1e-9)
    assert np.all((slider_back - found.chamber.start_mm)[~met] >= back.material_behind_mm[~met])
    assert scene("pump-1-2").chamber.behind_mm is None
    only_friction = drive_of_text(ASKEW.replace('expression_n: "500*(x - 20)"', "friction_n: 5"))
    chamber = chamber_of(only_friction.linkage, only_friction.machine.load)
    assert (chamber.begins_mm, chamber.behind_mm) == (None, None)


def passes_through(found: Scene, walls: list[Array], poses: int) -> bool:
    """Whether any link but the output meets a wall in so many poses, each looked at as an area."""
    wall = shapely.MultiLineString([LineString(line) for line in walls])
    places = found.poses(np.linspace(0.0, found.machine.transmission.cycle_rad, poses)).places
    for body in found.links[1:]:
        outline = Polygon(body.contours_mm[0])
        for (x, y), angle in zip(places[body.name].origin_mm, places[body.name].angle_rad, strict=True):
            moved = shapely.affinity.rotate(outline, float(angle), origin=(0.0, 0.0), use_radians=True)
            if shapely.affinity.translate(moved, float(x), float(y)).intersects(wall):
                return True
    return False


WALLED = [
    "uniform-crank",
    "pump-1-2",
    "pump-both-ways",
    "askew",
    "both ways",
    "scotch-yoke-pump",
    "quick-return-shaper",
]


@pytest.mark.tiers(thorough=["uniform-crank", "both ways"], rest="slow")
@pytest.mark.parametrize("name", WALLED)
def test_no_link_passes_through_a_wall(name: str) -> None:
    assert not passes_through(scene(name), walls_mm(scene(name)), 500)


def test_walls_as_long_as_the_chamber_would_be_passed_through() -> None:
    found = scene("uniform-crank")
    half = found.chamber.height_mm / 2.0
    sides = [np.array([[found.chamber.start_mm, y], [found.chamber.end_mm, y]]) for y in (-half, half)]
    assert passes_through(found, sides, 100)


def test_a_wall_begins_no_later_than_it_must() -> None:
    """By the rod's upper edge in closed form: the line through both pins, moved by half the rod's width."""
    found = scene("uniform-crank")
    linkage, half = found.machine.linkage, found.chamber.height_mm / 2.0
    gap = WALL_GAP * linkage.crank_mm
    turned = np.linspace(0.0, 2.0 * pi, 200_001)
    x, y = linkage.crank_mm * np.cos(turned), linkage.crank_mm * np.sin(turned)
    slope = np.arcsin(y / linkage.rod_mm)
    level = half - gap - ROD_WIDTH / 2.0 * linkage.crank_mm / np.cos(slope)
    over = y > level
    reached = (x + (y - level) / np.tan(np.where(over, slope, 1.0)))[over].max() + gap
    low, high = wall_starts_mm(found, found.chamber)
    assert low == pytest.approx(high, abs=1e-3 * linkage.crank_mm)
    assert high == pytest.approx(reached, abs=2e-3 * linkage.crank_mm)


def test_an_end_wall_has_an_opening_for_the_bar_of_a_yoke() -> None:
    found = scene("scotch-yoke-pump")
    ends = [line for line in walls_mm(found) if np.all(line[:, 0] == found.chamber.start_mm)]
    crank = found.machine.linkage.crank_mm
    levels = sorted(np.concatenate([line[:, 1] for line in ends]))
    opening = (ROD_WIDTH / 2.0 + WALL_GAP) * crank
    half = found.chamber.height_mm / 2.0
    assert levels == pytest.approx([-half, -opening, opening, half])


def test_straw_is_shown_where_the_file_says_so() -> None:
    assert scene("baler").chamber.straw
    assert not scene("pump-1-2").chamber.straw
    assert not scene("askew").chamber.straw
