"""Piecewise Chebyshev forms that are proven to miss no feature of their formula, however narrow.

A form that is fitted to samples cannot know what lies between them.  Here every panel is divided into cells, and discs
about the cells (``ncgear.numerics.discs``) prove that the formula is analytic so far around a cell that its values at a
few points of the cell give it everywhere: a function within r of some number on the ellipse with foci at the cell's
ends and half axes adding up to 3 half cells differs from its interpolant at n Chebyshev points by at most 2 r 3^(1 -
n).  At those points, which the fit has not used, formula and form are compared.  A cell without such a proof is halved;
a panel whose form misses the formula is halved too.  A formula without a proof within the budget is refused, with the
place.  Source of the bound: L. N. Trefethen, "Approximation Theory and Approximation Practice", SIAM 2013, theorem 8.2.
"""

from __future__ import annotations

import numpy as np

from ncgear.frozen import dataclass
from ncgear.numerics import chebyshev
from ncgear.numerics.arrays import Array, IndexArray, Mask
from ncgear.numerics.chebyshev import NotSmooth, PiecewiseChebyshev
from ncgear.numerics.formula import Formula
from ncgear.numerics.zeros import all_zeros

POINTS = 41
"""Points at which a cell is compared: 3^-40 is 1e-19, so that a bound may be a million times the formula's size."""

AROUND = 5.0 / 3.0
"""Radius of the disc about a cell over its half width: half the sum of 3 and 1/3, the ellipse's longer half axis."""

AGREED = 1e-12
"""Largest difference of a form from its formula over the formula's size: the accuracy of the design's quantities."""

TAIL = 100.0
"""Further difference that is allowed, as a multiple of the size of the form's last coefficients: these sizes show the
rounding errors of the formula itself, and a point's error is the sum of many such."""

HALVINGS = 45
"""Most halvings of a panel into cells: beyond them a root at the panel's end, as in x^0.9, counts as nothing."""

SHORT = 8
"""Halvings after which the range of a cell's values may prove it: beside a root, where the disc gives no proof."""

MOST_CELLS = 20_000
"""Most cells at once for one form; a wave needs one for about three turns, so this is some 50 000 turns."""

MOST_PANELS = 2000
"""Most panels of a form: a wave needs two."""

MOST_CHOICES = 200
"""Most places where a formula may change from one expression to another."""

AT_ONCE = 400
"""Cells that are compared together: 16 400 points, some megabytes for the longest formula."""

SHAKEN_BY = 4.0 * np.finfo(float).eps
"""Rounding errors of a formula's value, relative to the argument times the slope: some units of each operation from the
argument to the place where it changes fast."""

UNDECIDED = 1e-13
"""Share of its largest value below which a condition counts as zero, so that either side may be taken."""


def proven(formula: Formula, start: float, end: float) -> PiecewiseChebyshev:
    """The form of a formula without choices on [start, end]; raises NotSmooth where it cannot be proven."""

    def agreed(left: Array, right: Array, coefficients: Array, sizes: Array) -> Mask:
        return _agreed(formula, _Panels(left, right, coefficients), sizes)

    def shaken(points: Array) -> Array:
        errors: Array = SHAKEN_BY * np.abs(points * formula.derivative().values(points))
        return np.where(np.isfinite(errors), errors, 0.0)

    form = chebyshev.fitted(formula.values, np.array([start, end]), agreed=agreed, shaken=shaken)
    if form.breaks.size > MOST_PANELS + 1:
        raise NotSmooth(float(form.breaks[np.argmin(np.diff(form.breaks))]))
    return form


def smooth_parts(formula: Formula, start: float, end: float) -> list[tuple[float, float, Formula]]:
    """Stretches of [start, end] of one expression each; raises NotSmooth for too many or unproven conditions."""
    done: list[tuple[float, float, Formula]] = []
    waiting = [(start, end, formula)]
    while waiting:
        low, high, whole = waiting.pop()
        if whole.condition is None:
            done.append((low, high, whole))
            continue
        sides = _sides(whole.condition, low, high)
        if len(done) + len(waiting) + len(sides) > MOST_CHOICES:
            raise NotSmooth(low)
        waiting.extend((a, b, whole.where(negative=negative)) for a, b, negative in reversed(sides))
    return done


