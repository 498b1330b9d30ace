"""The results of a check as plain values whose keys end in their unit, and the comparison of the design with others."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import degrees
from typing import Any

from ncgear.design.keys.machine import Published
from ncgear.figures.advice.verdict import KnownParts, Verdict, judged
from ncgear.figures.numbers import fixed, name_of, shown, to_digits
from ncgear.figures.tables import Column, Table
from ncgear.figures.wished import motion_summary, wish_rows
from ncgear.kinematics.check import KinematicCheck, peak_figures
from ncgear.mechanisms.mechanism import Output
from ncgear.numerics.units import label_and_unit
from ncgear.pitch.pair import largest_tangent_angle_rad
from ncgear.project.drive import Drive

COMPARED = (
    "speed_rpm",
    "peak_power_w",
    "peak_power_resistance_w",
    "mean_power_w",
    "peak_acceleration_cycle_mm_s2",
    "peak_speed_mm_s",
    "peak_acceleration_cycle_rad_s2",
    "peak_speed_rad_s",
)
"""The figures of a comparison of mechanisms, by their keys."""

SAME_SPEED = "Comparison at equal driving speed"
MIXED_SPEEDS = "At other driving speeds: mixes speeds, so this proves nothing about equal productivity"


def comparison_rows(drive: Drive) -> list[dict[str, Any]]:
    """This design, the uniform crank, and published mechanisms scaled to the operating speed; then mixed speeds.

    Each row has ``name``, ``note``, ``same_speed`` (whether it holds at the operating speed) and figures in the units
    that its keys end in, None where one is not known.
    """
    speed, own, other = drive.design.operation.speed_rpm, drive.check, drive.uniform_check
    against_uniform = _saved("", own.peak_power_w.value, other.peak_power_w.value)
    published = drive.design.comparison.published if drive.design.comparison else ()
    return [
        _checked("this design", own, speed, ""),
        _checked(drive.linkage.UNIFORM, other, speed, against_uniform),
        *(_scaled(drive, mechanism) for mechanism in published),
        *(row for mechanism in published for row in _mixed(drive, mechanism)),
    ]


def _saved(what: str, own_w: float, other_w: float | None) -> str:
    """Words for a peak power of this design against the power of another machine; empty where the other has none."""
    if not other_w:
        return ""
    saving = 100.0 * (1.0 - own_w / other_w)
    return f"this design's peak power{what} is {fixed(abs(saving), 1)} % {'lower' if saving >= 0 else 'higher'}"


def _checked(name: str, check: KinematicCheck, speed: float, note: str) -> dict[str, Any]:
    acceleration, velocity = check.peak_acceleration_cycle.value, check.peak_speed.value
    row = _row(check.output, name, speed, check.peak_power_w.value, acceleration, velocity)
    alone = {"peak_power_resistance_w": check.peak_power_resistance_w.value} if check.with_masses else {}
    return {**row, **alone, "mean_power_w": check.mean_power_w, "same_speed": True, "note": note}


def _row(
    output: Output, name: str, speed: float, power: float | None, acceleration: float | None, velocity: float | None
) -> dict[str, Any]:
    return {
        "name": name,
        "speed_rpm": speed,
        "peak_power_w": power,
        "mean_power_w": None,
        f"peak_acceleration_cycle_{output.acceleration.ending}": acceleration,
        f"peak_speed_{output.speed.ending}": velocity,
    }


def _scaled(drive: Drive, published: Published) -> dict[str, Any]:
    found = published.at_speed(drive.design.operation.speed_rpm)
    power, pressing = found.peak_power_w, found.compression_speed_mm_s
    # A publication counts no masses of this machine
    alone = ", of the resistance alone," if drive.check.with_masses else ""
    saved = _saved(alone, drive.check.peak_power_resistance_w.value, power)
    notes = [saved, f"compression speed {to_digits(pressing, 4)} mm/s" if pressing else ""]
    output = drive.linkage.OUTPUT
    row = _row(output, found.name, found.speed_rpm, power, found.peak_acceleration_mm_s2, found.peak_speed_mm_s)
    return {**row, "same_speed": True, "note": "; ".join(note for note in notes if note)}


def _mixed(drive: Drive, published: Published) -> list[dict[str, Any]]:
    """The publication's own comparison, where it compares figures at different speeds."""
    if published.quoted_power_w is None or published.quoted_speed_rpm is None:
        return []
    acceleration, velocity = published.peak_acceleration_mm_s2, published.peak_speed_mm_s
    output = drive.linkage.OUTPUT
    theirs = _row(output, published.name, published.speed_rpm, published.peak_power_w, acceleration, velocity)
    quoted = _row(
        output, "set against it in the publication", published.quoted_speed_rpm, published.quoted_power_w, None, None
    )
    same = drive.check.peak_power_resistance_w.value * published.speed_rpm / drive.design.operation.speed_rpm
    alone = " for the resistance alone" if drive.check.with_masses else ""
    note = f"at {published.speed_rpm:g} r/min this design needs {shown(same)} W{alone}"
    if published.peak_power_w:
        saving = 100.0 * (1.0 - published.quoted_power_w / published.peak_power_w)
        note = f"the {fixed(saving, 1)} % between the two rows is a difference of speed; {note}"
    return [{**theirs, "same_speed": False, "note": ""}, {**quoted, "same_speed": False, "note": note}]


def comparison_tables(rows: Sequence[Mapping[str, Any]]) -> list[Table]:
    """A table of the mechanisms at equal speed, and one of the figures that were published at other speeds."""
    same, mixed = ([row for row in rows if row["same_speed"] is wanted] for wanted in (True, False))
    return [_table(title, chosen) for title, chosen in ((SAME_SPEED, same), (MIXED_SPEEDS, mixed)) if chosen]


def _table(title: str, rows: Sequence[Mapping[str, Any]]) -> Table:
    keys = [key for key in COMPARED if any(key in row for row in rows)]
    cells = (((str(row["name"]), *(shown(row.get(key)) for key in keys))) for row in rows)
    columns = Column("mechanism"), *(Column(name_of(key), label_and_unit(key)[1]) for key in keys)
    return Table(title, columns, tuple(cells), row_notes=tuple(row["note"] for row in rows))


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
    return {"warnings": verdict.lines(matter=True), "remarks": verdict.lines(matter=False), "verdict": verdict.table}


def _drive(drive: Drive) -> dict[str, Any]:
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
    return [shaft.words for shaft in drive.design.shafts[1:-1]]


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
