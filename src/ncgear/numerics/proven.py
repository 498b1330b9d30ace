"""Chebyshev forms of expressions that miss no feature of theirs, however narrow it is.

The panels of a form are halved where samples show that they must be.  A peak that is narrower than the samples' spacing
shows on none of them.  Here bounds of the derivatives on whole cells (see ``intervals``) prove where a function is as
good as a polynomial of low degree, and each cell is compared with the form at points that the form did not use.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ncgear.numerics import chebyshev, intervals
from ncgear.numerics.arrays import Array
from ncgear.numerics.chebyshev import HALVINGS, ROUNDING, NotSmooth, PiecewiseChebyshev
from ncgear.numerics.jet import Jet

ORDER = 12
"""Order of the derivative whose bound proves a cell: a wave takes a cell for a sixth of a turn."""

HIDDEN = 1e-10
"""What a cell's polynomial may miss of the function, relative to its largest value."""

NOISE = 1e-9
"""Largest share of the largest value that may be rounding error.  A peak of width w at x has 1e-16 x/w of it: 1e-9 is
reached where a force changes within a ten-thousandth of a millimetre at 600 mm."""

NOTHING = np.finfo(float).tiny
"""What a cell of the function zero may miss: bounds that are rounded outwards are not zero."""

SEEN = 1e-8
"""Largest difference between form and function, relative to the largest value, that shows no hidden feature."""

MOST_CELLS = 1 << 15
"""Most cells that are halved at once; a wave of 3000 turns needs 20 000."""

ROUNDS = 8
"""Most times that a form is made anew.  One round tells where all hidden features are, for cells are proven apart from
the form; a second one is needed only where features hide beside others."""


def proven_form(function: Callable[[Jet], Jet], start: float, end: float) -> PiecewiseChebyshev:
    """The form of an expression's values on [start, end]; no feature over SEEN of its largest value is missed.

    ``function`` maps a jet of the variable, of points or of intervals, to the expression's.  Raises NotSmooth where
    it is not finite, not smooth, or has too many waves.
    """

    def expression(points: Array, order: int) -> Jet:
        return function(Jet.variable(points, order))

    breaks = np.array([start, end])
    left, right, scale = _cells(function, start, end)
    points = chebyshev.nodes(left, right, ORDER)
    exact = expression(points.ravel(), 0).value.reshape(points.shape)
    form = fitted_by_noise(expression, breaks, points.ravel())
    for _ in range(ROUNDS):
        missed = (np.abs(form(points) - exact) > SEEN * scale).any(axis=0)
        if not missed.any():
            return form
        breaks = np.unique(np.concatenate([breaks, left[missed], right[missed]]))
        form = fitted_by_noise(expression, breaks, points.ravel())
    raise NotSmooth(float(left[missed][0]))


def fitted_by_noise(function: Callable[[Array, int], Jet], breaks: Array, points: Array) -> PiecewiseChebyshev:
    """The form of a function of points and an order, whose rounding errors are those of its argument times its slope.

    ``points`` (shape (n,)) lie where the function is large or steep.  Raises NotSmooth as ``chebyshev.fitted`` does.
    """
    at = function(points, 1)
    scale = float(np.abs(at.value).max())
    noise = 4.0 * np.finfo(float).eps * float(np.abs(points * at.derivative(1)).max())
    rounding = min(max(ROUNDING, noise / scale), NOISE) if scale and np.isfinite(noise) else ROUNDING
    return chebyshev.fitted(lambda x: function(x, 0).value, breaks, scale=scale, rounding=rounding)


def _cells(function: Callable[[Jet], Jet], start: float, end: float) -> tuple[Array, Array, float]:
    """Cells on which the function is as good as a polynomial of degree ORDER - 1, and its largest value at samples.

    On a cell of width h the polynomial of degree k - 1 through Chebyshev points misses at most 2 (h/4)^k c_k, where
    c_k bounds the k-th derivative over k! (Trefethen, see ``chebyshev``, chapter 7).  Beside a zero of a root of higher
    order, where the derivatives have no bounds, the range of the values is enough.
    """
    left, right, scale = np.array([start]), np.array([end]), 0.0
    powers = np.arange(1.0, ORDER + 1.0)[:, None]
    done: list[tuple[Array, Array]] = []
    for _ in range(HALVINGS):
        with np.errstate(all="ignore"):
            bound = intervals.coefficients(function(intervals.variable(left, right, ORDER)))
            scale = max(scale, float(np.abs(function(Jet.variable((left + right) / 2.0, 1)).value).max()))
            missed = np.fmin.reduce(2.0 * ((right - left) / 4.0) ** powers * bound.magnitude[1:])
            missed = np.fmin(missed, bound.high[0] - bound.low[0])
        proven = missed <= np.maximum(HIDDEN * scale, NOTHING)
        done.append((left[proven], right[proven]))
        left, right = left[~proven], right[~proven]
        if not left.size:
            return np.concatenate([low for low, _ in done]), np.concatenate([high for _, high in done]), scale
        if left.size > MOST_CELLS:
            break
        middle = (left + right) / 2.0
        left, right = np.concatenate([left, middle]), np.concatenate([middle, right])
    raise NotSmooth(float(left[0]))
