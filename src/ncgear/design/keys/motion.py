"""The law given point by point: displacement or ratio against the driving angle.

The motion laws a design file can ask for, told apart by the key ``law``.
"""

from __future__ import annotations

from math import pi
from sys import float_info
from typing import Annotated, Any, Literal, Self

from pydantic import BeforeValidator, Field, Strict, model_validator

from ncgear.design.keys.base import (
    Length,
    Model,
    Numbers,
    Positive,
    Speed,
    allow_one,
    angle_rad,
    fault,
    given,
    in_rad,
    listed,
    require_one,
    spellings,
)
from ncgear.design.reading.text import shown

MOST_POINTS = 200_000
FEWEST_POINTS = 4
ANGLE_COLUMNS = spellings("phi1")
VALUE_COLUMNS = ("displacement_mm", "ratio")
COLUMNS = (*ANGLE_COLUMNS, *VALUE_COLUMNS)

FULL_TURN = {"rad": 2.0 * pi, "deg": 360.0, "pi": 2.0}

Column = Annotated[Numbers, Field(min_length=FEWEST_POINTS, max_length=MOST_POINTS)]


class TableLaw(Model):
    """Points of the law. Points from a CSV file stand in the same columns once the file is loaded."""

    law: Literal["table"] = Field(description="the name of this law: table")
    phi1_rad: Column | None = Field(default=None, description="driving angles in rad, strictly rising, 0 to 2 pi")
    phi1_deg: Column | None = Field(default=None, description="driving angles in degrees, strictly rising, 0 to 360")
    phi1_pi: Column | None = Field(
        default=None, description="driving angles in multiples of pi, strictly rising, 0 to 2"
    )
    displacement_mm: Column | None = Field(
        default=None, description="slider displacements in mm from the retracted end, one for each angle"
    )
    ratio: Column | None = Field(default=None, description="transmission ratios i12 = dphi1/dphi2, one for each angle")
    file: str | None = Field(
        default=None,
        min_length=1,
        description="CSV file with the columns instead, its header naming them; its path counts from the design file",
    )
    scale_to_close: bool = Field(
        default=False, description="true: multiply the ratio by the constant that makes the driven gear come round"
    )

    @property
    def phi1(self) -> tuple[float, ...]:
        """Driving angles in rad."""
        unit = self._angle_key.removeprefix("phi1_")
        return tuple(in_rad(value, unit) for value in getattr(self, self._angle_key))

    @property
    def _angle_key(self) -> str:
        return given(self, ANGLE_COLUMNS)[0]

    @model_validator(mode="after")
    def _columns(self) -> Self:
        require_one(self, ANGLE_COLUMNS)
        require_one(self, VALUE_COLUMNS)
        if self.scale_to_close and self.ratio is None:
            raise fault("scale_to_close", "true, but there is no ratio to scale; leave it out, or give ratio")
        value_key = given(self, VALUE_COLUMNS)[0]
        angles, values = len(getattr(self, self._angle_key)), len(getattr(self, value_key))
        if angles != values:
            raise fault(value_key, f"{values} values for {angles} angles; give as many as {self._angle_key} has")
        return self

    @model_validator(mode="after")
    def _angles_rise_within_a_turn(self) -> Self:
        key = self._angle_key
        angles: tuple[float, ...] = getattr(self, key)
        turn = FULL_TURN[key.removeprefix("phi1_")]
        for i, angle in enumerate(angles):
            if not 0.0 <= angle <= turn:
                raise fault(f"{key}.{i}", f"{angle:g} is outside the cycle; 0 to {turn:g} is right")
            if i and angle <= angles[i - 1]:
                raise fault(f"{key}.{i}", f"{angle:g} follows {angles[i - 1]:g}; the angles must rise strictly")
        return self


LONGEST_EXPRESSION = 1000

MOST_HARMONICS = 200

LARGEST_COEFFICIENT = 10.0
"""Of ln i12: one harmonic of 7 alone is a range of 1:1e6, where the driven gear stands still."""

SolveFor = Literal["law_speed", "v1", "v2", "a1", "stroke"]

SOLVED_KEY: dict[str, str] = {
    "law_speed": "law_speed_rpm",
    "v1": "v1_mm_s",
    "v2": "v2_mm_s",
    "a1": "a1_mm_s2",
    "stroke": "stroke_mm",
}
"""The key that stays absent for each value of ``solve_for``."""

Expression = Annotated[str, Field(min_length=1, max_length=LONGEST_EXPRESSION)]

Coefficient = Annotated[float, Field(ge=-LARGEST_COEFFICIENT, le=LARGEST_COEFFICIENT)]
Coefficients = Annotated[tuple[Coefficient, ...], Strict(False), Field(max_length=MOST_HARMONICS)]


def _number_or_word(value: Any) -> Any:
    """Refuse in one sentence what is neither; pydantic would report each branch of the union by itself."""
    is_number = isinstance(value, int | float) and not isinstance(value, bool)
    if value != "least_acceleration" and not (is_number and abs(value) <= float_info.max):
        raise fault("", f"{shown(value)} given; a finite number or the word least_acceleration is needed")
    return value


