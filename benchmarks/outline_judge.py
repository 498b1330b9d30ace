"""Judge of two gears' outlines, by itself: no contact code of any program that made them.

Both outlines are turned as the law says.  Flanks cut by a rack touch where the lines of action cross them: the lines
through the pitch point at the rack's pressure angle to the pitch curves' tangent.  The distance along that line from
the driving to the driven outline is the gap between the two flanks at their contact, measured along their normal;
below zero it is an overlap.  All pairs of flanks in mesh are looked at, front and back.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cached_property
from math import cos, inf, pi, sin

import numpy as np
from numpy.typing import NDArray
from shapely import Polygon

Array = NDArray[np.float64]

GOLDEN = (5.0**0.5 - 1.0) / 2.0
"""Multiples of this, taken modulo 1, fill a turn evenly without ever keeping step with teeth or chords."""

PER_PITCH, LEAST = 40, 401
"""Positions per tooth pitch, and in all at least."""

SEEN = 6.0
"""Half width, in modules along the pitch curve, of the window in which chords are looked for: two pitches."""

STEEP = 0.3
"""Cosine to the line of action below which a chord belongs to a flank: flanks stand square on it, lands at 20 deg."""

NEAR = 0.5
"""Gap in modules above which two flanks are not a pair; neighbouring pairs are 2.9 modules apart."""

SAME = 1e-9
"""Distance in modules at which two points count as one."""


@dataclass(frozen=True)
class Law:
    """A one-to-one law by the driving angle: the driven angle and its first and second derivatives."""

    driven: Callable[[Array], Array]
    slope: Callable[[Array], Array]
    bend: Callable[[Array], Array]

    def unit_radius(self, phi1: Array) -> tuple[Array, Array]:
        """Driving pitch radius at centre distance 1, and its derivative: r1 = q / (1 + q), q being the slope."""
        slope = self.slope(phi1)
        return slope / (1.0 + slope), self.bend(phi1) / (1.0 + slope) ** 2

    def center_distance_mm(self, teeth: int, module_mm: float) -> float:
        """From the pitch curve's length, teeth times pi times module; trapezoids are exact on a smooth full turn."""
        phi1 = np.linspace(0.0, 2.0 * pi, 4096, endpoint=False)
        return teeth * module_mm / (2.0 * float(np.mean(np.hypot(*self.unit_radius(phi1)))))


@dataclass(frozen=True)
class Outline:
    """What an outline is like by itself: turns of more than 90 degrees, repeated points, crossings."""

    points: int
    reversals: int
    repeated: int
    simple: bool


@dataclass(frozen=True)
class Flanks:
    """Largest gap and largest overlap of any pair of flanks in mesh, in modules, and how many pairs were looked at."""

    gap: float
    overlap: float
    pairs: int


def judged_outline(outline_mm: Array, module_mm: float) -> Outline:
    """One outline, shape (n, 2), first point not repeated."""
    after = np.roll(outline_mm, -1, axis=0) - outline_mm
    repeated = np.hypot(*after.T) <= SAME * module_mm
    kept = outline_mm[~repeated]
    step = np.roll(kept, -1, axis=0) - kept
    forwards = np.sum(step * np.roll(step, 1, axis=0), axis=1)
    return Outline(len(outline_mm), int(np.sum(forwards < 0.0)), int(repeated.sum()), Polygon(kept).is_valid)


def judged_flanks(driving_mm: Array, driven_mm: Array, law: Law, teeth: int, module_mm: float, angle: float) -> Flanks:
    """Both outlines in mm, in their own frames in the pose of phi1 = 0; they turn by +phi1 and by -phi2."""
    count = max(LEAST, PER_PITCH * teeth)
    phi1 = 2.0 * pi * np.mod(np.arange(count) * GOLDEN, 1.0)
    gaps = list(_gaps(driving_mm, driven_mm, law, phi1, law.center_distance_mm(teeth, module_mm), module_mm, angle))
    every = np.concatenate(gaps) / module_mm
    return Flanks(float(every.max()), max(0.0, -float(every.min())), every.size)


