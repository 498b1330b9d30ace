"""A closed path of the tip of a planet's arm: the carrier, the arm and the ratio that make it.

With the carrier of length s at the angle u and the arm of length l at u - w, the tip is at

  axis + s exp(i u) + l exp(i (u - w)),        r^2 = s^2 + l^2 + 2 s l cos w,

where r is its distance from the carrier's axis.  The planet turns by w against the carrier, and gears exist where w and
u both grow all the way.  So r falls from s + l to its least, |s - l|, and rises again, once each in a cycle: the
farthest and the nearest place of the path from the axis give both lengths.  If the axis is inside the path, the carrier
is longer than the arm, else shorter.  The distance r of a place and its side of the path give w, and its direction
theta gives u = theta - arg(s + l exp(-i w)).  Only u(w) - w is free: a periodic function of w, here a Fourier series,
the smoothest that passes all points within their tolerances.  The ratio of the gears is du/dw.  The search varies the
axis, and the distance that the path goes beyond the points.

Source of the inverse: the two-link chain of any textbook; the conditions are its derivatives.
"""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import replace
from functools import cache, cached_property
from math import pi

import numpy as np

from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array, ComplexArray
from ncgear.ratio.laws.harmonic import harmonic_law, series_of
from ncgear.ratio.transmission import Lobes, Transmission

HARMONICS = 24
"""Harmonics of u - w: two for each of a dozen points; the smoothing leaves few of them large."""

ORDERS = np.arange(1.0, HARMONICS + 1.0)

GRID = 360
"""Angles w at which ratios are judged during the search; a harmonic of the highest order has 15 angles."""

USED_TOLERANCE = 0.8
"""Share of the tolerance that the smoothest curve may use; the rest is for nonlinear terms."""

STRAIGHT = 3
"""Points added on a straight stretch between its ends."""

ROUNDS = 3
"""Rounds that weigh anew how an error of u moves the path across itself."""

SMOOTHING = 10.0 ** np.arange(2.0, -9.0, -1.0)
"""Weights of the third derivative that are tried, the smoothest first."""


