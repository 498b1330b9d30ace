"""How ncgear fit follows the outline that a design draws."""

from __future__ import annotations

from typing import Literal

from ncgear.design.keys.base import Model, optional


class FollowedOutline(Model):
    """What the nearest pair that can be made is nearest in."""

    axis: Literal["free", "fixed"] = optional(
        "free: the axis is where the curve comes nearest to the outline; fixed: it stays where the outline has it",
        "free",
    )
    criterion: Literal["root_mean_square", "greatest"] = optional(
        "root_mean_square: the least root of the mean square of the distances between outline and curve; greatest: "
        "the least greatest distance",
        "root_mean_square",
    )
