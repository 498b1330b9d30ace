"""The tooth outlines in drawings of gears, read back from the bytes of their files."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from io import StringIO
from xml.etree import ElementTree as Xml

import numpy as np

from ncgear.numerics.arrays import Array, counted_up
from ncgear.numerics.plane import as_complex, as_points
from ncgear.pitch.shape import Gear

FLAT = 1e-7
"""Distance from an arc of the chords by which it is measured, as a share of the largest coordinate: a thousandth of a
usual chord tolerance."""


def read_outlines(files: Mapping[str, bytes]) -> dict[str, tuple[Array, Array]]:
    """The outlines of both gears, shape (n, 2) each, in the drawings among these files, by their kind."""
    found = {}
    for kind, read in READERS.items():
        names = [f"{gear.value}.{kind}" for gear in Gear]
        if all(name in files for name in names):
            found[kind] = (read(files[names[0]]), read(files[names[1]]))
    return found


def outline_of_dxf(data: bytes) -> Array:
    """The tooth outline of a DXF file of one gear in mm, arcs as fine chords, shape (n, 2)."""
    import ezdxf
    from ezdxf.entities.lwpolyline import LWPolyline

    entities = ezdxf.read(StringIO(data.decode())).modelspace()
    (outline,) = (one for one in entities if isinstance(one, LWPolyline) and one.dxf.layer == "OUTLINE")
    rows = np.array(outline.get_points("xyb"))
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


READERS: dict[str, Callable[[bytes], Array]] = {"dxf": outline_of_dxf, "svg": outline_of_svg}


def flattened(points_mm: Array, bulges: Array) -> Array:
    """A closed chain of lines and arcs (see ``ArcOutline``) as chords that stray from arcs by ``FLAT`` at most."""
    start = as_complex(points_mm)
    chord, turn = np.roll(start, -1) - start, 4.0 * np.arctan(bulges)
    height = np.abs(bulges) * np.abs(chord) / 2.0
    count = np.maximum(np.ceil(np.sqrt(height / (FLAT * np.abs(start).max()))), 1).astype(int)
    row, number = counted_up(np.zeros(count.size, dtype=int), count)
    share, turn = number / count[row], turn[row]
    bent = turn != 0.0
    on_arc = share.astype(complex)
    on_arc[bent] = np.expm1(1j * turn[bent] * share[bent]) / np.expm1(1j * turn[bent])
    return as_points(start[row] + chord[row] * on_arc)
