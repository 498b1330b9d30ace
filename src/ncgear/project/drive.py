"""A stage of a drive: an attribute that is computed when it is first asked for, and once.

The stages of a drive that need no gear: law, machine, motion, check.

The stages of a drive from the pitch curves to the contact of the teeth.

The stage of a drive that makes bodies of the teeth.

The stages of a drive that need masses.

The drive: one design, whose stages are computed when they are first asked for, and once.

A drive from a design file.
"""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import AbstractContextManager, nullcontext
from dataclasses import replace
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, Self, TypeVar, overload

from ncgear.design.keys.base import listed
from ncgear.design.keys.design import Design
from ncgear.design.keys.gears import Gears
from ncgear.design.mechanisms import entry_of
from ncgear.design.reading.design_file import LoadedDesign, parsed
from ncgear.design.reading.design_file import load as load_design
from ncgear.errors import WrongInput
from ncgear.kinematics.check import KinematicCheck, kinematic_check
from ncgear.kinematics.motion import Machine, SliderMotion, sample_angles
from ncgear.mechanisms.masses import Masses
from ncgear.mechanisms.mechanism import Mechanism
from ncgear.numerics.arrays import Array
from ncgear.numerics.units import RAD_S_PER_RPM
from ncgear.project.gears import helix_of, mesh_place, rack_of, tooth_form
from ncgear.project.law import Law, law_of, resistance_of
from ncgear.ratio.laws.uniform import uniform_law
from ncgear.ratio.transmission import Pair, Transmission
from ncgear.stopwatch import Stopwatch
from ncgear.teeth.rack import BasicRack

if TYPE_CHECKING:
    from ncgear.contact.designed.sides import AsDesigned
    from ncgear.contact.pair import PairContact
    from ncgear.contact.written.outline_contact import Outlines
    from ncgear.dynamics.meshing import Meshing
    from ncgear.dynamics.motion_in_time import Course
    from ncgear.dynamics.quasi_static import LoadedContact
    from ncgear.dynamics.rigid import Rigid
    from ncgear.pitch.pair import PitchPair
    from ncgear.solids.helical.helix import Helix
    from ncgear.solids.mesh.pair import GearSolid, SolidPair
    from ncgear.teeth.form import ToothForm
    from ncgear.teeth.gear import ToothedPair

Value = TypeVar("Value", covariant=True)


class stage(cached_property[Value]):
    """A cached property of a drive, whose errors name the place in the design file, whoever asks for it."""

    @overload
    def __get__(self, instance: None, owner: type[Any] | None = None) -> Self: ...

    @overload
    def __get__(self, instance: Any, owner: type[Any] | None = None) -> Value: ...

    def __get__(self, instance: Any, owner: type[Any] | None = None) -> Self | Value:
        if instance is None:
            return self
        with instance.locating():
            found: Value = super().__get__(instance, owner)
            return found


