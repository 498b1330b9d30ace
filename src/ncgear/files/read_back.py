"""Solids as binary STL, and tooth outlines read back from the files of a build: tables, STL files, drawings.

Every STL file is read back: it is used only if it still holds the closed solid that it was made from.  The contact is
judged on written outlines.  They are compared with points of the exact curves that no chord and no arc was made from.
STEP files are compared with the exact curves when they are made, between the points that their faces pass through.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from functools import lru_cache
from io import StringIO
from typing import TYPE_CHECKING
from xml.etree import ElementTree as Xml

import numpy as np
from shapely import Polygon

from ncgear.contact.written.as_written import Outlines
from ncgear.errors import Unanswered
from ncgear.metrology.exact_outline import exact_points, farthest_mm
from ncgear.numerics.arrays import Array, counted_up
from ncgear.numerics.plane import as_complex, as_points, signed_area
from ncgear.pitch.shape import Gear
from ncgear.solids.mesh.pair import SolidPair
from ncgear.solids.mesh.slabs import require_sound
from ncgear.solids.mesh.triangles import TriangleMesh, merged, section_rings
from ncgear.solids.plan.areas import parallel, rings
from ncgear.solids.plan.body import BodyPlan
from ncgear.teeth.gear import ToothedPair

if TYPE_CHECKING:
    from trimesh import Trimesh

VOLUME_TOLERANCE = 1e-5
"""Largest relative error of the volume by single precision; a millionth is usual, and a lost facet costs more."""

BOUNDS_TOLERANCE = 1e-6
"""Largest error of a coordinate in single precision, divided by the largest one: 2^-24, rounded up generously."""

STRAIGHT = 3e-11
"""A point nearer than this to the line through its neighbours, as a share of the largest coordinate, is on that line.

Such points arise where a section crosses the diagonal of a flat facet.
"""

NEAR = 3e-8
"""A point of a section this near to the point before it, as a share of the largest coordinate, is the same point.

Two such points arise where a diagonal crosses the section next to a corner.  Each would be on the line through the
other one and its other neighbour.
"""

STL_HEAD_BYTES = 84
"""Bytes of binary STL before its triangles; the last four are the number of triangles."""

STL_TRIANGLE = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
"""The record of a triangle in binary STL."""

FOOT = 1e-7
"""Height of the section of helical teeth, as a share of the face width: this low, the section has hardly turned against
the outline."""


def stl_bytes(mesh: Trimesh) -> bytes:
    """The mesh as binary STL, mm in single precision, read back and checked before it is handed out.

    Raises Unanswered when the bytes do not hold the same closed solid.
    """
    from trimesh.exchange.stl import export_stl

    data: bytes = export_stl(mesh)
    read_back(data, mesh)
    return data


@lru_cache(maxsize=2)
def mesh_of_stl(data: bytes) -> TriangleMesh:
    """The triangles of a binary STL file, with corners at the same place as one vertex.

    Raises ValueError where the file is not as long as it says.  Kept, since the outlines of both gears are taken from
    the files that were read back, each in 34 ms with 400 teeth.
    """
    count = int.from_bytes(data[STL_HEAD_BYTES - 4 : STL_HEAD_BYTES], "little")
    if len(data) != STL_HEAD_BYTES + count * STL_TRIANGLE.itemsize:
        raise ValueError(f"an STL file of {len(data)} bytes does not hold {count} triangles")
    corners = np.frombuffer(data, STL_TRIANGLE, offset=STL_HEAD_BYTES)["corners"].reshape(-1, 3).astype(float)
    return merged(corners, np.arange(len(corners)).reshape(-1, 3))


def read_back(data: bytes, original: TriangleMesh | Trimesh) -> TriangleMesh:
    """The solid in an STL file, its vertices merged.

    Raises Unanswered unless it is closed and has the volume and the bounds of ``original`` to single precision.
    """
    mesh = mesh_of_stl(data)
    require_sound(mesh, original.volume, VOLUME_TOLERANCE)
    allowed = BOUNDS_TOLERANCE * float(np.abs(original.bounds).max())
    if not np.allclose(mesh.bounds, original.bounds, rtol=0.0, atol=allowed):
        raise Unanswered(f"a written solid spans {mesh.bounds.tolist()} instead of {original.bounds.tolist()} mm")
    return mesh


def written_outlines(files: Mapping[str, bytes], bodies: SolidPair, *, helical: bool = False) -> list[Outlines]:
    """Both gears' outlines from the tables of a build, and from its solids without the clearance of the process.

    ``files`` maps the names of a build's files to their contents; ``bodies`` are the solids that they were made from;
    ``helical`` says whether the teeth are helical.  Raises ValueError for a solid that is not closed.
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
    """The tooth outline of a written solid, moved outwards by the clearance that was taken off the solid."""
    height = FOOT * plan.face_width_mm if helical else (plan.chamfer_mm + plan.face_width_mm) / 2.0
    outline = outline_of_stl(data, height, hole=plan.is_ring)
    if plan.clearance_mm == 0.0:
        return outline
    back = parallel(Polygon(outline), -plan.clearance_mm if plan.is_ring else plan.clearance_mm)
    return np.asarray(max(rings(back), key=signed_area)[:-1])


def outline_of_csv(data: bytes) -> Array:
    """The outline in a table of points with one line of headings, in mm, shape (n, 2)."""
    return np.loadtxt(StringIO(data.decode()), delimiter=",", skiprows=1, ndmin=2)


