"""Where the slider turns off sharply because the rod is hardly longer than crank and offset.

With rod/crank = 1.0001 the slider stands still for half a turn of the crank, and its acceleration there is a peak
0.014 rad of the crank wide, which samples over the whole stroke pass by.
"""

from __future__ import annotations

from math import pi

import numpy as np

from ncgear.kinematics.slider import Machine
from ncgear.numerics.arrays import Array
from ncgear.numerics.bracketed import zeros_between

SHARP_RAD = 0.5
"""Width of a corner in crank angle below which it is looked at by itself: a tenth of a stroke that is sampled at 129
points, on which wider ones have over ten; that is rod/crank = 1.13 (tests/test_kinematics.py)."""

WIDENING = 4.0
"""From cut to cut: between two of them the acceleration, which falls with the cube of the distance, is smooth."""


def corner_cuts_rad(machine: Machine) -> Array:
    """Driving angles in rad of one cycle that close in on each sharp corner; shape (0,) for ordinary linkages.

    Raises ArithmeticError where a crank angle is not found, which a law that rises cannot cause.
    """
    corners = [_about(angle, width) for angle, width in machine.linkage.corners if width < SHARP_RAD]
    if not corners:
        return np.empty(0)
    crank = np.unique(np.mod(np.concatenate(corners), 2.0 * pi))
    return _driving_angles(machine, crank[crank > 0.0])


def _about(angle: float, width: float) -> Array:
    """Crank angles at a corner and at growing distances to both sides."""
    distances = width * WIDENING ** np.arange(np.ceil(np.log(pi / width) / np.log(WIDENING)))
    return angle + np.concatenate([-distances, [0.0], distances])


def _driving_angles(machine: Machine, crank: Array) -> Array:
    """Driving angles at crank angles within a turn, shape (n,); one next to the end, where none is cut, is left out."""

    def driven(phi1: Array) -> Array:
        return machine.transmission.driven_angle(phi1).value

    end = machine.transmission.cycle_rad * (1.0 - 1e-12)
    wanted = crank[crank < driven(np.array([end]))[0]]
    return zeros_between(lambda phi1: driven(phi1) - wanted, np.zeros(wanted.shape), np.full(wanted.shape, end))
