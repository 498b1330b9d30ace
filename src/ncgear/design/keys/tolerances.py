"""The keys of ``tolerances``: permissible deviations of the gears and their assembly, for ncgear tolerance."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from ncgear.design.keys.base import Model, optional, required

GRADE = "flank tolerance class of ISO 1328-1:2013, 1 (finest) to 11"


class GearTolerances(Model):
    """Permissible deviations of one gear."""

    grade: int | None = optional(f"{GRADE}; left out: the grade of both gears", ge=1, le=11)
    single_pitch_mm: Annotated[float, Field(ge=0.0, le=10.0)] | None = optional(
        "own largest deviation in mm of one pitch, either way, in place of the grade's: printed gears are coarser than "
        "any grade"
    )
    profile_mm: float | None = optional(
        "own largest total deviation in mm of a flank's profile in place of the grade's", ge=0.0, le=10.0
    )
    eccentricity_mm: Annotated[float, Field(ge=0.0, le=10.0)] = optional(
        "largest distance in mm of the bore's centre from the teeth's, in any direction: half the runout that a dial "
        "shows",
        0.0,
    )
    tilt_deg: float = optional(
        "largest angle in degrees between the bore and the axis of the teeth, in any direction", 0.0, ge=0.0, le=5.0
    )
    index_deg: Annotated[float, Field(ge=0.0, le=10.0)] = optional(
        "largest angle in degrees, either way, between teeth and shaft that comes from the keyway", 0.0
    )
    wear_mm: Annotated[float, Field(ge=0.0, le=10.0)] = optional(
        "depth in mm to which flanks that push are worn at the end of life, all alike; both sides of the teeth with "
        "gears.drives: both_ways",
        0.0,
    )


class Temperatures(Model):
    """The lowest and the highest temperature of the running gears."""

    RULES = ("largest_c >= least_c",)

    least_c: float = required("least temperature of gears and housing in \u00b0C", ge=-100.0, le=300.0)
    largest_c: float = required("largest temperature of gears and housing in \u00b0C", ge=-100.0, le=300.0)
    warmer_k: float = optional("how much warmer than their housing the gears run, in K", 0.0, ge=0.0, le=200.0)


class AssemblyTolerances(Model):
    """Permissible deviations of a pair of gears and its housing."""

    grade: int | None = optional(f"{GRADE}, of both gears; left out: teeth without deviations", ge=1, le=11)
    center_distance_mm: float = optional(
        "largest deviation in mm of the centre distance, either way", 0.0, ge=0.0, le=10.0
    )
    driving: GearTolerances = optional("deviations of the driving gear", GearTolerances)
    driven: GearTolerances = optional("deviations of the driven gear", GearTolerances)
    temperature: Temperatures | None = optional(
        "temperatures that gears and housing run at; left out: 20 \u00b0C, as they are made"
    )
    housing_expansion_um_m_k: float = optional(
        "linear thermal expansion of the housing in um per m and K: steel 11.5, aluminium 23.5", 11.5, ge=0.0, le=500.0
    )
    largest_play_mm: Annotated[float, Field(gt=0.0, le=100.0)] | None = optional(
        "play in mm along the normal above which teeth knock where the torque turns round; left out: twice the largest "
        "play as designed, and a twentieth of the module at least"
    )
