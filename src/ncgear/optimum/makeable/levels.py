"""A level: a number that bounds a figure around the turn.  A limit caps it; a goal minimizes it.

A level bounds a figure of terms at places of the crank (``quantities.py``).  Its kind names the figure: the largest
value of the terms, their spread, their integral over the driving angle, or the swing of such an integral.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from enum import Enum
from math import inf, pi
from typing import Any

import numpy as np

from ncgear.dynamics.driving_shaft import KG_MM2
from ncgear.frozen import dataclass
from ncgear.kinematics.crank_stretches import CrankStretch
from ncgear.numerics.arrays import Array
from ncgear.numerics.bounds import shown_above
from ncgear.numerics.units import N_M_PER_N_MM
from ncgear.optimum.makeable import quantities
from ncgear.optimum.makeable.quantities import RatioPlace, Slider, Term, pairs, with_shaft_between
from ncgear.optimum.task import Limits, Prices, Task
from ncgear.wishes.wish import Offer

OF_LIMITS = "optimize.limits."
"""The group of keys of limits, with its dot."""


Sides = Callable[[RatioPlace, Slider, Term], tuple[Term, ...]]
"""Place, slider, and length of the driving curve over the centre distance, to the terms of a level."""


class LevelKind(Enum):
    """The figure of a level, from its terms at the places of its stretch; integrals are over the driving angle in rad.

    So the integral of the term 1.0 is the driving angle of a stretch, and a term's integral over the cycle, divided by
    the cycle's driving angle, is its mean over time.
    """

    PEAK = "peak"
    """The largest value of every term."""

    SPREAD = "spread"
    """The largest value of every term less its least value."""

    INTEGRAL = "integral"
    """Every term's integral over the stretch, less ``target``: at most the level.  Negative terms bound it below."""

    DEVIATION = "deviation"
    """Distance of every term's integral over the stretch from ``target``, to either side."""

    RMS = "rms"
    """The root of the mean square over the driving angle of every term less its harmonics up to ``order``."""

    SWING = "swing"
    """The largest less the least value of the running integral of every term less its mean, over the whole turn."""


TURN = CrankStretch(0.0, 2.0 * pi)


@dataclass(frozen=True)
class WishLevel:
    """A level: the ``wish`` behind it, its ``limit`` (None: no limit) and its ``weight`` in the goal.

    Terms and limit are in units in which they are of the order of 1; ``shown`` gives the limit that the user would need
    for a level that exceeds it.  ``of_pairs`` is true for a level of every pair of gears, false for a level of the
    whole machine.  ``widest`` is the largest limit that a file may ask for.  Integrals and swings are levels of the
    whole machine, since the integral of a pair's term would be over the driving angle of the whole train, too.

    ``group`` is the group of keys that the wish belongs to, with its dot.  Below ``floor`` a level costs no less.
    ``share_of_goal`` is the cost of a unit in shares of the least goal without such levels: soft wishes count like
    this.  ``order`` is for a root mean square over the driving angle ``cycle_rad``: None counts all harmonics and the
    mean, 0 all without the mean.
    """

    wish: str
    limit: float | None
    weight: float
    sides: Sides
    shown: Callable[[float], Offer]
    of_pairs: bool = False
    widest: float = inf
    kind: LevelKind = LevelKind.PEAK
    stretch: CrankStretch = TURN
    target: float = 0.0
    group: str = OF_LIMITS
    floor: float = -inf
    share_of_goal: float = 0.0
    order: int | None = None
    cycle_rad: float = 2.0 * pi

    @property
    def key(self) -> str:
        """The wish's dotted key in a design file."""
        return f"{self.group}{self.wish}"

    @property
    def least(self) -> float:
        """The least value that counts: the floor; a deviation to either side is never negative."""
        return max(self.floor, 0.0) if self.kind is LevelKind.DEVIATION else self.floor

    @property
    def cap(self) -> float:
        """The limit; infinite without a limit."""
        return inf if self.limit is None else self.limit

    def terms(self, ratios: Sequence[RatioPlace], slider: Slider, lengths: Sequence[Term]) -> tuple[Term, ...]:
        """The level's terms, from i12, and iB where there are two pairs, and every pair's length."""
        if not self.of_pairs:
            return self.sides(ratios[0], with_shaft_between(slider, ratios), lengths[0])
        return tuple(
            side for at, length in zip(pairs(ratios), lengths, strict=True) for side in self.sides(at, slider, length)
        )


