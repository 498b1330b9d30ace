"""The pitch curve nearest to an outline that keeps the conditions of teeth, by programmes one after another.

Each of two outlines alone gives a ratio of the gears at every angle, as if its mate were free.  The search for a pair
that follows both begins at the turn where the logarithms of both ratios are most alike, with a ratio between them.
"""

from __future__ import annotations

from dataclasses import replace
from math import pi, sqrt, tau

import numpy as np

from ncgear.errors import NoSuchMechanism
from ncgear.extras import require
from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array
from ncgear.optimum.outline.conditions import CurveLimits, Subject, conditions, excess
from ncgear.optimum.outline.outline import Outline, axes_to_try
from ncgear.optimum.outline.programme import OutlineAim, missed, step
from ncgear.optimum.outline.rolled import MatePlace, Rolled, SplineBasis, closing_distance_mm


@dataclass(frozen=True, eq=False)
class Phased:
    """A start: the numbers of the radii of both gears, the radius between them, the turn of the mate, and its scale.

    ``radius_mm`` has shape (n,), at even angles of the curve.
    """

    own: int
    mate: int
    radius_mm: Array
    turned_rad: float
    scale: float


def best_phases(own: list[Array], mate: list[Array], share: float, fixed_size: bool, count: int) -> list[Phased]:
    """The ``count`` best starts among all radii of both gears, at even polar angles of shape (n,) each.

    ``share`` is the mate's, 0 to 1; ``fixed_size`` says that both drawings have the size of the pair.
    """
    found = list[tuple[float, int, int, int]]()
    asked, answers = [_log_ratio(radius) for radius in own], [_as_driven(radius) for radius in mate]
    for i, one in enumerate(asked):
        for j, (other, _) in enumerate(answers):
            alike = np.fft.irfft(np.fft.rfft(one) * np.conj(np.fft.rfft(other)), len(one))
            # Only turns that are better than their neighbours count.
            tops = np.flatnonzero((alike > np.roll(alike, 1)) & (alike >= np.roll(alike, -1)))
            apart = float(one @ one + other @ other) - 2.0 * alike[tops]
            found += [(float(cost), i, j, int(turn)) for cost, turn in zip(apart, tops, strict=True)]
    starts = list[Phased]()
    for _, i, j, turn in sorted(found)[:count]:
        other, angle = answers[j]
        ratio = np.exp((1.0 - share) * asked[i] + share * np.roll(other, turn))
        ratio /= np.mean(ratio)
        form, form_mate = ratio / (1.0 + ratio), 1.0 / (1.0 + ratio)
        by_own, by_mate = np.mean(own[i]) / np.mean(form), np.mean(mate[j]) / np.mean(form_mate * ratio)
        distance = float((1.0 - share) * by_own + share * by_mate if fixed_size else by_own)
        scale = 1.0 if fixed_size else float(by_own / by_mate)
        starts.append(Phased(i, j, distance * form, float(-np.roll(angle, turn)[0]), scale))
    return starts


def _log_ratio(radius: Array) -> Array:
    """Logarithm of how fast the mate of a radius turns."""
    return np.log(radius / (closing_distance_mm(radius) - radius))


def _as_driven(radius: Array) -> tuple[Array, Array]:
    """Of a mate by its radius at even angles: logarithm of the ratio it asks for, and its own angle, over even angles
    of the gear that drives it; both turn against each other."""
    count = len(radius)
    backwards = np.roll(radius[::-1], 1)
    turns = np.exp(_log_ratio(backwards))
    turns /= np.mean(turns)
    angle = np.arange(count + 1) * (tau / count)
    driving = np.concatenate([[0.0], np.cumsum((turns + np.roll(turns, -1)) / 2.0)]) * (tau / count)
    own = np.interp(angle[:-1], driving, angle)
    return -np.log(np.interp(own, angle, np.append(turns, turns[0]))), own


FEWEST_COEFFICIENTS, MOST_COEFFICIENTS = 48, 250
"""Coefficients of a curve with few teeth, and with many; between them there is a coefficient for each tooth."""

