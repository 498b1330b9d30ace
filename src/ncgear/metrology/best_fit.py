"""Pose of a measured gear: the turning, and the shift if the bore does not give it, that fit its flanks best.

The sum of squares of the points' distances along the normals of the exact flanks is made least over the angle theta and
the shift (x, y).  With n the unit normal away from the material at the foot of a point p,

  d distance / d shift = n,    d distance / d theta = n . (i p) = cross(p, n)

hold exactly, so the steps of scipy.optimize.least_squares have exact slopes.  Only points on working flanks count:
root, tip lands, bore and points astray do not turn the gear, nor do points that stand alone.  The fit
decides which points these are, and the choice is repeated until it stays the same.

The fit begins at the best of many angles: the outline of a gear with z teeth nearly repeats itself from tooth to tooth.

Points that stand alone are dust, a probe that slipped, a wrong digit; they are not metal of the gear.  Metal goes on
from point to point: a flank that stands off does so along all of it, wear or a burr along a part.  So each point is
compared with the median of five, itself in their middle, along its flank, root or tip land; at an end of it, with the
median of the last five.  Three points that stand off together are the median themselves, and belong to the gear; one or
two do not.  The noise of the measurement follows from the steps from each point to the next: from the median of their
distances from their median, which outliers do not move (Hampel 1974; ``scipy.stats.median_abs_deviation``).
"""

from __future__ import annotations

from dataclasses import replace
from math import pi, sqrt

import numpy as np

from ncgear.errors import NoSuchMechanism, Unanswered, WrongInput
from ncgear.frozen import dataclass
from ncgear.metrology.exact_outline import FLANK_CURVE, ExactOutline, Feet
from ncgear.numerics.arrays import Array, ComplexArray, IndexArray, Mask
from ncgear.numerics.plane import across

TOGETHER = 5
"""Points of a median."""

FEWEST_PLACES = 3
"""Fewest places of a curve that show that one of them stands alone."""

DIGITS = 9
"""Equal decimals in mm of points at one place: a file has fewer, and rounding of a turned point is less."""

SIGMAS = 8.0
"""Standard deviations of the noise beyond which no point of a million is by chance, even in a slightly heavier tail."""

LEAST_IN_MODULES = 0.002
"""Least distance in modules of a point that stands off: less does no harm, as in small outlines' tolerance."""

STEEP = 3.0
"""Factor of the medians' change from point to point, as at a burr's edge, by which a point must stand off there."""

MOST = 0.05
"""Share of the points above which they are no faults of a measurement: the gear, or the probe, is rough."""


def alone_mm(outline: ExactOutline, feet: Feet) -> Array:
    """Distance in mm of each point that stands alone from its neighbours, away from the material, (n,); 0 for others.

    Points at one place count as one.  No point stands alone on a rough gear, or on a curve of fewer than three places.
    """
    off, same = _standing_off(outline, feet)
    return off[same] if _are_few(off) else np.zeros(same.size)


def rough_points(outline: ExactOutline, feet: Feet) -> int:
    """Number of places that stand off from their neighbours if they are too many to be faults; else 0."""
    off, _ = _standing_off(outline, feet)
    return 0 if _are_few(off) else int(np.count_nonzero(off))


def _are_few(off: Array) -> bool:
    """Whether places that stand off are too few for roughness; one place is, however few points there are."""
    return int(np.count_nonzero(off)) <= max(1.0, MOST * off.size)


