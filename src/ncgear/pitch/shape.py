"""Radii and curvatures of the two pitch curves at unit centre distance, in closed form from the law's derivatives.

With w = dphi2/dphi1 = 1/i12 the curves roll on each other at r1 = w / (1 + w) and r2 = 1 / (1 + w)
(F. L. Litvin, A. Fuentes-Aznar, I. Gonzalez-Perez, K. Hayasaka, "Noncircular Gears", Cambridge 2009, section 2.3).
"""

from __future__ import annotations

from enum import Enum

from ncgear.numerics import jet
from ncgear.numerics.jet import Jet


class Gear(Enum):
    """Which of the two gears."""

    DRIVING = "driving"
    DRIVEN = "driven"


def radius(slope: Jet, gear: Gear) -> Jet:
    """Pitch radius at unit centre distance, with derivatives by phi1, from the jet of dphi2/dphi1."""
    return slope / (slope + 1.0) if gear is Gear.DRIVING else 1.0 / (slope + 1.0)


def own_turn(slope: Jet, gear: Gear) -> Jet:
    """How far the gear itself turns per unit of phi1: 1 or dphi2/dphi1."""
    return slope * 0.0 + 1.0 if gear is Gear.DRIVING else slope


def radius_slope(slope: Jet, gear: Gear) -> Jet:
    """Derivative of the pitch radius by the gear's own angle, one order less than ``slope``."""
    shorter = slope.truncated(slope.order - 1)
    return radius(slope, gear).differentiated() / own_turn(shorter, gear)


def speed(slope: Jet, gear: Gear) -> Jet:
    """Arc length of the pitch curve per unit of phi1, one order less than ``slope``."""
    shorter = slope.truncated(slope.order - 1)
    across, along = radius_slope(slope, gear), radius(shorter, gear)
    return jet.sqrt(across * across + along * along) * own_turn(shorter, gear)


def curvature(slope: Jet, gear: Gear) -> Jet:
    """Curvature at unit centre distance, positive where convex, two orders less than ``slope``.

    k = (r^2 + 2 r'^2 - r r'') / (r^2 + r'^2)^(3/2), primes by the gear's own angle.
    """
    order = slope.order - 2
    first = radius_slope(slope, gear)
    second = first.differentiated() / own_turn(slope.truncated(order), gear)
    first, value = first.truncated(order), radius(slope.truncated(order), gear)
    square = value * value + first * first
    return (square + first * first - value * second) / (square * jet.sqrt(square))


def tangent_slope(slope: Jet) -> Jet:
    """r1'/r1, the tangent of the angle between the pitch curves' tangent and the normal to the centre line."""
    return radius_slope(slope, Gear.DRIVING) / radius(slope.truncated(slope.order - 1), Gear.DRIVING)
