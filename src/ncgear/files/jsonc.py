"""JSON with comments and trailing commas, as VS Code writes its settings: read, and changed without losing a character.

Comments and trailing commas become blanks of the same length.  So what is left is JSON whose every value stands where
it stood, and a change is a replacement of characters in the text as it was.
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from json.decoder import JSONDecoder
from typing import Any, NamedTuple

TOKEN = re.compile(r'"(?:[^"\\\n]|\\.)*"|//[^\n\r]*|/\*.*?\*/|[,\]}]|\s+|.', flags=re.DOTALL)
"""A string, a comment, a sign that may end something, white space, or any other character."""

BLANK = re.compile(r"\s*")

INDENT = "    "
"""What VS Code indents by where nothing else is set."""


class NotEditable(ValueError):
    """The text is not an object of JSON with comments, or has a key more than once; says what is wrong."""


def plain(text: str) -> str:
    """The text as JSON of the same length: comments and trailing commas are blank."""
    out: list[str] = []
    comma: int | None = None
    for found in TOKEN.finditer(text):
        token = found[0]
        if token.startswith(("//", "/*")) and len(token) > 1:
            out.append(re.sub(r"[^\r\n]", " ", token))
        elif token.isspace():
            out.append(token)
        else:
            if token in "]}" and comma is not None:
                out[comma] = " "
            comma = len(out) if token == "," else None
            out.append(token)
    return "".join(out)


def parsed(text: str) -> dict[str, Any]:
    """The object of a text; raises NotEditable."""
    found, _ = _object(plain(text), 0)
    return found


def with_member(text: str, path: tuple[str, ...], value: Any) -> str:
    """The text with a value at a path of keys, every other character as it was; objects on the way are made.

    A text without anything is taken for an empty object.  Raises NotEditable where the text is no object, or something
    on the way is none.
    """
    source = text if plain(text).strip() else f"{text}{{\n}}\n"
    bare = plain(source)
    start = _skipped(bare, 0)
    left = path
    while True:
        members, end = _members(bare, start)
        if left[0] not in members:
            new = value
            for key in reversed(left[1:]):
                new = {key: new}
            return _inserted(source, start, end, left[0], new, depth=len(path) - len(left) + 1)
        span = members[left[0]]
        left = left[1:]
        if not left:
            if json.loads(bare[span.start : span.end]) == value:
                return source
            return source[: span.start] + _text(value, len(path), source) + source[span.end :]
        start = span.start


class Span(NamedTuple):
    """Where a value stands in a text."""

    start: int
    end: int


def _inserted(text: str, start: int, end: int, key: str, value: Any, depth: int) -> str:
    """The text with one more member at the beginning of the object from ``start`` to ``end``."""
    line = _line_break(text)
    comma = "," if plain(text)[start + 1 : end - 1].strip() else ""
    member = f"{line}{INDENT * depth}{json.dumps(key)}: {_text(value, depth, text)}{comma}"
    rest = text[start + 1 :]
    # What stood behind the bracket goes to a line of its own.
    alone = BLANK.match(rest)
    assert alone is not None
    if "\n" not in alone[0]:
        rest = f"{line}{INDENT * (depth if comma else depth - 1)}{rest.lstrip(' ')}"
    return f"{text[: start + 1]}{member}{rest}"


def _text(value: Any, depth: int, text: str) -> str:
    """A value as JSON at a depth, with the line breaks of the text around it."""
    written = json.dumps(value, indent=len(INDENT), ensure_ascii=False)
    return written.replace("\n", f"{_line_break(text)}{INDENT * depth}")


def _line_break(text: str) -> str:
    return "\r\n" if "\r\n" in text else "\n"


def _skipped(bare: str, place: int) -> int:
    found = BLANK.match(bare, place + 1 if bare[place : place + 1] == "\ufeff" else place)
    assert found is not None
    return found.end()


def _object(bare: str, place: int) -> tuple[dict[str, Any], int]:
    start = _skipped(bare, place)
    members, end = _members(bare, start)
    if bare[end:].strip():
        raise NotEditable("something stands behind its end")
    return {key: json.loads(bare[span.start : span.end]) for key, span in members.items()}, end


def _members(bare: str, start: int) -> tuple[dict[str, Span], int]:
    """Where the values of an object's members stand, by their keys, and where the object ends."""
    if bare[start : start + 1] != "{":
        raise NotEditable("it is no object in curly brackets")
    found: dict[str, Span] = {}
    try:
        for key, span in _read_members(bare, start):
            if key in found:
                raise NotEditable(f"the key {key!r} is there twice")
            found[key] = span
            end = span.end
        last = _skipped(bare, end) if found else _skipped(bare, start + 1)
    except (ValueError, IndexError) as error:
        raise error if isinstance(error, NotEditable) else NotEditable(str(error)) from error
    return found, last + 1


def _read_members(bare: str, start: int) -> Iterator[tuple[str, Span]]:
    decoder = JSONDecoder()
    place = _skipped(bare, start + 1)
    while bare[place] != "}":
        key, place = decoder.raw_decode(bare, place)
        place = _skipped(bare, place)
        if not isinstance(key, str) or bare[place] != ":":
            raise NotEditable(f"a key is expected before character {place}")
        begin = _skipped(bare, place + 1)
        _, place = decoder.raw_decode(bare, begin)
        yield key, Span(begin, place)
        place = _skipped(bare, place)
        if bare[place] not in ",}":
            raise NotEditable(f"a comma is expected at character {place}")
        if bare[place] == ",":
            place = _skipped(bare, place + 1)
            if bare[place] == "}":
                raise NotEditable(f"a key is expected at character {place}")
