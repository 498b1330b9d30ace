"""The results of a check as plain values whose keys end in their unit."""

from __future__ import annotations

from math import degrees
from typing import Any

from ncgear.figures.advice.verdict import KnownParts, Verdict, judged
from ncgear.figures.comparison import comparison_rows
from ncgear.figures.wished import motion_summary, wish_rows
from ncgear.kinematics.check import peak_figures
from ncgear.pitch.pair import largest_tangent_angle_rad
from ncgear.project.drive import Drive


def check_summary(drive: Drive, verdict: Verdict | None = None) -> dict[str, Any]:
    """Kinematics and power.  The ratio belongs to the drive's own stage, or to the whole machine.

    ``verdict`` is another one than what a check can judge.
    """
    verdict = verdict or judged(drive, KnownParts.MOTION)
    of_ratio = drive.transmission if drive.stage is None else drive.pair.transmission
    (low, high), found = of_ratio.ratio_range, drive.achieved
    return {
        "design": {"name": drive.design.name, "description": drive.design.description, "law": drive.design.motion.law},
        "drive": _drive(drive),
        **stages_summary(drive),
        "closure": {"residual_rad": abs(drive.transmission.closure_error_rad), **drive.told_stroke_residual},
        "ratio": {"min": low.value, "max": high.value, "min_at_rad": low.at, "max_at_rad": high.at},
        "check": _check(drive),
        **({"motion": motion_summary(found, drive.linkage), "wishes": wish_rows(found)} if found else {}),
        "comparison": comparison_rows(drive),
        **verdict_summary(verdict),
    }


def verdict_summary(verdict: Verdict) -> dict[str, Any]:
    """The verdict in full: warnings and remarks as sentences, and a row for each condition."""
    return {
        "warnings": verdict.lines(matter=True),
        "remarks": verdict.lines(matter=False),
        "verdict": verdict.table,
    }


def _drive(drive: Drive) -> dict[str, Any]:
    """Speeds, lobes, and the linkage where there is one."""
    lobes, linkage, place = drive.transmission.lobes, drive.linkage, drive.linkage.OUTPUT.place
    found: dict[str, Any] = {"speed_rpm": drive.design.operation.speed_rpm, "law_speed_rpm": drive.law_speed_rpm}
    if lobes.range is not None:
        found["driving_range_deg"] = degrees(lobes.range.driving_rad)
        return found | {"driven_range_deg": degrees(lobes.range.driven_rad)}
    found |= {"lobes_driving": lobes.driving, "lobes_driven": lobes.driven}
    if linkage.RETURNS:
        found |= {"crank_mm": linkage.crank_mm, f"stroke_{place.ending}": place.factor * linkage.stroke_mm}
        found["working_crank_angle_deg"] = degrees(linkage.working_angle_rad)
        found["working_driving_angle_deg"] = degrees(drive.machine.extended_rad)
    return {**found, **(drive.law.stroke.facts if drive.law.stroke else {}), **drive.law.facts}


def stages_summary(drive: Drive) -> dict[str, Any]:
    """The section of pairs in series: the number of the drive's own stage, or else ratios and angles of all.

    The number stands with the place of the stage in the machine; phi1 of the stage is the angle of its driving gear.
    """
    if drive.design.stages == 1:
        return {}
    if drive.stage is None:
        return {"stages": {f"stage_{pair.stage}": _range_and_angle(pair) for pair in drive.by_stage}}
    count, number = drive.design.stages, drive.stage
    shafts = ["driving shaft", *names_between(drive), "crank shaft"]
    return {
        "stage": {
            "number": number,
            "of": count,
            "driving_gear_on": shafts[number - 1],
            "driven_gear_on": shafts[number],
            # Each pair turns the next shaft the other way round.
            "seen_from": "driving end" if number % 2 else "other end of the shafts",
        }
    }


def names_between(drive: Drive) -> list[str]:
    """The shafts between the pairs of a machine in words, from the driving shaft on."""
    count = drive.design.stages
    return [f"shaft between {'the stages' if count == 2 else f'stages {n} and {n + 1}'}" for n in range(1, count)]


def _range_and_angle(drive: Drive) -> dict[str, Any]:
    low, high = drive.pair.transmission.ratio_range
    tangent = degrees(largest_tangent_angle_rad(drive.pair.transmission).value)
    found = {"ratio_min": low.value, "ratio_max": high.value, "max_tangent_angle_deg": tangent}
    if drive.design.gears is not None:
        found["max_pressure_angle_deg"] = tangent + drive.design.gears.carrying_angle_deg
    return found


def masses_note(drive: Drive) -> str:
    """How masses count in the figures of power where that is to be told; empty where they count as the file gives them.

    A design that gives neither resistance nor masses has no power, and nothing is told of power.
    """
    why = drive.masses_left_out
    if why is not None:
        return f"not counted in power: {why}" if drive.design.resistance else ""
    if drive.gear_refusal is None:
        return ""
    return f"discs within the pitch curves stand for gears that cannot be made: {drive.gear_refusal.problem}"


def _check(drive: Drive) -> dict[str, Any]:
    result: dict[str, Any] = peak_figures(drive.check, returns=drive.linkage.RETURNS)
    if drive.law.stroke is not None:
        found = drive.check_at_rpm(drive.law_speed_rpm)
        of_law = peak_figures(found, returns=drive.linkage.RETURNS)
        told = {key: value for key, value in of_law.items() if key.startswith("peak_") and not key.endswith("_at_rad")}
        result["at_law_speed"] = {"speed_rpm": drive.law_speed_rpm, **told}
    result[uniform_key(drive)] = peak_figures(drive.uniform_check, returns=drive.linkage.RETURNS)
    note = masses_note(drive)
    return {**result, "masses": note} if note else result


def uniform_key(drive: Drive) -> str:
    """The key of the figures of the same machine where the driven gear turns evenly."""
    return drive.linkage.UNIFORM.replace(" ", "_")
