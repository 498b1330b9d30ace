"""The motion of the toothed machine in time: two shafts that only their teeth join, a stiff spring or none.

The driving gear turns at a constant speed, or a motor with a flywheel turns it.  The state is (phi1, phi1', phi2,
phi2', work of the drive, losses of the teeth); the last two follow from the motion for the balance of energy.  The
motion starts on the law under its load, or from rest.  A step ends at each dead centre, where the resistance starts or
ends, and at each narrow peak of the resistance, which steps might pass over.
"""

from __future__ import annotations

from collections.abc import Callable
from enum import StrEnum
from functools import cached_property
from math import ceil, inf, pi
from typing import Protocol

import numpy as np
from numpy.polynomial import chebyshev

from ncgear.dynamics.crank_load import CLEAR_RAD, CrankLoad
from ncgear.dynamics.meshing import Meshing, ToothForces, TwoShafts
from ncgear.dynamics.place_by_place import StateByState
from ncgear.dynamics.quasi_static import loaded_contact
from ncgear.errors import NoSuchMechanism
from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array, Number, distinct, row_blocks
from ncgear.numerics.chebyshev import PiecewiseChebyshev, nodes, series
from ncgear.numerics.oscillator_steps import Pulled, Stepped, steps
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
        """Inertia of the driving shaft; 0 for a constant speed."""
        ...

    @property
    def starting_rad_s(self) -> float:
        """Speed of the drive at a start from rest."""
        ...

    def answer(self, speed_rad_s: Number, moment_n_mm: Number) -> tuple[Number, Number]:
        """Acceleration of the driving shaft in rad/s^2, and torque of the drive in N mm."""
        ...


