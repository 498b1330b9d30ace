"""The three-segment working stroke: fast approach, constant compression speed, slowing down to the dead centre.

Source: J. Wang, C. Wang, L. Miao, "Design of a non-circular gear-crank slider baler mechanism considering slider
acceleration", eqs. (2.4) to (2.12) and (3.3) to (3.7).  In the driving angle phi1 the velocity is phi1 Q(phi1) in the
first segment (Q cubic), constant in the second and delta R(delta) in the third (R quadratic, delta = theta4 - phi1):
the zeros at both dead centres are divided out, which makes the inversion regular there.

The conditions over-determine the stroke unless one quantity is left free.  Per radian of the driving angle the
stroke is linear in v1/omega, v2/omega and a1/omega_ref^2, so each of them, the stroke itself, and the law speed omega
follow in closed form.

All formulas hold for one stroke and, in arrays, for many at once.  ``stroke_refusals`` tells which of them do not
advance everywhere, and why.
"""

from __future__ import annotations

from dataclasses import replace
from math import inf, pi
from typing import Any, Generic

import numpy as np

from ncgear.errors import NoSuchMechanism
from ncgear.frozen import dataclass
from ncgear.mechanisms.mechanism import SLIDER, Output
from ncgear.numerics.arrays import Array, Number, chosen
from ncgear.numerics.bounds import shown_above, shown_below
from ncgear.numerics.units import RAD_S_PER_RPM, in_words
from ncgear.numerics.zeros import real_roots


@dataclass(frozen=True)
class StrokeRequests(Generic[Number]):
    """Requests for one stroke, or, in arrays of shape (n,), for many; one field that may be None is solved for.

    Angles of the driving gear in rad, velocities ``v1`` and ``v2`` in mm/s at ``law_speed_rad_s``, acceleration ``a1``
    in mm/s2 at ``a1_speed_rad_s`` (None: at the law speed), ``stroke_mm`` the displacement to be covered.
    """

    theta1_rad: Number
    theta2_rad: Number
    theta3_rad: Number
    theta4_rad: Number
    v1: Number | None
    v2: Number | None
    a1: Number | None
    law_speed_rad_s: Number | None
    stroke_mm: Number | None
    a1_speed_rad_s: Number | None = None


@dataclass(frozen=True)
class StrokeRequest(StrokeRequests[float]):
    """Requests for one stroke, and its output; for an output that turns, rad take the place of mm."""

    output: Output = SLIDER


@dataclass(frozen=True, eq=False)
class WorkingStrokes(Generic[Number]):
    """One stroke that closes, or many; polynomials from the constant term upwards, in mm and rad, shape (m,) or (m, n).

    ``approach_slope`` is Q(phi1) and ``approach_root`` is x/phi1^2 on [0, theta2]; ``braking_slope`` is R(delta) and
    ``braking_root`` is (stroke - x)/delta^2 on [0, theta4 - theta3].
    """

    theta1_rad: Number
    theta2_rad: Number
    theta3_rad: Number
    theta4_rad: Number
    stroke_mm: Number
    law_speed_rad_s: Number
    v1: Number
    v2: Number
    a1: Number
    pressing_mm_rad: Number
    approach_slope: Array
    approach_root: Array
    braking_slope: Array
    braking_root: Array

    @property
    def pressing_start_mm(self) -> Number:
        """Displacement at theta2, where the constant speed begins."""
        return self.theta2_rad**2 * polynomial_at(self.approach_root, self.theta2_rad)

    @property
    def closing_error_mm(self) -> Number:
        """Difference of the sum of the three segments from the stroke; rounding error only."""
        delta = self.theta4_rad - self.theta3_rad
        braking = delta**2 * polynomial_at(self.braking_root, delta)
        pressing = self.pressing_mm_rad * (self.theta3_rad - self.theta2_rad)
        return self.pressing_start_mm + pressing + braking - self.stroke_mm


