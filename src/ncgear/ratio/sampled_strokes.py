"""Many three-segment strokes and their returns at once, sampled: what searches and screenings of thousands look at.

The equations are those of one stroke (``working_stroke.py``) and of one return (``return_stroke.py``), in arrays of
shape (n,) or, for polynomials, (m, n).  Only the multiple that closes a return in the ratio is found in another way:
one return is solved in a bracket and refused with a reason, which takes milliseconds; of many, Newton's method takes
all at once, and which of them close with a positive ratio is looked at afterwards.
"""

from __future__ import annotations

from dataclasses import dataclass, fields, replace
from functools import cache
from typing import Any, NamedTuple

import numpy as np

from ncgear.mechanisms.crank_slider import Linkages
from ncgear.numerics.arrays import Array
from ncgear.numerics.jet import Jet
from ncgear.numerics.sampled import integration, shares
from ncgear.ratio.return_stroke import (
    BUMP,
    EndsOfReturns,
    inverse_lift,
    published_polynomials,
    skewed_polynomials,
)
from ncgear.ratio.working_stroke import WorkingStrokes, polynomial_at

START_ABOVE = 1e-3
"""Where Newton's method starts: by so much of its size above the multiple at which the polynomial touches zero."""

BUMP_HEIGHT = 1.0 / 16.0
"""The bump's largest value, at tau = 1/2."""


class Motion(NamedTuple):
    """Displacement in mm, velocity in mm/rad and acceleration in mm/rad^2 of the driving angle, shape (n, points)."""

    displacement: Array
    velocity: Array
    acceleration: Array


def working_motions(strokes: WorkingStrokes[Array], counts: tuple[int, int, int]) -> tuple[Motion, Motion, Motion]:
    """The motion on approach, pressing and braking at Chebyshev points of each, ends included."""
    approach, pressing, braking = counts
    phi1 = strokes.theta2_rad[:, None] * shares(approach)
    delta = (strokes.theta4_rad - strokes.theta3_rad)[:, None] * shares(braking)[::-1]
    advancing = _from_rest(strokes.approach_slope, strokes.approach_root, phi1)
    left = _from_rest(strokes.braking_slope, strokes.braking_root, delta)
    speed = strokes.pressing_mm_rad[:, None]
    beyond = (strokes.theta3_rad - strokes.theta2_rad)[:, None] * shares(pressing)
    pressed = strokes.pressing_start_mm[:, None] + speed * beyond
    return (
        advancing,
        Motion(pressed, np.broadcast_to(speed, pressed.shape), np.zeros_like(pressed)),
        Motion(strokes.stroke_mm[:, None] - left.displacement, left.velocity, -left.acceleration),
    )


def _from_rest(slope: Array, root: Array, angle: Array) -> Motion:
    """The motion of v = t slope(t), whose displacement is t^2 root(t), at angles t (shape (n, points))."""
    rising = slope * np.arange(1.0, len(slope) + 1.0)[:, None]
    over, displaced, change = (polynomial_at(part[..., None], angle) for part in (slope, root, rising))
    return Motion(angle**2 * displaced, angle * over, change)


@dataclass(frozen=True, eq=False)
class Returns:
    """Returns as polynomials in tau (shape (6, n)), which are the ratio, or its inverse where ``inverse`` is true."""

    ends: EndsOfReturns[Array]
    polynomial: Array
    inverse: bool = False


@dataclass(frozen=True, eq=False)
class ReturnSamples:
    """n returns cut into p equal pieces of m Chebyshev points; arrays have shape (n, p, m).

    ``end_driven_rad`` (shape (n,)) is the driven angle at which the return really ends.  ``slope`` is dphi2/dphi1,
    followed by its two derivatives by phi1 and the slider's velocity in mm/rad and acceleration in mm/rad^2.
    """

    end_driven_rad: Array
    slope: Array
    slope_first: Array
    slope_second: Array
    velocity: Array
    acceleration: Array


def returns_with_constant(ends: EndsOfReturns[Array], constant: Array, points: tuple[int, int], steps: int) -> Returns:
    """i12 polynomials whose value extrapolated to phi1 = 0 is ``constant`` (shape (n,)), the published method's e.

    ``points`` are pieces and points of each, on which ``steps`` of Newton's method close the returns.
    """
    base, direction = published_polynomials(ends, constant)
    return Returns(ends, base + _ratio_lift(base, direction, ends, points, steps) * direction)


