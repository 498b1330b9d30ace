"""Zeros of functions: all or the first of them from Chebyshev forms, or one in each of many brackets.

``first_zeros`` and ``all_zeros`` take piecewise Chebyshev forms that are resolved to rounding error, so that no zero is
missed.  ``zeros_by_slope`` takes functions with their slopes, and Newton's method.  ``zeros_between`` closes in on
zeros in brackets, all at once, by the method of T. R. Chandrupatla, "A new hybrid quadratic/bisection algorithm for
finding the zero of a nonlinear function without using derivatives", Advances in Engineering Software 28 (1997),
145-149.  SciPy has the method too, but its bookkeeping takes ten times as long as the evaluation of this program's
functions.  Zeros of polynomials of one degree are the eigenvalues of their companion matrices.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.polynomial import Polynomial
from numpy.polynomial import chebyshev as series

from ncgear.errors import Unanswered
from ncgear.numerics import chebyshev
from ncgear.numerics.arrays import Array, IndexArray, Mask, distinct
from ncgear.numerics.chebyshev import PiecewiseChebyshev

NEGLIGIBLE = 1e-14
"""Trailing coefficients, relative to the largest, that are dropped before roots are sought: rounding errors."""

REAL = 1e-7
"""Largest imaginary part of a double zero that rounding has split: the square root of the coefficients' accuracy."""


def first_zeros(function: Callable[[IndexArray, Array], Array], cuts: list[Array]) -> Array:
    """For each interval number i, the smallest t at which ``function(i, t)`` is not positive, or the interval's end.

    ``cuts[i]`` holds the interval's ends and places where the function may jump.  Numbers and arguments have shape
    (n,).
    """
    first = np.concatenate([cut[:-1] for cut in cuts])
    last = np.concatenate([cut[1:] for cut in cuts])
    owner = np.repeat(np.arange(len(cuts)), [len(cut) - 1 for cut in cuts])

    def stacked(place: Array) -> Array:
        piece = np.clip(place.astype(int), 0, first.size - 1)
        return function(owner[piece], first[piece] + (last - first)[piece] * (place - piece))

    form = chebyshev.fitted(stacked, np.arange(first.size + 1.0))
    panel = np.nonzero(form.coefficients[0] <= np.abs(form.coefficients[1:]).sum(axis=0))[0]
    place = _first_zeros_of_series(form.coefficients[:, panel])
    panel, place = panel[np.isfinite(place)], place[np.isfinite(place)]
    start, end = form.breaks[panel], form.breaks[panel + 1]
    piece = ((start + end) / 2.0).astype(int)
    share = start + (end - start) * (place + 1.0) / 2.0 - piece
    zeros = np.array([cut[-1] for cut in cuts], dtype=float)
    # Backwards, so that of several zeros in an interval the first one stays.
    zeros[owner[piece][::-1]] = (first[piece] + (last - first)[piece] * share)[::-1]
    return zeros


def all_zeros(form: PiecewiseChebyshev) -> Array:
    """Every zero of a single function, in rising order, shape (n,); panels on which it is zero throughout have none."""
    doubtful = np.abs(form.coefficients[0]) <= np.abs(form.coefficients[1:]).sum(axis=0)
    found = [np.empty(0)]
    for panel in np.nonzero(doubtful & np.any(form.coefficients != 0.0, axis=0))[0]:
        start, end = form.breaks[panel], form.breaks[panel + 1]
        found.append(start + (end - start) * (_real_roots(form.coefficients[:, panel]) + 1.0) / 2.0)
    return distinct(np.concatenate(found))


EVEN = 0.3
"""Largest relative difference of a series' slope from its mean where Newton's method seeks its zero.  No step then
leaves more than six sevenths of the error, and far less of a small error."""

NEWTON_STEPS = 200
"""Most steps to the zero of a series of nearly even slope; five are enough as a rule."""

LAST_STEP = 1e-10
"""Step after which a zero counts as found: its error is about the square of the step."""

