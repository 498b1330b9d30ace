"""The search for the carrier's axis for the path of a tip (``tip_path.py``), and the burden that rates an axis.

The burden of a motion says how near it brings the teeth, the lengths, the arms and the tool to their limits.  The axis
is tried on a grid; Nelder and Mead's method goes downhill from the best places.  It needs no derivatives, as the burden
is the greatest of several figures.
"""

from __future__ import annotations

from math import degrees, pi, tan

import numpy as np

from ncgear.errors import NoSuchMechanism
from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array, ComplexArray
from ncgear.trains.tip_path import GRID, NOT_PASSED, NoPath, TipMotion, WishedPath, missed_mm, motion_from


@dataclass(frozen=True)
class PathLimits:
    """Limits of the train: the largest tangent angle of the pitch curves in rad, the teeth, and the lengths.

    The middle lines of ``arms`` evenly spread arms stay ``apart_mm`` apart.  The carrier's axis is sought between
    the corners ``low`` and ``high``, or anywhere where they are None.
    """

    tangent_rad: float
    teeth: int
    longest_mm: float
    arms: int = 1
    apart_mm: float = 0.0
    low: complex | None = None
    high: complex | None = None

    def outside(self, axis: complex) -> float:
        """Distance in mm of an axis from the area where it may be."""
        if self.low is None or self.high is None:
            return 0.0
        x = max(self.low.real - axis.real, axis.real - self.high.real, 0.0)
        y = max(self.low.imag - axis.imag, axis.imag - self.high.imag, 0.0)
        return float(np.hypot(x, y))


CONCAVE, CONVEX = 0.16, 0.45
"""Greatest curvature times module that teeth bear on dented and on bulging stretches.  All of 144 random pitch curves
within these limits had gears."""


def pair_figures(motion: TipMotion) -> Array:
    """Tangents of the pitch curves' angle and curvatures times centre distance of two pairs that share a ratio evenly.

    Shape (3, 2, GRID): tangent, curvature of the driving and of the driven curve, for both pairs at all places of GRID.
    Each pair has half the logarithm of the ratio R(w): i = c sqrt(R) over w for the second pair, i = sqrt(R) / c over
    the idler's angle v for the first, where dv/dw = c sqrt(R).  With s = 1/i over the driven angle and primes for
    derivatives by it: the tangent is s'/(1 + s), k2 = (1 + s + s'') cos^3 / a and k1 + k2 = (1 + s)^2 cos / (a s).
    """
    (ratio, bend, change), _ = motion.hardness
    root = np.sqrt(ratio)
    second = root / root.mean()
    of_first = root * root.mean(), 1.0 / second, bend * bend / 2.0 - change / 2.0
    of_second = second, np.ones(GRID), bend * bend / 4.0 - change / 2.0
    found = []
    for own, per_driven, curving in (of_first, of_second):
        s = 1.0 / own
        tangent = -bend / 2.0 * per_driven * s / (1.0 + s)
        cosine = 1.0 / np.sqrt(1.0 + tangent * tangent)
        driven = (1.0 + s + s * per_driven**2 * curving) * cosine**3
        found.append((tangent, (1.0 + s) ** 2 * cosine / s - driven, driven))
    return np.array(found).transpose(1, 0, 2)


def burden(motion: TipMotion, limits: PathLimits) -> float:
    """How near the ratio comes to the limits of teeth: 1 at the nearest, more beyond; over 10 where no gears exist."""
    ratio = motion.hardness[0][0]
    if ratio.min() <= LEAST_RATIO:
        return 10.0 + float(LEAST_RATIO - ratio.min())
    tangent, driving, driven = pair_figures(motion)
    low, high = min(driving.min(), driven.min()), max(driving.max(), driven.max())
    shares = (
        float(np.abs(tangent).max()) / tan(limits.tangent_rad),
        -float(low) / (CONCAVE * limits.teeth),
        float(high) / (CONVEX * limits.teeth),
        max(motion.carrier_mm, motion.arm_mm) / limits.longest_mm,
    )
    return min(max(*shares, crowding(motion, limits)), 10.0)


