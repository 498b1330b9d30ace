"""The mechanisms of a balance file: what drives them, what moves, and what is asked about them."""

from __future__ import annotations

from typing import Annotated, Literal, Self

from pydantic import Field, Strict, model_validator

from ncgear.design.angles import require_one
from ncgear.design.base import LONGEST_MM, Length, Model
from ncgear.design.faults import fault
from ncgear.design.machine import Linkage
from ncgear.design.masses import Mass, Masses, Place

MOST_ITEMS = 200

Angle = Annotated[float, Field(ge=-3600.0, le=3600.0)]
Share = Annotated[float, Field(ge=0.0, le=1.0)]


class Fixed(Model):
    """A counterweight that is there."""

    on: Literal["crank", "rod"] = Field(description="crank or rod")
    mass_kg: Mass = Field(description="its mass in kg")
    arm_mm: Length = Field(description="distance from the crank axis, or on the rod from the crank pin, in mm")
    angle_deg: Angle = Field(
        default=180.0,
        description="direction in degrees counter-clockwise from that to the pin, or on the rod to the slider; left "
        "out: opposite",
    )


class Complete(Model):
    """Complete balance by two counterweights."""

    rod_arm_mm: Length = Field(description="arm of the rod's counterweight beyond the crank pin in mm")
    crank_arm_mm: Length = Field(description="arm of the crank's counterweight beyond the axis in mm")


class Partial(Model):
    """Partial balance by a counterweight on the crank."""

    arm_mm: Length = Field(description="arm of the counterweight in mm")
    shares: Annotated[tuple[Share, ...], Strict(False), Field(min_length=1, max_length=MOST_ITEMS)] = Field(
        default=(1.0 / 3.0, 0.5), description="shares k of the reciprocating mass that are balanced, 0 to 1"
    )
    rotating_kg: Mass | None = Field(
        default=None, description="mass at the crank pin in kg; left out: that of the parts"
    )
    reciprocating_kg: Mass | None = Field(
        default=None, description="mass at the slider in kg; left out: that of the parts"
    )


class Best(Model):
    """The best counterweight on the crank for the actual motion."""

    arm_mm: Length = Field(description="arm of the counterweight in mm")


class Sweep(Model):
    """Counterweights tried one after the other."""

    arm_mm: Length = Field(description="arm of the counterweight in mm")
    angle_deg: Angle = Field(default=180.0, description="its direction in degrees as above; left out: opposite the pin")
    masses_kg: Annotated[tuple[Mass, ...], Strict(False), Field(min_length=1, max_length=MOST_ITEMS)] = Field(
        description="masses in kg"
    )


class Mechanism(Model):
    """A crank-slider in the frame."""

    name: str = Field(min_length=1, max_length=100, description="what it is called")
    linkage: Linkage | None = Field(default=None, description="its linkage, with a crank that turns evenly")
    design: str | None = Field(
        default=None,
        min_length=1,
        description="a design file instead, whose linkage and law are taken; its path counts from this file",
    )
    masses: Masses | None = Field(default=None, description="its masses; left out: those of the design file")
    counterweights: Annotated[tuple[Fixed, ...], Strict(False), Field(max_length=MOST_ITEMS)] = Field(
        default=(), description="counterweights that are there, a list"
    )
    direction_deg: Angle = Field(default=0.0, description="direction of the slider's way out in the frame in degrees")
    phase_deg: Angle = Field(default=0.0, description="driving angle in degrees by which it is ahead of the shaft")
    mirrored: bool = Field(default=False, description="true: its crank turns counter-clockwise")
    x_mm: Place = Field(default=0.0, description="place of its crank axis in the frame in mm")
    y_mm: Place = Field(default=0.0, description="place of its crank axis in the frame in mm")
    complete: Complete | None = Field(default=None, description="what would balance its forces completely")
    partial: Partial | None = Field(default=None, description="what would balance them in part")
    best: Best | None = Field(default=None, description="the counterweight that leaves least")
    sweep: Sweep | None = Field(default=None, description="counterweights to try")

    @model_validator(mode="after")
    def _driven_and_massive(self) -> Self:
        require_one(self, ("linkage", "design"))
        if self.linkage is not None and self.linkage.crank_mm is None:
            raise fault("linkage.crank_mm", "missing; give the length of the crank in mm")
        if self.linkage is not None and self.masses is None:
            raise fault("masses", "missing; a linkage given here needs slider_kg, rod and crank")
        if self.masses and not self.masses.slider_kg + self.masses.rod.mass_kg + self.masses.crank.mass_kg > 0.0:
            raise fault("masses", "nothing has a mass; give that of the slider, the rod or the crank")
        return self


class Chassis(Model):
    """Counterweight at the tail of a chassis on two supports."""

    mechanism: str = Field(description="name of the mechanism whose inertia force it is to hold")
    support_mm: Length = Field(description="distance of either support from the centre of gravity in mm")
    counterweight_mm: Length = Field(description="distance of the counterweight from the centre of gravity in mm")
    tilt_deg: float = Field(gt=0.0, le=90.0, description="slope of the slider's line against the ground in degrees")
    slider_kg: Mass = Field(default=0.0, description="weight of the slider on the support in kg")
    weight_kg: Mass = Field(default=0.0, description="dead weight in front of the supports in kg")
    weight_lever_mm: float = Field(default=0.0, ge=0.0, le=LONGEST_MM, description="its lever in mm")
