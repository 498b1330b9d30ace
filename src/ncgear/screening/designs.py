"""Many designs of a sweep: their varied values, and their figures or failed conditions, as of single designs.

Numbers are checked against the limits of the models as arrays, and designs of a kind are computed together.  A design
is computed alone where no batch is sure of it, or its kind has no batch.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import Any

import numpy as np

from ncgear.design.keys.design import Design
from ncgear.design.reading.places import Document
from ncgear.design.space import Space, accepted, checked_design
from ncgear.design.trains.registry import KINDS, names_in_file
from ncgear.design.words import quantity, spellings
from ncgear.errors import DesignError, WrongInput
from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array, IndexArray, Mask, equal_rows
from ncgear.screening.batch import Batch, BatchKind, kind_of
from ncgear.screening.rows import found_of
from ncgear.screening.samples import Fineness, laws_of, refused_at_once
from ncgear.screening.single import figure_names, single_figures

MADE = "made"

STROKES = (
    Fineness(29, (0.0, 0.2, 0.8, 1.0), (0.0, 0.4, 0.6, 0.88, 1.0)),
    Fineness(33, (0.0, 0.1, 0.3, 0.75, 1.0), (0.0, 0.2, 0.4, 0.5, 0.6, 0.7, 0.85, 0.95, 1.0), 3e-7),
    Fineness(
        33,
        (0.0, 0.04, 0.12, 0.25, 0.45, 0.75, 1.0),
        (0.0, 0.15, 0.3, 0.4, 0.48, 0.54, 0.6, 0.66, 0.75, 0.87, 0.96, 1.0),
        1e-3,
    ),
    Fineness(13, None, None),
    Fineness(49, (0.0, 0.1, 0.3, 0.75, 1.0), None, 3e-2),
    Fineness(65, None, None),
    Fineness(97, None, None),
)
"""Tried in order until a stroke is resolved: first few points, on pieces that are short where strokes bend most, which
is enough for four in five designs at the border.  The fourth, coarse but with pieces where laws are sharpest, only
refuses strokes that are steepest at their start."""

HARMONICS = tuple(Fineness(count) for count in (65, 129, 257, 513))
"""Of harmonic laws."""

TOGETHER = 1 << 16
"""Samples computed at once: with fewer, Python's share of each step counts (benchmarks/screening.md); with more, a
process takes more memory, 16 MB for twice as many, and gains a twentieth at most."""


@dataclass(frozen=True, eq=False)
class Block:
    """The results of n designs.

    ``figures`` has an array of shape (n,) for each key, NaN where the design is refused or has no such figure; ``made``
    (shape (n,)) marks makeable designs.  ``verdicts`` has a text for each: ``made``, or the key and the fault, as in
    the refusal of the single design.
    """

    figures: dict[str, Array]
    made: Mask
    verdicts: tuple[str, ...]


def screened_block(data: dict[str, Any], keys: Sequence[str], values: Array) -> Block:
    """Figures and verdicts of designs with other numbers at some dotted keys of a checked file's plain values.

    ``values`` has shape (n, keys).  Memory grows with n by the figures only.
    """
    numbers, written = np.asarray(values, dtype=float), checked_design(data, [], [])
    if isinstance(written, WrongInput):
        raise written
    table = _Table(figure_names(written), len(numbers))
    for batch, rows in _batches(data, written, keys, numbers):
        computed_together(batch, rows, table)
    for row in np.nonzero([not verdict for verdict in table.verdicts])[0].tolist():
        design = checked_design(data, keys, numbers[row].tolist())
        if isinstance(design, WrongInput):
            table.refuse(row, design)
        else:
            table.compute(row, design)
    return Block(table.figures, table.made, tuple(table.verdicts))


def _batches(
    data: dict[str, Any], written: Design, keys: Sequence[str], values: Array
) -> Iterator[tuple[Batch, IndexArray]]:
    """Designs that a file may hold, in batches with their rows; rows outside all batches must be computed alone.

    Rows that differ only in columns of a batch share a written design.
    """
    kind = kind_of(written)
    read = [number for number, key in enumerate(keys) if kind is not None and kind.reads(key)]
    others = [number for number in range(len(keys)) if number not in read]
    sound = np.ones(len(values), dtype=bool)
    for number in read:
        sound &= accepted(type(written), data, keys[number], values[:, number])
    rows, chosen = np.nonzero(sound)[0], [keys[number] for number in others]
    groups: dict[BatchKind, list[tuple[Design, IndexArray]]] = {}
    for same in _alike(values[:, others], rows):
        design = checked_design(data, chosen, values[same[0], others].tolist())
        if isinstance(design, Design) and (its := kind_of(design)) is not None:
            groups.setdefault(its, []).append((design, same))
    for its, members in groups.items():
        in_order = np.concatenate([same for _, same in members])
        follows = np.repeat(np.arange(len(members)), [len(same) for _, same in members])
        columns = {keys[number]: values[in_order, number] for number in read}
        batch = Batch(its, tuple(design for design, _ in members), follows, columns)
        for part in batch.parts():
            yield batch.kept(part), in_order[part]


def _alike(values: Array, rows: IndexArray) -> list[IndexArray]:
    """Groups of rows with equal values (shape (n, keys))."""
    if not values.shape[1] or not rows.size:
        return [rows] if rows.size else []
    group = equal_rows(values[rows])[1]
    in_order = rows[np.argsort(group, kind="stable")]
    return np.split(in_order, np.cumsum(np.bincount(group))[:-1])


class _Table:
    """The block as it fills."""

    def __init__(self, names: Sequence[str], count: int) -> None:
        self.figures = {name: np.full(count, np.nan) for name in names}
        self.made = np.zeros(count, dtype=bool)
        self.verdicts = [""] * count

    def refuse(self, row: int, error: DesignError) -> None:
        """Put down why a design is refused."""
        self.verdicts[row] = str(error)

    def make(self, rows: IndexArray, figures: dict[str, Array]) -> None:
        """Store figures, shape (m,) each, of makeable designs."""
        self.made[rows] = True
        for row in rows.tolist():
            self.verdicts[row] = MADE
        for name, values in figures.items():
            self.figures[name][rows] = values

    def compute(self, row: int, design: Design) -> None:
        """Compute a design by itself."""
        try:
            figures = single_figures(design)
        except DesignError as error:
            self.refuse(row, error)
        else:
            self.make(np.array([row]), {name: np.array([value]) for name, value in figures.items()})


def computed_together(
    batch: Batch, rows: IndexArray, table: _Table, finenesses: Sequence[Fineness] | None = None
) -> None:
    """Store the sure results of a batch, by the rows' numbers (shape (n,)).

    ``finenesses`` are tried one after the other, each on all designs that the earlier ones do not resolve, but not on
    designs that were too far from resolved.
    """
    refused = refused_at_once(batch)
    for place, error in refused.items():
        table.refuse(int(rows[place]), error)
    places, laws = np.setdiff1d(np.arange(len(batch)), list(refused)).astype(int), laws_of(batch)
    missed = np.zeros(len(batch))
    for fineness in finenesses or (STROKES if batch.kind.has_return else HARMONICS):
        tried = places[missed[places] <= fineness.most_missed]
        if not tried.size:
            continue
        try:
            found = found_of(batch, laws, tried, fineness, TOGETHER)
        except DesignError:
            # A resistance that is no smooth function: each design is refused alone.
            return
        missed[tried] = np.maximum(missed[tried], found.missed)
        table.make(rows[found.made], found.figures)
        for place, error in found.refused.items():
            table.refuse(int(rows[place]), error)
        places = np.setdiff1d(places, [*found.made.tolist(), *found.refused])


Names = np.ndarray[Any, np.dtype[np.object_]]


@dataclass(frozen=True, eq=False)
class Designs:
    """n designs of a sweep, shape (n,) each: their numbers, the values by key, the figures by name, the verdicts.

    Unknown figures of a refused design are NaN.
    """

    numbers: IndexArray
    values: dict[str, Array]
    figures: dict[str, Array]
    verdicts: Names

    @property
    def made(self) -> Mask:
        """Which designs are made, as far as they were followed."""
        return self.verdicts == MADE

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
    """The rows of one or more tables with the same columns, one after the other."""
    first = parts[0]
    return Designs(
        np.concatenate([part.numbers for part in parts]),
        {key: np.concatenate([part.values[key] for part in parts]) for key in first.values},
        {name: np.concatenate([part.figures[name] for part in parts]) for name in first.figures},
        np.concatenate([part.verdicts for part in parts]),
    )


@dataclass(frozen=True)
class Screening:
    """A screening: the plain values of a file, the space, and the names of the figures.

    ``rows`` successive designs are a part, which is computed, written and continued from as a whole.
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
    """The designs of a part with these values of keys; sampling them, which loads 68 MB, is left to the caller."""
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
    """A verdict with the key as in the file: the key of an angle ends in the file's unit."""
    key, colon, problem = verdict.partition(": ")
    if not colon or _has(data, key):
        return verdict
    if "train" in data:
        key = Document({}, {}, names_in_file(KINDS[data["train"]["kind"]])).as_written(key)
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


Counted = Callable[[int, int], None]
"""A function that receives the number of finished designs and the number of all designs."""