@dataclass(frozen=True, eq=False)
class ClosedStroke(WorkingStrokes[float]):
    """One stroke that closes."""


def solved_stroke(request: StrokeRequest) -> ClosedStroke:
    """The stroke with its free quantity solved for, and proved to advance everywhere.

    Raises NoSuchMechanism when no positive value closes the stroke, or when the slider stops or reverses on the way.
    """
    asked = {name: value for name, value in vars(request).items() if name != "output"}
    arrays: dict[str, Any] = {name: None if value is None else np.array([value]) for name, value in asked.items()}
    requests: StrokeRequests[Array] = StrokeRequests(**arrays)
    strokes = closed_strokes(requests)
    for refusal in stroke_refusals(requests, strokes, request.output).values():
        raise refusal
    return ClosedStroke(**{name: _first(values) for name, values in vars(strokes).items()})


def _first(values: Array) -> Any:
    """The number, or the coefficients, of the first of many strokes."""
    return values[:, 0] if values.ndim > 1 else float(values[0])


def closed_strokes(requests: StrokeRequests[Array]) -> WorkingStrokes[Array]:
    """Many strokes with their free quantity solved for; nothing is proved about them.

    The free quantity is negative or not a number where no positive value closes the stroke; other strokes may stop or
    reverse.
    """
    with np.errstate(all="ignore"):
        closed = _closed(requests)
        return WorkingStrokes(**_assembled(closed, _approach_slope(closed)))


def shaped_strokes(theta_rad: Array, approach_shape: Array, brake: Array, stroke_mm: float) -> WorkingStrokes[Array]:
    """Many strokes of given shapes at a law speed of 1 rad/s; nothing is proved about them.

    ``theta_rad`` holds theta1 to theta4 (shape (4, n)), ``approach_shape`` is v/v2 in powers 1 to 4 of phi1/theta2
    (shape (4, n)), ``brake`` is -a1 (theta4 - theta3)/v2 (shape (n,)).  The stroke is then linear in v2, which closes
    it; where no positive v2 closes it, v2 is negative or infinite.
    """
    theta1, theta2, theta3, theta4 = theta_rad
    delta, order = theta4 - theta3, np.arange(1.0, 5.0)[:, None]
    approached = theta2 * (approach_shape / (order + 1.0)).sum(axis=0)
    v2 = stroke_mm / (approached + theta3 - theta2 + delta * (0.5 + brake / 12.0))
    approach, unit = approach_shape * v2 / theta2**order, np.ones_like(v2)
    v1 = theta1 * polynomial_at(approach, theta1)
    request = StrokeRequests(theta1, theta2, theta3, theta4, v1, v2, -brake * v2 / delta, unit, stroke_mm * unit)
    return WorkingStrokes(**_assembled(request, approach))


def polynomial_at(coefficients: Array, argument: Number) -> Number:
    """A polynomial's value, or, with coefficients of shape (m, n), the value of each at its own argument."""
    value: Number = argument * 0.0
    for coefficient in coefficients[::-1]:
        value = value * argument + coefficient
    return value


def _approach_slope(request: StrokeRequests[Number]) -> Array:
    """Q of a closed request."""
    omega = _known(request.law_speed_rad_s)
    return _approach_through(request, _known(request.v1) / omega, _known(request.v2) / omega)


def _approach_through(request: StrokeRequests[Number], v1: Number, v2: Number) -> Array:
    """Q on [0, theta2] in powers of phi1: the cubic Hermite form of v/phi1 between theta1 and theta2."""
    t1, t2 = request.theta1_rad, request.theta2_rad
    width = t2 - t1
    value1, value2 = v1 / t1, v2 / t2
    slope1, slope2 = -width * value1 / t1, -width * value2 / t2
    rise = value2 - value1
    return _shifted((value1, slope1, 3 * rise - 2 * slope1 - slope2, slope1 + slope2 - 2 * rise), t1, width)


