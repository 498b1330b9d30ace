"""The stages of a drive that need no gear: law, machine, motion, check."""

from __future__ import annotations

from contextlib import AbstractContextManager, nullcontext
from dataclasses import replace

from ncgear.design.gears import Gears
from ncgear.design.load import LoadedDesign
from ncgear.design.schema import Design
from ncgear.drive.stage import stage
from ncgear.errors import WrongInput
from ncgear.kinematics.check import KinematicCheck, kinematic_check
from ncgear.kinematics.slider import Machine, SliderMotion, sample_angles
from ncgear.machine.linkage import CrankSlider
from ncgear.numerics.arrays import Array
from ncgear.numerics.units import RAD_S_PER_RPM
from ncgear.ratio.laws.uniform import uniform_law
from ncgear.ratio.train import Pair
from ncgear.ratio.transmission import Transmission
from ncgear.recipe.law import Law, law_of, resistance_of
from ncgear.stopwatch import Stopwatch


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
