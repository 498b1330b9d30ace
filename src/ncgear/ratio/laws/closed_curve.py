"""A closed curve about an axis in polar form, in stretches, for the pitch curve of a gear.

Each stretch is smooth and has its own parameter, which gives angle and radius with derivatives.  A gear needs the
radius by the angle: the angle must rise all the way, so that every ray from the axis meets the curve once.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cached_property
from itertools import pairwise
from math import degrees, tau

import numpy as np

from ncgear.errors import NoSuchMechanism
from ncgear.frozen import dataclass
from ncgear.numerics import chebyshev, jet
from ncgear.numerics.arrays import Array
from ncgear.numerics.chebyshev import PiecewiseChebyshev
from ncgear.numerics.extrema import Extremum, grid_between
from ncgear.numerics.extrema import extremes as extremes_between
from ncgear.numerics.jet import Jet
from ncgear.numerics.units import in_words
from ncgear.numerics.zeros import zeros_between

PolarFunction = Callable[[Array, int], tuple[Jet, Jet]]
"""Function of parameters, shape (n,), and an order: angle in rad and radius in mm with derivatives by the parameter."""

PointFunction = Callable[[Array, int], tuple[Jet, Jet]]
"""Function of parameters, shape (n,), and an order: x and y in mm from the axis with derivatives by the parameter."""

LEAST_SINE = 1e-3
"""Least sine of the angle between radius and curve: a curve nearer to the radius rolls on no mate."""

JOINED = 1e-6
"""Relative difference of radii, or share of the largest radius, that counts as rounding in a file: seven digits."""

SLIVER_RAD = 1e-9
"""Stretches of a smaller angle are left out: they are rounding errors where a curve is cut next to a joint."""

FINEST_TABLE = 40
"""Most halvings of a table whose angle turns by over a radian in a step: on a shorter stretch curves meet the axis."""


@dataclass(frozen=True, eq=False)
class SmoothPart:
    """A smooth part of a curve between two parameters; at inner parameters ``knots`` only a high derivative jumps."""

    start: float
    end: float
    polar: PolarFunction
    knots: tuple[float, ...] = ()

    @cached_property
    def breaks(self) -> Array:
        """Both ends and the knots."""
        return np.array([self.start, *self.knots, self.end])

    @cached_property
    def ends(self) -> tuple[tuple[float, float], tuple[float, float]]:
        """Angle in rad and radius in mm at the start and at the end."""
        angle, radius = (part.value.tolist() for part in self.polar(np.array([self.start, self.end]), 0))
        return (angle[0], radius[0]), (angle[1], radius[1])

    @cached_property
    def radius_range(self) -> tuple[Extremum, Extremum]:
        """Smallest and largest radius in mm, with the parameter."""
        return extremes_between(lambda at: self.polar(at, 1)[1], self.start, self.end, np.array(self.knots))

    def turned(self, by_rad: float) -> SmoothPart:
        """The stretch at angles that are greater by a constant."""

        def polar(at: Array, order: int) -> tuple[Jet, Jet]:
            angle, radius = self.polar(at, order)
            return angle + by_rad, radius

        return SmoothPart(self.start, self.end, polar, self.knots)

    def backwards(self, *, mirrored: bool = False) -> SmoothPart:
        """The stretch from its end to its start; with ``mirrored``, at negative angles."""
        side = -1.0 if mirrored else 1.0

        def polar(at: Array, order: int) -> tuple[Jet, Jet]:
            signs = np.where(np.arange(order + 1) % 2, -1.0, 1.0)[:, None]
            angle, radius = self.polar(-at, order)
            return Jet(side * angle.coefficients * signs), Jet(radius.coefficients * signs)

        return SmoothPart(-self.end, -self.start, polar, tuple(-knot for knot in reversed(self.knots)))

    def cut(self, low_rad: float, high_rad: float) -> SmoothPart | None:
        """The part between two angles; None for no part, or for a sliver."""
        start, end = self.ends[0][0], self.ends[1][0]
        if end - low_rad <= SLIVER_RAD or high_rad - start <= SLIVER_RAD:
            return None
        first = self.start if start >= low_rad - SLIVER_RAD else self._parameter(low_rad)
        last = self.end if end <= high_rad + SLIVER_RAD else self._parameter(high_rad)
        least = SLIVER_RAD * (self.end - self.start)
        return SmoothPart(
            first, last, self.polar, tuple(knot for knot in self.knots if first + least < knot < last - least)
        )

    def _parameter(self, angle_rad: float) -> float:
        ends = np.array([self.start]), np.array([self.end])
        return float(zeros_between(lambda at: self.polar(at, 0)[0].value - angle_rad, *ends)[0])


@dataclass(frozen=True, eq=False)
class Radius:
    """The radius by the angle on a stretch; its ends count as at these two angles in rad."""

    stretch: SmoothPart
    start_rad: float
    end_rad: float

    @cached_property
    def _parameter(self) -> PiecewiseChebyshev:
        """The stretch's parameter by the angle."""
        stretch = self.stretch
        grid = grid_between(stretch.start, stretch.end, np.array(stretch.knots))
        first = stretch.ends[0][0]

        def counted(parameter: Array) -> Array:
            """Angles from the start of this radius on."""
            return self.start_rad + (stretch.polar(parameter, 0)[0].value - first) / self._stretched

        angles = counted(grid)

        def parameter(angle_rad: Array) -> Array:
            place = np.clip(np.searchsorted(angles, angle_rad, side="right"), 1, grid.size - 1)
            ends = angles[place - 1] - angle_rad, angles[place] - angle_rad
            return zeros_between(lambda at: counted(at) - angle_rad, grid[place - 1], grid[place], ends)

        inner = counted(np.array(stretch.knots)) if stretch.knots else np.empty(0)
        return chebyshev.fitted(parameter, np.concatenate([[self.start_rad], inner, [self.end_rad]]))

    @property
    def _stretched(self) -> float:
        """The stretch's own angle over the angle that it counts as: 1 but for rounding errors."""
        (start, _), (end, _) = self.stretch.ends
        return (end - start) / (self.end_rad - self.start_rad)

    @property
    def breaks_rad(self) -> Array:
        """Angles between which the radius is smooth and resolved: both ends, knots, and panels of the parameter."""
        return self._parameter.breaks

    def at(self, angle_rad: Array, order: int) -> Jet:
        """The radius in mm with derivatives by the angle, at angles in rad of shape (n,)."""
        angle, radius = self.stretch.polar(self._parameter(angle_rad), order)
        if not order:
            return radius
        speed = self._stretched / angle.differentiated()
        return jet.by_other(radius.value, radius.differentiated() * speed, speed)