def _shifted(hermite: tuple[Number, ...], start: Number, width: Number) -> Array:
    """A polynomial of (t - start) / width in powers of t, by Horner's rule."""
    *lower, highest = hermite
    powers: list[Any] = [highest]
    for coefficient in lower[::-1]:
        raised = [0.0, *powers]
        powers = [(up - start * kept) / width for up, kept in zip(raised, [*powers, 0.0], strict=True)]
        powers[0] = powers[0] + coefficient
    return np.stack(powers)


def _braking_slope(request: StrokeRequests[Number], v2: Number, a1: Number) -> Array:
    """R in powers of delta: v = v2 and v' = 0 at theta3, v' = a1 at theta4."""
    delta = request.theta4_rad - request.theta3_rad
    start, mean = -a1, v2 / delta
    return np.array([start, (3.0 * mean - 2.0 * start) / delta, (start - 2.0 * mean) / delta**2])


def _root_form(slope: Array) -> Array:
    """Integral of t * slope(t), divided by t^2."""
    return (slope.T / np.arange(2.0, len(slope) + 2.0)).T


def _stroke_sensitivities(request: StrokeRequests[Number]) -> tuple[Number, Number, Number]:
    """Stroke per unit of v1/omega, v2/omega and a1/omega_ref^2."""
    t2 = request.theta2_rad
    delta = request.theta4_rad - request.theta3_rad
    none, unit = t2 * 0.0, t2 * 0.0 + 1.0

    def approach(v1: Number, v2: Number) -> Number:
        return polynomial_at(_root_form(_approach_through(request, v1, v2)), t2) * t2**2

    return approach(unit, none), approach(none, unit) + (request.theta3_rad - t2) + delta / 2.0, -(delta**2) / 12.0


def _closed(request: StrokeRequests[Number]) -> StrokeRequests[Number]:
    """The request with its free quantity filled in."""
    per_v1, per_v2, per_a1 = _stroke_sensitivities(request)
    if request.law_speed_rad_s is None:
        return replace(request, law_speed_rad_s=1.0 / _closing_period(request, per_v1, per_v2, per_a1))
    omega = request.law_speed_rad_s
    factors = {"v1": per_v1 / omega, "v2": per_v2 / omega, "a1": per_a1 / _a1_speed(request, omega) ** 2}
    given = {name: getattr(request, name) for name in factors}
    known = sum(factor * given[name] for name, factor in factors.items() if given[name] is not None)
    if request.stroke_mm is None:
        return replace(request, stroke_mm=known)
    free = next(name for name, value in given.items() if value is None)
    return replace(request, **{free: (request.stroke_mm - known) / factors[free]})


def _closing_period(request: StrokeRequests[Number], per_v1: Number, per_v2: Number, per_a1: Number) -> Number:
    """1/omega from the stroke: linear in it, or quadratic when a1 is stated at the law speed itself.

    Not positive, or not a number, where nothing closes the stroke.
    """
    v1, v2, a1 = _known(request.v1), _known(request.v2), _known(request.a1)
    stroke, linear = _known(request.stroke_mm), per_v1 * v1 + per_v2 * v2
    if request.a1_speed_rad_s is not None:
        return (stroke - per_a1 * a1 / request.a1_speed_rad_s**2) / linear
    discriminant = linear**2 + 4.0 * per_a1 * a1 * stroke
    root: Number = np.sqrt(discriminant)
    return 2.0 * stroke / (linear + root)


def _a1_speed(request: StrokeRequests[Number], law_speed: Number) -> Number:
    """Speed in rad/s at which a1 holds."""
    return law_speed if request.a1_speed_rad_s is None else request.a1_speed_rad_s


def _known(value: Number | None) -> Number:
    if value is None:
        raise ValueError("exactly one of law speed, v1, v2, a1 and stroke may be left open")
    return value


