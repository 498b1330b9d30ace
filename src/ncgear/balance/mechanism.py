"""A crank-slider with masses and counterweights, driven at constant speed through any law.

Statics brings all masses to the joints.  With the crank pin at c and the wrist at w, a mass on the rod at the share d
of the way from pin to wrist is at (1 - d) c + d w.  So the first moments of all masses add up to P c + S w, whatever
the drive: P is the rotating mass (m_B), S the reciprocating one (m_C), and counterweights follow from both.  C. Wei,
L. Xu, J. Wang, Y. Li, "Inertial force balance and ADAMS simulation of the oscillating sieve and return pan of a rice
combine harvester", Int. J. Agric. & Biol. Eng. 11 (2018) 129-137, eqs. 1 and 6 to 8.

Frame and pose as in ``mechanisms.mechanism``.  Points of the plane are complex numbers x + i y.

All shaking forces and moments are sums of seven functions of the driving angle.  With the pin c = r exp(-i q), the
wrist w = x + i e and the rod's angle b, the place p = (1 - d) c + d w has the second derivative (1 - d) c'' + d x'' by
the driving angle, and its moment of acceleration about the axis is

    Im(conj(p) p'') = |1 - d|^2 Im(conj(c) c'') + |d|^2 Im(conj(w) w'') + Im(K conj(c) w'' + conj(K) conj(w) c''),
    K = conj(1 - d) d,  Im(conj(c) c'') = -r^2 q'',  Im(conj(w) w'') = -e x''

So counterweights change coefficients only, and the functions are fitted once for all counterweights.
"""

from __future__ import annotations

from cmath import exp, phase
from dataclasses import replace
from enum import StrEnum
from math import pi

import numpy as np

from ncgear.errors import WrongInput
from ncgear.frozen import dataclass
from ncgear.mechanisms.forces import RodMasses
from ncgear.mechanisms.mechanism import RodMechanism
from ncgear.numerics import chebyshev
from ncgear.numerics.arrays import Array, ComplexArray
from ncgear.numerics.chebyshev import PiecewiseChebyshev
from ncgear.numerics.plane import Vector
from ncgear.ratio.transmission import Transmission

NOTHING = 1e-12
"""Share of masses and moments below which a difference of them is rounding error."""


@dataclass(frozen=True)
class JointMasses:
    """Masses in kg at the crank pin and at the slider that move the common centre of mass as the parts do."""

    rotating_kg: float
    reciprocating_kg: float


def joint_masses(linkage: RodMechanism, masses: RodMasses) -> JointMasses:
    """m_B = m_crank c/r + m_rod (1 - d/l), m_C = m_rod d/l + m_slider."""
    share = masses.rod_center_mm / linkage.rod_mm
    crank = masses.crank_kg * masses.crank_center_mm / linkage.crank_mm
    return JointMasses(crank + masses.rod_kg * (1.0 - share), masses.rod_kg * share + masses.slider_kg)


def partial_counterweight_kg(linkage: RodMechanism, at_joints: JointMasses, arm_mm: float, share: float) -> float:
    """m_D = (r/r') (m_B + k m_C) opposite the pin at an arm r' in mm, where k is the share of the reciprocating mass.

    The rotating mass is balanced wholly.  k = 1 would turn all of the reciprocating mass's first harmonic across the
    slider's line, k = 1/2 leaves half of it in each direction, and 1/3 to 1/2 is usual.  Raises WrongInput for an arm
    that is not positive.
    """
    require_arm(arm_mm, "arm_mm")
    return linkage.crank_mm / arm_mm * (at_joints.rotating_kg + share * at_joints.reciprocating_kg)


def require_arm(arm_mm: float, key: str) -> None:
    """Refuse an arm that is not positive; raises WrongInput for ``key``."""
    if not arm_mm > 0.0:
        raise WrongInput(f"a counterweight cannot stand at an arm of {arm_mm:g} mm; a positive one is needed", key=key)


class Carrier(StrEnum):
    """The body that a counterweight is fixed to."""

    CRANK = "crank"
    ROD = "rod"


