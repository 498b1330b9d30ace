"""High-precision reference of the three-segment working stroke, its inversion and the return polynomial.

Everything is built from the defining conditions (linear systems, root finding, quadrature) with mpmath; no closed form
of the inversion is used. Angles are in rad, lengths in mm, speeds in mm/s and rad/s.

Polynomials are kept in ascending powers of the driving angle itself. That is badly conditioned on purpose: with this
many digits it does not matter, and it shares nothing with an implementation in local variables.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np
from mpmath import mp
from scipy.optimize import brentq

Exact = Any  # str such as "13*pi/10" or "-1500", mpf, int or float; mpmath carries no types
Real = Any  # mpf

BASE_DIGITS = 60
SNAP = "1e-45"  # closer to a dead centre than this is the dead centre: the caller's own rounding of the angle


def exact(value: Exact) -> Real:
    """Value at the current precision; text may be products and quotients of numbers and pi ("13*pi/10")."""
    if not isinstance(value, str):
        return mp.mpf(value)
    numerator, *denominators = value.split("/")
    result = mp.mpf(1)
    for factor in numerator.split("*"):
        result *= _atom(factor)
    for factor in denominators:
        result /= _atom(factor)
    return result


def _atom(text: str) -> Real:
    """One factor: pi, -pi or a decimal number."""
    text = text.strip()
    if text in ("pi", "-pi"):
        return +mp.pi if text == "pi" else -mp.pi
    return mp.mpf(text)


@dataclass(frozen=True)
class StrokeParameters:
    """What defines the stroke; `a1_reference_speed` None means a1 holds at the law's own speed."""

    theta1: Exact
    theta2: Exact
    theta3: Exact
    theta4: Exact
    v1: Exact
    v2: Exact
    a1: Exact
    crank: Exact
    rod: Exact
    offset: Exact = "0"
    a1_reference_speed: Exact | None = None


# Table 1 of the baler paper, a1 read at the 20 r/min (2 pi / 3 rad/s) of its simulation.
BALER = StrokeParameters(
    "2*pi/5", "7*pi/10", "pi", "13*pi/10", "1600", "1100", "-1500", "380", "960", a1_reference_speed="2*pi/3"
)


# --- linkage -----------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Linkage:
    """Crank-slider in the project's pose; all three lengths exact."""

    crank: Exact
    rod: Exact
    offset: Exact

    def lengths(self) -> tuple[Real, Real, Real]:
        """Crank, rod, offset at the current precision."""
        return exact(self.crank), exact(self.rod), exact(self.offset)

    def stroke(self) -> Real:
        """Distance between the two dead centres, from the two stretched triangles."""
        crank, rod, offset = self.lengths()
        return mp.sqrt((rod + crank) ** 2 - offset**2) - mp.sqrt((rod - crank) ** 2 - offset**2)

    def working_angle(self) -> Real:
        """Driven angle from the retracted to the extended dead centre."""
        crank, rod, offset = self.lengths()
        return mp.pi + mp.asin(offset / (rod - crank)) - mp.asin(offset / (rod + crank))

    def crank_angle(self, phi2: Real) -> Real:
        """Angle of the crank: it turns clockwise from the retracted dead centre."""
        crank, rod, offset = self.lengths()
        return mp.pi + mp.asin(offset / (rod - crank)) - phi2

    def displacement(self, phi2: Real) -> Real:
        """Slider displacement from the retracted end, from the vector loop."""
        crank, rod, offset = self.lengths()
        theta = self.crank_angle(phi2)
        position = crank * mp.cos(theta) + mp.sqrt(rod**2 - (crank * mp.sin(theta) - offset) ** 2)
        return position - mp.sqrt((rod - crank) ** 2 - offset**2)

    def slope(self, phi2: Real) -> Real:
        """d displacement / d phi2, from velocities: the rod's ends move equally fast along the rod."""
        crank, rod, offset = self.lengths()
        theta = self.crank_angle(phi2)
        rod_x = mp.sqrt(rod**2 - (crank * mp.sin(theta) - offset) ** 2)
        rod_y = offset - crank * mp.sin(theta)
        return crank * (mp.sin(theta) * rod_x - mp.cos(theta) * rod_y) / rod_x

    def derivatives(self, phi2: Real, highest: int) -> list[Real]:
        """Derivatives 0..highest by differences with enough digits to spare (good to the working precision)."""
        with mp.workdps(mp.dps + 40):
            return [factor * mp.factorial(k) for k, factor in enumerate(mp.taylor(self.displacement, phi2, highest))]

    def driven_angle(self, displacement: Real) -> Real:
        """phi2 in (0, working angle) at a displacement: bisection, then Newton on the forward loop, checked."""
        low, high = mp.mpf(0), self.working_angle()
        end = high
        while True:
            middle = (low + high) / 2
            if high - low < min(middle, end - middle) / 10**4:
                return self._polished(middle, displacement, end)
            low, high = (middle, high) if self.displacement(middle) < displacement else (low, middle)

    def _polished(self, phi2: Real, displacement: Real, end: Real) -> Real:
        """Newton from a start good to four digits of the distance to the dead centre."""
        for _ in range(12):
            step = (self.displacement(phi2) - displacement) / self.slope(phi2)
            phi2 -= step
            if abs(step) < mp.mpf(10) ** -45 * min(phi2, end - phi2):
                return phi2
        raise ArithmeticError(f"inversion of displacement {mp.nstr(displacement, 20)} did not converge")


