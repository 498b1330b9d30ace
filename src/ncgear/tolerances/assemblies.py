"""Figures of many assemblies: transmission error, play, contact, and the motion of the output.

The figures are kinematic and quasi-static: the gears turn slowly and rest on their pushing flanks, without load.  The
output follows the driven gear, and so its transmission error.  The acceleration counts the slow part of this error, up
to a quarter of the number of teeth per turn.  Faster parts shake the machine as vibration, which needs masses and
stiffness: ``ncgear simulate`` computes it.  Gears that turn to and fro are followed from one end of their range to the
other.

Of two pairs in series, the first turns the second by its error e1, which the second passes on by its law's slope.  To
first order the crank is ahead by

    e = e2 + phi2'(psi) (e1 + delta1)

at the angle psi of the intermediate shaft, where delta1 is the keyway error of the gear that is driven there.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import fields
from functools import cached_property
from math import pi

import numpy as np

from ncgear.contact.placement import BACK, PUSHING
from ncgear.frozen import dataclass
from ncgear.kinematics.motion import Machine
from ncgear.numerics.arrays import Array, Columns, IndexArray
from ncgear.numerics.jet import Jet
from ncgear.ratio.transmission import Pair
from ncgear.tolerances.drawn import (
    COUNT,
    Chances,
    DeviationLimits,
    DeviationSource,
    chances_of,
    drawn,
    sources_of,
    with_source,
)
from ncgear.tolerances.mesh import Deviations, LinearMesh

SLOW_SHARE = 0.25
"""Most slow waves per turn of the driving gear, or in its range, as a share of the number of teeth."""


@dataclass(frozen=True, eq=False)
class BetweenAngles:
    """Places of angles between rising positions of a cycle, shape (n,) each: the positions beside, and the share."""

    before: IndexArray
    after: IndexArray
    share: Array

    def of(self, values: Array) -> Array:
        """Values at the angles, shape (n, N), by straight lines between values at the positions, shape (p, N)."""
        share = self.share[:, None]
        return np.asarray((1.0 - share) * values[self.before] + share * values[self.after])


def between(angle_rad: Array, position_rad: Array, cycle_rad: float | None) -> BetweenAngles:
    """Places of angles (n,) between positions (p,), the first again after ``cycle_rad``; None: a range with an end."""
    before = np.searchsorted(position_rad, angle_rad, side="right") - 1
    if cycle_rad is None:
        before = np.minimum(before, position_rad.size - 2)
        ends = position_rad
    else:
        ends = np.append(position_rad, position_rad[0] + cycle_rad)
    share = (angle_rad - ends[before]) / (ends[before + 1] - ends[before])
    return BetweenAngles(before, (before + 1) % position_rad.size, share)


@dataclass(frozen=True)
class Waves:
    """The slow part over a cycle of driving angles: up to ``count`` waves in the cycle."""

    cycle_rad: float
    count: int

    def of(self, even: Array) -> Array:
        """The slow part of values at even angles (shape (g, N)) with its first two derivatives, shape (3, g, N)."""
        found = np.fft.rfft(even, axis=0)[: self.count + 1]
        rate = (2j * pi / self.cycle_rad * np.arange(found.shape[0]))[:, None]
        return np.stack([np.fft.irfft(found * rate**order, even.shape[0], axis=0) for order in range(3)])


@dataclass(frozen=True)
class Smoothed:
    """The slow part over a range from end to end: a filter that halves ``count`` waves in the range.

    The sum of the squared differences from the values and of the squared third differences, times a penalty, is least
    (Whittaker 1923, Henderson 1924).  Of w waves it leaves the share 1 / (1 + (w / count)^6).  It invents no values
    beyond the ends, so a parabola stays as it is, up to the ends.
    """

    range_rad: float
    count: float

    def of(self, even: Array) -> Array:
        """The slow part of values at even angles (shape (g, N)) with its first two derivatives, shape (3, g, N)."""
        from scipy.interpolate import make_interp_spline
        from scipy.linalg import solveh_banded

        angle, step = np.linspace(0.0, self.range_rad, even.shape[0], retstep=True)
        penalty = (2.0 * pi * self.count / self.range_rad * float(step)) ** -6
        banded = np.zeros((4, even.shape[0]))
        for offset in range(4):
            # The diagonals of D'D, where D takes third differences.
            products = THIRD[offset:] * THIRD[: 4 - offset]
            banded[offset, : even.shape[0] - offset] = penalty * np.convolve(products, np.ones(even.shape[0] - 3))
        banded[0] += 1.0
        spline = make_interp_spline(angle, solveh_banded(banded, even, lower=True), k=5)
        return np.stack([spline.derivative(order)(angle) if order else spline(angle) for order in range(3)])


THIRD = np.array([-1.0, 3.0, -3.0, 1.0])
"""The third difference of four values."""


@dataclass(frozen=True, eq=False)
class Follower:
    """The output of a machine, at the machine's p positions and at g even driving angles over the cycle or range.

    ``radius_mm`` (shape (p,)) is the pitch radius of the last driven gear, ``slope`` (shape (p,)) the output's way per
    driven angle, in mm/rad or rad/rad.  ``driven`` (shape (2, g)) are the first and second derivative of the driven
    angle by the driving angle, ``output`` (shape (3, g)) the first three derivatives of the output by the driven angle.
    ``even`` gives the places of the even angles between the positions, and ``slowly`` takes the slow part of errors
    there. ``designed_peak`` is the largest acceleration of the output without deviations, in mm/s2 or rad/s2.
    """

    radius_mm: Array
    slope: Array
    speed_rad_s: float
    designed_peak: float
    even: BetweenAngles
    slowly: Waves | Smoothed
    driven: Array
    output: Array

    @cached_property
    def _even_peak(self) -> float:
        """The largest second derivative of the output by the driving angle at the even angles, without deviations."""
        return float(np.abs(self._seconds(np.zeros((3, self.even.share.size, 1)))).max())

    def peaks(self, error: Array) -> Array:
        """Largest acceleration (N,) with an error of the driven angle and two derivatives, (3, g, N), to first order.

        The part of the peak without deviations that the even angles miss is added to all peaks.
        """
        missed = self.designed_peak - self.speed_rad_s**2 * self._even_peak
        return np.asarray(self.speed_rad_s**2 * np.abs(self._seconds(error)).max(axis=0) + missed)

    def _seconds(self, error: Array) -> Array:
        """Second derivatives of the output by the driving angle, shape (g, N)."""
        value, rate, change = error
        first, second, third = self.output[:, :, None]
        speed, acceleration = self.driven[0][:, None] + rate, self.driven[1][:, None] + change
        return (second + third * value) * speed**2 + (first + second * value) * acceleration

    def slow(self, error_rad: Array) -> Array:
        """The slow part of errors at the positions (shape (p, N)) and its two derivatives, shape (3, g, N)."""
        return self.slowly.of(self.even.of(error_rad))


@dataclass(frozen=True, eq=False)
class PairAssemblies(Columns):
    """Figures of one pair in N assemblies over a cycle of meetings, shape (N,) each.

    ``transmission_error_rad`` and ``transmission_error_mm`` are peak to peak: the driven shaft's angle, and this angle
    times the pitch radius.  A play is an angle of the driven gear in rad, or a distance of the idle flanks along their
    normal; where it is below 0 the teeth jam.  ``reversal_play_mm`` is the largest play where the torque turns round.
    ``least_arc`` is in pitches.
    """

    transmission_error_rad: Array
    transmission_error_mm: Array
    least_play_rad: Array
    least_play_mm: Array
    largest_play_mm: Array
    reversal_play_mm: Array
    least_arc: Array


@dataclass(frozen=True, eq=False)
class Assemblies:
    """Figures of N assemblies over a cycle of meetings, shape (N,) each: each pair by itself, and the machine.

    The transmission errors, peak to peak, compare the last driven gear with the driving shaft.  ``play_max_rad`` is the
    largest angle by which this gear can turn while the driving shaft is held.  ``motion_error`` is the largest
    deviation of the output's place, and ``peak_acceleration`` its largest acceleration: in mm and mm/s2, or in rad and
    rad/s2 where it turns.
    """

    pairs: tuple[PairAssemblies, ...]
    transmission_error_rad: Array
    transmission_error_mm: Array
    play_max_rad: Array
    motion_error: Array
    peak_acceleration: Array

    @property
    def count(self) -> int:
        """The number of assemblies."""
        return self.motion_error.size

    @property
    def least_play_mm(self) -> Array:
        """The least play of any pair."""
        return np.asarray(np.minimum.reduce([pair.least_play_mm for pair in self.pairs]))

    @property
    def largest_play_mm(self) -> Array:
        """The largest play of any pair."""
        return np.asarray(np.maximum.reduce([pair.largest_play_mm for pair in self.pairs]))

    @property
    def reversal_play_mm(self) -> Array:
        """The largest play of any pair where the torque on it turns round."""
        return np.asarray(np.maximum.reduce([pair.reversal_play_mm for pair in self.pairs]))

    @property
    def least_arc(self) -> Array:
        """The least arc of contact in any pair."""
        return np.asarray(np.minimum.reduce([pair.least_arc for pair in self.pairs]))

    @classmethod
    def joined(cls, parts: list[Assemblies]) -> Assemblies:
        """The assemblies of all parts, in their order."""
        pairs = tuple(map(PairAssemblies.joined, zip(*(part.pairs for part in parts), strict=True)))
        own = [field.name for field in fields(cls)[1:]]
        return cls(pairs, *(np.concatenate([getattr(part, name) for part in parts]) for name in own))


@dataclass(frozen=True, eq=False)
class PairLot:
    """One pair of a machine, for the computation of its assemblies.

    ``reversals`` are the positions next to which the torque of the driven gear turns round.  ``way`` gives the places
    of the machine's positions between positions of the mesh, and ``slope`` (shape (p,)) the turn of the last driven
    gear there per angle of this pair's driven gear.
    """

    mesh: LinearMesh
    limits: DeviationLimits
    reversals: IndexArray
    way: BetweenAngles
    slope: Array

    def carried(self, angle_rad: Array) -> Array:
        """Angles of this pair's driven gear (shape (q, N)) as the last gear's, at the machine's positions."""
        return np.asarray(self.slope[:, None] * self.way.of(angle_rad))


