"""What a balance file says of gears and rotors."""

from __future__ import annotations

from typing import Annotated, Self

from pydantic import Field, Strict, model_validator

from ncgear.design.balance_mechanism import MOST_ITEMS, Angle
from ncgear.design.base import Length, Model, Positive, Speed
from ncgear.design.faults import fault

Amplitude = Annotated[float, Field(ge=0.0, le=1e9)]


class Holes(Model):
    """Through holes that may be drilled."""

    largest_mm: Length = Field(description="diameter of the largest in mm")
    smallest_mm: Length = Field(description="diameter of the smallest in mm")
    wall_mm: Length = Field(description="least wall between holes and to every edge in mm")

    @model_validator(mode="after")
    def _smallest_is_smaller(self) -> Self:
        if self.smallest_mm > self.largest_mm:
            problem = f"{self.smallest_mm:g} mm is over largest_mm; {self.largest_mm:g} or less is right"
            raise fault("smallest_mm", problem)
        return self


class Boss(Model):
    """A boss on the upper face."""

    height_mm: Length = Field(description="its height over the face in mm")
    wall_mm: Length = Field(description="its distance from every edge in mm")


class Correction(Model):
    """What may be done to a gear: holes first, a boss for what they leave."""

    holes: Holes | None = Field(default=None, description="through holes; left out: none")
    boss: Boss | None = Field(default=None, description="a boss; left out: none")


class GearBalance(Model):
    """Balance of the gears of a design."""

    design: str = Field(min_length=1, description="the design file; its path counts from this file")
    density_kg_m3: float = Field(default=7850.0, gt=0.0, le=30000.0, description="density of both gears in kg/m3")
    grade: float = Field(
        default=6.3, gt=0.0, le=4000.0, description="grade of balance quality of ISO 21940-11 in mm/s: 6.3 for G 6.3"
    )
    driving: Correction | None = Field(default=None, description="correction of the driving gear; left out: none")
    driven: Correction | None = Field(default=None, description="correction of the driven gear; left out: none")


class Reading(Model):
    """What an instrument shows."""

    amplitude: Amplitude = Field(description="amplitude, in the same unit for all")
    phase_deg: Angle = Field(description="phase in degrees, as the instrument counts it")


Readings = Annotated[tuple[Reading, ...], Strict(False), Field(min_length=1, max_length=MOST_ITEMS)]


class Trial(Model):
    """A run with a trial weight in one plane, taken off again after it."""

    mass_g: float = Field(ge=0.0, le=1e9, description="mass of the trial weight in g")
    angle_deg: Angle = Field(description="its angle in degrees, counted as the instrument counts phases")
    readings: Readings = Field(description="what every sensor shows, a list")


class Rotor(Model):
    """Field balancing from trial weights."""

    speed_rpm: Speed = Field(description="speed of the runs in r/min")
    first: Readings | None = Field(default=None, description="readings of every sensor without trial weights, a list")
    trials: Annotated[tuple[Trial, ...], Strict(False), Field(min_length=1, max_length=20)] | None = Field(
        default=None, description="one run for each plane, a list"
    )
    file: str | None = Field(
        default=None,
        min_length=1,
        description="CSV file of both instead, one reading in each row, with columns plane (0: without trial weight), "
        "mass_g, angle_deg, sensor, amplitude, phase_deg; its path counts from this file",
    )
    mass_kg: Positive | None = Field(default=None, description="mass of the rotor in kg; left out: no grade is told")
    radius_mm: Length | None = Field(default=None, description="radius of the weights in mm, with mass_kg")
    grade: float = Field(
        default=16.0, gt=0.0, le=4000.0, description="grade of balance quality of ISO 21940-11 in mm/s: 16 for G 16"
    )

    @model_validator(mode="after")
    def _has_readings(self) -> Self:
        for key in ("first", "trials"):
            if getattr(self, key) is None:
                raise fault(key, "missing; give first and trials, or a file of them")
        if (self.mass_kg is None) != (self.radius_mm is None):
            raise fault("mass_kg" if self.radius_mm is None else "radius_mm", "needs mass_kg and radius_mm both")
        return self


class ChainRun(Model):
    """A run with the weight at one phase."""

    weight_deg: Angle = Field(description="phase of the weight in degrees")
    amplitude: Amplitude = Field(description="amplitude of the reading")
    phase_deg: Angle = Field(description="phase of the reading in degrees")


class ChainDrive(Model):
    """Equivalent unbalance of a chain drive from runs with one weight at several phases."""

    wrap_deg: Angle = Field(description="phase of the middle of the chain's wrap in degrees")
    tight_deg: Angle = Field(description="phase of the tight side's equivalent unbalance in degrees")
    slack_deg: Angle = Field(description="phase of the slack side's in degrees")
    runs: Annotated[tuple[ChainRun, ...], Strict(False), Field(min_length=3, max_length=1000)] | None = Field(
        default=None, description="runs, a list"
    )
    file: str | None = Field(
        default=None,
        min_length=1,
        description="CSV file of runs instead, with columns weight_deg, amplitude, phase_deg; its path counts from "
        "this file",
    )
    predict_deg: Annotated[tuple[Angle, ...], Strict(False), Field(max_length=MOST_ITEMS)] = Field(
        default=(), description="phases of the weight in degrees for which readings are predicted"
    )
    effect_per_g: Positive | None = Field(
        default=None, description="amplitude per g of a weight, for corrections; left out: none"
    )

    @model_validator(mode="after")
    def _has_runs(self) -> Self:
        if self.runs is None:
            raise fault("runs", "missing; give runs, or a file of them")
        return self
