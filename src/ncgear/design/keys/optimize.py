"""What an optimised law shall be best at, and the limits it must keep."""

from __future__ import annotations

from typing import Literal, Self

from pydantic import Field, model_validator

from ncgear.design.keys.base import Length, Model, Positive, Speed, allow_one, angle_rad, fault, given, spellings

MOST_HARMONICS = 60


class Limits(Model):
    """What the law may nowhere exceed; left out: no limit."""

    peak_power_w: Positive | None = Field(default=None, description="greatest power at the slider in W")
    peak_acceleration_mm_s2: Positive | None = Field(
        default=None, description="greatest slider acceleration in mm/s2, over the whole cycle"
    )
    peak_jerk_mm_s3: Positive | None = Field(default=None, description="greatest slider jerk in mm/s3")
    driven_speed_rpm: Speed | None = Field(default=None, description="greatest speed of the driven gear in r/min")
    ratio_min: float = Field(default=0.2, ge=0.01, le=1.0, description="least transmission ratio")
    ratio_max: float = Field(default=5.0, ge=1.0, le=100.0, description="greatest transmission ratio")
    pressure_angle_deg: float | None = Field(
        default=None,
        gt=0.0,
        lt=90.0,
        description="greatest pressure angle in degrees, that of the rack included; of two stages, of each",
    )
    stages: int = Field(
        default=1,
        ge=1,
        le=2,
        description="2: the ratio is shared over two pairs in series; ratio, curves and pressure angle count for each",
    )
    convex: bool = Field(default=True, description="true: both pitch curves are convex, so that a rack can cut them")
    least_radius_mm: Length | None = Field(
        default=None,
        description="least radius of curvature of both pitch curves in mm; needs gears.teeth and gears.module_mm",
    )
    free_of_undercut: bool = Field(
        default=False, description="true: gears.teeth teeth are free of undercut at their full height"
    )
    working_angle_rad: Positive | None = Field(
        default=None, description="driving angle in rad that the working stroke takes; left out: free"
    )
    working_angle_deg: Positive | None = Field(
        default=None, description="driving angle in degrees that the working stroke takes; left out: free"
    )
    working_angle_pi: Positive | None = Field(
        default=None, description="driving angle in multiples of pi that the working stroke takes; left out: free"
    )

    @property
    def working_angle(self) -> float | None:
        """Driving angle of the working stroke in rad; None where it is free."""
        return angle_rad(self, "working_angle") if given(self, spellings("working_angle")) else None

    @model_validator(mode="after")
    def _one_working_angle(self) -> Self:
        allow_one(self, spellings("working_angle"))
        return self


class Weights(Model):
    """The peak acceleration and the peak power that count alike in a weighted goal."""

    acceleration_mm_s2: Positive = Field(description="peak acceleration in mm/s2 that counts as one")
    power_w: Positive = Field(description="peak power in W that counts as one")


class Optimize(Model):
    """What `ncgear optimize` looks for."""

    goal: Literal["least_acceleration", "least_power", "weighted"] = Field(
        default="least_acceleration",
        description="what shall be least: the slider's peak acceleration, the peak power (and with it the driving "
        "torque), or a weighted sum of both",
    )
    weights: Weights | None = Field(
        default=None, description="the acceleration and the power that count alike; only for goal weighted"
    )
    limits: Limits = Field(default_factory=Limits, description="what the law may nowhere exceed")
    harmonics: int = Field(
        default=24, ge=2, le=MOST_HARMONICS, description="harmonics of ln i12: more come closer to the limit"
    )
    starts: int = Field(default=1, ge=1, le=20, description="starts of the search: the uniform crank, then at random")
    seed: int = Field(default=0, ge=0, description="seed of the starts at random")

    @model_validator(mode="after")
    def _weights_of_the_weighted(self) -> Self:
        if self.goal == "weighted" and self.weights is None:
            raise fault("weights", "missing; a weighted goal needs the acceleration and the power that count as one")
        if self.goal != "weighted" and self.weights is not None:
            raise fault("weights", f"given, but the goal is {self.goal}; leave weights out, or goal: weighted")
        return self
