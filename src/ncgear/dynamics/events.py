"""What the solver of the motion in time looks out for: the end, dead centres, flanks that meet and part."""

from __future__ import annotations

from collections.abc import Callable
from math import pi

import numpy as np

from ncgear.dynamics.motion_equation import Mechanism
from ncgear.numerics.arrays import Array
from ncgear.numerics.bracketed import zeros_between

CLEAR_RAD = 1e-9
"""Angle within which a leg counts as starting at a dead centre: rounding errors of the event that ended the last."""


def passing(row: int, angle_rad: float) -> Callable[[float, Array], float]:
    """An event that ends a leg as the solver wants it: an angle of the state rises through a value."""

    def beyond(_time_s: float, state: Array) -> float:
        return float(state[row]) - angle_rad

    beyond.terminal, beyond.direction = True, 1.0  # type: ignore[attr-defined]
    return beyond


def pressed_rad(mechanism: Mechanism, states: Array, urge: float) -> Array:
    """How far the driven gear is pressed beyond the first contact of one side in states (shape (6, n)), shape (n,)."""
    angle, _ = mechanism.meshing.law.at(states[0])
    pushing, back = mechanism.meshing.gaps.play_rad(states[0])
    ahead = states[2] - angle
    pressed: Array = pushing - ahead if urge > 0.0 else ahead - back
    return pressed


def meetings_s(mechanism: Mechanism, time_s: Array, at: Callable[[Array], Array], urge: float) -> Array:
    """Times at which flanks of one side meet or part between the steps at ``time_s``; states are ``at`` times.

    Not left to the solver's own search for events: that compares the states of its steps with the interpolation between
    them, which LSODA does not join to them exactly.
    """

    def pressed(times: Array) -> Array:
        return pressed_rad(mechanism, at(times), urge)

    sign = np.sign(pressed(time_s))
    change = np.nonzero(sign[:-1] * sign[1:] < 0.0)[0]
    # The interpolation takes no empty times
    return zeros_between(pressed, time_s[change], time_s[change + 1]) if change.size else np.empty(0)


def next_dead_centre_rad(mechanism: Mechanism, phi2_rad: float) -> float:
    """The first dead centre beyond a crank angle."""
    turn, local = divmod(phi2_rad + CLEAR_RAD, 2.0 * pi)
    beyond = [angle for angle in mechanism.load.dead_centres_rad if angle > local]
    return turn * 2.0 * pi + min([*beyond, 2.0 * pi])
