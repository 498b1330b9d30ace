"""How a motion starts: on the law under its load, or from rest."""

from __future__ import annotations

from enum import StrEnum

import numpy as np

from ncgear.dynamics.motion_equation import Mechanism
from ncgear.dynamics.quasi_static import loaded_contact
from ncgear.numerics.arrays import Array
from ncgear.ratio.transmission import Transmission


class Start(StrEnum):
    """On the law, or at rest."""

    ON_LAW = "on_law"
    REST = "rest"


def law_torque_n_mm(mechanism: Mechanism, transmission: Transmission, phi1_rad: Array) -> Array:
    """Torque in N mm that the driven shaft takes where it keeps the law at the drive's speed, shape (n,)."""
    angle, speed = transmission.driven_angle(phi1_rad, 2), mechanism.drive.speed_rad_s
    return mechanism.load.torque_n_mm(angle.value, angle.derivative(1) * speed, angle.derivative(2) * speed**2)


def started(mechanism: Mechanism, transmission: Transmission, start: Start) -> Array:
    """The state at phi1 = 0, shape (6,).

    On the law both shafts have its speeds, and the teeth are pressed as deep as the load at that speed asks.  At rest
    the driven gear stands on pushing flanks, and so does the driving gear if a motor starts it; a drive of one speed
    has that speed from the start.
    """
    here = np.zeros(1)
    speed = mechanism.drive.speed_rad_s
    if start is Start.REST:
        pushing = float(mechanism.meshing.gaps.play_rad(here)[0][0])
        return np.array([0.0, mechanism.drive.starting_rad_s, pushing, 0.0, 0.0, 0.0])
    torque = law_torque_n_mm(mechanism, transmission, here)
    ahead = loaded_contact(mechanism.meshing, here, torque, speed).error_rad[0]
    ratio = float(transmission.driven_angle(here, 1).derivative(1)[0])
    return np.array([0.0, speed, float(ahead), ratio * speed, 0.0, 0.0])
