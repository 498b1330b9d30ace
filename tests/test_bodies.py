"""Bodies: hub, set screw, web, lightening holes, chamfer and clearance against closed forms, and what has no room."""

from __future__ import annotations

import re
from dataclasses import replace
from functools import cache
from math import cos, pi, radians, sin, sqrt

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import quad
from shapely import Point, Polygon

from at_once import at_once
from drives import DESIGNS, drive, drive_of_text
from engaged import read
from ncgear.balance.gears import mesh_body
from ncgear.contact.placement import placed
from ncgear.contact.written.as_written import Outlines
from ncgear.errors import WrongInput
from ncgear.figures.summary.build_summary import bodies_summary
from ncgear.files.read_back import outline_of_stl, read_back, stl_bytes, written_outlines
from ncgear.numerics.arrays import Array
from ncgear.pitch.shape import Gear
from ncgear.project.drive import Drive
from ncgear.solids.mesh import slabs
from ncgear.solids.mesh.pair import SCREW_TOLERANCE, GearSolid, gear_solid, ring_solid, screw_hole_mm3, solid_of_plan
from ncgear.solids.mesh.slabs import bevel_of, slab_mesh
from ncgear.solids.mesh.triangles import section_rings
from ncgear.solids.plan.areas import moved_inwards
from ncgear.solids.plan.body import (
    Blank,
    Bore,
    HoleSet,
    Hub,
    Keyway,
    RingBlank,
    SetScrew,
    Slab,
    WebSize,
    body_kg_mm2,
    circle_points,
)
from ncgear.solids.plan.plan import outer_radius_mm
from ncgear.solids.plan.room import require_hub_room
from ncgear.teeth.gear import toothed_pair
from speed_against_error.outlines import circular_gear, circular_pair, form

TOLERANCE = 0.005
FINE = 1e-4
RADIUS, WIDTH = 40.0, 12.0
MODULE = 2.0


def disc(radius: float = RADIUS, tolerance: float = FINE) -> Array:
    return circle_points(radius, tolerance)


def made(blank: Blank, tolerance: float = FINE, outline: Array | None = None) -> GearSolid:
    return gear_solid(Gear.DRIVING, disc() if outline is None else outline, blank, MODULE, tolerance)


def sections(solid: GearSolid, height: float) -> list[Array]:
    """What is left of a solid at a height after it was written as STL and read again."""
    mesh = read_back(stl_bytes(solid.mesh), solid.mesh)
    return section_rings(np.asarray(mesh.vertices), np.asarray(mesh.faces), height)


def section(solid: GearSolid, height: float) -> Polygon:
    outer, *holes = sorted(sections(solid, height), key=lambda ring: -Polygon(ring).area)
    return Polygon(outer, holes)


# --- hub and set screw -----------------------------------------------------------------------------------------------


def test_a_hub_is_a_cylinder_on_the_upper_face_with_the_bore_through_it() -> None:
    solid = made(Blank(WIDTH, Bore(10.0), hub=Hub(24.0, 7.0)))
    expected = pi * (RADIUS**2 - 5.0**2) * WIDTH + pi * (12.0**2 - 5.0**2) * 7.0
    assert solid.mesh.volume == pytest.approx(expected, rel=2e-5)
    assert solid.mesh.bounds[:, 2].tolist() == [0.0, WIDTH + 7.0]
    assert section(solid, WIDTH - 0.1).area == pytest.approx(pi * (RADIUS**2 - 25.0), rel=2e-5)
    assert section(solid, WIDTH + 0.1).area == pytest.approx(pi * (144.0 - 25.0), rel=1e-4)


def hole_volume(screw_radius: float, outer: float, inner: float | None, floor: float = 0.0) -> float:
    """A round hole across from a cylinder's outside to a bore about the axis, or to a keyway's floor."""

    def length(y: float) -> float:
        return sqrt(outer**2 - y**2) - (floor if inner is None else sqrt(inner**2 - y**2))

    return quad(lambda y: 2.0 * sqrt(screw_radius**2 - y**2) * length(y), -screw_radius, screw_radius)[0]


@pytest.mark.tiers(quick=["-143.0"], rest="slow")
@pytest.mark.parametrize("direction", [0.0, 90.0, -143.0])
def test_a_set_screw_takes_the_volume_of_crossing_cylinders(direction: float) -> None:
    """The hole ends in the bore's far side nowhere: it is cut out of one side only."""
    screw = SetScrew(3.3, WIDTH + 4.0, radians(direction))
    hub = Hub(24.0, 9.0)
    whole, drilled = (made(Blank(WIDTH, Bore(10.0), hub=one)).mesh for one in (hub, replace(hub, set_screw=screw)))
    assert whole.volume - drilled.volume == pytest.approx(hole_volume(1.65, 12.0, 5.0), rel=2e-3)
    across = np.array([cos(radians(direction)), sin(radians(direction))])
    new = np.asarray(drilled.vertices)[~np.isin(np.round(drilled.vertices[:, 2], 6), np.round(whole.vertices[:, 2], 6))]
    assert len(new) > 40
    assert np.all(new[:, :2] @ across > 0.0)
    assert np.abs(np.hypot(new[:, :2] @ [-across[1], across[0]], new[:, 2] - WIDTH - 4.0) - 1.65).max() < 2.0 * FINE


