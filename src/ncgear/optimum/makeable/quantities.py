"""The limited quantities at a place of the crank, from ln i12 there and its two derivatives by the driven angle.

Numbers, arrays and symbols share the arithmetic used here, so the optimiser and its judges use the same formulas.
With i = dphi1/dphi2, s = 1/i, f = ln i and primes by phi2:  d/dphi1 = s d/dphi2, di/dphi1 = f', d2i/dphi1^2 = s f''.
Pitch radii r1 = a/(1 + i) and r2 = a i/(1 + i), a the centre distance.

With two pairs in series, the law of each pair over its own driven angle follows from ln i12 and the second pair's ln
iB.  Both are functions of the crank's angle phi2, which the second pair drives, so ln iB needs no conversion.  The
first pair drives the shaft between, with dphim = iB dphi2, so that with f = ln i12, g = ln iB

    ln iA = f - g,   d/dphim = exp(-g) d/dphi2
    d ln iA/dphim = exp(-g) (f' - g'),   d2 ln iA/dphim2 = exp(-2g) (f'' - g'' - g' (f' - g'))
"""

from __future__ import annotations

from collections.abc import Sequence
from math import cos, log, sin
from typing import Any, NamedTuple

Term = Any
"""A number, an array or a symbol."""


class RatioPlace(NamedTuple):
    """The ratio at a place: ln i12, i12, its inverse, and the derivatives of ln i12 by the driven angle."""

    log: Term
    ratio: Term
    slope: Term
    first: Term
    second: Term


class Slider(NamedTuple):
    """The machine at a place: derivatives of the slider's displacement by the driven angle, in mm; its force in N.

    The force counts towards the retracted end, so that force times velocity is power on both strokes.  The rest are
    columns of ``ncgear.optimum.loads``, each load as its parts at rest, by q and by q'/2: the torque asked of the
    driven gear in N mm, and the forces in N on the crank's bearings and on the frame, along and across the slider's
    line.  They are zero without masses.  ``log_first`` is ln |x'|, finite at dead centres too.  ``between`` is the
    moment of inertia in N mm s^2 of a shaft between two pairs, times m' m'' of its angle m where a law is known, primes
    by the driving angle.
    """

    first: Term
    second: Term
    third: Term
    force_n: Term
    torque: Term = 0.0
    torque_by_q: Term = 0.0
    torque_by_rate: Term = 0.0
    bearing_x: Term = 0.0
    bearing_x_by_q: Term = 0.0
    bearing_x_by_rate: Term = 0.0
    bearing_y: Term = 0.0
    bearing_y_by_q: Term = 0.0
    bearing_y_by_rate: Term = 0.0
    shaking_x_by_q: Term = 0.0
    shaking_x_by_rate: Term = 0.0
    shaking_y_by_q: Term = 0.0
    shaking_y_by_rate: Term = 0.0
    log_first: Term = 0.0
    between: Term = 0.0


def velocity(at: RatioPlace, slider: Slider, speed_rad_s: Term) -> Term:
    """Slider velocity in mm/s: w x' s."""
    return speed_rad_s * slider.first * at.slope


def log_speed(at: RatioPlace, slider: Slider, speed_rad_s: float) -> Term:
    """Logarithm of the slider's speed in mm/s: ln w + ln |x'| - ln i12."""
    return log(speed_rad_s) + slider.log_first - at.log


def acceleration(at: RatioPlace, slider: Slider, speed_rad_s: Term) -> Term:
    """Slider acceleration in mm/s2: w^2 s^2 (x'' - x' f')."""
    return speed_rad_s**2 * at.slope**2 * (slider.second - slider.first * at.first)


def jerk(at: RatioPlace, slider: Slider, speed_rad_s: Term) -> Term:
    """Slider jerk in mm/s3: w^3 s^3 (x''' - 3 x'' f' + 2 x' f'^2 - x' f'')."""
    bend = slider.third - 3.0 * slider.second * at.first + slider.first * (2.0 * at.first**2 - at.second)
    return speed_rad_s**3 * at.slope**3 * bend


def power(at: RatioPlace, slider: Slider, speed_rad_s: Term) -> Term:
    """Power of the resistance in W: F v; without masses the torque on the driving gear is this over its speed."""
    return slider.force_n * velocity(at, slider, speed_rad_s) / 1000.0


def moved(at: RatioPlace, by_q: Term, by_rate: Term, speed_rad_s: Term) -> Term:
    """The part of a load that motion brings: w^2 (by_q q + by_rate q'/2), with q = s^2 and q'/2 = -f' q."""
    return (speed_rad_s * at.slope) ** 2 * (by_q - at.first * by_rate)


def driving_torque(at: RatioPlace, slider: Slider, speed_rad_s: Term) -> Term:
    """Torque on the driving gear in N mm with all masses: the driven gear's times s, and a shaft between's."""
    crank = (slider.torque + moved(at, slider.torque_by_q, slider.torque_by_rate, speed_rad_s)) * at.slope
    return crank + speed_rad_s**2 * slider.between


