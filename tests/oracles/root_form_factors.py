"""Form and stress correction factors of spur gears, ISO 6336-3:2019 method B (formulas from secondary sources).

Independent of the package: a circular gear cut by a rack, of which only tooth number, shift and rack are given.
"""

from __future__ import annotations

from math import acos, cos, pi, sin, sqrt, tan


def involute(angle: float) -> float:
    return tan(angle) - angle


def bending_factor(
    teeth: int,
    load_radius: float,
    shift: float = 0.0,
    *,
    dedendum: float = 1.25,
    root_radius: float = 0.38,
    angle: float = pi / 9.0,
) -> float:
    """Y_F times Y_S for a load where the flank has ``load_radius``; lengths are in modules.

    The root stress is this times the tangential force over face width and module.
    """
    g = root_radius - dedendum + shift
    e = pi / 4.0 - dedendum * tan(angle) - (1.0 - sin(angle)) * root_radius / cos(angle)
    h = 2.0 / teeth * (pi / 2.0 - e) - pi / 3.0
    theta = pi / 6.0
    for _ in range(100):
        theta = 2.0 * g / teeth * tan(theta) - h
    chord = teeth * sin(pi / 3.0 - theta) + sqrt(3.0) * (g / cos(theta) - root_radius)
    radius = root_radius + 2.0 * g**2 / (cos(theta) * (teeth * cos(theta) ** 2 - 2.0 * g))
    at = acos(teeth * cos(angle) / 2.0 / load_radius)
    gamma = (pi / 2.0 + 2.0 * shift * tan(angle)) / teeth + involute(angle) - involute(at)
    load = at - gamma
    arm = (cos(gamma) - sin(gamma) * tan(load)) * load_radius
    arm -= (teeth * cos(pi / 3.0 - theta) + g / cos(theta) - root_radius) / 2.0
    form = 6.0 * arm * cos(load) / (chord**2 * cos(angle))
    slender, notch = chord / arm, chord / (2.0 * radius)
    return form * (1.2 + 0.13 * slender) * notch ** (1.0 / (1.21 + 2.3 / slender))
