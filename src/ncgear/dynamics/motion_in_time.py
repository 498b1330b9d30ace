"""The motion of the toothed machine in time: shafts that only their teeth join, stiff springs or none.

The driving gear turns at a constant speed, or a motor with a flywheel turns it.  The state is (phi1, phi1', phi2,
phi2', work of the drive, losses of the teeth), then angle and speed of each shaft between pairs in series, from the
driving shaft on; work and losses follow from the motion for the balance of energy.  A step ends at each dead centre,
where the resistance starts or ends, and at each narrow peak of the resistance, which steps might pass over.  The spring
of a single pair of straight teeth swings in closed form in a step; pairs in series, of which several swing at once, and
helical teeth, of which another section begins or ends to touch every few steps, are followed by a solver for any stiff
equations.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property
from itertools import pairwise
from math import inf, pi
from typing import Protocol

import numpy as np

from ncgear.dynamics.crank_load import CLEAR_RAD, CrankLoad
from ncgear.dynamics.meshing import Meshing, ToothForces, TwoShafts
from ncgear.dynamics.place_by_place import StateByState, TrainByState
from ncgear.dynamics.trains_in_time import TrainStep, train_steps
from ncgear.errors import NoSuchMechanism
from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array, Number, row_blocks
from ncgear.numerics.chebyshev import PiecewiseChebyshev, nodes, series
from ncgear.numerics.oscillator_steps import Pulled, Stepped, joined, steps
from ncgear.numerics.units import in_words


class DriveLine(Protocol):
    """Answers a moment of the teeth in N mm at a driving speed in rad/s."""

    @property
    def speed_rad_s(self) -> float:
        """Speed without load."""
        ...

    @property
    def inertia_n_mm_s2(self) -> float:
        """Inertia of the driving shaft; 0 for a constant speed."""
        ...

    def answer(self, speed_rad_s: Number, moment_n_mm: Number) -> tuple[Number, Number]:
        """Acceleration of the driving shaft in rad/s^2, and torque of the drive in N mm."""
        ...


@dataclass(frozen=True)
class EvenDrive:
    """A drive with a constant speed at any torque."""

    speed_rad_s: float
    inertia_n_mm_s2: float = 0.0

    def answer(self, speed_rad_s: Number, moment_n_mm: Number) -> tuple[Number, Number]:
        """No acceleration; the torque against the teeth's moment."""
        return 0.0 * moment_n_mm, -moment_n_mm


@dataclass(frozen=True)
class Motor:
    """A motor whose torque falls linearly from the stall torque at rest to 0 at ``speed_rad_s``, and brakes beyond it.

    ``inertia_n_mm_s2`` is the inertia of the whole driving shaft, including flywheel and driving gear.
    """

    speed_rad_s: float
    stall_torque_n_mm: float
    inertia_n_mm_s2: float

    def answer(self, speed_rad_s: Number, moment_n_mm: Number) -> tuple[Number, Number]:
        """Acceleration by the motor's torque and the teeth's moment together; the motor's torque."""
        torque = self.stall_torque_n_mm * (1.0 - speed_rad_s / self.speed_rad_s)
        return (torque + moment_n_mm) / self.inertia_n_mm_s2, torque


@dataclass(frozen=True, eq=False)
class InstantForces:
    """Forces of the teeth, torque of the drive, and the accelerations of both shafts, in n states or in one.

    ``teeth`` are those of each pair, from the driving shaft on.
    """

    teeth: tuple[ToothForces, ...]
    torque_n_mm: Array
    acceleration1_rad_s2: Array
    acceleration2_rad_s2: Array


