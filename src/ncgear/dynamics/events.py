"""What the solver of the motion in time looks out for: the end, dead centres, flanks that meet and part."""

from __future__ import annotations

from collections.abc import Callable
from math import pi

from ncgear.dynamics.motion_equation import Mechanism
from ncgear.numerics.arrays import Array

CLEAR_RAD = 1e-9
"""Angle within which a leg counts as starting at a dead centre: rounding errors of the event that ended the last."""


def passing(row: int, angle_rad: float) -> Callable[[float, Array], float]:
    """An event that ends a leg: an angle of the state passes a value."""

    def beyond(_time_s: float, state: Array) -> float:
        return float(state[row]) - angle_rad

    return _marked(beyond, terminal=True)


def pressed(mechanism: Mechanism, urge: float) -> Callable[[float, Array], float]:
    """An event of meeting or parting: how far the driven gear is pressed beyond the first contact of one side."""

    def depth(_time_s: float, state: Array) -> float:
        angle, _ = mechanism.meshing.law.at(state[0])
        pushing, back = mechanism.meshing.gaps.play_rad(state[0])
        ahead = state[2] - angle
        return float(pushing - ahead if urge > 0.0 else ahead - back)

    return _marked(depth, terminal=False)


def _marked(event: Callable[[float, Array], float], *, terminal: bool) -> Callable[[float, Array], float]:
    """The event as the solver wants it: ending a leg only where its value rises through 0."""
    event.terminal, event.direction = terminal, 1.0 if terminal else 0.0  # type: ignore[attr-defined]
    return event


def next_dead_centre_rad(mechanism: Mechanism, phi2_rad: float) -> float:
    """The first dead centre beyond a crank angle."""
    turn, local = divmod(phi2_rad + CLEAR_RAD, 2.0 * pi)
    beyond = [angle for angle in mechanism.load.dead_centres_rad if angle > local]
    return turn * 2.0 * pi + min([*beyond, 2.0 * pi])
