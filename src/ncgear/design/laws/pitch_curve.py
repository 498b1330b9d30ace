"""The law ``pitch_curve``: the pitch curve of one gear is given, and its mate follows."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any, ClassVar, Literal

from ncgear.design.keys import pitch_shapes
from ncgear.design.keys.base import FORMULA, Expression, Faults, Length, angle, fault, given, optional
from ncgear.design.laws.base import Begins, LawKeys
from ncgear.design.words import listed
from ncgear.errors import WrongInput

if TYPE_CHECKING:
    from ncgear.mechanisms.mechanism import Mechanism
    from ncgear.numerics.arrays import Array
    from ncgear.ratio.laws.closed_curve import ClosedCurve
    from ncgear.ratio.laws.pitch_curve import ShapeSearch
    from ncgear.ratio.transmission import Law, Lobes

PER_STRETCH, DIGITS = 720, 7
"""Points of each stretch of a curve as an outline, and decimals of a millimetre in a fitted curve."""

SHAPES = (
    "expression_mm",
    "points",
    "b_spline",
    "dxf",
    "svg",
    "picture",
    "ellipse",
    "modified_ellipse",
    "rounded_polygon",
)


class PitchCurve(LawKeys):
    """The pitch curve of one gear, by a formula, points, a drawing or a named shape; the mate rolls on it."""

    CHOICE = "the pitch curve of one gear, whose mate follows"
    BEGINS = Begins.SHAPE
    EXAMPLES: ClassVar[dict[str, str]] = {
        "expression_mm": '"30 + 4*cos(phi)"',
        "points": "{file: points.csv, tolerance_mm: 0.05}",
        "b_spline": "{x_mm: [30, 0, -30, 0], y_mm: [0, 20, 0, -20]}",
        "dxf": "{file: contour.dxf, unit: mm}",
        "svg": "{file: contour.svg}",
        "picture": "{file: silhouette.png, width_mm: 60, tolerance_mm: 0.1}",
        "modified_ellipse": "{semi_latus_rectum_mm: 30, eccentricity: 0.3, modification: 1.2}",
        "rounded_polygon": "{sides: 4, side_mm: 130, corner_radius_mm: 25}",
    }
    NARROWER_RATIO = "bring the axis nearer to the middle of the curve, or make the curve rounder"
    RULES = (f"one of {' '.join(SHAPES)}",)

    gear: Literal["driving", "driven"] = optional("the gear whose pitch curve is given", "driving")
    expression_mm: Expression | None = optional(
        "radius in mm where the curve faces the mate, as a formula of phi (= the angle in rad, 0 to 2 pi, "
        f'by which the gear has turned): "30 + 4*cos(phi)", {FORMULA}; it may not jump; where its slope does, gears '
        "cannot be made"
    )
    points: pitch_shapes.DrawnPoints | None = optional("points of the curve, through which it is smoothed")
    b_spline: pitch_shapes.BSpline | None = optional("a closed B-spline by its control points")
    dxf: pitch_shapes.DxfContour | None = optional("a closed contour of a DXF file")
    svg: pitch_shapes.SvgContour | None = optional("a closed contour of an SVG file")
    picture: pitch_shapes.PictureContour | None = optional("the outline of a silhouette in a picture")
    ellipse: pitch_shapes.OffsetEllipse | None = optional("an ellipse that turns about any point inside")
    modified_ellipse: pitch_shapes.ModifiedEllipse | None = optional(
        "an ellipse about its focus, its relatives of several lobes, and modified ones"
    )
    rounded_polygon: pitch_shapes.RoundedPolygon | None = optional("a regular polygon with rounded corners")
    solve_for: Literal[
        "center_distance", "scale", "semi_major", "semi_minor", "eccentricity", "side", "corner_radius"
    ] = optional(
        "what makes the mate close, its own key left out: center_distance; scale (the whole curve grows or shrinks to "
        "center_distance_mm or, where that is left out, to the size of gears); semi_major or semi_minor of an "
        "ellipse; eccentricity of a modified_ellipse; side or corner_radius of a rounded_polygon",
        "center_distance",
    )
    center_distance_mm: Length | None = optional(
        "distance of the axes in mm; left out where solve_for is center_distance, or where the gears' size gives it"
    )
    phase: float = angle("angle {unit} that the gear has turned when phi = 0, or +x of a drawn curve, faces the mate")

    @property
    def contour(self) -> pitch_shapes.DrawnContour | None:
        """The contour of a drawing or a picture."""
        return self.dxf or self.svg or self.picture

    @property
    def solves_shape(self) -> bool:
        """Always, except when the centre distance or the scale is found."""
        return bool(self._found_key)

    @property
    def gives_outline(self) -> bool:
        """Every shape is an outline."""
        return True

    def outline_mm(self) -> tuple[Array, Array, str]:
        """Points of the drawn shape, its axis, and its key; raises WrongInput for a shape that is to be found."""
        import numpy as np

        key = f"{pitch_shapes.KEY}.{given(self, SHAPES)[0]}"
        if self._found_key:
            raise WrongInput(
                f"{self.solve_for} given; a fit needs a shape that is known: center_distance or scale is right",
                key=f"{pitch_shapes.KEY}.solve_for",
            )
        in_plane = self.points if self.points is not None and self.points.in_plane else None
        if (drawn := self.contour or self.b_spline or in_plane) is not None:
            return pitch_shapes.drawn_points(drawn, key), np.array(drawn.axis_mm), key
        if self.points is not None:
            angle, radius = self.points.polar()
        else:
            curve_of, _, _ = self._curves(key, 1)
            shares = np.linspace(0.0, 1.0, PER_STRETCH, endpoint=False)
            polar = [part.polar(part.start + shares * (part.end - part.start), 0) for part in curve_of(1.0).stretches]
            angle, radius = (np.concatenate([jet[k].value for jet in polar]) for k in (0, 1))
        # The angle of a formula is the turn of the gear: a driving gear is drawn by its negative.
        turned = -angle if not self._is_drawn and self.gear == "driving" else angle
        return np.column_stack([radius * np.cos(turned), radius * np.sin(turned)]), np.zeros(2), key

    def along(self, control_mm: Array, axis_mm: Array) -> dict[str, Any]:
        """The law of a B-spline in place of the shape; every other key stays."""
        kept = self.model_dump(by_alias=True, exclude_unset=True, exclude=set(SHAPES))
        x, y = (column.round(DIGITS).tolist() for column in control_mm.T)
        axis = {"axis_x_mm": float(axis_mm[0].round(DIGITS)), "axis_y_mm": float(axis_mm[1].round(DIGITS))}
        return {**kept, "b_spline": {"x_mm": x, "y_mm": y, "degree": pitch_shapes.HIGHEST_DEGREE, **axis}}

    @property
    def _is_drawn(self) -> bool:
        """Whether the shape is drawn in the plane, rather than given by the angle that its gear has turned."""
        by_angle = self.expression_mm is not None or self.modified_ellipse is not None
        return not by_angle and not (self.points is not None and not self.points.in_plane)

    @property
    def gives_center_distance(self) -> bool:
        """Always, except for a curve whose form alone is given."""
        return self.solve_for != "scale" or self.center_distance_mm is not None

    @property
    def _shape(self) -> pitch_shapes.Solvable | None:
        return self.ellipse or self.modified_ellipse or self.rounded_polygon

    @property
    def _found_key(self) -> str:
        """The key of the shape's unknown value; empty if the centre distance or the scale is unknown."""
        return self._shape.solvable.get(self.solve_for, "") if self._shape else ""

    def _faults(self) -> Faults:
        shape, wanted = given(self, SHAPES)[0], self.solve_for
        solvable: Mapping[str, str] = self._shape.solvable if self._shape else {}
        if wanted not in ("center_distance", "scale", *solvable):
            names = listed(("center_distance", "scale", *solvable))
            yield fault("solve_for", f"{wanted} given, but {shape} has none; {names} is right")
        if wanted == "center_distance" and self.center_distance_mm is not None:
            yield fault("center_distance_mm", "given, but solve_for finds it; leave it out")
        if wanted not in ("center_distance", "scale") and self.center_distance_mm is None:
            yield fault("", "center_distance_mm is missing; only solve_for: center_distance or scale can do without it")
        for name, key in solvable.items():
            value = getattr(self._shape, key)
            if name == wanted and value is not None:
                yield fault(f"{shape}.{key}", f"{value:g} given, but solve_for finds it; leave it out")
            if name != wanted and value is None:
                yield fault(shape, f"{key} is missing; only solve_for: {name} can do without it")

    def law_on(self, linkage: Mechanism, lobes: Lobes, *, ring: bool = False) -> Law:
        """The law with its centre distance; the values found are facts."""
        from ncgear.ratio.laws.pitch_curve import GivenCurve, closed_law
        from ncgear.ratio.transmission import Law, single

        key = f"{pitch_shapes.KEY}.{given(self, SHAPES)[0]}"
        repeats = (lobes.driving, lobes.driven) if self.gear == "driving" else (lobes.driven, lobes.driving)
        curve_of, range_, facts = self._curves(key, repeats[0])
        asked = GivenCurve(curve_of, range_, self._is_drawn, self.gear == "driven", self.phase, key, internal=ring)
        closed = closed_law(asked, lobes, self.center_distance_mm)
        if not self.gives_center_distance:
            return Law(linkage, single(closed.transmission), facts=facts)
        found = {} if self.solve_for == "center_distance" else {self._found_key or self.solve_for: closed.value}
        sizes = {"center_distance_mm": closed.center_distance_mm, **found}
        return Law(linkage, single(closed.transmission), None, closed.center_distance_mm, {**sizes, **facts})

    def _curves(
        self, key: str, repeats: int
    ) -> tuple[Callable[[float], ClosedCurve], ShapeSearch | None, dict[str, float]]:
        """The curve by the unknown value, the range of this value, and facts; otherwise one curve for every value."""
        import numpy as np

        from ncgear.ratio.laws import curve_shapes as shapes

        if self._found_key and self._shape:
            shape, name = self._shape, self._found_key
            assert self.center_distance_mm is not None
            where = shape.search(self.solve_for, self.center_distance_mm)
            return lambda value: shape.model_copy(update={name: value}).curve(key), where, {}
        facts: dict[str, float] = {}
        if self.expression_mm is not None:
            curve = shapes.formula_curve(self.expression_mm, key)
        elif self.points is not None:
            angle, radius = self.points.polar()
            curve, missed = shapes.smoothed_points(angle, radius, self.points.tolerance_mm, repeats, key)
            facts = {"points_missed_by_mm": missed}
        elif self.b_spline is not None:
            spline = self.b_spline
            points = np.column_stack([np.array(spline.x_mm), np.array(spline.y_mm)])
            curve = shapes.closed_b_spline(points, spline.degree, spline.axis_mm, key)
        elif (contour := self.contour) is not None:
            from ncgear.ratio.laws.contours import points_along

            joined = contour.chain(f"{key}.file")
            along = points_along(joined.parts)
            shapes.require_round(along, contour.axis_mm, key)
            width, height = np.ptp(along, axis=0).tolist()
            facts = {"contour_gap_mm": joined.gap_mm, "contour_doubled_mm": joined.doubled_mm}
            facts |= {"contour_width_mm": width, "contour_height_mm": height}
            if contour.tolerance_mm is None:
                curve = shapes.chain(joined.parts, contour.axis_mm, key)
            else:
                polar = shapes.polar_points(along - np.array(contour.axis_mm), contour.tolerance_mm, key)
                curve, missed = shapes.smoothed_points(*polar, contour.tolerance_mm, repeats, key)
                facts["points_missed_by_mm"] = missed
        else:
            assert self._shape is not None
            curve = self._shape.curve(key)
        return lambda _: curve, None, facts
