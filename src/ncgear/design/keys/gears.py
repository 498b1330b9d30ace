"""The keys of the pair of gears: lobes, sizes, basic rack, shift, cutter, helix, tolerances, bodies."""

from __future__ import annotations

from itertools import accumulate
from math import pi, radians
from typing import TYPE_CHECKING, Annotated, Any, Literal, NamedTuple

from pydantic import Field

from ncgear.design.keys.base import Faults, Length, Model, Several, counts, fault, optional, required
from ncgear.design.keys.bodies import DrivenBody, GearBody
from ncgear.design.keys.strength import WrittenMaterials
from ncgear.design.words import listed
from ncgear.teeth.root_radius import fitting_root_radius, largest_root_radius

if TYPE_CHECKING:
    from ncgear.teeth.form import BasicRack

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
"""The basic rack tooth profiles of ISO 53, by name (values from secondary sources)."""


def _of_profile(data: dict[str, Any]) -> Profile:
    return PROFILES[data["profile"]]


def _fitting_root_radius(data: dict[str, Any]) -> float:
    """The profile's root radius or, if it does not fit into teeth without backlash, the greatest radius that fits."""
    pushing, idle = data["pressure_angle_deg"], data["idle_pressure_angle_deg"]
    angles = radians(pushing), radians(pushing if idle is None else idle)
    return fitting_root_radius(_of_profile(data).root_radius, largest_root_radius(angles, data["dedendum"], pi / 4.0))


class TipRelief(Model):
    """Material that is taken off the flanks near their tips, so that teeth that bend under load meet gently."""

    amount: float = required("material taken off at the tip, along the normal, in modules", gt=0.0, le=0.1)
    start: float = optional("height over the pitch line at which it begins, in modules", 0.5, ge=0.0, le=10.0)


MOST_SHIFT = 1.0
"""Greatest profile shift in modules, either way."""

ToothShift = Annotated[float, Field(ge=-MOST_SHIFT, le=MOST_SHIFT)]


class ProfileShift(Model):
    """Profile shift in modules, positive outwards; the shifts are equal and opposite unless both are given."""

    driving: float | None = optional("of the driving gear, in modules", ge=-MOST_SHIFT, le=MOST_SHIFT)
    driven: float | None = optional("of the driven gear, in modules", ge=-MOST_SHIFT, le=MOST_SHIFT)
    against_undercut: bool = optional("true: chosen, equal and opposite, so that least is undercut", False)
    per_tooth: Annotated[Several[ToothShift], Field(min_length=1, max_length=MOST_TEETH)] | None = optional(
        "of each tooth of the driving gear, in modules, from tooth 1 on, which stands on the line of centres at phi1 = "
        "0, and on along growing arc length (clockwise); fewer are repeated round the gear. The driven gear's spaces "
        "are as much deeper and wider"
    )

    def _faults(self) -> Faults:
        if self.against_undercut and (self.driving is not None or self.driven is not None):
            yield fault(
                "against_undercut",
                "given, and driving or driven too, which are the shifts; leave out against_undercut, or both shifts",
            )
        if self.per_tooth is not None and (others := sorted(self.model_fields_set - {"per_tooth"})):
            yield fault("per_tooth", f"{listed(others, 'and')} given as well; leave out per_tooth, or all of them")


class Cutter(Model):
    """The tool that leaves the fillets."""

    kind: Literal["auto", "rack", "pinion", "mate"] = optional(
        "rack (hob), pinion (shaper), mate (wire, mill or print: each gear cleared for the other's tips), or auto: "
        "rack where both pitch curves are convex, else mate",
        "auto",
    )
    teeth: int | None = optional("teeth of the pinion cutter; left out: the most that go in", ge=3, le=1000)

    def _faults(self) -> Faults:
        if self.teeth is not None and self.kind != "pinion":
            yield fault("teeth", f"a cutter of kind {self.kind} has no teeth to count; leave it out, or kind: pinion")


