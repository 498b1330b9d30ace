"""Samples of many three-segment strokes and their returns at once, for searches and for screenings of thousands.

The strokes come from ``working_stroke.py``, the returns are the polynomials of ``return_stroke.py``; arrays of strokes
have shape (n,) and polynomials (m, n).  ``return_stroke.py`` solves one return in a bracket, polishes it or refuses it
with a reason, in milliseconds.  Here Newton's method closes many at once on the points of the samples; the caller must
check that each has a positive ratio and ends where it must.
"""

from __future__ import annotations

from functools import cache
from math import factorial, pi
from typing import Any, NamedTuple

import numpy as np

from ncgear.frozen import dataclass
from ncgear.mechanisms.mechanism import Mechanisms
from ncgear.numerics.arrays import Array, repeated
from ncgear.numerics.jet import Jet
from ncgear.numerics.sampled import integration, shares
from ncgear.numerics.zeros import zeros_between
from ncgear.ratio.laws.three_segment import approach, approach_angle, braking, braking_angle, pressing_angle
from ncgear.ratio.return_stroke import TOUCHING, hermite
from ncgear.ratio.working_stroke import WorkingStrokes, polynomial_at

BUMP_HEIGHT = 1.0 / 16.0
"""Largest value of tau^2 (1 - tau)^2, at the middle of the return."""

SMALLEST_STEP = 1e-15
"""Share of the multiple under which Newton steps are rounding errors."""

START_ABOVE = 1e-3
"""Share of its size by which Newton's method starts above the multiple at which the polynomial touches zero."""


class SampledMotion(NamedTuple):
    """Displacement in mm, velocity in mm/rad and acceleration in mm/rad^2 of the driving angle, shape (n, points)."""

    displacement: Array
    velocity: Array
    acceleration: Array


def working_motions(
    strokes: WorkingStrokes[Array], counts: tuple[int, int, int]
) -> tuple[SampledMotion, SampledMotion, SampledMotion]:
    """The motion on approach, pressing and braking at Chebyshev points of each, ends included.

    The points of the braking run from the dead centre back to theta3.
    """
    return working_motions_at(strokes, *_segment_angles(strokes, counts))


def _segment_angles(strokes: WorkingStrokes[Array], counts: tuple[int, int, int]) -> tuple[Array, Array, Array]:
    """Angles up to theta2, beyond theta2 and before theta4 at these points, shape (n, points) each."""
    theta2, theta3, theta4 = (angle[:, None] for angle in (strokes.theta2_rad, strokes.theta3_rad, strokes.theta4_rad))
    approach, pressing, braking = (shares(count) for count in counts)
    return theta2 * approach, (theta3 - theta2) * pressing, (theta4 - theta3) * braking


def working_angles(
    strokes: WorkingStrokes[Array], linkage: Mechanisms[Any], counts: tuple[int, int, int], order: int
) -> tuple[Array, tuple[Array, ...]]:
    """Driving angles, and the driven angle with its derivatives up to ``order``, at the points of ``working_motions``.

    Each has the shape (n, points of all three); all are regular up to and including both dead centres.
    """
    approach, beyond, before = _segment_angles(strokes, counts)
    angles = approach, strokes.theta2_rad[:, None] + beyond, strokes.theta4_rad[:, None] - before
    parts = []
    for law, phi1 in zip((approach_angle, pressing_angle, braking_angle), angles, strict=True):
        each = phi1.shape[1]
        driven = law(repeated(strokes, each), repeated(linkage, each), phi1.ravel(), order)
        parts.append([driven.derivative(k).reshape(phi1.shape) for k in range(order + 1)])
    return np.hstack(angles), tuple(np.hstack(derivatives) for derivatives in zip(*parts, strict=True))


def working_motions_at(
    strokes: WorkingStrokes[Array], phi1_rad: Array, beyond_rad: Array, before_rad: Array
) -> tuple[SampledMotion, SampledMotion, SampledMotion]:
    """The motion at angles up to theta2, which is the last one, beyond theta2, and before theta4, all (n, points)."""
    advanced = _from_rest(strokes.approach_slope, strokes.approach_root, phi1_rad)
    left = _from_rest(strokes.braking_slope, strokes.braking_root, before_rad)
    speed = strokes.pressing_mm_rad[:, None]
    pressed = advanced.displacement[:, -1:] + speed * beyond_rad
    return (
        advanced,
        SampledMotion(pressed, np.broadcast_to(speed, pressed.shape), 0.0 * pressed),
        SampledMotion(strokes.stroke_mm[:, None] - left.displacement, left.velocity, -left.acceleration),
    )


