"""The keys of searches: a law for ``ncgear optimize``, a machine for ``ncgear design``, a curve for ``ncgear fit``."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any, Literal

from pydantic import BeforeValidator, Field

from ncgear.design.keys.base import (
    Faults,
    Length,
    Model,
    Place,
    Positive,
    Several,
    Speed,
    fault,
    given,
    optional,
    required,
)
from ncgear.design.keys.masses import Inertia
from ncgear.design.keys.pitch_shapes import BSpline, DrawnPoints, DxfContour, PictureContour, SvgContour, drawn_points
from ncgear.design.keys.strength import WrittenMaterial
from ncgear.design.words import listed

if TYPE_CHECKING:
    from ncgear.numerics.arrays import Array


FEWEST_KNOTS, MOST_KNOTS = 12, 720

MOST_ORDER = 40
"""Laws of 180 knots have harmonics up to the ninetieth."""


class Limits(Model):
    """Limits that the law may nowhere exceed; left out: no limit."""

    peak_power_w: Positive | None = optional(
        "greatest power of the driving shaft in W, for the resistance and for all masses"
    )
    braking_power_w: Positive | None = optional("greatest power in W that masses give back to the driving shaft")
    rms_torque_n_m: Positive | None = optional("greatest root of the mean square of the driving shaft's torque in N m")
    flywheel_kg_mm2: Positive | None = optional(
        "greatest inertia in kg mm2 that the driving shaft needs, its gear included, to keep the fluctuation "
        "masses.flywheel.speed_fluctuation (left out: 0.05) while the motor's torque is even"
    )
    bearing_force_n: Positive | None = optional(
        "greatest force of the mechanism on the crank's bearings in N, the teeth's apart"
    )
    shaking_force_n: Positive | None = optional("greatest force of the moving masses on the frame in N")
    tooth_force_n: Positive | None = optional(
        "greatest force between the teeth along their normal in N; needs gears of a given size"
    )
    flank_load_n_mm: Positive | None = optional(
        "greatest force between the teeth times the pitch curves' relative curvature times centre distance squared, "
        "in N mm: face width times centre distance squared against pitting is in proportion to it; needs gears"
    )
    torque_harmonics_n_m: Positive | None = optional(
        "greatest r.m.s. in N m of the driving shaft's torque in harmonics above optimize.harmonics_above"
    )
    acceleration_harmonics_mm_s2: Positive | None = optional(
        "greatest r.m.s. in mm/s2 of the slider's acceleration in harmonics above optimize.harmonics_above"
    )
    acceleration_harmonics_rad_s2: Positive | None = optional("the same in rad/s2 of an output that turns")
    center_distance_mm: Length | None = optional(
        "greatest centre distance in mm; needs gears.teeth and gears.module_mm"
    )
    peak_speed_mm_s: Positive | None = optional("greatest slider speed in mm/s, over the whole cycle")
    peak_acceleration_mm_s2: Positive | None = optional("greatest slider acceleration in mm/s2, over the whole cycle")
    peak_jerk_mm_s3: Positive | None = optional("greatest slider jerk in mm/s3")
    peak_speed_rad_s: Positive | None = optional("greatest speed in rad/s of an output that turns")
    peak_acceleration_rad_s2: Positive | None = optional(
        "greatest acceleration in rad/s2 of an output that turns, over the whole cycle"
    )
    peak_jerk_rad_s3: Positive | None = optional("greatest jerk in rad/s3 of an output that turns")
    driven_speed_rpm: Speed | None = optional("greatest speed of the driven gear in r/min")
    ratio_min: float = optional("least transmission ratio", 0.2, ge=0.01, le=1.0)
    ratio_max: float = optional("greatest transmission ratio", 5.0, ge=1.0, le=100.0)
    pressure_angle_deg: float | None = optional(
        "greatest pressure angle in degrees with the rack's angle; of two stages, of each", gt=0.0, lt=90.0
    )
    stages: Annotated[int, Field(ge=1, le=2)] = optional(
        "2: the ratio is shared over two pairs in series; ratio, curves and pressure angle count for each", 1
    )
    convex: bool = optional("true: both pitch curves are convex, so that a rack can cut them", True)
    least_radius_mm: Length | None = optional(
        "least radius of curvature of both pitch curves in mm; needs gears.teeth and gears.module_mm"
    )
    free_of_undercut: bool = optional("true: gears.teeth teeth are free of undercut at their full height", False)
    teeth_hold: bool = optional(
        "true: the teeth of the gears hold against breakage and pitting with the safeties that strength wants, as "
        "ncgear strength rates them",
        False,
    )


class Weights(Model):
    """The value of each figure that counts as 1 in a weighted goal; figures that are left out do not count."""

    acceleration_mm_s2: Positive | None = optional("peak acceleration in mm/s2 that counts as 1")
    acceleration_rad_s2: Positive | None = optional(
        "peak acceleration in rad/s2 of an output that turns that counts as 1"
    )
    power_w: Positive | None = optional("peak power in W that counts as 1")
    braking_power_w: Positive | None = optional("peak braking power in W that counts as 1")
    flywheel_kg_mm2: Positive | None = optional("flywheel in kg mm2 that counts as 1")
    rms_torque_n_m: Positive | None = optional("r.m.s. torque in N m that counts as 1")
    bearing_force_n: Positive | None = optional("bearing force in N that counts as 1")
    shaking_force_n: Positive | None = optional("shaking force in N that counts as 1")
    tooth_force_n: Positive | None = optional("force between the teeth in N that counts as 1")
    jerk_mm_s3: Positive | None = optional("peak jerk in mm/s3 that counts as 1")
    jerk_rad_s3: Positive | None = optional("peak jerk in rad/s3 of an output that turns that counts as 1")

    def _faults(self) -> Faults:
        names = tuple(type(self).model_fields)
        if len(given(self, names)) < 2:
            yield fault("", f"a weighted goal weighs two or more figures; give two of {listed(names)}")


class Range(Model):
    """Range in which the best value of an unknown is sought."""

    RULES = ("most > least",)
    least: float
    most: float


class FlywheelRange(Range):
    """Range in which the best size of a flywheel on the driven shaft is sought."""

    least: Inertia = optional("the least size, by its moment of inertia", 0.0)
    most: Inertia = required("the greatest size, by its moment of inertia")


class LengthRange(Range):
    """Range in which the best length is sought."""

    least: Length = required("the least value")
    most: Length = required("the greatest value")


class OffsetRange(Range):
    """Range in which the best offset is sought."""

    least: Place = required("the least value")
    most: Place = required("the greatest value")


class Lengths(Model):
    """Lengths of the mechanism whose best values are sought; the crank follows from them and from the stroke."""

    stroke_mm: LengthRange | None = optional("the stroke in mm; left out: as given")
    stroke_deg: LengthRange | None = optional("the swing in degrees of an output that turns; left out: as given")
    rod_mm: LengthRange | None = optional("the rod of a crank_slider, in mm")
    offset_mm: OffsetRange | None = optional("the offset of a crank_slider's line, in mm")
    coupler_mm: LengthRange | None = optional("the coupler of a crank_rocker, in mm")
    rocker_mm: LengthRange | None = optional("the rocker of a crank_rocker, in mm")
    ground_mm: LengthRange | None = optional("the distance of a crank_rocker's axes, in mm")
    pivot_mm: LengthRange | None = optional("the distance of a slotted_lever's axis from the crank's, in mm")
    lever_mm: LengthRange | None = optional("the lever of a slotted_lever, in mm")

    @property
    def ranges(self) -> dict[str, Range]:
        """The given ranges, by their keys."""
        return {name: ends for name in type(self).model_fields if (ends := getattr(self, name)) is not None}


GOALS = Literal[
    "least_acceleration",
    "least_power",
    "least_braking_power",
    "least_rms_torque",
    "least_flywheel",
    "least_bearing_force",
    "least_shaking_force",
    "least_tooth_force",
    "least_flank_load",
    "least_speed",
    "least_jerk",
    "least_pressure_angle",
    "least_acceleration_harmonics",
    "least_torque_harmonics",
    "least_center_distance",
    "weighted",
]


class Optimize(Model):
    """The search of `ncgear optimize`."""

    goal: GOALS = optional(
        "what shall be least: the slider's peak speed, acceleration or jerk; the driving shaft's peak power (and with "
        "it its peak torque), its braking power, its r.m.s. torque, or the flywheel that it needs; the force on the "
        "crank's bearings, on the frame or between the teeth; the load of the flanks, which makes gears large against "
        "pitting; the pressure angle; the r.m.s. of acceleration or torque in harmonics above harmonics_above, which "
        "are heard; the centre distance of gears.teeth of gears.module_mm; or a weighted sum",
        "least_acceleration",
    )
    weights: Weights | None = optional("the figures that count alike; only for goal weighted, two or more")
    limits: Limits = optional("limits that the law may nowhere exceed", Limits)
    harmonics_above: Annotated[int, Field(ge=1, le=MOST_ORDER)] = optional(
        "harmonics of the output's cycle over this order count where harmonics are least or limited", 10
    )
    driven_flywheel_kg_mm2: FlywheelRange | None = optional(
        "sizes of a flywheel on the driven shaft, in kg mm2, among which the best is sought together with the law; "
        "left out: the flywheel is masses.driven_flywheel_kg_mm2"
    )
    lengths: Lengths | None = optional(
        "ranges of the mechanism's lengths, among which the best are sought together with the law; a rod or coupler "
        "keeps its section; left out: they are as linkage says"
    )
    knots: Annotated[int, Field(ge=FEWEST_KNOTS, le=MOST_KNOTS)] = optional(
        "knots of the spline of ln i12 around the turn: more come closer to the limit", 180
    )

    def _faults(self) -> Faults:
        if self.goal == "weighted" and self.weights is None:
            yield fault("weights", "missing; give it: a weighted goal needs the figures that count alike")
        if self.goal != "weighted" and self.weights is not None:
            yield fault("weights", f"given, but the goal is {self.goal}; leave weights out, or goal: weighted")


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


FEWEST_MACHINES, MOST_MACHINES = 1, 20

Price = Annotated[float, Field(ge=0.0, le=1e12)]

Process = Literal["hobbed", "shaped", "wire_cut", "printed"]
"""Ways of making teeth."""

OBJECTIVES = Literal["peak_power_w", "gear_volume_mm3", "driven_flywheel_kg_mm2", "center_distance_mm", "cost"]
"""Figures of a whole machine that may count."""


class AvailableMotor(Model):
    """An available motor, by its effect on the driving shaft."""

    name: str = required("its name", min_length=1, max_length=100)
    power_w: Positive = required("greatest power in W that it gives to the driving shaft")
    torque_n_m: Positive | None = optional("greatest torque in N m that it gives to the driving shaft; left out: any")
    cost: Price = optional("its cost", 0.0)


class MaterialChoice(Model):
    """A material that may be chosen for both gears."""

    material: WrittenMaterial = required("material of both gears: a name, or a group of keys")
    cost_factor: Positive = optional("how many times as much gears of it cost for their volume", 1.0)


def _of_material(value: Any) -> Any:
    """The group of keys for the name of a material, which may stand alone."""
    return {"material": value} if isinstance(value, str) else value


if TYPE_CHECKING:
    WrittenChoice = MaterialChoice
else:
    WrittenChoice = Annotated[
        MaterialChoice, BeforeValidator(_of_material, json_schema_input_type=str | MaterialChoice)
    ]


class FaceWidths(Model):
    """The face widths that may be chosen, in modules."""

    RULES = ("least <= most",)

    least: Annotated[float, Field(ge=1.0, le=30.0)] = optional("least face width in modules", 5.0)
    most: Annotated[float, Field(ge=1.0, le=30.0)] = optional("greatest face width in modules", 12.0)


class MakingCosts(Model):
    """Costs of making the teeth of a pair, at any size."""

    hobbed: Price = optional("cost of hobbing a pair", 0.0)
    shaped: Price = optional("cost of shaping a pair", 0.0)
    wire_cut: Price = optional("cost of cutting a pair by wire", 0.0)
    printed: Price = optional("cost of printing a pair", 0.0)


class Costs(Model):
    """Costs of a machine in money, kilograms or another unit: the sum of its figures, each times its factor."""

    motor_per_w: Price = optional("cost of each W of the driving shaft's peak power", 0.0)
    motor_per_n_m: Price = optional("cost of each N m of the driving shaft's peak torque", 0.0)
    gears_per_dm3: Price = optional(
        "cost of each dm3 of face width times centre distance squared; solid gears of steel have about 12 kg of it", 0.0
    )
    driven_flywheel_per_kg_m2: Price = optional("cost of each kg m2 of the flywheel on the driven shaft", 0.0)
    making: MakingCosts = optional("cost of making the teeth, by the process", MakingCosts)

    def _faults(self) -> Faults:
        if not self.model_fields_set:
            yield fault("", "nothing costs anything; give one price or more, or leave the group out")


class Choices(Model):
    """Choices for a whole machine; the law, module, teeth and face width are always chosen."""

    materials: Annotated[Several[WrittenChoice], Field(min_length=1, max_length=10)] | None = optional(
        "materials of both gears that may be chosen; left out: gears.material"
    )
    processes: Annotated[Several[Process], Field(min_length=1, max_length=4)] = optional(
        "ways of making teeth that may be chosen: hobbed, shaped, wire_cut, printed", ("hobbed",)
    )
    modules_mm: Annotated[Several[Length], Field(min_length=1, max_length=50)] | None = optional(
        "modules in mm that may be chosen; left out: series I of ISO 54"
    )
    face_width_modules: FaceWidths = optional("face widths that may be chosen, in modules", FaceWidths)
    center_distance_mm: Length | None = optional("greatest centre distance in mm; left out: no limit")
    diameter_mm: Length | None = optional("greatest diameter of either gear in mm; left out: no limit")
    motors: Annotated[Several[AvailableMotor], Field(min_length=1, max_length=50)] | None = optional(
        "available motors; the cheapest motor that is strong enough is taken; left out: motors of any power"
    )
    least: Annotated[Several[OBJECTIVES], Field(min_length=1, max_length=4)] | None = optional(
        "figures that shall be small; left out: the peak power, the gears' volume and, where it is free, the flywheel"
    )
    cost: Costs | None = optional("costs of a machine; the cheapest machine is recommended; left out: no cost")
    machines: Annotated[int, Field(ge=FEWEST_MACHINES, le=MOST_MACHINES)] = optional(
        "greatest number of machines in the answer", 8
    )

    def _faults(self) -> Faults:
        if self.least is not None and "cost" in self.least and not (self.cost or self.motors):
            yield fault("cost", "missing; least names the cost: give what the figures cost, or leave it out of least")
        for key in given(self, ("processes", "modules_mm", "least")):
            values = getattr(self, key)
            if len(set(values)) < len(values):
                yield fault(key, "the same is given twice; once is right")
