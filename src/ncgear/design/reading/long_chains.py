"""Long chains of chords in drawings, read without the libraries, which take 5 to 60 µs for each vertex.

A chain is cut out of the text of a drawing and put back when the library has read the rest, so that units, layers,
blocks and transforms stay the library's.
"""

from __future__ import annotations

import re
from collections.abc import Collection
from itertools import pairwise, takewhile

import numpy as np

from ncgear.numerics.arrays import Array

LONG = 1000
"""Least number of vertices of a long chain."""

MARK = 1e250
"""Thickness of what stands for the first long chain of a DXF file, the k-th has k times as much; no drawing has it."""

COLUMNS = {"10": 0, "20": 1, "40": 2, "41": 3, "42": 4}
"""Columns of a vertex of a polyline of DXF by the codes of its values: x, y, both widths and the bulge."""

ENDS = ("10", "20", "30", "11", "21", "31")
"""Codes of the ends of a LINE of DXF."""

COMMON = ("5", "330", "100", "8", "6", "48", "62", "370", "420")
"""Codes of every entity that lies in the model space and is seen."""

OF_LINE, OF_VERTEX = {*COMMON, *ENDS}, {*COMMON, *COLUMNS, "30", "70"}

ENTITIES = re.compile(r"\n[ \t]*2[ \t]*\nENTITIES[ \t]*\n")
ENTITY = re.compile(r"[ \t]*0[ \t]*\n([A-Z]\w*)[ \t]*\n")
NEXT = re.compile(r"\n(?=[ \t]*0[ \t]*\n[A-Z])")
"""Before a code 0, which a name follows; a value 0 is followed by a number."""

LAST = re.compile(r"\n(?=[ \t]*0[ \t]*\nSEQEND)")
TAG = re.compile(r"[ \t]*(\d+)[ \t]*\n([^\n]*)\n")

