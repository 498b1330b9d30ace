"""Piecewise Chebyshev forms: fitted panel by panel to near rounding error, evaluated and integrated exactly.

Between breaks the function must be smooth; panels are halved until the last coefficients have died away, so the
spectral rate is kept however sharp the function is.  Method: L. N. Trefethen, "Approximation Theory and
Approximation Practice", SIAM 2013, chapters 3, 7 and 19.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache, cached_property

import numpy as np
from numpy.polynomial import chebyshev

from ncgear.numerics.arrays import Array, IndexArray, Mask

DEGREE = 24
"""Degree of each panel: a panel costs 25 evaluations, and halving it makes a smooth function's tail 2^24 times less."""

RESOLVED = 4e-15
"""Tail, relative to the function's largest value, at which a panel counts as resolved: 18 rounding errors."""

ROUNDING = 1e-11
"""Largest relative tail that may count as rounding error of the function itself, which no halving removes: a smooth
function's tail falls by 2^-24 when its panel is halved, so one that falls by less than half below this is noise."""

SHAKEN = 1e-9
"""Largest relative tail that may count as rounding error where the function's own rounding errors are known.  A peak of
width w at x has 1e-16 x/w of it: 1e-9 is reached where a force changes within 0.1 um at 600 mm."""

HALVINGS = 40

MOST_PANELS = 1 << 12
"""Most panels per piece, on average over the pieces, that are halved at once; a function that needs more is taken for
noise.  Beside a pole or a corner only a few are halved, and only a wave of over 5000 turns along a piece needs more."""


class NotSmooth(ValueError):
    """The function has a pole or a jump inside a piece; ``at`` is where the panels shrink to."""

    def __init__(self, at: float) -> None:
        super().__init__(f"no smooth function near {at:.6g}")
        self.at = at


@dataclass(frozen=True, eq=False)
class PiecewiseChebyshev:
    """Functions on consecutive panels: ``breaks`` (shape (m + 1,)), ``coefficients`` (shape (degree + 1, m, ...)).

    The coefficients have a trailing axis where values have one: none for a single function, (2,) for a plane curve.
    """

    breaks: Array
    coefficients: Array

    def __call__(self, points: Array) -> Array:
        """Values at ``points`` (any shape), the trailing axis appended.

        A point at a break belongs to the panel on its right.  Several columns share the polynomials of a point, which
        takes a third of the time of a Clenshaw sum for each; for a single one the sum is quicker.
        """
        panel = np.clip(np.searchsorted(self.breaks, points, side="right") - 1, 0, len(self.breaks) - 2)
        left, right = self.breaks[panel], self.breaks[panel + 1]
        local = ((points - left) - (right - points)) / (right - left)
        if self.coefficients.ndim == 2:
            return on_panels(self.coefficients, panel, local)
        rows = _polynomials(local.ravel(), len(self.coefficients))[:, None]
        values: Array = rows @ self._by_panel[panel.ravel()]
        return values.reshape(panel.shape + self.coefficients.shape[2:])

    @cached_property
    def _by_panel(self) -> Array:
        """The coefficients, each panel's next to each other in memory, shape (m, degree + 1, columns)."""
        return np.ascontiguousarray(np.moveaxis(self.coefficients, 1, 0))

    def integrated(self) -> PiecewiseChebyshev:
        """The antiderivative of a single function that is zero at the first break."""
        half_widths = np.diff(self.breaks) / 2.0
        raised = chebyshev.chebint(self.coefficients, lbnd=-1, axis=0) * half_widths
        totals = raised.sum(axis=0)
        raised[0] += np.concatenate([[0.0], np.cumsum(totals)[:-1]])
        return PiecewiseChebyshev(self.breaks, raised)

    def differentiated(self) -> PiecewiseChebyshev:
        """The derivative, panel by panel."""
        half_widths = (np.diff(self.breaks) / 2.0).reshape(-1, *(1,) * (self.coefficients.ndim - 2))
        return PiecewiseChebyshev(self.breaks, chebyshev.chebder(self.coefficients, axis=0) / half_widths)

    @property
    def final(self) -> float:
        """Value at the last break, as the limit from the left."""
        return float(self.coefficients[:, -1].sum())


