"""The stages of a drive that need masses."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ncgear.drive.solids import SolidStages
from ncgear.drive.stage import stage
from ncgear.errors import WrongInput
from ncgear.kinematics.slider import Machine
from ncgear.machine.masses import Masses
from ncgear.recipe.gears import mesh_place

if TYPE_CHECKING:
    from ncgear.dynamics.integration import Course
    from ncgear.dynamics.meshing import Meshing
    from ncgear.dynamics.quasi_static import LoadedContact
    from ncgear.dynamics.rigid import Rigid


class ForceStages(SolidStages):
    """What the machine's masses and its teeth bear."""

    @stage
    def masses(self) -> Masses:
        """The moving masses; makes solids only where a gear's moment of inertia is left out."""
        from ncgear.recipe.masses import masses_of

        given, gears = self.design.masses, self.design.gears
        if given is None:
            raise WrongInput("missing; forces need slider_kg, rod and crank", key="masses")
        if gears is None or given.tells_gears:
            return masses_of(given)
        from ncgear.solids.inertia import body_kg_mm2

        plans, density = (self.solids.driving.plan, self.solids.driven.plan), given.density_kg_m3
        driving, driven = (body_kg_mm2(plan, density) for plan in plans)
        return masses_of(given, driving, driven)

    @stage
    def rigid(self) -> Rigid:
        """What the machine bears at constant driving speed."""
        return self._rigid(self.machine)

    @stage
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

    @stage
    def meshing(self) -> Meshing:
        """The straight teeth of the pair as they bear load; they must touch as designed."""
        from ncgear.recipe.simulation import meshing_of

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
        from ncgear.dynamics.integration import course
        from ncgear.dynamics.motion_equation import Mechanism
        from ncgear.dynamics.starts import Start, started
        from ncgear.recipe.simulation import drive_line_of

        given, masses, meshing = self.design.simulation, self.masses, self.meshing
        driving = drive_line_of(given, masses, self.machine.speed_rad_s)
        with self.stopwatch("motion in time"):
            mechanism = Mechanism(driving, meshing, crank_load(self.linkage, masses, self.machine.resistance))
            return course(mechanism, started(mechanism, self.transmission, Start(given.start)), given.turns)