@pytest.mark.slow
def test_a_set_screw_over_the_keyway_is_as_long_as_the_wall_there() -> None:
    hub = Hub(24.0, 9.0, SetScrew(3.0, WIDTH + 4.5, 0.0))
    bore = Bore(10.0, Keyway(4.0, 1.8))
    whole = made(Blank(WIDTH, bore, hub=replace(hub, set_screw=None))).mesh.volume
    taken = whole - made(Blank(WIDTH, bore, hub=hub)).mesh.volume
    assert taken == pytest.approx(hole_volume(1.5, 12.0, None, 6.8), rel=2e-3)


@pytest.mark.slow
@at_once("tolerance", [0.05, 0.005])
@at_once("diameter", [1.0, 9.0])
def test_the_quadrature_that_judges_a_screw_hole_has_digits_to_spare(tolerance: float, diameter: float) -> None:
    """Against the same cut by booleans, to a tenth of what is allowed."""
    screw = SetScrew(diameter, WIDTH + 6.0, 0.7)
    blank = Blank(WIDTH, Bore(10.0, Keyway(3.0, 1.4)), hub=Hub(24.0, 12.0))
    whole = made(blank, tolerance)
    drilled = solid_of_plan(replace(whole.plan, hub=replace(whole.plan.hub, set_screw=screw)))
    taken = screw_hole_mm3(whole.plan.slabs[-1].section, screw, tolerance)
    assert whole.mesh.volume - drilled.mesh.volume == pytest.approx(taken, rel=SCREW_TOLERANCE / 10.0)


# --- web and holes ---------------------------------------------------------------------------------------------------


@pytest.mark.slow
def test_pockets_of_a_round_gear_are_rings_between_hub_and_rim() -> None:
    solid = made(Blank(WIDTH, Bore(10.0), web=WebSize(4.0, 5.0, 20.0)))
    ring = pi * ((RADIUS - 5.0) ** 2 - 10.0**2)
    assert solid.mesh.volume == pytest.approx(pi * (RADIUS**2 - 25.0) * WIDTH - ring * (WIDTH - 4.0), rel=1e-4)
    assert len(sections(solid, 3.9)) == 2
    assert len(sections(solid, 4.1)) == 4


@pytest.mark.tiers(slow=["baler-driving"], rest="quick")
@pytest.mark.parametrize("gear", ["driving", "driven"])
@pytest.mark.parametrize("name", ["baler", "pump-1-2"])
def test_pockets_follow_the_outline_and_keep_the_rim(name: str, gear: str) -> None:
    """The least wall is the rim's, and it is reached all around, not only at one place."""
    blank = Blank(WIDTH, Bore(8.0), index_hole=True, web=WebSize(4.0, 3.0, 16.0))
    plan = made(blank, TOLERANCE, getattr(drive(name).teeth, gear).outline_mm).plan
    assert plan.web is not None
    pockets, outline = shapely.union_all(plan.web.pockets), plan.disc.exterior
    assert 3.0 <= pockets.distance(outline) <= 3.0 + 3.0 * TOLERANCE
    assert pockets.distance(Point(0.0, 0.0)) >= 8.0
    if plan.index_hole is not None:
        hole = Point(plan.index_hole.x_mm, plan.index_hole.y_mm)
        assert pockets.distance(hole) - plan.index_hole.diameter_mm / 2.0 >= MODULE - TOLERANCE
    sides = [shapely.box(-200.0, -200.0, 200.0, 0.0), shapely.box(-200.0, 0.0, 200.0, 200.0)]
    assert all((pockets & side).distance(outline & side) <= 3.0 + 3.0 * TOLERANCE for side in sides)


def test_few_holes_fill_the_way_from_bore_to_outline() -> None:
    holes = made(Blank(WIDTH, Bore(10.0), holes=HoleSet(3, 4.0))).plan.lightening_holes
    assert [hole.diameter_mm for hole in holes] == pytest.approx([RADIUS - 5.0 - 2.0 * 4.0] * 3, abs=0.011)


ASKED = [
    Blank(WIDTH, Bore(8.0), holes=HoleSet(5, 3.0)),
    Blank(WIDTH, Bore(8.0, Keyway(3.0, 1.4)), True, Hub(18.0, 5.0), holes=HoleSet(4, 2.0, 5.0)),
    Blank(WIDTH, Bore(8.0), True, Hub(16.0, 5.0), WebSize(4.0, 2.5, 16.0), HoleSet(6, 1.5)),
    Blank(WIDTH, holes=HoleSet(1, 3.0)),
]


