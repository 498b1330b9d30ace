"""The choices of `ncgear design` for a whole machine, and the figures that count."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any, Literal

from pydantic import BeforeValidator, Field

from ncgear.design.keys.base import Faults, Length, Model, Positive, Several, fault, given, optional, required
from ncgear.design.keys.strength import WrittenMaterial

FEWEST_MACHINES, MOST_MACHINES = 1, 20

Price = Annotated[float, Field(ge=0.0, le=1e12)]

Process = Literal["hobbed", "shaped", "wire_cut", "printed"]
"""Ways of making teeth."""

OBJECTIVES = Literal["peak_power_w", "gear_volume_mm3", "driven_flywheel_kg_mm2", "center_distance_mm", "cost"]
"""Figures of a whole machine that may count."""


class AvailableMotor(Model):
    """An available motor, by its effect on the driving shaft."""

    name: str = required("its name", min_length=1, max_length=100)
    power_w: Positive = required("greatest power in W that it gives to the driving shaft")
    torque_n_m: Positive | None = optional("greatest torque in N m that it gives to the driving shaft; left out: any")
    cost: Price = optional("its cost", 0.0)


class MaterialChoice(Model):
    """A material that may be chosen for both gears."""

    material: WrittenMaterial = required("material of both gears: a name, or a group of keys")
    cost_factor: Positive = optional("how many times as much gears of it cost for their volume", 1.0)


def _of_material(value: Any) -> Any:
    """The group of keys for the name of a material, which may stand alone."""
    return {"material": value} if isinstance(value, str) else value


if TYPE_CHECKING:
    WrittenChoice = MaterialChoice
else:
    WrittenChoice = Annotated[
        MaterialChoice, BeforeValidator(_of_material, json_schema_input_type=str | MaterialChoice)
    ]


class FaceWidths(Model):
    """The face widths that may be chosen, in modules."""

    RULES = ("least <= most",)

    least: Annotated[float, Field(ge=1.0, le=30.0)] = optional("least face width in modules", 5.0)
    most: Annotated[float, Field(ge=1.0, le=30.0)] = optional("greatest face width in modules", 12.0)


class MakingCosts(Model):
    """Costs of making the teeth of a pair, at any size."""

    hobbed: Price = optional("cost of hobbing a pair", 0.0)
    shaped: Price = optional("cost of shaping a pair", 0.0)
    wire_cut: Price = optional("cost of cutting a pair by wire", 0.0)
    printed: Price = optional("cost of printing a pair", 0.0)


class Costs(Model):
    """Costs of a machine in money, kilograms or another unit: the sum of its figures, each times its factor."""

    motor_per_w: Price = optional("cost of each W of the driving shaft's peak power", 0.0)
    motor_per_n_m: Price = optional("cost of each N m of the driving shaft's peak torque", 0.0)
    gears_per_dm3: Price = optional(
        "cost of each dm3 of face width times centre distance squared; solid gears of steel have about 12 kg of it", 0.0
    )
    driven_flywheel_per_kg_m2: Price = optional("cost of each kg m2 of the flywheel on the driven shaft", 0.0)
    making: MakingCosts = optional("cost of making the teeth, by the process", MakingCosts)

    def _faults(self) -> Faults:
        if not self.model_fields_set:
            yield fault("", "nothing costs anything; give one price or more, or leave the group out")


class Choices(Model):
    """Choices for a whole machine; the law, module, teeth and face width are always chosen."""

    materials: Annotated[Several[WrittenChoice], Field(min_length=1, max_length=10)] | None = optional(
        "materials of both gears that may be chosen; left out: gears.material"
    )
    processes: Annotated[Several[Process], Field(min_length=1, max_length=4)] = optional(
        "ways of making teeth that may be chosen: hobbed, shaped, wire_cut, printed", ("hobbed",)
    )
    modules_mm: Annotated[Several[Length], Field(min_length=1, max_length=50)] | None = optional(
        "modules in mm that may be chosen; left out: series I of ISO 54"
    )
    face_width_modules: FaceWidths = optional("face widths that may be chosen, in modules", FaceWidths)
    center_distance_mm: Length | None = optional("greatest centre distance in mm; left out: no limit")
    diameter_mm: Length | None = optional("greatest diameter of either gear in mm; left out: no limit")
    motors: Annotated[Several[AvailableMotor], Field(min_length=1, max_length=50)] | None = optional(
        "available motors; the cheapest motor that is strong enough is taken; left out: motors of any power"
    )
    least: Annotated[Several[OBJECTIVES], Field(min_length=1, max_length=4)] | None = optional(
        "figures that shall be small; left out: the peak power, the gears' volume and, where it is free, the flywheel"
    )
    cost: Costs | None = optional("costs of a machine; the cheapest machine is recommended; left out: no cost")
    machines: Annotated[int, Field(ge=FEWEST_MACHINES, le=MOST_MACHINES)] = optional(
        "greatest number of machines in the answer", 8
    )

    def _faults(self) -> Faults:
        if self.least is not None and "cost" in self.least and not (self.cost or self.motors):
            yield fault("cost", "missing; least names the cost: give what the figures cost, or leave it out of least")
        for key in given(self, ("processes", "modules_mm", "least")):
            values = getattr(self, key)
            if len(set(values)) < len(values):
                yield fault(key, "the same is given twice; once is right")