HEATS, HEATS_OF_TWO = ((8, 2), (3, 4), (1, 20)), ((8, 6), (3, 20), (1, 20))
"""Rounds: numbers of curves that enter each, best first, and programmes for each curve.  Two outlines need more rounds,
since their turn against each other shows later than an axis alone."""

AXES_OF_TWO = 4
"""Axes of each outline that are tried with each other where both gears follow an outline."""

MORE_ROUNDS = 8
"""Most programmes from a curve that kept other limits."""

HARMONICS, TAPER, RAYS = 24, 5.0, 720
"""Harmonics of the first curve, the harmonic at which they are tapered to exp(-1/2), and rays for computing them."""

SHRINKS = 20
"""Steps in which the first curve is shrunk towards a circle until it keeps all conditions."""

FIRST_STEP, LEAST_STEP = 0.08, 2e-4
"""Greatest step of the first programme, and a step after which nothing changes, as shares of the outline's size."""

GAIN = 3e-4
"""Share of the cost that a step must gain for another to follow."""

MISSED = 4.0
"""Cost of violating a condition by 1, against distances in sizes of the outline."""

KEPT, LOOSE = 2e-3, 1e-2
"""Largest final violation of a condition, far below the accuracy of the limits, and that of a curve that counts at all.
"""

GENTLE = 1e-4
"""Deviation, as a share of the outline's size, for which a curve may be steeper by a right angle: curves about several
axes often follow an outline equally well, and the noise of its points must not choose a steep curve among them."""

MEASURED, ROUGHLY = 6000, 1000
"""Points of outline and curve, even by arc length, for distances of the final and of intermediate curves."""


@dataclass(frozen=True, eq=False)
class Deviation:
    """Distances of outline and curve: from points of each, even by arc length, to the other.

    ``root_mean_square_mm`` is over both; ``greatest_mm`` is at ``at_mm``, a place of the outline or, where
    ``of_outline`` is false, of the curve; ``toward_mm`` is the nearest place of the other.
    """

    root_mean_square_mm: float
    greatest_mm: float
    at_mm: tuple[float, float]
    toward_mm: tuple[float, float]
    of_outline: bool


def deviation(outline: Outline, curve: Rolled, count: int = MEASURED) -> Deviation:
    """The deviation of a curve from an outline, by ``count`` points of each."""
    return _apart(outline, curve.points()[0], count)


def mate_deviation(outline: Outline, curve: Rolled, count: int = MEASURED) -> Deviation:
    """The same of the mate from its outline: distances in mm of the pair, places in mm of the mate's drawing."""
    assert curve.mate_place is not None
    scale = curve.mate_place.scale
    found = _apart(outline, curve.mate_in_drawing()[0] / scale, count)
    root, greatest = scale * found.root_mean_square_mm, scale * found.greatest_mm
    return replace(found, root_mean_square_mm=root, greatest_mm=greatest)


def _apart(outline: Outline, points_mm: Array, count: int) -> Deviation:
    own = Outline(points_mm)
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


def away_mm(outline: Outline, curve: Rolled, wanted: OutlineAim, count: int = MEASURED) -> float:
    """The minimized distance, of both gears by their shares where the mate has an outline."""
    mate, place = wanted.mate, curve.mate_place
    followed = [(outline, curve.points()[0], 1.0, 1.0)]
    if mate is not None and place is not None:
        followed = [(*followed[0][:3], 1.0 - mate.share)]
        followed.append((mate.outline, curve.mate_in_drawing()[0] / place.scale, place.scale, mate.share))
    if wanted.greatest:
        most = max(share for *_, share in followed)
        return max(scale * share / most * _apart(one, own, count).greatest_mm for one, own, scale, share in followed)
    return sqrt(sum(share * scale**2 * _mean_square(one, own, count) for one, own, scale, share in followed))


def _mean_square(outline: Outline, points_mm: Array, count: int) -> float:
    own = Outline(points_mm)
    return sum(float(np.mean(b.nearest(a.even(count))[1] ** 2)) for a, b in ((outline, own), (own, outline))) / 2.0