# --- the three segments ------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class SolvedStroke:
    """Law speed, the four angles and the three polynomials in ascending powers of phi1, at one precision."""

    omega: Real
    theta: tuple[Real, Real, Real, Real]
    segments: tuple[tuple[Real, ...], tuple[Real, ...], tuple[Real, ...]]

    def displacement(self, phi1: Real, order: int = 0) -> Real:
        """Displacement, or its derivative of an order with respect to phi1, within the working stroke."""
        segment = 0 if phi1 <= self.theta[1] else 1 if phi1 <= self.theta[2] else 2
        return polynomial(self.segments[segment], phi1, order)


def polynomial(coefficients: tuple[Real, ...], phi: Real, order: int = 0) -> Real:
    """Derivative of an order of a polynomial in ascending powers."""
    return mp.fdot(coefficients, _powers(phi, order, len(coefficients)))


def _powers(phi: Real, order: int, count: int) -> list[Real]:
    """Derivatives of an order of 1, phi, phi^2, ..."""
    return [mp.ff(k, order) * phi ** (k - order) if k >= order else mp.mpf(0) for k in range(count)]


def _through(conditions: list[tuple[Real, int, Real]]) -> tuple[Real, ...]:
    """Polynomial whose derivative of `order` at `phi` is `value`, for each (phi, order, value)."""
    matrix = mp.matrix([_powers(phi, order, len(conditions)) for phi, order, _ in conditions])
    solution = mp.lu_solve(matrix, mp.matrix([value for _, _, value in conditions]))
    return tuple(solution)


def _segments(parameters: StrokeParameters, theta: tuple[Real, ...], inverse_omega: Real) -> Any:
    """The three polynomials at a trial law speed; the stroke's height is left as it comes out."""
    t1, t2, t3, t4 = theta
    v1, v2 = exact(parameters.v1) * inverse_omega, exact(parameters.v2) * inverse_omega
    reference = parameters.a1_reference_speed
    a1 = exact(parameters.a1) * (inverse_omega if reference is None else 1 / exact(reference)) ** 2
    first = _through([(0, 0, 0), (0, 1, 0), (t1, 1, v1), (t1, 2, 0), (t2, 1, v2), (t2, 2, 0)])
    second = _through([(t2, 0, polynomial(first, t2)), (t2, 1, v2)])
    third = _through([(t3, 0, polynomial(second, t3)), (t3, 1, v2), (t3, 2, 0), (t4, 1, 0), (t4, 2, a1)])
    return first, second, third


