"""Reading a design file: plain values, checked against the schema, every fault with its line and column."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from ncgear.design.keys.design import Design, design_model
from ncgear.design.keys.machine import MOST_RESISTANCE_POINTS
from ncgear.design.keys.pitch_shapes import ANGLE_OR_X, RADIUS_OR_Y
from ncgear.design.keys.pitch_shapes import MOST_POINTS as CURVE_POINTS
from ncgear.design.laws.table import ANGLE_COLUMNS, MOST_POINTS, VALUE_COLUMNS
from ncgear.design.reading.contour_file import ContourKind
from ncgear.design.reading.messages import checked
from ncgear.design.reading.places import Document, Source
from ncgear.design.reading.points import Columns, CsvKind, FileKind, values_from_files
from ncgear.design.reading.text import quoted, read_text
from ncgear.design.reading.yaml import read_yaml
from ncgear.errors import WrongInput
from ncgear.frozen import dataclass

LARGEST_MB = 5

FORCE_POINTS = CsvKind(
    Columns((("displacement_mm", "angle_deg"), ("force_n", "torque_n_m")), MOST_RESISTANCE_POINTS),
    ("displacement_mm", "force_n", "angle_deg", "torque_n_m"),
)

FILES: dict[str, FileKind] = {
    "motion": CsvKind(
        Columns((ANGLE_COLUMNS, VALUE_COLUMNS), MOST_POINTS), (*ANGLE_COLUMNS, *VALUE_COLUMNS), law="table"
    ),
    "motion.points": CsvKind(Columns((ANGLE_OR_X, RADIUS_OR_Y), CURVE_POINTS), (*ANGLE_OR_X, *RADIUS_OR_Y)),
    "motion.dxf": ContourKind(),
    "resistance.table": FORCE_POINTS,
    "resistance.returning.table": FORCE_POINTS,
}
"""Groups of the design file that can name a file instead of columns of points or parts of a contour."""


@dataclass(frozen=True)
class LoadedDesign:
    """A design, its file, the places of its values, and the text of the file."""

    design: Design
    path: Path
    source: Source
    text: str

    @property
    def data(self) -> dict[str, Any]:
        """The plain values of the file, with the columns of its files of points; not to be changed."""
        return self.source.data


def load(path: Path) -> LoadedDesign:
    """Read and check a design file; WrongInput says where and what is wrong, up to ten faults in the file's order."""
    return parsed(read_text(path, limit_mb=LARGEST_MB), path)


def parsed(text: str, path: Path) -> LoadedDesign:
    """A design from the text of a file; the files of points that it names must be beside ``path``."""
    return design_of(read_yaml(text, str(path)), text, path)


def design_of(document: Document, text: str, path: Path) -> LoadedDesign:
    """A design from the values of its text; raises as reading the text does."""
    if not isinstance(document.data, dict):
        given = "is empty" if document.data is None else f"holds {quoted(document.data)}"
        form = "a design file is lines of `key: value`, and begins with `name:` (`ncgear new NAME` writes one)"
        raise WrongInput(f"{given}; {form}", location=str(document.place("")))
    source = Source(document, values_from_files(document, path, FILES))
    return LoadedDesign(checked(design_model(document.data), source), path, source, text)
