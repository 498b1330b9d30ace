"""What the keys of every kind of train have, and the keys of teeth and bodies that kinds share."""

from __future__ import annotations

from abc import abstractmethod
from math import radians
from typing import TYPE_CHECKING, Annotated, ClassVar

from pydantic import Field

from ncgear.design.keys.base import Model, optional, required
from ncgear.design.keys.gears import Rack
from ncgear.design.keys.types import Length, Speed
from ncgear.design.rack import basic_rack

if TYPE_CHECKING:
    from ncgear.teeth.form import ToothForm
    from ncgear.trains.train import Train


class TrainKeys(Model):
    """The group ``train`` of a design file; each kind adds its own keys."""

    KIND: ClassVar[str]
    """The value of ``train.kind``."""

    MEANING: ClassVar[str]
    """What this kind is, in a few words."""

    speed_rpm: Speed = required("speed of the driving part in r/min")

    @abstractmethod
    def train(self) -> Train:
        """The train that the keys ask for.

        Raises WrongInput and NoSuchMechanism with keys that begin with ``train``, as ``train.gears.module_mm``.
        """


class TrainGears(Model):
    """The teeth and the bodies of all gears of a train."""

    module_mm: Length | None = optional("module in mm")
    face_width_mm: Length = required("face width of every gear in mm")
    rack: Rack = optional("basic rack of the teeth; left out: profile A of ISO 53", Rack)
    backlash_mm: Annotated[float, Field(ge=0.0, le=10.0)] = optional(
        "least normal backlash of each mesh in mm, taken off both gears in equal parts", 0.0
    )
    bore_mm: Length | None = optional("diameter in mm of the bore of every gear; left out: no bores")
    chord_tolerance_mm: Annotated[float, Field(gt=0.0, le=1.0)] = optional(
        "how far the chords of outlines may be from the exact curves in mm", 0.005
    )

    def form(self, module_mm: float) -> ToothForm:
        """The form of the teeth in mm."""
        from ncgear.teeth.form import Backlash, ToothForm

        return ToothForm(basic_rack(self.rack, module_mm), backlash=Backlash(self.backlash_mm))

    @property
    def pressure_angle_rad(self) -> float:
        """The rack's larger pressure angle."""
        return radians(max(self.rack.angles_deg))
