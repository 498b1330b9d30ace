"""The motion of the toothed machine in time: shafts that only their teeth join, by a solver for stiff equations.

The driving gear turns at a constant speed, or a motor with a flywheel turns it.  The state is (phi1, phi1', phi2,
phi2', work of the drive, losses of the teeth), then angle and speed of each shaft between pairs in series, from the
driving shaft on; work and losses are integrated along with the motion for the balance of energy.  The motion starts on
the law under its load, or from rest.  The solver restarts at each dead centre, where the resistance starts or ends, and
at each narrow peak of the resistance, which its steps might pass over.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from enum import StrEnum
from functools import cached_property
from itertools import chain, pairwise
from math import inf, pi
from typing import Protocol

import numpy as np

from ncgear.dynamics.crank_load import CLEAR_RAD, CrankLoad
from ncgear.dynamics.meshing import Meshing, ToothForces, TwoShafts
from ncgear.dynamics.place_by_place import StateByState, TrainByState
from ncgear.dynamics.quasi_static import loaded_contact
from ncgear.errors import NoSuchMechanism, Unanswered
from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array, Number, row_blocks
from ncgear.numerics.chebyshev import PiecewiseChebyshev, nodes, series
from ncgear.numerics.units import in_words
from ncgear.numerics.zeros import zeros_between
from ncgear.ratio.transmission import Transmission, turned_after


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

    def pairs(self, states: Array) -> list[tuple[Meshing, TwoShafts]]:
        """Each pair, from the driving shaft on, with its own shafts in states of shape (6 + 2 between, ...)."""
        rows = [0, *range(6, len(states), 2), 2]
        return [
            (meshing, TwoShafts(*states[one : one + 2], *states[two : two + 2]))
            for meshing, (one, two) in zip((*self.before, self.meshing), pairwise(rows), strict=True)
        ]

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


class Start(StrEnum):
    """How a motion starts: on the law, or at rest."""

    ON_LAW = "on_law"
    REST = "rest"


def law_torque_n_mm(load: CrankLoad, transmission: Transmission, phi1_rad: Array, speed_rad_s: float) -> Array:
    """Torque in N mm on the driven shaft when it keeps the law at a driving speed, shape (n,)."""
    angle = transmission.driven_angle(phi1_rad, 2)
    return load.torque_n_mm(angle.value, angle.derivative(1) * speed_rad_s, angle.derivative(2) * speed_rad_s**2)


def started(
    machine: ToothedMachine,
    transmission: Transmission,
    start: Start,
    speed_rad_s: float,
    laws_before: Sequence[Transmission] = (),
) -> Array:
    """The state at phi1 = 0, shape (6 + 2 between,); ``laws_before`` are those of the pairs before the last.

    On the law all shafts have its speeds at the driving speed (not a motor's speed without load), and the load at that
    speed presses the teeth.  At rest all gears stand, the driven ones on pushing flanks, until a motor starts them.
    """
    here, resting = np.zeros(1), start is Start.REST
    turned = [*turned_after(laws_before, here, 2), transmission.driven_angle(here, 2)]
    torques = [law_torque_n_mm(machine.load, transmission, here, speed_rad_s)]
    for inertia, (one, two) in zip(machine.between_n_mm_s2[::-1], [*pairwise(turned)][::-1], strict=True):
        power = torques[0] * two.derivative(1) / one.derivative(1)
        torques.insert(0, power + inertia * one.derivative(2) * speed_rad_s**2)
    shafts = [(0.0, 0.0 if resting else speed_rad_s)]
    for meshing, torque in zip((*machine.before, machine.meshing), torques, strict=True):
        here, turning = np.array([shafts[-1][0]]), shafts[-1][1]
        angle, slope = meshing.law.at(here)
        if resting:
            ahead, slope = meshing.gaps.play_rad(here)[0], 0.0 * slope
        else:
            ahead = loaded_contact(meshing, here, torque, turning).error_rad
        shafts.append((float((angle + ahead)[0]), float(slope[0]) * turning))
    first, *between, last = shafts
    return np.array([*first, *last, 0.0, 0.0, *chain(*between)])


METHOD = "LSODA"
"""The stiff solver of scipy that has the least error in the same time (docs/speed-against-error.md)."""

ACCURACY = 1e-7
"""Relative error of a step: the published baler's slider is then at the right place to a micrometre after a turn."""

ENERGY = 1e-4
"""Share of the work done that the balance of energy may miss."""

BETWEEN = 1
"""Places looked at within each step of the solver, besides its ends: the top of a parabola is then met to a quarter of
its rise over the step, and closed in on from there.  Peaks of all designs are the same to 1e-10 with seven places."""

JUDGED = 0.618
"""Place in each step, as a share of it, where the balance of energy is tested."""

ON_RAD, MOST_STATES = 0.01, 20_000
"""Least advance of the driving gear within this many states of the solver.  Turning machines take some 300 states for
it; a machine that stands, or oscillates between its teeth, would take any number."""

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
    method: str = METHOD,
    on_turns: Callable[[float], None] = unheard,
) -> Course:
    """The motion from a state (shape (6,)) over ``turns`` of the driving gear, by one of scipy's solvers.

    ``on_turns`` receives the number of finished turns.  Raises NoSuchMechanism where the drive stalls, teeth are
    pressed too deep into each other, or energy does not balance, and Unanswered where the solver fails.
    """
    start_rad, target = float(state[0]), float(state[0]) + 2.0 * pi * turns
    change = _getting_on(machine, lambda phi1_rad: on_turns(min(turns, (phi1_rad - start_rad) / (2.0 * pi))))
    limit_s = SLOWEST * 2.0 * pi * turns / machine.drive.speed_rad_s
    steps = [_Step(0.0, state, np.empty((0, *state.shape)))]
    while steps[-1].state[0] < target - CLEAR_RAD:
        if steps[-1].time_s >= limit_s:
            late = f"{SLOWEST:g} times as long as it takes without load"
            raise _stalled(machine, limit_s, steps[-1].state, late)
        steps += _leg(machine, change, steps[-1], (limit_s, target), (accuracy, method))
    return _checked(_joined(machine, steps))


