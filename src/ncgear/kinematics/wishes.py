"""What a person wishes of the output's motion, as values, and what each wish asks of a law.

A wish speaks of places in mm and of the driving angle.  What it asks is one of four requirements on stretches of the
crank angle phi2, with s = dphi2/dphi1, w the driving speed and x(phi2) the displacement:

- ``SpeedWithin``: the speed w |x'| s lies between two bounds on a stretch;
- ``EvenSpeed``: the greatest speed on a stretch is at most so many times the least, whatever the speed is;
- ``DecelerationWithin``: the speed falls by at most so much in a second on a stretch;
- ``TimeWithin``: the driving angle that a stretch takes, the integral of dphi2/s, lies between two bounds.

In q = s^2 the speed is the root of a linear function, so that bounds on its square are linear, and ``EvenSpeed`` is
linear in q and the square of its free speed.  The deceleration is minus the slope of half the squared speed, w^2 x'^2
q/2, along the way, and so linear in q and q'.  The driving angle is convex in q: an upper bound of it is convex, and a
lower bound is an upper bound of the rest of the cycle, whose driving angle is fixed.  Programmes that look for laws and
those that bound them take the requirements; ``kinematics.outcomes`` judges a motion by the wishes themselves.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import field, replace
from enum import Enum
from itertools import pairwise
from math import inf, pi
from typing import ClassVar, NamedTuple, Self

import numpy as np

from ncgear.frozen import dataclass
from ncgear.mechanisms.mechanism import SLIDER, Mechanism, Output

NEGLIGIBLE = 1e-6
"""Share of a wished bound, and angle in rad, by which a wish that counts as kept may be missed: files hold the numbers
of a law to some ten digits."""


class Stroke(Enum):
    """The way from the retracted to the extended dead centre, or the way back."""

    WORKING = "working"
    RETURN = "return"


class End(Enum):
    """A dead centre."""

    RETRACTED = "retracted"
    EXTENDED = "extended"


class CrankStretch(NamedTuple):
    """Crank angles in rad from ``start_rad`` to ``end_rad``, rising; a start under 0 lies in the turn before."""

    start_rad: float
    end_rad: float

    @property
    def rest(self) -> CrankStretch:
        """The rest of the turn."""
        return CrankStretch(self.end_rad, self.start_rad + 2.0 * pi)


@dataclass(frozen=True)
class SpeedWithin:
    """The output's speed in mm/s, never negative, stays between two bounds on a stretch, which may be one place."""

    stretch: CrankStretch
    least_mm_s: float = 0.0
    most_mm_s: float = inf


@dataclass(frozen=True)
class EvenSpeed:
    """The greatest speed on a stretch is at most ``spread`` times the least."""

    stretch: CrankStretch
    spread: float


@dataclass(frozen=True)
class DecelerationWithin:
    """The output's speed, never negative, falls by at most ``most_mm_s2`` in a second on a stretch.

    At a dead centre the deceleration counts by which the output comes to it, where the stretch lies before it.
    """

    stretch: CrankStretch
    most_mm_s2: float


@dataclass(frozen=True)
class TimeWithin:
    """The driving angle in rad that a stretch takes stays between two bounds."""

    stretch: CrankStretch
    least_rad: float = 0.0
    most_rad: float = inf


Requirement = SpeedWithin | EvenSpeed | DecelerationWithin | TimeWithin


@dataclass(frozen=True, kw_only=True)
class Wish(ABC):
    """A wish: ``key`` is its dotted key in a design file, ``weight`` is None for a hard wish.

    ``output`` is what moves: where it turns, places are in rad and speeds in rad/s in place of mm and mm/s.

    A soft wish that is missed by p percent, of the speed or of the cycle's driving angle, counts in the goal of an
    optimised law like ``weight`` times p percent of what is to be least.
    """

    LIST: ClassVar[str] = ""
    """The key of its kind under ``wishes``."""

    key: str = ""
    weight: float | None = None
    output: Output = SLIDER

    @property
    def hard(self) -> bool:
        """Whether the wish must be kept."""
        return self.weight is None

    @abstractmethod
    def requirements(self, linkage: Mechanism, cycle_rad: float) -> tuple[Requirement, ...]:
        """What the wish asks on a mechanism whose cycle takes a driving angle of ``cycle_rad``."""