@dataclass(frozen=True, eq=False)
class ClosedCurve:
    """Consecutive stretches that come round the axis once, counter-clockwise.

    ``endless`` says that the only stretch goes on smoothly beyond its end as it began.
    """

    stretches: tuple[SmoothPart, ...]
    endless: bool = False

    @cached_property
    def radius_range_mm(self) -> tuple[float, float]:
        """Least and greatest radius."""
        lows, highs = zip(*(stretch.radius_range for stretch in self.stretches), strict=True)
        return min(low.value for low in lows), max(high.value for high in highs)

    def turned(self, by_rad: float) -> ClosedCurve:
        """The curve turned about its axis."""
        return ClosedCurve(tuple(stretch.turned(by_rad) for stretch in self.stretches), self.endless)

    def mirrored(self) -> ClosedCurve:
        """The curve mirrored at the ray of angle 0, again counter-clockwise."""
        return ClosedCurve(
            tuple(stretch.backwards(mirrored=True) for stretch in reversed(self.stretches)), self.endless
        )

    def radii(self, low_rad: float, high_rad: float) -> tuple[Radius, ...]:
        """The radius between two angles less than a turn apart, or a turn, on consecutive stretches."""
        turns = np.floor((low_rad - self.stretches[0].ends[0][0]) / tau)
        stretches = [stretch.turned((turns + more) * tau) for more in range(2) for stretch in self.stretches]
        if self.endless:
            stretches = [_over_two_turns(self.stretches[0]).turned(turns * tau)]
        parts = [part for part in (stretch.cut(low_rad, high_rad) for stretch in stretches) if part]
        edges = [low_rad, *(part.ends[0][0] for part in parts[1:]), high_rad]
        return tuple(Radius(part, a, b) for part, (a, b) in zip(parts, pairwise(edges), strict=True))

    def require_gear(self, key: str) -> None:
        """Refuse a curve that is not closed, meets its axis, or crosses a ray twice; raises NoSuchMechanism."""
        low, high = self.radius_range_mm
        if not low > JOINED * high:
            raise NoSuchMechanism(f"the pitch curve comes to {low:.4g} mm from its axis; it must go round it", key=key)
        for stretch in self.stretches:
            least, most = extremes_between(_sine(stretch), stretch.start, stretch.end, np.array(stretch.knots))
            if not (np.isfinite(most.value) and least.value > LEAST_SINE):
                angle = float(stretch.polar(np.array([least.at]), 0)[0].value[0])
                raise NoSuchMechanism(
                    f"the pitch curve {'turns back' if least.value < 0.0 else 'runs along the ray from its axis'} at "
                    f"the polar angle {in_words(angle % tau)}; every ray from the axis must cross it once, at over "
                    f"{degrees(LEAST_SINE):.2g} deg: move the axis, or smooth the curve there",
                    key=key,
                )
        ends = [stretch.ends for stretch in self.stretches]
        for (_, (angle, radius)), ((_, after), _) in zip(ends, [*ends[1:], ends[0]], strict=True):
            if abs(after - radius) > JOINED * high:
                raise NoSuchMechanism(
                    f"the radius of the pitch curve jumps at the polar angle {in_words(angle % tau)}, from "
                    f"{radius:.9g} to {after:.9g} mm; the curve must be closed",
                    key=key,
                )


