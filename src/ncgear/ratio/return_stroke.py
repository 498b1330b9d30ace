"""The return of one three-segment stroke: solved, closed to rounding, and refused with a reason where there is none.

In tau, the covered share of the return, i12 (or 1/i12) is the cubic with the working stroke's values and slopes at its
two ends, plus multiples of tau^2 (1 - tau)^2, which changes neither end.  One multiple makes the return cover the
remaining driven angle.  For the inverse it follows from a linear equation.  For the ratio there is exactly one above
the multiple at which the polynomial touches zero; it is found in a bracket and then polished on the spectral integral,
since the polynomial may be 1e5 times as large as its smallest value.  One quantity remains free: the published method's
constant e (source in ``working_stroke.py``), or a skewness, which is searched for the least peak acceleration.
"""

from __future__ import annotations

from contextlib import suppress
from dataclasses import field, replace
from functools import cache, cached_property
from math import comb

import numpy as np
from numpy.polynomial import Polynomial, legendre

from ncgear.errors import NoSuchMechanism
from ncgear.frozen import dataclass
from ncgear.mechanisms.mechanism import Mechanism
from ncgear.numerics import chebyshev, jet
from ncgear.numerics.arrays import Array, Mask, Number, distinct
from ncgear.numerics.chebyshev import NotSmooth, PiecewiseChebyshev
from ncgear.numerics.jet import Jet
from ncgear.numerics.units import in_words
from ncgear.numerics.zeros import zeros_between
from ncgear.ratio.transmission import CLOSED, STANDSTILL


@dataclass(frozen=True)
class ReturnEnds:
    """Conditions of the return: driving angles, the driven angle to cover, ratio and its slope at both ends."""

    start_rad: float
    end_rad: float
    start_driven_rad: float
    end_driven_rad: float
    start_ratio: float
    start_ratio_slope: float
    end_ratio: float
    end_ratio_slope: float

    @property
    def length_rad(self) -> float:
        """Driving angle of the return."""
        return self.end_rad - self.start_rad

    @property
    def driven_length_rad(self) -> float:
        """Driven angle of the return."""
        return self.end_driven_rad - self.start_driven_rad

    @property
    def cubic(self) -> Polynomial:
        """The cubic in tau with the values and slopes of the two ends."""
        values = self.start_ratio, self.start_ratio_slope, self.end_ratio, self.end_ratio_slope
        return Polynomial(hermite(*values, self.length_rad))

    def inverted(self) -> ReturnEnds:
        """The same ends for 1/i12 in place of i12."""
        return replace(
            self,
            start_ratio=1.0 / self.start_ratio,
            start_ratio_slope=-self.start_ratio_slope / self.start_ratio**2,
            end_ratio=1.0 / self.end_ratio,
            end_ratio_slope=-self.end_ratio_slope / self.end_ratio**2,
        )


def _not_positive(at_rad: float, ends: ReturnEnds) -> NoSuchMechanism:
    """The refusal of a ratio that is zero, negative or infinite at a driving angle in rad."""
    return NoSuchMechanism(
        f"the return's ratio passes through zero or infinity, or comes too near to it, at phi1 = "
        f"{in_words(at_rad)}; {_remedy(ends)}",
        key="motion.return",
    )


def _remedy(ends: ReturnEnds) -> str:
    """Words for a change that brings the ratio at theta4, which goes with 1/sqrt(-a1), nearer to the return's mean."""
    mean = ends.length_rad / ends.driven_length_rad
    towards = "farther from" if ends.start_ratio > mean else "nearer to"
    return (
        f"the ratio is {ends.start_ratio:.4g} where it begins and must be {mean:.4g} in the mean: an a1 {towards} zero "
        "brings the two together, another theta4, e or basis of the return may help"
    )


