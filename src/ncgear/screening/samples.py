"""What a batch of laws comes to: ratio and motion of the slider at Chebyshev points of each piece of the cycle.

The returns of many three-segment strokes, closed to rounding; equations as in ``ratio/compensation/``.

Many laws of the three-segment stroke at once, sampled; each step as one law is made in ``ratio/laws``.

Many laws by harmonics of their ratio at once, sampled over the driven angle.

Equations as in ``ratio/laws/harmonic.py``.  All is smooth in the driven angle phi2, and the linkage knows its dead
centres there, so the pieces are cut by it.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, fields, replace
from math import log, pi
from typing import Any, TypeVar

import numpy as np

from ncgear.mechanisms.mechanism import Mechanisms
from ncgear.numerics import jet
from ncgear.numerics.arrays import Array, Mask
from ncgear.numerics.jet import Jet
from ncgear.numerics.sampled import extremes, integration, shares
from ncgear.optimum.family.samples import ends_of, harmonic_lift, hermite
from ncgear.optimum.makeable.quantities import Place, Slider, acceleration, velocity
from ncgear.ratio.laws.three_segment import approach_angle, braking_angle, pressing_angle
from ncgear.ratio.transmission import Lobes
from ncgear.ratio.working_stroke import WorkingStrokes

Rows = TypeVar("Rows")


@dataclass(frozen=True, eq=False)
class Samples:
    """n laws over one cycle of the slider, cut into p pieces of m points each; arrays have shape (n, p, m).

    ``at`` holds ln i12 and what follows from it; velocities are in mm/rad and accelerations in mm/rad^2 of the driving
    angle.  ``displacement_mm`` (shape (n, w, m)) is that of the first w pieces, which make the working stroke.
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


def place_of(slope: Array, first: Array, second: Array) -> Place:
    """The ratio from dphi2/dphi1 and its derivatives by phi1: d/dphi2 = i d/dphi1, ln i = -ln s."""
    ratio = 1.0 / slope
    return Place(
        log=np.log(ratio),
        ratio=ratio,
        slope=slope,
        first=-first * ratio**2,
        second=(2.0 * first**2 * ratio - second) * ratio**3,
    )


def stacked(places: list[Place]) -> Place:
    """Places of shape (n, m) as pieces, shape (n, p, m)."""
    return Place(*(np.stack(column, axis=1) for column in zip(*places, strict=True)))


def repeated(many: Any, count: int) -> Any:
    """A dataclass whose arrays count designs along their last axis, each design ``count`` times."""
    return replace(many, **{key: np.repeat(value, count, axis=-1) for key, value in _arrays(many).items()})


def _arrays(many: Any) -> dict[str, Array]:
    values = {field.name: getattr(many, field.name) for field in fields(many)}
    return {name: value for name, value in values.items() if isinstance(value, np.ndarray)}


@dataclass(frozen=True, eq=False)
class Sampled:
    """Samples of n laws and what is known of them besides, shape (n,) each.

    ``sound`` says where the design is known to be one.
    """

    samples: Samples
    sound: Mask
    stroke_mm: Array
    law_speed_rpm: Array
    stroke_error_mm: Array


CLOSING_STEPS = 24
"""Newton's steps on the harmonic mean; from next to a zero of the polynomial some ten are needed."""

PIECES = 3
"""Equal pieces of tau that a return is cut into: where its ratio is small, a polynomial's inverse varies fast."""

BUMP = np.array([0.0, 0.0, 1.0, -2.0, 1.0, 0.0])
"""tau^2 (1 - tau)^2, which changes neither end."""


@dataclass(frozen=True, eq=False)
class Returns:
    """i12 as polynomials in tau (shape (6, n)) on returns of ``length_rad`` (shape (n,)) of the driving angle."""

    polynomial: Array
    length_rad: Array

    def slopes(self, count: int) -> tuple[Array, Array, Array]:
        """dphi2/dphi1 and two derivatives by phi1 at Chebyshev points of each piece, shape (n, PIECES, count)."""
        length = self.length_rad[:, None, None]
        value, first, second = _derivatives(self.polynomial, count)
        first, second = first / length, second / length**2
        return 1.0 / value, -first / value**2, 2.0 * first**2 / value**3 - second / value**2


