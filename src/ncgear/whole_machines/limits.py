"""The distance of machines from the best: certified limits of flank load, power and cost, and the gaps of the proof.

The limits are for laws: no law of the machine, with any flywheel in the range, needs less power, and no law of the same
power has less flank load.  The face width times the centre distance squared is in proportion to the flank load, as far
as the estimate of strength is right: it takes the load factors of the machine that was found.

Sweeps give a limit for every machine in a few seconds; where one is not near its machine, branch and bound raises it.

The price of a wish or a limit: the law found again without it, at the same power and for the least power.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from math import inf
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from ncgear.design.keys.design import Design
from ncgear.design.keys.optimize import Choices, Optimize
from ncgear.design.reading.design_file import parsed
from ncgear.errors import DesignError
from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array
from ncgear.optimum.certified.demands import Demands
from ncgear.optimum.certified.limit import Motion, least_mean_power_w, least_power
from ncgear.optimum.certified.sums import raised
from ncgear.optimum.certified.sweeps import Sweeps, least_flank_load
from ncgear.optimum.certified.sweeps import least_power as swept_power
from ncgear.optimum.certified.tree import Budget
from ncgear.optimum.makeable.demanded import bound_of_stroke, demands_of, start_motion
from ncgear.optimum.makeable.wishes import Goal, Wishes
from ncgear.optimum.task import LOAD_LIMITS, Task, figures
from ncgear.project.drive import Drive
from ncgear.project.law_task import inertia_as_given, task_of
from ncgear.whole_machines.laws import FoundLaw, law_design, law_wishes
from ncgear.whole_machines.machine import KEPT, WholeMachine, cost_of, guessed_figures, motor_for
from ncgear.workers import finished

FLYWHEELS = 8
"""Number of parts of the flywheel's range, each with its own limit."""

POWERS = 12
"""Number of parts of the range of powers in the limit of the cost."""

NEAR = 1.02
"""Ratio of a machine's figure to its limit up to which the limit is not raised."""

MOTION_PLACES = 720
"""Places of a machine's motion: its limit only starts from it."""

PROGRAMMES, FOR_ALL = 600, 1800
"""Most programmes, of 0.05 s each, for raising one limit and for the flank loads of all machines together; parts of the
flywheel's range share those of the least power."""

OUTSIDE = (
    "modules of a series, whole teeth and widths in whole mm",
    "the load factors and the sharing of load between teeth, which are taken from the machine found",
    "the gears' inertia, beyond the range of the machines found",
    "convex pitch curves, jerk, forces in bearings and soft wishes, which restrict laws and not the limit",
)
"""Things that the proof does not cover."""


@dataclass(frozen=True)
class MachineLimit:
    """A lower bound of the flank load of all laws with a machine's flywheel and power, and its gears; 0 if unknown."""

    flank_load_n_mm: float
    flank_load_gap: float
    gear_volume_mm3: float
    gear_volume_gap: float


@dataclass(frozen=True)
class ProvenLimits:
    """The limits of all machines; no law needs less than ``power_w`` with any flywheel in the range.

    No machine costs less than ``cost``, as far as the estimate of strength is right, with the materials and processes
    that may be chosen; None where no cost is given.
    """

    power_w: float
    power_gap: float
    each: tuple[MachineLimit, ...]
    cost: float | None = None
    cost_gap: float | None = None


class RaiseJob(NamedTuple):
    """A figure by its name in ``Demands`` whose limit is raised towards a motion that reaches it.

    The limit holds for all motions of at most a peak power, with any flywheel of a range in kg mm2.  ``number`` is its
    place among the limits that are raised together.
    """

    number: int
    figure: str
    reached: float
    power_w: float
    flywheel_kg_mm2: tuple[float, float]
    motion: Motion
    programmes: int


def without_flywheel(design: Design) -> tuple[Task, Demands]:
    """The machine of a design without the flywheel on its driven shaft, and the demands on all its laws."""
    bare = law_design(design, 0.0)
    task = task_of(bare, inertia_as_given(bare))
    return task, demands_of(task, law_wishes(bare, None))


