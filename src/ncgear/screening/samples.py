"""Designs of a kind as sampled laws: ratio and motion of the slider at Chebyshev points of pieces of the cycle.

Designs of a kind are computed together.  Three-segment strokes are cut at their joints and their returns into equal
pieces of the driving angle; the equations are those of ``ratio/laws/three_segment.py``, which makes one law.  Harmonic
laws are cut by the driven angle, in which everything is smooth and the dead centres are known; the equations are those
of ``ratio/laws/harmonic.py``.  A design of which a batch is not sure is not ``sound``, and is computed alone.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import replace
from functools import cached_property
from math import inf, log, pi

import numpy as np

from ncgear.errors import DesignError
from ncgear.frozen import dataclass
from ncgear.mechanisms.mechanism import Mechanisms
from ncgear.numerics.arrays import Array, IndexArray, Mask, chosen
from ncgear.numerics.jet import Jet
from ncgear.numerics.sampled import integrated, integration, shares
from ncgear.numerics.units import RAD_S_PER_RPM
from ncgear.numerics.zeros import zeros_between
from ncgear.ratio.laws.three_segment import Advance, approach, braking, pressing, require_return
from ncgear.ratio.sampled_strokes import (
    QUARTERINGS,
    PeakedReturns,
    ReturnGrid,
    Returns,
    edges_about,
    peaked_returns,
    returns_with_constant,
)
from ncgear.ratio.transmission import Lobes
from ncgear.ratio.working_stroke import StrokeRequests, WorkingStrokes, closed_strokes, polynomial_at, stroke_refusals
from ncgear.screening.batch import Batch, BatchKind, refusals

WHOLE = 0.0, 1.0
"""Ends of the single piece of an approach."""

THIRDS = 0.0, 1.0 / 3.0, 2.0 / 3.0, 1.0
"""Ends of the pieces of a return: where its ratio is small, a polynomial's inverse varies fast."""

CLOSING_STEPS = 24
"""Newton's steps that close a return; some ten are needed from a start next to a zero of the polynomial."""

WORKING_QUARTERINGS = 5
"""Quarterings of approach and braking towards where the slider hardly moves."""

GUESSES = 65
"""Even places of the approach for the first guess of its slowest place."""

SLOWEST_STEPS = 4
"""Newton's steps from there."""

HARMONIC_PIECES = 4
"""Equal pieces of the working stroke, and of the return."""

OTHER = 6
"""Additional points of a piece for the test whether a stroke closes."""

EVEN_PLACES, OFF = 16, 0.618
"""Even places around a turn for each point of a piece, and their offset as a share of a step, for the test whether a
harmonic law closes."""


@dataclass(frozen=True, eq=False)
class Samples:
    """n laws over one cycle of the slider, cut into p pieces of m points each; arrays have shape (p, m, n).

    With the laws along the last axis numpy works along whole rows: sums and extremes along a piece take a fifth of the
    time.  ``ratio`` is i12, ``slope`` its inverse, ``first`` and ``second`` are the derivatives of ln i12 by the driven
    angle.  ``turning`` is the driven angle per share of the piece, ``there`` (shape (p, n)) marks pieces with a length.
    """

    ratio: Array
    slope: Array
    first: Array
    second: Array
    turning: Array
    there: Mask


@dataclass(frozen=True, eq=False)
class Sampled:
    """Samples of n laws and their further values, shape (n,) each unless given otherwise.

    Driven angles, and the slider's velocities in mm/rad and accelerations in mm/rad^2 of the driving angle, have the
    shape of the samples, displacements in mm that of the first w pieces, which make the working stroke.
    ``closing_error_rad`` is the error of a cycle's angle, from other points than the samples.
    """

    samples: Samples
    driven_rad: Array
    displacement: Array
    velocity: Array
    acceleration: Array
    stroke_mm: Array
    law_speed_rpm: Array
    stroke_error_mm: Array
    closing_error_rad: Array


