"""Closed curves of named shapes, as pitch curves: formulas, points, ellipses, polygons, splines and chains of them.

Lengths are in mm.  Shapes that are drawn in the plane have their axis at (0, 0) unless it is given.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import ceil, cos, log2, pi, sin, tan, tau

import numpy as np
from scipy.interpolate import BSpline, make_interp_spline, splrep

from ncgear.errors import NoSuchMechanism, WrongInput
from ncgear.numerics import jet
from ncgear.numerics.arrays import Array
from ncgear.numerics.bounds import shown_above
from ncgear.numerics.formula import Formula, composed
from ncgear.numerics.jet import Jet
from ncgear.numerics.proven import proven, smooth_parts
from ncgear.numerics.rational import RationalSpline, arc, closed_uniform, line
from ncgear.numerics.units import in_words
from ncgear.ratio.laws.closed_curve import ClosedCurve, PointFunction, by_angle, drawn
from ncgear.ratio.laws.integrated import smooth_or_refused
from ncgear.ratio.transmission import JetFunction

Point = tuple[float, float]

STRAIGHT = 1e-9
"""Share of a polygon's side below which a straight part or a corner's radius is left out."""

SMOOTHINGS = 60
"""Most halvings of the smoothing until the curve keeps the points to their tolerance; then it goes through them."""

MANY_PLACES = 4000
"""Places of points for each mean: from twice as many on, a spline through means is sought first."""

SCATTERED_FROM, WHITE, COMMON = 500, 1.5, 0.12
"""Least number of points that show their scatter; the least ratio of von Neumann of scatter (2 for noise, near 0 for a
curve that follows too little); and the least share of the tolerance by which half the points miss the curve: normal
noise of 100 000 points beyond the tolerance has 0.15."""

SCATTER = 0.01
"""Share of the greatest radius by which points that scatter may turn back."""

WIDER = 1.05
"""Factor between tolerances that are tried for scattered points."""

SAME_PLACE_RAD = 1e-9
"""Angles of points nearer than this are one place of the curve."""

DEGREE = 5
"""Degree of the splines through points: curvature and its change are continuous."""


def formula_curve(text: str, key: str) -> ClosedCurve:
    """The curve of r(phi) in mm, phi in rad from 0 to 2 pi; raises WrongInput or NoSuchMechanism."""
    formula = composed(text, key, "phi")
    with smooth_or_refused(key):
        parts = [
            (_by_angle(part), proven(part, a, b).breaks.tolist()) for a, b, part in smooth_parts(formula, 0.0, tau)
        ]
    return by_angle(parts)


def _by_angle(formula: Formula) -> JetFunction:
    return lambda angle, order: formula(Jet.variable(angle, order))


def modified_ellipse(latus_mm: float, eccentricity: float, lobes: int, modification: float) -> ClosedCurve:
    """Lobes of r = p / (1 + e cos(n m phi)), with the factor m1 up to the greatest radius of a lobe, and m2 after it.

    1/m1 + 1/m2 = 2 makes the parts fill the lobe, so m1 is over 1/2; with m1 = 1 the lobes are symmetric, and with one
    lobe the curve is an ellipse about its focus.  The least radius is at phi = 0 (F. L. Litvin et al., "Noncircular
    Gears", Cambridge 2009, chapter 4).
    """

    def radius(factor: float, about: float) -> JetFunction:
        def at(angle: Array, order: int) -> Jet:
            _, cosine = jet.sin_cos((Jet.variable(angle, order) - about) * factor)
            return latus_mm / (1.0 + eccentricity * cosine)

        return at

    lobe, other = tau / lobes, modification / (2.0 * modification - 1.0)
    if modification == 1.0:
        return by_angle([(radius(float(lobes), 0.0), (0.0, tau))], endless=True)
    parts = []
    for number in range(lobes):
        start, end = number * lobe, (number + 1) * lobe
        top = start + pi / (lobes * modification)
        parts += [(radius(lobes * modification, start), (start, top)), (radius(lobes * other, end), (top, end))]
    return by_angle(parts)


def ellipse(semi_major_mm: float, semi_minor_mm: float, axis_mm: Point, key: str) -> ClosedCurve:
    """An ellipse about its centre, the major axis along x, that turns about any point inside."""
    x, y = axis_mm

    def point(at: Array, order: int) -> tuple[Jet, Jet]:
        sine, cosine = jet.sin_cos(Jet.variable(at, order))
        return cosine * semi_major_mm - x, sine * semi_minor_mm - y

    if not (x / semi_major_mm) ** 2 + (y / semi_minor_mm) ** 2 < 1.0:
        raise NoSuchMechanism(
            f"the axis at ({x:g}, {y:g}) mm is not inside the ellipse with semi axes of {semi_major_mm:.6g} and "
            f"{semi_minor_mm:.6g} mm",
            key=key,
        )
    return drawn([(point, (0.0, tau))], key, endless=True)


def rounded_polygon(sides: int, side_mm: float, corner_radius_mm: float, axis_mm: Point, key: str) -> ClosedCurve:
    """A regular polygon about its centre, the middle of a side at +x, whose corners are rounded by arcs.

    ``side_mm`` is the side of the sharp polygon; the radius is at most the radius of the circle in it.
    """
    step = tau / sides
    flat = side_mm / 2.0 / tan(step / 2.0)
    reach, along = (flat - corner_radius_mm) * tan(step / 2.0), (flat - corner_radius_mm) / cos(step / 2.0)
    parts: list[RationalSpline] = []
    for number in range(sides):
        ray, corner = number * step, (number + 0.5) * step
        if reach > STRAIGHT * side_mm:
            ends = [(flat * cos(ray) - y * sin(ray), flat * sin(ray) + y * cos(ray)) for y in (-reach, reach)]
            parts.append(line(*ends))
        if corner_radius_mm > STRAIGHT * side_mm:
            parts.append(arc((along * cos(corner), along * sin(corner)), corner_radius_mm, ray, step))
    return chain(parts, axis_mm, key)


def closed_b_spline(points_mm: Array, degree: int, axis_mm: Point, key: str) -> ClosedCurve:
    """The closed uniform B-spline of control points (shape (n, 2)) about an axis."""
    spline = closed_uniform(points_mm - np.array(axis_mm), degree)
    parts = spline.smooth_parts()
    return drawn([(part.at, part.breaks.tolist()) for part in parts], key, endless=len(parts) == 1)


MOST_CORNERS = 100
"""Most corners of a contour: with more it is an outline of chords, which must be smoothed; each corner takes 10 ms."""


def chain(curves: Sequence[RationalSpline], axis_mm: Point, key: str) -> ClosedCurve:
    """The contour of curves that follow each other, each beginning where the one before ends.

    Raises WrongInput for a contour of so many chords that it must be smoothed.
    """
    chords = sum(len(curve.points) - 1 for curve in curves if curve.degree == 1)
    if chords > MOST_CORNERS:
        raise WrongInput(
            f"the contour has {chords} chords, and no teeth roll over their corners; give tolerance_mm beside the "
            "file, within which a smooth curve follows them",
            key=key,
        )
    parts: list[tuple[PointFunction, Sequence[float]]] = []
    for curve in curves:
        moved = RationalSpline(curve.degree, curve.knots, curve.points - np.array(axis_mm), curve.weights)
        parts += [(part.at, part.breaks.tolist()) for part in moved.smooth_parts()]
    return drawn(parts, key)


def goes_round(points_mm: Array, axis_mm: Point) -> bool:
    """Whether a closed row of points (shape (n, 2)) goes round the axis."""
    away = np.concatenate([points_mm, points_mm[:1]]) - np.array(axis_mm)
    angles = np.unwrap(np.arctan2(away[:, 1], away[:, 0]))
    return round(float(angles[-1] - angles[0]) / tau) != 0


def middle_mm(points_mm: Array) -> Point | None:
    """The middle of a closed row of points (shape (n, 2)), in whole hundredths, if they go round it."""
    x, y = ((points_mm.min(axis=0) + points_mm.max(axis=0)) / 2.0).round(2).tolist()
    return (x, y) if goes_round(points_mm, (x, y)) else None


def require_round(points_mm: Array, axis_mm: Point, key: str) -> None:
    """Raise NoSuchMechanism, with a place that is right, where a closed row of points does not go round the axis."""
    if goes_round(points_mm, axis_mm):
        return
    middle, (x, y) = middle_mm(points_mm), axis_mm
    right = f"axis_x_mm: {middle[0]:g}, axis_y_mm: {middle[1]:g} is its middle" if middle else "move the axis"
    raise NoSuchMechanism(f"the curve does not go round its axis, which is at ({x:g}, {y:g}) mm; {right}", key=key)


def polar_points(points_mm: Array, tolerance_mm: float, key: str) -> tuple[Array, Array]:
    """Polar angle in rad and radius in mm of points (shape (n, 2)) around the axis, in either sense.

    Raises NoSuchMechanism where they do not go round the axis once, or turn back by more than the tolerance.
    """
    radius = np.hypot(points_mm[:, 0], points_mm[:, 1])
    if np.any(points_mm[0] != points_mm[-1]):
        points_mm, radius = np.concatenate([points_mm, points_mm[:1]]), np.append(radius, radius[0])
    if not np.all(radius > 0.0):
        raise NoSuchMechanism("a point is at the axis; the curve must go round it", key=key)
    steps = np.diff(np.unwrap(np.arctan2(points_mm[:, 1], points_mm[:, 0])))
    turns = round(float(steps.sum()) / tau)
    if turns not in (1, -1):
        _refuse_repeated(points_mm[:-1], abs(turns), key)
        _refuse_repeated(points_mm, abs(turns), key)
        said = f"the points go round the axis {abs(turns)} times; once is right: move the axis, or put them in order"
        raise NoSuchMechanism(said, key=key)
    along = np.concatenate([[0.0], turns * np.cumsum(steps)])
    back_mm = radius * (np.maximum.accumulate(along) - along)
    if np.max(back_mm) > tolerance_mm:
        at, most_mm = points_mm[int(np.argmax(back_mm > tolerance_mm))], float(np.max(back_mm))
        scatter = most_mm < SCATTER * float(np.max(radius))
        wider = f", or, where they scatter, give tolerance_mm: {shown_above(most_mm, 3)} or more" if scatter else ""
        raise NoSuchMechanism(
            f"the points turn back before ({at[0]:.6g}, {at[1]:.6g}) mm from the axis, at the polar angle "
            f"{in_words(float(np.arctan2(at[1], at[0])) % tau)}; every ray from the axis must meet the curve once: "
            f"move the axis, or smooth the points there{wider}",
            key=key,
        )
    return np.mod(np.arctan2(points_mm[:-1, 1], points_mm[:-1, 0]), tau), radius[:-1]


def _refuse_repeated(points: Array, times: int, key: str) -> None:
    """Raise WrongInput where rows of points, shape (n, 2), are one outline so many times over."""
    count = len(points) // max(times, 1)
    if times > 1 and count * times == len(points) and np.array_equal(points, np.tile(points[:count], (times, 1))):
        problem = f"the outline is given {times} times, and row {count + 1} of the points is row 1 again"
        raise WrongInput(f"{problem}; its first {count} rows alone are right", key=key)


def smoothed_points(
    angle_rad: Array, radius_mm: Array, tolerance_mm: float, repeats: int, key: str
) -> tuple[ClosedCurve, float]:
    """The smooth closed curve near points in polar form (shape (n,)), and its largest radial distance from a point in
    mm.

    It is a periodic quintic smoothing spline (P. Dierckx, "Curve and Surface Fitting with Splines", Oxford 1993,
    chapter 6) that keeps the tolerance with few knots, else the spline through the points. All points shape one of
    several lobes.  Raises NoSuchMechanism where lobes differ by more than the tolerance, and where many points scatter
    by more, with the tolerance that is kept.
    """
    period = tau / repeats
    folded = np.mod(angle_rad, period)
    order = np.argsort(folded, kind="stable")
    groups = np.cumsum(np.diff(folded[order], prepend=folded[order][0]) > SAME_PLACE_RAD)
    count = np.bincount(groups)
    angles = np.bincount(groups, folded[order]) / count
    radii = np.bincount(groups, radius_mm[order]) / count
    if angles.size > 1 and angles[0] + period - angles[-1] <= SAME_PLACE_RAD:
        angles, radii = angles[:-1], radii[:-1]
    if angles.size <= DEGREE:
        raise WrongInput(f"{angles.size} different places of a lobe; at least {DEGREE + 1} are needed", key=key)
    closed = np.append(angles, angles[0] + period), np.append(radii, radii[0])

    each, shows_scatter = angles.size // MANY_PLACES, angles.size >= SCATTERED_FROM

    def missed(spline: BSpline) -> Array:
        return np.abs(spline(folded, extrapolate="periodic") - radius_mm)

    def within(tolerance_mm: float) -> tuple[BSpline, Array, bool]:
        """The spline within a tolerance, or the smoothest one from which points only scatter, how far it misses them,
        and whether they scatter."""
        # Of many places, the means of a few neighbours show the curve; all places are judged.
        for few in (_means(*closed, each, period), closed) if each > 1 else (closed,):
            sum_ = len(few[0]) * tolerance_mm**2
            # Many points may scatter by far more than the tolerance: the smoothest curves, which are fast, show it.
            doublings = ceil(log2(max(float(np.var(few[1])) / tolerance_mm**2, 1.0))) if shows_scatter else 0
            for halving in range(-doublings, SMOOTHINGS):
                smoothing = sum_ / 2.0**halving
                knots_and_more, _, fault, _ = splrep(*few, k=DEGREE, s=smoothing, per=True, full_output=1, quiet=1)
                spline = BSpline(*knots_and_more)
                if fault > 0 or (few is not closed and len(spline.t) > len(few[0]) // 2):
                    break
                noise = shows_scatter and _are_noise(spline(few[0]) - few[1])
                if halving < 0 and not noise:
                    continue
                misses = missed(spline)
                if halving >= 0 and np.max(misses) <= tolerance_mm:
                    return spline, misses, False
                # At a corner a few points miss the curve by more than the others.
                if noise and np.median(misses) > COMMON * tolerance_mm:
                    return spline, misses, True
        through = make_interp_spline(*closed, k=DEGREE, bc_type="periodic")
        return through, missed(through), False

    spline, misses, scattered = within(tolerance_mm)
    worst = int(np.argmax(misses))
    missed_mm = float(misses[worst])
    at = f"the point at {in_words(float(angle_rad[worst]))}, {radius_mm[worst]:.6g} mm"
    if scattered:
        kept_mm = float(shown_above(missed_mm, 3))
        while within(kept_mm)[2]:
            kept_mm = float(shown_above(WIDER * kept_mm, 3))
        raise NoSuchMechanism(
            f"the points scatter about {'a smooth curve' if repeats == 1 else f'{repeats} equal lobes'}, {at}, by "
            f"{missed_mm:.3g} mm, over the tolerance of {tolerance_mm:g} mm; tolerance_mm: {kept_mm:g} or more"
            f"{'' if repeats == 1 else ', or gears.lobes that the points have,'} is right",
            key=key,
        )
    if missed_mm > tolerance_mm:
        raise NoSuchMechanism(
            f"{repeats} equal lobes miss {at}, by {missed_mm:.3g} mm, over the tolerance of {tolerance_mm:g} mm; give "
            "gears.lobes that the points have, or a wider tolerance_mm",
            key=key,
        )
    return _periodic(spline, period, repeats), missed_mm


def _are_noise(deviations: Array) -> bool:
    """Whether the deviations of points along a curve (shape (n,)) are noise, by the ratio of J. von Neumann (Annals of
    Mathematical Statistics 12, 1941): mean square of the steps from one to the next, by their own mean square.
    """
    return float(np.sum(np.diff(deviations) ** 2)) > WHITE * float(np.sum(deviations**2))


def _means(angles: Array, radii: Array, each: int, period: float) -> tuple[Array, Array]:
    """Means of ``each`` neighbouring places of a closed curve, with the first mean once more at the end."""
    first = np.arange(0, len(angles) - 1, each)
    count = np.diff(np.append(first, len(angles) - 1))
    mean = [np.add.reduceat(values[:-1], first) / count for values in (angles, radii)]
    return np.append(mean[0], mean[0][0] + period), np.append(mean[1], mean[1][0])


def _periodic(spline: BSpline, period: float, repeats: int) -> ClosedCurve:
    start = float(spline.t[DEGREE])
    inner = np.unique(spline.t[(spline.t > start) & (spline.t < start + period)])
    lobes = start + period * np.arange(repeats)[:, None]
    breaks = np.append((lobes + np.append(0.0, inner - start)).ravel(), start + tau)
    slopes = [spline.derivative(k) if k else spline for k in range(DEGREE + 1)]

    def radius(angle: Array, order: int) -> Jet:
        within = start + np.mod(angle - start, period)
        rows, factorial = [], 1.0
        for k in range(order + 1):
            factorial *= max(k, 1)
            rows.append(slopes[k](within) / factorial if k <= DEGREE else np.zeros_like(within))
        return Jet(np.array(rows))

    return by_angle([(radius, breaks.tolist())], endless=True)
