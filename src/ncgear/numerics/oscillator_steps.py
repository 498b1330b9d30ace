"""Steps of two coordinates that a spring between them, light or stiff, draws to each other, in plain numbers.

Over a step the spring and its damper are those of the step's start, and swing in closed form; what else accelerates
the coordinates is a quadratic through the start, the middle and the end of the step.  So a step may be half a swing or
more, where a method for any equations takes ten steps for a swing.  This is the exponential method of order 4 of S. M.
Cox, P. C. Matthews, J. Comp. Phys. 176 (2002), 430-455, with the linear stage of S. Krogstad, J. Comp. Phys. 203
(2005), 72-88.  A step estimates its error from what the quadratic misses in the middle of the step before.

Both coordinates stand in one complex number x + iy.  The spring acts on their relative place y - ratio x.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from math import cos, exp, inf, sin, sqrt
from typing import NamedTuple

import numpy as np
from numpy.polynomial import chebyshev

from ncgear.numerics.arrays import Array


class Pull(NamedTuple):
    """What accelerates both coordinates in a state.

    ``stiffness`` (1/s^2) times the relative place and ``damping`` (1/s) times the relative speed are what the spring
    and the damper add to the relative acceleration, with the other sign.  ``yielding`` is how both coordinates move
    under them for a relative way of 1.
    """

    acceleration: complex
    stiffness: float
    damping: float
    ratio: float
    yielding: complex


class Pulled(NamedTuple):
    """Places, speeds, and what accelerates them."""

    place: complex
    speed: complex
    pull: Pull


Pulling = Callable[[complex, complex], Pull]
"""What accelerates both coordinates at their places and speeds."""


class Stepped(NamedTuple):
    """The middle (places, speeds, accelerations) and the end of a step of ``width``, and its speeds' estimated error.

    The next step estimates its own error from the ``stage`` in the middle, too.
    """

    middle: tuple[complex, complex, complex]
    end: Pulled
    stage: Pulled
    width: float
    missed: float


NARROWEST, WIDEST, SAFE, STEADY = 0.2, 5.0, 0.85, 0.04
"""Least and largest change of a width from step to step, the share that the error allows, and the power of the error
before (K. Gustafsson, ACM Trans. Math. Softw. 17 (1991), 533-554), without which many steps would be tried in vain."""

LEAST_ERROR = 1e-4
"""Share of the allowed error below which an error counts no smaller, so that chance zeros do not widen steps."""


def steps(
    pulling: Pulling,
    start: Pulled,
    width: float,
    most: Callable[[Pulled], float],
    allowed: Callable[[complex], float],
) -> Iterator[Stepped | None]:
    """Steps after one another, without end, the first of at most ``width``; None for each that is tried in vain.

    Steps in which numbers overflow are such.  ``most`` is the largest width of a step from a state, ``allowed`` the
    error of the speeds in a step to some speeds.
    """
    now, last, before, growth = start, None, 1.0, WIDEST
    while True:
        width = min(width, most(now))
        try:
            step = stepped(pulling, now, last, width)
            error = max(step.missed / allowed(step.end.speed), LEAST_ERROR)
        except (ArithmeticError, ValueError):
            error = inf
        if error < 1.0:
            yield step
            now, last = step.end, step
            width *= min(growth, max(NARROWEST, SAFE * error**-0.2 * before**STEADY))
            before, growth = error, WIDEST
        else:
            yield None
            width *= max(NARROWEST, SAFE * error**-0.25)
            growth = 1.0


SLOW, OVERDAMPED = 4e-3, 400.0
"""Square of the angle of swing in a step below which, and square of the damping as a multiple of the stiffness (4: the
critical damping) from which, the spring counts with the rest: closed forms of the swing would lose digits."""

KINK = 0.2
"""Change of the stiffness within a step, as a share, from which the rest has a kink there: bodies meet or part."""

SMOOTH, KINKED = 1.0 / 64.0, 1.0 / 12.0
"""Error of the speed as a share of the width's cube and the change of the rest's second differences.  With a kink it is
that of the worst place of the kink; else the quadratic crosses the rest in the middle, and errors cancel."""


def stepped(pulling: Pulling, start: Pulled, before: Stepped | None, width: float) -> Stepped:
    """A step after the step ``before``, None at the start."""
    place, speed, (first, stiffness, damping, ratio, yielding) = start
    if stiffness * width * width < SLOW or damping * damping > OVERDAMPED * stiffness:
        stiffness = damping = 0.0
    half, forced = 0.5 * width, first.imag - ratio * first.real

    def rest(at: Pulled, time: float) -> complex:
        if not stiffness:
            return at.pull.acceleration
        way, faster = at.place - place - time * speed, at.speed - speed
        relative, rate = way.imag - ratio * way.real, faster.imag - ratio * faster.real
        return at.pull.acceleration + yielding * (stiffness * relative + damping * rate)

    def moved(time: float, slope: complex, bend: complex) -> tuple[complex, complex, complex]:
        """Places, speeds and accelerations under a rest of first + slope t + bend t^2."""
        gained = time * (first + time * (slope / 2.0 + time * bend / 3.0))
        way = time * time * (first / 2.0 + time * (slope / 6.0 + time * bend / 12.0))
        pull = first + time * (slope + time * bend)
        if stiffness:
            rising, bending = slope.imag - ratio * slope.real, bend.imag - ratio * bend.real
            swung, rate = _swung(time, (forced, rising, bending), stiffness, damping)
            way -= yielding * (way.imag - ratio * way.real - swung)
            gained -= yielding * (gained.imag - ratio * gained.real - rate)
            pull -= yielding * (stiffness * swung + damping * rate)
        return place + time * speed + way, speed + gained, pull

    def there(time: float, slope: complex, bend: complex) -> Pulled:
        ahead, faster, _ = moved(time, slope, bend)
        return Pulled(ahead, faster, pulling(ahead, faster))

    slope = (rest(there(half, 0j, 0j), half) - first) / half
    stage = there(half, slope, 0j)
    in_middle = rest(stage, half)
    at_end = rest(there(width, (in_middle - first) / half, 0j), width)
    slope, bend = (4.0 * in_middle - 3.0 * first - at_end) / width, 2.0 * (at_end - 2.0 * in_middle + first) / width**2
    end = there(width, slope, bend)
    last = rest(end, width)
    missed = abs(last - at_end) * width / 6.0
    if before:
        ago, both = 0.5 * before.width, (start.pull.stiffness, end.pull.stiffness)
        rises = (first - rest(before.stage, -ago)) / ago, (in_middle - first) / half, (last - in_middle) / half
        changed = abs((rises[2] - rises[1]) / width - (rises[1] - rises[0]) / (half + ago))
        kinked = abs(both[1] - both[0]) > KINK * max(both)
        missed += (KINKED if kinked else SMOOTH) * changed * width**3
    return Stepped(moved(half, slope, bend), end, stage, width, missed)


ALIKE = 1e-5
"""Least difference of both rates of decay, as a share of them, at which their closed form keeps its digits."""


def _swung(time: float, rest: tuple[float, float, float], stiffness: float, damping: float) -> tuple[float, float]:
    """Way and speed of r'' + damping r' + stiffness r = a + b t + c t^2 from rest at 0."""
    bend = rest[2] / stiffness
    slope = (rest[1] - 2.0 * damping * bend) / stiffness
    place = (rest[0] - damping * slope - 2.0 * bend) / stiffness
    half = 0.5 * damping
    square = stiffness - half * half
    if square > 0.0:
        swing, decay = sqrt(square), exp(-half * time)
        cosine, sine = decay * cos(swing * time), decay * sin(swing * time) / swing
    else:
        split = max(sqrt(-square), ALIKE * half)
        slowly, fast = exp(-stiffness / (half + split) * time), exp(-(half + split) * time)
        cosine, sine = (slowly + fast) / 2.0, (slowly - fast) / (2.0 * split)
    way = place * (1.0 - cosine - half * sine) + slope * (time - sine) + bend * time * time
    speed = place * stiffness * sine + slope * (1.0 - cosine + half * sine) + 2.0 * bend * time
    return way, speed


