"""Tables over the driving angle for the contact of pairs of teeth.

A pair touches at the law's driven angle along its path of contact; where only a corner of its teeth would touch, the
driven gear has a way to go first.  The slope of the touching angle is not a difference of samples: it follows from the
speeds of both gears along the common normal.  The contacts of each pair stand in a row along the positions; the row
reaches into the intervals between its positions and one interval beyond either end.

Each pair has its own stiffness at each place, tabled like the gap by cubics with known slopes, so that the energy of a
pair whose stiffness changes on its way is known, too.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import cached_property, lru_cache

import numpy as np

from ncgear.contact.designed.as_designed import first_within, repeat_of
from ncgear.contact.designed.curves import Contacts
from ncgear.contact.placement import BOTH_SIDES, URGE, Placement, placed
from ncgear.dynamics.pair_places import PairPlaces, PairStiffness, fixed_tangents, pair_places
from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array, Columns, IndexArray, Mask, row_blocks
from ncgear.numerics.periodic_table import PeriodicTable, cubics
from ncgear.numerics.plane import along
from ncgear.pitch.pair import PitchPair
from ncgear.teeth.gear import ToothedPair


@dataclass(frozen=True, eq=False)
class Rows(Columns):
    """The first contact of n pairs and positions, in the order of pairs and then positions; shape (n,) each.

    ``values`` (shape (n, q)) are the quantities to be followed, the first of them the driven angle beyond the law's;
    ``drift`` is the known slope of that angle by the driving angle.  ``teeth`` (shape (n, 2)) counts from 1.
    """

    urge: Array
    teeth: IndexArray
    position: IndexArray
    values: Array
    drift: Array

    def in_order(self) -> Rows:
        """The rows in the order of sides, pairs and positions."""
        return self.kept(np.lexsort((self.position, *self.teeth.T, self.urge)))

    @cached_property
    def pair(self) -> IndexArray:
        """A number for each pair of teeth and side, shape (n,)."""
        whole = np.column_stack([self.urge.astype(int), self.teeth])
        return np.cumsum(np.append(0, np.any(np.diff(whole, axis=0) != 0, axis=1)))

    def neighbours(self, step: int, count: int) -> IndexArray:
        """The row of the same pair ``step`` positions on, of ``count`` in all; -1 without such a row, shape (n,)."""
        key = self.pair * count + self.position
        wanted = self.pair * count + (self.position + step) % count
        found = np.minimum(np.searchsorted(key, wanted), key.size - 1)
        return np.where(key[found] == wanted, found, -1)


def first_of_pairs(contacts: Contacts, urge: float) -> Contacts:
    """The first contact of each pair at each position, in the order of pairs and positions."""
    teeth = contacts.driving_tooth, contacts.driven_tooth
    order = np.lexsort((-urge * contacts.error_rad, contacts.position, teeth[1], teeth[0]))
    place = np.column_stack([*teeth, contacts.position])[order]
    return contacts.kept(order[np.append(True, np.any(np.diff(place, axis=0) != 0, axis=1))])


@dataclass(frozen=True, eq=False)
class RowCubics:
    """Cubics of rows over k intervals, sorted by interval, shape (k,) each.

    A cubic goes from the row ``start`` to the row ``end`` in ``values`` with ``slopes`` (shape (n, q)), over ``width``;
    -1 stands for a row's straight continuation.
    """

    values: Array
    slopes: Array
    interval: IndexArray
    start: IndexArray
    end: IndexArray
    width: Array

    @property
    def row(self) -> IndexArray:
        """The row of each cubic."""
        return np.where(self.start < 0, self.end, self.start)

    def coefficients(self, chosen: slice) -> Array:
        """Of the chosen cubics, shape (4, chosen, q), highest power first."""
        width = self.width[chosen]
        return cubics(width, *_ends(self.values, self.slopes, self.start[chosen], self.end[chosen], width))


def row_cubics(rows: Rows, placement: Placement) -> RowCubics:
    """Cubics over all intervals of rows; beyond its ends a row continues in a straight line for an interval."""
    count = placement.count
    following, preceding = rows.neighbours(1, count), rows.neighbours(-1, count)
    slopes = _slopes(rows, placement, preceding, following)
    # Before the first position of gears that turn less than once there is no interval.
    begins = np.nonzero((preceding < 0) & ((placement.toothed is None) | (rows.position > 0)))[0]
    start = np.concatenate([np.arange(rows.position.size), np.full(begins.size, -1)])
    end = np.concatenate([following, begins])
    interval = np.concatenate([rows.position, (rows.position[begins] - 1) % count])
    order = np.argsort(interval, kind="stable")
    start, end, interval = start[order], end[order], interval[order]
    return RowCubics(rows.values, slopes, interval, start, end, _widths(placement)[interval])


def _ends(
    values: Array, slopes: Array, start: IndexArray, end: IndexArray, width: Array
) -> tuple[tuple[Array, Array], tuple[Array, Array]]:
    """Values and slopes at both ends of intervals; -1 stands for a row's straight continuation."""
    before, after = np.where(start < 0, end, start), np.where(end < 0, start, end)
    low = values[before] - np.where(start < 0, width, 0.0)[:, None] * slopes[before]
    high = values[after] + np.where(end < 0, width, 0.0)[:, None] * slopes[after]
    return (low, slopes[before]), (high, slopes[after])