@lru_cache(maxsize=64)
def solve(parameters: StrokeParameters, digits: int = BASE_DIGITS) -> SolvedStroke:
    """Law speed at which the stroke closes at the linkage's own stroke, and the three polynomials."""
    with mp.workdps(digits + 20):
        theta = tuple(exact(t) for t in _angles(parameters))
        stroke = linkage_of(parameters).stroke()

        def excess(inverse_omega: Real) -> Real:
            return polynomial(_segments(parameters, theta, inverse_omega)[2], theta[3]) - stroke

        inverse_omega = _closing(excess)
        return SolvedStroke(1 / inverse_omega, theta, _segments(parameters, theta, inverse_omega))


def _closing(excess: Any) -> Real:
    """Positive root of the excess stroke over 1/omega: at most quadratic, so three values give it exactly."""
    at_0, at_1, at_2 = (excess(mp.mpf(k)) for k in (0, 1, 2))
    square = (at_2 - 2 * at_1 + at_0) / 2
    linear = at_1 - at_0 - square
    if at_0 >= 0:
        raise ValueError("the end acceleration alone is more than the stroke: no law speed closes it")
    root = -2 * at_0 / (linear + mp.sqrt(linear**2 - 4 * square * at_0))  # stable also where the square vanishes
    if abs(excess(root)) > mp.mpf(10) ** (15 - mp.dps):
        raise ArithmeticError("the stroke does not close at the root found")
    return root


def _angles(parameters: StrokeParameters) -> tuple[Exact, Exact, Exact, Exact]:
    """The four joints as given."""
    return parameters.theta1, parameters.theta2, parameters.theta3, parameters.theta4


def linkage_of(parameters: StrokeParameters) -> Linkage:
    """The linkage of a stroke."""
    return Linkage(parameters.crank, parameters.rod, parameters.offset)


