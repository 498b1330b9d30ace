"""Names in words: of designs, of angles, which may be given in several units, and lists of names.

It loads no library, so that a key can be explained at once.
"""

from __future__ import annotations

import re
from collections.abc import Iterable

UNITS = ("rad", "deg", "pi")


def spellings(quantity: str) -> tuple[str, ...]:
    """The keys that can hold ``quantity``: theta1 -> theta1_rad, theta1_deg, theta1_pi."""
    return tuple(f"{quantity}_{unit}" for unit in UNITS)


def quantity(name: str) -> str:
    """A key without the unit of an angle at its end: theta1_deg -> theta1, but bore_mm -> bore_mm."""
    stem, _, unit = name.rpartition("_")
    return stem if unit in UNITS else name


def folded(names: Iterable[str]) -> list[str]:
    """``names`` once each; an angle with keys for all units is one name: theta1_rad/_deg/_pi."""
    known = set(names := list(names))
    units = "/_".join(UNITS)
    shown = (f"{quantity(name)}_{units}" if known.issuperset(spellings(quantity(name))) else name for name in names)
    return list(dict.fromkeys(shown))


def listed(names: Iterable[str], word: str = "or") -> str:
    """``a, b or c``."""
    *most, last = list(names) or [""]
    return f"{', '.join(most)} {word} {last}" if most else last


COUNTS = ("no", "one", "two", "three", "four", "five", "six", "seven", "eight", "nine", "ten", "eleven")
"""Small numbers in words."""

ORDINALS = ("first", "second", "third", "fourth", "fifth", "sixth", "seventh", "eighth", "ninth", "tenth")
"""Places of pairs in series and of shafts between, in words."""

LONGEST_NAME, LONGEST_DESCRIPTION = 64, 10_000
NAME_PATTERN = rf"^[A-Za-z0-9_-]{{1,{LONGEST_NAME}}}$"
NAME_RULE = f"letters, digits, - and _, at most {LONGEST_NAME} of them"


def ending_in(suffix: str, name: str) -> str:
    """The name of a design made from another design: ``pusher`` -> ``pusher-sized``, no longer than names may be."""
    return name if name.endswith(suffix) else f"{name[: LONGEST_NAME - len(suffix)]}{suffix}"


def is_name(text: str) -> bool:
    """Whether ``text`` can name a design."""
    # fullmatch, because Python's $ also matches before a final line break.
    return re.fullmatch(NAME_PATTERN.strip("^$"), text) is not None