@dataclass(frozen=True, eq=False)
class ReturnLaw:
    """The closed return: a polynomial in tau is i12, or 1/i12 when ``inverse`` is true.

    Its coefficients in tau may be 1e5 times its smallest value.  So ``local`` is in powers of tau - ``about``, where
    ``about`` is the place of the smallest value and the constant term is that value.  ``correction``, which closes the
    cycle to rounding error, is in tau and kept apart, since a sum would round it off.
    """

    ends: ReturnEnds
    local: Polynomial
    inverse: bool
    about: float = 0.0
    correction: Polynomial = field(default_factory=lambda: Polynomial([0.0]))

    @property
    def polynomial(self) -> Polynomial:
        """The polynomial in powers of tau."""
        return self.local(Polynomial([-self.about, 1.0])) + self.correction

    @property
    def extrapolated_ratio(self) -> float:
        """The polynomial's value at phi1 = 0, the published method's e."""
        origin = -self.ends.start_rad / self.ends.length_rad
        return float(self.local(origin - self.about) + self.correction(origin))

    def slope(self, phi1: Array, order: int) -> Jet:
        """dphi2/dphi1 = 1/i12 with derivatives."""
        tau = (Jet.variable(phi1, order) - self.ends.start_rad) * (1.0 / self.ends.length_rad)
        local, fine = (np.asarray(part.coef, dtype=float) for part in (self.local, self.correction))
        value = jet.polynomial(local, tau - self.about) + jet.polynomial(fine, tau)
        return value if self.inverse else 1.0 / value

    def driven_angle(self, phi1: Array, order: int) -> Jet:
        """phi2 with derivatives; the integral is spectral, to rounding error."""
        values = self.ends.start_driven_rad + self._driven_integral(phi1)
        if order == 0:
            return Jet(values[None, :])
        return self.slope(phi1, order - 1).integrated(values)

    @cached_property
    def _driven_integral(self) -> PiecewiseChebyshev:
        ends = (self.ends.start_rad, self.ends.end_rad)
        try:
            return chebyshev.fitted(lambda phi1: self.slope(phi1, 0).value, ends).integrated()
        except NotSmooth as fault:
            raise _not_positive(fault.at, self.ends) from fault

    @property
    def closure_error_rad(self) -> float:
        """Driven angle of the return less the angle that it must cover."""
        return self._driven_integral.final - self.ends.driven_length_rad


PLACES = np.linspace(0.0, 1.0, 65)
"""Places of the return at which its polynomial is checked, beside the places where it is level."""


def _lowest(polynomial: Polynomial) -> tuple[float, float]:
    """Smallest value on [0, 1] and where."""
    inner = polynomial.deriv().roots()
    candidates = np.clip(inner.real[np.abs(inner.imag) < 1e-9], 0.0, 1.0)
    points = np.concatenate([candidates, PLACES])
    values = polynomial(points)
    index = int(np.argmin(values))
    return float(values[index]), float(points[index])


def _unit_integral(polynomial: Polynomial) -> float:
    """The polynomial's integral over [0, 1]."""
    antiderivative = polynomial.integ()
    return float(antiderivative(1.0) - antiderivative(0.0))


NARROWEST = 24
"""Halvings of the return towards the place of its least ratio.  The driven gear's speed has a peak there about as
narrow, in returns, as the ratio is small, and STANDSTILL refuses a peak narrower than 2^-20."""


@cache
def _even_panels() -> Array:
    """Edges of 16 panels of [0, 1], which are shorter towards the ends."""
    return (1.0 - np.cos(np.linspace(0.0, np.pi, 17))) / 2.0


@cache
def _gauss() -> tuple[Array, Array]:
    """Points and weights of the Gauss-Legendre rule of 16 points on [-1, 1]."""
    points, weights = legendre.leggauss(16)
    return points, weights


