"""When flanks touch in a motion in time: where pushing flanks part and meet again, and where no flanks touch at all.

Without backlash the backs carry as soon as pushing flanks part; with backlash the driven gear runs free in between.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ncgear.dynamics.meshing import Meshing
from ncgear.dynamics.motion_in_time import Course
from ncgear.numerics.arrays import Array
from ncgear.numerics.zeros import zeros_between

NEAR_RAD = 1e-6
"""Driven angle within which flanks count as touching: the tables of first touches are right to some millionths of a
radian (tests/test_gaps.py), and so much play may they show where there is none."""


def pressed_rad(meshing: Meshing, states: Array) -> Array:
    """How far the driven gear is pressed beyond the first contact of pushing flanks and of backs, shape (2, n).

    Less than 0 where they are apart; states have shape (6, n).
    """
    pushing, back = meshing.gaps.play_rad(states[0])
    error = states[2] - meshing.law.at(states[0])[0]
    return np.stack([pushing - error, error - back])


def meetings_s(pressed: Callable[[Array], Array], time_s: Array) -> Array:
    """Times, between rising times of shape (n,), at which flanks meet or part.

    ``pressed`` tells how far they are pressed into each other at times, less than 0 where they are apart.
    The solver's own search for events is not used: it compares the states of steps with the interpolation between them,
    which LSODA does not join to them exactly.
    """
    sign = np.sign(pressed(time_s))
    change = np.nonzero(sign[:-1] * sign[1:] < 0.0)[0]
    return zeros_between(pressed, time_s[change], time_s[change + 1]) if change.size else np.empty(0)


def pushing_parted_s(course: Course) -> Array:
    """Starts and ends of the times at which no pushing flanks touch, shape (k, 2)."""
    return _parted_s(course, 1)


def parted_s(course: Course) -> Array:
    """Starts and ends of the times at which neither pushing flanks nor backs touch, shape (k, 2)."""
    return _parted_s(course, 2)


def _parted_s(course: Course, sides: int) -> Array:
    """Starts and ends of the times at which none of the first ``sides`` sides of the teeth touch, shape (k, 2)."""

    def pressed(time_s: Array) -> Array:
        return pressed_rad(course.machine.meshing, course.at(time_s))[:sides]

    def meetings(side: int) -> Array:
        return meetings_s(lambda time_s: pressed(time_s)[side], course.fine_s)

    edges = np.unique(np.concatenate([course.time_s[[0, -1]], *(meetings(side) for side in range(sides))]))
    apart = pressed((edges[1:] + edges[:-1]) / 2.0).max(axis=0) < -NEAR_RAD
    return np.column_stack([edges[:-1][apart], edges[1:][apart]])
