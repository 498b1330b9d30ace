"""From YAML to plain values and their places.

The reader follows the events of the parser directly.  So it refuses anchors, aliases, tags, repeated keys and deep
nesting where they begin, before it builds values from them, and the meaning of a value does not depend on a loader.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import Any

from ruamel.yaml import YAML
from ruamel.yaml.error import MarkedYAMLError, YAMLError
from ruamel.yaml.events import (
    AliasEvent,
    MappingEndEvent,
    MappingStartEvent,
    ScalarEvent,
    SequenceEndEvent,
    SequenceStartEvent,
)
from ruamel.yaml.reader import ReaderError

from ncgear.design.reading.places import Document, FilePlace
from ncgear.design.reading.text import beyond_numbers, plain_value, quoted, shortened
from ncgear.errors import WrongInput

LONGEST_FAULT = 200
"""Most characters of a parser's message, which may quote megabytes of the file."""

DEEPEST = 12
"""Levels of nesting; a design file needs four, a balance file five."""

MOST_KEYS = 200
"""Keys in one group; a law needs two dozen.  The comparison of every unknown key with the known keys takes time."""

MOST_VALUES = 100_000
"""Values in one file, with lists and groups: a few seconds of reading; a CSV file holds longer tables."""

LONG_TAG = re.compile(r"!\S{200}")
"""A long tag, refused before the parser sees it: the parser's time grows with the square of the tag's length."""

CONTROL_CHARACTER = re.compile(r"[\x00-\x08\x0b\x0c\x0e-\x1f\x7f-\x84\x86-\x9f]")
"""Control characters, which YAML allows as escapes; terminals obey them, and HTML and XML do not allow all of them."""

LONGEST_KEY = 100
"""Characters of a key; the longest known one has 24."""


def read_yaml(text: str, file: str) -> Document:
    """Parse one YAML document; WrongInput names the place of a fault."""
    if long_tag := LONG_TAG.search(text):
        location = _place_of_offset(text, long_tag.start(), file)
        raise WrongInput(f"{shortened(long_tag.group())} is a tag; write the value without it", location=location)
    try:
        return _Reader(text, file).document()
    except ReaderError as error:
        raise WrongInput(
            _cannot_stand(chr(error.character)), location=_place_of_offset(text, error.position, file)
        ) from error
    except MarkedYAMLError as error:
        # The parser finds an unclosed text at the end of the file; the fault is where the text begins.
        of_text = str(error.context).startswith(("while scanning a simple key", "while scanning a quoted"))
        mark = (error.context_mark if of_text else error.problem_mark) or error.context_mark
        place = FilePlace(file, mark.line + 1, mark.column + 1) if mark else FilePlace(file, 1, 1)
        raise WrongInput(_syntax(error, text.splitlines()[: place.line]), location=str(place)) from error
    except YAMLError as error:
        raise WrongInput(f"is not YAML: {error}", location=f"{file}:1:1") from error