def raised_limit(design: Design, job: RaiseJob) -> float:
    """The raised limit of a job."""
    task, asked = without_flywheel(design)
    asked = replace(asked, power_w=job.power_w, flywheel_kg_mm2=job.flywheel_kg_mm2)
    return raised(task, asked, {job.figure: 1.0}, {job.figure: job.reached}, job.motion, Budget(job.programmes))[0]


class MachineLimits:
    """The limits of one design file's machines."""

    def __init__(
        self,
        design: Design,
        machines: Sequence[WholeMachine],
        laws: Sequence[FoundLaw],
        scheduler: str | None = None,
        processes: int | None = None,
    ) -> None:
        self.design, self.machines, self.laws, self.where = design, machines, laws, (scheduler, processes)
        self.task, asked = without_flywheel(design)
        self.sweeps = Sweeps(self.task, asked)
        given = inertia_as_given(law_design(design, 0.0)).driven_kg_mm2
        self.made = [parsed(machine.text, Path("machine.yaml")).design for machine in machines]
        own = (inertia_as_given(machine).driven_kg_mm2 - given if self.task.masses else 0.0 for machine in self.made)
        self.own = list(own)

    def found(self) -> ProvenLimits:
        """All limits."""
        each = self.of_machines()
        power = self.power_w()
        least = min(machine.figures.peak_power_w for machine in self.machines)
        best = [machine.cost for machine in self.machines if machine.cost is not None]
        cost = self.cost(power) if best else None
        gap = least / power - 1.0 if power > 0.0 else inf
        return ProvenLimits(power, gap, tuple(each), cost, min(best) / cost - 1.0 if best and cost else None)

    def of_machines(self) -> list[MachineLimit]:
        """For each machine a lower bound of the flank load of all laws with its power and flywheel."""
        flywheel = np.array([machine.figures.driven_flywheel_kg_mm2 for machine in self.machines]) + np.array(self.own)
        power = np.array([machine.figures.peak_power_w for machine in self.machines]) * (1.0 + KEPT)
        load = np.array([machine.figures.flank_load_n_mm for machine in self.machines]) * (1.0 + KEPT)
        bounds = least_flank_load(self.sweeps, power, np.stack([flywheel, flywheel]), load)
        # With a large flywheel the bound from the work of a cycle may be higher
        of_work = bound_of_stroke("flank_load_n_mm", 1.0, self.task, self.sweeps.asked)
        bounds = np.maximum(bounds, 0.0 if of_work is None else of_work.value)
        far = np.nonzero(load > NEAR * bounds)[0].tolist()
        most = min(PROGRAMMES, FOR_ALL // max(len(far), 1))
        jobs = [
            RaiseJob(
                number,
                "flank_load_n_mm",
                load[number],
                power[number],
                (flywheel[number],) * 2,
                self.motion(number),
                most,
            )
            for number in far
        ]
        bounds = self.raised(bounds, jobs)
        return [machine_limit(machine, float(bound)) for machine, bound in zip(self.machines, bounds, strict=True)]

    def motion(self, number: int) -> Motion:
        """The motion of the crank of a machine."""
        law, angle = Drive(self.made[number]).law.train.whole, np.arange(MOTION_PLACES) * self.task.cycle_rad
        turned = law.driven_angle(angle / MOTION_PLACES, 1)
        return Motion(turned.value, turned.derivative(1))

    def raised(self, bounds: Array, jobs: Sequence[RaiseJob]) -> Array:
        """Limits of which some are raised, shape (k,)."""
        found = bounds.copy()
        for job, value in finished(partial(raised_limit, self.design), jobs, *self.where):
            found[job.number] = max(value, found[job.number])
        return found

    def _flywheel_parts(self) -> Array:
        """Parts of the range of flywheels with the gears' inertia, shape (2, parts)."""
        asked = self.design.free_flywheel
        given = self.design.masses.driven_flywheel_kg_mm2 if self.design.masses else 0.0
        low, high = (given, given) if asked is None else (asked.least, asked.most)
        low, high = low + min(self.own), high + max(self.own)
        parts = 1 if asked is None else FLYWHEELS
        ends = np.linspace(low, high, parts + 1)
        return np.stack([ends[:-1], ends[1:]])

    def power_w(self) -> float:
        """A lower bound of the peak power of all laws, with any flywheel in the range."""
        parts = self._flywheel_parts()
        most = np.full(parts.shape[1], min(machine.figures.peak_power_w for machine in self.machines) * (1.0 + KEPT))
        bounds = swept_power(self.sweeps, parts, most)
        if self.design.masses is None:
            # Without masses the conic programmes give a higher bound, and no flywheel or gear changes anything
            return max(float(bounds.min()), least_power(replace(self.task, masses=None), self.sweeps.asked).value)
        bounds = np.maximum(bounds, max(least_mean_power_w(self.task), 0.0))
        low = [number for number in range(bounds.size) if most[number] > NEAR * bounds[number]]
        motion = self.motion(int(np.argmin([machine.figures.peak_power_w for machine in self.machines])))
        jobs = [
            RaiseJob(number, "power_w", most[number], inf, tuple(parts[:, number]), motion, PROGRAMMES // len(low))
            for number in low
        ]
        return float(self.raised(bounds, jobs).min())

    def cost(self, lowest_w: float) -> float:
        """A lower bound of the cost: the least over parts of the ranges of power, from the least power, and flywheel.

        In each part the power and the flywheel are the least, and the flank load is a lower bound for all laws with at
        most the greatest power of the part.  The gears' volume has the least constant of all machines found.
        """
        choices = self.design.choices or Choices()
        parts = self._flywheel_parts()
        load = max(law.flank_load_n_mm for law in self.laws)
        highest = max(law.found.peak_power_w for law in self.laws)
        ends = np.geomspace(lowest_w, max(highest, lowest_w * 1.01), POWERS + 1)
        # A law of more power than all laws found costs at least its power
        caps = np.append(ends[1:], inf)
        count = parts.shape[1]
        power = np.repeat(caps, count)
        flywheel = np.tile(parts, caps.size)
        bounds = least_flank_load(self.sweeps, power, flywheel, np.full(power.size, load), share=0.05)
        constant = min(
            machine.figures.gear_volume_mm3 / (machine.figures.contact_share**2 * machine.figures.flank_load_n_mm)
            for machine in self.machines
        )
        return min(
            self._cost(choices, float(low), float(max(wheel, 0.0)), constant * float(bound))
            for low, bound, wheel in zip(np.repeat(ends, count), bounds, flywheel[0], strict=True)
        )

    def _cost(self, choices: Choices, power_w: float, flywheel_kg_mm2: float, volume_mm3: float) -> float:
        law = self.laws[0].found
        factor = min((material.cost_factor for material in choices.materials or ()), default=1.0)
        speed = self.task.speed_rad_s
        guess = guessed_figures(law, flywheel_kg_mm2, volume_mm3 * factor, speed)
        guess = replace(guess, peak_power_w=power_w, peak_torque_n_m=power_w / speed)
        return min(
            cost_of(choices, guess, motor_for(choices, guess), "", process) or 0.0 for process in choices.processes
        )


def machine_limit(machine: WholeMachine, bound_n_mm: float) -> MachineLimit:
    """The limit of a machine's gears that follows from a lower bound of the flank load of all laws."""
    has = machine.figures
    if not bound_n_mm > 0.0:
        return MachineLimit(0.0, inf, 0.0, inf)
    # For materials without figures for pitting, no gears' volume follows from the flank load
    pits = has.contact_share < inf
    volume = has.gear_volume_mm3 / has.contact_share**2 * bound_n_mm / has.flank_load_n_mm if pits else 0.0
    gap = has.gear_volume_mm3 / volume - 1.0 if volume > 0.0 else inf
    return MachineLimit(bound_n_mm, has.flank_load_n_mm / bound_n_mm - 1.0, volume, gap)


LIMITS = {
    "peak_acceleration_mm_s2": "peak_acceleration_mm_s2",
    "peak_acceleration_rad_s2": "peak_acceleration_mm_s2",
    "peak_speed_mm_s": "peak_speed_mm_s",
    "peak_speed_rad_s": "peak_speed_mm_s",
    "pressure_angle_deg": "pressure_angle_rad",
    **{name: name for name in LOAD_LIMITS},
}
"""Limits of a file that have a price, and their names in the wishes of a law."""

COUNTS = 5e-3
"""Least share of the motor or of the gears at which a price is told."""

CLOSE = 1.001
"""Ratio by which laws that are found again may miss the power of the machine."""


class WishPrice(NamedTuple):
    """Increase of motor and gears because of a wish or limit, as shares of the need without it."""

    key: str
    motor: float
    gears: float


@dataclass(frozen=True)
class NeededPower:
    """The least power in W, and the least flank load in N mm at the machine's power; infinite where none was found."""

    power_w: float
    flank_load_n_mm: float


def wish_keys(text: str) -> list[str]:
    """The keys of all hard wishes and limits of a design file that have a price."""
    design = parsed(text, Path("machine.yaml")).design
    given = (design.optimize or Optimize()).limits
    limits = [f"optimize.limits.{name}" for name in LIMITS if getattr(given, name) is not None]
    wishes = [wish.key for wish in law_wishes(law_design(design), None).motion if wish.hard]
    return [*dict.fromkeys(wishes), *limits, *(["optimize.limits.convex"] if given.convex else [])]


def _without(wishes: Wishes, key: str) -> Wishes:
    name = key.removeprefix("optimize.limits.")
    if name == "convex":
        return replace(wishes, convex=False)
    if name in LIMITS:
        free: dict[str, Any] = {LIMITS[name]: None}
        return replace(wishes, limits=replace(wishes.limits, **free))
    return replace(wishes, motion=tuple(wish for wish in wishes.motion if wish.key != key))


def needed_without(text: str, key: str) -> NeededPower:
    """The need of a machine without a wish; with an empty key, the need with all wishes."""
    from ncgear.optimum.makeable.law import kept_law

    design = parsed(text, Path("machine.yaml")).design
    made = law_design(design)
    task, wishes = task_of(made, inertia_as_given(made)), law_wishes(made, None)
    wishes = _without(wishes, key) if key else wishes
    cap = CLOSE * Drive(design).check.peak_power_w.value
    try:
        start = start_motion(task, wishes)
    except DesignError:
        return NeededPower(inf, inf)
    power = kept_law(task, replace(wishes, goal=Goal.POWER), start)
    starts = [start, *([power.motion] if power else [])]
    capped = replace(wishes, limits=replace(wishes.limits, peak_power_w=min(cap, wishes.limits.peak_power_w or cap)))
    flanks = [law for start in starts if (law := kept_law(task, capped, start)) is not None]
    load = min((figures(task, law.train(task.lobes)).flank_load_n_mm or inf for law in flanks), default=inf)
    watts = figures(task, power.train(task.lobes)).peak_power_w if power else inf
    return NeededPower(watts, load)


def wish_prices(
    machine: WholeMachine,
    on_law: Callable[[int, int], None],
    scheduler: str | None = None,
    processes: int | None = None,
) -> tuple[WishPrice, ...]:
    """The price of each wish and limit of a machine, the highest first; ``on_law`` takes numbers done and in all."""
    keys = ["", *wish_keys(machine.text)]
    found: dict[str, NeededPower] = {}
    for key, needed in finished(partial(needed_without, machine.text), keys, scheduler, processes):
        found[key] = needed
        on_law(len(found), len(keys))
    base = found.pop("")
    prices = [
        WishPrice(key, base.power_w / has.power_w - 1.0, base.flank_load_n_mm / has.flank_load_n_mm - 1.0)
        for key, has in found.items()
        if max(has.power_w, has.flank_load_n_mm) < inf
    ]
    told = [price for price in prices if max(price.motor, price.gears) > COUNTS]
    return tuple(sorted(told, key=lambda price: -max(price.motor, price.gears)))
