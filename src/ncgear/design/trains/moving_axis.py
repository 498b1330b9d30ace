"""The train ``moving_axis``: a pair of gears whose centre distance changes while they turn."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

from pydantic import Field

from ncgear.design.keys.base import FORMULA, Expression, Length, Several, optional, required
from ncgear.design.trains.base import TrainGears, TrainKeys
from ncgear.errors import WrongInput, renamed

if TYPE_CHECKING:
    from ncgear.pitch.moving_axes import MovingAxes
    from ncgear.ratio.transmission import JetFunction, Lobes
    from ncgear.trains.train import Train


class MovingGearKeys(TrainGears):
    """The teeth and the bodies of both gears."""

    module_mm: Length | None = optional("module in mm; left out: as it follows from teeth and distances", None)
    teeth: int = required("teeth of the driving gear, a whole number; the module follows", ge=8, le=1000)


class MovingAxis(TrainKeys):
    """A pair of gears on a moving axis."""

    KIND = "moving_axis"
    RULES = ("one of distances_mm distance_mm",)
    MEANING = "a pair of gears whose centre distance changes while they turn"

    distances_mm: Annotated[Several[Length], Field(min_length=3, max_length=64)] | None = optional(
        "centre distances in mm at evenly spaced driving angles over a lobe of the driving gear, from 0 on"
    )
    distance_mm: Expression | None = optional(f"centre distance in mm as a formula of phi, {FORMULA}")
    ratio: Expression | None = optional(
        f"ratio i12 as a formula of phi, {FORMULA}, times the factor that closes the cycle; left out: even"
    )
    round_driving: bool = optional("whether the driving gear is round, in place of a ratio", default=False)
    driving_lobes: int = optional("lobes of the driving gear, a whole number", 1, ge=1, le=64)
    driven_lobes: int = optional("lobes of the driven gear, a whole number", 1, ge=1, le=64)
    gears: MovingGearKeys = required("the teeth and the bodies of both gears")

    def _made(self) -> Train:
        """The train of the keys; raises WrongInput and NoSuchMechanism if no such gears exist."""
        from ncgear.trains.moving_axis import module_mm, moving_train

        axes, radius = self._axes()
        gears = self.gears
        given = "train.distance_mm" if self.distances_mm is None else "train.distances_mm"
        with renamed("motion", given), renamed("motion.ratio", "train.ratio"):
            module = module_mm(axes, gears.teeth)
        if gears.module_mm is not None and abs(gears.module_mm - module) > AGREED * module:
            raise WrongInput(
                f"{gears.module_mm:g} mm given, but {gears.teeth} teeth on the curves of these distances have "
                f"{module:.9g} mm; leave it out, or change distances or teeth",
                key="train.gears.module_mm",
            )
        form, sizes = gears.form(module), (gears.face_width_mm, gears.bore_mm)
        return moving_train(axes, gears.teeth, form, *sizes, self.speed_rpm, gears.chord_mm(module), radius)

    def _axes(self) -> tuple[MovingAxes, float | None]:
        """The law on its moving axis, and the radius of the driving gear if it is round."""
        from ncgear.pitch.moving_axes import MovingAxes, round_driving_law
        from ncgear.ratio.laws.expression import ratio_expression_law
        from ncgear.ratio.laws.uniform import uniform_law
        from ncgear.ratio.transmission import Lobes

        lobes = Lobes(self.driving_lobes, self.driven_lobes)
        distance = self._distance(lobes)
        if self.round_driving:
            if self.ratio is not None:
                raise WrongInput("true, but a ratio is given as well; one of them is right", key="train.round_driving")
            law, radius = round_driving_law(distance, lobes, "train.round_driving")
            return MovingAxes(law, distance), radius
        if self.ratio is None:
            return MovingAxes(uniform_law(lobes), distance), None
        with renamed("motion", "train"):
            return MovingAxes(ratio_expression_law(self.ratio, lobes, scale_to_close=True), distance), None

    def _distance(self, lobes: Lobes) -> JetFunction:
        """The centre distance as a function of the driving angle."""
        import numpy as np

        from ncgear.numerics.formula import composed
        from ncgear.numerics.jet import Jet
        from ncgear.pitch.moving_axes import even_distances, require_distances

        if self.distances_mm is not None:
            return require_distances(
                even_distances(np.array(self.distances_mm), lobes.driving), lobes, "train.distances_mm"
            )
        assert self.distance_mm is not None
        formula = composed(self.distance_mm, "train.distance_mm", "phi")
        return require_distances(lambda phi, order: formula(Jet.variable(phi, order)), lobes, "train.distance_mm")


AGREED = 1e-6
"""Largest relative difference of a given module that counts as rounding in a file."""