@pytest.mark.slow
@pytest.mark.parametrize("blank", ASKED)
def test_holes_keep_their_walls(blank: Blank) -> None:
    plan = made(blank, TOLERANCE, drive("printed-pump").teeth.driving.outline_mm).plan
    assert blank.holes is not None
    assert len(plan.lightening_holes) == blank.holes.count
    circles = [Point(hole.x_mm, hole.y_mm).buffer(hole.diameter_mm / 2.0, quad_segs=64) for hole in plan.round_holes]
    others = [plan.disc.exterior, plan.bore_polygon]
    if plan.hub is not None:
        others.append(Point(0.0, 0.0).buffer(plan.hub.diameter_mm / 2.0))
    if plan.web is not None:
        others += [pocket.boundary for pocket in plan.web.pockets]
    least = blank.holes.wall_mm
    for number, circle in enumerate(circles[-len(plan.lightening_holes) :]):
        rest = circles[: len(circles) - len(plan.lightening_holes) + number]
        assert all(circle.distance(other) >= least for other in [*others, *rest] if not other.is_empty)


# --- chamfer ---------------------------------------------------------------------------------------------------------


CHAMFERED = [("pump-1-2", "driven", 0.3), ("baler", "driving", 0.4)]


@pytest.mark.slow
@pytest.mark.parametrize(("name", "gear", "chamfer"), CHAMFERED)
def test_sections_of_the_chamfer_are_parallels_of_the_outline(name: str, gear: str, chamfer: float) -> None:
    """At every height, to the chord tolerance and both ways, judged by shapely on what was written."""
    blank = Blank(WIDTH, Bore(8.0, Keyway(3.0, 1.4)), True, chamfer_mm=chamfer)
    solid = made(blank, TOLERANCE, getattr(drive(name).teeth, gear).outline_mm)
    for height in chamfer * np.array([0.02, 0.35, 0.6, 0.95]):
        found = section(solid, height)
        expected = solid.plan.section.buffer(height - chamfer, join_style="mitre", mitre_limit=10.0)
        assert found.difference(expected.buffer(TOLERANCE)).is_empty
        assert expected.difference(found.buffer(TOLERANCE)).is_empty
    assert section(solid, chamfer + 1e-4).symmetric_difference(solid.plan.section).area < 1e-2


@pytest.mark.thorough
def test_volume_of_the_chamfer_is_the_integral_of_its_sections() -> None:
    solid = made(Blank(WIDTH, Bore(8.0), chamfer_mm=0.4), TOLERANCE, drive("pump-1-2").teeth.driven.outline_mm)
    whole = solid.plan.section
    lost = quad(lambda z: whole.area - whole.buffer(z - 0.4, join_style="mitre", mitre_limit=10.0).area, 0.0, 0.4)[0]
    assert whole.area * WIDTH - solid.mesh.volume == pytest.approx(lost, rel=1e-6)


@pytest.mark.slow
def test_a_chamfer_without_levels_strays_where_edges_vanish(monkeypatch: pytest.MonkeyPatch) -> None:
    """Negative control: with one slope from top to bottom a tip of the baler's is cut off."""
    area = Polygon(drive("baler").teeth.driving.outline_mm)
    assert len(bevel_of(area, 0.5, 2.0 * TOLERANCE, "key").slopes) > 1
    monkeypatch.setattr(slabs, "_close", lambda *_: True)
    coarse = bevel_of(area, 0.5, 2.0 * TOLERANCE, "key")
    mesh = slab_mesh((Slab(area, 0.0, WIDTH),), coarse)
    found = Polygon(section_rings(np.asarray(mesh.vertices), np.asarray(mesh.faces), 0.25)[0])
    expected = area.buffer(-0.25, join_style="mitre", mitre_limit=10.0)
    assert (
        not expected.difference(found.buffer(2.0 * TOLERANCE)).is_empty
        or not found.difference(expected.buffer(2.0 * TOLERANCE)).is_empty
    )


# --- clearance -------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("clearance", [0.02, 0.1, 0.2])
def test_outlines_recede_from_the_exact_teeth_by_the_clearance(clearance: float) -> None:
    """Every point of what is written stands so far from the closed form of a circular gear, and inside of it."""
    teeth = toothed_pair(circular_pair(), form(), TOLERANCE)
    blank = Blank(WIDTH, clearance_mm=clearance)
    solid = made(blank, TOLERANCE, teeth.driving.outline_mm)
    found = outline_of_stl(stl_bytes(solid.mesh), WIDTH / 2.0)
    exact = circular_gear()
    assert shapely.contains_xy(Polygon(teeth.driving.outline_mm), found).all()
    corners = found[np.hypot(*found.T) < exact.tip_radius_mm - clearance - TOLERANCE]
    assert exact.distance_mm(corners) == pytest.approx(clearance, abs=1.1 * TOLERANCE)
    assert np.hypot(*found.T).max() == pytest.approx(exact.tip_radius_mm - clearance, abs=TOLERANCE)


