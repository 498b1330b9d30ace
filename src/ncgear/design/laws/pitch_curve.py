"""The law ``pitch_curve``: the pitch curve of one gear is given, and its mate follows."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from math import cos, hypot, inf, pi, sqrt, tan
from typing import TYPE_CHECKING, Annotated, Literal, Self

from pydantic import Field, Strict, model_validator

from ncgear.design.keys.base import (
    FORMULA,
    LONGEST_MM,
    Expression,
    Length,
    Model,
    Numbers,
    allow_one,
    angle_rad,
    fault,
    given,
    in_rad,
    listed,
    require_one,
    spellings,
)
from ncgear.design.laws.base import DesignLaw, LawKeys

if TYPE_CHECKING:
    from ncgear.mechanisms.mechanism import Mechanism
    from ncgear.numerics.arrays import Array
    from ncgear.numerics.rational import RationalSpline
    from ncgear.ratio.laws.closed_curve import ClosedCurve
    from ncgear.ratio.laws.pitch_curve import Search
    from ncgear.ratio.transmission import Law, Lobes

MOST_POINTS = 20_000
FEWEST_POINTS = 6
MOST_CONTROL_POINTS = 500
MOST_SIDES = 100
HIGHEST_DEGREE = 5
MOST_CURVES = 2000
HIGHEST_DXF_DEGREE = 11
FLATTEST = 1e-3
"""Least semi axis that is sought, as a share of the other one: no gear turns with a flatter one."""
INSIDE = 1.01
"""What a size that is sought must be over, as a multiple of that at which the curve comes to its axis."""

POLAR_COLUMNS = spellings("phi")
ANGLE_OR_X = (*POLAR_COLUMNS, "x_mm")
RADIUS_OR_Y = ("radius_mm", "y_mm")

PointColumn = Annotated[Numbers, Field(min_length=FEWEST_POINTS, max_length=MOST_POINTS)]
ControlColumn = Annotated[Numbers, Field(min_length=3, max_length=MOST_CONTROL_POINTS)]
Place = Annotated[float, Field(ge=-LONGEST_MM, le=LONGEST_MM)]

UNIT_MM = {"mm": 1.0, "cm": 10.0, "m": 1000.0, "inch": 25.4}

KEY = "motion"


class Shape(Model):
    """A shape of a pitch curve; ``solvable`` are the quantities that can be found, each with its key."""

    @property
    def solvable(self) -> Mapping[str, str]:
        """By the value of ``solve_for`` the key that is left out."""
        return {}

    def search(self, wanted: str, center_distance_mm: float) -> Search:
        """Where the value of a quantity is sought; raises NoSuchMechanism where there is no place for one."""
        raise NotImplementedError(wanted)


class Drawn(Shape):
    """A curve drawn in the plane, and the point about which it turns."""

    axis_x_mm: Place = Field(default=0.0, description="x of the gear's axis in the drawing, in mm")
    axis_y_mm: Place = Field(default=0.0, description="y of the gear's axis in the drawing, in mm")

    @property
    def axis_mm(self) -> tuple[float, float]:
        """The gear's axis in the drawing."""
        return self.axis_x_mm, self.axis_y_mm