def _from_rest(slope: Array, root: Array, angle: Array) -> SampledMotion:
    """The motion of v = t slope(t), whose displacement is t^2 root(t), at angles t (shape (n, points))."""
    order = np.arange(len(slope))
    powers = angle[:, :, None] ** order
    rising = slope * (order + 1.0)[:, None]
    over, displaced, change = (
        np.einsum("npk,nk->np", powers, np.ascontiguousarray(part.T)) for part in (slope, root, rising)
    )
    return SampledMotion(angle**2 * displaced, angle * over, change)


@dataclass(frozen=True, eq=False)
class Returns:
    """n returns: cubic(tau) + (bump + skew (2 tau - 1)) tau^2 (1 - tau)^2 is the ratio, or its inverse.

    ``cubic`` has shape (4, n), the others (n,); ``length_rad`` is the driving angle of the return.
    """

    cubic: Array
    bump: Array
    skew: Array
    length_rad: Array
    inverse: bool = False

    def widths_rad(self, points: ReturnGrid) -> Array:
        """The driving angle of each piece, shape (n, pieces)."""
        return self.length_rad[:, None] * np.diff(points.edges)

    def at(self, beyond_rad: Array) -> Array:
        """The polynomial's values at driving angles beyond the return's start, or before it, shape (n,)."""
        tau = beyond_rad / self.length_rad
        bump = tau**2 * (1.0 - tau) ** 2
        return polynomial_at(self.cubic, tau) + (self.bump + self.skew * (2.0 * tau - 1.0)) * bump

    def polynomial(self, points: ReturnGrid, order: int) -> Jet:
        """Its value and derivatives by the driving angle up to ``order``, at most 2, at all points of each return."""
        at, rows, length = points.basis, self.cubic.T, self.length_rad[:, None]
        bump, skew = self.bump[:, None], self.skew[:, None]
        parts = [rows @ at.powers.T + skew * at.skew[0] + bump * at.bump[0]]
        if order >= 1:
            rising = rows[:, 1:] * np.arange(1.0, 4.0)
            parts.append((rising @ at.powers[:, :3].T + skew * at.skew[1] + bump * at.bump[1]) / length)
        if order == 2:
            bending = rows[:, 2:] * np.array([1.0, 3.0])
            halves = skew * (at.skew[2] / 2.0) + bump * (at.bump[2] / 2.0)
            parts.append((bending @ at.powers[:, :2].T + halves) / length**2)
        return Jet(np.stack([part.ravel() for part in parts]))


@dataclass(frozen=True, eq=False)
class PeakedReturns:
    """n returns in the ratio, which nearly touches zero at ``about`` (shape (n,)) in tau, the share of the return.

    ``local`` (shape (6, n)) is the ratio in powers of tau - about, which keeps the digits of its smallest value.  The
    pieces are quartered towards that place.
    """

    local: Array
    about: Array
    length_rad: Array
    inverse: bool = False

    @property
    def _edges(self) -> Array:
        """Ends of the pieces in tau - about, shape (n, pieces + 1)."""
        return edges_about(self.about, QUARTERINGS)

    def widths_rad(self, points: ReturnGrid) -> Array:
        """The driving angle of each piece, shape (n, pieces); zero for pieces beyond the return's ends."""
        return np.diff(self._edges, axis=1) * self.length_rad[:, None]

    def polynomial(self, points: ReturnGrid, order: int) -> Jet:
        """The ratio and its derivatives by the driving angle up to ``order``, at most 2, at all points."""
        tau = _between(self._edges, points.count)
        return Jet(
            np.stack(
                [
                    polynomial_at(part[:, :, None], tau).ravel() / factorial(k)
                    for k, part in enumerate(_derivatives(self.local, self.length_rad, order))
                ]
            )
        )


