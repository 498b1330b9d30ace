"""The variables of all motions as a conic programme, and their relations by acceleration, power, speed and energy.

Let phi2 be the crank's angle, s = dphi2/dphi1, q = s^2, primes by phi2.  The variables are q at the places, s there
(at most the root of q), and the mean of 1/s in each cell, which is its share of driving angle.

- Acceleration w^2 (x'' q + x' q'/2) is the slope of half the squared speed along the slider's way: from place to place
  it changes by at most the peak times the way, and falls by at most a wished deceleration times it.
- Power F w x' s of a resistance bounds q at each place, and the work of a cell takes its time at full power.  With
  masses, work and change of kinetic energy of a cell take their time.  The time is a variable not below the true time;
  where ranges of q are known, a chord limits it from above.

The relations are known from the time-optimal control of a path (Verscheure et al., "Time-optimal path tracking for
robots: a convex optimization approach", IEEE Trans. Automat. Contr. 54 (2009), who use q as well).

``rows`` adds the shape of the pitch curves, the times of cells and the load of flanks; ``problem.motion_programme``
puts a programme together.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from math import inf, isinf

import numpy as np

from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array
from ncgear.optimum.certified.cycle import CrankCycle
from ncgear.optimum.certified.demands import Demands, Priced, Ranges
from ncgear.optimum.certified.proof import ConicProgramme, Linear
from ncgear.optimum.task import Task
from ncgear.wishes.requirements import DecelerationWithin, EvenSpeed, SpeedWithin

ROUNDING = 1e-12
"""Relative error that ranges of variables made from other ranges may have, with much to spare."""

MOST_ACCELERATION = 1e4
"""Largest peak acceleration of the search, in units of crank w^2; an even crank has 1 or 2."""


@dataclass(frozen=True, eq=False)
class LimitedFigure:
    """A limited figure: its share of the limit, as an expression, and the least share."""

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
    driving angle of the motion over that of the cycle.  Each is a single expression.
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
        # Greatest wished decelerations in the cells, over crank w^2
        self.falls = np.full(count, inf)
        self.priced: dict[str, LimitedFigure] = {}
        for figure in priced:
            most = getattr(asked, figure.name)
            least = min(figure.least / most, 1.0)
            share = self.programme.variable(np.full(1, least), np.ones(1))
            self.programme.positive(1.0 - share)
            self.programme.positive(share - least)
            self.priced[figure.name] = LimitedFigure(share, least, most)

    @property
    def figures(self) -> dict[str, Linear]:
        """The priced figures, in their units."""
        return {name: figure.value for name, figure in self.priced.items()}

    def _cap_by_power(self) -> None:
        """Ranges of q and of times under a given peak power, without masses."""
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
            self.acceleration = self.constant(np.zeros(1))
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
        return self.energy[self.next] * per - self.energy * per

    def limit_decelerations(self) -> None:
        """Wished decelerations over stretches: the mean over each whole cell, and the deceleration at a dead centre.

        A law that keeps the deceleration at every point keeps the mean too; the swing within a cell is of first order.
        """
        on = self.on
        for limit in self.asked.requirements(DecelerationWithin):
            most = limit.most_mm_s2 / self.acceleration_unit_mm_s2
            cells = on.cells_within(*limit.stretch)
            self.falls[cells] = np.minimum(self.falls[cells], most)
            self.programme.positive(self._slope()[cells] + most)
            # The dead centres at the ends of these cells
            dead = np.intersect1d(self.next[cells], [0, on.extended])
            self.programme.positive(most - self.q[dead] * (on.bend_mm_rad2[dead] / self.crank))

    def limit_power(self, powers_w: tuple[float, float]) -> None:
        """The peak power, if not limited and without masses: its square bounds q at each place."""
        top = float(np.max(self.pressing, initial=0.0))
        self.power_unit_w = top if top > 0.0 else 1.0
        if self.task.masses is not None or not isinf(self.asked.power_w) or top <= 0.0:
            self.power_squared = self.constant(np.zeros(1))
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
        least_product = self.constant(np.sqrt(lasting[worked]))
        self.programme.product(self.time[worked], root.repeated(worked.size), least_product)

    def limit_speeds(self) -> None:
        """The peak speed, even speeds over stretches, and ranges of the speed; squared, over crank w."""
        on, per_q = self.on, (self.on.slope_mm_rad / self.crank) ** 2
        unit = self.crank * self.speed
        if (peak := self.limited("speed_mm_s")) is not None:
            # The square of its share lies below its chord
            all_round = peak.share.repeated(on.count)
            square = (all_round * (1.0 + peak.least) - peak.least) * (peak.most / unit) ** 2
            self.programme.positive(square - self.q * per_q)
            # A cell's way takes its time at full speed: time * share >= shortest
            shortest = on.length_mm * self.speed / (peak.most * self.after_h)
            self.programme.product(self.time, all_round, self.constant(np.sqrt(shortest)))
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

    @cached_property
    def given(self) -> Linear:
        """The energy in N mm that the crank takes in each cell."""
        least, most = self.asked.flywheel_kg_mm2
        unit = self.speed**2 / 2000.0
        kinetic = self.q * ((self.on.inertia_kg_mm2 + least) * unit)
        if most > least:
            # The share of the flywheel's range times q lies within the four planes of McCormick
            share = self.programme.variable(np.zeros(1), np.ones(1)).repeated(self.on.count)
            product = self.programme.variable(np.zeros(self.on.count), self.highest)
            self.programme.positive(1.0 - share[:1])
            self.programme.positive(product - share * self.lowest)
            self.programme.positive(share * self.highest - product)
            self.programme.positive(product - self.q - share * self.highest + self.highest)
            self.programme.positive(self.q + share * self.lowest - self.lowest - product)
            kinetic = kinetic + product * ((most - least) * unit)
        return kinetic[self.next] - kinetic + self.on.work_n_mm

    def limit_energies(self) -> None:
        """Motor and brake with masses, the swing of the shaft's energy, and its mean square torque; all in N mm."""
        on, task, given = self.on, self.task, self.given
        work = on.work_n_mm
        if task.masses is not None:
            self._limit_flow("power_w", given)
        elif "power_w" in self.priced:
            pressed = np.nonzero(self.pressing > 0.0)[0]
            share = self.pressing[pressed] / self.asked.power_w
            enough = self.priced["power_w"].share.repeated(pressed.size)
            self.programme.positive(enough - self._slower()[pressed] * share)
        self._limit_flow("braking_w", -given)
        total = float(np.sum(work))
        if (torque := self.limited("torque_n_mm")) is not None:
            # The mean square of the torque over a cell is no less than the square of its mean
            squares = self.programme.variable(np.zeros(on.count), np.full(on.count, task.cycle_rad))
            self.programme.product(self.time * self.after_h, squares, given * (1.0 / torque.most))
            # The square of its share lies below its chord
            square = torque.share * (1.0 + torque.least) - torque.least
            self.programme.positive(square * task.cycle_rad - squares.total())
        if (swing := self.limited("fluctuation_n_mm")) is not None:
            self._swing(given, total, swing)

    def limited(self, name: str) -> LimitedFigure | None:
        """A figure that is limited, a variable if it is priced; None where it is free."""
        most = getattr(self.asked, name)
        if isinf(most):
            return None
        return self.priced.get(name, LimitedFigure(self.constant(np.ones(1)), 1.0, most))

    def _limit_flow(self, name: str, given: Linear) -> None:
        """Cells take their time at a peak power; its share times the time lies below both planes of McCormick."""
        power = self.limited(name)
        if power is None:
            return
        taken = given * (self.speed / (1000.0 * power.most * self.after_h))
        share = power.share.repeated(self.on.count)
        for time, at in ((self.highest_time, power.least), (self.lowest_time, 1.0)):
            self.programme.positive(share * time + self.time * at - time * at - taken)

    def _slower(self) -> Linear:
        """A lower bound of s at the places: its chord in q over the range."""
        slow, fast = np.sqrt(self.lowest), np.sqrt(np.maximum(self.highest, self.lowest))
        return (self.q - self.lowest) * (1.0 / (slow + fast)) + slow

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

    @staticmethod
    def constant(values: Array) -> Linear:
        """Values as expressions without variables."""
        return Linear(np.zeros((1, values.size), dtype=int), np.zeros((1, values.size)), values)
