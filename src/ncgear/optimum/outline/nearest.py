"""The pitch curve nearest to an outline that keeps the conditions of teeth, by programmes one after another."""

from __future__ import annotations

from dataclasses import replace
from math import sqrt, tau

import numpy as np

from ncgear.errors import NoSuchMechanism
from ncgear.extras import require
from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array
from ncgear.optimum.outline.conditions import Kind, Limits, conditions, excess
from ncgear.optimum.outline.outline import Outline, axes_to_try
from ncgear.optimum.outline.programme import Wanted, missed, step
from ncgear.optimum.outline.rolled import Basis, Rolled, closing_distance_mm

FEWEST_COEFFICIENTS, MOST_COEFFICIENTS = 48, 250
"""Coefficients of a curve with few teeth, and with many; between them it has one for each tooth."""

HEATS = ((8, 3), (3, 4), (1, 20))
"""How many of the best curves go on, from so many axes at first, and with how many programmes each."""

MORE_ROUNDS = 8
"""Most programmes from a curve that kept other limits."""

HARMONICS, TAPER, RAYS = 24, 5.0, 720
"""Harmonics of the first curve and the harmonic at which they are tapered to exp(-1/2), of so many rays."""

SHRINKS = 20
"""Steps in which the first curve is shrunk towards a circle until it keeps all conditions."""

FIRST_STEP, LEAST_STEP = 0.08, 2e-4
"""Greatest step of the first programme, and a step after which nothing changes, as shares of the outline's size."""

MISSED = 4.0
"""What missing a condition by 1 counts against distances, in sizes of the outline."""

KEPT = 2e-3
"""By how much a condition may be missed at last: less than the limits are known to by far."""

MEASURED, ROUGHLY = 6000, 1000
"""Points of outline and curve at which distances are measured, by arc length, at last and on the way."""


@dataclass(frozen=True, eq=False)
class Deviation:
    """How far outline and curve are apart: the distance from points of either to the other one, even by arc length.

    ``root_mean_square_mm`` is over both; ``greatest_mm`` is at ``at_mm``, a place of the outline or, where
    ``of_outline`` is false, of the curve; ``toward_mm`` is the place of the other one that is nearest.
    """

    root_mean_square_mm: float
    greatest_mm: float
    at_mm: tuple[float, float]
    toward_mm: tuple[float, float]
    of_outline: bool


def deviation(outline: Outline, curve: Rolled, count: int = MEASURED) -> Deviation:
    """The deviation of a curve from an outline, by so many points of each."""
    own = Outline(curve.points()[0])
    square, worst = 0.0, list[tuple[float, Array, Array]]()
    for one, other in ((outline, own), (own, outline)):
        # The greatest distance is mostly at a corner, which even points miss.
        points = np.concatenate([one.even(count), one.corners])
        nearest, away = other.nearest(points)
        square += float(np.mean(away[:count] ** 2)) / 2.0
        at = int(np.argmax(away))
        worst.append((float(away[at]), points[at], nearest[at]))
    side = 0 if worst[0][0] >= worst[1][0] else 1
    greatest, at_mm, toward = worst[side]
    return Deviation(sqrt(square), greatest, _place(at_mm), _place(toward), side == 0)


def _place(point: Array) -> tuple[float, float]:
    return float(point[0]), float(point[1])


def coefficients_for(teeth: int) -> int:
    """Coefficients of a curve for so many teeth."""
    return min(max(FEWEST_COEFFICIENTS, teeth), MOST_COEFFICIENTS)


def nearest_curve(
    outline: Outline,
    teeth: int,
    limits: Limits,
    wanted: Wanted,
    axis_mm: Array | None = None,
    start: Rolled | None = None,
) -> Rolled:
    """The nearest curve for so many teeth, from a curve for the same number of teeth or from the start.

    Without an axis it is sought from several places.  Raises NoSuchMechanism where no curve keeps the conditions, and
    WrongInput where the solver is not installed.
    """
    require("clarabel", "optimize", "ncgear fit")
    if start is not None:
        return _better(outline, start, limits, wanted, MORE_ROUNDS, FIRST_STEP / 2.0)
    axes = [axis_mm] if axis_mm is not None else axes_to_try(outline, HEATS[0][0])
    basis = Basis(coefficients_for(teeth))
    begun = [_first(outline, basis, axis, teeth, limits) for axis in axes]
    curves = [one for one in begun if one is not None]
    if not curves:
        raise NoSuchMechanism("no axis inside the outline is met by every ray; give one in motion", key="motion")
    for count, rounds in HEATS:
        curves = sorted(curves, key=lambda one: _cost(outline, one, limits, wanted))[:count]
        curves = [_better(outline, one, limits, wanted, rounds, FIRST_STEP) for one in curves]
    found = curves[0]
    off = missed(found, limits, wanted)
    if off > 5.0 * KEPT:
        raise NoSuchMechanism(
            f"no pitch curve near the outline was found on which {teeth} teeth can stand: "
            f"{_most_missed(found, limits)}; an axis elsewhere, a rounder outline, or more teeth of a smaller module "
            "are needed",
            key="gears.teeth",
        )
    return found


