"""The frame, the title block and the tables of a sheet.

Frame and title block have the sizes of ISO 5457 and ISO 7200, and the sign of first angle projection is from
ISO 5456-2 (values from secondary sources).
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence

import numpy as np

from ncgear import __version__
from ncgear.files.workshop.sheets import sheet as paper
from ncgear.files.workshop.sheets.sheet import Anchor, Item, Pen, Ring, SheetLine, Text
from ncgear.frozen import dataclass

BINDING_MM, MARGIN_MM = 20.0, 10.0
"""Margin on the left, for filing, and on the other sides."""

TITLE_WIDTH_MM, TITLE_HEIGHT_MM = 180.0, 32.0

ROW_MM = 4.0
"""Distance of lines of text in tables."""

PAD_MM, SPARE_MM = 1.0, 0.1
"""Room left and right of a table's texts, and room for rounding."""


@dataclass(frozen=True)
class Box:
    """A rectangle of paper."""

    left: float
    low: float
    right: float
    high: float

    @property
    def width(self) -> float:
        """Size along x."""
        return self.right - self.left

    @property
    def height(self) -> float:
        """Size along y."""
        return self.high - self.low

    @property
    def bounds(self) -> tuple[float, float, float, float]:
        """Left, bottom, right, top."""
        return self.left, self.low, self.right, self.high


@dataclass(frozen=True)
class Titles:
    """The texts of the title block of a sheet."""

    part: str
    design: str
    material: str
    view: str
    scale: float
    general: str


def inside(size_mm: tuple[float, float]) -> Box:
    """The paper inside the frame."""
    return Box(BINDING_MM, MARGIN_MM, size_mm[0] - MARGIN_MM, size_mm[1] - MARGIN_MM)


def outlined(box: Box, pen: Pen) -> SheetLine:
    """The edges of a rectangle."""
    corners = [[box.left, box.low], [box.right, box.low], [box.right, box.high], [box.left, box.high]]
    return SheetLine(np.array(corners), pen, closed=True)


def framed(size_mm: tuple[float, float], titles: Titles) -> Iterator[Item]:
    """The frame of a sheet and its title block."""
    frame = inside(size_mm)
    yield outlined(frame, Pen.FRAME)
    block = Box(frame.right - TITLE_WIDTH_MM, frame.low, frame.right, frame.low + TITLE_HEIGHT_MM)
    yield outlined(block, Pen.VISIBLE)
    rows = np.array([0.0, 7.5, 15.0, 22.5, 32.0]) + block.low
    columns = np.array([0.0, 105.0, 145.0, 180.0]) + block.left
    for y in rows[1:-1]:
        yield SheetLine(np.array([[block.left, y], [block.right, y]]))
    for x in columns[1:-1]:
        yield SheetLine(np.array([[x, block.low], [x, block.high]]))
    cells = [
        (titles.view, "Date", f"ncgear {__version__}"),
        (f"Material {titles.material}", "Drawn", "Checked"),
        (titles.design, f"mm, {titles.general}", "Sheet A4"),
        (titles.part, f"Scale {paper.scale_text(titles.scale)}", ""),
    ]
    for row, (words, y) in enumerate(zip(cells, rows[:-1], strict=True)):
        letter = paper.TITLE_MM if row == 3 else paper.LETTER_MM
        for text, x, right in zip(words, columns[:-1], columns[1:], strict=True):
            if text:
                fitting = fitted(text, float(right - x) - 3.0, letter)
                yield Text(fitting, (float(x) + 1.5, float(y) + 2.5), letter_mm=letter)
    yield from first_angle(float(columns[2]) + 8.0, float(rows[3]) + 4.75)


def first_angle(x: float, y: float) -> Iterator[Item]:
    """The sign of first angle projection: a cone from the side, and to its right its two circles from the left."""
    cone = np.array([[-3.0, -1.5], [4.0, -3.0], [4.0, 3.0], [-3.0, 1.5]])
    yield SheetLine(np.array([x, y]) + cone, Pen.THIN, closed=True)
    yield SheetLine(np.array([[x - 4.5, y], [x + 5.5, y]]), Pen.CHAIN)
    middle = x + 13.0
    for radius in (1.5, 3.0):
        yield Ring((middle, y), radius, Pen.THIN)
    yield SheetLine(np.array([[middle - 4.0, y], [middle + 4.0, y]]), Pen.CHAIN)
    yield SheetLine(np.array([[middle, y - 4.0], [middle, y + 4.0]]), Pen.CHAIN)