def _assembled(request: StrokeRequests[Number], approach: Array) -> dict[str, Any]:
    """The fields of the stroke of a closed request, from its Q."""
    omega, v2 = _known(request.law_speed_rad_s), _known(request.v2)
    braking = _braking_slope(request, v2 / omega, _known(request.a1) / _a1_speed(request, omega) ** 2)
    return {
        **{name: value for name, value in vars(request).items() if name not in ("a1_speed_rad_s", "output")},
        "pressing_mm_rad": v2 / omega,
        "approach_slope": approach,
        "approach_root": _root_form(approach),
        "braking_slope": braking,
        "braking_root": _root_form(braking),
    }


CLEAR = 1e-9
"""Least v/phi1 of a stroke that passes without a search for its zeros, as a share of the largest value: a million
rounding errors."""


def stroke_refusals(
    requests: StrokeRequests[Array], strokes: WorkingStrokes[Array], output: Output
) -> dict[int, NoSuchMechanism]:
    """Refusals of strokes of an output, closed from requests: by their numbers, the first reason of each.

    No positive value closes the stroke, or the velocity is not positive between the dead centres.  Its divided-out
    zeros must be simple.  Braking needs no check: with u = delta / (theta4 - theta3),

        R = -a1 (1 - u)^2 + v2 / (theta4 - theta3) u (3 - 2 u)

    is a sum of terms that are zero or more.
    """
    with np.errstate(all="ignore"):
        zero = _first_zeros(strokes.approach_slope, strokes.theta2_rad)
        speed = strokes.law_speed_rad_s
        advancing = (strokes.v1 > 0.0) & (strokes.v2 > 0.0) & (strokes.a1 < 0.0)
        sound = (speed > 0.0) & (speed < inf) & advancing & np.isnan(zero)
        if requests.law_speed_rad_s is None:
            per_v1, per_v2, _ = _stroke_sensitivities(requests)
            sound &= per_v1 * _known(requests.v1) + per_v2 * _known(requests.v2) > 0.0
        rows = np.nonzero(~sound)[0]
        if not rows.size:
            return {}
        asked, closed = chosen(requests, rows), chosen(strokes, rows)
        per_v1, per_v2, _ = _stroke_sensitivities(asked)
        most = _most_of_v1(asked)
        speeds = _closing_speeds(asked, most)
    refusals = {}
    for place, number in enumerate(rows.tolist()):
        row = _Refused(
            _row(asked, place),
            _row(closed, place),
            output,
            float(per_v1[place]),
            float(per_v2[place]),
            float(most[place]),
            [float(values[place]) for values in speeds],
            float(zero[number]),
        )
        refusals[number] = row.refusal()
    return refusals


def _row(many: Any, row: int) -> Any:
    """One of many strokes or requests, in numbers; its polynomials are left as they are."""
    numbers = {name: values for name, values in vars(many).items() if values is not None and values.ndim == 1}
    return replace(many, **{name: float(values[row]) for name, values in numbers.items()})