@dataclass(frozen=True, kw_only=True)
class ConstantSpeed(Wish):
    """The speed stays within the share ``tolerance`` of one value between two places; None: of whatever value."""

    LIST: ClassVar[str] = "constant_speed"

    from_mm: float
    to_mm: float
    tolerance: float
    stroke: Stroke = Stroke.WORKING
    speed_mm_s: float | None = None

    def stretch(self, linkage: Mechanism) -> CrankStretch:
        """The crank angles between both places."""
        ends = sorted(crank_angle_rad(linkage, place, self.stroke) for place in (self.from_mm, self.to_mm))
        return CrankStretch(*ends)

    def requirements(self, linkage: Mechanism, cycle_rad: float) -> tuple[Requirement, ...]:
        """One speed's band, or the spread of whatever speed it is."""
        stretch = self.stretch(linkage)
        if self.speed_mm_s is None:
            return (EvenSpeed(stretch, spread(self.tolerance)),)
        least, most = ((1.0 + share) * self.speed_mm_s for share in (-self.tolerance, self.tolerance))
        return (SpeedWithin(stretch, least, most),)


@dataclass(frozen=True, kw_only=True)
class SpeedAt(Wish):
    """Bounds of the speed at one place."""

    LIST: ClassVar[str] = "speed_at"

    at_mm: float
    stroke: Stroke = Stroke.WORKING
    least_mm_s: float = 0.0
    most_mm_s: float = inf

    def requirements(self, linkage: Mechanism, cycle_rad: float) -> tuple[Requirement, ...]:
        """Both bounds of the speed at the place."""
        return (SpeedWithin(place_of(linkage, self.at_mm, self.stroke), self.least_mm_s, self.most_mm_s),)


@dataclass(frozen=True, kw_only=True)
class ExtremeSpeed(Wish):
    """The speed at one place as low, or as high, as the goal's other parts let it be: always soft.

    It asks for no bound.  p percent of speed, to the wrong side, count as p percent by which a soft wish is missed.
    """

    LIST: ClassVar[str] = "speed_at"

    at_mm: float
    stroke: Stroke = Stroke.WORKING
    fastest: bool = False
    weight: float | None = field(default=1.0)

    def place(self, linkage: Mechanism) -> CrankStretch:
        """The crank angle of the place, as a stretch without length."""
        return place_of(linkage, self.at_mm, self.stroke)

    def requirements(self, linkage: Mechanism, cycle_rad: float) -> tuple[Requirement, ...]:
        """Nothing that must be kept."""
        return ()


class DrivingRange(NamedTuple):
    """Driving angles from ``start_rad`` to ``end_rad``; a start under 0 lies in the cycle before.

    A bound over them is held over ``crank``, crank angles that the law must not pass before or after that range.
    """

    start_rad: float
    end_rad: float
    crank: CrankStretch


def passed_no_later(crank_rad: float, driving_rad: float) -> list[TimeWithin]:
    """What laws keep that pass a crank angle at a driving angle or before it; both are 0 at the retracted end."""
    return _passed(crank_rad, driving_rad, most=driving_rad > 0.0)


def passed_no_earlier(crank_rad: float, driving_rad: float) -> list[TimeWithin]:
    """What laws keep that pass a crank angle at a driving angle or after it."""
    return _passed(crank_rad, driving_rad, most=driving_rad < 0.0)


def _passed(crank_rad: float, driving_rad: float, *, most: bool) -> list[TimeWithin]:
    way, time = CrankStretch(min(crank_rad, 0.0), max(crank_rad, 0.0)), abs(driving_rad)
    if not 0.0 < way.end_rad - way.start_rad < 2.0 * pi:
        return []
    return [TimeWithin(way, most_rad=time) if most else TimeWithin(way, least_rad=time)]