QUARTERINGS = 7
"""Quarterings of the return towards the place of its least ratio: panels of 4^-7 of it resolve a ratio that is a
ten-thousandth of its mean there; narrower peaks are left to the solver of one return."""

EVERYWHERE = (1.0 / 32.0, 1.0 / 8.0, 1.0 / 2.0, 7.0 / 8.0, 31.0 / 32.0, 127.0 / 128.0)
"""Shares of a stretch at which it is also cut, since the ratio may change fast beside its ends too."""


def edges_about(about: Array, quarterings: int) -> Array:
    """Ends of pieces of [0, 1] less ``about`` (shape (n,)) in it, shape (n, pieces + 1); some have no length."""
    quarters = np.append(0.25 ** np.arange(quarterings + 1.0), 0.0)
    towards = np.broadcast_to(np.concatenate([-quarters, quarters[-2::-1]]), (about.size, 2 * quarters.size - 1))
    edges = np.concatenate([towards, np.array(EVERYWHERE) - about[:, None]], axis=1)
    return np.clip(np.sort(edges, axis=1), -about[:, None], 1.0 - about[:, None])


def _between(edges: Array, count: int) -> Array:
    """Chebyshev points of all pieces, shape (n, pieces * count)."""
    points: Array = edges[:, :-1, None] + np.diff(edges, axis=1)[..., None] * shares(count)
    return points.reshape(len(edges), -1)


def _derivatives(local: Array, length_rad: Array, order: int) -> list[Array]:
    """Coefficients of a polynomial in tau and of its derivatives by the driving angle, shape (m, n) each."""
    found = [local]
    for _ in range(order):
        rising = found[-1][1:] * np.arange(1.0, len(found[-1]))[:, None] / length_rad
        found.append(rising)
    return found


@dataclass(frozen=True, eq=False)
class ReturnSamples:
    """n returns at p pieces of m points each; arrays have shape (n, p, m).

    ``driven_rad`` is phi2, ``slopes`` are dphi2/dphi1 and its derivatives by phi1, up to the order that was asked for;
    ``displacement`` of the slider is in mm, ``velocity`` in mm/rad, ``acceleration`` in mm/rad^2.
    """

    driven_rad: Array
    slopes: tuple[Array, ...]
    displacement: Array
    velocity: Array
    acceleration: Array

    @property
    def end_driven_rad(self) -> Array:
        """Driven angle at which the return really ends, shape (n,)."""
        return self.driven_rad[:, -1, -1]


@dataclass(frozen=True)
class ReturnGrid:
    """A return is cut at ``edges`` in tau, from 0 to 1, into pieces of ``count`` Chebyshev points each, ends included.

    ``steps`` of Newton's method on these points close a return in the ratio.
    """

    edges: tuple[float, ...]
    count: int
    steps: int

    @property
    def basis(self) -> StrokeBasis:
        """The parts of a return's polynomial at all points."""
        return _basis(self.edges, self.count)


class StrokeBasis(NamedTuple):
    """Powers of tau (shape (points, 4)), and tau^2 (1 - tau)^2 and its product with 2 tau - 1 with two derivatives.

    ``weights`` (shape (points,)) make the integral over tau of values at all points.
    """

    tau: Array
    weights: Array
    powers: Array
    bump: tuple[Array, Array, Array]
    skew: tuple[Array, Array, Array]


@cache
def _basis(edges: tuple[float, ...], count: int) -> StrokeBasis:
    starts, widths = np.array(edges[:-1])[:, None], np.diff(edges)[:, None]
    tau = (starts + widths * shares(count)).ravel()
    bump = tau**2 * (1.0 - tau) ** 2, 2.0 * tau * (1.0 - tau) * (1.0 - 2.0 * tau), 2.0 - 12.0 * tau * (1.0 - tau)
    slant = 2.0 * tau - 1.0
    skew = slant * bump[0], 2.0 * bump[0] + slant * bump[1], 4.0 * bump[1] + slant * bump[2]
    weights = (widths * integration(count)[-1]).ravel()
    return StrokeBasis(tau, weights, tau[:, None] ** np.arange(4.0), bump, skew)


