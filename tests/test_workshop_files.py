"""Files for the workshop, each read back by a program that did not write it and held against the solids' sections."""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
import sys
from functools import cache
from io import BytesIO, StringIO
from math import pi
from pathlib import Path
from xml.etree import ElementTree
from zipfile import ZipFile

import ezdxf
import numpy as np
import pytest
import shapely
from scipy.spatial.transform import Rotation, Slerp
from shapely import Polygon
from svgelements import SVG, Arc, Group, Move
from svgelements import Path as SvgPath
from trimesh import Scene as TrimeshScene
from trimesh import Trimesh
from trimesh.creation import box

from commands import Run, environment
from drives import drive
from later import Later
from ncgear.contact.written.as_written import Outlines
from ncgear.drawings.beside import HERE
from ncgear.drawings.plots.canvas import DRIVEN, DRIVING
from ncgear.files.read_back import exact_outlines, outline_errors_mm, outline_of_dxf, outline_of_svg
from ncgear.files.workshop.drawing import Layer, Use, pitch_points
from ncgear.files.workshop.formats import USUAL, WRITERS, Format, all_made, begun_workshop_files
from ncgear.files.workshop.solid_files import _after, turning
from ncgear.numerics.arrays import Array
from ncgear.pitch.shape import Gear, Mesh
from ncgear.project.drive import Drive
from ncgear.teeth.outline import exact_curves
from oracles import dxf

pygltflib = Later("pygltflib")

DESIGNS = ["baler", "ellipse", "internal-1-2"]
"""Keyway and concave curves; a bore alone; a ring."""

ROUNDING_MM = 2e-6
"""Of coordinates with six decimals, twice."""

ARC_MM = 1e-5
"""Of the readers' own chords of arcs: a radius of 10 mm in 1600 steps over half a turn."""


@cache
def files(name: str) -> dict[str, bytes]:
    return all_made(begun_workshop_files(drive(name), USUAL, HERE, None)).files


def outline(name: str, gear: Gear) -> Array:
    """Of the teeth, as the build's table has it."""
    teeth = drive(name).teeth
    return (teeth.driving if gear is Gear.DRIVING else teeth.driven).outline_mm


def apart_mm(points: Array, other: Array) -> float:
    """The greatest distance between two closed lines through points (n, 2)."""
    both = (points, other), (other, points)
    return float(max(shapely.distance(shapely.points(a), shapely.LinearRing(b)).max() for a, b in both))


@pytest.mark.parametrize("bent", [False, True])
def test_points_of_dxf_are_written_and_read_as_the_library_does(bent: bool) -> None:
    """Ours are one text; the library's are one object for each number."""
    from ncgear.files.workshop.drawing import Drawing, Polyline
    from ncgear.files.workshop.dxf import dxf_bytes

    turned = np.linspace(0.0, 2.0 * np.pi, 40, endpoint=False)
    points = np.round(np.column_stack([30.0 * np.cos(turned), 2e-5 * np.sin(turned)]), 6)
    bulges = np.where(np.arange(40) % 3 == 0, 0.25, 0.0) if bent else np.zeros(40)
    drawing = Drawing("LWPOLYLINE", {Layer.OUTLINE: (Polyline(points, bulges),)}, ("  0", "  8", "OUTLINE"))
    data = dxf_bytes({"": drawing}, drawing.notes)
    document = ezdxf.read(StringIO(data.decode()))
    (read,) = document.modelspace().query("LWPOLYLINE")
    np.testing.assert_array_equal(np.array(read.get_points("xyb")), np.column_stack([points, bulges]))
    again = StringIO()
    document.write(again)
    ours, theirs = (
        text[text.index("AcDbPolyline") : text.index("AcDbText")] for text in (data.decode(), again.getvalue())
    )
    assert ours == theirs
    found = outline_of_dxf(data)
    for one in points:
        assert np.hypot(*(found - one).T).min() < 1e-12
    assert (len(found) > len(points)) == bent


def strayed_mm(points: Array, name: str, gear: Gear) -> float:
    """The greatest distance of places on the exact flanks, fillets and lands from a closed line through points."""
    share, teeth = np.random.default_rng(5), drive(name).teeth.of(gear)
    exact = [
        one.at(np.arange(one.owner.size)[:, None], share.uniform(0.0, 1.0, (one.owner.size, 13)))[0].reshape(-1, 2)
        for one in exact_curves(teeth.tips, teeth.sides)
    ]
    sides = shapely.STRtree(shapely.linestrings(np.stack([points, np.roll(points, -1, axis=0)], axis=1)))
    places = shapely.points(np.concatenate(exact))
    return float(sides.query_nearest(places, all_matches=False, return_distance=True)[1].max())


def section(name: str, gear: Gear) -> Polygon:
    solids = drive(name).solids
    return (solids.driving if gear is Gear.DRIVING else solids.driven).plan.section


# --- DXF -------------------------------------------------------------------------------------------------------------


