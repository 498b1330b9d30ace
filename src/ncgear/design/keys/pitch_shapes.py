"""The keys of shapes of pitch curves: points, a B-spline, a contour of a DXF file, ellipses and rounded polygons."""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import suppress
from math import cos, hypot, inf, pi, sqrt, tan
from typing import TYPE_CHECKING, Annotated, ClassVar, Literal

from pydantic import Field

from ncgear.design.keys.base import (
    CSV_FILE,
    LONGEST_MM,
    Faults,
    FileName,
    Length,
    Model,
    Numbers,
    Place,
    Several,
    angle,
    fault,
    given,
    optional,
    required,
    unkept,
)
from ncgear.design.words import listed, spellings
from ncgear.errors import WrongInput
from ncgear.numerics.bounds import shown_below

if TYPE_CHECKING:
    from ncgear.numerics.arrays import Array
    from ncgear.numerics.rational import RationalSpline
    from ncgear.ratio.laws.closed_curve import ClosedCurve
    from ncgear.ratio.laws.contours import JoinedContour
    from ncgear.ratio.laws.pitch_curve import ShapeSearch

MOST_POINTS = 100_000
FEWEST_POINTS = 6
MOST_CONTROL_POINTS = 500
MOST_SIDES = 100
HIGHEST_DEGREE = 5
MOST_CURVES = 2000
HIGHEST_DXF_DEGREE = 11
FLATTEST = 1e-3
"""Least semi axis that is sought, as a share of the other semi axis: no gear turns with a flatter ellipse."""
INSIDE = 1.01
"""Factor by which a sought size must exceed the size at which the curve comes to its axis."""

POLAR_COLUMNS = spellings("phi")
ANGLE_OR_X = (*POLAR_COLUMNS, "x_mm")
RADIUS_OR_Y = ("radius_mm", "y_mm")

PointColumn = Annotated[Numbers, Field(min_length=FEWEST_POINTS, max_length=MOST_POINTS)]
ControlColumn = Annotated[Numbers, Field(min_length=3, max_length=MOST_CONTROL_POINTS)]

UNIT_MM = {"mm": 1.0, "cm": 10.0, "m": 1000.0, "inch": 25.4}

KEY = "motion"


class Shape(Model):
    """A shape of a pitch curve; ``solvable`` names the quantities that can be found, each with its key."""

    @property
    def solvable(self) -> Mapping[str, str]:
        """The key that is left out, by the value of ``solve_for``."""
        return {}

    def search(self, wanted: str, center_distance_mm: float) -> ShapeSearch:
        """The range in which a quantity's value is sought; raises NoSuchMechanism if there is no such range."""
        raise NotImplementedError(wanted)


class Drawn(Shape):
    """A curve drawn in the plane, and the point about which it turns."""

    axis_x_mm: Place = optional("x of the gear's axis in the drawing, in mm", 0.0)
    axis_y_mm: Place = optional("y of the gear's axis in the drawing, in mm", 0.0)

    @property
    def axis_mm(self) -> tuple[float, float]:
        """The gear's axis in the drawing."""
        return self.axis_x_mm, self.axis_y_mm


