"""The motion of the toothed machine in time: two shafts that only their teeth join, by a solver for stiff equations.

The driving gear turns at a speed that nothing changes, or a motor with a flywheel turns it.  The state is (phi1, phi1',
phi2, phi2', work of the drive, losses of the teeth); the last two are integrated along with the motion for the balance
of energy.  The motion starts on the law under its load, or from rest.  The solver starts anew at each dead centre,
where the resistance goes on or off, and about each narrow peak of it, which its steps might pass over.
"""

from __future__ import annotations

from collections.abc import Callable
from enum import StrEnum
from functools import cached_property
from math import ceil, inf, pi
from typing import Any, Protocol

import numpy as np

from ncgear.dynamics.crank_load import CrankLoad
from ncgear.dynamics.meshing import Meshing, ToothForces, TwoShafts
from ncgear.dynamics.quasi_static import loaded_contact
from ncgear.errors import NoSuchMechanism, Unanswered
from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array, distinct
from ncgear.numerics.periodic_table import PeriodicTable, quintics
from ncgear.numerics.units import in_words
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
        """Inertia of the driving shaft; 0 where nothing changes its speed."""
        ...

    @property
    def starting_rad_s(self) -> float:
        """Speed that the drive has where it is started from rest."""
        ...

    def answer(self, speed_rad_s: Array, moment_n_mm: Array) -> tuple[Array, Array]:
        """Acceleration of the driving shaft in rad/s^2, and torque of the drive in N mm."""
        ...


@dataclass(frozen=True)
class EvenDrive:
    """Turns at one speed, whatever torque that takes."""

    speed_rad_s: float
    inertia_n_mm_s2: float = 0.0

    @property
    def starting_rad_s(self) -> float:
        """Its one speed, from the first moment on."""
        return self.speed_rad_s

    def answer(self, speed_rad_s: Array, moment_n_mm: Array) -> tuple[Array, Array]:
        """No acceleration; the torque against the teeth's moment."""
        return 0.0 * moment_n_mm, -moment_n_mm


@dataclass(frozen=True)
class Motor:
    """Torque falls in a line from the stall torque at rest to nothing at ``speed_rad_s``, and brakes beyond it.

    ``inertia_n_mm_s2`` is that of the whole driving shaft, flywheel and driving gear included.
    """

    speed_rad_s: float
    stall_torque_n_mm: float
    inertia_n_mm_s2: float

    @property
    def starting_rad_s(self) -> float:
        """0: a motor starts from rest."""
        return 0.0

    def answer(self, speed_rad_s: Array, moment_n_mm: Array) -> tuple[Array, Array]:
        """Acceleration by the motor's torque and the teeth's moment together; the motor's torque."""
        torque = self.stall_torque_n_mm * (1.0 - speed_rad_s / self.speed_rad_s)
        return (torque + moment_n_mm) / self.inertia_n_mm_s2, torque


@dataclass(frozen=True, eq=False)
class Answer:
    """Forces of the teeth, torque of the drive, and the accelerations of both shafts, in n states or in one."""

    teeth: ToothForces
    torque_n_mm: Array
    acceleration1_rad_s2: Array
    acceleration2_rad_s2: Array


@dataclass(frozen=True, eq=False)
class ToothedMachine:
    """What turns the driving gear, the teeth, and what the driven gear turns."""

    drive: DriveLine
    meshing: Meshing
    load: CrankLoad

    def change(self, _time_s: float, state: Array) -> Array:
        """Derivatives of a state by time, shape (6,)."""
        answer = self.answer(state)
        power, loss = answer.torque_n_mm * state[1], answer.teeth.loss_n_mm_s.sum(axis=-1)
        return np.array([state[1], answer.acceleration1_rad_s2, state[3], answer.acceleration2_rad_s2, power, loss])

    def answer(self, states: Array) -> Answer:
        """What moves and holds the shafts in states of shape (6,) or (6, n)."""
        teeth = self.meshing.forces(TwoShafts(*states[:4]))
        acceleration1, torque = self.drive.answer(states[1], teeth.driving_n_mm.sum(axis=-1))
        acceleration2 = self.load.acceleration_rad_s2(states[2], states[3], teeth.driven_n_mm.sum(axis=-1))
        return Answer(teeth, torque, acceleration1, acceleration2)

    def stored_n_mm(self, states: Array) -> Array:
        """Kinetic and elastic energy, and what resistance and weights took, shape (n,), in states of shape (6, n)."""
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
    """Torque in N mm that the driven shaft takes where it keeps the law at a driving speed, shape (n,)."""
    angle = transmission.driven_angle(phi1_rad, 2)
    return load.torque_n_mm(angle.value, angle.derivative(1) * speed_rad_s, angle.derivative(2) * speed_rad_s**2)


