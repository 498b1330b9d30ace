"""Each pair's contacts in rows along the positions, and the intervals between positions that a row reaches into."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields
from functools import cached_property

import numpy as np

from ncgear.contact.contacts import Contacts
from ncgear.contact.placement import Placement
from ncgear.numerics.arrays import Array, IndexArray, Mask
from ncgear.numerics.periodic_table import cubics


@dataclass(frozen=True, eq=False)
class Rows:
    """The first contact of n pairs and positions, in the order of pairs and then positions; shape (n,) each.

    ``values`` (shape (n, q)) are the quantities to be followed, the first of them the driven angle beyond the law's;
    ``drift`` is that one's slope by the driving angle, which is known.  ``teeth`` (shape (n, 2)) counts from 1.
    """

    urge: Array
    teeth: IndexArray
    position: IndexArray
    values: Array
    drift: Array

    @staticmethod
    def joined(parts: Sequence[Rows]) -> Rows:
        """The rows of several parts, in order again."""
        rows = Rows(*(np.concatenate([getattr(part, field.name) for part in parts]) for field in fields(Rows)))
        return rows.kept(np.lexsort((rows.position, *rows.teeth.T, rows.urge)))

    def kept(self, chosen: IndexArray | Mask) -> Rows:
        """Chosen rows."""
        return Rows(*(getattr(self, field.name)[chosen] for field in fields(self)))

    @cached_property
    def pair(self) -> IndexArray:
        """A number for each pair of teeth and side, shape (n,)."""
        whole = np.column_stack([self.urge.astype(int), self.teeth])
        return np.cumsum(np.append(0, np.any(np.diff(whole, axis=0) != 0, axis=1)))

    def neighbours(self, step: int, count: int) -> IndexArray:
        """The row of the same pair so many of ``count`` positions on, -1 where there is none, shape (n,)."""
        key = self.pair * count + self.position
        wanted = self.pair * count + (self.position + step) % count
        found = np.minimum(np.searchsorted(key, wanted), key.size - 1)
        return np.where(key[found] == wanted, found, -1)


def first_rows(contacts: Contacts, urge: float, values: Array, drift: Array) -> Rows:
    """The first contact of each pair at each position; values of shape (n, q), the first of them the error."""
    teeth = np.column_stack([contacts.driving_tooth, contacts.driven_tooth])
    order = np.lexsort((-urge * contacts.error_rad, contacts.position, *teeth.T))
    place = np.column_stack([teeth, contacts.position])[order]
    chosen = order[np.append(True, np.any(np.diff(place, axis=0) != 0, axis=1))]
    sides = np.full(contacts.position.size, urge)
    return Rows(sides, teeth, contacts.position, values, drift).kept(chosen)


@dataclass(frozen=True, eq=False)
class Stretches:
    """Cubics of rows over intervals, in the order of these: ``coefficients`` of shape (4, k, q), the others (k,)."""

    row: IndexArray
    interval: IndexArray
    coefficients: Array


def stretches(rows: Rows, placement: Placement) -> Stretches:
    """All intervals into which rows reach; beyond its ends a row goes straight on for one interval."""
    count = placement.count
    following, preceding = rows.neighbours(1, count), rows.neighbours(-1, count)
    slopes = _slopes(rows, placement, preceding, following)
    begins = np.nonzero(preceding < 0)[0]
    start = np.concatenate([np.arange(rows.position.size), np.full(begins.size, -1)])
    end = np.concatenate([following, begins])
    interval = np.concatenate([rows.position, (rows.position[begins] - 1) % count])
    width = _widths(placement)[interval]
    ends = _ends(rows.values, slopes, start, end, width)
    order = np.argsort(interval, kind="stable")
    chosen = np.where(start < 0, end, start)
    return Stretches(chosen[order], interval[order], cubics(width, *ends)[:, order])


def _ends(
    values: Array, slopes: Array, start: IndexArray, end: IndexArray, width: Array
) -> tuple[tuple[Array, Array], tuple[Array, Array]]:
    """Values and slopes at both ends of intervals; -1 stands for a row's straight continuation."""
    before, after = np.where(start < 0, end, start), np.where(end < 0, start, end)
    low = values[before] - np.where(start < 0, width, 0.0)[:, None] * slopes[before]
    high = values[after] + np.where(end < 0, width, 0.0)[:, None] * slopes[after]
    return (low, slopes[before]), (high, slopes[after])


def _slopes(rows: Rows, placement: Placement, preceding: IndexArray, following: IndexArray) -> Array:
    """Slopes of all values by the driving angle: known of the first, by differences of neighbours of the rest.

    At a row's ends the rest rest: arms that fall towards a grazing contact must not go on to below zero.
    """
    inner = np.nonzero((preceding >= 0) & (following >= 0))[0]
    width, position = _widths(placement), rows.position[inner]
    slopes = np.zeros_like(rows.values)
    across = width[position - 1] + width[position]
    slopes[inner] = (rows.values[following[inner]] - rows.values[preceding[inner]]) / across[:, None]
    slopes[:, 0] = rows.drift
    return slopes


def _widths(placement: Placement) -> Array:
    """Driving angle of each interval, the last one to the end of the cycle, shape (count,)."""
    return np.diff(placement.phi1_rad, append=placement.cycle_rad)


def reach_rad(rows: Rows, placement: Placement) -> Array:
    """Least driven angle between the end of a row and the first contact of its side there; inf where none ends.

    For each interval between positions, shape (count,).
    """
    count = placement.count
    behind = np.full(count, np.inf)
    ends = (rows.neighbours(1, count) < 0) | (rows.neighbours(-1, count) < 0)
    for urge in (1.0, -1.0):
        ahead = urge * rows.values[:, 0]
        first = np.full(count, -np.inf)
        own = rows.urge == urge
        np.maximum.at(first, rows.position[own], ahead[own])
        last = np.nonzero(own & ends)[0]
        position = rows.position[last]
        for interval in (position, position - 1):
            np.minimum.at(behind, interval, first[position] - ahead[last])
    return behind