def refused_at_once(batch: Batch) -> dict[int, DesignError]:
    """Why designs of a batch are refused before their law is closed, by their rows."""
    found = batch.refused_mechanisms()
    if not batch.kind.has_return:
        return found
    found = {**batch.refused_strokes(), **found, **batch.refused_angles()}
    rows = np.setdiff1d(np.arange(len(batch)), list(found))
    if not rows.size:
        return found
    left = _Strokes(batch.kept(rows))
    reasons: dict[int, DesignError] = dict(stroke_refusals(left.requests, left.strokes, batch.output))
    theta4 = left.strokes.theta4_rad
    late = refusals(~(theta4 < left.period_rad), lambda place: require_return(float(theta4[place]), batch.kind.lobes))
    return {**found, **{int(rows[place]): error for place, error in {**late, **reasons}.items()}}


@dataclass(frozen=True)
class Fineness:
    """Fineness of samples: points of a piece, and the shares at which a stroke's approach and return are cut.

    Shares of None cut towards the place of the extreme ratio: there the driven gear's speed may have a peak that fixed
    pieces do not resolve.  It is not tried on laws that a coarser one has missed by more than ``most_missed``.
    """

    count: int
    approach: tuple[float, ...] | None = WHOLE
    returned: tuple[float, ...] | None = THIRDS
    most_missed: float = inf

    def samples(self, kind: BatchKind) -> int:
        """Number of samples of a law."""
        if not kind.has_return:
            return 2 * HARMONIC_PIECES * self.count
        approach, returned = (
            3 * quarterings if cuts is None else len(cuts)
            for cuts, quarterings in ((self.approach, 2 * WORKING_QUARTERINGS), (self.returned, QUARTERINGS))
        )
        return (approach + returned) * self.count


class Laws(ABC):
    """The laws of a batch, which computes values for all blocks and finenesses of samples once."""

    @abstractmethod
    def sampled(self, rows: IndexArray, fineness: Fineness) -> Sampled:
        """Samples of some of the laws."""


def laws_of(batch: Batch) -> Laws:
    """The laws of a batch."""
    return _Strokes(batch) if batch.kind.has_return else _Harmonics(batch)


@dataclass(frozen=True, eq=False)
class _Strokes(Laws):
    """The working strokes of a batch, closed, and their returns."""

    batch: Batch

    @property
    def period_rad(self) -> float:
        """Driving angle of a cycle."""
        return self.batch.kind.lobes.driving_period_rad

    @cached_property
    def requests(self) -> StrokeRequests[Array]:
        """The requests of the files."""
        batch = self.batch
        return StrokeRequests(
            theta1_rad=batch.angle_rad("theta1"),
            theta2_rad=batch.angle_rad("theta2"),
            theta3_rad=batch.angle_rad("theta3"),
            theta4_rad=batch.angle_rad("theta4"),
            v1=batch.given("motion.v1_mm_s"),
            v2=batch.given("motion.v2_mm_s"),
            a1=batch.given("motion.a1_mm_s2"),
            law_speed_rad_s=batch.given("motion.law_speed_rpm", RAD_S_PER_RPM),
            stroke_mm=batch.mechanisms.stroke_mm,
            a1_speed_rad_s=batch.given("motion.a1_speed_rpm", RAD_S_PER_RPM),
        )

    @cached_property
    def strokes(self) -> WorkingStrokes[Array]:
        """The strokes with their free quantity solved for."""
        return closed_strokes(self.requests)

    @cached_property
    def _constant(self) -> Array:
        return self.batch.column("motion.return.e")

    @cached_property
    def _breaks_rad(self) -> Array:
        """Driving angles at which the output passes each place where the force begins or ends, shape (k, n)."""
        segments = list(zip((approach, pressing, braking), _segments(self.strokes, Fineness(0)), strict=True))
        passed = (
            sum(_passed_rad(self.strokes, *segment, kink) for segment in segments) for kink in self.batch.kinks_mm
        )
        return np.array([*passed]).reshape(-1, len(self.batch))

    def sampled(self, rows: IndexArray, fineness: Fineness) -> Sampled:
        """Samples of strokes that advance."""
        strokes, linkage = chosen(self.strokes, rows), chosen(self.batch.mechanisms, rows)
        closed = peaked_returns if fineness.returned is None else returns_with_constant
        points = ReturnGrid(fineness.returned or WHOLE, fineness.count, CLOSING_STEPS)
        returns = closed(strokes, linkage, self.period_rad, self._constant[rows], points)
        return _stroke_laws(strokes, linkage, returns, fineness, points, self._breaks_rad[:, rows])


