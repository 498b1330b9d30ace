"""The text of a design file with other values at some of its keys; its comments stay."""

from __future__ import annotations

from collections.abc import Mapping
from io import StringIO
from typing import Any

from ruamel.yaml import YAML
from ruamel.yaml.comments import CommentedMap, CommentedSeq

from ncgear.design.reading.design_file import LoadedDesign

LINE_WIDTH = 118
"""Width of the lines of files that hold many numbers."""

LONGEST_LINE = 10_000
"""Length over that of any line of a design file that people write, so that no line is broken."""


def rewritten(text: str, values: Mapping[str, Any], width: int = LONGEST_LINE) -> str:
    """A design file with other values at some dotted keys; None leaves a key out.  Lines are broken at ``width``.

    A key that the file does not have comes after the first one of its group.  A group that is missing is made.  A
    number in a key is the place of an item in a list.
    """
    yaml = YAML()
    yaml.width, yaml.preserve_quotes = width, True
    # Reading the text refuses anchors, in words.
    yaml.composer.warn_double_anchors = False
    data = yaml.load(text)
    for key, value in values.items():
        *above, name = key.split(".")
        group = data
        for one in above:
            if isinstance(group, list):
                group = group[int(one)]
                continue
            if group.get(one) is None:
                _put(group, one, CommentedMap())
            group = group[one]
        if isinstance(group, list):
            group[int(name) : int(name) + 1] = [] if value is None else [_flow(value)]
        elif value is None:
            group.pop(name, None)
        elif isinstance(value, list) and isinstance(group.get(name), list):
            # Only the items are replaced, so that the list keeps the style in which it is written.
            group[name][:] = [_flow(item) for item in value]
        else:
            _put(group, name, _flow(value))
    made = StringIO()
    yaml.dump(data, made)
    return made.getvalue()


def flow_text(value: Any) -> str:
    """A list or a group as it stands in a file on one line."""
    yaml, made = YAML(), StringIO()
    yaml.width = LONGEST_LINE
    yaml.dump(_flow(value), made)
    return made.getvalue().strip()


def design_copy(loaded: LoadedDesign, values: Mapping[str, Any]) -> str:
    """The text of a design file with other values, for another folder; its comments stay.

    Points that are in a CSV file are written into the text, because the path of that file is relative to the folder of
    the old design.
    """
    points: dict[str, Any] = {}
    for group, table in loaded.source.from_files.items():
        points |= {f"{group}.{key}": value for key, value in table.values.items()} | {f"{group}.file": None}
    return rewritten(loaded.text, {**points, **values}, LINE_WIDTH)


def _put(group: CommentedMap, name: str, value: Any) -> None:
    if name in group:
        group[name] = value
    else:
        group.insert(min(1, len(group)), name, value)


def _flow(value: Any) -> Any:
    """The value as it stands in a file: lists and groups on one line."""
    if not isinstance(value, list | dict):
        return value
    if isinstance(value, list):
        made: CommentedSeq | CommentedMap = CommentedSeq([_flow(item) for item in value])
    else:
        made = CommentedMap({key: _flow(inner) for key, inner in value.items()})
    made.fa.set_flow_style()
    return made