class DrawnPoints(Drawn):
    """Points of the curve in their order along it, in polar form or in the plane."""

    RULES = (f"one of {' '.join(ANGLE_OR_X)}",)

    angles_rad: tuple[float, ...] = angle(
        "turns of the gear {unit} when each point faces the mate", "phi", of=PointColumn, absent=()
    )
    radius_mm: PointColumn | None = optional("radii in mm, one for each angle")
    x_mm: PointColumn | None = optional("x of points of the drawn curve in mm, with y_mm")
    y_mm: PointColumn | None = optional("y of points of the drawn curve in mm")
    file: FileName | None = optional(CSV_FILE.format("the"))
    tolerance_mm: float = required(
        "how far the smooth curve may be from a point in mm, along its radius", gt=0.0, le=100.0
    )

    def _faults(self) -> Faults:
        first = given(self, ANGLE_OR_X)[0]
        second, other = RADIUS_OR_Y if first != "x_mm" else RADIUS_OR_Y[::-1]
        if getattr(self, other) is not None:
            yield fault(other, f"given, but {first} goes with {second}")
        if getattr(self, second) is None:
            yield fault("", f"{second} is missing; {first} needs it")
        yield from unkept(self, f"{second} as many as {first}")
        if first != "x_mm" and self.axis_mm != (0.0, 0.0):
            yield fault("axis_x_mm", "given, but points in polar form have their axis at the pole; leave it out")
        for i, radius in enumerate(self.radius_mm or ()):
            if not radius > 0.0:
                yield fault(f"radius_mm.{i}", f"{radius:g} mm given; a radius over 0 is right")

    @property
    def in_plane(self) -> bool:
        """Whether the points are drawn in the plane."""
        return self.x_mm is not None

    def polar(self) -> tuple[Array, Array]:
        """Angle in rad and radius in mm of each point, for drawn points about the axis; raises NoSuchMechanism."""
        import numpy as np

        if not self.in_plane:
            return np.array(self.angles_rad), np.array(self.radius_mm)
        from ncgear.ratio.laws.curve_shapes import polar_points, require_round

        points = np.column_stack([np.array(self.x_mm), np.array(self.y_mm)])
        require_round(points, self.axis_mm, f"{KEY}.points")
        return polar_points(points - np.array(self.axis_mm), self.tolerance_mm, f"{KEY}.points")


class BSpline(Drawn):
    """A closed uniform B-spline."""

    RULES = ("y_mm as many as x_mm",)

    x_mm: ControlColumn = required("x of the control points in mm, around the curve")
    y_mm: ControlColumn = required("y of the control points in mm")
    degree: int = optional("degree; with 2 the curvature jumps, from 3 on it does not", 3, ge=2, le=HIGHEST_DEGREE)

    def _faults(self) -> Faults:
        if len(self.x_mm) <= self.degree:
            problem = f"{len(self.x_mm)} control points for degree {self.degree}; {self.degree + 1} or more are right"
            yield fault("x_mm", problem)


class RationalCurve(Model):
    """A line, an arc or a spline of a contour, as a rational B-spline in the unit of the drawing."""

    layer: str = optional("layer of the drawing", "")
    degree: int = required("degree", ge=1, le=HIGHEST_DXF_DEGREE)
    knots: Numbers = required("knots, rising")
    x: Numbers = required("x of the control points")
    y: Numbers = required("y of the control points")
    weights: Numbers = required("weights of the control points")

    def _faults(self) -> Faults:
        count = len(self.x)
        if not (len(self.y) == len(self.weights) == count and len(self.knots) == count + self.degree + 1):
            yield fault("knots", f"{count} control points need as many weights, and {count + self.degree + 1} knots")
        if count <= self.degree or any(b < a for a, b in zip(self.knots, self.knots[1:], strict=False)):
            yield fault("knots", "must rise, and there must be more control points than the degree")
        if not self.knots[self.degree] < self.knots[-self.degree - 1]:
            yield fault("knots", "the curve has no length")
        if min(self.weights) <= 0.0:
            yield fault("weights", "must be over 0")


