"""The machine at driven angles: how the slider moves with the crank, and what resists it there."""

from __future__ import annotations

from dataclasses import dataclass
from math import pi

import numpy as np

from ncgear.machine.linkage import CrankSlider
from ncgear.machine.resistance import Resistance
from ncgear.numerics.arrays import Array
from ncgear.numerics.jet import Jet

ORDER = 3
"""Derivatives of the slider's displacement by the crank angle: jerk needs the third."""


@dataclass(frozen=True, eq=False)
class Stations:
    """n places of the crank: phi2, derivatives of the displacement by it (mm per rad and powers), force in N."""

    phi2_rad: Array
    first: Array
    second: Array
    third: Array
    force_n: Array

    @property
    def count(self) -> int:
        """Number of places."""
        return self.phi2_rad.size


def stations(linkage: CrankSlider, resistance: Resistance, count: int) -> Stations:
    """``count`` places evenly around one turn of the crank, from its retracted dead centre on."""
    phi2 = np.linspace(0.0, 2.0 * pi, count, endpoint=False)
    variable = np.zeros((ORDER + 1, count))
    variable[0], variable[1] = phi2, 1.0
    displacement = linkage.displacement(Jet(variable))
    working = phi2 < linkage.working_angle_rad
    force = np.where(working, resistance.force_n(displacement.value), 0.0)
    first, second, third = (displacement.derivative(order) for order in range(1, ORDER + 1))
    return Stations(phi2, first, second, third, force)
