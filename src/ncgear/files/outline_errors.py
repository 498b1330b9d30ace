"""How far tooth outlines in files are from the exact ones: measured on what is written, read back.

Points of the exact curves, that no chord and no arc knows of, are held against the outline of each file.  The faces of
STEP files are held against them when they are made, between the places that they go through.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from itertools import pairwise
from xml.etree import ElementTree as Xml

import numpy as np
import shapely
from numpy.typing import NDArray

from ncgear.contact.written.as_written import Outlines
from ncgear.numerics.arrays import Array, counted_up
from ncgear.numerics.plane import as_complex, as_points
from ncgear.pitch.shape import Gear
from ncgear.project.drive import Drive
from ncgear.teeth.gear import ToothedGear
from ncgear.teeth.outline import exact_curves

PER_CURVE = 21
"""Points of each flank, fillet and land that are looked at, at equal shares beside all that chords and arcs go by."""

OFF_GRID = 0.382
"""Share of the way between two of these points at which the first one lies."""

FLAT_MM = 5e-6
"""Distance from an arc of the chords by which it is measured: a thousandth of a usual chord tolerance."""

CHORDS = 8
"""Chords of an outline that are found as one line."""

FEW = 16
"""Every so many points are measured at once; each of the others where they do not show that it is nearer."""


def outline_errors_mm(drive: Drive, files: Mapping[str, bytes], outlines: list[Outlines]) -> dict[str, float]:
    """The largest distance of both gears' exact curves from their outlines in the files of each kind, by its name.

    ``outlines`` are those of tables and solids, read back.  Drawings of gears from which a process takes its clearance
    are left out: their outlines are parallels.
    """
    found = {one.source: (one.driving_mm, one.driven_mm) for one in outlines}
    if drive.gears.process_clearance_mm == 0.0:
        for kind, read in READERS.items():
            names = [f"{gear.value}.{kind}" for gear in Gear]
            if all(name in files for name in names):
                found[kind] = (read(files[names[0]]), read(files[names[1]]))
    exact = [shapely.points(exact_points(drive.teeth.of(gear))) for gear in Gear]
    errors = {kind: max(map(farthest_mm, exact, both)) for kind, both in found.items()}
    if "pair.step" in files:
        errors["step"] = error_of_step_mm(files["pair.step"])
    return errors


def exact_points(gear: ToothedGear) -> Array:
    """Points of all exact curves of a gear's outline, shape (n, 2)."""
    share = (np.arange(PER_CURVE) + OFF_GRID) / PER_CURVE
    stretches = exact_curves(gear.tips, gear.sides)
    points = [one.at(np.arange(one.owner.size)[:, None], share)[0].reshape(-1, 2) for one in stretches]
    return np.concatenate(points)


def farthest_mm(places: NDArray[np.object_], outline_mm: Array) -> float:
    """The largest distance of places (n,) from a closed line through points (m, 2)."""
    # Lines of a few chords: hardly more is measured than with each chord by itself, and far fewer lines are made.
    first = np.arange(0, len(outline_mm), CHORDS)
    last = np.minimum(first + CHORDS, len(outline_mm))
    line, corner = counted_up(first, last - first + 1)
    tree = shapely.STRtree(shapely.linestrings(outline_mm[corner % len(outline_mm)], indices=line))
    # Most points are seen to be nearer than the farthest of a few; only the others are measured.
    few = _farthest_mm(places[::FEW], tree)
    nearer, _ = tree.query(places, predicate="dwithin", distance=few)
    return max(few, _farthest_mm(np.delete(places, nearer), tree))


def _farthest_mm(places: NDArray[np.object_], tree: shapely.STRtree) -> float:
    """The largest distance of places from the nearest line of a tree each; 0 for no places."""
    _, distance = tree.query_nearest(places, return_distance=True, all_matches=False)
    return float(distance.max(initial=0.0))


def outline_of_dxf(data: bytes) -> Array:
    """The tooth outline of a DXF file of one gear in mm, arcs as fine chords, shape (n, 2).

    A DXF file is a line with a code and a line with a value in turn; code 0 begins an entity, 8 tells its layer, and of
    a polyline 10, 20 and 42 tell the coordinates of its points and the bulges that are not 0.
    """
    lines = data.decode().splitlines()
    codes, values = np.array(lines[::2], dtype=int), lines[1::2]
    begins = np.append(np.flatnonzero(codes == 0), codes.size)
    (own,) = (
        slice(first, last)
        for first, last in pairwise(begins.tolist())
        if values[first] == "LWPOLYLINE" and values[first + codes[first:last].tolist().index(8)] == "OUTLINE"
    )
    points: list[list[float]] = []
    bulges: list[float] = []
    for code, value in zip(codes[own].tolist(), values[own], strict=True):
        if code == 10:
            points.append([float(value)])
            bulges.append(0.0)
        elif code == 20:
            points[-1].append(float(value))
        elif code == 42:
            bulges[-1] = float(value)
    return flattened(np.array(points), np.array(bulges))


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


def error_of_step_mm(data: bytes) -> float:
    """What the head of a STEP file says of its faces, which were held against the exact curves when they were made."""
    head = b" ".join(data.split(b"ENDSEC", 1)[0].split())
    (error,) = re.findall(rb"tooth faces within (\S+) mm", head)
    return float(error)


READERS: dict[str, Callable[[bytes], Array]] = {"dxf": outline_of_dxf, "svg": outline_of_svg}


def flattened(points_mm: Array, bulges: Array) -> Array:
    """A closed chain of lines and arcs (see ``ArcOutline``) as chords that stray from arcs by ``FLAT_MM`` at most."""
    start = as_complex(points_mm)
    chord, turn = np.roll(start, -1) - start, 4.0 * np.arctan(bulges)
    height = np.abs(bulges) * np.abs(chord) / 2.0
    count = np.maximum(np.ceil(np.sqrt(height / FLAT_MM)), 1).astype(int)
    row, number = counted_up(np.zeros(count.size, dtype=int), count)
    share, turn = number / count[row], turn[row]
    bent = turn != 0.0
    on_arc = share.astype(complex)
    on_arc[bent] = np.expm1(1j * turn[bent] * share[bent]) / np.expm1(1j * turn[bent])
    return as_points(start[row] + chord[row] * on_arc)
