"""Sheets of paper as files: SVG, DXF, and here PDF of one page, with texts that can be searched and copied.

PDF is written without a library: a page of lines and texts needs few of the format's parts (ISO 32000-1, 7.5 for
the file, 8.5 for paths, 9.4 for texts).  Letters are those of the standard font Helvetica, which every reader has.
"""

from __future__ import annotations

import zlib
from collections.abc import Iterator, Mapping
from math import cos, sin

import numpy as np

from ncgear.files.workshop.dxf import sheet_dxf
from ncgear.files.workshop.sheets.sheet import CAPITAL, NARROW, Pen, Ring, Sheet, SheetLine, Text
from ncgear.files.workshop.svg import sheet_svg
from ncgear.numerics.arrays import Array

POINTS_PER_MM = 72.0 / 25.4

ENCODING = "cp1252"
"""The encoding of the font; letters that it lacks become question marks."""

ROUND = 4.0 / 3.0 * (2.0**0.5 - 1.0)
"""Distance of the handles of a quarter of a circle from its ends, as a share of the radius (within 3e-4 of it)."""


def drawing_files(sheets: Mapping[str, Sheet]) -> dict[str, bytes]:
    """``driving_drawing``, ``driven_drawing`` and ``pair_drawing`` of each kind by their names."""
    kinds = {"svg": sheet_svg, "pdf": sheet_pdf, "dxf": sheet_dxf}
    return {f"{name}_drawing.{kind}": write(sheet) for name, sheet in sheets.items() for kind, write in kinds.items()}


def sheet_pdf(sheet: Sheet) -> bytes:
    """The file; the same sheet gives the same bytes."""
    drawn = zlib.compress("\n".join(_drawn(sheet)).encode(ENCODING, "replace"))
    width, height = (f"{side * POINTS_PER_MM:.3f}" for side in sheet.size_mm)
    title = _escaped(sheet.title.encode(ENCODING, "replace"))
    objects = [
        b"<< /Type /Catalog /Pages 2 0 R >>",
        b"<< /Type /Pages /Kids [3 0 R] /Count 1 >>",
        f"<< /Type /Page /Parent 2 0 R /MediaBox [0 0 {width} {height}] /Contents 4 0 R "
        "/Resources << /Font << /F1 5 0 R >> >> >>".encode(),
        b"<< /Length %d /Filter /FlateDecode >>\nstream\n%b\nendstream" % (len(drawn), drawn),
        b"<< /Type /Font /Subtype /Type1 /BaseFont /Helvetica /Encoding /WinAnsiEncoding >>",
        b"<< /Title (%b) /Producer (ncgear) >>" % title,
    ]
    file, places = b"%PDF-1.4\n%\xe2\xe3\xcf\xd3\n", list[int]()
    for number, content in enumerate(objects, 1):
        places.append(len(file))
        file += b"%d 0 obj\n%b\nendobj\n" % (number, content)
    table = b"".join(b"%010d 00000 n \n" % place for place in places)
    head = b"xref\n0 %d\n0000000000 65535 f \n%b" % (len(objects) + 1, table)
    tail = b"trailer\n<< /Size %d /Root 1 0 R /Info 6 0 R >>\nstartxref\n%d\n%%%%EOF\n" % (len(objects) + 1, len(file))
    return file + head + tail


def _drawn(sheet: Sheet) -> Iterator[str]:
    """The operators of the page, in mm."""
    yield f"{POINTS_PER_MM:.9f} 0 0 {POINTS_PER_MM:.9f} 0 0 cm 1 j"
    items = list(sheet.plain())
    for pen in Pen:
        yield f"{pen.width_mm:g} w [{' '.join(f'{dash:g}' for dash in pen.dashes_mm)}] 0 d"
        for item in items:
            if isinstance(item, SheetLine) and item.pen is pen:
                yield f"{_path(item.points)} {'f' if item.filled else 's' if item.closed else 'S'}"
            elif isinstance(item, Ring) and item.pen is pen:
                yield f"{_circle(item)} s"
    for item in items:
        if isinstance(item, Text):
            yield _text(item)


def _path(points: Array) -> str:
    first, *others = (f"{x:.3f} {y:.3f}" for x, y in points.tolist())
    return f"{first} m {' '.join(f'{place} l' for place in others)}"


def _circle(ring: Ring) -> str:
    """Four Bezier curves."""
    quarter = np.array([[1.0, 0.0], [1.0, ROUND], [ROUND, 1.0], [0.0, 1.0]])
    parts = []
    for turn in range(4):
        cosine, sine = round(cos(turn * np.pi / 2.0)), round(sin(turn * np.pi / 2.0))
        turned = quarter @ np.array([[cosine, sine], [-sine, cosine]])
        places = np.asarray(ring.center) + ring.radius * turned
        start, *handles = (f"{x:.3f} {y:.3f}" for x, y in places.tolist())
        parts.append(f"{start} m {' '.join(handles)} c" if turn == 0 else f"{' '.join(handles)} c")
    return " ".join(parts)


def _text(text: Text) -> str:
    size, cosine, sine = text.letter_mm / CAPITAL, cos(text.turned_rad), sin(text.turned_rad)
    back = text.anchor.value * text.width_mm
    x, y = text.place[0] - back * cosine, text.place[1] - back * sine
    matrix = (NARROW * cosine, NARROW * sine, -sine, cosine, x, y)
    numbers = " ".join(f"{value:.4f}" for value in matrix)
    words = _escaped(text.words.encode(ENCODING, "replace")).decode(ENCODING)
    return f"BT /F1 {size:.4f} Tf {numbers} Tm ({words}) Tj ET"


def _escaped(words: bytes) -> bytes:
    return words.replace(b"\\", b"\\\\").replace(b"(", b"\\(").replace(b")", b"\\)")
