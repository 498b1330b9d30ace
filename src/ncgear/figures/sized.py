"""What is told of the gears that ``ncgear size`` finds: a table of the smallest, and the design file with the first."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from ncgear.design.keys.base import listed
from ncgear.design.reading.design_file import LoadedDesign
from ncgear.design.reading.text import whole
from ncgear.design.rewritten import told_copy
from ncgear.figures.advice.drivetrain_advice import around
from ncgear.figures.advice.values import Advice, changed
from ncgear.figures.numbers import shown, to_digits
from ncgear.figures.strong import of_weakest, strength_summary
from ncgear.pitch.shape import Gear
from ncgear.project.figures import figures_of
from ncgear.project.sizing import Sized, stated_inertias
from ncgear.strength.holding import Damage, worst

SUFFIX = "-sized"


def sized_row(one: Sized) -> list[str]:
    """The texts: module, teeth, face width, centre distance, diameter, both safeties, the weakest tooth."""
    size, weak = one.drive.pitch.size, worst(one.rating.weakest)
    least = [
        min((each.safety for each in one.rating.weakest if each.damage is damage), default=None) for damage in Damage
    ]
    return [
        f"{size.module_mm:g}",
        f"{size.driving_teeth}:{size.driven_teeth}",
        f"{one.face_width_mm:g}",
        shown(round(size.center_distance_mm, 2)),
        shown(round(one.diameter_mm, 1)),
        *("-" if safety is None else to_digits(safety, 3) for safety in least),
        f"{weak.gear.value} {weak.tooth}",
    ]


def parts_that_fail(one: Sized) -> list[Advice]:
    """What of shafts, keys, bearings and couplings around the gears does not hold with them."""
    if one.drive.design.drivetrain is None:
        return []
    return [told for told in around(one.drive) if isinstance(told, Advice) and told.matters]


def sized_figures(found: Sequence[Sized], herringbone: Sized | None = None) -> dict[str, Any]:
    """The smallest gears that hold as plain values whose keys end in their unit, the smallest first.

    Then those with herringbone teeth, if there are any.
    """
    first = found[0]
    design, rating = first.drive.design, first.rating
    wanted = of_weakest(rating, lambda one: {"safety_wanted": one.wanted})
    materials = {
        gear.value: {"material": rating.strength.of(gear).material.name, **wanted[gear.value]} for gear in Gear
    }
    return {
        "design": {"name": design.name, "description": design.description},
        "load": {"speed_rpm": design.operation.speed_rpm},
        **materials,
        "smallest": [_sizes(one) for one in found],
        **({"herringbone": _sizes(herringbone)} if herringbone else {}),
    }


def _sizes(one: Sized) -> dict[str, Any]:
    return {
        **figures_of(one.drive, "module_mm", "teeth_driving", "teeth_driven", "face_width_mm", "center_distance_mm"),
        "largest_diameter_mm": one.diameter_mm,
        "strength": strength_summary(one.rating, one.drive),
        "parts_that_fail": [told.what for told in parts_that_fail(one)],
        "keys": dict(one.changes),
    }


def sized_design(loaded: LoadedDesign, one: Sized, asked: dict[str, float | str]) -> str:
    """The text of a design file with other gears and with what was asked for, its name and description saying so."""
    design = loaded.design
    chosen = {key: whole(value) if isinstance(value, float) else value for key, value in (asked | one.changes).items()}
    said = f"Sized: {design.name} with {listed(map(str, changed(chosen)), 'and')}, so that its teeth hold."
    values = {**chosen, **dict.fromkeys(stated_inertias(design))}
    return told_copy(loaded, SUFFIX, said, values)