Change = Callable[[float, Array], Array]
"""Derivatives of a state by time, at a time and a state."""


def _getting_on(machine: ToothedMachine, on_way: Callable[[float], None]) -> Change:
    """The rate of a machine's states; it raises once the driving gear does not advance any more.

    ``on_way`` receives the driving angle as it advances.
    """
    furthest, looked_at, own = -inf, 0, StateByState(machine.drive.answer, machine.meshing, machine.load)
    if machine.before:
        own = TrainByState(machine.drive.answer, machine.meshing, machine.load, machine.before, machine.between_n_mm_s2)

    def change(time_s: float, state: Array) -> Array:
        nonlocal furthest, looked_at
        looked_at += 1
        if state[0] > furthest + ON_RAD:
            furthest, looked_at = float(state[0]), 0
            on_way(furthest)
        if looked_at > MOST_STATES:
            raise _stalled(machine, time_s, state, f"{MOST_STATES} states on one place")
        return own.change(state)

    return change


DEGREE = 12
"""Degree of the polynomials between the ends of steps: the highest order of LSODA, above those of scipy's others."""

SHARES = nodes(np.zeros(1), np.ones(1), DEGREE)[:, 0]
"""The nodes of these polynomials as shares of a step."""


@dataclass(frozen=True, eq=False)
class _Step:
    """The end of a step, its state (shape (6,)), and the states at the nodes of its polynomial, shape (13, 6)."""

    time_s: float
    state: Array
    inner: Array


def _leg(
    machine: ToothedMachine, change: Change, start: _Step, ends: tuple[float, float], how: tuple[float, str]
) -> list[_Step]:
    """The solver's steps up to the next stop of the load, or to the final time or driving angle."""
    from scipy import integrate

    (limit_s, target_rad), (accuracy, method) = ends, how
    stop_rad, way_rad = machine.load.next_stop_rad(float(start.state[2]))
    limits = {
        "rtol": accuracy,
        "atol": accuracy * _scales(machine),
        "max_step": way_rad / max(abs(float(start.state[3])), machine.drive.speed_rad_s),
    }
    solver = getattr(integrate, method)(change, start.time_s, start.state, limit_s, **limits)

    def beyond(states: Array) -> Array:
        passed: Array = np.maximum(states[0] - target_rad, states[2] - stop_rad)
        return passed

    steps, ended = [start], np.False_
    while solver.status == "running" and not ended:
        said, before_s = solver.step(), steps[-1].time_s
        if solver.status == "failed" and machine.meshing.stiffness_key:
            raise NoSuchMechanism(
                "the motion of teeth so stiff cannot be followed in time; a smaller stiffness is right",
                key=machine.meshing.stiffness_key,
            )
        if solver.status == "failed":
            raise Unanswered(f"the motion could not be integrated: {said}")
        between, end_s, state = solver.dense_output(), solver.t, solver.y
        ended = state[0] >= target_rad or state[2] >= stop_rad
        if ended:
            end_s = _first_s(beyond, between, before_s, end_s)
            state = between(end_s)
        # The polynomials of steps join up to the solver's error: the end may be that of the step before
        if end_s > before_s:
            steps.append(_Step(end_s, state, between(before_s + (end_s - before_s) * SHARES).T))
    return steps[1:]


def _first_s(
    beyond: Callable[[Array], Array], states: Callable[[Array], Array], before_s: float, after_s: float
) -> float:
    """When the states of a step get beyond its end: they are not yet there before, and are after, but for rounding."""

    def beyond_at(time_s: Array) -> Array:
        return beyond(states(time_s))

    low, high = np.array([before_s]), np.array([after_s])
    known = -np.abs(beyond_at(low)), np.abs(beyond_at(high))
    return float(zeros_between(beyond_at, low, high, known)[0])


def _scales(machine: ToothedMachine) -> Array:
    """Scales of small changes in each row of the state: a hundredth of a radian, of the speed, and of a turn's work."""
    speed = machine.drive.speed_rad_s
    moving = float(machine.load.energy_n_mm(np.array(0.0), np.array(speed)))
    work = max(moving, float(machine.load.table.at(2.0 * pi)[0][1]))
    return 1e-2 * np.array([1.0, speed, 1.0, speed, work, work, *[1.0, speed] * len(machine.before)])


def _joined(machine: ToothedMachine, steps: list[_Step]) -> Course:
    """A course of steps; the first step is its start."""
    time_s, states = np.array([step.time_s for step in steps]), np.stack([step.state for step in steps], axis=1)
    inner = np.stack([step.inner for step in steps[1:]], axis=1)
    return Course(machine, time_s, states, PiecewiseChebyshev(time_s, series(inner)))


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


def _stalled(machine: ToothedMachine, time_s: float, state: Array, after: str) -> NoSuchMechanism:
    driving, crank = (in_words(float(state[row])) for row in (0, 2))
    right = "more torque or a heavier flywheel is needed" if isinstance(machine.drive, Motor) else "softer teeth help"
    return NoSuchMechanism(
        f"the drive does not get on: after {time_s:.4g} s, {after}, it is at phi1 = {driving}, crank at {crank}; "
        f"{right}",
        key="simulation.motor" if isinstance(machine.drive, Motor) else "simulation",
    )
