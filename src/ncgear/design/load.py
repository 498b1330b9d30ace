"""Reading a design file: plain values, checked against the schema, every fault with its line and column."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from ncgear.design.angles import spellings
from ncgear.design.messages import Problem, problems
from ncgear.design.points_file import PointsFile, read_points
from ncgear.design.positions import Document, Place, read_yaml
from ncgear.design.scalars import shown
from ncgear.design.schema import Design
from ncgear.design.table import COLUMNS
from ncgear.design.text_file import read_text
from ncgear.errors import DesignError, WrongInput

LARGEST_MB = 5
MOST_PROBLEMS = 10


@dataclass(frozen=True)
class Source:
    """Where the values of a design stand: in the design file and, for a table law, perhaps in a file of points."""

    document: Document
    points: PointsFile | None = None

    def place(self, key: str) -> Place:
        """Where ``key`` (dotted) stands, or its nearest parent that does."""
        group, _, column = key.partition(".")
        name, _, row = column.partition(".")
        if self.points and group == "motion" and name in self.points.columns:
            return self.points.place(int(row) if row else None)
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

    def locate(self, key: str) -> str:
        """``FILE:LINE:COLUMN`` of a dotted key, or of its nearest parent that the file has."""
        return str(self.source.place(key))


def load(path: Path) -> LoadedDesign:
    """Read and check a design file; WrongInput says where and what is wrong, up to ten faults in the file's order."""
    text = read_text(path, limit_mb=LARGEST_MB)
    document = read_yaml(text, str(path))
    if not isinstance(document.data, dict):
        raise WrongInput(_no_mapping(document.data), location=str(document.place("")))
    points = _points(document, path)
    source = Source(document, points)
    try:
        design = Design.model_validate(_with_points(document.data, points))
    except ValidationError as error:
        raise _wrong_input(problems(error), source) from error
    return LoadedDesign(design, path, source, text)


def with_location(error: DesignError, loaded: LoadedDesign) -> DesignError:
    """``error``, which knows only its key, with the place of that key; an error that has a place keeps it."""
    if not error.location:
        error.location = loaded.locate(error.key)
        error.key = loaded.source.as_written(error.key)
    return error


def _no_mapping(data: Any) -> str:
    given = "is empty" if data is None else f"holds {shown(data)}"
    return f"{given}; a design file is lines of `key: value`, and begins with `name:` (`ncgear new NAME` writes one)"


def _points(document: Document, path: Path) -> PointsFile | None:
    """The points of a table law that names a file; a file that is no text is left to the schema."""
    motion = document.data.get("motion")
    if not isinstance(motion, dict) or motion.get("law") != "table" or not isinstance(motion.get("file"), str):
        return None
    for column in COLUMNS:
        if motion.get(column) is not None:
            key = f"motion.{column}"
            raise WrongInput("given beside file; keep one of them", key=key, location=str(document.place(key)))
    return _read_points(document, path.parent / motion["file"])


def _read_points(document: Document, path: Path) -> PointsFile:
    try:
        return read_points(path)
    except WrongInput as error:
        # A fault within the file has a line of that file; a file that cannot be had is a fault of the design's key.
        if error.location != str(path):
            raise
        place = str(document.place("motion.file"))
        raise WrongInput(f"{path} {error.problem}", key="motion.file", location=place) from error


def _with_points(data: dict[str, Any], points: PointsFile | None) -> dict[str, Any]:
    if points is None:
        return data
    return {**data, "motion": {**data["motion"], **points.columns}}


def _wrong_input(found: list[Problem], source: Source) -> WrongInput:
    """One error of all faults in the order of the file; faults of the file of points come last."""
    own_file = source.document.place("").file
    placed = [(source.place(problem.key), problem) for problem in found]
    placed.sort(key=lambda item: (item[0].file != own_file, item[0].line, item[0].column))
    (place, first), *others = placed
    lines = [first.text, *(f"{where}: {key}: {text}" for where, (key, text) in others[: MOST_PROBLEMS - 1])]
    if len(placed) > MOST_PROBLEMS:
        lines.append(f"and {len(placed) - MOST_PROBLEMS} more")
    return WrongInput("\n".join(lines), key=first.key, location=str(place))
