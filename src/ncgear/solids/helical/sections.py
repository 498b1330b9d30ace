"""Exact sections of helical teeth at any height, and their outlines cut at corresponding places.

Between two sections whose teeth stand d apart along a pitch curve of curvature k, straight lines cut across the surface
by d^2 / (8 rho), where 1 / rho = |k| (1 + h k) on a land h outside the pitch curve.  The number of sections follows.

Each tooth is cut where its lands end and where flank and fillet join, tangentially or in the corner that an undercut
leaves.  Between two such places every section has one piece of outline, and a place in it is named by its share of the
piece's length, so that each point of one section has a counterpart in all others.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import field
from functools import cached_property
from math import ceil, sqrt

import numpy as np

from ncgear.contact.designed.flanks import least_arc
from ncgear.contact.placement import placed
from ncgear.errors import NoSuchMechanism, Unanswered
from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array, IndexArray
from ncgear.numerics.plane import signed_area
from ncgear.pitch.pair import PitchPair
from ncgear.pitch.shape import Gear
from ncgear.solids.helical.helix import Helix
from ncgear.teeth.flank import FILLET
from ncgear.teeth.form import ToothForm
from ncgear.teeth.gear import ToothedGear, ToothedPair, toothed_pair

PER_TOOTH = 6
"""Places on each tooth."""

AGREEMENT = 1e-7
"""Distance, in modules, at which a place computed from the exact curves counts as a vertex of the outline.  It covers
the rounding of gears of up to a thousand modules and is far below any chord."""

LOOKED_AT = 9
"""Sections in which contact is computed, both ends included: contact changes as slowly as the curvature."""


@dataclass(frozen=True, eq=False)
class HelicalSection:
    """Both gears at one height."""

    teeth: ToothedPair

    def of(self, gear: Gear) -> ToothedGear:
        """The gear of the pair in this section."""
        return self.teeth.of(gear)

    @cached_property
    def pieces(self) -> dict[Gear, Pieces]:
        """The outlines of both gears, cut at corresponding places."""
        return {gear: pieces_of(self.of(gear)) for gear in Gear}


@dataclass(frozen=True, eq=False)
class Sections:
    """Sections of a pair of helical gears, each made when it is first asked for; outlines to ``tolerance_mm``."""

    pitch: PitchPair
    form: ToothForm
    helix: Helix
    tolerance_mm: float
    _made: dict[float, HelicalSection] = field(default_factory=dict, repr=False)

    def at(self, height_mm: float) -> HelicalSection:
        """The section at a height; raises NoSuchMechanism, naming the height, where no tooth can stand."""
        if height_mm not in self._made:
            with said_of_section(height_mm):
                advance = self.helix.advance_mm(height_mm)
                teeth = toothed_pair(self.pitch, self.form, self.tolerance_mm, advance_mm=advance)
            self._made[height_mm] = HelicalSection(teeth)
        return self._made[height_mm]

    def pieces(self, gear: Gear, heights_mm: Array) -> list[Pieces]:
        """A gear's outlines at heights, shape (l,), cut at corresponding places."""
        return [self.at(height).pieces[gear] for height in heights_mm]

    def steps_within(self, sagitta_mm: float) -> int:
        """Number of even steps, from z = 0 to where the teeth stop advancing, that cut across no land by more."""
        return max(1, ceil(sqrt(self.sagitta_mm(1) / sagitta_mm)))

    def sagitta_mm(self, steps: int) -> float:
        """How far straight lines cut across lands when the same height is divided into even steps."""
        turning = max(self._turning(gear) for gear in Gear)
        return turning * (self.helix.largest_advance_mm / steps) ** 2 / 8.0

    def _turning(self, gear: Gear) -> float:
        """The larger 1 / rho of both lands, with their height and depth at z = 0."""
        hollow, sharp = (extremum.value for extremum in self.pitch.curvature_range[gear])
        flanks = self.at(0.0).of(gear).flanks
        lands = float(np.max(flanks.tip_height_mm)), -float(np.max(flanks.root_depth_mm))
        return max(abs(k) * abs(1.0 + height * k) for k in (hollow, sharp) for height in lands)