@dataclass(frozen=True, kw_only=True)
class GentleStretch(Wish, ABC):
    """A motion that is gentle between two places of one stroke, or of both (None), which then meet at an end.

    With a ``driving`` range it is gentle over that, wherever the output is then.
    """

    LIST: ClassVar[str] = "gentle_stop"

    from_mm: float = 0.0
    to_mm: float = inf
    stroke: Stroke | None = Stroke.WORKING
    driving: DrivingRange | None = None

    @abstractmethod
    def bound(self, stretch: CrankStretch) -> Requirement:
        """What is asked on the stretch."""

    def held_over(self, crank: CrankStretch) -> Self:
        """The wish with its driving range held over other crank angles."""
        return self if self.driving is None else replace(self, driving=self.driving._replace(crank=crank))

    def requirements(self, linkage: Mechanism, cycle_rad: float) -> tuple[Requirement, ...]:
        """The bound; of a driving range also that its crank angles begin no later, and end no earlier, than it does.

        Enough for the range, and of the laws that keep it those only that pass these crank angles so.
        """
        asked = self.bound(self.stretch(linkage))
        if self.driving is None:
            return (asked,)
        start, end, crank = self.driving
        return (asked, *passed_no_later(crank.start_rad, start), *passed_no_earlier(crank.end_rad, end))

    def stretch(self, linkage: Mechanism) -> CrankStretch:
        """The crank angles between both places; a turn where they are both ends, and both strokes are asked for."""
        if self.driving is not None:
            return self.driving.crank
        far, turn = linkage.working_angle_rad, 2.0 * pi
        whole, outer = self.from_mm <= 0.0, self.to_mm >= linkage.stroke_mm
        out = 0.0 if whole else crank_angle_rad(linkage, self.from_mm, Stroke.WORKING)
        home = turn if whole else crank_angle_rad(linkage, self.from_mm, Stroke.RETURN)
        before = far if outer else crank_angle_rad(linkage, self.to_mm, Stroke.WORKING)
        behind = far if outer else crank_angle_rad(linkage, self.to_mm, Stroke.RETURN)
        if self.stroke is None:
            return CrankStretch(out, home) if outer else CrankStretch(behind - turn, before)
        return CrankStretch(out, before) if self.stroke is Stroke.WORKING else CrankStretch(behind, home)


@dataclass(frozen=True, kw_only=True)
class GentleSpeed(GentleStretch):
    """The speed is at most so much on the stretch."""

    most_mm_s: float

    def bound(self, stretch: CrankStretch) -> Requirement:
        """The upper bound of the speed."""
        return SpeedWithin(stretch, most_mm_s=self.most_mm_s)


@dataclass(frozen=True, kw_only=True)
class GentleStop(GentleStretch):
    """The speed falls by at most so much in a second on the stretch."""

    most_mm_s2: float

    def bound(self, stretch: CrankStretch) -> Requirement:
        """The bound of the deceleration."""
        return DecelerationWithin(stretch, self.most_mm_s2)


@dataclass(frozen=True, kw_only=True)
class TimeRatio(Wish):
    """The working stroke takes at least so many times the time of the return."""

    LIST: ClassVar[str] = "time_ratio"

    at_least: float

    def requirements(self, linkage: Mechanism, cycle_rad: float) -> tuple[Requirement, ...]:
        """The time of the working stroke, since a cycle's is given."""
        working = CrankStretch(0.0, linkage.working_angle_rad)
        return (TimeWithin(working, least_rad=cycle_rad * self.at_least / (1.0 + self.at_least)),)


@dataclass(frozen=True, kw_only=True)
class WorkingStroke(Wish):
    """The working stroke takes a driving angle, give or take a tolerance."""

    LIST: ClassVar[str] = "working_stroke"

    angle_rad: float
    tolerance_rad: float = 0.0

    def requirements(self, linkage: Mechanism, cycle_rad: float) -> tuple[Requirement, ...]:
        """The driving angle of the working stroke."""
        working = CrankStretch(0.0, linkage.working_angle_rad)
        return (TimeWithin(working, self.angle_rad - self.tolerance_rad, self.angle_rad + self.tolerance_rad),)


@dataclass(frozen=True, kw_only=True)
class Dwell(Wish):
    """The displacement stays within so much of an end for a driving angle: a near-dwell."""

    LIST: ClassVar[str] = "dwell"

    end: End
    within_mm: float
    for_rad: float

    def requirements(self, linkage: Mechanism, cycle_rad: float) -> tuple[Requirement, ...]:
        """The time of the stretch about the dead centre."""
        return (TimeWithin(about_end(linkage, self.end, self.within_mm), least_rad=self.for_rad),)


