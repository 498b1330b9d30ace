"""The schemas of ncgear in the settings of a folder that is opened in VS Code, for its extension YAML (Red Hat).

Settings are JSON with comments and trailing commas; a change loses no other character.  Comments and trailing commas
become blanks of the same length.  The result is JSON in which every value stands at its old place, and a change is a
replacement of characters in the text as it was.
"""

from __future__ import annotations

import json
import os
import re
from collections.abc import Iterator
from itertools import islice
from json.decoder import JSONDecoder
from pathlib import Path
from typing import Any

from ncgear.design.keys.balance import Balance
from ncgear.design.keys.base import Model
from ncgear.design.keys.design import Design, json_schema
from ncgear.design.trains.registry import TrainFile
from ncgear.errors import WrongInput
from ncgear.frozen import dataclass

# --- JSON with comments ----------------------------------------------------------------------------------------------

TOKEN = re.compile(
    r'"(?:[^"\\\n]|\\.)*"|//[^\n\r]*|/\*.*?\*/|,(?=(?>(?:\s|//[^\n\r]*|/\*.*?\*/)*)[\]}])', flags=re.DOTALL
)
"""A string, a comment, or a comma before the end of an object or a list."""

BLANK = re.compile(r"\ufeff?\s*")

INDENT = "    "
"""Indentation of VS Code where the settings name no other."""

Span = tuple[int, int]
"""The place of a value in a text: its start and its end."""


class NotEditable(ValueError):
    """The text is no object of JSON with comments, or has a key twice; the message names the fault."""


def plain(text: str) -> str:
    """The text as JSON of the same length: comments and trailing commas are blank."""
    return TOKEN.sub(lambda found: found[0] if found[0][0] == '"' else re.sub(r"[^\r\n]", " ", found[0]), text)


def parsed(text: str) -> dict[str, Any]:
    """The object of a text; raises NotEditable."""
    bare = plain(text)
    members, end = _members(bare, _skipped(bare, 0))
    if bare[end:].strip():
        raise NotEditable("something stands behind its end")
    return {key: json.loads(bare[start:end]) for key, (start, end) in members.items()}


def with_member(text: str, path: tuple[str, ...], value: Any) -> str:
    """The text with a value at a path of keys, every other character as it was; objects on the way are made.

    An empty text counts as an empty object.  Raises NotEditable where the text, or a value on the way, is no object.
    """
    text = text if plain(text).strip() else f"{text}{{\n}}\n"
    bare, start = plain(text), 0
    for depth, key in enumerate(path, 1):
        start = _skipped(bare, start)
        members, end = _members(bare, start)
        if key not in members:
            for further in reversed(path[depth:]):
                value = {further: value}
            return _inserted(text, bare[start + 1 : end - 1], start + 1, key, value, depth)
        start, end = members[key]
    if json.loads(bare[start:end]) == value:
        return text
    return text[:start] + _text(value, len(path), text) + text[end:]


def _inserted(text: str, inside: str, start: int, key: str, value: Any, depth: int) -> str:
    """The text with one more member at ``start``, before the text ``inside`` the object."""
    line, rest = _line_break(text), text[start:]
    comma = "," if inside.strip() else ""
    # Text behind the bracket goes to a line of its own.
    if "\n" not in rest[: _skipped(rest, 0)]:
        rest = f"{line}{INDENT * (depth if comma else depth - 1)}{rest.lstrip(' ')}"
    return f"{text[:start]}{line}{INDENT * depth}{json.dumps(key)}: {_text(value, depth, text)}{comma}{rest}"


def _text(value: Any, depth: int, text: str) -> str:
    """A value as JSON at a depth, with the line breaks of the text around it."""
    written = json.dumps(value, indent=len(INDENT), ensure_ascii=False)
    return written.replace("\n", f"{_line_break(text)}{INDENT * depth}")


def _line_break(text: str) -> str:
    return "\r\n" if "\r\n" in text else "\n"


def _skipped(bare: str, place: int) -> int:
    """The next place that is not blank."""
    found = BLANK.match(bare, place)
    assert found is not None
    return found.end()


def _members(bare: str, start: int) -> tuple[dict[str, Span], int]:
    """The places of the values of an object's members by their keys, and the end of the object; raises NotEditable."""
    if bare[start : start + 1] != "{":
        raise NotEditable("it is no object in curly brackets")
    found: dict[str, Span] = {}
    decode, place = JSONDecoder().raw_decode, _skipped(bare, start + 1)
    sign = "}" if bare[place : place + 1] == "}" else ","
    try:
        while sign != "}":
            key, place = decode(bare, place)
            colon = _skipped(bare, place)
            if not isinstance(key, str) or bare[colon] != ":":
                raise NotEditable(f"a key is expected before character {colon}")
            if key in found:
                raise NotEditable(f"the key {key!r} is there twice")
            begin = _skipped(bare, colon + 1)
            _, end = decode(bare, begin)
            found[key], place = (begin, end), _skipped(bare, end)
            sign = bare[place]
            if sign not in ",}":
                raise NotEditable(f"a comma is expected at character {place}")
            place = _skipped(bare, place + 1) if sign == "," else place
    except NotEditable:
        raise
    except (ValueError, IndexError) as error:
        raise NotEditable(str(error)) from error
    return found, place + 1


# --- settings --------------------------------------------------------------------------------------------------------

