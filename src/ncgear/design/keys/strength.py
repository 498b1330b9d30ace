"""The keys of the section ``strength``: what the gears run under, and how safe they shall be."""

from __future__ import annotations

from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from ncgear.design.keys.base import Model, allow_one, optional

USUAL_LIFE_H = 20_000.0
"""Ten years of 2000 hours; makers of bearings count 10 000 to 25 000 h for machines that run eight hours a day."""


class StrengthKeys(Model):
    """How the strength of the teeth is computed."""

    method: Literal["estimate", "elements"] = optional(
        "estimate: local replacement gears and ISO 6336, in milliseconds; elements: plane finite elements of every "
        "tooth, in seconds",
        "estimate",
    )
    life_h: Annotated[float, Field(gt=0.0, le=1e7)] | None = optional(
        "life wanted in hours at operation.speed_rpm; left out, with life_strokes: 20 000 h, ten years of 2000 hours"
    )
    life_strokes: float | None = optional(
        "life wanted in strokes of the slider out and back, instead of life_h", gt=0.0, le=1e13
    )
    application_factor: Annotated[float, Field(ge=1.0, le=5.0)] = optional(
        "application factor K_A: what jolts add to the load that is computed. 1.0 where the computed course of the "
        "load is all; 1.25 to 1.75 for a motor or a machine with jolts beyond it",
        1.0,
    )
    dynamic_factor: Annotated[float, Field(ge=1.0, le=5.0)] | None = optional(
        "dynamic factor K_V: what the teeth's own vibration adds; left out: estimated by ISO 6336-1, method C, for "
        "accuracy grade 8, near 1 at the speeds of cranks; gears too fast for that need it"
    )
    face_load_factor: Annotated[float, Field(ge=1.0, le=5.0)] = optional(
        "face load factor K_Hbeta: the greatest load along the width over the mean one. 1.3 for gears not wider than "
        "their shafts are stiff, as usual without a calculation of the shafts; 1.0 for the ideal pair",
        1.3,
    )
    reliability: float = optional(
        "share of gears that shall live so long: 0.99 is that of the figures of ISO 6336", 0.99, ge=0.5, le=0.9999
    )
    lubrication: Literal["oil", "grease", "dry"] = optional(
        "oil, grease or dry; dry steel wears, of which no life is told", "oil"
    )
    oil_viscosity_mm2_s: float = optional(
        "viscosity of the oil at 40 \u00b0C in mm2/s; greases: 220", 220.0, ge=1.0, le=2000.0
    )
    flank_roughness_um: Annotated[float, Field(gt=0.0, le=100.0)] = optional(
        "mean peak-to-valley roughness Rz of the flanks in um: about 3 ground, 6 hobbed, 12 milled", 6.0
    )
    root_roughness_um: float = optional("mean peak-to-valley roughness Rz of the roots in um", 16.0, gt=0.0, le=200.0)
    temperature_c: float = optional(
        "temperature in \u00b0C of the oil or, of dry or greased gears, of the air about them", 20.0, ge=-50.0, le=200.0
    )
    contact_safety: Annotated[float, Field(gt=0.0, le=10.0)] | None = optional(
        "least safety wanted against pitting, in stress; left out: 1.0 for metal, since single pits grow slowly, and "
        "1.4 for plastics"
    )
    bending_safety: Annotated[float, Field(gt=0.0, le=10.0)] | None = optional(
        "least safety wanted against breakage, in stress; left out: 1.4 for metal, since a broken tooth ends the "
        "drive, and 2.0 for plastics"
    )

    @model_validator(mode="after")
    def _one_life(self) -> Self:
        allow_one(self, ("life_h", "life_strokes"))
        return self
