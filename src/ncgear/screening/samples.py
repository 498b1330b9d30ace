"""Designs of one kind as sampled laws: ratio and motion of the slider at Chebyshev points of pieces of the cycle.

Designs of a kind are computed together.  Three-segment strokes are cut at their joints and their returns into equal
pieces of the driving angle; the equations are those of ``ratio/laws/three_segment.py``, which makes one law.  Harmonic
laws are cut by the driven angle, in which everything is smooth and the dead centres are known; the equations are those
of ``ratio/laws/harmonic.py``.  A design of which a batch cannot be sure is not ``sound`` and is computed by itself.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import cached_property
from math import log, pi
from typing import Any

import numpy as np

from ncgear.errors import DesignError
from ncgear.frozen import dataclass
from ncgear.mechanisms.mechanism import Mechanisms
from ncgear.numerics.arrays import Array, IndexArray, Mask, chosen, repeated
from ncgear.numerics.jet import Jet
from ncgear.numerics.sampled import integrated, integration, shares
from ncgear.numerics.units import RAD_S_PER_RPM
from ncgear.optimum.makeable.quantities import Place, Slider, acceleration, velocity
from ncgear.ratio.laws.three_segment import approach_angle, braking_angle, pressing_angle, require_return
from ncgear.ratio.sampled_strokes import (
    QUARTERINGS,
    ReturnGrid,
    SampledMotion,
    edges_about,
    peaked_returns,
    returns_with_constant,
    working_motions_at,
)
from ncgear.ratio.transmission import Lobes
from ncgear.ratio.working_stroke import StrokeRequests, WorkingStrokes, closed_strokes, polynomial_at, stroke_refusals
from ncgear.screening.batch import Batch, BatchKind, refusals

WHOLE = 0.0, 1.0
"""Ends of the one piece of an approach."""

THIRDS = 0.0, 1.0 / 3.0, 2.0 / 3.0, 1.0
"""Ends of the pieces of a return: where its ratio is small, a polynomial's inverse varies fast."""

CLOSING_STEPS = 24
"""Newton's steps that close a return; some ten are needed from a start next to a zero of the polynomial."""

WORKING_QUARTERINGS = 5
"""Quarterings of approach and braking towards where the slider hardly moves."""

GUESSES = 65
"""Even places of the approach among which the first guess is of where it moves least."""

SLOWEST_STEPS = 4
"""Newton's steps from there."""

HARMONIC_PIECES = 4
"""Equal pieces of the working stroke, and of the return."""

OTHER = 6
"""How many more points of a piece judge whether a stroke closes."""

EVEN_PLACES, OFF = 16, 0.618
"""Even places around a turn for each point of a piece, all of them this share of a step off, that judge whether a
harmonic law closes."""


@dataclass(frozen=True, eq=False)
class Samples:
    """n laws over one cycle of the slider, cut into p pieces of m points each; arrays have shape (n, p, m).

    ``at`` holds ln i12 and what follows from it.  ``turning`` is the driven angle per share of the piece, ``there``
    (shape (n, p)) where a piece has any length.
    """

    at: Place
    turning: Array
    there: Mask

    def kept(self, rows: IndexArray) -> Samples:
        """Some of the laws."""
        return Samples(Place(*(values[rows] for values in self.at)), self.turning[rows], self.there[rows])


@dataclass(frozen=True, eq=False)
class Sampled:
    """Samples of n laws and what is known of them besides, shape (n,) each.

    ``motion`` gives the slider's motion of some laws by their rows: velocities in mm/rad and accelerations in mm/rad^2
    of the driving angle, and displacements on the first w pieces, which make the working stroke, shape (k, w, m).
    ``closing_error_rad`` is by how much a cycle misses its angle, from other points than the samples.
    """

    samples: Samples
    motion: Callable[[IndexArray], SampledMotion]
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
    """How finely laws are sampled: points of a piece, and the shares at which a stroke's approach and return are cut.

    None cuts towards the place where the ratio is extreme: there the driven gear's speed may have a peak that fixed
    pieces do not resolve.
    """

    count: int
    approach: tuple[float, ...] | None = WHOLE
    returned: tuple[float, ...] | None = THIRDS

    @property
    def for_strokes(self) -> bool:
        """Whether it differs from one of as many points by its cuts of three-segment strokes alone."""
        return self.approach != WHOLE or self.returned != THIRDS

    def samples(self, kind: BatchKind) -> int:
        """How many samples a law has."""
        if not kind.has_return:
            return 2 * HARMONIC_PIECES * self.count
        approach, returned = (
            3 * quarterings if cuts is None else len(cuts)
            for cuts, quarterings in ((self.approach, 2 * WORKING_QUARTERINGS), (self.returned, QUARTERINGS))
        )
        return (approach + returned) * self.count


