"""The motion of the toothed machine in time: two shafts that only their teeth join, by a solver for stiff equations.

The driving gear turns at a constant speed, or a motor with a flywheel turns it.  The state is (phi1, phi1', phi2,
phi2', work of the drive, losses of the teeth); the last two are integrated along with the motion for the balance of
energy.  The motion starts on the law under its load, or from rest.  The solver restarts at each dead centre, where the
resistance starts or ends, and at each narrow peak of the resistance, which its steps might pass over.
"""

from __future__ import annotations

from collections.abc import Callable
from enum import StrEnum
from functools import cached_property
from math import ceil, inf, pi
from typing import Protocol

import numpy as np

from ncgear.dynamics.crank_load import CLEAR_RAD, CrankLoad
from ncgear.dynamics.meshing import Meshing, ToothForces, TwoShafts
from ncgear.dynamics.place_by_place import StateByState
from ncgear.dynamics.quasi_static import loaded_contact
from ncgear.errors import NoSuchMechanism, Unanswered
from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array, Number, distinct, row_blocks
from ncgear.numerics.chebyshev import PiecewiseChebyshev, nodes, series
from ncgear.numerics.periodic_table import PeriodicTable, quintics
from ncgear.numerics.units import in_words
from ncgear.numerics.zeros import zeros_between
from ncgear.ratio.transmission import Piece, Transmission

INTERVALS = 2048
"""Intervals of the table in a period; quintics then miss the shipped laws by 1e-13 rad or less
(tests/test_periodic_table.py)."""


def law_table(transmission: Transmission) -> PeriodicTable:
    """The driven angle in rad over a period of the driving angle, exact with two derivatives at all joints."""
    lobes = transmission.lobes
    parts = [_piece(piece, lobes.driving_period_rad / INTERVALS) for piece in transmission.pieces]
    breaks = np.append(np.concatenate([knots[:-1] for knots, _ in parts]), lobes.driving_period_rad)
    return PeriodicTable(breaks, np.concatenate([table for _, table in parts], axis=1), lobes.driven_period_rad)


def _piece(piece: Piece, step_rad: float) -> tuple[Array, Array]:
    count = ceil((piece.end_rad - piece.start_rad) / step_rad) + 1
    knots = distinct(np.append(np.linspace(piece.start_rad, piece.end_rad, count), piece.knots_rad))
    angle = piece.driven_angle(knots, 2)
    values = [angle.value, angle.derivative(1), angle.derivative(2)]
    return knots, quintics(np.diff(knots), [value[:-1] for value in values], [value[1:] for value in values])


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
    """Forces of the teeth, torque of the drive, and the accelerations of both shafts, in n states or in one."""

    teeth: ToothForces
    torque_n_mm: Array
    acceleration1_rad_s2: Array
    acceleration2_rad_s2: Array


@dataclass(frozen=True, eq=False)
class ToothedMachine:
    """The drive, the teeth, and the load of the driven gear."""

    drive: DriveLine
    meshing: Meshing
    load: CrankLoad

    def answer(self, states: Array) -> InstantForces:
        """Forces and accelerations of the shafts in states of shape (6,) or (6, n)."""
        teeth = self.meshing.forces(TwoShafts(*states[:4]))
        acceleration1, torque = self.drive.answer(states[1], teeth.driving_n_mm.sum(axis=-1))
        acceleration2 = self.load.acceleration_rad_s2(states[2], states[3], teeth.driven_n_mm.sum(axis=-1))
        return InstantForces(teeth, torque, acceleration1, acceleration2)

    def stored_n_mm(self, states: Array) -> Array:
        """Kinetic and elastic energy plus the work on resistance and weights, shape (n,), in states of shape (6, n)."""
        teeth = self.meshing.forces(TwoShafts(*states[:4]))
        elastic = self.meshing.impact.energy_n_mm(teeth.depth_mm, teeth.near.stiffness).sum(axis=-1)
        driving = 0.5 * self.drive.inertia_n_mm_s2 * states[1] ** 2
        stored: Array = driving + self.load.energy_n_mm(states[2], states[3]) + elastic
        return stored


class Start(StrEnum):
    """How a motion starts: on the law, or at rest."""

    ON_LAW = "on_law"
    REST = "rest"


def law_torque_n_mm(load: CrankLoad, transmission: Transmission, phi1_rad: Array, speed_rad_s: float) -> Array:
    """Torque in N mm on the driven shaft when it keeps the law at a driving speed, shape (n,)."""
    angle = transmission.driven_angle(phi1_rad, 2)
    return load.torque_n_mm(angle.value, angle.derivative(1) * speed_rad_s, angle.derivative(2) * speed_rad_s**2)


def started(machine: ToothedMachine, transmission: Transmission, start: Start, speed_rad_s: float) -> Array:
    """The state at phi1 = 0, shape (6,).

    On the law both shafts have its speeds at the driving speed (not a motor's speed without load), and the load at that
    speed presses the teeth.  At rest both gears stand, the driven one on pushing flanks, until a motor starts them.
    """
    here = np.zeros(1)
    if start is Start.REST:
        pushing = float(machine.meshing.gaps.play_rad(here)[0][0])
        return np.array([0.0, 0.0, pushing, 0.0, 0.0, 0.0])
    torque = law_torque_n_mm(machine.load, transmission, here, speed_rad_s)
    ahead = loaded_contact(machine.meshing, here, torque, speed_rad_s).error_rad[0]
    ratio = float(transmission.driven_angle(here, 1).derivative(1)[0])
    return np.array([0.0, speed_rad_s, float(ahead), ratio * speed_rad_s, 0.0, 0.0])


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
    """A motion from time 0 on: solver steps at ``time_s`` (shape (n,)) in ``states`` (shape (6, n)).

    ``between`` are the polynomials that the solver follows the states by in its steps.
    """

    machine: ToothedMachine
    time_s: Array
    states: Array
    between: PiecewiseChebyshev

    def at(self, time_s: Array) -> Array:
        """States at times within the course, shape (m,), as (6, m)."""
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
    return 1e-2 * np.array([1.0, speed, 1.0, speed, work, work])


def _joined(machine: ToothedMachine, steps: list[_Step]) -> Course:
    """A course of steps; the first step is its start."""
    time_s, states = np.array([step.time_s for step in steps]), np.stack([step.state for step in steps], axis=1)
    inner = np.stack([step.inner for step in steps[1:]], axis=1)
    return Course(machine, time_s, states, PiecewiseChebyshev(time_s, series(inner)))


def _checked(found: Course) -> Course:
    """The course itself, if its energy balances and its teeth are no deeper in each other than the tables follow."""
    meshing, states = found.machine.meshing, found.at(found.fine_s)
    meshing.require_reach(states[0], states[2] - meshing.law.at(states[0])[0])
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
