"""The pages of every key of a design file and of a balance file, read from the models that check them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import groupby
from typing import Any

from ncgear.design.keys.balance import Balance
from ncgear.design.keys.design import Design
from ncgear.design.reference import Key, allowed, default_words, keys_of, unit_of
from ncgear.figures.tables import markdown

MADE = "<!-- Made by `make docs` from the models that check such files. -->"

DESIGN_INTRODUCTION = f"""\
# The design file

{MADE}

Every key of a design file. Files are YAML: `ncgear new NAME` writes one with comments, [the tutorial](tutorial.md)
fills one in, `ncgear explain KEY` tells about one key, `ncgear schema` prints the JSON Schema for editors. A key that
is not here is refused, and the message names the nearest that is. A key's end is its unit; an angle can be given in
degrees (`_deg`), radians (`_rad`) or multiples of pi (`_pi`), by one of these keys.
"""

BALANCE_INTRODUCTION = f"""\
# The balance file

{MADE}

Every key of a balance file, which [`ncgear balance`](commands/balance.md) reads. A key's end is its unit. Worked
files are in [`designs/balance`](../designs/balance).
"""

PAGES: dict[str, tuple[str, type[Any]]] = {
    "design-file.md": (DESIGN_INTRODUCTION, Design),
    "balance-file.md": (BALANCE_INTRODUCTION, Balance),
}
"""Introduction and model of each page."""

HEADS = ("key", "unit", "meaning", "value", "left out")

SPECIAL = str.maketrans({"|": "&#124;", "*": "\\*", "<": "&lt;"})
"""What would be more than a letter in a table of Markdown."""


def key_page(name: str) -> str:
    """One whole page."""
    introduction, root = PAGES[name]
    return "\n".join([introduction, *_section(keys_of(root), "", "", "Top of the file", 2)]).rstrip() + "\n"


def _section(keys: Sequence[Key], above: str, law: str, title: str, level: int) -> Iterator[str]:
    """The table of a group's own keys, then the groups in it."""
    own = [key for key in _inside(keys, above) if key.law == law]
    yield from (f"{'#' * min(level, 4)} {title}", "", *markdown(HEADS, map(_row, own)), "")
    for group in (key for key in own if key.group):
        yield from _groups(keys, group, level + bool(above))


def _groups(keys: Sequence[Key], group: Key, level: int) -> Iterator[str]:
    """A group's section; of the motion one for each law."""
    inside = [key for key in _inside(keys, group.path) if not group.law or key.law == group.law]
    for law, _ in groupby(inside, lambda key: key.law):
        title = f"`{group.path}`" + (f", law `{law}`" if law else "")
        yield from _section(keys, group.path, law, title, level)


def _inside(keys: Sequence[Key], above: str) -> list[Key]:
    return [key for key in keys if key.path.rpartition(".")[0] == above]


def _row(key: Key) -> list[str]:
    left_out = default_words(key).removeprefix("none: it ").removeprefix("may be left out; ")
    cells = key.meaning, allowed(key), "-" if left_out == "may be left out" else left_out
    return [f"`{key.name}`", unit_of(key.name), *(cell.translate(SPECIAL) for cell in cells)]