@dataclass(frozen=True, eq=False)
class _Panels:
    """A Gauss-Legendre rule on [0, 1] whose panels are halved towards ``about``, shape (n,) each.

    Where a polynomial nearly touches zero at ``about``, its inverse has a pole beside each panel at three half-widths
    or more, so the relative error of 16 points is 5.8^-32.  ``offsets`` are tau - about, with all their digits.
    """

    about: float
    offsets: Array
    weights: Array

    @classmethod
    def towards(cls, about: float) -> _Panels:
        """The panels of a place in [0, 1]."""
        halves = 0.5 ** np.arange(1.0, NARROWEST + 1.0)
        edges = np.concatenate([_even_panels() - about, halves, -halves])
        edges = distinct(np.clip(edges, -about, 1.0 - about))
        points, weights = _gauss()
        middle, half = (edges[1:] + edges[:-1]) / 2.0, np.diff(edges) / 2.0
        return cls(about, (middle[:, None] + half[:, None] * points).ravel(), (half[:, None] * weights).ravel())


POLISHED = CLOSED / 20.0
"""Closure error in rad that needs no further Newton step: 25 rounding errors of a full turn.  A step costs a sixth of
the time of the whole law, and would only move the rounding."""

TOUCHING = 1e-12
"""Share of the largest coefficient below which a value counts as zero: 4500 rounding errors, for a touching point that
is a root of a polynomial of degree nine."""


def _closed_ratio(ends: ReturnEnds, base: Polynomial, direction: Polynomial) -> ReturnLaw:
    """i12 = base + c direction with c such that the return covers its driven angle.

    ``direction`` is positive inside the return, so the covered angle falls to zero as c grows, and grows without bound
    as c falls to the value at which the polynomial touches zero.  Above that value there is exactly one solution.
    """
    for ratio, at_rad in ((ends.start_ratio, ends.start_rad), (ends.end_ratio, ends.end_rad)):
        if not ratio > 0.0:
            raise _not_positive(at_rad, ends)
    least = _touching_multiple(base, direction)
    scale = max(1.0, abs(least), *np.abs(base.coef))
    target = ends.driven_length_rad / ends.length_rad
    local, about = _about_touching(base + least * direction)
    beyond, panels = direction(Polynomial([about, 1.0])), _Panels.towards(about)
    touching, rising = local(panels.offsets), beyond(panels.offsets)

    def excess(log_step: Array) -> Array:
        covered: Array = (1.0 / (touching + np.exp(log_step) * rising)) @ panels.weights
        return np.atleast_1d(covered - target)

    low, high = np.array([np.log(scale) - 30.0]), np.array([np.log(scale) + 30.0])
    if not excess(low)[0] > 0.0 > excess(high)[0]:
        raise NoSuchMechanism(
            f"the return from phi1 = {in_words(ends.start_rad)} cannot close: no "
            f"polynomial of this basis covers a driven angle of {ends.driven_length_rad:.6g} rad; {_remedy(ends)}",
            key="motion.return",
        )
    step = np.exp(zeros_between(excess, low, high)[0])
    return ReturnLaw(ends, local + step * beyond, inverse=False, about=about)


def _about_touching(polynomial: Polynomial) -> tuple[Polynomial, float]:
    """A polynomial that touches zero inside [0, 1], in powers about that place, which keep all digits beside it.

    The constant and the linear term are rounding errors and left out; closing the return makes up for them.
    """
    about = _lowest(polynomial)[1]
    for _ in range(3):
        local = polynomial(Polynomial([about, 1.0]))
        _, slope, bend = local.coef[:3]
        if not bend > 0.0 or not 0.0 < about - 0.5 * slope / bend < 1.0:
            return polynomial, 0.0
        about -= 0.5 * slope / bend
    local = polynomial(Polynomial([about, 1.0]))
    noise = TOUCHING * np.max(np.abs(polynomial.coef))
    if max(abs(local.coef[0]), abs(local.coef[1])) > noise:
        return polynomial, 0.0
    return Polynomial([0.0, 0.0, *local.coef[2:]]), float(about)


def _touching_multiple(base: Polynomial, direction: Polynomial) -> float:
    """Smallest c for which base + c direction is not negative on [0, 1]."""
    inner = (base.deriv() * direction - base * direction.deriv()).roots()
    candidates = inner.real[(np.abs(inner.imag) < 1e-9) & (inner.real > 1e-9) & (inner.real < 1.0 - 1e-9)]
    samples = np.concatenate([candidates, np.linspace(0.02, 0.98, 97)])
    # Nearer to the ends the double zeros of the direction drown in rounding, and the base decides alone.
    samples = samples[direction(samples) > 1e-12]
    return float(np.max(-base(samples) / direction(samples)))


