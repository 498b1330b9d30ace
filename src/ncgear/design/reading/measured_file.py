"""Points of a coordinate measuring machine: a text file with x and y in mm, one point a line.

It is a table as ``ncgear.design.reading.points`` reads it.  A header may name the columns, so that files may have more
columns than x and y; without a header, a third column counts as z, which hardly changes.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from math import isfinite
from pathlib import Path

import numpy as np

from ncgear.design.reading.points import read_rows
from ncgear.design.reading.text import plain_number, quoted
from ncgear.errors import WrongInput
from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array

LARGEST_MB = 50

MOST_POINTS = 500_000

IN_INCHES = re.compile(r"\b(in|inch|inches)\b|_in\b", re.IGNORECASE)

NAME = re.compile(r"(?P<axis>[xyz])(?:[\s_(\[]*(?P<unit>[a-z]*)[)\]]*)?", re.IGNORECASE)
"""A column's name: ``x``, ``X_mm``, ``x (mm)``."""


@dataclass(frozen=True, eq=False)
class MeasuredFile:
    """The points of a file in mm, shape (n, 2), and the line of each, shape (n,)."""

    file: str
    points_mm: Array
    lines: tuple[int, ...]


def read_measured(path: Path) -> MeasuredFile:
    """Read the points; raises WrongInput at the line of a text that is no point, and for inches or no points at all."""
    points: list[tuple[float, float]] = []
    third: list[str] = []
    lines: list[int] = []
    columns: tuple[int, int] | None = None
    is_named = False
    for row in read_rows(path, limit_mb=LARGEST_MB):
        cells, location = [cell.strip() for cell in row.cells], f"{path}:{row.line}:1"
        while not cells[-1]:
            # A separator at the end of a line makes no cell.
            cells.pop()
        if columns is None and plain_number(cells[0]) is None:
            columns, is_named = _named(cells, location), True
            continue
        columns = columns or (0, 1)
        if len(points) == MOST_POINTS:
            raise WrongInput(f"over {MOST_POINTS} points; fewer are right", location=location)
        points.append(_point(cells, columns, location))
        third += cells[2:3] if columns == (0, 1) else []
        lines.append(row.line)
    if third and not is_named:
        _require_height(third, np.array(points), str(path))
    if not points:
        raise WrongInput("holds no point; lines with x and y in mm are right", location=str(path))
    return MeasuredFile(str(path), np.array(points), tuple(lines))


LEVEL = 0.1
"""Share of the points' smaller extent, in x or in y, by which heights z of a gear's section may differ."""


def _require_height(third: Sequence[str], points: Array, location: str) -> None:
    """Refuse a third column without a name that is no height: it is y then, and the first column numbers the points."""
    numbers = [plain_number(cell) for cell in third]
    heights = np.array([number for number in numbers if number is not None], dtype=float)
    if heights.size == len(numbers) and not np.ptp(heights) <= LEVEL * float(np.ptp(points, axis=0).min()):
        problem = "three columns without a header, and the third is no height z: it varies as x and y do"
        raise WrongInput(f"{problem}; a line such as no,x_mm,y_mm at the top is right", location=location)


def _named(cells: Sequence[str], location: str) -> tuple[int, int]:
    """The columns of x and y of a header."""
    names = [NAME.fullmatch(cell.strip('"').strip()) for cell in cells]
    if any(IN_INCHES.search(cell) for cell in cells):
        raise WrongInput("the header names inches; points in mm are right", location=location)
    found = {}
    for axis in ("x", "y"):
        places = [place for place, name in enumerate(names) if name and name["axis"].lower() == axis]
        if len(places) != 1:
            problem = f"the header must name one column {axis}; it reads {quoted(', '.join(cells))}"
            raise WrongInput(f"{problem}; a line such as x_mm,y_mm, or none, is right", location=location)
        unit = names[places[0]]["unit"]  # type: ignore[index]
        if unit and unit.lower() not in ("mm", "coordinate", "coord"):
            raise WrongInput(f"the header names {quoted(unit)} as the unit of {axis}; mm is right", location=location)
        found[axis] = places[0]
    return found["x"], found["y"]


def _point(cells: Sequence[str], columns: tuple[int, int], location: str) -> tuple[float, float]:
    if len(cells) <= max(columns):
        problem = f"{len(cells)} value; x and y in mm are right"
        raise WrongInput(problem, location=location)
    if columns == (0, 1) and len(cells) > 3:
        problem = f"{len(cells)} values without a header that names x and y"
        raise WrongInput(
            f"{problem}; where commas are decimal, columns must be separated by semicolons", location=location
        )
    x, y = (plain_number(cells[column]) for column in columns)
    for cell, number in zip((cells[column] for column in columns), (x, y), strict=True):
        if number is None or not isfinite(number):
            raise WrongInput(f"{quoted(cell)} is not a finite number; x and y in mm are right", location=location)
    assert x is not None
    assert y is not None
    return float(x), float(y)