def drawn(data: bytes, layer: str) -> list[dxf.Entity]:
    return [one for one in dxf.entities(data.decode()) if one.layer == layer]


CUT_THROUGH = tuple(layer for layer in Layer if layer.use is Use.THROUGH)


def cut_area(data: bytes, prefix: str = "") -> Polygon:
    """What a machine leaves that cuts all contours of the layers for it: the largest less all others."""
    rings = [Polygon(one.points()) for layer in CUT_THROUGH for one in drawn(data, f"{prefix}{layer.name}")]
    largest = max(rings, key=lambda ring: ring.area)
    return largest.difference(shapely.union_all([ring for ring in rings if ring is not largest]))


@pytest.mark.judges("files")
@pytest.mark.tiers(quick=["ellipse-Gear.DRIVING"], slow=["ellipse-*", "internal-1-2-Gear.DRIVING"], rest="long")
@pytest.mark.parametrize("gear", Gear)
@pytest.mark.parametrize("name", DESIGNS)
def test_a_drawing_has_the_exact_outline_to_a_tenth_of_the_chord_tolerance(name: str, gear: Gear) -> None:
    data = files(name)[f"{gear.value}.dxf"]
    (teeth,) = drawn(data, "OUTLINE")
    assert teeth.closed
    points = np.array(teeth.points(step_rad=0.004))
    tolerance = drive(name).chord_tolerance_mm
    assert 1e-4 < strayed_mm(points, name, gear) <= 0.1 * tolerance
    assert Polygon(points).is_valid
    # Chords seven times as coarse or more, and hardly fewer points.
    assert strayed_mm(outline(name, gear), name, gear) > 0.7 * tolerance
    assert len(teeth.vertices()) < 1.5 * len(outline(name, gear))
    # Round edges are arcs there and chords in the solid.
    assert cut_area(data).symmetric_difference(section(name, gear)).buffer(-0.003).is_empty


@pytest.mark.slow
@pytest.mark.long
@pytest.mark.parametrize("name", ["ellipse", "internal-1-2"])
def test_gears_cut_as_drawn_keep_the_law_closer_than_the_table_s(name: str) -> None:
    """Contact of the written arcs, sampled off their ends: their errors are a third of those of chords, or less."""
    pair = drive(name)
    rings = []
    for gear in Gear:
        (teeth,) = drawn(files(name)[f"{gear.value}.dxf"], "OUTLINE")
        rings.append(np.array(teeth.points(step_rad=0.0037)))
    arcs = pair.contact([Outlines("dxf", *rings)]).as_written[0]
    chords = pair.contact([Outlines("csv", outline(name, Gear.DRIVING), outline(name, Gear.DRIVEN))]).as_written[0]
    for found, coarse, exact in (
        (arcs.pushing_rad, chords.pushing_rad, pair.designed_contact.pushing.error_rad),
        (arcs.back_rad, chords.back_rad, pair.designed_contact.back.error_rad),
    ):
        assert np.abs(found - exact).max() < np.abs(coarse - exact).max() / 3.0
    assert arcs.overlap_mm.max() <= 2.0 * 0.1 * 0.005


@pytest.mark.tiers(slow=["ellipse"], rest="long")
@pytest.mark.parametrize("name", ["ellipse", "internal-1-2"])
def test_the_told_errors_of_files_are_those_found_here(name: str) -> None:
    table, exact = {"csv": (outline(name, Gear.DRIVING), outline(name, Gear.DRIVEN))}, exact_outlines(drive(name).teeth)
    written = all_made(begun_workshop_files(drive(name), [Format.DXF, Format.SVG, Format.DRAWING], HERE, exact))
    told = {**outline_errors_mm(exact, table), **written.errors_mm}
    read = {
        "csv": [outline(name, gear) for gear in Gear],
        "dxf": [np.array(drawn(files(name)[f"{g.value}.dxf"], "OUTLINE")[0].points()) for g in Gear],
        "svg": [svg_rings(files(name)[f"{g.value}.svg"], "OUTLINE")[0] for g in Gear],
    }
    assert set(told) == set(read)
    for kind, rings in read.items():
        found = max(strayed_mm(ring, name, gear) for ring, gear in zip(rings, Gear, strict=True))
        assert told[kind] == pytest.approx(found, rel=0.1)


@pytest.mark.slow
def test_a_gear_a_thousandth_larger_is_seen() -> None:
    (teeth,) = drawn(files("ellipse")["driving.dxf"], "OUTLINE")
    assert strayed_mm(1.001 * np.array(teeth.points(step_rad=0.001)), "ellipse", Gear.DRIVING) > 0.01
    larger = shapely.affinity.scale(cut_area(files("ellipse")["driving.dxf"]), 1.001, 1.001, origin=(0.0, 0.0))
    assert not larger.symmetric_difference(section("ellipse", Gear.DRIVING)).buffer(-0.003).is_empty


