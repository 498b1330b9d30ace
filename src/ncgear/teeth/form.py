"""What is asked of the teeth: the basic rack and everything that departs from it."""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import Enum
from typing import NamedTuple

from ncgear.teeth.ceilings import Ceilings
from ncgear.teeth.rack import BasicRack


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


class Way(NamedTuple):
    """A way of sharing out a fouling: tips raised for what the mates' have lost or not, and whose are shortened first.

    ``first`` is 0 for the driving gear's tips and 1 for the driven one's.
    """

    raised: bool
    first: int


WAYS = Way(True, 0), Way(True, 1), Way(False, 0), Way(False, 1)
"""All of them, the ones that usually leave most contact first."""


@dataclass(frozen=True)
class TipLimits:
    """What is asked of tips: the least land in mm, and whether undercut is avoided by shortening them.

    Helical teeth must not jump from section to section: ``way`` is the one in which all sections share out foulings,
    the best for each where None, and ``ceilings`` are over their tips.
    """

    least_land_mm: float = 0.0
    avoid_undercut: bool = True
    way: Way | None = None
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
