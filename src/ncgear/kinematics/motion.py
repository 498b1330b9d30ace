"""Motion of the slider over a cycle: samples for tables and plots, and smooth stretches for exact derivatives.

A machine is a mechanism that a law drives against a load of its slider at constant driving speed.  Its cycle is cut
into stretches on which the slider's motion is smooth: at the joints of the law, at the dead centres, and about sharp
corners of the mechanism.  An example of a corner is a crank-slider whose rod is hardly longer than crank and offset:
with rod/crank = 1.0001 the slider stands still for half a turn of the crank, and its acceleration there has a peak
0.014 rad of the crank wide, which samples over the whole stroke miss.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from functools import cached_property
from itertools import pairwise
from math import pi

import numpy as np

from ncgear.frozen import dataclass
from ncgear.mechanisms.mechanism import Mechanism
from ncgear.mechanisms.slider_load import SliderLoad
from ncgear.numerics.arrays import Array, Mask, distinct
from ncgear.numerics.jet import Jet
from ncgear.numerics.quadrature import integrated_slope
from ncgear.numerics.units import RAD_S_PER_RPM
from ncgear.numerics.zeros import zeros_between
from ncgear.ratio.transmission import CLOSED, Piece, Transmission
from ncgear.shown import Shown


@dataclass(frozen=True, eq=False)
class OutputMotion(Shown):
    """Samples over the driving angle, all of shape (n,); the load acts against the motion, on both strokes.

    Places, speeds, accelerations and loads are in mm, mm/s, mm/s^2 and N, or in rad, rad/s, rad/s^2 and N mm where the
    output of the mechanism ``linkage`` turns.  ``power_w`` is the power of the resistance alone;
    ``torque_with_masses_n_mm`` and ``power_with_masses_w`` are the driving shaft's with all that the design gives, None
    where masses are not counted.
    """

    linkage: Mechanism
    phi1_rad: Array
    phi2_rad: Array
    ratio: Array
    displacement: Array
    velocity: Array
    acceleration: Array
    load: Array
    power_w: Array
    torque_with_masses_n_mm: Array | None = None
    power_with_masses_w: Array | None = None

    @property
    def driving_power_w(self) -> Array:
        """Power of the driving shaft with all that is counted."""
        return self.power_w if self.power_with_masses_w is None else self.power_with_masses_w

    def __repr__(self) -> str:
        last = float(np.degrees(self.phi1_rad[-1]))
        return f"OutputMotion({self.phi1_rad.size} driving angles up to {last:.4g} deg)"


@dataclass(frozen=True, eq=False)
class Machine(Shown):
    """A transmission that drives a mechanism against a load of its slider at constant driving speed."""

    transmission: Transmission
    linkage: Mechanism
    load: SliderLoad
    speed_rad_s: float

    def __repr__(self) -> str:
        return f"Machine({self.speed_rad_s / RAD_S_PER_RPM:.4g} r/min, {self.linkage!r},\n  {self.transmission!r})"

    def displacement(self, phi1: Array, order: int) -> Jet:
        """Slider displacement in mm, with derivatives by the driving angle."""
        return self.linkage.displacement(self.transmission.driven_angle(phi1, order))

    @cached_property
    def extended_rad(self) -> float:
        """Driving angle in the first cycle at which the working stroke ends; the cycle's end where no return follows.

        Gears that turn less than once stay within the working stroke: it is the end of their range.
        """
        if not (self.linkage.RETURNS and self.transmission.lobes.repeats):
            return self.transmission.cycle_rad
        return float(self.driving_angles(np.array([self.linkage.working_angle_rad]))[0])

    def driving_angles(self, crank_rad: Array) -> Array:
        """Driving angles in the first cycle at crank angles in rad, shape (n,), without angles at its end or beyond.

        Raises Unanswered where an angle is not found, which a rising law cannot cause.
        """

        def driven(phi1: Array) -> Array:
            return self.transmission.driven_angle(phi1).value

        end = self.transmission.cycle_rad * (1.0 - 1e-12)
        wanted: Array = crank_rad[crank_rad < driven(np.array([end]))[0]]
        if not wanted.size:
            return wanted
        return zeros_between(lambda phi1: driven(phi1) - wanted, np.zeros(wanted.shape), np.full(wanted.shape, end))

    def working(self, phi2: Array) -> Mask:
        """Whether the slider is in its working stroke, at driven angles of shape (n,).

        A dead centre belongs to the stroke that follows.  It counts as reached where the law misses it by no more than
        CLOSED, the closure error that a law may have.  Gears that turn less than once count on their way forth.
        """
        if not (self.linkage.RETURNS and self.transmission.lobes.repeats):
            return np.ones(np.shape(phi2), dtype=bool)
        return np.mod(phi2 + CLOSED, 2.0 * pi) < self.linkage.working_angle_rad

    def motion(self, phi1: Array) -> OutputMotion:
        """The motion at driving angles in rad, shape (n,)."""
        driven = self.transmission.driven_angle(phi1, 2)
        displacement = self.linkage.displacement(driven)
        velocity = displacement.derivative(1) * self.speed_rad_s
        returning = ~self.working(driven.value)
        force = self.load.against_n(displacement.value, returning)
        return OutputMotion(
            linkage=self.linkage,
            phi1_rad=phi1,
            phi2_rad=driven.value,
            ratio=1.0 / driven.derivative(1),
            displacement=displacement.value,
            velocity=velocity,
            acceleration=displacement.derivative(2) * self.speed_rad_s**2,
            load=force,
            power_w=np.where(returning, 0.0 - force, force) * velocity / 1000.0,
        )


def sample_angles(transmission: Transmission) -> Array:
    """Evenly spaced driving angles, 2000 a turn, over one cycle and at least one turn of the driving gear.

    For an open law 2000 over its range, both ends included.
    """
    if not transmission.lobes.repeats:
        return np.linspace(0.0, transmission.cycle_rad, 2001)
    end = max(2.0 * pi, transmission.cycle_rad)
    return np.linspace(0.0, end, int(np.ceil(2000 * end / (2.0 * pi))) + 1)


LEAST = 1e-9
"""Share of the law's period below which a stretch counts as the rounding error of its ends."""