@dataclass(frozen=True)
class Counterweight:
    """A mass fixed to the crank or the rod.

    On the crank, its arm counts from the crank axis and its angle from the direction to the pin; on the rod, from the
    pin and the direction to the slider.  The angle is positive counter-clockwise, so that pi is opposite.
    """

    carrier: Carrier
    mass_kg: float
    arm_mm: float
    angle_rad: float = pi

    @property
    def arm(self) -> complex:
        """Place on its body in mm, along it and across it."""
        return self.arm_mm * exp(1j * self.angle_rad)

    @classmethod
    def of_moment(cls, carrier: Carrier, moment_kg_mm: complex, arm_mm: float) -> Counterweight:
        """The counterweight with a first moment on its body, at an arm; opposite where the moment is zero."""
        angle = phase(moment_kg_mm) % (2.0 * pi) if moment_kg_mm else pi
        return cls(carrier, abs(moment_kg_mm) / arm_mm, arm_mm, angle)


@dataclass(frozen=True, eq=False)
class DrivenCrank:
    """A driven crank-slider with its masses."""

    linkage: RodMechanism
    transmission: Transmission
    speed_rad_s: float
    masses: RodMasses
    counterweights: tuple[Counterweight, ...] = ()

    @property
    def pin_kg(self) -> complex:
        """P: the mass at the crank pin that stands for all parts; complex where some are off the line of their body."""
        rod = sum((mass * (1.0 - place / self.linkage.rod_mm) for mass, place in self.on_rod), 0j)
        return rod + sum((mass * place / self.linkage.crank_mm for mass, place in self.on_crank), 0j)

    @property
    def wrist_kg(self) -> complex:
        """S: the mass at the slider, complex in the same way."""
        rod = sum((mass * place / self.linkage.rod_mm for mass, place in self.on_rod), 0j)
        return rod + self.masses.slider_kg

    @property
    def total_kg(self) -> float:
        """Mass of all moving parts."""
        return self.masses.slider_kg + sum(mass for mass, _ in (*self.on_rod, *self.on_crank))

    @property
    def on_crank(self) -> list[tuple[float, complex]]:
        """Masses on the crank with their places from the axis, along it and across in mm."""
        own = (self.masses.crank_kg, complex(self.masses.crank_center_mm))
        return [own, *((w.mass_kg, w.arm) for w in self.counterweights if w.carrier is Carrier.CRANK)]

    @property
    def on_rod(self) -> list[tuple[float, complex]]:
        """Masses on the rod with their places from the pin, along it and across in mm."""
        own = (self.masses.rod_kg, complex(self.masses.rod_center_mm))
        return [own, *((w.mass_kg, w.arm) for w in self.counterweights if w.carrier is Carrier.ROD)]

    @property
    def breaks_rad(self) -> Array:
        """Driving angles of one cycle between which everything is smooth, both ends included."""
        transmission = self.transmission
        starts = np.arange(transmission.lobes.driven)[:, None] * transmission.lobes.driving_period_rad
        return np.append((starts + transmission.joints_rad[:-1]).ravel(), transmission.cycle_rad)

    def with_counterweight(self, added: Counterweight) -> DrivenCrank:
        """The same with one more counterweight."""
        return replace(self, counterweights=(*self.counterweights, added))

    def center_of_mass_mm(self, phi1_rad: Array) -> ComplexArray:
        """Centre of mass of all moving parts in mm, shape (n,)."""
        at = self.linkage.rod(self.transmission.driven_angle(phi1_rad, 2))
        pin, wrist = (complex_derivative(place, 0) for place in (at.pin, at.wrist))
        return (self.pin_kg * pin + self.wrist_kg * wrist) / self.total_kg


@dataclass(frozen=True)
class CompleteBalance:
    """Counterweights on rod and crank, beside those already there, and the mass in kg at the pin with the rod's own."""

    rod: Counterweight
    pin_kg: float
    crank: Counterweight


def complete_balance(mechanism: DrivenCrank, rod_arm_mm: float, crank_arm_mm: float) -> CompleteBalance:
    """The two counterweights, beside the existing ones, that keep the common centre of mass on the crank axis.

    The counterweight on the rod brings the centre of slider and rod to the pin, the other brings all to the axis; arms
    are in mm beyond pin and axis.  They hold for every drive, circular or not; the shaking moment stays.  Z. Tang, Y.
    Li, Y. Zhou, H. Zhang, "Inertial Vibration Characteristics of Track Chassis Caused by Reciprocating Motion of Crank
    Slider", Shock and Vibration 2019, section 3.1.  Raises WrongInput for arms that are not positive, and where a part
    is too heavy on that side already.
    """
    require_arm(rod_arm_mm, "rod_arm_mm")
    require_arm(crank_arm_mm, "crank_arm_mm")
    about_pin = mechanism.wrist_kg * mechanism.linkage.rod_mm
    rod = _against(mechanism, Carrier.ROD, about_pin, rod_arm_mm)
    balanced = mechanism.with_counterweight(rod)
    crank = _against(mechanism, Carrier.CRANK, balanced.pin_kg * mechanism.linkage.crank_mm, crank_arm_mm)
    at_pin = mechanism.masses.slider_kg + sum(mass for mass, _ in balanced.on_rod)
    return CompleteBalance(rod, at_pin, crank)