@pytest.mark.slow
def test_the_keyway_is_exact() -> None:
    """An arc by its bulge: the reader's arc runs on the bore's circle, and its sides are the keyway's."""
    (bore,) = drawn(files("baler")["driving.dxf"], "BORE")
    points = np.array(bore.points())
    radius = np.hypot(*points.T)
    assert max(abs(bulge) for _, _, bulge in bore.vertices()) < 1.0, "no arc over half a turn, of which some fall short"
    on_circle = points[:, 0] < np.sqrt(8.0**2 - 2.5**2)
    assert np.abs(radius[on_circle] - 8.0).max() <= ROUNDING_MM
    assert points[~on_circle][:, 0].max() == pytest.approx(8.0 + 2.3, abs=ROUNDING_MM)
    assert Polygon(points).area == pytest.approx(Polygon(section("baler", Gear.DRIVING).interiors[0]).area, abs=0.2)


@pytest.mark.tiers(slow=["ellipse"], rest="long")
@pytest.mark.parametrize("name", DESIGNS)
def test_drawings_are_in_mm_with_every_layer_declared(name: str) -> None:
    for file in WRITERS[Format.DXF].names:
        data = files(name)[file]
        assert dxf.header(data.decode())["$INSUNITS"] == "4"
        document = ezdxf.read(StringIO(data.decode()))
        audit = document.audit()
        assert (audit.errors, audit.fixes) == ([], [])
        layers = {one.layer for one in dxf.entities(data.decode())}
        assert layers <= {layer.dxf.name for layer in document.layers}
        assert all(one.closed for one in dxf.entities(data.decode()) if one.kind != "LINE")
        words = f"no farther than {drive(name).chord_tolerance_mm:g} mm"
        assert any(words in note for _, note in document.header.custom_vars)
        written = [value for code, value in dxf.pairs(data.decode()) if code == 1]
        in_sight = file == "pair.dxf"
        assert sum(words in text for text in written) == 1 + in_sight, "among the properties, and in sight"
        if not in_sight:
            assert {one.kind for one in dxf.entities(data.decode())} <= {"LWPOLYLINE", "CIRCLE"}, "only what is cut"


@pytest.mark.slow
def test_the_axis_is_marked_across() -> None:
    lines = drawn(files("baler")["pair.dxf"], "DRIVING_AXIS")
    ends = np.array([[[one.number(10), one.number(20)], [one.number(11), one.number(21)]] for one in lines])
    assert np.allclose(ends.mean(axis=1), 0.0)
    assert np.allclose(np.diff(ends, axis=1)[:, 0], [[6.0, 0.0], [0.0, 6.0]])


@pytest.mark.tiers(slow=["internal-1-2"], rest="long")
@pytest.mark.parametrize("name", [*DESIGNS, "printed-pump", "helical-ellipse"])
def test_the_pair_is_drawn_as_assembled(name: str) -> None:
    """Clear of each other but for the chord tolerance of each; not so where one is turned by half a tooth."""
    data, distance = files(name)["pair.dxf"], drive(name).pitch.center_distance_mm
    driving, driven = (cut_area(data, f"{gear.value.upper()}_") for gear in Gear)
    assert driving.intersection(driven).buffer(-0.005).is_empty
    half_tooth = 180.0 / drive(name).pitch.size.driving_teeth
    turned = shapely.affinity.rotate(driving, half_tooth, origin=(0.0, 0.0))
    assert not turned.intersection(driven).buffer(-0.005).is_empty
    (axis, _) = drawn(data, "DRIVEN_AXIS")
    assert (axis.number(10) + axis.number(11)) / 2.0 == pytest.approx(distance, abs=ROUNDING_MM)


def cut_layers(data: bytes) -> dict[str, int]:
    """How many shapes there are on each layer."""
    found = dxf.entities(data.decode())
    return {layer: sum(one.layer == layer for one in found) for layer in sorted({one.layer for one in found})}


@pytest.mark.slow
def test_all_of_a_body_is_drawn() -> None:
    """Everything that printing asks for; what is not cut through is on layers of its own."""
    driving, driven = (files("printed-pump")[f"{gear.value}.dxf"] for gear in Gear)
    both = {"OUTLINE": 1, "BORE": 1, "INDEX_HOLE": 1, "HUB": 1}
    assert cut_layers(driving) == {**both, "POCKETS": 2}
    assert cut_layers(driven) == {**both, "LIGHTENING_HOLES": 5}
    for gear, data in ((Gear.DRIVING, driving), (Gear.DRIVEN, driven)):
        assert cut_area(data).symmetric_difference(section("printed-pump", gear)).buffer(-0.003).is_empty
    ring, *inner = sorted((Polygon(one.points()) for one in drawn(driving, "POCKETS")), key=lambda one: -one.area)
    pocket = drive("printed-pump").solids.driving.plan.slabs
    assert ring.area - sum(hole.area for hole in inner) == pytest.approx(
        pocket[0].section.area - pocket[1].section.area
    )


