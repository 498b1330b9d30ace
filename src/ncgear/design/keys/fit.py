"""The keys of the section ``fit``: what stands and moves beside the gears."""

from __future__ import annotations

from typing import Literal

from ncgear.design.keys.base import Length, Model, optional


class Fit(Model):
    """What a build needs to know to tell whether rod and crank pin pass the shafts."""

    rod_width_mm: Length | None = optional(
        "width of the rod in mm, or of coupler, rocker, lever, and bar and slot of yoke or ram, across its length and "
        "the axes; left out: none is assumed, and a build tells the widest that passes"
    )
    driving_shaft: Literal["through", "ends"] = optional(
        "through: shaft and hub of the driving gear stand in the plane in which rod and crank pin move; ends: they "
        "end below it, or are on the other side of the gears",
        "through",
    )
