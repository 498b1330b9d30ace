"""The places of the values of a file: in the file itself, or in CSV files that it names."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import field
from pathlib import Path
from typing import Any

from ncgear.design.words import quantity, spellings
from ncgear.errors import WrongInput
from ncgear.frozen import dataclass


@dataclass(frozen=True)
class FilePlace:
    """A line and a column of a file, both counted from 1; the text is empty without a file."""

    file: str
    line: int
    column: int

    def __str__(self) -> str:
        return f"{self.file}:{self.line}:{self.column}" if self.file else ""


@dataclass(frozen=True)
class Document:
    """Plain values of a YAML file, with the place of every key and list item by its dotted path.

    ``written_as`` has the keys of a machine by those that the file has for them, where a train is read as a machine;
    ``alone`` are those of the machine's keys that the train has by the same names, and that change nothing else;
    ``own`` are then the values of the file itself.
    """

    data: Any
    places: Mapping[str, FilePlace]
    written_as: Mapping[str, str] = field(default_factory=dict)
    alone: frozenset[str] = frozenset()
    own: Any = None

    def place(self, key: str) -> FilePlace:
        """The place of ``key``, or of its nearest parent in the file."""
        while key and key not in self.places:
            key = key.rpartition(".")[0]
        return self.places[key]

    def as_written(self, key: str) -> str:
        """The key that the file may have for ``key``, or else for its nearest parent; ``train`` where it has none."""
        if not self.written_as or key in ("", "name", "description") or key.partition(".")[0] == "train":
            return key
        while key and key not in self.written_as:
            key = key.rpartition(".")[0]
        return self.written_as[key] if key else "train"

    def at(self, key: str) -> Any:
        """The value at a dotted key; None if there is none."""
        data = self.data
        for part in key.split("."):
            if isinstance(data, list) and part.isdigit():
                data = data[int(part)] if int(part) < len(data) else None
            else:
                data = data.get(part) if isinstance(data, dict) else None
        return data


@dataclass(frozen=True)
class FromFile:
    """The values of a file that a group names, by the keys that they replace.

    ``place`` is the place in that file of a dotted key below the group; None if the file has no place for it.
    """

    values: Mapping[str, Any]
    place: Callable[[str], FilePlace | None] = lambda _: None


@dataclass(frozen=True)
class Source:
    """A design or balance file with the places of its values; ``from_files`` holds the CSV files, by their groups."""

    document: Document
    from_files: Mapping[str, FromFile]

    @property
    def data(self) -> dict[str, Any]:
        """The plain values of the file with those of its CSV files; not to be changed."""
        data: dict[str, Any] = self.document.data
        for group, found in self.from_files.items():
            data = with_value(data, group, {**self.document.at(group), **found.values})
        return data

    def place(self, key: str) -> FilePlace:
        """The place of ``key`` (dotted), or of its nearest parent in the file."""
        for group, found in self.from_files.items():
            inner = key.removeprefix(f"{group}.")
            if inner != key and inner.partition(".")[0] in found.values:
                return found.place(inner) or self.document.place(f"{group}.file")
        return self.document.place(self.as_written(key))

    def as_written(self, key: str) -> str:
        """``key`` in the spelling of the file: the key of an angle ends in the unit in which it was given."""
        if key not in self.document.places:
            key = next((name for name in spellings(quantity(key)) if name in self.document.places), key)
        return self.document.as_written(key)


def with_value(data: Any, key: str, value: Any) -> Any:
    """A copy of plain values with another value at a dotted key; the rest is shared.

    None leaves the key out, a group that is missing is made, and a number in a key is the place of an item in a list.
    Raises ValueError, LookupError or TypeError if there is no such place.
    """
    first, _, rest = key.partition(".")
    if isinstance(data, list | tuple):
        place = int(first)
        if place < 0:
            raise LookupError(first)
        items = [with_value(data[place], rest, value)] if rest else [value][: value is not None]
        return [*data[:place], *items, *data[place + 1 :]]
    group = {} if data is None else data
    if not rest and value is None:
        return {name: value for name, value in group.items() if name != first}
    return {**group, first: with_value(group.get(first), rest, value) if rest else value}


@contextmanager
def named_by(document: Document, key: str, file: Path) -> Iterator[None]:
    """A context for reading ``file``, which ``key`` of the document names.

    A fault in that file keeps its place there; a file that cannot be read is a fault of the key.
    """
    try:
        yield
    except WrongInput as error:
        if error.location != str(file):
            raise
        raise WrongInput(f"{file} {error.problem}", key=key, location=str(document.place(key))) from error
