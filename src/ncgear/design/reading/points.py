"""CSV files that a group of a design or balance file names in place of some of its keys.

Their columns are read as numbers, and the line of each row is kept, so that a fault has its place.
"""

from __future__ import annotations

import csv
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from math import isfinite
from pathlib import Path

from ncgear.design.keys.base import listed
from ncgear.design.reading.places import Document, FromFile, Place, named_by
from ncgear.design.reading.text import plain_number, read_text, shown
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
    values: dict[str, list[float]]
    lines: list[int]

    def row(self, row: int | None) -> Place:
        """Where a row begins; the header for None."""
        return Place(self.file, 1 if row is None else self.lines[row], 1)

    def place(self, key: str) -> Place:
        """Where a column (``ratio``) or a number in it (``ratio.12``) stands."""
        row = key.partition(".")[2]
        return self.row(int(row) if row else None)


@dataclass(frozen=True)
class CsvKind:
    """What a group's file holds: its columns, the keys it stands for, and how its rows become their values.

    Only a group whose ``law`` is this one may name a file, where a law is told.
    """

    columns: Columns
    keys: tuple[str, ...]
    read: Callable[[PointsFile], FromFile] = lambda points: points
    law: str = ""


def values_from_files(document: Document, path: Path, kinds: Mapping[str, CsvKind]) -> dict[str, FromFile]:
    """What the files hold that groups name by their key ``file``; ``kinds`` are by the group's dotted key.

    Files are looked for beside ``path``.  A file's name that is no text is left to the schema.  Raises WrongInput for a
    file that is wrong or missing, and for keys that are given beside it.
    """
    found: dict[str, FromFile] = {}
    for group, kind in kinds.items():
        given = document.at(group)
        if not isinstance(given, dict) or not isinstance(given.get("file"), str):
            continue
        if kind.law and given.get("law") != kind.law:
            continue
        for key in (f"{group}.{name}" for name in kind.keys if given.get(name) is not None):
            raise WrongInput("given beside file; keep one of them", key=key, location=str(document.place(key)))
        file = path.parent / given["file"]
        with named_by(document, f"{group}.file", file):
            found[group] = kind.read(read_points(file, kind.columns))
    return found


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
        points.values[name].append(float(number))


def _wrong(file: str, line: int, cells: list[str], i: int, problem: str, key: str = "") -> WrongInput:
    # Right as long as no cell is in quotes, which numbers need not be.
    column = 1 + sum(len(cell) + 1 for cell in cells[:i])
    return WrongInput(problem, key=key, location=f"{file}:{line}:{column}")