@dataclass(frozen=True, eq=False)
class _Refused:
    """A refused stroke, and the figures of its refusal.

    ``per_v1`` and ``per_v2`` are the stroke's sensitivities, ``most`` is the v1/v2 above which the output turns back,
    ``speeds_rad_s`` are law speeds at which it does not, ``zero_rad`` is where it first does (NaN: nowhere).
    """

    request: StrokeRequests[float]
    stroke: WorkingStrokes[float]
    output: Output
    per_v1: float
    per_v2: float
    most: float
    speeds_rad_s: list[float]
    zero_rad: float

    def refusal(self) -> NoSuchMechanism:
        """The refusal by the first condition that fails."""
        request, stroke = self.request, self.stroke
        speed, acceleration = self.output.speed, self.output.acceleration
        if request.law_speed_rad_s is None:
            v2 = _known(request.v2)
            if not self.per_v1 * _known(request.v1) + self.per_v2 * v2 > 0.0:
                reason = (
                    f"the approach goes backwards altogether; theta1 lies too near 0 or theta2: v1 under "
                    f"{shown_below(self.most * v2)} {speed.text} is right there, or {self._free_theta1}"
                )
                return self._reversal(request.theta1_rad, reason, "theta1_rad")
        if not 0.0 < stroke.law_speed_rad_s < inf:
            return self._no_speed()
        if not stroke.v1 > 0.0:
            reason = f"closing the stroke needs v1 = {stroke.v1:.4g} {speed.text}; {self._remedy_of_v1}"
            return self._reversal(request.theta1_rad, reason + self._closing_speeds, f"v1_{speed.ending}")
        if not stroke.v2 > 0.0:
            remedy = f"lower v1, bring a1 nearer to zero or lengthen the stroke{self._closing_speeds}"
            reason = f"closing the stroke needs v2 = {stroke.v2:.4g} {speed.text}; {remedy}"
            return self._reversal(stroke.theta2_rad, reason, f"v2_{speed.ending}")
        if not stroke.a1 < 0.0:
            reason = f"a1 = {stroke.a1:.4g} {acceleration.text} is not negative"
            return self._reversal(stroke.theta4_rad, reason, f"a1_{acceleration.ending}")
        changed = "v2" if request.v2 is None else "v1"
        return self._reversal(self.zero_rad, self._too_far_apart, f"{changed}_{speed.ending}")

    def _no_speed(self) -> NoSuchMechanism:
        v1, v2, a1 = self.stroke.v1, self.stroke.v2, self.stroke.a1
        stroke = self.output.place.factor * self.stroke.stroke_mm
        return NoSuchMechanism(
            f"no law speed closes a stroke of {stroke:g} {self.output.place.text} with v1 = {v1:g}, v2 = {v2:g} "
            f"{self.output.speed.text} and a1 = {a1:g} {self.output.acceleration.text}; "
            "bring a1 nearer to zero or solve for another quantity",
            key="motion.solve_for",
        )

    @property
    def _too_far_apart(self) -> str:
        """Words for v1 and v2 between which the output turns back, with values that are right."""
        v1, v2, unit = self.stroke.v1, self.stroke.v2, self.output.speed.text
        enough = f"v1 under {shown_below(self.most * v2)} {unit} is right"
        if self.request.v1 is None:
            said = f"closing the stroke needs v1 = {v1:.5g} {unit}, too much for v2 = {v2:g}; {enough} with this v2"
        elif self.request.v2 is None:
            least = f"over {shown_above(v1 / self.most)} is right"
            said = f"closing the stroke needs v2 = {v2:.5g} {unit}, too little for v1 = {v1:g}; {least}"
        else:
            least = f"v2 over {shown_above(v1 / self.most)}"
            said = f"v1 = {v1:g} and v2 = {v2:g} {unit} are too far apart; {enough}, or {least}"
        return f"{said}{self._closing_speeds}, or {self._free_theta1}"

    @property
    def _free_theta1(self) -> str:
        low, high = self.request.theta2_rad / 4.0, self.request.theta2_rad / 2.0
        return f"theta1 from {low / pi:.4g} to {high / pi:.4g} pi (a quarter to a half of theta2), which suits any v1"

    @property
    def _remedy_of_v1(self) -> str:
        """Words for a change that gives the approach a part of the stroke to cover, or lets it cover one."""
        if self.per_v1 > 0.0:
            return (
                "lower v2, shorten the stretch at v2 (theta2 to theta3), bring a1 nearer to zero or lengthen the stroke"
            )
        return f"theta1 lies too near 0 or theta2; take {self._free_theta1}"

    @property
    def _closing_speeds(self) -> str:
        """Words for the law speeds at which a solved v1 or v2 advances; empty where there are none."""
        speeds = [speed / RAD_S_PER_RPM for speed in self.speeds_rad_s if not np.isnan(speed)]
        if not speeds or not all(0.0 < speed < inf for speed in speeds):
            return ""
        shown = [f"{speed:.5g}" for speed in sorted(speeds)]
        if len(set(shown)) < len(shown):
            return ""
        sides = zip(("over", "under"), shown, strict=False)
        return f", or a law speed {' and '.join(f'{side} {speed}' for side, speed in sides)} r/min"

    def _reversal(self, angle: float, reason: str, key: str) -> NoSuchMechanism:
        return NoSuchMechanism(
            f"the {self.output.name} stops or reverses inside the working stroke at phi1 = {in_words(angle)}, "
            f"{angle / pi:.4g} pi: {reason}",
            key=f"motion.{key}",
        )