# --- what tests call ---------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Stroke:
    """The working stroke, 0 <= phi1 <= theta4. Every result has 30 digits or more, dead centres included."""

    parameters: StrokeParameters

    @property
    def linkage(self) -> Linkage:
        """The crank-slider."""
        return linkage_of(self.parameters)

    @property
    def omega(self) -> Real:
        """Angular speed of the driving gear at which v1 and v2 hold, rad/s."""
        return solve(self.parameters).omega

    @property
    def theta4(self) -> Real:
        """End of the working stroke."""
        return solve(self.parameters).theta[3]

    def displacement(self, phi1: Exact, order: int = 0) -> Real:
        """Slider displacement (mm), or its derivative of an order with respect to phi1."""
        with mp.workdps(BASE_DIGITS):
            return +solve(self.parameters).displacement(self._angle(phi1), order)

    def driven_angle(self, phi1: Exact) -> Real:
        """phi2 (rad)."""
        with mp.workdps(self._digits(phi1)):
            end = self._dead_centre(phi1)
            return self._dead_angle(end) if end is not None else self._inverted(phi1)

    def ratio(self, phi1: Exact) -> Real:
        """i12 = dphi1/dphi2, by the limit at the dead centres."""
        with mp.workdps(self._digits(phi1)):
            end = self._dead_centre(phi1)
            if end is not None:
                return self._ratio_at_dead_centre(end)[0]
            slope = solve(self.parameters, mp.dps).displacement(self._angle(phi1), 1)
            return self.linkage.slope(self._inverted(phi1)) / slope

    def ratio_slope_at_dead_centre(self, extended: bool) -> Real:
        """d i12 / d phi1 at the retracted (False) or the extended (True) dead centre, from inside the stroke."""
        with mp.workdps(BASE_DIGITS):
            return self._ratio_at_dead_centre(extended)[1]

    def return_polynomial(self, e: Exact) -> ReturnPolynomial:
        """The return law of degree 5 with the constant e."""
        return _return_polynomial(self.parameters, e)

    def _angle(self, phi1: Exact) -> Real:
        """phi1 as a number, refused outside the stroke (by more than a snap)."""
        phi = exact(phi1)
        if not -mp.mpf(SNAP) <= phi <= self.theta4 + mp.mpf(SNAP):
            raise ValueError(f"phi1 = {mp.nstr(phi, 20)} is outside the working stroke 0..{mp.nstr(self.theta4, 20)}")
        return phi

    def _dead_centre(self, phi1: Exact) -> bool | None:
        """False at the retracted dead centre, True at the extended one, None elsewhere."""
        phi = self._angle(phi1)
        if abs(phi) < mp.mpf(SNAP):
            return False
        return True if abs(phi - solve(self.parameters, mp.dps).theta[3]) < mp.mpf(SNAP) else None

    def _digits(self, phi1: Exact) -> int:
        """Digits to work with: s and S are quadratic at the dead centres, so twice the distance's digits are lost."""
        with mp.workdps(2 * BASE_DIGITS):
            theta4 = solve(self.parameters, 2 * BASE_DIGITS).theta[3]
            distance = max(min(abs(exact(phi1)), abs(theta4 - exact(phi1))), mp.mpf(SNAP))
            lost = max(0, int(mp.ceil(-mp.log10(distance))))
        return BASE_DIGITS + 4 * lost

    def _inverted(self, phi1: Exact) -> Real:
        """phi2 at the current precision, away from the dead centres themselves."""
        return self.linkage.driven_angle(solve(self.parameters, mp.dps).displacement(self._angle(phi1)))

    def _dead_angle(self, extended: bool) -> Real:
        """phi2 at a dead centre."""
        return self.linkage.working_angle() if extended else mp.mpf(0)

    def _ratio_at_dead_centre(self, extended: bool) -> tuple[Real, Real]:
        """Ratio and its slope: S(a h + b h^2) = s(h) compared in h^2 and h^3; ratio = 1/(a + 2 b h)."""
        solved = solve(self.parameters, mp.dps)
        phi = solved.theta[3] if extended else mp.mpf(0)
        _, _, second, third = self.linkage.derivatives(self._dead_angle(extended), 3)
        a = mp.sqrt(solved.displacement(phi, 2) / second)
        b = (solved.displacement(phi, 3) - third * a**3) / (6 * second * a)
        return 1 / a, -2 * b / a**2


# --- return ------------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class ReturnPolynomial:
    """i12 = e + f0 phi + ... + f4 phi^5 over theta4..2 pi, and what the slider then does."""

    coefficients: tuple[Real, ...]
    theta4: Real
    linkage: Linkage

    def ratio(self, phi1: Exact, order: int = 0) -> Real:
        """i12, or its derivative of an order with respect to phi1."""
        with mp.workdps(BASE_DIGITS):
            return polynomial(self.coefficients, exact(phi1), order)

    def driven_angle(self, phi1: Exact) -> Real:
        """phi2 (rad), by quadrature of 1/i12 from the extended dead centre."""
        with mp.workdps(BASE_DIGITS):
            return self.linkage.working_angle() + _turned(self.coefficients, self.theta4, exact(phi1))

    def displacement(self, phi1: Exact, order: int = 0) -> Real:
        """Slider displacement (mm), or its first or second derivative with respect to phi1."""
        phi2, ratio, slope = self.driven_angle(phi1), self.ratio(phi1), self.ratio(phi1, 1)
        with mp.workdps(BASE_DIGITS):
            zeroth, first, second = self.linkage.derivatives(phi2, 2)
            return (zeroth, first / ratio, second / ratio**2 - first * slope / ratio**2)[order]


def _turned(coefficients: tuple[Real, ...], start: Real, end: Real) -> Real:
    """Driven angle over start..end; split, because the poles of 1/i12 are near the real axis."""
    points = [start + (end - start) * k / 4 for k in range(5)]
    descending = coefficients[::-1]
    value, error = mp.quad(lambda phi: 1 / mp.polyval(descending, phi), points, error=True, method="gauss-legendre")
    if error > mp.mpf(10) ** -45:
        raise ArithmeticError(f"quadrature of 1/i12 is only good to {mp.nstr(error, 3)}")
    return value


