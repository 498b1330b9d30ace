"""What a design file says of accuracy."""

from __future__ import annotations

from typing import Self

from pydantic import Field, model_validator

from ncgear.design.base import Model
from ncgear.design.faults import fault


class Tolerances(Model):
    """What the data sheet says of accuracy, as given; only the limits of the measurements follow from it."""

    standard: str = Field(default="", max_length=200, description="standard that the grade belongs to, as text")
    grade: str = Field(default="", max_length=200, description="accuracy grade, as text")
    tooth_thickness_upper_mm: float | None = Field(
        default=None,
        ge=-10.0,
        le=10.0,
        description="greatest deviation of the tooth thickness along the pitch curve in mm, of both gears; thinner "
        "teeth have a negative one",
    )
    tooth_thickness_lower_mm: float | None = Field(
        default=None,
        ge=-10.0,
        le=10.0,
        description="least deviation of the tooth thickness along the pitch curve in mm, of both gears",
    )
    note: str = Field(default="", max_length=2000, description="more for the data sheet, as text: runout, hardness")

    @model_validator(mode="after")
    def _two_limits(self) -> Self:
        upper, lower = self.tooth_thickness_upper_mm, self.tooth_thickness_lower_mm
        if (upper is None) != (lower is None):
            absent = "tooth_thickness_upper_mm" if upper is None else "tooth_thickness_lower_mm"
            raise fault(absent, "missing; the deviation of the tooth thickness has two limits")
        if upper is not None and lower is not None and lower > upper:
            raise fault("tooth_thickness_lower_mm", f"{lower:g} mm is over the upper limit; {upper:g} or less is right")
        return self