@dataclass(frozen=True, eq=False)
class ToothedMachine:
    """The drive, the teeth, and the load of the driven gear.

    Of pairs in series ``meshing`` is the last, ``before`` are those before it from the driving shaft on, and
    ``between_n_mm_s2`` the inertias of the shafts that these turn.
    """

    drive: DriveLine
    meshing: Meshing
    load: CrankLoad
    before: tuple[Meshing, ...] = ()
    between_n_mm_s2: tuple[float, ...] = ()

    @property
    def rows(self) -> list[int]:
        """The rows of a state with the angle and the speed of each shaft, from the driving shaft on."""
        return [0, 1, *range(6, 6 + 2 * len(self.before)), 2, 3]

    def pairs(self, states: Array) -> list[tuple[Meshing, TwoShafts]]:
        """Each pair, from the driving shaft on, with its own shafts in states of shape (6 + 2 between, ...)."""
        shafts = [states[row : row + 2] for row in self.rows[::2]]
        meshings = (*self.before, self.meshing)
        return [(teeth, TwoShafts(*ends[0], *ends[1])) for teeth, ends in zip(meshings, pairwise(shafts), strict=True)]

    def law_rad(self, phi1_rad: Array) -> Array:
        """The law's angle of the last driven gear at driving angles, of any shape."""
        angle = phi1_rad
        for meshing in (*self.before, self.meshing):
            angle = meshing.law.at(angle)[0]
        return angle

    def answer(self, states: Array) -> InstantForces:
        """Forces and accelerations of the shafts in states of shape (rows,) or (rows, n)."""
        teeth = tuple(meshing.forces(shafts) for meshing, shafts in self.pairs(states))
        acceleration1, torque = self.drive.answer(states[1], teeth[0].driving_n_mm.sum(axis=-1))
        acceleration2 = self.load.acceleration_rad_s2(states[2], states[3], teeth[-1].driven_n_mm.sum(axis=-1))
        return InstantForces(teeth, torque, acceleration1, acceleration2)

    def stored_n_mm(self, states: Array) -> Array:
        """Kinetic and elastic energy plus the work on resistance and weights, shape (n,), in states (rows, n)."""
        stored = 0.5 * self.drive.inertia_n_mm_s2 * states[1] ** 2 + self.load.energy_n_mm(states[2], states[3])
        for inertia, speed in zip(self.between_n_mm_s2, states[7::2], strict=True):
            stored = stored + 0.5 * inertia * speed**2
        for meshing, shafts in self.pairs(states):
            teeth = meshing.forces(shafts)
            stored = stored + meshing.impact.energy_n_mm(teeth.depth_mm, teeth.near.stiffness).sum(axis=-1)
        return np.asarray(stored)


ACCURACY = 3e-7
"""Error of a step as a share of the speed of the shafts.  Largest forces of the shipped machines are then those of an
explicit method of order 8 at 1e-10 to 4e-4, but for knocks that follow many others."""

ENERGY = 1e-4
"""Share of the work done that the balance of energy may miss."""

BETWEEN = 1
"""Places looked at within each step of the solver, besides its ends: the top of a parabola is then met to a quarter of
its rise over the step, and closed in on from there.  Peaks of all designs are the same to 1e-10 with seven places."""

JUDGED = 0.618
"""Place in each step, as a share of it, where the balance of energy is tested."""

ON_RAD, MOST_STEPS = 0.01, 5_000
"""Least advance of the driving gear within this many steps, taken or tried.  Turning machines take some 50 steps for
it; a machine that stands, or oscillates between its teeth, would take any number."""

FIRST_RAD = 1e-6
"""The way of the driving gear at its speed without load in the first step that is tried."""

LEAST_SPEED = 0.01
"""Speed, as a share of the drive's, below which errors of a step are not measured by the speed of the shafts."""

NEARLY = 0.99
"""Share of the way to a stop that a step goes at most at its first speed, so that none leads beyond."""

SLOWEST = 20.0
"""The drive must get round in this many times the time that it takes without load."""


@dataclass(frozen=True, eq=False)
class Course:
    """A motion from time 0 on: solver steps at ``time_s`` (shape (n,)) in ``states`` (shape (rows, n)).

    ``between`` are the polynomials that the solver follows the states by in its steps.
    """

    machine: ToothedMachine
    time_s: Array
    states: Array
    between: PiecewiseChebyshev

    def at(self, time_s: Array) -> Array:
        """States at times within the course, shape (m,), as (rows, m)."""
        states = np.empty((self.states.shape[0], time_s.size))
        for rows in row_blocks(time_s.size):
            states[:, rows] = self.between(time_s[rows]).T
        # Interpolation meets the first state only up to rounding, so that a machine at rest would seem to move.
        states[:, time_s == self.time_s[0]] = self.states[:, :1]
        return states

    @property
    def fine_s(self) -> Array:
        """The times of the steps and of BETWEEN places within each step, rising."""
        shares = np.arange(BETWEEN + 1) / (BETWEEN + 1)
        within = self.time_s[:-1, None] + np.diff(self.time_s)[:, None] * shares
        return np.append(within.ravel(), self.time_s[-1])

    @cached_property
    def energy_error(self) -> float:
        """Largest imbalance of energy within any step, as a share of the most that was worked, lost or stored."""
        return self._imbalance[0]

    @property
    def least_balanced_rad(self) -> float:
        """The driving angle of the largest error of the energy balance."""
        return self._imbalance[1]

    @cached_property
    def _imbalance(self) -> tuple[float, float]:
        """The largest imbalance and its driving angle, from states that neither the solver nor the peaks use."""
        judged = self.at(self.time_s[:-1] + JUDGED * np.diff(self.time_s))
        before = float(self.machine.stored_n_mm(self.states[:, :1])[0])
        gained, work, loss = self.machine.stored_n_mm(judged) - before, judged[4], judged[5]
        most = max(float(np.abs(work).max()), float(loss.max()), float(np.ptp(gained)))
        missed = np.abs(work - loss - gained)
        worst = int(np.argmax(missed))
        return float(missed[worst]) / most if most else 0.0, float(judged[0, worst])


