"""A closed path of the tip of a planet's arm: the carrier, the arm and the ratio that make it.

With the carrier of length s at the angle u and the arm of length l at u - w, the tip is at

    axis + s exp(i u) + l exp(i (u - w)),        r^2 = s^2 + l^2 + 2 s l cos w,

r being its distance from the carrier's axis.  The planet turns by w against the carrier, and gears exist where w and u
both grow all the way.  So r falls from s + l to its least, |s - l|, and rises again, once each in a cycle: the farthest
and the nearest place of the path from the axis give both lengths.  Where the axis is inside the path the carrier is the
longer one, else the arm.  Each place of the path then has its own w, by r and by the side it is on, and u follows from
the direction theta of the place: u = theta - arg(s + l exp(-i w)).  The path is free in u(w) - w alone, a periodic
function of w, which is a Fourier series here: the smoothest that passes all points within their tolerances.  The ratio
of the gears is du/dw.  What is sought is the axis, and how far the path goes beyond the points.

Source of the inverse: the two-link chain of any textbook; the conditions are its derivatives.
"""

from __future__ import annotations

from functools import cache, cached_property
from math import degrees, pi, tan

import numpy as np

from ncgear.errors import NoSuchMechanism
from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array, ComplexArray

HARMONICS = 24
"""Harmonics of u - w: as many as two for each of a dozen points; the smoothing leaves few of them large."""

ORDERS = np.arange(1.0, HARMONICS + 1.0)

GRID = 360
"""Angles w at which ratios are judged during the search; a harmonic of the highest order has 15 of them."""

USED_TOLERANCE = 0.8
"""Share of the tolerance that the smoothest curve may use; the rest is for what linear terms leave out."""

ROUNDS = 3
"""Rounds of weighing how an error of u moves the path across itself."""

SMOOTHING = 10.0 ** np.arange(2.0, -9.0, -1.0)
"""Weights of the third derivative that are tried, the smoothest first."""


@dataclass(frozen=True, eq=False)
class WishedPath:
    """Points in mm, complex of shape (n,), in the order in which the tip passes them, with their tolerances in mm.

    ``tool_rad`` are angles of the tool at some of the points, by their numbers, and ``tool_tolerance_rad`` is by how
    much they may be missed.
    """

    points: ComplexArray
    tolerance_mm: Array
    tool_rad: tuple[tuple[int, float], ...] = ()
    tool_tolerance_rad: float = 0.0

    @property
    def mirrored(self) -> WishedPath:
        """The path seen from the other side."""
        tools = tuple((number, -angle) for number, angle in self.tool_rad)
        return WishedPath(self.points.conj(), self.tolerance_mm, tools, self.tool_tolerance_rad)


@dataclass(frozen=True)
class PathLimits:
    """What the train has to keep: the largest tangent angle of the pitch curves in rad, the teeth, and the lengths.

    Of curvatures times module the gears bear ``CONCAVE`` to ``CONVEX``.  The middle lines of ``arms`` arms, evenly
    spread, stay ``apart_mm`` from each other.  The carrier's axis is sought between two corners, ``low`` and ``high``,
    or anywhere where they are None.
    """

    tangent_rad: float
    teeth: int
    longest_mm: float
    arms: int = 1
    apart_mm: float = 0.0
    low: complex | None = None
    high: complex | None = None

    def outside(self, axis: complex) -> float:
        """How far an axis is from where it may be, in mm."""
        if self.low is None or self.high is None:
            return 0.0
        x = max(self.low.real - axis.real, axis.real - self.high.real, 0.0)
        y = max(self.low.imag - axis.imag, axis.imag - self.high.imag, 0.0)
        return float(np.hypot(x, y))


CONCAVE, CONVEX = 0.16, 0.45
"""Curvature times module that teeth bear on dented and on bulging stretches.

Of 144 random curves within these all were built (docs/outlines.md).
"""