@dataclass(frozen=True, eq=False)
class Lot:
    """The values from which assemblies are computed: their pairs from the driving shaft on, and the output."""

    pairs: tuple[PairLot, ...]
    follower: Follower

    @property
    def flanks(self) -> tuple[int, ...]:
        """Number of flanks of each pair."""
        return tuple(pair.limits.flanks for pair in self.pairs)

    @property
    def sources(self) -> tuple[DeviationSource, ...]:
        """The sources of deviations."""
        return sources_of([pair.limits for pair in self.pairs])

    @property
    def places(self) -> int:
        """Number of places of contact of all pairs."""
        return sum(pair.mesh.lead.size for pair in self.pairs)

    def drawn(self, task: AssembliesTask) -> tuple[Deviations, ...]:
        """The deviations of each pair in the assemblies of a task."""
        chances = task.chances(self.flanks)
        return tuple(drawn(pair.limits, own) for pair, own in zip(self.pairs, chances, strict=True))

    def assembled(self, of: Sequence[Deviations]) -> Assemblies:
        """The figures of assemblies with given deviations of each pair."""
        leads = [pair.mesh.leads(own) for pair, own in zip(self.pairs, of, strict=True)]
        # The last keyway turns the output, and is no error of the gears.
        *between_rad, last_rad = (own.output_rad for own in of)
        keyed = zip(self.pairs, leads, [*between_rad, 0.0], strict=True)
        error = np.asarray(sum(pair.carried(lead[PUSHING] + off_rad) for pair, lead, off_rad in keyed))
        play = np.asarray(sum(pair.carried(-lead.sum(axis=0)) for pair, lead in zip(self.pairs, leads, strict=True)))
        follower = self.follower
        slow = follower.slow(error)
        slow[0] += last_rad
        return Assemblies(
            pairs=tuple(map(of_pair, self.pairs, of, leads)),
            transmission_error_rad=np.ptp(error, axis=0),
            transmission_error_mm=np.ptp(error * follower.radius_mm[:, None], axis=0),
            play_max_rad=play.max(axis=0),
            motion_error=np.abs(follower.slope[:, None] * (error + last_rad)).max(axis=0),
            peak_acceleration=follower.peaks(slow),
        )


