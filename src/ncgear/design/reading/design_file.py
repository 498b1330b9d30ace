"""Reading a design file: plain values, checked against the schema, every fault with its line and column."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Protocol

from pydantic import ValidationError

from ncgear.design.keys.base import spellings
from ncgear.design.keys.design import Design, design_model
from ncgear.design.keys.machine import MOST_POINTS as MOST_RESISTANCE_POINTS
from ncgear.design.keys.motion import ANGLE_COLUMNS, MOST_POINTS, VALUE_COLUMNS
from ncgear.design.reading.messages import Problem, problems
from ncgear.design.reading.points import Columns, PointsFile, read_points
from ncgear.design.reading.text import read_text, shown
from ncgear.design.reading.yaml import Document, Place, read_yaml
from ncgear.errors import DesignError, WrongInput

LARGEST_MB = 5
MOST_PROBLEMS = 10

TABLES = {
    "motion": Columns((ANGLE_COLUMNS, VALUE_COLUMNS), MOST_POINTS),
    "resistance.table": Columns((("displacement_mm",), ("force_n",)), MOST_RESISTANCE_POINTS),
}
"""Groups of the design file that can name a file of points instead of giving columns, and the columns."""


class Places(Protocol):
    """Where the values of a file stand."""

    def place(self, key: str) -> Place:
        """Where ``key`` (dotted) stands, or its nearest parent that does."""


@dataclass(frozen=True)
class Source:
    """Where the values of a design stand: in the design file and, for tables, perhaps in files of points by group."""

    document: Document
    points: dict[str, PointsFile]

    def place(self, key: str) -> Place:
        """Where ``key`` (dotted) stands, or its nearest parent that does."""
        for group, points in self.points.items():
            name, _, row = key.removeprefix(f"{group}.").partition(".")
            if key.startswith(f"{group}.") and name in points.columns:
                return points.place(int(row) if row else None)
        return self.document.place(self.as_written(key))

    def as_written(self, key: str) -> str:
        """``key`` as the file spells it: an angle's key ends in the unit it was given in."""
        if key in self.document.places:
            return key
        quantity = key.rpartition("_")[0] if key.endswith(("_rad", "_deg", "_pi")) else key
        return next((name for name in spellings(quantity) if name in self.document.places), key)


@dataclass(frozen=True)
class LoadedDesign:
    """A design, the file it came from, and that file's text."""

    design: Design
    path: Path
    source: Source
    text: str

    @property
    def data(self) -> dict[str, Any]:
        """The plain values of the file, with the columns of its files of points; not to be changed."""
        return _with_points(self.source.document.data, self.source.points)

    def locate(self, key: str) -> str:
        """``FILE:LINE:COLUMN`` of a dotted key, or of its nearest parent that the file has."""
        return str(self.source.place(key))

    @contextmanager
    def locating(self) -> Iterator[None]:
        """A context in which errors that know only their key get its place; an error that has a place keeps it."""
        try:
            yield
        except DesignError as error:
            if not error.location:
                error.location = self.locate(error.key)
                error.key = self.source.as_written(error.key)
            raise


def load(path: Path) -> LoadedDesign:
    """Read and check a design file; WrongInput says where and what is wrong, up to ten faults in the file's order."""
    return parsed(read_text(path, limit_mb=LARGEST_MB), path)


def parsed(text: str, path: Path) -> LoadedDesign:
    """The same from the text of a file; files of points that it names are looked for beside ``path``."""
    document = read_yaml(text, str(path))
    if not isinstance(document.data, dict):
        raise WrongInput(_no_mapping(document.data), location=str(document.place("")))
    source = Source(document, dict(_points(document, path)))
    try:
        design = design_model(document.data).model_validate(_with_points(document.data, source.points))
    except ValidationError as error:
        raise wrong_input(problems(error, design_model(document.data)), source) from error
    return LoadedDesign(design, path, source, text)


def _no_mapping(data: Any) -> str:
    given = "is empty" if data is None else f"holds {shown(data)}"
    return f"{given}; a design file is lines of `key: value`, and begins with `name:` (`ncgear new NAME` writes one)"


def _points(document: Document, path: Path) -> Iterator[tuple[str, PointsFile]]:
    """The points of each table that names a file; a file that is no text is left to the schema."""
    for group, columns in TABLES.items():
        table = _at(document.data, group)
        if not isinstance(table, dict) or not isinstance(table.get("file"), str):
            continue
        if group == "motion" and table.get("law") != "table":
            continue
        for column in columns.names:
            if table.get(column) is not None:
                key = f"{group}.{column}"
                raise WrongInput("given beside file; keep one of them", key=key, location=str(document.place(key)))
        yield group, _read_points(document, path.parent / table["file"], group)


def _at(data: Any, group: str) -> Any:
    """What stands at a dotted key; None where there is nothing."""
    for key in group.split("."):
        data = data.get(key) if isinstance(data, dict) else None
    return data


def _read_points(document: Document, path: Path, group: str) -> PointsFile:
    try:
        return read_points(path, TABLES[group])
    except WrongInput as error:
        raise of_key(error, path, f"{group}.file", document) from error


def of_key(error: WrongInput, file: Path, key: str, document: Document) -> WrongInput:
    """A fault within a file that ``key`` names has a place there; a file that cannot be had is a fault of the key."""
    if error.location != str(file):
        return error
    return WrongInput(f"{file} {error.problem}", key=key, location=str(document.place(key)))


def _with_points(data: dict[str, Any], points: dict[str, PointsFile]) -> dict[str, Any]:
    """The data with the columns of every file in their group."""
    for group, found in points.items():
        data = _merged(data, group.split("."), found.columns)
    return data


def _merged(data: dict[str, Any], keys: list[str], columns: dict[str, list[float]]) -> dict[str, Any]:
    if not keys:
        return {**data, **columns}
    return {**data, keys[0]: _merged(data[keys[0]], keys[1:], columns)}


def wrong_input(found: list[Problem], source: Places) -> WrongInput:
    """One error of all faults in the order of the file; faults of files that it names come last."""
    own_file = source.place("").file
    placed = [(source.place(problem.key), problem) for problem in found]
    placed.sort(key=lambda item: (item[0].file != own_file, item[0].line, item[0].column))
    (place, first), *others = placed
    lines = [first.text, *(f"{where}: {key}: {text}" for where, (key, text) in others[: MOST_PROBLEMS - 1])]
    if len(placed) > MOST_PROBLEMS:
        lines.append(f"and {len(placed) - MOST_PROBLEMS} more")
    return WrongInput("\n".join(lines), key=first.key, location=str(place))
