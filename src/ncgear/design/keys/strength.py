"""The keys of the gears' materials, of their running conditions and of their safeties."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Annotated, Any, Literal

from pydantic import AfterValidator, BeforeValidator, Field

from ncgear.design.keys.base import Faults, Model, fault, optional, required
from ncgear.design.words import listed
from ncgear.strength.materials import TABLE, Ferrous, near_materials

STRONGEST_MPA = 10_000.0
STIFFEST_GPA = 1000.0


def _known(name: str) -> str:
    """The name itself; a fault if the table has no such material."""
    if name not in TABLE:
        close = near_materials(name)
        hint = f"did you mean {close[0]}?" if close else f"known are {listed(TABLE, 'and')}"
        raise fault("", f"{name} is no material of the table; {hint}")
    return name


class GearMaterial(Model):
    """The material of one gear: a row of the table, and the properties that a person knows better."""

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

    def _faults(self) -> Faults:
        entry = TABLE[self.name]
        if "quality" in self.model_fields_set and not isinstance(entry, Ferrous):
            yield fault("quality", f"given, but {self.name} has no grades; leave it out")
        if self.hardness is None:
            return
        if not isinstance(entry, Ferrous):
            yield fault("hardness", f"given, but the strength of {self.name} does not follow from it; leave it out")
            return
        softest, hardest = entry.group.hardnesses
        if not softest <= self.hardness <= hardest:
            yield fault(
                "hardness",
                f"{self.hardness:g} given, but {self.name} ({entry.meaning}) has {softest:g} to {hardest:g} "
                f"{entry.group.scale}",
            )


def _by_name(value: Any) -> Any:
    """The group of keys for a name, which may stand alone."""
    return {"name": _known(value)} if isinstance(value, str) else value


if TYPE_CHECKING:
    WrittenMaterial = GearMaterial
else:
    # The type of names is made at run time, so that only the table lists them; type checkers cannot follow it.
    Name = Literal[tuple(TABLE)]
    WrittenMaterial = Annotated[GearMaterial, BeforeValidator(_by_name, json_schema_input_type=Name | GearMaterial)]


class PairMaterial(Model):
    """The materials of both gears."""

    driving: WrittenMaterial = required("material of the driving gear: a name, or a group of keys")
    driven: WrittenMaterial | None = optional(
        "material of the driven gear: a name, or a group of keys; left out: the driving gear's"
    )

    @property
    def each(self) -> tuple[GearMaterial, GearMaterial]:
        """The materials of the driving and the driven gear."""
        return self.driving, self.driven or self.driving


def _of_both(value: Any) -> Any:
    """The group of both gears for a name or for the keys of one material."""
    of_one = isinstance(value, Mapping) and not value.keys() & PairMaterial.model_fields.keys()
    return {"driving": _by_name(value)} if isinstance(value, str) or of_one else value


if TYPE_CHECKING:
    WrittenMaterials = PairMaterial
else:
    WrittenMaterials = Annotated[
        PairMaterial, BeforeValidator(_of_both, json_schema_input_type=Name | GearMaterial | PairMaterial)
    ]


USUAL_LIFE_H = 20_000.0
"""Ten years of 2000 hours; makers of bearings recommend 10 000 to 25 000 h for machines that run eight hours a day."""


AIR_C, WARM_OIL_C = 20.0, 40.0
"""Default temperatures: the air in a room, and the oil in a working gearbox, which makes a thinner film than cold
oil."""


class Overload(Model):
    """A jam: the torque that presses the teeth then, at any place of the mesh, besides the load of every stroke."""

    driving_torque_n_m: Annotated[float, Field(gt=0.0, le=1e9)] = required(
        "torque in N m at the driving gear's shaft when the machine jams: the most that motor, flywheel or limiter let "
        "through. The teeth shall bear it at any angle, with the safeties wanted, without K_A and K_V"
    )
    times: float = optional(
        "how many jams come in the wanted life, all of them on the same teeth", 100.0, ge=1.0, le=1e6
    )


class StrengthKeys(Model):
    """Settings for the strength of the teeth."""

    RULES = ("at most one of life_h life_strokes", "oil_viscosity_100_mm2_s < oil_viscosity_mm2_s")

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
    mates: int = optional(
        "gears alike that each tooth of the driving gear meets in a turn with the load that is computed, as planets "
        "around a sun, a whole number; counted in its life and wear",
        1,
        ge=1,
        le=100,
    )
    application_factor: Annotated[float, Field(ge=1.0, le=5.0)] = optional(
        "application factor K_A: what jolts add to the load that is computed. 1.0 where the computed course of the "
        "load is all; 1.25 to 1.75 for a motor or a machine with jolts beyond it",
        1.0,
    )
    overload: Overload | None = optional("torque of a jam, which the teeth shall bear a few times; left out: none")
    dynamic_factor: Annotated[float, Field(ge=1.0, le=5.0)] | None = optional(
        "dynamic factor K_V for the teeth's own vibration; left out: computed for every place of the turn by "
        "ISO 6336-1, method B, from the inertias of both shafts and the grade of tolerances, 8 without"
    )
    face_load_factor: Annotated[float, Field(ge=1.0, le=5.0)] | None = optional(
        "face load factor K_Hbeta: the greatest load along the width over the mean one; 1.0 for the ideal pair. Left "
        "out: computed for every tooth where drivetrain gives bearings and diameters of both shafts, else 1.3, as "
        "usual for gears not wider than their shafts are stiff"
    )
    reliability: float = optional(
        "share of gears that shall reach the life; the figures of ISO 6336 hold for 0.99", 0.99, ge=0.5, le=0.9999
    )
    lubrication: Literal["oil", "grease", "dry"] = optional(
        "oil, grease or dry; dry steel wears, and its life ends when a tenth of the module is worn off", "oil"
    )
    oil_viscosity_mm2_s: float = optional(
        "viscosity of the oil at 40 \u00b0C in mm2/s; greases: 220", 220.0, ge=1.0, le=2000.0
    )
    oil_viscosity_100_mm2_s: float | None = optional(
        "viscosity of the oil at 100 \u00b0C in mm2/s; left out: a mineral oil with a viscosity "
        "index of 95, so 18.4 for 220 at 40 \u00b0C",
        ge=0.5,
        le=200.0,
    )
    oil_fzg_stage: float = optional(
        "load stage at which the oil fails in the FZG scuffing test A/8.3/90 (ISO 14635-1), by its data sheet: 12 of "
        "usual gear oils with additives (CLP), 6 to 9 of oils without",
        12.0,
        ge=1.0,
        le=14.0,
    )
    wear_coefficient_mm3_n_m: float | None = optional(
        "own wear coefficient of both flanks in mm3 for each N and m of sliding where no film parts them; left out: "
        "by material and lubrication as on the page of materials, known to the power of ten at best",
        gt=0.0,
        le=1.0,
    )
    flank_roughness_um: Annotated[float, Field(gt=0.0, le=100.0)] = optional(
        "mean peak-to-valley roughness Rz of the flanks in um: about 3 ground, 6 hobbed, 12 milled", 6.0
    )
    root_roughness_um: float = optional("mean peak-to-valley roughness Rz of the roots in um", 16.0, gt=0.0, le=200.0)
    temperature_c: float | None = optional(
        "temperature in \u00b0C of the oil or, of dry or greased gears, of the air about them; left out: 20, and "
        "40 for the film of oil between metal flanks",
        ge=-50.0,
        le=200.0,
    )
    duty_cycle: float = optional(
        "largest share of ten minutes in which the machine runs (ED of VDI 2736): dry and greased plastics warm by "
        "ED^0.64 of what they would without a pause. life_h counts running hours",
        1.0,
        gt=0.0,
        le=1.0,
    )
    contact_safety: Annotated[float, Field(gt=0.0, le=10.0)] | None = optional(
        "least safety wanted against pitting, in stress; left out: 1.0 for metal, since single pits grow slowly, and "
        "1.4 for plastics"
    )
    bending_safety: Annotated[float, Field(gt=0.0, le=10.0)] | None = optional(
        "least safety wanted against breakage, in stress; left out: 1.4 for metal, since a broken tooth ends the "
        "drive, and 2.0 for plastics"
    )