def _slopes(rows: Rows, placement: Placement, preceding: IndexArray, following: IndexArray) -> Array:
    """Slopes of all values by the driving angle.

    The slope of the first value is known; the others' are differences between neighbours, and zero at a row's ends:
    arms that fall towards a grazing contact must not go on to below zero.
    """
    inner = np.nonzero((preceding >= 0) & (following >= 0))[0]
    width, position = _widths(placement), rows.position[inner]
    slopes = np.zeros_like(rows.values)
    across = width[position - 1] + width[position]
    slopes[inner] = (rows.values[following[inner]] - rows.values[preceding[inner]]) / across[:, None]
    slopes[:, 0] = rows.drift
    return slopes


def _widths(placement: Placement) -> Array:
    """Driving angle of each interval, the last interval to the end of the table, shape (count,)."""
    return np.diff(_breaks(placement))


def _breaks(placement: Placement) -> Array:
    """Ends of all intervals; gears that turn less than once have a further end beyond their range.

    The first position has rolled nothing: its angle is 0 but for rounding, and no angle may lie before all intervals.
    """
    phi1 = placement.phi1_rad
    end = placement.cycle_rad if placement.toothed is None else phi1[-1] + (phi1[-1] - phi1[-2])
    return np.concatenate([[0.0], phi1[1:], [end]])


def reach_rad(rows: Rows, placement: Placement) -> Array:
    """Least driven angle between the end of a row and the first contact of its side there.

    It has a value for each interval between positions, shape (count,); inf where no row ends.
    """
    count = placement.count
    behind = np.full(count, np.inf)
    after, before = rows.neighbours(1, count) < 0, rows.neighbours(-1, count) < 0
    if placement.toothed is not None:
        # Pairs do not end with the range.
        after, before = after & (rows.position < count - 1), before & (rows.position > 0)
    ends = after | before
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


PER_TOOTH = 80
"""Positions per tooth pitch.  At the ends of contact gaps begin to grow with the square of the way; with this many
positions first touches are met to some millionths of a radian even there (tests/test_gaps.py)."""

WITHIN_IN_MODULES, LEAST_IN_MODULES = 0.52, 0.05
"""Depths to which teeth are followed into each other: deeper than any law of impact is valid, and at least, so that a
row begins many positions before its pair touches."""


ERROR, LEVER, STIFFNESS = 0, 1, 4
"""Columns of a table's quantities."""

ALIKE_RAD = 1e-9
"""Driven angle within which pairs count as touching together: far above rounding errors."""


@dataclass(frozen=True, eq=False)
class Near:
    """Pairs that touch or nearly touch, at driving angles of shape s; arrays of shape s + (slots,), or s by slot.

    ``urge`` is +1 on pushing flanks, -1 on their backs and 0 in empty slots.  ``error_rad`` is the driven angle beyond
    the law's at which the pair touches, ``lever_mm`` the arm of its normal force about the driven axis, ``stiffness``
    the stiffness of ``PairStiffness``; ``slopes`` are the slopes of these three by the driving angle.  ``driving_mm``
    and ``driven_mm`` are the speeds, in mm per rad of each gear's own angle, at which their points pass along the
    tangent that leads outwards from the driven axis.  ``number`` numbers pairs of helical teeth, which have a slot in
    each section; None for straight teeth.
    """

    urge: Array
    error_rad: Array
    lever_mm: Array
    driving_mm: Array
    driven_mm: Array
    stiffness: Array
    slopes: tuple[Array, Array, Array]
    number: IndexArray | None = None

    def of_pairs(self, values: Array) -> Array:
        """Values of slots as the sum over all sections of each pair, in one of its slots; 0 in its others."""
        if self.number is None:
            return values
        order = np.argsort(self.number, axis=-1)
        changes = np.diff(np.take_along_axis(self.number, order, axis=-1), axis=-1, prepend=-1) != 0
        sums = np.zeros(order.shape)
        sums[changes] = np.add.reduceat(np.take_along_axis(values, order, axis=-1).ravel(), np.flatnonzero(changes))
        found = np.empty(order.shape)
        np.put_along_axis(found, order, sums, axis=-1)
        return found