class ReturnStroke(Model):
    """How the slider returns: the form of the ratio over the return stroke and its one free coefficient."""

    basis: Literal["ratio", "inverse_ratio"] = Field(
        default="ratio", description="what is a polynomial of phi1 over the return stroke: ratio or inverse_ratio"
    )
    e: Annotated[float | Literal["least_acceleration"], BeforeValidator(_number_or_word)] = Field(
        default="least_acceleration",
        description="free coefficient of the return stroke: a number, or least_acceleration to have it found",
    )

    @model_validator(mode="after")
    def _number_needs_ratio(self) -> Self:
        if self.basis == "inverse_ratio" and self.e != "least_acceleration":
            raise fault("e", f"{self.e:g} is a number, which needs basis ratio; with inverse_ratio leave e out")
        return self


class ThreeSegmentStroke(Model):
    """The working stroke in three segments: by way of v1 to v2, constant v2, down to rest; then the return."""

    law: Literal["three_segment_stroke"] = Field(description="the name of this law: three_segment_stroke")
    solve_for: SolveFor = Field(
        description="the quantity found from the others, its own key left out: law_speed, v1, v2, a1 or stroke"
    )
    theta1_rad: float | None = Field(
        default=None, description="driving angle in rad at which the slider's speed is v1 and its acceleration zero"
    )
    theta1_deg: float | None = Field(
        default=None, description="driving angle in degrees at which the slider's speed is v1 and its acceleration zero"
    )
    theta1_pi: float | None = Field(
        default=None,
        description="driving angle in multiples of pi at which the slider's speed is v1 and its acceleration zero",
    )
    theta2_rad: float | None = Field(
        default=None, description="driving angle in rad from which the slider's speed is v2; over theta1"
    )
    theta2_deg: float | None = Field(
        default=None, description="driving angle in degrees from which the slider's speed is v2; over theta1"
    )
    theta2_pi: float | None = Field(
        default=None, description="driving angle in multiples of pi from which the slider's speed is v2; over theta1"
    )
    theta3_rad: float | None = Field(
        default=None, description="driving angle in rad up to which the slider's speed is v2; theta2 or over"
    )
    theta3_deg: float | None = Field(
        default=None, description="driving angle in degrees up to which the slider's speed is v2; theta2 or over"
    )
    theta3_pi: float | None = Field(
        default=None,
        description="driving angle in multiples of pi up to which the slider's speed is v2; theta2 or over",
    )
    theta4_rad: float | None = Field(
        default=None, description="driving angle in rad of the extended dead centre; over theta3, under a cycle"
    )
    theta4_deg: float | None = Field(
        default=None, description="driving angle in degrees of the extended dead centre; over theta3, under a cycle"
    )
    theta4_pi: float | None = Field(
        default=None,
        description="driving angle in multiples of pi of the extended dead centre; over theta3, under a cycle",
    )
    v1_mm_s: Positive | None = Field(default=None, description="slider speed v1 at theta1 in mm/s, at the law speed")
    v2_mm_s: Positive | None = Field(
        default=None, description="constant slider speed v2 from theta2 to theta3 in mm/s, at the law speed"
    )
    a1_mm_s2: float | None = Field(
        default=None, description="slider acceleration a1 at theta4 in mm/s2, negative, at a1_speed_rpm"
    )
    a1_speed_rpm: Speed | None = Field(
        default=None, description="driving speed in r/min at which a1_mm_s2 is stated; left out: the law speed"
    )
    law_speed_rpm: Speed | None = Field(default=None, description="driving speed in r/min at which v1 and v2 hold")
    stroke_mm: Length | None = Field(default=None, description="stroke in mm; left out: the stroke of the linkage")
    return_: ReturnStroke = Field(default_factory=ReturnStroke, alias="return", description="the return stroke")

    @property
    def theta1(self) -> float:
        """theta1 in rad."""
        return angle_rad(self, "theta1")

    @property
    def theta2(self) -> float:
        """theta2 in rad."""
        return angle_rad(self, "theta2")

    @property
    def theta3(self) -> float:
        """theta3 in rad."""
        return angle_rad(self, "theta3")

    @property
    def theta4(self) -> float:
        """theta4 in rad."""
        return angle_rad(self, "theta4")

    @model_validator(mode="after")
    def _angles_rise(self) -> Self:
        for quantity in ("theta1", "theta2", "theta3", "theta4"):
            require_one(self, spellings(quantity))
        if self.theta1 <= 0.0:
            raise self._out_of_order("theta1", "over 0")
        if self.theta2 <= self.theta1:
            raise self._out_of_order("theta2", "over theta1")
        if self.theta3 < self.theta2:
            raise self._out_of_order("theta3", "theta2 or over")
        if not self.theta3 < self.theta4 < 2.0 * pi:
            raise self._out_of_order("theta4", "between theta3 and 2 pi")
        return self

    def _out_of_order(self, quantity: str, needed: str) -> Exception:
        in_pi = [f"{angle_rad(self, f'theta{i}') / pi:.6g}" for i in (1, 2, 3, 4)]
        return fault(
            given(self, spellings(quantity))[0],
            f"{quantity} must be {needed}; the angles, in multiples of pi, are {', '.join(in_pi)}; "
            "0 < theta1 < theta2 <= theta3 < theta4 < 2 is right",
        )

    @model_validator(mode="after")
    def _only_the_solved_one_is_absent(self) -> Self:
        solved = SOLVED_KEY[self.solve_for]
        if getattr(self, solved) is not None:
            raise fault(solved, f"given, but solve_for: {self.solve_for} says to find it; leave {solved} out")
        # The stroke can always be left out: the linkage has one.
        needed = [key for key in SOLVED_KEY.values() if key not in (solved, "stroke_mm")]
        absent = [key for key in needed if getattr(self, key) is None]
        if absent:
            raise fault(absent[0], f"missing; solve_for: {self.solve_for} needs {listed(needed, 'and')}")
        return self


