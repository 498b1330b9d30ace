"""Circular involute gear pairs by ISO 6336, which judge ncgear's strength where both must agree.

The sources are those of ``ncgear.strength.iso6336``; symbols of ISO 21771 and ISO 6336 stand beside each figure.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import pi, radians, sqrt, tan
from typing import Any

import numpy as np
from scipy.optimize import brentq

from ncgear.numerics.arrays import Array
from ncgear.strength.iso6336 import involute

Real = Any
"""A number, or an array of them."""


@dataclass(frozen=True)
class CylindricalPair:
    """An external pair of circular involute gears; symbols of ISO 21771 are given beside each property.

    Two values stand for pinion and wheel.  Where no centre distance is given the gears mesh without play, and where no
    tip diameters are given the addendum is one module.  ``helix_rad`` is the helix angle on the reference cylinder.
    """

    module_mm: float
    teeth: tuple[int, int]
    face_width_mm: float
    shift: tuple[float, float] = (0.0, 0.0)
    helix_rad: float = 0.0
    pressure_angle_rad: float = radians(20.0)
    given_center_distance_mm: float | None = None
    given_tip_mm: tuple[float, float] | None = None

    @property
    def ratio(self) -> float:
        """u: teeth of the wheel over those of the pinion."""
        return self.teeth[1] / self.teeth[0]

    @property
    def transverse_angle_rad(self) -> float:
        """alpha_t = atan(tan(alpha_n) / cos(beta))."""
        return float(np.arctan(tan(self.pressure_angle_rad) / np.cos(self.helix_rad)))

    @property
    def base_helix_rad(self) -> float:
        """beta_b = asin(sin(beta) cos(alpha_n))."""
        return float(np.arcsin(np.sin(self.helix_rad) * np.cos(self.pressure_angle_rad)))

    @property
    def reference_mm(self) -> Array:
        """d: diameters of the reference circles, shape (2,)."""
        return np.asarray(np.array(self.teeth) * self.module_mm / np.cos(self.helix_rad))

    @property
    def base_mm(self) -> Array:
        """d_b: diameters of the base circles, shape (2,)."""
        return np.asarray(self.reference_mm * np.cos(self.transverse_angle_rad))

    @property
    def tip_mm(self) -> Array:
        """d_a: diameters of the tip circles, shape (2,)."""
        if self.given_tip_mm is not None:
            return np.array(self.given_tip_mm)
        return np.asarray(self.reference_mm + 2.0 * self.module_mm * (1.0 + np.array(self.shift)))

    @property
    def working_angle_rad(self) -> float:
        """alpha_wt: the transverse pressure angle at which the gears work."""
        alpha = self.transverse_angle_rad
        if self.given_center_distance_mm is not None:
            return float(np.arccos(self.base_mm.sum() / 2.0 / self.given_center_distance_mm))
        inv = involute(alpha) + 2.0 * tan(self.pressure_angle_rad) * sum(self.shift) / sum(self.teeth)
        return float(brentq(lambda angle: involute(angle) - inv, 0.0, 1.4))

    @property
    def center_distance_mm(self) -> float:
        """a."""
        return float(self.base_mm.sum() / 2.0 / np.cos(self.working_angle_rad))

    @property
    def transverse_contact_ratio(self) -> float:
        """epsilon_alpha: length of the path of contact over the transverse base pitch."""
        reach = np.sqrt(self.tip_mm**2 - self.base_mm**2).sum() / 2.0
        path = reach - self.center_distance_mm * np.sin(self.working_angle_rad)
        return float(path * self.teeth[0] / (pi * self.base_mm[0]))

    @property
    def overlap_ratio(self) -> float:
        """epsilon_beta = b sin(beta) / (pi m_n)."""
        return float(self.face_width_mm * np.sin(self.helix_rad) / (pi * self.module_mm))

    @property
    def virtual_teeth(self) -> Array:
        """z_n = z / (cos^2(beta_b) cos(beta)): teeth of the virtual spur gears, shape (2,)."""
        return np.asarray(np.array(self.teeth) / np.cos(self.base_helix_rad) ** 2 / np.cos(self.helix_rad))

    @property
    def virtual_contact_ratio(self) -> float:
        """epsilon_alpha_n = epsilon_alpha / cos^2(beta_b)."""
        return float(self.transverse_contact_ratio / np.cos(self.base_helix_rad) ** 2)

    @property
    def reduced_radius_mm(self) -> float:
        """rho_red: radius of relative curvature at the pitch point, across the axes."""
        first, second = self.base_mm / 2.0 * tan(self.working_angle_rad)
        return float(first * second / (first + second))


def zone_factor(pair: CylindricalPair) -> float:
    """Z_H of ISO 6336-2: from the tangential force to the curvature of flanks at the pitch point."""
    work, alpha = pair.working_angle_rad, pair.transverse_angle_rad
    return float(np.sqrt(2.0 * np.cos(pair.base_helix_rad) / (np.cos(alpha) ** 2 * tan(work))))


def elasticity_factor(youngs_modulus_mpa: Real, poisson: Real) -> float:
    """Z_E of ISO 6336-2 in the root of MPa, from both gears' constants (two values each)."""
    compliance = (1.0 - np.asarray(poisson) ** 2) / np.asarray(youngs_modulus_mpa)
    return float(np.sqrt(1.0 / (pi * np.sum(compliance * np.ones(2)))))