def test_bore_and_keyway_widen_by_the_clearance_on_every_side() -> None:
    bore = Bore(10.0, Keyway(3.0, 1.4)).widened(0.1)
    assert (bore.diameter_mm, bore.reach_mm) == (pytest.approx(10.2), pytest.approx(5.0 + 1.4 + 0.1))
    assert bore.keyway is not None
    assert bore.keyway.width_mm == pytest.approx(3.2)


@pytest.mark.slow
@pytest.mark.parametrize("internal", [False, True])
def test_parts_just_as_written_lag_by_two_clearances_over_the_lever(internal: bool) -> None:
    """What the summary says of a process that takes nothing: measured on the drawn-in outlines themselves."""
    made_of, clearance = drive("internal-1-2" if internal else "printed-pump"), 0.05
    designed, pitch, teeth = made_of.designed_contact, made_of.pitch, made_of.teeth
    moved = []
    for gear in (teeth.driving, teeth.driven):
        inwards = -clearance if gear.flanks.curve.gear is Gear.DRIVING or not internal else clearance
        moved.append(shapely.get_coordinates(Polygon(gear.outline_mm).buffer(inwards, join_style="mitre"))[:-1][::-1])
    moved = [ring if Polygon(ring).exterior.is_ccw else ring[::-1] for ring in moved]
    found = read(Outlines("moved in", *moved), pitch, teeth, placed(pitch))
    lag = np.abs(found.pushing_rad - designed.pushing.error_rad)
    expected = 2.0 * clearance / designed.pushing.first.lever_mm
    assert np.abs(lag - expected).max() <= 3.0 * TOLERANCE / designed.placement.driven_radius_mm.min()
    if not internal:
        assert bodies_summary(made_of)["lag_max_without_process_rad"] == pytest.approx(float(expected.max()))


# --- kerf ------------------------------------------------------------------------------------------------------------

KERFED = {
    "plate": "  process_clearance_mm: {}\n  driving: {{bore_mm: 10, "
    "lightening_holes: {{count: 4, least_wall_mm: 3, diameter_mm: 6}}}}",
    "web": "  process_clearance_mm: {}\n  driving: {{bore_mm: 8, web: {{thickness_mm: 3, rim_mm: 3, hub_mm: 20}}}}",
}


def cut_along(drawn: Polygon, kerf: float) -> Polygon:
    """What a round cutter leaves inside of drawn lines that its centre follows."""
    return drawn.difference(drawn.boundary.buffer(kerf / 2.0, quad_segs=64))


def sections_of(drive: Drive) -> list[Polygon]:
    return [drive.solids.of(gear).plan.section for gear in Gear]


@pytest.mark.judges("solids")
@pytest.mark.tiers(slow=["web", "plate"], rest="long")
@pytest.mark.parametrize("name", [*KERFED, "internal-1-2"])
def test_a_cutter_that_follows_the_lines_leaves_the_gears_at_size(name: str) -> None:
    """Area and distance of what is left, against the design without kerf; with the other sign both are far off."""

    def at(clearance: float) -> Drive:
        if name in KERFED:
            return asked(KERFED[name].format(clearance))
        # Without keyway, whose corners every round cutter leaves round.
        text = re.sub(r"keyway: *\{.*?\},? *", "", (DESIGNS / f"{name}.yaml").read_text())
        return drive_of_text(text.replace("gears:\n", f"gears:\n  process_clearance_mm: {clearance}\n"))

    kerf = 0.2
    for finished, drawn, other in zip(*(sections_of(at(c)) for c in (0.0, -kerf / 2.0, kerf / 2.0)), strict=True):
        left = cut_along(drawn, kerf)
        assert left.boundary.hausdorff_distance(finished.boundary) < 2.0 * TOLERANCE
        assert left.area == pytest.approx(finished.area, abs=TOLERANCE * finished.length)
        assert drawn.area == pytest.approx(finished.area + kerf / 2.0 * finished.length, rel=0.01)
        assert cut_along(other, kerf).boundary.hausdorff_distance(finished.boundary) > 0.9 * kerf


@pytest.mark.thorough
def test_bore_and_keyway_are_drawn_narrower_by_the_kerf() -> None:
    bores = [
        asked(
            f"  process_clearance_mm: {c}\n  driving: {{bore_mm: 10, keyway: {{width_mm: 3, depth_mm: 1.4}}}}"
        ).solids.driving.plan.bore
        for c in (0.0, -0.1)
    ]
    assert bores[1] == bores[0].widened(-0.1)
    assert bores[1].keyway.width_mm == pytest.approx(2.8)
    assert bores[1].reach_mm == pytest.approx(5.0 + 1.4 - 0.1)