class CurvePoints(Drawn):
    """Points of the curve, in polar form or in the plane, in the order in which they follow each other."""

    phi_rad: PointColumn | None = Field(
        default=None, description="angles in rad by which the gear has turned when its point faces the mate"
    )
    phi_deg: PointColumn | None = Field(
        default=None, description="angles in degrees by which the gear has turned when its point faces the mate"
    )
    phi_pi: PointColumn | None = Field(
        default=None,
        description="angles in multiples of pi by which the gear has turned when its point faces the mate",
    )
    radius_mm: PointColumn | None = Field(default=None, description="radii in mm, one for each angle")
    x_mm: PointColumn | None = Field(default=None, description="x of points of the drawn curve in mm, with y_mm")
    y_mm: PointColumn | None = Field(default=None, description="y of points of the drawn curve in mm")
    file: str | None = Field(
        default=None,
        min_length=1,
        description="CSV file with the columns instead, its header naming them; its path counts from the design file",
    )
    tolerance_mm: float = Field(
        gt=0.0, le=100.0, description="how far the smooth curve may be from a point in mm, along its radius"
    )

    @model_validator(mode="after")
    def _columns(self) -> Self:
        require_one(self, ANGLE_OR_X)
        first = given(self, ANGLE_OR_X)[0]
        second, other = RADIUS_OR_Y if first != "x_mm" else RADIUS_OR_Y[::-1]
        if getattr(self, other) is not None:
            raise fault(other, f"given, but {first} goes with {second}")
        if getattr(self, second) is None:
            raise fault("", f"{second} is missing; {first} needs it")
        counts = len(getattr(self, first)), len(getattr(self, second))
        if counts[0] != counts[1]:
            raise fault(second, f"{counts[1]} values, but {first} has {counts[0]}; as many are right")
        if first != "x_mm" and self.axis_mm != (0.0, 0.0):
            raise fault("axis_x_mm", "given, but points in polar form have their axis at the pole; leave it out")
        for i, radius in enumerate(self.radius_mm or ()):
            if not radius > 0.0:
                raise fault(f"radius_mm.{i}", f"{radius:g} mm given; a radius over 0 is right")
        return self

    @property
    def in_plane(self) -> bool:
        """Whether the points are drawn in the plane."""
        return self.x_mm is not None

    def polar(self) -> tuple[Array, Array]:
        """Angle in rad and radius in mm of each point, of drawn ones about the axis; raises NoSuchMechanism."""
        import numpy as np

        if not self.in_plane:
            name = given(self, POLAR_COLUMNS)[0]
            angles = [in_rad(value, name.removeprefix("phi_")) for value in getattr(self, name)]
            return np.array(angles), np.array(self.radius_mm)
        from ncgear.ratio.laws.curve_shapes import polar_points

        points = np.column_stack([np.array(self.x_mm), np.array(self.y_mm)])
        return polar_points(points - np.array(self.axis_mm), f"{KEY}.points")


class BSpline(Drawn):
    """A closed uniform B-spline."""

    x_mm: ControlColumn = Field(description="x of the control points in mm, around the curve")
    y_mm: ControlColumn = Field(description="y of the control points in mm")
    degree: int = Field(
        default=3, ge=2, le=HIGHEST_DEGREE, description="degree; with 2 the curvature jumps, from 3 on it does not"
    )

    @model_validator(mode="after")
    def _enough_points(self) -> Self:
        if len(self.x_mm) != len(self.y_mm):
            raise fault("y_mm", f"{len(self.y_mm)} values, but x_mm has {len(self.x_mm)}; as many are right")
        if len(self.x_mm) <= self.degree:
            problem = f"{len(self.x_mm)} control points for degree {self.degree}; {self.degree + 1} or more are right"
            raise fault("x_mm", problem)
        return self


class RationalCurve(Model):
    """A line, an arc or a spline of a contour, as a rational B-spline in the unit of the drawing."""

    degree: int = Field(ge=1, le=HIGHEST_DXF_DEGREE, description="degree")
    knots: Numbers = Field(description="knots, rising")
    x: Numbers = Field(description="x of the control points")
    y: Numbers = Field(description="y of the control points")
    weights: Numbers = Field(description="weights of the control points")

    @model_validator(mode="after")
    def _whole(self) -> Self:
        count = len(self.x)
        if not (len(self.y) == len(self.weights) == count and len(self.knots) == count + self.degree + 1):
            raise fault("knots", f"{count} control points need as many weights, and {count + self.degree + 1} knots")
        if count <= self.degree or any(b < a for a, b in zip(self.knots, self.knots[1:], strict=False)):
            raise fault("knots", "must rise, and there must be more control points than the degree")
        if not self.knots[self.degree] < self.knots[-self.degree - 1]:
            raise fault("knots", "the curve has no length")
        if min(self.weights) <= 0.0:
            raise fault("weights", "must be over 0")
        return self