def sampled(batch: Batch, fineness: Fineness) -> Sampled:
    """The laws of a batch."""
    if batch.kind.has_return:
        return _stroke_laws(_Strokes(batch), fineness)
    return _harmonics(batch, fineness.count)


@dataclass(frozen=True, eq=False)
class _Strokes:
    """The working strokes of a batch, closed."""

    batch: Batch

    @property
    def period_rad(self) -> float:
        """Driving angle of a cycle."""
        return self.batch.kind.lobes.driving_period_rad

    @cached_property
    def requests(self) -> StrokeRequests[Array]:
        """What the files ask for."""
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


def _stroke_laws(laws: _Strokes, fineness: Fineness) -> Sampled:
    """Three-segment strokes that advance."""
    strokes, linkage, count = laws.strokes, laws.batch.mechanisms, fineness.count
    closed = peaked_returns if fineness.returned is None else returns_with_constant
    points = ReturnGrid(fineness.returned or WHOLE, count, CLOSING_STEPS)
    returns = closed(strokes, linkage, laws.period_rad, laws.batch.column("motion.return.e"), points)
    segments, back_rad = _segments(strokes, fineness), returns.widths_rad(points)
    places = [segment.place(strokes, linkage, count) for segment in segments]
    places.append(_return_place(returns.polynomial(points, 2), (*back_rad.shape, count)))
    at = Place(*(np.concatenate(columns, axis=1) for columns in zip(*places, strict=True)))
    widths = np.concatenate([*(segment.widths_rad for segment in segments), back_rad], axis=1)
    samples = Samples(at, turning=at.slope * widths[..., None], there=widths > 0.0)
    # The working stroke turns by what the angle differs at its ends; other points than those of the samples tell what
    # the return turns by.
    judges = replace(points, count=count + OTHER)
    ratio = returns.polynomial(judges, 1).value.reshape(*back_rad.shape, judges.count)
    closing = integrated(back_rad[..., None] / ratio) - 2.0 * pi
    for segment in segments:
        closing = closing + segment.turned_rad(strokes, linkage)

    def motion(rows: IndexArray) -> SampledMotion:
        kept = [replace(segment, edges_rad=segment.edges_rad[rows]) for segment in segments]
        return _stroke_motion(chosen(strokes, rows), chosen(linkage, rows), kept, samples.kept(rows))

    speed_rpm = strokes.law_speed_rad_s / RAD_S_PER_RPM
    return Sampled(samples, motion, linkage.stroke_mm, speed_rpm, strokes.closing_error_mm, closing)


@dataclass(frozen=True, eq=False)
class _Segment:
    """A segment of the working strokes, cut into p pieces; ``edges_rad`` are the driving angles of their ends."""

    angle: Any
    edges_rad: Array

    def phi1_rad(self, count: int) -> Array:
        """The driving angles at the points of the pieces, shape (n, p, count)."""
        found: Array = self.edges_rad[:, :-1, None] + self.widths_rad[..., None] * shares(count)
        return found

    @property
    def widths_rad(self) -> Array:
        """The pieces' widths, shape (n, p)."""
        widths: Array = np.diff(self.edges_rad, axis=1)
        return widths

    def place(self, strokes: WorkingStrokes[Array], linkage: Mechanisms[Array], count: int) -> Place:
        """The ratio at the points of the pieces, shape (n, p, count) each."""
        phi1 = self.phi1_rad(count)
        driven = self._driven(strokes, linkage, phi1, 3)
        return _place_of(*(driven.derivative(k).reshape(phi1.shape) for k in (1, 2, 3)))

    def turned_rad(self, strokes: WorkingStrokes[Array], linkage: Mechanisms[Array]) -> Array:
        """The driven angle from the first to the last end, shape (n,)."""
        start, end = self._driven(strokes, linkage, self.edges_rad[:, [0, -1], None], 0).value.reshape(-1, 2).T
        turned: Array = end - start
        return turned

    def _driven(self, strokes: WorkingStrokes[Array], linkage: Mechanisms[Array], phi1: Array, order: int) -> Jet:
        each = phi1.shape[1] * phi1.shape[2]
        driven: Jet = self.angle(repeated(strokes, each), repeated(linkage, each), phi1.ravel(), order)
        return driven