@dataclass(frozen=True, eq=False)
class TipMotion:
    """The carrier's angle over w, and the lengths: u = w + start + the series.

    ``waves`` has the cosines and the sines of orders 1 to HARMONICS, shape (2 HARMONICS,).  ``clockwise`` says that all
    is seen from the other side: the carrier turns clockwise.  ``axis`` is in the frame of the points.
    """

    axis: complex
    carrier_mm: float
    arm_mm: float
    start_rad: float
    waves: Array
    clockwise: bool

    def carrier_rad(self, w: Array, order: int = 0) -> Array:
        """u at angles w, shape (n,), or its derivative of an order."""
        found: Array = _waves(w, order) @ self.waves
        if order == 0:
            found = found + w + self.start_rad
        return found + 1.0 if order == 1 else found

    def tip(self, w: Array) -> ComplexArray:
        """The path at angles w, complex of shape (n,), in the frame of the points."""
        return self.tip_where(w, self.carrier_rad(w))

    def tip_where(self, w: Array, u: Array) -> ComplexArray:
        """The path where planet and carrier have turned by w and u, shape (n,) all."""
        there = self.carrier_mm * np.exp(1j * u) + self.arm_mm * np.exp(1j * (u - w))
        path: ComplexArray = self.axis + (there.conj() if self.clockwise else there)
        return path

    def ratio(self, count: int) -> tuple[Array, Array]:
        """Angles w that divide a turn evenly, and du/dw there, shape (count,) each."""
        w = np.linspace(0.0, 2.0 * pi, count, endpoint=False)
        return w, self.carrier_rad(w, 1)

    @cached_property
    def turn(self) -> tuple[Array, Array]:
        """Angles w from 0 to a turn, shape (GRID + 1,), and the carrier's angles u there."""
        w, waves = _on_grid()
        u = waves[0] @ self.waves + w + self.start_rad
        return np.append(w, 2.0 * pi), np.append(u, u[0] + 2.0 * pi)

    @cached_property
    def hardness(self) -> tuple[Array, Array]:
        """The ratio of the whole on GRID and the logarithm's first two derivatives by w, as (3, GRID), and w."""
        w, waves = _on_grid()
        first, second, third = waves[1:] @ self.waves + [[1.0], [0.0], [0.0]]
        bend = second / first
        return np.array([first, bend, third / first - bend * bend]), w


def _waves(w: Array, order: int) -> Array:
    """Derivatives of the cosines and sines of w, shape (n, 2 HARMONICS)."""
    turned = w[:, None] * ORDERS + order * pi / 2.0
    scale = ORDERS**order
    return np.concatenate([scale * np.cos(turned), scale * np.sin(turned)], axis=1)


@cache
def _on_grid() -> tuple[Array, Array]:
    """GRID angles w of a turn, and the waves there with three derivatives, shape (4, GRID, 2 HARMONICS)."""
    w = np.linspace(0.0, 2.0 * pi, GRID, endpoint=False)
    return w, np.array([_waves(w, order) for order in range(4)])


