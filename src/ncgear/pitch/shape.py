"""Radii and curvatures of the two pitch curves at unit centre distance, in closed form from the law's derivatives.

With w = dphi2/dphi1 = 1/i12 the curves roll on each other at r1 = w / (1 - s w) and r2 = 1 / (1 - s w), where s is -1
for an external pair, whose gears turn against each other, and +1 for an internal one, whose gears turn alike.  This
holds because both gears have the same velocity at the pitch point x on the line of centres: x = s w (x - 1), so that
x = -s r1.  An internal pair needs w < 1, that is i12 > 1 (F. L. Litvin, A. Fuentes-Aznar, I. Gonzalez-Perez,
K. Hayasaka, "Noncircular Gears", Cambridge 2009, section 2.3).
"""

from __future__ import annotations

from enum import Enum
from math import pi

from ncgear.numerics import jet
from ncgear.numerics.jet import Jet


class Gear(Enum):
    """Which of the two gears."""

    DRIVING = "driving"
    DRIVEN = "driven"


class Mesh(Enum):
    """How the gears lie to each other: side by side, or the driving one inside a driven ring."""

    EXTERNAL = "external"
    INTERNAL = "internal"

    @property
    def sense(self) -> float:
        """Sense of the driven gear's turn while the driving gear turns by +phi1: +1 alike, -1 against it."""
        return 1.0 if self is Mesh.INTERNAL else -1.0


def is_ring(gear: Gear, mesh: Mesh) -> bool:
    """Whether the gear's material lies outside its pitch curve: the driven gear of an internal pair."""
    return gear is Gear.DRIVEN and mesh is Mesh.INTERNAL


def meeting_direction_rad(gear: Gear, mesh: Mesh) -> float:
    """Polar angle of the pitch point in the gear's own frame at phi1 = 0."""
    return 0.0 if gear is Gear.DRIVING and mesh is Mesh.EXTERNAL else pi


def radius(slope: Jet, gear: Gear, mesh: Mesh) -> Jet:
    """Pitch radius at unit centre distance, with derivatives by phi1, from the jet of dphi2/dphi1."""
    across = 1.0 - mesh.sense * slope
    return slope / across if gear is Gear.DRIVING else 1.0 / across


def by_own_angle(change: Jet, slope: Jet, gear: Gear) -> Jet:
    """A derivative by phi1 converted to the gear's own angle, which grows by 1 or by dphi2/dphi1."""
    return change if gear is Gear.DRIVING else change / slope.truncated(change.order)


def radius_slope(slope: Jet, gear: Gear, mesh: Mesh) -> Jet:
    """Derivative of the pitch radius by the gear's own angle, one order less than ``slope``."""
    return by_own_angle(radius(slope, gear, mesh).differentiated(), slope, gear)


def speed(slope: Jet, gear: Gear, mesh: Mesh) -> Jet:
    """Arc length of the pitch curve per unit of phi1, one order less than ``slope``."""
    along = radius(slope, gear, mesh)
    across = by_own_angle(along.differentiated(), slope, gear)
    along = along.truncated(across.order)
    per_turn = jet.sqrt(across * across + along * along)
    return per_turn if gear is Gear.DRIVING else per_turn * slope.truncated(across.order)


def polar(slope: Jet, gear: Gear, mesh: Mesh) -> tuple[Jet, Jet, Jet]:
    """The pitch radius and its first two derivatives by the gear's own angle, two orders less than ``slope``."""
    value, order = radius(slope, gear, mesh), slope.order - 2
    first = by_own_angle(value.differentiated(), slope, gear)
    return value.truncated(order), first.truncated(order), by_own_angle(first.differentiated(), slope, gear)


def curvature(slope: Jet, gear: Gear, mesh: Mesh) -> Jet:
    """Curvature at unit centre distance, positive where the material is convex, two orders less than ``slope``."""
    return curvature_of(polar(slope, gear, mesh), gear, mesh)


def curvature_of(radius_and_slopes: tuple[Jet, Jet, Jet], gear: Gear, mesh: Mesh) -> Jet:
    """The curvature from the values of ``polar``.

    k = (r^2 + 2 r'^2 - r r'') / (r^2 + r'^2)^(3/2), primes by the gear's own angle; a ring has -k.
    """
    value, first, second = radius_and_slopes
    square = value * value + first * first
    bend = (square + first * first - value * second) / (square * jet.sqrt(square))
    return -bend if is_ring(gear, mesh) else bend


def tangent_slope(slope: Jet, mesh: Mesh) -> Jet:
    """r1'/r1, the tangent of the angle between the pitch curves' tangent and the normal to the centre line."""
    value = radius(slope, Gear.DRIVING, mesh)
    change = value.differentiated()
    return change / value.truncated(change.order)
