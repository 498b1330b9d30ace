"""Refusal of gears whose carrying flanks cannot hold the torque: their pressure angle reaches 90 degrees."""

from __future__ import annotations

from math import degrees, pi

import numpy as np

from ncgear.dynamics.fluctuation import IDLE
from ncgear.dynamics.inverse import RigidMachine
from ncgear.errors import NoSuchMechanism
from ncgear.kinematics.stretches import stretches
from ncgear.numerics.angles import in_words


def refuse_locked(rigid: RigidMachine) -> None:
    """Raises NoSuchMechanism with the driving angle at which flanks carry under 90 degrees or more."""
    for stretch in stretches(rigid.machine) if rigid.place else ():
        phi1 = np.linspace(stretch.start_rad, stretch.end_rad, stretch.samples)
        loads = rigid.on(stretch, phi1)
        torque, angle = loads.driven_torque.value, loads.gripped.pressure_angle_rad.value
        locked = (np.abs(torque) > IDLE * np.abs(torque).max()) & (angle >= pi / 2.0)
        if locked.any():
            worst = int(np.argmax(np.where(locked, angle, 0.0)))
            flanks = "push the driven gear" if torque[worst] > 0.0 else "hold the driven gear back"
            raise NoSuchMechanism(
                f"the teeth cannot {flanks} at phi1 = {in_words(float(phi1[worst]))}, where their pressure angle is "
                f"{degrees(angle[worst]):.4g} deg; under 90 deg is needed: a law whose ratio changes more slowly there",
                key="motion",
            )
