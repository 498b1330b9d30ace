"""Masses of a crank-slider and of what turns with its crank and with the driving shaft."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Masses:
    """Masses in kg, lengths in mm, moments of inertia in kg mm^2.

    The rod's centre of mass lies ``rod_center_mm`` from the crank pin towards the slider, the rod's inertia is about
    that centre.  The crank's centre lies ``crank_center_mm`` from its axis towards the pin; ``crank_inertia_kg_mm2`` is
    about the axis, with all that turns with the crank but the driven gear.  ``gravity_m_s2`` is along and across the
    slider's line, in the frame of ``machine.linkage``.
    """

    slider_kg: float = 0.0
    rod_kg: float = 0.0
    rod_center_mm: float = 0.0
    rod_inertia_kg_mm2: float = 0.0
    crank_kg: float = 0.0
    crank_center_mm: float = 0.0
    crank_inertia_kg_mm2: float = 0.0
    driven_inertia_kg_mm2: float = 0.0
    driving_inertia_kg_mm2: float = 0.0
    flywheel_inertia_kg_mm2: float = 0.0
    gravity_m_s2: tuple[float, float] = (0.0, 0.0)

    @property
    def crank_shaft_kg_mm2(self) -> float:
        """All that turns with the crank, about its axis."""
        return self.crank_inertia_kg_mm2 + self.driven_inertia_kg_mm2

    @property
    def driving_shaft_kg_mm2(self) -> float:
        """All that turns with the driving gear, about its axis."""
        return self.driving_inertia_kg_mm2 + self.flywheel_inertia_kg_mm2
