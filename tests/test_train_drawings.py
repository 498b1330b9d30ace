"""The drawings, sheets and prints of a train, read back by other programs: ezdxf, pypdf, lib3mf, shapely."""

from __future__ import annotations

import json
from functools import cache
from io import BytesIO, StringIO
from typing import Any

import ezdxf
import numpy as np
import pytest
import trimesh
from lib3mf import get_wrapper
from pypdf import PdfReader
from shapely import Polygon
from shapely.affinity import rotate, translate

from ncgear.files.read_back import outline_of_csv, outline_of_svg
from ncgear.files.train import judged_train, train_files
from ncgear.files.workshop.train_drawings import facings
from ncgear.numerics.arrays import Array
from ncgear.pitch.shape import Mesh
from ncgear.trains.train import Train
from train_cases import planetary

pytestmark = pytest.mark.judges("trains")

KINDS = ["compound", pytest.param("ring", marks=pytest.mark.slow)]

RING = {
    "idler": "ring",
    "planet_turns": 3,
    "gears": {"teeth": 20, "module_mm": 2.0, "face_width_mm": 8.0, "rim_mm": 6.0},
}


def made(kind: str) -> Train:
    return planetary(arms=2) if kind == "compound" else planetary(arms=2, **RING)


@cache
def files(kind: str) -> dict[str, bytes]:
    return train_files(kind, judged_train(kind, "", made(kind), lambda _: None), lambda _: None)


@pytest.mark.parametrize("kind", KINDS)
def test_drawings_hold_the_written_outlines_and_round_holes(kind: str) -> None:
    """ezdxf reads closed contours on named layers; equal parts have one drawing, which names all of them."""
    train = made(kind)
    assert set(train.alike.values()) == {
        name.removesuffix(".dxf") for name in files(kind) if name.endswith(".dxf") and "_drawing" not in name
    }
    for part in train.parts:
        first = train.alike[part.name]
        document = ezdxf.read(StringIO(files(kind)[f"{first}.dxf"].decode()))
        assert document.units == ezdxf.units.MM
        by_layer: dict[str, list[Any]] = {}
        for entity in document.modelspace():
            by_layer.setdefault(entity.dxf.layer, []).append(entity)
        (outline,) = by_layer["OUTLINE"]
        assert outline.closed
        written = outline_of_csv(files(kind)[f"{part.name}.csv"])
        assert np.abs(np.array(outline.get_points("xy")) - written).max() < 1e-6
        assert np.abs(outline_of_svg(files(kind)[f"{first}.svg"]) - written).max() < 1e-6
        holes = [(0.0, 0.0, part.bore_mm)] if part.bore_mm is not None else []
        holes += [(hole.x_mm, hole.y_mm, hole.diameter_mm) for hole in part.holes]
        drawn = [(*bore.dxf.center.vec2, 2.0 * bore.dxf.radius) for bore in by_layer.get("BORE", [])]
        assert drawn == [pytest.approx(hole, abs=1e-6) for hole in holes]
        assert len(by_layer.get("RIM", [])) == (part.rim_mm is not None)
        notes = " ".join(value for _, value in document.header.custom_vars)
        assert all(other in notes for other, same in train.alike.items() if same == first)


@pytest.mark.parametrize("kind", KINDS)
def test_what_faces_each_other_lies_on_the_line_of_centres_of_the_written_poses(kind: str) -> None:
    """Turned by its written angle, each facing direction points at the mate's axis; a ring's gear points away from it.

    There both outlines are nearest to each other, or nearly: teeth stand within half a pitch of the line.
    """
    train, assembly = made(kind), json.loads(files(kind)["assembly.json"])
    parts = {part["name"]: part for part in assembly["parts"]}
    pairs = {frozenset((mesh.first, mesh.second)): mesh for mesh in train.meshes}
    for name in (part.name for part in train.parts if part.teeth):
        for each in facings(train, name):
            mesh = pairs[frozenset((name, each.mate))]
            here, there = (complex(parts[one]["x_mm"][0], parts[one]["y_mm"][0]) for one in (name, each.mate))
            assert each.distance_mm == pytest.approx(abs(there - here), rel=1e-12)
            own, mate = each.own_rad + parts[name]["angle_rad"][0], each.mate_rad + parts[each.mate]["angle_rad"][0]
            if mesh.kind is Mesh.EXTERNAL:
                assert np.exp(1j * own) == pytest.approx((there - here) / abs(there - here), abs=1e-9)
                assert np.exp(1j * mate) == pytest.approx(-np.exp(1j * own), abs=1e-9)
            else:
                ring_to_planet = (here - there) if name == mesh.first else (there - here)
                assert np.exp(1j * own) == pytest.approx(ring_to_planet / abs(ring_to_planet), abs=1e-9)
                assert np.exp(1j * mate) == pytest.approx(np.exp(1j * own), abs=1e-9)
            gap = placed(parts[name], outline(kind, name)).exterior.distance(
                placed(parts[each.mate], outline(kind, each.mate)).exterior
            )
            assert gap < 0.1