class MotionStages:
    """The law, and the slider's motion by it."""

    def __init__(self, design: Design, stage: int | None = None, loaded: LoadedDesign | None = None) -> None:
        self.design = design
        self.stage = stage
        self.loaded = loaded
        self.stopwatch = Stopwatch()

    def locating(self) -> AbstractContextManager[None]:
        """A context in which errors of the design get the place of their key in its file, where it came from one."""
        return self.loaded.locating() if self.loaded else nullcontext()

    @stage
    def pair(self) -> Pair:
        """The law that the gears follow; raises WrongInput where the stage is not told."""
        if self.stage is None and self.design.stages > 1:
            raise WrongInput(
                "two pairs of gears, and one is asked for; Drive.by_stage has each", key="motion.second_stage"
            )
        return self.law.train.pairs[(self.stage or 1) - 1]

    @property
    def timing_s(self) -> dict[str, float]:
        """Seconds spent in each stage so far."""
        return dict(self.stopwatch.seconds)

    @stage
    def gears(self) -> Gears:
        """What the file says of the gears; raises WrongInput when it says nothing."""
        if self.design.gears is None:
            raise WrongInput("missing; gears need teeth, module_mm, face_width_mm and more", key="gears")
        return self.design.gears

    @stage
    def law(self) -> Law:
        """Linkage and closed law."""
        with self.stopwatch("law"):
            return law_of(self.design)

    @property
    def linkage(self) -> Mechanism:
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

    @stage
    def machine(self) -> Machine:
        """The mechanism at the operating speed."""
        speed = self.design.operation.speed_rpm * RAD_S_PER_RPM
        return Machine(self.transmission, self.linkage, resistance_of(self.design), speed)

    def pair_speed_rad_s(self, angle_rad: Array) -> Array:
        """Speed of the pair's driving gear at its own angles in rad, shape (n,)."""
        return self.pair.speed(angle_rad) * self.machine.speed_rad_s

    @stage
    def uniform_machine(self) -> Machine:
        """The same linkage on a crank that turns evenly, at the same number of strokes per minute."""
        return replace(self.machine, transmission=uniform_law(self.transmission.lobes))

    @stage
    def motion(self) -> SliderMotion:
        """The slider's motion at the operating speed, sampled."""
        with self.stopwatch("motion"):
            return self.machine.motion(sample_angles(self.transmission))

    @stage
    def uniform_motion(self) -> SliderMotion:
        """The uniform crank's motion at the same angles."""
        with self.stopwatch("motion"):
            return self.uniform_machine.motion(self.motion.phi1_rad)

    @stage
    def check(self) -> KinematicCheck:
        """Exact peaks at the operating speed."""
        with self.stopwatch("check"):
            return kinematic_check(self.machine)

    @stage
    def uniform_check(self) -> KinematicCheck:
        """The uniform crank's peaks at the same speed."""
        with self.stopwatch("check"):
            return kinematic_check(self.uniform_machine)


class ToothStages(MotionStages):
    """Pitch curves, teeth, and their contact."""

    @stage
    def pitch(self) -> PitchPair:
        """Both pitch curves at their size."""
        from ncgear.pitch.pair import sized_pair
        from ncgear.pitch.shape import Mesh

        gears, transmission = self.gears, self.pair.transmission
        with self.stopwatch("pitch curves"):
            size = gears.teeth, gears.module_mm, gears.center_distance_mm
            return sized_pair(transmission, *size, Mesh(gears.mesh))

    @stage
    def rack(self) -> BasicRack:
        """The basic rack at the module."""
        return rack_of(self.gears, self.pitch.size.module_mm)

    @property
    def helix(self) -> Helix | None:
        """The helix of the teeth; None where they are straight."""
        return helix_of(self.gears)

    @property
    def overlap_ratio(self) -> float:
        """What the helix adds to the contact ratio: its advance in pitches."""
        return self.helix.largest_advance_mm / self.rack.pitch_mm if self.helix else 0.0

    @stage
    def tooth_form(self) -> ToothForm:
        """Everything asked of the teeth, at the module; of helical ones, that their tips do not jump with height."""
        from ncgear.solids.helical.even_tips import with_even_tips

        form, pitch = tooth_form(self.gears, self.pitch.size.module_mm), self.pitch
        if self.helix is None:
            return form
        with self.stopwatch("teeth"):
            return with_even_tips(pitch, form, self.helix)

    @stage
    def teeth(self) -> ToothedPair:
        """Both toothed gears."""
        from ncgear.teeth.gear import toothed_pair

        pitch, form = self.pitch, self.tooth_form
        with self.stopwatch("teeth"):
            return toothed_pair(pitch, form, self.design.output.chord_tolerance_mm)

    @stage
    def designed_contact(self) -> AsDesigned:
        """Contact of the exact teeth, which must not overlap."""
        from ncgear.contact.designed.sides import as_designed
        from ncgear.contact.pair import refuse_overlap, refuse_short_contact
        from ncgear.contact.placement import placed

        pitch, teeth = self.pitch, self.teeth
        with self.stopwatch("contact"):
            contact = as_designed(teeth, placed(pitch))
            refuse_overlap(contact, self.design.output.chord_tolerance_mm)
            refuse_short_contact(contact, teeth, self._asked_of_section(contact.longest_gap_pitches))
            return contact

    def require_sound_teeth(self) -> None:
        """Raise WrongInput or NoSuchMechanism where the contact of the exact teeth is not sound."""
        _ = self.designed_contact

    @property
    def sound_teeth(self) -> ToothedPair:
        """Both toothed gears, once their contact is found sound."""
        self.require_sound_teeth()
        return self.teeth

    def contact(self, written: Sequence[Outlines]) -> PairContact:
        """Contact of the exact teeth and of outlines that were written, which must touch where the teeth do."""
        from ncgear.contact.pair import pair_contact, refuse_bad_outlines

        designed, pitch, teeth = self.designed_contact, self.pitch, self.teeth
        with self.locating(), self.stopwatch("written contact"):
            contact = pair_contact(pitch, teeth, designed, written)
            refuse_bad_outlines(contact, self.design.output.chord_tolerance_mm)
            return contact

    @stage
    def section_contact_ratio(self) -> float:
        """Least arc of contact of any pair of flanks in the sections of helical teeth, in pitches."""
        from ncgear.solids.helical.sections import Sections, least_section_contact

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


