"""Reading a balance file, with the designs and the files of measurements that it names."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any

from ncgear.design.keys.balance import Balance
from ncgear.design.reading.design_file import LARGEST_MB, LoadedDesign, load, refuse_train
from ncgear.design.reading.messages import checked
from ncgear.design.reading.places import Document, FilePlace, FromFile, Source, named_by
from ncgear.design.reading.points import FileColumns, PointsFile, PointsKind, read_points, values_from_files
from ncgear.design.reading.text import read_text
from ncgear.design.reading.yaml import read_yaml
from ncgear.errors import WrongInput
from ncgear.frozen import dataclass

OF_A_DESIGN = {"linkage", "motion"}
"""Keys of every design file and of no balance file; a file with them gets one message, and not one for each key."""

MOST_ROWS = 1000


@dataclass(frozen=True)
class LoadedBalance:
    """A balance file, the places of its values, and the designs that it names, by their keys."""

    balance: Balance
    source: Source
    designs: dict[str, LoadedDesign]


def load_balance(path: Path) -> LoadedBalance:
    """Read and check a balance file and the designs that it names; WrongInput says where and what is wrong."""
    document = read_yaml(read_text(path, limit_mb=LARGEST_MB), str(path))
    if not isinstance(document.data, dict):
        problem = "holds no balance; a balance file is lines of `key: value`, and begins with `name:`"
        raise WrongInput(problem, location=str(document.place("")))
    refuse_train(document, "a balance file")
    if document.data.keys() >= OF_A_DESIGN:
        problem = (
            "is a design file; a balance file is needed, in which mechanisms.design or gears.design names this one"
        )
        raise WrongInput(problem, location=str(document.place("")))
    source = Source(document, values_from_files(document, path, FILES))
    balance = checked(Balance, source)
    return LoadedBalance(balance, source, dict(_designs(balance, document, path)))


def _designs(balance: Balance, document: Document, path: Path) -> Iterator[tuple[str, LoadedDesign]]:
    """Each design that the file names, with the key that names it."""
    named = {
        f"mechanisms.{k}.design": mechanism.design
        for k, mechanism in enumerate(balance.mechanisms)
        if mechanism.design is not None
    }
    if balance.gears is not None:
        named["gears.design"] = balance.gears.design
    for key, name in named.items():
        with named_by(document, key, path.parent / name):
            yield key, load(path.parent / name)


def _measured(points: PointsFile, values: Mapping[str, Any], rows: Mapping[str, int]) -> FromFile:
    """The keys that a file of measurements replaces, with their values, and the row of each list item under them."""

    def place(key: str) -> FilePlace | None:
        while key and key not in rows:
            key = key.rpartition(".")[0]
        return points.row(rows[key]) if key else None

    return FromFile(values, place)


def chain_runs(points: PointsFile) -> FromFile:
    """The runs of a chain drive, one in each row."""
    rows = zip(*points.values.values(), strict=True)
    items = [dict(zip(points.values, row, strict=True)) for row in rows]
    return _measured(points, {"runs": items}, {f"runs.{row}": row for row in range(len(items))})


def rotor_runs(points: PointsFile) -> FromFile:
    """The runs of a rotor, one reading in each row; plane 0 has no trial weight, each other plane has its own."""
    columns = points.values
    planes: dict[int, list[int]] = {}
    for row in sorted(range(len(points.lines)), key=lambda row: columns["sensor"][row]):
        planes.setdefault(_plane(points, row), []).append(row)
    if sorted(planes) != list(range(len(planes))) or not planes:
        problem = "planes are numbered 0 (without trial weight), 1, 2 and so on; one of them is missing"
        raise WrongInput(problem, key="plane", location=str(points.row(None)))
    readings = [
        [{"amplitude": columns["amplitude"][row], "phase_deg": columns["phase_deg"][row]} for row in planes[plane]]
        for plane in range(len(planes))
    ]
    trials = [
        {"mass_g": columns["mass_g"][rows[0]], "angle_deg": columns["angle_deg"][rows[0]], "readings": readings[plane]}
        for plane, rows in sorted(planes.items())
        if plane > 0
    ]
    return _measured(points, {"first": readings[0], "trials": trials}, _rows_by_key(planes))


def _plane(points: PointsFile, row: int) -> int:
    plane = points.values["plane"][row]
    if not plane.is_integer():
        raise WrongInput(f"{plane:g} given; a whole number is needed", key="plane", location=str(points.row(row)))
    return int(plane)


def _rows_by_key(planes: Mapping[int, list[int]]) -> dict[str, int]:
    """The row of each reading and of each trial, by its key; ``planes`` gives the rows of each plane."""
    first = [(f"first.{sensor}", row) for sensor, row in enumerate(planes[0])]
    trials = [(plane - 1, rows) for plane, rows in planes.items() if plane > 0]
    runs = [(f"trials.{number}", rows[0]) for number, rows in trials]
    readings = [(f"trials.{n}.readings.{sensor}", row) for n, rows in trials for sensor, row in enumerate(rows)]
    return dict([*first, *runs, *readings])


def _kind(keys: tuple[str, ...], names: str, runs: Callable[[PointsFile], FromFile]) -> PointsKind:
    columns = FileColumns(tuple((name,) for name in names.split()), MOST_ROWS)
    return PointsKind(keys, lambda file, _: runs(read_points(file, columns)))


FILES = {
    "chain_drive": _kind(("runs",), "weight_deg amplitude phase_deg", chain_runs),
    "rotor": _kind(("first", "trials"), "plane mass_g angle_deg sensor amplitude phase_deg", rotor_runs),
}
"""Groups of a balance file that can name a file of measurements."""
