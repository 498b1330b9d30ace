"""The keys under ``linkage`` of the mechanisms besides the crank-slider, and of what moves beside the gears.

Keys of the same name mean the same in all of them.
"""

from __future__ import annotations

from typing import Literal

from ncgear.design.keys.base import Length, Model, optional, required
from ncgear.design.keys.machine import Linkage

CRANK = Linkage.model_fields["crank_mm"].description


class YokeKeys(Model):
    """The Scotch yoke that the driven gear turns."""

    crank_mm: Length | None = optional(CRANK)


class RockerKeys(Model):
    """The crank-rocker (four-bar linkage) that the driven gear turns."""

    crank_mm: Length | None = optional(CRANK)
    coupler_mm: Length = required("length of the coupler of a crank_rocker, from crank pin to rocker pin, in mm")
    rocker_mm: Length = required("length of the rocker of a crank_rocker, from its axis to its pin, in mm")
    ground_mm: Length = required("distance of a crank_rocker's axes, crank to rocker, in mm")
    side: Literal[1, -1] = optional(
        "side of the rocker's pin as seen from the crank's axis to the rocker's, with the crank turning clockwise: 1 "
        "on the left, -1 on the right",
        1,
    )


class LeverKeys(Model):
    """The slotted lever with its ram that the driven gear turns."""

    crank_mm: Length | None = optional(CRANK)
    pivot_mm: Length = required("distance of a slotted_lever's axis from the crank's in mm, over crank_mm")
    lever_mm: Length = required(
        "length of a slotted_lever from its axis to the pin of the ram in mm, over pivot_mm + crank_mm"
    )


class RackKeys(Model):
    """The pinion on the shaft of the driven gear, and the rack that it moves."""

    radius_mm: Length | None = optional("pitch radius of a rack_pinion's pinion in mm; needed")


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