def limit_offer(name: str, words: str, number: str) -> Offer:
    """The offer of a limit by its name under ``optimize.limits``; its number stands in the words for the braces."""
    return Offer(words.format(number), ((f"{OF_LIMITS}{name}", float(number)),))


def limited(
    name: str, words: str, number: Callable[[float], str], limit: float | None, weight: float, sides: Sides, **more: Any
) -> WishLevel:
    """The level of a limit by its name under ``optimize.limits``; ``number`` writes the user's limit for a level."""
    return WishLevel(name, limit, weight, sides, lambda level: limit_offer(name, words, number(level)), **more)


def of_figure(
    name: str, words: str, unit: float, limit: float | None, price: float, sides: Sides, **more: Any
) -> Iterator[WishLevel]:
    """The level of a figure, in units of the figure, where it has a limit or a price."""
    if limit is not None or price:
        cap = None if limit is None else limit / unit
        yield limited(name, words, lambda level: shown_above(level * unit), cap, price * unit, sides, **more)


# --- forces of a machine with its masses, in units of the order of the forces at a crank that turns evenly ----------

LEAST_N_MM, LEAST_N = 1.0, 1e-3
"""Least units of torque and force, for a machine that feels next to nothing."""

ROUND = 1e-4
"""Force, in its unit, that smooths the size of a force at zero; it adds 5e-9 to a peak of 1 unit."""


@dataclass(frozen=True)
class MachineScales:
    """Units of a machine's driving torque in N mm and of forces in N on bearings and frame."""

    torque_n_mm: float
    bearing_n: float
    shaking_n: float


def machine_scales(task: Task, slider: Slider) -> MachineScales:
    """Scales from the loads of an even crank; the columns of ``slider`` are at places around the turn, (n,) each."""
    even, turning_rad_s = RatioPlace(0.0, 1.0, 1.0, 0.0, 0.0), task.speed_rad_s * 2.0 * pi / task.cycle_rad

    def largest(term: Term) -> float:
        return float(np.max(np.abs(term)))

    def size(force: tuple[Array, Array]) -> float:
        return max(largest(np.hypot(*force)), LEAST_N)

    return MachineScales(
        max(largest(quantities.driving_torque(even, slider, turning_rad_s)), LEAST_N_MM),
        size(quantities.bearing_force(even, slider, turning_rad_s)),
        size(quantities.shaking_force(even, slider, turning_rad_s)),
    )