def crowding(motion: TipMotion, limits: PathLimits) -> float:
    """The least distance that arms must keep over their distance; over 2 where they cross."""
    if limits.arms == 1:
        return 0.0
    w, u = motion.turn
    at = u[0] + np.linspace(0.0, 2.0 * pi, ROOM_PLACES, endpoint=False)
    crossing, nearest = 0.0, np.inf
    first = _arm(motion, at, w, u)
    for number in range(1, limits.arms // 2 + 1):
        offset = 2.0 * pi * number / limits.arms
        distance = segment_distances(*first, *_arm(motion, at + offset, w, u))
        crossing = max(crossing, float((distance == 0.0).mean()))
        nearest = min(nearest, float(distance.min()))
    return 2.0 + 8.0 * crossing if crossing else min(limits.apart_mm / nearest, 2.0)


ROOM_PLACES = 90
"""Angles of the carrier at which the search takes the distance of arms; a build searches the least distance."""


def _arm(motion: TipMotion, at: Array, w: Array, u: Array) -> tuple[ComplexArray, ComplexArray]:
    """Both ends of the arm about the carrier's axis at carrier angles, shape (n,)."""
    turns, within = np.divmod(at - u[0], 2.0 * pi)
    turned = np.interp(within + u[0], u, w) + 2.0 * pi * turns
    planet = motion.carrier_mm * np.exp(1j * at)
    return planet, planet + motion.arm_mm * np.exp(1j * (at - turned))


def segment_distances(a: ComplexArray, b: ComplexArray, c: ComplexArray, d: ComplexArray) -> Array:
    """Least distance of the segments from a to b and from c to d, complex of shape (n,); 0 where they cross."""

    def side(p: ComplexArray, q: ComplexArray, r: ComplexArray) -> Array:
        return ((q - p).conj() * (r - p)).imag

    def from_end(p: ComplexArray, q: ComplexArray, r: ComplexArray) -> Array:
        step = q - p
        share = np.clip(((r - p) * step.conj()).real / np.abs(step) ** 2, 0.0, 1.0)
        return np.abs(r - p - share * step)

    cross = (side(a, b, c) * side(a, b, d) < 0.0) & (side(c, d, a) * side(c, d, b) < 0.0)
    least = np.min([from_end(a, b, c), from_end(a, b, d), from_end(c, d, a), from_end(c, d, b)], axis=0)
    return np.where(cross, 0.0, least)


LEAST_RATIO = 0.02
"""du/dw below which the carrier counts as standing while the planet turns: teeth follow no ratio of 1:50."""


def found_motion(path: WishedPath, limits: PathLimits, axis: complex | None) -> TipMotion:
    """The motion of least burden about the given axis, or any; raises NoSuchMechanism, with place and reason."""
    from scipy.optimize import minimize

    size = float(np.abs(path.points - path.points.mean()).max())

    def tried(values: Array, clockwise: bool) -> tuple[float, TipMotion | NoPath]:
        place = axis if axis is not None else complex(values[2], values[3])
        outside = limits.outside(place)
        if outside:
            return 2.0 * NOT_PASSED + outside, NoPath(outside, "its axis is outside axis_from_mm and axis_to_mm")
        beyond = size * np.exp(np.clip(values[:2], -9.0, 1.0))
        motion = motion_from(path, place, (float(beyond[0]), float(beyond[1])), clockwise=clockwise)
        if isinstance(motion, NoPath):
            return motion.by, motion
        return burden(motion, limits) + _tool_missed(motion, path), motion

    starts: list[tuple[float, int, Array, bool]] = []
    for clockwise in (False, True):
        for place in [axis] if axis is not None else _places(path, size, limits):
            for beyond in BEYOND:
                values = np.array([np.log(beyond), np.log(beyond), place.real, place.imag])
                starts.append((tried(values, clockwise)[0], len(starts), values, clockwise))
    starts.sort(key=lambda start: start[:2])
    best, found = np.inf, tried(*starts[0][2:])[1]
    for _, _, values, clockwise in starts[:SEARCHES]:
        free = 2 if axis is not None else 4
        simplex = values[:free] + np.vstack([np.zeros(free), np.diag([0.7, 0.7, 0.1 * size, 0.1 * size][:free])])
        options = {"initial_simplex": simplex, "maxfev": 120 * free, "xatol": 1e-4, "fatol": 1e-4}

        def value(tail: Array, values: Array = values, clockwise: bool = clockwise) -> float:
            return tried(np.append(tail, values[tail.size :]), clockwise)[0]

        result = minimize(value, values[:free], method="Nelder-Mead", options=options)
        if result.fun < best:
            best, found = result.fun, tried(np.append(result.x, values[free:]), clockwise)[1]
    return _accepted(found, path, limits, axis)


BEYOND = 0.01, 0.05
"""First distances of the tried paths beyond the points, as shares of the path's size."""

SEARCHES = 5
"""Number of starting points of the search for the axis."""

PLACES = 13
"""Number of places along each side of the square where the search first tries axes."""

WIDE = 2.5
"""Half the side of that square, in sizes of the path."""


def _places(path: WishedPath, size: float, limits: PathLimits) -> list[complex]:
    side, middle = np.linspace(-1.0, 1.0, PLACES), complex(path.points.mean())
    low, high = middle - complex(WIDE * size, WIDE * size), middle + complex(WIDE * size, WIDE * size)
    if limits.low is not None and limits.high is not None:
        low, high = limits.low, limits.high
    half, middle = (high - low) / 2.0, (high + low) / 2.0
    return [middle + complex(half.real * x, half.imag * y) for x in side for y in side]


def _tool_missed(motion: TipMotion, path: WishedPath) -> float:
    """TOOL_WEIGHT times the excess of the tool's angle error over its tolerance, in tolerances."""
    if len(path.tool_rad) < 2:
        return 0.0
    return max(tool_mount(motion, path)[1] / path.tool_tolerance_rad - 1.0, 0.0) * TOOL_WEIGHT


TOOL_WEIGHT = 5.0
"""Weight of the tool's excess error against the burden of the teeth."""


def tool_mount(motion: TipMotion, path: WishedPath) -> tuple[float, float]:
    """The angle in rad of the tool against the arm with the least greatest error of its angles, and that error."""
    w, u = motion.turn
    places, sense = motion.tip_where(w, u), -1.0 if motion.clockwise else 1.0
    arm = sense * (u - w)
    found = []
    for number, angle in path.tool_rad:
        nearest = int(np.argmin(np.abs(places - path.points[number])))
        found.append(angle - arm[nearest])
    errors = found[0] + np.angle(np.exp(1j * (np.array(found) - found[0])))
    return float(errors.max() + errors.min()) / 2.0, float(errors.max() - errors.min()) / 2.0


def _accepted(found: TipMotion | NoPath, path: WishedPath, limits: PathLimits, axis: complex | None) -> TipMotion:
    free = "leave axis_mm out" if axis is not None else "" if limits.low is None else "let the axis be anywhere"
    helps = ", or ".join(filter(None, ("another order of the points, more distance, a larger tolerance_mm", free)))
    if isinstance(found, NoPath):
        raise NoSuchMechanism(f"no carrier passes the points: {found.words}; {helps}", key="path.points_mm")
    ratio, w = found.hardness[0][0], found.hardness[1]
    if ratio.min() <= LEAST_RATIO:
        where = found.tip(w[[int(np.argmin(ratio))]])[0]
        near = path.name(int(np.argmin(np.abs(path.points - where))))
        turned = "would have to turn back" if ratio.min() <= 0.0 else "all but stands"
        raise NoSuchMechanism(
            f"the carrier {turned} against the sun near point {near}, at {where.real:.4g}, {where.imag:.4g} mm, while "
            f"the planet turns on (du/dw = {ratio.min():.3g}); no gears can do that; {helps}",
            key="path.points_mm",
        )
    share, crowd = burden(found, limits), crowding(found, limits)
    if crowd > 1.0 and crowd >= share:
        raise NoSuchMechanism(
            f"{limits.arms} arms come nearer to each other than {limits.apart_mm:.4g} mm wherever the carrier's axis "
            "is; fewer arms, a smaller bar_width_mm, or another path is right",
            key="path.points_mm",
        )
    longest = max(found.carrier_mm, found.arm_mm)
    if longest > limits.longest_mm:
        raise NoSuchMechanism(
            f"the best train has a carrier of {found.carrier_mm:.4g} mm and an arm of {found.arm_mm:.4g} mm, and "
            f"{limits.longest_mm:g} mm are allowed; {longest:.4g} mm or more is right, or more teeth",
            key="path.longest_mm",
        )
    if share > MOST_BURDEN:
        tangent = pair_figures(found)[0]
        worst = int(np.argmax(np.abs(tangent).max(axis=0)))
        where = found.tip(w[[worst]])[0]
        raise NoSuchMechanism(
            f"the gears would need {share:.3g} times what teeth bear, worst near {where.real:.4g}, "
            f"{where.imag:.4g} mm; {helps}, or more teeth",
            key="path.points_mm",
        )
    if _tool_missed(found, path) > TOOL_ROUNDING:
        missed_deg = degrees(tool_mount(found, path)[1])
        raise NoSuchMechanism(
            f"the best train misses the tool's angles by {missed_deg:.3g} deg and "
            f"{degrees(path.tool_tolerance_rad):.3g} deg are allowed; a larger tool_tolerance_deg, or fewer angles",
            key="path.tool",
        )
    missed = missed_mm(found, path)
    over = missed / path.tolerance_mm
    if over.max() > 1.0:
        number = int(np.argmax(over))
        raise NoSuchMechanism(
            f"the best path misses it by {missed[number]:.4g} mm and {path.tolerance_mm[number]:g} mm are allowed; "
            f"{helps}",
            key=f"path.points_mm.{path.name(number) - 1}",
        )
    return found


TOOL_ROUNDING = 1e-3
"""Weighed excess of the tool's angle error that counts as rounding of the search."""

MOST_BURDEN = 1.6
"""Largest burden for a trial of teeth: nearly all curves within the limits can be made, and some beyond them."""
