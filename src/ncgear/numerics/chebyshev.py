"""Piecewise Chebyshev forms: fitted panel by panel to near rounding error, evaluated, integrated and inverted.

Between breaks the function must be smooth; panels are halved until the last coefficients have died away, so the
spectral rate is kept however sharp the function is.  Method: L. N. Trefethen, "Approximation Theory and
Approximation Practice", SIAM 2013, chapters 3, 7 and 19.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cache, cached_property

import numpy as np
from numpy.polynomial import chebyshev

from ncgear.errors import Unanswered
from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array, IndexArray, Mask, powers, row_blocks

DEGREE = 24
"""Degree of each panel: a panel costs 25 evaluations; halving it makes a smooth function's tail 2^24 times smaller."""

RESOLVED = 4e-15
"""Tail, relative to the function's largest value, at which a panel counts as resolved: 18 rounding errors."""

ROUNDING = 1e-11
"""Largest relative tail that may count as rounding error of the function itself, which no halving removes: a smooth
function's tail falls by 2^-24 when its panel is halved, so a tail below this that falls by less than half is noise."""

SHAKEN = 1e-9
"""Largest relative tail that may count as rounding error where the function's own rounding errors are known.  A peak of
width w at x has an error of 1e-16 x/w: 1e-9 is reached where a force changes within 0.1 um at 600 mm."""

HALVINGS = 40

MOST_PANELS = 1 << 12
"""Most panels that are halved at once: on average over the pieces, and of all pieces together where halving makes most
tails no smaller; a function that needs more counts as noise.  Beside a pole or a corner only a few are halved, and only
a wave of over 5000 turns along a piece needs more."""