def contact_ratio_factor(pair: CylindricalPair) -> float:
    """Z_epsilon of ISO 6336-2."""
    ratio, overlap = pair.transverse_contact_ratio, min(pair.overlap_ratio, 1.0)
    return sqrt((4.0 - ratio) / 3.0 * (1.0 - overlap) + overlap / ratio)


def single_contact_factors(pair: CylindricalPair) -> tuple[float, float]:
    """Z_B and Z_D of ISO 6336-2: from the pitch point to the inner points of single contact, at least 1."""
    lever, pitch = np.sqrt((pair.tip_mm / pair.base_mm) ** 2 - 1.0), 2.0 * pi / np.array(pair.teeth)
    rest, overlap = (pair.transverse_contact_ratio - 1.0) * pitch, min(pair.overlap_ratio, 1.0)
    inner = np.array([(lever[0] - pitch[0]) * (lever[1] - rest[1]), (lever[1] - pitch[1]) * (lever[0] - rest[0])])
    m = tan(pair.working_angle_rad) / np.sqrt(inner)
    first, second = np.maximum(m - overlap * (m - 1.0), 1.0)
    return float(first), float(second)


def nominal_contact_stress_mpa(
    pair: CylindricalPair, tangential_n: Real, elasticity: float, helix_factor: float = 1.0
) -> Real:
    """sigma_H0 of ISO 6336-2 at the pitch point in MPa, without factors of load.

    sigma_H0 = Z_H Z_E Z_eps Z_beta sqrt(F_t (u + 1) / (d_1 b u)).  ``helix_factor`` is Z_beta: 1 / sqrt(cos(beta)) in
    ISO 6336-2 since 2006, sqrt(cos(beta)) in DIN 3990.
    """
    u = pair.ratio
    line = tangential_n / (pair.reference_mm[0] * pair.face_width_mm) * (u + 1.0) / u
    return zone_factor(pair) * elasticity * contact_ratio_factor(pair) * helix_factor * np.sqrt(line)


def single_contact_diameter(teeth: Real, tip_diameter: Real, contact_ratio: Real, pressure_angle_rad: float) -> Real:
    """d_en of ISO 6336-3: diameter of the outer point of single contact of a (virtual) spur gear, all in modules."""
    base = teeth * np.cos(pressure_angle_rad) / 2.0
    path = np.sqrt(tip_diameter**2 / 4.0 - base**2) - pi * np.cos(pressure_angle_rad) * (contact_ratio - 1.0)
    return 2.0 * np.sqrt(path**2 + base**2)


def single_stiffness(theoretical: Real, rack_dedendum: float, helix_rad: float = 0.0) -> Real:
    """c' of ISO 6336-1 in N/(mm um): measured gears of steel have 0.8 of the theory; solid discs, 20 degree racks."""
    return 0.8 * theoretical * (1.0 + 0.5 * (1.2 - rack_dedendum)) * np.cos(helix_rad)


def mesh_stiffness(single: Real, transverse_contact_ratio: Real) -> Real:
    """c_gamma_alpha = c' (0.75 epsilon_alpha + 0.25) of ISO 6336-1, the mean over a mesh, for epsilon_alpha >= 1.2."""
    return single * (0.75 * transverse_contact_ratio + 0.25)