def returns_with_skewness(
    strokes: WorkingStrokes[Array],
    linkage: Mechanisms[Any],
    period_rad: float,
    skewness: Array,
    points: ReturnGrid,
    *,
    inverse: bool,
) -> Returns:
    """Returns in the ratio or its inverse; ``skewness`` (shape (n,)) is in mean polynomials per height of the bump."""
    length, driven = period_rad - strokes.theta4_rad, 2.0 * pi - linkage.working_angle_rad
    mean = driven / length if inverse else length / driven
    skew, at = mean * skewness / BUMP_HEIGHT, points.basis
    cubic = _cubic(strokes, linkage, length, inverse=inverse)
    base = cubic.T @ at.powers.T + skew[:, None] * at.skew[0]
    if inverse:
        bump = (mean - base @ at.weights) / float(at.weights @ at.bump[0])
    else:
        bump = _ratio_lift(base, at.bump[0], mean, points)
    return Returns(cubic, bump, skew, length, inverse)


def returns_with_constant(
    strokes: WorkingStrokes[Array], linkage: Mechanisms[Any], period_rad: float, constant: Array, points: ReturnGrid
) -> Returns:
    """Returns in the ratio whose polynomial is ``constant`` (shape (n,)) at phi1 = 0, the published method's e."""
    length, driven = period_rad - strokes.theta4_rad, 2.0 * pi - linkage.working_angle_rad
    cubic, at = _cubic(strokes, linkage, length, inverse=False), points.basis
    origin = -strokes.theta4_rad / length
    given = (constant - polynomial_at(cubic, origin)) / (origin**2 * (1.0 - origin) ** 2)
    base = cubic.T @ at.powers.T + given[:, None] * at.bump[0]
    lift = _ratio_lift(base, at.bump[0] * (at.tau - origin[:, None]), length / driven, points)
    return Returns(cubic, given + lift * (0.5 - origin), lift / 2.0, length)


TRIED = 512
"""Even places of the return, among them the first guess of the touching place."""


def peaked_returns(
    strokes: WorkingStrokes[Array], linkage: Mechanisms[Any], period_rad: float, constant: Array, points: ReturnGrid
) -> PeakedReturns:
    """As ``returns_with_constant``, for ratios that nearly touch zero inside the return; NaN for other ratios.

    The steps follow ``return_stroke.py``: the multiple at which the polynomial touches zero, its powers about that
    place, and the addition with which the return covers its driven angle.
    """
    length, driven = period_rad - strokes.theta4_rad, 2.0 * pi - linkage.working_angle_rad
    cubic, origin = _cubic(strokes, linkage, length, inverse=False), -strokes.theta4_rad / length
    bump = np.array([0.0, 0.0, 1.0, -2.0, 1.0, 0.0])[:, None]
    lift = (constant - polynomial_at(cubic, origin)) / (origin**2 * (1.0 - origin) ** 2)
    base = np.concatenate([cubic, np.zeros((2, length.size))]) + lift * bump
    direction = np.roll(bump, 1, axis=0) - origin * bump
    tau = np.arange(1.0, TRIED)[:, None] / TRIED
    about = tau[np.argmax(-polynomial_at(base[:, None], tau) / polynomial_at(direction[:, None], tau), axis=0), 0]
    unit, guess = np.ones_like(length), about
    for _ in range(TOUCHING_STEPS):
        (b, b1, b2), (d, d1, d2) = (
            [polynomial_at(part, about) for part in _derivatives(polynomial, unit, 2)]
            for polynomial in (base, direction)
        )
        about = np.clip(about - (b1 * d - b * d1) / (b2 * d - b * d2), guess - 1.0 / TRIED, guess + 1.0 / TRIED)
    touching = base - polynomial_at(base, about) / polynomial_at(direction, about) * direction
    local, rising = _about(touching, about), _about(direction, about)
    noise = TOUCHING * np.abs(touching).max(axis=0)
    touches = (np.abs(local[:2]) <= noise).all(axis=0) & (local[2] > 0.0)
    local[:2] = 0.0
    edges = edges_about(about, QUARTERINGS)
    places, widths = _between(edges, points.count), np.diff(edges, axis=1)
    weights = (widths[..., None] * integration(points.count)[-1]).reshape(len(edges), -1)
    flat, steep = (polynomial_at(part[:, :, None], places) for part in (local, rising))

    def excess(log_step: Array) -> Array:
        covered: Array = (weights / (flat + np.exp(log_step)[:, None] * steep)).sum(axis=1)
        return np.where(touches, covered - driven / length, -log_step)

    middle = np.where(touches, np.log(np.abs(base).max(axis=0)), 0.0)
    low, high = middle - WIDE, middle + WIDE
    touches &= (excess(low) > 0.0) & (excess(high) < 0.0)
    step = np.exp(zeros_between(excess, np.where(touches, low, -WIDE), np.where(touches, high, WIDE)))
    return PeakedReturns(np.where(touches, local + step * rising, np.nan), about, length)


