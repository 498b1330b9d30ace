"""What each of many assemblies does: transmission error, play, contact, and the motion of the output.

What counts is kinematic and quasi-static: the gears turn slowly and rest on their pushing flanks, without load.  The
output follows the driven gear, and so its transmission error; of it, the part that is slower than the teeth counts in
the acceleration, up to a quarter of the number of teeth per turn.  Faster ones shake the machine as vibration, which
needs masses and stiffness: that is what ``ncgear simulate`` computes.
"""

from __future__ import annotations

from dataclasses import dataclass, fields
from functools import cached_property
from math import pi

import numpy as np

from ncgear.contact.placement import BACK, PUSHING
from ncgear.kinematics.motion import Machine
from ncgear.numerics.arrays import Array, IndexArray
from ncgear.numerics.jet import Jet
from ncgear.tolerances.drawn import COUNT, Chances, Limits, drawn
from ncgear.tolerances.mesh import Deviations, Mesh

SLOW_SHARE = 0.25
"""Share of the number of teeth up to which waves per turn of the driving gear count as slow."""


@dataclass(frozen=True, eq=False)
class Follower:
    """The output of a machine, at the p positions of a mesh and at g even driving angles over the cycle of meetings.

    ``slope`` (shape (p,)) is the output's way per driven angle, in mm/rad or rad/rad.  ``driven`` (shape (2, g)) are
    the first and second derivative of the driven angle by the driving angle, ``output`` (shape (3, g)) the first three
    of the output by the driven angle.  ``waves`` is the number of waves per cycle up to which errors are slow.
    ``designed_peak`` is the largest acceleration of the output without deviations, in mm/s2 or rad/s2.
    """

    slope: Array
    speed_rad_s: float
    designed_peak: float
    even_rad: Array
    driven: Array
    output: Array
    waves: int

    @cached_property
    def _even_peak(self) -> float:
        """The largest second derivative of the output by the driving angle at the even angles, without deviations."""
        return float(np.abs(self._seconds(np.zeros((3, self.even_rad.size, 1)))).max())

    def peaks(self, error: Array) -> Array:
        """Largest acceleration with an error of the driven angle and its two derivatives, shape (3, g, N); shape (N,).

        The output's derivatives are followed to first order in the error.  What the even angles miss of the peak
        without deviations, they are taken to miss of the others.
        """
        missed = self.designed_peak - self.speed_rad_s**2 * self._even_peak
        return np.asarray(self.speed_rad_s**2 * np.abs(self._seconds(error)).max(axis=0) + missed)

    def _seconds(self, error: Array) -> Array:
        """Second derivatives of the output by the driving angle, shape (g, N)."""
        value, rate, change = error
        first, second, third = self.output[:, :, None]
        speed, acceleration = self.driven[0][:, None] + rate, self.driven[1][:, None] + change
        seconds: Array = (second + third * value) * speed**2 + (first + second * value) * acceleration
        return seconds

    def slow(self, phi1_rad: Array, cycle_rad: float, error_rad: Array) -> Array:
        """The slow part of errors at rising driving angles (shape (p, N)) and its two derivatives, shape (3, g, N)."""
        index = np.searchsorted(phi1_rad, self.even_rad, side="right") - 1
        angle = np.append(phi1_rad, phi1_rad[0] + cycle_rad)
        share = ((self.even_rad - angle[index]) / (angle[index + 1] - angle[index]))[:, None]
        after = (index + 1) % phi1_rad.size
        even = (1.0 - share) * error_rad[index] + share * error_rad[after]
        found = np.fft.rfft(even, axis=0)[: self.waves + 1]
        rate = (2j * pi / cycle_rad * np.arange(found.shape[0]))[:, None]
        count = self.even_rad.size
        return np.stack([np.fft.irfft(found * rate**order, count, axis=0) for order in range(3)])


def follower_of(machine: Machine, mesh: Mesh, driving_teeth: int, designed_peak: float) -> Follower:
    """The output of a machine with a single pair of gears, whose largest acceleration is ``designed_peak``."""
    count = mesh.phi1_rad.size
    even = np.linspace(0.0, mesh.cycle_rad, count, endpoint=False)
    law = machine.transmission.driven_angle(even, 2)
    output = machine.linkage.displacement(Jet.variable(law.value, 3))
    slope = machine.linkage.displacement(Jet.variable(mesh.phi2_rad, 1)).derivative(1)
    turns = round(mesh.cycle_rad / (2.0 * pi))
    return Follower(
        slope=slope,
        speed_rad_s=machine.speed_rad_s,
        designed_peak=designed_peak,
        even_rad=even,
        driven=np.stack([law.derivative(order) for order in (1, 2)]),
        output=np.stack([output.derivative(order) for order in (1, 2, 3)]),
        waves=max(int(SLOW_SHARE * driving_teeth), 1) * turns,
    )