@contextmanager
def said_of_section(height_mm: float) -> Iterator[None]:
    """A context that adds the height of the section to a NoSuchMechanism raised in it."""
    try:
        yield
    except NoSuchMechanism as fault:
        problem = f"in the section of the helical teeth at z = {height_mm:.4g} mm: {fault.problem}"
        raise NoSuchMechanism(problem, key=fault.key) from fault


def least_section_contact(sections: Sections) -> float:
    """Least arc of contact, in pitches, of the pairs of flanks in all sections; their shapes differ."""
    placement, heights = placed(sections.pitch), np.linspace(0.0, sections.helix.rise_mm, LOOKED_AT)
    return min(least_arc(sections.at(float(height)).teeth, placement) for height in heights)


@dataclass(frozen=True, eq=False)
class Pieces:
    """A closed outline from its first place round to the same place, in the direction of growing arc length.

    ``points_mm`` has shape (n + 1, 2), first point repeated.  ``length_mm`` (n + 1,) is the outline's length up to each
    point.  ``cut_mm`` (pieces + 1,) is the length up to each place and up to the end.
    """

    points_mm: Array
    length_mm: Array
    cut_mm: Array

    @property
    def count(self) -> int:
        """Number of pieces, six for each tooth."""
        return len(self.cut_mm) - 1

    def lengths_at(self, piece: IndexArray, share: Array) -> Array:
        """Lengths along the outline at shares (0 to 1) of pieces, shape (c,)."""
        start, end = self.cut_mm[piece], self.cut_mm[piece + 1]
        return np.asarray(start + (end - start) * share)

    def at(self, piece: IndexArray, share: Array) -> Array:
        """Points at shares of pieces, shape (c, 2)."""
        along = self.lengths_at(piece, share)
        return np.column_stack([np.interp(along, self.length_mm, column) for column in self.points_mm.T])


def pieces_of(gear: ToothedGear) -> Pieces:
    """A gear's outline cut at the places of its teeth; raises Unanswered where the places are not found in order."""
    from scipy.spatial import cKDTree

    places = _places(gear)
    outline = gear.outline_mm if signed_area(places) > 0.0 else gear.outline_mm[::-1]
    distance, vertex = cKDTree(outline).query(places)
    if np.max(distance) > AGREEMENT * gear.flanks.rack.module_mm:
        raise Unanswered(f"a tooth's corner is {np.max(distance):.3g} mm away from its outline")
    cut = np.append(np.mod(vertex - vertex[0], len(outline)), len(outline))
    if np.any(np.diff(cut) < 0):
        raise Unanswered(f"the corners of tooth {int(np.argmin(np.diff(cut))) // PER_TOOTH + 1} are out of order")
    points = np.roll(outline, -vertex[0], axis=0)
    closed = np.concatenate([points, points[:1]])
    length = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(closed, axis=0), axis=1))])
    return Pieces(closed, length, length[cut])


def _places(gear: ToothedGear) -> Array:
    """Back root, back joint, back tip, front tip, front joint, front root of each tooth in turn, shape (6 z, 2)."""
    sides, flanks = gear.sides, gear.flanks
    every = np.arange(flanks.count)
    first, after = np.searchsorted(sides.owner, every), np.searchsorted(sides.owner, every, side="right")
    before_fillet = np.concatenate([[0], np.cumsum(sides.kind != FILLET)])
    joint = np.minimum(first + before_fillet[after] - before_fillet[first], after - 1)
    run = np.stack([first, joint, after - 1], axis=1)
    parameter = np.stack([sides.start[first], sides.start[joint], sides.end[after - 1]], axis=1)
    point = flanks.curve_of(sides.kind[run.ravel()], np.repeat(every, 3), parameter.ravel())[0].reshape(-1, 3, 2)
    point[0::2] = point[0::2, ::-1]
    return point.reshape(-1, 2)