def _segments(strokes: WorkingStrokes[Array], fineness: Fineness) -> list[_Segment]:
    """Approach, pressing and braking, cut as asked for, or towards where v/phi1 is least and towards theta4.

    There the ratio may be nearly singular, as the slider nearly stops, or starts or ends with hardly any acceleration.
    """
    theta2, theta3, theta4 = strokes.theta2_rad, strokes.theta3_rad, strokes.theta4_rad
    cuts = [np.array(one)[None, :] for one in (fineness.approach or WHOLE, WHOLE, WHOLE)]
    if fineness.approach is None:
        slowest = _slowest(strokes)
        cuts[0] = slowest[:, None] + edges_about(slowest, WORKING_QUARTERINGS)
        # The pieces beyond the end of the braking have no length in any stroke.
        last = edges_about(np.ones(1), WORKING_QUARTERINGS)
        cuts[2] = 1.0 + np.unique(last)[None, :]
    ends = zip((0.0 * theta2, theta2, theta3), (theta2, theta3, theta4), strict=True)
    angles = approach_angle, pressing_angle, braking_angle
    return [
        _Segment(angle, start[:, None] + (end - start)[:, None] * cut)
        for angle, (start, end), cut in zip(angles, ends, cuts, strict=True)
    ]


def _slowest(strokes: WorkingStrokes[Array]) -> Array:
    """The share of theta2 at which v/phi1 is least, shape (n,)."""
    share = np.linspace(0.0, 1.0, GUESSES)
    slope, end = strokes.approach_slope, strokes.theta2_rad
    guess = share[np.argmin(polynomial_at(slope[..., None], end[:, None] * share), axis=1)]
    _, linear, square, cube = slope
    found = guess
    for _ in range(SLOWEST_STEPS):
        at = end * found
        step = (linear + at * (2.0 * square + 3.0 * cube * at)) / (2.0 * square + 6.0 * cube * at) / end
        found = np.clip(np.where(np.isfinite(step), found - step, found), guess - share[1], guess + share[1])
    slowest: Array = np.clip(found, 0.0, 1.0)
    return slowest


def _stroke_motion(
    strokes: WorkingStrokes[Array], linkage: Mechanisms[Array], segments: list[_Segment], samples: Samples
) -> SampledMotion:
    """The slider's motion by the segments' own polynomials, and on the return by the driven angle."""
    laws, _, count = samples.turning.shape
    phi1, pressing, braking = (segment.phi1_rad(count) for segment in segments)
    beyond, before = pressing - strokes.theta2_rad[:, None, None], strokes.theta4_rad[:, None, None] - braking
    motions = working_motions_at(strokes, *(angles.reshape(laws, -1) for angles in (phi1, beyond, before)))
    displacement, speed, change = (
        np.concatenate([part.reshape(laws, -1, count) for part in parts], axis=1)
        for parts in zip(*motions, strict=True)
    )
    working = displacement.shape[1]
    turned = samples.turning[:, working:] @ integration(count).T
    before = np.cumsum(turned[..., -1:], axis=1) - turned[..., -1:]
    driven = turned + before + np.reshape(linkage.working_angle_rad, (-1, 1, 1))
    back = _moved(linkage, driven, Place(*(values[:, working:] for values in samples.at)))
    return SampledMotion(
        displacement,
        np.concatenate([speed, back.velocity], axis=1),
        np.concatenate([change, back.acceleration], axis=1),
    )


def _moved(linkage: Mechanisms[Array], driven_rad: Array, at: Place) -> SampledMotion:
    """The slider's motion at driven angles of shape (n, p, count), where the ratio is known."""
    motion = repeated(linkage, driven_rad[0].size).displacement(Jet.variable(driven_rad.ravel(), 2))
    displacement, first, second = (motion.derivative(k).reshape(driven_rad.shape) for k in range(3))
    slider = Slider(first, second, third=0.0, force_n=0.0)
    return SampledMotion(displacement, velocity(at, slider, 1.0), acceleration(at, slider, 1.0))


