"""The force against the slider as a design file gives it: a polynomial, a table, or an expression."""

from __future__ import annotations

from typing import Annotated, Literal, Self

from pydantic import Field, Strict, model_validator

from ncgear.design.angles import require_one
from ncgear.design.base import LONGEST_MM, Model, Numbers
from ncgear.design.faults import fault
from ncgear.design.motion import Expression

MOST_POINTS = 1000
FEWEST_POINTS = 2

STRONGEST_N = 1e15
"""Far beyond any machine, and far below where slopes between two points overflow."""

Points = Field(min_length=FEWEST_POINTS, max_length=MOST_POINTS)
Displacement = Annotated[float, Field(ge=-LONGEST_MM, le=LONGEST_MM)]
Displacements = Annotated[tuple[Displacement, ...], Strict(False), Points]
Forces = Annotated[tuple[Annotated[float, Field(ge=-STRONGEST_N, le=STRONGEST_N)], ...], Strict(False), Points]


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
        return self


class Resistance(Model):
    """The force against the slider over its working stroke; one of polynomial_n, table and expression_n."""

    polynomial_n: Annotated[Numbers, Field(min_length=1, max_length=50)] | None = Field(
        default=None, description="coefficients of the force in N, in rising powers of the displacement in mm"
    )
    table: ResistanceTable | None = Field(
        default=None, description="the force point by point; it keeps its end values beyond the table's ends"
    )
    expression_n: Expression | None = Field(
        default=None, description='force in N as a formula of x (= displacement in mm): "200 + 3*exp(x/90)"'
    )
    where_negative: Literal["zero", "keep"] = Field(
        default="zero", description="where the force is negative: zero (a fit says nothing there) or keep"
    )

    @model_validator(mode="after")
    def _one_form(self) -> Self:
        require_one(self, ("polynomial_n", "table", "expression_n"))
        return self