HALVED = 10
"""Rounds of halving series whose bounds do not show whether they are positive, or fall evenly.  Two are enough as a
rule; where a series only touches zero no number is, and eigenvalues decide."""


def _first_zeros_of_series(coefficients: Array) -> Array:
    """Smallest places in [-1, 1] at which series (degree + 1, m) are not positive, NaN for none, by halving."""
    degree, count = len(coefficients) - 1, coefficients.shape[1]
    # The first part of each series that certainly has a zero, as far as is known: both ends, and values there.
    first = np.full((4, count), np.inf)
    row, left, right, parts = np.arange(count), -np.ones(count), np.ones(count), coefficients
    for _ in range(HALVED):
        slope = chebyshev.differentiation_matrix(degree) @ parts
        even, odd = parts[::2].sum(axis=0), parts[1::2].sum(axis=0)
        falling = -EVEN * slope[0] >= np.abs(slope[1:]).sum(axis=0)
        crossing = (even <= odd) | (falling & (even + odd <= 0.0))
        _keep_first(first, row[crossing], np.array([left, right, even - odd, even + odd])[:, crossing])
        beyond = left >= first[0, row]
        rest = np.nonzero(~(falling | beyond | (parts[0] > np.abs(parts[1:]).sum(axis=0))))[0]
        row, middle = np.tile(row[rest], 2), (left[rest] + right[rest]) / 2.0
        if not rest.size:
            break
        left, right = np.concatenate([left[rest], middle]), np.concatenate([middle, right[rest]])
        parts = np.concatenate([half @ parts[:, rest] for half in chebyshev.halves(degree)], axis=1)
    places = np.where(np.isinf(first[0]), np.nan, first[0])
    inside = np.nonzero(np.isfinite(first[0]) & (first[2] > 0.0))[0]
    if inside.size:
        places[inside] = _zeros_of_falling_series(coefficients[:, inside], *np.split(first[:, inside], 2))
    for number in distinct(row):
        places[number] = _first_zero(coefficients[:, number])
    return places


def _keep_first(first: Array, row: IndexArray, parts: Array) -> None:
    """Keeps parts of rows (shape (4, n)) that begin before the parts of ``first``, shape (4, m)."""
    for number in np.nonzero(parts[0] < first[0, row])[0]:
        if parts[0, number] < first[0, row[number]]:
            first[:, row[number]] = parts[:, number]


def _zeros_of_falling_series(coefficients: Array, ends: Array, values: Array) -> Array:
    """Zeros of series that fall evenly between ``ends``, from positive ``values`` to others, shape (2, m) both."""
    slope = chebyshev.differentiation_matrix(len(coefficients) - 1) @ coefficients
    at: Array = np.clip((ends[0] * values[1] - ends[1] * values[0]) / (values[1] - values[0]), *ends)
    for _ in range(NEWTON_STEPS):
        terms = chebyshev.polynomials(at, len(coefficients)).T
        step = (terms * coefficients).sum(axis=0) / (terms * slope).sum(axis=0)
        at = np.clip(at - step, *ends)
        if np.all(np.abs(step) <= LAST_STEP):
            return at
    raise Unanswered(f"the zero of a series that falls evenly was not found in {NEWTON_STEPS} steps")


def _first_zero(coefficients: Array) -> float:
    """Smallest place in [-1, 1] at which a Chebyshev series is not positive, NaN where it is positive throughout."""
    if series.chebval(-1.0, coefficients) <= 0.0:
        return -1.0
    real = _real_roots(coefficients)
    return float(real.min()) if real.size else np.nan


def _real_roots(coefficients: Array) -> Array:
    kept = series.chebtrim(coefficients, NEGLIGIBLE * np.abs(coefficients).max())
    roots = np.atleast_1d(series.chebroots(kept))
    return roots.real[(np.abs(roots.imag) <= REAL) & (np.abs(roots.real) <= 1.0)]