def pair_figures(motion: TipMotion) -> Array:
    """Tangents of the pitch curves' angle and curvatures times centre distance of two pairs that share a ratio evenly.

    Of both pairs and all places of GRID, shape (3, 2, GRID): tangent, curvature of the driving and of the driven curve.
    Each pair has half the logarithm of the ratio R(w): i = c sqrt(R) over w of the second pair, sqrt(R) / c over the
    idler's angle v of the first, where dv/dw = c sqrt(R).  With s = 1/i over the driven angle, primes by it: the
    tangent is s'/(1 + s), k2 = (1 + s + s'') cos^3 / a and k1 + k2 = (1 + s)^2 cos / (a s).
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
    """How near the ratio is to what teeth bear: 1 at the nearest limit, more beyond; over 10 where no gears exist."""
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
    """The least distance that arms have to keep over the distance that they keep; over 2 where they cross."""
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
"""Angles of the carrier at which the distance of arms is taken during the search; a build searches the least."""


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
        distance: Array = np.abs(r - p - share * step)
        return distance

    cross = (side(a, b, c) * side(a, b, d) < 0.0) & (side(c, d, a) * side(c, d, b) < 0.0)
    least = np.min([from_end(a, b, c), from_end(a, b, d), from_end(c, d, a), from_end(c, d, b)], axis=0)
    return np.where(cross, 0.0, least)


LEAST_RATIO = 0.02
"""du/dw below which the carrier counts as standing while the planet turns: teeth follow no ratio of 1:50."""


@dataclass(frozen=True, eq=False)
class Refused:
    """Why no motion passes the points from an axis, and by how much: a number that a search can lessen."""

    by: float
    words: str


def motion_from(
    path: WishedPath, axis: complex, beyond_mm: tuple[float, float], *, clockwise: bool
) -> TipMotion | Refused:
    """The smoothest motion about an axis whose path passes the points.

    ``beyond_mm`` is by how much the path goes beyond the farthest and the nearest point.
    """
    seen = path.mirrored if clockwise else path
    arms = seen.points - (axis.conjugate() if clockwise else axis)
    r, theta = np.abs(arms), np.unwrap(np.angle(arms))
    far, near = r.max() + beyond_mm[0], r.min() - beyond_mm[1]
    if near <= NEAREST * far:
        return Refused(float(NEAREST * far - near) + NOT_PASSED, "the path passes too near to the carrier's axis")
    w = _turns_of(r, far, near)
    if isinstance(w, Refused):
        return w
    winding = round(float(theta[-1] - theta[0] + np.angle(arms[0] / arms[-1])) / (2.0 * pi))
    if winding not in (0, 1):
        return Refused(NOT_PASSED, "the path turns about the carrier's axis against the carrier")
    carrier, arm = ((far + near) / 2.0, (far - near) / 2.0) if winding else ((far - near) / 2.0, (far + near) / 2.0)
    fitted, missed = _smoothest(seen, r, theta, w, carrier, arm)
    if missed.max() > 1.0:
        worst = int(np.argmax(missed)) + 1
        return Refused(
            UNEVEN + min(float(missed.max()), UNEVEN), f"no smooth path keeps point {worst} and its neighbours"
        )
    return TipMotion(axis, carrier, arm, fitted[0], fitted[1:], clockwise)


UNEVEN = 20.0
"""Burden of an axis from which no series of HARMONICS waves keeps the points, and what is added to it at most."""

NOT_PASSED = 100.0
"""Burden of an axis from which the points cannot be passed at all."""

NEAREST = 0.02
"""Least distance of the path from the axis, as a share of the greatest: nearer, u turns too fast for any gear."""


def _turns_of(r: Array, far: float, near: float) -> Array | Refused:
    """The planet's turn w at points of these distances, rising from about 0, shape (n,), in the points' order.

    Refused where the distance does not fall once and rise once.
    """
    top, bottom, count = int(np.argmax(r)), int(np.argmin(r)), r.size
    order = (np.arange(count) + top) % count
    falls, back = r[order], (bottom - top) % count
    steps = np.diff(np.append(falls, falls[0]))
    wrong = np.concatenate([np.maximum(steps[:back], 0.0), np.maximum(-steps[back:], 0.0)])
    if wrong.any():
        where = order[int(np.argmax(wrong))]
        words = (
            f"the distance from the carrier's axis turns round near point {where + 1}: it may fall and rise once only"
        )
        return Refused(NOT_PASSED + float(wrong.sum()), words)
    middle, swing = (far**2 + near**2) / 2.0, (far**2 - near**2) / 2.0
    turned = np.arccos(np.clip((falls**2 - middle) / swing, -1.0, 1.0))
    turned[back + 1 :] = 2.0 * pi - turned[back + 1 :]
    # The farthest and the nearest point stand on the side on which their farther neighbour of the two lies.
    if falls[1] > falls[-1]:
        turned[0] = -turned[0]
    if falls[(back + 1) % count] < falls[back - 1]:
        turned[back] = turned[back]
    else:
        turned[back] = 2.0 * pi - turned[back]
    found = np.empty(count)
    found[order] = turned
    # Rising in the points' own order, from the first point on.
    found[:top] = found[:top] - 2.0 * pi
    return found


def _smoothest(path: WishedPath, r: Array, theta: Array, w: Array, carrier: float, arm: float) -> tuple[Array, Array]:
    """Start angle and waves of the smoothest u - w that keeps the points, shape (1 + 2 HARMONICS,).

    Also by how many tolerances each point is missed to first order, shape (n,).
    """
    link = _link_rad(w, carrier, arm)
    wanted = theta - link - w
    middle = wanted.mean()
    # Of n points the smoothest curve is a sum of n kernels: one matrix of (n, n), whatever the number of harmonics.
    columns = np.concatenate([np.full((w.size, 1), FREE), _waves(w, 0) / np.tile(ORDERS**3, 2)], axis=1)
    falling = -carrier * arm * np.sin(w) / r
    share = arm * (arm + carrier * np.cos(w)) / r**2
    rate = np.ones(w.size)
    for _ in range(ROUNDS):
        along = r * (rate - share)
        # An error of u moves the path along the circle about the axis; what counts is its part across the path.
        weight = r * np.maximum(np.abs(falling) / np.hypot(falling, along), ALONG) / path.tolerance_mm
        weighed, side = columns * weight[:, None], weight * (wanted - middle)
        values, vectors = np.linalg.eigh(weighed @ weighed.T)
        inner = (vectors.T @ side) / (np.maximum(values, 0.0) + SMOOTHING[:, None])
        missed = np.abs(SMOOTHING[:, None] * inner @ vectors.T)
        kept = min(int(np.argmax(np.append(missed.max(axis=1), 0.0) <= USED_TOLERANCE)), SMOOTHING.size - 1)
        found = weighed.T @ (vectors @ inner[kept])
        waves = found[1:] / np.tile(ORDERS**3, 2)
        rate = 1.0 + _waves(w, 1) @ waves
    return np.concatenate([[found[0] * FREE + middle], waves]), missed[kept]


ALONG = 0.05
"""Least weight of a point where the path runs along the circle about the axis: it may slip 20 tolerances along."""

FREE = 1000.0
"""How much less the constant term is held down than the first harmonic: not at all, to rounding."""


def _link_rad(w: Array, carrier: float, arm: float) -> Array:
    """arg(s + l exp(-i w)), continuous in w: it swings about 0 where s is longer, else it falls with w."""
    if carrier > arm:
        found: Array = np.angle(carrier + arm * np.exp(-1j * w))
    else:
        found = -w + np.angle(arm + carrier * np.exp(1j * w))
    return found


def missed_mm(motion: TipMotion, path: WishedPath) -> Array:
    """Distance of each point from the path, shape (n,)."""
    return distances_mm(path.points, motion.tip(np.linspace(0.0, 2.0 * pi, FINE + 1)))


def distances_mm(points: ComplexArray, places: ComplexArray) -> Array:
    """Distance of points, complex of shape (n,), from the chords through places of shape (m,); shape (n,)."""
    start, step = places[:-1], np.diff(places)
    from_start = points[:, None] - start
    share = np.clip((from_start * step.conj()).real / np.abs(step) ** 2, 0.0, 1.0)
    distance: Array = np.abs(from_start - share * step).min(axis=1)
    return distance


FINE = 2880
"""Chords of the path: of one 1 m long each is a third of a millimetre, a micrometre off an arc of 15 mm."""


def found_motion(path: WishedPath, limits: PathLimits, axis: complex | None) -> TipMotion:
    """The motion with the least burden among all axes, or about a given one.

    Raises NoSuchMechanism with where and why none is possible, key ``path``.
    """
    from scipy.optimize import minimize

    size = float(np.abs(path.points - path.points.mean()).max())

    def tried(values: Array, clockwise: bool) -> tuple[float, TipMotion | Refused]:
        place = axis if axis is not None else complex(values[2], values[3])
        outside = limits.outside(place)
        if outside:
            return 2.0 * NOT_PASSED + outside, Refused(outside, "its axis is outside axis_from_mm and axis_to_mm")
        beyond = size * np.exp(np.clip(values[:2], -9.0, 1.0))
        motion = motion_from(path, place, (float(beyond[0]), float(beyond[1])), clockwise=clockwise)
        if isinstance(motion, Refused):
            return motion.by, motion
        return burden(motion, limits) + _tool_missed(motion, path), motion

    starts: list[tuple[float, int, Array, bool]] = []
    for clockwise in (False, True):
        for place in [axis] if axis is not None else _places(path, size, limits):
            for beyond in BEYOND:
                values = np.array([np.log(beyond), np.log(beyond), place.real, place.imag])
                starts.append((tried(values, clockwise)[0], len(starts), values, clockwise))
    starts.sort(key=lambda one: one[:2])
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
    return _accepted(found, path, limits)


BEYOND = 0.01, 0.05
"""Shares of the path's size by which a path may begin to go beyond its points."""