class _Reader:
    """One pass over the events of one file."""

    def __init__(self, text: str, file: str) -> None:
        self._file = file
        self._places: dict[str, FilePlace] = {}
        self._count = 0
        self._events = _events(text, file)

    def document(self) -> Document:
        """The only document of the stream; an empty file gives None."""
        self._places[""] = FilePlace(self._file, 1, 1)
        data, begun = None, False
        for event in self._events:
            if isinstance(event, ScalarEvent | SequenceStartEvent | MappingStartEvent | AliasEvent):
                if begun:
                    raise self._wrong(event, "", "a second document begins; one in each file is right")
                self._places[""] = self._place(event)
                data, begun = self._value(event, ()), True
        return Document(data, self._places)

    def _value(self, event: Any, path: tuple[str, ...]) -> Any:
        self._count += 1
        if self._count > MOST_VALUES:
            problem = (
                f"over {MOST_VALUES} values in one file; fewer are right: long columns go to a CSV file beside this, "
                "and `file: NAME.csv` stands in their place"
            )
            raise self._wrong(event, ".".join(path), problem)
        self._refuse_indirect(event, path)
        if isinstance(event, ScalarEvent):
            text = self._text(event, path)
            if event.implicit[0] and beyond_numbers(text):
                problem = f"{shortened(text)} given; a finite number is needed, of 1e-308 to 1e308 apart from its sign"
                raise WrongInput(problem, key=".".join(path), location=str(self._places[".".join(path)]))
            return plain_value(text) if event.implicit[0] else text
        if len(path) >= DEEPEST:
            raise self._wrong(event, "", f"nested over {DEEPEST} levels deep; no key of ncgear needs over five")
        return self._mapping(path) if isinstance(event, MappingStartEvent) else self._sequence(path)

    def _refuse_indirect(self, event: Any, path: tuple[str, ...]) -> None:
        key = ".".join(path)
        if event.anchor is not None:
            sign = "*" if isinstance(event, AliasEvent) else "&"
            name = shortened(f"{sign}{event.anchor}")
            raise self._wrong(event, key, f"{name} is an anchor or alias; write the value itself")
        tag = event.ctag
        if tag is not None:
            written = shortened(f"{tag.handle or ''}{tag.suffix or ''}")
            raise self._wrong(event, key, f"{written} is a tag; write the value without it")

    def _mapping(self, path: tuple[str, ...]) -> dict[str, Any]:
        values: dict[str, Any] = {}
        while not isinstance(event := next(self._events), MappingEndEvent):
            key = self._key(event, path)
            inner = (*path, key)
            if key in values:
                first = self._places[".".join(inner)].line
                raise self._wrong(event, ".".join(inner), f"given twice, first in line {first}; keep one")
            if len(values) == MOST_KEYS:
                raise self._wrong(event, ".".join(path), f"over {MOST_KEYS} keys in one group; no group has two dozen")
            self._places[".".join(inner)] = self._place(event)
            values[key] = self._value(next(self._events), inner)
        return values

    def _key(self, event: Any, path: tuple[str, ...]) -> str:
        self._refuse_indirect(event, path)
        if not isinstance(event, ScalarEvent):
            raise self._wrong(event, ".".join(path), "a list or a group stands as a key; a key is a word")
        text = self._text(event, path)
        if not text:
            raise self._wrong(event, ".".join(path), "the key before a colon is empty; a word is right")
        if event.implicit[0] and ":" in text:
            problem = f"no space follows the colon in {quoted(text)}; `key: value` is right"
            raise self._wrong(event, ".".join(path), problem)
        if len(text) > LONGEST_KEY:
            raise self._wrong(event, ".".join(path), f"a key of {len(text)} characters; none has over {LONGEST_KEY}")
        return text

    def _text(self, event: Any, path: tuple[str, ...]) -> str:
        text = str(event.value)
        # An escape such as "\ud800" is half a character, which can be neither written nor displayed.
        if any("\ud800" <= character <= "\udfff" for character in text):
            raise self._wrong(event, ".".join(path), r"a \u escape is half a character; write the character itself")
        if control := CONTROL_CHARACTER.search(text):
            raise self._wrong(event, ".".join(path), _cannot_stand(control.group()))
        return text

    def _sequence(self, path: tuple[str, ...]) -> list[Any]:
        values: list[Any] = []
        while not isinstance(event := next(self._events), SequenceEndEvent):
            inner = (*path, str(len(values)))
            self._places[".".join(inner)] = self._place(event)
            values.append(self._value(event, inner))
        return values

    def _place(self, event: Any) -> FilePlace:
        return FilePlace(self._file, event.start_mark.line + 1, event.start_mark.column + 1)

    def _wrong(self, event: Any, key: str, problem: str) -> WrongInput:
        return WrongInput(problem, key=key, location=str(self._place(event)))


def _events(text: str, file: str) -> Iterator[Any]:
    """The events of the parser; every machine uses the pure Python parser, because the C parser has other messages.

    The parser turns escapes (``"\\UFFFFFFFF"``) and the version after %YAML into numbers without checking their size.
    Such a fault gets the place where the readable text ends.
    """
    place = FilePlace(file, 1, 1)
    try:
        for event in YAML(typ="safe", pure=True).parse(text):
            place = FilePlace(file, event.end_mark.line + 1, event.end_mark.column + 1)
            yield event
    except (ValueError, OverflowError) as error:
        problem = "is not YAML: a number after \\U or %YAML is too large; write the character itself, and no version"
        raise WrongInput(problem, location=str(place)) from error


WORDS_OF_FAULTS = {
    "mapping values are not allowed": "a colon stands where no key can be; a space follows each colon, a text with a "
    "colon stands in quotes, and the keys of a group begin in the same column",
    "character '\\t'": "a tab stands before a key; spaces are right",
    "cannot start any token": "a value begins with a sign of YAML; in quotes it is a text",
    "could not find expected ':'": "a line is no `key: value`; a colon and a space are right",
    "unexpected end of stream": "a quotation mark or bracket is open at the end of the file; close it",
    "expected '<document start>'": "a line that is no `key: value` stands before it",
    "expected ',' or": "a bracket is not closed, or a comma is missing before this place",
    "expected <block end>": "the line does not begin in the column of its group, or a quotation mark above it is "
    "open; all keys of a group begin in the same column",
}
"""The meaning of the parser's faults for the writer of the file, by a part of the parser's words."""


def _syntax(error: MarkedYAMLError, lines: list[str]) -> str:
    said = shortened(str(error.problem), LONGEST_FAULT)
    meaning = next((words for part, words in WORDS_OF_FAULTS.items() if part in said), f"{said}; `key: value` is right")
    line = next((line.strip() for line in reversed(lines) if line.strip()), "")
    return f"is not YAML: {meaning}; the line is {quoted(line)}"


def _cannot_stand(character: str) -> str:
    return f"character {quoted(character)} cannot stand in a text; remove it"


def _place_of_offset(text: str, offset: int, file: str) -> str:
    before = text[:offset]
    return f"{file}:{before.count(chr(10)) + 1}:{offset - before.rfind(chr(10))}"