@lru_cache(maxsize=16)
def _return_polynomial(parameters: StrokeParameters, e: Exact) -> ReturnPolynomial:
    """Solve for the last coefficient so that the return turns the driven gear by what is left of the turn."""
    stroke = Stroke(parameters)
    with mp.workdps(BASE_DIGITS + 10):
        target = 2 * mp.pi - stroke.linkage.working_angle()
        ends = _end_conditions(stroke)

        def excess(f4: Real) -> Real:
            return _turned(_with_last(ends, e, f4), stroke.theta4, 2 * mp.pi) - target

        start = _coarse_last(ends, e, target)
        f4 = mp.findroot(excess, (start, start * (1 + mp.mpf(10) ** -5)), solver="secant", tol=mp.mpf(10) ** -110)
        return ReturnPolynomial(_with_last(ends, e, f4), stroke.theta4, stroke.linkage)


def _end_conditions(stroke: Stroke) -> list[tuple[Real, int, Real]]:
    """Value and slope of i12 at theta4 and 2 pi, as (phi, order, value)."""
    extended, retracted = stroke._ratio_at_dead_centre(True), stroke._ratio_at_dead_centre(False)
    at_end = [(stroke.theta4, order, extended[order]) for order in (0, 1)]
    return at_end + [(2 * mp.pi, order, retracted[order]) for order in (0, 1)]


def _with_last(ends: list[tuple[Real, int, Real]], e: Exact, f4: Real) -> tuple[Real, ...]:
    """All six coefficients: value e at phi = 0, the four end conditions and a given fifth derivative."""
    return _through([(mp.mpf(0), 0, exact(e)), *ends, (mp.mpf(0), 5, 120 * f4)])


def _coarse_last(ends: list[tuple[Real, int, Real]], e: Exact, target: Real) -> Real:
    """The last coefficient to about six digits, over the range where i12 stays positive.

    i12 = A + f4 B with B > 0 inside the return, so the driven angle falls steadily from infinity to 0 as f4 grows
    from where i12 first touches zero: there is one root.
    """
    grid = np.linspace(float(ends[0][0]), float(2 * mp.pi), 1001)
    trials = [_with_last(ends, e, mp.mpf(k)) for k in (0, 1)]
    base, raised = (np.array([float(polynomial(trial, mp.mpf(p))) for p in grid]) for trial in trials)
    lift = raised - base
    lowest = float(np.max(-base[1:-1] / lift[1:-1]))
    unit = 1 / float(lift.max())

    def excess(log_height: float) -> float:
        return float(np.trapezoid(1 / (base + (lowest + unit * np.exp(log_height)) * lift), grid)) - float(target)

    return mp.mpf(lowest + unit * np.exp(brentq(excess, -12.0, 12.0)))


@dataclass(frozen=True)
class Cycle:
    """The whole turn, 0 <= phi1 <= 2 pi: the working stroke, then the return."""

    working: Stroke
    returning: ReturnPolynomial

    def ratio(self, phi1: Exact) -> Real:
        """i12 = dphi1/dphi2."""
        return self._part(phi1).ratio(phi1)

    def driven_angle(self, phi1: Exact) -> Real:
        """phi2 (rad)."""
        return self._part(phi1).driven_angle(phi1)

    def displacement(self, phi1: Exact, order: int = 0) -> Real:
        """Slider displacement (mm), or its first or second derivative with respect to phi1."""
        return self._part(phi1).displacement(phi1, order)

    def _part(self, phi1: Exact) -> Stroke | ReturnPolynomial:
        """The part of the turn an angle is in."""
        with mp.workdps(BASE_DIGITS):
            return self.working if exact(phi1) <= self.working.theta4 + mp.mpf(SNAP) else self.returning


def cycle(parameters: StrokeParameters, e: Exact = "0") -> Cycle:
    """Working stroke and return of one design."""
    working = Stroke(parameters)
    return Cycle(working, working.return_polynomial(e))