@pytest.mark.slow
def test_contact_as_written_is_that_of_the_gears_after_the_cut() -> None:
    drive = asked(KERFED["web"].format(-0.15))
    solid, outline = drive.solids.driving, drive.teeth.driving.outline_mm
    files = {"driving.stl": stl_bytes(solid.mesh), "driven.stl": stl_bytes(drive.solids.driven.mesh)}
    files |= dict.fromkeys(("driving.csv", "driven.csv"), b"x_mm,y_mm\n0,0\n1,0\n0,1\n")
    written = written_outlines(files, drive.solids)[1].driving_mm
    assert Polygon(written).boundary.hausdorff_distance(Polygon(outline).boundary) < TOLERANCE
    assert bodies_summary(drive)["kerf_mm"] == 0.3
    assert "lag_max_without_process_rad" not in bodies_summary(drive)


@pytest.mark.tiers(slow=["process_clearance_mm: -0.9*"], rest="quick")
@pytest.mark.parametrize(
    ("text", "problem"),
    [
        ("process_clearance_mm: -0.9", r"a kerf of 1\.8 mm is wider than the narrowest fillet or space of the gear; -"),
        (
            "process_clearance_mm: -0.5\n  driving: {bore_mm: 8, keyway: {width_mm: 0.9, depth_mm: 1}}",
            r"a kerf of 1 mm does not go into a keyway of 0\.9 mm; over -0\.45 mm is right",
        ),
        (
            "process_clearance_mm: -0.5\n  driving: {bore_mm: 0.8}\n  driven: {bore_mm: 0.7}",
            r"a kerf of 1 mm does not go into a bore of 0\.7 mm; over -0\.35 mm is right",
        ),
        ("process_clearance_mm: -0.5\n  driving: {bore_mm: 0.8}", r"a kerf of 1 mm does not go into a bore of 0\.8 mm"),
    ],
)
def test_a_kerf_that_is_too_wide_is_refused_with_the_widest_that_goes_in(text: str, problem: str) -> None:
    with pytest.raises(WrongInput, match=problem) as caught:
        asked(f"  {text}").solids  # noqa: B018
    assert caught.value.key == "gears.process_clearance_mm"
    if "is the most" in caught.value.problem:
        most = float(re.search(r"; (\S+) mm, a kerf", caught.value.problem)[1])
        assert asked(f"  process_clearance_mm: {most}").solids.driving.mesh.is_watertight
        with pytest.raises(WrongInput):
            asked(f"  process_clearance_mm: {most - 0.03}").solids  # noqa: B018


def test_what_moves_in_comes_back() -> None:
    area = Polygon(drive("baler").teeth.driving.outline_mm)
    inner = moved_inwards(area, 0.1, TOLERANCE, "key")
    back = inner.buffer(0.1, join_style="mitre")
    assert area.boundary.hausdorff_distance(back.boundary) <= TOLERANCE


# --- masses ----------------------------------------------------------------------------------------------------------


@pytest.mark.slow
@pytest.mark.parametrize("blank", ASKED)
def test_moments_of_inertia_count_all_that_is_cut(blank: Blank) -> None:
    """Slab by slab, against the mesh's own volume integrals."""
    solid = made(blank, TOLERANCE, drive("printed-pump").teeth.driving.outline_mm)
    assert body_kg_mm2(solid.plan, 7850.0) == pytest.approx(mesh_body(solid.triangles, 7850.0).inertia_kg_mm2, rel=1e-9)


@pytest.mark.slow
def test_chamfer_and_set_screw_that_are_not_counted_are_small() -> None:
    solid = drive("printed-pump").solids.driving
    counted, whole = body_kg_mm2(solid.plan, 7850.0), mesh_body(solid.triangles, 7850.0).inertia_kg_mm2
    assert 0.0 < counted - whole < 0.01 * whole


# --- what has no room ------------------------------------------------------------------------------------------------


BASE = (DESIGNS / "printed-pump.yaml").read_text()
GEARS = BASE[: BASE.index("  first_layer_chamfer_mm")]


@cache
def plain_pump() -> Drive:
    return drive_of_text(GEARS)


def asked(text: str) -> Drive:
    """The printed pump with other bodies; what does not hang on them is computed once."""
    _ = plain_pump().teeth
    own = drive_of_text(GEARS + text)
    vars(own).update({name: vars(plain_pump())[name] for name in ("law", "pitch", "tooth_form", "teeth")})
    return own


NO_ROOM = [
    ("driving: {{hub: {{diameter_mm: {}, height_mm: 5}}}}", 60.0, "driving.hub.diameter_mm", "reaches over the tooth"),
    (
        "driven: {{bore_mm: 8, web: {{thickness_mm: 3, rim_mm: {}, hub_mm: 20}}}}",
        20.0,
        "driven.web.rim_mm",
        "leaves no room for a pocket beside a hub of 20 mm",
    ),
    (
        "driven: {{bore_mm: 8, lightening_holes: {{count: 5, least_wall_mm: 3, diameter_mm: {}}}}}",
        20.0,
        "driven.lightening_holes.diameter_mm",
        "5 holes of 20 mm do not keep walls of 3 mm",
    ),
    ("first_layer_chamfer_mm: {}", 2.0, "first_layer_chamfer_mm", "2 mm off the edges"),
    ("process_clearance_mm: {}", 1.5, "process_clearance_mm", r"1\.5 mm off the edges"),
    (
        "process_clearance_mm: 0.2\n  driving: {{bore_mm: {}}}",
        55.0,
        "driving.bore_mm",
        "leaves less than 2 mm, one module",
    ),
]


