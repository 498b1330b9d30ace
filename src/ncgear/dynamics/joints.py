"""Forces in the joints of the linkage, by the equations of Newton and Euler for slider, rod and crank.

From the slider to the crank each body's equations give the forces on it one after the other; no system is solved.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ncgear.kinematics.bodies import Bodies, Place
from ncgear.machine.masses import Masses
from ncgear.numerics.arrays import Array
from ncgear.numerics.jet import Jet

N = 1e-3
"""One kg mm/s^2 in N."""


@dataclass(frozen=True, eq=False)
class Turning:
    """How the crank turns at n places: speed in rad/s and acceleration in rad/s^2, shape (n,) each."""

    speed_rad_s: Array
    acceleration_rad_s2: Array

    def second_of(self, quantity: Jet) -> Array:
        """Second derivative by time of what is known with derivatives by the crank angle, shape (n,)."""
        return quantity.derivative(2) * self.speed_rad_s**2 + quantity.derivative(1) * self.acceleration_rad_s2

    def second(self, place: Place) -> Array:
        """Acceleration of a point in mm/s^2, shape (n, 2)."""
        return np.column_stack([self.second_of(place.x), self.second_of(place.y)])


@dataclass(frozen=True, eq=False)
class JointForces:
    """What the joints bear at n places: forces in N, shape (n, 2) each, but for the last two of shape (n,).

    ``wrist`` acts on the slider, ``pin`` on the rod, ``crank_axis`` on the crank, as far as the linkage asks it of the
    bearings.  ``guide_n`` is the guide's force on the slider across its line; ``torque_n_mm`` is asked of the crank
    shaft, in the sense in which the crank turns.
    """

    wrist: Array
    pin: Array
    crank_axis: Array
    guide_n: Array
    torque_n_mm: Array


def joint_forces(
    at: Bodies, masses: Masses, turning: Turning, resistance_n: Array, gravity_m_s2: tuple[float, float] = (0.0, 0.0)
) -> JointForces:
    """Forces that a motion needs against a resistance in N on the slider along -x, shape (n,).

    Bodies need derivatives of order 2.
    """
    rod_center, crank_center = at.on_rod(masses.rod_center_mm), at.on_crank(masses.crank_center_mm)
    gravity = np.array(gravity_m_s2)
    slider, rod, crank = (
        mass * (N * turning.second(place) - gravity)
        for mass, place in ((masses.slider_kg, at.wrist), (masses.rod_kg, rod_center), (masses.crank_kg, crank_center))
    )
    along = slider[:, 0] + resistance_n
    # Moments about the crank pin; the wrist's force on the rod is minus the one on the slider
    arm = at.wrist.value - at.pin.value
    spin = N * masses.rod_inertia_kg_mm2 * turning.second_of(at.rod_angle)
    turned = spin + _moment(rod_center.value - at.pin.value, rod)
    wrist = np.column_stack([along, (arm[:, 1] * along - turned) / arm[:, 0]])
    pin = rod + wrist
    shaft = N * masses.crank_shaft_kg_mm2 * turning.acceleration_rad_s2
    # Counter-clockwise moments are against the crank's turning
    torque = shaft - _moment(at.pin.value, pin) + _weight_torque(crank_center.value, masses.crank_kg, gravity)
    return JointForces(wrist, pin, crank + pin, slider[:, 1] - wrist[:, 1], torque)


def _moment(arm_mm: Array, force_n: Array) -> Array:
    """Counter-clockwise moments in N mm, shape (n,)."""
    return np.asarray(arm_mm[:, 0] * force_n[:, 1] - arm_mm[:, 1] * force_n[:, 0])


def _weight_torque(center_mm: Array, mass_kg: float, gravity_m_s2: Array) -> Array:
    """What the crank's own weight asks of the shaft in N mm, shape (n,)."""
    return _moment(center_mm, np.broadcast_to(mass_kg * gravity_m_s2, center_mm.shape))
