"""A drawing on a sheet of paper as a plain value: lines, circles, texts and dimensions in mm of paper.

The lower left corner of the sheet is the origin, and y points up.  Line widths are those of ISO 128, heights of letters
those of ISO 3098, scales those of ISO 5455, and the sheet is A4 of ISO 216 (values from secondary sources).  Letters
are Helvetica, whose widths Arial and Liberation Sans share, so that any program finds room for the same texts; they are
narrowed to ``NARROW`` of their width, like those of lettering guides.
"""

from __future__ import annotations

from collections.abc import Iterable
from enum import Enum
from itertools import repeat
from math import cos, pi, sin

import numpy as np

from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array

A4_MM = 210.0, 297.0
"""The short and the long side of a sheet."""

SCALES = tuple(step * 10.0**power for power in range(6, -6, -1) for step in (5.0, 2.0, 1.0))
"""Size on paper divided by true size, from the largest on: the steps of ISO 5455 and their powers of ten."""

LETTER_MM, TITLE_MM = 2.5, 3.5
"""Heights of capital letters: of all texts, and of names."""

CAPITAL = 0.718
"""Height of Helvetica's capital letters as a share of its size."""

NARROW = 0.85
"""Width of letters as a share of the font's own."""

DEPTH = 0.3
"""Depth of letters below their line, as a share of the height of capital letters."""

WIDTHS = {
    191: "'",
    222: "ijl",
    260: "|",
    278: " !,./:;I[\\]ft\u00b7",
    333: "()-`r",
    334: "{}",
    355: '"',
    389: "*",
    400: "\u00b0",
    469: "^",
    500: "Jcksvxyz",
    556: "#$0123456789?L_abdeghnopqu\u00b5",
    584: "+<=>~\u00d7\u00b1",
    611: "FTZ",
    667: "&ABEKPSVXY",
    722: "CDHNRUw",
    778: "GOQ\u00d8",
    833: "Mm",
    889: "%",
    944: "W",
    1015: "@",
}
"""Letters by their widths in thousandths of the font's size (Adobe's metrics of Helvetica)."""

WIDTH_OF = {letter: width for width, letters in WIDTHS.items() for letter in letters}

WIDEST = 1015
"""Width of letters that no table has: the widest, so that any letter has room."""


def text_width_mm(words: str, letter_mm: float = LETTER_MM) -> float:
    """Width of a text with capital letters of a given height."""
    return NARROW * letter_mm / CAPITAL * sum(map(WIDTH_OF.get, words, repeat(WIDEST))) / 1000.0


def scale_text(scale: float) -> str:
    """A scale as a title block has it: ``1:2``."""
    return f"{scale:g}:1" if scale >= 1.0 else f"1:{1.0 / scale:g}"


class Pen(Enum):
    """Kinds of lines: the width in mm, and the lengths of dashes and gaps."""

    VISIBLE = 0.5, ()
    FRAME = 0.7, ()
    THIN = 0.25, ()
    HIDDEN = 0.25, (2.5, 1.0)
    CHAIN = 0.25, (6.0, 1.0, 0.5, 1.0)

    def __init__(self, width_mm: float, dashes_mm: tuple[float, ...]) -> None:
        self.width_mm, self.dashes_mm = width_mm, dashes_mm


@dataclass(frozen=True, eq=False)
class SheetLine:
    """A line through points (n, 2), closed where its last point leads to the first; a ``filled`` line is a black area.

    Lines that belong together have a ``name``.
    """

    points: Array
    pen: Pen = Pen.THIN
    closed: bool = False
    filled: bool = False
    name: str = ""


@dataclass(frozen=True)
class Ring:
    """A whole circle."""

    center: tuple[float, float]
    radius: float
    pen: Pen = Pen.VISIBLE
    name: str = ""

    @property
    def points(self) -> Array:
        """Points of the circle, shape (n, 2)."""
        turned = np.linspace(0.0, 2.0 * pi, 73)[:-1]
        around: Array = np.column_stack([np.cos(turned), np.sin(turned)])
        return np.array(self.center) + self.radius * around


class Anchor(Enum):
    """Which part of a text's line is at its place."""

    START = 0.0
    MIDDLE = 0.5
    END = 1.0


@dataclass(frozen=True)
class Text:
    """A text on one line that begins, has its middle or ends at a place, turned counter-clockwise."""

    words: str
    place: tuple[float, float]
    anchor: Anchor = Anchor.START
    letter_mm: float = LETTER_MM
    turned_rad: float = 0.0
    name: str = ""

    @property
    def width_mm(self) -> float:
        """Width of the text."""
        return text_width_mm(self.words, self.letter_mm)

    @property
    def corners(self) -> Array:
        """Corners of the box around the text, shape (4, 2), letters that reach below the line included."""
        width, low, high = self.width_mm, -DEPTH * self.letter_mm, self.letter_mm
        left = -self.anchor.value * width
        box = np.array([[left, low], [left + width, low], [left + width, high], [left, high]])
        cosine, sine = cos(self.turned_rad), sin(self.turned_rad)
        return np.array(self.place) + box @ np.array([[cosine, sine], [-sine, cosine]])