def of_pair(pair: PairLot, of: Deviations, lead: Array) -> PairAssemblies:
    """The figures of a pair with the leads ``lead`` of its first contacts, shape (2, q, N)."""
    mesh = pair.mesh
    error, play = lead[PUSHING], -lead[PUSHING] - lead[BACK]
    play_mm = play * mesh.arm_mm[BACK][:, None]
    return PairAssemblies(
        transmission_error_rad=np.ptp(error, axis=0),
        transmission_error_mm=np.ptp(error * mesh.radius_mm[:, None], axis=0),
        least_play_rad=play.min(axis=0),
        least_play_mm=play_mm.min(axis=0),
        largest_play_mm=play_mm.max(axis=0),
        reversal_play_mm=play_mm[pair.reversals].max(axis=0, initial=-np.inf),
        least_arc=mesh.least_arcs(of),
    )


def lot_of_pairs(
    machine: Machine,
    made: Sequence[tuple[LinearMesh, DeviationLimits, IndexArray, Pair]],
    pitches: float,
    designed_peak: float,
) -> Lot:
    """The lot of a machine's pairs from the driving shaft on, each by its mesh, limits, reversals and law.

    The machine's positions are the positions of all pairs.  ``pitches`` is the number of tooth pitches in a turn of the
    first driving gear, or in its range where gears turn less than once.  ``designed_peak`` is the largest acceleration
    of the output as designed.  Two pairs have one lobe each, so that the cycle of meetings of both is one turn of every
    shaft.
    """
    last, covered, is_open = made[-1][0], made[0][0].cycle_rad, machine.transmission.lobes.range is not None
    cycle = None if is_open else covered
    shafts = [np.maximum(law.shaft_rad(mesh.phi1_rad), 0.0) for mesh, _, _, law in made]
    ways, slopes = [], []
    angle = position = np.unique(np.concatenate(shafts))
    for shaft, (_, _, _, law) in zip(shafts, made, strict=True):
        ways.append(between(position, shaft, cycle))
        turned = law.transmission.driven_angle(angle, 1)
        slopes.append(turned.derivative(1))
        angle = turned.value
    even = np.linspace(0.0, covered, position.size, endpoint=is_open)
    slowly = (
        Smoothed(covered, SLOW_SHARE * pitches)
        if is_open
        else Waves(covered, max(int(SLOW_SHARE * pitches), 1) * round(covered / (2.0 * pi)))
    )
    driven = machine.transmission.driven_angle(even, 2)
    output = machine.linkage.displacement(Jet.variable(driven.value, 3))
    follower = Follower(
        radius_mm=ways[-1].of(last.radius_mm[:, None])[:, 0],
        slope=machine.linkage.displacement(Jet.variable(angle, 1)).derivative(1),
        speed_rad_s=machine.speed_rad_s,
        designed_peak=designed_peak,
        even=between(even, position, cycle),
        slowly=slowly,
        driven=np.stack([driven.derivative(order) for order in (1, 2)]),
        output=np.stack([output.derivative(order) for order in (1, 2, 3)]),
    )
    pairs = tuple(
        PairLot(mesh, limits, reversals, way, np.prod([np.ones_like(position), *slopes[number + 1 :]], axis=0))
        for number, ((mesh, limits, reversals, _), way) in enumerate(zip(made, ways, strict=True))
    )
    return Lot(pairs, follower)


