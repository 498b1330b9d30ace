"""The keys of a row of gears, with idlers: what is refused of one, and what its law may be."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ncgear.design.keys.base import Faults, fault
from ncgear.design.keys.machine import NoLinkage

if TYPE_CHECKING:
    from ncgear.design.keys.design import Design
    from ncgear.design.keys.gears import Gears, Idlers

OFFERED = {
    **dict.fromkeys(("gears.driven", "gears.material"), ", but the same for both gears"),
    "gears.rack.idle_pressure_angle_deg": ", where both flanks of an idler push",
}
"""What is offered in place of keys that a row of gears refuses, or why it refuses them."""


def row_faults(design: Design, gears: Gears, idlers: Idlers) -> Faults:
    """A row has gears of one kind: the keys of one pair that have no meaning for an idler are refused."""
    lobes = gears.lobes.driving, gears.lobes.driven, *idlers.lobes
    given = f"{':'.join(map(str, lobes))} in all"
    if not isinstance(design.linkage, NoLinkage) and {*lobes} != {1}:
        yield fault("gears.idlers.lobes", f"{given}, but a row that moves a mechanism has one lobe each")
    if idlers.law_of == "first_pair" and design.motion.gives_slider:
        said = f"first_pair given, but {design.motion.law} tells how the slider moves; row is right"
        yield fault("gears.idlers.law_of", said)
    if design.prescribes_row and lobes != (1, 1, 1):
        said = "but one idler, with one lobe of each gear, makes a law of the last gear; [1] is right"
        yield fault("gears.idlers.lobes", f"{given}, {said}")
    material, driving, driven = gears.material, gears.driving.model_dump(), gears.driven.model_dump()
    asked = {
        "motion.law": design.motion.is_open or design.motion.pairs_in_series > 1,
        "strength.overload": design.strength.overload is not None,
        "drivetrain": design.drivetrain is not None,
        "gears.pairs": gears.pairs > 1,
        "gears.mesh": gears.mesh != "external",
        "gears.helix": gears.helix is not None,
        "gears.housing": gears.housing is not None,
        "gears.method": gears.method != "exact",
        "gears.index_holes": gears.index_holes,
        "gears.backlash_deg": gears.backlash_deg is not None,
        "gears.rack.idle_pressure_angle_deg": gears.rack.angles_deg[0] != gears.rack.angles_deg[1],
        "gears.profile_shift": gears.profile_shift != type(gears.profile_shift)(),
        "gears.cutter": gears.cutter != type(gears.cutter)(),
        "gears.tolerances.tooth_thickness_upper_mm": gears.tolerances.tooth_thickness_upper_mm is not None,
        "gears.driven": any(driven[name] != value for name, value in driving.items()),
        "gears.material": material is not None and material.each[0] != material.each[1],
    }
    for key in (key for key, is_given in asked.items() if is_given):
        said = f"not offered for a row of gears with idlers{OFFERED.get(key, '')}"
        yield fault(key, f"{said}; leave it out, or gears.idlers")
