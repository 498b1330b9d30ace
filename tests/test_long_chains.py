"""Long chains of drawings against what the libraries read of them."""

from __future__ import annotations

from collections.abc import Callable
from math import cos, pi, sin
from pathlib import Path
from typing import Any

import ezdxf
import numpy as np
import pytest

from ncgear.design.reading import contour_file, long_chains
from ncgear.design.reading.contour_file import contour_of
from ncgear.design.reading.long_chains import DxfText, svg_chain, svg_points
from ncgear.design.reading.svg_file import svg_contour_of

COUNT = 50
"""Vertices of the chains, of which 40 count as many here."""

POINTS = [(round(30.0 * cos(2 * pi * i / COUNT), 5), round(24.0 * sin(2 * pi * i / COUNT), 5)) for i in range(COUNT)]


@pytest.fixture(autouse=True)
def forty_are_many(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(long_chains, "LONG", 40)


def polyline(space: Any) -> None:
    space.add_lwpolyline(POINTS, close=True)


def bulged(space: Any) -> None:
    """Arcs with widths; a later polyline has widths at some vertices only, which is left to the library."""
    rows = [(x, y, 0.5, 0.25, 0.01 * (1 + i % 3)) for i, (x, y) in enumerate(POINTS)]
    space.add_lwpolyline([(x, y, i % 2, 0.0, 0.1) for i, (x, y) in enumerate(POINTS)], close=True)
    space.add_lwpolyline(rows, close=True, dxfattribs={"elevation": 4.0})


def heavy(space: Any, bulge: float = 0.0, flags: int = 0) -> None:
    """A polyline of R12 with a vertex for each entity, before a line."""
    rows = [(x, y, 0.0, 0.0, bulge) for x, y in POINTS]
    line = space.add_polyline2d(rows, format="xyseb", close=True)
    line.dxf.flags |= flags
    for vertex in line.vertices:
        vertex.dxf.location = vertex.dxf.location.replace(z=2.0)
    space.add_line((0.0, 0.0, 2.0), (1.0, 0.0, 2.0))


def lines(space: Any, height: float = 0.0, layers: tuple[str, ...] = ("0",)) -> None:
    for i, (x, y) in enumerate(POINTS):
        end = POINTS[(i + 1) % COUNT]
        space.add_line((x, y, height), (*end, height), dxfattribs={"layer": layers[i * len(layers) // COUNT]})


def with_others(space: Any) -> None:
    """Lines around other entities, one of which turns back."""
    space.add_circle((3.0, 0.0), 5.0)
    lines(space, 2.5)
    space.add_line((0.0, 0.0), (1.0, 0.0))
    polyline(space)


def tilted(space: Any) -> None:
    for (x, y), end in zip(POINTS, [*POINTS[1:], POINTS[0]], strict=True):
        space.add_line((x, y, 1e-9 * x), (*end, 1e-9 * end[0]))


def turned(space: Any) -> None:
    space.add_lwpolyline(POINTS, close=True, dxfattribs={"extrusion": (0.0, 0.0, -1.0)})


@pytest.mark.parametrize(
    ("add", "version", "chains"),
    [
        (polyline, "R2000", 1),
        (heavy, "R12", 1),
        (heavy, "R2010", 1),
        (lambda space: heavy(space, bulge=0.01), "R12", 1),
        (lambda space: heavy(space, flags=4), "R12", 0),
        (lambda space: space.add_polyline3d(POINTS), "R12", 0),
        (bulged, "R2010", 1),
        (lines, "R2010", 1),
        (lines, "R12", 1),
        (lambda space: lines(space, layers=("a", "b")), "R2010", 0),
        (with_others, "R2010", 2),
        (tilted, "R2010", 0),
        (turned, "R2010", 1),
    ],
    ids=[
        "polyline",
        "R12",
        "R12 in R2010",
        "bulges in R12",
        "smoothed",
        "in space",
        "bulges",
        "lines",
        "lines in R12",
        "two layers",
        "among others",
        "tilted",
        "from below",
    ],
)
def test_long_chains_of_dxf_are_those_of_the_library(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, add: Callable[[Any], object], version: str, chains: int
) -> None:
    document = ezdxf.new(version)
    add(document.modelspace())
    file = tmp_path / "c.dxf"
    document.saveas(file)
    monkeypatch.setattr(contour_file, "LARGE", file.stat().st_size + 1)
    whole = contour_of(file, {}).values
    monkeypatch.setattr(contour_file, "LARGE", 0)
    for content in (file.read_bytes(), file.read_bytes().replace(b"\n", b"\r\n")):
        file.write_bytes(content)
        assert len(DxfText(content.decode()).chains) == chains
        assert contour_of(file, {}).values == whole


def texts(steps: bool = False) -> list[str]:
    points = np.array(POINTS)
    return [f"{x!r},{y!r}" for x, y in (np.diff(points, axis=0, prepend=[[0.0, 0.0]]) if steps else points).tolist()]


@pytest.mark.parametrize(
    "element",
    [
        f'<path d="M{" L".join(texts())} Z"/>',
        f'<path d="m {" ".join(texts(steps=True))} z"/>',
        f'<path d="m{"l".join(texts(steps=True))}"/>',
        f'<path d="M{"l".join(texts(steps=True)).replace(",-", "-").replace("0.", ".")}z"/>',
        f'<polygon points="{" ".join(texts())}"/>',
        f'<polyline transform="skewX(3)" points="{" ".join(texts())}"/>',
    ],
    ids=["places", "steps", "open steps", "compact", "polygon", "polyline"],
)
def test_long_chains_of_svg_are_those_of_the_library(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, element: str
) -> None:
    pytest.importorskip("svgelements")
    file = tmp_path / "c.svg"
    page = '<svg xmlns="http://www.w3.org/2000/svg" width="9cm" height="8cm" viewBox="-90 -80 180 160">'
    file.write_text(f'{page}<g transform="rotate(10) scale(2)">{element}</g></svg>')
    (cut,) = svg_contour_of(file, {}).values["curves"]
    monkeypatch.setattr(long_chains, "LONG", 10**9)
    (whole,) = svg_contour_of(file, {}).values["curves"]
    for key in ("x", "y"):
        np.testing.assert_allclose(cut[key], whole[key], rtol=0.0, atol=1e-11)
    assert {**cut, "x": [], "y": []} == {**whole, "x": [], "y": []}


@pytest.mark.parametrize("more", [" M 0 0 L 1 1", " l 1 1", " C 1 1 2 2 3 3", " H 3", " z m 3 3"])
def test_another_path_is_left_to_the_library(more: str) -> None:
    path = f"M{' L'.join(texts())}"
    chain = svg_chain(path)
    assert chain is not None
    assert chain.tolist() == [list(one) for one in POINTS]
    assert svg_chain(path + more) is None
    assert svg_points("10 5;" * 80) is None
