"""How much of the inertia forces of two cranks on one frame is left when they work against each other.

Forces of crank-sliders of equal speed, crank radius (else give masses times radius) and with long rods: the
reciprocating mass m_C gives m_C cos, the rotating one a vector that turns.  C. Wei, L. Xu, J. Wang, Y. Li, Int. J.
Agric. & Biol. Eng. 11 (2018) 129-137, eqs. 9 to 16; that paper's second share depends on the phase where the integral
it states does not.
"""

from __future__ import annotations

from cmath import exp
from dataclasses import dataclass
from math import pi

from scipy.special import ellipe

from ncgear.balance.joint_masses import JointMasses


@dataclass(frozen=True)
class Crank:
    """One crank: masses at its joints, the angle of its crank at time zero in rad, and its sense of turning.

    Angles count from the direction of the slider's line, positive in the positive sense.
    """

    masses: JointMasses
    phase_rad: float
    sense: int = 1


def reciprocating_share(one: Crank, other: Crank) -> float:
    """eta1: mean size of the sum of both reciprocating forces, by the sum of their mean sizes.

    cos(s w t + phase) is the real part of exp(i (w t + s phase)): both swing at one frequency, so their sum does.
    """
    first, second = _reciprocating(one), _reciprocating(other)
    return abs(first + second) / (abs(first) + abs(second))


def rotating_share(one: Crank, other: Crank) -> float:
    """eta2: mean size of the sum of both rotating forces, by the sum of their sizes.

    Turning alike, they keep their angle.  Turning against each other, the sum runs on an ellipse with half axes of the
    masses' sum and difference; its mean size is a complete elliptic integral, whatever the phases.
    """
    first, second = one.masses.rotating_kg, other.masses.rotating_kg
    if one.sense == other.sense:
        turned = exp(1j * (other.phase_rad - one.phase_rad))
        return abs(first + second * turned) / (abs(first) + abs(second))
    # 2/pi E(k^2) of an ellipse with half axes a = 1 and b = sqrt(1 - k^2)
    return 2.0 / pi * float(ellipe(4.0 * abs(first * second) / (abs(first) + abs(second)) ** 2))


def best_phase_rad(one: Crank, other: Crank) -> float:
    """Phase of ``one`` in [0, 2 pi) at which its reciprocating force is opposed to that of ``other``: least eta1."""
    opposed = pi + other.sense * other.phase_rad
    return one.sense * opposed % (2.0 * pi)


def combined_counterweight_kg(one: JointMasses, shares: tuple[float, float], arm_ratio: float, share: float) -> float:
    """Counterweight of one of two cranks that help each other: (r/r') (eta2 m_B + k eta1 m_C), shares (eta1, eta2)."""
    reciprocating, rotating = shares
    return arm_ratio * (rotating * one.rotating_kg + share * reciprocating * one.reciprocating_kg)


def _reciprocating(crank: Crank) -> complex:
    return crank.masses.reciprocating_kg * exp(1j * crank.sense * crank.phase_rad)