def unheard(_done: float) -> None:
    """Report progress to nobody."""


def course(
    machine: ToothedMachine,
    state: Array,
    turns: float,
    accuracy: float = ACCURACY,
    on_turns: Callable[[float], None] = unheard,
) -> Course:
    """The motion from a state (shape (6 + 2 between,)) over ``turns`` of the driving gear.

    ``on_turns`` receives the number of finished turns.  Raises NoSuchMechanism where the drive stalls, teeth are
    pressed too deep into each other, or energy does not balance.
    """
    goes_on, target_rad = _watch(machine, float(state[0]), turns, on_turns), float(state[0]) + 2.0 * pi * turns
    followed = _train if machine.before or machine.meshing.gaps.sections > 1 else _pair
    return _checked(_with_work(machine, state, *followed(machine, state[machine.rows], target_rad, accuracy, goes_on)))


GoesOn = Callable[[float, complex], bool]
"""Tells at a time and the angles of the driving gear (real part) and of the crank whether a motion is to go on."""


def _watch(machine: ToothedMachine, begin_rad: float, turns: float, on_turns: Callable[[float], None]) -> GoesOn:
    """Asked after each step, taken or tried, it raises once the driving gear does not get on any more."""
    limit_s, target_rad = SLOWEST * 2.0 * pi * turns / machine.drive.speed_rad_s, begin_rad + 2.0 * pi * turns
    tried, furthest_rad = 0, begin_rad

    def goes_on(time_s: float, place: complex) -> bool:
        nonlocal tried, furthest_rad
        tried += 1
        if place.real > furthest_rad + ON_RAD:
            furthest_rad, tried = place.real, 0
            on_turns(min(turns, (furthest_rad - begin_rad) / (2.0 * pi)))
        if place.real >= target_rad - CLEAR_RAD:
            return False
        if tried > MOST_STEPS:
            raise _stalled(machine, time_s, place, f"{MOST_STEPS} steps on one place")
        if time_s >= limit_s:
            raise _stalled(machine, time_s, place, f"{SLOWEST:g} times as long as it takes without load")
        return True

    return goes_on


Followed = tuple[Array, Array, Array]
"""Times of steps, shape (n + 1,), angles and speeds of all shafts then, shape (rows, n + 1), and their polynomials."""


def _train(machine: ToothedMachine, shafts: Array, target_rad: float, accuracy: float, goes_on: GoesOn) -> Followed:
    """Pairs in series or helical teeth, from the angles and the speeds of all shafts."""
    own = TrainByState(machine.drive.answer, machine.meshing, machine.load, machine.before, machine.between_n_mm_s2)
    ends, found = (machine.drive.speed_rad_s, target_rad), [TrainStep(0.0, shafts, shafts)]
    for step in train_steps(own.change, machine.load, shafts, ends, accuracy):
        found.append(step)
        if not goes_on(step.time_s, complex(*step.shafts[[0, -2]])):
            break
    else:
        last = found[-1]
        raise _stalled(machine, last.time_s, complex(*last.shafts[[0, -2]]), "steps too narrow to count")
    every_s, at_ends, inner = zip(*found, strict=True)
    return np.array(every_s), np.stack(at_ends, axis=1), series(np.stack(inner[1:], axis=1))


def _pair(machine: ToothedMachine, shafts: Array, target_rad: float, accuracy: float, goes_on: GoesOn) -> Followed:
    """A single pair, from the angles and the speeds of both shafts."""
    begin, speed = complex(shafts[0], shafts[2]), complex(shafts[1], shafts[3])
    own = StateByState(machine.drive.answer, machine.drive.inertia_n_mm_s2, machine.meshing, machine.load)
    even_rad_s, time_s = machine.drive.speed_rad_s, 0.0
    start, found = Pulled(begin, speed, own.pull(begin, speed)), list[Stepped]()
    now = start

    def allowed(speed: complex) -> float:
        return accuracy * (LEAST_SPEED * even_rad_s + abs(speed))

    for step in steps(own.pull, start, FIRST_RAD / even_rad_s, _most_s(machine, target_rad), allowed):
        if step is not None:
            now, time_s = step.end, time_s + step.width
            found.append(step)
        if not goes_on(time_s, now.place):
            break
    return joined(start, found)