def _stroke_laws(
    strokes: WorkingStrokes[Array],
    linkage: Mechanisms[Array],
    returns: Returns | PeakedReturns,
    fineness: Fineness,
    points: ReturnGrid,
    breaks_rad: Array,
) -> Sampled:
    """Three-segment strokes with their returns."""
    count = points.count
    worked, edges = _working_strokes(strokes, linkage, fineness, breaks_rad)
    back_rad = returns.widths_rad(points).T
    slope, rate, bend, displacement, speed, change = worked
    ratio, first, second = _returned(returns, points, 2)
    widths = np.concatenate([*(np.diff(edge, axis=0) for edge in edges), back_rad])
    inverse, working = 1.0 / slope, len(slope)
    # d/dphi2 = i d/dphi1, ln i = -ln s
    growth = rate * inverse
    slope = np.concatenate([slope, 1.0 / ratio])
    second *= ratio
    samples = Samples(
        np.concatenate([inverse, ratio]),
        slope,
        np.concatenate([-growth * inverse, first]),
        np.concatenate([(2.0 * growth * growth - bend * inverse) * inverse * inverse, second]),
        turning=slope * widths[:, None],
        there=widths > 0.0,
    )
    # Other points than the samples give the turn of the return.
    (judged,) = _returned(returns, replace(points, count=count + OTHER), 0)
    closing = linkage.working_angle_rad + integrated(back_rad[:, None] / judged) - 2.0 * pi
    driven = integration(count) @ samples.turning
    driven[:working] += _before(driven[:working])
    driven[working:] += _before(driven[working:]) + linkage.working_angle_rad
    back = _moved(linkage, driven[working:], slope[working:], first)
    return Sampled(
        samples,
        driven,
        displacement,
        np.concatenate([speed, back[1]]),
        np.concatenate([change, back[2]]),
        linkage.stroke_mm,
        strokes.law_speed_rad_s / RAD_S_PER_RPM,
        strokes.closing_error_mm,
        closing,
    )


def _before(turned: Array) -> Array:
    """The turn of all pieces before each, shape (p, 1, n), from the turns to the points of each, shape (p, m, n)."""
    return np.cumsum(turned[:, -1:], axis=0) - turned[:, -1:]


def _returned(returns: Returns | PeakedReturns, points: ReturnGrid, order: int) -> list[Array]:
    """The ratio on the returns and its derivatives by the driving angle, shape (p, count, n) each."""
    ratio = returns.polynomial(points, order)
    rows = (ratio.derivative(k).reshape(returns.length_rad.size, -1, points.count) for k in range(order + 1))
    return [np.ascontiguousarray(np.moveaxis(row, 0, -1)) for row in rows]


def _working_strokes(
    strokes: WorkingStrokes[Array], linkage: Mechanisms[Array], fineness: Fineness, breaks_rad: Array
) -> tuple[list[Array], list[Array]]:
    """Three derivatives of the driven angle by the driving angle, the slider's displacement and two derivatives.

    Each has shape (p, m, n).  Besides the driving angles of the ends of the pieces of each segment (shape (p + 1, n)).
    """
    rows, edges = list[list[Array]](), _segments(strokes, fineness)
    for place, way in enumerate((approach, pressing, braking)):
        ends = edges[place] = _broken(edges[place], breaks_rad)
        phi1 = ends[:-1, None] + np.diff(ends, axis=0)[:, None] * shares(fineness.count)[:, None]
        advance = way(strokes, phi1, 2)
        jets = advance.driven_slope(linkage), advance.displacement
        rows.append([jet.derivative(k) for jet in jets for k in range(3)])
    return [np.concatenate(parts) for parts in zip(*rows, strict=True)], edges


