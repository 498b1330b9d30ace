"""A view that is being drawn: its items, and the room that is left for texts, leaders and dimensions.

A text covers no line and no other text; lines cross lines, but no text.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace
from itertools import compress, islice, product

import numpy as np
import shapely
from shapely import LineString, Polygon, STRtree
from shapely.geometry.base import BaseGeometry

from ncgear.files.workshop.sheets.sheet import Anchor, Dimension, Item, Ring, SheetLine, Text, leader, parts_of
from ncgear.numerics.arrays import Array, Mask

SLACK_MM = 0.6
"""Room around texts."""

CHUNK = 24
"""Points of a line that are tested together."""

TOGETHER = 24
"""Places of texts, and dimensions, that are tested together: usually one of the first has room."""

LENGTHS_MM = (5.0, 8.0, 12.0, 17.0, 24.0, 32.0, 42.0, 54.0)
TURNS_RAD = tuple(np.radians([0.0, 12.0, -12.0, 25.0, -25.0, 40.0, -40.0, 60.0, -60.0, 85.0, -85.0]))
"""Lengths of leaders that are tried, and their angles to the wanted direction."""


class _Shapes:
    """Shapes on a board, which are asked far more often than added to."""

    def __init__(self) -> None:
        self._shapes: list[BaseGeometry] = []
        self._tree = STRtree([])

    def add(self, shapes: list[BaseGeometry]) -> None:
        """Put shapes on the board."""
        self._shapes += shapes
        self._tree = STRtree(self._shapes)

    def meet(self, others: Sequence[BaseGeometry]) -> Mask:
        """Whether any shape touches each of others, shape (n,)."""
        met = np.zeros(len(others), dtype=bool)
        met[self._tree.query(others, predicate="intersects")[0]] = True
        return met


class Board:
    """The items of a view inside a box of paper: left, bottom, right, top."""

    def __init__(self, box: tuple[float, float, float, float]) -> None:
        self.box = shapely.box(*box)
        self.items: list[Item] = []
        self._lines, self._texts, self._holes = _Shapes(), _Shapes(), _Shapes()

    def add(self, *items: Item) -> None:
        """Put items on the board without a test for room."""
        for item in items:
            self.items.append(item)
            for part in parts_of(item):
                if isinstance(part, Text):
                    self._texts.add([Polygon(part.corners)])
                else:
                    self._lines.add(_pieces(part))

    def keep_clear(self, holes: Iterable[SheetLine | Ring]) -> None:
        """Keep texts out of holes with these edges; lines may cross them."""
        self._holes.add([Polygon(hole.points) for hole in holes])

    def has_room(self, text: Text) -> bool:
        """Whether a text is inside the box and covers nothing."""
        return bool(self._roomy([Polygon(_widened(text.corners))])[0])

    def _roomy(self, areas: Sequence[Polygon]) -> Mask:
        """Which of the areas are inside the box and cover nothing, shape (n,)."""
        free = np.asarray(shapely.covers(self.box, areas))
        for shapes in (self._texts, self._holes, self._lines):
            free[free] = ~shapes.meet(np.asarray(areas)[free])
        return free

    def is_free(self, lines: Iterable[SheetLine]) -> bool:
        """Whether lines are inside the box and cross no text."""
        pieces = [piece for line in lines for piece in _pieces(line)]
        return bool(shapely.covers(self.box, pieces).all()) and not self._texts.meet(pieces).any()

    def put_text(self, candidates: Iterable[Text]) -> bool:
        """Add the first text that has room; whether any had room."""
        for text in candidates:
            if self.has_room(text):
                self.add(text)
                return True
        return False

    def put_text_at(self, text: Text, places: Array, suits: Callable[[Array], Mask]) -> bool:
        """Add a text, given for the origin, at the first of places, (n, 2), with room that ``suits``; if any does."""
        around = _widened(text.corners)
        for block in np.split(places, range(TOGETHER, len(places), TOGETHER)):
            free = block[self._roomy(shapely.polygons(block[:, None] + around))]
            if free.size and (fit := free[suits(free)]).size:
                x, y = fit[0] + text.place
                self.add(replace(text, place=(float(x), float(y))))
                return True
        return False

    def put_dimension(self, candidates: Iterable[tuple[Dimension, *tuple[Ring, ...]]]) -> bool:
        """Add the first dimension that has room, with its circles; whether any had room."""
        waiting = iter(candidates)
        while some := list(islice(waiting, TOGETHER)):
            roomy = self._roomy(shapely.polygons([_widened(dimension.text.corners) for dimension, *_ in some]))
            for dimension, *rings in compress(some, roomy):
                circles = (SheetLine(ring.points, closed=True) for ring in rings)
                if self.is_free(dimension.lines) and (not rings or self.is_free(circles)):
                    self.add(dimension, *rings)
                    return True
        return False

    def pointed(
        self,
        target: Array,
        direction_rad: float,
        words: str,
        turns_rad: Iterable[float] = TURNS_RAD,
        lengths_mm: Iterable[float] = LENGTHS_MM,
    ) -> tuple[tuple[SheetLine, ...], Text] | None:
        """A leader with its text that points to a target from about a direction; None where there is no room."""
        lengths, turns = tuple(lengths_mm), tuple(turns_rad)
        for back, length, turn in product((False, True), lengths, turns):
            angle = direction_rad + turn
            elbow = target + length * np.array([np.cos(angle), np.sin(angle)])
            # The text stands on its own leader, which is not on the board yet.
            lines, text = leader(target, elbow, words, back=back)
            clear = not LineString([target, elbow]).intersects(Polygon(text.corners))
            if clear and self.has_room(text) and self.is_free(lines):
                return lines, text
        return None

    def point(self, target: Array, direction_rad: float, words: str, turns_rad: Iterable[float] = TURNS_RAD) -> bool:
        """Add a leader with a text; whether there was room."""
        found = self.pointed(target, direction_rad, words, turns_rad)
        if found is not None:
            self.add(*found[0], found[1])
        return found is not None


def _widened(box: Array) -> Array:
    """The corners of a text's box with the room around it, shape (4, 2)."""
    along, upwards = box[1] - box[0], box[3] - box[0]
    along, upwards = SLACK_MM * along / np.hypot(*along), SLACK_MM * upwards / np.hypot(*upwards)
    return np.array(
        [box[0] - along - upwards, box[1] + along - upwards, box[2] + along + upwards, box[3] - along + upwards]
    )


def _pieces(line: SheetLine | Ring) -> list[BaseGeometry]:
    """A line in short pieces, which are looked at faster."""
    closed = isinstance(line, Ring) or line.closed
    points = np.vstack([line.points, line.points[:1]]) if closed else line.points
    return [LineString(points[start : start + CHUNK + 1]) for start in range(0, len(points) - 1, CHUNK)]


def centered(words: str, place: Array, letter_mm: float, name: str = "") -> Text:
    """A text with its middle at a place."""
    return Text(words, (float(place[0]), float(place[1]) - letter_mm / 2.0), Anchor.MIDDLE, letter_mm, name=name)