class DxfContour(Drawn):
    """A contour of a DXF file: lines, arcs and splines that make one closed curve."""

    file: str | None = Field(
        default=None,
        min_length=1,
        description="DXF file with one closed contour of LINE, ARC, CIRCLE, ELLIPSE, SPLINE, LWPOLYLINE or POLYLINE; "
        "its path counts from the design file",
    )
    unit: Literal["mm", "cm", "m", "inch"] = Field(description="unit of the drawing")
    layer: str | None = Field(
        default=None, min_length=1, max_length=255, description="layer of the contour; left out: all layers"
    )
    curves: Annotated[tuple[RationalCurve, ...], Strict(False), Field(min_length=1, max_length=MOST_CURVES)] | None = (
        Field(
            default=None, description="the contour's parts, read from the file; given in place of it by programs only"
        )
    )

    @model_validator(mode="after")
    def _has_curves(self) -> Self:
        if self.curves is None:
            raise fault("", "file is missing; the name of a DXF file is needed")
        return self

    def contour(self) -> list[RationalSpline]:
        """The parts as one closed chain, in mm; raises WrongInput where they are not one."""
        import numpy as np

        from ncgear.numerics.rational import RationalSpline
        from ncgear.ratio.laws.curve_shapes import one_contour

        scale = UNIT_MM[self.unit]
        parts = [
            RationalSpline(
                part.degree,
                np.array(part.knots),
                scale * np.column_stack([np.array(part.x), np.array(part.y)]),
                np.array(part.weights),
            ).clamped()
            for part in self.curves or ()
        ]
        return one_contour(parts, f"{KEY}.dxf.file")


class OffsetEllipse(Drawn):
    """An ellipse about its centre, with the axis at any point inside."""

    semi_major_mm: Length | None = Field(default=None, description="semi axis along x in mm; left out to be found")
    semi_minor_mm: Length | None = Field(default=None, description="semi axis along y in mm; left out to be found")

    @property
    def solvable(self) -> Mapping[str, str]:
        """Either semi axis."""
        return {"semi_major": "semi_major_mm", "semi_minor": "semi_minor_mm"}

    def search(self, wanted: str, center_distance_mm: float) -> Search:
        """From where the ellipse comes to its axis to the centre distance."""
        x, y = self.axis_mm
        minor = wanted == "semi_minor"
        known = self.semi_major_mm if minor else self.semi_minor_mm
        assert known is not None
        along, across = (x, y) if minor else (y, x)
        least = abs(across) / sqrt(1.0 - (along / known) ** 2) if abs(along) < known else inf
        return search(max(FLATTEST * known, INSIDE * least), center_distance_mm, f"ellipse.{self.solvable[wanted]}")

    def curve(self, key: str) -> ClosedCurve:
        """The ellipse."""
        from ncgear.ratio.laws.curve_shapes import ellipse

        assert self.semi_major_mm is not None
        assert self.semi_minor_mm is not None
        return ellipse(self.semi_major_mm, self.semi_minor_mm, self.axis_mm, key)


