"""The name of a design, which also names its files; it has no separators and no dots, so it stays in its folder."""

from __future__ import annotations

import re

LONGEST_NAME = 64
NAME_PATTERN = rf"^[A-Za-z0-9_-]{{1,{LONGEST_NAME}}}$"
NAME_RULE = f"letters, digits, - and _, at most {LONGEST_NAME} of them"


def is_name(text: str) -> bool:
    """Whether ``text`` can name a design."""
    # fullmatch, because Python's $ also matches before a final line break.
    return re.fullmatch(NAME_PATTERN.strip("^$"), text) is not None
