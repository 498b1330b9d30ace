"""Files that a group of a design or balance file names instead of some of its keys; here CSV files.

The columns are read as numbers.  The line of each row is kept, so that a fault has its place.
"""

from __future__ import annotations

import csv
from collections.abc import Callable, Iterator, Mapping
from math import isfinite
from pathlib import Path
from typing import Any

from ncgear.design.keys.base import listed
from ncgear.design.reading.places import Document, FromFile, Place, named_by
from ncgear.design.reading.text import plain_number, quoted, read_text
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
    """Read the columns; WrongInput names the line of a cell that is no finite number, or of an unknown column."""
    text = read_text(path, limit_mb=LARGEST_MB)
    rows = _rows(text, str(path))
    line, header = next(rows, (1, []))
    names = _names(header, str(path), line, columns)
    points = PointsFile(str(path), line, {name: [] for name in names}, [])
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


def _names(header: list[str], file: str, line: int, columns: Columns) -> list[str]:
    names = [cell.strip() for cell in header]
    for i, name in enumerate(names):
        if name not in columns.names or name in names[:i]:
            problem = "column given twice" if name in columns.names else "unknown column"
            raise _wrong(
                file,
                line,
                header,
                i,
                f"{problem}: {quoted(name)}; columns can be {listed(columns.names)}, with commas between",
            )
    for kind in columns.kinds:
        if len(set(kind) & set(names)) != 1:
            problem = (
                f"the header must name one of the columns {listed(kind)}; it names {listed(names, 'and') or 'none'}"
            )
            raise WrongInput(problem, location=f"{file}:{line}:1")
    return names


def _append(points: PointsFile, names: list[str], line: int, cells: list[str], most: int) -> None:
    if len(cells) != len(names):
        problem = (
            f"{len(cells)} values for {len(names)} columns; one number for each, its decimals after a point, is right"
        )
        raise WrongInput(problem, location=f"{points.file}:{line}:1")
    if len(points.lines) == most:
        raise WrongInput(f"over {most} points; fewer are right", location=f"{points.file}:{line}:1")
    points.lines.append(line)
    for i, (name, cell) in enumerate(zip(names, cells, strict=True)):
        number = plain_number(cell.strip())
        if number is None or not isfinite(number):
            raise _wrong(points.file, line, cells, i, f"{quoted(cell)} is not a finite number; one is needed", name)
        points.values[name].append(float(number))


def _wrong(file: str, line: int, cells: list[str], i: int, problem: str, key: str = "") -> WrongInput:
    # The column is right as long as no cell is in quotes, which numbers do not need.
    column = 1 + sum(len(cell) + 1 for cell in cells[:i])
    return WrongInput(problem, key=key, location=f"{file}:{line}:{column}")
