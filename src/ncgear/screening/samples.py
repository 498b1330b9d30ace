"""Designs of one kind as sampled laws: ratio and motion of the slider at Chebyshev points of pieces of the cycle.

Designs of a kind are computed together.  Three-segment strokes are cut at their joints and their returns into equal
pieces of the driving angle; the equations are those of ``ratio/laws/three_segment.py``, which makes one law.  Harmonic
laws are cut by the driven angle, in which everything is smooth and the dead centres are known; the equations are those
of ``ratio/laws/harmonic.py``.  A design of which a batch cannot be sure is not ``sound`` and is computed by itself.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable, Sequence
from dataclasses import dataclass, replace
from math import log, pi
from operator import attrgetter
from typing import Any

import numpy as np

from ncgear.design.keys.base import Model
from ncgear.design.keys.design import Design
from ncgear.design.laws.harmonic_ratio import HarmonicRatio
from ncgear.design.laws.three_segment_stroke import SAME_STROKE, ThreeSegmentStroke
from ncgear.design.mechanisms import entry_of, mechanisms_of
from ncgear.mechanisms.mechanism import Mechanisms
from ncgear.mechanisms.resistance import Resistance, TableResistance
from ncgear.numerics.arrays import Array, Mask, repeated
from ncgear.numerics.jet import Jet
from ncgear.numerics.sampled import extremes, integrated, integration, shares
from ncgear.numerics.units import RAD_S_PER_RPM
from ncgear.optimum.makeable.quantities import Place, Slider, acceleration, velocity
from ncgear.project.law import load_of, lobes_of
from ncgear.ratio.laws.three_segment import approach_angle, braking_angle, pressing_angle
from ncgear.ratio.sampled_strokes import (
    Motion,
    Points,
    ReturnSamples,
    return_samples,
    returns_with_constant,
    working_motions,
)
from ncgear.ratio.transmission import Lobes
from ncgear.ratio.working_stroke import StrokeRequests, WorkingStrokes, closed_strokes, polynomial_at

STROKE, HARMONIC = "three_segment_stroke", "harmonic_ratio"

RETURN_PIECES = 3
"""Equal pieces that a return is cut into: where its ratio is small, a polynomial's inverse varies fast."""

CLOSING_STEPS = 24
"""Newton's steps that close a return; some ten are needed from a start next to a zero of the polynomial."""

CLEAR = 1e-9
"""Share of its largest value by which v/phi1 must stay over zero: a million rounding errors.  What is nearer to zero is
left to the solver of one stroke."""

HARMONIC_PIECES = 4
"""Equal pieces of the working stroke, and of the return."""

OTHER = 6
"""How many more points of a piece judge whether a stroke closes."""

EVEN_PLACES, OFF = 16, 0.618
"""Even places around a turn for each point of a piece, all of them this share of a step off, that judge whether a
harmonic law closes."""


@dataclass(frozen=True)
class Kind:
    """What the designs of one batch share; ``linkage`` is the model of its mechanism's keys."""

    linkage: type[Model]
    law: tuple[Hashable, ...]
    lobes: Lobes
    resistance: Resistance


def kind_of(design: Design) -> Kind | None:
    """The batch that a design belongs to; None where it must be computed by itself."""
    law = _law(design)
    # Batches know outputs that slide and return.
    if law is None or entry_of(design.linkage).turns or (design.gears is not None and design.gears.mesh == "internal"):
        return None
    load = load_of(design)
    if load.loads_return or isinstance(load.working, TableResistance):
        # Batches know the displacement in the working stroke only.  The bend of a table's force jumps at its points,
        # which no series along a piece resolves.
        return None
    return Kind(type(design.linkage), law, lobes_of(design), load.working)


def _law(design: Design) -> tuple[Hashable, ...] | None:
    motion = design.motion
    if isinstance(motion, ThreeSegmentStroke):
        if motion.solve_for == "stroke" or motion.return_.e == "least_acceleration":
            return None
        return STROKE, motion.solve_for, motion.a1_speed_rpm is None, motion.stroke_mm is None
    if isinstance(motion, HarmonicRatio) and motion.second_stage is None and (motion.cosine or motion.sine):
        # A batch of harmonic laws shares the working angle; None stands for cranks that cannot turn.
        linkage = mechanisms_of([design.linkage])
        return HARMONIC, float(linkage.working_angle_rad[0]) if linkage.turns_fully[0] else None
    return None


@dataclass(frozen=True, eq=False)
class Samples:
    """n laws over one cycle of the slider, cut into p pieces of m points each; arrays have shape (n, p, m).

    ``at`` holds ln i12 and what follows from it; velocities are in mm/rad and accelerations in mm/rad^2 of the driving
    angle.  ``displacement_mm`` (shape (n, w, m)) covers the first w pieces, which make the working stroke.
    ``turning`` is the driven angle per share of the piece, ``there`` (shape (n, p)) where a piece has any length,
    ``sound`` (shape (n,)) where the law is known to be one.
    """

    at: Place
    velocity: Array
    acceleration: Array
    displacement_mm: Array
    turning: Array
    there: Mask
    sound: Mask


