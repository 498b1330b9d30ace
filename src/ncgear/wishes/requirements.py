"""Requirements of wishes on a law: on stretches of the crank angle phi2, and on speeds that are pushed.

With s = dphi2/dphi1, w the driving speed and x(phi2) the displacement:

- ``SpeedWithin``: the speed w |x'| s lies between two bounds on a stretch;
- ``EvenSpeed``: the greatest speed on a stretch is at most a factor times the least, at any speed;
- ``DecelerationWithin``: the speed falls by at most a bound in a second on a stretch;
- ``TimeWithin``: the driving angle that a stretch takes, the integral of dphi2/s, lies between two bounds.

In q = s^2 the speed is the root of a linear function, so bounds on its square are linear, and ``EvenSpeed`` is linear
in q and the square of its free speed.  The deceleration is minus the slope of half the squared speed, w^2 x'^2 q/2,
along the way, and so linear in q and q'.  The driving angle is convex in q: an upper bound of it is convex, and a lower
bound is an upper bound of the rest of the cycle, whose driving angle is fixed.  Programmes that find laws, and
programmes that bound them, take the requirements; the wishes themselves judge a motion.
"""

from __future__ import annotations

from math import inf, pi
from typing import NamedTuple

from ncgear.frozen import dataclass
from ncgear.kinematics.crank_stretches import CrankStretch


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

    At a dead centre the output's approach counts, where the stretch lies before it.
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


class PushedSpeed(NamedTuple):
    """A speed at one place, a stretch without length, that shall be as low, or as high, as other wishes allow."""

    stretch: CrankStretch
    fastest: bool


class DrivingRange(NamedTuple):
    """Driving angles from ``start_rad`` to ``end_rad``; a start under 0 lies in the cycle before.

    A bound over them is held over the crank angles ``crank``, which must include all that the law passes in the range.
    """

    start_rad: float
    end_rad: float
    crank: CrankStretch


def passed_no_later(crank_rad: float, driving_rad: float) -> list[TimeWithin]:
    """Requirements of laws that pass a crank angle at a driving angle or before it; both are 0 at the retracted end."""
    return _passed(crank_rad, driving_rad, most=driving_rad > 0.0)


def passed_no_earlier(crank_rad: float, driving_rad: float) -> list[TimeWithin]:
    """Requirements of laws that pass a crank angle at a driving angle or after it."""
    return _passed(crank_rad, driving_rad, most=driving_rad < 0.0)


def _passed(crank_rad: float, driving_rad: float, *, most: bool) -> list[TimeWithin]:
    way, time = CrankStretch(min(crank_rad, 0.0), max(crank_rad, 0.0)), abs(driving_rad)
    if not 0.0 < way.end_rad - way.start_rad < 2.0 * pi:
        return []
    return [TimeWithin(way, most_rad=time) if most else TimeWithin(way, least_rad=time)]