def _polished(law: ReturnLaw, direction: Polynomial) -> ReturnLaw:
    """Newton steps on the spectral integral, which the panels of the solve only approximate.

    Raises NoSuchMechanism where the driven gear counts as standing still beside its fastest place, and when closure
    cannot be reached to CLOSED.
    """
    best, panels = law, _Panels.towards(law.about)
    ratios = law.local(panels.offsets)
    lowest = int(np.argmin(ratios))
    if not ratios[lowest] > STANDSTILL * np.max(ratios):
        raise _not_positive(law.ends.start_rad + law.ends.length_rad * (law.about + panels.offsets[lowest]), law.ends)
    rising = direction(panels.about + panels.offsets)
    for _ in range(6):
        if abs(best.closure_error_rad) <= POLISHED:
            return best
        ratio = best.local(panels.offsets) + best.correction(panels.about + panels.offsets)
        sensitivity = float(panels.weights @ (rising / ratio**2))
        step = direction * (best.closure_error_rad / (sensitivity * best.ends.length_rad))
        candidate = replace(best, correction=best.correction + step)
        positive = np.all(ratio + step(panels.about + panels.offsets) > 0.0)
        if not (positive and abs(candidate.closure_error_rad) < abs(best.closure_error_rad)):
            break
        best = candidate
    if abs(best.closure_error_rad) > CLOSED:
        raise NoSuchMechanism(
            f"the return closes only to {best.closure_error_rad:.2g} rad: its ratio comes too near zero; "
            f"{_remedy(best.ends)}",
            key="motion.return",
        )
    return best


BUMP = Polynomial([0.0, 0.0, 1.0, -2.0, 1.0])
"""tau^2 (1 - tau)^2."""

SKEW = Polynomial([-1.0, 2.0])
"""2 tau - 1; times the bump it skews a return."""


def return_with_constant(ends: ReturnEnds, constant: float, *, inverse: bool = False) -> ReturnLaw:
    """The published return: i12 polynomial whose value extrapolated to phi1 = 0 is ``constant`` (the paper's e).

    With ``inverse`` the polynomial is 1/i12.  Raises NoSuchMechanism when no such polynomial closes the cycle with a
    positive ratio.
    """
    base, direction = published_family(ends.inverted() if inverse else ends, constant)
    if inverse:
        return _positive_inverse(ends, _closing_inverse(ends, base, direction))
    return _polished(_closed_ratio(ends, base, direction), direction)


def published_family(ends: ReturnEnds, constant: float) -> tuple[Polynomial, Polynomial]:
    """Two polynomials in tau: the first plus any multiple of the second has the ends and the e of a return."""
    origin = -ends.start_rad / ends.length_rad
    base = ends.cubic
    lift = (constant - base(origin)) / BUMP(origin)
    return base + lift * BUMP, BUMP * Polynomial([-origin, 1.0])


def hermite(
    start: Number, start_slope: Number, end: Number, end_slope: Number, length_rad: Number
) -> tuple[Number, Number, Number, Number]:
    """Coefficients of the cubic in tau with these values, and slopes by the driving angle, at the two ends."""
    slope0, slope1, rise = start_slope * length_rad, end_slope * length_rad, end - start
    return start, slope0, 3.0 * rise - 2.0 * slope0 - slope1, slope0 + slope1 - 2.0 * rise


SKEWED = SKEW * BUMP
"""Polynomial that skews a return; its integral is zero, so it does not change the angle covered by 1/i12."""


