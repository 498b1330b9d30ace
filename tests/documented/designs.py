"""YAML blocks: whole files, and what a reader puts into a file.

The first line of a block says which file of the page's folder it belongs to:

- ``# NAME.yaml``: a complete file of that name, a design file or a balance file;
- ``# in NAME.yaml``: sections that take the place of the file's own, or stand at its end where it has none;
- ``# part of NAME.yaml``: keys that are added to the file's, however deep they stand.
"""

from __future__ import annotations

import io
import re
from pathlib import Path
from typing import Any

from ruamel.yaml import YAML

from ncgear.design.reading.balance_file import load_balance
from ncgear.design.reading.design_file import load
from ncgear.figures.balance.parts import balancing_figures
from ncgear.project.balancing import Balancing
from ncgear.project.drive import Drive

HEAD = re.compile(r"\A# (in |part of |)([\w./-]+\.yaml)\n")

SECTION = re.compile(r"^(\w+):.*\n(?:[ \t-].*\n)*", flags=re.MULTILINE)
"""A key at the left margin and the lines that belong to it."""


def put(text: str) -> None:
    """Make the file that a block speaks of, in the current folder, and check what it now says."""
    head = HEAD.match(text)
    if head is None:
        raise AssertionError("a yaml block begins with # NAME.yaml, # in NAME.yaml or # part of NAME.yaml")
    path, rest = Path(head[2]), text[head.end() :]
    if not head[1]:
        path.write_text(text, encoding="utf-8")
        require_sound(path)
        return
    with_it = with_sections if head[1] == "in " else with_keys
    path.write_text(with_it(path.read_text(encoding="utf-8"), rest), encoding="utf-8")
    load(path)


def require_sound(path: Path) -> None:
    """Read a complete file and compute the check of a design, or the figures of a balance."""
    if re.search("^motion:", path.read_text(encoding="utf-8"), flags=re.MULTILINE):
        assert Drive(load(path).design).check is not None
    else:
        assert balancing_figures(Balancing(load_balance(path)))


def with_sections(text: str, sections: str) -> str:
    """``text`` with each section of ``sections`` in the place of its own, or at the end."""
    for section in SECTION.finditer(sections):
        own = next((one for one in SECTION.finditer(text) if one[1] == section[1]), None)
        start, end = own.span() if own else (len(text), len(text))
        text = text[:start] + section[0] + text[end:]
    return text


def with_keys(text: str, keys: str) -> str:
    """``text`` with the keys of ``keys`` laid over its own."""
    yaml, written = YAML(), io.StringIO()
    data = yaml.load(text)
    lay(yaml.load(keys), data)
    yaml.dump(data, written)
    return written.getvalue()


def lay(keys: dict[str, Any], data: dict[str, Any]) -> None:
    """Lay ``keys`` over ``data``, mapping by mapping."""
    for key, value in keys.items():
        if isinstance(value, dict) and isinstance(data.get(key), dict):
            lay(value, data[key])
        else:
            data[key] = value