@pytest.mark.tiers(slow=["Gear.DRIVING"], rest="long")
@pytest.mark.parametrize("gear", Gear)
def test_a_clearance_is_taken_off_all_along_the_outline(gear: Gear) -> None:
    """As much off as the clearance times the length, and nowhere less than the clearance."""
    (teeth,) = drawn(files("printed-pump")[f"{gear.value}.dxf"], "OUTLINE")
    designed, cleared = Polygon(outline("printed-pump", gear)), Polygon(teeth.points())
    assert designed.exterior.distance(cleared.exterior) == pytest.approx(0.05, abs=ROUNDING_MM)
    assert designed.area - cleared.area == pytest.approx(0.05 * designed.length, rel=0.01)


@pytest.mark.tiers(slow=["Gear.DRIVING"], rest="long")
@pytest.mark.parametrize("gear", Gear)
def test_a_helical_gear_is_drawn_at_its_foot(gear: Gear) -> None:
    """Its section there and the outline in the table are two polylines of the same curves: a tolerance each."""
    (teeth,) = drawn(files("helical-ellipse")[f"{gear.value}.dxf"], "OUTLINE")
    assert apart_mm(np.array(teeth.points()), outline("helical-ellipse", gear)) <= 2.0 * 0.005
    texts = [value for code, value in dxf.pairs(files("helical-ellipse")[f"{gear.value}.dxf"].decode()) if code == 1]
    assert sum("section at z = 0" in text for text in texts) == 1


@pytest.mark.parametrize("name", DESIGNS)
def test_a_pitch_curve_keeps_the_tolerance_with_few_points(name: str) -> None:
    """Distances of the curve from its chords at nine places each; twice the points were at a quarter of it."""
    for curve in (drive(name).pitch.driving, drive(name).pitch.driven):
        points = pitch_points(curve, 0.005)
        start, end = points[:, None], np.roll(points, -1, axis=0)[:, None]
        length = (np.arange(len(points))[:, None] + np.arange(1, 10) / 10.0) * curve.length_mm / len(points)
        chord, arm = end - start, curve.at_length(length).position - start
        across = np.abs(chord[..., 0] * arm[..., 1] - chord[..., 1] * arm[..., 0]) / np.hypot(*chord.T).T
        assert 0.25 * 0.005 < across.max() <= 0.005


# --- SVG -------------------------------------------------------------------------------------------------------------


def svg_rings(data: bytes, layer: str) -> list[Array]:
    """Contours of a layer in mm, y up as it was, from what a browser would draw at 25.4 dots per inch."""
    image = SVG.parse(BytesIO(data), ppi=25.4)
    (group,) = image.select(lambda one: isinstance(one, Group) and one.id == layer)
    box = np.array([float(word) for word in image.values["viewBox"].split()])
    scale = np.array([float(image.width), float(image.height)]) / box[2:]
    assert scale == pytest.approx([1.0, 1.0], rel=1e-6), "1:1, the reader's inch being 25.4 mm to six digits"
    paths = group.select(lambda one: isinstance(one, SvgPath))
    return [(points_of(path) / scale + box[:2]) * (1.0, -1.0) for path in paths]


def points_of(path: SvgPath) -> Array:
    segments = [segment for segment in path.segments() if not isinstance(segment, Move)]
    count = {Arc: 1600 if len(segments) < 10 else 32}
    rows = [segment.npoint(np.linspace(0.0, 1.0, count.get(type(segment), 1), endpoint=False)) for segment in segments]
    return np.array([(point[0], point[1]) for row in rows for point in row])


@pytest.mark.tiers(slow=["ellipse-Gear.DRIVING"], rest="long")
@pytest.mark.parametrize("gear", Gear)
@pytest.mark.parametrize("name", DESIGNS)
def test_an_image_has_the_outline_at_its_size(name: str, gear: Gear) -> None:
    rings = svg_rings(files(name)[f"{gear.value}.svg"], "OUTLINE")
    assert strayed_mm(rings[0], name, gear) <= 0.1 * 0.005


@pytest.mark.slow
def test_an_image_has_bore_and_holes() -> None:
    data = files("baler")["driven.svg"]
    rings = [svg_rings(data, layer)[0] for layer in ("BORE", "INDEX_HOLE")]
    drawn_rings = [np.array(drawn(files("baler")["driven.dxf"], layer)[0].points()) for layer in ("BORE", "INDEX_HOLE")]
    for ours, other in zip(rings, drawn_rings, strict=True):
        assert apart_mm(ours, other) <= ARC_MM


@pytest.mark.slow
def test_an_image_says_what_each_layer_is_for() -> None:
    text = files("printed-pump")["driving.svg"].decode()
    for layer in (Layer.OUTLINE, Layer.BORE, Layer.INDEX_HOLE, Layer.POCKETS, Layer.HUB, Layer.PITCH_CURVE, Layer.AXIS):
        assert f"<title>{layer.words}</title>" in text
    root = ElementTree.fromstring(text)
    strokes = {group.get("id"): group.get("stroke") for group in root.iter("{http://www.w3.org/2000/svg}g")}
    assert len({strokes["OUTLINE"], strokes["POCKETS"], strokes["AXIS"]}) == 3
    assert strokes["OUTLINE"] == strokes["BORE"]