def _standing_off(outline: ExactOutline, feet: Feet) -> tuple[Array, IndexArray]:
    """Distance in mm by which each place stands off, 0 where it does not, and the number of each point's place."""
    from scipy.ndimage import maximum_filter1d
    from scipy.stats import median_abs_deviation

    one, same = _places(feet)
    feet = feet.kept(one)
    off, least, steps = np.zeros(one.size), np.zeros(one.size), [np.zeros(0)]
    curves = _curves(outline, feet)
    order = np.lexsort((feet.place_mm, curves))
    for points in np.split(order, np.flatnonzero(np.diff(curves[order])) + 1):
        if points.size >= FEWEST_PLACES:
            among = feet.distance_mm[points]
            middle = _medians(among)
            change = maximum_filter1d(np.abs(np.diff(middle, append=middle[-1])), TOGETHER + 1, mode="nearest")
            off[points] = among - middle
            least[points] = STEEP * change[_about(among.size, min(TOGETHER, among.size))]
            steps.append(np.diff(among))
    # With independent errors a step between neighbours has twice the variance.
    steps_mm = np.concatenate(steps)
    noise = float(median_abs_deviation(steps_mm, scale="normal")) / sqrt(2.0) if steps_mm.size else 0.0
    least = np.maximum(least, max(SIGMAS * noise, LEAST_IN_MODULES * outline.gear.flanks.rack.module_mm))
    return np.where(np.abs(off) > least, off, 0.0), same


def are_judged(outline: ExactOutline, feet: Feet) -> Mask:
    """Mask of points with enough others on their curve to show whether they stand alone, shape (n,)."""
    one, same = _places(feet)
    _, curve, places = np.unique(_curves(outline, feet.kept(one)), return_inverse=True, return_counts=True)
    return (places[curve] >= FEWEST_PLACES)[same]