class RatioExpression(Model):
    """A law written as a formula of phi1: the transmission ratio, or the driven angle."""

    law: Literal["ratio_expression"] = Field(description="the name of this law: ratio_expression")
    ratio: Expression | None = Field(
        default=None,
        description='transmission ratio i12 = dphi1/dphi2 as a formula of phi (= phi1 in rad): "1 + 0.3*cos(phi)"',
    )
    driven_angle: Expression | None = Field(
        default=None,
        description='driven angle phi2 in rad as a formula of phi (= phi1 in rad): "phi - 0.08*sin(2*phi)"',
    )
    scale_to_close: bool = Field(
        default=False, description="true: multiply the ratio by the constant that makes the driven gear come round"
    )

    @model_validator(mode="after")
    def _one_formula(self) -> Self:
        require_one(self, ("ratio", "driven_angle"))
        if self.scale_to_close and self.ratio is None:
            raise fault("scale_to_close", "true, but there is no ratio to scale; leave it out, or give ratio")
        return self


class Ellipse(Model):
    """Elliptical gears; with lobes 1:1 two equal ellipses, each turning about a focus."""

    law: Literal["ellipse"] = Field(description="the name of this law: ellipse")
    eccentricity: float = Field(ge=0.0, lt=1.0, description="eccentricity of the ellipse, 0 (a circle) to under 1")
    phase_rad: float | None = Field(
        default=None, description="driving angle at which the driving radius is smallest, in rad"
    )
    phase_deg: float | None = Field(
        default=None, description="driving angle at which the driving radius is smallest, in degrees"
    )
    phase_pi: float | None = Field(
        default=None, description="driving angle at which the driving radius is smallest, in multiples of pi"
    )

    @property
    def phase(self) -> float:
        """Phase in rad, 0 where none is given."""
        return angle_rad(self, "phase")

    @model_validator(mode="after")
    def _one_phase(self) -> Self:
        allow_one(self, spellings("phase"))
        return self


class SecondStage(Model):
    """The share of the second of two pairs in series, the one that drives the crank; the first has the rest."""

    cosine: Coefficients = Field(
        default=(), description="coefficients of cos(phi2), cos(2 phi2), ... in ln of the second pair's ratio"
    )
    sine: Coefficients = Field(
        default=(), description="coefficients of sin(phi2), sin(2 phi2), ... in ln of the second pair's ratio"
    )


class HarmonicRatio(Model):
    """The logarithm of the ratio by harmonics of the driven angle; what closes the cycle is added."""

    law: Literal["harmonic_ratio"] = Field(description="the name of this law: harmonic_ratio")
    cosine: Coefficients = Field(
        default=(), description="coefficients of cos(phi2), cos(2 phi2), ... in ln i12, phi2 being the driven angle"
    )
    sine: Coefficients = Field(
        default=(), description="coefficients of sin(phi2), sin(2 phi2), ... in ln i12, phi2 being the driven angle"
    )
    second_stage: SecondStage | None = Field(
        default=None, description="given: two pairs in series make i12, both as `gears` describes; left out: one pair"
    )


class UniformCrank(Model):
    """Circular gears: the crank turns uniformly."""

    law: Literal["uniform_crank"] = Field(description="the name of this law: uniform_crank")


Motion = Annotated[
    ThreeSegmentStroke | RatioExpression | HarmonicRatio | Ellipse | TableLaw | UniformCrank,
    Field(discriminator="law", description="how the slider moves, or how the ratio runs; `law` says which law it is"),
]

LAWS: dict[str, type[Model]] = {
    "three_segment_stroke": ThreeSegmentStroke,
    "ratio_expression": RatioExpression,
    "harmonic_ratio": HarmonicRatio,
    "ellipse": Ellipse,
    "table": TableLaw,
    "uniform_crank": UniformCrank,
}
"""The model of each law."""