TOUCHING_STEPS = 6
"""Newton's steps to the touching place from the best of the even places."""

WIDE = 30.0
"""Natural logarithm of the largest factor between the addition and the polynomial's largest coefficient, as in
``return_stroke.py``."""


def _about(coefficients: Array, about: Array) -> Array:
    """Polynomials in powers of tau (shape (m, n)) converted to powers of tau - about."""
    found = []
    for k, part in enumerate(_derivatives(coefficients, np.ones_like(about), len(coefficients) - 1)):
        found.append(polynomial_at(part, about) / factorial(k))
    return np.stack(found)


def return_samples(
    returns: Returns | PeakedReturns, linkage: Mechanisms[Any], points: ReturnGrid, order: int
) -> ReturnSamples:
    """The returns, dphi2/dphi1 with derivatives up to ``order`` (1 or 2), and the slider's motion at all points."""
    widths = returns.widths_rad(points)[..., None]
    shape = (len(widths), widths.shape[1], points.count)
    slope = returns.polynomial(points, order)
    slope = slope if returns.inverse else 1.0 / slope
    turned = (slope.value.reshape(-1, points.count) @ integration(points.count).T).reshape(shape)
    turned = turned * widths
    before = np.cumsum(turned[:, :, -1:], axis=1) - turned[:, :, -1:]
    driven = turned + before + np.reshape(linkage.working_angle_rad, (-1, 1, 1))
    moved = slope.truncated(1).integrated(driven.ravel())
    motion = repeated(linkage, widths.shape[1] * points.count).displacement(moved)
    slopes = tuple(slope.derivative(k).reshape(shape) for k in range(order + 1))
    displacement, velocity, acceleration = (motion.derivative(k).reshape(shape) for k in range(3))
    return ReturnSamples(driven, slopes, displacement, velocity, acceleration)


def _cubic(strokes: WorkingStrokes[Array], linkage: Mechanisms[Any], length: Array, *, inverse: bool) -> Array:
    """The cubic in tau with the values and slopes of the two ends, shape (4, n)."""
    advances = braking(strokes, strokes.theta4_rad, 1), approach(strokes, np.zeros_like(length), 1)
    slopes = (advance.driven_slope(linkage) for advance in advances)
    far, near = (slope if inverse else 1.0 / slope for slope in slopes)
    return np.stack(hermite(far.value, far.derivative(1), near.value, near.derivative(1), length))


def _ratio_lift(base: Array, direction: Array, mean: Array, points: ReturnGrid) -> Array:
    """The multiple (shape (n,)) of ``direction`` that makes the harmonic mean of the ratio over the return ``mean``.

    ``base`` has shape (n, points), ``direction`` the same or (points,); it is positive but for double zeros at both
    ends. The harmonic mean is a concave function of the multiple: from just above where the polynomial touches zero,
    Newton's steps never pass the solution.
    """
    inner, weights = slice(2, -2), points.basis.weights
    least = np.max(-base[:, inner] / direction[..., inner], axis=1)
    lift: Array = least + START_ABOVE * (np.abs(least) + mean / BUMP_HEIGHT)
    for _ in range(points.steps):
        inverse = 1.0 / (base + lift[:, None] * direction)
        covered, falling = inverse @ weights, (inverse**2 * direction) @ weights
        step: Array = (mean - 1.0 / covered) * covered**2 / falling
        lift, last = np.maximum(lift + step, least), lift
        if not (np.abs(lift - last) > SMALLEST_STEP * np.abs(lift)).any():
            break
    return lift