class Measured(Enum):
    """The kind of size that a dimension measures."""

    LENGTH = "length"
    RADIUS = "radius"
    DIAMETER = "diameter"


@dataclass(frozen=True, eq=False)
class Dimension:
    """A dimension: the kind of its size between two points, its drawing, and its text.

    ``ends`` (2, 2) are the points of a length, the centre and a point of a circle, or opposite points of it.  ``base``
    is a point of the dimension line.  ``view`` is the scale of its view.
    """

    measured: Measured
    ends: Array
    base: Array
    lines: tuple[SheetLine, ...]
    text: Text
    view: float

    @property
    def value_mm(self) -> float:
        """The true length between its ends."""
        return float(np.hypot(*(self.ends[1] - self.ends[0]))) / self.view


Item = SheetLine | Ring | Text | Dimension


@dataclass(frozen=True, eq=False)
class Sheet:
    """A sheet of paper: its size, its items, the scale of its main view, and the origin of that view."""

    title: str
    size_mm: tuple[float, float]
    scale: float
    origin: tuple[float, float]
    items: tuple[Item, ...]

    def plain(self) -> Iterable[SheetLine | Ring | Text]:
        """All lines, circles and texts, including those of the dimensions."""
        for item in self.items:
            yield from parts_of(item)


def parts_of(item: Item) -> tuple[SheetLine | Ring | Text, ...]:
    """An item, or the lines and the text of a dimension."""
    return (*item.lines, item.text) if isinstance(item, Dimension) else (item,)


ARROW_MM = 2.5
BEYOND_MM, FREE_MM = 1.5, 0.8
"""Lengths of lines beyond the dimension line, and of their gaps to the body and to text."""

OUTSIDE_MM = 9.0
"""Dimension lines shorter than this have their arrows outside."""


def arrow(tip: Array, towards: Array) -> SheetLine:
    """An arrowhead at a tip that points in a direction (2,)."""
    along = towards / np.hypot(*towards)
    back, aside = tip - ARROW_MM * along, ARROW_MM / 6.0 * np.array([-along[1], along[0]])
    return SheetLine(np.array([tip, back + aside, back - aside]), closed=True, filled=True)


def length(ends: Array, apart_mm: float, words: str, view: float) -> Dimension:
    """A dimension of the length between two points (2, 2), its line so far to their left.

    A short dimension has its arrows outside, and a text longer than the dimension is beyond its second end.
    """
    way = ends[1] - ends[0]
    long = float(np.hypot(*way))
    along = way / long
    aside = np.array([-along[1], along[0]]) * (1.0 if apart_mm >= 0.0 else -1.0)
    start, end = ends + abs(apart_mm) * aside
    lines = []
    if abs(apart_mm) > BEYOND_MM:
        lines += [
            SheetLine(np.array([point + FREE_MM * aside, base + BEYOND_MM * aside]))
            for point, base in ((ends[0], start), (ends[1], end))
        ]
    # Text is read from below or from the right.
    angle = float(np.arctan2(along[1], along[0]))
    upright = -pi / 2.0 + 1e-6 < angle <= pi / 2.0 + 1e-6
    reading, turned = (along, angle) if upright else (-along, angle - pi if angle > 0.0 else angle + pi)
    above = np.array([-reading[1], reading[0]])
    outside, width = long < OUTSIDE_MM, text_width_mm(words)
    beyond = 2.0 * ARROW_MM * along
    if outside:
        lines += [SheetLine(np.array([start - beyond, start])), SheetLine(np.array([end, end + beyond]))]
        lines += [arrow(start, along), arrow(end, -along), SheetLine(np.array([start, end]))]
    else:
        lines += [SheetLine(np.array([start, end])), arrow(start, -along), arrow(end, along)]
    middle = (start + end) / 2.0
    if width > long - 2.0 * FREE_MM:
        middle = end + (2.0 * ARROW_MM + width / 2.0) * along
        lines.append(SheetLine(np.array([end, middle + width / 2.0 * along])))
    place = middle + FREE_MM * above
    text = Text(words, (float(place[0]), float(place[1])), Anchor.MIDDLE, turned_rad=turned)
    return Dimension(Measured.LENGTH, ends, start, tuple(lines), text, view)


def leader(target: Array, elbow: Array, words: str, *, back: bool = False) -> tuple[tuple[SheetLine, ...], Text]:
    """An arrow from an elbow to a target, with a text on a shoulder that goes on to the side, or back."""
    way = target - elbow
    left = bool(elbow[0] < target[0]) != back
    width = text_width_mm(words) + 2.0 * FREE_MM
    end = elbow + np.array([-width if left else width, 0.0])
    place = min(elbow[0], end[0]) + FREE_MM, elbow[1] + FREE_MM
    return (SheetLine(np.array([target, elbow, end])), arrow(target, way)), Text(
        words, (float(place[0]), float(place[1]))
    )
