"""The demands of the certified limit on a motion: limits that have a convex form or a relaxed form."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import field, replace
from math import atan, inf
from typing import TypeVar

from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array
from ncgear.wishes.requirements import DecelerationWithin, EvenSpeed, Requirement, SpeedWithin, TimeWithin
from ncgear.wishes.wish import Offer

KINDS = (TimeWithin, EvenSpeed, SpeedWithin, DecelerationWithin)
"""Requirements in the order in which they count."""


@dataclass(frozen=True)
class WishDemand:
    """The requirement of a wish on every motion; a time has only an upper bound, the rest of the turn the lower.

    ``key`` is the key of the wish in the design file; a stretch may go on over the end of the turn.  ``shown`` gives
    the value to ask for instead, in words of the wish, from the value that ``eased`` takes.  Where a stretch must be
    short so that the rest of the turn, a dwell, can be long, ``instead`` gives the value kept at the greatest ratio.
    """

    key: str
    asked: Requirement
    shown: Callable[[float], Offer] = field(default=lambda value: Offer(f"{value:.5g}"), compare=False)
    instead: tuple[Offer, ...] = ()

    def eased(self, value: float) -> WishDemand:
        """The demand for another time in rad or spread, for a range of speeds wider by a factor, for a deceleration."""
        match self.asked:
            case TimeWithin():
                return replace(self, asked=replace(self.asked, most_rad=value))
            case EvenSpeed():
                return replace(self, asked=replace(self.asked, spread=value))
            case SpeedWithin(_, least, most):
                return replace(self, asked=replace(self.asked, least_mm_s=least / value, most_mm_s=most * value))
            case DecelerationWithin(_, most):
                return replace(self, asked=replace(self.asked, most_mm_s2=most * value))


Asked = TypeVar("Asked", TimeWithin, EvenSpeed, SpeedWithin, DecelerationWithin)


@dataclass(frozen=True)
class Demands:
    """Limits; infinity means no limit.

    ``steepness`` bounds |s'|/(1 + s) with s = dphi2/dphi1, the prime by phi2: the tangent of the pitch curves against
    their common perpendicular, without the rack's own angle, which messages add.  ``convex`` asks both pitch curves to
    be convex.  Powers are the motor's, with every mass that the task has.  ``fluctuation_n_mm`` bounds the swing of the
    energy that the driving shaft gives and takes beside its mean, ``torque_n_mm`` the root mean square of its torque.
    ``flank_load_n_mm`` is the flank load of ``task``; ``flywheel_kg_mm2`` is the least and the greatest inertia that a
    motion may have in addition to the crank's.
    """

    ratio_min: float
    ratio_max: float
    steepness: float = inf
    rack_angle_rad: float = 0.0
    convex: bool = False
    acceleration_mm_s2: float = inf
    speed_mm_s: float = inf
    power_w: float = inf
    braking_w: float = inf
    fluctuation_n_mm: float = inf
    torque_n_mm: float = inf
    flank_load_n_mm: float = inf
    flywheel_kg_mm2: tuple[float, float] = (0.0, 0.0)
    wishes: tuple[WishDemand, ...] = ()

    @property
    def tangent_rad(self) -> float:
        """The angle whose tangent is the steepness."""
        return atan(self.steepness)

    @property
    def places_rad(self) -> tuple[float, ...]:
        """Crank angles that should be places of the grid."""
        return tuple(angle for wish in self.in_order for angle in wish.asked.stretch)

    @property
    def in_order(self) -> list[WishDemand]:
        """The requirements of wishes, kind by kind."""
        return sorted(self.wishes, key=lambda wish: KINDS.index(type(wish.asked)))

    def requirements(self, kind: type[Asked]) -> list[Asked]:
        """The requirements of one kind."""
        return [wish.asked for wish in self.wishes if isinstance(wish.asked, kind)]


PEAKS = {
    "power_w": ("peak_power_w", "W"),
    "acceleration_mm_s2": ("peak_acceleration_mm_s2", "mm/s^2"),
    "speed_mm_s": ("peak_speed_mm_s", "mm/s"),
    "braking_w": ("braking_power_w", "W of braking power"),
    "torque_n_mm": ("rms_torque_n_m", "N m of r.m.s. torque"),
    "fluctuation_n_mm": ("flywheel_kg_mm2", "kg mm^2 of flywheel"),
}
"""Demands that can be given too low: the name of the limit and its unit in a design file, of an output that slides."""


@dataclass(frozen=True)
class Priced:
    """A figure in a weighted sum, by its name in ``Demands``, with the range of the search."""

    name: str
    least: float
    most: float


@dataclass(frozen=True, eq=False)
class Ranges:
    """Ranges of q = s^2 that all wanted motions keep: at the places and everywhere in the cells, shape (n,) each.

    The range is zero to infinity where nothing is known.
    """

    least: Array
    most: Array
    least_in_cell: Array
    most_in_cell: Array


@dataclass(frozen=True, eq=False)
class NearMotion:
    """A motion near which others are looked for: q at the places and the mean of q'/q in the cells, shape (n,)."""

    q: Array
    rate: Array