NUMBER = re.compile(r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?")
"""A number of SVG; a sign or a second point begins the next one."""

PLACES, PAIR = "[^A-DF-Za-df-z]*", rf"\s*{NUMBER.pattern}\s*,?\s*{NUMBER.pattern}\s*"
CHAIN = re.compile(rf"\s*(M{PLACES}(L{PLACES})*|(m{PLACES}|M{PAIR}l{PLACES})(l{PLACES})*)[Zz]?\s*")
"""A path of SVG that is one chain of chords, by places or by steps."""


class DxfText:
    """The text of a DXF file whose long chains are cut to a line or two vertices, and their rows, by ``COLUMNS``.

    A chain is a polyline, or a run of lines that follow each other on a layer. ``MARK`` times its number, from 1, is
    the thickness of what stands for it.
    """

    def __init__(self, text: str) -> None:
        self.chains = list[Array]()
        self._whole, self._kept, self._done = text.replace("\r\n", "\n"), list[str](), 0
        begins = ENTITIES.search(self._whole)
        at = begins.end() if begins else len(self._whole)
        cuts = {"LINE": self._lines, "LWPOLYLINE": self._light, "POLYLINE": self._heavy}
        while (found := ENTITY.match(self._whole, at)) and found[1] != "ENDSEC":
            follows = NEXT.search(self._whole, found.end() - 1)
            end = follows.end() if follows else len(self._whole)
            cut = cuts.get(found[1])
            at = cut(at, found.end(), end) if cut else end
        self.text = "".join([*self._kept, self._whole[self._done :]])

    def _rows(self, at: int, tags: list[tuple[str, str]], wanted: Collection[str]) -> tuple[Array, list[int]]:
        """Numbers of the wanted codes in a run of equal tags from a place on, a row each in the order of the tags; and
        the places where each begins and the last one ends.

        Layers, kinds and flags are those of the first."""
        same = ("0", "8", "70")
        values = ["([^\n]*)" if c in wanted else re.escape(v) if c in same else "[^\n]*" for c, v in tags]
        pattern = re.compile("".join(rf"[ \t]*{c}[ \t]*\n{v}\n" for (c, _), v in zip(tags, values, strict=True)))
        found, places = list[str](), [at]
        while row := pattern.match(self._whole, places[-1]):
            found += row.groups()
            places.append(row.end())
        return np.array([*map(float, found)]).reshape(-1, max(pattern.groups, 1)), places

    def _cut(self, rows: Array, begin: int, short: int, after: int) -> None:
        """Mark the first entity after a place as a chain, and leave out what lies between two other places."""
        self.chains.append(rows)
        mark = next(tag.start() for tag in TAG.finditer(self._whole, begin) if tag[1] == "10")
        marked = f"39\n{MARK * len(self.chains)!r}\n"
        self._kept += [self._whole[self._done : mark], marked, self._whole[mark:short]]
        self._done = after

    def _lines(self, begin: int, body: int, end: int) -> int:
        """Cut long chains of the run of lines like one; returns the place after it."""
        tags = [("0", "LINE"), *TAG.findall(self._whole, body, end)]
        codes = [code for code, _ in tags[1:]]
        order = [code for code in codes if code in ENDS]
        if not OF_LINE.issuperset(codes) or sorted(order) != sorted(ENDS):
            return end
        found, places = self._rows(begin, tags, ENDS)
        if len(found) >= LONG:
            x1, y1, z1, x2, y2, z2 = found[:, [order.index(code) for code in ENDS]].T
            parted = np.flatnonzero((x2[:-1] != x1[1:]) | (y2[:-1] != y1[1:])) + 1
            for first, after in pairwise([0, *parted.tolist(), len(x1)]):
                place = slice(first, after)
                if after - first >= LONG and np.all(z1[place] == z1[first]) and np.all(z2[place] == z1[first]):
                    rows = np.zeros((after - first + 1, len(COLUMNS)))
                    rows[:-1, 0], rows[:-1, 1], rows[-1, :2] = x1[place], y1[place], (x2[after - 1], y2[after - 1])
                    self._cut(rows, places[first], places[first + 1], places[after])
        return max(places[-1], end)

    def _light(self, begin: int, body: int, end: int) -> int:
        """Cut a long polyline of plain vertices; returns the place after it."""
        head = list(takewhile(lambda tag: tag[1] != "10", TAG.finditer(self._whole, body, end)))
        at, vertex = head[-1].end() if head else body, list[tuple[str, str]]()
        for tag in TAG.finditer(self._whole, at, end):
            if tag[1] not in COLUMNS or (tag[1] == "10" and vertex):
                break
            vertex.append((tag[1], tag[2]))
        self._vertices(begin, {tag[1] for tag in head}, at, vertex, end)
        return end

    def _heavy(self, begin: int, body: int, end: int) -> int:
        """Cut a long polyline of R12, whose vertices are entities; returns the place after it."""
        head, first = dict(TAG.findall(self._whole, body, end)), ENTITY.match(self._whole, end)
        follows, closes = NEXT.search(self._whole, end), LAST.search(self._whole, end)
        if not (first and first[1] == "VERTEX" and follows and closes):
            return end
        vertex = [("0", "VERTEX"), *TAG.findall(self._whole, first.end(), follows.end())]
        # Flags of a flat polyline that is neither smoothed nor a mesh, open or closed.
        flat = int(head.get("70", "0")) in (0, 1, 128, 129) and int(dict(vertex).get("70", "0")) == 0
        if flat and "10" in head and OF_VERTEX.issuperset(code for code, _ in vertex[1:]):
            self._vertices(begin, set(head) - {"10", "20"}, end, vertex, closes.end())
        return closes.end()

    def _vertices(self, begin: int, head: set[str], at: int, vertex: list[tuple[str, str]], end: int) -> None:
        """Cut the vertices between two places, if they are many and each is like the first; the polyline begins before
        them with the codes of its head."""
        columns = [code for code, _ in vertex if code in COLUMNS]
        if sorted(columns)[:2] != ["10", "20"]:
            return
        found, places = self._rows(at, vertex, COLUMNS)
        others = head | {code for code, _ in TAG.findall(self._whole, places[-1], end)}
        if len(found) >= LONG and others.isdisjoint((*COLUMNS, "39")):
            rows = np.zeros((len(found), len(COLUMNS)))
            rows[:, [COLUMNS[code] for code in columns]] = found
            self._cut(rows, begin, places[2], places[-1])


def svg_chain(data: str) -> Array | None:
    """The vertices of a path of SVG that is one long chain of chords, shape (n, 2); None for another path."""
    if len(data) < LONG or not (found := CHAIN.fullmatch(data)):
        return None
    points = svg_points(re.sub("[MmLlZz]", " ", data))
    if points is None:
        return None
    points = np.cumsum(points, axis=0) if found[3] else points
    return np.concatenate([points, points[:1]]) if data.rstrip()[-1] in "Zz" else points


def svg_points(data: str) -> Array | None:
    """The points of a long list of SVG, shape (n, 2); None for a short one, or for other signs than numbers."""
    if NUMBER.sub("", data).strip(" ,\t\r\n"):
        return None
    numbers = np.array([*map(float, NUMBER.findall(data))])
    return numbers.reshape(-1, 2) if len(numbers) >= 2 * LONG and len(numbers) % 2 == 0 else None