class ModifiedEllipse(Shape):
    """Lobes of r = p / (1 + e cos(n m phi)), the least radius at phi = 0."""

    semi_latus_rectum_mm: Length = Field(
        description="p in mm, of r = p/(1 + e cos(n m phi)): the radius where the cosine is zero"
    )
    eccentricity: float | None = Field(default=None, ge=0.0, lt=1.0, description="e, from 0 (a circle) to under 1")
    lobes: int = Field(default=1, ge=1, le=100, description="n, how often the curve repeats in a turn")
    modification: float = Field(
        default=1.0,
        gt=0.5,
        le=100.0,
        description="m up to a lobe's greatest radius, over 0.5; after it m/(2 m - 1), so that the lobe is filled. 1: "
        "both alike, an ellipse about its focus where n is 1",
    )

    @property
    def solvable(self) -> Mapping[str, str]:
        """The eccentricity."""
        return {"eccentricity": "eccentricity"}

    def search(self, wanted: str, center_distance_mm: float) -> Search:
        """From a circle to where the greatest radius is the centre distance."""
        high = 1.0 - self.semi_latus_rectum_mm / center_distance_mm
        return search(0.0, high, "modified_ellipse.eccentricity", "")

    def curve(self, key: str) -> ClosedCurve:
        """The curve."""
        from ncgear.ratio.laws.curve_shapes import modified_ellipse

        assert self.eccentricity is not None
        return modified_ellipse(self.semi_latus_rectum_mm, self.eccentricity, self.lobes, self.modification)


class RoundedPolygon(Drawn):
    """A regular polygon about its centre, a side at +x, its corners rounded."""

    sides: int = Field(ge=3, le=MOST_SIDES, description="number of sides")
    side_mm: Length | None = Field(
        default=None, description="side of the sharp polygon in mm, before rounding; left out to be found"
    )
    corner_radius_mm: float | None = Field(
        default=None, ge=0.0, le=LONGEST_MM, description="radius of the rounded corners in mm; left out to be found"
    )

    @property
    def _half_angle(self) -> float:
        return pi / self.sides

    @model_validator(mode="after")
    def _corners_fit(self) -> Self:
        if self.side_mm is not None and self.corner_radius_mm is not None:
            most = self.side_mm / 2.0 / tan(self._half_angle)
            if self.corner_radius_mm > most:
                problem = (
                    f"{self.corner_radius_mm:g} mm is more than the circle in the polygon; up to {most:.6g} is right"
                )
                raise fault("corner_radius_mm", problem)
        return self

    @property
    def solvable(self) -> Mapping[str, str]:
        """The side or the radius of the corners."""
        return {"side": "side_mm", "corner_radius": "corner_radius_mm"}

    def search(self, wanted: str, center_distance_mm: float) -> Search:
        """A side between the circle of the corners and the centre distance, or corners from sharp to round."""
        slope, key = 2.0 * tan(self._half_angle), f"rounded_polygon.{self.solvable[wanted]}"
        if wanted == "corner_radius":
            assert self.side_mm is not None
            return search(0.0, self.side_mm / slope, key)
        assert self.corner_radius_mm is not None
        least = max(self.corner_radius_mm, INSIDE * hypot(*self.axis_mm) / cos(self._half_angle))
        return search(slope * max(least, FLATTEST * center_distance_mm), slope * center_distance_mm, key)

    def curve(self, key: str) -> ClosedCurve:
        """The polygon."""
        from ncgear.ratio.laws.curve_shapes import rounded_polygon

        assert self.side_mm is not None
        assert self.corner_radius_mm is not None
        return rounded_polygon(self.sides, self.side_mm, self.corner_radius_mm, self.axis_mm, key)


Solvable = OffsetEllipse | ModifiedEllipse | RoundedPolygon
"""Shapes of which one quantity can be found."""


def search(low: float, high: float, key: str, unit: str = " mm") -> Search:
    """The range of a quantity; raises NoSuchMechanism where it is empty."""
    from ncgear.errors import NoSuchMechanism
    from ncgear.ratio.laws.pitch_curve import Search

    if not low < high:
        raise NoSuchMechanism(
            "no value makes a curve that goes round its axis and stays below the centre distance; move the axis, or "
            "give a greater center_distance_mm",
            key=f"{KEY}.{key}",
        )
    return Search(low, high, f"{KEY}.{key}", unit)


