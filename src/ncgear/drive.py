"""The drive: one design, whose stages are computed when they are first asked for, and once."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import cached_property
from typing import TYPE_CHECKING

from ncgear.design.gears import GearBody, Gears
from ncgear.design.schema import Design
from ncgear.errors import WrongInput
from ncgear.kinematics.check import KinematicCheck, kinematic_check
from ncgear.kinematics.slider import Machine, SliderMotion, sample_angles
from ncgear.machine.linkage import CrankSlider
from ncgear.machine.masses import Masses
from ncgear.machine.rack import BasicRack
from ncgear.numerics.arrays import Array
from ncgear.ratio.laws.uniform import uniform_law
from ncgear.ratio.train import Pair
from ncgear.ratio.transmission import Transmission
from ncgear.recipe.gears import bore_of, helix_of, mesh_place, rack_of, rim_mm_of, tooth_form
from ncgear.recipe.law import RAD_S_PER_RPM, Law, law_of, resistance_of
from ncgear.stopwatch import Stopwatch

if TYPE_CHECKING:
    from ncgear.contact.as_designed import AsDesigned
    from ncgear.contact.as_written import Outlines
    from ncgear.contact.pair_contact import PairContact
    from ncgear.dynamics.rigid import Rigid
    from ncgear.pitch.pair import PitchPair
    from ncgear.solids.helix import Helix
    from ncgear.solids.pair import Blank, GearSolid, SolidPair
    from ncgear.teeth.form import ToothForm
    from ncgear.teeth.gear import ToothedPair


class Drive:
    """A design and all that follows from it.

    Stages are attributes; each needs only the ones it is made from, so a check of power never makes a tooth.  They
    raise WrongInput or NoSuchMechanism, with the design file's key, when the stage cannot be made.

    Of a design in two stages, law and motion are those of the whole machine; pitch curves, teeth, contact and solids
    are those of the pair that ``stage`` tells, 1 or 2, and only one of ``by_stage`` has them.
    """

    def __init__(self, design: Design, stage: int | None = None) -> None:
        self.design = design
        self.stage = stage
        self.stopwatch = Stopwatch()

    def __repr__(self) -> str:
        stage = "" if self.stage is None else f", stage {self.stage}"
        return f"Drive({self.design.name!r}, law {self.design.motion.law!r}{stage})"

    @cached_property
    def by_stage(self) -> tuple[Drive, ...]:
        """The same drive for each of its pairs of gears, from the driving shaft on; one pair has itself."""
        if self.design.stages == 1 or self.stage is not None:
            return (self,)
        return tuple(Drive(self.design, stage) for stage in range(1, self.design.stages + 1))

    @property
    def pair(self) -> Pair:
        """The law that the gears follow; raises WrongInput where the stage is not told."""
        if self.stage is None and self.design.stages > 1:
            raise WrongInput("two pairs of gears, of which one is asked for; see by_stage", key="motion.second_stage")
        return self.law.train.pairs[(self.stage or 1) - 1]

    @property
    def timing_s(self) -> dict[str, float]:
        """Seconds spent in each stage so far."""
        return dict(self.stopwatch.seconds)

    @property
    def gears(self) -> Gears:
        """What the file says of the gears; raises WrongInput when it says nothing."""
        if self.design.gears is None:
            raise WrongInput("missing; gears need teeth, module_mm, face_width_mm and more", key="gears")
        return self.design.gears

    @cached_property
    def law(self) -> Law:
        """Linkage and closed law."""
        with self.stopwatch("law"):
            return law_of(self.design)

    @property
    def linkage(self) -> CrankSlider:
        """The crank-slider."""
        return self.law.linkage

    @property
    def transmission(self) -> Transmission:
        """The closed law phi2(phi1)."""
        return self.law.transmission

    @property
    def law_speed_rpm(self) -> float:
        """Driving speed at which the law's velocities hold; laws without velocities hold at any."""
        stroke = self.law.stroke_law
        return stroke.stroke.law_speed_rad_s / RAD_S_PER_RPM if stroke else self.design.operation.speed_rpm

    @cached_property
    def machine(self) -> Machine:
        """The mechanism at the operating speed."""
        speed = self.design.operation.speed_rpm * RAD_S_PER_RPM
        return Machine(self.transmission, self.linkage, resistance_of(self.design), speed)

    def pair_speed_rad_s(self, angle_rad: Array) -> Array:
        """Speed of the pair's driving gear at its own angles in rad, shape (n,)."""
        return self.pair.speed(angle_rad) * self.machine.speed_rad_s

    @cached_property
    def uniform_machine(self) -> Machine:
        """The same linkage on a crank that turns evenly, at the same number of strokes per minute."""
        return replace(self.machine, transmission=uniform_law(self.transmission.lobes))

    @cached_property
    def motion(self) -> SliderMotion:
        """The slider's motion at the operating speed, sampled."""
        with self.stopwatch("motion"):
            return self.machine.motion(sample_angles(self.transmission))

    @cached_property
    def uniform_motion(self) -> SliderMotion:
        """The uniform crank's motion at the same angles."""
        with self.stopwatch("motion"):
            return self.uniform_machine.motion(self.motion.phi1_rad)

    @cached_property
    def check(self) -> KinematicCheck:
        """Exact peaks at the operating speed."""
        with self.stopwatch("check"):
            return kinematic_check(self.machine)

    @cached_property
    def uniform_check(self) -> KinematicCheck:
        """The uniform crank's peaks at the same speed."""
        with self.stopwatch("check"):
            return kinematic_check(self.uniform_machine)

    @cached_property
    def masses(self) -> Masses:
        """The moving masses; makes teeth only where a gear's moment of inertia is left out."""
        from ncgear.recipe.masses import masses_of

        given, gears, tolerance = self.design.masses, self.design.gears, self.design.output.chord_tolerance_mm
        if given is None:
            raise WrongInput("missing; forces need slider_kg, rod and crank", key="masses")
        if gears is None or given.tells_gears:
            return masses_of(given)
        from ncgear.recipe.gear_inertia import body_inertias_kg_mm2

        module, outlines = self.pitch.size.module_mm, (self.teeth.driving.outline_mm, self.teeth.driven.outline_mm)
        return masses_of(given, *body_inertias_kg_mm2(gears, *outlines, module, tolerance, given.density_kg_m3))

    @cached_property
    def rigid(self) -> Rigid:
        """What the machine bears at constant driving speed."""
        return self._rigid(self.machine)

    @cached_property
    def uniform_rigid(self) -> Rigid:
        """What the uniform crank bears with the same masses."""
        return self._rigid(self.uniform_machine)

    def _rigid(self, machine: Machine) -> Rigid:
        from ncgear.dynamics.inverse import RigidMachine
        from ncgear.dynamics.rigid import rigid_level

        if self.design.stages > 1:
            raise WrongInput("two pairs of gears; forces are computed of one", key="motion.second_stage")
        place = None if self.design.gears is None else mesh_place(self.gears, self.pitch.center_distance_mm)
        masses = self.masses
        with self.stopwatch("forces"):
            return rigid_level(RigidMachine(machine, masses, place))

    @cached_property
    def pitch(self) -> PitchPair:
        """Both pitch curves at their size."""
        from ncgear.pitch.pair import sized_pair
        from ncgear.pitch.shape import Mesh

        gears, transmission = self.gears, self.pair.transmission
        with self.stopwatch("pitch curves"):
            size = gears.teeth, gears.module_mm, gears.center_distance_mm
            return sized_pair(transmission, *size, Mesh(gears.mesh))

    @cached_property
    def rack(self) -> BasicRack:
        """The basic rack at the module."""
        return rack_of(self.gears, self.pitch.size.module_mm)

    @cached_property
    def tooth_form(self) -> ToothForm:
        """Everything asked of the teeth, at the module; of helical ones, that their tips do not jump with height."""
        from ncgear.solids.even_tips import with_even_tips

        form, pitch = tooth_form(self.gears, self.pitch.size.module_mm), self.pitch
        if self.helix is None:
            return form
        with self.stopwatch("teeth"):
            return with_even_tips(pitch, form, self.helix)

    @cached_property
    def teeth(self) -> ToothedPair:
        """Both toothed gears."""
        from ncgear.teeth.gear import toothed_pair

        pitch, form = self.pitch, self.tooth_form
        with self.stopwatch("teeth"):
            return toothed_pair(pitch, form, self.design.output.chord_tolerance_mm)

    @cached_property
    def designed_contact(self) -> AsDesigned:
        """Contact of the exact teeth, which must not overlap."""
        from ncgear.contact.as_designed import as_designed
        from ncgear.contact.pair_contact import refuse_overlap
        from ncgear.contact.placement import placed
        from ncgear.contact.shortness import refuse_short_contact

        pitch, teeth = self.pitch, self.teeth
        with self.stopwatch("contact"):
            contact = as_designed(teeth, placed(pitch))
            refuse_overlap(contact, self.design.output.chord_tolerance_mm)
            refuse_short_contact(contact, teeth, self._asked_of_section(contact.longest_gap_pitches))
            return contact

    def contact(self, written: Sequence[Outlines]) -> PairContact:
        """Contact of the exact teeth and of outlines that were written, which must touch where the teeth do."""
        from ncgear.contact.pair_contact import pair_contact, refuse_bad_outlines

        designed, pitch, teeth = self.designed_contact, self.pitch, self.teeth
        with self.stopwatch("written contact"):
            contact = pair_contact(pitch, teeth, designed, written)
            refuse_bad_outlines(contact, self.design.output.chord_tolerance_mm)
            return contact

    @property
    def helix(self) -> Helix | None:
        """The helix of the teeth; None where they are straight."""
        return helix_of(self.gears)

    @property
    def overlap_ratio(self) -> float:
        """What the helix adds to the contact ratio: its advance in pitches."""
        return self.helix.largest_advance_mm / self.rack.pitch_mm if self.helix else 0.0

    @cached_property
    def section_contact_ratio(self) -> float:
        """Least arc of contact of any pair of flanks in the sections of helical teeth, in pitches."""
        from ncgear.solids.section_contact import least_section_contact
        from ncgear.solids.sections import Sections

        assert self.helix is not None
        pitch, form, tolerance = self.pitch, self.tooth_form, self.design.output.chord_tolerance_mm
        return least_section_contact(Sections(pitch, form, self.helix, tolerance))

    def _asked_of_section(self, gap: float) -> float:
        """The contact ratio that a section must have, which loses contact over ``gap`` pitches.

        Of helical teeth, what the overlap leaves to it; at least that contact never ceases where it is less than the
        gap.
        """
        least = self.gears.least_contact_ratio
        return least if gap > self.overlap_ratio and least <= 1.0 else least - self.overlap_ratio

    @cached_property
    def solids(self) -> SolidPair:
        """Both gears as closed meshes."""
        return self._straight_solids() if self.helix is None else self._helical_solids(self.helix)

    def _helical_solids(self, helix: Helix) -> SolidPair:
        from ncgear.pitch.shape import Gear
        from ncgear.solids.helical import helical_pair

        gears, pitch, form = self.gears, self.pitch, self.tooth_form
        if pitch.driven.is_ring:
            raise WrongInput("helical teeth of internal pairs are not made; leave it out", key="gears.helix")
        blanks = {Gear.DRIVING: _blank(gears, gears.driving), Gear.DRIVEN: _blank(gears, gears.driven)}
        with self.stopwatch("solids"):
            return helical_pair(pitch, form, helix, blanks, self.design.output.chord_tolerance_mm)

    def _straight_solids(self) -> SolidPair:
        from ncgear.solids.pair import SolidPair

        with self.stopwatch("solids"):
            return SolidPair(_driving_solid(self), _driven_solid(self))


def _driving_solid(drive: Drive) -> GearSolid:
    from ncgear.solids.pair import driving_solid

    pitch, blank = drive.pitch, _blank(drive.gears, drive.gears.driving)
    tolerance = drive.design.output.chord_tolerance_mm
    return driving_solid(drive.teeth.driving.outline_mm, blank, pitch.size.module_mm, tolerance, pitch.mesh)


def _driven_solid(drive: Drive) -> GearSolid:
    from ncgear.solids.pair import driven_solid
    from ncgear.solids.ring import RingBlank, ring_solid

    gears, outline, module = drive.gears, drive.teeth.driven.outline_mm, drive.pitch.size.module_mm
    tolerance = drive.design.output.chord_tolerance_mm
    if drive.pitch.driven.is_ring:
        ring = RingBlank(gears.face_width_mm, rim_mm_of(gears, module), gears.index_holes)
        return ring_solid(outline, ring, module, tolerance)
    return driven_solid(outline, _blank(gears, gears.driven), module, tolerance)


def _blank(gears: Gears, body: GearBody) -> Blank:
    from ncgear.solids.pair import Blank

    return Blank(gears.face_width_mm, bore_of(body), gears.index_holes)