@pytest.mark.tiers(thorough=["driving: {{hub*"], rest="slow")
@pytest.mark.parametrize(("text", "given", "key", "problem"), NO_ROOM)
def test_what_does_not_fit_is_refused_with_the_largest_that_does(
    text: str, given: float, key: str, problem: str
) -> None:
    with pytest.raises(WrongInput, match=problem) as caught:
        asked("  " + text.format(given)).solids  # noqa: B018
    assert caught.value.key == f"gears.{key}"
    stated = float(re.search(r"largest that fits is (\S+) mm", caught.value.problem)[1])
    assert asked("  " + text.format(stated)).solids.driving.mesh.is_watertight
    with pytest.raises(WrongInput):
        asked("  " + text.format(stated + 0.03)).solids  # noqa: B018


@pytest.mark.slow
@pytest.mark.parametrize(
    ("text", "key", "problem"),
    [
        (
            "driving: {bore_mm: 8, lightening_holes: {count: 3, least_wall_mm: 20}}",
            "driving.lightening_holes",
            "3 holes do not keep walls of 20 mm to every edge and to each other; none fit; fewer holes, thinner walls",
        ),
        (
            "driving: {bore_mm: 8, web: {thickness_mm: 3, rim_mm: 1, hub_mm: 70}}",
            "driving.web.rim_mm",
            "there is none beside any rim; a smaller hub_mm or a larger gear is needed",
        ),
    ],
)
def test_where_nothing_fits_the_message_says_what_to_change(text: str, key: str, problem: str) -> None:
    with pytest.raises(WrongInput, match=problem) as caught:
        asked("  " + text).solids  # noqa: B018
    assert caught.value.key == f"gears.{key}"


HELIX = "helix: {angle_deg: 10, kind: helical, hand: left}"
SCREW = "hub: {{diameter_mm: 20, height_mm: 6, set_screw: {{{}}}}}"

WRONG = [
    ("driving: {hub: {diameter_mm: 0, height_mm: 3}}", "driving.hub.diameter_mm", "0"),
    ("driving: {bore_mm: 8, web: {thickness_mm: 3, rim_mm: 3}}", "driving.web", "given without web.hub_mm or hub"),
    (
        "driving: {hub: {diameter_mm: 20, height_mm: 3}, web: {thickness_mm: 3, rim_mm: 3, hub_mm: 19}}",
        "driving.web.hub_mm",
        "20 mm or over is right",
    ),
    ("driving: {web: {thickness_mm: 10, rim_mm: 3, hub_mm: 9}}", "driving.web.thickness_mm", "under 10 mm is right"),
    ("driving: {" + SCREW.format("diameter_mm: 3") + "}", "driving.hub.set_screw", "given without bore_mm"),
    (
        "driving: {bore_mm: 2, " + SCREW.format("diameter_mm: 3") + "}",
        "driving.hub.set_screw.diameter_mm",
        "under 2 mm",
    ),
    (
        "driving: {bore_mm: 8, " + SCREW.format("diameter_mm: 6") + "}",
        "driving.hub.set_screw.diameter_mm",
        "under 6 mm",
    ),
    (
        "driving: {bore_mm: 8, " + SCREW.format("diameter_mm: 3, height_mm: 5") + "}",
        "driving.hub.set_screw.height_mm",
        "between 1.5 and 4.5 mm is right",
    ),
    ("driving: {lightening_holes: {count: 0, least_wall_mm: 1}}", "driving.lightening_holes.count", "0"),
    ("driving: {lightening_holes: {count: 3}}", "driving.lightening_holes.least_wall_mm", "missing"),
    *(
        (f"mesh: internal\n  driven: {{{part}}}", f"driven.{part.split(':')[0]}", f"a ring .* has no {name}")
        for part, name in (
            ("hub: {diameter_mm: 20, height_mm: 3}", "hub"),
            ("web: {thickness_mm: 3, rim_mm: 3, hub_mm: 9}", "web"),
            ("lightening_holes: {count: 3, least_wall_mm: 1}", "lightening holes"),
        )
    ),
]


@at_once(("text", "key", "problem"), WRONG)
def test_wrong_bodies_are_refused_with_their_place(text: str, key: str, problem: str) -> None:
    with pytest.raises(WrongInput, match=problem) as caught:
        asked("  " + text)
    assert caught.value.key == f"gears.{key}"
    assert caught.value.location