def returns_with_constant(
    strokes: WorkingStrokes[Array], linkage: Mechanisms[Array], period_rad: float, constant: Array, count: int
) -> Returns:
    """i12 polynomials whose value extrapolated to phi1 = 0 is ``constant`` (shape (n,)), the published method's e."""
    length = period_rad - strokes.theta4_rad
    cubic = _with_ends(strokes, linkage, length)
    origin = -strokes.theta4_rad / length
    bump = origin**2 * (1.0 - origin) ** 2
    base = cubic + BUMP[:, None] * ((constant - _value(cubic, origin)) / bump)
    direction = np.roll(BUMP, 1)[:, None] - BUMP[:, None] * origin
    return _closed(base, direction, length, linkage, count)


def _with_ends(strokes: WorkingStrokes[Array], linkage: Mechanisms[Array], length: Array) -> Array:
    """The Hermite cubic of the end conditions, shape (6, n)."""
    cubic = hermite(ends_of(strokes.approach_slope, strokes.braking_slope, linkage), length, inverse=False)
    return np.vstack([cubic, np.zeros((2, length.size))])


def _closed(base: Array, direction: Array, length: Array, linkage: Mechanisms[Array], count: int) -> Returns:
    """i12 = base + c direction, c from the driven angle that the return must cover."""
    mean = length / (2.0 * pi - linkage.working_angle_rad)
    powers = _powers(count)
    weights = np.tile(integration(count)[-1] / PIECES, PIECES)
    lift = harmonic_lift(base.T @ powers, direction.T @ powers, mean, weights, CLOSING_STEPS)
    return Returns(base + lift * direction, length)


def _value(polynomial: Array, argument: Array) -> Array:
    value: Array = (polynomial * argument ** np.arange(len(polynomial))[:, None]).sum(axis=0)
    return value


def _powers(count: int) -> Array:
    """Powers of tau at the points of all pieces, shape (6, PIECES * count)."""
    tau = ((np.arange(PIECES)[:, None] + shares(count)) / PIECES).ravel()
    powers: Array = tau ** np.arange(6.0)[:, None]
    return powers


def _derivatives(polynomial: Array, count: int) -> tuple[Array, Array, Array]:
    """Values and two derivatives by tau, shape (n, PIECES, count) each."""
    powers, order = _powers(count), np.arange(6.0)[:, None]
    rows = polynomial, (order * polynomial)[1:], (order * (order - 1.0) * polynomial)[2:]
    value, first, second = ((row.T @ powers[: len(row)]).reshape(-1, PIECES, count) for row in rows)
    return value, first, second


CLEAR = 1e-9
"""Share of its largest value by which v/phi1 must stay over zero: a million rounding errors.  What is nearer to zero is
left to the solver of one stroke."""

AngleFunction = Callable[[WorkingStrokes[Array], Mechanisms[Array], Array, int], Jet]


def stroke_samples(strokes: WorkingStrokes[Array], linkage: Mechanisms[Array], returns: Returns, count: int) -> Samples:
    """The working stroke's segments and the return, ``count`` points each."""
    width2, width3 = strokes.theta3_rad - strokes.theta2_rad, strokes.theta4_rad - strokes.theta3_rad
    starts = (0.0 * width2, strokes.theta2_rad, strokes.theta3_rad)
    widths = (strokes.theta2_rad, width2, width3)
    angles = (approach_angle, pressing_angle, braking_angle)
    phi1 = [_across(start, width, count) for start, width in zip(starts, widths, strict=True)]
    places = [_place(angle, strokes, linkage, at) for angle, at in zip(angles, phi1, strict=True)]
    motion = _motion(repeated(strokes, count), phi1)
    back, back_motion = _return(returns, linkage, count)
    at = Place(*(np.concatenate(column, axis=1) for column in zip(stacked(places), back, strict=True)))
    velocity, acceleration = (
        np.concatenate([np.stack(part, axis=1), last], axis=1)
        for part, last in zip(motion[1:], back_motion, strict=True)
    )
    every = np.stack([*widths, *[returns.length_rad / PIECES] * PIECES], axis=1)
    return Samples(
        at,
        velocity,
        acceleration,
        np.stack(motion[0], axis=1),
        at.slope * every[..., None],
        every > 0.0,
        _sound(strokes, count),
    )


