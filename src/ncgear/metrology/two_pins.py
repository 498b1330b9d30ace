"""Measurement over two pins (between them, in a ring) in spaces that lie nearly opposite each other."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ncgear.metrology.pins import Pins, stands_out
from ncgear.metrology.working import WorkingFlanks
from ncgear.numerics.arrays import Array, IndexArray


@dataclass(frozen=True, eq=False)
class TwoPins:
    """Pairs of spaces (numbers from 1) and the distance over, or in a ring between, their pins in mm; shape (n,)."""

    first: IndexArray
    second: IndexArray
    distance_mm: Array


def over_two_pins(working: WorkingFlanks, pins: Pins) -> TwoPins:
    """The greatest distance over the pins (the least between them) of spaces half the teeth apart.

    With z even there are z / 2 pairs, with z odd z of them, (z - 1) / 2 spaces apart; those are left out whose pins
    measure nothing or do not stand out of the tips towards each other's far side.
    """
    teeth = working.flanks.count // 2
    row = np.full(teeth + 1, -1)
    row[pins.space] = np.arange(pins.space.size)
    first = np.arange(1, teeth // 2 + 1 if teeth % 2 == 0 else teeth + 1)
    second = (first + teeth // 2 - 1) % teeth + 1
    both = np.nonzero((row[first] >= 0) & (row[second] >= 0))[0]
    return _apart(working, pins, row[first[both]], row[second[both]])


def _apart(working: WorkingFlanks, pins: Pins, one: IndexArray, other: IndexArray) -> TwoPins:
    """The distances of pins by their rows."""
    sense, radius = (-1.0 if working.is_ring else 1.0), pins.diameter_mm / 2.0
    way = pins.center_mm[one] - pins.center_mm[other]
    length = np.linalg.norm(way, axis=1)
    outwards = sense * way / length[:, None]
    free = stands_out(working, pins.space[one] - 1, pins.center_mm[one], radius, outwards)
    free &= stands_out(working, pins.space[other] - 1, pins.center_mm[other], radius, -outwards)
    distance = length + sense * pins.diameter_mm
    return TwoPins(pins.space[one[free]], pins.space[other[free]], distance[free])
