"""Demand on the driving shaft over the cycle, friction counted, and the energy that its machine stores.

At the speed w_0 the torque is T = T1 + share |T1|, with the torque T1 of the rigid level, which counts friction in the
guide, and the share that the teeth take.  A machine that turns at another speed w has the energy
J(phi) w^2 / 2, with everything that moves in the inertia J reduced to the driving shaft,

    J = J_shaft + M(phi2) phi2'^2

where M is the crank's reduced inertia (``ncgear.dynamics.crank_load``).  The part of T that accelerates masses at
constant speed is J' w_0^2 / 2; the rest, A = T - J' w_0^2 / 2, is needed at any speed.  So

    d(J w^2 / 2) / dphi = T_drive - A

holds for any motion; friction is taken as at w_0.
"""

from __future__ import annotations

from functools import cached_property

from ncgear.drivetrain.cycle import Cycle, with_tooth_friction
from ncgear.drivetrain.losses import Losses
from ncgear.dynamics.crank_load import reduced_inertia
from ncgear.dynamics.driving_shaft import Fluctuation
from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array
from ncgear.numerics.chebyshev import fitted
from ncgear.numerics.extrema import Extremum
from ncgear.numerics.highest import range_of
from ncgear.numerics.jet import Jet
from ncgear.numerics.units import N_PER_KG_MM_S2


@dataclass(frozen=True, eq=False)
class Demand:
    """The driving shaft's torque with losses, and its inertia; ``added_kg_mm2`` is the inertia of added parts."""

    cycle: Cycle
    losses: Losses
    added_kg_mm2: float = 0.0

    @property
    def speed_rad_s(self) -> float:
        """The speed w_0 at which the machine is run."""
        return self.cycle.speed_rad_s

    def torque_n_mm(self, phi1_rad: Array) -> Array:
        """T at driving angles in rad, shape (n,)."""
        return with_tooth_friction(self.cycle.rigid.at(phi1_rad).driving_torque.value, self.losses.mesh_share)

    def inertia(self, phi1_rad: Array) -> tuple[Array, Array]:
        """J in N mm s^2 and its slope by the driving angle, at driving angles in rad, shape (n,) each."""
        rigid = self.cycle.rigid
        angle = rigid.machine.transmission.driven_angle(phi1_rad, 2)
        moving = rigid.machine.linkage.moving_masses(Jet.variable(angle.value, 2), rigid.masses)
        inertia, change = reduced_inertia(moving, rigid.masses)
        slope, bend = angle.derivative(1), angle.derivative(2)
        whole = rigid.masses.driving_shaft_kg_mm2 + self.added_kg_mm2 + inertia * slope**2
        return N_PER_KG_MM_S2 * whole, N_PER_KG_MM_S2 * (change * slope**3 + 2.0 * inertia * slope * bend)

    def at_any_speed_n_mm(self, phi1_rad: Array) -> Array:
        """A at driving angles in rad, shape (n,)."""
        accelerating: Array = self.inertia(phi1_rad)[1] * self.speed_rad_s**2 / 2.0
        return self.torque_n_mm(phi1_rad) - accelerating

    @cached_property
    def fluctuation(self) -> Fluctuation:
        """The torque over one cycle as a form, with its work and swing."""
        return Fluctuation(fitted(self.torque_n_mm, self.cycle.breaks_rad), self.speed_rad_s)

    @cached_property
    def torque_range_n_mm(self) -> tuple[Extremum, Extremum]:
        """Least and largest T with their driving angles."""
        return range_of(self.torque_n_mm, self.cycle.places_rad)