def returns_with_skewness(
    ends: EndsOfReturns[Array], skewness: Array, points: tuple[int, int], steps: int, *, inverse: bool
) -> Returns:
    """Returns in the ratio or its inverse of given skewness (shape (n,)), in heights of the bump.

    The unit is the mean of the polynomial.
    """
    mean = ends.driven_length_rad / ends.length_rad if inverse else ends.length_rad / ends.driven_length_rad
    base = skewed_polynomials(ends.inverted() if inverse else ends, mean * skewness / BUMP_HEIGHT)
    bump = np.append(BUMP.coef, 0.0)[:, None]
    lift = inverse_lift(base, ends) if inverse else _ratio_lift(base, bump, ends, points, steps)
    return Returns(ends, base + lift * bump, inverse)


def return_samples(returns: Returns, linkage: Linkages[Any], points: tuple[int, int]) -> ReturnSamples:
    """The returns at Chebyshev points; ``points`` are the number of pieces and of points in each."""
    pieces, count = points
    length = returns.ends.length_rad[:, None]
    order, powers = np.arange(6.0)[:, None], _powers(points)
    rows = returns.polynomial, (order * returns.polynomial)[1:], (order * (order - 1.0) * returns.polynomial)[2:]
    value, first, second = (row.T @ powers[: len(row)] for row in rows)
    slope = Jet(np.stack([value.ravel(), (first / length).ravel(), (second / (2.0 * length**2)).ravel()]))
    slope = slope if returns.inverse else 1.0 / slope
    turned = slope.value.reshape(-1, pieces, count) @ integration(count).T * (length[..., None] / pieces)
    before = np.cumsum(turned[:, :, -1:], axis=1) - turned[:, :, -1:]
    driven = turned + before + returns.ends.start_driven_rad[:, None, None]
    motion = repeated(linkage, pieces * count).displacement(slope.truncated(1).integrated(driven.ravel()))
    arrays = *(slope.derivative(k) for k in (0, 1, 2)), *(motion.derivative(k) for k in (1, 2))
    return ReturnSamples(driven[:, -1, -1], *(values.reshape(-1, pieces, count) for values in arrays))


def repeated(many: Any, count: int) -> Any:
    """A dataclass whose arrays count designs along their last axis, each design ``count`` times."""
    values = {field.name: getattr(many, field.name) for field in fields(many)}
    arrays = {name: value for name, value in values.items() if isinstance(value, np.ndarray)}
    return replace(many, **{name: np.repeat(value, count, axis=-1) for name, value in arrays.items()})


def _ratio_lift(
    base: Array, direction: Array, ends: EndsOfReturns[Array], points: tuple[int, int], steps: int
) -> Array:
    """The multiple (shape (n,)) of ``direction`` that closes returns in the ratio.

    The harmonic mean of the ratio is then that of the return.  It is a concave function of the multiple, and from just
    above where the polynomial touches zero Newton's steps never pass the solution.
    """
    pieces, count = points
    mean = ends.length_rad / ends.driven_length_rad
    weights = np.tile(integration(count)[-1] / pieces, pieces)
    given, risen = base.T @ _powers(points), direction.T @ _powers(points)
    inner = slice(2, -2)
    least = np.max(-given[:, inner] / risen[:, inner], axis=1)
    lift: Array = least + START_ABOVE * (np.abs(least) + mean / BUMP_HEIGHT)
    for _ in range(steps):
        inverse = 1.0 / (given + lift[:, None] * risen)
        covered, falling = inverse @ weights, (inverse**2 * risen) @ weights
        step: Array = (mean - 1.0 / covered) * covered**2 / falling
        lift = np.maximum(lift + step, least)
    return lift


@cache
def _powers(points: tuple[int, int]) -> Array:
    """Powers of tau at the points of all pieces, shape (6, pieces * count)."""
    pieces, count = points
    tau = ((np.arange(pieces)[:, None] + shares(count)) / pieces).ravel()
    powers: Array = tau ** np.arange(6.0)[:, None]
    return powers