def _against(mechanism: DrivenCrank, carrier: Carrier, moment_kg_mm: complex, arm_mm: float) -> Counterweight:
    if moment_kg_mm.real < -NOTHING * mechanism.total_kg * arm_mm:
        there = any(counterweight.carrier is carrier for counterweight in mechanism.counterweights)
        lighter = "take counterweights off it" if there else "move its centre of mass towards the slider or the pin"
        raise WrongInput(
            f"the part is too heavy by {-moment_kg_mm.real:.6g} kg mm on the counterweight's side already; {lighter}",
            key=f"{carrier.value}_arm_mm",
        )
    return Counterweight.of_moment(carrier, -moment_kg_mm, arm_mm)


def partial_counterweight(mechanism: DrivenCrank, parts: JointMasses, arm_mm: float, share: float) -> Counterweight:
    """``partial_counterweight_kg`` less the counterweights already there, as a rule opposite the pin; raises alike."""
    bare, linkage = replace(mechanism, counterweights=()), mechanism.linkage
    pin, wrist = mechanism.pin_kg - bare.pin_kg, mechanism.wrist_kg - bare.wrist_kg
    wanted = partial_counterweight_kg(linkage, parts, arm_mm, share) * arm_mm
    moment = -wanted - (pin + share * wrist) * linkage.crank_mm
    return Counterweight.of_moment(Carrier.CRANK, moment if abs(moment) > NOTHING * abs(wanted) else 0.0, arm_mm)


def complex_derivative(place: Vector, derivative: int) -> ComplexArray:
    """A derivative of a place whose coordinates are jets, shape (n,)."""
    return np.asarray(place.x.derivative(derivative) + 1j * place.y.derivative(derivative))


PIN_X, PIN_Y, WRIST, CRANK, ROD, TOGETHER, ASIDE = range(7)
"""Places of the functions in their last axis: c''/r (real and imaginary part), x''/r, q'', b'',
Im(conj(c) w'' + conj(w) c'')/(r l) and Re(conj(c) w'' - conj(w) c'')/(r l).

All are of the size of one, so that each is resolved as well as the others."""


@dataclass(frozen=True, eq=False)
class Accelerations:
    """The seven functions on one cycle; ``form`` has values of shape (7,)."""

    form: PiecewiseChebyshev

    def combined(self, weights: Array) -> PiecewiseChebyshev:
        """Sums of the functions, ``weights`` of shape (7,) or (7, k)."""
        return PiecewiseChebyshev(self.form.breaks, self.form.coefficients @ weights)


def accelerations(mechanism: DrivenCrank) -> Accelerations:
    """The seven functions of a mechanism, whatever its masses; raises NotSmooth if the law's bend is infinite."""
    return Accelerations(chebyshev.fitted(lambda phi1: functions_at(mechanism, phi1), mechanism.breaks_rad))


def functions_at(mechanism: DrivenCrank, phi1_rad: Array) -> Array:
    """The seven functions at driving angles of shape (n,): shape (n, 7)."""
    linkage, driven = mechanism.linkage, mechanism.transmission.driven_angle(phi1_rad, 2)
    crank, rod, at = linkage.crank_mm, linkage.rod_mm, linkage.rod(driven)
    pin, wrist = (complex_derivative(place, 0) for place in (at.pin, at.wrist))
    pin_2, wrist_2 = (complex_derivative(place, 2) for place in (at.pin, at.wrist))
    one, other = np.conj(pin) * wrist_2, np.conj(wrist) * pin_2
    both = (one + other).imag / (crank * rod), (one - other).real / (crank * rod)
    alone = driven.derivative(2), at.angle.derivative(2)
    return np.column_stack([pin_2.real / crank, pin_2.imag / crank, wrist_2.real / crank, *alone, *both])