class Rack(Model):
    """The basic rack: a profile of ISO 53; each of its coefficients can also be given separately."""

    RULES = ("tip_relief.start < addendum",)

    profile: Literal["A", "B", "C", "D"] = optional("basic rack profile of ISO 53: A, B, C or D", "A")
    pressure_angle_deg: Annotated[float, Field(gt=5.0, lt=40.0)] = optional(
        "pressure angle of the rack's flanks in degrees; only of the pushing flanks if idle_pressure_angle_deg is "
        "given",
        20.0,
    )
    idle_pressure_angle_deg: Annotated[float, Field(gt=5.0, lt=40.0)] | None = optional(
        "pressure angle in degrees of the idle flanks, the back sides of the teeth while the driving gear drives; left "
        "out: as the pushing ones"
    )
    addendum: float = optional("addendum in modules", lambda data: _of_profile(data).addendum, gt=0.0, le=10.0)
    dedendum: float = optional("dedendum in modules", lambda data: _of_profile(data).dedendum, gt=0.0, le=10.0)
    root_radius: Annotated[float, Field(ge=0.0, le=10.0)] = optional(
        "radius of the root fillet in modules; left out: the profile's, or the most that fits", _fitting_root_radius
    )
    tip_relief: TipRelief | None = optional("tip relief; left out: none")

    @property
    def angles_deg(self) -> tuple[float, float]:
        """Pressure angles of the pushing and of the idle flanks."""
        pushing, idle = self.pressure_angle_deg, self.idle_pressure_angle_deg
        return pushing, pushing if idle is None else idle

    def in_mm(self, module_mm: float) -> BasicRack:
        """The basic rack in mm for a given module."""
        from ncgear.teeth.form import BasicRack
        from ncgear.teeth.form import TipRelief as Relief

        pushing, idle = map(radians, self.angles_deg)
        addendum, dedendum, root = (size * module_mm for size in (self.addendum, self.dedendum, self.root_radius))
        tip = self.tip_relief
        relief = None if tip is None else Relief(tip.amount * module_mm, tip.start * module_mm, addendum)
        return BasicRack(module_mm, pushing, addendum, dedendum, root, relief=relief, idle_angle_rad=idle)


class Housing(Model):
    """A close housing that makes the gears a flow meter or a pump."""

    clearance_mm: float = required(
        "gap in mm between the greatest radius of each gear and the housing", gt=0.0, le=100.0
    )


class Helix(Model):
    """Teeth that advance along the pitch curves from section to section."""

    angle_deg: Annotated[float, Field(gt=0.0, le=45.0)] = required(
        "helix angle at the pitch curve in degrees: its tangent is the advance along the pitch curve per unit of "
        "height. Module and pressure angle belong to the sections (transverse)"
    )
    kind: Literal["helical", "herringbone"] = required(
        "helical: one sense all the way up; herringbone: up to half the face width, and back from there"
    )
    hand: Literal["right", "left"] = required(
        "hand of the driving gear (of herringbone teeth: of the half next to z = 0); the driven gear has the other by "
        "itself"
    )


class Lead(Model):
    """Relief of both gears' flanks together along the width: for the strength and the data sheet, not in solids."""

    RULES = ("end_relief_um with end_relief_length_mm",)

    crowning_um: float = optional(
        "lead crowning in um: how far flanks fall back at both ends of the face width, along a parabola; both gears "
        "together",
        0.0,
        ge=0.0,
        le=1000.0,
    )
    end_relief_um: float | None = optional(
        "end relief in um: how far flanks fall back further at both ends, along a line; both gears together",
        ge=0.0,
        le=1000.0,
    )
    end_relief_length_mm: Length | None = optional("length in mm of the end relief at each end of the face width")


Fit = Literal["H6", "H7", "H8", "H9", "H11"]


