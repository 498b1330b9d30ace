"""The force against the slider in one of its strokes, as a polynomial, a table, or an expression in the displacement.

Every form gives the curve of the force with its derivatives, its antiderivative, its zeros, and the places between
which it is monotone; force and work follow from these.  The points of a table are joined by the monotone cubics of F.
N. Fritsch and J. Butland, "A method for constructing local monotone piecewise cubic interpolants", SIAM J. Sci. Stat.
Comput. 5 (1984): their slope is continuous, and the force never leaves the range of the two points beside it, so a
table that is nowhere negative stays so.  Beyond the table's ends the force keeps its end value.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from functools import cached_property, lru_cache
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np
from numpy.polynomial import Polynomial

from ncgear.errors import WrongInput
from ncgear.frozen import dataclass
from ncgear.numerics import jet
from ncgear.numerics.arrays import Array, distinct
from ncgear.numerics.chebyshev import NotSmooth, PiecewiseChebyshev, joined, nodes
from ncgear.numerics.formula import SHOWN, Formula, composed
from ncgear.numerics.jet import Jet
from ncgear.numerics.proven import proven, smooth_parts
from ncgear.numerics.zeros import all_zeros

if TYPE_CHECKING:
    from scipy.interpolate import PPoly


class Resistance(ABC):
    """Force in N over the displacement in mm.

    A fitted curve may be negative where there is nothing to press: the published baler's is negative below 33.7 mm.  A
    resistance cannot push, so negative values count as zero unless ``keep_negative`` is true.
    """

    keep_negative: bool

    @abstractmethod
    def fitted_n(self, displacement: Jet) -> Jet:
        """The curve itself, negative stretches included, with derivatives; one-sided where it has a corner."""

    @abstractmethod
    def work_from_retracted_n_mm(self, displacement_mm: Array, stroke_mm: float) -> Array:
        """Integral of the curve itself from 0 to displacements within the stroke, shape (n,)."""

    @abstractmethod
    def zeros_mm(self, stroke_mm: float) -> Array:
        """Displacements inside the stroke at which the curve is zero, in rising order."""

    @abstractmethod
    def turns_mm(self, stroke_mm: float) -> Array:
        """Displacements inside the stroke between which the curve is smooth and monotone, in rising order."""

    def panels_mm(self, stroke_mm: float) -> Array:
        """Displacements inside the stroke between which a polynomial is the curve, more of them where it is sharp."""
        return np.empty(0)

    def knots_mm(self, stroke_mm: float) -> Array:
        """Displacements inside the stroke, in rising order; searches between neighbours miss nothing of the curve."""
        return distinct(np.append(self.turns_mm(stroke_mm), self.panels_mm(stroke_mm)))

    def negative_stretches_mm(self, stroke_mm: float) -> list[tuple[float, float]]:
        """Stretches of the stroke on which the curve is negative."""
        edges = [0.0, *self.zeros_mm(stroke_mm).tolist(), stroke_mm]
        middles = np.array([(low + high) / 2.0 for low, high in pairwise(edges)])
        negative = self.fitted_n(Jet(middles[None, :])).value < 0.0
        return [stretch for stretch, below in zip(pairwise(edges), negative, strict=True) if below]

    def force_jet_n(self, displacement: Jet) -> Jet:
        """Force in N with derivatives; one-sided at corners, for example where the force sets in."""
        force = self.fitted_n(displacement)
        return Jet(np.where(self.keep_negative | (force.value > 0.0), force.coefficients, 0.0))

    def force_n(self, displacement_mm: Array) -> Array:
        """Force in N at displacements in mm, any shape."""
        force = self.fitted_n(Jet(displacement_mm.reshape(1, -1))).value.reshape(displacement_mm.shape)
        return force if self.keep_negative else np.maximum(force, 0.0)

    def work_n_mm(self, displacement_mm: Array, stroke_mm: float) -> Array:
        """Work in N mm from the retracted end to displacements in mm, shape (n,); the integral of ``force_n``."""
        if self.keep_negative:
            return self.work_from_retracted_n_mm(displacement_mm, stroke_mm)
        edges = np.concatenate([[0.0], self.zeros_mm(stroke_mm), [stroke_mm]])
        potential = self.work_from_retracted_n_mm(edges, stroke_mm)
        whole = np.concatenate([[0.0], np.cumsum(np.maximum(np.diff(potential), 0.0))])
        stretch = np.maximum(np.searchsorted(edges, displacement_mm, side="right") - 1, 0)
        begun = self.work_from_retracted_n_mm(displacement_mm, stroke_mm) - potential[stretch]
        return whole[stretch] + np.maximum(begun, 0.0)


def within(displacements_mm: Array, stroke_mm: float) -> Array:
    """The displacements that lie inside the stroke, in rising order, each once."""
    return distinct(displacements_mm[(displacements_mm > 0.0) & (displacements_mm < stroke_mm)])


@dataclass(frozen=True)
class PolynomialResistance(Resistance):
    """Force in N as a polynomial in the displacement in mm, constant term first; without coefficients it is zero."""

    coefficients_n: tuple[float, ...] = (0.0,)
    keep_negative: bool = False

    def fitted_n(self, displacement: Jet) -> Jet:
        """The polynomial itself, with derivatives."""
        return jet.polynomial(self.coefficients_n, displacement)

    def work_from_retracted_n_mm(self, displacement_mm: Array, stroke_mm: float) -> Array:
        """The antiderivative of the polynomial."""
        return Polynomial(self.coefficients_n).integ()(displacement_mm)

    def zeros_mm(self, stroke_mm: float) -> Array:
        """Real zeros inside the stroke."""
        return _real_zeros(Polynomial(self.coefficients_n), stroke_mm)

    def turns_mm(self, stroke_mm: float) -> Array:
        """Real zeros of the derivative inside the stroke."""
        return _real_zeros(Polynomial(self.coefficients_n).deriv(), stroke_mm)


def _real_zeros(curve: Polynomial, stroke_mm: float) -> Array:
    zeros = curve.roots()
    return within(zeros.real[np.abs(zeros.imag) < 1e-9 * stroke_mm], stroke_mm)


@dataclass(frozen=True)
class TableResistance(Resistance):
    """Forces in N at strictly rising displacements in mm, two points or more.

    Raises WrongInput for displacements that do not rise, and for unequal numbers of both.
    """

    displacement_mm: tuple[float, ...]
    at_points_n: tuple[float, ...]
    keep_negative: bool = False

    def __post_init__(self) -> None:
        points, forces = len(self.displacement_mm), len(self.at_points_n)
        if points != forces or points < 2:
            problem = f"{forces} forces for {points} displacements; one for each of two or more is right"
            raise WrongInput(problem, key="resistance.table.force_n")
        if not np.all(np.diff(self.displacement_mm) > 0.0):
            raise WrongInput("the displacements must rise strictly", key="resistance.table.displacement_mm")

    @cached_property
    def _cubics(self) -> PPoly:
        """The cubics between the points, and a constant on either side."""
        from scipy.interpolate import PchipInterpolator, PPoly

        inner = PchipInterpolator(self.displacement_mm, self.at_points_n)
        first, last = self.displacement_mm[0], self.displacement_mm[-1]
        before, after = np.zeros((4, 1)), np.zeros((4, 1))
        before[3], after[3] = self.at_points_n[0], self.at_points_n[-1]
        breaks = np.concatenate([[min(first, 0.0) - 1.0], inner.x, [last + 1.0]])
        return PPoly(np.hstack([before, inner.c, after]), breaks)

    def fitted_n(self, displacement: Jet) -> Jet:
        """The cubic at each displacement, with derivatives."""
        cubics = self._cubics
        place = np.searchsorted(cubics.x, displacement.value, side="right") - 1
        piece = np.clip(place, 0, cubics.c.shape[1] - 1)
        return jet.polynomial(cubics.c[::-1, piece], displacement - cubics.x[piece])

    def work_from_retracted_n_mm(self, displacement_mm: Array, stroke_mm: float) -> Array:
        """The antiderivative of the cubics."""
        antiderivative = self._cubics.antiderivative()
        return antiderivative(displacement_mm) - antiderivative(0.0)

    def zeros_mm(self, stroke_mm: float) -> Array:
        """Zeros of the cubics, and both ends of stretches without force."""
        forces, points = np.array(self.at_points_n), np.array(self.displacement_mm)
        crossings = self._cubics.roots(extrapolate=False)
        return within(np.concatenate([crossings[np.isfinite(crossings)], points[forces == 0.0]]), stroke_mm)

    def turns_mm(self, stroke_mm: float) -> Array:
        """The points of the table: the cubic between two of them is monotone."""
        return within(np.array(self.displacement_mm), stroke_mm)


MOST_TURNS = 500
"""Largest number of ups and downs over a stroke; some searches take milliseconds for each."""

FLAT = 1e-13
"""Slope, relative to the largest, that counts as zero; the form of the slope is a hundred times as accurate."""

AT_END = 1e-6
"""Least u: a turn nearer to the end, by a share of 1e-12 of the stroke, does not change the force."""

SAME = 1e-12
"""Distance, as a share of the stroke, below which two turns are one turn with rounding errors."""

NO_JUMP = 1e-9
"""Difference of the force on both sides of a joint, relative to the largest force, that does not count as a jump."""


@dataclass(frozen=True)
class FormulaResistance(Resistance):
    """Force in N as an expression in ``x``; ``max`` and the like may make corners, but jumps are not allowed.

    For a ``turning`` output the expression is a torque in N m over the angle in rad.

    Raises WrongInput where the text is no expression, or where the function jumps or is not smooth between its corners;
    the error names ``key`` of the design file.
    """

    text: str
    keep_negative: bool = False
    key: str = "resistance.expression_n"
    turning: bool = False

    @cached_property
    def _formula(self) -> Formula:
        return composed(f"1000*({self.text})" if self.turning else self.text, self.key, "x")

    def fitted_n(self, displacement: Jet) -> Jet:
        """The expression itself, with derivatives."""
        return self._formula(displacement)

    def work_from_retracted_n_mm(self, displacement_mm: Array, stroke_mm: float) -> Array:
        """The antiderivative of a piecewise Chebyshev form that is accurate to rounding error."""
        return _forms(self, stroke_mm).force.integrated()(displacement_mm)

    def zeros_mm(self, stroke_mm: float) -> Array:
        """Zeros of the Chebyshev form."""
        return within(all_zeros(_forms(self, stroke_mm).force), stroke_mm)

    def turns_mm(self, stroke_mm: float) -> Array:
        """Corners, and zeros of the Chebyshev form of the derivative."""
        return within(_forms(self, stroke_mm).turns_mm, stroke_mm)

    def panels_mm(self, stroke_mm: float) -> Array:
        """The panels of the Chebyshev forms of the slope."""
        return _forms(self, stroke_mm).panels_mm


@dataclass(frozen=True, eq=False)
class _Forms:
    """A proven form of a force over the stroke, and the places between which it is smooth and monotone.

    ``panels_mm`` are the ends, inside the stroke, of the panels of the slope's form.
    """

    force: PiecewiseChebyshev
    turns_mm: Array
    panels_mm: Array


@lru_cache(maxsize=16)
def _forms(resistance: FormulaResistance, stroke_mm: float) -> _Forms:
    text = resistance.text if len(resistance.text) <= SHOWN else f"{resistance.text[:SHOWN]}..."
    place, load, factor = ("rad", "N m", 1e-3) if resistance.turning else ("mm", "N", 1.0)
    right = f"one over the whole stroke, 0 to {stroke_mm:g} {place}, or a table, is right"
    try:
        parts = smooth_parts(resistance._formula, 0.0, stroke_mm)
        forces = [proven(part, start, end) for start, end, part in parts]
        slopes = [slope for start, end, part in parts for slope in _slopes(part, start, end)]
    except NotSmooth as fault:
        problem = f"{text!r} is no smooth function near x = {fault.at:.6g} {place}"
        faster = "or changes there faster than can be followed"
        raise WrongInput(f"{problem}, {faster}; {right}", key=resistance.key) from fault
    corners = np.array([start for start, _, _ in parts[1:]])
    whole = joined(forces)
    for corner, before, after in zip(corners, forces, forces[1:], strict=False):
        low, high = before.final, float(after(np.array([corner]))[0])
        if not abs(high - low) <= NO_JUMP * np.abs(whole.coefficients).max():
            jump = f"from {factor * low:.6g} to {factor * high:.6g} {load} at x = {corner:.6g} {place}"
            raise WrongInput(f"{text!r} jumps {jump}; {right}", key=resistance.key)
    steepest = max(slope.steepest for slope in slopes)
    turns = distinct(np.concatenate([corners, *(slope.turns_mm(steepest) for slope in slopes)]))
    # Two forms that meet at a turn may both give it.
    turns = turns[np.diff(turns, prepend=-np.inf) > SAME * stroke_mm]
    if turns.size > MOST_TURNS:
        problem = f"{text!r} turns up or down {turns.size} times over the stroke of {stroke_mm:g} {place}"
        raise WrongInput(f"{problem}; at most {MOST_TURNS} turns are followed", key=resistance.key)
    panels = distinct(np.concatenate([slope.at_mm(slope.form.breaks) for slope in slopes]))
    return _Forms(whole, turns, within(panels, stroke_mm))


@dataclass(frozen=True, eq=False)
class _Slope:
    """A form of a force's slope over x, or over u where x = end + width u**2."""

    form: PiecewiseChebyshev
    end_mm: float = 0.0
    width_mm: float | None = None

    @property
    def scale_mm(self) -> float:
        """Length in mm of one unit of the form's variable."""
        return 1.0 if self.width_mm is None else abs(self.width_mm)

    @property
    def steepest(self) -> float:
        """Largest slope in N/mm."""
        return float(np.abs(self.form.coefficients).max()) / self.scale_mm

    def turns_mm(self, steepest: float) -> Array:
        """Zeros of the slope, shape (n,), without stretches that are only rounding errors of the steepest slope."""
        return self.at_mm(_zeros(self.form, FLAT * steepest * self.scale_mm))

    def at_mm(self, places: Array) -> Array:
        """The displacements at these values of the form's variable, shape (n,)."""
        return places if self.width_mm is None else self.end_mm + self.width_mm * places**2


