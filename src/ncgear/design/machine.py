"""The machine around the gears: linkage, operation, published machines to compare with, output."""

from __future__ import annotations

from typing import Annotated, Self

from pydantic import Field, Strict, model_validator

from ncgear.design.angles import given, listed
from ncgear.design.base import LONGEST_MM, Length, Model, Positive, Speed
from ncgear.design.faults import fault

FIGURES = ("peak_power_w", "peak_acceleration_mm_s2", "peak_speed_mm_s", "compression_speed_mm_s")


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


class Output(Model):
    """How finely the results are written."""

    chord_tolerance_mm: float = Field(
        default=0.005,
        ge=1e-5,
        le=0.5,
        description="greatest distance in mm of a written outline's chords from the exact curve",
    )
