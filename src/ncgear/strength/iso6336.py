"""The formulas of ISO 6336 for circular involute gear pairs that the strength of other gears needs.

They give the factors of lubricant, speed and roughness, and the root and the stiffness of an equivalent circular pair.
They take plain numbers or arrays whose shapes broadcast; angles are in rad, lengths in mm, stresses in MPa.  Pairs are
external.

Sources: ISO 6336-1, -2 and -3 (2006 and 2019) from secondary sources: the public repositories gfsReboucas/Drivetrain
(part 2, and the figures of ISO/TR 6336-30) and hanslhansl/din3990 (DIN 3990-11, whose form factor is that of part 3).
Each function names the part of its formula.
"""

from __future__ import annotations

from math import pi, radians, sqrt, tan
from typing import Any

import numpy as np

from ncgear.errors import Unanswered
from ncgear.frozen import dataclass

Real = Any
"""A number, or an array of them."""


def involute(angle_rad: Real) -> Real:
    """inv(alpha) = tan(alpha) - alpha."""
    return np.tan(angle_rad) - angle_rad


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
    """The tip of the rack that cuts a gear, in modules: h_fP, rho_fP and the stock s_pr of a protuberance for grinding.

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
    """Y_F (``form``) and Y_S (``notch``) of ISO 6336-3, and the values that they follow from.

    ``arm`` is h_F in modules, from the section to the crossing of the load's line and the tooth's middle, ``angle_rad``
    the load's angle alpha_F there, and ``sharpness`` q_s = s_F / (2 rho_F).
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

    In method B the circle goes through the outer point of single contact, in method C it is the tip circle.  Shapes
    broadcast.
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


def single_stiffness_theoretical(teeth: Real, shift: Real) -> Real:
    """c'_th of ISO 6336-1 in N/(mm um), from the (virtual) teeth and shifts of both gears, shape (2,) each.

    The polynomial for q' holds for steel, x_1 >= x_2 and a sum of shifts from -0.5 to 2.
    """
    (z1, z2), (x1, x2) = teeth, shift
    q = 0.04723 + 0.15551 / z1 + 0.25791 / z2 - 0.00635 * x1 - 0.11654 * x1 / z1 - 0.00193 * x2 - 0.24188 * x2 / z2
    return 1.0 / (q + 0.00529 * x1**2 + 0.00182 * x2**2)


THICK_RIM, THIN_RIM = (1.2, 0.5), (3.5, 1.75)
"""The walls under the roots above which a rim weakens no root, and the thinnest walls with a known factor: of external
teeth in tooth heights, of a ring in modules (ISO 6336-3)."""

THINNEST_WEB = 0.2
"""Share of the face width under which the stiffness of a web is not known: the range of C_R in ISO 6336-1."""


def rim_factor(wall_mm: Real, height_mm: float, module_mm: float, *, internal: bool) -> Real:
    """Y_B, the factor of a thin rim on root stress; infinite for rims thinner than the thinnest known.

    ISO 6336-3:2006, 9: 1.6 ln(2.242 h / s) for external teeth, 1.15 ln(8.324 m / s) for a ring (values from secondary
    sources).  Walls of any shape.
    """
    thick, thin = THIN_RIM if internal else THICK_RIM
    factor, most = (1.15, 8.324) if internal else (1.6, 2.242)
    share = np.asarray(wall_mm) / (module_mm if internal else height_mm)
    raised = factor * np.log(most / np.clip(share, thin, thick))
    return np.where(share >= thick, 1.0, np.where(share < thin, np.inf, raised))


def thinnest_rim_mm(height_mm: float, module_mm: float, *, internal: bool) -> float:
    """The thinnest wall with a known Y_B."""
    return THIN_RIM[1] * module_mm if internal else THICK_RIM[1] * height_mm
