"""How ncgear fit follows the outline that a design draws."""

from __future__ import annotations

from typing import Literal

from ncgear.design.keys.base import Model, optional


class FollowedOutline(Model):
    """What the curve near an outline keeps, and what it is nearest in."""

    axis: Literal["free", "fixed"] = optional(
        "free: the axis is where the curve comes nearest to the outline; fixed: it stays where the outline has it",
        "free",
    )
    pressure_angle_deg: float = optional(
        "greatest pressure angle in degrees, that of the rack included; beyond 60 friction may lock the pair",
        75.0,
        gt=40.0,
        lt=85.0,
    )
    criterion: Literal["root_mean_square", "greatest"] = optional(
        "root_mean_square: the least root of the mean square of the distances between outline and curve; greatest: "
        "the least greatest distance",
        "root_mean_square",
    )
