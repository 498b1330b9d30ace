"""The keys of the parts around the gears: bearings, shafts, keys, guide, motor, flywheel's disc, shaft of a tractor.

``ncgear simulate`` computes their life and safeties; none of these keys changes gears or motion.
"""

from __future__ import annotations

from math import inf
from typing import TYPE_CHECKING, Annotated, Literal, NamedTuple

from pydantic import Field

from ncgear.design.keys.base import (
    Faults,
    Length,
    Model,
    Place,
    Positive,
    Several,
    Speed,
    fault,
    optional,
    required,
)
from ncgear.design.words import COUNTS

if TYPE_CHECKING:
    from ncgear.design.keys.gears import Gears

Share = Annotated[float, Field(gt=0.0, le=1.0)]
Coefficient = Annotated[float, Field(ge=0.0, le=2.0)]

LEAST_BALL_DEG = 20.0
"""Least contact angle of rows of balls for which ISO 281 has factors that do not change with the load."""


class Bearing(Model):
    """One of the two bearings of a shaft."""

    at_mm: Place = required(
        "place of its middle along the shaft in mm, counted from the middle of the gear, over 0 on the side of its hub"
    )
    kind: Literal["ball", "roller"] = optional(
        "ball or roller: the life falls with the load to the power 3 or 10/3", "ball"
    )
    dynamic_rating_n: Positive | None = optional(
        "basic dynamic load rating C in N; left out: the report only tells the rating that is needed"
    )
    static_rating_n: Positive | None = optional("basic static load rating C0 in N; left out: no static safety")
    stiffness_n_per_um: Positive | None = optional(
        "stiffness in N/um of the bearing and the housing about it together, across the shaft, for the load along the "
        "face width; left out: that of a usual bearing with this static rating in a rigid housing, or rigid without "
        "one"
    )
    contact_angle_deg: float | None = optional(
        "contact angle in degrees of two rows of balls (20 or over) or rollers that bear thrust to both sides, as of "
        "spherical roller bearings or tapered ones in pairs; left out: balls in a deep groove, cylindrical rollers",
        ge=1.0,
        le=45.0,
    )

    def _faults(self) -> Faults:
        angle = self.contact_angle_deg
        if self.kind == "ball" and angle is not None and angle < LEAST_BALL_DEG:
            yield fault(
                "contact_angle_deg",
                f"{angle:g} given, but rows of balls bear thrust at {LEAST_BALL_DEG:g} deg or over; leave it out for a "
                "deep groove",
            )


class ShaftKey(Model):
    """The key between shaft and gear, in the keyway of the gear's body."""

    length_mm: Length | None = optional("length of the key's straight sides in the hub in mm; left out: the face width")
    height_mm: Length | None = optional(
        "height in mm over which key and hub touch; left out: the depth of the gear's keyway less 0.4 mm"
    )
    yield_mpa: Positive | None = optional("least yield strength of key and hub in MPa; left out: the shaft's")


class DrivingShaft(Model):
    """The shaft of the driving gear; a coupling that does not press on it turns it."""

    RULES = (
        "bearing_a with bearing_b",
        "steel needs bearing_a",
        "tensile_mpa needs bearing_a",
        "key needs steel tensile_mpa",
        "at most one of steel tensile_mpa",
        "tensile_mpa with yield_mpa",
        "yield_mpa <= tensile_mpa",
    )

    bearing_a: Bearing | None = optional("one bearing; left out: none are looked at")
    bearing_b: Bearing | None = optional("the other bearing")
    diameter_mm: Length | None = optional("diameter at the gear in mm; left out: the bore of the gear")
    steel: Literal["S355", "E335", "C45", "42CrMo4", "34CrNiMo6"] | None = optional(
        "steel of the shaft: S355, E335, C45, 42CrMo4 or 34CrNiMo6; left out, and without tensile_mpa: the shaft is "
        "not looked at"
    )
    tensile_mpa: Positive | None = optional("tensile strength in MPa at this diameter, in place of a steel")
    yield_mpa: Positive | None = optional("yield strength in MPa at this diameter, in place of a steel")
    blank_mm: Length | None = optional(
        "diameter in mm of the blank when the steel was heat treated; left out: diameter of the shaft"
    )
    key: ShaftKey | None = optional("key in the gear's keyway; left out: not looked at. Needs the steel")
    thrust_on: Literal["a", "b"] = optional(
        "a or b: the bearing that bears the thrust of helical teeth, in both directions", "a"
    )

    def _faults(self) -> Faults:
        if self.bearing_a and self.bearing_b and self.bearing_a.at_mm == self.bearing_b.at_mm:
            yield fault(
                "bearing_b.at_mm", f"{self.bearing_b.at_mm:g} mm given, the place of bearing_a; another place is right"
            )

    @property
    def has_strength(self) -> bool:
        """Whether the strength of the shaft is given, by its steel or by a value."""
        return self.steel is not None or self.tensile_mpa is not None