class SolidStages(ToothStages):
    """Both gears as bodies."""

    @stage
    def solids(self) -> SolidPair:
        """Both gears as closed meshes."""
        return self._straight_solids() if self.helix is None else self._helical_solids(self.helix)

    def _helical_solids(self, helix: Helix) -> SolidPair:
        from ncgear.pitch.shape import Gear
        from ncgear.project.bodies import blank_of
        from ncgear.solids.helical.mesh import helical_pair

        gears, pitch, form = self.gears, self.pitch, self.tooth_form
        if pitch.driven.is_ring:
            raise WrongInput("helical teeth of internal pairs are not made; leave it out", key="gears.helix")
        blanks = {Gear.DRIVING: blank_of(gears, gears.driving), Gear.DRIVEN: blank_of(gears, gears.driven)}
        with self.stopwatch("solids"):
            return helical_pair(pitch, form, helix, blanks, self.design.output.chord_tolerance_mm)

    def _straight_solids(self) -> SolidPair:
        from ncgear.solids.mesh.pair import SolidPair

        with self.stopwatch("solids"):
            return SolidPair(_driving_solid(self), _driven_solid(self))


def _driving_solid(drive: SolidStages) -> GearSolid:
    from ncgear.project.bodies import blank_of
    from ncgear.solids.mesh.pair import driving_solid

    pitch, blank = drive.pitch, blank_of(drive.gears, drive.gears.driving)
    tolerance = drive.design.output.chord_tolerance_mm
    return driving_solid(drive.teeth.driving.outline_mm, blank, pitch.size.module_mm, tolerance, pitch.mesh)


def _driven_solid(drive: SolidStages) -> GearSolid:
    from ncgear.project.bodies import blank_of, ring_blank_of
    from ncgear.solids.mesh.pair import driven_solid
    from ncgear.solids.mesh.ring import ring_solid

    gears, outline, module = drive.gears, drive.teeth.driven.outline_mm, drive.pitch.size.module_mm
    tolerance = drive.design.output.chord_tolerance_mm
    if drive.pitch.driven.is_ring:
        return ring_solid(outline, ring_blank_of(gears, module), module, tolerance)
    return driven_solid(outline, blank_of(gears, gears.driven), module, tolerance)


