"""The keys of the gears' materials: a name of the table for both gears or for each, and a person's own values."""

from __future__ import annotations

from collections.abc import Mapping
from difflib import get_close_matches
from typing import TYPE_CHECKING, Annotated, Any, Literal, Self

from pydantic import AfterValidator, BeforeValidator, Field, model_validator

from ncgear.design.keys.base import Model, fault, listed, optional, required
from ncgear.strength.materials import TABLE, Ferrous

STRONGEST_MPA = 10_000.0
STIFFEST_GPA = 1000.0


def _known(name: str) -> str:
    """The name itself; a fault where the table has no such material."""
    if name not in TABLE:
        close = get_close_matches(name, TABLE, n=1, cutoff=0.5)
        hint = f"did you mean {close[0]}?" if close else f"known are {listed(TABLE, 'and')}"
        raise fault("", f"{name} is no material of the table; {hint}")
    return name


class GearMaterial(Model):
    """The material of one gear: a row of the table, and what a person knows better."""

    name: Annotated[str, AfterValidator(_known)] = required(
        "material of the table in docs/materials.md, whose figures hold for all that is not given here",
        json_schema_extra={"enum": [*TABLE]},
    )
    quality: Literal["ML", "MQ", "ME"] = optional(
        "grade of steel and iron by ISO 6336-5: ML modest, MQ normal for experienced makers, ME high demands; others "
        "have none",
        "MQ",
    )
    hardness: Annotated[float, Field(ge=50.0, le=1000.0)] | None = optional(
        "hardness of the flanks of steel and iron, Brinell or Vickers as the table says; left out: the table's"
    )
    contact_limit_mpa: float | None = optional(
        "own stress in MPa that flanks endure for long (sigma_Hlim); left out: the table's", gt=0.0, le=STRONGEST_MPA
    )
    bending_limit_mpa: Annotated[float, Field(gt=0.0, le=STRONGEST_MPA)] | None = optional(
        "own stress in MPa that roots endure for long, as the local stress with its notch (sigma_FE, twice "
        "sigma_Flim); left out: the table's"
    )
    youngs_modulus_gpa: float | None = optional(
        "own Young's modulus in GPa; left out: the table's", gt=0.0, le=STIFFEST_GPA
    )
    poisson: float | None = optional(
        "own Poisson's ratio; left out: the table's. At 0.5, as of rubber, wide teeth would be rigid", ge=0.0, le=0.49
    )
    density_kg_m3: float | None = optional("own density in kg/m3; left out: the table's", gt=0.0, le=30000.0)
    expansion_um_m_k: float | None = optional(
        "own linear thermal expansion in um per m and K, for ncgear tolerance; left out: the table's", ge=0.0, le=500.0
    )

    @model_validator(mode="after")
    def _hardness_is_of_the_class(self) -> Self:
        entry = TABLE[self.name]
        if "quality" in self.model_fields_set and not isinstance(entry, Ferrous):
            raise fault("quality", f"given, but {self.name} has no grades; leave it out")
        if self.hardness is None:
            return self
        if not isinstance(entry, Ferrous):
            raise fault("hardness", f"given, but the strength of {self.name} does not follow from it; leave it out")
        softest, hardest = entry.group.hardnesses
        if not softest <= self.hardness <= hardest:
            raise fault(
                "hardness",
                f"{self.hardness:g} given, but {self.name} ({entry.meaning}) has {softest:g} to {hardest:g} "
                f"{entry.group.scale}",
            )
        return self


def _by_name(value: Any) -> Any:
    """The group of keys for which a name alone stands."""
    return {"name": _known(value)} if isinstance(value, str) else value


if TYPE_CHECKING:
    WrittenMaterial = GearMaterial
else:
    # The type of names is made at run time, where type checkers cannot follow it, so that only the table lists them.
    Name = Literal[tuple(TABLE)]
    WrittenMaterial = Annotated[GearMaterial, BeforeValidator(_by_name, json_schema_input_type=Name | GearMaterial)]


class PairMaterial(Model):
    """The materials of both gears."""

    driving: WrittenMaterial = required("material of the driving gear: a name, or a group of keys")
    driven: WrittenMaterial | None = optional(
        "material of the driven gear: a name, or a group of keys; left out: that of the driving gear"
    )

    @property
    def each(self) -> tuple[GearMaterial, GearMaterial]:
        """The materials of the driving and the driven gear."""
        return self.driving, self.driven or self.driving


def _of_both(value: Any) -> Any:
    """The group of both gears, for which a name or the keys of one material stand."""
    of_one = isinstance(value, Mapping) and not value.keys() & PairMaterial.model_fields.keys()
    return {"driving": _by_name(value)} if isinstance(value, str) or of_one else value


if TYPE_CHECKING:
    WrittenMaterials = PairMaterial
else:
    WrittenMaterials = Annotated[
        PairMaterial, BeforeValidator(_of_both, json_schema_input_type=Name | GearMaterial | PairMaterial)
    ]