class Tolerances(Model):
    """Accuracy on drawings and the data sheet; teeth are made in the middle between the limits of their thickness."""

    RULES = (
        "tooth_thickness_upper_mm with tooth_thickness_lower_mm",
        "tooth_thickness_lower_mm <= tooth_thickness_upper_mm",
    )

    standard: str = optional("standard that the grade belongs to, as text", "", max_length=200)
    grade: str = optional("accuracy grade, as text", "", max_length=200)
    tooth_thickness_upper_mm: Annotated[float, Field(ge=-10.0, le=10.0)] | None = optional(
        "greatest deviation of the tooth thickness along the pitch curve in mm, of both gears; thinner teeth have a "
        "negative one. All outlines stand in the middle of both limits, by their idle flanks; a narrow band makes the "
        "default of output.chord_tolerance_mm finer"
    )
    tooth_thickness_lower_mm: float | None = optional(
        "least deviation of the tooth thickness along the pitch curve in mm, of both gears", ge=-10.0, le=10.0
    )
    center_distance_mm: Annotated[float, Field(gt=0.0, le=10.0)] | None = optional(
        "largest deviation of the centre distance in mm on drawings, either way; assemblies are judged by it too. Left "
        "out: the deviation in the section tolerances or, without one, JS7 of ISO 286, but no less than is usual"
    )
    bore_fit: Fit = optional("fit of both bores, of ISO 286", "H7")
    index_hole_fit: Fit = optional("fit of both index holes, of ISO 286", "H7")
    crank_pin_fit: Fit = optional("fit of the crank pin's hole in the driven gear, of ISO 286", "H7")
    general: Literal["f", "m", "c", "v"] = optional(
        "class of ISO 2768-1 for sizes without a tolerance: f (fine), m, c or v (very coarse)", "m"
    )
    flank_ra_um: float = optional("roughness Ra of the flanks in um", 1.6, gt=0.0, le=100.0)
    ra_um: float = optional("roughness Ra of all other surfaces in um", 6.3, gt=0.0, le=100.0)
    note: str = optional("more for the data sheet, as text: runout, hardness", "", max_length=2000)


MOST_LOBES = 100

MOST_PAIRS = 6


SIZES = ("teeth", "module_mm", "center_distance_mm")
"""Keys that give the pitch curves their size: two of them, or one of the first two if the law gives the last."""


class Lobes(Model):
    """How often the law repeats in one turn of each gear."""

    driving: int = optional("lobes of the driving gear, a whole number", 1, ge=1, le=MOST_LOBES)
    driven: int = optional("lobes of the driven gear, a whole number", 1, ge=1, le=MOST_LOBES)


MOST_IDLERS = 10

Lobe = Annotated[int, Field(ge=1, le=64)]
Bend = Annotated[float, Field(ge=-150.0, le=150.0)]


class Idlers(Model):
    """Further gears in a row behind the driven one: each meshes with the gear before, which so is an idler."""

    lobes: Annotated[Several[Lobe], Field(min_length=1, max_length=MOST_IDLERS)] = required(
        "lobes of each further gear, whole numbers; their count is the number of idlers"
    )
    bends_deg: Annotated[Several[Bend], Field(max_length=MOST_IDLERS)] = optional(
        "by how many degrees the line of centres turns at each idler, counter-clockwise; left out: a straight row", ()
    )
    law_of: Literal["first_pair", "row"] | None = optional(
        "whose law motion gives: first_pair; or row, that of the last gear by the first, with one idler and a bend "
        "such as 42.492; left out: row where the law tells how a slider moves, else first_pair"
    )

    def _faults(self) -> Faults:
        idlers = len(self.lobes)
        yield from counts("bends_deg", len(self.bends_deg), idlers, "idler", f"of {idlers + 2} gears")

    @property
    def directions_rad(self) -> tuple[float, ...]:
        """Directions of all lines of centres against the first."""
        return (0.0, *accumulate(map(radians, self.bends_deg or [0.0] * len(self.lobes))))


Parts = Annotated[Several[Annotated[float, Field(gt=0.0, le=1000.0)]], Field(min_length=2, max_length=MOST_PAIRS)]


