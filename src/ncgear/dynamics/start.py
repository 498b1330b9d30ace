"""The state in which a motion in time starts: on the law under its load, or at rest.

At a dead centre no torque presses the teeth, or a small one to the other side for a moment.  The gears stand on the
flanks that were pressed before: they fly over the play only where a load lasts.
"""

from __future__ import annotations

from collections.abc import Sequence
from enum import StrEnum
from itertools import chain, pairwise
from math import pi

import numpy as np

from ncgear.dynamics.crank_load import CrankLoad
from ncgear.dynamics.motion_in_time import ToothedMachine
from ncgear.dynamics.quasi_static import loaded_contact
from ncgear.numerics.arrays import Array
from ncgear.ratio.transmission import Transmission, turned_after


class Start(StrEnum):
    """How a motion starts: on the law, or at rest."""

    ON_LAW = "on_law"
    REST = "rest"


def law_torque_n_mm(load: CrankLoad, transmission: Transmission, phi1_rad: Array, speed_rad_s: float) -> Array:
    """Torque in N mm on the driven shaft when it keeps the law at a driving speed, shape (n,)."""
    angle = transmission.driven_angle(phi1_rad, 2)
    return load.torque_n_mm(angle.value, angle.derivative(1) * speed_rad_s, angle.derivative(2) * speed_rad_s**2)


BEFORE = 720
"""Angles in the turn before the start at which torques are asked for."""

HARDLY = 0.01
"""Share of the greatest torque up to which a torque at the start counts as none: it presses the other flanks only near
a dead centre, for too short a time to carry a gear over its play."""


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
    turn, resting = np.linspace(-2.0 * pi, 0.0, BEFORE + 1), start is Start.REST
    turned = [*turned_after(laws_before, turn, 2), transmission.driven_angle(turn, 2)]
    torques = [law_torque_n_mm(machine.load, transmission, turn, speed_rad_s)]
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
            ahead = loaded_contact(meshing, here, _pressing(torque), turning).error_rad
        shafts.append((float((angle + ahead)[0]), float(slope[0]) * turning))
    first, *between, last = shafts
    return np.array([*first, *last, 0.0, 0.0, *chain(*between)])


def _pressing(torque_n_mm: Array) -> Array:
    """The last of the torques over a turn, shape (1,); the least that keeps the flanks pressed before, if it is small.

    It is 0 for pushing flanks.
    """
    least = HARDLY * float(np.abs(torque_n_mm).max())
    pressed = torque_n_mm[np.abs(torque_n_mm) > least]
    last = torque_n_mm[-1:]
    if not pressed.size or abs(float(last[0])) > least:
        return last
    return np.maximum(last, 0.0) if pressed[-1] > 0.0 else np.minimum(last, -HARDLY * least)
