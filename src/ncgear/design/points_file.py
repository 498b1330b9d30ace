"""A CSV file that a table in the design file can name: its columns as numbers, and the line each row stands in."""

from __future__ import annotations

import csv
from collections.abc import Iterator
from dataclasses import dataclass
from math import isfinite
from pathlib import Path

from ncgear.design.angles import listed
from ncgear.design.positions import Place
from ncgear.design.scalars import plain_number, shown
from ncgear.design.text_file import read_text
from ncgear.errors import WrongInput

LARGEST_MB = 20


@dataclass(frozen=True)
class Columns:
    """What a file holds: one column of each kind, a kind being the names it can go by, and so many points at most."""

    kinds: tuple[tuple[str, ...], ...]
    most_points: int

    @property
    def names(self) -> tuple[str, ...]:
        """All names."""
        return tuple(name for kind in self.kinds for name in kind)


@dataclass(frozen=True)
class PointsFile:
    """Columns of a CSV file by name, and the line of each row."""

    file: str
    columns: dict[str, list[float]]
    lines: list[int]

    def place(self, row: int | None) -> Place:
        """Where a row begins; the header for None."""
        return Place(self.file, 1 if row is None else self.lines[row], 1)


def read_points(path: Path, columns: Columns) -> PointsFile:
    """Read the columns; WrongInput names the line of what is no finite number or no known column."""
    text = read_text(path, limit_mb=LARGEST_MB)
    rows = _rows(text, str(path))
    _, header = next(rows, (1, []))
    names = _names(header, str(path), columns)
    points = PointsFile(str(path), {name: [] for name in names}, [])
    for line, cells in rows:
        _append(points, names, line, cells, columns.most_points)
    return points


def _rows(text: str, file: str) -> Iterator[tuple[int, list[str]]]:
    """Rows that are not blank, each with its line."""
    reader = csv.reader(text.splitlines(), strict=True, skipinitialspace=True)
    try:
        yield from ((reader.line_num, cells) for cells in reader if any(cell.strip() for cell in cells))
    except csv.Error as error:
        problem = f"is not CSV: {error}; numbers separated by commas are right"
        raise WrongInput(problem, location=f"{file}:{reader.line_num}:1") from error


def _names(header: list[str], file: str, columns: Columns) -> list[str]:
    names = [cell.strip() for cell in header]
    for i, name in enumerate(names):
        if name not in columns.names or name in names[:i]:
            problem = "column given twice" if name in columns.names else "unknown column"
            raise _wrong(file, 1, header, i, f"{problem}: {shown(name)}; columns can be {listed(columns.names)}")
    for kind in columns.kinds:
        if len(set(kind) & set(names)) != 1:
            problem = f"the first line must name one of the columns {listed(kind)}; it names {listed(names) or 'none'}"
            raise WrongInput(problem, location=f"{file}:1:1")
    return names


def _append(points: PointsFile, names: list[str], line: int, cells: list[str], most: int) -> None:
    if len(cells) != len(names):
        problem = f"{len(cells)} values for {len(names)} columns; one number for each column is right"
        raise WrongInput(problem, location=f"{points.file}:{line}:1")
    if len(points.lines) == most:
        raise WrongInput(f"over {most} points; fewer are right", location=f"{points.file}:{line}:1")
    points.lines.append(line)
    for i, (name, cell) in enumerate(zip(names, cells, strict=True)):
        number = plain_number(cell.strip())
        if number is None or not isfinite(number):
            raise _wrong(points.file, line, cells, i, f"{shown(cell)} is not a finite number; one is needed", name)
        points.columns[name].append(float(number))


def _wrong(file: str, line: int, cells: list[str], i: int, problem: str, key: str = "") -> WrongInput:
    # Right as long as no cell is in quotes, which numbers need not be.
    column = 1 + sum(len(cell) + 1 for cell in cells[:i])
    return WrongInput(problem, key=key, location=f"{file}:{line}:{column}")
