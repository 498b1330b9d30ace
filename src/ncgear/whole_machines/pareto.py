"""Comparison of machines: machines that none beats, a few of them far apart, the recommended one, and differences."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TypeVar

import numpy as np

from ncgear.design.keys.design import Design

Item = TypeVar("Item")

SAME = 1e-3
"""Relative difference of a figure below which machines count as equal."""


def objectives_of(design: Design) -> tuple[str, ...]:
    """The figures that count, by their names in the file."""
    choices = design.choices
    if choices is not None and choices.least is not None:
        return tuple(choices.least)
    free = ("driven_flywheel_kg_mm2",) if design.free_flywheel is not None else ()
    return ("peak_power_w", "gear_volume_mm3", *free)


def undominated(items: Sequence[Item], values: Callable[[Item], Sequence[float]]) -> list[Item]:
    """The items that no other item matches in every figure and beats in one, by SAME of the figure."""
    table = np.array([values(one) for one in items], dtype=float).reshape(len(items), -1)
    kept: list[int] = []
    for row in range(len(items)):
        others = np.delete(table, row, axis=0)
        room = SAME * np.abs(table[row])
        as_good = np.all(others <= table[row] + room, axis=1)
        better = np.any(others < table[row] - room, axis=1)
        twin = any(np.all(np.abs(table[one] - table[row]) <= room) for one in kept)
        if not np.any(as_good & better) and not twin:
            kept.append(row)
    return [items[row] for row in kept]


def far_apart(items: Sequence[Item], values: Callable[[Item], Sequence[float]], count: int) -> list[Item]:
    """At most ``count`` items: the best in each figure, the item nearest to all, then the farthest from them."""
    if len(items) <= count:
        return list(items)
    table = np.array([values(one) for one in items], dtype=float)
    span = np.ptp(table, axis=0)
    table = (table - table.min(axis=0)) / np.where(span > 0.0, span, 1.0)
    taken = [int(np.argmin(np.linalg.norm(table, axis=1))), *np.argmin(table, axis=0).tolist()]
    taken = list(dict.fromkeys(taken))[:count]
    while len(taken) < count:
        gap = np.min(np.linalg.norm(table[:, None, :] - table[None, taken, :], axis=2), axis=1)
        taken.append(int(np.argmax(gap)))
    return [items[row] for row in sorted(taken)]


def recommended(
    items: Sequence[Item], values: Callable[[Item], Sequence[float]], cost: Callable[[Item], float | None]
) -> int:
    """The index of the cheapest item; without costs, the item with the least product of all figures over zero.

    The product does not depend on the unit of a figure, nor on how bad the worst items are.  A figure does not count
    where it is zero for some item, for example a flywheel that is left out.
    """
    costs = [one for item in items if (one := cost(item)) is not None]
    if len(costs) == len(items):
        return int(np.argmin(costs))
    table = np.array([values(one) for one in items], dtype=float)
    positive = table[:, np.all(table > 0.0, axis=0)]
    return int(np.argmin(np.log(positive).sum(axis=1)))