MOST_STEPS = 200
"""Most steps.  Bisection alone needs 100 for the 32 digits down to a zero at zero; this method needs few more."""

CLOSE = 4.0 * np.finfo(float).eps
"""Width of a bracket over the zero at which the zero counts as found.  For a zero at 0, the width over the first
bracket's width must come down to the square of this."""


AT_AN_END = 1e-9
"""Share of a function's change over a bracket that counts as zero at an end: a bracket that ends at the zero itself
may miss it by the function's rounding errors."""


Known = tuple[Array, Array] | None
"""Known values of a function at both ends of brackets."""


def zeros_between(function: Callable[[Array], Array], low: Array, high: Array, known: Known = None) -> Array:
    """A zero in each [low, high] (shape (n,)); at the ends the function has different signs, or is zero at one.

    The function maps points of shape (n,), one for each bracket, to values; the values at both ends may be ``known``.
    An infinite value has a sign, and halves the bracket: where the function jumps to infinity, the zero is the point
    beside the jump at which it is finite.  Where the function has only rounding errors, its sign at a point depends on
    the other points.  Raises Unanswered, with the numbers of brackets, where a value is no number, or has one sign at
    both ends.
    """
    new, old = low, high
    value, old_value = _zero_at_an_end((low, high), *(known or (function(low), function(high))))
    share = np.full(low.shape, 0.5)
    with np.errstate(all="ignore"):
        narrow = CLOSE * np.abs(high - low)
        for _ in range(MOST_STEPS):
            at = new + share * (old - new)
            at_value = function(at)
            if (missing := np.isnan(at_value)).any():
                raise _no_zero(missing, low, high, "is no number between them")
            same = np.sign(at_value) == np.sign(value)
            older, older_value = np.where(same, new, old), np.where(same, value, old_value)
            old, old_value = np.where(same, old, new), np.where(same, old_value, value)
            new, value = at, at_value
            best = np.where(np.abs(value) < np.abs(old_value), new, old)
            least = CLOSE * (np.abs(best) + narrow) / np.abs(old - new)
            done = (least > 0.5) | (value == 0.0) | (old_value == 0.0)
            if done.all():
                return np.where(np.abs(value) < np.abs(old_value), new, old)
            share = _next_share((new, old, older), (value, old_value, older_value), least)
            # A zero that is found stays where it is: a step within so narrow a bracket could leave it.
            share = np.where(done, 0.0, share)
    raise _no_zero(~done, low, high, f"has different signs, in {MOST_STEPS} steps")


def _zero_at_an_end(ends: tuple[Array, Array], low: Array, high: Array) -> tuple[Array, Array]:
    """Values at both ends of brackets, of different signs or zero; raises Unanswered where they are not."""
    same = np.sign(low) * np.sign(high) > 0.0
    with np.errstate(invalid="ignore"):
        least = AT_AN_END * np.abs(high - low)
    low, high = (np.where(same & (np.abs(value) <= least), 0.0, value) for value in (low, high))
    alike = ~(np.sign(low) * np.sign(high) <= 0.0)
    if np.any(alike):
        raise _no_zero(alike, *ends, "does not have different signs")
    return low, high


def _no_zero(failed: Mask, low: Array, high: Array, why: str) -> Unanswered:
    rows = np.flatnonzero(failed)
    ends = f"{low[rows[0]]:.6g} and {high[rows[0]]:.6g}"
    return Unanswered(f"no zero was found between {ends}, at which a function {why}", rows=rows.tolist())


def _next_share(points: tuple[Array, Array, Array], values: tuple[Array, Array, Array], least: Array) -> Array:
    """Share of the way from the newest point to the point across the zero: by an inverse quadratic, or the middle."""
    (a, b, c), (fa, fb, fc) = points, values
    ab, fab, fcb = a - b, fa - fb, fc - fb
    place, height = ab / (c - b), fab / fcb
    trusted: Mask = (height**2 < place) & ((1.0 - height) ** 2 < 1.0 - place)
    share = fa / fab * fc / fcb - (c - a) / ab * fa / (fc - fa) * fb / fcb
    usual = np.where(trusted & np.isfinite(share), share, 0.5)
    return np.minimum(np.maximum(usual, np.minimum(least, 0.5)), 1.0 - least)