def _across(start: Array, width: Array, count: int) -> Array:
    return start[:, None] + width[:, None] * shares(count)


def _place(angle: AngleFunction, strokes: WorkingStrokes[Array], linkage: Mechanisms[Array], phi1: Array) -> Place:
    """The ratio on one segment, from the inversion through the linkage."""
    count = phi1.shape[1]
    driven = angle(repeated(strokes, count), repeated(linkage, count), phi1.ravel(), 3)
    return place_of(*(driven.derivative(k).reshape(phi1.shape) for k in (1, 2, 3)))


def _motion(strokes: WorkingStrokes[Array], phi1: list[Array]) -> tuple[list[Array], list[Array], list[Array]]:
    """Displacement, velocity and acceleration on the three segments, from their polynomials."""
    approach, pressing, braking = (part.ravel() for part in phi1)
    advancing, ending = Jet.variable(approach, 1), -Jet.variable(braking - strokes.theta4_rad, 1)
    begun = advancing.value**2 * jet.polynomial(strokes.approach_root, advancing).value
    pressed = strokes.pressing_start_mm + strokes.pressing_mm_rad * (pressing - strokes.theta2_rad)
    left = ending.value**2 * jet.polynomial(strokes.braking_root, ending).value
    fast = advancing * jet.polynomial(strokes.approach_slope, advancing)
    slow = ending * jet.polynomial(strokes.braking_slope, ending)
    motions = (
        (begun, pressed, strokes.stroke_mm - left),
        (fast.value, strokes.pressing_mm_rad, slow.value),
        (fast.derivative(), 0.0 * pressing, slow.derivative()),
    )
    shaped = ([part.reshape(phi1[0].shape) for part in parts] for parts in motions)
    displacement, velocity, acceleration = shaped
    return displacement, velocity, acceleration


def _return(returns: Returns, linkage: Mechanisms[Array], count: int) -> tuple[Place, tuple[Array, Array]]:
    """Ratio, velocity and acceleration on the return."""
    slope, first, second = returns.slopes(count)
    turned = slope @ integration(count).T * returns.length_rad[:, None, None] / PIECES
    before = np.cumsum(turned[:, :, -1:], axis=1) - turned[:, :, -1:]
    driven = turned + before + linkage.working_angle_rad[:, None, None]
    rows = np.stack([driven, slope, first / 2.0]).reshape(3, -1)
    motion = repeated(linkage, PIECES * count).displacement(Jet(rows))
    velocity, acceleration = (motion.derivative(k).reshape(slope.shape) for k in (1, 2))
    return place_of(slope, first, second), (velocity, acceleration)


def _sound(strokes: WorkingStrokes[Array], count: int) -> Mask:
    """Whether the slider advances all the way, by far more than rounding: as ``machine/stroke.py`` asks for."""
    positive = (strokes.v1_mm_s > 0.0) & (strokes.v2_mm_s > 0.0) & (strokes.a1_mm_s2 < 0.0)
    finite = (strokes.law_speed_rad_s > 0.0) & np.isfinite(strokes.law_speed_rad_s)
    powers = (strokes.theta2_rad[:, None] * shares(count)) ** np.arange(4.0)[:, None, None]
    slope = (strokes.approach_slope[..., None] * powers).sum(axis=0)
    known = positive & finite & np.isfinite(slope).all(axis=1)
    low, high = extremes(np.where(known[:, None], slope, 1.0), np.arange(known.size))
    sound: Mask = known & (low > CLEAR * high)
    return sound


HARMONIC_PIECES = 4
"""Equal pieces of the working stroke, and of the return."""


def harmonic_samples(cosine: Array, sine: Array, linkage: Mechanisms[Array], lobes: Lobes, count: int) -> Samples:
    """Laws of coefficients of shape (n, harmonics) at ``count`` points a piece.

    The linkages (shape (n,)) must all have the first one's working angle, as those without offset have.
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
    """ln i12 with two derivatives by phi2, closed: the mean of i12 over phi2 is that of one turn over the other."""
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
