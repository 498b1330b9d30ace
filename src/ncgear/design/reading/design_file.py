"""Reading a design: a file, or a mapping of Python in its place, checked against the schema; and the file of a train.

Every fault has its line and column, in a mapping its key; a mapping may have arrays for lists.  Functions stay in
``plain``, for ``ncgear.project.opened``.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from ncgear.design.keys.design import Design, design_model, require_known_kind
from ncgear.design.keys.gears import MOST_PAIRS
from ncgear.design.keys.machine import MOST_RESISTANCE_POINTS
from ncgear.design.keys.pitch_shapes import ANGLE_OR_X, RADIUS_OR_Y
from ncgear.design.keys.pitch_shapes import MOST_POINTS as CURVE_POINTS
from ncgear.design.laws.table import ANGLE_COLUMNS, MOST_POINTS, VALUE_COLUMNS
from ncgear.design.reading.contour_file import contour_of
from ncgear.design.reading.messages import checked
from ncgear.design.reading.places import Document, FilePlace, Source
from ncgear.design.reading.points import FileColumns, PointsKind, columns_kind, values_from_files
from ncgear.design.reading.svg_file import picture_contour_of, svg_contour_of
from ncgear.design.reading.text import quoted, read_text
from ncgear.design.reading.yaml import DEEPEST, read_yaml
from ncgear.design.trains.registry import TrainFile, commands_of, names_in_file, train_model
from ncgear.design.words import listed
from ncgear.errors import WrongInput, located
from ncgear.frozen import dataclass

LARGEST_MB = 5

FORCE_POINTS = columns_kind(
    FileColumns((("displacement_mm", "angle_deg"), ("force_n", "torque_n_m")), MOST_RESISTANCE_POINTS)
)

DRAWN = {
    "points": columns_kind(FileColumns((ANGLE_OR_X, RADIUS_OR_Y), CURVE_POINTS)),
    "dxf": PointsKind(("curves",), contour_of),
    "svg": PointsKind(("curves",), svg_contour_of),
    "picture": PointsKind(("curves",), picture_contour_of),
}
"""Drawings of an outline, by their key."""

LAW_GROUPS = ("motion", *(f"motion.pairs.{number}" for number in range(MOST_PAIRS)))
"""Groups with the keys of a law."""

FILES: dict[str, PointsKind] = {
    **dict.fromkeys(LAW_GROUPS, columns_kind(FileColumns((ANGLE_COLUMNS, VALUE_COLUMNS), MOST_POINTS), law="table")),
    **{f"{group}.{shape}": kind for group in (*LAW_GROUPS, "outline.mate") for shape, kind in DRAWN.items()},
    "resistance.table": FORCE_POINTS,
    "resistance.returning.table": FORCE_POINTS,
}
"""Groups of the design file that can name a file in place of columns of points or parts of a contour."""


@dataclass(frozen=True)
class LoadedDesign:
    """A design, its file, the places of its values, and the text of the file."""

    design: Design
    path: Path
    source: Source
    text: str

    @property
    def is_train(self) -> bool:
        """Whether the file describes a train, read as the machine that it is."""
        return bool(self.source.document.written_as)

    @property
    def data(self) -> dict[str, Any]:
        """The plain values of the file, with the columns of its files of points; not to be changed."""
        return self.source.document.own or self.source.data


def load(path: Path, *, for_loads: bool = False) -> LoadedDesign:
    """Read and check a design file; WrongInput says where and what is wrong, up to ten faults in the file's order.

    A train that is a machine of gears by themselves is read as such a machine; the gears of a carrier, as it sees them,
    only ``for_loads``.
    """
    text = read_text(path, limit_mb=LARGEST_MB)
    document = read_yaml(text, str(path))
    if isinstance(document.data, dict) and "train" in document.data:
        document = _as_machine(document, for_loads=for_loads)
    return design_of(document, text, path)


def _as_machine(document: Document, *, for_loads: bool) -> Document:
    """The file of a train as the file of the machine that it is; as it is where it is none.

    Keys have their places in the train's file.
    """
    loaded = _train_of(document)
    file, places = loaded.file, document.places
    with located(loaded.source):
        if not (for_loads or file.train.TURNS_ALONE) or (data := file.machine()) is None:
            return document
        file.train.require_bores()
    given = {key.removeprefix("train."): key for key in places if key.startswith("train.")}
    written_as = given | names_in_file(type(file.train))
    places = {**places, **{key: document.place(name) for key, name in written_as.items()}}
    return Document(data, places, written_as, file.alone, document.data)


def parsed(text: str, path: Path) -> LoadedDesign:
    """A design from the text of a file; its files of points must be beside ``path``."""
    return design_of(read_yaml(text, str(path)), text, path)


def as_it_is(text: str, path: Path, document: Document | None = None) -> LoadedDesign | LoadedTrain:
    """As ``parsed``, by the values of the text if they are known; the file of a train is read as a train."""
    document = document or read_yaml(text, str(path))
    if isinstance(document.data, dict) and "train" in document.data:
        return _train_of(document)
    return design_of(document, text, path)


def design_of(document: Document, text: str, path: Path) -> LoadedDesign:
    """A design from the values of its text; raises the errors of reading the text."""
    if not isinstance(document.data, dict):
        given = "is empty" if document.data is None else f"holds {quoted(document.data)}"
        form = "a design file is lines of `key: value`, and begins with `name:` (`ncgear new NAME` writes one)"
        raise WrongInput(f"{given}; {form}", location=str(document.place("")))
    return _design(document, text, path)


def refuse_train(document: Document, needed: str) -> None:
    """Refuse the file of a train of gears if another file is needed; raises WrongInput with the commands that work."""
    if "train" in document.data:
        train = document.data["train"]
        taken = listed((f"`{command}`" for command in commands_of(train)), "and")
        problem = f"the file has a train of gears, which {taken} of ncgear take; this needs {needed}"
        raise WrongInput(problem, key="train", location=str(document.place("train")))


def _design(document: Document, text: str, path: Path) -> LoadedDesign:
    refuse_train(document, "the design of one machine, with linkage and motion")
    source = Source(document, values_from_files(document, path, FILES))
    with located(source):
        require_known_kind(document.data)
    design = checked(design_model(document.data), source)
    return LoadedDesign(design.of_train(document.alone) if document.written_as else design, path, source, text)


MAPPING = Path("mapping")
"""The mapping's substitute for the path of a file; files that a mapping names are beside the working folder."""