@dataclass(frozen=True)
class EvenDrive:
    """A drive with a constant speed at any torque."""

    speed_rad_s: float
    inertia_n_mm_s2: float = 0.0

    @property
    def starting_rad_s(self) -> float:
        """Its constant speed, from the first moment on."""
        return self.speed_rad_s

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

    @property
    def starting_rad_s(self) -> float:
        """0: a motor starts from rest."""
        return 0.0

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
    speed presses the teeth.  At rest the driven gear stands on pushing flanks; the driving gear stands too if a motor
    starts it, and a drive of constant speed has that speed from the start.
    """
    here = np.zeros(1)
    if start is Start.REST:
        pushing = float(machine.meshing.gaps.play_rad(here)[0][0])
        return np.array([0.0, machine.drive.starting_rad_s, pushing, 0.0, 0.0, 0.0])
    torque = law_torque_n_mm(machine.load, transmission, here, speed_rad_s)
    ahead = loaded_contact(machine.meshing, here, torque, speed_rad_s).error_rad[0]
    ratio = float(transmission.driven_angle(here, 1).derivative(1)[0])
    return np.array([0.0, speed_rad_s, float(ahead), ratio * speed_rad_s, 0.0, 0.0])


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
    on_turns: Callable[[float], None] = unheard,
) -> Course:
    """The motion from a state (shape (6,)) over ``turns`` of the driving gear.

    ``on_turns`` receives the number of finished turns.  Raises NoSuchMechanism where the drive stalls, teeth are
    pressed too deep into each other, or energy does not balance.
    """
    begin, target_rad = complex(state[0], state[2]), float(state[0]) + 2.0 * pi * turns
    own = StateByState(machine.drive.answer, machine.drive.inertia_n_mm_s2, machine.meshing, machine.load)
    even_rad_s, speed = machine.drive.speed_rad_s, complex(state[1], state[3])
    limit_s, time_s, tried, furthest_rad = SLOWEST * 2.0 * pi * turns / even_rad_s, 0.0, 0, begin.real
    start, found = Pulled(begin, speed, own.pull(begin, speed)), list[Stepped]()
    now = start

    def allowed(speed: complex) -> float:
        return accuracy * (LEAST_SPEED * even_rad_s + abs(speed))

    for step in steps(own.pull, start, FIRST_RAD / even_rad_s, _most_s(machine, target_rad), allowed):
        tried += 1
        if step is not None:
            now, time_s = step.end, time_s + step.width
            found.append(step)
        if now.place.real >= target_rad - CLEAR_RAD:
            break
        if now.place.real > furthest_rad + ON_RAD:
            furthest_rad, tried = now.place.real, 0
            on_turns(min(turns, (furthest_rad - begin.real) / (2.0 * pi)))
        if tried > MOST_STEPS:
            raise _stalled(machine, time_s, now.place, f"{MOST_STEPS} steps on one place")
        if time_s >= limit_s:
            raise _stalled(machine, time_s, now.place, f"{SLOWEST:g} times as long as it takes without load")
    return _checked(_joined(machine, state, start, found))


def _most_s(machine: ToothedMachine, target_rad: float) -> Callable[[Pulled], float]:
    """How long a step may be: up to a driving angle, or to the next stop of the load."""
    even_rad_s, stop_rad, way_rad = machine.drive.speed_rad_s, -inf, inf

    def most_s(now: Pulled) -> float:
        nonlocal stop_rad, way_rad
        if now.place.imag > stop_rad - CLEAR_RAD:
            stop_rad, way_rad = machine.load.next_stop_rad(now.place.imag)
        most = way_rad / max(abs(now.speed.imag), even_rad_s)
        if now.speed.imag > 0.0:
            most = min(most, max(NEARLY * (stop_rad - now.place.imag), CLEAR_RAD) / now.speed.imag)
        return min(most, (target_rad - now.place.real) / now.speed.real) if now.speed.real > 0.0 else most

    return most_s


DEGREE = 8
"""Degree of the polynomials within steps, by places, speeds and accelerations at both ends and in the middle."""

RATES = 5
"""Degree of the polynomials of the powers of the drive and of the teeth within a step."""


def _joined(machine: ToothedMachine, state: Array, start: Pulled, found: list[Stepped]) -> Course:
    """A course of steps from a state, with the work of the drive and the losses of the teeth."""
    time_s = np.append(0.0, np.cumsum([one.width for one in found]))
    half, ends = np.diff(time_s) / 2.0, [start, *(one.end for one in found)]
    at_ends = np.array([(now.place, now.speed, now.pull.acceleration) for now in ends])
    known = np.stack([at_ends[:-1], np.array([one.middle for one in found]), at_ends[1:]])
    places = np.tensordot(_through_three(), known * half[:, None] ** np.arange(3), axes=([1, 2], [2, 0]))
    speeds = np.append(chebyshev.chebder(places) / half, np.zeros((1, half.size)), axis=0)
    moved = np.stack([places.real, speeds.real, places.imag, speeds.imag], axis=-1)
    powers = _powers(machine, PiecewiseChebyshev(time_s, moved), nodes(time_s[:-1], time_s[1:], RATES))
    done = np.zeros((DEGREE + 1, half.size, 2))
    for number, power in enumerate(powers):
        work = PiecewiseChebyshev(time_s, series(power)).integrated().coefficients
        done[: len(work), :, number] = work
    done[0] += state[4:]
    place, speed, _ = at_ends.T
    works = np.append(state[4:, None], done.sum(axis=0).T, axis=1)
    states = np.concatenate([[place.real, speed.real, place.imag, speed.imag], works])
    return Course(machine, time_s, states, PiecewiseChebyshev(time_s, np.concatenate([moved, done], axis=-1)))


def _through_three() -> Array:
    """From values and derivatives (orders 0, 1, 2) at -1, 0 and 1 to Chebyshev's coefficients, shape (9, 3, 3)."""
    basis, points = np.eye(DEGREE + 1), np.array([-1.0, 0.0, 1.0])
    rows = [chebyshev.chebval(points, chebyshev.chebder(basis, order)).T for order in range(3)]
    return np.linalg.inv(np.concatenate(rows)).reshape(DEGREE + 1, 3, 3)


def _powers(machine: ToothedMachine, moving: PiecewiseChebyshev, time_s: Array) -> Array:
    """Powers of the drive and of the teeth at times of shape (m, n), shape (2, m, n)."""
    powers = np.empty((2, time_s.size))
    for rows in row_blocks(time_s.size):
        states = moving(time_s.ravel()[rows]).T
        answer = machine.answer(states)
        powers[:, rows] = answer.torque_n_mm * states[1], answer.teeth.loss_n_mm_s.sum(axis=-1)
    return powers.reshape(2, *time_s.shape)


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


def _stalled(machine: ToothedMachine, time_s: float, place: complex, after: str) -> NoSuchMechanism:
    driving, crank = in_words(place.real), in_words(place.imag)
    moved = isinstance(machine.drive, Motor)
    right = "more torque or a heavier flywheel is needed" if moved else "softer teeth or less damping help"
    return NoSuchMechanism(
        f"the drive does not get on: after {time_s:.4g} s, {after}, it is at phi1 = {driving}, crank at {crank}; "
        f"{right}",
        key="simulation.motor" if moved else "simulation",
    )