@dataclass(frozen=True, eq=False)
class _RatioReturns:
    """The ratio's returns by their skewness, each closed, at driving angles ``phi1``, shape (n,)."""

    ends: ReturnEnds
    phi1: Array

    def law(self, skewness: float) -> ReturnLaw:
        """The return; raises NoSuchMechanism where none closes."""
        return _closed_ratio(self.ends, self.ends.cubic + skewness * SKEWED, BUMP)

    def slopes(self, skewness: Array) -> Array:
        """1/i12 and its slope by phi1, shape (2, k, n), NaN where no return closes."""
        slopes = np.full((2, skewness.size, self.phi1.size), np.nan)
        for number, skew in enumerate(skewness.tolist()):
            with suppress(NoSuchMechanism):
                slopes[:, number] = self.law(skew).slope(self.phi1, 1).coefficients
        return slopes


@dataclass(frozen=True, eq=False)
class _InverseReturns:
    """As ``_RatioReturns``, for returns whose inverse ratio is a polynomial: a return without skewness, plus its skew.

    A linear equation closes each.
    """

    ends: ReturnEnds
    phi1: Array

    def law(self, skewness: float) -> ReturnLaw:
        """The return; raises NoSuchMechanism where the polynomial is not positive."""
        return _positive_inverse(self.ends, self._even + skewness * SKEWED)

    def slopes(self, skewness: Array) -> Array:
        """1/i12 and its slope by phi1, shape (2, k, n), NaN where it is not positive."""
        even, skewed = self._parts
        slopes = even[:, None] + skewness[:, None] * skewed[:, None]
        slopes[:, ~are_positive(self._powers[0] + skewness[:, None] * self._powers[1])] = np.nan
        return slopes

    @cached_property
    def _powers(self) -> tuple[Array, Array]:
        """The coefficients of both parts of ``_parts``, shape (6,) each."""
        return _powers(self._even), _powers(SKEWED)

    @cached_property
    def _even(self) -> Polynomial:
        return _closing_inverse(self.ends, self.ends.inverted().cubic, BUMP)

    @cached_property
    def _parts(self) -> tuple[Array, Array]:
        """1/i12 of the return without skewness and the addition by skewness, with their slopes, shape (2, n) each."""
        parts = (ReturnLaw(self.ends, part, inverse=True) for part in (self._even, SKEWED))
        even, skewed = (part.slope(self.phi1, 1).coefficients for part in parts)
        return even, skewed


def _closing_inverse(ends: ReturnEnds, base: Polynomial, direction: Polynomial) -> Polynomial:
    """1/i12 = base + c direction with c such that the return covers its driven angle; ``direction`` is positive."""
    missing = ends.driven_length_rad / ends.length_rad - _unit_integral(base)
    return base + direction * (missing / _unit_integral(direction))


def _positive_inverse(ends: ReturnEnds, polynomial: Polynomial) -> ReturnLaw:
    """The return whose inverse ratio is a polynomial; raises NoSuchMechanism where the polynomial is not positive."""
    if not are_positive(_powers(polynomial)[None]).all():
        raise _not_positive(ends.start_rad + _lowest(polynomial)[1] * ends.length_rad, ends)
    return ReturnLaw(ends, polynomial, inverse=True)


def _powers(polynomial: Polynomial) -> Array:
    """The coefficients of tau^0 to tau^5, shape (6,)."""
    return np.pad(np.asarray(polynomial.coef, dtype=float), (0, SKEWED.coef.size - polynomial.coef.size))


def are_positive(coefficients: Array) -> Mask:
    """Mask of k polynomials of m powers, shape (k, m), that are positive on all of [0, 1]; NaN are not."""
    count = coefficients.shape[1]
    parts = (coefficients @ _to_bernstein(count - 1).T).reshape(len(coefficients), -1, count)
    # On a part a polynomial is no less than its least Bernstein coefficient; the first is its value at the start.
    positive: Mask = np.min(parts, axis=(1, 2)) > 0.0
    for row in np.nonzero(~positive & (parts[..., 0] > 0.0).all(axis=1) & (parts[:, -1, -1] > 0.0))[0]:
        positive[row] = _lowest(Polynomial(coefficients[row]))[0] > 0.0
    return positive


