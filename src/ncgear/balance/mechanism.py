"""A crank-slider with masses and counterweights, driven at constant speed through any law, and how its places change.

Frame and pose as in ``machine.linkage``.  Points of the plane are complex numbers x + i y.
"""

from __future__ import annotations

from cmath import exp
from dataclasses import dataclass
from enum import StrEnum
from math import pi

import numpy as np

from ncgear.kinematics.bodies import Bodies, bodies
from ncgear.machine.linkage import CrankSlider
from ncgear.machine.masses import Masses
from ncgear.numerics.arrays import Array, ComplexArray
from ncgear.numerics.vector import Vector
from ncgear.ratio.transmission import Transmission


class Carrier(StrEnum):
    """The body that a counterweight is fixed to."""

    CRANK = "crank"
    ROD = "rod"


@dataclass(frozen=True)
class Counterweight:
    """A mass fixed to the crank or the rod.

    Its arm counts from the crank axis or the crank pin; its angle from the direction to the pin or to the slider,
    positive counter-clockwise, so that pi is opposite.
    """

    carrier: Carrier
    mass_kg: float
    arm_mm: float
    angle_rad: float = pi

    @property
    def arm(self) -> complex:
        """Place on its body, along it and across."""
        return self.arm_mm * exp(1j * self.angle_rad)


@dataclass(frozen=True, eq=False)
class Mechanism:
    """A driven crank-slider with its masses."""

    linkage: CrankSlider
    transmission: Transmission
    speed_rad_s: float
    masses: Masses
    counterweights: tuple[Counterweight, ...] = ()

    @property
    def pin_kg(self) -> complex:
        """P: the mass at the crank pin that moves the common centre as all parts do; complex where it stands aside."""
        rod = sum((mass * (1.0 - place / self.linkage.rod_mm) for mass, place in self.on_rod), 0j)
        return rod + sum((mass * place / self.linkage.crank_mm for mass, place in self.on_crank), 0j)

    @property
    def wrist_kg(self) -> complex:
        """S: the like at the slider."""
        rod = sum((mass * place / self.linkage.rod_mm for mass, place in self.on_rod), 0j)
        return rod + self.masses.slider_kg

    @property
    def total_kg(self) -> float:
        """All that moves."""
        return self.masses.slider_kg + sum(mass for mass, _ in (*self.on_rod, *self.on_crank))

    @property
    def on_crank(self) -> list[tuple[float, complex]]:
        """Masses on the crank with their places from the axis, along it and across in mm."""
        own = (self.masses.crank_kg, complex(self.masses.crank_center_mm))
        return [own, *((w.mass_kg, w.arm) for w in self.counterweights if w.carrier is Carrier.CRANK)]

    @property
    def on_rod(self) -> list[tuple[float, complex]]:
        """Masses on the rod with their places from the pin."""
        own = (self.masses.rod_kg, complex(self.masses.rod_center_mm))
        return [own, *((w.mass_kg, w.arm) for w in self.counterweights if w.carrier is Carrier.ROD)]

    @property
    def breaks_rad(self) -> Array:
        """Driving angles of one cycle between which everything is smooth, both ends included."""
        transmission = self.transmission
        inner = [angle for piece in transmission.pieces for angle in (piece.start_rad, *piece.knots_rad)]
        starts = np.arange(transmission.lobes.driven)[:, None] * transmission.lobes.driving_period_rad
        return np.append((starts + np.array(inner)).ravel(), transmission.cycle_rad)

    def bodies(self, phi1_rad: Array) -> Bodies:
        """Places with two derivatives by the driving angle, at driving angles of shape (n,)."""
        return bodies(self.linkage, self.transmission.driven_angle(phi1_rad, 2))

    def center_of_mass_mm(self, phi1_rad: Array) -> ComplexArray:
        """The common centre of all that moves, shape (n,)."""
        at = self.bodies(phi1_rad)
        return (self.pin_kg * as_complex(at.pin, 0) + self.wrist_kg * as_complex(at.wrist, 0)) / self.total_kg


def as_complex(place: Vector, derivative: int) -> ComplexArray:
    """A derivative of a place whose coordinates are jets, shape (n,)."""
    return np.asarray(place.x.derivative(derivative) + 1j * place.y.derivative(derivative))