class DrivenShaft(DrivingShaft):
    """The shaft of the driven gear; the crank turns with it."""

    crank_at_mm: Place = optional(
        "place of the crank pin's middle along the shaft in mm, counted from the middle of the gear", 0.0
    )


class ShaftBetween(DrivingShaft):
    """A shaft between two pairs of gears: the driven gear of one pair and the driving gear of the next are on it."""

    second_gear_at_mm: Place = required(
        "place of the middle of the driving gear of the next pair along the shaft in mm, counted like all places from "
        "the middle of the gear that is driven"
    )


class Gearbox(Model):
    """The parts between a motor and the driving shaft."""

    ratio: float = optional(
        "speed of the motor over speed of the driving shaft; over 1 slows down", 1.0, gt=0.0, le=1e6
    )
    efficiency: Share = optional("power that comes out over power that goes in", 1.0)


class DrivetrainMotor(Model):
    """The motor, at its own shaft: its ratings, and the fall of its torque with its speed."""

    RULES = ("no_load_speed_rpm > rated_speed_rpm", "peak_torque_n_m >= rated_torque_n_m")

    rated_torque_n_m: Positive = required("torque in N m that it gives for ever")
    rated_speed_rpm: Speed = required("speed in r/min at which it gives it")
    peak_torque_n_m: Positive | None = optional("torque in N m that it gives for moments; left out: not looked at")
    no_load_speed_rpm: Speed | None = optional(
        "speed in r/min at which it has no torque left, of the straight line through the rated point; left out: the "
        "line of simulation.motor, which is at the driving gear, or no line"
    )
    inertia_kg_mm2: float = optional("moment of inertia of its rotor in kg mm2, at its own shaft", 0.0, ge=0.0, le=1e16)
    gearbox: Gearbox = optional("gearbox or belt; left out: none", Gearbox)
    overrunning_clutch: bool = optional(
        "true: a clutch that lets the machine run ahead, so that the motor never brakes it", False
    )


class PowerTakeOff(Model):
    """A shaft that turns at constant speed, such as a tractor's shaft, and the coupling behind it."""

    torque_limiter_n_m: Positive | None = optional(
        "torque in N m at the driving shaft from which a limiter slips; left out: none"
    )
    overrunning_clutch: bool = optional(
        "true: a clutch that lets the machine run ahead, so that it is never braked", False
    )


class Drivetrain(Model):
    """The parts around the gears; every part may be left out."""

    RULES = ("at most one of motor pto",)

    life_h: Positive = optional("hours that the bearings shall last", 10_000.0)
    reliability_percent: float = optional(
        "share in percent of the bearings that shall last so long", 90.0, ge=50.0, le=99.95
    )
    driving_shaft: DrivingShaft | None = optional("shaft of the driving gear; left out: none")
    shafts_between: Annotated[Several[ShaftBetween], Field(min_length=1)] | None = optional(
        "list of the shafts between pairs of gears in series, from the driving shaft on; left out: none"
    )
    driven_shaft: DrivenShaft | None = optional("shaft of the driven gear and the crank; left out: none")
    guide_friction: Coefficient = optional("coefficient of friction of the slider in its guide", 0.0)
    flywheel_diameter_mm: Length | None = optional(
        "diameter in mm of a steel disc that masses.flywheel.speed_fluctuation asks for; left out: only its inertia is "
        "told"
    )
    motor: DrivetrainMotor | None = optional("motor with its gearbox; left out: none")
    pto: PowerTakeOff | None = optional(
        "shaft of constant speed with its coupling, in place of a motor; left out: none"
    )


class NamedShaft(NamedTuple):
    """A shaft in words, its key below ``drivetrain``, and its keys; None where they are left out."""

    words: str
    key: str
    given: DrivingShaft | None


def named_shafts(around: Drivetrain | None, pairs: int) -> list[NamedShaft]:
    """The shafts of pairs of gears, from the driving shaft on."""
    between = (around.shafts_between if around else None) or (None,) * (pairs - 1)
    words = [f"stages {stage} and {stage + 1}" for stage in range(1, len(between) + 1)] if pairs > 2 else ["the stages"]
    words += ["more"] * (len(between) - len(words))
    return [
        NamedShaft("driving shaft", "driving_shaft", around.driving_shaft if around else None),
        *(
            NamedShaft(f"shaft between {said}", f"shafts_between.{place}", shaft)
            for place, (said, shaft) in enumerate(zip(words, between, strict=False))
        ),
        NamedShaft("driven shaft", "driven_shaft", around.driven_shaft if around else None),
    ]