def of_loads(task: Task, units: MachineScales, limits: Limits, prices: Prices) -> Iterator[WishLevel]:
    """The levels of all limits and prices on forces of the machine: the figures of these names in ``Figures``."""
    speed, torque = task.speed_rad_s, units.torque_n_mm

    def driving(at: RatioPlace, slider: Slider, _: Term = 0.0) -> Term:
        return quantities.driving_torque(at, slider, speed) / torque

    def level(name: str, words: str, unit: float, sides: Sides, **more: Any) -> Iterator[WishLevel]:
        return of_figure(name, words, unit, getattr(limits, name), getattr(prices, name, 0.0), sides, **more)

    def size(force: Callable[[RatioPlace, Slider, Term], tuple[Term, Term]], unit: float) -> Sides:
        def sides(at: RatioPlace, slider: Slider, _: Term) -> tuple[Term, ...]:
            along, across = force(at, slider, speed)
            return (((along / unit) ** 2 + (across / unit) ** 2 + ROUND**2) ** 0.5,)

        return sides

    per_power = torque * speed * N_M_PER_N_MM
    yield from level("peak_power_w", "a peak power of {} W", per_power, lambda *at: (driving(*at),))
    # Nothing is gained by a shaft that never brakes
    yield from level("braking_power_w", "a braking power of {} W", per_power, lambda *at: (-driving(*at), 0.0))
    unit, rms, cycle = torque * N_M_PER_N_MM, LevelKind.RMS, task.cycle_rad
    words = "an r.m.s. torque of {} N m"
    yield from level("rms_torque_n_m", words, unit, lambda *at: (driving(*at),), kind=rms, cycle_rad=cycle)
    words, high = "an r.m.s. torque of {} N m in high harmonics", {"kind": rms, "order": task.harmonics_above}
    yield from level("torque_harmonics_n_m", words, unit, lambda *at: (driving(*at),), cycle_rad=cycle, **high)
    per_swing = KG_MM2 * torque / (task.speed_fluctuation * speed**2)
    words = "a flywheel of {} kg mm^2"
    yield from level("flywheel_kg_mm2", words, per_swing, lambda *at: (driving(*at),), kind=LevelKind.SWING)
    bearing, shaking = units.bearing_n, units.shaking_n
    words = "a force of {} N on the crank's bearings"
    yield from level("bearing_force_n", words, bearing, size(quantities.bearing_force, bearing))
    words = "a force of {} N on the frame"
    yield from level("shaking_force_n", words, shaking, size(quantities.shaking_force, shaking))
    if limits.tooth_force_n is not None or prices.tooth_force_n:
        yield from _tooth_force(task, units, limits.tooth_force_n, prices.tooth_force_n)
    if limits.flank_load_n_mm is not None or prices.flank_load_n_mm:
        yield from _flank_load(task, units, limits.flank_load_n_mm, prices.flank_load_n_mm)


def _tooth_force(task: Task, units: MachineScales, limit: float | None, price: float) -> Iterator[WishLevel]:
    """The force of the flanks that carry; the other sign, of flanks that do not, is far under the limit."""
    size, angles = task.gears, _rack_angles_rad(task)
    assert size is not None
    unit = limit or units.torque_n_mm * task.cycle_rad / size.rolled_mm(task.lobes)
    lobes = task.lobes.driving

    def sides(at: RatioPlace, slider: Slider, length: Term) -> tuple[Term, ...]:
        distance = size.center_distance_mm
        if size.teeth is not None and size.module_mm is not None:
            distance = size.teeth * pi * size.module_mm / (lobes * length)
        # Of the driven gear
        torque = quantities.driving_torque(at, slider, task.speed_rad_s) * at.ratio
        pushing, back = quantities.inverse_levers(at, angles)
        return torque * pushing / distance / unit, -torque * back / distance / unit

    return of_figure("tooth_force_n", "a force of {} N between the teeth", unit, limit, price, sides)


ROUND_GEARS = 8.0
"""(1 + s)^3/s of equal round gears."""


def _flank_load(task: Task, units: MachineScales, limit: float | None, price: float) -> Iterator[WishLevel]:
    """The load of the flanks that carry, which decides face width times centre distance squared against pitting."""
    angles, unit = _rack_angles_rad(task), limit or ROUND_GEARS * units.torque_n_mm

    def sides(at: RatioPlace, slider: Slider, _: Term) -> tuple[Term, ...]:
        torque = quantities.driving_torque(at, slider, task.speed_rad_s) * at.ratio
        pushing, back = quantities.inverse_levers(at, angles)
        per = quantities.relative_curvature(at) / unit
        return torque * pushing * per, -torque * back * per

    return of_figure("flank_load_n_mm", "a flank load of {} N mm", unit, limit, price, sides)


def _rack_angles_rad(task: Task) -> tuple[float, float]:
    """Pressure angles of the rack on the pushing flanks and on the back flanks."""
    size = task.gears
    assert size is not None
    return size.rack_angle_rad, size.rack_angle_rad if size.idle_angle_rad is None else size.idle_angle_rad
