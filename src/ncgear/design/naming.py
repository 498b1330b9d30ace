"""The name of a design, which also names its files: no separators, no dots, so no way out of the output folder."""

from __future__ import annotations

import re

NAME_PATTERN = r"^[A-Za-z0-9_-]{1,64}$"
NAME_RULE = "letters, digits, - and _, at most 64 of them"


def is_name(text: str) -> bool:
    """Whether ``text`` can name a design."""
    # fullmatch, because Python's $ also matches before a final line break.
    return re.fullmatch(NAME_PATTERN.strip("^$"), text) is not None