class Gears(Model):
    """The pair of gears: lobes, size, rack, backlash, bodies."""

    RULES = (
        "driving.web.thickness_mm < face_width_mm",
        "driven.web.thickness_mm < face_width_mm",
        "lead.end_relief_length_mm < face_width_mm",
    )

    mesh: Literal["external", "internal"] = optional(
        "external: gears side by side; internal: the driven gear is a ring around the driving one, which needs a "
        "ratio over 1 everywhere",
        "external",
    )
    lobes: Lobes = optional("lobes of each gear; left out: one each", Lobes)
    pairs: int = optional(
        "pairs in series that make the ratio, a whole number, each as these keys describe: each takes a part of the "
        "logarithm of the ratio",
        1,
        ge=1,
        le=MOST_PAIRS,
    )
    sharing: Literal["even", "pressure_angle", "safety"] = optional(
        "how pairs in series share the logarithm of the ratio: even, in equal parts; pressure_angle, so that the "
        "largest pressure angles of all pairs are equal; safety, so that the weakest pair is as safe as it "
        "can be",
        "even",
    )
    parts: Parts | None = optional(
        "parts of the logarithm of the ratio that pairs in series take, in any unit, as [3, 2], instead of sharing"
    )
    idlers: Idlers | None = optional(
        "further gears in a row, so that the driven gear of a pair drives the next; left out: none"
    )
    teeth: Annotated[int, Field(ge=3, le=MOST_TEETH)] | None = optional(
        "teeth of the driving gear, a whole number; of gears that turn less than once, the pitches from end to end of "
        "the range (no more than one tooth is added at each end)"
    )
    module_mm: Length | None = optional("module in mm")
    center_distance_mm: Length | None = optional("distance of the two axes in mm")
    face_width_mm: Length = required("width of both gears along their axes in mm")
    driving_axis_deg: Annotated[float, Field(ge=-360.0, le=360.0)] = optional(
        "where the driving gear's axis lies from the crank's axis: direction in degrees counter-clockwise from the "
        "slider's way out; left out: straight behind the crank",
        180.0,
    )
    rack: Rack = optional("basic rack; left out: ISO 53 profile A at 20 degrees", Rack)
    helix: Helix | None = optional(
        "helical or herringbone teeth; left out: straight ones. Sections differ from z = 0 on"
    )
    backlash_mm: Annotated[float, Field(ge=0.0, le=1000.0)] = optional(
        "backlash of the pair in mm, along the normal of the idle flanks where it is least. Idle flanks stay exact, "
        "so that the driven gear's play is the same angle everywhere. Left out: none, and a build warns where "
        "assemblies jam and says how much is enough; a 0 that is written down: the exact pair is wanted, and that it "
        "jams is a remark",
        0.0,
    )
    backlash_deg: float | None = optional(
        "play of the driven gear in degrees, instead of backlash_mm; 0 as there", ge=0.0, le=90.0
    )
    backlash_share: Annotated[float, Field(ge=0.0, le=1.0)] = optional(
        "share of the least backlash that is taken off the driving gear's teeth, the rest off the driven gear's", 0.5
    )
    drives: Literal["one_way", "both_ways"] = optional(
        "one_way: the driving gear only pushes, so what idle flanks lack is a warning; both_ways: the torque "
        "reverses, so idle flanks must hold as pushing ones do",
        "one_way",
    )
    profile_shift: ProfileShift = optional("profile shift; left out: none", ProfileShift)
    cutter: Cutter = optional("tool that leaves the fillets; left out: kind auto", Cutter)
    undercut: Literal["avoid", "allow"] = optional(
        "avoid: tips are shortened where they would undercut the mate; allow: full height, flanks cut away", "avoid"
    )
    least_tip_land: float = optional(
        "least width of tip lands in modules; sharper tips are shortened", 0.2, ge=0.01, le=1.0
    )
    least_contact_ratio: Annotated[float, Field(ge=0.0, le=3.0)] = optional(
        "1: flanks must touch all the time; tip relief does not prevent that. Above 1: each pair of flanks, pushing "
        "and back, must touch over this many pitches; flanks that tip relief holds apart do not count unless the load "
        "on given masses brings them into contact. Below 1: ncgear also makes gears that lose contact",
        1.0,
    )
    method: Literal["exact", "equivalent_gear"] = optional(
        "exact flanks, or for comparison the flanks of the circular gear with the local radius of curvature", "exact"
    )
    lead: Lead = optional(
        "form of the flanks along the width, which spreads the load where shafts bend; solids and drawings do not have "
        "it, the data sheet says it. Left out: straight flanks",
        Lead,
    )
    index_holes: bool = optional(
        "true: a small hole in each gear, which face each other at phi1 = 0: half a module wide, and 2 mm at least, "
        "or 1 mm where there is no room for more",
        False,
    )
    measuring_pin_mm: Length | None = optional(
        "diameter in mm of the pins or balls in the data sheet; left out: a sold diameter that fits"
    )
    tolerances: Tolerances = optional("accuracy on drawings and the data sheet", Tolerances)
    first_layer_chamfer_mm: Annotated[float, Field(ge=0.0, le=10.0)] = optional(
        "bevel in mm of all edges at z = 0, at 45 degrees: as much as the first layers of a print spread", 0.0
    )
    process_clearance_mm: Annotated[float, Field(ge=-10.0, le=10.0)] = optional(
        "distance in mm along the normal by which solids and drawings are moved into the material at teeth, bores and "
        "keyways, since a print swells. Negative: half the kerf of a laser, wire or jet; what is cut through is then "
        "moved out of the material, since the cutter takes half its kerf on either side of the line. Outline tables "
        "and contact hold for the finished gears",
        0.0,
    )
    housing: Housing | None = optional("a close housing: a build tells what the gears displace in it; left out: none")
    material: WrittenMaterials | None = optional(
        "material of both gears by its name in docs/materials.md, as 42CrMo4 or POM, of one by the keys below for "
        "both, or driving and driven each; left out: 42CrMo4 is assumed where strength is computed"
    )
    driving: GearBody = optional("body of the driving gear", GearBody)
    driven: DrivenBody = optional("body of the driven gear; of a ring, its rim", DrivenBody)

    def _body_is_that_of_the_mesh(self) -> Faults:
        ring, driven = self.mesh == "internal", self.driven
        if ring and driven.about_axis:
            name, *_ = driven.about_axis
            part, all_given = name.removesuffix("_mm").replace("_", " "), listed(driven.about_axis, "and")
            why = f"a ring (mesh: internal) has no {part}: it is open about its axis"
            yield fault(f"driven.{name}", f"given, but {why}; leave {all_given} out")
        if not ring and driven.rim_mm is not None:
            yield fault("driven.rim_mm", "given, but only a ring has a rim; leave it out, or give mesh: internal")

    def hub_mm(self, gear: str) -> float:
        """Height of the hub of the ``driving`` or ``driven`` gear over its face; 0 without a hub."""
        hub = getattr(self, gear).hub
        return hub.height_mm if hub else 0.0

    @property
    def carrying_angle_deg(self) -> float:
        """The rack's pressure angle of loaded flanks; driving both ways, the larger angle, as idle flanks carry too."""
        pushing, idle = self.rack.angles_deg
        return max(pushing, idle) if self.drives == "both_ways" else pushing

    def _uneven_teeth_are_exact(self) -> Faults:
        pushing, idle = self.rack.angles_deg
        if self.method != "exact" and pushing != idle:
            yield fault("rack.idle_pressure_angle_deg", f"given, but gears of method: {self.method} have one angle")
        if self.profile_shift.per_tooth is None:
            return
        unfit = {
            f"method: {self.method}": self.method != "exact",
            "helix": self.helix is not None,
            "cutter.kind: pinion": self.cutter.kind == "pinion",
            "rack.tip_relief": self.rack.tip_relief is not None,
        }
        for name in (name for name, is_given in unfit.items() if is_given):
            said = f"given, but not made together with {name}; leave out per_tooth, or {name}"
            yield fault("profile_shift.per_tooth", said)

    def _a_housing_is_about_both_gears(self) -> Faults:
        if self.housing is None:
            return
        if self.mesh == "internal":
            yield fault("housing", "given, but ncgear does not compute the flow of a ring and its gear; leave it out")
        if min(self.lobes.driving, self.lobes.driven) < 2:
            yield fault(
                "housing",
                f"given, but with {self.lobes.driving}:{self.lobes.driven} lobes a gear is not at the housing all the "
                "time between both ports; two lobes or more of each gear are right",
            )

    def _helical_teeth_are_exact(self) -> Faults:
        if self.helix is not None and self.method != "exact":
            yield fault("method", f"{self.method} given, but helical teeth are made of exact sections; leave it out")

    def _one_backlash(self) -> Faults:
        if self.backlash_deg is not None and "backlash_mm" in self.model_fields_set:
            yield fault(
                "backlash_deg", f"backlash_mm: {self.backlash_mm:g} is given; leave out backlash_deg or backlash_mm"
            )
