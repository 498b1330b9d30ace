"""The law ``ellipse``: elliptical gears."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Literal, Self

from pydantic import Field, model_validator

from ncgear.design.keys.base import allow_one, angle_rad, spellings
from ncgear.design.laws.base import Begins, DesignLaw, LawKeys, LawNumber

if TYPE_CHECKING:
    from ncgear.mechanisms.mechanism import Mechanism
    from ncgear.ratio.transmission import Lobes, Transmission


class Ellipse(LawKeys):
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

    @property
    def law_numbers(self) -> tuple[LawNumber, ...]:
        """The eccentricity."""
        return (LawNumber("eccentricity", "eccentricity", self.eccentricity),)

    def transmission(self, linkage: Mechanism, lobes: Lobes) -> Transmission:
        """Elliptical gears, or their relatives of several lobes."""
        from ncgear.ratio.laws.ellipse import elliptical_law

        return elliptical_law(self.eccentricity, self.phase, lobes)

    def gentler(self, share: float, even_turn: str) -> dict[str, Any]:
        """A smaller eccentricity."""
        return {"eccentricity": share * self.eccentricity}


LAW = DesignLaw(
    keys=Ellipse,
    choice="elliptical gears",
    begins=Begins.SHAPE,
)