class DrawnContour(Drawn):
    """A contour of a file: curves that make one closed curve."""

    tolerance_mm: float | None = optional(
        "greatest distance in mm of a smooth curve from the contour, along its radius: for a contour of many chords, "
        "such as a traced outline, as no teeth roll over corners; left out: the contour as it is drawn",
        gt=0.0,
        le=100.0,
    )
    curves: Annotated[Several[RationalCurve], Field(min_length=1, max_length=MOST_CURVES)] | None = optional(
        "the contour's parts, read from the file; given in place of it by programs only"
    )

    FILE: ClassVar[str]
    """The words for the file under the key ``file``."""

    def _faults(self) -> Faults:
        if self.curves is None:
            yield fault("", f"file is missing; the name of {self.FILE} is needed")

    @property
    def unit_mm(self) -> float:
        """The unit of the curves."""
        return 1.0

    @property
    def near_mm(self) -> float:
        """Greatest gap between the ends of parts that comes from the digits of the file, in mm."""
        return 0.0

    def chain(self, key: str) -> JoinedContour:
        """The parts as one closed chain.

        Raises WrongInput at the key of the file if they are not one chain; the message names the layers that hold one.
        """
        from ncgear.ratio.laws.contours import one_contour

        parts = self.curves or ()
        try:
            return one_contour([self._spline(part) for part in parts], self.near_mm, key)
        except WrongInput as refusal:
            layers = sorted({part.layer for part in parts})
            if len(layers) == 1:
                raise
            closed = list[str]()
            for layer in filter(None, layers):
                with suppress(WrongInput):
                    one_contour([self._spline(part) for part in parts if part.layer == layer], self.near_mm, key)
                    closed.append(layer)
            one = f"layers that hold one closed contour are {listed(closed, 'and')}" if closed else "no layer holds one"
            raise WrongInput(f"{refusal.problem}; {one}", key=key) from refusal

    def _spline(self, part: RationalCurve) -> RationalSpline:
        import numpy as np

        from ncgear.numerics.rational import RationalSpline

        points_mm = self.unit_mm * np.column_stack([np.array(part.x), np.array(part.y)])
        return RationalSpline(part.degree, np.array(part.knots), points_mm, np.array(part.weights)).clamped()


class DxfContour(DrawnContour):
    """A contour of a DXF file: lines, arcs and splines that make one closed curve."""

    file: FileName | None = optional(
        "DXF file with one closed contour of LINE, ARC, CIRCLE, ELLIPSE, SPLINE, LWPOLYLINE or POLYLINE; its path "
        "counts from the design file"
    )
    unit: Literal["mm", "cm", "m", "inch"] = required("unit of the drawing")
    layer: str | None = optional("layer of the contour; left out: all layers", min_length=1, max_length=255)
    near: float = optional(
        "how far ends of parts may miss each other, by the digits of the file; given by programs only", 0.0, ge=0.0
    )
    drawn_in: Literal["mm", "cm", "m", "inch"] | None = optional("the unit that the file names; given by programs only")

    FILE: ClassVar[str] = "a DXF file"

    @property
    def unit_mm(self) -> float:
        """The unit of the drawing."""
        return UNIT_MM[self.unit]

    @property
    def near_mm(self) -> float:
        """By the digits of the file."""
        return self.unit_mm * self.near


class SvgContour(DrawnContour):
    """A contour of an SVG file, in mm from the lower left corner of its page."""

    file: FileName | None = optional(
        "SVG file with one closed contour of paths, circles, ellipses or polygons; its path counts from the design file"
    )
    element: str | None = optional(
        "id of the contour's element, or id or label of its layer or group; left out: all elements",
        min_length=1,
        max_length=255,
    )
    holes: int = optional(
        "contours within the outer one of their element, which are left out; given by programs only", 0, ge=0
    )

    FILE: ClassVar[str] = "an SVG file"


class PictureContour(DrawnContour):
    """The outline of a silhouette, in mm from the middle of its box."""

    file: FileName | None = optional(
        "PNG or JPEG file with one silhouette, dark on light; its path counts from the design file"
    )
    width_mm: Length = required("width of the silhouette in mm")
    threshold: float = optional("brightness of the outline, 0 black and 1 white", 0.5, gt=0.0, lt=1.0)
    light: bool = optional("true: the silhouette is light on dark", False)
    tolerance_mm: float = required(
        "how far the smooth curve may be from the outline in mm, along its radius", gt=0.0, le=100.0
    )

    FILE: ClassVar[str] = "a picture"


def drawn_points(shape: DrawnContour | BSpline | DrawnPoints, key: str) -> Array:
    """Points along a shape as it is drawn, shape (n, 2); raises WrongInput if a file has no closed contour.

    Points must be given in the plane.
    """
    import numpy as np

    from ncgear.numerics.rational import closed_uniform
    from ncgear.ratio.laws.contours import points_along

    if isinstance(shape, DrawnContour):
        return points_along(shape.chain(f"{key}.file").parts)
    points = np.column_stack([np.array(shape.x_mm), np.array(shape.y_mm)])
    return points_along([closed_uniform(points, shape.degree).clamped()]) if isinstance(shape, BSpline) else points


