"""Long chains of chords in drawings, read without the libraries, which take 5 to 60 µs for each vertex.

A chain is cut out of the text of a drawing and put back when the library has read the rest, so that units, layers,
blocks and transforms stay the library's.
"""

from __future__ import annotations

import re
from itertools import groupby, pairwise

import numpy as np

from ncgear.numerics.arrays import Array

LONG = 1000
"""Least number of vertices of a long chain."""

COLUMNS = {"10": 0, "20": 1, "40": 2, "41": 3, "42": 4}
"""Columns of a vertex of a polyline of DXF by the codes of its values: x, y, both widths and the bulge."""

ENDS = ("10", "20", "30", "11", "21", "31")
"""Codes of the ends of a LINE of DXF."""

OF_LINE = frozenset(("0", "5", "330", "100", "8", "6", "48", "62", "370", "420", *ENDS))
"""Codes of a LINE that lies in the model space and is seen."""

CHAIN = re.compile(r"\s*M[^A-DF-Za-df-z]*(L[^A-DF-Za-df-z]*)*Z?\s*|\s*m[^A-DF-Za-df-z]*(l[^A-DF-Za-df-z]*)*z?\s*")
"""A path of SVG that is one chain of chords, by places or by steps."""


class DxfText:
    """The text of a DXF file whose long chains are cut to two vertices; ``chains`` are their rows, by ``COLUMNS``.

    A chain is a polyline, or a run of lines that follow each other on a layer, which becomes a polyline.  The width of
    its polyline is its number, from -1 downwards.
    """

    def __init__(self, text: str) -> None:
        self.chains = list[Array]()
        self._of_a_line = list[str]()
        self._lines = text.replace("\r\n", "\n").split("\n")
        self._codes, self._values = [code.strip() for code in self._lines[::2]], self._lines[1::2]
        begins = next((i for i, one in enumerate(self._values) if one == "ENTITIES"), len(self._values))
        starts = [i for i in range(begins, len(self._values)) if self._codes[i] == "0"]
        kept = self._lines[: 2 * starts[0]] if starts else self._lines
        for like, group in groupby(pairwise([*starts, len(self._values)]), self._line_like):
            every = list(group)
            begin, end = every[0][0], every[-1][1]
            for one in (self._joined(begin, end, *like),) if like else (self._cut(*each) for each in every):
                kept += one
        self.text = "\n".join(kept) + "\n"

    def _line_like(self, place: tuple[int, int]) -> tuple[list[str], str] | None:
        """The codes and the layer of a line; None for another entity."""
        shape = self._codes[slice(*place)]
        if self._values[place[0]] != "LINE":
            return None
        if shape != self._of_a_line:
            if "100" not in shape or not OF_LINE.issuperset(shape):
                return None
            self._of_a_line = shape
        return shape, self._values[place[0] + shape.index("8")] if "8" in shape else "0"

    def _numbers(self, begin: int, end: int, shape: list[str], codes: tuple[str, ...]) -> Array:
        """Values of codes in tags that repeat a shape, a column for each code."""
        texts = [self._values[begin + shape.index(code) : end : len(shape)] for code in codes]
        return np.array(texts, dtype=float).T

    def _joined(self, begin: int, end: int, shape: list[str], layer: str) -> list[str]:
        """A run of lines of one shape; long chains become polylines."""
        if end - begin < LONG * len(shape):
            return self._lines[2 * begin : 2 * end]
        x1, y1, z1, x2, y2, z2 = self._numbers(begin, end, shape, ENDS).T
        parted = np.flatnonzero((x2[:-1] != x1[1:]) | (y2[:-1] != y1[1:])) + 1
        kept = list[str]()
        for first, after in pairwise([0, *parted.tolist(), len(x1)]):
            place = slice(first, after)
            lines = self._lines[2 * (begin + first * len(shape)) : 2 * (begin + after * len(shape))]
            if after - first >= LONG and np.all(z1[place] == z1[first]) and np.all(z2[place] == z1[first]):
                rows = np.zeros((after - first + 1, len(COLUMNS)))
                rows[:-1, 0], rows[:-1, 1], rows[-1, :2] = x1[place], y1[place], (x2[after - 1], y2[after - 1])
                self.chains.append(rows)
                head = ["0", "LWPOLYLINE", "100", "AcDbEntity", "8", layer, "100", "AcDbPolyline", "38", str(z1[first])]
                lines = [*head, "43", str(-len(self.chains)), *("10", "0", "20", "0") * 2]
            kept += lines
        return kept

    def _cut(self, begin: int, end: int) -> list[str]:
        """An entity; of a long polyline of plain vertices two of them."""
        lines, shape = self._lines[2 * begin : 2 * end], self._codes[begin:end]
        count = shape.count("10")
        if self._values[begin] != "LWPOLYLINE" or count < LONG:
            return lines
        first = shape.index("10")
        each = shape[first : shape.index("10", first + 1)]
        after = first + count * len(each)
        if shape[first:after] != each * count or not set(each) <= set(COLUMNS) or "43" in shape[:first]:
            return lines
        rows = np.zeros((count, len(COLUMNS)))
        rows[:, [COLUMNS[code] for code in each]] = self._numbers(begin + first, begin + after, each, tuple(each))
        self.chains.append(rows)
        width = ["43", str(-len(self.chains))]
        return [*lines[: 2 * first], *width, *lines[2 * first : 2 * (first + 2 * len(each))], *lines[2 * after :]]


def svg_chain(data: str) -> Array | None:
    """The vertices of a path of SVG that is one long chain of chords, shape (n, 2); None for another path."""
    if len(data) < LONG or not CHAIN.fullmatch(data):
        return None
    points = svg_points(re.sub("[MmLlZz]", " ", data))
    if points is None:
        return None
    points = np.cumsum(points, axis=0) if data.lstrip()[0] == "m" else points
    return np.concatenate([points, points[:1]]) if data.rstrip()[-1] in "Zz" else points


def svg_points(data: str) -> Array | None:
    """The points of a long list of SVG, shape (n, 2); None for a short one, or for numbers that are not apart."""
    try:
        numbers = np.array(data.replace(",", " ").split(), dtype=float)
    except ValueError:
        return None
    return numbers.reshape(-1, 2) if len(numbers) >= 2 * LONG and len(numbers) % 2 == 0 else None