@dataclass(frozen=True, eq=False)
class Gaps:
    """The pairs of a mesh over a whole cycle of meetings.

    ``urge`` has shape (intervals, slots), ``table`` the five quantities of each slot.  ``pair`` has the driving and the
    driven tooth of each slot, from 1, or 0 where it is empty; shape (intervals, slots, 2).  ``reach_rad`` is the angle,
    in each interval, by which the driven gear may be pressed beyond the first contact before a pair touches that the
    tables do not follow; inf where there is no such pair.  ``section`` (slots,) numbers the section of the face width
    in which a slot's pair is: all pairs of straight teeth are in section 0.
    """

    table: PeriodicTable
    urge: Array
    pair: IndexArray
    reach_rad: Array
    section: IndexArray

    @classmethod
    def beside(cls, parts: Sequence[Gaps]) -> Gaps:
        """The pairs of several sections with the same positions, side by side in the slots."""
        if len(parts) == 1:
            return parts[0]
        breaks, tables = parts[0].table.breaks, [part.table.coefficients for part in parts]
        return cls(
            PeriodicTable(breaks, np.concatenate(tables, axis=2)),
            np.concatenate([part.urge for part in parts], axis=1),
            np.concatenate([part.pair for part in parts], axis=1),
            np.min([part.reach_rad for part in parts], axis=0),
            np.repeat(np.arange(len(parts)), [part.section.size for part in parts]),
        )

    @property
    def sections(self) -> int:
        """Number of sections."""
        return int(self.section[-1]) + 1

    def of_sections(self, turning: Array) -> Array:
        """Values of slots, shape (n, slots), as the sum over sections of the largest in each, shape (n,)."""
        begins = np.searchsorted(self.section, np.arange(self.sections))
        return np.asarray(np.maximum.reduceat(turning, begins, axis=-1).sum(axis=-1))

    def at(self, phi1_rad: Array | float, slot: IndexArray | None = None) -> Near:
        """The pairs near contact at driving angles in rad, of any shape; with ``slot`` of that shape, those pairs."""
        value, slope = self.table.at(phi1_rad, slot)
        _, index, _ = self.table.place(phi1_rad)
        error, lever, driving, driven, stiffness = (value[..., number] for number in range(5))
        slopes = slope[..., 0], slope[..., 1], slope[..., STIFFNESS]
        urge = self.urge[index] if slot is None else self.urge[index, slot]
        number = None if self._number is None or slot is not None else self._number[index]
        return Near(urge, error, lever, driving, driven, stiffness, slopes, number)

    @cached_property
    def _number(self) -> IndexArray | None:
        """A number for each pair of flanks, shape (intervals, slots); None for straight teeth."""
        if self.sections == 1:
            return None
        driving, driven = np.moveaxis(self.pair, -1, 0)
        return np.asarray(2 * (driving * (driven.max() + 1) + driven) + (self.urge > 0.0))

    @property
    def come_and_go(self) -> bool:
        """Whether more than one pair of a side may touch."""
        return bool(max(np.count_nonzero(self.urge == side, axis=1).max() for side in (1.0, -1.0)) > 1)

    @property
    def touching_stiffness(self) -> Array:
        """Stiffness of the pairs that touch without load at the positions of the table, shape (n,)."""
        return np.asarray(self.table.coefficients[-1, ..., STIFFNESS][self._touching])

    @property
    def touching_levers_mm(self) -> Array:
        """Levers of the same pairs, shape (n,)."""
        return np.asarray(self.table.coefficients[-1, ..., LEVER][self._touching])

    @property
    def _touching(self) -> Mask:
        """Which slots touch first, on either side of the teeth, shape (intervals, slots)."""
        error = self.table.coefficients[-1, ..., ERROR]
        touching = np.zeros(self.urge.shape, dtype=bool)
        for urge in (1.0, -1.0):
            ahead = np.where(self.urge == urge, urge * error, -np.inf)
            first = ahead.max(axis=1, keepdims=True)
            touching |= (self.urge == urge) & (ahead >= first - ALIKE_RAD)
        return touching

    def stiffened(self, factor: float) -> Gaps:
        """The same pairs, each as many times as stiff."""
        coefficients = self.table.coefficients.copy()
        coefficients[..., STIFFNESS] *= factor
        return replace(self, table=replace(self.table, coefficients=coefficients))

    def play_rad(self, phi1_rad: Array) -> tuple[Array, Array]:
        """Driven angles beyond the law's at which pushing flanks and their backs first touch, shape of ``phi1_rad``."""
        urge, error = self.urge[self.table.place(phi1_rad)[1]], self.table.values(phi1_rad, ERROR)
        pushing = np.where(urge > 0.0, error, -np.inf).max(axis=-1)
        back = np.where(urge < 0.0, error, np.inf).min(axis=-1)
        return pushing, back

    def too_deep(self, phi1_rad: Array, error_rad: Array) -> tuple[float, float] | None:
        """The place where driven angles beyond the law's press teeth deepest beyond the range of the tables.

        The driving angle and the angle by which the driven gear is pressed, in rad; None where the tables suffice.
        """
        pushing, back = self.play_rad(phi1_rad)
        pressed = np.maximum(pushing - error_rad, error_rad - back)
        reach = self.reach_rad[self.table.place(phi1_rad)[1]]
        worst = int(np.argmax(pressed - reach))
        return (float(phi1_rad[worst]), float(pressed[worst])) if pressed[worst] > reach[worst] else None


