"""Masses brought to the joints, and the counterweights that statics finds from them.

Every mass on the crank or the rod moves its centre as if parts of it were at the crank pin and at the slider.  With the
pin at c and the wrist at w, a mass m on the rod at the share d of the way from pin to wrist has its place at
(1 - d) c + d w; so all first moments together are P c + S w, whatever the drive.  P is the rotating mass (m_B), S the
reciprocating one (m_C).  C. Wei, L. Xu, J. Wang, Y. Li, "Inertial force balance and ADAMS simulation of the oscillating
sieve and return pan of a rice combine harvester", Int. J. Agric. & Biol. Eng. 11 (2018) 129-137, eqs. 1 and 6 to 8.
"""

from __future__ import annotations

from dataclasses import dataclass

from ncgear.errors import WrongInput
from ncgear.machine.linkage import CrankSlider
from ncgear.machine.masses import Masses


@dataclass(frozen=True)
class JointMasses:
    """Masses in kg at the crank pin and at the slider that move the common centre of mass as the parts do."""

    rotating_kg: float
    reciprocating_kg: float


@dataclass(frozen=True)
class CompleteBalance:
    """Counterweights in kg beyond the crank pin on the rod and beyond the axis on the crank, and the mass at the
    pin."""

    rod_kg: float
    pin_kg: float
    crank_kg: float


def joint_masses(linkage: CrankSlider, masses: Masses) -> JointMasses:
    """m_B = m_crank c/r + m_rod (1 - d/l), m_C = m_rod d/l + m_slider."""
    share = masses.rod_center_mm / linkage.rod_mm
    crank = masses.crank_kg * masses.crank_center_mm / linkage.crank_mm
    return JointMasses(crank + masses.rod_kg * (1.0 - share), masses.rod_kg * share + masses.slider_kg)


def complete_balance(linkage: CrankSlider, masses: Masses, rod_arm_mm: float, crank_arm_mm: float) -> CompleteBalance:
    """The two counterweights that keep the common centre of mass on the crank axis, at arms in mm beyond pin and axis.

    The one on the rod brings slider and rod to the pin, the one on the crank brings that to the axis.  They hold for
    every drive, circular or not; the shaking moment stays.  Z. Tang, Y. Li, Y. Zhou, H. Zhang, "Inertial Vibration
    Characteristics of Track Chassis Caused by Reciprocating Motion of Crank Slider", Shock and Vibration 2019,
    section 3.1.  Raises WrongInput for arms that are not positive, and where a part is too heavy on that side already.
    """
    require_arm(rod_arm_mm, "rod_arm_mm")
    require_arm(crank_arm_mm, "crank_arm_mm")
    about_pin = masses.slider_kg * linkage.rod_mm + masses.rod_kg * masses.rod_center_mm
    rod = _required(about_pin, rod_arm_mm, "rod_arm_mm")
    pin = rod + masses.slider_kg + masses.rod_kg
    about_axis = pin * linkage.crank_mm + masses.crank_kg * masses.crank_center_mm
    return CompleteBalance(rod, pin, _required(about_axis, crank_arm_mm, "crank_arm_mm"))


def partial_counterweight_kg(linkage: CrankSlider, at_joints: JointMasses, arm_mm: float, share: float) -> float:
    """m_D = (r/r') (m_B + k m_C) opposite the pin at an arm r' in mm, k being the share of the reciprocating mass.

    The rotating mass is balanced wholly; k = 1 would move all of the reciprocating mass's first harmonic across the
    slider's line, 1/2 halves it in both directions, and 1/3 to 1/2 is usual.  Raises WrongInput for an arm that is not
    positive.
    """
    require_arm(arm_mm, "arm_mm")
    return linkage.crank_mm / arm_mm * (at_joints.rotating_kg + share * at_joints.reciprocating_kg)


def require_arm(arm_mm: float, key: str) -> None:
    """Refuse an arm that is not positive; raises WrongInput for ``key``."""
    if not arm_mm > 0.0:
        raise WrongInput(f"{arm_mm:g} mm is no arm of a counterweight; a positive one is needed", key=key)


def _required(moment_kg_mm: float, arm_mm: float, key: str) -> float:
    if moment_kg_mm < 0.0:
        raise WrongInput(
            f"the part is too heavy by {-moment_kg_mm:.6g} kg mm on the counterweight's side already; "
            "move its centre of mass towards the slider or the pin",
            key=key,
        )
    return moment_kg_mm / arm_mm
