"""The gears a design file asks for: sizes, basic rack, bores and keyways."""

from __future__ import annotations

from typing import Any, Literal, NamedTuple, Self

from pydantic import Field, model_validator

from ncgear.design.angles import given, listed
from ncgear.design.base import Length, Model
from ncgear.design.faults import fault

MOST_LOBES = 100
MOST_TEETH = 10_000


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


class Lobes(Model):
    """How often the law repeats in one turn of each gear."""

    driving: int = Field(default=1, ge=1, le=MOST_LOBES, description="lobes of the driving gear, a whole number")
    driven: int = Field(default=1, ge=1, le=MOST_LOBES, description="lobes of the driven gear, a whole number")


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


class Keyway(Model):
    """A keyway in the bore."""

    width_mm: Length = Field(description="width of the keyway in mm, under the bore")
    depth_mm: Length = Field(description="depth of the keyway in mm, from the bore outwards")


class GearBody(Model):
    """What is cut into one gear around its axis."""

    bore_mm: Length | None = Field(default=None, description="diameter of the bore in mm; left out: no bore")
    keyway: Keyway | None = Field(default=None, description="keyway in the bore; left out: none")

    @model_validator(mode="after")
    def _keyway_fits(self) -> Self:
        if self.keyway is None:
            return self
        if self.bore_mm is None:
            raise fault("keyway", "a keyway without a bore; give bore_mm, or leave the keyway out")
        if self.keyway.width_mm >= self.bore_mm:
            width, bore = self.keyway.width_mm, self.bore_mm
            raise fault("keyway.width_mm", f"{width:g} mm is no narrower than the bore; under {bore:g} mm is right")
        return self


class Gears(Model):
    """The pair of gears: lobes, size, rack, backlash, bodies."""

    lobes: Lobes = Field(default_factory=Lobes, description="lobes of each gear; left out: one each")
    teeth: int | None = Field(
        default=None, ge=3, le=MOST_TEETH, description="teeth of the driving gear, a whole number"
    )
    module_mm: Length | None = Field(default=None, description="module in mm")
    center_distance_mm: Length | None = Field(default=None, description="distance of the two axes in mm")
    face_width_mm: Length = Field(description="width of both gears along their axes in mm")
    rack: Rack = Field(default_factory=Rack, description="basic rack; left out: ISO 53 profile A at 20 degrees")
    helix: Helix | None = Field(
        default=None, description="helical or herringbone teeth; left out: straight ones. Sections differ from z = 0 on"
    )
    backlash_mm: float = Field(default=0.0, ge=0.0, le=1000.0, description="normal backlash of the pair in mm")
    index_holes: bool = Field(
        default=False,
        description="true: a small hole in each gear, half a module wide, which face each other at phi1 = 0",
    )
    driving: GearBody = Field(default_factory=GearBody, description="bore and keyway of the driving gear")
    driven: GearBody = Field(default_factory=GearBody, description="bore and keyway of the driven gear")

    @model_validator(mode="after")
    def _two_sizes(self) -> Self:
        names = ("teeth", "module_mm", "center_distance_mm")
        found = given(self, names)
        if len(found) < 2:
            said = f"only {found[0]} is given" if found else "no size is given"
            raise fault("", f"{said}; two of {listed(names, 'and')} are needed")
        return self
