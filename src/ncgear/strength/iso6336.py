"""Formulas of ISO 6336 for circular involute gear pairs, as far as published examples need them to be reached.

ncgear's gears are not circular: these functions judge the local estimate where both must agree, give the factors of
lubricant, speed and roughness, and the stiffness of an equivalent circular pair.  They take plain numbers or arrays
whose shapes broadcast; angles are in rad, lengths in mm, stresses in MPa.  Pairs are external.

Sources: ISO 6336-1, -2 and -3 (2006 and 2019) from secondary sources: the public repositories gfsReboucas/Drivetrain
(part 2, and the figures of ISO/TR 6336-30) and hanslhansl/din3990 (DIN 3990-11, whose form factor is that of part 3).
Each function names the part its formula belongs to.
"""

from __future__ import annotations

from math import pi, radians, sqrt, tan
from typing import Any

import numpy as np

from ncgear.errors import Unanswered
from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array

Real = Any
"""A number, or an array of them."""


def involute(angle_rad: Real) -> Real:
    """inv(alpha) = tan(alpha) - alpha."""
    return np.tan(angle_rad) - angle_rad


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
        # ncgear check uses other formulas of this module, and loads no solver.
        from scipy.optimize import brentq

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


LOW_MPA, HIGH_MPA = 850.0, 1200.0
"""Endured contact stresses between which the exponents of the lubricant film's factors change."""


def _between(limit_mpa: Real, low: float, high: float) -> Real:
    """A coefficient that changes evenly with the endured contact stress of the softer flank."""
    return np.interp(limit_mpa, (LOW_MPA, HIGH_MPA), (low, high))


def lubricant_factor(limit_mpa: Real, viscosity_mm2_s: Real) -> Real:
    """Z_L of ISO 6336-2; the kinematic viscosity is that at 40 degrees Celsius, up to 500 mm2/s."""
    c = _between(limit_mpa, 0.83, 0.91)
    return c + 4.0 * (1.0 - c) / (1.2 + 134.0 / viscosity_mm2_s) ** 2


def speed_factor(limit_mpa: Real, speed_m_s: Real) -> Real:
    """Z_v of ISO 6336-2 at the speed of the pitch line, above 0."""
    c = _between(limit_mpa, 0.85, 0.93)
    return c + 2.0 * (1.0 - c) / np.sqrt(0.8 + 32.0 / speed_m_s)


def roughness_factor(limit_mpa: Real, mean_peak_um: Real, reduced_radius_mm: Real) -> Real:
    """Z_R of ISO 6336-2 from the mean of both flanks' R_z, brought to a relative radius of 10 mm."""
    c = _between(limit_mpa, 0.15, 0.08)
    return (3.0 / (mean_peak_um * np.cbrt(10.0 / reduced_radius_mm))) ** c


@dataclass(frozen=True)
class RackTip:
    """The tip of the rack that cuts a gear, in modules: h_fP, rho_fP and what a protuberance leaves for grinding, s_pr.

    ISO 53 (secondary sources): A 1.25, 0.38; B 1.25, 0.30; C 1.25, 0.25; D 1.40, 0.39.
    """

    dedendum: float
    radius: float
    left: float = 0.0


@dataclass(frozen=True)
class RootSection:
    """The section at the 30 degree tangents of a circular gear's tooth, in modules.

    ``chord`` is s_Fn and ``radius`` rho_F; ``depth`` is the section's distance from the gear's axis.
    """

    chord: Real
    radius: Real
    depth: Real


def root_section(teeth: Real, shift: Real, rack: RackTip, pressure_angle_rad: float = radians(20.0)) -> RootSection:
    """The section of ISO 6336-3 for (virtual) spur gears cut by a rack; shapes of teeth and shift broadcast.

    The auxiliary angle theta solves theta = 2 G tan(theta) / z - H; Newton's method takes it from 30 degrees.
    """
    sine, cosine, slope = np.sin(pressure_angle_rad), np.cos(pressure_angle_rad), tan(pressure_angle_rad)
    e = pi / 4.0 - rack.dedendum * slope + (rack.left - (1.0 - sine) * rack.radius) / cosine
    g = rack.radius - rack.dedendum + shift
    h = 2.0 / teeth * (pi / 2.0 - e) - pi / 3.0
    theta = pi / 6.0 + 0.0 * g / teeth
    for _ in range(8):
        wrong = theta - 2.0 * g / teeth * np.tan(theta) + h
        theta = theta - wrong / (1.0 - 2.0 * g / teeth / np.cos(theta) ** 2)
    if not np.all(np.abs(theta - 2.0 * g / teeth * np.tan(theta) + h) < 1e-12):
        raise Unanswered("the auxiliary angle of the 30 degree tangent was not found")
    arm = g / np.cos(theta) - rack.radius
    return RootSection(
        teeth * np.sin(pi / 3.0 - theta) + sqrt(3.0) * arm,
        rack.radius + 2.0 * g**2 / (np.cos(theta) * (teeth * np.cos(theta) ** 2 - 2.0 * g)),
        (teeth * np.cos(pi / 3.0 - theta) + arm) / 2.0,
    )


