"""Outlines read back from the bytes of tables and of solids."""

from __future__ import annotations

from math import pi

import numpy as np
import pytest
import trimesh.creation
from shapely import Polygon
from trimesh.exchange.stl import export_stl

from ncgear.figures.tables import outline_csv
from ncgear.files.read_back import FOOT, outline_of_csv, outline_of_stl, stl_bytes, written_outlines
from ncgear.pitch.shape import Gear
from ncgear.solids.mesh.pair import SolidPair, gear_solid
from ncgear.solids.mesh.triangles import TriangleMesh, section_rings
from ncgear.solids.plan.body import Blank, Bore, Hub, Keyway
from plane import wave_ring

Array = np.ndarray


def wavy(radius: float = 40.0, count: int = 900) -> Array:
    """A gear-like ring of 20 teeth."""
    return wave_ring(radius, 2.0, 20, count)


def test_a_table_reads_back_exactly() -> None:
    assert np.array_equal(outline_of_csv(outline_csv(wavy()).encode()), wavy())


@pytest.mark.parametrize("bore", [None, Bore(20.0), Bore(20.0, Keyway(6.0, 2.8))])
def test_a_solid_reads_back_as_its_outline(bore: Bore | None) -> None:
    """The same points in the same order, in single precision, whatever is cut out of the middle."""
    found = outline_of_stl(stl_bytes(gear_solid(Gear.DRIVING, wavy(), Blank(12.0, bore), 2.0, 0.005).mesh), 6.0)
    start = int(np.argmin(np.linalg.norm(found - wavy()[0], axis=1)))
    # 2^-24 of 42 mm, on each of both coordinates.
    assert np.abs(np.roll(found, -start, axis=0) - wavy()).max() <= 2.6e-6


def test_a_section_that_is_not_the_outline_is_seen() -> None:
    """Negative control: a solid whose middle is narrower than its ends."""
    ends = trimesh.creation.extrude_polygon(Polygon(wavy()), 4.0)
    waist = trimesh.creation.extrude_polygon(Polygon(wavy(39.9)), 4.0)
    stack = trimesh.util.concatenate(
        [ends, waist.apply_translation([0, 0, 5]), ends.copy().apply_translation([0, 0, 10])]
    )
    found = outline_of_stl(export_stl(stack), 7.0)
    assert np.hypot(*found.T).max() == pytest.approx(41.9, abs=1e-4)


def test_the_foot_of_twisted_teeth_keeps_its_points() -> None:
    """Close above the foot the section has two points at each corner, one of them on a diagonal, and keeps one."""
    straight = gear_solid(Gear.DRIVING, wavy(), Blank(10.0), 2.0, 0.005).mesh
    vertices = straight.vertices
    turn = np.exp(0.01j * (vertices[:, 2] > 5.0)) * (vertices[:, 0] + 1j * vertices[:, 1])
    twisted = TriangleMesh(np.column_stack([turn.real, turn.imag, vertices[:, 2]]), straight.faces)
    found = Polygon(outline_of_stl(stl_bytes(twisted.as_trimesh()), FOOT))
    assert found.boundary.hausdorff_distance(Polygon(wavy()).boundary) <= 1e-5


def test_rings_of_a_ring_run_round_it_outside_and_back_inside() -> None:
    tube = trimesh.creation.annulus(10.0, 20.0, 5.0)
    areas = sorted(
        float(np.sum(x * np.roll(y, -1) - y * np.roll(x, -1))) / 2.0
        for x, y in (ring.T for ring in section_rings(np.asarray(tube.vertices), np.asarray(tube.faces), 1.0))
    )
    assert areas == pytest.approx([-pi * 100.0, pi * 400.0], rel=0.02)


def test_an_open_solid_is_refused() -> None:
    mesh = trimesh.creation.box((10.0, 10.0, 10.0))
    walls = np.nonzero(np.abs(mesh.face_normals[:, 2]) < 0.5)[0]
    holed = np.delete(np.asarray(mesh.faces), walls[0], axis=0)
    with pytest.raises(ValueError, match="not closed at a height of 0"):
        section_rings(np.asarray(mesh.vertices), holed, 0.0)


@pytest.mark.slow
@pytest.mark.parametrize("clearance", [0.0, 0.1])
def test_both_forms_of_both_gears_are_read(clearance: float) -> None:
    """Below a hub that is higher than the gear, above the chamfer, and with the clearance put back on."""
    small, large = wavy(30.0), wavy(50.0)
    blank = Blank(10.0, hub=Hub(20.0, 30.0), chamfer_mm=0.3, clearance_mm=clearance)
    solids = SolidPair(
        gear_solid(Gear.DRIVING, small, blank, 2.0, 0.005), gear_solid(Gear.DRIVEN, large, blank, 2.0, 0.005)
    )
    files = {
        "driving.csv": outline_csv(small).encode(),
        "driven.csv": outline_csv(large).encode(),
        "driving.stl": stl_bytes(solids.driving.mesh),
        "driven.stl": stl_bytes(solids.driven.mesh),
    }
    table, solid = written_outlines(files, solids)
    assert (table.source, solid.source) == ("csv", "stl")
    for outlines in (table, solid):
        assert np.hypot(*outlines.driving_mm.T).max() == pytest.approx(32.0, abs=1e-5)
        assert np.hypot(*outlines.driven_mm.T).max() == pytest.approx(52.0, abs=1e-5)