def parsed_mapping(data: Mapping[str, Any]) -> LoadedDesign:
    """A design from plain values (``plain``); raises WrongInput with the key of each fault, up to ten."""
    nowhere = FilePlace("", 0, 0)
    return _design(Document(dict(data), {"": nowhere, **dict.fromkeys(_keys(data, ""), nowhere)}), "", MAPPING)


def plain(value: Any, key: str = "") -> Any:
    """A mapping with lists in place of arrays and tuples, and Python's numbers in place of numpy's numbers.

    Raises WrongInput for keys that are not text.
    """
    if key.count(".") >= DEEPEST:
        raise WrongInput(f"nested over {DEEPEST} levels deep; no key of ncgear needs over five", key=key.split(".")[0])
    if isinstance(value, Mapping):
        for name in value:
            if not isinstance(name, str):
                raise WrongInput(f"{name!r} is a key; keys are text", key=key)
        return {name: plain(inner, f"{key}.{name}".lstrip(".")) for name, inner in value.items()}
    if hasattr(value, "tolist"):
        return value.tolist()
    return [plain(x, f"{key}.{place}") for place, x in enumerate(value)] if isinstance(value, list | tuple) else value


def _keys(value: Any, above: str) -> Iterator[str]:
    """The dotted keys of all groups and list items."""
    inner = value.items() if isinstance(value, Mapping) else enumerate(value) if isinstance(value, list) else ()
    for name, inner_value in inner:
        key = f"{above}.{name}".lstrip(".")
        yield key
        yield from _keys(inner_value, key)


@dataclass(frozen=True)
class LoadedTrain:
    """A train file and the places of its values."""

    file: TrainFile
    source: Source

    @property
    def places(self) -> Source:
        """The places of the values."""
        return self.source


def load_train(path: Path) -> LoadedTrain:
    """Read and check a train file; WrongInput says where and what is wrong, up to ten faults."""
    document = read_yaml(read_text(path, limit_mb=LARGEST_MB), str(path))
    if not isinstance(document.data, dict) or "train" not in document.data:
        raise WrongInput("holds no train; a train file has name: and train:", location=str(document.place("")))
    return _train_of(document)


def _train_of(document: Document) -> LoadedTrain:
    source = Source(document, {})
    with located(source):
        model = train_model(document.data)
    return LoadedTrain(checked(model, source), source)
