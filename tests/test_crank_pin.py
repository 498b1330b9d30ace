"""A crank pin's hole in the driven gear: where the crank's pin is in every pose, in every file, and only with room.

The judges are the places of crank and gear in the moving scene, what is read back from files, and polygons of shapely.
"""

from __future__ import annotations

import io
from dataclasses import replace
from functools import cache
from math import hypot, pi

import ezdxf
import numpy as np
import pytest
import trimesh
from shapely import Point

from drives import drive_of_text
from ncgear.drawings.scene.scene import scene_of
from ncgear.errors import WrongInput
from ncgear.figures.assembly import assembly_of
from ncgear.figures.data_sheet.sheet import data_sheet
from ncgear.figures.summary.build_summary import bodies_summary
from ncgear.files.workshop.drawing import pair_drawings
from ncgear.files.workshop.dxf import dxf_files
from ncgear.files.workshop.svg import svg_files
from ncgear.project.drive import Drive
from scenes import carried

LINKAGES = {
    "crank-slider": "{crank_mm: 26, rod_mm: 120, offset_mm: 9}",
    "yoke": "{kind: scotch_yoke, crank_mm: 25}",
    "rocker": "{kind: crank_rocker, crank_mm: 24, coupler_mm: 110, rocker_mm: 80, ground_mm: 120}",
    "lever": "{kind: slotted_lever, crank_mm: 26, pivot_mm: 80, lever_mm: 150}",
}

TEXT = """
name: pinned
linkage: {linkage}
operation: {{speed_rpm: 60}}
motion: {{law: ratio_expression, ratio: "1 - 0.2*cos(2*phi)", scale_to_close: true}}
gears:
  teeth: 40
  module_mm: 2
  face_width_mm: 10
  driving_axis_deg: {axis}
  index_holes: true
  process_clearance_mm: {clearance}
  driven: {{bore_mm: 10, crank_pin: {{diameter_mm: {pin}}}{more}}}
"""


@cache
def pinned(
    kind: str = "crank-slider", axis: float = 180.0, pin: float = 6.0, clearance: float = 0.0, more: str = ""
) -> Drive:
    return drive_of_text(TEXT.format(linkage=LINKAGES[kind], axis=axis, pin=pin, clearance=clearance, more=more))


@pytest.mark.judges("solids")
@pytest.mark.tiers(quick=["crank-slider-140.0"], rest="slow")
@pytest.mark.parametrize("axis", [180.0, 140.0, -75.0])
@pytest.mark.parametrize("kind", list(LINKAGES))
def test_the_hole_is_where_the_crank_pin_is(kind: str, axis: float) -> None:
    made = pinned(kind, axis)
    hole, found = made.solids.driven.plan.crank_pin, scene_of(made)
    phi1 = np.linspace(0.0, 2.0 * pi, 50)
    places = found.poses(phi1).places
    pin = carried(places["crank"], np.array([made.linkage.crank_mm, 0.0]))
    at_hole = carried(places["driven"], np.array([hole.x_mm, hole.y_mm]))
    assert at_hole == pytest.approx(pin, abs=1e-11 * made.linkage.crank_mm)
    # A quarter turn off it is not there.
    assert np.abs(carried(places["driven"], np.array([-hole.y_mm, hole.x_mm])) - pin).max() > 10.0


@pytest.mark.slow
def test_an_axis_elsewhere_turns_the_hole_in_the_gear() -> None:
    straight, aside = (pinned(axis=axis).solids.driven.plan.crank_pin for axis in (180.0, 140.0))
    between = np.angle(complex(aside.x_mm, aside.y_mm) / complex(straight.x_mm, straight.y_mm))
    assert between == pytest.approx(np.radians(40.0), abs=1e-12)


@pytest.mark.slow
@pytest.mark.judges("files")
def test_files_have_the_hole() -> None:
    made = pinned()
    plan = made.solids.driven.plan
    hole, place = plan.crank_pin, Point(plan.crank_pin.x_mm, plan.crank_pin.y_mm)
    mesh = trimesh.load(io.BytesIO(made.solids.driven.mesh.export(file_type="stl")), file_type="stl")
    section = mesh.section(plane_origin=[0.0, 0.0, 5.0], plane_normal=[0.0, 0.0, 1.0]).to_2D(to_2D=np.eye(4))[0]
    (found,) = [ring for ring in section.polygons_closed if Point(ring.centroid).distance(place) < 1e-3]
    assert found.exterior.hausdorff_distance(place) == pytest.approx(3.0, abs=3e-3)
    (drawn,) = [
        circle
        for text in dxf_files(pair_drawings(made)).values()
        if (drawing := ezdxf.read(io.StringIO(text.decode() if isinstance(text, bytes) else text)))
        for circle in drawing.modelspace().query('CIRCLE[layer=="CRANK_PIN"]')
    ][:1]
    assert (drawn.dxf.center.x, drawn.dxf.center.y, drawn.dxf.radius) == pytest.approx((hole.x_mm, hole.y_mm, 3.0))
    assert any("CRANK_PIN" in str(text) for text in svg_files(pair_drawings(made)).values())
    told = assembly_of(made)["crank"]
    assert told["length_mm"] == 26.0
    turned = told["hole"]["x_mm"] + 1j * told["hole"]["y_mm"]
    assert turned == pytest.approx(26.0 * np.exp(1j * told["direction_rad"]), abs=2e-4)
    assert bodies_summary(made)["driven"]["crank_pin_hole"]["diameter_mm"] == 6.0
    assert "crank_pin_hole" not in bodies_summary(made)["driving"]
    rows = {entry.label: entry.texts for group in data_sheet(made).groups for entry in group.entries}
    assert rows["diameter of the crank pin's hole"] == ("", "6")


