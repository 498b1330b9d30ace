"""The teeth a design file asks for: basic rack, shift, cutter, helix."""

from __future__ import annotations

from typing import Any, Literal, NamedTuple, Self

from pydantic import Field, model_validator

from ncgear.design.base import Model
from ncgear.design.faults import fault


class Profile(NamedTuple):
    """Coefficients of a basic rack, in modules."""

    addendum: float
    dedendum: float
    root_radius: float


PROFILES: dict[str, Profile] = {
    "A": Profile(1.0, 1.25, 0.38),
    "B": Profile(1.0, 1.25, 0.30),
    "C": Profile(1.0, 1.25, 0.25),
    "D": Profile(1.0, 1.40, 0.39),
}
"""The basic rack tooth profiles of ISO 53 (values from secondary sources)."""


def _of_profile(data: dict[str, Any]) -> Profile:
    return PROFILES[data["profile"]]


class TipRelief(Model):
    """Material taken off the flanks near their tips, so that teeth that bend under load come together gently."""

    amount: float = Field(gt=0.0, le=0.1, description="what is taken off at the tip, along the normal, in modules")
    start: float = Field(
        default=0.5, ge=0.0, le=10.0, description="height over the pitch line at which it begins, in modules"
    )


class ProfileShift(Model):
    """Profile shift in modules, positive outwards; equal and opposite unless both are given."""

    driving: float | None = Field(default=None, ge=-1.0, le=1.0, description="of the driving gear, in modules")
    driven: float | None = Field(default=None, ge=-1.0, le=1.0, description="of the driven gear, in modules")
    against_undercut: bool = Field(
        default=False, description="true: chosen, equal and opposite, so that least is undercut"
    )

    @model_validator(mode="after")
    def _one_way(self) -> Self:
        if self.against_undercut and (self.driving is not None or self.driven is not None):
            raise fault("against_undercut", "the shifts are given; leave them out, or this")
        return self


class Cutter(Model):
    """The tool that leaves the fillets."""

    kind: Literal["auto", "rack", "pinion", "mate"] = Field(
        default="auto",
        description="rack (hob), pinion (shaper), mate (wire, mill or print: each gear cleared for the other's tips), "
        "or auto: rack where both pitch curves are convex, else mate",
    )
    teeth: int | None = Field(
        default=None, ge=3, le=1000, description="teeth of the pinion cutter; left out: the most that go in"
    )

    @model_validator(mode="after")
    def _teeth_of_a_pinion(self) -> Self:
        if self.teeth is not None and self.kind != "pinion":
            raise fault("teeth", f"a cutter of kind {self.kind} has no teeth to count; leave it out, or kind: pinion")
        return self


class Rack(Model):
    """The basic rack: a profile of ISO 53, any of whose coefficients can be given by itself."""

    profile: Literal["A", "B", "C", "D"] = Field(default="A", description="basic rack profile of ISO 53: A, B, C or D")
    pressure_angle_deg: float = Field(default=20.0, gt=5.0, lt=40.0, description="pressure angle in degrees")
    addendum: float = Field(
        default_factory=lambda data: _of_profile(data).addendum, gt=0.0, le=10.0, description="addendum in modules"
    )
    dedendum: float = Field(
        default_factory=lambda data: _of_profile(data).dedendum, gt=0.0, le=10.0, description="dedendum in modules"
    )
    root_radius: float = Field(
        default_factory=lambda data: _of_profile(data).root_radius,
        ge=0.0,
        le=10.0,
        description="radius of the root fillet in modules",
    )
    tip_relief: TipRelief | None = Field(default=None, description="tip relief; left out: none")

    @model_validator(mode="after")
    def _relief_below_tip(self) -> Self:
        if self.tip_relief is not None and self.tip_relief.start >= self.addendum:
            raise fault(
                "tip_relief.start",
                f"{self.tip_relief.start:g} modules is not below the tip; under {self.addendum:g} is right",
            )
        return self


class Helix(Model):
    """Teeth that advance along the pitch curves from section to section."""

    angle_deg: float = Field(
        gt=0.0,
        le=45.0,
        description="helix angle at the pitch curve in degrees: its tangent is the advance along the pitch curve per "
        "unit of height. Module and pressure angle stay those of the sections (transverse)",
    )
    kind: Literal["helical", "herringbone"] = Field(
        description="helical: one sense all the way up; herringbone: up to half the face width, and back from there"
    )
    hand: Literal["right", "left"] = Field(
        description="hand of the driving gear (of herringbone teeth: of the half next to z = 0); the driven gear has "
        "the other by itself"
    )
