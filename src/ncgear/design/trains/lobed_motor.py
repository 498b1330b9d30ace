"""The train ``lobed_motor``: a lobed sun, round planets and a lobed ring that displace a liquid."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Literal

from pydantic import Field

from ncgear.design.keys.base import FORMULA, Expression, Length, optional, required
from ncgear.design.trains.base import TrainGears, TrainKeys
from ncgear.errors import NoSuchMechanism, WrongInput, renamed

if TYPE_CHECKING:
    from ncgear.trains.train import Train


class MotorGearKeys(TrainGears):
    """The teeth and the bodies of sun, planets and ring."""

    module_mm: Length = required("module in mm")
    rim_mm: Length = required("thickness of the ring outside its farthest root in mm")
    planet_shift: Annotated[float, Field(ge=-1.0, le=1.0)] = optional(
        "profile shift of the planets in modules; sun and ring have the opposite one", 0.0
    )
    cutter_teeth: int | None = optional(
        "teeth of the pinion cutter of sun and ring, a whole number; left out: as many as their hollows allow",
        ge=5,
        le=200,
    )
    backlash_mm: Annotated[float, Field(ge=0.0, le=10.0)] = optional(
        "normal backlash of each mesh in mm, taken off idle flanks of sun and ring", 0.0
    )
    bore_mm: Length | None = optional("diameter in mm of the sun's bore; left out: none")


class LobedMotor(TrainKeys):
    """Lobed sun, round planets, lobed ring."""

    KIND = "lobed_motor"
    MEANING = "a lobed sun, round planets and a lobed ring, as in hydraulic motors"

    sun_lobes: int = required("lobes of the sun, a whole number", ge=1, le=24)
    ring_lobes: int = required("lobes of the ring, a whole number above those of the sun", ge=2, le=30)
    planet_teeth: int = required("teeth of a planet, a whole number", ge=5, le=200)
    teeth_per_lobe: int = required(
        "teeth of each lobe, of sun and ring alike, a whole number; round gears have 2 planet_teeth / (ring_lobes - "
        "sun_lobes), and the more above, the higher the lobes",
        ge=4,
        le=400,
    )
    curve: Literal["ellipse", "cosine"] = optional(
        "the sun's pitch curve: ellipse, r = a (1 - e^2) / (1 - e cos(n phi)), or cosine, r = a (1 + e cos(n phi)); "
        "a and e follow from the teeth",
        "ellipse",
    )
    radius: Expression | None = optional(
        "shape of the sun's pitch curve as a formula of phi, its polar angle, and e, which is found with the size; in "
        f"any unit, in place of curve, {FORMULA}"
    )
    pressure_mpa: Annotated[float, Field(gt=0.0, le=200.0)] | None = optional(
        "pressure difference in MPa (10 bar each), for torque and forces; left out: none"
    )
    gears: MotorGearKeys = required("the teeth and the bodies of all gears")

    def _made(self) -> Train:
        from ncgear.pitch.lobed import FAMILIES, formula_family, lobed_curves
        from ncgear.trains.lobed_motor import MotorBodies, MotorTeeth, motor_train

        if self.ring_lobes <= self.sun_lobes:
            raise WrongInput(
                f"{self.ring_lobes} given; the ring is around the sun, and has more lobes than its {self.sun_lobes}",
                key="train.ring_lobes",
            )
        if self.radius is not None and "curve" in self.model_fields_set:
            raise WrongInput("given, but curve is given as well; one of them is right", key="train.radius")
        if 2 * self.planet_teeth == self.teeth_per_lobe * (self.ring_lobes - self.sun_lobes):
            raise NoSuchMechanism(
                f"{self.teeth_per_lobe} teeth per lobe make all gears round, and nothing is displaced; more of them, "
                "or fewer planet_teeth, are needed",
                key="train.teeth_per_lobe",
            )
        gears, module = self.gears, self.gears.module_mm
        lobes = self.sun_lobes, self.ring_lobes
        family = FAMILIES[self.curve]
        if self.radius is not None:
            family = formula_family(self.radius, self.sun_lobes, "train.radius")
        curves = lobed_curves(family, lobes, self.planet_teeth, self.teeth_per_lobe, module)
        teeth = MotorTeeth(
            gears.form(module).rack,
            self.planet_teeth,
            self.teeth_per_lobe,
            gears.planet_shift * module,
            gears.cutter_teeth,
            gears.backlash_mm,
        )
        bodies = MotorBodies(gears.face_width_mm, gears.rim_mm, gears.bore_mm)
        with renamed("train.gears.teeth", "train.planet_teeth"):
            return motor_train(curves, teeth, bodies, self.speed_rpm, self.pressure_mpa, gears.chord_mm(module))