def _place(point: Array) -> tuple[float, float]:
    return float(point[0]), float(point[1])


def coefficients_for(teeth: int) -> int:
    """Number of coefficients of a curve for ``teeth`` teeth."""
    return min(max(FEWEST_COEFFICIENTS, teeth), MOST_COEFFICIENTS)


def nearest_curve(
    outline: Outline,
    teeth: int,
    limits: CurveLimits,
    wanted: OutlineAim,
    axis_mm: Array | None = None,
    start: Rolled | None = None,
) -> Rolled:
    """The nearest curve for a number of teeth, from a curve with that number or from the start.

    Without an axis the search starts at several places.  Raises NoSuchMechanism where no curve keeps the conditions,
    and WrongInput where the solver is not installed.
    """
    require("clarabel", "optimize", "ncgear fit")
    if start is not None:
        return _better(outline, start, limits, wanted, MORE_ROUNDS, FIRST_STEP / 2.0)
    basis = SplineBasis(coefficients_for(teeth))
    curves = [curve for curve in _begun(outline, basis, axis_mm, wanted, limits, teeth) if curve is not None]
    if not curves:
        raise NoSuchMechanism("no axis inside the outline is met by every ray; give one in motion", key="motion")
    for count, rounds in HEATS_OF_TWO if wanted.mate else HEATS:
        curves = sorted(
            curves,
            key=lambda curve: _cost(outline, curve, limits, wanted)[0] + GENTLE * outline.size_mm * _steepness(curve),
        )[:count]
        curves = [_better(outline, curve, limits, wanted, rounds, FIRST_STEP) for curve in curves]
    found = curves[0]
    off = missed(found, limits, wanted)
    if off > LOOSE:
        raise NoSuchMechanism(
            f"no pitch curve near the outline was found on which {teeth} teeth can stand: "
            f"{_most_missed(found, limits)}; an axis elsewhere, a rounder outline, or more teeth of a smaller module "
            "are needed",
            key="gears.teeth",
        )
    return found


def _steepness(curve: Rolled) -> float:
    """The greatest angle between the curve and a circle about its axis, as a share of a right angle."""
    radius, slope, _ = curve.radius
    return float(np.arctan(np.max(np.abs(slope / radius)))) / (pi / 2.0)


TOO_MUCH = {
    Subject.HOLLOW_OWN: "the gear is too concave",
    Subject.HOLLOW_MATE: "the mate is too concave",
    Subject.HOLLOW_CORNER_OWN: "a concave corner is too sharp",
    Subject.HOLLOW_CORNER_MATE: "a concave corner of the mate is too sharp",
    Subject.CORNER_OWN: "a corner is too sharp",
    Subject.CORNER_MATE: "a corner of the mate is too sharp",
    Subject.STEEP: "the curve runs too steeply against the ray from its axis",
    Subject.ROOM: "there is too little room beside the mate's axis",
}


