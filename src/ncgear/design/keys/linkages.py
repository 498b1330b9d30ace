"""The keys under ``linkage`` of all mechanisms, and of what moves beside the gears.

Keys of the same name mean the same in all of them.
"""

from __future__ import annotations

from typing import Literal

from ncgear.design.keys.base import Model, optional, required
from ncgear.design.keys.types import Length, Place


class CrankKeys(Model):
    """A mechanism with a crank."""

    crank_mm: Length | None = optional(
        "length of the crank in mm; may be left out only when motion.solve_for is stroke"
    )


class Linkage(CrankKeys):
    """The crank-slider that the driven gear turns."""

    rod_mm: Length = required("length of the connecting rod in mm")
    offset_mm: Place = optional("distance of the slider's line from the crank axis in mm", 0.0)


class NoLinkage(Model):
    """Gears by themselves: the driven shaft is the output."""


class YokeKeys(CrankKeys):
    """The Scotch yoke that the driven gear turns."""


class RockerKeys(CrankKeys):
    """The crank-rocker (four-bar linkage) that the driven gear turns."""

    coupler_mm: Length = required("length of the coupler of a crank_rocker, from crank pin to rocker pin, in mm")
    rocker_mm: Length = required("length of the rocker of a crank_rocker, from its axis to its pin, in mm")
    ground_mm: Length = required("distance of a crank_rocker's axes, crank to rocker, in mm")
    side: Literal[1, -1] = optional(
        "side of the rocker's pin as seen from the crank's axis to the rocker's, with the crank turning clockwise: 1 "
        "on the left, -1 on the right",
        1,
    )


class LeverKeys(CrankKeys):
    """The slotted lever with its ram that the driven gear turns."""

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