@dataclass(frozen=True, eq=False)
class Assemblies:
    """What N assemblies do over a cycle of meetings, shape (N,) each.

    ``transmission_error_rad`` and ``transmission_error_mm`` are peak to peak, of the driven shaft's angle and of that
    times the pitch radius.  Plays are those of the driven gear in rad, and of the idle flanks along their normal; those
    below 0 mean that the teeth jam.  ``reversal_play_mm`` is the largest play where the torque turns round.
    ``least_arc`` is in pitches.  ``motion_error`` is the largest deviation of the output's place, and
    ``peak_acceleration`` its largest acceleration: in mm and mm/s2, or in rad and rad/s2 where it turns.
    """

    transmission_error_rad: Array
    transmission_error_mm: Array
    least_play_rad: Array
    least_play_mm: Array
    largest_play_mm: Array
    reversal_play_mm: Array
    least_arc: Array
    motion_error: Array
    peak_acceleration: Array

    @property
    def count(self) -> int:
        """How many they are."""
        return self.least_play_rad.size

    @classmethod
    def joined(cls, parts: list[Assemblies]) -> Assemblies:
        """Those of all parts, in their order."""
        return cls(*(np.concatenate([getattr(part, field.name) for part in parts]) for field in fields(cls)))


@dataclass(frozen=True, eq=False)
class Lot:
    """All that assemblies are computed from: their mesh, limits and output.

    ``reversals`` are the positions next to which the torque of the driven gear turns round.
    """

    mesh: Mesh
    limits: Limits
    follower: Follower
    reversals: IndexArray

    def assembled(self, of: Deviations) -> Assemblies:
        """What assemblies with given deviations do."""
        mesh = self.mesh
        lead = mesh.leads(of)
        error, play = lead[PUSHING], -lead[PUSHING] - lead[BACK]
        play_mm = play * mesh.arm_mm[BACK][:, None]
        placed = self.follower.slope[:, None] * (error + of.output_rad)
        slow = self.follower.slow(mesh.phi1_rad, mesh.cycle_rad, error)
        slow[0] += of.output_rad
        turned = play_mm[self.reversals]
        return Assemblies(
            transmission_error_rad=np.ptp(error, axis=0),
            transmission_error_mm=np.ptp(error * mesh.radius_mm[:, None], axis=0),
            least_play_rad=play.min(axis=0),
            least_play_mm=play_mm.min(axis=0),
            largest_play_mm=play_mm.max(axis=0),
            reversal_play_mm=turned.max(axis=0, initial=-np.inf),
            least_arc=mesh.least_arcs(of),
            motion_error=np.abs(placed).max(axis=0),
            peak_acceleration=self.follower.peaks(slow),
        )


TOGETHER = 64
"""Assemblies that are computed at once: so few that their arrays stay in the processor's cache."""


@dataclass(frozen=True, eq=False)
class Task:
    """Some assemblies to be drawn: the numbers of the pair (shape (COUNT, n)), and seeds of those of the teeth.

    With ``other`` they have the numbers of ``source`` from there and everything else from here.
    """

    number: int
    pair: Array
    seeds: tuple[int, ...]
    source: str = ""
    other: Task | None = None

    def chances(self, flanks: int) -> Chances:
        """The numbers between 0 and 1 of these assemblies."""
        from scipy.stats import uniform

        random = np.random.default_rng(self.seeds)
        teeth = uniform.ppf(random.random((2, flanks, self.pair.shape[1])))
        own = Chances(self.pair, teeth)
        return own if self.other is None else own.with_source(self.source, self.other.chances(flanks))


def computed(lot: Lot, task: Task) -> Assemblies:
    """What the assemblies of a task do."""
    return lot.assembled(drawn(lot.limits, task.chances(lot.limits.flanks)))


def sobol_points(count: int, seed: int, dimensions: int = COUNT) -> Array:
    """Scrambled points of Sobol, shape (dimensions, count); ``count`` is a power of two."""
    from scipy.stats import qmc

    points = qmc.Sobol(dimensions, rng=np.random.default_rng([seed, dimensions])).random(count)
    # A number of exactly 0 would lie at the end of a distribution that has none.
    return np.ascontiguousarray(np.clip(points.T, 1e-12, 1.0 - 1e-12))


def tasks_of(pair: Array, seed: int, stream: int) -> list[Task]:
    """Tasks of at most TOGETHER assemblies each; the teeth of each have their own seed."""
    starts = range(0, pair.shape[1], TOGETHER)
    return [
        Task(number, pair[:, start : start + TOGETHER], (seed, stream, number)) for number, start in enumerate(starts)
    ]
