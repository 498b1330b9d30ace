"""The touching curves in the frame of the driven gear, and the places where they touch.

Chords of the exact curves follow the side of a tooth and tell the curve of a contact; a corner of the side is a place
where two of these curves meet at an angle.  A side continues past its root land to the fillet of the side that it
faces: a corner in a space can touch both.

In this frame the driven gear is at rest, and the driving gear has another place in each position.
"""

from __future__ import annotations

from functools import cached_property

import numpy as np

from ncgear.contact.placement import URGE, Meetings, Placement
from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array, Columns, ComplexArray, IndexArray, Mask
from ncgear.numerics.plane import across, along, angle_between, as_complex, square
from ncgear.teeth.flank import FILLET, FLANK, Flanks
from ncgear.teeth.sides import Sides


@dataclass(frozen=True, eq=False)
class Contacts(Columns):
    """n places of contact, all of shape (n,).

    ``side`` is the side of the teeth, PUSHING or BACK; ``driving`` and ``driven`` number the flanks that meet in
    ``position``.  ``error_rad`` is the driven angle of the contact minus the law's angle; ``point`` and ``tangent`` (of
    any length) are in the frame of the driven gear at that angle.  ``driving_mm`` and ``driven_mm`` are the heights on
    both flanks, NaN where an edge touches.
    """

    side: IndexArray
    driving: IndexArray
    driven: IndexArray
    position: IndexArray
    error_rad: Array
    point: ComplexArray
    tangent: ComplexArray
    driving_mm: Array
    driven_mm: Array

    @cached_property
    def flanks(self) -> Mask:
        """Whether two flanks touch."""
        return ~np.isnan(self.driving_mm)

    @property
    def driving_tooth(self) -> IndexArray:
        """Number of each contact's driving tooth, from 1."""
        return self.driving // 2 + 1

    @property
    def driven_tooth(self) -> IndexArray:
        """Number of each contact's driven tooth, from 1."""
        return self.driven // 2 + 1

    @property
    def urge(self) -> Array:
        """``URGE`` of each contact's side."""
        return URGE[self.side]

    @cached_property
    def lead_rad(self) -> Array:
        """How early each contact touches: the leading contact at a position is the first on its side of the teeth."""
        return self.urge * self.error_rad

    def place(self, placement: Placement) -> IndexArray:
        """Number of each contact's place in a table of shape (2, n) of the sides and positions."""
        return self.side * placement.count + self.position

    def on(self, side: int) -> Contacts:
        """The contacts on one side of the teeth."""
        return self.kept(self.side == side)

    @cached_property
    def lever_mm(self) -> Array:
        """Arm about the driven axis of a force across the tangent."""
        return np.asarray(np.abs(along(self.tangent, self.point)) / np.abs(self.tangent))

    @property
    def pressure_angle_rad(self) -> Array:
        """Angle between the common normal and the velocity of the driven gear's point."""
        return np.arccos(np.minimum(self.lever_mm / np.abs(self.point), 1.0))

    def fixed_points(self, placement: Placement) -> ComplexArray:
        """The places of contact in the fixed frame, as x + i y in mm."""
        return placement.fixed_points(self.point, self.position, self.error_rad)

    def sliding_mm(self, placement: Placement) -> Array:
        """Speed of the driving tooth's sliding over the driven tooth, in mm per rad of phi1; outwards is positive."""
        place = self.fixed_points(placement)
        tangent = placement.fixed_directions(self.tangent, self.position, self.error_rad) / np.abs(self.tangent)
        outwards = np.sign(along(tangent, place))
        return outwards * along(tangent, placement.relative_velocity(place, self.position))


LAND = 2
"""The root land, numbered after the kinds FLANK and FILLET of curves."""

CHORDS = 8
"""Chords per run of a curve; the exact curve strays from them by less than a fiftieth of a module."""

SHARES = np.linspace(0.0, 1.0, CHORDS + 1)
"""Ends of the chords of a run, as shares of its parameter range."""

KINK_RAD = 1e-6
"""Angle between two runs from which their joint is a corner; tangential joints are found to 1e-9."""

NOWHERE = complex(np.nan, np.nan)

TINY = 1e-300
"""Least divisor, so that chords of no length give no division of zero by zero."""


