"""What is asked of the teeth: the basic rack and everything that departs from it."""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import Enum

from ncgear.machine.rack import BasicRack
from ncgear.teeth.ceilings import Ceilings


class CutterKind(Enum):
    """What leaves the fillets."""

    AUTO = "auto"
    RACK = "rack"
    PINION = "pinion"
    MATE = "mate"


@dataclass(frozen=True)
class Cutter:
    """A kind of tool; ``teeth`` of a pinion cutter, chosen where None."""

    kind: CutterKind = CutterKind.AUTO
    teeth: int | None = None


@dataclass(frozen=True)
class TipLimits:
    """What is asked of tips: the least land in mm, and whether undercut is avoided by shortening them.

    ``ceilings`` are over the tips of helical teeth, which must not jump from section to section.
    """

    least_land_mm: float = 0.0
    avoid_undercut: bool = True
    ceilings: Ceilings | None = None


@dataclass(frozen=True)
class ToothForm:
    """The teeth of a pair.

    ``driving_shift_mm`` and ``driven_shift_mm`` are profile shifts; with ``shift_for_undercut`` they are chosen, equal
    and opposite, so that as little as possible is undercut.  ``equivalent`` takes every flank from its equivalent
    circular gear.
    """

    rack: BasicRack
    driving_shift_mm: float = 0.0
    driven_shift_mm: float = 0.0
    shift_for_undercut: bool = False
    cutter: Cutter = field(default_factory=Cutter)
    limits: TipLimits = field(default_factory=TipLimits)
    equivalent: bool = False