TOO_MUCH = {
    Kind.HOLLOW_OWN: "the gear is too concave",
    Kind.HOLLOW_MATE: "the mate is too concave",
    Kind.HOLLOW_CORNER_OWN: "a concave corner is too sharp",
    Kind.HOLLOW_CORNER_MATE: "a concave corner of the mate is too sharp",
    Kind.CORNER_OWN: "a corner is too sharp",
    Kind.CORNER_MATE: "a corner of the mate is too sharp",
    Kind.STEEP: "the curve runs too steeply against the ray from its axis",
    Kind.ROOM: "there is too little room beside the mate's axis",
}


def _most_missed(curve: Rolled, limits: Limits) -> str:
    """Which condition is missed by most, and where in the drawing, in words."""
    worst = max(conditions(curve, limits), key=lambda one: float(one.value.max()))
    points, _ = curve.points()
    x, y = points[int(worst.value.argmax()) * len(points) // worst.value.size]
    return f"{TOO_MUCH[worst.kind]} at ({x:.4g}, {y:.4g}) mm of the drawing"


def _cost(outline: Outline, curve: Rolled, limits: Limits, wanted: Wanted) -> float:
    """The deviation in mm, and what missed conditions count."""
    found = deviation(outline, curve, ROUGHLY)
    distance = found.greatest_mm if wanted.greatest else found.root_mean_square_mm
    return distance + MISSED * outline.size_mm / 64.0 * max(missed(curve, limits, wanted), 0.0)


def _better(outline: Outline, curve: Rolled, limits: Limits, wanted: Wanted, rounds: int, first: float) -> Rolled:
    """The curve after some programmes; steps are smaller after one that brought nothing."""
    most = first * outline.size_mm
    cost = _cost(outline, curve, limits, wanted)
    for _ in range(rounds):
        found = step(outline, curve, limits, wanted, most)
        after = _cost(outline, found, limits, wanted)
        moved = float(np.max(np.abs(found.radius[0] - curve.radius[0]))) / outline.size_mm
        if after < cost or missed(curve, limits, wanted) > KEPT:
            gained, curve, cost = cost - after, found, after
            if abs(gained) < 1e-3 * cost and missed(curve, limits, wanted) <= KEPT:
                break
        else:
            most /= 3.0
        if moved < LEAST_STEP or most < LEAST_STEP * outline.size_mm:
            break
    return curve


def _first(outline: Outline, basis: Basis, axis_mm: Array, teeth: int, limits: Limits) -> Rolled | None:
    """The farthest hits of rays, smoothed and shrunk towards a circle until they keep the conditions.

    None where a ray meets no outline.
    """
    hits = outline.farthest_hits(axis_mm, RAYS)
    if not np.min(hits) > 0.0:
        return None
    order = np.arange(HARMONICS + 1)
    spectrum = np.fft.rfft(hits)[: HARMONICS + 1] / RAYS * np.exp(-((order / TAPER) ** 2) / 2.0)
    for shrunk in np.linspace(1.0, 0.0, SHRINKS + 1):
        radius = basis.count * np.fft.irfft(np.where(order > 0, shrunk, 1.0) * spectrum, basis.count)
        if np.min(radius) <= 0.0:
            continue
        curve = Rolled(basis, basis.through(radius), np.asarray(axis_mm), 1.0, teeth)
        curve = replace(curve, center_distance_mm=closing_distance_mm(curve.radius[0]))
        if excess(curve, limits) <= KEPT:
            break
    return curve


def polar_angle(curve: Rolled, at_mm: tuple[float, float]) -> float:
    """Polar angle of a place about the curve's axis in rad, from 0 to 2 pi."""
    x, y = np.asarray(at_mm) - curve.axis_mm
    return float(np.arctan2(y, x)) % tau
