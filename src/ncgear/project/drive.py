"""The drive: a design and all values that follow from it; each is computed once, when it is first asked for."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import lru_cache, partial
from itertools import chain
from time import perf_counter
from typing import TYPE_CHECKING, Literal

import numpy as np

from ncgear.design.words import listed
from ncgear.errors import DesignError, NoSuchMechanism, WrongInput, located
from ncgear.numerics.arrays import Array, distinct
from ncgear.pitch.shape import Gear
from ncgear.project.geared import Geared
from ncgear.project.moving import computed, computed_by, left_words

if TYPE_CHECKING:
    from ncgear.contact.designed.as_designed import AsDesigned
    from ncgear.contact.designed.extremes import ContactExtremes, ValueRange
    from ncgear.contact.pair import PairContact, SidesInContact
    from ncgear.contact.written.as_written import Outlines
    from ncgear.drivetrain.jam import Jam
    from ncgear.drivetrain.motor import Stall
    from ncgear.dynamics.driven_side import Knock
    from ncgear.dynamics.flank_changes import BorneTorque
    from ncgear.dynamics.history import MotionPeaks
    from ncgear.dynamics.knocking import KnockingMachine
    from ncgear.dynamics.meshing import Meshing
    from ncgear.dynamics.motion_in_time import Course
    from ncgear.dynamics.quasi_static import LoadedContact, LoadedPeaks
    from ncgear.dynamics.rigid import LoadPeaks
    from ncgear.formulas.checked import Formulas
    from ncgear.project.drivetrain import DrivetrainResult
    from ncgear.project.face_load import FaceLoading, ToldFaceLoad
    from ncgear.project.passing import Passing
    from ncgear.project.thickness import AtThickness
    from ncgear.project.tooth_load import ToothLoad
    from ncgear.project.tooth_strength import JudgedTeeth, Method, Rim
    from ncgear.project.workshop_measures import CutGear, GearMeasures
    from ncgear.ratio.transmission import Law
    from ncgear.strength.answer import Strength
    from ncgear.strength.loading import Loading
    from ncgear.strength.material import Material
    from ncgear.strength.sections import InSections
    from ncgear.strength.stiffness import LinearTeeth
    from ncgear.strength.surfaces import Surfaces
    from ncgear.strength.vibration import Vibration

MOTOR = "simulation.motor"


class Drive(Geared):
    """A design and everything that follows from it: law, motion, pitch curves, teeth, contact, solids, forces.

    Each of these is an attribute.  It computes only the attributes that it needs, so a check of power never makes a
    tooth.  Where it cannot be made it raises WrongInput or NoSuchMechanism, with key and place in the file.

    Pairs of gears in series are stages.  Law and motion of such a design belong to the whole machine.  Pitch
    curves, teeth, contact, solids and strength belong to one pair: only the drives in ``by_stage`` have them, and their
    ``stage`` is the number of the pair, from 1 on.
    """

    @computed
    def law(self) -> Law:
        """Linkage and closed law, shared out by the strength of its pairs where the design asks for that."""
        gears = self.design.gears
        if self._whole is not None or gears is None or gears.sharing != "safety":
            return super().law
        return self._shared_by(gears.sharing)

    @computed_by
    def _shared_by(self, _sharing: Literal["safety"]) -> Law:
        """The law shared out as safely as can be; a refusal, which takes several ratings, is kept too."""
        gears = self.gears
        from ncgear.project.safest_parts import safest_parts
        from ncgear.strength.holding import weakest_under, worst

        @lru_cache(maxsize=1)
        def shared_out(parts: tuple[float, ...]) -> Drive:
            changed = gears.model_copy(update={"sharing": "even", "parts": parts})
            return Drive(self.design.model_copy(update={"gears": changed}), loaded=self.loaded)

        def share(parts: tuple[float, ...], number: int) -> float:
            pair = shared_out(parts).by_stage[number]
            return worst(weakest_under(pair.strength_by("estimate"), pair.conditions)).share

        with self.stopwatch("law"):
            return shared_out(safest_parts(share, self.design.stages)).law

    @computed
    def by_stage(self) -> tuple[Drive, ...]:
        """One drive for each pair of gears, from the driving shaft on; with a single pair, this drive alone."""
        if self.design.stages == 1 or self.stage is not None:
            return (self,)
        return tuple(Drive(self.design, number, self.loaded, self) for number in range(1, self.design.stages + 1))

    def of_stage(self, stage: int | None) -> Drive:
        """The drive of one pair of gears: of a stage of pairs in series, or of the only pair with None.

        Raises WrongInput for a stage that is not there, and for None with several pairs.
        """
        if stage is None and self.design.stages > 1:
            said, key = self.design.stages_said
            numbers = listed(f"--stage {pair.stage}" for pair in self.by_stage)
            raise WrongInput(f"given: {said}; {numbers} says which one", key=key)
        if stage is not None and self.design.stages == 1:
            raise WrongInput("has one pair of gears; leave out --stage", key="motion")
        if stage is not None and stage > self.design.stages:
            said, key = self.design.stages_said
            raise WrongInput(f"given: {said}; there is no --stage {stage}", key=key)
        return self.by_stage[0 if stage is None else stage - 1]

    @computed
    def formulas(self) -> Formulas:
        """The law in closed form, piece by piece, as expressions of sympy, compared with its numbers."""
        law = self.law
        from ncgear.formulas.checked import formulas_of
        from ncgear.formulas.laws import Sizes

        sizes: list[Sizes | None] = [None] * self.design.stages
        if self.design.gears is not None:
            pitches = [drive.pitch for drive in self.by_stage]
            sizes = [Sizes(pitch.center_distance_mm, int(pitch.mesh.sense)) for pitch in pitches]
        with self.stopwatch("formulas"):
            return formulas_of(self.design.name, str(self.design.motion.law), law, sizes)

    @computed
    def free_contact(self) -> AsDesigned:
        """Contact of the exact teeth, of any length; raises where they overlap."""
        from ncgear.contact.designed.as_designed import as_designed
        from ncgear.contact.pair import refuse_clashing_bodies, refuse_cut_arcs, refuse_overlap
        from ncgear.contact.placement import placed

        pitch, teeth = self.pitch, self.teeth
        with self.stopwatch("contact"):
            contact = as_designed(teeth, placed(pitch))
            refuse_cut_arcs(contact)
            refuse_overlap(contact, self.chord_tolerance_mm)
            refuse_clashing_bodies(contact, teeth, self.chord_tolerance_mm)
            return contact

    @computed
    def pairs_under_load(self) -> SidesInContact | None:
        """The pairs of flanks that touch under the torque of the rigid level, on both sides of the teeth.

        None where no load is known, where teeth are helical, and where a load brings no further flanks into contact,
        for example without relief.  Raises as ``loaded_contact`` does.
        """
        from ncgear.contact.designed.as_designed import pairs_under_load

        contact = self.free_contact
        if not contact.held_apart or self.design.masses is None or self.helix is not None or self.design.stages > 1:
            return None
        error = self._loaded_at(contact.placement.phi1_rad).error_rad
        with self.stopwatch("contact"):
            return pairs_under_load(self.teeth, contact.placement, error)

    @computed
    def designed_contact(self) -> AsDesigned:
        """Contact of the exact teeth; raises where they overlap or where the contact ratio is too small.

        Idle flanks are judged only where the design drives both ways.
        """
        from ncgear.contact.pair import refuse_short_contact

        refuse_short_contact(self.short_contacts, both_ways=self.gears.drives == "both_ways")
        return self.free_contact

    @computed
    def short_contacts(self) -> tuple[str | None, str | None]:
        """The missing contact ratio of pushing flanks, and of their backs, in words; None where nothing is missing."""
        from ncgear.contact.pair import short_contacts

        contact, least = self.free_contact, self.gears.least_contact_ratio
        return short_contacts(contact, self.teeth, least, self.overlap_ratio, self.pairs_under_load)

    @computed
    def contact_extremes(self) -> ContactExtremes:
        """Extremes of the contact of the exact teeth, also between its positions; raises where teeth overlap."""
        _ = self.designed_contact
        return self._free_extremes

    @computed
    def _free_extremes(self) -> ContactExtremes:
        """Extremes of the contact of teeth whose contact may be too short."""
        from ncgear.contact.pair import sound_extremes

        designed, tolerance = self.free_contact, self.chord_tolerance_mm
        with self.stopwatch("contact"):
            return sound_extremes(self.pitch, self.teeth, designed, self.pair_speed_rad_s, tolerance)

    @computed
    def thickness_band(self) -> tuple[AtThickness, ...]:
        """The pair at three tooth thicknesses: the least allowed, the outlines' thickness, the greatest allowed.

        Empty where the file gives no limits of the thickness; raises where the thickest teeth overlap.
        """
        from ncgear.project.thickness import thickness_band

        contact, extremes = self.designed_contact, self.contact_extremes
        with self.stopwatch("contact"):
            return thickness_band(self, contact, extremes)

    @property
    def play_range_rad(self) -> tuple[float, float]:
        """Least and greatest play of the driven gear; both are the same where teeth have no deviation of thickness."""
        if self.play.thicker_mm == 0.0:
            return self.play.driven_rad, self.play.driven_rad
        found = self.contact_extremes.backlash_rad
        return found.low.value, found.high.value

    @computed
    def passings(self) -> tuple[Passing, ...]:
        """How near crank pin and rods come to shafts, hubs and stops beside the gears; empty without a linkage."""
        from ncgear.project.passing import passings_of

        return passings_of(self)

    def require_sound_teeth(self) -> None:
        """Raise WrongInput or NoSuchMechanism where the contact of the exact teeth is not sound."""
        _ = self.contact_extremes

    def require_sound_pairs(self) -> None:
        """Raise as ``require_sound_teeth`` does for any pair of gears; a design without gears has none."""
        for pair in self.by_stage if self.design.gears is not None else ():
            pair.require_sound_teeth()

    def contact(self, written: Sequence[Outlines]) -> PairContact:
        """Contact of the exact teeth and of the written outlines.

        Raises where the written outlines overlap, or do not touch although the exact teeth touch.
        """
        from ncgear.contact.pair import pair_contact, refuse_bad_outlines

        designed, pitch, teeth = self.designed_contact, self.pitch, self.teeth
        with located(self.places), self.stopwatch("written contact"):
            contact = pair_contact(pitch, teeth, designed, written)
            refuse_bad_outlines(contact, self.chord_tolerance_mm)
            return contact

    @computed
    def drivetrain(self) -> DrivetrainResult:
        """Bearings, shafts, losses, motor and couplings around the gears; raises WrongInput without the section."""
        from ncgear.drivetrain.losses import TouchingTeeth
        from ncgear.project.drivetrain import drivetrain_of

        if self.design.drivetrain is None:
            raise WrongInput("missing; it tells bearings, shafts, motor and more around the gears", key="drivetrain")
        if self.stage is not None:
            return self.whole.drivetrain
        rigid, knocking, jam = self.rigid, self.knocking, self.jam
        straight = self.by_stage if self.helix is None else ()
        touching = [(TouchingTeeth(stage.teeth, stage.pitch, stage.designed_contact), stage.pair) for stage in straight]
        with self.stopwatch("drivetrain"):
            return drivetrain_of(self.design, rigid, touching, knocking, jam)

    @computed
    def jam(self) -> Jam | None:
        """The machine with a blocked output; None where no overload is given."""
        from ncgear.drivetrain.jam import Jam
        from ncgear.kinematics.motion import sample_angles

        overload = self.conditions.overload
        if overload is None:
            return None
        return Jam.of(self.rigid.machine, overload.driving_n_mm, sample_angles(self.transmission))

    @computed
    def knocks(self) -> tuple[Knock, ...] | None:
        """The knocks of all teeth in a turn of the driven gear; None where they are not computed or are refused."""
        try:
            found = [pair.loading_by(self.design.strength.method).knocks for pair in self.whole.by_stage]
        except DesignError:
            # Shafts and bearings are judged even if the teeth are refused.
            return None
        each = [knocks for knocks in found if knocks is not None]
        return tuple(chain.from_iterable(each)) if len(each) == len(found) else None

    @computed
    def knocking(self) -> KnockingMachine | None:
        """The loaded machine with the knocks of its teeth; None without knocks."""
        from ncgear.dynamics.knocking import KnockingMachine

        if not self.knocks:
            return None
        each = [pair.loading_by(self.design.strength.method).borne for pair in self.whole.by_stage]
        borne = tuple(torque for torque in each if torque is not None)
        return KnockingMachine(self.rigid.machine, self.law.train.pairs, borne) if len(borne) == len(each) else None

    @computed
    def knocking_peaks(self) -> LoadPeaks | None:
        """The largest forces of the machine with the knocks of its teeth; None without knocks."""
        from ncgear.kinematics.motion import sample_angles

        if self.knocking is None:
            return None
        with self.stopwatch("knocks"):
            return self.knocking.peaks(sample_angles(self.transmission))

    @computed
    def motor_stall(self) -> Stall | None:
        """Where the motor of the simulation stops within its turns; None if it keeps turning, or if none is given."""
        from ncgear.project.motor import motor_stall

        with self.stopwatch("motor"):
            return motor_stall(self)

    @computed
    def meshing(self) -> Meshing:
        """The teeth of the pair under load; raises where their contact is not sound.

        An impossible stiffness is refused before teeth are made.
        """
        from ncgear.project.forces import require_possible_stiffness

        require_possible_stiffness(self.design.simulation, self.gears.face_width_mm)
        self.require_sound_teeth()
        return self._any_meshing

    @computed
    def tooth_load(self) -> ToothLoad:
        """The torque on the teeth: from the masses, or without masses from the resistance only.

        Raises WrongInput where there is neither, and where there are two pairs and this drive has no stage;
        NoSuchMechanism where teeth cannot carry it.
        """
        from ncgear.project.tooth_load import tooth_load

        return tooth_load(self)

    @computed
    def section_stiffness(self) -> list[LinearTeeth]:
        """The stiffness of each pair of teeth in N/mm in each section, from its form and material by the estimate."""
        from ncgear.project.tooth_strength import estimated, stiffnesses
        from ncgear.strength.sections import InSections

        sections = self.face_sections
        driving, driven = (
            InSections(
                tuple(estimated(section.teeth.of(gear), material, sections.helix_rad) for section in sections.each)
            )
            for gear, material in zip(Gear, self.materials, strict=True)
        )
        width_mm = self.gears.face_width_mm
        return stiffnesses(self.tooth_load, sections, width_mm, (driving, driven), self.materials)

    def loading(self, methods: tuple[InSections, InSections], materials: tuple[Material, Material]) -> Loading:
        """The load of every tooth over a cycle of meetings, shared by the stiffness of the given methods.

        A stiffness given under ``simulation`` is not used.  Raises NoSuchMechanism where teeth are pressed too deep
        into each other, and as ``require_sound_teeth`` and ``tooth_load`` do.
        """
        from ncgear.dynamics.gaps import WITHIN_IN_MODULES
        from ncgear.project.forces import followed_modules

        width_mm, module_mm = self.gears.face_width_mm, self.pitch.size.module_mm
        with located(self.places):
            self.require_sound_teeth()
            with self.stopwatch("load of every tooth"):
                within = followed_modules(self.tooth_load, width_mm, materials, module_mm)
                try:
                    return self._loading_within(within, methods, materials)
                except NoSuchMechanism:
                    if within == WITHIN_IN_MODULES:
                        raise
                    # A jam, or softer teeth, are pressed deeper.
                    return self._loading_within(WITHIN_IN_MODULES, methods, materials)

    def _loading_within(
        self, within_modules: float, methods: tuple[InSections, InSections], materials: tuple[Material, Material]
    ) -> Loading:
        """As ``loading``, with pairs of teeth that are ``within_modules`` of the first contact."""
        from ncgear.contact.placement import BOTH_SIDES
        from ncgear.project.forces import borne_by
        from ncgear.strength.loading import AskedTorque, loading_of, out_and_back

        pitch, sections, load = self.pitch, self.face_sections, self.tooth_load
        asked = AskedTorque.of(pitch, load.torque_n_mm)
        sides = BOTH_SIDES if load.load == "masses" or load.loads_return else asked.sides
        meshing, speed = self._bearing(methods, materials, sides, within_modules), self.pair_speed_rad_s
        given, stage = self.design.simulation, self.stage
        borne = borne_by(given, load, meshing) if stage is None else self.whole.train_borne[stage - 1]
        found = loading_of(meshing, sections, pitch, asked, speed, borne)
        if load.loads_return:
            coming = AskedTorque.of(pitch, load.returning_n_mm)
            found = out_and_back(found, loading_of(meshing, sections, pitch, coming, speed))
        if borne.phi1_rad.size:
            knocking = AskedTorque.of(pitch, borne.at, borne)
            found = replace(loading_of(meshing, sections, pitch, knocking, speed, borne), still=found)
        if (jam := self.conditions.overload) is None:
            return found
        jamming = AskedTorque.of(pitch, partial(load.passed_on_n_mm, jam.driving_n_mm))
        return replace(found, jammed=loading_of(meshing, sections, pitch, jamming, speed))

    def _bearing(
        self,
        methods: tuple[InSections, InSections],
        materials: tuple[Material, Material],
        sides: Sequence[int],
        within_modules: float,
    ) -> Meshing:
        """The teeth as in ``meshing_of``, with the stiffness of methods, not of ``simulation``."""
        from ncgear.project.forces import meshing_of
        from ncgear.project.tooth_strength import stiffnesses

        sections, width_mm = self.face_sections, self.gears.face_width_mm
        stiff = stiffnesses(self.tooth_load, sections, width_mm, methods, materials)
        each = [(section.teeth, own) for section, own in zip(sections.each, stiff, strict=True)]
        return meshing_of(self.design.simulation.of_own_stiffness, self.pitch, each, sides, within_modules)

    @computed
    def train_borne(self) -> tuple[BorneTorque, ...]:
        """The torques on the teeth of pairs in series, with the stiffness of the estimate."""
        from ncgear.contact.placement import BOTH_SIDES
        from ncgear.dynamics.flank_changes import BorneTorque
        from ncgear.dynamics.gaps import WITHIN_IN_MODULES
        from ncgear.project.forces import train_borne_by
        from ncgear.project.tooth_strength import methods_of

        loads = [pair.tooth_load for pair in self.by_stage]
        if loads[0].load != "masses":
            return tuple(BorneTorque(load.torque_n_mm, self.transmission.cycle_rad) for load in loads)
        both = BOTH_SIDES, WITHIN_IN_MODULES
        meshings = [
            pair._bearing(methods_of("estimate", pair.face_sections, pair.materials, pair.rims), pair.materials, *both)
            for pair in self.by_stage
        ]
        with self.stopwatch("knocks"):
            return train_borne_by(self.design.simulation, loads, meshings)

    @computed
    def _any_meshing(self) -> Meshing:
        """The teeth of the pair under load, as if their contact were sound."""
        from ncgear.project.forces import meshing_of

        pitch = self.pitch
        sections = [
            (section.teeth, own) for section, own in zip(self.face_sections.each, self.section_stiffness, strict=True)
        ]
        with self.stopwatch("gaps"):
            return meshing_of(self.design.simulation, pitch, sections)

    @computed
    def stiffness_range(self) -> ValueRange:
        """The least and the largest stiffness in N/mm of any touching pair of teeth, anywhere in the cycle.

        Of helical teeth: of the first section's, as wide as the gears.
        """
        from ncgear.contact.designed.as_designed import as_designed
        from ncgear.dynamics.pair_places import stiffness_range
        from ncgear.project.forces import stiffness_of

        sections, designed = self.face_sections.each, self.designed_contact
        own, teeth, count = self.section_stiffness[0], sections[0].teeth, len(sections)
        stiffness = stiffness_of(self.design.simulation, lambda places: count * own(places), 1.0)
        with self.stopwatch("gaps"):
            placed = designed if count == 1 else as_designed(teeth, designed.placement)
            return stiffness_range(self.pitch, teeth, placed, stiffness)

    def _loaded_at(self, phi1_rad: Array, stiffness_factor: float = 1.0) -> LoadedContact:
        """The teeth, stiffer by a factor, under the rigid level's torque at angles of the driving shaft, shape (n,).

        A pair in series stands where the law turns it.  It bears what the teeth behind it and the shaft between need.
        """
        from ncgear.dynamics.quasi_static import loaded_contact

        rigid, number = self.rigid.machine, self.stage or 1
        loads, angles, stiffened = rigid.at(phi1_rad), rigid.angles(phi1_rad, 1), self._any_meshing.stiffened
        torque = loads.driven_torque.value
        if number < self.design.stages:
            behind = self.whole.by_stage[number]._loaded_at(phi1_rad, stiffness_factor)
            shaft = loads.passed[number - 1].value - loads.passed[number].value
            torque = behind.driving_torque_n_mm + shaft / angles[number].derivative(1)
        here, speed = angles[number - 1].value, angles[number - 1].derivative(1) * rigid.machine.speed_rad_s
        return loaded_contact(stiffened(stiffness_factor), here, torque, speed)

    def loaded_error_at(self, phi1_rad: Array, stiffness_factor: float = 1.0) -> Array:
        """The last driven angle beyond the law's in rad, shape (n,): each pair after a pair turns its error on."""
        error = np.zeros_like(phi1_rad)
        for pair in self.by_stage:
            loaded = pair._loaded_at(phi1_rad, stiffness_factor)
            error = pair._any_meshing.law.at(loaded.phi1_rad)[1] * error + loaded.error_rad
        return error

    def transmission_error_with(self, stiffness_factor: float) -> float:
        """Peak to peak variation of ``loaded_error_at`` over the angles of ``motion``."""
        from ncgear.dynamics.quasi_static import variation_rad

        if self.design.stages == 1:
            return self.loaded_peaks_with(stiffness_factor).transmission_error_rad
        places = distinct(np.concatenate([pair.loaded_places_rad for pair in self.by_stage]))
        with self.stopwatch("peaks of loaded contact" if stiffness_factor == 1.0 else "band of stiffness"):
            return variation_rad(partial(self.loaded_error_at, stiffness_factor=stiffness_factor), places)

    @computed
    def loaded_places_rad(self) -> Array:
        """Angles of the driving shaft, rising, at which the peaks of loaded teeth are searched, shape (n,)."""
        from ncgear.project.forces import loaded_places_rad

        return loaded_places_rad(self.motion.phi1_rad, self.pair, self.meshing, self.rigid.machine)

    @computed
    def loaded_contact(self) -> LoadedContact:
        """The teeth under the torque of the rigid level, at the angles of ``motion``."""
        return self._loaded_with(1.0)

    @computed
    def loaded_peaks(self) -> LoadedPeaks:
        """The peaks of the teeth under the torque of the rigid level, over the angles of ``motion``."""
        return self.loaded_peaks_with(1.0)

    def loaded_peaks_with(self, stiffness_factor: float) -> LoadedPeaks:
        """As ``loaded_peaks``, with teeth stiffer by a factor."""
        from ncgear.dynamics.quasi_static import loaded_peaks

        loaded = self.loaded_contact if stiffness_factor == 1.0 else self._loaded_with(stiffness_factor)
        at = partial(self._loaded_at, stiffness_factor=stiffness_factor)
        with self.stopwatch("peaks of loaded contact" if stiffness_factor == 1.0 else "band of stiffness"):
            return loaded_peaks(at, self.loaded_places_rad, int(loaded.pairs.max()))

    def _loaded_with(self, stiffness_factor: float) -> LoadedContact:
        """As ``loaded_contact``, with teeth stiffer by a factor."""
        phi1, _, _ = self.motion.phi1_rad, self.rigid, self.meshing
        with self.stopwatch("band of stiffness" if stiffness_factor != 1.0 else "loaded contact"):
            return self._loaded_at(phi1, stiffness_factor)

    @computed
    def course(self) -> Course:
        """The motion of the toothed machine in time."""
        from ncgear.dynamics.motion_in_time import ACCURACY

        return self.course_with(1.0, ACCURACY)

    def course_with(self, stiffness_factor: float, accuracy: float) -> Course:
        """The motion in time with teeth stiffer by a factor; raises as ``dynamics.motion_in_time.course`` does.

        Of pairs in series all are followed together.  A motor that stops during the turns is refused at once.
        """
        from ncgear.dynamics.motion_in_time import course
        from ncgear.dynamics.start import Start, started
        from ncgear.project.forces import drive_line_of, toothed_machine
        from ncgear.project.motor import fitting_simulated, told_words

        if self.motor_stall is not None:
            raise NoSuchMechanism(f"{self.motor_stall}; {told_words(fitting_simulated(self))}", key=MOTOR)
        given, masses, speed = self.design.simulation, self.masses, self.machine.speed_rad_s
        driving = drive_line_of(given, masses, speed)
        meshings = [pair.meshing.stiffened(stiffness_factor) for pair in self.by_stage]
        with self.stopwatch("motion in time" if stiffness_factor == 1.0 else "band of stiffness"):
            toothed = toothed_machine(given, driving, meshings, masses, self.machine)
            laws_before = self.loaded_machine(self.machine).laws_before
            state = started(toothed, self.transmission, Start(given.start), speed, laws_before)
            said = "" if stiffness_factor == 1.0 else f" at {stiffness_factor:g} times the stiffness"
            began_s = perf_counter()

            def on_turns(done: float) -> None:
                left = left_words(perf_counter() - began_s, done / given.turns)
                self.stopwatch.within(f"{done:.2f} of {given.turns:g} turns{said}{left}")

            return course(toothed, state, given.turns, accuracy, on_turns=on_turns)

    def peaks_of(self, course: Course) -> MotionPeaks:
        """The peaks of a motion in time of this drive."""
        from ncgear.dynamics.history import motion_peaks

        def on_share(done: float) -> None:
            self.stopwatch.within(f"peaks searched at {100.0 * done:.0f} % of the motion")

        return motion_peaks(course, self.rigid.machine, on_share)

    @computed
    def measured(self) -> tuple[GearMeasures, GearMeasures]:
        """The driving and the driven gear as a workshop measures them."""
        from ncgear.project.workshop_measures import measured_gears

        return measured_gears(self)

    @computed
    def cut_by(self) -> tuple[CutGear, CutGear]:
        """The driving and the driven gear as hob, shaper, wire and end mill cut them, with reasons."""
        from ncgear.project.workshop_measures import cut_gears

        return cut_gears(self)

    @property
    def strength(self) -> Strength:
        """The strength of the teeth by the method that the design names."""
        return self.strength_by(self.design.strength.method)

    def strength_by(self, method: Method) -> Strength:
        """The strength of the teeth by a method; computed once."""
        return self.judged_teeth(method).strength

    def loading_by(self, method: Method) -> Loading:
        """The load of every tooth, shared by the stiffness that a method of strength gives the teeth."""
        return self.judged_teeth(method).loading

    @computed_by
    def surfaces_by(self, method: Method) -> Surfaces:
        """Film, heat and wear of the flanks under the loads of a method."""
        from ncgear.project.tooth_strength import surfaces_of_teeth

        judged = self.judged_teeth(method)
        with self.stopwatch("film and wear"):
            with_all = self.gears, self.conditions, self.running, self.face_loading, self.vibration
            return surfaces_of_teeth(judged, *with_all)

    @computed_by
    def best_crowning_um_by(self, method: Method) -> float | None:
        """The lead crowning in whole um that is best for the loads of a method; None where it is not known."""
        from ncgear.project.face_load import best_crowning_um

        return best_crowning_um(self.face_loading, self.strength_by(method), self.conditions.application_factor)

    @computed_by
    def told_face_load_by(self, method: Method) -> ToldFaceLoad | None:
        """Figures of the load along the width by a method; None where it is not computed."""
        from ncgear.project.face_load import told_face_load

        over, best = self.conditions.application_factor, self.best_crowning_um_by(method)
        return told_face_load(self.face_loading, self.strength_by(method), over, best)

    @computed_by
    def judged_teeth(self, method: Method) -> JudgedTeeth:
        """Loads and strength of the teeth by a method, with the method's other results; idlers bend both ways."""
        from ncgear.project.tooth_strength import judged_in_row

        judged = self._judged_alone(method)
        if self.gears.idlers is None:
            return judged
        driving, driven = (self._pressed_elsewhere(gear, method) for gear in Gear)
        return judged_in_row(judged, (driving, driven), self.conditions, self.running)

    def _pressed_elsewhere(self, gear: Gear, method: Method) -> Array | None:
        """The compressions of roots of one gear in its other mesh, at this mesh's flanks; None for a gear without."""
        from ncgear.strength.life import pressed_mpa
        from ncgear.trains.chain import same_flanks

        number = self.stage or 1
        beside = number + 1 if gear is Gear.DRIVEN else number - 1
        if not 1 <= beside <= self.design.stages:
            return None
        other, there = self.whole.by_stage[beside - 1], list(Gear)[gear is Gear.DRIVING]
        found, teeth = other._judged_alone(method).strength, other.teeth.of(there)
        compression = found.stresses.compression_mpa[list(Gear).index(there)]
        pressed = pressed_mpa(compression, found.contacts.on(there).flank, teeth.teeth)
        rolled_mm = self.whole.row.rolled_mm(min(number, beside))
        sense = 1.0 if gear is Gear.DRIVEN else -1.0
        return np.asarray(pressed[same_flanks(self.teeth.of(gear).flanks, teeth.flanks, sense * rolled_mm)])

    @computed_by
    def _judged_alone(self, method: Method) -> JudgedTeeth:
        """As ``judged_teeth``, of a pair whose gears mesh with each other only."""
        from ncgear.project.tooth_strength import judged_teeth, methods_of, require_known_rims

        load, sections = self.tooth_load.load, self.face_sections
        with self.stopwatch("strength"):
            require_known_rims(self.rims, self.gears)
            methods = methods_of(method, sections, self.materials, self.rims)
            loading = self.loading(methods, self.materials)
            running, uneven, shaken = self.running, self.face_loading, self.vibration
            return judged_teeth(method, self.gears, methods, loading, self.conditions, running, load, uneven, shaken)

    @computed
    def face_loading(self) -> FaceLoading:
        """The uneven load along the width of the teeth, by the shafts around them if the file has enough keys."""
        from ncgear.project.face_load import face_loading_of

        return face_loading_of(self)

    @computed
    def vibration(self) -> Vibration:
        """The values on which the vibration of the pair's mesh depends, besides its loads."""
        from ncgear.project.vibration import vibration_of

        return vibration_of(self)

    @computed
    def rims(self) -> tuple[Rim, Rim]:
        """The walls under the teeth of the driving and the driven gear; raises where a body cannot be made."""
        from ncgear.project.tooth_strength import rim_of

        helical = self.helix is not None
        driving, driven = (
            rim_of(self.teeth.of(gear), plan, helical=helical)
            for gear, plan in zip(Gear, self.finished_plans, strict=True)
        )
        return driving, driven