@dataclass(frozen=True, eq=False)
class SidePaths:
    """The paths from all f flanks of a gear with c chords each, in the gear's frame.

    ``places`` (shape (f, c + 1)) are the ends of the chords; shorter paths stay at their end.  ``run`` (shape (f, any
    number)) numbers the runs of each path in ``runs``, -1 beyond its end.  Each of the r runs has ``parameter``,
    ``point`` and ``slope`` (by the parameter) at the ends of its chords, shape (r, CHORDS + 1) each.  ``corner`` has
    the places at which a side has an edge, its tip first, then where two of its curves meet at an angle, shape (f, any
    number), padded with NaN.
    """

    flanks: Flanks
    sides: Sides
    runs: _Runs
    places: ComplexArray
    run: IndexArray
    parameter: Array
    point: ComplexArray
    slope: ComplexArray
    corner: ComplexArray

    def curve(self, run: IndexArray, parameter: Array) -> tuple[ComplexArray, ComplexArray]:
        """Points of the exact curves of runs (shape (n,)) and derivatives; parameters of shape (n, ...)."""
        return _curve(self.flanks, self.sides, self.runs.kind[run], self.runs.owner[run], parameter)

    def chord(self, flank: IndexArray, number: IndexArray) -> tuple[IndexArray, IndexArray]:
        """The runs of chords with these numbers along the paths of flanks, and the chords' numbers in the runs."""
        return self.run[flank, number // CHORDS], number % CHORDS

    @cached_property
    def stray_mm(self) -> Array:
        """Largest possible distance of the curves from their chords, shape (r, CHORDS).

        A curve that bends to one side stays within the triangle of its chord and the tangents at both ends, which is no
        higher than a quarter of the chord times the sum of the tangents' slopes against it.  An arc is half as high.
        """
        chord, sense = np.diff(self.point, axis=1), np.sign(self.runs.end - self.runs.start)[:, None]
        steep = (
            np.abs(across(chord, slope)) / np.maximum(sense * along(chord, slope), TINY)
            for slope in (self.slope[:, :-1], self.slope[:, 1:])
        )
        return np.abs(chord) * sum(steep) / 4.0

    @cached_property
    def own_fillet(self) -> Mask:
        """Whether each chord belongs to the fillet of the flank itself, shape (f, c)."""
        own = (self.run >= 0) & (self.runs.kind[self.run] == FILLET)
        own &= self.runs.owner[self.run] == np.arange(len(self.run))[:, None]
        return np.repeat(own, CHORDS, axis=1)


@dataclass(frozen=True, eq=False)
class _Runs(Columns):
    """Runs of curves in the order of their paths, and along a path from the tip inwards; shape (r,) each.

    ``path`` numbers the flank that a path begins with.  ``owner`` numbers the flank that the curve belongs to; of a
    root land, the tooth before the space.
    """

    path: IndexArray
    kind: IndexArray
    owner: IndexArray
    start: Array
    end: Array

    @property
    def number(self) -> IndexArray:
        """Running number of each run in its path."""
        return np.arange(self.path.size) - np.searchsorted(self.path, self.path)


def side_paths(flanks: Flanks, sides: Sides) -> SidePaths:
    """The paths of all flanks of a gear."""
    down, facing = _runs_down(flanks, sides)
    parameter = down.start[:, None] + (down.end - down.start)[:, None] * SHARES
    point, slope = _curve(flanks, sides, down.kind, down.owner, parameter)
    # Up the fillets across the space.
    fillet = np.flatnonzero(down.kind == FILLET)[::-1]
    up = _Runs(facing[down.path[fillet]], down.kind[fillet], down.owner[fillet], down.end[fillet], down.start[fillet])
    runs = _Runs.joined([down, up])
    order = np.argsort(runs.path, kind="stable")
    parameter, point, slope = (np.concatenate([of, of[fillet, ::-1]])[order] for of in (parameter, point, slope))
    runs = runs.kept(order)
    last = np.searchsorted(runs.path, np.arange(flanks.count), side="right") - 1
    run = np.full((flanks.count, int(runs.number.max()) + 1), -1)
    run[runs.path, runs.number] = np.arange(runs.path.size)
    places = np.where(run[..., None] >= 0, point[run, :-1], point[last, -1][:, None, None]).reshape(flanks.count, -1)
    places = np.column_stack([places, point[last, -1]])
    return SidePaths(flanks, sides, runs, places, run, parameter, point, slope, _corners(runs, point, slope))


def _runs_down(flanks: Flanks, sides: Sides) -> tuple[_Runs, IndexArray]:
    """The runs of all sides and, behind these, the root lands they lead to; and the flank that each flank faces."""
    own = _Runs(sides.owner, sides.kind, sides.owner, sides.start, sides.end)
    every, front = np.arange(flanks.count), flanks.side > 0.0
    facing = np.where(front, every + 1, every - 1) % flanks.count
    space = np.where(front, every, facing) // 2
    first, last = (ends[space] for ends in sides.roots.lands())
    land = np.full(every.size, LAND)
    lands = _Runs(every, land, space, np.where(front, first, last), np.where(front, last, first))
    return _Runs.joined([own, lands]), facing


def _curve(
    flanks: Flanks, sides: Sides, kind: IndexArray, owner: IndexArray, parameter: Array
) -> tuple[ComplexArray, ComplexArray]:
    """Points of n mixed curves (kinds FLANK, FILLET, LAND) at parameters of shape (n, ...), and derivatives."""
    point, slope = np.empty(parameter.shape, dtype=complex), np.empty(parameter.shape, dtype=complex)
    owner = owner.reshape(-1, *[1] * (parameter.ndim - 1))
    for number, curve in ((FLANK, flanks.flank), (FILLET, flanks.fillet), (LAND, sides.roots.land)):
        rows = np.flatnonzero(kind == number)
        if rows.size:
            point[rows], slope[rows] = (as_complex(array) for array in curve(owner[rows], parameter[rows]))
    return point, slope


def _corners(runs: _Runs, points: ComplexArray, slopes: ComplexArray) -> ComplexArray:
    """The start of each side, and of each of its runs that does not go on in the direction of the run before."""
    heading = slopes * np.sign(runs.end - runs.start)[:, None]
    tip = runs.number == 0
    bend = np.append(np.inf, np.abs(angle_between(heading[:-1, -1], heading[1:, 0])))
    own = (runs.owner == runs.path) & (runs.kind != LAND)
    sharp = np.nonzero(own & (tip | (bend > KINK_RAD)))[0]
    path = runs.path[sharp]
    number = np.arange(path.size) - np.searchsorted(path, path)
    corner = np.full((int(runs.path[-1]) + 1, int(number.max()) + 1), NOWHERE)
    corner[path, number] = points[sharp, 0]
    return corner


@dataclass(frozen=True, eq=False)
class SeenGear:
    """One gear's sides in positions; ``moving`` is true of the driving gear."""

    paths: SidePaths
    placement: Placement
    moving: bool

    @property
    def rootwards_out(self) -> bool:
        """Whether the way from a tooth's tip to its root leads away from the driven axis."""
        return self.moving is not self.placement.driven_inside

    def points(self, points: ComplexArray, position: IndexArray) -> ComplexArray:
        """Points of the gear's own frame as seen at positions; shapes broadcast."""
        return self.placement.driving_points(points, position) if self.moving else points

    def flank(self, meetings: Meetings) -> IndexArray:
        """The gear's flank of each meeting, shape (m,)."""
        return meetings.driving if self.moving else meetings.driven

    def squares(self, meetings: Meetings) -> Array:
        """Squared distances from the driven axis of the c places of each meeting's flank, at the meetings' positions.

        The shape is (m, k, c) for m meetings in k positions; k = 1 where nothing moves.
        """
        points, position = self.paths.places, meetings.position
        if not self.moving:
            return square(points)[self.flank(meetings)][:, None]
        # |z turn + axis|^2 = |z|^2 + 2 Re(z turn conj(axis)) + |axis|^2
        axis = self.placement.driving_points(np.zeros(1, dtype=complex), position)
        swing = 2.0 * self.placement.driving_directions(np.ones(1, dtype=complex), position) * np.conj(axis)
        columns = np.stack([swing.real, -swing.imag, np.ones(swing.shape)], axis=-1)
        rows = np.stack([points.real, points.imag, square(points) + self.placement.center_distance_mm**2], axis=1)
        return np.asarray(columns @ rows[self.flank(meetings)])

    def directions(self, vectors: ComplexArray, position: IndexArray) -> ComplexArray:
        """Directions of the gear's own frame as seen at positions; shapes broadcast."""
        return self.placement.driving_directions(vectors, position) if self.moving else vectors

    def curve(self, run: IndexArray, parameter: Array, position: IndexArray) -> tuple[ComplexArray, ComplexArray]:
        """Points of exact curves as seen, and derivatives; ``run`` has shape (n,), the others (n, ...)."""
        point, slope = self.paths.curve(run, parameter)
        return self.points(point, position), self.directions(slope, position)
