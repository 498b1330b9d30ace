"""Solids as binary STL, and what other programs find in a build's files: both are read back from the bytes written.

An STL file is handed out only if it still holds the closed solid that it was made from.  Tooth outlines are read back
from tables and, as sections, from STL files, so that the contact is judged on what was written.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from io import BytesIO, StringIO

import numpy as np
import trimesh
from shapely import Polygon
from trimesh import Trimesh
from trimesh.exchange.stl import export_stl

from ncgear.contact.written.as_written import Outlines
from ncgear.numerics.arrays import Array, IndexArray
from ncgear.numerics.plane import signed_area
from ncgear.solids.mesh.pair import SolidPair
from ncgear.solids.mesh.slabs import require_sound
from ncgear.solids.plan.areas import parallel, rings
from ncgear.solids.plan.body import BodyPlan

VOLUME_TOLERANCE = 1e-5
"""Relative volume that single precision may cost; a millionth is usual, a lost facet costs more than this."""

BOUNDS_TOLERANCE = 1e-6
"""Single precision of a coordinate, relative to the largest one: 2^-24, rounded up generously."""

STRAIGHT_MM = 1e-9
"""Distance from the line through its neighbours at which a point counts as on it: where a section crosses the diagonal
of a flat facet."""

NEAR_MM = 1e-6
"""Distance at which a point of a section is the one before it: next to a corner a diagonal crosses the section, and of
two such points each would be on the line through the other and its other neighbour."""

FOOT_MM = 1e-6
"""Height at which the section of helical teeth is taken: there it is the outline, farther up it has turned."""


def stl_bytes(mesh: Trimesh) -> bytes:
    """The mesh as binary STL, mm in single precision, read back and checked before it is handed out.

    Raises RuntimeError when what was written is not the same closed solid, a fault of ncgear.
    """
    data = export_stl(mesh)
    read_back(data, mesh)
    return data


def read_back(data: bytes, original: Trimesh) -> Trimesh:
    """The solid that an STL file holds, its vertices merged; raises RuntimeError unless it is closed and has the
    volume and the bounds of ``original`` to single precision."""
    mesh = trimesh.load_mesh(BytesIO(data), file_type="stl")
    require_sound(mesh, float(original.volume), VOLUME_TOLERANCE)
    allowed = BOUNDS_TOLERANCE * float(np.abs(original.bounds).max())
    if not np.allclose(mesh.bounds, original.bounds, rtol=0.0, atol=allowed):
        raise RuntimeError(f"a written solid spans {mesh.bounds.tolist()} instead of {original.bounds.tolist()} mm")
    return mesh


def written_outlines(files: Mapping[str, bytes], bodies: SolidPair, *, helical: bool = False) -> list[Outlines]:
    """Both gears' outlines as a build's tables hold them, and as its solids do once the process took its clearance.

    ``files`` maps the names of a build's files to their contents; ``bodies`` is what they were made of; the teeth may
    be ``helical``.  Raises ValueError for a solid that is not closed.
    """
    driving, driven = (
        _outline_of_body(files[f"{name}.stl"], gear.plan, helical)
        for name, gear in (("driving", bodies.driving), ("driven", bodies.driven))
    )
    return [
        Outlines("csv", outline_of_csv(files["driving.csv"]), outline_of_csv(files["driven.csv"])),
        Outlines("stl", driving, driven),
    ]


def _outline_of_body(data: bytes, plan: BodyPlan, helical: bool) -> Array:
    """The tooth outline of a written solid, moved back by the clearance that it was drawn in by."""
    height = FOOT_MM if helical else (plan.chamfer_mm + plan.face_width_mm) / 2.0
    outline = outline_of_stl(data, height, hole=plan.is_ring)
    if plan.clearance_mm == 0.0:
        return outline
    back = parallel(Polygon(outline), -plan.clearance_mm if plan.is_ring else plan.clearance_mm)
    return np.asarray(max(rings(back), key=signed_area)[:-1])


def outline_of_csv(data: bytes) -> Array:
    """The outline in a table of points with one line of headings, in mm, shape (n, 2)."""
    points: Array = np.loadtxt(StringIO(data.decode()), delimiter=",", skiprows=1, ndmin=2)
    return points


def outline_of_stl(data: bytes, height_mm: float | None = None, *, hole: bool = False) -> Array:
    """The outer boundary of a solid's section, in mm, counter-clockwise, shape (n, 2), or that of its largest hole.

    The section is at a height over z = 0, or half way up where none is given.  Raises ValueError unless the mesh is
    closed there.
    """
    mesh = trimesh.load_mesh(BytesIO(data), file_type="stl")
    vertices = np.asarray(mesh.vertices)
    height = (vertices[:, 2].min() + vertices[:, 2].max()) / 2.0 if height_mm is None else height_mm
    found = section_rings(vertices, np.asarray(mesh.faces), height)
    chosen = min(found, key=signed_area)[::-1] if hole else max(found, key=signed_area)
    return _without_straight_points(chosen)


def section_rings(vertices: Array, faces: IndexArray, height: float) -> list[Array]:
    """The rings, shape (n, 2) each, in which a mesh meets the plane at a height; the outer ones counter-clockwise.

    They are followed from facet to facet over the mesh's edges, not over coordinates: rounding can then neither open a
    ring nor join two.  Raises ValueError unless every edge that crosses the plane joins two facets.
    """
    above, count = vertices[:, 2] > height, len(vertices)
    start, end = faces, np.roll(faces, -1, axis=1)
    falling, rising = above[start] & ~above[end], ~above[start] & above[end]
    # Seen from outside, a facet's boundary runs down on the left of its section and up again on the right.
    down, up = (_edge_keys(start[mask], end[mask], count) for mask in (falling, rising))
    edges, place = np.unique(np.concatenate([down, up]), return_inverse=True)
    if edges.size != down.size or np.any(np.bincount(place) != 2):
        raise ValueError(f"the mesh is not closed at a height of {height:g}")
    following = np.empty(edges.size, dtype=int)
    following[place[: down.size]] = place[down.size :]
    one, other = vertices[edges // count], vertices[edges % count]
    share = (height - one[:, 2]) / (other[:, 2] - one[:, 2])
    points: Array = one[:, :2] + share[:, None] * (other[:, :2] - one[:, :2])
    return [points[ring] for ring in _cycles(following.tolist())]


def _edge_keys(start: IndexArray, end: IndexArray, count: int) -> IndexArray:
    """One number for each edge, the same for both facets that it joins."""
    keys: IndexArray = np.minimum(start, end) * count + np.maximum(start, end)
    return keys


def _cycles(following: list[int]) -> Iterator[list[int]]:
    """The cycles of a permutation."""
    left = set(range(len(following)))
    while left:
        ring = [left.pop()]
        while (place := following[ring[-1]]) != ring[0]:
            ring.append(place)
            left.remove(place)
        yield ring


def _without_straight_points(ring: Array) -> Array:
    """A ring without points that are the one before them, or on the line through their neighbours."""
    step = ring - np.roll(ring, 1, axis=0)
    ring = ring[np.hypot(step[:, 0], step[:, 1]) > NEAR_MM]
    before, after = np.roll(ring, 1, axis=0), np.roll(ring, -1, axis=0)
    whole, arm = after - before, ring - before
    aside = np.abs(whole[:, 0] * arm[:, 1] - whole[:, 1] * arm[:, 0])
    return ring[aside > STRAIGHT_MM * np.hypot(whole[:, 0], whole[:, 1])]