DEGREE = 8
"""Degree of the polynomials within steps, by places, speeds and accelerations at both ends and in the middle."""


def joined(start: Pulled, found: Sequence[Stepped]) -> tuple[Array, Array, Array]:
    """Times of n steps after a start, shape (n + 1,), x, x', y and y' then, shape (4, n + 1), and their polynomials.

    These are Chebyshev's coefficients in the steps, shape (9, n, 4).
    """
    time = np.append(0.0, np.cumsum([part.width for part in found]))
    half, ends = np.diff(time) / 2.0, [start, *(part.end for part in found)]
    at_ends = np.array([(now.place, now.speed, now.pull.acceleration) for now in ends])
    known = np.stack([at_ends[:-1], np.array([part.middle for part in found]), at_ends[1:]])
    places = np.tensordot(_through_three(), known * half[:, None] ** np.arange(3), axes=([1, 2], [2, 0]))
    speeds = np.append(chebyshev.chebder(places) / half, np.zeros((1, half.size)), axis=0)
    place, speed, _ = at_ends.T
    moved = np.stack([places.real, speeds.real, places.imag, speeds.imag], axis=-1)
    return time, np.stack([place.real, speed.real, place.imag, speed.imag]), moved


def _through_three() -> Array:
    """From values and derivatives (orders 0, 1, 2) at -1, 0 and 1 to Chebyshev's coefficients, shape (9, 3, 3)."""
    basis, points = np.eye(DEGREE + 1), np.array([-1.0, 0.0, 1.0])
    rows = [chebyshev.chebval(points, chebyshev.chebder(basis, order)).T for order in range(3)]
    return np.linalg.inv(np.concatenate(rows)).reshape(DEGREE + 1, 3, 3)