@pytest.mark.slow
def test_an_image_with_y_down_is_seen() -> None:
    (ring,) = svg_rings(files("baler")["driving.svg"], "OUTLINE")
    assert strayed_mm(ring * (1.0, -1.0), "baler", Gear.DRIVING) > 1.0


# --- 3MF and GLB -----------------------------------------------------------------------------------------------------


def printed(data: bytes) -> tuple[str, dict[str, Trimesh]]:
    """Unit and parts at their places, as the 3MF Consortium's own library reads them."""
    from lib3mf import get_wrapper

    model = get_wrapper().CreateModel()
    reader = model.QueryReader("3mf")
    reader.SetStrictModeActive(True)
    reader.ReadFromBuffer(data)
    assert reader.GetWarningCount() == 0
    unit, items, parts = model.GetUnit(), model.GetBuildItems(), {}
    while items.MoveNext():
        item = items.GetCurrent()
        mesh, place = item.GetObjectResource(), item.GetObjectTransform()
        solid = model.GetMeshObjectByID(mesh.GetUniqueResourceID())
        points = np.array([list(vertex.Coordinates) for vertex in solid.GetVertices()])
        moved = points + np.array([place.Fields[3][axis] for axis in range(3)])
        parts[item.GetPartNumber()] = Trimesh(
            moved, [list(t.Indices) for t in solid.GetTriangleIndices()], process=False
        )
    return unit.name, parts


@pytest.mark.tiers(thorough=["ellipse"], rest="slow")
@pytest.mark.parametrize("name", [*DESIGNS, "helical-ellipse"])
def test_prints_are_the_solids_side_by_side(name: str) -> None:
    unit, parts = printed(files(name)["gears.3mf"])
    assert unit == "MilliMeter"
    solids = drive(name).solids
    for gear, solid in ((Gear.DRIVING, solids.driving), (Gear.DRIVEN, solids.driven)):
        part = parts[gear.value]
        assert part.is_watertight
        assert part.volume == pytest.approx(solid.mesh.volume, rel=1e-6)
        assert np.ptp(part.bounds, axis=0) == pytest.approx(np.ptp(solid.mesh.bounds, axis=0), abs=1e-4)
        assert part.bounds[0][2] == pytest.approx(0.0, abs=1e-9)
    assert parts["driven"].bounds[0][0] - parts["driving"].bounds[1][0] == pytest.approx(5.0, abs=1e-4)


@pytest.mark.tiers(slow=["ellipse"], rest="long")
@pytest.mark.parametrize("name", DESIGNS)
def test_assembled_prints_are_sections_of_the_drawings_times_the_face_width(name: str) -> None:
    """To the tolerance along teeth and circles, chords in the solid; a gear a thousandth larger is far off."""
    _, parts = printed(files(name)["pair.3mf"])
    distance, width = drive(name).pitch.center_distance_mm, drive(name).gears.face_width_mm
    for gear, x_mm in ((Gear.DRIVING, 0.0), (Gear.DRIVEN, distance)):
        data = files(name)[f"{gear.value}.dxf"]
        part, area = parts[gear.value], cut_area(data)
        arcs = [Polygon(one.points()) for layer in CUT_THROUGH for one in drawn(data, layer.name)]
        lost_mm2 = 0.005 * sum(arc.length for arc in arcs)
        assert part.volume == pytest.approx(area.area * width, abs=lost_mm2 * width)
        assert part.volume != pytest.approx(1.001**3 * area.area * width, abs=3.0 * lost_mm2 * width)
        west, south, east, north = area.bounds
        expected = [[west + x_mm, south, 0.0], [east + x_mm, north, width]]
        assert part.bounds == pytest.approx(np.array(expected), abs=0.005)


def shown(data: bytes) -> dict[str, Array]:
    """Vertices of each node in the scene's frame, in metres, by the names of the nodes."""
    image = pygltflib.GLTF2.load_from_bytes(data)
    blob, found = image.binary_blob(), {}
    for node in image.nodes:
        if node.mesh is None:
            continue
        accessor = image.accessors[image.meshes[node.mesh].primitives[0].attributes.POSITION]
        assert accessor.componentType == pygltflib.FLOAT
        view = image.bufferViews[accessor.bufferView]
        start = (view.byteOffset or 0) + (accessor.byteOffset or 0)
        points = np.frombuffer(blob, "<f4", 3 * accessor.count, start).reshape(-1, 3).astype(float)
        found[node.name] = Rotation.from_quat(node.rotation).apply(points * node.scale) + node.translation
    return found