@dataclass(frozen=True, kw_only=True)
class Position(Wish):
    """The output passes a place at a driving angle, give or take a tolerance of the place."""

    LIST: ClassVar[str] = "positions"

    at_mm: float
    phi1_rad: float
    tolerance_mm: float
    stroke: Stroke = Stroke.WORKING

    def way_mm(self, linkage: Mechanism) -> float:
        """The way from the retracted end to the place: on the return, the stroke and what is gone back of it."""
        return self.at_mm if self.stroke is Stroke.WORKING else 2.0 * linkage.stroke_mm - self.at_mm

    def requirements(self, linkage: Mechanism, cycle_rad: float) -> tuple[Requirement, ...]:
        """The way is under the place's far bound at the angle, and over its near one."""
        way, most = self.way_mm(linkage), 2.0 * linkage.stroke_mm
        before, after = (way + side * self.tolerance_mm for side in (-1.0, 1.0))
        asked: list[Requirement] = []
        if before > 0.0:
            asked.append(TimeWithin(CrankStretch(0.0, crank_at_way_rad(linkage, before)), most_rad=self.phi1_rad))
        if after < most:
            asked.append(TimeWithin(CrankStretch(0.0, crank_at_way_rad(linkage, after)), least_rad=self.phi1_rad))
        return tuple(asked)


def spread(tolerance: float) -> float:
    """Greatest speed over least of a motion that stays within the share ``tolerance`` of one speed."""
    return (1.0 + tolerance) / (1.0 - tolerance)


def crank_angle_rad(linkage: Mechanism, place_mm: float, stroke: Stroke) -> float:
    """Crank angle, 0 to 2 pi, at which the output passes a place of the stroke."""
    returning = np.array([stroke is Stroke.RETURN])
    return float(linkage.crank_angle(np.array([place_mm], dtype=float), returning)[0])


def crank_at_way_rad(linkage: Mechanism, way_mm: float) -> float:
    """Crank angle at which the output has gone a way of 0 to 2 strokes from the retracted end."""
    if way_mm <= linkage.stroke_mm:
        return crank_angle_rad(linkage, way_mm, Stroke.WORKING)
    return crank_angle_rad(linkage, 2.0 * linkage.stroke_mm - way_mm, Stroke.RETURN)


def place_of(linkage: Mechanism, at_mm: float, stroke: Stroke) -> CrankStretch:
    """The crank angle of a place, as a stretch without length."""
    angle = crank_angle_rad(linkage, at_mm, stroke)
    return CrankStretch(angle, angle)


def by_stroke(linkage: Mechanism, stretch: CrankStretch) -> list[tuple[CrankStretch, Stroke]]:
    """The parts of a stretch in each stroke, in order, with angles from 0 to 2 pi."""
    turn = 2.0 * pi
    dead = [angle + whole for whole in (-turn, 0.0, turn) for angle in (0.0, linkage.working_angle_rad)]
    edges = [stretch.start_rad, *(angle for angle in dead if stretch.start_rad < angle < stretch.end_rad)]
    found = []
    for start, end in pairwise([*edges, stretch.end_rad]):
        whole, middle = divmod((start + end) / 2.0, turn)
        working = middle < linkage.working_angle_rad
        found.append(
            (CrankStretch(start - turn * whole, end - turn * whole), Stroke.WORKING if working else Stroke.RETURN)
        )
    return found


def about_end(linkage: Mechanism, end: End, within_mm: float) -> CrankStretch:
    """The crank angles about a dead centre at which the displacement is within so much of it."""
    if end is End.EXTENDED:
        place = linkage.stroke_mm - within_mm
        return CrankStretch(*(crank_angle_rad(linkage, place, stroke) for stroke in Stroke))
    back, out = (crank_angle_rad(linkage, within_mm, stroke) for stroke in (Stroke.RETURN, Stroke.WORKING))
    return CrankStretch(back - 2.0 * pi, out)


def nearest_dwell_mm(linkage: Mechanism, end: End, for_rad: float, ratio_max: float) -> float:
    """The least distance from an end within which the output can stay for a driving angle, in mm.

    i12 is at most ``ratio_max``, so that the crank turns by for_rad / ratio_max at least; about a dead centre at which
    x'' = d2x/dphi2^2 that takes the output nearly |x''| (for_rad / ratio_max)^2 / 8 away.  What is returned is exact:
    the distance that is reached on both sides of the dead centre.  It is the whole stroke where the crank must turn all
    round.
    """
    crank_rad = for_rad / ratio_max
    low, high = 0.0, 1.0
    # The square root of the distance grows evenly with the angle, and bisection halves its error in each step.
    for _ in range(60):
        middle = (low + high) / 2.0
        stretch = about_end(linkage, end, linkage.stroke_mm * middle**2)
        low, high = (middle, high) if stretch.end_rad - stretch.start_rad < crank_rad else (low, middle)
    return linkage.stroke_mm * high**2
