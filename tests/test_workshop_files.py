"""Files for the workshop, each read back by a program that did not write it and held against the solids' sections."""

from __future__ import annotations

import json
from collections.abc import Callable
from functools import cache
from io import BytesIO, StringIO
from pathlib import Path

import ezdxf
import numpy as np
import pygltflib
import pytest
import shapely
from commands import Run
from lib3mf import get_wrapper
from shapely import Polygon
from svgelements import SVG
from svgelements import Path as SvgPath

from ncgear.design.load import load
from ncgear.drive import Drive
from ncgear.numerics.arrays import Array
from ncgear.output.workshop import formats
from ncgear.output.workshop.drawing import Layer
from ncgear.output.workshop.formats import workshop_files
from ncgear.output.workshop.kinds import Format
from ncgear.pitch.shape import Gear
from oracles import dxf

ROOT = Path(__file__).parents[1]

DESIGNS = ["baler", "ellipse", "internal-1-2"]
"""Keyway and concave curves; a bore alone; a ring."""

ROUNDING_MM = 2e-6
"""Of coordinates with six decimals, twice; other files have all digits."""

ARC_MM = 1e-5
"""Of the readers' own chords of arcs: a radius of 40 mm in steps of a thousandth of a radian."""


@cache
def drive(name: str) -> Drive:
    return Drive(load(ROOT / "designs" / f"{name}.yaml").design)


@cache
def files(name: str) -> dict[str, bytes]:
    return workshop_files(drive(name), tuple(kind for kind in Format if kind is not Format.STEP))


def outline(name: str, gear: Gear) -> Array:
    """Of the teeth, as the build's table has it."""
    teeth = drive(name).teeth
    return (teeth.driving if gear is Gear.DRIVING else teeth.driven).outline_mm


def apart_mm(points: Array, other: Array) -> float:
    """The greatest distance between two closed lines through points (n, 2)."""
    lines = [shapely.LinearRing(line) for line in (points, other)]
    return float(max(shapely.distance(shapely.points(a), line).max() for a, line in zip((points, other), lines[::-1])))


def section(name: str, gear: Gear) -> Polygon:
    solids = drive(name).solids
    return (solids.driving if gear is Gear.DRIVING else solids.driven).plan.section


# --- DXF -------------------------------------------------------------------------------------------------------------


def drawn(data: bytes, layer: str) -> list[dxf.Entity]:
    return [one for one in dxf.entities(data.decode()) if one.layer == layer]


def cut_area(data: bytes, prefix: str = "") -> Polygon:
    """What a machine leaves that cuts all contours of the three layers: the largest less all others."""
    rings = [Polygon(one.points()) for layer in formats_cut() for one in drawn(data, f"{prefix}{layer}")]
    largest = max(rings, key=lambda ring: ring.area)
    return largest.difference(shapely.union_all([ring for ring in rings if ring is not largest]))


def formats_cut() -> tuple[str, ...]:
    return Layer.OUTLINE.value, Layer.BORE.value, Layer.HOLES.value


@pytest.mark.parametrize("gear", Gear)
@pytest.mark.parametrize("name", DESIGNS)
def test_a_drawing_has_the_outline_to_rounding(name: str, gear: Gear) -> None:
    data = files(name)[f"{gear.value}.dxf"]
    (teeth,) = (one for one in drawn(data, "OUTLINE") if one.kind == "LWPOLYLINE")
    assert teeth.closed
    assert apart_mm(np.array(teeth.points()), outline(name, gear)) <= 1e-9
    # Round edges are arcs there and chords in the solid.
    assert cut_area(data).symmetric_difference(section(name, gear)).buffer(-0.003).is_empty


def test_a_gear_a_thousandth_larger_is_seen() -> None:
    (teeth,) = drawn(files("ellipse")["driving.dxf"], "OUTLINE")
    assert apart_mm(1.001 * np.array(teeth.points()), outline("ellipse", Gear.DRIVING)) > 0.01
    larger = shapely.affinity.scale(cut_area(files("ellipse")["driving.dxf"]), 1.001, 1.001, origin=(0.0, 0.0))
    assert not larger.symmetric_difference(section("ellipse", Gear.DRIVING)).buffer(-0.003).is_empty


def test_the_keyway_is_exact() -> None:
    """An arc by its bulge: the reader's arc runs on the bore's circle, and its sides are the keyway's."""
    (bore,) = drawn(files("baler")["driving.dxf"], "BORE")
    points = np.array(bore.points())
    radius = np.hypot(*points.T)
    on_circle = points[:, 0] < np.sqrt(8.0**2 - 2.5**2)
    assert np.abs(radius[on_circle] - 8.0).max() <= 1e-12
    assert points[~on_circle][:, 0].max() == pytest.approx(8.0 + 2.3, abs=1e-12)
    assert Polygon(points).area == pytest.approx(Polygon(section("baler", Gear.DRIVING).interiors[0]).area, abs=0.2)


@pytest.mark.parametrize("name", DESIGNS)
def test_drawings_are_in_mm_with_every_layer_declared(name: str) -> None:
    for file, data in files(name).items():
        if not file.endswith(".dxf"):
            continue
        assert dxf.header(data.decode())["$INSUNITS"] == "4"
        document = ezdxf.read(StringIO(data.decode()))
        audit = document.audit()
        assert (audit.errors, audit.fixes) == ([], [])
        layers = {one.layer for one in dxf.entities(data.decode())}
        assert layers <= {layer.dxf.name for layer in document.layers}
        assert all(one.closed for one in dxf.entities(data.decode()) if one.kind != "LINE")
        assert any("no farther than 0.005 mm" in note for _, note in document.header.custom_vars)


def test_the_axis_is_marked_across() -> None:
    lines = drawn(files("baler")["driven.dxf"], "AXIS")
    ends = np.array([[[one.number(10), one.number(20)], [one.number(11), one.number(21)]] for one in lines])
    assert np.allclose(ends.mean(axis=1), 0.0)
    assert np.allclose(np.diff(ends, axis=1)[:, 0], [[6.0, 0.0], [0.0, 6.0]])


def test_the_pair_is_drawn_as_assembled() -> None:
    data, distance = files("baler")["pair.dxf"], drive("baler").pitch.center_distance_mm
    driving, driven = (cut_area(data, f"{gear.value.upper()}_") for gear in Gear)
    assert driving.intersection(driven).buffer(-0.005).is_empty
    (axis, _) = drawn(data, "DRIVEN_AXIS")
    assert (axis.number(10) + axis.number(11)) / 2.0 == pytest.approx(distance, abs=1e-9)


# --- SVG -------------------------------------------------------------------------------------------------------------


def svg_rings(data: bytes, layer: str) -> list[Array]:
    """Contours of a layer in mm with y up: one inch is 25.4 units."""
    image = SVG.parse(BytesIO(data), ppi=25.4, reify=True)
    found = [group for group in image.select(lambda one: getattr(one, "id", None) == layer)]
    paths = [path for group in found for path in group.select(lambda one: isinstance(one, SvgPath))]
    origin = np.array(viewbox(data)[:2])
    return [(np.array([(p.x, p.y) for p in all_along(path)]) + origin) * (1.0, -1.0) for path in paths]


def all_along(path: SvgPath) -> list[object]:
    return [point for segment in path.segments() for point in segment.npoint(np.linspace(0.0, 1.0, 33)[:-1])]


def viewbox(data: bytes) -> list[float]:
    return [float(word) for word in SVG.parse(BytesIO(data)).values["attributes"]["viewBox"].split()]