TOGETHER = 64
"""Assemblies that are computed at once: so few that their arrays stay in the processor's cache."""


@dataclass(frozen=True, eq=False)
class AssembliesTask:
    """Assemblies to be drawn: the numbers of s pairs (shape (s COUNT, n)), and seeds for the numbers of the teeth.

    With ``other``, the numbers of ``source`` come from that task and all other numbers from this task.
    """

    number: int
    pairs: Array
    seeds: tuple[int, ...]
    source: DeviationSource | None = None
    other: AssembliesTask | None = None

    def chances(self, flanks: Sequence[int]) -> tuple[Chances, ...]:
        """The numbers between 0 and 1 of these assemblies, for each pair by its number of flanks."""
        from scipy.stats import uniform

        count = self.pairs.shape[1]
        random = np.random.default_rng(self.seeds)
        teeth = uniform.ppf(random.random((2, sum(flanks), count)))
        own = chances_of(self.pairs.reshape(len(flanks), COUNT, count), np.split(teeth, np.cumsum(flanks)[:-1], axis=1))
        if self.source is None or self.other is None:
            return own
        return with_source(own, self.source, self.other.chances(flanks))


def computed(lot: Lot, task: AssembliesTask) -> Assemblies:
    """The figures of the assemblies of a task."""
    return lot.assembled(lot.drawn(task))


def sobol_points(count: int, seed: int, dimensions: int) -> Array:
    """Scrambled points of Sobol, shape (dimensions, count); ``count`` is a power of two."""
    from scipy.stats import qmc

    points = qmc.Sobol(dimensions, rng=np.random.default_rng([seed, dimensions])).random(count)
    # A distribution may have no end, so a number of exactly 0 has no value.
    return np.ascontiguousarray(np.clip(points.T, 1e-12, 1.0 - 1e-12))


def tasks_of(pairs: Array, seed: int, stream: int) -> list[AssembliesTask]:
    """Tasks of at most TOGETHER assemblies each; the teeth of each have their own seed."""
    starts = range(0, pairs.shape[1], TOGETHER)
    return [
        AssembliesTask(number, pairs[:, start : start + TOGETHER], (seed, stream, number))
        for number, start in enumerate(starts)
    ]