def _most_s(machine: ToothedMachine, target_rad: float) -> Callable[[Pulled], float]:
    """How long a step may be: up to a driving angle, or to the next stop of the load."""
    even_rad_s, stop_rad, way_rad = machine.drive.speed_rad_s, -inf, inf
    # Teeth that come and go within a step would not be seen
    place_rad = float(np.diff(machine.meshing.gaps.table.breaks).max())

    def most_s(now: Pulled) -> float:
        nonlocal stop_rad, way_rad
        if now.place.imag > stop_rad - CLEAR_RAD:
            stop_rad, way_rad = machine.load.next_stop_rad(now.place.imag)
        most = way_rad / max(abs(now.speed.imag), even_rad_s)
        if now.speed.imag > 0.0:
            most = min(most, max(NEARLY * (stop_rad - now.place.imag), CLEAR_RAD) / now.speed.imag)
        if now.speed.real > 0.0:
            most = min(most, min(place_rad, target_rad - now.place.real) / now.speed.real)
        return most

    return most_s


RATES = 5
"""Degree of the polynomials of the powers of the drive and of the teeth within a step."""


def _with_work(machine: ToothedMachine, state: Array, time_s: Array, shafts: Array, moved: Array) -> Course:
    """The course of shafts from a state, with the work of the drive and the losses of the teeth."""
    states, between = np.empty((state.size, time_s.size)), np.zeros((*moved.shape[:2], state.size))
    states[machine.rows], between[..., machine.rows] = shafts, moved
    powers = _powers(machine, PiecewiseChebyshev(time_s, between), nodes(time_s[:-1], time_s[1:], RATES))
    for row, power in enumerate(powers, 4):
        work = PiecewiseChebyshev(time_s, series(power)).integrated().coefficients
        between[: len(work), :, row] = work
        between[0, :, row] += state[row]
        states[row] = np.append(state[row], between[..., row].sum(axis=0))
    return Course(machine, time_s, states, PiecewiseChebyshev(time_s, between))


def _powers(machine: ToothedMachine, moving: PiecewiseChebyshev, time_s: Array) -> Array:
    """Powers of the drive and of all teeth at times of shape (m, n), shape (2, m, n)."""
    powers = np.empty((2, time_s.size))
    for rows in row_blocks(time_s.size):
        states = moving(time_s.ravel()[rows]).T
        answer = machine.answer(states)
        powers[0, rows] = answer.torque_n_mm * states[1]
        powers[1, rows] = np.sum([teeth.loss_n_mm_s.sum(axis=-1) for teeth in answer.teeth], axis=0)
    return powers.reshape(2, *time_s.shape)


def _checked(found: Course) -> Course:
    """The course itself, if its energy balances and its teeth are no deeper in each other than the tables follow."""
    for meshing, shafts in found.machine.pairs(found.at(found.fine_s)):
        phi1 = np.asarray(shafts.phi1_rad)
        meshing.require_reach(phi1, shafts.phi2_rad - meshing.law.at(phi1)[0])
    if not found.energy_error <= ENERGY:
        raise NoSuchMechanism(
            f"the motion cannot be followed: its energy misses {found.energy_error:.3g} of the work at phi1 = "
            f"{in_words(found.least_balanced_rad)}, and {ENERGY:g} is the most that counts as right; softer teeth (a "
            "smaller stiffness_n_mm), more damping_n_s_mm, or fewer turns are needed",
            key="simulation",
        )
    return found


def _stalled(machine: ToothedMachine, time_s: float, place: complex, after: str) -> NoSuchMechanism:
    driving, crank = in_words(place.real), in_words(place.imag)
    moved = isinstance(machine.drive, Motor)
    right = "more torque or a heavier flywheel is needed" if moved else "softer teeth or less damping help"
    return NoSuchMechanism(
        f"the drive does not get on: after {time_s:.4g} s, {after}, it is at phi1 = {driving}, crank at {crank}; "
        f"{right}",
        key="simulation.motor" if moved else "simulation",
    )
