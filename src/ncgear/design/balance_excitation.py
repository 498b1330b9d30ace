"""What a balance file says of shafts and engines, and of natural frequencies."""

from __future__ import annotations

from typing import Annotated, Self

from pydantic import Field, Strict, model_validator

from ncgear.design.balance_mechanism import MOST_ITEMS
from ncgear.design.base import Model, Positive, Speed
from ncgear.design.faults import fault

MOST_COUNT = 10_000


class Shaft(Model):
    """A shaft that may shake the machine."""

    name: str = Field(min_length=1, max_length=100, description="what it is called")
    speed_rpm: Speed = Field(description="its speed in r/min")
    rollers: int | None = Field(default=None, ge=1, le=MOST_COUNT, description="rolling elements of its bearing")
    roller_ratio: float | None = Field(
        default=None,
        gt=0.0,
        lt=1.0,
        description="diameter of a rolling element by that of the pitch circle, times the cosine of the contact angle; "
        "left out: as many passes as rolling elements in each turn",
    )
    teeth: int | None = Field(default=None, ge=1, le=MOST_COUNT, description="teeth of its sprocket or gear")


class Engine(Model):
    """A reciprocating engine."""

    name: str = Field(default="engine", min_length=1, max_length=100, description="what it is called")
    speed_rpm: Speed = Field(description="its speed in r/min")
    cylinders: int = Field(ge=1, le=100, description="number of cylinders")
    strokes: int = Field(default=4, ge=2, le=4, description="strokes of a cycle, 2 or 4")
    inertia_order: Positive = Field(default=2.0, description="order of its strongest free inertia force")


class Excitations(Model):
    """Frequencies that shake the machine, beside its natural ones."""

    natural_hz: Annotated[tuple[Positive, ...], Strict(False), Field(min_length=1, max_length=MOST_ITEMS)] = Field(
        description="natural frequencies in Hz"
    )
    band: float = Field(
        default=0.2, gt=0.0, lt=1.0, description="share of a natural frequency within which an excitation is near it"
    )
    shafts: Annotated[tuple[Shaft, ...], Strict(False), Field(max_length=MOST_ITEMS)] = Field(
        default=(), description="shafts, a list"
    )
    engines: Annotated[tuple[Engine, ...], Strict(False), Field(max_length=MOST_ITEMS)] = Field(
        default=(), description="engines, a list"
    )
    harmonics: int = Field(
        default=0, ge=0, le=1000, description="harmonics of the slider's acceleration of each mechanism"
    )

    @model_validator(mode="after")
    def _something_shakes(self) -> Self:
        if not self.shafts and not self.engines and not self.harmonics:
            raise fault("", "nothing shakes; give shafts, engines or harmonics")
        return self
