"""Meshes of triangles, held against trimesh and against closed forms: integrals, soundness, merging, STL."""

from __future__ import annotations

from dataclasses import replace
from io import BytesIO

import numpy as np
import pytest
import trimesh
from trimesh.exchange.stl import export_stl

from meshes import as_trimesh
from ncgear.solids.mesh.triangles import TriangleMesh, from_stl, joined


def tilted_box() -> TriangleMesh:
    """A box of 2, 3 and 5 mm, turned and away from the origin."""
    box = trimesh.creation.box((2.0, 3.0, 5.0))
    box.apply_transform(trimesh.transformations.rotation_matrix(0.7, [1.0, 2.0, 3.0]))
    box.apply_translation([4.0, -1.0, 2.0])
    return TriangleMesh(np.array(box.vertices), np.array(box.faces))


def random_body() -> TriangleMesh:
    """The hull of random points: no symmetry hides a wrong sign."""
    hull = trimesh.convex.convex_hull(np.random.default_rng(3).normal(size=(60, 3)) * [1.0, 4.0, 9.0] + [5.0, 1.0, 2.0])
    return TriangleMesh(np.array(hull.vertices), np.array(hull.faces))


@pytest.mark.judges("solids")
@pytest.mark.parametrize("mesh", [tilted_box(), random_body()])
def test_integrals_are_those_of_trimesh(mesh: TriangleMesh) -> None:
    judge = as_trimesh(mesh)
    assert mesh.volume == pytest.approx(float(judge.volume), rel=1e-13)
    np.testing.assert_allclose(mesh.center_mass, judge.center_mass, rtol=1e-12)
    np.testing.assert_allclose(
        mesh.moment_inertia, judge.moment_inertia, atol=1e-11 * np.abs(judge.moment_inertia).max()
    )
    np.testing.assert_allclose(mesh.normals, judge.face_normals, atol=1e-14)
    np.testing.assert_array_equal(mesh.bounds, judge.bounds)


def test_integrals_of_a_box_in_closed_form() -> None:
    box = tilted_box()
    assert box.volume == pytest.approx(30.0, rel=1e-13)
    assert box.center_mass == pytest.approx([4.0, -1.0, 2.0], rel=1e-12)
    parts = sorted([30.0 * (9.0 + 25.0) / 12.0, 30.0 * (4.0 + 25.0) / 12.0, 30.0 * (4.0 + 9.0) / 12.0])
    assert np.linalg.eigvalsh(box.moment_inertia) == pytest.approx(parts, rel=1e-11)


def test_a_body_that_is_not_sound_is_seen() -> None:
    body = random_body()
    assert body.is_watertight
    assert body.is_winding_consistent
    assert not replace(body, faces=body.faces[1:]).is_watertight
    turned = body.faces.copy()
    turned[0] = turned[0, ::-1]
    assert replace(body, faces=turned).is_watertight
    assert not replace(body, faces=turned).is_winding_consistent
    # An edge of three triangles.
    assert not replace(body, faces=np.vstack([body.faces, body.faces[:1]])).is_watertight


def test_vertices_are_merged_as_trimesh_does() -> None:
    body = random_body()
    # Every triangle has corners of its own, with noise far below the resolution, and a vertex is unused.
    noise = np.random.default_rng(5).uniform(-1e-10, 1e-10, (body.faces.size, 3))
    loose = np.round(body.triangles.reshape(-1, 3), 6) + noise
    apart = TriangleMesh(np.vstack([[[99.0, 0.0, 0.0]], loose]), 1 + np.arange(len(loose)).reshape(-1, 3))
    merged, judge = apart.merged(), trimesh.Trimesh(apart.vertices, apart.faces)
    np.testing.assert_array_equal(merged.vertices, judge.vertices)
    np.testing.assert_array_equal(merged.faces, judge.faces)
    assert merged.is_watertight
    assert not apart.is_watertight


def test_sheets_that_share_edges_are_joined() -> None:
    body = random_body()
    sheets = [replace(body, faces=part) for part in np.array_split(body.faces, 5)]
    whole = joined([sheet.without_unused() for sheet in sheets])
    assert len(whole.vertices) == len(body.vertices)
    np.testing.assert_array_equal(whole.triangles, body.triangles)


def test_stl_is_that_of_trimesh_and_reads_back() -> None:
    body = random_body()
    data = body.as_stl()
    assert data == export_stl(as_trimesh(body))
    judge = trimesh.load_mesh(BytesIO(data), file_type="stl")
    again = from_stl(data)
    np.testing.assert_array_equal(again.vertices, judge.vertices)
    np.testing.assert_array_equal(again.faces, judge.faces)
    for wrong in (data[:-1], data[:60], data + b"\0"):
        with pytest.raises(ValueError, match="not as long as"):
            from_stl(wrong)