def _segments(strokes: WorkingStrokes[Array], fineness: Fineness) -> list[Array]:
    """The driving angles of the ends of pieces of approach, pressing and braking, shape (p + 1, n) each.

    They are cut at the given shares, or towards the least v/phi1 and towards theta4.  There the ratio may be nearly
    singular, as the slider nearly stops, or starts or ends with hardly any acceleration.
    """
    theta2, theta3, theta4 = strokes.theta2_rad, strokes.theta3_rad, strokes.theta4_rad
    cuts = [np.array(fineness_of)[:, None] for fineness_of in (fineness.approach or WHOLE, WHOLE, WHOLE)]
    if fineness.approach is None:
        slowest = _slowest(strokes)
        cuts[0] = slowest + edges_about(slowest, WORKING_QUARTERINGS).T
        # The pieces beyond the end of the braking have no length in any stroke.
        last = edges_about(np.ones(1), WORKING_QUARTERINGS)
        cuts[2] = 1.0 + np.unique(last)[:, None]
    ends = zip((0.0 * theta2, theta2, theta3), (theta2, theta3, theta4), strict=True)
    return [start + (end - start) * cut for (start, end), cut in zip(ends, cuts, strict=True)]


def _broken(ends: Array, breaks_rad: Array) -> Array:
    """Ends of pieces, extended by the angles that lie between them in any stroke."""
    inside = np.any((ends[0] < breaks_rad) & (breaks_rad < ends[-1]), axis=1)
    return np.sort([*ends, *np.clip(breaks_rad[inside], ends[0], ends[-1])], axis=0) if inside.any() else ends


def _passed_rad(strokes: WorkingStrokes[Array], way: Callable[..., Advance], ends: Array, place_mm: float) -> Array:
    """The driving angle of a segment before the output passes a place, shape (n,); all or nothing of other segments."""

    def moved(phi1: Array) -> Array:
        return way(strokes, phi1, 0).displacement.value

    place = np.clip(place_mm, *map(moved, ends))
    return zeros_between(lambda phi1: moved(phi1) - place, *ends) - ends[0]


def _slowest(strokes: WorkingStrokes[Array]) -> Array:
    """The share of theta2 at which v/phi1 is least, shape (n,)."""
    share = np.linspace(0.0, 1.0, GUESSES)
    slope, end = strokes.approach_slope, strokes.theta2_rad
    guess = share[np.argmin(polynomial_at(slope[:, None], end * share[:, None]), axis=0)]
    _, linear, square, cube = slope
    found = guess
    for _ in range(SLOWEST_STEPS):
        at = end * found
        step = (linear + at * (2.0 * square + 3.0 * cube * at)) / (2.0 * square + 6.0 * cube * at) / end
        found = np.clip(np.where(np.isfinite(step), found - step, found), guess - share[1], guess + share[1])
    return np.clip(found, 0.0, 1.0)


def _moved(linkage: Mechanisms[Array], driven_rad: Array, slope: Array, first: Array) -> tuple[Array, Array, Array]:
    """The slider's displacement, velocity and acceleration at driven angles with known ratios, (p, m, n) each.

    v = x' s and a = s^2 (x'' - x' f'), primes by the driven angle.
    """
    motion = linkage.displacement(Jet.variable(driven_rad, 2))
    rate, bend = motion.derivative(1), motion.derivative(2)
    return motion.value, rate * slope, slope * slope * (bend - rate * first)