def bodies_on(number: int, pairs: int) -> tuple[str, ...]:
    """The keys below ``gears`` of the bodies on a shaft, counted from the driving shaft on; the driven first."""
    return ("driven",) * (number > 0) + ("driving",) * (number < pairs)


def shaft_faults(shafts: list[NamedShaft], gears: Gears, pairs: int) -> Faults:
    """What is wrong with shafts and bearings beside their gears."""
    helical, width = gears.helix is not None and gears.helix.kind == "helical", gears.face_width_mm
    if len(shafts) != pairs + 1:
        many = f"{COUNTS[pairs]} pairs of gears have {pairs - 1}" if pairs > 1 else "one pair has none"
        problem = f"{len(shafts) - 2} given, but {many}; give one for each, or leave it out"
        yield fault("drivetrain.shafts_between", problem)
    if pairs > 1 and helical:
        yield fault(
            "gears.helix.kind",
            "helical given, but the thrust of pairs in series on their shafts is not computed; herringbone is right, "
            "or leave drivetrain out",
        )
    for number, (_, name, shaft) in enumerate(shafts):
        if shaft is None:
            continue
        key, second_mm = f"drivetrain.{name}", getattr(shaft, "second_gear_at_mm", 0.0)
        bearings = [
            (name, getattr(shaft, name)) for name in ("bearing_a", "bearing_b") if getattr(shaft, name) is not None
        ]
        thrust = dict(bearings).get(f"bearing_{shaft.thrust_on}")
        if helical and thrust is not None and thrust.contact_angle_deg is None:
            lacks = "contact_angle_deg" if thrust.kind == "roller" else "static_rating_n"
            why = {
                "contact_angle_deg": "cylindrical rollers bear no thrust of helical teeth; others have an angle",
                "static_rating_n": "what a ball bearing does under the thrust of helical teeth depends on it",
            }
            if lacks == "contact_angle_deg" or thrust.static_rating_n is None:
                yield fault(f"{key}.bearing_{shaft.thrust_on}.{lacks}", f"missing; {why[lacks]}")
        if isinstance(shaft, ShaftBetween) and abs(second_mm) < width:
            yield fault(
                f"{key}.second_gear_at_mm",
                f"{second_mm:.10g} mm given, but the gears are {width:.10g} mm wide: they overlap; as much or more is "
                "right, on either side",
            )
        for place, gear in enumerate(bodies_on(number, pairs)):
            # Of two gears on a shaft, the second is seen from the other end: its hub is on the other side.
            ends = [width / 2.0, width / 2.0 + gears.hub_mm(gear)][:: -1 if place else 1]
            low, top = second_mm * place - ends[0], second_mm * place + ends[1]
            for bearing, seat in bearings:
                if low < seat.at_mm < top:
                    within = "the gear" if abs(seat.at_mm - second_mm * place) < width / 2.0 else "the gear's hub"
                    yield fault(
                        f"{key}.{bearing}.at_mm",
                        f"{seat.at_mm:.10g} mm is within {within}, which ends at {top:.10g} mm; {low:.10g} or less, "
                        f"or {top:.10g} or more, is right",
                    )
            longest, length = width + gears.hub_mm(gear), shaft.key.length_mm if shaft.key else None
            if length is not None and length > longest:
                yield fault(
                    f"{key}.key.length_mm",
                    f"{length:g} given, but the gear with its hub is {longest:g} mm long; {longest:g} or less is right",
                )
            bore_mm = getattr(gears, gear).bore_mm
            if isinstance(shaft, ShaftBetween) and bore_mm and (shaft.diameter_mm or 0.0) > bore_mm:
                yield fault(
                    f"{key}.diameter_mm",
                    f"{shaft.diameter_mm:g} mm given, but a bore of its gears is {bore_mm:g} mm; as much or less is "
                    "right",
                )


def widest_mm(shafts: list[NamedShaft], gears: Gears, pairs: int) -> float:
    """The greatest face width with which gears and hubs end before the bearings; infinite where none are given."""
    halves = [inf]
    for number, (_, _, shaft) in enumerate(shafts):
        bearings = [bearing for bearing in (shaft.bearing_a, shaft.bearing_b) if bearing is not None] if shaft else []
        second_mm = getattr(shaft, "second_gear_at_mm", 0.0)
        for place, gear in enumerate(bodies_on(number, pairs)):
            hub_side = -1.0 if place else 1.0
            beyond = [hub_side * (bearing.at_mm - second_mm * place) for bearing in bearings]
            halves += [max(at - gears.hub_mm(gear), 0.0) if at > 0.0 else -at for at in beyond]
    return 2.0 * min(halves)