def gaps_of(
    teeth: ToothedPair,
    pitch: PitchPair,
    stiffness: PairStiffness,
    per_tooth: int = PER_TOOTH,
    sides: Sequence[int] = BOTH_SIDES,
    within_modules: float = WITHIN_IN_MODULES,
) -> Gaps:
    """The pairs of a mesh on ``sides`` of the teeth, from contacts at ``per_tooth`` (an even number) positions a tooth.

    Pairs are followed ``within_modules`` of the first contact.  Teeth that are followed on one side only never touch on
    the other.
    """
    placement, met = _met(teeth, pitch, per_tooth, tuple(sides), within_modules)
    rows = [replace(meeting, values=np.column_stack([meeting.values, stiffness(places)])) for meeting, places in met]
    return _slotted(_all_round(Rows.joined(rows), placement, repeat_of(teeth, placement)).in_order(), placement)


def _all_round(rows: Rows, placement: Placement, count: int) -> Rows:
    """The rows of all positions, of rows of the first ``count``, after which the teeth meet as at first."""
    turn, row = np.divmod(np.arange(placement.count // count * rows.drift.size), rows.drift.size)
    found, first = rows.kept(row), turn * count
    pitches = np.round(first / placement.per_tooth).astype(int)[:, None]
    teeth = (found.teeth - 1 + pitches) % [placement.driving_teeth, placement.driven_teeth] + 1
    return replace(found, teeth=teeth, position=found.position + first)


@lru_cache(maxsize=2)
def _met(
    teeth: ToothedPair, pitch: PitchPair, per_tooth: int, sides: tuple[int, ...], within_modules: float
) -> tuple[Placement, list[tuple[Rows, PairPlaces]]]:
    """The positions, and on each side contacts of pairs but for their stiffness, and their places, until teeth repeat.

    Kept: ``ncgear size`` asks for the same teeth in other widths, and a simulation for the teeth that strength loads.
    """
    placement = placed(pitch, per_tooth)
    within_mm = within_modules * teeth.driving.flanks.rack.module_mm
    found = first_within(teeth, placement, within_mm, sides, repeat_of(teeth, placement))
    return placement, [_rows(ends, float(URGE[side]), placement) for ends, side in zip(found, sides, strict=True)]


def _rows(contacts: Contacts, urge: float, placement: Placement) -> tuple[Rows, PairPlaces]:
    """The first contacts of pairs of teeth at positions, with slopes but without the stiffness, and their places."""
    contacts = first_of_pairs(contacts, urge)
    place, tangent = fixed_tangents(contacts, placement)
    from_axis = place - placement.center_distance_mm
    lever = along(tangent, from_axis)
    driving, driven = along(tangent, 1j * place), placement.mesh.sense * along(tangent, 1j * from_axis)
    drift = placement.mesh.sense * along(tangent, place) / lever - placement.speed[contacts.position]
    values = np.column_stack([contacts.error_rad, lever, driving, driven])
    teeth = np.column_stack([contacts.driving_tooth, contacts.driven_tooth])
    rows = Rows(np.full(drift.size, urge), teeth, contacts.position, values, drift)
    return rows, pair_places(contacts, placement)


def _slotted(rows: Rows, placement: Placement) -> Gaps:
    """Rows side by side in the slots of each interval."""
    found = row_cubics(rows, placement)
    slot = np.arange(found.interval.size) - np.searchsorted(found.interval, found.interval)
    place, shape = (found.interval, slot), (placement.count, int(slot.max()) + 1)
    coefficients = np.zeros((4, *shape, rows.values.shape[1]))
    in_line, number = coefficients.reshape(4, -1, rows.values.shape[1]), found.interval * shape[1] + slot
    for chosen in row_blocks(number.size):
        in_line[:, number[chosen]] = found.coefficients(chosen)
    urge, pair = np.zeros(shape), np.zeros((*shape, 2), dtype=int)
    urge[place], pair[place] = rows.urge[found.row], rows.teeth[found.row]
    every = np.zeros(shape[1], dtype=int)
    return Gaps(PeriodicTable(_breaks(placement), coefficients), urge, pair, reach_rad(rows, placement), every)