def _most_of_v1(request: StrokeRequests[Array]) -> Array:
    """v1/v2 above which the slider turns back on its way to theta2; infinite where no v1 turns it back.

    Q is v1 A + v2 B, where B is nowhere negative (it is (phi1 - theta1)^2 times a positive line), and A is negative
    only where theta1 is under a quarter or over a half of theta2.
    """
    unit, none = np.ones_like(request.theta2_rad), np.zeros_like(request.theta2_rad)
    a, b = _approach_through(request, unit, none), _approach_through(request, none, unit)
    # B' A - B A': the terms of the fifth power cancel.
    turning = np.stack([_product_term(a, b, power) for power in range(5)])
    roots = real_roots(turning)
    inside = (roots >= 0.0) & (roots <= request.theta2_rad)
    angles = np.concatenate([none[None, :], np.where(inside, roots, 0.0)])
    below, above = (polynomial_at(part[:, None], angles) for part in (a, b))
    limits = np.where(below < 0.0, -above / below, inf)
    # Where A is nowhere negative, it touches zero, and its rounding errors tell nothing.
    share = request.theta1_rad / request.theta2_rad
    return np.where((share >= 0.25) & (share <= 0.5), inf, limits.min(axis=0))


def _product_term(a: Array, b: Array, power: int) -> Array:
    """The coefficient of a power in b' a - b a', of cubics of shape (4, n)."""
    pairs = ((i, power + 1 - i) for i in range(4) if 0 <= power + 1 - i < 4)
    return np.sum([(i - k) * b[i] * a[k] for i, k in pairs], axis=0)


def _closing_speeds(request: StrokeRequests[Array], most: Array) -> list[Array]:
    """The law speeds in rad/s at both ends of the range of a solved v1 or v2 that advances; NaN for no end."""
    ends: dict[str, tuple[Array, ...]] = {}
    if request.v1 is None:
        ends = {"v1": (np.zeros_like(most), most * _known(request.v2))}
    elif request.v2 is None:
        ends = {"v2": (request.v1 / most,)}
    return [
        np.where(
            values < inf,
            np.nan_to_num(_known(_closed(replace(request, law_speed_rad_s=None, **{name: values})).law_speed_rad_s)),
            np.nan,
        )
        for name, both in ends.items()
        for values in both
    ]


def _first_zeros(coefficients: Array, end: Array) -> Array:
    """Smallest zero of each cubic (shape (4, n)) in [0, end], 0 where it starts negative, NaN where it is positive."""
    zeros = np.where(coefficients[0] > 0.0, np.nan, 0.0)
    constant, slope, bend, last = coefficients
    # The places where its slope is zero, by the form of the quadratic's roots that does not cancel.
    half = -(bend + np.copysign(np.sqrt(np.maximum(bend**2 - 3.0 * last * slope, 0.0)), bend))
    turns = np.stack([np.zeros_like(end), half / (3.0 * last), slope / half, end])
    at = np.clip(np.where(np.isfinite(turns), turns, 0.0), 0.0, end)
    values = polynomial_at(coefficients[:, None], at)
    doubtful = np.nonzero((constant > 0.0) & ~(values.min(axis=0) > CLEAR * np.abs(values).max(axis=0)))[0]
    roots = real_roots(coefficients[:, doubtful], 1e-12)
    inside = np.where((roots >= 0.0) & (roots <= end[doubtful]), roots, inf).min(axis=0, initial=inf)
    zeros[doubtful] = np.where(inside < inf, inside, np.nan)
    return zeros