AROUND_BORE = [
    ("bore_mm: 12, hub: {{diameter_mm: {}, height_mm: 3}}", "hub.diameter_mm", 16.0),
    ("bore_mm: 8, web: {{thickness_mm: 3, rim_mm: 3, hub_mm: {}}}", "web.hub_mm", 12.0),
    # Twice the way to the keyway's corner, hypot(8, 3), and two modules.
    (
        "bore_mm: 8, keyway: {{width_mm: 6, depth_mm: 4}}, hub: {{diameter_mm: {}, height_mm: 3}}",
        "hub.diameter_mm",
        21.09,
    ),
]


@pytest.mark.slow
@pytest.mark.parametrize(("text", "key", "least"), AROUND_BORE)
def test_what_stands_about_the_axis_keeps_a_module_around_the_bore(text: str, key: str, least: float) -> None:
    def body(size: float) -> Drive:
        return asked("  driving: {" + text.format(size) + "}")

    with pytest.raises(WrongInput, match=rf"one module, .*; {least:g} mm or more is right") as caught:
        body(least - 0.01).solids  # noqa: B018
    assert caught.value.key == f"gears.driving.{key}"
    assert body(least).solids.driving.mesh.is_watertight


OF_PROCESS = [
    (
        "process_clearance_mm: 0.5\n  driving: {bore_mm: 12, hub: {diameter_mm: 16.9, height_mm: 3}}",
        "driving.hub.diameter_mm",
        "17 mm or more is right",
    ),
    (
        "first_layer_chamfer_mm: 3\n  driven: {web: {thickness_mm: 3, rim_mm: 3, hub_mm: 9}}",
        "first_layer_chamfer_mm",
        "as high as the driven gear's web; under 3 mm",
    ),
    ("first_layer_chamfer_mm: 10", "first_layer_chamfer_mm", "as high as the gear; under 10 mm"),
    ("first_layer_chamfer_mm: 2.9", "first_layer_chamfer_mm", "more than half of the thinnest part"),
    ("process_clearance_mm: 1.9", "process_clearance_mm", "more than half of the thinnest part"),
    ("process_clearance_mm: -1.9", "process_clearance_mm", "kerf"),
    (f"{HELIX}\n  first_layer_chamfer_mm: 1", "first_layer_chamfer_mm", "helical"),
    (f"{HELIX}\n  process_clearance_mm: 1", "process_clearance_mm", "helical"),
]


@pytest.mark.slow
@pytest.mark.parametrize(("text", "key", "problem"), OF_PROCESS)
def test_what_the_process_wants_blocks_the_files_alone(text: str, key: str, problem: str) -> None:
    """Moments of inertia, and so all forces, are those of the gears as they come out: the process changes nothing."""
    made = asked("  " + text)
    plain = asked("  " + re.sub(r"(first_layer_chamfer|process_clearance)_mm: [-0-9.]+", r"\g<1>_mm: 0", text))
    assert made.gear_inertia.driving_kg_mm2 == plain.gear_inertia.driving_kg_mm2
    assert made.gear_inertia.driven_kg_mm2 == plain.gear_inertia.driven_kg_mm2
    assert made.gear_inertia.refusal is None
    assert made.gear_inertia.driven_kg_mm2 > 0.0
    with pytest.raises(WrongInput, match=problem) as caught:
        made.solids  # noqa: B018
    assert caught.value.key == f"gears.{key}"


@pytest.mark.parametrize("name", ["printed-pump", "pump-1-2", "baler"])
def test_the_largest_hubs_of_a_pair_do_not_meet(name: str) -> None:
    made_of, largest = drive(name), []
    for gear in (made_of.teeth.driving, made_of.teeth.driven):
        with pytest.raises(WrongInput, match="reaches over the tooth spaces") as caught:
            require_hub_room(Polygon(gear.outline_mm), Hub(1000.0, 5.0), "gears.driving")
        largest.append(float(caught.value.problem.split("largest that fits is ")[1].split(" mm")[0]))
    assert sum(largest) / 2.0 < made_of.pitch.center_distance_mm


LENGTHS = st.floats(0.2, 30.0)
BORES = st.builds(Bore, st.floats(4.0, 20.0), st.none() | st.builds(Keyway, st.floats(0.5, 3.5), st.floats(0.2, 3.0)))
SCREWS = st.builds(SetScrew, st.floats(0.5, 3.0), st.floats(WIDTH + 1.6, WIDTH + 2.4), st.floats(-7.0, 7.0))
BLANKS = st.builds(
    Blank,
    st.just(WIDTH),
    BORES,
    st.booleans(),
    hub=st.none() | st.builds(Hub, st.floats(28.0, 60.0), st.just(4.0), st.none() | SCREWS),
    web=st.none() | st.builds(WebSize, st.floats(1.5, 11.0), st.floats(0.5, 8.0), st.just(60.0) | st.just(34.0)),
    holes=st.none() | st.builds(HoleSet, st.integers(1, 12), st.floats(0.3, 5.0), st.none() | LENGTHS),
    chamfer_mm=st.just(0.0) | st.floats(0.05, 1.2),
    clearance_mm=st.just(0.0) | st.floats(0.005, 0.4),
)


