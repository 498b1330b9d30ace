"""From keys to the basic rack in mm for a given module."""

from __future__ import annotations

from math import radians
from typing import TYPE_CHECKING

from ncgear.design.keys.gears import Rack

if TYPE_CHECKING:
    from ncgear.teeth.form import BasicRack, TipRelief


def basic_rack(rack: Rack, module_mm: float) -> BasicRack:
    """The basic rack in mm for a given module."""
    from ncgear.teeth.form import BasicRack

    return BasicRack(
        module_mm=module_mm,
        pressure_angle_rad=radians(rack.pressure_angle_deg),
        addendum_mm=rack.addendum * module_mm,
        dedendum_mm=rack.dedendum * module_mm,
        root_radius_mm=rack.root_radius * module_mm,
        relief=_relief(rack, module_mm),
        idle_angle_rad=radians(rack.angles_deg[1]),
    )


def _relief(rack: Rack, module_mm: float) -> TipRelief | None:
    from ncgear.teeth.form import TipRelief

    if rack.tip_relief is None:
        return None
    start, full = rack.tip_relief.start * module_mm, rack.addendum * module_mm
    return TipRelief(rack.tip_relief.amount * module_mm, start, full)
