"""The moving masses as one inertia on the crank shaft, which changes with the crank's angle.

With q the crank's angle and primes by it, the kinetic energy is M(q) q'^2 / 2 and

    M = J_crank + m_rod (x_G'^2 + y_G'^2) + J_rod beta'^2 + m_slider x'^2

The torque that moves the masses is M q.. + M' q.^2 / 2 (Lagrange's equation of one degree of freedom, Eksergian's
equation of motion; e.g. B. Paul, "Kinematics and Dynamics of Planar Machinery", Prentice-Hall 1979, chapter 9).
"""

from __future__ import annotations

from dataclasses import dataclass

from ncgear.numerics.units import N_PER_KG_MM_S2
from ncgear.kinematics.bodies import Bodies
from ncgear.machine.masses import Masses
from ncgear.numerics.arrays import Array
from ncgear.numerics.jet import Jet


@dataclass(frozen=True, eq=False)
class ReducedInertia:
    """M in kg mm^2 and dM/dq in kg mm^2/rad at n crank angles, shape (n,) each."""

    inertia_kg_mm2: Array
    change_kg_mm2_rad: Array

    def torque_n_mm(self, speed_rad_s: Array, acceleration_rad_s2: Array) -> Array:
        """Torque on the crank shaft that moves the masses so."""
        return N_PER_KG_MM_S2 * (self.inertia_kg_mm2 * acceleration_rad_s2 + 0.5 * self.change_kg_mm2_rad * speed_rad_s**2)

    def energy_n_mm(self, speed_rad_s: Array) -> Array:
        """Kinetic energy."""
        return N_PER_KG_MM_S2 * 0.5 * self.inertia_kg_mm2 * speed_rad_s**2


def reduced_inertia(at: Bodies, masses: Masses) -> ReducedInertia:
    """The moving masses at the bodies' places, which need derivatives of order 2 by the crank's angle."""
    center = at.on_rod(masses.rod_center_mm)
    rod = masses.rod_kg * (_squared(center.x) + _squared(center.y)) + masses.rod_inertia_kg_mm2 * _squared(at.rod_angle)
    whole = rod + masses.slider_kg * _squared(at.wrist.x) + masses.crank_shaft_kg_mm2
    return ReducedInertia(whole.value, whole.derivative(1))


def _squared(place: Jet) -> Jet:
    slope = place.differentiated()
    return slope * slope