SHAPES = ("expression_mm", "points", "b_spline", "dxf", "ellipse", "modified_ellipse", "rounded_polygon")


class PitchCurve(LawKeys):
    """The pitch curve of one gear, by a formula, points, a drawing or a named shape; the mate rolls on it."""

    law: Literal["pitch_curve"] = Field(description="the name of this law: pitch_curve")
    gear: Literal["driving", "driven"] = Field(default="driving", description="the gear whose pitch curve is given")
    expression_mm: Expression | None = Field(
        default=None,
        description="radius in mm where the curve faces the mate, as a formula of phi (= the angle in rad, 0 to 2 pi, "
        f'by which the gear has turned): "30 + 4*cos(phi)", {FORMULA}; it may not jump; where its slope does, gears '
        "cannot be made",
    )
    points: CurvePoints | None = Field(default=None, description="points of the curve, through which it is smoothed")
    b_spline: BSpline | None = Field(default=None, description="a closed B-spline by its control points")
    dxf: DxfContour | None = Field(default=None, description="a closed contour of a DXF file")
    ellipse: OffsetEllipse | None = Field(default=None, description="an ellipse that turns about any point inside")
    modified_ellipse: ModifiedEllipse | None = Field(
        default=None, description="an ellipse about its focus, its relatives of several lobes, and modified ones"
    )
    rounded_polygon: RoundedPolygon | None = Field(default=None, description="a regular polygon with rounded corners")
    solve_for: Literal[
        "center_distance", "scale", "semi_major", "semi_minor", "eccentricity", "side", "corner_radius"
    ] = Field(
        default="center_distance",
        description="what makes the mate close, its own key left out: center_distance; scale (the whole curve grows or "
        "shrinks to center_distance_mm or, where that is left out, to the size of gears); semi_major or "
        "semi_minor of an ellipse; eccentricity of a modified_ellipse; side or corner_radius of a rounded_polygon",
    )
    center_distance_mm: Length | None = Field(
        default=None,
        description="distance of the axes in mm; left out where solve_for is center_distance, or where the gears' size "
        "gives it",
    )
    phase_rad: float | None = Field(
        default=None,
        description="angle in rad that the gear has turned when phi = 0, or +x of a drawn curve, faces the mate",
    )
    phase_deg: float | None = Field(
        default=None,
        description="angle in degrees that the gear has turned when phi = 0, or +x of a drawn curve, faces the mate",
    )
    phase_pi: float | None = Field(
        default=None,
        description="angle in multiples of pi that the gear has turned when phi = 0, or +x of a drawn curve, faces the "
        "mate",
    )

    @property
    def gives_pitch_curve(self) -> bool:
        """The mate is found beside the curve, not about it."""
        return True

    @property
    def gives_center_distance(self) -> bool:
        """Always, but for a curve of which only the form is given."""
        return self.solve_for != "scale" or self.center_distance_mm is not None

    @property
    def _shape(self) -> Solvable | None:
        return self.ellipse or self.modified_ellipse or self.rounded_polygon

    @property
    def _found_key(self) -> str:
        """The key of the shape whose value is found; empty for the centre distance and the scale."""
        return self._shape.solvable.get(self.solve_for, "") if self._shape else ""

    @model_validator(mode="after")
    def _one_shape(self) -> Self:
        require_one(self, SHAPES)
        allow_one(self, spellings("phase"))
        return self

    @model_validator(mode="after")
    def _one_unknown(self) -> Self:
        shape, wanted = given(self, SHAPES)[0], self.solve_for
        solvable: Mapping[str, str] = self._shape.solvable if self._shape else {}
        if wanted not in ("center_distance", "scale", *solvable):
            names = listed(("center_distance", "scale", *solvable))
            raise fault("solve_for", f"{wanted} given, but {shape} has none; {names} is right")
        if wanted == "center_distance" and self.center_distance_mm is not None:
            raise fault("center_distance_mm", "given, but it is what solve_for finds; leave it out")
        if wanted not in ("center_distance", "scale") and self.center_distance_mm is None:
            raise fault("", "center_distance_mm is missing; only solve_for: center_distance or scale can do without it")
        for name, key in solvable.items():
            value = getattr(self._shape, key)
            if name == wanted and value is not None:
                raise fault(f"{shape}.{key}", f"{value:g} given, but it is what solve_for finds; leave it out")
            if name != wanted and value is None:
                raise fault(shape, f"{key} is missing; only solve_for: {name} can do without it")
        return self

    def law_on(self, linkage: Mechanism, lobes: Lobes) -> Law:
        """The law with its centre distance, and what was found as facts."""
        from ncgear.ratio.laws.pitch_curve import GivenCurve, closed_law
        from ncgear.ratio.transmission import Law, single

        key = f"{KEY}.{given(self, SHAPES)[0]}"
        repeats = (lobes.driving, lobes.driven) if self.gear == "driving" else (lobes.driven, lobes.driving)
        curve_of, range_, facts = self._curves(key, repeats[0])
        drawn = (
            self.expression_mm is None
            and self.modified_ellipse is None
            and not (self.points and not self.points.in_plane)
        )
        asked = GivenCurve(curve_of, range_, drawn=drawn, driven=self.gear == "driven", phase_rad=self._phase, key=key)
        closed = closed_law(asked, lobes, self.center_distance_mm)
        if not self.gives_center_distance:
            return Law(linkage, single(closed.transmission), facts=facts)
        found = {} if self.solve_for == "center_distance" else {self._found_name: closed.value}
        sizes = {"center_distance_mm": closed.center_distance_mm, **found}
        return Law(linkage, single(closed.transmission), None, closed.center_distance_mm, {**sizes, **facts})

    @property
    def _found_name(self) -> str:
        return self._found_key or self.solve_for

    @property
    def _phase(self) -> float:
        return angle_rad(self, "phase")

    def _curves(self, key: str, repeats: int) -> tuple[Callable[[float], ClosedCurve], Search | None, dict[str, float]]:
        """The curve by the value that is found, the range of that value, and facts; else a curve of every value."""
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
        elif self.dxf is not None:
            curve = shapes.chain(self.dxf.contour(), self.dxf.axis_mm, key)
        else:
            assert self._shape is not None
            curve = self._shape.curve(key)
        return lambda _: curve, None, facts