@pytest.mark.slow
@pytest.mark.parametrize("name", ["ellipse", "internal-1-2", "log-generator"])
def test_the_gears_of_the_scene_turn_by_their_law(name: str) -> None:
    """Between keys as glTF turns nodes, by scipy: the driving gear evenly, the driven one by the law."""
    one = drive(name)
    image = pygltflib.GLTF2.load_from_bytes(files(name)["pair.glb"])
    blob, (animation,) = image.binary_blob(), image.animations

    def values(accessor: int, width: int) -> Array:
        kept, view = image.accessors[accessor], image.bufferViews[image.accessors[accessor].bufferView]
        assert view.byteOffset % 4 == 0
        return np.frombuffer(blob, "<f4", width * kept.count, view.byteOffset).reshape(kept.count, width).astype(float)

    turns, speed = {}, one.machine.speed_rad_s
    for channel in animation.channels:
        sampler, node = animation.samplers[channel.sampler], image.nodes[channel.target.node]
        time_s, keys = values(sampler.input, 1)[:, 0], Rotation.from_quat(values(sampler.output, 4))
        assert (channel.target.path, image.accessors[sampler.input].max) == ("rotation", [pytest.approx(time_s[-1])])
        assert (keys[0].inv() * keys[-1]).magnitude() == pytest.approx(0.0, abs=1e-6)
        at_s = np.linspace(0.0, time_s[-1], 611)
        own = Rotation.from_quat(node.rotation).inv() * Slerp(time_s, keys)(at_s)
        turns[node.name] = np.unwrap(own.as_rotvec() @ np.array([0.0, 0.0, 1.0]), period=2.0 * np.pi)
    forth = np.minimum(speed * at_s, 2.0 * one.pair.transmission.lobes.driving_period_rad - speed * at_s)
    phi1 = speed * at_s if one.pair.transmission.lobes.repeats else forth
    sense = 1.0 if one.gears.mesh == "internal" else -1.0
    for gear, expected in (("driving", phi1), ("driven", sense * one.transmission.driven_angle(phi1).value)):
        missed = (turns[gear] - expected + np.pi) % (2.0 * np.pi) - np.pi
        assert np.abs(missed).max() < 1e-4, gear


@pytest.mark.slow
def test_each_stretch_that_a_mesh_reads_is_named_for_its_use() -> None:
    """Numbers of glTF 2.0, table 5.11.4: 34962 for values of corners, 34963 for facets; nothing else has one."""
    image = pygltflib.GLTF2.load_from_bytes(files("ellipse")["pair.glb"])
    primitives = [one for mesh in image.meshes for one in mesh.primitives]
    expected = {image.accessors[one.attributes.POSITION].bufferView: pygltflib.ARRAY_BUFFER for one in primitives}
    expected |= {image.accessors[one.indices].bufferView: pygltflib.ELEMENT_ARRAY_BUFFER for one in primitives}
    assert {place: view.target for place, view in enumerate(image.bufferViews) if view.target} == expected


VALIDATED = """
require("gltf-validator").validateBytes(new Uint8Array(require("fs").readFileSync("pair.glb")))
  .then(told => console.log(JSON.stringify(told.issues.messages)))
"""


@pytest.mark.slow
@pytest.mark.parametrize("name", ["ellipse", "internal-1-2", "log-generator"])
def test_the_validator_of_the_format_finds_nothing(name: str, tmp_path: Path) -> None:
    """Neither errors nor hints, by the Khronos group's own program (npm install gltf-validator; NODE_PATH)."""
    node = shutil.which("node")
    if node is None or subprocess.run([node, "-e", 'require("gltf-validator")'], capture_output=True).returncode:
        pytest.skip("gltf-validator is not installed (npm install gltf-validator, its folder in NODE_PATH)")
    (tmp_path / "pair.glb").write_bytes(files(name)["pair.glb"])
    done = subprocess.run([node, "-e", VALIDATED], cwd=tmp_path, capture_output=True, text=True, check=True)
    assert json.loads(done.stdout) == []


@pytest.mark.tiers(slow=["internal-1-2"], rest="long")
@pytest.mark.parametrize("name", [*DESIGNS, "helical-ellipse"])
def test_the_scene_is_the_pair_in_metres_with_y_up(name: str) -> None:
    nodes, one = shown(files(name)["pair.glb"]), drive(name)
    for gear, solid, x_mm in (
        ("driving", one.solids.driving, 0.0),
        ("driven", one.solids.driven, one.pitch.center_distance_mm),
    ):
        x, y, z = solid.mesh.vertices.T
        expected = np.column_stack([x + x_mm, z, -y]) / 1000.0
        assert np.abs(nodes[gear] - expected).max() <= 1e-7


def on_screen(light: list[float]) -> Array:
    """The colour of a material as a screen numbers it, 0 to 255, by IEC 61966-2-1."""
    coded = [12.92 * one if one <= 0.0031308 else 1.055 * one ** (1.0 / 2.4) - 0.055 for one in light]
    return 255.0 * np.array(coded)