@dataclass(frozen=True, eq=False)
class Sampled:
    """Samples of n laws and what is known of them besides, shape (n,) each.

    ``sound`` says where the design is known to be one.  ``closing_error_rad`` is by how much a cycle misses its angle,
    from other points than the samples.
    """

    samples: Samples
    sound: Mask
    stroke_mm: Array
    law_speed_rpm: Array
    stroke_error_mm: Array
    closing_error_rad: Array


def sampled(kind: Kind, designs: Sequence[Design], count: int) -> Sampled:
    """The laws of a batch at ``count`` points a piece."""
    return _strokes(kind, designs, count) if kind.law[0] == STROKE else _harmonics(kind, designs, count)


def _strokes(kind: Kind, designs: Sequence[Design], count: int) -> Sampled:
    """Three-segment strokes; a stroke that ``project/law.py`` would refuse is not ``sound``."""
    linkage = mechanisms_of([design.linkage for design in designs])
    stroke_mm, period = linkage.stroke_mm, kind.lobes.driving_period_rad
    strokes = closed_strokes(_requests(designs, stroke_mm))
    points = Points(RETURN_PIECES, count, CLOSING_STEPS)
    returns = returns_with_constant(strokes, linkage, period, _column(designs, "motion.return_.e"), points)
    sound = linkage.turns_fully & (strokes.theta4_rad < period)
    given_mm = _given(designs, "stroke_mm")
    if given_mm is not None:
        sound &= np.isclose(given_mm, stroke_mm, rtol=SAME_STROKE / 2.0, atol=0.0)
    samples = _stroke_samples(strokes, linkage, return_samples(returns, linkage, points, 2), returns.length_rad)
    judge = replace(points, count=count + OTHER)
    judged = _stroke_samples(strokes, linkage, return_samples(returns, linkage, judge, 2), returns.length_rad)
    closing = integrated(judged.turning) - 2.0 * pi
    speed_rpm = strokes.law_speed_rad_s / RAD_S_PER_RPM
    return Sampled(samples, sound, stroke_mm, speed_rpm, strokes.closing_error_mm, closing)


def _requests(designs: Sequence[Design], stroke_mm: Array) -> StrokeRequests[Array]:
    theta1, theta2, theta3, theta4 = (_column(designs, f"motion.theta{number}") for number in (1, 2, 3, 4))
    return StrokeRequests(
        theta1_rad=theta1,
        theta2_rad=theta2,
        theta3_rad=theta3,
        theta4_rad=theta4,
        v1_mm_s=_given(designs, "v1_mm_s"),
        v2_mm_s=_given(designs, "v2_mm_s"),
        a1_mm_s2=_given(designs, "a1_mm_s2"),
        law_speed_rad_s=_given(designs, "law_speed_rpm", RAD_S_PER_RPM),
        stroke_mm=stroke_mm,
        a1_speed_rad_s=_given(designs, "a1_speed_rpm", RAD_S_PER_RPM),
    )


def _given(designs: Sequence[Design], name: str, unit: float = 1.0) -> Array | None:
    """A value of the motion, shape (n,); None where no design of the batch gives it, for all do or none does."""
    if getattr(designs[0].motion, name) is None:
        return None
    return _column(designs, f"motion.{name}") * unit


def _stroke_samples(
    strokes: WorkingStrokes[Array], linkage: Mechanisms[Array], back: ReturnSamples, length_rad: Array
) -> Samples:
    """The working stroke's segments and the pieces of a return of ``length_rad``, as many points each."""
    pieces, count = back.velocity.shape[1:]
    width2, width3 = strokes.theta3_rad - strokes.theta2_rad, strokes.theta4_rad - strokes.theta3_rad
    starts, widths = (0.0 * width2, strokes.theta2_rad, strokes.theta3_rad), (strokes.theta2_rad, width2, width3)
    angles = (approach_angle, pressing_angle, braking_angle)
    many, linkages = repeated(strokes, count), repeated(linkage, count)
    places = []
    for angle, start, width in zip(angles, starts, widths, strict=True):
        phi1 = start[:, None] + width[:, None] * shares(count)
        driven = angle(many, linkages, phi1.ravel(), 3)
        places.append(_place_of(*(driven.derivative(k).reshape(phi1.shape) for k in (1, 2, 3))))
    out = (np.stack(column, axis=1) for column in zip(*places, strict=True))
    home = _place_of(*back.slopes)
    at = Place(*(np.concatenate(columns, axis=1) for columns in zip(out, home, strict=True)))
    approach, pressing, braking = working_motions(strokes, (count, count, count))
    forwards = Motion(*(values[:, ::-1] for values in braking))
    displacement, speed, change = (np.stack(parts, axis=1) for parts in zip(approach, pressing, forwards, strict=True))
    every = np.stack([*widths, *[length_rad / pieces] * pieces], axis=1)
    return Samples(
        at=at,
        velocity=np.concatenate([speed, back.velocity], axis=1),
        acceleration=np.concatenate([change, back.acceleration], axis=1),
        displacement_mm=displacement,
        turning=at.slope * every[..., None],
        there=every > 0.0,
        sound=_sound(strokes, count),
    )


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


