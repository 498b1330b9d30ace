"""What all models of the design file share: strict types, no unknown keys, no changes, no nan or infinity."""

from __future__ import annotations

from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field, Strict

LONGEST_MM = 1e7
"""Ten kilometres: beyond any machine, and far below where the squares of lengths overflow."""

FASTEST_RPM = 1e7

Length = Annotated[float, Field(gt=0.0, le=LONGEST_MM)]
Speed = Annotated[float, Field(gt=0.0, le=FASTEST_RPM)]
Positive = Annotated[float, Field(gt=0.0)]

# YAML has lists only; strictness would ask for a tuple, so it is off for the container and on for its numbers.
Numbers = Annotated[tuple[float, ...], Strict(False)]


class Model(BaseModel):
    """Base of every model: what a person wrote, checked and unchangeable."""

    model_config = ConfigDict(strict=True, frozen=True, extra="forbid", allow_inf_nan=False)