LAW = DesignLaw(
    keys=PitchCurve,
    choice="the pitch curve of one gear, whose mate follows",
    template="""\
motion:                    # the pitch curve of the driving gear; its mate follows
  law: pitch_curve
  ellipse:                 # or expression_mm, points, b_spline, dxf, modified_ellipse, rounded_polygon
    semi_major_mm: 23
    semi_minor_mm: 16.44
    axis_x_mm: 4           # the ellipse turns about this point, counted from its centre
    axis_y_mm: -4
  solve_for: scale         # the curve grows to the size of the gears; or center_distance, semi_minor, ...
  # center_distance_mm: 40 # the curve grows to this distance of the axes; teeth or module_mm is then left out below
  # gear: driven           # the driven gear has the curve; left out: the driving gear
""",
    examples={
        "expression_mm": '"30 + 4*cos(phi)"',
        "points": "{file: points.csv, tolerance_mm: 0.05}",
        "b_spline": "{x_mm: [30, 0, -30, 0], y_mm: [0, 20, 0, -20]}",
        "dxf": "{file: contour.dxf, unit: mm}",
        "modified_ellipse": "{semi_latus_rectum_mm: 30, eccentricity: 0.3, modification: 1.2}",
        "rounded_polygon": "{sides: 4, side_mm: 130, corner_radius_mm: 25}",
    },
    narrower_ratio="bring the axis nearer to the middle of the curve, or make the curve rounder",
)