def started(machine: ToothedMachine, transmission: Transmission, start: Start, speed_rad_s: float) -> Array:
    """The state at phi1 = 0, shape (6,).

    On the law both shafts have its speeds at the driving speed, whatever speed a motor has without load, and the teeth
    are pressed as deep as the load at that speed asks.  At rest the driven gear stands on pushing flanks, and so does
    the driving gear if a motor starts it; a drive of one speed has that speed from the start.
    """
    here = np.zeros(1)
    if start is Start.REST:
        pushing = float(machine.meshing.gaps.play_rad(here)[0][0])
        return np.array([0.0, machine.drive.starting_rad_s, pushing, 0.0, 0.0, 0.0])
    torque = law_torque_n_mm(machine.load, transmission, here, speed_rad_s)
    ahead = loaded_contact(machine.meshing, here, torque, speed_rad_s).error_rad[0]
    ratio = float(transmission.driven_angle(here, 1).derivative(1)[0])
    return np.array([0.0, speed_rad_s, float(ahead), ratio * speed_rad_s, 0.0, 0.0])


def passing(row: int, angle_rad: float) -> Callable[[float, Array], float]:
    """An event that ends a leg as the solver wants it: an angle of the state rises through a value."""

    def beyond(_time_s: float, state: Array) -> float:
        return float(state[row]) - angle_rad

    beyond.terminal, beyond.direction = True, 1.0  # type: ignore[attr-defined]
    return beyond


METHOD = "LSODA"
"""The stiff solver of scipy that has the least error in the same time (docs/speed-against-error.md)."""

ACCURACY = 1e-7
"""Relative error of a step: the published baler's slider is then at the right place to a micrometre after a turn."""

ENERGY = 1e-4
"""Share of the work done that the balance of energy may miss."""

BETWEEN = 3
"""Places looked at within each step of the solver, besides its ends: the top of a parabola is then met to a sixteenth
of its rise over the step, and closed in on from there."""

JUDGED = 0.618
"""Share of each step at which the balance of energy is taken."""

ON_RAD, MOST_STATES = 0.01, 20_000
"""Angle by which the driving gear must get on within so many states that the solver looks at.  Machines that turn take
some 300; one that stands, or trembles between its teeth, takes as many as it is given."""

SLOWEST = 20.0
"""The drive must get round in this many times the time that it takes without load."""


@dataclass(frozen=True, eq=False)
class Course:
    """A motion from time 0 on: solver steps at ``time_s`` (shape (n,)) in ``states`` (shape (6, n)).

    ``legs`` are the starts of the solver's runs from stop to stop of the load, with the states between their steps.
    """

    machine: ToothedMachine
    time_s: Array
    states: Array
    legs: tuple[tuple[float, Callable[[Array], Array]], ...]

    def at(self, time_s: Array) -> Array:
        """States at times within the course, shape (m,), as (6, m)."""
        number = np.searchsorted([start for start, _ in self.legs], time_s, side="right") - 1
        states = np.empty((self.states.shape[0], time_s.size))
        for leg in np.unique(number):
            states[:, number == leg] = self.legs[leg][1](time_s[number == leg])
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
        """The driving angle at which the balance of energy is missed by most."""
        return self._imbalance[1]

    @cached_property
    def _imbalance(self) -> tuple[float, float]:
        """The largest imbalance and its driving angle, from states at which neither the solver nor the peaks look."""
        judged = self.at(self.time_s[:-1] + JUDGED * np.diff(self.time_s))
        before = float(self.machine.stored_n_mm(self.states[:, :1])[0])
        gained, work, loss = self.machine.stored_n_mm(judged) - before, judged[4], judged[5]
        most = max(float(np.abs(work).max()), float(loss.max()), float(np.ptp(gained)))
        missed = np.abs(work - loss - gained)
        worst = int(np.argmax(missed))
        return float(missed[worst]) / most if most else 0.0, float(judged[0, worst])


def course(
    machine: ToothedMachine, state: Array, turns: float, accuracy: float = ACCURACY, method: str = METHOD
) -> Course:
    """The motion from a state (shape (6,)) over ``turns`` of the driving gear, by one of scipy's solvers.

    Raises NoSuchMechanism where the drive does not get round or on, teeth are pressed too deep into each other, or
    energy does not balance, and Unanswered where the solver fails.
    """
    change = _getting_on(machine)
    target = float(state[0]) + 2.0 * pi * turns
    limit_s = SLOWEST * 2.0 * pi * turns / machine.drive.speed_rad_s
    legs: list[Any] = []
    time_s = 0.0
    while True:
        leg = _leg(machine, change, (time_s, limit_s), state, target, (accuracy, method))
        legs.append(leg)
        time_s, state = float(leg.t[-1]), leg.y[:, -1]
        if leg.status == 0:
            raise _stalled(machine, time_s, state, f"{SLOWEST:g} times as long as it takes without load")
        if leg.t_events[0].size:
            return _checked(_joined(machine, legs))