@dataclass(frozen=True)
class RootFactors:
    """Y_F (``form``) and Y_S (``notch``) of ISO 6336-3, and what they follow from.

    ``arm`` is h_F in modules, from the section to where the load's line crosses the tooth's middle, ``angle_rad`` the
    load's angle alpha_F there, and ``sharpness`` q_s = s_F / (2 rho_F).
    """

    form: Real
    notch: Real
    arm: Real
    angle_rad: Real
    sharpness: Real


def root_factors(
    section: RootSection, teeth: Real, shift: Real, load_diameter: Real, pressure_angle_rad: float = radians(20.0)
) -> RootFactors:
    """Y_F and Y_S for a load at a circle of the (virtual) spur gear, given by its diameter in modules.

    The circle is that of the outer point of single contact in method B (``single_contact_diameter``), the tip circle
    in method C.  Shapes broadcast.
    """
    at = np.arccos(teeth * np.cos(pressure_angle_rad) / load_diameter)
    half = (pi / 2.0 + 2.0 * shift * tan(pressure_angle_rad)) / teeth + involute(pressure_angle_rad) - involute(at)
    angle = at - half
    arm = (np.cos(half) - np.sin(half) * np.tan(angle)) * load_diameter / 2.0 - section.depth
    form = 6.0 * arm * np.cos(angle) / (section.chord**2 * np.cos(pressure_angle_rad))
    sharpness = section.chord / (2.0 * section.radius)
    return RootFactors(form, notch_factor(section.chord / arm, sharpness), arm, angle, sharpness)


def notch_factor(slenderness: Real, sharpness: Real) -> Real:
    """Y_S = (1.2 + 0.13 L) q_s^(1 / (1.21 + 2.3 / L)) of ISO 6336-3, with L = s_F / h_F; holds for q_s from 1 to 8."""
    return (1.2 + 0.13 * slenderness) * sharpness ** (1.0 / (1.21 + 2.3 / slenderness))


def single_contact_diameter(teeth: Real, tip_diameter: Real, contact_ratio: Real, pressure_angle_rad: float) -> Real:
    """d_en of ISO 6336-3: diameter of the outer point of single contact of a (virtual) spur gear, all in modules."""
    base = teeth * np.cos(pressure_angle_rad) / 2.0
    path = np.sqrt(tip_diameter**2 / 4.0 - base**2) - pi * np.cos(pressure_angle_rad) * (contact_ratio - 1.0)
    return 2.0 * np.sqrt(path**2 + base**2)


def single_stiffness_theoretical(teeth: Real, shift: Real) -> Real:
    """c'_th of ISO 6336-1 in N/(mm um), from the (virtual) teeth and shifts of both gears, shape (2,) each.

    The polynomial for q' holds for steel, x_1 >= x_2 and shifts from -0.5 to 2 in sum.
    """
    (z1, z2), (x1, x2) = teeth, shift
    q = 0.04723 + 0.15551 / z1 + 0.25791 / z2 - 0.00635 * x1 - 0.11654 * x1 / z1 - 0.00193 * x2 - 0.24188 * x2 / z2
    return 1.0 / (q + 0.00529 * x1**2 + 0.00182 * x2**2)


def single_stiffness(theoretical: Real, rack_dedendum: float, helix_rad: float = 0.0) -> Real:
    """c' of ISO 6336-1 in N/(mm um): measured gears of steel have 0.8 of the theory; solid discs, 20 degree racks."""
    return 0.8 * theoretical * (1.0 + 0.5 * (1.2 - rack_dedendum)) * np.cos(helix_rad)


def mesh_stiffness(single: Real, transverse_contact_ratio: Real) -> Real:
    """c_gamma_alpha = c' (0.75 epsilon_alpha + 0.25) of ISO 6336-1, the mean over a mesh, for epsilon_alpha >= 1.2."""
    return single * (0.75 * transverse_contact_ratio + 0.25)