@cache
def _to_bernstein(degree: int) -> Array:
    """Matrix from coefficients of powers to coefficients of Bernstein's polynomials, for each part between PLACES."""
    power = range(degree + 1)
    whole = np.array([[comb(i, j) / comb(degree, j) for j in power] for i in power])
    length = 1.0 / (PLACES.size - 1)
    raised = np.array(
        [[[comb(i, j) * start ** max(i - j, 0) * length**j for i in power] for j in power] for start in PLACES[:-1]]
    )
    return np.concatenate(whole @ raised)


def return_of_least_acceleration(ends: ReturnEnds, linkage: Mechanism, *, inverse: bool) -> ReturnLaw:
    """The return whose peak slider acceleration is least within its basis.

    The skewness of the polynomial is scanned, and the best of the scan refined by a bounded minimisation.
    """
    from scipy.optimize import minimize_scalar

    evaluator = _ReturnAcceleration(ends, linkage)
    family = (_InverseReturns if inverse else _RatioReturns)(ends, evaluator.points)

    def peaks(skewness: Array) -> Array:
        return evaluator.peaks(family.slopes(skewness))

    scale = 16.0 * (ends.driven_length_rad / ends.length_rad) ** (1 if inverse else -1)
    grid = scale * np.sinh(np.linspace(-3.0, 3.0, 31))
    known = peaks(grid)
    best = int(np.argmin(known))
    if not np.isfinite(known[best]):
        family.law(0.0)  # refuses by itself where the return cannot close
        raise NoSuchMechanism("no return of this basis has a finite acceleration", key="motion.return")
    bounds = grid[max(best - 1, 0)], grid[min(best + 1, grid.size - 1)]
    wall = 1e6 * known[best]  # a minimiser that interpolates cannot work with infinities
    refined = minimize_scalar(
        lambda skewness: min(float(peaks(np.array([skewness]))[0]), wall),
        bounds=bounds,
        method="bounded",
        options={"xatol": 1e-7 * scale},
    )
    law = family.law(float(refined.x) if refined.fun <= known[best] else float(grid[best]))
    return law if inverse else _polished(law, BUMP)


class _ReturnAcceleration:
    """Peaks of |d2x/dphi1^2| over returns, on one Chebyshev grid whose integration matrix is made once."""

    DEGREE = 128

    def __init__(self, ends: ReturnEnds, linkage: Mechanism) -> None:
        self._start = ends.start_driven_rad
        self._linkage = linkage
        start, end = np.array([ends.start_rad]), np.array([ends.end_rad])
        self.points = chebyshev.nodes(start, end, self.DEGREE).ravel()
        self._integration: Array = chebyshev.integration_matrix(self.DEGREE).T * (ends.length_rad / 2.0)

    def peaks(self, slopes: Array) -> Array:
        """The peaks of k returns from 1/i12 and its slope by phi1 at the n points of the grid, shape (2, k, n).

        A peak is infinite where the ratio is zero at a point of the grid, or not a number.
        """
        with np.errstate(all="ignore"):
            driven = Jet(slopes.reshape(2, -1)).integrated((self._start + slopes[0] @ self._integration).ravel())
            accelerations = np.abs(self._linkage.displacement(driven).derivative(2)).reshape(slopes.shape[1:])
            found = np.array([_interpolated_peak(self.points, values) for values in accelerations])
        return np.where(np.isfinite(found), found, np.inf)


def _interpolated_peak(points: Array, values: Array) -> float:
    """Peak of the parabola through the largest sample and its neighbours; the sample itself at either end."""
    top = int(np.argmax(values))
    if not 0 < top < values.size - 1:
        return float(values[top])
    before, after = points[[top - 1, top + 1]] - points[top]
    fall_before, fall_after = values[[top - 1, top + 1]] - values[top]
    bend = (fall_after / after - fall_before / before) / (after - before)
    slope = fall_before / before - bend * before
    return float(values[top] - slope**2 / (4.0 * bend)) if bend < 0.0 else float(values[top])
