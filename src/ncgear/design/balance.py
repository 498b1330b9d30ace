"""The balance file: what shakes, and what is asked about it."""

from __future__ import annotations

from typing import Annotated, Self

from pydantic import Field, Strict, model_validator

from ncgear.design.angles import given, listed
from ncgear.design.balance_excitation import Excitations
from ncgear.design.balance_mechanism import Chassis, Mechanism
from ncgear.design.balance_rotor import ChainDrive, GearBalance, Rotor
from ncgear.design.base import Model, Speed
from ncgear.design.faults import fault
from ncgear.design.naming import NAME_PATTERN

QUESTIONS = ("excitations", "gears", "rotor", "chain_drive")


class Balance(Model):
    """A balance file: what a person wrote, and nothing computed."""

    name: str = Field(pattern=NAME_PATTERN, description="name of the file's subject and of its output folder")
    description: str = Field(default="", max_length=10_000, description="free text")
    speed_rpm: Speed | None = Field(
        default=None, description="speed in r/min of the shaft that drives the mechanisms and the gears"
    )
    mechanisms: Annotated[tuple[Mechanism, ...], Strict(False), Field(max_length=50)] = Field(
        default=(), description="crank-sliders on one frame, a list"
    )
    move_phase_of: str | None = Field(
        default=None, description="name of the mechanism whose best phase is looked for; left out: none"
    )
    chassis: Chassis | None = Field(default=None, description="counterweight at the tail of a chassis")
    excitations: Excitations | None = Field(default=None, description="frequencies beside natural ones")
    gears: GearBalance | None = Field(default=None, description="balance of a design's gears")
    rotor: Rotor | None = Field(default=None, description="field balancing from trial weights")
    chain_drive: ChainDrive | None = Field(default=None, description="equivalent unbalance of a chain drive")

    @model_validator(mode="after")
    def _asks_something(self) -> Self:
        if not self.mechanisms and not given(self, QUESTIONS):
            raise fault("", f"nothing is asked; give mechanisms, {listed(QUESTIONS)}")
        if self.excitations and self.excitations.harmonics and not self.mechanisms:
            raise fault("excitations.harmonics", "there is no mechanism whose slider has any; give mechanisms")
        if self.speed_rpm is None and (self.mechanisms or self.gears):
            raise fault("speed_rpm", "missing; mechanisms and gears need the speed of their shaft in r/min")
        return self

    @model_validator(mode="after")
    def _names_are_known_and_differ(self) -> Self:
        names = [mechanism.name for mechanism in self.mechanisms]
        for number, name in enumerate(names):
            if name in names[:number]:
                raise fault(f"mechanisms.{number}.name", f"{name!r} is the name of an earlier one; choose another")
        asked = {"move_phase_of": self.move_phase_of}
        asked["chassis.mechanism"] = self.chassis.mechanism if self.chassis else None
        for key, asked_name in asked.items():
            if asked_name is not None and asked_name not in names:
                raise fault(key, f"{asked_name!r} is no mechanism of this file; {listed(names) or 'none'} is right")
        if self.move_phase_of is not None and len(names) < 2:
            raise fault("move_phase_of", "a single mechanism has no best phase; give a second one, or leave it out")
        return self