def _sides(condition: Formula, low: float, high: float) -> list[tuple[float, float, bool]]:
    """Stretches on which a condition is negative or not, in rising order."""
    form = proven(condition, low, high)
    zeros = all_zeros(form)
    edges = np.array([low, *zeros[(zeros > low) & (zeros < high)], high])
    values = condition.values((edges[:-1] + edges[1:]) / 2.0)
    decided = np.abs(values) > UNDECIDED * np.abs(form.coefficients).max()
    sides: list[tuple[float, float, bool]] = []
    for a, b, value, sure in zip(edges[:-1].tolist(), edges[1:].tolist(), values, decided, strict=True):
        negative = bool(value < 0.0) if sure or not sides else sides[-1][2]
        if sides and negative == sides[-1][2]:
            a = sides.pop()[0]
        sides.append((a, b, negative))
    return sides


@dataclass(frozen=True, eq=False)
class _Panels:
    """Panels anywhere, from ``left`` to ``right`` (shape (m,)), with ``coefficients`` (shape (degree + 1, m))."""

    left: Array
    right: Array
    coefficients: Array

    def values(self, points: Array, owner: IndexArray) -> Array:
        """Values at points (shape (n, k)), each column on the panel of that number."""
        low, high = self.left[owner], self.right[owner]
        return chebyshev.on_panels(self.coefficients, owner, ((points - low) - (high - points)) / (high - low))


def _agreed(formula: Formula, panels: _Panels, sizes: Array) -> Mask:
    """Mask of panels that give the formula everywhere, by sizes that count; raises NotSmooth for too many cells."""
    allowed = AGREED * sizes + TAIL * np.abs(panels.coefficients[-3:]).max(axis=0)
    good = np.ones(panels.left.size, dtype=bool)
    left, right, owner = panels.left, panels.right, np.arange(panels.left.size)
    for halving in range(HALVINGS):
        smooth = _without_surprise(formula, left, right, allowed[owner], short=halving >= SHORT)
        missed = _missed(formula, panels, (left[smooth], right[smooth], owner[smooth]))
        good[owner[smooth][missed > allowed[owner[smooth]]]] = False
        open_still = ~smooth & good[owner]
        left, right, owner = left[open_still], right[open_still], owner[open_still]
        if not left.size:
            return good
        if left.size > MOST_CELLS:
            raise NotSmooth(float(left.min()))
        middle = (left + right) / 2.0
        left, right = np.concatenate([left, middle]), np.concatenate([middle, right])
        owner = np.tile(owner, 2)
    # Beside an unresolved peak the size that counts may not be known yet: shorter panels will show it.
    good[owner] = False
    return good


def _without_surprise(formula: Formula, left: Array, right: Array, allowed: Array, *, short: bool) -> Mask:
    """Mask of cells on which the formula has no more than their points show."""
    center, half = (left + right) / 2.0, (right - left) / 2.0
    spread = formula.spread(center, AROUND * half, real=False)
    smooth: Mask = 2.0 * spread * 3.0 ** (1 - POINTS) <= allowed
    if short and not smooth.all():
        smooth |= 2.0 * formula.spread(center, half, real=True) <= allowed
    return smooth


def _missed(formula: Formula, panels: _Panels, cells: tuple[Array, Array, IndexArray]) -> Array:
    """The largest difference of formula and form at the points of each cell, shape (m,); infinite without a value."""
    left, right, owner = cells
    worst = np.zeros(left.size)
    for first in range(0, left.size, AT_ONCE):
        part = slice(first, first + AT_ONCE)
        points = chebyshev.nodes(left[part], right[part], POINTS - 1)
        form = panels.values(points, owner[part])
        difference = np.abs(form - formula.values(points.ravel()).reshape(points.shape)).max(axis=0)
        worst[part] = np.where(np.isfinite(difference), difference, np.inf)
    return worst