@dataclass(frozen=True, eq=False)
class Stretch:
    """Driving angles from ``start_rad`` to ``end_rad``, within one piece of the law.

    ``working`` is true on the way from the retracted to the extended dead centre and false on the way back.  ``turned``
    holds the driving and the driven angle in rad at which the piece's period begins.
    """

    start_rad: float
    end_rad: float
    working: bool
    linkage: Mechanism
    piece: Piece
    turned: tuple[float, float]

    @property
    def knots_rad(self) -> tuple[float, ...]:
        """Inner points at which a high derivative jumps."""
        shifted = (knot + self.turned[0] for knot in self.piece.knots_rad)
        return tuple(knot for knot in shifted if self.start_rad < knot < self.end_rad)

    @property
    def way_mm(self) -> float:
        """The integral of the slider's speed, which judges its displacement's growth."""
        breaks = np.array([self.start_rad, *self.knots_rad, self.end_rad])
        return integrated_slope(lambda phi1: self.displacement(phi1, 1), breaks)

    def driven_angle(self, phi1: Array, order: int) -> Jet:
        """phi2 in rad, with derivatives by phi1; one-sided limits at the ends."""
        driving, driven = self.turned
        local = np.clip(phi1 - driving, self.piece.start_rad, self.piece.end_rad)
        return self.piece.driven_angle(local, order) + driven

    def displacement(self, phi1: Array, order: int) -> Jet:
        """Slider displacement in mm, with derivatives by phi1; one-sided limits at the ends."""
        return self.linkage.displacement(self.driven_angle(phi1, order))

    def speed(self, phi1: Array, order: int) -> Jet:
        """Speed of the output in mm per rad, with derivatives; never negative."""
        moved = self.displacement(phi1, order + 1).differentiated()
        return moved if self.working else -moved


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
    """The stretches of one piece, which the extended dead centre divides."""
    start, end, extended = piece.start_rad + turned[0], piece.end_rad + turned[0], machine.extended_rad
    inner = [extended] if start < extended < end else []
    for low, high in pairwise([start, *inner, end]):
        if high - low > LEAST * machine.transmission.lobes.driving_period_rad:
            yield Stretch(low, high, (low + high) / 2.0 < extended, machine.linkage, piece, turned)


def cut(stretch: Stretch, displacements_mm: Array) -> list[Stretch]:
    """A stretch cut where the slider passes displacements in mm, in rising order, shape (n,)."""
    edges = [stretch.start_rad, *angles_at(stretch, displacements_mm).tolist(), stretch.end_rad]
    return [replace(stretch, start_rad=low, end_rad=high) for low, high in pairwise(edges)]


def angles_at(stretch: Stretch, displacements_mm: Array) -> Array:
    """Driving angles inside the stretch at which the slider passes any of the displacements, shape (n,), rising."""
    if not displacements_mm.size:
        return displacements_mm
    ends = stretch.displacement(np.array([stretch.start_rad, stretch.end_rad]), 0).value
    wanted_mm: Array = displacements_mm[(displacements_mm > ends.min()) & (displacements_mm < ends.max())]
    if not wanted_mm.size:
        return wanted_mm
    around = np.full(wanted_mm.shape, stretch.start_rad), np.full(wanted_mm.shape, stretch.end_rad)
    return distinct(zeros_between(lambda phi1: stretch.displacement(phi1, 0).value - wanted_mm, *around))
