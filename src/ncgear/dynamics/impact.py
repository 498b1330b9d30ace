"""Force between two bodies that are pressed or knocked into each other, and the friction that goes with it.

The law of impact is the one that multi-body programs use (MSC, "Adams/Solver" documentation, function IMPACT; after
K. H. Hunt, F. R. E. Crossley, J. Appl. Mech. 42 (1975), 440-445):

    F = max(0, k d^n + c(d) d'),   c(d) = c u^2 (3 - 2 u),   u = min(1, d / d_full)

at the depth d > 0, with d' its rate.  Friction is Coulomb's with a coefficient that depends on the speed of sliding.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import sqrt

import numpy as np

from ncgear.numerics.arrays import Array


@dataclass(frozen=True)
class Impact:
    """Stiffness in N/mm^exponent, damping in N s/mm, which is full from a depth in mm on."""

    stiffness: float
    exponent: float
    damping_n_s_mm: float
    full_damping_depth_mm: float

    def elastic_n(self, depth_mm: Array) -> Array:
        """What the depth alone gives; 0 where bodies do not touch."""
        pressed: Array = self.stiffness * np.maximum(depth_mm, 0.0) ** self.exponent
        return pressed

    def damping(self, depth_mm: Array) -> Array:
        """c(d) in N s/mm."""
        share = np.minimum(np.maximum(depth_mm / self.full_damping_depth_mm, 0.0), 1.0)
        ramp: Array = self.damping_n_s_mm * share * share * (3.0 - 2.0 * share)
        return ramp

    def force_n(self, depth_mm: Array, rate_mm_s: Array) -> Array:
        """Force that presses the bodies apart; they never pull."""
        force: Array = np.maximum(self.elastic_n(depth_mm) + self.damping(depth_mm) * rate_mm_s, 0.0)
        return force

    def energy_n_mm(self, depth_mm: Array) -> Array:
        """Work that the elastic force gives back."""
        return self.elastic_n(depth_mm) * np.maximum(depth_mm, 0.0) / (self.exponent + 1.0)

    def loss_n_mm_s(self, depth_mm: Array, rate_mm_s: Array) -> Array:
        """Power that damping takes; where the bodies part faster than the force follows, what the elastic one gives."""
        loss: Array = np.maximum(self.damping(depth_mm) * rate_mm_s, -self.elastic_n(depth_mm)) * rate_mm_s
        return loss

    def depth_mm(self, force_n: Array) -> Array:
        """Depth at rest under a force of 0 or more."""
        depth: Array = (force_n / self.stiffness) ** (1.0 / self.exponent)
        return depth


@dataclass(frozen=True)
class Friction:
    """Coefficients at rest and in motion, and the speeds in mm/s at which each of them is reached.

    The coefficient rises from 0 to the static one at the speed of ``static_mm_s`` and falls to the dynamic one at
    ``dynamic_mm_s``, both along cubics, as in the multi-body programs.
    """

    static: float
    dynamic: float
    static_mm_s: float
    dynamic_mm_s: float

    def coefficient(self, speed_mm_s: Array) -> Array:
        """Coefficient with the sign of the speed of sliding."""
        speed = np.abs(speed_mm_s)
        rising = np.minimum(speed / self.static_mm_s, 1.0)
        falling = np.minimum(np.maximum((speed - self.static_mm_s) / (self.dynamic_mm_s - self.static_mm_s), 0.0), 1.0)
        drop = (self.static - self.dynamic) * falling * falling * (3.0 - 2.0 * falling)
        coefficient: Array = np.sign(speed_mm_s) * (self.static * rising * rising * (3.0 - 2.0 * rising) - drop)
        return coefficient


def hertz_stiffness(youngs_modulus_gpa: float, poisson: float, radii_mm: tuple[float, float]) -> float:
    """k = 4/3 sqrt(R) E* in N/mm^1.5 for two spheres of one material, 1/R = 1/R1 + 1/R2, E* = E / (2 (1 - nu^2)).

    A ring has a negative radius.  K. L. Johnson, "Contact Mechanics", 1985, section 4.2.  Users of multi-body programs
    take the figure for any exponent; k d^n is then k N at 1 mm, whatever the exponent.
    """
    modulus_n_mm2 = 1e3 * youngs_modulus_gpa / (2.0 * (1.0 - poisson**2))
    radius_mm = 1.0 / (1.0 / radii_mm[0] + 1.0 / radii_mm[1])
    return 4.0 / 3.0 * sqrt(radius_mm) * modulus_n_mm2