class ForceStages(SolidStages):
    """What the machine's masses and its teeth bear."""

    @stage
    def masses(self) -> Masses:
        """The moving masses; makes solids only where a gear's moment of inertia is left out."""
        from ncgear.project.forces import masses_of

        given, gears = self.design.masses, self.design.gears
        if given is None:
            needed = listed(entry_of(self.design.linkage).needed_masses, "and")
            raise WrongInput(f"missing; forces need {needed}", key="masses")
        if gears is None or given.tells_gears:
            return masses_of(given, self.linkage)
        from ncgear.solids.inertia import body_kg_mm2

        plans, density = (self.solids.driving.plan, self.solids.driven.plan), given.density_kg_m3
        driving, driven = (body_kg_mm2(plan, density) for plan in plans)
        return masses_of(given, self.linkage, driving, driven)

    @stage
    def rigid(self) -> Rigid:
        """What the machine bears at constant driving speed."""
        return self._rigid(self.machine)

    @stage
    def uniform_rigid(self) -> Rigid:
        """What the uniform crank bears with the same masses."""
        return self._rigid(self.uniform_machine)

    def _rigid(self, machine: Machine) -> Rigid:
        from ncgear.dynamics.rigid import RigidMachine, rigid_level

        if self.design.stages > 1:
            raise WrongInput("two pairs of gears; forces are computed of one", key="motion.second_stage")
        place = None if self.design.gears is None else mesh_place(self.gears, self.pitch.center_distance_mm)
        masses = self.masses
        with self.stopwatch("forces"):
            return rigid_level(RigidMachine(machine, masses, place))

    @stage
    def meshing(self) -> Meshing:
        """The straight teeth of the pair as they bear load; they must touch as designed."""
        from ncgear.project.forces import meshing_of

        if self.helix is not None:
            raise WrongInput("helical teeth are not followed under load; leave it out", key="gears.helix")
        pitch, teeth = self.pitch, self.sound_teeth
        with self.stopwatch("gaps"):
            return meshing_of(self.design.simulation, pitch, teeth)

    @stage
    def loaded_contact(self) -> LoadedContact:
        """The teeth under the torque of the rigid level, at the angles of ``motion``."""
        from ncgear.dynamics.quasi_static import loaded_contact

        phi1, meshing = self.motion.phi1_rad, self.meshing
        torque = self.rigid.machine.at(phi1).driven_torque.value
        with self.stopwatch("loaded contact"):
            return loaded_contact(meshing, phi1, torque, self.machine.speed_rad_s)

    @stage
    def course(self) -> Course:
        """The motion of the toothed mechanism in time."""
        from ncgear.dynamics.crank_load import crank_load
        from ncgear.dynamics.motion_in_time import Start, ToothedMachine, course, started
        from ncgear.project.forces import drive_line_of

        given, masses, meshing = self.design.simulation, self.masses, self.meshing
        driving = drive_line_of(given, masses, self.machine.speed_rad_s)
        with self.stopwatch("motion in time"):
            mechanism = ToothedMachine(driving, meshing, crank_load(self.linkage, masses, self.machine.resistance))
            return course(mechanism, started(mechanism, self.transmission, Start(given.start)), given.turns)


class Drive(ForceStages):
    """A design and all that follows from it.

    Stages are attributes; each needs only the ones it is made from, so a check of power never makes a tooth.  They
    raise WrongInput or NoSuchMechanism, with the design file's key, when the stage cannot be made.

    Of a design in two stages, law and motion are those of the whole machine; pitch curves, teeth, contact and solids
    are those of the pair that ``stage`` tells, 1 or 2, and only one of ``by_stage`` has them.
    """

    def __repr__(self) -> str:
        stage = "" if self.stage is None else f", stage {self.stage}"
        speed = self.design.operation.speed_rpm
        return f"Drive({self.design.name!r}, law {self.design.motion.law}, {speed:g} r/min{stage})"

    @stage
    def by_stage(self) -> tuple[Drive, ...]:
        """The same drive for each of its pairs of gears, from the driving shaft on; one pair has itself."""
        if self.design.stages == 1 or self.stage is not None:
            return (self,)
        return tuple(Drive(self.design, number, self.loaded) for number in range(1, self.design.stages + 1))


def load(path: str | Path) -> Drive:
    """The drive of a design file, whose stages are attributes.

    Raises WrongInput, with ``FILE:LINE:COLUMN``, for a file that is wrong; stages raise it or NoSuchMechanism, with
    the same places, once they are asked for.

    >>> drive = load("designs/baler.yaml")
    >>> drive
    Drive('baler', law three_segment_stroke, 20 r/min)
    >>> f"{drive.check.peak_power_w.value:.0f} W"
    '6315 W'
    >>> f"{drive.pitch.center_distance_mm:.3f} mm"
    '74.885 mm'
    """
    return _drive(load_design(Path(path)))


def loads(text: str, name: str = "text") -> Drive:
    """The drive of a design file's text, which messages call ``name``; otherwise as ``load``.

    >>> machine = "linkage: {crank_mm: 40, rod_mm: 90}, operation: {speed_rpm: 30}"
    >>> drive = loads(f"{{name: even, {machine}, motion: {{law: uniform_crank}}}}")
    >>> f"{drive.linkage.stroke_mm:g} mm"
    '80 mm'
    """
    return _drive(parsed(text, Path(name)))


def _drive(loaded: LoadedDesign) -> Drive:
    return Drive(loaded.design, loaded=loaded)
