"""The text of a design file with other values at some of its keys: only the characters of these values differ.

Values are replaced at their places in the text.  A new key gets a line with its group's indentation, or a place in its
group's row; a removed key takes its own lines away.  Comments, line ends and order stay.
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterable, Mapping, Sequence
from functools import lru_cache, reduce
from typing import Any

from ruamel.yaml import YAML
from ruamel.yaml.nodes import MappingNode, SequenceNode

from ncgear.design.reading.design_file import LoadedDesign
from ncgear.design.reading.places import Document, with_value
from ncgear.design.reading.text import plain_value
from ncgear.design.reading.yaml import read_yaml
from ncgear.design.words import LONGEST_DESCRIPTION, ending_in
from ncgear.frozen import dataclass

LINE_WIDTH = 118
"""Largest width of a written line; longer lines are broken."""

BREAK = re.compile(r"\r\n|\r|\n")

_REST = re.compile(r"[ \t]*(#[^\r\n]*)?(\r\n|\r|\n|\Z)")
"""The text behind a value on its line: a comment, and the end of the line."""

_BETWEEN = re.compile(r"(?:[ \t\r\n]|(?<![^ \t\r\n,])#[^\r\n]*)*")
"""The text between two values besides signs: blanks and comments."""

_STRANGE = r"\x00-\x1f\x7f-\x9f\u2028\u2029\ufeff"
"""Characters that a text does not display."""

_AS_IT_IS = re.compile(rf"[^\s{_STRANGE}\-?:,\[\]{{}}#&*!|>'\"%@`][^{_STRANGE},\[\]{{}}]*")
"""A text that needs no quotation marks, even in a row; it has no ``: `` or `` #`` in it, and no blanks around it."""


@lru_cache(maxsize=8)
def document_of(text: str) -> Document:
    """The values of a design's text, read once for several changes; raises WrongInput as reading does."""
    return read_yaml(text, "design")


def rewritten(text: str, values: Mapping[str, Any]) -> str:
    """A design file with other values at some dotted keys; None leaves a key out.

    A key that the file lacks comes after the first key of its group.  A missing group is made, and a value that is a
    group is written anew.  A number in a key is the place of an item in a list.  Raises WrongInput if the text cannot
    be read, ValueError, LookupError or TypeError if it has no such places.
    """
    data = document_of(text).data
    wanted = reduce(lambda made, key: with_value(made, key, values[key]), values, data)
    anew = {key for key, value in values.items() if isinstance(value, dict)}
    made = _Rewriting(text, anew).made(data, wanted)
    if document_of(made).data != wanted:
        raise ValueError("the text has no such place")
    return made


def design_copy(loaded: LoadedDesign, values: Mapping[str, Any]) -> str:
    """The text of a design file with other values, for another folder; its comments stay.

    Points of a CSV file are written into the text, because the path of the file is relative to the old folder.
    """
    points: dict[str, Any] = {}
    for group, table in loaded.source.from_files.items():
        points |= {f"{group}.{key}": value for key, value in table.values.items()} | {f"{group}.file": None}
    return rewritten(loaded.text, {**points, **values})


def told_copy(loaded: LoadedDesign, suffix: str, said: str, values: Mapping[str, Any]) -> str:
    """A ``design_copy`` whose name ends in the suffix and whose description begins with ``said``."""
    design = loaded.design
    description = f"{said} {design.description}".strip()[:LONGEST_DESCRIPTION]
    return design_copy(loaded, {"name": ending_in(suffix, design.name), "description": description, **values})


def flow_text(value: Any, quote: str | None = None) -> str:
    """A value as it stands in a file on one line; ``quote`` is the quotation mark that a text already has."""
    match value:
        case dict():
            return "{" + ", ".join(f"{flow_text(key)}: {flow_text(inner)}" for key, inner in value.items()) + "}"
        case list():
            return "[" + ", ".join(map(flow_text, value)) + "]"
        case str():
            return _quoted(str(value), quote)
        case float():
            # Some YAML readers take 1e-05 for a text, but never 1.0e-05.
            number = float.__repr__(value)
            return {"inf": ".inf", "-inf": "-.inf", "nan": ".nan"}.get(
                number, number if "." in number else number.replace("e", ".0e")
            )
        case _:
            return json.dumps(value)


def _quoted(text: str, quote: str | None) -> str:
    plain = _AS_IT_IS.fullmatch(text) and not re.search(r":(\s|\Z)|\s#|\s\Z", text) and text[:3] != "..."
    if plain and quote is None and isinstance(plain_value(text), str):
        return text
    if quote == "'" and text.isprintable():
        return "'" + text.replace("'", "''") + "'"
    escaped = json.dumps(text, ensure_ascii=False)
    return re.sub(rf"[{_STRANGE}]", lambda character: f"\\u{ord(character[0]):04x}", escaped)