SEARCHES = 5
"""Starts from which the axis is searched."""

PLACES = 13
"""Places to each side of a square on which axes are tried first."""

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
    """By how much the tool's angles are missed beyond their tolerance, in tolerances."""
    if len(path.tool_rad) < 2:
        return 0.0
    return max(tool_mount(motion, path)[1] / path.tool_tolerance_rad - 1.0, 0.0) * TOOL_WEIGHT


TOOL_WEIGHT = 5.0
"""How much a missed tolerance of the tool counts against the burden of the teeth."""


def tool_mount(motion: TipMotion, path: WishedPath) -> tuple[float, float]:
    """The angle of the tool against the arm with which its angles are missed least, and the most that one is missed."""
    errors = _tool_errors(motion, path)
    return float(errors.max() + errors.min()) / 2.0, float(errors.max() - errors.min()) / 2.0


def _tool_errors(motion: TipMotion, path: WishedPath) -> Array:
    """Angles of the tool that are wished for less those of the arm at the nearest places, rad, shape (k,)."""
    w, u = motion.turn
    places, sense = motion.tip_where(w, u), -1.0 if motion.clockwise else 1.0
    arm = sense * (u - w)
    found = []
    for number, angle in path.tool_rad:
        nearest = int(np.argmin(np.abs(places - path.points[number])))
        found.append(angle - arm[nearest])
    first = found[0]
    return np.array([first + np.angle(np.exp(1j * (one - first))) for one in found])