def test_the_gears_have_the_colours_of_the_pictures() -> None:
    """To a step: the writer keeps shares of light to 1/255."""
    image = pygltflib.GLTF2.load_from_bytes(files("ellipse")["pair.glb"])
    for material, color in zip(image.materials, (DRIVING, DRIVEN), strict=True):
        light = material.pbrMetallicRoughness.baseColorFactor
        assert np.abs(on_screen(light[:3]) - list(bytes.fromhex(color[1:]))).max() <= 1.0
        assert light[3] == 1.0
    # With normals at corners that facets share, edges would look round.
    assert all(mesh.primitives[0].attributes.NORMAL is None for mesh in image.meshes)


# --- command ---------------------------------------------------------------------------------------------------------


@pytest.mark.slow
def test_the_same_design_gives_the_same_bytes() -> None:
    again = all_made(begun_workshop_files(Drive(drive("ellipse").design), USUAL, HERE, None)).files
    assert again == files("ellipse")
    # Two builds within a moment would not tell by themselves that an archive bears its time.
    for name in ("gears.3mf", "pair.3mf"):
        assert {entry.date_time[0] for entry in ZipFile(BytesIO(again[name])).infolist()} == {1980}


SMALL_DRAWING = """
import sys
import numpy as np
from ncgear.files.workshop.drawing import Circle, Drawing, Layer, polygon
from ncgear.files.workshop.dxf import dxf_bytes
triangle = polygon(np.array([[0.0, 0.0], [2.0, 0.0], [0.0, 2.0]]))
drawing = Drawing("triangle", {Layer.OUTLINE: (triangle,), Layer.BORE: (Circle(0.5, 0.5, 0.1),)}, ("note",))
sys.stdout.buffer.write(dxf_bytes({"": drawing}, drawing.notes))
"""


@pytest.mark.slow
def test_drawings_do_not_hang_on_how_a_process_orders_words() -> None:
    """Of these two seeds the library's own order of the classes in a file's head differs."""
    seeds = ({**os.environ, "PYTHONHASHSEED": seed} for seed in ("1", "7"))
    command = [sys.executable, "-c", SMALL_DRAWING]
    made = [subprocess.run(command, env=env, check=True, stdout=subprocess.PIPE).stdout for env in seeds]
    assert made[0] == made[1]


WHOLE_BUILD = """
import sys
from ncgear.cli import main
sys.argv = ["ncgear", "build", sys.argv[1], "--out", sys.argv[2], "--report"]
for kind in ("dxf", "svg", "3mf", "glb", "step", "drawing"):
    sys.argv += ["--format", kind]
main()
"""
TIMES = re.compile(rb"\"timing_s\": \{[^{}]*\}")
WITH_TIMES = {"summary.json", "manifest.json"}
"""The summary says how long a run took, and the manifest has its digest."""


@pytest.mark.slow
@pytest.mark.long
def test_files_of_all_kinds_do_not_hang_on_how_a_process_orders_words(tmp_path: Path) -> None:
    pytest.importorskip("OCP")
    (tmp_path / "wheel.yaml").write_text(WHEEL)
    made = []
    for seed in ("0", "3", "11", "4294967295"):
        command = [sys.executable, "-c", WHOLE_BUILD, str(tmp_path / "wheel.yaml"), str(tmp_path / seed)]
        subprocess.run(command, env=environment(PYTHONHASHSEED=seed), check=True, stdout=subprocess.DEVNULL)
        found = {path.name: path.read_bytes() for path in (tmp_path / seed).iterdir()}
        said = TIMES.sub(b"", found["summary.json"])
        assert said != found["summary.json"]
        made.append({**{name: found[name] for name in found if name not in WITH_TIMES}, "summary.json": said})
    assert {Path(name).suffix for name in made[0]} >= {
        ".dxf",
        ".svg",
        ".3mf",
        ".glb",
        ".step",
        ".stl",
        ".png",
        ".html",
        ".pdf",
    }
    for other in made[1:]:
        assert [name for name in made[0] if made[0][name] != other.get(name)] == []
        assert set(other) == set(made[0])


def test_every_kind_writes_what_it_is_said_to_write() -> None:
    written = files("ellipse")
    assert set(written) == {name for kind in USUAL for name in WRITERS[kind].names}


WHEEL = """\
name: wheel
linkage: {crank_mm: 10, rod_mm: 40}
operation: {speed_rpm: 60}
motion: {law: uniform_crank}
gears: {teeth: 12, module_mm: 2, face_width_mm: 5, driving: {bore_mm: 5}}
"""


@pytest.mark.slow
def test_a_build_writes_the_kinds_asked_for_and_clears_the_others(run: Run) -> None:
    Path("wheel.yaml").write_text(WHEEL)
    assert run("build", "wheel.yaml")[0] == 0
    usual = {path.name for path in Path("export/wheel").iterdir()}
    assert usual >= {"driving.dxf", "driven.svg", "gears.3mf", "pair.3mf", "pair.glb", "driving.stl"}
    assert run("build", "wheel.yaml", "--format", "dxf")[0] == 0
    left = {path.name for path in Path("export/wheel").iterdir()}
    drawings = set(WRITERS[Format.DRAWING].names)
    assert usual - left == {"driving.svg", "driven.svg", "gears.3mf", "pair.3mf", "pair.glb", *drawings}


