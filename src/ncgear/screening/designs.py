"""Rows of a sweep: designs by their numbers, with what varies, the figures found, and the verdicts."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from ncgear.design.keys.base import quantity, spellings
from ncgear.design.space import Space
from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array, IndexArray, Mask
from ncgear.screening.block import MADE, screened_block

Names = np.ndarray[Any, np.dtype[np.object_]]


@dataclass(frozen=True, eq=False)
class Designs:
    """n designs of a sweep, shape (n,) each: their numbers, the values by key, the figures by name, the verdicts.

    Figures of a design that is refused before they are known are NaN.
    """

    numbers: IndexArray
    values: dict[str, Array]
    figures: dict[str, Array]
    verdicts: Names

    @property
    def made(self) -> Mask:
        """Which designs are made, as far as they were followed."""
        made: Mask = self.verdicts == MADE
        return made

    def column(self, name: str) -> Array:
        """A figure, or the values of a key."""
        return self.figures[name] if name in self.figures else self.values[name]

    def at(self, rows: Mask | IndexArray | slice) -> Designs:
        """The designs of some rows."""
        return Designs(
            self.numbers[rows],
            {key: values[rows] for key, values in self.values.items()},
            {name: values[rows] for name, values in self.figures.items()},
            self.verdicts[rows],
        )


def joined(parts: Sequence[Designs]) -> Designs:
    """The rows of one or more tables that have the same columns, one after the other."""
    first = parts[0]
    return Designs(
        np.concatenate([part.numbers for part in parts]),
        {key: np.concatenate([part.values[key] for part in parts]) for key in first.values},
        {name: np.concatenate([part.figures[name] for part in parts]) for name in first.figures},
        np.concatenate([part.verdicts for part in parts]),
    )


@dataclass(frozen=True)
class Screening:
    """What is screened: the plain values of a file, the space, and the names of the figures.

    ``rows`` designs that follow each other are a part, which is computed, written and gone on from as a whole.
    """

    data: dict[str, Any]
    space: Space
    figures: tuple[str, ...]
    rows: int

    @property
    def parts(self) -> int:
        """The number of parts."""
        return -(-self.space.count // self.rows)

    def values(self, part: int) -> Array:
        """The values of the keys of a part's designs, shape (n, keys)."""
        first = part * self.rows
        return self.space.values(first, min(self.rows, self.space.count - first))


def screened_part(screening: Screening, part: int, values: Array) -> Designs:
    """The designs of one part, whose keys have these values; who samples them loads scipy's statistics, 68 MB."""
    space, first, count = screening.space, part * screening.rows, len(values)
    found = screened_block(screening.data, space.keys, values)
    none = np.full(count, np.nan)
    return Designs(
        np.arange(first, first + count),
        dict(zip(space.keys, values.T, strict=True)),
        {name: found.figures.get(name, none) for name in screening.figures},
        np.array([as_in_file(screening.data, verdict) for verdict in found.verdicts], dtype=object),
    )


def as_in_file(data: dict[str, Any], verdict: str) -> str:
    """A verdict whose key has the spelling of the file: the key of an angle ends in the unit that is given there."""
    key, colon, problem = verdict.partition(": ")
    if not colon or _has(data, key):
        return verdict
    return f"{next((name for name in spellings(quantity(key)) if _has(data, name)), key)}: {problem}"


def _has(data: Any, key: str) -> bool:
    for name in key.split("."):
        if isinstance(data, list) and name.isdigit() and int(name) < len(data):
            data = data[int(name)]
        elif isinstance(data, dict) and name in data:
            data = data[name]
        else:
            return False
    return True


def with_figures(designs: Designs, more: dict[str, Array], verdicts: Sequence[str]) -> Designs:
    """The same designs with more figures, and the verdicts of a later stage."""
    return replace(designs, figures={**designs.figures, **more}, verdicts=np.array(verdicts, dtype=object))


Counted = Callable[[int, int], None]
"""What hears how many designs are done, and how many there are."""
