"""Measurements that a balance file takes from CSV files, as the values it could have held itself."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ncgear.design.points_file import Columns, PointsFile, read_points
from ncgear.design.positions import Document, Place
from ncgear.errors import WrongInput

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