def _gaps(
    driving: Array, driven: Array, law: Law, phi1: Array, distance: float, module: float, angle: float
) -> Iterator[Array]:
    """Gaps of all pairs of flanks in mm, position by position and side by side; infinite where there is no pair."""
    first, second = _Turning(driving, 0.0, 0.0), _Turning(driven, pi, distance)
    unit, unit_slope = law.unit_radius(phi1)
    for one, two, r, slope in zip(phi1, law.driven(phi1), distance * unit, distance * unit_slope, strict=True):
        own, mate = first.near(one, SEEN * module / r), second.near(-two, SEEN * module / (distance - r))
        tangent = np.array([slope, -r]) / np.hypot(slope, r)
        normal = np.array([-tangent[1], tangent[0]])
        for side in (1.0, -1.0):
            line = _Line(np.array([r, 0.0]), side * cos(angle) * tangent + sin(angle) * normal, module / sin(angle))
            # Outlines run counter-clockwise: along the line, flanks of the driving gear are left and those of the
            # driven gear are entered.
            apart = (line.places(*mate, sense=-1.0)[None, :] - line.places(*own, sense=1.0)[:, None]).ravel()
            paired = apart[np.abs(apart) < NEAR * module]
            yield paired if paired.size else np.array([inf])


@dataclass(frozen=True)
class _Turning:
    """An outline that turns about an axis on the x axis; ``toward`` is the mate's direction as seen from there."""

    outline: Array
    toward: float
    axis: float

    @cached_property
    def _around(self) -> tuple[Array, NDArray[np.int64]]:
        """Polar angles in growing order, and whose they are; three turns, so that windows need not wrap."""
        angle = np.arctan2(self.outline[:, 1], self.outline[:, 0])
        order = np.argsort(angle)
        sorted_angle = angle[order]
        return np.concatenate([sorted_angle - 2.0 * pi, sorted_angle, sorted_angle + 2.0 * pi]), np.tile(order, 3)

    def near(self, turned: float, half_width: float) -> tuple[Array, Array]:
        """Starts and ends of the chords that begin within an angle of the line of centres, in the fixed frame."""
        angle, order = self._around
        middle = np.mod(self.toward - turned + pi, 2.0 * pi) - pi
        low, high = np.searchsorted(angle, [middle - half_width, middle + half_width])
        start = order[low:high]
        turn = np.array([[cos(turned), sin(turned)], [-sin(turned), cos(turned)]])
        shift = np.array([self.axis, 0.0])
        return self.outline[start] @ turn + shift, self.outline[(start + 1) % len(self.outline)] @ turn + shift


@dataclass(frozen=True)
class _Line:
    """A line of action: its origin, its unit direction, and how far from the origin flanks touch."""

    origin: Array
    direction: Array
    reach: float

    def places(self, start: Array, end: Array, *, sense: float) -> Array:
        """Where flanks among the chords cross the line, towards its left for ``sense`` +1."""
        across = np.array([-self.direction[1], self.direction[0]])
        low, high = (start - self.origin) @ across, (end - self.origin) @ across
        crossing = (low < 0.0) != (high < 0.0)
        start, step, low, high = start[crossing], (end - start)[crossing], low[crossing], high[crossing]
        place = (start - self.origin) @ self.direction + (step @ self.direction) * low / (low - high)
        steep = np.abs(step @ self.direction) < STEEP * np.hypot(*step.T)
        chosen: Array = place[steep & (np.sign(high - low) == sense) & (np.abs(place) <= self.reach)]
        return chosen


def sine_law(depth: float) -> Law:
    """phi2 = phi1 - depth sin 2 phi1."""
    return Law(
        lambda phi1: phi1 - depth * np.sin(2.0 * phi1),
        lambda phi1: 1.0 - 2.0 * depth * np.cos(2.0 * phi1),
        lambda phi1: 4.0 * depth * np.sin(2.0 * phi1),
    )
