"""Exact sections of helical teeth at any height, and how many of them a solid needs.

Between two sections whose teeth stand d apart along a pitch curve of curvature k, straight lines cut across the surface
by d^2 / (8 rho), where 1 / rho = |k| (1 + h k) on a land h outside the pitch curve.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from functools import cached_property
from math import ceil, sqrt

import numpy as np

from ncgear.errors import NoSuchMechanism
from ncgear.numerics.arrays import Array
from ncgear.pitch.pair import PitchPair
from ncgear.pitch.shape import Gear
from ncgear.solids.helix import Helix
from ncgear.solids.pieces import Pieces, pieces_of
from ncgear.teeth.form import ToothForm
from ncgear.teeth.gear import ToothedGear, ToothedPair, toothed_pair


@contextmanager
def said_of_section(height_mm: float) -> Iterator[None]:
    """Refusals from within, said of the section at a height."""
    try:
        yield
    except NoSuchMechanism as fault:
        problem = f"in the section of the helical teeth at z = {height_mm:.4g} mm: {fault.problem}"
        raise NoSuchMechanism(problem, key=fault.key) from fault


@dataclass(frozen=True, eq=False)
class Section:
    """Both gears at one height."""

    teeth: ToothedPair

    def of(self, gear: Gear) -> ToothedGear:
        """One of them."""
        return self.teeth.of(gear)

    @cached_property
    def pieces(self) -> dict[Gear, Pieces]:
        """Their outlines, cut at corresponding places."""
        return {gear: pieces_of(self.of(gear)) for gear in Gear}


@dataclass(frozen=True, eq=False)
class Sections:
    """Sections of a pair of helical gears, each made when it is first asked for; outlines to ``tolerance_mm``."""

    pitch: PitchPair
    form: ToothForm
    helix: Helix
    tolerance_mm: float
    _made: dict[float, Section] = field(default_factory=dict, repr=False)

    def at(self, height_mm: float) -> Section:
        """The section at a height; raises NoSuchMechanism, naming the height, where no tooth can stand."""
        if height_mm not in self._made:
            self._made[height_mm] = Section(self._teeth(height_mm))
        return self._made[height_mm]

    def pieces(self, gear: Gear, heights_mm: Array) -> list[Pieces]:
        """A gear's outlines at heights, shape (l,), cut at corresponding places."""
        return [self.at(height).pieces[gear] for height in heights_mm]

    def _teeth(self, height_mm: float) -> ToothedPair:
        with said_of_section(height_mm):
            advance = self.helix.advance_mm(height_mm)
            return toothed_pair(self.pitch, self.form, self.tolerance_mm, advance_mm=advance)

    def steps_within(self, sagitta_mm: float) -> int:
        """Even steps from z = 0 to where the teeth stop advancing, so that no land is cut across by more."""
        turning = max(self._turning(gear) for gear in Gear)
        return max(1, ceil(self.helix.largest_advance_mm * sqrt(turning / (8.0 * sagitta_mm))))

    def _turning(self, gear: Gear) -> float:
        """1 / rho, the largest of both lands, as high and as deep as they are at z = 0."""
        hollow, sharp = (extremum.value for extremum in self.pitch.curvature_range[gear])
        flanks = self.at(0.0).of(gear).flanks
        lands = float(np.max(flanks.tip_height_mm)), -float(np.max(flanks.root_depth_mm))
        return max(abs(k) * abs(1.0 + height * k) for k in (hollow, sharp) for height in lands)
