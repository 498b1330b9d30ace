"""Numbers for people, in units that fit their size, and results as JSON."""

from __future__ import annotations

import json
from collections.abc import Mapping
from math import isfinite
from typing import Any

import numpy as np

from ncgear.numerics.arrays import Array

THOUSANDS = {"W": "kW", "N": "kN", "N m": "kN m", "mm/s": "m/s", "mm/s\u00b2": "m/s\u00b2"}
"""Units, each with the unit that is a thousand times as large."""


def readable(unit: str, *values: Array | float) -> tuple[float, str]:
    """The unit in which values (of any shapes, not empty) are easy to read: the factor to it, and its name.

    It is the larger unit where a value reaches a thousand, so that peaks of 1 to 9 999 999 show as 1 to 9999.
    """
    largest = max(float(np.max(np.abs(value))) for value in values)
    return (1e-3, THOUSANDS[unit]) if unit in THOUSANDS and largest >= 1000.0 else (1.0, unit)


def finite(value: Any, name: str) -> Any:
    """The value, the same; ArithmeticError, which names it, where it or a part of it is no finite number.

    This is the check at the way out: everything that is told or written as text, table or JSON goes through it.
    """
    if isinstance(value, float) and not isfinite(value):
        raise ArithmeticError(f"{name} is {value}, which is no figure of a machine")
    if isinstance(value, Mapping):
        for key, part in value.items():
            finite(part, f"{name}.{key}" if name else str(key))
    elif isinstance(value, list | tuple):
        for place, part in enumerate(value):
            finite(part, f"{name}.{place}" if name else str(place))
    return value


LONG_LIST = 12
"""Items up to which a list is written out."""


def shown(value: Any) -> str:
    """A value of a summary as text: numbers with five digits, yes or no, ``-`` for None.

    Runs of whole numbers are shown as ``3-7``, pairs of numbers as ``0.1..0.2``.
    """
    if value is None:
        return "-"
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, float):
        finite(value, "a figure")
        # Five significant digits, but never fewer than the digits before the point.
        return f"{value:.0f}" if 1e5 <= abs(value) < 1e12 else f"{value:.5g}"
    if isinstance(value, list | tuple):
        return _listed(list(value))
    return str(value)


def _listed(items: list[Any]) -> str:
    if not items:
        return "none"
    if all(isinstance(item, int) and not isinstance(item, bool) for item in items):
        return ", ".join(_runs(sorted(items)))
    if any(isinstance(item, Mapping) for item in items):
        # The file of the summary has the whole table; a terminal has no room for it.
        return str(len(items))
    texts = [
        "..".join(map(shown, item)) if isinstance(item, list | tuple) and len(item) == 2 else shown(item)
        for item in items[:LONG_LIST]
    ]
    left = len(items) - len(texts)
    return ", ".join([*texts, f"and {left} more"] if left else texts)


def _runs(numbers: list[int]) -> list[str]:
    """Consecutive numbers joined: 1, 2, 3, 5 -> ``1-3``, ``5``."""
    starts = [i for i, number in enumerate(numbers) if i == 0 or number > numbers[i - 1] + 1]
    ends = [*(start - 1 for start in starts[1:]), len(numbers) - 1]
    pairs = [(numbers[start], numbers[end]) for start, end in zip(starts, ends, strict=True)]
    return [f"{low}" if low == high else f"{low}-{high}" for low, high in pairs]


def json_text(content: Any) -> str:
    """Content as indented JSON with a final line break; raises ArithmeticError as ``finite`` does."""
    return json.dumps(finite(content, ""), indent=2, allow_nan=False) + "\n"