CUT = "..."


def fitted(words: str, width_mm: float, letter_mm: float = paper.LETTER_MM) -> str:
    """A text, or as much of its beginning as has room on a line, with three points for the rest."""
    if paper.text_width_mm(words, letter_mm) <= width_mm:
        return words
    room = width_mm - paper.text_width_mm(CUT, letter_mm)
    kept = len(words)
    while kept and paper.text_width_mm(words[:kept].rstrip(), letter_mm) > room:
        kept -= 1
    return words[:kept].rstrip() + CUT


def wrapped(words: str, width_mm: float) -> list[str]:
    """A text on as many lines as it needs; a word that is too long for a line is cut."""
    lines = [""]
    for word in words.split():
        longer = f"{lines[-1]} {word}".strip()
        if paper.text_width_mm(longer) <= width_mm or not lines[-1]:
            lines[-1] = longer
        else:
            lines.append(word)
    return [fitted(line, width_mm) for line in lines]


def width_for(texts: Iterable[str]) -> float:
    """Width of a column with room for texts, each on one line."""
    return max(map(paper.text_width_mm, texts)) + 2.0 * PAD_MM + SPARE_MM


@dataclass(frozen=True)
class ColumnWidths:
    """The widths of a table's columns in mm, and whether each column's texts are on the right."""

    widths_mm: tuple[float, ...]
    right: tuple[bool, ...]

    @property
    def width_mm(self) -> float:
        """Width of the table."""
        return sum(self.widths_mm)


@dataclass(frozen=True)
class PaperTable:
    """A title on a line of its own, heads that may be broken over lines, and rows; all texts."""

    title: str
    heads: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    columns: ColumnWidths

    def height_mm(self) -> float:
        """Height of the whole table."""
        return ROW_MM * (1 + sum(map(self._lines, self._written)))

    @property
    def _written(self) -> tuple[tuple[str, ...], ...]:
        """The heads, where there are any, and the rows."""
        return (self.heads, *self.rows) if self.heads else self.rows

    def _lines(self, cells: Sequence[str]) -> int:
        """Lines of text that a row needs."""
        widths = self.columns.widths_mm
        return max(len(wrapped(cell, width - 2.0 * PAD_MM)) for cell, width in zip(cells, widths, strict=True))

    def drawn(self, left: float, high: float) -> Iterator[Item]:
        """The table from its upper left corner on."""
        right, edges = left + self.columns.width_mm, np.cumsum([0.0, *self.columns.widths_mm]) + left
        yield Text(fitted(self.title, self.columns.width_mm - 2.0 * PAD_MM), (left + PAD_MM, high - ROW_MM + 0.8))
        top = y = high - ROW_MM
        edge = [(left, y), (right, y)]
        for cells in self._written:
            lines = self._lines(cells)
            for cell, start, end, on_right in zip(cells, edges[:-1], edges[1:], self.columns.right, strict=True):
                x, anchor = (end - PAD_MM, Anchor.END) if on_right else (start + PAD_MM, Anchor.START)
                for line, words in enumerate(wrapped(cell, float(end - start) - 2.0 * PAD_MM)):
                    if words:
                        yield Text(words, (float(x), y - ROW_MM * (line + 1) + 0.8), anchor)
            y -= ROW_MM * lines
            if self.heads and len(edge) == 2:
                yield SheetLine(np.array([[left, y], [right, y]]), Pen.VISIBLE)
            # A single line, to and fro, draws all rules.
            here, there = (right, left) if edge[-1][0] == right else (left, right)
            edge += [(here, y), (there, y)]
        yield SheetLine(np.array(edge))
        yield SheetLine(np.array([[left, top], [right, top]]), Pen.VISIBLE)
        for x in edges:
            yield SheetLine(np.array([[x, top], [x, y]]))


def evenly(rows: Sequence[tuple[str, ...]], most: int) -> tuple[tuple[str, ...], ...]:
    """At most ``most`` rows, evenly spread, with the first row among them."""
    if len(rows) <= most:
        return tuple(rows)
    return tuple(rows[number * len(rows) // most] for number in range(most))
