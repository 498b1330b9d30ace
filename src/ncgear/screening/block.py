"""Many designs that differ in the numbers at some keys: figures of those that can be made, and why others cannot."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ncgear.design.varied import checked_design
from ncgear.numerics.arrays import Array, Mask
from ncgear.screening.screen import screened

MADE = "made"


@dataclass(frozen=True, eq=False)
class Block:
    """n designs: each figure, shape (n,), NaN where refused; which are made; a verdict for each.

    A verdict is ``made``, or the key at fault and the problem: ``key: problem``.
    """

    figures: dict[str, Array]
    made: Mask
    verdicts: tuple[str, ...]


def screened_block(data: dict[str, Any], keys: Sequence[str], values: Array) -> Block:
    """The designs of a file's plain values with other numbers at ``keys``, ``values`` of shape (n, keys)."""
    found = screened([checked_design(data, keys, row) for row in values.tolist()])
    figures = {name: np.full(len(values), np.nan) for name in found.figures}
    for name, column in figures.items():
        column[found.made] = found.figures[name]
    return Block(figures, found.made, found.verdicts)