def fitted(
    function: Callable[[Array], Array],
    breaks: Sequence[float] | Array,
    degree: int = DEGREE,
    agreed: Callable[[Array, Array, Array, Array], Mask] | None = None,
    shaken: Callable[[Array], Array] | None = None,
) -> PiecewiseChebyshev:
    """The piecewise form of a vectorised ``function`` (shape (n,) to (n, ...)) that is smooth between ``breaks``.

    Each panel has this ``degree``, at least 3: the last three coefficients tell whether the panel is resolved.  Where
    ``agreed`` is given, it must agree: from left and right ends of panels, coefficients, and the sizes that these count
    by, shape (m,), it tells which panels are resolved between the samples too.  ``shaken`` gives the rounding errors of
    the function's own values, where they are known.

    Raises NotSmooth where the function is not finite, or not resolved by panels of 2^-40 of its piece.
    """
    edges = np.asarray(breaks, dtype=float)
    left, right = edges[:-1], edges[1:]
    coarser = np.full(left.size, np.inf)
    done: list[tuple[Array, Array]] = []
    scale = 0.0
    for _ in range(HALVINGS):
        coefficients = _panel_coefficients(function, left, right, degree)
        tails, sizes = _largest(coefficients[-3:]), _largest(coefficients)
        # Only panels that are resolved by their own size set the scale: one value beside a pole would dwarf all others.
        scale = max(scale, float(np.max(sizes, where=tails <= RESOLVED * sizes, initial=0.0)))
        size = np.maximum(sizes, scale)
        noise = (tails <= ROUNDING * size) & (tails > 0.5 * coarser)
        resolved = (tails <= RESOLVED * size) | noise
        if shaken is not None and (open_still := ~resolved & (tails <= SHAKEN * size)).any():
            points = nodes(left[open_still], right[open_still], degree)
            resolved[open_still] = tails[open_still] <= shaken(points.ravel()).reshape(points.shape).max(axis=0)
        if agreed is not None and resolved.any():
            resolved[resolved] = agreed(left[resolved], right[resolved], coefficients[:, resolved], size[resolved])
        # So do those that are resolved up to their own rounding errors, once that is known.
        scale = max(scale, float(np.max(sizes, where=resolved & (tails <= SHAKEN * sizes), initial=0.0)))
        done.append((left[resolved], coefficients[:, resolved]))
        left, right = left[~resolved], right[~resolved]
        if not left.size:
            return _assembled(done, float(edges[-1]))
        if left.size > MOST_PANELS * (edges.size - 1):
            break
        middle, coarser = (left + right) / 2.0, np.tile(tails[~resolved], 2)
        left, right = np.concatenate([left, middle]), np.concatenate([middle, right])
    raise NotSmooth(float(left.min()))


def joined(forms: Sequence[PiecewiseChebyshev]) -> PiecewiseChebyshev:
    """One form of consecutive ones of the same degree."""
    breaks = np.concatenate([forms[0].breaks[:1], *(form.breaks[1:] for form in forms)])
    return PiecewiseChebyshev(breaks, np.concatenate([form.coefficients for form in forms], axis=1))


def nodes(left: Array, right: Array, degree: int = DEGREE) -> Array:
    """Chebyshev points of the first kind on each panel, shape (degree + 1, m); never an end point."""
    unit = _unit_nodes(degree)[:, None]
    return (left * (1.0 - unit) + right * (1.0 + unit)) / 2.0


def _largest(coefficients: Array) -> Array:
    """Largest magnitude of each panel's coefficients, shape (m,)."""
    largest: Array = np.abs(coefficients).max(axis=(0, *range(2, coefficients.ndim)))
    return largest


def _panel_coefficients(function: Callable[[Array], Array], left: Array, right: Array, degree: int) -> Array:
    points = nodes(left, right, degree)
    values = np.asarray(function(points.ravel()), dtype=float)
    wrong = ~np.isfinite(values).reshape(points.size, -1).all(axis=1)
    if wrong.any():
        raise NotSmooth(float(points.ravel()[wrong].min()))
    return np.tensordot(_transform(degree), values.reshape(points.shape + values.shape[1:]), axes=1)


def _assembled(parts: list[tuple[Array, Array]], end: float) -> PiecewiseChebyshev:
    starts = np.concatenate([start for start, _ in parts])
    coefficients = np.concatenate([block for _, block in parts], axis=1)
    order = np.argsort(starts)
    return PiecewiseChebyshev(np.append(starts[order], end), coefficients[:, order])


@cache
def _unit_nodes(degree: int) -> Array:
    points: Array = chebyshev.chebpts1(degree + 1)
    return points


@cache
def _transform(degree: int) -> Array:
    """Matrix from values at the first-kind points to coefficients, by discrete orthogonality."""
    weights = np.full(degree + 1, 2.0 / (degree + 1))
    weights[0] /= 2.0
    matrix: Array = chebyshev.chebvander(_unit_nodes(degree), degree).T * weights[:, None]
    return matrix


@cache
def integration_matrix(degree: int) -> Array:
    """Matrix from values at the first-kind points of [-1, 1] to the integrals from -1 to each of them, square."""
    integrals = chebyshev.chebint(np.eye(degree + 1), lbnd=-1, axis=0)
    matrix: Array = chebyshev.chebvander(_unit_nodes(degree), degree + 1) @ integrals @ _transform(degree)
    return matrix


def on_panels(coefficients: Array, panel: IndexArray, local: Array) -> Array:
    """Sums of series (shape (degree + 1, m)), each point of [-1, 1] with those of its own panel, by Clenshaw."""
    twice = 2.0 * local
    older = newer = np.zeros(local.shape)
    for row in coefficients[:0:-1]:
        older, newer = newer, row[panel] + twice * newer - older
    total: Array = coefficients[0][panel] + local * newer - older
    return total


def _polynomials(local: Array, count: int) -> Array:
    """T_0, T_1, ... at points of [-1, 1] (shape (n,)), by their recurrence; shape (n, count)."""
    values = np.empty((count, local.size))
    values[0], values[1] = 1.0, local
    twice = 2.0 * local
    for k in range(2, count):
        values[k] = twice * values[k - 1] - values[k - 2]
    return values.T
