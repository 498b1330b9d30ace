"""The relations between places that every motion keeps, as a conic programme.

Let phi2 be the crank's angle, s = dphi2/dphi1, q = s^2, primes by phi2.  The variables are q at the places, s there
(at most the root of q), and the mean of 1/s in each cell, which is its share of driving angle.

- Acceleration w^2 (x'' q + x' q'/2) is the slope of half the squared speed along the slider's way: from place to place
  it changes by at most the peak times the way, and falls by at most a wished deceleration times it.
- Power F w x' s of a resistance bounds q at each place, and the work of a cell takes its time at full power.  With
  masses, work and change of kinetic energy of a cell take their time.  The time is a variable of its own that is no
  less than the true one; where q is known to lie within ranges, it is no more than a chord leaves it.
- The driven curve, 1/r2 = (1 + s)/a, is convex where 1 + s + s'' >= 0.  So 1 + s lies at or below the sine curve
  through two places.  For three places in a row that is exact: s0 <= alpha + beta s- + gamma s+.  Squared, it bounds q0
  by a concave function of q- and q+.  In a cell, the curve through its ends bounds the mean of 1/s from below.
- The tangent, |s'| <= t (1 + s), lets 1 + s grow by at most exp(t h) in a cell of h rad.
- The driving curve, 1/r1 = (1 + 1/s)/a, is convex where y'' <= 2 exp(-y) + 2 exp(-y/2), with y = ln q.  Where q is
  known to lie within a range, the right side lies below its chord a - c y: so y lies at or above the solution of y'' +
  c y = a through two places (the maximum principle), which for three places in a row is linear.  The variables y lie
  below the tangents of ln q and above its chord over the range.

The first three are of the time-optimal control of a path (Verscheure et al., "Time-optimal path tracking for robots: a
convex optimization approach", IEEE Trans. Automat. Contr. 54 (2009), who use q as well); those of the curves are ours.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from math import inf, isinf, log

import numpy as np

from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array, IndexArray
from ncgear.optimum.certified.cycle import CrankCycle
from ncgear.optimum.certified.demands import Demands, NearMotion, Priced, Ranges
from ncgear.optimum.certified.proof import ConicProgramme, Linear
from ncgear.optimum.certified.ranges import along, curved
from ncgear.optimum.task import Task
from ncgear.wishes.requirements import DecelerationWithin, EvenSpeed, SpeedWithin, TimeWithin

ROUNDING = 1e-12
"""Relative error that ranges of variables made from other ranges may have, with much to spare."""

MOST_ACCELERATION = 1e4
"""Peak acceleration in units of crank w^2 beyond which none is told apart; an even crank has one or two."""


def motion_programme(
    task: Task,
    on: CrankCycle,
    asked: Demands,
    curve: Ranges | NearMotion | None = None,
    *,
    closed: bool = True,
    with_peak: bool = False,
    powers_w: tuple[float, float] = (0.0, inf),
    priced: Sequence[Priced] = (),
) -> MotionProgramme:
    """The programme of all motions that keep the demands, and more that only keep these relations.

    ``curve`` brings the driving curve in.  With ranges, for motions within these.  Near a motion, its relation is that
    of q'' <= 2 + 2 sqrt(q) + q'^2/q with q'^2/q bounded from below by its tangent: a motion that keeps it has a convex
    driving curve, but not every such motion keeps it.  That programme finds motions and proves nothing.  Where not
    ``closed``, the cycle may take any driving angle.  ``powers_w`` is the range of peak powers that is looked at where
    the peak power is not limited.  The peak of acceleration is a variable ``with_peak``, up to ``MOST_ACCELERATION``,
    or where it is limited.  Figures that are ``priced`` are variables within their ranges, and demands.
    """
    asked = replace(asked, **{one.name: min(one.most, getattr(asked, one.name)) for one in priced})
    made = MotionProgramme(task, on, asked, curve if isinstance(curve, Ranges) else None, priced)
    made.limit_acceleration(with_peak)
    made.limit_power(powers_w)
    if asked.convex:
        made.limit_bulge()
    if not isinf(asked.steepness):
        made.limit_lean()
    if isinstance(curve, Ranges):
        if asked.convex:
            made.limit_driving_curve(curve)
        if closed and needs_times(task, asked):
            made.limit_times(curve)
    if isinstance(curve, NearMotion):
        made.follow_driving_curve(curve)
    made.limit_speeds()
    made.limit_decelerations()
    made.limit_energies()
    made.least_times()
    made.take_time(closed)
    return made


def needs_times(task: Task, asked: Demands) -> bool:
    """Whether a longer time than the true one eases a row: those of energies, and those of stretches."""
    return (
        task.masses is not None
        or bool(asked.requirements(TimeWithin))
        or any(not isinf(one) for one in (asked.braking_w, asked.fluctuation_n_mm, asked.torque_n_mm))
    )


@dataclass(frozen=True, eq=False)
class LimitedFigure:
    """A limited figure: its share of the most, one expression, and the least share."""

    share: Linear
    least: float
    most: float

    @property
    def value(self) -> Linear:
        """The figure itself."""
        return self.share * self.most


class MotionProgramme:
    """The programme of a cycle under demands, and its variables; each method adds the rows of one idea.

    ``q`` (s^2), ``turning`` (s) and ``time`` (mean of 1/s in each cell) have one expression for each place.
    ``acceleration`` is in units of crank w^2, ``power_squared`` in units of ``power_unit_w`` squared, ``angle`` is the
    driving angle that the cycle takes, over that which it has; one expression each.
    """

    def __init__(
        self, task: Task, on: CrankCycle, asked: Demands, known: Ranges | None, priced: Sequence[Priced]
    ) -> None:
        self.task, self.on, self.asked = task, on, asked
        self.speed = task.speed_rad_s
        self.crank = task.linkage.half_way
        self.acceleration_unit_mm_s2 = self.crank * self.speed**2
        count = on.count
        self.next = np.roll(np.arange(count), -1)
        self.before = np.roll(np.arange(count), 1)
        self.after_h, self.before_h = on.step_rad, on.step_rad[self.before]
        self.programme = ConicProgramme(error=on.error)
        least, most = 1.0 / asked.ratio_max, 1.0 / asked.ratio_min
        self.lowest, self.highest = np.full(count, least**2), np.full(count, most**2)
        self.lowest_time, self.highest_time = np.full(count, asked.ratio_min), np.full(count, asked.ratio_max)
        self._cap_by_power()
        if known is not None:
            self.lowest = np.maximum(self.lowest, known.least)
            self.highest = np.maximum(np.minimum(self.highest, known.most), self.lowest * 0.99)
            found = (known.least_in_cell > 0.0) & np.isfinite(known.most_in_cell)
            quick, slow = (
                np.sqrt(1.0 / ends[found]) * (1.0 + sign * ROUNDING)
                for ends, sign in ((known.most_in_cell, -1.0), (known.least_in_cell, 1.0))
            )
            self.lowest_time[found] = np.maximum(self.lowest_time[found], quick)
            self.highest_time[found] = np.maximum(np.minimum(self.highest_time[found], slow), self.lowest_time[found])
        self.q = self.programme.variable(self.lowest, self.highest)
        self.turning = self.programme.variable(np.sqrt(self.lowest), np.sqrt(self.highest))
        self.time = self.programme.variable(self.lowest_time, self.highest_time)
        self.programme.positive(self.highest - self.q)
        self.programme.positive(self.q - self.lowest)
        self.programme.positive(self.time - self.lowest_time)
        self.programme.root(self.turning, self.q)
        # Half the squared speed at the places, over (crank w)^2
        self.energy = self.q * (on.slope_mm_rad**2 / (2.0 * self.crank**2))
        self.length = on.length_mm / self.crank
        self.angle = (self.time * (self.after_h / task.cycle_rad)).total()
        # Greatest decelerations that are wished in the cells, over crank w^2
        self.falls = np.full(count, inf)
        self.priced: dict[str, LimitedFigure] = {}
        for one in priced:
            most = getattr(asked, one.name)
            least = min(one.least / most, 1.0)
            share = self.programme.variable(np.full(1, least), np.ones(1))
            self.programme.positive(1.0 - share)
            self.programme.positive(share - least)
            self.priced[one.name] = LimitedFigure(share, least, most)

    @property
    def figures(self) -> dict[str, Linear]:
        """The priced figures, in their units."""
        return {name: one.value for name, one in self.priced.items()}

    def _cap_by_power(self) -> None:
        """Ranges of q and of times that a given peak power leaves where no mass takes part."""
        most = self.asked.power_w
        self.pressing = self.on.force_n * self.on.slope_mm_rad * self.speed / 1000.0
        if self.task.masses is not None or isinf(most):
            return
        capped = np.full(self.on.count, inf)
        np.divide(most, self.pressing, out=capped, where=self.pressing > 0.0)
        self.highest = np.maximum(np.minimum(self.highest, capped**2), self.lowest * 0.99)
        lasting = self.on.work_n_mm * self.speed / (1000.0 * most * self.after_h)
        self.lowest_time = np.clip(lasting, self.lowest_time, self.highest_time)

    def limit_acceleration(self, with_peak: bool) -> None:
        """The peak of the acceleration, over crank w^2."""
        on, most = self.on, self.asked.acceleration_mm_s2 / self.acceleration_unit_mm_s2
        self.has_peak = with_peak or not isinf(most)
        if not self.has_peak:
            self.acceleration = self._constant(np.zeros(1))
            return
        self.most_acceleration = top = min(most, MOST_ACCELERATION)
        self.acceleration = self.programme.variable(np.zeros(1), np.full(1, top))
        self.programme.positive(top - self.acceleration)
        everywhere = self.acceleration.repeated(on.count)
        slope = self._slope()
        self.programme.positive(everywhere - slope)
        self.programme.positive(everywhere + slope)
        if "acceleration_mm_s2" in self.priced:
            self.programme.positive(
                self.priced["acceleration_mm_s2"].value * (1.0 / self.acceleration_unit_mm_s2) - self.acceleration
            )
        dead = np.array([0, on.extended])
        self.programme.positive(everywhere[dead] - self.q[dead] * (on.bend_mm_rad2[dead] / self.crank))

    def _slope(self) -> Linear:
        """The mean along the way of the acceleration in each cell, over crank w^2, positive where the speed rises."""
        per = 1.0 / self.length
        slope: Linear = self.energy[self.next] * per - self.energy * per
        return slope

    def limit_decelerations(self) -> None:
        """Wished decelerations over stretches: the mean over each whole cell, and what a dead centre is come to with.

        A law that keeps the deceleration at every point has no more in the mean, so the rows hold for every such law.
        What they miss is the swing of the deceleration within a cell, of first order in its step.
        """
        on = self.on
        for limit in self.asked.requirements(DecelerationWithin):
            most = limit.most_mm_s2 / self.acceleration_unit_mm_s2
            cells = on.cells_within(*limit.stretch)
            self.falls[cells] = np.minimum(self.falls[cells], most)
            self.programme.positive(self._slope()[cells] + most)
            # The dead centres at which one of these cells ends
            dead = np.intersect1d(self.next[cells], [0, on.extended])
            self.programme.positive(most - self.q[dead] * (on.bend_mm_rad2[dead] / self.crank))

    def limit_power(self, powers_w: tuple[float, float]) -> None:
        """The peak power where it is not limited and no mass takes part: its square bounds q at each place."""
        top = float(np.max(self.pressing, initial=0.0))
        self.power_unit_w = top if top > 0.0 else 1.0
        if self.task.masses is not None or not isinf(self.asked.power_w) or top <= 0.0:
            self.power_squared = self._constant(np.zeros(1))
            return
        least, most = (end / top for end in powers_w)
        most = min(most, 1.0 / self.asked.ratio_min)
        self.power_squared = self.programme.variable(np.full(1, least**2), np.full(1, most**2))
        root = self.programme.variable(np.full(1, least), np.full(1, most))
        self.programme.positive(most**2 - self.power_squared)
        self.programme.positive(self.power_squared - least**2)
        self.programme.root(root, self.power_squared)
        share = self.pressing / top
        pressed = np.nonzero(share > 0.0)[0]
        self.programme.positive(self.power_squared.repeated(pressed.size) - self.q[pressed] * share[pressed] ** 2)
        # The work of a cell at full power: time * power >= work
        lasting = self.on.work_n_mm * self.speed / (1000.0 * top * self.after_h)
        worked = np.nonzero(lasting > 0.0)[0]
        least_product = self._constant(np.sqrt(lasting[worked]))
        self.programme.product(self.time[worked], root.repeated(worked.size), least_product)

    def limit_bulge(self) -> None:
        """Three places in a row of a convex driven curve, over alpha, which is of the square of their distance."""
        near, far = self.before_h, self.after_h
        whole = np.sin(near + far)
        beta, gamma = np.sin(far) / whole, np.sin(near) / whole
        alpha = 2.0 * np.sin(near / 2.0) * np.sin(far / 2.0) / np.cos((near + far) / 2.0)
        # The geometric mean of the values on both sides
        low, high = (np.sqrt(ends[self.before] * ends[self.next]) for ends in (self.lowest, self.highest))
        between = self.programme.variable(low * (1.0 - ROUNDING), high * (1.0 + ROUNDING))
        self.programme.cone(
            self.q[self.before] + self.q[self.next], 2.0 * between, self.q[self.before] - self.q[self.next]
        )
        roots = 2.0 * (beta * self.turning[self.before] + gamma * self.turning[self.next])
        squares = (beta**2 / alpha) * self.q[self.before] + (gamma**2 / alpha) * self.q[self.next]
        mixed = (2.0 * beta * gamma / alpha) * between
        self.programme.positive(roots + squares + mixed + alpha - self.q * (1.0 / alpha))

    def limit_lean(self) -> None:
        """1 + s grows by at most exp(t h) from place to place, either way."""
        cells = self._leaning()
        here, there = cells, self.next[cells]
        growth = np.exp(self.asked.steepness * self.after_h[cells])
        more = np.expm1(self.asked.steepness * self.after_h[cells])
        for start, end in ((here, there), (there, here)):
            reach = 2.0 * growth * self.turning[start] + (growth**2 / more) * self.q[start] + more
            self.programme.positive(reach - self.q[end] * (1.0 / more))

    def _leaning(self) -> IndexArray:
        """Cells in which the tangent holds 1 + s back more than the ratios do."""
        widest = log((1.0 + 1.0 / self.asked.ratio_min) / (1.0 + 1.0 / self.asked.ratio_max))
        return np.nonzero(self.asked.steepness * self.after_h < widest)[0]

    def limit_driving_curve(self, known: Ranges) -> None:
        """y = ln q within what its range leaves, and three places in a row of a convex driving curve."""
        cells = np.nonzero((known.least_in_cell > 0.0) & np.isfinite(known.most_in_cell))[0]
        places = np.unique(np.concatenate([cells, self.next[cells]]))
        low, high = self.lowest[places], np.maximum(self.highest[places], self.lowest[places])
        y = self.programme.variable(np.log(low), np.log(high))
        q = self.q[places]
        for at in (low, np.sqrt(low * high), high):
            self.programme.positive(q * (1.0 / at) + (np.log(at) - 1.0) - y)
        # The chord of ln q over the range; a tangent where the range has no width
        width = high / low - 1.0
        rise = np.where(width > 0.0, np.log1p(width) / np.where(width > 0.0, width, 1.0), 1.0)
        self.programme.positive(y - np.log(low) - (q * (1.0 / low) - 1.0) * rise)
        inner = np.nonzero(np.isin(self.before[places], cells) & np.isin(places, cells))[0]
        here = places[inner]
        number = np.zeros(self.on.count, dtype=int)
        number[places] = np.arange(places.size)
        near, far = self.before_h[here], self.after_h[here]
        least = np.minimum(known.least_in_cell[here], known.least_in_cell[self.before[here]])
        most = np.maximum(known.most_in_cell[here], known.most_in_cell[self.before[here]])
        first, second, rest, good = curved(np.log(least), np.log(most), near, far)
        lowest = first * y[number[self.before[here]]] + second * y[number[self.next[here]]] + rest
        self.programme.positive((y[inner[good]] - lowest[good]) * (1.0 / (near * far)[good]))

    def follow_driving_curve(self, motion: NearMotion) -> None:
        """Three places in a row of a driving curve that stays convex by the tangents at a motion."""
        rate = (motion.rate + motion.rate[self.before]) / 2.0
        first, second, rest = along(rate, motion.q, self.before_h, self.after_h)
        lowest = first * self.q[self.before] + second * self.q[self.next] + rest
        self.programme.positive((self.q - lowest) * (1.0 / (self.before_h * self.after_h)))

    def limit_times(self, known: Ranges) -> None:
        """Upper bounds of the mean of 1/s in cells: the mean of a bound for each end, which lies below its chord in q.

        A convex driving curve lets ln q bend up by 2 i + 2 i^2 at most, so 1/s lies below the mean of both ends but for
        the bend.  Else the tangent lets 1 + s fall by exp(-t d) at most over d rad from an end; on half a cell of h rad
        1/s has the mean -ln(1 - f/s) 2/(t h) then, with f = exp(t h/2) - 1.
        """
        cells = np.nonzero((known.least_in_cell > 0.0) & np.isfinite(known.most_in_cell))[0]
        if self.asked.convex:
            ratio = 1.0 / np.sqrt(known.least_in_cell[cells])
            bent = np.exp((2.0 * ratio + 2.0 * ratio**2) * self.after_h[cells] ** 2 / 16.0)

            def mean(s: Array) -> Array:
                return bent / s
        else:
            half = self.asked.steepness * self.after_h / 2.0
            slowest = np.sqrt(np.minimum(self.lowest, self.lowest[self.next]))
            cells = cells[np.expm1(half[cells]) < slowest[cells]]
            half = half[cells]

            def mean(s: Array) -> Array:
                longest: Array = -np.log1p(-np.expm1(half) / s) / half * (1.0 + ROUNDING)
                return longest

        for_ends = []
        for end in (cells, self.next[cells]):
            low, high = self.lowest[end], np.maximum(self.highest[end], self.lowest[end])
            longest, width = mean(np.sqrt(low)), high - low
            fall = np.where(width > ROUNDING * high, longest - mean(np.sqrt(high)), 0.0)
            for_ends.append((self.q[end] - low) * (-fall / np.maximum(width, ROUNDING * high)) + longest)
        self.programme.positive((for_ends[0] + for_ends[1]) * 0.5 - self.time[cells])
        # The times fill the cycle
        self.programme.positive(self.angle - 1.0)

    def limit_speeds(self) -> None:
        """Even speeds over stretches, and ranges of the speed; squared, over crank w."""
        on, per_q = self.on, (self.on.slope_mm_rad / self.crank) ** 2
        unit = self.crank * self.speed
        for even in self.asked.requirements(EvenSpeed):
            places = on.within(*even.stretch)
            places = places[per_q[places] > 0.0]
            top = float(np.max(per_q[places] * self.highest[places], initial=1.0))
            least = self.programme.variable(np.zeros(1), np.full(1, top))
            speed = self.q[places] * per_q[places]
            self.programme.positive(even.spread**2 * least.repeated(places.size) - speed)
            self.programme.positive(speed - least.repeated(places.size))
        for limit in self.asked.requirements(SpeedWithin):
            places = on.within(*limit.stretch)
            speed = self.q[places] * per_q[places]
            self.programme.positive(speed - (limit.least_mm_s / unit) ** 2)
            if not isinf(limit.most_mm_s):
                self.programme.positive((limit.most_mm_s / unit) ** 2 - speed)

    def limit_energies(self) -> None:
        """Motor and brake with masses, the swing of the shaft's energy, and its mean square torque; all in N mm."""
        on, task = self.on, self.task
        work = on.work_n_mm
        kinetic = self.q * (on.inertia_kg_mm2 * self.speed**2 / 2000.0)
        given = kinetic[self.next] - kinetic + work
        if task.masses is not None:
            self._limit_flow("power_w", given)
        elif "power_w" in self.priced:
            pressed = np.nonzero(self.pressing > 0.0)[0]
            share = self.pressing[pressed] / self.asked.power_w
            enough = self.priced["power_w"].share.repeated(pressed.size)
            self.programme.positive(enough - self._slower()[pressed] * share)
        self._limit_flow("braking_w", -given)
        total = float(np.sum(work))
        if (torque := self._limit("torque_n_mm")) is not None:
            # The mean square of the torque over a cell is no less than the square of its mean
            squares = self.programme.variable(np.zeros(on.count), np.full(on.count, task.cycle_rad))
            self.programme.product(self.time * self.after_h, squares, given * (1.0 / torque.most))
            # The square of its share lies below its chord
            square = torque.share * (1.0 + torque.least) - torque.least
            self.programme.positive(square * task.cycle_rad - squares.total())
        if (swing := self._limit("fluctuation_n_mm")) is not None:
            self._swing(given, total, swing)

    def _limit(self, name: str) -> LimitedFigure | None:
        """A figure that is limited, a variable if it is priced; None where it is free."""
        most = getattr(self.asked, name)
        if isinf(most):
            return None
        return self.priced.get(name, LimitedFigure(self._constant(np.ones(1)), 1.0, most))

    def _limit_flow(self, name: str, given: Linear) -> None:
        """The energy given in each cell takes its time at a peak power.

        The product of the power's share and the time lies below both planes of McCormick.
        """
        power = self._limit(name)
        if power is None:
            return
        taken = given * (self.speed / (1000.0 * power.most * self.after_h))
        share = power.share.repeated(self.on.count)
        for time, at in ((self.highest_time, power.least), (self.lowest_time, 1.0)):
            self.programme.positive(share * time + self.time * at - time * at - taken)

    def _slower(self) -> Linear:
        """What s is no less than at the places: its chord in q over the range."""
        slow, fast = np.sqrt(self.lowest), np.sqrt(np.maximum(self.highest, self.lowest))
        chord: Linear = (self.q - self.lowest) * (1.0 / (slow + fast)) + slow
        return chord

    def _swing(self, given: Linear, total: float, swing: LimitedFigure) -> None:
        """The energy at each place less the mean torque's stays within a band."""
        on = self.on
        size = swing.most + abs(total)
        top = self.programme.variable(np.full(1, -1e3), np.full(1, 1e3))
        level = self.programme.variable(np.full(on.count, -1e3), np.full(on.count, 1e3))
        step = (given - self.time * (self.after_h * total / self.task.cycle_rad)) * (1.0 / size)
        inner = np.arange(on.count - 1)
        for sign in (1.0, -1.0):
            self.programme.positive(sign * (level[inner + 1] - level[inner] - step[inner]))
        self.programme.positive(top.repeated(on.count) - level)
        self.programme.positive(level - top.repeated(on.count) + swing.share.repeated(on.count) * (swing.most / size))

    def least_times(self) -> None:
        """Upper bounds of the mean of s in a cell: its inverse is no more than the mean of 1/s."""
        one = self._constant(np.ones(self.on.count))
        ends = (self.turning + self.turning[self.next]) * 0.5
        if self.asked.convex:
            wide = np.tan(self.after_h / 2.0) / (self.after_h / 2.0)
            self.programme.product(self.time, wide * ends + (wide - 1.0), one)
            return
        if not isinf(self.asked.steepness):
            cells = self._leaning()
            lean = self.asked.steepness * self.after_h[cells] / 2.0
            wide = np.expm1(lean) / lean
            self.programme.product(self.time[cells], wide * ends[cells] + (wide - 1.0), one[cells])
        self._keep_under_roofs()

    def _keep_under_roofs(self) -> None:
        """A cell's mean of half the squared speed is under the roof that accelerations leave, which limits its time.

        Over a way of length 1 from a to b it rises by A at most and falls by D at most, so it is at most the lower of a
        + A u and b + D (1 - u) at u.  The mean of that is b + D/2 - (b - a + D)^2/(2 (A + D)).
        """
        cells = np.nonzero(np.isfinite(self.falls) | self.has_peak)[0]
        if not cells.size:
            return
        per, falls = 1.0 / self.length[cells], self.falls[cells]
        here, there = self.energy[cells] * per, self.energy[self.next[cells]] * per
        fastest = self.on.slope_mm_rad**2 * self.highest / (2.0 * self.crank**2)
        ends = fastest[cells] * per, fastest[self.next[cells]] * per
        rising = np.maximum(*ends) + (self.most_acceleration / 2.0 if self.has_peak else inf)
        top = 1.1 * np.minimum(float(np.max(fastest)) * per, np.minimum(rising, ends[1] + falls / 2.0))
        mean, root = (
            self.programme.variable(np.zeros(cells.size), top),
            self.programme.variable(np.zeros(cells.size), np.sqrt(top)),
        )
        peak, fallen = self.acceleration.repeated(cells.size), np.nonzero(np.isfinite(falls))[0]
        fall, room = falls[fallen], there[fallen] - mean[fallen]
        if self.has_peak:
            self.programme.product(peak, 2.0 * here + 2.0 * there + peak - 4.0 * mean, there - here)
            self.programme.product(peak[fallen] + fall, 2.0 * room + fall, (there - here)[fallen] + fall)
        else:
            self.programme.positive(room + fall / 2.0)
        self.programme.root(root, mean)
        # time * step >= length / (mean speed), over crank w
        least = np.sqrt(np.sqrt(self.length[cells] / 2.0) / self.after_h[cells])
        self.programme.product(self.time[cells], root, self._constant(least))

    @staticmethod
    def _constant(values: Array) -> Linear:
        return Linear(np.zeros((1, values.size), dtype=int), np.zeros((1, values.size)), values)

    def take_time(self, closed: bool) -> None:
        """The driving angles that the cycle and its stretches have."""
        if closed:
            self.programme.positive(1.0 - self.angle)
        for limit in self.asked.requirements(TimeWithin):
            cells = self.on.cells_within(*limit.stretch)
            if cells.size:
                taken = (self.time[cells] * self.after_h[cells]).total()
                self.programme.positive((limit.most_rad - taken) * (1.0 / limit.most_rad))
