"""One cycle of the slider in stretches on which its motion is smooth: between joints of the law and dead centres."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from scipy.optimize import elementwise

from ncgear.kinematics.slider import Machine
from ncgear.machine.linkage import CrankSlider
from ncgear.numerics.arrays import Array
from ncgear.numerics.jet import Jet
from ncgear.ratio.transmission import Piece

LEAST = 1e-9
"""Share of the law's period below which a stretch is rounding error of its ends."""


@dataclass(frozen=True, eq=False)
class Stretch:
    """Driving angles from ``start_rad`` to ``end_rad``, within one piece of the law.

    ``working`` tells the way from the retracted to the extended dead centre from the way back.  ``turned`` holds the
    driving and the driven angle in rad at which the piece's period begins.
    """

    start_rad: float
    end_rad: float
    working: bool
    linkage: CrankSlider
    piece: Piece
    turned: tuple[float, float]

    @property
    def samples(self) -> int:
        """Points on which an extremum of anything along the stretch is looked for."""
        return self.piece.samples

    @property
    def knots_rad(self) -> tuple[float, ...]:
        """Inner points at which a high derivative jumps."""
        shifted = (knot + self.turned[0] for knot in self.piece.knots_rad)
        return tuple(knot for knot in shifted if self.start_rad < knot < self.end_rad)

    def driven_angle(self, phi1: Array, order: int) -> Jet:
        """phi2 in rad, with derivatives by phi1; one-sided limits at the ends."""
        driving, driven = self.turned
        local = np.clip(phi1 - driving, self.piece.start_rad, self.piece.end_rad)
        return self.piece.driven_angle(local, order) + driven

    def displacement(self, phi1: Array, order: int) -> Jet:
        """Slider displacement in mm, likewise."""
        return self.linkage.displacement(self.driven_angle(phi1, order))

    def between(self, start_rad: float, end_rad: float) -> Stretch:
        """A part of it."""
        return replace(self, start_rad=start_rad, end_rad=end_rad)


def stretches(machine: Machine) -> list[Stretch]:
    """The stretches of one cycle, in the order of the driving angle."""
    lobes = machine.transmission.lobes
    return [
        stretch
        for period in range(lobes.driven)
        for piece in machine.transmission.pieces
        for stretch in _of_piece(machine, piece, (period * lobes.driving_period_rad, period * lobes.driven_period_rad))
    ]


def _of_piece(machine: Machine, piece: Piece, turned: tuple[float, float]) -> Iterator[Stretch]:
    """The parts of a piece before and after the extended dead centre, as far as there are any."""
    start, end, extended = piece.start_rad + turned[0], piece.end_rad + turned[0], machine.extended_rad
    for low, high, working in ((start, min(end, extended), True), (max(start, extended), end, False)):
        if high - low > LEAST * machine.transmission.lobes.driving_period_rad:
            yield Stretch(low, high, working, machine.linkage, piece, turned)


def cut(stretch: Stretch, displacements_mm: Array) -> list[Stretch]:
    """A stretch of the working stroke cut where the slider passes displacements in mm, in rising order, shape (n,)."""
    edges = [stretch.start_rad, *angles_at(stretch, displacements_mm).tolist(), stretch.end_rad]
    return [stretch.between(low, high) for low, high in pairwise(edges)]


def angles_at(stretch: Stretch, displacements_mm: Array) -> Array:
    """Driving angles inside the stretch at which the slider passes any of the displacements, shape (n,), rising."""
    ends = stretch.displacement(np.array([stretch.start_rad, stretch.end_rad]), 0).value
    wanted_mm: Array = displacements_mm[(displacements_mm > ends.min()) & (displacements_mm < ends.max())]
    if not wanted_mm.size:
        return wanted_mm

    def excess(phi1: Array, wanted: Array) -> Array:
        return stretch.displacement(phi1.ravel(), 0).value.reshape(phi1.shape) - wanted

    around = np.full(wanted_mm.shape, stretch.start_rad), np.full(wanted_mm.shape, stretch.end_rad)
    found: Array = elementwise.find_root(excess, around, args=(wanted_mm,)).x
    return np.unique(found)