@dataclass(frozen=True)
class _Part:
    """A key with its value, or an item, in the text: its start, the end of the sign after the key or before the item,
    and the start and end of its value."""

    start: int
    after: int
    begin: int
    end: int
    node: Any


class _Rewriting:
    """One pass over a text and its values, which collects the changes: from place to place, with the new characters."""

    def __init__(self, text: str, anew: Iterable[str]) -> None:
        self._text, self._anew = text, set(anew)
        self._edits: list[tuple[int, int, str]] = []
        found = BREAK.search(text)
        self._break = found[0] if found else "\n"

    def made(self, data: Any, wanted: Any) -> str:
        """The text with the wanted values."""
        root = YAML(typ="safe", pure=True).compose(self._text)
        if root is None:
            self._insert_lines(len(self._text), self._lines_of_group(wanted, 0))
        else:
            start = root.start_mark.index
            self._change(_Part(start, start, start, self._end(root, start), root), (), data, wanted, 0, in_flow=False)
        pieces, done = [], 0
        for start, end, new in sorted(self._edits, key=lambda edit: edit[:2]):
            pieces += [self._text[done : max(start, done)], new]
            done = max(done, end)
        return "".join([*pieces, self._text[done:]])

    def _change(self, part: _Part, path: tuple[str, ...], old: Any, new: Any, indent: int, *, in_flow: bool) -> None:
        if new == old and isinstance(new, bool) == isinstance(old, bool):
            return
        node = part.node
        if isinstance(old, dict) and isinstance(new, dict) and ".".join(path) not in self._anew and old.keys() & new:
            self._change_group(node, path, old, new)
        elif isinstance(old, list) and isinstance(new, list) and old and new:
            self._change_items(node, path, old, new)
        else:
            self._replace(part, new, indent, in_flow=in_flow)

    def _change_group(self, node: Any, path: tuple[str, ...], old: dict[str, Any], new: dict[str, Any]) -> None:
        parts = self._parts(node)
        column, flow = node.value[0][0].start_mark.column, bool(node.flow_style)
        for place, (key, value) in enumerate(old.items()):
            if key in new:
                self._change(parts[place], (*path, key), value, new[key], column, in_flow=flow)
        self._remove(parts, [place for place, key in enumerate(old) if key not in new], in_flow=flow)
        first = next(part for part, key in zip(parts, old, strict=True) if key in new)
        added = {key: value for key, value in new.items() if key not in old}
        if flow:
            self._insert_in_row(
                first, column, [f"{flow_text(key)}: {flow_text(value)}" for key, value in added.items()]
            )
        else:
            self._insert_lines(first.end, self._lines_of_group(added, column))

    def _change_items(self, node: Any, path: tuple[str, ...], old: list[Any], new: list[Any]) -> None:
        parts = self._parts(node)
        column, flow, shared = node.start_mark.column, bool(node.flow_style), min(len(old), len(new))
        same = next((step for step in range(shared) if old[step] != new[step]), shared)
        # Items after the place of a removed or added item stay unchanged.
        tail = next((step for step in range(shared - same) if old[-1 - step] != new[-1 - step]), shared - same)
        middle = shared - tail
        for place in range(same, middle):
            inner = (*path, str(place))
            self._change(parts[place], inner, old[place], new[place], column, in_flow=flow)
        self._remove(parts, list(range(middle, len(old) - tail)), in_flow=flow)
        added = new[middle : len(new) - tail]
        if not added:
            return
        if middle == 0:
            raise ValueError("no item can come before the first")
        if flow:
            self._insert_in_row(
                parts[middle - 1], parts[0].start - self._line_start(parts[0].start), map(flow_text, added)
            )
        else:
            lines = [line for text in added for line in self._lines("-", text, column)]
            self._insert_lines(parts[middle - 1].end, lines)

    def _replace(self, part: _Part, new: Any, indent: int, *, in_flow: bool) -> None:
        node, begin, end, lead = part.node, part.begin, part.end, ""
        was_block = isinstance(node, MappingNode | SequenceNode) and not node.flow_style
        if was_block:
            rest = _REST.match(self._text, end)
            end = rest.start(2) if rest else end
        between = self._text[part.after : begin]
        if (was_block and not between.strip()) or begin == end:
            begin = part.after
            lead = " " if self._text[begin - 1 : begin] in (":", "-") else "" if was_block else ": "
        written = flow_text(new, getattr(node, "style", None))
        column = begin - self._line_start(begin) + len(lead)
        too_long = not in_flow and column + len(written) > LINE_WIDTH
        if was_block and isinstance(new, dict) and new:
            lines = self._lines_of_group(new, node.start_mark.column)
            self._edits.append((part.begin, end, self._break.join(lines).lstrip(" ")))
        elif too_long and isinstance(new, dict) and new:
            self._edits.append((begin, end, ""))
            self._insert_lines(end, self._lines_of_group(new, indent + 2))
        elif too_long and isinstance(new, list):
            lines = _filled(" " * column, new, indent + 2)
            self._edits.append((begin, end, lead + self._break.join(lines).lstrip(" ")))
        else:
            self._edits.append((begin, end, lead + written))

    def _remove(self, parts: Sequence[_Part], gone: Sequence[int], *, in_flow: bool) -> None:
        """Take parts away; at least one stays."""
        last = max(set(range(len(parts))) - set(gone))
        for place in gone:
            start, end = parts[place].start, parts[place].end
            if not in_flow:
                rest = _REST.match(self._text, end)
                line, following = self._line_start(start), rest.end() if rest else end
                if not self._text[line:start].strip():
                    start, end = line, following
                else:
                    # A sign of the list around the group is before it.
                    then = parts[place + 1].start
                    end = following if self._text[following:then].strip() else then
                self._edits.append((start, end, ""))
            elif place < last:
                after = self._sign(end) + 1
                self._edits.append((start, after + _blanks(self._text[after : parts[place + 1].start]), ""))
            else:
                comma = self._sign(parts[place - 1].end)
                self._edits.append((comma, comma + 1, ""))
                between = self._text[comma + 1 : start]
                self._edits.append((start if BREAK.search(between) else start - _blanks(between[::-1]), end, ""))

    def _insert_in_row(self, part: _Part, column: int, added: Iterable[str]) -> None:
        """Put the added parts behind a part, on new lines if the line would be too long."""
        found = BREAK.search(self._text, part.end)
        used = (found.start() if found else len(self._text)) - self._line_start(part.end)
        made = ""
        for text in added:
            used += len(text) + 2
            made += f", {text}" if used <= LINE_WIDTH else f",{self._break}{' ' * column}{text}"
        self._edits.append((part.end, part.end, made))

    def _insert_lines(self, end: int, lines: Sequence[str]) -> None:
        """Put lines behind the line on which a value ends."""
        rest = _REST.match(self._text, end)
        at = rest.end() if rest else end
        made = "".join(f"{line}{self._break}" for line in lines)
        if lines and at and self._text[at - 1] not in "\r\n":
            made = self._break + made.removesuffix(self._break)
        self._edits.append((at, at, made))

    def _lines_of_group(self, group: Mapping[str, Any], indent: int) -> list[str]:
        return [line for key, value in group.items() for line in self._lines(f"{flow_text(key)}:", value, indent)]

    def _lines(self, head: str, value: Any, indent: int) -> list[str]:
        head = " " * indent + head
        on_one = f"{head} {flow_text(value)}"
        if len(on_one) <= LINE_WIDTH or not value or not isinstance(value, dict | list):
            return [on_one]
        if isinstance(value, dict):
            return [head, *self._lines_of_group(value, indent + 2)]
        return _filled(f"{head} ", value, indent + 2)

    def _parts(self, node: Any) -> list[_Part]:
        parts: list[_Part] = []
        end: int = node.start_mark.index
        for part in node.value:
            if isinstance(node, MappingNode):
                key, value = part
                start, sign = key.start_mark.index, re.compile(r"[ \t]*:").match(self._text, key.end_mark.index)
                after = sign.end() if sign else key.end_mark.index
            else:
                value = part
                start = value.start_mark.index if node.flow_style else self._sign(end)
                after = start if node.flow_style else start + 1
            end = self._end(value, after)
            begin = after if _is_empty(value) else value.start_mark.index
            parts.append(_Part(start, after, begin, end, value))
        return parts

    def _end(self, node: Any, after: int) -> int:
        """End of a value; the parser counts the text beneath a block as part of the block."""
        if isinstance(node, MappingNode | SequenceNode):
            return node.end_mark.index if node.flow_style else self._parts(node)[-1].end
        if _is_empty(node):
            return after
        start: int = node.start_mark.index
        end: int = node.end_mark.index
        return start + len(self._text[start:end].rstrip()) if node.style in ("|", ">") else end

    def _sign(self, place: int) -> int:
        """Place of the next sign, a comma or the dash of an item, after blanks and comments."""
        found = _BETWEEN.match(self._text, place)
        return found.end() if found else place

    def _line_start(self, place: int) -> int:
        return max(self._text.rfind("\n", 0, place), self._text.rfind("\r", 0, place)) + 1


def _is_empty(node: Any) -> bool:
    return node.value == "" and node.style is None and node.start_mark.index == node.end_mark.index


def _blanks(text: str) -> int:
    return len(text) - len(text.lstrip(" \t"))


def _filled(head: str, items: Sequence[Any], indent: int) -> list[str]:
    """A list in brackets, on lines that are as full as possible."""
    lines = [f"{head}["]
    for place, item in enumerate(items):
        written = flow_text(item) + ("," if place < len(items) - 1 else "]")
        gap = "" if lines[-1].endswith("[") and len(lines) == 1 and place == 0 else " "
        if len(lines[-1]) + len(gap) + len(written) > LINE_WIDTH and place:
            lines.append(" " * indent + written)
        else:
            lines[-1] += gap + written
    return lines