class NotSmooth(Unanswered):
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
        takes a third of the time of a Clenshaw sum for each; for a single column the sum is quicker.
        """
        panel = np.clip(np.searchsorted(self.breaks, points, side="right") - 1, 0, len(self.breaks) - 2)
        left, right = self.breaks[panel], self.breaks[panel + 1]
        local = ((points - left) - (right - points)) / (right - left)
        if self.coefficients.ndim == 2:
            return on_panels(self.coefficients, panel, local)
        rows = polynomials(local.ravel(), len(self.coefficients))[:, None]
        values: Array = rows @ self._by_panel[panel.ravel()]
        return values.reshape(panel.shape + self.coefficients.shape[2:])

    @cached_property
    def _by_panel(self) -> Array:
        """The coefficients of each panel next to each other in memory, shape (m, degree + 1, columns)."""
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


CELL_DEGREE = 8
"""Degree of the polynomials of cells, which are about a tenth as wide as panels of degree 24 and quicker by a third."""

CELL_ROUNDING = 2.0**-54
"""Largest sum of a cell's left out coefficients, as a share of a column's largest coefficient: half a rounding
error."""


@dataclass(frozen=True, eq=False)
class Cells:
    """A form of several columns, cut so finely that short polynomials follow it to rounding errors.

    ``ends`` (shape (n, 2)) are both ends of the cells, in order; ``powers`` (shape (n, degree + 1, columns)) the
    coefficients of 1, x, x^2 and so on, where x is -1 and 1 at a cell's ends.
    """

    ends: Array
    powers: Array

    @cached_property
    def _in_memory(self) -> tuple[Array, Array, Array, Array]:
        """Beginnings of all cells but the first, both ends, and the coefficients of columns, in the order of use."""
        left, right = (end.copy() for end in self.ends.T)
        return left[1:], left, right, np.ascontiguousarray(np.moveaxis(self.powers, 1, 2))

    def column(self, number: int) -> Cells:
        """One of the columns alone."""
        return Cells(self.ends, self.powers[..., number : number + 1])

    def __call__(self, points: Array) -> Array:
        """Values at ``points`` (any shape), the trailing axis appended; as ``PiecewiseChebyshev``."""
        flat, (count, columns) = points.ravel(), self.powers.shape[1:]
        starts, *ends, by_column = self._in_memory
        values = np.empty((flat.size, columns))
        for rows in row_blocks(flat.size):
            some = flat[rows]
            cell = starts.searchsorted(some, side="right")
            left, right = (end.take(cell) for end in ends)
            local = ((some - left) - (right - some)) / (right - left)
            # Next to each other in memory, so that a value is the same among any number of points.
            each = np.ascontiguousarray(powers(local, count).T)
            np.einsum("nk,nck->nc", each, by_column.take(cell, axis=0), out=values[rows])
        return values.reshape(*points.shape, columns)


def cells_of(form: PiecewiseChebyshev) -> Cells:
    """The cells of a form of several columns: its panels are halved until ``CELL_DEGREE`` is enough."""
    degree = len(form.coefficients) - 1
    both = halves(degree)
    left, right, series = form.breaks[:-1], form.breaks[1:], form.coefficients
    least = CELL_ROUNDING * np.abs(series).max(axis=(0, 1))
    done: list[tuple[Array, Array]] = []
    while left.size:
        short = (np.abs(series[CELL_DEGREE + 1 :]).sum(axis=0) <= least).all(axis=1)
        done.append((np.stack([left[short], right[short]], axis=1), series[: CELL_DEGREE + 1, short]))
        left, right, series = left[~short], right[~short], series[:, ~short]
        middle = (left + right) / 2.0
        left, right = np.concatenate([left, middle]), np.concatenate([middle, right])
        series = np.concatenate([np.tensordot(half, series, axes=1) for half in both], axis=1)
    ends = np.concatenate([both for both, _ in done])
    short_series = np.concatenate([block for _, block in done], axis=1)
    order = np.argsort(ends[:, 0])
    powers = np.tensordot(_to_powers(len(short_series) - 1), short_series[:, order], axes=1)
    return Cells(ends[order], np.moveaxis(powers, 1, 0))


@cache
def halves(degree: int) -> tuple[Array, Array]:
    """Matrices from a series' coefficients to its halves', by the recurrence of T_k((x -+ 1) / 2); exact."""
    both = []
    for side in (-1.0, 1.0):
        columns = [np.eye(degree + 1)[0], np.array([side / 2.0, 0.5, *[0.0] * (degree - 1)])]
        while len(columns) <= degree:
            one = columns[-1]
            raised = chebyshev.chebmulx(one)[: degree + 1]
            columns.append(np.pad(raised, (0, degree + 1 - raised.size)) + side * one - columns[-2])
        both.append(np.stack(columns[: degree + 1], axis=1))
    return both[0], both[1]


def falls_below(series: Array, level: float) -> bool:
    """Whether a function falls below a level somewhere; its coefficients on panels have shape (degree + 1, m).

    Panels are halved until coefficients or an end decide; a function that still touches the level after ``HALVINGS``
    counts as above.
    """
    both = halves(len(series) - 1)
    for _ in range(HALVINGS):
        series = series[:, ~(series[0] - np.abs(series[1:]).sum(axis=0) >= level)]
        if not series.size:
            return False
        if series.sum(axis=0).min() < level:
            return True
        series = np.concatenate([half @ series for half in both], axis=1)
    return False


@cache
def _to_powers(degree: int) -> Array:
    """Matrix from Chebyshev coefficients to coefficients of powers; all numbers are whole."""
    columns = [chebyshev.cheb2poly(np.eye(degree + 1)[k, : k + 1]) for k in range(degree + 1)]
    return np.stack([np.pad(column, (0, degree + 1 - column.size)) for column in columns], axis=1)


def fitted(
    function: Callable[[Array], Array],
    breaks: Sequence[float] | Array,
    degree: int = DEGREE,
    agreed: Callable[[Array, Array, Array, Array], Mask] | None = None,
    shaken: Callable[[Array], Array] | None = None,
) -> PiecewiseChebyshev:
    """The piecewise form of a vectorised ``function`` (shape (n,) to (n, ...)) that is smooth between ``breaks``.

    Each panel has this ``degree``, at least 3: the last three coefficients show whether the panel is resolved.  If
    ``agreed`` is given, it must agree: from left and right ends of panels, coefficients, and the sizes that count,
    shape (m,), it says which panels are resolved between the samples too.  ``shaken`` gives the rounding errors of the
    function's own values, if they are known.

    Raises NotSmooth where the function is not finite, or not resolved by panels of 2^-40 of its piece.
    """
    edges = np.asarray(breaks, dtype=float)
    left, right = edges[:-1], edges[1:]
    coarser = np.full(left.size, np.inf)
    done: list[tuple[Array, Array]] = []
    scale = 0.0
    for _ in range(HALVINGS):
        coefficients = panel_coefficients(function, left, right, degree)
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
        # So do panels that are resolved up to their own rounding errors, once these are known.
        scale = max(scale, float(np.max(sizes, where=resolved & (tails <= SHAKEN * sizes), initial=0.0)))
        done.append((left[resolved], coefficients[:, resolved]))
        left, right = left[~resolved], right[~resolved]
        if not left.size:
            return _assembled(done, float(edges[-1]))
        stagnant = np.count_nonzero(tails[~resolved] > 0.5 * coarser[~resolved]) > left.size // 2
        if left.size > MOST_PANELS * (1 if stagnant else edges.size - 1):
            break
        middle, coarser = (left + right) / 2.0, np.tile(tails[~resolved], 2)
        left, right = np.concatenate([left, middle]), np.concatenate([middle, right])
    raise NotSmooth(float(left.min()))


def joined(forms: Sequence[PiecewiseChebyshev]) -> PiecewiseChebyshev:
    """One form of consecutive forms of the same degree."""
    breaks = np.concatenate([forms[0].breaks[:1], *(form.breaks[1:] for form in forms)])
    return PiecewiseChebyshev(breaks, np.concatenate([form.coefficients for form in forms], axis=1))


def nodes(left: Array, right: Array, degree: int = DEGREE) -> Array:
    """Chebyshev points of the first kind on each panel, shape (degree + 1, m); never an end point."""
    unit = _unit_nodes(degree)[:, None]
    return (left * (1.0 - unit) + right * (1.0 + unit)) / 2.0


def _largest(coefficients: Array) -> Array:
    return np.abs(coefficients).max(axis=(0, *range(2, coefficients.ndim)))


def panel_coefficients(function: Callable[[Array], Array], left: Array, right: Array, degree: int) -> Array:
    """Coefficients on each panel, shape (degree + 1, m, ...); raises NotSmooth where a value is not finite."""
    points = nodes(left, right, degree)
    values = np.asarray(function(points.ravel()), dtype=float)
    wrong = ~np.isfinite(values).reshape(points.size, -1).all(axis=1)
    if wrong.any():
        raise NotSmooth(float(points.ravel()[wrong].min()))
    return series(values.reshape(points.shape + values.shape[1:]))


def series(values: Array) -> Array:
    """Coefficients of panels with these values at their ``nodes``, shape (degree + 1, m, ...) both."""
    return np.tensordot(_transform(len(values) - 1), values, axes=1)


def _assembled(parts: list[tuple[Array, Array]], end: float) -> PiecewiseChebyshev:
    starts = np.concatenate([start for start, _ in parts])
    coefficients = np.concatenate([block for _, block in parts], axis=1)
    order = np.argsort(starts)
    return PiecewiseChebyshev(np.append(starts[order], end), coefficients[:, order])


@cache
def _unit_nodes(degree: int) -> Array:
    return chebyshev.chebpts1(degree + 1)


@cache
def _transform(degree: int) -> Array:
    """Matrix from values at the first-kind points to coefficients, by discrete orthogonality."""
    weights = np.full(degree + 1, 2.0 / (degree + 1))
    weights[0] /= 2.0
    return chebyshev.chebvander(_unit_nodes(degree), degree).T * weights[:, None]


@cache
def differentiation_matrix(degree: int) -> Array:
    """Matrix from coefficients to the derivative's coefficients on [-1, 1], square, its last row zero."""
    return np.pad(chebyshev.chebder(np.eye(degree + 1), axis=0), ((0, 1), (0, 0)))