@dataclass(frozen=True, eq=False)
class WishedPath:
    """Points in mm, complex of shape (n,), in the order in which the tip passes them, with their tolerances in mm.

    ``tool_rad`` holds, for some points, the place among the points and the tool's angle there, ``tool_tolerance_rad``
    the tolerance of these angles.  ``named`` are the numbers by which messages name the points; empty: from 1 on.
    """

    points: ComplexArray
    tolerance_mm: Array
    tool_rad: tuple[tuple[int, float], ...] = ()
    tool_tolerance_rad: float = 0.0
    named: tuple[int, ...] = ()

    @property
    def mirrored(self) -> WishedPath:
        """The path seen from the other side."""
        tools = tuple((number, -angle) for number, angle in self.tool_rad)
        return replace(self, points=self.points.conj(), tool_rad=tools)

    def name(self, place: int) -> int:
        """The number of a point in messages."""
        return self.named[place] if self.named else place + 1

    def place(self, number: int) -> int:
        """The place among the points of a point by its number in messages, the first of that number."""
        return self.named.index(number) if self.named else number - 1

    def straightened(self, after: Collection[int]) -> WishedPath:
        """The path with STRAIGHT more points on the straight line from each point of ``after`` to the next one.

        They have the name of the point before them, and the smaller tolerance of both ends.
        """
        points, tolerances, named, at = list[complex](), list[float](), list[int](), list[int]()
        for place, point in enumerate(self.points):
            following = (place + 1) % self.points.size
            steps = STRAIGHT + 1 if place in after else 1
            at.append(len(points))
            points += [point + (self.points[following] - point) * step / steps for step in range(steps)]
            least = min(self.tolerance_mm[place], self.tolerance_mm[following])
            tolerances += [self.tolerance_mm[place], *[least] * (steps - 1)]
            named += [self.name(place)] * steps
        tools = tuple((at[place], angle) for place, angle in self.tool_rad)
        return WishedPath(np.array(points), np.array(tolerances), tools, self.tool_tolerance_rad, tuple(named))


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
        return self.axis + (there.conj() if self.clockwise else there)

    def ratio(self, count: int) -> tuple[Array, Array]:
        """Angles w that divide a turn evenly, and du/dw there, shape (count,) each."""
        w = np.linspace(0.0, 2.0 * pi, count, endpoint=False)
        return w, self.carrier_rad(w, 1)

    @cached_property
    def law(self) -> Transmission:
        """The planet's angle w by the carrier's u, both from the first place on."""
        series = series_of(np.log(self.ratio(FINE)[1]), FINE // 16)
        return harmonic_law(series.cosine, series.sine, Lobes())

    @cached_property
    def turn(self) -> tuple[Array, Array]:
        """Angles w from 0 to a turn, shape (GRID + 1,), and the carrier's angles u there."""
        w, waves = _on_grid()
        u = waves[0] @ self.waves + w + self.start_rad
        return np.append(w, 2.0 * pi), np.append(u, u[0] + 2.0 * pi)

    @cached_property
    def hardness(self) -> tuple[Array, Array]:
        """The ratio du/dw on GRID and the first two derivatives of its logarithm by w, shape (3, GRID), and w."""
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


@dataclass(frozen=True, eq=False)
class NoPath:
    """Why no motion passes the points from an axis, and by how much: a number that a search can lessen."""

    by: float
    words: str


def motion_from(
    path: WishedPath, axis: complex, beyond_mm: tuple[float, float], *, clockwise: bool
) -> TipMotion | NoPath:
    """The smoothest motion about an axis through all points, whose path goes ``beyond_mm`` beyond the outermost two."""
    seen = path.mirrored if clockwise else path
    arms = seen.points - (axis.conjugate() if clockwise else axis)
    r, theta = np.abs(arms), np.unwrap(np.angle(arms))
    far, near = r.max() + beyond_mm[0], r.min() - beyond_mm[1]
    if near <= NEAREST * far:
        return NoPath(float(NEAREST * far - near) + NOT_PASSED, "the path passes too near to the carrier's axis")
    w = _turns_of(path, r, far, near)
    if isinstance(w, NoPath):
        return w
    winding = round(float(theta[-1] - theta[0] + np.angle(arms[0] / arms[-1])) / (2.0 * pi))
    if winding not in (0, 1):
        return NoPath(NOT_PASSED, "the path turns about the carrier's axis against the carrier")
    carrier, arm = ((far + near) / 2.0, (far - near) / 2.0) if winding else ((far - near) / 2.0, (far + near) / 2.0)
    fitted, missed = _smoothest(seen, r, theta, w, carrier, arm)
    if missed.max() > 1.0:
        worst = path.name(int(np.argmax(missed)))
        return NoPath(
            UNEVEN + min(float(missed.max()), UNEVEN), f"no smooth path keeps point {worst} and its neighbours"
        )
    return TipMotion(axis, carrier, arm, fitted[0], fitted[1:], clockwise)


UNEVEN = 20.0
"""Burden of an axis if no series of HARMONICS waves about it keeps the points, and the most that is added to it."""

NOT_PASSED = 100.0
"""Burden of an axis if no motion about it passes the points."""

NEAREST = 0.02
"""Least distance of the path from the axis, as a share of the greatest: nearer, u turns too fast for any gear."""


def _turns_of(path: WishedPath, r: Array, far: float, near: float) -> Array | NoPath:
    """The planet's turn w at points of these distances, rising from about 0, shape (n,), in the points' order.

    Refused where the distance does not fall once and rise once.
    """
    top, bottom, count = int(np.argmax(r)), int(np.argmin(r)), r.size
    order = (np.arange(count) + top) % count
    falls, back = r[order], (bottom - top) % count
    steps = np.diff(np.append(falls, falls[0]))
    wrong = np.concatenate([np.maximum(steps[:back], 0.0), np.maximum(-steps[back:], 0.0)])
    if wrong.any():
        near = path.name(int(order[int(np.argmax(wrong))]))
        words = f"the distance from the carrier's axis turns round near point {near}: it may fall and rise once only"
        return NoPath(NOT_PASSED + float(wrong.sum()), words)
    middle, swing = (far**2 + near**2) / 2.0, (far**2 - near**2) / 2.0
    turned = np.arccos(np.clip((falls**2 - middle) / swing, -1.0, 1.0))
    turned[back + 1 :] = 2.0 * pi - turned[back + 1 :]
    # The farthest and the nearest point lie on the side of the neighbour whose distance differs more from theirs.
    if falls[1] > falls[-1]:
        turned[0] = -turned[0]
    if falls[(back + 1) % count] >= falls[back - 1]:
        turned[back] = 2.0 * pi - turned[back]
    found = np.empty(count)
    found[order] = turned
    # Angles rise in the points' own order, from the first point on.
    found[:top] = found[:top] - 2.0 * pi
    return found


def _smoothest(path: WishedPath, r: Array, theta: Array, w: Array, carrier: float, arm: float) -> tuple[Array, Array]:
    """Start angle and waves of the smoothest u - w that keeps the points, shape (1 + 2 HARMONICS,).

    Also the error of each point in tolerances, to first order, shape (n,).
    """
    link = _link_rad(w, carrier, arm)
    wanted = theta - link - w
    middle = wanted.mean()
    # For n points the smoothest curve is a sum of n kernels: one matrix of (n, n), whatever the number of harmonics.
    columns = np.concatenate([np.full((w.size, 1), FREE), _waves(w, 0) / np.tile(ORDERS**3, 2)], axis=1)
    falling = -carrier * arm * np.sin(w) / r
    share = arm * (arm + carrier * np.cos(w)) / r**2
    rate = np.ones(w.size)
    for _ in range(ROUNDS):
        along = r * (rate - share)
        # An error of u moves the path along the circle about the axis; only the part across the path counts.
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
"""Factor by which the constant term is held down less than the first harmonic: to rounding it is free."""


def _link_rad(w: Array, carrier: float, arm: float) -> Array:
    """arg(s + l exp(-i w)), continuous in w: it swings about 0 where s is longer, else falls with w."""
    if carrier > arm:
        return np.angle(carrier + arm * np.exp(-1j * w))
    return -w + np.angle(arm + carrier * np.exp(1j * w))


def missed_mm(motion: TipMotion, path: WishedPath) -> Array:
    """Distance of each point from the path, shape (n,)."""
    return distances_mm(path.points, motion.tip(np.linspace(0.0, 2.0 * pi, FINE + 1)))


def distances_mm(points: ComplexArray, places: ComplexArray) -> Array:
    """Distance of points, complex of shape (n,), from the chords through places of shape (m,); shape (n,)."""
    start, step = places[:-1], np.diff(places)
    from_start = points[:, None] - start
    share = np.clip((from_start * step.conj()).real / np.abs(step) ** 2, 0.0, 1.0)
    return np.abs(from_start - share * step).min(axis=1)


FINE = 2880
"""Chords of the path: for a path 1 m long each is a third of a millimetre, a micrometre off an arc of 15 mm."""
