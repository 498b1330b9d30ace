"""The keys of the machine around the gears: linkage, operation, resistance, mechanisms to compare with, output."""

from __future__ import annotations

from typing import Annotated, Literal, Self

from pydantic import Field, Strict, model_validator

from ncgear.design.keys.base import (
    FORMULA,
    LONGEST_MM,
    Expression,
    Length,
    Model,
    Numbers,
    Positive,
    Speed,
    allow_one,
    fault,
    given,
    listed,
    require_one,
)

FIGURES = {"peak_power_w": 1, "peak_acceleration_mm_s2": 2, "peak_speed_mm_s": 1, "compression_speed_mm_s": 1}
"""Figures of a published mechanism, each with the power of the driving speed that it is proportional to."""


class Linkage(Model):
    """The crank-slider that the driven gear turns."""

    crank_mm: Length | None = Field(
        default=None, description="length of the crank in mm; may be left out only when motion.solve_for is stroke"
    )
    rod_mm: Length = Field(description="length of the connecting rod in mm")
    offset_mm: float = Field(
        default=0.0,
        ge=-LONGEST_MM,
        le=LONGEST_MM,
        description="distance of the slider's line from the crank axis in mm",
    )


class Operation(Model):
    """How the machine is run."""

    speed_rpm: Speed = Field(description="speed of the driving gear in r/min")


class Published(Model):
    """A published mechanism and its figures, at the speed they belong to."""

    name: str = Field(min_length=1, max_length=200, description="name of the mechanism or its publication")
    speed_rpm: Speed = Field(description="driving speed in r/min that the figures belong to")
    peak_power_w: Positive | None = Field(default=None, description="greatest driving power in W")
    peak_acceleration_mm_s2: Positive | None = Field(default=None, description="greatest slider acceleration in mm/s2")
    peak_speed_mm_s: Positive | None = Field(default=None, description="greatest slider speed in mm/s")
    compression_speed_mm_s: Positive | None = Field(default=None, description="slider speed during compression in mm/s")
    quoted_power_w: Positive | None = Field(
        default=None, description="power in W that the publication set against its own; needs quoted_speed_rpm"
    )
    quoted_speed_rpm: Speed | None = Field(
        default=None, description="driving speed in r/min that quoted_power_w belongs to"
    )

    def at_speed(self, speed_rpm: float) -> Published:
        """The same mechanism at another speed: power and velocities follow the speed, acceleration its square."""
        factor = speed_rpm / self.speed_rpm
        scaled = {key: getattr(self, key) * factor ** FIGURES[key] for key in given(self, FIGURES)}
        return self.model_copy(update={"speed_rpm": speed_rpm, **scaled})

    @model_validator(mode="after")
    def _figures(self) -> Self:
        if not given(self, FIGURES):
            raise fault("", f"no figure to compare; give at least one of {listed(FIGURES)}")
        quoted = given(self, ("quoted_power_w", "quoted_speed_rpm"))
        if len(quoted) == 1:
            raise fault(quoted[0], "given alone; quoted_power_w and quoted_speed_rpm need each other")
        return self


class Comparison(Model):
    """Mechanisms to compare with at equal speed."""

    published: Annotated[tuple[Published, ...], Strict(False), Field(min_length=1, max_length=100)] = Field(
        description="published mechanisms, a list"
    )


MOST_RESISTANCE_POINTS = 1000
FEWEST_POINTS = 2

STRONGEST_N = 1e15
"""Far beyond any machine, and far below where slopes between two points overflow."""

NEAREST_MM = 1e-9
"""Far below what can be measured, and far above where the slope from one point to the next overflows."""

Points = Field(min_length=FEWEST_POINTS, max_length=MOST_RESISTANCE_POINTS)
Displacement = Annotated[float, Field(ge=-LONGEST_MM, le=LONGEST_MM)]
Displacements = Annotated[tuple[Displacement, ...], Strict(False), Points]
Forces = Annotated[tuple[Annotated[float, Field(ge=-STRONGEST_N, le=STRONGEST_N)], ...], Strict(False), Points]


FORMS = ("polynomial_n", "table", "expression_n")


class ResistanceTable(Model):
    """Points of the force. Points from a CSV file stand in the same columns once the file is loaded."""

    displacement_mm: Displacements | None = Field(
        default=None, description="displacements in mm from the retracted end, strictly rising"
    )
    force_n: Forces | None = Field(default=None, description="forces in N, one for each displacement")
    file: str | None = Field(
        default=None,
        min_length=1,
        description="CSV file with both columns instead, its header naming them; its path counts from the design file",
    )

    @model_validator(mode="after")
    def _columns(self) -> Self:
        for key in ("displacement_mm", "force_n"):
            if getattr(self, key) is None:
                raise fault(key, "missing; a table needs displacement_mm and force_n, or a file that has both")
        points, forces = len(self.displacement_mm or ()), len(self.force_n or ())
        if points != forces:
            raise fault("force_n", f"{forces} values for {points} displacements; give as many")
        return self

    @model_validator(mode="after")
    def _displacements_rise(self) -> Self:
        points = self.displacement_mm or ()
        for i in range(1, len(points)):
            if not points[i] > points[i - 1]:
                problem = f"{points[i]:g} follows {points[i - 1]:g}; the displacements must rise strictly"
                raise fault(f"displacement_mm.{i}", problem)
            if points[i] - points[i - 1] < NEAREST_MM:
                problem = f"{points[i]:g} follows {points[i - 1]:g}; at least {NEAREST_MM:g} mm apart is right"
                raise fault(f"displacement_mm.{i}", problem)
        return self


class StrokeForce(Model):
    """The force against the slider over one of its strokes; one of polynomial_n, table and expression_n."""

    polynomial_n: Annotated[Numbers, Field(min_length=1, max_length=50)] | None = Field(
        default=None, description="coefficients of the force in N, in rising powers of the displacement in mm"
    )
    table: ResistanceTable | None = Field(
        default=None, description="the force point by point; it keeps its end values beyond the table's ends"
    )
    expression_n: Expression | None = Field(
        default=None,
        description='force in N as a formula of x (= displacement in mm): "200 + 3*exp(x/90)", '
        f"{FORMULA}; it may have corners, as max(0, x - 30) has, but no jumps",
    )
    where_negative: Literal["zero", "keep"] = Field(
        default="zero", description="where the force is negative: zero (a fit says nothing there) or keep"
    )

    @model_validator(mode="after")
    def _one_form(self) -> Self:
        require_one(self, FORMS)
        return self


class Resistance(StrokeForce):
    """The force against the slider: over its working stroke, over its way back, and a friction on both."""

    returning: StrokeForce | None = Field(
        default=None,
        description="force against the slider on its way back, over the displacement like the other; left out: none",
    )
    friction_n: float = Field(
        default=0.0, ge=0.0, description="constant force in N against the slider's motion, on both strokes"
    )

    @model_validator(mode="after")
    def _one_form(self) -> Self:
        if self.returning is None and "friction_n" not in self.model_fields_set:
            require_one(self, FORMS)
        allow_one(self, FORMS)
        return self


class Output(Model):
    """How finely the results are written."""

    chord_tolerance_mm: float = Field(
        default=0.005,
        ge=1e-5,
        le=0.5,
        description="greatest distance in mm of a written outline's chords from the exact curve",
    )
