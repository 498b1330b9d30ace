"""Common keys of every kind of train, and the keys of teeth and bodies that kinds share."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Mapping
from math import radians
from typing import TYPE_CHECKING, Annotated, Any, ClassVar

from pydantic import Field

from ncgear.design.keys.base import Length, Model, Speed, optional, required
from ncgear.design.keys.gears import Rack
from ncgear.design.keys.machine import CHORD_MM, COARSEST_IN_MODULES, Output, ShaftTorque
from ncgear.design.keys.strength import StrengthKeys, WrittenMaterials
from ncgear.design.keys.tolerances import AssemblyTolerances
from ncgear.errors import WrongInput, renamed

if TYPE_CHECKING:
    from ncgear.teeth.form import ToothForm
    from ncgear.trains.train import Train


USUAL_IN_MODULES = 0.01
"""Chord tolerance of small teeth if none is given: a twenty-fifth of a usual tip clearance."""


class TrainKeys(Model):
    """The group ``train`` of a design file; each kind adds its own keys."""

    KIND: ClassVar[str]
    """The value of ``train.kind``."""

    MEANING: ClassVar[str]
    """The kind in a few words."""

    TURNS_ALONE: ClassVar[bool] = True
    """Whether ``machine`` turns as the train does; if its axes turn with a carrier, it has the loads and no power."""

    speed_rpm: Speed = required("speed of the driving part in r/min")

    def train(self) -> Train:
        """The train of the keys; every bore is inside its part, and rims are thicker than chords.

        Raises WrongInput and NoSuchMechanism with keys that begin with ``train``, such as ``train.gears.module_mm``.
        """
        from ncgear.trains.train import MORE_TEETH

        with (
            renamed("train.output", "train.gears"),
            renamed("train.gears.cutter.teeth", "train.gears.teeth", MORE_TEETH),
        ):
            return with_sound_bodies(self._made())

    WRITTEN_AS: ClassVar[Mapping[str, str]] = {}
    """The keys of ``machine`` that have other names in the train, by these names below ``train``."""

    @property
    def alone(self) -> tuple[str, ...]:
        """Beginnings of keys, as ``gears.``, of which the train's and the machine's of one name change the same."""
        return ("gears.", "strength.", "tolerances.")

    def require_bores(self) -> None:
        """Raise WrongInput for a bore that leaves too little of any gear, if ``machine`` does not."""

    def machine(self) -> dict[str, Any] | None:
        """The keys of the same gears in the file of one machine, by themselves, so that every command takes them.

        Keys of gears are those below ``train.gears``, if they have the same names; None for a kind that is no machine.
        """
        return None

    @abstractmethod
    def _made(self) -> Train:
        """The train of the keys of its kind; raises the errors of ``train``."""


def with_sound_bodies(train: Train) -> Train:
    """The train; raises WrongInput where a bore leaves no wall, with the largest bore, or a rim is too thin."""
    from shapely import Polygon

    from ncgear.solids.plan.areas import said_largest
    from ncgear.solids.plan.body import Bore
    from ncgear.solids.plan.room import has_room, largest_bore_mm

    tight, tolerance_mm = list[tuple[float, str, float]](), train.tolerance_mm
    for part in train.parts:
        if part.rim_mm is not None and part.rim_mm < part.wall_mm:
            raise WrongInput(
                f"{part.rim_mm:g} mm is less than one module outside the roots; {part.wall_mm:g} mm or more is right",
                key="train.gears.rim_mm",
            )
        if part.bore_mm is None:
            continue
        room = Polygon(part.outline_mm), Bore(part.bore_mm), part.wall_mm, tolerance_mm
        if not has_room(*room):
            tight.append((largest_bore_mm(*room), part.name, part.wall_mm))
    if tight:
        largest_mm, name, wall_mm = min(tight)
        around = "to the teeth of" if train.part(name).teeth else "at the side of"
        right = said_largest(largest_mm, "none fits; larger gears are needed")
        raise WrongInput(
            f"{train.part(name).bore_mm:g} mm leaves less than {wall_mm:g} mm, one module, {around} {name}; {right}",
            key="train.gears.bore_mm",
        )
    return train


class RatedTrain(TrainKeys):
    """A train whose gears are a machine by themselves, with what rates their teeth."""

    @classmethod
    def is_machine(cls, given: Mapping[str, Any]) -> bool:
        """Whether ``machine`` of such keys is one, whether they are right or not."""
        return True

    resistance: ShaftTorque | None = optional(
        "the torque against the last gear over its angle, for strength, tolerances and reports; left out: none"
    )
    strength: StrengthKeys = optional(
        "running conditions and safeties of the teeth; left out: 20 000 h in oil", StrengthKeys
    )
    tolerances: AssemblyTolerances | None = optional(
        "permissible deviations of gears and assembly, for ncgear tolerance; left out: grade 8 and more, which its "
        "answer tells"
    )


class TrainGears(Model):
    """The teeth and the bodies of all gears of a train."""

    module_mm: Length | None = optional("module in mm")
    face_width_mm: Length = required("face width of every gear in mm")
    rack: Rack = optional("basic rack of the teeth; left out: profile A of ISO 53", Rack)
    backlash_mm: Annotated[float, Field(ge=0.0, le=10.0)] = optional(
        "least normal backlash of each mesh in mm, taken off both gears in equal parts", 0.0
    )
    bore_mm: Length | None = optional("diameter in mm of the bore of every gear; left out: no bores")
    chord_tolerance_mm: Length | None = optional(
        f"how far the chords of outlines may be from the exact curves in mm, up to {COARSEST_IN_MODULES:g} modules; "
        f"left out: {CHORD_MM:g}, or {USUAL_IN_MODULES:g} modules if that is less"
    )

    def form(self, module_mm: float) -> ToothForm:
        """The form of the teeth in mm."""
        from ncgear.teeth.form import Backlash, ToothForm

        return ToothForm(self.rack.in_mm(module_mm), backlash=Backlash(self.backlash_mm))

    def chord_mm(self, module_mm: float) -> float:
        """The chord tolerance for a module; raises WrongInput for chords that are too coarse for teeth."""
        if self.chord_tolerance_mm is None:
            return min(CHORD_MM, USUAL_IN_MODULES * module_mm)
        with renamed("output", "train.gears"):
            return Output(chord_tolerance_mm=self.chord_tolerance_mm).chord_mm(module_mm)

    @property
    def pressure_angle_rad(self) -> float:
        """The rack's larger pressure angle."""
        return radians(max(self.rack.angles_deg))


class RatedGears(TrainGears):
    """The teeth and the bodies of all gears of a train whose teeth are rated."""

    material: WrittenMaterials | None = optional(
        "material of all gears by its name in docs/materials.md, as 42CrMo4 or POM; left out: 42CrMo4 is assumed where "
        "strength is computed"
    )
