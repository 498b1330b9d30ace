"""The train ``planetary``: a sun, idlers and planets on a carrier, with an arm on each planet."""

from __future__ import annotations

from math import radians
from typing import TYPE_CHECKING, Annotated, Literal

from pydantic import Field

from ncgear.design.keys.base import optional, required
from ncgear.design.keys.types import Length, Several
from ncgear.design.trains.base import TrainGears, TrainKeys
from ncgear.errors import below
from ncgear.trains.train import Told

if TYPE_CHECKING:
    from ncgear.pitch.pair import PitchPair
    from ncgear.ratio.transmission import Transmission
    from ncgear.teeth.gear import ToothedPair
    from ncgear.trains.planetary import Chain
    from ncgear.trains.train import Train

Ratio = Annotated[float, Field(gt=0.0, le=100.0)]


class PlanetaryGears(TrainGears):
    """The teeth and the bodies of sun, idlers and planets."""

    teeth: int = required("teeth of every gear, a whole number", ge=8, le=1000)
    center_distance_mm: Length | None = optional("distance of the axes of each pair in mm, in place of module_mm")


class Planetary(TrainKeys):
    """Gears on a carrier."""

    KIND = "planetary"
    MEANING = "planetary: a sun, idlers and planets on a carrier, with an arm on each planet"

    arms: int = optional("arms of the carrier, evenly spread, a whole number", 1, ge=1, le=6)
    idler: Literal["compound", "shared"] = optional(
        "compound: two gears on one shaft, which make any ratio; shared: one gear that meshes with sun and planet",
        "compound",
    )
    ratio: Annotated[Several[Ratio], Field(min_length=4, max_length=720)] = required(
        "speed of the sun against the carrier over that of the planet (compound) or of the idler (shared), at evenly "
        "spaced angles of the latter, from 0 on; a common factor closes the turn"
    )
    arm_mm: Length | None = optional("length of the arm on each planet in mm; left out: no arm")
    arm_deg: float = optional("angle of the arm from the carrier's line where the carrier stands at 0, in degrees", 0.0)
    sun_turns: float = optional(
        "turns of the sun for one of the carrier; left out: the sun stands", 0.0, gt=-10.0, lt=0.9
    )
    bar_width_mm: Length = optional("width of carrier and arms in mm", 20.0)
    gears: PlanetaryGears = required("the teeth and bodies of all gears")

    def train(self) -> Train:
        """The train that the keys ask for; raises NoSuchMechanism where no such gears exist."""
        import numpy as np

        from ncgear.trains.planetary import Arm, Bodies, planetary_train

        with below("train"):
            chain = self._chain()
        arm = None
        if self.arm_mm is not None:
            arm = Arm(self.arm_mm, radians(self.arm_deg), np.empty((0, 2)))
        bodies = Bodies(self.gears.face_width_mm, self.gears.bore_mm, self.bar_width_mm)
        told = Told(f"planetary train, {self.idler} idler, {self.arms} arm{'s' * (self.arms > 1)}")
        return planetary_train(
            chain, arm, self.arms, bodies, self.speed_rpm, self.gears.chord_tolerance_mm, told, self.sun_turns
        )

    def _chain(self) -> Chain:
        import numpy as np

        from ncgear.ratio.laws.spline import even_steps, spline_ratio_law, spline_ratio_staged
        from ncgear.ratio.transmission import Lobes
        from ncgear.trains.planetary import compound_chain, shared_chain

        ratio = np.array(self.ratio)
        angles = even_steps(ratio.size)
        if self.idler == "shared":
            pitch = self._pitch(spline_ratio_law(angles, ratio, Lobes()))
            return shared_chain(pitch, self._teeth(pitch))
        pairs = spline_ratio_staged(angles, ratio, np.sqrt(ratio)).train.pairs
        first, second = (self._pitch(pair.transmission) for pair in pairs)
        distance = first.center_distance_mm + second.center_distance_mm
        return compound_chain((first, second), (self._teeth(first), self._teeth(second)), distance)

    def _pitch(self, transmission: Transmission) -> PitchPair:
        from ncgear.pitch.pair import sized_pair

        gears = self.gears
        return sized_pair(transmission, gears.teeth, gears.module_mm, gears.center_distance_mm)

    def _teeth(self, pitch: PitchPair) -> ToothedPair:
        from ncgear.teeth.gear import toothed_pair

        return toothed_pair(pitch, self.gears.form(pitch.size.module_mm), self.gears.chord_tolerance_mm)
