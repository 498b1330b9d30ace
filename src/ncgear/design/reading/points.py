"""A CSV file that a table in the design file can name: its columns as numbers, and the line each row stands in.

Measurements that a balance file takes from CSV files, as the values it could have held itself.
"""

from __future__ import annotations

import csv
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from math import isfinite
from pathlib import Path
from typing import Any

from ncgear.design.keys.base import listed
from ncgear.design.reading.text import plain_number, read_text, shown
from ncgear.design.reading.yaml import Document, Place
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


MOST_ROWS = 1000


@dataclass(frozen=True)
class Measured:
    """Keys that a file stands for with their values, and the row of each item below them."""

    points: PointsFile
    values: Mapping[str, Any]
    rows: Mapping[str, int]

    def place(self, key: str) -> Place | None:
        """The line of a dotted key below the group, or of its nearest parent that has one; None for others."""
        while key:
            if key in self.rows:
                return self.points.place(self.rows[key])
            key = key.rpartition(".")[0]
        return None


def chain_runs(points: PointsFile) -> Measured:
    """The runs of a chain drive, one in each row."""
    rows = zip(*points.columns.values(), strict=True)
    items = [dict(zip(points.columns, row, strict=True)) for row in rows]
    return Measured(points, {"runs": items}, {f"runs.{row}": row for row in range(len(items))})


def rotor_runs(points: PointsFile) -> Measured:
    """The runs of a rotor, one reading in each row: plane 0 without trial weight, then each plane with its own."""
    columns = points.columns
    planes: dict[int, list[int]] = {}
    for row in sorted(range(len(points.lines)), key=lambda row: columns["sensor"][row]):
        planes.setdefault(_whole(points, row), []).append(row)
    if sorted(planes) != list(range(len(planes))) or not planes:
        problem = "planes are numbered 0 (without trial weight), 1, 2 and so on; one of them is missing"
        raise WrongInput(problem, key="plane", location=str(points.place(None)))
    readings = [_readings(columns, planes[plane]) for plane in range(len(planes))]
    trials = [
        {"mass_g": columns["mass_g"][rows[0]], "angle_deg": columns["angle_deg"][rows[0]], "readings": readings[plane]}
        for plane, rows in sorted(planes.items())
        if plane > 0
    ]
    return Measured(points, {"first": readings[0], "trials": trials}, dict(_places(planes)))


def _whole(points: PointsFile, row: int) -> int:
    """The number of the plane in a row."""
    plane = points.columns["plane"][row]
    if not plane.is_integer():
        raise WrongInput(f"{plane:g} given; a whole number is needed", key="plane", location=str(points.place(row)))
    return int(plane)


def _readings(columns: Mapping[str, list[float]], rows: list[int]) -> list[dict[str, float]]:
    return [{"amplitude": columns["amplitude"][row], "phase_deg": columns["phase_deg"][row]} for row in rows]


def _places(planes: Mapping[int, list[int]]) -> list[tuple[str, int]]:
    first = [(f"first.{sensor}", row) for sensor, row in enumerate(planes[0])]
    trials = [(plane - 1, rows) for plane, rows in planes.items() if plane > 0]
    runs = [(f"trials.{number}", rows[0]) for number, rows in trials]
    readings = [(f"trials.{n}.readings.{sensor}", row) for n, rows in trials for sensor, row in enumerate(rows)]
    return [*first, *runs, *readings]


@dataclass(frozen=True)
class Kind:
    """The columns of a file, the keys it stands for, and how its rows become their values."""

    columns: Columns
    keys: tuple[str, ...]
    read: Callable[[PointsFile], Measured]


def _all_of(*names: str) -> Columns:
    return Columns(tuple((name,) for name in names), MOST_ROWS)


KINDS = {
    "chain_drive": Kind(_all_of("weight_deg", "amplitude", "phase_deg"), ("runs",), chain_runs),
    "rotor": Kind(
        _all_of("plane", "mass_g", "angle_deg", "sensor", "amplitude", "phase_deg"), ("first", "trials"), rotor_runs
    ),
}
"""Groups of a balance file that can name a file of measurements."""


def measured(
    document: Document, path: Path, fault: Callable[[WrongInput, Path, str], WrongInput]
) -> dict[str, Measured]:
    """The measurements of each group that names a file; a file that is no text is left to the schema.

    ``fault`` turns an error about a file, named by a key, into the one to raise.
    """
    found = {}
    for group, kind in KINDS.items():
        given = document.data.get(group)
        if not isinstance(given, dict) or not isinstance(given.get("file"), str):
            continue
        for key in (f"{group}.{name}" for name in kind.keys if given.get(name) is not None):
            raise WrongInput("given beside file; keep one of them", key=key, location=str(document.place(key)))
        file = path.parent / given["file"]
        try:
            found[group] = kind.read(read_points(file, kind.columns))
        except WrongInput as error:
            raise fault(error, file, f"{group}.file") from error
    return found
