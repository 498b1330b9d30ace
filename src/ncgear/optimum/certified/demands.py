"""What the certified limit demands of a motion: limits that have a convex form, or a relaxed one."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import field, replace
from math import atan, inf

from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array
from ncgear.optimum.offers import Offer


@dataclass(frozen=True)
class StretchTime:
    """The driving gear turns at most ``at_most_rad`` while the crank turns from one angle to another.

    ``key`` is the wish's in the design file; a stretch may go on over the end of the turn.  ``shown`` says in words of
    the wish what would have to be asked for instead, for another ``at_most_rad``.  Where a stretch must be short so
    that the rest of the turn, a dwell, can be long, ``instead`` says what would do at the greatest ratio.
    """

    key: str
    start_rad: float
    end_rad: float
    at_most_rad: float
    shown: Callable[[float], Offer] = field(default=lambda angle_rad: Offer(f"{angle_rad:.5g} rad"), compare=False)
    instead: tuple[Offer, ...] = ()


@dataclass(frozen=True)
class SpeedSpread:
    """The slider's greatest speed in a stretch of crank angles is at most ``spread`` times the least.

    ``shown`` says in words of the wish what would have to be asked for instead, for another spread.
    """

    key: str
    start_rad: float
    end_rad: float
    spread: float
    shown: Callable[[float], Offer] = field(default=lambda spread: Offer(f"a spread of {spread:.5g}"), compare=False)


@dataclass(frozen=True)
class SpeedRange:
    """The slider's speed lies in a range in a stretch of crank angles, which may be one angle.

    ``shown`` says in words of the wish what would have to be asked for instead, for a range that is wider by a factor:
    so many times the greatest speed, and the least divided by it.
    """

    key: str
    start_rad: float
    end_rad: float
    least_mm_s: float = 0.0
    most_mm_s: float = inf
    shown: Callable[[float], Offer] = field(
        default=lambda factor: Offer(f"a range {factor:.5g} times as wide"), compare=False
    )

    def wider(self, factor: float) -> SpeedRange:
        """The range that is wider by a factor."""
        return replace(self, least_mm_s=self.least_mm_s / factor, most_mm_s=self.most_mm_s * factor)


@dataclass(frozen=True)
class GreatestDeceleration:
    """The slider's speed falls by at most ``most_mm_s2`` in a second in a stretch of crank angles.

    ``shown`` says in words of the wish what would have to be asked for instead, for so many times that.
    """

    key: str
    start_rad: float
    end_rad: float
    most_mm_s2: float
    shown: Callable[[float], Offer] = field(
        default=lambda factor: Offer(f"{factor:.5g} times the deceleration"), compare=False
    )

    def wider(self, factor: float) -> GreatestDeceleration:
        """The demand for so many times the deceleration."""
        return replace(self, most_mm_s2=self.most_mm_s2 * factor)


OfWish = StretchTime | SpeedSpread | SpeedRange | GreatestDeceleration
"""A demand that a wish of the motion asks for."""


@dataclass(frozen=True)
class Demands:
    """Limits; infinite ones are free.

    ``steepness`` bounds |s'|/(1 + s) with s = dphi2/dphi1, the prime by phi2: the tangent of the pitch curves against
    their common perpendicular, without the rack's own angle, which messages add.  ``convex`` asks both pitch curves to
    be convex.  Powers are those of the motor, with every mass that the task has.  ``fluctuation_n_mm`` bounds the swing
    of the energy that the driving shaft gives and takes beside its mean, ``torque_n_mm`` the root mean square of its
    torque.
    """

    ratio_min: float
    ratio_max: float
    steepness: float = inf
    rack_angle_rad: float = 0.0
    convex: bool = False
    acceleration_mm_s2: float = inf
    power_w: float = inf
    braking_w: float = inf
    fluctuation_n_mm: float = inf
    torque_n_mm: float = inf
    times: tuple[StretchTime, ...] = ()
    even_speeds: tuple[SpeedSpread, ...] = ()
    speeds: tuple[SpeedRange, ...] = ()
    decelerations: tuple[GreatestDeceleration, ...] = ()

    @property
    def tangent_rad(self) -> float:
        """The angle whose tangent is the steepness."""
        return atan(self.steepness)

    @property
    def places_rad(self) -> tuple[float, ...]:
        """Crank angles that should be places of the grid."""
        stretches: tuple[OfWish, ...] = (*self.times, *self.even_speeds, *self.speeds, *self.decelerations)
        return tuple(angle for one in stretches for angle in (one.start_rad, one.end_rad))


@dataclass(frozen=True)
class Priced:
    """A figure in a weighted sum, by its name in ``Demands``: the range that it is looked for in."""

    name: str
    least: float
    most: float


@dataclass(frozen=True, eq=False)
class Ranges:
    """Ranges of q = s^2 that all wanted motions keep: at the places and everywhere in the cells, shape (n,) each.

    Where nothing is known, the least is zero and the most infinite.
    """

    least: Array
    most: Array
    least_in_cell: Array
    most_in_cell: Array


@dataclass(frozen=True, eq=False)
class Near:
    """A motion near which others are looked for: q at the places and the mean of q'/q in the cells, shape (n,)."""

    q: Array
    rate: Array