def bearing_force(at: RatioPlace, slider: Slider, speed_rad_s: Term) -> tuple[Term, Term]:
    """Force on the crank's bearings in N, the teeth's apart, along and across the slider's line."""
    along = moved(at, slider.bearing_x_by_q, slider.bearing_x_by_rate, speed_rad_s)
    across = moved(at, slider.bearing_y_by_q, slider.bearing_y_by_rate, speed_rad_s)
    return slider.bearing_x + along, slider.bearing_y + across


def shaking_force(at: RatioPlace, slider: Slider, speed_rad_s: Term) -> tuple[Term, Term]:
    """Force of the moving masses on the frame in N, along and across the slider's line."""
    along = moved(at, slider.shaking_x_by_q, slider.shaking_x_by_rate, speed_rad_s)
    across = moved(at, slider.shaking_y_by_q, slider.shaking_y_by_rate, speed_rad_s)
    return along, across


def inverse_levers(at: RatioPlace, angles_rad: tuple[float, float]) -> tuple[Term, Term]:
    """Centre distance over the lever of the teeth's force about the driven axis, of pushing and of back flanks.

    The lever is r2 cos(alpha +- atan f'/(1 + i)) with the rack's angle alpha on that side:
    ``ncgear.dynamics.mesh_force``.
    """
    steep = tangent(at)
    per_radius = (1.0 + at.slope) * (1.0 + steep**2) ** 0.5
    pushing, back = angles_rad
    return (per_radius / (cos(pushing) - steep * sin(pushing)), per_radius / (cos(back) + steep * sin(back)))


def relative_curvature(at: RatioPlace) -> Term:
    """Sum of both pitch curves' curvatures times the centre distance: (1 + s)^2/(s sqrt(1 + t^2)), t the tangent."""
    return (1.0 + at.slope) ** 2 * at.ratio / (1.0 + tangent(at) ** 2) ** 0.5


def tangent(at: RatioPlace) -> Term:
    """Tangent of the angle between the pitch curves and the normal to the centre line: -r1'/r1 = f'/(1 + i)."""
    return at.first / (1.0 + at.ratio)


def driving_bulge(at: RatioPlace) -> Term:
    """1 + i + d2i/dphi1^2, with the sign of the driving curve's curvature."""
    return 1.0 + at.ratio + at.slope * at.second


def driven_bulge(at: RatioPlace) -> Term:
    """1 + s + d2s/dphi2^2, with the sign of the driven curve's curvature."""
    return 1.0 + at.slope + (at.first**2 - at.second) * at.slope


def driving_curvature(at: RatioPlace) -> Term:
    """Curvature of the driving curve times the centre distance."""
    return (1.0 + at.ratio) ** 3 * driving_bulge(at) / ((1.0 + at.ratio) ** 2 + at.first**2) ** 1.5


def driven_curvature(at: RatioPlace) -> Term:
    """Curvature of the driven curve times the centre distance."""
    slope = at.first * at.slope
    return (1.0 + at.slope) ** 3 * driven_bulge(at) / ((1.0 + at.slope) ** 2 + slope**2) ** 1.5


def length_rate(at: RatioPlace) -> Term:
    """Length of the pitch curves per unit of phi2, over the centre distance."""
    across = 1.0 + at.ratio
    return at.ratio * (across**2 + at.first**2) ** 0.5 / across**2


def pairs(ratios: Sequence[RatioPlace]) -> tuple[RatioPlace, ...]:
    """The ratio of every pair at a place, from the driving shaft on; ``ratios`` are i12 alone, or i12 and iB."""
    if len(ratios) == 1:
        return (ratios[0],)
    whole, second = ratios
    bend = whole.first - second.first
    first = RatioPlace(
        whole.log - second.log,
        whole.ratio * second.slope,
        whole.slope * second.ratio,
        second.slope * bend,
        second.slope**2 * (whole.second - second.second - second.first * bend),
    )
    return first, second


def with_shaft_between(slider: Slider, ratios: Sequence[RatioPlace]) -> Slider:
    """The machine at a place with the motion of the shaft between two pairs: m' = iB s and m'' = m' s (g' - f')."""
    if len(ratios) == 1:
        return slider._replace(between=0.0)
    whole, second = ratios
    speed = second.ratio * whole.slope
    return slider._replace(between=slider.between * speed**2 * whole.slope * (second.first - whole.first))


def length_rates(ratios: Sequence[RatioPlace]) -> tuple[Term, ...]:
    """Length of every pair's pitch curves per unit of phi2, each over its centre distance."""
    if len(ratios) == 1:
        return (length_rate(ratios[0]),)
    first, second = pairs(ratios)
    return length_rate(first) * second.ratio, length_rate(second)