def _medians(among: Array) -> Array:
    """Medians of the five values about each, or of the five at an end; of four, the middle one nearest to each."""
    from numpy.lib.stride_tricks import sliding_window_view

    width = min(TOGETHER, among.size)
    ordered = np.sort(sliding_window_view(among, width), axis=1)
    about = _about(among.size, width) - width // 2
    return np.clip(among, ordered[about, (width - 1) // 2], ordered[about, width // 2])


def _about(count: int, width: int) -> IndexArray:
    """The middle of the window about each point, or of the nearest whole window."""
    return np.clip(np.arange(count), width // 2, count - (width + 1) // 2)


def _places(feet: Feet) -> tuple[IndexArray, IndexArray]:
    _, one, same = np.unique(feet.point.round(DIGITS), return_index=True, return_inverse=True)
    return one, same


def _curves(outline: ExactOutline, feet: Feet) -> IndexArray:
    """Number of the curve of each point: a flank is one curve, however many rows it has; shape (n,)."""
    on_flank = outline.part[feet.row] == FLANK_CURVE
    return np.where(on_flank, outline.flank[feet.row], outline.gear.flanks.count + feet.row)


FEWEST = 12
"""Fewest points on working flanks for a fit."""

ASTRAY_IN_MODULES = 0.25
"""Least distance in modules from the outline of points that belong to bore, hub or something else."""

AT_END, AT_END_IN_MODULES = 1e-4, 1e-4
"""Share of a flank, and height in modules, within which a point is at the end of the working flank: the corners of a
written outline are, and rounding must not choose among them."""

BEGUN_PER_TOOTH = 12
"""Angles per tooth pitch where a fit may begin."""

FEW = 250
"""Points that find the best of these angles."""

BEGINNINGS = 3
"""Number of best angles where fits begin; as many of the nearly as good angles that turn least are added."""

NEARLY = 1.5
"""Largest factor of the least average distance of points for an angle that is nearly as good as the best."""

ALIKE = 1.02
"""Largest factor of the least r.m.s. for a fit that is as good as the best; the fit that turns least is taken.  A gear
that repeats itself fits as often as it has lobes, and its noise must not choose among them."""

ROUNDING_IN_MODULES = 3e-10
"""Rounding of the distances of exact points, in modules."""

STEP_TOLERANCE = 1e-11
"""Relative steps and gains at which a fit ends: far below a nanometre at the teeth."""

WORST_CONDITION = 1e8
"""Condition of the normal equations, in lengths, beyond which angle and shift cannot be separated."""

TRIED_ROUNDS, ROUNDS = 2, 12
"""Most rounds of choosing the points that count: for a tried beginning, and for the fit itself."""


@dataclass(frozen=True)
class Pose:
    """Pose of the gear in the coordinates of its points: turned by an angle in rad and moved by a shift in mm."""

    angle_rad: float
    shift_mm: complex = 0j

    def of_gear(self, points: ComplexArray) -> ComplexArray:
        """Points of the file in the gear's own frame."""
        return (points - self.shift_mm) * np.exp(-1j * self.angle_rad)


@dataclass(frozen=True, eq=False)
class BestFit:
    """The pose of best fit, and the feet of all n points in the gear's own frame, less the probe's radius.

    ``counted`` (shape (n,)) is the mask of the fit's points, and ``alone_mm`` the distance of points that are left out
    because they stand alone; 0 for the others.  ``angle_error_rad`` and ``shift_error_mm`` are the standard deviations
    from the scatter of the fit's points; the shift is None where the bore was kept.
    """

    pose: Pose
    feet: Feet
    counted: Mask
    angle_error_rad: float
    shift_error_mm: float | None
    alone_mm: Array

    @property
    def alone(self) -> Mask:
        """Mask of points that stand alone, shape (n,)."""
        return self.alone_mm != 0.0

    @property
    def rms_mm(self) -> float:
        """Root mean square of the distances after the fit."""
        return sqrt(float(np.mean(self.feet.distance_mm[self.counted] ** 2)))


def best_fit(outline: ExactOutline, points: ComplexArray, probe_mm: float, *, rigid: bool) -> BestFit:
    """The pose of points, shape (n,), which are centres of a probe's ball of radius ``probe_mm``; 0 for surface points.

    With ``rigid`` the shift is fitted besides the angle.  Raises WrongInput where too few points lie on the flanks, and
    NoSuchMechanism where the points do not determine the pose.
    """
    some = points[:: max(1, points.size // FEW)]
    tried = (
        _fitted(outline, some, probe_mm, pose, rigid, TRIED_ROUNDS)
        for pose in _beginnings(outline, some, probe_mm, rigid)
    )
    fits = [fit for fit in tried if fit is not None]
    least = min((fit.rms_mm for fit in fits), default=0.0)
    rounding_mm = ROUNDING_IN_MODULES * outline.gear.flanks.rack.module_mm
    alike = [fit for fit in fits if fit.rms_mm <= ALIKE * least + rounding_mm]
    nearest = min(alike, key=lambda fit: abs(fit.pose.angle_rad), default=None)
    if nearest is not None and rigid:
        nearest = _by_teeth(outline, some, probe_mm, nearest)
    found = _without_those_alone(outline, points, probe_mm, nearest.pose, rigid) if nearest else None
    if found is None:
        raise WrongInput(
            f"fewer than {FEWEST} of {points.size} points lie on working flanks, however the gear is turned; points "
            "of the flanks of this gear in mm, with its axis at (0, 0), are right"
        )
    return found


def _without_those_alone(
    outline: ExactOutline, points: ComplexArray, probe_mm: float, pose: Pose, rigid: bool
) -> BestFit | None:
    """The best fit near a pose without points that stand alone in it; None for too few points on flanks."""
    found = _fitted(outline, points, probe_mm, pose, rigid, ROUNDS)
    for _ in range(ROUNDS):
        if found is None:
            return None
        alone = alone_mm(outline, found.feet)
        if np.array_equal(alone != 0.0, found.alone):
            return replace(found, alone_mm=alone)
        found = _fitted(outline, points, probe_mm, found.pose, rigid, ROUNDS, alone)
    return found


def _by_teeth(outline: ExactOutline, points: ComplexArray, probe_mm: float, fit: BestFit) -> BestFit:
    """The best of a rigid fit and fits a tooth farther on, and on from there, as long as they are better.

    A gear nearly round about its middle nearly fits a tooth farther on with its axis moved, wherever its bore is.
    """
    count = outline.gear.flanks.count // 2
    for _ in range(count):
        middle = fit.pose.shift_mm + outline.middle_mm * complex(np.exp(1j * fit.pose.angle_rad))
        angles = [fit.pose.angle_rad + step * 2.0 * pi / count for step in (-1, 1)]
        poses = (Pose(angle, middle - outline.middle_mm * complex(np.exp(1j * angle))) for angle in angles)
        beside = [_fitted(outline, points, probe_mm, pose, True, TRIED_ROUNDS) for pose in poses]
        best = min((fit for fit in beside if fit is not None), key=lambda fit: fit.rms_mm, default=fit)
        if best.rms_mm * ALIKE >= fit.rms_mm:
            break
        fit = best
    return fit


def nearness_mm(outline: ExactOutline, points: ComplexArray, probe_mm: float) -> float:
    """Distance of points from an outline at the best of many angles: r.m.s., each distance up to a quarter module."""
    some = points[:: max(1, points.size // FEW)]
    begun = _begun(outline, some, probe_mm)
    best = min(begun, key=lambda pair: pair[0])[1].angle_rad
    step = 2.0 * pi / len(begun)
    finer = best + step * np.linspace(-1.0, 1.0, 2 * BEGUN_PER_TOOTH + 1)
    return min(_nearness_mm(outline, some, probe_mm, Pose(float(angle))) for angle in finer)


def _nearness_mm(outline: ExactOutline, points: ComplexArray, probe_mm: float, pose: Pose) -> float:
    astray = ASTRAY_IN_MODULES * outline.gear.flanks.rack.module_mm
    away = np.minimum(np.abs(outline.near_mm(pose.of_gear(points)) - probe_mm), astray)
    return sqrt(float(np.mean(away**2)))


def _beginnings(outline: ExactOutline, points: ComplexArray, probe_mm: float, rigid: bool) -> list[Pose]:
    """The poses where fits begin, the best of many; if ``rigid`` also about the middle of the points."""
    poses = _chosen(_begun(outline, points, probe_mm))
    return poses + (_chosen(_begun(outline, points, probe_mm, by_middle=True)) if rigid else [])


def _chosen(begun: list[tuple[float, Pose]]) -> list[Pose]:
    worth = np.array([pair[0] for pair in begun])
    lowest = np.flatnonzero((worth <= np.roll(worth, 1)) & (worth <= np.roll(worth, -1)))
    best = lowest[np.argsort(worth[lowest], kind="stable")][:BEGINNINGS]
    nearly = lowest[worth[lowest] <= NEARLY * worth.min()]
    least = nearly[np.argsort([abs(begun[place][1].angle_rad) for place in nearly], kind="stable")][:BEGINNINGS]
    return [begun[place][1] for place in dict.fromkeys([*best.tolist(), *least.tolist()])]


def _begun(
    outline: ExactOutline, points: ComplexArray, probe_mm: float, *, by_middle: bool = False
) -> list[tuple[float, Pose]]:
    """Poses at many angles from -pi to pi, 0 among them, and their distance; the axis at 0 or by the points' mean."""
    count = BEGUN_PER_TOOTH * (outline.gear.flanks.count // 2)
    angles = [step * 2.0 * pi / count for step in range(-(count // 2), count - count // 2)]
    middle, own = (complex(points.mean()), outline.middle_mm) if by_middle else (0j, 0j)
    poses = [Pose(angle, middle - own * complex(np.exp(1j * angle))) for angle in angles]
    return [(_nearness_mm(outline, points, probe_mm, pose), pose) for pose in poses]


def _fitted(
    outline: ExactOutline,
    points: ComplexArray,
    probe_mm: float,
    pose: Pose,
    rigid: bool,
    rounds: int,
    alone: Array | None = None,
) -> BestFit | None:
    """The best fit near a pose, without points that stand ``alone``; None where too few points are on flanks."""
    from scipy.optimize import least_squares

    last: list[tuple[Array, Feet]] = []

    def feet(values: Array, some: ComplexArray) -> Feet:
        """The feet in a pose; the last feet are kept, since slopes are needed where distances were."""
        if not last or last[0][1].point.size != some.size or not np.array_equal(last[0][0], values):
            last[:] = [(values.copy(), outline.feet(_pose(values).of_gear(some)).less(probe_mm))]
        return last[0][1]

    # Turning a gear moves its flanks by about their distance from the axis.
    size = float(np.abs(outline.gear.outline_mm).max())
    scale = np.array([1.0 / size, 1.0, 1.0] if rigid else [1.0 / size])
    values = np.array([pose.angle_rad, pose.shift_mm.real, pose.shift_mm.imag])[: scale.size]
    alone = np.zeros(points.size) if alone is None else alone
    counted = on_flanks(outline, feet(values, points)) & (alone == 0.0)
    for _ in range(rounds):
        if np.count_nonzero(counted) < FEWEST:
            return None
        solved = least_squares(
            lambda tried, own: feet(tried, own).distance_mm,
            values,
            jac=lambda tried, own: _slopes(feet(tried, own), tried),
            x_scale=scale,
            xtol=STEP_TOLERANCE,
            ftol=STEP_TOLERANCE,
            gtol=STEP_TOLERANCE,
            args=(points[counted],),
        )
        if not solved.success:
            raise Unanswered(f"the best fit of measured points was not found: {solved.message}")
        values, before = solved.x, counted
        counted = on_flanks(outline, feet(values, points)) & (alone == 0.0)
        if np.array_equal(before, counted):
            break
    if np.count_nonzero(counted) < FEWEST:
        return None
    found = feet(values, points)
    spread = _spread(_slopes(found.kept(counted), values), found.distance_mm[counted], scale)
    shift_error = float(spread[1:].max()) if rigid else None
    return BestFit(_pose(values), found, counted, float(spread[0]), shift_error, alone)


def _pose(values: Array) -> Pose:
    return Pose(float(values[0]), complex(*values[1:])) if values.size > 1 else Pose(float(values[0]))


def _slopes(feet: Feet, values: Array) -> Array:
    """Slopes of the distances by the pose's numbers, shape (n, 1 or 3)."""
    # In the frame of a gear that is turned farther, its points are turned back.
    turning = -across(feet.point, feet.outwards)
    if values.size == 1:
        return turning[:, None]
    shifting = feet.outwards * np.exp(1j * values[0])
    return np.column_stack([turning, -shifting.real, -shifting.imag])


def _spread(slopes: Array, left: Array, scale: Array) -> Array:
    """Standard deviations of the pose's numbers from the remaining scatter."""
    scaled = slopes * scale
    normal = scaled.T @ scaled
    if np.linalg.cond(normal) > WORST_CONDITION:
        raise NoSuchMechanism(
            "the points do not tell where the gear stands: they lie on flanks of one direction; points of teeth all "
            "around, or --fit rotation, are right"
        )
    free = max(left.size - scale.size, 1)
    return scale * np.sqrt(np.diag(np.linalg.inv(normal)) * float(left @ left) / free)


def on_flanks(outline: ExactOutline, feet: Feet) -> Mask:
    """Mask of points on working flanks: not as deep as the mate reaches, and not at the edge of the tip."""
    on_flank = outline.part[feet.row] == FLANK_CURVE
    flank = np.where(on_flank, outline.flank[feet.row], 0)
    deep = AT_END_IN_MODULES * outline.gear.flanks.rack.module_mm - outline.gear.tips.met_depth_mm[flank]
    works = outline.height_mm(feet.row, feet.share) > deep
    inside = np.minimum(feet.share, 1.0 - feet.share) > AT_END
    return on_flank & works & inside & ~is_astray(outline, feet)


def is_astray(outline: ExactOutline, feet: Feet) -> Mask:
    """Mask of points so far from the outline that they belong to bore, hub or something else."""
    return np.abs(feet.distance_mm) >= ASTRAY_IN_MODULES * outline.gear.flanks.rack.module_mm