def _sound(strokes: WorkingStrokes[Array], count: int) -> Mask:
    """Whether the slider advances all the way, by far more than rounding, as ``ratio/working_stroke.py`` demands."""
    positive = (strokes.v1_mm_s > 0.0) & (strokes.v2_mm_s > 0.0) & (strokes.a1_mm_s2 < 0.0)
    finite = (strokes.law_speed_rad_s > 0.0) & np.isfinite(strokes.law_speed_rad_s)
    slope = polynomial_at(strokes.approach_slope[..., None], strokes.theta2_rad[:, None] * shares(count))
    known = positive & finite & np.isfinite(slope).all(axis=1)
    low, high = extremes(np.where(known[:, None], slope, 1.0), np.arange(known.size))
    sound: Mask = known & (low > CLEAR * high)
    return sound


def _harmonics(kind: Kind, designs: Sequence[Design], count: int) -> Sampled:
    """Harmonics of the ratio; the law holds at any speed, so its own speed is the speed of operation."""
    cosine, sine = _padded(designs, "motion.cosine", "motion.sine")
    linkage = mechanisms_of([design.linkage for design in designs])
    samples = _harmonic_samples(cosine, sine, linkage, kind.lobes, count)
    speed = _column(designs, "operation.speed_rpm")
    # The samples' ln i12 at phi2 = 0 holds the constant that closes the law; even places around a turn judge it.
    places = 2.0 * pi * (np.arange(EVEN_PLACES * count) + OFF) / (EVEN_PLACES * count)
    constant = samples.at.log[:, 0, 0] - cosine.sum(axis=1)
    turned = np.arange(1.0, cosine.shape[1] + 1.0)[:, None] * kind.lobes.driven * places
    mean = np.exp(constant[:, None] + cosine @ np.cos(turned) + sine @ np.sin(turned)).mean(axis=1)
    closing = 2.0 * pi * (1.0 - mean * kind.lobes.driving / kind.lobes.driven)
    return Sampled(samples, linkage.turns_fully, linkage.stroke_mm, speed, 0.0 * speed, closing)


def _padded(designs: Sequence[Design], *names: str) -> list[Array]:
    """Lists of numbers as rows, shape (n, longest of them) for each name, zeros where they are shorter."""
    lists = [[attrgetter(name)(design) for design in designs] for name in names]
    longest = max(len(values) for column in lists for values in column)
    return [np.array([[*values, *[0.0] * (longest - len(values))] for values in column]) for column in lists]


def _harmonic_samples(cosine: Array, sine: Array, linkage: Mechanisms[Array], lobes: Lobes, count: int) -> Samples:
    """Laws of coefficients of shape (n, harmonics) at ``count`` points a piece.

    The mechanisms (shape (n,)) must all have the first one's working angle, as crank-sliders without offset do.
    """
    phi2, width = _angles(float(linkage.working_angle_rad[0]), count)
    at = _places(cosine, sine, lobes, phi2, width)
    everywhere = np.broadcast_to(phi2, at.log.shape)
    motion = repeated(linkage, phi2.size).displacement(Jet.variable(everywhere.ravel(), 2))
    displacement, first, second = (motion.derivative(k).reshape(everywhere.shape) for k in (0, 1, 2))
    slider = Slider(first, second, third=0.0, force_n=0.0)
    there = np.ones(everywhere.shape[:2], dtype=bool)
    return Samples(
        at,
        velocity(at, slider, 1.0),
        acceleration(at, slider, 1.0),
        displacement[:, :HARMONIC_PIECES],
        np.broadcast_to(width[:, None], everywhere.shape),
        there,
        there[:, 0],
    )


def _angles(working_rad: float, count: int) -> tuple[Array, Array]:
    """phi2 at the points of the pieces, shape (p, count), and the pieces' widths, shape (p,)."""
    width = np.repeat([working_rad / HARMONIC_PIECES, (2.0 * pi - working_rad) / HARMONIC_PIECES], HARMONIC_PIECES)
    return (np.cumsum(width) - width)[:, None] + width[:, None] * shares(count), width


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


def _column(designs: Sequence[Design], name: str) -> Array:
    """The values at a dotted name, shape (n,)."""
    value: Callable[[Any], float] = attrgetter(name)
    return np.array([value(design) for design in designs], dtype=float)