SETTINGS_FOLDER, SETTINGS_FILE = ".vscode", "settings.json"

SETTING = "yaml.schemas"
"""The setting in which the extension looks for schemas; it gives each schema its files."""

OF_BALANCE = "|".join(name for name in Balance.model_fields if name not in Design.model_fields)

SCHEMAS: dict[str, tuple[type[Model], re.Pattern[str]]] = {
    name: (model, re.compile(rf"^(?:{keys})\s*:", flags=re.MULTILINE))
    for name, model, keys in (
        ("ncgear.schema.json", Design, "motion"),
        ("ncgear-balance.schema.json", Balance, OF_BALANCE),
        ("ncgear-train.schema.json", TrainFile, "train"),
    )
}
"""The files of the schemas, beside the settings, each with its model and with the keys at the left margin by which the
text of such a file is recognized."""

MOST_FILES, LONGEST_BYTES = 5000, 1_000_000
"""Most YAML files that are read, and the largest size of each in bytes."""

LEFT_OUT = ("node_modules", "__pycache__", "site-packages")
"""Folders that are not searched; folders whose names begin with a dot are not searched either."""

ANY = "*.yaml"
"""The pattern for a folder that has no design file yet."""


@dataclass(frozen=True)
class EditorFiles:
    """The files to be written into the settings folder by their names, and the patterns that each schema is for."""

    files: dict[str, bytes]
    patterns: dict[str, list[str]]


def editor_files(folder: Path) -> EditorFiles:
    """The files that must be written into ``.vscode`` of a folder; files that are right already are left out.

    Existing settings and comments stay.  Raises WrongInput, with the lines to paste, where the settings are a link or
    cannot be read as JSON with comments.
    """
    place = folder / SETTINGS_FOLDER
    patterns = _patterns(folder) or {"ncgear.schema.json": [ANY]}
    files = {name: f"{json.dumps(json_schema(SCHEMAS[name][0]), indent=2)}\n".encode() for name in patterns}
    files[SETTINGS_FILE] = _settings(place / SETTINGS_FILE, patterns)
    return EditorFiles({name: new for name, new in files.items() if _bytes(place / name) != new}, patterns)


def _bytes(path: Path) -> bytes | None:
    """The content of a file; None where there is none.  Raises WrongInput where it cannot be read."""
    try:
        return path.read_bytes()
    except (FileNotFoundError, NotADirectoryError):
        return None
    except OSError as error:
        raise WrongInput(f"cannot be read ({error.strerror or error})", location=str(path)) from error


def _settings(path: Path, patterns: dict[str, list[str]]) -> bytes:
    """The settings with all schemas; files that a person has added to a schema's stay."""
    wanted = {f"./{SETTINGS_FOLDER}/{name}": globs for name, globs in patterns.items()}
    try:
        if path.is_symlink():
            raise NotEditable("it is a link to another file")
        text = (_bytes(path) or b"").decode()
        given = parsed(text).get(SETTING, {}) if text.strip() else {}
        if not isinstance(given, dict):
            raise NotEditable(f"{SETTING} is no object in curly brackets")
        for key, globs in wanted.items():
            there = given.get(key, [])
            kept = [there] if isinstance(there, str) else list(there)
            value = [*kept, *(glob for glob in globs if glob not in kept)]
            if value != there:
                text = with_member(text, (SETTING, key), value)
        found = parsed(text)[SETTING]
        if any(glob not in found[key] for key, globs in wanted.items() for glob in globs):
            raise NotEditable("it reads otherwise than it is written")
    except (NotEditable, UnicodeDecodeError, TypeError) as error:
        paste = json.dumps({SETTING: wanted}, indent=4).strip("{}\n")
        problem = f"cannot be changed safely: {error}; put these lines into it by hand:\n{paste}"
        raise WrongInput(problem, location=str(path)) from error
    return text.encode()


def _patterns(folder: Path) -> dict[str, list[str]]:
    """Patterns of the files below a folder, by their paths from it, for each of SCHEMAS that any of them has.

    The pattern is ``NAME/*.yaml`` where all YAML files in and below a folder are of one kind; otherwise each file has
    its own.  In the extension's patterns a star also matches folders, and two schemas of one file would contradict.
    """
    kinds = {path.relative_to(folder): _kind(path) for path in islice(_yaml_files(folder), MOST_FILES)}
    found: dict[str | None, dict[str, None]] = {name: {} for name in (*SCHEMAS, None)}
    for path, kind in kinds.items():
        places = reversed(path.parents)
        alone = (place for place in places if {kinds[kind] for kind in kinds if kind.is_relative_to(place)} == {kind})
        place = next(alone, None)
        found[kind][path.as_posix() if place is None else (place / ANY).as_posix()] = None
    return {name: list(found[name]) for name in SCHEMAS if found[name]}


def _yaml_files(folder: Path) -> Iterator[Path]:
    for place, folders, names in os.walk(folder):
        folders[:] = sorted(name for name in folders if not name.startswith(".") and name not in LEFT_OUT)
        yield from (Path(place) / name for name in sorted(names) if name.endswith(".yaml"))


def _kind(path: Path) -> str | None:
    """The schema of a file; None of other files."""
    try:
        if path.stat().st_size > LONGEST_BYTES:
            return None
        text = path.read_text(encoding="utf-8", errors="replace")
    except OSError:
        return None
    return next((name for name, (_, key) in SCHEMAS.items() if key.search(text)), None)