def _place_of(slope: Array, first: Array, second: Array) -> Place:
    """The ratio from dphi2/dphi1 and its derivatives by phi1: d/dphi2 = i d/dphi1, ln i = -ln s."""
    ratio = 1.0 / slope
    return Place(
        log=np.log(ratio),
        ratio=ratio,
        slope=slope,
        first=-first * ratio**2,
        second=(2.0 * first**2 * ratio - second) * ratio**3,
    )


def _return_place(ratio: Jet, shape: tuple[int, ...]) -> Place:
    """The ratio from its derivatives by phi1: d ln i/dphi2 = di/dphi1, d2 ln i/dphi2^2 = i d2i/dphi1^2."""
    value, first, second = (ratio.derivative(k).reshape(shape) for k in range(3))
    return Place(np.log(value), value, 1.0 / value, first, value * second)


def _harmonics(batch: Batch, count: int) -> Sampled:
    """Harmonics of the ratio; the law holds at any speed, so its own speed is the speed of operation."""
    cosine, sine = batch.series("cosine"), batch.series("sine")
    longest = max(cosine.shape[1], sine.shape[1])
    cosine, sine = (np.pad(one, ((0, 0), (0, longest - one.shape[1]))) for one in (cosine, sine))
    linkage, lobes = batch.mechanisms, batch.kind.lobes
    # The mechanisms all have the first one's working angle, as crank-sliders without offset do.
    working = float(linkage.working_angle_rad[0])
    width = np.repeat([working / HARMONIC_PIECES, (2.0 * pi - working) / HARMONIC_PIECES], HARMONIC_PIECES)
    phi2 = (np.cumsum(width) - width)[:, None] + width[:, None] * shares(count)
    at = _places(cosine, sine, lobes, phi2, width)
    turning = np.broadcast_to(width[:, None], at.ratio.shape)
    samples = Samples(at, turning, there=np.ones(turning.shape[:2], dtype=bool))

    def motion(rows: IndexArray) -> SampledMotion:
        kept = samples.kept(rows).at
        moved = _moved(chosen(linkage, rows), np.broadcast_to(phi2, kept.ratio.shape), kept)
        return moved._replace(displacement=moved.displacement[:, :HARMONIC_PIECES])

    speed = batch.column("operation.speed_rpm")
    # The samples' ln i12 at phi2 = 0 holds the constant that closes the law; even places around a turn judge it.
    places = 2.0 * pi * (np.arange(EVEN_PLACES * count) + OFF) / (EVEN_PLACES * count)
    constant = samples.at.log[:, 0, 0] - cosine.sum(axis=1)
    turned = np.arange(1.0, cosine.shape[1] + 1.0)[:, None] * lobes.driven * places
    mean = np.exp(constant[:, None] + cosine @ np.cos(turned) + sine @ np.sin(turned)).mean(axis=1)
    closing = 2.0 * pi * (1.0 - mean * lobes.driving / lobes.driven)
    return Sampled(samples, motion, linkage.stroke_mm, speed, 0.0 * speed, closing)


def _places(cosine: Array, sine: Array, lobes: Lobes, phi2: Array, width: Array) -> Place:
    """ln i12 with two derivatives by phi2; it closes where the mean of i12 over phi2 is n2 / n1."""
    wave = np.arange(1.0, cosine.shape[1] + 1.0) * lobes.driven
    turned = wave[:, None] * phi2.ravel()
    in_phase, quarter_on = np.cos(turned), np.sin(turned)
    rows = (
        cosine @ in_phase + sine @ quarter_on,
        (wave * sine) @ in_phase - (wave * cosine) @ quarter_on,
        -((wave**2 * cosine) @ in_phase + (wave**2 * sine) @ quarter_on),
    )
    series, first, second = (row.reshape(-1, *phi2.shape) for row in rows)
    mean = (np.exp(series) @ integration(phi2.shape[1])[-1]) @ width / (2.0 * pi)
    log_ratio = series + (log(lobes.driven / lobes.driving) - np.log(mean))[:, None, None]
    return Place(log_ratio, np.exp(log_ratio), np.exp(-log_ratio), first, second)
