"""The keys that say a design's size, for another number of teeth."""

from __future__ import annotations

from ncgear.design.gears import Gears
from ncgear.output.advice.values import Change
from ncgear.pitch.sizing import Size


def resized(gears: Gears, size: Size, teeth: int) -> tuple[Change, ...]:
    """The changes that give the driving gear ``teeth`` teeth at the same centre distance, by a module that fits.

    A design that gives teeth and centre distance needs no other change; from one that gives the module it changes too,
    or is left out where the centre distance is given.
    """
    changes = [Change("gears.teeth", teeth)]
    if gears.module_mm is not None:
        fitting = size.module_mm * size.driving_teeth / teeth
        changes.append(Change("gears.module_mm", fitting if gears.center_distance_mm is None else None))
    return tuple(changes)