@pytest.mark.long
@pytest.mark.slow
@settings(max_examples=60, deadline=None)
@given(blank=BLANKS, name=st.sampled_from(["baler", "pump-1-2", "printed-pump"]))
def test_every_body_is_sound_or_refused(blank: Blank, name: str) -> None:
    """Closed, of the volume of its parts, and the same after it was written and read; or refused with a key."""
    if blank.web is not None and blank.hub is not None:
        blank = replace(blank, web=replace(blank.web, hub_mm=max(blank.web.hub_mm, blank.hub.diameter_mm)))
    try:
        solid = made(blank, TOLERANCE, drive(name).teeth.driven.outline_mm)
    except WrongInput as refused:
        assert refused.key.startswith("gears.")
    else:
        assert read_back(stl_bytes(solid.mesh), solid.mesh).is_watertight


# --- helical teeth, rings, balance -----------------------------------------------------------------------------------


HELICAL = """\
name: helical
linkage: {crank_mm: 25, rod_mm: 90}
operation: {speed_rpm: 150}
motion: {law: ellipse, eccentricity: 0.2, phase_deg: 180}
gears:
  teeth: 19
  module_mm: 2
  face_width_mm: 6
  helix: {angle_deg: 12, kind: helical, hand: right}
  driving:
    bore_mm: 6
    hub: {diameter_mm: 14, height_mm: 5, set_screw: {diameter_mm: 2.5, direction_deg: 30}}
    web: {thickness_mm: 3, rim_mm: 2}
  driven:
    bore_mm: 6
    lightening_holes: {count: 4, least_wall_mm: 1.5}
output: {chord_tolerance_mm: 0.02}
"""


@pytest.mark.slow
def test_helical_gears_have_the_same_bodies() -> None:
    """Their cuts go straight through every section; volumes add up."""
    solids = drive_of_text(HELICAL).solids
    plan, mesh = solids.driving.plan, solids.driving.mesh
    assert plan.hub is not None
    assert plan.hub.set_screw is not None
    assert plan.web is not None
    pocket = sum(float(pocket.area) for pocket in plan.web.pockets)
    bare = drive_of_text(HELICAL[: HELICAL.index("    hub:")] + "output: {chord_tolerance_mm: 0.02}\n").solids
    added = (pi * 7.0**2 - pi * 3.0**2) * 5.0 - hole_volume(1.25, 7.0, 3.0) - pocket * 3.0
    assert mesh.volume - bare.driving.mesh.volume == pytest.approx(added, rel=5e-3)
    assert mesh.is_watertight
    for hole in solids.driven.plan.lightening_holes:
        for height in (0.5, 3.0, 5.5):
            around = section(solids.driven, height)
            wall = around.exterior.distance(Point(hole.x_mm, hole.y_mm)) - hole.diameter_mm / 2.0
            assert wall >= 1.5 - 0.02


@pytest.mark.slow
def test_a_ring_is_chamfered_inside_and_outside_and_its_teeth_recede() -> None:
    outline, rim = drive("printed-pump").teeth.driving.outline_mm, 6.0
    whole = Polygon(circle_points(outer_radius_mm(outline, rim), TOLERANCE), [outline])
    cut = ring_solid(outline, RingBlank(WIDTH, rim, chamfer_mm=0.3, clearance_mm=0.05), MODULE, TOLERANCE)
    drawn = section(cut, 5.0)
    assert drawn.exterior.hausdorff_distance(whole.exterior) <= 2.0 * TOLERANCE
    expected = Polygon(outline).buffer(0.05, join_style="mitre")
    assert expected.exterior.hausdorff_distance(drawn.interiors[0]) <= TOLERANCE
    foot = section(cut, 1e-4)
    assert foot.symmetric_difference(drawn.buffer(-0.3, join_style="mitre")).area <= 1e-3 * drawn.area


@pytest.mark.thorough
def test_the_index_hole_passes_by_the_hub() -> None:
    outline = drive("printed-pump").teeth.driving.outline_mm
    plan = made(Blank(WIDTH, Bore(8.0), True, Hub(50.0, 5.0)), TOLERANCE, outline).plan
    assert plan.index_hole is not None
    assert plan.index_hole.x_mm - plan.index_hole.diameter_mm / 2.0 >= 25.0 + MODULE - TOLERANCE
    assert made(Blank(WIDTH, None, True, Hub(2.0 * (RADIUS - 3.0 * MODULE) - 0.1, 5.0))).plan.index_hole is not None
    assert made(Blank(WIDTH, None, True, Hub(2.0 * (RADIUS - 3.0 * MODULE) + 0.1, 5.0))).plan.index_hole is None
