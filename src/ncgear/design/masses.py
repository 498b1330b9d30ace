"""The moving masses of the machine, and which way is down."""

from __future__ import annotations

from typing import Annotated, Self

from pydantic import Field, model_validator

from ncgear.design.base import LONGEST_MM, Model
from ncgear.design.faults import fault

HEAVIEST_KG = 1e7
"""Ten thousand tonnes: beyond any machine."""

LARGEST_INERTIA_KG_MM2 = 1e16

Mass = Annotated[float, Field(ge=0.0, le=HEAVIEST_KG)]
Inertia = Annotated[float, Field(ge=0.0, le=LARGEST_INERTIA_KG_MM2)]
Place = Annotated[float, Field(ge=-LONGEST_MM, le=LONGEST_MM)]


class Rod(Model):
    """The connecting rod as a rigid body."""

    mass_kg: Mass = Field(description="mass of the rod in kg")
    center_mm: Place = Field(description="distance of its centre of mass from the crank pin towards the slider in mm")
    inertia_kg_mm2: Inertia = Field(description="moment of inertia about its centre of mass in kg mm2")

    @model_validator(mode="after")
    def _inertia_has_mass(self) -> Self:
        if self.inertia_kg_mm2 > 0.0 and self.mass_kg == 0.0:
            raise fault("mass_kg", "0 given, but a body without mass has no moment of inertia; give both or neither")
        return self


class Crank(Model):
    """The crank with all that turns with it, the driven gear apart."""

    mass_kg: Mass = Field(description="mass of the crank in kg")
    center_mm: Place = Field(
        description="distance of its centre of mass from its axis towards the crank pin in mm; negative beyond the axis"
    )
    inertia_kg_mm2: Inertia = Field(description="moment of inertia about its axis in kg mm2")

    @model_validator(mode="after")
    def _inertia_is_about_the_axis(self) -> Self:
        least = self.mass_kg * self.center_mm**2
        if self.inertia_kg_mm2 < least:
            raise fault(
                "inertia_kg_mm2",
                f"{self.inertia_kg_mm2:g} kg mm2 is less than the mass at its centre alone has about the axis; "
                f"{least:.6g} or over is right",
            )
        return self


class Flywheel(Model):
    """A flywheel on the driving shaft: the one that is there, and how evenly the shaft shall turn."""

    inertia_kg_mm2: Inertia = Field(default=0.0, description="moment of inertia in kg mm2; left out: no flywheel")
    speed_fluctuation: float = Field(
        default=0.05,
        gt=0.0,
        le=0.2,
        description="coefficient of speed fluctuation, largest less smallest speed over the mean, for which the "
        "inertia that is needed is told",
    )


class Gravity(Model):
    """Which way is down."""

    acceleration_m_s2: float = Field(default=9.80665, ge=0.0, le=1000.0, description="acceleration of gravity in m/s2")
    direction_deg: float = Field(
        default=-90.0,
        ge=-360.0,
        le=360.0,
        description="direction of gravity in degrees from the slider's way out, counter-clockwise; left out: across it",
    )


class Masses(Model):
    """What moves, as masses and moments of inertia."""

    slider_kg: Mass = Field(description="mass of the slider in kg, with all that moves with it")
    rod: Rod = Field(description="the connecting rod")
    crank: Crank = Field(description="the crank with all that turns with it, the driven gear apart")
    driving_gear_kg_mm2: Inertia | None = Field(
        default=None,
        description="moment of inertia of the driving shaft with its gear in kg mm2, its flywheel apart; left out: "
        "that of the gear's own body",
    )
    driven_gear_kg_mm2: Inertia | None = Field(
        default=None,
        description="moment of inertia of the driven gear in kg mm2; left out: that of its own body",
    )
    density_kg_m3: float = Field(default=7850.0, gt=0.0, le=30000.0, description="density of both gears in kg/m3")
    flywheel: Flywheel = Field(default_factory=Flywheel, description="flywheel on the driving shaft; left out: none")
    gravity: Gravity | None = Field(default=None, description="gravity; left out: none")

    @property
    def tells_gears(self) -> bool:
        """Whether the moments of inertia of both gears are given."""
        return self.driving_gear_kg_mm2 is not None and self.driven_gear_kg_mm2 is not None
