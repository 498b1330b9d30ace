"""Rows of different lengths in flat arrays."""

from __future__ import annotations

import numpy as np

from ncgear.numerics.arrays import IndexArray


def counted_up(first: IndexArray, count: IndexArray) -> tuple[IndexArray, IndexArray]:
    """For each row the numbers ``first``, ``first + 1``, ... (``count`` of them), one row after the other.

    Both of shape (n,).  Returns the row of each number and the numbers, shape (sum of counts,) each.
    """
    row = np.repeat(np.arange(count.size), count)
    before = np.cumsum(count) - count
    return row, np.arange(row.size) + (first - before)[row]
