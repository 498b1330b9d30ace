"""How ncgear fit follows the outline that a design draws, and an outline of the mate."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

from ncgear.design.keys.base import Faults, Model, fault, given, optional
from ncgear.design.keys.pitch_shapes import (
    BSpline,
    DrawnPoints,
    DxfContour,
    PictureContour,
    SvgContour,
    drawn_points,
)

if TYPE_CHECKING:
    from ncgear.numerics.arrays import Array

MATE_SHAPES = ("points", "b_spline", "dxf", "svg", "picture")


class MateOutline(Model):
    """An outline that the mate follows; it is drawn as seen from the same side as the first outline."""

    RULES = (f"one of {' '.join(MATE_SHAPES)}",)

    points: DrawnPoints | None = optional("points of the outline in the plane")
    b_spline: BSpline | None = optional("a closed B-spline by its control points")
    dxf: DxfContour | None = optional("a closed contour of a DXF file")
    svg: SvgContour | None = optional("a closed contour of an SVG file")
    picture: PictureContour | None = optional("the outline of a silhouette in a picture")
    weight: float = optional(
        "the mate's share in the mean of the squared distances of both gears, or in the greater of both greatest "
        "distances; 0.5: both alike",
        0.5,
        ge=0.05,
        le=0.95,
    )
    axis: Literal["free", "fixed"] = optional(
        "free: the mate's axis is where the curve comes nearest; fixed: it stays where the drawing has it", "free"
    )
    size: Literal["free", "fixed"] = optional(
        "free: the mate's drawing grows or shrinks to a size that rolls with the other one; fixed: it is as drawn",
        "free",
    )

    def _faults(self) -> Faults:
        if self.points is not None and not self.points.in_plane:
            yield fault("points", "given in polar form; points in the plane, x_mm and y_mm, are right")

    def outline_mm(self) -> tuple[Array, Array, str]:
        """Points of the outline, shape (n, 2), the axis in it, shape (2,), and the key that draws it.

        Raises WrongInput where a file has no closed contour.
        """
        import numpy as np

        drawn = self.points or self.b_spline or self.dxf or self.svg or self.picture
        assert drawn is not None
        key = f"outline.mate.{given(self, MATE_SHAPES)[0]}"
        return drawn_points(drawn, key), np.array(drawn.axis_mm), key


class FollowedOutline(Model):
    """Limits of the curve near an outline, and the measure of nearness."""

    axis: Literal["free", "fixed"] = optional(
        "free: the axis is where the curve comes nearest to the outline; fixed: it stays where the outline has it",
        "free",
    )
    pressure_angle_deg: float = optional(
        "greatest pressure angle in degrees with the rack's angle; beyond 60 friction may lock the pair",
        75.0,
        gt=40.0,
        lt=85.0,
    )
    criterion: Literal["root_mean_square", "greatest"] = optional(
        "root_mean_square: the least root of the mean square of the distances between outline and curve; greatest: "
        "the least greatest distance",
        "root_mean_square",
    )
    mate: MateOutline | None = optional(
        "an outline for the mate as well; left out: the mate has the shape that rolls with the first one"
    )