def _over_two_turns(stretch: SmoothPart) -> SmoothPart:
    """An endless stretch with one more turn after its own."""
    length = stretch.end - stretch.start

    def polar(at: Array, order: int) -> tuple[Jet, Jet]:
        turns = np.floor((at - stretch.start) / length)
        angle, radius = stretch.polar(at - turns * length, order)
        return angle + tau * turns, radius

    once = (stretch.start, *stretch.knots)
    knots = (*once[1:], *(knot + length for knot in once)) if stretch.knots else ()
    return SmoothPart(stretch.start, stretch.end + length, polar, knots)


def _sine(stretch: SmoothPart) -> Callable[[Array], Jet]:
    """The sine of the angle from the radius to the curve, positive where the angle rises."""

    def sine(at: Array) -> Jet:
        angle, radius = stretch.polar(at, 2)
        around, along = angle.differentiated() * radius.truncated(1), radius.differentiated()
        return around / jet.sqrt(around * around + along * along)

    return sine


def drawn(points: Sequence[tuple[PointFunction, Sequence[float]]], key: str, *, endless: bool = False) -> ClosedCurve:
    """The curve of consecutive parts, each a function with its rising breaks; they may go round in either sense.

    Raises NoSuchMechanism for parts that do not come round the axis once.
    """
    stretches: list[SmoothPart] = []
    for point, breaks in points:
        edges = np.asarray(breaks, dtype=float)
        polar = _polar(point, edges, key)
        part = SmoothPart(float(edges[0]), float(edges[-1]), polar, tuple(edges[1:-1].tolist()))
        after = stretches[-1].ends[1][0] if stretches else part.ends[0][0]
        stretches.append(part.turned(tau * round((after - part.ends[0][0]) / tau)))
    turned = stretches[-1].ends[1][0] - stretches[0].ends[0][0]
    if round(turned / tau) not in (1, -1):
        times = abs(round(turned / tau))
        said = f"goes round its axis {times} times" if times else "does not go round its axis"
        raise NoSuchMechanism(f"the pitch curve {said}; once is right: move the axis, or mend the curve", key=key)
    curve = ClosedCurve(tuple(stretches), endless)
    # Mirrored and reversed, then mirrored again without reversing: only the sense in which it is run through changes.
    return (
        curve if turned > 0.0 else ClosedCurve(tuple(stretch.backwards() for stretch in reversed(stretches)), endless)
    )


def _polar(point: PointFunction, breaks: Array, key: str) -> PolarFunction:
    """Angle and radius of points; the angle counts on over whole turns, by a table, finer where it turns fast."""
    shares = np.arange(16) / 16
    grid = np.append((breaks[:-1, None] + np.diff(breaks)[:, None] * shares).ravel(), breaks[-1])
    for _ in range(FINEST_TABLE):
        x, y = (part.value for part in point(grid, 0))
        if not (np.isfinite(x).all() and np.isfinite(y).all()) or np.min(np.hypot(x, y)) == 0.0:
            break
        table = np.unwrap(np.arctan2(y, x))
        fast = np.flatnonzero(np.abs(np.diff(table)) > 1.0)
        if not fast.size:
            return _counted(point, grid, table)
        grid = np.insert(grid, fast + 1, (grid[fast] + grid[fast + 1]) / 2.0)
    raise NoSuchMechanism("the pitch curve meets its axis; it must go round it", key=key)


def _counted(point: PointFunction, grid: Array, table: Array) -> PolarFunction:
    def polar(at: Array, order: int) -> tuple[Jet, Jet]:
        x, y = point(at, order)
        square = x * x + y * y
        angle = np.arctan2(y.value, x.value)
        angle = angle + tau * np.round((np.interp(at, grid, table) - angle) / tau)
        if not order:
            return Jet(angle[None, :]), jet.sqrt(square)
        short = order - 1
        around = x.truncated(short) * y.differentiated() - y.truncated(short) * x.differentiated()
        return (around / square.truncated(short)).integrated(angle), jet.sqrt(square)

    return polar


def by_angle(
    parts: Sequence[tuple[Callable[[Array, int], Jet], Sequence[float]]], *, endless: bool = False
) -> ClosedCurve:
    """The curve whose radius in mm is given by the angle, each part with its rising breaks in rad, 2 pi in all."""

    def stretch(radius: Callable[[Array, int], Jet], breaks: Sequence[float]) -> SmoothPart:
        edges = [float(edge) for edge in breaks]
        return SmoothPart(
            edges[0], edges[-1], lambda at, order: (Jet.variable(at, order), radius(at, order)), tuple(edges[1:-1])
        )

    return ClosedCurve(tuple(stretch(*part) for part in parts), endless)