SLOWEST = 0.5
"""Share of a function's value that a Newton step may leave; after a slower step a bracket is halved."""

BySlope = Callable[[Array, IndexArray], tuple[Array, Array]]
"""Function of points and the numbers of their brackets: values and slopes, shape (n,) each."""


def zeros_by_slope(
    function: BySlope, positive: Array, other: Array, values: tuple[Array, Array], within: float
) -> Array:
    """Places beside zeros between points (shape (n,)) at which a function is ``positive``, and ``other`` points.

    Its ``values`` at both are given.  At the places it is zero or more, and at most twice ``within``; where the
    function jumps, the places are as near to the jump as numbers can be.  Newton's steps, and halves of brackets where
    a step leads out of them or gains too little; a value that is no number counts as not positive.  Raises Unanswered
    where a given value has the wrong sign.
    """
    if np.any(wrong := ~(values[0] >= 0.0) | (values[1] > 0.0)):
        raise _no_zero(wrong, positive, other, "does not have different signs")
    good, bad, row = positive.copy(), other.copy(), np.arange(positive.size)
    with np.errstate(all="ignore"):
        at = good + (bad - good) * values[0] / (values[0] - values[1])
    at, last = np.where(np.isfinite(at), at, (good + bad) / 2.0), np.full(at.shape, np.inf)
    for _ in range(MOST_STEPS):
        value, slope = function(at, row)
        above = value > 0.0
        good[row], bad[row] = np.where(above, at, good[row]), np.where(above, bad[row], at)
        # The target is ``within``, so that rounding leaves a positive value.
        missing = value - within
        near, far = good[row], bad[row]
        found = above & (np.abs(missing) <= within)
        found |= np.abs(far - near) <= CLOSE * np.maximum(np.abs(near), np.abs(far))
        if found.all():
            return good
        with np.errstate(all="ignore"):
            step = at - missing / slope
        gaining = (np.abs(missing) <= SLOWEST * last) & (np.minimum(near, far) < step) & (step < np.maximum(near, far))
        at, last = np.where(gaining, step, (near + far) / 2.0)[~found], np.abs(missing)[~found]
        row = row[~found]
    raise Unanswered(f"no zero was found in {MOST_STEPS} steps", rows=row.tolist())


def real_roots(coefficients: Array, imaginary: float = np.inf) -> Array:
    """Real parts of the zeros of polynomials, (degree, n), from coefficients from the constant term up (degree + 1, n).

    NaN where a zero is missing, or where its imaginary part is over ``imaginary`` times 1 plus its size.
    """
    degree, count = len(coefficients) - 1, coefficients.shape[1]
    zeros = np.full((degree, count), np.nan, dtype=complex)
    with np.errstate(all="ignore"):
        # numpy's companion matrix with its rows and columns reversed, which keeps small zeros accurate.
        last = -coefficients[-2::-1] / coefficients[-1]
        regular = np.isfinite(last).all(axis=0)
        companion = np.zeros((int(regular.sum()), degree, degree))
        companion[:, np.arange(degree - 1), np.arange(1, degree)] = 1.0
        companion[:, :, 0] = last[:, regular].T
        zeros[:, regular] = np.linalg.eigvals(companion).T
        for number in np.nonzero(~regular & np.isfinite(coefficients).all(axis=0))[0]:
            found = Polynomial(np.trim_zeros(coefficients[:, number], "b")).roots()
            zeros[: found.size, number] = found
    size = imaginary * (1.0 + np.abs(zeros.real))
    return np.where(np.abs(zeros.imag) <= size, zeros.real, np.nan)