@cache
def integration_matrix(degree: int) -> Array:
    """Matrix from values at the first-kind points of [-1, 1] to the integrals from -1 to each of them, square."""
    integrals = chebyshev.chebint(np.eye(degree + 1), lbnd=-1, axis=0)
    return chebyshev.chebvander(_unit_nodes(degree), degree + 1) @ integrals @ _transform(degree)


def on_panels(coefficients: Array, panel: IndexArray, local: Array) -> Array:
    """Sums of series (shape (degree + 1, m)): each point of [-1, 1] takes the series of its own panel, by Clenshaw."""
    twice = 2.0 * local
    older = newer = np.zeros(local.shape)
    for row in coefficients[:0:-1]:
        older, newer = newer, row[panel] + twice * newer - older
    return coefficients[0][panel] + local * newer - older


def polynomials(local: Array, count: int) -> Array:
    """T_0, T_1, ... at points of [-1, 1] (shape (n,)), by their recurrence; shape (n, count)."""
    values = np.empty((count, local.size))
    values[0], values[1] = 1.0, local
    twice = 2.0 * local
    for k in range(2, count):
        values[k] = twice * values[k - 1] - values[k - 2]
    return values.T


GUESSES = 16
"""Places in each panel from which Newton's method begins: nearer to each other than a panel's details."""

NEWTON_STEPS = 20
"""Most steps to an inverse; convergence is quadratic."""

SETTLED = 4e-15
"""Last step that counts as rounding, for places of a few units."""

JUMP = 1e-12
"""Difference of the values of two panels at their common end, as a share of the whole rise, that rounding may leave."""


@dataclass(frozen=True, eq=False)
class Rising:
    """A function that rises from 0 at 0 to the end of its form."""

    form: PiecewiseChebyshev

    @property
    def end(self) -> float:
        """The place where the form ends."""
        return float(self.form.breaks[-1])

    def __call__(self, places: Array) -> Array:
        """Values at places, shape (n,)."""
        return self.form(places)

    @cached_property
    def _guesses(self) -> tuple[Array, Array, PiecewiseChebyshev]:
        breaks = self.form.breaks
        within = breaks[:-1, None] + np.diff(breaks)[:, None] * (np.arange(GUESSES) / GUESSES)
        places = np.append(within.ravel(), breaks[-1])
        return places, self(places), self.form.differentiated()

    def inverse(self, values: Array) -> Array:
        """Places with these values, shape (n,), within the form; raises Unanswered where Newton's method finds none."""
        guesses, known, rate = self._guesses
        places = np.interp(values, known, guesses)
        for _ in range(NEWTON_STEPS):
            step = (self(places) - values) / rate(places)
            places = np.clip(places - step, 0.0, self.end)
            if np.max(np.abs(step), initial=0.0) <= SETTLED:
                return places
        if np.max(np.abs(self(places) - values)) <= JUMP * known[-1]:
            return places
        raise Unanswered("a rising function could not be inverted")