def _accepted(found: TipMotion | Refused, path: WishedPath, limits: PathLimits) -> TipMotion:
    """The motion, or a refusal with where and why and what helps."""
    helps = "another order of the points, more distance between them, a larger tolerance_mm, or leave axis_mm out"
    if isinstance(found, Refused):
        raise NoSuchMechanism(f"no carrier passes the points: {found.words}; {helps}", key="path.points_mm")
    ratio, w = found.hardness[0][0], found.hardness[1]
    if ratio.min() <= LEAST_RATIO:
        where = found.tip(w[[int(np.argmin(ratio))]])[0]
        near = int(np.argmin(np.abs(path.points - where))) + 1
        turned = "would have to turn back" if ratio.min() <= 0.0 else "all but stands"
        raise NoSuchMechanism(
            f"the carrier {turned} against the sun near point {near}, at {where.real:.4g}, {where.imag:.4g} mm, while "
            f"the planet turns on (du/dw = {ratio.min():.3g}), and no gears do that; {helps}",
            key="path.points_mm",
        )
    share, crowd = burden(found, limits), crowding(found, limits)
    if crowd > 1.0 and crowd >= share:
        raise NoSuchMechanism(
            f"{limits.arms} arms come nearer to each other than {limits.apart_mm:.4g} mm wherever the carrier's axis "
            "is; fewer arms, a smaller bar_width_mm, or another path is right",
            key="path.points_mm",
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
            key=f"path.points_mm.{number}",
        )
    return found


TOOL_ROUNDING = 1e-3
"""Share of the tool's tolerance that the search may leave."""

MOST_BURDEN = 1.6
"""Burden up to which teeth are tried: the limits are those at which nearly all curves can be made, not the last."""
