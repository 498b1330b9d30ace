"""Points of a coordinate measuring machine: a text file with x and y in mm, one point a line.

Columns are separated by commas, semicolons, tabs or spaces; where they are separated by semicolons or tabs, a comma may
stand for the decimal point.  Empty lines and comments are passed over.  A header may name the columns, so that files
with more columns than x and y are read as well; without one, a third column is taken for z.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from math import isfinite
from pathlib import Path

import numpy as np

from ncgear.design.reading.text import plain_number, quoted, read_text
from ncgear.errors import WrongInput
from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array

LARGEST_MB = 50

MOST_POINTS = 500_000

COMMENTS = ("#", "%", "//", "!")
"""How a line begins that is no point."""

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
    """Read the points; raises WrongInput with the line of what is no point, and for a file in inches or without any."""
    text = read_text(path, limit_mb=LARGEST_MB)
    rows: list[tuple[float, float]] = []
    lines: list[int] = []
    columns: tuple[int, int] | None = None
    for line, content in enumerate(text.splitlines(), 1):
        stripped = content.strip()
        if not stripped or stripped.startswith(COMMENTS):
            continue
        cells = _cells(stripped)
        if columns is None and not _is_point(cells):
            columns = _named(cells, f"{path}:{line}:1")
            continue
        columns = columns or (0, 1)
        if len(rows) == MOST_POINTS:
            raise WrongInput(f"over {MOST_POINTS} points; fewer are right", location=f"{path}:{line}:1")
        rows.append(_point(cells, columns, f"{path}:{line}:1"))
        lines.append(line)
    if not rows:
        raise WrongInput("holds no point; lines with x and y in mm are right", location=str(path))
    return MeasuredFile(str(path), np.array(rows), tuple(lines))


def _cells(line: str) -> list[str]:
    """The cells of a line, each number with a decimal point."""
    for separator in (";", "\t"):
        if separator in line:
            # A separator at the end of a line makes no cell.
            return [cell.strip().replace(",", ".") for cell in line.rstrip(separator + " ").split(separator)]
    return [cell.strip() for cell in (line.rstrip(", ").split(",") if "," in line else line.split())]


def _is_point(cells: Sequence[str]) -> bool:
    """Whether the first cell is a number, so that the line is no header."""
    return plain_number(cells[0]) is not None


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