Change = Callable[[float, Array], Array]
"""Derivatives of a state by time, at a time and a state."""


def _getting_on(machine: ToothedMachine) -> Change:
    """The change of a machine's states, which is no longer told once its driving gear does not get on."""
    furthest, looked_at = -inf, 0

    def change(time_s: float, state: Array) -> Array:
        nonlocal furthest, looked_at
        looked_at += 1
        if state[0] > furthest + ON_RAD:
            furthest, looked_at = float(state[0]), 0
        if looked_at > MOST_STATES:
            raise _stalled(machine, time_s, state, f"{MOST_STATES} states on one place")
        return machine.change(time_s, state)

    return change


def _leg(
    machine: ToothedMachine,
    change: Change,
    span_s: tuple[float, float],
    state: Array,
    target_rad: float,
    how: tuple[float, str],
) -> Any:
    """The solver's answer up to the next stop of the load, or to the end of the course."""
    from scipy.integrate import solve_ivp

    stop_rad, way_rad = machine.load.next_stop_rad(float(state[2]))
    events = passing(0, target_rad), passing(2, stop_rad)
    accuracy, method = how
    limits = {
        "rtol": accuracy,
        "atol": accuracy * _scales(machine),
        "max_step": way_rad / max(abs(float(state[3])), machine.drive.speed_rad_s),
    }
    leg = solve_ivp(change, span_s, state, method, dense_output=True, events=events, **limits)
    if leg.status < 0 and machine.meshing.stiffness_key:
        raise NoSuchMechanism(
            "the motion of teeth so stiff cannot be followed in time; a smaller stiffness is right",
            key=machine.meshing.stiffness_key,
        )
    if leg.status < 0:
        raise Unanswered(f"the motion could not be integrated: {leg.message}")
    return leg


def _scales(machine: ToothedMachine) -> Array:
    """What counts as small in each row of the state: a hundredth of a radian, of the speed, and of a turn's work."""
    speed = machine.drive.speed_rad_s
    moving = float(machine.load.energy_n_mm(np.array(0.0), np.array(speed)))
    work = max(moving, float(machine.load.table.at(2.0 * pi)[0][1]))
    return 1e-2 * np.array([1.0, speed, 1.0, speed, work, work])


def _joined(machine: ToothedMachine, legs: list[Any]) -> Course:
    """Legs end to end; a leg's first state is the last one of the leg before."""
    time_s = np.concatenate([legs[0].t[:1], *(leg.t[1:] for leg in legs)])
    states = np.concatenate([legs[0].y[:, :1], *(leg.y[:, 1:] for leg in legs)], axis=1)
    return Course(machine, time_s, states, tuple((float(leg.t[0]), leg.sol) for leg in legs))


def _checked(found: Course) -> Course:
    """The course itself, if its energy balances and its teeth are no deeper in each other than the tables follow."""
    meshing, states = found.machine.meshing, found.at(found.fine_s)
    meshing.require_reach(states[0], states[2] - meshing.law.at(states[0])[0])
    if not found.energy_error <= ENERGY:
        raise _unbalanced(found)
    return found


def _unbalanced(found: Course) -> NoSuchMechanism:
    return NoSuchMechanism(
        f"the motion cannot be followed: its energy misses {found.energy_error:.3g} of the work at phi1 = "
        f"{in_words(found.least_balanced_rad)}, and {ENERGY:g} is the most that counts as right; softer teeth (a "
        "smaller stiffness_n_mm), more damping_n_s_mm, or fewer turns are needed",
        key="simulation",
    )


def _stalled(machine: ToothedMachine, time_s: float, state: Array, after: str) -> NoSuchMechanism:
    driving, crank = (in_words(float(state[row])) for row in (0, 2))
    right = "more torque or a heavier flywheel is needed" if isinstance(machine.drive, Motor) else "softer teeth help"
    return NoSuchMechanism(
        f"the drive does not get on: after {time_s:.4g} s, {after}, it is at phi1 = {driving}, crank at {crank}; "
        f"{right}",
        key="simulation.motor" if isinstance(machine.drive, Motor) else "simulation",
    )
