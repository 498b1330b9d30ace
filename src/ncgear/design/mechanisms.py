"""The list of mechanisms: one line joins a mechanism's class to its keys in design files, and nothing else names it.

The keys under ``linkage`` have the names of the lengths of the class.  The key ``linkage.kind`` tells which mechanism a
design has; without the key, it is the first one.  A design without ``linkage`` has gears alone.  Classes are imported
when a mechanism is made, so that reading a design file loads no numerical library.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import field, fields
from importlib import import_module
from typing import TYPE_CHECKING, Any

from ncgear.design.keys import machine
from ncgear.design.keys.base import Model
from ncgear.design.keys.masses import DrivenShaftMasses, GearMasses, LeverMasses, Masses, RockerMasses, SlidingMasses
from ncgear.design.wishes.registry import TurningWishes, Wishes
from ncgear.errors import WrongInput
from ncgear.frozen import dataclass

if TYPE_CHECKING:
    from ncgear.mechanisms.mechanism import Mechanism


@dataclass(frozen=True)
class MechanismEntry:
    """A mechanism of design files: its class, and its keys under the groups of the file.

    One key under ``linkage`` may have the default None: the length follows if the law gives the stroke.
    """

    module: str
    """The module of the class in ``ncgear.mechanisms``; both have the same name."""

    linkage: type[Model]
    masses: type[GearMasses] = SlidingMasses
    resistance: type[machine.Load] = machine.Resistance
    wishes: type[Wishes] = Wishes
    proportions: Mapping[str, float] = field(default_factory=dict)
    """Lengths of a working machine, as multiples of its crank or pinion, for new designs with this mechanism."""

    has_crank_pin: bool = True

    def load(self) -> type[Mechanism]:
        """The class of the mechanism."""
        module = import_module(f"ncgear.mechanisms.{self.module}")
        return getattr(module, self.module.title().replace("_", ""))

    @property
    def stroke_key(self) -> str | None:
        """The key of the length that may be left out if the law gives the stroke; None if no law gives it."""
        return next((name for name, field in self.linkage.model_fields.items() if field.default is None), None)

    @property
    def turns(self) -> bool:
        """Whether the output turns."""
        return issubclass(self.resistance, machine.TurningLoad)

    @property
    def needed_masses(self) -> list[str]:
        """Keys that a file must have under ``masses``."""
        return [name for name, field in self.masses.model_fields.items() if field.is_required()]


NO_LINKAGE = "none"
"""The name of gears without a linkage."""

MECHANISMS: dict[str, MechanismEntry] = {
    "crank_slider": MechanismEntry(
        "crank_slider", machine.Linkage, Masses, proportions={"crank_mm": 1.0, "rod_mm": 3.0}
    ),
    "scotch_yoke": MechanismEntry("scotch_yoke", machine.YokeKeys, proportions={"crank_mm": 1.0}),
    "crank_rocker": MechanismEntry(
        "crank_rocker",
        machine.RockerKeys,
        RockerMasses,
        machine.RockerTorque,
        TurningWishes,
        {"crank_mm": 1.0, "coupler_mm": 3.25, "rocker_mm": 2.25, "ground_mm": 3.5},
    ),
    "slotted_lever": MechanismEntry(
        "slotted_lever", machine.LeverKeys, LeverMasses, proportions={"crank_mm": 1.0, "pivot_mm": 2.5, "lever_mm": 5.0}
    ),
    "rack_pinion": MechanismEntry("rack_pinion", machine.RackKeys, proportions={"radius_mm": 1.0}, has_crank_pin=False),
    NO_LINKAGE: MechanismEntry(
        "driven_shaft", machine.NoLinkage, DrivenShaftMasses, machine.ShaftTorque, has_crank_pin=False
    ),
}
"""All mechanisms by their names in ``linkage.kind``; the first is the usual mechanism."""


def entry_of(linkage: Model) -> MechanismEntry:
    """The entry of the mechanism that a group of keys describes."""
    return next(entry for entry in MECHANISMS.values() if isinstance(linkage, entry.linkage))


def usual_mechanism(**lengths: float) -> Mechanism:
    """The usual mechanism with the given lengths; raises WrongInput where no such mechanism exists."""
    return next(iter(MECHANISMS.values())).load()(**lengths)


def lengths_of(linkage: Model) -> dict[str, Any]:
    """All lengths of a group of keys; None for a length that is left out."""
    made: Any = entry_of(linkage).load()
    return {field.name: getattr(linkage, field.name) for field in fields(made)}


def mechanism_of(linkage: Model) -> Mechanism:
    """The mechanism of a group of keys; raises WrongInput where a length is missing or the crank cannot turn."""
    entry, lengths = entry_of(linkage), lengths_of(linkage)
    if entry.stroke_key is not None and lengths[entry.stroke_key] is None:
        key = f"linkage.{entry.stroke_key}"
        raise WrongInput("missing; give it in mm: only a stroke that is solved for gives the crank", key=key)
    return entry.load()(**lengths)


def mechanism_of_stroke(linkage: Model, stroke_mm_of: Callable[[type[Mechanism]], float]) -> Mechanism:
    """The mechanism with the crank for the stroke that the law gives on a mechanism of its class.

    Raises WrongInput if the file also gives the crank, and if no crank gives that stroke.
    """
    entry, lengths = entry_of(linkage), lengths_of(linkage)
    crank_mm = lengths.pop(entry.stroke_key) if entry.stroke_key is not None else None
    if crank_mm is not None:
        raise WrongInput(
            f"{crank_mm:g} mm is given, but the crank follows from the stroke that is solved for; leave it out",
            key=f"linkage.{entry.stroke_key}",
        )
    mechanism = entry.load()
    return mechanism.of_stroke(stroke_mm_of(mechanism), **lengths)


def kind_named(data: Any) -> Any:
    """The name of the mechanism, as in the file, in the plain values of a design."""
    if not isinstance(data, Mapping) or "linkage" not in data:
        return NO_LINKAGE
    usual, linkage = next(iter(MECHANISMS)), data["linkage"]
    return linkage.get("kind", usual) if isinstance(linkage, Mapping) else usual