def _most_missed(curve: Rolled, limits: CurveLimits) -> str:
    """Words for the most violated condition and its place in the drawing."""
    worst = max(conditions(curve, limits), key=lambda condition: float(condition.value.max()))
    points, _ = curve.points()
    x, y = points[int(worst.value.argmax()) * len(points) // worst.value.size]
    return f"{TOO_MUCH[worst.kind]} at ({x:.4g}, {y:.4g}) mm of the drawing"


def _cost(outline: Outline, curve: Rolled, limits: CurveLimits, wanted: OutlineAim) -> tuple[float, float]:
    """The deviation in mm plus the cost of violated conditions, and the largest violation."""
    off = missed(curve, limits, wanted)
    return away_mm(outline, curve, wanted, ROUGHLY) + MISSED * outline.size_mm / 64.0 * max(off, 0.0), off


def _better(
    outline: Outline, curve: Rolled, limits: CurveLimits, wanted: OutlineAim, rounds: int, first: float
) -> Rolled:
    """The curve after some programmes; a step without gain makes the next steps smaller."""
    most = first * outline.size_mm
    cost, off = _cost(outline, curve, limits, wanted)
    for _ in range(rounds):
        found = step(outline, curve, limits, wanted, most)
        after, off_after = _cost(outline, found, limits, wanted)
        moved = float(np.max(np.abs(found.radius[0] - curve.radius[0]))) / outline.size_mm
        if after < cost or off > KEPT:
            gained, curve, cost, off = cost - after, found, after, off_after
            if abs(gained) < GAIN * cost and off <= KEPT:
                break
        else:
            most /= 3.0
        if moved < LEAST_STEP or most < LEAST_STEP * outline.size_mm:
            break
    return curve


def _begun(
    outline: Outline, basis: SplineBasis, axis_mm: Array | None, wanted: OutlineAim, limits: CurveLimits, teeth: int
) -> list[Rolled | None]:
    """The first curves of the search; None for an axis with a ray that meets no outline."""
    mate, count = wanted.mate, HEATS[0][0]

    def seen(outline: Outline, axis_mm: Array | None, count: int) -> list[tuple[Array, Array]]:
        """Axes with the radii about them."""
        axes = [axis_mm] if axis_mm is not None else axes_to_try(outline, count)
        radii = [(axis, _smoothed(outline, axis)) for axis in axes]
        return [(axis, radius) for axis, radius in radii if radius is not None]

    if mate is None:
        return [
            _shrunk(Rolled(basis, basis.through(_resampled(radius, basis.count)), axis, 1.0, teeth), limits)
            for axis, radius in seen(outline, axis_mm, count)
        ]
    own, other = seen(outline, axis_mm, AXES_OF_TWO), seen(mate.outline, mate.axis_mm, AXES_OF_TWO)
    begun = list[Rolled | None]()
    for phase in best_phases([r for _, r in own], [r for _, r in other], mate.share, mate.fixed_size, count):
        place = MatePlace(other[phase.mate][0] * phase.scale, phase.turned_rad, phase.scale)
        radius = basis.through(_resampled(phase.radius_mm, basis.count))
        begun.append(_shrunk(Rolled(basis, radius, own[phase.own][0], 1.0, teeth, place), limits))
    return begun


def _smoothed(outline: Outline, axis_mm: Array) -> Array | None:
    """The farthest hits of rays from an axis, smoothed, shape (RAYS,); None where a ray meets no outline."""
    hits = outline.farthest_hits(axis_mm, RAYS)
    if not np.min(hits) > 0.0:
        return None
    order = np.arange(HARMONICS + 1)
    spectrum = np.fft.rfft(hits)[: HARMONICS + 1] * np.exp(-((order / TAPER) ** 2) / 2.0)
    radius: Array = np.fft.irfft(spectrum, RAYS)
    return np.maximum(radius, np.min(hits))


def _resampled(radius: Array, count: int) -> Array:
    """Radii at ``count`` even angles, from the harmonics of a smooth curve."""
    return np.fft.irfft(np.fft.rfft(radius)[: HARMONICS + 1], count) * (count / len(radius))


def _shrunk(curve: Rolled, limits: CurveLimits) -> Rolled | None:
    """A curve, shrunk towards a circle until it keeps the conditions; None where it does not enclose its axis."""
    given, found = curve.coefficients, None
    mean = float(np.mean(given))
    for share in np.linspace(1.0, 0.0, SHRINKS + 1):
        found = replace(curve, coefficients=mean + share * (given - mean))
        if np.min(found.radius[0]) <= 0.0:
            continue
        found = replace(found, center_distance_mm=closing_distance_mm(found.radius[0]))
        if excess(found, limits) <= KEPT:
            break
    return found


def polar_angle(curve: Rolled, at_mm: tuple[float, float]) -> float:
    """Polar angle of a place about the curve's axis in rad, from 0 to 2 pi."""
    x, y = np.asarray(at_mm) - curve.axis_mm
    return float(np.arctan2(y, x)) % tau