def outline_of_stl(data: bytes, height_mm: float, *, hole: bool = False) -> Array:
    """The outer boundary of a solid's section, or with ``hole`` the boundary of its largest hole, in mm, shape (n, 2).

    The boundary runs counter-clockwise.  The section is at a height above z = 0.  Raises ValueError unless the mesh is
    closed there.
    """
    mesh = mesh_of_stl(data)
    found = section_rings(mesh.vertices, mesh.faces, height_mm)
    ring = min(found, key=signed_area)[::-1] if hole else max(found, key=signed_area)
    # Points go that repeat the point before them, or are on the line through their neighbours.
    step, size = ring - np.roll(ring, 1, axis=0), float(np.abs(ring).max())
    ring = ring[np.hypot(step[:, 0], step[:, 1]) > NEAR * size]
    before, after = np.roll(ring, 1, axis=0), np.roll(ring, -1, axis=0)
    whole, arm = after - before, ring - before
    aside = np.abs(whole[:, 0] * arm[:, 1] - whole[:, 1] * arm[:, 0])
    return ring[aside > STRAIGHT * size * np.hypot(whole[:, 0], whole[:, 1])]


FLAT = 1e-7
"""Largest distance between an arc and its chords, as a share of the largest coordinate: a thousandth of a usual chord
tolerance."""


DXF_POLYLINE = re.compile(r"^  0\nLWPOLYLINE\n(.*?)^  0\n", re.DOTALL | re.MULTILINE)
DXF_VERTEX = re.compile(r"^ 10\n(.+)\n 20\n(.+)\n(?: 42\n(.+)\n)?", re.MULTILINE)
"""A polyline of a DXF file, and its points with their bulges: group codes and values, each on a line of its own."""


def outline_of_dxf(data: bytes) -> Array:
    """The tooth outline of a DXF file of one gear in mm, arcs as fine chords, shape (n, 2)."""
    (outline,) = (text for text in DXF_POLYLINE.findall(data.decode()) if "  8\nOUTLINE\n" in text)
    rows = np.array([(x, y, bulge or "0") for x, y, bulge in DXF_VERTEX.findall(outline)], dtype=float)
    return flattened(rows[:, :2], rows[:, 2])


STEP = re.compile(r"([MLA])([^MLAZ]*)")
NUMBER = re.compile(r"[-+]?\d+(?:\.\d+)?")


def outline_of_svg(data: bytes) -> Array:
    """The tooth outline of an SVG file in mm, y up, arcs as fine chords, shape (n, 2)."""
    space = "{http://www.w3.org/2000/svg}"
    (path,) = Xml.fromstring(data).iterfind(f".//{space}g[@id='OUTLINE']/{space}path")
    steps = [(kind, [float(word) for word in NUMBER.findall(rest)]) for kind, rest in STEP.findall(path.attrib["d"])]
    points = np.array([numbers[-2:] for _, numbers in steps])
    chord = np.hypot(*np.diff(points, axis=0).T)
    bulges = np.zeros(len(points))
    for row, (kind, numbers) in enumerate(steps[1:]):
        if kind == "A":
            turned = 2.0 * np.arcsin(min(chord[row] / 2.0 / numbers[0], 1.0))
            bulges[row] = (1.0 if numbers[4] else -1.0) * np.tan(turned / 4.0)
    # The path comes back to its first point.
    return flattened(points[:-1], bulges[:-1])


def flattened(points_mm: Array, bulges: Array) -> Array:
    """A closed chain of lines and arcs (see ``ArcOutline``) as chords that stray from arcs by ``FLAT`` at most."""
    points = as_complex(points_mm)
    height = np.abs(bulges) * np.abs(np.roll(points, -1) - points) / 2.0
    return as_chords(points_mm, bulges, np.sqrt(height / (FLAT * np.abs(points).max())))


def as_chords(points_mm: Array, bulges: Array, least: Array) -> Array:
    """A closed chain of lines and arcs (see ``ArcOutline``) as chords, ``least`` (n,) or more for each."""
    start, count = as_complex(points_mm), np.maximum(np.ceil(least), 1).astype(int)
    chord, turn = np.roll(start, -1) - start, 4.0 * np.arctan(bulges)
    row, number = counted_up(np.zeros(count.size, dtype=int), count)
    share, turn = number / count[row], turn[row]
    bent = turn != 0.0
    on_arc = share.astype(complex)
    on_arc[bent] = np.expm1(1j * turn[bent] * share[bent]) / np.expm1(1j * turn[bent])
    return as_points(start[row] + chord[row] * on_arc)


ExactOutlines = tuple[Array, Array]
"""Points of all exact curves of the driving and of the driven gear, shape (n, 2) each."""

ERRORS = f"{__name__}:outline_errors_mm"


def exact_outlines(teeth: ToothedPair) -> ExactOutlines:
    """The points against which outlines are measured."""
    return exact_points(teeth.of(Gear.DRIVING)), exact_points(teeth.of(Gear.DRIVEN))


def outline_errors_mm(exact_mm: ExactOutlines, outlines_mm: Mapping[str, tuple[Array, Array]]) -> dict[str, float]:
    """The largest distance of both gears' exact curves from the outlines of each kind of file, by its name."""
    return {kind: max(map(farthest_mm, exact_mm, both)) for kind, both in outlines_mm.items()}


def error_of_step_mm(data: bytes) -> float:
    """The error of the faces in mm that the head of a STEP file names; it was measured when the file was made."""
    head = b" ".join(data.split(b"ENDSEC", 1)[0].split())
    (error,) = re.findall(rb"tooth faces within (\S+) mm", head)
    return float(error)