def test_an_unknown_kind_is_a_usage_error(run: Run) -> None:
    Path("wheel.yaml").write_text(WHEEL)
    status, _, err = run("build", "wheel.yaml", "--format", "dwg")
    assert status == 2
    assert "dxf" in err


def test_turns_of_nodes_follow_one_another_as_their_matrices_do() -> None:
    """Against the rotations of scipy, whose quaternions are in the same order; the other order is another turn."""
    first, second = Rotation.random(rng=1), Rotation.random(5, rng=2)
    both = Rotation.from_quat(_after(first.as_quat(), second.as_quat())).as_matrix()
    assert both == pytest.approx(first.as_matrix() @ second.as_matrix(), abs=1e-12)
    assert both != pytest.approx(second.as_matrix() @ first.as_matrix(), abs=1e-2)


@pytest.mark.parametrize(("name", "mesh"), [("ellipse", Mesh.EXTERNAL), ("internal-1-2", Mesh.INTERNAL)])
def test_keys_of_nodes_turn_them_in_their_places_by_the_law(name: str, mesh: Mesh) -> None:
    """A block in place of each gear, y up and in metres: a key for every degree until both stand as at first."""
    scene, up = TrimeshScene(), np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]])
    for gear, x_m, side in (("driving", 0.0, 9.0), ("driven", 0.05, 8.0)):
        place = np.eye(4)
        place[:3, :3], place[:3, 3] = 0.001 * up, (x_m, 0.0, 0.0)
        scene.add_geometry(box((side, 7.0, 5.0)), node_name=gear, geom_name=gear, transform=place)
    one = drive(name)
    image = pygltflib.GLTF2.load_from_bytes(turning(scene.export(file_type="glb"), one.pair, mesh, 3.0))
    blob = image.binary_blob()
    assert len(blob) >= image.buffers[0].byteLength
    corners = {place: view.target for place, view in enumerate(image.bufferViews) if view.target}
    assert set(corners.values()) == {34962, 34963}

    def numbers(place: int, width: int) -> Array:
        accessor = image.accessors[place]
        view = image.bufferViews[accessor.bufferView]
        assert (view.byteOffset % 4, view.byteLength) == (0, 4 * width * accessor.count)
        return np.frombuffer(blob, "<f4", width * accessor.count, view.byteOffset).reshape(-1, width).astype(float)

    turns = 2 if name == "internal-1-2" else 1
    phi1 = np.radians(np.arange(360 * turns + 1.0))
    angles = {"driving": phi1, "driven": mesh.sense * one.pair.transmission.driven_angle(phi1).value}
    nodes = {node.name: node for node in image.nodes}
    (animation,) = image.animations
    for channel, (gear, angle) in zip(animation.channels, angles.items(), strict=True):
        node, sampler = nodes[gear], animation.samplers[channel.sampler]
        assert image.nodes[channel.target.node] is node
        assert (node.matrix, node.scale) == (None, pytest.approx([0.001] * 3))
        assert node.translation == pytest.approx([0.05 if gear == "driven" else 0.0, 0.0, 0.0])
        assert Rotation.from_quat(node.rotation).as_matrix() == pytest.approx(up, abs=1e-7)
        times = image.accessors[sampler.input]
        assert numbers(sampler.input, 1)[:, 0] == pytest.approx(phi1 / 3.0, abs=1e-6)
        assert (times.min, times.max) == ([0.0], [pytest.approx(phi1[-1] / 3.0)])
        keys = Rotation.from_quat(numbers(sampler.output, 4)).as_matrix()
        assert keys == pytest.approx(up @ Rotation.from_rotvec(angle[:, None] * [0.0, 0.0, 1.0]).as_matrix(), abs=1e-6)


@pytest.mark.judges("files")
@pytest.mark.parametrize("sweep", [1, 0])
def test_arcs_of_an_svg_file_are_read_to_their_side(sweep: int) -> None:
    """A square whose sides are half a circle and a quarter of one, both outwards or both inwards."""
    path = f"M0 0L2 0A1 1 0 0 {sweep} 2 2A1.4142135 1.4142135 0 0 {sweep} 0 2L0 0Z"
    text = f'<svg xmlns="http://www.w3.org/2000/svg"><g id="AXIS"/><g id="OUTLINE"><path d="{path}"/></g></svg>'
    outline = outline_of_svg(text.encode())
    bent = pi / 2.0 + (pi / 2.0 - 1.0)
    assert Polygon(outline).area == pytest.approx(4.0 + (bent if sweep else -bent), rel=1e-5)
    far = outline[:, 0].max(), outline[:, 1].max()
    assert far == pytest.approx((3.0, 2.0**0.5 + 1.0) if sweep else (2.0, 2.0), abs=1e-5)
