"""The gears a design file asks for: lobes, sizes, teeth, bodies."""

from __future__ import annotations

from typing import Literal, Self

from pydantic import Field, model_validator

from ncgear.design.angles import given, listed
from ncgear.design.base import Length, Model
from ncgear.design.body_faults import require_height, require_hub_wall
from ncgear.design.faults import fault
from ncgear.design.gear_body import DrivenBody, GearBody
from ncgear.design.teeth import Cutter, Helix, ProfileShift, Rack
from ncgear.design.tolerances import Tolerances

MOST_LOBES = 100
MOST_TEETH = 10_000


class Lobes(Model):
    """How often the law repeats in one turn of each gear."""

    driving: int = Field(default=1, ge=1, le=MOST_LOBES, description="lobes of the driving gear, a whole number")
    driven: int = Field(default=1, ge=1, le=MOST_LOBES, description="lobes of the driven gear, a whole number")


class Gears(Model):
    """The pair of gears: lobes, size, rack, backlash, bodies."""

    mesh: Literal["external", "internal"] = Field(
        default="external",
        description="external: gears side by side; internal: the driven gear is a ring around the driving one, which "
        "needs a ratio over 1 everywhere",
    )
    lobes: Lobes = Field(default_factory=Lobes, description="lobes of each gear; left out: one each")
    teeth: int | None = Field(
        default=None, ge=3, le=MOST_TEETH, description="teeth of the driving gear, a whole number"
    )
    module_mm: Length | None = Field(default=None, description="module in mm")
    center_distance_mm: Length | None = Field(default=None, description="distance of the two axes in mm")
    face_width_mm: Length = Field(description="width of both gears along their axes in mm")
    driving_axis_deg: float = Field(
        default=180.0,
        ge=-360.0,
        le=360.0,
        description="where the driving gear's axis lies from the crank's axis: direction in degrees counter-clockwise "
        "from the slider's way out; left out: straight behind the crank",
    )
    rack: Rack = Field(default_factory=Rack, description="basic rack; left out: ISO 53 profile A at 20 degrees")
    helix: Helix | None = Field(
        default=None, description="helical or herringbone teeth; left out: straight ones. Sections differ from z = 0 on"
    )
    backlash_mm: float = Field(
        default=0.0, ge=0.0, le=1000.0, description="normal backlash of the pair in mm, taken off the idle flanks"
    )
    profile_shift: ProfileShift = Field(default_factory=ProfileShift, description="profile shift; left out: none")
    cutter: Cutter = Field(default_factory=Cutter, description="tool that leaves the fillets; left out: kind auto")
    undercut: Literal["avoid", "allow"] = Field(
        default="avoid",
        description="avoid: tips are shortened where they would undercut the mate; allow: full height, flanks cut away",
    )
    least_tip_land: float = Field(
        default=0.2, ge=0.01, le=1.0, description="least width of tip lands in modules; sharper tips are shortened"
    )
    least_contact_ratio: float = Field(
        default=1.0,
        ge=0.0,
        le=3.0,
        description="1: flanks must touch all the time; above 1: each pair of flanks over so many pitches; below 1: "
        "gears that lose contact are made all the same",
    )
    method: Literal["exact", "equivalent_gear"] = Field(
        default="exact",
        description="exact flanks, or for comparison those of the circular gear of the local radius of curvature",
    )
    index_holes: bool = Field(
        default=False,
        description="true: a small hole in each gear, half a module wide, which face each other at phi1 = 0",
    )
    measuring_pin_mm: Length | None = Field(
        default=None,
        description="diameter in mm of the pins or balls in the data sheet; left out: one that is sold and fits",
    )
    tolerances: Tolerances | None = Field(
        default=None, description="what the data sheet says of accuracy; left out: nothing"
    )
    first_layer_chamfer_mm: float = Field(
        default=0.0,
        ge=0.0,
        le=10.0,
        description="bevel in mm of all edges at z = 0, at 45 degrees: what the first layers of a print spread by",
    )
    process_clearance_mm: float = Field(
        default=0.0,
        ge=0.0,
        le=10.0,
        description="what teeth, bores and keyways of the solids are moved into the material by, in mm along the "
        "normal, since a print swells; outline tables and contact are those of the gears as they shall come out",
    )
    driving: GearBody = Field(default_factory=GearBody, description="body of the driving gear")
    driven: DrivenBody = Field(default_factory=DrivenBody, description="body of the driven gear; of a ring, its rim")

    @model_validator(mode="after")
    def _two_sizes(self) -> Self:
        names = ("teeth", "module_mm", "center_distance_mm")
        found = given(self, names)
        if len(found) < 2:
            said = f"only {found[0]} is given" if found else "no size is given"
            raise fault("", f"{said}; two of {listed(names, 'and')} are needed")
        return self

    @model_validator(mode="after")
    def _body_is_that_of_the_mesh(self) -> Self:
        ring, driven = self.mesh == "internal", self.driven
        if ring and driven.about_axis:
            name, *_ = driven.about_axis
            part, all_given = name.removesuffix("_mm").replace("_", " "), listed(driven.about_axis, "and")
            why = f"a ring (mesh: internal) has no {part}: it is open about its axis"
            raise fault(f"driven.{name}", f"given, but {why}; leave {all_given} out")
        if not ring and driven.rim_mm is not None:
            raise fault("driven.rim_mm", "given, but only a ring has a rim; leave it out, or give mesh: internal")
        return self

    @model_validator(mode="after")
    def _helical_teeth_are_exact(self) -> Self:
        if self.helix is not None and self.method != "exact":
            raise fault("method", f"{self.method} given, but helical teeth are made of exact sections; leave it out")
        return self

    @model_validator(mode="after")
    def _helical_teeth_are_whole(self) -> Self:
        for name in ("first_layer_chamfer_mm", "process_clearance_mm"):
            if self.helix is not None and getattr(self, name) > 0.0:
                raise fault(name, "given, but helical teeth are made as designed, edges and all; leave it out")
        return self

    @model_validator(mode="after")
    def _bodies_have_walls(self) -> Self:
        for name, body in (("driving", self.driving), ("driven", self.driven)):
            require_hub_wall(name, body, self.process_clearance_mm)
            require_height(name, body, self.face_width_mm, self.first_layer_chamfer_mm)
        return self
