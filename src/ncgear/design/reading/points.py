"""Files that a group of a design or balance file names instead of some of its keys; here tables.

The columns are read as numbers.  The line of each row is kept, so that a fault has its place.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from math import isfinite
from pathlib import Path
from typing import Any

from ncgear.design.keys.base import listed
from ncgear.design.reading.places import Document, FromFile, Place, named_by
from ncgear.design.reading.table import Row, column_name, read_rows
from ncgear.design.reading.text import plain_number, quoted
from ncgear.errors import WrongInput
from ncgear.frozen import dataclass

LARGEST_MB = 20


@dataclass(frozen=True)
class Columns:
    """The columns of a file, one of each kind, and the largest number of points; a kind is a list of possible names."""

    kinds: tuple[tuple[str, ...], ...]
    most_points: int

    @property
    def names(self) -> tuple[str, ...]:
        """All names."""
        return tuple(name for kind in self.kinds for name in kind)


@dataclass(frozen=True)
class PointsFile:
    """Columns of a CSV file by name, and the line of the header and of each row."""

    file: str
    header: int
    values: dict[str, list[float]]
    lines: list[int]

    def row(self, row: int | None) -> Place:
        """The place where a row begins; None stands for the header."""
        return Place(self.file, self.header if row is None else self.lines[row], 1)

    def place(self, key: str) -> Place:
        """The place of a column (``ratio``) or of a number in it (``ratio.12``)."""
        row = key.partition(".")[2]
        return self.row(int(row) if row else None)


@dataclass(frozen=True)
class FileKind:
    """What a group's file is read for: the keys that it replaces, and how.

    ``read`` has the file and the other keys of the group.  If ``law`` is not empty, only a group with this law may name
    a file.
    """

    keys: tuple[str, ...]
    read: Callable[[Path, Mapping[str, Any]], FromFile]
    law: str = ""


def columns_kind(columns: Columns, law: str = "") -> FileKind:
    """The columns of a CSV file in place of keys of the same names."""

    def read(file: Path, _: Mapping[str, Any]) -> FromFile:
        points = read_points(file, columns)
        return FromFile(points.values, points.place)

    return FileKind(columns.names, read, law)


def values_from_files(document: Document, path: Path, kinds: Mapping[str, FileKind]) -> dict[str, FromFile]:
    """The values of the files that groups name by their key ``file``; ``kinds`` are by the group's dotted key.

    Files must be beside ``path``.  The schema refuses a name of a file that is not text.  Raises WrongInput for a file
    that is wrong or missing, and for keys that are given beside it.
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
            found[group] = kind.read(file, given)
    return found


def read_points(path: Path, columns: Columns) -> PointsFile:
    """Read the columns, others than which are passed over; WrongInput names the line of a cell that is no number."""
    rows = read_rows(path, limit_mb=LARGEST_MB)
    header = next(rows, Row(1, []))
    places = _places(header, str(path), columns)
    points = PointsFile(str(path), header.line, {name: [] for name in places}, [])
    width = len(header.cells)
    for row in rows:
        _append(points, places, width, row, columns.most_points)
    return points


def _places(header: Row, file: str, columns: Columns) -> dict[str, int]:
    """The columns that are asked for, by name, in the order of the file."""
    names = [column_name(cell) for cell in header.cells]
    for i, name in enumerate(names):
        if name in columns.names and name in names[:i]:
            raise _wrong(file, header, i, f"column given twice: {quoted(name)}")
    named = [name for name in names if name]
    for kind in columns.kinds:
        if len(set(kind) & set(names)) == 1:
            continue
        for i, name in enumerate(names):
            if name and name not in columns.names:
                known = f"columns can be {listed(columns.names)}"
                raise _wrong(file, header, i, f"unknown column: {quoted(header.cells[i].strip())}; {known}")
        problem = f"the header must name one of the columns {listed(kind)}; it names {listed(named, 'and') or 'none'}"
        raise WrongInput(problem, location=f"{file}:{header.line}:1")
    return {name: i for i, name in enumerate(names) if name in columns.names}


def _append(points: PointsFile, places: Mapping[str, int], width: int, row: Row, most: int) -> None:
    cells = row.cells
    while len(cells) > width and not cells[-1].strip():
        cells = cells[:-1]
    if len(cells) != width:
        decimals = ", its decimals after a point," if row.comma else ""
        problem = f"{len(cells)} values for {width} columns; one number for each{decimals} is right"
        raise WrongInput(problem, location=f"{points.file}:{row.line}:1")
    if len(points.lines) == most:
        raise WrongInput(f"over {most} points; fewer are right", location=f"{points.file}:{row.line}:1")
    points.lines.append(row.line)
    for name, i in places.items():
        number = plain_number(cells[i].strip())
        if number is None or not isfinite(number):
            raise _wrong(points.file, row, i, f"{quoted(cells[i])} is not a finite number; one is needed", name)
        points.values[name].append(float(number))


def _wrong(file: str, row: Row, i: int, problem: str, key: str = "") -> WrongInput:
    return WrongInput(problem, key=key, location=f"{file}:{row.line}:{row.column(i)}")