@dataclass(frozen=True, eq=False)
class _Harmonics(Laws):
    """Harmonics of the ratio; the law holds at any speed, so its own speed is the speed of operation."""

    batch: Batch

    @cached_property
    def _series(self) -> tuple[Array, Array]:
        """Coefficients of cosines and sines, shape (harmonics, n) both."""
        cosine, sine = self.batch.series("cosine"), self.batch.series("sine")
        longest = max(cosine.shape[1], sine.shape[1])
        cosine, sine = (np.pad(series, ((0, 0), (0, longest - series.shape[1]))).T for series in (cosine, sine))
        return cosine, sine

    @cached_property
    def _speed_rpm(self) -> Array:
        return self.batch.column("operation.speed_rpm")

    def sampled(self, rows: IndexArray, fineness: Fineness) -> Sampled:
        """Samples by the driven angle."""
        cosine, sine = (series[:, rows] for series in self._series)
        linkage, lobes, count = chosen(self.batch.mechanisms, rows), self.batch.kind.lobes, fineness.count
        # All mechanisms have the working angle of the first, like crank-sliders without offset.
        working = float(linkage.working_angle_rad[0])
        ways = ((0.0, working), (working, 2.0 * pi))
        out, back = (np.linspace(*ends, HARMONIC_PIECES + 1) for ends in ways)
        ends = np.concatenate([np.sort([*out, *self.batch.kinks_rad]), back[1:]])
        width = np.diff(ends)
        phi2 = ends[:-1, None] + width[:, None] * shares(count)
        log_ratio, first, second = _places(cosine, sine, lobes, phi2, width)
        slope = np.exp(-log_ratio)
        turning = np.broadcast_to(width[:, None, None], slope.shape)
        there = np.ones((len(width), rows.size), dtype=bool)
        samples = Samples(np.exp(log_ratio), slope, first, second, turning, there)
        displacement, velocity, acceleration = _moved(linkage, phi2[..., None], slope, first)
        displacement = np.ascontiguousarray(np.broadcast_to(displacement, slope.shape)[:-HARMONIC_PIECES])
        # The samples' ln i12 at phi2 = 0 holds the constant that closes the law; even places around a turn judge it.
        places = 2.0 * pi * (np.arange(EVEN_PLACES * count) + OFF) / (EVEN_PLACES * count)
        constant = log_ratio[0, 0] - cosine.sum(axis=0)
        turned = places[:, None] * np.arange(1.0, len(cosine) + 1.0) * lobes.driven
        mean = np.exp(constant + np.cos(turned) @ cosine + np.sin(turned) @ sine).mean(axis=0)
        closing = 2.0 * pi * (1.0 - mean * lobes.driving / lobes.driven)
        speed = self._speed_rpm[rows]
        stroke = np.broadcast_to(linkage.stroke_mm, speed.shape)
        driven = np.broadcast_to(phi2[..., None], slope.shape)
        return Sampled(samples, driven, displacement, velocity, acceleration, stroke, speed, 0.0 * speed, closing)


def _places(cosine: Array, sine: Array, lobes: Lobes, phi2: Array, width: Array) -> tuple[Array, Array, Array]:
    """ln i12 with two derivatives by phi2, shape (p, m, n); it closes where the mean of i12 over phi2 is n2 / n1.

    ``cosine`` and ``sine`` have shape (harmonics, n).
    """
    wave = np.arange(1.0, len(cosine) + 1.0)[:, None] * lobes.driven
    turned = phi2.ravel()[:, None] * wave[:, 0]
    in_phase, quarter_on = np.cos(turned), np.sin(turned)
    rows = (
        in_phase @ cosine + quarter_on @ sine,
        in_phase @ (wave * sine) - quarter_on @ (wave * cosine),
        -(in_phase @ (wave**2 * cosine) + quarter_on @ (wave**2 * sine)),
    )
    series, first, second = (row.reshape(*phi2.shape, -1) for row in rows)
    mean = width @ (integration(phi2.shape[1])[-1] @ np.exp(series)) / (2.0 * pi)
    return series + (log(lobes.driven / lobes.driving) - np.log(mean)), first, second
