"""Names for the arrays that travel between functions, and rows of different lengths in flat arrays."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import fields, replace
from typing import Any, Self, TypeVar

import numpy as np
from numpy.typing import NDArray

from ncgear.frozen import dataclass

Array = NDArray[np.float64]
"""Real numbers; docstrings say the shape."""

ComplexArray = NDArray[np.complex128]
"""Points of a plane as x + i y, where turning is a multiplication; docstrings say the shape."""

Mask = NDArray[np.bool_]
"""Truth values, one for each element of another array."""

IndexArray = NDArray[np.intp]
"""Whole numbers that count or point into another array."""

Number = TypeVar("Number", float, Array)
"""One number, or an array of them for many points or designs, so that formulas for both are written once."""


Kind = TypeVar("Kind", np.float64, np.complex128, np.intp)
"""Kinds of numbers of an array."""


def repeated(many: Any, count: int) -> Any:
    """Repeats each design ``count`` times in a row, in a dataclass whose arrays count designs along their last axis."""
    arrays = {name: np.repeat(value, count, axis=-1) for name, value in _arrays(many).items()}
    return replace(many, **arrays) if arrays else many


def chosen(many: Any, rows: IndexArray) -> Any:
    """Some of the designs, in a dataclass whose arrays count designs along their last axis."""
    return replace(many, **{name: values[..., rows] for name, values in _arrays(many).items()})


@dataclass(frozen=True, eq=False)
class Columns:
    """Base of dataclasses whose arrays all count the same things along their first axis."""

    def kept(self, rows: Mask | IndexArray | slice) -> Self:
        """The chosen rows of every array; other fields stay."""
        return replace(self, **{name: values[rows] for name, values in _arrays(self).items()})

    @classmethod
    def joined(cls, parts: Sequence[Self]) -> Self:
        """All rows of several parts whose fields are all arrays."""
        return cls(*(np.concatenate([getattr(part, field.name) for part in parts]) for field in fields(cls)))


def _arrays(many: Any) -> dict[str, Any]:
    values = {field.name: getattr(many, field.name) for field in fields(many)}
    return {name: value for name, value in values.items() if isinstance(value, np.ndarray)}


def distinct(values: NDArray[Kind] | Sequence[float]) -> NDArray[Kind]:
    """All different values in rising order, shape (n,), without numpy's masked arrays, which ``np.unique`` loads."""
    ordered: NDArray[Kind] = np.sort(np.asarray(values), axis=None)
    return ordered[np.concatenate([[True], ordered[1:] != ordered[:-1]])] if ordered.size else ordered


def equal_rows(rows: Array | IndexArray) -> tuple[IndexArray, IndexArray]:
    """The first of equal rows of a table (n, k), in rising order of rows, and each row's number among these, (n,).

    As ``np.unique`` with ``axis=0``, which compares rows one by one and takes ten times as long.
    """
    order = np.lexsort(rows.T[::-1])
    new = np.arange(order.size) == 0
    for column in rows.T:
        ordered = column[order]
        new[1:] |= ordered[1:] != ordered[:-1]
    number = np.empty(order.size, dtype=np.intp)
    number[order] = np.cumsum(new) - 1
    return order[new], number


def counted_up(first: IndexArray, count: IndexArray) -> tuple[IndexArray, IndexArray]:
    """For each row the numbers ``first``, ``first + 1``, ... (``count`` of them), one row after the other.

    ``first`` and ``count`` have shape (n,).  Returns the row of each number and the numbers, shape (sum of counts,)
    each.
    """
    row = np.repeat(np.arange(count.size), count)
    before = np.cumsum(count) - count
    return row, np.arange(row.size) + (first - before)[row]


AT_ONCE = 4096
"""Rows of wide arrays that are computed at once: their intermediate values stay in the cache of a processor, while all
rows at once would ask the system for new memory at each step."""


def powers(base: NDArray[Kind], count: int) -> NDArray[Kind]:
    """1, x, x^2 and so on of real or complex numbers x, shape (n,), with few multiplications; shape (count, n)."""
    found = np.empty((count, base.size), dtype=base.dtype)
    found[0], found[1:2] = 1.0, base
    known = 2
    while known < count:
        more = min(known - 1, count - known)
        np.multiply(found[1 : more + 1], found[known - 1], out=found[known : known + more])
        known += more
    return found


def row_blocks(count: int, each: int = 1) -> Iterator[slice]:
    """Blocks of rows that together are ``count`` rows; a row counts as ``each`` of ``AT_ONCE``."""
    size = max(AT_ONCE // each, 1)
    return (slice(start, min(start + size, count)) for start in range(0, count, size))


def largest_rows(values: Array, group: IndexArray, groups: int) -> IndexArray:
    """Row of the largest value of each group (``group`` numbers them, (n,)), the first of equals, or -1; (groups,)."""
    largest = np.full(groups, -np.inf)
    np.maximum.at(largest, group, values)
    rows = np.flatnonzero(values == largest[group])[::-1]
    row = np.full(groups, -1)
    row[group[rows]] = rows
    return row