@pytest.mark.long
@pytest.mark.slow
def test_step_has_the_hole() -> None:
    pytest.importorskip("OCP", reason="the kernel for STEP is not installed")
    from ncgear.files.workshop.step import step_files
    from oracles.part21 import Part21

    made = pinned()
    hole, file = made.solids.driven.plan.crank_pin, Part21(step_files(made)["driven.step"])
    (solid,) = file.of("MANIFOLD_SOLID_BREP")
    walls = [file.surface(face) for face in file.faces(solid)]
    round_ = [wall for wall in walls if wall.name == "CYLINDRICAL_SURFACE" and wall.arguments[-1] == pytest.approx(3.0)]
    (axis,) = {tuple(np.round(file.triple(file[wall.arguments[1]].arguments[1])[:2], 6)) for wall in round_}
    assert axis == pytest.approx((hole.x_mm, hole.y_mm), abs=1e-5)


@pytest.mark.slow
@pytest.mark.parametrize(("clearance", "wide"), [(0.1, 6.2), (-0.1, 5.8)])
def test_a_process_widens_or_narrows_the_hole(clearance: float, wide: float) -> None:
    assert pinned(clearance=clearance).solids.driven.plan.crank_pin.diameter_mm == pytest.approx(wide)


@pytest.mark.slow
def test_other_parts_keep_away_from_the_hole() -> None:
    plan = pinned(more=", lightening_holes: {count: 5, least_wall_mm: 2}").solids.driven.plan
    own = plan.crank_pin
    others = [plan.index_hole, *plan.lightening_holes]
    walls = [
        hypot(one.x_mm - own.x_mm, one.y_mm - own.y_mm) - (one.diameter_mm + own.diameter_mm) / 2.0 for one in others
    ]
    assert min(walls) >= 2.0 - plan.chord_tolerance_mm
    webbed = pinned(more=", web: {thickness_mm: 4, rim_mm: 3, hub_mm: 20}").solids.driven.plan
    place = Point(own.x_mm, own.y_mm)
    assert (
        min(pocket.distance(place) for pocket in webbed.web.pockets)
        >= own.diameter_mm / 2.0 + 2.0 - plan.chord_tolerance_mm
    )


@pytest.mark.slow
def test_a_hole_without_room_is_refused_with_the_largest_that_fits() -> None:
    with pytest.raises(WrongInput, match=r"the largest that fits is (\S+) mm") as told:
        _ = pinned(pin=22.0).solids
    assert told.value.key == "gears.driven.crank_pin.diameter_mm"
    largest = float(str(told.value).split("fits is ")[1].split()[0])
    plan = pinned(pin=largest).solids.driven.plan
    edge = Point(plan.crank_pin.x_mm, plan.crank_pin.y_mm).buffer(largest / 2.0, quad_segs=256)
    assert 2.0 - 1e-3 <= min(edge.distance(plan.disc.exterior), edge.distance(plan.bore_polygon)) < 2.02
    with pytest.raises(WrongInput, match="the largest"):
        _ = pinned(pin=largest + 0.02).solids


@pytest.mark.thorough
def test_a_hub_leaves_no_room_for_the_hole() -> None:
    with pytest.raises(WrongInput, match="none fits there") as told:
        _ = pinned(more=", hub: {diameter_mm: 52, height_mm: 5}").solids
    assert told.value.key == "gears.driven.crank_pin.diameter_mm"


@pytest.mark.parametrize(
    ("linkage", "mesh"),
    [("{kind: rack_pinion, radius_mm: 20}", "external"), ("{kind: none}", "external"), (None, "internal")],
)
def test_a_gear_without_a_crank_or_a_ring_refuses_it(linkage: str | None, mesh: str) -> None:
    text = TEXT.format(linkage=linkage or LINKAGES["yoke"], axis=180.0, pin=6.0, clearance=0.0, more="")
    text = text.replace("  teeth: 40\n", f"  teeth: 40\n  mesh: {mesh}\n")
    with pytest.raises(WrongInput) as told:
        drive_of_text(text.replace("bore_mm: 10, ", "") if mesh == "internal" else text)
    assert str(told.value.key).startswith("gears.driven.crank_pin")


@pytest.mark.thorough
def test_designs_without_a_hole_are_as_before() -> None:
    made = pinned()
    plain = drive_of_text(
        TEXT.format(linkage=LINKAGES["crank-slider"], axis=180.0, pin=6.0, clearance=0.0, more="").replace(
            ", crank_pin: {diameter_mm: 6.0}", ""
        )
    )
    assert plain.solids.driven.plan.crank_pin is None
    assert "hole" not in assembly_of(plain)["crank"]
    assert plain.solids.driven.plan.round_holes == (plain.solids.driven.plan.index_hole,)
    assert replace(made.solids.driven.plan, crank_pin=None).round_holes[0] == made.solids.driven.plan.index_hole