def outline(kind: str, name: str) -> Array:
    return outline_of_csv(files(kind)[f"{name}.csv"])


def placed(part: dict[str, Any], outline_mm: Array) -> Polygon:
    turned = rotate(Polygon(outline_mm), part["angle_rad"][0], origin=(0.0, 0.0), use_radians=True)
    return translate(turned, part["x_mm"][0], part["y_mm"][0])


@pytest.mark.parametrize("kind", KINDS)
def test_sheets_tell_every_mate_and_the_place_of_every_part(kind: str) -> None:
    train, assembly = made(kind), json.loads(files(kind)["assembly.json"])
    for part in (part for part in train.parts if part.teeth and train.alike[part.name] == part.name):
        told = text_of(files(kind)[f"{part.name}_drawing.pdf"])
        for each in facings(train, part.name):
            assert f"faces {each.mate}" in told
            assert all(words in told for words in each.directions)
        assert f"{part.teeth} teeth" in told
    told = text_of(files(kind)["assembly_drawing.pdf"])
    for one in assembly["parts"]:
        degrees = np.degrees(one["angle_rad"][0]) % 360.0
        for words in (one["name"], f"{one['x_mm'][0] + 0.0:.4f}", f"{round(degrees, 3) % 360.0:.3f}"):
            assert words.replace("-0.0000", "0.0000") in told
    for name in ("assembly", "sun" if kind == "compound" else "ring"):
        document = ezdxf.read(StringIO(files(kind)[f"{name}_drawing.dxf"].decode()))
        assert not document.audit().has_errors
        assert files(kind)[f"{name}_drawing.svg"].startswith(b"<?xml")


def text_of(pdf: bytes) -> str:
    (page,) = PdfReader(BytesIO(pdf)).pages
    return page.extract_text()


@pytest.mark.parametrize("kind", KINDS)
def test_one_print_holds_every_part_where_the_assembly_says(kind: str) -> None:
    """By the 3MF Consortium's own library: the volume and the box of each part's STL, placed by assembly.json."""
    model = get_wrapper().CreateModel()
    reader = model.QueryReader("3mf")
    reader.SetStrictModeActive(True)
    reader.ReadFromBuffer(files(kind)["train.3mf"])
    assert reader.GetWarningCount() == 0
    items, found = model.GetBuildItems(), {}
    while items.MoveNext():
        item = items.GetCurrent()
        solid = model.GetMeshObjectByID(item.GetObjectResource().GetUniqueResourceID())
        fields = np.array([list(row) for row in item.GetObjectTransform().Fields])
        points = np.array([list(vertex.Coordinates) for vertex in solid.GetVertices()]) @ fields[:3] + fields[3]
        faces = [list(triangle.Indices) for triangle in solid.GetTriangleIndices()]
        found[item.GetPartNumber()] = trimesh.Trimesh(points, faces, process=False)
    parts = {part["name"]: part for part in json.loads(files(kind)["assembly.json"])["parts"]}
    assert found.keys() == parts.keys()
    for name, part in parts.items():
        solid = trimesh.load(BytesIO(files(kind)[f"{name}.stl"]), file_type="stl")
        turn = trimesh.transformations.rotation_matrix(part["angle_rad"][0], [0.0, 0.0, 1.0])
        turn[:3, 3] = part["x_mm"][0], part["y_mm"][0], made(kind).part(name).low_mm
        solid.apply_transform(turn)
        assert found[name].volume == pytest.approx(solid.volume, rel=1e-5)
        assert found[name].bounds == pytest.approx(solid.bounds, abs=1e-3)
        assert found[name].is_watertight
