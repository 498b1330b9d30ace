"""Masses of a mechanism, and of what turns with its crank and with the driving shaft.

Masses in kg, lengths in mm, moments of inertia in kg mm^2.  Every mechanism has a crank and two gears, and most have a
slider; what else moves is the mechanism's own, and its class of masses is in the mechanism's module.  That of a
connecting rod, ``RodMasses``, is here: several mechanisms may have one.
"""

from __future__ import annotations

from ncgear.frozen import dataclass


@dataclass(frozen=True)
class SliderMass:
    """The mass of the slider, with all that moves with it."""

    slider_kg: float = 0.0


@dataclass(frozen=True)
class RodMass:
    """The connecting rod.

    Its centre of mass lies ``rod_center_mm`` from the crank pin towards the slider; its inertia is about that centre.
    """

    rod_kg: float = 0.0
    rod_center_mm: float = 0.0
    rod_inertia_kg_mm2: float = 0.0


@dataclass(frozen=True)
class ShaftMasses:
    """What turns with the crank and with the driving shaft, and gravity.

    The crank's centre of mass lies ``crank_center_mm`` from its axis towards the pin; ``crank_inertia_kg_mm2`` is about
    the axis and includes all that turns with the crank except the driven gear.  ``gravity_m_s2`` has its components
    along and across the slider's line, in the frame of the mechanism.  ``between_inertia_kg_mm2`` is that of the shaft
    between two pairs of gears in series with both its gears.
    """

    crank_kg: float = 0.0
    crank_center_mm: float = 0.0
    crank_inertia_kg_mm2: float = 0.0
    driven_inertia_kg_mm2: float = 0.0
    driving_inertia_kg_mm2: float = 0.0
    flywheel_inertia_kg_mm2: float = 0.0
    gravity_m_s2: tuple[float, float] = (0.0, 0.0)
    between_inertia_kg_mm2: float = 0.0

    @property
    def crank_shaft_kg_mm2(self) -> float:
        """All that turns with the crank, about its axis."""
        return self.crank_inertia_kg_mm2 + self.driven_inertia_kg_mm2

    @property
    def driving_shaft_kg_mm2(self) -> float:
        """All that turns with the driving gear, about its axis."""
        return self.driving_inertia_kg_mm2 + self.flywheel_inertia_kg_mm2


@dataclass(frozen=True)
class Masses(ShaftMasses, SliderMass):
    """The masses that every mechanism has; the slider's is 0 where the output turns."""


# Fields come from the last base to the first, so the rod's stand between the slider's and the crank's.
@dataclass(frozen=True)
class RodMasses(Masses, RodMass, SliderMass):
    """The masses of a mechanism whose slider is moved by a connecting rod."""