class OffsetEllipse(Drawn):
    """An ellipse about its centre, with the axis at any point inside."""

    semi_major_mm: Length | None = optional("semi axis along x in mm; left out to be found")
    semi_minor_mm: Length | None = optional("semi axis along y in mm; left out to be found")

    @property
    def solvable(self) -> Mapping[str, str]:
        """Either semi axis."""
        return {"semi_major": "semi_major_mm", "semi_minor": "semi_minor_mm"}

    def search(self, wanted: str, center_distance_mm: float) -> ShapeSearch:
        """From the size at which the ellipse comes to its axis to the centre distance."""
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

    semi_latus_rectum_mm: Length = required(
        "p in mm, of r = p/(1 + e cos(n m phi)): the radius where the cosine is zero"
    )
    eccentricity: float | None = optional("e, from 0 (a circle) to under 1", ge=0.0, lt=1.0)
    lobes: int = optional("n, how often the curve repeats in a turn", 1, ge=1, le=100)
    modification: Annotated[float, Field(gt=0.5, le=100.0)] = optional(
        "m up to a lobe's greatest radius, over 0.5; after it m/(2 m - 1), so that the lobe is filled. 1: both alike, "
        "an ellipse about its focus where n is 1",
        1.0,
    )

    @property
    def solvable(self) -> Mapping[str, str]:
        """The eccentricity."""
        return {"eccentricity": "eccentricity"}

    def search(self, wanted: str, center_distance_mm: float) -> ShapeSearch:
        """From a circle to the eccentricity at which the greatest radius is the centre distance."""
        high = 1.0 - self.semi_latus_rectum_mm / center_distance_mm
        return search(0.0, high, "modified_ellipse.eccentricity", "")

    def curve(self, key: str) -> ClosedCurve:
        """The curve."""
        from ncgear.ratio.laws.curve_shapes import modified_ellipse

        assert self.eccentricity is not None
        return modified_ellipse(self.semi_latus_rectum_mm, self.eccentricity, self.lobes, self.modification)


class RoundedPolygon(Drawn):
    """A regular polygon about its centre, with a side at +x and rounded corners."""

    sides: int = required("number of sides", ge=3, le=MOST_SIDES)
    side_mm: Length | None = optional("side of the sharp polygon in mm, before rounding; left out to be found")
    corner_radius_mm: float | None = optional(
        "radius of the rounded corners in mm; left out to be found", ge=0.0, le=LONGEST_MM
    )

    @property
    def _half_angle(self) -> float:
        return pi / self.sides

    def _faults(self) -> Faults:
        if self.side_mm is not None and self.corner_radius_mm is not None:
            most = self.side_mm / 2.0 / tan(self._half_angle)
            if self.corner_radius_mm > most:
                right = f"up to {shown_below(most)} is right"
                problem = f"{self.corner_radius_mm:g} mm is more than the circle in the polygon; {right}"
                yield fault("corner_radius_mm", problem)

    @property
    def solvable(self) -> Mapping[str, str]:
        """The side or the radius of the corners."""
        return {"side": "side_mm", "corner_radius": "corner_radius_mm"}

    def search(self, wanted: str, center_distance_mm: float) -> ShapeSearch:
        """A side from the circle of the corners to the centre distance, or corners from sharp to round."""
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
"""Shapes that can have one unknown quantity."""


def search(low: float, high: float, key: str, unit: str = " mm") -> ShapeSearch:
    """The range of a quantity; raises NoSuchMechanism if it is empty."""
    from ncgear.errors import NoSuchMechanism
    from ncgear.ratio.laws.pitch_curve import ShapeSearch

    if not low < high:
        raise NoSuchMechanism(
            "no value makes a curve that goes round its axis and stays below the centre distance; move the axis, or "
            "give a greater center_distance_mm",
            key=f"{KEY}.{key}",
        )
    return ShapeSearch(low, high, f"{KEY}.{key}", unit)
