"""The motion of the toothed mechanism in time, by a solver for stiff equations.

The solver starts anew at each dead centre, where the resistance goes on or off.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from math import pi
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp

from ncgear.dynamics.events import meetings_s, next_dead_centre_rad, passing
from ncgear.dynamics.motion_equation import Mechanism
from ncgear.errors import NoSuchMechanism
from ncgear.numerics.angles import in_words
from ncgear.numerics.arrays import Array

METHOD = "LSODA"
"""Of scipy's stiff solvers the one with the least error in the same time (docs/speed-against-error.md)."""

ACCURACY = 1e-7
"""Relative error of a step: the published baler's slider is then at the right place to a micrometre after a turn."""

ENERGY = 1e-4
"""Share of the work done that the balance of energy may miss."""

SLOWEST = 20.0
"""Times the time without load, in which the drive has to get round."""


@dataclass(frozen=True, eq=False)
class Course:
    """A motion from time 0 on: solver steps at ``time_s`` (shape (n,)) in ``states`` (shape (6, n)).

    ``pushing_s`` and ``back_s`` are the times at which pushing flanks and their backs meet or part.
    """

    mechanism: Mechanism
    time_s: Array
    states: Array
    pushing_s: Array
    back_s: Array
    legs: tuple[tuple[float, Callable[[Array], Array]], ...]

    def at(self, time_s: Array) -> Array:
        """States at times within the course, shape (m,), as (6, m)."""
        number = np.searchsorted([start for start, _ in self.legs], time_s, side="right") - 1
        states = np.empty((self.states.shape[0], time_s.size))
        for leg in np.unique(number):
            states[:, number == leg] = self.legs[leg][1](time_s[number == leg])
        return states

    @cached_property
    def energy_error(self) -> float:
        """Largest imbalance of energy at any step, as a share of the most that was worked, lost or stored."""
        stored = self.mechanism.stored_n_mm(self.states)
        work, loss = self.states[4], self.states[5]
        most = max(float(np.abs(work).max()), float(loss.max()), float(np.ptp(stored)))
        return float(np.abs(work - loss - (stored - stored[0])).max()) / most if most else 0.0


def course(
    mechanism: Mechanism, state: Array, turns: float, accuracy: float = ACCURACY, method: str = METHOD
) -> Course:
    """The motion from a state (shape (6,)) over so many turns of the driving gear, by one of scipy's solvers.

    Raises NoSuchMechanism where the drive does not get round or teeth are pressed too deep into each other, and
    ArithmeticError where the solver fails or energy does not balance.
    """
    target = float(state[0]) + 2.0 * pi * turns
    limit_s = SLOWEST * 2.0 * pi * turns / mechanism.drive.speed_rad_s
    legs: list[Any] = []
    time_s = 0.0
    while True:
        leg = _leg(mechanism, (time_s, limit_s), state, target, (accuracy, method))
        legs.append(leg)
        time_s, state = float(leg.t[-1]), leg.y[:, -1]
        if leg.status == 0:
            raise _stalled(mechanism, state)
        if leg.t_events[0].size:
            return _checked(_joined(mechanism, legs))


def _leg(
    mechanism: Mechanism, span_s: tuple[float, float], state: Array, target_rad: float, how: tuple[float, str]
) -> Any:
    """From one dead centre to the next, or to the end of the course."""
    events = passing(0, target_rad), passing(2, next_dead_centre_rad(mechanism, float(state[2])))
    accuracy, method = how
    tolerance = {"rtol": accuracy, "atol": accuracy * _scales(mechanism)}
    leg = solve_ivp(mechanism.change, span_s, state, method, dense_output=True, events=events, **tolerance)
    if leg.status < 0:
        raise ArithmeticError(f"the motion could not be integrated: {leg.message}")
    return leg


def _scales(mechanism: Mechanism) -> Array:
    """What counts as small in each row of the state: a hundredth of a radian, of the speed, and of a turn's work."""
    speed = mechanism.drive.speed_rad_s
    moving = float(mechanism.load.energy_n_mm(np.array(0.0), np.array(speed)))
    work = max(moving, float(mechanism.load.table.at(2.0 * pi)[0][1]))
    return 1e-2 * np.array([1.0, speed, 1.0, speed, work, work])


def _joined(mechanism: Mechanism, legs: list[Any]) -> Course:
    """Legs end to end; a leg's first state is the last one of the leg before."""
    time_s = np.concatenate([legs[0].t[:1], *(leg.t[1:] for leg in legs)])
    states = np.concatenate([legs[0].y[:, :1], *(leg.y[:, 1:] for leg in legs)], axis=1)
    pushing, back = (
        np.concatenate([meetings_s(mechanism, leg.t, leg.sol, urge) for leg in legs]) for urge in (1.0, -1.0)
    )
    return Course(mechanism, time_s, states, pushing, back, tuple((float(leg.t[0]), leg.sol) for leg in legs))


def _checked(found: Course) -> Course:
    """The course itself, if its energy balances and its teeth are no deeper in each other than they are followed."""
    meshing, states = found.mechanism.meshing, found.states
    meshing.gaps.require_reach(states[0], states[2] - meshing.law.at(states[0])[0])
    if not found.energy_error <= ENERGY:
        raise ArithmeticError(f"the energy of the motion misses its balance by {found.energy_error:.3g} of the work")
    return found


def _stalled(mechanism: Mechanism, state: Array) -> NoSuchMechanism:
    return NoSuchMechanism(
        f"the drive does not get round in {SLOWEST:g} times the time that it takes without load: it is at phi1 = "
        f"{in_words(float(state[0]))}; more torque or a heavier flywheel is needed",
        key="simulation.motor",
    )
