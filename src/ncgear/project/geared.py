"""The pair of gears of a design: pitch curves, teeth and bodies, and the forces on its moving masses."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from math import radians
from typing import TYPE_CHECKING

import numpy as np

from ncgear.design.keys.gears import Gears
from ncgear.design.keys.machine import FINEST_IN_MODULES
from ncgear.design.mechanisms import entry_of
from ncgear.design.words import listed
from ncgear.errors import DesignError, WrongInput
from ncgear.kinematics.check import KinematicCheck, at_speed, both_sides_rad, kinematic_check, load_extremes_rad
from ncgear.kinematics.motion import Machine, OutputMotion, sample_angles
from ncgear.mechanisms.forces import Masses
from ncgear.numerics.arrays import Array, distinct
from ncgear.numerics.bounds import shown_above
from ncgear.numerics.units import N_M_PER_N_MM, RAD_S_PER_RPM
from ncgear.pitch.shape import Gear
from ncgear.project.law import require_whole_turns, size_of
from ncgear.project.moving import GearInertia, Moving, TrainInertia, computed, disc_kg_mm2, masses_of, train_inertia
from ncgear.project.tooth_form import (
    backlash_of,
    driving_axes_rad,
    helix_of,
    mesh_place,
    reach_in_pitches,
    require_pushing_flanks,
    thickness_limits_mm,
    tooth_form_of,
)
from ncgear.ratio.laws.uniform import uniform_law
from ncgear.teeth.form import BasicRack

if TYPE_CHECKING:
    from ncgear.dynamics.driving_shaft import DrivingShaft
    from ncgear.dynamics.loaded_machine import RigidMachine
    from ncgear.dynamics.mesh_force import MeshPlace
    from ncgear.dynamics.rigid import Rigid
    from ncgear.pitch.chambers import Pumped
    from ncgear.pitch.pair import PitchPair
    from ncgear.solids.helical.helix import Helix
    from ncgear.solids.mesh.pair import SolidPair
    from ncgear.solids.plan.body import BodyPlan, RoundHole
    from ncgear.strength.conditions import Conditions, Running
    from ncgear.strength.material import Material
    from ncgear.strength.sections import FaceSections
    from ncgear.teeth.arcs import ArcOutline
    from ncgear.teeth.backlash import Play
    from ncgear.teeth.fitting import PairTips
    from ncgear.teeth.form import CutterKind, ToothForm
    from ncgear.teeth.gear import ToothedPair
    from ncgear.teeth.reach import Reach
    from ncgear.trains.chain import PairRow
    from ncgear.trains.contact import Distance


class Geared(Moving):
    """A design with its gears, before anything touches; see ``ncgear.project.drive.Drive``."""

    @computed
    def gears(self) -> Gears:
        """The keys of the gears; raises WrongInput where the file has none."""
        if self.design.gears is None:
            raise WrongInput("missing; gears need teeth, module_mm, face_width_mm and more", key="gears")
        return self.design.gears

    @computed
    def pitch(self) -> PitchPair:
        """Both pitch curves at their size."""
        from ncgear.pitch.pair import sized_pair
        from ncgear.pitch.shape import Mesh

        gears, transmission = self.gears, self.pair.transmission
        with self.stopwatch("pitch curves"):
            size = size_of(gears, self.law)
            if gears.idlers is not None and self.stage != 1:
                before = self.whole.by_stage[(self.stage or 1) - 2].pitch.size
                size = before.driven_teeth, before.module_mm, None
            reach, by_law = reach_in_pitches(gears), self.law.center_distance_mm is not None
            return sized_pair(transmission, *size, Mesh(gears.mesh), reach, by_law=by_law)

    @property
    def chord_tolerance_mm(self) -> float:
        """Largest distance of an outline's chords from the exact curves.

        Raises WrongInput where chords would leave no gear, leave the band of tooth thickness, or be lost in rounding.
        """
        lower, upper = thickness_limits_mm(self.gears) or (0.0, 0.0)
        module_mm = self.pitch.size.module_mm
        chord_mm = self.design.output.chord_mm(module_mm, upper - lower if upper > lower else None)
        if chord_mm < FINEST_IN_MODULES * module_mm:
            said = f"{chord_mm:g} mm are {chord_mm / module_mm:.3g} of the module of {module_mm:.4g} mm"
            raise self._too_fine(said, FINEST_IN_MODULES * module_mm)
        return chord_mm

    def _too_fine(self, said: str, from_mm: float) -> WrongInput:
        """The error for too fine chords, with the finest tolerances over ``from_mm`` that work and that are quick."""
        from ncgear.project.gear_solids import finest_chords_mm

        made = [
            (pair.pitch, form, pair.helix)
            for pair in self.whole.by_stage
            for form in (pair.tooth_form, *pair.forms_at_limits)
        ]
        finest_mm, soon_mm = finest_chords_mm(made, from_mm)
        soon = f"; a build takes minutes under {shown_above(soon_mm, 2)} mm" if soon_mm > finest_mm else ""
        problem = f"{said}; {shown_above(finest_mm, 4)} mm or more is right{soon}"
        return WrongInput(problem, key="output.chord_tolerance_mm")

    @contextmanager
    def telling_the_finest(self) -> Iterator[None]:
        """A context in which too fine chords, for teeth or sections, are refused with the finest that are possible."""
        from ncgear.teeth.chords import TooManyChords

        try:
            yield
        except TooManyChords as refused:
            raise self._too_fine(refused.said, self.chord_tolerance_mm) from refused

    @property
    def moves_output(self) -> bool:
        """Whether its driven shaft moves the output; in the first of two pairs in series it does not."""
        return self.stage in (None, self.design.stages)

    @property
    def turns_crank(self) -> bool:
        """Whether its driven shaft turns a crank with a pin."""
        return self.moves_output and entry_of(self.design.linkage).has_crank_pin

    @property
    def crank_pin(self) -> RoundHole | None:
        """The hole for the crank pin in the driven gear; None where none is asked for or the gear turns no crank."""
        from ncgear.project.gear_solids import crank_pin_hole

        return crank_pin_hole(self.gears, self.linkage) if self.turns_crank else None

    @computed
    def rack(self) -> BasicRack:
        """The basic rack at the module."""
        return self.gears.rack.in_mm(self.pitch.size.module_mm)

    @property
    def largest_pressure_angle_deg(self) -> float:
        """Largest pressure angle of the flanks that carry, the rack's own included."""
        return self.pitch.largest_pressure_angle_deg(radians(self.gears.carrying_angle_deg))

    @computed
    def play(self) -> Play:
        """The play of the driven gear, the same at every position."""
        from ncgear.teeth.backlash import play_of

        backlash = backlash_of(self.gears) if self.gears.idlers is None else self.whole.row_form.backlash
        return play_of(self.pitch, self.rack, backlash)

    @property
    def helix(self) -> Helix | None:
        """The helix of the teeth; None where they are straight."""
        return helix_of(self.gears)

    @property
    def overlap_ratio(self) -> float:
        """The part of the contact ratio that the helix adds: its advance in pitches."""
        return self.helix.largest_advance_mm / self.rack.pitch_mm if self.helix else 0.0

    @computed
    def tooth_form(self) -> ToothForm:
        """The form of the teeth in mm; the tips of helical teeth do not jump with height.

        Raises NoSuchMechanism where no flank of any form could turn its mate.
        """
        from ncgear.solids.helical.even_tips import with_even_tips

        require_pushing_flanks(self.pitch, self.gears.rack)
        if self.gears.idlers is not None:
            return self.whole.row_form
        form, pitch = tooth_form_of(self.gears, self.pitch.size.module_mm), self.pitch
        if self.helix is None:
            return form
        with self.stopwatch("teeth"):
            return with_even_tips(pitch, form, self.helix)

    @property
    def forms_at_limits(self) -> tuple[ToothForm, ...]:
        """The form of the teeth at both limits of their thickness, the thinnest first; empty without limits."""
        form, limits = self.tooth_form, thickness_limits_mm(self.gears) or ()
        return tuple(replace(form, backlash=replace(form.backlash, thickness_mm=(limit, limit))) for limit in limits)

    @computed
    def row(self) -> PairRow:
        """The pairs of a whole row of gears with idlers."""
        from ncgear.trains.chain import PairRow

        assert self.gears.idlers is not None
        row = PairRow(tuple(pair.pitch for pair in self.by_stage), self.gears.idlers.directions_rad)
        row.require_apart("gears.idlers.bends_deg")
        return row

    @computed
    def row_form(self) -> ToothForm:
        """The form of the teeth of a whole row of gears, of which each thins the idle flanks by half of the play."""
        from ncgear.trains.chain import row_form

        return row_form(self.row, tooth_form_of(self.gears, self.row.pairs[0].size.module_mm))

    @computed
    def row_tips(self) -> list[tuple[CutterKind, PairTips]]:
        """Tool and flanks of both gears of each pair of a whole row."""
        from ncgear.trains.chain import row_tips

        with self.stopwatch("teeth"):
            return row_tips(self.row, self.row_form)

    @computed
    def row_room(self) -> list[Distance]:
        """The least distances of the gears of a whole row that come near to each other and do not mesh."""
        from ncgear.trains.chain import train_of_gears
        from ncgear.trains.contact import distances_of
        from ncgear.trains.train import TrainFigures

        pairs, given = self.by_stage, self.gears
        gears = [pairs[0].teeth.driving, *(pair.teeth.driven for pair in pairs)]
        body = given.face_width_mm, None, self.design.operation.speed_rpm, pairs[0].chord_tolerance_mm
        with self.stopwatch("room between gears"):
            train = train_of_gears(self.row, gears, *body, TrainFigures(""))
            return distances_of(train, {part.name: part.outline_mm for part in train.parts})

    @computed
    def teeth(self) -> ToothedPair:
        """Both toothed gears."""
        _ = self.pitch, self.tooth_form
        with self.stopwatch("teeth"), self.telling_the_finest():
            return self.toothed(self.chord_tolerance_mm)

    def toothed(self, chord_mm: float, flank_tolerance_mm: float | None = None, advance_mm: float = 0.0) -> ToothedPair:
        """Both toothed gears with chord tolerances as in ``toothed_pair``; an idler's teeth have one place only."""
        from ncgear.teeth.gear import outlined_pair, pair_tips

        pitch, form = self.pitch, self.tooth_form
        if self.gears.idlers is None:
            made = pair_tips(pitch, form, advance_mm)
        else:
            made = self.whole.row_tips[(self.stage or 1) - 1]
        return outlined_pair(pitch, form, made, chord_mm, flank_tolerance_mm=flank_tolerance_mm)

    @computed
    def face_sections(self) -> FaceSections:
        """The teeth over the face width: one section of straight teeth, the sections of one rise of helical teeth."""
        from ncgear.solids.helical.sections import Sections
        from ncgear.strength.sections import FaceSection, FaceSections, count_of

        teeth, helix = self.teeth, self.helix
        if helix is None:
            return FaceSections.straight(teeth)
        count, tolerance = count_of(helix.largest_advance_mm, self.rack.pitch_mm), self.chord_tolerance_mm
        heights = helix.rise_mm * (np.arange(count) + 0.5) / count
        with self.stopwatch("teeth"), self.telling_the_finest():
            made = Sections(self.pitch, self.tooth_form, helix, tolerance)
            sections = tuple(FaceSection(made.at(float(height)).teeth, 1.0 / count) for height in heights)
        return FaceSections(sections, helix.angle_rad)

    @computed
    def pumped(self) -> Pumped | None:
        """The volume that the gears displace in their housing; None where the design has no housing."""
        from ncgear.pitch.chambers import pumped

        radii = self.housing_radii_mm
        if radii is None:
            return None
        first, second = radii[Gear.DRIVING], radii[Gear.DRIVEN]
        transmission, distance = self.pair.transmission, self.pitch.center_distance_mm
        return pumped(transmission, distance, (first, second), self.gears.face_width_mm)

    @property
    def housing_radii_mm(self) -> dict[Gear, float] | None:
        """Radii of the housing's bores about both axes; None where the design has no housing."""
        given = self.gears.housing
        return None if given is None else {gear: far + given.clearance_mm for gear, far in self.outer_radii_mm.items()}

    @computed
    def reach(self) -> dict[Gear, Reach]:
        """How far the teeth and the spaces of each gear reach from its axis."""
        from ncgear.teeth.reach import reach_of

        return {gear: reach_of(self.teeth.of(gear)) for gear in Gear}

    @computed
    def outer_radii_mm(self) -> dict[Gear, float]:
        """Largest distance of each gear's points from its axis: of its teeth in all sections, or of a ring's rim."""
        from ncgear.project.gear_solids import rim_mm_of
        from ncgear.solids.plan.plan import outer_radius_mm

        radii = {gear: reach.farthest_mm for gear, reach in self.reach.items()}
        if self.helix is not None:
            solids = self.solids
            return {
                gear: max(radii[gear], float(np.hypot(*solids.of(gear).triangles.vertices.T[:2]).max()))
                for gear in Gear
            }
        if self.pitch.driven.is_ring:
            rim_mm = rim_mm_of(self.gears, self.pitch.size.module_mm)
            radii[Gear.DRIVEN] = outer_radius_mm(self.teeth.driven.outline_mm, rim_mm)
        return radii

    @computed
    def section_contact_ratio(self) -> float:
        """Least arc of contact of any pair of flanks in the sections of helical teeth, in pitches."""
        from ncgear.solids.helical.sections import Sections, least_section_contact

        assert self.helix is not None
        pitch, form, tolerance = self.pitch, self.tooth_form, self.chord_tolerance_mm
        with self.telling_the_finest():
            return least_section_contact(Sections(pitch, form, self.helix, tolerance))

    @computed
    def solids(self) -> SolidPair:
        """Both gears as closed meshes."""
        from ncgear.project.gear_solids import helical_solids, straight_solids

        gears, pitch, tolerance = self.gears, self.pitch, self.chord_tolerance_mm
        if self.helix is not None:
            form = self.tooth_form
            with self.stopwatch("solids"), self.telling_the_finest():
                return helical_solids(gears, pitch, form, self.helix, tolerance, self.crank_pin)
        teeth = self.teeth
        with self.stopwatch("solids"):
            return straight_solids(gears, pitch, teeth, tolerance, self.crank_pin)

    @computed
    def finished_plans(self) -> tuple[BodyPlan, BodyPlan]:
        """The bodies of both gears as they come out of the process, which may need other files."""
        from ncgear.project.gear_solids import finished, finished_plans, helical_solids

        gears, pitch, tolerance = self.gears, self.pitch, self.chord_tolerance_mm
        if self.helix is None:
            teeth = self.teeth
            with self.stopwatch("bodies"):
                return finished_plans(gears, pitch, teeth, tolerance, self.crank_pin)
        if finished(gears) == gears:
            return self.solids.driving.plan, self.solids.driven.plan
        form = self.tooth_form
        with self.stopwatch("bodies"):
            solids = helical_solids(finished(gears), pitch, form, self.helix, tolerance, self.crank_pin)
        return solids.driving.plan, solids.driven.plan

    @computed
    def tooth_arcs(self) -> dict[Gear, ArcOutline] | None:
        """Both gears' teeth as lines and arcs; None where outlines are sections or parallels, which have chords only.

        Arcs, not splines: all programs for cutters read arcs, and many of them cut splines into chords of their own.
        """
        from ncgear.teeth.arcs import arc_outline
        from ncgear.teeth.contour import CURVES_SHARE

        if self.helix is not None or self.gears.process_clearance_mm != 0.0:
            return None
        tolerance = CURVES_SHARE * self.chord_tolerance_mm
        return {gear: arc_outline(self.teeth.of(gear), tolerance) for gear in Gear}

    if TYPE_CHECKING:

        @property
        def by_stage(self) -> tuple[Geared, ...]:
            """One drive for each pair of gears, see ``Drive``."""

    @computed
    def gear_inertia(self) -> GearInertia:
        """The moments of inertia of this pair's gears, from their bodies."""
        from ncgear.project.gear_solids import finished, helical_plans
        from ncgear.project.service import densities_kg_m3
        from ncgear.solids.plan.body import body_kg_mm2

        given, pitch = self.design.masses, self.pitch
        densities = densities_kg_m3(None if given is None else given.density_kg_m3, self.gears)
        try:
            if self.helix is None:
                plans = self.finished_plans
            else:
                # By the sections that bear the load, without meshes
                sections = [self.teeth, *(section.teeth for section in self.face_sections.each)]
                tolerance = self.chord_tolerance_mm
                with self.stopwatch("bodies"):
                    plans = helical_plans(finished(self.gears), pitch, sections, tolerance, self.crank_pin)
        except DesignError as refusal:
            curves, module = (pitch.driving, pitch.driven), pitch.size.module_mm
            first, last = (
                disc_kg_mm2(self.gears, curve, module, density)
                for curve, density in zip(curves, densities, strict=True)
            )
            return GearInertia(first, last, refusal)
        first, last = (body_kg_mm2(*of) for of in zip(plans, densities, strict=True))
        return GearInertia(first, last)

    @computed
    def train_inertia(self) -> TrainInertia:
        """The moments of inertia of the gears of the whole machine; zero where the design gives no masses."""
        given, whole = self.design.masses, self.whole
        if given is None:
            return TrainInertia()
        bodies = None if self.design.gears is None else lambda place: whole.by_stage[place].gear_inertia
        shares = self.design.gears is not None and self.design.gears.idlers is not None
        return train_inertia(given, self.design.stages, bodies, shares_gears=shares)

    @computed
    def masses(self) -> Masses:
        """The moving masses; makes teeth only where a gear's moment of inertia is left out.

        Raises WrongInput without masses.
        """
        require_whole_turns(self.design, "the computation of forces")
        given = self.design.masses
        if given is None:
            needed = listed(entry_of(self.design.linkage).needed_masses, "and")
            raise WrongInput(f"missing; forces need {needed}", key="masses")
        whole = self.whole
        return whole.masses if whole is not self else masses_of(given, self.linkage, self.train_inertia)

    @property
    def masses_left_out(self) -> str | None:
        """Why masses do not count, in words; None where they count."""
        if self.design.motion.is_open:
            return "gears turn less than once"
        key = self.design.key_in_file("masses") or "masses"
        return f"give them as {key}" if self.design.masses is None else None

    @property
    def gear_refusal(self) -> DesignError | None:
        """Why gears with counted inertia cannot be made as given, so that discs replace them; None without discs."""
        found = (pair for pair in self.whole.by_stage if "gear_inertia" in vars(pair))
        return next((pair.gear_inertia.refusal for pair in found if pair.gear_inertia.refusal), None)

    def loaded_machine(self, machine: Machine) -> RigidMachine:
        """A machine of this design with everything that the file gives, except the force between the teeth."""
        from ncgear.dynamics.loaded_machine import RigidMachine

        around, before = self.design.drivetrain, [pair.transmission for pair in self.law.train.pairs[:-1]]
        if machine.transmission is not self.transmission:
            before = [uniform_law(law.lobes) for law in before]
        return RigidMachine(
            machine,
            self.masses,
            guide_friction=around.guide_friction if around else 0.0,
            laws_before=tuple(before),
        )

    @computed
    def driving(self) -> DrivingShaft:
        """The demand on the driving shaft, with masses; raises as ``masses`` does."""
        return self._driving(self.machine)

    @computed
    def uniform_driving(self) -> DrivingShaft:
        """The demand on the driving shaft of the uniform crank with the same masses."""
        return self._driving(self.uniform_machine)

    def _driving(self, machine: Machine) -> DrivingShaft:
        from ncgear.dynamics.driving_shaft import DrivingShaft

        loaded = self.loaded_machine(machine)
        with self.stopwatch("forces"):
            return DrivingShaft(loaded)

    @computed
    def check(self) -> KinematicCheck:
        """Exact peaks at the operating speed, with all masses that the design gives."""
        return self._counted(self.massless_check, lambda: self.driving)

    @computed
    def uniform_check(self) -> KinematicCheck:
        """The peaks of the uniform crank with the same masses at the same speed."""
        with self.stopwatch("check"):
            massless = kinematic_check(self.uniform_machine)
        return self._counted(massless, lambda: self.uniform_driving)

    def check_at_rpm(self, speed_rpm: float) -> KinematicCheck:
        """The check of this design at another driving speed in r/min."""
        machine = replace(self.machine, speed_rad_s=speed_rpm * RAD_S_PER_RPM)
        return self._counted(at_speed(self.massless_check, speed_rpm), lambda: self._driving(machine))

    def _counted(self, massless: KinematicCheck, driving: Callable[[], DrivingShaft]) -> KinematicCheck:
        """A check with the given masses, for the machine with this driving shaft."""
        if self.masses_left_out is not None:
            return massless
        from ncgear.dynamics.driving_shaft import counting_masses

        shaft = driving()
        with self.stopwatch("forces"):
            return counting_masses(massless, shaft)

    @computed
    def motion(self) -> OutputMotion:
        """The output's motion at the operating speed, sampled, with the masses that the design gives."""
        return self.motion_of(self.machine, sample_angles(self.transmission))

    @computed
    def uniform_motion(self) -> OutputMotion:
        """The uniform crank's motion at the same angles, with the same masses."""
        return self.motion_of(self.uniform_machine, self.motion.phi1_rad)

    @computed
    def extremes_rad(self) -> Array:
        """Driving angles at which a curve of motion, load, power or ratio is least or greatest, and beside them.

        They rise, shape (n,).  Drawn curves are sampled there too, so that a chart shows the peaks of ``check``.
        """
        of_ratio = [end.at for end in self.transmission.ratio_range]
        found = (*self.check.extremes_rad, *load_extremes_rad(self.machine), *of_ratio)
        return both_sides_rad(found, self.transmission.cycle_rad)

    @computed
    def drawn_motions(self) -> tuple[OutputMotion, OutputMotion]:
        """Both motions at the angles of ``motion`` and of ``extremes_rad``, for charts."""
        phi1 = distinct(np.concatenate([sample_angles(self.transmission), self.extremes_rad]))
        return self.motion_of(self.machine, phi1), self.motion_of(self.uniform_machine, phi1)

    def motion_of(self, machine: Machine, phi1_rad: Array) -> OutputMotion:
        """The motion of a machine of this design at driving angles in rad, shape (n,)."""
        with self.stopwatch("motion"):
            moved = machine.motion(phi1_rad)
        if self.masses_left_out is not None:
            return moved
        loaded = self.loaded_machine(machine)
        with self.stopwatch("forces"):
            torque = loaded.at(phi1_rad).driving_torque.value
        power = N_M_PER_N_MM * machine.speed_rad_s * torque
        return replace(moved, torque_with_masses_n_mm=torque, power_with_masses_w=power)

    @computed
    def rigid(self) -> Rigid:
        """The forces in the machine at constant driving speed."""
        return self._rigid(lambda: self.driving) if self.stage is None else self.whole.rigid

    @computed
    def uniform_rigid(self) -> Rigid:
        """The forces in the uniform crank with the same masses."""
        return self._rigid(lambda: self.uniform_driving)

    def _rigid(self, driving: Callable[[], DrivingShaft]) -> Rigid:
        from ncgear.dynamics.rigid import rigid_level

        places = [] if self.design.gears is None else self.mesh_places
        shaft = driving()
        with self.stopwatch("forces"):
            return rigid_level(shaft, places)

    @property
    def mesh_places(self) -> list[MeshPlace]:
        """The places of all pairs of gears, from the driving shaft on, in the frame of the mechanism."""
        pairs, axes, sense = self.by_stage, driving_axes_rad(self.gears, self.design.stages), -1.0
        found: list[MeshPlace] = []
        for pair, axis in zip(pairs[::-1], axes[::-1], strict=True):
            place = mesh_place(self.gears, pair.pitch.center_distance_mm)
            found.insert(0, replace(place, driving_axis_rad=axis, driven_sense=sense))
            sense *= place.mesh.sense
        return found

    @computed
    def running(self) -> Running:
        """Size and speed of the pair, as its strength depends on them."""
        from ncgear.strength.conditions import Running

        size, teeth = self.pitch.size, (self.pitch.size.driving_teeth, self.pitch.size.driven_teeth)
        width, toothed = self.gears.face_width_mm, self.pitch.toothed
        speed = self.machine.speed_rad_s * self.transmission.lobes.driving / self.pair.transmission.lobes.driving
        mates = self.design.strength.mates if self.stage in (None, 1) else 1
        found = Running(size.module_mm, teeth, width, speed, self.overlap_ratio, mates=mates)
        if toothed is None:
            return found
        ends = toothed.covered_rad, float(self.transmission.driven_angle(np.array([toothed.covered_rad])).value[0])
        driving, driven = (2.0 * toothed.covered_mm / (size.module_mm * abs(end)) for end in ends)
        return replace(found, around=(driving, driven), stroke_rad=2.0 * toothed.covered_rad)

    @computed
    def conditions(self) -> Conditions:
        """The conditions under which the teeth run, and their wanted safety."""
        from ncgear.project.service import conditions_of

        ways = 2.0 if self.design.motion.is_open else 1.0
        return conditions_of(self.design.strength, ways * self.transmission.cycle_rad, self.machine.speed_rad_s)

    @computed
    def materials(self) -> tuple[Material, Material]:
        """The materials of the driving and the driven gear, plastics at the temperature of their surroundings."""
        from ncgear.project.service import choices_of
        from ncgear.strength.endurance import materials_of
        from ncgear.strength.plastics import temperatures_of

        choices, conditions, running = choices_of(self.gears), self.conditions, self.running
        return materials_of(choices, conditions, running, temperatures_of(choices, conditions, running))