def _slopes(force: Formula, start: float, end: float) -> list[_Slope]:
    """Forms of the slope of a force without corners; raises NotSmooth.

    Where the slope is like a root at an end, as the slope of x**1.5 is, u counts from both ends: over u the slope is
    like a whole power.
    """
    try:
        return [_Slope(proven(force.derivative(), start, end))]
    except NotSmooth:
        for place in (start, end):
            if np.isinf(force.derivative().values(np.array([place]))[0]):
                raise NotSmooth(place) from None
        width = (end - start) / 2.0
        return [_slope_from(force, place, way) for place, way in ((start, width), (end, -width))]


def _slope_from(force: Formula, end: float, width: float) -> _Slope:
    try:
        return _Slope(proven(force.from_end(end, width).derivative(), AT_END, 1.0), end, width)
    except NotSmooth as fault:
        raise NotSmooth(end + width * fault.at**2) from None


def _zeros(slope: PiecewiseChebyshev, least: float) -> Array:
    """Zeros inside the range of a slope, shape (n,), without zeros between stretches where it stays under ``least``."""
    zeros = all_zeros(slope)
    zeros = zeros[(zeros > slope.breaks[0]) & (zeros < slope.breaks[-1])]
    edges = np.concatenate([slope.breaks[:1], zeros, slope.breaks[-1:]])
    samples = [(edges[:-1] + edges[1:]) / 2.0, nodes(slope.breaks[:-1], slope.breaks[1:]).ravel()]
    points = np.sort(np.concatenate(samples))
    largest = np.maximum.reduceat(np.abs(slope(points)), np.searchsorted(points, edges[:-1]))
    flat = largest <= least
    return zeros[~(flat[:-1] & flat[1:])]
